//! The timeline below the picture.

use super::*;

const MOVING: &str = "scene = sphere(1).translate(sin(time), 0, 0)\ncamera { eye: (0, 0, 8), target: (0, 0, 0) }\n";

#[test]
fn time_is_dragged_and_begins_anew() {
    let folder = Folder::new("timeline", MOVING);
    let mut harness = window(&folder.scene());
    begun(&mut harness);
    let time = |harness: &Harness<'_, App>| harness.state().session.stage.time();
    assert!(harness.state().session.moves());
    harness.get_by_label("Pause").click();
    harness.run_steps(3);
    let strip = harness.get_by_role_and_label(Role::Slider, "Timeline").rect();
    let drawn = frames(harness.state());
    drag(&mut harness, strip.left_center() + egui::vec2(4.0, 0.0), strip.center());
    assert!((time(&harness) - 5.0).abs() < 0.5, "the middle of ten seconds: {}", time(&harness));
    assert!(frames(harness.state()) > drawn, "the picture follows");
    if let Ok(shots) = std::env::var("SUREFOOT_SHOTS") {
        harness.render().unwrap().save(Path::new(&shots).join("timeline.png")).unwrap();
    }
    // By the keyboard: an arrow moves it, L lets it loop.
    harness.get_by_role_and_label(Role::Slider, "Timeline").focus();
    harness.run_steps(2);
    let before = time(&harness);
    harness.key_press(Key::ArrowRight);
    harness.run_steps(2);
    assert!(time(&harness) > before);
    harness.get_by_role_and_label(Role::SpinButton, "Length");
    let focused = harness.ctx.memory(|m| m.focused());
    harness.ctx.memory_mut(|m| focused.into_iter().for_each(|id| m.surrender_focus(id)));
    harness.step();
    harness.key_press(Key::L);
    harness.run_steps(2);
    assert!(harness.state().session.timeline.loops);
    harness.state_mut().session.stage.set_time(9.95);
    harness.get_by_label("Play").click();
    until(&mut harness, |app| app.session.stage.time() < 5.0);
    assert!(time(&harness) >= 0.0);
}

#[test]
fn its_length_and_its_loop_come_back() {
    let folder = Folder::new("timeline-back", MOVING);
    let mut harness = window(&folder.scene());
    begun(&mut harness);
    let timeline = session::Timeline { length: 4.25, loops: true };
    harness.state_mut().apply(vec![Command::Timeline(timeline)]);
    let file = folder.0.join("window.json");
    let start = Instant::now();
    while !std::fs::read_to_string(&file).is_ok_and(|text| text.contains("4.25")) {
        assert!(start.elapsed() < Duration::from_secs(5));
        std::thread::sleep(Duration::from_millis(20));
        harness.step();
    }
    drop(harness);
    let harness = window(&folder.scene());
    assert_eq!(harness.state().session.timeline, timeline);
    // A length that is none is as at first.
    drop(harness);
    std::fs::write(&file, std::fs::read_to_string(&file).unwrap().replace("4.25", "-1.0")).unwrap();
    assert_eq!(window(&folder.scene()).state().session.timeline, session::Timeline::default());
}

/// Asks for a file of the picture.
fn ask(harness: &mut Harness<'_, App>, name: &str, each: bool) {
    harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    harness.run_steps(3);
    harness.get_by_role_and_label(Role::SpinButton, "Width");
    harness.state_mut().session.asked.as_mut().unwrap().wanted.size = (64, 48);
    if each {
        harness.get_by_label("Sequence").click();
        harness.run_steps(2);
    }
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    harness.event(egui::Event::Text(name.to_owned()));
    harness.run_steps(2);
    if let Ok(shots) = std::env::var("SUREFOOT_SHOTS") {
        harness.render().unwrap().save(Path::new(&shots).join(format!("save-{name}.png"))).unwrap();
    }
    harness.key_press(Key::Enter);
    harness.run_steps(2);
}

/// Asks for one, and waits for what is said of it.
fn save(harness: &mut Harness<'_, App>, name: &str, each: bool) -> String {
    ask(harness, name, each);
    until(harness, |app| app.session.notice.is_some());
    let said = harness.state_mut().session.notice.take().unwrap();
    harness.run_steps(2);
    said
}

#[test]
fn what_moves_is_written_as_a_film_or_as_pictures() {
    let folder = Folder::new("film", MOVING);
    let mut harness = window(&folder.scene());
    until(&mut harness, |app| app.session.said.swaps > 0 && frames(app) > 0);
    harness.get_by_label("Pause").click();
    harness.state_mut().session.timeline.length = 0.2;
    harness.run_steps(3);
    assert!(save(&mut harness, "film.gif", false).starts_with("The film is in"));
    let film = image::codecs::gif::GifDecoder::new(std::io::BufReader::new(std::fs::File::open(folder.0.join("film.gif")).unwrap())).unwrap();
    let pictures = image::AnimationDecoder::into_frames(film).collect_frames().unwrap();
    assert_eq!(pictures.len(), 6);
    assert_eq!(pictures[0].buffer().dimensions(), (64, 48));
    assert!(pictures[0].buffer() != pictures[5].buffer(), "it moves");
    assert!(save(&mut harness, "still.png", true).starts_with("The pictures are in"));
    let written = |n: u32| folder.0.join(format!("still_{n:04}.png"));
    assert!(written(5).exists() && !written(6).exists());
    assert_eq!(image::open(written(0)).unwrap().to_rgba8().dimensions(), (64, 48));

    // A long one is given up, and no half of it stays.
    harness.state_mut().session.timeline.length = 600.0;
    ask(&mut harness, "long.gif", false);
    until(&mut harness, |app| app.session.export.part().is_some() && folder.0.join("long.gif").exists());
    harness.get_by_label("Cancel").click();
    until(&mut harness, |app| app.session.export.part().is_none());
    assert!(!folder.0.join("long.gif").exists() && harness.state().session.notice.is_none());
}

#[test]
fn a_scene_that_rests_has_no_timeline() {
    let folder = Folder::new("no-timeline", SCENE);
    let mut harness = window(&folder.scene());
    until(&mut harness, |app| app.session.said.swaps > 0);
    assert!(harness.query_by_role_and_label(Role::Slider, "Timeline").is_none());
}
