//! Silhouettes: pixels of which a pixel's width to the side something else is seen.

use super::pixel::Pixel;
use rayon::prelude::*;
use surefoot_compiler::reference::Reference;
use surefoot_compiler::reference::march::Ray;

/// A ray that comes so near to a surface, in widths of a pixel, and goes away from it again, touches it within a pixel.
const NEAR: f64 = 1.0;
/// What is less than this, in widths of a pixel, is no way away.
const RISE: f64 = 1.0 / 128.0;
/// The shortest step, in widths of a pixel, and how many steps at most.
const STEP: f64 = 0.125;
const STEPS: usize = 4096;

/// Rays that pass a surface within a pixel's width before they meet one, by the distance estimate along them.
pub fn touching(reference: &Reference, rays: &[Ray], pixels: &[Pixel], footprint: f64) -> Vec<bool> {
    let touches = |ray: &Ray, end: f64| {
        let mut evaluator = reference.distance().evaluator();
        let (mut t, mut least) = (ray.t_min.max(1e-9), f64::INFINITY);
        for _ in 0..STEPS {
            if t >= end {
                break;
            }
            let width = footprint * t;
            let mut away = 0.0;
            evaluator.at(&[ray.at(t)], &[], |_, values| away = values[0].abs() / width);
            if least < NEAR && away > least + RISE {
                return true;
            }
            least = least.min(away);
            t += width * (0.9 * away).max(STEP);
        }
        false
    };
    let ends = rays.par_iter().zip(pixels).map(|(ray, pixel)| match pixel {
        Pixel::Hit { t, .. } => touches(ray, *t),
        Pixel::Miss => touches(ray, ray.t_max),
        Pixel::Unknown(_) => false,
    });
    ends.collect()
}

/// Pixels beside one of another kind, or beside a depth that the surface here does not lead to.
pub fn beside(pixels: &[Pixel], size: (u32, u32), footprint: f64) -> Vec<bool> {
    let (width, height) = (size.0 as i64, size.1 as i64);
    let apart = |a: Pixel, b: Pixel| match (a, b) {
        (Pixel::Hit { t, facing, .. }, Pixel::Hit { t: u, facing: other, .. }) => {
            let lean = |facing: f64| (1.0 - facing * facing).max(0.0).sqrt() / facing.max(1e-3);
            // What two planes with these normals differ by over the diagonal of a pixel, and as much again.
            (t - u).abs() > footprint * t.max(u) * (3.0 * (lean(facing) + lean(other)) + 1.0)
        }
        (Pixel::Miss, Pixel::Miss) => false,
        _ => true,
    };
    (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| {
            let at = |x: i64, y: i64| {
                let inside = x >= 0 && y >= 0 && x < width && y < height;
                inside.then(|| pixels[(y * width + x) as usize])
            };
            let Some(own) = at(x, y) else { return false };
            let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
            around.into_iter().any(|(dx, dy)| at(x + dx, y + dy).is_some_and(|other| apart(own, other)))
        })
        .collect()
}
