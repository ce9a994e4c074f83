//! Statements of STL: label, mnemonic and operand stand in columns, as STEP 7 writes them.

use std::collections::BTreeMap;

use plcc_syntax::Language;
use plcc_syntax::ast::{Block, CodeBlock, SourceUnit, Statement, StatementKind};

use crate::lines::{Kind, Line};
use crate::piece::{Begins, Part, Piece};

/// The column of mnemonics.
const MNEMONICS: usize = 6;

/// The column of operands.
const OPERANDS: usize = 12;

/// The bytes at which labels, mnemonics, operands and parameters begin. None: there is no statement of STL.
pub fn statements(unit: &SourceUnit) -> Option<BTreeMap<usize, Begins>> {
    let mut starts = BTreeMap::new();
    for block in &unit.blocks {
        if let Block::Code(block) = block {
            add_block(block, &mut starts);
        }
    }
    (!starts.is_empty()).then_some(starts)
}

fn add_block(block: &CodeBlock, starts: &mut BTreeMap<usize, Begins>) {
    for statement in block.networks().iter().flat_map(|network| &network.statements) {
        add_statement(statement, starts);
    }
}

fn add_statement(statement: &Statement, starts: &mut BTreeMap<usize, Begins>) {
    if let Some(label) = &statement.label {
        starts.insert(label.span.start as usize, Begins::Label);
    }
    match &statement.kind {
        StatementKind::Instruction { mnemonic_span, operand, .. } => {
            starts.insert(mnemonic_span.start as usize, Begins::Mnemonic);
            if let Some(operand) = operand {
                starts.entry(operand.span.start as usize).or_insert(Begins::Operand);
            }
        }
        StatementKind::Call(call) => {
            starts.entry(call.target.span.start as usize).or_insert(Begins::Operand);
            for parameter in &call.parameters {
                starts.insert(parameter.name_span.start as usize, Begins::Parameter);
            }
        }
        StatementKind::Empty | StatementKind::Pragma(_) | StatementKind::Error => {}
    }
}

/// Tells the pieces of STL what they begin. The word CALL is the piece before its target.
pub fn mark(parts: &mut [Part], starts: &BTreeMap<usize, Begins>) {
    for part in parts.iter_mut().filter(|part| part.language == Language::Stl) {
        for at in 0..part.pieces.len() {
            let Some(begins) = starts.get(&part.pieces[at].start) else { continue };
            part.pieces[at].begins = *begins;
            if *begins == Begins::Operand
                && at > 0
                && part.pieces[at - 1].is("CALL")
                && part.pieces[at - 1].begins == Begins::Nothing
            {
                part.pieces[at - 1].begins = Begins::Mnemonic;
            }
        }
    }
}

/// Whether a statement begins at a piece: a new line.
pub fn begins_statement(pieces: &[Piece], at: usize) -> bool {
    match pieces[at].begins {
        Begins::Label => true,
        Begins::Mnemonic => {
            // A mnemonic stays on the line of its label, if it is there.
            let before = &pieces[..at];
            !matches!(before, [.., label, colon] if colon.text == ":" && label.begins == Begins::Label)
        }
        Begins::Nothing | Begins::Operand | Begins::Parameter => false,
    }
}

/// A line of code. `name_width`: columns of the names of parameters of this CALL.
pub fn line(pieces: &[Piece], name_width: usize) -> Line {
    let mut line = Line { indent: MNEMONICS, kind: Kind::Statement, ..Line::default() };
    let Some(first) = pieces.first() else { return line };
    if first.begins == Begins::Parameter || first.begins == Begins::Nothing && !first.is_comment() {
        // A parameter, or what else continues a statement.
        line.indent = OPERANDS;
        line.code = operands(pieces, name_width);
        return line;
    }
    let mut at = 0;
    let mut column = 0;
    if first.begins == Begins::Label {
        line.indent = 0;
        let colon = pieces.iter().position(|piece| piece.text == ":").map_or(pieces.len(), |colon| colon + 1);
        line.code = pieces[..colon].iter().map(|piece| piece.text).collect();
        at = colon;
        if at == pieces.len() {
            return line;
        }
        pad(&mut line.code, MNEMONICS);
        column = line.code.chars().count();
    }
    let operand = (at..pieces.len()).find(|index| {
        let piece = &pieces[*index];
        *index > at && (piece.begins == Begins::Operand || piece.text == ";" || piece.is_comment())
    });
    let operand = operand.unwrap_or(pieces.len());
    for (index, piece) in pieces[at..operand].iter().enumerate() {
        if index > 0 && piece.spaced {
            line.code.push(' ');
        }
        line.code.push_str(piece.text);
    }
    let rest = operands(&pieces[operand..], name_width);
    if rest.starts_with(';') {
        line.code.push_str(&rest);
    } else if !rest.is_empty() {
        pad(&mut line.code, column + OPERANDS - MNEMONICS);
        line.code.push_str(&rest);
    }
    line
}

/// Blanks up to a column, at least one.
fn pad(code: &mut String, column: usize) {
    let blanks = column.saturating_sub(code.chars().count()).max(1);
    code.extend(std::iter::repeat_n(' ', blanks));
}

/// Operands and parameters: one blank where there are blanks, none before `;` and `,`.
fn operands(pieces: &[Piece], name_width: usize) -> String {
    let mut out = String::new();
    let mut in_brackets = 0usize;
    let mut named = pieces.first().is_some_and(|first| first.begins == Begins::Parameter);
    for (at, piece) in pieces.iter().enumerate() {
        let before = at.checked_sub(1).map(|before| &pieces[before]);
        match piece.text {
            "[" => in_brackets += 1,
            "]" => in_brackets = in_brackets.saturating_sub(1),
            _ => {}
        }
        let Some(before) = before else {
            out.push_str(piece.text);
            continue;
        };
        let parameter = piece.text == ":=" || before.text == ":=";
        match piece.text {
            ";" | "," => {}
            ":=" => {
                // Names are padded where parameters stand below one another.
                let width = if named { name_width } else { 0 };
                named = false;
                out.extend(std::iter::repeat_n(' ', width.saturating_sub(out.chars().count()) + 1));
            }
            _ if piece.spaced || parameter || before.text == "," && in_brackets == 0 => out.push(' '),
            _ => {}
        }
        out.push_str(piece.text);
    }
    out
}
