//! The images of a material, and its relief.

use super::value::Value;
use super::{Elaborated, Elaborator, Env};
use crate::diagnostic::Code;
use crate::graph::{Material, MaterialImage, NodeId, Slot};
use crate::source::ImageFile;
use crate::source::Span;

/// What a material says of images while its entries are read.
pub(super) struct Texture {
    images: Vec<(Slot, ImageFile)>,
    relief: Option<NodeId>,
    scale: NodeId,
    sharpness: NodeId,
    height: NodeId,
    has_color: bool,
}

impl Texture {
    /// None yet.
    pub fn new(e: &mut Elaborator<'_>) -> Self {
        let [scale, sharpness, height] = [1.0, 2.0, 0.05].map(|c| e.graph.constant(c));
        Self { images: Vec::new(), relief: None, scale, sharpness, height, has_color: false }
    }

    /// Whether an entry is an image's name in place of a formula.
    pub fn takes(&mut self, key: &str, value: &Value) -> bool {
        let is_text = matches!(value, Value::Text(_));
        self.has_color |= key == "color" && !is_text;
        is_text && matches!(key, "color" | "roughness" | "metallic")
    }

    /// Reads an entry.
    pub fn put(&mut self, e: &mut Elaborator<'_>, key: &str, value: Value, at: Span, env: &Env) -> Elaborated<()> {
        match (key, &value) {
            ("color" | "texture" | "roughness" | "metallic" | "bump", Value::Text(_)) => {
                let file = e.image_file(&value, key, env, at)?;
                let slot = match key {
                    "roughness" => Slot::Roughness,
                    "metallic" => Slot::Metallic,
                    "bump" => Slot::Relief,
                    _ => Slot::Color,
                };
                if self.images.iter().any(|(known, _)| *known == slot) {
                    return Err(e.error(Code::TwiceDeclared, at, "this material has such an image already", "delete one of them"));
                }
                self.images.push((slot, file));
            }
            ("bump", Value::Number(height, _)) => self.relief = Some(*height),
            ("texture_scale" | "texture_sharpness" | "bump_height", Value::Number(n, _)) => {
                let positive = key != "bump_height";
                if let Some(c) = e.graph.as_constant(*n).filter(|c| positive && *c <= 0.0) {
                    return Err(e.error(Code::BadValue, at, format!("`{key}` is {c}"), "write a number greater than zero"));
                }
                match key {
                    "texture_scale" => self.scale = *n,
                    "texture_sharpness" => self.sharpness = *n,
                    _ => self.height = *n,
                }
            }
            _ => {
                let found = value.describe(&e.graph);
                let help = match key {
                    "texture_scale" | "texture_sharpness" | "bump_height" => "write a number",
                    "bump" => "write a formula of a height, or the name of an image file, for example \"stone.png\"",
                    _ => "write the name of an image file, for example \"stone.png\"",
                };
                return Err(e.error(Code::TypeMismatch, at, format!("`{key}` can't be {found}"), help));
            }
        }
        Ok(())
    }

    /// Gives the material its images: what they say takes the place of what the formulas would.
    pub fn lay_on(self, e: &mut Elaborator<'_>, material: &mut Material) {
        let [zero, one] = [0.0, 1.0].map(|c| e.graph.constant(c));
        material.relief = self.relief;
        let mut images = Vec::new();
        for (slot, file) in self.images {
            let weight = match slot {
                // A colour beside the image tints it.
                Slot::Color => {
                    let tint = if self.has_color { material.color } else { [one; 3] };
                    material.color = [zero; 3];
                    tint
                }
                Slot::Roughness => {
                    material.roughness = zero;
                    [one; 3]
                }
                Slot::Metallic => {
                    material.metallic = zero;
                    [one; 3]
                }
                Slot::Relief => [self.height; 3],
            };
            let known = e.graph.images.iter().position(|known| known.path == file.path);
            let image = known.unwrap_or_else(|| {
                e.graph.images.push(file);
                e.graph.images.len() - 1
            }) as u32;
            images.push(MaterialImage { image, slot, weight, scale: self.scale, sharpness: self.sharpness });
        }
        material.images = images.into();
    }
}
