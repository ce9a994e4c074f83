//! Sources of the S7-200: their mnemonics, and reports of migrations.

use std::fs;

use super::{expect, folder_with, plcc, programs, text};

/// `Start:I0.0`: Micro/WIN shows a symbol and its address. Other mnemonics change the address alone, and `--absolute` leaves only that.
#[test]
fn symbols_before_their_addresses_stay_with_other_mnemonics() {
    let source = "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nNETWORK 1\nLD     Start:I0.0\nA      \"Stop\":I0.1\n=      Lamp:Q0.0\n\
                  END_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("a.awl", source)]);
    let german = plcc(&folder, &["convert", "a.awl", "--to", "awl", "--mnemonics", "de"]);
    let expected = source.replace("A      ", "U      ").replace(":I0", ":E0").replace(":Q0", ":A0");
    assert_eq!(text(&german.stdout), expected);
    let absolute = plcc(&folder, &["convert", "a.awl", "--absolute"]);
    let expected = source.replace("Start:", "").replace("\"Stop\":", "").replace("Lamp:", "");
    assert_eq!(text(&absolute.stdout), expected);
}

#[test]
fn sources_of_the_s7_200_have_both_mnemonics() {
    expect(&["convert", "press", "--to", "awl", "--mnemonics", "de"], "press.german");
    let folder = folder_with(&[]);
    let german = programs().join("press.german");
    fs::copy(german, folder.path().join("main.awl")).expect("the folder can be written");
    let back = plcc(&folder, &["convert", "main.awl", "--to", "awl", "--mnemonics", "en"]);
    let source = fs::read_to_string(programs().join("press/main.awl")).expect("it is there");
    assert_eq!(text(&back.stdout), source);
}

#[test]
fn other_notations_of_the_s7_200_are_refused_with_what_to_do() {
    for (to, says) in [("lad", "`plcc view` draws them"), ("stl", "--report s7-1200")] {
        let output = plcc(programs(), &["convert", "press", "--to", to]);
        assert_eq!(output.status.code(), Some(3));
        assert!(text(&output.stderr).contains(says), "{}", text(&output.stderr));
        assert!(output.stdout.is_empty());
    }
    let output = plcc(programs(), &["convert", "packer", "--to", "awl"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(text(&output.stderr).contains("only sources of the S7-200"), "{}", text(&output.stderr));
}

/// Subroutines of libraries of Micro/WIN are in no source: a report of a program with missing parts has them.
#[test]
fn a_report_of_a_program_with_missing_parts_has_libraries_of_micro_win() {
    let list = "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nNETWORK\nLD SM0.1\nCALL USS_INIT, 1, 9600, 1, M0.0, VB1\nNETWORK\nLD SM0.0\n\
                CALL MBUS_MSG, M1.0, 2, 0, 40001, 4, &VB100, M2.1, MB8\nEND_ORGANIZATION_BLOCK\n";
    let folder = folder_with(&[("a.awl", list)]);
    let refused = plcc(&folder, &["convert", "a.awl", "--report", "s7-1200"]);
    assert_eq!(refused.status.code(), Some(3));
    assert!(text(&refused.stderr).contains("`--partial`"), "{}", text(&refused.stderr));
    let output = plcc(&folder, &["convert", "a.awl", "--report", "s7-1200", "--partial"]);
    let report = text(&output.stdout);
    assert!(report.contains("  MBUS_MSG          Modbus_Master\n      a.awl:8  CALL MBUS_MSG, "), "{report}");
    assert!(report.contains("  USS_INIT          nothing: USS_Port_Scan has the port and its baud rate\n"), "{report}");
    assert!(!report.contains("\n  CALL "), "{report}");
    assert!(text(&output.stderr).contains("the subroutine `USS_INIT` is not defined"), "{}", text(&output.stderr));
    let other = plcc(&folder, &["convert", "a.awl", "--to", "awl", "--partial"]);
    assert_eq!(other.status.code(), Some(2), "{}", text(&other.stderr));
}
