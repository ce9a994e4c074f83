//! Start values, instances and attributes of blocks.

use std::path::Path;

use super::{done, expect_passed, folder_with, plcc, read, text};

/// Arrays in an array, whose elements have all indices in XML.
#[test]
fn arrays_in_arrays_keep_their_start_values() {
    const SCL: &str = r#"//@ cpu s7-1500
FUNCTION_BLOCK "Rows"
VERSION : 0.1
VAR
  nested : Array[0..1] of Array[1..2] of Int := [[1, 2], [3, 4]];
  short : Array[0..1] of Array[1..2] of Int := [[5], [6]];
  twice : Array[0..1] of Array[1..2] of Int := [2([7, 8])];
  wide : Array[0..1, 1..2] of Int := [[1, 2], [3, 4]];
END_VAR
BEGIN
  //@ assert #nested[0][2] == 2
  //@ assert #nested[1][1] == 3
  //@ assert #short[0][1] == 5
  //@ assert #short[1][1] == 6
  //@ assert #twice[1][2] == 8
  //@ assert #wide[1, 1] == 3
END_FUNCTION_BLOCK
DATA_BLOCK "Rows_DB" "Rows"
BEGIN
END_DATA_BLOCK
ORGANIZATION_BLOCK "Main"
BEGIN
  "Rows_DB"();
END_ORGANIZATION_BLOCK
"#;
    let folder = folder_with(&[("a.scl", SCL)]);
    for (from, to, made) in [("a.scl", "xml", "a.xml"), ("a.xml", "scl", "b.scl")] {
        done(&folder, &["convert", from, "--to", to, "-o", made]);
        expect_passed(&folder, &[made, "--cpu", "s7-1500"], 6);
    }
}

/// A structure in an array that has only the values of its type.
#[test]
fn arrays_of_structures_have_gaps() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/run/scl/language/start_value_parentheses.scl")
        .display()
        .to_string();
    let folder = folder_with(&[]);
    for (from, to, made) in [(source.as_str(), "xml", "a.xml"), ("a.xml", "scl", "b.scl"), ("a.xml", "sd", "b.s7dcl")] {
        done(&folder, &["convert", from, "--to", to, "-o", made]);
        expect_passed(&folder, &[made], 13);
    }
}

/// `()` at an array is not a start value, as at a structure.
#[test]
fn values_that_stay_are_none_in_xml() {
    let list = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/run/stl/data/structure_start_values.stl");
    let folder = folder_with(&[]);
    done(&folder, &["convert", &list.display().to_string(), "--to", "xml", "-o", "a.xml"]);
    expect_passed(&folder, &["a.xml"], 7);
}

/// The type of a data block in quotes may still be one of the system.
#[test]
fn data_of_timers_are_no_instances_of_function_blocks() {
    const SCL: &str = r#"DATA_BLOCK "Delay" "TON_TIME"
BEGIN
END_DATA_BLOCK
DATA_BLOCK "Pause" "IEC_TIMER"
BEGIN
END_DATA_BLOCK
"#;
    let folder = folder_with(&[("a.scl", SCL)]);
    let written = plcc(&folder, &["convert", "a.scl", "--to", "xml"]);
    let document = text(&written.stdout);
    for name in ["TON_TIME", "IEC_TIMER"] {
        let wanted = format!("<OfSystemLibElement>{name}</OfSystemLibElement>");
        assert!(document.contains(&wanted), "{document}{}", text(&written.stderr));
    }
    assert!(!document.contains("InstanceOfType"), "{document}");
}

/// Such data blocks are instances of the blocks of IEC 61131-3 that are called with them.
#[test]
fn data_of_timers_become_function_blocks_of_projects() {
    const SCL: &str = r#"//@ cpu s7-1500
DATA_BLOCK "Delay" "TON_TIME"
BEGIN
END_DATA_BLOCK
DATA_BLOCK "Pause" "IEC_TIMER"
BEGIN
END_DATA_BLOCK
ORGANIZATION_BLOCK "Main"
VERSION : 0.1
BEGIN
  "Delay".TON(IN := TRUE, PT := T#1h);
  "Pause".TP(IN := TRUE, PT := T#1h);
  //@ assert "Delay".Q == 0
  //@ assert "Pause".Q == 1
END_ORGANIZATION_BLOCK
"#;
    let folder = folder_with(&[("a.scl", SCL)]);
    done(&folder, &["convert", "a.scl", "--to", "plcopen", "-o", "a.xml"]);
    expect_passed(&folder, &["a.xml"], 2);
}

/// The check of types by IEC 61131-3, with which a BYTE is no INT.
#[test]
fn the_iec_check_of_a_block_stays() {
    const SCL: &str = r#"//@ cpu s7-1500
FUNCTION_BLOCK "Strict"
{ S7_Optimized_Access := 'TRUE'; S7_IECCheck := 'TRUE' }
VERSION : 0.1
VAR
  b : Byte;
  i : Int;
END_VAR
BEGIN
  #i := BYTE_TO_INT(#b);
END_FUNCTION_BLOCK
"#;
    let folder = folder_with(&[("a.scl", SCL)]);
    let written = done(&folder, &["convert", "a.scl", "--to", "xml", "-o", "a.xml"]);
    assert!(written.stderr.is_empty(), "{}", text(&written.stderr));
    let document = read(&folder, "a.xml");
    assert!(document.contains("<IsIECCheckEnabled>true</IsIECCheckEnabled>"), "{document}");
    let back = text(&plcc(&folder, &["convert", "a.xml", "--to", "scl"]).stdout);
    assert!(back.contains("S7_IECCheck := 'TRUE'"), "{back}");
}
