//! Names of the emitted module: made of those of the source, safe in WGSL, each once.

use naga::keywords::wgsl::{BUILTIN_IDENTIFIER_SET, RESERVED_SET};
use rustc_hash::FxHashMap;
use std::fmt::Write;

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
    RESERVED_SET.contains(name) || BUILTIN_IDENTIFIER_SET.contains(name)
}

/// Names of one scope, each given once.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    /// How many names were asked for with this text; a name that was given is in here.
    given: FxHashMap<String, u32>,
}

impl Scope {
    /// Keeps a name from being given.
    pub fn reserve(&mut self, name: &str) {
        if !self.given.contains_key(name) {
            self.given.insert(name.to_owned(), 1);
        }
    }

    /// The name itself where it is free, else the name with a number after it. `outer` holds names that must stay visible.
    pub fn give(&mut self, name: &str, outer: Option<&Scope>) -> String {
        let hidden = |n: &str| outer.is_some_and(|o| o.given.contains_key(n)) || is_taken(n);
        let mut candidate = name.to_owned();
        if !self.given.contains_key(name) && !hidden(name) {
            self.given.insert(candidate.clone(), 1);
            return candidate;
        }
        let mut number = self.given.get(name).copied().unwrap_or(1);
        // A digit at the end would run into the number.
        let joint = if name.ends_with(|c: char| c.is_ascii_digit()) { "_" } else { "" };
        loop {
            number += 1;
            candidate.truncate(name.len());
            let _ = write!(candidate, "{joint}{number}");
            if !self.given.contains_key(&candidate) && !hidden(&candidate) {
                break;
            }
        }
        self.given.insert(name.to_owned(), number);
        self.given.insert(candidate.clone(), 1);
        candidate
    }
}
