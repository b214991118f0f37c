//! Tokens to tree. Parsing never fails: what can't be read becomes a hole in the tree, a diagnostic says what to write instead,
//! and the parser goes on at the next comma, bracket or declaration.
//!
//! No tree is higher than [`MAX_HEIGHT`], so that whoever walks it can recurse.

mod blocks;
mod declarations;
mod expressions;
mod mistaken;
mod recovery;
mod types;

use super::ast;
use super::lexer::{Token, TokenKind, lex};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::{FileId, Span};

/// How many brackets, blocks and signs may stand within each other.
pub const MAX_NESTING: usize = 200;

/// How many nodes lie at most between a declaration and its deepest leaf. A bracket can hold several: `(1 + 2 * (…))`.
pub const MAX_HEIGHT: usize = 400;

/// Reads a text. The tree holds everything that could be read; the diagnostics are in the order of the text.
pub fn parse(file: FileId, text: &str) -> (ast::File, Vec<Diagnostic>) {
    let (all, diagnostics) = lex(file, text);
    let mut tokens: Vec<Token> = Vec::with_capacity(all.len());
    let mut docs: Vec<(usize, String)> = Vec::new();
    let mut file_doc: Option<String> = None;
    for token in all {
        match token.kind {
            TokenKind::LineComment | TokenKind::BlockComment => {}
            TokenKind::Doc if stands_after_something(text, &tokens, token) => {}
            TokenKind::Doc => {
                let line = doc_line(token.text(text), "///");
                match docs.last_mut() {
                    Some((at, lines)) if *at == tokens.len() => {
                        lines.push('\n');
                        lines.push_str(line);
                    }
                    _ => docs.push((tokens.len(), line.to_string())),
                }
            }
            TokenKind::FileDoc if tokens.is_empty() => {
                let line = doc_line(token.text(text), "//!");
                match &mut file_doc {
                    Some(lines) => {
                        lines.push('\n');
                        lines.push_str(line);
                    }
                    None => file_doc = Some(line.to_string()),
                }
            }
            TokenKind::FileDoc => {}
            _ => {
                // What documents reaches over the `;` or `,` of what stands before.
                if matches!(token.kind, TokenKind::Semicolon | TokenKind::Comma)
                    && let Some((at, _)) = docs.last_mut()
                    && *at == tokens.len()
                {
                    *at += 1;
                }
                tokens.push(token);
            }
        }
    }
    let mut parser = Parser {
        file,
        text,
        tokens,
        docs,
        at: 0,
        opens: Vec::new(),
        nesting: 0,
        height: 0,
        said_too_deep: false,
        last_report: None,
        said_then: false,
        misnamed: Vec::new(),
        stray_lets: Vec::new(),
        diagnostics,
    };
    let items = parser.items();
    let mut diagnostics = parser.diagnostics;
    diagnostics.sort_by_key(|d| d.span.start);
    (ast::File { items, doc: file_doc }, diagnostics)
}

/// Whether a token stands on the same line before a comment, which then documents nothing.
fn stands_after_something(text: &str, tokens: &[Token], comment: Token) -> bool {
    tokens.last().is_some_and(|last| {
        text.get(last.end as usize..comment.start as usize).is_some_and(|gap| !gap.contains('\n'))
    })
}

fn doc_line<'t>(text: &'t str, mark: &str) -> &'t str {
    let line = text.strip_prefix(mark).unwrap_or(text);
    line.strip_prefix(' ').unwrap_or(line).trim_end()
}

struct Parser<'t> {
    file: FileId,
    text: &'t str,
    /// Without comments.
    tokens: Vec<Token>,
    /// Documentation by the index of the token that follows it.
    docs: Vec<(usize, String)>,
    /// Index of the next token.
    at: usize,
    /// The brackets that are open here.
    opens: Vec<TokenKind>,
    /// How many expressions, blocks and types are being read within each other.
    nesting: usize,
    /// Height of the highest tree that was finished since the node now being read began. Each function that makes a node
    /// sets it to 0, reads the children, adds 1 for itself, and leaves the larger of that and what it found.
    height: usize,
    /// One declaration says once that it is too deep.
    said_too_deep: bool,
    /// The token at which something was said last: what follows from it is not said again.
    last_report: Option<usize>,
    /// That an `if` has no `then` was said.
    said_then: bool,
    /// Words that were said to be no names where they are declared.
    misnamed: Vec<&'t str>,
    /// `let`s found among the entries of a block.
    stray_lets: Vec<ast::Let>,
    diagnostics: Vec<Diagnostic>,
}

impl<'t> Parser<'t> {
    fn token_at(&self, index: usize) -> Token {
        let end = self.text.len() as u32;
        self.tokens.get(index).copied().unwrap_or(Token { kind: TokenKind::End, start: end, end })
    }

    fn peek(&self) -> Token {
        self.token_at(self.at)
    }

    fn peek_next(&self) -> Token {
        self.token_at(self.at + 1)
    }

    fn is(&self, kind: TokenKind) -> bool {
        self.peek().kind == kind
    }

    fn next_is(&self, kind: TokenKind) -> bool {
        self.peek_next().kind == kind
    }

    fn word_of(&self, token: Token) -> &'t str {
        if token.kind == TokenKind::Name { token.text(self.text) } else { "" }
    }

    fn is_word(&self, word: &str) -> bool {
        self.word_of(self.peek()) == word
    }

    /// Whether a `let` starts here, and not an entry whose key is that word.
    fn at_let(&self) -> bool {
        self.is_word("let") && !self.next_is(TokenKind::Colon)
    }

    fn bump(&mut self) -> Token {
        let token = self.peek();
        if token.kind != TokenKind::End {
            self.at += 1;
        }
        token
    }

    fn eat(&mut self, kind: TokenKind) -> Option<Token> {
        self.is(kind).then(|| self.bump())
    }

    fn eat_word(&mut self, word: &str) -> Option<Token> {
        self.is_word(word).then(|| self.bump())
    }

    fn previous(&self) -> Option<Token> {
        self.at.checked_sub(1).and_then(|i| self.tokens.get(i)).copied()
    }

    /// The end of what was read so far.
    fn end(&self) -> u32 {
        self.previous().map_or(0, |t| t.end)
    }

    fn span_from(&self, start: u32) -> Span {
        Span { file: self.file, start, end: self.end().max(start) }
    }

    fn span(&self, token: Token) -> Span {
        token.span(self.file)
    }

    fn name_of(&self, token: Token) -> ast::Name {
        ast::Name { text: token.text(self.text).into(), span: self.span(token) }
    }

    /// Whether a line ends between the token before and this one.
    fn is_on_new_line(&self) -> bool {
        let start = self.end() as usize;
        self.text.get(start..self.peek().start as usize).is_some_and(|gap| gap.contains('\n'))
    }

    /// Whether a token stands at the very start of its line.
    fn is_flush(&self, token: Token) -> bool {
        let start = token.start as usize;
        start == 0 || self.text.as_bytes().get(start - 1) == Some(&b'\n')
    }

    fn doc_here(&self) -> Option<String> {
        let i = self.docs.binary_search_by_key(&self.at, |(at, _)| *at).ok()?;
        self.docs.get(i).map(|(_, text)| text.clone())
    }

    /// Says something, unless something was said at this token already.
    fn report(
        &mut self,
        code: Code,
        span: Span,
        message: impl Into<String>,
        help: impl Into<String>,
    ) {
        self.say(Diagnostic::new(code, span, message, help));
    }

    /// The same of a diagnostic that is made already.
    fn say(&mut self, diagnostic: Diagnostic) {
        let bad = matches!(self.peek().kind, TokenKind::BadCharacter | TokenKind::BadLiteral);
        if bad || self.last_report == Some(self.at) {
            return;
        }
        self.last_report = Some(self.at);
        self.diagnostics.push(diagnostic);
    }

    /// Says that the next token is wrong, and what stands in its place.
    fn unexpected_for(&mut self, message: impl Into<String>, help: impl Into<String>, ours: &str) {
        let span = self.span(self.peek());
        self.say(Diagnostic::new(Code::Unexpected, span, message, help).write(span, ours));
    }

    /// Says that the next token is wrong.
    fn unexpected(&mut self, message: impl Into<String>, help: impl Into<String>) {
        let span = self.span(self.peek());
        self.report(Code::Unexpected, span, message, help);
    }

    /// Says that something is missing here: at the next token where it stands on the same line, else after the last one.
    fn missing(&mut self, wanted: &str, help: impl Into<String>) {
        match self.previous() {
            Some(last) if self.is(TokenKind::End) || self.is_on_new_line() => {
                let message = format!("{wanted} is missing after {}", self.describe(last));
                let span = self.span(last);
                self.report(Code::Unexpected, span, message, help);
            }
            _ => {
                let message = format!("expected {wanted}, found {}", self.describe(self.peek()));
                self.unexpected(message, help);
            }
        }
    }

    fn describe(&self, token: Token) -> String {
        let text: String = token.text(self.text).chars().take(30).collect();
        match token.kind {
            TokenKind::End => "the end of the text".to_string(),
            TokenKind::Name if super::words::is_reserved(&text) => format!("the word `{text}`"),
            TokenKind::Str => format!("the text `{text}`"),
            _ => format!("`{text}`"),
        }
    }

    /// Reads something that may hold itself. Where it is too deep, says so, skips it and answers nothing.
    fn nested<T>(&mut self, read: impl FnOnce(&mut Self) -> T) -> Option<T> {
        if self.nesting >= MAX_NESTING {
            self.too_deep(self.span(self.peek()));
            self.skip_nested();
            return None;
        }
        let outside = std::mem::take(&mut self.height);
        self.nesting += 1;
        let value = read(self);
        self.nesting -= 1;
        self.height = outside.max(self.height);
        Some(value)
    }

    /// Counts a node above the trees that were just finished; false where that makes it too high to be kept.
    fn grow(&mut self, span: Span) -> bool {
        self.height += 1;
        if self.height <= MAX_HEIGHT {
            return true;
        }
        self.height = 0;
        self.too_deep(span);
        false
    }

    fn too_deep(&mut self, span: Span) {
        if !self.said_too_deep {
            self.said_too_deep = true;
            self.diagnostics.push(Diagnostic::new(
                Code::TooDeep,
                span,
                format!("nested deeper than {MAX_NESTING}"),
                "name a part of it with `let`, and use the name here",
            ));
        }
    }
}
