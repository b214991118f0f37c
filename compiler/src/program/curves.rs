//! Curves as values, and solids of points: what the prelude's functions of them are made of.

use super::value::Value;
use super::{Elaborated, Elaborator, Stop};
use crate::analysis::Box3;
use crate::diagnostic::Code;
use crate::figure::{Bow, Face, Figure, Frame, Line, MOST_BOWS, MOST_POINTS, Stretch, closed, hull, triangles, turn};
use crate::graph::interval::Interval;
use crate::graph::{Claim, ClaimGroup, Leaf, Node, NodeId, ShapeId, ValueRange};
use crate::kept::Kept;
use crate::sampled::MOST_DEVICE_BYTES;
use crate::source::Span;
use crate::vector::{Vec3, cross};
use std::rc::Rc;
use std::sync::Arc;

/// The most faces of a solid that a text names.
const MOST_FACES: usize = 100_000;
/// The most arcs along which a drawing is carried, each of which is a shape.
const MOST_SWEPT: usize = 2_000;
/// A stretch of a sweep with a twist reaches into the next by this part of half its length: the prelude's `way_along` knows its place so far past its ends.
const TWISTED_OVERLAP: f64 = 0.25;

type Given<'a> = (&'a Value, Span);

// Calls of built-in functions nest. These are kept out of line, so that their room on the stack is not taken at each level.
impl Elaborator<'_> {
    /// `curve_of("kind", points, closed)`.
    #[inline(never)]
    pub(super) fn curve_of(&mut self, kind: &str, points: Given<'_>, is_closed: bool) -> Elaborated<Value> {
        let places = self.places(points, 2 * MOST_BOWS)?;
        let line = match (kind, &places[..]) {
            ("arc", &[from, by, to]) => Line::arc(from, by, to),
            ("bezier", _) => Line::bezier(&places, is_closed),
            ("catmull_rom", _) => Line::catmull_rom(&places, is_closed),
            _ => Line::polyline(&places, is_closed),
        };
        self.curve(line, points.1)
    }

    /// `helix_of(radius, pitch, turns)`.
    #[inline(never)]
    pub(super) fn helix_of(&mut self, numbers: [Given<'_>; 3], span: Span) -> Elaborated<Value> {
        let [radius, pitch, turns] = numbers.map(|(value, at)| self.to_constant(value, at));
        let line = Line::helix(radius?, pitch?, turns?);
        self.curve(line, span)
    }

    fn curve(&mut self, line: Result<Line, String>, span: Span) -> Elaborated<Value> {
        match line {
            Ok(line) => Ok(Value::Curve(Rc::new(line))),
            // A function that nobody calls is tried with points that say nothing.
            Err(_) if self.trial => self.stand_in_curve().ok_or(Stop),
            Err(why) => Err(self.error(Code::BadValue, span, format!("this is no curve: {why}"), "write points that are apart, as `polyline([(0, 0, 0), (1, 0, 0), (1, 1, 0)])`")),
        }
    }

    /// Some curve.
    pub(super) fn stand_in_curve(&self) -> Option<Value> {
        Line::polyline(&[[0.0; 3], [1.0, 0.0, 0.0]], false).ok().map(|line| Value::Curve(Rc::new(line)))
    }

    /// `way_to(curve, q)`: how far a point is from a curve.
    #[inline(never)]
    pub(super) fn way_to(&mut self, line: &Line, q: &[NodeId], span: Span) -> Elaborated<Value> {
        let &[x, y, z] = q else { return Err(Stop) };
        let Some(figure) = Figure::of_bows(&line.bows) else { return Err(Stop) };
        let value = self.figured(figure, [x, y, z], span)?;
        Ok(Value::number(value))
    }

    /// `solid_of(points, faces)`.
    #[inline(never)]
    pub(super) fn solid_of(&mut self, points: Given<'_>, faces: Given<'_>, span: Span) -> Elaborated<Value> {
        let places = self.places(points, 3 * MOST_FACES)?;
        let Value::List(lists) = faces.0 else { return Err(Stop) };
        if lists.len() > MOST_FACES {
            let words = format!("a polyhedron has {MOST_FACES} faces at most, and this one has {}", lists.len());
            return Err(self.error(Code::TooLarge, faces.1, words, "bring it as a file: `mesh_field(\"solid.obj\")`"));
        }
        let mut all: Vec<Vec<usize>> = Vec::new();
        for list in lists.iter() {
            let Value::List(corners) = list else { return Err(Stop) };
            let mut face = Vec::new();
            for corner in corners.iter() {
                let number = self.to_constant(corner, faces.1)?;
                // What is below 0 names no point.
                face.push(if number < 0.0 { usize::MAX } else { number as usize });
            }
            all.push(face);
        }
        let found = match triangles(&places, &all) {
            Ok(found) => closed(&places, &found).map_err(|why| format!("this solid can't be closed: {why}")),
            Err((at, why)) => Err(format!("face {at} of this solid is wrong: {why}")),
        };
        self.solid(found, span, "write each face as the numbers of its corners, counted from 0: `polyhedron([(0, 0, 0), …], [[0, 1, 2], …])`")
    }

    /// `hull_of(points)`.
    #[inline(never)]
    pub(super) fn hull_of(&mut self, points: Given<'_>, span: Span) -> Elaborated<Value> {
        let found = hull(&self.places(points, MOST_POINTS)?).map_err(|why| format!("these points have no hull: {why}"));
        self.solid(found, span, "write at least four points that do not lie in one plane")
    }

    pub(super) fn solid(&mut self, faces: Result<Vec<Face>, String>, span: Span, help: &str) -> Elaborated<Value> {
        let corners: Vec<Vec3> = faces.iter().flatten().flat_map(|face| face.corners).collect();
        let figure = match faces {
            Ok(faces) => Figure::of_faces(&faces),
            Err(_) if self.trial => hull(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]).ok().and_then(|faces| Figure::of_faces(&faces)),
            Err(why) => return Err(self.error(Code::BadValue, span, why, help)),
        };
        let Some(figure) = figure else { return Err(Stop) };
        let [[a, b, c], [d, e, f]] = figure.bounds();
        let point = self.graph.point();
        let value = self.figured(figure, point, span)?;
        self.facts.know_solid(value, Box3([Interval::new(a, d), Interval::new(b, e), Interval::new(c, f)]));
        let made = self.formula_shape(value, 3, None, false, span);
        self.note_corners(made, corners);
        Ok(Value::Shape(made))
    }

    /// The distance of a point to a figure, which changes no faster than the way.
    fn figured(&mut self, figure: Figure, point: [NodeId; 3], span: Span) -> Elaborated<NodeId> {
        let kept = Kept::new(Arc::new(figure));
        let others = self.graph.figures.iter().filter(|known| known.number != kept.number);
        let bytes: usize = others.map(|known| known.data.bytes()).sum::<usize>() + kept.data.bytes();
        if bytes > MOST_DEVICE_BYTES {
            let words = format!("the curves and solids of this scene take {} MiB, and a device reads {} at most", bytes >> 20, MOST_DEVICE_BYTES >> 20);
            return Err(self.error(Code::TooLarge, span, words, "write fewer points"));
        }
        let value = self.graph.figured(&kept, point);
        let steepest = self.graph.leaf(Leaf::Variable(0));
        let claim = Claim::Lipschitz(steepest, [ClaimGroup::Vector(3)].into(), None::<ValueRange>);
        let [x, y, z] = point;
        Ok(self.graph.intern(Node::Claim([value, x, y, z].into(), claim)))
    }

    /// `curve.at(t)`: a place of a curve, from 0 at its start to 1 at its end.
    #[inline(never)]
    pub(super) fn curve_at(&mut self, line: &Line, share: Given<'_>) -> Elaborated<Value> {
        let share = self.to_constant(share.0, share.1)?;
        let Some(frame) = line.at(share, &line.frames()) else { return Err(Stop) };
        Ok(Value::Vector(frame.at.into_iter().map(|c| self.graph.constant(c)).collect()))
    }

    /// `frame_of(curve, i, count)`: what carries copy `i` of `count` there, its z along the curve: an axis, the angle about it, and the place. They stand evenly, from its start to its end or all around.
    #[inline(never)]
    pub(super) fn frame_of(&mut self, line: &Line, i: Given<'_>, count: Given<'_>) -> Elaborated<Value> {
        let [i, count] = [i, count].map(|(value, at)| self.to_constant(value, at));
        let (i, spans) = (i?, if line.is_closed { count? } else { count? - 1.0 });
        let Some(Frame { at, x, y, forth }) = line.at(i / spans.max(1.0), &line.frames()) else { return Err(Stop) };
        let (axis, angle) = turn([x, y, forth]);
        let rows: [&[f64]; 3] = [&axis, &[angle, 0.0], &at];
        Ok(Value::List(rows.map(|row| Value::Vector(row.iter().map(|c| self.graph.constant(*c)).collect())).to_vec().into()))
    }

    /// `swept_of(curve)`, `twisted_of(curve)` and `kinks_of(curve)`: the stretches of a sweep, of one with a twist, and of its kinks two by two. Each is a list for the prelude's `swept` and
    /// `swept_twisted`.
    #[inline(never)]
    pub(super) fn swept_of(&mut self, line: &Line, span: Span, what: &str) -> Elaborated<Value> {
        if line.bows.len() > MOST_SWEPT {
            let words = format!("a drawing is carried along {MOST_SWEPT} arcs at most, and this curve has {}", line.bows.len());
            return Err(self.error(Code::TooLarge, span, words, "carry it along parts of the curve, or write fewer points"));
        }
        let (all, kinks) = line.stretches(if what == "twisted_of" { TWISTED_OVERLAP } else { 1.0 });
        let whole = line.length();
        let one = |e: &mut Self, stretch: &Stretch| {
            let Stretch { bow: Bow { middle, out, forth, bend, half }, turn, way, past, mitre, ends } = *stretch;
            let [low, high] = Bow { half: half + past, ..stretch.bow }.bounds();
            let across = cross(out, forth);
            let [[a, b, c, d], [f, g, h, i]] = ends.map(|([a, b, c], d)| [a, b, c, d]);
            let rows: [&[f64]; 10] = [&across, &out, &forth, &middle, &[bend, turn], &[a, b, c, d], &[f, g, h, i], &[way, half, whole, 1.0 + mitre], &low, &high];
            Value::List(rows.into_iter().map(|row| Value::Vector(row.iter().map(|c| e.graph.constant(*c)).collect())).collect())
        };
        let items: Vec<Value> = if what == "kinks_of" {
            kinks.iter().map(|pair| Value::List(pair.iter().map(|stretch| one(self, stretch)).collect())).collect()
        } else {
            all.iter().map(|stretch| one(self, stretch)).collect()
        };
        Ok(Value::List(items.into()))
    }

    /// `known_in(s, low, high)`: the same shape, which lies within a box, as the prelude knows. Nothing changes where a corner is live or has no end.
    #[inline(never)]
    pub(super) fn known_in(&mut self, shape: ShapeId, low: Given<'_>, high: Given<'_>) -> Elaborated<Value> {
        let mut corner = |(value, span): Given<'_>| -> Elaborated<Option<Vec<f64>>> {
            let nodes = self.to_vector(value, 3, span)?;
            Ok(nodes.iter().map(|node| self.graph.as_constant(*node).filter(|c| c.is_finite())).collect())
        };
        if let (Some(low), Some(high)) = (corner(low)?, corner(high)?)
            && let ([a, b, c], [d, e, f]) = (low.as_slice(), high.as_slice())
            && let Some(value) = self.graph.shape(shape).map(|shape| shape.value)
        {
            self.facts.know_solid(value, Box3([Interval::new(*a, *d), Interval::new(*b, *e), Interval::new(*c, *f)]));
        }
        Ok(Value::Shape(shape))
    }

    /// Points that are known while compiling, no more than `most`.
    fn places(&mut self, (value, span): Given<'_>, most: usize) -> Elaborated<Vec<Vec3>> {
        let Value::List(items) = value else { return Err(Stop) };
        if items.len() > most {
            let words = format!("{most} points are the most here, and these are {}", items.len());
            return Err(self.error(Code::TooLarge, span, words, "write fewer points"));
        }
        let mut all = Vec::with_capacity(items.len());
        for item in items.iter() {
            let nodes = self.to_vector(item, 3, span)?;
            let mut place = [0.0; 3];
            for (c, node) in place.iter_mut().zip(&*nodes) {
                let Some(constant) = self.graph.as_constant(*node) else {
                    let words = "these points must be known while compiling, and one depends on something live";
                    return Err(self.error(Code::NotConstant, span, words, "write numbers, or a `let` of numbers; move the whole with `.translate(v)`"));
                };
                *c = constant;
            }
            all.push(place);
        }
        Ok(all)
    }
}
