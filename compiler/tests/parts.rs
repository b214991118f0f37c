//! The parts that a scene imports as `std/NAME.sdf`: documented, proven, of the sizes that norms say, and closed as meshes.

use surefoot_compiler::contour::{Detail, Settings, contour};
use surefoot_compiler::diagnostic::{self, Code};
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::graph::{Function, Proof};
use surefoot_compiler::prelude;
use surefoot_compiler::reference_text::{PARTS, entries, part_scenes};
use surefoot_compiler::{Compiled, MemoryLoader, Options, Outcome, compile, syntax};

fn outcome(text: &str) -> Outcome {
    compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default())
}

fn scene(text: &str) -> Compiled {
    let outcome = outcome(text);
    outcome.compiled.unwrap_or_else(|| panic!("{text}\n{}", diagnostic::render(&outcome.sources, &outcome.diagnostics, false)))
}

/// The values of a scene's field at points.
fn values(scene: &Compiled, points: &[[f64; 3]]) -> Vec<f64> {
    let root = scene.functions.formulas[&(scene.root, Function::Field)];
    let tape = Tape::new(&scene.graph, &scene.functions.formulas, &[root], &scene.live(), 4_000_000).unwrap();
    let mut all = vec![0.0; points.len()];
    tape.evaluator().at(points, &[], |i, values| all[i] = values[0]);
    all
}

/// How far from `from` towards `to` the surface is, in shares of the way, where the field changes its sign once between them.
fn crossing(scene: &Compiled, from: [f64; 3], to: [f64; 3]) -> f64 {
    let at = |t: f64| values(scene, &[[0, 1, 2].map(|i| from[i] + t * (to[i] - from[i]))])[0];
    let (mut low, mut high) = (0.0, 1.0);
    let inside = at(low) < 0.0;
    assert_ne!(inside, at(high) < 0.0, "no surface between {from:?} and {to:?}");
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if (at(middle) < 0.0) == inside { low = middle } else { high = middle }
    }
    low
}

#[test]
fn every_declaration_is_documented_and_shown() {
    assert_eq!(PARTS.len(), prelude::PARTS.len());
    for (part, _, text) in PARTS {
        assert!(prelude::PARTS.iter().any(|(name, known)| *name == format!("<std>/{part}.sdf") && known == text));
        assert_eq!(syntax::format(text).unwrap(), *text, "{part} is laid out");
        for entry in entries(part, text) {
            assert!(!entry.text.is_empty(), "{} has no words", entry.signature);
        }
    }
    assert!(part_scenes().len() > 40);
}

/// Each example keeps to what is proven of it: no warning, no measured factor.
#[test]
fn every_example_is_proven() {
    let mut wrong = Vec::new();
    for (part, entry, text) in part_scenes() {
        let outcome = outcome(&text);
        let Some(scene) = &outcome.compiled else {
            wrong.push(format!("{part}/{}: {}", entry.name, diagnostic::render(&outcome.sources, &outcome.diagnostics, false)));
            continue;
        };
        let steepest = scene.graph.factors.iter().map(|f| f.lipschitz).fold(1.0, f64::max);
        let unproven = scene.graph.factors.iter().any(|f| f.proof == Proof::Measured);
        println!("{part:<12} {:<24} ×{steepest:.2}", entry.name);
        if unproven || !outcome.diagnostics.is_empty() {
            wrong.push(format!("{part}/{}: {}", entry.name, diagnostic::render(&outcome.sources, &outcome.diagnostics, false)));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Coarse threads by ISO 724: diameter, pitch, pitch diameter and minor diameter, which the norm rounds to a thousandth.
const COARSE: &[(f64, f64, f64, f64)] = &[
    (3.0, 0.5, 2.675, 2.459),
    (4.0, 0.7, 3.545, 3.242),
    (5.0, 0.8, 4.480, 4.134),
    (6.0, 1.0, 5.350, 4.917),
    (8.0, 1.25, 7.188, 6.647),
    (10.0, 1.5, 9.026, 8.376),
    (12.0, 1.75, 10.863, 10.106),
];

#[test]
fn threads_have_the_sizes_of_the_norm() {
    for &(d, pitch, at_pitch, minor) in COARSE {
        let exact = [d - 0.375 * 3f64.sqrt() * pitch, d - 0.625 * 3f64.sqrt() * pitch];
        assert!((exact[0] - at_pitch).abs() < 5.1e-4 && (exact[1] - minor).abs() < 5.1e-4);
        let screw = scene(&format!("import \"std/threads.sdf\"\nscene = metric({d}, {})", 10.0 * pitch));
        let hole = scene(&format!("import \"std/threads.sdf\"\nscene = box({}) - metric_hole({d}, {})", 2.0 * d, 10.0 * pitch));
        for of in [&screw, &hole] {
            // At the angle 0 (+z) a ridge is at the height 0, and a quarter of a turn on (+x) it is a quarter of the pitch higher.
            for (turn, height, wanted) in [(0.0, 0.0, d), (0.0, 0.5 * pitch, exact[1]), (0.0, 0.25 * pitch, exact[0]), (0.25, 0.25 * pitch, d), (0.25, 0.5 * pitch, exact[0]), (0.5, 1.5 * pitch, d)] {
                let angle = std::f64::consts::TAU * turn;
                let place = |r: f64| [r * angle.sin(), height, r * angle.cos()];
                let radius = d * (0.3 + 0.5 * crossing(of, place(0.3 * d), place(0.8 * d)));
                assert!((2.0 * radius - wanted).abs() < 1e-4, "M{d} at {turn} of a turn, {height}: {}, not {wanted}", 2.0 * radius);
            }
        }
    }
}

#[test]
fn fasteners_have_the_sizes_of_their_norms() {
    // Across flats, height of the head, of the nut, key, socket head, washer.
    for (d, flats, head, nut, key, cap, washer) in [
        (3.0, 5.5, 2.0, 2.4, 2.5, 5.5, [3.2, 7.0, 0.5]),
        (4.0, 7.0, 2.8, 3.2, 3.0, 7.0, [4.3, 9.0, 0.8]),
        (5.0, 8.0, 3.5, 4.7, 4.0, 8.5, [5.3, 10.0, 1.0]),
        (6.0, 10.0, 4.0, 5.2, 5.0, 10.0, [6.4, 12.0, 1.6]),
        (8.0, 13.0, 5.3, 6.8, 6.0, 13.0, [8.4, 16.0, 1.6]),
        (10.0, 16.0, 6.4, 8.4, 8.0, 16.0, [10.5, 20.0, 2.0]),
        (12.0, 18.0, 7.5, 10.8, 10.0, 18.0, [13.0, 24.0, 2.5]),
    ] {
        let of = |what: &str| scene(&format!("import \"std/fasteners.sdf\"\nscene = {what}"));
        let far = 4.0 * d;
        let along = |scene: &Compiled, from: [f64; 3], to: [f64; 3]| far * crossing(scene, from, to);
        let close = |found: f64, wanted: f64, what: &str| assert!((found - wanted).abs() < 1e-4, "M{d}: {what} {found}, not {wanted}");
        let screw = of(&format!("hex_screw({d}, {})", 3.0 * d));
        let middle = 0.5 * head;
        // A corner of the hexagon lies on z, a flat on x.
        close(2.0 * along(&screw, [0.0, middle, 0.0], [far, middle, 0.0]), flats, "across flats");
        close(along(&screw, [0.0, 0.0, 0.0], [0.0, far, 0.0]), head, "height of the head");
        close(along(&screw, [0.0, 0.0, 0.0], [0.0, -far, 0.0]), 3.0 * d, "length");
        let hexagon = of(&format!("nut({d})"));
        close(2.0 * along(&hexagon, [0.45 * flats, 0.0, 0.0], [0.45 * flats, far, 0.0]), nut, "height of the nut");
        let socket = of(&format!("socket_screw({d}, {})", 2.0 * d));
        close(2.0 * along(&socket, [0.0, 0.1 * d, 0.0], [far, 0.1 * d, 0.0]), cap, "socket head");
        // Between the socket and the rim, and in the ring of the washer.
        let (wall, ring) = (0.25 * (key + cap), 0.25 * (washer[0] + washer[1]));
        let level = 0.8 * d;
        close(2.0 * wall * crossing(&socket, [0.0, level, 0.0], [wall, level, 0.0]), key, "key");
        let flat = of(&format!("washer({d})"));
        close(2.0 * ring * crossing(&flat, [0.0; 3], [ring, 0.0, 0.0]), washer[0], "hole of the washer");
        close(2.0 * (ring + (far - ring) * crossing(&flat, [ring, 0.0, 0.0], [far, 0.0, 0.0])), washer[1], "washer");
        close(2.0 * far * crossing(&flat, [ring, 0.0, 0.0], [ring, far, 0.0]), washer[2], "thickness of the washer");
    }
}

#[test]
fn gears_have_the_circles_and_the_involute_of_the_norm() {
    let pressure = 20f64.to_radians();
    for teeth in [9, 12, 20, 41] {
        let z = f64::from(teeth);
        let gear = scene(&format!("import \"std/gears.sdf\"\nscene = gear_drawing({teeth}).extrude(4)"));
        let (pitch, base) = (z / 2.0, z / 2.0 * pressure.cos());
        let at = |r: f64, angle: f64| [r * angle.sin(), r * angle.cos(), 0.0];
        // The tip in the middle of a tooth, and the root in the middle of a gap.
        let (tip, gap) = (crossing(&gear, [0.0; 3], at(2.0 * pitch, 0.0)), crossing(&gear, [0.0; 3], at(2.0 * pitch, std::f64::consts::PI / z)));
        assert!((2.0 * pitch * tip - (pitch + 1.0)).abs() < 1e-4, "{teeth} teeth: tip {}", 2.0 * pitch * tip);
        assert!((2.0 * pitch * gap - (pitch - 1.25)).abs() < 1e-4, "{teeth} teeth: root {}", 2.0 * pitch * gap);
        // A tooth is as wide as a gap at the pitch circle; from there its flank follows the involute of the base circle.
        let involute = |r: f64| {
            let a = (base / r).acos();
            a.tan() - a
        };
        for r in [base.max(pitch - 0.9), pitch, pitch + 0.5, pitch + 0.99] {
            let wanted = std::f64::consts::PI / (2.0 * z) + involute(pitch) - involute(r);
            let around = |angle: f64| values(&gear, &[at(r, angle)])[0];
            assert!(around(wanted - 1e-4 / r) < 0.0 && around(wanted + 1e-4 / r) > 0.0, "{teeth} teeth at the radius {r}: {wanted}");
        }
    }
}

/// A few of each part as meshes without a hole.
#[test]
fn parts_are_closed_as_meshes() {
    for (part, entry, text) in part_scenes() {
        if !["metric", "metric_hole", "hex_screw", "nut", "gear", "slot_bar", "koch", "sierpinski", "tree", "flower", "ridged"].contains(&entry.name.as_str()) {
            continue;
        }
        let scene = scene(&text);
        let mesh = contour(&scene, &scene.live(), &Settings { detail: Detail::Cells(48), sharp: true, within: None }, &|_| {});
        let mesh = mesh.unwrap_or_else(|why| panic!("{part}/{}: {why:?}", entry.name));
        assert_eq!(mesh.torn_edges(), 0, "{part}/{}", entry.name);
        assert!(mesh.examine().volume > 0.0, "{part}/{}", entry.name);
    }
}

#[test]
fn a_part_that_is_not_there_is_an_error_that_names_those_that_are() {
    let outcome = outcome("import \"std/screws.sdf\"\nscene = sphere(1)");
    let said = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    assert!(outcome.diagnostics.iter().any(|d| d.code == Code::Unreadable && d.help.contains("fasteners.sdf")), "{said}");
}

/// What a part complains of is said where a person calls it.
#[test]
fn places_are_those_of_the_call() {
    let scene = scene("import \"std/gears.sdf\"\n\nscene = gear(12, 3, helix: 20deg)");
    let sources = outcome("import \"std/gears.sdf\"\n\nscene = gear(12, 3, helix: 20deg)").sources;
    for factor in &scene.graph.factors {
        let (file, line, _) = sources.position(factor.span.file, factor.span.start);
        assert_eq!((file, line), ("main.sdf", 3), "{}", factor.name);
    }
}
