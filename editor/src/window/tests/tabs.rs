//! Several texts in tabs, how large they are written, and what is put in place of words.

use super::*;

const PART: &str = "shape part = sphere(0.5)\n";

fn two(test: &str) -> (Folder, Harness<'static, App>) {
    let folder = Folder::new(test, "import \"part.sdf\" as part\nscene = part.part | box(1)\n");
    std::fs::write(folder.0.join("part.sdf"), PART).unwrap();
    let mut harness = window(&folder.scene());
    until(&mut harness, |app| app.session.said.words.files.len() > 1);
    (folder, harness)
}

fn text(harness: &Harness<'_, App>) -> String {
    harness.state().session.documents.current().text.clone()
}

fn press(harness: &mut Harness<'_, App>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(3);
}

fn type_in(harness: &mut Harness<'_, App>, text: &str) {
    harness.event(egui::Event::Text(text.to_owned()));
    harness.run_steps(3);
}

#[test]
fn texts_are_opened_turned_over_and_closed() {
    let (folder, mut harness) = two("tabs");
    harness.get_by_label("Parts").click();
    harness.run_steps(3);
    let part = folder.0.join("part.sdf").to_string_lossy().into_owned();
    harness.get_by_label(&part).click();
    harness.run_steps(3);
    assert_eq!(text(&harness), PART);
    let shown = |harness: &Harness<'_, App>| harness.state().session.documents.shown;
    for (modifiers, now) in [(Modifiers::COMMAND, 0), (Modifiers::COMMAND | Modifiers::SHIFT, 1), (Modifiers::COMMAND, 0)] {
        press(&mut harness, modifiers, Key::Tab);
        assert_eq!(shown(&harness), now);
        assert!(harness.get_by_role(Role::MultilineTextInput).is_focused());
    }
    press(&mut harness, Modifiers::COMMAND, Key::W);
    assert_eq!(harness.state().session.documents.all.len(), 2, "the scene's own text stays");
    harness.get_by_role_and_label(Role::Tab, "part.sdf").click();
    harness.run_steps(3);

    // One with edits asks.
    write(&mut harness, "shape part = sphere(0.25)\n");
    harness.get_by_role_and_label(Role::Tab, "part.sdf, not saved");
    pixel(&mut harness, MIDDLE);
    press(&mut harness, Modifiers::COMMAND, Key::W);
    assert!(matches!(harness.state().session.question, Some(Question::CloseText(_))));
    harness.get_by_label("Cancel").click();
    harness.run_steps(3);
    assert_eq!(shown(&harness), 1);
    harness.get_by_label("Close part.sdf").click();
    harness.run_steps(3);
    harness.get_by_label("Throw away").click();
    harness.run_steps(3);
    assert_eq!((harness.state().session.documents.all.len(), shown(&harness)), (1, 0));
    assert!(!harness.state().session.is_unsaved());
    assert_eq!(std::fs::read_to_string(folder.0.join("part.sdf")).unwrap(), PART);

    // The middle button closes one without edits.
    harness.state_mut().apply(vec![Command::Show(part)]);
    harness.run_steps(3);
    let at = harness.get_by_role_and_label(Role::Tab, "part.sdf").rect().center();
    harness.hover_at(at);
    harness.step();
    for pressed in [true, false] {
        harness.event(egui::Event::PointerButton { pos: at, button: egui::PointerButton::Middle, pressed, modifiers: Modifiers::NONE });
        harness.step();
    }
    harness.run_steps(2);
    assert_eq!(harness.state().session.documents.all.len(), 1);
}

#[test]
fn the_text_grows_and_wraps() {
    let long = format!("scene = sphere(1) // {}\n", "long ".repeat(60));
    let folder = Folder::new("grows", &long);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let width = |harness: &Harness<'_, App>| harness.get_by_role(Role::MultilineTextInput).rect().width();
    let before = width(&harness);
    press(&mut harness, Modifiers::COMMAND, Key::Plus);
    press(&mut harness, Modifiers::COMMAND, Key::Plus);
    assert_eq!(harness.state().session.open.text_size, 15.0);
    assert!(width(&harness) > 1.1 * before, "{before} {}", width(&harness));
    assert_eq!(harness.ctx.zoom_factor(), 1.0, "and nothing else");
    press(&mut harness, Modifiers::COMMAND, Key::Num0);
    assert_eq!(width(&harness), before);
    press(&mut harness, Modifiers::ALT, Key::Z);
    assert!(width(&harness) < 500.0, "{}", width(&harness));
    pixel(&mut harness, MIDDLE);
    press(&mut harness, Modifiers::ALT, Key::Z);
    assert_eq!(width(&harness), before);
}

#[test]
fn words_are_replaced_one_by_one_and_all_at_once() {
    let scene = "// ball, Ball and balls\nscene = sphere(1) // ball\n";
    let folder = Folder::new("replace", scene);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    harness.get_by_role(Role::MultilineTextInput).focus();
    harness.step();
    press(&mut harness, Modifiers::CTRL, Key::Home);
    press(&mut harness, Modifiers::COMMAND, Key::H);
    type_in(&mut harness, "ball");
    harness.get_by_label("1 of 4");
    harness.get_by_label("Capitals count").click();
    harness.run_steps(3);
    harness.get_by_label("1 of 3");
    harness.get_by_label("Whole words only").click();
    harness.run_steps(3);
    harness.get_by_label("1 of 2");
    harness.get_by_label("Replace by").focus();
    harness.step();
    type_in(&mut harness, "orb");
    pixel(&mut harness, MIDDLE);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(text(&harness), "// orb, Ball and balls\nscene = sphere(1) // ball\n");
    harness.get_by_label("1 of 1");
    harness.get_by_label("Whole words only").click();
    harness.get_by_label("Capitals count").click();
    harness.run_steps(3);
    harness.get_by_label("Replace by").focus();
    harness.step();
    press(&mut harness, Modifiers::COMMAND, Key::Enter);
    assert_eq!(text(&harness), "// orb, orb and orbs\nscene = sphere(1) // orb\n");
    harness.get_by_label("nothing");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.get_by_role(Role::MultilineTextInput).is_focused());
    // Typing at once is a step of its own.
    type_in(&mut harness, "x");
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(text(&harness), "// orb, orb and orbs\nscene = sphere(1) // orb\n");
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(text(&harness), "// orb, Ball and balls\nscene = sphere(1) // ball\n", "all at once is one step");
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(text(&harness), scene);
    for _ in 0..2 {
        press(&mut harness, Modifiers::COMMAND, Key::Y);
    }
    assert_eq!(text(&harness), "// orb, orb and orbs\nscene = sphere(1) // orb\n");
}
