//! A person points at a pixel: its shape is named, and the text shows it.

use super::*;
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
