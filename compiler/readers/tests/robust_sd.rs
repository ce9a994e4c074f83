//! Whatever a source in SIMATIC SD contains, reading it ends soon, without a panic, and every message has a place in the text.

mod mutate;

use std::time::{Duration, Instant};

use plcc_diag::FileId;
use plcc_readers::sd::Texts;
use plcc_readers::{ReadOptions, parse, tokens_text};
use plcc_syntax::{Language, ast_text};
use proptest::prelude::*;

/// Sources with most forms of the language.
const SOURCES: [&str; 4] = [
    include_str!("../../../tests/parse/sd/lad.s7dcl"),
    include_str!("../../../tests/parse/sd/fbd.s7dcl"),
    include_str!("../../../tests/parse/sd/data.s7dcl"),
    include_str!("../../../tests/parse/sd/dialects.s7dcl"),
];

/// Pieces that mutations put into sources.
#[rustfmt::skip]
const PIECES: &[&str] = &[
    ";", "\n", "(", ")", "[", "]", "{", "}", ":", ":=", "=>", ",", ".", "#", "\"", "'", "//", "(*", "*)", "%", "_.",
    "RUNG ", "END_RUNG ", "NETWORK ", "END_NETWORK ", "wire#powerrail ", "wire#w1 ", "wire#", "wire", " NOT ", "Label(",
    "Contact( #a ) ", "Coil( ", "A( in2 := ", "A() ", "#t.TON( ", "TON{ time_type := Time }( ", "\"Fill\"( ", "JumpCoil( L ) ",
    "Switch( k := #k, EQ 1 => L ) ", "S_SR( #a, #b, #c ) ", "S_Templates", "{ S7_Templates := \"SrcType := Int\" } ",
    "{ S7_Templates := \"[SrcType := , ]\" } ", "{ S7_Language := \"FBD\" } ", "{ S7_Expression := \"IN1 + \" } ", "{ CASE0 := \"==\" } ",
    "{ S7_BlockNumber := \"7\" } ", "VAR ", "END_VAR ", "VAR CONSTANT ", "STRUCT ", "END_STRUCT; ", "BEGIN ", "TYPE ", "END_TYPE ",
    "T : Int; ", "DATA_BLOCK D : _.T ", "END_DATA_BLOCK ", "FUNCTION F : Void ", "END_FUNCTION ", "FUNCTION_BLOCK ",
    "END_FUNCTION_BLOCK ", "ORGANIZATION_BLOCK ", "#a", "\"Tag\"", "%I0.0", "%MW", "T#1s", "16#", "TRUE", "10", "-", "+", "ä", "\u{FEFF}",
    "\u{0}", "//@ assert #x == 5\n", "#s := #a + 1;", "IF #a THEN",
];

fn options(pragmas: bool) -> ReadOptions<'static> {
    ReadOptions { pragmas, language: Some(Language::Sd), ..ReadOptions::default() }
}

/// Reads a text, prints the result, and checks the positions of all messages.
fn check(text: &str) {
    for pragmas in [false, true] {
        let (unit, diagnostics) = parse(FileId(0), text, &options(pragmas));
        for diagnostic in &diagnostics {
            let places = std::iter::once(&diagnostic.primary).chain(&diagnostic.secondary);
            for span in places.map(|label| label.span) {
                assert!(text.get(span.range()).is_some(), "{}: {span:?} is not a part of the text", diagnostic.title);
            }
        }
        ast_text(&unit);
    }
    tokens_text(text, &options(true));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn any_text_is_read(text in "\\PC{0,200}") {
        check(&text);
    }

    #[test]
    fn pieces_in_any_order_are_read(pieces in prop::collection::vec(prop::sample::select(PIECES), 0..60)) {
        check(&pieces.concat());
        check(&format!("FUNCTION_BLOCK F NETWORK RUNG {} END_RUNG END_NETWORK END_FUNCTION_BLOCK", pieces.concat()));
    }

    #[test]
    fn changed_sources_are_read(
        source in 0..SOURCES.len(),
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..12usize, 0..PIECES.len()), 1..6),
    ) {
        check(&mutate::mutated(SOURCES[source], edits, PIECES));
    }

    #[test]
    fn the_start_of_a_source_is_read(source in 0..SOURCES.len(), place in any::<prop::sample::Index>()) {
        let (head, tail) = mutate::cut(SOURCES[source], place);
        check(head);
        check(tail);
    }

    #[test]
    fn any_texts_are_read(text in "[-a-z: '\"|>\\[\\]{}&*!#%@`,?\n\t]{0,200}") {
        let whole = format!("MultiLingualTexts:\n  - id: a\n    en-US: {text}");
        for text in [&text, &whole] {
            let (_, diagnostics) = Texts::parse(FileId(0), text);
            for diagnostic in &diagnostics {
                assert!(text.get(diagnostic.primary.span.range()).is_some(), "{}", diagnostic.title);
            }
        }
    }
}

#[test]
fn long_sources_are_read_in_time() {
    let rung = "RUNG wire#powerrail Contact( #a ) wire#w1 Coil( #q ) END_RUNG\nRUNG wire#w1 Contact( #b ) Coil( #r ) END_RUNG\n";
    let network = format!("NETWORK\n{rung}END_NETWORK\n");
    let many_networks = format!("FUNCTION_BLOCK F\n{}END_FUNCTION_BLOCK\n", network.repeat(3000));
    let one_network = format!("FUNCTION_BLOCK F\nNETWORK\n{}END_NETWORK\nEND_FUNCTION_BLOCK\n", rung.repeat(3000));
    for text in [many_networks, one_network, "[".repeat(100_000), "{".repeat(20_000), "NETWORK\n".repeat(20_000)] {
        let start = Instant::now();
        check(&text);
        assert!(start.elapsed() < Duration::from_secs(20), "{} bytes took {:?}", text.len(), start.elapsed());
    }
}
