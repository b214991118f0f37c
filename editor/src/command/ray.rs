//! `surefoot ray`: the march of one pixel's ray, step by step, as a table and as a picture.

use super::aim::{Pixel, aim};
use super::console::{Exit, Failure, print};
use super::render::size;
use crate::marched::Slice;
use crate::picture::write_png;
use serde_json::json;
use std::fmt::Write;
use std::path::PathBuf;
use surefoot_compiler::camera::Basis;
use surefoot_compiler::pick::held;

/// A pixel, and what is told of its ray.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    pixel: Pixel,
    /// For machines: one JSON object.
    #[arg(long)]
    json: bool,
    /// Write a picture too, a PNG: a slice of the field through the ray, each step a white circle as large as the distance with a yellow one as large as the
    /// bound.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Width and height of that picture in pixels.
    #[arg(long, default_value = "1280x720", value_parser = size, value_name = "WxH", requires = "output")]
    picture: (u32, u32),
    /// Let that picture show the march from this step on; the first is 1.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..), value_name = "STEP", requires = "output")]
    from: u32,
}

/// Follows the ray, prints its steps and draws them.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let Some(aimed) = aim(&args.pixel)? else { return Ok(Exit::Errors) };
    let Some(compiled) = aimed.compiled() else { return Ok(Exit::Errors) };
    let march = aimed.reference.march_of(&aimed.ray, aimed.footprint, compiled.blocks.extent);
    let held = held(compiled, &aimed.live, &aimed.outcome.sources, march.steps.iter().map(|step| step.point));
    let end = match (march.hit.hit, march.plane, march.steps.last()) {
        (true, Some(_), _) => "hit a plane",
        (true, None, _) => "hit",
        (false, _, Some(step)) if step.kind == surefoot_compiler::reference::Kind::Spent => "all steps used up",
        _ => "nothing met",
    };
    let text = if args.json {
        let steps = march.steps.iter().zip(&held).map(|(step, held)| {
            json!({
                "t": step.t, "point": step.point, "bound": step.bound, "distance": step.distance, "field": step.field, "next": step.next,
                "kind": step.kind.name(), "held_by": held.as_ref().map(|held| &held.name), "factor": held.as_ref().and_then(|held| held.factor),
                "line": held.as_ref().map(|held| held.made.place.1),
            })
        });
        let hit = json!({ "hit": march.hit.hit, "t": march.hit.t, "steps": march.hit.steps, "end": end });
        format!("{:#}\n", json!({ "end": hit, "steps": steps.collect::<Vec<_>>() }))
    } else {
        let mut text = format!("{:>4} {:>12} {:>12} {:>12} {:>12}  {:<7} held by\n", "step", "t", "distance", "bound", "goes", "how");
        for (at, (step, held)) in (1..).zip(march.steps.iter().zip(&held)) {
            let goes = step.next - step.t;
            let held = held.as_ref().map_or(String::new(), |held| held.words());
            let _ = writeln!(
                text,
                "{at:>4} {:>12.6} {:>12.6} {:>12.6} {goes:>12.6}  {:<7} {held}",
                step.t,
                step.distance,
                step.bound,
                step.kind.name()
            );
        }
        let _ = writeln!(text, "{end} at {:.6} after {} steps", march.hit.t, march.hit.steps);
        text
    };
    if let Some(output) = &args.output {
        let up = Basis::of(&aimed.camera).up;
        let slice = Slice::of(&aimed.ray, &march, up, args.from as usize - 1, args.picture);
        let pixels = slice.draw(&aimed.reference, &march);
        let (width, height) = args.picture;
        write_png(output, width, height, &pixels).map_err(|why| Failure { exit: Exit::Usage, words: format!("{}: {why}", output.display()) })?;
    }
    print(text.as_bytes())?;
    Ok(Exit::Fine)
}
