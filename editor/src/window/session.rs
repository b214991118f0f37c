//! All that the window knows. Panels read it and push [`Command`](super::command::Command)s.

use super::document::Document;
use crate::animation::Format;
use super::export::{Export, Wanted};
use super::holding::{Holding, is_held};
use super::kept::SceneState;
use super::looking::Looking;
use super::measuring::Measuring;
use super::orbit::Orbit;
use super::parts::Parts;
use super::passes::Passes;
pub use super::places::{Place, place};
use super::recovery::Found;
use super::theme::{Choice, TEXT_SIZE};
use super::truth::Truth;
use std::collections::VecDeque;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use surefoot_compiler::Options;
use surefoot_compiler::compiled::{Camera, Compiled, Parameter};
use surefoot_compiler::diagnostic::{self, Severity};
use surefoot_compiler::factors::Explained;
use surefoot_compiler::outlook::is_blind;
use surefoot_compiler::section::Section;
use surefoot_compiler::syntax::revise::Written;
use surefoot_runtime::live::{Times, Words, Work};
use surefoot_runtime::{Showing, Stage, ViewMode};

/// All that the window knows.
pub struct Session {
    /// The texts.
    pub documents: Documents,
    /// The scene that is drawn, the values of its parameters, and time.
    pub stage: Stage,
    /// What the compiler said last.
    pub said: Said,
    /// From where and how the scene is looked at.
    pub look: Look,
    /// Which panels are open.
    pub open: Open,
    /// What is looked for in the text, while the bar for that is open.
    pub search: Option<Search>,
    /// A path that a person is asked for.
    pub asked: Option<PathAsked>,
    /// Scenes that were opened, the newest first.
    pub recent: Vec<String>,
    /// What comes back of a scene when it is there.
    pub restoring: Option<SceneState>,
    /// What must be answered before anything else, if anything.
    pub question: Option<Question>,
    /// Something that went wrong outside of the scene, for a person to read once.
    pub notice: Option<String>,
    /// How long time runs.
    pub timeline: Timeline,
    /// What the compiler is asked for, with the choices that a person made.
    pub options: Options,
    /// What drawing takes.
    pub meter: Meter,
    /// Texts that were not saved when a window ended without a word.
    pub found: Vec<Found>,
    /// What the scene measures.
    pub measuring: Measuring,
    /// The picture as a file.
    pub export: Export,
    /// What made the pixel that a person pointed at.
    pub looking: Looking,
    /// How far into the picture the ball is that a hand holds, if one does.
    pub held: Option<f64>,
    /// The scene's parts, and which are hidden.
    pub parts: Parts,
    /// What each pass of a frame takes.
    pub passes: Passes,
    /// What is certain of the picture.
    pub truth: Truth,
    /// The number of the text that a hand holds, if one does and it can be a slider.
    pub holding: Option<Holding>,
    /// How many numbers were held so far.
    pub holds: u64,
}

/// How long time runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timeline {
    /// Its length in seconds.
    pub length: f64,
    /// Whether time begins anew at its end.
    pub loops: bool,
}

impl Default for Timeline {
    fn default() -> Self {
        Self { length: 10.0, loops: false }
    }
}

impl Timeline {
    /// The least and the greatest length, in seconds.
    pub const LENGTHS: std::ops::RangeInclusive<f64> = 0.1..=3600.0;
}

/// The texts: the scene's own first, then those that were opened.
pub struct Documents {
    /// All of them; never empty.
    pub all: Vec<Document>,
    /// The one that is shown.
    pub shown: usize,
    /// Where the cursor shall go in it.
    pub jump: Option<Place>,
    /// Whether the keyboard shall go to the text.
    pub focus: bool,
}

/// A diagnostic as the window shows it.
#[derive(Clone, Debug)]
pub struct Problem {
    /// How bad it is.
    pub severity: Severity,
    /// Its name: `surefoot explain` knows it.
    pub code: &'static str,
    /// What is wrong.
    pub message: String,
    /// What to write instead.
    pub help: String,
    /// Where.
    pub place: Place,
    /// What `help` says, as edits; where there are several, one of them is meant.
    pub mends: Vec<Mend>,
}

/// Edits that mend a problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Mend {
    /// What it does, in a few words.
    pub title: String,
    /// The file's name, as the compiler calls it.
    pub file: String,
    /// The text that they are of.
    pub of: Arc<str>,
    /// What stands instead of which bytes, in the order of their places.
    pub edits: Vec<(Range<usize>, String)>,
}

impl Mend {
    /// The text with the edits in it. None if it has become another one.
    pub fn made(&self, text: &str) -> Option<String> {
        if text != &*self.of {
            return None;
        }
        let mut text = text.to_owned();
        for (range, written) in self.edits.iter().rev() {
            text.get(range.clone())?;
            text.replace_range(range.clone(), written);
        }
        Some(text)
    }
}

/// What the compiler said last.
#[derive(Default)]
pub struct Said {
    /// Its words about the newest text.
    pub words: Arc<Words>,
    /// Its words about the text of the scene that is drawn.
    pub drawn: Arc<Words>,
    /// The newest words, as the window shows them.
    pub problems: Vec<Problem>,
    /// The factors of the scene that is drawn, each with its place.
    pub factors: Vec<(Place, Explained)>,
    /// What went wrong behind the compiler.
    pub failure: Option<String>,
    /// What went wrong when the picture was drawn.
    pub drawing: Option<String>,
    /// Which mesh is being read, and how many there are.
    pub loading: Option<String>,
    /// What is being done for the newest text, and for how long.
    pub work: Option<(Work, Duration)>,
    /// How long the newest text took.
    pub times: Times,
    /// Whether the scene that is drawn changes with time.
    pub reads_time: bool,
    /// How many scenes were put on.
    pub swaps: u64,
}

/// From where and how the scene is looked at.
#[derive(Default)]
pub struct Look {
    /// The camera that a person moved; none where the scene's is used.
    pub orbit: Option<Orbit>,
    /// The name of the scene's camera that is used; its first where there is none.
    pub camera: Option<String>,
    /// What the picture shows.
    pub mode: ViewMode,
    /// What it shows right of the divider, where it shows two views.
    pub beside: Option<ViewMode>,
    /// Where the divider is, in parts of the picture's width.
    pub divider: f32,
    /// The plane that cuts the picture open, as a person left it; none before there was one.
    pub section: Option<Section>,
    /// Whether it cuts.
    pub cuts: bool,
    /// How wide the picture is for its height.
    pub wide: f64,
    /// What was seen from where a hand left the camera.
    pub left: Option<Left>,
}

impl Look {
    /// The plane that cuts the picture open, where one does.
    pub fn cut(&self) -> Option<Section> {
        self.section.filter(|_| self.cuts && !matches!(self.mode, ViewMode::Slice(_)))
    }

    /// What the picture is built for.
    pub fn showing(&self) -> Showing {
        let section = self.section.filter(|_| self.cuts).map(|section| section.cut);
        Showing { view: self.mode, section, beside: self.beside }
    }
}

/// From where a hand left the camera.
pub struct Left {
    camera: Camera,
    /// Which of the scenes it was.
    swaps: u64,
    /// Where the sliders stood.
    values: Vec<f64>,
    when: Instant,
    /// Whether nothing is seen.
    pub blind: bool,
}

/// What moves is looked at no more often than this.
const GLANCE: Duration = Duration::from_millis(500);

/// Which panels are open, and what could be.
pub struct Open {
    /// The text and the problems.
    pub source: bool,
    /// The parameters.
    pub parameters: bool,
    /// What the scene measures.
    pub measures: bool,
    /// The scene's parts.
    pub outline: bool,
    /// The module that is emitted.
    pub shader: bool,
    /// What frames take.
    pub frames: bool,
    /// A grid over the picture.
    pub grid: bool,
    /// How large the text is written, in points.
    pub text_size: f32,
    /// Whether long lines of the text are wrapped.
    pub wrap: bool,
    /// How large all of the window is; 1 is as the system has it.
    pub zoom: f32,
    /// The look of it.
    pub theme: Choice,
    /// How wide the panels at the left and right are, in points.
    pub widths: [f32; 2],
    /// Only the picture.
    pub alone: bool,
    /// The page with which the program begins, in place of all else.
    pub start: bool,
    /// All keys.
    pub keys: bool,
    /// Whether the keyboard shall go to the first slider.
    pub to_sliders: bool,
    /// The steps of the ray of what was picked.
    pub ray: bool,
    /// The scenes beside the one that is open, as they were found last.
    pub beside: Vec<String>,
}

/// What is looked for in the text that is shown.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Search {
    /// As it is typed: a word, or after a colon a line.
    pub wanted: String,
    /// What was found last, in bytes of the text; where the cursor was, before anything is.
    pub at: Range<usize>,
    /// What shall stand in its place, while that is asked for.
    pub instead: Option<String>,
    /// Whether capitals count.
    pub case: bool,
    /// Whether only whole words are meant.
    pub whole: bool,
}

impl Search {
    /// The word that is looked for; empty where it is a line.
    pub fn word(&self) -> &str {
        if self.wanted.starts_with(':') { "" } else { &self.wanted }
    }
}

/// What must be answered before anything else.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Question {
    /// The window shall close, and there are unsaved edits.
    Close,
    /// Another scene shall be opened, and there are unsaved edits.
    Open(String),
    /// A new scene shall begin, and there are unsaved edits: its name without an ending, and its text.
    New(String, String),
    /// A text shall be closed that has unsaved edits.
    CloseText(String),
}

/// What a path is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// A scene to open.
    Open,
    /// Where the text that is shown is to be written.
    SaveAs,
    /// Where the picture is to be written.
    Picture,
}

/// A path that a person is asked for.
#[derive(Clone, Debug)]
pub struct PathAsked {
    /// What for.
    pub purpose: Purpose,
    /// The folder that is looked into.
    pub folder: PathBuf,
    /// What is typed: a name in that folder, or a path.
    pub typed: String,
    /// What the folder holds: names, and whether each is a folder.
    pub entries: Vec<(String, bool)>,
    /// Of a picture: its size, and whether it is one of many.
    pub wanted: Wanted,
}

impl PathAsked {
    /// The path that is meant. What has no ending is a scene.
    pub fn path(&self) -> PathBuf {
        let path = self.folder.join(self.typed.trim());
        // A picture is never written over a scene.
        if self.purpose == Purpose::Picture && Format::of(&path).is_none() && !path.is_dir() {
            return path.with_extension("png");
        }
        if self.typed.ends_with(['/', '\\']) || path.is_dir() || path.extension().is_some() { path } else { path.with_extension("sdf") }
    }
}

/// What drawing takes.
#[derive(Clone, Debug, Default)]
pub struct Meter {
    /// The last picture's time, from the order to its end.
    pub frame: Duration,
    /// Those of the last pictures, in seconds, the newest last.
    pub frames: VecDeque<f32>,

    /// Its width and height in pixels.
    pub size: (u32, u32),
    /// Whether all pixels are drawn: not while something moves that is slow to draw.
    pub sharp: bool,
    /// How many pictures are in it, each through other places of its pixels.
    pub samples: u32,
    /// The adapter's name.
    pub adapter: String,
    /// Whether the adapter is a program.
    pub software: bool,
}

impl Meter {
    /// So many times are kept.
    pub const KEPT: usize = 120;

    /// Notes what a picture took, once.
    pub fn note(&mut self, frame: Duration) {
        // No two take the same to the nanosecond.
        if frame != self.frame {
            self.frame = frame;
            self.frames.push_back(frame.as_secs_f32());
            while self.frames.len() > Self::KEPT {
                self.frames.pop_front();
            }
        }
    }
}

impl Session {
    /// A window on a scene whose text is not known yet.
    pub fn new(scene: Document) -> Self {
        let mut stage = Stage::new();
        stage.playing = true;
        Self {
            documents: Documents { all: vec![scene], shown: 0, jump: None, focus: false },
            stage,
            said: Said::default(),
            look: Look { wide: f64::INFINITY, divider: 0.5, ..Look::default() },
            open: Open { source: true, parameters: true, measures: false, outline: false, shader: false, frames: false, grid: false, ray: true, text_size: TEXT_SIZE, wrap: false, zoom: 1.0, theme: Choice::Dark, widths: [470.0, 250.0], alone: false, start: false, keys: false, to_sliders: false, beside: Vec::new() },
            search: None,
            asked: None,
            recent: Vec::new(),
            restoring: None,
            question: None,
            notice: None,
            timeline: Timeline::default(),
            options: Options::default(),
            meter: Meter::default(),
            found: Vec::new(),
            measuring: Measuring::default(),
            export: Export::default(),
            looking: Looking::default(),
            held: None,
            parts: Parts::default(),
            passes: Passes::default(),
            truth: Truth::default(),
            holding: None,
            holds: 0,
        }
    }

    /// Whether the scene that is drawn changes with time.
    pub fn moves(&self) -> bool {
        self.said.reads_time || self.stage.balls().is_some()
    }

    /// Lets so many seconds pass. At the end of a timeline that loops time begins anew, but not where balls would be left behind.
    pub fn advance(&mut self, seconds: f64) {
        self.stage.advance(seconds);
        let Timeline { length, loops } = self.timeline;
        if loops && self.stage.playing && self.stage.balls().is_none() && self.stage.time() >= length {
            self.stage.set_time(self.stage.time().rem_euclid(length));
        }
    }

    /// The scene that is drawn.
    pub fn scene(&self) -> Option<&Arc<Compiled>> {
        self.stage.scene()
    }

    /// Where the picture is seen from.
    pub fn camera(&self) -> Option<Camera> {
        if let Some(orbit) = &self.look.orbit {
            return Some(orbit.camera());
        }
        let scene = self.scene()?;
        let frame = scene.frame(self.stage.live()?);
        let named = |name: &String| frame.cameras.iter().find(|(known, _)| known == name);
        let found = self.look.camera.as_ref().and_then(named).or_else(|| frame.cameras.first());
        found.map(|(_, camera)| scene.camera_in(*camera, self.look.wide))
    }

    /// Looks whether anything is in sight from where a hand left the camera. Once for each place, and now and then where the scene moves: it takes
    /// some milliseconds.
    pub fn look_around(&mut self) {
        let Some(camera) = self.look.orbit.as_ref().map(Orbit::camera) else {
            self.look.left = None;
            return;
        };
        let Some((scene, live)) = self.scene().zip(self.stage.live()) else { return };
        let (swaps, moves) = (self.said.swaps, self.stage.animates());
        let is_known = |left: &Left| {
            let same = (left.camera, left.swaps) == (camera, swaps) && left.values == live.components;
            if moves { left.when.elapsed() < GLANCE } else { same }
        };
        if !self.look.left.as_ref().is_some_and(is_known) {
            let blind = is_blind(scene, live, &camera);
            self.look.left = Some(Left { camera, swaps, values: live.components.clone(), when: Instant::now(), blind });
        }
    }

    /// The factors of the scene that is drawn, with their places, as large as they are for the values at hand.
    pub fn factors(&self) -> impl Iterator<Item = (&Place, Explained)> {
        let at_hand = self.scene().zip(self.stage.live());
        self.said.factors.iter().map(move |(place, factor)| {
            let live = at_hand.map_or(factor.live, |(scene, live)| live.factor(&scene.graph, factor.index));
            (place, Explained { live, ..factor.clone() })
        })
    }

    /// A parameter of the scene that is drawn.
    pub fn parameter(&self, name: &str) -> Option<&Parameter> {
        self.scene()?.parameters.iter().find(|p| p.name == name)
    }

    /// The name that a parameter has chosen.
    pub fn choice<'a>(&'a self, parameter: &'a Parameter) -> Option<&'a str> {
        let asked = self.options.choose.iter().find(|(name, _)| *name == parameter.name);
        // What was chosen may not be there any more.
        let asked = asked.map(|(_, choice)| choice).filter(|choice| parameter.choices.contains(choice));
        asked.map(String::as_str).or_else(|| parameter.choice())
    }

    /// Whether a parameter has another value than the text gives it.
    pub fn is_moved(&self, parameter: &Parameter) -> bool {
        if is_held(parameter) {
            return false;
        }
        match self.stage.value(parameter) {
            Some(value) => value != parameter.default,
            None => self.choice(parameter) != parameter.choice(),
        }
    }

    /// The file's own parameters that were moved, each with what the text is to say of it.
    pub fn moved(&self) -> Vec<(String, Written)> {
        let parameters = self.scene().map_or(&[][..], |scene| &scene.parameters);
        let written = |p: &Parameter| {
            let chosen = || self.choice(p).map(|choice| Written::Choice(choice.to_owned()));
            let written = self.stage.value(p).map(|value| p.written(value)).or_else(chosen)?;
            Some((p.name.clone(), written))
        };
        parameters.iter().filter(|p| !p.name.contains('.') && self.is_moved(p)).filter_map(written).collect()
    }

    /// The first error, if there is one: the picture is then that of an older text.
    pub fn error(&self) -> Option<&Problem> {
        self.said.problems.iter().find(|p| p.severity == Severity::Error)
    }

    /// The scene's texts, those that are open first.
    pub fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = self.documents.all.iter().map(|d| d.name.clone()).collect();
        for file in &self.said.words.files {
            if file.ends_with(".sdf") && !names.contains(file) {
                names.push(file.clone());
            }
        }
        names
    }

    /// Whether any text has edits that are not on the disk.
    pub fn is_unsaved(&self) -> bool {
        self.documents.all.iter().any(Document::is_unsaved)
    }
}

impl Documents {
    /// The text that is shown.
    pub fn current(&self) -> &Document {
        // There is always one, and `shown` is always within.
        &self.all[self.shown.min(self.all.len() - 1)]
    }

    /// The same, to change it.
    pub fn current_mut(&mut self) -> &mut Document {
        let last = self.all.len() - 1;
        &mut self.all[self.shown.min(last)]
    }

    /// Whether the edits of a text are lost where a question is answered so.
    pub fn is_at_stake(&self, question: &Question, document: &Document) -> bool {
        let is_meant = !matches!(question, Question::CloseText(name) if *name != document.name);
        is_meant && document.is_unsaved()
    }

    /// A text by its name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.all.iter().position(|d| d.name == name)
    }
}

/// The factors of a scene with their places in the texts that it was compiled from.
pub fn factors(compiled: &Compiled, words: &Words) -> Vec<(Place, Explained)> {
    let explained = surefoot_compiler::factors::explain(compiled, &words.sources);
    explained.into_iter().map(|factor| (place(words, factor.span), factor)).collect()
}

/// A fix as the window makes it: in one text, and in none of the compiler's own.
fn mend(words: &Words, fix: &diagnostic::Fix) -> Option<Mend> {
    let file = fix.edits.first()?.span.file;
    let source = words.sources.get(file).filter(|source| !source.name.starts_with('<'))?;
    let mut edits: Vec<_> = fix.edits.iter().filter(|edit| edit.span.file == file).map(|edit| (edit.span.range(), edit.text.clone())).collect();
    edits.sort_by_key(|(range, _)| range.start);
    let is_one = edits.len() == fix.edits.len();
    is_one.then(|| Mend { title: fix.title.clone(), file: source.name.clone(), of: source.text.clone(), edits })
}

/// The compiler's words as the window shows them.
pub fn problems(words: &Words) -> Vec<Problem> {
    let problem = |d: &diagnostic::Diagnostic| {
        Problem {
            severity: d.severity,
            code: d.code.row().name,
            message: d.message.clone(),
            help: d.help.clone(),
            place: place(words, d.span),
            mends: d.fixes.iter().filter_map(|fix| mend(words, fix)).collect(),
        }
    };
    let mut problems: Vec<Problem> = diagnostic::shown(&words.diagnostics).0.into_iter().map(problem).collect();
    // Errors first: they are why the picture is not that of the text.
    problems.sort_by_key(|p| p.severity != Severity::Error);
    problems
}
