//! A thousand saves in ten seconds under a running window: in place and by rename, emptied first, deleted and brought back, with
//! errors and with bytes that are no text, of the scene and of what it imports.
//!
//! Needs what the window's tests need. Prints how many of the saves were drawn while they came.
#![cfg(all(feature = "gui", target_os = "linux"))]

mod screen;

use image::RgbImage;
use screen::{Window, blue, red};
use std::fs;
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, Instant};

const SAVES: u32 = 1000;
/// From one save to the next.
const BEAT: Duration = Duration::from_millis(10);
/// The picture's pixels that are compared, from..to: the ball and sky about it.
const PART: ((u32, u32), (u32, u32)) = ((600, 260), (900, 560));

/// The picture's width when it is drawn in full; a coarser one may come before it.
const FULL: u64 = 560;
/// How far a pixel of a coarser picture may be mixed with its neighbours: the coarsest has a pixel for every 5.5 each way.
const COARSE: u32 = 11;
/// The same for a still of fewer samples: the pixels of an edge are smooth only in time, and the samples lie aside in both pictures.
const UNFINISHED: u32 = 2;

const BALL: &str = "shape ball(r: float) = sphere(r)\n";

/// The scene as it is saved for the `i`-th time: red where `i` is even, and each time with formulas that were not there before. All
/// of one colour look alike.
fn scene(i: u32) -> String {
    let color = if i.is_multiple_of(2) { "#d02010" } else { "#2010d0" };
    format!(
        "import \"part.sdf\"\n\
         param size = 1 in 0.2..2\n\
         material paint {{ color: {color}, roughness: 1 }}\n\
         scene = ball(size).translate(0, 0, 0.{i:07}).material(paint)\n\
         camera {{ eye: (0, 0, 8), target: (0, 0, 0), fov: 40deg }}\n"
    )
}

/// The imported file as it is saved for the `i`-th time.
fn part(i: u32) -> String {
    format!("{BALL}let unused = {i}\n")
}

/// Puts a text in a file's place in one step.
fn rename(path: &Path, text: &str) {
    let beside = path.with_extension("new");
    fs::write(&beside, text).unwrap();
    fs::rename(beside, path).unwrap();
}

/// One save, as programs save, or as they fail to.
fn save(folder: &Path, i: u32) {
    let pause = || sleep(Duration::from_millis(2));
    let (main, imported) = (folder.join("scene.sdf"), folder.join("part.sdf"));
    let text = scene(i);
    match i % 12 {
        0 | 1 => fs::write(&main, &text).unwrap(),
        2 | 3 => rename(&main, &text),
        4 => {
            fs::write(&main, "").unwrap();
            pause();
            fs::write(&main, &text).unwrap();
        }
        5 => {
            fs::remove_file(&main).unwrap();
            pause();
            fs::write(&main, &text).unwrap();
        }
        6 => fs::write(&main, [text.as_bytes(), b"// \xff\xfe\xc0"].concat()).unwrap(),
        7 => fs::write(&main, text.replace("ball(", "bal(")).unwrap(),
        8 => rename(&imported, &part(i)),
        9 => fs::write(&imported, "shape ball(r: float = sphere(").unwrap(),
        10 => {
            fs::remove_file(&imported).unwrap();
            pause();
            fs::write(&imported, part(i)).unwrap();
        }
        _ => fs::write(&imported, part(i)).unwrap(),
    }
}

/// All the saves, each at its beat; answers how long they took.
fn storm(folder: PathBuf) -> Duration {
    let start = Instant::now();
    for i in 1..=SAVES {
        sleep((BEAT * i).saturating_sub(start.elapsed()));
        save(&folder, i);
    }
    start.elapsed()
}

/// The share of pixels that are those of none of the pictures, nor a mixture of the pixels of one of them no farther than `reach` away.
fn strange(screen: &RgbImage, pictures: &[&RgbImage], reach: u32) -> f64 {
    let ((left, top), (right, bottom)) = PART;
    let all = (left..right).flat_map(|x| (top..bottom).map(move |y| (x, y)));
    let strange = all.filter(|&(x, y)| {
        let seen = screen.get_pixel(x, y).0;
        let from = |picture: &RgbImage, reach: u32| {
            let around = (x - reach..=x + reach).flat_map(|x| (y - reach..=y + reach).map(move |y| picture.get_pixel(x, y).0));
            let (low, high) = around.fold(([255; 3], [0; 3]), |(low, high): ([u8; 3], [u8; 3]), pixel| {
                ([0, 1, 2].map(|i| low[i].min(pixel[i])), [0, 1, 2].map(|i| high[i].max(pixel[i])))
            });
            (0..3).all(|i| (low[i].saturating_sub(3)..=high[i].saturating_add(3)).contains(&seen[i]))
        };
        !pictures.iter().any(|picture| from(picture, 0)) && !pictures.iter().any(|picture| from(picture, reach))
    });
    strange.count() as f64 / f64::from((right - left) * (bottom - top))
}

/// Waits until a ball of this colour is drawn in full, and answers what the screen shows then.
fn settled(window: &Window, name: &str, color: fn([u8; 3]) -> bool) -> RgbImage {
    window.see(name, color);
    let swaps = swaps(window);
    window.picture(|frame| frame["swaps"] == swaps && frame["width"] == FULL);
    // From the frame that is done to the screen.
    sleep(Duration::from_millis(300));
    window.see(name, color)
}

#[test]
fn a_thousand_saves_in_ten_seconds() {
    let mut window = Window::open("storm", &[("scene.sdf", &scene(0)), ("part.sdf", BALL)]);
    let red_ball = settled(&window, "red", red);
    fs::write(window.scene(), scene(1)).unwrap();
    let blue_ball = settled(&window, "blue", blue);
    assert!(strange(&blue_ball, &[&red_ball], COARSE) > 0.15, "the two balls look alike");
    let (swaps, held) = (swaps(&window), window.lives().unwrap());

    let folder = window.folder.clone();
    let saving = std::thread::spawn(move || storm(folder));
    let mut screens = Vec::new();
    while !saving.is_finished() {
        screens.push(window.screen(&format!("during-{}", screens.len())));
        assert!(window.lives().is_some(), "it died in the storm");
    }
    let took = saving.join().unwrap();
    let drawn = self::swaps(&window) - swaps;
    let seen: Vec<f64> = screens.iter().map(|screen| strange(screen, &[&red_ball, &blue_ball], COARSE)).collect();
    let worst = seen.iter().fold(0.0, |a: f64, &b| a.max(b));
    println!(
        "{SAVES} saves in {took:.2?}: {drawn} drawn meanwhile; of {} screens at most {:.2} % are of no good picture",
        seen.len(),
        100.0 * worst
    );
    assert!(took < Duration::from_secs(12), "the saves themselves took {took:?}");
    assert!(seen.len() > 10 && worst == 0.0, "not the last good picture: {seen:?}");
    assert!(drawn > 2, "the picture follows while the storm lasts");

    // What stays broken is said, and the last good picture stays.
    fs::write(window.scene(), b"scene = sphere(1) // \xff").unwrap();
    fs::write(window.folder.join("part.sdf"), BALL).unwrap();
    let broken = window.log().len();
    let start = Instant::now();
    while !window.log().iter().skip(broken).any(|event| event["errors"].as_u64() > Some(0)) {
        assert!(start.elapsed() < Duration::from_secs(20), "the error is never said");
        sleep(Duration::from_millis(20));
    }
    let screen = window.screen("broken");
    assert!(strange(&screen, &[&red_ball, &blue_ball], COARSE) == 0.0, "an error took the picture away");

    // And at the end it is the right one.
    for (name, last, right) in [("last", SAVES + 1, &blue_ball), ("very-last", SAVES + 2, &red_ball)] {
        fs::write(window.scene(), scene(last)).unwrap();
        let mut screen = settled(&window, name, if last % 2 == 0 { red } else { blue });
        // A busy machine takes a while to finish its edges.
        let start = Instant::now();
        while strange(&screen, &[right], UNFINISHED) > 0.0 && start.elapsed() < Duration::from_secs(10) {
            sleep(Duration::from_millis(300));
            screen = window.screen(name);
        }
        let strange = strange(&screen, &[right], UNFINISHED);
        assert!(strange == 0.0, "{name}: {:.2} % are of another picture", 100.0 * strange);
    }
    let last = window.log().iter().rev().find(|event| event["event"] == "compiled").cloned().unwrap();
    assert_eq!((last["errors"].as_u64(), last["swapped"].as_bool()), (Some(0), Some(true)), "{last}");
    println!("memory: {held} MiB before, {} MiB after", window.lives().unwrap());
}

/// How many scenes were put up so far.
fn swaps(window: &Window) -> u64 {
    let swaps = window.log().iter().rev().find_map(|event| event["swaps"].as_u64());
    swaps.unwrap_or(0)
}
