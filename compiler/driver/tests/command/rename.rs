//! Names that an editor changes, in everything that has them.

use crate::lsp::Editor;

/// The edits that give the name at the `|` of a piece another one, as `file:line text`.
fn rename(editor: &mut Editor, file: &str, piece: &str, to: &str) -> Result<Vec<String>, String> {
    let edits = editor.rename(file, piece, to)?;
    Ok(edits.iter().map(|edit| format!("{}:{:02} {}", edit.file, edit.line, edit.text)).collect())
}

#[test]
fn assertions_scenarios_and_tables_follow() {
    let mut editor = Editor::new("mixer");
    editor.open("mixer.scl");
    assert_eq!(editor.messages("mixer.scl"), Vec::<String>::new());
    assert_eq!(
        rename(&mut editor, "mixer.scl", "  sp|eed : Int", "rate"),
        Ok([
            "mixer.scenario.toml:03 rate",
            "mixer.scenario.toml:04 rate",
            "mixer.scenario.toml:04 rate",
            "mixer.scl:06 rate",
            "mixer.scl:10 #rate",
            "mixer.scl:10 #rate",
            "mixer.scl:13 #rate",
            "mixer.scl:24 rate",
            "plc.toml:08 rate",
            "watch.toml:02 rate",
        ]
        .map(str::to_owned)
        .to_vec())
    );
    // What is not a word is in quotes where a name would end.
    assert_eq!(
        rename(&mut editor, "mixer.scl", "\"La|mp\" :=", "Lamp.1"),
        Ok([
            "mixer.scenario.toml:03 \"\\\"Lamp.1\\\"\"",
            "mixer.scl:12 \"Lamp.1\"",
            "mixer.scl:13 \"Lamp.1\"",
            "plc.toml:08 \\\"Lamp.1\\\"",
            "tags.xml:03 Lamp.1",
            "watch.toml:06 \\\"Lamp.1\\\"",
        ]
        .map(str::to_owned)
        .to_vec())
    );
    let blocks = rename(&mut editor, "mixer.scl", "DATA_BLOCK \"Mixer|_DB\"", "Big mixer").expect("it can change");
    assert!(blocks.contains(&"mixer.scenario.toml:03 \"Big mixer\"".to_owned()), "{blocks:?}");
    assert!(blocks.contains(&"mixer.scenario.toml:04 Big mixer".to_owned()), "{blocks:?}");
    assert!(blocks.contains(&"watch.toml:02 Big mixer".to_owned()), "{blocks:?}");
    // References have the assertions, too.
    let found = editor.at("textDocument/references", "mixer.scl", "  sp|eed : Int");
    assert_eq!(found.as_array().map(Vec::len), Some(5));
}

#[test]
fn the_result_of_a_function_has_its_name() {
    let mut editor = Editor::new("press");
    editor.open("press.scl");
    assert_eq!(editor.messages("press.scl"), Vec::<String>::new());
    for piece in ["FUNCTION \"Co|unt\"", "#Co|unt := #n", "\"Co|unt\"(force"] {
        assert_eq!(
            rename(&mut editor, "press.scl", piece, "Strokes so far"),
            Ok([
                "press.scl:01 \"Strokes so far\"",
                "press.scl:26 #\"Strokes so far\"",
                "press.scl:34 \"Strokes so far\"",
            ]
            .map(str::to_owned)
            .to_vec())
        );
    }
    let wrong = rename(&mut editor, "press.scl", "FUNCTION \"Co|unt\"", "force").expect_err("it cannot have it");
    assert_eq!(wrong, "`force` is already the name of something else");
}

#[test]
fn steps_and_transitions_have_names() {
    let mut editor = Editor::new("door");
    editor.open("door.gr7");
    editor.open("main.stl");
    assert_eq!(editor.messages("main.stl"), Vec::<String>::new());
    assert_eq!(
        rename(&mut editor, "door.gr7", "STEP Open|ing", "Lifting"),
        Ok([
            "door.gr7:10 Lifting",
            "door.gr7:17 Lifting",
            "door.gr7:22 Lifting",
            "door.gr7:24 Lifting",
            "door.scenario.toml:03 Lifting",
            "main.stl:23 Lifting",
            "main.stl:25 Lifting",
        ]
        .map(str::to_owned)
        .to_vec())
    );
    assert_eq!(
        rename(&mut editor, "door.gr7", "TRANSITION A|sk", "On request"),
        Ok(["door.gr7:15 \"On request\"", "door.gr7:24 \"On request\""].map(str::to_owned).to_vec())
    );
    for (to, why) in [
        ("Closed", "already"),
        ("S1", "already"),
        ("Request", "already"),
        ("MOP", "already"),
        ("MW10", "an address"),
        ("END_STEP", "is a word"),
    ] {
        let wrong = rename(&mut editor, "door.gr7", "STEP Open|ing", to).expect_err("it cannot have it");
        assert!(wrong.contains(why), "{to}: {wrong}");
    }
}

/// `IF` of a statement is not the variable `"IF"`.
#[test]
fn words_of_the_language_stay() {
    let mut editor = Editor::new("words");
    editor.open("words.scl");
    assert_eq!(editor.messages("words.scl"), Vec::<String>::new());
    for (piece, to, edits) in [
        ("\"I|F\" : Int", "limit", &["04 \"limit\"", "13 #\"limit\"", "27 \"limit\""][..]),
        ("\"t|o\" : Int", "last", &["05 \"last\"", "14 #\"last\"", "15 last", "27 \"last\""]),
        // In quotes alone, `to` of line 15 would be a name of the whole program.
        ("\"t|o\" : Int", "last one", &["05 \"last one\"", "14 #\"last one\"", "15 #\"last one\"", "27 \"last one\""]),
        ("\"no|t\" : Bool", "off", &["06 \"off\"", "13 #\"off\"", "27 \"off\""]),
    ] {
        let edits = edits.iter().map(|edit| format!("words.scl:{edit}")).collect();
        assert_eq!(rename(&mut editor, "words.scl", piece, to), Ok(edits));
    }
}

/// Of operands and parameters with the name of a label only those of jumps are the label.
#[test]
fn labels_and_variables_of_one_name_are_told_apart() {
    let mut editor = Editor::new("words");
    editor.open("jumps.stl");
    assert_eq!(editor.messages("jumps.stl"), Vec::<String>::new());
    for (piece, to, edits) in [
        ("mo|re : INT", "rest", &["03 rest", "07 rest", "11 rest", "20 rest"][..]),
        ("JC    mo|re", "end", &["10 end", "13 end"]),
        ("JU    mo|re", "end", &["19 end", "20 end"]),
    ] {
        let edits = edits.iter().map(|edit| format!("jumps.stl:{edit}")).collect();
        assert_eq!(rename(&mut editor, "jumps.stl", piece, to), Ok(edits), "{piece}");
    }
    editor.open("lamps.s7dcl");
    for (piece, to, edits) in
        [("of|f : Bool", "low", &["03 low", "07 #low"][..]), ("JumpCoil( of|f", "low", &["07 low", "11 low"])]
    {
        let edits = edits.iter().map(|edit| format!("lamps.s7dcl:{edit}")).collect();
        assert_eq!(rename(&mut editor, "lamps.s7dcl", piece, to), Ok(edits), "{piece}");
    }
}
