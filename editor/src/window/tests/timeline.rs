//! The timeline below the picture.

use super::*;

const MOVING: &str = "scene = sphere(1).translate(sin(time), 0, 0)\ncamera { eye: (0, 0, 8), target: (0, 0, 0) }\n";

#[test]
fn time_is_dragged_and_begins_anew() {
    let folder = Folder::new("timeline", MOVING);
    let mut harness = window(&folder.scene());
    until(&mut harness, |app| app.session.said.swaps > 0 && frames(app) > 0);
    let time = |harness: &Harness<'_, App>| harness.state().session.stage.time();
    assert!(harness.state().session.moves());
    harness.get_by_label("Pause").click();
    harness.run_steps(3);
    let strip = harness.get_by_role_and_label(Role::Slider, "Timeline").rect();
    let drawn = frames(harness.state());
    drag(&mut harness, strip.left_center() + egui::vec2(4.0, 0.0), strip.center());
    assert!((time(&harness) - 5.0).abs() < 0.5, "the middle of ten seconds: {}", time(&harness));
    assert!(frames(harness.state()) > drawn, "the picture follows");
    if let Ok(shots) = std::env::var("SUREFOOT_SHOTS") {
        harness.render().unwrap().save(Path::new(&shots).join("timeline.png")).unwrap();
    }
    // By the keyboard: an arrow moves it, L lets it loop.
    harness.get_by_role_and_label(Role::Slider, "Timeline").focus();
    harness.run_steps(2);
    let before = time(&harness);
    harness.key_press(Key::ArrowRight);
    harness.run_steps(2);
    assert!(time(&harness) > before);
    harness.get_by_role_and_label(Role::SpinButton, "Length");
    let focused = harness.ctx.memory(|m| m.focused());
    harness.ctx.memory_mut(|m| focused.into_iter().for_each(|id| m.surrender_focus(id)));
    harness.step();
    harness.key_press(Key::L);
    harness.run_steps(2);
    assert!(harness.state().session.timeline.loops);
    harness.state_mut().session.stage.set_time(9.95);
    harness.get_by_label("Play").click();
    until(&mut harness, |app| app.session.stage.time() < 5.0);
    assert!(time(&harness) >= 0.0);
}

#[test]
fn a_scene_that_rests_has_no_timeline() {
    let folder = Folder::new("no-timeline", SCENE);
    let mut harness = window(&folder.scene());
    until(&mut harness, |app| app.session.said.swaps > 0);
    assert!(harness.query_by_role_and_label(Role::Slider, "Timeline").is_none());
}
