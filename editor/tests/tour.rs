//! A tour through the window, as a person would go in the first hour: on a screen that is none, with a hand that types, drags and clicks.
//!
//! Needs what the window's tests need. With `SUREFOOT_PICTURES` set it writes the pictures of `docs/editor.md`.
#![cfg(all(feature = "gui", target_os = "linux"))]

mod screen;

use screen::{MIDDLE, Window, blue, red};
use std::path::Path;
use std::time::{Duration, Instant};

const SCENE: &str = "\
import \"ground.sdf\" as ground
param size = 1.00 in 0.2..2
material paint { color: #d02010, roughness: 1 }
scene = sphere(size).material(paint) | ground.ground
camera { eye: (0, 1, 8), target: (0, 0, 0), fov: 40deg }
";

const GROUND: &str = "/// What it stands on.\nshape ground = box(4, 0.1, 4).translate(0, -1.4, 0)\n";

/// A letter of the text is so wide and a line so high, in pixels; the first letter's upper left corner.
const LETTER: (f64, f64) = (7.8, 17.0);
const FIRST: (f64, f64) = (39.0, 72.0);

/// The middle of a letter of a line, both from 0.
fn letter(line: u32, column: u32) -> (u32, u32) {
    let at = |first: f64, step: f64, n: u32| step.mul_add(f64::from(n) + 0.5, first) as u32;
    (at(FIRST.0, LETTER.0, column), at(FIRST.1, LETTER.1, line))
}

fn until(what: &str, so: impl FnMut() -> bool) {
    within(20, what, so);
}

/// Waits so many seconds at most.
fn within(seconds: u64, what: &str, mut so: impl FnMut() -> bool) {
    let start = Instant::now();
    while !so() {
        assert!(start.elapsed() < Duration::from_secs(seconds), "{what}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// A hand waits until it sees what it did: longer on a machine on which others work, too.
fn pause() {
    let load = std::fs::read_to_string("/proc/loadavg").ok().and_then(|text| text.split(' ').next()?.parse::<f64>().ok()).unwrap_or(1.0);
    let cores = std::thread::available_parallelism().map_or(1.0, |cores| cores.get() as f64);
    std::thread::sleep(Duration::from_secs_f64(0.35 * (load / cores).clamp(1.0, 4.0)));
}

/// Presses keys, one after the other.
fn keys(window: &Window, keys: &[&str]) {
    for key in keys {
        window.hand(&["key", key]);
        pause();
    }
}

fn type_in(window: &Window, text: &str) {
    window.hand(&["type", "--delay", "20", text]);
    pause();
}

/// Presses a key that asks for something, and waits until it is asked: all else is darker then.
fn ask(window: &Window, key: &str) {
    let shown = || window.screen("asked").get_pixel(240, 560).0;
    let before = shown();
    window.hand(&["key", key]);
    until("it is asked", || shown() != before);
    pause();
}

fn click(window: &Window, at: (u32, u32)) {
    window.point(at);
    window.hand(&["click", "1"]);
    pause();
}

fn text(window: &Window, name: &str) -> String {
    std::fs::read_to_string(window.folder.join(name)).unwrap_or_default()
}

/// Saves, and waits until the file is so.
fn saved(window: &Window, so: impl Fn(&str) -> bool) {
    keys(window, &["ctrl+s"]);
    until("it is saved", || so(&text(window, "scene.sdf")));
}

/// How many scenes were compiled so far, and how many of the last one's errors there are.
fn compiled(window: &Window) -> (usize, u64) {
    let log = window.log();
    let all: Vec<_> = log.iter().filter(|event| event["event"] == "compiled").collect();
    (all.len(), all.last().and_then(|event| event["errors"].as_u64()).unwrap_or(0))
}

/// Waits until the picture is fine, and keeps it for the page of the editor where that is wanted and the page shows it.
fn show(window: &Window, name: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let page = std::fs::read_to_string(folder.join("editor.md")).unwrap();
    let is_shown = std::env::var_os("SUREFOOT_PICTURES").is_some() && page.contains(&format!("(editor/{name}.png)"));
    std::thread::sleep(Duration::from_millis(if is_shown { 3000 } else { 300 }));
    let shown = window.screen(name);
    if is_shown {
        std::fs::create_dir_all(folder.join("editor")).unwrap();
        // One whole window; of the others the part where something happens.
        let picture = match name {
            "window" | "outline" => image::imageops::resize(&shown, 960, 600, image::imageops::FilterType::CatmullRom),
            _ => image::imageops::crop_imm(&shown, 0, 0, 900, 420).to_image(),
        };
        picture.save(folder.join("editor").join(name).with_extension("png")).unwrap();
    }
}

fn pixels(window: &Window, name: &str, so: impl Fn([u8; 3]) -> bool) -> usize {
    window.screen(name).pixels().filter(|pixel| so(pixel.0)).count()
}

#[test]
fn a_first_hour() {
    let mut window = Window::open("first_hour", &[("scene.sdf", SCENE), ("ground.sdf", GROUND)]);
    window.see("opened", red);
    show(&window, "window");

    // An error is underlined, and its advice is taken.
    click(&window, letter(3, 70));
    keys(&window, &["ctrl+g"]);
    type_in(&window, "4");
    keys(&window, &["Return"]);
    for _ in 0.."scene = sp".len() {
        window.hand(&["key", "Right"]);
    }
    let before = compiled(&window).0;
    keys(&window, &["Delete"]);
    until("the error is known", || compiled(&window).0 > before && compiled(&window).1 == 1);
    window.see("error", red);
    show(&window, "error");
    assert!(pixels(&window, "underlined", |[r, g, b]| r > 200 && g < 130 && b < 130) > 40, "it is underlined in red");
    keys(&window, &["ctrl+period"]);
    until("the advice mends it", || compiled(&window).1 == 0);
    saved(&window, |text| text == SCENE);

    // A number is dragged, and the picture follows while the hand still holds it.
    let swaps = |window: &Window| window.log().iter().filter_map(|event| event["swaps"].as_u64()).max().unwrap_or(0);
    let before = swaps(&window);
    window.point(letter(1, 15));
    window.hand(&["keydown", "ctrl"]);
    window.hand(&["mousedown", "1"]);
    for step in 1..=10 {
        let (x, y) = letter(1, 15);
        window.point((x + 18 * step, y));
    }
    until("the picture follows", || swaps(&window) > before);
    show(&window, "number");
    window.hand(&["mouseup", "1"]);
    window.hand(&["keyup", "ctrl"]);
    pause();
    keys(&window, &["ctrl+s"]);
    until("the number is written", || text(&window, "scene.sdf").contains("param size = 1.3"));
    click(&window, letter(1, 40));
    keys(&window, &["ctrl+z"]);
    saved(&window, |text| text == SCENE);

    // A colour is picked by its square.
    let (x, y) = letter(2, 24);
    click(&window, (x + 3, y));
    show(&window, "colour");
    keys(&window, &["ctrl+a"]);
    type_in(&window, "#2010d0");
    window.see("blue", blue);
    keys(&window, &["Return", "ctrl+z"]);
    window.see("red again", red);

    // A slider moves by its keys, the camera by the hand.
    click(&window, letter(1, 40));
    let before = window.log().len();
    keys(&window, &["F6", "Right", "Right", "Right"]);
    until("it is drawn anew", || window.log().len() > before);
    window.point(MIDDLE);
    window.hand(&["mousedown", "1"]);
    for step in 1..=4 {
        window.point((MIDDLE.0 + 25 * step, MIDDLE.1 + 12 * step));
    }
    window.hand(&["mouseup", "1"]);
    pause();
    keys(&window, &["Home"]);

    // Each view.
    let shaded = pixels(&window, "shaded", red);
    for view in ["2", "3", "4"] {
        keys(&window, &[&format!("ctrl+{view}")]);
        until("another view", || pixels(&window, "view", red) < shaded / 2);
        show(&window, &format!("view{view}"));
    }
    keys(&window, &["ctrl+1"]);
    until("the first view", || pixels(&window, "view", red) > shaded / 2);

    // The ball is cut open, and two views stand beside each other.
    keys(&window, &["c"]);
    until("it is cut open", || pixels(&window, "section", red) < shaded / 2);
    show(&window, "section");
    keys(&window, &["w"]);
    pause();
    show(&window, "two_views");
    keys(&window, &["w", "c"]);
    until("it is whole again", || pixels(&window, "view", red) > shaded / 2);

    // The scene's parts, and the module beside the text.
    click(&window, letter(3, 20));
    let before = pixels(&window, "narrow", red);
    keys(&window, &["ctrl+shift+o", "ctrl+shift+g"]);
    until("the module takes its room", || pixels(&window, "narrow", red) != before);
    pause();
    show(&window, "outline");
    keys(&window, &["ctrl+shift+g", "ctrl+shift+o"]);
    until("the picture has its room", || pixels(&window, "narrow", red).abs_diff(before) < before / 50);

    // Find and replace, all at once.
    click(&window, letter(1, 40));
    keys(&window, &["ctrl+Home", "ctrl+h"]);
    type_in(&window, "paint");
    show(&window, "replace");
    keys(&window, &["Tab", "Tab", "Tab", "Tab", "Tab", "Tab"]);
    type_in(&window, "coat");
    keys(&window, &["ctrl+Return", "Escape"]);
    saved(&window, |text| *text == SCENE.replace("paint", "coat"));

    // The imported text in a tab of its own.
    keys(&window, &["ctrl+End", "Up", "Up", "End", "F12"]);
    pause();
    show(&window, "tabs");
    keys(&window, &["ctrl+Tab"]);

    // Another program changes the file, without edits here and with some.
    let theirs = SCENE.replace("#d02010", "#2010d0");
    std::fs::write(window.scene(), &theirs).unwrap();
    window.see("theirs", blue);
    keys(&window, &["ctrl+End"]);
    type_in(&window, "// mine");
    std::fs::write(window.scene(), SCENE).unwrap();
    pause();
    pause();
    show(&window, "conflict");
    keys(&window, &["ctrl+s"]);
    assert_eq!(text(&window, "scene.sdf"), SCENE, "no save decides it");

    // Killed while one types: at most a second of text is lost.
    type_in(&window, " and more");
    std::thread::sleep(Duration::from_secs(1));
    type_in(&window, " lost");
    window.kill_and_start();
    assert!(window.kept().iter().any(|kept| kept.contains("// mine and more")), "{:?}", window.kept());
    show(&window, "recovered");
    assert_eq!(window.errors(), "");

    // Saved under another name, and the picture written into a file.
    ask(&window, "ctrl+shift+s");
    type_in(&window, "second");
    keys(&window, &["Return"]);
    until("it is saved as", || text(&window, "second.sdf") == SCENE);
    pause();
    ask(&window, "ctrl+shift+e");
    show(&window, "export");
    keys(&window, &["Return"]);
    // A large picture takes its time where the adapter is a program.
    within(120, "the picture is written", || image::open(window.folder.join("second.png")).is_ok_and(|picture| picture.width() == 1920));
}
