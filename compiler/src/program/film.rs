//! What stands between the scene's light and a screen: fog, bloom and the tone curve.

use super::{Elaborated, Elaborator, Env, Stop};
use crate::blocks::{SceneBlocks, Tone};
use crate::diagnostic::Code;
use crate::graph::NodeId;
use crate::syntax::ast::{Entry, Expr, ExprKind};
use rustc_hash::FxHashMap;

/// Names of tone curves.
const TONES: [(&str, Tone); 4] = [("aces", Tone::Aces), ("agx", Tone::Agx), ("neutral", Tone::Neutral), ("none", Tone::None)];

impl Elaborator<'_> {
    /// The entries of `render` about it.
    pub(super) fn film(&mut self, seen: &FxHashMap<&str, &Entry>, env: &Env, blocks: &mut SceneBlocks) -> Elaborated<()> {
        let entry = |key: &str| seen.get(key).map(|e| &e.value);
        let tone = entry("tone").map(|expr| self.tone(expr)).transpose();
        let fog = entry("fog").map(|expr| self.fog(expr, env)).transpose();
        let bloom = entry("bloom").map(|expr| self.number_entry(Some(expr), env, 0.0, Some((0.0, 1.0)), "the share of light that is scattered, from 0 to 1"));
        let bloom = bloom.transpose();
        blocks.tone = tone?.unwrap_or_default();
        blocks.fog = fog?;
        blocks.bloom = bloom?;
        Ok(())
    }

    fn tone(&mut self, expr: &Expr) -> Elaborated<Tone> {
        let name = match &expr.kind {
            ExprKind::Hole => return Err(Stop),
            ExprKind::Name(name) => name.as_str(),
            _ => "",
        };
        match TONES.into_iter().find(|(known, _)| *known == name) {
            Some((_, tone)) => Ok(tone),
            None => Err(self.error(Code::BadValue, expr.span, "this is no tone curve", "write `aces`, `agx`, `neutral` or `none`")),
        }
    }

    /// A colour and a density.
    fn fog(&mut self, expr: &Expr, env: &Env) -> Elaborated<([NodeId; 3], NodeId)> {
        match &expr.kind {
            ExprKind::Hole => Err(Stop),
            ExprKind::Vector(parts) if let [color, density] = parts.as_slice() => {
                let color = self.color_entry(Some(color), env, [0.0; 3]);
                let density = self.number_entry(Some(density), env, 0.0, Some((0.0, f64::INFINITY)), "a density of at least zero");
                Ok((color?, density?))
            }
            _ => Err(self.error(
                Code::TypeMismatch,
                expr.span,
                "fog is a colour and a density",
                "write `(#cfd8e0, 0.05)`: at 0.05 a third of the light of what is 20 away arrives",
            )),
        }
    }
}
