//! Whatever a file contains, reading it ends soon, without a panic, and every message has a place in the text.

mod mutate;

use std::fmt::Write;
use std::time::{Duration, Instant};

use plcc_diag::FileId;
use plcc_readers::{ReadOptions, parse};
use plcc_syntax::{ast_text, decode, stl};
use proptest::prelude::*;

/// A source with most forms of the language.
const FORMS: &str = include_str!("forms.stl");

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
    ",",
    ".",
    "..",
    "#",
    "\"",
    "'",
    "//",
    "(*",
    "*)",
    "@@x@@",
    "P#",
    "P##",
    "B#(",
    "16#",
    "T#1",
    "D#1990-",
    "L",
    "A(",
    "CALL",
    "FC 1",
    "MW",
    "10",
    "0.0",
    "-",
    "+",
    "==",
    "STRUCT",
    "END_STRUCT;",
    "ARRAY[",
    "OF",
    "NETWORK",
    "TITLE =",
    "BEGIN",
    "END_VAR",
    "VAR",
    "END_FUNCTION",
    "FUNCTION FC 2 : INT",
    "DATA_BLOCK DB 1",
    "TYPE UDT 1",
    "IF",
    "AR1,P#0.0",
    "%",
    "$",
    "ä",
    "\u{0}",
    "//@ assert ACCU1 == 5\n",
    "//@ ",
    "m1:",
    "MCR(",
    ")MCR",
    "RND+",
    "{ a := 'b' }",
];

fn read(text: &str) {
    for pragmas in [false, true] {
        let options = ReadOptions { pragmas, ..ReadOptions::default() };
        let (unit, diagnostics) = parse(FileId(0), text, &options);
        for diagnostic in &diagnostics {
            let spans = std::iter::once(&diagnostic.primary).chain(&diagnostic.secondary).map(|label| label.span);
            for span in spans {
                assert!(text.get(span.range()).is_some(), "a message lies outside the text: {diagnostic:?}");
            }
            assert!(!diagnostic.title.is_empty() && !diagnostic.primary.text.is_empty(), "{diagnostic:?}");
        }
        ast_text(&unit);
        stl::tokens_text(text, &plcc_syntax::ParseOptions { mnemonics: options.mnemonics, pragmas: options.pragmas });
    }
}

fn within(limit: Duration, text: &str) {
    let start = Instant::now();
    parse(FileId(0), text, &ReadOptions { pragmas: true, ..ReadOptions::default() });
    let needed = start.elapsed();
    assert!(needed < limit, "{needed:?} for {} bytes", text.len());
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
        within(Duration::from_secs(1), &text);
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
    within(Duration::from_secs(1), &text);
    let (_, diagnostics) = parse(FileId(0), &text, &ReadOptions::default());
    assert_eq!(diagnostics, []);
}

#[test]
fn ten_mistakes_are_ten_messages() {
    let text = "      A     MW 10;\n      L     ;\n      FOO   5;\n      L     40000;\n      NOT   M 0.0;\n      T     PIW 4;\n\
                \x20     L     W#A2EB;\n      SSI   16;\n      A     I 0.9;\n      L     #;\n      L     1;\n";
    let (unit, diagnostics) = parse(FileId(0), text, &ReadOptions::default());
    assert_eq!(diagnostics.len(), 10, "{diagnostics:#?}");
    assert!(ast_text(&unit).trim_end().ends_with("Load int 1"));
}
