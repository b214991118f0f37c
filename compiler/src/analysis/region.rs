//! Where a formula can be at or below a level: a box, found by carrying conditions back to the coordinates, and by cutting off slabs that
//! are proven empty.

use super::tape::{Step, Tape};
use super::{call_domain, Box3, Domain, Facts};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Claim, Graph, Leaf, NodeId, ShapeId};

/// How many boxes the cutting of one region may cost, those of the shapes inside counted in.
const SLABS: u64 = 160;
/// How many shapes one contraction may enter, shared ones counted each time.
const ENTRIES: u32 = 400;
/// How many steps one contraction may visit, shared steps counted each time.
const VISITS: usize = 4000;

impl Facts {
    /// A box within the domain that holds every point at which the node is at most `level`.
    pub fn region(&mut self, graph: &Graph, node: NodeId, domain: &Domain, level: f64) -> Box3 {
        let key = (node, domain.key(), level.to_bits());
        if let Some(known) = self.regions.get(&key) {
            return *known;
        }
        let mut region = domain.point;
        let tape = self.tape(graph, node);
        self.entries = ENTRIES;
        for _ in 0..3 {
            let before = region.size();
            region = self.contract(graph, &tape, &domain.at(region), Interval::new(f64::NEG_INFINITY, level));
            if region.is_empty() || region.size() > 0.9 * before {
                break;
            }
        }
        if !region.is_empty() && region.is_finite() {
            region = self.shave(graph, &tape, domain, region, level);
        }
        self.regions.insert(key, region);
        region
    }

    /// The same, found at once and not as tight.
    pub fn rough_region(&mut self, graph: &Graph, node: NodeId, domain: &Domain) -> Box3 {
        let tape = self.tape(graph, node);
        self.entries = ENTRIES;
        self.contract(graph, &tape, domain, Interval::new(f64::NEG_INFINITY, 0.0))
    }

    /// Cuts off slabs at the faces in which the formula is above the level everywhere.
    fn shave(
        &mut self,
        graph: &Graph,
        tape: &Tape,
        domain: &Domain,
        mut region: Box3,
        level: f64,
    ) -> Box3 {
        let first = self.boxes;
        for _ in 0..2 {
            let before = region;
            for axis in 0..3 {
                for upper in [false, true] {
                    let mut part = 0.5;
                    while part > 0.02 && self.boxes - first < SLABS {
                        let side = region.axis(axis);
                        let cut = side.width() * part;
                        if cut <= 0.0 {
                            break;
                        }
                        let (slab, rest) = if upper {
                            (Interval::new(side.hi - cut, side.hi), Interval::new(side.lo, side.hi - cut))
                        } else {
                            (Interval::new(side.lo, side.lo + cut), Interval::new(side.lo + cut, side.hi))
                        };
                        let slab = domain.at(region.with_axis(axis, slab));
                        let values = self.ranges_of(graph, tape, &slab);
                        if values.last().is_some_and(|v| v.lo > level) {
                            region = region.with_axis(axis, rest);
                        } else {
                            part /= 2.0;
                        }
                    }
                }
            }
            if region == before {
                break;
            }
        }
        region
    }

    /// The part of a domain in which a tape's last step can be within a target.
    pub fn contract(
        &mut self,
        graph: &Graph,
        tape: &Tape,
        domain: &Domain,
        target: Interval,
    ) -> Box3 {
        let ranges = self.ranges_of(graph, tape, domain);
        let Some(last) = tape.steps.len().checked_sub(1) else { return domain.point };
        let mut visits = VISITS;
        let mut walk = Walk { facts: self, graph, tape, ranges: &ranges, visits: &mut visits };
        walk.step(last, target, domain.point)
    }

    fn shape_region(
        &mut self,
        graph: &Graph,
        shape: ShapeId,
        args: &[Interval],
        target: Interval,
    ) -> Box3 {
        let Some(s) = graph.shape(shape) else { return Box3::ALL };
        let domain = call_domain(&s.variables, args);
        if self.entries == 0 {
            return domain.point;
        }
        self.entries -= 1;
        if target.lo == f64::NEG_INFINITY {
            let key = (s.value, domain.key(), target.hi.to_bits());
            if let Some(known) = self.regions.get(&key) {
                return *known;
            }
            let tape = self.tape(graph, s.value);
            let region = self.contract(graph, &tape, &domain, target);
            self.regions.insert(key, region);
            return region;
        }
        let tape = self.tape(graph, s.value);
        self.contract(graph, &tape, &domain, target)
    }
}

struct Walk<'a> {
    facts: &'a mut Facts,
    graph: &'a Graph,
    tape: &'a Tape,
    ranges: &'a [Interval],
    visits: &'a mut usize,
}

impl Walk<'_> {
    fn range(&self, step: usize) -> Interval {
        self.ranges.get(step).copied().unwrap_or(Interval::ALL)
    }

    /// The part of `region` in which a step can be within `target`.
    fn step(&mut self, step: usize, target: Interval, region: Box3) -> Box3 {
        let range = self.range(step);
        let target = target.intersect(range);
        if target.is_empty() || region.is_empty() {
            return Box3::EMPTY;
        }
        if target == range || *self.visits == 0 {
            return region;
        }
        *self.visits -= 1;
        let Some(kind) = self.tape.steps.get(step) else { return region };
        match kind {
            Step::Constant(_) => region,
            Step::Leaf(Leaf::P(i)) => {
                let i = usize::from(*i);
                region.with_axis(i, region.axis(i).intersect(target))
            }
            Step::Leaf(_) => region,
            Step::Claim(Claim::Lipschitz(..) | Claim::Continuous, args) => match args.first() {
                Some(&value) => self.step(value, target, region),
                None => region,
            },
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

    /// The part of `region` in which the three steps can be a point of `own`.
    fn point(&mut self, coordinates: &[usize], own: Box3, mut region: Box3) -> Box3 {
        for (i, &a) in coordinates.iter().enumerate() {
            let turned = self.partner(coordinates, a).map(|(j, u, v, t)| (own.axis(i), own.axis(j), u, v, t));
            if let Some((first, second, u, v, t)) = turned {
                // Turned back by the angle, and never longer than the point is.
                let (cos, sin) = (self.range(t).cos(), self.range(t).sin());
                let reach = first.square().add(second.square()).sqrt().hi;
                let disc = Interval::new(-reach, reach);
                let back_u = first.mul(cos).add(second.mul(sin)).intersect(disc);
                let back_v = second.mul(cos).sub(first.mul(sin)).intersect(disc);
                region = self.step(u, back_u, region);
                region = self.step(v, back_v, region);
            }
            region = self.step(a, own.axis(i), region);
        }
        region
    }

    /// For a first turned coordinate: which coordinate is its second, and what they turn.
    fn partner(&self, coordinates: &[usize], a: usize) -> Option<(usize, usize, usize, usize)> {
        let Some(Step::Op(Op::TurnU, first)) = self.tape.steps.get(a) else { return None };
        let j = coordinates.iter().position(|&b| {
            matches!(self.tape.steps.get(b), Some(Step::Op(Op::TurnV, second)) if second == first)
        })?;
        Some((j, *first.first()?, *first.get(1)?, *first.get(2)?))
    }

    fn operation(&mut self, op: Op, args: &[usize], target: Interval, region: Box3) -> Box3 {
        let arg = |i: usize| args.get(i).copied().unwrap_or(0);
        let (a, b) = (arg(0), arg(1));
        let (ra, rb) = (self.range(a), self.range(b));
        match op {
            Op::Add => {
                let region = self.step(a, target.sub(rb), region);
                self.step(b, target.sub(ra), region)
            }
            Op::Sub => {
                let region = self.step(a, target.add(rb), region);
                self.step(b, ra.sub(target), region)
            }
            Op::Mul => {
                let mut region = region;
                if !rb.contains(0.0) {
                    region = self.step(a, target.div(rb), region);
                }
                if !ra.contains(0.0) {
                    region = self.step(b, target.div(ra), region);
                }
                region
            }
            Op::Div if !rb.contains(0.0) => self.step(a, target.mul(rb), region),
            Op::Neg => self.step(a, target.neg(), region),
            Op::Min => {
                let above = Interval::new(target.lo, f64::INFINITY);
                let region = self.step(a, above, region);
                let region = self.step(b, above, region);
                let first = self.step(a, target, region);
                let second = self.step(b, target, region);
                first.hull(&second)
            }
            Op::Max => {
                let below = Interval::new(f64::NEG_INFINITY, target.hi);
                let region = self.step(a, below, region);
                let region = self.step(b, below, region);
                if target.lo == f64::NEG_INFINITY {
                    return region;
                }
                let first = self.step(a, target, region);
                let second = self.step(b, target, region);
                first.hull(&second)
            }
            Op::Abs => self.step(a, Interval::new(-target.hi, target.hi), region),
            Op::Square => {
                let side = target.sqrt().hi;
                self.step(a, Interval::new(-side, side), region)
            }
            Op::Sqrt => self.step(a, Interval::new(f64::NEG_INFINITY, target.square().hi), region),
            Op::Length2 | Op::Length3 | Op::Length4 => {
                let side = target.hi.max(0.0);
                let own = Box3([Interval::new(-side, side); 3]);
                let mut region = region;
                if args.len() <= 3 {
                    region = self.point(args, own, region);
                }
                region
            }
            Op::TurnU | Op::TurnV => region,
            Op::Select => {
                let first = self.step(b, target, region);
                let second = self.step(arg(2), target, region);
                let condition = self.range(a);
                if condition == Interval::ONE {
                    first
                } else if condition == Interval::ZERO {
                    second
                } else {
                    first.hull(&second)
                }
            }
            _ => region,
        }
    }
}
