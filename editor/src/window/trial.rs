//! What the window costs whoever types in it: keys are put into it as if a keyboard sent them, and it is measured how long each takes to be
//! seen, while pictures are not refined and while they are; how long after the last one there is a new picture; whether the window stands
//! while the compiler works; and how much of a core the window takes while nothing happens.

use super::canvas::Canvas;
use super::meter::lock;
use super::panels::source::BLINKS;
use super::session::{Place, Session};
use egui::{Context, Event, RawInput};
use std::collections::VecDeque;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use surefoot_runtime::Gpu;

/// So many keys are typed, each time.
const KEYS: usize = 120;
/// So many pictures make the stills that are refined meanwhile.
const STILL: u32 = 256;
/// From one key to the next, in milliseconds: as people type, in words with pauses in which a picture is begun, and refined.
const PAUSES: [u64; 10] = [90, 120, 80, 150, 110, 400, 130, 95, 700, 160];
/// Nobody waits longer for a picture or a still.
const PATIENCE: Duration = Duration::from_secs(90);
/// How long the window is left alone before it is measured, and for how long it is.
const REST: (Duration, Duration) = (Duration::from_millis(500), Duration::from_secs(8));

/// What was measured.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    /// The adapter's name.
    pub adapter: String,
    /// Width and height of the picture in pixels.
    pub size: (u32, u32),
    /// How many lines the text has.
    pub lines: usize,
    /// What was measured of keys while pictures were not refined, and while they were.
    pub typed: [Typed; 2],
    /// The longest time that the window's thread took for a frame while the compiler worked, and the longest time that the compiler took.
    pub meanwhile: [Duration; 2],
    /// Soon after something was touched: the caret blinks then, where it does; none where the system does not tell.
    pub blinking: Option<Rested>,
    /// The same after a while in which nothing was touched.
    pub still: Option<Rested>,
    /// Why it ended early, if it did.
    pub failure: Option<String>,
}

/// What was measured of keys.
#[derive(Clone, Debug, Default)]
pub struct Typed {
    /// From each key to the end of the frame that shows it, in ascending order.
    pub echoes: Vec<Duration>,
    /// What the processor did on the window's thread for each such frame, in ascending order; empty where the system does not tell.
    pub own: Vec<Duration>,
    /// From the last key to the first picture of the text with it, and to one of which all pixels are drawn.
    pub picture: [Duration; 2],
    /// How many pictures were drawn meanwhile.
    pub pictures: u64,
}

/// What was measured of a time in which nothing happened.
#[derive(Clone, Copy, Debug)]
pub struct Rested {
    /// The share of a core.
    pub share: f64,
    /// Over how long.
    pub time: Duration,
    /// How many frames were drawn.
    pub frames: u64,
}

/// Keys that were typed and are not yet in the window, with the moments at which they were.
type Keys = Arc<Mutex<VecDeque<(Instant, String)>>>;

/// What is being done.
enum Phase {
    /// There is no picture yet.
    Opening,
    /// Keys come from another thread: the first time pictures are not refined, the second time they are.
    Typing(usize),
    /// The picture of the last key is waited for.
    Following(usize),
    /// The still is being finished.
    Refining,
    /// Something was touched just now: the caret blinks, where it does. That is measured.
    Blinking(Rest),
    /// It does not blink any more.
    Still(Rest),
    /// All is measured.
    Done,
}

/// A time in which nothing happens. A thread measures it, for which the window draws nothing.
type Rest = Receiver<Option<Rested>>;

/// Begins a rest after a while. `frames` counts those of the window.
fn rest(ctx: &Context, pause: Duration, frames: &Arc<AtomicU64>) -> Rest {
    let (sender, receiver) = channel();
    let (ctx, frames) = (ctx.clone(), frames.clone());
    let measure = move || {
        std::thread::sleep(pause);
        let count = || frames.load(Ordering::Relaxed);
        let (began, before, first) = (Instant::now(), processor_time(), count());
        std::thread::sleep(REST.1);
        let (time, frames) = (began.elapsed(), count() - first);
        let rested = |(then, now): (Duration, Duration)| Rested { share: now.saturating_sub(then).as_secs_f64() / time.as_secs_f64(), time, frames };
        // The window may be closed by now.
        let _ = sender.send(before.zip(processor_time()).map(rested));
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
    /// When the last key came, and how many of its two pictures are on their way to the screen, and how many were seen.
    last: Option<Instant>,
    drawn: usize,
    followed: usize,
    /// How many pictures there were before.
    pictures: u64,
    /// How many frames the window has drawn.
    frames: Arc<AtomicU64>,
    /// When this frame began, and what the processor had done on this thread by then.
    frame: (Instant, Option<Duration>),
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
            last: None,
            drawn: 0,
            followed: 0,
            pictures: 0,
            frames: Arc::default(),
            frame: (Instant::now(), None),
            touches: false,
        }
    }

    /// Before a frame: the one before is on its way to the screen, and ends with what was ordered for it.
    pub fn before(&mut self, input: &mut RawInput) {
        // Nobody has given the window the keyboard.
        input.focused = true;
        if let Phase::Typing(turn) | Phase::Following(turn) = self.phase
            && (!self.shown.is_empty() || self.drawn > self.followed)
        {
            let own = self.frame.1.zip(time_of_this_thread()).map(|(then, now)| now.saturating_sub(then));
            let submission_index = Some(self.gpu.queue().submit([]));
            // Where the device is lost the window says so.
            let _ = self.gpu.device().poll(wgpu::PollType::Wait { submission_index, timeout: None });
            let now = Instant::now();
            let typed = &mut lock(&self.measured).typed[turn];
            typed.own.extend(own.filter(|_| !self.shown.is_empty()));
            typed.echoes.extend(self.shown.drain(..).map(|key| now - key));
            for picture in &mut typed.picture[self.followed..self.drawn] {
                *picture = self.last.map(|last| now - last).unwrap_or_default();
            }
            self.followed = self.drawn;
        }
        for (typed, text) in lock(&self.keys).drain(..) {
            self.last = Some(typed);
            self.shown.push(typed);
            input.events.push(Event::Text(text));
        }
        if std::mem::take(&mut self.touches) {
            // Something that changes nothing.
            input.events.push(Event::WindowFocused(true));
        }
        self.frame = (Instant::now(), time_of_this_thread());
    }

    fn enter(&mut self, phase: Phase) {
        (self.phase, self.began) = (phase, Instant::now());
    }

    /// Types a comment behind a line in the middle of the text, on another thread: a keyboard waits for no window.
    fn type_in(&mut self, ctx: &Context, session: &mut Session, canvas: &Canvas) {
        let document = session.documents.current();
        let lines = document.text.lines().count();
        let line = document.text.lines().nth(lines / 2).unwrap_or_default();
        let at = (lines as u32 / 2 + 1, line.chars().count() as u32 + 1);
        session.documents.jump = Some(Place { file: document.name.clone(), start: at, end: at });
        lock(&self.measured).lines = lines;
        (self.last, self.drawn, self.followed, self.pictures) = (None, 0, 0, canvas.frames());
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
        self.frames.fetch_add(1, Ordering::Relaxed);
        if !self.shown.is_empty() {
            ctx.request_repaint();
        }
        if matches!(self.phase, Phase::Typing(_)) {
            let [frame, compiler] = &mut lock(&self.measured).meanwhile;
            *compiler = session.said.times.compile.max(*compiler);
            if session.said.work.is_some() {
                *frame = self.frame.0.elapsed().max(*frame);
            }
        }
        let is_late = self.began.elapsed() > PATIENCE;
        match &mut self.phase {
            Phase::Opening if session.said.swaps > 0 && canvas.samples() > 0 => {
                canvas.set_still(1);
                // Of what moves there is no picture with all its pixels.
                session.stage.playing = false;
                self.type_in(ctx, session, canvas);
                self.enter(Phase::Typing(0));
            }
            Phase::Typing(turn) if lock(&self.measured).typed[*turn].echoes.len() >= KEYS => {
                let turn = *turn;
                {
                    let typed = &mut lock(&self.measured).typed[turn];
                    typed.echoes.sort_unstable();
                    typed.own.sort_unstable();
                    typed.pictures = canvas.frames() - self.pictures;
                }
                self.enter(Phase::Following(turn));
                ctx.request_repaint();
            }
            Phase::Following(turn) if self.followed == 2 => {
                let turn = *turn;
                if turn == 0 {
                    canvas.set_still(STILL);
                    self.type_in(ctx, session, canvas);
                    self.enter(Phase::Typing(1));
                } else {
                    // What a still costs is not measured here.
                    canvas.set_still(1);
                    self.enter(Phase::Refining);
                }
                ctx.request_repaint();
            }
            Phase::Following(_) if !is_late => {
                let document = session.documents.current();
                let is_drawn = session.said.drawn.sources.iter().any(|(_, file)| *file.text == *document.text);
                let drawn = usize::from(is_drawn) + usize::from(is_drawn && canvas.is_sharp());
                if drawn > self.drawn {
                    self.drawn = drawn;
                    ctx.request_repaint();
                } else {
                    // What draws wakes the window. Frames in between would only take its time.
                    ctx.request_repaint_after(REST.0);
                }
            }
            Phase::Refining if canvas.is_done() && session.said.work.is_none() && !session.stage.settles() => {
                lock(&self.measured).size = canvas.timing().size;
                self.touches = true;
                self.enter(Phase::Blinking(rest(ctx, REST.0, &self.frames)));
            }
            Phase::Blinking(known) => match known.try_recv() {
                Err(TryRecvError::Empty) => {}
                share => {
                    lock(&self.measured).blinking = share.ok().flatten();
                    self.enter(Phase::Still(rest(ctx, Duration::from_secs_f64(BLINKS), &self.frames)));
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
            Phase::Opening | Phase::Typing(_) | Phase::Following(_) | Phase::Refining if is_late => {
                let what = match self.phase {
                    Phase::Opening => "there is no picture",
                    Phase::Typing(_) => "not every key was seen",
                    Phase::Following(_) => "there is no picture of the last key",
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

/// What it has done on this thread: `/proc/thread-self/schedstat` of Linux, in nanoseconds.
fn time_of_this_thread() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse().ok().map(Duration::from_nanos)
}
