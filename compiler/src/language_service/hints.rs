//! What an editor may show between the characters of a text.

use super::callable::Callable;
use super::examine::FactorAt;
use super::place::Call;
use super::signature::callables;
use super::world::World;
use crate::source::FileId;
use crate::syntax::lexer::{Token, TokenKind, lex};
use rustc_hash::FxHashMap;
use std::ops::Range;

/// Words between two characters.
#[derive(Clone, Debug, PartialEq)]
pub struct Hint {
    /// Before which byte.
    pub offset: usize,
    /// The words.
    pub label: String,
    /// What a person sees who points at them, as Markdown.
    pub text: String,
    /// Whether it is the name of an argument: it stands before its value. Else it is a factor, and stands behind its term.
    pub is_argument: bool,
}

/// The hints within a range of a text: a factor behind each term that has one, and before each argument that is a bare number the name that it is given to, where
/// the call has more than one argument. `factors` are those of the newest compilation of this very text.
pub fn hints(world: &World, factors: &[FactorAt], file: FileId, range: Range<usize>) -> Vec<Hint> {
    let mut found: Vec<Hint> = Vec::new();
    for factor in factors.iter().filter(|factor| factor.path == world.path(file)) {
        let hint = Hint { offset: factor.range.end, label: factor.times.clone(), text: factor.markdown(), is_argument: false };
        // Of several at one place, as copies have them, the first is the largest.
        if !found.iter().any(|known| known.offset == hint.offset) {
            found.push(hint);
        }
    }
    let text = world.text(file);
    let (tokens, _) = lex(file, text);
    let mut known = Known::default();
    for (at, token) in tokens.iter().enumerate().filter(|(_, token)| token.kind == TokenKind::ParenOpen) {
        let name = at.checked_sub(1).and_then(|at| tokens.get(at)).filter(|name| name.kind == TokenKind::Name);
        if let Some(name) = name
            && range.contains(&(token.start as usize))
        {
            found.extend(arguments(world, file, &tokens, at, *name, &mut known));
        }
    }
    found.retain(|hint| range.start <= hint.offset && hint.offset <= range.end);
    found.sort_by_key(|hint| hint.offset);
    found
}

/// What is called by a name behind another, found once.
type Known = FxHashMap<(String, String, bool), (Vec<Callable>, bool)>;

/// The names of the bare numbers of a call whose bracket is the token at an index.
fn arguments(world: &World, file: FileId, tokens: &[Token], open: usize, name: Token, known: &mut Known) -> Vec<Hint> {
    let after_dot = open.checked_sub(2).and_then(|at| tokens.get(at)).is_some_and(|token| token.kind == TokenKind::Dot);
    let import = open.checked_sub(3).and_then(|at| tokens.get(at)).filter(|token| after_dot && token.kind == TokenKind::Name);
    // Where each argument begins and ends.
    let (mut depth, mut starts, mut close) = (0usize, vec![open + 1], None);
    for (at, token) in tokens.iter().enumerate().skip(open + 1) {
        match token.kind {
            TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen => depth += 1,
            TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose if depth == 0 => {
                close = Some(at);
                break;
            }
            TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => depth -= 1,
            TokenKind::Comma if depth == 0 => starts.push(at + 1),
            _ => {}
        }
    }
    let Some(close) = close.filter(|_| starts.len() > 1) else { return Vec::new() };
    let call = Call {
        name: name.start as usize..name.end as usize,
        after_dot,
        before_dot: import.map(|token| token.start as usize..token.end as usize),
        before_is_after_dot: import.is_some() && open.checked_sub(4).and_then(|at| tokens.get(at)).is_some_and(|token| token.kind == TokenKind::Dot),
        commas: 0,
        label: None,
        labels: Vec::new(),
    };
    let text = world.text(file);
    let key = (name.text(text).to_owned(), import.map_or("", |token| token.text(text)).to_owned(), call.before_is_after_dot);
    let known = known.entry(key).or_insert_with(|| callables(world, file, &call));
    let (known, has_receiver) = (&known.0, known.1);
    let Some(callable) = known.iter().find(|callable| takes(callable, starts.len(), has_receiver)) else { return Vec::new() };
    let ends = starts.iter().skip(1).map(|start| start - 1).chain([close]);
    let bare = |token: &Token| matches!(token.kind, TokenKind::Int | TokenKind::Float | TokenKind::Angle | TokenKind::Length);
    let mut found = Vec::new();
    for ((start, end), parameter) in starts.iter().zip(ends).zip(callable.written(has_receiver)) {
        let sign = tokens.get(*start).is_some_and(|token| token.kind == TokenKind::Minus);
        let only = tokens.get(start + usize::from(sign)).filter(|token| bare(token) && start + usize::from(sign) + 1 == end);
        if let (Some(_), Some(first)) = (only, tokens.get(*start))
            && parameter.name.len() > 1
        {
            found.push(Hint { offset: first.start as usize, label: format!("{}:", parameter.name), text: String::new(), is_argument: true });
        }
    }
    found
}

/// Whether so many arguments are those of a call, each in its place: a vector may be given by its components.
fn takes(callable: &Callable, count: usize, has_receiver: bool) -> bool {
    let written = callable.written(has_receiver);
    let needed = written.iter().filter(|parameter| !parameter.optional).count();
    callable.kind.is_some() && (needed..=written.len()).contains(&count)
}
