//! How long something takes, whatever else the machine does.

use std::time::{Duration, Instant};

/// Measures the processor's time of this thread; the clock's where the system does not say.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    begin: Instant,
    had: Duration,
}

impl Stopwatch {
    /// Starts now.
    pub fn start() -> Self {
        let begin = Instant::now();
        Self { begin, had: had(begin) }
    }

    /// The time since the start.
    pub fn time(&self) -> Duration {
        had(self.begin) - self.had
    }
}

/// The processor's time that this thread has had in all, or the time since `begin`.
fn had(begin: Instant) -> Duration {
    let said = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = said.and_then(|s| s.split(' ').next()?.parse().ok());
    nanoseconds.map_or_else(|| begin.elapsed(), Duration::from_nanos)
}
