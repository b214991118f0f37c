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

/// What is selected in the text.
fn selected(harness: &Harness<'_, App>) -> String {
    let document = harness.state().session.documents.current();
    let id = egui::Id::unique(("source", &document.name));
    let state = egui::text_edit::TextEditState::load(&harness.ctx, id).unwrap_or_default();
    let range = state.cursor.char_range().unwrap_or_default().as_sorted_char_range();
    document.text.chars().skip(range.start.0).take(range.end.0 - range.start.0).collect()
}

fn type_in(harness: &mut Harness<'_, App>, text: &str) {
    harness.event(egui::Event::Text(text.to_owned()));
    harness.run_steps(3);
}

#[test]
fn words_and_lines_are_found() {
    let folder = Folder::new("find", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::F);
    harness.run_steps(3);
    type_in(&mut harness, "style");
    harness.get_by_label("1 of 2");
    for (modifiers, key, at) in [(Modifiers::NONE, Key::Enter, 2), (Modifiers::NONE, Key::Enter, 1), (Modifiers::SHIFT, Key::Enter, 2), (Modifiers::NONE, Key::F3, 1)] {
        harness.key_press_modifiers(modifiers, key);
        harness.run_steps(3);
        harness.get_by_label(&format!("{at} of 2"));
    }
    pixel(&mut harness, MIDDLE);
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    assert_eq!(selected(&harness), "style");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::F);
    harness.run_steps(3);
    harness.get_by_label("1 of 2");
    type_in(&mut harness, "style and more");
    harness.get_by_label("nothing");
    assert_eq!(harness.state().session.documents.current().text, SCENE, "what is typed is no text");
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    assert!(harness.state().session.search.is_none());
    assert!(harness.get_by_role(Role::MultilineTextInput).is_focused());

    harness.key_press_modifiers(Modifiers::COMMAND, Key::G);
    harness.run_steps(3);
    type_in(&mut harness, "8");
    assert_eq!(harness.state().session.search.as_ref().map(|search| &*search.wanted), Some(":8"));
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    assert!(harness.state().session.search.is_none());
    type_in(&mut harness, "// here: ");
    assert_eq!(harness.state().session.documents.current().text.lines().nth(7).unwrap().split(' ').nth(1), Some("here:"));
}

#[test]
fn lines_become_comments_move_and_come_back() {
    let folder = Folder::new("comments", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let text = |harness: &Harness<'_, App>| harness.state().session.documents.current().text.clone();
    harness.get_by_role(Role::MultilineTextInput).focus();
    harness.step();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Slash);
    harness.run_steps(2);
    assert!(text(&harness).lines().all(|line| line.starts_with("// ")));
    until(&mut harness, |app| app.session.error().is_some());
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Slash);
    harness.run_steps(2);
    assert_eq!(text(&harness), SCENE);
    until(&mut harness, |app| app.session.error().is_none());
    harness.key_press(Key::Tab);
    harness.run_steps(2);
    assert!(text(&harness).lines().all(|line| line.starts_with("  ")));
    harness.key_press_modifiers(Modifiers::SHIFT, Key::Tab);
    harness.run_steps(2);
    assert_eq!(text(&harness), SCENE);
    // An undo takes it back as any other edit.
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Slash);
    harness.run_steps(2);
    std::thread::sleep(Duration::from_millis(50));
    harness.run_steps(40);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(2);
    assert_eq!(text(&harness), SCENE);
}

/// Where the cursor is, in characters.
fn cursor(harness: &Harness<'_, App>) -> usize {
    let id = egui::Id::unique(("source", &harness.state().session.documents.current().name));
    let state = egui::text_edit::TextEditState::load(&harness.ctx, id).unwrap_or_default();
    state.cursor.char_range().unwrap_or_default().primary.index.0
}

#[test]
fn an_undo_takes_back_lines_and_no_moves_of_the_cursor() {
    let folder = Folder::new("undo", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let text = |harness: &Harness<'_, App>| harness.state().session.documents.current().text.clone();
    let undo = |harness: &mut Harness<'_, App>| {
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        harness.run_steps(2);
    };
    harness.get_by_role(Role::MultilineTextInput).focus();
    harness.step();
    harness.key_press_modifiers(Modifiers::CTRL, Key::Home);
    harness.step();
    // Fast, without a pause.
    for line in ["// one", "// two"] {
        harness.event(egui::Event::Text(line.to_owned()));
        harness.step();
        harness.key_press(Key::Enter);
        harness.step();
    }
    harness.run_steps(1);
    assert_eq!(text(&harness), format!("// one\n// two\n{SCENE}"));
    for _ in 0..3 {
        harness.key_press(Key::ArrowDown);
        harness.run_steps(20);
    }
    undo(&mut harness);
    let once = text(&harness);
    assert!(once.starts_with("// one\n") && once.len() < SCENE.len() + 14, "a move of the cursor is no step: {once}");
    harness.key_press(Key::ArrowUp);
    harness.run_steps(20);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Y);
    harness.run_steps(2);
    assert_eq!(text(&harness), format!("// one\n// two\n{SCENE}"), "nor the end of what can be brought back");
    for _ in 0..6 {
        undo(&mut harness);
    }
    assert_eq!(text(&harness), SCENE);
}

#[test]
fn the_cursor_stays_in_its_line_when_another_program_writes_and_goes_by_pages() {
    let lines: String = (0..300).map(|i| format!("// {i}\n")).collect();
    let scene = format!("scene = sphere(1)\n{lines}");
    let folder = Folder::new("cursor", &scene);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let line = |harness: &Harness<'_, App>| {
        let text = &harness.state().session.documents.current().text;
        text.chars().take(cursor(harness)).filter(|c| *c == '\n').count()
    };
    harness.get_by_role(Role::MultilineTextInput).focus();
    harness.step();
    harness.key_press_modifiers(Modifiers::CTRL, Key::Home);
    harness.step();
    harness.key_press(Key::PageDown);
    harness.run_steps(3);
    let page = line(&harness);
    assert!((5..100).contains(&page), "{page} lines");
    harness.key_press(Key::PageDown);
    harness.run_steps(3);
    assert_eq!(line(&harness), 2 * page);
    std::fs::write(folder.scene(), format!("// before\n// it\n{scene}")).unwrap();
    until(&mut harness, |app| app.session.documents.current().text.starts_with("// before"));
    harness.run_steps(3);
    assert_eq!(line(&harness), 2 * page + 2);
    harness.key_press(Key::PageUp);
    harness.run_steps(3);
    assert_eq!(line(&harness), page + 2);
    for _ in 0..4 {
        harness.key_press(Key::PageUp);
        harness.run_steps(3);
    }
    assert_eq!(line(&harness), 0);
}
