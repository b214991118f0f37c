//! What is certain of each pixel, and how far a tracer's answer is from it.

use super::pixel::{Doubt, Pixel};
use super::silhouette;
use rayon::prelude::*;
use surefoot_compiler::certify::{Hit, Truth};
use surefoot_compiler::compiled::{Camera, Compiled, Frame, Live};
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::reference::{self, Reference};
use surefoot_compiler::camera::Basis;
use surefoot_compiler::reference::march::Ray;
use surefoot_compiler::vector::{Vec3, along, dot, length};
use surefoot_runtime::passes::rays::{FUNCTIONS, GpuRay, RayPicture, Traced, counted_from};

/// Boxes that one ray may cost.
pub const BOXES: usize = 20_000;
/// Normals are those of so far before the surface, times the way: on it a formula may have a kink, a box's for one, and no slope.
const OUTSIDE: f64 = 1e-9;
/// Places between a camera and its target where it may stand.
const NEARER: u32 = 32;
/// So many wrong pixels of a method are remembered.
pub const MOST_WRONG: usize = 64;
/// Operations of the field at most.
const LIMIT: usize = 2_000_000;

/// A pixel of which the truth is not known.
#[derive(Clone, Copy, Debug)]
pub struct Unknown {
    /// Number of the view, from 0.
    pub view: usize,
    /// Column and row, from 0, at the upper left.
    pub at: (u32, u32),
    /// What is not known.
    pub doubt: Doubt,
}

/// A pixel that a tracer shows wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrong {
    /// Number of the view, from 0.
    pub view: usize,
    /// Column and row, from 0, at the upper left.
    pub at: (u32, u32),
    /// In which way.
    pub what: &'static str,
    /// How far along the ray it meets the surface; infinite where it meets none.
    pub truth: f64,
    /// Where the tracer ended.
    pub answered: f64,
}

/// What a tracer answers.
#[derive(Clone, Copy, Debug)]
pub struct Answer {
    /// Where it ended.
    pub t: f64,
    /// Whether it met the surface.
    pub hit: bool,
    /// How often it looked.
    pub steps: u32,
    /// How often it evaluated field, bound and distance, where that was counted.
    pub looks: [u32; FUNCTIONS.len()],
}

impl From<&Traced> for Answer {
    fn from(a: &Traced) -> Self {
        Self { t: f64::from(a.t), hit: a.hit == 1, steps: a.steps, looks: a.looks }
    }
}

impl From<&reference::Hit> for Answer {
    fn from(a: &reference::Hit) -> Self {
        Self { t: a.t, hit: a.hit, steps: a.steps, looks: [0; FUNCTIONS.len()] }
    }
}

/// The rays of one view and what is certain of them.
pub struct View {
    /// For the GPU.
    pub picture: RayPicture,
    /// The same in 64 bits.
    pub rays: Vec<Ray>,
    pixels: Vec<Pixel>,
    /// Whether the surface ends, or nearly does, within a pixel, or the ray nearly touches it on its way.
    pub silhouette: Vec<bool>,
}

/// Errors of one method at one view, or of several added up.
#[derive(Clone, Debug, Default)]
pub struct Errors {
    /// Pixels of which the truth is known, and which are no silhouette.
    pub judged: usize,
    /// Pixels of which it is not known.
    pub unknown: usize,
    /// Silhouettes.
    pub silhouettes: usize,
    /// Truth hits, the ray does not.
    pub missed: usize,
    /// Truth misses, the ray hits.
    pub false_hits: usize,
    /// Hits that lie deeper in the solid than half a pixel is wide there.
    pub inside: usize,
    /// Where the first [`MOST_WRONG`] of these three are.
    pub wrong: Vec<Wrong>,
    /// Silhouettes at which hit and miss are the other way round.
    pub silhouettes_apart: usize,
    /// |t - t*| over the width of a pixel there, of all hits.
    pub depth: Vec<f64>,
    /// How far from the surface that is: the same times the cosine between ray and normal, or the field over its gradient where that is less.
    pub off: Vec<f64>,
    /// Angle between the normals, degrees.
    pub normal: Vec<f64>,
    /// Steps, and looks at each of [`FUNCTIONS`], of all rays.
    pub steps: u64,
    /// How often field, bound and distance were evaluated.
    pub looks: [u64; FUNCTIONS.len()],
    /// Number of rays.
    pub rays: usize,
    /// Number of views.
    pub views: usize,
}

/// Cameras around what the scene's own camera looks at: the first is that camera. One that would stand in a solid, behind a wall perhaps,
/// comes so much nearer that it does not; where it would have to come all the way there is no such view.
pub fn cameras(frame: &Frame, field: &Tape, count: u32) -> Vec<Camera> {
    let Some((_, own)) = frame.cameras.first() else { return Vec::new() };
    (0..count)
        .filter_map(|i| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(count)).sin_cos();
            let from: Vec3 = std::array::from_fn(|a| own.eye[a] - own.target[a]);
            let turned = [cos * from[0] + sin * from[2], from[1], cos * from[2] - sin * from[0]];
            let places: Vec<Vec3> = (0..NEARER).map(|n| along(own.target, turned, 1.0 - f64::from(n) / f64::from(NEARER))).collect();
            let mut outside = None;
            field.evaluator().at(&places, &[], |n, values| {
                if values[0] > 0.0 && outside.is_none_or(|found| n < found) {
                    outside = Some(n);
                }
            });
            Some(Camera { eye: places[outside?], ..*own })
        })
        .collect()
}

impl View {
    /// The rays of a camera's picture, and the truth of each, which may cost so many boxes.
    pub fn new(
        scene: &Compiled,
        live: &Live,
        camera: &Camera,
        size: (u32, u32),
        boxes: usize,
        progress: &(dyn Fn() + Sync),
    ) -> Result<Self, String> {
        let basis = Basis::of(camera);
        let places = (0..size.1).flat_map(|y| (0..size.0).map(move |x| (f64::from(x) + 0.5, f64::from(y) + 0.5)));
        let aimed: Vec<(Vec3, Vec3)> = places.map(|at| (basis.start(camera.eye, at, size), basis.direction(at, size))).collect();
        let mut view = Self::aimed(scene, live, &aimed, size, basis.footprint(size.1), boxes, progress)?;
        let reference = Reference::new(scene, live).map_err(|e| e.to_string())?;
        let footprint = basis.footprint(size.1);
        let beside = silhouette::beside(&view.pixels, size, footprint);
        let touching = silhouette::touching(&reference, &view.rays, &view.pixels, footprint);
        view.silhouette = beside.into_iter().zip(touching).map(|(a, b)| a || b).collect();
        Ok(view)
    }

    /// Rays that are no picture's, each from a point in a direction, and the truth of each. None of them is a silhouette.
    pub fn aimed(
        scene: &Compiled,
        live: &Live,
        aimed: &[(Vec3, Vec3)],
        size: (u32, u32),
        footprint: f64,
        boxes: usize,
        progress: &(dyn Fn() + Sync),
    ) -> Result<Self, String> {
        let frame = scene.frame(live);
        // The truth is that of the rays that the GPU gets, and it gets them as the picture does: from the eye on, where that can be.
        let origin = aimed.first().map_or([0.0; 3], |(eye, _)| counted_from(scene, *eye));
        let gpu: Vec<GpuRay> = aimed.iter().map(|(from, direction)| GpuRay::narrowed(*from, *direction, origin, frame.max_distance)).collect();
        let rays: Vec<Ray> = gpu.iter().map(|ray| ray.widened(origin)).collect();
        let truth = Truth::new(scene, live, LIMIT).map_err(|e| e.to_string())?;
        let found: Vec<Hit> = rays
            .par_iter()
            .map_init(
                || truth.prover(),
                |prover, ray| {
                    progress();
                    let Some(ray) = ray.clip(frame.extent) else { return Hit::Miss };
                    prover.first_hit(ray.origin, ray.direction, ray.t_min, ray.t_max, boxes)
                },
            )
            .collect();
        let reference = Reference::new(scene, live).map_err(|e| e.to_string())?;
        let points: Vec<Vec3> =
            rays.iter().zip(&found).map(|(ray, hit)| ray.at(if let Hit::Hit(t) = hit { t - OUTSIDE * t.max(1.0) } else { 0.0 })).collect();
        let normals = unit_all(reference.gradients(&points));
        let pixels: Vec<Pixel> = found
            .iter()
            .zip(&rays)
            .zip(normals)
            .map(|((hit, ray), normal)| match *hit {
                Hit::Hit(t) => Pixel::Hit { t, facing: dot(ray.direction, normal).abs(), normal },
                Hit::Miss => Pixel::Miss,
                Hit::Ambiguous(t) => Pixel::Unknown(Doubt { t, why: "ambiguous" }),
                Hit::Exhausted(t) => Pixel::Unknown(Doubt { t, why: "too costly" }),
            })
            .collect();
        let silhouette = vec![false; pixels.len()];
        let picture = RayPicture { size, rays: gpu, origin, footprint: footprint as f32 };
        Ok(Self { picture, rays, pixels, silhouette })
    }

    /// The pixels of which the truth is not known, row by row. `view`: the number of this view.
    pub fn unknown(&self, view: usize) -> impl Iterator<Item = Unknown> {
        self.pixels.iter().enumerate().filter_map(move |(i, pixel)| match *pixel {
            Pixel::Unknown(doubt) => Some(Unknown { view, at: self.place(i), doubt }),
            _ => None,
        })
    }

    /// Column and row of a ray by its number.
    fn place(&self, ray: usize) -> (u32, u32) {
        let (ray, width) = (ray as u32, self.picture.size.0.max(1));
        (ray % width, ray / width)
    }

    /// Judges what a tracer answered.
    pub fn judge(&self, reference: &Reference, answers: &[Answer], errors: &mut Errors) {
        let footprint = f64::from(self.picture.footprint);
        let points: Vec<Vec3> = self.rays.iter().zip(answers).map(|(ray, a)| ray.at(a.t)).collect();
        let gradients = reference.gradients(&points);
        let mut fields = vec![0.0; points.len()];
        reference.field().evaluator().at(&points, &[], |i, values| fields[i] = values[0]);
        let from: Vec<f64> = fields.iter().zip(&gradients).map(|(f, g)| f.abs() / length(*g).max(1e-30)).collect();
        let normals = unit_all(gradients);
        errors.rays += answers.len();
        for (i, answer) in answers.iter().enumerate() {
            errors.steps += u64::from(answer.steps);
            for (sum, looks) in errors.looks.iter_mut().zip(answer.looks) {
                *sum += u64::from(looks);
            }
            let hit = answer.hit;
            let wrong = |what, truth| Wrong { view: errors.views, at: self.place(i), what, truth, answered: answer.t };
            let mut found = None;
            match self.pixels[i] {
                Pixel::Unknown(_) => errors.unknown += 1,
                pixel if self.silhouette[i] => {
                    errors.silhouettes += 1;
                    errors.silhouettes_apart += usize::from(hit != matches!(pixel, Pixel::Hit { .. }));
                }
                Pixel::Miss => {
                    errors.judged += 1;
                    errors.false_hits += usize::from(hit);
                    found = hit.then(|| wrong("false", f64::INFINITY));
                }
                Pixel::Hit { t, facing, normal } => {
                    errors.judged += 1;
                    let width = footprint * t;
                    let ahead = answer.t - t;
                    let inside = hit && ahead * facing > 0.5 * width;
                    errors.missed += usize::from(!hit);
                    errors.inside += usize::from(inside);
                    found = if inside { Some(wrong("inside", t)) } else { (!hit).then(|| wrong("missed", t)) };
                    if hit {
                        errors.depth.push(ahead.abs() / width);
                        errors.off.push((ahead.abs() * facing).min(from[i]) / width);
                        errors.normal.push(dot(normals[i], normal).clamp(-1.0, 1.0).acos().to_degrees());
                    }
                }
            }
            errors.wrong.extend(found.filter(|_| errors.wrong.len() < MOST_WRONG));
        }
        errors.views += 1;
    }
}

impl Errors {
    /// The value that so many of a hundred do not exceed; 0 where there is none.
    pub fn percentile(values: &[f64], percent: f64) -> f64 {
        let mut sorted = values.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        let rank = (percent / 100.0 * sorted.len() as f64).ceil().max(1.0) as usize;
        sorted.get(rank - 1).copied().unwrap_or(0.0)
    }
}

fn unit_all(vectors: Vec<Vec3>) -> Vec<Vec3> {
    vectors
        .into_iter()
        .map(|v| {
            let size = length(v).max(1e-30);
            v.map(|c| c / size)
        })
        .collect()
}
