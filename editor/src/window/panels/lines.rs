//! What the keyboard does to whole lines: comments, and how far they stand in.

use std::ops::Range;

/// How far a line goes in or out at a time.
const STEP: usize = 2;

/// Makes comments of the lines that a selection touches (in characters), or code again where all of them are comments.
/// The new text, and the selection in it.
pub fn comment(text: &str, selection: Range<usize>) -> (String, Range<usize>) {
    // Documentation is made a comment as code is.
    let is_comment = |code: &str| code.starts_with("//") && !code.starts_with("///") && !code.starts_with("//!");
    let touched = || lines(text).filter(|(_, range)| touches(range, &selection)).map(|(line, _)| line).filter(|line| !line.trim().is_empty());
    let are_comments = touched().all(|line| is_comment(line.trim_start()));
    let margin = touched().map(indent).min().unwrap_or(0);
    by_lines(text, selection.clone(), |line| {
        if line.trim().is_empty() {
            return line.to_owned();
        }
        if !are_comments {
            let (before, code) = line.split_at(line.char_indices().nth(margin).map_or(line.len(), |(at, _)| at));
            return format!("{before}// {code}");
        }
        let (before, code) = line.split_at(line.len() - line.trim_start().len());
        let code = code.strip_prefix("//").unwrap_or(code);
        format!("{before}{}", code.strip_prefix(' ').unwrap_or(code))
    })
}

/// Moves the lines that a selection touches in, or out.
pub fn shift(text: &str, selection: Range<usize>, inwards: bool) -> (String, Range<usize>) {
    by_lines(text, selection, |line| match inwards {
        true if line.trim().is_empty() => line.to_owned(),
        true => format!("{}{line}", " ".repeat(STEP)),
        false if line.starts_with('\t') => line[1..].to_owned(),
        false => line[indent(line).min(STEP)..].to_owned(),
    })
}

/// The spaces and tabulators at a line's beginning; each is one byte and one character.
fn indent(line: &str) -> usize {
    line.bytes().take_while(|b| matches!(b, b' ' | b'\t')).count()
}

/// The lines, each with its characters, without its end.
fn lines(text: &str) -> impl Iterator<Item = (&str, Range<usize>)> {
    text.split('\n').scan(0, |at, line| {
        let range = *at..*at + line.chars().count();
        *at = range.end + 1;
        Some((line, range))
    })
}

/// Whether a line is meant by a selection. One that ends where a line begins does not mean that line.
fn touches(line: &Range<usize>, selection: &Range<usize>) -> bool {
    let is_last = selection.end >= line.start && (selection.is_empty() || selection.end > line.start);
    is_last && selection.start <= line.end
}

/// Changes each line that a selection touches. The selection stays on what it was.
fn by_lines(text: &str, selection: Range<usize>, change: impl Fn(&str) -> String) -> (String, Range<usize>) {
    let mut new = String::with_capacity(text.len() + 64);
    let mut count = 0;
    let mut ends = [selection.start, selection.end];
    for (line, range) in lines(text) {
        if !new.is_empty() || range.start > 0 {
            new.push('\n');
            count += 1;
        }
        let changed = if touches(&range, &selection) { change(line) } else { line.to_owned() };
        let (before, after) = (range.end - range.start, changed.chars().count());
        for (end, old) in ends.iter_mut().zip([selection.start, selection.end]) {
            if (range.start..=range.end).contains(&old) {
                let column = old - range.start;
                // What stands at the very beginning of a selected line stays there.
                let moved = if column == 0 && !selection.is_empty() { 0 } else { (column + after).saturating_sub(before) };
                *end = count + moved.min(after);
            }
        }
        new.push_str(&changed);
        count += after;
    }
    (new, ends[0]..ends[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_become_comments_and_code_again() {
        let text = "a\n  é = 1\n\n    c\nd";
        let (commented, selection) = comment(text, 4..14);
        assert_eq!(commented, "a\n  // é = 1\n\n  //   c\nd");
        let (back, selection) = comment(&commented, selection);
        assert_eq!((back.as_str(), selection), (text, 4..14));
        // One line, where the cursor stands; without a space too.
        assert_eq!(comment("ab\n//cd", 5..5), ("ab\ncd".to_owned(), 3..3));
        assert_eq!(comment("ab\ncd", 4..4), ("ab\n// cd".to_owned(), 7..7));
        // Of several some are comments: they become comments of comments.
        assert_eq!(comment("// a\nb", 0..6).0, "// // a\n// b");
        // Documentation is no comment; a selection's last line counts where something of it is selected.
        assert_eq!(comment("/// a\nb\n", 0..6).0, "// /// a\nb\n");
        assert_eq!(comment("", 0..0), (String::new(), 0..0));
    }

    #[test]
    fn lines_move_in_and_out() {
        let text = "a\n b\n\n\tc";
        let (inwards, selection) = shift(text, 0..text.len(), true);
        assert_eq!((inwards.as_str(), selection.clone()), ("  a\n   b\n\n  \tc", 0..14));
        assert_eq!(shift(&inwards, selection, false).0, text);
        assert_eq!(shift(text, 0..text.len(), false).0, "a\nb\n\nc");
        assert_eq!(shift("  a", 3..3, false), ("a".to_owned(), 1..1));
        assert_eq!(shift("  a", 1..1, false), ("a".to_owned(), 0..0));
    }
}
