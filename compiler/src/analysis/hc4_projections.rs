//! Ways back from what a formula can be to the coordinates, operation by operation, and where one operand alone does not tell: turned points, sums with
//! a kink, mixes.

use super::rules::isometry::{self, PlaneTurn};
use super::branches::backward;
use super::chain::{DEEP, DEEPEST};
use super::domain::Box3;
use super::facts::Facts;
use super::formula::Formula;
use super::tape::Step;
use crate::figure::Figure;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Claim, Graph, Leaf};
use crate::kept::Kept;
use crate::rules::Rule;

/// So many steps are few.
const FEW: usize = 32;

/// One way back from a tape's last step to the coordinates.
pub(super) struct Walk<'a> {
    facts: &'a mut Facts,
    graph: &'a Graph,
    pub(super) tape: &'a Formula,
    ranges: &'a [Interval],
    visits: &'a mut usize,
    /// Turned points that were met on the way.
    turned: Vec<Turned>,
}

impl<'a> Walk<'a> {
    /// A way back through a tape whose steps have these ranges; it may visit so many more of them.
    pub(super) fn new(facts: &'a mut Facts, (graph, tape, ranges): (&'a Graph, &'a Formula, &'a [Interval]), visits: &'a mut usize) -> Self {
        Self { facts, graph, tape, ranges, visits, turned: Vec::new() }
    }
}

impl Walk<'_> {
    pub(super) fn allows(&self, rule: Rule) -> bool {
        self.facts.rules.has(rule)
    }

    /// Counts so many steps.
    pub(super) fn counted(&mut self, steps: usize) {
        self.facts.account.ran += steps as u64;
        self.facts.account.spend(steps as u64);
    }

    pub(super) fn range(&self, step: usize) -> Interval {
        self.ranges.get(step).copied().unwrap_or(Interval::ALL)
    }

    /// The part of `region` in which a step can be within `target`.
    pub(super) fn step(&mut self, step: usize, target: Interval, region: Box3) -> Box3 {
        let range = self.range(step);
        let mut target = target.intersect(range);
        if target.is_empty() || region.is_empty() {
            return Box3::EMPTY;
        }
        if target == range || *self.visits == 0 || self.facts.looks.walking >= DEEPEST {
            return region;
        }
        if target.lo <= range.lo {
            // Only the upper end says anything: a shape is looked at as closely as where that is all that was asked.
            target.lo = f64::NEG_INFINITY;
        }
        *self.visits -= 1;
        self.facts.looks.walking += 1;
        let region = self.carried_back(step, target, region);
        self.facts.looks.walking -= 1;
        region
    }

    /// The same of a step of which something is asked.
    fn carried_back(&mut self, step: usize, target: Interval, region: Box3) -> Box3 {
        if target.hi <= 0.0
            && let Some(solid) = self.tape.nodes.get(step).and_then(|&n| self.facts.known_solid(n))
        {
            return region.intersect(&solid);
        }
        let Some(kind) = self.tape.steps.get(step) else { return region };
        match kind {
            Step::Constant(_) => region,
            Step::Leaf(Leaf::P(i)) => {
                let i = usize::from(*i);
                region.with_axis(i, region.axis(i).intersect(target))
            }
            Step::Leaf(_) => region,
            Step::Claim(Claim::Lipschitz(..) | Claim::Continuous, args) => {
                let Some(&value) = args.first() else { return region };
                if let (Some(&a), Some(&b), true) = (args.get(1), args.get(2), target.lo == f64::NEG_INFINITY)
                    && self.allows(Rule::BlendSublevelSet)
                    && let Some(level) = self.joined_level(value, [a, b], target.hi)
                {
                    let below = Interval::new(f64::NEG_INFINITY, level);
                    let region = self.either(|walk| walk.step(a, below, region), |walk| walk.step(b, below, region));
                    return self.cut_off(value, target, region);
                }
                self.step(value, target, region)
            }
            Step::Op(Op::Max, args) => {
                let region = self.operation(Op::Max, args, target, region);
                if region.is_empty() || !self.allows(Rule::Polytope) { region } else { self.in_polytope(step, target.hi, &region).unwrap_or(region) }
            }
            Step::Op(op, args) => self.operation(*op, args, target, region),
            Step::Call(shape, args) => {
                let values: Vec<Interval> = args.iter().map(|&a| self.range(a)).collect();
                let own = self.facts.shape_region(self.graph, *shape, &values, target);
                if own.is_empty() {
                    return Box3::EMPTY;
                }
                self.point(args.get(..3).unwrap_or(args), own, region)
            }
        }
    }

    fn operation(&mut self, op: Op, args: &[usize], target: Interval, region: Box3) -> Box3 {
        let arg = |i: usize| args.get(i).copied().unwrap_or(0);
        let (a, b) = (arg(0), arg(1));
        let (ra, rb) = (self.range(a), self.range(b));
        match op {
            // No farther from its box than that.
            Op::Figured if target.hi.is_finite() => {
                let figure = if ra.is_point() { Kept::<Figure>::find(ra.lo) } else { None };
                let Some([low, high]) = figure.map(|figure| figure.bounds()) else { return region };
                let reach = target.hi.max(0.0);
                let side = |i: usize| Interval::new(low.get(i).copied().unwrap_or(0.0), high.get(i).copied().unwrap_or(0.0)).grow(reach);
                self.point(args.get(1..).unwrap_or(&[]), Box3([0, 1, 2].map(side)), region)
            }
            Op::Add => match (self.capped(a), self.capped(b)) {
                // On each side of the kink it is a sum of its own, which says more than the hull of both.
                (Some((part, cap)), None) => self.capped_sum(b, part, cap, target, region),
                (None, Some((part, cap))) => self.capped_sum(a, part, cap, target, region),
                _ if target.lo == f64::NEG_INFINITY && self.allows(Rule::Mix) && let Some((a, b, slack)) = self.mixed(a, b, target.hi) => {
                    let target = Interval::new(target.lo, target.hi + slack);
                    self.either(|walk| walk.step(a, target, region), |walk| walk.step(b, target, region))
                }
                _ => {
                    let region = self.step(a, target.sub(rb), region);
                    self.step(b, target.sub(ra), region)
                }
            },
            // Of what is at most zero one factor is.
            Op::Mul if target.hi <= 0.0 && ra.contains(0.0) && rb.contains(0.0) => {
                let below = Interval::new(f64::NEG_INFINITY, 0.0);
                self.either(|walk| walk.step(a, below, region), |walk| walk.step(b, below, region))
            }
            // Of a long chain all operands at once: no stack grows with their number.
            Op::Min if self.facts.looks.walking >= DEEP && target.lo == f64::NEG_INFINITY => {
                let (known, mut open, mut hull) = (self.turned.clone(), vec![b, a], Box3::EMPTY);
                while let Some(step) = open.pop() {
                    match self.tape.steps.get(step) {
                        Some(Step::Op(Op::Min, args)) if self.tape.nodes.get(step).is_none_or(|&n| self.facts.known_solid(n).is_none()) => {
                            open.extend(args.iter().rev());
                        }
                        _ => {
                            self.turned.clone_from(&known);
                            hull = hull.hull(&self.step(step, target, region));
                        }
                    }
                }
                self.turned = known;
                hull
            }
            Op::Min => {
                let above = Interval::new(target.lo, f64::INFINITY);
                let region = self.step(a, above, region);
                let region = self.step(b, above, region);
                self.either(|walk| walk.step(a, target, region), |walk| walk.step(b, target, region))
            }
            Op::Max => {
                let below = Interval::new(f64::NEG_INFINITY, target.hi);
                let region = self.step(a, below, region);
                let region = self.step(b, below, region);
                if target.lo == f64::NEG_INFINITY {
                    return region;
                }
                self.either(|walk| walk.step(a, target, region), |walk| walk.step(b, target, region))
            }
            Op::Length2 | Op::Length3 | Op::Length4 => {
                let side = target.hi.max(0.0);
                let own = Box3([Interval::new(-side, side); 3]);
                let mut region = region;
                if args.len() <= 3 {
                    region = self.point(args, own, region);
                }
                region
            }
            Op::TurnU | Op::TurnV if self.allows(Rule::TurnedPoint) => self.turned(op, args, target, region),
            Op::Select => match self.range(a) {
                Interval::ONE => self.step(b, target, region),
                Interval::ZERO => self.step(arg(2), target, region),
                _ => self.either(|walk| walk.step(b, target, region), |walk| walk.step(arg(2), target, region)),
            },
            _ => (0..).zip(args).fold(region, |region, (k, &arg)| self.step(arg, backward(op, k, ra, rb, target, None), region)),
        }
    }
}

impl Walk<'_> {
    /// The part of `region` in which the three steps can be a point of `own`.
    pub(super) fn point(&mut self, coordinates: &[usize], own: Box3, mut region: Box3) -> Box3 {
        if let Some(PlaneTurn { coordinates: [i, j], of }) = PlaneTurn::of(self.tape, coordinates) {
            region = self.turned_back(of, own.axis(i), own.axis(j), region);
        }
        for (i, &a) in coordinates.iter().enumerate() {
            region = self.step(a, own.axis(i), region);
        }
        let farthest = own.0.iter().map(|side| side.magnitude().powi(2)).sum::<f64>().sqrt() * (1.0 + 1e-8);
        if farthest.is_finite()
            && let Some(before) = coordinates.try_into().ok().and_then(|point| isometry::unturned(self.tape, point))
        {
            for a in before {
                region = self.step(a, Interval::new(-farthest, farthest), region);
            }
        }
        region
    }

    /// The part of `region` in which that of a largest value can be within `target` which asks no shape.
    pub(super) fn cut_off(&mut self, step: usize, target: Interval, region: Box3) -> Box3 {
        let Some(Step::Op(Op::Max, args)) = self.tape.steps.get(step) else { return region };
        args.iter().fold(region, |region, &a| if self.asks_no_shape(a) { self.step(a, target, region) } else { region })
    }

    /// Whether a step is made of few others, none of them a shape's.
    fn asks_no_shape(&self, step: usize) -> bool {
        let mut open = vec![step];
        for _ in 0..FEW {
            let Some(next) = open.pop() else { return true };
            match self.tape.steps.get(next) {
                Some(Step::Op(_, args)) => open.extend(args.iter().copied()),
                Some(Step::Constant(_) | Step::Leaf(_)) => {}
                _ => return false,
            }
        }
        open.is_empty()
    }

    /// What a step is the lesser of, where that is another step and a number between its ends.
    pub(super) fn capped(&self, step: usize) -> Option<(usize, f64)> {
        let Some(Step::Op(Op::Min, args)) = self.tape.steps.get(step).filter(|_| self.allows(Rule::CappedSum)) else { return None };
        let &[a, b] = args.as_slice() else { return None };
        let cap = |step: usize| match self.tape.steps.get(step) {
            Some(Step::Constant(c)) => Some(*c),
            _ => None,
        };
        let (part, cap) = cap(b).map(|c| (a, c)).or_else(|| cap(a).map(|c| (b, c)))?;
        let range = self.range(part);
        (range.lo < cap && cap < range.hi).then_some((part, cap))
    }

    /// The part of `region` in which `other + min(part, cap)` can be within `target`.
    pub(super) fn capped_sum(&mut self, other: usize, part: usize, cap: f64, target: Interval, region: Box3) -> Box3 {
        let low = self.range(part).intersect(Interval::new(f64::NEG_INFINITY, cap));
        let others = target.sub(self.range(other));
        let below = |walk: &mut Self| {
            let below = walk.step(part, low.intersect(others), region);
            walk.step(other, target.sub(low), below)
        };
        // What is above the cap hardly says anything, and may take all looks at shapes: it comes last.
        let above = |walk: &mut Self| {
            let above = walk.step(other, target.sub(Interval::point(cap)), region);
            walk.step(part, Interval::new(cap, f64::INFINITY), above)
        };
        self.either(below, above)
    }

    /// What two operands are of which a sum is a share of each, `a (1 - t) + b t` with t between 0 and 1: it is never less than both of them, but for
    /// so much where t is rounded. Of a sum that is no more than `level`.
    pub(super) fn mixed(&self, first: usize, second: usize, level: f64) -> Option<(usize, usize, f64)> {
        let product = |step: usize| match self.tape.steps.get(step) {
            Some(Step::Op(Op::Mul, args)) => <[usize; 2]>::try_from(args.as_slice()).ok(),
            _ => None,
        };
        let rest_of = |step: usize| match self.tape.steps.get(step) {
            Some(Step::Op(Op::Sub, args)) => match *args.as_slice() {
                [one, rest] if self.range(one) == Interval::ONE => Some(rest),
                _ => None,
            },
            _ => None,
        };
        let ([a, b], [c, d]) = (product(first)?, product(second)?);
        let ways = [(a, b, c, d), (a, b, d, c), (b, a, c, d), (b, a, d, c)];
        let (a, b, t) = ways.into_iter().find_map(|(a, s, b, t)| {
            let t = (rest_of(s) == Some(t)).then_some(t).or((rest_of(t) == Some(s)).then_some(s))?;
            Some((a, b, t))
        })?;
        // With t beyond its ends by d the one operand is no more than the level and d times how far they are apart.
        let beyond = self.range(t).hi.max(1.0 - self.range(t).lo) - 1.0;
        let apart = self.range(a).magnitude() + self.range(b).magnitude() + level.abs();
        let slack = if beyond > 0.0 { 2.0 * beyond * apart } else { 0.0 };
        slack.is_finite().then_some((a, b, slack))
    }

    /// The part of `region` in which a coordinate of a turned point can be within `target`, with what is known of the other one.
    pub(super) fn turned(&mut self, op: Op, args: &[usize], target: Interval, region: Box3) -> Box3 {
        let Ok(of) = <[usize; 3]>::try_from(args) else { return region };
        let at = self.turned.iter().position(|t| t.of == of).unwrap_or_else(|| {
            self.turned.push(Turned { of, first: Interval::ALL, second: Interval::ALL });
            self.turned.len() - 1
        });
        let Some(known) = self.turned.get_mut(at) else { return region };
        let side = if op == Op::TurnU { &mut known.first } else { &mut known.second };
        *side = side.intersect(target);
        let (first, second) = (known.first, known.second);
        if first.is_finite() && second.is_finite() { self.turned_back(of, first, second, region) } else { region }
    }

    /// The part of `region` in which a point (u, v), turned by t, can be within two intervals. It is never longer than it was.
    fn turned_back(&mut self, [u, v, t]: [usize; 3], first: Interval, second: Interval, region: Box3) -> Box3 {
        let (cos, sin) = (self.range(t).cos(), self.range(t).sin());
        let reach = first.square().add(second.square()).sqrt().hi;
        let disc = Interval::new(-reach, reach);
        let back_u = first.mul(cos).add(second.mul(sin)).intersect(disc);
        let back_v = second.mul(cos).sub(first.mul(sin)).intersect(disc);
        let region = self.step(u, back_u, region);
        self.step(v, back_v, region)
    }

    /// Where one of two ways back leads. What is met on the one is not known on the other.
    pub(super) fn either(&mut self, first: impl FnOnce(&mut Self) -> Box3, second: impl FnOnce(&mut Self) -> Box3) -> Box3 {
        let known = self.turned.clone();
        let first = first(self);
        self.turned.clone_from(&known);
        let second = second(self);
        self.turned = known;
        first.hull(&second)
    }
}

/// A point that is turned, (u, v) by t, and what its coordinates can be.
#[derive(Clone, Copy)]
pub struct Turned {
    of: [usize; 3],
    first: Interval,
    second: Interval,
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::functions::bounds;
    use crate::{MemoryLoader, Options, compile};

    /// The box of a formula within an extent of 100.
    fn region(formula: &str) -> Option<[[f64; 3]; 2]> {
        let text = format!("param t = 0.5 in 0..1\nparam u = 0.5 in 0..2\nfield f = {formula}\nscene = f");
        let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
        let scene = outcome.compiled.unwrap();
        bounds(&scene.graph, scene.root, &scene.functions, 100.0)
    }

    #[test]
    fn a_mix_is_where_its_parts_are() {
        let parts = "length(p) - 1, length(p - (1, 0, 0)) - 0.5";
        for share in ["t", "0.5 + 0.5 * sin(time)", "0.3"] {
            let [low, high] = region(&format!("mix({parts}, {share})")).unwrap_or_else(|| panic!("{share}"));
            assert!(low.iter().all(|c| *c >= -1.6 && *c <= -0.5) && high.iter().all(|c| *c >= 0.5 && *c <= 2.0), "{share}: {low:?} {high:?}");
        }
        // More than all of the second is away from both.
        assert!(region(&format!("mix({parts}, u)")).is_none_or(|[low, _]| low[0] < -1.6));
    }

    #[test]
    fn a_turned_point_is_as_far_from_the_axis_as_it_was() {
        // By its coordinates one by one, with the angle's sine and cosine written out, as a matrix and as a turn.
        for turned in ["(c * p.x - s * p.z, s * p.x + c * p.z)", "mat2(c, -s, s, c) * p.xz", "turn(p.xz, 3 * p.y)"] {
            let formula = format!(
                "{{ let c = cos(3 * p.y); let s = sin(3 * p.y); let q = {turned}; max(max(abs(q.x), abs(q.y)) - 1, abs(p.y) - 2) }}"
            );
            let [low, high] = region(&formula).unwrap_or_else(|| panic!("{turned}"));
            let expected = [1.5, 2.1, 1.5];
            assert!((0..3).all(|i| low[i] >= -expected[i] && high[i] <= expected[i]), "{turned}: {low:?} {high:?}");
            assert!(high[0] >= 1.0 && high[2] >= 1.0);
        }
        // Of either solid, and not of both.
        let [_, high] = region("min(length(turn(p.xz, p.y) - (3, 0)) + abs(p.y) - 1, abs(turn(p.xz, p.y).x) + abs(turn(p.xz, p.y).y - 8) + abs(p.y) - 1)").unwrap();
        assert!(high[2] >= 8.0, "{high:?}");
    }

    #[test]
    fn many_live_copies_in_a_drawing_leave_it_its_box() {
        let text = "param n: int = 18 in 8..40\nscene = (circle(0.7) | for k in polar(n) { rectangle((0.2, 0.1)).translate(0.75, 0) }).extrude(0.6)";
        let scene = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default()).compiled.unwrap();
        let [low, high] = scene.bounds().unwrap();
        assert!(high[0] <= 1.0 && low[1] >= -1.0 && high[2] <= 0.301 && high[0] >= 0.85, "{low:?} {high:?}");
    }
}
