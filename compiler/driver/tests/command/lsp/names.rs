//! Where names are declared and used, and what changes with them.

use serde_json::json;

use super::{Edit, Editor, labels, places};

/// The places where the name at the `|` of a piece gets another one, as `file:line`.
fn renamed(editor: &mut Editor, file: &str, piece: &str) -> Vec<String> {
    places(&editor.rename(file, piece, "Other").expect("it can change"))
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
    // A bit of a word: the word is one of its uses, and so is the row of its symbol.
    let found = editor.at("textDocument/references", "main.stl", "stop  := M |11.3");
    assert_eq!(editor.covered(&found), ["main.stl:31 MW 10", "main.stl:35 M 11.3", "symbols.sdf:4 Level"]);
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
    let mut rename = |piece: &str, to: &str| editor.rename("main.stl", piece, to);
    let over = |line: u64| Edit { file: "main.stl".to_owned(), line, text: "over".to_owned() };
    assert_eq!(rename("JC    fu|ll", "over"), Ok(vec![over(22), over(24)]));
    assert_eq!(rename("L     #le|vel", "height").map(|edits| edits.len()), Ok(3));
    let motor = rename("CALL  \"Mo|tor\"", "Pump").expect("it can change");
    assert!(motor.iter().any(|edit| edit.file == "motor.scl" && edit.text == "\"Pump\""), "{motor:?}");
    assert!(motor.iter().any(|edit| edit.file == "symbols.sdf" && edit.text.starts_with("Pump  ")), "{motor:?}");
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
        assert_eq!(renamed(&mut editor, file, piece).join(" "), wanted, "{piece}");
    }
    // A word that is not a name of the block tells what it is.
    let hover = editor.at("textDocument/hover", "list.stl", "|T     #result");
    let text = hover["contents"]["value"].as_str().unwrap_or_default();
    assert!(text.contains("Operand"), "{text}");
    assert!(text.starts_with("```plc\nT\n```"), "one name where both sets of mnemonics have the same: {text}");
    // A component is one of its data type, not of the block that uses it.
    let found = editor.at("textDocument/hover", "line.scl", "#pairs[#list[1]].|x");
    let text = found["contents"]["value"].as_str().unwrap_or_default();
    assert!(text.contains("component of TYPE Pair"), "{text}");
    let found = editor.at("textDocument/completion", "line.scl", "#Twice.|x");
    assert_eq!(labels(&found), ["x", "y"]);
    let found = editor.at("textDocument/completion", "line.scl", "#pairs[#list[1]].|x");
    assert_eq!(labels(&found), ["x", "y"]);
}

#[test]
fn a_table_in_an_editor_is_part_of_the_program() {
    // The name has the same places wherever the cursor is, and an open table is not reported as a source.
    let mut editor = Editor::new("wash");
    editor.open("main.awl");
    editor.messages("main.awl");
    let places = ["main.awl:8", "main.awl:32", "main.scenario.toml:3", "symbols.txt:3"];
    editor.open("symbols.txt");
    assert_eq!(editor.messages("symbols.txt"), Vec::<String>::new());
    assert_eq!(renamed(&mut editor, "symbols.txt", "Pu|mp"), places);
    // Also in settings that were just opened, or changed.
    editor.open("main.scenario.toml");
    assert_eq!(renamed(&mut editor, "main.awl", "R      Pu|mp"), places);
    editor.edit("main.scenario.toml", "[", "\n[");
    let places = ["main.awl:8", "main.awl:32", "main.scenario.toml:4", "symbols.txt:3"];
    assert_eq!(renamed(&mut editor, "main.awl", "R      Pu|mp"), places);
    let mut editor = Editor::new("plant");
    editor.open("symbols.sdf");
    assert_eq!(
        renamed(&mut editor, "symbols.sdf", "Mo|tor"),
        ["main.stl:3", "main.stl:33", "motor.scl:1", "symbols.sdf:3"]
    );
    assert_eq!(renamed(&mut editor, "symbols.sdf", "La|mp"), ["main.stl:37", "symbols.sdf:2"]);
    let found = editor.at("textDocument/references", "symbols.sdf", "La|mp");
    assert_eq!(editor.covered(&found), ["main.stl:37 \"Lamp\"", "symbols.sdf:2 Lamp"]);
    let found = editor.at("textDocument/hover", "symbols.sdf", "La|mp");
    assert!(found["contents"]["value"].as_str().is_some_and(|text| text.contains("`Q 4.0`")), "{found}");
    let found = editor.at("textDocument/definition", "symbols.sdf", "Mo|tor");
    assert_eq!(editor.covered(&json!([found])), ["motor.scl:1 \"Motor\""]);
    let mut editor = Editor::new("press");
    editor.open("tags.xml");
    assert_eq!(editor.messages("tags.xml"), Vec::<String>::new());
    assert_eq!(renamed(&mut editor, "tags.xml", "STRO|KES"), ["press.scl:21", "press.scl:24", "tags.xml:4"]);
}

/// Its name changes in its table and where it is used; `Bool` in a declaration stays the type.
#[test]
fn a_tag_may_have_the_name_of_a_type() {
    let mut editor = Editor::new("tags");
    editor.open("main.scl");
    assert_eq!(editor.messages("main.scl"), Vec::<String>::new());
    let found = renamed(&mut editor, "main.scl", "\"Bo|ol\" := NOT");
    assert_eq!(found, ["main.scl:7", "main.scl:9", "main.scl:10", "tags.xml:3"]);
}

/// All of a name in quotes, and not only the word under the cursor; what has no other name says so before one is typed.
#[test]
fn an_editor_is_told_what_would_be_renamed() {
    let mut editor = Editor::new("tags");
    editor.open("main.scl");
    assert_eq!(editor.messages("main.scl"), Vec::<String>::new());
    for (piece, name) in [("\"up & do|wn\"", "\"up & down\""), ("  o|ld : Bool", "old")] {
        let found = editor.at("textDocument/prepareRename", "main.scl", piece);
        assert_eq!(found["range"], editor.range("main.scl", name), "{found}");
        assert_eq!(found["placeholder"], json!(name.trim_matches('"')));
    }
    let params = editor.position("main.scl", "N|OT #all");
    assert!(editor.ask_or("textDocument/prepareRename", params).is_err());
    let mut editor = Editor::new("plant");
    editor.open("main.stl");
    editor.messages("main.stl");
    let params = editor.position("main.stl", "level := M|W 10");
    assert!(editor.ask_or("textDocument/prepareRename", params).expect_err("an address").contains("only names"));
}

#[test]
fn a_table_in_xml_writes_some_signs_of_a_name_in_another_way() {
    let mut editor = Editor::new("tags");
    editor.open("main.scl");
    assert_eq!(editor.messages("main.scl"), Vec::<String>::new());
    let found = editor.at("textDocument/references", "main.scl", "\"up| & down\"");
    assert_eq!(editor.covered(&found), ["main.scl:10 \"up & down\"", "tags.xml:4 up &amp; down"]);
    let edits = editor.rename("main.scl", "\"up| & down\"", "left & right").expect("it can change");
    let texts: Vec<&str> = edits.iter().map(|edit| edit.text.as_str()).collect();
    assert_eq!(texts, ["\"left & right\"", "left &amp; right"]);
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
