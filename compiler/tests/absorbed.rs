//! Operands of intersections that cut nothing off: rays and light do without them, and the surface is the same.

use surefoot_compiler::certify::Truth;
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::graph::Function;
use surefoot_compiler::random::Random;
use surefoot_compiler::verify::{Settings, WORK, verify};
use surefoot_compiler::{Compiled, MemoryLoader, Options, compile};

fn scene(text: &str) -> Compiled {
    let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
    outcome.compiled.unwrap_or_else(|| panic!("{text}: {:?}", outcome.diagnostics))
}

/// What a function of the scene costs, calls opened.
fn steps(scene: &Compiled, function: Function) -> usize {
    let root = scene.functions.formulas[&(scene.root, function)];
    Tape::new(&scene.graph, &scene.functions.formulas, &[root], &scene.live(), 100_000).unwrap().operations()
}

/// With something that cuts nothing off, and without it.
const PAIRS: [(&str, &str); 5] = [
    ("scene = box(1) - sphere(0.3).translate(1, 0, 0)", "scene = box(1)"),
    ("param far = 2 in 1.5..4\nscene = torus(0.7, 0.2).rotate(x, 0.3) - sphere(0.3).translate(far, 0, 0)", "scene = torus(0.7, 0.2).rotate(x, 0.3)"),
    ("scene = (box((1, 2, 1)) & sphere(1.3)).rotate(x, 0.4)", "scene = box((1, 2, 1)).rotate(x, 0.4)"),
    ("scene = sphere(2) - (box(1) - capsule((1, 0, 0), (2, 1, 0), 0.3))", "scene = sphere(2) - box(1)"),
    (
        "scene = for i in 0..3 { (box(0.5) - sphere(0.2).translate(0, 1, 0)).translate(i, 0, 0) } | sphere(0.6).translate(0, 1, 0)",
        "scene = for i in 0..3 { box(0.5).translate(i, 0, 0) } | sphere(0.6).translate(0, 1, 0)",
    ),
];

#[test]
fn bound_and_distance_cost_what_they_do_without_and_the_field_stays() {
    for (text, without) in PAIRS {
        let (with, without) = (scene(text), scene(without));
        for function in [Function::Bound, Function::Distance] {
            assert_eq!(steps(&with, function), steps(&without, function), "{function:?} of {text}");
        }
        assert!(steps(&with, Function::Field) > steps(&without, Function::Field));
    }
}

#[test]
fn the_surface_is_the_same_and_no_bound_reaches_through_it() {
    for (with, without) in PAIRS {
        let scenes = [scene(with), scene(without)];
        let truths = scenes.each_ref().map(|s| Truth::new(s, &s.live(), 100_000).unwrap());
        let mut provers = truths.each_ref().map(Truth::prover);
        let mut random = Random(11);
        for _ in 0..300 {
            let at = random.within(3.0);
            let [a, b] = provers.each_mut().map(|prover| prover.value(at) > 0.0);
            assert_eq!(a, b, "{with} at {at:?}");
        }
        let report = verify(&scenes[0], Settings { samples: 3000, certified: 60, seed: 3, work: WORK }, None, &|_| {}).unwrap();
        assert!(report.violations.is_empty(), "{with}: {:?}", report.violations);
    }
}

/// What reaches the solid for a value of a slider or at some time, or of which a box can't tell, is looked at.
#[test]
fn what_may_cut_is_looked_at() {
    for (text, without) in [
        ("param far = 2 in 0..4\nscene = box(1) - sphere(0.3).translate(far, 0, 0)", "scene = box(1)"),
        ("scene = box(1) - sphere(0.3).translate(2 + 2 * sin(time), 0, 0)", "scene = box(1)"),
        ("scene = box(1) - sphere(0.3).translate(0.75, 0, 0)", "scene = box(1)"),
        ("scene = (box(1) - sphere(0.3).translate(0.6, 0.6, 0)) | plane(y, -1)", "scene = box(1) | plane(y, -1)"),
    ] {
        let (with, without) = (scene(text), scene(without));
        assert!(steps(&with, Function::Bound) > steps(&without, Function::Bound), "{text}");
    }
}
