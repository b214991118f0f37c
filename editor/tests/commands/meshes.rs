//! `surefoot mesh`: what it writes, read back, and what it refuses.

use super::{folder, run};
use std::fs;
use std::path::Path;
use std::sync::Arc;
use surefoot_compiler::Loader;
use surefoot_compiler::sampled::{Grid, Settings};
use surefoot_runtime::mesh::Mesh;

struct Disk;

impl Loader for Disk {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        fs::read(path).map_err(|why| why.to_string())
    }

    fn grid(&self, path: &str, settings: Settings) -> Result<Arc<Grid>, String> {
        surefoot_runtime::mesh::field::grid(self, path, settings, &|_| {})
    }
}

fn load(path: &Path) -> Mesh {
    Mesh::load(&Disk, path.to_str().unwrap()).unwrap()
}

fn package(path: &Path) -> threemf2::package::ThreemfPackage {
    threemf2::package::ThreemfPackage::from_reader_with_memory_optimized_deserializer(fs::File::open(path).unwrap(), true).unwrap()
}

/// The two numbers at the start of what the command says: vertices and triangles.
fn counts(said: &str) -> (usize, usize) {
    let numbers: Vec<usize> = said.split([' ', ',']).filter_map(|word| word.parse().ok()).take(2).collect();
    (numbers[0], numbers[1])
}

/// Volume inside of closed triangles.
fn volume(mesh: &Mesh) -> f64 {
    let corner = |i: u32| mesh.vertices[i as usize].position.map(f64::from);
    mesh.indices.chunks(3).map(|t| {
        let [a, b, c] = [corner(t[0]), corner(t[1]), corner(t[2])];
        let n = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
        (a[0] * n[0] + a[1] * n[1] + a[2] * n[2]) / 6.0
    }).sum()
}

#[test]
fn meshes_are_read_back_as_they_were_written() {
    let folder = folder("mesh");
    fs::write(folder.join("ball.sdf"), "material red { color: #ff0000 }\nscene = sphere(1).material(red)\n").unwrap();
    let mut first: Option<(usize, usize)> = None;
    for ending in ["stl", "obj", "ply", "glb"] {
        let file = format!("ball.{ending}");
        let (code, out, err) = run(&folder, &["mesh", "ball.sdf", "-o", &file, "--resolution", "32"]);
        assert_eq!((code, err.as_str()), (0, ""), "{out}");
        assert!(out.contains("each edge in two of them") && out.contains("1 piece, Euler number 2"), "{out}");
        let said = counts(&out);
        assert_eq!(*first.get_or_insert(said), said);
        let mesh = load(&folder.join(&file));
        assert_eq!((mesh.vertices.len(), mesh.indices.len() / 3), said, "{ending}");
        assert!((volume(&mesh) - 4.0 / 3.0 * std::f64::consts::PI).abs() < 0.03, "{ending}: {}", volume(&mesh));
        assert!(mesh.bounds.iter().flatten().all(|c| (c.abs() - 1.0).abs() < 0.01), "{ending}: {:?}", mesh.bounds);
    }
    let (code, _, err) = run(&folder, &["mesh", "ball.sdf", "-o", "ball.3mf", "--resolution", "32"]);
    assert_eq!((code, err.as_str()), (0, ""));
    // Every corner is red, as screens have it.
    let text = fs::read_to_string(folder.join("ball.obj")).unwrap();
    assert!(text.lines().filter(|line| line.starts_with("v ")).all(|line| line.ends_with(" 1.0000 0.0000 0.0000")), "{}", &text[..200]);
    let package = package(&folder.join("ball.3mf"));
    let group = &package.root.resources.colorgroup[0];
    assert_eq!((group.color.len(), group.color[0].color.to_hex_compact()), (1, "#FF0000".to_owned()));
    let [object] = &package.root.resources.object[..] else { panic!("one object") };
    let triangles = &object.get_mesh().unwrap().triangles.triangle;
    assert!(u32::from(object.id) != group.id && triangles.len() == first.unwrap().1);
    assert!(triangles.iter().all(|t| t.pid.get() == Some(group.id) && [t.p1, t.p2, t.p3].iter().all(|p| p.get() == Some(0))));
}

#[test]
fn a_tolerance_a_box_a_value_and_a_moment_are_taken() {
    let folder = folder("mesh_options");
    let (code, out, err) = run(&folder, &["mesh", "good.sdf", "-o", "a.obj", "--tolerance", "0.01", "--set", "size=0.5", "--set", "style=ball"]);
    assert_eq!((code, err.as_str()), (0, ""), "{out}");
    assert!(out.contains("2 pieces, Euler number 4"), "{out}");
    fs::write(folder.join("ground.sdf"), "scene = sphere(1).translate(time, 0, 0) | plane(y, -3)\n").unwrap();
    let (code, _, err) = run(&folder, &["mesh", "ground.sdf", "-o", "b.stl"]);
    assert_eq!(code, 1);
    assert!(err.contains("has no end") && err.contains("--within="), "{err}");
    assert!(!folder.join("b.stl").exists());
    // One that ends at each moment is cut off nowhere.
    fs::write(folder.join("moved.sdf"), "param far = 1 in 0..2\nscene = sphere(1).translate(time * far, 0, 0)\n").unwrap();
    let (code, out, err) = run(&folder, &["mesh", "moved.sdf", "-o", "m.stl", "--time", "4", "--set", "far=2", "--resolution", "24"]);
    assert_eq!((code, err.as_str()), (0, ""), "{out}");
    let bounds = load(&folder.join("m.stl")).bounds;
    assert!((bounds[0][0] - 7.0).abs() < 0.01 && (bounds[1][0] - 9.0).abs() < 0.01, "{bounds:?}");
    let (code, out, err) = run(&folder, &["mesh", "ground.sdf", "-o", "b.stl", "--within", "(-2,-2,-2)..(4,2,2)", "--time", "2", "--smooth", "--resolution", "40"]);
    assert_eq!((code, err.as_str()), (0, ""));
    let bounds = load(&folder.join("b.stl")).bounds;
    assert!((bounds[0][0] - 1.0).abs() < 0.05 && (bounds[1][0] - 3.0).abs() < 0.05, "{bounds:?} {out}");
}

/// A scene in centimetres: what has a unit of its own is scaled to it, and the rest says that of the scene.
#[test]
fn a_unit_goes_along() {
    let folder = folder("mesh_unit");
    fs::write(folder.join("block.sdf"), "param wide = 2cm in 5mm..5cm\nrender { unit: cm }\nscene = box((wide, 10mm, 0.5in))\n").unwrap();
    let wide = |file: &str, set: &str| {
        let (code, out, err) = run(&folder, &["mesh", "block.sdf", "-o", file, "--resolution", "16", "--set", set]);
        assert_eq!((code, err.as_str()), (0, ""), "{out}");
        assert!(out.contains(" cm³, area ") && out.contains("0.6350) cm"), "{out}");
        fs::read(folder.join(file)).unwrap()
    };
    for (file, set, size) in [("b.stl", "wide=20mm", 20.0), ("b.glb", "wide=2", 0.02), ("b.obj", "wide=0.03m", 3.0), ("b.ply", "wide=1in", 2.54)] {
        let bytes = wide(file, set);
        let [low, high] = load(&folder.join(file)).bounds.map(|corner| f64::from(corner[0]));
        assert!((high - low - size).abs() < 1e-5 * size, "{file}: {low} to {high}");
        let says = bytes.windows(8).any(|w| w == b"unit: cm");
        assert_eq!(says, file.ends_with("obj") || file.ends_with("ply"), "{file}");
    }
    // A 3MF's model is deflated; its reader says the unit.
    wide("b.3mf", "wide=2");
    let package = package(&folder.join("b.3mf"));
    assert_eq!(package.root.unit, Some(threemf2::model::builder::Unit::Centimeter));
    for (set, told) in [("wide=6cm", "6cm is outside of 0.5cm to 5cm"), ("wide=1mm,2mm", "it takes 1 number"), ("wide=3ells", "is no number")] {
        let (code, _, err) = run(&folder, &["mesh", "block.sdf", "-o", "x.stl", "--set", set]);
        assert_eq!(code, 2, "{err}");
        assert!(err.contains(told), "{err}");
    }
}

#[test]
fn what_has_no_mesh_is_refused() {
    let folder = folder("mesh_refused");
    fs::write(folder.join("empty.sdf"), "scene = sphere(1) & sphere(1).translate(5, 0, 0)\n").unwrap();
    fs::write(folder.join("tiles.sdf"), "scene = sphere(0.3).repeat(1)\n").unwrap();
    for (args, exit, told) in [
        (&["mesh", "empty.sdf", "-o", "x.stl"][..], 1, "no surface"),
        (&["mesh", "tiles.sdf", "-o", "x.stl"], 1, "--within"),
        (&["mesh", "bad.sdf", "-o", "x.stl"], 1, "unknown-name"),
        (&["mesh", "good.sdf", "-o", "x.stl", "--within", "(8,8,8)..(9,9,9)"], 1, "no surface"),
        (&["mesh", "good.sdf", "-o", "x.stl", "--within", "(0,0,0)..(9,9,9e9)"], 1, "extent"),
        (&["mesh", "good.sdf", "-o", "x.stl", "--resolution", "4000"], 1, "take fewer"),
        (&["mesh", "good.sdf", "-o", "x.stl", "--resolution", "1"], 2, "--resolution"),
        (&["mesh", "good.sdf", "-o", "x.stl", "--tolerance", "-1"], 2, "above zero"),
        (&["mesh", "good.sdf", "-o", "x.stl", "--within", "1,2"], 2, "two corners"),
        (&["mesh", "good.sdf"], 2, "--output"),
    ] {
        let (code, _, err) = run(&folder, args);
        assert_eq!(code, exit, "{args:?}: {err}");
        assert!(err.contains(told), "{args:?}: {err}");
        assert!(!folder.join("x.stl").exists());
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_mesh_is_sampled_at_the_first_start_alone() {
    use std::os::unix::fs::MetadataExt;
    let folder = folder("mesh_kept");
    let pyramid = |tip: f64| format!("v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 {tip} 0\nf 1 2 3\nf 1 3 4\nf 2 1 5\nf 3 2 5\nf 4 3 5\nf 1 4 5\n");
    fs::write(folder.join("tip.obj"), pyramid(1.5)).unwrap();
    fs::write(folder.join("tip.sdf"), "scene = mesh_field(\"tip.obj\", 24)\n").unwrap();
    let check = || run(&folder, &["check", "tip.sdf", "--factors"]);
    let grids = || fs::read_dir(folder.join("cache/surefoot/grids")).unwrap().map(|entry| entry.unwrap().path()).collect::<Vec<_>>();
    let first = check();
    assert_eq!(first.0, 0, "{first:?}");
    let [kept] = &grids()[..] else { panic!("{:?}", grids()) };
    let (file, bytes) = (|| fs::metadata(kept).unwrap().ino(), fs::read(kept).unwrap());
    let written = file();
    assert_eq!((check(), file()), (first.clone(), written));
    // One that is broken is made again.
    fs::write(kept, &bytes[..bytes.len() - 1]).unwrap();
    assert_eq!((check(), fs::read(kept).unwrap()), (first, bytes));
    // Another mesh has another.
    fs::write(folder.join("tip.obj"), pyramid(1.6)).unwrap();
    assert_eq!((check().0, grids().len()), (0, 2));
}

/// What is certified is said with both distances; a ball that is missed, and is far from the mesh, is said with its place.
#[test]
fn a_mesh_is_certified_or_it_is_said_where_not() {
    let folder = folder("certified");
    fs::write(folder.join("ball.sdf"), "scene = sphere(1)\n").unwrap();
    for (how, ending) in [(["--resolution", "20"], "stl"), (["--tolerance", "0.02"], "obj")] {
        let (code, out, err) = run(&folder, &["mesh", "ball.sdf", "-o", &format!("ball.{ending}"), how[0], how[1], "--certify"]);
        assert_eq!((code, err.as_str()), (0, ""), "{out}");
        assert!(out.contains("\n  certified to ") && out.matches("; 0 proven to be farther; 0 undecided\n").count() == 2, "{out}");
    }
    fs::write(folder.join("moon.sdf"), "scene = sphere(1) | sphere(0.02).translate(1.7, 0.01, 0.02)\n").unwrap();
    let (code, out, err) = run(&folder, &["mesh", "moon.sdf", "-o", "moon.stl", "--resolution", "12", "--certify"]);
    assert_eq!((code, err.as_str()), (1, ""), "{out}");
    assert!(out.contains("1 piece, Euler number 2") && out.contains("\n  not certified to "), "{out}");
    assert!(out.contains("from surface to mesh") && out.contains("near (1.7") && !out.contains("; 0 proven to be farther; 0 undecided\n  from mesh"), "{out}");
    assert!(out.contains("triangles, all of them") && out.ends_with("; 0 proven to be farther; 0 undecided\n"), "{out}");
}
