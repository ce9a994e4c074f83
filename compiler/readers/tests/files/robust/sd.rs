//! SIMATIC SD, and the texts next to it.

use std::time::Duration;

use plcc_diag::FileId;
use plcc_readers::sd::Texts;
use plcc_syntax::Language;
use proptest::prelude::*;

use super::input::Notation;
use super::reading::{of, read, soon};

const SD: Option<Language> = Some(Language::Sd);

/// For the longest source.
const LIMIT: Duration = Duration::from_secs(5);

const NOTATION: Notation = Notation {
    sources: &[
        include_str!("../../../../../tests/parse/sd/lad.s7dcl"),
        include_str!("../../../../../tests/parse/sd/fbd.s7dcl"),
        include_str!("../../../../../tests/parse/sd/data.s7dcl"),
        include_str!("../../../../../tests/parse/sd/dialects.s7dcl"),
    ],
    pieces: PIECES,
    frames: &[("FUNCTION_BLOCK F NETWORK RUNG ", " END_RUNG END_NETWORK END_FUNCTION_BLOCK")],
};

/// Pieces that changes put into sources.
#[rustfmt::skip]
const PIECES: &[&str] = &[
    ";", "\n", "(", ")", "[", "]", "{", "}", ":", ":=", "=>", ",", ".", "#", "\"", "'", "//", "(*", "*)", "%", "_.", "RUNG ",
    "END_RUNG ", "NETWORK ", "END_NETWORK ", "wire#powerrail ", "wire#w1 ", "wire#", "wire", " NOT ", "Label(",
    "Contact( #a ) ", "Coil( ", "A( in2 := ", "A() ", "#t.TON( ", "TON{ time_type := Time }( ", "\"Fill\"( ", "JumpCoil( L ) ",
    "Switch( k := #k, EQ 1 => L ) ", "S_SR( #a, #b, #c ) ", "S_Templates", "{ S7_Templates := \"SrcType := Int\" } ",
    "{ S7_Templates := \"[SrcType := , ]\" } ", "{ S7_Language := \"FBD\" } ", "{ S7_Expression := \"IN1 + \" } ",
    "{ CASE0 := \"==\" } ", "{ S7_BlockNumber := \"7\" } ", "VAR ", "END_VAR ", "VAR CONSTANT ", "STRUCT ", "END_STRUCT; ",
    "BEGIN ", "TYPE ", "END_TYPE ", "T : Int; ", "DATA_BLOCK D : _.T ", "END_DATA_BLOCK ", "FUNCTION F : Void ",
    "END_FUNCTION ", "FUNCTION_BLOCK ", "END_FUNCTION_BLOCK ", "ORGANIZATION_BLOCK ", "#a", "\"Tag\"", "%I0.0", "%MW", "T#1s",
    "16#", "TRUE", "10", "-", "+", "ä", "\u{FEFF}", "\u{0}", "//@ assert #x == 5\n", "#s := #a + 1;", "IF #a THEN",
];

#[test]
fn any_text_is_read() {
    NOTATION.test(|text| read(text, SD));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

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
        soon(LIMIT, &text, &of(SD));
        read(&text, SD);
    }
}
