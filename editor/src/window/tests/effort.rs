//! What the window does while the compiler works, and while nothing happens.

use super::*;
use std::sync::Condvar;
use std::thread::ThreadId;
use surefoot_compiler::Loader;

/// Files on disk, of which one is read only when it may be; it says on which threads it was asked for.
#[derive(Default)]
struct Gate {
    is_shut: Mutex<bool>,
    opened: Condvar,
    asked_by: Mutex<Vec<ThreadId>>,
}

impl Gate {
    fn shut(&self, shut: bool) {
        *self.is_shut.lock().unwrap() = shut;
        self.opened.notify_all();
    }

    fn asked(&self) -> usize {
        self.asked_by.lock().unwrap().len()
    }
}

impl Loader for Gate {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        if path.ends_with("part.sdf") {
            self.asked_by.lock().unwrap().push(std::thread::current().id());
            // A test that fails still ends.
            let shut = self.is_shut.lock().unwrap();
            drop(self.opened.wait_timeout_while(shut, Duration::from_secs(20), |shut| *shut));
        }
        FileLoader.read(path)
    }
}

#[test]
fn the_window_never_waits_for_the_compiler() {
    let scene = "import \"part.sdf\"\nscene = ball | box(1).translate(3, 0, 0)\ncamera { eye: (0, 0, 8), target: (0, 0, 0) }\n";
    let folder = Folder::new("gate", scene);
    std::fs::write(folder.0.join("part.sdf"), "shape ball = sphere(1)\n").unwrap();
    let gate = Arc::<Gate>::default();
    let mut harness = window_that_reads(&folder.scene(), gate.clone());
    ready(&mut harness);
    let swaps = harness.state().session.said.swaps;
    gate.shut(true);
    let asked = gate.asked();
    let longer = scene.replace("box(1)", "box(0.5)");
    write(&mut harness, &longer);
    until(&mut harness, |app| gate.asked() > asked && app.session.said.work.is_some());
    // The compiler stands. Each key is in the next frame all the same.
    for (count, letter) in "// a word".chars().enumerate() {
        harness.event(egui::Event::Text(letter.to_string()));
        harness.step();
        let text = &harness.state().session.documents.current().text;
        assert_eq!(text.chars().count(), longer.chars().count() + count + 1, "{text}");
    }
    let drawn = frames(harness.state());
    drag(&mut harness, MIDDLE, MIDDLE + egui::vec2(80.0, 30.0));
    assert!(frames(harness.state()) > drawn, "the last picture is turned meanwhile");
    assert_eq!(harness.state().session.said.swaps, swaps);
    harness.step();
    assert!(harness.state().session.said.work.is_some(), "and it still stands");
    gate.shut(false);
    until(&mut harness, |app| app.session.said.swaps > swaps);
    let here = std::thread::current().id();
    assert!(gate.asked_by.lock().unwrap().iter().all(|thread| *thread != here), "the window's thread compiles nothing");
}

/// After how long the window wants to be drawn again.
fn pause(harness: &Harness<'_, App>) -> Duration {
    harness.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay
}

/// How many frames the window wants within so many seconds in which nothing happens: it is shown often, and those are counted that it has asked for.
fn wanted(harness: &mut Harness<'_, App>, seconds: f32) -> usize {
    // As the harness is built.
    let step = 0.02;
    let (mut now, mut due, mut count) = (0.0, pause(harness).as_secs_f32(), 0);
    while now < seconds {
        harness.step();
        now += step;
        if now >= due {
            count += 1;
            due = now + pause(harness).as_secs_f32();
        }
    }
    count
}

#[test]
fn a_window_at_rest_is_hardly_drawn() {
    let folder = Folder::new("rest", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    harness.get_by_role(Role::MultilineTextInput).focus();
    harness.run_steps(10);
    // What is kept of the session is written soon, and then nothing is left to do.
    until(&mut harness, |app| app.canvas.as_ref().unwrap().is_done() && app.session.said.work.is_none());
    let settled = Instant::now();
    while settled.elapsed() < Duration::from_secs(3) {
        std::thread::sleep(Duration::from_millis(100));
        harness.step();
    }
    assert!(harness.get_by_role(Role::MultilineTextInput).is_focused());
    harness.state_mut().session.meter.software = true;
    harness.run_steps(3);
    assert_eq!(wanted(&mut harness, 4.0), 0, "no frame where no caret blinks: {:?}", pause(&harness));
    // Something that changes nothing, so that the caret blinks again.
    harness.state_mut().session.meter.software = false;
    harness.event(egui::Event::WindowFocused(true));
    harness.run_steps(3);
    let blinks = wanted(&mut harness, 4.0);
    assert!((4..=8).contains(&blinks), "two frames a second for the caret: {blinks}");
    assert_eq!(wanted(&mut harness, 10.0) / 16, 0);
    assert_eq!(wanted(&mut harness, 4.0), 0, "it stands still by now: {:?}", pause(&harness));
}

#[test]
fn keys_are_measured_while_time_stands() {
    let folder = Folder::new("trial", "scene = sphere(1).translate(sin(time), 0, 0)\ncamera { eye: (0, 0, 8), target: (0, 0, 0) }\n");
    let mut harness = window(&folder.scene());
    assert!(harness.state().session.stage.playing);
    let gpu = harness.state().canvas.as_ref().unwrap().gpu().clone();
    harness.state_mut().trial = Some(Trial::new(gpu, Arc::default()));
    until(&mut harness, |app| !app.session.stage.playing);
    // So there is a picture with all its pixels, for which the last key's time is waited.
    sharp(&mut harness);
    harness.state_mut().trial = None;
}
