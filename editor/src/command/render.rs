//! `surefoot render`: pictures of a scene.

use super::bar::LateBar;
use super::values::{self, Setting};
use super::console::{Exit, Failure, ends_wrong, print, show_broken, show_found, spare};
use crate::picture::{Device, Mode, NoPainter, Painter, Shot, write_png};
use std::ops::Range;
use std::path::{Path, PathBuf};
use surefoot_compiler::Options;
use surefoot_compiler::compiled::{Camera, Frame};
use surefoot_compiler::diagnostic::Diagnostic;

/// What to draw, and how.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scene.
    scene: String,
    /// The PNG file to write; `-` is stdout. With --frames its name gets a number: OUT_0000.png.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Width and height in pixels.
    #[arg(long, default_value = "1280x720", value_parser = size, value_name = "WxH")]
    size: (u32, u32),
    /// The scene's time, in seconds.
    #[arg(long, allow_negative_numbers = true, default_value_t = 0.0, value_parser = seconds, value_name = "SECONDS", conflicts_with = "frames")]
    time: f64,
    /// Draw these frames, without the last number.
    #[arg(long, value_parser = frames, value_name = "FIRST..END")]
    frames: Option<Range<u32>>,
    /// Frames per second.
    #[arg(long, default_value_t = 30.0, value_parser = rate, value_name = "N", requires = "frames")]
    fps: f64,
    /// Set a parameter: a number, `0,1,0`, `#d08770`, `45deg`, `true` or the name of a choice.
    #[arg(long, value_parser = values::setting, value_name = "NAME=VALUE")]
    set: Vec<Setting>,
    /// The camera to use; the scene's first one if this is left out.
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
    /// What the picture shows.
    #[arg(long, value_enum, default_value_t)]
    view: Mode,
    /// What draws it.
    #[arg(long, value_enum, default_value_t)]
    device: Device,
    /// Samples per pixel, 1 to 4096; the pixel gets their mean. Default: 16 on a graphics card, 4 on a software adapter or the processor,
    /// 1 for every view but the shaded one.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=4096), value_name = "N")]
    samples: Option<u32>,
    /// List the passes of the frame with their time, size and reason, and what was left out.
    #[arg(long)]
    explain: bool,
    /// Make it an error where a factor is measured and not proven.
    #[arg(long)]
    strict: bool,
}

/// Reads `1280x720`.
pub fn size(text: &str) -> Result<(u32, u32), String> {
    // As large as the pictures that common graphics cards and viewers take.
    let side = |text: &str| text.trim().parse().ok().filter(|side| (1..=16384).contains(side));
    let (width, height) = text.split_once(['x', '×']).ok_or("write WIDTHxHEIGHT")?;
    side(width)
        .zip(side(height))
        .ok_or_else(|| "each side is a whole number from 1 to 16384".to_owned())
}

fn seconds(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|s: &f64| s.is_finite())
        .ok_or_else(|| "write a number of seconds".to_owned())
}

fn rate(text: &str) -> Result<f64, String> {
    let in_range = |fps: &f64| fps.is_finite() && *fps > 0.0;
    text.parse().ok().filter(in_range).ok_or_else(|| "write a number above zero".to_owned())
}

fn frames(text: &str) -> Result<Range<u32>, String> {
    let (first, end) = text.split_once("..").ok_or("write FIRST..END")?;
    match (first.trim().parse(), end.trim().parse()) {
        (Ok(first), Ok(end)) if first < end => Ok(first..end),
        (Ok(_), Ok(_)) => Err("the end is not above the first".to_owned()),
        _ => Err("write FIRST..END, two whole numbers".to_owned()),
    }
}

/// Draws and writes.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let (outcome, live) = values::read(&args.scene, &args.set, &Options { strict: args.strict, ..Options::default() })?;
    let (Some(compiled), Some(mut live)) = (&outcome.compiled, live) else { return Ok(Exit::Errors) };
    compiled.settle(&mut live);
    if args.output.as_os_str() == "-" && args.frames.is_some() {
        return Err(Failure::usage("frames are files of their own: say where to write with `-o FRAME.png`"));
    }
    if args.output.extension().is_some_and(|e| !e.eq_ignore_ascii_case("png")) {
        let png = args.output.with_extension("png");
        let pictures = format!("pictures are written as PNG: write `-o {}`", png.display());
        return Err(Failure::usage(match ends_wrong(&args.output, &["png"]) {
            Some(words) => format!("{words}; {pictures}"),
            None => pictures,
        }));
    }
    let shots: Vec<(f64, PathBuf)> = match &args.frames {
        None => vec![(args.time, args.output.clone())],
        Some(range) => {
            range.clone().map(|n| (f64::from(n) / args.fps, numbered(&args.output, n))).collect()
        }
    };
    for (_, path) in &shots {
        spare(path, &outcome)?;
    }
    // A wrong name is said before anything slow is done.
    camera(&compiled.frame(&live), args.camera.as_deref())?;
    live.time = args.time;
    let unseen: Vec<Diagnostic> = outcome.outlook(&live, args.camera.as_deref()).into_iter().collect();
    show_found(&outcome, &unseen);

    let (mut painter, note) =
        Painter::new(args.device, compiled, args.view, args.samples).map_err(|why| match why {
            NoPainter::NoGraphics(words) => Failure { exit: Exit::NoGraphics, words },
            NoPainter::Refused(words) => {
                Failure::usage(format!("the graphics adapter refuses the scene: {words}"))
            }
        })?;
    if let Some(note) = note {
        eprintln!("note: {note}");
    }
    let exit = show_broken(&outcome, painter.broken());
    let bar = LateBar::new();
    for (i, (time, path)) in shots.iter().enumerate() {
        live.time = *time;
        let camera = camera(&compiled.frame(&live), args.camera.as_deref())?;
        let camera = compiled.camera_in(camera, f64::from(args.size.0) / f64::from(args.size.1));
        let (width, height) = args.size;
        let shot = Shot { width, height, camera };
        let rgba = painter
            .paint(compiled, &live, &shot, &|part| bar.show((i as f64 + part) / shots.len() as f64))
            .map_err(|why| Failure::usage(format!("can't draw {}: {why}", args.scene)))?;
        if args.explain && i == 0 {
            let explained = painter.explain(compiled, &live, &shot).map_err(Failure::usage)?;
            print(explained.as_bytes())?;
        }
        write_png(path, width, height, &rgba)
            .map_err(|why| Failure::usage(format!("can't write {}: {why}", path.display())))?;
    }
    bar.finish();
    Ok(exit)
}

fn camera(frame: &Frame, name: Option<&str>) -> Result<Camera, Failure> {
    let found = match name {
        None => frame.cameras.first(),
        Some(name) => frame.cameras.iter().find(|(known, _)| known == name),
    };
    found.map(|(_, camera)| *camera).ok_or_else(|| {
        let known: Vec<_> =
            frame.cameras.iter().map(|(n, _)| n.as_str()).filter(|n| !n.is_empty()).collect();
        let words = format!("the scene has no camera `{}`", name.unwrap_or_default());
        Failure::usage(match known.is_empty() {
            true => format!("{words}; none of its cameras has a name"),
            false => format!("{words}; it has {}", known.join(", ")),
        })
    })
}

/// `out.png` and 7 make `out_0007.png`.
fn numbered(path: &Path, number: u32) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().map_or_else(|| "png".into(), |e| e.to_string_lossy());
    path.with_file_name(format!("{stem}_{number:04}.{extension}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(size("1280x720"), Ok((1280, 720)));
        for wrong in ["", "x", "0x1", "1x", "100000x1", "1280", "-1x1"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn frames_exclude_their_end() {
        assert_eq!(frames("0..120"), Ok(0..120));
        for wrong in ["", "3", "3..3", "4..3", "a..b", "0..=3"] {
            assert!(frames(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn frames_are_numbered_before_the_extension() {
        assert_eq!(numbered(Path::new("a/out.png"), 7), Path::new("a/out_0007.png"));
        assert_eq!(numbered(Path::new("out"), 12345), Path::new("out_12345.png"));
    }
}
