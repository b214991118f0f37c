//! The command line: one file a command.

#[cfg(feature = "gpu")]
mod bake;
mod bar;
mod bench;
mod check;
mod compile;
mod console;
mod explain;
mod fmt;
#[cfg(feature = "gpu")]
mod page;
mod reference;
mod render;
mod simulate;
#[cfg(feature = "gpu")]
mod stress;
mod values;
mod verify;
mod view;

use clap::{CommandFactory, Parser, Subcommand};
use console::{Exit, Failure};
use std::process::ExitCode;
use surefoot_compiler::syntax::words;

/// A language for signed distance fields: its compiler and live editor.
#[derive(Debug, Parser)]
#[command(
    name = "surefoot",
    version,
    args_conflicts_with_subcommands = true,
    arg_required_else_help = true,
    after_help = "Exit codes: 0 fine, 1 the scene has errors (or a violation, for verify), 2 wrong usage or an unreadable file, 3 no graphics adapter \
                  where --device gpu asked for one."
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    view: Option<view::Args>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Open a scene in a live window; what `surefoot SCENE.sdf` does.
    View(view::Args),
    /// Say what is wrong with scenes, and what the compiler knows of them.
    Check(check::Args),
    /// Put a scene's bound to the test: whether any ray could step through its surface.
    Verify(verify::Args),
    /// Write the functions of a scene as shader text.
    Compile(compile::Args),
    /// Lay out the text of scenes.
    Fmt(fmt::Args),
    /// Write pictures of a scene.
    Render(render::Args),
    /// Let a scene's balls fall, and write where they are.
    Simulate(simulate::Args),
    /// Make a grid of signed distances of a mesh.
    #[cfg(feature = "gpu")]
    Bake(bake::Args),
    /// Measure.
    Bench(Box<bench::Args>),
    /// Try what is hard for a field, for rays and for balls.
    #[cfg(feature = "gpu")]
    Stress(stress::Args),
    /// Explain what the compiler says.
    Explain(explain::Args),
    /// Write the language's reference: a page, and its pictures.
    Reference(reference::Args),
}

/// Reads the command line and does what it asks.
pub fn run() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => match std::env::args().nth(1).as_deref().and_then(misspelled) {
            Some(words) => {
                eprintln!("surefoot: {words}");
                return ExitCode::from(Exit::Usage as u8);
            }
            None => error.exit(),
        },
    };
    let command = cli.command.or_else(|| cli.view.map(Command::View));
    let done = match command {
        // Kept from here by `arg_required_else_help`.
        None => Err(Failure::usage("say what to do; `surefoot --help` lists the commands")),
        Some(Command::View(args)) => view::run(&args),
        Some(Command::Check(args)) => check::run(&args),
        Some(Command::Verify(args)) => verify::run(&args),
        Some(Command::Compile(args)) => compile::run(&args),
        Some(Command::Fmt(args)) => fmt::run(&args),
        Some(Command::Render(args)) => render::run(&args),
        Some(Command::Simulate(args)) => simulate::run(&args),
        #[cfg(feature = "gpu")]
        Some(Command::Bake(args)) => bake::run(&args),
        Some(Command::Bench(args)) => bench::run(&args),
        #[cfg(feature = "gpu")]
        Some(Command::Stress(args)) => stress::run(&args),
        Some(Command::Explain(args)) => explain::run(&args),
        Some(Command::Reference(args)) => reference::run(&args),
    };
    let exit = done.unwrap_or_else(|failure| {
        eprintln!("surefoot: {}", failure.words);
        failure.exit
    });
    ExitCode::from(exit as u8)
}

/// What is said of a first word that is no scene and nearly a command: it reads as a scene, and then what follows it is not understood.
fn misspelled(word: &str) -> Option<String> {
    let cli = Cli::command();
    let near = words::nearest(word, cli.get_subcommands().map(clap::Command::get_name))?;
    (!std::path::Path::new(word).exists()).then(|| format!("there is no command `{word}`: did you mean `{near}`?"))
}

<<<<<<< HEAD
=======
/// Compiles a scene on disk; fails only where the scene's own file can't be read.
fn compile_file(scene: &str, options: &Options) -> Result<Outcome, Failure> {
    crate::files::read(std::path::Path::new(scene))
        .map_err(|why| Failure::usage(format!("can't read {scene}: {why}")))?;
    Ok(surefoot_compiler::compile(&FileLoader, scene, options))
}

/// Fails where a path that is to be written is a file that the scene reads: a text, an image, one in a folder of images, or a mesh.
fn spare(path: &std::path::Path, outcome: &Outcome) -> Result<(), Failure> {
    let Ok(target) = std::fs::canonicalize(path) else { return Ok(()) };
    // A path starts with itself.
    match all_read(outcome).into_iter().any(|file| std::fs::canonicalize(file).is_ok_and(|file| target.starts_with(file))) {
        false => Ok(()),
        true => Err(Failure::usage(format!(
            "{} is a file of the scene, and would be written over: say another after -o",
            path.display()
        ))),
    }
}

/// What files with some ending hold, and how such are written, or that nothing writes them.
const ENDINGS: [(&[&str], &str); 12] = [
    (&["png"], "a picture is drawn by `surefoot render SCENE.sdf -o OUT.png`"),
    (&["jpg", "jpeg", "webp", "bmp", "tif", "tiff", "exr", "hdr", "svg"], "pictures are PNG alone, by `surefoot render SCENE.sdf -o OUT.png`"),
    (&["gif", "mp4", "webm", "mov", "avi", "mkv"], "nothing writes films; their pictures are drawn by `surefoot render SCENE.sdf -o OUT.png --frames 0..120`"),
    (&["wgsl"], "WGSL is written by `surefoot compile SCENE.sdf -o OUT.wgsl`"),
    (&["glsl", "frag", "vert"], "GLSL is written by `surefoot compile SCENE.sdf -o OUT.glsl --target glsl`"),
    (&["hlsl"], "HLSL is written by `surefoot compile SCENE.sdf -o OUT.hlsl --target hlsl`"),
    (&["msl", "metal"], "Metal's language is written by `surefoot compile SCENE.sdf -o OUT.metal --target msl`"),
    (&["spv", "spirv"], "SPIR-V is written by `surefoot compile SCENE.sdf -o OUT.spv --target spirv`"),
    (&["csv", "ply"], "places of balls are written by `surefoot simulate SCENE.sdf -o OUT.csv` or `-o OUT.ply`"),
    (&["sfgrid"], "grids of distances are made of meshes by `surefoot bake MESH.obj -o OUT.sfgrid`"),
    (&["stl", "obj", "glb", "gltf", "3mf", "off", "step", "stp", "usd", "usdz"], "nothing writes meshes: a scene is a field, and what draws it is `surefoot render`"),
    (&["sdf"], "a scene is written by a person, and laid out by `surefoot fmt SCENE.sdf`"),
];

/// Why a command that writes files with the endings `own` does not write one with the ending of `path`; none where it may. Endings that nobody
/// knows are free.
fn ends_wrong(path: &std::path::Path, own: &[&str]) -> Option<String> {
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    if own.contains(&ending.as_str()) {
        return None;
    }
    let (_, written) = ENDINGS.iter().find(|(endings, _)| endings.contains(&ending.as_str()))?;
    Some(format!("{} is not what this writes: {written}", path.display()))
}

/// The paths of all that a scene reads: texts, those of images and of a sky (a folder, of a cubemap), meshes.
fn all_read(outcome: &Outcome) -> Vec<&str> {
    let images = outcome.compiled.iter().flat_map(|c| c.graph.images.iter().chain(c.blocks.environment.as_ref().map(|e| &e.file)));
    let meshes = outcome.compiled.iter().flat_map(|c| c.blocks.meshes.iter().map(|mesh| &mesh.file));
    let mut all: Vec<&str> = Vec::new();
    for path in outcome.files.iter().chain(images.map(|image| &image.path)).chain(meshes) {
        if !all.contains(&path.as_str()) {
            all.push(path);
        }
    }
    all
}

/// Whether a stream shows colours: it is a terminal, and nobody has asked for none (<https://no-color.org>).
fn colored(stream: &impl IsTerminal) -> bool {
    stream.is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Shows what a compilation found on stderr.
fn show_diagnostics(outcome: &Outcome) {
    show_found(outcome, &outcome.diagnostics);
}

/// Shows diagnostics of a compilation on stderr.
fn show_found(outcome: &Outcome, found: &[Diagnostic]) {
    if !found.is_empty() {
        eprint!("{}", diagnostic::render(&outcome.sources, found, colored(&std::io::stderr())));
    }
}

/// Shows what is wrong with the meshes of a scene that is drawn, and answers how the command ends.
fn show_broken(outcome: &Outcome, broken: &[Diagnostic]) -> Exit {
    if broken.is_empty() {
        return Exit::Fine;
    }
    show_found(outcome, broken);
    Exit::Errors
}

/// `2 errors and 1 warning`; empty where there is neither.
fn count(diagnostics: &[Diagnostic]) -> String {
    let of = |severity, one: &str, many: &str| match diagnostics
        .iter()
        .filter(|d| d.severity == severity)
        .count()
    {
        0 => None,
        1 => Some(format!("1 {one}")),
        n => Some(format!("{n} {many}")),
    };
    [of(Severity::Error, "error", "errors"), of(Severity::Warning, "warning", "warnings")]
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join(" and ")
}

/// Writes to stdout. A reader that has gone away (`| head`) is no failure.
fn print(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::usage(format!("can't write: {error}")))
        }
        _ => Ok(()),
    }
}

>>>>>>> fee6dab (`surefoot bake` makes a grid of signed distances of a mesh)
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_hangs_together() {
        Cli::command().debug_assert();
    }

    #[test]
    fn a_misspelled_command_is_no_scene() {
        assert!(misspelled("rendr").unwrap().contains("`render`"));
        assert_eq!(misspelled("render"), None);
        assert_eq!(misspelled("castle.sdf"), None);
        assert!(Cli::try_parse_from(["surefoot", "rendr", "castle.sdf"]).is_err());
    }

    #[test]
    fn a_scene_alone_is_a_view_of_it() {
        let cli = Cli::try_parse_from(["surefoot", "scene.sdf"]).unwrap();
        assert!(cli.command.is_none());
        assert_eq!(cli.view.unwrap().scene, "scene.sdf");
        assert!(Cli::try_parse_from(["surefoot"]).is_err());
        assert!(Cli::try_parse_from(["surefoot", "view"]).is_err());
    }
}
