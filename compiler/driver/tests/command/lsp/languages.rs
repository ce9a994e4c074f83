//! What the server knows of names in SCL, in charts, in networks, and in programs of an S7-200.

use serde_json::{Value, json};

use super::{Editor, labels, places};

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
    let mut rename = |piece: &str, to: &str| editor.rename("press.scl", piece, to).map(|edits| edits.len());
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

/// Also those that no call names yet.
#[test]
fn functions_of_the_library_and_conversions_of_texts_are_proposed() {
    let mut editor = Editor::new("words");
    editor.open("words.scl");
    assert_eq!(editor.messages("words.scl"), Vec::<String>::new());
    let found = editor.at("textDocument/completion", "words.scl", "#sum := |#sum + to");
    for word in ["LEN", "T_COMBINE", "RD_SYS_T", "INT_TO_STRING", "STRING_TO_UINT", "WSTRING_TO_REAL", "DTL_TO_DATE"] {
        assert_eq!(labels(&found).iter().filter(|own| **own == word).count(), 1, "{word} in {found}");
    }
    for word in ["TEXT_FIND", "STRNG_I", "BYTE_TO_STRING", "DTL_TO_INT", "TON"] {
        assert!(!labels(&found).contains(&word), "{word} is in {found}");
    }
    editor.edit("words.scl", "#sum + to;", "#sum + FIND(IN1 := 'a', IN2 := 'b');");
    let found = editor.at("textDocument/hover", "words.scl", "FI|ND(IN1 := 'a'");
    let text = found["contents"]["value"].as_str().unwrap_or_default();
    assert!(text.contains("Position of the first IN2 in IN1") && text.contains("- `IN2` IN STRING[254]"), "{found}");
    let found = editor.at("textDocument/signatureHelp", "words.scl", "FIND(IN1 := '|a'");
    assert_eq!(found["signatures"][0]["label"], json!("FIND(IN1 : STRING[254] IN, IN2 : STRING[254] IN)"));
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
    let found = editor.at("textDocument/completion", "door.gr7", "TO |Opening");
    assert_eq!(labels(&found), ["Closed", "Opening"]);
    let found = editor.at("textDocument/completion", "door.gr7", "S002.X AND |NOT");
    for name in ["Request", "Opening", "Ask"] {
        assert!(labels(&found).contains(&name), "{name} is not in {found}");
    }
    let found = editor.at("textDocument/completion", "door.gr7", "Q4.0   (|R)");
    assert_eq!(labels(&found), Vec::<&str>::new(), "a qualifier stands there");
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
    let refused = editor.rename("main.stl", "CALL  \"SC|ALE\"", "Other").expect_err("it is not ours");
    assert!(refused.contains("library"), "{refused}");
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
    let mut rename = |piece: &str, to: &str| editor.rename("main.awl", piece, to).map(|edits| places(&edits));
    let lines = |names: &[&str]| Ok(names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>());
    assert_eq!(rename("LDW<   #n|ow", "level"), lines(&["main.awl:17", "main.awl:24", "main.awl:26"]));
    assert_eq!(
        rename("R      Pu|mp", "Valve"),
        lines(&["main.awl:8", "main.awl:32", "main.scenario.toml:3", "symbols.txt:3"])
    );
    assert_eq!(rename("CALL   Fi|ll", "Top_up"), lines(&["main.awl:8", "main.awl:14"]));
    assert!(rename("R      Pu|mp", "Level").expect_err("it is taken").contains("already"));
    assert!(rename("R      Pu|mp", "VW8").expect_err("it is an address").contains("address"));
    assert!(rename("LBL    |3", "x").is_err());
    let found = editor.at("textDocument/completion", "main.awl", "MOVW   #|now");
    assert_eq!(labels(&found), ["now", "open", "Water", "Level", "Pump", "MAIN", "Fill", "Stopped"]);
    let found = editor.at("textDocument/completion", "main.awl", "JMP    |3");
    assert_eq!(labels(&found), ["3"]);
    let found = editor.at("textDocument/completion", "main.awl", "|MOVW   #now");
    assert!(labels(&found).contains(&"MOVW"));
    for (piece, active) in [("CALL   Fill, Le|vel", 0), ("CALL   Fill, Level, |Pump", 1)] {
        let found = editor.at("textDocument/signatureHelp", "main.awl", piece);
        assert_eq!(found["signatures"][0]["label"], json!("Fill, now : INT IN, open : BOOL OUT"), "{found}");
        assert_eq!(found["activeParameter"], json!(active), "{piece}");
    }
    let found = editor.at("textDocument/signatureHelp", "main.awl", "MOVW   #now, |VW102");
    assert_eq!(found, Value::Null);
}

/// `Start:I0.0`: Micro/WIN shows a symbol and its address.
#[test]
fn symbols_before_their_addresses_are_renamed() {
    let mut editor = Editor::new("shown");
    editor.open("main.awl");
    assert_eq!(editor.messages("main.awl"), Vec::<String>::new());
    let mut rename = |piece: &str, to: &str| editor.rename("main.awl", piece, to).map(|edits| places(&edits));
    let lines = |names: &[&str]| Ok(names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>());
    assert_eq!(rename("LD     St|art:I0.0", "Go"), lines(&["main.awl:5", "main.awl:8", "symbols.txt:1"]));
    assert_eq!(rename("CALL   Bl|ink:SBR0", "Flash"), lines(&["main.awl:9", "main.awl:11"]));
    assert_eq!(rename("=      #li|ght:L0.0", "lamp"), lines(&["main.awl:13", "main.awl:18"]));
    assert!(rename("LD     Start:I|0.0", "Go").expect_err("an address").contains("address"));
}

#[test]
fn subroutines_of_libraries_of_micro_win_show_their_parameters() {
    let mut editor = Editor::new("modbus");
    editor.open("main.awl");
    editor.messages("main.awl");
    for (piece, active) in [("CALL   MBUS_SLAVE, |M1.1", 0), ("CALL   MBUS_SLAVE, M1.1, |MB6", 1)] {
        let found = editor.at("textDocument/signatureHelp", "main.awl", piece);
        assert_eq!(found["signatures"][0]["label"], json!("MBUS_SLAVE, Done OUT, Error OUT"), "{found}");
        assert_eq!(found["activeParameter"], json!(active), "{piece}");
    }
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
    let found = editor.at("textDocument/completion", "lamp.s7dcl", "TON( |pt := #time");
    assert_eq!(labels(&found), ["en", "pt", "et", "eno"]);
    let found = editor.at("textDocument/completion", "lamp.s7dcl", "Contact( |#on");
    assert_eq!(labels(&found)[..4], ["#on", "#time", "#lit", "#T1"]);
    let found = editor.at("textDocument/completion", "lamp.s7dcl", "#one( |on :=");
    assert_eq!(labels(&found), ["on", "time", "lit"]);
    for (piece, label, active) in
        [("TON( pt := |#time", "TON(en, pt, et OUT, eno OUT)", 1), ("A( in2 := |#a", "A(in1 …)", 0)]
    {
        let found = editor.at("textDocument/signatureHelp", "lamp.s7dcl", piece);
        assert_eq!(found["signatures"][0]["label"], json!(label), "{piece}");
        assert_eq!(found["activeParameter"], json!(active), "{piece}");
    }
    let found = editor.at("textDocument/completion", "lamp.s7dcl", "TON( pt := |#time");
    assert_eq!(labels(&found)[..4], ["#on", "#time", "#lit", "#T1"]);
    assert!(!labels(&found).contains(&"Contact"), "{found}");
}

#[test]
fn outlines_have_the_networks_of_all_languages() {
    for (folder, file, block, parts) in [
        ("wash", "main.awl", "MAIN OB1", &["Network 1", "Network 2"][..]),
        ("wash", "main.awl", "Fill SBR0", &["now", "open", "Network 1"]),
        ("alike", "lamp.s7dcl", "Lamp", &["on", "time", "lit", "T1", "Network 1"]),
        ("plant", "main.stl", "FC 1", &["level", "limit", "rest", "Network 1"]),
    ] {
        let mut editor = Editor::new(folder);
        editor.open(file);
        editor.messages(file);
        let document = json!({ "textDocument": { "uri": editor.uri(file) } });
        let symbols = editor.ask("textDocument/documentSymbol", document);
        let found = symbols.as_array().and_then(|blocks| blocks.iter().find(|one| one["name"] == block));
        let children = found.and_then(|block| block["children"].as_array()).unwrap_or_else(|| panic!("{symbols}"));
        let names: Vec<&str> = children.iter().filter_map(|one| one["name"].as_str()).collect();
        assert_eq!(names, parts, "{block}");
    }
}

/// Of types that only the library knows, also those that have another name than their block.
#[test]
fn values_and_parameters_of_timers_are_known() {
    let mut editor = Editor::new("tags");
    editor.open("main.scl");
    editor.messages("main.scl");
    let found = editor.at("textDocument/completion", "main.scl", ":= #t.|Q");
    for name in ["IN", "PT", "Q", "ET"] {
        assert!(labels(&found).contains(&name), "{name} is not in {found}");
    }
    assert!(!labels(&found).contains(&"R"), "only a TONR has it: {found}");
    let found = editor.at("textDocument/hover", "main.scl", ":= #t.|Q");
    assert!(found["contents"]["value"].as_str().is_some_and(|text| text.contains("Q : BOOL")), "{found}");
    for piece in ["#t(IN := TRUE, P|T", "#t.TON(IN := #done, P|T"] {
        let found = editor.at("textDocument/signatureHelp", "main.scl", piece);
        let label = "TON(IN : BOOL IN, PT : TIME IN, Q : BOOL OUT, ET : TIME OUT)";
        assert_eq!(found["signatures"][0]["label"], json!(label), "{piece}");
    }
    let found = editor.at("textDocument/completion", "main.scl", "#t(IN := TRUE, |PT");
    assert!(labels(&found).contains(&"ET") && !labels(&found).contains(&"IN"), "{found}");
}

/// Also beside a variable with the name of the function.
#[test]
fn functions_of_scl_are_known() {
    let mut editor = Editor::new("alike");
    editor.open("line.scl");
    editor.messages("line.scl");
    let found = editor.at("textDocument/hover", "line.scl", "LI|MIT(MN := 0");
    assert_eq!(found["contents"]["value"], json!("```plc\nLIMIT\n```\n- `MN` IN\n- `IN` IN\n- `MX` IN\n\n"));
    let found = editor.at("textDocument/signatureHelp", "line.scl", "LIMIT(MN := 0, IN := |#in");
    assert_eq!(found["signatures"][0]["label"], json!("LIMIT(MN, IN, MX)"), "{found}");
    assert_eq!(found["activeParameter"], json!(1));
    let found = editor.at("textDocument/completion", "line.scl", "#limit := |LIMIT(MN");
    for name in ["LIMIT", "SIN", "SCALE_X", "LINT_TO_INT", "limit"] {
        assert!(labels(&found).contains(&name), "{name} is not in {found}");
    }
    let found = editor.at("textDocument/completion", "line.scl", "IN := #in, |MX := 9");
    assert!(labels(&found).contains(&"MX") && !labels(&found).contains(&"MN"), "{found}");
    let mut editor = Editor::new("tags");
    editor.open("main.scl");
    editor.messages("main.scl");
    for (piece, label) in
        [("DINT_TO_INT(#wide), IN3 := |3", "MAX(IN1 …)"), ("DINT_TO_INT(|#wide", "DINT_TO_INT(IN : DINT IN)")]
    {
        let found = editor.at("textDocument/signatureHelp", "main.scl", piece);
        assert_eq!(found["signatures"][0]["label"], json!(label), "{found}");
        assert_eq!(found["activeParameter"], json!(0), "{piece}");
    }
    let found = editor.at("textDocument/completion", "main.scl", "MAX(IN1 := #level, |IN2");
    assert!(labels(&found).contains(&"IN2") && !labels(&found).contains(&"IN1"), "{found}");
}

/// STL and networks name the value of a function RET_VAL; in SCL it is the call.
#[test]
fn the_value_of_a_function_is_a_parameter_outside_of_scl() {
    let mut editor = Editor::new("alike");
    ["list.stl", "line.scl"].iter().for_each(|file| editor.open(file));
    editor.messages("line.scl");
    let found = editor.at("textDocument/hover", "line.scl", "\"Tw|ice\"(x");
    assert!(
        found["contents"]["value"].as_str().is_some_and(|text| text.contains("FUNCTION Twice : \"Pair\"")),
        "{found}"
    );
    let found = editor.at("textDocument/signatureHelp", "line.scl", "\"Twice\"(x := |#limit");
    assert_eq!(found["signatures"][0]["label"], json!("Twice(x : Int IN)"));
    editor.edit("list.stl", "      T     #result;", "      CALL  \"Twice\" (x := 1,\n            );");
    let found = editor.at("textDocument/completion", "list.stl", "(x := 1,|\n");
    assert_eq!(labels(&found), ["RET_VAL"]);
    assert_eq!(found[0]["insertText"], json!("RET_VAL := "), "{found}");
    let found = editor.at("textDocument/signatureHelp", "list.stl", "(x := |1,");
    assert_eq!(found["signatures"][0]["label"], json!("Twice(x : Int IN, RET_VAL : \"Pair\" OUT)"));
}

/// A block that only has a number has no name for quotes.
#[test]
fn names_in_quotes_are_those_of_the_program() {
    let mut editor = Editor::new("plant");
    editor.open("main.stl");
    editor.messages("main.stl");
    let found = editor.at("textDocument/completion", "main.stl", "start := \"|Start\"");
    let found = labels(&found);
    assert!(found.contains(&"Start") && found.contains(&"Motor"), "{found:?}");
    assert!(!found.contains(&"FC 1") && !found.contains(&"DB 10"), "{found:?}");
}

#[test]
fn wires_of_a_network_are_proposed() {
    let mut editor = Editor::new("alike");
    editor.open("lamp.s7dcl");
    editor.messages("lamp.s7dcl");
    let rung = "Coil( #lit )  END_RUNG\n        RUNG wire#powerrail  Contact( #on )  END_RUNG wire#";
    editor.edit("lamp.s7dcl", "Coil( #lit )  END_RUNG", rung);
    for piece in ["END_RUNG wire#|\n", "Contact( #on )  wire#|lit"] {
        let found = editor.at("textDocument/completion", "lamp.s7dcl", piece);
        let wanted = if piece.ends_with('\n') { &["powerrail", "lit"][..] } else { &["powerrail"] };
        assert_eq!(labels(&found), wanted, "{piece}");
    }
}

#[test]
fn types_are_proposed_in_declarations() {
    for (folder, file, piece, wanted, other) in [
        ("press", "press.scl", "  force : |Int", &["INT", "LREAL", "ARRAY"][..], "IF"),
        ("press", "press.scl", "Array[0..LIMIT] of |Int", &["INT"], "IF"),
        ("press", "press.scl", "FUNCTION \"Count\" : |Int", &["INT"], "IF"),
        ("press", "press.scl", "  again:|\n", &["IF"], "INT"),
        ("alike", "line.scl", "  in : |Int", &["\"Pair\"", "\"Line\""], "IF"),
        ("alike", "lamp.s7dcl", "  time : |Time", &["TIME"], "Coil"),
        ("plant", "main.stl", "  limit : |INT", &["DINT", "\"Motor\""], "LREAL"),
        ("plant", "main.stl", "full:| NOP", &["NOP"], "DINT"),
    ] {
        let mut editor = Editor::new(folder);
        editor.open(file);
        editor.messages(file);
        let found = editor.at("textDocument/completion", file, piece);
        for word in wanted {
            assert!(labels(&found).contains(word), "{piece}: {word} is not in {found}");
        }
        assert!(!labels(&found).contains(&other), "{piece}: {other}");
    }
}
