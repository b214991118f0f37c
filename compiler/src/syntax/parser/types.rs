//! Types.

use super::super::ast::Type;
use super::super::lexer::TokenKind;
use super::super::words;
use super::Parser;
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;

impl Parser<'_> {
    pub(super) fn type_after_colon(&mut self) -> Option<(Type, Span)> {
        self.eat(TokenKind::Colon)?;
        let start = self.peek().start;
        let ty = self.ty()?;
        Some((ty, self.span_from(start)))
    }

    pub(super) fn ty(&mut self) -> Option<Type> {
        let token = self.peek();
        match token.kind {
            TokenKind::BracketOpen => {
                let inner = self.nested(|p| {
                    p.bump();
                    let inner = p.ty();
                    if p.eat(TokenKind::BracketClose).is_none() {
                        p.unclosed(token);
                    }
                    inner
                });
                inner.flatten().map(|inner| Type::List(Box::new(inner)))
            }
            TokenKind::Name => {
                let word = token.text(self.text);
                let ty = type_of(word);
                if ty.is_none() {
                    let ours = match word {
                        "number" | "double" | "half" | "real" | "f32" | "f64" => Some("float"),
                        "integer" | "uint" | "i32" | "u32" | "i64" => Some("int"),
                        "boolean" => Some("bool"),
                        "colour" | "rgb" => Some("color"),
                        "vec" | "vector" | "point" => Some("vec3"),
                        "drawing" | "shape2d" => Some("shape2"),
                        "solid" | "sdf" | "object" => Some("shape"),
                        _ => words::nearest(word, words::TYPES.iter().copied()),
                    };
                    let help = match ours {
                        Some(ours) => format!("write `{ours}`"),
                        None => format!("types are {} and lists `[T]`", words::TYPES.join(", ")),
                    };
                    let span = self.span(token);
                    let said = Diagnostic::new(Code::UnknownType, span, format!("there is no type `{word}`"), help);
                    self.say(said.write_if(span, ours));
                }
                self.bump();
                ty
            }
            _ => {
                self.missing(
                    "a type",
                    format!("types are {} and lists `[T]`", words::TYPES.join(", ")),
                );
                None
            }
        }
    }
}

pub(super) fn type_of(word: &str) -> Option<Type> {
    Some(match word {
        "bool" => Type::Bool,
        "int" => Type::Int,
        "float" => Type::Float,
        "vec2" => Type::Vec(2),
        "vec3" => Type::Vec(3),
        "vec4" => Type::Vec(4),
        "mat2" => Type::Mat(2),
        "mat3" => Type::Mat(3),
        "mat4" => Type::Mat(4),
        "color" => Type::Color,
        "shape" => Type::Shape,
        "shape2" => Type::Shape2,
        "material" => Type::Material,
        "curve" => Type::Curve,
        "field" => Type::Field,
        _ => return None,
    })
}
