//! Help at the cursor.

use super::*;

const SMALL: &str = "/// A ball.\nshape ball = sphere(0.6)\nscene = ball\n";

fn text(harness: &Harness<'_, App>) -> String {
    harness.state().session.documents.current().text.clone()
}

fn letter(harness: &mut Harness<'_, App>, letter: &str) {
    harness.event(egui::Event::Text(letter.to_owned()));
    harness.run_steps(3);
}

/// The cursor at the end of the text, on a line of its own.
fn at_end(harness: &mut Harness<'_, App>) {
    harness.get_by_role(Role::MultilineTextInput).focus();
    harness.step();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::End);
    harness.step();
    harness.key_press(Key::ArrowLeft);
    harness.run_steps(2);
}

#[test]
fn names_are_completed_while_they_are_written() {
    let folder = Folder::new("complete", SMALL);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    at_end(&mut harness);
    for typed in [".", "t", "w", "i"] {
        letter(&mut harness, typed);
    }
    assert!(text(&harness).ends_with("scene = ball.twi\n"));
    assert!(harness.query_all_by_label_contains("warp twist(axis: vec3, rate: float)").next().is_some(), "the list is shown");
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    assert!(text(&harness).ends_with("scene = ball.twist\n"), "{}", text(&harness));
    assert!(harness.query_all_by_label_contains("warp twist(").next().is_none(), "the list is gone");
    assert!(harness.get_by_role(Role::MultilineTextInput).is_focused());
    // What was taken can be taken back.
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(3);
    assert!(!text(&harness).contains("twist"), "{}", text(&harness));
}

#[test]
fn a_list_opens_where_it_is_asked_for() {
    let folder = Folder::new("list", SMALL);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    at_end(&mut harness);
    letter(&mut harness, " ");
    letter(&mut harness, "|");
    letter(&mut harness, " ");
    assert!(harness.query_all_by_label_contains("shape ball").next().is_none());
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Space);
    harness.run_steps(3);
    // Names of the file come before those of the language.
    assert!(harness.query_all_by_label_contains("shape ball").next().is_some());
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    assert!(harness.query_all_by_label_contains("shape ball").next().is_none());
    assert!(text(&harness).ends_with("scene = ball | \n"), "{}", text(&harness));
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Space);
    harness.run_steps(3);
    harness.key_press(Key::ArrowDown);
    harness.key_press(Key::ArrowUp);
    harness.key_press(Key::Tab);
    harness.run_steps(3);
    assert!(text(&harness).ends_with("scene = ball | ball\n"), "{}", text(&harness));
    // Nothing is listed while numbers are written, or in a text that is pasted.
    letter(&mut harness, "1");
    harness.event(egui::Event::Paste(" spher".to_owned()));
    harness.run_steps(3);
    assert!(harness.query_all_by_label_contains("field sphere").next().is_none());
}

#[test]
fn a_key_goes_to_where_a_name_is_declared() {
    let folder = Folder::new("declared", SMALL);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    at_end(&mut harness);
    harness.key_press(Key::F12);
    harness.run_steps(4);
    let document = harness.state().session.documents.current();
    let state = egui::text_edit::TextEditState::load(&harness.ctx, egui::Id::unique(("source", &document.name))).unwrap_or_default();
    let range = state.cursor.char_range().unwrap_or_default().as_sorted_char_range();
    let selected: String = document.text.chars().skip(range.start.0).take(range.end.0 - range.start.0).collect();
    assert_eq!((selected.as_str(), range.start.0), ("ball", "/// A ball.\nshape ".len()));
    // Into the language's own texts, too.
    harness.key_press(Key::End);
    harness.step();
    for _ in 0.."(0.6)".len() {
        harness.key_press(Key::ArrowLeft);
    }
    harness.run_steps(2);
    harness.key_press(Key::F12);
    harness.run_steps(4);
    assert_eq!(harness.state().session.documents.current().name, "<prelude>/primitives.sdf");
}

#[test]
fn a_click_mends_a_problem() {
    let folder = Folder::new("mend", "scene = spere(1)\n");
    let mut harness = window(&folder.scene());
    until(&mut harness, |app| app.session.error().is_some());
    harness.run_steps(2);
    harness.get_by_label("Write sphere").click();
    harness.run_steps(3);
    assert_eq!(text(&harness), "scene = sphere(1)\n");
    until(&mut harness, |app| app.session.said.problems.is_empty());
}

#[test]
fn a_name_is_given_another_in_all_files() {
    let folder = Folder::new("rename", "import \"parts.sdf\"\nscene = ball | box(1)\n");
    let parts = folder.0.join("parts.sdf");
    std::fs::write(&parts, "shape ball = sphere(0.6)\n").unwrap();
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    harness.get_by_role(Role::MultilineTextInput).focus();
    harness.step();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::End);
    harness.step();
    for _ in 0.." | box(1)\n".len() {
        harness.key_press(Key::ArrowLeft);
    }
    harness.run_steps(2);
    // A name that is taken is refused, and says where.
    let write = |harness: &mut Harness<'_, App>, name: &str| {
        harness.key_press(Key::F2);
        harness.run_steps(3);
        harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        harness.step();
        harness.event(egui::Event::Text(name.to_owned()));
        harness.step();
        harness.key_press(Key::Enter);
        harness.run_steps(4);
    };
    write(&mut harness, "box");
    assert!(harness.query_all_by_label_contains("would mean something else").next().is_some());
    assert_eq!(text(&harness), "import \"parts.sdf\"\nscene = ball | box(1)\n");
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    write(&mut harness, "orb");
    assert_eq!(text(&harness), "import \"parts.sdf\"\nscene = orb | box(1)\n");
    let name = parts.to_string_lossy().into_owned();
    let other = harness.state().session.documents.all.iter().find(|document| document.name == name).unwrap();
    assert_eq!(other.text, "shape orb = sphere(0.6)\n");
    assert!(harness.get_by_role(Role::MultilineTextInput).is_focused());
}
