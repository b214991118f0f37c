//! Diagnostics as data, with places as JavaScript and editors count them.

use serde_json::{Value, json};
use surefoot_compiler::diagnostic::{Diagnostic, Severity, shown};
use surefoot_compiler::source::{Sources, Span};

/// The diagnostics that a person is shown, in their order.
pub fn found(sources: &Sources, diagnostics: &[Diagnostic]) -> Vec<Value> {
    shown(diagnostics).0.into_iter().map(|one| diagnostic(sources, one)).collect()
}

fn diagnostic(sources: &Sources, one: &Diagnostic) -> Value {
    let mut value = json!({
        "severity": if one.severity == Severity::Error { "error" } else { "warning" },
        "code": one.code.row().name,
        "message": one.message,
        "help": one.help,
    });
    let labels = one.labels.iter().map(|(span, words)| {
        let mut label = place(sources, *span);
        label["message"] = json!(words);
        label
    });
    let labels: Vec<Value> = labels.collect();
    if let (Some(value), Value::Object(place)) = (value.as_object_mut(), place(sources, one.span)) {
        value.extend(place);
        value.insert("labels".to_owned(), json!(labels));
    }
    value
}

/// A span: `start` and `end` in units of UTF-16 from the text's beginning, as JavaScript counts; `bytes` the same in UTF-8; lines and columns from 1,
/// columns in units of UTF-16.
fn place(sources: &Sources, span: Span) -> Value {
    let Some(source) = sources.get(span.file) else { return json!({ "file": "", "start": 0, "end": 0, "bytes": [0, 0], "line": 1, "column": 1, "endLine": 1, "endColumn": 1 }) };
    let text: &str = &source.text;
    let within = |byte: u32| (0..=(byte as usize).min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0);
    let (start, end) = (within(span.start), within(span.end.max(span.start)));
    let units = |upto: usize| text.get(..upto).unwrap_or_default().encode_utf16().count();
    let of = |at: usize| {
        let before = text.get(..at).unwrap_or_default();
        let line = before.rfind('\n').map_or(0, |end| end + 1);
        (before.matches('\n').count() + 1, units(at) - units(line) + 1)
    };
    let ((line, column), (end_line, end_column)) = (of(start), of(end));
    json!({
        "file": source.name, "start": units(start), "end": units(end), "bytes": [start, end],
        "line": line, "column": column, "endLine": end_line, "endColumn": end_column,
    })
}
