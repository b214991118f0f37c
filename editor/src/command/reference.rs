//! `surefoot reference`: writes the language's reference from the compiler's own tables, with its pictures.

use super::console::{Exit, Failure, print};
use super::grammar;
use crate::files;
use crate::picture::write_png;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use surefoot_compiler::graph::Proof;
use surefoot_compiler::reference::film::{dither, level};
use surefoot_compiler::reference::{Area, Reference, View};
use surefoot_compiler::reference_text::{language_reference, parts_reference, pictures};
use surefoot_compiler::{MemoryLoader, Options, compile};

/// Where to write, and what.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The folder to write to: language.md, parts.md, and their pictures in pictures/.
    #[arg(short, long, default_value = "docs", value_name = "FOLDER")]
    output: PathBuf,
    /// Only check whether language.md and parts.md in that folder are up to date.
    #[arg(long)]
    check: bool,
    /// Write the text only, and leave the pictures as they are.
    #[arg(long)]
    text_only: bool,
    /// Print the language's grammar for editors that colour by regular expressions (TextMate), and write nothing.
    #[arg(long)]
    grammar: bool,
    /// Print the tokens of a text with their classes as JSON, and write nothing.
    #[arg(long, value_name = "FILE")]
    tokens: Option<PathBuf>,
}

/// Pixels of a picture on the page.
const SIZE: (u32, u32) = (160, 120);
/// Each is the mean of a square of so many pixels a side.
const FINER: u32 = 4;

/// Writes, or compares.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    if args.grammar {
        print(grammar::grammar().as_bytes())?;
        return Ok(Exit::Fine);
    }
    if let Some(path) = &args.tokens {
        let failed = |why: &str| Failure::usage(format!("can't read {}: {why}", path.display()));
        let text = String::from_utf8(files::read(path).map_err(|why| failed(&why))?).map_err(|_| failed("it is not UTF-8"))?;
        print(format!("{}\n", grammar::classes(&text)).as_bytes())?;
        return Ok(Exit::Fine);
    }
    let pages = [("language.md", language_reference()), ("parts.md", parts_reference(&steepest))].map(|(name, page)| (args.output.join(name), page));
    if args.check {
        let old: Vec<_> = pages.iter().filter(|(path, page)| std::fs::read_to_string(path).unwrap_or_default() != *page).collect();
        for (path, _) in &old {
            eprintln!("{} is not up to date; `surefoot reference` writes it", path.display());
        }
        return Ok(if old.is_empty() { Exit::Fine } else { Exit::Errors });
    }
    for (path, page) in pages {
        std::fs::create_dir_all(args.output.join("pictures"))
            .and_then(|()| std::fs::write(&path, page))
            .map_err(|why| Failure::usage(format!("can't write {}: {why}", path.display())))?;
    }
    if !args.text_only {
        for (name, scene) in pictures() {
            draw(&args.output.join("pictures").join(name), scene)?;
        }
    }
    Ok(Exit::Fine)
}

/// The greatest factor of a scene, as `×1.5`, and whether all of its factors are proven.
fn steepest(scene: &str) -> String {
    let loader = MemoryLoader::new().with("scene.sdf", scene);
    let Some(compiled) = compile(&loader, "scene.sdf", &Options::default()).compiled else { return "unknown".to_owned() };
    let factors = &compiled.graph.factors;
    let greatest = factors.iter().map(|factor| factor.lipschitz).fold(1.0, f64::max);
    let measured = factors.iter().any(|factor| factor.proof == Proof::Measured);
    // Rounded up: no smaller number is proven.
    format!("×{}{}", (100.0 * greatest - 1e-3).ceil() / 100.0, if measured { ", measured" } else { "" })
}

/// Draws a scene on the processor, so that every machine makes the same file.
fn draw(path: &Path, scene: String) -> Result<(), Failure> {
    let failed = |why: &str| Failure::usage(format!("can't draw {}: {why}", path.display()));
    let loader = MemoryLoader::new().with("scene.sdf", scene);
    let outcome = compile(&loader, "scene.sdf", &Options::default());
    let compiled = outcome.compiled.ok_or_else(|| failed("its example has errors"))?;
    let live = compiled.live();
    let reference = Reference::new(&compiled, &live).map_err(|why| failed(&why.to_string()))?;
    let frame = compiled.frame(&live);
    let (_, camera) = frame.cameras.first().ok_or_else(|| failed("it has no camera"))?;
    let size = (SIZE.0 * FINER, SIZE.1 * FINER);
    // A strip of the picture for each of its rows, on as many threads as there are.
    let strips: Vec<u8> = (0..SIZE.1)
        .into_par_iter()
        .flat_map_iter(|row| {
            let area = Area { left: 0, top: row * FINER, width: size.0, height: FINER };
            shrink(&reference.tile(&frame, camera, size, View::Shaded, area), row)
        })
        .collect();
    write_png(path, SIZE.0, SIZE.1, &strips)
        .map_err(|why| Failure::usage(format!("can't write {}: {why}", path.display())))
}

/// The mean of each square of pixels of a strip, which is a row of the picture.
fn shrink(fine: &[[f32; 4]], row: u32) -> Vec<u8> {
    let mut small = Vec::with_capacity(4 * SIZE.0 as usize);
    for x in 0..SIZE.0 {
        let mut sum = [0.0; 3];
        for (i, j) in (0..FINER).flat_map(|j| (0..FINER).map(move |i| (i, j))) {
            let at = (j * SIZE.0 * FINER + x * FINER + i) as usize;
            for (sum, part) in sum.iter_mut().zip(fine.get(at).copied().unwrap_or_default()) {
                *sum += part;
            }
        }
        small.extend(sum.map(|c| level((c / (FINER * FINER) as f32).into(), dither(x, row))));
        small.push(255);
    }
    small
}
