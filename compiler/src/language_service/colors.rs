//! Colours that are written in a text.

use crate::source::{FileId, Span};
use crate::syntax::lexer::{TokenKind, lex};
use crate::syntax::literals::read_color;

/// A colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorAt {
    /// Where it stands.
    pub span: Span,
    /// Red, green and blue in sRGB, 0 to 1.
    pub rgb: [f64; 3],
}

/// The colours of a text, in their order.
pub fn colors(text: &str, file: FileId) -> Vec<ColorAt> {
    let (tokens, _) = lex(file, text);
    let literals = tokens.iter().filter(|token| token.kind == TokenKind::Color);
    literals.filter_map(|token| Some(ColorAt { span: token.span(file), rgb: read_color(token.text(text))?.map(|byte| f64::from(byte) / 255.0) })).collect()
}

/// A colour as it is written: `#d4af37`. Components outside of 0 to 1 are kept within, and what is no number counts as 0.
pub fn written_color(rgb: [f64; 3]) -> String {
    let byte = |c: f64| (c.clamp(0.0, 1.0) * 255.0).round() as u8;
    let [r, g, b] = rgb.map(byte);
    format!("#{r:02x}{g:02x}{b:02x}")
}
