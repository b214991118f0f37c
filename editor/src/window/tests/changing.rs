//! What the window shows while it waits, and what it keeps when what is around it changes.

use super::*;
use surefoot_runtime::live::{Times, Work};

#[test]
fn what_takes_long_is_said() {
    let mut session = Session::new(Document::new("a.sdf", "scene = sphere(1)"));
    session.said.times = Times { compile: Duration::from_millis(20), pipeline: Duration::from_millis(893), ..Times::default() };
    let shown = |session: Session| Harness::new_ui(move |ui| {
        panels::status::show(ui, &session, &mut Vec::new());
        let rect = ui.available_rect_before_wrap();
        panels::picture::paint(ui, rect, &session, None);
    });
    session.said.work = Some((Work::Building, Duration::from_secs(12)));
    let harness = shown(session);
    harness.get_by_label("building the picture …");
    harness.get_by_label("12 s");
    harness.get_by_label("building the picture … 12 s");
    assert!(harness.query_by_label("pipeline").is_none(), "that of another text");
}

#[test]
fn what_can_not_be_drawn_is_not_waited_for() {
    let folder = Folder::new("refused", ") scene = (\n");
    let mut harness = window(&folder.scene());
    until(&mut harness, |app| app.session.error().is_some());
    let app = harness.state_mut();
    app.session.said.problems.clear();
    app.session.said.failure = Some("the adapter refuses it".to_owned());
    harness.step();
    harness.get_by_label("no picture yet");
    assert!(harness.query_by_label_contains("compiling").is_none());
}

#[test]
fn an_eye_that_another_scene_swallows_goes_home() {
    let folder = Folder::new("swallowed", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    drag(&mut harness, MIDDLE, MIDDLE + egui::vec2(40.0, 20.0));
    let large = |side: u32| format!("scene = box({side})\ncamera {{ eye: (0, 0, 60), target: (0, 0, 0) }}\n");
    std::fs::write(folder.scene(), large(30)).unwrap();
    until(&mut harness, |app| app.session.said.swaps == 2);
    assert_eq!(harness.state().session.camera().unwrap().eye, [0.0, 0.0, 60.0]);

    drag(&mut harness, MIDDLE, MIDDLE + egui::vec2(40.0, 20.0));
    let moved = harness.state().session.camera();
    std::fs::write(folder.scene(), large(28)).unwrap();
    until(&mut harness, |app| app.session.said.swaps == 3);
    assert_eq!(harness.state().session.camera(), moved, "one that sees something stays");
}

#[test]
fn a_small_window_leaves_the_panels_their_width() {
    let folder = Folder::new("small", SCENE);
    let scene = folder.0.join("a_scene_of_a_very_long_name.sdf");
    std::fs::write(&scene, SCENE).unwrap();
    let mut harness = window(&scene.to_string_lossy());
    ready(&mut harness);
    let width = |harness: &Harness<'_, App>| harness.get_by_label("Save").rect().right();
    harness.set_size(egui::vec2(1280.0, 800.0));
    harness.run_steps(4);
    let before = width(&harness);
    harness.set_size(egui::vec2(420.0, 300.0));
    harness.run_steps(4);
    assert!(width(&harness) < 0.6 * before);
    let (name, other) = (harness.get_by_label("a_scene_of_a_very_long_name.sdf").rect(), harness.get_by_label("Lay out").rect());
    assert!(name.right() <= other.left(), "{name:?} {other:?}");
    harness.set_size(egui::vec2(1280.0, 800.0));
    harness.run_steps(4);
    assert_eq!(width(&harness), before);
}

fn text(app: &App) -> &str {
    &app.session.documents.current().text
}

#[test]
fn what_a_hand_has_set_is_written_into_the_text() {
    let folder = Folder::new("kept", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let app = harness.state_mut();
    app.apply(vec![
        Command::Set("size".to_owned(), vec![1.234_567_8]),
        Command::Set("turn".to_owned(), vec![45f64.to_radians()]),
        Command::Set("tint".to_owned(), vec![0.0, 1.0, 0.0]),
        Command::Choose("style".to_owned(), "ball".to_owned()),
    ]);
    until(&mut harness, |app| app.session.said.swaps == 2);
    let moved = |app: &App| app.session.scene().unwrap().parameters.iter().filter(|p| app.session.is_moved(p)).count();
    assert_eq!(moved(harness.state()), 4, "a choice is one of them");
    harness.get_by_label("Keep").click();
    until(&mut harness, |app| app.session.said.swaps >= 3 && app.session.options.choose.is_empty());
    let written = SCENE.replace("= 1 in", "= 1.2346 in").replace("= 30deg", "= 45deg").replace("#d02010", "#00ff00").replace("= block in", "= ball in");
    assert_eq!(text(harness.state()), written);
    until(&mut harness, |app| moved(app) == 0);
    assert_eq!(value(harness.state(), "size"), 1.2346);

    // What the text says later counts more than what a hand did before.
    harness.state_mut().apply(vec![Command::Set("size".to_owned(), vec![0.5])]);
    write(&mut harness, &written.replace("1.2346", "1.5"));
    until(&mut harness, |app| value(app, "size") == 1.5);
}

#[test]
fn where_the_camera_stands_is_written_into_the_text() {
    let folder = Folder::new("viewed", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    drag(&mut harness, MIDDLE, MIDDLE + egui::vec2(60.0, 40.0));
    let moved = harness.state().session.camera().unwrap();
    harness.get_by_label("Keep view").click();
    until(&mut harness, |app| app.session.look.orbit.is_none());
    let (text, kept) = (text(harness.state()).to_owned(), harness.state().session.camera().unwrap());
    let off = surefoot_compiler::vector::length(surefoot_compiler::vector::sub(kept.eye, moved.eye));
    assert!(text != SCENE && text.contains("fov: 40deg") && off < 0.02, "{text}");
}

#[test]
fn a_hand_that_loses_the_scene_is_told_the_way_home() {
    let folder = Folder::new("lost", "scene = sphere(1)\ncamera { eye: (0, 0, 5), target: (0, 0, 0) }\n");
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let hint = |harness: &Harness<'_, App>| harness.query_by_label_contains("nothing is in sight").is_some();
    harness.state_mut().apply(vec![Command::Pan(0.1, 0.0)]);
    harness.run_steps(3);
    assert!(!hint(&harness));
    harness.state_mut().apply(vec![Command::Dolly(0.1)]);
    harness.run_steps(3);
    assert!(hint(&harness), "inside of it");
    harness.state_mut().apply(vec![Command::Home]);
    harness.run_steps(3);
    assert!(!hint(&harness));
}
