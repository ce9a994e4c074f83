//! STL of the S7-200.

use std::fmt::Write;
use std::time::Duration;

use plcc_diag::FileId;
use plcc_readers::parse;
use plcc_syntax::Language;

use super::input::Notation;
use super::reading::{of, read, soon};

const S7200: Option<Language> = Some(Language::S7200);

const NOTATION: Notation =
    Notation { sources: &[include_str!("../../../../../tests/parse/s7200/forms.awl")], pieces: PIECES, frames: &[] };

/// Pieces that changes put into sources.
#[rustfmt::skip]
const PIECES: &[&str] = &[
    "\n", "\r", ";", ",", ":", ":=", "=", "=I", "==", "<>", ">=", "+", "-", "*", "/", "//", "//@ assert VW0 == 5\n", "//@ ",
    "&", "%", "%I0.0", "#", "#a", "\"", "\"b c\"", "'", "'$4", "$", "LD", "LDS=", "A", "U", "MOVW", "CALL", "SBR", "SBR 3",
    "INT0", "MEND", "RET", "NETWORK", "NETWORK 99999999999", "TITLE=", "BEGIN", "VAR", "VAR_INPUT", "END_VAR", "VAR_GLOBAL",
    "ORGANIZATION_BLOCK", "SUBROUTINE_BLOCK a:SBR0", "END_SUBROUTINE_BLOCK", "DATA_BLOCK DB1", "END_DATA_BLOCK",
    "FUNCTION FC 1", "x:INT;", "I0.0", "I 0.0", "VW100", "V40", "DB1.DBW0", "DB1.", "T37", "16#", "16#FFFFFFFFFF", "W#16#",
    "BYTE#-1", "99999999999999999999", "1.0E99", "1e", "10ms", "ä", "水泵", "\u{0}", "\u{A0}", "(", ".",
];

#[test]
fn any_text_is_read() {
    NOTATION.test(|text| read(text, S7200));
}

#[test]
fn a_source_with_most_forms_has_no_mistake() {
    for language in [None, Some(Language::Stl), S7200] {
        let (unit, diagnostics) = parse(FileId(0), NOTATION.sources[0], &of(language));
        assert!(unit.s7200.is_some());
        assert_eq!(diagnostics, []);
    }
}

#[test]
fn reading_ends_soon() {
    let mut text = String::from("ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\n");
    for line in 0..10_000 {
        writeln!(text, "NETWORK {line} // title\nLDW>= VW{line}, {line}\nLPS\nMOVW *AC1, VW2\nLPP\nTON T37, +50")
            .expect("a String takes all text");
    }
    text.push_str("END_ORGANIZATION_BLOCK\n");
    for text in [
        text,
        "LD ,".repeat(20_000),
        "LD ,\n".repeat(20_000),
        "VB0 1,\n".repeat(20_000),
        "SUBROUTINE_BLOCK a\n".repeat(10_000),
        "VAR\nx y\n".repeat(10_000),
        format!("CALL X{}", ", 5".repeat(50_000)),
        format!("LD {}", "*".repeat(50_000)),
        "'$".repeat(50_000),
        "NETWORK 1\n".repeat(5_000),
    ] {
        soon(Duration::from_secs(3), &text, &of(S7200));
    }
}
