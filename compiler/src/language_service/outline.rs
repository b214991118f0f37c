//! What a text declares, as a tree, and what of it can be folded.

use super::world::World;
use crate::program::blocks::block_words;
use crate::source::{FileId, Span};
use crate::syntax::ast::{Expr, ExprKind, FunctionKind, Item, ItemKind, Let};
use crate::syntax::lexer::{Token, TokenKind, lex};

/// What an entry of an outline is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OutlineKind {
    /// An import.
    Import,
    /// A slider.
    Slider,
    /// A `let`.
    Constant,
    /// A material.
    Material,
    /// A formula or a shape.
    Shape,
    /// A deformation, a combination or a function of numbers.
    Function,
    /// The scene.
    Scene,
    /// A camera, a light and the like.
    Block,
    /// A key of a block or a material.
    Key,
}

/// An entry of an outline.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Its name.
    pub name: String,
    /// What stands beside the name: parameters, or the word that declares it.
    pub detail: String,
    /// What it is.
    pub kind: OutlineKind,
    /// All of it.
    pub whole: Span,
    /// Its name.
    pub at: Span,
    /// What is declared within it.
    pub within: Vec<Outline>,
}

/// A part of a text that can be folded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fold {
    /// All of it, its brackets or marks too.
    pub span: Span,
    /// Whether it is a comment.
    pub is_comment: bool,
    /// Whether it is a group of imports.
    pub is_imports: bool,
}

/// What a text declares.
pub fn outline(world: &World, file: FileId) -> Vec<Outline> {
    let Some(tree) = world.tree(file) else { return Vec::new() };
    World::with_room(|| tree.items.iter().filter_map(|item| entry(world, item)).collect())
}

/// What all texts of a world but the prelude declare, of those whose names hold all letters of `query` in their order, in upper or lower case.
pub fn workspace_outline(world: &World, query: &str) -> Vec<Outline> {
    let holds = |name: &str| {
        let mut letters = name.chars().map(|c| c.to_ascii_lowercase());
        query.chars().map(|c| c.to_ascii_lowercase()).all(|wanted| letters.any(|c| c == wanted))
    };
    let paths: Vec<&str> = world.paths().collect();
    let files = paths.into_iter().filter_map(|path| world.file(path));
    let named = files.flat_map(|file| outline(world, file)).filter(|entry| !matches!(entry.kind, OutlineKind::Import) && holds(&entry.name));
    named.map(|entry| Outline { within: Vec::new(), ..entry }).collect()
}

fn entry(world: &World, item: &Item) -> Option<Outline> {
    let text = |span: Span| world.texts.sources.text(span).to_owned();
    let parameters = |end: u32, start: u32| {
        let between = world.texts.sources.text(Span { file: item.span.file, start: end, end: start.max(end) });
        between.split(['=', '{']).next().unwrap_or("").split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let entries = |entries: &[crate::syntax::ast::Entry]| -> Vec<Outline> {
        let key = |entry: &crate::syntax::ast::Entry| Outline {
            name: entry.key.text.to_string(),
            detail: String::new(),
            kind: OutlineKind::Key,
            whole: entry.key.span.to(entry.value.span),
            at: entry.key.span,
            within: Vec::new(),
        };
        entries.iter().filter(|entry| !entry.key.text.is_empty()).map(key).collect()
    };
    let (name, at, detail, kind, within) = match &item.kind {
        ItemKind::Import { path, path_span, alias } => {
            let name = alias.as_ref().map_or(path.clone(), |alias| alias.text.to_string());
            (name, alias.as_ref().map_or(*path_span, |alias| alias.span), "import".to_owned(), OutlineKind::Import, Vec::new())
        }
        ItemKind::Param { name, value, .. } => (name.text.to_string(), name.span, format!("param = {}", text(value.span)), OutlineKind::Slider, Vec::new()),
        ItemKind::Let(l) => {
            let (name, value) = l.bindings.first()?;
            (name.text.to_string(), name.span, "let".to_owned(), OutlineKind::Constant, lets_of(value))
        }
        ItemKind::Function(function) => {
            let kind = match function.kind {
                FunctionKind::Field | FunctionKind::Field2 | FunctionKind::Shape | FunctionKind::Shape2 => OutlineKind::Shape,
                _ => OutlineKind::Function,
            };
            let end = function.claim.as_ref().map_or(function.body.span.start, |claim| claim.span.start);
            (function.name.text.to_string(), function.name.span, parameters(function.name.span.end, end), kind, lets_of(&function.body))
        }
        ItemKind::Material { name, lets, entries: all, .. } => {
            let mut within: Vec<Outline> = lets.iter().filter_map(of_let).collect();
            within.extend(entries(all));
            (name.text.to_string(), name.span, parameters(name.span.end, item.span.end), OutlineKind::Material, within)
        }
        ItemKind::Scene(value) => {
            let at = Span { end: (item.span.start + "scene".len() as u32).min(item.span.end), ..item.span };
            ("scene".to_owned(), at, String::new(), OutlineKind::Scene, lets_of(value))
        }
        ItemKind::Block { kind, kind_span, name, entries: all, .. } => {
            let word = block_words(*kind);
            let shown = name.as_ref().map_or(word.to_owned(), |name| name.text.to_string());
            let at = name.as_ref().map_or(*kind_span, |name| name.span);
            let detail = if name.is_some() { word.to_owned() } else { String::new() };
            (shown, at, detail, OutlineKind::Block, entries(all))
        }
    };
    (!name.is_empty()).then_some(Outline { name, detail, kind, whole: item.span.to(at), at, within })
}

fn of_let(l: &Let) -> Option<Outline> {
    let (name, _) = l.bindings.first().filter(|(name, _)| !name.text.is_empty())?;
    Some(Outline { name: name.text.to_string(), detail: "let".to_owned(), kind: OutlineKind::Constant, whole: l.span.to(name.span), at: name.span, within: Vec::new() })
}

/// The names of a block that is the value of a declaration.
fn lets_of(value: &Expr) -> Vec<Outline> {
    match &value.kind {
        ExprKind::Block(lets, _) => lets.iter().filter_map(of_let).collect(),
        ExprKind::Paren(inner) => lets_of(inner),
        _ => Vec::new(),
    }
}

/// What of a text can be folded: brackets, comments and imports that go over several lines. In the order of their places.
pub fn folds(text: &str, file: FileId) -> Vec<Fold> {
    let (tokens, _) = lex(file, text);
    let lines = |start: u32, end: u32| text.get(start as usize..end as usize).is_some_and(|part| part.contains('\n'));
    let mut folds = Vec::new();
    let mut open: Vec<Token> = Vec::new();
    let mut comment: Option<(Token, Token)> = None;
    let mut imports: Option<(Token, Token)> = None;
    let end = |run: &mut Option<(Token, Token)>, is_comment: bool, folds: &mut Vec<Fold>| {
        if let Some((first, last)) = run.take()
            && lines(first.start, last.end)
        {
            folds.push(Fold { span: first.span(file).to(last.span(file)), is_comment, is_imports: !is_comment });
        }
    };
    let mut before: Option<Token> = None;
    for token in &tokens {
        let is_line = matches!(token.kind, TokenKind::LineComment | TokenKind::Doc | TokenKind::FileDoc);
        match (&mut comment, is_line) {
            // Comments in lines after each other are one.
            (Some((_, last)), true) if text.get(last.end as usize..token.start as usize).is_some_and(|gap| gap.matches('\n').count() == 1) => *last = *token,
            _ => {
                end(&mut comment, true, &mut folds);
                if is_line {
                    comment = Some((*token, *token));
                }
            }
        }
        match token.kind {
            TokenKind::BlockComment => {
                let mut run = Some((*token, *token));
                end(&mut run, true, &mut folds);
            }
            TokenKind::ParenOpen | TokenKind::BracketOpen | TokenKind::BraceOpen => open.push(*token),
            TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => {
                if let Some(first) = open.pop()
                    && lines(first.start, token.end)
                {
                    folds.push(Fold { span: first.span(file).to(token.span(file)), is_comment: false, is_imports: false });
                }
            }
            TokenKind::Str if before.is_some_and(|t| t.text(text) == "import") => match &mut imports {
                Some((_, last)) => *last = *token,
                None => imports = before.map(|first| (first, *token)),
            },
            TokenKind::Name if before.is_some_and(|t| t.text(text) == "as") => {
                if let Some((_, last)) = &mut imports {
                    *last = *token;
                }
            }
            TokenKind::Name if token.text(text) != "import" && token.text(text) != "as" => {
                end(&mut imports, false, &mut folds);
            }
            _ => {}
        }
        if !is_line {
            before = Some(*token);
        }
    }
    end(&mut comment, true, &mut folds);
    end(&mut imports, false, &mut folds);
    folds.sort_by_key(|fold| (fold.span.start, fold.span.end));
    folds
}
