//! A window on a screen that is none, and a hand before it. Needs Xvfb, xdotool, imagemagick and a graphics adapter (a program will do).
#![allow(dead_code)]

use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// The middle of the picture, in pixels of the screen.
pub const MIDDLE: (u32, u32) = (750, 406);

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

/// The program `surefoot` with its window, on a screen of its own.
pub struct Window {
    /// Where the scene lies, and what the window says of itself.
    pub folder: PathBuf,
    display: String,
    program: Ended,
    _screen: Ended,
    _alone: MutexGuard<'static, ()>,
}

impl Window {
    /// Opens a window on `scene.sdf`, in a folder of its own with these files; comes back when the first picture is drawn.
    pub fn open(test: &str, files: &[(&str, &str)]) -> Self {
        let alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("window").join(test);
        std::fs::remove_dir_all(&folder).ok();
        std::fs::create_dir_all(&folder).unwrap();
        for (name, text) in files {
            std::fs::write(folder.join(name), text).unwrap();
        }
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
        let program = start(&folder, &display);
        let window = Self { folder, display, program, _screen: screen, _alone: alone };
        window.wait_for_first();
        window
    }

    /// Kills the program, which hears nothing of it, and starts it again.
    pub fn kill_and_start(&mut self) {
        self.program.0.kill().unwrap();
        self.program.0.wait().unwrap();
        std::fs::remove_file(self.folder.join("log.jsonl")).unwrap();
        self.program = start(&self.folder, &self.display);
        self.wait_for_first();
    }

    fn wait_for_first(&self) {
        self.picture(|frame| frame["swaps"] == 1);
        self.hand(&["windowfocus", "--sync", &self.id()]);
    }

    /// What the program has written on standard error.
    pub fn errors(&self) -> String {
        std::fs::read_to_string(self.folder.join("errors.txt")).unwrap()
    }

    /// The texts that are kept for recovery.
    pub fn kept(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder.join("state/surefoot/recovery")).into_iter().flatten().flatten();
        let texts = entries.map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|e| e == "txt"));
        texts.filter_map(|path| std::fs::read_to_string(path).ok()).collect()
    }

    /// The scene's file.
    pub fn scene(&self) -> PathBuf {
        self.folder.join("scene.sdf")
    }

    /// What happened so far.
    pub fn log(&self) -> Vec<Value> {
        let text = std::fs::read_to_string(self.folder.join("log.jsonl")).unwrap_or_default();
        // The last line may be half written.
        text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
    }

    /// Waits for an event.
    pub fn wait(&self, so: impl Fn(&Value) -> bool) -> Value {
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
    pub fn picture(&self, so: impl Fn(&Value) -> bool) -> Value {
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

    /// What a hand does, as xdotool has it.
    pub fn hand(&self, args: &[&str]) {
        let done =
            Command::new("xdotool").args(args).env("DISPLAY", &self.display).status().unwrap();
        assert!(done.success(), "{args:?}");
        // A hand is not so fast that two of its moves fall into one frame.
        std::thread::sleep(Duration::from_millis(120));
    }

    /// Moves the pointer.
    pub fn point(&self, (x, y): (u32, u32)) {
        self.hand(&["mousemove", &x.to_string(), &y.to_string()]);
    }

    /// Whether the program still runs, and the memory that it holds, in MiB.
    pub fn lives(&mut self) -> Option<u64> {
        if self.program.0.try_wait().unwrap().is_some() {
            return None;
        }
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.program.0.id())).ok()?;
        let held = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
        Some(held.trim().split(' ').next()?.parse::<u64>().ok()? >> 10)
    }

    /// What the screen shows.
    pub fn screen(&self, name: &str) -> image::RgbImage {
        let path = self.folder.join(name).with_extension("png");
        let mut import = Command::new("import");
        import.args(["-window", "root"]).arg(&path).env("DISPLAY", &self.display);
        assert!(import.status().expect("these tests need imagemagick").success());
        image::open(path).unwrap().to_rgb8()
    }

    /// Waits until the middle of the picture is of a kind, and answers what the screen shows then.
    pub fn see(&self, name: &str, so: impl Fn([u8; 3]) -> bool) -> image::RgbImage {
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

/// Starts the program in a folder, on a screen.
fn start(folder: &Path, display: &str) -> Ended {
    let mut program = Command::new(env!("CARGO_BIN_EXE_surefoot"));
    program.current_dir(folder).args(["scene.sdf", "--log", "log.jsonl"]);
    program.env("DISPLAY", display).env_remove("WAYLAND_DISPLAY").env("XDG_STATE_HOME", folder.join("state"));
    program.stdin(Stdio::null()).stderr(std::fs::File::create(folder.join("errors.txt")).unwrap());
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        program.env("XDG_RUNTIME_DIR", folder);
    }
    Ended(program.spawn().unwrap())
}

/// The colour of a red ball.
pub fn red([r, g, b]: [u8; 3]) -> bool {
    r > 60 && r / 2 > g && r / 2 > b
}

/// The colour of a blue one.
pub fn blue([r, g, b]: [u8; 3]) -> bool {
    b > 60 && b / 2 > r && b > g
}
