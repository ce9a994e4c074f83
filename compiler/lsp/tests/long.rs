//! A program of 26,000 lines: how long an editor waits after a change.
//!
//! With `PLCC_LSP_TIMES` set, the times of a release build are printed and held to 100 ms.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use lsp_server::{Connection, Message, Notification, Request, RequestId};
use plcc_diag::{SourceFile, SourceMap};
use plcc_lsp::{Checked, Host, Open, serve};
use plcc_readers::ReadOptions;
use serde_json::{Value, json};

/// A host whose programs are one open file, which is only parsed.
struct Parses;

impl Host for Parses {
    fn root(&self, path: &Path) -> PathBuf {
        path.to_path_buf()
    }

    fn check(&self, root: &Path, open: &Open) -> Checked {
        let mut sources = SourceMap::default();
        let text = open.get(root).cloned().unwrap_or_default();
        let file = sources.add(SourceFile::new(root.display().to_string(), text.clone()));
        let (unit, diagnostics) = plcc_readers::parse(file, &text, &ReadOptions::default());
        Checked { sources, units: vec![(file, unit)], diagnostics, ..Checked::default() }
    }
}

/// Lines that the program has at least.
const LINES: usize = 26_000;

fn program() -> String {
    let code = "      A     M 1.0;\n      L     #a;\n      L     5;\n      +I;\n      T     #b;\n".repeat(10);
    let mut text = String::new();
    for number in 1.. {
        if text.len() > LINES * 14 && text.lines().count() >= LINES {
            break;
        }
        text.push_str(&format!("FUNCTION FC {number} : VOID\nVAR_INPUT\n  a : INT ;\nEND_VAR\nVAR_OUTPUT\n  b : INT ;\nEND_VAR\nBEGIN\n{code}END_FUNCTION\n"));
    }
    text
}

#[test]
fn a_change_in_a_long_program_is_answered_quickly() {
    const URI: &str = "file:///long.stl";
    let (server, editor) = Connection::memory();
    let server = std::thread::spawn(move || serve(&server, Arc::new(Parses)));
    let mut number = 0;
    let mut ask = |method: &str, params: Value| {
        number += 1;
        let request = Request::new(RequestId::from(number), method.to_owned(), params);
        editor.sender.send(Message::Request(request)).expect("the server runs");
        loop {
            if let Message::Response(response) = editor.receiver.recv().expect("the server answers") {
                return serde_json::to_value(response).expect("a response is JSON")["result"].clone();
            }
        }
    };
    let tell = |method: &str, params: Value| {
        let note = Notification::new(method.to_owned(), params);
        editor.sender.send(Message::Notification(note)).expect("the server runs");
    };
    let messages = || loop {
        if let Message::Notification(note) = editor.receiver.recv().expect("the server publishes") {
            return note.params["diagnostics"].as_array().map_or(0, Vec::len);
        }
    };
    let change = |line: u32, text: &str| {
        let range = json!({ "start": { "line": line, "character": 0 }, "end": { "line": line, "character": 99 } });
        let changes = json!([{ "range": range, "text": text }]);
        tell(
            "textDocument/didChange",
            json!({ "textDocument": { "uri": URI, "version": 2 }, "contentChanges": changes }),
        );
    };
    ask("initialize", json!({ "capabilities": {} }));
    tell("initialized", json!({}));
    let text = program();
    // The first statement of the last block.
    let line = text.lines().count() as u32 - 51;
    let document = json!({ "uri": URI, "languageId": "plc", "version": 1, "text": text });
    tell("textDocument/didOpen", json!({ "textDocument": document }));
    assert_eq!(messages(), 0);
    let mut slowest = Duration::ZERO;
    let mut timed = |name: &str, began: Instant| {
        slowest = slowest.max(began.elapsed());
        println!("{name}: {:?}", began.elapsed());
    };
    let place = json!({ "textDocument": { "uri": URI }, "position": { "line": line + 1, "character": 13 } });
    for _ in 0..3 {
        let began = Instant::now();
        change(line, "      A     M 1.0 ));");
        assert!(messages() > 0);
        timed("a mistake", began);
        let began = Instant::now();
        assert!(
            ask("textDocument/hover", place.clone())["contents"]["value"]
                .as_str()
                .is_some_and(|text| text.contains("a : INT"))
        );
        timed("hover", began);
        let began = Instant::now();
        assert_eq!(ask("textDocument/completion", place.clone()).as_array().map(Vec::len), Some(2));
        timed("completion", began);
        let began = Instant::now();
        change(line, "      A     M 1.0;");
        assert!(!ask("textDocument/hover", place.clone()).is_null());
        timed("a change, then hover", began);
    }
    ask("shutdown", Value::Null);
    tell("exit", Value::Null);
    server.join().expect("it does not panic").expect("it ends in order");
    if std::env::var_os("PLCC_LSP_TIMES").is_some() {
        assert!(slowest < Duration::from_millis(100), "{slowest:?}");
    }
}
