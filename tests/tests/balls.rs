//! Balls on the GPU: against the step in 64 bits, against closed forms, and through what a person does to them. `BALLS=1` makes the tests as
//! large as the numbers in the documents.

use crate::common::gpu;
use surefoot_compiler::compiled::{Compiled, Live};
use surefoot_compiler::physics::{Ball, Field, Ground, Law, State, World, spawn};
use surefoot_compiler::vector::{add, length, scale, sub};
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
        "param k = 0.3 in 0.1..0.6\nscene = smooth_union(sphere(0.5).translate(-0.45, 0, 0), sphere(0.5).translate(0.45, 0, 0), k)",
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
    let (mut worst, mut judged) = (0.0f64, 0);
    for _ in 0..90 {
        world.step(&law, STEP, |_, _| ground.clone());
        run(&mut physics, &compiled, &law, &mut live, 1);
        let device = physics.read().unwrap();
        for (i, a) in world.balls.iter().enumerate() {
            // Within a step they go no farther towards each other.
            let near = |b: &Ball| length(sub(a.position, b.position)) < a.radius + b.radius + STEP * length(sub(a.velocity, b.velocity)) + 0.01;
            met[i] = met[i] || world.balls.iter().enumerate().any(|(k, b)| k != i && near(b));
            if !met[i] {
                let apart = length(sub(a.position, device[i].position)) / a.radius;
                worst = worst.max(apart);
                judged += 1;
            }
        }
    }
    println!("{judged} positions judged, the worst {worst:.2e} radii apart");
    assert!(judged > 20_000);
    assert!(worst < 1e-3, "{worst}");
}

#[test]
fn a_device_keeps_to_closed_forms() {
    let gpu = gpu();
    let compiled = scene("scene = plane(y)");
    let live = compiled.live();
    // One falls and bounces, the other slides.
    let balls = [Ball::at([0.0, 1.05, 0.0], 0.05), Ball { velocity: [2.0, 0.0, 0.0], ..Ball::at([5.0, 0.05, 0.0], 0.05) }];
    let mut physics = Physics::with(&gpu, &compiled, &balls).unwrap();
    let (mut tops, mut last) = (Vec::new(), [0.0f64; 2]);
    for _ in 0..240 {
        run(&mut physics, &compiled, &law(0.7, 0.3, 0.0), &mut live.clone(), 1);
        let ball = physics.read().unwrap()[0];
        if last[1] > 0.0 && ball.velocity[1] <= 0.0 {
            tops.push(last[0] + last[1] * last[1] / (2.0 * 9.81) - 0.05);
        }
        last = [ball.position[1], ball.velocity[1]];
    }
    let off: Vec<f64> = tops.iter().zip(1..=5).map(|(top, i)| (top / 0.7f64.powi(2 * i) - 1.0).abs()).collect();
    let rolls = physics.read().unwrap()[1].velocity[0] / 2.0;
    println!("five bounces are off by {off:.5?}; what slid rolls at {rolls:.5} of its speed, 5/7 = {:.5}", 5.0 / 7.0);
    assert!(off.len() == 5 && off.iter().all(|off| *off < 0.01));
    assert!((rolls * 7.0 / 5.0 - 1.0).abs() < 0.02);

    let slope = 20f64.to_radians();
    let compiled = scene("scene = plane(y).rotate(z, 20deg)");
    let start = Ball::at([-slope.sin() * 0.05, slope.cos() * 0.05, 0.0], 0.05);
    let mut physics = Physics::with(&gpu, &compiled, &[start]).unwrap();
    run(&mut physics, &compiled, &law(0.5, 0.4, 0.0), &mut compiled.live(), 120);
    let way = length(sub(physics.read().unwrap()[0].position, start.position));
    let want = 0.5 * 5.0 / 7.0 * 9.81 * slope.sin() * 4.0;
    println!("{way:.5} along the slope, closed form {want:.5}");
    assert!((way / want - 1.0).abs() < 0.02);
}

/// Mean height, and the energy of motion and place.
fn statistics(balls: &[Ball], law: &Law) -> (f64, f64) {
    let height = balls.iter().map(|b| b.position[1]).sum::<f64>() / balls.len() as f64;
    (height, World::new(balls.to_vec()).energy(law) / balls.iter().map(Ball::mass).sum::<f64>())
}

#[test]
fn many_balls_are_on_the_whole_as_in_64_bits() {
    let gpu = gpu();
    let compiled = scene(
        "scene = box(6, 3, 6) - sphere(2).translate(0, 2, 0)\nballs b { count: 300, radius: 0.05..0.08, spawn: (-1, 1.4, -1)..(1, 3.4, 1), seed: 2 }",
    );
    let law = compiled.law(&compiled.live());
    let balls = spawn::spawn(&compiled.groups(&compiled.live()));
    let ground = Field::new(&compiled, &compiled.live(), None).unwrap();
    let mut world = World::new(balls.clone());
    let mut physics = Physics::with(&gpu, &compiled, &balls).unwrap();
    let mut live = compiled.live();
    let mut sums = [0.0; 4];
    for _ in 0..if large() { 1200 } else { 240 } {
        world.step(&law, STEP, |_, _| ground.clone());
        run(&mut physics, &compiled, &law, &mut live, 1);
        let (want, have) = (statistics(&world.balls, &law), statistics(&physics.read().unwrap(), &law));
        for (sum, new) in sums.iter_mut().zip([want.0, have.0, want.1, have.1]) {
            *sum += new;
        }
    }
    let [height, on_device, energy, energy_on_device] = sums;
    println!("over {:.0} s: height {:.5} of that in 64 bits, energy {:.5}", world.time, on_device / height, energy_on_device / energy);
    assert!((on_device / height - 1.0).abs() < 0.01);
    assert!((energy_on_device / energy - 1.0).abs() < 0.01);
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let gpu = gpu();
    let compiled = scene("scene = plane(y) | sphere(0.6)\nballs b { count: 2000, radius: 0.02..0.05, spawn: (-0.7, 1, -0.7)..(0.7, 3, 0.7), seed: 9 }");
    let once = || {
        let mut physics = Physics::prepare(&gpu, &compiled, &compiled.live()).unwrap().unwrap();
        let law = compiled.law(&compiled.live());
        run(&mut physics, &compiled, &law, &mut compiled.live(), 60);
        physics.read().unwrap()
    };
    let first = once();
    assert_eq!(first, once());
    assert!(first.iter().any(|b| b.touching > 0), "they met");
}

#[test]
fn a_scene_without_balls_builds_nothing() {
    let gpu = gpu();
    let before = gpu.stats();
    let compiled = scene("scene = sphere(1)");
    assert!(Physics::prepare(&gpu, &compiled, &compiled.live()).unwrap().is_none());
    assert_eq!(gpu.stats(), before);
}

#[test]
fn fast_balls_pass_no_thin_wall() {
    let gpu = gpu();
    let compiled = scene("scene = box(0.01, 40, 40)");
    let law = Law { gravity: [0.0; 3], ..law(1.0, 0.3, 0.0) };
    // A hundred radii a step.
    let speed = 100.0 * 0.02 / STEP;
    let ball = |i: u32| {
        let (y, z) = (f64::from(i % 100) * 0.15 - 7.5, f64::from(i / 100) * 0.15 - 7.5);
        Ball { velocity: [speed, 0.3 * y, 0.3 * z], ..Ball::at([-1.0 - 0.0013 * f64::from(i % 977), y, z], 0.02) }
    };
    let balls: Vec<Ball> = (0..10_000).map(ball).collect();
    let mut physics = Physics::with(&gpu, &compiled, &balls).unwrap();
    run(&mut physics, &compiled, &law, &mut compiled.live(), 12);
    let balls = physics.read().unwrap();
    let passed = balls.iter().filter(|b| b.position[0] > 0.0 || b.velocity[0] > 0.0).count();
    println!("{passed} of {} passed", balls.len());
    assert_eq!(passed, 0);
}

#[test]
fn balls_stay_in_their_bowl() {
    let gpu = gpu();
    // 10,000 in a bowl of twice the size take minutes.
    let (count, size, seconds) = if large() { (10_000, 2.0, 60) } else { (600, 0.8, 6) };
    let compiled = scene(&format!(
        "let r = {size}\nscene = capsule((0, r, 0), (0, 4 * r, 0), 1.05 * r) - capsule((0, r, 0), (0, 4 * r, 0), r)\nphysics {{ restitution: 0.4 }}\nballs b {{ count: {count}, radius: 0.04..0.06, spawn: (-0.6 * r, r, -0.6 * r)..(0.6 * r, 4 * r, 0.6 * r), seed: 4 }}"
    ));
    let law = compiled.law(&compiled.live());
    let ground = Field::new(&compiled, &compiled.live(), None).unwrap();
    let mut live = compiled.live();
    let mut physics = Physics::prepare(&gpu, &compiled, &live).unwrap().unwrap();
    let (mut drift, mut deepest) = (0.0f64, f64::MIN);
    let mut last: Vec<Ball> = Vec::new();
    for step in 0..60 * seconds {
        run(&mut physics, &compiled, &law, &mut live, 1);
        let balls = physics.read().unwrap();
        // No ball wakes and sleeps again within a step.
        for (was, is) in last.iter().zip(&balls).filter(|(was, is)| was.state == State::Asleep && is.state == State::Asleep) {
            drift = drift.max(length(sub(was.position, is.position)));
        }
        last = balls;
        if step % 30 == 29 {
            deepest = last.iter().map(|b| -gap(&ground, b)).fold(deepest, f64::max);
        }
    }
    let finite = last.iter().all(|b| b.position.iter().chain(&b.velocity).chain(&b.spin).all(|c| c.is_finite()));
    let axis = |b: &Ball| [0.0, b.position[1].clamp(size, 4.0 * size), 0.0];
    let outside = last.iter().filter(|b| length(sub(b.position, axis(b))) > size).count();
    let asleep = last.iter().filter(|b| b.state == State::Asleep).count();
    println!("{count} balls, {seconds} s: {outside} outside, the deepest {deepest:.2e} radii in, {asleep} asleep, sleepers drift {drift:e}");
    assert!(finite);
    assert_eq!(outside, 0);
    assert!(deepest < 0.02);
    assert_eq!(drift, 0.0);
    assert!(asleep * 10 > last.len() * 9, "a heap comes to rest: {asleep} of {count} sleep");
}

#[test]
fn a_swap_moves_no_ball() {
    let gpu = gpu();
    let text = "balls b { count: 1400, radius: 0.02..0.05, spawn: (-1, 1, -1)..(1, 3, 1), seed: 9 }";
    let compiled = scene(&format!("scene = plane(y)\n{text}"));
    let law = compiled.law(&compiled.live());
    let mut live = compiled.live();
    let mut physics = Physics::prepare(&gpu, &compiled, &live).unwrap().unwrap();
    run(&mut physics, &compiled, &law, &mut live, 60);
    let before = physics.read().unwrap();
    let fastest = before.iter().map(|b| length(b.velocity)).fold(0.0, f64::max);
    // A wall inside of them.
    let other = scene(&format!("param w = 1.6 in 0.1..3\nscene = plane(y) | box(w, 2, 4)\n{text}"));
    physics.put(Contact::prepare(&gpu, &other).unwrap());
    assert_eq!(before, physics.read().unwrap(), "every bit is as it was");
    let mut other_live = other.live();
    other_live.time = live.time;
    let ground = Field::new(&other, &other_live, None).unwrap();
    let inside = before.iter().filter(|b| gap(&ground, b) < -0.1).count();
    let mut peak = 0.0f64;
    for _ in 0..60 {
        run(&mut physics, &other, &law, &mut other_live, 1);
        peak = physics.read().unwrap().iter().map(|b| length(b.velocity)).fold(peak, f64::max);
    }
    let after = physics.read().unwrap();
    let deepest = after.iter().map(|b| -gap(&ground, b)).fold(f64::MIN, f64::max);
    println!("{inside} balls were inside the wall; after a second the deepest is {deepest:.1e} radii in; fastest {peak:.2}, before {fastest:.2}");
    assert!(inside > 1000);
    assert!(deepest < 0.02);
    assert!(peak < 3.0 * fastest);
}

#[test]
fn a_piston_lifts_balls() {
    let gpu = gpu();
    let compiled = scene(
        "scene = (box(2.4, 6, 2.4) - box(2, 7, 2)).translate(0, 2, 0) | box(1.99, 0.2, 1.99).translate(0, min(0.8 * max(time - 0.5, 0), 1.2), 0)\nballs b { count: 300, radius: 0.05..0.08, spawn: (-0.8, 0.3, -0.8)..(0.8, 2, 0.8), seed: 1 }",
    );
    let law = compiled.law(&compiled.live());
    let mut live = compiled.live();
    let mut physics = Physics::prepare(&gpu, &compiled, &live).unwrap().unwrap();
    let mut fastest = 0.0f64;
    for _ in 0..180 {
        run(&mut physics, &compiled, &law, &mut live, 1);
        fastest = physics.read().unwrap().iter().map(|b| length(b.velocity)).fold(fastest, f64::max);
    }
    let balls = physics.read().unwrap();
    let lowest = balls.iter().map(|b| b.position[1] - b.radius).fold(f64::MAX, f64::min);
    println!("the lowest ball stands at {lowest:.4}, the piston at 1.3; fastest {fastest:.2}");
    assert!(lowest > 1.3 - 0.002);
    assert!(fastest < 12.0);
}

#[test]
fn a_device_carries_balls_as_64_bits_do() {
    let gpu = gpu();
    // A turntable, a belt that runs up a slope, and a slab in the air that nothing meets.
    let compiled = scene(
        "material ghost { color: #ffffff, solid: off }
param tilt = 0.2 in 0..0.4
let table = cylinder(1, 0.2).rotate(y, 3 * time).translate(-1.5, 0, 0)
let belt = box(40, 0.2, 2).translate(time, 0, 0).rotate(z, tilt).translate(1.5, 0, 0) & box(2, 4, 2).translate(1.5, 0, 0)
scene = table | belt | box(6, 0.2, 6).translate(0, 0.4, 0).material(ghost)
physics { friction: 0.5 }
balls b { count: 0 }",
    );
    let at = |i: u32| [f64::from(i % 6), f64::from(i / 6)];
    let place = |[i, on_belt]: [f64; 2]| [-2.1 + 0.2 * i + 3.5 * on_belt, 0.7, 0.05 * i - 0.1];
    let balls: Vec<Ball> = (0..12).map(|i| Ball::at(place(at(i)), 0.05)).collect();
    let law = compiled.law(&compiled.live());
    let mut world = World::new(balls.clone());
    let mut physics = Physics::with(&gpu, &compiled, &balls).unwrap();
    let mut live = compiled.live();
    for _ in 0..50 {
        let before = live.clone();
        run(&mut physics, &compiled, &law, &mut live, 1);
        world.step_scene(&compiled, &before, &live).unwrap();
    }
    let device = physics.read().unwrap();
    let apart = |(a, b): (&Ball, &Ball)| length(sub(a.position, b.position)) / a.radius;
    let worst = world.balls.iter().zip(&device).map(apart).fold(0.0, f64::max);
    let aside = |b: &&Ball| b.velocity[0].hypot(b.velocity[2]) > 0.1 && b.position[1] > -0.5;
    println!("the worst is {worst:.2e} radii apart; {} are carried", device.iter().filter(aside).count());
    assert!(device.iter().filter(aside).count() >= 10, "{device:?}");
    assert!(device.iter().all(|b| b.position[1] < 0.55), "they fell through the slab");
    assert!(worst < 1e-3, "{worst}");
}

#[test]
fn what_is_held_goes_where_the_hand_is_and_through_nothing() {
    let gpu = gpu();
    let compiled = scene("scene = plane(y)");
    let (law, live) = (law(0.5, 0.3, 0.0), compiled.live());
    let balls = [Ball::at([0.0, 0.1, 0.0], 0.1), Ball::at([2.0, 0.1, 0.0], 0.1)];
    let ground = Field::new(&compiled, &live, None).unwrap();
    let mut world = World::new(balls.to_vec());
    let mut physics = Physics::with(&gpu, &compiled, &balls).unwrap();
    let mut go = |place: [f64; 3]| {
        physics.hold(0, place);
        world.held = Some((0, place));
        for _ in 0..60 {
            world.step(&law, STEP, |_, _| ground.clone());
        }
        run(&mut physics, &compiled, &law, &mut live.clone(), 60);
        let device = physics.read().unwrap();
        let apart = world.balls.iter().zip(&device).map(|(a, b)| length(sub(a.position, b.position))).fold(0.0, f64::max);
        assert!(apart < 1e-4, "{apart}");
        device[0].position
    };
    let up = go([1.0, 0.6, 0.3]);
    assert!(length(sub(up, [1.0, 0.6, 0.3])) < 1e-2, "{up:?}");
    let down = go([1.0, -0.5, 0.3]);
    assert!((down[1] - 0.1).abs() < 2e-4, "the floor holds it: {down:?}");
    physics.throw([0.0, 3.0, 0.0]);
    run(&mut physics, &compiled, &law, &mut live.clone(), 6);
    let thrown = physics.read().unwrap()[0];
    assert!((thrown.velocity[1] - (3.0 - 0.981)).abs() < 1e-3, "{thrown:?}");
}

#[test]
fn a_lift_goes_as_fast_as_it_is_however_the_frames_come() {
    let gpu = gpu();
    let compiled = scene("scene = plane(y).translate(0, 0.5 * time, 0)\nballs b { count: 0 }");
    let live = compiled.live();
    let mut physics = Physics::with(&gpu, &compiled, &[Ball::at([0.0, 0.1, 0.0], 0.1)]).unwrap();
    let (mut now, mut steps) = (live.clone(), 0);
    let (mut slowest, mut fastest) = (f64::MAX, f64::MIN);
    for frame in 0..120 {
        let passed = [0.009, 0.031, 0.017, 0.012][frame % 4];
        now.time += passed;
        steps += physics.advance(&compiled, &now, passed, 3).unwrap();
        let speed = physics.read().unwrap()[0].velocity[1];
        if frame > 20 {
            (slowest, fastest) = (slowest.min(speed), fastest.max(speed));
        }
    }
    println!("{steps} steps, lifted at {slowest:.3} to {fastest:.3}");
    assert!(slowest > 0.48 && fastest < 0.52);
    let ball = physics.read().unwrap()[0];
    assert!((ball.position[1] - 0.1 - 0.5 * now.time).abs() < 0.5 / 60.0 + 1e-3, "{ball:?}");
}

#[test]
fn two_balls_keep_their_momentum() {
    let gpu = gpu();
    let compiled = scene("scene = plane(y, -50)");
    let law = Law { gravity: [0.0; 3], ..law(0.8, 0.3, 0.0) };
    let a = Ball { velocity: [1.0, 0.1, 0.0], ..Ball::at([-0.3, 0.0, 0.0], 0.1) };
    let b = Ball { velocity: [-2.0, 0.0, 0.2], spin: [0.0, 3.0, 9.0], ..Ball::at([0.3, 0.04, 0.0], 0.05) };
    let momentum = |balls: &[Ball]| balls.iter().fold([0.0; 3], |sum, b| add(sum, scale(b.velocity, b.mass())));
    let mut physics = Physics::with(&gpu, &compiled, &[a, b]).unwrap();
    run(&mut physics, &compiled, &law, &mut compiled.live(), 60);
    let after = physics.read().unwrap();
    let lost = length(sub(momentum(&after), momentum(&[a, b]))) / length(momentum(&[a, b]));
    println!("momentum lost: {lost:.1e}");
    assert!(after[0].velocity[0] < 1.0, "they met");
    assert!(lost < 1e-5);
}

#[test]
fn elastic_balls_keep_their_energy() {
    let gpu = gpu();
    let compiled = scene(
        "scene = sphere(1).translate(0, 50, 0)\nballs b { count: 100, radius: 0.1..0.2, spawn: (-1.8, -1.8, -1.8)..(1.8, 1.8, 1.8), velocity: (3, 0.3, 0.7), seed: 7 }",
    );
    let law = Law { gravity: [0.0; 3], walls: Some([[-2.0; 3], [2.0; 3]]), ..law(1.0, 0.0, 0.0) };
    let balls = spawn::spawn(&compiled.groups(&compiled.live()));
    let mut physics = Physics::with(&gpu, &compiled, &balls).unwrap();
    run(&mut physics, &compiled, &law, &mut compiled.live(), 120);
    let left = World::new(physics.read().unwrap()).energy(&law) / World::new(balls).energy(&law);
    println!("{left:.4} of the energy is left after two seconds");
    assert!((0.97..1.01).contains(&left), "{left}");
}

#[test]
fn a_ball_is_seen_where_it_is() {
    use surefoot_compiler::camera::Basis;
    use surefoot_runtime::headless::{FORMAT, Shot, render_with};
    use surefoot_runtime::{Picture, ViewMode};
    let gpu = gpu();
    // One half in front of the field's ball and one half behind it, and one that stands alone at the picture's rim; wider than a tile.
    let compiled = scene("scene = sphere(1)\nballs b { count: 0 }\ncamera { eye: (0.3, 0.4, 6), target: (0, 0, 0), fov: 40deg }");
    let balls = [([0.9, 0.2, 0.7], 0.4), ([-0.8, 0.3, -0.5], 0.7), ([2.0, -1.4, 0.3], 0.3)];
    let physics = Physics::with(&gpu, &compiled, &balls.map(|(p, r)| Ball::at(p, r))).unwrap();
    let live = compiled.live();
    let mut picture = Picture::prepare(&gpu, &compiled, FORMAT, ViewMode::Normals).unwrap();
    picture.show_balls(&compiled, &live, Some(&physics));
    let (width, height) = (640, 400);
    let pixels = render_with(&gpu, &mut picture, &compiled, &live, &Shot { mode: ViewMode::Normals, ..Shot::new(width, height) }).unwrap();
    let camera = compiled.frame(&live).cameras[0].1;
    let basis = Basis::of(&camera);
    let spheres: Vec<_> = balls.into_iter().chain([([0.0; 3], 1.0)]).collect();
    let (mut wrong, mut of_balls) = (0, 0);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let direction = basis.direction((f64::from(x) + 0.5, f64::from(y) + 0.5), (width, height));
        let hit = |(center, radius): &([f64; 3], f64)| {
            let way = sub(*center, camera.eye);
            let along = way.iter().zip(&direction).map(|(a, b)| a * b).sum::<f64>();
            let rest = radius * radius - length(sub(way, scale(direction, along))).powi(2);
            (rest >= 0.0).then(|| along - rest.sqrt())
        };
        let nearest = spheres.iter().enumerate().filter_map(|(i, s)| Some((hit(s)?, i))).min_by(|a, b| a.0.total_cmp(&b.0));
        let want = match nearest {
            None => [0.12; 3],
            Some((t, i)) => {
                of_balls += u32::from(i < 3);
                let (center, radius) = spheres[i];
                scale(sub(add(camera.eye, scale(direction, t)), center), 1.0 / radius).map(|c| 0.5 + 0.5 * c)
            }
        };
        let have = pixels.get(x, y);
        let apart = (0..3).map(|i| (want[i] * 255.0 - f64::from(have[i])).abs()).fold(0.0, f64::max);
        // At the outline of the field its rays end a hair before it, which is not judged here.
        let passes_at = length(sub(camera.eye, scale(direction, direction.iter().zip(&camera.eye).map(|(a, b)| a * b).sum())));
        let at_outline = (passes_at - 1.0).abs() < 0.02;
        wrong += u32::from(apart > 3.0 && !at_outline);
    }
    println!("{of_balls} pixels of balls, {wrong} of {} otherwise than by the formula", width * height);
    assert!(of_balls > 10_000);
    // At the outlines 32 bits may decide otherwise.
    assert!(wrong < 60, "{wrong}");
}

#[test]
fn a_ball_throws_a_shadow() {
    use surefoot_runtime::headless::{FORMAT, Shot, render_with};
    use surefoot_runtime::{Picture, ViewMode};
    let gpu = gpu();
    // Seen from above, the light from above and aside: the shadow lies where no ball hides it.
    let compiled = scene(
        "scene = plane(y)\nballs b { count: 0 }\ncamera { eye: (0, 8, 0.01), target: (0, 0, 0), fov: 40deg }\nlight sun { direction: (-1, -1, 0), intensity: 3, shadow: hard }\nrender { ambient_occlusion: off }\nenvironment { sky: gradient(#204060, #202830) }",
    );
    let live = compiled.live();
    let mut picture = Picture::prepare(&gpu, &compiled, FORMAT, ViewMode::Shaded).unwrap();
    let mut row = |balls: &[Ball]| {
        let physics = Physics::with(&gpu, &compiled, balls).unwrap();
        picture.show_balls(&compiled, &live, Some(&physics));
        let pixels = render_with(&gpu, &mut picture, &compiled, &live, &Shot::new(400, 400)).unwrap();
        (0..400).map(|x| pixels.get(x, 200)[0]).collect::<Vec<u8>>()
    };
    let empty = row(&[]);
    let with = row(&[Ball::at([0.0, 1.5, 0.0], 0.3)]);
    // The middle of the shadow is 1.5 to the left, and half of the picture's width is 8 tan 20° at the plane.
    let column = |x: f64| (200.0 + 200.0 * x / (8.0 * 20f64.to_radians().tan())) as usize;
    assert!(u32::from(with[column(-1.5)]) * 2 < u32::from(empty[column(-1.5)]), "{} {}", with[column(-1.5)], empty[column(-1.5)]);
    let dark = (0..column(-0.6)).filter(|&x| u32::from(with[x]) * 2 < u32::from(empty[x])).count();
    // As wide as the ball, seen along the light: 0.6 times the root of two.
    let want = column(0.6 * 2f64.sqrt()) - column(0.0);
    println!("the shadow is {dark} pixels wide, {want} by the formula");
    assert!(dark.abs_diff(want) <= 3);
    for x in [column(1.5), column(-2.6)] {
        assert_eq!(with[x], empty[x], "light elsewhere");
    }
}

#[test]
fn a_ball_has_the_colour_of_its_speed() {
    use surefoot_runtime::headless::{FORMAT, Shot, render_with};
    use surefoot_runtime::{Picture, ViewMode};
    let gpu = gpu();
    let compiled = scene(
        "param red = 4 in 1..10\nscene = plane(y, -3)\nballs plain { count: 0 }\nballs b { count: 0, color_by_speed: red }\ncamera { eye: (0, 0, 8), target: (0, 0, 0), fov: 40deg }",
    );
    // Three at rest, at half of the speed, and beyond it; one of a group that has its own colour.
    let ball = |x: f64, speed: f64, group| Ball { velocity: [0.0, speed, 0.0], group, ..Ball::at([x, 0.0, 0.0], 0.4) };
    let balls = [ball(-1.5, 0.0, 1), ball(-0.5, 2.0, 1), ball(0.5, 9.0, 1), ball(1.5, 9.0, 0)];
    let physics = Physics::with(&gpu, &compiled, &balls).unwrap();
    let live = compiled.live();
    let mut picture = Picture::prepare(&gpu, &compiled, FORMAT, ViewMode::Shaded).unwrap();
    picture.show_balls(&compiled, &live, Some(&physics));
    let pixels = render_with(&gpu, &mut picture, &compiled, &live, &Shot::new(400, 300)).unwrap();
    let column = |x: f64| (200.0 + 150.0 * x / (8.0 * 20f64.to_radians().tan())) as u32;
    let colors = [-1.5, -0.5, 0.5, 1.5].map(|x| pixels.get(column(x), 150));
    println!("{colors:?}");
    let [slow, middle, fast, plain] = colors.map(|c| f64::from(c[0]) - f64::from(c[2]));
    assert!(slow < -40.0, "blue at rest: {slow}");
    assert!(fast > 40.0, "red at full speed: {fast}");
    assert!(middle.abs() < 25.0 && plain.abs() < 25.0, "white between, and grey: {middle} {plain}");
}
