//! Expressions as texts with places where their lines may end. The tree is walked in the order of the text, so that each comment
//! finds its place when the walk passes it.

use super::super::ast::*;
use super::super::lexer::{Token, TokenKind, lex};
use super::comments::Comments;
use super::doc::{Doc, Hug};
use crate::source::{FileId, Span};

pub(super) struct Builder<'t> {
    text: &'t str,
    pub(super) tokens: Vec<Token>,
    pub(super) comments: Comments<'t>,
}

/// A list between brackets.
pub(super) struct Brackets {
    pub(super) open: &'static str,
    pub(super) close: &'static str,
    /// First byte of the closing bracket.
    pub(super) close_at: u32,
    /// Where lines end: after the opening and before the closing bracket.
    pub(super) pad: bool,
    /// A comma after the last element where lines end.
    pub(super) last_comma: bool,
    /// As many elements on a line as go there.
    pub(super) fill: bool,
}

impl<'t> Builder<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        let (tokens, _) = lex(FileId(0), text);
        Builder { text, comments: Comments::new(text, &tokens), tokens }
    }

    /// The characters of a place.
    pub(super) fn source(&self, span: Span) -> Doc<'t> {
        Doc::Text(self.text.get(span.range()).unwrap_or(""))
    }

    /// A number with a digit on each side of its point.
    fn number(&self, span: Span) -> Doc<'t> {
        let text = self.text.get(span.range()).unwrap_or("");
        let before = if text.starts_with('.') { "0" } else { "" };
        let after = if text.ends_with('.') { "0" } else { "" };
        Doc::concat([before, text, after].into_iter().filter(|part| !part.is_empty()).map(Doc::Text).collect())
    }

    /// Where the first token of a kind stands after a byte.
    pub(super) fn first_after(&self, from: u32, kind: TokenKind) -> u32 {
        let start = self.tokens.partition_point(|token| token.start < from);
        self.tokens
            .iter()
            .skip(start)
            .find(|token| token.kind == kind)
            .map_or(from, |token| token.start)
    }

    pub(super) fn name(&mut self, name: &Name) -> Doc<'t> {
        let comments = self.comments.within(name.span.start);
        Doc::concat(vec![comments, self.source(name.span)])
    }

    /// Elements with commas between them, after some `let`s where it is the inside of a block.
    pub(super) fn list<T>(
        &mut self,
        brackets: &Brackets,
        lets: &[Let],
        items: &[T],
        start_of: fn(&T) -> u32,
        write: fn(&mut Self, &T) -> Doc<'t>,
    ) -> Doc<'t> {
        let edge = || if brackets.pad { Doc::Line } else { Doc::Soft };
        let mut inner = Vec::new();
        for (i, binding) in lets.iter().enumerate() {
            self.let_line(binding, i > 0, &mut inner);
        }
        for (i, item) in items.iter().enumerate() {
            let between = self.comments.between(start_of(item));
            if i > 0 {
                inner.push(Doc::Text(","));
            }
            let first = i == 0 && lets.is_empty();
            let line = match between.blank && !first {
                true => Doc::Blank,
                false if first => edge(),
                false => Doc::Line,
            };
            let mut element = vec![between.trailing, line];
            element.extend(between.leading);
            element.push(write(self, item));
            match brackets.fill && i > 0 {
                true => inner.push(Doc::yielding(Doc::concat(element))),
                false => inner.extend(element),
            }
        }
        if brackets.last_comma && !items.is_empty() {
            inner.push(Doc::IfBroken(Box::new(Doc::Text(",")), Box::new(Doc::nil())));
        }
        inner.push(self.comments.closing(brackets.close_at));
        let list = Doc::concat(vec![
            Doc::Text(brackets.open),
            Doc::indent(Doc::concat(inner)),
            edge(),
            Doc::Text(brackets.close),
        ]);
        if brackets.pad { Doc::yielding(list) } else { Doc::group(list) }
    }

    /// One value that stays with its brackets where its own lines end, unless a comment stands between them.
    fn hugged(&mut self, brackets: &Brackets, item: &Expr) -> Option<Doc<'t>> {
        let comments = &self.comments;
        if comments.any_before(item.span.start)
            || comments.any_between(item.span.end, brackets.close_at)
        {
            return None;
        }
        Some(Doc::concat(vec![
            Doc::Text(brackets.open),
            self.expr(item),
            Doc::Text(brackets.close),
        ]))
    }

    pub(super) fn expr(&mut self, expr: &Expr) -> Doc<'t> {
        match &expr.kind {
            ExprKind::Chain(first, rest) => self.chain(first, rest, 0),
            ExprKind::Dot(..) | ExprKind::Call(..) | ExprKind::Index(..) => self.calls(expr),
            ExprKind::If(..) => {
                let mut parts = Vec::new();
                self.choice(expr, &mut parts);
                Doc::group(Doc::concat(parts))
            }
            ExprKind::For(repetition) => self.repetition(expr, repetition),
            ExprKind::Block(lets, value) => {
                let comments = self.comments.within(expr.span.start);
                let block = self.block(lets, value, expr.span);
                Doc::concat(vec![comments, Doc::group(block)])
            }
            ExprKind::Vector(items) => self.items(expr, items),
            ExprKind::List(items) => self.items(expr, items),
            ExprKind::Paren(inner) => self.items(expr, std::slice::from_ref(&**inner)),
            ExprKind::Unary(op, inner) => {
                let comments = self.comments.within(expr.span.start);
                let sign = match op {
                    UnaryOp::Neg => "-",
                    UnaryOp::Not => "!",
                };
                Doc::concat(vec![comments, Doc::Text(sign), self.expr(inner)])
            }
            ExprKind::Range(from, to) => {
                Doc::concat(vec![self.expr(from), Doc::Text(".."), self.expr(to)])
            }
            ExprKind::Float(_) | ExprKind::Angle(..) | ExprKind::Length(..) => {
                let comments = self.comments.within(expr.span.start);
                Doc::concat(vec![comments, self.number(expr.span)])
            }
            ExprKind::Hole
            | ExprKind::Bool(_)
            | ExprKind::Int(_)
            | ExprKind::Color(_)
            | ExprKind::Str(_)
            | ExprKind::Name(_) => {
                let comments = self.comments.within(expr.span.start);
                Doc::concat(vec![comments, self.source(expr.span)])
            }
        }
    }

    /// A value after `=`.
    pub(super) fn body(&mut self, expr: &Expr) -> Doc<'t> {
        let between = self.comments.between(expr.span.start);
        if between.trailing.breaks() || between.leading.iter().any(Doc::breaks) {
            let mut parts = vec![between.trailing, Doc::Hard];
            parts.extend(between.leading);
            parts.push(self.expr(expr));
            return Doc::indent(Doc::concat(parts));
        }
        let (doc, hug) = match &expr.kind {
            ExprKind::Chain(first, rest) => (self.chain(first, rest, 2), Hug::Near),
            ExprKind::Block(..) | ExprKind::List(_) => (self.expr(expr), Hug::Now),
            ExprKind::Name(_)
            | ExprKind::Bool(_)
            | ExprKind::Int(_)
            | ExprKind::Float(_)
            | ExprKind::Str(_) => (self.expr(expr), Hug::Never),
            _ => (self.expr(expr), Hug::Always),
        };
        let mut parts = between.leading;
        parts.push(doc);
        Doc::Body(Box::new(Doc::concat(parts)), hug)
    }

    /// Operands with operators between them, which stand `back` columns left of the operands.
    fn chain(&mut self, first: &Expr, rest: &[(BinaryOp, Span, Expr)], back: usize) -> Doc<'t> {
        let mut parts = vec![Doc::align(0, self.expr(first))];
        for (op, span, operand) in rest {
            let between = self.comments.between(span.start);
            let line = between.line(Doc::Line);
            parts.extend([between.trailing, line]);
            parts.extend(between.leading);
            parts.push(Doc::Text(sign_of(*op)));
            parts.push(Doc::Text(" "));
            parts.push(Doc::align(0, self.expr(operand)));
        }
        Doc::align(back, Doc::group(Doc::concat(parts)))
    }

    /// A value with the calls, dots and indices after it.
    fn calls(&mut self, expr: &Expr) -> Doc<'t> {
        let mut base = expr;
        let mut links = Vec::new();
        while let ExprKind::Dot(inner, ..) | ExprKind::Call(inner, _) | ExprKind::Index(inner, _) =
            &base.kind
        {
            links.push(base);
            base = inner;
        }
        let is_call = |link: &&&Expr| matches!(link.kind, ExprKind::Dot(_, _, Some(_)));
        let block = matches!(base.kind, ExprKind::For(_) | ExprKind::If(..) | ExprKind::Block(..));
        let breakable = !block && links.iter().filter(is_call).count() > 1;
        let base = self.expr(base);
        let mut parts = Vec::new();
        for link in links.iter().rev() {
            let close_at = link.span.end.saturating_sub(1);
            match &link.kind {
                ExprKind::Dot(_, name, arguments) => {
                    if breakable && arguments.is_some() {
                        let dot =
                            self.tokens.partition_point(|token| token.start < name.span.start);
                        let dot = self
                            .tokens
                            .iter()
                            .take(dot)
                            .rfind(|token| token.kind == TokenKind::Dot);
                        let at = dot.map_or(name.span.start, |token| token.start);
                        let between = self.comments.between(at);
                        let line = between.line(Doc::Soft);
                        parts.extend([between.trailing, line]);
                        parts.extend(between.leading);
                    }
                    parts.push(self.comments.within(name.span.start));
                    parts.extend([Doc::Text("."), self.source(name.span)]);
                    if let Some(arguments) = arguments {
                        parts.push(self.arguments(arguments, close_at));
                    }
                }
                ExprKind::Call(_, arguments) => parts.push(self.arguments(arguments, close_at)),
                ExprKind::Index(_, index) => {
                    let brackets = Brackets::new("[", "]", close_at);
                    let doc = match self.hugged(&brackets, index) {
                        Some(doc) => doc,
                        None => {
                            let index = std::slice::from_ref(&**index);
                            self.list(&brackets, &[], index, |item| item.span.start, Self::expr)
                        }
                    };
                    parts.push(doc);
                }
                _ => {}
            }
        }
        let parts = Doc::concat(parts);
        Doc::group(Doc::concat(vec![base, if breakable { Doc::indent(parts) } else { parts }]))
    }

    pub(super) fn arguments(&mut self, arguments: &[Argument], close_at: u32) -> Doc<'t> {
        let brackets = Brackets { last_comma: true, ..Brackets::new("(", ")", close_at) };
        if let [Argument { name: None, value }] = arguments
            && (is_block_like(value) || matches!(value.kind, ExprKind::Call(..)))
            && let Some(doc) = self.hugged(&brackets, value)
        {
            return doc;
        }
        let start =
            |a: &Argument| a.name.as_ref().map_or(a.value.span.start, |name| name.span.start);
        self.list(&brackets, &[], arguments, start, Self::argument)
    }

    fn argument(&mut self, argument: &Argument) -> Doc<'t> {
        let mut parts = Vec::new();
        if let Some(name) = &argument.name {
            parts.extend([self.name(name), Doc::Text(": ")]);
        }
        parts.push(self.expr(&argument.value));
        Doc::concat(parts)
    }

    /// The elements of a vector, a list, or brackets around a value.
    fn items(&mut self, expr: &Expr, items: &[Expr]) -> Doc<'t> {
        let comments = self.comments.within(expr.span.start);
        let is_list = matches!(expr.kind, ExprKind::List(_));
        let is_paren = matches!(expr.kind, ExprKind::Paren(_));
        let (open, close) = if is_list { ("[", "]") } else { ("(", ")") };
        let mut brackets = Brackets::new(open, close, expr.span.end.saturating_sub(1));
        brackets.last_comma = !is_paren;
        brackets.fill = is_list && items.iter().all(is_plain);
        let hugged = match items {
            [item] if is_paren || is_block_like(item) => self.hugged(&brackets, item),
            _ => None,
        };
        let list = match hugged {
            Some(doc) => doc,
            None => self.list(&brackets, &[], items, |item| item.span.start, Self::expr),
        };
        Doc::concat(vec![comments, list])
    }

    /// `for i in source by fold { body }`.
    fn repetition(&mut self, expr: &Expr, repetition: &For) -> Doc<'t> {
        let mut parts = vec![self.comments.within(expr.span.start), Doc::Text("for ")];
        parts.extend([
            self.name(&repetition.index),
            Doc::Text(" in "),
            self.expr(&repetition.source),
            Doc::Text(" "),
        ]);
        if let Some(fold) = &repetition.by {
            parts.extend([self.comments.within(fold.span.start), Doc::Text("by ")]);
            match &fold.kind {
                FoldKind::Operator(op) => parts.push(Doc::Text(sign_of(*op))),
                FoldKind::Call(callee, arguments) => {
                    parts.push(self.expr(callee));
                    if !arguments.is_empty() {
                        parts.push(self.arguments(arguments, fold.span.end.saturating_sub(1)));
                    }
                }
            }
            parts.push(Doc::Text(" "));
        }
        parts.push(self.braces(&repetition.body));
        Doc::group(Doc::concat(parts))
    }

    /// `if c { a } else if d { b } else { e }`: broken all together.
    fn choice(&mut self, expr: &Expr, parts: &mut Vec<Doc<'t>>) {
        let mut at = expr;
        while let ExprKind::If(condition, then, otherwise) = &at.kind {
            parts.push(self.comments.within(at.span.start));
            parts.extend([
                Doc::Text("if "),
                self.expr(condition),
                Doc::Text(" "),
                self.braces(then),
            ]);
            let Some(otherwise) = otherwise else { return };
            parts.push(Doc::Text(" else "));
            at = otherwise;
        }
        parts.push(self.braces(at));
    }

    /// A block that is broken with what it belongs to.
    fn braces(&mut self, expr: &Expr) -> Doc<'t> {
        match &expr.kind {
            ExprKind::Block(lets, value) => {
                let comments = self.comments.within(expr.span.start);
                Doc::concat(vec![comments, self.block(lets, value, expr.span)])
            }
            _ => self.expr(expr),
        }
    }

    /// `{ let a = 1; value }`.
    fn block(&mut self, lets: &[Let], value: &Expr, span: Span) -> Doc<'t> {
        let mut inner = Vec::new();
        for (i, binding) in lets.iter().enumerate() {
            self.let_line(binding, i > 0, &mut inner);
        }
        self.element(value.span.start, !lets.is_empty(), &mut inner);
        inner.push(self.expr(value));
        inner.push(self.comments.closing(span.end.saturating_sub(1)));
        Doc::concat(vec![
            Doc::Text("{"),
            Doc::indent(Doc::concat(inner)),
            Doc::Line,
            Doc::Text("}"),
        ])
    }

    /// A `let` of a block on its line, with its `;`.
    pub(super) fn let_line(&mut self, binding: &Let, keep_blank: bool, inner: &mut Vec<Doc<'t>>) {
        self.element(binding.span.start, keep_blank, inner);
        inner.extend([self.binding(binding), Doc::Text(";")]);
    }

    /// The line before an element, and its comments.
    pub(super) fn element(&mut self, at: u32, keep_blank: bool, inner: &mut Vec<Doc<'t>>) {
        let between = self.comments.between(at);
        let line = if keep_blank { between.line(Doc::Line) } else { Doc::Line };
        inner.extend([between.trailing, line]);
        inner.extend(between.leading);
    }

    /// `let a = 1`, or one with a loop.
    pub(super) fn binding(&mut self, binding: &Let) -> Doc<'t> {
        let mut parts = vec![self.comments.within(binding.span.start), Doc::Text("let ")];
        let Some(iterate) = &binding.iterate else {
            for (name, value) in &binding.bindings {
                parts.extend([self.name(name), Doc::Text(" ="), self.body(value)]);
            }
            return Doc::concat(parts);
        };
        for (i, update) in binding.bindings.iter().enumerate() {
            if i > 0 {
                parts.push(Doc::Text(", "));
            }
            parts.push(self.update(update));
        }
        parts.extend([
            Doc::Text(" for "),
            self.name(&iterate.index),
            Doc::Text(" in "),
            self.expr(&iterate.source),
        ]);
        if let Some(condition) = &iterate.condition {
            parts.extend([Doc::Text(" while "), self.expr(condition)]);
        }
        parts.push(Doc::Text(" "));
        let head_end = iterate.condition.as_ref().unwrap_or(&iterate.source).span.end;
        let open_at = self.first_after(head_end, TokenKind::BraceOpen);
        parts.push(self.comments.within(open_at));
        let close_at = binding.span.end.saturating_sub(1);
        let brackets =
            Brackets { pad: true, last_comma: true, ..Brackets::new("{", "}", close_at) };
        let start = |update: &(Name, Expr)| update.0.span.start;
        parts.push(self.list(&brackets, &iterate.lets, &iterate.updates, start, Self::update));
        Doc::concat(parts)
    }

    fn update(&mut self, (name, value): &(Name, Expr)) -> Doc<'t> {
        Doc::concat(vec![self.name(name), Doc::Text(" = "), self.expr(value)])
    }
}

impl Brackets {
    pub(super) fn new(open: &'static str, close: &'static str, close_at: u32) -> Self {
        Brackets { open, close, close_at, pad: false, last_comma: false, fill: false }
    }
}

/// Whether a value brings its own brackets, so that others around it need no lines of their own.
fn is_block_like(expr: &Expr) -> bool {
    matches!(
        expr.kind,
        ExprKind::For(_) | ExprKind::If(..) | ExprKind::Block(..) | ExprKind::List(_)
    )
}

/// Whether a value is a number, a colour, or a vector of numbers.
fn is_plain(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Int(_) | ExprKind::Float(_) | ExprKind::Angle(..) | ExprKind::Length(..) | ExprKind::Color(_) => true,
        ExprKind::Unary(_, inner) => {
            matches!(inner.kind, ExprKind::Int(_) | ExprKind::Float(_) | ExprKind::Angle(..) | ExprKind::Length(..))
        }
        ExprKind::Vector(items) => {
            items.iter().all(|item| !matches!(item.kind, ExprKind::Vector(_)) && is_plain(item))
        }
        _ => false,
    }
}

fn sign_of(op: BinaryOp) -> &'static str {
    match op {
        BinaryOp::Mul => "*",
        BinaryOp::Div => "/",
        BinaryOp::Rem => "%",
        BinaryOp::Intersect => "&",
        BinaryOp::Add => "+",
        BinaryOp::Sub => "-",
        BinaryOp::Union => "|",
        BinaryOp::Eq => "==",
        BinaryOp::Ne => "!=",
        BinaryOp::Lt => "<",
        BinaryOp::Le => "<=",
        BinaryOp::Gt => ">",
        BinaryOp::Ge => ">=",
        BinaryOp::And => "&&",
        BinaryOp::Or => "||",
    }
}
