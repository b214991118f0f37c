//! Longer searches for smaller factors, behind the window's back: the picture stays the same, and its rays take longer steps.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, mpsc};
use surefoot_compiler::Compiled;
use surefoot_compiler::compiled::Live;
use surefoot_compiler::live::Followed;

/// How many boxes each factor may cost, in turn, for the whole ranges of the parameters.
const BOXES: [usize; 3] = [2_048, 16_384, 131_072];
/// Deep nesting takes stack.
const STACK: usize = 64 << 20;

/// A search in the background. It ends when it is dropped.
#[derive(Debug)]
pub struct Tightening {
    found: mpsc::Receiver<Found>,
    orders: Arc<Orders>,
}

/// What a search found.
#[derive(Debug)]
enum Found {
    /// Factors for the whole ranges.
    Whole(Vec<f64>),
    /// Factors for where the parameters stand.
    Here(Followed),
}

/// What the search is told.
#[derive(Debug, Default)]
struct Orders {
    next: Mutex<Next>,
    heard: Condvar,
}

#[derive(Debug, Default)]
struct Next {
    stop: bool,
    /// Where the parameters stand now, if that is to be looked at.
    here: Option<Live>,
}

impl Orders {
    fn lock(&self) -> MutexGuard<'_, Next> {
        self.next.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Tightening {
    /// Begins to search. None where no factor of the scene can become smaller.
    pub fn start(scene: Arc<Compiled>) -> Option<Self> {
        if (0..scene.graph.factors.len()).all(|i| !scene.can_tighten(i) && !scene.is_live(i)) {
            return None;
        }
        let (sender, found) = mpsc::channel();
        let orders = Arc::new(Orders::default());
        let told = orders.clone();
        let thread = std::thread::Builder::new().name("surefoot factors".to_owned()).stack_size(STACK);
        // Without a thread the first factors stay, which are proven too.
        thread.spawn(move || search(&scene, &told, &sender)).ok().map(|_| Self { found, orders })
    }

    /// Asks for a longer look at the factors where the parameters stand; what was asked before and is not begun is forgotten.
    pub fn ask(&self, live: &Live) {
        self.orders.lock().here = Some(live.clone());
        self.orders.heard.notify_one();
    }

    /// Takes the newest factors that were found since the last call. Answers whether more may come.
    pub fn take(&self, live: &mut Live) -> bool {
        loop {
            match self.found.try_recv() {
                Ok(Found::Whole(factors)) => live.tightened = factors,
                Ok(Found::Here(followed)) => live.take(followed),
                Err(error) => return error == mpsc::TryRecvError::Empty,
            }
        }
    }
}

impl Drop for Tightening {
    fn drop(&mut self) {
        self.orders.lock().stop = true;
        self.orders.heard.notify_one();
    }
}

/// Searches until it is told to stop: first for where the parameters stand, as often as that is asked, then for their whole ranges.
fn search(scene: &Compiled, orders: &Orders, sender: &mpsc::Sender<Found>) {
    let mut factors: Vec<f64> = scene.graph.factors.iter().map(|f| f.lipschitz).collect();
    let mut left = BOXES.into_iter().flat_map(|boxes| (0..scene.graph.factors.len()).map(move |i| (boxes, i)));
    loop {
        let mut next = orders.lock();
        let more = loop {
            if next.stop {
                return;
            }
            if next.here.is_some() {
                break None;
            }
            if let Some(more) = left.next() {
                break Some(more);
            }
            next = orders.heard.wait(next).unwrap_or_else(PoisonError::into_inner);
        };
        let here = next.here.take();
        drop(next);
        let found = match (here, more) {
            (Some(mut live), _) => {
                scene.settle(&mut live);
                live.followed.map(Found::Here)
            }
            (None, Some((boxes, i))) => {
                factors.get_mut(i).into_iter().for_each(|factor| *factor = factor.min(scene.tighten(i, boxes)));
                (i + 1 == factors.len()).then(|| Found::Whole(factors.clone()))
            }
            _ => None,
        };
        if found.is_some_and(|found| sender.send(found).is_err()) {
            return;
        }
    }
}
