//! What depends on parameters and time alone is computed by the host: no function of a module does it for every pixel. This is seen in the
//! graph that naga makes of the emitted text, which knows nothing of how the text came about.

use crate::common::Disk;
use naga::{BinaryOperator, Expression, Function, Handle, Module, Statement, UnaryOperator};
use std::path::{Path, PathBuf};
use surefoot_compiler::compiled::UniformSource;
use surefoot_compiler::{Compiled, MemoryLoader, Options, compile, emit};

/// What an expression is made of.
#[derive(Clone, Copy, PartialEq)]
enum Made {
    /// Numbers alone.
    Constant,
    /// Numbers, parameters and time.
    Live,
    /// Anything else.
    Varies,
}

fn together(parts: impl IntoIterator<Item = Made>) -> Made {
    parts.into_iter().fold(Made::Constant, |a, b| match (a, b) {
        (Made::Varies, _) | (_, Made::Varies) => Made::Varies,
        (Made::Constant, Made::Constant) => Made::Constant,
        _ => Made::Live,
    })
}

/// The operations of a function that need nothing but what is live, as text.
fn found(scene: &Compiled, module: &Module, function: &Function, out: &mut Vec<String>) {
    let field = |pointer: Handle<Expression>| {
        let mut at = pointer;
        while let Expression::AccessIndex { base, index } = function.expressions[at] {
            if let Expression::GlobalVariable(g) = function.expressions[base] {
                let uniform = module.global_variables[g].space == naga::AddressSpace::Uniform;
                return uniform.then(|| scene.module.uniforms[index as usize].source);
            }
            at = base;
        }
        None
    };
    let mut made: Vec<Made> = Vec::new();
    for (handle, expression) in function.expressions.iter() {
        let of = |h: Handle<Expression>| made[h.index()];
        let mut operation = false;
        let is = match expression {
            Expression::Literal(_) | Expression::Constant(_) | Expression::ZeroValue(_) => Made::Constant,
            Expression::Load { pointer } => match field(*pointer) {
                Some(UniformSource::Time | UniformSource::Parameter(_) | UniformSource::Formula(_)) => Made::Live,
                _ => Made::Varies,
            },
            Expression::Compose { components, .. } => together(components.iter().map(|c| of(*c))),
            Expression::Splat { value: base, .. }
            | Expression::Swizzle { vector: base, .. }
            | Expression::AccessIndex { base, .. }
            | Expression::Unary { op: UnaryOperator::Negate, expr: base } => of(*base),
            // Not of a condition is none of the work.
            Expression::Unary { op: UnaryOperator::LogicalNot, expr } => of(*expr),
            Expression::Unary { expr, .. } | Expression::As { expr, .. } => {
                operation = true;
                of(*expr)
            }
            Expression::Binary { op, left, right } => {
                use BinaryOperator as B;
                // A comparison is no dearer than reading what came of it, and a condition can't stand in a uniform block.
                operation = !matches!(op, B::Less | B::LessEqual | B::Greater | B::GreaterEqual | B::Equal | B::NotEqual);
                together([of(*left), of(*right)])
            }
            Expression::Select { condition, accept, reject } => {
                operation = true;
                together([of(*condition), of(*accept), of(*reject)])
            }
            Expression::Math { arg, arg1, arg2, arg3, .. } => {
                operation = true;
                together([Some(*arg), *arg1, *arg2, *arg3].into_iter().flatten().map(of))
            }
            _ => Made::Varies,
        };
        made.push(is);
        if operation && is == Made::Live {
            let span = function.expressions.get_span(handle).to_range();
            let text = span.and_then(|r| scene.module.wgsl.get(r)).unwrap_or("?");
            out.push(format!("{}: {text}", function.name.as_deref().unwrap_or("?")));
        }
    }
    calls(&function.body, &mut |called, arguments| {
        let live = together(arguments.iter().map(|a| made[a.index()])) == Made::Live;
        if live {
            let name = |f: &Function| f.name.clone().unwrap_or_default();
            out.push(format!("{}: calls {}", name(function), name(&module.functions[called])));
        }
    });
}

fn calls(block: &naga::Block, found: &mut dyn FnMut(Handle<Function>, &[Handle<Expression>])) {
    for statement in block {
        match statement {
            Statement::Call { function, arguments, .. } => found(*function, arguments),
            Statement::Block(inner) => calls(inner, found),
            Statement::If { accept, reject, .. } => [accept, reject].into_iter().for_each(|b| calls(b, found)),
            Statement::Switch { cases, .. } => cases.iter().for_each(|c| calls(&c.body, found)),
            Statement::Loop { body, continuing, .. } => [body, continuing].into_iter().for_each(|b| calls(b, found)),
            _ => {}
        }
    }
}

/// All of a scene's modules: the scene's own, with what draws meshes, and that of its ground.
fn per_pixel(scene: &Compiled) -> Vec<String> {
    let mut out = Vec::new();
    for scene in [scene, scene.ground()] {
        let text = format!("{}\n{}", scene.module.wgsl, scene.module.meshes);
        let (module, _) = emit::validate(&text).unwrap_or_else(|e| panic!("{e}"));
        for (_, function) in module.functions.iter() {
            found(scene, &module, function, &mut out);
        }
    }
    out
}

fn scenes(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder);
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().filter_map(|e| e.ok().map(|e| e.path())).collect();
    paths.retain(|p| p.extension().is_some_and(|e| e == "sdf"));
    paths.sort();
    paths
}

#[test]
fn no_function_computes_what_the_host_can() {
    let mut wrong = Vec::new();
    let mut computed = 0;
    let mut all = scenes("examples");
    all.extend(["right", "deformed", "sound", "large"].iter().flat_map(|f| scenes(&format!("tests/corpus/{f}"))));
    assert!(all.len() > 40, "{}", all.len());
    for path in all {
        let outcome = compile(&Disk, path.to_str().unwrap(), &Options::default());
        // Whether each compiles is another test's question.
        let Some(scene) = outcome.compiled else { continue };
        computed += scene.module.uniforms.iter().filter(|u| matches!(u.source, UniformSource::Formula(_))).count();
        let name = path.file_name().unwrap().to_string_lossy();
        wrong.extend(per_pixel(&scene).into_iter().map(|w| format!("{name}: {w}")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(computed > 40, "{computed}");
}

fn scene(text: &str, options: &Options) -> Compiled {
    let loader = MemoryLoader::new().with("main.sdf", text);
    let outcome = compile(&loader, "main.sdf", options);
    outcome.compiled.unwrap_or_else(|| panic!("{text}: {:?}", outcome.diagnostics))
}

const WAVES: &str = "
    param size = 1 in 0.5..2
    param on = true
    param tint = #d08040
    param shift = (1, 0, 0) in (-2, -2, -2)..(2, 2, 2)
    let swing = 0.5 * sin(2 * time + size)
    let high = if on && size > 1 { size * 2 } else { size / 3 }
    material m { color: 0.5 * tint + 0.1 * shift }
    scene = box(size, high, 1).rotate(y, swing).translate(2 * shift).material(m) | sphere(swing * swing + 0.1)
";

#[test]
fn what_is_computed_is_named_and_has_its_formula() {
    let built = scene(WAVES, &Options::default());
    assert_eq!(per_pixel(&built), Vec::<String>::new());
    let wgsl = &built.module.wgsl;
    let line = |part: &str| wgsl.lines().find(|l| l.contains(part)).unwrap_or_else(|| panic!("no {part} in\n{wgsl}"));
    assert!(line("part_a = 0.5 * sin(2 * time + size)").starts_with("//   "), "{wgsl}");
    assert!(line("  time ").contains(" - "), "time is read by formulas alone:\n{wgsl}");
    assert!(wgsl.contains("in which both(a, b) is: `a && b`"), "{wgsl}");
    // The bytes follow what is live.
    let mut live = built.live();
    let before = built.uniform_bytes(&live, [0.0; 3]);
    live.time = 0.25;
    let after = built.uniform_bytes(&live, [0.0; 3]);
    assert_ne!(before, after);
    live.components[0] = 2.0;
    assert_ne!(built.uniform_bytes(&live, [0.0; 3]), after);
}

#[test]
fn a_host_may_write_parameters_and_time_alone() {
    let options = Options { live_in_shader: true, ..Options::default() };
    let built = scene(WAVES, &options);
    let formula = |u: &surefoot_compiler::compiled::Uniform| matches!(u.source, UniformSource::Formula(_));
    assert!(!built.module.uniforms.iter().any(formula), "{}", built.module.wgsl);
    assert!(!per_pixel(&built).is_empty());
}
