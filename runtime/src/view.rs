//! From where a scene is looked at, and what of it is shown.

use surefoot_compiler::compiled::Camera;
use surefoot_compiler::reference;
use surefoot_compiler::section::Cut;

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

/// What the pictures of a scene show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Showing {
    /// The view.
    pub view: reference::View,
    /// How a plane cuts the picture open, where one does. Where it is: [`Live::section`](surefoot_compiler::Live::section).
    pub section: Option<Cut>,
    /// The view that is shown right of the divider, where there are two.
    pub beside: Option<reference::View>,
}

impl From<reference::View> for Showing {
    fn from(view: reference::View) -> Self {
        Self { view, ..Self::default() }
    }
}
