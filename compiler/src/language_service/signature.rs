//! The parameters of a call while it is written.

use super::callable::Callable;
use super::place::{Call, Place, Within};
use super::world::World;
use crate::program::builtin::is_function;
use crate::program::load::Resolution;
use crate::source::FileId;
use std::ops::Range;

/// One way to call something.
#[derive(Clone, Debug, PartialEq)]
pub struct Signature {
    /// `field sphere(radius: float)`.
    pub label: String,
    /// Where the parameters stand in the label, in bytes.
    pub parameters: Vec<Range<usize>>,
    /// What it does, as Markdown.
    pub text: String,
    /// The parameter that is written at the place, if it has one.
    pub active: Option<usize>,
}

/// The ways to call what is called around a place.
#[derive(Clone, Debug, PartialEq)]
pub struct SignatureHelp {
    /// All of them.
    pub signatures: Vec<Signature>,
    /// The one that takes as many arguments as are written.
    pub active: usize,
}

/// The call around a byte of a text, where there is one of something that is known.
pub fn signature_help(world: &World, file: FileId, offset: usize) -> Option<SignatureHelp> {
    let text = world.text(file);
    if !text.is_char_boundary(offset) {
        return None;
    }
    let place = Place::new(text, offset);
    if place.within == Within::Comment {
        return None;
    }
    let call = place.call(text)?;
    let (known, has_receiver) = callables(world, file, &call);
    let signatures: Vec<Signature> = known.iter().map(|callable| signature(callable, &call, has_receiver, text)).collect();
    let active = signatures.iter().position(|signature| signature.active.is_some()).unwrap_or(0);
    (!signatures.is_empty()).then_some(SignatureHelp { signatures, active })
}

/// What a call may be of, and whether what it takes first stands before its dot.
pub(super) fn callables(world: &World, file: FileId, call: &Call) -> (Vec<Callable>, bool) {
    let text = world.text(file);
    let (Some(name), Some(module)) = (text.get(call.name.clone()), world.texts.modules.of_file(file)) else { return (Vec::new(), false) };
    let import = call.before_dot.clone().and_then(|range| world.texts.modules.alias(module, text.get(range)?));
    let items = match import {
        Some(import) => world.texts.modules.own(import, name).get(..1).unwrap_or(&[]),
        None => match world.texts.modules.resolve(module, name) {
            Resolution::Items(items) => items,
            _ => &[],
        },
    };
    let mut found: Vec<Callable> = items.iter().filter_map(|item| Callable::of_item(world, *item)).collect();
    let is_own = items.first().is_some_and(|item| !world.texts.modules.is_prelude(item.module));
    if is_function(name) && !is_own && import.is_none() {
        found.push(Callable::built_in(name));
    }
    let has_receiver = if import.is_some() { call.before_is_after_dot } else { call.after_dot };
    (found, has_receiver)
}

fn signature(callable: &Callable, call: &Call, has_receiver: bool, text: &str) -> Signature {
    let before = if callable.word.is_empty() { String::new() } else { format!("{} ", callable.word) };
    let mut label = format!("{before}{}(", callable.name);
    let mut parameters = Vec::new();
    let written = callable.written(has_receiver);
    for (at, parameter) in written.iter().enumerate() {
        if at > 0 {
            label.push_str(", ");
        }
        let start = label.len();
        label.push_str(&parameter.text);
        parameters.push(start..label.len());
    }
    label.push(')');
    let named = call.label.clone().and_then(|range| text.get(range));
    let active = match named {
        Some(named) => written.iter().position(|parameter| parameter.name == named),
        None => (call.commas < written.len()).then_some(call.commas),
    };
    Signature { label, parameters, text: callable.text.clone(), active }
}
