//! Ways of looking that go with any view: a section that cuts the picture open, and two views with a divider between them.

use super::*;
use surefoot_compiler::section::{Across, Section};
use surefoot_runtime::ViewMode;

/// A hollow ball, blue, with a red one in it.
const HOLLOW: &str = "\
material blue { color: #2040c0 }
material red { color: #c02010 }
scene = sphere(1.4).shell(0.3).material(blue) | sphere(0.6).material(red)
camera { eye: (0, 0, 8), target: (0, 0, 0), fov: 40deg }
";

fn section(app: &App) -> Section {
    app.session.look.section.unwrap()
}

/// Waits until a picture is built that shows something else, and drawn.
fn built(harness: &mut Harness<'_, App>, swaps: u64) {
    until(harness, |app| app.session.said.swaps > swaps);
    sharp(harness);
}

fn shot(harness: &mut Harness<'_, App>, name: &str) {
    if let Ok(folder) = std::env::var("SUREFOOT_SHOTS") {
        harness.render().unwrap().save(Path::new(&folder).join(format!("{name}.png"))).unwrap();
    }
}

#[test]
fn a_section_is_switched_on_flipped_and_dragged() {
    let folder = Folder::new("section", HOLLOW);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let wall = MIDDLE + vec2(120.0, 0.0);
    let [r, _, b, _] = pixel(&mut harness, MIDDLE);
    assert!(b > r, "the ball is closed: {r} {b}");
    harness.key_press(Key::C);
    harness.run_steps(2);
    built(&mut harness, 1);
    assert_eq!(section(harness.state()).cut.across, Across::Z);
    assert!(!section(harness.state()).cut.keeps_above, "the side of the eye is taken away");
    let [r, _, b, _] = pixel(&mut harness, MIDDLE);
    assert!(r > b, "the red ball in it is cut: {r} {b}");
    shot(&mut harness, "section");
    // Between them is the inside of the blue one; its wall is cut farther out.
    let [r, _, b, _] = pixel(&mut harness, wall);
    assert!(b > r, "{r} {b}");
    // A slider moves it, and nothing is compiled or built.
    let slider = harness.get_by_role_and_label(Role::Slider, "Place of the section");
    slider.focus();
    harness.run_steps(2);
    let swaps = harness.state().session.said.swaps;
    for _ in 0..3 {
        harness.key_press(Key::ArrowLeft);
        harness.run_steps(2);
    }
    let moved = section(harness.state()).at;
    assert!(moved < 0.0, "{moved}");
    let now = section(harness.state());
    harness.state_mut().apply(vec![Command::Section(Section { at: 1.2, ..now })]);
    harness.run_steps(3);
    let [r, _, b, _] = pixel(&mut harness, MIDDLE);
    assert!(r > b, "it cuts the shell and not the red ball, which is seen through the hole: {r} {b}");
    assert_eq!(harness.state().session.said.swaps, swaps, "a plane that moves is a number");
    // The other side, by hand, and what a person points at is what is seen.
    harness.state_mut().apply(vec![Command::Section(Section { at: 0.0, ..now })]);
    harness.get_by_label("Flip").click();
    harness.run_steps(2);
    built(&mut harness, swaps);
    assert!(section(harness.state()).cut.keeps_above);
    harness.state_mut().apply(vec![Command::Pick { at: [280.0, 300.0], size: [560, 600] }]);
    until(&mut harness, |app| app.session.looking.found.is_some());
    let seen = |app: &App| app.session.looking.found.as_ref().unwrap().as_ref().unwrap().seen.unwrap().point;
    assert!((seen(harness.state())[2] - 1.55).abs() < 0.02, "what stays lies between the eye and the plane: {:?}", seen(harness.state()));
    let swaps = harness.state().session.said.swaps;
    let now = section(harness.state());
    harness.state_mut().apply(vec![Command::Section(now.flipped())]);
    built(&mut harness, swaps);
    harness.state_mut().apply(vec![Command::Unpick, Command::Pick { at: [280.0, 300.0], size: [560, 600] }]);
    until(&mut harness, |app| app.session.looking.found.is_some());
    assert!(seen(harness.state())[2].abs() < 1e-6, "the face that is cut: {:?}", seen(harness.state()));
    // Any of the planes, by its button.
    harness.state_mut().apply(vec![Command::Unpick]);
    harness.run_steps(2);
    for across in Across::ALL {
        harness.get_by_label(&format!("Section across {}", across.name())).click();
        harness.run_steps(2);
        assert_eq!(section(harness.state()).cut.across, across);
    }
    harness.get_by_label("No section").click();
    harness.run_steps(2);
    assert!(!harness.state().session.look.cuts && harness.query_by_label("Flip").is_none());
}

#[test]
fn two_views_stand_on_the_sides_of_a_divider() {
    let folder = Folder::new("wipe", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    let alone = harness.render().unwrap();
    let swaps = harness.state().session.said.swaps;
    harness.key_press(Key::W);
    harness.run_steps(2);
    built(&mut harness, swaps);
    assert_eq!(harness.state().session.look.beside, Some(ViewMode::Steps));
    harness.get_by_label("64 steps");
    shot(&mut harness, "wipe");
    let (left, right) = (MIDDLE + vec2(-25.0, 20.0), MIDDLE + vec2(25.0, 20.0));
    let both = harness.render().unwrap();
    let at = |image: &image::RgbaImage, place: egui::Pos2| image.get_pixel(place.x as u32, place.y as u32).0;
    assert_eq!(at(&both, left), at(&alone, left), "the left side is the view as it was");
    assert_ne!(at(&both, right), at(&alone, right), "the right side is another");
    // By hand: the divider goes where the pointer goes, and nothing is built.
    let divider = harness.get_by_label("Divider of the two views").rect().center();
    drag(&mut harness, divider, divider + vec2(60.0, 0.0));
    let dragged = harness.state().session.look.divider;
    assert!(dragged > 0.55, "{dragged}");
    sharp(&mut harness);
    let moved = harness.render().unwrap();
    assert_eq!(at(&moved, right), at(&alone, right), "the divider is right of it now");
    assert_eq!(harness.state().session.look.orbit.map(|orbit| orbit.camera()), None, "the camera stays");
    // By keys: it has the keyboard since it was taken.
    for _ in 0..5 {
        harness.key_press(Key::ArrowLeft);
        harness.run_steps(2);
    }
    let pressed = harness.state().session.look.divider;
    assert!((dragged - pressed - 0.1).abs() < 1e-3, "{dragged} {pressed}");
    assert_eq!(harness.state().session.said.swaps, swaps + 1);
    // Another view, and one alone again.
    harness.state_mut().apply(vec![Command::Beside(Some(ViewMode::Normals))]);
    built(&mut harness, swaps + 1);
    harness.state_mut().apply(vec![Command::Divide(0.0)]);
    harness.run_steps(2);
    let normals = pixel(&mut harness, left);
    assert!(normals[2] > 200, "a normal toward the eye is blue: {normals:?}");
    harness.get_by_label("Two views").click();
    harness.run_steps(2);
    built(&mut harness, swaps + 2);
    assert!(harness.query_by_label("Divider of the two views").is_none());
    assert_eq!(at(&harness.render().unwrap(), left), at(&alone, left));
}

/// What is rasterised is on both sides, with the depth that either needs.
#[test]
fn a_scene_with_balls_beside_a_view_without_them() {
    let folder = Folder::new("wipe-balls", "scene = plane(y, -1)\nballs b { count: 30, spawn: (-1, 0, -1)..(1, 2, 1), radius: 0.2 }\ncamera { eye: (0, 1, 7), target: (0, 0, 0), fov: 40deg }\n");
    let mut harness = window(&folder.scene());
    begun(&mut harness);
    harness.state_mut().apply(vec![Command::Play(false)]);
    let swaps = harness.state().session.said.swaps;
    for (mode, beside) in [(ViewMode::Shaded, ViewMode::Steps), (ViewMode::Gradient, ViewMode::Normals)] {
        harness.state_mut().apply(vec![Command::Mode(mode), Command::Beside(Some(beside))]);
        until(&mut harness, |app| app.session.said.swaps > swaps && app.session.stage.picture().unwrap().lock().unwrap().mode() == mode);
        sharp(&mut harness);
        assert_eq!((harness.state().session.said.failure.clone(), harness.state().session.said.drawing.clone()), (None, None));
    }
}

#[test]
fn the_picture_is_held_against_what_is_certain_of_it() {
    let folder = Folder::new("truth", SCENE);
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    harness.key_press(Key::D);
    harness.run_steps(2);
    let part = |app: &App| app.session.truth.found.as_ref().map_or(0.0, |found| found.as_ref().unwrap().part);
    until(&mut harness, |app| part(app) > 0.0);
    harness.get_by_label("Difference from the truth");
    until(&mut harness, |app| part(app) == 1.0);
    let count = harness.state().session.truth.found.as_ref().unwrap().as_ref().unwrap().count;
    println!("{count:?}");
    assert!(count.all > 10_000 && count.missed == 0 && count.extra == 0 && count.unknown < 5 && count.most <= 1.0, "{count:?}");
    harness.get_by_label_contains("0 missed (red)");
    shot(&mut harness, "truth");
    // Nothing more is done where nothing changes; another picture begins anew.
    harness.run_steps(5);
    assert_eq!(part(harness.state()), 1.0);
    harness.state_mut().apply(vec![Command::Turn(0.1, 0.0)]);
    harness.run_steps(2);
    assert_eq!(part(harness.state()), 0.0);
    until(&mut harness, |app| part(app) > 0.0);
    harness.get_by_label("Close the difference").click();
    harness.run_steps(2);
    assert!(!harness.state().session.truth.open && harness.query_by_label("Difference from the truth").is_none());
}
