//! The steps that a shader's own loop takes by a function that a scene uses: which holes they leave, and what would do.

use crate::files::{self, FileLoader};
use crate::picture::{Device, Painter, Shot, write_png};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;
use surefoot_compiler::by_hand::{ByHand, by_hand};
use surefoot_compiler::compiled::Compiled;
use surefoot_compiler::program::load::translate;
use surefoot_compiler::reference::View;
use surefoot_compiler::sampled::{Grid, Settings};
use surefoot_compiler::shader::Language;
use surefoot_compiler::source::Sources;
use surefoot_compiler::{Loader, Options, Outcome};

/// A function of a shader, and what becomes of rays that step by a share of its value.
pub struct Stepped {
    /// The shader's file, and the line where the share is written; 0 where it has no loop along a ray.
    place: (String, u32),
    /// The function.
    function: String,
    /// The share: 1 where none is written.
    share: f64,
    found: ByHand,
    /// A scene that is that function alone.
    alone: Compiled,
}

/// Width and height of the picture whose rays are followed.
const RAYS: (u32, u32) = (96, 72);
/// Width and height of each half of the picture that shows the holes.
const HALF: (u32, u32) = (400, 300);
/// The colour of a hole.
const HOLE: [u8; 4] = [255, 0, 80, 255];

/// A scene beside the shader that is that function alone.
struct Alone(String);

/// No file has this name.
const MAIN: &str = "<check>";

impl Loader for Alone {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        if path == MAIN { Ok(self.0.clone().into_bytes()) } else { FileLoader.read(path) }
    }

    fn grid(&self, path: &str, settings: Settings) -> Result<Arc<Grid>, String> {
        FileLoader.grid(path, settings)
    }
}

/// The functions of the shaders that a scene has read which give back a distance and are stepped by, or are called `map`.
pub fn stepped(scene: &Compiled, outcome: &Outcome) -> Vec<Stepped> {
    outcome.files.iter().flat_map(|file| of_shader(scene, file).unwrap_or_default()).collect()
}

fn of_shader(scene: &Compiled, file: &str) -> Option<Vec<Stepped>> {
    let language = Language::of(file)?;
    let text = String::from_utf8(files::read(Path::new(file)).ok()?).ok()?;
    let made = translate(file, &text, language).ok()?;
    let mut sources = Sources::default();
    let id = sources.add(file, text.as_str());
    let mut all = Vec::new();
    for function in made.functions.iter().filter(|function| function.is_distance() && (function.step.is_some() || function.name == "map")) {
        let (share, line) = match &function.step {
            Some((share, range)) => (*share, sources.position(id, range.start as u32).1),
            None => (1.0, 0),
        };
        let main = format!("scene = shader({file:?}, {})\nrender {{ extent: {} }}", function.name, scene.blocks.extent);
        let outcome = surefoot_compiler::compile(&Alone(main), MAIN, &Options::default());
        let Some(alone) = outcome.compiled else { continue };
        let Ok(found) = by_hand(&alone, &outcome.diagnostics, &alone.live(), share, RAYS) else { continue };
        all.push(Stepped { place: (file.to_owned(), line), function: function.name.clone(), share, found, alone });
    }
    Some(all)
}

impl Stepped {
    /// For a person.
    pub fn words(&self) -> String {
        let Self { place: (file, line), function, share, found, .. } = self;
        let (place, steps, s) = match line {
            0 => (file.clone(), format!("rays that step by the whole of `{function}`"), ""),
            line => (format!("{file}:{line}"), format!("your {share} of `{function}`"), "s"),
        };
        let proven = found.proven.map(rounded_down);
        if let Some((at, _)) = found.holes.first() {
            let [x, y, z] = at.map(|c| format!("{c:.2}"));
            let would = proven.map_or("no share is proven for the whole function".to_owned(), |proven| format!("{proven} is proven"));
            return format!("{place}: {steps} leave{s} holes at ({x}, {y}, {z}) and elsewhere: {} of {} rays pass through the solid; {would}", found.holes.len(), found.rays);
        }
        match proven {
            Some(proven) if proven >= 1.05 * share => format!("{place}: {steps} leave{s} no hole, and {proven} would do: it is proven"),
            Some(proven) if proven >= *share => format!("{place}: {steps} leave{s} no hole: that is proven"),
            Some(proven) => format!("{place}: {steps} leave{s} no hole that {} rays find; {proven} is proven for the whole function", found.rays),
            None => format!("{place}: {steps} leave{s} no hole that {} rays find; no share is proven for the whole function", found.rays),
        }
    }

    /// Draws the function twice: as rays find it that step by the share, with its holes in red, and as rays find it by its bound.
    pub fn draw(&self, path: &Path) -> Result<(), String> {
        let (live, (width, height)) = (self.alone.live(), HALF);
        let (mut painter, _) = Painter::new(Device::Cpu, &self.alone, View::Shaded, None, Some(1)).map_err(|_| "the processor draws no picture".to_owned())?;
        let camera = self.alone.frame(&live).cameras.first().map(|(_, camera)| *camera).ok_or("there is no camera")?;
        let whole = painter.paint(&self.alone, &live, &Shot::new((width, height), camera), &|_| {})?;
        let found = by_hand(&self.alone, &[], &live, self.share, HALF).map_err(|_| "the function is too large to follow rays through it".to_owned())?;
        let mut holed = whole.clone();
        for (_, [x, y]) in &found.holes {
            let at = 4 * (*y as usize * width as usize + *x as usize);
            holed[at..at + 4].copy_from_slice(&HOLE);
        }
        let row = 4 * width as usize;
        let both: Vec<u8> = holed.chunks_exact(row).zip(whole.chunks_exact(row)).flat_map(|(a, b)| [a, b].concat()).collect();
        write_png(path, 2 * width, height, &both)
    }

    /// For a machine.
    pub fn in_json(&self) -> Value {
        json!({
            "file": self.place.0,
            "line": (self.place.1 > 0).then_some(self.place.1),
            "function": self.function,
            "share": self.share,
            "proven": self.found.proven,
            "rays": self.found.rays,
            "holes": self.found.holes.iter().map(|(at, _)| at).collect::<Vec<_>>(),
        })
    }
}

/// A share with three digits that is no larger.
fn rounded_down(share: f64) -> f64 {
    let digits = 10f64.powi(2 - share.log10().floor() as i32);
    (share * digits).floor() / digits
}
