//! What stays while scenes come and go: the values of the parameters, time, and whether there is anything new to draw.

use crate::frame::Picture;
use crate::gpu::Gpu;
use crate::live::Ready;
use crate::physics::{Contact, Passes, Physics, STEP};
use crate::tighten::Tightening;
use crate::view::View;
use std::sync::{Arc, Mutex, PoisonError};
use surefoot_compiler::compiled::{Compiled, Live, Parameter};
use surefoot_compiler::physics::{Group, spawn};
use surefoot_compiler::section::Section;

/// The scene that is on, with its live values.
#[derive(Debug, Default)]
pub struct Stage {
    scene: Option<Arc<Compiled>>,
    picture: Option<Arc<Mutex<Picture>>>,
    live: Option<Live>,
    time: f64,
    /// Where the plane of a slice is.
    slice: f64,
    /// The plane that cuts the picture open.
    section: Option<Section>,
    /// Where the divider of two views is, in parts of the picture's width.
    divider: f32,
    /// Whether time runs.
    pub playing: bool,
    animated: bool,
    fresh: bool,
    tightening: Option<Tightening>,
    balls: Option<Physics>,
    /// Seconds that have passed for the balls since the last update.
    passed: f64,
    /// What went wrong with them.
    trouble: Option<String>,
}

/// So many steps of the balls are ordered for a frame at most; on a device that is slower the time of their scene passes slowly.
const MOST_STEPS: u32 = 3;

impl Stage {
    /// An empty stage.
    pub fn new() -> Self {
        Self { divider: 0.5, ..Self::default() }
    }

    /// Puts a new scene on. A parameter that it shares with the old one, by its name, keeps the value that a person gave it, unless the
    /// text gives it another one than before.
    pub fn put(&mut self, ready: Ready) {
        let mut live = match (&self.scene, &self.live) {
            (Some(old), Some(live)) => carry_over(old, live, &ready.compiled),
            _ => ready.compiled.live(),
        };
        live.time = self.time;
        live.slice = self.slice;
        live.section = self.section;
        self.animated = ready.compiled.reads_time();
        let parts = (ready.balls, ready.picture.as_ref().map(|p| p.gpu().clone()));
        self.trouble = match parts {
            (Some((passes, contact)), Some(gpu)) => self.put_balls(&gpu, &ready.compiled, &live, passes, contact).err(),
            _ => {
                self.balls = None;
                None
            }
        };
        self.live = Some(live);
        self.tightening = Tightening::start(ready.compiled.clone());
        self.scene = Some(ready.compiled);
        self.picture = ready.picture.map(|picture| Arc::new(Mutex::new(picture)));
        self.fresh = true;
    }

    /// Puts another contact below the balls, which keep every bit; where the text lets other balls begin, those begin.
    fn put_balls(&mut self, gpu: &Gpu, new: &Compiled, live: &Live, passes: Arc<Passes>, contact: Contact) -> Result<(), String> {
        let groups = new.groups(live);
        let same = |old: &Compiled, was: &Live| {
            let begun = |groups: &[Group]| groups.iter().map(Group::beginning).collect::<Vec<_>>();
            begun(&old.groups(was)) == begun(&groups)
        };
        let kept = self.scene.as_ref().zip(self.live.as_ref()).is_some_and(|(old, was)| same(old, was));
        match &mut self.balls {
            Some(balls) if kept => balls.put(contact),
            balls => *balls = Some(Physics::start(gpu, passes, contact, &spawn::spawn(&groups))?),
        }
        Ok(())
    }

    /// The balls of the scene, where it has some.
    pub fn balls(&self) -> Option<&Physics> {
        self.balls.as_ref()
    }

    /// What went wrong with the balls, if anything.
    pub fn trouble(&self) -> Option<&str> {
        self.trouble.as_deref()
    }

    /// Lets the balls make a step though time stands.
    pub fn step_balls(&mut self) {
        self.passed += STEP;
        self.fresh = true;
    }

    /// Puts the balls back to where they begin.
    pub fn reset_balls(&mut self) {
        if let (Some(scene), Some(live), Some(balls)) = (&self.scene, &self.live, &mut self.balls) {
            self.trouble = balls.write(&spawn::spawn(&scene.groups(live))).err();
            self.fresh = true;
        }
    }

    /// Adds balls of the first group in a box about a place.
    pub fn drop_balls(&mut self, place: [f64; 3], count: u32) {
        let (Some(scene), Some(live), Some(balls)) = (&self.scene, &self.live, &mut self.balls) else { return };
        let Some(group) = scene.groups(live).into_iter().next() else { return };
        // As many cells a side as hold them.
        let side = f64::from(count).cbrt().ceil() * 1.1 * group.radius[1];
        let spawn = [place.map(|c| c - side), place.map(|c| c + side)];
        // Other balls each time.
        let seed = group.seed.wrapping_add(balls.count());
        let more = spawn::spawn(&[Group { count, spawn, seed, velocity: [0.0; 3], ..group }]);
        self.trouble = balls.add(&more).err();
        self.fresh = true;
    }

    /// Takes a ball and pulls it to a place from now on.
    pub fn hold_ball(&mut self, index: u32, place: [f64; 3]) {
        if let Some(balls) = &mut self.balls {
            balls.hold(index, place);
        }
    }

    /// Lets go of the ball that is held, with a velocity.
    pub fn throw_ball(&mut self, velocity: [f64; 3]) {
        if let Some(balls) = &mut self.balls {
            balls.throw(velocity);
        }
    }

    /// The scene that is on.
    pub fn scene(&self) -> Option<&Arc<Compiled>> {
        self.scene.as_ref()
    }

    /// Its parameters' values and the time.
    pub fn live(&self) -> Option<&Live> {
        self.live.as_ref()
    }

    /// What draws it; another thread may draw with it too.
    pub fn picture(&self) -> Option<&Arc<Mutex<Picture>>> {
        self.picture.as_ref()
    }

    /// The components of a parameter. None where the scene has no such number.
    pub fn value(&self, parameter: &Parameter) -> Option<&[f64]> {
        let live = self.live.as_ref()?;
        let first = parameter.first? as usize;
        live.components.get(first..first + parameter.default.len())
    }

    /// Gives a parameter a value, clamped to its range. Answers whether the scene has it.
    pub fn set(&mut self, name: &str, value: &[f64]) -> bool {
        let (Some(scene), Some(live)) = (&self.scene, &mut self.live) else { return false };
        let Some(parameter) = scene.parameters.iter().find(|p| p.name == name) else {
            return false;
        };
        write(parameter, value, live)
    }

    /// Seconds since the scene began to play.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Goes to a moment.
    pub fn set_time(&mut self, seconds: f64) {
        self.time = if seconds.is_finite() { seconds } else { 0.0 };
        if let Some(live) = &mut self.live {
            live.time = self.time;
        }
    }

    /// Puts the plane of a slice to a place along its axis.
    pub fn set_slice(&mut self, at: f64) {
        self.slice = if at.is_finite() { at } else { 0.0 };
        if let Some(live) = &mut self.live {
            live.slice = self.slice;
        }
    }

    /// Puts the plane that cuts the picture open to a place. Whether it cuts, and which side stays, is of what draws the picture.
    pub fn set_section(&mut self, section: Option<Section>) {
        self.section = section;
        if let Some(live) = &mut self.live {
            live.section = section;
        }
    }

    /// Puts the divider of two views to a part of the picture's width.
    pub fn divide(&mut self, share: f32) {
        self.divider = share;
    }

    /// Where along its axis the plane of a slice is.
    pub fn slice(&self) -> f64 {
        self.slice
    }

    /// Lets so many seconds pass, if time runs: fewer where the balls can't follow, or what moves would hit them faster than it goes.
    pub fn advance(&mut self, seconds: f64) {
        if self.playing {
            let seconds = if self.balls.is_some() { seconds.min(STEP * f64::from(MOST_STEPS)) } else { seconds };
            self.set_time(self.time + seconds);
            self.passed += seconds;
        }
    }

    /// Whether the next frame differs from this one though nobody touches anything: time runs, and the scene reads it or has balls.
    pub fn animates(&self) -> bool {
        self.playing && (self.animated || self.balls.is_some())
    }

    /// Whether gentler factors for where the parameters stand are being looked for.
    pub fn settles(&self) -> bool {
        self.tightening.is_some() && self.scene.as_ref().zip(self.live.as_ref()).is_some_and(|(scene, live)| scene.can_settle(live))
    }

    /// Writes to the GPU what changed since the last call. Answers whether there is anything new to draw: where not, the last picture
    /// is still the right one.
    pub fn update(&mut self, queue: &wgpu::Queue, view: &View) -> bool {
        let (Some(scene), Some(live), Some(picture)) = (&self.scene, &mut self.live, &self.picture)
        else {
            return false;
        };
        if self.tightening.as_ref().is_some_and(|tightening| !tightening.take(live)) {
            self.tightening = None;
        }
        if scene.follow(live, Compiled::QUICK) && scene.can_settle(live) {
            self.tightening.iter().for_each(|tightening| tightening.ask(live));
        }
        let mut picture = picture.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(balls) = &mut self.balls {
            match balls.advance(scene, live, std::mem::take(&mut self.passed), MOST_STEPS) {
                Ok(steps) => self.fresh |= steps > 0,
                Err(error) => self.trouble = Some(error),
            }
            picture.show_balls(scene, live, Some(balls));
        }
        let divided = picture.divide(self.divider);
        let changed = picture.update(queue, scene, live, view) || divided;
        std::mem::take(&mut self.fresh) || changed
    }
}

/// The live values of a new scene: what a person moved in the old one stays, within the new range; what nobody moved, and what the text
/// gives another value than before, follows the text.
pub fn carry_over(old: &Compiled, live: &Live, new: &Compiled) -> Live {
    let mut carried = new.live();
    carried.time = live.time;
    for parameter in &new.parameters {
        let same = |p: &&Parameter| p.name == parameter.name && p.ty == parameter.ty && p.default == parameter.default;
        let Some(before) = old.parameters.iter().find(same) else { continue };
        let Some(first) = before.first.map(|f| f as usize) else { continue };
        let value = live.components.get(first..first + before.default.len());
        if let Some(value) = value.filter(|v| *v != before.default) {
            write(parameter, value, &mut carried);
        }
    }
    carried
}

fn write(parameter: &Parameter, value: &[f64], live: &mut Live) -> bool {
    let Some(first) = parameter.first.map(|f| f as usize) else { return false };
    let Some(slots) = live.components.get_mut(first..first + parameter.default.len()) else {
        return false;
    };
    let ranges = parameter.min.iter().zip(&parameter.max);
    for ((slot, value), (&min, &max)) in slots.iter_mut().zip(value).zip(ranges) {
        // `max` and `min` and not `clamp`, which panics where a range is empty.
        if value.is_finite() {
            *slot = value.max(min).min(max);
        }
    }
    true
}
