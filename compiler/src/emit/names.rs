//! Names of the emitted module: made of those of the source, safe in WGSL and in what else reads or translates it, each once.
//!
//! No name ends in a digit or in `_`, and none holds `__`: GLSL keeps the latter for itself, and naga, which numbers names, would change the others. So
//! names stay as they are in every language, and where a module is read and written again, as naga_oil does.

use naga::keywords::wgsl::{BUILTIN_IDENTIFIER_SET, RESERVED_SET};
use rustc_hash::{FxHashMap, FxHasher};
use std::collections::hash_map::Entry;
use std::hash::Hasher;

/// A name of the source as an identifier: letters of ASCII, digits and underscores, but no `_` at an end or beside another, and no digit at an end.
pub fn identifier(name: &str) -> String {
    let mut text = String::with_capacity(name.len());
    for c in name.chars() {
        match c.is_ascii_alphanumeric() {
            true => text.push(c),
            false if text.is_empty() || text.ends_with('_') => {}
            false => text.push('_'),
        }
    }
    text.truncate(text.trim_end_matches('_').len());
    if text.is_empty() {
        text.push('n');
    }
    // A digit starts a number.
    if text.starts_with(|c: char| c.is_ascii_digit()) {
        text.insert(0, 'n');
    }
    if text.ends_with(|c: char| c.is_ascii_digit()) {
        text.push('a');
    }
    text
}

/// The name of the thing with this number, from 1 on, of several that are alike: `part_a`, `part_b` and so on, `part_aa` after `part_z`.
pub fn numbered(name: &str, number: usize) -> String {
    let mut text = format!("{name}_");
    write_letters(number, &mut text);
    text
}

/// What stands after the `_` there.
pub fn letters(number: usize) -> String {
    let mut text = String::new();
    write_letters(number, &mut text);
    text
}

/// Writes a number from 1 on in letters: `a` to `z`, then `aa`, `ab` and so on.
fn write_letters(number: usize, to: &mut String) {
    let before = number.saturating_sub(1);
    if before >= 26 {
        write_letters(before / 26, to);
    }
    to.push(char::from(b'a' + (before % 26) as u8));
}

/// What an argument for a variable of a shape is called, numbered.
pub const VARIABLE: &str = "k";

/// What a piece of a table's row is called, numbered.
pub const ROW: &str = "r";

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

/// Names of one scope, each given once. Kept by their hashes: two names of one hash only cost one of them a letter.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    /// For each name that is given or reserved, the number of the last letters that were put after it.
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

    /// Writes the name itself where it is free, else the name with letters after it: `name_b` is the second. `outer` holds names that must stay visible.
    pub fn write(&mut self, name: &str, outer: Option<&Scope>, to: &mut String) {
        let hidden = |n: &str| outer.is_some_and(|o| o.given.contains_key(&hash(n))) || is_taken(n);
        if !self.given.contains_key(&hash(name)) && hidden(name) {
            self.reserve(name);
        }
        self.next(name, hidden, to);
    }

    /// The same for a name that is surely nothing else, with or without letters after it.
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
        to.push('_');
        let end = to.len();
        loop {
            number += 1;
            to.truncate(end);
            write_letters(number as usize, to);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_the_source_become_identifiers() {
        for (name, expected) in [("ball", "ball"), ("column.flutes", "column_flutes"), ("a__b", "a_b"), ("x1", "x1a"), ("a_", "a"), ("_", "n"), ("2", "n2a")] {
            assert_eq!(identifier(name), expected);
        }
    }

    #[test]
    fn numbers_are_letters_and_each_is_another() {
        for (number, letters) in [(1, "a"), (26, "z"), (27, "aa"), (52, "az"), (53, "ba"), (702, "zz"), (703, "aaa")] {
            assert_eq!(numbered("part", number), format!("part_{letters}"));
        }
        let all: std::collections::BTreeSet<String> = (1..5000).map(|i| numbered("n", i)).collect();
        assert_eq!(all.len(), 4999);
    }

    #[test]
    fn a_name_is_given_once() {
        let mut scope = Scope::default();
        scope.reserve("d_c");
        let given: Vec<String> = (0..4).map(|_| scope.give("d")).collect();
        assert_eq!(given, ["d", "d_b", "d_d", "d_e"]);
        assert_eq!(scope.give("d_b"), "d_b_b");
    }
}
