//! The whole window, without a screen: what it shows, and what a hand does to it. Needs a graphics adapter; a program will do.

mod assist;
mod changing;
mod effort;
mod files;
mod keyboard;
mod looking;
mod measures;
mod numbers;
mod random;
mod tabs;
mod timeline;
mod typing;
mod understanding;
mod unsaved;
mod views;

use super::*;
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::path::{Path, PathBuf};
use surefoot_compiler::diagnostic::Severity;

const SCENE: &str = "\
param size = 1 in 0.2..2 \"how large\"
param turn = 30deg in 0deg..90deg
param tint = #d02010
param style = block in [block, ball]
shape block = box(1)
shape ball = sphere(0.6)
material paint { color: tint, roughness: 1 }
scene = sphere(size).material(paint) | style.rotate(y, turn).translate(3, 0, 0)
camera { eye: (0, 0, 8), target: (0, 0, 0), fov: 40deg }
";

/// A folder of its own with a scene in it; gone when it is dropped.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str, text: &str) -> Self {
        let name = format!("surefoot-window-{}-{test}", std::process::id());
        let folder = Self(std::env::temp_dir().join(name));
        std::fs::create_dir_all(&folder.0).unwrap();
        std::fs::write(folder.scene(), text).unwrap();
        folder
    }

    fn scene(&self) -> String {
        self.0.join("scene.sdf").to_string_lossy().into_owned()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).ok();
    }
}

fn window(scene: &str) -> Harness<'static, App> {
    window_that_reads(scene, Arc::new(FileLoader))
}

fn window_that_reads(scene: &str, loader: SharedLoader) -> Harness<'static, App> {
    let scene = scene.to_owned();
    let recovery = Recovery::within(Some(Path::new(&scene).with_file_name("recovery")));
    let builder =
        Harness::builder().with_size([1100.0, 700.0]).with_max_steps(2).with_step_dt(0.02).wgpu();
    let mut harness = builder.build_eframe(move |cc| {
        App::new(cc, &scene, Options::default(), loader, recovery, Log::default()).unwrap()
    });
    // One picture is enough, but where stills are looked at.
    harness.state_mut().canvas.as_mut().unwrap().set_still(1);
    until(&mut harness, |app| !app.session.said.words.files.is_empty());
    until(&mut harness, |app| app.session.said.failure.is_none());
    harness
}

/// Shows frames until something is so.
fn until(harness: &mut Harness<'_, App>, so: impl Fn(&App) -> bool) {
    let start = Instant::now();
    while !so(harness.state()) {
        let said = &harness.state().session.said;
        assert!(start.elapsed() < Duration::from_secs(30), "waited too long: {:?} {:?}", said.failure, said.drawing);
        std::thread::sleep(Duration::from_millis(5));
        harness.step();
    }
    harness.step();
}

/// Until something is drawn: a scene that moves is never drawn to its end.
fn begun(harness: &mut Harness<'_, App>) {
    until(harness, |app| app.session.said.swaps > 0 && frames(app) > 0);
}

fn ready(harness: &mut Harness<'_, App>) {
    begun(harness);
    sharp(harness);
}

/// Waits until all pixels are drawn.
fn sharp(harness: &mut Harness<'_, App>) {
    until(harness, |app| app.canvas.as_ref().unwrap().is_sharp());
}

fn frames(app: &App) -> u64 {
    app.canvas.as_ref().unwrap().frames()
}

/// Replaces the whole text, as a hand would.
fn write(harness: &mut Harness<'_, App>, text: &str) {
    harness.get_by_role(Role::MultilineTextInput).focus();
    harness.step();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    harness.event(egui::Event::Paste(text.to_owned()));
    harness.step();
    harness.step();
    assert_eq!(harness.state().session.documents.current().text, text);
}

fn drag(harness: &mut Harness<'_, App>, from: egui::Pos2, to: egui::Pos2) {
    harness.hover_at(from);
    harness.step();
    harness.drag_at(from);
    harness.step();
    harness.hover_at(from.lerp(to, 0.5));
    harness.step();
    harness.hover_at(to);
    harness.step();
    harness.drop_at(to);
    harness.step();
}

fn double_click(harness: &mut Harness<'_, App>, at: egui::Pos2) {
    harness.hover_at(at);
    harness.step();
    for _ in 0..2 {
        harness.drag_at(at);
        harness.step();
        harness.drop_at(at);
        harness.step();
    }
}

fn value(app: &App, name: &str) -> f64 {
    let stage = &app.session.stage;
    stage.value(app.session.parameter(name).unwrap()).unwrap()[0]
}

/// The picture's colour at a place of the window.
fn pixel(harness: &mut Harness<'_, App>, at: egui::Pos2) -> [u8; 4] {
    sharp(harness);
    let image = harness.render().unwrap();
    if let Ok(folder) = std::env::var("SUREFOOT_SHOTS") {
        let test = std::thread::current().name().unwrap_or("test").replace("::", "_");
        image.save(Path::new(&folder).join(format!("{test}.png"))).unwrap();
    }
    image.get_pixel(at.x as u32, at.y as u32).0
}

/// The middle of the picture: between the panels as they open.
const MIDDLE: egui::Pos2 = egui::pos2(660.0, 355.0);

#[test]
fn shows_a_scene_and_then_rests() {
    let folder = Folder::new("shows", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let [r, g, b, _] = pixel(&mut harness, MIDDLE);
    assert!(r > 60 && r > 2 * g && r > 2 * b, "a red ball: {r} {g} {b}");
    let drawn = frames(harness.state());
    harness.run_steps(10);
    assert_eq!(frames(harness.state()), drawn, "nothing moves, nothing is drawn");
    harness.get_by_role_and_label(Role::Slider, "size");
    harness.get_by_label_contains("operations");
    assert!(!harness.state().session.stage.animates());
    assert!(!harness.state().session.is_unsaved());
}

/// The part of the window that shows the picture's middle.
fn middle(harness: &mut Harness<'_, App>) -> image::RgbaImage {
    let image = harness.render().unwrap();
    image::imageops::crop_imm(&image, MIDDLE.x as u32 - 130, MIDDLE.y as u32 - 130, 260, 260).to_image()
}

#[test]
fn a_still_grows_while_nothing_moves_and_then_rests() {
    let folder = Folder::new("still", &format!("{SCENE}environment {{ sky: gradient((0.24, 0.39, 0.63), (0.8, 0.86, 0.91)) }}\n"));
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let samples = |app: &App| app.canvas.as_ref().unwrap().samples();
    assert_eq!(samples(harness.state()), 1);
    let first = middle(&mut harness);
    let wanted = 12;
    harness.state_mut().canvas.as_mut().unwrap().set_still(wanted);
    let mut seen = vec![first.clone()];
    for step in 2..=wanted {
        until(&mut harness, |app| samples(app) >= step);
        seen.push(middle(&mut harness));
    }
    harness.run_steps(3);
    assert_eq!(samples(harness.state()), wanted);
    let drawn = frames(harness.state());
    harness.run_steps(10);
    assert_eq!(frames(harness.state()), drawn, "the still is done, nothing is drawn");
    harness.get_by_label("× 12");
    let still = middle(&mut harness);
    let apart = |a: &image::RgbaImage, b: &image::RgbaImage| {
        let off = a.pixels().zip(b.pixels()).map(|(a, b)| (0..3).map(|c| a[c].abs_diff(b[c])).max().unwrap());
        let off: Vec<u8> = off.collect();
        (off.iter().filter(|o| **o > 12).count(), off.iter().filter(|o| **o > 3).count())
    };
    let (edges, all) = apart(&first, &still);
    assert!(edges > 60, "edges have lost their steps: {edges}");
    assert!(all < 260 * 260 / 10, "and nothing else has changed: {all}");
    // Without a flicker: each is nearer to the still, but for a little.
    let ways: Vec<usize> = seen.iter().map(|image| apart(image, &still).0).collect();
    assert!(ways.windows(2).all(|w| w[1] <= w[0] + 20), "{ways:?}");
    if let Ok(folder) = std::env::var("SUREFOOT_SHOTS") {
        first.save(Path::new(&folder).join("still-first.png")).unwrap();
        still.save(Path::new(&folder).join("still-last.png")).unwrap();
        harness.render().unwrap().save(Path::new(&folder).join("still-window.png")).unwrap();
    }
    // Any change begins anew.
    harness.key_press(Key::Home);
    harness.state_mut().session.stage.set("size", &[0.8]);
    harness.step();
    assert_eq!(samples(harness.state()), 1);
    until(&mut harness, |app| samples(app) == wanted);
    assert!(apart(&middle(&mut harness), &still).0 > 500, "the ball is smaller");
}

#[test]
fn a_slider_changes_the_picture_and_builds_nothing() {
    let folder = Folder::new("slider", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let built = harness.state().world.stats();
    let drawn = frames(harness.state());
    let first = harness.get_all_by_role(Role::Slider).next().unwrap().rect();
    let from = egui::pos2(first.left() + 0.45 * (first.width()), first.center().y);
    drag(&mut harness, from, egui::pos2(first.left() - 40.0, first.center().y));
    assert!((value(harness.state(), "size") - 0.2).abs() < 1e-9);
    until(&mut harness, |app| frames(app) > drawn);
    assert_eq!(harness.state().world.stats().pipelines, built.pipelines);
    assert_eq!(harness.state().world.stats().modules, built.modules);
    let off_the_small_ball = MIDDLE + egui::vec2(60.0, 0.0);
    let sky = pixel(&mut harness, MIDDLE + egui::vec2(75.0, 0.0));
    let seen = pixel(&mut harness, off_the_small_ball);
    assert!(seen.iter().zip(sky).all(|(a, b)| a.abs_diff(b) <= 3), "the sky where the ball was: {seen:?}, beside it {sky:?}");

    double_click(&mut harness, egui::pos2(first.center().x, first.center().y));
    assert_eq!(value(harness.state(), "size"), 1.0, "a double click gives back the text's value");
}

#[test]
fn an_error_keeps_the_picture_and_says_where() {
    let folder = Folder::new("error", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    write(&mut harness, &SCENE.replace("sphere(size)", "spere(size)"));
    until(&mut harness, |app| app.session.error().is_some());
    assert!(harness.state().session.is_unsaved());
    assert_eq!(harness.state().session.said.swaps, 1);
    harness.get_by_label_contains("last text without errors");
    let [r, g, b, _] = pixel(&mut harness, MIDDLE);
    assert!(r > 60 && r > 2 * g && r > 2 * b, "still the red ball: {r} {g} {b}");

    let error = harness.state().session.error().unwrap().clone();
    assert_eq!((error.severity, error.place.start), (Severity::Error, (8, 9)));
    harness.get_all_by_label_contains("nothing is named").last().unwrap().click();
    harness.run_steps(3);
    let id = egui::Id::unique(("source", &folder.scene()));
    let state = egui::text_edit::TextEditState::load(&harness.ctx, id).unwrap();
    let range = state.cursor.char_range().unwrap();
    let at = SCENE.find("sphere(size)").unwrap();
    assert_eq!(range.as_sorted_char_range(), at.into()..(at + 5).into());

    write(&mut harness, SCENE);
    until(&mut harness, |app| app.session.error().is_none());
    assert!(!harness.state().session.is_unsaved());
}

#[test]
fn edits_compile_and_save() {
    let folder = Folder::new("save", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let new = SCENE.replace("#d02010", "#2010d0");
    write(&mut harness, &new);
    until(&mut harness, |app| app.session.said.swaps == 2);
    let drawn = frames(harness.state());
    until(&mut harness, |app| frames(app) >= drawn);
    let [r, g, b, _] = pixel(&mut harness, MIDDLE);
    assert!(b > 60 && b > r && b > g, "a blue ball: {r} {g} {b}");
    assert_eq!(std::fs::read_to_string(folder.scene()).unwrap(), SCENE, "not saved yet");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    harness.run_steps(2);
    assert_eq!(std::fs::read_to_string(folder.scene()).unwrap(), new);
    assert!(!harness.state().session.is_unsaved());
}

#[test]
fn another_program_saves() {
    let folder = Folder::new("reload", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let theirs = SCENE.replace("#d02010", "#20d010");
    std::fs::write(folder.scene(), &theirs).unwrap();
    until(&mut harness, |app| app.session.documents.current().text == theirs);
    until(&mut harness, |app| app.session.said.swaps == 2);

    // With unsaved edits a person is asked, and nothing is lost.
    let mine = theirs.replace("sphere(size)", "sphere(size * 0.5)");
    write(&mut harness, &mine);
    let later = theirs.replace("fov: 40deg", "fov: 50deg");
    std::fs::write(folder.scene(), &later).unwrap();
    until(&mut harness, |app| app.session.documents.current().has_conflict());
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    harness.run_steps(2);
    assert_eq!(std::fs::read_to_string(folder.scene()).unwrap(), later, "no save decides it");
    pixel(&mut harness, MIDDLE);
    harness.get_by_label("Keep both").click();
    harness.run_steps(3);
    let beside = folder.0.join("scene.mine.sdf");
    assert_eq!(std::fs::read_to_string(beside).unwrap(), mine);
    assert_eq!(harness.state().session.documents.current().text, later);
    assert!(!harness.state().session.is_unsaved());
}

#[test]
fn the_camera_follows_the_hand_and_comes_home() {
    let folder = Folder::new("camera", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let home = harness.state().session.camera().unwrap();
    let drawn = frames(harness.state());
    drag(&mut harness, MIDDLE, MIDDLE + egui::vec2(80.0, 30.0));
    let moved = harness.state().session.camera().unwrap();
    assert!(moved.eye[0] < -0.5 && moved.eye[1] > 0.5, "{moved:?}");
    assert!(frames(harness.state()) > drawn);
    harness.key_press(Key::Home);
    harness.run_steps(2);
    assert_eq!(harness.state().session.camera().unwrap(), home);
}

#[test]
fn a_choice_compiles_again_and_values_stay() {
    let folder = Folder::new("choice", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let app = harness.state_mut();
    apply(&mut app.session, &mut app.world, Command::Set("size".to_owned(), vec![0.5]));
    // The toolbar has a list too.
    harness.query_all_by_role(Role::ComboBox).last().unwrap().click();
    harness.run_steps(3);
    harness.get_by_label("ball").click();
    until(&mut harness, |app| app.session.said.swaps == 2);
    assert_eq!(value(harness.state(), "size"), 0.5);
    let app = harness.state();
    assert_eq!(app.session.choice(app.session.parameter("style").unwrap()), Some("ball"));
}

#[test]
fn another_scene_of_the_folder_is_opened() {
    let folder = Folder::new("beside", SCENE);
    let other = folder.0.join("other.sdf");
    std::fs::write(&other, SCENE.replace("size = 1 in", "size = 0.7 in")).unwrap();
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    assert!(harness.state_mut().session.stage.set("size", &[2.0]));
    let swaps = harness.state().session.said.swaps;
    harness.key_press_modifiers(Modifiers::COMMAND, Key::O);
    harness.run_steps(4);
    pixel(&mut harness, MIDDLE);
    harness.get_by_label("other.sdf").click();
    until(&mut harness, |app| app.session.said.swaps > swaps);
    let app = harness.state();
    assert_eq!(app.session.documents.current().name, other.to_string_lossy());
    assert_eq!(value(app, "size"), 0.7, "what a hand moved belongs to the other scene");
    assert!(harness.query_by_label("scene.sdf").is_none(), "the menu is closed");
}

#[test]
fn closing_asks_for_unsaved_edits() {
    let folder = Folder::new("close", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    write(&mut harness, "scene = box(1)\n");
    let viewport = egui::ViewportId::ROOT;
    let close = |harness: &mut Harness<'_, App>| {
        let info = harness.input_mut().viewports.entry(viewport).or_default();
        info.events.push(egui::ViewportEvent::Close);
        harness.step();
        harness.input_mut().viewports.entry(viewport).or_default().events.clear();
        harness.step();
    };
    close(&mut harness);
    harness.run_steps(2);
    assert_eq!(harness.state().session.question, Some(Question::Close));
    harness.get_by_label("Cancel").click();
    harness.run_steps(3);
    assert!(!harness.state().world.close && harness.state().session.question.is_none());
    close(&mut harness);
    harness.run_steps(2);
    harness.get_by_label("Throw away").click();
    harness.run_steps(3);
    assert!(harness.state().world.close);
    assert_eq!(std::fs::read_to_string(folder.scene()).unwrap(), SCENE);
}

#[test]
fn time_plays_stands_and_goes_back() {
    let text = "scene = box(1).rotate(y, time)\ncamera { eye: (0, 2, 5), target: (0, 0, 0) }\n";
    let folder = Folder::new("time", text);
    let mut harness = window(&folder.scene());
    begun(&mut harness);
    let drawn = frames(harness.state());
    until(&mut harness, |app| frames(app) > drawn + 2);
    harness.get_by_label("Pause").click();
    harness.run_steps(3);
    let then = harness.state().session.stage.time();
    assert!(then > 0.0);
    harness.run_steps(3);
    assert_eq!(harness.state().session.stage.time(), then);
    harness.get_by_label("Rewind").click();
    harness.run_steps(3);
    assert_eq!(harness.state().session.stage.time(), 0.0);
}

#[test]
fn a_file_that_is_no_scene_is_shown_with_its_errors() {
    let folder = Folder::new("nonsense", ") scene = (\n");
    let mut harness = window(&folder.scene());
    until(&mut harness, |app| app.session.error().is_some());
    harness.get_by_label_contains("no picture yet");
}

#[test]
fn a_pointer_over_a_term_shows_its_factor() {
    let text = "param rate = 0.5 in 0..2\nscene = box((1, 2, 1)).twist(y, rate)\n";
    let folder = Folder::new("factor", text);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    harness.ctx.all_styles_mut(|style| style.interaction.tooltip_delay = 0.0);
    let source = harness.get_by_role(Role::MultilineTextInput).rect();
    // The lines are 17 high; the second one holds the twist.
    let hover = |harness: &mut Harness<'_, App>, x: f32| {
        harness.hover_at(egui::pos2(source.left() + x, source.top() + 4.0 + 1.5 * 17.0));
        harness.run_steps(8);
        harness.query_all_by_label_contains("from twist at").count()
    };
    let shown: Vec<f32> = (0..24).map(|i| 20.0 * i as f32).filter(|x| hover(&mut harness, *x) > 0).collect();
    // `twist(y, rate)` is 14 letters of about 8 points, behind 23 others.
    let (Some(first), Some(last)) = (shown.first(), shown.last()) else { panic!("no factor is shown") };
    assert!(*first > 160.0 && *last < 400.0 && last - first >= 60.0, "{shown:?}");
    assert!(hover(&mut harness, *first) > 0);
    harness.get_by_label_contains("derived within");
    harness.get_by_label_contains("for all rate in 0..2");
    harness.get_by_label_contains("narrower range of `rate`");
    pixel(&mut harness, MIDDLE);
    assert_eq!(harness.query_all_by_label("unproven").count(), 0);
}

#[test]
fn an_unproven_scene_is_marked() {
    let folder = Folder::new("unproven", "field f = 1 / p.x - 2\nscene = f\n");
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    harness.get_by_label("unproven");
    pixel(&mut harness, MIDDLE);
    write(&mut harness, "scene = sphere(1)\n");
    until(&mut harness, |app| app.session.said.swaps == 2);
    harness.run_steps(2);
    assert_eq!(harness.query_all_by_label("unproven").count(), 0);
}

const BALLS: &str = "\
scene = plane(y)
balls drops { count: 200, radius: 0.05, spawn: (-1, 0.5, -1)..(1, 2, 1) }
camera { eye: (0, 3, 8), target: (0, 0, 0), fov: 40deg }
";

#[test]
fn balls_fall_step_and_begin_again() {
    let folder = Folder::new("balls", BALLS);
    let mut harness = window(&folder.scene());
    until(&mut harness, |app| app.session.said.swaps > 0 && frames(app) > 0);
    let steps = |app: &App| app.session.stage.balls().map_or(0, |balls| balls.steps());
    let read = |app: &App| app.session.stage.balls().unwrap().read().unwrap();
    until(&mut harness, |app| steps(app) > 20);
    harness.get_by_label("200 balls");
    harness.get_by_label("Pause").click();
    harness.run_steps(2);
    let stood = steps(harness.state());
    harness.run_steps(3);
    assert_eq!(steps(harness.state()), stood, "time stands");
    harness.get_by_label("Step").click();
    harness.run_steps(2);
    assert_eq!(steps(harness.state()), stood + 1);

    // Another text below them moves none.
    let before = read(harness.state());
    write(&mut harness, &BALLS.replace("plane(y)", "plane(y) | box(0.4, 1, 0.4)"));
    until(&mut harness, |app| app.session.said.swaps == 2);
    assert_eq!(read(harness.state()), before, "every bit is as it was");

    harness.hover_at(MIDDLE);
    harness.step();
    harness.state_mut().session.stage.playing = false;
    harness.ctx.memory_mut(|m| m.stop_text_input());
    harness.key_press(Key::B);
    harness.run_steps(2);
    harness.get_by_label("264 balls");
    let dropped = read(harness.state());
    assert_eq!(dropped[..200], before, "those that were there stay");
    assert!(dropped[200..].iter().all(|b| b.position[1] > 0.2 && b.position[1] < 3.0), "above the place");
    harness.get_by_label("Pour again").click();
    harness.run_steps(2);
    harness.get_by_label("200 balls");
    let heights = |balls: &[surefoot_compiler::physics::Ball]| balls.iter().map(|b| b.position[1]).sum::<f64>() / 200.0;
    assert!(heights(&read(harness.state())) > heights(&before));
    pixel(&mut harness, MIDDLE);
}

#[test]
fn a_ball_is_taken_and_thrown() {
    let text = "scene = plane(y)\nphysics { gravity: (0, 0, 0) }\nballs b { count: 1, radius: 0.3, spawn: (0, 0.6, 0)..(0, 0.6, 0) }\ncamera { eye: (0, 0.6, 8), target: (0, 0.6, 0), fov: 40deg }\n";
    let folder = Folder::new("throw", text);
    let mut harness = window(&folder.scene());
    until(&mut harness, |app| app.session.stage.balls().is_some() && frames(app) > 0);
    let ball = |app: &App| app.session.stage.balls().unwrap().read().unwrap()[0];
    let camera = harness.state().session.camera();
    // Beside the ball a drag with Control turns the camera, as any drag.
    let beside = MIDDLE + egui::vec2(0.0, -200.0);
    harness.event(egui::Event::PointerMoved(MIDDLE));
    let press = |harness: &mut Harness<'_, App>, at: egui::Pos2, pressed: bool| {
        let (button, modifiers) = (egui::PointerButton::Primary, Modifiers::COMMAND);
        harness.event_modifiers(egui::Event::PointerButton { pos: at, button, pressed, modifiers }, modifiers);
        harness.step();
    };
    let go = |harness: &mut Harness<'_, App>, at: egui::Pos2| {
        harness.event_modifiers(egui::Event::PointerMoved(at), Modifiers::COMMAND);
        harness.step();
    };
    go(&mut harness, beside);
    press(&mut harness, beside, true);
    assert!(harness.state().session.held.is_none());
    press(&mut harness, beside, false);

    go(&mut harness, MIDDLE);
    press(&mut harness, MIDDLE, true);
    for i in 1..=30 {
        go(&mut harness, MIDDLE + egui::vec2(6.0 * i as f32, -3.0 * i as f32));
        std::thread::sleep(Duration::from_millis(10));
    }
    assert!(harness.state().session.held.is_some());
    assert_eq!(harness.state().session.camera(), camera, "the camera stays");
    let held = ball(harness.state());
    assert!(held.position[0] > 0.5 && held.position[1] > 0.7 && held.position[2].abs() < 0.1, "{held:?}");
    press(&mut harness, MIDDLE + egui::vec2(180.0, -90.0), false);
    harness.step();
    assert!(harness.state().session.held.is_none());
    let thrown = ball(harness.state());
    assert!(thrown.velocity[0] > 0.5 && thrown.velocity[1] > 0.2, "{thrown:?}");
    until(&mut harness, |app| ball(app).position[0] > thrown.position[0] + 0.5);
    let flying = ball(harness.state());
    assert!((flying.velocity[0] - thrown.velocity[0]).abs() < 1e-3, "it flies on: {flying:?}");
    harness.state_mut().session.stage.playing = false;
    pixel(&mut harness, MIDDLE);
}
