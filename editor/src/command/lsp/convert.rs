//! What the service says, in the words of the protocol.

use lsp_types::{
    CompletionItem, CompletionItemKind, CompletionTextEdit, DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag, Documentation, FoldingRange,
    FoldingRangeKind, InsertTextFormat, Location, MarkupContent, MarkupKind, NumberOrString, ParameterInformation, ParameterLabel, Position, Range, SemanticToken,
    SemanticTokenModifier, SemanticTokenType, SignatureInformation, SymbolKind, TextEdit, Uri,
};
use surefoot_compiler::diagnostic::{Code, Diagnostic, Severity};
use surefoot_compiler::language_service::{Completion, CompletionKind, Fold, Lines, Meaning, OutlineKind, Painted, Signature};
use surefoot_compiler::source::Span;
use surefoot_compiler::syntax::TokenClass;

/// The position of a byte.
pub(super) fn position(lines: &Lines<'_>, offset: usize) -> Position {
    let at = lines.position(offset);
    Position::new(at.line, at.column)
}

/// The range of some bytes.
pub(super) fn range(lines: &Lines<'_>, bytes: std::ops::Range<usize>) -> Range {
    Range::new(position(lines, bytes.start), position(lines, bytes.end))
}

/// Words that a client may lay out.
pub(super) fn markdown(value: String) -> MarkupContent {
    MarkupContent { kind: MarkupKind::Markdown, value }
}

/// What the compiler says. `place` tells where a place in any text is.
pub(super) fn diagnostic(told: &Diagnostic, lines: &Lines<'_>, place: &dyn Fn(Span) -> Option<(Uri, Range)>) -> lsp_types::Diagnostic {
    let related = told.labels.iter().filter_map(|(span, words)| {
        let (uri, range) = place(*span)?;
        Some(DiagnosticRelatedInformation { location: Location { uri, range }, message: words.clone() })
    });
    let help = if told.help.is_empty() { String::new() } else { format!("\nhelp: {}", told.help) };
    let severity = match told.severity {
        // A file of parts has none, and that is well.
        _ if told.code == Code::NoScene => DiagnosticSeverity::INFORMATION,
        Severity::Error => DiagnosticSeverity::ERROR,
        Severity::Warning => DiagnosticSeverity::WARNING,
    };
    lsp_types::Diagnostic {
        range: range(lines, told.span.range()),
        severity: Some(severity),
        code: Some(NumberOrString::String(told.code.row().name.to_owned())),
        source: Some("surefoot".to_owned()),
        message: format!("{}{help}", told.message),
        related_information: Some(related.collect()),
        tags: (told.code == Code::Unused).then(|| vec![DiagnosticTag::UNNECESSARY]),
        ..lsp_types::Diagnostic::default()
    }
}

/// A declaration that nothing uses: an editor shows it faded.
pub(super) fn unused(name: &str, range: Range) -> lsp_types::Diagnostic {
    lsp_types::Diagnostic {
        range,
        severity: Some(DiagnosticSeverity::HINT),
        source: Some("surefoot".to_owned()),
        message: format!("nothing uses `{name}`"),
        tags: Some(vec![DiagnosticTag::UNNECESSARY]),
        ..lsp_types::Diagnostic::default()
    }
}

/// A completion. `snippets`: whether the client steps through places.
pub(super) fn completion(found: Completion, lines: &Lines<'_>, snippets: bool) -> CompletionItem {
    let kind = match found.kind {
        CompletionKind::Argument => CompletionItemKind::FIELD,
        CompletionKind::Keyword => CompletionItemKind::KEYWORD,
        CompletionKind::Type => CompletionItemKind::TYPE_PARAMETER,
        CompletionKind::File => CompletionItemKind::FILE,
        CompletionKind::Name(meaning) => match meaning {
            Meaning::Slider | Meaning::Parameter | Meaning::Local | Meaning::Block => CompletionItemKind::VARIABLE,
            Meaning::Constant | Meaning::Value => CompletionItemKind::CONSTANT,
            Meaning::Material => CompletionItemKind::COLOR,
            Meaning::Field | Meaning::Shape => CompletionItemKind::CLASS,
            Meaning::Warp => CompletionItemKind::METHOD,
            Meaning::Blend | Meaning::Function => CompletionItemKind::FUNCTION,
            Meaning::Key | Meaning::Component => CompletionItemKind::PROPERTY,
            Meaning::Import => CompletionItemKind::MODULE,
            Meaning::Path => CompletionItemKind::FILE,
            Meaning::Word => CompletionItemKind::ENUM_MEMBER,
        },
    };
    let snippet = found.snippet.filter(|_| snippets);
    let format = snippet.as_ref().map(|_| InsertTextFormat::SNIPPET);
    CompletionItem {
        kind: Some(kind),
        detail: (!found.signature.is_empty()).then_some(found.signature),
        documentation: (!found.text.is_empty()).then(|| Documentation::MarkupContent(markdown(found.text))),
        sort_text: Some(format!("{}{}", found.rank, found.label)),
        insert_text_format: format,
        text_edit: Some(CompletionTextEdit::Edit(TextEdit { range: range(lines, found.span.range()), new_text: snippet.unwrap_or(found.insert) })),
        label: found.label,
        ..CompletionItem::default()
    }
}

/// A way to call something.
pub(super) fn signature(found: Signature) -> SignatureInformation {
    // Clients count in units of UTF-16; signatures are plain letters, but for what a person has written in them.
    let units = |bytes: usize| found.label.get(..bytes).map_or(0, |text| text.encode_utf16().count() as u32);
    let parameters = found.parameters.iter().map(|range| ParameterInformation { label: ParameterLabel::LabelOffsets([units(range.start), units(range.end)]), documentation: None });
    SignatureInformation {
        parameters: Some(parameters.collect()),
        active_parameter: found.active.map(|active| active as u32),
        documentation: (!found.text.is_empty()).then(|| Documentation::MarkupContent(markdown(found.text.clone()))),
        label: found.label.clone(),
    }
}

/// What an entry of an outline is.
pub(super) fn symbol(kind: OutlineKind) -> SymbolKind {
    match kind {
        OutlineKind::Import => SymbolKind::MODULE,
        OutlineKind::Slider => SymbolKind::VARIABLE,
        OutlineKind::Constant => SymbolKind::CONSTANT,
        OutlineKind::Material => SymbolKind::STRUCT,
        OutlineKind::Shape => SymbolKind::CLASS,
        OutlineKind::Function => SymbolKind::FUNCTION,
        OutlineKind::Scene => SymbolKind::NAMESPACE,
        OutlineKind::Block => SymbolKind::OBJECT,
        OutlineKind::Key => SymbolKind::FIELD,
    }
}

/// A part that can be folded: its last line stays where a bracket closes.
pub(super) fn fold(fold: Fold, lines: &Lines<'_>) -> FoldingRange {
    let whole = range(lines, fold.span.range());
    let closes = u32::from(!fold.is_comment && !fold.is_imports);
    FoldingRange {
        start_line: whole.start.line,
        end_line: whole.end.line.saturating_sub(closes).max(whole.start.line),
        kind: match (fold.is_comment, fold.is_imports) {
            (true, _) => Some(FoldingRangeKind::Comment),
            (_, true) => Some(FoldingRangeKind::Imports),
            _ => None,
        },
        ..FoldingRange::default()
    }
}

/// The types of tokens, in the order of their numbers.
pub(super) const TOKEN_TYPES: [SemanticTokenType; 14] = [
    SemanticTokenType::KEYWORD,
    SemanticTokenType::TYPE,
    SemanticTokenType::NUMBER,
    SemanticTokenType::STRING,
    SemanticTokenType::COMMENT,
    SemanticTokenType::OPERATOR,
    SemanticTokenType::VARIABLE,
    SemanticTokenType::PARAMETER,
    SemanticTokenType::PROPERTY,
    SemanticTokenType::FUNCTION,
    SemanticTokenType::METHOD,
    SemanticTokenType::NAMESPACE,
    SemanticTokenType::ENUM_MEMBER,
    SemanticTokenType::CLASS,
];

/// Their modifiers, in the order of their bits.
pub(super) const TOKEN_MODIFIERS: [SemanticTokenModifier; 4] =
    [SemanticTokenModifier::DECLARATION, SemanticTokenModifier::READONLY, SemanticTokenModifier::DEFAULT_LIBRARY, SemanticTokenModifier::DOCUMENTATION];

/// The type and the modifiers of a token; none for what can't be read, and for signs.
fn token(painted: &Painted) -> Option<(u32, u32)> {
    let kind = match (painted.class, painted.meaning) {
        (TokenClass::Name | TokenClass::Text, Some(meaning)) => match meaning {
            Meaning::Slider | Meaning::Local | Meaning::Constant | Meaning::Value | Meaning::Block => 6,
            Meaning::Parameter => 7,
            Meaning::Key | Meaning::Component => 8,
            Meaning::Material => 13,
            Meaning::Warp => 10,
            Meaning::Field | Meaning::Shape | Meaning::Blend | Meaning::Function if painted.after_dot => 10,
            Meaning::Field | Meaning::Shape | Meaning::Blend | Meaning::Function => 9,
            Meaning::Import => 11,
            Meaning::Path => 3,
            Meaning::Word => 12,
        },
        (TokenClass::Keyword, _) => 0,
        (TokenClass::Kind, _) => 1,
        (TokenClass::Number | TokenClass::Color, _) => 2,
        (TokenClass::Text, None) => 3,
        (TokenClass::Comment | TokenClass::Doc, _) => 4,
        (TokenClass::Operator, _) => 5,
        (TokenClass::Name, None) | (TokenClass::Error, _) => return None,
    };
    let bits = [
        painted.declares,
        matches!(painted.meaning, Some(Meaning::Constant | Meaning::Value)),
        painted.is_built_in,
        painted.class == TokenClass::Doc,
    ];
    Some((kind, bits.iter().enumerate().map(|(at, set)| u32::from(*set) << at).sum()))
}

/// The tokens of a text as numbers, each counted from the one before. What goes over several lines is one token for each.
pub(super) fn tokens(painted: &[Painted], text: &str, lines: &Lines<'_>, within: std::ops::Range<usize>) -> Vec<SemanticToken> {
    let mut out = Vec::new();
    let mut last = Position::new(0, 0);
    for one in painted.iter().filter(|one| one.range.start < within.end && within.start < one.range.end) {
        let Some((token_type, token_modifiers_bitset)) = token(one) else { continue };
        let mut start = one.range.start;
        for piece in text.get(one.range.clone()).unwrap_or("").split_inclusive('\n') {
            let written = piece.trim_end_matches(['\n', '\r']);
            let length = written.encode_utf16().count() as u32;
            if length > 0 {
                let at = position(lines, start);
                let delta_line = at.line - last.line;
                let delta_start = if delta_line == 0 { at.character - last.character } else { at.character };
                out.push(SemanticToken { delta_line, delta_start, length, token_type, token_modifiers_bitset });
                last = at;
            }
            start += piece.len();
        }
    }
    out
}
