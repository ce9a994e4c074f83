//! SCL.

use std::fmt::Write;
use std::time::Duration;

use plcc_diag::FileId;
use plcc_readers::parse;
use plcc_syntax::Language;

use super::input::Notation;
use super::reading::{of, read, soon};

const SCL: Option<Language> = Some(Language::Scl);

const NOTATION: Notation = Notation {
    sources: &[include_str!("../../../../../tests/parse/scl/forms.scl")],
    pieces: PIECES,
    frames: &[
        ("FUNCTION_BLOCK \"f\"\nBEGIN\n", "\nEND_FUNCTION_BLOCK\n"),
        ("FUNCTION_BLOCK \"f\"\nVAR\n", "\nEND_VAR\n"),
    ],
};

/// Pieces that changes put into sources.
#[rustfmt::skip]
const PIECES: &[&str] = &[
    ";", "\n", "(", ")", "[", "]", "{", "}", ":", ":=", "=", "=>", ",", ".", "..", "#", "#a", "\"", "\"b\"", "\"t\":P", "'",
    "//", "(*", "*)", "(/*", "/*", "*/", "P#", "16#", "T#1", "LT#1s", "D#1990-", "DTL#", "WSTRING#'", "INT#", "'$>", "$<", "IF",
    "THEN", "ELSE", "ELSIF", "ELSEIF", "END_IF", "CASE", "OF", "END_CASE", "FOR", "TO", "BY", "DO", "END_FOR", "WHILE",
    "END_WHILE", "REPEAT", "UNTIL", "END_REPEAT", "EXIT", "CONTINUE", "RETURN", "GOTO", "lbl:", "1:", "2, 5..7:", "NOT", "-",
    "+", "*", "**", "/", "MOD", "AND", "&", "^", "<>", "REF(", "NULL", "x", "10", "1.5", "%MW10", "%MW", "%X3", ".%X3", "M0.0",
    "DB10.DW", "FC 1", "STRUCT", "END_STRUCT;", "ARRAY[", "*", "REF_TO", "STRING[", "BEGIN", "END_VAR", "VAR", "VAR CONSTANT",
    "VAR RETAIN", "CONST", "END_CONST", "LABEL", "END_LABEL", "AT", "TITLE =", "AUTHOR :", "REGION a", "END_REGION",
    "END_FUNCTION", "FUNCTION FC 2 : INT", "FUNCTION_BLOCK \"x\"", "DATA_BLOCK DB 1", "END_DATA_BLOCK", "TYPE \"t\"",
    "END_TYPE", "%", "$", "ä", "\u{0}", "//@ assert #x == 5\n", "//@ ", "{ a := 'b' }", "+=", "?=", "NETWORK", "L MW 2;",
];

#[test]
fn any_text_is_read() {
    NOTATION.test(|text| read(text, SCL));
}

#[test]
fn a_source_with_most_forms_has_no_mistake() {
    let (_, diagnostics) = parse(FileId(0), NOTATION.sources[0], &of(SCL));
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
        for language in [SCL, None] {
            soon(Duration::from_secs(3), &text, &of(language));
        }
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
    for language in [SCL, None] {
        soon(Duration::from_secs(3), &text, &of(language));
    }
    let (_, diagnostics) = parse(FileId(0), &text, &of(SCL));
    assert_eq!(diagnostics, []);
}
