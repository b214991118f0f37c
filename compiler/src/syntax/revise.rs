//! A text with other values in it, where all else stays as it is written: what a hand has set becomes what the scene begins with.

use super::ast::{BlockKind, ExprKind, ItemKind};
use super::parse;
use crate::source::FileId;

/// What is to stand where a parameter has its value.
#[derive(Clone, Debug, PartialEq)]
pub enum Written {
    /// A value, and the range that stands behind it where the text gives none: without one it would follow the value.
    Value(String, Option<String>),
    /// What is called so in its list of choices.
    Choice(String),
}

/// Gives the text's parameters of these names other values to begin with.
pub fn parameters(text: &str, values: &[(String, Written)]) -> String {
    let (file, _) = parse(FileId(0), text);
    let mut edits = Vec::new();
    for item in &file.items {
        let ItemKind::Param { name, value, domain, .. } = &item.kind else { continue };
        let Some((_, written)) = values.iter().find(|(wanted, _)| *wanted == *name.text) else { continue };
        let words = match (written, domain.as_ref().map(|domain| &domain.kind)) {
            (Written::Value(words, Some(range)), None) => Some(format!("{words} in {range}")),
            (Written::Value(words, _), _) => Some(words.clone()),
            (Written::Choice(label), Some(ExprKind::List(choices))) => {
                let choice = choices.iter().find(|choice| choice.label().as_ref() == Some(label));
                choice.and_then(|choice| text.get(choice.span.range())).map(str::to_owned)
            }
            (Written::Choice(_), _) => None,
        };
        edits.extend(words.map(|words| (value.span.range(), words)));
    }
    replaced(text, edits)
}

/// Gives the text's camera of this name (one without has the empty name), or its first, these entries; where it has none, a camera is written at
/// the end.
pub fn camera(text: &str, name: Option<&str>, entries: &[(&str, String)]) -> String {
    let (file, _) = parse(FileId(0), text);
    let cameras = || {
        file.items.iter().filter_map(|item| match &item.kind {
            ItemKind::Block { kind: BlockKind::Camera, name, entries, .. } => Some((item.span, name, entries)),
            _ => None,
        })
    };
    let named = |wanted: &str| cameras().find(|(_, name, _)| name.as_ref().map_or("", |name| &*name.text) == wanted);
    let all = |entries: &[(&str, String)]| entries.iter().map(|(key, value)| format!("{key}: {value}")).collect::<Vec<_>>().join(", ");
    let Some((span, _, there)) = name.and_then(named).or_else(|| cameras().next()) else {
        let gap = if text.is_empty() || text.ends_with('\n') { "" } else { "\n" };
        return format!("{text}{gap}\ncamera {{ {} }}\n", all(entries));
    };
    let Some(first) = there.first() else {
        let open = text.get(span.range()).and_then(|block| block.find('{')).map(|at| span.range().start + at + 1);
        return open.map_or_else(|| text.to_owned(), |open| replaced(text, vec![(open..open, format!(" {} ", all(entries)))]));
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
        let text = "// head\nparam  a = 1 +\n 2 in 0..4 \"how\" // why\nparam b: vec3 = (1, 2, 3)\nparam c = x in [x, lib.y, \"z\"]\nparam d = 1 in [1, -1]\nparam e = x in [x, y]\nparam f = 1\nscene = sphere(a)\n";
        let values = [
            ("c".to_owned(), Written::Choice("lib.y".to_owned())),
            ("d".to_owned(), Written::Choice("-1".to_owned())),
            ("e".to_owned(), Written::Choice("gone".to_owned())),
            ("f".to_owned(), Written::Value("0.25".to_owned(), Some("0..2".to_owned()))),
            ("b".to_owned(), Written::Value("(0, 0, 1)".to_owned(), None)),
            ("a".to_owned(), Written::Value("0.5".to_owned(), Some("0..4".to_owned()))),
            ("lib.a".to_owned(), Written::Value("9".to_owned(), None)),
        ];
        let wanted = "// head\nparam  a = 0.5 in 0..4 \"how\" // why\nparam b: vec3 = (0, 0, 1)\nparam c = lib.y in [x, lib.y, \"z\"]\nparam d = -1 in [1, -1]\nparam e = x in [x, y]\nparam f = 0.25 in 0..2\nscene = sphere(a)\n";
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
        assert_eq!(of("camera c {\n  // note\n}", None), format!("camera c {{ {all} \n  // note\n}}"));
        let unnamed = "camera a { eye: (9, 9, 9) }\ncamera { eye: (8, 8, 8) }\n";
        assert_eq!(of(unnamed, Some("")), unnamed.replace("eye: (8, 8, 8)", "target: (0, 0, 0), eye: (1, 2, 3)"));
        assert_eq!(of("camera { fov: 30deg }", None), format!("camera {{ {all}, fov: 30deg }}"));
        let two = "camera a { eye: (9, 9, 9) }\ncamera b {\n  target: (1, 1, 1) // there\n  eye: 3 * (1, 1, 1)\n}\n";
        assert_eq!(of(two, None), two.replace("eye: (9, 9, 9)", "target: (0, 0, 0), eye: (1, 2, 3)"));
        let changed = two.replace("(1, 1, 1) // there", "(0, 0, 0) // there").replace("3 * (1, 1, 1)", "(1, 2, 3)");
        assert_eq!(of(two, Some("b")), changed);
        assert_eq!(of(two, Some("c")), of(two, None), "one that is gone");
    }

    /// Whatever a slider can say is a text that says the same, or what differs from it by no more than a ten-thousandth of the range.
    #[test]
    fn what_a_slider_says_can_be_written() {
        use crate::{MemoryLoader, Options, compile};
        let text = "param a = 0.3\nparam b: int = 2 in 0..5\nparam c = 0.25turn in 0..1turn\nparam d = 1 in 1/3..sqrt(2)\nparam e: vec3 = (0, 0, 0) in (-1, -2, 0)..(1, 2, 1e-6)\n\
            param f = #804020\nparam g: color = (2, 3, 0.5) in (0, 0, 0)..(4, 4, 4)\nparam h: color = (0.5, 0.5, 0.5) in (0.21, 0.1, 0.03)..(0.9, 0.9, 0.9)\n\
            param i = true\nparam j = -20deg in -90deg..90deg\nparam k = 2cm in 1cm..5cm\nrender { unit: mm }\nscene = sphere(1)\n";
        let read = |text: &str| {
            let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
            outcome.compiled.unwrap_or_else(|| panic!("{text}\n{:?}", outcome.diagnostics)).parameters
        };
        let before = read(text);
        let [angle, length] = [&before[9], &before[10]];
        assert_eq!((length.default[0], length.min[0], length.max[0], length.suffix()), (20.0, 10.0, 50.0, "cm"));
        assert_eq!(length.written(&[12.5]), Written::Value("1.25cm".to_owned(), Some("1cm..5cm".to_owned())));
        assert_eq!(["3", "30mm", " 1 in", "-3", "30deg", "x", ""].map(|text| length.read(text)), [Some(3.0), Some(3.0), Some(2.54), Some(-3.0), None, None, None]);
        assert_eq!(["-30", "0.25turn", "3mm"].map(|text| angle.read(text)), [Some(-30.0), Some(90.0), None]);
        for share in [0.0, 0.123_456_7, 1.0 / 3.0, 1.0] {
            let at = |p: &crate::interface::Parameter| {
                let between = |(min, max): (&f64, &f64)| if p.ty == crate::syntax::ast::Type::Int { (min + share * (max - min)).round() } else { min + share * (max - min) };
                p.min.iter().zip(&p.max).map(between).collect::<Vec<f64>>()
            };
            let values: Vec<_> = before.iter().map(|p| (p.name.clone(), p.written(&at(p)))).collect();
            let after = read(&parameters(text, &values));
            for (old, new) in before.iter().zip(&after) {
                let range = old.min.iter().zip(&old.max).map(|(a, b)| b - a).fold(0.0, f64::max);
                // A colour's bytes are as fine as a screen.
                let off = if old.ty == crate::syntax::ast::Type::Color { 5e-3 * range.max(1.0) } else { 1e-4 * range };
                assert!(at(old).iter().zip(&new.default).all(|(a, b)| old.name == "i" || (a - b).abs() <= off), "{} {:?} {:?}", old.name, at(old), new.default);
                assert!(old.min.iter().chain(&old.max).zip(new.min.iter().chain(&new.max)).all(|(a, b)| (a - b).abs() <= 1e-4 * range), "{}", old.name);
            }
        }
    }
}
