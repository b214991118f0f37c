//! `surefoot verify`: a scene's bound put to the test.

use super::bar::LateBar;
use super::console::{Exit, Failure, colored, compile_file, print, show_diagnostics};
use crate::picture::Device;
use serde_json::{Value, json};
use surefoot_compiler::compiled::{Compiled, Live};
use surefoot_compiler::functions::Kind;
use surefoot_compiler::verify::{self, ALLOWANCE, Compared, DIRECTIONS, Fault, Left, Report, Settings, Side, Violation};
use surefoot_compiler::{Options, Outcome};

/// What to verify.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
The bound says that no surface is nearer than its value. verify tests that at points near and far, inside and outside, with parameters at \
the ends of their ranges and between. Every point is probed along 8 directions. At some points, interval arithmetic certifies that the ball \
of 0.99 times the bound is empty. On a graphics adapter the emitted module computes the bound too; its values, less an allowance for \
rounding in 32 bits, must pass the same test. Parameters that choose by name keep the choice of the text.")]
pub struct Args {
    /// The scene.
    scene: String,
    /// How many points to test, over all values of the parameters.
    #[arg(long, default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(1..), value_name = "N")]
    samples: u32,
    /// How many of the points to certify.
    #[arg(long, default_value_t = 100, value_name = "N")]
    certified: u32,
    /// Seed of the random points; the same seed gives the same points.
    #[arg(long, default_value_t = 1, value_name = "S")]
    seed: u64,
    /// The device that runs the emitted module; `cpu` verifies only its 64-bit counterpart.
    #[arg(long, value_enum, default_value_t)]
    device: Device,
    /// Write one JSON object.
    #[arg(long)]
    json: bool,
}

/// Violations that are printed for a person.
const SHOWN: usize = 5;

/// Verifies and says what came of it.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let outcome = compile_file(&args.scene, &Options::default())?;
    show_diagnostics(&outcome);
    let Some(compiled) = &outcome.compiled else { return Ok(Exit::Errors) };
    let device = Adapter::new(args.device)?;
    let bar = LateBar::new();
    let settings = Settings { samples: args.samples as usize, certified: args.certified as usize, seed: args.seed, work: verify::WORK };
    let bound = |live: &Live, points: &[[f32; 3]]| device.bound(compiled, live, points);
    let bound = device.name().is_some().then_some(&bound as verify::Device);
    let report = verify::verify(compiled, settings, bound, &|part| bar.show(part));
    bar.finish();
    let report = report.map_err(|why| Failure::usage(format!("can't verify {}: {why}", args.scene)))?;
    let text = match args.json {
        true => format!("{}\n", in_json(args, &outcome, compiled, &report, device.name())),
        false => in_words(args, compiled, &report, device.name(), colored(&std::io::stdout())),
    };
    print(text.as_bytes())?;
    Ok(if report.violations.is_empty() { Exit::Fine } else { Exit::Errors })
}

/// What computes the emitted module, if anything.
struct Adapter {
    #[cfg(feature = "gpu")]
    gpu: Option<surefoot_runtime::Gpu>,
}

impl Adapter {
    #[cfg(feature = "gpu")]
    fn new(wanted: Device) -> Result<Self, Failure> {
        let gpu = match wanted {
            Device::Cpu => None,
            _ => match (surefoot_runtime::Gpu::headless(), wanted) {
                (Ok(gpu), _) => Some(gpu),
                (Err(why), Device::Gpu) => return Err(Failure { exit: Exit::NoGraphics, words: why.to_string() }),
                (Err(why), _) => {
                    eprintln!("note: {why}; the emitted module is not computed");
                    None
                }
            },
        };
        Ok(Self { gpu })
    }

    #[cfg(not(feature = "gpu"))]
    fn new(wanted: Device) -> Result<Self, Failure> {
        match wanted {
            Device::Gpu => {
                let words = "this program was built without graphics".to_owned();
                Err(Failure { exit: Exit::NoGraphics, words })
            }
            _ => Ok(Self {}),
        }
    }

    #[cfg(feature = "gpu")]
    fn name(&self) -> Option<&str> {
        self.gpu.as_ref().map(|gpu| gpu.name())
    }

    #[cfg(not(feature = "gpu"))]
    fn name(&self) -> Option<&str> {
        None
    }

    /// The emitted module's bound.
    #[cfg(feature = "gpu")]
    fn bound(&self, compiled: &Compiled, live: &Live, points: &[[f32; 3]]) -> Result<Vec<f32>, String> {
        use surefoot_compiler::Export;
        let gpu = self.gpu.as_ref().ok_or("there is no adapter")?;
        surefoot_runtime::evaluate(gpu, compiled, live, [0.0; 3], Export::Bound, points)
    }

    #[cfg(not(feature = "gpu"))]
    fn bound(&self, _: &Compiled, _: &Live, _: &[[f32; 3]]) -> Result<Vec<f32>, String> {
        Err("there is no adapter".to_owned())
    }
}

fn in_words(args: &Args, compiled: &Compiled, report: &Report, device: Option<&str>, color: bool) -> String {
    let (red, plain) = if color { ("\u{1b}[31m", "\u{1b}[0m") } else { ("", "") };
    let verdict = match report.violations.len() {
        0 => "no violation".to_owned(),
        1 => format!("{red}1 violation{plain}"),
        n => format!("{red}{n} violations{plain}"),
    };
    let mut text = format!("{}: {verdict}\n", args.scene);
    if compiled.summary.kind == Kind::Unproven {
        text.push_str(&format!("  {red}unproven{plain}: something in this scene is only measured; what is tried here proves nothing of the rest\n"));
    }
    let moments = match report.moments.len() {
        1 => String::new(),
        n => format!(", at {n} values of time and parameters"),
    };
    text.push_str(&format!("  {} points along {DIRECTIONS} directions each{moments}\n", report.points));
    let balls = report.empty + report.undecided;
    let Left { moments, points, balls: left } = report.left;
    if report.left != Left::default() {
        let asked = |left: usize, done: usize, of: &str| if left > 0 { format!(", {done} of {} {of}", done + left) } else { String::new() };
        let others = asked(left, report.balls, "balls") + &asked(moments, report.moments.len(), "values of time and parameters");
        let all = args.samples;
        text.push_str(&format!("  stopped after {} of {all} points{others}: the budget is used up
", all as usize - points));
    }
    text.push_str(&format!("  {} of {balls} balls within the bound are certified to be empty", report.empty));
    text.push_str(&match report.undecided {
        0 => "\n".to_owned(),
        n => format!(", {n} undecided\n"),
    });
    if let (Some(low), Some(half)) = (report.tightness(5), report.tightness(50)) {
        let count = report.tightness.len();
        text.push_str(&format!("  the bound over the true distance: {half:.3} at the median, {low:.3} at p5, of {count} points\n"));
    }
    if let (Some(compared), Some(name)) = (&report.device, device) {
        let Compared { points, within, larger, worst } = *compared;
        text.push_str(&format!("  {name}: {within} of {points} bounds of the emitted module are within {ALLOWANCE}·2⁻²⁴·(|p| + size) of those in 64 bits"));
        let smaller = points - within - larger;
        if smaller > 0 {
            text.push_str(&format!(", {smaller} are smaller, which costs steps and no surface"));
        }
        text.push_str(&match (larger, smaller) {
            (0, 0) => format!(", the worst {worst:.3} times that\n"),
            (0, _) => ", and none is larger\n".to_owned(),
            _ => format!(", {larger} are larger, by up to {worst:.3} times that\n"),
        });
    }
    for violation in report.violations.iter().take(SHOWN) {
        text.push_str(&format!("  {red}violation{plain}: {}\n", words(violation, compiled, report)));
    }
    if report.violations.len() > SHOWN {
        text.push_str(&format!("  and {} more; --json has them all\n", report.violations.len() - SHOWN));
    }
    text
}

fn words(violation: &Violation, compiled: &Compiled, report: &Report) -> String {
    let at = |p: [f64; 3]| format!("({}, {}, {})", p[0], p[1], p[2]);
    let side = match violation.side {
        Side::Processor => "",
        Side::Device => " by the emitted module",
    };
    let (from, bound) = (at(violation.point), violation.bound);
    let what = match violation.fault {
        Fault::Crossed(end) => format!(
            "from {from} the bound is {bound:.6}{side}, but the field (there {:.6}) changes its sign before {}, {:.6} away",
            violation.field,
            at(end),
            distance(violation.point, end)
        ),
        Fault::Sign => format!("at {from} the field is {} and the bound{side} has another sign", violation.field),
        Fault::NotFinite => format!("at {from} the field or the bound{side} is no finite number"),
    };
    let values: Vec<String> = values(violation, compiled, report).iter().map(|(n, v)| format!("{n} {v:?}")).collect();
    format!("{what}; {}", values.join(", "))
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// The time and the values of the parameters at which something was found.
fn values(violation: &Violation, compiled: &Compiled, report: &Report) -> Vec<(String, Vec<f64>)> {
    let Some(live) = report.moments.get(violation.moment) else { return Vec::new() };
    let of = |p: &surefoot_compiler::compiled::Parameter| {
        let first = p.first? as usize;
        Some((p.name.clone(), live.components.get(first..first + p.default.len())?.to_vec()))
    };
    let time = std::iter::once(("time".to_owned(), vec![live.time]));
    time.chain(compiled.parameters.iter().filter_map(of)).collect()
}

fn in_json(args: &Args, outcome: &Outcome, compiled: &Compiled, report: &Report, device: Option<&str>) -> Value {
    let violations = report.violations.iter().map(|v| {
        let (fault, surface) = match v.fault {
            Fault::Crossed(at) => ("crossed", Some(at)),
            Fault::Sign => ("sign", None),
            Fault::NotFinite => ("not-finite", None),
        };
        json!({
            "fault": fault,
            "on": if v.side == Side::Device { "device" } else { "processor" },
            "point": v.point,
            "field": v.field,
            "bound": v.bound,
            "surface": surface,
            "distance": surface.map(|at| distance(v.point, at)),
            "values": values(v, compiled, report).into_iter().collect::<std::collections::BTreeMap<_, _>>(),
        })
    });
    json!({
        "file": args.scene,
        "ok": report.violations.is_empty(),
        "kind": compiled.summary.kind.name(),
        "warnings": outcome.diagnostics.len(),
        "seed": args.seed,
        "points": report.points,
        "directions": DIRECTIONS,
        "moments": report.moments.len(),
        "stopped": report.left != Left::default(),
        "left": { "points": report.left.points, "balls": report.left.balls, "moments": report.left.moments },
        "balls": { "empty": report.empty, "undecided": report.undecided },
        "tightness": { "points": report.tightness.len(), "p5": report.tightness(5), "p50": report.tightness(50) },
        "device": report.device.zip(device).map(|(c, name)| json!({
            "name": name,
            "points": c.points,
            "allowance": ALLOWANCE,
            "within": c.within,
            "larger": c.larger,
            "worst": c.worst,
        })),
        "violations": violations.collect::<Vec<_>>(),
    })
}
