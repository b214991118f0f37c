//! Balls that are too fast or too many.

use super::rows::{Args, Cells, Row, scene};
use crate::command::bench::error::truth::Errors;
use surefoot_compiler::compiled::{Compiled, Live};
use surefoot_compiler::physics::{Ball, Field, Ground, State, World, spawn};
use surefoot_runtime::{Gpu, Physics};

/// Steps a second.
const RATE: f64 = 60.0;
/// How many balls come to rest in 64 bits at most, and for how many seconds: a processor has one thread for them.
const FEW: (u32, u32) = (300, 20);

/// Balls in a scene.
pub struct Heap {
    /// Its name in the table.
    pub name: String,
    /// The scene for 64 bits, and for the adapter.
    texts: [String; 2],
    /// Seconds for each.
    seconds: [u32; 2],
    /// Whether they shall come to rest.
    rests: bool,
    /// No ball may be on the other side of this height along x.
    wall: f64,
    /// No ball may be below this height.
    floor: f64,
}

/// All of them.
pub fn heaps(args: &Args) -> Vec<Heap> {
    // A ball of radius 0.05 at 300 units a second goes 100 of its radii in a step; each starts a little farther away than the one before.
    let shots = "\
scene = box((0.01, 4, 4))
physics { gravity: (0, 0, 0), restitution: 0.5 }
balls shots { count: 200, radius: 0.05, spawn: (-20, -1.5, -1.5)..(-2, 1.5, 1.5), velocity: (300, 0, 0) }
";
    let bowl = |count: u32| {
        // As many as fill it a few balls deep.
        let side = 0.24 * f64::from(count).cbrt();
        format!(
            "scene = box(({0}, 2, {0})).translate(0, 0, 0) - box(({1}, 2, {1})).translate(0, 0.5, 0)
physics {{ restitution: 0.4, friction: 0.5, rolling: 0.02 }}
balls heap {{ count: {count}, radius: 0.04..0.06, spawn: (-{2}, 0.2, -{2})..({2}, {3}, {2}) }}
render {{ extent: 200 }}
",
            side + 1.0,
            side,
            0.45 * side,
            0.2 + side
        )
    };
    let few = (FEW.0.min(args.balls), FEW.1.min(args.seconds));
    vec![
        Heap {
            name: "balls at 100 radii a step against a thin wall".to_owned(),
            texts: [shots.to_owned(), shots.to_owned()],
            seconds: [1, 1],
            rests: false,
            wall: 0.0,
            floor: f64::NEG_INFINITY,
        },
        Heap {
            name: format!("{} balls at rest for {} seconds (in 64 bits {} for {})", args.balls, args.seconds, few.0, few.1),
            texts: [bowl(few.0), bowl(args.balls)],
            seconds: [few.1, args.seconds],
            rests: true,
            wall: f64::INFINITY,
            floor: -0.6,
        },
    ]
}

/// Lets balls go on both machines.
pub fn row(gpu: &Gpu, heap: &Heap, show: &dyn Fn(f64)) -> Result<Row, String> {
    let mut row = Row {
        name: heap.name.clone(),
        cells: Default::default(),
        unknown: (0, 0),
        said: Vec::new(),
        refused: false,
        limit: 0.05,
        known: None,
    };
    for (machine, cells) in row.cells.iter_mut().enumerate() {
        let (compiled, said) = scene(&heap.texts[machine]);
        row.said = said;
        let compiled = compiled.ok_or("the scene is refused")?;
        let start = spawn::spawn(&compiled.groups(&compiled.live()));
        let steps = heap.seconds[machine] * RATE as u32;
        let half = |step: u32| show(0.5 * (machine as f64 + f64::from(step) / f64::from(steps)));
        let balls = if machine == 0 { exact(&compiled, &start, steps, &half)? } else { device(gpu, &compiled, &start, steps, &half)? };
        *cells = judge(heap, &compiled, &balls)?;
    }
    Ok(row)
}

fn exact(compiled: &Compiled, start: &[Ball], steps: u32, show: &dyn Fn(u32)) -> Result<Vec<Ball>, String> {
    let mut world = World::new(start.to_vec());
    let (live, law) = (compiled.live(), compiled.law(&compiled.live()));
    let ground = Field::new(compiled, &live, None).map_err(|e| e.to_string())?;
    for step in 0..steps {
        world.step(&law, 1.0 / RATE, |_, _| ground.clone());
        show(step);
    }
    Ok(world.balls)
}

fn device(gpu: &Gpu, compiled: &Compiled, start: &[Ball], steps: u32, show: &dyn Fn(u32)) -> Result<Vec<Ball>, String> {
    let mut physics = Physics::with(gpu, compiled, start)?;
    let mut live: Live = compiled.live();
    for step in 0..steps {
        let before = live.clone();
        live.time += 1.0 / RATE;
        physics.step(compiled, &before, &live)?;
        if step % 16 == 0 {
            physics.wait()?;
            show(step);
        }
    }
    physics.read()
}

fn judge(heap: &Heap, compiled: &Compiled, balls: &[Ball]) -> Result<Cells, String> {
    let ground = Field::new(compiled, &compiled.live(), None).map_err(|e| e.to_string())?;
    let numbers = balls.iter().flat_map(|b| b.position.into_iter().chain(b.velocity).chain(b.spin));
    let finite = numbers.fold((0, 0), |(all, bad), n| (all + 1, bad + usize::from(!n.is_finite())));
    let restless = |b: &&Ball| heap.rests && b.state != State::Asleep;
    let passed = |b: &&Ball| b.position[0] > heap.wall || b.position[1] < heap.floor || heap.rests && b.state == State::Gone;
    // How deep a ball stands in the surface, in its radii.
    let sunk: Vec<f64> = balls
        .iter()
        .filter(|b| b.state != State::Gone)
        .map(|b| (b.radius - ground.touch(b.position, b.radius).distance).max(0.0) / b.radius)
        .collect();
    Ok(Cells {
        finite,
        ended: (balls.len(), balls.iter().filter(restless).count()),
        missed: (balls.len(), balls.iter().filter(passed).count()),
        error: Some((Errors::percentile(&sunk, 99.0), Errors::percentile(&sunk, 100.0))),
    })
}
