//! Materials: their entries as nodes, and shapes that have them.

use super::elsewhere;
use super::load::{self, ItemRef};
use super::texture::Texture;
use super::value::Value;
use super::{Elaborated, Elaborator, Env, Stop};
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::{Exactness, NodeId, Material, MaterialId, Shape, ShapeId};
use crate::source::Span;
use crate::syntax::ast::{ItemKind, Type};
use std::sync::Arc;

/// The index of refraction of what light goes through, where it is not said: that of window glass.
const GLASS: f64 = 1.5;

/// The keys that a material knows.
pub const KEYS: [&str; 13] = [
    "color", "roughness", "metallic", "reflectivity", "emission", "bump", "bump_height", "texture",
    "texture_scale", "texture_sharpness", "solid", "transmission", "ior",
];

impl Elaborator<'_> {
    /// Warns of a colour that is written as bytes, or beyond what a surface can be.
    fn warn_of_bytes(&mut self, color: [NodeId; 3], at: Span) {
        let [Some(r), Some(g), Some(b)] = color.map(|c| self.graph.as_constant(c)) else { return };
        let all = [r, g, b];
        let Some(beyond) = all.into_iter().filter(|c| !(0.0..=2.0).contains(c)).reduce(f64::max) else { return };
        let are_bytes = all.iter().all(|c| (0.0..=255.0).contains(c) && c.fract() == 0.0);
        let hexadecimal: String = all.iter().map(|c| format!("{:02x}", *c as u8)).collect();
        let help = match are_bytes {
            true => format!("write `#{hexadecimal}`"),
            false => "write numbers from 0 to 1; what shines by itself has an `emission`".to_owned(),
        };
        let message = format!("the components of a colour go from 0 to 1, and one of these is {beyond}");
        let color = are_bytes.then(|| format!("#{hexadecimal}"));
        self.report(Diagnostic::new(Code::ColorBytes, at, message, help).write_if(at, color));
    }

    /// A material of a declaration and its arguments.
    pub fn make_material(
        &mut self,
        item: ItemRef,
        args: &[Option<Value>],
        span: Span,
    ) -> Elaborated<MaterialId> {
        self.called.insert(item);
        if self.materials.contains(&item) {
            let name = self.modules.item(item).and_then(load::item_name).map(|name| name.text.to_string()).unwrap_or_default();
            return Err(self.error(
                Code::TypeMismatch,
                span,
                format!("`{name}` is this material itself"),
                "write a colour in its place, as `#ffd700` or `(1, 0.7, 0)`",
            ));
        }
        self.materials.push(item);
        let made = self.for_user(item, span, |e| e.deeper(span, |e| e.material_of(item, args, span)));
        self.materials.pop();
        made
    }

    fn material_of(
        &mut self,
        item: ItemRef,
        args: &[Option<Value>],
        span: Span,
    ) -> Elaborated<MaterialId> {
        let modules = self.modules;
        let Some(declared) = modules.item(item) else { return Err(Stop) };
        let ItemKind::Material { name, parameters, lets, entries } = &declared.kind else {
            return Err(Stop);
        };
        let mut env = Env::top(item.module);
        for (i, parameter) in parameters.iter().enumerate() {
            let value = match (args.get(i).cloned().flatten(), &parameter.default) {
                (Some(value), _) => value,
                (None, Some(default)) => {
                    let value = self.expression(default, &env)?;
                    match &parameter.ty {
                        Some((ty, _)) => self.coerce(value, ty, default.span, &env)?,
                        None => value,
                    }
                }
                (None, None) => {
                    return Err(self.error(
                        Code::MissingArgument,
                        span,
                        format!("`{}` needs `{}`", name.text, parameter.name.text),
                        format!("write `{}(…)` with it", name.text),
                    ));
                }
            };
            env = env.and(&parameter.name.text, value);
        }
        let point = self.graph.point();
        env = Env { point: Some(point.into()), normal: true, ..env };
        let env = self.bind_lets(lets, &env)?;
        let default = self.default_material();
        let Some(mut material) = self.graph.materials.get(default.0 as usize).cloned() else {
            return Err(Stop);
        };
        material.name = name.text.clone();
        let mut texture = Texture::new(self);
        let (mut transmission, mut ior) = (None, None);
        let mut failed = false;
        for entry in entries {
            let key = &*entry.key.text;
            if !KEYS.contains(&key) {
                let near = elsewhere::key(key, &KEYS);
                let help = match near {
                    Some(near) => format!("did you mean `{near}`?"),
                    None if matches!(key, "opacity" | "alpha" | "transparent" | "transparency") => {
                        "write `transmission: 1` for glass, or a number between".to_owned()
                    }
                    None => format!("the keys of a material are {}", KEYS.join(", ")),
                };
                let said = Diagnostic::new(Code::UnknownKey, entry.key.span, format!("a material has no `{key}`"), help);
                self.report(said.write_if(entry.key.span, near));
                failed = true;
                continue;
            }
            let Ok(value) = self.expression(&entry.value, &env) else {
                failed = true;
                continue;
            };
            let at = entry.value.span;
            if texture.takes(key, &value) {
                failed |= texture.put(self, key, value, at, &env).is_err();
                continue;
            }
            let done = match key {
                "color" | "emission" => self.coerce(value, &Type::Color, at, &env).map(|v| {
                    if let Value::Vector(v) = v
                        && let [r, g, b] = *v
                    {
                        if key == "color" {
                            self.warn_of_bytes([r, g, b], at);
                            material.color = [r, g, b];
                        } else {
                            material.emission = [r, g, b];
                        }
                    }
                }),
                "roughness" | "metallic" | "reflectivity" | "transmission" | "ior" => {
                    self.to_number(&value, at, &env).and_then(|n| {
                        let (range, help) = match key {
                            "ior" => (1.0..=5.0, "write an index of refraction from 1 to 5: glass has 1.5, water 1.33, diamond 2.4"),
                            _ => (0.0..=1.0, "write a number from 0 to 1"),
                        };
                        if let Some(c) = self.graph.as_constant(n)
                            && !range.contains(&c)
                        {
                            return Err(self.error(Code::BadValue, at, format!("`{key}` is {c}"), help));
                        }
                        match key {
                            "transmission" => transmission = Some(n),
                            "ior" => ior = Some(n),
                            "roughness" => material.roughness = n,
                            "metallic" => material.metallic = n,
                            _ => material.reflectivity = n,
                        }
                        Ok(())
                    })
                }
                "solid" => self.coerce(value, &Type::Bool, at, &env).and_then(|v| {
                    if let Value::Bool(node) = v {
                        match self.graph.as_constant(node) {
                            Some(c) => material.solid = c != 0.0,
                            None => {
                                return Err(self.error(
                                    Code::NotConstant,
                                    at,
                                    "`solid` must be known while compiling",
                                    "write `on` or `off`",
                                ));
                            }
                        }
                    }
                    Ok(())
                }),
                _ => texture.put(self, key, value, at, &env),
            };
            failed |= done.is_err();
        }
        if failed {
            return Err(Stop);
        }
        let index = self.graph.constant(GLASS);
        material.glass = transmission.filter(|t| self.graph.as_constant(*t) != Some(0.0)).map(|t| [t, ior.unwrap_or(index)]);
        texture.lay_on(self, &mut material);
        Ok(self.graph.add_material(material))
    }

    /// What a shape without a material looks like.
    pub fn default_material(&mut self) -> MaterialId {
        let grey = self.graph.constant(0.55);
        let zero = self.graph.constant(0.0);
        let roughness = self.graph.constant(0.6);
        self.graph.add_material(Material {
            name: "default".into(),
            color: [grey; 3],
            emission: [zero; 3],
            roughness,
            metallic: zero,
            reflectivity: zero,
            glass: None,
            relief: None,
            images: Arc::default(),
            solid: true,
        })
    }

    /// A shape with a material, or painted with one where `mask` is negative.
    pub fn with_material(
        &mut self,
        shape: ShapeId,
        mask: Option<ShapeId>,
        material: MaterialId,
        span: Span,
    ) -> Value {
        let dimensions = self.graph.dimensions(shape);
        let point = self.graph.point();
        let value = self.graph.field(shape, point);
        let (own, paints) = match mask {
            None => (Some(material), Arc::default()),
            Some(mask) => (None, [(mask, material)].into()),
        };
        Value::Shape(self.graph.add_shape(Shape {
            name: None,
            dimensions,
            value,
            variables: Arc::default(),
            exactness: Exactness::Formula,
            material: own,
            paints,
            span: self.place(span),
        }))
    }
}
