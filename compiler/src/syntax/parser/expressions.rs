//! Expressions: operators from the left by their level, then calls, dots and indices, then what stands by itself.

use super::super::ast::*;
use super::super::lexer::{Token, TokenKind};
use super::super::literals::{Number, read_color, read_number, read_string};
use super::super::words;
use super::Parser;
use super::recovery::ListOf;
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::unit::Unit;

const ARGUMENTS: ListOf = ListOf { plural: "arguments", example: "an argument" };
const COMPONENTS: ListOf = ListOf { plural: "the components of a vector", example: "a number" };
const ITEMS: ListOf = ListOf { plural: "the items of a list", example: "a value" };

/// Operators of one level whose right side is not finished yet.
struct Pending {
    level: u8,
    first: Expr,
    rest: Vec<(BinaryOp, Span, Expr)>,
    operator: (BinaryOp, Span),
    height: usize,
}

impl Parser<'_> {
    /// A value where no range may stand.
    pub(super) fn value(&mut self) -> Expr {
        let value = self.expr();
        if !self.is(TokenKind::DotDot) {
            return value;
        }
        let span = self.span(self.peek());
        self.report(
            Code::Unexpected,
            span,
            "a range can't stand here",
            "a range stands after `in`, and as a value in a block: `for i in 0..n`, `radius: 0.02..0.06`",
        );
        self.bump();
        if self.starts_operand() {
            self.expr();
        }
        Expr { kind: ExprKind::Hole, span: self.span_from(value.span.start) }
    }

    /// A value or a range of values.
    pub(super) fn value_or_range(&mut self) -> Expr {
        let outside = std::mem::take(&mut self.height);
        let from = self.expr();
        let mut value = from;
        if self.eat(TokenKind::DotDot).is_some() {
            if self.is(TokenKind::Equals) {
                self.unexpected_for(
                    "a range is written `a..b`",
                    "take the `=` out; both ends belong to a parameter's range, and a `for` leaves out the end",
                    "",
                );
                self.bump();
            }
            let to = self.expr();
            let span = value.span.to(to.span);
            let kind = if self.grow(span) {
                ExprKind::Range(Box::new(value), Box::new(to))
            } else {
                ExprKind::Hole
            };
            value = Expr { kind, span };
        }
        self.height = outside.max(self.height);
        value
    }

    pub(super) fn hole(&self) -> Expr {
        let at = self.end();
        Expr { kind: ExprKind::Hole, span: Span { file: self.file, start: at, end: at } }
    }

    /// A value without a range.
    fn expr(&mut self) -> Expr {
        self.nested(Self::operators).unwrap_or_else(|| self.hole())
    }

    /// Operands and the operators between them. A stack holds what waits for its right side, so that neither a long chain
    /// nor a change of level needs recursion.
    fn operators(&mut self) -> Expr {
        let mut waiting: Vec<Pending> = Vec::new();
        let mut current = self.operand();
        loop {
            while self.is(TokenKind::BadCharacter) {
                current = self.unknown_operator(&current);
            }
            let token = self.peek();
            let Some((operator, level)) = binary(token.kind) else { break };
            current = self.close_tighter(&mut waiting, current, level + 1);
            let place = (operator, self.span(token));
            match waiting.last_mut() {
                Some(top) if top.level == level => {
                    let done = std::mem::replace(&mut top.operator, place);
                    top.rest.push((done.0, done.1, current));
                    top.height = top.height.max(self.height);
                }
                _ => waiting.push(Pending {
                    level,
                    first: current,
                    rest: Vec::new(),
                    operator: place,
                    height: self.height,
                }),
            }
            self.height = 0;
            self.bump();
            current = self.operand();
        }
        self.close_tighter(&mut waiting, current, 0)
    }

    /// Makes chains of all that waits at `level` or tighter.
    fn close_tighter(&mut self, waiting: &mut Vec<Pending>, mut current: Expr, level: u8) -> Expr {
        while let Some(mut top) = waiting.pop_if(|top| top.level >= level) {
            let span = top.first.span.to(current.span);
            top.rest.push((top.operator.0, top.operator.1, current));
            self.height = self.height.max(top.height);
            let kind = if self.grow(span) {
                ExprKind::Chain(Box::new(top.first), top.rest)
            } else {
                ExprKind::Hole
            };
            current = Expr { kind, span };
        }
        current
    }

    /// A character that the language does not use, where an operator could stand: what follows it is read and forgotten.
    fn unknown_operator(&mut self, left: &Expr) -> Expr {
        self.bump();
        for _ in 0..2 {
            if self.starts_operand() && !self.is_on_new_line() {
                self.operand();
            }
            // `a ? b : c`
            if self.eat(TokenKind::Colon).is_none() {
                break;
            }
        }
        self.last_report = Some(self.at);
        self.height = 0;
        Expr { kind: ExprKind::Hole, span: self.span_from(left.span.start) }
    }

    /// Signs, then a value with its calls, dots and indices.
    fn operand(&mut self) -> Expr {
        let outside = std::mem::take(&mut self.height);
        let mut signs: Vec<(UnaryOp, Token)> = Vec::new();
        loop {
            match self.peek().kind {
                TokenKind::Minus => signs.push((UnaryOp::Neg, self.bump())),
                TokenKind::Not => signs.push((UnaryOp::Not, self.bump())),
                TokenKind::Plus => {
                    self.unexpected_for("a value has no `+` before it", "take the `+` out", "");
                    self.bump();
                }
                TokenKind::BadCharacter => {
                    self.bump();
                    self.last_report = Some(self.at);
                }
                _ => break,
            }
        }
        let mut value = self.postfix();
        while let Some((operator, token)) = signs.pop() {
            let span = self.span(token).to(value.span);
            let kind = if self.grow(span) {
                ExprKind::Unary(operator, Box::new(value))
            } else {
                ExprKind::Hole
            };
            value = Expr { kind, span };
        }
        self.height = outside.max(self.height);
        value
    }

    fn postfix(&mut self) -> Expr {
        let mut value = self.primary();
        loop {
            let token = self.peek();
            let start = value.span.start;
            let kind = match token.kind {
                TokenKind::Dot => {
                    self.bump();
                    self.after_dot(value)
                }
                // What stands behind a number is something else: the range that lacks its `in`, an operand that lacks its operator.
                TokenKind::ParenOpen | TokenKind::BracketOpen if is_literal(&value) => {
                    return value;
                }
                TokenKind::ParenOpen => {
                    let callable = matches!(value.kind, ExprKind::Name(_) | ExprKind::Hole);
                    if !callable {
                        self.unexpected(
                            "only a name can be called",
                            "write an operator before the bracket, or a name",
                        );
                    }
                    let arguments = self.arguments();
                    if let ExprKind::Name(name) = &value.kind
                        && self.is_before_its_shape(name)
                    {
                        return self.before_its_shape(start);
                    }
                    match callable {
                        true => ExprKind::Call(Box::new(value), arguments),
                        false => ExprKind::Hole,
                    }
                }
                TokenKind::BracketOpen => {
                    let index = self.index();
                    ExprKind::Index(Box::new(value), Box::new(index))
                }
                // `v.0`, `1.5.2`: said already.
                TokenKind::BadLiteral if token.start == self.end() => {
                    self.bump();
                    ExprKind::Hole
                }
                _ => return value,
            };
            value = Expr { kind, span: self.span_from(start) };
            if !self.grow(value.span) {
                value.kind = ExprKind::Hole;
            }
        }
    }

    fn after_dot(&mut self, receiver: Expr) -> ExprKind {
        if !self.is(TokenKind::Name) || self.is_on_new_line() && self.at_declaration() {
            self.missing("a name", "after a dot stands a component, as in `p.x`, or a call, as in `s.translate(1, 0, 0)`");
            return ExprKind::Hole;
        }
        let token = self.bump();
        let name = self.name_of(token);
        let arguments = self.is(TokenKind::ParenOpen).then(|| self.arguments());
        ExprKind::Dot(Box::new(receiver), name, arguments)
    }

    pub(super) fn index(&mut self) -> Expr {
        let open = self.bump();
        let span = self.span(open);
        let mut items = self.list(open, TokenKind::BracketClose, &ITEMS, |p| Some(p.value()));
        match items.len() {
            1 => items.pop().unwrap_or_else(|| self.hole()),
            _ => {
                let span = span.to(self.span_from(open.start));
                self.report(Code::Unexpected, span, "an index is one number", "write `list[i]`");
                Expr { kind: ExprKind::Hole, span }
            }
        }
    }

    /// `(a, name: b)`.
    pub(super) fn arguments(&mut self) -> Vec<Argument> {
        let open = self.bump();
        self.list(open, TokenKind::ParenClose, &ARGUMENTS, Self::argument)
    }

    fn argument(&mut self) -> Option<Argument> {
        let mut name = None;
        if self.is(TokenKind::Name) {
            if self.next_is(TokenKind::Colon) {
                let token = self.bump();
                name = Some(self.name_of(token));
                self.bump();
            } else if self.next_is(TokenKind::Equals) && !self.at_declaration() {
                let token = self.bump();
                let written = self.name_of(token);
                let help = format!("write `{}: …`", written.text);
                let equals = self.span(self.peek());
                let said = Diagnostic::new(Code::Unexpected, written.span, "a named argument is written with `:`, found `=`", help);
                self.say(said.write(written.span.to(equals), format!("{}:", written.text)));
                name = Some(written);
                self.bump();
            }
        }
        Some(Argument { name, value: self.value() })
    }

    fn primary(&mut self) -> Expr {
        let token = self.peek();
        let kind = match token.kind {
            TokenKind::Int | TokenKind::Float | TokenKind::Angle | TokenKind::Length => self.number(),
            TokenKind::Color => {
                self.bump();
                read_color(token.text(self.text)).map_or(ExprKind::Hole, ExprKind::Color)
            }
            TokenKind::Str => {
                self.bump();
                read_string(token.text(self.text)).map_or(ExprKind::Hole, ExprKind::Str)
            }
            TokenKind::BadLiteral => {
                self.bump();
                ExprKind::Hole
            }
            TokenKind::ParenOpen => self.parentheses(),
            TokenKind::BracketOpen => {
                self.bump();
                let items = self.list(token, TokenKind::BracketClose, &ITEMS, |p| Some(p.item()));
                ExprKind::List(items)
            }
            TokenKind::BraceOpen => return self.block(),
            TokenKind::Name => return self.word(token),
            _ => {
                let operator = self.previous().filter(|last| last.end == token.start && binary(last.kind).is_some());
                match (operator, token.kind) {
                    (Some(operator), TokenKind::Equals) => self.changed_value(operator),
                    (Some(operator), TokenKind::Star) if operator.kind == TokenKind::Star => {
                        self.unexpected("a power is a function", "write `pow(a, b)`; `sq(a)` and `cubed(a)` are the second and third");
                        self.bump();
                        self.value();
                    }
                    (Some(operator), TokenKind::Greater) if matches!(operator.text(self.text), "|" | ">") => self.handed_on(),
                    _ => self.missing("a value", "write a number, a name, a call, or something in brackets"),
                }
                return self.hole();
            }
        };
        let kind = if self.grow(self.span(token)) { kind } else { ExprKind::Hole };
        Expr { kind, span: self.span_from(token.start) }
    }

    pub(super) fn number(&mut self) -> ExprKind {
        let token = self.bump();
        let number = read_number(token.text(self.text));
        let word = self.word_of(self.peek());
        let unit = match word {
            "deg" => Some(AngleUnit::Deg),
            "turn" => Some(AngleUnit::Turn),
            "rad" => Some(AngleUnit::Rad),
            _ => None,
        };
        // `in` stands before a range.
        let length = Unit::named(word).filter(|unit| *unit != Unit::In);
        match (number, unit) {
            (Ok(Number::Int(_) | Number::Float(_)), None) if let Some(unit) = length && !self.is_on_new_line() => {
                self.apart(token, word);
                ExprKind::Length(token.text(self.text).parse().unwrap_or(0.0), unit)
            }
            (Ok(Number::Int(_) | Number::Float(_)), Some(unit)) if !self.is_on_new_line() => {
                self.apart(token, word);
                ExprKind::Angle(token.text(self.text).parse().unwrap_or(0.0), unit)
            }
            (Ok(Number::Int(value)), _) => ExprKind::Int(value),
            (Ok(Number::Float(value)), _) => ExprKind::Float(value),
            (Ok(Number::Angle(value, unit)), _) => ExprKind::Angle(value, unit),
            (Ok(Number::Length(value, unit)), _) => ExprKind::Length(value, unit),
            (Err(_), _) => ExprKind::Hole,
        }
    }

    /// A unit with a space before it.
    fn apart(&mut self, number: Token, unit: &str) {
        let (span, written) = (self.span(self.peek()), format!("{}{unit}", number.text(self.text)));
        let said = Diagnostic::new(Code::Unexpected, span, "a unit stands right after its number", format!("write `{written}`"));
        self.say(said.write(self.span(number).to(span), written));
        self.bump();
    }

    /// An item of a list. In other languages a `for` may follow on it.
    fn item(&mut self) -> Expr {
        let item = self.value();
        let token = self.peek();
        if !self.is_word("for") || self.is_on_new_line() {
            return item;
        }
        self.bump();
        let index = self.loop_index();
        let source = self.value_or_range();
        let text = |span: Span| self.text.get(span.range()).unwrap_or("…");
        let help = format!("write `for {} in {} {{ {} }}`", index.text, text(source.span), text(item.span));
        let span = self.span(token);
        self.report(Code::Unexpected, span, "the `for` stands first, and what it makes in braces", help);
        let span = item.span.to(source.span);
        let kind = if self.grow(span) { ExprKind::For(Box::new(For { index, source, by: None, body: item })) } else { ExprKind::Hole };
        Expr { kind, span }
    }

    fn parentheses(&mut self) -> ExprKind {
        let open = self.bump();
        let mut items = self.list(open, TokenKind::ParenClose, &COMPONENTS, |p| Some(p.value()));
        match items.len() {
            1 => items.pop().map_or(ExprKind::Hole, |value| ExprKind::Paren(Box::new(value))),
            2..=4 => ExprKind::Vector(items),
            count => {
                let span = self.span_from(open.start);
                let message = match count {
                    0 => "there is nothing between these brackets".to_string(),
                    _ => format!("a vector has two to four components, not {count}"),
                };
                self.report(
                    Code::Unexpected,
                    span,
                    message,
                    "write `(a, b, c)` for a vector, `[a, b, c]` for a list",
                );
                ExprKind::Hole
            }
        }
    }

    pub(super) fn word(&mut self, token: Token) -> Expr {
        let word = token.text(self.text);
        let kind = match word {
            "true" | "false" => {
                self.bump();
                ExprKind::Bool(word == "true")
            }
            "for" => return self.nested(Self::repetition).unwrap_or_else(|| self.hole()),
            "if" => return self.nested(Self::choice).unwrap_or_else(|| self.hole()),
            _ if self.at_declaration() && self.is_on_new_line() => {
                self.missing("a value", "write a number, a name, a call, or something in brackets");
                return self.hole();
            }
            "let" => {
                self.unexpected(
                    "a `let` can't stand within a value",
                    "open a block: `{ let a = 1; a + 2 }`",
                );
                self.bump();
                self.skip_nested();
                ExprKind::Hole
            }
            "in" | "else" | "while" => {
                self.missing("a value", format!("before `{word}` a value is missing"));
                return self.hole();
            }
            _ if words::is_reserved(word) => {
                let help = match word {
                    "scene" => {
                        "what `scene` is made of can be named with `shape` and used by that name"
                            .to_string()
                    }
                    _ => format!(
                        "it starts a declaration; call the value something else than `{word}`"
                    ),
                };
                if !self.misnamed.contains(&word) {
                    self.unexpected(format!("the word `{word}` can't be the name of a value"), help);
                }
                self.bump();
                ExprKind::Hole
            }
            _ => {
                self.bump();
                ExprKind::Name(word.to_string())
            }
        };
        self.grow(self.span(token));
        Expr { kind, span: self.span(token) }
    }

    /// `for index in source by fold { body }`.
    fn repetition(&mut self) -> Expr {
        let start = self.bump().start;
        if self.foreign_loop() {
            return Expr { kind: ExprKind::Hole, span: self.span_from(start) };
        }
        let index = self.loop_index();
        let source = self.value_or_range();
        self.foreign_steps(&index);
        let by = self.is_word("by").then(|| self.fold());
        let body = self.body("the body of a `for`", "write `for i in 0..n { … }`");
        let span = self.span_from(start);
        let kind = ExprKind::For(Box::new(For { index, source, by, body }));
        let kind = if self.grow(span) { kind } else { ExprKind::Hole };
        Expr { kind, span }
    }

    /// `index in`, after `for`.
    pub(super) fn loop_index(&mut self) -> Name {
        let token = self.peek();
        let index = if token.kind == TokenKind::Name && !self.is_word("in") {
            if words::is_reserved(self.word_of(token)) {
                let message =
                    format!("the word `{}` can't be the name of a value", token.text(self.text));
                self.unexpected(message, "write another name: `for i in 0..n { … }`");
            }
            self.bump();
            self.name_of(token)
        } else {
            self.missing("a name", "write `for i in 0..n { … }`");
            Name { text: "".into(), span: self.span_from(self.end()) }
        };
        if self.eat_word("in").is_none() {
            self.missing("`in`", "write `for i in 0..n { … }`");
            if self.is(TokenKind::Equals) || self.is(TokenKind::Colon) {
                self.bump();
            }
        }
        index
    }

    fn fold(&mut self) -> Fold {
        let start = self.bump().start;
        let token = self.peek();
        let kind = match token.kind {
            TokenKind::Plus | TokenKind::Star => {
                self.bump();
                FoldKind::Operator(if token.kind == TokenKind::Plus {
                    BinaryOp::Add
                } else {
                    BinaryOp::Mul
                })
            }
            TokenKind::Name => {
                self.bump();
                let mut callee = Expr {
                    kind: ExprKind::Name(token.text(self.text).to_string()),
                    span: self.span(token),
                };
                if self.eat(TokenKind::Dot).is_some() {
                    if let Some(member) = self.eat(TokenKind::Name) {
                        let name = self.name_of(member);
                        let span = callee.span.to(name.span);
                        callee = Expr { kind: ExprKind::Dot(Box::new(callee), name, None), span };
                    } else {
                        self.missing("a name", "write `by smooth_union(0.1)`");
                    }
                }
                let arguments =
                    if self.is(TokenKind::ParenOpen) { self.arguments() } else { Vec::new() };
                FoldKind::Call(callee, arguments)
            }
            kind => {
                let help = match kind {
                    TokenKind::Or => {
                        "without `by` the bodies are united; write `by union` to say so"
                    }
                    TokenKind::And => "write `by intersection`",
                    TokenKind::Minus => "write `by difference`",
                    _ => "write `by smooth_union(0.1)`, `by min`, `by max`, `by +` or `by *`",
                };
                self.missing("a way to join the bodies", help);
                if binary(kind).is_some() {
                    self.bump();
                }
                FoldKind::Call(self.hole(), Vec::new())
            }
        };
        Fold { span: self.span_from(start), kind }
    }

    /// `if condition { a } else { b }`.
    fn choice(&mut self) -> Expr {
        let start = self.bump().start;
        let mut condition = self.value();
        if self.is(TokenKind::Equals) {
            self.unexpected_for("`=` declares, found where a condition goes on", "two values are compared with `==`", "==");
            self.bump();
            self.value();
            condition.kind = ExprKind::Hole;
        }
        let help = "write `if condition { a } else { b }`";
        let words = self.foreign_then(help);
        let bare = !words && !self.is(TokenKind::BraceOpen);
        let then = if words { self.value() } else { self.body("the value of an `if`", help) };
        let mut otherwise = None;
        if self.eat_word("else").is_some() {
            let value = if self.is_word("if") {
                self.nested(Self::choice).unwrap_or_else(|| self.hole())
            } else if words && !self.is(TokenKind::BraceOpen) {
                self.value()
            } else {
                // Said of its `if` already.
                if bare {
                    self.last_report = Some(self.at);
                }
                self.body("the value of an `else`", help)
            };
            otherwise = Some(Box::new(value));
        }
        let span = self.span_from(start);
        let kind = ExprKind::If(Box::new(condition), Box::new(then), otherwise);
        let kind = if self.grow(span) { kind } else { ExprKind::Hole };
        Expr { kind, span }
    }
}

fn is_literal(value: &Expr) -> bool {
    use ExprKind::{Angle, Bool, Color, Float, Int, Length, Str};
    matches!(value.kind, Bool(_) | Int(_) | Float(_) | Angle(..) | Length(..) | Color(_) | Str(_))
}

/// An operator between operands, and its level: the higher, the tighter.
fn binary(kind: TokenKind) -> Option<(BinaryOp, u8)> {
    Some(match kind {
        TokenKind::OrOr => (BinaryOp::Or, 0),
        TokenKind::AndAnd => (BinaryOp::And, 1),
        TokenKind::EqualsEquals => (BinaryOp::Eq, 2),
        TokenKind::NotEquals => (BinaryOp::Ne, 2),
        TokenKind::Less => (BinaryOp::Lt, 2),
        TokenKind::LessEquals => (BinaryOp::Le, 2),
        TokenKind::Greater => (BinaryOp::Gt, 2),
        TokenKind::GreaterEquals => (BinaryOp::Ge, 2),
        TokenKind::Or => (BinaryOp::Union, 3),
        TokenKind::Plus => (BinaryOp::Add, 4),
        TokenKind::Minus => (BinaryOp::Sub, 4),
        TokenKind::And => (BinaryOp::Intersect, 5),
        TokenKind::Star => (BinaryOp::Mul, 6),
        TokenKind::Slash => (BinaryOp::Div, 6),
        TokenKind::Percent => (BinaryOp::Rem, 6),
        _ => return None,
    })
}
