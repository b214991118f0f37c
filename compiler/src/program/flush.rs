//! Faces of two solids that lie in one plane. A blend of both would bulge over it, as it fills every place to which both are near: it is cut off
//! at the plane. Both lie on one side of that, so nothing of either is lost, and the cut is a half-space, whose field is a distance.

use crate::analysis::Box3;
use crate::evaluate::Tape;
use crate::graph::kernel::Op;
use crate::graph::{Graph, Leaf, Node, NodeId, Opened, ShapeId};
use crate::live::Live;
use crate::program::Elaborator;
use crate::program::bind::flush_by;
use crate::program::faces::{Face, Faces, ROUNDING};
use crate::program::load::ItemRef;
use crate::program::value::Value;
use crate::source::Span;
use crate::syntax::ast;
use rustc_hash::FxHashSet;
use std::rc::Rc;

/// Shapes of longer formulas are not looked at.
const LARGEST: usize = 2000;
/// A face is looked at in so many places along each of its sides.
const PLACES: usize = 9;
/// About each of these its neighbours are so far away, as a share of the side.
const NEAR: f64 = 1e-2;
/// Of a side without an end so much is looked at, on both sides of the origin.
const WIDE: f64 = 10.0;
/// A chain of blends in which so many cuts stand within others gets no more of those: each of them parts what is one union without it.
const MOST_WITHIN: usize = 4;

/// What a blend of two is made of, and where it is cut off.
pub struct Flush {
    /// The two, where they were cut off at the same planes without their cuts.
    pub operands: [ShapeId; 2],
    faces: Faces,
}

impl Elaborator<'_> {
    /// A blend without its cuts.
    pub(super) fn uncut(&self, shape: ShapeId) -> ShapeId {
        self.faces.get(&shape).map_or(shape, |known| known.uncut)
    }

    /// Where a blend of the prelude must be cut off; none of what does not ask for it.
    pub(super) fn flush(&mut self, item: ItemRef, function: &ast::Function, values: &[Value]) -> Option<Flush> {
        let by = flush_by(self.modules, item)?;
        let (Some(Value::Shape(a)), Some(Value::Shape(b))) = (values.first(), values.get(1)) else { return None };
        let at = function.parameters.iter().position(|p| *p.name.text == *by)?;
        let reach = match values.get(at) {
            Some(Value::Number(k, _)) => self.graph.as_constant(*k).unwrap_or(f64::INFINITY),
            _ => return None,
        };
        let first = self.faces_of(*a);
        let none = Faces { flat: Rc::default(), region: Box3::ALL, uncut: *a, cuts: Rc::default(), joined: true, within: 0 };
        if first.joined && first.flat.is_empty() {
            // Of a long chain without flat faces no further operand is looked at.
            return Some(Flush { operands: [*a, *b], faces: none });
        }
        let second = self.faces_of(*b);
        let (mut flat, mut cuts) = (Vec::new(), Vec::new());
        for face in first.flat.iter() {
            match second.flat.iter().find(|other| face.is_flush_with(other)) {
                Some(other) => {
                    let whole = Face { at: face.at.max(other.at), within: face.within.hull(&other.within), ..*face };
                    flat.push(whole);
                    // What was cut off before has bulged already.
                    if face.gap(other) < reach || [&first, &second].iter().any(|of| of.cuts.iter().any(|cut| face.is_flush_with(cut))) {
                        cuts.push(whole);
                    }
                }
                None if face.end(&second.region) <= face.at - reach => flat.push(*face),
                None => {}
            }
        }
        flat.extend(second.flat.iter().filter(|face| face.end(&first.region) <= face.at - reach));
        // What is cut off again need not be cut off before: a chain of blends stays one.
        let again = |of: &Faces| of.cuts.iter().all(|cut| cuts.iter().any(|face| face.is_flush_with(cut)));
        let within = first.within + second.within + [&first, &second].iter().filter(|of| !again(of)).count();
        let operands = [(*a, &first), (*b, &second)].map(|(whole, of)| if again(of) { of.uncut } else { whole });
        let region = first.region.hull(&second.region);
        if within >= MOST_WITHIN {
            flat.retain(|face| cuts.contains(face));
        }
        Some(Flush { operands, faces: Faces { flat: flat.into(), region, cuts: cuts.into(), within, ..none } })
    }

    /// The blend, cut off.
    pub(super) fn cut_flush(&mut self, blend: ShapeId, flush: Flush, span: Span) -> ShapeId {
        let point = self.graph.point();
        let planes: Vec<NodeId> = flush.faces.cuts.iter().filter_map(|face| {
            let at = self.graph.constant(face.at);
            let along = *point.get(face.axis)?;
            let outward = if face.outward > 0.0 { along } else { self.graph.op(Op::Neg, &[along]) };
            Some(self.graph.op(Op::Sub, &[outward, at]))
        }).collect();
        let outside = planes.into_iter().reduce(|a, b| self.graph.op(Op::Max, &[a, b]));
        let cut = match outside {
            None => blend,
            Some(outside) => {
                let inside = self.graph.field(blend, point);
                let value = self.graph.op(Op::Max, &[inside, outside]);
                let dimensions = self.graph.dimensions(blend);
                self.make_shape(dimensions, value, span)
            }
        };
        self.faces.insert(cut, Faces { uncut: blend, ..flush.faces });
        cut
    }

    /// The flat faces of a shape, as far as they are found.
    fn faces_of(&mut self, shape: ShapeId) -> Faces {
        if let Some(known) = self.faces.get(&shape) {
            return known.clone();
        }
        let mut faces = Faces { flat: Rc::default(), region: Box3::ALL, uncut: shape, cuts: Rc::default(), joined: false, within: 0 };
        if let Some((dimensions, value)) = self.graph.shape(shape).map(|s| (usize::from(s.dimensions), s.value))
            && stands_still(&self.graph, value)
            && let Ok(tape) = Tape::new(&self.graph, &Opened::default(), &[value], &Live::start(&self.graph), LARGEST)
        {
            faces.region = self.facts.on_top(|facts| facts.outline(&self.graph, value));
            let within = faces.region;
            let all = (0..dimensions).flat_map(|axis| [1.0, -1.0].map(|outward| Face { axis, outward, at: 0.0, within }));
            let ends = all.map(|face| Face { at: face.end(&within), ..face });
            faces.flat = ends.filter(|face| is_flat(&tape, face, dimensions)).collect();
        }
        self.faces.insert(shape, faces.clone());
        faces
    }
}

/// Whether the surface is flat about some place in the plane of a face: the field is zero there and around.
fn is_flat(tape: &Tape, face: &Face, dimensions: usize) -> bool {
    let region = &face.within;
    if !face.at.is_finite() || region.is_empty() {
        return false;
    }
    let sides: Vec<usize> = (0..dimensions).filter(|axis| *axis != face.axis).collect();
    let side = |axis: usize| (region.axis(axis).lo.max(-WIDE), region.axis(axis).hi.min(WIDE));
    let mut points = Vec::new();
    for place in 0..PLACES.pow(sides.len() as u32) {
        let mut middle = [0.0; 3];
        let mut set = |axis: usize, to: f64| middle.iter_mut().skip(axis).take(1).for_each(|c| *c = to);
        set(face.axis, face.outward * face.at);
        for (i, &axis) in sides.iter().enumerate() {
            let (lo, hi) = side(axis);
            let share = ((place / PLACES.pow(i as u32) % PLACES) as f64 + 0.5) / PLACES as f64;
            set(axis, lo + share * (hi - lo));
        }
        points.push(middle);
        for &axis in &sides {
            let (lo, hi) = side(axis);
            for step in [-NEAR, NEAR] {
                let mut beside = middle;
                beside.iter_mut().skip(axis).take(1).for_each(|c| *c += step * (hi - lo));
                points.push(beside);
            }
        }
    }
    let zero = ROUNDING * (1.0 + face.at.abs());
    let group = 1 + 2 * sides.len();
    let mut on_it = vec![0; PLACES.pow(sides.len() as u32)];
    tape.evaluator().at(&points, &[], |i, values| {
        if let (Some(count), Some(value)) = (on_it.get_mut(i / group), values.first()) {
            *count += usize::from(value.abs() <= zero);
        }
    });
    on_it.contains(&group)
}

/// Whether a formula and all that it calls are the same wherever sliders stand, at all times and in all cells; of a long one that is not known.
fn stands_still(graph: &Graph, value: NodeId) -> bool {
    let (mut open, mut seen, mut looked) = (vec![value], FxHashSet::default(), 0);
    while let Some(formula) = open.pop() {
        for id in graph.reachable(&[formula]) {
            looked += 1;
            match graph.node(id) {
                Node::Leaf(Leaf::P(_)) => {}
                Node::Leaf(_) => return false,
                Node::Call(shape, ..) if seen.insert(*shape) => open.extend(graph.shape(*shape).map(|s| s.value)),
                _ => {}
            }
        }
        if looked > LARGEST {
            return false;
        }
    }
    true
}
