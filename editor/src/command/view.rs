//! `surefoot view`: a scene in a live window.

use super::console::{Exit, Failure, compile_file, show_broken, show_diagnostics};
use crate::picture::{Device, NoPainter, Painter, Shot, write_png};
use std::path::{Path, PathBuf};
use surefoot_compiler::reference::View;
use surefoot_compiler::Options;

/// What to show.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// The scene.
    #[arg(value_name = "SCENE")]
    pub scene: String,
    /// Append events (compilations, frames, …) to this file, one JSON object on each line.
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// Show only the picture, with the errors over it: for a second screen, while the scene is written in another editor.
    #[arg(long)]
    follow: bool,
    /// Make it an error where a factor is measured and not proven.
    #[arg(long)]
    strict: bool,
}

impl Args {
    fn options(&self) -> Options {
        Options { strict: self.strict, ..Options::default() }
    }
}

/// Opens the window; where there can be none, writes a picture.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    match window(args)? {
        None => Ok(Exit::Fine),
        Some(why) => picture(args, &why),
    }
}

/// Shows the window until it is closed, or says why there is none.
#[cfg(feature = "gui")]
fn window(args: &Args) -> Result<Option<String>, Failure> {
    let recovery = crate::window::Recovery::of_user();
    // An editor may open a scene that does not exist yet or has errors, but a wrong name is more likely; not where text of it was left behind.
    if let Err(why) = crate::files::read(Path::new(&args.scene))
        && !recovery.found().iter().any(|found| found.is_of(&args.scene))
    {
        return Err(Failure::usage(format!("can't read {}: {why}", args.scene)));
    }
    let log = match &args.log {
        None => crate::window::Log::default(),
        Some(path) => crate::window::Log::to(path)
            .map_err(|why| Failure::usage(format!("can't write {}: {why}", path.display())))?,
    };
    if !crate::window::has_display() {
        return Ok(Some("there is no display".to_owned()));
    }
    Ok(crate::window::open(&args.scene, args.options(), args.follow, recovery, log).err())
}

/// Shows the page with which one begins, until the window is closed. Answers whether there was a window.
#[cfg(feature = "gui")]
pub fn start() -> bool {
    crate::window::has_display() && crate::window::start(crate::window::Recovery::of_user()).is_ok()
}

/// There is no window in this program.
#[cfg(not(feature = "gui"))]
pub fn start() -> bool {
    false
}

#[cfg(not(feature = "gui"))]
fn window(args: &Args) -> Result<Option<String>, Failure> {
    let _ = (&args.log, args.follow);
    Ok(Some("this program was built without a window".to_owned()))
}

/// Where there is no window: `SCENE.png` in the working directory, or where that is there already `SCENE.2.png` and so on.
fn picture(args: &Args, why: &str) -> Result<Exit, Failure> {
    let scene = &args.scene;
    let outcome = compile_file(scene, &args.options())?;
    eprintln!("surefoot: no window: {why}");
    show_diagnostics(&outcome);
    let Some(compiled) = &outcome.compiled else { return Ok(Exit::Errors) };
    let (mut painter, note) =
        Painter::new(Device::Auto, compiled, View::Shaded, None, None).map_err(|why| match why {
            NoPainter::NoGraphics(words) | NoPainter::Refused(words) => Failure::usage(words),
        })?;
    if let Some(note) = note {
        eprintln!("note: {note}");
    }
    let exit = show_broken(&outcome, painter.broken());
    let mut live = compiled.live();
    compiled.settle(&mut live);
    let frame = compiled.frame(&live);
    let Some(&(_, camera)) = frame.cameras.first() else {
        return Err(Failure::usage(format!("{scene}: the scene has no camera")));
    };
    let shot = Shot::new((1280, 720), camera);
    let rgba = painter
        .paint(compiled, &live, &shot, &|_| {})
        .map_err(|why| Failure::usage(format!("can't draw {scene}: {why}")))?;
    let path = free(Path::new(Path::new(scene).file_name().unwrap_or_default()));
    write_png(&path, shot.width, shot.height, &rgba)
        .map_err(|why| Failure::usage(format!("can't write {}: {why}", path.display())))?;
    let shown = std::path::absolute(&path).unwrap_or(path);
    eprintln!("surefoot: wrote the picture to {}", shown.display());
    Ok(exit)
}

/// A name for a scene's picture that no file has: what is there may be an image of the scene, or anybody's.
fn free(scene: &Path) -> PathBuf {
    let name = |n: u32| scene.with_extension(if n == 1 { "png".to_owned() } else { format!("{n}.png") });
    (1..).map(name).find(|path| path.symlink_metadata().is_err()).unwrap_or_default()
}
