//! Texts with gaps: `%%NAME%%` stands for a part.

/// The text with its gaps filled. What stands in a part is no gap.
pub fn fill(template: &str, parts: &[(&str, &str)]) -> String {
    let mut text = String::with_capacity(template.len());
    for piece in template.split("%%") {
        text.push_str(parts.iter().find(|(name, _)| *name == piece).map_or(piece, |(_, part)| part));
    }
    text
}

/// A text between backquotes of JavaScript, which ends no script that stands in a page.
pub fn quoted(text: &str) -> String {
    text.replace('\\', "\\\\").replace("</", "<\\/").replace('`', "\\`").replace("${", "\\${")
}

/// A text as the end of one line of a comment.
pub fn on_one_line(text: &str) -> String {
    text.replace(char::is_control, " ")
}
