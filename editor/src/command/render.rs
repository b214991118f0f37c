//! `surefoot render`: pictures of a scene.

use super::bar::LateBar;
use super::values::{self, Setting};
use super::console::{Exit, Failure, ends_wrong, print, show_broken, show_found, spare};
use crate::animation::{Animation, Format, numbered};
use crate::picture::{Device, Mode, NoPainter, Painter, Shot, write_png};
use std::ops::Range;
use std::path::{Path, PathBuf};
use surefoot_compiler::Options;
use surefoot_compiler::compiled::{Camera, Frame};
use surefoot_compiler::diagnostic::Diagnostic;
use surefoot_compiler::reference::View;
use surefoot_compiler::section::{Across, Cut, Section};

/// What to draw, and how.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scene.
    scene: String,
    /// The file to write: a PNG, or with --frames or --loop a .gif, .apng, .mp4 or .webm; `-` is a PNG to stdout. With --frames the name of a PNG gets a
    /// number: OUT_0000.png. MP4 and WebM need the program ffmpeg.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Width and height in pixels.
    #[arg(long, default_value = "1280x720", value_parser = size, value_name = "WxH")]
    size: (u32, u32),
    /// Draw the I-th of N bands of rows alone, the first on top. Its pixels are those of the whole picture, to the byte: bands may be drawn anywhere, and are
    /// set one below the other.
    #[arg(long, value_parser = tile, value_name = "I/N")]
    tile: Option<(u32, u32)>,
    /// The scene's time, in seconds.
    #[arg(long, allow_negative_numbers = true, default_value_t = 0.0, value_parser = seconds, value_name = "SECONDS", conflicts_with = "frames")]
    time: f64,
    /// Draw these frames, without the last number.
    #[arg(long, value_parser = frames, value_name = "FIRST..END", group = "moving")]
    frames: Option<Range<u32>>,
    /// Draw the frames of so many seconds, after which the film starts again, and say whether the scene repeats then.
    #[arg(long = "loop", value_parser = period, value_name = "SECONDS", conflicts_with_all = ["frames", "time"], group = "moving")]
    period: Option<f64>,
    /// Frames per second.
    #[arg(long, default_value_t = 30.0, value_parser = rate, value_name = "N", requires = "moving")]
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
    /// Show a plane through the field instead: its lines, blue outside and orange inside. Nothing is drawn before the plane.
    #[arg(long, value_parser = slice, value_name = "AXIS=PLACE", conflicts_with = "view")]
    slice: Option<(u8, f64)>,
    /// Cut the picture open: `y<0.5` shows what lies below 0.5 along y, `y>0.5` what lies above, and `y=0.5` takes away the side of the eye. x, y, z, or
    /// `view`: the direction of the camera, from what it looks at. What is cut is flat and striped. Light and shadows are those of the whole scene.
    #[arg(long, value_parser = section, value_name = "AXIS<PLACE", conflicts_with = "slice")]
    section: Option<Wanted>,
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

/// Reads `2/8`.
fn tile(text: &str) -> Result<(u32, u32), String> {
    let words = || "write I/N, as 1/8 for the first of eight and 8/8 for the last".to_owned();
    let (which, of) = text.split_once('/').ok_or_else(words)?;
    let (which, of) = which.trim().parse().ok().zip(of.trim().parse().ok()).ok_or_else(words)?;
    if (1..=of).contains(&which) { Ok((which, of)) } else { Err(words()) }
}

/// The rows of a band.
fn band((which, of): (u32, u32), height: u32) -> [u32; 2] {
    [which - 1, which].map(|i| (u64::from(height) * u64::from(i) / u64::from(of)) as u32)
}

/// Reads `z=0.2`.
fn slice(text: &str) -> Result<(u8, f64), String> {
    let words = || "write x, y or z and a place along it, as z=0.2".to_owned();
    let (axis, at) = text.split_once('=').ok_or_else(words)?;
    let axis = ["x", "y", "z"].iter().position(|name| *name == axis.trim()).ok_or_else(words)?;
    let at = at.trim().parse().ok().filter(|at: &f64| at.is_finite()).ok_or_else(words)?;
    Ok((axis as u8, at))
}

/// A section as it is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Wanted {
    across: Across,
    /// Whether what lies above stays; the side away from the eye where that is not said.
    keeps_above: Option<bool>,
    at: f64,
}

impl Wanted {
    /// The section, as a camera sees it.
    fn section(self, camera: &Camera) -> Section {
        let Self { across, keeps_above, at } = self;
        keeps_above.map_or_else(|| Section::facing(across, at, camera), |keeps_above| Section { cut: Cut { across, keeps_above }, at })
    }
}

/// Reads `y<0.5`, `view>0` and `z=0.2`.
fn section(text: &str) -> Result<Wanted, String> {
    let words = || "write x, y, z or view, then <, > or =, and a place, as 'y<0.5'".to_owned();
    let sign = text.find(['<', '>', '=']).ok_or_else(words)?;
    let (name, rest) = text.split_at(sign);
    let keeps_above = match rest.as_bytes().first() {
        Some(b'<') => Some(false),
        Some(b'>') => Some(true),
        _ => None,
    };
    let across = Across::ALL.into_iter().find(|across| across.name() == name.trim()).ok_or_else(words)?;
    let at = rest.get(1..).and_then(|place| place.trim().parse().ok()).filter(|at: &f64| at.is_finite()).ok_or_else(words)?;
    Ok(Wanted { across, keeps_above, at })
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

fn period(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|s: &f64| s.is_finite() && *s > 0.0).ok_or_else(|| "write a number of seconds above zero".to_owned())
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
    live.slice = args.slice.map_or(0.0, |(_, at)| at);
    let view = args.slice.map_or(args.view.into(), |(axis, _)| View::Slice(axis));
    let moments = moments(args)?;
    let film = film(args, moments.len())?;
    let single = args.frames.is_none() && args.period.is_none();
    let path = |n: u32| if single || film.is_some() { args.output.clone() } else { numbered(&args.output, n) };
    for (n, _) in &moments {
        spare(&path(*n), &outcome)?;
    }
    // A wrong name is said before anything slow is done.
    let first = camera(&compiled.frame(&live), args.camera.as_deref())?;
    live.section = args.section.map(|wanted| wanted.section(&first));
    live.time = moments.first().map_or(args.time, |(_, time)| *time);
    let unseen: Vec<Diagnostic> = outcome.outlook(&live, args.camera.as_deref()).into_iter().collect();
    show_found(&outcome, &unseen);

    let (mut painter, note) =
        Painter::new(args.device, compiled, view, live.section.map(|section| section.cut), args.samples).map_err(|why| match why {
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
    let (width, height) = args.size;
    let rows = args.tile.map_or([0, height], |tile| band(tile, height));
    // The picture at the end of a loop is drawn too, and not written.
    let total = moments.len() + usize::from(args.period.is_some());
    let mut paint = |at: usize, time: f64| -> Result<Vec<u8>, Failure> {
        live.time = time;
        let camera = camera(&compiled.frame(&live), args.camera.as_deref())?;
        let camera = compiled.camera_in(camera, f64::from(width) / f64::from(height));
        let shot = Shot { rows, ..Shot::new(args.size, camera) };
        let rgba = painter
            .paint(compiled, &live, &shot, &|part| bar.show((at as f64 + part) / total as f64))
            .map_err(|why| Failure::usage(format!("can't draw {}: {why}", args.scene)))?;
        if args.explain && at == 0 {
            let explained = painter.explain(compiled, &live, &shot).map_err(Failure::usage)?;
            print(explained.as_bytes())?;
        }
        Ok(rgba)
    };
    let unwritten = |path: &Path, why: String| Failure::usage(format!("can't write {}: {why}", path.display()));
    let begin = |(format, rate)| Animation::begin(&args.output, format, args.size, rate, moments.len() as u32);
    let mut film = film.map(begin).transpose().map_err(|why| unwritten(&args.output, why))?;
    let mut first = None;
    for (at, (n, time)) in moments.iter().enumerate() {
        let rgba = paint(at, *time)?;
        match &mut film {
            Some(film) => film.push(&rgba).map_err(|why| unwritten(&args.output, why))?,
            None => write_png(&path(*n), width, rows[1] - rows[0], &rgba).map_err(|why| unwritten(&path(*n), why))?,
        }
        first.get_or_insert(rgba);
    }
    if let Some(film) = film {
        film.finish().map_err(|why| unwritten(&args.output, why))?;
    }
    if let (Some(period), Some(first)) = (args.period, first) {
        let changed = changed(&first, &paint(moments.len(), period)?);
        if changed > SEEN {
            eprintln!(
                "note: the picture at {period} s differs from that at 0 s in {:.1} % of its pixels, so the film jumps where it starts again. `time` repeats there \
                 in `sin(2 * pi * time / {period})` or `fract(time / {period})`",
                100.0 * changed
            );
        }
    }
    bar.finish();
    Ok(exit)
}

/// From this share of pixels on a loop that does not close is told. Noise of soft shadows changes fewer.
const SEEN: f64 = 0.002;

/// The share of pixels of which a colour differs by more than a sixteenth of white.
fn changed(a: &[u8], b: &[u8]) -> f64 {
    let differs = |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 16);
    a.chunks(4).zip(b.chunks(4)).filter(differs).count() as f64 / (a.len() / 4).max(1) as f64
}

/// The pictures to draw: number and time in seconds.
fn moments(args: &Args) -> Result<Vec<(u32, f64)>, Failure> {
    match (&args.frames, args.period) {
        (Some(range), _) => Ok(range.clone().map(|n| (n, f64::from(n) / args.fps)).collect()),
        (None, Some(period)) => {
            let count = (period * args.fps).round().max(1.0);
            if count > 1e6 {
                return Err(Failure::usage(format!("{period} s are more than a million frames: write a shorter --loop, or a lower --fps")));
            }
            Ok((0..count as u32).map(|n| (n, period * f64::from(n) / count)).collect())
        }
        (None, None) => Ok(vec![(0, args.time)]),
    }
}

/// The format of the film that is asked for, and its frames per second; none if pictures are.
fn film(args: &Args, count: usize) -> Result<Option<(Format, f64)>, Failure> {
    let moves = args.frames.is_some() || args.period.is_some();
    let shown = args.output.display();
    if let Some((_, of)) = args.tile.filter(|(_, of)| *of > args.size.1) {
        return Err(Failure::usage(format!("a picture of {} rows has no {of} bands: write a smaller N in `--tile I/N`", args.size.1)));
    }
    if args.output.as_os_str() == "-" && moves {
        return Err(Failure::usage("frames are files of their own: say where to write with `-o FRAME.png` or `-o FILM.gif`"));
    }
    if let Some(format) = Format::of(&args.output) {
        if args.tile.is_some() {
            return Err(Failure::usage(format!("{shown} is a film, and a band of rows is written as PNG: write `-o BAND.png`")));
        }
        if !moves {
            return Err(Failure::usage(format!("{shown} moves: say how long it is with `--frames 0..120` or `--loop 4`")));
        }
        let rate = args.period.map_or(args.fps, |period| count as f64 / period);
        return match format.refuses(args.size, rate) {
            Some(words) => Err(Failure::usage(words)),
            None => Ok(Some((format, rate))),
        };
    }
    if args.output.extension().is_some_and(|e| !e.eq_ignore_ascii_case("png")) {
        let png = args.output.with_extension("png");
        let pictures = format!("pictures are written as PNG: write `-o {}`", png.display());
        return Err(Failure::usage(match ends_wrong(&args.output, &["png"]) {
            Some(words) => format!("{words}; {pictures}"),
            None => pictures,
        }));
    }
    Ok(None)
}

/// One of the frame's cameras: that with this name, or the first.
pub fn camera(frame: &Frame, name: Option<&str>) -> Result<Camera, Failure> {
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
    fn bands_are_all_of_a_picture() {
        assert_eq!(tile(" 2/ 8"), Ok((2, 8)));
        for wrong in ["", "1", "0/4", "5/4", "-1/4", "1/0", "a/b", "1/2/3"] {
            assert!(tile(wrong).is_err(), "{wrong}");
        }
        for (of, height) in [(1, 1), (3, 100), (7, 720), (16384, 16384)] {
            let ends: Vec<[u32; 2]> = (1..=of).map(|which| band((which, of), height)).collect();
            assert!(ends.iter().all(|[first, end]| first < end) && ends.windows(2).all(|two| two[0][1] == two[1][0]));
            assert_eq!((ends[0][0], ends[ends.len() - 1][1]), (0, height));
        }
    }

    #[test]
    fn a_section_keeps_the_side_that_is_asked_for() {
        let from = |eye| Camera { eye, ..Camera::PLAIN };
        let kept = |text: &str, eye| section(text).map(|wanted| wanted.section(&from(eye)).cut.keeps_above);
        assert_eq!((kept("y<0.5", [0.0, 3.0, 0.0]), kept(" y > -0.5 ", [0.0, 3.0, 0.0])), (Ok(false), Ok(true)));
        assert_eq!((kept("y=0.5", [0.0, 3.0, 0.0]), kept("y=0.5", [0.0, -3.0, 0.0])), (Ok(false), Ok(true)));
        assert_eq!(kept("view=0", [0.0, 0.0, 5.0]), Ok(true), "the eye is before the plane");
        for wrong in ["", "y", "y<", "w<1", "<1", "y<one", "y<inf", "y<=1"] {
            assert!(section(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn frames_exclude_their_end() {
        assert_eq!(frames("0..120"), Ok(0..120));
        for wrong in ["", "3", "3..3", "4..3", "a..b", "0..=3"] {
            assert!(frames(wrong).is_err(), "{wrong}");
        }
    }
}
