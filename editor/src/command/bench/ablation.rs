//! `surefoot bench --ablation`: what each rule for bounds gains. Scenes are compiled with all rules, and without each of them in turn.

use crate::command::bar::LateBar;
use crate::command::console::{Exit, Failure, print};
use crate::command::page;
use crate::files::FileLoader;
use rayon::prelude::*;
use std::fmt::Write;
use std::path::Path;
use surefoot_compiler::ablation::{Price, about};
use surefoot_compiler::rules::{RULES, Row, RuleSet};
use surefoot_compiler::{Loader, MemoryLoader, Options, compile};

/// The rules without which a scene gets worse, by their place in `rows`, and in what it does.
fn losses(loader: &(dyn Loader + Sync), path: &str, rows: &[Row]) -> Vec<(usize, Vec<String>)> {
    let whole = compile(loader, path, &Options::default());
    let about = about(&whole);
    let price = Price::of(&whole, about);
    let without = |(i, row): (usize, &Row)| {
        let options = Options { rules: RuleSet::default().without(row.rule), ..Options::default() };
        let words = Price::of(&compile(loader, path, &options), about).worse_than(&price);
        (!words.is_empty()).then_some((i, words))
    };
    rows.iter().enumerate().filter_map(without).collect()
}

/// Measures and prints a table, or makes it a section of a page.
pub fn run(scenes: &[String], file: Option<&Path>) -> Result<Exit, Failure> {
    let bar = LateBar::new();
    let own: Vec<Vec<String>> = RULES
        .par_iter()
        .map(|row| {
            let loader = MemoryLoader::new().with("scene.sdf", row.scene);
            losses(&loader, "scene.sdf", std::slice::from_ref(row)).into_iter().flat_map(|(_, words)| words).collect()
        })
        .collect();
    let done = std::sync::atomic::AtomicUsize::new(0);
    let of_scenes: Vec<Vec<(usize, Vec<String>)>> = scenes
        .par_iter()
        .map(|scene| {
            let found = losses(&FileLoader, scene, RULES);
            let done = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
            bar.show(done as f64 / scenes.len() as f64);
            found
        })
        .collect();
    bar.finish();
    let mut table = String::from("| rule | gives | tried | what it does | source | its own scene without it | other scenes |\n|---|---|---|---|---|---|---|\n");
    for (i, (row, own)) in RULES.iter().zip(&own).enumerate() {
        let name = |scene: &str| Path::new(scene).file_stem().map_or_else(|| scene.to_owned(), |s| s.to_string_lossy().into_owned());
        let worse = |(scene, found): (&String, &Vec<(usize, Vec<String>)>)| Some((name(scene), found.iter().find(|(rule, _)| *rule == i)?.1.join(", ")));
        let others: Vec<(String, String)> = scenes.iter().zip(&of_scenes).filter_map(worse).collect();
        let first = others.first().map_or_else(String::new, |(scene, words)| format!(": {scene} ({words})"));
        let words = |text: &str| text.replace('|', "\\|");
        writeln!(
            table,
            "| `{}` | {} | {} | {} `{}` | {} | {} | {}{first} |",
            row.id,
            row.gives.name(),
            row.cost.name(),
            words(row.what),
            row.file,
            words(row.source),
            if own.is_empty() { "the same".to_owned() } else { own.join(", ") },
            others.len()
        )
        .ok();
    }
    match file {
        Some(file) => page::put(file, "rules", &format!("{HEAD}{table}"))?,
        None => print(table.as_bytes())?,
    }
    Ok(if own.iter().any(Vec::is_empty) { Exit::Errors } else { Exit::Fine })
}

/// What stands above the table.
const HEAD: &str = "# Rules\n\n\
    A bound is safe without any of these rules; each makes it tighter. `surefoot check --without-rule ID` switches one off.\n\
    `surefoot bench --ablation tests/corpus/formulas/*.sdf --page docs/rules.md` writes this page. The last two columns say what becomes\n\
    worse when a rule is switched off: in the scene that the table has for it, and in how many of the scenes of that command.\n\n";
