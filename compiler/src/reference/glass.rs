//! Rays that go through glass: the twin of `compiler/src/shading/glass.wgsl`.

use super::march::{Ray, at_points};
use super::shade::{fresnel, Seen, shadow_offset};
use crate::vector::{Vec3, add, along, dot, scale, sub};
use super::Reference;
use crate::frame::Frame;

/// The direction of a ray beyond a surface whose normal points to where it comes from, by Snell's law; `ratio` is the index before over that
/// beyond. Nothing where all is mirrored.
fn refracted(direction: Vec3, normal: Vec3, ratio: f64) -> Vec3 {
    let cosine = dot(normal, direction);
    let squared = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
    if squared < 0.0 {
        return [0.0; 3];
    }
    sub(scale(direction, ratio), scale(normal, ratio * cosine + squared.sqrt()))
}

fn reflected(direction: Vec3, normal: Vec3) -> Vec3 {
    along(direction, normal, -2.0 * dot(direction, normal))
}

/// A ray in glass, or that has come through it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Through {
    /// Where it goes on.
    pub at: Vec3,
    /// Where to.
    pub direction: Vec3,
    /// How far it has come from the eye.
    pub way: f64,
    /// The share of it that is left.
    pub weight: f64,
    /// How many surfaces it has met inside, and may meet.
    pub met: u32,
    most: u32,
    index: f64,
    /// Whether it is outside again.
    pub out: bool,
}

impl Through {
    /// A ray that comes to glass with an index. At most so many surfaces are met inside.
    pub fn new(seen: &Seen, off: f64, index: f64, most: u32) -> Self {
        let direction = refracted(seen.direction, seen.normal, 1.0 / index);
        Self { at: along(seen.point, seen.normal, -off), direction, way: seen.t, weight: 1.0, met: 0, most, index, out: false }
    }
}

/// Looks of a ray in glass at most.
const LOOKS: u32 = 192;

impl Reference {
    /// How far off a surface rays start that leave it.
    pub fn off(&self, point: Vec3, t: f64, footprint: f64) -> f64 {
        shadow_offset(self.rounded(point, t), t, footprint)
    }

    /// How far it is from places in the solid to where rays leave it, and the normals there. `ways` are how far the places are from the eye.
    fn inside(&self, rays: &[(Vec3, Vec3, f64)], footprint: f64, extent: f64) -> Vec<Option<(f64, Vec3)>> {
        let mut found = vec![None; rays.len()];
        let mut going: Vec<(usize, f64)> = (0..rays.len()).map(|i| (i, 0.0)).collect();
        for look in 1..=LOOKS {
            let at = |(i, t): &(usize, f64)| rays.get(*i).map_or([0.0; 3], |(origin, direction, _)| along(*origin, *direction, *t));
            let points: Vec<Vec3> = going.iter().map(at).collect();
            let mut free = vec![0.0; going.len()];
            at_points(&self.bound, &points, &[], |i, values| {
                if let (Some(slot), Some(bound)) = (free.get_mut(i), values.first()) {
                    *slot = -bound;
                }
            });
            let normals = self.normals(&points, |i| {
                let ray = going.get(i).and_then(|(ray, _)| rays.get(*ray));
                ray.map_or([0.0; 3], |(_, direction, _)| scale(*direction, -1.0))
            });
            let mut next = Vec::new();
            for (((&(i, t), point), free), normal) in going.iter().zip(&points).zip(&free).zip(&normals) {
                let Some((_, direction, way)) = rays.get(i) else { continue };
                let near = 0.25 * self.off(*point, way + t, footprint);
                let go = if *free > near {
                    t + free
                } else if dot(*normal, *direction) > 0.0 {
                    if let Some(slot) = found.get_mut(i) {
                        *slot = Some((t, *normal));
                    }
                    continue;
                } else {
                    t + 2.0 * near
                };
                if look == LOOKS {
                    if let Some(slot) = found.get_mut(i) {
                        *slot = Some((go, *normal));
                    }
                } else if go <= 2.0 * extent {
                    next.push((i, go));
                }
            }
            going = next;
            if going.is_empty() {
                break;
            }
        }
        found
    }

    /// Follows rays through glass until they are out of it, lost, or have met as many surfaces as they may.
    pub(super) fn through(&self, rays: &mut [Through], footprint: f64, extent: f64) {
        loop {
            let going: Vec<usize> = rays.iter().enumerate().filter(|(_, r)| !r.out && r.weight > 0.0 && r.met < r.most).map(|(i, _)| i).collect();
            if going.is_empty() {
                return;
            }
            let starts: Vec<(Vec3, Vec3, f64)> = going.iter().filter_map(|i| rays.get(*i)).map(|r| (r.at, r.direction, r.way)).collect();
            let ends = self.inside(&starts, footprint, extent);
            for (i, end) in going.into_iter().zip(ends) {
                let Some(ray) = rays.get_mut(i) else { continue };
                ray.met += 1;
                let Some((t, outward)) = end else {
                    ray.weight = 0.0;
                    continue;
                };
                let place = along(ray.at, ray.direction, t);
                ray.way += t;
                let mirrored = fresnel(dot(ray.direction, outward), 1.0 / ray.index);
                let off = self.off(place, ray.way, footprint);
                if mirrored < 1.0 {
                    ray.direction = refracted(ray.direction, scale(outward, -1.0), ray.index);
                    ray.at = along(place, outward, off);
                    ray.weight = 1.0 - mirrored;
                    ray.out = true;
                } else {
                    ray.direction = reflected(ray.direction, outward);
                    ray.at = along(place, outward, -off);
                }
            }
        }
    }

    /// How much of a light arrives along rays, with what comes straight through one body of glass. `lit` is without that, `dark` says so of rays
    /// that begin elsewhere.
    pub(super) fn lit_through(&self, rays: &[Ray], lit: Vec<f64>, frame: &Frame, footprint: f64, dark: impl Fn(&[Ray]) -> Vec<f64>) -> Vec<f64> {
        let shaded: Vec<usize> = lit.iter().enumerate().filter(|(_, lit)| **lit < 1.0).map(|(i, _)| i).collect();
        let asked: Vec<Ray> = shaded.iter().filter_map(|i| rays.get(*i)).copied().collect();
        let hits = self.trace(&asked, footprint, frame.extent);
        let met: Vec<(usize, Ray, f64)> =
            shaded.iter().zip(&asked).zip(&hits).filter(|(_, hit)| hit.hit).map(|((i, ray), hit)| (*i, *ray, hit.t)).collect();
        let places: Vec<Vec3> = met.iter().map(|(_, ray, t)| ray.at(*t)).collect();
        let normals = self.normals(&places, |i| met.get(i).map_or([0.0; 3], |(_, ray, _)| ray.direction));
        let seen: Vec<Seen> = met
            .iter()
            .zip(places.iter().zip(&normals))
            .map(|((_, ray, t), (point, normal))| Seen { point: *point, normal: *normal, direction: ray.direction, t: *t })
            .collect();
        let surfaces = self.surfaces(&seen);
        let starts: Vec<(Vec3, Vec3, f64)> =
            seen.iter().map(|s| (along(s.point, s.normal, -self.off(s.point, s.t, footprint)), s.direction, s.t)).collect();
        let ends = self.inside(&starts, footprint, frame.extent);
        let mut beyond = Vec::new();
        let mut of = Vec::new();
        for ((((i, ray, t), seen), surface), (start, end)) in met.iter().zip(&seen).zip(&surfaces).zip(starts.iter().zip(ends)) {
            let Some((inner, outward)) = end.filter(|_| surface.transmission > 0.0) else { continue };
            let place = along(start.0, ray.direction, inner);
            let off = self.off(place, t + inner, footprint);
            beyond.push(Ray { origin: add(place, scale(outward, off)), direction: ray.direction, t_min: off, t_max: ray.t_max - t - inner });
            let passed = 1.0 - fresnel(-dot(ray.direction, seen.normal), surface.ior);
            let tint = surface.color.iter().map(|c| c.clamp(0.0, 1.0)).sum::<f64>() / 3.0;
            of.push((*i, surface.transmission * passed * passed * tint));
        }
        let mut lit = lit;
        for ((i, share), rest) in of.into_iter().zip(dark(&beyond)) {
            if let Some(slot) = lit.get_mut(i) {
                *slot += (1.0 - *slot) * share * rest;
            }
        }
        lit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glass_mirrors_and_bends_as_fresnel_and_snell_say() {
        assert!((fresnel(1.0, 1.5) - 0.04).abs() < 1e-12);
        assert!((fresnel(1.0, 1.0 / 1.5) - 0.04).abs() < 1e-12);
        assert!((fresnel(0.0, 1.5) - 1.0).abs() < 1e-12);
        assert!(fresnel(0.4, 1.0).abs() < 1e-12);
        // At Brewster's angle half of what arrives is mirrored as its other half is not at all.
        let angle = 1.5f64.atan();
        let across = ((angle.cos() - 1.5 * (angle.sin() / 1.5).asin().cos()) / (angle.cos() + 1.5 * (angle.sin() / 1.5).asin().cos())).powi(2);
        assert!((fresnel(angle.cos(), 1.5) - across / 2.0).abs() < 1e-12);
        // From inside all is mirrored beyond 41.8 degrees.
        assert!(fresnel(42f64.to_radians().cos(), 1.0 / 1.5) >= 1.0 && fresnel(41.5f64.to_radians().cos(), 1.0 / 1.5) < 1.0);
        let bent = refracted([0.6, -0.8, 0.0], [0.0, 1.0, 0.0], 1.0 / 1.5);
        assert!((bent[0] - 0.4).abs() < 1e-12 && bent[1] < 0.0 && (dot(bent, bent) - 1.0).abs() < 1e-12);
        assert_eq!(reflected([0.6, -0.8, 0.0], [0.0, 1.0, 0.0]), [0.6, 0.8, 0.0]);
    }
}
