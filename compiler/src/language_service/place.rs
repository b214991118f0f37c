//! What stands around a place, by tokens alone: this holds in texts with errors too.

use crate::source::FileId;
use crate::syntax::ast::BlockKind;
use crate::syntax::lexer::{Token, TokenKind, lex};
use crate::syntax::words;
use std::ops::Range;

/// What a place is within.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Within {
    /// A comment.
    Comment,
    /// A text between quotes, from its quote on; whether it is the path of an import.
    Text(Range<usize>, bool),
    /// A number or a colour.
    Literal,
    /// Anything else.
    Code,
}

/// A bracket that is open at a place.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Open {
    /// The brackets of a call: where the called name stands, whether after a dot, and the names before that dot.
    Call(Call),
    /// The brackets of the parameters of a declaration.
    Parameters,
    /// The braces of a block of the scene, or of a material where there is none.
    Entries(Option<BlockKind>),
    /// Any other bracket.
    Other,
}

/// A call whose brackets are open at a place.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Call {
    /// Where the called name stands.
    pub(super) name: Range<usize>,
    /// Whether it stands after a dot.
    pub(super) after_dot: bool,
    /// The name right before that dot, where a name stands there.
    pub(super) before_dot: Option<Range<usize>>,
    /// Whether that name stands after a dot too: `s.sky.arch(`.
    pub(super) before_is_after_dot: bool,
    /// How many arguments end before the place.
    pub(super) commas: usize,
    /// The name before the colon of the argument at the place, where one is written.
    pub(super) label: Option<Range<usize>>,
    /// The names before colons of all arguments so far.
    pub(super) labels: Vec<Range<usize>>,
}

/// What stands around a place.
pub(super) struct Place {
    /// Tokens that end before the word at the place, without comments.
    before: Vec<Token>,
    /// The word at the place, empty where there is none.
    pub(super) word: Range<usize>,
    pub(super) within: Within,
    /// The innermost bracket that is open.
    pub(super) open: Option<Open>,
}

impl Place {
    /// The place of a byte in a text.
    pub(super) fn new(text: &str, offset: usize) -> Self {
        let (tokens, _) = lex(FileId(0), text);
        let mut place = Self { before: Vec::new(), word: offset..offset, within: Within::Code, open: None };
        for token in &tokens {
            let (start, end) = (token.start as usize, token.end as usize);
            if start >= offset && !(start == offset && token.kind == TokenKind::Name) {
                break;
            }
            match token.kind {
                TokenKind::LineComment | TokenKind::Doc | TokenKind::FileDoc if offset <= end => place.within = Within::Comment,
                TokenKind::BlockComment if offset < end => place.within = Within::Comment,
                TokenKind::LineComment | TokenKind::Doc | TokenKind::FileDoc | TokenKind::BlockComment => {}
                TokenKind::Name if offset <= end => place.word = start..end,
                TokenKind::Str if offset < end => place.within = Within::Text(start..end, place.ends_in(text, &["import"])),
                TokenKind::BadLiteral if offset <= end && text.get(start..).is_some_and(|rest| rest.starts_with('"')) => {
                    place.within = Within::Text(start..end, place.ends_in(text, &["import"]));
                }
                TokenKind::Int | TokenKind::Float | TokenKind::Angle | TokenKind::Length | TokenKind::Color | TokenKind::BadLiteral if offset <= end => {
                    place.within = Within::Literal;
                }
                _ => place.before.push(*token),
            }
        }
        place.open = place.innermost(text);
        place
    }

    /// The last token before the word, `n` tokens back.
    pub(super) fn back(&self, n: usize) -> Option<Token> {
        self.before.len().checked_sub(n + 1).and_then(|at| self.before.get(at)).copied()
    }

    /// The kind of the last token before the word, `n` tokens back.
    pub(super) fn kind_back(&self, n: usize) -> Option<TokenKind> {
        self.back(n).map(|token| token.kind)
    }

    fn ends_in(&self, text: &str, words: &[&str]) -> bool {
        self.back(0).is_some_and(|token| token.kind == TokenKind::Name && words.contains(&token.text(text)))
    }

    /// Whether a declaration may start at the word.
    pub(super) fn at_top(&self, text: &str) -> bool {
        let ends = self.back(0).is_none_or(|last| text.get(last.end as usize..self.word.start).is_some_and(|gap| gap.contains('\n')));
        let goes_on = matches!(
            self.kind_back(0),
            Some(
                TokenKind::Equals | TokenKind::Dot | TokenKind::Comma | TokenKind::Colon | TokenKind::Plus | TokenKind::Minus | TokenKind::Star
                    | TokenKind::Slash | TokenKind::Percent | TokenKind::And | TokenKind::AndAnd | TokenKind::Or | TokenKind::OrOr | TokenKind::Not
                    | TokenKind::EqualsEquals | TokenKind::NotEquals | TokenKind::Less | TokenKind::LessEquals | TokenKind::Greater
                    | TokenKind::GreaterEquals | TokenKind::DotDot
            )
        );
        self.open.is_none() && ends && !goes_on
    }

    /// Whether a type is written at the word.
    pub(super) fn at_type(&self, text: &str) -> bool {
        let mut back = 0;
        while self.kind_back(back) == Some(TokenKind::BracketOpen) {
            back += 1;
        }
        if self.kind_back(back) != Some(TokenKind::Colon) || self.kind_back(back + 1) != Some(TokenKind::Name) {
            return false;
        }
        let is_param = self.back(back + 2).is_some_and(|token| token.text(text) == "param");
        is_param || self.open == Some(Open::Parameters) || back > 0 && self.stack_at(text, back) == Some(Open::Parameters)
    }

    /// The bracket that is open so many tokens before the word.
    fn stack_at(&self, text: &str, back: usize) -> Option<Open> {
        let shorter = Self {
            before: self.before.get(..self.before.len().saturating_sub(back)).unwrap_or(&[]).to_vec(),
            word: self.word.clone(),
            within: Within::Code,
            open: None,
        };
        shorter.innermost(text)
    }

    /// Whether a key of a block is written at the word.
    pub(super) fn at_key(&self) -> Option<Option<BlockKind>> {
        let Some(Open::Entries(kind)) = self.open else { return None };
        matches!(self.kind_back(0), Some(TokenKind::BraceOpen | TokenKind::Comma | TokenKind::Semicolon)).then_some(kind)
    }

    /// The key whose value is written at the word, where it is one of a block.
    pub(super) fn value_of<'t>(&self, text: &'t str) -> Option<(Option<BlockKind>, &'t str)> {
        let Some(Open::Entries(kind)) = self.open else { return None };
        let mut depth = 0usize;
        for (at, token) in self.before.iter().enumerate().rev() {
            match token.kind {
                TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => depth += 1,
                TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen => depth = depth.checked_sub(1)?,
                TokenKind::Comma if depth == 0 => return None,
                TokenKind::Colon if depth == 0 => {
                    let key = at.checked_sub(1).and_then(|at| self.before.get(at))?;
                    return Some((kind, key.text(text)));
                }
                _ => {}
            }
        }
        None
    }

    /// The innermost bracket that is open after the tokens before the word.
    fn innermost(&self, text: &str) -> Option<Open> {
        let open = self.unclosed(text, self.before.len())?;
        Some(self.kind_of(text, open))
    }

    /// The innermost call whose brackets are open at the word, over brackets that are none of a call.
    pub(super) fn call(&self, text: &str) -> Option<Call> {
        let mut end = self.before.len();
        while let Some(open) = self.unclosed(text, end) {
            match self.kind_of(text, open) {
                Open::Call(call) => return Some(call),
                // What stands in braces is a value of its own.
                Open::Entries(_) | Open::Parameters => return None,
                Open::Other if self.before.get(open).is_some_and(|token| token.kind == TokenKind::BraceOpen) => return None,
                Open::Other => end = open,
            }
        }
        None
    }

    /// The index of the last bracket before `end` that nothing closes. A word of a declaration at the start of a line ends all brackets.
    fn unclosed(&self, text: &str, end: usize) -> Option<usize> {
        let mut depth = 0usize;
        for (at, token) in self.before.iter().enumerate().take(end).rev() {
            match token.kind {
                TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => depth += 1,
                TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen => match depth.checked_sub(1) {
                    None => return Some(at),
                    Some(less) => depth = less,
                },
                TokenKind::Name => {
                    let start = token.start as usize;
                    let flush = start == 0 || text.as_bytes().get(start - 1) == Some(&b'\n');
                    let declares = words::DECLARATIONS.contains(&token.text(text));
                    let next = self.before.get(at + 1).map(|next| next.kind);
                    if flush && declares && matches!(next, Some(TokenKind::Name | TokenKind::Equals | TokenKind::Str | TokenKind::BraceOpen)) {
                        // What is open was opened after it: that was met already.
                        return None;
                    }
                }
                _ => {}
            }
        }
        None
    }

    /// What the bracket at an index is.
    fn kind_of(&self, text: &str, open: usize) -> Open {
        let token = |at: Option<usize>| at.and_then(|at| self.before.get(at)).copied();
        let word = |at: Option<usize>| token(at).filter(|t| t.kind == TokenKind::Name).map_or("", |t| t.text(text));
        let range = |t: Token| t.start as usize..t.end as usize;
        let back = |n: usize| open.checked_sub(n);
        match token(Some(open)).map(|t| t.kind) {
            Some(TokenKind::ParenOpen) => {
                let Some(name) = token(back(1)).filter(|t| t.kind == TokenKind::Name) else { return Open::Other };
                if words::DECLARATIONS.contains(&word(back(2))) {
                    return Open::Parameters;
                }
                let after_dot = token(back(2)).is_some_and(|t| t.kind == TokenKind::Dot);
                if !after_dot && words::is_reserved(name.text(text)) {
                    return Open::Other;
                }
                let before_dot = token(back(3)).filter(|t| after_dot && t.kind == TokenKind::Name).map(range);
                let before_is_after_dot = before_dot.is_some() && token(back(4)).is_some_and(|t| t.kind == TokenKind::Dot);
                let (commas, labels, label) = self.arguments(open);
                Open::Call(Call { name: range(name), after_dot, before_dot, before_is_after_dot, commas, label, labels })
            }
            Some(TokenKind::BraceOpen) => {
                let blocks = [
                    ("camera", BlockKind::Camera),
                    ("light", BlockKind::Light),
                    ("environment", BlockKind::Environment),
                    ("render", BlockKind::Render),
                    ("physics", BlockKind::Physics),
                    ("balls", BlockKind::Balls),
                    ("mesh", BlockKind::Mesh),
                ];
                // `camera {`, `camera top {`, `mesh statue "file" {`, `material m(a: float) {`
                for n in 1..=3 {
                    if let Some((_, kind)) = blocks.iter().find(|(name, _)| *name == word(back(n))) {
                        return Open::Entries(Some(*kind));
                    }
                    if !token(back(n)).is_some_and(|t| matches!(t.kind, TokenKind::Name | TokenKind::Str)) {
                        break;
                    }
                }
                let name = match token(back(1)).map(|t| t.kind) {
                    Some(TokenKind::ParenClose) => self.opening(open - 1).and_then(|at| at.checked_sub(1)),
                    _ => back(1),
                };
                let is_material = name.and_then(|name| name.checked_sub(1)).is_some_and(|at| word(Some(at)) == "material");
                if is_material { Open::Entries(None) } else { Open::Other }
            }
            _ => Open::Other,
        }
    }

    /// The bracket that the one at an index closes.
    fn opening(&self, close: usize) -> Option<usize> {
        let mut depth = 0usize;
        for (at, token) in self.before.iter().enumerate().take(close + 1).rev() {
            match token.kind {
                TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => depth += 1,
                TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen => {
                    depth = depth.saturating_sub(1);
                    if depth == 0 {
                        return Some(at);
                    }
                }
                _ => {}
            }
        }
        None
    }

    /// Of the arguments after an open bracket: how many end before the word, their names, and that of the last.
    fn arguments(&self, open: usize) -> (usize, Vec<Range<usize>>, Option<Range<usize>>) {
        let (mut depth, mut commas, mut labels, mut label) = (0usize, 0, Vec::new(), None);
        let mut last: Option<Token> = None;
        for token in self.before.iter().skip(open + 1) {
            match token.kind {
                TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen => depth += 1,
                TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => depth = depth.saturating_sub(1),
                TokenKind::Comma if depth == 0 => {
                    commas += 1;
                    label = None;
                }
                TokenKind::Colon if depth == 0 => {
                    label = last.filter(|t| t.kind == TokenKind::Name).map(|t| t.start as usize..t.end as usize);
                    labels.extend(label.clone());
                }
                _ => {}
            }
            last = Some(*token);
        }
        (commas, labels, label)
    }
}
