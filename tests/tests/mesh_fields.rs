//! Meshes as fields: intervals and slopes of grids, bounds, pictures of both machines, files that change, and files that are broken.

use crate::common::{Disk, compile_file, gpu, root};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::{Compiled, Export, Live, Options};
use surefoot_compiler::contour::{self, Detail};
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::graph::Function;
use surefoot_compiler::graph::interval::Interval;
use surefoot_compiler::graph::kernel::{self, Op};
use surefoot_compiler::random::Random;
use surefoot_compiler::reference::{Area, Reference, View, rgb8};
use surefoot_compiler::kept::Kept;
use surefoot_compiler::sampled::{self, Grid, Sign, Surface};
use surefoot_compiler::verify::{Settings, WORK, verify};
use surefoot_compiler::{Loader, compile};
use surefoot_runtime::headless::{self, FORMAT, Shot};
use surefoot_runtime::live::{LiveScene, Setup};
use surefoot_runtime::{ViewMode, evaluate};

/// A folder of one test with what it writes.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("mesh-fields-{name}"));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// A pyramid whose tip is so high, as an OBJ file: closed, its faces outwards.
fn pyramid(tip: f64) -> String {
    format!("v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 {tip} 0\nf 1 2 3\nf 1 3 4\nf 2 1 5\nf 3 2 5\nf 4 3 5\nf 1 4 5\n")
}

/// A scene beside a pyramid and the knot of the examples.
fn scene(name: &str, text: &str) -> (PathBuf, PathBuf) {
    let folder = folder(name);
    let (mesh, path) = (folder.join("pyramid.obj"), folder.join("main.sdf"));
    std::fs::write(&mesh, pyramid(1.5)).unwrap();
    std::fs::copy(root().join("examples/meshes/knot.obj"), folder.join("knot.obj")).unwrap();
    std::fs::write(&path, text).unwrap();
    (mesh, path)
}

fn compiled(name: &str, text: &str) -> Compiled {
    let (_, path) = scene(name, text);
    compile_file(path.to_str().unwrap()).unwrap_or_else(|words| panic!("{name}: {words}"))
}

/// Alone, and in all that the language does with shapes.
const SCENES: [(&str, &str); 11] = [
    ("alone", "scene = mesh_field(\"knot.obj\")"),
    ("coarse", "scene = mesh_field(\"pyramid.obj\", resolution: 16, padding: 0.01)"),
    ("blended", "scene = smooth_union(mesh_field(\"pyramid.obj\", 32), sphere(0.7).translate(0, 1.4, 0), 0.4) - box(0.6).translate(0.6, 0.3, 0.6)"),
    ("twisted", "scene = mesh_field(\"knot.obj\", 48).scale(0.4).twist(y, 1.5).rotate(x, 40deg)"),
    ("repeated", "scene = mesh_field(\"pyramid.obj\", 32).repeat((3, 0, 3), (3, 1, 2)) | mesh_field(\"pyramid.obj\", 32).scale(0.5).repeat_polar(y, 5)"),
    ("moved", "param x = 0.2 in -1..1\nscene = mesh_field(\"pyramid.obj\", 32).translate(x, 0.3 * sin(time), 0) | mesh_field(\"knot.obj\", 32).scale(0.3).translate(0, 2, x)"),
    ("rounded", "scene = mesh_field(\"pyramid.obj\", 32).round(0.2).shell(0.1) & mesh_field(\"pyramid.obj\", 32).scale(1.3).translate(0.4, 0, 0)"),
    ("baked", "scene = sphere(1).displace(0.1 * fbm(3 * p, 3)).baked(32)"),
    ("baked-blended", "material m { color: #804020 }\nscene = smooth_union((torus(1, 0.3) | box(0.8)).material(m).baked(48), sphere(0.5).translate(0, 0.8, 0), 0.2)"),
    ("baked-moved", "param x = 0.2 in -1..1\nlet s = gyroid(0.7, 0.1).within(sphere(1)).baked(40)\nscene = s.twist(y, 0.5).translate(x, 0, 0) | s.scale(0.5).translate(0, 1.5 + 0.2 * sin(time), 0)"),
    ("displaced", "material m { color: (0.5 + 0.4 * sin(8 * p.y), 0.4, 0.3) }\nscene = mesh_field(\"pyramid.obj\", 32).displace(0.05 * sin(9 * p.x) * sin(9 * p.y)).material(m)"),
];

#[test]
fn no_bound_is_too_large() {
    let gpu = gpu();
    for (name, text) in SCENES {
        let scene = compiled(&format!("bound-{name}"), text);
        let device = |live: &Live, points: &[[f32; 3]]| evaluate(&gpu, &scene, live, [0.0; 3], Export::Bound, points);
        let settings = Settings { samples: 2000, certified: 24, seed: 7, work: WORK };
        let report = verify(&scene, settings, Some(&device), &|_| {}).unwrap();
        assert!(report.violations.is_empty(), "{name}: {:?}", report.violations);
        assert!(report.empty > 0 && report.device.is_some_and(|device| device.worst < 1.0), "{name}: {report:?}");
    }
}

#[test]
fn both_machines_draw_the_same() {
    let gpu = gpu();
    let (width, height) = (96, 72);
    for (name, text) in SCENES {
        let scene = compiled(&format!("drawn-{name}"), text);
        let live = scene.live();
        let frame = scene.frame(&live);
        let reference = Reference::new(&scene, &live).unwrap();
        for mode in [View::Normals, View::Depth] {
            let drawn = headless::render(&gpu, &scene, &live, &Shot { mode, ..Shot::new(width, height) }).unwrap();
            let area = Area { left: 0, top: 0, width, height };
            let computed = rgb8(&reference.light_at(&frame, &frame.cameras[0].1, (width, height), mode, area, 0), area, mode);
            let background = computed[..3].to_vec();
            let differ = |(drawn, computed): (&[u8], &[u8])| drawn.iter().zip(computed).any(|(a, b)| a.abs_diff(*b) > 8);
            let count = drawn.rgba.chunks_exact(4).zip(computed.chunks_exact(3)).filter(|pair| differ(*pair)).count();
            let seen = computed.chunks_exact(3).filter(|pixel| **pixel != background[..]).count();
            assert!(seen > 200, "{name}: {seen} pixels of {mode:?} show anything");
            assert!(count * 200 < (width * height) as usize, "{name}: {count} pixels of {mode:?} differ");
        }
    }
}

/// The grid of the knot.
fn grid() -> Arc<Grid> {
    let knot = root().join("examples/meshes/knot.obj");
    Disk.grid(knot.to_str().unwrap(), sampled::Settings { resolution: 32, padding: 0.05 }).unwrap()
}

#[test]
fn values_and_slopes_lie_within_their_intervals() {
    let kept = Kept::new(grid());
    let (grid, mut random) = (&kept.data, Random(3));
    for round in 0..20_000 {
        // Boxes from a part of a cell to much of the grid, also beyond its wall.
        let half = 10f64.powf(-3.0 + 3.5 * random.next());
        let middle = random.within(4.5);
        let sides = [0, 1, 2].map(|i| Interval::new(middle[i] - half * random.next(), middle[i] + half * random.next()));
        let p = sides.map(|side| side.lo + random.next() * (side.hi - side.lo));
        let number = Interval::point(kept.number);
        for op in [Op::Sampled, Op::SampledX, Op::SampledY, Op::SampledZ] {
            let value = kernel::value(op, &[kept.number, p[0], p[1], p[2]]);
            let all = kernel::interval(op, &[number, sides[0], sides[1], sides[2]]);
            assert!(all.contains(value), "{round}: {op:?} is {value} at {p:?}, not in {all:?} of {sides:?}");
        }
        // The slopes are those of the values, where both places are of one cell.
        let h = 1e-7;
        let slope = (grid.inside([p[0] + h, p[1], p[2]]) - grid.inside([p[0] - h, p[1], p[2]])) / (2.0 * h);
        let known = [-h, h].map(|by| grid.gradient([p[0] + by, p[1], p[2]])[0]);
        let shape = grid.shape();
        let is_inside = (0..3).all(|i| p[i] > shape.origin[i] + h && p[i] < shape.end()[i] - h);
        if is_inside && known[0] == known[1] {
            assert!((slope - known[0]).abs() < 1e-5, "{slope} and {known:?} at {p:?}");
        }
    }
}

#[test]
fn a_number_is_that_of_the_content() {
    let (one, same) = (Kept::new(grid()), Kept::new(Arc::new((*grid()).clone())));
    assert_eq!(one.number, same.number);
    assert!(Arc::ptr_eq(&one.data, &same.data));
    assert!(Kept::<Grid>::find(one.number).is_some() && one.number.fract() == 0.0 && one.number < 16_777_216.0);
    assert_eq!(kernel::value(Op::Sampled, &[0.5, 0.0, 0.0, 0.0]), 0.0, "no grid has such a number");
}

#[test]
fn what_is_not_solid_and_where_the_solid_lies_is_known() {
    let scene = compiled("solid", "scene = mesh_field(\"pyramid.obj\", 32)");
    let [low, high] = scene.bounds().expect("a box about the solid");
    // By a cell at most too wide.
    let cell = 2.2 / 32.0;
    for (found, expected) in low.into_iter().chain(high).zip([-1.0, 0.0, -1.0, 1.0, 1.5, 1.0]) {
        assert!((found - expected).abs() < 2.5 * cell, "{low:?} to {high:?}");
    }
}

#[test]
fn what_is_wrong_is_said_at_its_place() {
    let broken = [
        ("mesh_field(\"nowhere.obj\")", "`nowhere.obj` can't be made a field", 23),
        ("mesh_field(\"empty.obj\")", "the file is empty", 23),
        ("mesh_field(\"points.obj\")", "it has no triangles", 23),
        ("mesh_field(\"pyramid.txt\")", "its format is not known", 23),
        ("mesh_field(\"nan.obj\")", "can't be made a field", 23),
        ("mesh_field(\"broken.sfgrid\")", "can't be made a field", 23),
        ("mesh_field(\"pyramid.obj\", 4)", "a grid has 8 to 1024 cells", 38),
        ("mesh_field(\"pyramid.obj\", 20.5)", "a grid has 8 to 1024 cells", 38),
        ("mesh_field(\"pyramid.obj\", padding: 3)", "the padding is a share", 47),
        ("sphere(1).baked(4)", "a grid has 8 to 1024 cells", 28),
        ("sphere(1).baked(700)", "it can't be baked: the grid would take", 22),
        ("sphere(1 + 0.1 * sin(time)).baked()", "what is baked is sampled while compiling", 12),
        ("plane(y).baked()", "has no end that is known", 12),
        ("circle(1).baked()", "this is a drawing", 12),
        ("mesh_field(3)", "the name of a file is needed here", 23),
        ("mesh_field()", "needs more arguments", 12),
        ("mesh_field(\"pyramid.obj\", resolution: 32 + 8 * sin(time))", "this must be known while compiling", 50),
    ];
    for (call, words, column) in broken {
        let (_, path) = scene("broken", &format!("\nscene    = {call}\n"));
        let folder = path.parent().unwrap();
        std::fs::write(folder.join("empty.obj"), "").unwrap();
        std::fs::write(folder.join("points.obj"), "v 0 0 0\nv 1 0 0\n").unwrap();
        std::fs::write(folder.join("pyramid.txt"), pyramid(1.0)).unwrap();
        std::fs::write(folder.join("nan.obj"), pyramid(f64::NAN)).unwrap();
        std::fs::write(folder.join("broken.sfgrid"), "SFGRID and no more").unwrap();
        let outcome = compile(&Disk, path.to_str().unwrap(), &Options::default());
        let [found] = &outcome.diagnostics[..] else { panic!("{call}: {:?}", outcome.diagnostics) };
        assert!(found.message.replace(&format!("{}/", folder.display()), "").contains(words), "{call}: {}", found.message);
        let (_, line, at) = outcome.sources.position(found.span.file, found.span.start);
        assert!(outcome.compiled.is_none() && !found.help.is_empty());
        assert_eq!((line, at), (2, column), "{call}");
    }
}

#[test]
fn a_grid_that_was_baked_is_the_same_shape() {
    let (mesh, path) = scene("baked", "scene = mesh_field(\"pyramid.obj\", 16) | mesh_field(\"pyramid.sfgrid\")");
    let grid = Disk.grid(mesh.to_str().unwrap(), sampled::Settings { resolution: 16, padding: 0.05 }).unwrap();
    std::fs::write(mesh.with_extension("sfgrid"), grid.to_bytes()).unwrap();
    let scene = compile_file(path.to_str().unwrap()).unwrap();
    assert_eq!(scene.graph.grids.len(), 1);
}

/// What a scene looks like.
fn picture(gpu: &surefoot_runtime::Gpu, scene: &Compiled) -> Vec<u8> {
    headless::render(gpu, scene, &scene.live(), &Shot::new(64, 48)).unwrap().rgba
}

#[test]
fn a_vertex_that_moves_is_in_the_next_picture() {
    let gpu = gpu();
    let (mesh, path) = scene("reload", "camera { eye: (4, 2, 5), target: (0, 0.7, 0) }\nscene = mesh_field(\"pyramid.obj\", 24) | box((4, 0.1, 4))");
    let live = LiveScene::start(Setup {
        path: path.to_str().unwrap().to_owned(),
        options: Options::default(),
        loader: Arc::new(Disk),
        compile: Arc::new(compile),
        target: Some((gpu.clone(), FORMAT)),
        mode: ViewMode::Shaded,
        wake: Arc::new(|| {}),
    })
    .unwrap();
    let next = || {
        let start = Instant::now();
        loop {
            if let Some(update) = live.poll() {
                return update;
            }
            assert!(start.elapsed() < Duration::from_secs(120), "no update: {:?}", live.report());
            std::thread::sleep(Duration::from_millis(1));
        }
    };
    let first = next().ready.expect("a scene").compiled;
    std::fs::write(&mesh, pyramid(2.2)).unwrap();
    let second = next().ready.expect("the scene with the vertex elsewhere").compiled;
    assert_ne!(picture(&gpu, &first), picture(&gpu, &second));
    // A broken file is an error, and nothing new is drawn.
    std::fs::write(&mesh, "v 0 0").unwrap();
    let update = next();
    assert!(update.ready.is_none() && update.words.diagnostics.len() == 1, "{:?}", update.words.diagnostics);
    // What was there before is found again.
    std::fs::write(&mesh, pyramid(1.5)).unwrap();
    let third = next().ready.expect("the scene again").compiled;
    assert_eq!(picture(&gpu, &first), picture(&gpu, &third));
    assert_eq!(first.graph.grids[0].number, third.graph.grids[0].number);
}

/// Places at which a field is zero, each found between a point within and one without.
fn zeros(field: &dyn Fn([f64; 3]) -> f64, count: usize, random: &mut Random) -> Vec<[f64; 3]> {
    let mut found = Vec::new();
    while found.len() < count {
        let mut ends = [random.within(1.6), random.within(1.6)];
        if (field(ends[0]) < 0.0) == (field(ends[1]) < 0.0) {
            continue;
        }
        let within = usize::from(field(ends[0]) >= 0.0);
        for _ in 0..50 {
            let middle = [0, 1, 2].map(|i| 0.5 * (ends[0][i] + ends[1][i]));
            ends[if field(middle) < 0.0 { within } else { 1 - within }] = middle;
        }
        found.push(ends[0]);
    }
    found
}

#[test]
fn a_field_that_became_a_mesh_and_a_field_again_is_where_it_was() {
    /// How far the mesh may be from the surface.
    const TOLERANCE: f64 = 0.01;
    let shapes = [
        ("ring", "scene = torus(0.8, 0.3).rotate(x, 0.4)"),
        ("drilled", "scene = box((1.3, 0.9, 1.1)).rotate(y, 0.5) - cylinder(0.3, 3)"),
        ("blended", "scene = smooth_union(box(1).twist(y, 0.6), sphere(0.6).translate(0.5, 0.5, 0), 0.3)"),
        ("hollow", "scene = sphere(1).shell(0.2) - box(2).translate(1, 1, 1)"),
    ];
    for (name, text) in shapes {
        let (mesh_path, path) = scene(&format!("trip-{name}"), text);
        let first = compile_file(path.to_str().unwrap()).unwrap();
        let fine = contour::Settings { detail: Detail::Tolerance(TOLERANCE), sharp: true, within: None };
        let mesh = contour::contour(&first, &first.live(), &fine, &|_| {}).unwrap();
        let vertices = mesh.vertices.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n"));
        let triangles = mesh.triangles.iter().map(|t| t.map(|i| i + 1)).map(|[a, b, c]| format!("f {a} {b} {c}\n"));
        std::fs::write(&mesh_path, vertices.chain(triangles).collect::<String>()).unwrap();
        std::fs::write(&path, "scene = mesh_field(\"pyramid.obj\", resolution: 96)").unwrap();
        let again = compile_file(path.to_str().unwrap()).unwrap();
        let surface = Surface::new(&mesh.vertices, &mesh.triangles, Sign::Auto).unwrap();
        let [_, near] = sampled::measure(&again.graph.grids[0].data, &surface, 20_000);
        let most = TOLERANCE + near.largest;
        let tapes = [&first, &again].map(|scene| {
            let formulas = &scene.functions.formulas;
            Tape::new(&scene.graph, formulas, &[formulas[&(scene.root, Function::Field)]], &scene.live(), 100_000).unwrap()
        });
        let value = |which: usize, p: [f64; 3]| {
            let mut value = f64::NAN;
            tapes[which].evaluator().at(&[p], &[], |_, found| value = found[0]);
            value
        };
        let mut random = Random(5);
        for (one, other) in [(0, 1), (1, 0)] {
            for p in zeros(&|p| value(one, p), 500, &mut random) {
                // Where the other has both signs within a ball, it has a zero there.
                let side = value(other, p) < 0.0;
                let is_near = (0..400).any(|_| {
                    let way = random.direction();
                    (value(other, [0, 1, 2].map(|i| p[i] + most * way[i])) < 0.0) != side
                });
                assert!(is_near, "{name}: no zero of {other} is within {most} of {p:?}, a zero of {one}");
            }
        }
    }
}

#[test]
fn what_is_baked_is_the_nearer_the_more_cells_there_are() {
    let text = "torus(0.8, 0.3).displace(0.05 * fbm(4 * p, 3))";
    let exact = compiled("fine", &format!("scene = {text}"));
    let field = exact.functions.formulas[&(exact.root, Function::Field)];
    let tape = Tape::new(&exact.graph, &exact.functions.formulas, &[field], &exact.live(), 100_000).unwrap();
    let mut random = Random(11);
    let value = |p: [f64; 3]| {
        let mut value = f64::NAN;
        tape.evaluator().at(&[p], &[], |_, found| value = found[0]);
        value
    };
    let places = zeros(&value, 1000, &mut random);
    let [coarse, fine] = [24, 96].map(|cells| {
        let scene = compiled("fine", &format!("scene = {text}.baked({cells})"));
        let [baked] = &scene.graph.baked[..] else { panic!("{:?}", scene.graph.baked) };
        let grid = &scene.graph.grids[0].data;
        // Where the formula is zero the grid is nearly.
        let off: Vec<f64> = places.iter().map(|p| grid.inside(*p).abs()).collect();
        let (largest, mean) = (off.iter().copied().fold(0.0, f64::max), off.iter().sum::<f64>() / 1000.0);
        assert!(largest < 1.5 * baked.off.largest && mean < 1.5 * baked.off.mean, "{cells}: {largest} {mean} {:?}", baked.off);
        baked.off
    });
    assert!(fine.mean < 0.25 * coarse.mean && fine.largest < 0.5 * coarse.largest, "{coarse:?} {fine:?}");
}

#[test]
fn what_is_baked_keeps_its_material_and_is_sampled_once() {
    let text = "material red { color: #ff0000 }\nscene = sphere(1).displace(0.05 * fbm(4 * p, 3)).material(red).baked(32).translate(0, 0, 0)";
    let loader = surefoot_compiler::MemoryLoader::new().with("main.sdf", text);
    let mut memory = surefoot_compiler::Memory::default();
    let mut compiled = || surefoot_compiler::compile_remembering(&loader, "main.sdf", &Options::default(), &mut memory, &mut |_| {}).compiled.unwrap();
    let (first, second) = (compiled(), compiled());
    assert_eq!(first.graph.grids.len(), 1);
    assert!(Arc::ptr_eq(&first.graph.grids[0].data, &second.graph.grids[0].data));
    let color = first.functions.surface.color.map(|node| first.graph.as_constant(node));
    assert_eq!(color, [Some(1.0), Some(0.0), Some(0.0)]);
}
