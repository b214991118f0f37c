//! Declarations as texts with places where their lines may end.

use super::super::ast::*;
use super::super::lexer::TokenKind;
use super::build::{Brackets, Builder};
use super::doc::Doc;
use crate::source::Span;

impl<'t> Builder<'t> {
    pub(super) fn file(mut self, file: &File) -> Doc<'t> {
        let mut parts = Vec::new();
        for item in &file.items {
            let between = self.comments.between(item.span.start);
            let line = between.line(Doc::Hard);
            parts.extend([between.trailing, line]);
            parts.extend(between.leading);
            parts.push(self.item(item));
        }
        parts.push(self.comments.closing(u32::MAX));
        Doc::concat(parts)
    }

    fn item(&mut self, item: &Item) -> Doc<'t> {
        let mut parts = Vec::new();
        match &item.kind {
            ItemKind::Import { path_span, alias, .. } => {
                parts.extend([
                    Doc::Text("import "),
                    self.comments.within(path_span.start),
                    self.source(*path_span),
                ]);
                if let Some(alias) = alias {
                    parts.extend([Doc::Text(" as "), self.name(alias)]);
                }
            }
            ItemKind::Param { name, ty, value, domain, description } => {
                parts.extend([Doc::Text("param "), self.name(name)]);
                self.type_after_colon(ty, &mut parts);
                parts.extend([Doc::Text(" = "), self.expr(value)]);
                if let Some(domain) = domain {
                    parts.extend([Doc::Text(" in "), self.expr(domain)]);
                }
                if description.is_some() {
                    let text = self.last_text(item.span);
                    let between = self.comments.between(text.start);
                    let mut line = vec![between.trailing, Doc::Line];
                    line.extend(between.leading);
                    line.push(self.source(text));
                    parts.push(Doc::group(Doc::indent(Doc::concat(line))));
                }
            }
            ItemKind::Let(binding) => parts.push(self.binding(binding)),
            ItemKind::Function(function) => self.function(function, &mut parts),
            ItemKind::Material { name, parameters, lets, entries } => {
                parts.extend([Doc::Text("material "), self.name(name)]);
                let head_end = self.parameters(parameters, &mut parts).unwrap_or(name.span.end);
                parts.push(Doc::Text(" "));
                parts.push(self.entries(lets, entries, head_end, item.span));
            }
            ItemKind::Scene(value) => parts.extend([Doc::Text("scene ="), self.body(value)]),
            ItemKind::Block { kind_span, name, file, entries, .. } => {
                parts.extend([self.source(*kind_span), Doc::Text(" ")]);
                let mut head_end = kind_span.end;
                if let Some(name) = name {
                    parts.extend([self.name(name), Doc::Text(" ")]);
                    head_end = name.span.end;
                }
                if let Some((_, span)) = file {
                    parts.extend([
                        self.comments.within(span.start),
                        self.source(*span),
                        Doc::Text(" "),
                    ]);
                    head_end = span.end;
                }
                parts.push(self.entries(&[], entries, head_end, item.span));
            }
        }
        Doc::concat(parts)
    }

    /// Where the description of a parameter stands, which is its last token.
    fn last_text(&self, item: Span) -> Span {
        let end = self.tokens.partition_point(|token| token.end <= item.end);
        let last = self.tokens.iter().take(end).rfind(|token| token.kind == TokenKind::Str);
        last.map_or(item, |token| token.span(item.file))
    }

    fn function(&mut self, function: &Function, parts: &mut Vec<Doc<'t>>) {
        parts.push(Doc::Text(match function.kind {
            FunctionKind::Field => "field ",
            FunctionKind::Field2 => "field2 ",
            FunctionKind::Warp => "warp ",
            FunctionKind::Warp2 => "warp2 ",
            FunctionKind::Blend => "blend ",
            FunctionKind::Fn => "fn ",
            FunctionKind::Shape => "shape ",
            FunctionKind::Shape2 => "shape2 ",
        }));
        parts.push(self.name(&function.name));
        self.parameters(&function.parameters, parts);
        if let Some(claim) = &function.claim {
            parts.extend([Doc::Text(" "), self.comments.within(claim.span.start)]);
            match &claim.kind {
                ClaimKind::Exact => parts.push(Doc::Text("exact")),
                ClaimKind::Lipschitz(value, range) => {
                    parts.extend([Doc::Text("lipschitz "), self.expr(value)]);
                    if let Some(range) = range {
                        parts.extend([Doc::Text(" in "), self.expr(range)]);
                    }
                }
            }
        }
        parts.extend([Doc::Text(" ="), self.body(&function.body)]);
    }

    /// The parameters, if there are some; the answer is where their bracket closes.
    fn parameters(&mut self, parameters: &[Parameter], parts: &mut Vec<Doc<'t>>) -> Option<u32> {
        let last = parameters.last()?;
        let end = match (&last.default, &last.ty) {
            (Some(value), _) => value.span.end,
            (None, Some((_, span))) => span.end,
            (None, None) => last.name.span.end,
        };
        let close_at = self.first_after(end, TokenKind::ParenClose);
        let brackets = Brackets { last_comma: true, ..Brackets::new("(", ")", close_at) };
        parts.push(self.list(&brackets, &[], parameters, |p| p.name.span.start, Self::parameter));
        Some(close_at)
    }

    fn parameter(&mut self, parameter: &Parameter) -> Doc<'t> {
        let mut parts = vec![self.name(&parameter.name)];
        self.type_after_colon(&parameter.ty, &mut parts);
        if let Some(default) = &parameter.default {
            parts.extend([Doc::Text(" = "), self.expr(default)]);
        }
        Doc::concat(parts)
    }

    fn type_after_colon(&mut self, ty: &Option<(Type, Span)>, parts: &mut Vec<Doc<'t>>) {
        if let Some((ty, span)) = ty {
            parts.extend([Doc::Text(": "), self.comments.within(span.start)]);
            let mut inner = ty;
            let mut lists = 0;
            while let Type::List(element) = inner {
                lists += 1;
                inner = element;
            }
            parts.extend((0..lists).map(|_| Doc::Text("[")));
            parts.push(Doc::Text(type_name(inner)));
            parts.extend((0..lists).map(|_| Doc::Text("]")));
        }
    }

    /// The inside of a block whose head ends at a byte.
    fn entries(&mut self, lets: &[Let], entries: &[Entry], head_end: u32, item: Span) -> Doc<'t> {
        let open_at = self.first_after(head_end, TokenKind::BraceOpen);
        let comments = self.comments.within(open_at);
        let close_at = item.end.saturating_sub(1);
        let brackets =
            Brackets { pad: true, last_comma: true, ..Brackets::new("{", "}", close_at) };
        let list = self.list(&brackets, lets, entries, |entry| entry.key.span.start, Self::entry);
        Doc::concat(vec![comments, list])
    }

    fn entry(&mut self, entry: &Entry) -> Doc<'t> {
        Doc::concat(vec![self.name(&entry.key), Doc::Text(": "), self.expr(&entry.value)])
    }
}

fn type_name(ty: &Type) -> &'static str {
    match ty {
        Type::Bool => "bool",
        Type::Int => "int",
        Type::Float => "float",
        Type::Vec(2) => "vec2",
        Type::Vec(3) => "vec3",
        Type::Vec(_) => "vec4",
        Type::Mat(2) => "mat2",
        Type::Mat(3) => "mat3",
        Type::Mat(_) => "mat4",
        Type::Color => "color",
        Type::Shape => "shape",
        Type::Shape2 => "shape2",
        Type::Material => "material",
        Type::Curve => "curve",
        Type::Field => "field",
        Type::List(_) | Type::Str => "",
    }
}
