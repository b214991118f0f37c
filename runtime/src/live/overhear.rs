//! What is wrong with a text that is written while the picture of an older one is still being built: said at once, and not after it.
//! Building may take seconds, compiling takes milliseconds.

use super::worker::{Compilation, DOUBT, STACK, wait};
use super::{Setup, Shared, Words};
use std::sync::Arc;
use std::thread::Scope;
use std::time::{Duration, Instant};

/// How long it sleeps at most.
const NAP: Duration = Duration::from_millis(50);

/// What was heard last: how many texts were pushed, and the newest event of the file system.
type Heard = (u64, Option<Instant>);

/// Listens, on a thread of its own, for as long as a picture is being built.
pub(super) fn start<'scope>(scope: &'scope Scope<'scope, '_>, setup: Setup, shared: Arc<Shared>) {
    shared.lock().building = true;
    let listen = move || {
        let mut last = None;
        while let Some(heard) = next(&shared, last) {
            last = Some(heard);
            say(&setup, &shared);
        }
    };
    // Where no thread can be had it is said later.
    let _ = std::thread::Builder::new().name("surefoot ears".to_owned()).stack_size(STACK).spawn_scoped(scope, listen);
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
        state = wait(shared, state, NAP);
    }
}

/// Compiles what is there now, and says what the compiler says of it.
fn say(setup: &Setup, shared: &Shared) {
    let Compilation { recorder, outcome, failure, .. } = Compilation::run(setup, shared);
    // A file that is empty or gone is most likely about to be written.
    if failure.is_some() || recorder.is_hollow() {
        return;
    }
    let mut state = shared.lock();
    if state.building {
        let words = Arc::new(Words::of(outcome, &recorder).0);
        state.words = Some(words.clone());
        state.overheard = Some(words);
        drop(state);
        (setup.wake)();
    }
}
