//! What stays while scenes come and go: the values of the parameters, time, and whether there is anything new to draw.

use crate::frame::Picture;
use crate::live::Ready;
use crate::tighten::Tightening;
use crate::view::View;
use std::sync::Arc;
use surefoot_compiler::compiled::{Compiled, Live, Parameter};
use surefoot_compiler::graph::{Leaf, Node, NodeId};

/// The scene that is on, with its live values.
#[derive(Debug, Default)]
pub struct Stage {
    scene: Option<Arc<Compiled>>,
    picture: Option<Picture>,
    live: Option<Live>,
    time: f64,
    /// Whether time runs.
    pub playing: bool,
    animated: bool,
    fresh: bool,
    tightening: Option<Tightening>,
}

impl Stage {
    /// An empty stage.
    pub fn new() -> Self {
        Self::default()
    }

    /// Puts a new scene on. A parameter that it shares with the old one, by its name, keeps the value that a person gave it.
    pub fn put(&mut self, ready: Ready) {
        let mut live = match (&self.scene, &self.live) {
            (Some(old), Some(live)) => carry_over(old, live, &ready.compiled),
            _ => ready.compiled.live(),
        };
        live.time = self.time;
        self.animated = reads_time(&ready.compiled);
        self.live = Some(live);
        self.tightening = Tightening::start(ready.compiled.clone());
        self.scene = Some(ready.compiled);
        self.picture = ready.picture;
        self.fresh = true;
    }

    /// The scene that is on.
    pub fn scene(&self) -> Option<&Arc<Compiled>> {
        self.scene.as_ref()
    }

    /// Its parameters' values and the time.
    pub fn live(&self) -> Option<&Live> {
        self.live.as_ref()
    }

    /// What draws it.
    pub fn picture(&self) -> Option<&Picture> {
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

    /// Lets so many seconds pass, if time runs.
    pub fn advance(&mut self, seconds: f64) {
        if self.playing {
            self.set_time(self.time + seconds);
        }
    }

    /// Whether the next frame differs from this one though nobody touches anything: time runs, and the scene reads it.
    pub fn animates(&self) -> bool {
        self.playing && self.animated
    }

    /// Writes to the GPU what changed since the last call. Answers whether there is anything new to draw: where not, the last picture
    /// is still the right one.
    pub fn update(&mut self, queue: &wgpu::Queue, view: &View) -> bool {
        let (Some(scene), Some(live), Some(picture)) = (&self.scene, &mut self.live, &mut self.picture)
        else {
            return false;
        };
        if let Some(factors) = self.tightening.as_ref().and_then(Tightening::newest) {
            live.tightened = factors;
        }
        scene.follow(live, Compiled::QUICK);
        let changed = picture.update(queue, scene, live, view);
        std::mem::take(&mut self.fresh) || changed
    }
}

/// The live values of a new scene: what a person moved in the old one stays, within the new range; what nobody moved follows the text.
pub fn carry_over(old: &Compiled, live: &Live, new: &Compiled) -> Live {
    let mut carried = new.live();
    carried.time = live.time;
    for parameter in &new.parameters {
        let same = |p: &&Parameter| p.name == parameter.name && p.ty == parameter.ty;
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

/// Whether anything in a scene changes with time.
pub fn reads_time(compiled: &Compiled) -> bool {
    let graph = &compiled.graph;
    (0..graph.len()).any(|i| matches!(graph.node(NodeId(i as u32)), Node::Leaf(Leaf::Time)))
}
