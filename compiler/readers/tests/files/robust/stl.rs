//! STL.

use std::fmt::Write;
use std::time::Duration;

use plcc_diag::FileId;
use plcc_readers::{ReadOptions, parse};

use super::input::Notation;
use super::reading::{of, read, soon};

const NOTATION: Notation = Notation { sources: &[include_str!("../forms.stl")], pieces: PIECES, frames: &[] };

/// Pieces that changes put into sources.
#[rustfmt::skip]
const PIECES: &[&str] = &[
    ";", "\n", "(", ")", "[", "]", "{", "}", ":", ":=", "=", ",", ".", "..", "#", "\"", "'", "//", "(*", "*)", "@@x@@", "P#",
    "P##", "B#(", "16#", "T#1", "D#1990-", "L", "A(", "CALL", "FC 1", "MW", "10", "0.0", "-", "+", "==", "STRUCT",
    "END_STRUCT;", "ARRAY[", "OF", "NETWORK", "TITLE =", "BEGIN", "END_VAR", "VAR", "END_FUNCTION", "FUNCTION FC 2 : INT",
    "DATA_BLOCK DB 1", "TYPE UDT 1", "IF", "AR1,P#0.0", "%", "$", "ä", "\u{0}", "//@ assert ACCU1 == 5\n", "//@ ", "m1:",
    "MCR(", ")MCR", "RND+", "{ a := 'b' }",
];

#[test]
fn any_text_is_read() {
    NOTATION.test(|text| read(text, None));
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
        "A(\n".repeat(DEPTH),
        format!("CALL FC 1 {}", "(".repeat(DEPTH)),
        format!("L MW {}", "[MW ".repeat(DEPTH)),
        format!("L #a{}", "[1".repeat(DEPTH)),
        format!("L #a{};", ".b".repeat(DEPTH)),
        format!("{declared}{}", "s : STRUCT\n".repeat(DEPTH)),
        format!("{declared}{}", "END_STRUCT;\n".repeat(DEPTH)),
        format!("{declared}a : {}INT;", "ARRAY [1..2] OF ".repeat(DEPTH)),
        format!("{declared}a : {}", "ARRAY [1..2] OF STRUCT x : ".repeat(DEPTH)),
        format!("{declared}a : INT := {}", "3 (".repeat(DEPTH)),
        format!("{declared}a : INT := {}", "[".repeat(DEPTH)),
        format!("{declared}a {}", "{ b := ".repeat(DEPTH)),
        format!("{data}a := {}", "1 (".repeat(DEPTH)),
        format!("{data}{}", "a[".repeat(DEPTH)),
        "FUNCTION FC 1 : VOID\n".repeat(DEPTH / 10),
        "m1: ".repeat(DEPTH),
        "(* ".repeat(DEPTH),
        "x := ".repeat(DEPTH),
        "L 1 ".repeat(DEPTH),
        "'".repeat(DEPTH),
        "B#(".repeat(DEPTH),
        "P#DB".repeat(DEPTH),
    ] {
        soon(Duration::from_secs(1), &text, &of(None));
    }
}

#[test]
fn a_large_file_is_read_fast() {
    let mut text = String::from("ORGANIZATION_BLOCK OB 1\nBEGIN\n");
    for line in 0..26_000 / 5 {
        writeln!(
            text,
            "NETWORK // {line}\n      A     I {}.3;\n      L     DB5.DBW {line}; // comment\n      T     \"recipe\".part[3].weight;\nm{line}: = M 4.0;",
            line % 100
        )
        .expect("a String takes all text");
    }
    text.push_str("END_ORGANIZATION_BLOCK\n");
    // 0.03 s on the machine that this was written on; the limit leaves room for a loaded one.
    soon(Duration::from_secs(1), &text, &of(None));
    let (_, diagnostics) = parse(FileId(0), &text, &ReadOptions::default());
    assert_eq!(diagnostics, []);
}
