//! Hulls of shapes: which shapes are those of balls, and the distance of their hull.
//!
//! A shape's balls are those whose hull has the same hull as the shape: the corners of a box, the ends of a capsule. They are noted where the prelude makes a shape, and followed through the
//! graph where shapes are moved and joined.

use super::value::Value;
use super::{Elaborated, Elaborator, Stop};
use crate::analysis::{Box3, Placed};
use crate::diagnostic::{Code, Diagnostic};
use crate::figure::{Ball, Part, hull, parts};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Claim, ClaimGroup, FAR, Function, Graph, Leaf, Node, NodeId, ShapeId, ValueRange};
use crate::source::Span;
use crate::vector::{Vec3, mul, scale};
use std::cmp::Ordering;
use std::f64::consts::TAU;
use std::rc::Rc;

/// The most corners and balls of all shapes of a hull.
const MOST: usize = 4_000;

/// Why the balls of a shape are not known.
enum Unknown {
    /// It is of another kind.
    Other(ShapeId),
    /// There are too many.
    Many,
}

impl Elaborator<'_> {
    /// Notes the balls of a shape that a function of the prelude made of values.
    #[inline(never)]
    pub(super) fn note_balls(&mut self, name: &str, values: &[Value], made: &Value) {
        let Value::Shape(id) = made else { return };
        let z = self.graph.leaf(Leaf::P(2));
        if let Some(balls) = self.balls_made(name, values, z).filter(|balls| balls.len() <= MOST) {
            self.balls.insert(*id, balls.into());
        }
    }

    /// Notes the corners of a solid.
    pub(super) fn note_corners(&mut self, id: ShapeId, mut corners: Vec<Vec3>) {
        corners.sort_by(|a, b| a.partial_cmp(b).unwrap_or(Ordering::Equal));
        corners.dedup();
        if corners.len() <= MOST {
            self.balls.insert(id, corners.iter().map(|at| Ball { at: *at, radius: 0.0 }).collect());
        }
    }

    fn balls_made(&self, name: &str, values: &[Value], z: NodeId) -> Option<Vec<Ball>> {
        let number = |i: usize| match values.get(i)? {
            Value::Number(node, _) => self.graph.as_constant(*node),
            _ => None,
        };
        let vector = |i: usize| match values.get(i)? {
            Value::Vector(nodes) => self.place_of(nodes),
            _ => None,
        };
        let ball = |at: Vec3, radius: f64| Ball { at, radius };
        let corner = |at: Vec3| Ball { at, radius: 0.0 };
        let signs = |of: Vec3| (0..8).map(move |i| mul(of, [i & 1, i >> 1 & 1, i >> 2].map(|bit| f64::from(2 * bit - 1))));
        let of = || match values.first()? {
            Value::Shape(id) => self.balls_of(*id, z).ok(),
            _ => None,
        };
        Some(match (name, values.len()) {
            ("sphere" | "circle", 1) => vec![ball([0.0; 3], number(0)?)],
            ("box", 1) => signs(scale(vector(0)?, 0.5)).map(corner).collect(),
            ("rounded_box", 2) => {
                let size = vector(0)?;
                let radius = size.iter().fold(number(1)?, |least, c| least.min(c / 2.0));
                signs(size.map(|c| c / 2.0 - radius)).map(|at| ball(at, radius)).collect()
            }
            ("capsule", 3) => vec![ball(vector(0)?, number(2)?), ball(vector(1)?, number(2)?)],
            ("capsule", 2) => {
                let up = (number(1)? / 2.0 - number(0)?).max(0.0);
                [up, -up].map(|y| ball([0.0, y, 0.0], number(0).unwrap_or(0.0))).to_vec()
            }
            ("rounded_cone", 3) => vec![ball([0.0, number(2)? / -2.0, 0.0], number(0)?), ball([0.0, number(2)? / 2.0, 0.0], number(1)?)],
            ("rounded_cone", 4) => vec![ball(vector(0)?, number(2)?), ball(vector(1)?, number(3)?)],
            ("octahedron", 1) => [0, 1, 2].into_iter().flat_map(|axis| [1.0, -1.0].map(|sign| [0, 1, 2].map(|i| if i == axis { sign } else { 0.0 }))).map(|at| Some(corner(scale(at, number(0)?)))).collect::<Option<_>>()?,
            ("segment", 2) => vec![corner(vector(0)?), corner(vector(1)?)],
            ("rounded_rectangle", 2) => {
                let [x, y, _] = vector(0)?;
                let radius = number(1)?.min(x / 2.0).min(y / 2.0);
                signs([x / 2.0 - radius, y / 2.0 - radius, 0.0]).take(4).map(|at| ball(at, radius)).collect()
            }
            ("rectangle", 1) => signs(scale(vector(0)?, 0.5)).take(4).map(corner).collect(),
            ("triangle", 3) => [vector(0)?, vector(1)?, vector(2)?].map(corner).to_vec(),
            ("polygon", 1) => {
                let Value::List(points) = values.first()? else { return None };
                points.iter().map(|point| if let Value::Vector(nodes) = point { self.place_of(nodes).map(corner) } else { None }).collect::<Option<_>>()?
            }
            ("regular_polygon", 2) => {
                let (sides, radius) = (number(0)?, number(1)?);
                let turned = |i: usize| {
                    let (x, y) = (i as f64 * TAU / sides).sin_cos();
                    corner([radius * x, radius * y, 0.0])
                };
                (0..sides.clamp(0.0, MOST as f64 + 1.0) as usize).map(turned).collect()
            }
            ("extrude", 3) if number(2)? == 0.0 => {
                let (flat, half) = (of()?, number(1)? / 2.0);
                let ends = |ball: &Ball| (ball.radius == 0.0).then(|| [half, -half].map(|z| corner([ball.at[0], ball.at[1], z])));
                flat.iter().map(ends).collect::<Option<Vec<_>>>()?.concat()
            }
            ("scale", 2) => {
                let by = number(1)?;
                of()?.iter().map(|one| ball(scale(one.at, by), one.radius * by)).collect()
            }
            // Only distances are known here: what is stretched is made thicker by more than it is told.
            ("round", 2) => {
                let by = number(1)?;
                of()?.iter().map(|one| (one.radius + by >= 0.0).then(|| ball(one.at, one.radius + by))).collect::<Option<_>>()?
            }
            _ => return None,
        })
    }

    /// Two or three numbers that are known.
    fn place_of(&self, nodes: &[NodeId]) -> Option<Vec3> {
        let mut place = [0.0; 3];
        for (c, node) in place.iter_mut().zip(nodes) {
            *c = self.graph.as_constant(*node)?;
        }
        Some(place)
    }

    /// The balls of a shape: those noted, or those of what it is made of. `z` is the third coordinate, which a drawing does not have.
    fn balls_of(&self, shape: ShapeId, z: NodeId) -> Result<Rc<[Ball]>, Unknown> {
        if let Some(known) = self.balls.get(&shape) {
            return Ok(known.clone());
        }
        let mut all = Vec::new();
        // What is still to be opened: a value, and the way back to the outermost shape's space.
        let mut open = vec![self.graph.shape(shape).map(|made| made.value).ok_or(Unknown::Other(shape))?];
        while let Some(node) = open.pop() {
            match self.graph.node(node) {
                Node::Op(Op::Min, args) => open.extend(args.iter().rev()),
                // Nothing.
                Node::Constant(bits) if f64::from_bits(*bits) >= FAR => {}
                Node::Call(inner, Function::Field, point) => {
                    let placed = match (self.graph.dimensions(*inner), &**point) {
                        (2, [x, y, ..]) => Placed::of(&self.graph, &[*x, *y, z]),
                        _ => Placed::of(&self.graph, point),
                    };
                    let placed = placed.ok_or(Unknown::Other(shape))?;
                    all.extend(self.balls_of(*inner, z)?.iter().map(|ball| Ball { at: placed.back_to(ball.at), ..*ball }));
                }
                _ => return Err(Unknown::Other(shape)),
            }
            if all.len() + open.len() > MOST {
                return Err(Unknown::Many);
            }
        }
        Ok(all.into())
    }

    /// `hull_of(shape)`.
    #[inline(never)]
    pub(super) fn hull_of_shape(&mut self, (shape, at): (ShapeId, Span), span: Span) -> Elaborated<Value> {
        let z = self.graph.leaf(Leaf::P(2));
        let dimensions = self.graph.dimensions(shape);
        let balls = match self.balls_of(shape, z) {
            Ok(balls) => balls,
            Err(Unknown::Many) => {
                let words = format!("a hull has {MOST} corners and balls at most, and these shapes have more");
                return Err(self.error(Code::TooLarge, at, words, "join fewer shapes"));
            }
            Err(Unknown::Other(which)) => {
                let words = "the hull of this shape is not known while compiling";
                let help = match dimensions {
                    2 => "a hull is of circles, rectangles, polygons and segments of numbers that are not live; they may be moved, turned, scaled, rounded and joined. Else write corners: `hull(polygon([(0, 0), …]))`",
                    _ => "a hull is of balls, boxes, capsules, solids with flat faces and extruded polygons, of numbers that are not live; they may be moved, turned, scaled, rounded and joined. Of cylinders side by side, extrude the hull of their circles: `hull(circle(1), circle(0.5).translate(2, 0)).extrude(0.3)`. Else write points: `hull([(0, 0, 0), …])`",
                };
                let error = Diagnostic::new(Code::BadValue, at, words, help);
                let error = match self.graph.place_in(which, None) {
                    Some(place) if place != at => error.label(place, "it is not known of this one"),
                    _ => error,
                };
                return Err(self.report(error));
            }
        };
        let Some(radius) = balls.first().map(|ball| ball.radius) else { return Ok(Value::Nothing) };
        // Of one radius it is a solid with flat faces, made thicker, unless all is in one plane.
        if dimensions == 3 && balls.iter().all(|ball| ball.radius == radius) {
            let corners: Vec<Vec3> = balls.iter().map(|ball| ball.at).collect();
            if let Ok(faces) = hull(&corners) {
                let Value::Shape(flat) = self.solid(Ok(faces), span, "")? else { return Err(Stop) };
                let made = if radius > 0.0 { self.thicker(flat, radius, span) } else { flat };
                self.balls.insert(made, balls);
                return Ok(Value::Shape(made));
            }
        }
        match parts(&balls, dimensions) {
            Ok(parts) => {
                let value = self.distance_of(&parts, dimensions);
                let side = |i: usize| {
                    balls.iter().fold(Interval::EMPTY, |side, ball| {
                        let at = ball.at.get(i).copied().unwrap_or(0.0);
                        side.hull(Interval::new(at - ball.radius, at + ball.radius))
                    })
                };
                self.facts.know_solid(value, Box3([side(0), side(1), if dimensions == 2 { Interval::ALL } else { side(2) }]));
                let made = self.formula_shape(value, dimensions, None, true, span);
                self.balls.insert(made, balls);
                Ok(Value::Shape(made))
            }
            Err(why) => Err(self.error(Code::BadValue, at, format!("these shapes have no hull: {why}"), "join fewer shapes, or write points: `hull([(0, 0, 0), …]).round(0.1)`")),
        }
    }

    /// A shape, its surface farther out.
    fn thicker(&mut self, shape: ShapeId, by: f64, span: Span) -> ShapeId {
        let point = self.graph.point();
        let inner = self.graph.field(shape, point);
        let by = self.graph.constant(by);
        let value = self.graph.op(Op::Sub, &[inner, by]);
        self.make_shape(3, value, span)
    }

    /// The largest value of the parts that are right, which is a distance.
    fn distance_of(&mut self, parts: &[Part], dimensions: u8) -> NodeId {
        let graph = &mut self.graph;
        let point = graph.point();
        let none = graph.constant(-FAR);
        let mut values = Vec::with_capacity(parts.len());
        for part in parts {
            values.push(match part {
                Part::Plane { normal, height } => {
                    let along = sum(graph, point, *normal);
                    add(graph, along, -height)
                }
                Part::Ball { ball, ends } => {
                    let way = off(graph, point, ball.at);
                    let far = match (dimensions, way) {
                        (2, [x, y, _]) => graph.op(Op::Length2, &[x, y]),
                        _ => graph.op(Op::Length3, &way),
                    };
                    let value = add(graph, far, -ball.radius);
                    within(graph, (way, far), ends.iter().map(|end| (end.way, end.by)), value, none)
                }
                Part::Cone { foot, axis, rise, run, ends } => {
                    let way = off(graph, point, foot.at);
                    let along = sum(graph, way, *axis);
                    let mut across = way;
                    for (c, by) in across.iter_mut().zip(axis) {
                        let by = graph.constant(*by);
                        let part = graph.op(Op::Mul, &[along, by]);
                        *c = graph.op(Op::Sub, &[*c, part]);
                    }
                    let far = graph.op(Op::Length3, &across);
                    let (up, out) = (times(graph, along, *rise), times(graph, far, *run));
                    let value = graph.op(Op::Add, &[up, out]);
                    let value = add(graph, value, -foot.radius);
                    within(graph, (way, far), ends.iter().map(|end| (end.way, end.by)), value, none)
                }
            });
        }
        let value = graph.balanced(Op::Max, &values, -FAR);
        let steepest = graph.leaf(Leaf::Variable(0));
        let claim = Claim::Lipschitz(steepest, [ClaimGroup::Vector(dimensions)].into(), None::<ValueRange>);
        let args = std::iter::once(value).chain(point.into_iter().take(dimensions.into()));
        graph.intern(Node::Claim(args.collect(), claim))
    }
}

fn times(graph: &mut Graph, node: NodeId, by: f64) -> NodeId {
    let by = graph.constant(by);
    graph.op(Op::Mul, &[by, node])
}

fn add(graph: &mut Graph, node: NodeId, number: f64) -> NodeId {
    let number = graph.constant(number);
    graph.op(Op::Add, &[node, number])
}

/// The way to a point from a place.
fn off(graph: &mut Graph, point: [NodeId; 3], from: Vec3) -> [NodeId; 3] {
    let mut way = point;
    for (c, from) in way.iter_mut().zip(from) {
        let from = graph.constant(from);
        *c = graph.op(Op::Sub, &[*c, from]);
    }
    way
}

/// The scalar product with numbers.
fn sum(graph: &mut Graph, of: [NodeId; 3], with: Vec3) -> NodeId {
    let parts: Vec<NodeId> = of.into_iter().zip(with).filter(|(_, by)| *by != 0.0).map(|(c, by)| times(graph, c, by)).collect();
    graph.balanced(Op::Add, &parts, 0.0)
}

/// A value where all ends are before a way, `none` elsewhere.
fn within(graph: &mut Graph, (way, far): ([NodeId; 3], NodeId), ends: impl Iterator<Item = (Vec3, f64)>, value: NodeId, none: NodeId) -> NodeId {
    let zero = graph.constant(0.0);
    let mut right = Vec::new();
    for (toward, by) in ends {
        let (along, more) = (sum(graph, way, toward), times(graph, far, by));
        let total = graph.op(Op::Add, &[along, more]);
        right.push(graph.op(Op::Le, &[zero, total]));
    }
    if right.is_empty() {
        return value;
    }
    let all = graph.balanced(Op::And, &right, 1.0);
    graph.op(Op::Select, &[all, value, none])
}
