//! What the client asks, each answered from names alone or from the newest compilation.

use super::convert;
use super::documents::{Document, offset, uri_of};
use super::project::prelude_file;
use super::state::State;
use lsp_server::{ErrorCode, Request, RequestId, Response};
use lsp_types::{
    CodeAction, CodeActionKind, CodeActionParams, ColorInformation, ColorPresentation, ColorPresentationParams, CompletionList, CompletionParams, DocumentColorParams,
    DocumentFormattingParams, DocumentHighlight, DocumentHighlightKind, DocumentHighlightParams, DocumentSymbol, DocumentSymbolParams, FoldingRangeParams,
    GotoDefinitionParams, Hover, HoverContents, HoverParams, InlayHint, InlayHintKind, InlayHintLabel, InlayHintParams, InlayHintTooltip, Location, LocationLink, Position,
    PrepareRenameResponse, Range, ReferenceParams, RenameParams, SemanticTokens, SemanticTokensParams, SemanticTokensRangeParams, SignatureHelp, SignatureHelpParams,
    SymbolInformation, TextDocumentPositionParams, TextEdit, Uri, WorkspaceEdit, WorkspaceSymbolParams,
};
use serde::de::DeserializeOwned;
use serde::Serialize;
use serde_json::Value;
use std::collections::HashMap;
use std::rc::Rc;
use surefoot_compiler::language_service::{self as service, Edit, FactorAt, Lines, Outline, Report, World};
use surefoot_compiler::source::{FileId, Span};
use surefoot_compiler::syntax;

/// Why there is no answer: a code of the protocol and words.
type Refused = (ErrorCode, String);
type Answer = Result<Value, Refused>;

/// The answer to a request. What is not known is refused, what is not open has none.
pub(super) fn answer(state: &mut State, request: Request) -> Response {
    let Request { id, method, params } = request;
    let done = match method.as_str() {
        "textDocument/completion" => with(params, |p| completion(state, p)),
        "textDocument/signatureHelp" => with(params, |p| signature_help(state, p)),
        "textDocument/hover" => with(params, |p| hover(state, p)),
        "textDocument/definition" => with(params, |p| definition(state, p)),
        "textDocument/references" => with(params, |p| references(state, p)),
        "textDocument/documentHighlight" => with(params, |p| highlights(state, p)),
        "textDocument/prepareRename" => with(params, |p| prepare_rename(state, p)),
        "textDocument/rename" => with(params, |p| rename(state, p)),
        "textDocument/documentSymbol" => with(params, |p| symbols(state, p)),
        "workspace/symbol" => with(params, |p| workspace_symbols(state, p)),
        "textDocument/foldingRange" => with(params, |p| folds(state, p)),
        "textDocument/formatting" => with(params, |p| formatting(state, p)),
        "textDocument/semanticTokens/full" => with(params, |p: SemanticTokensParams| tokens(state, &p.text_document.uri, None)),
        "textDocument/semanticTokens/range" => with(params, |p: SemanticTokensRangeParams| tokens(state, &p.text_document.uri, Some(p.range))),
        "textDocument/inlayHint" => with(params, |p| inlay_hints(state, p)),
        "textDocument/documentColor" => with(params, |p| colors(state, p)),
        "textDocument/colorPresentation" => with(params, color_presentation),
        "textDocument/codeAction" => with(params, |p| code_actions(state, p)),
        _ => Err((ErrorCode::MethodNotFound, format!("there is no method `{method}`"))),
    };
    respond(id, done)
}

fn respond(id: RequestId, done: Answer) -> Response {
    match done {
        Ok(value) => Response::new_ok(id, value),
        Err((code, words)) => Response::new_err(id, code as i32, words),
    }
}

fn with<P: DeserializeOwned>(params: Value, run: impl FnOnce(P) -> Answer) -> Answer {
    run(serde_json::from_value(params).map_err(|error| (ErrorCode::InvalidParams, error.to_string()))?)
}

fn value(answer: impl Serialize) -> Answer {
    serde_json::to_value(answer).map_err(|error| (ErrorCode::InternalError, error.to_string()))
}

/// A document and its world.
struct Open {
    document: Document,
    path: String,
    world: Rc<World>,
    file: FileId,
}

impl Open {
    fn lines(&self) -> Lines<'_> {
        Lines::new(&self.document.text)
    }

    fn offset(&self, position: Position) -> usize {
        offset(&self.lines(), position)
    }
}

impl State {
    fn open(&mut self, uri: &Uri, whole: bool) -> Option<Open> {
        let path = super::documents::path_of(uri);
        let document = self.documents.get(&path)?.clone();
        let world = self.world(&path, whole);
        let file = world.file(&path)?;
        Some(Open { document, path, world, file })
    }

    /// The factors of a document, where its text was compiled as it is: by itself, or as a part of another scene that is open.
    fn factors(&self, open: &Open) -> Vec<FactorAt> {
        let is_same = |report: &&Report| {
            let file = report.file(&open.path).and_then(|file| report.sources.get(file));
            file.is_some_and(|file| file.text == open.document.text)
        };
        let reports = self.known.values().map(|known| &known.report).filter(is_same);
        reports.flat_map(|report| &report.factors).filter(|factor| factor.path == open.path).cloned().collect()
    }

    /// Where a place of a world is for the client.
    fn location(&self, world: &World, span: Span) -> Option<Location> {
        let path = world.path(span.file);
        let uri = match self.documents.get(path) {
            Some(document) => document.uri.clone(),
            None if path.starts_with('<') => uri_of(&prelude_file(path)?)?,
            None => uri_of(path)?,
        };
        Some(Location::new(uri, convert::range(&Lines::new(world.text(span.file)), span.range())))
    }

    fn edit(&self, world: &World, edits: &[Edit]) -> WorkspaceEdit {
        #[allow(clippy::mutable_key_type)] // The protocol's own type.
        let mut changes: HashMap<Uri, Vec<TextEdit>> = HashMap::new();
        for edit in edits {
            if let Some(Location { uri, range }) = self.location(world, edit.span) {
                changes.entry(uri).or_default().push(TextEdit::new(range, edit.text.clone()));
            }
        }
        WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() }
    }
}

fn completion(state: &mut State, params: CompletionParams) -> Answer {
    let at = params.text_document_position;
    let Some(open) = state.open(&at.text_document.uri, false) else { return Ok(Value::Null) };
    let offset = open.offset(at.position);
    // Only the path of an import needs to know what is there.
    let line = open.document.text.get(..offset).and_then(|text| text.rsplit('\n').next()).unwrap_or("");
    let files = if line.contains("import") { state.project(&open.path) } else { Vec::new() };
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    let texts = state.texts();
    let lines = open.lines();
    let found = service::complete(&open.world, &texts, open.file, offset, &files);
    let items = found.into_iter().map(|found| convert::completion(found, &lines, state.client.snippets)).collect();
    value(CompletionList { is_incomplete: false, items })
}

fn signature_help(state: &mut State, params: SignatureHelpParams) -> Answer {
    let at = params.text_document_position_params;
    let Some(open) = state.open(&at.text_document.uri, false) else { return Ok(Value::Null) };
    let Some(help) = service::signature_help(&open.world, open.file, open.offset(at.position)) else { return Ok(Value::Null) };
    let active = help.signatures.get(help.active).and_then(|signature| signature.active);
    value(SignatureHelp {
        active_signature: Some(help.active as u32),
        active_parameter: active.map(|active| active as u32),
        signatures: help.signatures.into_iter().map(convert::signature).collect(),
    })
}

fn hover(state: &mut State, params: HoverParams) -> Answer {
    let at = params.text_document_position_params;
    let Some(open) = state.open(&at.text_document.uri, false) else { return Ok(Value::Null) };
    let said = service::hover(&open.world, &state.factors(&open), open.file, open.offset(at.position));
    let Some(said) = said.filter(|said| !said.markdown().is_empty()) else { return Ok(Value::Null) };
    let range = said.span.map(|span| convert::range(&open.lines(), span.range()));
    value(Hover { contents: HoverContents::Markup(convert::markdown(said.markdown())), range })
}

fn definition(state: &mut State, params: GotoDefinitionParams) -> Answer {
    let at = params.text_document_position_params;
    let Some(open) = state.open(&at.text_document.uri, false) else { return Ok(Value::Null) };
    let found = service::definition(&open.world, open.file, open.offset(at.position));
    let links: Vec<LocationLink> = found
        .iter()
        .filter_map(|found| {
            let (name, whole) = (state.location(&open.world, found.name)?, state.location(&open.world, found.whole)?);
            let from = convert::range(&open.lines(), found.from.range());
            Some(LocationLink { origin_selection_range: Some(from), target_uri: name.uri, target_range: whole.range, target_selection_range: name.range })
        })
        .collect();
    // Every client takes places; what links say besides few show.
    value(links.into_iter().map(|link| Location::new(link.target_uri, link.target_selection_range)).collect::<Vec<_>>())
}

fn references(state: &mut State, params: ReferenceParams) -> Answer {
    let at = params.text_document_position;
    let Some(open) = state.open(&at.text_document.uri, true) else { return Ok(Value::Null) };
    let found = service::references(&open.world, open.file, open.offset(at.position));
    let wanted = found.into_iter().filter(|found| params.context.include_declaration || !found.declares);
    value(wanted.filter_map(|found| state.location(&open.world, found.span)).collect::<Vec<_>>())
}

fn highlights(state: &mut State, params: DocumentHighlightParams) -> Answer {
    let at = params.text_document_position_params;
    let Some(open) = state.open(&at.text_document.uri, false) else { return Ok(Value::Null) };
    let lines = open.lines();
    let found = service::references(&open.world, open.file, open.offset(at.position));
    let here = found.into_iter().filter(|found| found.span.file == open.file).map(|found| DocumentHighlight {
        range: convert::range(&lines, found.span.range()),
        kind: Some(if found.declares { DocumentHighlightKind::WRITE } else { DocumentHighlightKind::READ }),
    });
    value(here.collect::<Vec<_>>())
}

fn prepare_rename(state: &mut State, params: TextDocumentPositionParams) -> Answer {
    let Some(open) = state.open(&params.text_document.uri, false) else { return Ok(Value::Null) };
    let span = service::prepare_rename(&open.world, open.file, open.offset(params.position)).map_err(|why| (ErrorCode::RequestFailed, why))?;
    value(PrepareRenameResponse::Range(convert::range(&open.lines(), span.range())))
}

fn rename(state: &mut State, params: RenameParams) -> Answer {
    let at = params.text_document_position;
    let Some(open) = state.open(&at.text_document.uri, true) else { return Ok(Value::Null) };
    let texts = state.texts();
    let edits = service::rename(&open.world, &texts, open.file, open.offset(at.position), &params.new_name).map_err(|why| (ErrorCode::RequestFailed, why))?;
    value(state.edit(&open.world, &edits))
}

fn symbols(state: &mut State, params: DocumentSymbolParams) -> Answer {
    let Some(open) = state.open(&params.text_document.uri, false) else { return Ok(Value::Null) };
    let lines = open.lines();
    let outline = service::outline(&open.world, open.file);
    if state.client.trees {
        return value(outline.into_iter().map(|entry| tree(entry, &lines)).collect::<Vec<_>>());
    }
    let mut flat = Vec::new();
    outline.into_iter().for_each(|entry| flatten(state, &open.world, entry, None, &mut flat));
    value(flat)
}

#[allow(deprecated)] // A field of the protocol's type that has no other way to be left out.
fn tree(entry: Outline, lines: &Lines<'_>) -> DocumentSymbol {
    DocumentSymbol {
        name: entry.name,
        detail: Some(entry.detail).filter(|detail| !detail.is_empty()),
        kind: convert::symbol(entry.kind),
        tags: None,
        deprecated: None,
        range: convert::range(lines, entry.whole.range()),
        selection_range: convert::range(lines, entry.at.range()),
        children: Some(entry.within.into_iter().map(|entry| tree(entry, lines)).collect()),
    }
}

#[allow(deprecated)] // As above.
fn flatten(state: &State, world: &World, entry: Outline, container_name: Option<String>, flat: &mut Vec<SymbolInformation>) {
    let Some(location) = state.location(world, entry.at) else { return };
    let name = entry.name.clone();
    flat.push(SymbolInformation { name: entry.name, kind: convert::symbol(entry.kind), tags: None, deprecated: None, location, container_name });
    entry.within.into_iter().for_each(|inner| flatten(state, world, inner, Some(name.clone()), flat));
}

fn workspace_symbols(state: &mut State, params: WorkspaceSymbolParams) -> Answer {
    let Some(path) = state.documents.keys().next().cloned().or_else(|| state.project("").first().cloned()) else { return value(Vec::<Value>::new()) };
    let world = state.world(&path, true);
    let mut flat = Vec::new();
    for entry in service::workspace_outline(&world, &params.query) {
        let container = world.path(entry.at.file).rsplit('/').next().map(str::to_owned);
        flatten(state, &world, entry, container, &mut flat);
    }
    value(flat)
}

fn folds(state: &mut State, params: FoldingRangeParams) -> Answer {
    let Some(open) = state.open(&params.text_document.uri, false) else { return Ok(Value::Null) };
    let lines = open.lines();
    value(service::folds(&open.document.text, open.file).into_iter().map(|fold| convert::fold(fold, &lines)).collect::<Vec<_>>())
}

fn formatting(state: &mut State, params: DocumentFormattingParams) -> Answer {
    let path = super::documents::path_of(&params.text_document.uri);
    let Some(document) = state.documents.get(&path) else { return Ok(Value::Null) };
    let text = &*document.text;
    // What can't be read stays as it is: diagnostics say why.
    let Ok(laid_out) = syntax::format(text) else { return value(Vec::<TextEdit>::new()) };
    value(difference(text, &laid_out).into_iter().collect::<Vec<_>>())
}

/// The one edit that makes a text of another: whole lines that are the same at the beginning and at the end stay.
fn difference(text: &str, other: &str) -> Option<TextEdit> {
    if text == other {
        return None;
    }
    let (old, new): (Vec<&str>, Vec<&str>) = (text.split_inclusive('\n').collect(), other.split_inclusive('\n').collect());
    let before = old.iter().zip(&new).take_while(|(a, b)| a == b).count();
    let most = old.len().min(new.len()) - before;
    let after = old.iter().rev().zip(new.iter().rev()).take(most).take_while(|(a, b)| a == b).count();
    let length = |lines: &[&str]| lines.iter().map(|line| line.len()).sum::<usize>();
    let (start, end) = (length(&old[..before]), text.len() - length(&old[old.len() - after..]));
    let lines = Lines::new(text);
    Some(TextEdit::new(convert::range(&lines, start..end), new[before..new.len() - after].concat()))
}

fn tokens(state: &mut State, uri: &Uri, range: Option<Range>) -> Answer {
    let Some(open) = state.open(uri, false) else { return Ok(Value::Null) };
    let (lines, text) = (open.lines(), &*open.document.text);
    let within = range.map_or(0..text.len(), |range| offset(&lines, range.start)..offset(&lines, range.end));
    let painted = service::paint(&open.world, open.file);
    value(SemanticTokens { result_id: None, data: convert::tokens(&painted, text, &lines, within) })
}

fn inlay_hints(state: &mut State, params: InlayHintParams) -> Answer {
    let Some(open) = state.open(&params.text_document.uri, false) else { return Ok(Value::Null) };
    let lines = open.lines();
    let within = offset(&lines, params.range.start)..offset(&lines, params.range.end);
    let found = service::hints(&open.world, &state.factors(&open), open.file, within);
    let hint = |found: service::Hint| InlayHint {
        position: convert::position(&lines, found.offset),
        label: InlayHintLabel::String(found.label),
        kind: found.is_argument.then_some(InlayHintKind::PARAMETER),
        text_edits: None,
        tooltip: (!found.text.is_empty()).then(|| InlayHintTooltip::MarkupContent(convert::markdown(found.text))),
        padding_left: Some(!found.is_argument),
        padding_right: Some(found.is_argument),
        data: None,
    };
    value(found.into_iter().map(hint).collect::<Vec<_>>())
}

fn colors(state: &mut State, params: DocumentColorParams) -> Answer {
    let Some(open) = state.open(&params.text_document.uri, false) else { return Ok(Value::Null) };
    let lines = open.lines();
    let color = |[red, green, blue]: [f64; 3]| lsp_types::Color { red: red as f32, green: green as f32, blue: blue as f32, alpha: 1.0 };
    let found = service::colors(&open.document.text, open.file);
    value(found.iter().map(|found| ColorInformation { range: convert::range(&lines, found.span.range()), color: color(found.rgb) }).collect::<Vec<_>>())
}

fn color_presentation(params: ColorPresentationParams) -> Answer {
    let lsp_types::Color { red, green, blue, .. } = params.color;
    let label = service::written_color([red, green, blue].map(f64::from));
    let text_edit = Some(TextEdit::new(params.range, label.clone()));
    value([ColorPresentation { label, text_edit, additional_text_edits: None }])
}

fn code_actions(state: &mut State, params: CodeActionParams) -> Answer {
    let Some(open) = state.open(&params.text_document.uri, false) else { return Ok(Value::Null) };
    let Some(known) = state.known.get(&open.path).filter(|known| known.version == open.document.version) else { return value(Vec::<Value>::new()) };
    let report = &known.report;
    let Some(file) = report.file(&open.path) else { return value(Vec::<Value>::new()) };
    let lines = open.lines();
    let at = Span::new(file, offset(&lines, params.range.start), offset(&lines, params.range.end));
    let mut found = Vec::new();
    for action in service::actions(&report.diagnostics, at) {
        let mended = report.diagnostics.get(action.mends);
        // A fix is of the text at hand, which is open.
        if action.edits.iter().any(|edit| edit.span.file != file) {
            continue;
        }
        let edits = action.edits.iter().map(|edit| TextEdit::new(convert::range(&lines, edit.span.range()), edit.text.clone())).collect();
        #[allow(clippy::mutable_key_type)] // The protocol's own type.
        let changes = HashMap::from([(open.document.uri.clone(), edits)]);
        let mends = |told: &&lsp_types::Diagnostic| mended.is_some_and(|mended| told.range == convert::range(&lines, mended.span.range()) && told.message.starts_with(&mended.message));
        found.push(CodeAction {
            title: action.title,
            kind: Some(CodeActionKind::QUICKFIX),
            diagnostics: Some(params.context.diagnostics.iter().filter(mends).cloned().collect()),
            edit: Some(WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() }),
            is_preferred: action.is_only.then_some(true),
            ..CodeAction::default()
        });
    }
    value(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_leaves_what_is_the_same() {
        let edit = difference("a\nb\nc\nd\n", "a\nx\ny\nd\n").unwrap();
        assert_eq!((edit.range, edit.new_text.as_str()), (Range::new(Position::new(1, 0), Position::new(3, 0)), "x\ny\n"));
        let edit = difference("a\na\n", "a\n").unwrap();
        assert_eq!((edit.range, edit.new_text.as_str()), (Range::new(Position::new(1, 0), Position::new(2, 0)), ""));
        let edit = difference("", "a\n").unwrap();
        assert_eq!((edit.range, edit.new_text.as_str()), (Range::default(), "a\n"));
        assert!(difference("a", "a").is_none());
    }
}
