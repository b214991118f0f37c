//! The volume of what is solid and its centre of mass, between two numbers each.
//!
//! A box in which the field is surely below zero is solid, and one in which it is surely not is empty. In any other the field lies between two linear
//! functions, by its value at the middle and its gradient over the box (the mean-value theorem): the solid holds what of the box is below zero by the upper
//! one, and lies within what is by the lower one. Both are known exactly (`clip.rs`). The boxes of which least is known are cut in eight, again and again.
//! What is not known falls with the square of their size where the surface is smooth, and around edges too.

#![allow(clippy::indexing_slicing)] // Every index is that of an axis.

use super::clip::{Part, below};
use crate::certify::{Box3, Prover, Truth};
use crate::graph::interval::Interval;
use crate::spread::spread;
use crate::vector::{Vec3, add, along, scale, sub};

/// Boxes along the longest side at first.
const FIRST: f64 = 8.0;
/// Operations over boxes, as the prover counts them.
const WORK: u64 = 5_000_000_000;
/// Branches of the field that are looked at in a box: a few kinks meet there, or it is noise, of which they tell little.
const BRANCHES: usize = 8;
/// Boxes that are left open.
const MOST: usize = 1_000_000;
/// Boxes that one task cuts.
const SHARE: usize = 64;
/// Boxes that are cut before it is asked again which are worth it.
const ROUND: usize = 20_000;

/// A volume and a centre of mass, each surely between two numbers.
pub(super) struct Filled {
    pub volume: Interval,
    pub centre: [Interval; 3],
}

/// A box that is not decided: what of it surely is solid, about its own middle, and the volume of what may be so beside that.
struct Cell {
    range: Box3,
    sure: Part,
    open: f64,
}

enum Found {
    Solid,
    Empty,
    Open(Cell),
}

/// Fills a box that holds the solid, until the volume is known to within `enough` or much was computed.
pub(super) fn volume(truth: &Truth, whole: Box3, enough: f64, progress: &dyn Fn(f64)) -> Filled {
    let widest = whole.iter().fold(0.0, |most: f64, side| most.max(side.width()));
    let origin = whole.map(Interval::middle);
    let mut solid = Part::default();
    let mut open: Vec<Cell> = Vec::new();
    let (mut work, mut boxes) = (0, 0);
    let mut cut: Vec<Box3> = grid(whole, whole.map(|side| (FIRST * side.width() / widest).ceil().max(1.0) as usize));
    loop {
        let shares: Vec<&[Box3]> = cut.chunks(SHARE).collect();
        let found = spread(shares.len(), &|| truth.prover(), &|prover, i| {
            let before = prover.work();
            let found: Vec<(Box3, Found)> = shares[i].iter().map(|range| (*range, look(prover, *range))).collect();
            (found, prover.work() - before)
        });
        for (found, took) in found {
            work += took;
            boxes += found.len();
            for (range, found) in found {
                match found {
                    Found::Solid => {
                        let volume = range[0].width() * range[1].width() * range[2].width();
                        solid = solid.plus(Part { volume, moment: scale(sub(range.map(Interval::middle), origin), volume) });
                    }
                    Found::Empty => {}
                    Found::Open(cell) => open.push(cell),
                }
            }
        }
        let unknown = open.iter().map(|cell| cell.open).sum::<f64>();
        let part = work as f64 / WORK as f64;
        progress(part.max((2.0 * enough / unknown).min(1.0)));
        if 0.5 * unknown <= enough || work >= WORK || open.len() >= MOST {
            return filled(whole, origin, solid, &open, boxes);
        }
        // Those of which least is known, so that what the others do not tell is half of what is allowed.
        open.sort_unstable_by(|a, b| b.open.total_cmp(&a.open));
        let mut rest = unknown;
        let count = open.iter().take(ROUND).take_while(|cell| {
            let more = rest > enough;
            rest -= cell.open;
            more
        }).count();
        cut = open.drain(..count.max(1).min(open.len())).flat_map(|cell| grid(cell.range, [2; 3])).collect();
    }
}

/// A box in equal parts.
fn grid(range: Box3, counts: [usize; 3]) -> Vec<Box3> {
    let parts = [0, 1, 2].map(|axis| {
        let (side, n) = (range[axis], counts[axis]);
        let wall = |i: usize| if i == n { side.hi } else { side.lo + side.width() * i as f64 / n as f64 };
        (0..n).map(|i| Interval { lo: wall(i), hi: wall(i + 1) }).collect::<Vec<_>>()
    });
    let [xs, ys, zs] = &parts;
    zs.iter().flat_map(|z| ys.iter().flat_map(move |y| xs.iter().map(move |x| [*x, *y, *z]))).collect()
}

fn look(prover: &mut Prover<'_>, range: Box3) -> Found {
    let over = prover.over_branches(range, BRANCHES);
    if over.value.hi < 0.0 {
        return Found::Solid;
    }
    if over.value.lo >= 0.0 {
        return Found::Empty;
    }
    let middle = range.map(Interval::middle);
    let half = [0, 1, 2].map(|axis| (range[axis].hi - middle[axis]).max(middle[axis] - range[axis].lo));
    let whole = Part { volume: 8.0 * half[0] * half[1] * half[2], ..Part::default() };
    let (mut sure, mut may) = (Part::default(), whole);
    if !over.jump && over.gradient.iter().all(|slope| slope.is_finite()) {
        let value = prover.range(middle.map(Interval::point));
        let slope = over.gradient.map(Interval::middle);
        let off = [0, 1, 2].map(|axis| (over.gradient[axis].width() * 0.5).next_up() * half[axis]).iter().sum::<f64>();
        // A little more, for the rounding of these lines.
        let off = off + 1e-14 * (off + value.magnitude() + [0, 1, 2].map(|axis| slope[axis].abs() * half[axis]).iter().sum::<f64>());
        sure = below(half, value.hi + off, slope);
        may = below(half, value.lo - off, slope);
    }
    Found::Open(Cell { range, sure, open: (may.volume - sure.volume).max(0.0) })
}

/// Volume and centre of all boxes: of the solid ones, about `origin`, and of those that are open.
fn filled(whole: Box3, origin: Vec3, solid: Part, open: &[Cell], boxes: usize) -> Filled {
    let least = solid.volume + open.iter().map(|cell| cell.sure.volume).sum::<f64>();
    let unknown = open.iter().map(|cell| cell.open).sum::<f64>();
    // What so many sums may lose by rounding.
    let slack = f64::EPSILON * (boxes + 64) as f64 * (least + unknown);
    let volume = Interval::new((least - slack).max(0.0), least + unknown + slack);
    // About a guess of the centre, so that what is not known of the volume counts as little as it can.
    let place = |cell: &Cell| cell.range.map(Interval::middle);
    let moment = open.iter().fold(solid.moment, |sum, cell| {
        let volume = cell.sure.volume + 0.5 * cell.open;
        add(add(sum, cell.sure.moment), scale(sub(place(cell), origin), volume))
    });
    let guess = along(origin, moment, 1.0 / (least + 0.5 * unknown).max(f64::MIN_POSITIVE));
    let mut centre = whole;
    for (axis, side) in centre.iter_mut().enumerate() {
        let size = side.width();
        let mut sum = Interval::point(solid.moment[axis] - solid.volume * (guess[axis] - origin[axis]));
        for cell in open {
            let sure = cell.sure.moment[axis] + cell.sure.volume * (place(cell)[axis] - guess[axis]);
            let away = cell.range[axis].sub(Interval::point(guess[axis]));
            let may = Interval::new((cell.open * away.lo).min(0.0), (cell.open * away.hi).max(0.0));
            sum = Interval { lo: sum.lo + sure + may.lo, hi: sum.hi + sure + may.hi };
        }
        let mean = sum.grow(slack * size).div(volume);
        *side = side.intersect(mean.add(Interval::point(guess[axis])));
    }
    Filled { volume, centre }
}
