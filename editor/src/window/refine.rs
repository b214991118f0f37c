//! Makes a still of a picture that rests: more and more pictures, each through other places of its pixels, whose mean is shown.
//!
//! A thread draws them, in bands so narrow that the window hardly waits for one when it must be drawn itself, and none while keys arrive. The
//! window is woken only when there is something new to show. The thread ends with the canvas: a driver that is a program must not be asked
//! while the process ends.

use super::log::Log;
use super::meter::{Finished, Meter, Piece, Timing, lock, watch};
use std::ops::Range;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::{Camera, Compiled, Live};
use surefoot_runtime::film::{self, Film};
use surefoot_runtime::{Gpu, Picture, View};

/// How long a band may take, in seconds.
const BAND: f64 = 0.008;
/// A picture is cut into no more bands than this where each draws the depth of meshes anew.
const MOST_WITH_DEPTH: u32 = 8;
/// How long after a key no picture is refined, and how long none is begun of which not all pixels were drawn yet.
const QUIET: (Duration, Duration) = (Duration::from_millis(150), Duration::from_millis(40));
/// How long it sleeps meanwhile.
const NAP: Duration = Duration::from_millis(5);
/// A still is made of fewer pictures where they take longer than so many seconds, but not of fewer than the second number.
const STILL: (f64, u32) = (60.0, 16);
/// What was shown is shown anew when there are twice as many pictures in it, but not sooner than the first after the last time, or when the
/// second has passed.
const SHOW: (Duration, Duration) = (Duration::from_millis(100), Duration::from_millis(500));

/// What the window and the thread share.
pub struct Sheet {
    /// What is drawn on.
    pub film: Film,
    /// Of which sample the view is that the device was told last.
    pub aim: u32,
    /// Whether all pixels of the first picture are on the film, and nothing counts yet.
    pub first: bool,
    /// Grows with each change; what was ordered before is given up.
    pub turn: u64,
    /// For which turn a still was ordered.
    pub ordered: Option<u64>,
    /// How many pictures are in the still that is shown; 0: none is.
    pub shown: u32,
    /// How many pictures were drawn so far.
    pub frames: u64,
    /// What went wrong.
    pub error: Option<String>,
    /// When the last key came.
    pub key: Option<Instant>,
}

impl Sheet {
    /// An empty one.
    pub fn new(film: Film) -> Self {
        Self { film, aim: 0, first: false, turn: 0, ordered: None, shown: 0, frames: 0, error: None, key: None }
    }

    /// Begins anew: something is another than it was.
    pub fn begin_anew(&mut self) {
        self.film.clear();
        (self.aim, self.first, self.shown, self.error) = (0, false, 0, None);
        self.turn += 1;
    }
}

/// A still to make.
pub struct Job {
    /// Of which turn it is.
    pub turn: u64,
    /// What draws the scene.
    pub picture: Arc<Mutex<Picture>>,
    /// The scene.
    pub compiled: Arc<Compiled>,
    /// Its values.
    pub live: Live,
    /// From where it is seen.
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Where it is shown.
    pub target: wgpu::Texture,
    /// Of how many pictures it is made at most.
    pub most: u32,
    /// How many scenes were put on before it.
    pub swaps: u64,
}

/// What the thread is told.
enum Order {
    /// Measure a picture that the window has ordered itself.
    Measure(Piece),
    /// Make a still.
    Refine(Box<Job>),
}

/// How many pictures a still of this size is made of, at most so many.
pub fn wanted(timing: &Timing, size: [u32; 2], most: u32) -> u32 {
    let takes = timing.per_pixel * f64::from(size[0]) * f64::from(size[1]);
    let in_time = if takes > 0.0 { (STILL.0 / takes) as u32 } else { u32::MAX };
    most.min(in_time.max(STILL.1))
}

/// The view of the sample of a number, of a picture of `size` pixels.
pub fn view(camera: Camera, size: [u32; 2], sample: u32) -> View {
    View { camera: camera.sampled(sample), size: size.map(|side| side as f32), corner: film::offset(sample).map(|c| -c), sample }
}

/// The thread.
pub struct Refiner {
    sheet: Arc<Mutex<Sheet>>,
    timing: Arc<Mutex<Timing>>,
    /// None once it ends.
    orders: Option<Sender<Order>>,
    /// None where there could be no thread: then nothing is measured or refined, and the pictures come all the same.
    thread: Option<JoinHandle<()>>,
}

impl Refiner {
    /// Starts. `wake` is called when there is something to show.
    pub fn start(gpu: Gpu, sheet: Arc<Mutex<Sheet>>, log: Log, wake: Arc<dyn Fn() + Send + Sync>) -> Self {
        let timing = Arc::<Mutex<Timing>>::default();
        let (orders, received) = channel();
        let meter = Meter::new(gpu.clone(), log, timing.clone());
        let mut hand = Hand { gpu, sheet: sheet.clone(), meter, timing: timing.clone(), rows: Rows::default(), wake };
        let thread = std::thread::Builder::new().name("surefoot stills".to_owned()).spawn(move || hand.work(&received)).ok();
        Self { sheet, timing, orders: Some(orders), thread }
    }

    /// What is known of how long pictures take.
    pub fn timing(&self) -> Timing {
        *lock(&self.timing)
    }

    /// Hears of a picture that is being drawn.
    pub fn measure(&self, piece: Piece) {
        self.order(Order::Measure(piece));
    }

    /// Orders a still.
    pub fn refine(&self, job: Job) {
        self.order(Order::Refine(Box::new(job)));
    }

    fn order(&self, order: Order) {
        if let Some(orders) = &self.orders {
            // A thread that panicked has said so already.
            let _ = orders.send(order);
        }
    }
}

impl Drop for Refiner {
    fn drop(&mut self) {
        // What is being drawn is given up.
        lock(&self.sheet).turn += 1;
        self.orders = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// What the thread works with.
struct Hand {
    gpu: Gpu,
    sheet: Arc<Mutex<Sheet>>,
    meter: Meter,
    timing: Arc<Mutex<Timing>>,
    rows: Rows,
    wake: Arc<dyn Fn() + Send + Sync>,
}

impl Hand {
    fn work(&mut self, orders: &Receiver<Order>) {
        while let Ok(order) = orders.recv() {
            match order {
                Order::Measure(piece) => drop(self.meter.measure(&piece)),
                Order::Refine(job) => {
                    let done = self.refine(&job);
                    let mut sheet = lock(&self.sheet);
                    if sheet.turn == job.turn {
                        match done {
                            Ok(()) => sheet.ordered = None,
                            // It is not tried again before something changes.
                            Err(error) => sheet.error = Some(error),
                        }
                    }
                }
            }
            (self.wake)();
        }
    }

    /// Draws one picture after the other until there are enough, or something changes.
    fn refine(&mut self, job: &Job) -> Result<(), String> {
        let least = match lock(&job.picture).has_depth() {
            true => job.size[1].div_ceil(MOST_WITH_DEPTH),
            false => 1,
        };
        let per_row = lock(&self.timing).per_pixel * f64::from(job.size[0]);
        self.rows.fit(job.size, per_row);
        let mut shown = Instant::now();
        while self.begin(job)? {
            let mut row = 0;
            while row < job.size[1] {
                if !self.is_quiet(job) {
                    return Ok(());
                }
                let band = self.rows.band(row, least);
                let Some((piece, shows)) = self.draw(job, band.clone(), shown.elapsed())? else { return Ok(()) };
                let took = self.meter.measure(&piece);
                self.rows.note(band.clone(), took);
                row = band.end;
                if shows {
                    shown = Instant::now();
                    (self.wake)();
                }
            }
        }
        Ok(())
    }

    /// Aims at the next picture's places; false where there are enough, or something has changed.
    fn begin(&self, job: &Job) -> Result<bool, String> {
        let mut sheet = lock(&self.sheet);
        if sheet.turn != job.turn {
            return Ok(false);
        }
        if std::mem::take(&mut sheet.first) {
            self.gpu.catch(|| {
                let mut encoder = self.gpu.device().create_command_encoder(&Default::default());
                sheet.film.keep(&mut encoder, &lock(&job.picture));
                self.gpu.queue().submit([encoder.finish()]);
            })?;
        }
        if sheet.film.count() >= self.wanted(job) {
            return Ok(false);
        }
        sheet.aim = sheet.film.count();
        lock(&job.picture).update(self.gpu.queue(), &job.compiled, &job.live, &view(job.camera, job.size, sheet.aim));
        Ok(true)
    }

    fn wanted(&self, job: &Job) -> u32 {
        wanted(&lock(&self.timing), job.size, job.most)
    }

    /// Waits until no keys arrive; false where something has changed.
    fn is_quiet(&self, job: &Job) -> bool {
        loop {
            let sheet = lock(&self.sheet);
            if sheet.turn != job.turn {
                return false;
            }
            let quiet = if sheet.film.count() == 0 { QUIET.1 } else { QUIET.0 };
            if sheet.key.is_none_or(|key| key.elapsed() >= quiet) {
                return true;
            }
            drop(sheet);
            std::thread::sleep(NAP);
        }
    }

    /// Orders a band; with the last one the picture counts, and is shown where it is time. None where something has changed.
    fn draw(&self, job: &Job, band: Range<u32>, since: Duration) -> Result<Option<(Piece, bool)>, String> {
        let mut sheet = lock(&self.sheet);
        if sheet.turn != job.turn {
            return Ok(None);
        }
        let picture = lock(&job.picture);
        let is_last = band.end == job.size[1];
        let count = sheet.film.count() + 1;
        let is_time = since >= SHOW.1 || since >= SHOW.0 && count >= 2 * sheet.shown;
        let shows = is_last && (sheet.shown == 0 || count >= self.wanted(job) || is_time);
        let ordered = Instant::now();
        let done = self.gpu.catch(|| {
            let mut encoder = self.gpu.device().create_command_encoder(&Default::default());
            sheet.film.draw(&mut encoder, &picture, job.size, band.clone());
            if is_last {
                sheet.film.keep(&mut encoder, &picture);
            }
            if shows {
                sheet.film.show(&mut encoder, &picture, &job.target);
            }
            self.gpu.queue().submit([encoder.finish()]);
            watch(&self.gpu)
        })?;
        sheet.frames += u64::from(is_last);
        if shows {
            sheet.shown = count;
        }
        let finishes = is_last.then(|| Finished { frame: sheet.frames, size: job.size.into(), swaps: job.swaps });
        let pixels = u64::from(job.size[0]) * u64::from(band.end - band.start);
        Ok(Some((Piece { done, ordered, pixels, begins: band.start == 0, finishes }, shows)))
    }
}

/// What each row of a picture took, in seconds.
#[derive(Default)]
struct Rows {
    size: [u32; 2],
    costs: Vec<f64>,
    /// How many of the first rows were drawn before.
    known: u32,
    /// How many the last band had.
    last: u32,
}

impl Rows {
    /// Of a picture of this size. Where it is another than before, a row takes so long.
    fn fit(&mut self, size: [u32; 2], per_row: f64) {
        if self.size != size {
            *self = Self { size, costs: vec![per_row; size[1] as usize], known: 0, last: size[1].div_ceil(32) };
        }
    }

    /// The rows from one on that are drawn within the time of a band, but so many at least.
    fn band(&self, first: u32, least: u32) -> Range<u32> {
        let least = least.max(1);
        // Where nothing was drawn yet a picture may be much slower than the rows before.
        let most = if first < self.known { u32::MAX } else { (2 * self.last).max(least) };
        let mut left = BAND;
        let fits = |(i, cost): (u32, &f64)| {
            left -= cost;
            i < least || left >= 0.0 && i < most
        };
        let count = (0..).zip(self.costs.get(first as usize..).unwrap_or_default()).map(fits).take_while(|fits| *fits).count();
        first..(first + (count as u32).max(1)).min(self.size[1])
    }

    fn note(&mut self, band: Range<u32>, took: Duration) {
        self.last = band.end - band.start;
        self.known = self.known.max(band.end);
        let cost = took.as_secs_f64() / f64::from(self.last.max(1));
        for row in self.costs.iter_mut().take(band.end as usize).skip(band.start as usize) {
            *row = cost;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_are_as_wide_as_their_time() {
        let mut rows = Rows::default();
        rows.fit([100, 64], 1e-3);
        assert_eq!(rows.band(0, 1), 0..4, "carefully, where nothing was drawn");
        for (first, ms) in [(0u32, 1u64), (32, 70)] {
            rows.note(first..first + 32, Duration::from_millis(ms));
        }
        assert_eq!(rows.band(0, 1), 0..35, "quick rows, and as many slow ones as there is time");
        assert_eq!(rows.band(32, 1), 32..35);
        assert_eq!(rows.band(32, 16), 32..48);
        assert_eq!(rows.band(63, 16), 63..64);
        rows.note(32..64, Duration::from_secs(10));
        assert_eq!(rows.band(40, 1), 40..41, "one at least");
        rows.fit([100, 64], 1.0);
        assert_eq!(rows.band(0, 1), 0..32, "what is known stays");
    }
}
