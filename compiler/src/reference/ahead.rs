//! Planes that rays meet apart from everything else, as `sf_ahead` and `sf_planes` of the module do.

use super::march::{Ray, at_points};
use super::vector::Vec3;
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

    /// How much light the planes leave of each ray at most, before its edge is smoothed: as `shadow_past_planes` in `emit/library.rs` says. `lights`: how
    /// far the light is along each ray.
    pub fn shares(&self, rays: &[Option<Ray>], lights: &[f64], softness: &[f64]) -> Vec<f64> {
        let mut shares = vec![f64::INFINITY; rays.len()];
        let ahead = self.ahead(rays);
        let halves: Vec<f64> = rays.iter().zip(lights).map(|(ray, light)| ray.map_or(0.0, |ray| ray.t_max.min(0.5 * light))).collect();
        let points: Vec<Vec3> = rays.iter().zip(&halves).map(|(ray, &half)| ray.map_or([0.0; 3], |ray| ray.at(half))).collect();
        at_points(&self.distance, &points, &[], |i, values| {
            let ray = rays.get(i).copied().flatten();
            if let (Some(share), Some(ray), Some(height)) = (shares.get_mut(i), ray, values.first()) {
                if ahead.get(i).is_some_and(|t| *t <= ray.t_max) {
                    *share = 0.0;
                } else if let Some(softness) = softness.get(i).filter(|softness| **softness > 0.0) {
                    *share = softness * height / halves.get(i).map_or(1e-6, |half| half.max(1e-6));
                }
            }
        });
        shares
    }
}
