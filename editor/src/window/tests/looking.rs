//! A person points at a pixel: its shape is named, and the text shows it.

use super::*;
use egui::pos2;
use crate::window::looking::Found;

/// Holds a key down and clicks.
fn click_with(harness: &mut Harness<'_, App>, modifiers: Modifiers, at: egui::Pos2) {
    harness.hover_at(at);
    harness.step();
    for pressed in [true, false] {
        harness.event(egui::Event::ModifiersChanged(modifiers));
        harness.event(egui::Event::PointerButton { pos: at, button: egui::PointerButton::Primary, pressed, modifiers });
        harness.step();
    }
    harness.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    harness.step();
}

fn found(app: &App) -> Option<&Found> {
    app.session.looking.found.as_ref()?.as_ref().ok()
}

#[test]
fn a_pixel_names_its_shape_and_the_text_goes_there() {
    let folder = Folder::new("picked", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let before = harness.state().session.camera().unwrap();
    click_with(&mut harness, Modifiers::ALT, MIDDLE);
    until(&mut harness, |app| found(app).is_some());
    let ball = found(harness.state()).unwrap();
    let last = ball.parts.last().unwrap();
    assert_eq!((last.text.as_str(), last.place.start.0), ("sphere(size)", 8));
    let seen = ball.seen.unwrap();
    assert!((surefoot_compiler::vector::length(seen.point) - 1.0).abs() < 1e-2, "{seen:?}");
    assert_eq!(harness.state().session.camera().unwrap(), before, "a click turns nothing");
    harness.get_by_label("Picked");
    harness.get_by_label_contains("normal 0.0");
    until(&mut harness, |app| app.session.documents.jump.is_none());
    if let Ok(folder) = std::env::var("SUREFOOT_SHOTS") {
        harness.render().unwrap().save(Path::new(&folder).join("picked.png")).unwrap();
    }
    // The ray's steps are there too: the same as the tracer takes, each with what holds it.
    let march = &found(harness.state()).unwrap().march;
    assert!(march.hit.hit && march.steps.len() == march.hit.steps as usize && march.steps.len() > 1);
    let steps = format!("{} steps, hit", march.hit.steps);
    harness.get_by_label(&steps);
    assert!(found(harness.state()).unwrap().held.iter().flatten().any(|(by, _)| by.contains("sphere (line 8)")));
    harness.get_by_label("2").click();
    harness.run_steps(2);
    assert_eq!(harness.state().session.looking.chosen, Some(1));
    harness.get_by_label("From here").click();
    until(&mut harness, |app| found(app).is_some_and(|found| found.asked.from == 1));
    harness.get_by_label("Whole ray");
    harness.get_by_label("Hide the ray").click();
    harness.run_steps(2);
    assert!(harness.query_by_label("Whole ray").is_some() && harness.query_by_label("distance").is_none());
    // What the sliders change is no longer that.
    harness.state_mut().session.stage.set("size", &[0.5]);
    harness.run_steps(2);
    harness.get_by_label_contains("changed since");
    harness.get_by_label("Close what was picked").click();
    harness.run_steps(2);
    assert!(harness.query_by_label("Picked").is_none());
    // Nothing is where nothing is seen, and that is said.
    click_with(&mut harness, Modifiers::ALT, MIDDLE - vec2(0.0, 300.0));
    until(&mut harness, |app| found(app).is_some());
    harness.get_by_label("nothing is seen there");
}

#[test]
fn views_say_what_their_colours_mean_and_a_slice_is_dragged_through_the_field() {
    let folder = Folder::new("views", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    assert!(harness.query_by_label("64 steps").is_none());
    for (mode, words) in [
        (surefoot_runtime::ViewMode::Steps, "64 steps"),
        (surefoot_runtime::ViewMode::Operations, "1 million"),
        (surefoot_runtime::ViewMode::Gradient, "slope 1"),
        (surefoot_runtime::ViewMode::Factor, "of the distance"),
        (surefoot_runtime::ViewMode::Occlusion, "open"),
        (surefoot_runtime::ViewMode::Shadow, "lit"),
    ] {
        let swaps = harness.state().session.said.swaps;
        harness.state_mut().apply(vec![Command::Mode(mode)]);
        until(&mut harness, |app| app.session.said.swaps > swaps);
        harness.get_by_label(words);
    }
    let [r, g, b, _] = pixel(&mut harness, MIDDLE + vec2(0.0, 20.0));
    assert!(r == g && g == b, "a share of light has no colour: {r} {g} {b}");
    // By hand: the list of views, then the plane.
    let swaps = harness.state().session.said.swaps;
    harness.get_by_label("More views").click();
    harness.run_steps(3);
    harness.get_by_label("Slice z").click();
    until(&mut harness, |app| app.session.said.swaps > swaps);
    let [r, _, b, _] = pixel(&mut harness, MIDDLE);
    assert!(r > b, "inside is orange: {r} {b}");
    harness.state_mut().apply(vec![Command::Slice(1.5)]);
    harness.run_steps(4);
    let [r, _, b, _] = pixel(&mut harness, MIDDLE);
    assert!(b > r, "the plane is before the ball, where it is blue: {r} {b}");
    assert_eq!(harness.state().session.said.swaps, swaps + 1, "nothing is compiled for a plane that moves");
    harness.get_by_label_contains("lines every");
}

#[test]
fn keys_look_from_a_side_and_frame_what_was_picked() {
    let folder = Folder::new("sides", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    click_with(&mut harness, Modifiers::NONE, MIDDLE);
    let eye = |harness: &Harness<'_, App>| harness.state().session.camera().unwrap().eye;
    harness.key_press(Key::Num3);
    harness.run_steps(2);
    assert!((eye(&harness)[0] - 8.0).abs() < 1e-9, "{:?}", eye(&harness));
    harness.key_press(Key::Num7);
    harness.run_steps(2);
    assert!(eye(&harness)[1] > 7.9);
    harness.key_press(Key::Num1);
    harness.run_steps(2);
    assert!((eye(&harness)[2] - 8.0).abs() < 1e-9);
    // Of a solid that is known all of it is seen.
    harness.key_press(Key::F);
    harness.run_steps(2);
    let framed = harness.state().session.camera().unwrap();
    assert!(framed.target[0] > 0.5 && framed.target[0] < 2.0, "{framed:?}");
    harness.key_press(Key::Home);
    harness.run_steps(2);
    // What was picked comes nearer, and two points have a distance.
    click_with(&mut harness, Modifiers::ALT, MIDDLE);
    until(&mut harness, |app| found(app).is_some());
    harness.run_steps(2);
    click_with(&mut harness, Modifiers::NONE, pos2(500.0, 60.0));
    harness.key_press(Key::F);
    harness.run_steps(2);
    let nearer = harness.state().session.camera().unwrap();
    assert!((nearer.target[2] - 1.0).abs() < 1e-2 && nearer.eye[2] < 6.0, "{nearer:?}");
    harness.key_press(Key::Home);
    harness.run_steps(2);
    click_with(&mut harness, Modifiers::ALT, MIDDLE + vec2(0.0, -280.0));
    until(&mut harness, |app| app.session.looking.before.is_some() && !app.session.looking.is_busy());
    harness.run_steps(2);
}
