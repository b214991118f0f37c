//! The picture against what is certain of it: where rays in 64 bits provably meet the surface first, beside where the GPU's rays have met it.
//! It is found on another thread, coarse at first. When the picture changes it begins again.

use egui::ColorImage;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::time::{Duration, Instant};
use surefoot_compiler::camera::Basis;
use surefoot_compiler::certify::{Hit, Prover, Truth as Certain};
use surefoot_compiler::compiled::{Camera, Compiled, Live};
use surefoot_compiler::reference::march::Ray;
use surefoot_compiler::reference::shade::steps_color;
use surefoot_compiler::vector::Vec3;
use surefoot_runtime::Gpu;
use surefoot_runtime::passes::rays::{Follower, GpuRay, RayPicture, Rays, Traced, counted_from};

/// The side of a cell in pixels. Its middle pixel is looked at.
pub const CELL: u32 = 4;
/// So many cells a side share what is found of one, coarse at first.
const STRIDES: [u32; 4] = [8, 4, 2, 1];
/// Boxes that a ray may cost.
const BOXES: usize = 4000;
/// Operations of the field at most.
const LIMIT: usize = 2_000_000;
/// How long the picture must rest.
const REST: Duration = Duration::from_millis(300);
/// A difference in depth of this many widths of a pixel is the darkest; one of a whole pixel is the brightest.
pub const LEAST: f64 = 1e-3;
/// Places about a pixel at which its neighbours are, in pixels.
const AROUND: [(f64, f64); 4] = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)];
/// A neighbour is met where the ray was, if they are no further apart than so many widths of a pixel.
const NEAR: f64 = 8.0;

/// A picture that is compared with the truth.
#[derive(Clone)]
pub struct Seen {
    /// The scene.
    pub scene: Arc<Compiled>,
    /// Its values and its moment.
    pub live: Live,
    /// From where.
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
}

impl Seen {
    fn is(&self, other: &Self) -> bool {
        let moment = |seen: &Self| (seen.live.time, seen.live.components.clone());
        Arc::ptr_eq(&self.scene, &other.scene) && self.camera == other.camera && self.size == other.size && moment(self) == moment(other)
    }
}

/// What is true of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Verdict {
    /// Nothing is there, and nothing was met.
    Nothing,
    /// The surface is met: so many widths of a pixel off.
    Apart(f64),
    /// The surface is there, and was not met.
    Missed,
    /// Nothing is there, and something was met.
    Extra,
    /// What was met is what a neighbour shows: an edge goes through the pixel.
    Edge,
    /// It can't be told.
    Unknown,
}

impl Verdict {
    fn color(self) -> [u8; 3] {
        match self {
            Self::Nothing => [31; 3],
            Self::Apart(pixels) => difference_color(pixels).map(|c| (255.0 * c).round() as u8),
            Self::Missed => [255, 0, 0],
            Self::Extra => [255, 0, 255],
            Self::Edge => [96; 3],
            Self::Unknown => [40, 80, 140],
        }
    }
}

/// The colour of a difference in depth, in widths of a pixel.
pub fn difference_color(pixels: f64) -> Vec3 {
    let share = 1.0 - pixels.max(LEAST).log10() / LEAST.log10();
    steps_color((64.0 * share.min(1.0)).round() as u32)
}

/// How many pixels are what.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Count {
    /// Pixels that were looked at.
    pub all: usize,
    /// The surface is there, and was not met.
    pub missed: usize,
    /// Nothing is there, and something was met.
    pub extra: usize,
    /// An edge goes through them.
    pub edges: usize,
    /// It can't be told.
    pub unknown: usize,
    /// The greatest difference of the others, in widths of a pixel.
    pub most: f64,
}

/// What is found so far.
pub struct Found {
    /// Of which picture.
    pub seen: Seen,
    /// How much of it is looked at, 0 to 1.
    pub part: f32,
    /// How many pixels are what.
    pub count: Count,
    /// Its colours, in cells.
    pub image: Arc<ColorImage>,
}

struct Work {
    seen: Seen,
    answer: Receiver<Result<Found, String>>,
    cancelled: Arc<AtomicBool>,
}

impl Drop for Work {
    fn drop(&mut self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }
}

/// The truth of the picture that is shown.
#[derive(Default)]
pub struct Truth {
    /// Whether a person wants to see it.
    pub open: bool,
    work: Option<Work>,
    /// The picture that was seen last, and since when.
    rests: Option<(Seen, Instant)>,
    /// What was found last, or why nothing was.
    pub found: Option<Result<Found, String>>,
}

impl Truth {
    /// Hears which picture is shown, and begins when it rests. The answer: after what time to tell again.
    pub fn follow(&mut self, gpu: &Gpu, seen: Seen, wake: impl Fn() + Send + 'static) -> Option<Duration> {
        if self.work.as_ref().is_some_and(|work| work.seen.is(&seen)) {
            return None;
        }
        self.work = None;
        let now = Instant::now();
        let since = match &self.rests {
            Some((before, since)) if before.is(&seen) => *since,
            _ => now,
        };
        if now.duration_since(since) < REST {
            self.rests = Some((seen, since));
            self.found = None;
            return Some(REST);
        }
        let (sender, answer) = channel();
        let cancelled = Arc::new(AtomicBool::new(false));
        let (gpu, asked, given_up) = (gpu.clone(), seen.clone(), cancelled.clone());
        let find = move || {
            if let Err(why) = find(&gpu, &asked, &given_up, &sender, &wake) {
                // The window may be closed by now, or another picture shown.
                let _ = sender.send(Err(why));
            }
            wake();
        };
        // Where there can be no thread the sender is gone, and that is said.
        let _ = std::thread::Builder::new().name("surefoot truth".to_owned()).spawn(find);
        self.work = Some(Work { seen, answer, cancelled });
        None
    }

    /// Ends it.
    pub fn close(&mut self) {
        *self = Self::default();
    }

    /// Takes what is found. The answer: whether there is anything new.
    pub fn hear(&mut self) -> bool {
        let Some(work) = &self.work else { return false };
        let mut is_new = false;
        loop {
            match work.answer.try_recv() {
                Ok(found) => {
                    self.found = Some(found);
                    is_new = true;
                }
                Err(TryRecvError::Disconnected) if self.found.is_none() => {
                    self.found = Some(Err("no thread could be started for it".to_owned()));
                    return true;
                }
                Err(_) => return is_new,
            }
        }
    }
}

/// A picture's rays: those of the GPU, and the same in 64 bits.
struct Grid {
    /// Cells: columns, a multiple of 8, and rows.
    size: (u32, u32),
    basis: Basis,
    eye: Vec3,
    picture: (u32, u32),
    origin: Vec3,
    reach: f64,
}

impl Grid {
    fn new(seen: &Seen) -> Self {
        let Seen { scene, live, camera, size: [width, height] } = seen;
        Self {
            size: (width.div_ceil(CELL).next_multiple_of(8), height.div_ceil(CELL).max(1)),
            basis: Basis::of(camera),
            eye: camera.eye,
            picture: (*width, *height),
            origin: counted_from(scene, camera.eye),
            reach: scene.frame(live).max_distance,
        }
    }

    /// The ray so many pixels beside the middle of a cell, as the GPU has it.
    fn narrow(&self, (x, y): (u32, u32), (right, down): (f64, f64)) -> GpuRay {
        let middle = |cell: u32| f64::from(cell * CELL + CELL / 2) + 0.5;
        let at = (middle(x) + right, middle(y) + down);
        let from = self.basis.start(self.eye, at, self.picture);
        GpuRay::narrowed(from, self.basis.direction(at, self.picture), self.origin, self.reach)
    }

    /// The same ray in 64 bits.
    fn ray(&self, cell: (u32, u32), aside: (f64, f64)) -> Ray {
        self.narrow(cell, aside).widened(self.origin)
    }
}

fn find(gpu: &Gpu, seen: &Seen, cancelled: &AtomicBool, sender: &Sender<Result<Found, String>>, wake: &dyn Fn()) -> Result<(), String> {
    let Seen { scene, live, .. } = seen;
    let grid = Grid::new(seen);
    let (columns, rows) = grid.size;
    let cells: Vec<(u32, u32)> = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))).collect();
    let footprint = grid.basis.footprint(grid.picture.1);
    let rays = cells.iter().map(|cell| grid.narrow(*cell, (0.0, 0.0))).collect();
    let picture = RayPicture { size: grid.size, rays, origin: grid.origin, footprint: footprint as f32 };
    let follower = Follower { wgsl: "", name: "sf_trace", count: false };
    let traced = {
        let rays = Rays::new(gpu, scene, live, &follower, &picture)?;
        rays.run()?;
        rays.read()?
    };
    let certain = Certain::new(scene, live, LIMIT).map_err(|why| why.to_string())?;
    let extent = scene.frame(live).extent;
    let mut verdicts: Vec<Option<Verdict>> = vec![None; cells.len()];
    for stride in STRIDES {
        let stands = |(x, y): (u32, u32)| x.is_multiple_of(stride) && y.is_multiple_of(stride);
        let new: Vec<usize> = (0..cells.len()).filter(|i| stands(cells[*i]) && verdicts[*i].is_none()).collect();
        let judged: Vec<Option<Verdict>> = new
            .par_iter()
            .map_init(
                || certain.prover(),
                |prover, i| {
                    let traced = traced.get(*i).filter(|_| !cancelled.load(Ordering::Relaxed))?;
                    Some(judge(prover, &grid, cells[*i], traced, footprint, extent))
                },
            )
            .collect();
        if cancelled.load(Ordering::Relaxed) {
            return Ok(());
        }
        for (i, verdict) in new.into_iter().zip(judged) {
            verdicts[i] = verdict;
        }
        let shown = |(x, y): (u32, u32)| verdicts[((y - y % stride) * columns + x - x % stride) as usize].unwrap_or(Verdict::Unknown);
        let within = |(x, y): (u32, u32)| x * CELL < grid.picture.0 && y * CELL < grid.picture.1;
        let pixels: Vec<u8> = cells.iter().flat_map(|cell| shown(*cell).color()).collect();
        let mut count = Count::default();
        for verdict in cells.iter().zip(&verdicts).filter(|(cell, _)| within(**cell)).filter_map(|(_, verdict)| *verdict) {
            count.all += 1;
            match verdict {
                Verdict::Missed => count.missed += 1,
                Verdict::Extra => count.extra += 1,
                Verdict::Edge => count.edges += 1,
                Verdict::Unknown => count.unknown += 1,
                Verdict::Apart(pixels) => count.most = count.most.max(pixels),
                Verdict::Nothing => {}
            }
        }
        let image = Arc::new(ColorImage::from_rgb([columns as usize, rows as usize], &pixels));
        let found = Found { seen: seen.clone(), part: 1.0 / (stride * stride) as f32, count, image };
        if sender.send(Ok(found)).is_err() {
            return Ok(());
        }
        wake();
    }
    Ok(())
}

/// What is true of a cell's pixel, and of what the GPU met there.
fn judge(prover: &mut Prover<'_>, grid: &Grid, cell: (u32, u32), traced: &Traced, footprint: f64, extent: f64) -> Verdict {
    let mut first = |aside| {
        let ray = grid.ray(cell, aside);
        ray.clip(extent).map_or(Hit::Miss, |ray| prover.first_hit(ray.origin, ray.direction, ray.t_min, ray.t_max, BOXES))
    };
    let (met, t) = (traced.hit == 1, f64::from(traced.t));
    let verdict = match (first((0.0, 0.0)), met) {
        (Hit::Miss, false) => return Verdict::Nothing,
        (Hit::Ambiguous(_) | Hit::Exhausted(_), _) => return Verdict::Unknown,
        (Hit::Hit(truth), true) => Verdict::Apart((t - truth).abs() / (footprint * truth).max(1e-30)),
        (Hit::Hit(_), false) => Verdict::Missed,
        (Hit::Miss, true) => Verdict::Extra,
    };
    if matches!(verdict, Verdict::Apart(pixels) if pixels <= 1.0) {
        return verdict;
    }
    let as_there = |hit: Hit| match hit {
        Hit::Hit(other) => met && (t - other).abs() <= NEAR * footprint * t,
        Hit::Miss => !met,
        _ => false,
    };
    let is_edge = AROUND.into_iter().any(|aside| as_there(first(aside)));
    if is_edge { Verdict::Edge } else { verdict }
}

#[cfg(test)]
mod tests {
    use super::*;
    use surefoot_compiler::{MemoryLoader, Options, compile};

    /// A ball of radius 1, and what is said of a pixel where the GPU has answered so.
    fn said(at: (u32, u32), answer: impl Fn(f64) -> (u32, f64)) -> Verdict {
        let text = "scene = sphere(1)\ncamera { eye: (0, 0, 5), target: (0, 0, 0), fov: 40deg }";
        let compiled = compile(&MemoryLoader::new().with("s.sdf", text), "s.sdf", &Options::default()).compiled.unwrap();
        let live = compiled.live();
        let camera = compiled.frame(&live).cameras[0].1;
        let seen = Seen { scene: Arc::new(compiled), live, camera, size: [400, 400] };
        let (grid, certain) = (Grid::new(&seen), Certain::new(&seen.scene, &seen.live, LIMIT).unwrap());
        let footprint = grid.basis.footprint(400);
        let (hit, t) = answer(footprint);
        judge(&mut certain.prover(), &grid, at, &Traced { t: t as f32, hit, steps: 1, looks: [0; 6] }, footprint, 100.0)
    }

    #[test]
    fn each_answer_of_the_gpu_is_judged() {
        let (middle, corner) = ((50, 50), (2, 2));
        assert!(matches!(said(middle, |_| (1, 4.0)), Verdict::Apart(pixels) if pixels < 0.1));
        assert!(matches!(said(middle, |pixel| (1, 4.0 + 0.5 * 4.0 * pixel)), Verdict::Apart(pixels) if (pixels - 0.5).abs() < 0.1));
        assert_eq!(said(middle, |_| (0, 100.0)), Verdict::Missed);
        assert_eq!(said(corner, |_| (0, 100.0)), Verdict::Nothing);
        assert_eq!(said(corner, |_| (1, 4.0)), Verdict::Extra);
        assert_eq!((Verdict::Missed.color(), Verdict::Extra.color()), ([255, 0, 0], [255, 0, 255]));
        // At the outline of the ball either is fine.
        let answers = (50..100).map(|x| said((x, 50), |_| (0, 100.0))).collect::<Vec<_>>();
        assert!(answers.contains(&Verdict::Nothing) && answers.contains(&Verdict::Missed));
        assert!(difference_color(1.0)[0] > 0.9 && difference_color(0.0)[0] < 0.01);
    }
}
