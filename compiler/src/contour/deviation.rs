//! How far triangles are from the surface: measured at their middles and at those of their edges.
//!
//! From such a point some steps of Newton's lead to the surface, around the edges of what is cut out too. From there the field is followed along its
//! gradient until it changes sign. The place where it does is a point of the surface, so the whole way there is no less than the distance.

use super::field::{Eyes, Field};
use super::Mesh;
use crate::vector::{Vec3, add, along, dot, length, scale, sub, unit};
use crate::spread::spread;

/// Triangles that one task asks for.
const SHARE: usize = 256;
/// Newton's steps; none is longer than a cell.
const TOWARD: usize = 4;
/// No farther from the triangles is asked what the field is, in cells: after all steps, twice a cell.
const ASKED: f64 = TOWARD as f64 + 3.0;
/// Steps by which a sign change is enclosed, each twice as wide as the one before; the last is twice a cell.
const WIDER: i32 = 16;
/// Halves by which it is found then.
const HALVES: usize = 12;

/// The largest distance found from any triangle of which every so many are asked; twice a cell where no sign change is found within that.
pub(super) fn deviation(field: &Field, mesh: &Mesh, every: usize) -> f64 {
    let asked: Vec<&[u32; 3]> = mesh.triangles.iter().step_by(every).collect();
    let shares: Vec<&[&[u32; 3]]> = asked.chunks(SHARE).collect();
    let found = spread(shares.len(), &|| (), &|(), i| {
        let points: Vec<Vec3> = shares.get(i).iter().flat_map(|share| share.iter()).flat_map(|t| places(mesh.corners(t))).collect();
        let near = field.near(points.iter().copied(), ASKED * mesh.cell);
        farthest(&mut near.eyes(), &points, mesh.cell)
    });
    found.into_iter().fold(0.0, f64::max)
}

/// The middle of a triangle, and those of its edges.
fn places([a, b, c]: [Vec3; 3]) -> [Vec3; 4] {
    let half = |p: Vec3, q: Vec3| scale(add(p, q), 0.5);
    [scale(add(a, add(b, c)), 1.0 / 3.0), half(a, b), half(b, c), half(c, a)]
}

/// Ways to the corners and to the middles of the faces of a cube.
pub(super) const AROUND: [Vec3; 14] = {
    const S: f64 = 0.577_350_269;
    [
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
        [S, S, S],
        [-S, S, S],
        [S, -S, S],
        [-S, -S, S],
        [S, S, -S],
        [-S, S, -S],
        [S, -S, -S],
        [-S, -S, -S],
    ]
};

#[derive(Clone, Copy)]
struct Way {
    from: Vec3,
    /// How far the steps before have led.
    before: f64,
    /// Toward the surface, of length one.
    way: Vec3,
    solid: bool,
    /// The surface is farther than the first, and no farther than the second.
    between: [f64; 2],
}

fn farthest(eyes: &mut Eyes<'_>, points: &[Vec3], cell: f64) -> f64 {
    let mut places = points.to_vec();
    let (mut values, mut slopes) = (eyes.values(&places), eyes.slopes(&places, cell));
    for _ in 0..TOWARD {
        for ((place, value), slope) in places.iter_mut().zip(values).zip(slopes) {
            let steep = dot(slope, slope);
            let step = if steep > 0.0 { scale(slope, -value / steep) } else { [0.0; 3] };
            *place = along(*place, step, (cell / length(step).max(1e-300)).min(1.0));
        }
        (values, slopes) = (eyes.values(&places), eyes.slopes(&places, cell));
    }
    let mut met: Vec<Way> = Vec::new();
    let mut open: Vec<Way> = Vec::new();
    for ((from, place), (value, slope)) in points.iter().zip(places).zip(values.into_iter().zip(slopes)) {
        let way = unit(slope).map_or([0.0; 3], |n| scale(n, -value.signum()));
        let found = Way { from: place, before: length(sub(place, *from)), way, solid: value < 0.0, between: [0.0, 0.0] };
        if value == 0.0 { met.push(found) } else { open.push(found) }
    }
    for step in 0..=WIDER {
        let far = 2.0 * cell * 0.5f64.powi(WIDER - step);
        let changed = signs(eyes, &open, |_| far);
        let mut next = Vec::new();
        for (mut way, changed) in open.into_iter().zip(changed) {
            way.between = [if changed { way.between[0] } else { far }, far];
            if changed { met.push(way) } else { next.push(way) }
        }
        open = next;
    }
    // By an edge the gradient may point past the solid: the other ways around are tried for those that are left.
    for step in 0..=WIDER {
        let far = 2.0 * cell * 0.5f64.powi(WIDER - step);
        let mut changed = vec![false; open.len()];
        for around in AROUND {
            let toward = |way: &Way| Way { way: around, ..*way };
            let found = signs(eyes, &open.iter().map(toward).collect::<Vec<_>>(), |_| far);
            changed.iter_mut().zip(found).for_each(|(all, one)| *all |= one);
        }
        let mut next = Vec::new();
        for (way, changed) in open.into_iter().zip(changed) {
            if changed { met.push(Way { between: [far, far], ..way }) } else { next.push(way) }
        }
        open = next;
    }
    for _ in 0..HALVES {
        let half = |way: &Way| 0.5 * (way.between[0] + way.between[1]);
        let changed = signs(eyes, &met, half);
        for (way, changed) in met.iter_mut().zip(changed) {
            let half = half(way);
            way.between = if changed { [way.between[0], half] } else { [half, way.between[1]] };
        }
        // Those that are surely not the farthest need no further look.
        let most = met.iter().map(|way| way.before + way.between[0]).fold(0.0, f64::max);
        met.retain(|way| way.before + way.between[1] >= most);
    }
    open.iter().chain(&met).map(|way| way.before + way.between[1]).fold(0.0, f64::max)
}

/// Whether the field has another sign so far along each way.
fn signs(eyes: &mut Eyes<'_>, ways: &[Way], far: impl Fn(&Way) -> f64) -> Vec<bool> {
    let points: Vec<Vec3> = ways.iter().map(|way| along(way.from, way.way, far(way))).collect();
    eyes.values(&points).into_iter().zip(ways).map(|(value, way)| (value < 0.0) != way.solid).collect()
}
