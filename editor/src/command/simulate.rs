//! `surefoot simulate`: balls on a scene, without a window.

use super::bar::LateBar;
use super::values::{self, Setting};
use super::console::{Exit, Failure, ends_wrong, print};
use crate::picture::Device;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::{Compiled, Live};
use surefoot_compiler::physics::{Ball, State, World, spawn};
use surefoot_compiler::Options;

/// What to simulate, and what to write.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scene.
    scene: String,
    /// How long to simulate, in seconds.
    #[arg(long, alias = "time", allow_negative_numbers = true, default_value_t = 10.0, value_parser = above_zero, value_name = "SECONDS")]
    seconds: f64,
    /// Steps per second; `physics { substeps }` divides each of them.
    #[arg(long, allow_negative_numbers = true, default_value_t = 60.0, value_parser = above_zero, value_name = "N")]
    rate: f64,
    /// Write the final positions of the balls: a table (.csv) or points (.ply).
    #[arg(short, long, value_parser = table, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write the balls after each step into this folder: balls_0001.csv, …
    #[arg(long, value_name = "FOLDER")]
    frames: Option<PathBuf>,
    /// Set a parameter.
    #[arg(long, value_parser = values::setting, value_name = "NAME=VALUE")]
    set: Vec<Setting>,
    /// What computes: the graphics adapter in 32 bits, or the processor in 64.
    #[arg(long, value_enum, default_value_t)]
    device: Device,
}

fn above_zero(text: &str) -> Result<f64, String> {
    let in_range = |n: &f64| n.is_finite() && *n > 0.0;
    text.parse().ok().filter(in_range).ok_or_else(|| "write a number above zero".to_owned())
}

fn table(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match path.extension().and_then(|e| e.to_str()) {
        Some("csv" | "ply") => Ok(path),
        _ => Err(match ends_wrong(&path, &["csv", "ply"]) {
            Some(words) => format!("the name ends with .csv or .ply; {words}"),
            None => "the name ends with .csv or .ply".to_owned(),
        }),
    }
}

/// What computes the steps.
enum Machine {
    #[cfg(feature = "gpu")]
    Gpu(Box<surefoot_runtime::Physics>),
    Cpu(World),
}

/// Simulates, and writes.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let (outcome, live) = values::read(&args.scene, &args.set, &Options::default())?;
    let (Some(compiled), Some(mut live)) = (&outcome.compiled, live) else { return Ok(Exit::Errors) };
    if !compiled.has_balls() {
        return Err(Failure::usage(format!("{} has no balls: write `balls drops {{ count: 100 }}`", args.scene)));
    }
    let balls = spawn::spawn(&compiled.groups(&live));
    let mut machine = machine(args.device, compiled, &balls)?;
    if let Some(folder) = &args.frames {
        std::fs::create_dir_all(folder).map_err(|why| Failure::usage(format!("can't make the folder {}: {why}", folder.display())))?;
    }
    let bar = LateBar::new();
    let begun = Instant::now();
    let steps = (args.seconds * args.rate).round().max(1.0) as u64;
    for step in 1..=steps {
        let before = live.clone();
        live.time = step as f64 / args.rate;
        machine.step(compiled, &before, &live)?;
        if let Some(folder) = &args.frames {
            let balls = machine.read()?;
            let path = folder.join(format!("balls_{step:04}.csv"));
            write(&path, &balls)?;
        } else if step % 16 == 0 {
            machine.wait()?;
        }
        bar.show(step as f64 / steps as f64);
    }
    let balls = machine.read()?;
    bar.finish();
    let took = begun.elapsed();
    if let Some(path) = &args.output {
        write(path, &balls)?;
    }
    print(summary(&balls, steps as f64 / args.rate, steps, took).as_bytes())?;
    Ok(Exit::Fine)
}

fn machine(device: Device, compiled: &Compiled, balls: &[Ball]) -> Result<Machine, Failure> {
    if device == Device::Cpu {
        return Ok(Machine::Cpu(World::new(balls.to_vec())));
    }
    #[cfg(feature = "gpu")]
    let missing = match surefoot_runtime::Gpu::headless() {
        Ok(gpu) => {
            if gpu.is_software() {
                eprintln!("note: the adapter is a program: {}", gpu.name());
            }
            let physics = surefoot_runtime::Physics::with(&gpu, compiled, balls);
            let physics = physics.map_err(|why| Failure::usage(format!("the graphics adapter refuses the scene: {why}")))?;
            return Ok(Machine::Gpu(Box::new(physics)));
        }
        Err(missing) => missing.to_string(),
    };
    #[cfg(not(feature = "gpu"))]
    let missing = {
        let _ = compiled;
        "this program was built without graphics".to_owned()
    };
    if device == Device::Gpu {
        return Err(Failure { exit: Exit::NoGraphics, words: missing });
    }
    eprintln!("note: {missing}; computing on the processor");
    Ok(Machine::Cpu(World::new(balls.to_vec())))
}

impl Machine {
    fn step(&mut self, compiled: &Compiled, before: &Live, now: &Live) -> Result<(), Failure> {
        match self {
            #[cfg(feature = "gpu")]
            Self::Gpu(physics) => physics.step(compiled, before, now).map_err(Failure::usage),
            Self::Cpu(world) => world.step_scene(compiled, before, now).map_err(|error| Failure::usage(error.to_string())),
        }
    }

    fn read(&self) -> Result<Vec<Ball>, Failure> {
        match self {
            #[cfg(feature = "gpu")]
            Self::Gpu(physics) => physics.read().map_err(Failure::usage),
            Self::Cpu(world) => Ok(world.balls.clone()),
        }
    }

    /// Until what was ordered is done.
    fn wait(&self) -> Result<(), Failure> {
        match self {
            #[cfg(feature = "gpu")]
            Self::Gpu(physics) => physics.wait().map_err(Failure::usage),
            Self::Cpu(_) => Ok(()),
        }
    }
}

fn summary(balls: &[Ball], seconds: f64, steps: u64, took: Duration) -> String {
    let count = |state| balls.iter().filter(|b| b.state == state).count();
    let height: f64 = balls.iter().map(|b| b.position[1]).sum::<f64>() / balls.len().max(1) as f64;
    let rate = steps as f64 / took.as_secs_f64().max(1e-9);
    format!(
        "{} balls for {seconds} s in {:.2} s ({rate:.1} steps a second): {} awake, {} asleep, {} gone; mean height {height:.4}\n",
        balls.len(),
        took.as_secs_f64(),
        count(State::Awake),
        count(State::Asleep),
        count(State::Gone),
    )
}

fn write(path: &Path, balls: &[Ball]) -> Result<(), Failure> {
    let text = if path.extension().is_some_and(|e| e == "ply") { ply(balls) } else { csv(balls) };
    crate::files::write(path, text.as_bytes()).map_err(|why| Failure::usage(format!("can't write {}: {why}", path.display())))
}

/// A table: a line for each ball. Numbers are written so that they read back as they were.
fn csv(balls: &[Ball]) -> String {
    let mut text = String::from("ball,group,state,x,y,z,radius,vx,vy,vz,spin_x,spin_y,spin_z\n");
    for (i, b) in balls.iter().enumerate() {
        let state = match b.state {
            State::Awake => "awake",
            State::Asleep => "asleep",
            State::Gone => "gone",
        };
        let _ = write!(text, "{i},{},{state}", b.group);
        for number in b.position.iter().chain([&b.radius]).chain(&b.velocity).chain(&b.spin) {
            let _ = write!(text, ",{}", *number as f32);
        }
        text.push('\n');
    }
    text
}

/// Points with a radius (Turk, "The PLY Polygon File Format").
fn ply(balls: &[Ball]) -> String {
    let here: Vec<&Ball> = balls.iter().filter(|b| b.state != State::Gone).collect();
    let mut text = format!("ply\nformat ascii 1.0\nelement vertex {}\n", here.len());
    for name in ["x", "y", "z", "radius"] {
        let _ = writeln!(text, "property float {name}");
    }
    text.push_str("end_header\n");
    for b in here {
        let [x, y, z] = b.position.map(|c| c as f32);
        let _ = writeln!(text, "{x} {y} {z} {}", b.radius as f32);
    }
    text
}
