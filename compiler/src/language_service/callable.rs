//! What can be called: its parameters, and what they are for.

use super::manual;
use super::walk::{meaning_of, parameters_of, type_of_item, Meaning};
use super::world::World;
use crate::graph::kernel::KERNEL;
use crate::program::builtin::{argument_names, defaults, Usual};
use crate::program::expression::kind_words;
use crate::program::load::{ItemRef, item_name};
use crate::syntax::ast::{FunctionKind, Item, ItemKind, Type};

/// A parameter of something that is called.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Taken {
    /// Its name.
    pub(super) name: String,
    /// As it is written: `rate: float = 1`.
    pub(super) text: String,
    /// Its type, where it has one.
    pub(super) ty: Option<Type>,
    /// Whether it may be left out.
    pub(super) optional: bool,
}

/// Something that can be called.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Callable {
    pub(super) name: String,
    /// The word that declares it; empty for what is built in.
    pub(super) word: &'static str,
    pub(super) meaning: Meaning,
    pub(super) kind: Option<FunctionKind>,
    /// All that it takes, the shape or point that a deformation is of too.
    pub(super) parameters: Vec<Taken>,
    /// What is written after the last parameter, as the type of what comes out.
    pub(super) result: Option<Type>,
    /// What it does, as Markdown.
    pub(super) text: String,
}

impl Callable {
    /// A declaration that can be called.
    pub(super) fn of_item(world: &World, item: ItemRef) -> Option<Self> {
        let declared = world.texts.modules.item(item)?;
        let name = item_name(declared)?.text.to_string();
        let (word, kind) = match &declared.kind {
            ItemKind::Function(function) => (kind_words(function.kind), Some(function.kind)),
            ItemKind::Material { .. } => ("material", None),
            _ => return None,
        };
        let mut parameters: Vec<Taken> = match kind {
            Some(FunctionKind::Warp) => vec![Taken { name: "s".into(), text: "s: shape".into(), ty: Some(Type::Shape), optional: false }],
            Some(FunctionKind::Warp2) => vec![Taken { name: "s".into(), text: "s: shape2".into(), ty: Some(Type::Shape2), optional: false }],
            _ => Vec::new(),
        };
        parameters.extend(parameters_of(declared).iter().map(|parameter| {
            let ty = parameter.ty.as_ref().map(|(ty, _)| ty.clone());
            let written = ty.as_ref().map_or(String::new(), |ty| format!(": {}", ty.name()));
            let default = parameter.default.as_ref().map_or(String::new(), |value| format!(" = {}", world.texts.sources.text(value.span)));
            Taken { name: parameter.name.text.to_string(), text: format!("{}{written}{default}", parameter.name.text), ty, optional: parameter.default.is_some() }
        }));
        let text = text_of(world, item, declared);
        Some(Self { text, name, word, meaning: meaning_of(declared), kind, parameters, result: type_of_item(&world.texts, item) })
    }

    /// A built-in function that takes so many arguments, or as many as it needs.
    pub(super) fn built_in(name: &str) -> Self {
        let count = KERNEL.iter().find(|row| row.callable && row.name == name).map_or(2, |row| usize::from(row.arity));
        let names: &[&str] = match name {
            "vec2" => &["x", "y"],
            "vec3" => &["x", "y", "z"],
            "vec4" => &["x", "y", "z", "w"],
            "mat2" => &["column_1", "column_2"],
            "mat3" => &["column_1", "column_2", "column_3"],
            "mat4" => &["column_1", "column_2", "column_3", "column_4"],
            "float" | "int" => &["a"],
            "grid" => &["size", "count"],
            "polar" => &["axis", "count"],
            _ => argument_names(name, count),
        };
        let defaults = defaults(name);
        let parameters = names.iter().enumerate().map(|(at, name_of)| {
            let default = defaults.get(at).copied().flatten();
            let seed = (*name_of == "seed").then_some(Usual::Number(0.0));
            let ty = match (name, *name_of) {
                ("at" | "material" | "paint" | "low_corner" | "high_corner" | "baked", "s") => Some(Type::Shape),
                ("paint", "mask") => Some(Type::Shape),
                ("material" | "paint", "m") => Some(Type::Material),
                ("mesh_field", "file") | ("text", "words" | "font" | "align") | ("path", "data") | ("svg", "file") | ("shader", "file") => Some(Type::Str),
                _ => None,
            };
            let text = default.or(seed).map_or((*name_of).to_owned(), |value| format!("{name_of} = {value}"));
            let optional = default.or(seed).is_some() || name == "grid" && at == 1;
            Taken { name: (*name_of).to_owned(), text, ty, optional }
        });
        Self {
            name: name.to_owned(),
            word: "",
            meaning: Meaning::Function,
            kind: None,
            parameters: parameters.collect(),
            result: None,
            text: manual::of_function(name).unwrap_or_default(),
        }
    }

    /// What it takes after a dot: without what stands before the dot.
    pub(super) fn written(&self, after_dot: bool) -> &[Taken] {
        self.parameters.get(usize::from(after_dot)..).unwrap_or(&[])
    }

    /// `twist(axis: vec3, rate: float)`, after a dot or not.
    pub(super) fn signature(&self, after_dot: bool) -> String {
        let parameters: Vec<&str> = self.written(after_dot).iter().map(|p| p.text.as_str()).collect();
        match parameters.is_empty() {
            true => self.name.clone(),
            false => format!("{}({})", self.name, parameters.join(", ")),
        }
    }

    /// Whether it can stand after a dot behind a value of this type.
    pub(super) fn takes(&self, receiver: &Type) -> bool {
        use FunctionKind::{Blend, Warp, Warp2};
        let is_shape = matches!(receiver, Type::Shape | Type::Shape2);
        match (self.kind, receiver) {
            (Some(Warp), Type::Shape | Type::Vec(3)) | (Some(Warp2), Type::Shape2 | Type::Vec(2)) => true,
            (Some(Warp | Warp2), _) => false,
            // What makes a shape of a size is written without a dot.
            (Some(FunctionKind::Field | FunctionKind::Field2 | FunctionKind::Shape | FunctionKind::Shape2), _) if !is_shape => false,
            (Some(Blend), _) => is_shape || matches!(receiver, Type::Float | Type::Int),
            _ => match self.parameters.first() {
                None => false,
                Some(Taken { ty: Some(ty), .. }) => {
                    ty == receiver
                        || matches!((ty, receiver), (Type::Float, Type::Int) | (Type::Vec(3), Type::Color) | (Type::Color, Type::Vec(3)))
                        || matches!((self.name.as_str(), receiver), ("at" | "material" | "paint" | "low_corner" | "high_corner" | "baked", Type::Shape2))
                }
                Some(Taken { ty: None, .. }) => !is_shape && !matches!(receiver, Type::Material | Type::Str),
            },
        }
    }
}

/// The comment of a declaration as Markdown.
pub(super) fn text_of(world: &World, item: ItemRef, declared: &Item) -> String {
    let Some(name) = item_name(declared) else { return String::new() };
    if world.texts.modules.is_prelude(item.module) {
        let written = |entry: &&crate::reference_text::Entry| {
            let named: Vec<&str> = entry.signature.split([' ', ':', ',', '(', ')', '=']).filter(|part| !part.is_empty()).collect();
            let parameters = parameters_of(declared);
            let names = parameters.iter().map(|p| &*p.name.text);
            let types = parameters.iter().filter_map(|p| p.ty.as_ref().map(|(ty, _)| ty.name()));
            names.clone().all(|name| named.contains(&name)) && types.into_iter().all(|ty| entry.signature.contains(&format!(": {ty}")))
        };
        let found = manual::of_prelude(&name.text).find(written).or_else(|| manual::of_prelude(&name.text).next());
        return found.map(manual::entry_text).unwrap_or_default();
    }
    let mut text = declared.doc.clone().unwrap_or_default();
    if let ItemKind::Param { description: Some(description), .. } = &declared.kind {
        text = if text.is_empty() { description.clone() } else { format!("{description}\n\n{text}") };
    }
    text
}
