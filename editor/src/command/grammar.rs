//! The grammar of the language for editors that colour by regular expressions (TextMate's), made of the compiler's own words; and the classes that it has to agree
//! with.
//!
//! A grammar sees one line at a time. So words that mean something in one place only are known by what stands beside them on their line.

use serde_json::{Value, json};
use surefoot_compiler::syntax::{TokenClass, tokens, words};

/// The grammar, as the text of its file.
pub(super) fn grammar() -> String {
    let any = |words: &[&str]| words.join("|");
    let reserved: Vec<&str> = words::DECLARATIONS.iter().chain(words::EXPRESSIONS).copied().collect();
    let kinds: Vec<&str> = words::DECLARATIONS.iter().filter(|word| !is_statement(word)).copied().collect();
    let keywords: Vec<&str> = words::DECLARATIONS.iter().filter(|word| is_statement(word)).chain(words::EXPRESSIONS).copied().collect();
    let name = "[A-Za-z_][A-Za-z0-9_]*";
    // What stands right before is a value, and no word of the language.
    let after_value = format!("(?<=[A-Za-z0-9_)\\]}}] )(?<!{})", reserved.iter().map(|word| format!("\\b{word} ")).collect::<Vec<_>>().join("|"));
    let number = "(?:[0-9]+(?:\\.[0-9]+)?|\\.[0-9]+)(?:[eE][+-]?[0-9]+)?[A-Za-z0-9_]*(?:(?<=[0-9A-Za-z_])\\.(?![._A-Za-z0-9]))?";
    let operator = "keyword.operator.surefoot";
    let code = json!([
        { "name": "comment.block.surefoot", "begin": "/\\*", "end": "\\*/", "patterns": [{ "include": "#comment" }] },
        { "name": "comment.line.documentation.surefoot", "match": "///(?!/).*$|//!.*$" },
        { "name": "comment.line.double-slash.surefoot", "match": "//.*$" },
        { "name": "string.quoted.double.surefoot", "begin": "\"", "end": "\"|$", "patterns": [{ "name": "constant.character.escape.surefoot", "match": "\\\\." }] },
        { "name": "constant.other.color.surefoot", "match": "#(?:[0-9a-fA-F]{6}|[0-9a-fA-F]{3})(?![A-Za-z0-9_])" },
        // A name after a dot, whatever it is elsewhere. Two dots are a range.
        { "name": operator, "match": "\\.\\." },
        { "match": format!("(\\.)\\s*({name})(?=\\s*\\()"), "captures": { "1": { "name": operator }, "2": { "name": "entity.name.function.surefoot" } } },
        { "match": format!("(\\.)\\s*({name})"), "captures": { "1": { "name": operator }, "2": { "name": "variable.other.property.surefoot" } } },
        { "name": "constant.numeric.surefoot", "match": number },
        // A type after a colon.
        { "match": format!("(:(?:\\s*\\[)*)\\s*({})\\b(?!\\s*:)", any(words::TYPES)), "captures": { "1": { "name": operator }, "2": { "name": "storage.type.surefoot" } } },
        { "name": "variable.parameter.surefoot", "match": format!("{name}(?=\\s*:)") },
        { "name": "keyword.control.surefoot", "match": format!("\\b(?:{})\\b", any(&keywords)) },
        { "name": "storage.type.surefoot", "match": format!("\\b(?:{})\\b", any(&kinds)) },
        { "name": "keyword.control.surefoot", "match": "(?<=\" )as\\b" },
        { "name": "keyword.control.surefoot", "match": format!("(?:{after_value}|^\\s*)by\\b(?=\\s*[A-Za-z_+*])") },
        { "name": "keyword.control.surefoot", "match": format!("{after_value}exact\\b(?=\\s*=(?!=))") },
        { "name": "keyword.control.surefoot", "match": format!("(?:{after_value}|^\\s*)lipschitz\\b") },
        { "name": "entity.name.function.surefoot", "match": format!("\\b{name}(?=\\s*\\()") },
        { "name": "variable.other.surefoot", "match": format!("\\b{name}") },
        { "name": operator, "match": "[-+*/%&|!<>=]|[.,;:()\\[\\]{}]" },
    ]);
    let grammar = json!({
        "$schema": "https://raw.githubusercontent.com/martinring/tmlanguage/master/tmlanguage.json",
        "comment": "Written by `surefoot reference --grammar` from the compiler's words. Do not edit.",
        "name": "Surefoot",
        "scopeName": "source.surefoot",
        "fileTypes": ["sdf"],
        "patterns": code,
        "repository": { "comment": { "name": "comment.block.surefoot", "begin": "/\\*", "end": "\\*/", "patterns": [{ "include": "#comment" }] } },
    });
    format!("{grammar:#}\n")
}

/// Whether a word that starts a declaration says what is done, and not what is declared.
fn is_statement(word: &str) -> bool {
    matches!(word, "import" | "param" | "let")
}

/// The tokens of a text as the window colours them: first and last byte, and class.
pub(super) fn classes(text: &str) -> Value {
    let class = |class| match class {
        TokenClass::Keyword => "keyword",
        TokenClass::Kind => "kind",
        TokenClass::Name => "name",
        TokenClass::Number => "number",
        TokenClass::Text => "text",
        TokenClass::Color => "color",
        TokenClass::Comment => "comment",
        TokenClass::Doc => "doc",
        TokenClass::Operator => "operator",
        TokenClass::Error => "error",
    };
    tokens(text).into_iter().map(|(range, of)| json!([range.start, range.end, class(of)])).collect()
}

#[cfg(test)]
mod tests {
    use super::grammar;

    /// `SUREFOOT_WRITE=1` writes it.
    #[test]
    fn the_file_is_what_the_words_make() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/vscode/syntaxes/surefoot.tmLanguage.json");
        if std::env::var_os("SUREFOOT_WRITE").is_some() {
            std::fs::write(path, grammar()).unwrap();
        }
        assert_eq!(std::fs::read_to_string(path).unwrap_or_default(), grammar(), "run `surefoot reference --grammar > editor/vscode/syntaxes/surefoot.tmLanguage.json`");
    }
}
