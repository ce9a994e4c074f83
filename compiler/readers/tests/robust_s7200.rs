//! Whatever a source for the S7-200 contains, reading it ends soon, without a panic, and every message has a place in the text.

mod mutate;

use std::fmt::Write;
use std::time::{Duration, Instant};

use plcc_diag::FileId;
use plcc_readers::{ReadOptions, parse, tokens_text};
use plcc_syntax::{Language, ast_text, decode};
use proptest::prelude::*;

/// A source with most forms of the language.
const FORMS: &str = include_str!("../../../tests/parse/awl/forms.awl");

/// Pieces that mutations put into sources.
const PIECES: &[&str] = &[
    "\n",
    "\r",
    ";",
    ",",
    ":",
    ":=",
    "=",
    "=I",
    "==",
    "<>",
    ">=",
    "+",
    "-",
    "*",
    "/",
    "//",
    "//@ assert VW0 == 5\n",
    "//@ ",
    "&",
    "%",
    "%I0.0",
    "#",
    "#a",
    "\"",
    "\"b c\"",
    "'",
    "'$4",
    "$",
    "LD",
    "LDS=",
    "A",
    "U",
    "MOVW",
    "CALL",
    "SBR",
    "SBR 3",
    "INT0",
    "MEND",
    "RET",
    "NETWORK",
    "NETWORK 99999999999",
    "TITLE=",
    "BEGIN",
    "VAR",
    "VAR_INPUT",
    "END_VAR",
    "VAR_GLOBAL",
    "ORGANIZATION_BLOCK",
    "SUBROUTINE_BLOCK a:SBR0",
    "END_SUBROUTINE_BLOCK",
    "DATA_BLOCK DB1",
    "END_DATA_BLOCK",
    "FUNCTION FC 1",
    "x:INT;",
    "I0.0",
    "I 0.0",
    "VW100",
    "V40",
    "DB1.DBW0",
    "DB1.",
    "T37",
    "16#",
    "16#FFFFFFFFFF",
    "W#16#",
    "BYTE#-1",
    "99999999999999999999",
    "1.0E99",
    "1e",
    "10ms",
    "ä",
    "水泵",
    "\u{0}",
    "\u{A0}",
    "(",
    ".",
];

fn read(text: &str) {
    for (pragmas, language) in [(true, Some(Language::S7200)), (false, Some(Language::S7200)), (true, None)] {
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

fn s7200() -> ReadOptions<'static> {
    ReadOptions { pragmas: true, language: Some(Language::S7200), ..ReadOptions::default() }
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
        read(&pieces.join("\n"));
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
    for language in [None, Some(Language::Stl), Some(Language::S7200)] {
        let (unit, diagnostics) = parse(FileId(0), FORMS, &ReadOptions { language, ..s7200() });
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
        let start = Instant::now();
        parse(FileId(0), &text, &s7200());
        let needed = start.elapsed();
        let head: String = text.chars().take(60).collect();
        assert!(needed < Duration::from_secs(3), "{needed:?} for {} bytes: {head}", text.len());
    }
}
