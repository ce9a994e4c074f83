//! XML of the TIA Portal.

use std::path::Path;

use super::{done, expect_passed, folder_with, plcc, read, text, write};

/// Blocks and data types of the CPU and the libraries, whose sources are not available, and their start values.
#[test]
fn blocks_of_the_system_become_xml() {
    const SCL: &str = r#"//@ cpu s7-1500
DATA_BLOCK "Link" TCON_IP_v4
BEGIN
  InterfaceId := 64;
  RemoteAddress.ADDR[1] := 192;
  RemotePort := 502;
END_DATA_BLOCK
DATA_BLOCK "Level" CONT_C
BEGIN
  GAIN := 3.0;
END_DATA_BLOCK
FUNCTION_BLOCK "Plant"
{ S7_Optimized_Access := 'TRUE' }
VERSION : 0.1
VAR
  zone : TimeTransformationRule := (Bias := 60, TimeZoneName := 'here');
  loops : Array[0..1] of CONT_C := [(TI := T#5s), (TI := T#6s)];
END_VAR
BEGIN
  //@ assert #zone.Bias == 60
  //@ assert #zone.TimeZoneName == 'here'
  //@ assert #loops[0].TI == T#5s
  //@ assert #loops[1].TI == T#6s
  //@ assert #loops[1].GAIN == 2.0
END_FUNCTION_BLOCK
DATA_BLOCK "Plant_DB" "Plant"
BEGIN
END_DATA_BLOCK
ORGANIZATION_BLOCK "Main"
BEGIN
  "Plant_DB"();
  //@ assert "Link".RemoteAddress.ADDR[1] == 192
  //@ assert "Link".RemotePort == 502
  //@ assert "Link".ConnectionType == 11
  //@ assert "Level".GAIN == 3.0
END_ORGANIZATION_BLOCK
"#;
    const STL: &str = r#"FUNCTION_BLOCK FB 1
VAR
  wait : SFB 4;
  level : FB 41;
END_VAR
BEGIN
NETWORK
      CALL #wait (IN := M 0.0, PT := T#1S, Q := M 0.1);
      CALL #level (GAIN := 3.0);
END_FUNCTION_BLOCK
DATA_BLOCK DB 1 FB 1
BEGIN
END_DATA_BLOCK
DATA_BLOCK DB 4 SFB 4
BEGIN
  PT := T#2S;
END_DATA_BLOCK
ORGANIZATION_BLOCK OB 1
BEGIN
NETWORK
//@ assert DB4.DBD2 == 2000
      CALL FB 1, DB 1;
//@ assert DB1.level.GAIN == 3.0
      CALL SFB 4, DB 4 (IN := M 0.0, PT := T#3S, Q := M 0.1);
      CALL TON, DB 4 (IN := M 0.0, PT := T#3S, Q := M 0.1);
      CALL SFC 64 (RET_VAL := MD 10);
      CALL TIME_TCK (RET_VAL := MD 10);
      CALL FC 105 (IN := 27648, HI_LIM := 10.0, LO_LIM := 0.0, BIPOLAR := FALSE, RET_VAL := MW 20, OUT := MD 24);
//@ assert MD24 == 10.0
      BE;
END_ORGANIZATION_BLOCK
"#;
    for (name, source, set) in [("a.scl", SCL, "9 passed, 0 failed"), ("b.stl", STL, "3 passed, 0 failed")] {
        let folder = folder_with(&[]);
        write(&folder, name, source);
        done(&folder, &["convert", name, "--to", "xml", "-o", "made.xml"]);
        let cpu = if name == "a.scl" { "1511-1" } else { "315-2DP" };
        let tested = plcc(&folder, &["test", "made.xml", "--cpu", cpu]);
        let document = read(&folder, "made.xml");
        assert!(text(&tested.stdout).contains(set), "{}{}{document}", text(&tested.stdout), text(&tested.stderr));
    }
    // A block with this number may be another one.
    let folder = folder_with(&[]);
    write(&folder, "a.stl", "FUNCTION FC 1 : VOID\nBEGIN\nNETWORK\n      CALL FC 105;\nEND_FUNCTION\n");
    write(&folder, "a.sdf", "\"Motor\",\"FC 105\",\"FC 105\",\"\"\n");
    let made = plcc(&folder, &["convert", "a.stl", "a.sdf", "--to", "xml"]);
    assert_eq!(made.status.code(), Some(3), "{}", text(&made.stdout));
    assert!(text(&made.stderr).contains("FC 105 has no name"), "{}", text(&made.stderr));
}

/// A block that the source numbers and the symbol table names has that name in XML: calls and operands use it.
#[test]
fn numbered_blocks_become_xml_with_the_names_of_their_symbols() {
    const BLOCKS: &str = r#"FUNCTION_BLOCK FB 10
VAR_INPUT
  n : INT;
END_VAR
VAR_OUTPUT
  m : INT;
END_VAR
BEGIN
NETWORK
      L     #n;
      T     #m;
END_FUNCTION_BLOCK
FUNCTION FC 5 : VOID
VAR_INPUT
  n : INT;
END_VAR
BEGIN
NETWORK
      L     #n;
      T     MW 10;
END_FUNCTION
FUNCTION FC 6 : VOID
BEGIN
NETWORK
      CALL FB 10, DB 10 (n := 1);
      CALL FC 5 (n := DB10.DBW 2);
END_FUNCTION
DATA_BLOCK DB 10 FB 10
BEGIN
END_DATA_BLOCK
"#;
    const MAIN: &str = r#"{ S7_BlockNumber := "1"; S7_PreferredLanguage := "LAD" }
ORGANIZATION_BLOCK Main
    VAR_TEMP
        k : Int;
    END_VAR
    { S7_Language := "LAD" }
    NETWORK
        RUNG wire#powerrail  Contact( %I0.0 )  "Motor_DB"( n := 3, m => #k )  "Calc"( n := #k )  "Both"()  END_RUNG
    END_NETWORK
END_ORGANIZATION_BLOCK
"#;
    const SYMBOLS: &str = "\"Motor\",\"FB 10\",\"FB 10\",\"\"\n\"Motor_DB\",\"DB 10\",\"FB 10\",\"\"\n\"Calc\",\"FC 5\",\"FC 5\",\"\"\n\
                           \"Both\",\"FC 6\",\"FC 6\",\"\"\n";
    let folder =
        folder_with(&[("plant/blocks.stl", BLOCKS), ("plant/main.s7dcl", MAIN), ("plant/symbols.sdf", SYMBOLS)]);
    done(&folder, &["convert", "plant", "--to", "xml", "-o", "made/", "--cpu", "315-2DP"]);
    let (blocks, main) = (read(&folder, "made/blocks.xml"), read(&folder, "made/main.xml"));
    for found in ["<Name>Motor</Name>", "<Name>Motor_DB</Name>", "<Name>Calc</Name>", "<Number>10</Number>"] {
        assert!(blocks.contains(found), "{found} in\n{blocks}");
    }
    assert!(blocks.contains("<InstanceOfName>Motor</InstanceOfName>"), "{blocks}");
    assert!(!blocks.contains("FB_10") && !blocks.contains("FC_5"), "{blocks}");
    for found in [r#"<CallInfo Name="Motor" BlockType="FB">"#, r#"<CallInfo Name="Calc" BlockType="FC">"#] {
        assert!(main.contains(found), "{found} in\n{main}");
    }
    done(&folder, &["check", "made", "--cpu", "315-2DP"]);

    // In STL a call names the function block and its data block.
    done(&folder, &["convert", "plant", "--to", "stl", "-o", "list/", "--cpu", "315-2DP"]);
    let main = read(&folder, "list/main.stl");
    assert!(main.contains("CALL  FB 10, \"Motor_DB\" ("), "{main}");
    done(&folder, &["check", "list", "--cpu", "315-2DP"]);
}

/// Start values of all types that STL has constants of.
#[test]
fn start_values_of_stl_become_xml() {
    let source = "DATA_BLOCK DB 1\nSTRUCT\n  q : DATE_AND_TIME := DT#2001-2-3-4:5:6.789;\n  h : S5TIME := S5T#1M2S;\n  \
                  r : ARRAY [1..4 ] OF INT := 1, 2 (5), 9;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\nORGANIZATION_BLOCK OB 1\n\
                  BEGIN\nNETWORK\n      SET;\n//@ assert DB1.DBD 0 == DW#16#0102_0304\n//@ assert DB1.DBW 12 == 5\n\
                  END_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("a.stl", source)]);
    done(&folder, &["convert", "a.stl", "--to", "xml", "-o", "a.xml"]);
    expect_passed(&folder, &["a.xml", "--cpu", "315-2DP"], 2);
    // XML has the values of arrays one by one, STL as a list.
    let back = text(&plcc(&folder, &["convert", "a.xml", "--to", "stl"]).stdout);
    assert!(back.contains("r : ARRAY[1..4] OF INT := 1, 2(5), 9;"), "{back}");
}

/// Assertions of STL are in the XML where they were, also where a network or a block has nothing else; numbers keep their digits.
#[test]
fn assertions_of_stl_become_xml() {
    let source = "//@ cpu s7-1500\nFUNCTION \"Take\" : VOID\nVAR_INPUT\n  share : LREAL;\nEND_VAR\nBEGIN\n\
                  //@ assert #share == 0.123456789\nEND_FUNCTION\nORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\n\
                  //@ assert MW10 == 0\n      L     1;\n      T     MW 10;\n      CALL  \"Take\" (share := 0.123456789);\nNETWORK\n\
                  //@ assert MW10 == 1\n      T     MW 12;\n// the end\nNETWORK\n//@ assert MW12 == 1\nEND_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("a.stl", source)]);
    done(&folder, &["convert", "a.stl", "--to", "xml", "-o", "a.xml"]);
    for name in ["a.stl", "a.xml"] {
        expect_passed(&folder, &[name], 4);
    }
}

/// Statements without a header are the block that the name of their file states, in other notations too.
#[test]
fn names_of_files_name_blocks() {
    let folder = folder_with(&[
        ("parts/FC19_Count.awl", "      A     I 0.0\n      =     Q 4.0\n"),
        ("parts/OB1_MAIN.awl", "      CALL  FC 19\n"),
    ]);
    for (to, ending) in [("xml", "xml"), ("lad", "s7dcl")] {
        let out = format!("{to}/");
        done(&folder, &["convert", "parts", "--to", to, "-o", &out]);
        done(&folder, &["check", to]);
        let written = read(&folder, &format!("{to}/FC19_Count.{ending}"));
        assert!(written.contains("<Name>FC_19</Name>") || written.contains("FUNCTION FC19 : Void"), "{written}");
    }
}

/// Tags in an export with blocks are beside what is made of the blocks.
#[test]
fn tags_among_exported_blocks_stay() {
    let folder = folder_with(&[]);
    let export = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/scl/exports/memory-by-tags.xml");
    for (to, name) in [("xml", "a.xml"), ("scl", "b.scl")] {
        done(&folder, &["convert", &export.to_string_lossy(), "--to", to, "-o", name]);
        let tags = Path::new(name).with_extension("tags.xml");
        expect_passed(&folder, &[name, &tags.to_string_lossy()], 3);
    }
}

/// Start values of single elements, which exports have, follow BEGIN where a declaration does not have them.
#[test]
fn start_values_of_elements_stay() {
    let data = "DATA_BLOCK \"Data\"\nVERSION : 0.1\nSTRUCT\n  a : ARRAY[1..3] OF STRUCT b : BOOL; w : WORD := W#16#1F; END_STRUCT;\n  \
                m : ARRAY[0..3, 1..2] OF INT;\n  s : STRUCT\n    q : ARRAY[0..2] OF \"U\";\n  END_STRUCT;\n  p : \"U\";\n  big : REAL := 1.5;\n\
                END_STRUCT;\nBEGIN\n  a[2].w := W#16#2F;\n  m[1,2] := 5;\n  s.q[1].\"IF\" := 7;\n  s.q[1].y[2] := 8;\n  p.\"IF\" := 6;\n\
                END_DATA_BLOCK\nTYPE \"U\"\nVERSION : 0.1\nSTRUCT\n  \"IF\" : INT := 2;\n  y : ARRAY[0..3] OF INT;\nEND_STRUCT;\nEND_TYPE\n";
    let main = "ORGANIZATION_BLOCK \"Main\"\nVERSION : 0.1\nVAR_TEMP\n  i : INT;\nEND_VAR\nBEGIN\n  //@ assert \"Data\".a[1].w == 16#1F\n  //@ assert \"Data\".a[2].w == 16#2F\n  \
                //@ assert \"Data\".m[1,2] == 5\n  //@ assert \"Data\".s.q[0].y[2] == 0\n  //@ assert \"Data\".s.q[1].y[2] == 8\n  \
                //@ assert \"Data\".p.y[0] == 0\n  //@ assert \"Data\".big == 1.5\n  \
                #i := \"Data\".s.q[1].\"IF\" * 10 + \"Data\".p.\"IF\";\n  //@ assert #i == 76\nEND_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("data.scl", data), ("main.scl", main)]);
    let convert = |from: &str, to: &str, name: &str| {
        done(&folder, &["convert", from, "--to", to, "--cpu", "s7-1500", "-o", name]);
    };
    convert("data.scl", "xml", "data.xml");
    for (to, name) in [("scl", "again.scl"), ("sd", "again.s7dcl")] {
        convert("data.xml", to, name);
        expect_passed(&folder, &[name, "main.scl", "--cpu", "s7-1500"], 8);
    }
    // A function block has no BEGIN for them, but a list.
    let block = "FUNCTION_BLOCK \"F\"\nVERSION : 0.1\nVAR\n  p : \"U\" := (y := [0, 0, 5]);\nEND_VAR\nBEGIN\nEND_FUNCTION_BLOCK\n\
                 TYPE \"U\"\nVERSION : 0.1\nSTRUCT\n  y : ARRAY[0..3] OF INT;\nEND_STRUCT;\nEND_TYPE\n";
    write(&folder, "block.scl", block);
    convert("block.scl", "xml", "block.xml");
    let made = plcc(&folder, &["convert", "block.xml", "--to", "scl"]);
    assert!(text(&made.stdout).contains("    p : \"U\" := (y := [0, 0, 5]);\n"), "{}", text(&made.stdout));
    // A list has no gaps.
    let whole = read(&folder, "block.xml");
    let (before, rest) = whole.split_once("<Subelement Path=\"0\">").expect("values of elements");
    let (_, after) = rest.split_once("</Subelement>").expect("its end");
    write(&folder, "gap.xml", &format!("{before}{after}"));
    let made = plcc(&folder, &["convert", "gap.xml", "--to", "scl"]);
    assert_eq!(made.status.code(), Some(3), "{}", text(&made.stdout));
    assert!(text(&made.stderr).contains("no start values of single elements"), "{}", text(&made.stderr));
    // STL has no start values of structures in declarations at all.
    convert("data.xml", "stl", "again.stl");
    let list = read(&folder, "again.stl");
    for found in ["    a[2].w := W#16#002F;\n", "    s.q[1].y[2] := 8;\n"] {
        assert!(list.contains(found), "{found} in\n{list}");
    }
}

/// Values of single elements of an instance come back from XML.
#[test]
fn values_of_instances_come_back() {
    let source = "FUNCTION_BLOCK \"F\"\nVERSION : 0.1\nVAR\n    list : Array[1..3] of STRUCT\n        w : Int;\n        \
                  r : Real;\n    END_STRUCT;\n    m : Array[0..1, 0..1] of Int;\nEND_VAR\nBEGIN\n    #m[0, 0] := 1;\n\
                  END_FUNCTION_BLOCK\n\nDATA_BLOCK \"D\"\n\"F\"\nBEGIN\n    list[2].w := 5;\n    list[2].r := 1.5;\n    \
                  m[1, 0] := 7;\nEND_DATA_BLOCK\n";
    let folder = folder_with(&[("a.scl", source)]);
    done(&folder, &["convert", "a.scl", "--to", "xml", "-o", "a.xml"]);
    let back = plcc(&folder, &["convert", "a.xml", "--to", "scl"]);
    assert_eq!(text(&back.stdout), source, "{}", text(&back.stderr));
}

/// Values of elements of constants and of structures come back as lists, with the data types in other sources.
#[test]
fn lists_of_declarations_come_back() {
    let row = "TYPE \"Row\"\nVERSION : 0.1\nSTRUCT\n    n : Int;\n    names : Array[1..2] of String[4];\nEND_STRUCT;\nEND_TYPE\n";
    let block = "FUNCTION_BLOCK \"F\"\nVERSION : 0.1\nVAR\n    row : \"Row\" := (n := 3, names := ['a', 'b']);\nEND_VAR\n\
                 VAR CONSTANT\n    DAYS : Array[1..3] of Int := [31, 28, 31];\nEND_VAR\nBEGIN\n    #row.n := #DAYS[1];\n\
                 END_FUNCTION_BLOCK\n";
    let folder = folder_with(&[("a/row.scl", row), ("a/block.scl", block)]);
    for (from, to) in [("a", "xml"), ("xml", "scl")] {
        done(&folder, &["convert", from, "--to", to, "-o", &format!("{to}/"), "--cpu", "s7-1500"]);
    }
    assert_eq!((read(&folder, "scl/row.scl").as_str(), read(&folder, "scl/block.scl").as_str()), (row, block));
}

/// What starts an organization block has another name in XML.
#[test]
fn classes_of_organization_blocks_come_back() {
    let source = "ORGANIZATION_BLOCK \"Begin\"\n{ S7_EventClass := 'Startup' }\nVERSION : 0.1\nBEGIN\n    %MW0 := 1;\n\
                  END_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("a.scl", source)]);
    let made = plcc(&folder, &["convert", "a.scl", "--to", "xml", "-o", "a.xml"]);
    assert_eq!((made.status.code(), text(&made.stderr).as_str()), (Some(0), ""));
    assert_eq!(text(&plcc(&folder, &["convert", "a.xml", "--to", "scl"]).stdout), source);
    let document = text(&plcc(&folder, &["convert", "a.xml", "--to", "sd"]).stdout);
    assert!(document.starts_with("{ S7_EventClass := \"Startup\"; S7_Version := \"0.1\" }\n"), "{document}");
}

/// A part of a part of a variable is one part of it.
#[test]
fn parts_of_parts_are_one() {
    let source = "//@ cpu s7-1500\nFUNCTION_BLOCK \"F\"\nVERSION : 0.1\nVAR\n    d : DWord;\nEND_VAR\nBEGIN\n    \
                  #d.%W1.%B1.%X2 := TRUE;\n    //@ assert #d == DW#16#0400_0000\nEND_FUNCTION_BLOCK\n\
                  DATA_BLOCK \"D\"\n\"F\"\nBEGIN\nEND_DATA_BLOCK\n\
                  ORGANIZATION_BLOCK \"Main\"\nBEGIN\n    \"D\"();\nEND_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("a.scl", source)]);
    done(&folder, &["convert", "a.scl", "--to", "xml", "-o", "a.xml"]);
    let document = read(&folder, "a.xml");
    assert!(document.contains("<Component Name=\"d\" SliceAccessModifier=\"x26\"/>"), "{document}");
    expect_passed(&folder, &["a.xml"], 1);
}

/// A data type that is another name of a type is written out where it is used.
#[test]
fn names_of_types_are_written_out() {
    let source = "TYPE \"State\" : Int;\nEND_TYPE\nTYPE \"Row\" : Array[0..1] of \"State\";\nEND_TYPE\n\
                  DATA_BLOCK \"D\"\n{ S7_Optimized_Access := 'TRUE' }\nVERSION : 0.1\nVAR\n    s : \"State\" := 3;\n    \
                  r : \"Row\";\n    all : Array[1..2] of \"State\";\nEND_VAR\nBEGIN\n    r[1] := 5;\nEND_DATA_BLOCK\n";
    let folder = folder_with(&[("a.scl", source)]);
    let made = plcc(&folder, &["convert", "a.scl", "--to", "xml", "-o", "a.xml", "--cpu", "s7-1500"]);
    let said = text(&made.stderr);
    assert_eq!(made.status.code(), Some(0), "{said}");
    assert!(said.contains("`State` is not a structure: its type is written where it is used"), "{said}");
    let document = read(&folder, "a.xml");
    for (name, ty) in [("s", "Int"), ("r", "Array[0..1] of Int"), ("all", "Array[1..2] of Int")] {
        let wanted = format!("<Member Name=\"{name}\" Datatype=\"{ty}\"");
        assert!(document.contains(&wanted), "{wanted} in\n{document}");
    }
    assert!(!document.contains("PlcStruct"), "{document}");
    done(&folder, &["check", "a.xml", "--cpu", "s7-1500"]);
}

/// Start values of STL have no types in XML, where the member has one.
#[test]
fn start_values_of_stl_have_no_types() {
    let source = "DATA_BLOCK DB 1\nSTRUCT\n  a : REAL := 2.5;\n  b : WORD := W#16#1F;\n  c : DINT := L#-70000;\n  d : TIME := T#2S;\n\
                  END_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n";
    let folder = folder_with(&[("a.stl", source)]);
    let document = text(&plcc(&folder, &["convert", "a.stl", "--to", "xml"]).stdout);
    for value in ["2.5", "16#1F", "-70000", "T#2S"] {
        assert!(document.contains(&format!("<StartValue>{value}</StartValue>")), "{value} in\n{document}");
    }
}

/// The TIA Portal writes the data of timers and counters with their components: in XML they are instances.
#[test]
fn data_of_instructions_become_instances() {
    const SOURCE: &str = r#"//@ cpu s7-1500
DATA_BLOCK "Wait"
{InstructionName := 'IEC_TIMER';
LibVersion := '1.0';
S7_Optimized_Access := 'TRUE' }
AUTHOR : Simatic
NAME : IEC_TMR
VERSION : 1.0
NON_RETAIN
   VAR
      PT : Time := T#2s;
      ET : Time;
      IN : Bool;
      Q : Bool;
   END_VAR
BEGIN
END_DATA_BLOCK

ORGANIZATION_BLOCK "Main"
VERSION : 0.1
BEGIN
  //@ assert "Wait".PT == T#2s
  "Wait".TON(IN := TRUE, PT := T#1s);
  //@ sleep 1500
  "Wait".TON(IN := TRUE, PT := T#1s);
  //@ assert "Wait".Q == 1
END_ORGANIZATION_BLOCK
"#;
    let folder = folder_with(&[("a.scl", SOURCE)]);
    let made = plcc(&folder, &["convert", "a.scl", "--to", "xml", "-o", "a.xml"]);
    assert_eq!((made.status.code(), text(&made.stderr).as_str()), (Some(0), ""));
    let document = read(&folder, "a.xml");
    for found in [
        "<SW.Blocks.InstanceDB",
        "<OfSystemLibElement>IEC_TIMER</OfSystemLibElement>",
        "<OfSystemLibVersion>1.0</OfSystemLibVersion>",
    ] {
        assert!(document.contains(found), "{found} in\n{document}");
    }
    expect_passed(&folder, &["a.xml"], 2);
    let source = text(&plcc(&folder, &["convert", "a.xml", "--to", "scl"]).stdout);
    for found in ["InstructionName := 'IEC_TIMER'; LibVersion := '1.0' }\n", "\nIEC_TIMER\nBEGIN\n    PT := T#2s;\n"] {
        assert!(source.contains(found), "{found} in\n{source}");
    }
}

/// A number that the project chose is left to the project again, unless addresses need it.
#[test]
fn automatic_numbers_stay_automatic() {
    let object = |kind: &str, name: &str, layout: &str, language: &str| {
        format!(
            "<SW.Blocks.{kind} ID=\"{name}\"><AttributeList><AutoNumber>true</AutoNumber>\
             <Interface><Sections xmlns=\"http://www.siemens.com/automation/Openness/SW/Interface/v5\">\
             <Section Name=\"Static\"><Member Name=\"x\" Datatype=\"Int\"/></Section></Sections></Interface>\
             <MemoryLayout>{layout}</MemoryLayout><Name>{name}</Name><Number>5</Number>\
             <ProgrammingLanguage>{language}</ProgrammingLanguage></AttributeList></SW.Blocks.{kind}>"
        )
    };
    let document = format!(
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<Document><Engineering version=\"V17\"/>{}{}</Document>\n",
        object("GlobalDB", "Five", "Standard", "DB"),
        object("FB", "Lamp", "Optimized", "SCL")
    );
    let folder = folder_with(&[("a.xml", &document)]);
    let main =
        "ORGANIZATION_BLOCK \"Main\"\nBEGIN\n  %DB5.DBW0 := 7;\n  //@ assert \"Five\".x == 7\nEND_ORGANIZATION_BLOCK\n";
    write(&folder, "main.scl", main);
    for to in ["scl", "sd"] {
        let output = format!("{to}/");
        done(&folder, &["convert", "a.xml", "main.scl", "--to", to, "-o", &output, "--cpu", "s7-1500"]);
        expect_passed(&folder, &[to, "--cpu", "s7-1500"], 1);
        let extension = if to == "sd" { "s7dcl" } else { to };
        let found = read(&folder, &format!("{to}/a.{extension}"));
        assert_eq!(found.matches("S7_BlockNumber").count(), 1, "{found}");
    }
}

/// Numbers of blocks come back from XML, where each block has a name.
#[test]
fn numbers_of_exports_stay() {
    let source = "//@ cpu 315-2DP\nFUNCTION FC 1 : VOID\nBEGIN\nNETWORK\n      L     5;\n      T     DB7.DBW 0;\nEND_FUNCTION\n\
                  TYPE UDT 3\nSTRUCT\n  x : INT;\nEND_STRUCT;\nEND_TYPE\nDATA_BLOCK DB 7\nUDT 3\nBEGIN\nEND_DATA_BLOCK\n\
                  ORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\n      UC    FC 1;\n//@ assert DB7.DBW 0 == 5\nEND_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("a.stl", source)]);
    for (from, to, name) in [("a.stl", "xml", "a.xml"), ("a.xml", "stl", "b.stl")] {
        let made = plcc(&folder, &["convert", from, "--to", to, "-o", name]);
        assert_eq!((made.status.code(), text(&made.stderr).as_str()), (Some(0), ""));
    }
    let list = read(&folder, "b.stl");
    for (block, number) in [("FUNCTION \"FC_1\"", 1), ("TYPE \"UDT_3\"", 3), ("DATA_BLOCK \"DB_7\"", 7)] {
        let lines: Vec<&str> = list.lines().collect();
        let at = lines.iter().position(|line| line.starts_with(block));
        let next = at.and_then(|at| lines.get(at + 1)).copied();
        assert_eq!(next, Some(format!("{{ S7_BlockNumber := '{number}' }}").as_str()), "{block} in\n{list}");
    }
    expect_passed(&folder, &["b.stl"], 1);
}

/// Data of the types IEC_TIMER and IEC_COUNTER do not say which instruction has them: its name stays.
#[test]
fn names_of_instructions_with_shared_data_stay() {
    let export = "../../tests/run/stl/exports/instructions-with-shared-data.xml";
    let export = Path::new(env!("CARGO_MANIFEST_DIR")).join(export).display().to_string();
    let folder = folder_with(&[]);
    done(&folder, &["convert", &export, "--to", "xml", "-o", "a.xml"]);
    expect_passed(&folder, &["a.xml"], 4);
    // SCL becomes calls with the name in quotes.
    let quoted = "//@ cpu s7-1500\nFUNCTION_BLOCK \"Delay\"\nVERSION : 0.1\nVAR\n  own : IEC_TIMER;\nEND_VAR\nBEGIN\nNETWORK\n      \
                  CALL  \"TP\", #own (IN := TRUE, PT := T#5S);\n//@ assert #own.Q == 1\n      NOP   0;\nEND_FUNCTION_BLOCK\n\
                  DATA_BLOCK \"Delay_DB\" \"Delay\"\nBEGIN\nEND_DATA_BLOCK\nORGANIZATION_BLOCK \"Main\"\nVERSION : 0.1\nBEGIN\n\
                  NETWORK\n      CALL  \"Delay\", \"Delay_DB\";\nEND_ORGANIZATION_BLOCK\n";
    write(&folder, "quoted.stl", quoted);
    done(&folder, &["convert", "quoted.stl", "--to", "xml", "-o", "quoted.xml"]);
    expect_passed(&folder, &["quoted.xml", "--cpu", "s7-1500"], 1);
}

/// Calls of instances in data blocks, in structures and in arrays.
#[test]
fn calls_of_instances_inside_data_come_back() {
    const STL: &str = r#"//@ cpu s7-1500
DATA_BLOCK "Line"
VERSION : 0.1
STRUCT
  first : TON_TIME;
  others : ARRAY[0..3] OF CTU_INT;
END_STRUCT
BEGIN
END_DATA_BLOCK
TYPE "Cell"
STRUCT
  count : CTU_INT;
END_STRUCT
END_TYPE
FUNCTION_BLOCK "Plant"
VERSION : 0.1
VAR
  cell : "Cell";
  counts : ARRAY[0..3] OF CTU_INT;
END_VAR
BEGIN
NETWORK
      CALL "Line".first (IN := TRUE, PT := T#5S, Q := M 0.1);
      CALL "Line".others[2] (CU := TRUE, R := FALSE, PV := 1, Q := M 0.2);
      CALL #cell.count (CU := TRUE, R := FALSE, PV := 1, Q := M 0.3);
      CALL #counts[1] (CU := TRUE, R := FALSE, PV := 1, Q := M 0.4);
//@ assert "Line".first.PT == T#5S
//@ assert MB0 == 16#1C
//@ assert "Line".others[2].CV == 1
//@ assert #cell.count.CV == 1
//@ assert #counts[1].CV == 1
      NOP   0;
END_FUNCTION_BLOCK
DATA_BLOCK "Plant_DB" "Plant"
BEGIN
END_DATA_BLOCK
ORGANIZATION_BLOCK "Main"
VERSION : 0.1
BEGIN
NETWORK
      CALL "Plant", "Plant_DB";
END_ORGANIZATION_BLOCK
"#;
    let folder = folder_with(&[("a.stl", STL)]);
    done(&folder, &["convert", "a.stl", "--to", "xml", "-o", "made.xml"]);
    expect_passed(&folder, &["made.xml", "--cpu", "1511-1"], 5);
}
