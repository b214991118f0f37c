//! What is written as in other languages: at the top of a file what is no declaration, within values what changes them and how one loops.

use super::super::ast::*;
use super::super::lexer::{Token, TokenKind};
use super::super::words;
use crate::diagnostic::Code;
use super::Parser;

/// What a light is called that is declared without its word.
const LIGHTS: [&str; 8] = ["sun", "moon", "lamp", "bulb", "spot", "spotlight", "point_light", "directional_light"];

/// What OpenSCAD writes before a shape.
const MOVES: [&str; 9] = ["translate", "rotate", "scale", "mirror", "resize", "color", "linear_extrude", "rotate_extrude", "offset"];

/// What it writes before a block of them, and ours.
const JOINS: [(&str, &str); 5] =
    [("union", "(a | b)"), ("difference", "(a - b)"), ("intersection", "(a & b)"), ("hull", "hull(a, b)"), ("minkowski", "a.round(0.1)")];

impl Parser<'_> {
    /// What stands at the top of the file and is no declaration: says what was probably meant, and reads it as that.
    pub(super) fn not_a_declaration(&mut self, loose: &mut Option<Item>) -> Option<ItemKind> {
        let token = self.peek();
        let start = token.start;
        let word = self.word_of(token);
        let next = self.peek_next().kind;
        if self.at > 0 && !self.is_on_new_line() && token.kind != TokenKind::Semicolon {
            let found = self.describe(token);
            let help = match token.kind {
                TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => {
                    format!("take the {found} out, or write its partner where it opens")
                }
                TokenKind::DotDot => {
                    "a range stands after `in`, and as a value in a block".to_string()
                }
                TokenKind::Equals if next == TokenKind::Greater => "a function is declared: `fn double(t: float) = 2 * t`".to_string(),
                TokenKind::Equals => "two values are compared with `==`".to_string(),
                TokenKind::Name if word == "and" => "what two shapes share is `a & b`; conditions are joined by `a && b`".to_string(),
                TokenKind::Name if word == "or" => "two shapes are joined by `a | b`; conditions by `a || b`".to_string(),
                TokenKind::Name if next == TokenKind::ParenOpen => {
                    "join shapes with `|`, `&` or `-`, numbers with `+`, `-`, `*` or `/`; what is done to a shape stands behind a dot, `box(1).round(0.1)`".to_string()
                }
                _ => "join shapes with `|`, `&` or `-`, numbers with `+`, `-`, `*` or `/`"
                    .to_string(),
            };
            self.unexpected(format!("the declaration ended before {found}"), help);
            self.skip_to_declaration();
            return None;
        }
        match token.kind {
            // As other languages end what stands for itself.
            TokenKind::Semicolon => {
                self.bump();
                return None;
            }
            TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => {
                let found = self.describe(token);
                self.unexpected(
                    format!("{found} closes nothing"),
                    "take it out, or write its partner where it opens",
                );
                self.bump();
                return None;
            }
            TokenKind::BadCharacter | TokenKind::BadLiteral => {
                self.bump();
                self.skip_to_declaration();
                return None;
            }
            TokenKind::Name => {}
            _ => {
                let found = self.describe(token);
                let help = match token.kind {
                    TokenKind::ParenOpen | TokenKind::BracketOpen => "what is drawn is written `scene = sphere(1) | box(1).translate(2, 0, 0)`".to_owned(),
                    _ => declaration_help(),
                };
                self.unexpected(format!("expected a declaration, found {found}"), help);
                self.skip_to_declaration();
                return None;
            }
        }
        let third = self.token_at(self.at + 2).kind;
        let meant = match word {
            "def" | "define" if next == TokenKind::Name && third == TokenKind::ParenOpen => Some("fn"),
            "const" | "var" | "val" | "def" | "define" if next == TokenKind::Name => Some("let"),
            "uniform" | "parameter" | "slider" if next == TokenKind::Name => Some("param"),
            "func" | "function" | "fun" if next == TokenKind::Name => Some("fn"),
            "include" | "use" if next == TokenKind::Str => Some("import"),
            _ if LIGHTS.contains(&word) && next == TokenKind::BraceOpen => {
                self.unexpected_for(format!("no declaration starts with `{word}`"), format!("write `light {word} {{ … }}`"), &format!("light {word}"));
                return self.declaration("light");
            }
            _ => words::nearest(word, words::DECLARATIONS.iter().copied()).filter(|near| {
                matches!(next, TokenKind::Name | TokenKind::Str | TokenKind::BraceOpen)
                    || next == TokenKind::Equals && *near == "scene"
            }),
        };
        if let Some(meant) = meant {
            let name = self.word_of(self.token_at(self.at + 2));
            let typed = third == TokenKind::Name && words::is_type(self.word_of(self.peek_next()));
            let help = if typed { format!("write `{meant} {name} = …`") } else { format!("write `{meant}`") };
            match typed {
                true => self.unexpected(format!("no declaration starts with `{word}`"), help),
                false => self.unexpected_for(format!("no declaration starts with `{word}`"), help, meant),
            }
            // Its type stands between the word and the name.
            if typed {
                self.bump();
            }
            return self.declaration(meant);
        }
        if word == "module" && next == TokenKind::Name && third == TokenKind::ParenOpen {
            let name = self.word_of(self.peek_next());
            self.unexpected("no declaration starts with `module`", format!("write `shape {name}(…) = …`"));
            self.bump();
            // What calls it is right.
            let token = self.bump();
            let (name, parameters) = (self.name_of(token), self.parameters());
            let body = Expr { kind: ExprKind::Hole, span: name.span };
            self.skip_to_declaration();
            return Some(ItemKind::Function(Function { kind: FunctionKind::Shape, name, parameters, claim: None, body }));
        }
        if words::is_type(word) && next == TokenKind::Name && third == TokenKind::ParenOpen
        {
            let help = "write `fn name(a: float) = …` for numbers, `field name(a: float) = …` for a formula in `p`";
            self.unexpected(format!("a function does not start with its type `{word}`"), help);
            self.skip_to_declaration();
            return None;
        }
        if words::is_type(word) && next == TokenKind::Name && third == TokenKind::Equals {
            self.unexpected(
                format!("a value does not start with its type `{word}`"),
                "write `let` in its place",
            );
            return self.declaration("let");
        }
        match next {
            TokenKind::Equals => {
                self.unexpected(
                    format!("`{word}` is given a value without a word that says what it is"),
                    format!("write `let {word} = …` for a value, `shape {word} = …` for a shape"),
                );
                let name = self.declared_name("a value")?;
                let value = self.after_equals("`let a = 1`");
                let span = self.span_from(start);
                Some(ItemKind::Let(Let {
                    span,
                    bindings: vec![(name, value)],
                    iterate: None,
                    doc: None,
                }))
            }
            _ if matches!(next, TokenKind::ParenOpen | TokenKind::Dot) || matches!(word, "for" | "if") => {
                let span = self.span(token);
                let value = self.value();
                let moves_next = matches!(self.peek().kind, TokenKind::Name | TokenKind::BraceOpen) && !self.is_on_new_line();
                let help = match moves_next {
                    true => "what is moved or joined stands first: `scene = sphere(1).translate(1, 2, 3)`, `scene = box(2) - sphere(1.2)`".to_owned(),
                    false => format!("write `scene = {word}…` to draw it, `shape name = {word}…` to name it"),
                };
                self.report(Code::Unexpected, span, "a value stands here by itself", help);
                if moves_next {
                    self.skip_to_declaration();
                    return None;
                }
                loose.get_or_insert(Item {
                    kind: ItemKind::Scene(value),
                    span: self.span_from(start),
                    doc: None,
                });
                None
            }
            _ => {
                let help = match word {
                    "sky" | "background" => "write `environment { sky: #87a7d0 }`".to_owned(),
                    _ => declaration_help(),
                };
                self.unexpected(format!("no declaration starts with `{word}`"), help);
                self.bump();
                // After its block another may stand that is none either.
                if self.is(TokenKind::BraceOpen) {
                    self.skip_balanced();
                }
                if !self.is_on_new_line() {
                    self.skip_to_declaration();
                }
                None
            }
        }
    }

    /// `a |> f` or `a >> f`, with the last sign at hand: says what to write, and skips what follows.
    pub(super) fn handed_on(&mut self) {
        self.unexpected("a shape is handed on by a dot", "write `sphere(1).translate(1, 2, 3)`");
        self.skip_to_declaration();
    }

    /// `d += 1`, with the `=` at hand: says what to write, and skips it.
    pub(super) fn changed_value(&mut self, operator: Token) {
        let operator = operator.text(self.text);
        let turned = self.at.checked_sub(3).map(|i| (self.token_at(i), self.token_at(i + 1)));
        let axis = turned.filter(|(dot, _)| dot.kind == TokenKind::Dot && operator == "*").and_then(|(_, part)| match self.word_of(part) {
            "yz" | "zy" => Some('x'),
            "xz" | "zx" => Some('y'),
            "xy" | "yx" => Some('z'),
            _ => None,
        });
        let point = self.at.checked_sub(4).map_or("", |i| self.word_of(self.token_at(i)));
        let (before, named) = (self.at.checked_sub(3).map(|i| self.token_at(i)), self.at.checked_sub(2).map_or("", |i| self.word_of(self.token_at(i))));
        let is_part = before.is_some_and(|dot| dot.kind == TokenKind::Dot);
        let name = if named.is_empty() { "d" } else { named };
        let component = match named {
            "x" | "r" => Some("(1, 0, 0)"),
            "y" | "g" => Some("(0, 1, 0)"),
            "z" | "b" => Some("(0, 0, 1)"),
            _ => None,
        };
        let help = match axis {
            None if is_part && !point.is_empty() => match component.filter(|_| matches!(operator, "+" | "-")) {
                Some(unit) => format!("a component is not changed by itself: write `let {point}2 = {point} {operator} … * {unit};`, and `{point}2` from there on"),
                None => format!("a component is not changed by itself: write all of them, `let {point}2 = ({point}.x, {point}.y {operator} …, {point}.z);`, and `{point}2` from there on"),
            },
            Some(axis) => format!("a turn makes a new point: write `let {point}2 = rotate({point}, {axis}, 0.5);`, and `{point}2` from there on"),
            None => format!("a name is given its value once: write `let {name}2 = {name} {operator} …;`, and `{name}2` from there on"),
        };
        self.unexpected(format!("`{operator}=` changes a value, and none can be changed"), help);
        self.bump();
        self.value();
        self.eat(TokenKind::Semicolon);
        self.last_report = Some(self.at);
    }

    /// A loop or a choice that stands by itself and gives names new values, as statements of other languages do: says how it is written, and skips it.
    pub(super) fn statement(&mut self, lets: &[Let]) -> bool {
        let start = self.peek();
        let word = self.word_of(start).to_owned();
        if !matches!(word.as_str(), "while" | "for" | "if") || word == "for" && self.next_is(TokenKind::ParenOpen) {
            return false;
        }
        let ends = |kind| matches!(kind, TokenKind::BraceClose | TokenKind::Semicolon | TokenKind::End);
        let Some(open) = (self.at + 1..).find(|&at| ends(self.token_at(at).kind) || self.token_at(at).kind == TokenKind::BraceOpen) else { return false };
        if self.token_at(open).kind != TokenKind::BraceOpen {
            return false;
        }
        // A name with a new value begins the body, or stands after a `;` of the body itself.
        let (mut depth, mut given) = (0usize, None);
        for at in open + 1.. {
            match self.token_at(at).kind {
                TokenKind::End => break,
                TokenKind::BraceClose if depth == 0 => break,
                TokenKind::BraceOpen | TokenKind::ParenOpen | TokenKind::BracketOpen => depth += 1,
                TokenKind::BraceClose | TokenKind::ParenClose | TokenKind::BracketClose => depth = depth.saturating_sub(1),
                TokenKind::Name
                    if depth == 0
                        && self.token_at(at + 1).kind == TokenKind::Equals
                        && (at == open + 1 || self.token_at(at - 1).kind == TokenKind::Semicolon) =>
                {
                    given = Some(at);
                    break;
                }
                _ => {}
            }
        }
        let Some(given) = given else { return false };
        let name = self.word_of(self.token_at(given)).to_owned();
        let text = |from: u32, to: u32| self.text.get(from as usize..to as usize).unwrap_or_default().trim();
        let head = text(start.start, self.token_at(open).start);
        let first = lets.iter().rev().flat_map(|l| &l.bindings).find(|(known, _)| *known.text == name);
        let first = first.map_or("…", |(_, value)| text(value.span.start, value.span.end));
        let (message, help) = match word.as_str() {
            "if" => ("a choice stands by itself, and it is a value".to_owned(), format!("write what is chosen: `{name} = {head} {{ … }} else {{ {name} }}`")),
            _ => {
                let head = if word == "for" { head.to_owned() } else { format!("for i in 0..100 {head}") };
                let help = format!("write `let {name} = {first} {head} {{ {name} = … }};`: a loop belongs to the `let` of what it changes");
                (format!("a loop stands by itself, and `{name}` is given its value once"), help)
            }
        };
        self.unexpected(message, help);
        while self.at < open {
            self.bump();
        }
        self.skip_balanced();
        while word == "if" && self.is_word("else") {
            while !matches!(self.peek().kind, TokenKind::BraceOpen | TokenKind::BraceClose | TokenKind::End) {
                self.bump();
            }
            if self.is(TokenKind::BraceOpen) {
                self.skip_balanced();
            }
        }
        if self.is(TokenKind::Semicolon) || self.is(TokenKind::Comma) {
            self.bump();
        }
        true
    }

    /// `step 2` after a range: says how it is written, and skips it.
    pub(super) fn foreign_steps(&mut self, index: &Name) {
        let is_step = self.is(TokenKind::DotDot) || self.is_word("step") && !self.next_is(TokenKind::BraceOpen);
        if !is_step {
            return;
        }
        let i = &index.text;
        self.unexpected("a range goes by whole steps of 1", format!("multiply where it counts: `for {i} in 0..5 {{ … }}`, and `2 * {i}` within"));
        while !matches!(self.peek().kind, TokenKind::BraceOpen | TokenKind::End) && !self.is_on_new_line() {
            self.bump();
        }
    }

    /// `then` in the place of a brace: says so once in a text, and skips it. Answers whether it stands there.
    pub(super) fn foreign_then(&mut self, help: &str) -> bool {
        if !self.is_word("then") {
            return false;
        }
        if !std::mem::replace(&mut self.said_then, true) {
            self.missing("`{` before the value of an `if`", help);
        }
        self.bump();
        true
    }

    /// What stands in parentheses after `for`, as in other languages: says how it is written, and skips it with its body.
    pub(super) fn foreign_loop(&mut self) -> bool {
        if !self.is(TokenKind::ParenOpen) {
            return false;
        }
        self.unexpected("a `for` goes over a range, without parentheses", "write `for i in 0..n { … }`");
        self.skip_balanced();
        if self.is(TokenKind::BraceOpen) {
            self.skip_balanced();
        }
        self.last_report = Some(self.at);
        true
    }

    /// Whether what is called stands before the shape that it moves or joins, as OpenSCAD has it: `translate([1, 2, 3]) sphere(1)`.
    pub(super) fn is_before_its_shape(&self, name: &str) -> bool {
        let is_call = self.is(TokenKind::Name) && self.peek_next().kind == TokenKind::ParenOpen;
        !self.is_on_new_line() && (is_call && MOVES.contains(&name) || self.is(TokenKind::BraceOpen) && (MOVES.contains(&name) || JOINS.iter().any(|j| j.0 == name)))
    }

    /// Says how it is written here, and reads it as nothing.
    pub(super) fn before_its_shape(&mut self, start: u32) -> Expr {
        let mut calls = vec![self.call_since(start)];
        let span = self.span_from(start);
        let mut joined = self.is(TokenKind::BraceOpen);
        while !joined && self.is(TokenKind::Name) && self.peek_next().kind == TokenKind::ParenOpen && !self.is_on_new_line() {
            let from = self.bump().start;
            self.arguments();
            calls.push(self.call_since(from));
            joined = self.is(TokenKind::BraceOpen) && !self.is_on_new_line();
        }
        // A block holds what is joined.
        let mut depth = 0;
        while joined && !self.is(TokenKind::End) {
            match self.bump().kind {
                TokenKind::BraceOpen => depth += 1,
                TokenKind::BraceClose => depth -= 1,
                _ => {}
            }
            joined = depth > 0;
        }
        let last = calls.pop().unwrap_or_default();
        let shape = match JOINS.iter().find(|(name, _)| *name == last.0) {
            Some((_, shape)) => (*shape).to_owned(),
            None if MOVES.contains(&last.0.as_str()) => format!("shape.{}", moved(&last)),
            None => {
                let ours = match last.0.as_str() {
                    "cube" => "box",
                    "square" => "rectangle",
                    same => same,
                };
                format!("{ours}({})", last.1.replace('[', "(").replace(']', ")"))
            }
        };
        let written: String = calls.iter().rev().map(|call| format!(".{}", moved(call))).collect();
        let is_alone = self.text.get(..start as usize).is_none_or(|before| before.is_empty() || before.ends_with('\n'));
        let help = format!("write `{}{shape}{written}`", if is_alone { "scene = " } else { "" });
        // What is wrong within it is written anew.
        self.diagnostics.retain(|d| d.span.start < start);
        self.report(Code::Unexpected, span, "what is moved or joined stands first, and what is done to it behind a dot", help);
        Expr { kind: ExprKind::Hole, span: self.span_from(start) }
    }

    /// The name and what is given in a call that has just been read.
    fn call_since(&self, start: u32) -> (String, String) {
        let text = self.text.get(start as usize..self.end() as usize).unwrap_or("");
        let (name, given) = text.split_once('(').unwrap_or((text, ""));
        (name.trim().to_owned(), given.strip_suffix(')').unwrap_or(given).trim().to_owned())
    }
}

fn declaration_help() -> String {
    format!("a declaration starts with {}", words::DECLARATIONS.join(", "))
}

/// A call of OpenSCAD's as one of ours, which stands behind a dot.
fn moved((name, given): &(String, String)) -> String {
    let numbers = given.trim_matches(['[', ']']);
    match name.as_str() {
        "rotate" => match numbers.split(',').map(str::trim).collect::<Vec<_>>()[..] {
            [angle, "0", "0"] => format!("rotate(x, {angle}deg)"),
            ["0", angle, "0"] => format!("rotate(y, {angle}deg)"),
            ["0", "0", angle] | [angle] => format!("rotate(z, {angle}deg)"),
            _ => "rotate(y, 45deg)".to_owned(),
        },
        "scale" if given.starts_with('[') => format!("stretch({numbers})"),
        "resize" => "stretch(1, 2, 1)".to_owned(),
        "color" => "material(swatch(#ff0000))".to_owned(),
        "linear_extrude" => {
            let height = given.split(',').next().and_then(|first| first.rsplit('=').next()).map(str::trim).filter(|height| !height.is_empty());
            format!("extrude({})", height.unwrap_or("1"))
        }
        "rotate_extrude" => "revolve()".to_owned(),
        _ => format!("{name}({numbers})"),
    }
}
