//! Longer searches for smaller factors, behind the window's back: the picture stays the same, and its rays take longer steps.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, mpsc};
use surefoot_compiler::Compiled;

/// How many boxes each factor may cost, in turn.
const BOXES: [usize; 3] = [2_048, 16_384, 131_072];
/// Deep nesting takes stack.
const STACK: usize = 64 << 20;

/// A search in the background. It ends when it is dropped.
#[derive(Debug)]
pub struct Tightening {
    found: mpsc::Receiver<Vec<f64>>,
    stop: Arc<AtomicBool>,
}

impl Tightening {
    /// Begins to search. None where no factor of the scene can become smaller.
    pub fn start(scene: Arc<Compiled>) -> Option<Self> {
        if (0..scene.graph.factors.len()).all(|i| !scene.can_tighten(i)) {
            return None;
        }
        let (sender, found) = mpsc::channel();
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = stop.clone();
        let search = move || {
            let mut factors: Vec<f64> = scene.graph.factors.iter().map(|f| f.lipschitz).collect();
            for boxes in BOXES {
                for (i, factor) in factors.iter_mut().enumerate() {
                    if stopped.load(Ordering::Relaxed) {
                        return;
                    }
                    *factor = factor.min(scene.tighten(i, boxes));
                }
                if sender.send(factors.clone()).is_err() {
                    return;
                }
            }
        };
        let thread = std::thread::Builder::new().name("surefoot factors".to_owned()).stack_size(STACK);
        // Without a thread the first factors stay, which are proven too.
        thread.spawn(search).ok().map(|_| Self { found, stop })
    }

    /// The newest factors that were found since the last call: numbers for [`surefoot_compiler::Live::tightened`].
    pub fn newest(&self) -> Option<Vec<f64>> {
        self.found.try_iter().last()
    }
}

impl Drop for Tightening {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}
