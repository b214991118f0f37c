//! New scenes, names that are asked for, and what comes back when the window is opened again.

use super::*;

fn press(harness: &mut Harness<'_, App>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(3);
}

fn type_in(harness: &mut Harness<'_, App>, text: &str) {
    harness.event(egui::Event::Text(text.to_owned()));
    harness.run_steps(3);
}

fn text(harness: &Harness<'_, App>) -> String {
    harness.state().session.documents.current().text.clone()
}

#[test]
fn a_new_scene_is_drawn_and_saved_where_one_says() {
    let folder = Folder::new("new", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    press(&mut harness, Modifiers::COMMAND, Key::N);
    until(&mut harness, |app| app.session.said.swaps == 2);
    assert_eq!(harness.state().session.documents.current().short_name(), "untitled.sdf");
    assert!(!harness.state().session.is_unsaved(), "nobody has written anything yet");
    press(&mut harness, Modifiers::COMMAND, Key::End);
    type_in(&mut harness, "// mine\n");
    assert!(harness.state().session.is_unsaved());
    press(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    assert!(harness.get_by_label("Name").is_focused());
    pixel(&mut harness, MIDDLE);
    // A name that is taken needs more than Enter.
    type_in(&mut harness, "scene");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(std::fs::read_to_string(folder.scene()).unwrap(), SCENE);
    harness.get_by_label("Write over it");
    harness.get_by_label("Name").focus();
    harness.step();
    press(&mut harness, Modifiers::COMMAND, Key::A);
    type_in(&mut harness, "ball");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    let ball = folder.0.join("ball.sdf");
    assert_eq!(std::fs::read_to_string(&ball).unwrap(), format!("{}// mine\n", examples::TEMPLATE));
    assert_eq!(harness.state().session.documents.current().name, ball.to_string_lossy());
    assert!(!harness.state().session.is_unsaved() && !folder.0.join("untitled.sdf").exists());
    assert_eq!(harness.state().session.recent[..2], [ball.to_string_lossy().into_owned(), folder.scene()]);
    // The new file is followed.
    std::fs::write(&ball, "scene = sphere(0.5)\n").unwrap();
    until(&mut harness, |app| app.session.documents.current().text == "scene = sphere(0.5)\n");
}

#[test]
fn a_path_is_typed_and_folders_are_looked_into() {
    let folder = Folder::new("paths", SCENE);
    std::fs::create_dir_all(folder.0.join("deeper")).unwrap();
    std::fs::write(folder.0.join("deeper/ball.sdf"), "scene = sphere(1)\n").unwrap();
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    press(&mut harness, Modifiers::COMMAND, Key::O);
    harness.get_by_label("deeper/").click();
    harness.run_steps(3);
    harness.get_by_label("ball.sdf");
    harness.get_by_label("Up").click();
    harness.run_steps(3);
    harness.get_by_label("Name").focus();
    harness.step();
    type_in(&mut harness, "deeper/ball");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(text(&harness), "scene = sphere(1)\n");
    press(&mut harness, Modifiers::COMMAND, Key::O);
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.state().session.asked.is_none());
    assert!(harness.get_by_role(Role::MultilineTextInput).is_focused());
}

#[test]
fn what_a_hand_had_done_comes_back() {
    let folder = Folder::new("back", SCENE);
    std::fs::write(folder.0.join("part.sdf"), "shape part = sphere(1)\n").unwrap();
    let part = folder.0.join("part.sdf").to_string_lossy().into_owned();
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    harness.state_mut().apply(vec![
        Command::Show(part.clone()),
        Command::Set("size".to_owned(), vec![1.5]),
        Command::Choose("style".to_owned(), "ball".to_owned()),
        Command::TextSize(16.0),
        Command::Wrap(true),
        Command::Theme(theme::Choice::Light),
        Command::ShowMeasures(true),
    ]);
    drag(&mut harness, MIDDLE, MIDDLE + egui::vec2(60.0, 20.0));
    until(&mut harness, |app| app.session.said.swaps == 2);
    let save = harness.get_by_label("Save").rect();
    drag(&mut harness, egui::pos2(save.right() + 8.0, 400.0), egui::pos2(save.right() + 60.0, 400.0));
    harness.run_steps(5);
    let (wide, eye) = (harness.get_by_label("Save").rect().right(), harness.state().session.camera().unwrap().eye);
    assert!(wide > save.right() + 20.0);
    let file = folder.0.join("window.json");
    let start = Instant::now();
    // Also where the program is killed.
    while !std::fs::read_to_string(&file).is_ok_and(|text| text.contains("1.5") && text.contains("part.sdf")) {
        assert!(start.elapsed() < Duration::from_secs(5));
        std::thread::sleep(Duration::from_millis(20));
        harness.step();
    }
    for _ in 0..80 {
        std::thread::sleep(Duration::from_millis(20));
        harness.step();
    }
    drop(harness);

    let mut harness = window(&folder.scene());
    ready(&mut harness);
    harness.run_steps(3);
    let app = harness.state();
    assert_eq!((app.session.documents.all.len(), app.session.documents.current().name.as_str()), (2, part.as_str()));
    assert_eq!((app.session.open.text_size, app.session.open.wrap, app.session.open.measures), (16.0, true, true));
    assert_eq!(value(app, "size"), 1.5);
    assert_eq!(app.session.choice(app.session.parameter("style").unwrap()), Some("ball"));
    let back = app.session.camera().unwrap().eye;
    assert!(eye.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-6), "{eye:?} {back:?}");
    assert!((harness.get_by_label("Save").rect().right() - wide).abs() < 1.5, "{wide}");
    assert_eq!(harness.ctx.theme(), egui::Theme::Light);
    pixel(&mut harness, MIDDLE);
    drop(harness);

    // What the text says by now counts more, and what can't be read is as at first.
    std::fs::write(folder.scene(), SCENE.replace("size = 1 in", "size = 0.7 in")).unwrap();
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    assert_eq!(value(harness.state(), "size"), 0.7);
    drop(harness);
    std::fs::write(&file, "{\"layout\":[").unwrap();
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    assert_eq!((harness.state().session.open.text_size, harness.state().session.documents.all.len()), (theme::TEXT_SIZE, 1));
}

#[test]
fn the_first_page_has_examples_and_recent_scenes() {
    let folder = Folder::new("start", SCENE);
    let mut harness = window(&folder.scene());
    harness.state_mut().start();
    harness.run_steps(4);
    harness.get_by_label("scene.sdf");
    if let Ok(shots) = std::env::var("SUREFOOT_SHOTS") {
        harness.render().unwrap().save(Path::new(&shots).join("start.png")).unwrap();
    }
    harness.get_by_role_and_label(Role::Button, "csg").click();
    until(&mut harness, |app| !app.session.open.start && app.session.said.swaps > 0 && frames(app) > 0 && app.session.error().is_none());
    let example = examples::EXAMPLES.iter().find(|example| example.name == "csg").unwrap();
    assert_eq!(text(&harness), example.text);
    assert!(!harness.state().session.is_unsaved());
    until(&mut harness, |app| app.session.scene().is_some_and(|scene| !scene.parameters.is_empty()));
}

#[test]
fn a_picture_alone_follows_another_editor() {
    let folder = Folder::new("alone", SCENE);
    let mut harness = window(&folder.scene());
    harness.state_mut().session.open.alone = true;
    ready(&mut harness);
    assert!(harness.query_by_role(Role::MultilineTextInput).is_none() && harness.query_by_label("File").is_none());
    std::fs::write(folder.scene(), SCENE.replace("sphere(size)", "spere(size)")).unwrap();
    until(&mut harness, |app| app.session.error().is_some());
    harness.get_by_label_contains("did you mean");
    std::fs::write(folder.scene(), SCENE.replace("#d02010", "#2010d0")).unwrap();
    until(&mut harness, |app| app.session.error().is_none() && app.session.said.swaps == 2);
    let [r, g, b, _] = pixel(&mut harness, egui::pos2(550.0, 350.0));
    assert!(b > 60 && b > r && b > g, "a blue ball over all of the window: {r} {g} {b}");
}

#[test]
fn every_example_of_the_first_page_is_a_scene() {
    for example in examples::EXAMPLES {
        let scene = surefoot_compiler::compile(&FileLoader, &format!("../examples/{}.sdf", example.name), &Options::default());
        assert!(scene.compiled.is_some(), "{}", example.name);
        let picture = image::load_from_memory(example.picture).unwrap();
        assert_eq!((picture.width(), picture.height()), (256, 144), "{}", example.name);
    }
    let folder = Folder::new("template", examples::TEMPLATE);
    let scene = surefoot_compiler::compile(&FileLoader, &folder.scene(), &Options::default());
    assert!(scene.diagnostics.is_empty(), "{:?}", scene.diagnostics);
    assert!(surefoot_compiler::syntax::format(examples::TEMPLATE).is_ok_and(|text| text == examples::TEMPLATE));
}
