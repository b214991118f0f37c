//! `surefoot import`, and what `check` says of a shader's own steps.

use super::{folder, run};
use serde_json::Value;
use std::fs;

const RIPPLES: &str = "\
float map(vec3 p) {
    return length(p) - 0.8 + 0.12 * sin(12.0 * p.x) * sin(12.0 * p.y) * sin(12.0 * p.z);
}

float trace(vec3 ro, vec3 rd) {
    float t = 0.0;
    for (int i = 0; i < 128; i++) {
        float d = map(ro + t * rd);
        if (d < 0.001) break;
        t += 0.95 * d;
    }
    return t;
}

void mainImage(out vec4 color, in vec2 at) {
    color = texture(iChannel0, at) * trace(vec3(0.0, 0.0, 3.0), normalize(vec3(at, -1.0)));
}
";

#[test]
fn a_shader_is_written_as_a_scene() {
    let folder = folder("import");
    fs::write(folder.join("ripples.glsl"), RIPPLES).unwrap();
    let (code, out, err) = run(&folder, &["import", "ripples.glsl", "-o", "ripples.sdf"]);
    assert_eq!((code, out.as_str()), (0, ""), "{err}");
    assert!(err.contains("note: ripples.glsl:16: `mainImage` is left out: a formula reads no textures"), "{err}");
    let written = fs::read_to_string(folder.join("ripples.sdf")).unwrap();
    for words in ["//! From ripples.glsl.\n", "fn map(p: vec3) =", "fn trace(ro: vec3, rd: vec3) =", "field solid = map(p)", "scene = solid"] {
        assert!(written.contains(words), "{words}:\n{written}");
    }
    let (code, out, err) = run(&folder, &["fmt", "--check", "ripples.sdf"]);
    assert_eq!(code, 0, "{out}{err}");
    let (code, out, err) = run(&folder, &["compile", "ripples.sdf"]);
    assert!(code == 0 && out.contains("fn sf_trace("), "{err}");
    // What is written is written again.
    let (code, out, _) = run(&folder, &["import", "ripples.glsl"]);
    assert!(code == 0 && out == written);
}

#[test]
fn what_is_no_shader_is_not_imported() {
    let folder = folder("import_wrong");
    fs::write(folder.join("wrong.glsl"), "float map(vec3 p) {\n    return lenght(p);\n}\n").unwrap();
    fs::write(folder.join("none.wgsl"), "fn wave(x: f32) -> f32 { return sin(x); }\n").unwrap();
    fs::write(folder.join("a.txt"), RIPPLES).unwrap();
    for (args, code, words) in [
        (&["import", "wrong.glsl"][..], 1, "wrong.glsl:2:12"),
        (&["import", "none.wgsl"], 2, "no function of the shader takes a point and gives back a distance"),
        (&["import", "none.wgsl", "--function", "map"], 2, "no such function"),
        (&["import", "a.txt"], 2, "no shader by its name"),
        (&["import", "nowhere.glsl"], 2, "can't read nowhere.glsl"),
    ] {
        let (got, out, err) = run(&folder, args);
        assert!(got == code && err.contains(words), "{args:?}: {got}\n{out}{err}");
    }
}

#[test]
fn check_says_what_a_step_by_hand_misses() {
    let folder = folder("import_check");
    fs::write(folder.join("ripples.glsl"), RIPPLES).unwrap();
    fs::write(folder.join("main.sdf"), "scene = shader(\"ripples.glsl\")\n").unwrap();
    let (code, out, err) = run(&folder, &["check", "main.sdf", "--holes", "holes.png"]);
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("ripples.glsl:10: your 0.95 of `map` leaves holes at ("), "{out}");
    let (code, out, _) = run(&folder, &["check", "main.sdf", "--json"]);
    let said: Value = serde_json::from_str(&out).unwrap();
    let shader = &said["shaders"][0];
    assert!(code == 0 && shader["line"] == 10 && shader["share"] == 0.95 && shader["proven"].as_f64().unwrap() < 0.95, "{shader}");
    // Holes are red, and there are some on the left alone.
    let picture = image::open(folder.join("holes.png")).unwrap().to_rgb8();
    let half = picture.width() / 2;
    let red = |left: u32| (0..picture.height()).flat_map(|y| (left..left + half).map(move |x| (x, y))).filter(|(x, y)| picture.get_pixel(*x, *y).0 == [255, 0, 80]).count();
    assert!(red(0) > 20 && red(half) == 0, "{} and {}", red(0), red(half));
    // With less, or with what is proven, there are none.
    let careful = RIPPLES.replace("0.95 * d", "0.2 * d");
    fs::write(folder.join("ripples.glsl"), careful).unwrap();
    let (code, out, _) = run(&folder, &["check", "main.sdf"]);
    assert!(code == 0 && out.contains("your 0.2 of `map` leaves no hole") && out.contains("would do: it is proven"), "{out}");
}
