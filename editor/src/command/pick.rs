//! `surefoot pick`: which shape of the text made a pixel of the picture.

use super::aim::{Pixel, aim};
use super::console::{Exit, Failure, print};
use serde_json::json;
use std::fmt::Write;
use surefoot_compiler::pick::pick;

/// Characters that are printed of what is written there.
const LONGEST: usize = 60;

/// A pixel, and how it is told.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    pixel: Pixel,
    /// For machines: one JSON object.
    #[arg(long)]
    json: bool,
}

/// Follows the pixel's ray and names what it met.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let Some(aimed) = aim(&args.pixel)? else { return Ok(Exit::Errors) };
    let Some(compiled) = aimed.compiled() else { return Ok(Exit::Errors) };
    let seen = aimed.reference.seen(&[aimed.ray], aimed.footprint, compiled.blocks.extent).pop().map(|(_, seen)| seen);
    let made = seen.map(|seen| pick(compiled, &aimed.live, seen.point).made(&aimed.outcome.sources)).unwrap_or_default();
    let text = match (args.json, seen) {
        (true, _) => {
            let shapes = made.iter().map(|made| {
                let (file, line, column) = &made.place;
                json!({ "name": made.name, "text": made.text, "file": file, "line": line, "column": column, "cuts": made.cuts })
            });
            let hit = seen.map(|seen| json!({ "point": seen.point, "normal": seen.normal, "distance": seen.t }));
            format!("{:#}\n", json!({ "hit": hit, "shapes": shapes.collect::<Vec<_>>() }))
        }
        (false, None) => "nothing is seen there\n".to_owned(),
        (false, Some(seen)) => {
            let three = |v: [f64; 3]| v.map(|c| format!("{:.4}", c + 0.0)).join(", ");
            let mut text = format!("point {}; normal {}; {:.4} from the eye\n", three(seen.point), three(seen.normal), seen.t);
            for made in &made {
                let (file, line, column) = &made.place;
                let cuts = if made.cuts { ", taken away" } else { "" };
                let short: String = made.text.chars().take(LONGEST).collect();
                let dots = if short.len() < made.text.len() { "…" } else { "" };
                let _ = writeln!(text, "  {file}:{line}:{column} {}{cuts}: {short}{dots}", made.name);
            }
            text
        }
    };
    print(text.as_bytes())?;
    Ok(Exit::Fine)
}
