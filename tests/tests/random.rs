//! Random scenes that mean something: none of them has a hole, and what is refused says why and where.
//!
//! `SUREFOOT_SCENES=10000` judges so many (else a number that takes about a minute), from seed `SUREFOOT_FIRST` (else 0) on;
//! `SUREFOOT_SEED=123` judges and prints one. What fails is made as small as it goes and printed.

use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;
use surefoot_compiler::diagnostic::Code;
use surefoot_compiler::graph::Function;
use surefoot_compiler::graph::kernel::KERNEL;
use surefoot_compiler::prelude::PRELUDE;
use surefoot_compiler::{MemoryLoader, Options, compile};
use surefoot_tests::scenes::check::{Care, FaultKind, Verdict, check, try_bound};
use surefoot_tests::scenes::shrink::shrink;
use surefoot_tests::scenes::{Term, scene};

/// Scenes of an ordinary run, and points in each.
const SCENES: u64 = 1000;
const POINTS: usize = 1000;
/// Balls in each scene that are certified.
const BALLS: usize = 20;
/// The same of a long run.
const MANY_POINTS: usize = 10_000;
const MANY_BALLS: usize = 100;
/// A scene that takes longer to compile counts as a hang.
const HANG: Duration = Duration::from_secs(10);
/// How often the shrinker may ask.
const ASKED: usize = 300;
/// Scenes among which every construct is found.
const ENOUGH: u64 = 6000;

fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok().and_then(|s| s.parse().ok())
}

#[test]
fn no_random_scene_has_a_hole() {
    let count = number("SUREFOOT_SCENES");
    let (points, balls) = if count.is_some() { (MANY_POINTS, MANY_BALLS) } else { (POINTS, BALLS) };
    let care = Care { points, balls, longest: HANG };
    let first = number("SUREFOOT_FIRST").unwrap_or(0);
    let seeds = match number("SUREFOOT_SEED") {
        Some(seed) => {
            println!("{}", scene(seed).text());
            seed..seed + 1
        }
        None => first..first + count.unwrap_or(SCENES),
    };
    let verdicts: Vec<(u64, Verdict)> =
        seeds.into_par_iter().map(|seed| (seed, check(&scene(seed).text(), seed, care))).collect();
    let mut tally: BTreeMap<String, usize> = BTreeMap::new();
    let mut wrong = Vec::new();
    for (seed, verdict) in &verdicts {
        let name = match verdict {
            Verdict::Proven(_) => "proven".to_owned(),
            Verdict::Unproven => "unproven".to_owned(),
            Verdict::Refused(code) => {
                // What the generator writes is right as far as its grammar and types go.
                let of_values = [Code::BadValue, Code::NoBound, Code::NoReach, Code::EndlessCall, Code::TooLarge];
                let text = scene(*seed).text();
                // Or a material paints a shape that the material itself asks, which no grammar forbids.
                let asks_itself = |line: &str| line.strip_prefix("material paint_a").is_some_and(|rest| rest.contains("paint_a"));
                let is_itself = *code == Code::TypeMismatch && text.lines().any(asks_itself);
                assert!(is_itself || of_values.contains(code), "seed {seed} is no program: {code:?}\n{text}");
                format!("refused: {}", code.row().name)
            }
            Verdict::Wrong(fault) => {
                wrong.push((*seed, fault.kind));
                format!("{:?}", fault.kind)
            }
        };
        *tally.entry(name).or_default() += 1;
    }
    let (mut empty, mut undecided) = (0, 0);
    for (_, verdict) in &verdicts {
        if let Verdict::Proven(tried) = verdict {
            (empty, undecided) = (empty + tried.empty, undecided + tried.undecided);
        }
    }
    println!("{tally:#?}\n{empty} balls are certainly empty, {undecided} are undecided");
    let small = wrong.iter().map(|(seed, kind)| smallest(*seed, *kind, care)).collect::<Vec<_>>();
    assert!(small.is_empty(), "{} of {} scenes are wrong:\n{}", small.len(), verdicts.len(), small.join("\n"));
    // A generator of which little is ever drawn would find little.
    let proven = verdicts.iter().filter(|(_, v)| matches!(v, Verdict::Proven(_))).count();
    assert!(verdicts.len() < 100 || empty > 4 * undecided, "only {empty} balls are decided, and {undecided} not");
    assert!(verdicts.len() < 100 || 2 * proven > verdicts.len(), "only {proven} of {} are proven", verdicts.len());
}

/// The smallest scene that is wrong in the same way, as a program, with what is wrong.
fn smallest(seed: u64, kind: FaultKind, care: Care) -> String {
    let verdict = |term: &Term| match check(&term.text(), seed, care) {
        Verdict::Wrong(fault) if fault.kind == kind => Some(fault.words),
        _ => None,
    };
    let small = shrink(&scene(seed), ASKED, |term| verdict(term).is_some());
    let words = verdict(&small).unwrap_or_default();
    format!("seed {seed}, {kind:?}: {words}\n{}", small.text())
}

#[test]
fn the_scenes_hold_all_that_the_language_has() {
    let texts: Vec<String> = (0..ENOUGH).map(|seed| scene(seed).text()).collect();
    let mut missing = BTreeSet::new();
    let word = |c: char| c.is_alphanumeric() || c == '_';
    // Every name that comes with the language, as a call.
    let mut calls: BTreeSet<&str> = BTreeSet::new();
    for text in &texts {
        for (at, _) in text.match_indices('(') {
            calls.insert(text[..at].rsplit(|c| !word(c)).next().unwrap());
        }
    }
    let kinds = ["field", "field2", "warp", "warp2", "blend", "fn", "shape", "shape2", "material"];
    for (_, text) in PRELUDE {
        for line in text.lines() {
            let Some((kind, rest)) = line.split_once(' ') else { continue };
            let name = rest.split(|c| !word(c)).next().unwrap();
            if kinds.contains(&kind) && !calls.contains(name) {
                missing.insert(name.to_owned());
            }
        }
    }
    missing.extend(KERNEL.iter().filter(|row| row.callable && !calls.contains(row.name)).map(|row| row.name.to_owned()));
    // Every construct.
    let constructs = [
        "param ", ": int =", "= true", " in [", "in (-1, -1, -1)..", "let ", "field own", "field2 ", "warp ", "warp2 ", "blend ", "fn ",
        "shape ", "shape2 ", "material ", "camera {", "light ", "environment {", "render {", " | ", " & ", " - ", "(!", " + ", " * ", " / ",
        " % ", "(-", " < ", " > ", " <= ", " >= ", " == ", " != ", " && ", " || ", "if ", "else if ", "else {", "for i in 0..", "for v in",
        "in grid(", "in polar(", " by +", " by *", " by min", " by max", " by smooth_union(", " by meet(", "while ", "[for ", "][",
        "time", "world", "normal", "nothing", "pi", "tau", "deg", "turn(", "turn_about(", ".at(", ".low_corner", ".high_corner",
        ".material(", ".paint(", "#d08770", "mat2(", "mat3(", "mat4(", "vec3(", "vec4(", "inverse(", "transpose(", "determinant(", "hash(",
        "hash2(", "hash3(", ".zxy", ".xz", "dot(", "cross(", "normalize(", "distance(", "length(", "int(", "float(", "p.x", "tree(n - 1)",
        "scene = ", "repeat(", "style", "bump:",
    ];
    let holds = |part: &str| texts.iter().any(|text| text.contains(part));
    missing.extend(constructs.iter().filter(|c| !holds(c)).map(|c| (*c).to_owned()));
    assert!(missing.is_empty(), "never written: {missing:?}");
}

#[test]
fn what_is_too_steep_is_found() {
    let text = "field f = 3 * length(p) - 3\nfield g = 0.5 * p.y\nscene = f | g.within(box(1))";
    let loader = MemoryLoader::new().with("main.sdf", text);
    let mut right = compile(&loader, "main.sdf", &Options::default()).compiled.unwrap();
    let care = Care { points: 500, balls: 50, longest: HANG };
    assert!(try_bound(&right, 1, care).is_ok());
    let field = right.functions.formulas[&(right.root, Function::Field)];
    right.functions.formulas.insert((right.root, Function::Bound), field);
    assert_eq!(try_bound(&right, 1, care).unwrap_err().kind, FaultKind::Hole);
}

#[test]
fn what_rays_would_not_look_at_is_found() {
    let text = "scene = plane(y, -1) | sphere(2) | box(1).translate(2, 0, 0)";
    let loader = MemoryLoader::new().with("main.sdf", text);
    let right = compile(&loader, "main.sdf", &Options::default()).compiled.unwrap();
    let care = Care { points: 4000, balls: 0, longest: HANG };
    assert!(try_bound(&right, 1, care).is_ok());
    let mut narrow = right.clone();
    narrow.functions.ahead.region.as_mut().unwrap().0[0].hi = 0.5;
    assert_eq!(try_bound(&narrow, 1, care).unwrap_err().kind, FaultKind::Ahead);
    let mut less = right.clone();
    let planes = less.functions.ahead.planes.as_mut().unwrap();
    planes.rest_bound = planes.distance;
    assert_eq!(try_bound(&less, 1, care).unwrap_err().kind, FaultKind::Ahead);
}

#[test]
fn a_scene_shrinks_to_what_matters() {
    let matters = |term: &Term| {
        let text = term.text();
        // The twist of a loop is a part of its form, and stays with all of that.
        let twists = |line: &str| line.replace(".twist(y, 0.1 * i)", "").contains(".twist(");
        // A mask stays a mask, with the material that it paints, and a field that is blended stays one, with the shape that it is within.
        let holds = |line: &str| [".paint(torus(", "meet(torus("].iter().fold(line.to_owned(), |line, part| line.replace(part, "")).contains("(torus(");
        text.lines().any(|line| line.starts_with("scene") && holds(line) && twists(line))
    };
    let large = (0..).map(scene).find(|s| matters(s) && s.text().len() > 600).unwrap();
    let small = shrink(&large, 2000, matters);
    assert!(matters(&small) && small.text().len() < 120, "{}", small.text());
}
