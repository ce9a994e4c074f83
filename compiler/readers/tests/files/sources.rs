//! Sources of STL and SCL: all mistakes in one run, and which language a file has.

use plcc_diag::FileId;
use plcc_readers::{ReadOptions, parse};
use plcc_syntax::{Language, ast_text};

fn scl() -> ReadOptions<'static> {
    ReadOptions { pragmas: true, language: Some(Language::Scl), ..ReadOptions::default() }
}

#[test]
fn ten_mistakes_are_ten_messages() {
    let text = "      A     MW 10;\n      L     ;\n      FOO   5;\n      L     40000;\n      NOT   M 0.0;\n      T     PIW 4;\n\
                \x20     L     W#A2EB;\n      SSI   16;\n      A     I 0.9;\n      L     #;\n      L     1;\n";
    let (unit, diagnostics) = parse(FileId(0), text, &ReadOptions::default());
    assert_eq!(diagnostics.len(), 10, "{diagnostics:#?}");
    assert!(ast_text(&unit).trim_end().ends_with("Load int 1"));
}

#[test]
fn mistakes_of_a_file_are_told_in_one_run() {
    let text = "x := 1 + ;\nIF a b := 1; END_IF;\ny := INT#40000;\nf(a b);\nz := (1 + 2;\nELSEIF;\n5 := a;\nWHILE a DO\n  v := 'abc;\nEND_WHILE;\nw := 1;\n";
    let (unit, diagnostics) = parse(FileId(0), text, &scl());
    assert_eq!(diagnostics.len(), 8, "{diagnostics:#?}");
    assert!(ast_text(&unit).trim_end().ends_with("w := 1"));
}

#[test]
fn var_of_a_function_is_temporary() {
    let tree = |text: &str| parse(FileId(0), text, &scl());
    let (unit, diagnostics) = tree("FUNCTION FC 1 : VOID\nVAR\n  a : INT;\nEND_VAR\nBEGIN\n  a := 5;\nEND_FUNCTION\n");
    assert!(ast_text(&unit).contains("temp\n      a : INT") && diagnostics.is_empty());
    let (_, diagnostics) = tree("FUNCTION \"f\" : VOID\nVAR\n  a : INT;\nEND_VAR\nBEGIN\n  #a := 5;\nEND_FUNCTION\n");
    assert_eq!(diagnostics.len(), 1);
}

#[test]
fn the_language_of_a_file_is_found() {
    let tree = |text: &str| ast_text(&parse(FileId(0), text, &ReadOptions::default()).0);
    let scl = "FUNCTION FC 1 : VOID\nBEGIN\n  a := 5;\nEND_FUNCTION\n";
    let stl = "FUNCTION FC 2 : VOID\nBEGIN\n  L 5;\n  T MW 2;\nEND_FUNCTION\n";
    assert!(tree(scl).contains("a := 5"));
    assert!(tree(stl).contains("Load int 5"));
    // Both in one file, each with its own grammar.
    let both = tree(&format!("{scl}{stl}"));
    assert!(both.contains("a := 5") && both.contains("Load int 5"), "{both}");
    assert!(tree("#x := 5;\n").contains("#x := 5"));
    assert!(tree("      A     I 0.0\n      =     Q 4.0\n").contains("network"));
    assert!(
        tree("DATA_BLOCK \"d\"\nVAR RETAIN\n  a : ARRAY[0..1] OF INT := [1, 2];\nEND_VAR\nBEGIN\nEND_DATA_BLOCK\n")
            .contains(":= [1, 2]")
    );
    // CALL without parentheses.
    assert!(
        tree("FUNCTION FC 3 : VOID\nBEGIN\nCALL FC 1\n a := MW 2\n b := MW 4\nEND_FUNCTION\n").contains("call FC 1")
    );
}
