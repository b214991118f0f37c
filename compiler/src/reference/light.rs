//! Light on its way: from surface to surface, and from lamps to surfaces. The twin of `compiler/src/shading/reflections.wgsl` and
//! `glass.wgsl`.

use super::glass::Through;
use super::area::{Part, toward};
use super::march::{Ray, at_points};
use super::shade::{self, fresnel, Lamp, Leaving, Seen, Shading, SurfaceValues};
use crate::vector::{Vec3, add, along, dot, mul, scale, sub};
use super::{Reference, numbered};
use crate::frame::Frame;

impl Reference {
    /// The light of places, exposed: what leaves them, with what they mirror.
    pub(super) fn light(&self, frame: &Frame, shading: &Shading, places: &[Seen], footprint: f64) -> Vec<Vec3> {
        let mut lights = vec![[0.0; 3]; places.len()];
        // Of each ray that is still followed: its pixel, how much of what it meets arrives, what it met, and how many surfaces before.
        let mut met: Vec<(usize, Vec3, Seen, u32)> = places.iter().enumerate().map(|(i, seen)| (i, [1.0; 3], *seen, 0)).collect();
        while !met.is_empty() {
            let mut rays: Vec<Ray> = Vec::new();
            let mut of: Vec<(usize, Vec3, f64, f64, u32)> = Vec::new();
            let mut inside: Vec<Through> = Vec::new();
            let mut of_inside: Vec<(usize, Vec3, Vec3, f64, u32)> = Vec::new();
            let plain: Vec<Seen> = met.iter().map(|(_, _, seen, _)| *seen).collect();
            let (seen, surfaces) = self.dressed(&plain, footprint);
            let leaving = self.leaving(frame, shading, &seen, &surfaces, footprint);
            for (((pixel, weight, _, used), (seen, surface)), leaving) in met.iter().zip(seen.iter().zip(&surfaces)).zip(leaving) {
                let Some(light) = lights.get_mut(*pixel) else { continue };
                // What the eye itself sees is lost below.
                let lost = if *used == 0 { 0.0 } else { shading.lost(seen) };
                *light = add(*light, mul(scale(*weight, lost), shading.sky(seen.direction)));
                let weight = scale(*weight, 1.0 - lost);
                let share = mul(weight, leaving.share);
                let (more, clear) = (*used < frame.reflections, surface.transmission > 0.0);
                let followed = if more && !clear { shade::followed(leaving.roughness, share) } else { 0.0 };
                let rest = scale(share, (1.0 - followed) * leaving.occlusion);
                let mirror = shading.fogged(shading.mirror(leaving.mirror, leaving.roughness), shading.max_distance - seen.t);
                let mirrored = mul(rest, mirror);
                *light = add(*light, add(mul(weight, leaving.light), mirrored));
                let off = self.off(seen.point, seen.t, footprint);
                if clear {
                    let tint = surface.color.map(|c| c.clamp(0.0, 1.0));
                    let passed = surface.transmission * (1.0 - fresnel(-dot(seen.direction, seen.normal), surface.ior));
                    inside.push(Through::new(seen, off, surface.ior, frame.reflections.saturating_sub(*used)));
                    of_inside.push((*pixel, mul(scale(weight, passed), tint), tint, leaving.roughness, *used));
                } else if followed > 0.0 {
                    // As if the ray came straight from the eye: pixels grow with the whole way.
                    let start = add(seen.point, scale(seen.normal, off));
                    let origin = sub(start, scale(leaving.mirror, seen.t));
                    let (t_min, t_max) = (seen.t + off, frame.max_distance);
                    rays.push(Ray { origin, direction: leaving.mirror, t_min, t_max });
                    of.push((*pixel, scale(share, followed), leaving.roughness, seen.t, used + 1));
                }
            }
            self.through(&mut inside, footprint, frame.extent);
            for (ray, (pixel, weight, tint, roughness, used)) in inside.into_iter().zip(of_inside) {
                let weight = scale(weight, ray.weight);
                if ray.out {
                    let origin = along(ray.at, ray.direction, -ray.way);
                    rays.push(Ray { origin, direction: ray.direction, t_min: ray.way, t_max: frame.max_distance });
                    of.push((pixel, mul(weight, tint), roughness, ray.way, used + 1 + ray.met));
                } else if let Some(light) = lights.get_mut(pixel) {
                    let seen = shading.fogged(shading.mirror(ray.direction, roughness), shading.max_distance - ray.way);
                    *light = add(*light, mul(weight, seen));
                }
            }
            let hits = self.trace(&rays, footprint, frame.extent);
            met.clear();
            let mut places = self.places(&numbered(&rays, &hits)).into_iter();
            for ((&(pixel, weight, roughness, way, used), ray), hit) in of.iter().zip(&rays).zip(&hits) {
                let Some(light) = lights.get_mut(pixel) else { continue };
                if hit.hit {
                    // The fog on the way from one surface to the next.
                    *light = add(*light, mul(weight, shading.fogged([0.0; 3], hit.t - way)));
                    let weight = scale(weight, shading.fog.map_or(1.0, |fog| fog.clear(hit.t - way)));
                    met.extend(places.next().map(|seen| (pixel, weight, seen, used)));
                } else {
                    let beyond = shading.fogged(shading.beyond(ray.direction, roughness), shading.max_distance - way);
                    *light = add(*light, mul(weight, beyond));
                }
            }
        }
        lights.iter().zip(places).map(|(light, seen)| shading.exposed(shading.haze(*light, seen))).collect()
    }

    /// What leaves places toward where they are seen from.
    fn leaving(&self, frame: &Frame, shading: &Shading, places: &[Seen], surfaces: &[SurfaceValues], footprint: f64) -> Vec<Leaving> {
        let (reach, strength) = frame.ambient_occlusion;
        let occlusion = self.occlusion(places, reach, strength);
        let mut lit = vec![vec![1.0; shading.lamps.len()]; places.len()];
        for (which, lamp) in shading.lamps.iter().enumerate().filter(|(_, l)| l.softness >= 0.0) {
            let (rays, of) = self.rays_to(shading, lamp, places, footprint);
            let dark = |rays: &[Ray]| self.lit(lamp, shading.part, rays, frame.extent);
            let mut shares = dark(&rays);
            if self.glass.is_some() {
                shares = self.lit_through(&rays, shares, frame, footprint, dark);
            }
            for (i, share) in of.into_iter().zip(shares) {
                if let Some(slot) = lit.get_mut(i).and_then(|l| l.get_mut(which)) {
                    *slot = share;
                }
            }
        }
        let all = places.iter().zip(surfaces).zip(occlusion.iter().zip(&lit));
        all.map(|((seen, surface), (&occlusion, lit))| shading.leaving(seen, surface, occlusion, lit)).collect()
    }

    /// Rays to a lamp's middle from the places on whose fronts it shines, with the numbers of those.
    pub(super) fn rays_to(&self, shading: &Shading, lamp: &Lamp, places: &[Seen], footprint: f64) -> (Vec<Ray>, Vec<usize>) {
        let ray = |(i, seen): (usize, &Seen)| {
            let arriving = shading.arriving(lamp, seen.point, seen.normal)?;
            let off = self.off(seen.point, seen.t, footprint);
            let origin = add(seen.point, scale(seen.normal, off));
            Some((Ray { origin, direction: arriving.direction, t_min: off, t_max: arriving.far }, i))
        };
        places.iter().enumerate().filter_map(ray).unzip()
    }

    /// How much of a lamp is seen along rays to its middle, of which `t_min` is how far they start from a surface: of all of its disc, or of what a
    /// picture of a film looks at.
    pub fn lit(&self, lamp: &Lamp, part: Part, rays: &[Ray], extent: f64) -> Vec<f64> {
        let softness: Vec<f64> = rays.iter().map(|ray| lamp.softness_from(ray.t_max)).collect();
        let aimed = |(ray, &softness): (&Ray, &f64)| {
            let before = if softness > 0.0 && part.narrower > 0.0 { 1.25 * ray.t_max / softness } else { ray.t_min };
            let end = self.end(lamp, ray, before);
            let (tangent, [x, y]) = if softness > 0.0 { (1.0 / softness, part.place) } else { (0.0, [0.0; 2]) };
            let t_max = end * (1.0 + tangent * tangent * (x * x + y * y)).sqrt();
            Ray { direction: toward(ray.direction, tangent, [x, y]), t_max, ..*ray }
        };
        let aimed: Vec<Ray> = rays.iter().zip(&softness).map(aimed).collect();
        let softness: Vec<f64> = softness.into_iter().map(|softness| softness * part.narrower).collect();
        self.shadows(&aimed, &softness, extent)
    }

    /// Where a shadow's ray ends: at the lamp, or so far before the solid in which it stands if that emits light: it throws no shadow of its own.
    pub fn end(&self, lamp: &Lamp, ray: &Ray, before: f64) -> f64 {
        let (direction, far) = (ray.direction, ray.t_max);
        let mut out = 0.0;
        for _ in 0..if lamp.position { 64 } else { 0 } {
            let mut inside = 0.0;
            at_points(&self.bound, &[along(lamp.vector, direction, -out)], &[], |_, values| inside = -values.first().copied().unwrap_or(0.0));
            if inside <= 1e-4 * out {
                break;
            }
            out += inside;
        }
        if out <= 0.0 {
            return far;
        }
        let lamp = Seen { point: lamp.vector, normal: direction, direction, t: 0.0 };
        let emits = self.surfaces(&[lamp]).iter().any(|surface| surface.emission.iter().any(|c| *c > 0.0));
        if emits { far - out - before } else { far }
    }
}
