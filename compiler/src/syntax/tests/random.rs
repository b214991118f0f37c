//! Whatever the text: no panic, no long wait, and places that lie within the text.

use super::*;
use crate::syntax::{format, tokens};
use proptest::prelude::*;
use std::time::{Duration, Instant};

/// Far above what any text of a few thousand bytes takes, even on a busy machine.
const LONG: Duration = Duration::from_secs(2);

fn survives(text: &str) -> Result<(), TestCaseError> {
    let start = Instant::now();
    let (_, diagnostics) = parse(FileId(0), text);
    for d in &diagnostics {
        prop_assert!(
            text.get(d.span.range()).is_some(),
            "{:?} in {}",
            d,
            text
        );
        prop_assert!(!d.message.is_empty() && !d.message.ends_with('.'), "{:?}", d);
        prop_assert!(!d.help.is_empty(), "{:?}", d);
    }
    prop_assert_eq!(format(text).is_err(), !diagnostics.is_empty());
    let mut end = 0;
    for (range, _) in tokens(text) {
        prop_assert!(
            range.start >= end && range.end > range.start && text.get(range.clone()).is_some()
        );
        end = range.end;
    }
    prop_assert!(start.elapsed() < LONG, "{:?} for {}", start.elapsed(), text);
    Ok(())
}

/// Pieces that make most of the language's mistakes likely.
const PIECES: &[&str] = &[
    "let",
    "a",
    "=",
    "field",
    "shape",
    "material",
    "scene",
    "camera",
    "{",
    "}",
    "(",
    ")",
    "[",
    "]",
    ",",
    ";",
    ":",
    ".",
    "..",
    "+",
    "-",
    "*",
    "|",
    "&",
    "!",
    "<",
    "==",
    "for",
    "in",
    "while",
    "if",
    "else",
    "by",
    "as",
    "import",
    "param",
    "\"x\"",
    "\"",
    "1",
    "0.5",
    "45deg",
    "#fff",
    "#1",
    "1e999",
    "$",
    "//",
    "/*",
    "*/",
    "///",
    "\n",
    "mesh",
    "light",
    "fn",
    "lipschitz",
    "exact",
    "->",
    "float",
    "true",
    ".5",
    "1.",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_characters(text in "\\PC*") {
        survives(&text)?;
    }

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        survives(&String::from_utf8_lossy(&bytes))?;
    }

    #[test]
    fn any_pieces(pieces in prop::collection::vec(prop::sample::select(PIECES), 0..80)) {
        survives(&pieces.join(" "))?;
        survives(&pieces.concat())?;
    }

    /// The contract with some pieces taken out, doubled, or put elsewhere.
    #[test]
    fn mutated_programs(edits in prop::collection::vec((any::<prop::sample::Index>(), 0usize..12, 0usize..3, any::<prop::sample::Index>()), 1..8)) {
        let mut bytes: Vec<char> = CONTRACT.chars().collect();
        for (at, length, what, other) in edits {
            let at = at.index(bytes.len());
            let end = (at + length).min(bytes.len());
            match what {
                0 => drop(bytes.drain(at..end)),
                1 => {
                    let piece: Vec<char> = bytes[at..end].to_vec();
                    let to = other.index(bytes.len());
                    bytes.splice(to..to, piece);
                }
                _ => {
                    let piece = PIECES[other.index(PIECES.len())];
                    bytes.splice(at..at, piece.chars());
                }
            }
        }
        survives(&bytes.into_iter().collect::<String>())?;
    }
}

/// Errors far from each other are all said, and only they.
#[test]
fn one_run_shows_all_errors() {
    let text = "let a = 1 +\nlet b = (2\nfield f(r flot) = r\nscene = sphere(1 2)\ncamera { eye = 3; fov 4 }\nshap x = 1\nlet c = ]";
    let (file, diagnostics) = parse(FileId(0), text);
    let places: Vec<_> = diagnostics
        .iter()
        .map(|d| text[..d.span.start as usize].matches('\n').count() + 1)
        .collect();
    assert_eq!(places, [1, 2, 3, 4, 5, 5, 5, 6, 7], "{}", shown(text, &diagnostics));
    assert_eq!(file.items.len(), 7);
}

#[test]
fn large_texts_take_no_time() {
    let start = Instant::now();
    let union = format!("scene = sphere(1){}", " | sphere(1).translate(1, 2, 3)".repeat(10_000));
    assert!(parse(FileId(0), &union).1.is_empty());
    assert!(format(&union).is_ok());
    let many = "shape a = box(1)\n".repeat(10_000);
    assert!(format(&many).is_ok());
    let list = format!("let l = [{}]", "(1, 2, 3), ".repeat(20_000));
    assert!(format(&list).is_ok());
    let wrong = "scene = sphere(1 2\n".repeat(5_000);
    assert!(parse(FileId(0), &wrong).1.len() >= 5_000);
    let open = "{ let a = ( [ ".repeat(5_000);
    assert!(!parse(FileId(0), &open).1.is_empty());
    let comments = format!("scene = f({})", "// a\n1,\n".repeat(10_000));
    assert!(format(&comments).is_ok());
    assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
}
