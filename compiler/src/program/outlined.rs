//! Drawings with outlines of curves: words, paths and logos.

use super::load::join;
use super::value::Value;
use super::{Elaborated, Elaborator, Env};
use crate::analysis::Box3;
use crate::diagnostic::Code;
use crate::graph::interval::Interval;
use crate::graph::{Claim, ClaimGroup, Leaf, Node, ValueRange};
use crate::kept::Kept;
use crate::outline::{Align, Fill, MOST_CURVES, MOST_SVG, Outline, Piece, Refused, Typesetting, boundary, path, svg, typeset};
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
        match boundary(&contours, Fill::NonZero) {
            Ok(pieces) => self.outline(pieces, span),
            Err(why) => Err(self.error(Code::TooLarge, data.1, format!("this path is too much: {why}"), "draw it with fewer curves, or write several paths")),
        }
    }

    /// `svg("logo.svg", size)`.
    #[inline(never)]
    pub(super) fn svg(&mut self, file: &(Value, Span), size: &(Value, Span), span: Span, env: &Env) -> Elaborated<Value> {
        let name = self.words(file, "svg(\"logo.svg\")")?;
        let height = self.to_constant(&size.0, size.1)?;
        if height < 0.0 {
            return Err(self.error(Code::BadValue, size.1, "the size of a drawing is above zero", "write its height, `size: 1`, or no size for its own lengths"));
        }
        let path = join(self.modules.path(env.module), &name.replace('\\', "/"));
        let bytes = match self.grids.bytes(&path, MOST_SVG) {
            Ok(bytes) => bytes,
            Err(why) => {
                let words = format!("the drawing `{path}` can't be read: {why}");
                return Err(self.error(Code::BrokenFile, file.1, words, "write the path of an SVG file, relative to this file"));
            }
        };
        let place = |(line, column): (u32, u32)| format!("`{path}`, line {line}, column {column}");
        match svg(&bytes, (height > 0.0).then_some(height)) {
            Ok(logo) => {
                if let Some(at) = logo.line_only {
                    let words = format!("{}: a shape that has a stroke and no fill is left out", place(at));
                    self.warn(Code::LeftOut, file.1, words, "turn strokes into paths in the program that drew it (in Inkscape: Path, Stroke to Path)");
                }
                self.outline(logo.pieces, span)
            }
            Err(Refused { at, message, help }) => {
                let words = format!("this drawing can't be used: {}: {message}", at.map_or(format!("`{path}`"), place));
                Err(self.error(Code::BrokenFile, file.1, words, help))
            }
        }
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
            let words = format!("the texts, paths and logos of this scene take {} MiB, and a device reads {} at most", bytes >> 20, MOST_DEVICE_BYTES >> 20);
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
