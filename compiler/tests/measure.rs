//! What a solid measures, against closed forms: each number is as near as its error says, and what is proven holds the truth.

use surefoot_compiler::contour::Refused;
use surefoot_compiler::measure::{Known, Measured, Settings, measure};
use surefoot_compiler::random::Random;
use surefoot_compiler::{Compiled, MemoryLoader, Options, compile};

const PI: f64 = std::f64::consts::PI;

fn scene(text: &str) -> Compiled {
    let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
    outcome.compiled.unwrap_or_else(|| panic!("{text}: {:?}", outcome.diagnostics))
}

fn measured(text: &str, settings: &Settings) -> Measured {
    let scene = scene(text);
    measure(&scene, &scene.live(), settings, &|_| {}).unwrap()
}

/// As fine as so much of a length.
fn coarse(tolerance: f64) -> Settings {
    Settings { tolerance: Some(tolerance), ..Settings::default() }
}

/// That a number is within a part of a length, an area or a volume, that its error says no less, and that what is proven holds.
fn near(what: &str, found: Known, wanted: f64, most: f64) {
    let off = (found.value - wanted).abs();
    assert!(off <= most && off <= found.error && found.error <= most, "{what}: {found:?}, not {wanted}, by {off:e}");
    assert!(found.proven.lo - 1e-6 * wanted.abs() <= wanted && wanted <= found.proven.hi + 1e-6 * wanted.abs(), "{what}: {found:?}, not {wanted}");
}

fn at(what: &str, found: [Known; 3], wanted: [f64; 3], most: f64) {
    for (found, wanted) in found.into_iter().zip(wanted) {
        near(what, found, wanted, most);
    }
}

#[test]
fn closed_forms_to_a_ten_thousandth() {
    let hole = PI * 0.09;
    for (text, half, volume, area, euler) in [
        ("sphere(1)", [1.0, 1.0, 1.0], 4.0 / 3.0 * PI, 4.0 * PI, 2),
        ("torus(1, 0.3)", [1.3, 0.3, 1.3], 2.0 * PI * PI * 0.09, 4.0 * PI * PI * 0.3, 0),
        ("box(1.2, 0.8, 1) - cylinder(0.3, 4)", [0.6, 0.4, 0.5], 0.8 * (1.2 - hole), 2.0 * (0.96 + 1.2 + 0.8) - 2.0 * hole + 0.8 * 2.0 * PI * 0.3, 0),
        ("capsule((0, -0.5, 0), (0, 0.5, 0), 0.4)", [0.4, 0.9, 0.4], PI * 0.16 + 4.0 / 3.0 * PI * 0.064, 2.0 * PI * 0.4 + 4.0 * PI * 0.16, 2),
    ] {
        // Away from the origin, so that no symmetry helps.
        let away = [0.37, -0.21, 0.11];
        let found = measured(&format!("scene = ({text}).translate(0.37, -0.21, 0.11)\n"), &Settings::default());
        let corner = |sign: f64| [0, 1, 2].map(|i| away[i] + sign * half[i]);
        at(text, found.bounds[0], corner(-1.0), 2e-7);
        at(text, found.bounds[1], corner(1.0), 2e-7);
        assert!(found.bounds.concat().iter().all(|side| side.is_proven));
        near(text, found.volume, volume, 1e-4 * volume);
        assert!(found.volume.proven.width() < 2e-3 * volume, "{text}: {found:?}");
        near(text, found.area, area, 1e-4 * area);
        at(text, found.centre, away, 1e-4);
        assert_eq!((found.pieces.len(), found.pieces[0].euler, found.pieces[0].cavities, found.settled), (1, euler, 0, true), "{text}");
    }
}

/// The thinnest wall and the narrowest gap of a scene.
fn across(text: &str) -> [Option<surefoot_compiler::measure::Across>; 2] {
    let found = measured(text, &Settings { walls: true, ..coarse(0.05) }).walls.unwrap();
    [found.wall, found.gap]
}

#[test]
fn walls_and_gaps_are_those_of_closed_forms() {
    for (text, wall, gap) in [
        ("sphere(1)", Some(2.0), None),
        // A hollow ball, whose cavity is a gap.
        ("sphere(1) - sphere(0.9)", Some(0.1), Some(1.8)),
        // Off its middle.
        ("sphere(1) - sphere(0.6).translate(0.3, 0.05, 0)", Some(0.4 - 0.3f64.hypot(0.05)), Some(1.2)),
        ("box(2, 1, 3)", Some(1.0), None),
        // The hole lies near a side, through the short way.
        ("box(2, 1, 3) - cylinder(0.3, 4).translate(0.55, 0, 0.4)", Some(0.15), Some(0.6)),
        ("sphere(1) | sphere(0.5).translate(1.7, 0.4, 0.2)", Some(1.0), Some((1.7f64 * 1.7 + 0.16 + 0.04).sqrt() - 1.5)),
        // A slanted plate has the thickness across.
        ("box(3, 0.2, 3).rotate(z, 33deg).rotate(x, 12deg)", Some(0.2), None),
        ("torus(1, 0.3)", Some(0.6), Some(1.4)),
    ] {
        let [thin, narrow] = across(&format!("scene = ({text}).translate(0.37, -0.21, 0.11)\n"));
        for (what, found, wanted) in [("wall", thin, wall), ("gap", narrow, gap)] {
            assert_eq!(found.is_some(), wanted.is_some(), "{text}: {what} {found:?}");
            let (Some(found), Some(wanted)) = (found, wanted) else { continue };
            near(&format!("{text}: {what}"), found.length, wanted, 1e-4);
            let [from, to] = found.ends;
            let long = from.iter().zip(to).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
            assert!((long - found.length.value).abs() < 1e-9 && !found.length.is_proven && found.length.proven.hi >= long, "{text}: {found:?}");
        }
    }
}

#[test]
fn what_is_flat_is_proven() {
    let found = measured("scene = box(2, 3, 4).translate(1, 1.5, 2) - box(1).translate(0.5, 0.5, 0.5)\n", &coarse(1e-3));
    near("volume", found.volume, 23.0, 0.06);
    assert!(found.volume.is_proven);
    near("area", found.area, 52.0, 0.02);
    at("box", found.bounds[0], [0.0; 3], 1e-6);
    at("box", found.bounds[1], [2.0, 3.0, 4.0], 1e-6);
    at("centre", found.centre, [(24.0 - 0.5) / 23.0, (36.0 - 0.5) / 23.0, (48.0 - 0.5) / 23.0], 4e-3);
    // Turned, it is as large.
    let turned = measured("scene = box(2, 3, 4).rotate(x, 20deg).rotate(z, 31deg)\n", &coarse(1e-3));
    near("volume", turned.volume, 24.0, 0.06);
    let [x, y, z] = [31f64, 20.0, 0.0].map(|a| a.to_radians()).map(f64::sin_cos);
    let across = 2.0 * x.1 + (3.0 * y.1 + 4.0 * y.0) * x.0 + z.0;
    near("width", turned.bounds[1][0], 0.5 * across, 1e-6);
    near("height", turned.bounds[1][2], 0.5 * (3.0 * y.0 + 4.0 * y.1), 1e-6);
}

#[test]
fn pieces_are_solids_with_their_cavities() {
    let found = measured(
        "scene = (sphere(1) - sphere(0.6)) | sphere(0.3) | torus(0.5, 0.1).translate(3, 0, 0) | (sphere(0.5) - sphere(0.2)).translate(0, 3, 0)\n",
        &coarse(1e-3),
    );
    let ball = |radius: f64| 4.0 / 3.0 * PI * radius * radius * radius;
    let wanted = [(ball(1.0) - ball(0.6), 4, 1), (ball(0.5) - ball(0.2), 4, 1), (ball(0.3), 2, 0), (2.0 * PI * PI * 0.5 * 0.01, 0, 0)];
    assert_eq!(found.pieces.len(), 4, "{found:?}");
    for (piece, (volume, euler, cavities)) in found.pieces.iter().zip(wanted) {
        assert_eq!((piece.euler, piece.cavities), (euler, cavities), "{piece:?}");
        near("piece", piece.volume, volume, 0.03 * volume);
    }
    near("all", found.volume, wanted.iter().map(|w| w.0).sum(), 0.02);
}

#[test]
fn a_moment_a_value_and_a_box_count() {
    let scene = scene("param size = 1 in 0.5..2\nscene = sphere(size).translate(time, 0, 0) | plane(y, -3)\n");
    let mut live = scene.live();
    (live.time, live.components[0]) = (2.0, 0.5);
    scene.settle(&mut live);
    let find = |settings: &Settings| measure(&scene, &live, settings, &|_| {});
    assert_eq!(find(&coarse(1e-3)).unwrap_err(), Refused::Endless);
    let found = find(&Settings { within: Some([[-1.0, -2.0, -1.0], [4.0, 2.0, 1.0]]), ..coarse(1e-3) }).unwrap();
    at("box", found.bounds[0], [1.5, -0.5, -0.5], 1e-6);
    at("box", found.bounds[1], [2.5, 0.5, 0.5], 1e-6);
    near("volume", found.volume, 4.0 / 3.0 * PI * 0.125, 5e-3);
    // What the box cuts off ends at its walls, the ground too.
    let found = find(&Settings { within: Some([[2.0, -4.0, -1.0], [4.0, 2.0, 1.0]]), ..coarse(1e-3) }).unwrap();
    at("box", found.bounds[0], [2.0, -4.0, -1.0], 1e-6);
    near("volume", found.volume, 4.0 + 2.0 / 3.0 * PI * 0.125, 0.03);
    assert_eq!(found.pieces.len(), 2);
    // What ends at each moment needs no box.
    let moving = self::scene("scene = sphere(0.5).translate(time, 0, 2 * time)\n");
    let found = measure(&moving, &surefoot_compiler::Live { time: 3.0, ..moving.live() }, &coarse(1e-3), &|_| {}).unwrap();
    at("box", found.bounds[0], [2.5, -0.5, 5.5], 1e-5);
    at("box", found.bounds[1], [3.5, 0.5, 6.5], 1e-5);
    let nothing = Settings { within: Some([[5.0, 0.0, 0.0], [6.0, 1.0, 1.0]]), ..coarse(1e-3) };
    assert_eq!(find(&nothing).unwrap_err(), Refused::Empty);
}

/// What is neither flat nor round: blends, warps, noise and steps. What is proven holds what many points say.
#[test]
fn what_is_proven_holds_what_points_say() {
    for text in [
        "smooth_union(box(1), sphere(0.6).translate(0.5, 0.4, 0), 0.2)",
        "box(0.5, 1.4, 0.7).twist(y, 50deg)",
        "ellipsoid(1, 0.5, 0.7).rotate(y, 33deg)",
        "sphere(0.8).displace(0.05 * value_noise(2 * p))",
        "steps\nfield steps = max(length(p) - 1, floor(3 * p.x) * 0.3 - 0.5)",
    ] {
        let scene = scene(&format!("scene = {text}\n"));
        // Of noise less is proven, and each box costs more.
        let noise = text.contains("noise");
        let tolerance = if noise { 8e-3 } else { 2e-3 };
        let found = measure(&scene, &scene.live(), &coarse(tolerance), &|_| {}).unwrap();
        let truth = surefoot_compiler::certify::Truth::new(&scene, &scene.live(), 1_000_000).unwrap();
        let mut prover = truth.prover();
        let sides = [0, 1, 2].map(|i| [found.bounds[0][i].value - 0.01, found.bounds[1][i].value + 0.01]);
        // A place by chance in each of many cells, so that no flat side is counted by halves.
        const N: usize = 24;
        let mut random = Random(7);
        let mut inside = 0;
        for i in 0..N * N * N {
            let place = [i % N, i / N % N, i / (N * N)];
            let point = [0, 1, 2].map(|k| sides[k][0] + (sides[k][1] - sides[k][0]) * (place[k] as f64 + random.next()) / N as f64);
            if prover.value(point) < 0.0 {
                inside += 1;
                let held = (0..3).all(|k| found.bounds[0][k].value - found.bounds[0][k].error <= point[k] && point[k] <= found.bounds[1][k].value + found.bounds[1][k].error);
                assert!(held, "{text}: {point:?} is solid, {found:?}");
            }
        }
        let whole: f64 = sides.iter().map(|[low, high]| high - low).product();
        let counted = whole * inside as f64 / (N * N * N) as f64;
        assert!((found.volume.value - counted).abs() < 0.01 * counted, "{text}: {counted}, {found:?}");
        assert!(found.volume.proven.lo < counted * 1.01 && counted < found.volume.proven.hi * 1.01, "{text}: {counted}, {found:?}");
        let most = if noise { 0.2 } else { 0.1 };
        assert!(found.volume.proven.width() < most * counted, "{text}: {found:?}");
        assert!(found.bounds.concat().iter().all(|side| side.error < 2.0 * tolerance), "{text}: {found:?}");
    }
}

#[test]
fn a_line_is_followed_through_solid_and_air() {
    let line = |text: &str, ends| {
        let found = measured(&format!("scene = {text}\n"), &Settings { line: Some(ends), ..coarse(0.01) });
        let line = found.line.unwrap();
        assert_eq!((line.known_to, line.touches.len()), (line.length, 0), "{line:?}");
        line.ways.iter().map(|way| (way.solid, way.from, way.to)).collect::<Vec<_>>()
    };
    let close = |found: Vec<(bool, f64, f64)>, wanted: &[(bool, f64, f64)]| {
        let same = found.iter().zip(wanted).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() < 1e-7 && (a.2 - b.2).abs() < 1e-7);
        assert!(same && found.len() == wanted.len(), "{found:?}, not {wanted:?}");
    };
    let shell = "sphere(1) - sphere(0.75)";
    let through = [(false, 0.0, 1.0), (true, 1.0, 1.25), (false, 1.25, 2.75), (true, 2.75, 3.0), (false, 3.0, 4.0)];
    close(line(shell, [[-2.0, 0.0, 0.0], [2.0, 0.0, 0.0]]), &through);
    // From the middle, along a diagonal, and past it.
    let d = 1.0 / 3f64.sqrt();
    close(line(shell, [[0.0; 3], [1.5 * d; 3]]), &[(false, 0.0, 0.75), (true, 0.75, 1.0), (false, 1.0, 1.5)]);
    close(line(shell, [[0.875, 0.0, 0.0], [2.0, 0.0, 0.0]]), &[(true, 0.0, 0.125), (false, 0.125, 1.125)]);
    close(line(shell, [[-2.0, 1.5, 0.0], [2.0, 1.5, 0.0]]), &[(false, 0.0, 4.0)]);
}
