//! A sound bound passes its trial, a broken one does not, on either side.

use surefoot_compiler::certify::{Ball, Truth};
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::graph::Function;
use surefoot_compiler::verify::{Device, Fault, Report, Settings, Side, WORK, verify};
use surefoot_compiler::{Compiled, Live, MemoryLoader, Options, compile};

const SCENES: [&str; 4] = [
    "scene = box((2, 3, 0.2)).twist(y, 1)\n",
    "param rate = 0.5 in 0..1.5\nscene = box((1, 2, 1)).shear(x, y, rate) | sphere(0.4).translate(2, 0, 0)\n",
    "field wave = p.y - 0.3 * sin(3 * p.x + time) * cos(3 * p.z)\nscene = wave\n",
    "field f = p.x * p.x + 3 * p.y * p.y + p.z * p.z - 1\nscene = f.within(box(3))\n",
];

fn scene(text: &str) -> Compiled {
    let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
    outcome.compiled.unwrap_or_else(|| panic!("{text}: {:?}", outcome.diagnostics))
}

fn trial(scene: &Compiled, device: Option<Device>) -> Report {
    verify(scene, Settings { samples: 3000, certified: 30, seed: 1, work: WORK }, device, &|_| {}).unwrap()
}

/// Stands for a device: the bound in 64 bits, rounded to 32, times something.
fn device(scene: &Compiled, times: f32) -> impl Fn(&Live, &[[f32; 3]]) -> Result<Vec<f32>, String> {
    move |live, points| {
        let bound = scene.functions.formulas[&(scene.root, Function::Bound)];
        let tape = Tape::new(&scene.graph, &scene.functions.formulas, &[bound], live, 1_000_000).unwrap();
        let points: Vec<[f64; 3]> = points.iter().map(|p| p.map(f64::from)).collect();
        let mut bounds = Vec::new();
        tape.evaluator().at(&points, &[], |_, values| bounds.push(values[0] as f32 * times));
        Ok(bounds)
    }
}

#[test]
fn sound_scenes_pass() {
    for text in SCENES {
        let scene = scene(text);
        let report = trial(&scene, None);
        assert_eq!(report.violations, [], "{text}");
        assert!(report.points >= 2900 && report.empty >= 25 && report.undecided <= 3, "{text}: {report:?}");
        assert_eq!(report.moments.len(), if text.contains("param") || text.contains("time") { 8 } else { 1 }, "{text}");
        let (p5, p50) = (report.tightness(5).unwrap(), report.tightness(50).unwrap());
        assert!(p5 > 0.0 && p5 <= p50 && p50 <= 1.0 + 1e-9, "{text}: {p5} {p50}");
        assert_eq!(report, trial(&scene, None), "the same seed gives the same report");
    }
}

#[test]
fn halved_factors_are_found_out() {
    for text in SCENES {
        let mut scene = scene(text);
        assert!(!scene.graph.factors.is_empty(), "{text}");
        for factor in &mut scene.graph.factors {
            factor.lipschitz /= 2.0;
        }
        let report = trial(&scene, None);
        assert!(!report.violations.is_empty(), "{text}");
        for violation in &report.violations {
            let Fault::Crossed(at) = violation.fault else { panic!("{violation:?}") };
            let away = (0..3).map(|i| (at[i] - violation.point[i]).powi(2)).sum::<f64>().sqrt();
            assert!(away <= violation.bound, "{violation:?} is {away} away");
            let live = &report.moments[violation.moment];
            let field = scene.functions.formulas[&(scene.root, Function::Field)];
            let tape = Tape::new(&scene.graph, &scene.functions.formulas, &[field], live, 1_000_000).unwrap();
            let mut there = 0.0;
            tape.evaluator().at(&[at], &[], |_, values| there = values[0]);
            assert!(there * violation.field < 0.0, "the field is {there} there: {violation:?}");
        }
    }
}

#[test]
fn a_device_is_held_to_the_same() {
    let scene = scene(SCENES[0]);
    let honest = device(&scene, 1.0);
    let report = trial(&scene, Some(&honest));
    assert_eq!(report.violations, []);
    let compared = report.device.unwrap();
    assert!(compared.points == report.points && compared.within == compared.points && compared.worst < 1.0, "{compared:?}");

    let wild = device(&scene, 3.0);
    let report = trial(&scene, Some(&wild));
    assert!(!report.violations.is_empty() && report.violations.iter().all(|v| v.side == Side::Device));
    assert!(report.device.unwrap().within < report.points);

    let broken = |_: &Live, points: &[[f32; 3]]| Ok(vec![f32::NAN; points.len()]);
    let report = trial(&scene, Some(&broken));
    assert_eq!(report.violations.len(), report.points);
    assert!(report.violations.iter().all(|v| v.fault == Fault::NotFinite));

    let absent = |_: &Live, _: &[[f32; 3]]| Err("gone".to_owned());
    let report = verify(&scene, Settings { samples: 10, certified: 1, seed: 1, work: WORK }, Some(&absent), &|_| {});
    assert_eq!(report, Err("gone".to_owned()));
}

#[test]
fn a_jump_is_no_violation() {
    for text in [
        "field f = length((p.x - floor(p.x) - 0.5, p.y, p.z)) - 0.3 + 0.1 * floor(p.x)\nscene = f.within(box(3))\n",
        "field f = if p.x > 0.5 { length(p) - 1 } else { p.y - 0.3 * hash(floor(4 * p.x)) }\nscene = f.within(box(3))\n",
    ] {
        let scene = scene(text);
        let report = verify(&scene, Settings { samples: 30_000, certified: 300, seed: 2, work: WORK }, None, &|_| {}).unwrap();
        assert_eq!(report.violations, [], "{text}");
    }
}

#[test]
fn no_ball_across_a_jump_is_certified_to_be_empty() {
    for text in [
        "field f = if p.x > 0.5 { 1 + length(p) } else { -1 - length(p) }\nscene = f.within(box(3))\n",
        // The branches of the smaller one decide the condition too.
        "field f = { let m = min(p.x, 0.5); if p.x > m { 2 + p.y } else { p.y - 2 } }\nscene = f.within(box(3))\n",
        "field f = sign(p.x - 0.5) * (2 + p.y)\nscene = f.within(box(3))\n",
    ] {
        let scene = scene(text);
        let truth = Truth::new(&scene, &scene.live(), 1_000_000).unwrap();
        let mut prover = truth.prover();
        for radius in [0.1875, 0.25, 0.5] {
            assert_ne!(prover.empty_ball([0.625, 0.0, 0.0], radius, 10_000), Ball::Empty, "{text}: {radius}");
        }
        assert_eq!(prover.empty_ball([0.625, 0.0, 0.0], 0.0625, 10_000), Ball::Empty, "{text}");
    }
}
