//! Planes that rays meet apart from everything else, as `sf_ahead` and `sf_planes` of the module do.

use super::march::{Ray, at_points};
use crate::vector::Vec3;
use crate::evaluate::Tape;

/// The distance to the planes that are met apart, and the way to them.
#[derive(Clone, Debug)]
pub struct PlanesApart {
    /// At points.
    pub distance: Tape,
    /// From points in directions, which stand for normals.
    pub way: Tape,
}

impl PlanesApart {
    /// How far along each ray the first of the planes is; infinite where there is no ray.
    pub fn ahead(&self, rays: &[Option<Ray>]) -> Vec<f64> {
        let mut ways = vec![f64::INFINITY; rays.len()];
        let start = |ray: &Option<Ray>| ray.map_or(([0.0; 3], [0.0; 3]), |ray| (ray.at(ray.t_min), ray.direction));
        let (points, directions): (Vec<Vec3>, Vec<Vec3>) = rays.iter().map(start).unzip();
        at_points(&self.way, &points, &directions, |i, values| {
            if let (Some(way), Some(ray), Some(ahead)) = (ways.get_mut(i), rays.get(i).copied().flatten(), values.first()) {
                *way = ray.t_min + ahead;
            }
        });
        ways
    }

    /// How narrowly the planes are passed: the angle, in half-angles of the light, 0 where a ray meets one; and where it does. A plane that is not met
    /// is passed most narrowly at the ray's end. `sharpness`: how sharp the light of a ray is, by the ray's number; `unit`: that of rounding.
    pub fn passages(&self, rays: &[Option<Ray>], unit: f64, sharpness: impl Fn(usize) -> f64) -> Vec<(f64, f64)> {
        let mut passed = vec![(f64::INFINITY, 0.0); rays.len()];
        let ahead = self.ahead(rays);
        let points: Vec<Vec3> = rays.iter().map(|ray| ray.map_or([0.0; 3], |ray| ray.at(ray.t_max))).collect();
        at_points(&self.distance, &points, &[], |i, values| {
            let ray = rays.get(i).copied().flatten();
            if let (Some(passed), Some(ray), Some(height)) = (passed.get_mut(i), ray, values.first()) {
                let met = ahead.get(i).filter(|t| **t <= ray.t_max);
                *passed = met.map_or_else(|| (sharpness(i) * height / ray.t_max.max(1e-6 * unit), 0.0), |t| (0.0, *t));
            }
        });
        passed
    }
}
