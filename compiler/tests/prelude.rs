//! The prelude: it reads, every declaration is documented, its examples compile and what it claims is true.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]

use surefoot_compiler::reference_text::{CHAPTERS, Entry, entries, language_reference};
use surefoot_compiler::source::Sources;
use surefoot_compiler::syntax::parse;

const FILES: [&str; 7] =
    ["numbers", "primitives", "drawings", "blends", "placement", "warps", "noise"];

fn text(name: &str) -> String {
    let path = format!("{}/prelude/{name}.sdf", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).expect("a file of the prelude")
}

fn assert_reads(name: &str, text: &str) {
    let mut sources = Sources::default();
    let file = sources.add(name, text);
    let (_, diagnostics) = parse(file, text);
    let shown: Vec<String> = diagnostics
        .iter()
        .map(|d| {
            let (n, l, c) = sources.position(d.span.file, d.span.start);
            format!("{n}:{l}:{c}: {} ({})", d.message, d.help)
        })
        .collect();
    assert!(shown.is_empty(), "{}", shown.join("\n"));
}

#[test]
fn it_reads_without_a_diagnostic() {
    for name in FILES {
        assert_reads(name, &text(name));
    }
}

#[test]
fn the_examples_read_without_a_diagnostic() {
    let folder = format!("{}/../examples", env!("CARGO_MANIFEST_DIR"));
    for folder in [folder.clone(), format!("{folder}/parts")] {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|e| e == "sdf") {
                let text = std::fs::read_to_string(&path).unwrap();
                assert_reads(&path.display().to_string(), &text);
            }
        }
    }
}

fn all_entries() -> Vec<Entry> {
    CHAPTERS.iter().flat_map(|(name, _, text)| entries(name, text)).collect()
}

#[test]
fn every_declaration_is_documented() {
    for entry in all_entries() {
        assert!(!entry.text.is_empty(), "{} has no words", entry.signature);
        assert!(!entry.source.is_empty(), "{} names no source", entry.signature);
        assert!(!entry.example.is_empty(), "{} has no example", entry.signature);
    }
}

/// `SUREFOOT_WRITE=1 cargo test -p surefoot-compiler --test prelude` writes the page anew, as `surefoot reference` does.
#[test]
fn the_reference_is_up_to_date() {
    let path = format!("{}/../docs/language.md", env!("CARGO_MANIFEST_DIR"));
    let page = language_reference();
    if std::env::var_os("SUREFOOT_WRITE").is_some() {
        std::fs::write(&path, &page).unwrap();
    }
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(written == page, "docs/language.md is not what `surefoot reference` writes");
}
