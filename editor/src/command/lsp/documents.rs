//! Texts that are open in an editor, and what stands on disk beside them.

use crate::files;
use lsp_types::{Position, TextDocumentContentChangeEvent, Uri};
use std::str::FromStr;
use std::sync::Arc;
use surefoot_compiler::language_service::Lines;
use surefoot_compiler::program::load::join;

/// A text that is open.
#[derive(Clone, Debug)]
pub(super) struct Document {
    /// As the client names it.
    pub(super) uri: Uri,
    /// As the client counts.
    pub(super) version: i32,
    /// The text.
    pub(super) text: Arc<str>,
}

/// The path of a document. One that is no file has its whole name.
pub(super) fn path_of(uri: &Uri) -> String {
    let text = uri.as_str();
    let Some(rest) = text.strip_prefix("file://") else { return text.to_owned() };
    let path = rest.find('/').map_or("", |slash| &rest[slash..]);
    let decoded = decoded(path.split(['?', '#']).next().unwrap_or(path));
    // `/c:/scene.sdf`
    let drive = decoded.as_bytes().get(1).is_some_and(u8::is_ascii_alphabetic) && decoded.as_bytes().get(2) == Some(&b':');
    join("", if drive { &decoded[1..] } else { &decoded })
}

/// The name of a file for a client.
pub(super) fn uri_of(path: &str) -> Option<Uri> {
    let absolute = if path.starts_with('/') || path.as_bytes().get(1) == Some(&b':') {
        path.to_owned()
    } else {
        std::env::current_dir().ok()?.join(path).to_string_lossy().replace('\\', "/")
    };
    let mut text = String::from(if absolute.starts_with('/') { "file://" } else { "file:///" });
    for byte in absolute.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte) {
            text.push(char::from(byte));
        } else {
            text.push_str(&format!("%{byte:02X}"));
        }
    }
    Uri::from_str(&text).ok()
}

/// A text whose `%41` are characters again. What is no such code stays.
fn decoded(text: &str) -> String {
    let bytes = text.as_bytes();
    let (mut out, mut at) = (Vec::with_capacity(bytes.len()), 0);
    while let Some(&byte) = bytes.get(at) {
        let code = bytes.get(at + 1..at + 3).filter(|_| byte == b'%').and_then(|code| std::str::from_utf8(code).ok());
        match code.and_then(|code| u8::from_str_radix(code, 16).ok()) {
            Some(code) => {
                out.push(code);
                at += 3;
            }
            None => {
                out.push(byte);
                at += 1;
            }
        }
    }
    String::from_utf8_lossy(&out).into_owned()
}

/// The byte at a position of a text.
pub(super) fn offset(lines: &Lines<'_>, position: Position) -> usize {
    lines.offset(surefoot_compiler::language_service::Position { line: position.line, column: position.character })
}

/// A text after what its client says has changed.
pub(super) fn changed(text: &str, changes: Vec<TextDocumentContentChangeEvent>) -> String {
    let mut text = text.to_owned();
    for change in changes {
        match change.range {
            None => text = change.text,
            Some(range) => {
                let lines = Lines::new(&text);
                let (start, end) = (offset(&lines, range.start), offset(&lines, range.end));
                text.replace_range(start.min(end)..end.max(start), &change.text);
            }
        }
    }
    // What no file may be no document is.
    if text.len() as u64 > files::LARGEST_FILE { String::new() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_and_names_go_both_ways() {
        let path = |text: &str| path_of(&Uri::from_str(text).unwrap());
        assert_eq!(path("file:///a%20b/%C3%A4.sdf"), "/a b/ä.sdf");
        assert_eq!(path("file:///c%3A/a/../b.sdf"), "c:/b.sdf");
        assert_eq!(path("file://host/a.sdf"), "/a.sdf");
        assert_eq!(path("untitled:Untitled-1"), "untitled:Untitled-1");
        assert_eq!((decoded("/a%2"), decoded("%zz%C3%A4%"), decoded("%FF")), ("/a%2".to_owned(), "%zzä%".to_owned(), "\u{fffd}".to_owned()));
        for there in ["/a b/ä#?.sdf", "/x/%41.sdf", "c:/b.sdf"] {
            assert_eq!(path_of(&uri_of(there).unwrap()), there);
        }
    }

    #[test]
    fn changes_apply_one_after_another() {
        let change = |start: (u32, u32), end: (u32, u32), text: &str| TextDocumentContentChangeEvent {
            range: Some(lsp_types::Range::new(Position::new(start.0, start.1), Position::new(end.0, end.1))),
            range_length: None,
            text: text.to_owned(),
        };
        assert_eq!(changed("ab\n𝄞d\n", vec![change((1, 2), (1, 3), "x"), change((0, 0), (0, 1), "")]), "b\n𝄞x\n");
        // Out of range, the wrong way round, within a character.
        assert_eq!(changed("ab", vec![change((9, 9), (0, 1), "c")]), "ac");
        assert_eq!(changed("𝄞", vec![change((0, 1), (0, 1), "c")]), "c𝄞");
        let whole = TextDocumentContentChangeEvent { range: None, range_length: None, text: "new".to_owned() };
        assert_eq!(changed("old", vec![whole]), "new");
    }
}
