//! What an edit costs: one number of the scene's text is another, and what was found before is kept.

use super::timing::{in_memory, milliseconds, percentile};
use crate::command::console::{Exit, Failure, compile_file, print, show_diagnostics};
use std::time::{Duration, Instant};
use surefoot_compiler::{Loader, Memory, Options, compile_remembering};

/// Edits the numbers of a scene's text one after the other, so many times in all, and prints what that took.
pub fn run(path: &str, runs: u32) -> Result<Exit, Failure> {
    let first = compile_file(path, &Options::default())?;
    show_diagnostics(&first);
    if first.compiled.is_none() {
        return Ok(Exit::Errors);
    }
    let loader = in_memory(&first);
    let text = loader.read(path).ok().and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_default();
    let numbers = numbers(&text);
    let mut memory = Memory::default();
    compile_remembering(&loader, path, &Options::default(), &mut memory, &mut |_| {});
    let whole = memory.searched;
    let (mut times, mut searched): (Vec<Duration>, Vec<u64>) = (Vec::new(), Vec::new());
    for &(start, end) in numbers.iter().cycle().take(runs as usize) {
        let edited = format!("{}{}1{}", &text[..start], &text[start..end], &text[end..]);
        let loader = loader.clone().with(path, edited);
        let mut memory = memory.clone();
        let before = memory.searched;
        let began = Instant::now();
        let outcome = compile_remembering(&loader, path, &Options::default(), &mut memory, &mut |_| {});
        if outcome.compiled.is_some() {
            times.push(began.elapsed());
            searched.push(memory.searched - before);
        }
    }
    times.sort_unstable();
    searched.sort_unstable();
    let middle = searched.get(searched.len() / 2).copied().unwrap_or(0);
    let text = format!(
        "{path}, {} edits of one number\n  median{:>9.3} ms\n  p95   {:>9.3} ms\n  searches after an edit: median {middle}, at most {}, of {whole}\n",
        times.len(),
        milliseconds(percentile(&times, 50)),
        milliseconds(percentile(&times, 95)),
        searched.last().copied().unwrap_or(0),
    );
    print(text.as_bytes())?;
    Ok(Exit::Fine)
}

/// The places of the numbers with a point in a text, comments and colours left out: a digit can be added to them.
fn numbers(text: &str) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let code = line.split("//").next().unwrap_or(line);
        let mut begin = None;
        for (i, c) in code.char_indices().chain([(code.len(), ' ')]) {
            match (begin, c.is_ascii_digit() || c == '.') {
                (None, true) if c != '.' => begin = Some(i),
                (Some(b), false) => {
                    let number = &code[b..i];
                    let before = code[..b].chars().next_back();
                    let alone = before.is_none_or(|c| !c.is_alphanumeric() && c != '_' && c != '#');
                    if alone && number.contains('.') && !number.contains("..") && !number.ends_with('.') && !c.is_alphabetic() {
                        found.push((at + b, at + i));
                    }
                    begin = None;
                }
                _ => {}
            }
        }
        at += line.len();
    }
    found
}

#[cfg(test)]
mod tests {
    #[test]
    fn numbers_that_can_be_edited_are_found() {
        let text = "param a = 0.5 in 0..1 // 7.5\nscene = sphere(1.25).rotate(y, 30deg).material(#123456)\n";
        let found: Vec<_> = super::numbers(text).into_iter().map(|(a, b)| &text[a..b]).collect();
        assert_eq!(found, ["0.5", "1.25"]);
    }
}
