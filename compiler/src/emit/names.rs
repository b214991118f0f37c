//! Names of the emitted module: made of those of the source, safe in WGSL, each once.

use naga::keywords::wgsl::{BUILTIN_IDENTIFIER_SET, RESERVED_SET};
use rustc_hash::{FxHashMap, FxHasher};
use std::collections::hash_map::Entry;
use std::hash::Hasher;

/// A name of the source as a WGSL identifier: letters of ASCII, digits and underscores, none of WGSL's own words.
pub fn identifier(name: &str) -> String {
    let mut text: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    // An identifier can't be `_` alone and can't start with two; and a digit starts a number.
    let start = text.find(|c| c != '_').unwrap_or(text.len());
    text.drain(..start);
    if text.is_empty() {
        text.push('n');
    }
    if text.starts_with(|c: char| c.is_ascii_digit()) {
        text.insert(0, 'n');
    }
    text
}

/// Whether a name means something in WGSL: a keyword, a reserved word, a type or a function that is built in.
pub fn is_taken(name: &str) -> bool {
    RESERVED_SET.contains(name) || BUILTIN_IDENTIFIER_SET.contains(name) || is_alias(name)
}

/// Whether a name is a vector's or a matrix's type with the type of its components, as `vec3f` (WGSL, "Predeclared type aliases").
fn is_alias(name: &str) -> bool {
    let is_size = |c: u8| (b'2'..=b'4').contains(&c);
    match *name.as_bytes() {
        [b'v', b'e', b'c', n, b'f' | b'h' | b'i' | b'u'] => is_size(n),
        [b'm', b'a', b't', n, b'x', m, b'f' | b'h'] => is_size(n) && is_size(m),
        _ => false,
    }
}

/// Writes a whole number: faster than the standard library, which looks at how it is to be formatted.
fn write_number(number: u32, to: &mut String) {
    if number >= 10 {
        write_number(number / 10, to);
    }
    to.push(char::from(b'0' + (number % 10) as u8));
}

/// Names of one scope, each given once. Kept by their hashes: two names of one hash only cost one of them a number.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    /// For each name that is given or reserved, the last number that was put after it.
    given: FxHashMap<u64, u32>,
}

fn hash(name: &str) -> u64 {
    let mut hasher = FxHasher::default();
    hasher.write(name.as_bytes());
    hasher.finish()
}

impl Scope {
    /// Keeps a name from being given.
    pub fn reserve(&mut self, name: &str) {
        self.given.entry(hash(name)).or_insert(1);
    }

    /// Forgets all names.
    pub fn clear(&mut self) {
        self.given.clear();
    }

    /// Writes the name itself where it is free, else the name with a number after it. `outer` holds names that must stay visible.
    pub fn write(&mut self, name: &str, outer: Option<&Scope>, to: &mut String) {
        let hidden = |n: &str| outer.is_some_and(|o| o.given.contains_key(&hash(n))) || is_taken(n);
        if !self.given.contains_key(&hash(name)) && hidden(name) {
            self.reserve(name);
        }
        self.next(name, hidden, to);
    }

    /// The same for a name that is surely nothing else, with or without a number.
    pub fn write_plain(&mut self, name: &str, to: &mut String) {
        self.next(name, |_| false, to);
    }

    /// The same as a text of its own.
    pub fn give(&mut self, name: &str) -> String {
        let mut text = String::new();
        self.write(name, None, &mut text);
        text
    }

    fn next(&mut self, name: &str, hidden: impl Fn(&str) -> bool, to: &mut String) {
        let start = to.len();
        to.push_str(name);
        let of_name = hash(name);
        let mut number = match self.given.entry(of_name) {
            Entry::Occupied(last) => *last.get(),
            Entry::Vacant(free) => {
                free.insert(1);
                return;
            }
        };
        // A digit at the end would run into the number.
        if name.ends_with(|c: char| c.is_ascii_digit()) {
            to.push('_');
        }
        let end = to.len();
        loop {
            number += 1;
            to.truncate(end);
            write_number(number, to);
            let candidate = to.get(start..).unwrap_or_default();
            if let Entry::Vacant(free) = self.given.entry(hash(candidate))
                && !hidden(candidate)
            {
                free.insert(1);
                self.given.insert(of_name, number);
                return;
            }
        }
    }
}

/// Places in a list whose names are `NAME_x`, `NAME_y` and so on, one after the other.
pub fn named_vectors<'n>(names: impl Iterator<Item = Option<&'n str>>) -> Vec<Vec<u32>> {
    let mut open: FxHashMap<&str, usize> = FxHashMap::default();
    let mut vectors: Vec<Vec<u32>> = Vec::new();
    for (at, name) in (0..).zip(names) {
        let Some((base, place)) = name.and_then(split_axis) else { continue };
        if place == 0 {
            open.insert(base, vectors.len());
            vectors.push(vec![at]);
        } else if let Some(parts) = open.get(base).and_then(|&i| vectors.get_mut(i))
            && parts.len() == place
        {
            parts.push(at);
        }
    }
    vectors.retain(|parts| parts.len() > 1);
    vectors
}

/// The name of a vector and the place of a component, of the name of a component.
pub fn split_axis(name: &str) -> Option<(&str, usize)> {
    let (base, axis) = name.rsplit_once('_')?;
    let place = ["x", "y", "z", "w"].iter().position(|a| *a == axis)?;
    Some((base, place))
}

/// What stands after a vector for one of its components.
pub fn component_name(i: u8) -> &'static str {
    match i {
        0 => ".x",
        1 => ".y",
        2 => ".z",
        _ => ".w",
    }
}

/// The type of a vector of 32-bit floats.
pub fn vector_type(components: u8) -> &'static str {
    match components {
        0 | 1 => "f32",
        2 => "vec2f",
        3 => "vec3f",
        _ => "vec4f",
    }
}
