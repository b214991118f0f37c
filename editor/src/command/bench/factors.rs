//! How tight the factors are, and what it costs to find them: at once, within an edit's budget, in the background.

use super::timing::milliseconds;
use crate::command::console::{Exit, Failure, compile_file, print, show_diagnostics};
use crate::files::FileLoader;
use std::time::Instant;
use surefoot_compiler::factors::{certified, judge, rules as read};
use surefoot_compiler::{Loader, MemoryLoader, Options, compile};

/// Boxes that an edit may cost, and a search in the background.
const BUDGETS: [usize; 2] = [16_384, 131_072];
/// Half the cube in which the certified supremum is looked for where a factor holds for all of space.
const CUBE: f64 = 4.0;
/// Points at which a formula is looked at: the constant is at least the steepest place from there uphill.
const SAMPLES: usize = 4_096;

/// Prints a row for each factor of the scenes.
pub fn run(paths: &[String]) -> Result<Exit, Failure> {
    let head = format!(
        "{:<34}{:<10}{:>9}{:>10}{:>9}{:>8}{:>9}{:>9}{:>9}\n",
        "factor", "proof", "attained", "certified", "at once", "edit", "ms", "longest", "ms"
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
            let certified = certified(scene, Some(i), CUBE, CERTIFIED);
            let least = certified.map_or(0.0, |c| c.at_least).max(scene.sampled_factor(i, SAMPLES));
            let at_most = certified.map_or("-".to_owned(), |c| format!("{:.3}", c.at_most));
            let mut row = format!("{term:<34}{:<10}{least:>9.3}{at_most:>10}{:>9.3}", factor.proof.name(), factor.lipschitz / least);
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

/// Boxes that a certified supremum may cost.
const CERTIFIED: usize = 20_000;

/// Prints a row for each rule: its factor, the steepest place found, what is certified, and how tight that is.
pub fn rules(path: &str) -> Result<Exit, Failure> {
    let bytes = FileLoader.read(path).map_err(Failure::usage)?;
    let rules = read(&String::from_utf8_lossy(&bytes)).map_err(Failure::usage)?;
    print(format!("{:<38}{:>9}{:>10}{:>10}{:>10}\n", "rule", "factor", "attained", "at most", "tightness").as_bytes())?;
    let mut wrong = false;
    for rule in rules {
        let outcome = compile(&MemoryLoader::new().with("rule.sdf", rule.text), "rule.sdf", &Options::default());
        let Some(scene) = &outcome.compiled else {
            show_diagnostics(&outcome);
            wrong = true;
            continue;
        };
        let found = judge(scene, rule.half, CERTIFIED);
        // Where the certified end is loose it says little.
        let at_most = found.at_most.filter(|most| *most < 1000.0).map_or("-".to_owned(), |most| format!("{most:.4}"));
        let tightness = found.factor / found.attained;
        wrong |= tightness < 1.0 - 1e-9;
        let loose = rule.loose.map_or(String::new(), |why| format!("  {why}"));
        let row = format!("{:<38}{:>9.4}{:>10.4}{at_most:>10}{tightness:>10.3}{loose}\n", rule.name, found.factor, found.attained);
        print(row.as_bytes())?;
    }
    Ok(if wrong { Exit::Errors } else { Exit::Fine })
}
