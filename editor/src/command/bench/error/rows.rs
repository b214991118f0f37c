//! What is asked, and what comes of each method and scene.

use super::methods::METHODS;
use super::truth::{Errors, Unknown};
use std::path::PathBuf;
use std::time::Duration;

/// How scenes are measured.
#[derive(Debug, clap::Args)]
// The command's own arguments are a group of that name.
#[group(skip)]
pub struct Args {
    /// The tracing methods, separated by commas; all if this is left out.
    #[arg(long, value_delimiter = ',', value_name = "NAMES", value_parser = known_method)]
    pub(super) methods: Vec<String>,
    /// Also run Surefoot's method with other tolerances, budgets and bounds, for the curves.
    #[arg(long)]
    pub(super) sweep: bool,
    /// Width and height of each view in pixels; the width is a multiple of 8.
    #[arg(long, default_value = "128x128", value_parser = crate::command::render::size, value_name = "WxH")]
    pub(super) size: (u32, u32),
    /// Number of views around the target of the scene's camera.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=64), value_name = "N")]
    pub(super) views: u32,
    /// Timed runs of each method; the methods take turns. Default: 5, or 20 with --hand.
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..), value_name = "N")]
    pub rounds: Option<u32>,
    /// Write curves of time against error to this file as SVG.
    #[arg(long, value_name = "FILE")]
    pub(super) plot: Option<PathBuf>,
}

impl Args {
    pub(super) fn rounds(&self) -> u32 {
        self.rounds.unwrap_or(5)
    }
}

pub(super) fn known_method(name: &str) -> Result<String, String> {
    let names: Vec<&str> = METHODS.iter().map(|(name, _)| *name).collect();
    match names.contains(&name) {
        true => Ok(name.to_owned()),
        false => Err(format!("write some of {}", names.join(", "))),
    }
}

/// What came of a method in a scene.
pub struct Row {
    /// The method's name.
    pub method: String,
    /// What it is.
    pub about: &'static str,
    /// Median time of all views together, and the part of the first method's in the same round, median of the rounds.
    pub time: Duration,
    /// See `time`.
    pub ratio: f64,
    /// Operations of the kernel for each ray.
    pub operations: f64,
    /// Errors of all views together.
    pub errors: Errors,
}

/// What came of a scene.
pub struct Scene {
    /// Its file.
    pub path: String,
    /// Largest factor of the scene.
    pub factor: f64,
    /// Methods in their order.
    pub rows: Vec<Row>,
    /// Pixels of which it is not certain what they show.
    pub unknown: Vec<Unknown>,
    /// Methods that the scene does not allow, and why.
    pub left_out: Vec<(String, String)>,
}
