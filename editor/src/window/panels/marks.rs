//! Where problems are underlined in the text that is shown. The compiler has spoken of a text that may be another one by now: what still stands
//! there is found again, and what an edit has touched is not underlined until the compiler has seen it.

use crate::window::document::Document;
use crate::window::session::Session;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;
use surefoot_compiler::diagnostic::Severity;

/// The pieces of a text that have a problem, as bytes.
pub fn of(session: &Session, document: &Document) -> Vec<(Range<usize>, Severity)> {
    let spoken = session.said.words.sources.iter().find(|(_, file)| file.name == document.name);
    // What a person sees has no carriage returns.
    let old = spoken.map_or(Cow::Borrowed(document.text.as_str()), |(_, file)| match file.text.contains('\r') {
        true => Cow::Owned(file.text.replace("\r\n", "\n")),
        false => Cow::Borrowed(&*file.text),
    });
    let ends = shared_ends(&old, &document.text);
    let here = session.said.problems.iter().filter(|problem| problem.place.file == document.name);
    let mut marks: Vec<_> = here
        .filter_map(|problem| {
            let start = byte(&old, problem.place.start);
            let end = byte(&old, problem.place.end).max(start);
            Some((found_again(start..end, [old.len(), document.text.len()], ends)?, problem.severity))
        })
        .collect();
    // Errors last: they are drawn over warnings.
    marks.sort_by_key(|(range, severity)| (*severity, range.start));
    marks
}

/// The worst problem of each line that has one; lines are counted from 1.
pub fn by_line(marks: &[(Range<usize>, Severity)], text: &str) -> BTreeMap<u32, Severity> {
    let mut worst = BTreeMap::new();
    for (range, severity) in marks {
        let line = text.bytes().take(range.start).filter(|byte| *byte == b'\n').count() as u32 + 1;
        let known = worst.entry(line).or_insert(*severity);
        *known = (*severity).max(*known);
    }
    worst
}

/// How many bytes two texts share at their beginnings, and how many more at their ends; none where they are the same.
fn shared_ends(old: &str, new: &str) -> Option<[usize; 2]> {
    if old == new {
        return None;
    }
    let before = old.bytes().zip(new.bytes()).take_while(|(a, b)| a == b).count();
    let most = old.len().min(new.len()) - before;
    let after = old.bytes().rev().zip(new.bytes().rev()).take(most).take_while(|(a, b)| a == b).count();
    Some([before, after])
}

/// Where a piece of the old text is in the new one; none where what has changed touches it.
fn found_again(range: Range<usize>, [old, new]: [usize; 2], ends: Option<[usize; 2]>) -> Option<Range<usize>> {
    let Some([before, after]) = ends else { return Some(range) };
    if range.end < before {
        return Some(range);
    }
    let moved = |at: usize| (at + new).checked_sub(old);
    (range.start > old - after).then_some(moved(range.start)?..moved(range.end)?)
}

/// The byte of a line and column; the nearest where the text has become another one meanwhile.
pub fn byte(text: &str, (line, column): (u32, u32)) -> usize {
    let start = match line {
        0 | 1 => 0,
        n => {
            let ends = text.match_indices('\n').nth(n as usize - 2);
            ends.map_or(text.len(), |(at, _)| at + 1)
        }
    };
    let line = text[start..].split('\n').next().unwrap_or_default();
    let within = line.char_indices().nth(column.max(1) as usize - 1);
    start + within.map_or(line.len(), |(at, _)| at)
}

/// The character of a line and column.
pub fn character(text: &str, place: (u32, u32)) -> usize {
    text[..byte(text, place)].chars().count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_become_bytes_and_characters() {
        let text = "a é\n\nlast";
        assert_eq!(byte(text, (1, 1)), 0);
        assert_eq!(byte(text, (1, 4)), 4);
        assert_eq!(byte(text, (1, 99)), 4);
        assert_eq!(byte(text, (2, 1)), 5);
        assert_eq!(byte(text, (3, 3)), 8);
        assert_eq!(byte(text, (9, 9)), text.len());
        assert_eq!(character(text, (3, 1)), 5);
    }

    #[test]
    fn what_an_edit_has_not_touched_is_found_again() {
        let old = "scene = spere(1) | bix(2)";
        let again = |new: &str, piece: &str| {
            let start = old.find(piece).unwrap();
            let found = found_again(start..start + piece.len(), [old.len(), new.len()], shared_ends(old, new))?;
            Some(new[found].to_owned())
        };
        for new in [old, "scene = spere(1.25) | bix(2)", "scene = spere(é) | bix(2)", "scene = spere() | bix(2)"] {
            assert_eq!(again(new, "spere").as_deref(), Some("spere"), "{new}");
            assert_eq!(again(new, "bix").as_deref(), Some("bix"), "{new}");
        }
        for new in ["scene = sphere(1) | bix(2)", "scene = speres(1) | bix(2)", "scene = xspere(1) | bix(2)", "scene = (1) | bix(2)"] {
            assert_eq!(again(new, "spere"), None, "{new}");
            assert_eq!(again(new, "bix").as_deref(), Some("bix"), "{new}");
        }
        assert_eq!(again("", "bix"), None);
    }

    #[test]
    fn the_worst_problem_of_a_line_counts() {
        let marks = [(0..1, Severity::Error), (1..2, Severity::Warning), (4..5, Severity::Warning)];
        let worst: Vec<_> = by_line(&marks, "abc\nde").into_iter().collect();
        assert_eq!(worst, [(1, Severity::Error), (2, Severity::Warning)]);
    }
}
