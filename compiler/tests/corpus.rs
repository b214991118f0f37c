//! The corpus: programs that are right and programs that are wrong, and what the compiler says to them.
//!
//! A program of `tests/corpus/wrong` says what is expected in comments, one for each error:
//!
//! ```text
//! //~ 3:9 unexpected
//! //~ parts/open.sdf:1:17 unclosed
//! ```
//!
//! which is line, column (both from 1, these comments counted, columns in characters) and code; a file name where the error is in an
//! import. All errors are expected and no others; a warning is checked where one is expected. `//~?` says what is owed: it is not
//! said yet, and the test fails when it is, so that the mark is taken out. `CORPUS=name` runs only the
//! programs whose name contains it, and shows all that is said to them.

use proptest::prelude::*;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use surefoot_compiler::diagnostic::{CODES, Code, Diagnostic, Severity, render};
use surefoot_compiler::{Loader, MemoryLoader, Options, Outcome};

/// Codes that no program of the corpus triggers, and why.
const WITHOUT_A_PROGRAM: &[(Code, &str)] =
    &[
        (Code::BrokenFile, "the compiler opens no mesh"),
        (Code::Shader, "the shader is another file, and no program: tests/shaders.rs"),
        (Code::BadImage, "who draws reads the images"),
    ];

/// Files below a folder.
struct Folder(PathBuf);

impl Loader for Folder {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        std::fs::read(self.0.join(path)).map_err(|e| e.to_string())
    }
}

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/corpus").join(name)
}

/// The programs of a folder that were asked for, by their names.
fn programs(folder: &Path) -> Vec<String> {
    let wanted = std::env::var("CORPUS").unwrap_or_default();
    let entries =
        std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> =
        entries.filter(|n| n.ends_with(".sdf") && n.contains(&wanted)).collect();
    names.sort();
    names
}

fn compile(folder: &Path, name: &str) -> Outcome {
    let mut outcome = surefoot_compiler::compile(&Folder(folder.to_path_buf()), name, &Options::default());
    outcome.look();
    outcome
}

/// What a program's comments say of it.
struct Expectation {
    /// `file:line:column code`, sorted.
    errors: Vec<String>,
    /// The same.
    warnings: Vec<String>,
    /// Whether the compiler does not say so yet.
    owed: bool,
}

impl Expectation {
    fn of(text: &str, name: &str) -> Self {
        let mut said = Self { errors: Vec::new(), warnings: Vec::new(), owed: false };
        for line in text.lines().filter_map(|line| line.trim().strip_prefix("//~")) {
            said.owed |= line.starts_with('?');
            let line = line.trim_start_matches('?').trim();
            let (place, code) = line.split_once(' ').unwrap_or_else(|| panic!("{name}: `{line}`"));
            let row = CODES.iter().find(|row| row.name == code.trim());
            let row = row.unwrap_or_else(|| panic!("{name}: no code is called `{code}`"));
            let place = if place.matches(':').count() == 1 {
                format!("{name}:{place}")
            } else {
                place.to_string()
            };
            let list = match row.severity {
                Severity::Error => &mut said.errors,
                Severity::Warning => &mut said.warnings,
            };
            list.push(format!("{place} {}", row.name));
        }
        said.errors.sort();
        said.warnings.sort();
        said
    }
}

fn found(outcome: &Outcome, severity: Severity) -> Vec<String> {
    let some = outcome.diagnostics.iter().filter(|d| d.severity == severity);
    let mut all: Vec<String> = some
        .map(|d| {
            let (file, line, column) = outcome.sources.position(d.span.file, d.span.start);
            format!("{file}:{line}:{column} {}", d.code.row().name)
        })
        .collect();
    all.sort();
    all
}

/// Whether a diagnostic reads as all of them do: a sentence without a full stop, in the reader's own text, with what to write instead.
fn is_well_said(outcome: &Outcome, d: &Diagnostic) -> bool {
    let (file, ..) = outcome.sources.position(d.span.file, d.span.start);
    let sentence = |text: &str| !text.is_empty() && !text.ends_with('.') && !text.contains('\n');
    sentence(&d.message)
        && sentence(&d.help)
        && !d.message.starts_with(char::is_uppercase)
        && !file.starts_with('<')
}

#[test]
fn wrong_programs_are_told_what_is_wrong() {
    let folder = folder("wrong");
    let names = programs(&folder);
    let chosen = std::env::var("CORPUS").is_ok();
    let mut failures = Vec::new();
    for name in &names {
        let text = String::from_utf8_lossy(&std::fs::read(folder.join(name)).unwrap()).into_owned();
        let expected = Expectation::of(&text, name);
        let outcome = compile(&folder, name);
        let (errors, warnings) =
            (found(&outcome, Severity::Error), found(&outcome, Severity::Warning));
        let said = render(&outcome.sources, &outcome.diagnostics, false);
        if chosen {
            println!("{said}");
        }
        let right = expected.errors == errors
            && expected.warnings.iter().all(|w| warnings.contains(w))
            && outcome.diagnostics.iter().all(|d| is_well_said(&outcome, d));
        if right && expected.owed {
            failures.push(format!("{name}: no longer owed, write `//~` in place of `//~?`"));
        } else if !right && !expected.owed {
            failures.push(format!(
                "{name}\n  expected {:?} {:?}\n  found    {errors:?} {warnings:?}\n{said}",
                expected.errors, expected.warnings
            ));
        }
    }
    assert!(failures.is_empty(), "{} of {}:\n{}", failures.len(), names.len(), failures.join("\n"));
    assert!(chosen || names.len() >= 80);
}

#[test]
fn right_programs_are_right() {
    let folder = folder("right");
    for name in programs(&folder) {
        let outcome = compile(&folder, &name);
        assert!(!outcome.has_errors(), "{}", render(&outcome.sources, &outcome.diagnostics, false));
    }
}

#[test]
fn every_code_has_a_wrong_program() {
    let folder = folder("wrong");
    let mut seen = BTreeSet::new();
    for name in programs(&folder) {
        let text = std::fs::read(folder.join(&name)).unwrap();
        let expected = Expectation::of(&String::from_utf8_lossy(&text), &name);
        let said = expected.errors.into_iter().chain(expected.warnings);
        seen.extend(said.filter_map(|e| e.rsplit(' ').next().map(str::to_string)));
    }
    if std::env::var("CORPUS").is_ok() {
        return;
    }
    let missing: Vec<_> = CODES
        .iter()
        .filter(|row| {
            !seen.contains(row.name) && !WITHOUT_A_PROGRAM.iter().any(|(code, _)| *code == row.code)
        })
        .map(|row| row.name)
        .collect();
    assert!(missing.is_empty(), "no program of the corpus shows {missing:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    /// Programs of the corpus with pieces taken out, doubled and put elsewhere: whatever is said, nothing panics and nothing hangs.
    #[test]
    fn mutated_programs_end(
        program in any::<prop::sample::Index>(),
        right in any::<bool>(),
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0usize..10, 0usize..3, any::<prop::sample::Index>()), 1..5),
    ) {
        let folder = folder(if right { "right" } else { "wrong" });
        let names = programs(&folder);
        let name = &names[program.index(names.len())];
        let mut text: Vec<char> = String::from_utf8_lossy(&std::fs::read(folder.join(name)).unwrap()).chars().collect();
        for (at, length, what, to) in edits {
            let at = at.index(text.len().max(1)).min(text.len());
            let end = (at + length).min(text.len());
            let piece = text[at..end].to_vec();
            let to = to.index(text.len() + 1);
            match what {
                0 => drop(text.drain(at..end)),
                1 => drop(text.splice(to..to, piece)),
                _ => {
                    text.drain(at..end);
                    let to = to.min(text.len());
                    text.splice(to..to, piece);
                }
            }
        }
        let text: String = text.into_iter().collect();
        let start = Instant::now();
        let outcome = surefoot_compiler::compile(&Edited { folder: Folder(folder), name, text: &text }, name, &Options::default());
        let time = start.elapsed();
        prop_assert!(time < Duration::from_secs(10), "{time:?} for {text}");
        for d in &outcome.diagnostics {
            prop_assert!(outcome.sources.get(d.span.file).is_some(), "{d:?}");
        }
    }
}

#[test]
fn of_very_many_mistakes_some_are_shown() {
    let text = format!("scene = {}", "#".repeat(50_000));
    let outcome = surefoot_compiler::compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
    let said = render(&outcome.sources, &outcome.diagnostics, false);
    assert!(said.matches("error[").count() == 100 && said.contains("more"));
}

/// A folder in which one file holds another text.
struct Edited<'a> {
    folder: Folder,
    name: &'a str,
    text: &'a str,
}

impl Loader for Edited<'_> {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        if path == self.name { Ok(self.text.as_bytes().to_vec()) } else { self.folder.read(path) }
    }
}

/// The smallest program of each row of the table shows what the row speaks of. Some rows have none: they need other files, bytes that
/// are not text, or more than a person would read.
#[test]
fn the_table_of_codes_is_right() {
    for row in CODES.iter().filter(|row| !row.program.is_empty() && !row.program.contains('…')) {
        let loader = MemoryLoader::new().with("main.sdf", row.program);
        let mut outcome = surefoot_compiler::compile(&loader, "main.sdf", &Options::default());
        outcome.look();
        let codes: Vec<_> = outcome.diagnostics.iter().map(|d| d.code).collect();
        assert!(codes.contains(&row.code), "{}: {codes:?}\n{}", row.name, row.program);
    }
}
