//! What the compiler makes of scenes, line for line as `tests/corpus/goldens.txt` says, so that a change shows in that file's diff what it changed.
//!
//! `SUREFOOT_GOLDENS=write cargo test --workspace --test compiler goldens::` writes the file anew.

use crate::common;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use surefoot_compiler::sampled::{Grid, Settings};
use surefoot_compiler::{Loader, Memory, Options, compile_remembering, factors};

/// Folders of scenes, from the top of the repository.
const FOLDERS: [&str; 7] =
    ["examples", "tests/corpus/cases", "tests/corpus/deformed", "tests/corpus/formulas", "tests/corpus/large", "tests/corpus/light", "tests/corpus/sound"];
/// Counts of steps may differ by this part between processors, whose sines differ in the last bit.
const STEPS_APART: f64 = 0.01;

fn top() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Files by their paths in a folder, whose own path is not seen.
struct Folder(PathBuf);

impl Loader for Folder {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        std::fs::read(self.0.join(path)).map_err(|e| e.to_string())
    }

    fn grid(&self, path: &str, settings: Settings) -> Result<Arc<Grid>, String> {
        common::grid(self, path, settings)
    }
}

/// The scenes of a folder, in order.
fn scenes(folder: &Path) -> Vec<PathBuf> {
    let files = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path());
    let mut scenes: Vec<PathBuf> = files.filter(|path| path.extension().is_some_and(|e| e == "sdf")).collect();
    scenes.sort();
    scenes
}

/// Fowler, Noll and Vo's hash of 64 bits, 1a.
fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// What is made of one scene: a line of its own, and one for each factor and each warning.
fn golden(loader: &Folder, path: &str, name: &str) -> String {
    let mut memory = Memory::default();
    let outcome = compile_remembering(loader, path, &Options::default(), &mut memory, &mut |_| {});
    let mut text = format!("{name}\n  steps {}\n", memory.steps);
    for diagnostic in &outcome.diagnostics {
        writeln!(text, "  {:?} {:?}", diagnostic.severity, diagnostic.code).unwrap();
    }
    let Some(compiled) = outcome.compiled else { return text };
    let wgsl = compiled.module.wgsl.as_bytes();
    writeln!(text, "  module {} bytes, hash {:016x}", wgsl.len(), hash(wgsl)).unwrap();
    writeln!(text, "  kind {:?}", compiled.summary.kind).unwrap();
    writeln!(text, "  solid {}", compiled.solid_box().map_or_else(|| "no box".to_owned(), |solid| solid.words())).unwrap();
    for factor in factors::explain(&compiled, &outcome.sources) {
        let region = factor.region.map_or_else(|| "everywhere".to_owned(), |[low, high]| format!("in {low:.4?} {high:.4?}"));
        let (_, line, column) = &factor.place;
        let (all, live, proof) = (factor.factor, factor.live, factor.proof);
        writeln!(text, "  ×{all:.4} live ×{live:.4} {proof:?} {} {line}:{column} {region}", factor.operation).unwrap();
    }
    text
}

/// All of them.
fn goldens() -> String {
    let top = top();
    let mut parts = Vec::new();
    for folder in FOLDERS {
        for path in scenes(&top.join(folder)) {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            parts.push((Folder(top.join(folder)), name.clone(), format!("{folder}/{name}")));
        }
    }
    let next = AtomicUsize::new(0);
    let made = Mutex::new(BTreeMap::new());
    let work = || {
        while let Some((i, (loader, path, name))) = Some(next.fetch_add(1, Relaxed)).and_then(|i| parts.get(i).map(|part| (i, part))) {
            let text = golden(loader, path, name);
            made.lock().unwrap().insert(i, text);
        }
    };
    std::thread::scope(|scope| (0..std::thread::available_parallelism().map_or(1, usize::from)).for_each(|_| drop(scope.spawn(work))));
    made.into_inner().unwrap().into_values().collect()
}

/// The number of a line of steps.
fn steps(line: &str) -> Option<f64> {
    line.strip_prefix("  steps ")?.parse().ok()
}

#[test]
fn the_compiler_makes_of_scenes_what_it_did() {
    let file = top().join("tests/corpus/goldens.txt");
    let made = goldens();
    if std::env::var("SUREFOOT_GOLDENS").is_ok_and(|value| value == "write") {
        std::fs::write(&file, &made).unwrap();
        return;
    }
    let known = std::fs::read_to_string(&file).unwrap();
    let mut scene = "";
    let mut wrong = Vec::new();
    for (known, made) in known.lines().zip(made.lines()) {
        scene = if made.starts_with(' ') { scene } else { made };
        let is_near = match (steps(known), steps(made)) {
            (Some(known), Some(made)) => (known - made).abs() <= STEPS_APART * known,
            _ => false,
        };
        if known != made && !is_near {
            wrong.push(format!("{scene}:\n    was {known}\n    is  {made}"));
        }
    }
    let (was, is) = (known.lines().count(), made.lines().count());
    assert!(
        wrong.is_empty() && was == is,
        "{} of {was} lines differ, {is} are made; the first:\n{}\nIf that is meant, SUREFOOT_GOLDENS=write cargo test --workspace --test compiler goldens::, and say in the commit why.",
        wrong.len(),
        wrong.iter().take(10).map(String::as_str).collect::<Vec<_>>().join("\n")
    );
}
