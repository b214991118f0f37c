//! The panel of the measures: what it says, of what, and what it copies.

use super::*;

#[test]
fn a_solid_is_measured_while_the_window_goes_on() {
    let folder = Folder::new("measures", "param size = 20mm in 10mm..40mm\nrender { unit: mm }\nscene = box((size, 1cm, 0.5in))\n");
    let mut harness = window(&folder.scene());
    ready(&mut harness);
    harness.get_by_label("Measures").click();
    harness.step();
    harness.step();
    harness.get_by_label("Walls").click();
    harness.step();
    harness.step();
    assert!(harness.state().session.measuring.part().is_some(), "it is measured on another thread");
    let start = Instant::now();
    while harness.state().session.measuring.found.is_none() {
        assert!(start.elapsed() < Duration::from_secs(300), "waited too long");
        std::thread::sleep(Duration::from_millis(20));
        harness.step();
    }
    harness.step();
    let said = |harness: &Harness<'_, App>, words: &str| harness.query_all_by_label_contains(words).count();
    for words in ["20 × 10 × 12.7 mm", " mm³, proven", "thinnest wall", "proven from 0 to 10; "] {
        assert!(said(&harness, words) > 0, "{words}: {:?}", harness.state().session.measuring.found.as_ref().map(|found| &found.1));
    }
    assert_eq!(said(&harness, "has changed"), 0);
    // By its file, for a person to look at.
    pixel(&mut harness, egui::pos2(550.0, 350.0));
    harness.get_by_label("Copy").click();
    harness.step();
    let copied = harness.output().platform_output.commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    assert!(copied.is_some_and(|text| text.contains("size: 20 × 10 × 12.7 mm\n") && text.lines().count() > 5));
    let size = harness.state().session.parameter("size").unwrap().clone();
    harness.state_mut().session.stage.set(&size.name, &[30.0]);
    harness.step();
    harness.step();
    assert!(said(&harness, "has changed") > 0);
}
