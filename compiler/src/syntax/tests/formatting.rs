//! The canonical form keeps the meaning and the comments, and is its own canonical form.

use super::*;
use crate::syntax::format;
use crate::syntax::lexer::{TokenKind, lex};
use proptest::prelude::*;

/// Every construct of the language.
const EVERYTHING: &str = r#"//! Head of the file.
//! Second line.

import "a.sdf"
import "b.sdf" as b
param n: int = 6 in 1..12 "how many"
param on = true
param spot = (0, 1, 0) in (-2, 0, -2)..(2, 3, 2)
param style = doric in [doric, ionic]
param angle = 30deg in 0deg..90deg
/// Documented.
let a = -b.c[1] * 2 % 3 & d + 0.5turn - 1e-3 | !e
let l = [1, 2, (3, 4), #fff, "text \" \n", true]
let m = [for i in 0..10 { (cos(i * 36deg), sin(i * 36deg)) }]
let q = p, s = 1 for i in 0..n while length(q) < 8 && s != 2 { let t = abs(q) - 1; q = 2 * t, s = 2 * s }
field egg(r: float, k: float = 0.2) exact = { let s = 1 + k; /// Of it.
 let t = s; length((p.x * s, p.y, p.z * t)) - r }
blend smooth(a, b, k: field) lipschitz max(a, b) = min(a, b) - (k)
warp2 w(v: [vec4], u: [[float]] = [[1], []]) = p + v[0].xy
shape tower(s: shape, count = 4) = for i in 0..count by smooth_union(0.1, k: 2) { s.translate(0, i, 0) }.round(0.1).material(m).shell(0.1)
shape t2 = if n == 1 { sphere } else if n <= 2 { box(1) } else { nothing }
fn f(t) = for v in [1, 2] by + { v } * for v in [1, 2] by b.fold { { let z = 1; v } }
material stone { }
material bands(count: float) { let t = fract(count * p.y); color: mix(#204060, #f0e0c0, step(0.5, t)), roughness: 0.5 }
scene = plane(y) | a.b(1, 2).c(x: 3) - (box(1) | sphere) & f()
camera { eye: (6, 4, 8), camera: 1 }
light sun { shadow: soft(16), range: 1..2 }
mesh statue "statue.obj" { scale: 0.5 }
"#;

fn erased(file: &File) -> String {
    let text = format!("{file:?}");
    let mut out = String::new();
    let mut rest = text.as_str();
    while let Some((before, after)) = rest.split_once("Span { ") {
        out.push_str(before);
        rest = after.split_once('}').unwrap().1;
    }
    out + rest
}

fn comments(text: &str) -> Vec<&str> {
    let (tokens, _) = lex(FileId(0), text);
    let is_comment = |kind| {
        matches!(
            kind,
            TokenKind::LineComment | TokenKind::BlockComment | TokenKind::Doc | TokenKind::FileDoc
        )
    };
    let mut all: Vec<&str> = tokens
        .iter()
        .filter(|t| is_comment(t.kind))
        .map(|t| t.text(text).trim_end().trim_start_matches('/'))
        .collect();
    all.sort_unstable();
    all
}

pub(super) fn holds(text: &str) -> Result<(), TestCaseError> {
    let Ok(once) = format(text) else {
        return Err(TestCaseError::fail(format!(
            "{text}\n---\n{}",
            shown(text, &parse(FileId(0), text).1)
        )));
    };
    let (before, _) = parse(FileId(0), text);
    let (after, wrong) = parse(FileId(0), &once);
    prop_assert!(wrong.is_empty(), "{}\n---\n{}", text, shown(&once, &wrong));
    prop_assert_eq!(erased(&before), erased(&after), "{}\n---\n{}", text, once);
    prop_assert_eq!(comments(text), comments(&once), "{}\n---\n{}", text, once);
    let twice = format(&once).unwrap();
    let first = once.lines().zip(twice.lines()).find(|(a, b)| a != b);
    prop_assert!(once == twice, "{text}\n--- once\n{once}\n--- twice\n{twice}\n--- {first:?}");
    for line in once.lines() {
        prop_assert_eq!(line, line.trim_end(), "{}", once);
    }
    prop_assert!(!once.contains("\n\n\n"), "{}", once);
    Ok(())
}

#[test]
fn a_number_has_digits_on_both_sides_of_its_point() {
    assert_eq!(format("let a = [.5, 1., -.25turn, 3, 2.*x]").unwrap(), "let a = [0.5, 1.0, -0.25turn, 3, 2.0 * x]\n");
}

#[test]
fn the_contract_and_everything_hold() {
    holds(CONTRACT).unwrap();
    holds(EVERYTHING).unwrap();
    holds("").unwrap();
    holds("// only\n\n\n// comments\n\n").unwrap();
}

#[test]
fn what_ends_a_declaration_in_other_languages_is_taken_and_not_kept() {
    let plain = "let a = 1\nmaterial red { color: #ff0000 }\nscene = sphere(a).material(red)\n";
    let ended = "let a = 1;\nmaterial red { color: #ff0000 };\nscene = sphere(a).material(red);;\n";
    assert_eq!(format(ended).unwrap(), plain);
}

#[test]
fn a_wrong_text_is_not_touched() {
    assert_eq!(format("scene = sphere(1").unwrap_err().len(), 1);
}

/// A program whose tokens have other white space and comments between them.
fn respaced(program: &str, gaps: &[u8]) -> String {
    let (tokens, _) = lex(FileId(0), program);
    let mut out = String::new();
    let mut gaps = gaps.iter().cycle();
    let mut end = 0;
    for (i, token) in tokens.iter().enumerate() {
        let was = &program[end..token.start as usize];
        end = token.end as usize;
        let gap = match gaps.next().copied().unwrap_or(0) {
            0 => format!(" /* {i} */ "),
            1 => format!(" // {i}\n"),
            2 => format!("\n// {i}\n"),
            3 => format!("\n\n\n/* {i}\n  second */\n"),
            4 => format!("\n/// {i}\n"),
            5 => format!(" /* {i} */ // {i}\n"),
            6 => format!("\n/* {i} */ "),
            7 => format!("\n\n// {i}\n\n"),
            8 => format!(" /// {i}\n"),
            9 | 10 => "\n".into(),
            11 => "\n\n\n".into(),
            12 => " ".into(),
            _ => was.to_string(),
        };
        // Glued tokens stay glued, where a space would make another text: none does.
        out.push_str(&gap);
        out.push_str(token.text(program));
        if matches!(token.kind, TokenKind::LineComment | TokenKind::Doc | TokenKind::FileDoc) {
            out.push('\n');
        }
    }
    out
}

/// Two declarations that follow each other, so that what fails is short.
fn two_of(program: &str, index: usize) -> &str {
    let items = read(program).items;
    let first = index % (items.len() - 1);
    let start = if first == 0 { 0 } else { items[first - 1].span.end as usize };
    &program[start..items[first + 1].span.end as usize]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, max_shrink_iters: 4000, ..ProptestConfig::default() })]

    #[test]
    fn comments_anywhere_survive(
        index in 0usize..1000,
        gaps in prop_oneof![
            prop::collection::vec(0u8..200, 1..100),
            prop::collection::vec(0u8..40, 1..100),
            prop::collection::vec(0u8..16, 1..100),
        ],
    ) {
        holds(&respaced(two_of(EVERYTHING, index), &gaps))?;
        holds(&respaced(two_of(CONTRACT, index), &gaps))?;
    }
}

#[test]
fn lines_are_broken_where_they_are_too_long() {
    let long = "let atoms = [(0.1, 0.2, 0.3, 1), (0.1, 0.2, 0.3, 1), (0.1, 0.2, 0.3, 1), (0.1, 0.2, 0.3, 1), (1, 2, 3, 1)]
shape temple(columns: int, height: float) = plane(y).material(stone) | pillar(height).ring(columns, 4) | box(1, 2, 3)
shape dotted = box(1, 2, 3).translate(1, 2, 3).rotate(y, 45deg).twist(y, 0.3).round(0.1).material(stone).repeat(3)
field h = sqrt(min(dot(first_long_name_of_all, first_long_name_of_all), dot(second_name_of_all, second_name_of_all)))
scene = for i in 0..count { for j in 0..count by smooth_union(0.1) { sphere(0.3).translate(i * 2, hash((i, j)), j * 2) } }.within(a)

      | (first_shape_with_a_long_name | second_shape_with_a_long_name | third_shape_with_a_long_name | fourth).round(0.1)
camera { eye: (6, 4, 8) * mix(0.5, 1.5, param_of_the_scene) + (0, height_of_the_camera, 0) * another_factor, fov: 45deg }
";
    let short = "let atoms = [
  (0.1, 0.2, 0.3, 1), (0.1, 0.2, 0.3, 1), (0.1, 0.2, 0.3, 1), (0.1, 0.2, 0.3, 1), (1, 2, 3, 1),
]
shape temple(columns: int, height: float) =
  plane(y).material(stone) | pillar(height).ring(columns, 4) | box(1, 2, 3)
shape dotted = box(1, 2, 3)
  .translate(1, 2, 3)
  .rotate(y, 45deg)
  .twist(y, 0.3)
  .round(0.1)
  .material(stone)
  .repeat(3)
field h = sqrt(min(
  dot(first_long_name_of_all, first_long_name_of_all),
  dot(second_name_of_all, second_name_of_all),
))
scene = for i in 0..count {
          for j in 0..count by smooth_union(0.1) {
            sphere(0.3).translate(i * 2, hash((i, j)), j * 2)
          }
        }.within(a)

      | (first_shape_with_a_long_name
         | second_shape_with_a_long_name
         | third_shape_with_a_long_name
         | fourth).round(0.1)
camera {
  eye: (6, 4, 8) * mix(0.5, 1.5, param_of_the_scene)
       + (0, height_of_the_camera, 0) * another_factor,
  fov: 45deg,
}
";
    assert_eq!(format(long).unwrap(), short);
    holds(long).unwrap();
}

/// Every program of the project that has to be right.
#[test]
fn all_programs_hold() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut folders =
        vec![root.join("prelude"), root.join("../examples"), root.join("../tests/corpus/right")];
    let mut seen = 0;
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "sdf") {
                let text = std::fs::read_to_string(&path).unwrap();
                holds(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
                seen += 1;
            }
        }
    }
    assert!(seen > 0);
}

#[test]
fn lines_end_as_most_of_the_text_do() {
    let text = "// A comment.\nlet  a = 1\nscene = sphere(a) // another\n";
    let laid_out = format(text).unwrap();
    assert_eq!(format(&text.replace('\n', "\r\n")).unwrap(), laid_out.replace('\n', "\r\n"));
    assert_eq!(format(&text.replace(".\n", ".\r\n")).unwrap(), laid_out);
    assert!(!laid_out.contains('\r'));
}
