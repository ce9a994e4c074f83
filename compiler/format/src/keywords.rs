//! Words that open and close blocks, sections, statements and parts of charts.

use crate::piece::Piece;

/// Something that indents what is inside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inside {
    /// A block of SIMATIC SD, the body of another block.
    Block,
    Section,
    Struct,
    If,
    Loop,
    Case,
    /// The statements after a label of CASE.
    Branch,
    Region,
    Network,
    Rung,
    /// A step or a transition, an interlock or a supervision.
    Chart,
}

/// What begins a block.
pub const BLOCKS: [&str; 6] = ["ORGANIZATION_BLOCK", "FUNCTION_BLOCK", "FUNCTION", "DATA_BLOCK", "TYPE", "PROGRAM"];
/// What begins a section of declarations.
pub const SECTIONS: [&str; 10] = [
    "VAR",
    "VAR_INPUT",
    "VAR_OUTPUT",
    "VAR_IN_OUT",
    "VAR_TEMP",
    "VAR_STAT",
    "VAR_CONSTANT",
    "VAR_EXTERNAL",
    "CONST",
    "LABEL",
];
/// What opens a part of a chart.
pub const CHART: [&str; 8] = [
    "SEQUENCE",
    "STEP",
    "INITIAL_STEP",
    "TRANSITION",
    "INTERLOCK",
    "SUPERVISION",
    "PERM_CONDITION_AT_BEGIN",
    "PERM_CONDITION_AT_END",
];
/// Words after the keyword of a section.
pub const MODIFIERS: [&str; 6] = ["RETAIN", "NON_RETAIN", "CONSTANT", "PERSISTENT", "DB_SPECIFIC", "INTERNAL"];

/// `REGION`, also with its name.
pub fn is_region(piece: &Piece) -> bool {
    piece.text.len() >= 6 && piece.text.is_char_boundary(6) && piece.text[..6].eq_ignore_ascii_case("REGION")
}

/// `END_REGION`, also with the name of the region or a `;`.
fn is_end_of_region(piece: &Piece) -> bool {
    let word = piece.text.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or_default();
    word.eq_ignore_ascii_case("END_REGION")
}

/// `END_FUNCTION` and the like.
pub fn is_end_of_block(piece: &Piece) -> bool {
    piece.text.len() > 4
        && piece.text.is_char_boundary(4)
        && piece.text[..4].eq_ignore_ascii_case("END_")
        && BLOCKS.iter().any(|block| piece.text[4..].eq_ignore_ascii_case(block))
}

/// What a keyword closes.
pub fn closes(piece: &Piece) -> Option<Inside> {
    match () {
        () if piece.is_any(&["END_VAR", "END_CONST", "END_LABEL"]) => Some(Inside::Section),
        () if piece.is("END_STRUCT") => Some(Inside::Struct),
        () if piece.is("END_IF") => Some(Inside::If),
        () if piece.is_any(&["END_FOR", "END_WHILE", "END_REPEAT"]) => Some(Inside::Loop),
        () if piece.is("END_CASE") => Some(Inside::Case),
        () if is_end_of_region(piece) => Some(Inside::Region),
        () if piece.is("END_NETWORK") => Some(Inside::Network),
        () if piece.is("END_RUNG") => Some(Inside::Rung),
        () if piece.is_any(&[
            "END_STEP",
            "END_TRANSITION",
            "END_INTERLOCK",
            "END_SUPERVISION",
            "END_PERM_CONDITION",
            "END_SEQUENCE",
        ]) =>
        {
            Some(Inside::Chart)
        }
        () => None,
    }
}
