//! What the window costs whoever types in it: keys are put into it as if a keyboard sent them, and it is measured how long each takes to be
//! seen; then how much of a core the window takes while nothing happens.

use super::canvas::Canvas;
use super::meter::lock;
use super::panels::source::BLINKS;
use super::session::Session;
use egui::{Context, Event, RawInput};
use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use surefoot_runtime::Gpu;

/// So many keys are typed.
const KEYS: usize = 120;
/// From one key to the next, in milliseconds: as people type, in words with pauses in which a picture is begun, and refined.
const PAUSES: [u64; 10] = [90, 120, 80, 150, 110, 400, 130, 95, 700, 160];
/// Nobody waits longer for a picture or a still.
const PATIENCE: Duration = Duration::from_secs(120);
/// How long the window is left alone before it is measured, and for how long it is.
const REST: (Duration, Duration) = (Duration::from_millis(500), Duration::from_secs(8));

/// What was measured.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    /// The adapter's name.
    pub adapter: String,
    /// Width and height of the picture in pixels.
    pub size: (u32, u32),
    /// From each key to the end of the frame that shows it, in ascending order.
    pub echoes: Vec<Duration>,
    /// How many pictures were drawn meanwhile.
    pub pictures: u64,
    /// The share of a core soon after something was touched, and over how long: the caret blinks then, where it does; none where the system does not tell.
    pub blinking: Option<(f64, Duration)>,
    /// The same after a while in which nothing was touched.
    pub still: Option<(f64, Duration)>,
    /// Why it ended early, if it did.
    pub failure: Option<String>,
}

/// Keys that were typed and are not yet in the window, with the moments at which they were.
type Keys = Arc<Mutex<VecDeque<(Instant, String)>>>;

/// What is being done.
enum Phase {
    /// There is no picture yet.
    Opening,
    /// Keys come from another thread; so many are seen.
    Typing,
    /// The still is being finished.
    Refining,
    /// Something was touched just now: the caret blinks, where it does. That is measured.
    Blinking(Rest),
    /// It does not blink any more.
    Still(Rest),
    /// All is measured.
    Done,
}

/// A time in which nothing happens. A thread measures it, for which the window draws nothing; it answers with the share of a core.
type Rest = Receiver<Option<(f64, Duration)>>;

/// Begins a rest after a while.
fn rest(ctx: &Context, pause: Duration) -> Rest {
    let (sender, receiver) = channel();
    let ctx = ctx.clone();
    let measure = move || {
        std::thread::sleep(pause);
        let (began, before) = (Instant::now(), processor_time());
        std::thread::sleep(REST.1);
        let passed = began.elapsed();
        let share = |(then, now): (Duration, Duration)| (now.saturating_sub(then).as_secs_f64() / passed.as_secs_f64(), passed);
        // The window may be closed by now.
        let _ = sender.send(before.zip(processor_time()).map(share));
        ctx.request_repaint();
    };
    // Where there can be no thread the sender is gone, and nothing is known.
    let _ = std::thread::Builder::new().name("surefoot rest".to_owned()).spawn(measure);
    receiver
}

/// Types, waits and measures.
pub struct Trial {
    gpu: Gpu,
    measured: Arc<Mutex<Measured>>,
    phase: Phase,
    began: Instant,
    keys: Keys,
    /// What is in the frame that is being drawn.
    shown: Vec<Instant>,
    seen: usize,
    frames: u64,
    /// Whether something that changes nothing shall come from the keyboard.
    touches: bool,
}

impl Trial {
    /// Begins. What is measured goes into `measured`.
    pub fn new(gpu: Gpu, measured: Arc<Mutex<Measured>>) -> Self {
        lock(&measured).adapter = gpu.name().to_owned();
        Self {
            gpu,
            measured,
            phase: Phase::Opening,
            began: Instant::now(),
            keys: Keys::default(),
            shown: Vec::new(),
            seen: 0,
            frames: 0,
            touches: false,
        }
    }

    /// Before a frame: the one before is on its way to the screen, and ends with what was ordered for it.
    pub fn before(&mut self, input: &mut RawInput) {
        // Nobody has given the window the keyboard.
        input.focused = true;
        if !self.shown.is_empty() {
            let submission_index = Some(self.gpu.queue().submit([]));
            // Where the device is lost the window says so.
            let _ = self.gpu.device().poll(wgpu::PollType::Wait { submission_index, timeout: None });
            let now = Instant::now();
            let mut measured = lock(&self.measured);
            measured.echoes.extend(self.shown.drain(..).map(|typed| now - typed));
            self.seen = measured.echoes.len();
        }
        for (typed, text) in lock(&self.keys).drain(..) {
            self.shown.push(typed);
            input.events.push(Event::Text(text));
        }
        if std::mem::take(&mut self.touches) {
            // Something that changes nothing.
            input.events.push(Event::WindowFocused(true));
        }
    }

    fn enter(&mut self, phase: Phase) {
        (self.phase, self.began) = (phase, Instant::now());
    }

    /// Types a comment behind the text, on another thread: a keyboard waits for no window.
    fn type_in(&self, ctx: &Context) {
        let (keys, ctx) = (self.keys.clone(), ctx.clone());
        let texts = std::iter::once("\n// ").chain(["w", "o", "r", "d", "s", " "].into_iter().cycle()).take(KEYS);
        let type_in = move || {
            for (text, pause) in texts.zip(PAUSES.into_iter().cycle()) {
                std::thread::sleep(Duration::from_millis(pause));
                lock(&keys).push_back((Instant::now(), text.to_owned()));
                ctx.request_repaint();
            }
        };
        // Where there can be no thread the keys do not come, and that is said.
        let _ = std::thread::Builder::new().name("surefoot keyboard".to_owned()).spawn(type_in);
    }

    /// After a frame: what is next. Answers whether all is measured, and the window shall close.
    pub fn after(&mut self, ctx: &Context, session: &mut Session, canvas: &mut Canvas) -> bool {
        if !self.shown.is_empty() {
            ctx.request_repaint();
        }
        let is_late = self.began.elapsed() > PATIENCE;
        match &mut self.phase {
            Phase::Opening if session.said.swaps > 0 && canvas.samples() > 0 => {
                session.documents.focus = true;
                self.frames = canvas.frames();
                self.type_in(ctx);
                self.enter(Phase::Typing);
            }
            Phase::Typing if self.seen >= KEYS => {
                let mut measured = lock(&self.measured);
                measured.echoes.sort_unstable();
                measured.pictures = canvas.frames() - self.frames;
                drop(measured);
                // What a still costs is not measured here.
                canvas.set_still(1);
                self.enter(Phase::Refining);
            }
            Phase::Refining if canvas.is_done() && session.said.work.is_none() && !session.stage.settles() => {
                lock(&self.measured).size = canvas.timing().size;
                self.touches = true;
                self.enter(Phase::Blinking(rest(ctx, REST.0)));
            }
            Phase::Blinking(known) => match known.try_recv() {
                Err(TryRecvError::Empty) => {}
                share => {
                    lock(&self.measured).blinking = share.ok().flatten();
                    self.enter(Phase::Still(rest(ctx, Duration::from_secs_f64(BLINKS))));
                }
            },
            Phase::Still(known) => match known.try_recv() {
                Err(TryRecvError::Empty) => {}
                share => {
                    lock(&self.measured).still = share.ok().flatten();
                    self.enter(Phase::Done);
                }
            },
            Phase::Done => {}
            Phase::Opening | Phase::Typing | Phase::Refining if is_late => {
                let what = match self.phase {
                    Phase::Opening => "there is no picture",
                    Phase::Typing => "not every key was seen",
                    _ => "the still is not finished",
                };
                lock(&self.measured).failure = Some(format!("{what} after {} s", PATIENCE.as_secs()));
                self.enter(Phase::Done);
            }
            _ => ctx.request_repaint_after(REST.0),
        }
        let is_done = matches!(self.phase, Phase::Done);
        if is_done {
            // Once more, to close.
            ctx.request_repaint();
        }
        is_done
    }
}

/// What the processor has done for this program so far, where the system tells: `/proc/self/stat` of Linux, in hundredths of a second.
fn processor_time() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The program's name stands in brackets, and may hold anything.
    let (_, rest) = text.rsplit_once(')')?;
    let ticks = |at: usize| rest.split_whitespace().nth(at)?.parse::<u64>().ok();
    Some(Duration::from_millis(10 * (ticks(11)? + ticks(12)?)))
}
