//! Whatever an SCL source contains, reading it ends soon, without a panic, and every message has a place in the text.

mod mutate;

use std::fmt::Write;
use std::time::{Duration, Instant};

use plcc_diag::FileId;
use plcc_readers::{ReadOptions, parse, tokens_text};
use plcc_syntax::{Language, ast_text, decode};
use proptest::prelude::*;

/// A source with most forms of the language.
const FORMS: &str = include_str!("../../../tests/parse/scl/forms.scl");

/// Pieces that mutations put into sources.
const PIECES: &[&str] = &[
    ";",
    "\n",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    ":",
    ":=",
    "=",
    "=>",
    ",",
    ".",
    "..",
    "#",
    "#a",
    "\"",
    "\"b\"",
    "\"t\":P",
    "'",
    "//",
    "(*",
    "*)",
    "(/*",
    "/*",
    "*/",
    "P#",
    "16#",
    "T#1",
    "LT#1s",
    "D#1990-",
    "DTL#",
    "WSTRING#'",
    "INT#",
    "'$>",
    "$<",
    "IF",
    "THEN",
    "ELSE",
    "ELSIF",
    "ELSEIF",
    "END_IF",
    "CASE",
    "OF",
    "END_CASE",
    "FOR",
    "TO",
    "BY",
    "DO",
    "END_FOR",
    "WHILE",
    "END_WHILE",
    "REPEAT",
    "UNTIL",
    "END_REPEAT",
    "EXIT",
    "CONTINUE",
    "RETURN",
    "GOTO",
    "lbl:",
    "1:",
    "2, 5..7:",
    "NOT",
    "-",
    "+",
    "*",
    "**",
    "/",
    "MOD",
    "AND",
    "&",
    "^",
    "<>",
    "REF(",
    "NULL",
    "x",
    "10",
    "1.5",
    "%MW10",
    "%MW",
    "%X3",
    ".%X3",
    "M0.0",
    "DB10.DW",
    "FC 1",
    "STRUCT",
    "END_STRUCT;",
    "ARRAY[",
    "*",
    "REF_TO",
    "STRING[",
    "BEGIN",
    "END_VAR",
    "VAR",
    "VAR CONSTANT",
    "VAR RETAIN",
    "CONST",
    "END_CONST",
    "LABEL",
    "END_LABEL",
    "AT",
    "TITLE =",
    "AUTHOR :",
    "REGION a",
    "END_REGION",
    "END_FUNCTION",
    "FUNCTION FC 2 : INT",
    "FUNCTION_BLOCK \"x\"",
    "DATA_BLOCK DB 1",
    "END_DATA_BLOCK",
    "TYPE \"t\"",
    "END_TYPE",
    "%",
    "$",
    "ä",
    "\u{0}",
    "//@ assert #x == 5\n",
    "//@ ",
    "{ a := 'b' }",
    "+=",
    "?=",
    "NETWORK",
    "L MW 2;",
];

fn read(text: &str) {
    for (pragmas, language) in [(false, Some(Language::Scl)), (true, Some(Language::Scl)), (true, None)] {
        let options = ReadOptions { pragmas, language, ..ReadOptions::default() };
        let (unit, diagnostics) = parse(FileId(0), text, &options);
        for diagnostic in &diagnostics {
            let spans = std::iter::once(&diagnostic.primary).chain(&diagnostic.secondary).map(|label| label.span);
            for span in spans {
                assert!(text.get(span.range()).is_some(), "a message lies outside the text: {diagnostic:?}");
            }
            assert!(!diagnostic.title.is_empty() && !diagnostic.primary.text.is_empty(), "{diagnostic:?}");
        }
        ast_text(&unit);
        tokens_text(text, &options);
    }
}

fn scl() -> ReadOptions<'static> {
    ReadOptions { pragmas: true, language: Some(Language::Scl), ..ReadOptions::default() }
}

fn within(limit: Duration, text: &str) {
    for language in [Some(Language::Scl), None] {
        let start = Instant::now();
        parse(FileId(0), text, &ReadOptions { language, ..scl() });
        let needed = start.elapsed();
        let head: String = text.chars().take(60).collect();
        assert!(needed < limit, "{needed:?} for {} bytes: {head}", text.len());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        read(&decode(&bytes));
    }

    #[test]
    fn any_pieces(pieces in proptest::collection::vec(proptest::sample::select(PIECES), 0..120)) {
        read(&pieces.join(" "));
        read(&pieces.concat());
        read(&format!("FUNCTION_BLOCK \"f\"\nBEGIN\n{}\nEND_FUNCTION_BLOCK\n", pieces.join(" ")));
        read(&format!("FUNCTION_BLOCK \"f\"\nVAR\n{}\nEND_VAR\n", pieces.join(" ")));
    }

    #[test]
    fn mutated_sources(edits in proptest::collection::vec((any::<prop::sample::Index>(), 0usize..6, 0..PIECES.len()), 1..12)) {
        read(&mutate::mutated(FORMS, edits, PIECES));
    }

    #[test]
    fn cut_sources(place in any::<prop::sample::Index>()) {
        let (before, after) = mutate::cut(FORMS, place);
        read(before);
        read(after);
    }
}

#[test]
fn a_source_with_most_forms_has_no_mistake() {
    let (_, diagnostics) = parse(FileId(0), FORMS, &scl());
    assert_eq!(diagnostics, []);
}

#[test]
fn deep_nesting_is_bounded() {
    const DEPTH: usize = 100_000;
    let declared = "FUNCTION_BLOCK FB 1\nVAR\n";
    let data = "DATA_BLOCK DB 1\nSTRUCT\na : INT;\nEND_STRUCT;\nBEGIN\n";
    for text in [
        "(".repeat(DEPTH),
        "[".repeat(DEPTH),
        "{".repeat(DEPTH),
        format!("x := {}", "(".repeat(DEPTH)),
        format!("x := {}1;", "NOT ".repeat(DEPTH)),
        format!("x := {}1{};", "-(".repeat(DEPTH), ")".repeat(DEPTH)),
        format!("x := 1{};", " + 1".repeat(DEPTH)),
        format!("x := 1{};", " ** -1".repeat(DEPTH)),
        format!("x{} := 1;", ".a".repeat(DEPTH)),
        format!("x{} := 1;", "[1]".repeat(DEPTH)),
        format!("{}1;", "x := ".repeat(DEPTH)),
        format!("x := {}", "f(a := ".repeat(DEPTH)),
        "IF a THEN ".repeat(DEPTH),
        "CASE a OF 1: ".repeat(DEPTH),
        "REPEAT ".repeat(DEPTH),
        "FOR i := 1 TO 2 DO ".repeat(DEPTH),
        "END_IF; ".repeat(DEPTH),
        "ELSE IF a THEN ".repeat(DEPTH),
        format!("CASE x OF\n{}", "a\n".repeat(DEPTH)),
        format!("{declared}{}", "s : STRUCT\n".repeat(DEPTH)),
        format!("{declared}{}", "END_STRUCT;\n".repeat(DEPTH)),
        format!("{declared}a : {}INT;", "ARRAY [1..2] OF ".repeat(DEPTH)),
        format!("{declared}a : {}INT;", "REF_TO ".repeat(DEPTH)),
        format!("{declared}a : {}", "ARRAY [1..2] OF STRUCT x : ".repeat(DEPTH)),
        format!("{declared}a : INT := {}", "3 (".repeat(DEPTH)),
        format!("{declared}a : INT := {}", "[".repeat(DEPTH)),
        format!("{declared}a {}", "{ b := ".repeat(DEPTH)),
        format!("{data}a := {}", "1 (".repeat(DEPTH)),
        format!("{data}{}", "a[".repeat(DEPTH)),
        "FUNCTION FC 1 : VOID\n".repeat(DEPTH / 10),
        "TYPE \"t\"\nEND_TYPE\n".repeat(DEPTH / 10),
        "m1: ".repeat(DEPTH),
        "(* ".repeat(DEPTH),
        "(* (* *) ".repeat(DEPTH),
        "'$> ".repeat(DEPTH),
        "x y ".repeat(DEPTH),
        "x\n".repeat(DEPTH),
        "'".repeat(DEPTH),
        "P#DB".repeat(DEPTH),
        "REGION a\n".repeat(DEPTH),
        "//@ assert #x == 5\n".repeat(DEPTH / 10),
    ] {
        within(Duration::from_secs(3), &text);
    }
}

#[test]
fn a_large_file_is_read_fast() {
    let mut text = String::from("FUNCTION_BLOCK \"Large\"\nVAR\n  x : ARRAY[0..99] OF INT;\nEND_VAR\nBEGIN\n");
    for line in 0..26_000 / 5 {
        writeln!(
            text,
            "  IF #x[{}] > {line} AND NOT #busy THEN // comment\n    #x[{0}] := #x[{0}] + 1;\n    \"Recipe\".part[3].weight := REAL_TO_INT(#y * 2.5);\n  \
             \x20 #timer(IN := #start, PT := T#3s, Q => #done);\n  END_IF;",
            line % 100
        )
        .expect("a String takes all text");
    }
    text.push_str("END_FUNCTION_BLOCK\n");
    within(Duration::from_secs(3), &text);
    let (_, diagnostics) = parse(FileId(0), &text, &scl());
    assert_eq!(diagnostics, []);
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
