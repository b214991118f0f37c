//! The command line: one file for each command.

mod aim;
#[cfg(feature = "gpu")]
mod bake;
mod bar;
mod bench;
mod check;
mod compile;
mod console;
mod explain;
mod export;
mod fmt;
mod grammar;
mod import;
mod lsp;
mod measure;
mod mesh;
mod page;
mod pick;
mod ray;
mod reference;
mod render;
mod shaders;
mod simulate;
#[cfg(feature = "gpu")]
mod stress;
mod values;
mod verify;
mod view;

use clap::{CommandFactory, Parser, Subcommand};
use console::Exit;
use std::process::ExitCode;
use surefoot_compiler::syntax::words;

/// A language for signed distance fields: its compiler and live editor.
#[derive(Debug, Parser)]
#[command(
    name = "surefoot",
    version,
    args_conflicts_with_subcommands = true,
    after_help = "Exit codes: 0 success; 1 the scene has errors (for verify: or a violation); 2 wrong usage or an unreadable file; 3 no graphics adapter \
                  with --device gpu."
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    view: Option<view::Args>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Open a scene in a live window, the same as `surefoot SCENE.sdf`.
    View(view::Args),
    /// Report the errors and warnings of scenes, and what the compiler knows about them.
    Check(check::Args),
    /// Test a scene's bound: could any ray step through the surface?
    Verify(verify::Args),
    /// Write the functions of a scene as shader text.
    Compile(compile::Args),
    /// Write a scene as one page to show.
    Export(export::Args),
    /// Format the text of scenes.
    Fmt(fmt::Args),
    /// Write the functions of a shader, GLSL or WGSL, as a scene.
    Import(import::Args),
    /// Serve editors: completion, diagnostics, renaming and more, over stdin and stdout.
    Lsp(lsp::Args),
    /// Draw pictures of a scene into files.
    Render(render::Args),
    /// Write the surface of a scene as a closed mesh, for example for a 3D printer.
    Mesh(mesh::Args),
    /// Measure a scene's solid: box, volume, area, centre of mass, pieces, each with its error.
    Measure(measure::Args),
    /// Name the shape of the text that made a pixel of a scene's picture.
    Pick(pick::Args),
    /// Follow the ray of a pixel step by step.
    Ray(ray::Args),
    /// Simulate a scene's balls and write their positions.
    Simulate(simulate::Args),
    /// Convert a mesh into a grid of signed distances.
    #[cfg(feature = "gpu")]
    Bake(bake::Args),
    /// Measure time, error and the tightness of factors.
    Bench(Box<bench::Args>),
    /// Run cases that are hard for fields, rays and balls.
    #[cfg(feature = "gpu")]
    Stress(stress::Args),
    /// Explain an error or a warning of the compiler.
    Explain(explain::Args),
    /// Write the reference of the language: a page and its pictures.
    Reference(reference::Args),
}

/// Reads the command line and does what it asks.
pub fn run() -> ExitCode {
    if std::env::args_os().len() < 2 {
        return ExitCode::from(alone() as u8);
    }
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
        None => Ok(alone()),
        Some(Command::View(args)) => view::run(&args),
        Some(Command::Check(args)) => check::run(&args),
        Some(Command::Verify(args)) => verify::run(&args),
        Some(Command::Compile(args)) => compile::run(&args),
        Some(Command::Export(args)) => export::run(&args),
        Some(Command::Fmt(args)) => fmt::run(&args),
        Some(Command::Import(args)) => import::run(&args),
        Some(Command::Lsp(args)) => lsp::run(&args),
        Some(Command::Render(args)) => render::run(&args),
        Some(Command::Mesh(args)) => mesh::run(&args),
        Some(Command::Measure(args)) => measure::run(&args),
        Some(Command::Pick(args)) => pick::run(&args),
        Some(Command::Ray(args)) => ray::run(&args),
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

/// The window's first page; where there can be none, the help.
fn alone() -> Exit {
    if view::start() {
        return Exit::Fine;
    }
    eprintln!("{}", Cli::command().render_help());
    Exit::Usage
}

/// The message for a misspelled command. Without it the word is read as a scene, and the error is about the words after it.
fn misspelled(word: &str) -> Option<String> {
    let cli = Cli::command();
    let near = words::nearest(word, cli.get_subcommands().map(clap::Command::get_name))?;
    (!std::path::Path::new(word).exists()).then(|| format!("there is no command `{word}`: did you mean `{near}`?"))
}

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
        assert!(Cli::try_parse_from(["surefoot", "view"]).is_err());
    }
}
