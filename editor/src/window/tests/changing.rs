//! What the window shows while it waits, and what it keeps when what is around it changes.

use super::*;
use surefoot_runtime::live::{Times, Work};

#[test]
fn what_takes_long_is_said() {
    let mut session = Session::new(Document::new("a.sdf", "scene = sphere(1)"));
    session.said.times = Times { compile: Duration::from_millis(20), pipeline: Duration::from_millis(893), ..Times::default() };
    let shown = |session: Session| Harness::new_ui(move |ui| {
        panels::status::show(ui, &session);
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
    let (name, open) = (harness.get_by_label("a_scene_of_a_very_long_name.sdf").rect(), harness.get_by_label("Open").rect());
    assert!(name.right() <= open.left(), "{name:?} {open:?}");
    harness.set_size(egui::vec2(1280.0, 800.0));
    harness.run_steps(4);
    assert_eq!(width(&harness), before);
}
