//! The commonest things that a person does, each by the keyboard alone: the list of `docs/editor.md`. And what a screen reader is told.

use super::*;
use egui::accesskit::Action;
use egui_kittest::kittest::{NodeT, by};

fn press(harness: &mut Harness<'_, App>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(4);
}

fn type_in(harness: &mut Harness<'_, App>, text: &str) {
    harness.event(egui::Event::Text(text.to_owned()));
    harness.run_steps(4);
}

fn text(harness: &Harness<'_, App>) -> String {
    harness.state().session.documents.current().text.clone()
}

const CMD: Modifiers = Modifiers::COMMAND;
const CMD_SHIFT: Modifiers = Modifiers { shift: true, ..Modifiers::COMMAND };

/// A window whose text has the keyboard, with the cursor in a line and column.
fn at(folder: &Folder, line: usize, column: usize) -> Harness<'static, App> {
    let mut harness = window(&folder.scene());
    until(&mut harness, |app| app.session.said.swaps > 0 || app.session.error().is_some());
    press(&mut harness, Modifiers::NONE, Key::F6);
    assert!(harness.get_by_role(Role::MultilineTextInput).is_focused());
    press(&mut harness, Modifiers::CTRL, Key::Home);
    for _ in 0..line {
        press(&mut harness, Modifiers::NONE, Key::ArrowDown);
    }
    for _ in 0..column {
        harness.key_press(Key::ArrowRight);
        harness.step();
    }
    harness
}

#[test]
fn one_opens_makes_and_saves_scenes() {
    let folder = Folder::new("k-files", SCENE);
    std::fs::write(folder.0.join("other.sdf"), "scene = box(1)\n").unwrap();
    let mut harness = at(&folder, 0, 0);
    // 1: open a scene.
    press(&mut harness, CMD, Key::O);
    type_in(&mut harness, "other");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(text(&harness), "scene = box(1)\n");
    // 2: write, 3: save.
    press(&mut harness, Modifiers::CTRL, Key::End);
    type_in(&mut harness, "// written");
    press(&mut harness, CMD, Key::S);
    assert_eq!(std::fs::read_to_string(folder.0.join("other.sdf")).unwrap(), "scene = box(1)\n// written");
    // 4: save under another name.
    press(&mut harness, CMD_SHIFT, Key::S);
    type_in(&mut harness, "third");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert!(folder.0.join("third.sdf").is_file());
    // 5: a new scene; edits are asked for first.
    type_in(&mut harness, " more");
    press(&mut harness, CMD, Key::N);
    assert!(matches!(harness.state().session.question, Some(Question::New(..))));
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(text(&harness), examples::TEMPLATE);
    assert_eq!(std::fs::read_to_string(folder.0.join("third.sdf")).unwrap(), "scene = box(1)\n// written more");
}

#[test]
fn one_undoes_finds_and_replaces() {
    let folder = Folder::new("k-find", "scene = sphere(1) // one\n// two one\n");
    let mut harness = at(&folder, 2, 0);
    // 6: undo and redo.
    type_in(&mut harness, "// three");
    press(&mut harness, CMD, Key::Z);
    assert_eq!(text(&harness), "scene = sphere(1) // one\n// two one\n");
    press(&mut harness, CMD, Key::Y);
    assert!(text(&harness).ends_with("// three"));
    // 7: find.
    press(&mut harness, CMD, Key::F);
    type_in(&mut harness, "one");
    harness.get_by_label("1 of 2");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    harness.get_by_label("2 of 2");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    // 8: replace all.
    press(&mut harness, CMD, Key::H);
    press(&mut harness, Modifiers::NONE, Key::Tab);
    for _ in 0..8 {
        if harness.get_by_label("Replace by").is_focused() {
            break;
        }
        press(&mut harness, Modifiers::NONE, Key::Tab);
    }
    type_in(&mut harness, "1");
    press(&mut harness, CMD, Key::Enter);
    assert_eq!(text(&harness), "scene = sphere(1) // 1\n// two 1\n// three");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    // 9: go to a line.
    press(&mut harness, CMD, Key::G);
    type_in(&mut harness, "2");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    type_in(&mut harness, "// here ");
    assert_eq!(text(&harness), "scene = sphere(1) // 1\n// here // two 1\n// three");
}

#[test]
fn one_is_helped_while_writing() {
    let folder = Folder::new("k-help", "shape ball = spere(1)\nscene   = ball\n");
    let mut harness = at(&folder, 0, 15);
    until(&mut harness, |app| app.session.error().is_some());
    // 10: take an advice.
    press(&mut harness, CMD, Key::Period);
    assert_eq!(text(&harness), "shape ball = sphere(1)\nscene   = ball\n");
    // 11: go to a definition.
    press(&mut harness, Modifiers::CTRL, Key::End);
    press(&mut harness, Modifiers::NONE, Key::ArrowLeft);
    press(&mut harness, Modifiers::NONE, Key::ArrowLeft);
    press(&mut harness, Modifiers::NONE, Key::F12);
    press(&mut harness, Modifiers::NONE, Key::ArrowRight);
    // 12: another name.
    press(&mut harness, Modifiers::NONE, Key::F2);
    harness.get_by_label("New name");
    press(&mut harness, CMD, Key::A);
    type_in(&mut harness, "orb");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(text(&harness), "shape orb = sphere(1)\nscene   = orb\n");
    // 13: lay out.
    press(&mut harness, CMD_SHIFT, Key::I);
    assert_eq!(text(&harness), "shape orb = sphere(1)\nscene = orb\n");
    // 14: complete a name.
    press(&mut harness, Modifiers::CTRL, Key::End);
    type_in(&mut harness, "shape other = cylin");
    press(&mut harness, CMD, Key::Space);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert!(text(&harness).contains("shape other = cylinder"), "{}", text(&harness));
    // 15: make a comment of the line.
    press(&mut harness, CMD, Key::Slash);
    assert!(text(&harness).contains("\n// shape other"), "{}", text(&harness));
}

#[test]
fn one_changes_numbers_colours_and_sliders_and_looks() {
    let folder = Folder::new("k-looks", SCENE);
    let mut harness = at(&folder, 0, 13);
    // 16: change a number.
    press(&mut harness, Modifiers::ALT | Modifiers::SHIFT, Key::ArrowUp);
    assert!(text(&harness).starts_with("param size = 1.1 in"), "{}", text(&harness));
    press(&mut harness, CMD, Key::Z);
    // 17: pick a colour.
    for key in [Key::ArrowDown, Key::ArrowDown, Key::ArrowRight] {
        press(&mut harness, Modifiers::NONE, key);
    }
    press(&mut harness, CMD, Key::K);
    type_in(&mut harness, "#102030");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(text(&harness), SCENE.replace("#d02010", "#102030"));
    // 18: move a slider.
    press(&mut harness, Modifiers::NONE, Key::F6);
    assert!(harness.get_by_role_and_label(Role::Slider, "size").is_focused());
    press(&mut harness, Modifiers::NONE, Key::ArrowRight);
    assert!(value(harness.state(), "size") > 1.0);
    // 19: turn the camera, come nearer, go home.
    press(&mut harness, Modifiers::NONE, Key::F6);
    let home = harness.state().session.camera().unwrap();
    press(&mut harness, Modifiers::NONE, Key::ArrowRight);
    press(&mut harness, Modifiers::NONE, Key::PageUp);
    let moved = harness.state().session.camera().unwrap();
    assert!(moved.eye[0] < -0.2 && surefoot_compiler::vector::length(moved.eye) < 7.5, "{moved:?}");
    press(&mut harness, Modifiers::NONE, Key::Home);
    assert_eq!(harness.state().session.camera().unwrap(), home);
    // 20: each view.
    for (key, (mode, ..)) in [Key::Num2, Key::Num3, Key::Num4, Key::Num1].into_iter().zip([1, 2, 3, 0].map(|i| panels::modes::MODES[i])) {
        press(&mut harness, CMD, key);
        assert_eq!(harness.state().session.look.mode, mode);
    }
    press(&mut harness, Modifiers::NONE, Key::F6);
    assert!(harness.get_by_role(Role::MultilineTextInput).is_focused());
    // And the keys themselves.
    press(&mut harness, Modifiers::NONE, Key::F1);
    harness.get_by_label("pick a colour");
    if let Ok(shots) = std::env::var("SUREFOOT_SHOTS") {
        harness.render().unwrap().save(Path::new(&shots).join("keys.png")).unwrap();
    }
    press(&mut harness, Modifiers::NONE, Key::F1);
    assert!(harness.query_by_label("pick a colour").is_none());
}

#[test]
fn the_picture_is_written_into_a_file() {
    let folder = Folder::new("k-picture", SCENE);
    let mut harness = at(&folder, 0, 0);
    press(&mut harness, CMD_SHIFT, Key::E);
    // A picture is no scene, whatever its name.
    press(&mut harness, CMD, Key::A);
    type_in(&mut harness, "scene.sdf");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    until(&mut harness, |app| app.session.notice.is_some());
    let written = image::open(folder.0.join("scene.png")).unwrap().to_rgb8();
    assert_eq!(written.dimensions(), (1920, 1080));
    let [r, g, b] = written.get_pixel(960, 540).0;
    assert!(r > 60 && r > 2 * g && r > 2 * b, "the red ball: {r} {g} {b}");
    harness.get_by_label_contains("The picture is in");
    assert_eq!(std::fs::read_to_string(folder.scene()).unwrap(), SCENE);
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.state().session.notice.is_none());
}

/// What can have the keyboard and has no name.
fn nameless(harness: &Harness<'_, App>) -> Vec<String> {
    let nodes = harness.query_all(by().predicate(|node| node.data().supports_action(Action::Focus)));
    let named = |label: Option<String>| label.is_some_and(|label| !label.trim().is_empty());
    nodes.filter(|node| !named(node.accesskit_node().label())).map(|node| format!("{:?} at {:?}", node.accesskit_node().role(), node.rect())).collect()
}

#[test]
fn all_that_can_have_the_keyboard_has_a_name() {
    let folder = Folder::new("k-names", &format!("import \"part.sdf\" as part\n{SCENE}param on = true\nparam at = vec3(0) in vec3(-1)..vec3(1)\n"));
    std::fs::write(folder.0.join("part.sdf"), "shape part = sphere(1)\n").unwrap();
    let mut harness = at(&folder, 0, 0);
    let part = folder.0.join("part.sdf").to_string_lossy().into_owned();
    harness.state_mut().apply(vec![Command::Show(part), Command::ShowMeasures(true), Command::ShowOutline(true), Command::ShowShader(true), Command::ShowFrames(true)]);
    until(&mut harness, |app| app.session.parts.found().root.is_some());
    harness.run_steps(3);
    let check = |harness: &Harness<'_, App>, what: &str| assert!(nameless(harness).is_empty(), "{what}: {:#?}", nameless(harness));
    check(&harness, "the window");
    assert!(harness.query_all(by().predicate(|node| node.data().supports_action(Action::Focus))).count() > 25);
    for (modifiers, key, what) in [(CMD, Key::H, "replace"), (CMD, Key::O, "open"), (Modifiers::NONE, Key::F1, "keys")] {
        press(&mut harness, modifiers, key);
        check(&harness, what);
        press(&mut harness, Modifiers::NONE, Key::Escape);
    }
    for menu in ["File", "View"] {
        harness.get_by_label(menu).click();
        harness.run_steps(3);
        check(&harness, menu);
        press(&mut harness, Modifiers::NONE, Key::Escape);
    }
    harness.state_mut().start();
    harness.run_steps(3);
    check(&harness, "the first page");
}
