//! What lies on a surface, as text: for each layer of the scene's surface a few lines that add what its image says.

use std::borrow::Cow;
use surefoot_compiler::functions::Surface;
use surefoot_compiler::graph::Slot;
use surefoot_compiler::images::TextureKind;

/// Textures that a pass takes; what is made of more images is drawn without them. Every device has room for sixteen, and shadows and the sky
/// need some.
pub const MOST_TEXTURES: usize = 8;
/// The binding of the first texture in group 1; that of their sampler is the one before.
pub(super) const FIRST_TEXTURE: u32 = 5;

/// The text that says of a place what is there: the function `scene_met`.
pub(super) fn text(surface: &Surface) -> Vec<Cow<'static, str>> {
    if !surface.is_layered() {
        return vec![include_str!("layers/none.wgsl").into()];
    }
    let textures = surface.textures();
    let mut text: Vec<Cow<'static, str>> = vec![include_str!("layers/base.wgsl").into()];
    if !textures.is_empty() {
        text.push(include_str!("layers/images.wgsl").into());
    }
    for texture in 0..textures.len().min(MOST_TEXTURES) {
        let binding = FIRST_TEXTURE + texture as u32;
        let image = include_str!("layers/image.wgsl");
        text.push(image.replace("TEXTURE", &texture.to_string()).replace("BINDING", &binding.to_string()).into());
    }
    text.push(include_str!("layers/begin.wgsl").into());
    if surface.relief.is_some() {
        text.push(include_str!("layers/formula.wgsl").into());
    }
    for (i, layer) in surface.layers.iter().enumerate() {
        let wanted = (layer.image, TextureKind::of(layer.slot));
        let Some(texture) = textures.iter().position(|t| *t == wanted).filter(|t| *t < MOST_TEXTURES) else { continue };
        let lines = match layer.slot {
            Slot::Color => include_str!("layers/color.wgsl"),
            Slot::Roughness => include_str!("layers/roughness.wgsl"),
            Slot::Metallic => include_str!("layers/metallic.wgsl"),
            Slot::Relief => include_str!("layers/relief.wgsl"),
        };
        text.push(lines.replace('#', &i.to_string()).replace("TEXTURE", &texture.to_string()).into());
    }
    text.push(include_str!("layers/end.wgsl").into());
    text
}
