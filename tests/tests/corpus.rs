//! What holds for every text of the language in the repository: examples, prelude, and the programs that are right.

use crate::common::{Disk, examples, root};
use std::path::PathBuf;
use std::sync::Arc;
use surefoot_compiler::diagnostic;
use surefoot_compiler::sampled::{Grid, Settings};
use surefoot_compiler::{Loader, Options, compile, syntax};

/// Files of the language below a folder, in order.
fn files(folder: &str) -> Vec<PathBuf> {
    let mut found: Vec<PathBuf> = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display())) {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "sdf") {
                found.push(path);
            }
        }
    }
    found.sort();
    assert!(!found.is_empty(), "{folder} is empty");
    found
}

/// The text of a scene's module.
fn module(path: &str) -> String {
    let outcome = compile(&Disk, path, &Options::default());
    let words = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    outcome.compiled.unwrap_or_else(|| panic!("{path} does not compile:\n{words}")).module.wgsl
}

#[test]
fn every_example_is_free_of_errors_and_warnings() {
    let mut wrong = String::new();
    for (_, path) in examples() {
        let mut outcome = compile(&Disk, &path, &Options::default());
        outcome.look();
        wrong += &diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn the_same_text_gives_the_same_bytes() {
    for (name, path) in examples() {
        assert!(module(&path) == module(&path), "{name} gives two modules");
    }
}

#[test]
fn texts_that_are_laid_out_stay_as_they_are() {
    let folders = ["examples", "compiler/prelude", "compiler/std", "tests/corpus/right"];
    for path in folders.iter().flat_map(|folder| files(folder)) {
        let text = std::fs::read_to_string(&path).unwrap();
        let laid_out = |text: &str| {
            syntax::format(text).unwrap_or_else(|found| panic!("{}: {} diagnostics", path.display(), found.len()))
        };
        let once = laid_out(&text);
        assert!(laid_out(&once) == once, "{} changes when it is laid out again", path.display());
        // The prelude and the examples are the form's own examples, so that laying them out can't change a scene.
        let corpus = path.starts_with(root().join("tests"));
        assert!(corpus || once == text, "{} is not laid out", path.display());
    }
}

/// The files of the examples, whose texts are laid out or not.
struct Examples {
    laid_out: bool,
}

impl Loader for Examples {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        let bytes = Disk.read(root().join("examples").join(path).to_str().unwrap())?;
        let is_text = self.laid_out && path.ends_with(".sdf");
        Ok(if is_text { syntax::format(std::str::from_utf8(&bytes).unwrap()).unwrap().into_bytes() } else { bytes })
    }

    fn grid(&self, path: &str, settings: Settings) -> Result<Arc<Grid>, String> {
        surefoot_runtime::mesh::field::grid(self, path, settings, &|_| {})
    }
}

#[test]
fn laying_out_does_not_change_a_scene() {
    for (name, _) in examples() {
        let path = format!("{name}.sdf");
        let code = |laid_out| compile(&Examples { laid_out }, &path, &Options::default()).compiled.map(|c| c.module.code().to_owned());
        let (before, after) = (code(false), code(true));
        assert!(before.is_some(), "{path} does not compile");
        assert!(before == after, "{path} is another scene when it is laid out");
    }
}
