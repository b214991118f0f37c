//! A real scene that is edited at random, one key at a time.

use super::*;
use crate::texts::OpenTexts;
use surefoot_compiler::language_service::World as Names;

/// So many edits.
const EDITS: usize = 200;
/// After so many of them a pause lets the compiler follow.
const PAUSE_AFTER: usize = 4;
/// What is typed.
const KEYS: &[char] = &['a', 'e', 's', 'x', 'y', '0', '1', '7', '.', ',', ' ', '(', ')', '{', '}', '[', ']', '|', '-', '+', '*', '/', '=', ':', '#', '"', '\n', 'é'];

/// Numbers that are the same on every run.
struct Dice(u64);

impl Dice {
    fn below(&mut self, count: usize) -> usize {
        // The generator of Knuth's MMIX; its upper bits.
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % count as u64) as usize
    }
}

/// Severity and place of each problem, in an order of its own.
fn sorted(problems: &[session::Problem]) -> Vec<String> {
    let mut all: Vec<String> = problems.iter().map(|p| format!("{:?} {} {:?}", p.severity, p.code, p.place)).collect();
    all.sort();
    all
}

/// Puts the cursor before a character.
fn put_cursor(harness: &mut Harness<'_, App>, at: usize) {
    let id = egui::Id::unique(("source", &harness.state().session.documents.current().name));
    let mut state = egui::text_edit::TextEditState::load(&harness.ctx, id).unwrap_or_default();
    state.cursor.set_char_range(Some(egui::text::CCursorRange::one(egui::text::CCursor::new(at))));
    state.store(&harness.ctx, id);
}

/// Each piece that is underlined reads as the compiler has read it.
fn underlines_fit(app: &App) {
    let document = app.session.documents.current();
    let sources = &app.session.said.words.sources;
    let Some((file, source)) = sources.iter().find(|(_, file)| file.name == document.name) else { return };
    let complained: Vec<&str> = app.session.said.words.diagnostics.iter().filter(|d| d.span.file == file).map(|d| &source.text[d.span.range()]).collect();
    for (range, _) in panels::marks::of(&app.session, document) {
        let underlined = &document.text[range];
        assert!(complained.contains(&underlined), "{underlined:?} is underlined, and not one of {complained:?}");
    }
}

#[test]
fn random_edits_harm_nothing() {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/csg.sdf")).unwrap();
    let folder = Folder::new("random", &text);
    let mut harness = window(&folder.scene());
    // A slow adapter takes its time for all pixels, and they are not looked at.
    until(&mut harness, |app| app.session.said.swaps > 0 && frames(app) > 0);
    harness.get_by_role(Role::MultilineTextInput).focus();
    harness.step();
    let mut dice = Dice(20_261_128);
    let (mut swaps, mut wrong, mut right) = (harness.state().session.said.swaps, 0, 0);
    for edit in 0..EDITS {
        let length = harness.state().session.documents.current().text.chars().count();
        let at = dice.below(length + 1);
        put_cursor(&mut harness, at);
        match dice.below(10) {
            0..6 => match KEYS[dice.below(KEYS.len())] {
                '\n' => harness.key_press(Key::Enter),
                letter => harness.event(egui::Event::Text(letter.to_string())),
            },
            6 => harness.key_press(Key::Backspace),
            7 => harness.key_press(Key::Delete),
            // What was typed is taken back, so that the text is right now and then.
            _ => (0..3).for_each(|_| harness.key_press_modifiers(Modifiers::COMMAND, Key::Z)),
        }
        harness.step();
        underlines_fit(harness.state());
        // A list of names does not take the next key.
        harness.key_press(Key::Escape);
        harness.step();
        harness.get_by_role(Role::MultilineTextInput).focus();
        harness.step();
        underlines_fit(harness.state());
        if edit % PAUSE_AFTER == PAUSE_AFTER - 1 {
            if dice.below(5) == 0 {
                write(&mut harness, &text);
            }
            let newest = |app: &App| {
                let document = app.session.documents.current();
                app.session.said.words.sources.iter().any(|(_, file)| file.name == document.name && *file.text == *document.text)
            };
            until(&mut harness, |app| newest(app) && app.session.said.work.is_none());
            let app = harness.state();
            underlines_fit(app);
            let document = app.session.documents.current();
            let texts = OpenTexts::new([(document.name.clone(), document.text.as_str().into())]);
            let outcome = surefoot_compiler::compile(&texts, &document.name, &Options::default());
            let is_good = outcome.compiled.is_some();
            let words = surefoot_runtime::live::Words { sources: outcome.sources, diagnostics: outcome.diagnostics, files: outcome.files };
            assert_eq!(sorted(&app.session.said.problems), sorted(&session::problems(&words)), "of {:?}", document.text);
            (right, wrong) = if is_good { (right + 1, wrong) } else { (right, wrong + 1) };
            // Names are found in any text.
            drop(Names::read(&texts, &[&document.name]));
            // What is drawn becomes the newest text without errors, once its pipeline is there.
            until(&mut harness, |app| {
                let document = app.session.documents.current();
                app.session.said.drawn.sources.iter().any(|(_, file)| *file.text == *document.text) == is_good
            });
        }
        let app = harness.state();
        assert!(app.session.said.swaps >= swaps && app.session.scene().is_some() && app.canvas.as_ref().unwrap().samples() > 0, "there is a picture");
        assert_eq!((app.session.said.failure.as_ref(), app.session.said.drawing.as_ref()), (None, None));
        swaps = app.session.said.swaps;
    }
    assert!(right > 3 && wrong > 10, "both were tried: {right} texts were right, {wrong} were wrong");
    if let Ok(shots) = std::env::var("SUREFOOT_SHOTS") {
        harness.render().unwrap().save(Path::new(&shots).join("random.png")).unwrap();
    }
}
