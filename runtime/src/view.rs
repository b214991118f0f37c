//! From where a scene is looked at.

use surefoot_compiler::compiled::Camera;

/// One look at a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Eye, target, angle.
    pub camera: Camera,
    /// Width and height of the whole picture, in pixels.
    pub size: [f32; 2],
    /// Where the picture's upper left corner lies on the target, in pixels: not zero within a window's panel, and negative where
    /// only a part of a picture is drawn.
    pub corner: [f32; 2],
    /// Which of the pictures it is that become one on film: of a light's disc each looks at its own place. 0 where there is one alone.
    pub sample: u32,
}
