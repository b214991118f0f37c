//! What is asked, and what comes of each case.

use std::path::PathBuf;
use surefoot_compiler::diagnostic::{self, Severity};
use surefoot_compiler::functions::Kind;
use surefoot_compiler::{Compiled, MemoryLoader, Options, compile};

/// How much of it.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Each case must stay finite: no NaN and no infinity in any picture, ray or function. It must converge: no ray uses up its steps between \
surfaces, and balls come to rest. It must miss nothing: a ray that certainly hits does hit, one that certainly misses does miss, and no ball \
passes a wall. It must err by less than half a pixel: the 99th percentile of the distance between hit and surface; for balls, less than a \
twentieth of a radius. Interval arithmetic first certifies what each ray hits. A cell is red if its check fails, and the case then says why.")]
pub struct Args {
    /// Run only the cases whose names contain these words.
    pub(super) words: Vec<String>,
    /// Width and height of the pictures in pixels, a multiple of 32; costly scenes get a half or a quarter of that.
    #[arg(long, default_value_t = 64, value_parser = side, value_name = "N")]
    pub(super) size: u32,
    /// Number of balls that come to rest on the adapter.
    #[arg(long, default_value_t = 10_000, value_name = "N")]
    pub(super) balls: u32,
    /// How many seconds the balls get to come to rest.
    #[arg(long, default_value_t = 60, value_name = "N")]
    pub(super) seconds: u32,
    /// Write the numbers to this file.
    #[arg(long, value_name = "FILE")]
    pub(super) json: Option<PathBuf>,
    /// Write the table to this page; it replaces the old one.
    #[arg(long, value_name = "FILE")]
    pub(super) page: Option<PathBuf>,
}

pub(super) fn side(text: &str) -> Result<u32, String> {
    let fits = |n: &u32| n.is_multiple_of(32) && (32..=512).contains(n);
    text.parse().ok().filter(fits).ok_or_else(|| "write a multiple of 32, at most 512".to_owned())
}

/// What came of a case on one machine.
#[derive(Clone, Debug, Default)]
pub struct Cells {
    /// Numbers that were looked at, and how many of them are none or infinite.
    pub finite: (usize, usize),
    /// Rays or balls, and how many of them did not come to an end.
    pub ended: (usize, usize),
    /// Rays or balls of which it is known where they must go, and how many did not.
    pub missed: (usize, usize),
    /// The 99th percentile of the error and the largest: in pixels, or in radii of a ball. None where nothing is certain.
    pub error: Option<(f64, f64)>,
}

/// What came of a case.
pub struct Row {
    /// Its name.
    pub name: String,
    /// In 64 bits, and on the adapter.
    pub cells: [Cells; 2],
    /// Rays of which nothing is certain, of all.
    pub unknown: (usize, usize),
    /// What the compiler says: severity and words.
    pub said: Vec<(Severity, String)>,
    /// Whether the scene is refused.
    pub refused: bool,
    /// What the error is allowed to be.
    pub limit: f64,
    /// Why a cell is red, where one is.
    pub known: Option<&'static str>,
}

impl Row {
    /// Names of the red cells.
    pub fn red(&self) -> Vec<&'static str> {
        let any = |red: &dyn Fn(&Cells) -> bool| self.cells.iter().any(red);
        let mut red = Vec::new();
        let mut ask = |name, is| if is { red.push(name) };
        ask("finite", any(&|c| c.finite.1 > 0));
        ask("converged", any(&|c| c.ended.1 > 0));
        ask("missed", any(&|c| c.missed.1 > 0));
        ask("error", any(&|c| c.error.is_some_and(|(p99, _)| p99 > self.limit)));
        red
    }

    /// Whether a cell is red and nobody knows why.
    pub fn unexplained(&self) -> bool {
        self.known.is_none() && !self.red().is_empty()
    }
}

/// A scene of these words, and what the compiler says of it.
pub(super) fn scene(text: &str) -> (Option<Compiled>, Vec<(Severity, String)>) {
    let outcome = compile(&MemoryLoader::new().with("stress.sdf", text), "stress.sdf", &Options::default());
    let words = |d: &diagnostic::Diagnostic| (d.severity, format!("[{}] {}", d.code.row().name, d.message));
    let mut said: Vec<_> = outcome.diagnostics.iter().map(words).collect();
    if let Some(compiled) = outcome.compiled.as_ref().filter(|c| c.summary.kind == Kind::Unproven) {
        said.push((Severity::Warning, format!("[unproven] factor {:.3}", compiled.summary.factor)));
    }
    (outcome.compiled, said)
}
