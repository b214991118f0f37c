//! Texts and places in them.

use std::ops::Range;
use std::sync::Arc;

/// Which text: an index into [`Sources`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FileId(pub u32);

/// A half-open range of bytes in one text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Span {
    /// The text.
    pub file: FileId,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Span {
    /// A range of bytes in a text.
    pub fn new(file: FileId, start: usize, end: usize) -> Self {
        Self { file, start: start as u32, end: end as u32 }
    }

    /// The bytes, to index its text.
    pub fn range(self) -> Range<usize> {
        self.start as usize..self.end as usize
    }

    /// The smallest range that holds both; `self` where they are of different texts.
    pub fn to(self, other: Span) -> Self {
        if self.file != other.file {
            return self;
        }
        Self { file: self.file, start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

/// One text with its name, as a person would write it on the command line.
#[derive(Clone, Debug)]
pub struct SourceFile {
    /// The path, or `<prelude>/NAME.sdf` or `<std>/NAME.sdf`.
    pub name: String,
    /// The text.
    pub text: Arc<str>,
    /// Byte offset of each line's start.
    line_starts: Vec<u32>,
}

/// All texts of one compilation: the prelude's, the scene's and its imports'.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    files: Vec<SourceFile>,
}

impl Sources {
    /// Adds a text; the answer is its index.
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<Arc<str>>) -> FileId {
        let text: Arc<str> = text.into();
        let line_starts =
            std::iter::once(0).chain(text.match_indices('\n').map(|(i, _)| i as u32 + 1)).collect();
        self.files.push(SourceFile { name: name.into(), text, line_starts });
        FileId(self.files.len() as u32 - 1)
    }

    /// The text of an index, if there is one.
    pub fn get(&self, id: FileId) -> Option<&SourceFile> {
        self.files.get(id.0 as usize)
    }

    /// All texts with their indices.
    pub fn iter(&self) -> impl Iterator<Item = (FileId, &SourceFile)> {
        self.files.iter().enumerate().map(|(i, f)| (FileId(i as u32), f))
    }

    /// Name of the text, line and column (both from 1, columns in characters) of a byte.
    pub fn position(&self, file: FileId, byte: u32) -> (&str, u32, u32) {
        let Some(source) = self.get(file) else { return ("", 1, 1) };
        let line = source.line_starts.partition_point(|&start| start <= byte).max(1);
        let start = source.line_starts.get(line - 1).copied().unwrap_or(0) as usize;
        let end = (byte as usize).min(source.text.len());
        let column = source.text.get(start..end).map_or(0, |s| s.chars().count());
        (&source.name, line as u32, column as u32 + 1)
    }

    /// The lines on which a declaration stands, with the comment that documents it before it. Where something else stands on them, the declaration alone.
    pub fn lines_of(&self, span: Span) -> Span {
        let Some(file) = self.get(span.file) else { return span };
        let (before, after) = (file.text.get(..span.start as usize).unwrap_or(""), file.text.get(span.end as usize..).unwrap_or(""));
        let start = before.rfind('\n').map_or(0, |at| at + 1);
        let line = after.find('\n').map_or(after.len(), |at| at + 1);
        let rest = after.get(..line).unwrap_or("").trim();
        let alone = before.get(start..).is_some_and(|text| text.trim().is_empty()) && (rest.is_empty() || rest.starts_with("//"));
        if !alone {
            return span;
        }
        let mut start = start;
        while let Some(line) = before.get(..start).and_then(|text| text.strip_suffix('\n')).map(|text| text.rsplit('\n').next().unwrap_or(""))
            && line.trim_start().starts_with("///")
        {
            start -= line.len() + 1;
        }
        Span { start: start as u32, end: span.end + line as u32, ..span }
    }

    /// The text of a span, empty where it is not a whole piece of its text.
    pub fn text(&self, span: Span) -> &str {
        self.get(span.file)
            .and_then(|f| f.text.get(span.range()))
            .unwrap_or("")
    }
}

/// A file that the scene's text names.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct ImageFile {
    /// Relative to the working directory, or absolute; a folder's name may end in `/`.
    pub path: String,
    /// Where the text names it.
    pub span: Span,
}

/// What stands at a place on one line, and the name of what is called there.
pub fn written(sources: &Sources, span: Span) -> (String, String) {
    let text = sources.text(span).split_whitespace().collect::<Vec<_>>().join(" ");
    let operation = called(&text).unwrap_or("formula").to_owned();
    (text, operation)
}

/// The name in `name(…)` or `name`, where the text is nothing more than that.
fn called(text: &str) -> Option<&str> {
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    let (name, rest) = text.split_at_checked(end)?;
    if !name.starts_with(|c: char| c.is_alphabetic() || c == '_') {
        return None;
    }
    let mut depth = 0;
    for (at, c) in rest.char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ if depth == 0 => return None,
            _ => {}
        }
        if depth == 0 {
            return (at + 1 == rest.len()).then_some(name);
        }
    }
    rest.is_empty().then_some(name)
}

#[cfg(test)]
mod tests {
    use super::called;

    #[test]
    fn names_are_those_of_whole_calls() {
        assert_eq!(called("twist(y, (1 + 2))"), Some("twist"));
        assert_eq!(called("wave"), Some("wave"));
        for other in ["length(p) - 1", "(a + b)", "a | b", "2 * f(p)", "", "f(", "f(p).g()"] {
            assert_eq!(called(other), None, "{other}");
        }
    }
}
