//! A session of an editor with the language server, over a connection in memory and the files in tests/lsp.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use lsp_server::{Connection, Message, Notification, Request, RequestId};
use plcc_driver::command::lsp::Files;
use serde_json::{Value, json};

/// A check of the programs of these tests takes less.
const LONGEST: Duration = Duration::from_secs(60);

pub(crate) struct Editor {
    connection: Connection,
    server: Option<std::thread::JoinHandle<Result<(), String>>>,
    folder: tempfile::TempDir,
    next: i32,
    texts: HashMap<String, String>,
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

    fn uri(&self, file: &str) -> String {
        format!("file://{}", self.path(file).display())
    }

    fn tell(&self, method: &str, params: Value) {
        let note = Notification::new(method.to_owned(), params);
        self.connection.sender.send(Message::Notification(note)).expect("the server runs");
    }

    fn ask(&mut self, method: &str, params: Value) -> Value {
        self.ask_or(method, params).unwrap_or_else(|error| panic!("{method}: {error}"))
    }

    pub(crate) fn ask_or(&mut self, method: &str, params: Value) -> Result<Value, String> {
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
    fn edit(&mut self, file: &str, from: &str, to: &str) {
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

    fn range(&self, file: &str, text: &str) -> Value {
        let start = self.texts[file].find(text).unwrap_or_else(|| panic!("{text} is in {file}"));
        json!({ "start": self.place(file, start), "end": self.place(file, start + text.len()) })
    }

    /// Asks about the `|` in a piece of an open file.
    pub(crate) fn at(&mut self, method: &str, file: &str, piece: &str) -> Value {
        let params = self.position(file, piece);
        self.ask(method, params)
    }

    pub(crate) fn position(&self, file: &str, piece: &str) -> Value {
        let before = piece.find('|').expect("a bar marks the place");
        let piece = piece.replace('|', "");
        let start = self.texts[file].find(&piece).unwrap_or_else(|| panic!("{piece} is in {file}"));
        json!({
            "textDocument": { "uri": self.uri(file) },
            "position": self.place(file, start + before),
            "context": { "includeDeclaration": true, "triggerKind": 1, "isRetrigger": false },
        })
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
    fn covered(&mut self, places: &Value) -> Vec<String> {
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

/// Without a check of the whole program they would be statements of STL with an error in each line.
#[test]
fn files_without_blocks_are_not_sources() {
    let mut editor = Editor::new("door");
    ["door.scenario.toml", "plc.toml", "symbols.sdf", "main.stl"].iter().for_each(|file| editor.open(file));
    let (main, mut told) = (json!(editor.uri("main.stl")), Vec::new());
    loop {
        match editor.connection.receiver.recv_timeout(LONGEST).expect("the server publishes") {
            Message::Notification(note) if note.params["uri"] == main => break,
            Message::Notification(note) if note.params["diagnostics"] != json!([]) => told.push(note.params),
            _ => {}
        }
    }
    assert_eq!(told, Vec::<Value>::new());
}

fn labels(items: &Value) -> Vec<&str> {
    items.as_array().expect("a list").iter().filter_map(|item| item["label"].as_str()).collect()
}

#[test]
fn messages_follow_the_text() {
    let mut editor = Editor::new("plant");
    editor.open("main.stl");
    assert_eq!(editor.messages("main.stl"), Vec::<String>::new());
    // What does not parse is reported at once; what does not bind when the program is bound.
    editor.edit("main.stl", "T     #rest;", "T     #rest )) ;");
    let syntax = editor.messages("main.stl");
    assert!(syntax.iter().all(|message| message.ends_with(" 23")) && !syntax.is_empty(), "{syntax:?}");
    editor.edit("main.stl", "#rest )) ;", "#rost;");
    let mut names = editor.messages("main.stl");
    while names.iter().any(|name| syntax.contains(name)) {
        names = editor.messages("main.stl");
    }
    assert_eq!(names.len(), 1, "{names:?}");
    // The message says what is meant.
    let uri = editor.uri("main.stl");
    let range = editor.range("main.stl", "#rost");
    let params = json!({ "textDocument": { "uri": uri }, "range": range, "context": { "diagnostics": [] } });
    let actions = editor.ask("textDocument/codeAction", params);
    assert_eq!(actions[0]["title"], json!("Write `#rest`"), "{actions}");
    editor.edit("main.stl", "#rost", "#rest");
    assert_eq!(editor.messages("main.stl"), Vec::<String>::new());
}

/// Messages about steps and about variables of an S7-200 say in other words what is meant.
#[test]
fn every_name_that_is_meant_can_be_written() {
    for (folder, file, from, to, title) in [
        ("door", "door.gr7", "  TO Opening\n", "  TO Opning\n", "Write `Opening`"),
        ("wash", "main.awl", "MOVW   #now", "MOVW   #nou", "Write `#now`"),
    ] {
        let mut editor = Editor::new(folder);
        editor.open(file);
        editor.messages(file);
        editor.edit(file, from, to);
        assert_eq!(editor.messages(file).len(), 1);
        let wrong = to.split_whitespace().last().expect("a word");
        let range = editor.range(file, wrong);
        let uri = editor.uri(file);
        let params = json!({ "textDocument": { "uri": uri }, "range": range, "context": { "diagnostics": [] } });
        let actions = editor.ask("textDocument/codeAction", params);
        assert_eq!(actions[0]["title"], json!(title), "{actions}");
    }
}

#[test]
fn words_are_explained() {
    let mut editor = Editor::new("plant");
    editor.open("main.stl");
    editor.open("motor.scl");
    editor.messages("motor.scl");
    let mut hover = |file: &str, piece: &str| {
        editor.at("textDocument/hover", file, piece)["contents"]["value"].as_str().unwrap_or_default().to_owned()
    };
    for (file, piece, texts) in [
        ("main.stl", "L     #le|vel", &["level : INT", "IN of FUNCTION FC 1", "in mm"][..]),
        ("main.stl", "      |>I", &[">I"]),
        ("main.stl", "J|C    full", &["JC / SPB", "Operand"]),
        ("main.stl", "JC    fu|ll", &["jump label"]),
        ("main.stl", "CALL  F|C 1", &["FUNCTION FC 1", "Level of a tank", "`limit` IN INT"]),
        ("main.stl", "start := \"St|art\"", &["`I 0.0`", "start button"]),
        ("main.stl", "level := M|W 10", &["16 bits of M", "\"Level\""]),
        ("main.stl", "CALL  \"Mo|tor\"", &["FUNCTION_BLOCK Motor", "`running` OUT BOOL"]),
        ("motor.scl", "speed.se|t :=", &["speed.set : INT", "byte 4.0 of the instance"]),
    ] {
        let found = hover(file, piece);
        for text in texts {
            assert!(found.contains(text), "{piece}: {text} is not in {found}");
        }
    }
}

#[test]
fn declarations_and_uses_are_found() {
    let mut editor = Editor::new("plant");
    editor.open("main.stl");
    editor.open("motor.scl");
    editor.messages("motor.scl");
    let found = editor.at("textDocument/definition", "main.stl", "CALL  \"Mo|tor\"");
    assert_eq!(editor.covered(&json!([found])), ["motor.scl:1 \"Motor\""]);
    let found = editor.at("textDocument/references", "main.stl", "L     #le|vel");
    assert_eq!(editor.covered(&found), ["main.stl:10 level", "main.stl:19 level", "main.stl:31 level"]);
    // A bit of a word: the word is one of its uses.
    let found = editor.at("textDocument/references", "main.stl", "stop  := M |11.3");
    assert_eq!(editor.covered(&found), ["main.stl:31 MW 10", "main.stl:35 M 11.3"]);
    let found = editor.at("textDocument/references", "motor.scl", "  st|art : BOOL");
    assert_eq!(editor.covered(&found), ["main.stl:34 start", "motor.scl:3 start", "motor.scl:16 start"]);
    let found = editor.at("textDocument/references", "main.stl", "JC    fu|ll");
    assert_eq!(editor.covered(&found), ["main.stl:22 full", "main.stl:24 full"]);
}

#[test]
fn names_change_everywhere() {
    let mut editor = Editor::new("plant");
    editor.open("main.stl");
    editor.open("motor.scl");
    editor.messages("motor.scl");
    let mut rename = |piece: &str, to: &str| {
        let mut params = editor.position("main.stl", piece);
        params["newName"] = json!(to);
        let edits = editor.ask_or("textDocument/rename", params)?;
        let mut texts = Vec::new();
        for (uri, edits) in edits["changes"].as_object().expect("changes") {
            let name = uri.rsplit('/').next().unwrap_or_default();
            texts.extend(edits.as_array().expect("a list").iter().map(|edit| format!("{name} {}", edit["newText"])));
        }
        texts.sort();
        Ok::<_, String>(texts)
    };
    assert_eq!(rename("JC    fu|ll", "over"), Ok(vec!["main.stl \"over\"".to_owned(); 2]));
    assert_eq!(rename("L     #le|vel", "height").map(|edits| edits.len()), Ok(3));
    let motor = rename("CALL  \"Mo|tor\"", "Pump").expect("it can change");
    assert!(motor.contains(&"motor.scl \"\\\"Pump\\\"\"".to_owned()), "{motor:?}");
    assert!(motor.iter().any(|edit| edit.starts_with("symbols.sdf \"Pump  ")), "{motor:?}");
    assert!(rename("L     #le|vel", "limit").expect_err("it is taken").contains("already"));
    assert!(rename("level := M|W 10", "x").is_err());
}

/// Names that are also mnemonics, elements, pins, types, functions, parameters of the library, words of a header, addresses, or the
/// names of other blocks.
#[test]
fn a_name_is_changed_only_where_it_is_meant() {
    let mut editor = Editor::new("alike");
    for file in ["line.scl", "lamp.s7dcl", "list.stl"] {
        editor.open(file);
    }
    assert_eq!(editor.messages("list.stl"), Vec::<String>::new());
    let mut lines = |file: &str, piece: &str| {
        let mut params = editor.position(file, piece);
        params["newName"] = json!("Other");
        let edits = editor.ask("textDocument/rename", params);
        let mut found = Vec::new();
        for (uri, edits) in edits["changes"].as_object().expect("changes") {
            let name = uri.rsplit('/').next().unwrap_or_default();
            let line = |edit: &Value| edit["range"]["start"]["line"].as_u64().expect("a line") + 1;
            found.extend(edits.as_array().expect("a list").iter().map(|edit| (name.to_owned(), line(edit))));
        }
        found.sort();
        let words: Vec<String> = found.into_iter().map(|(name, line)| format!("{name}:{line}")).collect();
        words.join(" ")
    };
    for (file, piece, wanted) in [
        ("line.scl", "TYPE \"Pa|ir\"", "line.scl:2 line.scl:10 line.scl:15 line.scl:35 line.scl:36"),
        ("line.scl", "DATA_BLOCK \"Pa|ir\"", "line.scl:9 line.scl:57"),
        (
            "line.scl",
            "|x : Int;\n  y",
            "line.scl:4 line.scl:12 line.scl:20 line.scl:35 line.scl:42 line.scl:50 line.scl:57",
        ),
        ("line.scl", "|y : Int;", "line.scl:5 line.scl:21 line.scl:35 line.scl:50"),
        ("line.scl", "|x : Int;\nEND_VAR", "line.scl:17 line.scl:20 line.scl:21 line.scl:43"),
        ("line.scl", "aut|hor : Int", "line.scl:27 line.scl:41 line.scl:49 line.scl:55"),
        ("line.scl", "T|1 : TON", "line.scl:30 line.scl:39 line.scl:40 line.scl:56"),
        ("line.scl", "t|on : TON", "line.scl:31 line.scl:40"),
        ("line.scl", "i|n : Int", "line.scl:32 line.scl:39 line.scl:41"),
        ("line.scl", "lim|it : Int", "line.scl:33 line.scl:41 line.scl:42 line.scl:43"),
        ("line.scl", "li|st : Array", "line.scl:34 line.scl:42 line.scl:57"),
        ("line.scl", "pa|ir : ", "line.scl:35 line.scl:43 line.scl:50"),
        ("line.scl", "DATA_BLOCK \"T|1\"", "line.scl:46 line.scl:55 line.scl:56 line.scl:57"),
        ("lamp.s7dcl", "o|n : Bool;\n        time", "lamp.s7dcl:3 lamp.s7dcl:14 lamp.s7dcl:31 lamp.s7dcl:32"),
        ("lamp.s7dcl", "ti|me : Time", "lamp.s7dcl:4 lamp.s7dcl:14 lamp.s7dcl:31 lamp.s7dcl:32"),
        ("lamp.s7dcl", "li|t : Bool", "lamp.s7dcl:7 lamp.s7dcl:14 lamp.s7dcl:31 lamp.s7dcl:32"),
        ("lamp.s7dcl", "T|1 : TON_TIME", "lamp.s7dcl:10 lamp.s7dcl:14"),
        (
            "lamp.s7dcl",
            "o|n : Bool;\n    END_VAR",
            "lamp.s7dcl:20 lamp.s7dcl:31 lamp.s7dcl:32 lamp.s7dcl:32 line.scl:56",
        ),
        ("lamp.s7dcl", "|a, coil", "lamp.s7dcl:27 lamp.s7dcl:31 lamp.s7dcl:32"),
        ("lamp.s7dcl", "a, co|il", "lamp.s7dcl:27 lamp.s7dcl:32"),
        ("list.stl", "|t : INT", "line.scl:57 list.stl:3 list.stl:11"),
        ("list.stl", "|p : ANY", "line.scl:57 list.stl:4 list.stl:15"),
        ("list.stl", "|d : INT", "line.scl:57 list.stl:5 list.stl:12"),
    ] {
        assert_eq!(lines(file, piece), wanted, "{piece}");
    }
    // A word that is not a name of the block tells what it is.
    let hover = editor.at("textDocument/hover", "list.stl", "|T     #result");
    let text = hover["contents"]["value"].as_str().unwrap_or_default();
    assert!(text.contains("Operand"), "{text}");
    let found = editor.at("textDocument/completion", "line.scl", "#Twice.|x");
    assert_eq!(labels(&found), ["x", "y"]);
    let found = editor.at("textDocument/completion", "line.scl", "#pairs[#list[1]].|x");
    assert_eq!(labels(&found), ["x", "y"]);
}

#[test]
fn a_table_in_an_editor_is_part_of_the_program() {
    let lines = |editor: &mut Editor, file: &str, piece: &str| {
        let mut params = editor.position(file, piece);
        params["newName"] = json!("Other");
        let edits = editor.ask("textDocument/rename", params);
        let mut found = Vec::new();
        for (uri, edits) in edits["changes"].as_object().expect("changes") {
            let name = uri.rsplit('/').next().unwrap_or_default();
            let line = |edit: &Value| edit["range"]["start"]["line"].as_u64().expect("a line") + 1;
            found.extend(edits.as_array().expect("a list").iter().map(|edit| format!("{name}:{}", line(edit))));
        }
        found.sort();
        found
    };
    // The name has the same places wherever the cursor is, and an open table is not reported as a source.
    let mut editor = Editor::new("wash");
    editor.open("main.awl");
    editor.messages("main.awl");
    let places = ["main.awl:32", "main.awl:8", "main.scenario.toml:3", "symbols.txt:3"];
    editor.open("symbols.txt");
    assert_eq!(editor.messages("symbols.txt"), Vec::<String>::new());
    assert_eq!(lines(&mut editor, "symbols.txt", "Pu|mp"), places);
    // Also in settings that were just opened, or changed.
    editor.open("main.scenario.toml");
    assert_eq!(lines(&mut editor, "main.awl", "R      Pu|mp"), places);
    editor.edit("main.scenario.toml", "[", "\n[");
    let places = ["main.awl:32", "main.awl:8", "main.scenario.toml:4", "symbols.txt:3"];
    assert_eq!(lines(&mut editor, "main.awl", "R      Pu|mp"), places);
    let mut editor = Editor::new("plant");
    editor.open("symbols.sdf");
    assert_eq!(
        lines(&mut editor, "symbols.sdf", "Mo|tor"),
        ["main.stl:3", "main.stl:33", "motor.scl:1", "symbols.sdf:3"]
    );
    assert_eq!(lines(&mut editor, "symbols.sdf", "La|mp"), ["main.stl:37", "symbols.sdf:2"]);
    let found = editor.at("textDocument/references", "symbols.sdf", "La|mp");
    assert_eq!(editor.covered(&found), ["main.stl:37 \"Lamp\"", "symbols.sdf:2 Lamp"]);
    let found = editor.at("textDocument/hover", "symbols.sdf", "La|mp");
    assert!(found["contents"]["value"].as_str().is_some_and(|text| text.contains("`Q 4.0`")), "{found}");
    let found = editor.at("textDocument/definition", "symbols.sdf", "Mo|tor");
    assert_eq!(editor.covered(&json!([found])), ["motor.scl:1 \"Motor\""]);
    let mut editor = Editor::new("press");
    editor.open("tags.xml");
    assert_eq!(editor.messages("tags.xml"), Vec::<String>::new());
    assert_eq!(lines(&mut editor, "tags.xml", "STRO|KES"), ["press.scl:21", "press.scl:24", "tags.xml:4"]);
}

/// Also right after the file was opened, when the others are not read yet.
#[test]
fn a_name_is_changed_everywhere_from_the_first_moment_on() {
    for method in ["rename", "references"] {
        let mut editor = Editor::new("plant");
        editor.open("motor.scl");
        let mut params = editor.position("motor.scl", "  st|art : BOOL");
        params["newName"] = json!("launch");
        let found = editor.ask(&format!("textDocument/{method}"), params).to_string();
        for file in ["motor.scl", "main.stl"] {
            assert!(found.contains(file), "{method}: {file} in {found}");
        }
    }
}

#[test]
fn words_and_parameters_are_proposed() {
    let mut editor = Editor::new("plant");
    editor.open("main.stl");
    editor.open("motor.scl");
    editor.messages("motor.scl");
    let found = editor.at("textDocument/completion", "motor.scl", "  speed.|set :=");
    assert_eq!(labels(&found), ["set", "real"]);
    let found = editor.at("textDocument/completion", "main.stl", "      L     #|level");
    assert_eq!(labels(&found), ["level", "limit", "rest"]);
    let found = editor.at("textDocument/completion", "main.stl", "      |>I;");
    assert!(labels(&found).contains(&"JC") && labels(&found).contains(&">=I"));
    let found = editor.at("textDocument/completion", "main.stl", "level := MW 10,|");
    assert!(labels(&found).contains(&"limit"), "{found}");
    let found = editor.at("textDocument/signatureHelp", "main.stl", "limit := 1|00");
    assert_eq!(found["signatures"][0]["label"], json!("FC 1(level : INT IN, limit : INT IN)"));
    assert_eq!(found["activeParameter"], json!(1));
}

#[test]
fn constants_and_labels_of_scl_are_names() {
    let mut editor = Editor::new("press");
    editor.open("press.scl");
    assert_eq!(editor.messages("press.scl"), Vec::<String>::new());
    for (piece, texts) in [
        ("#n < #LI|MIT", &["LIMIT : Int := 10", "constant of FUNCTION Count"][..]),
        ("> \"STRO|KES\"", &["STROKES : Int := 12", "constant of the tag tables"]),
        ("GOTO ag|ain", &["again", "jump label"]),
    ] {
        let found = editor.at("textDocument/hover", "press.scl", piece);
        let found = found["contents"]["value"].as_str().unwrap_or_default().to_owned();
        for text in texts {
            assert!(found.contains(text), "{piece}: {text} is not in {found}");
        }
    }
    for (piece, place) in [
        ("#forces[#LA|ST]", "press.scl:7 LAST"),
        ("> STRO|KES;", "tags.xml:4 STROKES"),
        ("GOTO ov|er", "press.scl:25 over"),
    ] {
        let found = editor.at("textDocument/definition", "press.scl", piece);
        assert_eq!(editor.covered(&json!([found])), [place]);
    }
    for (piece, places) in [
        (
            "  LI|MIT : Int",
            &["press.scl:6 LIMIT", "press.scl:7 LIMIT", "press.scl:10 LIMIT", "press.scl:18 #LIMIT"][..],
        ),
        ("> STRO|KES;", &["press.scl:21 \"STROKES\"", "press.scl:24 STROKES", "tags.xml:4 STROKES"]),
        ("  ag|ain:", &["press.scl:15 again", "press.scl:19 again"]),
    ] {
        let found = editor.at("textDocument/references", "press.scl", piece);
        assert_eq!(editor.covered(&found), places);
    }
    let mut rename = |piece: &str, to: &str| {
        let mut params = editor.position("press.scl", piece);
        params["newName"] = json!(to);
        let edits = editor.ask_or("textDocument/rename", params)?;
        let files = edits["changes"].as_object().expect("changes");
        Ok::<_, String>(files.values().map(|edits| edits.as_array().expect("a list").len()).sum::<usize>())
    };
    assert_eq!(rename("  LI|MIT : Int", "BOUND"), Ok(4));
    assert_eq!(rename("> STRO|KES;", "HITS"), Ok(3));
    assert_eq!(rename("  ag|ain:", "back"), Ok(2));
    // The function in XML writes the tag, and has an input of its own with the name of the other one.
    assert!(rename("  \"Ho|rn\" :=", "Siren").expect_err("XML has it").contains("Guard.xml"));
    assert_eq!(rename("  fo|rce : Int", "power"), Ok(4));
    for (piece, to) in
        [("  LI|MIT : Int", "force"), ("  LI|MIT : Int", "Last"), ("  fo|rce : Int", "limit"), ("  ag|ain:", "OVER")]
    {
        assert!(rename(piece, to).expect_err("it is taken").contains("already"), "{piece} {to}");
    }
    let found = editor.at("textDocument/completion", "press.scl", "  |#n := 0;");
    for word in ["IF", "THEN", "END_REPEAT", "GOTO", "DIV", "TRUE", "END_REGION"] {
        assert!(labels(&found).contains(&word), "{word} is not in {found}");
    }
    assert!(!labels(&found).contains(&"ELSEIF") && !labels(&found).contains(&"VAR_INPUT"));
    let found = editor.at("textDocument/completion", "press.scl", "GOTO |again");
    assert_eq!(labels(&found), ["again", "over"]);
    let found = editor.at("textDocument/completion", "press.scl", "IF #n < #|LIMIT");
    assert_eq!(labels(&found), ["force", "forces", "n", "LIMIT", "LAST"]);
}

#[test]
fn steps_and_blocks_of_the_library_are_known() {
    let mut editor = Editor::new("door");
    editor.open("door.gr7");
    editor.open("main.stl");
    assert_eq!(editor.messages("main.stl"), Vec::<String>::new());
    let found = editor.at("textDocument/hover", "door.gr7", "FROM Open|ing");
    let found = found["contents"]["value"].as_str().unwrap_or_default();
    assert!(found.contains("step S2 Opening") && found.contains("The motor runs"), "{found}");
    for (piece, wanted) in [("AND Opening.|T >", "Opening.T : TIME"), ("NOT Ask.|TT", "Ask.TT : BOOL")] {
        let found = editor.at("textDocument/hover", "door.gr7", piece);
        let found = found["contents"]["value"].as_str().unwrap_or_default();
        assert!(found.contains(wanted), "{found}");
    }
    let found = editor.at("textDocument/completion", "door.gr7", "AND Opening.|T >");
    assert_eq!(labels(&found)[..4], ["X", "T", "U", "S1"]);
    let found = editor.at("textDocument/completion", "door.gr7", "NOT Ask.|TT");
    assert_eq!(labels(&found), ["TV", "TT", "TS", "TNO"]);
    let found = editor.at("textDocument/definition", "door.gr7", "TO Open|ing");
    assert_eq!(editor.covered(&json!([found])), ["door.gr7:10 Opening"]);
    let found = editor.at("textDocument/references", "door.gr7", "STEP Open|ing");
    let own =
        ["10 Opening", "17 Opening", "22 Opening", "24 Opening", "24 S002"].map(|place| format!("door.gr7:{place}"));
    let others = [23, 25].map(|line| format!("main.stl:{line} Opening"));
    assert_eq!(editor.covered(&found), [&others[..], &own[..]].concat());
    let file = json!({ "textDocument": { "uri": editor.uri("door.gr7") } });
    let symbols = editor.ask("textDocument/documentSymbol", file);
    let parts = symbols[0]["children"].as_array().expect("a list");
    let names: Vec<&str> = parts.iter().filter_map(|one| one["name"].as_str()).collect();
    assert_eq!(names, ["Request", "Closed", "Opening", "Ask", "Opened"]);
    let mut rename = |file: &str, piece: &str| {
        let mut params = editor.position(file, piece);
        params["newName"] = json!("Other");
        editor.ask_or("textDocument/rename", params)
    };
    assert!(rename("main.stl", "CALL  \"SC|ALE\"").expect_err("it is not ours").contains("library"));
}

#[test]
fn names_of_an_s7_200_are_known() {
    let mut editor = Editor::new("wash");
    editor.open("main.awl");
    assert_eq!(editor.messages("main.awl"), Vec::<String>::new());
    for (piece, texts) in [
        ("LD     Wa|ter", &["\"Water\"", "I0.3", "water is there"][..]),
        ("LDW<   #n|ow", &["now : INT", "IN of SUBROUTINE_BLOCK Fill SBR0", "measured"]),
        ("CALL   Fi|ll", &["SUBROUTINE_BLOCK Fill SBR0", "Opens the valve", "`now` IN INT", "`open` OUT BOOL"]),
        ("JMP    |3", &["LBL 3", "jump label of ORGANIZATION_BLOCK MAIN OB1"]),
        ("A      V10|1.2", &["one bit of V", "\"Level\"` VW100"]),
        ("MO|VW   #now", &["MOVW"]),
        ("L|DW<   #now", &["LDW<"]),
        ("LDW|<   #now", &["LDW<"]),
        ("|=      #open", &["Writes S0 to the bit"]),
    ] {
        let found = editor.at("textDocument/hover", "main.awl", piece);
        let found = found["contents"]["value"].as_str().unwrap_or_default().to_owned();
        for text in texts {
            assert!(found.contains(text), "{piece}: {text} is not in {found}");
        }
    }
    for (piece, place) in [
        ("CALL   Fi|ll", "main.awl:14 Fill"),
        ("CALL   Fill, Le|vel", "symbols.txt:2 Level"),
        ("MOVW   #no|w", "main.awl:17 now"),
        ("JMP    |3", "main.awl:10 3"),
        ("ATCH   St|opped", "main.awl:28 Stopped"),
    ] {
        let found = editor.at("textDocument/definition", "main.awl", piece);
        assert_eq!(editor.covered(&json!([found])), [place]);
    }
    let mut uses = |piece: &str| {
        let found = editor.at("textDocument/references", "main.awl", piece);
        editor.covered(&found)
    };
    assert_eq!(uses("LDW<   #n|ow"), ["main.awl:17 now", "main.awl:24 #now", "main.awl:26 #now"]);
    // A bit of the word that a symbol names.
    assert_eq!(uses("A      V10|1.2"), ["main.awl:7 V101.2", "main.awl:8 Level", "symbols.txt:2 Level"]);
    assert_eq!(uses("R      Pu|mp"), ["main.awl:8 Pump", "main.awl:32 Pump", "symbols.txt:3 Pump"]);
    assert_eq!(uses("LBL    |3"), ["main.awl:6 3", "main.awl:10 3"]);
    let mut rename = |piece: &str, to: &str| {
        let mut params = editor.position("main.awl", piece);
        params["newName"] = json!(to);
        let edits = editor.ask_or("textDocument/rename", params)?;
        let mut texts = Vec::new();
        for (uri, edits) in edits["changes"].as_object().expect("changes") {
            let name = uri.rsplit('/').next().unwrap_or_default();
            let range = |edit: &Value| edit["range"]["start"]["line"].as_u64().expect("a line") + 1;
            texts.extend(edits.as_array().expect("a list").iter().map(|edit| format!("{name}:{}", range(edit))));
        }
        texts.sort();
        Ok::<_, String>(texts)
    };
    let lines = |names: &[&str]| Ok(names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>());
    assert_eq!(rename("LDW<   #n|ow", "level"), lines(&["main.awl:17", "main.awl:24", "main.awl:26"]));
    assert_eq!(
        rename("R      Pu|mp", "Valve"),
        lines(&["main.awl:32", "main.awl:8", "main.scenario.toml:3", "symbols.txt:3"])
    );
    assert_eq!(rename("CALL   Fi|ll", "Top_up"), lines(&["main.awl:14", "main.awl:8"]));
    assert!(rename("R      Pu|mp", "Level").expect_err("it is taken").contains("already"));
    assert!(rename("R      Pu|mp", "VW8").expect_err("it is an address").contains("address"));
    assert!(rename("LBL    |3", "x").is_err());
    let found = editor.at("textDocument/completion", "main.awl", "MOVW   #|now");
    assert_eq!(labels(&found), ["now", "open", "Water", "Level", "Pump", "MAIN", "Fill", "Stopped"]);
    let found = editor.at("textDocument/completion", "main.awl", "JMP    |3");
    assert_eq!(labels(&found), ["3"]);
    let found = editor.at("textDocument/completion", "main.awl", "|MOVW   #now");
    assert!(labels(&found).contains(&"MOVW"));
}

#[test]
fn a_file_has_an_outline_folds_colours_and_a_layout() {
    let mut editor = Editor::new("plant");
    editor.open("main.stl");
    editor.messages("main.stl");
    let file = json!({ "textDocument": { "uri": editor.uri("main.stl") } });
    let symbols = editor.ask("textDocument/documentSymbol", file.clone());
    let names: Vec<&str> = symbols.as_array().expect("a list").iter().filter_map(|one| one["name"].as_str()).collect();
    assert_eq!(names, ["DB 10", "FC 1", "OB 1"]);
    let inner: Vec<&str> =
        symbols[1]["children"].as_array().expect("a list").iter().filter_map(|one| one["name"].as_str()).collect();
    assert_eq!(inner, ["level", "limit", "rest", "Network 1"]);
    let folds = editor.ask("textDocument/foldingRange", file.clone());
    assert!(
        folds.as_array().expect("a list").iter().any(|fold| fold["startLine"] == 8 && fold["endLine"] == 11),
        "{folds}"
    );
    let colours = editor.ask("textDocument/semanticTokens/full", file.clone());
    let data = colours["data"].as_array().expect("a list");
    assert!(data.len() > 100 && data.len().is_multiple_of(5));
    let mut format = file;
    format["options"] = json!({ "tabSize": 2, "insertSpaces": true });
    assert_eq!(editor.ask("textDocument/formatting", format.clone()), json!([]));
    editor.edit("main.stl", "      JC    full;", " JC full;");
    let edits = editor.ask("textDocument/formatting", format);
    assert!(edits[0]["newText"].as_str().expect("a text").contains("\n      JC    full;\n"));
}

#[test]
fn elements_pins_and_wires_of_networks_are_explained() {
    let mut editor = Editor::new("alike");
    editor.open("lamp.s7dcl");
    editor.messages("lamp.s7dcl");
    for (piece, texts) in [
        ("Con|tact( #on )", &["Bit logic: Contact", "- `operand` input"][..]),
        ("#T1.TO|N( pt", &["TON", "- `pt` input", "- `et` output"]),
        ("TON( p|t :=", &["TON.pt", "input of TON"]),
        ("RUNG #on  |A( in2", &["Bit logic: A", "- `in1` … input"]),
        ("A( in|2 :=", &["A.in2", "input of A"]),
        ("wi|re#powerrail", &["wire#powerrail", "TRUE"]),
        ("wire#power|rail", &["wire#powerrail", "TRUE"]),
        // The parameter of a block.
        ("#one( o|n :=", &["on : Bool", "IN of FUNCTION_BLOCK Lamp"][..]),
    ] {
        let found = editor.at("textDocument/hover", "lamp.s7dcl", piece);
        let found = found["contents"]["value"].as_str().unwrap_or_default().to_owned();
        for text in texts {
            assert!(found.contains(text), "{piece}: {text} is not in {found}");
        }
    }
    let found = editor.at("textDocument/completion", "lamp.s7dcl", "RUNG #on  |A( in2");
    for name in ["Contact", "Coil", "A", "TON"] {
        assert!(labels(&found).contains(&name), "{name} is not in {found}");
    }
    let found = editor.at("textDocument/completion", "lamp.s7dcl", "RUNG #on  A( |in2");
    assert_eq!(labels(&found), ["in1"]);
    let found = editor.at("textDocument/completion", "lamp.s7dcl", "TON( pt := #time, |et");
    assert_eq!(labels(&found), ["en", "et", "eno"]);
    let found = editor.at("textDocument/completion", "lamp.s7dcl", "#one( |on :=");
    assert_eq!(labels(&found), ["on", "time", "lit"]);
}

/// As while the block is not written yet.
#[test]
fn a_symbol_like_the_number_of_its_block_does_not_end_the_server() {
    let mut editor = Editor::new("plant");
    editor.open("main.stl");
    editor.messages("main.stl");
    editor.edit("main.stl", "      A     DB10.DBX 2.0;", "      CALL  \"FC77\";");
    let found = editor.at("textDocument/hover", "main.stl", "CALL  \"FC|77\"");
    let found = found["contents"]["value"].as_str().unwrap_or_default();
    assert!(found.contains("FC 77"), "{found}");
    for method in ["definition", "references", "completion", "signatureHelp", "documentHighlight"] {
        editor.at(&format!("textDocument/{method}"), "main.stl", "CALL  \"FC|77\"");
    }
}

/// As while the data type is not written yet.
#[test]
fn a_data_block_of_its_own_name_does_not_end_the_server() {
    let mut editor = Editor::new("alike");
    editor.open("line.scl");
    editor.messages("line.scl");
    editor.edit("line.scl", "TYPE \"Pair\"", "TYPE \"Pear\"");
    for method in ["hover", "definition", "references", "completion", "signatureHelp", "documentHighlight"] {
        editor.at(&format!("textDocument/{method}"), "line.scl", "t := \"Pair\".|x");
    }
    // Each with the name of the other.
    editor.edit("line.scl", "DATA_BLOCK \"Pair\"\n\"Pair\"", "DATA_BLOCK \"Pair\"\n\"T1\"");
    editor.edit("line.scl", "DATA_BLOCK \"T1\"\n\"Line\"", "DATA_BLOCK \"T1\"\n\"Pair\"");
    for method in ["hover", "definition", "references", "completion", "signatureHelp", "documentHighlight"] {
        editor.at(&format!("textDocument/{method}"), "line.scl", "p := \"T1\".|list");
    }
}

#[test]
fn nonsense_does_not_end_the_server() {
    let mut editor = Editor::new("plant");
    assert!(editor.ask_or("textDocument/nothing", json!({})).is_err());
    assert!(editor.ask_or("textDocument/hover", json!({ "x": 1 })).is_err());
    editor.tell("textDocument/didChange", json!({ "textDocument": 3 }));
    let nowhere =
        json!({ "textDocument": { "uri": "file:///no/such.stl" }, "position": { "line": 9, "character": 9 } });
    assert_eq!(editor.ask("textDocument/hover", nowhere), Value::Null);
    let web = json!({ "textDocument": { "uri": "https://example.com/a" }, "position": { "line": 0, "character": 0 } });
    assert!(editor.ask_or("textDocument/hover", web).is_err());
    // Every place of a file has an answer, also while it is broken.
    editor.open("main.stl");
    editor.edit("main.stl", "BEGIN", "\"é😀 ( [ #");
    for line in 0..40 {
        for character in [0, 5, 7, 13, 400] {
            let place = json!({ "textDocument": { "uri": editor.uri("main.stl") }, "position": { "line": line, "character": character }, "context": { "includeDeclaration": true, "triggerKind": 1, "isRetrigger": false } });
            for method in ["hover", "definition", "references", "completion", "signatureHelp", "documentHighlight"] {
                editor.ask(&format!("textDocument/{method}"), place.clone());
            }
        }
    }
}
