//! probe
mod common;
use common::gpu;
use surefoot_compiler::physics::*;
use surefoot_compiler::reference::vector::*;
use surefoot_compiler::{MemoryLoader, Options, compile};
use surefoot_runtime::physics::Physics;
#[test]
fn probe() {
    let gpu = gpu();
    for text in ["scene = plane(y)", "scene = box(6, 2, 6) - sphere(3).translate(0, 3, 0)", "scene = torus(1.3, 0.2).translate(0, 0.6, 0)", "scene = sphere(0.4).translate(0.9, 0.3, 0.2)"] {
        let c = compile(&MemoryLoader::new().with("s.sdf", text), "s.sdf", &Options::default()).compiled.unwrap();
        let law = Law { gravity: [0.0, -9.81, 0.0], restitution: 0.5, friction: 0.3, rolling: 0.01, substeps: 1, walls: None, extent: 100.0 };
        let ground = Field::new(&c, &c.live(), None).unwrap();
        let balls: Vec<Ball> = (0..900).map(|i| Ball::at([f64::from(((i % 30) as f32) * 0.1 - 1.5), f64::from(1.5f32 + 0.001 * i as f32), f64::from(((i / 30) as f32) * 0.1 - 1.5)], f64::from(0.015f32))).collect();
        let mut world = World::new(balls.clone());
        let mut physics = Physics::with(&gpu, &c, &balls).unwrap();
        let mut live = c.live();
        let mut done = vec![false; balls.len()];
        let (mut sum, mut n, mut worst, mut wi) = (0.0, 0, 0.0f64, 0);
        for step in 0..240 {
            let was = world.balls.clone();
            world.step(&law, 1.0 / 240.0, |_, _| ground.clone());
            let before = live.clone();
            live.time += 1.0 / 240.0;
            physics.step_by(&c, &law, &before, &live).unwrap();
            let d = physics.read().unwrap();
            for (i, a) in world.balls.iter().enumerate() {
                if !done[i] && a.grounded {
                    done[i] = true;
                    let e = length(sub(a.velocity, d[i].velocity)) / length(a.velocity);
                    sum += e; n += 1;
                    if e > worst { worst = e; wi = i; println!("step {step} {i} e {e:.1e}\n  was {:?} {:?}\n  cpu {:?} {:?}\n  gpu {:?} {:?}", was[i].position, was[i].velocity, a.position, a.velocity, d[i].position, d[i].velocity); }
                }
            }
        }
        println!("{text}: mean {:.1e} worst {worst:.1e} ball {wi} of {n}", sum / n as f64);
    }
}
