//! What is known while serving: open documents, and what was said of them.

use super::convert;
use super::documents::{Document, path_of, uri_of};
use super::project::{is_of_prelude, scenes};
use super::wire::Wire;
use super::worker::{Done, Job, Order};
use crate::texts::OpenTexts;
use lsp_server::{Notification, Request, RequestId};
use lsp_types::{PublishDiagnosticsParams, Range, Uri};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;
use std::sync::mpsc::Sender;
use surefoot_compiler::diagnostic::{Severity, shown};
use surefoot_compiler::language_service::{Lines, Report, World};
use surefoot_compiler::source::Span;

/// So many worlds of one state are kept.
const WORLDS: usize = 8;

/// What a client can do, as far as that matters.
#[derive(Debug, Default)]
pub(super) struct Client {
    /// Whether it steps through the places of a completion.
    pub(super) snippets: bool,
    /// Whether outlines may be trees.
    pub(super) trees: bool,
    /// Whether it asks for inlay hints again when it is told to.
    refreshes: bool,
    /// Whether it watches files for us.
    pub(super) watches: bool,
    /// The folders that it has open.
    pub(super) folders: Vec<String>,
}

impl Client {
    /// What it says of itself.
    pub(super) fn of(params: &Value) -> Self {
        let can = |path: &str| params.pointer(path) == Some(&Value::Bool(true));
        let path = |uri: &Value| uri.as_str().and_then(|uri| uri.parse::<Uri>().ok()).map(|uri| path_of(&uri));
        let folders = params.get("workspaceFolders").and_then(Value::as_array).map(|all| all.iter().filter_map(|folder| path(folder.get("uri")?)).collect());
        let root = || params.get("rootUri").and_then(path).into_iter().collect();
        Self {
            snippets: can("/capabilities/textDocument/completion/completionItem/snippetSupport"),
            trees: can("/capabilities/textDocument/documentSymbol/hierarchicalDocumentSymbolSupport"),
            refreshes: can("/capabilities/workspace/inlayHint/refreshSupport"),
            watches: can("/capabilities/workspace/didChangeWatchedFiles/dynamicRegistration"),
            folders: folders.filter(|all: &Vec<String>| !all.is_empty()).unwrap_or_else(root),
        }
    }
}

/// What was found out of a document's text.
pub(super) struct Known {
    /// The version of the text.
    pub(super) version: i32,
    /// What the compiler says.
    pub(super) report: Report,
}

/// All that is known while serving.
pub(super) struct State {
    pub(super) client: Client,
    pub(super) wire: Wire,
    pub(super) worker: Sender<Order>,
    pub(super) documents: BTreeMap<String, Document>,
    /// What the newest compilation of each open document says.
    pub(super) known: BTreeMap<String, Known>,
    /// The texts as they are, and worlds of them, by the path of their first text and whether they hold all of the project.
    texts: Option<OpenTexts>,
    worlds: Vec<((String, bool), Rc<World>)>,
    /// Files of which something was said, by the document whose compilation said it.
    pub(super) told: BTreeMap<String, BTreeSet<String>>,
    /// Number of the next request to the client.
    next: i32,
}

impl State {
    /// Nothing is open.
    pub(super) fn new(client: Client, wire: Wire, worker: Sender<Order>) -> Self {
        Self {
            client,
            wire,
            worker,
            documents: BTreeMap::new(),
            known: BTreeMap::new(),
            texts: None,
            worlds: Vec::new(),
            told: BTreeMap::new(),
            next: 0,
        }
    }

    /// Asks the client something of which the answer does not matter.
    pub(super) fn ask(&mut self, method: &str, params: Value) {
        self.next += 1;
        let request = Request { id: RequestId::from(format!("surefoot-{}", self.next)), method: method.to_owned(), params };
        self.wire.send(request);
    }

    /// Files are others: what depends on them is compiled.
    pub(super) fn changed(&mut self, paths: &[String]) {
        self.texts = None;
        self.worlds.clear();
        let texts = self.texts();
        for (path, document) in &self.documents {
            // Of images and meshes it is not told which scene reads them.
            let reads = |file: &String| match self.known.get(path) {
                Some(known) => known.report.files.contains(file) || !file.ends_with(".sdf"),
                None => true,
            };
            let concerns = paths.contains(path) || paths.iter().any(reads);
            if concerns && !is_of_prelude(path) {
                let job = Job { path: path.clone(), version: document.version, texts: texts.clone() };
                let _ = self.worker.send(Order::Compile(job));
            }
        }
    }

    /// All texts as they are now.
    pub(super) fn texts(&mut self) -> OpenTexts {
        self.texts.get_or_insert_with(|| OpenTexts::new(self.documents.iter().map(|(path, document)| (path.clone(), document.text.clone())))).clone()
    }

    /// The world of a text and what it imports, and of all the project's texts if `whole`.
    pub(super) fn world(&mut self, path: &str, whole: bool) -> Rc<World> {
        let key = (path.to_owned(), whole);
        if let Some((_, world)) = self.worlds.iter().find(|(known, _)| *known == key) {
            return world.clone();
        }
        let mut paths = vec![path.to_owned()];
        if whole {
            paths.extend(self.project(path).into_iter().filter(|other| other != path));
        }
        let names: Vec<&str> = paths.iter().map(String::as_str).collect();
        let world = Rc::new(World::read(&self.texts(), &names));
        if self.worlds.len() >= WORLDS {
            self.worlds.remove(0);
        }
        self.worlds.push((key, world.clone()));
        world
    }

    /// The scenes of the project: those in the client's folders, or else beside a text, and those that are open.
    pub(super) fn project(&self, path: &str) -> Vec<String> {
        let beside = path.rsplit_once('/').map(|(folder, _)| folder.to_owned()).filter(|folder| !folder.is_empty());
        let folders = if self.client.folders.is_empty() { beside.into_iter().collect() } else { self.client.folders.clone() };
        let mut scenes = scenes(&folders);
        scenes.extend(self.documents.keys().filter(|path| !is_of_prelude(path)).cloned());
        scenes.sort();
        scenes.dedup();
        scenes
    }

    /// A compilation has ended.
    pub(super) fn done(&mut self, done: Done) {
        let Done { path, version, report: Some(report) } = done else { return };
        let Some(document) = self.documents.get(&path) else { return };
        // Something newer is on its way.
        if document.version != version {
            return;
        }
        let mut concerned = self.told.remove(&path).unwrap_or_default();
        let said = report.diagnostics.iter().filter_map(|told| report.sources.get(told.span.file)).map(|file| file.name.clone());
        let said: BTreeSet<String> = said.filter(|file| *file != path).collect();
        concerned.extend(said.iter().cloned().chain([path.clone()]));
        self.told.insert(path.clone(), said);
        self.known.insert(path, Known { version, report });
        self.publish_all(concerned);
        if self.client.refreshes {
            self.ask("workspace/inlayHint/refresh", Value::Null);
        }
    }

    pub(super) fn publish_all(&self, paths: BTreeSet<String>) {
        for path in paths {
            self.publish(&path);
        }
    }

    /// Tells what is wrong with a file: by its own compilation where it is open, else by those of what imports it.
    fn publish(&self, path: &str) {
        let own = self.documents.get(path);
        let Some(uri) = own.map(|document| document.uri.clone()).or_else(|| uri_of(path)) else { return };
        let mut diagnostics: Vec<lsp_types::Diagnostic> = Vec::new();
        match own {
            // Its own compilation is on its way.
            Some(document) if self.known.get(path).is_none_or(|known| known.version != document.version) => return,
            Some(_) => diagnostics = self.known.get(path).map_or_else(Vec::new, |known| self.diagnostics(path, &known.report)),
            None => {
                for known in self.known.values() {
                    for told in self.diagnostics(path, &known.report) {
                        if !diagnostics.contains(&told) {
                            diagnostics.push(told);
                        }
                    }
                }
            }
        }
        let version = own.map(|document| document.version);
        self.tell("textDocument/publishDiagnostics", PublishDiagnosticsParams { uri, diagnostics, version });
    }

    fn tell(&self, method: &str, params: impl serde::Serialize) {
        if let Ok(params) = serde_json::to_value(params) {
            self.wire.send(Notification { method: method.to_owned(), params });
        }
    }

    /// What a report says of a file.
    fn diagnostics(&self, path: &str, report: &Report) -> Vec<lsp_types::Diagnostic> {
        let Some(file) = report.file(path) else { return Vec::new() };
        let text = report.sources.get(file).map_or("", |file| &file.text);
        let lines = Lines::new(text);
        let place = |span: Span| self.place(report, span);
        let mut found: Vec<lsp_types::Diagnostic> =
            shown(&report.diagnostics).0.into_iter().filter(|told| told.span.file == file).map(|told| convert::diagnostic(told, &lines, &place)).collect();
        let has_errors = report.diagnostics.iter().any(|told| told.severity == Severity::Error);
        if !has_errors {
            found.extend(report.unused.iter().filter(|(_, span)| span.file == file).map(|(name, span)| convert::unused(name, convert::range(&lines, span.range()))));
        }
        found
    }

    /// Where a place of a report's texts is for the client.
    fn place(&self, report: &Report, span: Span) -> Option<(Uri, Range)> {
        let file = report.sources.get(span.file)?;
        let uri = match self.documents.get(&file.name) {
            Some(document) => document.uri.clone(),
            None if file.name.starts_with('<') => return None,
            None => uri_of(&file.name)?,
        };
        Some((uri, convert::range(&Lines::new(&file.text), span.range())))
    }
}
