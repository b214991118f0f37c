//! Work on all of the processor's cores.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Does tasks on all of the processor's cores. Each thread has something of its own to work with, as `make` makes it. Answers in order.
pub fn spread<W, R: Send>(tasks: usize, make: &(dyn Fn() -> W + Sync), work: &(dyn Fn(&mut W, usize) -> R + Sync)) -> Vec<R> {
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get()).min(tasks);
    let next = AtomicUsize::new(0);
    let run = || {
        let mut own = make();
        let mut done = Vec::new();
        loop {
            let task = next.fetch_add(1, Ordering::Relaxed);
            if task >= tasks {
                return done;
            }
            done.push((task, work(&mut own, task)));
        }
    };
    let mut all: Vec<(usize, R)> = std::thread::scope(|scope| {
        // Where the system has no more threads to give, this one does what is left.
        let others: Vec<_> = (1..threads).filter_map(|_| std::thread::Builder::new().spawn_scoped(scope, run).ok()).collect();
        let own = run();
        let others = others.into_iter().flat_map(|thread| thread.join().unwrap_or_else(|fault| std::panic::resume_unwind(fault)));
        own.into_iter().chain(others).collect()
    });
    all.sort_by_key(|(task, _)| *task);
    all.into_iter().map(|(_, answer)| answer).collect()
}
