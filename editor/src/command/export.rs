//! `surefoot export`: a scene as one page to show.

use super::bar::LateBar;
use super::compile::{say_left_out, shown};
use super::console::{Exit, Failure, compile_file, ends_wrong, show_broken, spare};
use super::render;
use super::values::{self, Setting};
use crate::files;
use crate::picture::{Device, NoPainter, Painter, Shot};
use image::{ExtendedColorType, codecs::jpeg::JpegEncoder};
use std::path::PathBuf;
use surefoot_compiler::reference::View;
use surefoot_compiler::Options;
use surefoot_compiler::compiled::Live;
use surefoot_hosts::{Host, Showing, page};

/// How large a poster is where no size is said.
const POSTER: (u32, u32) = (640, 360);
/// The quality of its JPEG, up to 100.
const QUALITY: u8 = 82;

/// What to write.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scene.
    scene: String,
    /// The page to write: one .html file that draws by WebGPU, or by WebGL 2 where there is none, and loads nothing.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Width and height of the picture on the page, in CSS pixels. It fills the window if this is left out.
    #[arg(long, value_parser = render::size, value_name = "WxH")]
    size: Option<(u32, u32)>,
    /// Leave out the panel with the parameters, for a page within another one.
    #[arg(long)]
    bare: bool,
    /// Leave out the picture that is seen before the first one is drawn, and where a browser can draw none.
    #[arg(long)]
    no_poster: bool,
    /// What draws that picture.
    #[arg(long, value_enum, default_value_t)]
    device: Device,
    /// Fix a parameter that is a choice, or give another one its value at the start.
    #[arg(long, value_parser = values::setting, value_name = "NAME=VALUE")]
    set: Vec<Setting>,
    /// Make it an error where a factor is measured and not proven.
    #[arg(long)]
    strict: bool,
}

/// Compiles, draws the poster and writes the page. Nothing is written where anything is wrong.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    if let Some(words) = ends_wrong(&args.output, Host::Html.endings()) {
        return Err(Failure::usage(words));
    }
    let options = Options { strict: args.strict, ..Host::Html.options() };
    let (outcome, live) = values::read(&args.scene, &args.set, &options)?;
    let (Some(compiled), Some(mut live)) = (&outcome.compiled, live) else { return Ok(Exit::Errors) };
    compiled.settle(&mut live);
    if show_broken(&outcome, &crate::picture::broken_meshes(compiled)) == Exit::Errors {
        return Ok(Exit::Errors);
    }
    spare(&args.output, &outcome)?;
    say_left_out(compiled, &compiled.module);
    let poster = if args.no_poster { None } else { Some(poster(args, &live)?) };
    let (title, parameters) = shown(&args.scene, compiled);
    let showing = Showing { size: args.size, bare: args.bare, poster };
    let invalid = |why| Failure { exit: Exit::Errors, words: format!("{}: nothing is written: {why}", args.scene) };
    let bytes = page(compiled, &live, &parameters, &title, &showing).map_err(invalid)?;
    files::write(&args.output, &bytes).map_err(|why| Failure::usage(format!("can't write {}: {why}", args.output.display())))?;
    Ok(Exit::Fine)
}

/// The scene at its start as a JPEG, drawn as `render` draws it.
fn poster(args: &Args, live: &Live) -> Result<Vec<u8>, Failure> {
    let failed = |why: String| Failure::usage(format!("can't draw the poster of {}: {why}. --no-poster leaves it out", args.scene));
    // What the page's module lacks, it is drawn with.
    let outcome = compile_file(&args.scene, &Options { choose: values::choices(&args.set), ..Options::default() })?;
    let compiled = outcome.compiled.as_ref().ok_or_else(|| failed("it has errors".to_owned()))?;
    let (width, height) = args.size.unwrap_or(POSTER);
    let (mut painter, _) = Painter::new(args.device, compiled, View::default(), None, None).map_err(|why| match why {
        NoPainter::NoGraphics(words) => Failure { exit: Exit::NoGraphics, words },
        NoPainter::Refused(words) => failed(words),
    })?;
    let camera = render::camera(&compiled.frame(live), None)?;
    let camera = compiled.camera_in(camera, f64::from(width) / f64::from(height));
    let bar = LateBar::new();
    let rgba = painter.paint(compiled, live, &Shot::new((width, height), camera), &|part| bar.show(part)).map_err(failed)?;
    bar.finish();
    let rgb: Vec<u8> = rgba.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
    let mut jpeg = Vec::new();
    JpegEncoder::new_with_quality(&mut jpeg, QUALITY).encode(&rgb, width, height, ExtendedColorType::Rgb8).map_err(|why| failed(why.to_string()))?;
    Ok(jpeg)
}
