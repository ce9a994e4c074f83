//! `plcc convert` as a command: symbols and addresses, reports of migrations, SCL as STL.
//!
//! `convert/` has the programs, and beside them what plcc writes: `plant.absolute`. `UPDATE_EXPECT=1` renews these.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const PLCC: &str = env!("CARGO_BIN_EXE_plcc");

fn programs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/command/convert")
}

fn plcc(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(PLCC).current_dir(folder).args(arguments).output().expect("plcc starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).replace("\r\n", "\n")
}

/// Compares what a command prints, and its messages, with a file.
fn expect(arguments: &[&str], file: &str) {
    let output = plcc(&programs(), arguments);
    let found = format!("{}{}", text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{arguments:?}:\n{found}");
    let path = programs().join(file);
    if std::env::var_os("UPDATE_EXPECT").is_some_and(|value| value != "0") {
        return fs::write(&path, found).expect("the tree can be written");
    }
    let expected = fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(found, expected, "{file}: UPDATE_EXPECT=1 renews it; read the diff");
}

#[test]
fn symbols_become_addresses_and_addresses_symbols() {
    expect(&["convert", "plant", "--absolute"], "plant.absolute");
    expect(&["convert", "plant", "--symbolic"], "plant.symbolic");
    expect(&["convert", "press", "--absolute"], "press.absolute");
    expect(&["convert", "press", "--symbolic"], "press.symbolic");
}

#[test]
fn regions_stay() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION \"F\" : VOID\nVAR_TEMP\n    n : INT;\nEND_VAR\nBEGIN\n    REGION Start values   // c\n    #n := 1;\n    \
                  IF #n = 1 THEN\n        REGION inside\n        #n := 2;\n        END_REGION inside\n    END_IF;\n    \
                  END_REGION\nEND_FUNCTION\n";
    fs::write(folder.join("a.scl"), source).expect("the folder can be written");
    let output = plcc(folder, &["convert", "a.scl", "--to", "scl"]);
    let words = |text: &str| text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
    let (found, wanted): (Vec<String>, Vec<String>) = (words(&text(&output.stdout)), words(source));
    assert_eq!(found, wanted);
    let xml = text(&plcc(folder, &["convert", "a.scl", "--to", "xml"]).stdout);
    let lines = |part: &str| xml.lines().filter(|line| line.contains(part)).count();
    assert_eq!((lines(" Text=\"REGION\"/>"), lines(" Text=\"END_REGION\"/>")), (2, 2), "{xml}");
    assert_eq!((lines("\">Start values</Text>"), lines("\">inside</Text>")), (1, 2), "{xml}");
    // STL and PLCopen XML have no regions.
    for (notation, cpu) in [("stl", "s7-300"), ("plcopen", "s7-1200")] {
        let output = plcc(folder, &["convert", "a.scl", "--to", notation, "--cpu", cpu]);
        let found = format!("{}{}", text(&output.stdout), text(&output.stderr));
        let lines = |part: &str| found.lines().filter(|line| line.contains(part)).count();
        assert_eq!((lines("// REGION"), lines("// END_REGION")), (2, 2), "{found}");
    }
}

/// A region that ends a network stays inside it.
#[test]
fn regions_of_networks_stay() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "ORGANIZATION_BLOCK Main\n    { S7_Language := \"SCL\" }\n    NETWORK\n        REGION lamps\n        \
                  %Q0.0 := TRUE;\n        END_REGION\n        // end\n    END_NETWORK\n    // between\n    \
                  { S7_Language := \"SCL\" }\n    NETWORK\n        %Q0.1 := TRUE;\n    END_NETWORK\nEND_ORGANIZATION_BLOCK\n";
    fs::write(folder.join("a.s7dcl"), source).expect("the folder can be written");
    let output = plcc(folder, &["convert", "a.s7dcl", "--to", "sd"]);
    assert_eq!(text(&output.stdout), source, "{}", text(&output.stderr));
}

/// Elements are spelt as their author did, and pins that nothing is connected to are shown.
#[test]
fn documents_come_back_as_they_were() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION_BLOCK Line\n    VAR_INPUT\n        a, b : Bool;            // of both\n    END_VAR\n    \
                  VAR\n        one, \"two 2\", \"IF\" : Int := 5;\n        t : TON_TIME;\n    END_VAR\n    \
                  { S7_Language := \"LAD\" }\n    NETWORK\n        \
                  RUNG wire#powerrail  Contact( #a )  { S7_Templates := \"time_type := Time\" }  #t.TON( pt := T#2s, et => )  \
                  Coil( #b )  END_RUNG\n        \
                  RUNG wire#powerrail  Contact( #b )  S_CU( counter := %C3, pv := C#12, r := #a, cv => %MW12, cv_bcd => )  \
                  I_Coil( #b )  END_RUNG\n    END_NETWORK\nEND_FUNCTION_BLOCK\n";
    fs::write(folder.join("a.s7dcl"), source).expect("the folder can be written");
    let output = plcc(folder, &["convert", "a.s7dcl", "--to", "sd"]);
    assert_eq!(text(&output.stdout), source, "{}", text(&output.stderr));
    let source = "FUNCTION_BLOCK Gates\n    VAR\n        left, right : _.Valve;\n        osc : TON_TIME;\n        e, t : Bool;\n    \
                  END_VAR\n    { S7_Language := \"FBD\" }\n    NETWORK\n        RUNG #e  A()  S_Coil( #t )  END_RUNG\n        \
                  RUNG #t  { S7_Templates := \"time_type := Time\" }  NOT  #osc.TON( pt := T#1s, et => )  Coil( #t )  END_RUNG\n        \
                  RUNG #t  P_Coil( operand := #e, bit := %M0.0 )  END_RUNG\n        \
                  RUNG #t  A()  Inc( %MW2 )  Return( #t )  END_RUNG\n    END_NETWORK\nEND_FUNCTION_BLOCK\n";
    fs::write(folder.join("gates.s7dcl"), source).expect("the folder can be written");
    let output = plcc(folder, &["convert", "gates.s7dcl", "--to", "sd"]);
    assert_eq!(text(&output.stdout), source, "{}", text(&output.stderr));
    // Gates have names of their own: a comparison is spelt as in the language that it is drawn in.
    let source = "FUNCTION F : Void\n    VAR_INPUT\n        a, b : Int;\n    END_VAR\n    \
                  { S7_Language := \"LAD\" }\n    NETWORK\n        \
                  RUNG wire#powerrail  { S7_Templates := \"SrcType := Int\" }  GT_Contact( in1 := #a, in2 := #b )  \
                  Coil( %Q0.0 )  END_RUNG\n    END_NETWORK\nEND_FUNCTION\n";
    fs::write(folder.join("b.s7dcl"), source).expect("the folder can be written");
    let output = plcc(folder, &["convert", "b.s7dcl", "--to", "fbd"]);
    let found = text(&output.stdout);
    assert!(found.contains(" GT( in1 := #a, in2 := #b )") && found.contains("a, b : Int;"), "{found}");
}

/// The comments, regions and pragmas of an export in XML are in what is made of it.
#[test]
fn comments_of_exports_stay() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "//@ cpu s7-1200\nFUNCTION \"F\" : VOID\nVAR_TEMP\n    n : INT;\nEND_VAR\nBEGIN\n    // first\n    REGION start\n    \
                  #n := 1; // one\n    IF #n = 1 THEN\n        // inside\n        #n := 2;\n    END_IF;\n    END_REGION\n    // last\n\
                  END_FUNCTION\n\nFUNCTION \"G\" : VOID\nVAR_TEMP\n    n : INT;\nEND_VAR\nBEGIN\n    // other\n    #n := 1;\n\
                  END_FUNCTION\n";
    fs::write(folder.join("a.scl"), source).expect("the folder can be written");
    let convert = |from: &str, to: &str| {
        let output = plcc(folder, &["convert", from, "--to", to]);
        assert_eq!(output.status.code(), Some(0), "{from} to {to}: {}", text(&output.stderr));
        text(&output.stdout).to_string()
    };
    let first = convert("a.scl", "xml");
    fs::write(folder.join("a.xml"), &first).expect("the folder can be written");
    assert_eq!(convert("a.xml", "xml"), first);
    let words = |text: &str| {
        let lines = text.lines().filter(|line| !line.trim().is_empty());
        lines.map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect::<Vec<_>>()
    };
    let scl = convert("a.xml", "scl");
    assert_eq!(words(&scl), words(source));
    // What stands at the end of a body is indented as its statements are.
    assert!(scl.contains("\n    REGION start\n"), "{scl}");
    assert!(scl.contains("\n    END_REGION\n    // last\nEND_FUNCTION\n"), "{scl}");
    let stl = "FUNCTION \"F\" : VOID\nBEGIN\nNETWORK\n      SET; // one\n      // two\n      SAVE;\nEND_FUNCTION\n";
    fs::write(folder.join("b.stl"), stl).expect("the folder can be written");
    let first = convert("b.stl", "xml");
    fs::write(folder.join("b.xml"), &first).expect("the folder can be written");
    assert_eq!(convert("b.xml", "xml"), first);
}

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
        let folder = tempfile::tempdir().expect("a temporary folder");
        fs::write(folder.path().join(name), source).expect("the folder can be written");
        let made = plcc(folder.path(), &["convert", name, "--to", "xml", "-o", "made.xml"]);
        assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
        let cpu = if name == "a.scl" { "1511-1" } else { "315-2DP" };
        let tested = plcc(folder.path(), &["test", "made.xml", "--cpu", cpu]);
        let document = fs::read_to_string(folder.path().join("made.xml")).expect("it is written");
        assert!(text(&tested.stdout).contains(set), "{}{}{document}", text(&tested.stdout), text(&tested.stderr));
    }
    // A block with this number may be another one.
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("a file");
    write("a.stl", "FUNCTION FC 1 : VOID\nBEGIN\nNETWORK\n      CALL FC 105;\nEND_FUNCTION\n");
    write("a.sdf", "\"Motor\",\"FC 105\",\"FC 105\",\"\"\n");
    let made = plcc(folder.path(), &["convert", "a.stl", "a.sdf", "--to", "xml"]);
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
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    fs::create_dir(folder.join("plant")).expect("the folder can be made");
    for (name, text) in [("blocks.stl", BLOCKS), ("main.s7dcl", MAIN), ("symbols.sdf", SYMBOLS)] {
        fs::write(folder.join("plant").join(name), text).expect("the folder can be written");
    }
    let made = plcc(folder, &["convert", "plant", "--to", "xml", "-o", "made/", "--cpu", "315-2DP"]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    let read = |name: &str| fs::read_to_string(folder.join("made").join(name)).expect("it is written");
    let (blocks, main) = (read("blocks.xml"), read("main.xml"));
    for found in ["<Name>Motor</Name>", "<Name>Motor_DB</Name>", "<Name>Calc</Name>", "<Number>10</Number>"] {
        assert!(blocks.contains(found), "{found} in\n{blocks}");
    }
    assert!(blocks.contains("<InstanceOfName>Motor</InstanceOfName>"), "{blocks}");
    assert!(!blocks.contains("FB_10") && !blocks.contains("FC_5"), "{blocks}");
    for found in [r#"<CallInfo Name="Motor" BlockType="FB">"#, r#"<CallInfo Name="Calc" BlockType="FC">"#] {
        assert!(main.contains(found), "{found} in\n{main}");
    }
    let checked = plcc(folder, &["check", "made", "--cpu", "315-2DP"]);
    assert_eq!(checked.status.code(), Some(0), "{}", text(&checked.stderr));

    // In STL a call names the function block and its data block.
    let made = plcc(folder, &["convert", "plant", "--to", "stl", "-o", "list/", "--cpu", "315-2DP"]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    let main = fs::read_to_string(folder.join("list/main.stl")).expect("it is written");
    assert!(main.contains("CALL  FB 10, \"Motor_DB\" ("), "{main}");
    let checked = plcc(folder, &["check", "list", "--cpu", "315-2DP"]);
    assert_eq!(checked.status.code(), Some(0), "{}", text(&checked.stderr));
}

/// The number decides when an organization block with a name of its own runs.
#[test]
fn numbers_of_documents_stay() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "{ S7_BlockNumber := \"35\"; S7_Version := \"0.1\" }\nORGANIZATION_BLOCK Control\n    \
                  { S7_Language := \"LAD\" }\n    NETWORK\n        RUNG wire#powerrail  Contact( %I0.0 )  Coil( %Q0.0 )  END_RUNG\n    \
                  END_NETWORK\nEND_ORGANIZATION_BLOCK\n";
    fs::write(folder.join("a.s7dcl"), source).expect("the folder can be written");
    let made = plcc(folder, &["convert", "a.s7dcl", "--to", "stl", "--cpu", "315-2DP", "-o", "b.stl"]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    let list = fs::read_to_string(folder.join("b.stl")).expect("it is written");
    assert!(list.contains("{ S7_BlockNumber := '35' }\n"), "{list}");
    let main = "ORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\n      SET;\nEND_ORGANIZATION_BLOCK\n";
    fs::write(folder.join("main.stl"), main).expect("the folder can be written");
    let found = plcc(folder, &["xref", "b.stl", "main.stl", "--cpu", "315-2DP"]);
    let found = format!("{}{}", text(&found.stdout), text(&found.stderr));
    assert!(found.contains("OB35 (Control)"), "{found}");
}

/// Names of parameters with blanks are in quotes.
#[test]
fn parameters_of_blocks_have_any_names() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION F : Void\n    { S7_Language := \"LAD\" }\n    NETWORK\n        \
                  RUNG wire#powerrail  \"Other FC\"( \"a b\" := 1, \"c/d\" => %MW2, e := %MW4 )  END_RUNG\n    END_NETWORK\nEND_FUNCTION\n";
    fs::write(folder.join("a.s7dcl"), source).expect("the folder can be written");
    assert_eq!(text(&plcc(folder, &["convert", "a.s7dcl", "--to", "sd"]).stdout), source);
    // Words of the language are names in quotes, as their author wrote them.
    let source = "FUNCTION \"F\" : VOID\nVAR_INPUT\n    \"END\" : INT;\n    \"Größe\" : INT;\n    Länge : INT;\nEND_VAR\nBEGIN\n    \
                  \"DB 1\".\"a b\"[#\"END\"].\"if\" := #\"Größe\" + #Länge;\nEND_FUNCTION\n";
    fs::write(folder.join("a.scl"), source).expect("the folder can be written");
    assert_eq!(text(&plcc(folder, &["convert", "a.scl", "--to", "scl"]).stdout), source);
    let source = "DATA_BLOCK \"D\"\nSTRUCT\n    \"IF\" : INT;\n    x : STRUCT\n        \"FOR\" : INT;\n    END_STRUCT;\nEND_STRUCT;\n\
                  BEGIN\n    \"IF\" := 5;\n    x.\"FOR\" := 6;\nEND_DATA_BLOCK\n";
    fs::write(folder.join("d.scl"), source).expect("the folder can be written");
    assert_eq!(text(&plcc(folder, &["convert", "d.scl", "--to", "scl"]).stdout), source);
    // XML has no quotes.
    plcc(folder, &["convert", "d.scl", "--to", "xml", "--cpu", "s7-1500", "-o", "d.xml"]);
    let found = text(&plcc(folder, &["convert", "d.xml", "--to", "scl"]).stdout);
    assert!(found.contains("\n    \"IF\" : INT") && found.contains("\n        \"FOR\" : INT"), "{found}");
}

/// `"tag":P` is an input or output itself, not a tag with this name.
#[test]
fn direct_access_stays_direct() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let scl = "FUNCTION \"F\" : VOID\nVAR_TEMP\n    x : BOOL;\nEND_VAR\nBEGIN\n    #x := \"Tag\":P;\n    \
               #x := \"Motor\".run:P;\n    \"Out\":P := #x;\nEND_FUNCTION\n";
    let ladder = "FUNCTION F : Void\n    { S7_Language := \"LAD\" }\n    NETWORK\n        \
                  RUNG wire#powerrail  Contact( \"Tag\":P )  Coil( \"Motor\".run:P )  END_RUNG\n    END_NETWORK\nEND_FUNCTION\n";
    fs::write(folder.join("a.scl"), scl).expect("the folder can be written");
    fs::write(folder.join("b.s7dcl"), ladder).expect("the folder can be written");
    let convert = |name: &str, to: &str| {
        let output = plcc(folder, &["convert", name, "--to", to]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    assert_eq!(convert("a.scl", "scl"), scl);
    assert_eq!(convert("b.s7dcl", "sd"), ladder);
    for (name, back) in [("a.scl", "scl"), ("b.s7dcl", "sd")] {
        let document = convert(name, "xml");
        for component in ["Tag", "run"] {
            let wanted = format!("<Component Name=\"{component}\" SimpleAccessModifier=\"Periphery\"/>");
            assert!(document.contains(&wanted), "{wanted} in\n{document}");
        }
        fs::write(folder.join("c.xml"), document).expect("the folder can be written");
        let again = convert("c.xml", back);
        assert!(again.contains("\"Tag\":P") && again.contains("\"Motor\".run:P"), "{again}");
    }
    let list = convert("b.s7dcl", "stl");
    assert!(list.contains("A     \"Tag\":P;") && list.contains("=     \"Motor\".run:P;"), "{list}");
}

/// Start values of all types that STL has constants of.
#[test]
fn start_values_of_stl_become_xml() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "DATA_BLOCK DB 1\nSTRUCT\n  q : DATE_AND_TIME := DT#2001-2-3-4:5:6.789;\n  h : S5TIME := S5T#1M2S;\n  \
                  r : ARRAY [1..4 ] OF INT := 1, 2 (5), 9;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\nORGANIZATION_BLOCK OB 1\n\
                  BEGIN\nNETWORK\n      SET;\n//@ assert DB1.DBD 0 == DW#16#0102_0304\n//@ assert DB1.DBW 12 == 5\n\
                  END_ORGANIZATION_BLOCK\n";
    fs::write(folder.join("a.stl"), source).expect("the folder can be written");
    let made = plcc(folder, &["convert", "a.stl", "--to", "xml", "-o", "a.xml"]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    let tested = plcc(folder, &["test", "a.xml", "--cpu", "315-2DP"]);
    let said = format!("{}{}", text(&tested.stdout), text(&tested.stderr));
    assert!(said.contains("2 passed, 0 failed"), "{said}");
    // XML has the values of arrays one by one, STL as a list.
    let back = text(&plcc(folder, &["convert", "a.xml", "--to", "stl"]).stdout);
    assert!(back.contains("r : ARRAY[1..4] OF INT := 1, 2(5), 9;"), "{back}");
}

/// Comments of a block and of a structure are not those of the variable after them.
#[test]
fn comments_of_structures_stay_with_them() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "TYPE \"T\"\nVERSION : 0.1\n//about T\n   STRUCT\n      a : Int;   // of a\n      // above the limits\n      \
                  limits : Struct   // of the limits\n         low : Int;\n         high : Int;   // of high\n      \
                  END_STRUCT;\n   END_STRUCT;\nEND_TYPE\n";
    fs::write(folder.join("a.scl"), source).expect("the folder can be written");
    for to in ["xml", "plcopen"] {
        let made = plcc(folder, &["convert", "a.scl", "--to", to, "--cpu", "1511-1", "-o", "a.xml"]);
        assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
        let document = fs::read_to_string(folder.join("a.xml")).expect("it is written");
        let member = if to == "xml" { "<Member Name=\"" } else { "<variable name=\"" };
        let of = |name: &str| {
            let at = document.find(&format!("{member}{name}\"")).unwrap_or_else(|| panic!("{name} in\n{document}"));
            let rest = &document[at + member.len()..];
            &rest[..rest.find(member).unwrap_or(rest.len())]
        };
        assert!(!of("low").contains("limits") && of("high").contains("of high"), "{document}");
        for comment in ["about T", "of a", "above the limits", "of the limits", "of high"] {
            assert_eq!(document.matches(comment).count(), 1, "{comment} in\n{document}");
        }
        assert!(!of("a").contains("about T"), "{document}");
    }
}

/// A function of a project has its result at a pin with its own name.
#[test]
fn results_of_functions_of_projects_are_ret_val() {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/plcopen/result-by-name");
    let project = project.display().to_string();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let made = plcc(folder, &["convert", &project, "--to", "stl", "-o", "made/", "--cpu", "s7-1500"]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    let list = fs::read_to_string(folder.join("made/project.stl")).expect("it is written");
    assert!(list.contains("RET_VAL :="), "{list}");
    let checked = plcc(folder, &["check", "made", "--cpu", "s7-1500"]);
    assert_eq!(checked.status.code(), Some(0), "{}", text(&checked.stderr));
}

/// `S` of an instruction list assigns TRUE: what is made of a project is not what stands at its places.
#[test]
fn instruction_lists_of_projects_become_xml() {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/plcopen/instruction-list");
    let project = project.display().to_string();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let made = plcc(folder, &["convert", &project, "--to", "xml", "-o", "made/"]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    let document = fs::read_to_string(folder.join("made/project.xml")).expect("it is written");
    assert!(document.contains("<ConstantValue>TRUE</ConstantValue>") && !document.contains("Text=\"S\""), "{document}");
    let checked = plcc(folder, &["check", "made"]);
    assert_eq!(checked.status.code(), Some(0), "{}", text(&checked.stderr));
}

/// A quote in a text, which XML writes as `&apos;`.
#[test]
fn texts_with_quotes_come_back_from_projects() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION \"F\" : Void\nVAR_TEMP\n  t : String[20];\nEND_VAR\nBEGIN\n  \
                  #t := CONCAT(IN1 := 'It$'s ', IN2 := 'on');\nEND_FUNCTION\n";
    fs::write(folder.join("a.scl"), source).expect("the folder can be written");
    let made = plcc(folder, &["convert", "a.scl", "--to", "plcopen", "--cpu", "1511-1", "-o", "a.xml"]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    let back = text(&plcc(folder, &["convert", "a.xml", "--to", "scl"]).stdout);
    assert!(back.contains("CONCAT(IN1 := 'It$'s ', IN2 := 'on')"), "{back}");
}

/// Comments of statements in an export are in the project as those of a source are.
#[test]
fn comments_of_exports_reach_projects() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "//@ cpu s7-1200\nFUNCTION_BLOCK \"F\"\nVERSION : 0.1\nVAR\n    n : Int;   // of n\nEND_VAR\nBEGIN\n    // first\n    \
                  REGION start\n    #n := 1; // one\n    //@ assert #n == 1\n    IF #n = 1 THEN\n        // inside\n        #n := 2;\n    \
                  END_IF;\n    END_REGION\n    // last\nEND_FUNCTION_BLOCK\nORGANIZATION_BLOCK \"Main\"\nBEGIN\n    // call it\n    \
                  \"F_DB\"();\nEND_ORGANIZATION_BLOCK\nDATA_BLOCK \"F_DB\" \"F\"\nBEGIN\nEND_DATA_BLOCK\n";
    fs::write(folder.join("c.scl"), source).expect("the folder can be written");
    let convert = |from: &str, to: &str| {
        let output = plcc(folder, &["convert", from, "--to", to, "--cpu", "1214C"]);
        assert_eq!(output.status.code(), Some(0), "{from} to {to}: {}", text(&output.stderr));
        text(&output.stdout)
    };
    let project = convert("c.scl", "plcopen");
    for comment in ["// first", "// REGION start", "// one", "// inside", "// last", "// call it", ">of n<"] {
        assert_eq!(project.matches(comment).count(), 1, "{comment} in\n{project}");
    }
    fs::write(folder.join("c.xml"), convert("c.scl", "xml")).expect("the folder can be written");
    assert_eq!(convert("c.xml", "plcopen"), project);
    // From there they come back into the block, although its data block is written first.
    fs::write(folder.join("p.xml"), &project).expect("the folder can be written");
    let scl = convert("p.xml", "scl");
    let body = scl.split("FUNCTION_BLOCK \"F\"").nth(1).and_then(|rest| rest.split("END_FUNCTION_BLOCK").next());
    for comment in ["// first", "// REGION start", "// one", "// inside", "// last"] {
        assert!(body.is_some_and(|body| body.contains(comment)), "{comment} in\n{scl}");
        assert_eq!(scl.matches(comment).count(), 1, "{comment} in\n{scl}");
    }
    // Also by way of an export.
    fs::write(folder.join("q.xml"), convert("p.xml", "xml")).expect("the folder can be written");
    let scl = convert("q.xml", "scl");
    for comment in ["// first", "// REGION start", "// one", "// inside", "// last"] {
        assert_eq!(scl.matches(comment).count(), 1, "{comment} in\n{scl}");
    }
}

/// Assertions of STL are in the XML where they were, also where a network or a block has nothing else; numbers keep their digits.
#[test]
fn assertions_of_stl_become_xml() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "//@ cpu s7-1500\nFUNCTION \"Take\" : VOID\nVAR_INPUT\n  share : LREAL;\nEND_VAR\nBEGIN\n\
                  //@ assert #share == 0.123456789\nEND_FUNCTION\nORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\n\
                  //@ assert MW10 == 0\n      L     1;\n      T     MW 10;\n      CALL  \"Take\" (share := 0.123456789);\nNETWORK\n\
                  //@ assert MW10 == 1\n      T     MW 12;\n// the end\nNETWORK\n//@ assert MW12 == 1\nEND_ORGANIZATION_BLOCK\n";
    fs::write(folder.join("a.stl"), source).expect("the folder can be written");
    let made = plcc(folder, &["convert", "a.stl", "--to", "xml", "-o", "a.xml"]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    for name in ["a.stl", "a.xml"] {
        let tested = plcc(folder, &["test", name]);
        let said = format!("{}{}", text(&tested.stdout), text(&tested.stderr));
        assert!(said.contains("4 passed, 0 failed"), "{name}: {said}");
    }
}

/// In LAD and FBD assertions stand between networks: a network of STL with assertions among its statements is divided.
#[test]
fn assertions_divide_networks() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "//@ cpu 315-2DP\nORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\nTITLE =two values\n      L     W#16#1234\n      T     MW 10\n\
                  //@ assert MB 10 == B#16#12\n//@ assert MB 11 == B#16#34\n      AN    M 20.0\n      =     M 20.1\n      =     M 20.2\n\
                  //@ assert MB 20 == B#16#06\n// the end\n      SET\n      S     M 30.0\nEND_ORGANIZATION_BLOCK\n";
    fs::write(folder.join("a.stl"), source).expect("the folder can be written");
    for to in ["lad", "fbd"] {
        let name = format!("{to}.s7dcl");
        let made = plcc(folder, &["convert", "a.stl", "--to", to, "-o", &name]);
        assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
        let tested = plcc(folder, &["test", &name]);
        let written = fs::read_to_string(folder.join(&name)).expect("it is written");
        let said = format!("{}{}", text(&tested.stdout), text(&tested.stderr));
        assert!(said.contains("3 passed, 0 failed"), "{said}{written}");
        assert_eq!(written.matches("S7_NetworkTitle").count(), 1, "{written}");
    }
    // The signal goes on after the assertion.
    fs::write(folder.join("b.stl"), source.replace("      SET\n", "")).expect("the folder can be written");
    let made = plcc(folder, &["convert", "b.stl", "--to", "lad", "-o", "b.s7dcl"]);
    assert!(text(&made.stderr).contains("stands inside its network"), "{}", text(&made.stderr));
    // Networks have no registers.
    fs::write(folder.join("c.stl"), source.replace("MB 20 == B#16#06", "STW.RLO == 1"))
        .expect("the folder can be written");
    let made = plcc(folder, &["convert", "c.stl", "--to", "fbd", "-o", "c.s7dcl"]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    assert!(text(&made.stderr).contains("this assertion checks a register"), "{}", text(&made.stderr));
}

/// The forms in which a counter has its value, and a flip-flop its operand.
#[test]
fn counters_and_flip_flops_have_their_usual_form() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "      A     M 1.0\n      L     C#10\n      S     C 1\n      A     M 1.1\n      S     M 2.0\n      \
                  A     M 1.2\n      R     M 2.0\n      A     M 2.0\n      =     M 2.1\n";
    fs::write(folder.join("a.stl"), source).expect("the folder can be written");
    let made = plcc(folder, &["convert", "a.stl", "--to", "lad", "-o", "a.s7dcl"]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    let drawn = fs::read_to_string(folder.join("a.s7dcl")).expect("it is written");
    for found in ["SC_Coil( counter := %C1, pv := C#10 )", "S_SR( operand := %M2.0, r1 := "] {
        assert!(drawn.contains(found), "{found} in\n{drawn}");
    }
    let list = text(&plcc(folder, &["convert", "a.s7dcl", "--to", "stl"]).stdout);
    assert!(list.contains("      L     C#10;\n      S     C 1;\n"), "{list}");
}

/// What follows the last statement is still in the block, also where that has no header.
#[test]
fn comments_at_the_end_stay() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let plain = "      SET\n      =     M 0.0\n//@ assert M 0.0 == 1\n// the end\n";
    let framed = "ORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\n      SET\n      =     M 0.0\n//@ assert M 0.0 == 1\n\
                  END_ORGANIZATION_BLOCK\n// the end\n";
    for (name, source) in [("plain", plain), ("framed", framed)] {
        fs::write(folder.join(format!("{name}.stl")), source).expect("the folder can be written");
        for (to, extension) in [("xml", "xml"), ("lad", "s7dcl"), ("fbd", "s7dcl"), ("stl", "stl")] {
            let made = format!("{name}-{to}.{extension}");
            let output = plcc(folder, &["convert", &format!("{name}.stl"), "--to", to, "-o", &made]);
            assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
            let written = fs::read_to_string(folder.join(&made)).expect("it is written");
            assert!(written.contains("the end"), "{written}");
            let tested = plcc(folder, &["test", &made, "--cpu", "315-2DP"]);
            let said = format!("{}{}", text(&tested.stdout), text(&tested.stderr));
            assert!(said.contains("1 passed, 0 failed"), "{said}{written}");
        }
    }
}

/// A number at a LREAL stays a LREAL; with more digits than a constant of a statement has, it is refused.
#[test]
fn long_numbers_in_networks() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "//@ cpu s7-1500\nFUNCTION \"Take\" : VOID\nVAR_INPUT\n  share : LREAL; ratio : REAL;\nEND_VAR\nBEGIN\n\
                  END_FUNCTION\nORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\n\
                  \x20     CALL  \"Take\" (share := 0.1, ratio := 0.1);\nEND_ORGANIZATION_BLOCK\n";
    fs::write(folder.join("a.stl"), source).expect("the folder can be written");
    let made = plcc(folder, &["convert", "a.stl", "--to", "lad"]);
    let written = text(&made.stdout);
    assert!(written.contains("share := LREAL#0.1, ratio := REAL#0.1"), "{written}{}", text(&made.stderr));
    fs::write(folder.join("b.stl"), source.replace("0.1,", "0.123456789,")).expect("the folder can be written");
    let made = plcc(folder, &["convert", "b.stl", "--to", "lad"]);
    assert_eq!(made.status.code(), Some(3), "{}", text(&made.stdout));
    assert!(text(&made.stderr).contains("more than six digits at a LREAL"), "{}", text(&made.stderr));
}

/// A document of SIMATIC SD comes back as the same text up to white space, with types in the letters of its author.
#[test]
fn types_keep_the_letters_of_their_author() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = r#"TYPE
    Point : STRUCT
        x : Array[0..15] of Bool;
        name : String[8];
    END_STRUCT;
END_TYPE

FUNCTION_BLOCK Lamp
    VAR_INPUT
        start : Bool;
        place : Point;
        wait : TON_TIME;
        names : Array[0..3] of String[8];
    END_VAR
    { S7_Language := "LAD" }
    NETWORK
        RUNG wire#powerrail  Contact( #start )  Coil( %Q0.0 )  END_RUNG
    END_NETWORK
END_FUNCTION_BLOCK

DATA_BLOCK Lamp_DB : Lamp
END_DATA_BLOCK

FUNCTION Nothing : Void
    { S7_Language := "FBD" }
    NETWORK
        RUNG %I0.0  Coil( %Q0.1 )  END_RUNG
    END_NETWORK
END_FUNCTION
"#;
    fs::write(folder.join("a.s7dcl"), source).expect("the folder can be written");
    let made = plcc(folder, &["convert", "a.s7dcl", "--to", "sd"]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    let written = text(&made.stdout);
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert_eq!(words(&written), words(source), "{written}");
    // Names of types in other sources have the letters of the TIA Portal.
    let stl = "FUNCTION FC 1 : VOID\nVAR_TEMP\n  n : DINT; t : ARRAY [0..3] OF WORD;\nEND_VAR\nBEGIN\nNETWORK\n      SET\n      =     M 0.0\n\
               END_FUNCTION\n";
    fs::write(folder.join("b.stl"), stl).expect("the folder can be written");
    let written = text(&plcc(folder, &["convert", "b.stl", "--to", "lad"]).stdout);
    assert!(written.contains("n : DInt;") && written.contains("t : Array[0..3] of Word;"), "{written}");
}

/// Statements without a header are the block that the name of their file states, in other notations too.
#[test]
fn names_of_files_name_blocks() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    fs::create_dir(folder.join("parts")).expect("the folder can be written");
    let write = |name: &str, text: &str| fs::write(folder.join("parts").join(name), text).expect("a file");
    write("FC19_Count.awl", "      A     I 0.0\n      =     Q 4.0\n");
    write("OB1_MAIN.awl", "      CALL  FC 19\n");
    let read = |name: &str| fs::read_to_string(folder.join(name)).unwrap_or_default();
    for (to, ending) in [("xml", "xml"), ("lad", "s7dcl")] {
        let out = format!("{to}/");
        let made = plcc(folder, &["convert", "parts", "--to", to, "-o", &out]);
        assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
        let checked = plcc(folder, &["check", to]);
        let written = read(&format!("{to}/FC19_Count.{ending}"));
        assert_eq!(checked.status.code(), Some(0), "{}{written}", text(&checked.stderr));
        assert!(written.contains("<Name>FC_19</Name>") || written.contains("FUNCTION FC19 : Void"), "{written}");
    }
}

/// The comment of a network is in the texts of the networks, and not once more before it.
#[test]
fn comments_of_networks_are_written_once() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "FUNCTION FC 1 : VOID\nBEGIN\nNETWORK\nTITLE = lamps\n// both\n      A     I 0.0;\n      // inside\n      =     Q 0.0;\n\
                  NETWORK\n// both\n      A     I 0.1;\n      =     Q 0.1;\nEND_FUNCTION\n";
    fs::write(folder.join("a.stl"), source).expect("the folder can be written");
    let output = plcc(folder, &["convert", "a.stl", "--to", "lad", "-o", "a.s7dcl"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let read = |name: &str| fs::read_to_string(folder.join(name)).expect("it is written");
    let (networks, texts) = (read("a.s7dcl"), read("a.s7res"));
    let count = |text: &str, part: &str| text.matches(part).count();
    assert_eq!((count(&networks, "both"), count(&networks, "// inside")), (0, 1), "{networks}");
    assert_eq!((count(&networks, "S7_NetworkComment"), count(&texts, "both")), (2, 2), "{networks}\n{texts}");
}

/// What to do first with a block that is not in networks depends on its language.
#[test]
fn blocks_without_networks_say_what_comes_first() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    fs::write(folder.join("a.scl"), "FUNCTION \"F\" : VOID\nBEGIN\n  RETURN;\nEND_FUNCTION\n").expect("a file");
    let output = plcc(folder, &["convert", "a.scl", "--to", "lad"]);
    assert_eq!(output.status.code(), Some(3));
    let said = text(&output.stderr);
    assert!(said.contains("write it with `--to stl` first, and that with `--to lad`"), "{said}");
}

/// LAD, SCL, data blocks and tags as one project, with what the format does not have.
#[test]
fn a_program_becomes_one_project_of_plcopen() {
    expect(&["convert", "filler", "--to", "plcopen"], "filler.plcopen");
}

#[test]
fn what_plcopen_does_not_have_is_refused_with_its_line() {
    let output = plcc(&programs(), &["convert", "startup.scl", "--to", "plcopen"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(output.stdout.is_empty(), "nothing is written");
    let path = programs().join("startup.plcopen");
    let found = text(&output.stderr);
    if std::env::var_os("UPDATE_EXPECT").is_some_and(|value| value != "0") {
        fs::write(&path, &found).expect("the tree can be written");
    }
    assert_eq!(found, fs::read_to_string(&path).unwrap_or_default(), "UPDATE_EXPECT=1 renews it; read the diff");
}

#[test]
fn sources_of_the_s7_200_have_both_mnemonics() {
    expect(&["convert", "press", "--to", "awl", "--mnemonics", "de"], "press.german");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let german = programs().join("press.german");
    fs::copy(german, folder.path().join("main.awl")).expect("the folder can be written");
    let back = plcc(folder.path(), &["convert", "main.awl", "--to", "awl", "--mnemonics", "en"]);
    let source = fs::read_to_string(programs().join("press/main.awl")).expect("it is there");
    assert_eq!(text(&back.stdout), source);
}

#[test]
fn other_notations_of_the_s7_200_are_refused_with_what_to_do() {
    for (to, says) in [("lad", "`plcc view` draws them"), ("stl", "--report s7-1200")] {
        let output = plcc(&programs(), &["convert", "press", "--to", to]);
        assert_eq!(output.status.code(), Some(3));
        assert!(text(&output.stderr).contains(says), "{}", text(&output.stderr));
        assert!(output.stdout.is_empty());
    }
    let output = plcc(&programs(), &["convert", "packer", "--to", "awl"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(text(&output.stderr).contains("only sources of the S7-200"), "{}", text(&output.stderr));
}

/// Statements of STL have no steps.
#[test]
fn charts_are_refused_as_stl() {
    let chart = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/graph/activation_order.gr7");
    let output = plcc(&programs(), &["convert", &chart.to_string_lossy(), "--to", "stl"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(text(&output.stderr).contains("STL has no form for a chart of GRAPH"), "{}", text(&output.stderr));
}

/// Blocks in ST with their comments, and beside them the variables that have addresses; other languages are left out.
#[test]
fn st_of_plcopen_becomes_scl() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = folder.path().join("bottles.scl");
    let written = plcc(&programs(), &["convert", "bottles.xml", "--to", "scl", "-o", &output.to_string_lossy()]);
    assert_eq!(written.status.code(), Some(0), "{}", text(&written.stderr));
    let read = |path: &Path| fs::read_to_string(path).expect("plcc has written it");
    let found = format!("{}{}{}", text(&written.stderr), read(&output), read(&output.with_extension("sdf")));
    let path = programs().join("bottles.scl.expected");
    if std::env::var_os("UPDATE_EXPECT").is_some_and(|value| value != "0") {
        fs::write(&path, &found).expect("the tree can be written");
    }
    assert_eq!(found, fs::read_to_string(&path).unwrap_or_default(), "UPDATE_EXPECT=1 renews it; read the diff");
    let printed = plcc(&programs(), &["convert", "bottles.xml", "--to", "scl"]);
    assert_eq!(printed.status.code(), Some(2));
    assert!(text(&printed.stderr).contains("(`.sdf`): name the output with `-o`"), "{}", text(&printed.stderr));
}

/// What their assertions say of projects in ST and IL holds for the sources in SCL.
#[test]
fn st_of_plcopen_does_the_same_as_scl() {
    for (name, assertions) in [("words", 25), ("instruction-list", 11)] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/plcopen").join(name);
        let settings = fs::read_to_string(project.join("plc.toml")).expect("it is there");
        let settings = settings.replace("project.xml", "project.scl");
        fs::write(folder.path().join("plc.toml"), settings).expect("the folder can be written");
        let (from, to) = (project.join("project.xml"), folder.path().join("project.scl"));
        let arguments =
            ["convert", &from.to_string_lossy(), "--to", "scl", "-o", &to.to_string_lossy()].map(String::from);
        let written = plcc(folder.path(), &arguments.each_ref().map(String::as_str));
        assert_eq!(written.status.code(), Some(0), "{name}: {}", text(&written.stderr));
        let tested = plcc(folder.path(), &["test", "."]);
        let said = format!("{}{}", text(&tested.stdout), text(&tested.stderr));
        assert!(said.contains(&format!("{assertions} passed, 0 failed")), "{name}: {said}");
    }
}

#[test]
fn reports_say_what_carries_over() {
    expect(&["convert", "press", "--report", "s7-1200"], "press.report");
    expect(&["convert", "packer", "--report", "s7-1500"], "packer.report");
}

#[test]
fn a_report_is_refused_where_there_is_none() {
    for (program, family, says) in [
        ("press", "s7-1500", "goes to an S7-1200"),
        ("packer", "s7-1200", "goes to an S7-1500"),
        ("packer", "s7-9000", "does not know the CPU"),
    ] {
        let output = plcc(&programs(), &["convert", program, "--report", family]);
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output.stderr).contains(says), "{}", text(&output.stderr));
    }
}

/// The notation that is written belongs to a command line with one of them only.
#[test]
fn a_single_source_goes_into_a_folder_whose_name_ends_with_a_slash() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("lamp.stl"), "      A     I 0.0\n      =     Q 4.0\n")
        .expect("the folder can be written");
    let output = plcc(folder.path(), &["convert", "lamp.stl", "--to", "stl", "--mnemonics", "de", "-o", "german/"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let written = fs::read_to_string(folder.path().join("german/lamp.stl")).expect("it is written");
    assert!(written.contains("E 0.0"), "{written}");
}

/// `SE` starts an on-delay in one set and an extended pulse in the other.
#[test]
fn a_source_that_does_not_show_its_mnemonics_has_those_of_the_others() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let write = |name: &str, source: &str| fs::write(folder.join(name), source).expect("the folder can be written");
    let delay = "      O     M 0.0\n      L     S5T#1S\n      SE    T 1\n";
    write("delay.awl", &format!("FUNCTION FC 2 : VOID\nBEGIN\n{delay}END_FUNCTION\n"));
    let main = |set: &str, and: &str, status: u8| {
        let code = "      SET\n      =     M 0.0\n      UC    FC 2\n";
        let check = format!("      {and}     T 1\n//@ assert STW.RLO == {status}\n");
        write("main.awl", &format!("ORGANIZATION_BLOCK OB 1\nBEGIN\n{code}{check}END_ORGANIZATION_BLOCK\n"));
        let output = plcc(folder, &["test", "main.awl", "delay.awl"]);
        assert_eq!(output.status.code(), Some(0), "{set}: {}{}", text(&output.stdout), text(&output.stderr));
    };
    main("German", "U", 0);
    main("international", "A", 1);
}

#[test]
fn one_conversion_at_a_time() {
    for arguments in [&["convert", "plant"][..], &["convert", "plant", "--to", "stl", "--absolute"]] {
        assert_eq!(plcc(&programs(), arguments).status.code(), Some(2), "{arguments:?}");
    }
}

/// A converted folder is a project of its own: with its tables, its settings, and the CPU that the sources implied.
#[test]
fn converted_folders_are_projects() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("the folder can be written");
        fs::write(path, text).expect("the folder can be written");
    };
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap_or_default();
    let run = |arguments: &[&str]| {
        let output = plcc(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
    };
    let main =
        "ORGANIZATION_BLOCK OB 1\nBEGIN\nNETWORK\n      A     \"start\";\n      CC    FC 1;\nEND_ORGANIZATION_BLOCK\n";
    let lamp = "FUNCTION FC 1 : VOID\nBEGIN\nNETWORK\n      A     \"start\";\n      =     Q 4.0;\nEND_FUNCTION\n";
    write("plant/src/main.stl", main);
    write("plant/src/lamp.stl", lamp);
    write("plant/names.sdf", "\"start\",\"I 0.0\",\"BOOL\",\"a button\"\n");
    let settings = "name = \"lamps\"\nsources = [\n  \"src\",\n]\nsymbols = [\"names.sdf\"]\ncpu = \"315-2DP\"\nmnemonics = \"en\"\n";
    write("plant/plc.toml", settings);
    run(&["convert", "plant", "--to", "lad", "-o", "lad/"]);
    assert_eq!(read("lad/plc.toml"), "name = \"lamps\"\ncpu = \"315-2DP\"\n");
    assert_eq!(read("lad/names.sdf"), read("plant/names.sdf"));
    run(&["check", "lad", "--deny", "warnings"]);
    run(&["convert", "plant", "--to", "stl", "--mnemonics", "de", "-o", "german/"]);
    assert_eq!(read("german/plc.toml"), "mnemonics = \"de\"\nname = \"lamps\"\ncpu = \"315-2DP\"\n");
    run(&["check", "german", "--deny", "warnings"]);
    // A second time, settings that are there stay.
    write("lad/plc.toml", "cpu = \"317-2DP\"\n");
    run(&["convert", "plant", "--to", "lad", "-o", "lad/"]);
    assert_eq!(read("lad/plc.toml"), "cpu = \"317-2DP\"\n");
    // Without a project, statement lists are those of an S7-300, and SIMATIC SD is of the TIA Portal.
    fs::remove_file(folder.path().join("plant/plc.toml")).expect("it is there");
    run(&["convert", "plant", "--to", "lad", "-o", "other/"]);
    assert_eq!(read("other/plc.toml"), "cpu = \"s7-300\"\n");
    run(&["check", "other", "--deny", "warnings"]);
}

/// Tags in an export with blocks are beside what is made of the blocks.
#[test]
fn tags_among_exported_blocks_stay() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let export = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/scl/exports/memory-by-tags.xml");
    for (to, name) in [("xml", "a.xml"), ("scl", "b.scl")] {
        let made = plcc(folder.path(), &["convert", &export.to_string_lossy(), "--to", to, "-o", name]);
        assert_eq!(made.status.code(), Some(0), "{to}: {}", text(&made.stderr));
        let tags = Path::new(name).with_extension("tags.xml");
        let tested = plcc(folder.path(), &["test", name, &tags.to_string_lossy()]);
        let said = format!("{}{}", text(&tested.stdout), text(&tested.stderr));
        assert!(said.contains("3 passed, 0 failed"), "{to}: {said}");
    }
}

/// The CPU that a source names in a pragma decides what its statements mean, as it does for `plcc test`.
#[test]
fn scl_for_the_cpu_of_its_pragma_becomes_stl_for_it() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let source = "//@ cpu s7-1500\nORGANIZATION_BLOCK \"Main\"\n{ S7_Optimized_Access := 'TRUE' }\nVERSION : 0.1\nVAR_TEMP\n  w : Word;\n  \
                  i : Int;\n  d : DInt;\nEND_VAR\nBEGIN\n  #w := 16#FFFF;\n  #i := 1;\n  #d := #w + #i;\n  //@ assert #d == L#65536\n\
                  END_ORGANIZATION_BLOCK\n";
    fs::write(folder.join("a.scl"), source).expect("the folder can be written");
    let made = plcc(folder, &["convert", "a.scl", "--to", "stl", "-o", "a.stl"]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    let tested = plcc(folder, &["test", "a.stl"]);
    assert_eq!(tested.status.code(), Some(0), "{}{}", text(&tested.stdout), text(&tested.stderr));
    // Without a pragma a source of the TIA Portal is for an S7-1500, as `plcc test` takes it.
    fs::write(folder.join("c.scl"), source.replace("//@ cpu s7-1500\n", "")).expect("the folder can be written");
    let made = plcc(folder, &["convert", "c.scl", "--to", "stl", "-o", "c.stl"]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    for name in ["c.scl", "c.stl"] {
        let tested = plcc(folder, &["test", name]);
        assert_eq!(tested.status.code(), Some(0), "{name}: {}{}", text(&tested.stdout), text(&tested.stderr));
    }
    // An S7-1200 has no STL.
    fs::write(folder.join("b.scl"), source.replace("s7-1500", "1214C")).expect("the folder can be written");
    let refused = plcc(folder, &["convert", "b.scl", "--to", "stl"]);
    assert_eq!(refused.status.code(), Some(3), "{}", text(&refused.stdout));
    assert!(text(&refused.stderr).contains("S7-1200"), "{}", text(&refused.stderr));
}

#[test]
fn scl_as_stl_does_the_same() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    for name in ["average.scl", "calls.stl"] {
        fs::copy(programs().join(name), folder.join(name)).expect("the folder can be written");
    }
    let before = plcc(folder, &["test", "average.scl", "calls.stl"]);
    assert_eq!(before.status.code(), Some(0), "{}{}", text(&before.stdout), text(&before.stderr));
    let made = plcc(folder, &["convert", "average.scl", "--to", "stl", "-o", "average.stl"]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    let written = fs::read_to_string(folder.join("average.stl")).expect("it was written");
    assert!(written.contains("NETWORK") && !written.contains("END_FOR"), "{written}");
    let after = plcc(folder, &["test", "average.stl", "calls.stl"]);
    assert_eq!(after.status.code(), Some(0), "{}{}", text(&after.stdout), text(&after.stderr));
    // The test can fail.
    let wrong = written.replace("+D", "-D");
    assert_ne!(wrong, written);
    fs::write(folder.join("average.stl"), wrong).expect("the folder can be written");
    assert_eq!(plcc(folder, &["test", "average.stl", "calls.stl"]).status.code(), Some(1));
}

/// Every program of the tests and samples that has symbols: with addresses and back, it stays the same program, which plcc itself
/// compares.
#[test]
fn programs_with_symbols_go_there_and_back() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut changed = 0;
    for project in [
        "samples/edge-equivalence",
        "samples/star-delta",
        "samples/traffic-light",
        "samples/water-tank",
        "tests/run/stl/names",
        "tests/run/scl/s7-1200/tags_beside_functions",
        "tests/xref/station",
        "tests/services/plant",
        "tests/services/line",
    ] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let there = folder.path().join("there");
        fs::create_dir(&there).expect("the folder can be written");
        let project = root.join(project);
        let shown = project.to_string_lossy().into_owned();
        let made = plcc(folder.path(), &["convert", &shown, "--absolute", "-o", "there"]);
        assert_eq!(made.status.code(), Some(0), "{shown}: {}", text(&made.stderr));
        let is_source = |path: &PathBuf| !is_table(path) && !path.ends_with("plc.toml");
        let sources: Vec<PathBuf> = files(&there).into_iter().filter(is_source).collect();
        for source in &sources {
            let name = source.file_name().expect("a file has a name");
            let own = files(&project).into_iter().find(|path| path.file_name() == Some(name));
            changed += usize::from(own.is_some_and(|own| fs::read(own).ok() != fs::read(source).ok()));
        }
        // The folder is a project with its symbols.
        let back = plcc(folder.path(), &["convert", "there", "--symbolic", "-o", "back/"]);
        assert_eq!(back.status.code(), Some(0), "{shown}: {}", text(&back.stderr));
    }
    assert!(changed >= 5, "only {changed} sources had symbols");
}

fn is_table(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "sdf")
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut found: Vec<PathBuf> = entries.filter(|path| path.is_file()).collect();
    found.sort();
    found
}
