//! Times as tables say them, and scenes that are read from memory so that no disk is timed.

use crate::files::FileLoader;
use std::time::Duration;
use surefoot_compiler::{Loader, MemoryLoader, Outcome};

pub(super) fn in_memory(outcome: &Outcome) -> MemoryLoader {
    let read = |loader: MemoryLoader, path: &String| match FileLoader.read(path) {
        Ok(bytes) => loader.with(path, bytes),
        Err(_) => loader,
    };
    outcome.files.iter().fold(MemoryLoader::new(), read)
}

/// The time that so many of a hundred runs did not exceed. `sorted` is in ascending order.
pub(super) fn percentile(sorted: &[Duration], percent: usize) -> Duration {
    let rank = (sorted.len() * percent).div_ceil(100).max(1);
    sorted.get(rank - 1).copied().unwrap_or_default()
}

pub(super) fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
