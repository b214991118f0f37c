//! What is wrong with a text that is written while the picture of an older one is still being built: said at once, and not after it.
//! Building may take seconds, compiling takes milliseconds.

use crate::live::compilation::{Compilation, DOUBT, LONGER_DOUBT, STACK};
use crate::live::state::{Setup, Shared, Words};
use std::sync::Arc;
use std::thread::Scope;
use std::time::{Duration, Instant};

/// How long it sleeps at most.
const NAP: Duration = Duration::from_millis(50);

/// What was heard last: how many texts were pushed, and the newest event of the file system.
type Heard = (u64, Option<Instant>);

/// What ends the listening when it goes.
pub(super) struct Ears<'a>(&'a Shared);

impl Drop for Ears<'_> {
    fn drop(&mut self) {
        self.0.lock().building = false;
        self.0.changed.notify_all();
    }
}

/// Listens, on a thread of its own, until what it answers is dropped. `built`: of the text whose picture is being built.
pub(super) fn start<'scope, 'a>(scope: &'scope Scope<'scope, '_>, setup: Setup, shared: &'a Arc<Shared>, built: Arc<Words>) -> Ears<'a> {
    shared.lock().building = true;
    let other = shared.clone();
    let listen = move || {
        let mut last = None;
        while let Some(heard) = next(&other, last) {
            last = say(&setup, &other, &built).then_some(heard);
        }
    };
    // Where no thread can be had it is said later.
    let _ = std::thread::Builder::new().name("surefoot ears".to_owned()).stack_size(STACK).spawn_scoped(scope, listen);
    Ears(shared)
}

/// Waits for something newer. None: the picture is built.
fn next(shared: &Shared, last: Option<Heard>) -> Option<Heard> {
    let mut state = shared.lock();
    loop {
        if !state.building || state.stop {
            return None;
        }
        let heard = (state.report.pushes, state.last_event);
        // What was pushed is whole. What was saved is, once nothing more comes.
        let whole = state.pushed || state.last_event.is_none_or(|at| at.elapsed() >= DOUBT);
        if state.asked.is_some() && whole && last != Some(heard) {
            return Some(heard);
        }
        state = shared.wait(state, NAP);
    }
}

/// Compiles what is there now, and says what the compiler says of it. Answers whether that is all there is to say of it.
fn say(setup: &Setup, shared: &Shared, built: &Words) -> bool {
    let Compilation { recorder, outcome, failure, .. } = Compilation::run(setup, shared);
    let mut state = shared.lock();
    // A file that is empty or gone is most likely about to be written.
    if recorder.is_hollow() && !state.pushed && state.last_event.is_some_and(|at| at.elapsed() < LONGER_DOUBT) {
        drop(shared.wait(state, NAP));
        return false;
    }
    if state.building && failure.is_none() {
        let words = Arc::new(Words::of(outcome, &recorder).0);
        let texts = |words: &Words| words.sources.iter().map(|(_, file)| (file.name.clone(), file.text.clone())).collect::<Vec<_>>();
        // What is there again is being built already; that something else was said is taken back.
        let newer = texts(&words) != texts(built);
        let before = state.overheard.take();
        if newer || before.is_some() {
            state.words = Some(words.clone());
        }
        state.overheard = newer.then_some(words);
        drop(state);
        (setup.wake)();
    }
    true
}
