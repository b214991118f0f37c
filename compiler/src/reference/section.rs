//! What a picture shows of a scene that a section cuts open: the twin of `runtime/src/passes/section/*.wgsl`.

use super::march::Ray;
use super::scene::{Reference, View};
use super::shade::{self, Seen, Shading};
use crate::section::Plane;
use crate::vector::{Vec3, length, scale};

/// The colour of what is cut, where the view shows no light, normals or depths.
const FACE: Vec3 = [0.62, 0.62, 0.66];
/// What of it is in its darker stripes.
const STRIPE: f64 = 0.7;

/// Rays of a picture that is cut open.
pub(super) struct Opened {
    /// What of the rays is on the side that stays.
    pub rays: Vec<Ray>,
    /// Where rays begin in the solid, with their numbers: there they meet the plane itself.
    pub faces: Vec<(usize, Seen)>,
}

impl Reference {
    /// Cuts rays off at a plane. Those that begin in the solid there have nothing more to meet.
    pub(super) fn opened(&self, plane: &Plane, rays: &[Ray], extent: f64) -> Opened {
        let kept = |ray: &Ray| {
            let [t_min, t_max] = plane.span(ray.origin, ray.direction, [ray.t_min, ray.t_max]);
            Ray { t_min, t_max, ..*ray }
        };
        let mut kept: Vec<Ray> = rays.iter().map(kept).collect();
        let points: Vec<Vec3> = kept.iter().map(|ray| ray.at(ray.t_min)).collect();
        let values = self.values(&self.field, &points);
        let mut faces = Vec::new();
        for (i, ((ray, point), value)) in kept.iter_mut().zip(&points).zip(&values).enumerate() {
            let begins_there = ray.t_min > 0.0 && ray.t_min <= ray.t_max;
            if begins_there && *value < 0.0 && length(*point) < extent {
                faces.push((i, Seen { point: *point, normal: plane.normal, direction: ray.direction, t: ray.t_min }));
                ray.t_max = -1.0;
            }
        }
        Opened { rays: kept, faces }
    }

    /// What is seen of what is cut: light, exposed, where the view shows light, else colours.
    pub(super) fn cut_faces(&self, plane: &Plane, shading: &Shading, view: View, faces: &[(usize, Seen)]) -> Vec<Vec3> {
        let seen: Vec<Seen> = faces.iter().map(|(_, seen)| *seen).collect();
        let striped = |seen: &Seen, color: Vec3| {
            let dark = plane.is_striped(seen.point, shading.spacing / 5.0);
            scale(color, if dark { STRIPE } else { 1.0 })
        };
        match view {
            View::Shaded => {
                let surfaces = self.surfaces(&seen);
                seen.iter().zip(surfaces).map(|(seen, surface)| striped(seen, surface.color.map(|c| 0.25 + 0.5 * c))).collect()
            }
            View::Normals => seen.iter().map(|seen| shade::normal_color(seen.normal)).collect(),
            View::Depth => seen.iter().map(|seen| shade::depth_color(seen.t, shading.max_distance)).collect(),
            _ => seen.iter().map(|seen| striped(seen, FACE)).collect(),
        }
    }
}
