//! `plcc view` as a command: the page of a program.

mod charts;
mod statements;

use std::fs;
use std::process::Command;

use crate::{PLCC, plcc};

#[test]
fn a_page_names_all_languages_of_a_block() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let network = |language: &str, rung: &str| {
        format!("{{ S7_Language := \"{language}\" }}\nNETWORK\n  RUNG {rung} Coil( #q ) END_RUNG\nEND_NETWORK\n")
    };
    let head =
        "FUNCTION Both : Void\n  VAR_INPUT\n    a, b : Bool;\n  END_VAR\n  VAR_OUTPUT\n    q : Bool;\n  END_VAR\n";
    let lad = network("LAD", "wire#powerrail Contact( #a )");
    let fbd = network("FBD", "#a A( in2 := #b )");
    for (networks, language) in [(format!("{lad}{fbd}"), "LAD, FBD"), (lad.clone(), "LAD"), (fbd.clone(), "FBD")] {
        fs::write(folder.join("both.s7dcl"), format!("{head}{networks}END_FUNCTION\n"))
            .expect("the folder can be written");
        let arguments = ["view", "both.s7dcl", "--html", "both.html"];
        let output = plcc(folder, &arguments);
        let page = fs::read_to_string(folder.join("both.html")).expect("it is written");
        let messages = String::from_utf8_lossy(&output.stderr);
        assert!(page.contains(&format!("\"lang\":\"{language}\"")), "{language}: {messages}");
    }
}

#[test]
fn a_calculation_shows_its_formula() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION Work : Void\n  VAR_INPUT\n    a : Real;\n    list : Array[0..9] of Real;\n    i : Int;\n  END_VAR\n\
                  { S7_Language := \"LAD\" }\nNETWORK\n  RUNG wire#powerrail { S7_Templates := \"SrcType := Real\"; \
                  S7_Expression := \"(IN1 + IN2) * IN3\" } Calculate( in1 := #a, in2 := #list[#i + 1], in3 := 2.0, \
                  out => %MD20 ) END_RUNG\nEND_NETWORK\nEND_FUNCTION\n";
    fs::write(folder.join("work.s7dcl"), source).expect("the folder can be written");
    let output = plcc(folder, &["view", "work.s7dcl", "-o", "drawings"]);
    let picture = fs::read_to_string(folder.join("drawings/FC_1_network_1.svg"));
    let picture = picture.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    for text in [">Real<", ">OUT := (IN1 + IN2) * IN3<", ">#list[#i + 1]<"] {
        assert!(picture.contains(text), "{text} in {picture}");
    }
}

/// Its variables have no address of their own, since each instance has others.
#[test]
fn a_block_with_an_instance_inside_of_another_has_several() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION_BLOCK \"Inner\"\nVAR_INPUT\n  go : Bool;\nEND_VAR\nVAR\n  count : Int;\nEND_VAR\nBEGIN\n  IF #go THEN\n    \
                  #count := #count + 1;\n  END_IF;\nEND_FUNCTION_BLOCK\nFUNCTION_BLOCK \"Outer\"\nVAR\n  list : Array[0..1] of \"Inner\";\n\
                  END_VAR\nBEGIN\n  #list[0](go := TRUE);\nEND_FUNCTION_BLOCK\nDATA_BLOCK \"Outer_DB\" \"Outer\"\nBEGIN\nEND_DATA_BLOCK\n\
                  DATA_BLOCK \"Inner_DB\" \"Inner\"\nBEGIN\nEND_DATA_BLOCK\nORGANIZATION_BLOCK \"Main\"\nBEGIN\n  \"Outer_DB\"();\n  \
                  \"Inner_DB\"(go := TRUE);\nEND_ORGANIZATION_BLOCK\n";
    fs::write(folder.join("twice.scl"), source).expect("the folder can be written");
    let output = plcc(folder, &["view", "twice.scl", "--cpu", "s7-1500", "--html", "twice.html"]);
    let page = fs::read_to_string(folder.join("twice.html"));
    let page = page.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    // Where it is used: the page adds these to the addresses of both instances.
    assert!(page.contains("\"FB 1#count\":[[") && page.contains("\"FB 1#go\":[["), "{page}");
    assert!(!page.contains("\"DB2.DBX0.0\":[["), "{page}");
}

/// Timers and counters of the S7-300/400: a box shows all pins, those without an operand too; with nothing but its time a timer is a coil.
#[test]
fn a_box_of_a_timer_has_all_pins_and_a_coil_is_a_coil() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let rungs = [
        "S_ODT( timer := %T1, tv := %MW2 ) Coil( %M10.0 )",
        "S_Cu( counter := %C1, r := %M0.1, cv => %MW20 )",
        "SF_Coil( timer => %T2, pt := %MW4 )",
    ];
    let network = |rung: &str| {
        format!(
            "{{ S7_Language := \"LAD\" }}\nNETWORK\n  RUNG wire#powerrail Contact( %M0.0 ) {rung} END_RUNG\nEND_NETWORK\n"
        )
    };
    let networks: String = rungs.map(network).concat();
    fs::write(folder.join("cells.s7dcl"), format!("FUNCTION Cells : Void\n{networks}END_FUNCTION\n"))
        .expect("the folder can be written");
    let arguments = ["view", "cells.s7dcl", "--cpu", "s7-1500", "-o", "drawings"];
    let output = Command::new(PLCC).current_dir(folder).args(arguments).output().expect("plcc starts");
    let shown = |number: usize| {
        let picture = fs::read_to_string(folder.join(format!("drawings/FC_1_network_{number}.svg")));
        let picture = picture.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
        let texts = picture.split("</text>").filter_map(|text| text.rsplit('>').next().map(str::to_owned));
        texts.filter(|text| !text.trim().is_empty()).collect::<Vec<String>>()
    };
    for (number, pins) in
        [(1, &["S", "Q", "TV", "BI", "R", "BCD"][..]), (2, &["CU", "Q", "S", "CV", "PV", "CV_BCD", "R"])]
    {
        let shown = shown(number);
        let own: Vec<&str> = shown.iter().map(String::as_str).filter(|text| pins.contains(text)).collect();
        assert_eq!(own, pins, "{shown:?}");
    }
    assert_eq!(shown(3), ["M0.0", "SF", "T2", "MW4"]);
}

/// In the column of the last coil, the wire to MOVE would cross the others.
#[test]
fn a_last_box_of_fbd_is_where_its_wire_branches() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION Branch : Void\n  VAR_INPUT\n    a, b, c : Bool;\n    x : Int;\n  END_VAR\n  VAR_OUTPUT\n    q, last : Bool;\n    \
                  n : Int;\n  END_VAR\n  { S7_Language := \"FBD\" }\n  NETWORK\n    RUNG #a A( in2 := #b ) wire#w1 Coil( #q ) END_RUNG\n    \
                  RUNG wire#w1 Move( in := #x, out1 => #n ) END_RUNG\n    RUNG wire#w1 O( in2 := #c ) Coil( #last ) END_RUNG\n  \
                  END_NETWORK\nEND_FUNCTION\n";
    fs::write(folder.join("branch.s7dcl"), source).expect("the folder can be written");
    let output = plcc(folder, &["view", "branch.s7dcl", "--cpu", "s7-1500", "-o", "drawings"]);
    let picture = fs::read_to_string(folder.join("drawings/FC_1_network_1.svg"));
    let picture = picture.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    let place = |text: &str| {
        let line = picture.lines().find(|line| line.contains(&format!(">{text}</text>")));
        let line = line.unwrap_or_else(|| panic!("{text} in {picture}"));
        let x = line.split(" x=\"").nth(1).and_then(|rest| rest.split('"').next());
        x.and_then(|x| x.parse::<i32>().ok()).expect("a text has a place")
    };
    assert!(place("MOVE") < place("#last"), "{picture}");
}

#[test]
fn assignments_of_fbd_have_the_signs_of_the_editor() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let coils = "Coil( %Q0.0 ) I_Coil( %Q0.1 ) P_Coil( operand => %Q0.2, bit := %M0.0 ) N_Coil( operand => %Q0.3, bit := %M0.1 )";
    let network = |language: &str, rung: &str| {
        format!("{{ S7_Language := \"{language}\" }}\nNETWORK\n  RUNG {rung} {coils} END_RUNG\nEND_NETWORK\n")
    };
    let (fbd, lad) = (network("FBD", "%I0.0 A( in2 := %I0.1 )"), network("LAD", "wire#powerrail Contact( %I0.0 )"));
    fs::write(folder.join("signs.s7dcl"), format!("FUNCTION Signs : Void\n{fbd}{lad}END_FUNCTION\n"))
        .expect("the folder can be written");
    let output = plcc(folder, &["view", "signs.s7dcl", "--cpu", "s7-1500", "-o", "drawings"]);
    for (number, signs, others) in
        [(1, [">=<", ">/=<", ">P=<", ">N=<"], ">P<"), (2, [">P<", ">N<", ">Q0.0<", ">Q0.1<"], "P=<")]
    {
        let picture = fs::read_to_string(folder.join(format!("drawings/FC_1_network_{number}.svg")));
        let picture = picture.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
        assert!(signs.iter().all(|sign| picture.contains(sign)) && !picture.contains(others), "{picture}");
    }
}

#[test]
fn pins_have_the_names_of_the_editors() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION Count : Void\n  VAR_IN_OUT\n    n : Int;\n  END_VAR\n{ S7_Language := \"LAD\" }\nNETWORK\n  \
                  RUNG wire#powerrail { S7_Templates := \"SrcType := Int\" } InRange( min := 0, in := #n, max := 9 ) \
                  { S7_Templates := \"SrcType := Int\" } Inc( operand := #n ) END_RUNG\nEND_NETWORK\nEND_FUNCTION\n";
    fs::write(folder.join("count.s7dcl"), source).expect("the folder can be written");
    let arguments = ["view", "count.s7dcl", "--cpu", "s7-1500", "-o", "drawings"];
    let output = Command::new(PLCC).current_dir(folder).args(arguments).output().expect("plcc starts");
    let picture = fs::read_to_string(folder.join("drawings/FC_1_network_1.svg"));
    let picture = picture.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    for (name, is_shown) in [("MIN", true), ("VAL", true), ("IN/OUT", true), ("PRE", false), ("OUT", false)] {
        assert_eq!(picture.contains(&format!(">{name}<")), is_shown, "{name} in {picture}");
    }
}

#[test]
fn durations_and_dates_have_their_units() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION_BLOCK Times\n  VAR\n    day : Date;\n    long : LTime;\n    clock : Time_Of_Day;\n    t : TON_TIME;\n    \
                  q : Bool;\n  END_VAR\n{ S7_Language := \"LAD\" }\nNETWORK\n  RUNG wire#powerrail \
                  { S7_Templates := \"SrcType := Date\" } GT_Contact( in1 := #day, in2 := D#2024-02-29 ) \
                  { S7_Templates := \"SrcType := LTime\" } LT_Contact( in1 := #long, in2 := LT#1s500us ) \
                  { S7_Templates := \"SrcType := Time_Of_Day\" } EQ_Contact( in1 := #clock, in2 := TOD#12:30:00 ) \
                  #t.TON( pt := T#1h2m3s, et => ) Coil( #q ) END_RUNG\nEND_NETWORK\nEND_FUNCTION_BLOCK\n";
    fs::write(folder.join("times.s7dcl"), source).expect("the folder can be written");
    let arguments = ["view", "times.s7dcl", "--cpu", "s7-1500", "-o", "drawings"];
    let output = Command::new(PLCC).current_dir(folder).args(arguments).output().expect("plcc starts");
    let picture = fs::read_to_string(folder.join("drawings/FB_1_network_1.svg"));
    let picture = picture.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    for text in [">D#2024-02-29<", ">LT#1s500us<", ">TOD#12:30:00<", ">T#1h2m3s<"] {
        assert!(picture.contains(text), "{text} in {picture}");
    }
}

#[test]
fn constants_are_drawn_as_their_author_wrote_them() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION_BLOCK Fill\n  VAR\n    r : Real;\n    t : Time;\n    w : Word;\n    n : DInt;\n  END_VAR\n\
                  { S7_Language := \"LAD\" }\nNETWORK\n  RUNG wire#powerrail Move( in := 1.0E+6, out1 => #r ) \
                  Move( in := T#90s, out1 => #t ) Move( in := 2#1010_0000, out1 => #w ) Move( in := -1_000, out1 => #n ) \
                  END_RUNG\nEND_NETWORK\n{ S7_Language := \"LAD\" }\nNETWORK\n  RUNG wire#powerrail \
                  { S7_Templates := \"SrcType := Real\"; S7_Expression := \"IN1 * 2.50\" } Calculate( in1 := #r, out => #r ) \
                  END_RUNG\nEND_NETWORK\nEND_FUNCTION_BLOCK\n";
    fs::write(folder.join("fill.s7dcl"), source).expect("the folder can be written");
    let chart = "FUNCTION_BLOCK FB 2\nINITIAL_STEP Run (*$_NUM 1*):\nMW20 := 16#00FF   (N)\nQ0.0 := T#90S   (D)\nEND_STEP\nTRANSITION T_1 (*$_NUM 1*)\n  \
                 FROM Run\n  TO Run (*$_JUMP*)\nCONDITION := MW22 > 1_000\nEND_TRANSITION\nEND_FUNCTION_BLOCK\n";
    fs::write(folder.join("run.gr7"), chart).expect("the folder can be written");
    let pictures: [(&str, &str, &str, &[&str]); 3] = [
        ("fill.s7dcl", "s7-1500", "FB_1_network_1", &["1.0E+6", "T#90s", "2#1010_0000", "-1_000"]),
        ("fill.s7dcl", "s7-1500", "FB_1_network_2", &["OUT := IN1 * 2.50"]),
        ("run.gr7", "315-2DP", "FB_2", &["MW20 := 16#00FF", "Q0.0, T#90S", "1_000"]),
    ];
    for (source, cpu, name, texts) in pictures {
        let output = plcc(folder, &["view", source, "--cpu", cpu, "-o", "drawings"]);
        let picture = fs::read_to_string(folder.join(format!("drawings/{name}.svg")));
        let picture = picture.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
        for text in texts {
            assert!(picture.contains(&format!(">{text}<")), "{text} in {picture}");
        }
    }
}

#[test]
fn columns_of_a_trace_are_found_by_names_with_any_letters() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).expect("the folder can be written");
    write("main.stl", "A \"Start (left)\"\nA \"Pump in use\"\n= \"Pump\"\n");
    let symbols = [("Start (left)", "I 0.0"), ("Pump", "Q 0.0"), ("Pump in use", "M 0.0")];
    let symbols = symbols.map(|(name, address)| format!("\"{name}\",\"{address}\",\"BOOL\",\"\"\n"));
    write("symbols.sdf", &symbols.concat());
    write("trace.csv", "cycle,time_ms,Start (left),Pump,Pump in use,MD20 as REAL in l\n0,0,1,0,1,2.5\n");
    let arguments = ["view", "main.stl", "symbols.sdf", "--html", "page.html", "--state", "trace.csv"];
    let output = plcc(folder, &arguments);
    let page = fs::read_to_string(folder.join("page.html"));
    let page = page.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    let columns = r#"[["Start (left)","I0.0"],["Pump","Q0.0"],["Pump in use","M0.0"],["MD20","MD20"]]"#;
    assert!(page.contains(&format!("\"columns\":{columns}")), "{page}");
    assert!(page.contains(r#""units":["","","","l"]"#), "{page}");
}

#[test]
fn elements_of_arrays_have_their_addresses() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).expect("the folder can be written");
    write(
        "main.awl",
        "DATA_BLOCK DB 1\nSTRUCT\n  a : ARRAY [1..3] OF INT;\n  b : ARRAY [0..9] OF BOOL;\nEND_STRUCT;\nBEGIN\n\
         END_DATA_BLOCK\nORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\n  A DB1.b[9];\n  = Q 0.0;\nEND_ORGANIZATION_BLOCK\n",
    );
    write("trace.csv", "cycle,time_ms,DB1.a[2],DB1.b[9],DB1.a[4]\n0,0,1,1,0\n");
    let output = plcc(folder, &["view", "main.awl", "--html", "page.html", "--state", "trace.csv"]);
    let page = fs::read_to_string(folder.join("page.html"));
    let page = page.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    let columns = r#"[["DB1.a[2]","DB1.DBW2"],["DB1.b[9]","DB1.DBX7.1"],["DB1.a[4]","DB1.a[4]"]]"#;
    assert!(page.contains(&format!("\"columns\":{columns}")), "{page}");
}

#[test]
fn components_of_a_data_block_have_initial_values_and_comments() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "DATA_BLOCK DB 10\nSTRUCT\n  speed : REAL := 1.5; // set point\n  s : STRUCT\n    n : INT := 3;\n  \
                  END_STRUCT;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n";
    fs::write(folder.join("data.awl"), source).expect("the folder can be written");
    let output = plcc(folder, &["view", "data.awl", "--html", "page.html"]);
    let page = fs::read_to_string(folder.join("page.html"));
    let page = page.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    let speed = r#"["","speed","REAL","1.5","set point","DB10.DBD0",0]"#;
    let n = r#"["","n","INT","3","","DB10.DBW4",1]"#;
    for row in [speed, n] {
        assert!(page.contains(row), "{row} in {page}");
    }
}

/// Those that its function block or data type declares, unless the data block has another value.
#[test]
fn an_instance_has_the_initial_values_and_comments_of_its_block() {
    let source = "FUNCTION_BLOCK \"Motor\"\nVAR_INPUT\n  speed : INT := 50;\nEND_VAR\nVAR\n  count : INT := 7; // how often\n  \
                  s : STRUCT\n    a : INT := 3;\n  END_STRUCT;\n  u : \"Limits\";\nEND_VAR\nBEGIN\nEND_FUNCTION_BLOCK\n\
                  DATA_BLOCK \"Motor_DB\" \"Motor\"\nBEGIN\n  speed := 60;\nEND_DATA_BLOCK\n\
                  DATA_BLOCK \"Limits_DB\" \"Limits\"\nBEGIN\nEND_DATA_BLOCK\n";
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    fs::write(folder.join("motor.scl"), source).expect("the folder can be written");
    let limits = "TYPE \"Limits\"\nSTRUCT\n  high : INT := 4;\nEND_STRUCT;\nEND_TYPE\n";
    fs::write(folder.join("limits.udt"), limits).expect("the folder can be written");
    let output = plcc(folder, &["view", "motor.scl", "limits.udt", "--cpu", "s7-1500", "--html", "page.html"]);
    let page = fs::read_to_string(folder.join("page.html"));
    let page = page.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    for row in [
        r#"["","speed","INT","60","","DB1.DBW0",0]"#,
        r#"["","count","INT","7","how often","DB1.DBW2",0]"#,
        r#"["","a","INT","3","","DB1.DBW4",1]"#,
        r#"["","high","INT","4","","DB1.DBW6",1]"#,
        r#"["","high","INT","4","","DB2.DBW0",0]"#,
    ] {
        assert!(page.contains(row), "{row} in {page}");
    }
}

#[test]
fn a_page_of_a_data_block_has_its_values_and_comments() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "DATA_BLOCK DB 10\nSTRUCT\n  count : INT := 5; // Number of parts\n  limit : INT := 6;\n  list : ARRAY [1..3] OF STRUCT\n    \
                  weight : REAL := 1.5;\n  END_STRUCT;\nEND_STRUCT\nBEGIN\n  limit := 7;\n  list[2].weight := 2.5;\nEND_DATA_BLOCK\n";
    fs::write(folder.join("data.awl"), source).expect("the folder can be written");
    let output = plcc(folder, &["view", "data.awl", "--cpu", "315-2DP", "--html", "data.html"]);
    let page = fs::read_to_string(folder.join("data.html"));
    let page = page.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    for row in [
        r#"["","count","INT","5","Number of parts","DB10.DBW0",0]"#,
        r#"["","limit","INT","7","","DB10.DBW2",0]"#,
        r#"["","list","ARRAY[1..3] OF STRUCT","","","DB10.DBB4",0]"#,
        r#"["","weight","REAL","1.5","","",1]"#,
        r#""comment":"list[2].weight := 2.5""#,
    ] {
        assert!(page.contains(row), "{row} in {page}");
    }
}

/// A project in PLCopen XML has types as elements.
#[test]
fn a_page_of_a_project_has_the_names_of_types() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION_BLOCK \"Fill\"\nVAR_INPUT\n  level : Real;\nEND_VAR\nVAR\n  list : Array[1..3] of Int;\nEND_VAR\nBEGIN\n  \
                  #list[1] := REAL_TO_INT(#level);\nEND_FUNCTION_BLOCK\n";
    fs::write(folder.join("fill.scl"), source).expect("the folder can be written");
    for arguments in [
        &["convert", "fill.scl", "--to", "plcopen", "--cpu", "s7-1500", "-o", "fill.xml"][..],
        &["view", "fill.xml", "--cpu", "s7-1500", "--html", "fill.html"],
    ] {
        let output = plcc(folder, arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let page = fs::read_to_string(folder.join("fill.html")).expect("it is written");
    for row in [r#"["Input","level","REAL""#, r#"["Static","list","ARRAY[1..3] OF INT""#] {
        assert!(page.contains(row), "{row} in {page}");
    }
}

#[test]
fn no_page_is_written_of_what_could_not_be_read() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    for project in ["a", "b"] {
        fs::create_dir(folder.join(project)).expect("the folder can be written");
        fs::write(folder.join(project).join("plc.toml"), "cpu = \"1214C\"\n").expect("the folder can be written");
    }
    for (input, code) in [("missing.scl", 2), (".", 3)] {
        let arguments = ["view", input, "--html", "page.html", "-o", "drawings"];
        let output = plcc(folder, &arguments);
        assert_eq!(output.status.code(), Some(code), "{}", String::from_utf8_lossy(&output.stderr));
        assert_eq!(String::from_utf8_lossy(&output.stdout), "", "{input}");
        assert!(!folder.join("page.html").exists() && !folder.join("drawings").exists(), "{input}");
    }
}

/// A branch with contacts is not above coils that the CPU writes before it.
#[test]
fn branches_are_in_the_order_of_their_execution() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION Branches : Void\n  VAR_INPUT\n    a, b : Bool;\n  END_VAR\n  VAR_IN_OUT\n    q, r : Bool;\n  \
                  END_VAR\n  { S7_Language := \"LAD\" }\n  NETWORK\n    \
                  RUNG wire#powerrail Contact( #a ) wire#w1 S_Coil( #q ) END_RUNG\n    \
                  RUNG wire#w1 Contact( #b ) R_Coil( #q ) END_RUNG\n    RUNG wire#w1 Coil( #r ) END_RUNG\n  \
                  END_NETWORK\nEND_FUNCTION\n";
    fs::write(folder.join("branches.s7dcl"), source).expect("the folder can be written");
    let arguments = ["view", "branches.s7dcl", "-o", "drawings"];
    let output = Command::new(PLCC).current_dir(folder).args(arguments).output().expect("plcc starts");
    let picture = fs::read_to_string(folder.join("drawings/FC_1_network_1.svg"));
    let picture = picture.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    let places = [">#a<", ">S<", ">#b<", ">R<", ">#r<"].map(|name| picture.find(name));
    assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{picture}");
}

/// In the order of the declaration, whatever the call gives them, but the result of a function before the other outputs.
#[test]
fn a_box_of_a_call_has_all_parameters() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION_BLOCK \"Lamp\"\nVAR_INPUT\n  on : BOOL;\n  test : BOOL;\nEND_VAR\nVAR_OUTPUT\n  lit : BOOL;\n  \
                  broken : BOOL;\nEND_VAR\nBEGIN\nEND_FUNCTION_BLOCK\nDATA_BLOCK \"One\"\n\"Lamp\"\nBEGIN\nEND_DATA_BLOCK\n\
                  FUNCTION FC 6 : INT\nVAR_OUTPUT\n  more : BOOL;\nEND_VAR\nBEGIN\nEND_FUNCTION\n\
                  FUNCTION FC 5 : VOID\nBEGIN\nNETWORK\nCALL \"Lamp\", \"One\" (lit := M 0.1, on := M 0.0);\n\
                  CALL FC 6 (more := M 0.2, RET_VAL := MW 2);\nEND_FUNCTION\n";
    fs::write(folder.join("lamps.stl"), source).expect("the folder can be written");
    let arguments = ["view", "lamps.stl", "--cpu", "s7-1500", "-o", "drawings"];
    let output = Command::new(PLCC).current_dir(folder).args(arguments).output().expect("plcc starts");
    let picture = fs::read_to_string(folder.join("drawings/FC_5_network_1.svg"));
    let picture = picture.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    let places = [">on<", ">lit<", ">test<", ">broken<", ">RET_VAL<", ">more<"].map(|name| picture.find(name));
    assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{picture}");
}

/// In the box as if the instance were a data block.
#[test]
fn a_call_of_an_instance_in_the_block_shows_the_block() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let lamp = "FUNCTION_BLOCK \"Lamp\"\nVAR_INPUT\n  on : BOOL;\nEND_VAR\nVAR_OUTPUT\n  lit : BOOL;\nEND_VAR\nBEGIN\n\
                A #on;\n= #lit;\nEND_FUNCTION_BLOCK\n";
    let list = "FUNCTION_BLOCK \"List\"\nVAR\n  one : \"Lamp\";\nEND_VAR\nBEGIN\nNETWORK\n\
                CALL #one (on := M 0.0, lit := M 0.1);\nEND_FUNCTION_BLOCK\n";
    let drawn = "FUNCTION_BLOCK Drawn\n  VAR\n    lamps : Array[1..2] of Lamp;\n  END_VAR\n  { S7_Language := \"LAD\" }\n  \
                 NETWORK\n    RUNG wire#powerrail #lamps[1]( on := %M0.0, lit => %M0.1 ) END_RUNG\n  END_NETWORK\n\
                 END_FUNCTION_BLOCK\n";
    fs::write(folder.join("lamps.stl"), format!("{lamp}{list}")).expect("the folder can be written");
    fs::write(folder.join("drawn.s7dcl"), drawn).expect("the folder can be written");
    let arguments = ["view", "lamps.stl", "drawn.s7dcl", "--cpu", "s7-1500", "-o", "drawings"];
    let output = plcc(folder, &arguments);
    let pictures = fs::read_dir(folder.join("drawings")).into_iter().flatten().flatten();
    let pictures: String = pictures.map(|file| fs::read_to_string(file.path()).expect("it is a text")).collect();
    assert!(pictures.contains(">#one<"), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(pictures.contains(">#lamps[1]<"), "{pictures}");
    assert_eq!(pictures.matches("text-anchor=\"middle\">&quot;Lamp&quot;<").count(), 2, "{pictures}");
    // The output of the call in STL is at the right.
    assert_eq!(pictures.matches("text-anchor=\"end\">lit<").count(), 2, "{pictures}");
}

/// The operand that is written has no `%` either.
#[test]
fn an_address_in_an_action_of_a_chart_is_drawn_as_elsewhere() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION_BLOCK FB 1\nINITIAL_STEP Run (*$_NUM 1*):\nM11.0 := M11.7   (N)\nM11.1 := NOT M11.6   (N)\n\
                  MW20 := SHL(IN := MW22, N := 1)   (N)\nM11.2 := \"Open M11.6 now\"   (N)\nEND_STEP\nTRANSITION T_1 (*$_NUM 1*)\n  FROM Run\n  \
                  TO Run (*$_JUMP*)\nCONDITION := M0.0\nEND_TRANSITION\nEND_FUNCTION_BLOCK\n";
    fs::write(folder.join("run.gr7"), source).expect("the folder can be written");
    let symbols = "\"Ready\",\"M 11.6\",\"BOOL\",\"\"\n\"Open M11.6 now\",\"M 11.5\",\"BOOL\",\"\"\n";
    fs::write(folder.join("symbols.sdf"), symbols).expect("the folder can be written");
    let arguments = ["view", "run.gr7", "symbols.sdf", "--cpu", "315-2DP", "-o", "drawings"];
    let output = plcc(folder, &arguments);
    let picture = fs::read_to_string(folder.join("drawings/FB_1.svg"));
    let picture = picture.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    for text in [
        ">M11.0 := M11.7<",
        ">M11.1 := NOT &quot;Ready&quot;<",
        ">MW20 := SHL(IN := MW22, N := 1)<",
        ">M11.2 := &quot;Open M11.6 now&quot;<",
    ] {
        assert!(picture.contains(text), "{text} in {picture}");
    }
}

/// Words, timers and counters are the operands that they are elsewhere: they have symbols.
#[test]
fn a_chart_with_german_addresses_is_drawn_with_them() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION_BLOCK FB 1\nINITIAL_STEP Run (*$_NUM 1*):\nA1.0   (N)\nA1.1 := NOT E0.1   (N)\n\
                  AW4 := EW6 + 1   (N)\nEND_STEP\nTRANSITION T_1 (*$_NUM 1*)\n  FROM Run\n  TO Run (*$_JUMP*)\n\
                  CONDITION := E0.0 AND EW8 > 5 AND NOT Z1\nEND_TRANSITION\nEND_FUNCTION_BLOCK\n";
    fs::write(folder.join("run.gr7"), source).expect("the folder can be written");
    let symbols = "\"Level\",\"EW  6\",\"INT\",\"\"\n\"Parts\",\"Z   1\",\"COUNTER\",\"\"\n";
    fs::write(folder.join("symbols.sdf"), symbols).expect("the folder can be written");
    let arguments = ["view", "run.gr7", "symbols.sdf", "--cpu", "315-2DP", "-o", "drawings"];
    let output = plcc(folder, &arguments);
    let picture = fs::read_to_string(folder.join("drawings/FB_1.svg"));
    let picture = picture.unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    for text in
        [">A1.0<", ">A1.1 := NOT E0.1<", ">AW4 := &quot;Level&quot; + 1<", ">E0.0<", ">EW8<", ">&quot;Parts&quot;<"]
    {
        assert!(picture.contains(text), "{text} in {picture}");
    }
}

/// As the editor draws them. A project in XML has only the pins that are connected.
#[test]
fn timers_counters_and_flip_flops_have_all_of_their_outputs() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION_BLOCK Wait\n  VAR\n    t : TON_TIME;\n    c : CTUD_INT;\n  END_VAR\n  { S7_Language := \"LAD\" }\n  \
                  NETWORK\n    RUNG wire#powerrail Contact( %M0.0 ) { S7_Templates := \"time_type := Time\" } \
                  #t.TON( pt := T#2s ) Coil( %M0.1 ) END_RUNG\n  END_NETWORK\n  { S7_Language := \"LAD\" }\n  NETWORK\n    \
                  RUNG wire#powerrail Contact( %M0.2 ) { S7_Templates := \"value_type := Int\" } \
                  #c.CTUD( cd := %M0.3, r := FALSE, ld := FALSE, pv := 5, cv => %MW4 ) END_RUNG\n  END_NETWORK\n  \
                  { S7_Language := \"LAD\" }\n  NETWORK\n    RUNG wire#powerrail Contact( %M0.4 ) \
                  S_SR( operand := %M1.0, r1 := %M0.5 ) END_RUNG\n  END_NETWORK\nEND_FUNCTION_BLOCK\n";
    fs::write(folder.join("wait.s7dcl"), source).expect("the folder can be written");
    let arguments = ["view", "wait.s7dcl", "--cpu", "s7-1500", "-o", "drawings"];
    let output = plcc(folder, &arguments);
    let picture = |number: usize| {
        let path = folder.join(format!("drawings/FB_1_network_{number}.svg"));
        fs::read_to_string(path).unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)))
    };
    // The height of the row of a pin.
    let row = |picture: &str, pin: &str| {
        let line = picture.lines().find(|line| line.contains(&format!(">{pin}</text>")));
        let line = line.unwrap_or_else(|| panic!("{pin} in {picture}"));
        let y = line.split(" y=\"").nth(1).and_then(|rest| rest.split('"').next());
        y.and_then(|y| y.parse::<i32>().ok()).expect("a text has a place")
    };
    let timer = picture(1);
    assert_eq!([row(&timer, "Q"), row(&timer, "ET")], [row(&timer, "IN"), row(&timer, "PT")]);
    let counter = picture(2);
    let outputs = ["QU", "QD", "CV"].map(|pin| row(&counter, pin));
    assert_eq!(outputs, ["CU", "CD", "R"].map(|pin| row(&counter, pin)));
    let flip_flop = picture(3);
    assert_eq!(row(&flip_flop, "Q"), row(&flip_flop, "S"));
}

/// CLK and Q, as the TIA Portal draws the boxes; the bit below has no name.
#[test]
fn boxes_of_edges_name_the_flow() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION_BLOCK Edges\n  VAR\n    old : BOOL;\n    fell : BOOL;\n  END_VAR\n  { S7_Language := \"LAD\" }\n  \
                  NETWORK\n    RUNG wire#powerrail Contact( %I0.0 ) P_Trig( #old ) N_Trig( #fell ) Coil( %Q0.0 ) END_RUNG\n  \
                  END_NETWORK\nEND_FUNCTION_BLOCK\n";
    fs::write(folder.join("edges.s7dcl"), source).expect("the folder can be written");
    let output = plcc(folder, &["view", "edges.s7dcl", "--cpu", "s7-1500", "-o", "drawings"]);
    let picture = fs::read_to_string(folder.join("drawings/FB_1_network_1.svg"))
        .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    for (text, count) in [("P_TRIG", 1), ("N_TRIG", 1), ("CLK", 2), ("Q", 2), ("BIT", 0)] {
        assert_eq!(picture.matches(&format!(">{text}</text>")).count(), count, "{text} in {picture}");
    }
}

#[test]
fn a_view_without_an_output_names_both_kinds() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("lamp.stl"), "      A     I 0.0\n      =     Q 4.0\n")
        .expect("the folder can be written");
    let output = plcc(&folder, &["view", "lamp.stl"]);
    assert_eq!(output.status.code(), Some(2));
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(message.contains("--out <DIR>|--html <FILE.html>"), "{message}");
}

#[test]
fn a_view_says_what_it_has_written() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    fs::write(folder.join("lamp.stl"), "      A     I 0.0\n      =     Q 4.0\n").expect("the folder can be written");
    for (flags, status, says) in [
        (&["-o", "pictures", "--html", "lamp.html"][..], 0, "wrote 1 picture to pictures\nwrote lamp.html\n"),
        (&["-o", "lamp.svg"], 2, "plcc: -o lamp.svg: this is a file; name a folder"),
        (&["-o", "lamp.pdf"], 2, "plcc: -o lamp.pdf: this is a file; pictures are SVG: name a folder for them"),
        (&["-o", "page.html"], 2, "plcc: -o page.html: this is a file; write `--html page.html` for one page"),
    ] {
        let arguments = [&["view", "lamp.stl"], flags].concat();
        let output = plcc(folder, &arguments);
        let said = if status == 0 { &output.stdout } else { &output.stderr };
        assert_eq!(output.status.code(), Some(status));
        assert!(String::from_utf8_lossy(said).starts_with(says), "{}", String::from_utf8_lossy(said));
    }
    assert!(!folder.join("lamp.svg").exists());
}

#[test]
fn a_page_on_standard_output_has_no_messages() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    fs::write(folder.join("lamp.stl"), "      A     I 0.0\n      =     Q 4.0\n").expect("the folder can be written");
    let page = fs::File::create(folder.join("lamp.html")).expect("the folder can be written");
    let arguments = ["view", "lamp.stl", "-o", "pictures", "--html", "/dev/stdout"];
    let status = Command::new(PLCC).current_dir(folder).args(arguments).stdout(page).status().expect("plcc starts");
    assert_eq!(status.code(), Some(0));
    let page = fs::read_to_string(folder.join("lamp.html")).expect("it is written");
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"), "{page}");
}

#[test]
fn a_folder_without_drawings_is_explained() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    fs::write(
        folder.join("main.scl"),
        "ORGANIZATION_BLOCK \"Main\"\nBEGIN\n  %Q0.0 := %I0.0;\nEND_ORGANIZATION_BLOCK\n",
    )
    .expect("the folder can be written");
    let output = plcc(folder, &["view", "main.scl", "-o", "drawings"]);
    let messages = String::from_utf8_lossy(&output.stderr);
    assert!(messages.contains("no networks and no charts"), "{messages}");
}
