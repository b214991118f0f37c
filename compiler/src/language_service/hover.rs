//! What a name is, in words.

use super::callable::{Callable, text_of};
use super::examine::FactorAt;
use super::manual;
use super::walk::{Meaning, Symbol, Use};
use super::world::World;
use crate::prelude::in_prelude;
use crate::program::blocks::block_words;
use crate::program::load::item_name;
use crate::source::{FileId, Span};
use crate::syntax::ast::{Item, ItemKind};
use crate::syntax::lexer::{TokenKind, lex};

/// What is said of a place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hover {
    /// What it is said of.
    pub span: Option<Span>,
    /// How it is declared or called, each on a line of the language.
    pub code: Vec<String>,
    /// What it is, as Markdown.
    pub text: String,
    /// What is known of its factors, as lines of Markdown.
    pub factors: Vec<String>,
}

impl Hover {
    /// All of it as Markdown.
    pub fn markdown(&self) -> String {
        let mut parts = Vec::new();
        if !self.code.is_empty() {
            parts.push(format!("```sdf\n{}\n```", self.code.join("\n")));
        }
        if !self.text.is_empty() {
            parts.push(self.text.clone());
        }
        parts.extend(self.factors.iter().cloned());
        parts.join("\n\n")
    }
}

/// What is said of a byte of a text. `factors` are those of the newest compilation of this very text; without one there are none.
pub fn hover(world: &World, factors: &[FactorAt], file: FileId, offset: usize) -> Option<Hover> {
    let mut said = match world.use_at(file, offset) {
        Some(found) => of_use(world, found),
        None => of_word(world, file, offset)?,
    };
    let at = said.span?;
    for factor in factors.iter().filter(|factor| factor.path == world.path(file) && holds(world, factor, at)) {
        said.factors.push(factor.markdown());
    }
    Some(said)
}

/// Whether a factor is that of a name: its term begins with the name, or ends with it where that is all there is.
fn holds(world: &World, factor: &FactorAt, at: Span) -> bool {
    let text = world.text(at.file).get(factor.range.clone()).unwrap_or("");
    let name = world.texts.sources.text(at);
    factor.range.start == at.start as usize && text.starts_with(name)
}

fn of_use(world: &World, found: &Use) -> Hover {
    let mut said = Hover { span: Some(found.span), ..Hover::default() };
    let name = world.texts.sources.text(found.span).to_owned();
    let ty = found.ty.as_ref().map_or(String::new(), |ty| format!(": {}", ty.name()));
    match &found.symbol {
        Symbol::Declared(span) => match declared(world, *span) {
            Some((item, whole)) if item_name(whole).is_some_and(|name| name.span == *span) => of_item(world, item, whole, found, &mut said),
            _ => {
                let what = match found.meaning {
                    Meaning::Parameter => "parameter",
                    Meaning::Import => "import",
                    Meaning::Block => "block",
                    _ => "let",
                };
                let ty = match parameter_text(world, *span) {
                    Some(written) => format!("{what} {written}"),
                    None => format!("{what} {name}{ty}"),
                };
                said.code.push(ty);
            }
        },
        Symbol::Prelude(name) => {
            let mut texts: Vec<String> = Vec::new();
            for item in world.texts.modules.own(world.texts.modules.prelude(), name).iter().filter(|item| found.overload.is_none_or(|meant| meant == **item)) {
                let Some(callable) = Callable::of_item(world, *item) else { continue };
                said.code.push(format!("{} {}", callable.word, callable.signature(found.after_dot)));
                if !texts.contains(&callable.text) {
                    texts.push(callable.text);
                }
            }
            said.text = texts.join("\n\n---\n\n");
        }
        Symbol::BuiltIn(name) => match manual::of_value(name) {
            Some(text) => {
                said.code.push(format!("{name}{ty}"));
                said.text = text.to_owned();
            }
            None => {
                let callable = Callable::built_in(name);
                let result = found.ty.as_ref().map_or(String::new(), |ty| format!(" → {}", ty.name()));
                said.code.push(format!("{}{result}", callable.signature(found.after_dot)));
                said.text = callable.text;
            }
        },
        Symbol::Key(kind, key) => {
            said.code.push(format!("{} {{ {key} }}", kind.map_or("material", block_words)));
            said.text = manual::of_key(*kind, key).unwrap_or_default();
        }
        Symbol::Component => said.code.push(format!("{name}{ty}")),
        Symbol::File(module) => {
            said.code.push(format!("import \"{}\"", world.texts.modules.path(*module)));
            said.text = world.texts.modules.tree(*module).and_then(|tree| tree.doc.clone()).unwrap_or_default();
        }
        Symbol::Word => said.text = manual::of_keyword(&name).unwrap_or_default(),
    }
    said
}

/// The declaration of a text in which a name stands.
fn declared(world: &World, name: Span) -> Option<(crate::program::load::ItemRef, &Item)> {
    let module = world.texts.modules.of_file(name.file)?;
    world.texts.modules.items(module).find(|(_, item)| item.span.file == name.file && item.span.start <= name.start && name.end <= item.span.end)
}

/// A parameter of a declaration as it is written.
fn parameter_text(world: &World, name: Span) -> Option<String> {
    let (_, item) = declared(world, name)?;
    let parameter = super::walk::parameters_of(item).iter().find(|parameter| parameter.name.span == name)?;
    let ends = [Some(name.end), parameter.ty.as_ref().map(|(_, span)| span.end), parameter.default.as_ref().map(|value| value.span.end)];
    let whole = Span { end: ends.into_iter().flatten().max()?, ..name };
    Some(world.texts.sources.text(whole).split_whitespace().collect::<Vec<_>>().join(" "))
}

fn of_item(world: &World, item: crate::program::load::ItemRef, whole: &Item, found: &Use, said: &mut Hover) {
    let code = match &whole.kind {
        // A slider is known by its line: value, range and description.
        ItemKind::Param { .. } => one_line(world.texts.sources.text(whole.span)),
        ItemKind::Let(_) => {
            let ty = found.ty.as_ref().map_or(String::new(), |ty| format!(": {}", ty.name()));
            format!("let {}{ty}", world.texts.sources.text(found.span))
        }
        _ => Callable::of_item(world, item).map_or(String::new(), |callable| {
            // A deformation stands behind a dot.
            let after_dot = callable.meaning == Meaning::Warp;
            let result = match (callable.meaning, &callable.result) {
                (Meaning::Function, Some(ty)) => format!(" → {}", ty.name()),
                _ => String::new(),
            };
            format!("{} {}{result}", callable.word, callable.signature(after_dot))
        }),
    };
    said.code.push(code);
    said.text = text_of(world, item, whole);
    let path = world.path(whole.span.file);
    if whole.span.file != found.span.file && !in_prelude(whole.span) {
        let from = format!("Declared in `{path}`.");
        said.text = if said.text.is_empty() { from } else { format!("{}\n\n{from}", said.text) };
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A word of the language, a colour or a type.
fn of_word(world: &World, file: FileId, offset: usize) -> Option<Hover> {
    let text = world.text(file);
    let (tokens, _) = lex(file, text);
    let token = tokens.iter().find(|token| token.start as usize <= offset && offset <= token.end as usize && matches!(token.kind, TokenKind::Name | TokenKind::Color))?;
    let word = token.text(text);
    let span = token.span(file);
    if token.kind == TokenKind::Color {
        let bytes = crate::syntax::literals::read_color(word)?;
        let linear = bytes.map(|byte| crate::srgb::decode(f64::from(byte) / 255.0)).map(|c| format!("{c:.3}"));
        let text = format!("sRGB {}, {}, {}; linear ({})", bytes[0], bytes[1], bytes[2], linear.join(", "));
        return Some(Hover { span: Some(span), code: vec![word.to_owned()], text, factors: Vec::new() });
    }
    let text = manual::of_keyword(word)?;
    Some(Hover { span: Some(span), code: Vec::new(), text, factors: Vec::new() })
}
