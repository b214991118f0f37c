//! Drawings with outlines of curves: words and paths.

use super::load::join;
use super::value::Value;
use super::{Elaborated, Elaborator, Env};
use crate::analysis::Box3;
use crate::diagnostic::Code;
use crate::graph::interval::Interval;
use crate::graph::{Claim, ClaimGroup, Leaf, Node, ValueRange};
use crate::kept::Kept;
use crate::outline::{Align, Fill, MOST_CURVES, Outline, Piece, Typesetting, boundary, path, typeset};
use crate::sampled::MOST_DEVICE_BYTES;
use crate::source::Span;
use std::sync::Arc;

/// Bytes of the largest font that is read.
const MOST_FONT: u64 = 64 << 20;
const ALIGNS: [(&str, Align); 3] = [("left", Align::Left), ("center", Align::Center), ("right", Align::Right)];

// Calls of built-in functions nest. These are kept out of line, so that their room on the stack is not taken at each level.
impl Elaborator<'_> {
    /// `text("words", size, font, align, spacing, leading)`.
    #[inline(never)]
    pub(super) fn text(&mut self, args: [&(Value, Span); 6], span: Span, env: &Env) -> Elaborated<Value> {
        let [words, size, font, align, spacing, leading] = args;
        let (said, at) = (self.words(words, "text(\"Surefoot\")")?, words.1);
        let name = self.words(align, "align: \"center\"")?;
        let Some((_, align)) = ALIGNS.into_iter().find(|(word, _)| *word == &*name) else {
            let words = format!("there is no alignment `{name}`");
            return Err(self.error(Code::BadValue, align.1, words, "write `\"left\"`, `\"center\"` or `\"right\"`"));
        };
        let height = self.to_constant(&size.0, size.1)?;
        if height <= 0.0 {
            return Err(self.error(Code::BadValue, size.1, "the size of a text is above zero", "write a height, `size: 1`"));
        }
        let setting = Typesetting { size: height, align, spacing: self.to_constant(&spacing.0, spacing.1)?, leading: self.to_constant(&leading.0, leading.1)? };
        let file = self.words(font, "font: \"Name.ttf\"")?;
        let bytes = if file.is_empty() {
            None
        } else {
            let path = join(self.modules.path(env.module), &file.replace('\\', "/"));
            match self.grids.bytes(&path, MOST_FONT) {
                Ok(bytes) => Some(bytes),
                Err(why) => {
                    let words = format!("the font `{path}` can't be read: {why}");
                    return Err(self.error(Code::BrokenFile, font.1, words, "write the path of a TrueType or OpenType font, relative to this file"));
                }
            }
        };
        match typeset(&said, bytes.as_deref(), &setting) {
            Ok(pieces) => self.outline(pieces, span),
            Err(why) => Err(self.error(Code::BadValue, at, format!("this text can't be set: {why}"), "write other words, or name a font that has these letters, `font: \"Name.ttf\"`")),
        }
    }

    /// `path("M 0 0 L 1 0 …")`.
    #[inline(never)]
    pub(super) fn path(&mut self, data: &(Value, Span), span: Span) -> Elaborated<Value> {
        let said = self.words(data, "path(\"M 0 0 H 1 V 1 Z\")")?;
        let contours = path(&said).map_err(|why| {
            let words = format!("this is no path data: {why}");
            self.error(Code::BadValue, data.1, words, "write what the attribute `d` of a path has in SVG: `M 0 0 H 1 V 1 Z`")
        })?;
        let count: usize = contours.iter().map(Vec::len).sum();
        if count > MOST_CURVES {
            let words = format!("a path has {MOST_CURVES} curves at most, and this one has {count}");
            return Err(self.error(Code::TooLarge, data.1, words, "draw it with fewer curves, or write several paths"));
        }
        self.outline(boundary(&contours, Fill::NonZero), span)
    }

    /// A text among arguments.
    #[inline(never)]
    fn words(&mut self, (value, span): &(Value, Span), example: &str) -> Elaborated<std::rc::Rc<str>> {
        if let Value::Text(words) = value {
            return Ok(words.clone());
        }
        let found = value.describe(&self.graph);
        Err(self.error(Code::TypeMismatch, *span, format!("a text is needed here, and this is {found}"), format!("write it between quotes: `{example}`")))
    }

    /// The drawing that pieces of an outline bound.
    #[inline(never)]
    fn outline(&mut self, pieces: Vec<Piece>, span: Span) -> Elaborated<Value> {
        let Some(outline) = Outline::new(pieces) else { return Ok(Value::Nothing) };
        let kept = Kept::new(Arc::new(outline));
        let bytes: usize = self.graph.outlines.iter().map(|known| known.data.bytes()).sum::<usize>() + kept.data.bytes();
        if bytes > MOST_DEVICE_BYTES {
            let words = format!("the texts and paths of this scene take {} MiB, and a device reads {} at most", bytes >> 20, MOST_DEVICE_BYTES >> 20);
            return Err(self.error(Code::TooLarge, span, words, "write fewer letters, or fewer curves"));
        }
        let [x, y, _] = self.graph.point();
        let value = self.graph.outlined(&kept, [x, y]);
        let steepest = self.graph.leaf(Leaf::Variable(0));
        let claim = Claim::Lipschitz(steepest, [ClaimGroup::Vector(2)].into(), None::<ValueRange>);
        let claimed = self.graph.intern(Node::Claim([value, x, y].into(), claim));
        let [low, high] = kept.data.bounds();
        let side = |i: f64, j: f64| Interval::new(i, j);
        self.facts.know_solid(claimed, Box3([side(low[0], high[0]), side(low[1], high[1]), Interval::ALL]));
        Ok(Value::Shape(self.formula_shape(claimed, 2, None, false, span)))
    }
}
