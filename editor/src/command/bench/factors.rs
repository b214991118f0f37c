//! How tight the factors are, and what it costs to find them: at once, within an edit's budget, in the background.

use super::milliseconds;
use crate::command::{Exit, Failure, compile_file, print, show_diagnostics};
use std::time::Instant;
use surefoot_compiler::Options;

/// Boxes that an edit may cost, and a search in the background.
const BUDGETS: [usize; 2] = [16_384, 131_072];
/// Points at which a formula is looked at: the constant is at least the steepest of them.
const SAMPLES: usize = 4_096;

/// Prints a row for each factor of the scenes.
pub fn run(paths: &[String]) -> Result<Exit, Failure> {
    let head = format!(
        "{:<34}{:<10}{:>9}{:>9}{:>8}{:>9}{:>9}{:>9}\n",
        "factor", "proof", "sampled", "at once", "edit", "ms", "longest", "ms"
    );
    print(head.as_bytes())?;
    let mut wrong = false;
    for path in paths {
        let outcome = compile_file(path, &Options::default())?;
        let Some(scene) = &outcome.compiled else {
            show_diagnostics(&outcome);
            wrong = true;
            continue;
        };
        let file = std::path::Path::new(path).file_stem().map_or(path.as_str().into(), |s| s.to_string_lossy());
        if scene.graph.factors.is_empty() {
            print(format!("{file:<34}every step is a whole distance\n").as_bytes())?;
        }
        for (i, factor) in scene.graph.factors.iter().enumerate() {
            let term = outcome.sources.text(factor.span).split_whitespace().collect::<Vec<_>>().join(" ");
            let term: String = format!("{file}: {term}").chars().take(32).collect();
            let least = scene.sampled_factor(i, SAMPLES);
            let mut row = format!("{term:<34}{:<10}{least:>9.3}{:>9.3}", factor.proof.name(), factor.lipschitz / least);
            for boxes in BUDGETS {
                let began = Instant::now();
                let found = scene.tighten(i, boxes);
                row += &format!("{:>8.3}{:>9.1}", found / least, milliseconds(began.elapsed()));
            }
            print(format!("{row}\n").as_bytes())?;
        }
    }
    Ok(if wrong { Exit::Errors } else { Exit::Fine })
}
