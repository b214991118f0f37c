//! Other names: checked, so that no name changes its meaning.

use super::navigate::of_symbol;
use super::walk::{Symbol, Use};
use super::world::World;
use crate::diagnostic::{Code, Edit};
use crate::loader::Loader;
use crate::prelude::in_prelude;
use crate::program::load::{ItemRef, Resolution, item_name};
use crate::source::{FileId, Span};
use crate::syntax::ast::{Item, ItemKind};
use crate::syntax::words;

/// The name at a byte of a text that can be given another name, or why there is none.
pub fn prepare_rename(world: &World, file: FileId, offset: usize) -> Result<Span, String> {
    declared_at(world, file, offset).map(|(found, _)| found.span)
}

fn declared_at(world: &World, file: FileId, offset: usize) -> Result<(&Use, Span), String> {
    let found = world.use_at(file, offset).ok_or("there is no name here")?;
    match &found.symbol {
        Symbol::Declared(span) if in_prelude(*span) => Err("this name comes with the language".to_owned()),
        Symbol::Declared(span) => Ok((found, *span)),
        Symbol::Prelude(_) | Symbol::BuiltIn(_) | Symbol::Key(..) => Err("this name comes with the language".to_owned()),
        Symbol::Component => Err("a component has no other name".to_owned()),
        Symbol::File(_) => Err("a path is renamed with its file".to_owned()),
        Symbol::Word => Err("nothing declares this name".to_owned()),
    }
}

/// The edits that give what is named at a byte another name, in every text of the world. Or why they can't be made: the name is none, it is taken, or a name would
/// mean something else afterwards. For that the texts are read again with the edits in them; `loader` reads them as they are.
pub fn rename(world: &World, loader: &dyn Loader, file: FileId, offset: usize, name: &str) -> Result<Vec<Edit>, String> {
    let (_, declared) = declared_at(world, file, offset)?;
    let mut letters = name.chars();
    let is_name = letters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_') && letters.all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !is_name {
        return Err(format!("`{name}` is no name: a name is made of the letters a to z, digits and `_`, and begins with no digit"));
    }
    if words::is_reserved(name) || words::CONTEXTUAL.contains(&name) {
        return Err(format!("`{name}` is a word of the language"));
    }
    if world.texts.sources.text(declared) == name {
        return Ok(Vec::new());
    }
    let symbol = Symbol::Declared(declared);
    let uses: Vec<&Use> = of_symbol(world, &symbol).collect();
    if let Some(taken) = uses.iter().find_map(|found| taken(world, found.span.file, declared, name)) {
        return Err(taken);
    }
    let edits: Vec<Edit> = uses.into_iter().map(|found| Edit { span: found.span, text: name.to_owned() }).collect();
    let edited = Edited { world, loader, edits: &edits };
    let after = World::read(&edited, &world.roots());
    match edited.changed(&after) {
        None => Ok(edits),
        Some(span) => Err(format!("`{name}` would mean something else at {}", place(world, span))),
    }
}

/// A world's texts with edits in them.
struct Edited<'w> {
    world: &'w World,
    loader: &'w dyn Loader,
    /// In the order of their places.
    edits: &'w [Edit],
}

impl Loader for Edited<'_> {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        let Some(file) = self.world.file(path) else { return self.loader.read(path) };
        let mut text = self.world.text(file).to_owned();
        for edit in self.edits.iter().rev().filter(|edit| edit.span.file == file) {
            if text.get(edit.span.range()).is_some() {
                text.replace_range(edit.span.range(), &edit.text);
            }
        }
        Ok(text.into_bytes())
    }
}

impl Edited<'_> {
    /// Where a place is after the edits.
    fn moved(&self, span: Span) -> Span {
        let mut moved = span;
        for edit in self.edits.iter().filter(|edit| edit.span.file == span.file) {
            let more = (edit.text.len() as u32).wrapping_sub(edit.span.end - edit.span.start);
            if edit.span.end <= span.start {
                moved.start = moved.start.wrapping_add(more);
                moved.end = moved.end.wrapping_add(more);
            } else if edit.span.start >= span.start && edit.span.end <= span.end {
                moved.end = moved.end.wrapping_add(more);
            }
        }
        moved
    }

    /// The first name that stands for something else in the texts after the edits.
    fn changed(&self, after: &World) -> Option<Span> {
        let same = |before: &Use, after: &Use| {
            let symbol = match &before.symbol {
                Symbol::Declared(span) => Symbol::Declared(self.moved(*span)),
                other => other.clone(),
            };
            self.moved(before.span) == after.span && symbol == after.symbol
        };
        let (mut old, mut new) = (self.world.all_uses(), after.all_uses());
        loop {
            match (old.next(), new.next()) {
                (None, None) => break,
                (Some(before), Some(found)) if same(before, found) => {}
                (Some(before), _) => return Some(before.span),
                (None, Some(found)) => return Some(found.span),
            }
        }
        // Two parameters of one name.
        let said = after.diagnostics().iter().find(|d| d.code == Code::TwiceDeclared && !self.world.diagnostics().iter().any(|known| self.moved(known.span) == d.span));
        said.map(|d| d.span)
    }
}

fn place(world: &World, span: Span) -> String {
    let (path, line, _) = world.texts.sources.position(span.file, span.start);
    format!("{path}:{line}")
}

/// Why a name can't stand in a text for what is declared at a place, if that is a name of a file: what else has the name there.
fn taken(world: &World, file: FileId, declared: Span, name: &str) -> Option<String> {
    let modules = &world.texts.modules;
    let module = modules.of_file(file)?;
    let is_top = |item: &Item| match &item.kind {
        ItemKind::Import { alias: Some(alias), .. } => alias.span == declared,
        _ => item_name(item).is_some_and(|name| name.span == declared),
    };
    let own = modules.of_file(declared.file)?;
    if !modules.items(own).any(|(_, item)| is_top(item)) {
        return None;
    }
    let import = modules.items(module).find_map(|(_, item)| match &item.kind {
        ItemKind::Import { alias: Some(alias), .. } if &*alias.text == name => Some(alias.span),
        _ => None,
    });
    if let Some(span) = import {
        return Some(format!("`{name}` is the name of an import at {}", place(world, span)));
    }
    let span_of = |item: Option<&ItemRef>| item.and_then(|item| modules.item(*item)).and_then(item_name).map_or(declared, |name| name.span);
    if let Some(item) = modules.own(module, name).first().or_else(|| modules.own(own, name).first()) {
        return Some(format!("`{name}` is declared already at {}", place(world, span_of(Some(item)))));
    }
    match modules.resolve(module, name) {
        Resolution::Items(items) if items.iter().any(|item| !modules.is_prelude(item.module)) => {
            Some(format!("`{name}` is imported already, from {}", place(world, span_of(items.first()))))
        }
        Resolution::Ambiguous(paths) => Some(format!("`{name}` is imported already, from {}", paths.join(" and "))),
        _ => None,
    }
}
