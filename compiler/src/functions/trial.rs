//! Formulas tried at many places: points of a domain, with values for what else they read.

use crate::analysis::Domain;
use crate::evaluate::{Evaluator, LANES, Lanes, Tape, lanes};
use crate::functions::builder::Builder;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Leaf, Node, NodeId};
use crate::live::Live;
use crate::random::Random;
use crate::vector::{Vec3, mix};
use std::array::from_fn;

/// So many sets of values of parameters, time and variables are tried.
const LIVES: usize = 16;
/// Longer formulas are not tried.
const LONGEST: usize = 20_000;
/// Times are up to here, in seconds.
const LATEST: f64 = 100.0;
/// What varies by more than this are numbers of cells or of copies, which are whole.
const WHOLE: f64 = 1.5;
/// Places lie in the whole domain and, in turn, in such parts of it about the origin, where people put what they look at.
const PARTS: [f64; 4] = [1.0, 0.2, 1.0, 0.04];

/// Places, one for each lane.
pub(super) type Places = [Vec3; LANES];

impl Builder<'_> {
    /// How many sets of values a formula must be tried with.
    pub(super) fn lives(&self, root: NodeId) -> usize {
        let lives = |id: &NodeId| matches!(self.graph.node(*id), Node::Leaf(Leaf::Parameter(_) | Leaf::Time | Leaf::Variable(_)) | Node::Call(..));
        if self.graph.reachable(&[root]).iter().any(lives) { LIVES } else { 1 }
    }

    /// Formulas with one of those sets of values. None where they are too long, or read what nothing is known of.
    pub(super) fn tape_of(&mut self, near: &Domain, roots: &[NodeId], life: usize) -> Option<Tape> {
        let known = |v: &u32| near.variables.iter().any(|(known, _)| known == v);
        if !roots.iter().all(|root| self.graph.variables_of(*root).iter().all(known)) {
            return None;
        }
        let mut random = Random(life as u64);
        let mut live = Live::start(self.graph);
        for (value, parameter) in live.components.iter_mut().zip(&self.graph.parameters) {
            let part = match life {
                0 => continue,
                1 => 0.0,
                2 => 1.0,
                _ => random.next(),
            };
            *value = parameter.min + part * (parameter.max - parameter.min);
            if parameter.whole {
                *value = value.round();
            }
        }
        live.time = if life == 0 { 0.0 } else { LATEST * random.next() };
        let values: Vec<(u32, f64)> = near.variables.iter().map(|&(v, range)| {
            let value = at(range, random.next(), 1.0);
            (v, if range.width() > WHOLE { value.round().clamp(range.lo, range.hi) } else { value })
        }).collect();
        let roots = if values.is_empty() {
            roots.to_vec()
        } else {
            let values: Vec<(u32, NodeId)> = values.into_iter().map(|(v, value)| (v, self.graph.constant(value))).collect();
            self.graph.substitute(roots, |leaf| match leaf {
                Leaf::Variable(v) => values.iter().find(|(known, _)| *known == v).map(|(_, value)| *value),
                _ => None,
            })
        };
        Tape::new(self.graph, &self.built.formulas, &roots, &live, LONGEST).ok()
    }
}

/// Places of a domain; more each turn.
pub(super) fn places(near: &Domain, turn: usize, random: &mut Random) -> Places {
    let part = PARTS.get(turn % PARTS.len()).copied().unwrap_or(1.0);
    from_fn(|_| [0, 1, 2].map(|axis| at(near.point.axis(axis), random.next(), part)))
}

/// A number of an interval, so far along it; about zero, or what is nearest to that, within a part of it. Without end: most of them near the middle.
fn at(side: Interval, along: f64, part: f64) -> f64 {
    let middle = side.lo.max(0.0).min(side.hi);
    let t = 2.0 * along - 1.0;
    let far = if side.is_finite() { side.lo + along * side.width() } else { (middle + 4.0 * t / (1.0 - t * t)).clamp(side.lo, side.hi) };
    middle + part * (far - middle)
}

/// The place in a lane.
pub(super) fn get(places: &Places, lane: usize) -> Vec3 {
    places.get(lane).copied().unwrap_or_default()
}

/// The number in a lane.
pub(super) fn number(lanes: &Lanes, lane: usize) -> f64 {
    lanes.get(lane).copied().unwrap_or(0.0)
}

/// The first two formulas of a tape at some places.
pub(super) fn values(evaluator: &mut Evaluator<'_>, places: &Places) -> [Lanes; 2] {
    evaluator.run(&lanes(places));
    [0, 1].map(|i| *evaluator.output(i))
}

/// Both ends of ways between places, halved so often, each time to the half of which one end is beyond what is sought and the other is not.
pub(super) fn halved(from: &Places, to: &Places, times: usize, mut beyond: impl FnMut(&Places) -> [bool; LANES]) -> [Places; 2] {
    let (mut here, mut there) = (*from, *to);
    for _ in 0..times {
        let middle: Places = from_fn(|lane| mix(get(&here, lane), get(&there, lane), 0.5));
        for (lane, beyond) in beyond(&middle).into_iter().enumerate() {
            if let Some(side) = if beyond { there.get_mut(lane) } else { here.get_mut(lane) } {
                *side = get(&middle, lane);
            }
        }
    }
    [here, there]
}

/// What a tape costs at one place, in additions.
pub(super) fn weight(tape: &Tape) -> usize {
    let of = |op| match op {
        Op::Hash => 10,
        Op::Sin | Op::Cos | Op::Atan2 | Op::Exp | Op::Log | Op::Pow => 5,
        _ => 1,
    };
    tape.instructions().map(|(op, ..)| of(op)).sum()
}
