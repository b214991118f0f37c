//! The window on a screen that is none: another program saves the scene, a hand drags a slider and types.
//!
//! Needs Xvfb, xdotool and a graphics adapter (a program will do). Prints how long it takes from a save to the first new picture.
#![cfg(all(feature = "gui", target_os = "linux"))]

use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant, SystemTime};

const SCENE: &str = "\
param size = 1 in 0.2..2
material paint { color: #d02010, roughness: 1 }
scene = sphere(size).material(paint)
camera { eye: (0, 0, 8), target: (0, 0, 0), fov: 40deg }
";

/// The middle of the picture, in pixels of the screen.
const MIDDLE: (u32, u32) = (750, 406);
/// The left end of the first slider's rail, and its middle.
const SLIDER: ((u32, u32), (u32, u32)) = ((1042, 104), (1110, 104));
/// Somewhere in the text.
const TEXT: (u32, u32) = (250, 400);

/// Processes that end with the test, even where it fails.
struct Ended(Child);

impl Drop for Ended {
    fn drop(&mut self) {
        self.0.kill().ok();
        self.0.wait().ok();
    }
}

/// One window at a time: they would share the cores, and the times would say nothing.
static ALONE: Mutex<()> = Mutex::new(());

struct Window {
    folder: PathBuf,
    display: String,
    _program: Ended,
    _screen: Ended,
    _alone: MutexGuard<'static, ()>,
}

impl Window {
    fn open(test: &str) -> Self {
        let alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("window").join(test);
        std::fs::remove_dir_all(&folder).ok();
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("scene.sdf"), SCENE).unwrap();
        let mut screen = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("these tests need Xvfb: apt-get install xvfb xdotool imagemagick");
        let mut number = String::new();
        BufReader::new(screen.stdout.take().unwrap()).read_line(&mut number).unwrap();
        let screen = Ended(screen);
        let display = format!(":{}", number.trim());
        let mut program = Command::new(env!("CARGO_BIN_EXE_surefoot"));
        program.current_dir(&folder).args(["scene.sdf", "--log", "log.jsonl"]);
        program.env("DISPLAY", &display).env_remove("WAYLAND_DISPLAY").stdin(Stdio::null());
        if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
            program.env("XDG_RUNTIME_DIR", &folder);
        }
        let program = Ended(program.spawn().unwrap());
        let window = Self { folder, display, _program: program, _screen: screen, _alone: alone };
        window.picture(|frame| frame["swaps"] == 1);
        window.hand(&["windowfocus", "--sync", &window.id()]);
        window
    }

    fn scene(&self) -> PathBuf {
        self.folder.join("scene.sdf")
    }

    /// What happened so far.
    fn log(&self) -> Vec<Value> {
        let text = std::fs::read_to_string(self.folder.join("log.jsonl")).unwrap_or_default();
        // The last line may be half written.
        text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
    }

    /// Waits for an event.
    fn wait(&self, so: impl Fn(&Value) -> bool) -> Value {
        let start = Instant::now();
        loop {
            if let Some(event) = self.log().into_iter().find(&so) {
                return event;
            }
            assert!(start.elapsed() < Duration::from_secs(30), "it did not come: {:?}", self.log());
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Waits for a picture.
    fn picture(&self, so: impl Fn(&Value) -> bool) -> Value {
        self.wait(|event| event["event"] == "frame" && so(event))
    }

    fn id(&self) -> String {
        let found = Command::new("xdotool")
            .args(["search", "--sync", "--onlyvisible", "--name", "Surefoot"])
            .env("DISPLAY", &self.display)
            .output()
            .expect("these tests need xdotool");
        String::from_utf8_lossy(&found.stdout).lines().next().unwrap_or_default().to_owned()
    }

    fn hand(&self, args: &[&str]) {
        let done =
            Command::new("xdotool").args(args).env("DISPLAY", &self.display).status().unwrap();
        assert!(done.success(), "{args:?}");
        // A hand is not so fast that two of its moves fall into one frame.
        std::thread::sleep(Duration::from_millis(120));
    }

    fn point(&self, (x, y): (u32, u32)) {
        self.hand(&["mousemove", &x.to_string(), &y.to_string()]);
    }

    /// What the screen shows.
    fn screen(&self, name: &str) -> image::RgbImage {
        let path = self.folder.join(name).with_extension("png");
        let mut import = Command::new("import");
        import.args(["-window", "root"]).arg(&path).env("DISPLAY", &self.display);
        assert!(import.status().expect("these tests need imagemagick").success());
        image::open(path).unwrap().to_rgb8()
    }

    /// Waits until the middle of the picture is of a kind, and answers what the screen shows then.
    fn see(&self, name: &str, so: impl Fn([u8; 3]) -> bool) -> image::RgbImage {
        let start = Instant::now();
        loop {
            let screen = self.screen(name);
            let middle = screen.get_pixel(MIDDLE.0, MIDDLE.1).0;
            if so(middle) {
                return screen;
            }
            assert!(start.elapsed() < Duration::from_secs(20), "{name}: {middle:?}");
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

fn now() -> f64 {
    SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap().as_secs_f64()
}

fn red([r, g, b]: [u8; 3]) -> bool {
    r > 60 && r / 2 > g && r / 2 > b
}

fn blue([r, g, b]: [u8; 3]) -> bool {
    b > 60 && b / 2 > r && b > g
}

#[test]
fn another_program_saves_and_the_picture_follows() {
    let window = Window::open("save");
    window.see("first", red);
    let mut times = Vec::new();
    for turn in 0..10u64 {
        let color = if turn % 2 == 0 { "#2010d0" } else { "#d02010" };
        // Another radius each time: nothing of it was built before.
        let size = format!("sphere(size * 1.{turn})");
        let text = SCENE.replace("#d02010", color).replace("sphere(size)", &size);
        std::fs::write(window.scene(), text).unwrap();
        let saved = now();
        let shown = window.picture(|frame| frame["swaps"] == turn + 2);
        times.push((shown["at"].as_f64().unwrap() - saved) * 1e3);
        window.see("saved", if turn % 2 == 0 { blue } else { red });
    }
    times.sort_by(f64::total_cmp);
    println!(
        "from a save to the first new picture: median {:.0} ms, worst {:.0} ms",
        times[5], times[9]
    );

    // An error keeps the picture, and the window goes on.
    std::fs::write(window.scene(), SCENE.replace("sphere", "spere")).unwrap();
    let broken = window.wait(|event| event["errors"] == 1);
    assert_eq!(broken["swapped"], false);
    window.see("error", red);
    std::fs::write(window.scene(), SCENE.replace("#d02010", "#2010d0")).unwrap();
    window.see("mended", blue);
}

#[test]
fn a_slider_moves_the_picture_and_builds_no_pipeline() {
    let window = Window::open("slider");
    window.see("first", red);
    let before = window.log().last().cloned().unwrap();
    let (left, middle) = SLIDER;
    window.point(middle);
    window.hand(&["mousedown", "1"]);
    for part in 1..=5 {
        window
            .point((middle.0 - (middle.0 - left.0) * part / 5 - u32::from(part == 5) * 10, left.1));
    }
    window.hand(&["mouseup", "1"]);
    // The ball is small now: beside the middle there is sky.
    let start = Instant::now();
    let beside = |screen: &image::RgbImage| screen.get_pixel(MIDDLE.0 + 70, MIDDLE.1).0;
    while red(beside(&window.screen("slider"))) {
        assert!(start.elapsed() < Duration::from_secs(10), "the slider moved nothing");
    }
    let after = window.log().last().cloned().unwrap();
    assert!(after["frame"].as_u64() > before["frame"].as_u64());
    assert_eq!(after["pipelines"], before["pipelines"]);
    assert_eq!(after["modules"], before["modules"]);
    assert_eq!(window.log().iter().filter(|e| e["event"] == "compiled").count(), 1);

    // Nothing moves any more, so nothing is drawn.
    std::thread::sleep(Duration::from_secs(1));
    let rests = window.log().len();
    std::thread::sleep(Duration::from_secs(2));
    assert_eq!(window.log().len(), rests);
}

#[test]
fn what_is_typed_is_seen_and_saved() {
    let window = Window::open("typed");
    window.see("first", red);
    window.point(TEXT);
    window.hand(&["click", "1"]);
    window.hand(&["key", "ctrl+End"]);
    window.hand(&["type", "--delay", "40", "material paint2 { color: #2010d0 }"]);
    assert_eq!(std::fs::read_to_string(window.scene()).unwrap(), SCENE);
    window.hand(&["key", "ctrl+s"]);
    let typed = format!("{SCENE}material paint2 {{ color: #2010d0 }}");
    let start = Instant::now();
    while std::fs::read_to_string(window.scene()).unwrap() != typed {
        assert!(
            start.elapsed() < Duration::from_secs(10),
            "{:?}",
            std::fs::read_to_string(window.scene())
        );
        std::thread::sleep(Duration::from_millis(20));
    }
    window.screen("typed");
}
