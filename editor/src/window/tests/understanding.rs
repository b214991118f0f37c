//! The outline, the module beside the source, and what frames take.

use super::*;
use egui_kittest::kittest::NodeT;

const PARTS: &str = "\
shape post = box(0.2).translate(0, 0, 0)
scene = sphere(1.2)
  | post.twist(y, 1).translate(3, 0, 0)
  | torus(2, 0.1)
camera { eye: (0, 0, 8), target: (0, 0, 0), fov: 40deg }
";

fn press(harness: &mut Harness<'_, App>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(3);
}

const FORTH: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

fn shot(harness: &mut Harness<'_, App>, name: &str) {
    if let Ok(shots) = std::env::var("SUREFOOT_SHOTS") {
        harness.render().unwrap().save(Path::new(&shots).join(format!("{name}.png"))).unwrap();
    }
}

#[test]
fn parts_are_shown_hidden_and_alone() {
    let folder = Folder::new("parts", PARTS);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let above = MIDDLE - egui::vec2(0.0, 80.0);
    let first = pixel(&mut harness, above);
    press(&mut harness, FORTH, Key::O);
    let root = |app: &App| app.session.parts.found().root;
    until(&mut harness, |app| root(app).is_some());
    let tree = root(harness.state()).unwrap();
    let post = tree.find("scene/union/post").unwrap();
    assert!(post.factor.is_some() && post.operations.is_some() && post.region.is_some(), "{post:?}");
    shot(&mut harness, "outline");
    // A click goes to its line.
    harness.get_by_label("post").click();
    harness.run_steps(3);
    let id = egui::Id::unique(("source", &folder.scene()));
    let at = egui::text_edit::TextEditState::load(&harness.ctx, id).unwrap().cursor.char_range().unwrap();
    assert_eq!(at.primary.index.0, PARTS.find("post.twist").unwrap());
    // Hidden: the picture is without it and says so, and the text is as it was.
    let swaps = harness.state().session.said.swaps;
    harness.get_by_label("Show sphere").click();
    until(&mut harness, |app| app.session.said.swaps > swaps);
    let hidden = pixel(&mut harness, above);
    assert_ne!(first, hidden, "the ball is not there");
    harness.get_by_label("1 part is hidden");
    shot(&mut harness, "hidden");
    let app = harness.state();
    assert_eq!((app.session.documents.current().text.as_str(), app.session.is_unsaved()), (PARTS, false));
    assert_eq!(std::fs::read_to_string(folder.scene()).unwrap(), PARTS);
    assert!(app.session.error().is_none());
    // What is written meanwhile is drawn without it too.
    let swaps = app.session.said.swaps;
    write(&mut harness, &PARTS.replace("torus(2, 0.1)", "torus(2, 0.2)"));
    until(&mut harness, |app| app.session.said.swaps > swaps);
    assert_eq!(harness.state().session.parts.found().left_out, 1);
    assert!(harness.state().session.said.drawn.sources.iter().any(|(_, file)| file.text.contains("sphere(1.2)")), "its words are of the text that is seen");
    // Alone, and all again.
    let swaps = harness.state().session.said.swaps;
    harness.get_by_label("Show the hidden parts").click();
    until(&mut harness, |app| app.session.said.swaps > swaps);
    assert!(harness.query_by_label("1 part is hidden").is_none());
    let swaps = harness.state().session.said.swaps;
    harness.get_by_label("Solo sphere").click();
    until(&mut harness, |app| app.session.said.swaps > swaps);
    harness.get_by_label("only sphere");
    let region = harness.state().session.scene().unwrap().bounds().unwrap();
    assert!(region[1][0] < 1.3, "nothing but the ball: {region:?}");
    // The last part can't be hidden, and that is said.
    harness.state_mut().apply(vec![Command::ShowAllParts, Command::Hide("scene/union".to_owned(), true)]);
    until(&mut harness, |app| app.session.parts.found().refused.is_some());
    harness.get_by_label_contains("All is shown");
    press(&mut harness, FORTH, Key::O);
    assert!(harness.query_by_label("Outline").is_none());
}

#[test]
fn the_module_stands_beside_the_source() {
    let folder = Folder::new("module", PARTS);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    press(&mut harness, FORTH, Key::G);
    harness.get_by_label("WGSL");
    let line = |harness: &mut Harness<'_, App>, line: u32| {
        let place = session::Place { file: folder.scene(), start: (line, 3), end: (line, 3) };
        harness.state_mut().apply(vec![Command::Jump(place)]);
        harness.run_steps(4);
        shot(harness, "module");
        harness.get_all_by_label_contains("Computes it:").map(|node| node.accesskit_node().label().unwrap_or_default()).collect::<Vec<_>>()
    };
    let (torus, twist) = (line(&mut harness, 4), line(&mut harness, 3));
    assert!(!torus.is_empty() && !twist.is_empty() && torus != twist, "{torus:?} {twist:?}");
    let module = &harness.state().session.scene().unwrap().module;
    let lines: Vec<&str> = module.wgsl.lines().collect();
    assert!(module.places.windows(2).all(|two| two[0].0 <= two[1].0));
    assert!(module.places.iter().all(|(line, _)| lines[*line as usize - 1].starts_with("  ")), "each is a line of a function");
}

#[test]
fn frames_and_their_passes_have_times() {
    let folder = Folder::new("passes", PARTS);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    press(&mut harness, FORTH, Key::P);
    harness.get_by_label_contains("The last pictures took");
    harness.state_mut().session.meter.size = (64, 48);
    harness.get_by_label("Measure passes").click();
    until(&mut harness, |app| app.session.passes.found.is_some());
    shot(&mut harness, "frames");
    let found = harness.state().session.passes.found.as_ref().unwrap().1.clone().unwrap();
    assert!(!found.passes.is_empty());
    let name = found.passes[0].name;
    harness.get_by_label(name);
    assert!(harness.state().session.meter.frames.iter().all(|seconds| *seconds > 0.0));
}

#[test]
fn rays_go_side_by_side_where_one_asks() {
    let folder = Folder::new("parallel", PARTS);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let drawn = |app: &App| app.session.scene().is_some_and(|scene| scene.blocks.parallel);
    harness.key_press(Key::Num9);
    harness.run_steps(2);
    let camera = harness.state().session.camera().unwrap();
    let away = surefoot_compiler::vector::sub(camera.eye, camera.target);
    assert!((away[0] - away[1]).abs() < 1e-6 && (away[1] - away[2]).abs() < 1e-6, "{away:?}");
    harness.key_press(Key::Num1);
    harness.key_press(Key::Num5);
    until(&mut harness, drawn);
    sharp(&mut harness);
    harness.key_press(Key::G);
    harness.run_steps(2);
    // 8 away and 40° high: 5.8 of the scene.
    harness.get_by_label("a square is 0.5");
    shot(&mut harness, "parallel");
    harness.key_press(Key::G);
    harness.run_steps(2);
    assert!(harness.query_by_label("a square is 0.5").is_none());
    assert!(matches!(harness.state().session.camera().unwrap().projection, surefoot_compiler::compiled::Projection::Orthographic(Some(_))));
    harness.key_press(Key::Num5);
    harness.run_steps(2);
    assert_eq!(harness.state().session.camera().unwrap().projection, surefoot_compiler::compiled::Projection::Perspective);
}
