//! Functions that people wrote for other programs: their values are those that naga gives them, and no ray steps through what they say.

use crate::common::{gpu, root};
use surefoot_compiler::by_hand::by_hand;
use surefoot_compiler::compiled::{Compiled, Export, Live};
use surefoot_compiler::random::Random;
use surefoot_compiler::shader::Language;
use surefoot_compiler::verify::{Settings, WORK, verify};
use surefoot_compiler::diagnostic::{self, Code, Diagnostic};
use surefoot_compiler::{MemoryLoader, Options, compile};
use surefoot_runtime::evaluate;

/// Points of each shader.
const POINTS: usize = 10_000;
/// The moment at which they are evaluated.
const TIME: f64 = 0.75;

/// The shaders of the corpus: names and texts.
fn shaders() -> Vec<(String, String)> {
    let folder = root().join("tests/corpus/shaders");
    let mut shaders: Vec<(String, String)> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read_to_string(&path).unwrap()))
        .collect();
    shaders.sort();
    shaders
}

fn scene(name: &str, text: &str) -> Compiled {
    compiled(name, text).0
}

/// The scene that is a shader's function, and what the compiler says of it.
fn compiled(name: &str, text: &str) -> (Compiled, Vec<Diagnostic>) {
    let main = format!("field it = shader(\"{name}\", map)\nscene = it\nrender {{ extent: 6 }}");
    let loader = MemoryLoader::new().with("main.sdf", main).with(name, text);
    let outcome = compile(&loader, "main.sdf", &Options::default());
    let said = || diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    (outcome.compiled.clone().unwrap_or_else(|| panic!("{name}: {}", said())), outcome.diagnostics.clone())
}

/// naga writes no case of a `switch` whose `break` stands between braces: it takes it to go on.
fn ended(statement: &mut naga::Statement) {
    if let naga::Statement::Switch { cases, .. } = statement {
        for case in cases.iter_mut().filter(|case| !case.body.is_empty()) {
            case.fall_through = false;
        }
    }
}

/// The shader as naga writes it, with a number in place of what is given from outside.
fn own(name: &str, text: &str) -> String {
    // What draws the picture is none of it, and naga writes no pointer to a component.
    let text = text.split("void mainImage").next().unwrap();
    let text = &text.replace("float c = pMod1(p.x, 1.6);", "float x = p.x; float c = pMod1(x, 1.6); p.x = x;");
    let text = match Language::of(name).unwrap() {
        Language::Wgsl => text.to_owned(),
        Language::Glsl => {
            let whole = format!("#version 450\n#define uniform layout(binding = 0) uniform\nuniform float iTime;\n{text}\nvoid main() {{}}");
            let mut module = naga::front::glsl::Frontend::default().parse(&naga::front::glsl::Options::from(naga::ShaderStage::Fragment), &whole).unwrap();
            for (_, function) in module.functions.iter_mut() {
                function.body.iter_mut().for_each(ended);
            }
            let flags = naga::valid::ValidationFlags::all() - naga::valid::ValidationFlags::BINDINGS;
            let info = naga::valid::Validator::new(flags, naga::valid::Capabilities::all()).validate(&module).unwrap();
            let written = naga::back::wgsl::write_string(&module, &info, naga::back::wgsl::WriterFlags::empty()).unwrap();
            written.split("@fragment").next().unwrap().to_owned()
        }
    };
    let mut own = String::new();
    for line in text.lines() {
        let (before, after) = line.split_once("var<uniform> ").unwrap_or((line, ""));
        match after.trim_end_matches(';').split_once(": ") {
            Some((name, "f32")) => own += &format!("const {name}: f32 = {TIME};\n"),
            Some((name, ty)) => own += &format!("const {name} = {ty}({TIME}, 0.0);\n"),
            None if before.trim() == "@group(0) @binding(0)" => {}
            None => own += &format!("{line}\n"),
        }
    }
    own
}

#[test]
fn values_are_those_of_the_shader() {
    let gpu = gpu();
    let mut random = Random(11);
    let plain = {
        let outcome = compile(&MemoryLoader::new().with("main.sdf", "scene = sphere(1)"), "main.sdf", &Options::default());
        outcome.compiled.unwrap()
    };
    let all = shaders();
    assert!(all.len() >= 30);
    println!("shader: the largest error, over the distance that a place may be off by 1e-5 of its scale");
    let mut wrong = Vec::new();
    for (name, text) in all {
        let ours = scene(&name, &text);
        // The shader's function stands in the place of a sphere's.
        let mut theirs = plain.clone();
        let result = if text.contains("vec4 map(") || text.contains("vec2 map(") || text.contains("-> vec2f {\n    var all") { ".x" } else { "" };
        let field = format!("{}\nfn sf_field(p: vec3f) -> f32 {{\n    return map(p){result};\n}}\n\nfn sf_field_of_a_sphere(p: vec3f) -> f32 {{", own(&name, &text));
        theirs.module.wgsl = theirs.module.wgsl.replacen("fn sf_field(p: vec3f) -> f32 {", &field, 1);
        let points: Vec<[f32; 3]> = (0..POINTS).map(|_| [0; 3].map(|_| (4.0 * random.next() - 2.0) as f32)).collect();
        let live = Live { time: TIME, ..ours.live() };
        let got = evaluate(&gpu, &ours, &live, [0.0; 3], Export::Field, &points).unwrap();
        let meant = evaluate(&gpu, &theirs, &theirs.live(), [0.0; 3], Export::Field, &points).unwrap_or_else(|why| panic!("{name}: {why}\n{}", theirs.module.wgsl));
        let scale = 2.0 * 3f64.sqrt();
        let errors = got.iter().zip(&meant).map(|(a, b)| (f64::from(*a) - f64::from(*b)).abs() / (1e-5 * scale.max(f64::from(b.abs()))));
        let mut errors: Vec<f64> = errors.collect();
        errors.sort_by(f64::total_cmp);
        let (worst, off) = (errors[POINTS - 1], errors.iter().filter(|error| **error > 1.0).count());
        println!("{name:24} {worst:10.3} {off:6} of {POINTS} are farther off");
        if off * 1000 > POINTS {
            wrong.push(format!("{name}: {off} of {POINTS}, the worst by {worst}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn no_ray_steps_through_a_shader() {
    let mut wrong = Vec::new();
    for (name, text) in shaders() {
        let (scene, said) = compiled(&name, &text);
        let settings = Settings { samples: 1000, certified: 0, seed: 7, work: WORK };
        let report = verify(&scene, settings, None, &|_| {}).unwrap();
        // What has no proven bound is marked so wherever it is shown, and then `verify` may find what is wrong with it.
        let is_unproven = said.iter().any(|said| said.code == Code::Unproven);
        println!("{name:24} {} violations{}", report.violations.len(), if is_unproven { ", unproven" } else { "" });
        if !report.violations.is_empty() && !is_unproven {
            wrong.push(format!("{name}: {:?}", report.violations.first()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn steps_by_hand_leave_holes_and_proven_ones_none() {
    let (mut holed, mut wrong) = (Vec::new(), Vec::new());
    for (name, text) in shaders() {
        let (scene, said) = compiled(&name, &text);
        let live = scene.live();
        let holes = |share: f64| by_hand(&scene, &said, &live, share, (96, 72)).unwrap();
        let whole = holes(1.0);
        let proven = whole.proven.map(|share| (share, holes(share).holes.len()));
        println!("{name:24} {:5} of {:5} rays pass by the whole value; by what is proven {proven:.3?}", whole.holes.len(), whole.rays);
        if whole.holes.len() > 10 {
            holed.push(name.clone());
        }
        if let Some((_, 1..)) = proven {
            wrong.push(name);
        }
    }
    assert!(holed.len() >= 5, "{holed:?}");
    assert!(wrong.is_empty(), "{wrong:?}");
}
