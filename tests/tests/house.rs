//! The rules of the house, as far as a program can see them.

use crate::common::root;
use std::path::{Path, PathBuf};

/// All texts of the repository, in order, with their paths from its top.
fn texts() -> Vec<(String, String)> {
    let mut found = Vec::new();
    walk(&root(), &mut found);
    let top = root();
    let named = |path: PathBuf| {
        let name = path.strip_prefix(&top).unwrap().to_str().unwrap().to_owned();
        std::fs::read_to_string(path).ok().map(|text| (name, text))
    };
    let mut texts: Vec<(String, String)> = found.into_iter().filter_map(named).collect();
    texts.sort();
    assert!(texts.len() > 50);
    texts
}

fn walk(folder: &Path, found: &mut Vec<PathBuf>) {
    // What is built, installed or made by the version control is not the repository's.
    const OTHERS: [&str; 5] = [".git", "target", "node_modules", "out", "__pycache__"];
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        if OTHERS.contains(&name) {
            continue;
        }
        if path.is_dir() { walk(&path, found) } else { found.push(path) }
    }
}

#[test]
fn every_dependency_says_what_it_is_for() {
    let mut wrong = Vec::new();
    for (name, text) in texts().iter().filter(|(name, _)| name.ends_with("Cargo.toml")) {
        let mut dependencies = false;
        let mut commented = false;
        for line in text.lines() {
            if line.starts_with('[') {
                dependencies = line.contains("dependencies]");
            } else if dependencies && line.contains('=') && !line.starts_with('#') {
                // What the workspace declares has its comment there, and its own crates need none.
                let ours = line.contains("workspace = true") || line.contains("path = \"compiler\"") || line.contains("path = \"hosts\"") || line.contains("path = \"runtime\"");
                if !commented && !ours {
                    wrong.push(format!("{name}: {line}"));
                }
            }
            // A comment holds for the lines below it, until an empty one or one that is no dependency.
            commented = line.starts_with('#') || commented && line.contains('=');
        }
    }
    assert!(wrong.is_empty(), "dependencies without a comment:\n{}", wrong.join("\n"));
}

#[test]
fn every_folder_and_crate_starts_with_what_it_is() {
    let mut wrong = Vec::new();
    for (name, text) in texts() {
        let speaks = match name.rsplit('.').next() {
            Some("rs") => text.starts_with("//! "),
            Some("sdf") if name.starts_with("examples") || name.starts_with("compiler/prelude") || name.starts_with("compiler/std") => text.starts_with("//! "),
            Some("wgsl") => text.starts_with("// "),
            _ => true,
        };
        if !speaks {
            wrong.push(name);
        }
    }
    assert!(wrong.is_empty(), "files whose first line does not say what they are:\n{}", wrong.join("\n"));
}

/// A file of tests that no program names would never run, and nothing would say so.
#[test]
fn every_file_of_tests_is_in_a_program() {
    for name in ["compiler", "tests"] {
        let folder = root().join(name);
        let manifest = std::fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        let main = std::fs::read_to_string(folder.join("tests/main.rs")).unwrap();
        for entry in std::fs::read_dir(folder.join("tests")).unwrap() {
            let path = entry.unwrap().path();
            let file = path.file_stem().unwrap().to_str().unwrap();
            let module = path.extension().is_some_and(|e| e == "rs") || path.join("mod.rs").exists();
            let named = main.contains(&format!("mod {file};")) || manifest.contains(&format!("[[test]]\nname = \"{file}\""));
            assert!(!module || file == "main" || named, "{name}/tests/{file}.rs is in no program of tests");
        }
    }
}

#[test]
fn nothing_depends_on_where_it_was_written() {
    let mut wrong = Vec::new();
    for (name, text) in texts() {
        for (number, line) in text.lines().enumerate() {
            let mut place = |what: &str| wrong.push(format!("{name}:{}: {what}", number + 1));
            let folders = [["/ho", "me/"].concat(), ["/ro", "ot/"].concat(), ["/Us", "ers/"].concat()];
            if folders.iter().any(|f| line.contains(f.as_str())) {
                place("a person's folder");
            }
            // A lock may name the registries that everybody has.
            let locked = name.ends_with("Cargo.lock") || name.ends_with("package-lock.json");
            let source = line.split('"').find(|part| part.contains("://"));
            let public = ["registry+https://github.com/rust-lang/crates.io-index", "https://registry.npmjs.org/"];
            let private = |source: &&str| !public.iter().any(|p| source.starts_with(p));
            if let Some(source) = source.filter(private).filter(|_| locked && !line.contains("\"url\"")) {
                place(source);
            }
            if line.contains('\r') || line.ends_with(char::is_whitespace) && !name.ends_with(".md") && !name.contains("corpus/") {
                place("white space at the end of the line");
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
