//! What made a pixel of the picture: found on another thread, for the scene and the moment at which a person pointed there.

use crate::marched::Slice;
use crate::window::places::{Place, place};
use egui::{ColorImage, TextureHandle};
use std::cell::OnceCell;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use surefoot_compiler::compiled::{Compiled, Live};
use surefoot_compiler::pick::{Made, held, pick};
use surefoot_compiler::reference::Reference;
use surefoot_compiler::reference::march::Ray;
use surefoot_compiler::reference::shade::Seen;
use surefoot_compiler::reference::steps::March;
use surefoot_runtime::live::Words;

/// Width and height of the slice's picture, in pixels.
pub const SLICE: (u32, u32) = (760, 400);

/// A pixel of the picture, and the scene as it was drawn.
#[derive(Clone)]
pub struct Asked {
    /// The scene.
    pub scene: Arc<Compiled>,
    /// Its values and its moment.
    pub live: Live,
    /// What the compiler said of its text.
    pub words: Arc<Words>,
    /// The ray through the middle of the pixel.
    pub ray: Ray,
    /// The width of a pixel at distance one.
    pub footprint: f64,
    /// What is up in the picture.
    pub up: [f64; 3],
    /// The slice shows the march from this step on.
    pub from: usize,
}

/// A place of the text that made the pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Where it stands.
    pub place: Place,
    /// What it is called.
    pub name: String,
    /// As it is written.
    pub text: String,
    /// Whether it is what is taken away there.
    pub cuts: bool,
}

/// What was found.
pub struct Found {
    /// Of which scene and moment.
    pub asked: Asked,
    /// The point, the normal and the way there; none where nothing is seen.
    pub seen: Option<Seen>,
    /// What made the pixel, from the outside in.
    pub parts: Vec<Part>,
    /// The steps of its ray.
    pub march: March,
    /// What holds the ray back at each of them, in words, and where that stands.
    pub held: Vec<Option<(String, Place)>>,
    /// The slice through the ray, and its picture.
    pub slice: Slice,
    image: Arc<ColorImage>,
    texture: OnceCell<TextureHandle>,
}

impl Found {
    /// The picture of the slice.
    pub fn texture(&self, ctx: &egui::Context) -> egui::TextureId {
        self.texture.get_or_init(|| ctx.load_texture("slice", self.image.clone(), egui::TextureOptions::LINEAR)).id()
    }

    /// Whether that is of the scene that is drawn now, but for the time.
    pub fn is_of(&self, scene: Option<&Arc<Compiled>>, live: Option<&Live>) -> bool {
        let same = scene.is_some_and(|scene| Arc::ptr_eq(scene, &self.asked.scene));
        same && live.is_some_and(|live| live.components == self.asked.live.components)
    }
}

/// The pixel that a person points at.
#[derive(Default)]
pub struct Looking {
    work: Option<Receiver<Result<Found, String>>>,
    /// What was found last, or why nothing was.
    pub found: Option<Result<Found, String>>,
    /// The step of the ray that stands out.
    pub chosen: Option<usize>,
    /// The point that was picked before that.
    pub before: Option<[f64; 3]>,
    /// Whether the text goes to what is found.
    jumps: bool,
}

impl Looking {
    /// Begins; what was asked before is given up.
    pub fn begin(&mut self, asked: Asked) {
        self.before = self.point();
        self.chosen = None;
        self.jumps = true;
        self.ask(asked);
    }

    /// The point that was picked.
    pub fn point(&self) -> Option<[f64; 3]> {
        Some(self.found.as_ref()?.as_ref().ok()?.seen?.point)
    }

    /// Whether it is of the scene that is drawn now, but for the time.
    pub fn is_of(&self, scene: Option<&Arc<Compiled>>, live: Option<&Live>) -> bool {
        self.found.as_ref().is_some_and(|found| found.as_ref().is_ok_and(|found| found.is_of(scene, live)))
    }

    /// Shows the march from a step on.
    pub fn closer(&mut self, from: usize) {
        if let Some(Ok(found)) = &self.found {
            let asked = Asked { from, ..found.asked.clone() };
            self.jumps = false;
            self.ask(asked);
        }
    }

    fn ask(&mut self, asked: Asked) {
        let (sender, answer) = channel();
        let find = move || {
            // The window may be closed by now, or another pixel asked for.
            let _ = sender.send(find(asked));
        };
        // Where there can be no thread the sender is gone, and that is said.
        let _ = std::thread::Builder::new().name("surefoot look".to_owned()).spawn(find);
        self.work = Some(answer);
    }

    /// Whether it is being looked for.
    pub fn is_busy(&self) -> bool {
        self.work.is_some()
    }

    /// Takes what is found. The answer: the place of the text that shall be shown for it.
    pub fn hear(&mut self) -> Option<Place> {
        let found = match self.work.as_ref()?.try_recv() {
            Err(TryRecvError::Empty) => return None,
            Ok(found) => found,
            Err(TryRecvError::Disconnected) => Err("it could not be looked for".to_owned()),
        };
        self.work = None;
        let shown = found.as_ref().ok().filter(|_| self.jumps).and_then(|found| found.parts.last()).map(|part| part.place.clone());
        self.found = Some(found);
        shown
    }
}

fn find(asked: Asked) -> Result<Found, String> {
    let Asked { scene, live, words, ray, footprint, up, from } = &asked;
    let reference = Reference::new(scene, live).map_err(|why| why.to_string())?;
    let seen = reference.seen(&[*ray], *footprint, scene.blocks.extent).pop().map(|(_, seen)| seen);
    let made = seen.map(|seen| pick(scene, live, seen.point).made(&words.sources)).unwrap_or_default();
    let part = |made: Made| Part { place: place(words, made.span), name: made.name, text: made.text, cuts: made.cuts };
    let parts = made.into_iter().map(part).collect();
    let march = reference.march_of(ray, *footprint, scene.blocks.extent);
    let held = held(scene, live, &words.sources, march.steps.iter().map(|step| step.point));
    let held = held.into_iter().map(|held| held.map(|held| (held.words(), place(words, held.made.span)))).collect();
    let slice = Slice::of(ray, &march, *up, *from, SLICE);
    let pixels = slice.draw(&reference, &march);
    let image = Arc::new(ColorImage::from_rgba_unmultiplied([SLICE.0 as usize, SLICE.1 as usize], &pixels));
    Ok(Found { asked, seen, parts, march, held, slice, image, texture: OnceCell::new() })
}
