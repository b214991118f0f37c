//! Repetition along axes: as many neighbours as the body reaches.
//!
//! The value is the smallest over the copies that are looked at, and over the least distance at which a copy that is not looked
//! at may begin. So it is continuous, keeps the Lipschitz constant of the body, and its zero set is that of all copies.

use super::value::Value;
use super::{Elaborated, Elaborator, Env, Stop};
use crate::analysis::region::WORLD_SIDE;
use crate::analysis::Box3;
use crate::diagnostic::Code;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Claim, Leaf, Node, NodeId, ShapeId, FAR};
use crate::source::Span;
use crate::syntax::ast::For;

/// At most so many cells are looked at along one axis.
const MOST_CELLS: usize = 8;
/// At most so many copies are looked at, all together.
pub(super) const MOST_COPIES: usize = 128;

impl Elaborator<'_> {
    /// `for cell in grid(size, count) { body }`. `given`: the arguments of `grid`.
    pub fn grid(
        &mut self,
        each: &For,
        given: &[(Value, Span)],
        span: Span,
        env: &Env,
    ) -> Elaborated<Value> {
        let (size, count) = match given {
            [size] => (size.clone(), None),
            [size, count] => (size.clone(), Some(count.clone())),
            _ => {
                return Err(self.error(
                    Code::MissingArgument,
                    each.source.span,
                    "`grid` needs the size of its cells",
                    "write `grid((2, 0, 2))`; zero along an axis means that it is not repeated there",
                ));
            }
        };
        let dimensions = match &size.0 {
            Value::Vector(v) if v.len() == 2 => 2,
            _ => 3,
        };
        let sizes = self.to_vector(&size.0, dimensions, size.1)?;
        let counts = match &count {
            Some((count, at)) => Some((self.to_vector(count, dimensions, *at)?, *at)),
            None => None,
        };
        let variables: Vec<u32> = (0..3).map(|_| self.graph.fresh_variable()).collect();
        let cell_leaves: Vec<NodeId> =
            variables.iter().map(|&v| self.graph.leaf(Leaf::Variable(v))).collect();
        let inner = env
            .with(&each.index.text, Value::Vector(cell_leaves.iter().take(dimensions).copied().collect()))
            .at(None);
        let body = self.expression(&each.body, &inner)?;
        if matches!(body, Value::Nothing) {
            return Ok(Value::Nothing);
        }
        let body = self.repeated(&body, dimensions as u8, each, "grid((2, 0, 2))")?;
        // What the cells can be, and how far the body reaches over all of them.
        let mut axes = Vec::new();
        for (i, &size_node) in sizes.iter().enumerate() {
            let range = self.facts.live_range(&self.graph, size_node);
            if range.lo < 0.0 {
                return Err(self.error(
                    Code::BadValue,
                    size.1,
                    format!("a cell's size is {}", range.lo),
                    "write a size greater than zero, or zero along an axis that is not repeated",
                ));
            }
            if range.hi == 0.0 {
                continue;
            }
            if range.lo == 0.0 {
                return Err(self.error(
                    Code::BadValue,
                    size.1,
                    "a cell's size can become zero",
                    "let the parameter's range begin above zero",
                ));
            }
            let count = match &counts {
                Some((counts, at)) => {
                    let count = counts.get(i).copied().ok_or(Stop)?;
                    let range = self.facts.live_range(&self.graph, count);
                    let constant = self.graph.as_constant(count);
                    if range.lo < 1.0 || constant.is_some_and(|c| c.fract() != 0.0) {
                        return Err(self.error(
                            Code::BadValue,
                            *at,
                            format!("there can't be {} cells", constant.unwrap_or(range.lo)),
                            "write a whole number of at least one",
                        ));
                    }
                    // A live count is a whole number.
                    let whole = self.graph.op(Op::Round, &[count]);
                    Some((whole, range.hi))
                }
                None => None,
            };
            axes.push(Axis { index: i, size: size_node, range, count, reach: 0.0, rings: 0, share: 1.0 });
        }
        let numbers = [0, 1, 2].map(|i| match axes.iter().find(|a| a.index == i) {
            None => (0.0, 0.0),
            Some(Axis { count: Some((_, most)), .. }) => (0.0, most - 1.0),
            Some(_) => (-1e6, 1e6),
        });
        let cells = |variable: u32| numbers.get(variables.iter().position(|&v| v == variable)?).copied();
        let region = self.body_box(body, &cells);
        // The largest body and the smallest cell never meet where both follow one parameter.
        let together = match axes.iter().any(|axis| axis.range.lo < axis.range.hi) {
            true => "where the body follows the size of the cells, repeat it once and scale the whole, `body.repeat(1).scale(size)`; else ",
            false => "",
        };
        for axis in &mut axes {
            let side = region.axis(axis.index);
            axis.reach = side.magnitude();
            let unbounded = !side.is_finite() || axis.reach >= self.extent.max(WORLD_SIDE);
            if side.is_empty() {
                axis.reach = 0.0;
            } else if unbounded || !axis.fit() {
                let name = ["x", "y", "z"].get(axis.index).copied().unwrap_or("x");
                let why = if unbounded {
                    format!("the body reaches without end along {name}")
                } else {
                    format!("the body reaches {:.3} from its cell's middle along {name}, and a cell is {} wide", axis.reach, axis.range.lo)
                };
                return Err(self.error(
                    Code::NoReach,
                    span,
                    why,
                    format!("{together}make the cells larger, bound the body with `.within(…)`, or do not repeat along {name} (size 0)"),
                ));
            }
        }
        let copies = copies(&axes);
        if copies > MOST_COPIES {
            return Err(self.error(
                Code::NoReach,
                span,
                format!("the body reaches so far that {copies} copies would be looked at for each point"),
                format!("{together}make the cells larger, or the body smaller"),
            ));
        }
        let shares = |e: &mut Self, axes: &mut [Axis]| {
            for axis in axes.iter_mut().filter(|axis| axis.reach > 0.0) {
                let next = axis.rings as f64 + 1.0;
                let distances = next * axis.range.lo - axis.reach..(next + 0.5) * axis.range.hi - axis.reach;
                axis.share = e.share_of_distance(body, &cells, &region, distances, &[axis.index]);
            }
        };
        shares(self, &mut axes);
        if let Some(level) = self.level_read(span) {
            if !look_as_far_as(level, &mut axes) {
                self.say_too_far(level, least_cap(&axes), span);
            }
            shares(self, &mut axes);
        }
        // All cells together: those of a counted axis reach so far, those of an endless one everywhere.
        let mut around = region;
        for axis in &axes {
            let side = match axis.count {
                Some((_, most)) => {
                    let widest = self.facts.live_range(&self.graph, axis.size).hi;
                    let far = (most - 1.0) / 2.0 * widest + axis.reach;
                    Interval::new(-far.next_up(), far.next_up())
                }
                None => Interval::ALL,
            };
            around = around.with_axis(axis.index, side);
        }
        let id = self.place_cells(&axes, &variables, body, &around, dimensions, span);
        if let Some(value) = self.graph.shape(id).map(|s| s.value) {
            self.facts.know_solid(value, around);
        }
        Ok(Value::Shape(id))
    }

    fn place_cells(
        &mut self,
        axes: &[Axis],
        variables: &[u32],
        body: ShapeId,
        around: &Box3,
        dimensions: usize,
        span: Span,
    ) -> ShapeId {
        let point = self.graph.point();
        let zero = self.graph.constant(0.0);
        let half = self.graph.constant(0.5);
        let one = self.graph.constant(1.0);
        // Along each axis: the candidates' coordinate and cell number; and the cap.
        let mut choices: Vec<Vec<(NodeId, NodeId)>> =
            point.iter().map(|&c| vec![(c, zero)]).collect();
        let mut cap: Option<NodeId> = None;
        for axis in axes {
            let Some(&coordinate) = point.get(axis.index) else { continue };
            // With a count the cells stand centred as a whole.
            let shift = match axis.count {
                Some((n, _)) => {
                    let last = self.graph.op(Op::Sub, &[n, one]);
                    self.graph.op(Op::Mul, &[last, half])
                }
                None => zero,
            };
            let scaled = self.graph.op(Op::Div, &[coordinate, axis.size]);
            let scaled = self.graph.op(Op::Add, &[scaled, shift]);
            let near = self.graph.op(Op::Round, &[scaled]);
            let near = self.clamp_cell(near, axis.count);
            let offset = self.graph.op(Op::Sub, &[scaled, near]);
            // The side toward which the point lies in its cell: 1 or -1.
            let below = self.graph.op(Op::Lt, &[offset, zero]);
            let minus = self.graph.constant(-1.0);
            let side = self.graph.op(Op::Select, &[below, minus, one]);
            let mut candidates = Vec::new();
            let rings = axis.rings as i32;
            let mut cells: Vec<NodeId> = (-rings..=rings)
                .map(|ring| {
                    let ring = self.graph.constant(f64::from(ring));
                    self.graph.op(Op::Add, &[near, ring])
                })
                .collect();
            if axis.reach > 0.0 {
                let beyond = self.graph.constant(f64::from(rings + 1));
                let step = self.graph.op(Op::Mul, &[side, beyond]);
                cells.push(self.graph.op(Op::Add, &[near, step]));
            }
            for cell in cells {
                let cell = self.clamp_cell(cell, axis.count);
                let from = self.graph.op(Op::Sub, &[cell, shift]);
                let middle = self.graph.op(Op::Mul, &[from, axis.size]);
                candidates.push((self.graph.op(Op::Sub, &[coordinate, middle]), cell));
            }
            if let Some(slot) = choices.get_mut(axis.index) {
                *slot = candidates;
            }
            // Copies beyond those looked at begin at least so far away: (rings + 1 + |offset|) cells less the reach.
            let away = self.graph.op(Op::Abs, &[offset]);
            // Far outside of a counted grid the offset grows; the nearest copy is then looked at.
            let away = self.graph.op(Op::Min, &[away, half]);
            let first = self.graph.constant(f64::from(rings + 1));
            let cells_away = self.graph.op(Op::Add, &[first, away]);
            let distance = self.graph.op(Op::Mul, &[cells_away, axis.size]);
            let reach = self.graph.constant(axis.reach);
            let distance = self.graph.op(Op::Sub, &[distance, reach]);
            cap = Some(match cap {
                Some(cap) => self.graph.op(Op::Min, &[cap, distance]),
                None => distance,
            });
        }
        let mut copies = Vec::new();
        let bound: Vec<u32> =
            self.graph.shape(body).map(|s| s.variables.to_vec()).unwrap_or_default();
        let [xs, ys, zs] = choices.as_slice() else { return body };
        for (x, cx) in xs {
            for (y, cy) in ys {
                for (z, cz) in zs {
                    let z = if dimensions == 2 { &zero } else { z };
                    let mut args = vec![*x, *y, *z];
                    for &variable in &bound {
                        let cell = variables.iter().position(|&v| v == variable);
                        args.push(match cell {
                            Some(0) => *cx,
                            Some(1) => *cy,
                            Some(_) => *cz,
                            None => self.graph.leaf(Leaf::Variable(variable)),
                        });
                    }
                    copies.push(self.graph.call(body, crate::graph::Function::Field, &args));
                }
            }
        }
        let nearest = self.graph.balanced(Op::Min, &copies, FAR);
        let value = match cap {
            Some(cap) => {
                let cap = self.at_least_outside(cap, around, dimensions);
                let cap = self.part_of(cap, least_share(axes));
                let value = self.graph.op(Op::Min, &[nearest, cap]);
                self.note_capped(value, nearest, cap, least_cap(axes), span);
                value
            }
            None => nearest,
        };
        // At a wall between cells the copies that are looked at change, and the cap is at or below what
        // comes and goes; so the jumps of the cell's number cancel.
        let value = self.graph.intern(Node::Claim([value].into(), Claim::Continuous));
        self.make_shape(dimensions as u8, value, span)
    }

    /// A cap, or the distance to a box that holds all copies, if that is more: none is nearer than that either.
    pub(super) fn at_least_outside(&mut self, cap: NodeId, around: &Box3, dimensions: usize) -> NodeId {
        // What reaches to the extent goes on there.
        let ends = |side: &Interval| !side.is_empty() && side.magnitude() < 0.99 * self.extent;
        let slabs: Vec<(usize, Interval)> = (0..dimensions).map(|i| (i, around.axis(i))).filter(|(_, side)| ends(side)).collect();
        let ways = self.graph.beyond(slabs);
        let Some(outside) = self.graph.together(&ways) else { return cap };
        self.graph.op(Op::Max, &[cap, outside])
    }

    /// As much of a cap as the field of a body is at that distance.
    pub(super) fn part_of(&mut self, cap: NodeId, share: f64) -> NodeId {
        if share >= 1.0 {
            return cap;
        }
        let share = self.graph.constant(share);
        self.graph.op(Op::Mul, &[share, cap])
    }

    fn clamp_cell(&mut self, cell: NodeId, count: Option<(NodeId, f64)>) -> NodeId {
        let Some((count, _)) = count else { return cell };
        let zero = self.graph.constant(0.0);
        let one = self.graph.constant(1.0);
        let last = self.graph.op(Op::Sub, &[count, one]);
        let cell = self.graph.op(Op::Max, &[cell, zero]);
        self.graph.op(Op::Min, &[cell, last])
    }
}

/// One axis of a grid.
struct Axis {
    index: usize,
    size: NodeId,
    /// All that the size can be.
    range: Interval,
    /// The number of cells where it ends, and the most that it can be.
    count: Option<(NodeId, f64)>,
    /// How far the body reaches from its cell's middle.
    reach: f64,
    /// Cells looked at on either side, besides the nearest and one more.
    rings: usize,
    /// How much of the distance from it the body's field is at least.
    share: f64,
}

impl Axis {
    /// Looks for the number of neighbours: what is not looked at shall begin a quarter of a cell away at least.
    fn fit(&mut self) -> bool {
        let needed = self.reach / self.range.lo + 0.25 - 1.0;
        let rings = needed.max(0.0).ceil();
        self.rings = rings as usize;
        2.0 * rings + 2.0 <= MOST_CELLS as f64
    }

    /// How far copies that are not looked at are away, at least.
    fn least_cap(&self) -> f64 {
        (self.rings as f64 + 1.0) * self.range.lo - self.reach
    }
}

/// How many copies are looked at, all together.
fn copies(axes: &[Axis]) -> usize {
    axes.iter().map(|axis| 2 * axis.rings + 2).product()
}

/// How much of a distance the body's field is along all axes, at least.
fn least_share(axes: &[Axis]) -> f64 {
    axes.iter().fold(1.0, |share, axis| share.min(axis.share))
}

/// The least value of the cap.
fn least_cap(axes: &[Axis]) -> f64 {
    axes.iter().map(Axis::least_cap).fold(FAR, f64::min) * least_share(axes)
}

/// Looks at more cells, until the value is right up to a level; false where those would be too many.
fn look_as_far_as(level: f64, axes: &mut [Axis]) -> bool {
    while least_cap(axes) < level {
        let nearest = axes.iter().enumerate().min_by(|a, b| a.1.least_cap().total_cmp(&b.1.least_cap())).map(|(i, _)| i);
        let Some(nearest) = nearest else { break };
        let grow = |axes: &mut [Axis], rings: fn(usize) -> usize| {
            if let Some(axis) = axes.get_mut(nearest) {
                axis.rings = rings(axis.rings);
            }
        };
        grow(axes, |rings| rings + 1);
        if axes.iter().any(|axis| 2 * axis.rings + 2 > MOST_CELLS) || copies(axes) > MOST_COPIES {
            grow(axes, |rings| rings - 1);
            return false;
        }
    }
    true
}
