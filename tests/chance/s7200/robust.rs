//! Sources with random changes and sources of random words.

use plcc_diag::SourceFile;
use plcc_driver::cli::Level;
use plcc_driver::inputs::Read;
use plcc_driver::pipeline::{self, Settings};

use super::generate;
use plcc_tests::damage;
use plcc_tests::random::Random;

/// Words of the S7-200, for wrong positions.
#[rustfmt::skip]
const WORDS: &[&str] = &[
    "LD", "LDN", "A", "O", "=", "S", "R", "EU", "NOT", "ALD", "LPS", "LDS", "TON", "CTUD", "MOVB", "MOVD", "BMB", "+I", "/R",
    "SHRB", "FOR", "NEXT", "JMP", "LBL", "LSCR", "SCRT", "SCRE", "CALL", "SBR0", "CRET", "ATCH", "INT0", "DTCH", "ENI", "HDEF",
    "HSC", "PLS", "PID", "XMT", "NETR", "FILL", "FND=", "ATT", "SCPY", "STI", "AENO", "END", "MEND", "STOP", "RET", "I0.0",
    "Q99.9", "VB10239", "VW10239", "VD-1", "*VD100", "*AC0", "*AC1", "&VB0", "&*VD0", "AC3", "AC4", "T37", "T256", "C0", "HC6",
    "AIW1", "AQW0", "SM0.0", "SMB549", "S31.7", "L63.7", "LD60", "#x", "\"s\"", "\"", "'A'", "'", "16#FFFFFFFFF", "2#102",
    "1.0E99", "-", "+", "99999999999999999999", "*", "&", ",", ";", "//", ".", ":", "NETWORK", "Network 1", "TITLE=", "BEGIN",
    "VAR", "VAR_INPUT", "END_VAR", "x:BOOL;", "y:STRING;", "ORGANIZATION_BLOCK MAIN:OB1", "END_ORGANIZATION_BLOCK",
    "SUBROUTINE_BLOCK a:SBR0", "END_SUBROUTINE_BLOCK", "INTERRUPT_BLOCK b:INT0", "END_INTERRUPT_BLOCK", "DATA_BLOCK DB1",
    "END_DATA_BLOCK", "VB0 1, 2", "VD0 1.5", "V0 'abc'", "SBR 1", "INT 300", "DB1.DBX0.9", "\u{e9}", "\u{4e2d}", "\0",
];

/// A source by chance.
pub fn source(seed: u64) -> String {
    let mut random = Random::new(seed);
    if random.percent(30) {
        let mut text = String::from(if random.percent(50) { "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\n" } else { "" });
        for _ in 0..random.below(120) {
            text.push_str(random.of(WORDS));
            text.push_str(random.of(&[" ", " ", ", ", "\n", "\n", "\t", ""]));
        }
        return text;
    }
    let [text, other] = [seed, seed + 1].map(|seed| generate::case(seed).program.to_string());
    damage::damaged(&mut random, &text, &other, WORDS)
}

/// Compiles as far as it goes.
pub fn compile(source: &str) {
    let mut read = Read { name: "changed".to_string(), ..Read::default() };
    read.units.push(read.sources.add(SourceFile::new("changed.awl", source.to_string())));
    let bound = pipeline::front(read, &Settings { require_main: true, ..Settings::default() });
    _ = plcc_diag::drawing::draw(&bound.diagnostics, &bound.sources, false);
    if !bound.has_errors() {
        let compiled = pipeline::back(&bound, Level::O2);
        plcc_ir::verify::verify(&compiled.module).expect("what is compiled is well formed");
    }
}
