//! A session of an editor with the language server, over a connection in memory and the files in tests/lsp.
//!
//! - `editor`: the editor.
//! - `names`: where names are used, and new ones for them; `languages`: names that only some languages have.

mod editor;
mod languages;
mod names;

use lsp_server::Message;
use serde_json::{Value, json};

use editor::LONGEST;

pub(crate) use editor::{Edit, Editor};

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

/// Where edits are, as `file:line`.
fn places(edits: &[Edit]) -> Vec<String> {
    edits.iter().map(|edit| format!("{}:{}", edit.file, edit.line)).collect()
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
fn what_a_message_reads_can_be_written() {
    let mut editor = Editor::new("words");
    editor.open("words.scl");
    editor.messages("words.scl");
    editor.edit("words.scl", "#\"not\" THEN", "#\"not\"&&TRUE THN");
    // First what does not parse, then what the whole program has.
    for _ in 0..2 {
        assert_eq!(editor.messages("words.scl").len(), 2);
    }
    for (marked, title, text) in [("&&", "Write `AND`", " AND "), ("THN", "Write `THEN`", "THEN")] {
        let (uri, range) = (editor.uri("words.scl"), editor.range("words.scl", marked));
        let params = json!({ "textDocument": { "uri": uri }, "range": range, "context": { "diagnostics": [] } });
        let actions = editor.ask("textDocument/codeAction", params);
        let edit = json!([{ "range": range, "newText": text }]);
        assert_eq!(actions[0]["title"], json!(title), "{actions}");
        assert_eq!(actions[0]["edit"]["changes"][&uri], edit, "{actions}");
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
    let found = editor.at("textDocument/completion", "main.stl", "            |limit := 100");
    assert_eq!(labels(&found), ["limit"], "a line of a list has no mnemonic");
    let found = editor.at("textDocument/signatureHelp", "main.stl", "limit := 1|00");
    assert_eq!(found["signatures"][0]["label"], json!("FC 1(level : INT IN, limit : INT IN)"));
    assert_eq!(found["activeParameter"], json!(1));
}

/// Before their first sign is written, too.
#[test]
fn variables_tags_and_blocks_are_proposed_where_they_can_stand() {
    let mut editor = Editor::new("plant");
    editor.open("main.stl");
    editor.open("motor.scl");
    editor.messages("motor.scl");
    editor.edit("main.stl", "      >I;", "      L     ;\n      >I;");
    for (piece, proposed) in [
        ("L     |;", &["#level", "#limit", "#rest", "DB 10", "\"Start\"", "\"Lamp\"", "\"Level\""][..]),
        ("JC    |full", &["full"]),
        ("CALL  |FC 1", &["FC 1", "\"Motor\"", "\"FC77\""]),
        ("CALL  \"Motor\", |DB 10", &["DB 10"]),
        ("NOP   |0", &[]),
    ] {
        let found = editor.at("textDocument/completion", "main.stl", piece);
        assert_eq!(labels(&found), proposed, "{piece}");
    }
    let found = editor.at("textDocument/completion", "motor.scl", "running := |(start");
    for word in ["start", "\"Lamp\"", "DB 10"] {
        assert!(labels(&found).contains(&word), "{word} is not in {found}");
    }
    assert!(!labels(&found).contains(&"\"Motor\""), "{found}");
    editor.edit("motor.scl", "speed.set + 1;", "'abc");
    let found = editor.at("textDocument/completion", "motor.scl", "'abc|\n");
    assert_eq!(labels(&found), Vec::<&str>::new(), "a text is being written");
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
