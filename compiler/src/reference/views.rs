//! Views that show no light but what it, or a ray, goes by: the twins of `runtime/src/passes/scene/view_*.wgsl`.

use super::march::{Ray, at_points};
use super::scene::Reference;
use super::shade::{self, Seen, Shading};
use crate::frame::Frame;
use crate::vector::{Vec3, along, dot, length, mix, sub};

/// So many widths of a pixel above the surface it is asked what of the distance a ray may go.
const ABOVE: f64 = 4.0;

impl Reference {
    /// The values of a formula at points.
    pub(super) fn values(&self, tape: &crate::evaluate::Tape, points: &[Vec3]) -> Vec<f64> {
        let mut found = vec![0.0; points.len()];
        at_points(tape, points, &[], |i, values| {
            if let (Some(slot), Some(value)) = (found.get_mut(i), values.first()) {
                *slot = *value;
            }
        });
        found
    }

    /// How steep the field is at places, as colours.
    pub(super) fn steepness(&self, places: &[Seen]) -> Vec<Vec3> {
        let points: Vec<Vec3> = places.iter().map(|seen| seen.point).collect();
        self.gradients(&points).into_iter().map(|gradient| shade::gradient_color(length(gradient))).collect()
    }

    /// What of the distance a ray may go right above places, as colours.
    pub(super) fn parts_of_distance(&self, places: &[Seen], footprint: f64) -> Vec<Vec3> {
        let high = |seen: &Seen| ABOVE * footprint * seen.t;
        let points: Vec<Vec3> = places.iter().map(|seen| along(seen.point, seen.normal, high(seen))).collect();
        let (bounds, distances) = (self.values(&self.bound, &points), self.values(&self.distance, &points));
        let part = |((seen, bound), distance): ((&Seen, f64), f64)| {
            let high = high(seen);
            shade::factor_color(bound.abs() / high.min(distance.abs()).max(1e-3 * high))
        };
        places.iter().zip(bounds).zip(distances).map(part).collect()
    }

    /// How much arrives at places of the lights that shine on their fronts, as colours.
    pub(super) fn lights_arriving(&self, frame: &Frame, shading: &Shading, places: &[Seen], footprint: f64) -> Vec<Vec3> {
        let mut sums = vec![(0.0, 0.0); places.len()];
        for lamp in &shading.lamps {
            let (rays, of) = self.rays_to(shading, lamp, places, footprint);
            let shares = if lamp.softness >= 0.0 { self.lit(lamp, shading.part, &rays, frame.extent) } else { vec![1.0; rays.len()] };
            for (i, share) in of.into_iter().zip(shares) {
                if let Some((sum, count)) = sums.get_mut(i) {
                    *sum += share;
                    *count += 1.0;
                }
            }
        }
        sums.into_iter().map(|(sum, count)| if count > 0.0 { [sum / count; 3] } else { shade::UNLIT }).collect()
    }

    /// Pixels of a plane through the field, square to an axis; nothing is before it.
    pub(super) fn sliced(&self, frame: &Frame, axis: u8, spacing: f64, rays: &[Ray], footprint: f64) -> Vec<[f32; 4]> {
        let axis = usize::from(axis.min(2));
        let of = |v: Vec3| v.get(axis).copied().unwrap_or(0.0);
        let plane = |ray: &Ray| {
            let ahead = of(ray.direction);
            let t = if ahead.abs() < 1e-6 { -1.0 } else { (frame.slice - of(ray.origin)) / ahead };
            (t > 0.0 && t < ray.t_max && length(ray.at(t)) < frame.extent).then_some(t)
        };
        let planes: Vec<Option<f64>> = rays.iter().map(plane).collect();
        let cut: Vec<Ray> = rays.iter().zip(&planes).map(|(ray, plane)| Ray { t_min: plane.unwrap_or(ray.t_min), ..*ray }).collect();
        let hits = self.trace(&cut, footprint, frame.extent);
        let mut behind = vec![shade::NOTHING; rays.len()];
        let met = super::numbered(&cut, &hits);
        for (seen, (i, ..)) in self.places(&met).iter().zip(&met) {
            if let Some(slot) = behind.get_mut(*i) {
                *slot = [0.25 + 0.55 * (-dot(seen.normal, seen.direction)).clamp(0.0, 1.0); 3];
            }
        }
        let points: Vec<Vec3> = rays.iter().zip(&planes).map(|(ray, plane)| ray.at(plane.unwrap_or(0.0))).collect();
        let (values, gradients) = (self.values(&self.field, &points), self.gradients(&points));
        let square: Vec3 = std::array::from_fn(|i| f64::from(u8::from(i == axis)));
        let pixel = |i: usize| {
            let behind = behind.get(i).copied().unwrap_or(shade::NOTHING);
            let hit = hits.get(i).copied().unwrap_or_default();
            let (Some(t), Some(value), Some(gradient), Some(point)) = (planes.get(i).copied().flatten(), values.get(i), gradients.get(i), points.get(i)) else {
                return (behind, if hit.hit { hit.t } else { -1.0 });
            };
            let slope = length(sub(*gradient, square.map(|c| c * of(*gradient)))) * footprint * t;
            let across = point.iter().sum::<f64>() - of(*point);
            let color = shade::isolines_color(*value, slope, spacing, across);
            (mix(behind, color, if *value < 0.0 { 1.0 } else { 0.55 }), t)
        };
        (0..rays.len()).map(pixel).map(|([r, g, b], t)| [r as f32, g as f32, b as f32, t as f32]).collect()
    }
}
