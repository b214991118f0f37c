//! What only a compilation tells: all diagnostics, and factors.

use crate::analysis::analysis_cache::Memory;
use crate::compiled::Outcome;
use crate::diagnostic::Diagnostic;
use crate::factors::{Explained, explain};
use crate::interface::Options;
use crate::loader::Loader;
use crate::pipeline::compile_remembering;
use crate::source::{FileId, Sources, Span};
use std::ops::Range;

/// A factor at its place, in words. It says what [`Explained`] says, without the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct FactorAt {
    /// The path of its text.
    pub path: String,
    /// Where the term stands.
    pub range: Range<usize>,
    /// The factor for all values of the sliders, and at their defaults.
    pub factor: [f64; 2],
    /// `×1.56`
    pub times: String,
    /// How it is known and where.
    pub knowledge: String,
    /// Why it is needed.
    pub reason: String,
    /// For which parameters it holds; empty where it depends on none.
    pub following: String,
    /// What it costs.
    pub cost: String,
    /// What would lower it.
    pub advice: String,
}

impl FactorAt {
    fn of(explained: &Explained, sources: &Sources) -> Self {
        let path = sources.get(explained.span.file).map_or(String::new(), |file| file.name.clone());
        Self {
            path,
            range: explained.span.range(),
            factor: [explained.factor, explained.live],
            times: explained.headline().split(' ').next().unwrap_or("").to_owned(),
            knowledge: explained.knowledge(),
            reason: explained.reason.clone(),
            following: explained.following("at the defaults"),
            cost: explained.cost(),
            advice: explained.advice.clone(),
        }
    }

    /// All of it as Markdown.
    pub fn markdown(&self) -> String {
        let following = if self.following.is_empty() { String::new() } else { format!("; {}", self.following) };
        format!("**Factor {}**: {}: {}{following}. It costs {}. Lower it with {}.", self.times, self.knowledge, self.reason, self.cost, self.advice)
    }
}

/// What a compilation tells of a scene, without the scene.
#[derive(Clone, Debug)]
pub struct Report {
    /// The texts that were read, for the places of diagnostics.
    pub sources: Sources,
    /// Errors and warnings, in the order of their places.
    pub diagnostics: Vec<Diagnostic>,
    /// Every file that was read or looked for, the scene's own first.
    pub files: Vec<String>,
    /// Its factors that are not 1, the larger of one place first.
    pub factors: Vec<FactorAt>,
    /// Declarations of the scene's own text that nothing uses: names and places.
    pub unused: Vec<(String, Span)>,
    /// Whether the scene could be compiled.
    pub is_whole: bool,
}

impl Report {
    /// The text that was read from a path.
    pub fn file(&self, path: &str) -> Option<FileId> {
        self.sources.iter().find(|(_, file)| file.name == path).map(|(id, _)| id)
    }
}

/// Compiles the scene at a path and tells what came of it. `memory` keeps what the next compilation of it need not find again.
pub fn examine(loader: &dyn Loader, path: &str, memory: &mut Memory) -> Report {
    let mut outcome = compile_remembering(loader, path, &Options::default(), memory, &mut |_| {});
    outcome.look();
    let Outcome { sources, diagnostics, files, compiled } = outcome;
    let mut factors: Vec<FactorAt> = Vec::new();
    let mut unused = Vec::new();
    if let Some(compiled) = &compiled {
        factors = explain(compiled, &sources).iter().filter(|known| (known.factor - 1.0).abs() > 1e-9).map(|known| FactorAt::of(known, &sources)).collect();
        factors.sort_by(|a, b| (&a.path, a.range.start, a.range.end).cmp(&(&b.path, b.range.start, b.range.end)).then(b.factor[0].total_cmp(&a.factor[0])));
        unused = compiled.unused.clone();
    }
    Report { sources, diagnostics, files, factors, unused, is_whole: compiled.is_some() }
}
