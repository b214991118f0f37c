//! Wrong files and wrong words in what is read: fonts, paths, drawings, shaders and parts. Each is an error at its place, soon, and nothing else is read.

use std::cell::RefCell;
use std::time::{Duration, Instant};
use surefoot_compiler::diagnostic::{Severity, render};
use surefoot_compiler::loader::Loader;
use surefoot_compiler::{MemoryLoader, Options, compile};

/// Files in memory, and which were asked for.
struct Watched {
    files: MemoryLoader,
    asked: RefCell<Vec<String>>,
}

impl Loader for Watched {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        self.asked.borrow_mut().push(path.to_owned());
        self.files.read(path)
    }
}

/// What is wrong: the scene, a file beside it, where the error is (file, line, column), and a piece of what it says.
type Wrong = (String, (&'static str, Vec<u8>), &'static str, &'static str);

fn svg(inside: &str) -> Vec<u8> {
    format!("<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink' viewBox='0 0 9 9'>\n{inside}\n</svg>").into_bytes()
}

fn fonts() -> Vec<Wrong> {
    let font = std::fs::read(format!("{}/fonts/DejaVuSans-Bold.ttf", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let named = || "scene = text(\"a\", font: \"it.ttf\").extrude(1)".to_owned();
    let alone = |text: &str| (text.to_owned(), ("none", Vec::new()));
    let rows = [
        (alone("scene = text(\"a\", font: \"it.ttf\").extrude(1)"), "1:25", "can't be read"),
        (alone("scene = text(\"a\", font: \"../it.ttf\").extrude(1)"), "1:25", "can't be read"),
        ((named(), ("it.ttf", Vec::new())), "1:14", "can't be set"),
        ((named(), ("it.ttf", b"this is no font".to_vec())), "1:14", "can't be set"),
        ((named(), ("it.ttf", font[..900].to_vec())), "1:14", "can't be set"),
        ((named(), ("it.ttf", [&font[..12], &[0xff; 4000]].concat())), "1:14", "can't be set"),
        (alone("scene = text(\"\u{6f22}\u{5b57}\").extrude(1)"), "1:14", "the font has no"),
        (alone("scene = text(\"a\u{e000}b\").extrude(1)"), "1:14", "the font has no"),
        (alone(&format!("scene = text(\"{}\").extrude(1)", "a".repeat(4001))), "1:14", "4000"),
        (alone("scene = text(\"a\", size: -1).extrude(1)"), "1:25", "above zero"),
        (alone("scene = text(\"a\", align: \"middle\").extrude(1)"), "1:26", "no alignment"),
        (alone("param s = 1 in 1..2\nscene = text(\"a\", size: s).extrude(1)"), "2:25", "known while compiling"),
    ];
    rows.into_iter().map(|((text, file), place, words)| (text, file, place, words)).collect()
}

fn paths() -> Vec<Wrong> {
    let lines = |count: usize, flat: bool| {
        let point = |i: usize| if flat { format!("L {} {} ", 300 * (i % 2), i) } else { format!("L {} {} ", i, 300 * (i % 2)) };
        (0..count).map(point).collect::<String>()
    };
    let tangled = format!("M 0 0 {}{}", lines(300, true), lines(300, false));
    let long = format!("M 0 0 {}", (0..40_001).map(|i| format!("L {i} {} ", i % 7)).collect::<String>());
    let rows = [
        ("M 0 0 X".to_owned(), "no path data"),
        ("L 1 1".to_owned(), "no path data"),
        ("M 0 0 L 1".to_owned(), "no path data"),
        ("M 0 0 A 1 1 0 2 0 1 1".to_owned(), "no path data"),
        ("M 0 0 L 1 1e".to_owned(), "no path data"),
        ("M 0 0 C 1 2 3".to_owned(), "no path data"),
        (long, "curves at most"),
        (tangled, "cross each other too often"),
    ];
    rows.into_iter().map(|(data, words)| (format!("scene = path(\"{data}\").extrude(1)"), ("none", Vec::new()), "1:14", words)).collect()
}

fn drawings() -> Vec<Wrong> {
    let bomb: String = (0..24).map(|i| format!("<g id='a{}'><use href='#a{i}'/><use href='#a{i}'/></g>", i + 1)).collect();
    let laughs: String = (0..9).map(|i| format!("<!ENTITY e{} \"{}\">", i + 1, format!("&e{i};").repeat(10))).collect();
    let doctype = |entities: &str, inside: &str| format!("<!DOCTYPE svg [{entities}]><svg xmlns='http://www.w3.org/2000/svg'>{inside}</svg>").into_bytes();
    let clips: String = (0..90).map(|_| "<g clip-path='url(#k)'>").collect();
    let rows: Vec<(Vec<u8>, &str)> = vec![
        (Vec::new(), "no XML"),
        (b"M 0 0 H 1".to_vec(), "no XML"),
        (b"\x1f\x8b\x08\0\0".to_vec(), "it is packed"),
        (b"\xff\xfe<\0s\0".to_vec(), "UTF-8"),
        (b"<svg xmlns='http://www.w3.org/2000/svg'>\n<path d='M0 0H1".to_vec(), "no XML"),
        (b"<html><body/></html>".to_vec(), "begins with `html`"),
        (svg(""), "no fill"),
        (svg("<path fill='none' d='M0 0H1V1Z'/>"), "no fill"),
        (svg("<path fill='none' stroke='red' d='M0 0H1V1Z'/>"), "line 2, column 1: it has strokes and no fill"),
        (svg("<g>\n<path d='M0 0H1V1X'/></g>"), "line 3, column 1: its path"),
        (svg("<rect width='1' height='1' transform='rotate(a)'/>"), "`transform` can't be read"),
        (svg("<rect width='1' height='a'/>"), "`height` can't be read"),
        (b"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 0 9'><rect width='1' height='1'/></svg>".to_vec(), "zero size"),
        (svg("<use href='#a'/>"), "no element `#a`"),
        (svg("<g id='a'><use href='#a'/></g>"), "`#a` uses itself"),
        (svg("<g id='a'><use xlink:href='#b'/></g><g id='b'><use xlink:href='#a'/></g>"), "uses itself"),
        (svg("<symbol id='a'><use href='#a'/></symbol><use href='#a'/>"), "`#a` uses itself"),
        (svg(&format!("<g id='a0'><rect width='1' height='1'/></g>{bomb}")), "elements are drawn"),
        (svg("<use href='other.svg#a'/>"), "names another file"),
        (svg("<use href='file:///etc/passwd#a'/>"), "names another file"),
        (svg("<image href='../photo.png' width='9' height='9'/>"), "shows an image"),
        (svg("<image href='data:image/png;base64,AAAA' width='9' height='9'/>"), "shows an image"),
        (svg("<text>Surefoot</text>"), "it has letters"),
        (svg("<foreignObject/>"), "no SVG"),
        (svg("<mask id='m'/><rect width='1' height='1' mask='url(#m)'/>"), "a mask"),
        (svg("<rect width='1' height='1' clip-path='url(other.svg#k)'/>"), "names another file"),
        (svg("<clipPath id='k'><rect width='1' height='1' clip-path='url(#k)'/></clipPath><rect width='1' height='1' clip-path='url(#k)'/>"), "uses itself"),
        (svg("<path d='M0 0H1e300V1e300Z'/>"), "too far away"),
        (svg(&format!("{}<rect width='1' height='1'/>{}", "<g>".repeat(20_000), "</g>".repeat(20_000))), "deep"),
        (svg(&"<g/>".repeat(30_000)), "elements are drawn"),
        (svg(&"<!---->".repeat(300_000)), "nodes"),
        (svg(&format!("<clipPath id='k'><path d='M0 0{}'/></clipPath>{clips}<rect width='9' height='9'/>{}", "h1v1".repeat(300), "</g>".repeat(90))), "more than 40000 curves"),
        (svg(&format!("<style>{}</style><rect width='1' height='1'/>", "a{fill:red}".repeat(2000))), "rules of style"),
        (doctype(&format!("<!ENTITY e0 \"ha\">{laughs}"), "<title>&e9;</title>"), "no XML"),
        (doctype("<!ENTITY a \"&b;\"><!ENTITY b \"&a;\">", "<title>&a;</title>"), "no XML"),
        (doctype("<!ENTITY a SYSTEM \"file:///etc/passwd\">", "<title>&a;</title>"), "no XML"),
        (vec![b' '; 9 << 20], "larger than"),
    ];
    let named = |(file, words)| ("scene = svg(\"it.svg\").extrude(1)".to_owned(), ("it.svg", file), "1:13", words);
    let mut all: Vec<Wrong> = rows.into_iter().map(named).collect();
    all.push(("scene = svg(\"none.svg\").extrude(1)".to_owned(), ("it.svg", Vec::new()), "1:13", "can't be read"));
    all.push(("scene = svg(\"it.svg\", size: -1).extrude(1)".to_owned(), ("it.svg", Vec::new()), "1:29", "above zero"));
    all.push(("scene = svg(3).extrude(1)".to_owned(), ("it.svg", Vec::new()), "1:13", "a text is needed"));
    all
}

fn shaders() -> Vec<Wrong> {
    let rows = [
        ("it.glsl", "float map(vec3 p) {\n  while (true) { p *= 0.5; }\n  return p.x;\n}", "it.glsl:2", ""),
        ("it.glsl", "float f(float x);\nfloat f(float x) { return f(x); }\nfloat map(vec3 p) { return f(p.x); }", "it.glsl", ""),
        ("it.glsl", "float map(vec3 p) {\n  return texture(iChannel0, p.xy).x;\n}", "it.glsl:2", "no textures"),
        ("it.glsl", "float map(vec3 p) {\n  return fwidth(p.x);\n}", "it.glsl:2", "pixels beside"),
        // The hash of PCG, and one by the bits of a number: the language has no bits.
        ("it.glsl", "uint pcg(uint v) {\n  uint s = v * 747796405u + 2891336453u;\n  return s ^ (s >> 16u);\n}\nfloat map(vec3 p) { return float(pcg(uint(p.x))); }", "it.glsl:2", "too large"),
        ("it.glsl", "float map(vec3 p) {\n  return float(floatBitsToUint(p.x));\n}", "it.glsl:2", "bits of a number"),
        ("it.wgsl", "fn map(p: vec3f) -> f32 {\n  return map(p);\n}", "it.wgsl", ""),
        ("it.wgsl", "fn map(p: vec3f) -> f32 {\n  return p.x +;\n}", "it.wgsl:2", ""),
        ("it.wgsl", "fn map(p: vec3f) -> f32 {\n  loop { }\n  return 1.0;\n}", "it.wgsl", ""),
        ("it.wgsl", "@group(0) @binding(0) var t: texture_2d<f32>;\nfn map(p: vec3f) -> f32 {\n  return textureLoad(t, vec2i(p.xy), 0).x;\n}", "it.wgsl", ""),
    ];
    let named = |(file, text, place, words): (&'static str, &str, &'static str, &'static str)| (format!("scene = shader(\"{file}\", map)"), (file, text.as_bytes().to_vec()), place, words);
    let mut all: Vec<Wrong> = rows.into_iter().map(named).collect();
    all.push(("scene = shader(\"none.glsl\", map)".to_owned(), ("it.glsl", Vec::new()), "1", "none.glsl"));
    all.push(("scene = shader(\"it.txt\", map)".to_owned(), ("it.txt", Vec::new()), "1:16", "no shader by its name"));
    all
}

fn parts() -> Vec<Wrong> {
    let rows = [
        ("gears", "gear(0, 5)", "3:14", "the `teeth` of `gear` is 0"),
        ("gears", "gear(12, 5, module: 0)", "3:29", "the `module` of `gear` is 0"),
        ("gears", "gear(12, -5)", "3:18", "the `width` of `gear` is -5"),
        ("gears", "rack(0).extrude(1)", "3:14", "the `module` of `rack` is 0"),
        ("threads", "metric(0, 9)", "3:16", "the `d` of `metric` is 0"),
        ("threads", "metric(6, 0)", "3:19", "the `length` of `metric` is 0"),
        ("threads", "metric(6, 9, pitch: -1)", "3:29", "the `pitch` of `metric` is -1"),
        ("threads", "metric(6, 9, starts: 0)", "3:30", "the `starts` of `metric` is 0"),
        ("fasteners", "hex_screw(14, 30)", "3:19", "the `d` of `hex_screw` is 14"),
        ("fasteners", "nut(2)", "3:13", "the `d` of `nut` is 2"),
        ("fasteners", "sphere(across_flats(20))", "3:29", "the `d` of `across_flats` is 20"),
        ("profiles", "round_tube(0, 1).extrude(1)", "3:20", "the `d` of `round_tube` is 0"),
        ("fractals", "koch(1, -1).extrude(1)", "3:17", "the `level` of `koch` is -1"),
        ("none", "sphere(1)", "1:8", "std/none.sdf"),
    ];
    rows.into_iter().map(|(part, text, place, words)| (format!("import \"std/{part}.sdf\"\n\nscene = {text}"), ("none", Vec::new()), place, words)).collect()
}

#[test]
fn what_is_wrong_in_a_file_is_an_error_at_its_place() {
    let all = [fonts(), paths(), drawings(), shaders(), parts()].concat();
    assert!(all.len() >= 80, "{}", all.len());
    let mut wrong = Vec::new();
    for (text, (name, file), place, words) in all {
        let files = MemoryLoader::new().with("scene/main.sdf", text.as_str()).with(&format!("scene/{name}"), file);
        let watched = Watched { files, asked: RefCell::default() };
        let start = Instant::now();
        let outcome = compile(&watched, "scene/main.sdf", &Options::default());
        let took = start.elapsed();
        let place = if place.starts_with("it.") { format!("scene/{place}") } else { format!("scene/main.sdf:{place}") };
        let fits = outcome.diagnostics.iter().any(|d| {
            let (file, line, column) = outcome.sources.position(d.span.file, d.span.start);
            d.severity == Severity::Error && format!("{file}:{line}:{column}:").starts_with(&format!("{place}")) && d.message.contains(words) && !d.help.is_empty()
        });
        let shown: String = text.chars().take(120).collect();
        if !fits {
            wrong.push(format!("{shown}\n{place}: {words}\n{}", render(&outcome.sources, &outcome.diagnostics, false)));
        }
        if took > Duration::from_secs(20) {
            wrong.push(format!("{shown}: {words}: took {took:?}"));
        }
        // What the scene itself names, and what comes along; a font beside the folder was named by the scene.
        let mut asked = watched.asked.into_inner();
        asked.retain(|path| !path.starts_with("scene/") && !path.starts_with("std/") && path != "it.ttf");
        if !asked.is_empty() {
            wrong.push(format!("{shown}: {words}: asked for {asked:?}"));
        }
    }
    assert!(wrong.is_empty(), "{} are wrong:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn a_live_value_is_kept_within_what_a_part_has() {
    let text = "import \"std/fasteners.sdf\"\nparam d = 6 in 1..20\nscene = washer(d)";
    let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
    assert!(!outcome.has_errors(), "{}", render(&outcome.sources, &outcome.diagnostics, false));
    let said: Vec<&str> = outcome.diagnostics.iter().map(|d| d.message.as_str()).collect();
    assert!(said.iter().any(|words| words.contains("`d`")), "{said:?}");
}
