//! What the documentation says of a word: taken from the reference, the kernel's table and the prelude's comments, so that each thing is said once.

use crate::graph::kernel::KERNEL;
use crate::program::blocks::block_words;
use crate::reference_text::{CHAPTERS, Entry, HEAD, entries};
use crate::syntax::ast::BlockKind;
use std::sync::LazyLock;

/// The entries of the prelude, in the order of the reference.
static ENTRIES: LazyLock<Vec<Entry>> = LazyLock::new(|| CHAPTERS.iter().flat_map(|(name, _, text)| entries(name, text)).collect());

/// The entries of a name of the prelude: one for each overload.
pub(super) fn of_prelude(name: &str) -> impl Iterator<Item = &'static Entry> {
    ENTRIES.iter().filter(move |entry| entry.name == name)
}

/// What an entry says, as Markdown.
pub(super) fn entry_text(entry: &Entry) -> String {
    let mut text = entry.text.clone();
    if !entry.requires.is_empty() {
        let conditions: Vec<String> = entry.requires.iter().map(|r| format!("`{r}`")).collect();
        text.push_str(&format!(" Needs {}.", conditions.join(", ")));
    }
    if !entry.example.is_empty() {
        text.push_str(&format!("\n\n```sdf\nscene = {}\n```", entry.example));
    }
    if !entry.source.is_empty() {
        text.push_str(&format!("\n\n*{}*", entry.source));
    }
    text
}

/// What a built-in function does.
pub(super) fn of_function(name: &str) -> Option<String> {
    let row = KERNEL.iter().find(|row| row.callable && row.name == name);
    row.map(|row| row.doc.to_owned()).or_else(|| {
        let written = [format!("`{name}("), format!("`{name}`"), format!("`s.{name}("), format!("`s.{name}`"), format!(" {name}(")];
        let (_, text) = rows().find(|(first, _)| written.iter().any(|w| first.contains(w.as_str())))?;
        Some(text.to_owned())
    })
}

/// What a built-in value is.
pub(super) fn of_value(name: &str) -> Option<&'static str> {
    Some(match name {
        "p" => "The point in the own space of the shape where the formula is used. In a drawing it has two components.",
        "world" => "The point of the scene.",
        "normal" => "The direction in which the surface faces. It exists in materials.",
        "time" => "The time in seconds.",
        "pi" => "Half of a turn in radians.",
        "tau" => "A whole turn in radians.",
        "x" => "The unit vector along x.",
        "y" => "The unit vector along y, which points up.",
        "z" => "The unit vector along z.",
        "nothing" => "The empty shape.",
        "on" | "true" => "The condition that holds.",
        "off" | "false" => "The condition that does not hold.",
        _ => return None,
    })
}

/// What a word of the language does: the paragraph of the reference that explains it.
pub(super) fn of_keyword(word: &str) -> Option<String> {
    let heading = match word {
        "scene" => "## A first scene",
        "import" | "as" => "## Several files: `import`",
        "param" => "## Live values: `param`",
        "let" => "## Names: `let`",
        "if" | "else" => "## Choosing: `if`",
        "for" | "in" | "by" => "## Many of one: `for`",
        "material" => "## Materials",
        "field" | "field2" | "warp" | "warp2" | "blend" | "fn" | "shape" | "shape2" => {
            let word = word.trim_end_matches('2');
            let start = format!("**`{word}`**");
            return HEAD.lines().find(|line| line.starts_with(&start)).map(str::to_owned);
        }
        "while" => return HEAD.lines().find(|line| line.starts_with("**Formulas that iterate.**")).map(str::to_owned),
        "camera" | "light" | "environment" | "render" | "physics" | "balls" | "mesh" => {
            return bullet(word).map(|line| first_sentences(line, 2)).map(|text| format!("{text}\n\n```sdf\n{}\n```", example(word).unwrap_or("")));
        }
        _ => return None,
    };
    let after = HEAD.split_once(heading)?.1.trim_start();
    let paragraph = after.split("\n\n").next().unwrap_or("");
    let code = after.split("```").nth(1).filter(|_| after.find("```") < after.find("\n## "));
    Some(match (paragraph.starts_with("```"), code) {
        (false, _) => paragraph.to_owned(),
        (true, Some(code)) => format!("```sdf\n{}\n```", code.trim()),
        (true, None) => String::new(),
    })
}

/// What a key of a block says; of a material where there is no block.
pub(super) fn of_key(kind: Option<BlockKind>, key: &str) -> Option<String> {
    let Some(kind) = kind else {
        let cell = format!("`{key}`");
        return rows().find(|(first, _)| first.trim() == cell).map(|(_, text)| text.to_owned());
    };
    let word = block_words(kind);
    let line = bullet(word)?;
    let named = [format!("`{key}`"), format!("`{key}:"), format!(", {key}:"), format!("`{key} ")];
    let told: Vec<&str> = sentences(line).filter(|sentence| named.iter().any(|name| sentence.contains(name.as_str()))).collect();
    let shown = example(word).and_then(|text| {
        let at = text.find(&format!("{key}: "))?;
        let rest = text.get(at..)?;
        // As far as the comma before the next key.
        let end = rest.match_indices(", ").find(|(at, _)| {
            let after = rest.get(at + 2..).unwrap_or("");
            let word = after.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').next().unwrap_or("");
            !word.is_empty() && after.get(word.len()..).is_some_and(|rest| rest.starts_with(": "))
        });
        Some(rest.get(..end.map_or(rest.len(), |(at, _)| at))?.trim_end_matches([' ', '}']).to_owned())
    });
    match (told.is_empty(), shown) {
        (false, Some(shown)) => Some(format!("{}\n\nFor example `{shown}`.", told.join(" "))),
        (false, None) => Some(told.join(" ")),
        (true, Some(shown)) => Some(format!("For example `{shown}`.")),
        (true, None) => None,
    }
}

/// The words that stand as the value of a key, each as it is written.
pub(super) fn values_of(kind: Option<BlockKind>, key: &str) -> &'static [&'static str] {
    match (kind, key) {
        (None, "solid") => &["on", "off"],
        (Some(BlockKind::Light), "shadow") => &["none", "hard", "soft(16)", "map"],
        (Some(BlockKind::Camera), "projection") => &["perspective", "orthographic"],
        (Some(BlockKind::Environment), "sky") => &["gradient(#87a7d0, #e8eef5)", "cubemap(\"folder/\")", "equirect(\"sky.hdr\")"],
        (Some(BlockKind::Render), "tone") => &["aces", "agx", "neutral", "none"],
        (Some(BlockKind::Render), "unit") => &["um", "mm", "cm", "m", "in", "ft"],
        (Some(BlockKind::Render), "shadows") => &["on", "off"],
        (Some(BlockKind::Render), "ambient_occlusion") => &["off"],
        _ => &[],
    }
}

/// The rows of all tables of two columns.
fn rows() -> impl Iterator<Item = (&'static str, &'static str)> {
    HEAD.lines().filter_map(|line| line.strip_prefix("| ")?.strip_suffix(" |")?.split_once(" | "))
}

fn bullet(word: &str) -> Option<&'static str> {
    HEAD.lines().find_map(|line| line.strip_prefix("- **")?.strip_prefix(word)?.strip_prefix("**: "))
}

/// The block as the reference shows it.
fn example(word: &str) -> Option<&'static str> {
    let shown = HEAD.split_once("\n## Camera, lights and the rest")?.1;
    shown.split("```").nth(1)?.lines().find(|line| line.strip_prefix(word).is_some_and(|rest| rest.starts_with(' ')))
}

/// The sentences of a line. A point within brackets, quotes or a number ends none.
fn sentences(line: &str) -> impl Iterator<Item = &str> {
    let mut ends: Vec<usize> = Vec::new();
    let (mut code, mut depth) = (false, 0usize);
    for (at, c) in line.char_indices() {
        match c {
            '`' => code = !code,
            '(' if !code => depth += 1,
            ')' if !code => depth = depth.saturating_sub(1),
            '.' if !code && depth == 0 && line.get(at + 1..).is_none_or(|rest| rest.is_empty() || rest.starts_with(' ')) => ends.push(at + 1),
            _ => {}
        }
    }
    let mut start = 0;
    ends.into_iter().filter_map(move |end| {
        let sentence = line.get(start..end);
        start = end;
        sentence.map(str::trim)
    })
}

fn first_sentences(line: &str, count: usize) -> String {
    sentences(line).take(count).collect::<Vec<_>>().join(" ")
}
