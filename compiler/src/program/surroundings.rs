//! What surrounds a scene: the sky, the images that stand for it, and how often it is mirrored.

use super::load::join;
use super::value::Value;
use super::{Elaborated, Elaborator, Env};
use crate::blocks::{CAPTURE_SIZES, CaptureNodes, SceneBlocks};
use crate::frame::MAX_BOUNCES;
use crate::diagnostic::Code;
use crate::graph::NodeId;
use crate::images::{EnvironmentFile, EnvironmentKind};
use crate::source::ImageFile;
use crate::source::Span;
use crate::syntax::ast::{Expr, ExprKind, Type};

impl Elaborator<'_> {
    /// A colour, `gradient(zenith, horizon)`, `cubemap("folder/")` or `equirect("file")`.
    pub(super) fn sky(&mut self, expr: &Expr, env: &Env, blocks: &mut SceneBlocks) -> Elaborated<()> {
        if let ExprKind::Str(file) = &expr.kind {
            return Err(self.error(
                Code::TypeMismatch,
                expr.span,
                "a sky is a colour, a gradient or a picture, and this is a name alone",
                format!("write `equirect(\"{file}\")` for a picture of all around, or `cubemap(\"{file}\")` for a folder of six"),
            ));
        }
        if let ExprKind::Call(callee, args) = &expr.kind
            && let ExprKind::Name(name) = &callee.kind
        {
            match (name.as_str(), args.as_slice()) {
                ("gradient", [zenith, horizon]) => {
                    let zenith = self.color_entry(Some(&zenith.value), env, [0.0; 3]);
                    let horizon = self.color_entry(Some(&horizon.value), env, [0.0; 3]);
                    blocks.sky = Some((zenith?, horizon?));
                    return Ok(());
                }
                ("gradient", _) => {
                    return Err(self.error(
                        Code::MissingArgument,
                        expr.span,
                        "`gradient` needs two colours",
                        "write `gradient(#87a7d0, #e8eef5)`: straight up, and at the horizon",
                    ));
                }
                ("cubemap" | "equirect", [file]) => {
                    let kind = if name == "cubemap" { EnvironmentKind::Cubemap } else { EnvironmentKind::Equirect };
                    let value = self.expression(&file.value, env)?;
                    let file = self.image_file(&value, name, env, file.value.span)?;
                    blocks.environment = Some(EnvironmentFile { kind, file });
                    return Ok(());
                }
                ("cubemap" | "equirect", _) => {
                    return Err(self.error(
                        Code::MissingArgument,
                        expr.span,
                        format!("`{name}` needs one name"),
                        "write `cubemap(\"sky/\")`, a folder, or `equirect(\"sky.hdr\")`, a file",
                    ));
                }
                _ => {}
            }
        }
        let color = self.color_entry(Some(expr), env, [0.0; 3])?;
        blocks.sky = Some((color, color));
        Ok(())
    }

    /// The file that a text names, relative to the file in which it stands.
    pub(super) fn image_file(&mut self, value: &Value, what: &str, env: &Env, span: Span) -> Elaborated<ImageFile> {
        match value {
            Value::Text(name) if !name.trim().is_empty() => {
                let from = self.modules.path(env.module);
                Ok(ImageFile { path: join(from, &name.replace('\\', "/")), span })
            }
            other => {
                let found = other.describe(&self.graph);
                Err(self.error(
                    Code::TypeMismatch,
                    span,
                    format!("the name of a file is needed here, and this is {found}"),
                    format!("write `{what}(\"sky\")`"),
                ))
            }
        }
    }

    /// From where the scene itself is drawn for what mirrors it, and how many pixels a side of its faces has.
    pub(super) fn capture(&mut self, place: Option<&Expr>, size: Option<&Expr>, env: &Env) -> Elaborated<Option<CaptureNodes>> {
        let Some(place) = place else {
            return match size {
                Some(size) => Err(self.error(
                    Code::MissingArgument,
                    size.span,
                    "`size` is that of a `capture`, and there is none",
                    "write `capture: (0, 1, 0), size: 256`: from where the scene is drawn for what mirrors it",
                )),
                None => Ok(None),
            };
        };
        let place = self.vec3_entry(Some(place), env, [0.0; 3]);
        let Some(expr) = size else { return Ok(Some(CaptureNodes { place: place?, size: 256 })) };
        let value = self.expression(expr, env)?;
        let wanted = self.to_constant(&value, expr.span)?;
        match CAPTURE_SIZES.into_iter().find(|size| f64::from(*size) == wanted) {
            Some(size) => Ok(Some(CaptureNodes { place: place?, size })),
            None => Err(self.error(
                Code::BadValue,
                expr.span,
                format!("the `size` of a capture is {wanted}"),
                format!("write how many pixels a side of its faces has: one of {}", CAPTURE_SIZES.map(|s| s.to_string()).join(", ")),
            )),
        }
    }

    /// How often a mirrored ray is followed.
    pub(super) fn reflections(&mut self, expr: &Expr, env: &Env) -> Elaborated<NodeId> {
        let value = self.expression(expr, env)?;
        let value = self.coerce(value, &Type::Int, expr.span, env)?;
        let node = self.to_number(&value, expr.span, env)?;
        let most = f64::from(MAX_BOUNCES);
        if let Some(c) = self.graph.as_constant(node)
            && !(0.0..=most).contains(&c)
        {
            return Err(self.error(
                Code::BadValue,
                expr.span,
                format!("this is {c}"),
                format!("write how often a ray is mirrored, a whole number from 0 to {MAX_BOUNCES}"),
            ));
        }
        Ok(node)
    }
}
