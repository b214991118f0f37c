//! What a person or the world outside asks of the session.

use crate::window::document::{Disk, Resolution};
use crate::window::examples::Example;
use crate::window::export::Wanted;
use crate::window::holding::Number;
use crate::window::orbit::Side;
use crate::window::session::{Mend, Place, Purpose, Search, Timeline};
use crate::window::theme::Choice;
use std::path::PathBuf;
use std::sync::Arc;
use surefoot_compiler::section::Section;
use surefoot_runtime::ViewMode;
use surefoot_runtime::live::{Update, Words};

/// Balls of one drop.
pub const DROP: u32 = 64;

/// One thing to do.
#[derive(Debug)]
pub enum Command {
    /// The text that is shown was edited.
    Edit(String),
    /// The same by a hand that goes on: the picture follows it.
    EditOn(String),
    /// A hand takes a number of the text that is shown.
    HoldNumber(Number),
    /// It drags it: the text with the number that it is by now.
    DragNumber {
        /// The text.
        text: String,
        /// The number, which stands at the same place.
        number: Number,
    },
    /// It lets go of it.
    LetNumberGo,
    /// Write the text that is shown to the disk.
    Save,
    /// Write it under another name, and go on with that.
    SaveAs(String),
    /// Write the picture into a file: a film where its ending says so.
    SavePicture(PathBuf),
    /// How large that is, and whether each picture of the timeline gets a file.
    Picture(Wanted),
    /// Draw no further for a file.
    CancelPicture,
    /// The keyboard goes to the first slider, or it is there.
    ToSliders(bool),
    /// Ask for a path, or no longer.
    AskPath(Option<Purpose>),
    /// Look into a folder for it.
    LookInto(PathBuf),
    /// What is typed of it.
    TypePath(String),
    /// Begin with a new scene.
    New,
    /// Begin with a copy of an example.
    OpenExample(&'static Example),
    /// Show the page with which the program begins, or no longer.
    ShowStart(bool),
    /// Show all keys, or no longer.
    ShowKeys(bool),
    /// Choose the look of the window.
    Theme(Choice),
    /// How large all of the window is.
    Zoom(f32),
    /// How wide the panels at the left and right are.
    Widths([f32; 2]),
    /// Lay out the text that is shown.
    Format,
    /// End a conflict between edits and the disk.
    Resolve(Resolution),
    /// Write the edits beside the file, then show what is on the disk.
    KeepBoth,
    /// Take a text that was left behind as an edit of the one that is shown, or drop it.
    Recover {
        /// The file that holds it.
        file: PathBuf,
        /// Whether it is taken.
        keep: bool,
    },
    /// Show a text.
    Show(String),
    /// Show the next of the texts that are open, or the one before.
    Turnover {
        /// Whether it is the next.
        forth: bool,
    },
    /// Close a text, but for the scene's own.
    CloseText(String),
    /// How large the text is written, in points.
    TextSize(f32),
    /// Whether long lines of the text are wrapped.
    Wrap(bool),
    /// Show a place.
    Jump(Place),
    /// Mend a problem by the edits that its advice names.
    Mend(Mend),
    /// Give files other texts: their names and those texts.
    Rewrite(Vec<(String, String)>),
    /// The cursor is where it shall be.
    Jumped,
    /// Look for something in the text, or no longer.
    Search(Option<Search>),
    /// The keyboard goes to the text.
    Focus,
    /// It is there.
    Focused,
    /// Give a parameter a value.
    Set(String, Vec<f64>),
    /// Choose for a parameter among its names.
    Choose(String, String),
    /// Give a parameter back the value that the text gives it.
    Reset(String),
    /// The same for all.
    ResetAll,
    /// Write the values that a hand gave into the scene's text.
    KeepValues,
    /// Let time run or stand.
    Play(bool),
    /// Go to a moment.
    Time(f64),
    /// How long the timeline is, and whether it loops.
    Timeline(Timeline),
    /// One step of the balls.
    StepBalls,
    /// The balls back to where they begin.
    ResetBalls,
    /// More balls over a place of the picture: its points from the upper left corner, and the picture's size in them.
    DropBalls {
        /// Where.
        at: [f64; 2],
        /// Width and height.
        size: [u32; 2],
    },
    /// Take the ball that is seen at a place of the picture, if one is.
    TakeBall {
        /// Where.
        at: [f64; 2],
        /// Width and height.
        size: [u32; 2],
    },
    /// Pull it there, as far into the picture as it was.
    PullBall {
        /// Where.
        at: [f64; 2],
        /// Width and height.
        size: [u32; 2],
    },
    /// Let go of it: it flies on as fast as the hand went.
    ThrowBall {
        /// To the right and down, in parts of the picture's height a second.
        speed: [f64; 2],
    },
    /// Find out what made a pixel: its place from the picture's upper left corner, and the picture's size.
    Pick {
        /// Where.
        at: [f64; 2],
        /// Width and height.
        size: [u32; 2],
    },
    /// No longer show what was picked.
    Unpick,
    /// Show the steps of the ray of what was picked, or no longer.
    ShowRay(bool),
    /// Let a step of that ray stand out.
    ChooseStep(usize),
    /// Show that ray from a step on.
    Closer(usize),
    /// Turn around the target: by parts of the picture's height, to the right and down.
    Turn(f64, f64),
    /// Move sideways, likewise.
    Pan(f64, f64),
    /// Go nearer or farther by a factor.
    Dolly(f64),
    /// Look along an axis: from the front, from the right or from above.
    LookFrom(Side),
    /// Come nearer to what was picked, or see the whole solid.
    FrameSelection,
    /// Put the plane of a slice to a place along its axis.
    Slice(f64),
    /// Cut the picture open, or no longer.
    ShowSection(bool),
    /// Cut it open by this plane.
    Section(Section),
    /// Show another view right of the divider, or no longer.
    Beside(Option<ViewMode>),
    /// Put the divider to a part of the picture's width.
    Divide(f32),
    /// Show how far the picture is from what is certain of it, or no longer.
    ShowTruth(bool),
    /// Back to the scene's camera.
    Home,
    /// Write where the camera stands into the scene's text.
    KeepView,
    /// Look through a camera of the scene.
    Camera(String),
    /// Show something else of the scene.
    Mode(ViewMode),
    /// Open or close the panel of the source.
    ShowSource(bool),
    /// Open or close the panel of the parameters.
    ShowParameters(bool),
    /// Open or close the panel of the measures.
    ShowMeasures(bool),
    /// Open or close the panel of the scene's parts.
    ShowOutline(bool),
    /// Open or close the panel of the emitted module.
    ShowShader(bool),
    /// Open or close the panel of what frames take.
    ShowFrames(bool),
    /// Show a grid over the picture, or no longer.
    ShowGrid(bool),
    /// Leave a part out of the picture, or no longer: by its id.
    Hide(String, bool),
    /// Show one part alone, or no longer.
    Solo(Option<String>),
    /// Show all parts.
    ShowAllParts,
    /// Measure what each pass of a frame takes.
    MeasurePasses,
    /// Let rays go side by side, or not.
    Parallel(bool),
    /// Measure the scene as it is now.
    Measure {
        /// Whether its walls and gaps are looked for too.
        walls: bool,
    },
    /// Open another scene.
    Open(String),
    /// The answer to a question: save first, go on without, or stay.
    Answer(Answer),
    /// A notice was read.
    Dismiss,
    /// Something came from the compiler.
    Arrived(Box<Update>),
    /// The compiler said this of the newest text, whose picture is being built.
    Said(Arc<Words>),
    /// What the disk holds of a file.
    OnDisk(String, Disk),
    /// What went wrong when the picture was drawn, if anything.
    Drawn(Option<String>),
}

/// Answers to a [`Question`](crate::window::session::Question).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Save, then do it.
    Save,
    /// Do it, and lose the edits.
    Discard,
    /// Don't.
    Stay,
}
