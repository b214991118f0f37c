//! Text in WGSL by its words: names that are exchanged, and the items of a text that something needs.

use rustc_hash::{FxHashMap, FxHashSet};

/// The pieces of a text: each name, and what stands between two. Comments and attributes (`@vertex`) are no names.
fn pieces(text: &str) -> impl Iterator<Item = (&str, bool)> {
    let mut rest = text;
    std::iter::from_fn(move || {
        let first = rest.chars().next()?;
        let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let (length, is_name) = if rest.starts_with("//") {
            (rest.find('\n').unwrap_or(rest.len()), false)
        } else if is_word(first) {
            (rest.find(|c| !is_word(c)).unwrap_or(rest.len()), !first.is_ascii_digit())
        } else if first == '@' {
            (rest.char_indices().skip(1).find(|(_, c)| !is_word(*c)).map_or(rest.len(), |(at, _)| at), false)
        } else {
            // Up to the next word, attribute or comment.
            let end = rest.char_indices().skip(1).find(|(at, c)| is_word(*c) || *c == '@' || rest.get(*at..).is_some_and(|rest| rest.starts_with("//")));
            (end.map_or(rest.len(), |(at, _)| at), false)
        };
        let (piece, after) = rest.split_at_checked(length)?;
        rest = after;
        Some((piece, is_name))
    })
}

/// The names in a text.
pub fn names(text: &str) -> FxHashSet<&str> {
    pieces(text).filter_map(|(piece, is_name)| is_name.then_some(piece)).collect()
}

/// The text with other names.
pub fn renamed(text: &str, names: &FxHashMap<&str, String>) -> String {
    let mut out = String::with_capacity(text.len() + text.len() / 8);
    for (piece, is_name) in pieces(text) {
        out.push_str(names.get(piece).filter(|_| is_name).map_or(piece, String::as_str));
    }
    out
}

/// The text with another name for each field of a variable: `block.field` is one name.
pub fn with_variables(text: &str, block: &str, variable: impl Fn(&str) -> Option<String>) -> String {
    let mut out = String::with_capacity(text.len());
    let mut all = pieces(text).peekable();
    while let Some((piece, is_name)) = all.next() {
        if is_name && piece == block && all.peek().is_some_and(|(piece, _)| *piece == ".") {
            _ = all.next();
            let field = all.next().map_or("", |(field, _)| field);
            match variable(field) {
                Some(name) => out.push_str(&name),
                None => out.extend([block, ".", field]),
            }
        } else {
            out.push_str(piece);
        }
    }
    out
}

/// What a text of our own declares: with its comment, from the start of a line to a `}` or `;` at the end of one that is not indented.
pub struct Item<'t> {
    /// Its name.
    pub name: &'t str,
    /// Its text, with a line's end.
    pub text: &'t str,
}

/// The items of a text whose functions and structs end with a `}` at the start of a line.
pub fn items(text: &str) -> Vec<Item<'_>> {
    let (mut found, mut start, mut at, mut name) = (Vec::new(), 0, 0, None);
    for line in text.split_inclusive('\n') {
        let bare = line.trim_end();
        at += line.len();
        if bare.is_empty() && name.is_none() {
            // A comment that nothing follows speaks of the whole text.
            start = at;
            continue;
        }
        let declares = ["fn ", "struct ", "const ", "var<private> "].iter().find_map(|word| line.strip_prefix(word));
        if let Some(rest) = declares {
            name = name.or(rest.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').next());
        }
        let ends = bare == "}" || !line.starts_with([' ', '/', '@']) && bare.ends_with(';') || declares.is_some() && bare.ends_with('}');
        if let (Some(own), true) = (name, ends) {
            found.extend(text.get(start..at).map(|text| Item { name: own, text }));
            (start, name) = (at, None);
        }
    }
    found
}

/// The items that those with some names need, and these, in their order.
pub fn needed<'a, 't>(items: &'a [Item<'t>], roots: &[&str]) -> Vec<&'a Item<'t>> {
    let index: FxHashMap<&str, usize> = items.iter().enumerate().map(|(i, item)| (item.name, i)).collect();
    let mut is_needed = vec![false; items.len()];
    let mut open: Vec<usize> = roots.iter().filter_map(|name| index.get(name).copied()).collect();
    while let Some(at) = open.pop() {
        let Some(slot) = is_needed.get_mut(at).filter(|slot| !**slot) else { continue };
        *slot = true;
        let Some(item) = items.get(at) else { continue };
        open.extend(names(item.text).into_iter().filter_map(|name| index.get(name).copied()));
    }
    items.iter().zip(is_needed).filter_map(|(item, is_needed)| is_needed.then_some(item)).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::indexing_slicing)]
mod tests {
    use super::*;

    const TEXT: &str = "// About all.\n\nconst a: f32 = 1.0;\n\n// A struct, as `b`.\nstruct b {\n    c: f32,\n}\n\nvar<private> d: b;\n\n// One.\nfn e() -> f32 {\n    return d.c * a;\n}\n\n@fragment\nfn f() -> f32 { return 2.0; }\n";

    #[test]
    fn items_are_found_with_what_they_need() {
        let all = items(TEXT);
        assert_eq!(all.iter().map(|item| item.name).collect::<Vec<_>>(), ["a", "b", "d", "e", "f"]);
        assert_eq!(all[1].text, "// A struct, as `b`.\nstruct b {\n    c: f32,\n}\n");
        assert_eq!(all[4].text, "@fragment\nfn f() -> f32 { return 2.0; }\n");
        let found = |roots: &[&str]| needed(&all, roots).iter().map(|item| item.name).collect::<String>();
        assert_eq!(found(&["e"]), "abde");
        assert_eq!(found(&["f"]), "f");
    }

    #[test]
    fn names_are_exchanged_and_comments_stay() {
        let names = FxHashMap::from_iter([("d", "sf_d".to_owned())]);
        assert_eq!(renamed("@d d.dd + 1d; // d\nd", &names), "@d sf_d.dd + 1d; // d\nsf_d");
        let text = with_variables("u.a + x_u.a - u.b * u; // u.a", "u", |field| (field == "a").then(|| "sf_a".to_owned()));
        assert_eq!(text, "sf_a + x_u.a - u.b * u; // u.a");
    }
}
