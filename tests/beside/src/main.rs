//! Writes `docs/side-by-side.md`: the factors of Surefoot beside those of the crate `alice-sdf`, on the operations that both have.
//!
//! `cargo run --manifest-path tests/beside/Cargo.toml docs/side-by-side.md`

use alice_sdf::SdfNode;
use alice_sdf::eval::eval;
use alice_sdf::interval::eval_lipschitz;
use glam::{Quat, Vec3};
use std::fmt::Write;
use surefoot_compiler::certify::Truth;
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::graph::Function;
use surefoot_compiler::graph::interval::Interval;
use surefoot_compiler::random::Random;
use surefoot_compiler::verify::{Settings, WORK, verify};
use surefoot_compiler::{Compiled, MemoryLoader, Options, compile};

/// Points at which a bound is tried.
const POINTS: usize = 20_000;
/// How many of ours are certified.
const CERTIFIED: usize = 200;
/// Directions along which a sign change is looked for, and at which parts of the bound.
const DIRECTIONS: usize = 8;
const PARTS: [f64; 4] = [0.3, 0.6, 0.9, 0.995];
/// Boxes that a certified supremum may cost.
const BOXES: usize = 60_000;
/// Boxes that a factor may cost in the background.
const LONG: usize = 131_072;
/// Points at which slopes are sampled.
const SLOPES: usize = 200_000;

/// An operation of both.
struct Row {
    name: &'static str,
    /// The scene of Surefoot.
    ours: &'static str,
    theirs: SdfNode,
    /// Their formula in Surefoot's language, where it is not the one that ours stands for.
    formula: Option<&'static str>,
    /// Half the cube about the origin in which points are tried and slopes looked for.
    half: f64,
}

fn rows() -> Vec<Row> {
    let ball = || SdfNode::sphere(0.8);
    let cube = || SdfNode::box3d(1.0, 1.0, 1.0);
    let aside = || SdfNode::sphere(0.5).translate(0.5, 0.3, 0.0);
    let row = |name, ours, theirs, half| Row { name, ours, theirs, formula: None, half };
    let with = |formula, row: Row| Row { formula: Some(formula), ..row };
    vec![
        row("union", "box(1) | sphere(0.5).translate(0.5, 0.3, 0)", cube().union(aside()), 1.5),
        row("ellipsoid 1 : 2 : 10", "ellipsoid((0.2, 0.4, 2))", SdfNode::ellipsoid(0.2, 0.4, 2.0), 2.4),
        row("smooth union", "smooth_union(box(1), sphere(0.5).translate(0.5, 0.3, 0), 0.3)", cube().smooth_union(aside(), 0.3), 1.5),
        row("smooth difference", "smooth_difference(box(1), sphere(0.5).translate(0.5, 0.3, 0), 0.3)", cube().smooth_subtract(aside(), 0.3), 1.5),
        with(
            "field f = min(min(box(1).at(p), sphere(0.5).at(p - (0.5, 0.3, 0))), (box(1).at(p) + sphere(0.5).at(p - (0.5, 0.3, 0))) / sqrt(2) - 0.2)",
            row("chamfer", "chamfer_union(box(1), sphere(0.5).translate(0.5, 0.3, 0), 0.28)", cube().chamfer_union(aside(), 0.2), 1.5),
        ),
        row("stairs", "stairs_union(box(1), sphere(0.5).translate(0.5, 0.3, 0), 0.3, 4)", cube().stairs_union(aside(), 0.3, 4.0), 1.5),
        row("xor", "xor(box(1), sphere(0.5).translate(0.5, 0.3, 0))", cube().xor(aside()), 1.5),
        row("mix", "mix(sphere(0.8), box(1), 0.4)", ball().morph(cube(), 0.4), 1.5),
        row("round", "box(1).round(0.1)", cube().round(0.1), 1.5),
        row("shell", "box(1).shell(0.1)", cube().onion(0.05), 1.5),
        row("turn", "box((1, 0.4, 1)).rotate(z, 30deg)", SdfNode::box3d(1.0, 0.4, 1.0).rotate(Quat::from_rotation_z(0.523_598_8)), 1.5),
        row("scale along one axis", "box(0.6).stretch((1, 3, 1))", SdfNode::box3d(0.6, 0.6, 0.6).scale_xyz(1.0, 3.0, 1.0), 1.5),
        row("shear, rate 1", "box(1).shear(y, x, 1)", cube().shear(1.0, 0.0, 0.0), 1.5),
        row("twist, rate 1", "box((1.4, 2, 0.6)).twist(y, 1)", SdfNode::box3d(1.4, 2.0, 0.6).twist(1.0), 1.5),
        row("twist, rate 4", "box((1.4, 2, 0.6)).twist(y, 4)", SdfNode::box3d(1.4, 2.0, 0.6).twist(4.0), 1.5),
        row("twist of a smooth union", "smooth_union(box(1), sphere(0.5).translate(0.5, 0.3, 0), 0.3).twist(y, 2)", cube().smooth_union(aside(), 0.3).twist(2.0), 1.5),
        row("bend, rate 0.5", "box((2, 0.4, 0.6)).bend(x, y, 0.5)", SdfNode::box3d(2.0, 0.4, 0.6).bend(0.5), 1.8),
        row("bend, rate 1.5", "box((2, 0.4, 0.6)).bend(x, y, 1.5)", SdfNode::box3d(2.0, 0.4, 0.6).bend(1.5), 1.8),
        with(
            "field f = cylinder(0.6, 1.2).at((p.x / (1 - 0.5 * p.y), p.y, p.z / (1 - 0.5 * p.y)))",
            row("taper", "cylinder(0.6, 1.2).taper(y, -0.6, 0.6, 0.54).scale(1.3)", SdfNode::cylinder(0.6, 1.2).taper(0.5), 1.2),
        ),
        row("waves on a ball", "sphere(0.8).displace(-0.08 * sin(5 * p.x) * sin(5 * p.y) * sin(5 * p.z))", ball().displacement(0.08), 1.2),
        row("steep waves on a ball", "sphere(0.8).displace(-0.05 * sin(20 * p.x) * sin(20 * p.y) * sin(20 * p.z))", ball().sine_displacement(0.05, 20.0), 1.2),
        row("gyroid", "gyroid(2.0943951, 0.06).within(sphere(1))", SdfNode::gyroid(3.0, 0.06).intersection(SdfNode::sphere(1.0)), 1.2),
        row("repetition, symmetric", "sphere(0.3).repeat(1)", SdfNode::sphere(0.3).repeat_infinite(1.0, 1.0, 1.0), 3.0),
        row("repetition, off centre", "sphere(0.3).translate(0.2, 0.1, 0).repeat(1)", SdfNode::sphere(0.3).translate(0.2, 0.1, 0.0).repeat_infinite(1.0, 1.0, 1.0), 3.0),
        row("repetition about an axis", "box((0.8, 0.3, 0.15)).translate(0.9, 0, 0.1).repeat_polar(y, 7)", SdfNode::box3d(0.8, 0.3, 0.15).translate(0.9, 0.0, 0.1).polar_repeat(7), 1.8),
        row("a drawing made solid", "regular_polygon(5, 0.8).extrude(0.6).rotate(x, 90deg)", SdfNode::regular_polygon(0.8, 5, 0.6), 1.4),
        row("a wire in turns", "circle(0.15).sweep_helix(0.7, 0.6, 3)", SdfNode::helix(0.7, 0.15, 0.6, 1.8), 1.5),
    ]
}

/// What is found of a side.
struct Found {
    /// The factor that is claimed; infinite where none is.
    claimed: f64,
    /// The same after a search in the background.
    tightened: f64,
    /// The largest slope that was found, and the certified supremum of all.
    steepest: (f64, Option<f64>),
    /// Points from which the surface is nearer than is claimed.
    violations: usize,
}

fn scene(text: &str) -> Compiled {
    let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
    let said = surefoot_compiler::diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    outcome.compiled.unwrap_or_else(|| panic!("{text}\n{said}"))
}

/// How steep a scene is somewhere in a cube about the origin, and how steep at most; none where it jumps there.
fn supremum(compiled: &Compiled, half: f64) -> Option<(f64, Option<f64>)> {
    let truth = Truth::new(compiled, &compiled.live(), 1_000_000).ok()?;
    let found = truth.prover().steepest([Interval::new(-half, half); 3], 1.02, BOXES);
    (!found.jump && found.at_most.is_finite()).then_some((found.at_least, Some(found.at_most)))
}

/// Fields of a scene at points.
fn fields(compiled: &Compiled, points: &[[f64; 3]]) -> Vec<f64> {
    let root = compiled.functions.formulas[&(compiled.root, Function::Field)];
    let tape = Tape::new(&compiled.graph, &compiled.functions.formulas, &[root], &compiled.live(), 1_000_000).expect("it is no larger than that");
    let mut values = Vec::new();
    tape.evaluator().at(points, &[], |_, value| values.push(value[0]));
    values
}

fn ours(row: &Row) -> (Found, Compiled) {
    let compiled = scene(&format!("scene = {}\n", row.ours));
    let settings = Settings { samples: POINTS, certified: CERTIFIED, seed: 1, work: WORK };
    let report = verify(&compiled, settings, None, &|_| {}).expect("it is small enough");
    let tightened = (0..compiled.graph.factors.len()).map(|i| compiled.tighten(i, LONG)).fold(1.0, f64::max);
    let found = Found {
        claimed: compiled.summary.factor,
        tightened,
        steepest: supremum(&compiled, row.half).unwrap_or((f64::NAN, None)),
        violations: report.violations.len(),
    };
    (found, compiled)
}

fn along(p: [f64; 3], d: [f64; 3], t: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| p[i] + t * d[i])
}

fn theirs(row: &Row, ours: &Compiled) -> (Found, bool) {
    let at = |p: [f64; 3]| f64::from(eval(&row.theirs, Vec3::from_array(p.map(|c| c as f32))));
    let claimed = f64::from(eval_lipschitz(&row.theirs));
    // What their tracers step by: the value over the factor, or the value where there is none.
    let factor = if claimed.is_finite() { claimed.max(1.0) } else { 1.0 };
    let mut random = Random(1);
    let mut violations = 0;
    for _ in 0..POINTS {
        let p = random.within(row.half);
        let (value, mut crossed) = (at(p), false);
        for _ in 0..DIRECTIONS {
            let d = random.direction();
            // A value of single precision next to zero says nothing.
            crossed |= PARTS.iter().map(|part| at(along(p, d, part * value.abs() / factor))).any(|v| v * value < 0.0 && v.abs() > 1e-4);
        }
        violations += usize::from(crossed);
    }
    let formula = row.formula.map(|text| scene(&format!("{text}\nscene = f\n")));
    let same = formula.as_ref().unwrap_or(ours);
    let points: Vec<[f64; 3]> = (0..1000).map(|_| random.within(row.half)).collect();
    let agree = fields(same, &points).iter().zip(&points).filter(|(value, p)| (*value - at(**p)).abs() <= 2e-4 * (1.0 + value.abs())).count();
    let certified = if agree == points.len() { supremum(same, row.half) } else { None };
    let mut sampled: f64 = 0.0;
    for _ in 0..if certified.is_none() { SLOPES } else { 0 } {
        let p = random.within(row.half);
        let slope = [0, 1, 2].map(|i| {
            let mut unit = [0.0; 3];
            unit[i] = 1.0;
            (at(along(p, unit, 2e-3)) - at(along(p, unit, -2e-3))) / 4e-3
        });
        sampled = sampled.max(slope.iter().map(|s| s * s).sum::<f64>().sqrt());
    }
    let steepest = certified.unwrap_or((sampled, None));
    (Found { claimed, tightened: claimed, steepest, violations }, agree == points.len())
}

fn number(value: f64) -> String {
    if value.is_infinite() { "∞".to_owned() } else if value.is_nan() { "it jumps".to_owned() } else { format!("{value:.3}") }
}

fn steepest(found: &Found) -> String {
    match found.steepest {
        (least, None) if least.is_nan() => number(least),
        (least, None) => format!("≥ {}", number(least)),
        (least, Some(most)) if most <= 1.02 * least => number(most),
        (least, Some(most)) => format!("{} to {}", number(least), number(most)),
    }
}

fn main() {
    let mut page = format!(
        "# Side by side with alice-sdf\n\n\
         Written by `cargo run --manifest-path tests/beside/Cargo.toml docs/side-by-side.md`, with `alice-sdf` 6.1.0.\n\n\
         *Claimed* is the factor by which a field is divided for a ray's step: theirs is `eval_lipschitz` of the whole tree, ours the largest in the scene, which \
         holds only where that operand is near; *later* is what the window has after a search in the background. *Steepest* is the supremum of the slopes of the \
         field in the cube in which points were tried (half its side under *half*), certified to lie between two numbers, or one where they are within 2 % of each \
         other; where the fields are not the same formula (\\*), or it jumps, theirs is the steepest of {SLOPES} samples, after ≥. A twist or a \
         bend is steeper the farther one goes, and ours claims its factor only near the solid, so ours may be the smaller there. \
         *Violations* are points of {POINTS} from which the surface is nearer than the step: a change of sign along {DIRECTIONS} directions; of ours {CERTIFIED} are \
         certified too. Where they claim none (∞) their tracers take the value as it is, and so does this table.\n\n\
         | operation | half | claimed: theirs | ours | ours later | steepest: theirs | ours | violations: theirs | ours |\n|---|---|---|---|---|---|---|---|---|\n"
    );
    for row in rows() {
        let (mine, compiled) = ours(&row);
        let (other, agree) = theirs(&row, &compiled);
        let line = format!(
            "| {}{} | {} | {} | {} | {} | {} | {} | {} | {} |",
            row.name,
            if agree { "" } else { " \\*" },
            row.half,
            number(other.claimed),
            number(mine.claimed),
            number(mine.tightened),
            steepest(&other),
            steepest(&mine),
            other.violations,
            mine.violations
        );
        eprintln!("{line}");
        let _ = writeln!(page, "{line}");
    }
    match std::env::args().nth(1) {
        Some(file) => std::fs::write(&file, page).unwrap_or_else(|e| panic!("{file}: {e}")),
        None => print!("{page}"),
    }
}
