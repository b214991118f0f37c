//! What rays find without a search: planes that a scene is the union of, and the box about everything else. They change nothing of what is seen.

use surefoot_compiler::functions::Ahead;
use surefoot_compiler::reference::Reference;
use surefoot_compiler::reference::area::{on_disc, toward};
use surefoot_compiler::reference::march::Ray;
use surefoot_compiler::skipped::skipped;
use surefoot_compiler::{Compiled, Export, MemoryLoader, Options, compile};

fn scene(text: &str) -> Compiled {
    let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
    outcome.compiled.unwrap_or_else(|| panic!("{text}: {:?}", outcome.diagnostics))
}

/// The same scene of which nothing is known ahead.
fn searched(scene: &Compiled) -> Reference {
    let mut plain = scene.clone();
    plain.functions.ahead = Ahead::default();
    Reference::new(&plain, &plain.live()).unwrap()
}

/// A ball on a floor before a leaning wall.
const ROOM: &str = "\
param lean = 20deg in 0deg..45deg
scene = plane(y) | plane(z, -3).rotate(x, lean) | sphere(1).translate(0, 1, 0) | plane(x + 2 * y, -30)
render { extent: 100 }
";

/// Rays from places above the floor, most of them down.
fn rays() -> Vec<Ray> {
    let mut state = 1u32;
    let mut random = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1u32 << 24)
    };
    let ray = |_| {
        let (u, turn) = (1.2 * random() - 1.0, std::f64::consts::TAU * random());
        let across = (1.0 - u * u).sqrt();
        let origin = [6.0 * random() - 3.0, 2.5 + 2.0 * random(), 1.5 + 4.0 * random()];
        Ray { origin, direction: [across * turn.cos(), u, across * turn.sin()], t_min: 0.0, t_max: 1000.0 }
    };
    (0..20_000).map(ray).collect()
}

#[test]
fn rays_meet_planes_where_their_formulas_say_and_the_rest_as_before() {
    let scene = scene(ROOM);
    assert!(scene.functions.ahead.planes.is_some() && scene.functions.ahead.region.is_some());
    let rays = rays();
    let apart = Reference::new(&scene, &scene.live()).unwrap().trace(&rays, 1e-3, 100.0);
    let whole = searched(&scene).trace(&rays, 1e-3, 100.0);
    let lean = 20f64.to_radians();
    let (mut flat, mut looks) = (0, [0u64; 2]);
    for (i, (ray, (a, b))) in rays.iter().zip(apart.iter().zip(&whole)).enumerate() {
        looks[0] += u64::from(a.steps);
        looks[1] += u64::from(b.steps);
        let at = ray.at(a.t);
        let ball = (at[0].powi(2) + (at[1] - 1.0).powi(2) + at[2].powi(2)).sqrt() - 1.0;
        let wall = at[2] * lean.cos() - at[1] * lean.sin() + 3.0;
        let third = (at[0] + 2.0 * at[1] + 30.0) / 5f64.sqrt();
        // A ray all but level with a plane meets it a little earlier where it is searched for.
        if a.hit != b.hit {
            assert!(a.hit || !a.hit && at[1].abs() < 0.01, "{i}: {ray:?} {a:?} {b:?}");
            continue;
        }
        if !a.hit {
            continue;
        }
        let plane = at[1].min(wall).min(third);
        if ball.abs() > 1e-4 {
            flat += 1;
            // The numbers of the wall are rounded to 32 bits.
            assert!(plane.abs() < 1e-6, "{i}: {ray:?} {a:?}: {plane}");
        }
        assert!((a.t - b.t).abs() < 0.01 * (1.0 + a.t), "{i}: {ray:?} {a:?} {b:?}");
    }
    assert!(flat > 10_000, "{flat}");
    assert!(4 * looks[0] < looks[1], "{looks:?}");
}

#[test]
fn shadows_of_planes_are_nearer_to_the_truth_than_searched_ones() {
    let scene = scene(ROOM);
    let (apart, whole) = (Reference::new(&scene, &scene.live()).unwrap(), searched(&scene));
    let rays: Vec<Ray> = (0..2_000)
        .map(|i| {
            let origin = [f64::from(i % 50) * 0.12 - 3.0, 1e-3, f64::from(i / 50) * 0.12 - 2.0];
            let up = [0.02, 0.1, 0.5, 0.9][i as usize % 4];
            let across = f64::sqrt(1.0 - up * up) / 2f64.sqrt();
            Ray { origin, direction: [across, up, across], t_min: 1e-3, t_max: 400.0 }
        })
        .collect();
    let off = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f64>() / a.len() as f64;
    for softness in [4.0, 20.0] {
        // The share of 64 points of the light's disc that are seen.
        let mut truth = vec![0.0; rays.len()];
        for point in 1..=64 {
            let aimed: Vec<Ray> = rays.iter().map(|ray| Ray { direction: toward(ray.direction, 1.0 / softness, on_disc(point)), ..*ray }).collect();
            truth.iter_mut().zip(apart.shadow(&aimed, 0.0, 100.0)).for_each(|(sum, lit)| *sum += lit / 64.0);
        }
        let between = truth.iter().filter(|lit| (0.05..0.95).contains(*lit)).count();
        assert!(between > 100, "{softness}: {between}");
        let (a, b) = (apart.shadow(&rays, softness, 100.0), whole.shadow(&rays, softness, 100.0));
        let (a, b) = (off(&a, &truth), off(&b, &truth));
        assert!(a < 0.035 && a <= b + 1e-3, "{softness}: {a} apart, {b} searched");
    }
    // Of a sharp edge both say the same, but where a ray creeps along the floor.
    let (a, b) = (apart.shadow(&rays, 0.0, 100.0), whole.shadow(&rays, 0.0, 100.0));
    let far = a.iter().zip(&b).filter(|(a, b)| a != b).count();
    assert!(far < 20, "{far}");
}

#[test]
fn planes_are_those_that_stand_in_a_union() {
    let known = |text: &str| scene(text).functions.ahead;
    assert!(known("scene = plane(y)\n").planes.is_some());
    assert!(known("scene = sphere(1) | plane(y, -1).rotate(z, 10deg).translate(1, 2, 3)\n").planes.is_some());
    // What is cut by one, or blends with one, is not bounded by it alone.
    for text in ["scene = sphere(1) & plane(y)\n", "scene = sphere(1) - plane(y)\n", "scene = smooth_union(sphere(1), plane(y), 0.2)\n"] {
        assert!(known(text).planes.is_none(), "{text}");
    }
    let region = known("scene = sphere(1).translate(3, 0, 0) | plane(y, -4)\n").region.unwrap();
    assert!(region.0[0].lo > 1.9 && region.0[0].hi < 4.1 && region.0[1].lo > -1.1, "{region:?}");
    assert!(known("scene = sphere(0.3).repeat(2)\n").region.is_none());
}

#[test]
fn what_is_not_looked_at_is_said() {
    let said = |text: &str| {
        let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
        skipped(&outcome.compiled.unwrap(), &outcome.sources).join("\n")
    };
    let both = said("scene = sphere(1).translate(3, 0, 0) | plane(y, -4)\n");
    assert!(both.contains("looks for planes") && both.contains("beyond the box about what is solid: but planes nothing is solid there"), "{both}");
    assert!(said("scene = box(1)\n").contains("beyond the box about what is solid: nothing is solid there"));
    let neither = said("scene = sphere(0.3).repeat(2)\n");
    assert!(!neither.contains("looks"), "{neither}");
}

#[test]
fn a_module_holds_what_its_rays_follow_once() {
    let text = "scene = plane(y) | sphere(1).translate(0, 1, 0) | box(1)\n";
    let all = scene(text).module.wgsl;
    for name in ["fn sf_planes(", "fn sf_ahead(", "fn sf_rest_bound(", "fn sf_within("] {
        assert_eq!(all.matches(name).count(), 1, "{name} in {all}");
    }
    assert!(all.contains("return min(sf_rest_bound(p), sf_planes(p));"), "{all}");
    let only = |exports: &[Export]| {
        let options = Options { exports: exports.to_vec(), ..Options::default() };
        compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &options).compiled.unwrap().module
    };
    let field = only(&[Export::Field, Export::Bound]).wgsl;
    assert!(["sf_planes", "sf_ahead", "sf_rest", "sf_region"].iter().all(|name| !field.contains(name)), "{field}");
    let trace = only(&[Export::Trace]);
    assert_eq!(trace.exports, [Export::Trace]);
    assert!(!trace.wgsl.contains("fn sf_bound("), "{}", trace.wgsl);
}
