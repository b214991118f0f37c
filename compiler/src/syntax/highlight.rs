//! Colours for an editor.

use super::lexer::{Token, TokenKind, lex};
use super::words;
use crate::source::FileId;
use std::ops::Range;

/// What a token is to its reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TokenClass {
    /// `let`, `for`, `if`, `import`, `param` and their like.
    Keyword,
    /// `field`, `shape`, `material`, `light` and their like where they declare, and types.
    Kind,
    /// A name.
    Name,
    /// A number, with its unit.
    Number,
    /// A string.
    Text,
    /// `#d4af37`
    Color,
    /// `// …`, `/* … */`
    Comment,
    /// `/// …`, `//! …`
    Doc,
    /// Operators and signs between them.
    Operator,
    /// What can't be read.
    Error,
}

/// The tokens of a text in their order, comments too, each with its class. Texts with errors have their tokens as well.
pub fn tokens(text: &str) -> Vec<(Range<usize>, TokenClass)> {
    let (tokens, _) = lex(FileId(0), text);
    let mut before: [Option<Token>; 2] = [None, None];
    let mut out = Vec::with_capacity(tokens.len());
    for (i, token) in tokens.iter().enumerate() {
        let class = match token.kind {
            TokenKind::LineComment | TokenKind::BlockComment => TokenClass::Comment,
            TokenKind::Doc | TokenKind::FileDoc => TokenClass::Doc,
            TokenKind::Int | TokenKind::Float | TokenKind::Angle | TokenKind::Length => TokenClass::Number,
            TokenKind::Str => TokenClass::Text,
            TokenKind::Color => TokenClass::Color,
            TokenKind::BadLiteral | TokenKind::BadCharacter => TokenClass::Error,
            TokenKind::Name => {
                let after = tokens.iter().skip(i + 1).find(|t| !is_comment(t.kind));
                class_of_name(text, *token, before, after.copied())
            }
            _ => TokenClass::Operator,
        };
        out.push((token.start as usize..token.end as usize, class));
        if !is_comment(token.kind) {
            before = [before[1], Some(*token)];
        }
    }
    out
}

fn is_comment(kind: TokenKind) -> bool {
    matches!(
        kind,
        TokenKind::LineComment | TokenKind::BlockComment | TokenKind::Doc | TokenKind::FileDoc
    )
}

/// A word is what its place makes it: a name after a dot and before a colon, a type after a colon.
fn class_of_name(
    text: &str,
    token: Token,
    before: [Option<Token>; 2],
    after: Option<Token>,
) -> TokenClass {
    let word = token.text(text);
    let after_value =
        before[1].is_some_and(|last| ends_value(last.kind) && !words::is_reserved(last.text(text)));
    let [second, last] = before.map(|t| t.map(|t| t.kind));
    let next = after.map(|t| t.kind);
    if last == Some(TokenKind::Dot) || next == Some(TokenKind::Colon) {
        return TokenClass::Name;
    }
    let after_colon = last == Some(TokenKind::Colon)
        || last == Some(TokenKind::BracketOpen)
            && matches!(second, Some(TokenKind::Colon | TokenKind::BracketOpen));
    if after_colon && words::TYPES.contains(&word) {
        return TokenClass::Kind;
    }
    match word {
        "import" | "param" | "let" => TokenClass::Keyword,
        _ if words::EXPRESSIONS.contains(&word) => TokenClass::Keyword,
        _ if words::DECLARATIONS.contains(&word) => TokenClass::Kind,
        "as" if last == Some(TokenKind::Str) => TokenClass::Keyword,
        "by" if matches!(next, Some(TokenKind::Name | TokenKind::Plus | TokenKind::Star))
            && after_value =>
        {
            TokenClass::Keyword
        }
        "exact" if next == Some(TokenKind::Equals) && after_value => TokenClass::Keyword,
        "lipschitz" if after_value => TokenClass::Keyword,
        _ => TokenClass::Name,
    }
}

fn ends_value(kind: TokenKind) -> bool {
    matches!(
        kind,
        TokenKind::Name
            | TokenKind::Int
            | TokenKind::Float
            | TokenKind::Angle
            | TokenKind::Length
            | TokenKind::ParenClose
            | TokenKind::BracketClose
            | TokenKind::BraceClose
    )
}

#[cfg(test)]
mod tests {
    #![allow(clippy::indexing_slicing)]
    use super::TokenClass::*;
    use super::*;

    fn classes(text: &str) -> Vec<(&str, TokenClass)> {
        tokens(text).into_iter().map(|(range, class)| (&text[range], class)).collect()
    }

    #[test]
    fn words_are_what_their_place_makes_them() {
        let found = classes(
            "field f(by: [vec4], k = 45deg) exact = for by in by by min { by.light } // #fff\nlet c = #fff $",
        );
        let expected = [
            ("field", Kind),
            ("f", Name),
            ("(", Operator),
            ("by", Name),
            (":", Operator),
            ("[", Operator),
            ("vec4", Kind),
            ("]", Operator),
            (",", Operator),
            ("k", Name),
            ("=", Operator),
            ("45deg", Number),
            (")", Operator),
            ("exact", Keyword),
            ("=", Operator),
            ("for", Keyword),
            ("by", Name),
            ("in", Keyword),
            ("by", Name),
            ("by", Keyword),
            ("min", Name),
            ("{", Operator),
            ("by", Name),
            (".", Operator),
            ("light", Name),
            ("}", Operator),
            ("// #fff", Comment),
            ("let", Keyword),
            ("c", Name),
            ("=", Operator),
            ("#fff", Color),
            ("$", Error),
        ];
        assert_eq!(found, expected);
    }
}
