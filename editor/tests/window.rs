//! The window on a screen that is none: another program saves the scene, a hand drags a slider and types.
//!
//! Needs Xvfb, xdotool and a graphics adapter (a program will do). Prints how long it takes from a save to the first new picture.
#![cfg(all(feature = "gui", target_os = "linux"))]

mod screen;

use screen::{MIDDLE, Window, blue, red};
use std::time::{Duration, Instant, SystemTime};

const SCENE: &str = "\
param size = 1 in 0.2..2
material paint { color: #d02010, roughness: 1 }
scene = sphere(size).material(paint)
camera { eye: (0, 0, 8), target: (0, 0, 0), fov: 40deg }
";

/// The left end of the first slider's rail, and its middle.
const SLIDER: ((u32, u32), (u32, u32)) = ((1042, 104), (1110, 104));
/// Somewhere in the text.
const TEXT: (u32, u32) = (250, 400);

fn now() -> f64 {
    SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap().as_secs_f64()
}

#[test]
fn another_program_saves_and_the_picture_follows() {
    let window = Window::open("save", &[("scene.sdf", SCENE)]);
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
    let window = Window::open("slider", &[("scene.sdf", SCENE)]);
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

    // Nothing moves any more, so when the still is done nothing is drawn.
    let start = Instant::now();
    loop {
        let drawn = window.log().len();
        std::thread::sleep(Duration::from_secs(2));
        if window.log().len() == drawn {
            break;
        }
        assert!(start.elapsed() < Duration::from_secs(100), "it is drawn again and again");
    }
}

#[test]
fn what_is_typed_is_seen_and_saved() {
    let window = Window::open("typed", &[("scene.sdf", SCENE)]);
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

/// Where the bar over the text has the button that takes what was found.
const KEEP: (u32, u32) = (40, 106);

#[test]
fn who_types_undoes_and_is_killed_comes_back_to_the_text() {
    let lines: String = (0..120).map(|i| format!("// {i}\n")).collect();
    let scene = format!("{SCENE}{lines}");
    let mut window = Window::open("tour", &[("scene.sdf", &scene)]);
    window.see("first", red);
    let saved = |window: &Window, end: &str| {
        let start = Instant::now();
        loop {
            let text = std::fs::read_to_string(window.scene()).unwrap();
            if text.starts_with(&scene) && text.ends_with(end) {
                return;
            }
            assert!(start.elapsed() < Duration::from_secs(10), "{text}");
            std::thread::sleep(Duration::from_millis(20));
        }
    };
    // Each key is a frame of its own, also on a machine that is busy.
    let hand = |window: &Window, args: &[&str]| {
        window.hand(args);
        std::thread::sleep(Duration::from_millis(400));
    };
    window.point(TEXT);
    hand(&window, &["click", "1"]);
    hand(&window, &["key", "ctrl+End"]);
    hand(&window, &["type", "--delay", "20", "// typed"]);
    hand(&window, &["key", "ctrl+Home"]);
    hand(&window, &["key", "ctrl+z"]);
    // The cursor is where the change was, not where it was left.
    hand(&window, &["type", "--delay", "20", "// instead"]);
    window.screen("undone");
    hand(&window, &["key", "ctrl+s"]);
    saved(&window, "// instead");
    assert!(window.kept().is_empty(), "what is saved is not kept besides");

    hand(&window, &["type", "--delay", "20", " and not saved"]);
    let start = Instant::now();
    while !window.kept().iter().any(|text| text.ends_with("// instead and not saved")) {
        assert!(start.elapsed() < Duration::from_secs(1), "{:?}", window.kept());
        std::thread::sleep(Duration::from_millis(5));
    }
    window.kill_and_start();
    window.see("found", red);
    window.point(KEEP);
    hand(&window, &["click", "1"]);
    window.screen("kept");
    hand(&window, &["key", "ctrl+s"]);
    saved(&window, "// instead and not saved");
    let start = Instant::now();
    while !window.kept().is_empty() {
        assert!(start.elapsed() < Duration::from_secs(1), "{:?}", window.kept());
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(window.errors(), "", "nothing that a person did not ask for");
}
