//! Balls on the GPU: against the step in 64 bits, against closed forms, and through what a person does to them. `BALLS=1` makes the tests as
//! large as the numbers in the documents.

mod common;

use common::gpu;
use surefoot_compiler::compiled::{Compiled, Live};
use surefoot_compiler::physics::{Ball, Field, Ground, Law, State, World, spawn};
use surefoot_compiler::reference::vector::{add, length, scale, sub};
use surefoot_compiler::{MemoryLoader, Options, compile, diagnostic};
use surefoot_runtime::physics::{Contact, Physics};

const STEP: f64 = 1.0 / 60.0;

fn large() -> bool {
    std::env::var_os("BALLS").is_some()
}

fn scene(text: &str) -> Compiled {
    let outcome = compile(&MemoryLoader::new().with("s.sdf", text), "s.sdf", &Options::default());
    let words = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    outcome.compiled.unwrap_or_else(|| panic!("{words}"))
}

fn law(restitution: f64, friction: f64, rolling: f64) -> Law {
    Law { gravity: [0.0, -9.81, 0.0], restitution, friction, rolling, substeps: 4, walls: None, extent: 100.0 }
}

/// Steps from the live values' time on.
fn run(physics: &mut Physics, compiled: &Compiled, law: &Law, live: &mut Live, steps: u32) {
    for _ in 0..steps {
        let before = live.clone();
        live.time += STEP;
        physics.step_by(compiled, law, &before, live).unwrap();
    }
}

fn gap(ground: &impl Ground, ball: &Ball) -> f64 {
    (ground.touch(ball.position, ball.radius).distance - ball.radius) / ball.radius
}

/// Names and texts of places where a ball comes to rest, and where it is let fall from.
const PLACES: [(&str, &str, [f64; 3]); 5] = [
    ("plane", "scene = plane(y)", [0.1, 0.4, 0.2]),
    ("bowl", "param r = 1 in 0.6..1.4\nscene = box(4, 2, 4) - sphere(r).translate(0, 1, 0)", [0.2, 0.8, 0.1]),
    (
        "a V between two boxes",
        "param turn = 0.6 in 0.3..1.2\nscene = box(4, 1, 4).translate(2, -0.5, 0).rotate(z, turn) | box(4, 1, 4).translate(-2, -0.5, 0).rotate(z, -turn)",
        [0.05, 0.5, 0.3],
    ),
    (
        "the groove of a lying twisted column",
        "param rate = 2 in 0.5..4\nlet column = box(0.8, 6, 0.8).twist(y, rate).rotate(x, 90deg)\nscene = box(1.6, 0.8, 5).translate(0, -0.4, 0) - column",
        [0.03, 0.1, 0.1],
    ),
    (
        "the saddle of a smooth union",
        "param k = 0.3 in 0.1..0.6\nscene = smooth_union(sphere(0.5).translate(-0.45, 0, 0), sphere(0.5).translate(0.45, 0, 0), k) | box(3, 0.1, 3).translate(0, 0.3, 0)",
        [0.02, 0.8, 0.0],
    ),
];

#[test]
fn balls_rest_on_the_surface() {
    let gpu = gpu();
    for (name, text, start) in PLACES {
        let compiled = scene(text);
        let mut physics = Physics::with(&gpu, &compiled, &[]).unwrap();
        for part in [0.0, 0.5, 1.0] {
            let mut live = compiled.live();
            for (slot, p) in live.components.iter_mut().zip(&compiled.graph.parameters) {
                *slot = p.min + part * (p.max - p.min);
            }
            physics.write(&[Ball::at(start, 0.05)]).unwrap();
            run(&mut physics, &compiled, &law(0.5, 0.5, 0.02), &mut live, 600);
            let ball = physics.read().unwrap()[0];
            let gap = gap(&Field::new(&compiled, &live, None).unwrap(), &ball);
            println!("{name} at {part}: a gap of {gap:.2e} radii, {:?}", ball.state);
            assert!(gap.abs() < 2e-3, "{name} at {part}: a gap of {gap} radii at {:?}", ball.position);
        }
    }
}

#[test]
fn the_device_and_64_bits_agree_until_two_balls_meet() {
    let gpu = gpu();
    let compiled = scene("scene = smooth_union(box(8, 2, 8) - sphere(3).translate(0, 3, 0), sphere(1).translate(0, -0.4, 0), 0.3)");
    let law = law(0.5, 0.3, 0.01);
    let group = "balls b { count: 1000, radius: 0.02..0.03, spawn: (-1.8, 1.5, -1.8)..(1.8, 3, 1.8), seed: 5 }";
    let balls = spawn::spawn(&scene(&format!("scene = plane(y)\n{group}")).groups(&compiled.live()));
    let ground = Field::new(&compiled, &compiled.live(), None).unwrap();
    let mut world = World::new(balls.clone());
    let mut physics = Physics::with(&gpu, &compiled, &balls).unwrap();
    let mut live = compiled.live();
    let mut met = vec![false; balls.len()];
    let mut first = std::collections::BTreeSet::new();
    let (mut worst, mut judged) = (0.0f64, 0);
    for step in 0..90 {
        world.step(&law, STEP, |_, _| ground.clone());
        run(&mut physics, &compiled, &law, &mut live, 1);
        let device = physics.read().unwrap();
        for (i, a) in world.balls.iter().enumerate() {
            // Within a step they go no farther towards each other.
            let near = |b: &Ball| length(sub(a.position, b.position)) < a.radius + b.radius + STEP * length(sub(a.velocity, b.velocity)) + 0.01;
            met[i] = met[i] || world.balls.iter().enumerate().any(|(k, b)| k != i && near(b));
            if !met[i] {
                let apart = length(sub(a.position, device[i].position)) / a.radius;
                if apart > 1e-3 && first.insert(i) && first.len() < 10 { println!("step {step} ball {i} {apart:.1e} {:?} {:?}", a.position, a.velocity); }
                worst = worst.max(apart);
                judged += 1;
            }
        }
    }
    let bounced = world.balls.iter().zip(&met).filter(|(b, met)| !**met && b.grounded).count();
    println!("{judged} positions judged, the worst {worst:.2e} radii apart; {bounced} unmet balls on the ground at the end");
    assert!(judged > 20_000);
    assert!(worst < 1e-3, "{worst}");
}
