//! What a person types, and what the keyboard does meanwhile.

use super::*;

#[test]
fn what_is_no_text_is_never_written_over() {
    let folder = Folder::new("latin", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let latin = b"// gr\xf6\xdfe\nscene = sphere(1)\n";
    std::fs::write(folder.scene(), latin).unwrap();
    until(&mut harness, |app| app.session.documents.current().unreadable().is_some());
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    harness.run_steps(3);
    assert_eq!(std::fs::read(folder.scene()).unwrap(), latin, "nobody asked for that");
    assert!(harness.query_by_label_contains("is gone from the disk").is_none());
    assert!(harness.query_all_by_label_contains("not UTF-8").next().is_some());
}

#[test]
fn values_are_what_the_text_says_until_a_hand_moves_them() {
    let text = "param r = 0.4 in 0..1000\nparam s = 0.33333 in 0..1\nparam t = 12.3456deg in 0deg..90deg\nparam tiny = 0.0001 in 0..0.001\nparam n: int = 3 in 0..9\n\
                scene = for i in 0..n { sphere(r + s + tiny).rotate(y, t).translate(i, 0, 0) }\n";
    let folder = Folder::new("values", text);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    harness.run_steps(5);
    let app = harness.state();
    for (name, wanted) in [("r", 0.4), ("s", 0.33333), ("t", 12.3456f64.to_radians()), ("tiny", 0.0001), ("n", 3.0)] {
        assert!((value(app, name) - wanted).abs() < 1e-6 * wanted, "{name}: {}", value(app, name));
    }
    let left = |harness: &Harness<'_, App>| harness.get_by_role_and_label(Role::Slider, "tiny").rect().left();
    let before = left(&harness);
    harness.run_steps(30);
    assert_eq!(left(&harness), before, "the panel is as wide as it was");
}

#[test]
fn a_click_on_the_words_of_a_problem_goes_there() {
    let folder = Folder::new("words", "scene = sphere(1) |\n  bix(2)\n");
    let mut harness = window(&folder.scene());
    until(&mut harness, |app| app.session.error().is_some());
    harness.run_steps(2);
    let words = harness.get_all_by_label_contains("did you mean").last().unwrap().rect().center();
    harness.hover_at(words);
    harness.step();
    harness.drag_at(words);
    harness.step();
    harness.drop_at(words);
    harness.run_steps(3);
    let text = harness.get_by_role(Role::MultilineTextInput);
    assert!(text.is_focused(), "the keyboard is where the problem is");
}

#[test]
fn buttons_leave_the_keyboard_to_the_text() {
    let folder = Folder::new("keyboard", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    write(&mut harness, &SCENE.replace("size = 1", "size = 1.5"));
    harness.get_by_label("Save").click();
    harness.run_steps(3);
    assert!(!harness.state().session.is_unsaved());
    assert!(harness.get_by_role(Role::MultilineTextInput).is_focused());
    harness.get_by_label("Lay out").click();
    harness.run_steps(3);
    assert!(harness.get_by_role(Role::MultilineTextInput).is_focused());
}

#[test]
fn a_new_line_begins_where_the_one_before_did() {
    let folder = Folder::new("indent", "// one");
    let mut harness = window(&folder.scene());
    harness.get_by_role(Role::MultilineTextInput).focus();
    harness.step();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::End);
    harness.step();
    harness.key_press(Key::Enter);
    harness.step();
    // Both in one frame.
    harness.event(egui::Event::Text("field f = {".to_owned()));
    harness.key_press(Key::Enter);
    harness.step();
    harness.event(egui::Event::Text("let q = p;".to_owned()));
    harness.step();
    harness.key_press(Key::Enter);
    harness.step();
    harness.event(egui::Event::Text("length(q)".to_owned()));
    harness.step();
    harness.key_press(Key::Tab);
    harness.run_steps(2);
    assert_eq!(harness.state().session.documents.current().text, "// one\nfield f = {\n  let q = p;\n  length(q)  ");
    assert!(harness.get_by_role(Role::MultilineTextInput).is_focused());
}
