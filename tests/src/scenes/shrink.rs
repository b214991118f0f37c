//! From a scene that fails to the smallest one near it that fails too.

use super::grammar::{Literal, Piece, Sort, forms};
use super::{Part, Term};

/// The shortest scene found that `fails` says still fails, changing one place at a time; it is asked at most `budget` times.
pub fn shrink(scene: &Term, budget: usize, mut fails: impl FnMut(&Term) -> bool) -> Term {
    let mut best = scene.clone();
    let mut left = budget;
    loop {
        let before = best.clone();
        let mut index = 0;
        while index < best.size() {
            let mut path = Vec::new();
            let place = find(&best, index, &mut path);
            let shorter = candidates(place);
            let smaller = shorter.into_iter().find_map(|part| {
                let changed = with(&best, &path, part);
                if left == 0 || changed.text().len() >= best.text().len() {
                    return None;
                }
                left -= 1;
                fails(&changed).then_some(changed)
            });
            match smaller {
                Some(changed) => best = changed,
                None => index += 1,
            }
        }
        if best == before || left == 0 {
            return best;
        }
    }
}

/// A place in a tree: a term or a number, and of which kind it is.
enum Place<'t> {
    Term(&'t Term),
    Number(Literal, f64),
}

/// The place with this index, counted from the root down; `path` becomes the way to it.
fn find<'t>(term: &'t Term, index: usize, path: &mut Vec<usize>) -> Place<'t> {
    if index == 0 {
        return Place::Term(term);
    }
    let mut left = index - 1;
    let mut kinds = forms(term.sort)[term.form].pieces.iter().filter(|piece| !matches!(piece, Piece::Text(_)));
    for (i, part) in term.parts.iter().enumerate() {
        let kind = kinds.next();
        let size = if let Part::Term(inner) = part { inner.size() } else { 1 };
        if left < size {
            path.push(i);
            return match (part, kind) {
                (Part::Term(inner), _) => find(inner, left, path),
                (Part::Number(n), Some(Piece::Literal(kind))) => Place::Number(*kind, *n),
                (Part::Number(n), _) => Place::Number(Literal::Signed, *n),
            };
        }
        left -= size;
    }
    Place::Term(term)
}

fn with(term: &Term, path: &[usize], part: Part) -> Term {
    let mut changed = term.clone();
    match (path, part) {
        ([], Part::Term(term)) => changed = term,
        ([], Part::Number(_)) => {}
        ([last], part) => changed.parts[*last] = part,
        ([first, rest @ ..], part) => {
            if let Part::Term(inner) = &term.parts[*first] {
                changed.parts[*first] = Part::Term(with(inner, rest, part));
            }
        }
    }
    changed
}

/// What may stand in a place instead, the simplest first.
fn candidates(place: Place<'_>) -> Vec<Part> {
    match place {
        Place::Term(term) if term.sort == Sort::File => Vec::new(),
        Place::Term(term) => {
            let mut all: Vec<Term> = simplest(term.sort);
            inside(term, term.sort, &mut all);
            all.retain(|other| other != term);
            all.into_iter().map(Part::Term).collect()
        }
        Place::Number(kind, n) => {
            let mut all = match kind {
                Literal::Degrees => vec![0.0, 90.0, 45.0],
                _ => vec![1.0, 0.0, 0.5],
            };
            all.extend([n.round(), (n * 2.0).round() / 2.0, (n * 10.0).round() / 10.0]);
            if kind == Literal::Whole {
                all.retain(|m| *m >= 1.0);
            }
            all.into_iter().map(Part::Number).collect()
        }
    }
}

/// The first forms of a sort that hold nothing but numbers, each with those at one.
fn simplest(sort: Sort) -> Vec<Term> {
    let fill = |(index, pieces): (usize, &Vec<Piece>)| {
        let mut parts = Vec::new();
        for piece in pieces {
            match piece {
                Piece::Text(_) => {}
                Piece::Literal(Literal::Degrees) => parts.push(Part::Number(90.0)),
                Piece::Literal(_) => parts.push(Part::Number(1.0)),
                Piece::Hole(inner) => parts.push(Part::Term(first(*inner, sort)?)),
            }
        }
        Some(Term { sort, form: index, parts })
    };
    let ends = forms(sort).iter().enumerate().filter(|(_, form)| form.ends);
    ends.map(|(i, form)| (i, &form.pieces)).filter_map(fill).take(6).collect()
}

/// A short term of a sort that holds none of the sort `not`.
fn first(sort: Sort, not: Sort) -> Option<Term> {
    if sort == not { None } else { simplest(sort).into_iter().next() }
}

/// The terms of this sort within a term.
fn inside(term: &Term, sort: Sort, found: &mut Vec<Term>) {
    for part in &term.parts {
        if let Part::Term(inner) = part {
            if inner.sort == sort {
                found.push(inner.clone());
            }
            inside(inner, sort, found);
        }
    }
}
