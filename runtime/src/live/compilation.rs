//! One run of the compiler over the newest text, and how long what it says of a file is held back.

use crate::live::record::Recorder;
use crate::live::state::{Setup, Shared};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::Outcome;
use surefoot_compiler::source::Sources;

/// How long an error in a file that changed just now is held back.
pub(super) const DOUBT: Duration = Duration::from_millis(50);
/// The same of a scene's file that is empty or not there: who saves it is about to write it, and may be held up on a busy machine.
pub(super) const LONGER_DOUBT: Duration = Duration::from_millis(250);
/// Deep nesting takes stack, here and in naga.
pub(super) const STACK: usize = 64 << 20;

/// What came of one run of the compiler.
pub(super) struct Compilation {
    /// What it read.
    pub recorder: Recorder,
    pub outcome: Outcome,
    /// What went wrong with the compiler itself.
    pub failure: Option<String>,
    /// How long it took, without what the camera sees.
    pub took: Duration,
}

impl Compilation {
    /// Of the newest text.
    pub fn run(setup: &Setup, shared: &Shared) -> Self {
        let (path, options, texts) = {
            let mut state = shared.lock();
            state.report.compilations += 1;
            (state.path.clone(), state.options.clone(), state.texts.clone())
        };
        let recorder = Recorder::new(setup.loader.clone(), texts);
        let start = Instant::now();
        let compile = || (setup.compile)(&recorder, &path, &options);
        let (mut outcome, failure) = match catch_unwind(AssertUnwindSafe(compile)) {
            Ok(outcome) => (outcome, None),
            Err(panic) => (nothing(&path), Some(broken("the compiler", panic.as_ref()))),
        };
        let took = start.elapsed();
        // What the camera sees is worth a word, and no failure.
        let _ = catch_unwind(AssertUnwindSafe(|| outcome.look()));
        Self { recorder, outcome, failure, took }
    }
}

/// The outcome of a compiler that did not come to its end.
fn nothing(path: &str) -> Outcome {
    Outcome {
        sources: Sources::default(),
        diagnostics: Vec::new(),
        files: vec![path.to_owned()],
        compiled: None,
    }
}

/// What is said where a part of Surefoot panicked.
pub(super) fn broken(what: &str, panic: &(dyn Any + Send)) -> String {
    let words = panic
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("no reason given");
    format!("a mistake in Surefoot, please report it: {what} stopped with: {words}")
}
