//! A progress bar for long work.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// A progress bar on stderr that is seen only where the work takes longer than a second.
pub struct LateBar {
    start: Instant,
    bar: ProgressBar,
    shown: Mutex<bool>,
}

impl LateBar {
    const STEPS: u64 = 1000;

    /// A bar that nobody sees yet.
    pub fn new() -> Self {
        let bar = ProgressBar::with_draw_target(Some(Self::STEPS), ProgressDrawTarget::hidden());
        if let Ok(style) =
            ProgressStyle::with_template("{bar:40} {percent:>3} %  {elapsed} / {duration}")
        {
            bar.set_style(style);
        }
        Self { start: Instant::now(), bar, shown: Mutex::new(false) }
    }

    /// Hears which part of the work is done.
    pub fn show(&self, part: f64) {
        if let Ok(mut shown) = self.shown.lock()
            && !*shown
            && self.start.elapsed() > Duration::from_secs(1)
        {
            *shown = true;
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.bar.set_position((part * Self::STEPS as f64) as u64);
    }

    /// Does something while the bar is not seen.
    #[cfg(feature = "gpu")]
    pub fn hide<T>(&self, work: impl FnOnce() -> T) -> T {
        self.bar.suspend(work)
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
