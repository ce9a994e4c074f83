//! STL in other notations, its mnemonics and its report of a migration; SCL as SCL.

use std::path::Path;

use super::{done, expect_passed, folder_with, plcc, read, text, write};

/// An LREAL has more digits than the constants of statement lists.
#[test]
fn start_values_keep_the_digits_of_an_lreal() {
    let list = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/stl/data/lreal_start_values.stl");
    let list = list.display().to_string();
    for notation in ["xml", "lad"] {
        let folder = folder_with(&[]);
        done(&folder, &["convert", &list, "--to", notation, "-o", "made/"]);
        expect_passed(&folder, &["made"], 5);
    }
}

/// The TIA Portal declares the data of a timer as TON_TIME.
#[test]
fn calls_of_timers_by_the_type_of_their_data_are_drawn() {
    let list = "//@ cpu s7-1500\nFUNCTION_BLOCK \"Wait\"\nVAR\n  pause : TON_TIME;\nEND_VAR\nBEGIN\nNETWORK\n      \
                CALL #pause (IN := M 0.0, PT := T#10MS, Q := M 0.1);\nEND_FUNCTION_BLOCK\nDATA_BLOCK \"Wait_DB\"\n\"Wait\"\nBEGIN\n\
                END_DATA_BLOCK\nORGANIZATION_BLOCK \"Main\"\nBEGIN\nNETWORK\n      CALL \"Wait\", \"Wait_DB\";\nEND_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("wait.stl", list)]);
    for notation in ["lad", "fbd"] {
        done(&folder, &["convert", "wait.stl", "--to", notation, "-o", "wait.s7dcl"]);
        let drawn = read(&folder, "wait.s7dcl");
        assert!(drawn.contains("#pause.TON("), "{drawn}");
        for file in ["wait.stl", "wait.s7dcl"] {
            let run =
                ["run", file, "--clock", "virtual", "--cycles", "4", "--quiet", "--set", "M0.0=1", "--print", "MB0"];
            let output = done(&folder, &[&run[..], &["--cpu", "s7-1500"]].concat());
            assert_eq!(text(&output.stdout), "MB0 = 16#03\n", "{file}");
        }
    }
}

/// The second of two networks in STL goes on with the RLO of the first.
#[test]
fn networks_in_stl_stay_as_they_are() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/parse/simatic-ml/mixed-block.xml");
    let export = std::fs::read_to_string(file).expect("a test file").replace("\r\n", "\n");
    let place = |text: &str| export.find(text).unwrap_or_else(|| panic!("{text} is in the file"));
    let (scl, list) = (place("<SW.Blocks.CompileUnit ID=\"2\""), place("<SW.Blocks.CompileUnit ID=\"3\""));
    let head = export[list..place("  <StlStatement>")].replace("\"3\"", "\"4\"");
    let between = "</StatementList></NetworkSource><ProgrammingLanguage>STL</ProgrammingLanguage></AttributeList></SW.Blocks.CompileUnit>";
    let second = "  <StlStatement>\n    <StlToken Text=\"S\" />";
    let export =
        format!("{}{}", &export[..scl], &export[list..]).replace(second, &format!("{between}\n{head}{second}"));
    let folder = folder_with(&[("mixed.xml", &export), ("tags.sdf", "\"Motor\",\"Q 4.0\",\"BOOL\",\"\"\n")]);
    done(&folder, &["convert", "mixed.xml", "tags.sdf", "--to", "stl", "--cpu", "s7-1500", "-o", "made/"]);
    let made = read(&folder, "made/mixed.stl");
    assert!(made.contains("S     \"Motor\"") && made.matches("NETWORK").count() > 2, "{made}");
    assert!(!made.contains("CLR"), "{made}");
}

/// SAVE does not end the string of logic: without CLR, the next rung would be an AND with it.
#[test]
fn rungs_after_save_begin_anew() {
    let rung = |rung: &str| format!("        RUNG wire#powerrail  {rung}  END_RUNG\n");
    let network = |rungs: &[&str]| {
        let rungs: String = rungs.iter().map(|one| rung(one)).collect();
        format!("    {{ S7_Language := \"LAD\" }}\n    NETWORK\n{rungs}    END_NETWORK\n")
    };
    let saved = "Contact( %M0.7 )  SaveCoil()";
    let first = network(&[saved, "I_Contact( %M0.7 )  Coil( %Q4.0 )", saved]);
    let second = network(&["I_Contact( %M0.7 )  Coil( %Q4.1 )"]);
    let source = format!(
        "//@ cpu s7-300\nORGANIZATION_BLOCK Main\n{first}    //@ assert %Q4.0 == 1\n{second}    //@ assert %Q4.1 == 1\n\
         END_ORGANIZATION_BLOCK\n"
    );
    let folder = folder_with(&[("save.s7dcl", &source)]);
    expect_passed(&folder, &["save.s7dcl"], 2);
    done(&folder, &["convert", "save.s7dcl", "--to", "stl", "-o", "save.stl"]);
    expect_passed(&folder, &["save.stl"], 2);
}

/// NOP is not an element: what is between it and the first one is before the network.
#[test]
fn assertions_after_nop_stand_before_their_network() {
    let list = "ORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\n      NOP   0\n//@ assert M 0.0 == 0\n      SET\n      =     M 0.0\n\
                //@ assert M 0.0 == 1\nEND_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("a.stl", list)]);
    for notation in ["lad", "fbd"] {
        done(&folder, &["convert", "a.stl", "--to", notation, "-o", "a.s7dcl"]);
        expect_passed(&folder, &["a.s7dcl"], 2);
    }
}

/// What the CPU and the libraries of STEP 7 declare is not in the sources. A symbol may say that a number is that of another block.
#[test]
fn calls_of_the_library_are_drawn() {
    let list = "//@ cpu s7-300\nORGANIZATION_BLOCK OB 1\nVAR_TEMP info : ARRAY[0..19] OF BYTE; END_VAR\nBEGIN\nNETWORK\n\
                L L#123456;\nT MD 0;\nL 13824;\nT MW 40;\nSET;\n= M 50.0;\nNETWORK\nA M 50.0;\nJNB _001;\n\
                CALL SFC 20 (SRCBLK := MD 0, RET_VAL := MW 54, DSTBLK := MD 10);\n_001: NOP 0;\nNETWORK\nA M 50.0;\n\
                JNB _002;\nCALL FC 105 (IN := MW 40, HI_LIM := 1.0e2, LO_LIM := 0.0, BIPOLAR := M 50.1, RET_VAL := MW 20, \
                OUT := MD 24);\n_002: NOP 0;\nNETWORK\nA M 50.0;\nJNB _003;\n\
                CALL SFB 4, DB 4 (IN := M 50.0, PT := T#0ms, Q := M 60.2, ET := MD 64);\n_003: NOP 0;\n\
                //@ assert MD 10 == 123456\n//@ assert MD 24 as REAL == 50.0\nEND_ORGANIZATION_BLOCK\n\
                DATA_BLOCK DB 4\nSFB 4\nBEGIN\nEND_DATA_BLOCK\n";
    let folder = folder_with(&[("a.stl", list), ("b.sdf", "\"Own\",\"FC 105\",\"FC 105\",\"\"\r\n")]);
    for notation in ["lad", "fbd"] {
        done(&folder, &["convert", "a.stl", "--to", notation, "-o", "a.s7dcl"]);
        let made = read(&folder, "a.s7dcl");
        for call in ["%SFC20( ", "RET_VAL => %MW54", "%FC105( ", "OUT => %MD24", "%DB4( "] {
            assert!(made.contains(call), "{call} in {made}");
        }
        expect_passed(&folder, &["a.s7dcl", "--cpu", "s7-300"], 2);
    }
    let refused = plcc(folder.path(), &["convert", "a.stl", "b.sdf", "--to", "lad", "-o", "made/"]);
    let said = text(&refused.stderr);
    assert!(said.contains("JNB _002") && !said.contains("JNB _001"), "{said}");
}

/// Parts of variables, `#w.%X2`, are no components.
#[test]
fn parts_of_variables_are_drawn() {
    let list = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/stl/syntax/tia_slices.stl");
    let folder = folder_with(&[]);
    for notation in ["lad", "fbd"] {
        done(&folder, &["convert", &list.display().to_string(), "--to", notation, "-o", "a.s7dcl"]);
        expect_passed(&folder, &["a.s7dcl", "--cpu", "s7-1500"], 7);
    }
}

/// `RET_VAL` without `#` is the value of the function, not a symbol of the program.
#[test]
fn values_of_functions_without_a_mark_are_local_in_xml() {
    let list = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/stl/german/like_addresses.stl");
    let folder = folder_with(&[]);
    done(&folder, &["convert", &list.display().to_string(), "--to", "xml", "-o", "made/"]);
    expect_passed(&folder, &["made"], 1);
}

/// Instructions that STL calls for types: `CALL LIMIT {value_type := Int}`, and `relation := EQ` of comparisons.
#[test]
fn calls_for_types_stay_in_xml() {
    let lists = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/stl/syntax");
    for list in ["tia_instructions", "tia_move", "tia_block_moves", "tia_times_and_texts", "tia_functions_of_texts"] {
        let list = lists.join(list).with_extension("stl").display().to_string();
        let folder = folder_with(&[]);
        done(&folder, &["convert", &list, "--to", "xml", "-o", "a.xml"]);
        done(&folder, &["test", "a.xml"]);
    }
}

/// Blocks of the libraries are in the report of a migration, those of the program with their own statements.
#[test]
fn reports_of_migrations_have_blocks_of_the_libraries() {
    let list = "FUNCTION FC 2 : VOID\nVAR_TEMP\n  s : STRING[20];\nEND_VAR\nBEGIN\nNETWORK\n      \
                CALL  FC 10 (S1 := #s, S2 := #s, RET_VAL := M 0.0);\n      \
                CALL  FC 105 (IN := IW 64, HI_LIM := 1.0, LO_LIM := 0.0, BIPOLAR := FALSE, RET_VAL := MW 2, OUT := MD 4);\n      \
                CALL  FB 41, DB 41;\nEND_FUNCTION\nDATA_BLOCK DB 41 FB 41\nBEGIN\nEND_DATA_BLOCK\n\
                ORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\n      CALL FC 2;\nEND_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("a.stl", list)]);
    let output = plcc(&folder, &["convert", "a.stl", "--report", "s7-1500"]);
    let report = text(&output.stdout);
    assert!(report.contains("  FC 10 EQ_STRNG    S_COMP\n      a.stl:7  CALL FC 10 ("), "{report}");
    assert!(report.contains("  FC 105 SCALE (1)  the instruction of this name\n"), "{report}");
    assert!(report.contains("  FB 41 CONT_C (1)  the instruction of this name\n"), "{report}");
    assert!(!report.contains("FC 2 "), "{report}");
}

/// `SE` starts an on-delay in the German set and an extended pulse in the international one.
#[test]
fn a_source_that_does_not_show_its_mnemonics_has_those_of_the_others() {
    let folder = folder_with(&[]);
    let delay = "      O     M 0.0\n      L     S5T#1S\n      SE    T 1\n";
    write(&folder, "delay.awl", &format!("FUNCTION FC 2 : VOID\nBEGIN\n{delay}END_FUNCTION\n"));
    let main = |and: &str, status: u8| {
        let code = "      SET\n      =     M 0.0\n      UC    FC 2\n";
        let check = format!("      {and}     T 1\n//@ assert STW.RLO == {status}\n");
        write(&folder, "main.awl", &format!("ORGANIZATION_BLOCK OB 1\nBEGIN\n{code}{check}END_ORGANIZATION_BLOCK\n"));
        done(&folder, &["test", "main.awl", "delay.awl"]);
    };
    main("U", 0);
    main("A", 1);
}

/// Types in the letters of their author, words of the language as names, and signs after operators, also by way of an export.
#[test]
fn scl_comes_back_as_its_author_wrote_it() {
    let source = r#"FUNCTION "F" : Void
VERSION : 0.1
VAR_INPUT
    "IF" : Int;
    s : Struct
        "FOR" : Array[0..3] of Int;
        t : String[8];
    END_STRUCT;
END_VAR
VAR_TEMP
    i : DInt;
    r : LReal;
END_VAR
BEGIN
    #i := -#i - -5;
    #r := -#r ** 2;
    #i := #"IF" + #s."FOR"[#i] * -2;
    #i := "D"."WHILE" + -"D".s."TO" - (-7);
    #i := -(-#i);
END_FUNCTION
"#;
    let folder = folder_with(&[("a.scl", source)]);
    let convert = |arguments: &[&str]| {
        let output = done(&folder, &[&["convert"][..], arguments].concat());
        text(&output.stdout)
    };
    assert_eq!(convert(&["a.scl", "--to", "scl"]), source);
    convert(&["a.scl", "--to", "xml", "--cpu", "s7-1500", "-o", "a.xml"]);
    let back = convert(&["a.xml", "--to", "scl"]);
    for found in ["    \"IF\" : Int;", "\"FOR\" : Array[0..3] of Int;", "r : LReal;"] {
        assert!(back.contains(found), "{found} in\n{back}");
    }
    let body = |text: &str| text.split("BEGIN").nth(1).map(str::to_string);
    assert_eq!(body(&back), body(source), "{back}");
}
