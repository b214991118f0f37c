//! What a person or the world outside asks of the session.

use crate::window::document::{Disk, Resolution};
use crate::window::orbit::Side;
use crate::window::session::{Mend, Place, Search};
use std::path::PathBuf;
use std::sync::Arc;
use surefoot_runtime::ViewMode;
use surefoot_runtime::live::{Update, Words};

/// Balls of one drop.
pub const DROP: u32 = 64;

/// One thing to do.
#[derive(Debug)]
pub enum Command {
    /// The text that is shown was edited.
    Edit(String),
    /// Write the text that is shown to the disk.
    Save,
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
    /// Measure the scene as it is now.
    Measure {
        /// Whether its walls and gaps are looked for too.
        walls: bool,
    },
    /// Find out which scenes lie beside the one that is open.
    LookAround,
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
