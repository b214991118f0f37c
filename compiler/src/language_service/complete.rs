//! What may be written at a place.

use super::callable::{Callable, text_of};
use super::manual;
use super::place::{Open, Place, Within};
use super::texts::Texts;
use super::walk::{AtCaret, CARET, Meaning, at_caret, meaning_of, type_of_item};
use super::world::World;
use crate::loader::Loader;
use crate::program::blocks::keys;
use crate::program::builtin::{FUNCTIONS, NAMES, OF_PRELUDE};
use crate::program::load::{ItemRef, Resolution, item_name, join};
use crate::program::material;
use crate::source::{FileId, Span};
use crate::syntax::ast::{BlockKind, ItemKind, Type};
use crate::syntax::words;

/// What a completion is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CompletionKind {
    /// A name with a meaning.
    Name(Meaning),
    /// The name of an argument in a call.
    Argument,
    /// A word of the language.
    Keyword,
    /// A type.
    Type,
    /// A path of a file.
    File,
}

/// Something that may be written.
#[derive(Clone, Debug, PartialEq)]
pub struct Completion {
    /// What it is called in a list.
    pub label: String,
    /// What it is.
    pub kind: CompletionKind,
    /// How it is called, or its type; empty where that says nothing.
    pub signature: String,
    /// What it does, as Markdown.
    pub text: String,
    /// What is written in place of [`Completion::span`].
    pub insert: String,
    /// The same for editors that step through places: `sphere(${1:radius})`. None where there are no places.
    pub snippet: Option<String>,
    /// What it replaces: the word at the place, or nothing.
    pub span: Span,
    /// What is likely stands first: lists are in the order of this, then of labels.
    pub rank: u8,
}

/// A text with a name in place of the word at the caret, so that there is something to read.
struct WithCaret<'l> {
    loader: &'l dyn Loader,
    path: &'l str,
    text: String,
}

impl Loader for WithCaret<'_> {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        if path == self.path { Ok(self.text.clone().into_bytes()) } else { self.loader.read(path) }
    }
}

/// What may be written at a byte of a text, what is likely first. `loader` reads what the text imports; `files` are the paths of texts that it may import.
pub fn complete(world: &World, loader: &dyn Loader, file: FileId, offset: usize, files: &[&str]) -> Vec<Completion> {
    let text = world.text(file);
    if !text.is_char_boundary(offset) {
        return Vec::new();
    }
    let place = Place::new(text, offset);
    let mut list = List { world, file, span: Span::new(file, place.word.start, place.word.end), found: Vec::new() };
    match &place.within {
        Within::Comment | Within::Literal => {}
        Within::Text(range, true) => list.paths(range.start + 1, range.end, offset, files),
        Within::Text(..) => {}
        Within::Code if place.at_type(text) => list.types(),
        Within::Code if place.at_top(text) => list.declarations(),
        Within::Code => match place.at_key() {
            Some(kind) => list.keys(kind),
            None => list.values(&place, loader, text),
        },
    }
    let mut found = list.found;
    found.sort_by(|a, b| (a.rank, &a.label).cmp(&(b.rank, &b.label)));
    found.dedup_by(|a, b| a.label == b.label && a.kind == b.kind);
    found
}

struct List<'w> {
    world: &'w World,
    file: FileId,
    span: Span,
    found: Vec<Completion>,
}

impl List<'_> {
    fn add(&mut self, label: &str, kind: CompletionKind, signature: impl Into<String>, text: impl Into<String>, rank: u8) -> &mut Self {
        self.found.push(Completion {
            label: label.to_owned(),
            kind,
            signature: signature.into(),
            text: text.into(),
            insert: label.to_owned(),
            snippet: None,
            span: self.span,
            rank,
        });
        self
    }

    /// What is written is another text than the label.
    fn inserts(&mut self, insert: impl Into<String>, snippet: Option<String>) {
        if let Some(last) = self.found.last_mut() {
            last.insert = insert.into();
            last.snippet = snippet;
        }
    }

    fn paths(&mut self, start: usize, end: usize, offset: usize, files: &[&str]) {
        let world = self.world;
        let text = world.text(self.file);
        // The closing quote stays, where there is one.
        let closed = text.get(start..end).is_some_and(|inside| inside.ends_with('"'));
        self.span = Span::new(self.file, start.min(offset), (end - usize::from(closed)).max(offset));
        let own = world.path(self.file);
        for path in files.iter().filter(|path| **path != own) {
            let relative = relative(own, path);
            if join(own, &relative) == **path {
                self.add(&relative, CompletionKind::File, "", "", 0);
            }
        }
    }

    fn types(&mut self) {
        for ty in words::TYPES {
            self.add(ty, CompletionKind::Type, "", "", 0);
        }
    }

    fn declarations(&mut self) {
        for word in words::DECLARATIONS {
            let snippet = match *word {
                "import" => "import \"${1:parts/file.sdf}\"",
                "param" => "param ${1:name} = ${2:1} in ${3:0}..${4:2}",
                "let" => "let ${1:name} = ${2:1}",
                "field" | "shape" | "shape2" | "field2" | "warp" | "warp2" | "fn" => "WORD ${1:name}(${2}) = ${3}",
                "blend" => "blend ${1:name}(a, b, ${2:k: float}) = ${3:min(a, b)}",
                "material" => "material ${1:name} { color: ${2:#d4af37}, roughness: ${3:0.5} }",
                "scene" => "scene = ${1:sphere(1)}",
                "mesh" => "mesh ${1:name} \"${2:file.obj}\" { ${3} }",
                "balls" | "light" => "WORD ${1:name} { ${2} }",
                _ => "WORD { ${1} }",
            };
            self.add(word, CompletionKind::Keyword, "", manual::of_keyword(word).unwrap_or_default(), 0);
            self.inserts(*word, Some(snippet.replace("WORD", word)));
        }
    }

    fn keys(&mut self, kind: Option<BlockKind>) {
        let known = kind.map_or(&material::KEYS[..], keys);
        for key in known {
            self.add(key, CompletionKind::Name(Meaning::Key), "", manual::of_key(kind, key).unwrap_or_default(), 0);
            self.inserts(format!("{key}: "), None);
        }
        if kind.is_none() {
            self.add("let", CompletionKind::Keyword, "", manual::of_keyword("let").unwrap_or_default(), 1);
        }
    }

    fn values(&mut self, place: &Place, loader: &dyn Loader, text: &str) {
        let Some(at) = self.known_at_caret(place, loader, text) else { return };
        match (&at.receiver, at.import) {
            (receiver, Some(module)) => {
                let after_dot = receiver.is_some();
                for (item, _) in self.world.texts.modules.items(module) {
                    self.item(item, after_dot, 0);
                }
            }
            (Some(receiver), None) => self.members(receiver.as_ref()),
            (None, None) => {
                self.arguments(place, text);
                self.names(&at, place, text);
            }
        }
    }

    /// What is known at the caret, which is found in a text that has a name there.
    fn known_at_caret(&self, place: &Place, loader: &dyn Loader, text: &str) -> Option<AtCaret> {
        let with = format!("{}{CARET}{}", text.get(..place.word.start)?, text.get(place.word.end..)?);
        let path = self.world.path(self.file);
        let texts = Texts::read(&WithCaret { loader, path, text: with }, &[path]);
        let module = texts.modules.of_path(path)?;
        let found = World::with_room(|| at_caret(&texts, module));
        // A dot whose receiver can't be read has no members that are known; what is read as a declaration has no place.
        let after_dot = place.kind_back(0) == Some(crate::syntax::lexer::TokenKind::Dot);
        found.or_else(|| Some(AtCaret { receiver: after_dot.then_some(None), point: 3, ..AtCaret::default() }))
    }

    /// The names of the arguments of the call around the caret, as far as they are not written yet.
    fn arguments(&mut self, place: &Place, text: &str) {
        if !matches!(place.open, Some(Open::Call(_))) {
            return;
        }
        let Some(call) = place.call(text).filter(|call| call.label.is_none()) else { return };
        let taken: Vec<&str> = call.labels.iter().filter_map(|range| text.get(range.clone())).collect();
        let (known, has_receiver) = super::signature::callables(self.world, self.file, &call);
        for callable in known {
            for parameter in callable.written(has_receiver) {
                if !taken.contains(&parameter.name.as_str()) && callable.kind.is_some() {
                    let label = format!("{}:", parameter.name);
                    self.add(&label, CompletionKind::Argument, parameter.text.clone(), "", 1);
                    self.inserts(format!("{label} "), None);
                }
            }
        }
    }

    fn names(&mut self, at: &AtCaret, place: &Place, text: &str) {
        if let Some((kind, key)) = place.value_of(text) {
            for value in manual::values_of(kind, key) {
                self.add(value, CompletionKind::Name(Meaning::Word), "", "", 0);
            }
        }
        let mut hidden: Vec<&str> = Vec::new();
        for local in at.locals.iter().rev() {
            if !hidden.contains(&&*local.name) && &*local.name != CARET {
                hidden.push(&local.name);
                let ty = local.ty.as_ref().map_or(String::new(), Type::name);
                self.add(&local.name, CompletionKind::Name(local.meaning), ty, "", 0);
            }
        }
        let world = self.world;
        let Some(module) = world.texts.modules.of_file(self.file) else { return };
        for name in world.texts.modules.visible(module) {
            if hidden.contains(&name) {
                continue;
            }
            match world.texts.modules.resolve(module, name) {
                Resolution::Items(items) => {
                    for item in items {
                        let rank = if world.texts.modules.is_prelude(item.module) { 3 } else { 2 };
                        self.item(*item, false, rank);
                    }
                }
                _ if world.texts.modules.alias(module, name).is_some() => {
                    self.add(name, CompletionKind::Name(Meaning::Import), "", "", 2);
                }
                _ => {}
            }
        }
        for name in NAMES {
            let exists = match *name {
                "p" | "world" => at.point > 0,
                "normal" => at.normal,
                _ => true,
            };
            if exists {
                self.add(name, CompletionKind::Name(Meaning::Value), "", manual::of_value(name).unwrap_or_default(), 3);
            }
        }
        for name in FUNCTIONS.iter().filter(|name| !OF_PRELUDE.contains(name)) {
            self.callable(&Callable::built_in(name), false, 4);
        }
        for word in words::EXPRESSIONS.iter().filter(|word| !NAMES.contains(word)) {
            let snippet = match *word {
                "for" => Some("for ${1:i} in ${2:0..6} { ${3} }".to_owned()),
                "if" => Some("if ${1:condition} { ${2} } else { ${3} }".to_owned()),
                _ => None,
            };
            self.add(word, CompletionKind::Keyword, "", manual::of_keyword(word).unwrap_or_default(), 5);
            self.inserts(*word, snippet);
        }
    }

    fn members(&mut self, receiver: Option<&Type>) {
        if let Some(Type::Vec(_) | Type::Color) = receiver {
            let count = if let Some(Type::Vec(n)) = receiver { usize::from(*n) } else { 3 };
            for letter in ["x", "y", "z", "w"].iter().take(count) {
                self.add(letter, CompletionKind::Name(Meaning::Component), "float", "", 0);
            }
        }
        if let Some(Type::List(_)) = receiver {
            self.add("count", CompletionKind::Name(Meaning::Component), "int", "How many the list has.", 0);
        }
        let world = self.world;
        let Some(module) = world.texts.modules.of_file(self.file) else { return };
        for name in world.texts.modules.visible(module) {
            if let Resolution::Items(items) = world.texts.modules.resolve(module, name) {
                for item in items {
                    let Some(callable) = Callable::of_item(world, *item) else { continue };
                    if receiver.is_none_or(|receiver| callable.takes(receiver)) && callable.meaning != Meaning::Material {
                        let rank = if world.texts.modules.is_prelude(item.module) { 2 } else { 1 };
                        self.callable(&callable, true, rank);
                    }
                }
            } else if world.texts.modules.alias(module, name).is_some() && !matches!(receiver, Some(Type::Vec(_) | Type::Float | Type::Int)) {
                self.add(name, CompletionKind::Name(Meaning::Import), "", "", 3);
            }
        }
        for name in FUNCTIONS.iter().filter(|name| !OF_PRELUDE.contains(name) && !matches!(**name, "grid" | "polar" | "mesh_field" | "text" | "path" | "svg" | "shader")) {
            let callable = Callable::built_in(name);
            if receiver.is_none_or(|receiver| callable.takes(receiver)) {
                self.callable(&callable, true, if matches!(receiver, Some(Type::Shape | Type::Shape2)) { 1 } else { 3 });
            }
        }
    }

    /// A declaration of a text.
    fn item(&mut self, item: ItemRef, after_dot: bool, rank: u8) {
        if let Some(callable) = Callable::of_item(self.world, item) {
            return self.callable(&callable, after_dot, rank);
        }
        let world = self.world;
        let Some(declared) = world.texts.modules.item(item).filter(|item| matches!(item.kind, ItemKind::Param { .. } | ItemKind::Let(_))) else { return };
        let Some(name) = item_name(declared) else { return };
        let ty = type_of_item(&world.texts, item).map_or(String::new(), |ty| ty.name());
        let text = text_of(world, item, declared);
        self.add(&name.text, CompletionKind::Name(meaning_of(declared)), ty, text, rank);
    }

    fn callable(&mut self, callable: &Callable, after_dot: bool, rank: u8) {
        let signature = [callable.word, &callable.signature(after_dot)].join(" ").trim_start().to_owned();
        let needed: Vec<String> = callable
            .written(after_dot)
            .iter()
            .filter(|parameter| !parameter.optional)
            .enumerate()
            .map(|(at, parameter)| format!("${{{}:{}}}", at + 1, parameter.name))
            .collect();
        let snippet = match (needed.is_empty(), callable.written(after_dot).is_empty()) {
            (false, _) => Some(format!("{}({})", callable.name, needed.join(", "))),
            _ => None,
        };
        self.add(&callable.name, CompletionKind::Name(callable.meaning), signature, callable.text.clone(), rank);
        self.inserts(callable.name.clone(), snippet);
    }
}

/// A path as it is written in the text at another: relative to its folder.
fn relative(from: &str, to: &str) -> String {
    let folders: Vec<&str> = from.split('/').collect();
    let folders = folders.get(..folders.len() - 1).unwrap_or(&[]);
    let parts: Vec<&str> = to.split('/').collect();
    let common = folders.iter().zip(parts.get(..parts.len() - 1).unwrap_or(&[])).take_while(|(a, b)| a == b).count();
    let ups = folders.len() - common;
    let rest = parts.get(common..).unwrap_or(&[]).join("/");
    format!("{}{rest}", "../".repeat(ups))
}

#[cfg(test)]
mod tests {
    use super::relative;

    #[test]
    fn paths_are_relative_to_the_folder() {
        assert_eq!(relative("/a/b/main.sdf", "/a/b/parts/x.sdf"), "parts/x.sdf");
        assert_eq!(relative("/a/b/main.sdf", "/a/x.sdf"), "../x.sdf");
        assert_eq!(relative("main.sdf", "x.sdf"), "x.sdf");
    }
}
