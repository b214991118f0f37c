//! What `check` says of the scenes of the corpus, and what commands refuse.

use super::{command, folder, run, texts};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Scenes of the corpus, and what `check` says of their boxes: in words, and whether it is an upper limit and leaves planes out.
const BOXES: [(&str, &str, bool, bool); 7] = [
    ("box_of_a_ball", "from (0.3, 1.3, 2.3) to (1.7, 2.7, 3.7)", false, false),
    ("box_beside_a_plane", "from (-1, 0, -1.5) to (1, 1, 1.5), without the planes", false, true),
    ("box_of_a_slider", "at most from (-2.5, -0.5, -0.5) to (2.5, 0.5, 0.5)", true, false),
    ("polytopes", "from (-0.6928, -0.6928, -0.6928) to (3.1928, 0.6928, 0.6928)", false, false),
    ("polytope_octahedron", "from (0, -1, -1) to (2, 1, 1)", false, false),
    ("polytope_pyramid", "from (-1, 1, -1) to (1, 4, 1)", false, false),
    ("polytope_wedge", "from (0, -0.5, -0.25) to (1, 0.5, 0.25)", false, false),
];

#[test]
fn the_box_of_the_solid_is_the_same_for_people_and_machines() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/corpus/cases");
    let of = |name: &str| {
        let scene = format!("{name}.sdf");
        let (code, words, _) = run(&cases, &["check", &scene]);
        let (_, json, _) = run(&cases, &["check", "--json", &scene]);
        let report: Value = serde_json::from_str(&json).unwrap();
        assert_eq!(code, 0, "{words}");
        (words, report["scene"]["bounds"].clone())
    };
    for (name, said, at_most, planes) in BOXES {
        let (words, bounds) = of(name);
        assert!(words.ends_with(&format!("  solid:\n    {said}\n")), "{words}");
        assert_eq!((&bounds["at_most"], &bounds["without_planes"]), (&at_most.into(), &planes.into()), "{name}");
    }
    let (words, bounds) = of("json_box");
    for corner in ["min", "max"] {
        for side in bounds[corner].as_array().unwrap() {
            let short = format!("{:.4}", side.as_f64().unwrap());
            let short = short.trim_end_matches('0').trim_end_matches('.');
            assert!(words.contains(short), "{side} is not in\n{words}");
        }
    }
}

/// Scenes of the corpus, with which code `check` ends, and what it says of them.
const SAID: [(&str, i32, &[&str]); 4] = [
    ("symmetry_in_a_drawing", 0, &["symmetry_in_a_drawing.sdf: fine"]),
    ("cube", 1, &["cube.sdf:2:9", "help: write `box((10, 20, 30))`", "1 error\n"]),
    ("fillet", 1, &["fillet.sdf:2:9", "help: write `rounded_box(1, 0.1)`, which is as large as `box(1)`", "1 error\n"]),
    (
        "ranges_that_cannot_be",
        0,
        &[
            "ranges_that_cannot_be.sdf:2:16",
            "warning[range-reach]: the range of `k` reaches -1, where the `k` of `scale` is -1",
            "ranges_that_cannot_be.sdf:3:16",
            "warning[range-reach]: the range of `r` reaches -1, where the `major` of `torus` is -1",
            "2 warnings\n",
        ],
    ),
];

#[test]
fn cases_are_told_what_they_are_owed() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/corpus/cases");
    for (name, code, said) in SAID {
        let (exit, out, err) = run(&cases, &["check", &format!("{name}.sdf")]);
        assert_eq!((exit, err.as_str()), (code, ""), "{name}: {out}");
        for words in said {
            assert!(out.contains(words), "`{words}` is not in\n{out}");
        }
    }
}

/// A second scene is one too many, and what it reads is read all the same.
#[test]
fn what_a_second_scene_reads_is_not_called_unused() {
    let folder = folder("second");
    fs::write(folder.join("two.sdf"), "param a = 1 in 0..2\nparam b = 1 in 0..2\nparam c = 1 in 0..2\nscene = sphere(a)\nscene = box(b)\n").unwrap();
    let (code, out, _) = run(&folder, &["check", "two.sdf"]);
    assert_eq!(code, 1, "{out}");
    assert!(out.contains("reads `c`") && !out.contains("reads `a`") && !out.contains("reads `b`"), "{out}");
}

/// Each kind of file is written by one command; another says which.
#[test]
fn files_that_a_command_does_not_write_are_refused() {
    let folder = folder("endings");
    let render = ["render", "good.sdf", "--device", "cpu", "--size", "8x8", "-o"];
    for (args, file, told) in [
        (&["compile", "good.sdf", "-o"][..], "x.stl", "`surefoot mesh SCENE.sdf -o OUT.stl`"),
        (&["compile", "good.sdf", "-o"], "x.STL", "`surefoot mesh SCENE.sdf -o OUT.stl`"),
        (&["compile", "good.sdf", "-o"], "x.png", "`surefoot render SCENE.sdf -o OUT.png`"),
        (&["compile", "good.sdf", "-o"], "x.csv", "`surefoot simulate"),
        (&["compile", "good.sdf", "-o"], "x.glsl", "--target glsl"),
        (&["compile", "good.sdf", "--target", "glsl", "-o"], "x.wgsl", "`surefoot compile SCENE.sdf -o OUT.wgsl`"),
        (&["compile", "good.sdf", "-o"], "x.sdf", "`surefoot fmt SCENE.sdf`"),
        (&["compile", "good.sdf", "-o", "x.wgsl", "--layout"], "x.png", "`surefoot render"),
        (&render, "x.wgsl", "`surefoot compile SCENE.sdf -o OUT.wgsl`"),
        (&render, "x.obj", "`surefoot mesh SCENE.sdf -o OUT.obj`"),
        (&render, "x.3mf", "`surefoot mesh SCENE.sdf -o OUT.3mf`"),
        (&render, "x.gif", "--frames 0..120"),
        (&render, "x.jpg", "write `-o x.png`"),
        (&render, "x.ply", "`surefoot simulate"),
        (&["simulate", "good.sdf", "-o"], "x.png", "`surefoot render"),
        (&["simulate", "good.sdf", "-o"], "x.stl", "`surefoot mesh"),
        (&["mesh", "good.sdf", "-o"], "x.png", "`surefoot render"),
        (&["mesh", "good.sdf", "-o"], "x.gltf", "STL, OBJ, PLY, GLB or 3MF"),
    ] {
        let (code, out, err) = run(&folder, &[args, &[file]].concat());
        assert_eq!((code, out.as_str()), (2, ""), "{args:?} {file}: {err}");
        assert!(err.contains(told), "{args:?} {file}: {err}");
        assert!(!folder.join(file).exists(), "{file}");
    }
    for (args, file) in [
        (&["compile", "good.sdf", "-o"][..], "x.txt"),
        (&["compile", "good.sdf", "--target", "glsl", "-o"], "x.frag"),
        (&["compile", "good.sdf", "--target", "msl", "-o"], "x.metal"),
        (&render, "x.PNG"),
    ] {
        assert_eq!(run(&folder, &[args, &[file]].concat()).0, 0, "{args:?} {file}");
        assert!(folder.join(file).exists(), "{file}");
    }
}

/// Where there is no desktop, drivers complain of it; a person reads what the program says alone.
#[test]
fn drivers_write_nothing_of_their_own() {
    let folder = folder("drivers");
    let mut render = command(&folder, &["render", "good.sdf", "-o", "a.png", "--size", "8x8", "--device", "gpu"]);
    for name in ["XDG_RUNTIME_DIR", "WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"] {
        render.env_remove(name);
    }
    let (code, _, err) = texts(render.output().unwrap());
    assert!(code == 0 || code == 3, "{err}");
    assert!(err.lines().all(|line| line.starts_with("note: ") || line.starts_with("surefoot: ")), "{err}");
}
