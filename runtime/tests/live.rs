//! Scenes that follow their files, with a compiler that is a toy: `radius 1.5` on a line makes a sphere, `import a` reads a file,
//! `bad` is an error, `panic` a mistake of ours.

mod common;

use common::{gpu, sphere, sphere_in};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::*;
use surefoot_compiler::diagnostic::{Code, Diagnostic};
use surefoot_compiler::source::{FileId, Sources, Span};
use surefoot_compiler::sampled::{Grid, Settings};
use surefoot_runtime::live::{LiveScene, Report, Setup, Update, Words, Work};
use surefoot_runtime::{Stage, View, ViewMode};

struct Disk;

impl Loader for Disk {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        fs::read(path).map_err(|e| e.to_string())
    }

    fn grid(&self, path: &str, settings: Settings) -> Result<Arc<Grid>, String> {
        surefoot_runtime::mesh::field::grid(self, path, settings, &|_| {})
    }
}

fn toy(loader: &dyn Loader, path: &str, _options: &Options) -> Outcome {
    let mut sources = Sources::default();
    let mut diagnostics = Vec::new();
    let mut files = vec![path.to_owned()];
    let mut radius = None;
    let mut next = 0;
    while let Some(file) = files.get(next).cloned() {
        next += 1;
        let mut wrong = |words: &str| {
            let span = Span::new(FileId(0), 0, 0);
            diagnostics.push(Diagnostic::new(Code::Unreadable, span, words, ""));
        };
        let Ok(bytes) = loader.read(&file) else {
            wrong(&format!("{file} can't be read"));
            continue;
        };
        let text = String::from_utf8(bytes).unwrap();
        sources.add(file.clone(), text.as_str());
        for line in text.lines() {
            match line.split_once(' ') {
                Some(("radius", r)) => radius = r.parse().ok(),
                Some(("import", name)) => {
                    let beside = Path::new(&file).parent().unwrap().join(name);
                    files.push(beside.to_str().unwrap().to_owned());
                }
                _ if line == "bad" => wrong("bad"),
                _ if line == "panic" => panic!("as asked"),
                _ => {}
            }
        }
    }
    let compiled = radius.filter(|_| diagnostics.is_empty()).map(sphere);
    Outcome { sources, diagnostics, files, compiled }
}

/// An empty folder of its own for each test.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn setup(path: &Path) -> Setup {
    Setup {
        path: path.to_str().unwrap().to_owned(),
        options: Options::default(),
        loader: Arc::new(Disk),
        compile: Arc::new(toy),
        target: None,
        mode: ViewMode::Normals,
        wake: Arc::new(|| {}),
    }
}

fn start(path: &Path) -> LiveScene {
    LiveScene::start(setup(path)).unwrap()
}

/// The next update, within ten seconds.
fn next(live: &LiveScene) -> Update {
    let start = Instant::now();
    loop {
        if let Some(update) = live.poll() {
            return update;
        }
        assert!(start.elapsed() < Duration::from_secs(10), "no update: {:?}", live.report());
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn radius(update: &Update) -> Option<f64> {
    Some(update.ready.as_ref()?.compiled.parameters[0].default[0])
}

/// Waits for a scene of this radius; no error may come before it.
fn expect(live: &LiveScene, want: f64) {
    expect_unless_held_up(live, want, Duration::ZERO);
}

/// The same, where the machine took so long to write: a file that is gone for longer than it is doubted is an error.
fn expect_unless_held_up(live: &LiveScene, want: f64, took: Duration) {
    loop {
        let update = next(live);
        assert!(took >= DOUBT || update.words.diagnostics.is_empty(), "{:?}", update.words.diagnostics);
        if radius(&update) == Some(want) {
            return;
        }
    }
}

/// Nothing may come for a while.
fn expect_silence(live: &LiveScene) {
    let start = Instant::now();
    while start.elapsed() < Duration::from_millis(250) {
        if let Some(update) = live.poll() {
            panic!("an update for nothing: {update:?}");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn pause(milliseconds: u64) {
    std::thread::sleep(Duration::from_millis(milliseconds));
}

#[test]
fn every_way_to_save_is_seen() {
    let folder = folder("ways");
    let path = folder.join("main.sdf");
    fs::write(&path, "radius 1").unwrap();
    let live = start(&path);
    expect(&live, 1.0);
    // In place.
    fs::write(&path, "radius 1.1").unwrap();
    expect(&live, 1.1);
    // Beside it, then in its place.
    for i in 2..6 {
        let new = folder.join("main.sdf~");
        fs::write(&new, format!("radius 1.{i}")).unwrap();
        fs::rename(&new, &path).unwrap();
        expect(&live, 1.0 + 0.1 * f64::from(i));
    }
    // The old one out of the way first, as some editors do.
    fs::rename(&path, folder.join("main.bak")).unwrap();
    fs::write(&path, "radius 1.6").unwrap();
    expect(&live, 1.6);
    // Empty for a while.
    fs::write(&path, "").unwrap();
    pause(25);
    fs::write(&path, "radius 1.7").unwrap();
    expect(&live, 1.7);
    // Gone for a while.
    fs::remove_file(&path).unwrap();
    pause(25);
    fs::write(&path, "radius 1.8").unwrap();
    expect(&live, 1.8);
    // Gone for long: that is said, and it comes back.
    fs::remove_file(&path).unwrap();
    let update = next(&live);
    assert_eq!(update.words.diagnostics.len(), 1);
    assert!(update.ready.is_none());
    fs::write(&path, "radius 1.9").unwrap();
    expect(&live, 1.9);
}

#[test]
fn a_file_behind_a_link_and_a_path_with_dots() {
    let folder = folder("links");
    fs::create_dir(folder.join("real")).unwrap();
    fs::create_dir(folder.join("scenes")).unwrap();
    fs::write(folder.join("real/a.sdf"), "radius 1").unwrap();
    let link = folder.join("scenes/a.sdf");
    #[cfg(unix)]
    std::os::unix::fs::symlink(folder.join("real/a.sdf"), &link).unwrap();
    let live = start(&folder.join("scenes/../scenes/./a.sdf"));
    expect(&live, 1.0);
    fs::write(folder.join("real/a.sdf"), "radius 1.5").unwrap();
    expect(&live, 1.5);
    fs::write(folder.join("real/b.sdf"), "radius 1.25").unwrap();
    fs::rename(folder.join("real/b.sdf"), folder.join("real/a.sdf")).unwrap();
    expect(&live, 1.25);
}

#[test]
fn imports_are_followed_even_before_they_exist() {
    let folder = folder("imports");
    let path = folder.join("main.sdf");
    fs::write(&path, "import parts/deep/a.sdf\nradius 1").unwrap();
    let live = start(&path);
    assert_eq!(next(&live).words.diagnostics.len(), 1);
    fs::create_dir(folder.join("parts")).unwrap();
    pause(100);
    fs::create_dir(folder.join("parts/deep")).unwrap();
    pause(100);
    fs::write(folder.join("parts/deep/a.sdf"), "radius 1.25").unwrap();
    expect(&live, 1.25);
    fs::write(folder.join("parts/deep/a.sdf"), "radius 1.5").unwrap();
    expect(&live, 1.5);
    // The whole folder replaced.
    let start = Instant::now();
    fs::remove_dir_all(folder.join("parts")).unwrap();
    fs::create_dir_all(folder.join("parts/deep")).unwrap();
    fs::write(folder.join("parts/deep/a.sdf"), "radius 1.75").unwrap();
    expect_unless_held_up(&live, 1.75, start.elapsed());
    let start = Instant::now();
    fs::rename(folder.join("parts"), folder.join("old")).unwrap();
    fs::create_dir_all(folder.join("parts/deep")).unwrap();
    fs::write(folder.join("parts/deep/a.sdf"), "radius 1.25").unwrap();
    expect_unless_held_up(&live, 1.25, start.elapsed());
    // What was followed through the old folder is no longer ours.
    fs::write(folder.join("old/deep/a.sdf"), "radius 2").unwrap();
    fs::write(folder.join("parts/deep/b.sdf"), "radius 2").unwrap();
    expect_silence(&live);
    // And after all that, the new one still is.
    fs::write(folder.join("parts/deep/a.sdf"), "radius 2").unwrap();
    expect(&live, 2.0);
}

#[test]
fn what_changes_nothing_costs_nothing() {
    let folder = folder("nothing");
    let path = folder.join("main.sdf");
    fs::write(&path, "radius 1").unwrap();
    let live = start(&path);
    expect(&live, 1.0);
    pause(50);
    let before = live.report();
    fs::write(folder.join("other.sdf"), "radius 2").unwrap();
    fs::write(&path, "radius 1").unwrap();
    expect_silence(&live);
    assert_eq!(live.report().compilations, before.compilations);
    // To read a file is no event: nothing turns in a circle.
    let before = live.report();
    pause(300);
    assert_eq!(live.report().events, before.events);
    // Nor does an editor that says again what it said.
    live.set_text(path.to_str().unwrap(), Some("radius 1".to_owned()));
    expect_silence(&live);
    assert_eq!(live.report().compilations, before.compilations);
}

/// How long a file may be empty or away before that is an error.
const DOUBT: Duration = Duration::from_millis(250);

/// A hundred saves a second, each in one of four ways, with a compiler that is slower than that.
#[test]
fn a_storm_of_saves_ends_with_the_last_one() {
    let folder = folder("storm");
    let path = folder.join("main.sdf");
    fs::write(&path, "radius 0.5\nimport part.sdf").unwrap();
    fs::write(folder.join("part.sdf"), "").unwrap();
    let mut setup = setup(&path);
    setup.compile = Arc::new(|loader, path, options| {
        let outcome = toy(loader, path, options);
        pause(15);
        outcome
    });
    let woken = Arc::new(AtomicU64::new(0));
    let ours = woken.clone();
    setup.wake = Arc::new(move || {
        ours.fetch_add(1, Ordering::Relaxed);
    });
    let live = LiveScene::start(setup).unwrap();
    expect(&live, 0.5);
    let last = 400u32;
    let value = |i: u32| 0.5 + f64::from(i) / 400.0;
    let writer = {
        let (folder, path) = (folder.clone(), path.clone());
        std::thread::spawn(move || {
            let mut held_up = 0;
            for i in 1..=last {
                let text = format!("radius {}\nimport part.sdf", value(i));
                match i % 4 {
                    0 => fs::write(&path, text).unwrap(),
                    1 => {
                        fs::write(folder.join("new"), text).unwrap();
                        fs::rename(folder.join("new"), &path).unwrap();
                    }
                    way => {
                        let hollow = Instant::now();
                        match way {
                            2 => fs::write(&path, "").unwrap(),
                            _ => fs::remove_file(&path).unwrap(),
                        }
                        pause(2);
                        fs::write(&path, text).unwrap();
                        held_up += u32::from(hollow.elapsed() >= DOUBT);
                    }
                }
                pause(8);
            }
            (Instant::now(), held_up)
        })
    };
    let (mut updates, mut errors) = (0, 0);
    let mut seen = 0.5;
    while seen < value(last) {
        let update = next(&live);
        updates += 1;
        if let Some(wrong) = update.words.diagnostics.first() {
            println!("{wrong:?}");
            errors += 1;
        }
        if let Some(radius) = radius(&update) {
            assert!(radius >= seen, "from {seen} back to {radius}");
            seen = radius;
        }
    }
    let (end, held_up) = writer.join().unwrap();
    let late = end.elapsed();
    let Report { events, compilations, replaced, .. } = live.report();
    println!(
        "{last} saves: {events} events, {compilations} compilations, {updates} updates taken, {replaced} replaced, \
         {errors} errors shown, {held_up} saves held up, the last save on after {late:?}"
    );
    // Where the machine let the writer wait in the middle of a save, the file was not there for so long.
    assert!(errors <= held_up, "a save that is half done is not an error");
    assert!(updates > 5, "the picture follows while the storm lasts");
    assert!(late < Duration::from_secs(2), "{late:?}");
    assert!(woken.load(Ordering::Relaxed) >= updates);
    expect_silence(&live);
}

#[test]
fn an_error_takes_nothing_away() {
    let folder = folder("errors");
    let path = folder.join("main.sdf");
    fs::write(&path, "radius 1").unwrap();
    let live = start(&path);
    expect(&live, 1.0);
    let name = path.to_str().unwrap();
    live.set_text(name, Some("bad".to_owned()));
    let update = next(&live);
    assert!(update.ready.is_none());
    assert_eq!(update.words.diagnostics[0].message, "bad");
    assert_eq!(update.words.files, [name]);
    // A good text that nobody takes, then a bad one: the good one must not be lost.
    live.set_text(name, Some("radius 1.5".to_owned()));
    while live.is_busy() {
        pause(1);
    }
    live.set_text(name, Some("bad".to_owned()));
    while live.is_busy() {
        pause(1);
    }
    let update = next(&live);
    assert_eq!(radius(&update), Some(1.5));
    assert_eq!(update.words.diagnostics.len(), 1);
    // Our own mistakes are no end either.
    live.set_text(name, Some("panic".to_owned()));
    let update = next(&live);
    assert!(update.ready.is_none());
    assert!(update.failure.is_some_and(|text| text.contains("as asked")));
    // And back to what is on the disk.
    live.set_text(name, None);
    let update = next(&live);
    assert_eq!((radius(&update), update.failure), (Some(1.0), None));
    // Another file.
    fs::write(folder.join("second.sdf"), "radius 2").unwrap();
    live.open(folder.join("second.sdf").to_str().unwrap());
    expect(&live, 2.0);
    fs::write(&path, "radius 1.25").unwrap();
    expect_silence(&live);
}

#[test]
fn unsaved_text_hides_the_file() {
    let folder = folder("unsaved");
    let path = folder.join("main.sdf");
    fs::write(&path, "import part.sdf").unwrap();
    fs::write(folder.join("part.sdf"), "radius 1").unwrap();
    let live = start(&path);
    expect(&live, 1.0);
    let part = folder.join("./part.sdf").to_str().unwrap().to_owned();
    live.set_text(&part, Some("radius 1.5".to_owned()));
    expect(&live, 1.5);
    fs::write(folder.join("part.sdf"), "radius 2").unwrap();
    expect_silence(&live);
    live.set_text(&part, None);
    expect(&live, 2.0);
}

#[test]
fn pipelines_are_built_behind_and_only_where_something_changed() {
    let folder = folder("pipelines");
    let path = folder.join("main.sdf");
    fs::write(&path, "radius 1").unwrap();
    let gpu = gpu();
    let mut setup = setup(&path);
    setup.target = Some((gpu.clone(), wgpu::TextureFormat::Rgba8Unorm));
    // A text that the compiler takes and the device refuses.
    setup.compile = Arc::new(|loader, path, options| {
        let mut outcome = toy(loader, path, options);
        let text = loader.read(path).unwrap_or_default();
        if text.ends_with(b"broken") {
            outcome.compiled = Some(sphere_in("fn nonsense(", 1.0, (0.5, 2.0)));
        }
        outcome
    });
    let live = LiveScene::start(setup).unwrap();
    let mut stage = Stage::new();
    let update = next(&live);
    assert!(update.times.pipeline > Duration::ZERO && update.times.total >= update.times.pipeline);
    stage.put(update.ready.unwrap());
    assert_eq!(gpu.stats().pipelines, 2, "that of the field, and that of its cones");
    let camera = stage.scene().unwrap().frame(stage.live().unwrap()).cameras[0].1;
    let view = View { camera, size: [32.0, 32.0], corner: [0.0; 2], sample: 0 };
    assert!(stage.update(gpu.queue(), &view), "a new scene is to be drawn");
    assert!(!stage.update(gpu.queue(), &view), "and then not again");
    // A slider, and time in a scene that does not read it.
    assert!(stage.set("radius", &[1.75]));
    assert!(stage.update(gpu.queue(), &view));
    stage.playing = true;
    stage.advance(1.0);
    assert!(!stage.animates() && !stage.update(gpu.queue(), &view));
    assert!(!stage.set("nothing", &[1.0]));
    // A text that gives the same module: everything is there already. The slider goes where the text says.
    fs::write(&path, "radius 1.25").unwrap();
    let update = next(&live);
    stage.put(update.ready.unwrap());
    assert_eq!(gpu.stats().pipelines, 2, "that of the field, and that of its cones");
    assert_eq!(stage.live().unwrap().components, [1.25]);
    assert_eq!(stage.time(), 1.0);
    assert!(stage.update(gpu.queue(), &view));
    assert!(stage.set("radius", &[1.75]));
    // Refused by the device: said, and the picture stays.
    fs::write(&path, "broken").unwrap();
    let update = next(&live);
    assert!(update.ready.is_none() && update.failure.is_some());
    // Another view of the last good scene: built, not compiled.
    let compilations = live.report().compilations;
    live.show(ViewMode::Steps);
    let ready = next(&live).ready.unwrap();
    assert_eq!(ready.picture.as_ref().unwrap().mode(), ViewMode::Steps);
    assert_eq!(ready.compiled.parameters[0].default, [1.25]);
    assert_eq!(live.report().compilations, compilations);
    assert_eq!(gpu.stats().pipelines, 3, "a view of looks has no cones");
    stage.put(ready);
    assert_eq!(stage.live().unwrap().components, [1.75]);
    drop(live);
}

#[test]
fn values_stay_by_name_and_within_the_new_range() {
    let ready =
        |compiled| surefoot_runtime::live::Ready { compiled: Arc::new(compiled), picture: None, balls: None };
    let wgsl = common::WGSL;
    let mut stage = Stage::new();
    stage.put(ready(sphere(1.0)));
    let value =
        |stage: &Stage| stage.value(&stage.scene().unwrap().parameters[0]).unwrap().to_vec();
    // Nobody moved it: it follows the text.
    stage.put(ready(sphere(1.5)));
    assert_eq!(value(&stage), [1.5]);
    assert!(stage.set("radius", &[0.75]));
    stage.put(ready(sphere_in(wgsl, 1.5, (0.25, 4.0))));
    assert_eq!(value(&stage), [0.75]);
    stage.put(ready(sphere(1.25)));
    assert_eq!(value(&stage), [1.25], "the text was changed after the slider");
    assert!(stage.set("radius", &[0.75]));
    stage.put(ready(sphere_in(wgsl, 1.25, (1.0, 1.5))));
    assert_eq!(value(&stage), [1.0], "clamped to the new range");
    assert!(stage.set("radius", &[f64::NAN]));
    assert_eq!(value(&stage), [1.0]);
    let mut renamed = sphere(1.25);
    renamed.parameters[0].name = "size".to_owned();
    stage.put(ready(renamed));
    assert_eq!(value(&stage), [1.25], "another name is another parameter");
}

#[test]
fn it_is_known_what_is_being_done_and_for_how_long() {
    let path = folder("work").join("a.sdf");
    fs::write(&path, "radius 1").unwrap();
    let gate = Arc::new(Mutex::new(()));
    let (held, other) = (gate.lock().unwrap(), gate.clone());
    let compile = move |loader: &dyn Loader, path: &str, options: &Options| {
        drop(other.lock());
        toy(loader, path, options)
    };
    let live = LiveScene::start(Setup { compile: Arc::new(compile), ..setup(&path) }).unwrap();
    let start = Instant::now();
    while live.work().is_none_or(|(_, time)| time < Duration::from_millis(20)) {
        assert!(start.elapsed() < Duration::from_secs(10), "nothing is done");
        std::thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(live.work().map(|(work, _)| work), Some(Work::Compiling));
    drop(held);
    next(&live);
    assert_eq!(live.work(), None);
}

#[test]
fn what_is_wrong_is_said_before_the_picture_is_built() {
    let folder = folder("said");
    let path = folder.join("main.toy");
    fs::write(&path, "bad\n").unwrap();
    // What a window finds that is woken while the picture is being built.
    let found: Arc<Mutex<Vec<(String, usize)>>> = Arc::default();
    let (live, seen) = (Arc::new(OnceLock::<LiveScene>::new()), found.clone());
    let woken = live.clone();
    let wake = move || {
        let Some(words) = woken.get().and_then(LiveScene::poll_words) else { return };
        let text = words.sources.iter().next().map(|(_, file)| file.text.to_string()).unwrap_or_default();
        seen.lock().unwrap().push((text, words.diagnostics.len()));
    };
    assert!(live.set(LiveScene::start(Setup { wake: Arc::new(wake), ..setup(&path) }).unwrap()).is_ok());
    let live = live.get().unwrap();
    assert_eq!(next(live).words.diagnostics.len(), 1);
    assert!(found.lock().unwrap().is_empty(), "of an error no picture is built");
    fs::write(&path, "radius 1.5\n").unwrap();
    expect(live, 1.5);
    assert_eq!(*found.lock().unwrap(), [("radius 1.5\n".to_owned(), 0)]);
    assert!(live.poll_words().is_none(), "what came with the update is not said again");
}

#[test]
fn what_is_wrong_with_a_newer_text_is_said_while_an_older_picture_is_built() {
    let folder = folder("overheard");
    let path = folder.join("main.toy");
    fs::write(&path, "radius 1\n").unwrap();
    let gate = Arc::new(Mutex::new(()));
    let (held, other) = (gate.lock().unwrap(), gate.clone());
    let live = Arc::new(OnceLock::<LiveScene>::new());
    let woken = live.clone();
    // Building goes on when the gate opens.
    let wake = move || {
        let is_worker = std::thread::current().name() == Some("surefoot live");
        if is_worker && woken.get().and_then(LiveScene::work).is_some_and(|(work, _)| work == Work::Building) {
            drop(other.lock());
        }
    };
    let target = Some((gpu(), surefoot_runtime::headless::FORMAT));
    assert!(live.set(LiveScene::start(Setup { wake: Arc::new(wake), target, ..setup(&path) }).unwrap()).is_ok());
    let live = live.get().unwrap();
    let said = |text: &str, wrong: usize| {
        let start = Instant::now();
        let is_it = |words: Arc<Words>| {
            let read = words.sources.iter().next().map(|(_, file)| file.text.to_string());
            read.as_deref() == Some(text) && words.diagnostics.len() == wrong
        };
        while !live.poll_words().is_some_and(is_it) {
            assert!(start.elapsed() < Duration::from_secs(10), "nothing is said: {:?}", live.report());
            std::thread::sleep(Duration::from_millis(1));
        }
        assert_eq!(live.work().map(|(work, _)| work), Some(Work::Building));
    };
    let name = path.to_str().unwrap();
    said("radius 1\n", 0);
    live.set_text(name, Some("bad\n".to_owned()));
    said("bad\n", 1);
    live.set_text(name, None);
    said("radius 1\n", 0);
    live.set_text(name, Some("radius 1\n".to_owned()));
    pause(100);
    assert!(live.poll_words().is_none(), "that is being built");
    live.set_text(name, None);
    // A file counts once it is quiet.
    fs::write(&path, "radius 2\nbad\n").unwrap();
    said("radius 2\nbad\n", 1);
    fs::write(&path, "radius 3\nbad\n").unwrap();
    said("radius 3\nbad\n", 1);
    drop(held);
    // With the older picture come its own words; the newer ones stay to be said, until the newest text is looked at, though it is the one that is shown.
    let update = next(live);
    assert_eq!(radius(&update), Some(1.0));
    fs::write(&path, "radius 1\n").unwrap();
    let start = Instant::now();
    while !next(live).words.diagnostics.is_empty() {
        assert!(start.elapsed() < Duration::from_secs(10), "the error stays");
    }
}
