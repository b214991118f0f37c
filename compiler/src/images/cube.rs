//! Light from all directions on six faces: what a mirror, a glossy and a matte surface see of it.
//!
//! Faces and their axes are those of OpenGL, Vulkan and WebGPU: px is what lies along x, and so on; a face's `s` goes to the right and
//! its `t` down, seen from within with the eye along z, x to the right and y up.

use super::bitmap::{Bitmap, blend, mean4};
use crate::vector::{Vec3, add, cross, dot, scale, sub, unit};
use std::f64::consts::PI;

/// The names of the faces, in their order.
pub const FACES: [&str; 6] = ["px", "nx", "py", "ny", "pz", "nz"];
/// The longest side of a face; larger images are made smaller.
const LARGEST: usize = 1024;
/// Sides of the most blurred level.
const SMALLEST: usize = 8;
/// The roughness of a surface that the shading takes for a mirror.
pub const POLISHED: f64 = 0.06;

/// Light from all directions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cube {
    /// Pixels of a side of the sharpest level, a power of two.
    side: usize,
    /// Each half the side of the one before, and as blurred as [`Cube::roughness_of`] says: face by face, row by row.
    levels: Vec<Vec<[f32; 3]>>,
    /// What a matte surface sees, by the first nine spherical harmonics of its normal.
    harmonics: [Vec3; 9],
}

/// The face that a direction meets, and where: `s` and `t` from 0 to 1.
fn place(d: Vec3) -> (usize, f64, f64) {
    let [x, y, z] = d;
    let (ax, ay, az) = (x.abs(), y.abs(), z.abs());
    let (face, s, t, m) = if az >= ax && az >= ay {
        if z >= 0.0 { (4, x, -y, az) } else { (5, -x, -y, az) }
    } else if ay >= ax {
        if y >= 0.0 { (2, x, z, ay) } else { (3, x, -z, ay) }
    } else if x >= 0.0 {
        (0, -z, -y, ax)
    } else {
        (1, z, -y, ax)
    };
    let m = m.max(1e-30);
    (face, 0.5 * (s / m + 1.0), 0.5 * (t / m + 1.0))
}

/// The direction of a place on a face, or beside it; of no special length.
pub(super) fn direction(face: usize, s: f64, t: f64) -> Vec3 {
    let (s, t) = (2.0 * s - 1.0, 2.0 * t - 1.0);
    match face {
        0 => [1.0, -t, -s],
        1 => [-1.0, -t, s],
        2 => [s, 1.0, t],
        3 => [s, -1.0, -t],
        4 => [s, -t, 1.0],
        _ => [-s, -t, -1.0],
    }
}

impl Cube {
    /// From six faces in the order of [`FACES`], each a square.
    pub fn from_faces(faces: &[Bitmap; 6]) -> Self {
        let side = faces.iter().map(|f| f.width).max().unwrap_or(1);
        let level = fitting(side);
        let mut texels = Vec::with_capacity(6 * level * level);
        for face in faces {
            let mut face = std::borrow::Cow::Borrowed(face);
            while face.width >= 2 * level {
                face = std::borrow::Cow::Owned(face.half());
            }
            texels.extend(places(level).map(|(s, t)| {
                if face.width == level {
                    return face.get((s * level as f64) as usize, (t * level as f64) as usize);
                }
                narrow(face.bilinear(s, t, false))
            }));
        }
        Self::of_level(level, texels)
    }

    /// From an image of all directions; see [`super::EnvironmentKind::Equirect`].
    pub fn from_equirect(image: &Bitmap) -> Self {
        let side = fitting((image.height / 2).max(image.width / 4));
        let mut image = std::borrow::Cow::Borrowed(image);
        while image.height >= 4 * side {
            image = std::borrow::Cow::Owned(image.half());
        }
        Self::of_directions(side, |d| image.bilinear(0.5 + d[0].atan2(-d[2]) / (2.0 * PI), d[1].clamp(-1.0, 1.0).acos() / PI, true))
    }

    /// From a function of directions of length one. `side` is a power of two.
    pub fn of_directions(side: usize, light: impl Fn(Vec3) -> Vec3) -> Self {
        let part = 0.25 / side as f64;
        let corners = [(-part, -part), (part, -part), (-part, part), (part, part)];
        let mut texels = Vec::with_capacity(6 * side * side);
        for face in 0..6 {
            texels.extend(places(side).map(|(s, t)| {
                mean4(corners.map(|(ds, dt)| {
                    let d = direction(face, s + ds, t + dt);
                    narrow(light(unit(d).unwrap_or(d)))
                }))
            }));
        }
        Self::of_level(side, texels)
    }

    /// From the pixels of the sharpest level.
    fn of_level(side: usize, texels: Vec<[f32; 3]>) -> Self {
        let means = means(side, texels);
        let mut cube = Self { side, harmonics: harmonics(&means), levels: means };
        let sharp = cube.clone();
        let count = cube.levels.len().min(1 + (side / SMALLEST).max(1).ilog2() as usize);
        cube.levels.truncate(count);
        for (i, level) in cube.levels.iter_mut().enumerate().skip(1) {
            let roughness = POLISHED + (1.0 - POLISHED) * i as f64 / (count - 1) as f64;
            let samples = lobe(roughness, (8192 / (side >> i)).clamp(32, 512) as u32);
            let side = side >> i;
            for (texel, (face, (s, t))) in level.iter_mut().zip((0..6).flat_map(|f| places(side).map(move |p| (f, p)))) {
                let axis = direction(face, s, t);
                *texel = narrow(sharp.blurred(unit(axis).unwrap_or(axis), &samples));
            }
        }
        cube
    }

    /// The mean of the light about a direction, by a lobe's samples.
    fn blurred(&self, axis: Vec3, samples: &[Sample]) -> Vec3 {
        let helper = if axis[1].abs() < 0.9 { [0.0, 1.0, 0.0] } else { [1.0, 0.0, 0.0] };
        let right = unit(cross(helper, axis)).unwrap_or([1.0, 0.0, 0.0]);
        let up = cross(axis, right);
        let texel = 4.0 * PI / (6.0 * (self.side * self.side) as f64);
        let mut sum = [0.0; 3];
        let mut weights = 0.0;
        for sample in samples {
            let [x, y, z] = sample.toward;
            let d = add(add(scale(right, x), scale(up, y)), scale(axis, z));
            // As blurred as the samples are apart (Křivánek and Colbert, "Real-time Shading with Filtered Importance Sampling", 2008).
            let level = (0.5 * (sample.angle / texel).log2()).max(0.0);
            sum = add(sum, scale(self.at_level(d, level), z));
            weights += z;
        }
        scale(sum, 1.0 / f64::max(weights, 1e-9))
    }

    /// Pixels of a side of the sharpest level.
    pub fn side(&self) -> usize {
        self.side
    }

    /// The levels, the sharpest first; each holds six faces, row by row.
    pub fn levels(&self) -> &[Vec<[f32; 3]>] {
        &self.levels
    }

    /// What a matte surface sees, by spherical harmonics: coefficients of 1, y, z, x, xy, yz, 3z² - 1, xz, x² - y² of its normal.
    pub fn harmonics(&self) -> &[Vec3; 9] {
        &self.harmonics
    }

    /// The level of a roughness.
    pub fn level_of(&self, roughness: f64) -> f64 {
        ((roughness - POLISHED) / (1.0 - POLISHED)).clamp(0.0, 1.0) * self.levels.len().saturating_sub(1) as f64
    }

    /// The light from a direction, as a surface of some roughness mirrors it.
    pub fn glossy(&self, direction: Vec3, roughness: f64) -> Vec3 {
        self.at_level(direction, self.level_of(roughness))
    }

    /// The light from a direction.
    pub fn sharp(&self, direction: Vec3) -> Vec3 {
        self.at_level(direction, 0.0)
    }

    /// The mean of the light over the half of all directions about a normal, by its cosine.
    pub fn matte(&self, normal: Vec3) -> Vec3 {
        let sum = self.harmonics.iter().zip(basis(normal)).fold([0.0; 3], |sum, (c, b)| add(sum, scale(*c, b)));
        sum.map(|c| c.max(0.0))
    }

    fn at_level(&self, direction: Vec3, level: f64) -> Vec3 {
        let last = self.levels.len().saturating_sub(1);
        let level = level.clamp(0.0, last as f64);
        let (low, part) = (level.floor() as usize, level.fract());
        let near = self.bilinear(direction, low);
        if part == 0.0 { near } else { blend(near, self.bilinear(direction, low + 1), part) }
    }

    /// Between the four pixels about a direction, over the edges of faces.
    fn bilinear(&self, d: Vec3, level: usize) -> Vec3 {
        let side = (self.side >> level).max(1);
        let (face, s, t) = place(d);
        let (x, y) = (s * side as f64 - 0.5, t * side as f64 - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let at = |dx: f64, dy: f64| self.texel(level, side, face, left + dx, top + dy);
        let row = |dy: f64| blend(at(0.0, dy), at(1.0, dy), x - left);
        blend(row(0.0), row(1.0), y - top)
    }

    /// The pixel of a column and a row of a face; beyond its edge that of the neighbour.
    fn texel(&self, level: usize, side: usize, face: usize, x: f64, y: f64) -> Vec3 {
        let end = (side - 1) as f64;
        let inside = x >= 0.0 && y >= 0.0 && x <= end && y <= end;
        let (face, x, y) = if inside {
            (face, x as usize, y as usize)
        } else {
            let (face, s, t) = place(direction(face, (x + 0.5) / side as f64, (y + 0.5) / side as f64));
            let cell = |at: f64| ((at * side as f64) as usize).min(side - 1);
            (face, cell(s), cell(t))
        };
        let found = self.levels.get(level).and_then(|l| l.get((face * side + y) * side + x));
        found.copied().unwrap_or_default().map(f64::from)
    }
}

/// The power of two at or below a side, within what is taken.
fn fitting(side: usize) -> usize {
    let side = side.clamp(SMALLEST, LARGEST);
    1 << side.ilog2()
}

/// The middles of a face's pixels, row by row.
fn places(side: usize) -> impl Iterator<Item = (f64, f64)> {
    let middle = move |i: usize| (i as f64 + 0.5) / side as f64;
    (0..side).flat_map(move |y| (0..side).map(move |x| (middle(x), middle(y))))
}

/// The levels of a cube by plain means, down to one pixel a face.
fn means(side: usize, texels: Vec<[f32; 3]>) -> Vec<Vec<[f32; 3]>> {
    let mut levels = vec![texels];
    let mut side = side;
    while let Some(last) = levels.last().filter(|_| side > 1) {
        let half = side / 2;
        let get = |face: usize, x: usize, y: usize| last.get((face * side + y) * side + x).copied().unwrap_or_default();
        let mean = |face: usize, x: usize, y: usize| {
            mean4([(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| get(face, 2 * x + dx, 2 * y + dy)))
        };
        let faces = (0..6).flat_map(|f| (0..half).flat_map(move |y| (0..half).map(move |x| (f, x, y))));
        let next = faces.map(|(f, x, y)| mean(f, x, y)).collect();
        levels.push(next);
        side = half;
    }
    levels
}

/// A direction about the z axis by which a lobe is sampled, and the angle for which it stands.
struct Sample {
    toward: Vec3,
    angle: f64,
}

/// The directions that a surface of some roughness mirrors when it is seen head-on: the distribution GGX (Walter et al. 2007), by
/// Hammersley's points.
fn lobe(roughness: f64, count: u32) -> Vec<Sample> {
    let width2 = roughness.powi(4);
    let sample = |i: u32| {
        let around = 2.0 * PI * (f64::from(i) + 0.5) / f64::from(count);
        let share = f64::from(i.reverse_bits()) / 4_294_967_296.0 + 0.5 / f64::from(count);
        let cos2 = (1.0 - share) / (1.0 + (width2 - 1.0) * share);
        let (cos, sin) = (cos2.sqrt(), (1.0 - cos2).max(0.0).sqrt());
        let half = [sin * around.cos(), sin * around.sin(), cos];
        let toward = sub(scale(half, 2.0 * cos), [0.0, 0.0, 1.0]);
        let below = cos2 * (width2 - 1.0) + 1.0;
        // The density of mirrored directions is a quarter of that of normals.
        let density = 0.25 * width2 / (PI * below * below);
        Sample { toward, angle: 1.0 / (f64::from(count) * density) }
    };
    (0..count).map(sample).filter(|s| s.toward[2] > 0.0).collect()
}

/// The polynomials of the first nine spherical harmonics.
fn basis([x, y, z]: Vec3) -> [f64; 9] {
    [1.0, y, z, x, x * y, y * z, 3.0 * z * z - 1.0, x * z, x * x - y * y]
}

/// What a matte surface sees, as factors of [`basis`]: Ramamoorthi and Hanrahan, "An Efficient Representation for Irradiance Environment
/// Maps" (2001), over π. `levels` are means.
fn harmonics(levels: &[Vec<[f32; 3]>]) -> [Vec3; 9] {
    // Squares of the harmonics' norms, and the shares of a cosine by their order.
    const NORMS: [f64; 9] = [
        1.0 / (4.0 * PI), 3.0 / (4.0 * PI), 3.0 / (4.0 * PI), 3.0 / (4.0 * PI), 15.0 / (4.0 * PI), 15.0 / (4.0 * PI),
        5.0 / (16.0 * PI), 15.0 / (4.0 * PI), 15.0 / (16.0 * PI),
    ];
    const SHARES: [f64; 9] = [1.0, 2.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0, 0.25, 0.25, 0.25, 0.25, 0.25];
    let side_of = |level: &Vec<[f32; 3]>| ((level.len() / 6) as f64).sqrt().round() as usize;
    let Some(level) = levels.iter().find(|l| side_of(l) <= 64) else { return [[0.0; 3]; 9] };
    let side = side_of(level);
    let mut sums = [[0.0; 3]; 9];
    let mut whole = 0.0;
    for (texel, (face, (s, t))) in level.iter().zip((0..6).flat_map(|f| places(side).map(move |p| (f, p)))) {
        let d = direction(face, s, t);
        let square = dot(d, d);
        // A pixel far from the face's middle is seen under a smaller angle.
        let angle = 1.0 / (square * square.sqrt());
        whole += angle;
        for (sum, b) in sums.iter_mut().zip(basis(scale(d, 1.0 / square.sqrt()))) {
            *sum = add(*sum, scale(texel.map(f64::from), b * angle));
        }
    }
    let mut all = [[0.0; 3]; 9];
    for ((slot, sum), (norm, share)) in all.iter_mut().zip(sums).zip(NORMS.iter().zip(SHARES)) {
        *slot = scale(sum, norm * share * 4.0 * PI / whole);
    }
    all
}

fn narrow(v: Vec3) -> [f32; 3] {
    v.map(|c| c as f32)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::indexing_slicing)]
mod tests {
    use super::*;

    /// The directions to the middles, edges and corners of a cube.
    fn directions() -> Vec<Vec3> {
        let three = [-1.0, 0.0, 1.0];
        let all = three.iter().flat_map(|&x| three.iter().flat_map(move |&y| three.map(|z| [x, y, z])));
        all.filter_map(unit).collect()
    }

    #[test]
    fn a_place_and_its_direction_agree() {
        assert_eq!(directions().len(), 26);
        for d in directions() {
            let (face, s, t) = place(d);
            let back = unit(direction(face, s, t)).unwrap();
            assert!(dot(back, d) > 1.0 - 1e-12, "{d:?}: {back:?}");
        }
        // The table of the specifications.
        assert_eq!(place([1.0, 0.5, -0.5]), (0, 0.75, 0.25));
        assert_eq!(place([-1.0, 0.5, -0.5]), (1, 0.25, 0.25));
        assert_eq!(place([0.5, 1.0, 0.25]), (2, 0.75, 0.625));
        assert_eq!(place([0.5, -1.0, 0.25]), (3, 0.75, 0.375));
        assert_eq!(place([0.5, 0.25, 1.0]), (4, 0.75, 0.375));
        assert_eq!(place([0.5, 0.25, -1.0]), (5, 0.25, 0.375));
    }

    #[test]
    fn even_light_stays_even() {
        let cube = Cube::of_directions(32, |_| [0.25, 1.0, 4.0]);
        assert_eq!(cube.levels().iter().map(Vec::len).collect::<Vec<_>>(), [6 * 1024, 6 * 256, 6 * 64]);
        for d in directions() {
            for (got, want) in [cube.glossy(d, 0.06), cube.glossy(d, 0.7), cube.glossy(d, 1.0), cube.matte(d)].iter().zip([[0.25, 1.0, 4.0]; 4]) {
                for (got, want) in got.iter().zip(want) {
                    assert!((got - want).abs() < 2e-3 * want, "{d:?}: {got} and not {want}");
                }
            }
        }
    }

    #[test]
    fn matte_surfaces_see_the_mean_by_the_cosine() {
        // Of max(y, 0)-like light 1 + y the mean by the cosine about n is 1 + 2/3 n.y.
        let cube = Cube::of_directions(64, |d| [1.0 + d[1], 1.0 + d[0], 1.0 - d[2]]);
        for d in directions() {
            let want = [1.0 + 2.0 / 3.0 * d[1], 1.0 + 2.0 / 3.0 * d[0], 1.0 - 2.0 / 3.0 * d[2]];
            for (got, want) in cube.matte(d).iter().zip(want) {
                assert!((got - want).abs() < 2e-3, "{d:?}: {got} and not {want}");
            }
        }
        // Of light of the second order, x² - 1/3, a quarter.
        let cube = Cube::of_directions(64, |d| [1.0 + d[0] * d[0] - 1.0 / 3.0; 3]);
        for d in directions() {
            let want = 1.0 + 0.25 * (d[0] * d[0] - 1.0 / 3.0);
            assert!((cube.matte(d)[0] - want).abs() < 2e-3, "{d:?}: {:?} and not {want}", cube.matte(d));
        }
    }

    #[test]
    fn a_rough_mirror_sees_the_lobe_of_its_distribution() {
        // Light 1 + y, mirrored by a lobe about a direction: 1 + c y, c the lobe's mean cosine weighted by the cosine.
        let cube = Cube::of_directions(64, |d| [1.0 + d[1]; 3]);
        for level in 1..cube.levels().len() {
            let roughness = POLISHED + (1.0 - POLISHED) * level as f64 / (cube.levels().len() - 1) as f64;
            let samples = lobe(roughness, 4096);
            let sum: f64 = samples.iter().map(|s| s.toward[2]).sum();
            let want = samples.iter().map(|s| s.toward[2] * s.toward[2]).sum::<f64>() / sum;
            let got = cube.glossy([0.0, 1.0, 0.0], roughness)[0] - 1.0;
            assert!((got - want).abs() < 0.03, "roughness {roughness}: {got} and not {want}");
        }
    }

    #[test]
    fn an_image_of_all_directions_is_turned_as_it_says() {
        // A colour by its direction.
        let (width, height) = (512, 256);
        let texel = |x: usize, y: usize| {
            let (around, down) = (((x as f64 + 0.5) / width as f64 - 0.5) * 2.0 * PI, (y as f64 + 0.5) / height as f64 * PI);
            narrow([around.sin() * down.sin(), down.cos(), -around.cos() * down.sin()].map(|c| 0.5 + 0.5 * c))
        };
        let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| texel(x, y)).collect();
        let cube = Cube::from_equirect(&Bitmap { width, height, texels });
        assert_eq!(cube.side(), 128);
        for d in directions() {
            for (got, want) in cube.sharp(d).iter().zip(d) {
                assert!((got - (0.5 + 0.5 * want)).abs() < 0.01, "{d:?}: {got}");
            }
        }
    }
}
