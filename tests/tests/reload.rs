//! From a saved file to a picture, with the compiler and the device as they are.

mod common;

use common::{Disk, examples, gpu};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};
use surefoot_compiler::compile;
use surefoot_compiler::compiled::Options;
use surefoot_runtime::headless::{self, FORMAT, Shot};
use surefoot_runtime::live::{LiveScene, Setup, Update};
use surefoot_runtime::{Gpu, Stage, View, ViewMode};

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn start(gpu: &Gpu, path: &Path) -> LiveScene {
    LiveScene::start(Setup {
        path: path.to_str().unwrap().to_owned(),
        options: Options::default(),
        loader: Arc::new(Disk),
        compile: Arc::new(compile),
        target: Some((gpu.clone(), FORMAT)),
        mode: ViewMode::Shaded,
        wake: Arc::new(|| {}),
    })
    .unwrap()
}

fn next(live: &LiveScene) -> Update {
    let start = Instant::now();
    loop {
        if let Some(update) = live.poll() {
            return update;
        }
        assert!(start.elapsed() < Duration::from_secs(120), "no update: {:?}", live.report());
        std::thread::sleep(Duration::from_micros(200));
    }
}

/// The next update with a picture; anything wrong ends the test.
fn next_good(live: &LiveScene) -> Update {
    let update = next(live);
    let Update { words, failure, ready, .. } = &update;
    assert!(failure.is_none(), "{failure:?}");
    assert!(ready.is_some(), "{:?}", words.diagnostics);
    update
}

/// Each example saved again with a line that changes its formulas: how long until it can be drawn.
#[test]
fn a_save_of_each_example_is_drawn_soon() {
    let gpu = gpu();
    let folder = folder("reload");
    copy(&common::root().join("examples"), &folder);
    println!("on {}: from a save to a scene that is ready to be drawn", gpu.name());
    println!(
        "{:14} {:>10} {:>11} {:>11} {:>17}",
        "scene", "total ms", "compile ms", "pipeline ms", "save to ready ms"
    );
    for (name, _) in examples() {
        let path = folder.join(format!("{name}.sdf"));
        let text = fs::read_to_string(&path).unwrap();
        let live = start(&gpu, &path);
        let update = next(&live);
        if update.ready.is_none() {
            println!("{name:14} does not compile");
            continue;
        }
        let new = text.replace("scene = ", "scene = sphere(0.0625).translate(1, 2, 0) | ");
        let saved = Instant::now();
        fs::write(&path, new).unwrap();
        let update = next_good(&live);
        let ready = saved.elapsed();
        let ms = |time: Duration| time.as_secs_f64() * 1e3;
        let times = update.times;
        println!(
            "{name:14} {:10.1} {:11.1} {:11.1} {:17.1}",
            ms(times.total),
            ms(times.compile),
            ms(times.pipeline),
            ms(ready)
        );
    }
}

/// A storm of saves, whole and halved, good and bad, while the sliders move and the picture is drawn.
#[test]
fn a_storm_of_saves_while_the_picture_is_drawn() {
    let gpu = gpu();
    let folder = folder("storm");
    let path = folder.join("main.sdf");
    let text = |i: u32| {
        format!(
            "import \"part.sdf\"\nparam size = 1 in 0.5..2\nlet n = {}\nscene = ball(size) | box(0.5).translate({}, 0, 0)\n",
            i,
            f64::from(i) / 64.0
        )
    };
    fs::write(folder.join("part.sdf"), "shape ball(r: float) = sphere(r)\n").unwrap();
    fs::write(&path, text(0)).unwrap();
    let live = start(&gpu, &path);
    let mut stage = Stage::new();
    stage.put(next_good(&live).ready.unwrap());
    let camera = stage.scene().unwrap().frame(stage.live().unwrap()).cameras[0].1;
    let view = View { camera, size: [32.0, 32.0], corner: [0.0; 2], sample: 0 };
    let last = 256;
    let writer = {
        let (folder, path) = (folder.clone(), path.clone());
        std::thread::spawn(move || {
            for i in 1..=last {
                let text = text(i);
                match i % 4 {
                    0 => fs::write(&path, text).unwrap(),
                    1 => {
                        fs::write(folder.join("new"), text).unwrap();
                        fs::rename(folder.join("new"), &path).unwrap();
                    }
                    // A half is often a program too; the whole follows.
                    2 => {
                        fs::write(&path, &text[..text.len() / 2]).unwrap();
                        std::thread::sleep(Duration::from_millis(1));
                        fs::write(&path, text).unwrap();
                    }
                    _ => {
                        let part = folder.join("part.sdf");
                        fs::remove_file(&part).unwrap();
                        fs::write(&path, text).unwrap();
                        fs::write(&part, "shape ball(r: float) = sphere(r)\n").unwrap();
                    }
                }
                std::thread::sleep(Duration::from_millis(9));
            }
            Instant::now()
        })
    };
    let wanted = text(last);
    let (mut pictures, mut errors, mut frames) = (0, 0, 0);
    loop {
        if let Some(update) = live.poll() {
            assert!(update.failure.is_none(), "{:?}", update.failure);
            errors += u32::from(!update.words.diagnostics.is_empty() && update.ready.is_none());
            let newest = update.words.sources.iter().any(|(_, f)| *f.text == *wanted);
            if let Some(ready) = update.ready {
                stage.put(ready);
                pictures += 1;
                if newest {
                    break;
                }
            }
        }
        frames += 1;
        let size = 0.5 + 1.5 * f64::from(frames % 100) / 100.0;
        assert!(stage.set("size", &[size]), "the slider is there in every scene");
        stage.update(gpu.queue(), &view);
        std::thread::sleep(Duration::from_millis(2));
        assert!(frames < 30_000, "the last save never came: {:?}", live.report());
    }
    let late = writer.join().unwrap().elapsed();
    println!(
        "{last} saves: {pictures} pictures, {errors} errors shown, {:?}, {:?}; the last save ready {late:?} after the storm",
        live.report(),
        gpu.stats()
    );
    assert!(pictures > 2, "the picture follows while the storm lasts");
    assert!(late < Duration::from_secs(20), "{late:?}");
    // What is on is the last text, and the slider is where it was.
    let value = stage.live().unwrap().components[0];
    let size = 0.5 + 1.5 * f64::from(frames % 100) / 100.0;
    assert!((value - size).abs() < 1e-12, "{value}, not {size}");
    // After it, nothing moves.
    let (report, stats) = (live.report(), gpu.stats());
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!((live.report(), gpu.stats()), (report, stats));
    stage.update(gpu.queue(), &view);
    assert!(!stage.update(gpu.queue(), &view), "nothing to draw");
}

/// A slider writes a uniform: no compilation, no module, no pipeline, whatever the parameter shapes.
#[test]
fn sliders_of_the_examples_build_nothing() {
    let gpu = gpu();
    for (name, path) in examples() {
        let Ok(compiled) = common::compile_file(&path) else { continue };
        if compiled.module.wgsl.len() > 64 << 10 {
            continue; // Takes a minute of Mesa's time and says nothing more.
        }
        let mut live = compiled.live();
        let mut picture =
            surefoot_runtime::Picture::prepare(&gpu, &compiled, FORMAT, ViewMode::Normals).unwrap();
        let shot = Shot { mode: ViewMode::Normals, ..Shot::new(32, 24) };
        let built = gpu.stats();
        for (i, parameter) in compiled.graph.parameters.iter().enumerate() {
            for share in [0.0, 0.3, 1.0] {
                live.components[i] = parameter.min + share * (parameter.max - parameter.min);
                headless::render_with(&gpu, &mut picture, &compiled, &live, &shot).unwrap();
            }
        }
        assert_eq!(gpu.stats(), built, "{name}");
    }
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &target);
        } else {
            fs::copy(&path, &target).unwrap();
        }
    }
}

/// The picture moves while a scene is built that takes long.
#[test]
fn the_picture_moves_while_a_large_scene_is_built() {
    let gpu = gpu();
    let folder = folder("smooth");
    let path = folder.join("main.sdf");
    fs::write(&path, "scene = sphere(1)").unwrap();
    let live = start(&gpu, &path);
    let mut stage = Stage::new();
    stage.put(next_good(&live).ready.unwrap());
    let compiled = stage.scene().unwrap().clone();
    let mut picture =
        surefoot_runtime::Picture::prepare(&gpu, &compiled, FORMAT, ViewMode::Shaded).unwrap();
    let shot = Shot::new(64, 48);
    // No text that the driver has seen before: a number from the clock is in it.
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap();
    let new = format!(
        "scene = for i in 0..24 {{ box(0.1 + 0.01 * i).twist(y, 0.1 * i).translate(0.2 * i - 4, 0.{:09}, 0) }}",
        now.subsec_nanos()
    );
    fs::write(&path, new).unwrap();
    let start = Instant::now();
    let (mut worst, mut frames) = (Duration::ZERO, 0);
    let update = loop {
        let frame = Instant::now();
        headless::render_with(&gpu, &mut picture, &compiled, &compiled.live(), &shot).unwrap();
        worst = worst.max(frame.elapsed());
        frames += 1;
        if let Some(update) = live.poll() {
            break update;
        }
    };
    let all = start.elapsed();
    println!(
        "{frames} frames in {all:?}, the longest {worst:?}; the new scene took {:?}",
        update.times
    );
    assert!(update.ready.is_some(), "{:?}", update.words.diagnostics);
    assert!(2 * worst < all, "the picture stood still for {worst:?} of {all:?}");
}
