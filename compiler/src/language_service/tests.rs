//! Small texts with a caret, `|`, and what the service says there. `~` separates files: `name.sdf~text`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]

use super::*;
use crate::analysis::analysis_cache::Memory;
use crate::source::{FileId, Span};
use crate::MemoryLoader;
use std::time::Instant;

const PARTS: &str = "//! Parts of a scene.\n/// A column.\nfield column(height: float, width = 1) = max(abs(p.y) - height, length(p.xz) - width)\nparam flutes = 3 in 1..9 \"how many\"\nmaterial stone { color: #808080 }\n";

struct Case {
    loader: MemoryLoader,
    world: World,
    file: FileId,
    caret: usize,
}

/// The scene of a text with a caret, beside `parts.sdf`.
fn case(text: &str) -> Case {
    let caret = text.find('§').expect("a caret");
    let text = text.replace('§', "");
    let loader = MemoryLoader::new().with("main.sdf", text).with("parts.sdf", PARTS);
    let world = World::read(&loader, &["main.sdf", "parts.sdf"]);
    let file = world.file("main.sdf").unwrap();
    Case { loader, world, file, caret }
}

impl Case {
    fn complete(&self) -> Vec<Completion> {
        complete(&self.world, &self.loader, self.file, self.caret, &["main.sdf", "parts.sdf", "sub/more.sdf"])
    }

    fn labels(&self) -> Vec<String> {
        self.complete().into_iter().map(|c| c.label).collect()
    }
}

#[test]
fn completion_knows_its_place() {
    // What is there, and what is not.
    let cases: &[(&str, &str, &str)] = &[
        // At the top: words of declarations.
        ("§", "scene param material import", "sphere for"),
        ("scene = sphere(1)\nma§", "material scene", "sphere p"),
        // After a dot: what takes the shape first.
        ("scene = sphere(1).§", "translate twist material smooth_union shell low_corner", "sphere pi clamp sin extrude"),
        ("scene = sphere(1).tr§anslate(1, 0, 0)", "translate", "sphere"),
        ("scene = box(1).translate(1, 0, 0).§\ncamera { fov: 30deg }", "rotate scale", "extrude revolve"),
        ("scene = circle(1).§", "extrude revolve rotate", "twist sphere"),
        ("field f = length(p.§) - 1\nscene = f", "x y z", "w box extrude"),
        ("field2 f = length(p.§) - 1\nscene = f.extrude(1)", "x y", "z w"),
        ("let a = [1, 2]\nscene = sphere(a.§)", "count", "x twist"),
        ("import \"parts.sdf\" as parts\nscene = parts.§", "column flutes stone", "sphere main"),
        ("import \"parts.sdf\" as parts\nscene = sphere(1).parts.§", "column", "sphere"),
        // In values: names of the place, the file, the imports and the language.
        ("import \"parts.sdf\"\nparam size = 1\nfield f(width: float) = { let inner = 2; wi§ }\nscene = f(1)", "width inner size column flutes sphere p sin for", "import camera normal"),
        ("field f(width: float) = { let inner = 2; 1 }\nfield g(other) = §\nscene = f(1)", "other", "width inner"),
        ("scene = for copy in 0..3 { § }", "copy sphere", "import"),
        ("scene = for copy in 0..3 { sphere(1).translate(§", "copy v:", "import"),
        ("material m { color: mix(#fff, #000, §) }\nscene = sphere(1)", "normal p world a: t:", "import"),
        // The names of arguments that are not given yet.
        ("scene = torus(§)", "major: minor:", "radius:"),
        ("scene = torus(major: 1, §)", "minor:", "major:"),
        ("scene = box(1).twist(§", "axis: rate:", "s:"),
        ("scene = torus(major: §)", "pi", "minor: major:"),
        ("import \"parts.sdf\" as q\nscene = q.column(§)", "height: width:", ""),
        // Keys and their values.
        ("camera { § }\nscene = sphere(1)", "eye target fov", "color sphere"),
        ("camera { eye: (1, 2, 3), § }\nscene = sphere(1)", "eye target fov", "color sphere"),
        ("light sun { shadow: §", "none hard map sphere", "direction"),
        ("render { tone: §, fog: (#fff, 1) }", "aces agx neutral", "fog"),
        ("material m(a: float) { §", "color roughness let", "eye sphere"),
        ("mesh statue \"a.obj\" { §", "translate scale", "eye"),
        // Types.
        ("field f(a: §) = 1", "float vec3 shape", "sphere a"),
        ("param a: § = 1", "float int color", "sphere"),
        ("shape f(a: [§]) = 1", "shape float", "sphere"),
        // Paths.
        ("import \"§\"", "parts.sdf sub/more.sdf", "main.sdf sphere"),
        ("import \"§", "parts.sdf", "sphere"),
        // Nothing within comments, numbers and texts.
        ("// sph§\nscene = sphere(1)", "", "sphere scene"),
        ("scene = sphere(1§)", "", "sphere scene"),
        // Broken texts.
        ("scene = (sphere(1) | box(1).§ & \nparam a = 1", "translate", "sphere"),
        ("scene = )))) sphere(1).§", "translate", ""),
        ("scene = { let a = sphere(1); a.§", "translate", "sphere"),
    ];
    for (text, present, absent) in cases {
        let labels = case(text).labels();
        let has = |name: &&str| labels.iter().any(|label| label == name || label.trim_end_matches(':') == name.trim_end_matches(':') && !name.ends_with(':'));
        let missing: Vec<&str> = present.split(' ').filter(|name| !name.is_empty() && !has(name)).collect();
        let extra: Vec<&str> = absent.split(' ').filter(|name| !name.is_empty() && labels.iter().any(|label| label == name)).collect();
        assert!(missing.is_empty() && extra.is_empty(), "{text}\nmissing {missing:?}, too many {extra:?} of {labels:?}");
    }
}

#[test]
fn a_completion_says_what_it_is() {
    let found = case("scene = sphere(1).twi§").complete();
    let twist = found.iter().find(|c| c.label == "twist").unwrap();
    assert_eq!(twist.signature, "warp twist(axis: vec3, rate: float)");
    assert_eq!(twist.snippet.as_deref(), Some("twist(${1:axis}, ${2:rate})"));
    assert_eq!(twist.kind, CompletionKind::Name(Meaning::Warp));
    assert!(twist.text.contains("Requires") == false && twist.text.contains("```sdf"), "{}", twist.text);
    assert_eq!((twist.span.start, twist.span.end), (18, 21));
    let found = case("import \"pa§rts.sdf\"\n").complete();
    assert_eq!((found[0].span.start, found[0].span.end), (8, 17));
}

#[test]
fn signatures_follow_the_argument() {
    let cases: &[(&str, Option<(&str, Option<&str>)>)] = &[
        ("scene = torus(§", Some(("field torus(major: float, minor: float)", Some("major: float")))),
        ("scene = torus(1, §)", Some(("field torus(major: float, minor: float)", Some("minor: float")))),
        ("scene = torus(minor: §)", Some(("field torus(major: float, minor: float)", Some("minor: float")))),
        ("scene = box(1).twist(y, §)", Some(("warp twist(axis: vec3, rate: float)", Some("rate: float")))),
        ("scene = torus(max(1, §), 2)", Some(("max(a, b)", Some("b")))),
        ("scene = torus((1 + §), 2)", Some(("field torus(major: float, minor: float)", Some("major: float")))),
        ("import \"parts.sdf\" as q\nscene = q.column(1, §)", Some(("field column(height: float, width = 1)", Some("width = 1")))),
        ("fn f(a, b = 2) = a + b\nscene = sphere(f(1, §))", Some(("fn f(a, b = 2)", Some("b = 2")))),
        ("fn f(a, §b) = 1", None),
        ("scene = unknown(§)", None),
        ("scene = sphere(1)§", None),
        ("scene = { sphere(1) § }", None),
    ];
    for (text, expected) in cases {
        let at = case(text);
        let help = signature_help(&at.world, at.file, at.caret);
        let found = help.as_ref().map(|help| {
            let signature = &help.signatures[help.active];
            (signature.label.as_str(), signature.active.map(|active| &signature.label[signature.parameters[active].clone()]))
        });
        assert_eq!(found, *expected, "{text}");
    }
}

#[test]
fn hover_says_type_range_and_meaning() {
    let cases: &[(&str, &[&str])] = &[
        ("param siz§e = 1 in 0.5..2 \"how large\"\nscene = sphere(size)", &["param size = 1 in 0.5..2", "how large"]),
        ("param size = 1 in 0.5..2 \"how large\"\nscene = sphere(siz§e)", &["param size = 1 in 0.5..2", "how large"]),
        ("let a = (1, 2, 3)\nscene = box(§a)", &["let a: vec3"]),
        ("scene = sph§ere(1)", &["field sphere(radius: float)", "```sdf"]),
        ("scene = box(1).twis§t(y, 1)", &["warp twist(axis: vec3, rate: float)"]),
        ("field f = leng§th(p) - 1\nscene = f", &["length(v) → float", "GLSL"]),
        ("field f = length(§p) - 1\nscene = f", &["p: vec3", "own space"]),
        ("field f = p.xz§.x\nscene = f", &["xz: vec2"]),
        ("/// Doubles it.\nfn twice(t: float) = 2 * t\nscene = sphere(twi§ce(1))", &["fn twice(t: float) → float", "Doubles it."]),
        ("field f(r: float = 2) = length(p) - r§\nscene = f", &["parameter r: float = 2"]),
        ("field f = { let q = p.xz; length(q§) }\nscene = f", &["let q: vec2"]),
        ("camera { fo§v: 30deg }\nscene = sphere(1)", &["camera { fov }", "vertical angle"]),
        ("material m { rough§ness: 1 }\nscene = sphere(1)", &["material { roughness }", "matte"]),
        ("import \"par§ts.sdf\"\nscene = column(1)", &["Parts of a scene."]),
        ("import \"parts.sdf\" as q\nscene = q.colu§mn(1)", &["field column(height: float, width = 1)", "A column.", "Declared in `parts.sdf`"]),
        ("scene = torus(maj§or: 1, minor: 0.2)", &["parameter major: float"]),
        ("sce§ne = sphere(1)", &["scene = sphere(1)"]),
        ("let c = #d4af§37\nscene = sphere(1)", &["#d4af37", "212, 175, 55"]),
        ("scene = for cel§l in grid((2, 0, 2)) { sphere(cell.x) }", &["let cell: vec3"]),
    ];
    for (text, expected) in cases {
        let at = case(text);
        let said = hover(&at.world, &[], at.file, at.caret).map(|hover| hover.markdown()).unwrap_or_default();
        for words in *expected {
            assert!(said.contains(words), "{text}\n{words} is not in\n{said}");
        }
    }
    for text in ["scene = sphere(§1)", "// sp§here\n", "scene §= sphere(1)"] {
        let at = case(text);
        assert_eq!(hover(&at.world, &[], at.file, at.caret), None, "{text}");
    }
}

/// Every key has words, or the reference lacks them.
#[test]
fn every_word_of_the_language_is_documented() {
    use crate::syntax::ast::BlockKind::*;
    let mut missing = Vec::new();
    for kind in [None, Some(Camera), Some(Light), Some(Environment), Some(Render), Some(Physics), Some(Balls), Some(Mesh)] {
        let keys = kind.map_or(&crate::program::material::KEYS[..], crate::program::blocks::keys);
        missing.extend(keys.iter().filter(|key| manual::of_key(kind, key).is_none()).map(|key| format!("{kind:?} {key}")));
    }
    let functions = crate::program::builtin::FUNCTIONS.iter().filter(|name| !crate::program::builtin::OF_PRELUDE.contains(name));
    missing.extend(functions.filter(|name| manual::of_function(name).is_none()).map(|name| (*name).to_owned()));
    missing.extend(crate::program::builtin::NAMES.iter().filter(|name| manual::of_value(name).is_none()).map(|name| (*name).to_owned()));
    let keywords = crate::syntax::words::DECLARATIONS.iter().chain(crate::syntax::words::EXPRESSIONS).filter(|word| !matches!(**word, "true" | "false"));
    missing.extend(keywords.filter(|word| manual::of_keyword(word).is_none_or(|text| text.is_empty())).map(|word| (*word).to_owned()));
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn definitions_are_where_names_are_declared() {
    let cases: &[(&str, &[&str])] = &[
        ("param size = 1\nscene = sphere(si§ze)", &["main.sdf:1:7"]),
        ("import \"parts.sdf\"\nscene = colu§mn(1)", &["parts.sdf:3:7"]),
        ("import \"parts.sdf\" as q\nscene = q.colu§mn(1)", &["parts.sdf:3:7"]),
        ("import \"parts.sdf\" as q\nscene = §q.column(1)", &["main.sdf:1:23"]),
        ("import \"par§ts.sdf\" as q\nscene = q.column(1)", &["parts.sdf:1:1"]),
        ("import \"parts.sdf\" as q\nscene = q.column(hei§ght: 1)", &["parts.sdf:3:14"]),
        ("import \"parts.sdf\" as q\nscene = sphere(1).q.colu§mn(1)", &["parts.sdf:3:7"]),
        ("field f(r) = { let r = 2 * r; length(p) - r§ }\nscene = f(1)", &["main.sdf:1:20"]),
        ("field f(r) = { let r = 2 * §r; length(p) - r }\nscene = f(1)", &["main.sdf:1:9"]),
        ("let r = 1\nscene = for r in 0..2 { sphere(§r) }", &["main.sdf:2:13"]),
        ("let r = 1\nscene = for i in 0..r§ { sphere(i) }", &["main.sdf:1:5"]),
        ("let sphere = box(1)\nscene = spher§e", &["main.sdf:1:5"]),
        ("scene = box(1).§translate(1, 0, 0)\nlet p = 1", &["<prelude>/placement.sdf:"]),
        ("scene = sphere(§1)", &[]),
        ("field f = si§n(p.x)\nscene = f", &[]),
        ("scene = nowher§e", &[]),
    ];
    for (text, expected) in cases {
        let at = case(text);
        let found: Vec<String> = definition(&at.world, at.file, at.caret)
            .iter()
            .map(|d| {
                let (path, line, column) = at.world.texts.sources.position(d.name.file, d.name.start);
                format!("{path}:{line}:{column}")
            })
            .collect();
        let same = found.len() == expected.len() && found.iter().zip(*expected).all(|(a, b)| a.starts_with(b));
        assert!(same, "{text}: {found:?}");
    }
}

#[test]
fn a_name_is_renamed_wherever_it_stands() {
    let cases: &[(&str, &str, Result<&str, &str>)] = &[
        ("param si§ze = 1\nscene = sphere(size) | box(size)", "width", Ok("param width = 1\nscene = sphere(width) | box(width)")),
        // The names of arguments go with the parameter.
        ("field f(r§) = length(p) - r\nscene = f(r: 1) | f(2)", "radius", Ok("field f(radius) = length(p) - radius\nscene = f(radius: 1) | f(2)")),
        // Names that hide it are others.
        ("let a§ = 1\nfield f = { let a = 2; length(p) - a }\nscene = f.scale(a)", "b", Ok("let b = 1\nfield f = { let a = 2; length(p) - a }\nscene = f.scale(b)")),
        ("let a = 1\nfield f = { let a§ = 2; length(p) - a }\nscene = f.scale(a)", "b", Ok("let a = 1\nfield f = { let b = 2; length(p) - b }\nscene = f.scale(a)")),
        ("scene = { let q§ = 1, s = 2 for i in 0..3 { q = q * 2, s = s + q }; sphere(q + s) }", "r", Ok("scene = { let r = 1, s = 2 for i in 0..3 { r = r * 2, s = s + r }; sphere(r + s) }")),
        ("import \"parts.sdf\" as q§\nscene = q.column(1).material(q.stone)", "parts", Ok("import \"parts.sdf\" as parts\nscene = parts.column(1).material(parts.stone)")),
        ("scene = sphere(1).mine§(2)\nshape mine(s: shape, k: float) = s.scale(k)", "yours", Ok("scene = sphere(1).yours(2)\nshape yours(s: shape, k: float) = s.scale(k)")),
        // What can't be.
        ("param a§ = 1\nlet b = 2\nscene = sphere(a)", "b", Err("declared already")),
        ("import \"parts.sdf\"\nparam a§ = 1\nscene = sphere(a)", "column", Err("imported already")),
        ("param a§ = 1\nfield f(r) = length(p) - a * r\nscene = f(1)", "r", Err("something else")),
        ("param a = 1\nfield f(r§) = length(p) - a * r\nscene = f(1)", "a", Err("something else")),
        ("field f(r§, s) = length(p)\nscene = f(1, 2)", "s", Err("something else")),
        ("param a§ = 1\nscene = sphere(a)", "sphere", Err("something else")),
        ("param a§ = 1\nscene = sphere(a)", "scene", Err("word of the language")),
        ("param a§ = 1\nscene = sphere(a)", "1a", Err("no name")),
        ("param a§ = 1\nscene = sphere(a)", "", Err("no name")),
        ("scene = sphe§re(1)", "ball", Err("comes with the language")),
        ("scene = torus(maj§or: 1, minor: 2)", "big", Err("comes with the language")),
        ("field f = p.§x\nscene = f", "y", Err("component")),
        ("scene = now§here", "b", Err("nothing declares")),
        ("scene = sphere(1) §", "b", Err("no name here")),
    ];
    for (text, name, expected) in cases {
        let at = case(text);
        let done = rename(&at.world, &at.loader, at.file, at.caret, name).map(|edits| edited(at.world.text(at.file), at.file, &edits));
        match expected {
            Ok(wanted) => assert_eq!(done.as_deref(), Ok(*wanted), "{text}"),
            Err(words) => assert!(done.as_ref().is_err_and(|why| why.contains(words)), "{text}: {done:?}"),
        }
    }
}

fn edited(text: &str, file: FileId, edits: &[Edit]) -> String {
    let mut text = text.to_owned();
    let mut edits: Vec<&Edit> = edits.iter().filter(|edit| edit.span.file == file).collect();
    edits.sort_by_key(|edit| std::cmp::Reverse(edit.span.start));
    for edit in edits {
        text.replace_range(edit.span.range(), &edit.text);
    }
    text
}

#[test]
fn renaming_goes_over_files() {
    let at = case("import \"parts.sdf\"\nscene = colu§mn(1) | column(height: 2).material(stone)");
    let edits = rename(&at.world, &at.loader, at.file, at.caret, "pillar").unwrap();
    assert_eq!(edited(at.world.text(at.file), at.file, &edits), "import \"parts.sdf\"\nscene = pillar(1) | pillar(height: 2).material(stone)");
    let parts = at.world.file("parts.sdf").unwrap();
    assert_eq!(edited(PARTS, parts, &edits), PARTS.replace("field column", "field pillar"));
    // From the other file too.
    let same = rename(&at.world, &at.loader, parts, PARTS.find("column(").unwrap(), "pillar").unwrap();
    assert_eq!(same, edits);
}

#[test]
fn references_are_in_all_files() {
    let at = case("import \"parts.sdf\"\nscene = sphere(flu§tes).scale(flutes)");
    let found = references(&at.world, at.file, at.caret);
    assert_eq!(found.iter().map(|r| r.declares).collect::<Vec<_>>(), [false, false, true]);
    let at = case("scene = sph§ere(1) | sphere(2).translate(1, 0, 0)");
    assert_eq!(references(&at.world, at.file, at.caret).len(), 2);
}

#[test]
fn outlines_are_trees() {
    let at = case("import \"parts.sdf\" as q\nparam size = 1\nfield f(r: float) = { let a = r; a }\nmaterial m { color: #fff, roughness: 1 }\nscene = f(size)\ncamera top { fov: 30deg }§\n");
    let shown: Vec<String> = outline(&at.world, at.file)
        .iter()
        .map(|entry| format!("{} {} [{}]", entry.name, entry.detail, entry.within.iter().map(|w| w.name.as_str()).collect::<Vec<_>>().join(" ")))
        .collect();
    assert_eq!(shown, ["q import []", "size param = 1 []", "f (r: float) [a]", "m  [color roughness]", "scene  []", "top camera [fov]"]);
    let found: Vec<String> = workspace_outline(&at.world, "cLm").into_iter().map(|entry| entry.name).collect();
    assert_eq!(found, ["column"]);
    let folds = folds("//! a\n//! b\nimport \"a\"\nimport \"b\" as c\n\nscene = (\n  sphere(1)\n)\n/* x\n*/\n", FileId(0));
    assert_eq!(folds.iter().map(|f| (f.span.start, f.span.end, f.is_comment, f.is_imports)).collect::<Vec<_>>(), [(0, 11, true, false), (12, 38, false, true), (48, 63, false, false), (64, 71, true, false)]);
}

#[test]
fn names_are_painted_by_their_meaning() {
    let at = case("import \"parts.sdf\" as q\nparam size = 1\nmaterial m { color: #fff }\nfield f(r: float) = { let a = r; length(p.xz) - a }\nscene = f(size).twist(y, 1).material(m) | q.column(1)§\n");
    let text = at.world.text(at.file);
    let painted: Vec<(&str, Meaning)> = paint(&at.world, at.file).into_iter().filter_map(|token| Some((&text[token.range], token.meaning?))).collect();
    use Meaning::*;
    let expected = [
        ("\"parts.sdf\"", Path), ("q", Import), ("size", Slider), ("m", Material), ("color", Key), ("f", Field), ("r", Parameter), ("a", Local), ("r", Parameter),
        ("length", Function), ("p", Value), ("xz", Component), ("a", Local), ("f", Field), ("size", Slider), ("twist", Warp), ("y", Value), ("material", Function),
        ("m", Material), ("q", Import), ("column", Field),
    ];
    assert_eq!(painted, expected);
    let classes: Vec<_> = paint(&at.world, at.file).into_iter().map(|token| (token.range, token.class)).collect();
    assert_eq!(classes, crate::syntax::tokens(text));
}

#[test]
fn colours_are_found_and_written() {
    let text = "material m { color: #fa0, emission: #d4af37 } // #fff\n";
    let found = colors(text, FileId(0));
    let written: Vec<String> = found.iter().map(|color| written_color(color.rgb)).collect();
    assert_eq!(written, ["#ffaa00", "#d4af37"]);
    assert_eq!(written_color([f64::NAN, -1.0, 2.0]), "#0000ff");
}

#[test]
fn factors_and_names_of_arguments_are_hinted() {
    let text = "scene = box((1, 2, 1)).twist(y, 1) | torus(1, 0.3) | torus(major: 1, minor: 0.2)§\n";
    let at = case(text);
    let report = examine(&at.loader, "main.sdf", &mut Memory::default());
    assert!(report.is_whole && report.diagnostics.is_empty(), "{:?}", report.diagnostics);
    let found = hints(&at.world, &report.factors, at.file, 0..text.len());
    let shown: Vec<(usize, bool, &str)> = found.iter().map(|hint| (hint.offset, hint.is_argument, hint.label.as_str())).collect();
    let [(32, true, "rate:"), (34, false, factor), (43, true, "major:"), (46, true, "minor:")] = shown[..] else { panic!("{shown:?}") };
    assert!(factor.starts_with("×1."), "{factor}");
    let said = hover(&at.world, &report.factors, at.file, text.find("twist").unwrap()).unwrap().markdown();
    assert!(said.contains(&format!("**Factor {factor}**")) && said.contains("It costs about") && said.contains("Lower it with"), "{said}");
}

/// Every fix of every wrong program of the corpus ends what it mends, or the diagnostic would come back.
#[test]
fn a_fix_ends_its_diagnostic() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/corpus/wrong");
    let mut texts: Vec<String> = std::fs::read_dir(folder).unwrap().filter_map(|entry| std::fs::read_to_string(entry.unwrap().path()).ok()).collect();
    texts.sort();
    texts.extend(crate::diagnostic::CODES.iter().map(|row| row.program.to_owned()));
    texts.extend([
        "param a = 1\n/// A doc.\nparam unused = 2 // never\nscene = sphere(a)\n".to_owned(),
        "scene = sphere(1).translate(1 × 2, 0, 0)\n".to_owned(),
        "scene = box(1).rotate(y, 45 deg)\n".to_owned(),
        "scene = sphere(radius = 1)\n".to_owned(),
        "# a comment\nscene = sphere(1)\n".to_owned(),
        "param a = 1 in 2..0\nscene = sphere(a)\n".to_owned(),
        "secne = sphere(1)\n".to_owned(),
        "sun { direction: (0, -1, 0) }\nscene = sphere(1)\n".to_owned(),
    ]);
    let (mut tried, mut wrong) = (0, Vec::new());
    let look = |text: &str| {
        let loader = MemoryLoader::new().with("main.sdf", text).with("parts.sdf", PARTS);
        examine(&loader, "main.sdf", &mut Memory::default())
    };
    for text in texts {
        let report = look(&text);
        let Some(file) = report.file("main.sdf") else { continue };
        for action in actions(&report.diagnostics, Span::new(file, 0, text.len())) {
            tried += 1;
            let mended = edited(&text, file, &action.edits);
            let of = &report.diagnostics[action.mends];
            let same = |d: &&crate::diagnostic::Diagnostic| d.code == of.code && d.message == of.message;
            let (before, after) = (report.diagnostics.iter().filter(same).count(), look(&mended).diagnostics.iter().filter(same).count());
            if after >= before {
                wrong.push(format!("{:?}: {}\n{text}\n→\n{mended}", of.code, action.title));
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {tried}:\n{}", wrong.len(), wrong.join("\n\n"));
    assert!(tried > 40, "{tried}");
}

#[test]
fn positions_count_in_utf_16_both_ways() {
    let text = "a = \"ä𝄞b\"\r\nsecond\rthird\n";
    let lines = Lines::new(text);
    for (offset, _) in text.char_indices().chain([(text.len(), ' ')]) {
        let position = lines.position(offset);
        let within_end = text[..offset].ends_with('\r') && text[offset..].starts_with('\n');
        assert!(within_end || lines.offset(position) == offset, "{offset} {position:?}");
    }
    assert_eq!(lines.position(text.find('b').unwrap()), Position { line: 0, column: 8 });
    assert_eq!(lines.position(text.find("third").unwrap()), Position { line: 2, column: 0 });
    // Within a character, beyond a line, beyond the text.
    assert_eq!(lines.offset(Position { line: 0, column: 7 }), text.find('𝄞').unwrap());
    assert_eq!(lines.offset(Position { line: 1, column: 999 }), text.find("\rthird").unwrap());
    assert_eq!(lines.offset(Position { line: u32::MAX, column: u32::MAX }), text.len());
    assert_eq!(lines.position(usize::MAX), Position { line: 3, column: 0 });
}

/// Every answer at every byte of every example, cut off there too: none panics.
#[test]
fn no_text_and_no_place_is_too_odd() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/corpus/wrong");
    let mut texts: Vec<String> = std::fs::read_dir(folder).unwrap().filter_map(|entry| std::fs::read_to_string(entry.unwrap().path()).ok()).collect();
    texts.sort();
    texts.push(include_str!("../../../examples/still_life.sdf").to_owned());
    for (n, text) in texts.iter().enumerate() {
        let step = 1 + text.len() / 12;
        for cut in (n % step..=text.len()).step_by(step) {
            if !text.is_char_boundary(cut) {
                continue;
            }
            let part = &text[..cut];
            let loader = MemoryLoader::new().with("main.sdf", part);
            let world = World::read(&loader, &["main.sdf"]);
            let file = world.file("main.sdf").unwrap();
            for at in [cut, cut / 2, cut + 7] {
                complete(&world, &loader, file, at, &[]);
                signature_help(&world, file, at);
                hover(&world, &[], file, at);
                definition(&world, file, at);
                references(&world, file, at);
                let _ = rename(&world, &loader, file, at, "other");
            }
            outline(&world, file);
            folds(part, file);
            paint(&world, file);
            colors(part, file);
            hints(&world, &[], file, 0..cut);
        }
    }
    let deep = format!("scene = {}1{}", "(".repeat(20_000), ")".repeat(20_000));
    let loader = MemoryLoader::new().with("main.sdf", deep.as_str()).with("empty.sdf", "");
    let world = World::read(&loader, &["main.sdf", "nowhere.sdf", "empty.sdf"]);
    paint(&world, world.file("main.sdf").unwrap());
    assert!(world.file("nowhere.sdf").is_none());
    let empty = world.file("empty.sdf").unwrap();
    assert!(!complete(&world, &loader, empty, 0, &[]).is_empty());
    assert!(world.text(FileId(u32::MAX)).is_empty() && outline(&world, FileId(u32::MAX)).is_empty());
}

/// A scene of a thousand lines: each answer that needs no compilation within ten milliseconds; in a build without optimisation ten times that. The best of five
/// counts, because other programs run too.
#[test]
fn answers_are_quick() {
    let mut text = String::from("import \"parts.sdf\"\nparam size = 1 in 0.5..2\n");
    for i in 0..332 {
        text.push_str(&format!("/// Part {i}.\nfield part{i}(r: float, k = 0.2) = {{ let q = p.xz * {i}; length((q, p.y)) - r * k }}\nshape many{i} = part{i}(size).twist(y, 0.2).translate({i}, 0, 0)\n"));
    }
    text.push_str("scene = many1 | many2.scale(2).§\n");
    assert!(text.lines().count() > 990);
    let at = case(&text);
    let mut times: Vec<(&str, f64)> = Vec::new();
    let mut timed = |name: &'static str, run: &mut dyn FnMut()| {
        let best = (0..5).map(|_| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64() * 1e3
        });
        times.push((name, best.fold(f64::INFINITY, f64::min)));
    };
    let name = at.world.text(at.file).find("many1 |").unwrap();
    timed("read", &mut || drop(World::read(&at.loader, &["main.sdf"])));
    timed("complete", &mut || assert!(at.complete().len() > 30));
    timed("signature", &mut || drop(signature_help(&at.world, at.file, name)));
    timed("hover", &mut || assert!(hover(&at.world, &[], at.file, name).is_some()));
    timed("definition", &mut || assert_eq!(definition(&at.world, at.file, name).len(), 1));
    timed("references", &mut || assert_eq!(references(&at.world, at.file, name).len(), 2));
    timed("rename", &mut || assert_eq!(rename(&at.world, &at.loader, at.file, name, "other").unwrap().len(), 2));
    timed("outline", &mut || assert!(outline(&at.world, at.file).len() > 600));
    timed("paint", &mut || assert!(paint(&at.world, at.file).len() > 10_000));
    timed("hints", &mut || drop(hints(&at.world, &[], at.file, 0..1_000_000)));
    println!("milliseconds: {times:.1?}");
    let most = if cfg!(debug_assertions) { 100.0 } else { 10.0 };
    assert!(times.iter().all(|(_, time)| *time < most), "{times:?}");
}

/// The parts of a text that is given to the compiler, each with its depth: `0 scene`.
fn parts_of(text: &str) -> (World, Part) {
    let loader = MemoryLoader::new().with("main.sdf", text).with("parts.sdf", PARTS);
    let world = World::read(&loader, &["main.sdf"]);
    let root = parts(&world, world.file("main.sdf").unwrap()).unwrap();
    (world, root)
}

/// The text without some parts, spaces pressed together.
fn left(text: &str, hidden: &[&str], solo: Option<&str>) -> Result<String, String> {
    let (world, root) = parts_of(text);
    for id in hidden.iter().chain(&solo) {
        assert!(root.find(id).is_some(), "{id} is none of {:?}", root.all().iter().map(|(_, part)| &part.id).collect::<Vec<_>>());
    }
    let shown = Shown { hidden: hidden.iter().map(|id| (*id).to_owned()).collect(), solo: solo.map(str::to_owned) };
    let texts = without(&world, &root, &shown)?;
    let new = texts.get("main.sdf").cloned().unwrap_or_else(|| text.to_owned());
    assert_eq!(new.len(), text.len(), "all stays at its place");
    let lines = |text: &str| text.match_indices('\n').map(|(at, _)| at).collect::<Vec<_>>();
    assert_eq!(lines(&new), lines(text));
    let outcome = crate::compile(&MemoryLoader::new().with("main.sdf", new.as_str()).with("parts.sdf", PARTS), "main.sdf", &crate::Options::default());
    assert!(outcome.compiled.is_some(), "{new}: {:?}", outcome.diagnostics.first().map(|d| &d.message));
    Ok(new.split_whitespace().collect::<Vec<_>>().join(" "))
}

#[test]
fn parts_are_a_tree_and_can_be_left_out() {
    let text = "shape house = box(1) | sphere(1)\nscene = plane(y)\n  | (house - box(0.5)).translate(1, 0, 0)\n  | house.twist(y, 0.1)\n  | smooth_union(box(2), torus(1, 0.2) & box(3), 0.1)\n";
    let (_, root) = parts_of(text);
    let names: Vec<String> = root.all().iter().map(|(depth, part)| format!("{depth} {}{}", part.name, part.kind)).collect();
    let wanted = [
        "0 scene", "1 union", "2 plane", "2 difference .translate", "3 houseshape", "4 union", "5 box", "5 sphere", "3 box", "2 houseshape .twist", "4 union",
    ];
    assert!(names.starts_with(&wanted[..9].iter().map(|name| (*name).to_owned()).collect::<Vec<_>>()), "{names:?}");
    let union = "scene/union";
    let rest = "| (house - box(0.5)).translate(1, 0, 0) | house.twist(y, 0.1) | smooth_union(box(2), torus(1, 0.2) & box(3), 0.1)";
    let house = "shape house = box(1) | sphere(1)";
    let scene = |text: Result<String, String>| text.unwrap().strip_prefix(house).map(|text| text.trim().to_owned());
    let hide = |ids: &[&str]| scene(left(text, &ids.iter().map(|id| format!("{union}/{id}")).collect::<Vec<_>>().iter().map(String::as_str).collect::<Vec<_>>(), None));
    assert_eq!(hide(&[]).unwrap(), format!("scene = plane(y) {rest}"));
    assert_eq!(hide(&["plane"]).unwrap(), format!("scene = {}", &rest[2..]));
    assert_eq!(hide(&["difference/box"]).unwrap(), format!("scene = plane(y) {}", rest.replace("house - box(0.5)", "house ")).replace("house )", "house )"));
    assert_eq!(hide(&["difference/house", "smooth_union"]).unwrap(), "scene = plane(y) | house.twist(y, 0.1)", "nothing is left of the difference");
    assert_eq!(hide(&["smooth_union/box"]).unwrap(), format!("scene = plane(y) {}", rest.replace("smooth_union(box(2), torus(1, 0.2) & box(3), 0.1)", "( torus(1, 0.2) & box(3) )")));
    assert_eq!(hide(&["smooth_union/intersection/box"]).unwrap(), format!("scene = plane(y) {}", rest.replace("& box(3)", "")).replace("  ", " "));
    let within = left(text, &["scene/union/house/union/sphere"], None).unwrap();
    assert!(within.starts_with("shape house = box(1) scene = plane(y)"), "{within}");
    assert_eq!(scene(left(text, &[], Some("scene/union/smooth_union/intersection/torus"))).unwrap(), "scene = ( torus(1, 0.2) )");
    assert_eq!(scene(left(text, &[], Some("scene/union/difference/box"))).unwrap(), "scene = ( box(0.5)).translate(1, 0, 0)", "what is taken away is shown alone");
    assert!(left(text, &[union], None).is_err(), "nothing is left");
    assert!(left(text, &["scene/union/plane", "scene/union/difference", "scene/union/house", "scene/union/smooth_union"], None).is_err());
}

#[test]
fn parts_know_what_the_compiler_does() {
    let text = "shape house = box(1).twist(y, 1).translate(3, 0, 0)\nscene = sphere(0.5) | house\n";
    let (_, mut root) = parts_of(text);
    let outcome = crate::compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &crate::Options::default());
    let compiled = outcome.compiled.unwrap();
    let factors = crate::factors::explain(&compiled, &outcome.sources);
    tell(&mut root, &compiled, &outcome.sources, &factors);
    let part = |id: &str| root.find(id).unwrap();
    let (ball, house) = (part("scene/union/sphere"), part("scene/union/house"));
    assert_eq!(ball.factor, None);
    assert!(house.factor.is_some_and(|factor| factor > 1.05), "{house:?}");
    let [low, high] = ball.region.unwrap();
    assert!(low.iter().all(|c| (c + 0.5).abs() < 0.01) && high.iter().all(|c| (c - 0.5).abs() < 0.01), "{low:?} {high:?}");
    let [low, high] = house.region.unwrap();
    assert!(low[0] > 1.0 && high[0] < 5.0, "{low:?} {high:?}");
    assert!(part("scene/union").operations > ball.operations && house.operations > ball.operations, "{root:?}");
}
