//! Copies about an axis: those of the sectors near the point, or all of them.

use super::growth::angle_about_zero;
use super::repeat::MOST_COPIES;
use super::value::Value;
use super::{Elaborated, Elaborator, Env, Stop};
use crate::analysis::Box3;
use crate::diagnostic::Code;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Claim, FAR, Leaf, Node, NodeId, ShapeId};
use crate::source::Span;
use crate::syntax::ast::For;

/// At most so many sectors are looked at, but for the nearest.
const MOST_SECTORS: f64 = 8.0;

impl Elaborator<'_> {
    /// `for k in polar(axis, n) { body }`: copy k turned by k/n of a turn. `given`: the arguments of `polar`.
    pub fn polar(
        &mut self,
        each: &For,
        given: &[(Value, Span)],
        span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        let (axis, count) = match given {
            [count] => (None, count.clone()),
            [(Value::Number(..), _), (Value::Vector(_), at)] => {
                return Err(self.error(Code::TypeMismatch, *at, "the axis stands first", "write `polar(y, 6)`"));
            }
            [axis, count] => (Some(axis.clone()), count.clone()),
            _ => {
                return Err(self.error(
                    Code::MissingArgument,
                    each.source.span,
                    "`polar` needs a number of copies",
                    "write `polar(y, 12)`, and `polar(12)` for drawings",
                ));
            }
        };
        let dimensions: u8 = if axis.is_some() { 3 } else { 2 };
        let count_node = self.to_number(&count.0, count.1, env)?;
        let range = self.facts.live_range(&self.graph, count_node);
        let constant = self.graph.as_constant(count_node);
        if range.lo < 1.0 || constant.is_some_and(|c| c.fract() != 0.0) {
            return Err(self.error(
                Code::BadValue,
                count.1,
                format!("there can't be {} copies", constant.unwrap_or(range.lo)),
                "write a whole number of at least one",
            ));
        }
        // A live count is a whole number.
        let count_node = match count.0 {
            Value::Number(_, true) => count_node,
            _ => self.graph.op(Op::Round, &[count_node]),
        };
        if !range.hi.is_finite() || range.hi > 10_000.0 {
            return Err(self.error(
                Code::NotConstant,
                count.1,
                "the number of copies may be anything",
                "write a number, or a parameter with a range",
            ));
        }
        let axis_value = match &axis {
            Some((axis, at)) => {
                let v = self.to_vector(axis, 3, *at)?;
                let &[i, j, k] = &*v else { return Err(Stop) };
                Some(([i, j, k], *at))
            }
            None => None,
        };
        let variable = self.graph.fresh_variable();
        let index = self.graph.leaf(Leaf::Variable(variable));
        let inner = env.with(&each.index.text, Value::Number(index, true)).at(None);
        let body = self.expression(&each.body, &inner)?;
        if matches!(body, Value::Nothing) {
            return Ok(Value::Nothing);
        }
        let body = self.repeated(&body, dimensions, each, "polar(y, 6)")?;
        let last = range.hi - 1.0;
        let cells = |v: u32| (v == variable).then_some((0.0, last));
        let region = self.body_box(body, &cells);
        let plane = match axis_value {
            None => Some((0, 1, 1.0)),
            Some((axis, _)) => match axis.map(|n| self.graph.as_constant(n)) {
                // The plane in which the copies turn, first to second coordinate by the right-hand rule.
                [Some(c), Some(0.0), Some(0.0)] => Some((1, 2, c)),
                [Some(0.0), Some(c), Some(0.0)] => Some((2, 0, c)),
                [Some(0.0), Some(0.0), Some(c)] => Some((0, 1, c)),
                _ => None,
            },
        };
        let sectors = constant.zip(plane).and_then(|(n, (u, v, _))| {
            let half = angle_about_zero(&region, u, v)? / (std::f64::consts::TAU / n);
            // The first copy that is not looked at begins three quarters of a sector away, or more.
            let rings = (half - 0.25).max(1.0).ceil();
            let inner = region.axis(u).mignitude().hypot(region.axis(v).mignitude());
            // Turned about the axis, the body stays within the circle through its farthest point.
            let outer = region.axis(u).magnitude().hypot(region.axis(v).magnitude()).next_up();
            let disc = Interval::new(-outer, outer);
            let around = region.with_axis(u, disc).with_axis(v, disc);
            let mut sectors = Sectors { n, rings, half, inner, around, share: 1.0 };
            if !sectors.are_few() {
                return None;
            }
            sectors.share = self.share_of_distance(body, &cells, &region, 0.0..outer, &[u, v]);
            let level = self.level_read(span).unwrap_or(0.0);
            while sectors.least_cap() < level {
                let few = Sectors { rings: sectors.rings + 1.0, ..sectors };
                if !few.are_few() {
                    // All of them are looked at, unless they are too many.
                    if n <= MOST_COPIES as f64 {
                        return None;
                    }
                    self.say_too_far(level, sectors.least_cap(), span);
                    break;
                }
                sectors = few;
            }
            Some(sectors)
        });
        let id = match (sectors, plane) {
            (Some(sectors), Some(about)) => self.place_sectors(body, variable, about, sectors, dimensions, span),
            _ => {
                // Few copies, or a body that reaches around: all of them.
                let most = range.hi.ceil() as usize;
                if most > MOST_COPIES {
                    return Err(self.error(
                        Code::NoReach,
                        span,
                        "the body reaches so far around the axis that too many copies would be looked at",
                        "move the body away from the axis with `.translate(…)` inside the braces, or make it smaller",
                    ));
                }
                let id = self.place_all(body, variable, axis_value, count_node, most, dimensions, span)?;
                if let (Some((u, v, _)), Some(value)) = (plane, self.graph.shape(id).map(|s| s.value)) {
                    let outer = region.axis(u).magnitude().hypot(region.axis(v).magnitude()).next_up();
                    let disc = Interval::new(-outer, outer);
                    self.facts.know_solid(value, region.with_axis(u, disc).with_axis(v, disc));
                }
                id
            }
        };
        Ok(Value::Shape(id))
    }

    /// Copies in the point's own sector and `rings` on either side.
    fn place_sectors(
        &mut self,
        body: ShapeId,
        variable: u32,
        (u, v, sign): (usize, usize, f64),
        sectors: Sectors,
        dimensions: u8,
        span: Span,
    ) -> ShapeId {
        let Sectors { n, rings, half, inner, around, share } = sectors;
        let mut point = self.graph.point();
        if dimensions == 2 {
            point[2] = self.graph.constant(0.0);
        }
        let (Some(&pu), Some(&pv)) = (point.get(u), point.get(v)) else { return body };
        let sector = std::f64::consts::TAU / n * sign.signum();
        let angle = self.graph.op(Op::Atan2, &[pv, pu]);
        let per = self.graph.constant(1.0 / sector);
        let scaled = self.graph.op(Op::Mul, &[angle, per]);
        let near = self.graph.op(Op::Round, &[scaled]);
        let offset = self.graph.op(Op::Sub, &[scaled, near]);
        let count = self.graph.constant(n);
        let rings_i = rings as i32;
        let mut copies = Vec::new();
        for ring in -rings_i..=rings_i {
            let ring = self.graph.constant(f64::from(ring));
            let k = self.graph.op(Op::Add, &[near, ring]);
            let whole_turns = self.graph.op(Op::Div, &[k, count]);
            let whole_turns = self.graph.op(Op::Floor, &[whole_turns]);
            let whole_turns = self.graph.op(Op::Mul, &[count, whole_turns]);
            let index = self.graph.op(Op::Sub, &[k, whole_turns]);
            let back = self.graph.constant(-sector);
            let back = self.graph.op(Op::Mul, &[k, back]);
            let mut q = point;
            let tu = self.graph.op(Op::TurnU, &[pu, pv, back]);
            let tv = self.graph.op(Op::TurnV, &[pu, pv, back]);
            for (i, slot) in q.iter_mut().enumerate() {
                if i == u {
                    *slot = tu;
                } else if i == v {
                    *slot = tv;
                }
            }
            copies.push(self.call_with_index(body, q, variable, index));
        }
        let nearest = self.graph.balanced(Op::Min, &copies, FAR);
        // What is not looked at lies behind a half plane through the axis, so many sectors away.
        let first = self.graph.constant(rings + 1.0 - half);
        let away = self.graph.op(Op::Abs, &[offset]);
        let gap = self.graph.op(Op::Sub, &[first, away]);
        let width = self.graph.constant(sector.abs());
        let gap = self.graph.op(Op::Mul, &[gap, width]);
        let quarter = self.graph.constant(std::f64::consts::FRAC_PI_2);
        let gap = self.graph.op(Op::Min, &[gap, quarter]);
        let sine = self.graph.op(Op::Sin, &[gap]);
        let radius = self.graph.op(Op::Length2, &[pu, pv]);
        let cap = self.graph.op(Op::Mul, &[radius, sine]);
        // It is the distance to that half plane.
        let one = self.graph.constant(1.0);
        let cap = self.graph.intern(Node::Claim([cap].into(), Claim::Lipschitz(one, [].into(), None)));
        // Nor does any copy come nearer to the axis than the body does.
        let inner = self.graph.constant(inner);
        let inner = self.graph.op(Op::Sub, &[inner, radius]);
        let cap = self.graph.op(Op::Max, &[cap, inner]);
        let cap = self.at_least_outside(cap, &around, usize::from(dimensions));
        let cap = self.part_of(cap, share);
        let value = self.graph.op(Op::Min, &[nearest, cap]);
        self.note_capped(value, nearest, cap, sectors.least_cap(), span);
        let value = self.graph.intern(Node::Claim([value].into(), Claim::Continuous));
        self.facts.know_solid(value, around);
        self.make_shape(dimensions, value, span)
    }

    #[allow(clippy::too_many_arguments)]
    fn place_all(
        &mut self,
        body: ShapeId,
        variable: u32,
        axis: Option<([NodeId; 3], Span)>,
        count: NodeId,
        most: usize,
        dimensions: u8,
        span: Span,
    ) -> Elaborated<ShapeId> {
        let mut point = self.graph.point();
        if dimensions == 2 {
            point[2] = self.graph.constant(0.0);
        }
        let far = self.graph.constant(FAR);
        let zero = self.graph.constant(0.0);
        let one = self.graph.constant(1.0);
        let turn = self.graph.constant(-std::f64::consts::TAU);
        let mut copies = Vec::new();
        for k in 0..most {
            let index = self.graph.constant(k as f64);
            let part = self.graph.op(Op::Div, &[index, count]);
            let angle = self.graph.op(Op::Mul, &[part, turn]);
            let (axis, at) = axis.unwrap_or(([zero, zero, one], span));
            let Value::Vector(q) = self.turn_about(point, axis, angle, at)? else {
                return Err(Stop);
            };
            let &[a, b, c] = &*q else { return Err(Stop) };
            let copy = self.call_with_index(body, [a, b, c], variable, index);
            let present = self.graph.op(Op::Lt, &[index, count]);
            copies.push(self.graph.op(Op::Select, &[present, copy, far]));
        }
        let value = self.graph.balanced(Op::Min, &copies, FAR);
        Ok(self.make_shape(dimensions, value, span))
    }

    fn call_with_index(
        &mut self,
        body: ShapeId,
        point: [NodeId; 3],
        variable: u32,
        index: NodeId,
    ) -> NodeId {
        let bound = self.graph.shape(body).map(|s| s.variables.to_vec()).unwrap_or_default();
        let mut args = point.to_vec();
        for v in bound {
            args.push(if v == variable { index } else { self.graph.leaf(Leaf::Variable(v)) });
        }
        self.graph.call(body, crate::graph::Function::Field, &args)
    }
}

/// Sectors about an axis.
#[derive(Clone, Copy)]
struct Sectors {
    /// How many.
    n: f64,
    /// How many are looked at on either side.
    rings: f64,
    /// Half of the body's width, in sectors.
    half: f64,
    /// How near the body comes to the axis.
    inner: f64,
    /// A box that holds all copies.
    around: Box3,
    /// How much of the distance from it the body's field is at least.
    share: f64,
}

impl Sectors {
    /// Whether fewer than all are looked at, and not too many.
    fn are_few(&self) -> bool {
        2.0 * self.rings + 1.0 < self.n && 2.0 * self.rings < MOST_SECTORS
    }

    /// The least value of the cap: where the half plane beyond which others stand is as near as the axis is to the body.
    fn least_cap(&self) -> f64 {
        let gap = (self.rings + 0.5 - self.half) * std::f64::consts::TAU / self.n;
        let sine = gap.min(std::f64::consts::FRAC_PI_2).sin();
        self.share * self.inner * sine / (1.0 + sine)
    }
}
