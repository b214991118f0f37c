//! What stands in braces: blocks with a value, the loop of a `let`, the entries of a material or a block of the scene.

use super::super::ast::*;
use super::super::lexer::{Token, TokenKind};
use super::super::words;
use super::Parser;
use super::recovery::ListOf;
use crate::diagnostic::Code;

const ENTRIES: ListOf = ListOf { plural: "entries", example: "an entry" };
const UPDATES: ListOf = ListOf { plural: "the new values", example: "a name with its new value" };

impl Parser<'_> {
    /// A block where one has to stand.
    pub(super) fn body(&mut self, what: &str, help: &str) -> Expr {
        if self.is(TokenKind::BraceOpen) {
            return self.block();
        }
        self.missing(&format!("`{{` before {what}"), help);
        if self.starts_operand() && !self.is_on_new_line() { self.value() } else { self.hole() }
    }

    /// `{ let a = 1; value }`.
    pub(super) fn block(&mut self) -> Expr {
        self.nested(Self::block_inside).unwrap_or_else(|| self.hole())
    }

    fn block_inside(&mut self) -> Expr {
        let open = self.bump();
        self.opens.push(TokenKind::BraceOpen);
        if self.is(TokenKind::Name) && self.next_is(TokenKind::Colon) && !self.is_word("let") {
            self.unexpected(
                "entries stand in a declaration, and a value is needed here",
                "write `material name { color: … }` outside, and `name` here; for a colour alone `swatch(#ff0000)`",
            );
            self.skip_to_brace();
            self.last_report = Some(self.at);
        }
        let mut lets = Vec::new();
        loop {
            let given = self.is(TokenKind::Name) && self.next_is(TokenKind::Equals) && !self.is_word("scene");
            if self.at_let() || self.at_typed() || given {
                self.block_let(&mut lets);
            } else if !self.statement(&lets) {
                break;
            }
        }
        let returned = self.is_word("return") && self.returns();
        if returned {
            self.unexpected("a block has no `return`", words::NO_RETURN);
            self.bump();
        }
        let value = if self.is(TokenKind::BraceClose) {
            self.unexpected(
                "a block ends with its value, found `}`",
                "write the value before the `}`, without `;`",
            );
            self.hole()
        } else {
            self.value()
        };
        let broken = self.is(TokenKind::Equals);
        if broken {
            self.unexpected(
                "a part of a value can't be given another value",
                "write `let` and a new name with the whole of it, as `let q2 = (1, q.y, q.z);`",
            );
            self.skip_to_brace();
        }
        if returned {
            self.eat(TokenKind::Semicolon);
        }
        if self.is(TokenKind::Semicolon) {
            self.unexpected_for("the value of a block has no `;` after it", "take the `;` out; only a `let` ends with one", "");
            self.bump();
        }
        self.close_block(open);
        self.opens.pop();
        let span = self.span_from(open.start);
        let whole = self.grow(span) && !broken;
        let kind = if whole { ExprKind::Block(lets, Box::new(value)) } else { ExprKind::Hole };
        Expr { kind, span }
    }

    /// Reads a `}`, and what can't stand before it.
    fn close_block(&mut self, open: Token) {
        if self.eat(TokenKind::BraceClose).is_some() {
            return;
        }
        if !self.is(TokenKind::End) && !self.at_declaration() {
            self.missing("`}`", "a block is `{ let a = 1; value }`: one value, at its end");
            self.skip_to_brace();
        }
        if self.eat(TokenKind::BraceClose).is_none() {
            self.unclosed(open);
        }
    }

    /// Goes to the `}` that closes the block at hand, or to where something else begins.
    fn skip_to_brace(&mut self) {
        while !matches!(self.peek().kind, TokenKind::BraceClose | TokenKind::End) && !self.at_declaration() {
            self.skip_balanced();
        }
    }

    /// Whether what is at hand stands before a value on its line.
    fn returns(&self) -> bool {
        let next = self.peek_next();
        let value = matches!(next.kind, TokenKind::Name | TokenKind::Int | TokenKind::Float);
        value && !self.text.get(self.peek().end as usize..next.start as usize).is_some_and(|between| between.contains('\n'))
    }

    /// Whether a name with its type before it is given a value here, as in other languages.
    fn at_typed(&self) -> bool {
        let word = self.word_of(self.peek());
        words::is_type(word) && !words::is_reserved(word) && self.next_is(TokenKind::Name) && self.token_at(self.at + 2).kind == TokenKind::Equals
    }

    /// A `let` in a block with the `;` after it.
    fn block_let(&mut self, lets: &mut Vec<Let>) {
        if self.at_typed() {
            let name = self.word_of(self.peek_next());
            self.unexpected(
                format!("`{name}` is given a type before its name"),
                format!("write `let {name} = …;`: its type is that of its value"),
            );
            self.bump();
        } else if !self.is_word("let") {
            let word = self.word_of(self.peek());
            self.unexpected(
                format!("`{word}` is given a value without `let`"),
                format!("write `let {word} = …;`: a name is given its value once"),
            );
        }
        lets.extend(self.let_declaration(true));
        if self.eat(TokenKind::Semicolon).is_some() {
            return;
        }
        if self.is(TokenKind::Comma) {
            self.unexpected("a `let` ends with `;`, found `,`", "write `;` in its place");
            self.bump();
        } else if !self.is(TokenKind::BraceClose) && !self.is(TokenKind::End) {
            let last = self.previous().unwrap_or(self.peek());
            if self.starts_operand() || self.is_word("let") {
                let span = self.span(last);
                self.report(
                    Code::Unexpected,
                    span,
                    "`;` is missing after this `let`",
                    "write `;` between a `let` and what follows it",
                );
            } else {
                self.missing("`;`", "a `let` in a block ends with `;`");
                while !matches!(
                    self.peek().kind,
                    TokenKind::Semicolon
                        | TokenKind::Comma
                        | TokenKind::BraceClose
                        | TokenKind::End
                ) && !self.is_word("let")
                    && !self.at_declaration()
                {
                    self.skip_balanced();
                }
                if !self.is(TokenKind::BraceClose) {
                    self.eat(TokenKind::Semicolon).or_else(|| self.eat(TokenKind::Comma));
                }
            }
        }
    }
    /// `let a = 1`, or `let q = p, s = 1 for i in 0..n while c { … }`. Several names without a loop are said to be wrong and
    /// answered as several.
    pub(super) fn let_declaration(&mut self, in_block: bool) -> Vec<Let> {
        let doc = self.doc_here();
        let start = self.peek().start;
        if self.is_word("let") || !in_block {
            self.bump();
        }
        let mut bindings = Vec::new();
        let mut second = None;
        loop {
            let name = self.declared_name("a value");
            if self.is(TokenKind::Colon) {
                self.unexpected(
                    "a `let` has no type",
                    "take the type out; it is that of the value",
                );
                self.type_after_colon();
            }
            let value = self.after_equals("`let a = 1`");
            bindings.extend(name.map(|name| (name, value)));
            let more = self.is(TokenKind::Comma)
                && self.next_is(TokenKind::Name)
                && self.token_at(self.at + 2).kind == TokenKind::Equals;
            if !more {
                break;
            }
            second.get_or_insert(self.at);
            self.bump();
        }
        let iterate = if self.is_word("for") { Some(Box::new(self.iterate())) } else { None };
        let span = self.span_from(start);
        if iterate.is_none()
            && let Some(at) = second
        {
            let span = self.span(self.token_at(at));
            let write = if in_block {
                "write `;` and another `let`"
            } else {
                "write another `let` in place of the comma"
            };
            self.report(
                Code::Unexpected,
                span,
                "several names after one `let` need a loop",
                format!(
                    "{write}, or the loop: `let a = 1, b = 2 for i in 0..n {{ a = b, b = a + b }}`"
                ),
            );
            return bindings
                .into_iter()
                .map(|binding| Let {
                    span,
                    bindings: vec![binding],
                    iterate: None,
                    doc: doc.clone(),
                })
                .collect();
        }
        if bindings.is_empty() {
            return Vec::new();
        }
        vec![Let { span, bindings, iterate, doc }]
    }

    pub(super) fn iterate(&mut self) -> Iterate {
        self.bump();
        if self.foreign_loop() {
            let index = Name { text: "".into(), span: self.span_from(self.end()) };
            return Iterate { index, source: self.hole(), condition: None, lets: Vec::new(), updates: Vec::new() };
        }
        let index = self.loop_index();
        let source = self.value_or_range();
        let condition = self.eat_word("while").map(|_| self.value());
        let mut lets = Vec::new();
        let mut updates = Vec::new();
        if self.is(TokenKind::BraceOpen) {
            let open = self.bump();
            self.opens.push(TokenKind::BraceOpen);
            while self.at_let() {
                self.block_let(&mut lets);
            }
            self.opens.pop();
            updates = self.list(open, TokenKind::BraceClose, &UPDATES, Self::update);
        } else {
            self.missing(
                "`{` before the new values",
                "write `let q = p for i in 0..n { q = 2 * q }`",
            );
        }
        Iterate { index, source, condition, lets, updates }
    }

    fn update(&mut self) -> Option<(Name, Expr)> {
        if self.at_let() {
            self.unexpected(
                "a `let` stands before the new values",
                "write `let a = 1;` right after the `{`",
            );
            let lets = self.let_declaration(true);
            self.stray_lets.extend(lets);
            return None;
        }
        if self.statement(&[]) {
            return None;
        }
        if !self.is(TokenKind::Name) {
            self.missing("a name with its new value", "write `q = 2 * q`");
            return None;
        }
        let token = self.bump();
        let name = self.name_of(token);
        if self.is(TokenKind::Colon) {
            self.unexpected(
                "a new value is written with `=`, found `:`",
                format!("write `{} = …`", name.text),
            );
            self.bump();
        } else if self.eat(TokenKind::Equals).is_none() {
            self.missing("`=`", format!("write `{} = …`, the value of the next turn", name.text));
            if !self.starts_operand() {
                return None;
            }
        }
        Some((name, self.value()))
    }

    /// `{ let …; key: value, … }`.
    pub(super) fn entries(&mut self, example: &str, with_lets: bool) -> (Vec<Let>, Vec<Entry>) {
        if !self.is(TokenKind::BraceOpen) {
            self.missing("`{`", format!("write it as in {example}"));
            return (Vec::new(), Vec::new());
        }
        let open = self.bump();
        let mut lets = Vec::new();
        if with_lets {
            self.opens.push(TokenKind::BraceOpen);
            while self.at_let() {
                self.block_let(&mut lets);
            }
            self.opens.pop();
        }
        let entries = self.list(open, TokenKind::BraceClose, &ENTRIES, Self::entry);
        lets.append(&mut self.stray_lets);
        (lets, entries)
    }

    pub(super) fn entry(&mut self) -> Option<Entry> {
        let token = self.peek();
        if self.at_let() {
            self.unexpected(
                "a `let` can't stand here",
                "in a material, `let`s stand before the first entry; elsewhere, before the block",
            );
            let lets = self.let_declaration(true);
            self.stray_lets.extend(lets);
            return None;
        }
        if token.kind != TokenKind::Name {
            self.missing("an entry", "an entry is written `key: value`");
            return None;
        }
        self.bump();
        let key = self.name_of(token);
        let help = format!("write `{}: …`", key.text);
        match self.peek().kind {
            TokenKind::Colon => {
                self.bump();
            }
            TokenKind::Equals => {
                self.unexpected("an entry is written with `:`, found `=`", help);
                self.bump();
            }
            _ => {
                self.missing("`:`", help);
                if !self.starts_operand() || self.is_on_new_line() {
                    return None;
                }
            }
        }
        if *key.text == *"unit" && self.is_word("in") {
            // Inches: a word of the language everywhere else.
            let word = self.bump();
            return Some(Entry { key, value: Expr { kind: ExprKind::Name("in".to_owned()), span: self.span(word) } });
        }
        Some(Entry { key, value: self.value_or_range() })
    }
}
