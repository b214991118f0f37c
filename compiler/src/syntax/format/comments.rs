//! Comments, and where they go.

use super::super::lexer::{Token, TokenKind};
use super::doc::Doc;

/// A comment of the text.
#[derive(Clone, Copy, Debug)]
pub(super) struct Comment<'t> {
    start: u32,
    end: u32,
    text: &'t str,
    kind: TokenKind,
    /// Nothing but comments stands before it on its line.
    own_line: bool,
    /// Nothing but comments stands after it on its line.
    ends_line: bool,
}

impl<'t> Comment<'t> {
    /// Its text where it may come to stand on a line of its own: what stood behind something else documents nothing, and must
    /// not start to.
    fn moved(self) -> &'t str {
        let documents_nothing = self.kind == TokenKind::Doc && !self.own_line;
        self.text.strip_prefix('/').filter(|_| documents_nothing).unwrap_or(self.text)
    }
}

/// The comments of a text that are not written yet.
pub(super) struct Comments<'t> {
    text: &'t str,
    /// The last first.
    waiting: Vec<Comment<'t>>,
}

/// What stands between two things that may have a line's end between them.
pub(super) struct Between<'t> {
    /// At the end of the line of the first.
    pub(super) trailing: Doc<'t>,
    /// Before the second, with the ends of their lines.
    pub(super) leading: Vec<Doc<'t>>,
    /// Whether an empty line stands before all that.
    pub(super) blank: bool,
}

impl Between<'_> {
    /// The end of the line between the two, where `plain` stands if the text has no empty line there.
    pub(super) fn line<'t>(&self, plain: Doc<'t>) -> Doc<'t> {
        if self.blank { Doc::Blank } else { plain }
    }
}

impl<'t> Comments<'t> {
    pub(super) fn new(text: &'t str, tokens: &[Token]) -> Self {
        let mut waiting: Vec<Comment> = Vec::new();
        let mut end_before = 0;
        let mut own_line = true;
        for token in tokens {
            own_line |= has_line_end(text, end_before, token.start);
            if is_comment(*token) {
                let words = token.text(text).trim_end();
                waiting.push(Comment {
                    start: token.start,
                    end: token.end,
                    text: words,
                    kind: token.kind,
                    own_line,
                    ends_line: false,
                });
            } else {
                own_line = false;
            }
            end_before = token.end;
        }
        let mut next_start = text.len() as u32;
        let mut next_ends_line = true;
        let mut rest = waiting.iter_mut().rev();
        for token in tokens.iter().rev() {
            if is_comment(*token) {
                let ends_line = next_ends_line || has_line_end(text, token.end, next_start);
                if let Some(comment) = rest.next() {
                    comment.ends_line = ends_line;
                }
                next_ends_line = ends_line;
            } else {
                next_ends_line = false;
            }
            next_start = token.start;
        }
        waiting.reverse();
        Comments { text, waiting }
    }

    /// Whether a comment waits that stands before a byte.
    pub(super) fn any_before(&self, at: u32) -> bool {
        self.waiting.last().is_some_and(|comment| comment.start < at)
    }

    /// Whether a comment waits that stands between two bytes.
    pub(super) fn any_between(&self, from: u32, to: u32) -> bool {
        let after = self.waiting.partition_point(|comment| comment.start >= from);
        after
            .checked_sub(1)
            .and_then(|i| self.waiting.get(i))
            .is_some_and(|comment| comment.start < to)
    }

    fn next_before(&mut self, at: u32) -> Option<Comment<'t>> {
        self.waiting.pop_if(|comment| comment.start < at)
    }

    /// The comments up to a thing before which a line may end.
    pub(super) fn between(&mut self, at: u32) -> Between<'t> {
        let mut trailing = Vec::new();
        let mut leading = Vec::new();
        let mut blank = false;
        let mut line_is_closed = false;
        while let Some(comment) = self.next_before(at) {
            // All that stands on the line of what came before ends that line, if it ends in a comment.
            let starts_own_line = line_is_closed || leading.iter().any(Doc::breaks);
            if !comment.own_line && comment.ends_line && !starts_own_line {
                line_is_closed = comment.kind != TokenKind::BlockComment;
                for doc in leading.drain(..).chain([Doc::Text(comment.text)]) {
                    if let Doc::Text(text) = doc
                        && text != " "
                    {
                        trailing.push(Doc::Trailing(text, true));
                    }
                }
                continue;
            }
            let empty = comment.own_line && self.is_after_empty_line(comment.start);
            match leading.is_empty() {
                true => blank = empty,
                false if empty => leading.push(Doc::Blank),
                false => {}
            }
            leading.push(Doc::Text(comment.moved()));
            let ends = match self.waiting.last().filter(|next| next.start < at) {
                Some(next) => has_line_end(self.text, comment.end, next.start),
                None => comment.ends_line,
            };
            leading.push(if ends { Doc::Hard } else { Doc::Text(" ") });
        }
        let empty = self.is_after_empty_line(at);
        match leading.is_empty() {
            true => blank = empty,
            false if empty => leading.push(Doc::Blank),
            false => {}
        }
        Between { trailing: Doc::concat(trailing), leading, blank }
    }

    /// The comments up to a closing bracket; the line of the bracket itself is left to the caller.
    pub(super) fn closing(&mut self, at: u32) -> Doc<'t> {
        let mut docs = Vec::new();
        let mut own = false;
        while let Some(comment) = self.next_before(at) {
            if !own && !comment.own_line {
                own = comment.kind != TokenKind::BlockComment;
                docs.push(match comment.ends_line {
                    true => Doc::Trailing(comment.text, true),
                    false => Doc::IfBroken(
                        Box::new(Doc::Trailing(comment.text, false)),
                        Box::new(Doc::concat(vec![Doc::Text(" "), Doc::Text(comment.text)])),
                    ),
                });
                continue;
            }
            own = true;
            let empty = self.is_after_empty_line(comment.start);
            docs.push(if empty { Doc::Blank } else { Doc::Hard });
            docs.push(Doc::Text(comment.text));
        }
        Doc::concat(docs)
    }

    /// The comments up to a thing before which no line ends, unless a comment ends it.
    pub(super) fn within(&mut self, at: u32) -> Doc<'t> {
        let mut docs = Vec::new();
        while let Some(comment) = self.next_before(at) {
            match comment.kind {
                TokenKind::BlockComment => docs.extend([Doc::Text(comment.text), Doc::Text(" ")]),
                // What documents has to stay before what it documents.
                TokenKind::Doc if comment.own_line => {
                    docs.extend([Doc::Hard, Doc::Text(comment.text), Doc::Hard]);
                }
                _ => docs.extend([Doc::Trailing(comment.moved(), true), Doc::Hard]),
            }
        }
        Doc::concat(docs)
    }

    /// Whether an empty line stands right before a byte.
    fn is_after_empty_line(&self, at: u32) -> bool {
        let before = self.text.get(..at as usize).unwrap_or("");
        let space = before.len() - before.trim_end().len();
        before.bytes().rev().take(space).filter(|&b| b == b'\n').count() > 1
    }
}

fn is_comment(token: Token) -> bool {
    matches!(
        token.kind,
        TokenKind::LineComment | TokenKind::BlockComment | TokenKind::Doc | TokenKind::FileDoc
    )
}

fn has_line_end(text: &str, from: u32, to: u32) -> bool {
    text.get(from as usize..to as usize).is_some_and(|gap| gap.contains('\n'))
}
