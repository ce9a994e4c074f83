//! GRAPH as source text.

use std::time::Duration;

use plcc_syntax::Language;

use super::input::Notation;
use super::reading::{of, read, soon};

const GRAPH: Option<Language> = Some(Language::Graph);

/// For the longest source.
const LIMIT: Duration = Duration::from_secs(5);

const NOTATION: Notation = Notation {
    sources: &[
        include_str!("../../../../../tests/parse/graph/forms.gr7"),
        include_str!("../../../../../tests/parse/graph/door.gr7"),
        include_str!("../../../../../tests/parse/graph/mixed.gr7"),
    ],
    pieces: PIECES,
    frames: &[("FUNCTION_BLOCK FB1\nINITIAL_STEP S1:\n", "\nEND_STEP\nEND_FUNCTION_BLOCK")],
};

/// Pieces that changes put into sources.
#[rustfmt::skip]
const PIECES: &[&str] = &[
    ";", "\n", "\r", "\r\n", "(", ")", "[", "]", "{", "}", ":", ":=", "=>", ",", ".", "#", "\"", "'", "//", "(*", "*)", "(*$_",
    "%", "(*$_COM a@b*)", "(*$_NUM 3*)", "(*$_NUM x*)", "(*$_JUMP*)", "(*$_CMPSET\nAckReq: T\n*)", "(*$_X*)",
    "FUNCTION_BLOCK FB1\n", "\nEND_FUNCTION_BLOCK\n", "\nSTEP S1 (*$_NUM 1*):\n", "\nINITIAL_STEP ", "\nEND_STEP\n",
    "\nTRANSITION T1\n", "\nEND_TRANSITION\n", "\nFROM ", "\nTO ", "\nCONDITION := ", "\nINTERLOCK\n", "\nEND_INTERLOCK\n",
    "\nSUPERVISION ", "END_SUPERVISION", "\nPERM_CONDITION_AT_BEGIN\n", "\nPERM_CONDITION_AT_END\n", "END_PERM_CONDITION\n",
    "SEQUENCE", "END_SEQUENCE", "VAR ", "END_VAR ", "VAR_INPUT\nx : INT; ", "TITLE = ", " (N)\n", " (S1_N)", " (CDC) ",
    " (XY)\n", "(=) := ", "(S) := ", "()", "CALL FC1 (a := ", "CALL FB1, DB1", "S_ALL", " AND ", " OR ", " NOT ", " XOR ",
    " SHL ", "=", "==", "<>", ">=", "-", "+", "*", "MOD ", "I0.0", "I 0.0", "MW 2", "DB1.DBX 1.0", "T 5", "S001.X", "1_step",
    "T#5S", "16#", "1.5e+3", "TRUE", "ä", "\u{FEFF}", "\u{0}", "//@ test\n", "DATA_BLOCK DB1\n", "BEGIN\n", "NETWORK\n",
    "U E0.0;",
];

#[test]
fn any_text_is_read() {
    NOTATION.test(|text| read(text, GRAPH));
}

#[test]
fn a_keyword_is_not_the_name_of_a_part() {
    for word in ["END_VAR", "END_FUNCTION_BLOCK", "BEGIN", "NETWORK", "VAR", "FUNCTION_BLOCK"] {
        for after in ["(*$_NUM 1*)", "(*$_X*)", ":"] {
            for end in ["END_STEP", "END_TRANSITION"] {
                read(&format!("FUNCTION_BLOCK FB1\n{word} {after}\n{end}\nEND_FUNCTION_BLOCK\n"), GRAPH);
                read(&format!("FUNCTION_BLOCK FB1\nVAR\nEND_VAR\n{word} {after}\n{end}\n"), GRAPH);
            }
        }
    }
}

#[test]
fn long_sources_are_read_in_time() {
    let block = |inner: &str| format!("FUNCTION_BLOCK FB1\nINITIAL_STEP S1:\n{inner}\nEND_STEP\nEND_FUNCTION_BLOCK\n");
    let condition = |text: String| {
        format!("FUNCTION_BLOCK FB1\nTRANSITION T1\nFROM S1\nCONDITION := {text}\nEND_TRANSITION\nEND_FUNCTION_BLOCK\n")
    };
    for text in [
        block(&"Q4.0 (N)\n".repeat(20_000)),
        block(&"CALL FC1 (\n".repeat(20_000)),
        block(&"MW2 := (MW4\n".repeat(20_000)),
        block(&"MW2 := MW4 +\n".repeat(20_000)),
        block(&"(".repeat(50_000)),
        format!("FUNCTION_BLOCK FB1\nPERM_CONDITION_AT_BEGIN\n{}", "M0.0 (=) := (I0.0\n".repeat(20_000)),
        condition("I0.0 AND ".repeat(30_000)),
        condition(format!("I0.0{}", "\nAND (I0.1 OR NOT I0.2)OR I0.3".repeat(20_000))),
        condition("(".repeat(50_000)),
        condition("NOT ".repeat(50_000)),
        condition(format!("a{}", ".b".repeat(50_000))),
        condition(format!("a{}", " + a".repeat(20_000))),
        "STEP S1\n".repeat(20_000),
        "FUNCTION_BLOCK FB1\n".repeat(5_000),
        "{(*$_X*)}".repeat(20_000),
        "(*$_COM ".repeat(20_000),
    ] {
        for language in [GRAPH, None] {
            soon(LIMIT, &text, &of(language));
        }
        read(&text, GRAPH);
    }
}
