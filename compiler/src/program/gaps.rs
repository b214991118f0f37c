//! Whether something reads a repetition's value where it is only a cap.
//!
//! Near no copy that is looked at the value is what any other copy is at least. The solid of the repetition does not depend on it, but one that
//! is rounded or blended by more than the cap does: it would grow into the gaps between sparse copies. So the surface of what reads the value is
//! looked for at some places, with the cap and with a higher one. Where they differ, the repetition looks as far as it is read.

use crate::analysis::{Box3, Domain};
use crate::diagnostic::{Code, Diagnostic};
use crate::evaluate::{Evaluator, LANES, Lanes, Tape, lanes};
use crate::graph::kernel::Op;
use crate::graph::{Claim, FAR, Function, Graph, Leaf, Node, NodeId, ParameterComponent, ShapeId};
use crate::live::Live;
use crate::program::Elaborator;
use crate::program::capped::Capped;
use crate::source::Span;
use rustc_hash::{FxHashMap, FxHashSet};

/// At so many places is it found what is solid.
const PLACES: usize = 1024;
/// So many places of the surface are looked at.
const PAIRS: usize = 128;
/// A place of the surface is between two places, halved so often.
const HALVINGS: usize = 20;
/// How far a cap has to be raised is found within a hundredth of it, by so many halvings.
const NARROWED: usize = 5;
/// Formulas of more operations are not asked.
const LARGEST: usize = 20_000;
/// A value that is so much of the least cap away from the surface is not at the surface; and one that differs by so much is another.
const NEAR: f64 = 0.1;
const OTHER: f64 = 0.01;
/// So many operations may the looks at all surfaces take; what is left is read as it is.
const MOST: usize = 100_000_000;
/// What moves is looked at at these times too, in seconds.
const TIMES: [f64; 4] = [0.7, 1.9, 3.1, 4.7];
/// With a higher cap there is another surface: so often is it looked for.
const ROUNDS: usize = 3;

impl Elaborator<'_> {
    /// Remembers that a repetition's `value` is the lesser of the `nearest` copies and of a cap, which is nowhere below `least`.
    pub(super) fn note_capped(&mut self, value: NodeId, nearest: NodeId, cap: NodeId, least: f64, span: Span) {
        if value != nearest && value != cap {
            self.capped.push(Capped { value, nearest, cap, least, place: self.place(span) });
        }
    }

    /// How far a repetition is read, where that is farther than it looks by itself.
    pub(super) fn level_read(&self, span: Span) -> Option<f64> {
        self.read_up_to.get(&self.place(span)).copied()
    }

    /// Says that a repetition is read farther than it can look.
    pub(super) fn say_too_far(&mut self, level: f64, least: f64, span: Span) {
        self.report(Diagnostic::new(
            Code::Gaps,
            span,
            format!("these copies are rounded or blended by {level:.1}, and those farther away than {least:.1} can't be looked at: the gaps between them fill up"),
            "make the cells larger, round or blend by less, or round the shape inside the braces",
        ));
    }

    /// How far each repetition of a scene is read, by its place; only those that are read farther than they look.
    pub(super) fn read_in_gaps(&mut self, root: ShapeId) -> FxHashMap<Span, f64> {
        let mut levels = FxHashMap::default();
        if self.capped.is_empty() {
            return levels;
        }
        let lesser: FxHashMap<NodeId, [NodeId; 2]> = self.capped.iter().map(|c| (c.value, [c.nearest, c.cap])).collect();
        let start = Live::start(&self.graph);
        let all = |end: fn(&ParameterComponent) -> f64| Live { components: self.graph.parameters.iter().map(end).collect(), ..start.clone() };
        let ends = [all(|p| p.min), all(|p| p.max)];
        let later = TIMES.map(|time| Live { time, ..start.clone() });
        let mut ran = 0;
        for reader in readers(&self.graph, root, &lesser) {
            if ran > MOST {
                break;
            }
            let inside = inside(&self.graph, reader);
            let least = self.capped.iter().filter(|c| inside.contains(&c.value)).fold(FAR, |least, c| least.min(c.least));
            let region = self.facts.rough_region(&self.graph, reader, &Domain::of(Box3::cube(self.extent)));
            let reads = |wanted: fn(&Leaf) -> bool| inside.iter().any(|&id| matches!(self.graph.node(id), Node::Leaf(leaf) if wanted(leaf)));
            let ends = ends.iter().filter(|_| reads(|leaf| matches!(leaf, Leaf::Parameter(_))));
            let later = later.iter().filter(|_| reads(|leaf| *leaf == Leaf::Time));
            let mut level: f64 = 0.0;
            for live in std::iter::once(&start).chain(ends).chain(later) {
                let Ok(tape) = Tape::raising(&self.graph, reader, live, LARGEST, &lesser) else { continue };
                let mut look = Reader { eval: tape.evaluator(), least, ran };
                level = level.max(look.level(&region));
                ran = look.ran;
            }
            for capped in self.capped.iter().filter(|c| c.least < level && inside.contains(&c.value)) {
                let known = levels.entry(capped.place).or_insert(level);
                *known = level.max(*known);
            }
        }
        levels
    }
}

/// The nodes under a scene's root that read one of some values otherwise than by leasts and greatests, under which its zero set stays: the
/// topmost of each.
fn readers(graph: &Graph, root: ShapeId, values: &FxHashMap<NodeId, [NodeId; 2]>) -> Vec<NodeId> {
    // A shape's formula is older than a call of it.
    let mut holds = vec![false; graph.len()];
    for i in 0..holds.len() {
        let node = NodeId(i as u32);
        let has = |id: &NodeId| holds.get(id.0 as usize).copied().unwrap_or(false);
        let called = match graph.node(node) {
            Node::Call(shape, ..) => graph.shape(*shape).is_some_and(|s| has(&s.value)),
            _ => false,
        };
        let found = called || values.contains_key(&node) || graph.arguments(node).iter().any(has);
        if let Some(slot) = holds.get_mut(i) {
            *slot = found;
        }
    }
    let has = |id: NodeId| holds.get(id.0 as usize).copied().unwrap_or(false);
    let mut readers = Vec::new();
    let mut seen = FxHashSet::default();
    let mut open: Vec<NodeId> = graph.shape(root).map(|s| s.value).into_iter().collect();
    while let Some(node) = open.pop() {
        if !has(node) || !seen.insert(node) {
            continue;
        }
        match graph.node(node) {
            Node::Op(Op::Min | Op::Max | Op::Neg, args) => open.extend(args.iter()),
            Node::Op(Op::Select, args) if args.first().is_some_and(|&condition| !has(condition)) => open.extend(args.iter()),
            Node::Op(Op::Mul, args) if args.iter().any(|&a| graph.as_constant(a).is_some_and(|c| c > 0.0)) => open.extend(args.iter()),
            Node::Op(Op::Div, args) if args.get(1).is_some_and(|&by| graph.as_constant(by).is_some_and(|c| c > 0.0)) => open.extend(args.first()),
            Node::Claim(args, Claim::Continuous) => open.extend(args.first()),
            Node::Call(shape, Function::Field, args) if !args.iter().any(|&a| has(a)) => open.extend(graph.shape(*shape).map(|s| s.value)),
            _ => readers.push(node),
        }
    }
    readers
}

/// All nodes that a node is computed from, those of the shapes that it calls among them.
fn inside(graph: &Graph, node: NodeId) -> FxHashSet<NodeId> {
    let mut inside = FxHashSet::default();
    let mut open = vec![node];
    while let Some(node) = open.pop() {
        if inside.insert(node) {
            open.extend(graph.arguments(node).iter());
            if let Node::Call(shape, ..) = graph.node(node) {
                open.extend(graph.shape(*shape).map(|s| s.value));
            }
        }
    }
    inside
}

/// A formula that reads capped values, whose caps can be raised.
struct Reader<'t> {
    eval: Evaluator<'t>,
    /// The least of the caps.
    least: f64,
    /// How many operations all looks took so far.
    ran: usize,
}

impl Reader<'_> {
    /// Up to where the caps have to be raised for a surface that does not depend on them; zero where it does not as they are.
    fn level(&mut self, region: &Box3) -> f64 {
        if region.is_empty() || !region.is_finite() {
            return 0.0;
        }
        let mut level = 0.0;
        for _ in 0..ROUNDS {
            let mut surface = self.surface(region, level);
            if surface.is_empty() {
                // The gaps may be filled altogether.
                surface = self.surface(region, FAR);
            }
            let uncapped = self.values(&surface, FAR);
            let least = self.least;
            let mut agrees = |level: f64| {
                let clip = |value: f64| value.clamp(-NEAR * least, NEAR * least);
                let values = self.values(&surface, level);
                values.iter().zip(&uncapped).all(|(&a, &b)| (clip(a) - clip(b)).abs() <= OTHER * least)
            };
            if agrees(level) {
                break;
            }
            let mut low = level.max(least);
            let mut high = low;
            while high < region.size() && !agrees(high) {
                low = high;
                high *= 1.5;
            }
            for _ in 0..NARROWED {
                let middle = 0.5 * (low + high);
                if agrees(middle) {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            level = high;
        }
        level
    }

    /// The values at some places with the caps raised to a level.
    fn values(&mut self, places: &[[f64; 3]], level: f64) -> Vec<f64> {
        self.ran += places.len() * self.eval.tape().operations();
        self.eval.set_normals(&[[level; LANES], [0.0; LANES], [0.0; LANES]]);
        let mut values = Vec::with_capacity(places.len());
        for batch in places.chunks(LANES) {
            let points: [Lanes; 3] = lanes(batch);
            self.eval.run(&points);
            values.extend(self.eval.output(0).iter().take(batch.len()));
        }
        values
    }

    /// Some places on either side of the surface, in a box and a little outside of it.
    fn surface(&mut self, region: &Box3, level: f64) -> Vec<[f64; 3]> {
        let around = region.grow(self.least);
        let places: Vec<[f64; 3]> = (1..=PLACES).map(|i| around.place(i)).collect();
        let values = self.values(&places, level);
        let (solid, empty): (Vec<_>, Vec<_>) = places.iter().zip(&values).partition(|(_, value)| **value <= 0.0);
        if solid.is_empty() || empty.is_empty() {
            return Vec::new();
        }
        let of = |list: &[(&[f64; 3], &f64)], i: usize| list.get(i % list.len()).map_or([0.0; 3], |(place, _)| **place);
        let mut ends: Vec<[[f64; 3]; 2]> = (0..PAIRS).map(|i| [of(&solid, i), of(&empty, i)]).collect();
        for _ in 0..HALVINGS {
            let middles: Vec<[f64; 3]> = ends.iter().map(|[[x, y, z], [u, v, w]]| [0.5 * (x + u), 0.5 * (y + v), 0.5 * (z + w)]).collect();
            let values = self.values(&middles, level);
            for (([solid, empty], middle), value) in ends.iter_mut().zip(middles).zip(values) {
                *if value <= 0.0 { solid } else { empty } = middle;
            }
        }
        ends.into_iter().flatten().collect()
    }
}
