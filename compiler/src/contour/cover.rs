//! From the surface to the mesh: all of space in cells, as large as those of the mesh.
//!
//! A cell is done where the field keeps its sign in it, or where what lies between the planes that hold its zeros is near to triangles. Any
//! other is cut in two, the part first of which least is known.

use super::asked::{Asked, Way};
use super::prism::{Prism, ROUNDED};
use crate::certify::{Box3, Held, Look, Place, Prover, Slab};
use crate::graph::interval::Interval;
use crate::spread::spread;
use crate::vector::{Vec3, along, dot, length, sub};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Boxes that are looked at in a cell that is within the tolerance, to know it better.
const FEW: usize = 24;
/// The same in another.
const MANY: usize = 600;
/// After so many boxes of a cell the worst part is asked first whether it is proven to be farther.
const EARLY: usize = 12;
/// A part that is no thicker than this part of its distance, and has a corner almost as far away, is known well enough.
const THIN: f64 = 0.3;
/// Parts of a cell that are asked whether they are proven to be farther.
const ASKED: usize = 32;
/// So many blocks of cells are found before each is a task.
const BLOCKS: usize = 512;
/// Boxes that one task looks at before.
const SHARE: usize = 32;
/// How often the extent is halved at most.
const DEEPEST: u32 = 40;

/// Where the surface is looked for, and what the field may be there.
struct Part {
    room: Box3,
    /// Zero; on a wall at which the solid is cut off, all that is solid.
    target: Interval,
}

/// A cube of cells that may hold the surface.
struct Cube {
    range: Box3,
    place: Place,
}

/// A part of a cell. The greatest is that of which least is known.
struct Open {
    far: f64,
    place: Place,
    halves: [Box3; 2],
    kink: bool,
    /// The thinnest of those that hold the surface.
    slab: Option<Slab>,
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        self.far.total_cmp(&other.far)
    }
}

/// What is proven of the way from the surface to the mesh.
pub(super) fn cover(asked: &Asked, progress: &(dyn Fn(f64) + Sync)) -> Way {
    let mut parts = vec![Part { room: asked.room, target: Interval::ZERO }];
    if asked.cut {
        for axis in 0..3 {
            for wall in [|side: Interval| side.lo, |side: Interval| side.hi] {
                let mut room = asked.room;
                room.iter_mut().skip(axis).take(1).for_each(|side| *side = Interval::point(wall(*side)));
                parts.push(Part { room, target: Interval { lo: f64::NEG_INFINITY, hi: 0.0 } });
            }
        }
    }
    let all = parts.len() as f64;
    let known = |way: Way, (i, part): (usize, &Part)| way.and(covered(asked, part, &|done| progress((i as f64 + done) / all)));
    parts.iter().enumerate().fold(Way::NOTHING, known)
}

fn covered(asked: &Asked, part: &Part, progress: &(dyn Fn(f64) + Sync)) -> Way {
    // A cube of so many halvings of cells, off the middle so that what is laid out in round numbers lies on no wall.
    let low = asked.room.map(|side| side.lo - 0.381_966 * asked.mesh.cell);
    let wide = asked.room.iter().zip(low).map(|(side, low)| side.hi - low).fold(0.0, f64::max);
    let mut deep = 0;
    while asked.mesh.cell * 2f64.powi(deep) < wide && deep < DEEPEST as i32 {
        deep += 1;
    }
    let size = wide.max(asked.mesh.cell * 2f64.powi(deep));
    let whole = low.map(|low| Interval { lo: low, hi: low + size });
    let place = asked.truth.prover().place(part.room);
    let mut cubes = vec![Cube { range: whole, place }];
    let mut level = 0;
    while level < deep && cubes.len() < BLOCKS {
        let shares: Vec<&[Cube]> = cubes.chunks(SHARE).collect();
        let found = spread(shares.len(), &|| asked.truth.prover(), &|prover, i| {
            shares.get(i).iter().flat_map(|share| share.iter()).flat_map(|cube| eighths(prover, part, cube)).collect::<Vec<_>>()
        });
        cubes = found.into_iter().flatten().collect();
        level += 1;
    }
    let done = AtomicUsize::new(0);
    let found = spread(cubes.len(), &|| asked.truth.prover(), &|prover, i| {
        let mut way = Way::NOTHING;
        let mut hint = 0;
        // The cubes of each level that are still to be looked at, so that there are never many.
        let mut open: Vec<(Cube, i32)> = cubes.get(i).map(|cube| (Cube { range: cube.range, place: cube.place.clone() }, level)).into_iter().collect();
        while let Some((cube, level)) = open.pop() {
            if level < deep {
                open.extend(eighths(prover, part, &cube).into_iter().map(|cube| (cube, level + 1)));
            } else {
                way = way.and(Cell::new(asked, part, cube.place).settled(prover, &mut hint));
            }
        }
        progress((done.fetch_add(1, Relaxed) + 1) as f64 / cubes.len() as f64);
        way
    });
    found.into_iter().fold(Way::NOTHING, Way::and)
}

/// The eighths of a cube that may hold the surface.
fn eighths(prover: &mut Prover<'_>, part: &Part, cube: &Cube) -> Vec<Cube> {
    let halves = cube.range.map(|side| [Interval { lo: side.lo, hi: side.middle() }, Interval { lo: side.middle(), hi: side.hi }]);
    let [xs, ys, zs] = halves;
    let all = zs.into_iter().flat_map(|z| ys.into_iter().flat_map(move |y| xs.into_iter().map(move |x| [x, y, z])));
    all.filter_map(|range| {
        let inside = within(&range, &part.room)?;
        match prover.look(cube.place.within(inside), part.target, false) {
            Look::Held(held) => Some(Cube { range, place: held.place.within(inside) }),
            _ => None,
        }
    }).collect()
}

/// What two boxes have in common, if anything.
fn within(a: &Box3, b: &Box3) -> Option<Box3> {
    let mut both = *a;
    both.iter_mut().zip(b).for_each(|(x, y)| *x = x.intersect(*y));
    both.iter().all(|x| !x.is_empty()).then_some(both)
}

/// A cell through which the surface may go.
struct Cell<'a> {
    asked: &'a Asked<'a>,
    part: &'a Part,
    base: Place,
    open: BinaryHeap<Open>,
    /// How far the parts are at most that are done, and where that is so.
    done: (f64, Vec3),
    /// Boxes that were looked at, and those in which surface may be.
    looked: usize,
    held: usize,
    /// After so many boxes the worst is asked whether it is farther.
    next: usize,
}

impl<'a> Cell<'a> {
    fn new(asked: &'a Asked<'a>, part: &'a Part, base: Place) -> Self {
        let middle = base.range.map(Interval::middle);
        Self { asked, part, base, open: BinaryHeap::new(), done: (0.0, middle), looked: 0, held: 0, next: EARLY }
    }

    fn settled(mut self, prover: &mut Prover<'_>, hint: &mut u32) -> Way {
        let asked = self.asked;
        self.look(prover, self.base.clone(), hint);
        if self.held == 0 {
            return Way::NOTHING;
        }
        let mut way = Way { parts: 1, ..Way::NOTHING };
        while let Some(worst) = self.open.peek() {
            let far = worst.far > asked.tolerance;
            // Some points are found to be too far away before all of a cell is looked at.
            if far && self.looked >= self.next {
                self.next = self.next * 3 / 2;
                if let Some((least, at)) = self.at_least(prover, worst, hint).filter(|found| found.0 > asked.tolerance) {
                    (way.at_least, way.wrong) = (least, Some(at));
                    break;
                }
            }
            if self.looked >= if far { MANY } else { FEW } {
                break;
            }
            let Some(Open { far, place, halves, kink, .. }) = self.open.pop() else { break };
            if kink && let Some(sides) = prover.sides(&place) {
                sides.into_iter().for_each(|side| self.look(prover, side, hint));
                continue;
            }
            if halves.contains(&place.range) {
                // No number is between its walls.
                self.done(far, &place);
                continue;
            }
            for half in halves {
                self.look(prover, place.within(half), hint);
            }
        }
        let open = std::mem::take(&mut self.open).into_sorted_vec();
        if let Some(worst) = open.last() {
            self.done(worst.far, &worst.place);
        }
        (way.proven, way.at) = self.done;
        if way.proven > asked.tolerance {
            for part in open.iter().rev().take(ASKED).filter(|open| open.far > asked.tolerance) {
                if part.far > way.at_least
                    && let Some((least, at)) = self.at_least(prover, part, hint)
                    && least > way.at_least
                {
                    (way.at_least, way.wrong) = (least, Some(at));
                }
            }
            if way.at_least > asked.tolerance {
                way.farther = 1;
            } else {
                (way.undecided, way.wrong) = (1, Some(way.at));
            }
        }
        way
    }

    /// Keeps how far a part is at most of which no more is looked at.
    fn done(&mut self, far: f64, place: &Place) {
        if far >= self.done.0 {
            self.done = (far, place.range.map(Interval::middle));
        }
    }

    /// Looks at a part of the cell, and keeps what of it may be farther than is wanted.
    fn look(&mut self, prover: &mut Prover<'_>, place: Place, hint: &mut u32) {
        let asked = self.asked;
        let mut places = vec![place];
        while let Some(place) = places.pop() {
            self.looked += 1;
            match prover.look(place, self.part.target, self.looked < MANY) {
                Look::Nothing => {}
                Look::Parted(pieces) => places.extend(pieces),
                Look::Held(held) => {
                    let Held { place, slabs, halves, kink } = *held;
                    let Some(prism) = Prism::new(&place.range, &slabs) else { continue };
                    self.held += 1;
                    let (far, near) = prism.farthest(asked.boxes, asked.fine, hint);
                    // What is thin is not told better by less of it.
                    let told = !kink && prism.thickness() <= THIN * far && near >= (1.0 - THIN) * far;
                    if far <= asked.fine || far <= asked.tolerance && told {
                        self.done(far, &place);
                    } else {
                        let slab = slabs.iter().min_by(|a, b| a.thickness().total_cmp(&b.thickness())).copied();
                        self.open.push(Open { far, place, halves, kink, slab });
                    }
                }
            }
        }
    }

    /// How far the surface in a part surely is from the mesh, and where; none where it is not sure that there is some.
    fn at_least(&self, prover: &mut Prover<'_>, part: &Open, hint: &mut u32) -> Option<(f64, Vec3)> {
        let range = &part.place.range;
        let middle = range.map(Interval::middle);
        let corners = (0..8).map(|i| {
            let mut axis = 0;
            range.map(|side| {
                axis += 1;
                if i >> (axis - 1) & 1 == 1 { side.hi } else { side.lo }
            })
        });
        let corners: Vec<Vec3> = corners.chain([middle]).collect();
        if self.crossed(prover, &corners) {
            return Some(self.away(middle, &corners, hint));
        }
        // Across the planes that hold the surface, on both sides of them.
        let slab = part.slab.filter(|slab| slab.thickness().is_finite())?;
        let height = dot(sub(middle, slab.from), slab.normal);
        let on = along(middle, slab.normal, 0.5 * (slab.heights[0] + slab.heights[1]) - height);
        [0.51, 2.0, 8.0].into_iter().find_map(|times| {
            let by = times * slab.thickness();
            let ends = [along(on, slab.normal, by), along(on, slab.normal, -by)];
            let inside = ends.iter().all(|end| self.base.range.iter().zip(end).all(|(side, x)| side.contains(*x)));
            (inside && self.crossed(prover, &ends)).then(|| self.away(on, &ends, hint))
        })
    }

    /// Whether there surely is surface between points.
    fn crossed(&self, prover: &mut Prover<'_>, points: &[Vec3]) -> bool {
        let sides: Vec<i8> = points.iter().map(|at| prover.side_of_point(&self.base, *at)).collect();
        // On a wall at which the solid is cut off all that is solid is surface.
        sides.contains(&-1) && (sides.contains(&1) || self.part.target.lo < 0.0)
    }

    /// How far all that is between some points and another is from the mesh at least, and that.
    fn away(&self, middle: Vec3, points: &[Vec3], hint: &mut u32) -> (f64, Vec3) {
        let reach = points.iter().map(|at| length(sub(*at, middle))).fold(0.0, f64::max);
        let near = self.asked.boxes.closest(middle, *hint);
        let scale = middle.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
        // Less what these lines may lose.
        (near.squared.sqrt() * (1.0 - 1e-6) - reach - ROUNDED * scale, middle)
    }
}
