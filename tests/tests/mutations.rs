//! No input makes the compiler panic, hang or fill the memory, and what it takes is right.
//!
//! `SUREFOOT_MUTATIONS=1000000` tries so many inputs (else a number that takes a few minutes), from seed `SUREFOOT_FIRST` (else 0)
//! on; `SUREFOOT_SEED=12345` tries and prints one. What fails is made smaller where that is quick, and saved in `tests/corpus/crashes`, whose files are tried first.

// Counting what an input allocates needs an allocator, whose calls are unsafe by nature.
#![allow(unsafe_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};
use surefoot_compiler::diagnostic::{self, Severity};
use surefoot_compiler::source::Sources;
use surefoot_compiler::{Compiled, MemoryLoader, Options, compile, syntax};
use surefoot_tests::clock::Stopwatch;
use surefoot_tests::mutations::{self, Corpus};

/// Inputs of an ordinary run.
const COUNT: u64 = 10_000;
/// The longest that one input may take, of the processor's time, where the yardstick takes no longer than `YARDSTICK`.
const LONGEST: Duration = Duration::from_secs(1);
/// How long the yardstick takes on an idle machine of today.
const YARDSTICK: Duration = Duration::from_millis(50);
/// What takes longer is asked so many times in all, and so is the yardstick. The least times count: what else the machine does adds to a time, and takes nothing off.
const TRIES: usize = 3;
/// The longest that one input may take by the clock; then the run is ended, for nothing else can stop it.
const GIVE_UP: Duration = Duration::from_secs(300);
/// The most that may be allocated at one time for one input.
const MOST_MEMORY: usize = 1 << 30;
/// What a thread gets where nobody asks for more.
const STACK: usize = 2 << 20;

/// Held by the test that runs: on a machine where all cores are busy with the other one an input takes a third more of the processor's time.
static ALONE: Mutex<()> = Mutex::new(());

/// The system's allocator, counting for each thread.
struct Counting;

thread_local! {
    static HELD: Cell<isize> = const { Cell::new(0) };
    static MOST: Cell<isize> = const { Cell::new(0) };
}

fn count(change: isize) {
    // A thread that ends has nothing to count with any more.
    let _ = HELD.try_with(|held| {
        held.set(held.get() + change);
        let _ = MOST.try_with(|most| most.set(most.get().max(held.get())));
    });
}

unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(-(layout.size() as isize));
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(size as isize - layout.size() as isize);
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name)
}

/// The texts of a folder by name, in order.
fn texts(name: &str) -> Vec<(String, Vec<u8>)> {
    let Ok(entries) = std::fs::read_dir(folder(name)) else { return Vec::new() };
    let mut paths: Vec<PathBuf> = entries.filter_map(|e| Some(e.ok()?.path())).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "sdf"));
    paths.sort();
    let file = |path: PathBuf| (path.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read(path).unwrap());
    paths.into_iter().map(file).collect()
}

fn corpus() -> Corpus {
    let folders = ["examples", "examples/parts", "compiler/prelude", "compiler/std", "tests/corpus/right"];
    let all: Vec<String> =
        folders.iter().flat_map(|f| texts(f)).map(|(_, bytes)| String::from_utf8(bytes).unwrap()).collect();
    assert!(all.len() > 10, "the corpus is gone");
    Corpus::new(all.iter().map(String::as_str))
}

/// Everything that an input is asked; says what is wrong.
fn check(bytes: &[u8]) -> Result<(), String> {
    let held = HELD.get();
    MOST.set(held);
    let timed = || {
        let watch = Stopwatch::start();
        let done = catch_unwind(AssertUnwindSafe(|| ask(bytes)));
        (done, watch.time())
    };
    let (done, mut time) = timed();
    let most = (MOST.get() - held) as usize;
    let mut longest = LONGEST;
    if time > LONGEST {
        // Other work on the same cores and memory makes a machine slower, for what is asked and for the yardstick.
        let yardstick = (1..TRIES).map(|_| {
            time = time.min(timed().1);
            yardstick()
        });
        let slower = yardstick.min().unwrap_or(YARDSTICK).as_secs_f64() / YARDSTICK.as_secs_f64();
        longest = LONGEST.mul_f64(slower.max(1.0));
    }
    let compiled = match done {
        Err(_) => return Err(format!("a panic: {}", PANIC.take())),
        Ok(wrong) => wrong?,
    };
    if most > MOST_MEMORY {
        return Err(format!("{} MiB of memory", most >> 20));
    }
    if time > longest {
        return Err(format!("{} ms of time, {} are allowed", time.as_millis(), longest.as_millis()));
    }
    compiled.map_or(Ok(()), |compiled| takes(&compiled.module.wgsl))
}

fn ask(bytes: &[u8]) -> Result<Option<Compiled>, String> {
    let mut loader = MemoryLoader::new().with("main.sdf", bytes);
    for (name, text) in PARTS.lock().unwrap().iter() {
        loader = loader.with(&format!("parts/{name}"), text.clone());
    }
    let outcome = compile(&loader, "main.sdf", &Options::default());
    let errors = outcome.diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
    if outcome.compiled.is_none() && errors == 0 {
        return Err("no scene, and no error that says why".to_owned());
    }
    if outcome.compiled.is_some() && errors > 0 {
        return Err("a scene in spite of errors".to_owned());
    }
    for diagnostic in &outcome.diagnostics {
        for span in diagnostic.labels.iter().map(|(span, _)| *span).chain([diagnostic.span]) {
            let text = outcome.sources.get(span.file).map(|file| &*file.text);
            if text.and_then(|t| t.get(span.start as usize..span.end as usize)).is_none() {
                return Err(format!("a place that is none, of {}: {span:?}", diagnostic.code.row().name));
            }
        }
    }
    diagnostic::render(&outcome.sources, &outcome.diagnostics, true);
    if let Some(compiled) = &outcome.compiled {
        COMPILED.fetch_add(1, Ordering::Relaxed);
        let uniforms = compiled.uniform_bytes(&compiled.live(), [0.0; 3]);
        if uniforms.chunks_exact(4).any(|c| !f32::from_le_bytes([c[0], c[1], c[2], c[3]]).is_finite()) {
            return Err("a uniform that is no finite number".to_owned());
        }
        compiled.frame(&compiled.live());
    }
    if let Ok(text) = std::str::from_utf8(bytes) {
        syntax::tokens(text);
        laid_out(text)?;
    }
    Ok(outcome.compiled)
}

/// The time of work that never changes and is none of the compiler's: naga reads and checks the same module many times.
fn yardstick() -> Duration {
    let watch = Stopwatch::start();
    for _ in 0..100 {
        takes(include_str!("../../runtime/src/passes/capture/levels.wgsl")).unwrap();
    }
    watch.time()
}

/// Whether naga takes a module. Its time is not the compiler's.
fn takes(wgsl: &str) -> Result<(), String> {
    let module = naga::front::wgsl::parse_str(wgsl).map_err(|e| format!("naga can't read the module: {}", e.emit_to_string(wgsl)))?;
    let flags = naga::valid::ValidationFlags::all();
    let mut validator = naga::valid::Validator::new(flags, naga::valid::Capabilities::empty());
    validator.validate(&module).map_err(|e| format!("naga refuses the module: {}", e.emit_to_string(wgsl)))?;
    Ok(())
}

/// Laying out what is laid out changes nothing.
fn laid_out(text: &str) -> Result<(), String> {
    let Ok(once) = syntax::format(text) else { return Ok(()) };
    match syntax::format(&once) {
        Ok(twice) if twice == once => Ok(()),
        Ok(_) => Err("laid out twice, it is another text".to_owned()),
        Err(found) => {
            let mut sources = Sources::default();
            sources.add("main.sdf", once.as_str());
            Err(format!("laid out, it is wrong: {}", diagnostic::render(&sources, &found, false)))
        }
    }
}

/// How many inputs are scenes.
static COMPILED: AtomicU64 = AtomicU64::new(0);

/// What the examples import.
static PARTS: Mutex<Vec<(String, Vec<u8>)>> = Mutex::new(Vec::new());

thread_local! {
    static PANIC: Cell<String> = const { Cell::new(String::new()) };
}

/// Keeps what a panic says, and where.
fn keep_panics() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        // Of a single input all is told.
        if std::thread::current().name() == Some("input") && number("SUREFOOT_SEED").is_none() {
            PANIC.set(info.to_string());
        } else {
            usual(info);
        }
    }));
    *PARTS.lock().unwrap() = texts("examples/parts");
}

/// Does something on a thread with a small stack.
fn with_small_stack<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().name("input".to_owned()).stack_size(STACK);
        thread.spawn_scoped(scope, work).unwrap().join().unwrap()
    })
}

/// What failures have in common that have the same cause, most likely.
fn class(wrong: &str) -> String {
    wrong.lines().next().unwrap_or_default().chars().filter(|c| !c.is_ascii_digit()).collect()
}

/// The same failure in fewer bytes, as far as a few seconds go.
fn smaller(mut bytes: Vec<u8>, wrong: &str) -> Vec<u8> {
    let begin = Instant::now();
    let mut size = bytes.len() / 2;
    while size > 0 {
        let mut at = 0;
        while at < bytes.len() {
            if begin.elapsed() > Duration::from_secs(10) {
                return bytes;
            }
            let mut less = bytes.clone();
            less.drain(at..(at + size).min(bytes.len()));
            match check(&less) {
                Err(other) if class(&other) == class(wrong) => bytes = less,
                _ => at += size,
            }
        }
        size /= 2;
    }
    bytes
}

fn save(name: &str, bytes: &[u8]) -> PathBuf {
    let crashes = folder("tests/corpus/crashes");
    std::fs::create_dir_all(&crashes).unwrap();
    let path = crashes.join(format!("{name}.sdf"));
    std::fs::write(&path, bytes).unwrap();
    path
}

fn number(variable: &str) -> Option<u64> {
    std::env::var(variable).ok().map(|value| value.parse().unwrap_or_else(|_| panic!("{variable}={value} is no number")))
}

#[test]
fn what_once_failed_does_not_fail_again() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    keep_panics();
    let wrong: Vec<String> = with_small_stack(|| {
        let check = |(name, bytes): (String, Vec<u8>)| Some(format!("{name}: {}", check(&bytes).err()?));
        texts("tests/corpus/crashes").into_iter().filter_map(check).collect()
    });
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn no_input_is_too_much() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    keep_panics();
    let corpus = corpus();
    if let Some(seed) = number("SUREFOOT_SEED") {
        let (kind, bytes) = mutations::input(seed, &corpus);
        eprintln!("{kind:?}\n{}", String::from_utf8_lossy(&bytes));
        with_small_stack(|| check(&bytes)).unwrap();
        return;
    }
    let count = number("SUREFOOT_MUTATIONS").unwrap_or(COUNT);
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    let first = number("SUREFOOT_FIRST").unwrap_or(0);
    let next = AtomicU64::new(first);
    // What each thread is at, and since when: a run that dies leaves it on the disk, one that hangs is ended by the clock.
    let at: Vec<Mutex<Option<(u64, Instant)>>> = (0..threads).map(|_| Mutex::new(None)).collect();
    let failures = Mutex::new(BTreeSet::new());
    let left = |thread: usize| Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("input-{thread}.sdf"));
    std::thread::scope(|scope| {
        let mut running = Vec::new();
        for (thread, at) in at.iter().enumerate() {
            let (next, failures, corpus, left) = (&next, &failures, &corpus, &left);
            let work = move || {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= first + count || failures.lock().unwrap().len() >= 10 {
                        break;
                    }
                    let (kind, bytes) = mutations::input(seed, corpus);
                    std::fs::write(left(thread), &bytes).unwrap();
                    *at.lock().unwrap() = Some((seed, Instant::now()));
                    let result = check(&bytes);
                    *at.lock().unwrap() = None;
                    let Err(wrong) = result else { continue };
                    if !failures.lock().unwrap().insert(class(&wrong)) {
                        continue;
                    }
                    let path = save(&format!("{kind:?}-{seed}").to_lowercase(), &smaller(bytes, &wrong));
                    eprintln!("seed {seed}, saved as {}: {wrong}", path.display());
                }
                let _ = std::fs::remove_file(left(thread));
            };
            let builder = std::thread::Builder::new().name("input".to_owned()).stack_size(STACK);
            running.push(builder.spawn_scoped(scope, work).unwrap());
        }
        while running.iter().any(|thread| !thread.is_finished()) {
            std::thread::sleep(Duration::from_millis(50));
            for (thread, at) in at.iter().enumerate() {
                let Some((seed, since)) = *at.lock().unwrap() else { continue };
                if since.elapsed() > GIVE_UP {
                    let path = save(&format!("hang-{seed}"), &std::fs::read(left(thread)).unwrap());
                    eprintln!("seed {seed} does not end; saved as {}", path.display());
                    std::process::exit(101);
                }
            }
        }
    });
    let failures = failures.into_inner().unwrap();
    assert!(failures.is_empty(), "inputs failed in {} ways, one of each is shown above", failures.len());
    let compiled = COMPILED.load(Ordering::Relaxed);
    println!("{count} inputs, of which {compiled} compile");
    assert!(count < 1000 || compiled > count / 100, "only {compiled} of {count} inputs compile, so this tries little");
}
