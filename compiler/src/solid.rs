//! Where the solid of a scene lies, for people and for machines: a box, and whether the solid is known to reach its faces.

use crate::analysis::Box3;
use crate::compiled::Compiled;
use crate::evaluate::{Evaluator, Tape};
use crate::graph::Function;
use crate::graph::interval::Interval;
use crate::random::Random;

/// A solid that comes this near to a face, as a part of the box's side across it, reaches it.
const NEAR: f64 = 0.01;
/// Operations that the search for such points may take over all faces.
const WORK: usize = 60_000_000;
/// Operations of a field that is looked at, at most.
const LONGEST: usize = 200_000;
/// Rounds of the search at a face; each looks nearer about the lowest point so far.
const ROUNDS: i32 = 14;
/// How much nearer.
const NEARER: f64 = 0.6;
/// Points of a round, at most.
const POINTS: usize = 96;

/// A box that holds all that is solid, at any time and wherever sliders stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidBox {
    /// Its least corner.
    pub low: [f64; 3],
    /// Its greatest corner.
    pub high: [f64; 3],
    /// Whether it may be larger than what is solid: no point of the solid was found within 1 % of some face, as the sliders stand.
    pub at_most: bool,
    /// Whether the scene's planes are left out; they have no end.
    pub but_planes: bool,
}

impl SolidBox {
    /// In one line, with as many digits as tell a ten-thousandth of its size.
    pub fn words(&self) -> String {
        let size = self.low.iter().zip(self.high).map(|(low, high)| high - low).fold(0.0, f64::max);
        let decimals = if size > 0.0 { (4.0 - size.log10()).ceil().clamp(0.0, 12.0) as usize } else { 4 };
        let number = |c: f64| {
            let text = format!("{c:.decimals$}");
            let short = if decimals > 0 { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
            if short == "-0" { "0".to_owned() } else { short.to_owned() }
        };
        let corner = |corner: [f64; 3]| corner.map(number).join(", ");
        let but = if self.but_planes { ", without the planes" } else { "" };
        let at_most = if self.at_most { "at most " } else { "" };
        format!("{at_most}from ({}) to ({}){but}", corner(self.low), corner(self.high))
    }
}

impl Compiled {
    /// The box about what is solid, planes left out; none where that is nothing, has no end within the extent, or is not known.
    pub fn solid_box(&self) -> Option<SolidBox> {
        let ahead = &self.functions.ahead;
        let but_planes = ahead.planes.is_some();
        let whole = || self.bounds().map(|[low, high]| Box3([0, 1, 2].map(|i| Interval::new(corner(low, i), corner(high, i)))));
        let solid = match (ahead.solid, if but_planes { None } else { whole() }) {
            (Some(a), Some(b)) => a.intersect(&b),
            (a, b) => a.or(b)?,
        };
        if solid.is_empty() || !solid.is_finite() {
            return None;
        }
        let at_most = !self.reaches_all_faces(&solid).unwrap_or(false);
        Some(SolidBox { low: solid.0.map(|side| side.lo), high: solid.0.map(|side| side.hi), at_most, but_planes })
    }

    /// Whether the solid comes near all faces of a box, as the sliders stand. None where that takes too long to see.
    fn reaches_all_faces(&self, solid: &Box3) -> Option<bool> {
        let field = self.functions.formulas.get(&(self.root, Function::Field)).copied();
        let root = self.functions.ahead.planes.map_or(field, |planes| Some(planes.rest_bound))?;
        let tape = Tape::new(&self.graph, &self.functions.formulas, &[root], &self.live(), LONGEST).ok()?;
        let points = (WORK / (6 * (ROUNDS as usize + 1) * tape.operations().max(1))).min(POINTS);
        if points < crate::evaluate::LANES {
            return None;
        }
        let mut evaluator = tape.evaluator();
        let faces = (0..3).flat_map(|axis| [(axis, false), (axis, true)]);
        Some(faces.into_iter().all(|(axis, upper)| reaches(&mut evaluator, solid, axis, upper, points)))
    }
}

fn corner(of: [f64; 3], axis: usize) -> f64 {
    of.get(axis).copied().unwrap_or(0.0)
}

/// Looks for a point of the solid in the slab at a face: where the field is least, and nearer about that again and again.
fn reaches(evaluator: &mut Evaluator<'_>, solid: &Box3, axis: usize, upper: bool, points: usize) -> bool {
    let side = solid.axis(axis);
    let thick = NEAR * side.width();
    let slab = solid.with_axis(axis, if upper { Interval::new(side.hi - thick, side.hi) } else { Interval::new(side.lo, side.lo + thick) });
    let mut random = Random(2 * axis as u64 + u64::from(upper));
    let mut best = (f64::INFINITY, slab.0.map(Interval::middle));
    for round in 0..=ROUNDS {
        let half = 0.5 * NEARER.powi(round);
        let place = |random: &mut Random| {
            let mut at = best.1;
            for (c, side) in at.iter_mut().zip(&slab.0) {
                *c = (*c + (2.0 * random.next() - 1.0) * half * side.width()).clamp(side.lo, side.hi);
            }
            at
        };
        let mut places: Vec<[f64; 3]> = (0..points).map(|_| place(&mut random)).collect();
        places.push(best.1);
        let mut least = best;
        evaluator.at(&places, &[], |i, values| {
            if let (Some(&at), Some(&value)) = (places.get(i), values.first())
                && value < least.0
            {
                least = (value, at);
            }
        });
        best = least;
        if best.0 <= 0.0 {
            return true;
        }
    }
    false
}
