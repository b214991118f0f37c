//! What rounds or blends a repetition makes the same of it as of the copies written out, in the gaps between sparse copies too.

use surefoot_compiler::analysis::Box3;
use surefoot_compiler::diagnostic::{Code, render};
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::graph::Function;
use surefoot_compiler::{Compiled, MemoryLoader, Options, compile};

/// Formulas with a repetition, and with its copies written out: as many as a box of 8 about the origin can meet.
const PAIRS: [(&str, &str); 10] = [
    (
        "(for c in grid((1, 0, 0)) { if c.x % 4 == 0 { sphere(0.3) } }).round(1)",
        "(for i in -3..4 { sphere(0.3).translate(4 * i, 0, 0) }).round(1)",
    ),
    (
        "(for c in grid((1, 0, 1)) { if hash(c) > 0.8 { box((0.6, 1.5, 0.6)) } }).smooth_union(plane(y, -0.5), 1.5)",
        "(for i in -8..9 { for j in -8..9 { if hash((i, 0, j)) > 0.8 { box((0.6, 1.5, 0.6)).translate(i, 0, j) } } }).smooth_union(plane(y, -0.5), 1.5)",
    ),
    // The copies fill their cells, but not the box about them.
    (
        "(for c in grid((1, 0, 0)) { capsule((0, -3, -3), (0, 3, 3), 0.1) }).round(0.95)",
        "(for i in -8..9 { capsule((0, -3, -3), (0, 3, 3), 0.1).translate(i, 0, 0) }).round(0.95)",
    ),
    (
        "(for k in polar(y, 12) { if k % 3 == 0 { sphere(0.2).translate(1.2, 0, 0) } }).round(0.7)",
        "(for k in 0..4 { sphere(0.2).translate(1.2, 0, 0).rotate(y, k * 90deg) }).round(0.7)",
    ),
    (
        "(for k in polar(24) { if k % 8 == 0 { circle(0.2).translate(2, 0) } }).offset(1).extrude(0.5)",
        "(for k in 0..3 { circle(0.2).translate(2, 0).rotate(k * 120deg) }).offset(1).extrude(0.5)",
    ),
    (
        "for c in grid((3, 3, 3)) { (for k in polar(y, 8) { if k % 4 == 0 { sphere(0.05).translate(0.6, 0, 0) } }).round(0.5) }",
        "for i in -2..3 { for j in -2..3 { for k in -2..3 { (sphere(0.05).translate(0.6, 0, 0) | sphere(0.05).translate(-0.6, 0, 0)).round(0.5).translate(3 * (i, j, k)) } } }",
    ),
    // Taken away, and scaled: the gap is read as three times as wide.
    (
        "box(7) - (for c in grid((1, 0, 1)) { if c.x % 3 == 0 && c.z % 3 == 0 { cylinder(0.1, 20) } }).round(0.4).scale(1.5)",
        "box(7) - (for i in -2..3 { for j in -2..3 { cylinder(0.1, 20).translate(3 * i, 0, 3 * j) } }).round(0.4).scale(1.5)",
    ),
    // As far as a parameter can go.
    (
        "(for c in grid((1, 0, 0)) { if c.x % 4 == 0 { sphere(0.3) } }).round(wide)",
        "(for i in -3..4 { sphere(0.3).translate(4 * i, 0, 0) }).round(wide)",
    ),
    // As far as it goes in time: at its start it is small.
    (
        "(for c in grid((1, 0, 0)) { if c.x % 4 == 0 { sphere(0.3) } }).round(0.6 - 0.5 * cos(time))",
        "(for i in -3..4 { sphere(0.3).translate(4 * i, 0, 0) }).round(0.6 - 0.5 * cos(time))",
    ),
    // Through a function of a person's own, on numbers.
    (
        "thick(for c in grid((2, 0, 2)) { if (c.x + c.z) % 3 == 0 { sphere(0.3) } })",
        "thick(for i in -4..5 { for j in -4..5 { if (i + j) % 3 == 0 { sphere(0.3).translate(2 * i, 0, 2 * j) } } })",
    ),
];

const DECLARATIONS: &str = "param wide = 0.1 in 0..1.1\nblend thick(a) = a * a * sign(a) - 2\n";

fn scene(text: &str) -> (Compiled, Vec<Code>) {
    let text = format!("{DECLARATIONS}scene = {text}\n");
    let outcome = compile(&MemoryLoader::new().with("main.sdf", text.as_str()), "main.sdf", &Options::default());
    let said = render(&outcome.sources, &outcome.diagnostics, false);
    let codes = outcome.diagnostics.iter().map(|d| d.code).collect();
    (outcome.compiled.unwrap_or_else(|| panic!("{text}\n{said}")), codes)
}

fn fields(text: &str, wide: f64, points: &[[f64; 3]]) -> Vec<f64> {
    let (scene, _) = scene(text);
    let mut live = scene.live();
    live.components.fill(wide);
    live.time = wide * std::f64::consts::PI;
    let root = scene.functions.formulas[&(scene.root, Function::Field)];
    let tape = Tape::new(&scene.graph, &scene.functions.formulas, &[root], &live, 1_000_000).unwrap();
    let mut found = Vec::new();
    tape.evaluator().at(points, &[], |_, values| found.push(values[0]));
    found
}

#[test]
fn sparse_copies_are_rounded_and_blended_as_if_written_out() {
    let points: Vec<[f64; 3]> = (1..20_000).map(|i| Box3::cube(4.0).place(i)).collect();
    for (repeated, written) in PAIRS {
        for wide in if repeated.contains("wide") || repeated.contains("time") { vec![0.5, 1.0] } else { vec![0.1] } {
            let (found, expected) = (fields(repeated, wide, &points), fields(written, wide, &points));
            let solid = expected.iter().filter(|v| **v < 0.0).count();
            assert!(solid > 50 && solid < 19_900, "{written}: {solid} of the points are solid");
            for ((point, a), b) in points.iter().zip(found).zip(expected) {
                // What is near the surface is the same to a hundredth of a cell; what is farther away has the same sign.
                assert!((a.clamp(-0.05, 0.05) - b.clamp(-0.05, 0.05)).abs() < 0.01, "{repeated} at {point:?}: {a}, and written out {b}");
            }
        }
    }
}

#[test]
fn only_what_is_read_far_away_is_looked_at_far_away() {
    let size = |text: &str| scene(text).0.module.operations.1;
    let grid = "(for c in grid((1, 0, 1)) { if hash(c) > 0.8 { sphere(0.3) } })";
    let near = size(&format!("{grid}.round(0.1) | plane(y, -0.5)"));
    assert_eq!(near, size(&format!("{grid}.round(0.2) | plane(y, -0.5)")));
    assert!(size(&format!("{grid}.round(1) | plane(y, -0.5)")) > near);
    // No gaps: each cell has its copy.
    let full = "(for c in grid((1, 0, 1)) { sphere(0.3) })";
    let (blended, apart) = (size(&format!("{full}.smooth_union(plane(y, -0.5), 0.9)")), size(&format!("{full}.smooth_union(plane(y, -0.5), 0.1)")));
    assert_eq!(blended, apart);
}

#[test]
fn what_is_read_farther_than_can_be_looked_is_said() {
    let (_, codes) = scene("(for c in grid((1, 1, 1)) { if c.x % 9 == 0 { sphere(0.2) } }).round(3) & sphere(9)");
    assert!(codes.contains(&Code::Gaps), "{codes:?}");
    let (_, codes) = scene("(for c in grid((1, 0, 0)) { if c.x % 4 == 0 { sphere(0.3) } }).round(1)");
    assert!(!codes.contains(&Code::Gaps), "{codes:?}");
}
