//! A page of several sections, each written by a command of its own.

use super::console::Failure;
use std::path::Path;

/// Sections in the order of a page; those with other names come after.
const ORDER: [&str; 2] = ["bench", "errors"];

/// Puts a section into a page: in place of the one of that name, where the page has one. The others stay as they are; a page that has no
/// sections is written anew. `text` is Markdown.
pub fn put(file: &Path, name: &str, text: &str) -> Result<(), Failure> {
    let old = std::fs::read_to_string(file).unwrap_or_default();
    std::fs::write(file, with(&old, name, text)).map_err(|e| Failure::usage(format!("can't write {}: {e}", file.display())))
}

fn with(page: &str, name: &str, text: &str) -> String {
    let mut sections = sections(page);
    match sections.iter_mut().find(|(known, _)| known == name) {
        Some((_, old)) => *old = text.to_owned(),
        None => sections.push((name.to_owned(), text.to_owned())),
    }
    sections.sort_by_key(|(name, _)| ORDER.iter().position(|known| known == name).unwrap_or(ORDER.len()));
    let whole = |(name, text): &(String, String)| format!("{}\n{}\n{}\n", begin(name), text.trim_end(), end(name));
    sections.iter().map(whole).collect::<Vec<_>>().join("\n")
}

/// The sections of a page, in their order.
fn sections(page: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let mut rest = page;
    while let Some((_, after)) = rest.split_once("<!-- section ")
        && let Some((name, after)) = after.split_once(" -->\n")
        && let Some((text, after)) = after.split_once(&end(name))
    {
        found.push((name.to_owned(), text.to_owned()));
        rest = after;
    }
    found
}

fn begin(name: &str) -> String {
    format!("<!-- section {name} -->")
}

fn end(name: &str) -> String {
    format!("<!-- end of {name} -->")
}

#[cfg(test)]
mod tests {
    use super::with;

    #[test]
    fn a_section_is_replaced_and_the_others_stay() {
        let page = with("# An old page\n", "stress", "## Stress\n\nall green\n");
        let page = with(&page, "bench", "# Time\n");
        assert_eq!(page.matches("# Time\n").count(), 1);
        assert!(page.find("# Time") < page.find("## Stress") && !page.contains("An old page"), "{page}");
        let again = with(&page, "stress", "## Stress\n\none red\n");
        assert!(again.contains("# Time\n") && again.contains("one red") && !again.contains("all green"), "{again}");
        assert_eq!(with(&again, "stress", "## Stress\n\none red"), again);
    }
}
