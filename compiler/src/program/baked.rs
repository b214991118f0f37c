//! `s.baked(128)`: a shape that is sampled while it is compiled, and then read from its grid.

use super::value::Value;
use super::{Elaborated, Elaborator, Env};
use crate::analysis::{Box3, Sampled};
use crate::diagnostic::Code;
use crate::evaluate::Tape;
use crate::graph::{Baked, Graph, Leaf, Node, NodeId, Opened, Shape, ShapeId};
use crate::live::Live;
use crate::kept::Kept;
use crate::sampled::{Settings, compare, sample};
use crate::source::Span;
use rustc_hash::FxHashSet;
use std::sync::Arc;

/// A formula of more operations is too long to be sampled.
const LARGEST: usize = 1_000_000;
/// What is solid farther out has no end, for a grid.
const ENDLESS: f64 = 1e4;

impl Elaborator<'_> {
    /// `s.baked(resolution, padding)`.
    pub(super) fn baked(&mut self, (id, at): (ShapeId, Span), settings: Settings, span: Span, env: &Env) -> Elaborated<Value> {
        let Some(shape) = self.graph.shape(id).cloned() else { return Err(super::Stop) };
        if shape.dimensions != 3 {
            return Err(self.error(Code::TypeMismatch, at, "a solid is baked, and this is a drawing", "make a solid of it first: `s.extrude(1).baked()`"));
        }
        if !shape.variables.is_empty() || is_live(&self.graph, shape.value) {
            let words = "what is baked is sampled while compiling, and this depends on a `param`, on `time`, on `world` or on what stands around it";
            return Err(self.error(Code::NotConstant, at, words, "bake what stays as it is, and move that: `s.baked().rotate(y, time)`"));
        }
        let graph = &mut self.graph;
        let region = self.facts.closer_and_closer(|facts, within| facts.body_region(graph, id, &|_| None, within), Box3::cube(ENDLESS));
        let sides = [0, 1, 2].map(|i| region.axis(i));
        if sides.iter().any(|side| side.is_empty()) {
            return Err(self.error(Code::BadValue, at, "nothing of it is solid", "bake a shape"));
        }
        if sides.iter().any(|side| side.lo <= -ENDLESS || side.hi >= ENDLESS) {
            let words = "what is solid of it has no end that is known, and a grid has one";
            return Err(self.error(Code::BadValue, at, words, "cut it off first: `s.within(box(4)).baked()`"));
        }
        let bounds = [sides.map(|side| side.lo), sides.map(|side| side.hi)];
        let key = self.facts.sampling(&self.graph, shape.value, (settings.resolution, settings.padding.to_bits()), bounds);
        let known = self.facts.sampled(key);
        let tape = Tape::new(&self.graph, &Opened::default(), &[shape.value], &Live::start(&self.graph), LARGEST);
        let Ok(tape) = tape else {
            return Err(self.error(Code::TooLarge, at, format!("its formula has more than {LARGEST} operations"), "bake parts of it"));
        };
        let values = |places: &[[f64; 3]]| {
            let mut all = vec![0.0; places.len()];
            let mut slots = all.iter_mut();
            tape.evaluator().at(places, &[], |_, value| {
                if let (Some(slot), Some(value)) = (slots.next(), value.first()) {
                    *slot = *value;
                }
            });
            all
        };
        let found = match known {
            Some(found) => found,
            None => {
                let grid = sample(bounds, settings, &values).map_err(|why| self.error(Code::TooLarge, span, format!("it can't be baked: {why}"), "write a lower resolution"))?;
                let found = Sampled { off: compare(&grid, &values), grid: Arc::new(grid) };
                self.facts.keep_sampled(key, found.clone());
                found
            }
        };
        let baked = Baked { span: self.place(span), bricks: found.grid.shape().bricks, off: found.off, operations: tape.operations() };
        if !self.graph.baked.contains(&baked) {
            self.graph.baked.push(baked);
        }
        let whole = self.sampled_shape(&Kept::new(found.grid), span, env)?;
        let Value::Shape(read) = whole else { return Ok(whole) };
        // What it looks like is said by formulas of the same space.
        let Some(like) = self.graph.shape(read).cloned() else { return Ok(whole) };
        Ok(Value::Shape(self.graph.add_shape(Shape { material: shape.material, paints: shape.paints, ..like })))
    }
}

/// Whether a value depends on more than its point.
fn is_live(graph: &Graph, value: NodeId) -> bool {
    let (mut open, mut seen) = (vec![value], FxHashSet::default());
    while let Some(formula) = open.pop() {
        for id in graph.reachable(&[formula]) {
            match graph.node(id) {
                Node::Leaf(Leaf::Time | Leaf::Parameter(_)) => return true,
                Node::Call(shape, ..) if seen.insert(*shape) => open.extend(graph.shape(*shape).map(|s| s.value)),
                _ => {}
            }
        }
    }
    false
}
