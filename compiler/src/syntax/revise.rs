//! A text with other values in it, where all else stays as it is written: what a hand has set becomes what the scene begins with.

use super::ast::{BlockKind, ExprKind, ItemKind};
use super::parse;
use crate::source::FileId;

/// What is to stand where a parameter has its value.
#[derive(Clone, Debug, PartialEq)]
pub enum Written {
    /// This.
    Text(String),
    /// What its list of choices has at this place.
    Choice(usize),
}

/// Gives the text's parameters of these names other values to begin with.
pub fn parameters(text: &str, values: &[(String, Written)]) -> String {
    let (file, _) = parse(FileId(0), text);
    let mut edits = Vec::new();
    for item in &file.items {
        let ItemKind::Param { name, value, domain, .. } = &item.kind else { continue };
        let Some((_, written)) = values.iter().find(|(wanted, _)| *wanted == *name.text) else { continue };
        let words = match (written, domain.as_ref().map(|domain| &domain.kind)) {
            (Written::Text(words), _) => Some(words.as_str()),
            (Written::Choice(index), Some(ExprKind::List(choices))) => choices.get(*index).and_then(|choice| text.get(choice.span.range())),
            (Written::Choice(_), _) => None,
        };
        edits.extend(words.map(|words| (value.span.range(), words.to_owned())));
    }
    replaced(text, edits)
}

/// Gives the text's camera of this name, or its first, these entries; where it has none, a camera is written at the end.
pub fn camera(text: &str, name: Option<&str>, entries: &[(&str, String)]) -> String {
    let (file, _) = parse(FileId(0), text);
    let cameras = || {
        file.items.iter().filter_map(|item| match &item.kind {
            ItemKind::Block { kind: BlockKind::Camera, name, entries, .. } => Some((item.span, name, entries)),
            _ => None,
        })
    };
    let named = |wanted: &str| cameras().find(|(_, name, _)| name.as_ref().is_some_and(|name| *name.text == *wanted));
    let all = |entries: &[(&str, String)]| entries.iter().map(|(key, value)| format!("{key}: {value}")).collect::<Vec<_>>().join(", ");
    let Some((span, name, there)) = name.and_then(named).or_else(|| cameras().next()) else {
        let gap = if text.is_empty() || text.ends_with('\n') { "" } else { "\n" };
        return format!("{text}{gap}\ncamera {{ {} }}\n", all(entries));
    };
    let Some(first) = there.first() else {
        let name = name.as_ref().map_or_else(String::new, |name| format!("{} ", name.text));
        return replaced(text, vec![(span.range(), format!("camera {name}{{ {} }}", all(entries)))]);
    };
    let mut edits = Vec::new();
    let mut missing = Vec::new();
    for (key, value) in entries {
        match there.iter().find(|entry| *entry.key.text == **key) {
            Some(entry) => edits.push((entry.value.span.range(), value.clone())),
            None => missing.push((*key, value.clone())),
        }
    }
    if !missing.is_empty() {
        let at = first.key.span.range().start;
        edits.push((at..at, format!("{}, ", all(&missing))));
    }
    replaced(text, edits)
}

/// The text with other words in some places, which do not overlap.
fn replaced(text: &str, mut edits: Vec<(std::ops::Range<usize>, String)>) -> String {
    edits.sort_by_key(|(place, _)| place.start);
    let (mut new, mut done) = (String::with_capacity(text.len()), 0);
    for (place, words) in edits {
        new.push_str(text.get(done..place.start).unwrap_or_default());
        new.push_str(&words);
        done = place.end;
    }
    new.push_str(text.get(done..).unwrap_or_default());
    new
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_replaced_and_nothing_else() {
        let text = "// head\nparam  a = 1 +\n 2 in 0..4 \"how\" // why\nparam b: vec3 = (1, 2, 3)\nparam c = x in [x, lib.y, \"z\"]\nscene = sphere(a)\n";
        let values = [
            ("c".to_owned(), Written::Choice(1)),
            ("b".to_owned(), Written::Text("(0, 0, 1)".to_owned())),
            ("a".to_owned(), Written::Text("0.5".to_owned())),
            ("lib.a".to_owned(), Written::Text("9".to_owned())),
        ];
        let wanted = "// head\nparam  a = 0.5 in 0..4 \"how\" // why\nparam b: vec3 = (0, 0, 1)\nparam c = lib.y in [x, lib.y, \"z\"]\nscene = sphere(a)\n";
        assert_eq!(parameters(text, &values), wanted);
        assert_eq!(parameters("", &values), "");
    }

    #[test]
    fn a_camera_is_changed_where_there_is_one() {
        let entries = [("eye", "(1, 2, 3)".to_owned()), ("target", "(0, 0, 0)".to_owned())];
        let of = |text: &str, name: Option<&str>| camera(text, name, &entries);
        let all = "eye: (1, 2, 3), target: (0, 0, 0)";
        assert_eq!(of("scene = box(1)", None), format!("scene = box(1)\n\ncamera {{ {all} }}\n"));
        assert_eq!(of("camera {}\nscene = box(1)", None), format!("camera {{ {all} }}\nscene = box(1)"));
        assert_eq!(of("camera { fov: 30deg }", None), format!("camera {{ {all}, fov: 30deg }}"));
        let two = "camera a { eye: (9, 9, 9) }\ncamera b {\n  target: (1, 1, 1) // there\n  eye: 3 * (1, 1, 1)\n}\n";
        assert_eq!(of(two, None), two.replace("eye: (9, 9, 9)", "target: (0, 0, 0), eye: (1, 2, 3)"));
        let changed = two.replace("(1, 1, 1) // there", "(0, 0, 0) // there").replace("3 * (1, 1, 1)", "(1, 2, 3)");
        assert_eq!(of(two, Some("b")), changed);
        assert_eq!(of(two, Some("c")), of(two, None), "one that is gone");
    }
}
