//! The layout of STL of the S7-200: statements at the left margin, operands in one column, as Micro/WIN exports them.

use crate::lines::{Kind, Line};
use crate::piece::Piece;

/// The column of operands.
const OPERANDS: usize = 7;

/// Words that begin lines of the frame.
const FRAME: [&str; 22] = [
    "ORGANIZATION_BLOCK",
    "SUBROUTINE_BLOCK",
    "INTERRUPT_BLOCK",
    "DATA_BLOCK",
    "END_ORGANIZATION_BLOCK",
    "END_SUBROUTINE_BLOCK",
    "END_INTERRUPT_BLOCK",
    "END_DATA_BLOCK",
    "BEGIN",
    "NETWORK",
    "NETZWERK",
    "TITLE",
    "TITEL",
    "VAR",
    "VAR_INPUT",
    "VAR_OUTPUT",
    "VAR_IN_OUT",
    "VAR_TEMP",
    "END_VAR",
    "AUTHOR",
    "VERSION",
    "FAMILY",
];

/// The lines of a part of `text`.
pub fn lay_out(text: &str, pieces: &[Piece]) -> Vec<Line> {
    let mut out = Vec::new();
    let mut in_declarations = false;
    for line in pieces.chunk_by(|_, next| next.line_ends == 0) {
        let Some(first) = line.first() else { continue };
        let apart = first.line_ends > 1;
        let (code, comment) = match line.last() {
            Some(last) if last.is_line_comment() => (&line[..line.len() - 1], last.text),
            _ => (line, ""),
        };
        if code.is_empty() {
            out.push(Line { comment: comment.to_owned(), apart, kind: Kind::Comment, ..Line::default() });
            continue;
        }
        if first.is_any(&FRAME) {
            in_declarations = first.text.len() >= 3 && first.text[..3].eq_ignore_ascii_case("VAR");
            // Titles have a text of their own: only blanks around it go.
            let end = line.last().map_or(first.start, |last| last.start + last.text.len());
            let whole = text[first.start..end].trim_end();
            let code = if first.is("TITLE") || first.is("TITEL") { whole.to_owned() } else { joined(line) };
            out.push(Line { code, apart, ..Line::default() });
            continue;
        }
        let mut line = Line { comment: comment.to_owned(), apart, kind: Kind::Statement, ..Line::default() };
        if in_declarations {
            (line.kind, line.code) = (Kind::Declaration, joined(code));
        } else {
            let mnemonic = mnemonic_of(code);
            let operands = joined(&code[mnemonic..]);
            line.code = code[..mnemonic].iter().map(|piece| piece.text).collect();
            if !operands.is_empty() {
                let blanks = OPERANDS.saturating_sub(line.code.chars().count()).max(1);
                line.code.extend(std::iter::repeat_n(' ', blanks));
                line.code.push_str(&operands);
            }
        }
        out.push(line);
    }
    out
}

/// Number of pieces that the mnemonic has: `LDW>=`, `+I`, `=`.
fn mnemonic_of(line: &[Piece]) -> usize {
    let sign = |piece: &Piece| piece.text.chars().all(|c| c.is_ascii_punctuation());
    let glued = |at: usize| line.get(at).is_some_and(|piece| !piece.spaced);
    if sign(&line[0]) {
        let is_arithmetic = matches!(line[0].text, "+" | "-" | "*" | "/");
        let letters: &[&str] = if is_arithmetic { &["I", "D", "R"] } else { &["I"] };
        return if glued(1) && line[1].is_any(letters) { 2 } else { 1 };
    }
    if glued(1) && matches!(line[1].text, "=" | "==" | "<>" | ">=" | "<=" | ">" | "<") { 2 } else { 1 }
}

/// The pieces with one blank where there are blanks; none before a comma, one after it.
fn joined(pieces: &[Piece]) -> String {
    let mut out = String::new();
    for (at, piece) in pieces.iter().enumerate() {
        let after_comma = at > 0 && pieces[at - 1].text == ",";
        if at > 0 && piece.text != "," && (piece.spaced || after_comma) {
            out.push(' ');
        }
        out.push_str(piece.text);
    }
    out
}
