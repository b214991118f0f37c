//! Balls that fall on the field, on the GPU. Their state stands in two buffers that trade places. The code of the contact is made of an
//! emitted module; it is built on any thread and put in between two steps, and no ball notices.
//!
//! A program with a device of its own:
//!
//! ```no_run
//! # fn with(device: wgpu::Device, queue: wgpu::Queue, compiled: surefoot_compiler::Compiled) -> Result<(), String> {
//! use surefoot_runtime::{Gpu, Physics};
//! let gpu = Gpu::from_parts(device, queue);
//! let mut live = compiled.live();
//! if let Some(mut physics) = Physics::prepare(&gpu, &compiled, &live)? {
//!     for _ in 0..60 {
//!         let before = live.clone();
//!         live.time += 1.0 / 60.0;
//!         physics.step(&compiled, &before, &live)?;
//!     }
//!     let balls = physics.read()?; // or draw from physics.buffer()
//!     println!("{:?}", balls.first());
//! }
//! # Ok(())
//! # }
//! ```

mod buffers;
mod contact;
mod state;

pub use contact::Contact;
pub use state::BALL_SIZE;

use crate::gpu::Gpu;
use crate::readback::{read, wait};
use buffers::{Balls, Layout};
use state::{ANOTHER, BY_HAND, BY_TIME, Cell, STILL, Step};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::{Compiled, Live};
use surefoot_compiler::physics::{Ball, Law, MEETINGS, meet, spawn};

/// Balls of a scene on a device.
#[derive(Debug)]
pub struct Physics {
    gpu: Gpu,
    passes: Arc<Passes>,
    contact: Contact,
    balls: Balls,
    /// Another field is below the balls than in the last step.
    anew: bool,
    steps: u64,
    version: u64,
    /// Seconds that have passed, and no step yet.
    owed: f64,
    /// The field's values at the end of the last step.
    last: Option<Live>,
    /// What a step took, in nanoseconds.
    cost: Arc<AtomicU64>,
    /// A ball that a hand holds, and where it pulls it to.
    held: Option<(u32, [f64; 3])>,
}

/// The passes over balls that no scene changes. Built once for a device.
#[derive(Debug)]
pub struct Passes {
    layout: Layout,
    count: wgpu::ComputePipeline,
    scan_blocks: wgpu::ComputePipeline,
    scan_sums: wgpu::ComputePipeline,
    scatter: wgpu::ComputePipeline,
    put_in_order: wgpu::ComputePipeline,
    neighbours: wgpu::ComputePipeline,
    meet: wgpu::ComputePipeline,
}

/// Seconds of a step where time passes by itself.
pub const STEP: f64 = 1.0 / 60.0;

impl Physics {
    /// The balls of a scene where they begin; none where the scene has no balls, and then nothing is built.
    pub fn prepare(gpu: &Gpu, compiled: &Compiled, live: &Live) -> Result<Option<Self>, String> {
        if !compiled.has_balls() {
            return Ok(None);
        }
        Self::with(gpu, compiled, &spawn::spawn(&compiled.groups(live))).map(Some)
    }

    /// Given balls over a scene's field, whether the scene has balls or not.
    pub fn with(gpu: &Gpu, compiled: &Compiled, balls: &[Ball]) -> Result<Self, String> {
        let passes = Arc::new(Passes::new(gpu)?);
        let contact = Contact::prepare(gpu, compiled)?;
        Self::start(gpu, passes, contact, balls)
    }

    /// Given balls, with code that was built before: on another thread, or for other balls.
    pub fn start(gpu: &Gpu, passes: Arc<Passes>, contact: Contact, balls: &[Ball]) -> Result<Self, String> {
        let balls = gpu.catch(|| Balls::new(gpu, &passes.layout, &cells(balls)))?;
        Ok(Self { gpu: gpu.clone(), passes, contact, balls, anew: false, steps: 0, version: 0, owed: 0.0, last: None, cost: Arc::default(), held: None })
    }

    /// Puts other contact code in; the balls stay as they are, bit by bit, and those that sleep wake.
    pub fn put(&mut self, contact: Contact) {
        self.contact = contact;
        self.anew = true;
        self.last = None;
    }

    /// How many balls there are, those that left the scene among them.
    pub fn count(&self) -> u32 {
        self.balls.count()
    }

    /// Steps so far.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// A number that is another one whenever the balls may be.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// What a step of the newest [`Physics::advance`] took, from the order to its end.
    pub fn cost(&self) -> Duration {
        Duration::from_nanos(self.cost.load(Ordering::Relaxed))
    }

    /// The buffer with the balls as they are now, [`BALL_SIZE`] bytes each: position and radius, velocity and a word whose lower half is the
    /// group and whose bit 17 says that the ball is gone, angular velocity and four bytes, and sixteen bytes more.
    pub fn buffer(&self) -> &wgpu::Buffer {
        self.balls.current()
    }

    /// Waits until all that was ordered is done.
    pub fn wait(&self) -> Result<(), String> {
        wait(&self.gpu, self.gpu.queue().submit([]))
    }

    /// The balls as they are now.
    pub fn read(&self) -> Result<Vec<Ball>, String> {
        let size = BALL_SIZE * u64::from(self.count());
        if size == 0 {
            return Ok(Vec::new());
        }
        let (copy, submitted) = self.gpu.catch(|| {
            let copy = self.gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: Some("surefoot balls, read"),
                size,
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            });
            let mut encoder = self.gpu.device().create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(self.balls.current(), 0, &copy, 0, size);
            (copy, self.gpu.queue().submit([encoder.finish()]))
        })?;
        let bytes = read(&self.gpu, &copy, submitted)?;
        Ok(bytemuck::pod_collect_to_vec::<u8, Cell>(&bytes).iter().map(Cell::ball).collect())
    }

    /// Replaces all balls.
    pub fn write(&mut self, balls: &[Ball]) -> Result<(), String> {
        self.balls = self.gpu.catch(|| Balls::new(&self.gpu, &self.passes.layout, &cells(balls)))?;
        self.held = self.held.filter(|(index, _)| (*index as usize) < balls.len());
        self.version += 1;
        Ok(())
    }

    /// Adds balls to those that are there.
    pub fn add(&mut self, more: &[Ball]) -> Result<(), String> {
        let mut balls = self.read()?;
        balls.extend_from_slice(more);
        balls.truncate(surefoot_compiler::physics::MOST_BALLS as usize);
        self.write(&balls)
    }

    /// Takes a ball by its index and pulls it to a place from now on; what stands in the way stops it.
    pub fn hold(&mut self, index: u32, place: [f64; 3]) {
        self.held = (index < self.count()).then_some((index, place));
    }

    /// Lets go of the ball that is held, with a velocity.
    pub fn throw(&mut self, velocity: [f64; 3]) {
        if let Some((index, _)) = self.held.take() {
            let at = u64::from(index) * BALL_SIZE + std::mem::offset_of!(Cell, velocity) as u64;
            self.gpu.queue().write_buffer(self.balls.current(), at, bytemuck::bytes_of(&velocity.map(|c| c as f32)));
            self.version += 1;
        }
    }

    /// The ball that is held.
    pub fn held(&self) -> Option<u32> {
        self.held.map(|(index, _)| index)
    }

    /// Orders a step from one moment to another; `compiled` is the scene that the contact was made of. Does not wait for it.
    pub fn step(&mut self, compiled: &Compiled, before: &Live, now: &Live) -> Result<(), String> {
        self.step_by(compiled, &compiled.law(now), before, now)
    }

    /// The same with another law than the scene's.
    pub fn step_by(&mut self, compiled: &Compiled, law: &Law, before: &Live, now: &Live) -> Result<(), String> {
        self.step_for(compiled, law, before, now, now.time - before.time)
    }

    /// Lets `seconds` pass for the balls, in steps of [`STEP`], of which at most so many are ordered now: a slow device falls behind, and
    /// does not stop the window. Meanwhile the field goes from where it was at the last call to `now`. Answers how many steps were ordered.
    pub fn advance(&mut self, compiled: &Compiled, now: &Live, seconds: f64, most: u32) -> Result<u32, String> {
        self.owed += seconds.max(0.0);
        let behind = self.owed;
        let steps = ((self.owed / STEP + 1e-6).floor() as u32).min(most);
        if self.owed > STEP * f64::from(most) {
            self.owed = STEP * f64::from(most);
        }
        if steps == 0 {
            // What the field did before anyone looked is nothing that pushes.
            self.last.get_or_insert_with(|| now.clone());
            return Ok(0);
        }
        let start = self.last.take().filter(|last| last.components.len() == now.components.len()).unwrap_or_else(|| now.clone());
        // The field goes as far as the balls do, or a surface would push faster than it is; where the device falls behind it goes on.
        let share = if steps == most { 1.0 } else { (STEP * f64::from(steps) / behind).min(1.0) };
        let law = compiled.law(now);
        let ordered = Instant::now();
        for step in 0..steps {
            let at = |step: u32| start.between(now, share * f64::from(step) / f64::from(steps));
            self.step_for(compiled, &law, &at(step), &at(step + 1), STEP)?;
            self.owed = (self.owed - STEP).max(0.0);
        }
        self.last = Some(start.between(now, share));
        let cost = self.cost.clone();
        self.gpu.queue().on_submitted_work_done(move || {
            let each = ordered.elapsed() / steps;
            cost.store(each.as_nanos() as u64, Ordering::Relaxed);
        });
        Ok(steps)
    }

    fn step_for(&mut self, compiled: &Compiled, law: &Law, before: &Live, now: &Live, seconds: f64) -> Result<(), String> {
        if self.count() == 0 || seconds <= 0.0 {
            return Ok(());
        }
        let parts = law.substeps;
        let changes = self.contact.write_moments(&self.gpu, compiled, before, now, parts);
        let moves = match (self.anew, changes) {
            (true, _) => ANOTHER,
            (false, false) => STILL,
            (false, true) if before.components == now.components => BY_TIME,
            (false, true) => BY_HAND,
        };
        let h = seconds / f64::from(parts);
        let step = self.numbers(law, h, moves);
        let gpu = self.gpu.clone();
        gpu.catch(|| {
            self.balls.write_step(gpu.queue(), bytemuck::bytes_of(&step));
            let mut encoder = gpu.device().create_command_encoder(&Default::default());
            for part in 0..parts {
                self.order(&mut encoder, part);
            }
            gpu.queue().submit([encoder.finish()]);
        })?;
        self.anew = false;
        self.steps += 1;
        self.version += 1;
        Ok(())
    }

    fn numbers(&self, law: &Law, h: f64, moves: u32) -> Step {
        let narrow = |v: [f64; 3]| v.map(|c| c as f32);
        let [low, high] = law.walls.unwrap_or([[0.0; 3]; 2]);
        Step {
            gravity: narrow(law.gravity),
            h: h as f32,
            low: narrow(low),
            restitution: law.restitution as f32,
            high: narrow(high),
            friction: law.friction as f32,
            rolling: law.rolling as f32,
            rest: law.rest(h) as f32,
            extent: law.extent as f32,
            side: meet::cell_side(f64::from(self.balls.most())) as f32,
            count: self.count(),
            mask: self.balls.buckets() - 1,
            walls: u32::from(law.walls.is_some()),
            moves,
            place: narrow(self.held.map_or([0.0; 3], |(_, place)| place)),
            held: self.held.map_or(u32::MAX, |(index, _)| index),
        }
    }

    /// A part of a step.
    fn order(&mut self, encoder: &mut wgpu::CommandEncoder, part: u32) {
        let (count, buckets) = (self.count(), self.balls.buckets());
        encoder.clear_buffer(self.balls.counts(), 0, None);
        let mut pass = encoder.begin_compute_pass(&Default::default());
        let passes = &self.passes;
        let each = count.div_ceil(64);
        pass.set_bind_group(1, self.balls.group(), &[]);
        for (pipeline, groups) in [
            (&passes.count, each),
            (&passes.scan_blocks, buckets / 256),
            (&passes.scan_sums, 1),
            (&passes.scatter, each),
            (&passes.put_in_order, buckets / 64),
            (&passes.neighbours, each),
        ] {
            pass.set_pipeline(pipeline);
            pass.dispatch_workgroups(groups, 1, 1);
        }
        pass.set_pipeline(&passes.meet);
        for _ in 0..MEETINGS {
            pass.set_bind_group(1, self.balls.group(), &[]);
            pass.dispatch_workgroups(each, 1, 1);
            self.balls.trade();
        }
        self.contact.bind(&mut pass, part);
        pass.set_bind_group(1, self.balls.group(), &[]);
        pass.dispatch_workgroups(each, 1, 1);
        self.balls.trade();
    }
}

fn cells(balls: &[Ball]) -> Vec<Cell> {
    balls.iter().map(Cell::of).collect()
}

impl Passes {
    /// Builds them for a device.
    pub fn new(gpu: &Gpu) -> Result<Self, String> {
        let wgsl = [include_str!("ball.wgsl"), include_str!("state.wgsl"), include_str!("grid.wgsl")].join("\n");
        gpu.catch(|| {
            let layout = Layout::new(gpu);
            let pass = |entry| gpu.compute_pipeline("surefoot balls", &wgsl, entry, &[None, Some(layout.balls())]);
            Ok(Self {
                count: pass("count")?,
                scan_blocks: pass("scan_blocks")?,
                scan_sums: pass("scan_sums")?,
                scatter: pass("scatter")?,
                put_in_order: pass("put_in_order")?,
                neighbours: pass("neighbours")?,
                meet: pass("meet")?,
                layout,
            })
        })?
    }
}
