//! What the GPU computes at a point is what the CPU computes there in 64 bits.

use crate::common::{compile_file, examples, gpu, prelude};
use surefoot_compiler::compiled::{Compiled, Export, Live};
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::graph::Function;
use surefoot_compiler::random::Random;
use surefoot_runtime::{Gpu, evaluate};

/// Points of each scene.
const POINTS: usize = 10_000;
/// The function at its points, 64 bits; near the surface as many as anywhere.
const FUNCTIONS: [(Export, Function); 3] = [
    (Export::Field, Function::Field),
    (Export::Bound, Function::Bound),
    (Export::Distance, Function::Distance),
];

fn narrow(p: [f64; 3]) -> [f32; 3] {
    p.map(|c| c as f32)
}

fn wide(p: [f32; 3]) -> [f64; 3] {
    p.map(f64::from)
}

fn length(p: [f64; 3]) -> f64 {
    p.iter().map(|c| c * c).sum::<f64>().sqrt()
}

fn tape(compiled: &Compiled, live: &Live, functions: &[Function]) -> Option<Tape> {
    let roots: Option<Vec<_>> = functions
        .iter()
        .map(|f| compiled.functions.formulas.get(&(compiled.root, *f)).copied())
        .collect();
    Tape::new(&compiled.graph, &compiled.functions.formulas, &roots?, live, 4_000_000).ok()
}

/// Points about what the camera looks at, exact in 32 bits; half of them walked toward the surface.
fn points(compiled: &Compiled, live: &Live, random: &mut Random) -> (Vec<[f32; 3]>, f64) {
    let camera = compiled.frame(live).cameras[0].1;
    let size = length([0, 1, 2].map(|i| camera.eye[i] - camera.target[i]));
    let mut points: Vec<[f64; 3]> = (0..POINTS)
        .map(|_| camera.target.map(|c| c + size * (2.0 * random.next() - 1.0)))
        .collect();
    let bound = tape(compiled, live, &[Function::Bound]).unwrap();
    let mut evaluator = bound.evaluator();
    let near = &mut points[..POINTS / 2];
    for _ in 0..24 {
        let mut steps = vec![0.0; near.len()];
        evaluator.at(near, &[], |i, values| steps[i] = values[0].abs().min(size));
        for (p, step) in near.iter_mut().zip(steps) {
            let down = [camera.target[0] - p[0], camera.target[1] - p[1], camera.target[2] - p[2]];
            let far = length(down).max(1e-9);
            *p = [0, 1, 2].map(|i| p[i] + 0.9 * step * down[i] / far);
        }
    }
    points.retain(|p| length(*p) < compiled.blocks.extent);
    (points.into_iter().map(narrow).collect(), size)
}

/// Shares of the errors that are at most 1, and the error that 99 of 100 do not exceed.
fn share(mut errors: Vec<f64>) -> (f64, f64) {
    errors.sort_by(f64::total_cmp);
    let within = errors.iter().filter(|e| **e <= 1.0).count() as f64 / errors.len() as f64;
    (within, errors[errors.len() * 99 / 100])
}

/// Angles between the gradients' directions, as multiples of a milliradian. On the surface itself the gradient of a square root has no
/// digits left in 32 bits, and coincident surfaces have two: it is looked at a hair beside it, as a ray does that hits.
fn normals(
    gpu: &Gpu,
    compiled: &Compiled,
    live: &Live,
    points: &[[f32; 3]],
    exact: &[[f64; 3]],
    allowed: &[f64],
) -> Vec<f64> {
    let [x, y, z] = [0, 1, 2].map(Function::Gradient);
    let tape = tape(compiled, live, &[x, y, z, Function::Field]).unwrap();
    let got = evaluate(gpu, compiled, live, [0.0; 3], Export::Gradient, points).unwrap();
    let mut errors = Vec::new();
    tape.evaluator().at(exact, &[], |i, values| {
        let a = [0, 1, 2].map(|k| f64::from(got[4 * i + k]));
        let b = [values[0], values[1], values[2]];
        if values[3].abs() > allowed[i] {
            let off = [0, 1, 2].map(|k| a[k] / length(a).max(1e-9) - b[k] / length(b).max(1e-9));
            errors.push(length(off) / 1e-3);
        }
    });
    errors
}

#[test]
fn the_gpu_computes_what_the_cpu_computes() {
    let gpu = gpu();
    let mut wrong = Vec::new();
    println!(
        "on {}: share of {POINTS} points within 1e-5·(|p| + size), and p99 of the error as a multiple of that",
        gpu.name()
    );
    println!(
        "{:14} {:>6} {:>18} {:>18} {:>18} {:>18}",
        "scene", "live", "field", "bound", "distance", "normal, mrad"
    );
    for (name, path) in examples() {
        let compiled = match compile_file(&path) {
            Ok(compiled) => compiled,
            Err(words) => {
                wrong.push(format!("{name} does not compile:\n{words}"));
                continue;
            }
        };
        let mut random = Random(7);
        let mut live = compiled.live();
        for round in ["start", "random"] {
            if round == "random" {
                live.time = f64::from((10.0 * random.next()) as f32);
                for (value, p) in live.components.iter_mut().zip(&compiled.graph.parameters) {
                    *value = p.min + (p.max - p.min) * random.next();
                }
            }
            let (points, size) = points(&compiled, &live, &mut random);
            let exact: Vec<[f64; 3]> = points.iter().map(|p| wide(*p)).collect();
            let allowed: Vec<f64> = exact.iter().map(|p| 1e-5 * (length(*p) + size)).collect();
            let mut row = format!("{name:14} {round:>6}");
            let mut judge = |what: &str, errors: Vec<f64>, least: f64| {
                if errors.iter().any(|e| !e.is_finite()) {
                    wrong.push(format!("{name}, {round}: {what} is not finite somewhere"));
                    return;
                }
                let (within, p99) = share(errors);
                row += &format!(" {:7.2} % {p99:8.2}", 100.0 * within);
                if within < least {
                    wrong.push(format!("{name}, {round}: {what} within {:.2} %", 100.0 * within));
                }
            };
            for (export, function) in FUNCTIONS {
                let tape = tape(&compiled, &live, &[function]).unwrap();
                let got = evaluate(&gpu, &compiled, &live, [0.0; 3], export, &points).unwrap();
                let mut errors = vec![0.0; got.len()];
                // The bound of a union of many is that of a cell's list, which may be less.
                let may_be_less = function == Function::Bound && compiled.module.tables.is_some();
                tape.evaluator().at(&exact, &[], |i, values| {
                    let off = f64::from(got[i]) - values[0];
                    errors[i] = if may_be_less { off.max(0.0) } else { off.abs() } / allowed[i];
                });
                judge(export.name(), errors, 0.99);
            }
            judge("normal", normals(&gpu, &compiled, &live, &points, &exact, &allowed), 0.99);
            println!("{row}");
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Every answer of the GPU is one that the accuracy table of WGSL allows, and 99 of 100 are within 1e-5·(|p| + size).
#[test]
fn the_gpu_computes_the_prelude_as_the_cpu_does() {
    let gpu = gpu();
    // Modules have no more than what is asked here: drivers in software take long over the rest.
    let mut scenes = prelude(&FUNCTIONS.map(|(export, _)| export));
    // A union of many has another bound: that of the cell's list, no farther than the cell's side.
    scenes.retain(|(_, compiled)| compiled.module.tables.is_none());
    assert!(scenes.len() > 100, "only {} examples", scenes.len());
    println!("on {}, {} examples at {POINTS} points", gpu.name(), scenes.len());
    println!("{:24} {:>9} {:>12} {:>9} {:>12}", "item", "function", "within 1e-5", "p99", "worst/table");
    let mut wrong = Vec::new();
    for (name, compiled) in &scenes {
        let live = compiled.live();
        let (points, size) = points(compiled, &live, &mut Random(11));
        let exact: Vec<[f64; 3]> = points.iter().map(|p| wide(*p)).collect();
        for (export, function) in FUNCTIONS {
            let tape = tape(compiled, &live, &[function]).unwrap();
            let got = evaluate(&gpu, compiled, &live, [0.0; 3], export, &points).unwrap();
            let mut errors = vec![0.0; got.len()];
            // How much of what the table allows on its side is used, at most.
            let mut used = 0.0f64;
            tape.evaluator().at(&exact, &[], |i, values| {
                let (got, right) = (f64::from(got[i]), values[0]);
                errors[i] = (got - right).abs() / (1e-5 * (length(exact[i]) + size));
                let allowed = tape.conforming(points[i])[0];
                let side = if got > right { allowed.hi - right } else { right - allowed.lo };
                let share = if got == right { 0.0 } else { (got - right).abs() / side };
                if !allowed.contains(got) && used <= 1.0 {
                    wrong.push(format!("{name}: {} is {got} at {:?}, not {right} within {allowed:?}", export.name(), points[i]));
                }
                used = used.max(share);
            });
            let (within, p99) = share(errors);
            if within < 0.99 {
                wrong.push(format!("{name}: {} within {:.2} %", export.name(), 100.0 * within));
            }
            println!("{name:24} {:>9} {:10.2} % {p99:9.4} {used:12.4}", export.name(), 100.0 * within);
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
