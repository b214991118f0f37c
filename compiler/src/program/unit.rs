//! What a unit of the scene is, and lengths that are written with a unit.

use super::value::Value;
use super::{Elaborated, Elaborator, Stop};
use crate::diagnostic::Code;
use crate::source::Span;
use crate::syntax::ast::{BlockKind, Expr, ExprKind, ItemKind};
use crate::unit::Unit;

impl Elaborator<'_> {
    /// The unit that a text's `render` says. It is read before all else: every length needs it.
    pub(super) fn scene_unit(&mut self, module: usize) -> Option<Unit> {
        let modules = self.modules;
        let render = modules.items(module).find_map(|(_, item)| match &item.kind {
            ItemKind::Block { kind: BlockKind::Render, entries, .. } => Some(entries),
            _ => None,
        });
        let value = &render?.iter().find(|entry| *entry.key.text == *"unit")?.value;
        let known = match &value.kind {
            ExprKind::Name(name) => Unit::named(name),
            _ => None,
        };
        if known.is_none() && value.kind != ExprKind::Hole {
            self.error(Code::BadValue, value.span, "this is no unit of length", format!("the units are {}: `render {{ unit: mm }}`", Unit::NAMES));
        }
        // Where it is an error, lengths shall not be errors too.
        Some(known.unwrap_or(Unit::Mm))
    }

    /// A length in units of the scene.
    pub(super) fn written_with(&mut self, value: f64, unit: Unit, span: Span) -> Elaborated<Value> {
        let Some(of_scene) = self.unit else {
            let name = unit.name();
            // Once is enough.
            if self.diagnostics.iter().any(|d| d.code == Code::NoUnit) {
                return Err(Stop);
            }
            return Err(self.error(
                Code::NoUnit,
                span,
                format!("`{value}{name}` is a length, and the scene does not say what its unit is"),
                format!("write `render {{ unit: {name} }}`, or the number alone"),
            ));
        };
        let length = unit.to(of_scene, value);
        if !(length as f32).is_finite() {
            return Err(self.error(Code::NumberForm, span, "this number is too large", "numbers go up to 3.4e38 units of the scene, as those of the GPU do"));
        }
        Ok(Value::number(self.graph.constant(length)))
    }

    /// The first unit of a length in a parameter's value or range, and how many units of the scene it is.
    pub(super) fn written_length(&self, exprs: [Option<&Expr>; 2]) -> Option<(Unit, f64)> {
        let unit = exprs.into_iter().flatten().find_map(unit_in)?;
        Some((unit, unit.to(self.unit?, 1.0)))
    }
}

fn unit_in(expr: &Expr) -> Option<Unit> {
    match &expr.kind {
        ExprKind::Length(_, unit) => Some(*unit),
        ExprKind::Range(a, b) => unit_in(a).or_else(|| unit_in(b)),
        ExprKind::Unary(_, a) | ExprKind::Paren(a) => unit_in(a),
        ExprKind::Vector(parts) => parts.iter().find_map(unit_in),
        _ => None,
    }
}
