//! Judges what the compiler makes of a scene: a bound without holes, or a diagnostic with a place.

use crate::clock::Stopwatch;
use crate::mutations::Random;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;
use surefoot_compiler::certify::{Ball, Claim, Truth, falsify};
use surefoot_compiler::diagnostic::{Code, Severity};
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::functions::Kind;
use surefoot_compiler::graph::{Function, NodeId};
use surefoot_compiler::{Compiled, Live, MemoryLoader, Options, Outcome, compile};

/// How carefully a scene is judged.
#[derive(Clone, Copy, Debug)]
pub struct Care {
    /// Points at which the bound is tried, over all rounds.
    pub points: usize,
    /// How many of them are certified: that no surface is in the ball of the bound.
    pub balls: usize,
    /// The longest that the compiler may take, of the processor's time.
    pub longest: Duration,
}

/// What became of a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// It is drawn, and nothing was found wrong.
    Proven(Tried),
    /// It is drawn with a mark that says what is not proven.
    Unproven,
    /// It is refused, and the first diagnostic that says so has this code.
    Refused(Code),
    /// Something is wrong.
    Wrong(Fault),
}

/// At how much nothing was found wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tried {
    /// Points from which a change of sign was looked for.
    pub points: usize,
    /// Balls that are certainly empty.
    pub empty: usize,
    /// Balls of which nothing is certain.
    pub undecided: usize,
}

/// What is wrong, and in words where.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Of which kind.
    pub kind: FaultKind,
    /// With numbers.
    pub words: String,
}

/// Kinds of what may be wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FaultKind {
    /// The field changes its sign within the bound.
    Hole,
    /// Field and bound have different signs.
    Sign,
    /// Something is solid beyond the box about the scene, or planes and the rest are not the whole.
    Ahead,
    /// A value is not a number, or infinite.
    NotFinite,
    /// Refused without a diagnostic, or one without a place in the text.
    NoDiagnostic,
    /// The compiler took too long.
    Slow,
    /// The compiler panicked.
    Panic,
}

/// Operations of a scene's tape.
const OPERATIONS: usize = 4_000_000;
/// Boxes that a factor for one setting may cost.
const FOLLOWED: usize = 64;
/// Boxes that a certified ball may cost, and steps of the field's code.
const BOXES: usize = 500;
const STEPS: usize = 200_000;
/// Half the side of the cube about the origin in which points are strewn.
const HALF: f64 = 4.0;
/// Directions in which each ball is searched, and at which parts of its radius.
const DIRECTIONS: usize = 8;
const PARTS: [f64; 4] = [0.3, 0.7, 0.95, 0.999];
/// A ray that stands before a jump steps across it by no more than this.
const HAIR: f64 = 1.1e-4;

/// Compiles a program and looks for what is wrong with what comes out; `seed` chooses the points.
pub fn check(text: &str, seed: u64, care: Care) -> Verdict {
    let loader = MemoryLoader::new().with("main.sdf", text);
    let watch = Stopwatch::start();
    let Ok(outcome) = catch_unwind(AssertUnwindSafe(|| compile(&loader, "main.sdf", &Options::default()))) else {
        return wrong(FaultKind::Panic, "the compiler panicked".to_owned());
    };
    let time = watch.time();
    if time > care.longest {
        return wrong(FaultKind::Slow, format!("{} ms", time.as_millis()));
    }
    match &outcome.compiled {
        None => said(&outcome, text, Severity::Error).map_or_else(Verdict::Wrong, Verdict::Refused),
        Some(scene) if scene.summary.kind == Kind::Unproven => {
            said(&outcome, text, Severity::Warning).map_or_else(Verdict::Wrong, |_| Verdict::Unproven)
        }
        Some(scene) => match catch_unwind(AssertUnwindSafe(|| try_bound(scene, seed, care))) {
            Ok(Ok(tried)) => Verdict::Proven(tried),
            Ok(Err(fault)) => Verdict::Wrong(fault),
            Err(_) => wrong(FaultKind::Panic, "evaluating panicked".to_owned()),
        },
    }
}

fn wrong(kind: FaultKind, words: String) -> Verdict {
    Verdict::Wrong(Fault { kind, words })
}

/// A scene that is refused or marked has a diagnostic of this severity, and each names a part of the text and says what helps.
/// Returns the code of the first.
fn said(outcome: &Outcome, text: &str, severity: Severity) -> Result<Code, Fault> {
    let fault = |words| Err(Fault { kind: FaultKind::NoDiagnostic, words });
    let all = || outcome.diagnostics.iter().filter(|d| d.severity == severity);
    let marks = || all().filter(|d| severity == Severity::Error || d.code == Code::Unproven);
    let Some(first) = marks().next() else { return fault("nothing says why".to_owned()) };
    for said in all() {
        let file = outcome.sources.iter().find(|(id, _)| *id == said.span.file).map(|(_, f)| f.name.to_string());
        let place = text.get(said.span.start as usize..said.span.end as usize).unwrap_or("");
        if file.as_deref() != Some("main.sdf") || place.trim().is_empty() || said.help.is_empty() {
            return fault(format!("{:?} at {:?} of {file:?}: {}", said.code, said.span, said.message));
        }
    }
    Ok(first.code)
}

/// Looks for a sign change of the field within the bound, at the start and at other values of what is live.
pub fn try_bound(scene: &Compiled, seed: u64, care: Care) -> Result<Tried, Fault> {
    let mut random = Random::new(seed);
    let live_at_all = scene.graph.parameters.len() + usize::from(scene.module.uniforms.iter().any(|u| u.name == "time"));
    let rounds = if live_at_all > 0 { 4 } else { 1 };
    let share = Care { points: care.points / rounds, balls: care.balls / rounds, ..care };
    let mut tried = Tried::default();
    for round in 0..rounds {
        let mut live = setting(scene, round, &mut random);
        // Half of the settings with the factors that follow the sliders.
        if round % 2 == 1 {
            scene.follow(&mut live, FOLLOWED);
        }
        let here = try_setting(scene, &live, share, &mut random)?;
        tried.points += here.points;
        tried.empty += here.empty;
        tried.undecided += here.undecided;
    }
    Ok(tried)
}

/// Values of what is live: the start, one end of each range, the other end or any, any.
fn setting(scene: &Compiled, round: usize, random: &mut Random) -> Live {
    let mut live = scene.live();
    if round > 0 {
        live.time = unit(random) * 20.0;
    }
    for (value, parameter) in live.components.iter_mut().zip(&scene.graph.parameters) {
        let any = parameter.min + (parameter.max - parameter.min) * unit(random);
        *value = match (round, random.below(3)) {
            (0, _) => *value,
            (1, 0) => parameter.min,
            (1, 1) => parameter.max,
            _ => any,
        };
    }
    live
}

fn try_setting(scene: &Compiled, live: &Live, care: Care, random: &mut Random) -> Result<Tried, Fault> {
    let fault = |kind, words| Err(Fault { kind, words });
    let [field, bound, distance] = [Function::Field, Function::Bound, Function::Distance].map(|f| scene.functions.formulas[&(scene.root, f)]);
    // What rays follow: planes, and the rest within its box.
    let ahead = scene.functions.ahead;
    let apart = ahead.planes.map(|p| [p.distance, p.rest_bound, p.rest_distance]);
    let roots: Vec<NodeId> = [field, bound, distance].into_iter().chain(apart.into_iter().flatten()).collect();
    let Ok(tape) = Tape::new(&scene.graph, &scene.functions.formulas, &roots, live, OPERATIONS) else { return Ok(Tried::default()) };
    let mut evaluator = tape.evaluator();
    let mut starts: Vec<[f64; 3]> = (0..care.points).map(|_| in_cube(random).map(|c| c * HALF)).collect();
    // Half of them are walked toward the surface by their bounds, and stop at different distances before it.
    let walking = starts.len() / 2;
    let directions: Vec<[f64; 3]> = (0..walking).map(|_| direction(random)).collect();
    for _ in 0..10 {
        let mut moved = starts[..walking].to_vec();
        evaluator.at(&starts[..walking], &[], |i, values| {
            let step = values[1].abs().min(HALF);
            if step > 1e-3 {
                // Back and forth: what leaves the cube is of no interest.
                let outward = (0..3).map(|k| moved[i][k] * directions[i][k]).sum::<f64>() > 2.0;
                moved[i] = along(moved[i], directions[i], if outward { -0.9 * step } else { 0.9 * step });
            }
        });
        starts[..walking].copy_from_slice(&moved);
    }
    let extent = scene.blocks.extent;
    starts.retain(|p| p.iter().map(|c| c * c).sum::<f64>().sqrt() < extent);
    let mut claims = Vec::with_capacity(starts.len());
    let mut found = None;
    evaluator.at(&starts, &[], |i, values| {
        let [field, bound, distance] = [values[0], values[1], values[2]];
        if !(field.is_finite() && bound.is_finite() && distance.is_finite()) && found.is_none() {
            let words = format!("at {:?} the field is {field}, the bound {bound}, the distance {distance}", starts[i]);
            found = Some(Fault { kind: FaultKind::NotFinite, words });
        }
        if field.signum() != bound.signum() && field.abs() > 1e-9 && bound.abs() > 1e-9 && found.is_none() {
            let words = format!("at {:?} the field is {field} and the bound {bound}; {live:?}", starts[i]);
            found = Some(Fault { kind: FaultKind::Sign, words });
        }
        let planes = values.get(3).copied().unwrap_or(f64::INFINITY);
        let beyond = ahead.region.is_some_and(|region| !region.0.iter().zip(starts[i]).all(|(side, c)| side.contains(c)));
        // What is beyond the box may touch zero where a number was rounded.
        if beyond && planes > 1e-6 && field < -1e-6 && found.is_none() {
            let words = format!("at {:?} the field is {field}, beyond the box {:?}; {live:?}", starts[i], ahead.region);
            found = Some(Fault { kind: FaultKind::Ahead, words });
        }
        if let [whole, whole_distance, planes, rest, rest_distance] = values[1..]
            && [(whole, rest), (whole_distance, rest_distance)].iter().any(|(all, rest)| (rest.min(planes) - all).abs() > 1e-9 * (1.0 + all.abs()))
            && found.is_none()
        {
            let words = format!("at {:?} planes and rest make {values:?}; {live:?}", starts[i]);
            found = Some(Fault { kind: FaultKind::Ahead, words });
        }
        let radius = if bound.abs() <= HAIR { 0.0 } else { bound.abs().min(2.0 * HALF) };
        claims.push(Claim { point: starts[i], radius, field });
    });
    if let Some(fault) = found {
        return Err(fault);
    }
    let violations = falsify(&mut evaluator, &claims, || direction(random), DIRECTIONS, &PARTS, extent);
    if let Some(violation) = violations.first() {
        let claim = claims[violation.claim];
        let words = format!(
            "{} times: from {:?} (field {}, bound {}) to {:?} (field {}); {live:?}",
            violations.len(), claim.point, claim.field, claim.radius, violation.at, violation.field
        );
        return fault(FaultKind::Hole, words);
    }
    let (empty, undecided) = certify(scene, live, &claims, care.balls)?;
    Ok(Tried { points: claims.len(), empty, undecided })
}

/// How many of so many balls are certainly empty, and how many may or may not be.
fn certify(scene: &Compiled, live: &Live, claims: &[Claim], balls: usize) -> Result<(usize, usize), Fault> {
    let (mut empty, mut undecided) = (0, 0);
    let Ok(truth) = Truth::new(scene, live, OPERATIONS) else { return Ok((0, 0)) };
    let mut prover = truth.prover();
    let boxes = (STEPS / truth.steps().max(1)).clamp(10, BOXES);
    // An odd step meets points near to the surface and far from it.
    let every = (claims.len() / balls.max(1)).max(1) | 1;
    for claim in claims.iter().step_by(every).take(balls) {
        // What 64 bits lose is less than the hundredth; beyond the extent nothing is promised.
        let room = scene.blocks.extent - claim.point.iter().map(|c| c * c).sum::<f64>().sqrt();
        match prover.empty_ball(claim.point, (0.99 * claim.radius).min(room), boxes) {
            Ball::Empty => empty += 1,
            Ball::Unknown(_) => undecided += 1,
            Ball::Crossed(at) => {
                let words = format!(
                    "certain: from {:?} (field {}, bound {}) to {at:?} (field {}); {live:?}",
                    claim.point,
                    claim.field,
                    claim.radius,
                    prover.value(at)
                );
                return Err(Fault { kind: FaultKind::Hole, words });
            }
        }
    }
    Ok((empty, undecided))
}

fn along(p: [f64; 3], d: [f64; 3], t: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| p[i] + t * d[i])
}

/// In 0..1.
fn unit(random: &mut Random) -> f64 {
    (random.next() >> 11) as f64 / (1u64 << 53) as f64
}

fn in_cube(random: &mut Random) -> [f64; 3] {
    [0; 3].map(|_| 2.0 * unit(random) - 1.0)
}

fn direction(random: &mut Random) -> [f64; 3] {
    loop {
        let v = in_cube(random);
        let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
        if length > 0.1 && length < 1.0 {
            return v.map(|c| c / length);
        }
    }
}
