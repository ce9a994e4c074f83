//! An editor with a copy of a folder of tests/lsp, which a language server in the same process serves.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use lsp_server::{Connection, Message, Notification, Request, RequestId};
use plcc_driver::command::lsp::Files;
use serde_json::{Value, json};

/// A check of the programs of these tests takes less.
pub(super) const LONGEST: Duration = Duration::from_secs(60);

pub(crate) struct Editor {
    pub(super) connection: Connection,
    server: Option<std::thread::JoinHandle<Result<(), String>>>,
    folder: tempfile::TempDir,
    next: i32,
    texts: HashMap<String, String>,
}

/// What a new name changes in one place.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Edit {
    pub(crate) file: String,
    pub(crate) line: u64,
    pub(crate) text: String,
}

impl Editor {
    /// An editor with a copy of a folder of tests/lsp.
    pub(crate) fn new(name: &str) -> Editor {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/lsp").join(name);
        for file in fs::read_dir(source).into_iter().flatten().flatten() {
            fs::copy(file.path(), folder.path().join(file.file_name())).expect("the folder can be written");
        }
        let (server, connection) = Connection::memory();
        let server = std::thread::spawn(move || plcc_lsp::serve(&server, Arc::new(Files)));
        let mut editor = Editor { connection, server: Some(server), folder, next: 0, texts: HashMap::new() };
        let started = editor.ask("initialize", json!({ "capabilities": {} }));
        assert!(started["capabilities"]["hoverProvider"].as_bool().expect("hover is offered"));
        editor.tell("initialized", json!({}));
        editor
    }

    fn path(&self, file: &str) -> PathBuf {
        self.folder.path().join(file)
    }

    pub(super) fn uri(&self, file: &str) -> String {
        format!("file://{}", self.path(file).display())
    }

    pub(super) fn tell(&self, method: &str, params: Value) {
        let note = Notification::new(method.to_owned(), params);
        self.connection.sender.send(Message::Notification(note)).expect("the server runs");
    }

    pub(super) fn ask(&mut self, method: &str, params: Value) -> Value {
        self.ask_or(method, params).unwrap_or_else(|error| panic!("{method}: {error}"))
    }

    pub(super) fn ask_or(&mut self, method: &str, params: Value) -> Result<Value, String> {
        self.next += 1;
        let id = RequestId::from(self.next);
        let request = Request::new(id.clone(), method.to_owned(), params);
        self.connection.sender.send(Message::Request(request)).expect("the server runs");
        loop {
            match self.connection.receiver.recv_timeout(LONGEST).expect("the server answers") {
                Message::Response(response) if response.id == id => {
                    let response = serde_json::to_value(&response).expect("a response is JSON");
                    return match response.get("error") {
                        Some(error) if !error.is_null() => {
                            Err(error["message"].as_str().unwrap_or_default().to_owned())
                        }
                        _ => Ok(response["result"].clone()),
                    };
                }
                _ => {}
            }
        }
    }

    pub(crate) fn open(&mut self, file: &str) {
        let text = fs::read_to_string(self.path(file)).expect("the file is there");
        let document = json!({ "uri": self.uri(file), "languageId": "plc", "version": 1, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": document }));
        self.texts.insert(file.to_owned(), text);
    }

    /// Replaces the first `from` in an open file, as typing does.
    pub(super) fn edit(&mut self, file: &str, from: &str, to: &str) {
        let range = self.range(file, from);
        let changes = json!([{ "range": range, "text": to }]);
        let document = json!({ "uri": self.uri(file), "version": 2 });
        self.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
        let text = self.texts.get_mut(file).expect("it is open");
        *text = text.replacen(from, to, 1);
    }

    fn place(&self, file: &str, byte: usize) -> Value {
        let text = &self.texts[file][..byte];
        let line = text.matches('\n').count();
        json!({ "line": line, "character": text.rsplit('\n').next().unwrap_or_default().encode_utf16().count() })
    }

    pub(super) fn range(&self, file: &str, text: &str) -> Value {
        let start = self.texts[file].find(text).unwrap_or_else(|| panic!("{text} is in {file}"));
        json!({ "start": self.place(file, start), "end": self.place(file, start + text.len()) })
    }

    /// Asks about the `|` in a piece of an open file.
    pub(crate) fn at(&mut self, method: &str, file: &str, piece: &str) -> Value {
        let params = self.position(file, piece);
        self.ask(method, params)
    }

    pub(super) fn position(&self, file: &str, piece: &str) -> Value {
        let before = piece.find('|').expect("a bar marks the place");
        let piece = piece.replace('|', "");
        let start = self.texts[file].find(&piece).unwrap_or_else(|| panic!("{piece} is in {file}"));
        json!({
            "textDocument": { "uri": self.uri(file) },
            "position": self.place(file, start + before),
            "context": { "includeDeclaration": true, "triggerKind": 1, "isRetrigger": false },
        })
    }

    /// The edits that give the name at the `|` of a piece another one, in order, or why it has no other.
    pub(crate) fn rename(&mut self, file: &str, piece: &str, to: &str) -> Result<Vec<Edit>, String> {
        let mut params = self.position(file, piece);
        params["newName"] = json!(to);
        let answer = self.ask_or("textDocument/rename", params)?;
        let mut found = Vec::new();
        for (uri, edits) in answer["changes"].as_object().expect("changes") {
            let file = uri.rsplit('/').next().unwrap_or_default();
            found.extend(edits.as_array().expect("a list").iter().map(|edit| Edit {
                file: file.to_owned(),
                line: edit["range"]["start"]["line"].as_u64().expect("a line") + 1,
                text: edit["newText"].as_str().expect("a text").to_owned(),
            }));
        }
        found.sort();
        Ok(found)
    }

    /// The next messages about a file, as `CODE line`.
    pub(crate) fn messages(&mut self, file: &str) -> Vec<String> {
        let uri = self.uri(file);
        loop {
            match self.connection.receiver.recv_timeout(LONGEST).expect("the server publishes") {
                Message::Notification(note) if note.params["uri"] == json!(uri) => {
                    let messages = note.params["diagnostics"].as_array().expect("a list").clone();
                    let text = |message: &Value| {
                        let line = message["range"]["start"]["line"].as_u64().expect("a line");
                        format!("{} {}", message["code"].as_str().expect("a code"), line + 1)
                    };
                    return messages.iter().map(text).collect();
                }
                _ => {}
            }
        }
    }

    /// The text that each place covers, and its file.
    pub(super) fn covered(&mut self, places: &Value) -> Vec<String> {
        let mut out = Vec::new();
        for place in places.as_array().expect("a list") {
            let uri = place["uri"].as_str().expect("a URI");
            let path = uri.strip_prefix("file://").expect("a file");
            let name = Path::new(path).file_name().expect("a name").to_string_lossy().into_owned();
            let text = self.texts.get(&name).cloned().unwrap_or_else(|| fs::read_to_string(path).expect("it is there"));
            let line = place["range"]["start"]["line"].as_u64().expect("a line") as usize;
            let column = |end: &str| place["range"][end]["character"].as_u64().expect("a column") as usize;
            let text: String = text.lines().nth(line).expect("the line").chars().collect::<Vec<_>>()
                [column("start")..column("end")]
                .iter()
                .collect();
            out.push(format!("{name}:{} {text}", line + 1));
        }
        out
    }
}

impl Drop for Editor {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            self.ask("shutdown", Value::Null);
            self.tell("exit", Value::Null);
            let server = self.server.take().expect("it runs");
            server.join().expect("it does not panic").expect("the connection is closed in order");
        }
    }
}
