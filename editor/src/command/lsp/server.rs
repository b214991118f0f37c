//! The order of messages: what comes is answered one after another.

use super::convert;
use super::documents::{Document, changed, path_of};
use super::requests::answer;
use super::state::State;
use super::worker::{Done, Order};
use crate::command::console::Exit;
use lsp_server::{ErrorCode, Message, Notification, Request, RequestId, Response};
use lsp_types::{DidChangeTextDocumentParams, DidChangeWatchedFilesParams, DidCloseTextDocumentParams, DidOpenTextDocumentParams};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::Receiver;

/// So many messages are taken in before one is answered, so that one that is cancelled is not.
const AHEAD: usize = 256;

/// What the answering thread hears.
pub(super) enum Event {
    /// Of the client.
    Message(Message),
    /// Of the thread that compiles.
    Done(Box<Done>),
    /// The client is gone.
    Gone,
}

/// What the server can do.
pub(super) fn greeting() -> Value {
    json!({
        "capabilities": {
            "positionEncoding": "utf-16",
            "textDocumentSync": { "openClose": true, "change": 2 },
            "completionProvider": { "triggerCharacters": [".", "\"", "/"] },
            "signatureHelpProvider": { "triggerCharacters": ["(", ",", ":"] },
            "hoverProvider": true,
            "definitionProvider": true,
            "referencesProvider": true,
            "documentHighlightProvider": true,
            "renameProvider": { "prepareProvider": true },
            "documentSymbolProvider": true,
            "workspaceSymbolProvider": true,
            "foldingRangeProvider": true,
            "documentFormattingProvider": true,
            "semanticTokensProvider": {
                "legend": { "tokenTypes": convert::TOKEN_TYPES, "tokenModifiers": convert::TOKEN_MODIFIERS },
                "full": true,
                "range": true,
            },
            "inlayHintProvider": true,
            "colorProvider": true,
            "codeActionProvider": { "codeActionKinds": ["quickfix"] },
        },
        "serverInfo": { "name": "surefoot", "version": env!("CARGO_PKG_VERSION") },
    })
}

/// Serves until the client says `exit`, or is gone.
pub(super) fn serve(mut state: State, events: &Receiver<Event>) -> Exit {
    let mut waiting: VecDeque<Event> = VecDeque::new();
    let mut is_down = false;
    loop {
        if waiting.is_empty() {
            let Ok(event) = events.recv() else { return Exit::Errors };
            waiting.push_back(event);
        }
        while waiting.len() < AHEAD
            && let Ok(event) = events.try_recv()
        {
            waiting.push_back(event);
        }
        let Some(event) = waiting.pop_front() else { continue };
        match event {
            // The protocol: without `shutdown` before it this is an error.
            Event::Gone => return Exit::Errors,
            Event::Message(Message::Notification(told)) if told.method == "exit" => return if is_down { Exit::Fine } else { Exit::Errors },
            Event::Message(Message::Request(request)) if request.method == "shutdown" => {
                is_down = true;
                state.wire.send(Response::new_ok(request.id, Value::Null));
            }
            Event::Message(Message::Request(request)) if is_down => {
                state.wire.send(Response::new_err(request.id, ErrorCode::InvalidRequest as i32, "the server is shut down".to_owned()));
            }
            Event::Message(Message::Request(request)) => {
                let cancelled = waiting.iter().any(|event| cancels(event, &request.id));
                request_of(&mut state, request, cancelled);
            }
            Event::Message(Message::Notification(told)) => notification(&mut state, told),
            Event::Message(Message::Response(_)) => {}
            Event::Done(done) => state.done(*done),
        }
    }
}

fn request_of(state: &mut State, request: Request, cancelled: bool) {
    let id = request.id.clone();
    let response = match cancelled {
        true => Response::new_err(id, ErrorCode::RequestCanceled as i32, "cancelled".to_owned()),
        // What is wrong with one answer ends no session.
        false => catch_unwind(AssertUnwindSafe(|| answer(state, request)))
            .unwrap_or_else(|_| Response::new_err(id, ErrorCode::InternalError as i32, "the server could not answer this".to_owned())),
    };
    state.wire.send(response);
}

fn notification(state: &mut State, told: Notification) {
    match told.method.as_str() {
        "initialized" if state.client.watches => {
            let watchers = json!([{ "globPattern": "**/*.{sdf,obj,stl,ply,glb,gltf,png,jpg,jpeg,hdr,sfgrid}" }]);
            let registrations = json!([{ "id": "files", "method": "workspace/didChangeWatchedFiles", "registerOptions": { "watchers": watchers } }]);
            state.ask("client/registerCapability", json!({ "registrations": registrations }));
        }
        "textDocument/didOpen" => {
            if let Some(DidOpenTextDocumentParams { text_document }) = read(told) {
                let path = path_of(&text_document.uri);
                let document = Document { uri: text_document.uri, version: text_document.version, text: text_document.text.into() };
                state.documents.insert(path.clone(), document);
                state.changed(&[path]);
            }
        }
        "textDocument/didChange" => {
            if let Some(DidChangeTextDocumentParams { text_document, content_changes }) = read(told) {
                let path = path_of(&text_document.uri);
                if let Some(document) = state.documents.get_mut(&path) {
                    document.text = changed(&document.text, content_changes).into();
                    document.version = text_document.version;
                    state.changed(&[path]);
                }
            }
        }
        "textDocument/didClose" => {
            if let Some(DidCloseTextDocumentParams { text_document }) = read(told) {
                let path = path_of(&text_document.uri);
                if state.documents.remove(&path).is_some() {
                    let _ = state.worker.send(Order::Forget(path.clone()));
                    state.known.remove(&path);
                    let before = state.told.remove(&path).unwrap_or_default();
                    state.publish_all(before.into_iter().chain([path.clone()]).collect());
                    state.changed(&[path]);
                }
            }
        }
        "workspace/didChangeWatchedFiles" => {
            if let Some(DidChangeWatchedFilesParams { changes }) = read(told) {
                let paths: Vec<String> = changes.iter().map(|change| path_of(&change.uri)).filter(|path| !state.documents.contains_key(path)).collect();
                if !paths.is_empty() {
                    state.changed(&paths);
                }
            }
        }
        _ => {}
    }
}

/// Whether a message cancels a request.
fn cancels(event: &Event, id: &RequestId) -> bool {
    let Event::Message(Message::Notification(told)) = event else { return false };
    told.method == "$/cancelRequest" && told.params.get("id").and_then(|told| serde_json::from_value::<RequestId>(told.clone()).ok()).as_ref() == Some(id)
}

fn read<T: DeserializeOwned>(told: Notification) -> Option<T> {
    serde_json::from_value(told.params).ok()
}
