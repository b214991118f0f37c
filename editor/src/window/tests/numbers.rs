//! Numbers and colours that are changed in the text.

use super::*;

fn text(harness: &Harness<'_, App>) -> String {
    harness.state().session.documents.current().text.clone()
}

fn press(harness: &mut Harness<'_, App>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(3);
}

/// Where a character of a line is on the screen: lines are 17 points high, and a letter is so wide.
fn place(harness: &Harness<'_, App>, line: usize, column: f32) -> egui::Pos2 {
    let letter = harness.ctx.fonts_mut(|f| f.glyph_width(&theme::code_font(13.0), '0'));
    let source = harness.get_by_role(Role::MultilineTextInput).rect();
    egui::pos2(source.left() + (4.0 + column) * letter, source.top() + 4.0 + (line as f32 + 0.5) * 17.0)
}

/// Puts the cursor before what is found first in the text.
fn go_to(harness: &mut Harness<'_, App>, what: &str) {
    harness.get_by_role(Role::MultilineTextInput).focus();
    harness.step();
    let document = harness.state().session.documents.current();
    let at = document.text[..document.text.find(what).unwrap()].chars().count();
    let id = egui::Id::unique(("source", &document.name));
    let mut state = egui::text_edit::TextEditState::load(&harness.ctx, id).unwrap_or_default();
    state.cursor.set_char_range(Some(egui::text::CCursorRange::one(egui::text::CCursor::new(at))));
    state.store(&harness.ctx, id);
    harness.step();
}

#[test]
fn a_number_is_dragged_and_the_picture_follows() {
    let scene = "scene = sphere(0.50)\ncamera { eye: (0, 0, 8), target: (0, 0, 0) }\n";
    let folder = Folder::new("drag", scene);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let from = place(&harness, 0, 16.5);
    let go = |harness: &mut Harness<'_, App>, x: f32, modifiers: Modifiers| {
        harness.event(egui::Event::ModifiersChanged(modifiers));
        harness.event(egui::Event::PointerMoved(from + egui::vec2(x, 0.0)));
        harness.step();
    };
    let button = |harness: &mut Harness<'_, App>, x: f32, pressed: bool| {
        let (pos, modifiers) = (from + egui::vec2(x, 0.0), Modifiers::COMMAND);
        harness.event(egui::Event::PointerButton { pos, button: egui::PointerButton::Primary, pressed, modifiers });
        harness.step();
    };
    for _ in 0..3 {
        go(&mut harness, 0.0, Modifiers::COMMAND);
    }
    assert_eq!(harness.output().platform_output.cursor_icon, egui::CursorIcon::ResizeHorizontal);
    button(&mut harness, 0.0, true);
    let swaps = harness.state().session.said.swaps;
    for x in 1..=50 {
        go(&mut harness, 6.0 * x as f32, Modifiers::COMMAND);
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(text(&harness).starts_with("scene = sphere(1.00)\n"), "{}", text(&harness));
    // While the hand still holds it.
    until(&mut harness, |app| app.session.said.swaps > swaps);
    for x in 51..=54 {
        go(&mut harness, 6.0 * x as f32, Modifiers::COMMAND | Modifiers::SHIFT);
    }
    assert!(text(&harness).starts_with("scene = sphere(1.004)\n"), "finer: {}", text(&harness));
    if let Ok(shots) = std::env::var("SUREFOOT_SHOTS") {
        harness.render().unwrap().save(Path::new(&shots).join("drag.png")).unwrap();
    }
    button(&mut harness, 324.0, false);
    harness.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    harness.run_steps(3);
    harness.get_by_role(Role::MultilineTextInput).focus();
    harness.step();
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(text(&harness), scene, "the drag is one step");
    press(&mut harness, Modifiers::COMMAND, Key::Y);
    assert!(text(&harness).starts_with("scene = sphere(1.004)\n"));
}

/// Presses with Ctrl on a place of the text, or lets go, and moves by so many points.
fn hold(harness: &mut Harness<'_, App>, from: egui::Pos2, x: f32, pressed: Option<bool>) {
    harness.event(egui::Event::ModifiersChanged(Modifiers::COMMAND));
    harness.event(egui::Event::PointerMoved(from + egui::vec2(x, 0.0)));
    harness.step();
    if let Some(pressed) = pressed {
        let (pos, modifiers) = (from + egui::vec2(x, 0.0), Modifiers::COMMAND);
        harness.event(egui::Event::PointerButton { pos, button: egui::PointerButton::Primary, pressed, modifiers });
        harness.step();
    }
}

#[test]
fn a_number_that_is_dragged_is_a_slider_until_it_is_let_go() {
    let scene = "scene = sphere(0.50)\ncamera { eye: (0, 0, 8), target: (0, 0, 0) }\n";
    let folder = Folder::new("live", scene);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let from = place(&harness, 0, 16.5);
    for _ in 0..3 {
        hold(&mut harness, from, 0.0, None);
    }
    hold(&mut harness, from, 0.0, Some(true));
    until(&mut harness, |app| app.session.holding.as_ref().is_some_and(|holding| holding.is_live));
    let app = harness.state();
    let (swaps, modules, before) = (app.session.said.swaps, app.world.stats().modules, frames(app));
    for x in 1..=50 {
        hold(&mut harness, from, 6.0 * x as f32, None);
        std::thread::sleep(Duration::from_millis(10));
    }
    let app = harness.state();
    assert!(text(&harness).starts_with("scene = sphere(1.00)\n"), "{}", text(&harness));
    let parameter = &app.session.scene().unwrap().parameters[0];
    assert!((app.session.stage.value(parameter).unwrap()[0] - 1.0).abs() < 1e-6, "the slider is where the text is");
    assert!(frames(app) >= before + 40, "each move is drawn: {}", frames(app) - before);
    assert_eq!((app.session.said.swaps, app.world.stats().modules), (swaps, modules), "and nothing is compiled for it");
    assert!(harness.query_by_role(Role::Slider).is_none(), "the panel has no slider for it");
    assert!(app.session.moved().is_empty() && app.session.said.problems.is_empty());
    // Beyond the slider's range there is another slider.
    for x in 51..=90 {
        hold(&mut harness, from, 6.0 * x as f32, None);
    }
    until(&mut harness, |app| app.session.said.swaps > swaps && app.session.holding.as_ref().is_some_and(|holding| holding.is_live));
    let app = harness.state();
    let parameter = &app.session.scene().unwrap().parameters[0];
    assert!((app.session.stage.value(parameter).unwrap()[0] - 1.4).abs() < 1e-6);
    let swaps = app.session.said.swaps;
    hold(&mut harness, from, 540.0, Some(false));
    harness.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    until(&mut harness, |app| app.session.said.swaps > swaps);
    let app = harness.state();
    assert!(app.session.holding.is_none() && app.session.scene().unwrap().parameters.is_empty(), "the text is compiled as it is");
    assert!(text(&harness).starts_with("scene = sphere(1.40)\n"), "{}", text(&harness));
    let read = |app: &App| app.session.said.words.sources.iter().any(|(_, file)| file.text.starts_with("scene = sphere(1.40)"));
    assert!(read(harness.state()));
}

#[test]
fn a_number_that_can_be_no_slider_is_compiled_as_it_is_dragged() {
    let scene = "param size = 0.5 in 0.1..2\nscene = sphere(size)\ncamera { eye: (0, 0, 8), target: (0, 0, 0) }\n";
    let folder = Folder::new("refused", scene);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let swaps = harness.state().session.said.swaps;
    let from = place(&harness, 0, 13.5);
    for _ in 0..3 {
        hold(&mut harness, from, 0.0, None);
    }
    hold(&mut harness, from, 0.0, Some(true));
    assert!(harness.state().session.holding.is_some());
    until(&mut harness, |app| app.session.holding.is_none());
    for x in 1..=5 {
        hold(&mut harness, from, 6.0 * x as f32, None);
    }
    assert!(text(&harness).starts_with("param size = 1.0 in"), "{}", text(&harness));
    until(&mut harness, |app| app.session.said.swaps > swaps && value(app, "size") == 1.0);
    assert!(harness.state().session.said.problems.is_empty());
    hold(&mut harness, from, 30.0, Some(false));
}

#[test]
fn a_number_at_the_cursor_is_changed_by_keys() {
    let folder = Folder::new("arrows", "scene = box(1.5).rotate(y, 30deg)\n");
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    go_to(&mut harness, "1.5");
    press(&mut harness, Modifiers::ALT, Key::ArrowUp);
    press(&mut harness, Modifiers::ALT, Key::ArrowUp);
    press(&mut harness, Modifiers::ALT | Modifiers::SHIFT, Key::ArrowDown);
    assert_eq!(text(&harness), "scene = box(1.69).rotate(y, 30deg)\n");
    go_to(&mut harness, "30deg");
    press(&mut harness, Modifiers::ALT, Key::ArrowDown);
    assert_eq!(text(&harness), "scene = box(1.69).rotate(y, 29deg)\n");
    assert!(harness.get_by_role(Role::MultilineTextInput).is_focused());
}

#[test]
fn a_colour_is_picked() {
    let folder = Folder::new("colour", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    harness.get_by_role_and_label(Role::ColorWell, "Colour #d02010").click();
    harness.run_steps(4);
    pixel(&mut harness, MIDDLE);
    harness.event(egui::Event::Text("#2010d0".to_owned()));
    harness.run_steps(3);
    assert_eq!(text(&harness), SCENE.replace("#d02010", "#2010d0"));
    until(&mut harness, |app| app.session.said.swaps == 2);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert!(harness.query_by_label("Colour").is_none(), "it is closed");
    assert!(harness.get_by_role(Role::MultilineTextInput).is_focused());
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(text(&harness), SCENE, "one step");

    go_to(&mut harness, "d02010");
    press(&mut harness, Modifiers::COMMAND, Key::K);
    harness.get_by_label("Colour");
    for typed in ["#fff", "fff"] {
        harness.event(egui::Event::Text(typed.to_owned()));
        harness.run_steps(2);
    }
    assert_eq!(text(&harness), SCENE.replace("#d02010", "#ffffff"));
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.query_by_label("Colour").is_none());
}

#[test]
fn an_advice_is_taken_by_a_key() {
    let folder = Folder::new("advice", "scene = spere(1)\n");
    let mut harness = window(&folder.scene());
    until(&mut harness, |app| app.session.error().is_some());
    harness.get_by_role(Role::MultilineTextInput).focus();
    harness.step();
    press(&mut harness, Modifiers::COMMAND, Key::Period);
    assert_eq!(text(&harness), "scene = sphere(1)\n");
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(text(&harness), "scene = spere(1)\n");
}
