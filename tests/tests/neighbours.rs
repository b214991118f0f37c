//! A ray's answer is its own: which rays a machine leads beside it, in step, changes nothing.

use crate::common;
use surefoot_compiler::compiled::{Camera, Live, UniformSource};
use surefoot_compiler::camera::Basis;
use surefoot_runtime::passes::rays::{Follower, GpuRay, RayPicture, Rays};

/// Columns and rows of a view.
const SIZE: (u32, u32) = (128, 128);

/// Each ray of a picture is followed twice, once among its neighbours and once among rays of everywhere.
#[test]
fn a_ray_answers_the_same_in_any_company() {
    let gpu = common::gpu();
    for (name, path) in common::examples() {
        let scene = common::compile_file(&path).unwrap();
        let live = Live::start(&scene.graph);
        let frame = scene.frame(&live);
        let Some((_, own)) = frame.cameras.first() else {
            continue;
        };
        // From the side: what was found wrong once, one ray of the statue, was seen from there.
        let from: [f64; 3] = std::array::from_fn(|a| own.eye[a] - own.target[a]);
        let eye = [own.target[0] - from[2], own.eye[1], own.target[2] + from[0]];
        let basis = Basis::of(&Camera { eye, ..*own });
        let count = SIZE.0 * SIZE.1;
        // Rays begin at the eye, as those of the picture do: at zero, where the module can be told where that is.
        let moves = scene.module.uniforms.iter().any(|u| u.source == UniformSource::Origin);
        let (origin, start) = if moves { (eye, [0.0; 3]) } else { ([0.0; 3], eye.map(|c| c as f32)) };
        let ray = |i: u32| {
            let at = (f64::from(i % SIZE.0) + 0.5, f64::from(i / SIZE.0) + 0.5);
            let direction = basis.direction(at, SIZE).map(|c| c as f32);
            GpuRay { origin: start, t_min: 0.0, direction, t_max: frame.max_distance as f32 }
        };
        // An odd number has all places of a power of two as multiples.
        let shuffled = |i: u32| (i * 6_007) % count;
        let rays: Vec<GpuRay> = (0..count).map(ray).chain((0..count).map(|i| ray(shuffled(i)))).collect();
        let picture = RayPicture { size: (SIZE.0, 2 * SIZE.1), rays, origin, footprint: basis.footprint(SIZE.1) as f32 };
        let tracer = Follower { wgsl: "", name: "sf_trace", count: false };
        let followed = Rays::new(&gpu, &scene, &live, &tracer, &picture).unwrap();
        followed.run().unwrap();
        let answers = followed.read().unwrap();
        for i in 0..count {
            let (among, apart) = (answers[shuffled(i) as usize], answers[(count + i) as usize]);
            let at = (shuffled(i) % SIZE.0, shuffled(i) / SIZE.0);
            assert_eq!(among, apart, "{name}: the ray of column {} and row {}", at.0, at.1);
        }
    }
}
