//! A client that speaks raw JSON-RPC with `surefoot lsp`.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Longer than any answer takes.
const LONG: Duration = Duration::from_secs(120);

/// A server, and what it said so far.
pub struct Client {
    child: Child,
    stdin: Option<ChildStdin>,
    messages: Receiver<Value>,
    next: i64,
    /// Notifications and requests of the server that nobody looked at yet.
    pub told: Vec<Value>,
    folder: PathBuf,
}

impl Client {
    /// Starts a server in a folder of its own, with these files in it.
    pub fn start(test: &str, files: &[(&str, &str)]) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("lsp").join(test);
        std::fs::remove_dir_all(&folder).ok();
        std::fs::create_dir_all(&folder).unwrap();
        for (name, text) in files {
            let path = folder.join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        let mut command = Command::new(env!("CARGO_BIN_EXE_surefoot"));
        command.arg("lsp").current_dir(&folder).env("XDG_CACHE_HOME", folder.join("cache"));
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::inherit()).spawn().unwrap();
        let mut stdout = BufReader::new(child.stdout.take().unwrap());
        let (sender, messages) = channel();
        std::thread::spawn(move || {
            while let Some(message) = read(&mut stdout) {
                if sender.send(message).is_err() {
                    return;
                }
            }
        });
        let stdin = child.stdin.take();
        let mut client = Self { child, stdin, messages, next: 0, told: Vec::new(), folder };
        let capabilities = json!({
            "textDocument": { "completion": { "completionItem": { "snippetSupport": true } }, "documentSymbol": { "hierarchicalDocumentSymbolSupport": true } },
            "workspace": { "inlayHint": { "refreshSupport": true } },
        });
        let root = client.uri("");
        let started = client.ask("initialize", json!({ "processId": null, "rootUri": root, "capabilities": capabilities }));
        assert_eq!(started["serverInfo"]["name"], "surefoot");
        client.tell("initialized", json!({}));
        client
    }

    pub fn uri(&self, name: &str) -> String {
        format!("file://{}", self.folder.join(name).to_str().unwrap().trim_end_matches('/'))
    }

    pub fn pid(&self) -> u32 {
        self.child.id()
    }

    fn send(&mut self, message: Value) {
        let text = message.to_string();
        let stdin = self.stdin.as_mut().unwrap();
        write!(stdin, "Content-Length: {}\r\n\r\n{text}", text.len()).unwrap();
        stdin.flush().unwrap();
    }

    pub fn tell(&mut self, method: &str, params: Value) {
        self.send(json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    /// Sends a request; its number.
    pub fn begin(&mut self, method: &str, params: Value) -> i64 {
        self.next += 1;
        let id = self.next;
        self.send(json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }));
        id
    }

    /// The whole answer to a request; what else comes is kept.
    pub fn end(&mut self, id: i64) -> Value {
        let start = Instant::now();
        loop {
            let message = self.messages.recv_timeout(LONG.saturating_sub(start.elapsed())).expect("an answer");
            if message.get("method").is_none() && message["id"] == json!(id) {
                return message;
            }
            self.hear(message);
        }
    }

    fn hear(&mut self, message: Value) {
        // A client answers what it is asked.
        if let (Some(id), Some(_)) = (message.get("id").cloned(), message.get("method")) {
            self.send(json!({ "jsonrpc": "2.0", "id": id, "result": null }));
        }
        self.told.push(message);
    }

    /// The result of a request.
    pub fn ask(&mut self, method: &str, params: Value) -> Value {
        let id = self.begin(method, params);
        let answer = self.end(id);
        assert!(answer.get("error").is_none(), "{method}: {answer}");
        answer["result"].clone()
    }

    /// The error of a request.
    pub fn refused(&mut self, method: &str, params: Value) -> (i64, String) {
        let id = self.begin(method, params);
        let answer = self.end(id);
        let error = &answer["error"];
        (error["code"].as_i64().unwrap_or_else(|| panic!("{method}: {answer}")), error["message"].as_str().unwrap().to_owned())
    }

    pub fn open(&mut self, name: &str, version: i64, text: &str) {
        let uri = self.uri(name);
        self.tell("textDocument/didOpen", json!({ "textDocument": { "uri": uri, "languageId": "sdf", "version": version, "text": text } }));
    }

    pub fn change(&mut self, name: &str, version: i64, changes: Value) {
        let uri = self.uri(name);
        self.tell("textDocument/didChange", json!({ "textDocument": { "uri": uri, "version": version }, "contentChanges": changes }));
    }

    /// The next diagnostics of a file, of a version.
    pub fn diagnostics(&mut self, name: &str, version: Option<i64>) -> Vec<Value> {
        let uri = self.uri(name);
        let fits = |message: &Value| {
            let params = &message["params"];
            message["method"] == "textDocument/publishDiagnostics" && params["uri"] == uri && params["version"].as_i64() == version
        };
        let start = Instant::now();
        loop {
            if let Some(at) = self.told.iter().position(fits) {
                let message = self.told.remove(at);
                return message["params"]["diagnostics"].as_array().unwrap().clone();
            }
            let message = self.messages.recv_timeout(LONG.saturating_sub(start.elapsed())).unwrap_or_else(|_| panic!("no diagnostics of {name} {version:?}: {:?}", self.told));
            self.hear(message);
        }
    }

    /// Takes in what has come until nothing comes for a while.
    pub fn listen(&mut self, quiet: Duration) {
        loop {
            match self.messages.recv_timeout(quiet) {
                Ok(message) => self.hear(message),
                Err(RecvTimeoutError::Timeout) => return,
                Err(RecvTimeoutError::Disconnected) => return,
            }
        }
    }

    /// Position of the first byte of some words in a text.
    pub fn at(text: &str, words: &str) -> Value {
        let offset = text.find(words).unwrap_or_else(|| panic!("{words} in {text}"));
        let line = text[..offset].matches('\n').count();
        let column = text[..offset].rsplit('\n').next().unwrap().encode_utf16().count();
        json!({ "line": line, "character": column })
    }

    /// A place in a file, as most requests name it.
    pub fn place(&self, name: &str, position: Value) -> Value {
        json!({ "textDocument": { "uri": self.uri(name) }, "position": position })
    }

    /// Says good-bye; the code with which the server ends.
    pub fn stop(mut self) -> i32 {
        self.ask("shutdown", Value::Null);
        self.tell("exit", Value::Null);
        self.stdin = None;
        self.child.wait().unwrap().code().unwrap()
    }

    /// Goes without a word; the code with which the server ends.
    pub fn vanish(mut self) -> i32 {
        self.stdin = None;
        self.child.wait().unwrap().code().unwrap()
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn read(stdout: &mut impl BufRead) -> Option<Value> {
    let mut length = 0;
    loop {
        let mut line = String::new();
        if stdout.read_line(&mut line).ok()? == 0 {
            return None;
        }
        match line.trim() {
            "" => break,
            header => {
                if let Some(count) = header.strip_prefix("Content-Length: ") {
                    length = count.parse().ok()?;
                }
            }
        }
    }
    let mut bytes = vec![0; length];
    stdout.read_exact(&mut bytes).ok()?;
    serde_json::from_slice(&bytes).ok()
}
