//! What `compile` writes for other hosts: forms of uniforms, entry points that draw, and whole files.

use super::{folder, run};
use serde_json::Value;
use std::fs;

#[test]
fn forms_of_uniforms_are_what_was_asked_for() {
    let folder = folder("forms");
    let (code, wgsl, says) = run(&folder, &["compile", "good.sdf", "--functions", "field", "--uniforms", "separate", "--group", "2", "--binding", "5", "--layout", "layout.json"]);
    assert_eq!(code, 0, "{says}");
    assert!(wgsl.contains("@group(2) @binding(5) var<uniform> sf_origin: vec3f;\n@group(2) @binding(6) var<uniform> sf_size: f32;\n"), "{wgsl}");
    let layout: Value = serde_json::from_slice(&fs::read(folder.join("layout.json")).unwrap()).unwrap();
    assert_eq!(layout["form"], "separate");
    assert_eq!((&layout["uniforms"][1]["binding"], &layout["uniforms"][1]["offset"], &layout["binding"]), (&6.into(), &Value::Null, &Value::Null));
    let (code, wgsl, says) = run(&folder, &["compile", "good.sdf", "--functions", "field", "--uniforms", "private"]);
    assert_eq!(code, 0, "{says}");
    assert!(wgsl.contains("var<private> sf_uniforms: sf_Uniforms = sf_Uniforms(vec3f(0.0, 0.0, 0.0), 1.0);"), "{wgsl}");
    let (code, _, says) = run(&folder, &["compile", "good.sdf", "--uniforms", "separate", "--prefix", ""]);
    assert_eq!(code, 2, "{says}");
    let (code, wgsl, says) = run(&folder, &["compile", "good.sdf", "--entry", "draw", "--prefix", "sf_my_"]);
    assert_eq!(code, 0, "{says}");
    assert!(wgsl.contains("fn sf_my_fragment(") && !wgsl.contains("my_my"), "{wgsl}");
}

#[test]
fn a_page_is_one_file_that_loads_nothing() {
    let folder = folder("page");
    let (code, _, says) = run(&folder, &["compile", "good.sdf", "--for", "html", "-o", "good.html", "--set", "style=ball"]);
    assert_eq!(code, 0, "{says}");
    let page = fs::read_to_string(folder.join("good.html")).unwrap();
    assert!(page.contains("default-src 'none'; script-src 'sha256-") && page.contains("<title>good</title>"), "{page}");
    assert!(!page.contains("%%") && !page.contains("http:") && !page.contains("https:") && !page.contains(" src="), "{page}");
    assert_eq!((page.matches("<script").count(), page.matches("</script>").count()), (4, 4));
    // What a person writes ends no text of the page.
    fs::write(folder.join("odd.sdf"), "param a = 1 in 0.5..2 \"</script><b>%%SCRIPT%%\"\nscene = sphere(a)\n").unwrap();
    let (code, odd, says) = run(&folder, &["compile", "odd.sdf", "--for", "html"]);
    assert_eq!(code, 0, "{says}");
    assert_eq!((odd.matches("<script").count(), odd.matches("</script>").count(), odd.matches("<b>").count()), (4, 4, 0));
    for wrong in [vec!["--target", "glsl"], vec!["-o", "page.png"], vec!["--set", "size=0.5"]] {
        let (code, _, says) = run(&folder, &[&["compile", "good.sdf", "--for", "html"], &wrong[..]].concat());
        assert_eq!(code, 2, "{says}");
    }
}

#[test]
fn modules_for_engines_export_a_field() {
    let folder = folder("engines");
    // Backquotes, and what else ends a text of JavaScript; names of the engine and of the language.
    let text = "param input = 1 in 0.5..2 \"`${a}` </script> \\n\"\nparam cameraPosition = 0.2 in 0..1\nscene = sphere(input).translate(0, sin(time), cameraPosition)\n";
    fs::write(folder.join("odd.sdf"), text).unwrap();
    for host in ["three", "three-webgl", "babylon", "playcanvas"] {
        let (code, module, says) = run(&folder, &["compile", "odd.sdf", "--for", host]);
        assert_eq!(code, 0, "{says}");
        assert!(module.contains("export class Field extends ") && module.contains("\"parameter\":\"cameraPosition\""), "{module}");
        assert!(!module.contains("%%") && !module.contains("</script"), "{module}");
        assert_eq!(module.contains("uniform float cameraPosition_value;"), host == "three-webgl");
        // No text between backquotes ends but where it shall.
        let plain = module.replace("\\`", "").replace("`three-webgl`", "");
        assert_eq!(plain.lines().filter(|line| !line.starts_with("//")).map(|line| line.matches('`').count()).sum::<usize>() % 2, 0);
    }
    let (code, module, says) = run(&folder, &["compile", "odd.sdf", "--for", "wgpu-py"]);
    assert_eq!(code, 0, "{says}");
    assert!(module.contains("class Field:") && module.contains("\"parameter\":\"cameraPosition\"") && !module.contains("%%"), "{module}");
    assert_eq!(module.matches("'''").count(), 4, "{module}");
    fs::write(folder.join("baked.sdf"), "scene = sphere(1).baked(16)\n").unwrap();
    let (code, _, says) = run(&folder, &["compile", "baked.sdf", "--for", "three"]);
    assert_eq!(code, 2);
    assert!(says.contains("--for html"), "{says}");
}

#[test]
fn an_exported_page_has_a_poster_a_size_and_its_values() {
    let folder = folder("export");
    let (code, _, says) = run(&folder, &["export", "good.sdf", "-o", "good.html", "--size", "96x64", "--set", "size=1.25", "--device", "cpu"]);
    assert_eq!(code, 0, "{says}");
    let page = fs::read_to_string(folder.join("good.html")).unwrap();
    let poster = page.split_once("src=\"data:image/jpeg;base64,").unwrap().1.split('"').next().unwrap();
    assert!(poster.starts_with("/9j/") && poster.len() > 800, "{poster}");
    assert!(page.contains("aspect-ratio: 96 / 64") && page.contains("<button id=\"pause\""), "{page}");
    assert!(page.contains(&1.25f32.to_bits().to_string()) && page.contains("img-src data:"), "{page}");
    let (code, _, says) = run(&folder, &["export", "good.sdf", "-o", "bare.html", "--bare", "--no-poster"]);
    assert_eq!(code, 0, "{says}");
    let page = fs::read_to_string(folder.join("bare.html")).unwrap();
    assert!(!page.contains("<details") && !page.contains("<button") && !page.contains("<img"), "{page}");
    for wrong in [vec!["-o", "page.png"], vec!["-o", "good.sdf"], vec!["-o", "a.html", "--set", "sise=2"]] {
        let (code, _, says) = run(&folder, &[&["export", "good.sdf"], &wrong[..]].concat());
        assert_eq!(code, 2, "{says}");
    }
}

#[test]
fn a_shader_for_shadertoy_has_its_entry() {
    let folder = folder("shadertoy");
    fs::write(folder.join("turn.sdf"), "scene = box(1).rotate(y, time)\n").unwrap();
    let (code, shader, says) = run(&folder, &["compile", "turn.sdf", "--for", "shadertoy"]);
    assert_eq!(code, 0, "{says}");
    assert!(shader.contains("void mainImage(out vec4 fragColor, in vec2 fragCoord) {\n    sf_uniforms.time = iTime;\n"), "{shader}");
    for word in ["#version", "void main()", "gl_FragDepth", "layout(", "precision "] {
        assert!(!shader.contains(word), "{word} in\n{shader}");
    }
    // What no shader of the page can read is said.
    fs::write(folder.join("baked.sdf"), "scene = sphere(1).baked(16)\n").unwrap();
    let (code, _, says) = run(&folder, &["compile", "baked.sdf", "--for", "shadertoy"]);
    assert_eq!(code, 2, "{says}");
}

#[test]
fn shaders_for_vulkan_have_bindings_and_entries() {
    let folder = folder("vulkan");
    for file in ["good.spv", "good.frag", "good.vert"] {
        let (code, _, says) = run(&folder, &["compile", "good.sdf", "--for", "vulkan", "-o", file]);
        assert_eq!(code, 0, "{says}");
    }
    let text = |file: &str| fs::read_to_string(folder.join(file)).unwrap();
    let (fragment, vertex) = (text("good.frag"), text("good.vert"));
    assert!(fragment.starts_with("#version 450") && fragment.contains("layout(std140, binding = 0) uniform"), "{fragment}");
    assert!(fragment.contains("gl_FragDepth") && vertex.contains("gl_VertexIndex") && !vertex.contains("gl_VertexID"), "{vertex}");
    let words: Vec<u32> = fs::read(folder.join("good.spv")).unwrap().chunks(4).map(|w| u32::from_le_bytes([w[0], w[1], w[2], w[3]])).collect();
    let (mut at, mut entries, mut capabilities) = (5, 0, Vec::new());
    while at < words.len() {
        match words[at] & 0xffff {
            15 => entries += 1,
            17 => capabilities.push(words[at + 1]),
            _ => {}
        }
        at += (words[at] >> 16) as usize;
    }
    assert_eq!((entries, capabilities), (2, vec![1]), "Shader, and nothing to link");
}

#[test]
fn a_shader_for_godot_has_no_global_variables() {
    let folder = folder("godot");
    fs::write(folder.join("turn.sdf"), "param size = 1 in 0.5..2 \"how large\"\nparam tint: color = #ff0000\nmaterial m { color: tint }\nscene = box(size).rotate(y, time).material(m)\n").unwrap();
    let (code, shader, says) = run(&folder, &["compile", "turn.sdf", "--for", "godot"]);
    assert_eq!(code, 0, "{says}");
    assert!(shader.contains(" : hint_range(0.5, 2.0) = 1.0; // how large\n"), "{shader}");
    assert!(shader.contains("uniform vec3 tint = vec3(") && shader.contains("sf_uniforms.time = TIME;"), "{shader}");
    for line in shader.lines().filter(|line| line.ends_with(';') && !line.starts_with([' ', '\t', '}'])) {
        let known = ["shader_type ", "render_mode ", "uniform ", "const "].iter().any(|start| line.starts_with(start));
        assert!(known, "{line}");
    }
}

#[test]
fn a_material_for_bevy_has_its_plugin() {
    let folder = folder("bevy");
    fs::write(folder.join("my scene 2.sdf"), "param size = 1 in 0.5..2 \"how large\"\nscene = box(size).rotate(y, time)\n").unwrap();
    let (code, _, says) = run(&folder, &["compile", "my scene 2.sdf", "--for", "bevy", "-o", "s.wgsl"]);
    assert_eq!(code, 0, "{says}");
    let text = |file: &str| fs::read_to_string(folder.join(file)).unwrap();
    let (shader, plugin) = (text("s.wgsl"), text("s.rs"));
    assert!(shader.contains("#define_import_path surefoot::my_scene\n") && shader.contains("@group(#{MATERIAL_BIND_GROUP}) @binding(0)"), "{shader}");
    assert!(plugin.contains("pub struct MyScenePlugin;") && plugin.contains("    pub size: f32,\n") && plugin.contains("\"s.wgsl\".into()"), "{plugin}");
    // Nothing is written over what is not a file of its own.
    let (code, _, says) = run(&folder, &["compile", "my scene 2.sdf", "--for", "bevy", "-o", "s.rs"]);
    assert_eq!(code, 2, "{says}");
}

#[test]
fn text_for_direct3d_and_metal_says_what_it_binds() {
    let folder = folder("text");
    let (code, hlsl, says) = run(&folder, &["compile", "good.sdf", "--for", "hlsl"]);
    assert_eq!(code, 0, "{says}");
    assert!(hlsl.contains("dxc -T ps_6_0 -E sf_fragment") && hlsl.contains(": register(b0)"), "{hlsl}");
    let (code, msl, says) = run(&folder, &["compile", "good.sdf", "--for", "msl"]);
    assert_eq!(code, 0, "{says}");
    assert!(msl.contains("[[buffer(0)]]") && !msl.contains("fake"), "{msl}");
}
