//! What all commands share: how they end, what they say, and what they must not write over.

use crate::files::FileLoader;
use std::io::{IsTerminal, Write};
use surefoot_compiler::diagnostic::{self, Diagnostic, Severity};
use surefoot_compiler::{Options, Outcome};

/// How a command ended, as the shell sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Exit {
    /// All is well.
    Fine = 0,
    /// The scene has errors (or is not laid out, for `fmt --check`; or a violation, for `verify`; or a mesh that is too far off, for `mesh --certify`).
    Errors = 1,
    /// Wrong usage, or a file that can't be read or written.
    Usage = 2,
    /// `--device gpu`, and there is no adapter.
    NoGraphics = 3,
    /// `mesh --certify`, and something could not be decided.
    Undecided = 4,
}

/// Why a command could not do what was asked. What is wrong with a scene is not here: diagnostics say it.
#[derive(Debug)]
pub struct Failure {
    pub exit: Exit,
    pub words: String,
}

impl Failure {
    /// Wrong usage, or a file that can't be read or written.
    pub fn usage(words: impl Into<String>) -> Self {
        Self { exit: Exit::Usage, words: words.into() }
    }
}

/// Compiles a scene on disk; fails only where the scene's own file can't be read.
pub fn compile_file(scene: &str, options: &Options) -> Result<Outcome, Failure> {
    crate::files::read(std::path::Path::new(scene))
        .map_err(|why| Failure::usage(format!("can't read {scene}: {why}")))?;
    Ok(surefoot_compiler::compile(&FileLoader, scene, options))
}

/// Fails where a path that is to be written is a file that the scene reads: a text, an image, one in a folder of images, or a mesh.
pub fn spare(path: &std::path::Path, outcome: &Outcome) -> Result<(), Failure> {
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
const ENDINGS: [(&[&str], &str); 18] = [
    (&["png"], "a picture is drawn by `surefoot render SCENE.sdf -o OUT.png`"),
    (&["jpg", "jpeg", "webp", "bmp", "tif", "tiff", "exr", "hdr", "svg"], "pictures are PNG alone, by `surefoot render SCENE.sdf -o OUT.png`"),
    (&["gif", "apng", "mp4", "webm"], "films are drawn by `surefoot render SCENE.sdf -o OUT.gif --frames 0..120`"),
    (&["mov", "avi", "mkv"], "films are GIF, APNG, MP4 and WebM, by `surefoot render SCENE.sdf -o OUT.mp4 --frames 0..120`"),
    (&["wgsl"], "WGSL is written by `surefoot compile SCENE.sdf -o OUT.wgsl`"),
    (&["glsl", "frag", "vert"], "GLSL is written by `surefoot compile SCENE.sdf -o OUT.glsl --target glsl`"),
    (&["hlsl"], "HLSL is written by `surefoot compile SCENE.sdf -o OUT.hlsl --target hlsl`"),
    (&["msl", "metal"], "Metal's language is written by `surefoot compile SCENE.sdf -o OUT.metal --target msl`"),
    (&["spv", "spirv"], "SPIR-V is written by `surefoot compile SCENE.sdf -o OUT.spv --target spirv`"),
    (&["csv"], "places of balls are written by `surefoot simulate SCENE.sdf -o OUT.csv`"),
    (&["ply"], "a scene's surface is written by `surefoot mesh SCENE.sdf -o OUT.ply`, and places of balls by `surefoot simulate SCENE.sdf -o OUT.ply`"),
    (&["stl"], "a scene's surface is written by `surefoot mesh SCENE.sdf -o OUT.stl`"),
    (&["obj"], "a scene's surface is written by `surefoot mesh SCENE.sdf -o OUT.obj`"),
    (&["glb"], "a scene's surface is written by `surefoot mesh SCENE.sdf -o OUT.glb`"),
    (&["3mf"], "a scene's surface is written by `surefoot mesh SCENE.sdf -o OUT.3mf`"),
    (&["gltf", "off", "step", "stp", "usd", "usdz"], "a scene's surface is written as STL, OBJ, PLY, GLB or 3MF, by `surefoot mesh SCENE.sdf -o OUT.stl`"),
    (&["sfgrid"], "grids of distances are made of meshes by `surefoot bake MESH.obj -o OUT.sfgrid`"),
    (&["sdf"], "a scene is written by a person, and laid out by `surefoot fmt SCENE.sdf`"),
];

/// Why a command that writes files with the endings `own` does not write one with the ending of `path`; none where it may. Endings that nobody
/// knows are free.
pub fn ends_wrong(path: &std::path::Path, own: &[&str]) -> Option<String> {
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    if own.contains(&ending.as_str()) {
        return None;
    }
    let (_, written) = ENDINGS.iter().find(|(endings, _)| endings.contains(&ending.as_str()))?;
    Some(format!("{} is not what this writes: {written}", path.display()))
}

/// The paths of all that a scene reads: texts, those of images and of a sky (a folder, of a cubemap), meshes.
pub fn all_read(outcome: &Outcome) -> Vec<&str> {
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
pub fn colored(stream: &impl IsTerminal) -> bool {
    stream.is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
}

/// Shows what a compilation found on stderr.
pub fn show_diagnostics(outcome: &Outcome) {
    show_found(outcome, &outcome.diagnostics);
}

/// Shows diagnostics of a compilation on stderr.
pub fn show_found(outcome: &Outcome, found: &[Diagnostic]) {
    if !found.is_empty() {
        eprint!("{}", diagnostic::render(&outcome.sources, found, colored(&std::io::stderr())));
    }
}

/// Shows what is wrong with the meshes of a scene that is drawn, and answers how the command ends.
pub fn show_broken(outcome: &Outcome, broken: &[Diagnostic]) -> Exit {
    if broken.is_empty() {
        return Exit::Fine;
    }
    show_found(outcome, broken);
    Exit::Errors
}

/// `2 errors and 1 warning`; empty where there is neither.
pub fn count(diagnostics: &[Diagnostic]) -> String {
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
pub fn print(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::usage(format!("can't write: {error}")))
        }
        _ => Ok(()),
    }
}
