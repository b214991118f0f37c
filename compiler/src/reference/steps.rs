//! The march of one ray as data: each look of the loop that leads all rays ([`Reference::trace`]), in its order.

use super::follow::{Follow, Kind, Turn};
use super::march::{Look, Ray, at_points};
use super::scene::{Hit, Reference};
use crate::vector::Vec3;

/// One look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// How far along the ray.
    pub t: f64,
    /// The point.
    pub point: Vec3,
    /// How far the ray may step there: what it follows, without planes that are met apart.
    pub bound: f64,
    /// The estimate of the distance to the surface of the whole scene.
    pub distance: f64,
    /// What the formulas say there.
    pub field: f64,
    /// How near is near enough there.
    pub tolerance: f64,
    /// How far along the ray the next look is, or the hit.
    pub next: f64,
    /// What the ray does then.
    pub kind: Kind,
}

/// A ray's march.
#[derive(Clone, Debug, PartialEq)]
pub struct March {
    /// The ray, with the part of it that is looked at; none where no part of it can meet anything but a plane.
    pub ray: Option<Ray>,
    /// Each look.
    pub steps: Vec<Step>,
    /// What it met: the same as [`Reference::trace`] says.
    pub hit: Hit,
    /// How far along the ray a plane is that is met apart from all else, where that is what it met.
    pub plane: Option<f64>,
}

impl Reference {
    /// Follows one ray as [`Reference::trace`] does, and tells each of its looks.
    pub fn march_of(&self, ray: &Ray, footprint: f64, extent: f64) -> March {
        let mut steps: Vec<Step> = Vec::new();
        let mut part = None;
        let record = |look: &Look, within: &Ray, tolerance: f64, [before, after]: [&Follow; 2], turn: &Turn, is_spent: bool| {
            part = Some(*within);
            let next = match turn {
                Turn::Hit(t) | Turn::Go(t) => *t,
                Turn::Missed => look.t,
            };
            let kind = Kind::of(before, after, turn, look.free, is_spent);
            steps.push(Step { t: look.t, point: look.point, bound: look.free, distance: 0.0, field: 0.0, tolerance, next, kind });
        };
        let hit = self.traced(std::slice::from_ref(ray), footprint, extent, record).pop().unwrap_or_default();
        let points: Vec<Vec3> = steps.iter().map(|step| step.point).collect();
        at_points(&self.distance, &points, &[], |i, values| {
            if let (Some(step), Some(distance)) = (steps.get_mut(i), values.first()) {
                step.distance = *distance;
            }
        });
        at_points(&self.field, &points, &[], |i, values| {
            if let (Some(step), Some(field)) = (steps.get_mut(i), values.first()) {
                step.field = *field;
            }
        });
        let met = steps.last().is_some_and(|step| step.kind == Kind::Hit);
        March { ray: part, plane: (hit.hit && !met).then_some(hit.t), steps, hit }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::indexing_slicing)]
mod tests {
    use super::*;
    use crate::camera::Basis;
    use crate::random::Random;
    use crate::{MemoryLoader, Options, compile};

    const SCENES: [&str; 3] = [
        "scene = box((1, 3, 1)).twist(y, 2) | sphere(0.7).translate(1.5, 0, 0)\n",
        "scene = smooth_union(torus(1, 0.3), box(0.8), 0.3) - sphere(0.5) | plane(y, -1)\n",
        "field bumps = length(p) - 1 + 0.1 * sin(9 * p.x) * sin(9 * p.y)\nscene = bumps | (for cell in grid((1, 0, 0)) { sphere(0.3) }).translate(0, -1.6, 0)\n",
    ];

    /// All rays of a picture led together, as pixels are, take the very steps that each takes alone.
    #[test]
    fn a_ray_takes_the_steps_that_its_pixel_took() {
        const SIZE: (u32, u32) = (48, 32);
        for text in SCENES {
            let compiled = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default()).compiled.unwrap();
            let live = compiled.live();
            let frame = compiled.frame(&live);
            let camera = frame.cameras[0].1;
            let (basis, reference) = (Basis::of(&camera), Reference::new(&compiled, &live).unwrap());
            let places = (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (f64::from(x) + 0.5, f64::from(y) + 0.5)));
            let ray = |at| Ray { origin: basis.start(camera.eye, at, SIZE), direction: basis.direction(at, SIZE), t_min: 0.0, t_max: frame.max_distance };
            let rays: Vec<Ray> = places.map(ray).collect();
            let footprint = basis.footprint(SIZE.1);
            let mut taken: Vec<Vec<(f64, f64)>> = vec![Vec::new(); rays.len()];
            let hits = reference.traced(&rays, footprint, frame.extent, |look, _, _, _, _, _| taken[look.ray].push((look.t, look.free)));
            let (mut met, mut kinds) = (0, rustc_hash::FxHashSet::default());
            for ((ray, hit), taken) in rays.iter().zip(&hits).zip(&taken) {
                let march = reference.march_of(ray, footprint, frame.extent);
                assert_eq!(march.hit, *hit, "{text}");
                let steps: Vec<(f64, f64)> = march.steps.iter().map(|step| (step.t, step.bound)).collect();
                assert_eq!(steps.len(), hit.steps as usize);
                for (alone, together) in steps.iter().zip(taken) {
                    // Shortened tapes may round otherwise.
                    assert!((alone.0 - together.0).abs() < 1e-9 && (alone.1 - together.1).abs() < 1e-9, "{text}: {alone:?} and {together:?}");
                }
                for pair in march.steps.windows(2) {
                    assert_eq!(pair[0].next, pair[1].t);
                    assert_eq!(pair[1].t < pair[0].t && pair[0].kind != Kind::Closer, pair[0].kind == Kind::Back, "{pair:?}");
                    assert!(pair[0].kind != Kind::Whole || pair[0].next - pair[0].t <= pair[0].bound.max(0.5 * pair[0].tolerance) * (1.0 + 1e-9), "{pair:?}");
                }
                let last = march.steps.last().map(|step| step.kind);
                assert_eq!(hit.hit, last == Some(Kind::Hit) || march.plane.is_some(), "{last:?}");
                kinds.extend(march.steps.iter().map(|step| step.kind.name()));
                met += usize::from(hit.hit);
            }
            assert!(met > 100 && kinds.contains("hit") && kinds.contains("longer") && kinds.contains("end"), "{met} {kinds:?}");
        }
    }

    #[test]
    fn what_a_step_says_is_what_the_formulas_say() {
        let compiled = compile(&MemoryLoader::new().with("main.sdf", SCENES[0]), "main.sdf", &Options::default()).compiled.unwrap();
        let reference = Reference::new(&compiled, &compiled.live()).unwrap();
        let mut random = Random(7);
        for _ in 0..50 {
            let direction = random.direction();
            let ray = Ray { origin: crate::vector::scale(direction, -6.0), direction, t_min: 0.0, t_max: 20.0 };
            let march = reference.march_of(&ray, 1e-3, 100.0);
            for step in &march.steps {
                let at = |tape: &crate::evaluate::Tape| {
                    let mut found = 0.0;
                    tape.evaluator().at(&[step.point], &[], |_, values| found = values[0]);
                    found
                };
                assert_eq!((step.bound, step.field, step.distance), (at(reference.bound()), at(reference.field()), at(reference.distance())));
                assert!(step.bound <= step.distance.abs() * 1.5 + 1.0);
            }
        }
    }
}
