//! The step of balls in 64 bits, held against closed forms.

use surefoot_compiler::physics::{Ball, Field, Ground, Law, State, Touch, World, spawn};
use surefoot_compiler::vector::{add, cross, dot, length, scale, sub};
use surefoot_compiler::{Compiled, Live, MemoryLoader, Options, compile, diagnostic};

const STEP: f64 = 1.0 / 60.0;

fn scene(text: &str) -> Compiled {
    let outcome = compile(&MemoryLoader::new().with("s.sdf", text), "s.sdf", &Options::default());
    let words = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    outcome.compiled.unwrap_or_else(|| panic!("{words}"))
}

fn law(restitution: f64, friction: f64, rolling: f64) -> Law {
    Law { gravity: [0.0, -9.81, 0.0], restitution, friction, rolling, substeps: 4, walls: None, extent: 100.0 }
}

/// Runs balls over a field that stands still.
fn run(compiled: &Compiled, live: &Live, law: &Law, balls: Vec<Ball>, seconds: f64, mut each: impl FnMut(&World)) -> World {
    let ground = Field::new(compiled, live, None).unwrap();
    let mut world = World::new(balls);
    while world.time < seconds - 1e-9 {
        world.step(law, STEP, |_, _| ground.clone());
        each(&world);
    }
    world
}

/// The gap between a ball and the surface, in parts of its radius.
fn gap(ground: &impl Ground, ball: &Ball) -> f64 {
    (ground.touch(ball.position, ball.radius).distance - ball.radius) / ball.radius
}

/// A place to rest: its name, its text, and where the ball is let fall from.
const PLACES: [(&str, &str, [f64; 3]); 5] = [
    ("plane", "scene = plane(y)", [0.1, 0.4, 0.2]),
    ("bowl", "param r = 1 in 0.6..1.4\nscene = (box(4, 2, 4) - sphere(r).translate(0, 1, 0)).translate(0, 0, 0)", [0.2, 0.8, 0.1]),
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
    for (name, text, start) in PLACES {
        let compiled = scene(text);
        println!("factor {}", compiled.summary.factor);
        for part in (0..=12).map(|i| f64::from(i) / 12.0) {
            let mut live = compiled.live();
            for (slot, p) in live.components.iter_mut().zip(&compiled.graph.parameters) {
                *slot = p.min + part * (p.max - p.min);
            }
            let world = run(&compiled, &live, &law(0.5, 0.5, 0.02), vec![Ball::at(start, 0.05)], 10.0, |_| {});
            let ground = Field::new(&compiled, &live, None).unwrap();
            let ball = &world.balls[0];
            let gap = gap(&ground, ball);
            println!("{name} {part}: gap {gap:.2e} at {:?} {:?} v {:.1e}", ball.position, ball.state, length(ball.velocity));
            assert!(gap.abs() < 2e-3, "{name} at {part}: a gap of {gap} radii at {:?}", ball.position);
        }
    }
}

/// The field, where a ball takes the bound for the distance.
struct ByBound(Field);

impl Ground for ByBound {
    fn free(&self, p: [f64; 3]) -> f64 {
        self.0.free(p)
    }

    fn touch(&self, center: [f64; 3], radius: f64) -> Touch {
        Touch { distance: self.0.free(center), ..self.0.touch(center, radius) }
    }

    fn distance(&self, p: [f64; 3]) -> f64 {
        self.free(p)
    }

    fn before(&self, _: [f64; 3]) -> Option<f64> {
        None
    }
}

#[test]
fn by_the_bound_a_ball_hovers() {
    let (name, text, start) = PLACES[3];
    let compiled = scene(text);
    let live = compiled.live();
    let ground = ByBound(Field::new(&compiled, &live, None).unwrap());
    let mut world = World::new(vec![Ball::at(start, 0.05)]);
    while world.time < 10.0 {
        world.step(&law(0.5, 0.5, 0.02), STEP, |_, _| ByBound(ground.0.clone()));
    }
    let gap = gap(&ground.0, &world.balls[0]);
    println!("{name} by the bound: a gap of {gap} radii");
    assert!(gap > 0.2, "{gap}");
}

#[test]
fn five_bounces_are_as_high_as_the_formula_says() {
    let walls = Some([[-9.0, 0.0, -9.0], [9.0; 3]]);
    for (name, text, aside, walls) in [
        ("a floor", "scene = plane(y)", 0.0, None),
        // Pressed against a wall, a ball always touches that, too.
        ("a corner", "scene = plane(y) | plane(x)", -3.0, None),
        ("bounds", "scene = plane(y, -50)", 0.0, walls),
    ] {
        let compiled = scene(text);
        for restitution in [1.0, 0.9, 0.7] {
            let (mut tops, mut last) = (Vec::new(), [0.0f64; 2]);
            let law = Law { gravity: [aside, -9.81, 0.0], walls, ..law(restitution, 0.0, 0.0) };
            run(&compiled, &compiled.live(), &law, vec![Ball::at([0.05, 1.05, 0.0], 0.05)], 5.0, |world| {
                let ball = &world.balls[0];
                // Where the ball turns within a step: the top from its height and its speed.
                if last[1] > 0.0 && ball.velocity[1] <= 0.0 {
                    tops.push(last[0] + last[1] * last[1] / (2.0 * 9.81) - 0.05);
                }
                last = [ball.position[1], ball.velocity[1]];
            });
            for (i, top) in tops.iter().take(5).enumerate() {
                let want = restitution.powi(2 * (i as i32 + 1));
                println!("{name}, e = {restitution}: bounce {i} to {top:.5}, closed form {want:.5}");
                assert!((top / want - 1.0).abs() < 0.01, "{name}, bounce {i}: {top} and not {want}");
            }
            assert!(tops.len() >= 5);
        }
    }
}

#[test]
fn a_heap_in_a_square_bowl_comes_to_rest_and_gains_no_energy() {
    let compiled = scene(
        "scene = box(3, 2, 3) - box(1.2, 2, 1.2).translate(0, 0.4, 0)\nballs b { count: 150, radius: 0.05..0.07, spawn: (-0.5, -0.4, -0.5)..(0.5, 1, 0.5), seed: 1 }",
    );
    let balls = spawn::spawn(&compiled.groups(&compiled.live()));
    for restitution in [0.0, 0.4, 0.9] {
        let law = law(restitution, 0.5, 0.02);
        let (mut least, mut rise) = (f64::INFINITY, 0.0f64);
        let world = run(&compiled, &compiled.live(), &law, balls.clone(), 15.0, |world| {
            let energy = world.energy(&law) / world.balls.iter().map(Ball::mass).sum::<f64>();
            least = least.min(energy);
            rise = rise.max(energy - least);
        });
        let awake = world.balls.iter().filter(|b| b.state != State::Asleep).count();
        println!("e = {restitution}: {awake} awake, energy rose by {rise:.2e} for each unit of mass");
        assert_eq!(awake, 0);
        // What overlaps is pushed apart, and some of it upwards: by less than a hundredth of a radius on the whole.
        assert!(rise < 9.81 * 0.01 * 0.05, "{rise}");
    }
}

#[test]
fn what_slides_rolls_at_five_sevenths() {
    let compiled = scene("scene = plane(y)");
    let ball = Ball { velocity: [2.0, 0.0, 0.0], ..Ball::at([0.0, 0.05, 0.0], 0.05) };
    let world = run(&compiled, &compiled.live(), &law(0.5, 0.3, 0.0), vec![ball], 2.0, |_| {});
    let ball = &world.balls[0];
    let share = ball.velocity[0] / 2.0;
    println!("{share:.5} of the speed, 5/7 = {:.5}; rim {:.5}", 5.0 / 7.0, -ball.spin[2] * ball.radius / ball.velocity[0]);
    assert!((share * 7.0 / 5.0 - 1.0).abs() < 0.02);
    assert!((-ball.spin[2] * ball.radius / ball.velocity[0] - 1.0).abs() < 1e-3, "it rolls");
}

#[test]
fn a_ball_rolls_down_a_slope() {
    let slope = 20f64.to_radians();
    let compiled = scene("scene = plane(y).rotate(z, 20deg)");
    let start = Ball::at([-slope.sin() * 0.05, slope.cos() * 0.05, 0.0], 0.05);
    let begun = start.position;
    let world = run(&compiled, &compiled.live(), &law(0.5, 0.4, 0.0), vec![start], 2.0, |_| {});
    let way = length(sub(world.balls[0].position, begun));
    let want = 0.5 * 5.0 / 7.0 * 9.81 * slope.sin() * 4.0;
    println!("{way:.5} along the slope, closed form {want:.5}");
    assert!((way / want - 1.0).abs() < 0.02);
}

#[test]
fn two_balls_keep_their_momentum() {
    let compiled = scene("scene = plane(y, -50)");
    let law = Law { gravity: [0.0; 3], ..law(0.8, 0.3, 0.0) };
    let a = Ball { velocity: [1.0, 0.1, 0.0], ..Ball::at([-0.3, 0.0, 0.0], 0.1) };
    let b = Ball { velocity: [-2.0, 0.0, 0.2], spin: [0.0, 3.0, 9.0], ..Ball::at([0.3, 0.04, 0.0], 0.05) };
    let momentum = |balls: &[Ball]| balls.iter().fold([0.0; 3], |sum, b| add(sum, scale(b.velocity, b.mass())));
    let before = momentum(&[a, b]);
    let world = run(&compiled, &compiled.live(), &law, vec![a, b], 1.0, |_| {});
    let lost = length(sub(momentum(&world.balls), before)) / length(before);
    assert!(dot(world.balls[0].velocity, [1.0, 0.0, 0.0]) < 1.0, "they met");
    println!("momentum lost: {lost:.2e}");
    assert!(lost < 1e-5, "{lost}");
}

/// The energy of balls in a box without gravity after two seconds, over that at the start.
fn energy_left(count: u32, restitution: f64) -> f64 {
    let text = format!(
        "scene = sphere(1).translate(0, 50, 0)\nballs b {{ count: {count}, radius: 0.1..0.2, spawn: (-1.8, -1.8, -1.8)..(1.8, 1.8, 1.8), velocity: (3, 0.3, 0.7), seed: 7 }}"
    );
    let compiled = scene(&text);
    let law = Law { gravity: [0.0; 3], walls: Some([[-2.0; 3], [2.0; 3]]), ..law(restitution, 0.0, 0.0) };
    let balls = spawn::spawn(&compiled.groups(&compiled.live()));
    let start = World::new(balls.clone()).energy(&law);
    run(&compiled, &compiled.live(), &law, balls, 2.0, |_| {}).energy(&law) / start
}

#[test]
fn elastic_balls_keep_their_energy() {
    let [thin, dense, half] = [energy_left(100, 1.0), energy_left(500, 1.0), energy_left(100, 0.5)];
    println!("left after two seconds: {thin:.3} among 100, {dense:.3} among 500, {half:.3} among 100 that lose half of their speed");
    assert!((0.97..1.01).contains(&thin), "{thin}");
    assert!((0.85..1.01).contains(&dense), "{dense}");
    assert!(half < 0.3, "{half}");
}

/// What one ball gives to a row of four that touch: all of its momentum, and most of its energy; the last one takes the largest part.
#[test]
fn a_blow_goes_through_a_row() {
    let compiled = scene("scene = sphere(1).translate(0, 50, 0)");
    let law = Law { gravity: [0.0; 3], ..law(1.0, 0.0, 0.0) };
    let mut balls: Vec<Ball> = (0..4).map(|i| Ball::at([0.2 * f64::from(i), 0.0, 0.0], 0.1)).collect();
    let mut first = Ball::at([-0.5, 0.0, 0.0], 0.1);
    first.velocity = [1.0, 0.0, 0.0];
    balls.push(first);
    let world = run(&compiled, &compiled.live(), &law, balls, 1.0, |_| {});
    let momentum: f64 = world.balls.iter().map(|b| b.velocity[0]).sum();
    let energy: f64 = world.balls.iter().map(|b| b.velocity[0] * b.velocity[0]).sum();
    let last = world.balls.get(3).map_or(0.0, |b| b.velocity[0]);
    println!("momentum {momentum:.4}, energy {energy:.3}, the last one goes at {last:.3}");
    assert!((momentum - 1.0).abs() < 1e-9);
    assert!((0.7..1.01).contains(&energy), "{energy}");
    let others = world.balls.get(..3).unwrap_or_default();
    assert!(others.iter().all(|b| b.velocity[0] < last), "the last one goes at {last}");
}

#[test]
fn balls_in_one_place_part() {
    let compiled = scene("scene = plane(y)");
    let balls = vec![Ball::at([0.0, 1.0, 0.0], 0.1); 5];
    let world = run(&compiled, &compiled.live(), &law(0.5, 0.3, 0.01), balls, 5.0, |_| {});
    for (i, a) in world.balls.iter().enumerate() {
        for b in &world.balls[..i] {
            let apart = length(sub(a.position, b.position));
            assert!(apart > 0.19, "{apart} apart: {:?} and {:?}", a.position, b.position);
        }
    }
}

#[test]
fn fast_balls_pass_no_thin_wall() {
    let compiled = scene("scene = box(0.01, 4, 4)");
    let law = Law { gravity: [0.0; 3], ..law(1.0, 0.3, 0.0) };
    // A hundred radii a step.
    let speed = 100.0 * 0.02 / STEP;
    let ball = |i: u32| {
        let (y, z) = (f64::from(i % 20) * 0.15 - 1.5, f64::from(i / 20) * 0.15 - 1.5);
        Ball { velocity: [speed, 0.3 * y, 0.3 * z], ..Ball::at([-1.0 - 0.013 * f64::from(i), y, z], 0.02) }
    };
    let world = run(&compiled, &compiled.live(), &law, (0..400).map(ball).collect(), 0.2, |_| {});
    let passed = world.balls.iter().filter(|b| b.position[0] > 0.0 || b.velocity[0] > 0.0).count();
    assert_eq!(passed, 0);
}

#[test]
fn a_group_has_room_and_keeps_its_seed() {
    let compiled = scene("scene = plane(y)\nballs b { count: 500, radius: 0.02..0.06, spawn: (-1, 1, -1)..(1, 2, 1), seed: 3 }");
    let groups = compiled.groups(&compiled.live());
    let balls = spawn::spawn(&groups);
    assert_eq!(balls, spawn::spawn(&groups));
    assert_eq!(balls.len(), 500);
    for (i, a) in balls.iter().enumerate() {
        assert!((0.02..=0.06).contains(&(a.radius as f32 as f64)), "{}", a.radius);
        for b in &balls[..i] {
            assert!(length(sub(a.position, b.position)) > a.radius + b.radius, "{a:?} {b:?}");
        }
    }
    assert!(balls.iter().all(|b| b.state == State::Awake));
}

/// Steps over a scene whose time runs.
fn run_scene(compiled: &Compiled, balls: Vec<Ball>, seconds: f64) -> World {
    let mut world = World::new(balls);
    let mut live = compiled.live();
    while world.time < seconds - 1e-9 {
        let before = live.clone();
        live.time += STEP;
        world.step_scene(compiled, &before, &live).unwrap();
    }
    world
}

#[test]
fn a_belt_takes_a_ball_along() {
    let compiled = scene("scene = plane(y).translate(1.4 * time, 0, 0)\nphysics { rolling: 0, friction: 0.4 }\nballs b { count: 0 }");
    let world = run_scene(&compiled, vec![Ball::at([0.0, 0.05, 0.0], 0.05)], 2.0);
    // What friction gives the centre, spin takes: at two sevenths of the belt's speed it rolls.
    let [vx, vy, vz] = world.balls[0].velocity;
    println!("{vx:.5} on a belt of 1.4, 2/7 of it is 0.4; spin {:?}", world.balls[0].spin);
    assert!((vx / 0.4 - 1.0).abs() < 0.02 && vy.abs() < 1e-3 && vz.abs() < 1e-9);
    assert!((world.balls[0].spin[2] * 0.05 - 1.0).abs() < 0.02);
}

#[test]
fn drawings_carry_as_solids_do() {
    let law = "physics { rolling: 0, friction: 0.6, restitution: 0 }\nballs b { count: 0 }";
    for (drawn, solid) in [
        ("rectangle((200, 1)).translate(1.4 * time, -0.5).extrude(4)", "rectangle((200, 1)).extrude(4).translate(1.4 * time, -0.5, 0)"),
        ("(circle(1) | rectangle(0.3)).rotate(-3 * time).extrude(4).translate(0, -1, 0)", "circle(1).extrude(4).rotate(z, -3 * time).translate(0, -1, 0)"),
        ("circle(1).rotate(2 * time).extrude(1).rotate(x, -90deg).translate(-0.4, -0.5, 0)", "cylinder(1, 1).rotate(y, 2 * time).translate(-0.4, -0.5, 0)"),
    ] {
        let velocity = |text: &str| {
            let world = run_scene(&scene(&format!("scene = {text}\n{law}")), vec![Ball::at([0.0, 0.05, 0.0], 0.05)], 0.3);
            world.balls[0].velocity
        };
        let (found, expected) = (velocity(drawn), velocity(solid));
        println!("{drawn}: {found:?}, as a solid {expected:?}");
        assert!(length(expected) > 0.1, "{solid} carries");
        assert!(length(sub(found, expected)) < 1e-6, "{drawn}");
    }
}

#[test]
fn what_time_moves_fast_takes_balls_along() {
    for speed in [2.0, 6.0, 12.0, 40.0] {
        let text = format!("scene = box((4, 1, 4)).translate(0, -0.6 + {speed} * time, 0)\nphysics {{ gravity: (0, 0, 0), restitution: 0 }}\nballs b {{ count: 0 }}");
        let world = run_scene(&scene(&text), vec![Ball::at([0.0, 0.0, 0.0], 0.05)], 0.4);
        let ball = &world.balls[0];
        println!("{speed}: {:?} {:?}", ball.position, ball.velocity);
        assert!((ball.velocity[1] / speed - 1.0).abs() < 0.01, "{speed}: {:?}", ball.velocity);
        assert!(ball.position[1] >= -0.1 + 0.4 * speed + 0.049, "on top of it: {:?}", ball.position);
    }
}

#[test]
fn a_ball_on_a_turntable_goes_round_at_two_sevenths() {
    // Its path is a circle: Earnshaw, "Dynamics" (1844).
    let rate = 4.0;
    let compiled = scene(&format!(
        "scene = (cylinder(3, 0.2) | box(0.2, 1, 0.2).translate(2.5, 0, 0)).rotate(y, {rate} * time)\nphysics {{ rolling: 0, friction: 0.6 }}\nballs b {{ count: 0 }}"
    ));
    let (place, r, velocity) = ([1.0, 0.15, 0.0], 0.05, [0.0, 0.0, 0.3]);
    let surface = cross([0.0, rate, 0.0], place);
    let spin = scale(cross([0.0, 1.0, 0.0], sub(velocity, surface)), 1.0 / r);
    let world = run_scene(&compiled, vec![Ball { velocity, spin, ..Ball::at(place, r) }], 2.0);
    let ball = &world.balls[0];
    let turned = ball.velocity[0].atan2(ball.velocity[2]);
    println!("turned by {turned:.4}, closed form {:.4}; speed {:.5} of 0.3", rate * 2.0 / 7.0 * 2.0, length(ball.velocity));
    assert!((turned / (rate * 2.0 / 7.0 * 2.0) - 1.0).abs() < 0.02);
    assert!((length(ball.velocity) / 0.3 - 1.0).abs() < 0.02);
}

#[test]
fn what_is_not_solid_lets_balls_through() {
    let rests_at = |scene_text: &str| {
        let text = format!(
            "material ghost {{ color: #ffffff, solid: off }}\nmaterial stone {{ color: #808080 }}\nlet floor = plane(y)\n{scene_text}\nballs b {{ count: 0 }}"
        );
        let world = run_scene(&scene(&text), vec![Ball::at([0.1, 3.0, 0.1], 0.05)], 4.0);
        world.balls[0].position[1]
    };
    let slab = "box(4, 0.2, 4).translate(0, 1, 0)";
    for (what, text, height) in [
        ("a slab", format!("scene = floor | {slab}"), 1.15),
        ("one that is not solid", format!("scene = floor | {slab}.material(ghost)"), 0.05),
        ("moved afterwards, in a blend", format!("scene = smooth_union(floor, {slab}.material(ghost).rotate(y, 20deg), 0.4)"), 0.05),
        ("of many", format!("scene = floor | for i in 0..3 {{ {slab}.translate(0, 0.4 * i, 0).material(ghost) }}"), 0.05),
        ("within another that is", format!("scene = floor | {slab}.material(ghost).material(stone)"), 1.15),
        ("a hole of it is none", format!("scene = (floor | {slab}) - box(9, 9, 9).material(ghost)"), 1.15),
        ("what it cuts out of is nothing", format!("scene = floor | {slab} & sphere(9).material(ghost)"), 0.05),
    ] {
        let rests = rests_at(&text);
        println!("{what}: {rests:.4}");
        assert!((rests - height).abs() < 1e-3, "{what}: {rests}, not {height}");
    }
}
