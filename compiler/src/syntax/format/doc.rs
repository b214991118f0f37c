//! A text with places where its lines may end, and the choice of where they do (after Wadler's "A prettier printer").

/// A line holds at most this many characters where it can be broken.
pub(super) const WIDTH: usize = 100;

/// A body moves below its `=` rather than align its operators further right than this.
const FAR: usize = 30;

/// A text that may be broken over lines.
#[derive(Debug)]
pub(super) enum Doc<'t> {
    /// Characters; a comment may hold ends of lines.
    Text(&'t str),
    /// A space, or the end of a line.
    Line,
    /// Nothing, or the end of a line.
    Soft,
    /// The end of a line.
    Hard,
    /// The end of a line, and an empty line.
    Blank,
    /// One after the other.
    Concat(Vec<Doc<'t>>, Breaks),
    /// Two columns further right, where lines end within.
    Indent(Box<Doc<'t>>),
    /// As far right as it starts, less a number of columns.
    Align(usize, Box<Doc<'t>>),
    /// On one line, or broken at all of its places.
    Group(Box<Doc<'t>>, Breaks),
    /// A group that is broken rather than the one before it.
    Yielding(Box<Doc<'t>>, Breaks),
    /// The first where the group is broken, else the second.
    IfBroken(Box<Doc<'t>>, Box<Doc<'t>>),
    /// A comment for the end of the line that is being written, and that ends right after what stands here.
    Trailing(&'t str, Breaks),
    /// What follows `=`: on the same line, or whole on the next one, or broken.
    Body(Box<Doc<'t>>, Hug),
}

/// Whether a line has to end within.
type Breaks = bool;

/// How a body that fits on no line is broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Hug {
    /// It starts on the line of the `=`, and is not tried whole on the next one.
    Now,
    /// It starts on the line of the `=`.
    Always,
    /// It starts on the line of the `=` where that is not too far right.
    Near,
    /// It starts on the next line.
    Never,
}

impl<'t> Doc<'t> {
    pub(super) fn nil() -> Self {
        Doc::Text("")
    }

    pub(super) fn concat(docs: Vec<Doc<'t>>) -> Self {
        let breaks = docs.iter().any(Doc::breaks);
        Doc::Concat(docs, breaks)
    }

    pub(super) fn group(doc: Doc<'t>) -> Self {
        let breaks = doc.breaks();
        Doc::Group(Box::new(doc), breaks)
    }

    pub(super) fn yielding(doc: Doc<'t>) -> Self {
        let breaks = doc.breaks();
        Doc::Yielding(Box::new(doc), breaks)
    }

    pub(super) fn indent(doc: Doc<'t>) -> Self {
        Doc::Indent(Box::new(doc))
    }

    pub(super) fn align(back: usize, doc: Doc<'t>) -> Self {
        Doc::Align(back, Box::new(doc))
    }

    /// Whether a line has to end within.
    pub(super) fn breaks(&self) -> bool {
        match self {
            Doc::Text(text) => text.contains('\n'),
            Doc::Hard | Doc::Blank => true,
            Doc::Line | Doc::Soft | Doc::IfBroken(..) => false,
            Doc::Concat(_, breaks)
            | Doc::Group(_, breaks)
            | Doc::Yielding(_, breaks)
            | Doc::Trailing(_, breaks) => *breaks,
            Doc::Indent(doc) | Doc::Align(_, doc) | Doc::Body(doc, _) => doc.breaks(),
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Mode {
    Flat,
    Broken,
}

type Work<'d, 't> = (usize, Mode, &'d Doc<'t>);

/// Writes a text, choosing where its lines end.
pub(super) fn print(doc: &Doc) -> String {
    let mut page = Page::default();
    let mut stack: Vec<Work> = vec![(0, Mode::Broken, doc)];
    while let Some((indent, mode, doc)) = stack.pop() {
        match doc {
            Doc::Text(text) => page.write(text),
            Doc::Line if mode == Mode::Flat => page.write(" "),
            Doc::Soft if mode == Mode::Flat => {}
            Doc::Line | Doc::Soft | Doc::Hard => page.newline(indent, 1),
            Doc::Blank => page.newline(indent, 2),
            Doc::Concat(docs, _) => stack.extend(docs.iter().rev().map(|d| (indent, mode, d))),
            Doc::Indent(doc) => stack.push((indent + 2, mode, doc)),
            Doc::Align(back, doc) => {
                let column = page.column.saturating_sub(*back).max(indent);
                stack.push((column, mode, doc));
            }
            Doc::Group(doc, breaks) | Doc::Yielding(doc, breaks) => {
                let flat = !breaks && fits(doc, &stack, page.column);
                stack.push((indent, if flat { Mode::Flat } else { Mode::Broken }, doc));
            }
            Doc::IfBroken(broken, flat) => {
                stack.push((indent, mode, if mode == Mode::Broken { broken } else { flat }));
            }
            Doc::Trailing(text, _) => page.trailing.push(text.to_string()),
            Doc::Body(doc, hug) => {
                let whole = !doc.breaks();
                let column = page.column + 1;
                if mode == Mode::Flat || whole && fits(doc, &stack, column) {
                    page.write(" ");
                    stack.push((indent, Mode::Flat, doc));
                } else if *hug != Hug::Now && whole && fits(doc, &stack, indent + 2) {
                    page.newline(indent + 2, 1);
                    stack.push((indent + 2, Mode::Flat, doc));
                } else if *hug == Hug::Never || *hug == Hug::Near && column > indent + FAR {
                    page.newline(indent + 2, 1);
                    stack.push((indent + 2, Mode::Broken, doc));
                } else {
                    page.write(" ");
                    stack.push((indent, Mode::Broken, doc));
                }
            }
        }
    }
    page.newline(0, 1);
    page.out
}

/// Whether a text fits on the line whole, with what follows it up to where the line may end.
fn fits(doc: &Doc, after: &[Work], column: usize) -> bool {
    let mut column = column;
    let mut after = after.iter().rev();
    let mut stack: Vec<Work> = vec![(0, Mode::Flat, doc)];
    loop {
        if column > WIDTH {
            return false;
        }
        let Some((_, mode, doc)) = stack.pop().or_else(|| after.next().copied()) else {
            return true;
        };
        match doc {
            Doc::Text(text) => match text.split_once('\n') {
                Some((first, _)) => return column + first.chars().count() <= WIDTH,
                None => column += text.chars().count(),
            },
            Doc::Line if mode == Mode::Flat => column += 1,
            Doc::Soft if mode == Mode::Flat => {}
            Doc::Line | Doc::Soft | Doc::Hard | Doc::Blank => return true,
            Doc::Concat(docs, _) => stack.extend(docs.iter().rev().map(|d| (0, mode, d))),
            Doc::Indent(doc) | Doc::Align(_, doc) | Doc::Yielding(doc, _) => {
                stack.push((0, mode, doc))
            }
            Doc::Group(doc, breaks) => {
                let mode = if *breaks { mode } else { Mode::Flat };
                stack.push((0, mode, doc));
            }
            Doc::IfBroken(broken, flat) => {
                stack.push((0, mode, if mode == Mode::Broken { broken } else { flat }));
            }
            Doc::Trailing(..) => {}
            Doc::Body(doc, _) => {
                if mode == Mode::Broken {
                    return true;
                }
                column += 1;
                stack.push((0, mode, doc));
            }
        }
    }
}

#[derive(Default)]
struct Page {
    out: String,
    /// Characters in the line so far, the indentation too before it is written.
    column: usize,
    /// Spaces to write before the next character.
    indent: usize,
    /// Whether anything but comments stands in the line so far.
    line_has_code: bool,
    /// Comments for the end of this line.
    trailing: Vec<String>,
}

impl Page {
    fn write(&mut self, text: &str) {
        if text.is_empty() || text == " " && (self.out.is_empty() || self.out.ends_with('\n')) {
            return;
        }
        self.start_line();
        self.out.push_str(text);
        self.line_has_code |= text != " " && !text.starts_with("/*") && !text.starts_with("//");
        match text.rsplit_once('\n') {
            Some((_, last)) => self.column = last.chars().count(),
            None => self.column += text.chars().count(),
        }
    }

    fn start_line(&mut self) {
        if self.out.is_empty() || self.out.ends_with('\n') {
            self.out.extend(std::iter::repeat_n(' ', self.indent));
        }
    }

    /// Ends the line; with a count of two, an empty line follows.
    fn newline(&mut self, indent: usize, count: usize) {
        for (i, text) in std::mem::take(&mut self.trailing).into_iter().enumerate() {
            let line = self.out.rsplit_once('\n').map_or(self.out.as_str(), |(_, line)| line);
            if line.trim().is_empty() {
                self.indent = indent;
                self.start_line();
            } else {
                self.trim();
                self.out.push_str(if i == 0 && self.line_has_code { "  " } else { " " });
            }
            self.out.push_str(&text);
        }
        self.trim();
        let ends = self.out.len() - self.out.trim_end_matches('\n').len();
        let wanted = if self.out.is_empty() { 0 } else { count };
        self.out.extend(std::iter::repeat_n('\n', wanted.saturating_sub(ends)));
        self.indent = indent;
        self.column = indent;
        self.line_has_code = false;
    }

    fn trim(&mut self) {
        self.out.truncate(self.out.trim_end_matches(' ').len());
    }
}
