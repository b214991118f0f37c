//! The gradient of a formula, as nodes. Where a formula jumps it has none; light and contact see a wall there, so the gradient of a shape's field
//! stands across a jump that is near enough to be met by a ray.

use crate::analysis::chain::DEEP;
use crate::functions::builder::Builder;
use crate::functions::found::{NearestJump, Slopes};
use crate::functions::jumps::{Jump, jump_epsilon};
use crate::functions::outline::Outline;
use crate::functions::sides::{Sides, Way};
use crate::graph::kernel::Op;
use crate::graph::partials::partials;
use crate::graph::{Exactness, Function, Leaf, Node, NodeId, ShapeId};
use rustc_hash::FxHashMap;
use smallvec::{SmallVec, smallvec};
use std::rc::Rc;

/// A wall is seen from so many times as far as a ray steps across it; and from so many times as far where it parts what is solid from what is not, and
/// the surface of this side is farther away: rays stop before a wall, the earlier the wider a pixel is.
const NEAR: [f64; 2] = [2.0, 32.0];

/// What a gradient is asked for.
#[derive(Clone, Copy, PartialEq)]
enum Seen {
    /// What formulas change by between their jumps.
    Pieces,
    /// That, and the walls of other shapes, which stand in their gradients.
    Walls,
}

fn known(slopes: &Slopes, id: NodeId) -> Option<[NodeId; 3]> {
    slopes.get(id.0 as usize).copied().flatten()
}

fn set(slopes: &mut Slopes, id: NodeId, slope: [NodeId; 3]) {
    let at = id.0 as usize;
    if at >= slopes.len() {
        slopes.resize(at + 1, None);
    }
    if let Some(slot) = slopes.get_mut(at) {
        *slot = Some(slope);
    }
}

impl Builder<'_> {
    /// The gradient of a node by the point of its space, as nodes: forward, by the kernel's partial derivatives. Between jumps.
    pub(super) fn gradient(&mut self, root: NodeId) -> [NodeId; 3] {
        let mut slopes = std::mem::take(&mut self.gradients.slopes);
        let found = self.gradient_of(root, &mut slopes, Seen::Pieces);
        self.gradients.slopes = slopes;
        found
    }

    /// The gradient of a shape's field, with its walls.
    pub(super) fn gradient_with_walls(&mut self, shape: ShapeId, value: NodeId) -> [NodeId; 3] {
        if self.is_outlined(shape) {
            // By its own formula, which elsewhere it stands for.
            self.gradients.own = Some(shape);
            let found = self.gradient_of(value, &mut Slopes::new(), Seen::Pieces);
            self.gradients.own = None;
            return found;
        }
        if !self.has_walls(shape) {
            return self.gradient(value);
        }
        let mut slopes = Slopes::new();
        let pieces = self.gradient_of(value, &mut slopes, Seen::Walls);
        let mut partials: SmallVec<[NodeId; 4]> = smallvec![self.graph.constant(1.0)];
        let mut inner: SmallVec<[[NodeId; 3]; 4]> = smallvec![pieces];
        if let Some(wall) = &*self.wall(shape) {
            for &(number, share) in &wall.across {
                partials.push(self.graph.op(Op::Mul, &[wall.steep, share]));
                inner.push(self.gradient_of(number, &mut slopes, Seen::Walls));
            }
        }
        self.chain_rule(&partials, &inner)
    }

    /// Whether the field of a shape, or of one that it calls, has walls.
    pub(super) fn has_walls(&mut self, shape: ShapeId) -> bool {
        if let Some(known) = self.gradients.walled.get(&shape) {
            return *known;
        }
        let Some(value) = self.graph.shape(shape).map(|s| s.value) else { return false };
        self.found.deep += 1;
        if self.found.deep > DEEP {
            for shape in self.graph.called_below(value, |shape| self.gradients.walled.contains_key(&shape)) {
                self.has_walls(shape);
            }
        }
        let mut nodes = Vec::new();
        let inner: Vec<ShapeId> = self.calls(&[value], &mut nodes).map(|(inner, _)| inner).collect();
        let found = self.wall(shape).is_some() || inner.into_iter().any(|inner| self.has_walls(inner));
        self.found.deep -= 1;
        self.gradients.walled.insert(shape, found);
        found
    }

    /// The wall that a shape's own formula makes.
    fn wall(&mut self, shape: ShapeId) -> Rc<Option<NearestJump>> {
        if let Some(known) = self.gradients.walls.get(&shape) {
            return known.clone();
        }
        let wall = Rc::new(self.find_wall(shape));
        self.gradients.walls.insert(shape, wall.clone());
        wall
    }

    fn find_wall(&mut self, shape: ShapeId) -> Option<NearestJump> {
        let value = self.graph.shape(shape).filter(|s| s.exactness != Exactness::Exact)?.value;
        let own = self.graph.reachable(&[value]);
        let jumps = |id: &NodeId| matches!(self.graph.node(*id), Node::Op(op, _) if is_wall(*op));
        if !own.iter().any(jumps) {
            return None;
        }
        let near = self.domain(shape);
        let mut sites = self.sites(value, &near);
        sites.retain(|site| {
            let mut known = || !matches!(self.distance_to_jump(site.op, &site.args, &near), Jump::Unknown);
            is_wall(site.op) && own.binary_search(&site.node).is_ok() && known()
        });
        let Sides { other, nearest, across, .. } = self.sides(value, &sites, &near, Way::About)?;
        let [narrow, wide] = NEAR.map(|times| times * jump_epsilon(&near));
        let [zero, narrow, wide, steep] = [0.0, narrow, wide, 1.0 / narrow].map(|c| self.graph.constant(c));
        let size = self.graph.op(Op::Abs, &[value]);
        let limit = self.graph.op(Op::Min, &[size, wide]);
        let [at, near] = [narrow, limit].map(|limit| self.graph.op(Op::Lt, &[nearest, limit]));
        // One side is solid, and the other is not.
        let [here, there] = [value, other].map(|side| self.graph.op(Op::Le, &[side, zero]));
        let [outside, beyond] = [here, there].map(|solid| self.graph.op(Op::Not, &[solid]));
        let [into, out] = [[outside, there], [here, beyond]].map(|sides| self.graph.op(Op::And, &sides));
        let apart = self.graph.op(Op::Or, &[into, out]);
        let near = self.graph.op(Op::And, &[near, apart]);
        let beside = self.graph.op(Op::Or, &[at, near]);
        let rise = self.graph.op(Op::Sub, &[other, value]);
        let steep = self.graph.op(Op::Mul, &[rise, steep]);
        Some(NearestJump { steep: self.graph.op(Op::Select, &[beside, steep, zero]), across })
    }

    fn gradient_of(&mut self, root: NodeId, slopes: &mut Slopes, seen: Seen) -> [NodeId; 3] {
        if let Some(known) = known(slopes, root) {
            return known;
        }
        for id in self.without_slope(root, slopes) {
            let slope = self.slope(id, slopes, seen);
            set(slopes, id, slope);
        }
        known(slopes, root).unwrap_or_default()
    }

    /// The nodes whose gradients a node's own is made of, in order, as far as they are not known.
    fn without_slope(&mut self, root: NodeId, slopes: &Slopes) -> Vec<NodeId> {
        let new = |id| known(slopes, id).is_none();
        let order = self.graph.reachable_among(&[root], new);
        let outlined: FxHashMap<NodeId, Outline> = order.iter().filter_map(|&id| Some((id, self.outline(id)?))).collect();
        if outlined.is_empty() {
            return order;
        }
        // What is inside of them is another function's.
        let graph = &*self.graph;
        let operands = |id: NodeId| outlined.get(&id).map_or_else(|| graph.arguments(id), |outline| &outline.operands[..]);
        graph.needed(&[root], operands, new)
    }

    /// The gradient of a node whose arguments have theirs.
    fn slope(&mut self, id: NodeId, slopes: &mut Slopes, seen: Seen) -> [NodeId; 3] {
        let zero = self.graph.constant(0.0);
        let flat = [zero; 3];
        let of = |slopes: &Slopes, a: &NodeId| known(slopes, *a).unwrap_or(flat);
        if let Some(outline) = self.outline(id) {
            let arguments = outline.arguments();
            let inner: SmallVec<[[NodeId; 3]; 4]> = arguments.iter().take(outline.read).filter(|_| outline.moves).map(|a| of(slopes, a)).collect();
            let partials = [0, 1, 2].map(|i| self.graph.call(outline.shape, Function::Gradient(i), arguments));
            let slope = self.chain_rule(&partials, &inner);
            let Some(by) = outline.by else { return slope };
            let mut value = self.graph.call(outline.shape, Function::Field, arguments);
            set(slopes, value, slope);
            for &other in outline.beside() {
                value = self.graph.op(by, &[value, other]);
            }
            return self.gradient_of(value, slopes, seen);
        }
        match self.graph.node(id).clone() {
            Node::Leaf(Leaf::P(i)) => {
                let mut unit = flat;
                if let Some(slot) = unit.get_mut(usize::from(i)) {
                    *slot = self.graph.constant(1.0);
                }
                unit
            }
            Node::Op(op @ (Op::Min | Op::Max), args) => {
                let (Some(&a), Some(&b)) = (args.first(), args.get(1)) else { return flat };
                let (ga, gb) = (of(slopes, &a), of(slopes, &b));
                let [a, b] = [a, b].map(|side| if seen == Seen::Walls { self.beside_walls(side, op == Op::Max) } else { side });
                let first = self.graph.op(Op::Le, &if op == Op::Min { [a, b] } else { [b, a] });
                self.pick(first, ga, gb)
            }
            Node::Op(Op::Select, args) => {
                let (Some(&c), Some(&a), Some(&b)) = (args.first(), args.get(1), args.get(2)) else { return flat };
                self.pick(c, of(slopes, &a), of(slopes, &b))
            }
            Node::Op(op, args) => {
                // A length does not change with what is kept at zero, so it is as steep by the number itself.
                let length = matches!(op, Op::Length2 | Op::Length3 | Op::Length4);
                let within = |a: NodeId| match self.graph.node(a) {
                    Node::Op(Op::Max, sides) if length && sides.get(1) == Some(&zero) => sides.first().copied().unwrap_or(a),
                    _ => a,
                };
                let inner: SmallVec<[[NodeId; 3]; 4]> = args.iter().map(|&a| of(slopes, &within(a))).collect();
                if inner.iter().all(|g| *g == flat) {
                    return flat;
                }
                let partials = partials(self.graph, op, &args, id);
                self.chain_rule(&partials, &inner)
            }
            Node::Call(shape, Function::Field, args) => {
                let inner: SmallVec<[[NodeId; 3]; 4]> = args.iter().map(|a| of(slopes, a)).collect();
                // The function of the module shows walls.
                let as_it_is = seen == Seen::Walls || !self.has_walls(shape);
                if as_it_is && inner.iter().skip(3).all(|g| *g == flat) {
                    let partials = [0, 1, 2].map(|i| self.graph.call(shape, Function::Gradient(i), &args));
                    return self.chain_rule(&partials, &inner);
                }
                // A variable moves too: the formula is opened here.
                let Some(value) = self.graph.shape(shape).map(|s| s.value) else { return flat };
                let opened = self.graph.open(shape, value, &args);
                self.gradient_of(opened, slopes, seen)
            }
            Node::Claim(args, _) => args.first().map_or(flat, |a| of(slopes, a)),
            _ => flat,
        }
    }

    /// A field that is as near to zero at a wall as the wall is: where shapes with walls are put together by the least or the greatest of them, what
    /// is met is found by their bounds. `deep`: within a drawing, as beneath a bevel, it is the field itself where no wall of its own is seen.
    fn beside_walls(&mut self, node: NodeId, deep: bool) -> NodeId {
        if let Some(known) = self.gradients.beside.get(&(node, deep)) {
            return *known;
        }
        let found = match self.graph.node(node).clone() {
            Node::Call(shape, Function::Field, args) if self.has_walls(shape) => {
                let bound = self.graph.call(shape, Function::Bound, &args);
                match &*self.wall(shape) {
                    Some(wall) if deep && self.graph.shape(shape).is_some_and(|s| s.dimensions == 2) => {
                        let steep = self.graph.open(shape, wall.steep, &args);
                        let zero = self.graph.constant(0.0);
                        let apart = self.graph.op(Op::Eq, &[steep, zero]);
                        self.graph.op(Op::Select, &[apart, node, bound])
                    }
                    _ => bound,
                }
            }
            Node::Op(op @ (Op::Min | Op::Max | Op::Neg), args) => {
                let args: SmallVec<[NodeId; 2]> = args.iter().map(|&a| self.beside_walls(a, deep)).collect();
                self.graph.op(op, &args)
            }
            _ => node,
        };
        self.gradients.beside.insert((node, deep), found);
        found
    }

    pub(super) fn pick(&mut self, condition: NodeId, a: [NodeId; 3], b: [NodeId; 3]) -> [NodeId; 3] {
        let mut chosen = a;
        for (slot, other) in chosen.iter_mut().zip(b) {
            *slot = self.graph.op(Op::Select, &[condition, *slot, other]);
        }
        chosen
    }

    pub(super) fn chain_rule(&mut self, partials: &[NodeId], inner: &[[NodeId; 3]]) -> [NodeId; 3] {
        let (zero, one) = (self.graph.constant(0.0), self.graph.constant(1.0));
        let mut total = [zero; 3];
        for (partial, gradient) in partials.iter().zip(inner) {
            for (slot, g) in total.iter_mut().zip(gradient).filter(|(_, g)| **g != zero) {
                let term = if *g == one { *partial } else { self.graph.op(Op::Mul, &[*partial, *g]) };
                *slot = if *slot == zero { term } else { self.graph.op(Op::Add, &[*slot, term]) };
            }
        }
        total
    }
}

/// Whether a jump of an operation makes a wall that has a direction.
fn is_wall(op: Op) -> bool {
    matches!(op, Op::Floor | Op::Ceil | Op::Trunc | Op::Round | Op::Hash | Op::Sign | Op::Lt | Op::Le | Op::Atan2)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::evaluate::Tape;
    use crate::graph::algebra::Reals;
    use crate::graph::{Function, kernel, partials};
    use crate::{MemoryLoader, Options, compile};

    /// Of a scene at a place: the direction of its gradient, and the estimate of the distance.
    fn seen(scene: &str, place: [f64; 3]) -> ([f64; 3], f64) {
        let loader = MemoryLoader::new().with("main.sdf", scene);
        let scene = compile(&loader, "main.sdf", &Options::default()).compiled.unwrap();
        let functions = [Function::Gradient(0), Function::Gradient(1), Function::Gradient(2), Function::Distance];
        let roots = functions.map(|f| scene.functions.formulas[&(scene.root, f)]);
        let tape = Tape::new(&scene.graph, &scene.functions.formulas, &roots, &scene.live(), 1_000_000).unwrap();
        let mut found = [0.0; 4];
        tape.evaluator().at(&[place], &[], |_, values| found.copy_from_slice(values));
        let [x, y, z, distance] = found;
        let length = (x * x + y * y + z * z).sqrt();
        ([x / length, y / length, z / length], distance)
    }

    fn assert_near(found: [f64; 3], expected: [f64; 3]) {
        assert!((0..3).all(|i| (found[i] - expected[i]).abs() < 1e-3), "{found:?}, not {expected:?}");
    }

    #[test]
    fn what_is_flat_has_no_slope() {
        // Of no grid and no outline nothing is known.
        for row in kernel::KERNEL.iter().filter(|row| !row.op.reads_data()) {
            let args = [0.3, 0.7, 0.2, 0.9];
            let args = &args[..usize::from(row.arity)];
            let slopes = partials::partials(&mut Reals, row.op, args, (row.value)([0.3, 0.7, 0.2, 0.9]));
            assert_eq!(slopes == [0.0; 4], row.op.is_flat(), "{}", row.name);
        }
    }

    #[test]
    fn a_wall_faces_away_from_what_is_solid() {
        let stairs = "field f = p.y - 0.25 * floor(4 * p.x)\nscene = f.within(box(8))";
        assert_near(seen(stairs, [0.2, 0.1, 0.0]).0, [0.0, 1.0, 0.0]);
        assert_near(seen(stairs, [0.250_001, 0.1, 0.0]).0, [-1.0, 0.0, 0.0]);
        let chosen = "field f = if p.x + p.z < 0.5 { length(p) - 1 } else { length(p) - 0.5 }\nscene = f.within(box(8))";
        let half = 0.5f64.sqrt();
        assert_near(seen(chosen, [0.25, 0.8, 0.25 + 1e-6]).0, [half, 0.0, half]);
        // Where an angle starts anew: the end of what winds about the axis faces along the circle.
        let spiral = "field f = { let a = atan2(p.y, p.x); length((length(p.xy) - 1 - 0.15 * a, p.z)) - 0.3 }\nscene = f.within(box(6))";
        assert_near(seen(spiral, [-1.5, -1e-6, 0.0]).0, [0.0, -1.0, 0.0]);
        // Each axis by itself, and the shape is turned.
        let blocks = "field f = length(round(4 * p) / 4) - 1\nscene = f.within(box(4)).rotate(z, 90deg)";
        assert_near(seen(blocks, [0.1, 1.125 - 1e-6, 0.1]).0, [0.0, 1.0, 0.0]);
    }

    #[test]
    fn a_wall_is_near_where_it_is_and_not_where_it_might_be() {
        // Far away what jumps changes a thousand times as fast as here, where the jump is far.
        let rod = "fn g(q: vec2) = { let h = q.x * q.x * q.y + q.y * q.y * q.x - 9; sqrt(if h < 0 { q.y * q.y } else { 0.25 }) }\n\
                   field f = length((g((2 * p.x, p.y)), p.z)) - 0.15\nscene = f";
        let half = 0.5f64.sqrt();
        assert_near(seen(rod, [0.1, 0.15 * half, 0.15 * half]).0, [0.0, half, half]);
    }

    #[test]
    fn a_wall_that_is_only_passed_is_not_near() {
        let stairs = "field f = p.y - 0.25 * floor(4 * p.x)\nscene = smooth_union(f, sphere(1), 0.1).within(box(8))";
        let [beside, at] = [0.26, 0.250_001].map(|x| seen(stairs, [x, 2.5, 0.0]).1);
        assert!((beside - at).abs() < 0.02 && at > 0.5, "{beside} {at}");
    }

    #[test]
    fn beneath_a_bevel_a_wall_is_not_near_where_it_might_be() {
        // The bore of a gear by angle; of a number of teeth that may be another one nobody knows that the angle's cut is none.
        let gear = |teeth: &str| {
            format!(
                "{teeth}\nfield2 f = length(p) - 1.5 - 0.12 * clamp(3 * cos(n * atan(p.y, p.x)), -1, 1)\nscene = (f - circle(0.4)).extrude(0.5, 0.05)"
            )
        };
        let [live, still] = ["param n: int = 18 in 6..40", "let n = 18"].map(gear);
        for i in 0..16 {
            let angle = 0.1 + 0.39 * f64::from(i);
            let place = [0.42 * angle.cos(), 0.42 * angle.sin(), 0.22];
            assert_near(seen(&live, place).0, seen(&still, place).0);
        }
    }

    #[test]
    fn what_is_claimed_to_be_continuous_has_no_walls() {
        // A wall of the noise's cells.
        let waves = "scene = plane(y).displace(0.2 * value_noise(p)).within(box(8))";
        let [beside, at] = [0.999, 1.0].map(|x| seen(waves, [x, 0.1, 0.3]).0);
        assert_near(beside.map(|c| (c * 100.0).round() / 100.0), at.map(|c| (c * 100.0).round() / 100.0));
    }

    #[test]
    fn walls_of_what_has_no_slope_are_seen() {
        let city = "field f = p.y - 2 * hash(floor(p.x), floor(p.z))\n";
        let alone = format!("{city}scene = f.within(box(20))");
        let heights = [0.5, 1.5].map(|x| -(0..400).map(|i| f64::from(i) * 0.005).find(|&y| seen(&alone, [x, y, 0.5]).1 > 0.0).unwrap());
        assert!((heights[0] - heights[1]).abs() > 0.05, "{heights:?}");
        let between = -(heights[0] + heights[1]) / 2.0;
        let away = if heights[0] < heights[1] { 1.0 } else { -1.0 };
        assert_near(seen(&alone, [1.0 + 1e-5 * away, between, 0.5]).0, [away, 0.0, 0.0]);
        // Nearer to another shape than to the ground, yet on the wall.
        let [x, y] = [1.0 + 0.2 * away, between];
        let beside = format!("{city}scene = f.within(box(20)) | sphere(0.1).translate({x}, {y}, 0.5)");
        assert_near(seen(&beside, [1.0 + 1e-5 * away, between, 0.5]).0, [away, 0.0, 0.0]);
    }
}
