//! The prelude: it reads, every declaration is documented, its examples compile and what it claims is true.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]

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
