//! Both sides of a jump. Within the distance to its second nearest jump a formula is one of two: as it is here, or as it is on the other side of
//! the nearest. Light sees how it changes from one to the other as a wall, and a ray passes the jump where both are far from zero.

use crate::analysis::Domain;
use crate::analysis::search::ROUNDING;
use crate::functions::bound_strategy::BoundStrategy;
use crate::functions::builder::Builder;
use crate::functions::jumps::{Jump, Site};
use crate::functions::limits::{BUDGET, STEEPEST};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{FAR, Node, NodeId, Proof};
use crate::rules::Rule;
use rustc_hash::FxHashMap;
use std::f64::consts::TAU;

/// Of more jumps only the distance is known.
const MOST: usize = 8;
/// What changes slower does not change.
const LEAST: f64 = 1e-9;

/// What the way to a jump is asked for.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Way {
    /// A ray: no jump is nearer.
    AtLeast,
    /// Light: about how near it is, by how steep what jumps is here.
    About,
}

/// A formula beside its nearest jump.
pub(super) struct Sides {
    /// The formula as it is on the other side.
    pub(super) other: NodeId,
    /// How far it is to the nearest jump, at least.
    pub(super) nearest: NodeId,
    /// How far it is to the next one, at least; none where there is no other.
    beyond: Option<NodeId>,
    /// The arguments by which the formula jumps. With each what is 1 or -1 where the nearest jump is one of it, as the other side lies where the
    /// argument is greater or less, and 0 where it is not.
    pub(super) across: Vec<(NodeId, NodeId)>,
}

/// A jump of an operation by one of its arguments.
struct Side {
    site: NodeId,
    op: Op,
    argument: NodeId,
    nearest: NodeId,
    next: Option<NodeId>,
    /// 1 where the other side lies where the argument is greater, else -1.
    rising: NodeId,
    /// The operation's value there.
    other: NodeId,
}

impl Builder<'_> {
    /// The other side of the nearest of these jumps of a formula. None where one of them is not known well enough, is another shape's, or there
    /// are many.
    pub(super) fn sides(&mut self, node: NodeId, sites: &[Site], near: &Domain, way: Way) -> Option<Sides> {
        // Those of other shapes stand in formulas of their own.
        let own = self.graph.reachable(&[node]);
        if !sites.iter().all(|s| own.binary_search(&s.node).is_ok()) || self.calls_what_jumps(node, near) {
            return None;
        }
        let mut all = Vec::new();
        for site in sites {
            self.sides_of(site, near, way, &mut all)?;
        }
        let (first, rest) = all.split_first().filter(|_| all.len() <= MOST)?;
        let nearest = rest.iter().fold(first.nearest, |nearest, side| self.graph.op(Op::Min, &[nearest, side.nearest]));
        let zero = self.graph.constant(0.0);
        // Which of them is the nearest; nothing to ask where there is one. Of two in the same place of which one follows from the other it is that other:
        // where it leads is another place on its other side.
        let choices: Vec<Option<NodeId>> = all
            .iter()
            .map(|side| {
                if rest.is_empty() {
                    return None;
                }
                let chosen = self.graph.op(Op::Le, &[side.nearest, nearest]);
                let read = self.graph.reachable(&[side.argument]);
                let before = all.iter().filter(|other| other.site != side.site && read.binary_search(&other.site).is_ok());
                let before = before.map(|other| other.nearest).reduce(|a, b| self.graph.op(Op::Min, &[a, b]));
                Some(before.map_or(chosen, |before| {
                    let alone = self.graph.op(Op::Lt, &[side.nearest, before]);
                    self.graph.op(Op::And, &[chosen, alone])
                }))
            })
            .collect();
        let mut beyond: Option<NodeId> = None;
        let mut across = Vec::new();
        for (side, chosen) in all.iter().zip(&choices) {
            let other = match (*chosen, side.next) {
                (None, next) => next,
                (Some(chosen), next) => {
                    let next = next.unwrap_or_else(|| self.graph.constant(FAR));
                    let unchosen = if way == Way::AtLeast { self.way_on_both(side, sites, (&all, &choices), near)? } else { side.nearest };
                    Some(self.graph.op(Op::Select, &[chosen, next, unchosen]))
                }
            };
            beyond = match (beyond, other) {
                (Some(a), Some(b)) => Some(self.graph.op(Op::Min, &[a, b])),
                (a, b) => a.or(b),
            };
            let share = chosen.map_or(side.rising, |chosen| self.graph.op(Op::Select, &[chosen, side.rising, zero]));
            across.push((side.argument, share));
        }
        let other = self.across(node, (&all, &choices))?;
        Some(Sides { other, nearest, beyond, across })
    }

    /// A formula as it is across those of some jumps that are chosen.
    fn across(&mut self, node: NodeId, (all, chosen): (&[Side], &[Option<NodeId>])) -> Option<NodeId> {
        self.rebuilt(node, &mut |builder, id, args| {
            let mut mine = all.iter().zip(chosen).filter(|(side, _)| side.site == id).peekable();
            let Some((side, _)) = mine.peek() else { return Some(None) };
            let here = builder.graph.op(side.op, args);
            Some(Some(mine.fold(here, |here, (side, chosen)| match *chosen {
                None => side.other,
                Some(chosen) if matches!(side.op, Op::Lt | Op::Le) => {
                    let other = builder.graph.op(Op::And, &[chosen, side.other]);
                    let still = builder.graph.op(Op::Not, &[chosen]);
                    let here = builder.graph.op(Op::And, &[still, here]);
                    builder.graph.op(Op::Or, &[other, here])
                }
                Some(chosen) => builder.graph.op(Op::Select, &[chosen, side.other, here]),
            })))
        })
    }

    /// How far it is at least to a jump that is not the nearest, neither as things are here nor as they are across the nearest, where its argument may
    /// be another one. None where that is not known.
    fn way_on_both(&mut self, side: &Side, sites: &[Site], nearest: (&[Side], &[Option<NodeId>]), near: &Domain) -> Option<NodeId> {
        if !self.follows(&[side.argument], sites, Some(side.site)) {
            return Some(side.nearest);
        }
        // As what jumps goes on where the other side is, it may be steeper.
        let here = self.facts.constant(self.graph, side.argument, near, 16).lipschitz;
        let steepest = self.constant_of_sides(side.argument, sites, near)?.max(here);
        let across = self.across(side.nearest, nearest)?;
        let share = self.graph.constant(if steepest > 0.0 { here / steepest } else { 1.0 });
        let across = self.graph.op(Op::Mul, &[share, across]);
        Some(self.graph.op(Op::Min, &[side.nearest, across]))
    }

    fn sides_of(&mut self, site: &Site, near: &Domain, way: Way, all: &mut Vec<Side>) -> Option<()> {
        let [zero, one, half] = [0.0, 1.0, 0.5].map(|c| self.graph.constant(c));
        if let (Op::Atan2, Some(&argument)) = (site.op, site.args.first()) {
            // Where what is never below zero stays at zero, an angle goes over to another one than across its cut.
            if self.facts.range(self.graph, argument, near).lo >= 0.0 {
                return None;
            }
            // Across its cut an angle is a whole turn more or less.
            let Jump::From(nearest) = self.distance_to_jump(site.op, &site.args, near) else { return None };
            let below = self.graph.op(Op::Lt, &[site.node, zero]);
            let rising = self.toward(below);
            let turn = self.graph.constant(TAU);
            let turn = self.graph.op(Op::Mul, &[turn, rising]);
            let other = self.graph.op(Op::Add, &[site.node, turn]);
            all.push(Side { site: site.node, op: site.op, argument, nearest, next: None, rising, other });
            return Some(());
        }
        for (argument, gap) in self.gaps(site.op, &site.args, near) {
            let Jump::From(mut nearest) = self.way_across(gap, argument, near) else { return None };
            if way == Way::About && let Some(about) = self.way_by_slope(gap, argument) {
                nearest = about;
            }
            let (rising, other, repeats) = match site.op {
                Op::Floor | Op::Ceil | Op::Trunc => {
                    let whole = self.nearest_whole(site.op, argument, near);
                    let [below, up_to] = [Op::Lt, Op::Le].map(|op| self.graph.op(op, &[argument, whole]));
                    let below = match site.op {
                        Op::Floor => below,
                        Op::Ceil => up_to,
                        // Below zero it jumps as `ceil` does.
                        _ => {
                            let negative = self.graph.op(Op::Lt, &[whole, zero]);
                            let up_to = self.graph.op(Op::And, &[negative, up_to]);
                            self.graph.op(Op::Or, &[below, up_to])
                        }
                    };
                    let rising = self.toward(below);
                    let within = self.graph.op(Op::Mul, &[half, rising]);
                    let within = self.graph.op(Op::Add, &[whole, within]);
                    (rising, self.graph.op(site.op, &[within]), true)
                }
                Op::Round | Op::Hash => {
                    let cell = self.graph.op(Op::Round, &[argument]);
                    let above = self.graph.op(Op::Le, &[cell, argument]);
                    let rising = self.toward(above);
                    let next = self.graph.op(Op::Add, &[cell, rising]);
                    let args: Vec<NodeId> = site.args.iter().map(|&a| if a == argument { next } else { a }).collect();
                    (rising, if site.op == Op::Round { next } else { self.graph.op(Op::Hash, &args) }, true)
                }
                Op::Sign => {
                    let below = self.graph.op(Op::Lt, &[argument, zero]);
                    let rising = self.toward(below);
                    (rising, rising, false)
                }
                Op::Lt | Op::Le => (self.toward(site.node), self.graph.op(Op::Not, &[site.node]), false),
                _ => return None,
            };
            let next = match repeats {
                true => {
                    let gap = self.graph.op(Op::Sub, &[one, gap]);
                    let Jump::From(next) = self.way_across(gap, argument, near) else { return None };
                    Some(next)
                }
                false => None,
            };
            all.push(Side { site: site.node, op: site.op, argument, nearest, next, rising, other });
        }
        Some(())
    }

    /// About how far it is to where a node has changed by `gap`, as fast as it changes here. None where it changes as fast everywhere.
    fn way_by_slope(&mut self, gap: NodeId, node: NodeId) -> Option<NodeId> {
        let gradient = self.gradient(node);
        if gradient.iter().all(|&g| self.is_uniform(g)) {
            return None;
        }
        let slope = self.graph.op(Op::Length3, &gradient);
        let least = self.graph.constant(LEAST);
        let slope = self.graph.op(Op::Max, &[slope, least]);
        Some(self.graph.op(Op::Div, &[gap, slope]))
    }

    /// 1 where a condition holds, else -1.
    fn toward(&mut self, condition: NodeId) -> NodeId {
        let [one, minus] = [1.0, -1.0].map(|c| self.graph.constant(c));
        self.graph.op(Op::Select, &[condition, one, minus])
    }

    /// How far a ray may step at least by a formula that jumps at these operations, where both sides of the nearest jump are of one sign; less than
    /// nothing where they are not. None where one of them is not known well enough. No bound of the pieces changes faster than the way. The other side may
    /// jump at `seams`, at which the formula does not.
    pub(super) fn past_jump(&mut self, node: NodeId, sites: &[Site], seams: &[Site], near: &Domain, strategy: &BoundStrategy) -> Option<NodeId> {
        if !self.facts.rules.has(Rule::FarSides) {
            return None;
        }
        // Just where it changes, a sign is neither of its sides.
        if sites.iter().any(|s| s.op == Op::Sign) {
            return None;
        }
        let sides = self.sides(node, sites, near, Way::AtLeast)?;
        let all = match strategy.proof {
            Proof::Measured => strategy.constant,
            _ => self.constant_of_sides(node, sites, near)?.max(strategy.constant) * (1.0 + ROUNDING),
        };
        let [zero, share] = [0.0, 1.0 / all].map(|c| self.graph.constant(c));
        let inside = self.graph.op(Op::Lt, &[node, zero]);
        let minus = self.graph.op(Op::Neg, &[sides.other]);
        let size = self.graph.op(Op::Select, &[inside, minus, sides.other]);
        let size = self.graph.op(Op::Mul, &[size, share]);
        let mut past = sides.beyond.map_or(size, |beyond| self.graph.op(Op::Min, &[size, beyond]));
        for seam in seams {
            let follows = self.follows(&seam.args, sites, None);
            match self.distance_to_jump(seam.op, &seam.args, near) {
                Jump::Nowhere => {}
                Jump::From(seam) if !follows => past = self.graph.op(Op::Min, &[past, seam]),
                _ => return None,
            }
        }
        Some(past)
    }

    /// How steep either side of a jump is, as it goes on where the other one is. None where that is not known.
    fn constant_of_sides(&mut self, node: NodeId, sites: &[Site], near: &Domain) -> Option<f64> {
        let mut free = near.clone();
        let either = self.rebuilt(node, &mut |builder, id, args| {
            let Some(site) = sites.iter().find(|s| s.node == id) else { return Some(None) };
            let most = if site.op == Op::Atan2 { TAU } else { 1.0 };
            let number = free.free_number(builder.graph, Interval::new(-most, most));
            let here = builder.graph.op(site.op, args);
            Some(Some(match site.op {
                Op::Lt | Op::Le => {
                    let zero = builder.graph.constant(0.0);
                    builder.graph.op(Op::Lt, &[number, zero])
                }
                Op::Hash => number,
                _ => builder.graph.op(Op::Add, &[here, number]),
            }))
        })?;
        let found = self.facts.constant(self.graph, either, &free, BUDGET).lipschitz;
        (found <= STEEPEST).then_some(found)
    }

    /// A formula made anew, with other nodes where `exchange` answers with one, asked with a node and its new arguments. None where it answers with
    /// none at all, or where what is claimed of a part does not hold of the new one.
    pub(super) fn rebuilt(
        &mut self,
        root: NodeId,
        exchange: &mut impl FnMut(&mut Self, NodeId, &[NodeId]) -> Option<Option<NodeId>>,
    ) -> Option<NodeId> {
        let mut new: FxHashMap<NodeId, NodeId> = FxHashMap::default();
        let mut exchanged = Vec::new();
        for id in self.graph.reachable(&[root]) {
            let old = self.graph.arguments(id).to_vec();
            let args: Vec<NodeId> = old.iter().map(|a| new.get(a).copied().unwrap_or(*a)).collect();
            let made = match (exchange(self, id, &args)?, self.graph.node(id).clone()) {
                (Some(made), _) => {
                    exchanged.push(id);
                    made
                }
                (None, _) if args == old => id,
                (None, Node::Op(op, _)) => self.graph.op(op, &args),
                (None, Node::Call(shape, function, _)) => self.graph.call(shape, function, &args),
                // A claim says what a part is by its arguments; of those it is as true when they are others.
                (None, Node::Claim(_, claim)) => match (old.split_first(), args.get(1..)) {
                    (Some((_, of)), Some(now)) if of == now => id,
                    (Some((&value, of)), _) => {
                        let own = self.graph.reachable_among(&[value], |n| !of.contains(&n));
                        if exchanged.iter().any(|e| own.binary_search(e).is_ok()) {
                            return None;
                        }
                        self.graph.intern(Node::Claim(args.into(), claim))
                    }
                    _ => id,
                },
                (None, _) => id,
            };
            if made != id {
                new.insert(id, made);
            }
        }
        Some(new.get(&root).copied().unwrap_or(root))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::evaluate::Tape;
    use crate::graph::Function;
    use crate::vector::length;
    use crate::random::Random;
    use crate::{MemoryLoader, Options, compile};
    use std::array::from_fn;

    /// The bound of a scene at a place.
    fn bound(scene: &str, place: [f64; 3]) -> f64 {
        let loader = MemoryLoader::new().with("main.sdf", scene);
        let scene = compile(&loader, "main.sdf", &Options::default()).compiled.unwrap();
        let root = scene.functions.formulas[&(scene.root, Function::Bound)];
        let tape = Tape::new(&scene.graph, &scene.functions.formulas, &[root], &scene.live(), 1_000_000).unwrap();
        let mut found = 0.0;
        tape.evaluator().at(&[place], &[], |_, values| found = values[0]);
        found
    }

    #[test]
    fn a_ray_passes_a_jump_above_both_of_its_sides() {
        // Steps of two that rise by ten, far too steep to be gone over from afar.
        let stairs = "field f = p.y - 10 * floor(p.x / 2)\nscene = f.within(box(50))";
        // At the upper end of one of them, 3 above it and 7 below the next; then above both, and half a step from the one after.
        let beside = bound(stairs, [1.999, 3.0, 0.0]);
        assert!((beside - 0.001).abs() < 1e-6, "{beside}");
        let above = bound(stairs, [2.001, 13.0, 0.0]);
        assert!((above - 1.999).abs() < 1e-6, "{above}");
        // The other side is the nearer one.
        let over = bound(stairs, [1.999, 10.5, 0.0]);
        assert!((over - 0.5).abs() < 1e-6, "{over}");
    }

    #[test]
    fn just_where_it_changes_a_sign_is_zero() {
        // A disc without thickness between two points that are away from it.
        let disc = "field f = length((sign(p.x), p.y, p.z)) - 0.9\nscene = f.within(box(3))";
        let beside = bound(disc, [0.01, 0.0, 0.0]);
        assert!(beside <= 0.01 + 1e-9, "{beside}");
    }

    #[test]
    fn across_its_cut_an_angle_is_a_turn_more() {
        // A spiral of which the arms are 1 apart; on either side of the cut it is as near as the formula there says.
        let spiral = "field f = abs(length(p.xz) - 2 - atan(p.z, p.x) / tau) - 0.1\nscene = f.within(box((3, 1, 3)).translate(-2.5, 0, 0))";
        let cut = bound(spiral, [-2.0, 0.0, 1e-5]);
        assert!(cut > 0.3 && cut <= 0.4, "{cut}");
    }

    /// Looks at many places how far a ray steps, and that nothing is nearer. The answer: from which part of those that are within a tenth it gets half as
    /// far as the formula says.
    fn passed(scene: &str) -> f64 {
        let loader = MemoryLoader::new().with("main.sdf", scene);
        let scene = compile(&loader, "main.sdf", &Options::default()).compiled.unwrap();
        let root = |function| scene.functions.formulas[&(scene.root, function)];
        let tape = Tape::new(&scene.graph, &scene.functions.formulas, &[root(Function::Bound), root(Function::Field)], &scene.live(), 1_000_000).unwrap();
        let mut evaluator = tape.evaluator();
        let mut random = Random(7);
        let (mut far, mut close, places) = (0, 0, 4000);
        for _ in 0..places {
            let place = [0; 3].map(|_| 4.0 * random.next() - 2.0);
            let mut at = |place: [f64; 3]| {
                let mut found = [0.0; 2];
                evaluator.at(&[place], &[], |_, values| found = [values[0], values[1]]);
                found
            };
            let [step, field] = at(place);
            let is_close = field.abs() < 0.1;
            close += usize::from(is_close);
            far += usize::from(is_close && step.abs() > 0.5 * field.abs());
            for _ in 0..24 {
                let way = [0; 3].map(|_| 2.0 * random.next() - 1.0);
                let part = 0.999 * step.abs() * random.next().sqrt() / length(way);
                let [_, there] = at(from_fn(|axis| place[axis] + part * way[axis]));
                assert!(there * field >= 0.0, "{place:?} {step} {field} {there}");
            }
        }
        far as f64 / close as f64
    }

    #[test]
    fn what_follows_from_another_jump_is_passed_as_it_is_on_both_sides() {
        let bricks = "let row = floor(p.y / 0.4); let x = p.x + if row % 2 < 1 { 0 } else { 0.5 }; let c = floor(x);
             let q = (x - c - 0.5, p.y - (row + 0.5) * 0.4, p.z); let b = abs(q) - (0.4, 0.15, 0.2 + 0.1 * hash((row, c))); max(b.x, max(b.y, b.z))";
        let moved = "p.y - hash(floor(p.x + 0.37 * floor(p.z) + 0.5 * floor(2 * p.y)))";
        let triangles = "let q = (p.x - p.z * 0.57735, p.z * 1.1547); let i = floor(q); let f = q - i; let u = if f.x + f.y > 1 { 1 } else { 0 };
             p.y - hash((i.x, i.y, u))";
        let numbered = "let q = (p.x * 1.1547, p.z + p.x * 0.57735); let i = floor(q); let f = q - i; let v = (i.x + i.y) % 3;
             let a = if v >= 1 { 1 } else { 0 }; let b = if v >= 2 { 1 } else { 0 }; let m = if f.x < f.y { (1, 0) } else { (0, 1) };
             p.y - hash(i + a - b * m)";
        let nearest = "let r = (1, 1.7320508); let a = mod(p.xz, r) - r / 2; let b = mod(p.xz - r / 2, r) - r / 2;
             let g = CHOICE; p.y - hash(round(2 * (p.xz - g)))";
        let [chosen, mixed] = ["if dot(a, a) < dot(b, b) { a } else { b }", "mix(a, b, step(dot(b, b), dot(a, a)))"].map(|choice| nearest.replace("CHOICE", choice));
        let centred = "let a = p - round(p); let b = p - 0.5 - round(p - 0.5); let g = if length(a) <= length(b) { a } else { b };
             length(g) - 0.15 - 0.2 * hash(round(2 * (p - g)))";
        // Three jumps in one place, of which two follow from the third.
        let together = "let a = mod(p.xz, 2) - 1; let m = if a.x < a.y { 1 } else { 2 }; p.y - 0.2 * floor(m * p.x) - 0.3 * m + step(0.3, a.x)";
        for (formula, least) in [
            (bricks, 0.9),
            (moved, 0.9),
            (triangles, 0.9),
            (numbered, 0.9),
            (&chosen, 0.9),
            (&mixed, 0.9),
            (centred, 0.9),
            (together, 0.85),
        ] {
            let far = passed(&format!("field f = {{ {formula} }}\nscene = f.within(box(50))"));
            assert!(far > least, "{far}: {formula}");
        }
    }
}
