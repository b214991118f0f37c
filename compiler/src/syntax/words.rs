//! The words of the language, and the nearest word to one that is not.

/// Words that start a declaration.
pub const DECLARATIONS: &[&str] = &[
    "import",
    "param",
    "let",
    "field",
    "field2",
    "warp",
    "warp2",
    "blend",
    "fn",
    "shape",
    "shape2",
    "material",
    "scene",
    "camera",
    "light",
    "environment",
    "render",
    "physics",
    "balls",
    "mesh",
];

/// Words within expressions.
pub const EXPRESSIONS: &[&str] = &["for", "in", "while", "if", "else", "true", "false"];

/// Words that mean something in one place only, and are ordinary names everywhere else.
pub const CONTEXTUAL: &[&str] = &["as", "by", "exact", "lipschitz"];

/// Names of types, as they are written.
pub const TYPES: &[&str] = &[
    "bool", "int", "float", "vec2", "vec3", "vec4", "mat2", "mat3", "mat4", "color", "shape",
    "shape2", "material", "curve", "field",
];

/// What other languages write where a type stands, and that is none here.
pub const TYPES_ELSEWHERE: &[&str] = &["uint", "double", "half", "var", "const", "auto"];

/// Whether a word stands before a name that is declared, here or in another language, to say its type.
pub fn is_type(word: &str) -> bool {
    TYPES.contains(&word) || TYPES_ELSEWHERE.contains(&word)
}

/// What to write in place of a `return`.
pub const NO_RETURN: &str = "write the value alone, without `return`: a block is `{ let a = 1; value }`, and its value stands at its end";

/// Whether a word can't be the name of a value.
pub fn is_reserved(word: &str) -> bool {
    DECLARATIONS.contains(&word) || EXPRESSIONS.contains(&word)
}

/// The candidate that differs from `word` by the fewest letters, the first of several, if it is near enough to be meant.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let limit = (word.chars().count() / 3).clamp(1, 3);
    let mut best: Option<(usize, &str)> = None;
    for candidate in candidates {
        if candidate.len().abs_diff(word.len()) > limit || candidate == word {
            continue;
        }
        let distance = edits(word, candidate);
        // Of short words, one that keeps no letter at its place is not near.
        if distance <= limit
            && distance < candidate.chars().count()
            && best.is_none_or(|(d, _)| distance < d)
        {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// Letters to insert, drop, replace or swap with their neighbour to make one word of the other (optimal string alignment).
fn edits(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.chars().map(|c| c.to_ascii_lowercase()).collect();
    let b: Vec<char> = b.chars().map(|c| c.to_ascii_lowercase()).collect();
    let mut before: Vec<usize> = Vec::new();
    let mut above: Vec<usize> = (0..=b.len()).collect();
    for (i, &ca) in a.iter().enumerate() {
        let mut row = vec![i + 1];
        for (j, &cb) in b.iter().enumerate() {
            let at = |line: &[usize], k: usize| line.get(k).copied().unwrap_or(usize::MAX / 2);
            let mut cost = (at(&above, j) + usize::from(ca != cb))
                .min(at(&above, j + 1) + 1)
                .min(at(&row, j) + 1);
            let swapped = i > 0 && j > 0 && a.get(i - 1) == Some(&cb) && b.get(j - 1) == Some(&ca);
            if swapped {
                cost = cost.min(at(&before, j - 1) + 1);
            }
            row.push(cost);
        }
        before = std::mem::replace(&mut above, row);
    }
    above.last().copied().unwrap_or(usize::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_word_is_the_one_that_was_meant() {
        assert_eq!(nearest("shap", DECLARATIONS.iter().copied()), Some("shape"));
        assert_eq!(nearest("secne", DECLARATIONS.iter().copied()), Some("scene"));
        assert_eq!(nearest("matrial", DECLARATIONS.iter().copied()), Some("material"));
        assert_eq!(nearest("flot", TYPES.iter().copied()), Some("float"));
        assert_eq!(nearest("number", TYPES.iter().copied()), None);
        assert_eq!(nearest("q", ["p", "x"]), None);
    }
}
