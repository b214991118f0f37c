//! What is typed is not lost: undo goes to where it was, and what is not saved when the program ends comes back.

use super::*;

/// A scene of many lines, so that its ends are not seen together.
fn long() -> String {
    let lines: String = (0..200).map(|i| format!("// {i}\n")).collect();
    format!("scene = sphere(1)\n{lines}")
}

fn text(harness: &Harness<'_, App>) -> String {
    harness.state().session.documents.current().text.clone()
}

/// Where the cursor is, in characters.
fn cursor(harness: &Harness<'_, App>) -> usize {
    let id = egui::Id::unique(("source", &harness.state().session.documents.current().name));
    let state = egui::text_edit::TextEditState::load(&harness.ctx, id).unwrap_or_default();
    state.cursor.char_range().unwrap_or_default().primary.index.0
}

/// Whether the line of the cursor is within the window.
fn is_in_view(harness: &Harness<'_, App>) -> bool {
    let line = text(harness).chars().take(cursor(harness)).filter(|c| *c == '\n').count();
    let y = harness.get_by_role(Role::MultilineTextInput).rect().top() + 4.0 + 17.0 * (line as f32 + 0.5);
    (60.0..540.0).contains(&y)
}

fn press(harness: &mut Harness<'_, App>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(60);
}

fn begin(harness: &mut Harness<'_, App>) {
    ready(harness);
    harness.get_by_role(Role::MultilineTextInput).focus();
    harness.step();
}

fn type_in(harness: &mut Harness<'_, App>, text: &str) {
    harness.event(egui::Event::Text(text.to_owned()));
    harness.run_steps(60);
}

#[test]
fn undo_and_redo_go_to_where_the_change_was() {
    let scene = long();
    let folder = Folder::new("places", &scene);
    let mut harness = window(&folder.scene());
    begin(&mut harness);
    press(&mut harness, Modifiers::CTRL, Key::Home);
    type_in(&mut harness, "// first ");
    press(&mut harness, Modifiers::CTRL, Key::End);
    type_in(&mut harness, "// last");
    let both = format!("// first {scene}// last");
    assert_eq!(text(&harness), both);

    // Away from what was changed, and back to it with each undo.
    press(&mut harness, Modifiers::CTRL, Key::Home);
    assert!(cursor(&harness) == 0 && is_in_view(&harness));
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(text(&harness), format!("// first {scene}"));
    assert_eq!(cursor(&harness), 9 + scene.len());
    assert!(is_in_view(&harness));
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(text(&harness), scene);
    assert!(cursor(&harness) == 0 && is_in_view(&harness), "{}", cursor(&harness));

    // And forth.
    press(&mut harness, Modifiers::CTRL, Key::End);
    press(&mut harness, Modifiers::COMMAND, Key::Y);
    assert!(cursor(&harness) == 9 && is_in_view(&harness), "{}", cursor(&harness));
    press(&mut harness, Modifiers::COMMAND, Key::Y);
    assert_eq!(text(&harness), both);
    assert!(cursor(&harness) == both.len() && is_in_view(&harness));
}

/// The texts that are kept for recovery.
fn kept(folder: &Folder) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder.0.join("recovery")).into_iter().flatten().flatten();
    entries.map(|entry| entry.path()).filter(|path| path.extension().is_some_and(|e| e == "txt")).collect()
}

/// Waits until so many texts are kept: a frame half a second later sends them to the disk, which may take as long again. A frame that takes long, as
/// other tests keep the machine busy, does not count.
fn wait_for_kept(harness: &mut Harness<'_, App>, folder: &Folder, count: usize) {
    let start = Instant::now();
    let half = Duration::from_millis(500);
    let mut sent: Option<Instant> = None;
    while kept(folder).len() != count {
        assert!(sent.is_none_or(|sent| sent.elapsed() < half), "{:?}", kept(folder));
        std::thread::sleep(Duration::from_millis(5));
        let is_time = start.elapsed() >= half;
        harness.step();
        if is_time && sent.is_none() {
            sent = Some(Instant::now());
        }
    }
}

#[test]
fn unsaved_text_is_on_the_disk_within_a_second_and_comes_back() {
    let folder = Folder::new("recovered", SCENE);
    let mut harness = window(&folder.scene());
    begin(&mut harness);
    assert!(kept(&folder).is_empty());
    press(&mut harness, Modifiers::CTRL, Key::Home);
    harness.event(egui::Event::Text("// not saved ".to_owned()));
    harness.run_steps(2);
    wait_for_kept(&mut harness, &folder, 1);
    // The window ends and nobody has closed it.
    drop(harness);

    let mut harness = window(&folder.scene());
    begin(&mut harness);
    assert_eq!(text(&harness), SCENE, "nothing is taken unasked");
    harness.get_by_label_contains("Unsaved text of scene.sdf was found, written just now.");
    pixel(&mut harness, MIDDLE);
    // What is typed before somebody decides takes nothing away.
    type_in(&mut harness, "// more ");
    wait_for_kept(&mut harness, &folder, 2);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    harness.get_by_label("Keep it").click();
    harness.run_steps(3);
    assert_eq!(text(&harness), format!("// not saved {SCENE}"));
    assert!(harness.query_by_label("Keep it").is_none() && harness.state().session.is_unsaved());
    wait_for_kept(&mut harness, &folder, 1);
    assert_eq!(std::fs::read_to_string(folder.scene()).unwrap(), SCENE, "it is not saved yet");
    // An undo brings back what was there.
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(text(&harness), SCENE);
    press(&mut harness, Modifiers::COMMAND, Key::Y);
    press(&mut harness, Modifiers::COMMAND, Key::S);
    assert_eq!(std::fs::read_to_string(folder.scene()).unwrap(), format!("// not saved {SCENE}"));
    wait_for_kept(&mut harness, &folder, 0);
}

#[test]
fn what_is_newer_is_said_and_what_is_dropped_is_gone() {
    let folder = Folder::new("dropped", SCENE);
    let mut harness = window(&folder.scene());
    begin(&mut harness);
    type_in(&mut harness, "// not saved ");
    wait_for_kept(&mut harness, &folder, 1);
    drop(harness);
    let theirs = SCENE.replace("size = 1 in", "size = 0.9 in");
    std::thread::sleep(Duration::from_millis(20));
    std::fs::write(folder.scene(), &theirs).unwrap();

    let mut harness = window(&folder.scene());
    begin(&mut harness);
    harness.get_by_label_contains("The file was changed after it, just now: the file is newer.");
    harness.get_by_label("Drop it").click();
    harness.run_steps(3);
    assert_eq!(text(&harness), theirs);
    assert!(!harness.state().session.is_unsaved() && harness.query_by_label("Drop it").is_none());
    wait_for_kept(&mut harness, &folder, 0);

    // What is thrown away when the window closes does not come back.
    type_in(&mut harness, "// not saved ");
    wait_for_kept(&mut harness, &folder, 1);
    let app = harness.state_mut();
    app.session.question = Some(Question::Close);
    apply(&mut app.session, &mut app.world, Command::Answer(super::super::command::Answer::Discard));
    harness.run_steps(3);
    drop(harness);
    assert!(kept(&folder).is_empty());
}

#[test]
fn the_text_of_a_part_and_of_a_file_that_is_gone_comes_back() {
    let folder = Folder::new("parts", "import \"part.sdf\" as part\nscene = part.ball\n");
    std::fs::write(folder.0.join("part.sdf"), "shape ball = sphere(1)\n").unwrap();
    let part = folder.0.join("part.sdf").to_string_lossy().into_owned();
    let open = |folder: &Folder| {
        let mut harness = window(&folder.scene());
        ready(&mut harness);
        harness
    };
    let mut harness = open(&folder);
    let app = harness.state_mut();
    apply(&mut app.session, &mut app.world, Command::Show(part.clone()));
    apply(&mut app.session, &mut app.world, Command::Edit("shape ball = sphere(2)\n".to_owned()));
    harness.run_steps(2);
    wait_for_kept(&mut harness, &folder, 1);
    drop(harness);
    let mut harness = open(&folder);
    harness.get_by_label("Show it").click();
    harness.run_steps(3);
    std::fs::remove_file(&part).unwrap();
    until(&mut harness, |app| app.session.documents.current().is_missing());
    harness.get_by_label_contains("The file itself is gone.");
    harness.get_by_label("Keep it").click();
    harness.run_steps(3);
    assert_eq!(text(&harness), "shape ball = sphere(2)\n");
}
