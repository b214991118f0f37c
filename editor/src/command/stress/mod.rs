//! `surefoot stress`: what is hard for a field, for rays and for balls, in 64 bits and on the graphics adapter.

mod balls;
mod cases;
mod report;

use super::bar::LateBar;
use super::bench::error::truth::{Answer, BOXES, Errors, View};
use super::console::{Exit, Failure, print};
use super::page;
use cases::{Case, Rays};
use std::path::PathBuf;
use surefoot_compiler::compiled::{Compiled, Frame, Live};
use surefoot_compiler::diagnostic::{self, Severity};
use surefoot_compiler::emit::tracer::Tracer;
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::functions::Kind;
use surefoot_compiler::reference::march::Ray;
use surefoot_compiler::vector::{Vec3, along, unit};
use surefoot_compiler::reference::{Area, Reference, View as Shows};
use surefoot_compiler::{Export, MemoryLoader, Options, compile};
use surefoot_runtime::headless::{self, Shot};
use surefoot_runtime::passes::rays::{Follower, Rays as Followed};
use surefoot_runtime::{Gpu, evaluate};

/// How much of it.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Each case must stay finite (no NaN and no infinity in any picture, ray or function), converge (no ray spends its looks between surfaces; \
balls come to rest), miss nothing (a ray that surely hits does hit, and one that surely misses does miss; no ball passes a wall), and err by \
less than half a pixel (the 99th percentile of the distance between the hit and the surface; of balls less than a twentieth of a radius). What each ray \
meets is certified in intervals first. A cell is red where that fails, and the case then says why.")]
pub struct Args {
    /// Only the cases whose names hold these words.
    words: Vec<String>,
    /// Width and height of the pictures in pixels, a multiple of 32; costly scenes get a half or a quarter of that.
    #[arg(long, default_value_t = 64, value_parser = side, value_name = "N")]
    size: u32,
    /// Balls that come to rest on the adapter, and for how many seconds.
    #[arg(long, default_value_t = 10_000, value_name = "N")]
    balls: u32,
    /// See --balls.
    #[arg(long, default_value_t = 60, value_name = "N")]
    seconds: u32,
    /// Write the numbers to this file.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the table to this page, in place of the one that stands there.
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
}

fn side(text: &str) -> Result<u32, String> {
    let fits = |n: &u32| n.is_multiple_of(32) && (32..=512).contains(n);
    text.parse().ok().filter(fits).ok_or_else(|| "write a multiple of 32, at most 512".to_owned())
}

/// What came of a case on one machine.
#[derive(Clone, Debug, Default)]
pub struct Cells {
    /// Numbers that were looked at, and how many of them are none or infinite.
    pub finite: (usize, usize),
    /// Rays or balls, and how many of them did not come to an end.
    pub ended: (usize, usize),
    /// Rays or balls of which it is known where they must go, and how many did not.
    pub missed: (usize, usize),
    /// The 99th percentile of the error and the largest: in pixels, or in radii of a ball. None where nothing is certain.
    pub error: Option<(f64, f64)>,
}

/// What came of a case.
pub struct Row {
    /// Its name.
    pub name: String,
    /// In 64 bits, and on the adapter.
    pub cells: [Cells; 2],
    /// Rays of which nothing is certain, of all.
    pub unknown: (usize, usize),
    /// What the compiler says: severity and words.
    pub said: Vec<(Severity, String)>,
    /// Whether the scene is refused.
    pub refused: bool,
    /// What the error is allowed to be.
    pub limit: f64,
    /// Why a cell is red, where one is.
    pub known: Option<&'static str>,
}

impl Row {
    /// Names of the red cells.
    pub fn red(&self) -> Vec<&'static str> {
        let any = |red: &dyn Fn(&Cells) -> bool| self.cells.iter().any(red);
        let mut red = Vec::new();
        let mut ask = |name, is| if is { red.push(name) };
        ask("finite", any(&|c| c.finite.1 > 0));
        ask("converged", any(&|c| c.ended.1 > 0));
        ask("missed", any(&|c| c.missed.1 > 0));
        ask("error", any(&|c| c.error.is_some_and(|(p99, _)| p99 > self.limit)));
        red
    }

    /// Whether a cell is red and nobody knows why.
    pub fn unexplained(&self) -> bool {
        self.known.is_none() && !self.red().is_empty()
    }
}

/// Tries all cases, prints the table, and ends with an error where a cell is red without a reason.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let gpu = Gpu::headless().map_err(|why| Failure { exit: Exit::NoGraphics, words: why.to_string() })?;
    let wanted = |name: &str| args.words.is_empty() || args.words.iter().any(|word| name.contains(word.as_str()));
    let cases: Vec<Case> = cases::cases().into_iter().filter(|case| wanted(&case.name)).collect();
    let heaps: Vec<balls::Heap> = balls::heaps(args).into_iter().filter(|heap| wanted(&heap.name)).collect();
    let count = cases.len() + heaps.len();
    if count == 0 {
        return Err(Failure::usage(format!("no case has a name with {} in it", args.words.join(" or "))));
    }
    let bar = LateBar::new();
    let mut rows = Vec::new();
    let failed = |name: &str, why: String| Failure::usage(format!("can't try '{name}': {why}"));
    print(report::head(gpu.name()).as_bytes())?;
    for case in &cases {
        bar.show(rows.len() as f64 / count as f64);
        let row = row(&gpu, case, args.size).map_err(|why| failed(&case.name, why))?;
        bar.hide(|| print(report::line(&row).as_bytes()))?;
        rows.push(row);
    }
    for heap in &heaps {
        let show = |part: f64| bar.show((rows.len() as f64 + part) / count as f64);
        let row = balls::row(&gpu, heap, &show).map_err(|why| failed(&heap.name, why))?;
        bar.hide(|| print(report::line(&row).as_bytes()))?;
        rows.push(row);
    }
    bar.finish();
    if let Some(file) = &args.json {
        report::write_json(file, gpu.name(), &rows)?;
    }
    if let Some(file) = &args.page {
        page::put(file, "stress", &report::page(gpu.name(), args, &rows))?;
    }
    print(report::summary(&rows).as_bytes())?;
    Ok(if rows.iter().any(Row::unexplained) { Exit::Errors } else { Exit::Fine })
}

/// A scene of these words, and what the compiler says of it.
fn scene(text: &str) -> (Option<Compiled>, Vec<(Severity, String)>) {
    let outcome = compile(&MemoryLoader::new().with("stress.sdf", text), "stress.sdf", &Options::default());
    let words = |d: &diagnostic::Diagnostic| (d.severity, format!("[{}] {}", d.code.row().name, d.message));
    let mut said: Vec<_> = outcome.diagnostics.iter().map(words).collect();
    if let Some(compiled) = outcome.compiled.as_ref().filter(|c| c.summary.kind == Kind::Unproven) {
        said.push((Severity::Warning, format!("[unproven] factor {:.3}", compiled.summary.factor)));
    }
    (outcome.compiled, said)
}

fn row(gpu: &Gpu, case: &Case, size: u32) -> Result<Row, String> {
    let (compiled, said) = scene(&case.text);
    let refused = compiled.is_none();
    let mut row =
        Row { name: case.name.clone(), cells: Default::default(), unknown: (0, 0), said, refused, limit: 0.5, known: case.known };
    let Some(compiled) = compiled else { return Ok(row) };
    let live = compiled.live();
    let frame = compiled.frame(&live);
    let (_, camera) = frame.cameras.first().ok_or("there is no camera")?;
    let view = match &case.rays {
        Rays::Camera(smaller) => View::new(&compiled, &live, camera, [size / smaller; 2].into(), BOXES, &|| {})?,
        Rays::Uncertain(smaller) => View::new(&compiled, &live, camera, [size / smaller; 2].into(), 0, &|| {})?,
        Rays::Aimed(rays) => {
            // Rows of the device are multiples of eight.
            let padded = rays.iter().chain(rays.last().into_iter().cycle()).take(rays.len().next_multiple_of(8));
            let (padded, certain): (Vec<_>, Vec<bool>) =
                padded.map(|(from, to, certain)| ((*from, unit(*to).unwrap_or([1.0, 0.0, 0.0])), *certain)).unzip();
            let mut view = View::aimed(&compiled, &live, &padded, (padded.len() as u32, 1), 1e-3, BOXES, &|| {})?;
            view.silhouette = certain.iter().map(|certain| !certain).collect();
            view
        }
    };
    let reference = Reference::new(&compiled, &live).map_err(|e| e.to_string())?;
    let footprint = f64::from(view.picture.footprint);
    let exact: Vec<Answer> = reference.trace(&view.rays, footprint, frame.extent).iter().map(Answer::from).collect();
    let own = Follower { wgsl: "", name: "sf_trace", count: false };
    let followed = Followed::new(gpu, &compiled, &live, &own, &view.picture)?;
    followed.run()?;
    let device: Vec<Answer> = followed.read()?.iter().map(Answer::from).collect();
    let judged = !matches!(case.rays, Rays::Uncertain(_));
    let machine = Machine { compiled: &compiled, live: &live, frame: &frame, reference: &reference, view: &view, judged };
    let (cells, unknown) = machine.cells(&exact, machine.numbers_exact(&exact));
    row.unknown = unknown;
    row.cells = [cells, machine.cells(&device, machine.numbers_on(gpu, &device)?).0];
    Ok(row)
}

/// What a case is tried with.
struct Machine<'s> {
    compiled: &'s Compiled,
    live: &'s Live,
    frame: &'s Frame,
    reference: &'s Reference,
    view: &'s View,
    /// Whether it is certain where rays end.
    judged: bool,
}

impl Machine<'_> {
    /// The cells of some answers. `numbers` are those of pictures and functions: how many, and how many are not finite.
    fn cells(&self, answers: &[Answer], numbers: (usize, usize)) -> (Cells, (usize, usize)) {
        let mut errors = Errors::default();
        self.view.judge(self.reference, answers, &mut errors);
        let unknown = if self.judged { errors.unknown } else { answers.len() };
        let bad = answers.iter().filter(|a| !a.t.is_finite()).count();
        let spent = answers.iter().filter(|a| !a.hit && a.steps >= Tracer::DEFAULT.budget).count();
        let wrong = errors.missed + errors.false_hits;
        let at = |percent| Errors::percentile(&errors.off, percent);
        let certain = self.judged && !errors.off.is_empty();
        let cells = Cells {
            finite: (numbers.0 + answers.len(), numbers.1 + bad),
            ended: (answers.len(), spent),
            missed: if self.judged { (errors.judged, wrong) } else { (0, 0) },
            error: certain.then(|| (at(99.0), at(100.0))),
        };
        (cells, (unknown, answers.len()))
    }

    /// Where functions are looked at: where the rays ended and half a unit around, at the origin, and far away.
    fn points(&self, answers: &[Answer]) -> Vec<Vec3> {
        let rays = self.view.rays.iter().zip(answers);
        let met = |(ray, a): (&Ray, &Answer)| [ray.at(a.t), ray.at(0.5 * a.t), along(ray.at(a.t), [0.48, -0.6, 0.64], 0.5)];
        let extent = self.frame.extent;
        let fixed = [[0.0; 3], [0.5; 3], [extent; 3], [0.0, -extent, 0.0], [1e6, 0.0, 1.0], [-1e9; 3]];
        rays.flat_map(met).chain(fixed).filter(|p| p.iter().all(|c| c.is_finite())).collect()
    }

    fn size(&self) -> (u32, u32) {
        self.view.picture.size
    }

    /// In 64 bits.
    fn numbers_exact(&self, answers: &[Answer]) -> (usize, usize) {
        let points = self.points(answers);
        let mut count = Count::default();
        let tape = |tape: &Tape, count: &mut Count| {
            tape.evaluator().at(&points, &[], |_, values| count.add(values.iter().copied()));
        };
        for own in [self.reference.field(), self.reference.bound(), self.reference.distance()] {
            tape(own, &mut count);
        }
        count.add(self.reference.gradients(&points).into_iter().flatten());
        if let Some((_, camera)) = self.frame.cameras.first() {
            let (width, height) = self.size();
            let area = Area { left: 0, top: 0, width, height };
            for shows in [Shows::Shaded, Shows::Normals] {
                let pixels = self.reference.tile(self.frame, camera, self.size(), shows, area);
                count.add(pixels.into_iter().flatten().map(f64::from));
            }
        }
        count.0
    }

    /// On the adapter.
    fn numbers_on(&self, gpu: &Gpu, answers: &[Answer]) -> Result<(usize, usize), String> {
        let origin = self.view.picture.origin;
        let narrow = |p: &Vec3| [0, 1, 2].map(|i| (p[i] - origin[i]) as f32);
        let points: Vec<[f32; 3]> = self.points(answers).iter().map(narrow).collect();
        let mut count = Count::default();
        for export in [Export::Field, Export::Bound, Export::Distance, Export::Gradient] {
            let numbers = evaluate(gpu, self.compiled, self.live, origin, export, &points)?;
            count.add(numbers.into_iter().map(f64::from));
        }
        let (width, height) = self.size();
        for mode in [surefoot_runtime::ViewMode::Shaded, surefoot_runtime::ViewMode::Normals] {
            let shot = Shot { mode, ..Shot::new(width, height) };
            let pixels = headless::light(gpu, self.compiled, self.live, &shot)?;
            count.add(pixels.into_iter().flatten().map(f64::from));
        }
        Ok(count.0)
    }
}

/// Numbers, and how many of them are none or infinite.
#[derive(Default)]
struct Count((usize, usize));

impl Count {
    fn add(&mut self, numbers: impl IntoIterator<Item = f64>) {
        for number in numbers {
            self.0.0 += 1;
            self.0.1 += usize::from(!number.is_finite());
        }
    }
}
