//! The thread that compiles: the newest text of each scene, after a moment in which nothing changes.

use crate::texts::OpenTexts;
use std::collections::BTreeMap;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};
use surefoot_compiler::Memory;
use surefoot_compiler::language_service::{Report, examine};

/// Nothing is compiled while edits follow each other this fast.
const PAUSE: Duration = Duration::from_millis(80);
/// But after so long something is, so that a person who types on sees it too.
const LONGEST: Duration = Duration::from_millis(600);
/// Room for programs that nest deeply; it grows on its own.
const STACK: usize = 16 << 20;

/// A scene to compile.
pub(super) struct Job {
    /// Its path.
    pub(super) path: String,
    /// The version of its text.
    pub(super) version: i32,
    /// All texts as they are.
    pub(super) texts: OpenTexts,
}

/// What came of it.
pub(super) struct Done {
    /// The scene's path.
    pub(super) path: String,
    /// The version of its text.
    pub(super) version: i32,
    /// What the compiler says; none where it gave up.
    pub(super) report: Option<Report>,
}

/// What the thread is told.
pub(super) enum Order {
    /// Compile this, and no older text of it.
    Compile(Job),
    /// Forget a scene.
    Forget(String),
}

/// Starts the thread. It ends when what `start` answers is dropped, or `tell` says that nobody listens.
pub(super) fn start(tell: impl Fn(Done) -> bool + Send + 'static) -> io::Result<Sender<Order>> {
    let (sender, orders) = channel();
    std::thread::Builder::new().name("surefoot lsp compiler".to_owned()).stack_size(STACK).spawn(move || work(&orders, &tell))?;
    Ok(sender)
}

fn work(orders: &Receiver<Order>, tell: &dyn Fn(Done) -> bool) {
    let mut waiting: BTreeMap<String, Job> = BTreeMap::new();
    let mut memories: BTreeMap<String, Memory> = BTreeMap::new();
    loop {
        if waiting.is_empty() {
            let Ok(order) = orders.recv() else { return };
            take(order, &mut waiting, &mut memories);
            let since = Instant::now();
            while since.elapsed() < LONGEST {
                match orders.recv_timeout(PAUSE) {
                    Ok(order) => take(order, &mut waiting, &mut memories),
                    Err(RecvTimeoutError::Timeout) => break,
                    Err(RecvTimeoutError::Disconnected) => return,
                }
            }
        }
        // What came while another scene was compiled is newer.
        while let Ok(order) = orders.try_recv() {
            take(order, &mut waiting, &mut memories);
        }
        let Some((path, Job { version, texts, .. })) = waiting.pop_first() else { continue };
        let memory = memories.entry(path.clone()).or_default();
        let report = catch_unwind(AssertUnwindSafe(|| examine(&texts, &path, memory))).ok();
        if report.is_none() {
            memories.remove(&path);
        }
        if !tell(Done { path, version, report }) {
            return;
        }
    }
}

fn take(order: Order, waiting: &mut BTreeMap<String, Job>, memories: &mut BTreeMap<String, Memory>) {
    match order {
        Order::Compile(job) => {
            waiting.insert(job.path.clone(), job);
        }
        Order::Forget(path) => {
            waiting.remove(&path);
            memories.remove(&path);
        }
    }
}
