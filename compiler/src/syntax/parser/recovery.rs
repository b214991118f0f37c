//! Lists between brackets, and how to go on after an error.

use super::super::lexer::{Token, TokenKind};
use super::super::words;
use super::Parser;
use crate::diagnostic::{Code, Diagnostic};

/// What a list between brackets holds, in the words of its diagnostics.
pub(super) struct ListOf {
    /// `arguments`
    pub(super) plural: &'static str,
    /// An example of one.
    pub(super) example: &'static str,
}

impl Parser<'_> {
    /// Reads elements with commas between them until `close`. `open` was read already.
    pub(super) fn list<T>(
        &mut self,
        open: Token,
        close: TokenKind,
        of: &ListOf,
        element: fn(&mut Self) -> Option<T>,
    ) -> Vec<T> {
        self.opens.push(open.kind);
        let mut elements = Vec::new();
        loop {
            if self.eat(close).is_some() {
                break;
            }
            if self.list_is_cut(close) {
                self.unclosed(open);
                break;
            }
            if self.is(TokenKind::Comma) {
                let message = format!("expected {}, found `,`", of.example);
                self.unexpected(message, "take the comma out, or write what stands before it");
                self.bump();
                continue;
            }
            let before = self.at;
            elements.extend(element(self));
            if self.eat(TokenKind::Comma).is_some() || self.is(close) {
                continue;
            }
            if self.list_is_cut(close) {
                self.unclosed(open);
                break;
            }
            self.after_element(close, of, before);
        }
        self.opens.pop();
        elements
    }

    /// After an element stands neither a comma nor the closing bracket.
    fn after_element(&mut self, close: TokenKind, of: &ListOf, before: usize) {
        if self.is(TokenKind::Semicolon) && close == TokenKind::BraceClose {
            self.unexpected_for(format!("{} are separated by `,`, found `;`", of.plural), "write `,` in its place", ",");
            self.bump();
            return;
        }
        if self.at > before && self.starts_operand() {
            self.missing("`,`", format!("write `,` between {}", of.plural));
            return;
        }
        let closing = bracket_text(close);
        self.missing(
            &format!("`,` or `{closing}`"),
            format!("{} are separated by `,` and end with `{closing}`", of.plural),
        );
        if self.at == before {
            self.skip_balanced();
        }
        while !self.is(TokenKind::Comma) && !self.is(close) && !self.list_is_cut(close) {
            self.skip_balanced();
        }
        self.eat(TokenKind::Comma);
    }

    /// Whether the list can't go on here: its closing bracket is missing.
    fn list_is_cut(&self, close: TokenKind) -> bool {
        match self.peek().kind {
            TokenKind::End => true,
            TokenKind::Semicolon => {
                close != TokenKind::BraceClose && self.opens.contains(&TokenKind::BraceOpen)
            }
            kind => {
                let foreign = opening_of(kind).filter(|_| kind != close);
                foreign.is_some_and(|open| self.opens.contains(&open)) || self.at_declaration()
            }
        }
    }

    /// Says that a bracket has no partner.
    pub(super) fn unclosed(&mut self, open: Token) {
        let text = open.text(self.text);
        let closing = closing_of(open.kind).map_or("", bracket_text);
        if self.last_report != Some(self.at) {
            self.last_report = Some(self.at);
            let mut diagnostic = Diagnostic::new(
                Code::Unclosed,
                self.span(open),
                format!("`{text}` is not closed"),
                format!("write `{closing}` where it ends"),
            );
            if let Some(last) = self.previous() {
                diagnostic = diagnostic.label(
                    self.span(last),
                    format!("perhaps after this, before {}", self.describe(self.peek())),
                );
            }
            self.diagnostics.push(diagnostic);
        }
    }

    /// Skips one token, or a bracket with all that it holds as far as the next declaration.
    pub(super) fn skip_balanced(&mut self) {
        let mut depth = 0usize;
        loop {
            let token = self.peek();
            match token.kind {
                TokenKind::End => return,
                TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen => depth += 1,
                TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => {
                    depth = depth.saturating_sub(1)
                }
                _ if depth > 0 && self.is_flush(token) && self.at_declaration() => return,
                _ => {}
            }
            self.bump();
            if depth == 0 {
                return;
            }
        }
    }

    /// Skips what is nested too deep.
    pub(super) fn skip_nested(&mut self) {
        loop {
            match self.peek().kind {
                TokenKind::End
                | TokenKind::Comma
                | TokenKind::Semicolon
                | TokenKind::ParenClose
                | TokenKind::BracketClose
                | TokenKind::BraceClose => break,
                _ if self.at_declaration() => break,
                _ => self.skip_balanced(),
            }
        }
        // What is missing after it follows from it.
        self.last_report = Some(self.at);
    }

    /// Skips to the next declaration.
    pub(super) fn skip_to_declaration(&mut self) {
        while !self.is(TokenKind::End) && !self.at_declaration() {
            self.skip_balanced();
        }
    }

    /// Whether a declaration starts here: its word, in the form that it has there. Within a block a `let` counts only at
    /// the very start of a line.
    pub(super) fn at_declaration(&self) -> bool {
        let token = self.peek();
        let word = self.word_of(token);
        if !words::DECLARATIONS.contains(&word) {
            return false;
        }
        let next = self.peek_next();
        let third = self.token_at(self.at + 2);
        let named = next.kind == TokenKind::Name;
        let flush = self.is_flush(token);
        match word {
            "import" => matches!(next.kind, TokenKind::Str | TokenKind::BadLiteral),
            "param" => named,
            "let" => named && (flush || self.opens.last() != Some(&TokenKind::BraceOpen)),
            "scene" => next.kind == TokenKind::Equals,
            "material" => {
                named
                    && (flush || matches!(third.kind, TokenKind::BraceOpen | TokenKind::ParenOpen))
            }
            "camera" | "light" | "environment" | "render" | "physics" | "balls" => {
                next.kind == TokenKind::BraceOpen || named && third.kind == TokenKind::BraceOpen
            }
            "mesh" => match next.kind {
                TokenKind::BraceOpen | TokenKind::Str => true,
                TokenKind::Name => {
                    matches!(
                        third.kind,
                        TokenKind::BraceOpen | TokenKind::Str | TokenKind::BadLiteral
                    )
                }
                _ => false,
            },
            _ => {
                let claimed = matches!(self.word_of(third), "exact" | "lipschitz");
                named
                    && (flush
                        || claimed
                        || matches!(third.kind, TokenKind::ParenOpen | TokenKind::Equals))
            }
        }
    }

    /// Whether a value could start here.
    pub(super) fn starts_operand(&self) -> bool {
        let token = self.peek();
        match token.kind {
            TokenKind::Name => {
                !matches!(self.word_of(token), "in" | "else" | "while") && !self.at_declaration()
            }
            TokenKind::Int
            | TokenKind::Float
            | TokenKind::Angle
            | TokenKind::Length
            | TokenKind::Color
            | TokenKind::Str
            | TokenKind::BadLiteral
            | TokenKind::ParenOpen
            | TokenKind::BracketOpen
            | TokenKind::BraceOpen
            | TokenKind::Minus
            | TokenKind::Not => true,
            _ => false,
        }
    }
}

fn closing_of(open: TokenKind) -> Option<TokenKind> {
    match open {
        TokenKind::ParenOpen => Some(TokenKind::ParenClose),
        TokenKind::BracketOpen => Some(TokenKind::BracketClose),
        TokenKind::BraceOpen => Some(TokenKind::BraceClose),
        _ => None,
    }
}

fn opening_of(close: TokenKind) -> Option<TokenKind> {
    match close {
        TokenKind::ParenClose => Some(TokenKind::ParenOpen),
        TokenKind::BracketClose => Some(TokenKind::BracketOpen),
        TokenKind::BraceClose => Some(TokenKind::BraceOpen),
        _ => None,
    }
}

fn bracket_text(kind: TokenKind) -> &'static str {
    match kind {
        TokenKind::ParenOpen => "(",
        TokenKind::ParenClose => ")",
        TokenKind::BracketOpen => "[",
        TokenKind::BracketClose => "]",
        TokenKind::BraceOpen => "{",
        TokenKind::BraceClose => "}",
        _ => "",
    }
}
