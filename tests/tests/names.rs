//! Names of modules stay what they are wherever a module is read, translated or written again: none ends in a digit or in `_`, and none holds `__`.

use crate::common::{Disk, examples, root};
use std::collections::BTreeSet;
use surefoot_compiler::compiled::{Compiled, Entry, Module, Uniforms};
use surefoot_compiler::emit::{Target, translate, validate};
use surefoot_compiler::{MemoryLoader, Options, compile};
use surefoot_tests::mutations::Random;
use surefoot_tests::programs::program;
use surefoot_tests::scenes::scene;

/// The identifiers of a text in WGSL, without those of its comments and numbers.
fn identifiers(wgsl: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for line in wgsl.lines() {
        let code = line.split("//").next().unwrap();
        for word in code.split(|c: char| !c.is_ascii_alphanumeric() && c != '_') {
            if word.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') {
                found.insert(word.to_owned());
            }
        }
    }
    found
}

/// Words of WGSL that end in a digit.
const OWN: [&str; 10] = ["f32", "u32", "i32", "vec2", "vec3", "vec4", "exp2", "log2", "atan2", "mat3x3"];

fn is_kept(name: &str) -> bool {
    !name.ends_with(|c: char| c.is_ascii_digit() || c == '_') && !name.contains("__")
}

/// The names of a module that are not kept.
fn wrong(module: &Module) -> Vec<String> {
    let texts = [module.wgsl.as_str(), module.code(), module.meshes.as_str()];
    let all: BTreeSet<String> = texts.into_iter().flat_map(identifiers).collect();
    let mut wrong: Vec<String> = all.into_iter().filter(|name| !is_kept(name) && !OWN.contains(&name.as_str())).collect();
    wrong.extend(module.uniforms.iter().map(|uniform| uniform.name.clone()).filter(|name| !is_kept(name)));
    wrong
}

/// What naga changed of the functions, structs and fields of a module in other languages.
fn changed(module: &Module, prefix: &str) -> Vec<String> {
    let (parsed, _) = validate(&module.wgsl).unwrap();
    let functions = parsed.functions.iter().filter_map(|(_, function)| function.name.clone());
    let types = parsed.types.iter().filter_map(|(_, ty)| ty.name.clone());
    let names: Vec<String> = functions.chain(types).collect();
    let mut changed = Vec::new();
    for target in [Target::Glsl, Target::Hlsl, Target::Msl] {
        let Ok(bytes) = translate(module, prefix, target) else { continue };
        let text = String::from_utf8(bytes).unwrap();
        let all = identifiers(&text);
        changed.extend(names.iter().filter(|name| !all.contains(*name)).map(|name| format!("{name} in {target:?}")));
        if target == Target::Glsl {
            changed.extend(all.into_iter().filter(|name| name.contains("__")));
        }
    }
    changed
}

fn compiled(path: &str, options: &Options) -> Compiled {
    compile(&Disk, path, options).compiled.unwrap_or_else(|| panic!("{path} does not compile"))
}

/// Scenes that are right: the corpus, and the examples.
fn paths() -> Vec<String> {
    let folder = root().join("tests/corpus/right");
    let right = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path().to_str().unwrap().to_owned());
    let mut paths: Vec<String> = right.filter(|path| path.ends_with(".sdf")).collect();
    paths.sort();
    paths.extend(examples().into_iter().map(|(_, path)| path));
    paths
}

#[test]
fn names_of_scenes_are_kept() {
    let mut seen = 0;
    for path in paths() {
        // What is no scene, but a part of one, is another test's.
        let Some(scene) = compile(&Disk, &path, &Options::default()).compiled else { continue };
        seen += 1;
        assert_eq!(wrong(&scene.module), Vec::<String>::new(), "{path}\n{}", scene.module.wgsl);
    }
    assert!(seen > 30, "{seen}");
}

#[test]
fn names_of_examples_are_the_same_in_every_language() {
    for (name, path) in examples() {
        let scene = compiled(&path, &Options::default());
        let options = Options { entry: Entry::Draw, uniforms: Uniforms::Separate, ..Options::default() };
        let drawn = compiled(&path, &options).module;
        assert_eq!(wrong(&drawn), Vec::<String>::new(), "{name}\n{}", drawn.wgsl);
        // Tables of grids have no text of their own.
        if !scene.module.needs_buffers {
            assert_eq!(changed(&scene.module, "sf_"), Vec::<String>::new(), "{name}");
        }
    }
}

#[test]
fn names_of_random_programs_are_kept() {
    let mut random = Random::new(7);
    // Few programs of the grammar are right; most scenes are.
    let programs = (0..200).map(|_| program(&mut random));
    let (mut texts, mut seen) = (programs.collect::<Vec<_>>(), 0);
    texts.extend((0..60).map(|seed| scene(seed).text()));
    for text in texts {
        let loader = MemoryLoader::new().with("main.sdf", text.clone());
        let Some(scene) = compile(&loader, "main.sdf", &Options::default()).compiled else { continue };
        seen += 1;
        assert_eq!(wrong(&scene.module), Vec::<String>::new(), "{text}\n{}", scene.module.wgsl);
    }
    assert!(seen > 40, "{seen}");
}

/// Names that a person may give and a module must not hold.
#[test]
fn names_that_are_not_kept_are_changed_and_stay_apart() {
    let text = "
        param size1 = 1 in 0.5..2
        param size1a = 1 in 0.5..2
        param a__b = 1 in 0.5..2
        param a_b = 1 in 0.5..2
        param q_ = 1 in 0.5..2
        field f2 = length(p) - size1 - 0.1 * perlin(3 * p)
        shape ball2 = f2.within(box(4))
        shape ball2a = sphere(size1a).twist(y, a__b)
        shape part_ = box(a_b, q_, 1)
        shape part__2 = box(a_b, 1, q_)
        scene = ball2 | ball2a.translate(2, 0, 0) | part_.translate(0, 2, 0) | part__2.translate(0, 0, 2)";
    let loader = MemoryLoader::new().with("main.sdf", text);
    for prefix in ["sf_", "", "blob"] {
        let options = Options { prefix: prefix.into(), ..Options::default() };
        let outcome = compile(&loader, "main.sdf", &options);
        let scene = outcome.compiled.unwrap_or_else(|| panic!("{:?}", outcome.diagnostics));
        assert_eq!(wrong(&scene.module), Vec::<String>::new(), "{}", scene.module.wgsl);
        // Without a prefix a name may be a word of another language.
        let changed = if prefix.is_empty() { Vec::new() } else { changed(&scene.module, prefix) };
        assert_eq!(changed, Vec::<String>::new(), "{}", scene.module.wgsl);
        let mut fields: Vec<&str> = scene.module.uniforms.iter().map(|uniform| uniform.name.as_str()).collect();
        let count = fields.len();
        fields.sort();
        fields.dedup();
        assert_eq!(fields.len(), count, "{}", scene.module.wgsl);
        assert!(count >= 6, "{fields:?}");
    }
}
