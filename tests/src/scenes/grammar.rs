//! The grammar of random scenes: for each sort of term the forms that it can take.
//!
//! `<shape>` in a form stands for any term of that sort, `<same>` for one of the sort of the form itself. A form is listed as often as it
//! shall be likely. A number alone makes a literal: [`Literal`] says of which kind.

use super::forms::lists;
use std::sync::LazyLock;

/// What a term is, and what it may see.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Sort {
    /// A whole file.
    File,
    /// A block of the scene that may be missing.
    Block,
    /// A solid.
    Shape,
    /// What stands in a field of a user: a formula whose zero set is worth seeing.
    Body,
    /// A flat shape.
    Drawing,
    /// A line without width.
    Line,
    /// A number that depends on a point of space.
    Formula,
    /// A number that depends on a point of a drawing.
    Flat,
    /// A number that depends on `t`, in a `fn`.
    Free,
    /// A number that depends on the distances `a` and `b` and the number `k`, in a `blend`.
    Mixed,
    /// A point of space that depends on `p`.
    Point,
    /// A point of a drawing that depends on `p`.
    Spot,
    /// A condition on a point of space.
    Test,
    /// The same at every point, of either sign.
    Number,
    /// The same at every point, mostly above zero.
    Size,
    /// The same at every point, small and mostly above zero.
    Small,
    /// A whole number that is known while compiling, at least 1.
    Count,
    /// A whole number that may be live.
    Whole,
    /// An angle.
    Angle,
    /// A direction in space.
    Axis,
    /// A direction in a drawing.
    Way,
    /// A place in space.
    Vector,
    /// Three sizes.
    Sizes,
    /// A place in a drawing.
    Pair,
    /// A colour.
    Color,
}

/// Of which kind a literal is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Literal {
    /// In -1.5..1.5, and now and then 0 or large.
    Signed,
    /// In 0.1..1.6, and now and then 0, a blade, large, or below zero.
    Positive,
    /// In 0.02..0.4.
    Small,
    /// 1 to 5.
    Whole,
    /// Degrees.
    Degrees,
}

/// A piece of a form.
#[derive(Clone, Debug)]
pub enum Piece {
    /// As it stands.
    Text(&'static str),
    /// A term of this sort.
    Hole(Sort),
    /// A number.
    Literal(Literal),
}

/// A way to write a term.
#[derive(Clone, Debug)]
pub struct Form {
    /// In the order in which they are printed.
    pub pieces: Vec<Piece>,
    /// Whether it ends the recursion: it holds no shape and no formula.
    pub ends: bool,
}

/// The forms of a sort.
pub fn forms(sort: Sort) -> &'static [Form] {
    &GRAMMAR[sort as usize]
}

/// Sorts whose terms are never deep.
fn shallow(sort: Sort) -> bool {
    use Sort::*;
    matches!(sort, Number | Size | Small | Count | Whole | Angle | Axis | Way | Vector | Sizes | Pair | Color)
}

const SORTS: &[(&str, Sort)] = &[
    ("file", Sort::File),
    ("block", Sort::Block),
    ("shape", Sort::Shape),
    ("body", Sort::Body),
    ("drawing", Sort::Drawing),
    ("line", Sort::Line),
    ("formula", Sort::Formula),
    ("flat", Sort::Flat),
    ("free", Sort::Free),
    ("mixed", Sort::Mixed),
    ("point", Sort::Point),
    ("spot", Sort::Spot),
    ("test", Sort::Test),
    ("number", Sort::Number),
    ("size", Sort::Size),
    ("small", Sort::Small),
    ("count", Sort::Count),
    ("whole", Sort::Whole),
    ("angle", Sort::Angle),
    ("axis", Sort::Axis),
    ("way", Sort::Way),
    ("vector", Sort::Vector),
    ("sizes", Sort::Sizes),
    ("pair", Sort::Pair),
    ("color", Sort::Color),
];

const LITERALS: &[(&str, Literal)] = &[
    ("signed", Literal::Signed),
    ("positive", Literal::Positive),
    ("little", Literal::Small),
    ("integer", Literal::Whole),
    ("degrees", Literal::Degrees),
];

static GRAMMAR: LazyLock<Vec<Vec<Form>>> = LazyLock::new(|| {
    let of = |&(_, sort): &(&str, Sort)| lists(sort).iter().flat_map(|list| list.iter()).map(|text| form(sort, text)).collect();
    SORTS.iter().map(of).collect()
});

fn form(own: Sort, text: &'static str) -> Form {
    let mut pieces = Vec::new();
    let mut rest = text;
    // A name between angles, nothing else: `a < b` has none.
    while let Some((before, after)) = rest.split_once('<') {
        let known = after.split_once('>').and_then(|(name, after)| {
            let sort = || SORTS.iter().find(|(n, _)| *n == name).map(|s| Piece::Hole(s.1));
            let literal = || LITERALS.iter().find(|(n, _)| *n == name).map(|l| Piece::Literal(l.1));
            let same = (name == "same").then_some(Piece::Hole(own));
            Some((same.or_else(sort).or_else(literal)?, after))
        });
        match known {
            Some((piece, after)) => {
                pieces.extend((!before.is_empty()).then_some(Piece::Text(before)));
                pieces.push(piece);
                rest = after;
            }
            None => {
                let end = text.len() - rest.len() + before.len() + 1;
                pieces.push(Piece::Text(&text[text.len() - rest.len()..end]));
                rest = after;
            }
        }
    }
    pieces.extend((!rest.is_empty()).then_some(Piece::Text(rest)));
    let ends = pieces.iter().all(|piece| !matches!(piece, Piece::Hole(s) if !shallow(*s) || *s == own));
    Form { pieces, ends }
}
