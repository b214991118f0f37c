//! `surefoot stress`: what is hard for a field, for rays and for balls, in 64 bits and on the graphics adapter.

mod balls;
mod cases;
mod report;
mod rows;

use super::bar::LateBar;
use super::bench::error::truth::{Answer, BOXES, Errors, View};
use super::console::{Exit, Failure, print};
use super::page;
use cases::{Case, Rays};
use surefoot_compiler::compiled::{Compiled, Frame, Live};
use surefoot_compiler::emit::tracer::Tracer;
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::reference::march::Ray;
use surefoot_compiler::vector::{Vec3, along, unit};
use surefoot_compiler::reference::{Area, Reference, View as Shows};
use surefoot_compiler::Export;
use surefoot_runtime::headless::{self, Shot};
use surefoot_runtime::passes::rays::{Follower, Rays as Followed};
use surefoot_runtime::{Gpu, evaluate};
use rows::{Cells, Row, scene};
pub use rows::Args;

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
