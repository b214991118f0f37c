//! The keys, in one table; and those that work wherever the keyboard is.

use crate::window::command::Command;
use crate::window::panels::cursor::id;
use crate::window::panels::modes::MODES;
use crate::window::session::{Purpose, Session};
use crate::window::theme::TEXT_SIZE;
use egui::{Key, Modifiers, Ui};

/// How far a key moves the camera, in parts of the picture's height.
const STEP: f64 = 0.03;

/// A part of the window, with its keys and what they do.
type Part = (&'static str, &'static [(&'static str, &'static str)]);

/// All keys, and what the mouse does: F1 shows them, and `docs/editor.md` has the same table.
pub const KEYS: &[Part] = &[
    (
        "Files",
        &[
            ("Ctrl+N", "a new scene"),
            ("Ctrl+O", "open a scene"),
            ("Ctrl+S", "save"),
            ("Ctrl+Shift+S", "save under another name"),
            ("Ctrl+Shift+E", "save the picture, a film or a sequence"),
            ("F1", "this list"),
            ("Ctrl+Shift+O", "the outline: the scene's parts, hidden or alone"),
            ("Ctrl+Shift+G", "the emitted WGSL beside the text"),
            ("Ctrl+Shift+P", "what frames and their passes take"),
            ("F6", "from the text to the sliders, to the picture, and back"),
            ("Ctrl+Tab, Ctrl+Shift+Tab", "the next tab, the one before"),
            ("Ctrl+W", "close the tab"),
        ],
    ),
    (
        "Text",
        &[
            ("Ctrl+Z, Ctrl+Y", "undo, redo"),
            ("Ctrl+Space", "what may be written here"),
            ("Ctrl+.", "take the advice of the nearest problem"),
            ("F12, or Ctrl and a click", "go to where a name is declared"),
            ("F2", "another name, wherever it stands"),
            ("Ctrl+Shift+I", "lay out, as `surefoot fmt` does"),
            ("Ctrl and drag, or Alt and drag", "change a number; with Shift finer"),
            ("Alt+Up, Alt+Down", "change the number at the cursor; with Shift finer"),
            ("Ctrl+K, or a click on its square", "pick a colour"),
            ("Ctrl+/", "make comments of lines, or code again"),
            ("Tab, Shift+Tab", "move the selected lines in and out"),
            ("Ctrl++, Ctrl+-, Ctrl+0", "larger text, smaller, as at first"),
            ("Alt+Z", "wrap long lines, or not"),
        ],
    ),
    (
        "Search",
        &[
            ("Ctrl+F, then Enter; F3, Shift+F3", "find, the next, the one before"),
            ("Ctrl+H", "find and replace; Enter replaces one, Ctrl+Enter all"),
            ("Ctrl+G", "go to a line"),
            ("Escape", "back to the text"),
        ],
    ),
    (
        "Picture",
        &[
            ("Drag", "turn the camera"),
            ("Shift and drag, or the right button", "move it sideways"),
            ("Wheel", "come nearer"),
            ("Arrows, and with Shift", "turn the camera, move it sideways"),
            ("Page Up, Page Down", "come nearer, go farther"),
            ("Ctrl+1, Ctrl+2, …", "the views of the toolbar"),
            ("1, 3, 7, 9", "look from the front, from the right, from above, from a corner"),
            ("G", "a grid with a scale, or none"),
            ("5", "let rays go side by side, or not"),
            ("C, and with Shift", "cut the picture open, or not; show the other side of the cut"),
            ("W; Left and Right on the divider", "two views beside each other, or one; move the divider"),
            ("D", "the difference of the picture from what is certain of it, or none"),
            ("F", "come nearer to what was picked, or see the whole solid"),
            ("Home, or a double click", "the scene's own camera"),
            ("Alt and a click", "name what made the pixel, and follow its ray"),
            ("Space", "let time run or stand"),
            ("L", "let time begin anew at the end of the timeline, or run on"),
            ("B, or Ctrl and a click", "more balls here, in a scene with balls"),
            ("Ctrl and drag", "take a ball and throw it"),
        ],
    ),
    ("Sliders", &[("Left, Right", "change the one that has the keyboard"), ("Double click", "the value that the text gives")]),
];

/// Hears the keys that work wherever the keyboard is. Before the panels see them.
pub fn hear(ui: &Ui, session: &Session, commands: &mut Vec<Command>) {
    // What is asked is answered first.
    if session.question.is_some() || session.notice.is_some() || session.asked.is_some() || session.open.keys {
        return;
    }
    let pressed = |modifiers, key| ui.input_mut(|i| i.consume_key(modifiers, key));
    let forth = Modifiers::COMMAND | Modifiers::SHIFT;
    // With Shift first, which the one without it would take as well.
    if pressed(forth, Key::S) {
        commands.push(Command::AskPath(Some(Purpose::SaveAs)));
    } else if pressed(Modifiers::COMMAND, Key::S) {
        commands.push(Command::Save);
    }
    if pressed(forth, Key::O) {
        commands.push(Command::ShowOutline(!session.open.outline));
    } else if pressed(Modifiers::COMMAND, Key::O) {
        commands.push(Command::AskPath(Some(Purpose::Open)));
    }
    if pressed(Modifiers::COMMAND, Key::N) {
        commands.push(Command::New);
    }
    if pressed(forth, Key::G) {
        commands.push(Command::ShowShader(!session.open.shader));
    }
    if pressed(forth, Key::P) {
        commands.push(Command::ShowFrames(!session.open.frames));
    }
    if pressed(forth, Key::E) {
        commands.push(Command::AskPath(Some(Purpose::Picture)));
    }
    if pressed(Modifiers::NONE, Key::F6) {
        next_pane(ui, session, commands);
    }
    let digits = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9];
    for (key, (mode, ..)) in digits.into_iter().zip(MODES) {
        if pressed(Modifiers::COMMAND, key) {
            commands.push(Command::Mode(mode));
        }
    }
    if pressed(Modifiers::NONE, Key::F1) {
        commands.push(Command::ShowKeys(true));
    }
    if pressed(forth, Key::Tab) {
        commands.push(Command::Turnover { forth: false });
    } else if pressed(Modifiers::COMMAND, Key::Tab) {
        commands.push(Command::Turnover { forth: true });
    }
    if pressed(Modifiers::COMMAND, Key::W) {
        commands.push(Command::CloseText(session.documents.current().name.clone()));
    }
    if pressed(forth, Key::I) {
        commands.push(Command::Format);
    }
    let size = session.open.text_size;
    let plus = [Key::Plus, Key::Equals].map(|key| pressed(Modifiers::COMMAND, key) || pressed(forth, key));
    if plus.contains(&true) {
        commands.push(Command::TextSize(size + 1.0));
    }
    if pressed(Modifiers::COMMAND, Key::Minus) {
        commands.push(Command::TextSize(size - 1.0));
    }
    if pressed(Modifiers::COMMAND, Key::Num0) {
        commands.push(Command::TextSize(TEXT_SIZE));
    }
    if pressed(Modifiers::ALT, Key::Z) {
        commands.push(Command::Wrap(!session.open.wrap));
    }
}

/// From the text to the sliders, from there to the picture, and to the text again. What is closed is passed over.
fn next_pane(ui: &Ui, session: &Session, commands: &mut Vec<Command>) {
    let focused = ui.memory(|m| m.focused());
    let text = id(session.documents.current());
    let sliders = session.open.parameters && session.scene().is_some_and(|scene| !scene.parameters.is_empty());
    match focused {
        Some(focused) if focused == text && sliders => commands.push(Command::ToSliders(true)),
        Some(focused) => ui.memory_mut(|m| m.surrender_focus(focused)),
        None if session.open.source => commands.push(Command::Focus),
        None if sliders => commands.push(Command::ToSliders(true)),
        None => {}
    }
}

/// Hears the keys that move the camera, where nothing else has the keyboard.
pub fn hear_picture(ui: &Ui, session: &Session, commands: &mut Vec<Command>) {
    let is_asked = session.question.is_some() || session.notice.is_some() || session.asked.is_some() || session.open.keys || session.open.start;
    if is_asked || ui.memory(|m| m.focused().is_some()) {
        return;
    }
    let pressed = |modifiers, key| ui.input_mut(|i| i.consume_key(modifiers, key));
    for (key, right, down) in [(Key::ArrowLeft, -1.0, 0.0), (Key::ArrowRight, 1.0, 0.0), (Key::ArrowUp, 0.0, -1.0), (Key::ArrowDown, 0.0, 1.0)] {
        if pressed(Modifiers::SHIFT, key) {
            commands.push(Command::Pan(STEP * right, STEP * down));
        } else if pressed(Modifiers::NONE, key) {
            commands.push(Command::Turn(STEP * right, STEP * down));
        }
    }
    for (key, factor) in [(Key::PageUp, 1.0 / 1.1), (Key::PageDown, 1.1)] {
        if pressed(Modifiers::NONE, key) {
            commands.push(Command::Dolly(factor));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::KEYS;

    /// The table of `docs/editor.md`.
    fn page() -> String {
        let mut page = String::from("| keys | what they do |\n|---|---|\n");
        for (part, keys) in KEYS {
            page += &format!("| **{part}** | |\n");
            for (key, what) in *keys {
                page += &format!("| {key} | {what} |\n");
            }
        }
        page
    }

    #[test]
    fn the_page_has_the_same_table() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/editor.md");
        let text = std::fs::read_to_string(path).unwrap();
        let (begin, end) = ("<!-- keys -->\n\n", "\n<!-- end of keys -->");
        let (before, rest) = text.split_once(begin).unwrap();
        let (table, after) = rest.split_once(end).unwrap();
        if std::env::var_os("SUREFOOT_WRITE").is_some() {
            std::fs::write(path, format!("{before}{begin}{}{end}{after}", page())).unwrap();
            return;
        }
        assert_eq!(table, page(), "SUREFOOT_WRITE=1 cargo test --workspace --bin surefoot keys:: writes it");
    }
}
