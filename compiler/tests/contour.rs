//! The mesh of a scene: closed, oriented, where the surface is, and with its edges sharp.

use crate::common::Disk;
use surefoot_compiler::certify::Truth;
use surefoot_compiler::contour::{Detail, Examined, Mesh, Refused, Settings, contour};
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::graph::Function;
use surefoot_compiler::graph::interval::Interval;
use surefoot_compiler::{Compiled, MemoryLoader, Options, compile};

fn scene(text: &str) -> Compiled {
    let loader = MemoryLoader::new().with("main.sdf", text);
    let outcome = compile(&loader, "main.sdf", &Options::default());
    outcome.compiled.unwrap_or_else(|| panic!("{text}: {:?}", outcome.diagnostics))
}

fn example(name: &str) -> Compiled {
    let path = format!("{}/../examples/{name}.sdf", env!("CARGO_MANIFEST_DIR"));
    compile(&Disk, &path, &Options::default()).compiled.unwrap()
}

fn cells(n: u32) -> Settings {
    Settings { detail: Detail::Cells(n), sharp: true, within: None }
}

fn mesh(scene: &Compiled, settings: &Settings) -> Mesh {
    let mesh = contour(scene, &scene.live(), settings, &|_| {}).unwrap();
    assert_eq!(mesh.torn_edges(), 0);
    assert_eq!((mesh.normals.len(), mesh.colors.len()), (mesh.vertices.len(), mesh.vertices.len()));
    let found = mesh.examine();
    assert!(found.volume > 0.0, "{found:?}");
    assert_eq!(found.euler % 2, 0, "{found:?}");
    // A file has 32 bits: corners that are one there would tear it.
    let mut places: Vec<[u32; 3]> = mesh.vertices.iter().map(|v| v.map(|c| (c as f32 + 0.0).to_bits())).collect();
    places.sort_unstable();
    places.dedup();
    assert_eq!(places.len(), mesh.vertices.len());
    mesh
}

/// That the surface is no farther than this from some vertices and middles of triangles: at both sides of each the sign is proven.
fn assert_near(scene: &Compiled, mesh: &Mesh, vertices: f64, triangles: f64) {
    let truth = Truth::new(scene, &scene.live(), 4_000_000).unwrap();
    let mut prover = truth.prover();
    let middle = |t: &[u32; 3]| {
        let [a, b, c] = mesh.corners(t);
        let normal = mesh.normals[t[0] as usize];
        ([0, 1, 2].map(|i| (a[i] + b[i] + c[i]) / 3.0), normal, triangles)
    };
    let every = |n: usize| n.div_ceil(500);
    let corners = mesh.vertices.iter().zip(&mesh.normals).map(|(p, n)| (*p, *n, vertices));
    let middles = mesh.triangles.iter().map(middle);
    for (point, normal, most) in corners.step_by(every(mesh.vertices.len())).chain(middles.step_by(every(mesh.triangles.len()))) {
        let [out, inward] = [most, -most].map(|by| prover.range([0, 1, 2].map(|i| Interval::point(point[i] + by * f64::from(normal[i])))));
        assert!(out.lo > 0.0 && inward.hi < 0.0, "{point:?}, {most}: {out:?} {inward:?}");
    }
}

fn close(found: f64, wanted: f64, part: f64) {
    assert!((found - wanted).abs() <= part * wanted, "{found}, not {wanted}");
}

#[test]
fn shapes_have_their_euler_number_volume_and_area() {
    let pi = std::f64::consts::PI;
    let (hole, side) = (pi * 0.3 * 0.3, 2.0 * pi * 0.3);
    for (text, euler, pieces, volume, area) in [
        ("sphere(1)", 2, 1, 4.0 / 3.0 * pi, 4.0 * pi),
        ("torus(1, 0.3)", 0, 1, 2.0 * pi * pi * 0.09, 4.0 * pi * pi * 0.3),
        ("capsule((0, -0.5, 0), (0, 0.5, 0), 0.4)", 2, 1, pi * 0.16 + 4.0 / 3.0 * pi * 0.064, 2.0 * pi * 0.4 + 4.0 * pi * 0.16),
        ("box(1.2, 0.8, 1).rotate(y, 20deg).rotate(x, 31deg)", 2, 1, 0.96, 2.0 * (0.96 + 1.2 + 0.8)),
        ("box(1.2, 0.8, 1) - cylinder(0.3, 4)", 0, 1, 0.8 * (1.2 - hole), 2.0 * (0.96 + 1.2 + 0.8) - 2.0 * hole + 0.8 * side),
        ("sphere(0.5) | sphere(0.25).translate(2, 0, 0)", 4, 2, 4.0 / 3.0 * pi * (0.125 + 0.015625), 4.0 * pi * (0.25 + 0.0625)),
        // A hollow ball has two surfaces.
        ("sphere(1) - sphere(0.5)", 4, 2, 4.0 / 3.0 * pi * 0.875, 4.0 * pi * 1.25),
    ] {
        let scene = scene(&format!("scene = {text}\n"));
        let found: Examined = mesh(&scene, &cells(64)).examine();
        assert_eq!((found.euler, found.pieces), (euler, pieces), "{text}");
        // What is round has its vertices on the surface, and its chords inside.
        close(found.volume, volume, 5e-3);
        close(found.area, area, 5e-3);
    }
}

#[test]
fn corners_and_triangles_are_where_the_surface_is() {
    for (text, vertices, triangles) in [
        ("sphere(1)", 2e-3, 0.02),
        ("torus(1, 0.3)", 1e-3, 0.05),
        // Edges that are bent, by a blend and by a warp: planes meet beside them, and a vertex that reaches out of its cell may be a fifth of a cell off.
        ("smooth_union(box(1), sphere(0.7).translate(0.4, 0.5, 0), 0.2)", 0.2, 0.2),
        ("box(1).twist(y, 40deg)", 0.2, 0.2),
        ("ellipsoid(1, 0.5, 0.7)", 0.01, 0.05),
    ] {
        let scene = scene(&format!("scene = {text}\n"));
        let mesh = mesh(&scene, &cells(48));
        assert_near(&scene, &mesh, vertices * mesh.cell, triangles * mesh.cell);
        assert!(mesh.deviation < 0.25 * mesh.cell, "{text}: {} of {}", mesh.deviation, mesh.cell);
    }
}

#[test]
fn edges_of_a_box_are_sharp() {
    for turn in ["", ".rotate(y, 20deg).rotate(x, 31deg)", ".rotate(z, 45deg)"] {
        let scene = scene(&format!("scene = box(1.3, 0.9, 1.1){turn}\n"));
        let mesh = mesh(&scene, &cells(40));
        // All edges are there if all of the volume is, and nothing stands out.
        close(mesh.examine().volume, 1.3 * 0.9 * 1.1, 1e-3);
        let field = Tape::new(&scene.graph, &scene.functions.formulas, &[scene.functions.formulas[&(scene.root, Function::Field)]], &scene.live(), 100_000).unwrap();
        field.evaluator().at(&mesh.vertices, &[], |i, v| assert!(v[0].abs() < 0.01 * mesh.cell, "{:?}: {}", mesh.vertices[i], v[0]));
        assert!(mesh.deviation < 0.01 * mesh.cell, "{turn}: {} of {}", mesh.deviation, mesh.cell);
        let smooth = contour(&scene, &scene.live(), &Settings { sharp: false, ..cells(40) }, &|_| {}).unwrap();
        assert_eq!(smooth.torn_edges(), 0);
        assert!(smooth.examine().volume < mesh.examine().volume - 1e-4);
    }
}

/// A part for a printer: what is planar stays so, and each of its holes is there.
#[test]
fn flat_faces_are_flat() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/corpus/large/bracket.sdf");
    let mesh = mesh(&compile(&Disk, path, &Options::default()).compiled.unwrap(), &cells(120));
    let found = mesh.examine();
    assert_eq!((found.pieces, found.euler), (1, 2 - 2 * 12));
    let mut flat = 0;
    for (vertex, normal) in mesh.vertices.iter().zip(&mesh.normals) {
        for (axis, place) in [(0, 0.0), (0, 100.0), (1, 0.0), (1, 6.0), (1, 60.0), (2, 0.0), (2, 6.0), (2, 40.0)] {
            let off = (vertex[axis] - place).abs();
            if normal[axis].abs() > 0.999 && off < 0.3 * mesh.cell {
                assert!(off < 1e-4 * mesh.cell, "{vertex:?} is {off} off the plane at {place}");
                flat += 1;
            }
        }
    }
    assert!(flat > mesh.vertices.len() / 2, "{flat} of {}", mesh.vertices.len());
}

/// The rim of a slanted hole is sharper than a right angle, and thinner than a cell between two corners.
#[test]
fn a_rim_has_no_notches() {
    let scene = scene("scene = box(1.5, 1, 0.7).rotate(y, 20deg).rotate(x, 31deg) - cylinder(0.2, 4)\n");
    for n in [64, 90, 128] {
        let mesh = mesh(&scene, &cells(n));
        assert!(mesh.deviation < 0.15 * mesh.cell, "{n}: {} of {}", mesh.deviation, mesh.cell);
    }
}

/// Boxes that touch along an edge, cells that hold two sheets, noise, and a surface that a jump of the field tears.
#[test]
fn what_is_ambiguous_stays_a_manifold() {
    for text in [
        "box(1).translate(-0.5, -0.5, 0) | box(1).translate(0.5, 0.5, 0)",
        "box(1).translate(-0.499, -0.499, 0) | box(1).translate(0.499, 0.499, 0)",
        "box(1).translate(-0.5, -0.5, -0.5) | box(1).translate(0.5, 0.5, 0.5)",
        "box(1, 0.01, 1).rotate(x, 30deg)",
        "rough() & sphere(1)",
        "waves() & box(1.2)",
        "sphere(1) & blocks()",
    ] {
        let fields = "field rough() = fbm(9 * p) - 0.02\n\
                      field waves() = sin(31 * p.x) * sin(37 * p.y) + sin(29 * p.z) * sin(41 * p.x)\n\
                      field blocks() = hash(floor(7 * p)) - 0.5\n";
        let scene = scene(&format!("{fields}scene = {text}\n"));
        for n in [13, 24, 37] {
            mesh(&scene, &cells(n));
        }
    }
}

/// Shapes whose meshes have holes or double edges elsewhere: sweeps whose sides are steep or meet, a cut of a revolution, cubes of a grid that touch.
#[test]
fn what_is_swept_or_set_in_rows_is_closed() {
    for (text, euler) in [
        ("rectangle((1, 0.5)).extrude(2).twist(z, 180deg)", Some(2)),
        ("rectangle((1, 0.5)).extrude(2).taper(z, -1, 1, 0.15)", Some(2)),
        // From a square to a circle.
        ("mix(rectangle(1).extrude(2), circle(0.3).extrude(2), saturate(p.z / 2 + 0.5))", Some(2)),
        ("thread() & cylinder(0.6, 1.6)", None),
        // A revolution over 90 and over 300 degrees, whose ends are flat.
        ("rectangle((0.3, 0.5)).translate(1, 0).revolve() & plane(x) & plane(z)", Some(2)),
        ("rectangle((0.3, 0.5)).translate(1, 0).revolve() - (plane(x) & plane(x).rotate(y, 120deg))", Some(2)),
        ("for i in 0..4 { for j in 0..4 { for k in 0..4 { if hash((i, j, k)) < 0.4 { box(0.5).translate(i / 2, j / 2, k / 2) } else { nothing } } } }", None),
        ("box(0.3).repeat(0.5, (5, 3, 4))", Some(2 * 60)),
        ("box(0.5).repeat(0.5, (3, 3, 3))", Some(2)),
        ("capsule((0.4, -0.4, 0), (0.4, 0.4, 0), 0.15).repeat_polar(y, 7)", Some(2 * 7)),
    ] {
        let fields = "field thread() = {\n  let turn = atan2(p.z, p.x) / tau;\n  \
                      (length(p.xz) - 0.4 - 0.1 * triangle_wave(p.y / 0.3 - turn)) / 2\n}\n";
        let scene = scene(&format!("{fields}scene = {text}\n"));
        for n in [30, 61] {
            let found = mesh(&scene, &cells(n)).examine();
            assert!(euler.is_none_or(|euler| euler == found.euler), "{text}: {found:?}");
        }
    }
}

#[test]
fn examples_are_closed() {
    let within = |low, high| Settings { within: Some([low, high]), ..cells(64) };
    let fine = Settings { detail: Detail::Cells(128), ..within([-1.3, 0.05, -1.3], [1.3, 2.6, 1.3]) };
    let sponge = mesh(&example("menger"), &fine).examine();
    assert_eq!(sponge.pieces, 1);
    let part = mesh(&example("csg"), &within([-2.5, -0.2, -2.0], [2.5, 3.0, 3.0]));
    assert!(part.deviation < 0.5 * part.cell);
    for name in ["chess", "machine", "isometric"] {
        mesh(&example(name), &cells(48));
    }
}

#[test]
fn a_sponge_has_its_holes() {
    // Of level 1: a cube with three tunnels, of genus 5; of level 2 the genus is 81 (each of 20 parts adds its own, as they are glued along faces).
    for (level, euler) in [(1, 2 - 2 * 5), (2, 2 - 2 * 81)] {
        let scene = scene(&format!("scene = menger_sponge(2, {level}).rotate(y, 10deg)\n"));
        assert_eq!(mesh(&scene, &cells(90)).examine().euler, euler, "level {level}");
    }
}

#[test]
fn a_tolerance_is_met() {
    let scene = scene("scene = torus(1, 0.4) | box(0.5)\n");
    let mut before = 0;
    for most in [0.02, 0.004, 0.001] {
        let mesh = mesh(&scene, &Settings { detail: Detail::Tolerance(most), ..cells(1) });
        assert!(mesh.deviation <= most, "{} > {most}", mesh.deviation);
        assert!(mesh.cells > before);
        before = mesh.cells;
    }
}

#[test]
fn what_has_no_end_is_refused_and_a_box_ends_it() {
    let endless = ["plane(y)", "sphere(0.3).repeat(1)", "sphere(1) | plane(y)"];
    for text in endless {
        let scene = scene(&format!("scene = {text}\n"));
        assert_eq!(contour(&scene, &scene.live(), &cells(20), &|_| {}), Err(Refused::Endless), "{text}");
    }
    let half = scene("scene = plane(y)\n");
    let found = mesh(&half, &Settings { within: Some([[-1.0; 3], [1.0; 3]]), ..cells(20) }).examine();
    assert_eq!(found.euler, 2);
    close(found.volume, 4.0, 1e-6);
    let refused = |within| contour(&half, &half.live(), &Settings { within: Some(within), ..cells(20) }, &|_| {});
    assert_eq!(refused([[-1.0, 0.5, -1.0], [1.0, 1.0, 1.0]]), Err(Refused::Empty));
    assert!(matches!(refused([[-1.0; 3], [1e9; 3]]), Err(Refused::Beyond(_))));
}

#[test]
fn memory_has_an_end() {
    let scene = scene("scene = box(1)\n");
    assert_eq!(contour(&scene, &scene.live(), &cells(4096), &|_| {}), Err(Refused::TooMany(4096)));
}
