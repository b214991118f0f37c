//! Cameras, as the text has them.

use super::{Elaborated, Elaborator, Env, Stop};
use crate::blocks::CameraNodes;
use crate::diagnostic::Code;
use crate::graph::NodeId;
use crate::camera::{EYE, FOV};
use crate::source::Span;
use crate::syntax::ast::{Entry, Expr, ExprKind};
use rustc_hash::FxHashMap;

impl Elaborator<'_> {
    /// The entries of a camera.
    pub(super) fn camera(&mut self, name: String, kind_span: Span, seen: &FxHashMap<&str, &Entry>, env: &Env) -> Elaborated<CameraNodes> {
        let entry = |key: &str| seen.get(key).map(|e| &e.value);
        let mut place = |key| entry(key).map(|given| self.vec3_entry(Some(given), env, [0.0; 3])).transpose();
        let (eye, target, up) = (place("eye"), place("target"), place("up"));
        let fov = self.number_entry(entry("fov"), env, FOV, Some((0.01, 3.0)), "an angle between 1deg and 170deg");
        let mut number = |key, least, wanted| {
            entry(key).map(|given| self.number_entry(Some(given), env, 0.0, Some((least, f64::INFINITY)), wanted)).transpose()
        };
        let positive = "a length greater than zero";
        let height = number("height", 1e-6, positive);
        let lens = number("lens", 0.0, "the radius of the lens, at least zero");
        let focus = number("focus", 1e-6, positive);
        let orthographic = entry("projection").map_or(Ok(false), |given| self.projection(given));
        let (eye, target, up) = (eye?, target?, up?);
        let constants = |given: Option<[NodeId; 3]>, usual: [f64; 3]| match given {
            Some(nodes) => nodes.map(|node| self.graph.as_constant(node).unwrap_or(f64::NAN)),
            None => usual,
        };
        let (from, to) = (constants(eye, EYE), constants(target, [0.0; 3]));
        if from.iter().zip(&to).all(|(a, b)| (a - b).abs() < 1e-9) {
            return Err(self.error(
                Code::BadValue,
                entry("target").or(entry("eye")).map_or(kind_span, |e| e.span),
                "the camera looks at the place where it stands, so it has no direction",
                "write another `target`: the point that shall be in the middle of the picture",
            ));
        }
        if let (Some(given), true) = (entry("up"), constants(up, [1.0; 3]) == [0.0; 3]) {
            return Err(self.error(Code::BadValue, given.span, "a direction of length zero points nowhere", "write what is up in the picture, for example `(0, 1, 0)`"));
        }
        let orthographic = orthographic?;
        if let (Some(given), false) = (entry("height"), orthographic) {
            let help = "write `projection: orthographic` too, or `fov` for an angle";
            return Err(self.error(Code::BadValue, given.span, "only an orthographic picture has a height", help));
        }
        Ok(CameraNodes { name, eye, target, fov: fov?, up, orthographic, height: height?, lens: lens?, focus: focus?, span: kind_span })
    }

    /// Whether rays go side by side.
    fn projection(&mut self, expr: &Expr) -> Elaborated<bool> {
        match &expr.kind {
            ExprKind::Hole => Err(Stop),
            ExprKind::Name(name) if name == "orthographic" => Ok(true),
            ExprKind::Name(name) if name == "perspective" => Ok(false),
            _ => Err(self.error(Code::BadValue, expr.span, "this is no projection", "write `perspective` or `orthographic`")),
        }
    }
}
