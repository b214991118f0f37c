//! Where names are declared, and where they are used.

use super::walk::{Symbol, Use};
use super::world::World;
use crate::program::load::item_name;
use crate::source::{FileId, Span};

/// Where a name is declared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Definition {
    /// The name from which one goes.
    pub from: Span,
    /// The name where it is declared, in a text of a person or of the prelude; the first byte of a text that is imported.
    pub name: Span,
    /// All of the declaration.
    pub whole: Span,
}

/// A place where something is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reference {
    /// The name.
    pub span: Span,
    /// Whether it declares what it names.
    pub declares: bool,
}

/// Where the name at a byte of a text is declared: once, or as often as it has overloads. Nowhere where it is built in.
pub fn definition(world: &World, file: FileId, offset: usize) -> Vec<Definition> {
    let Some(found) = world.use_at(file, offset) else { return Vec::new() };
    let at = |name: Span| Definition { from: found.span, name, whole: whole(world, name) };
    match &found.symbol {
        Symbol::Declared(name) => vec![at(*name)],
        Symbol::Prelude(name) => {
            let items = world.texts.modules.own(world.texts.modules.prelude(), name);
            let meant = items.iter().filter(|item| found.overload.is_none_or(|meant| meant == **item));
            meant.filter_map(|item| item_name(world.texts.modules.item(*item)?)).map(|name| at(name.span)).collect()
        }
        Symbol::File(module) => vec![at(world.texts.modules.head(*module))],
        _ => Vec::new(),
    }
}

/// All of the declaration around a name.
fn whole(world: &World, name: Span) -> Span {
    let Some(module) = world.texts.modules.of_file(name.file) else { return name };
    let mut items = world.texts.modules.items(module).map(|(_, item)| item.span);
    items.find(|span| span.file == name.file && span.start <= name.start && name.end <= span.end).unwrap_or(name)
}

/// Every place, in all texts but the prelude, that names what is named at a byte of a text; in the order of texts and places.
pub fn references(world: &World, file: FileId, offset: usize) -> Vec<Reference> {
    let Some(found) = world.use_at(file, offset) else { return Vec::new() };
    of_symbol(world, &found.symbol).map(|found| Reference { span: found.span, declares: found.declares }).collect()
}

/// Every place that names a symbol. What stands for nothing alone, as a component, has none.
pub(super) fn of_symbol<'w>(world: &'w World, symbol: &'w Symbol) -> impl Iterator<Item = &'w Use> {
    let stands = !matches!(symbol, Symbol::Component | Symbol::Word);
    world.all_uses().filter(move |found| stands && found.symbol == *symbol)
}
