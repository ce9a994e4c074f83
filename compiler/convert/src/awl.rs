//! STL of the S7-200 with the other mnemonics, as edits of its text: Micro/WIN has no other notation for it, since LAD and FBD are
//! views of the same statements.

use plcc_diag::Span;
use plcc_syntax::ast::Width;
use plcc_syntax::s7200::ast::{Area, Direct, Operand, OperandKind, Source, StatementKind, SymbolForm};
use plcc_syntax::stl::Mnemonics;

use crate::addresses::Edit;

/// The edits that make a source one with the mnemonics `set`, in the order of the text.
pub fn edits(source: &Source, set: Mnemonics) -> Vec<Edit> {
    let mut edits = Vec::new();
    for statement in source.blocks.iter().flat_map(|block| &block.networks).flat_map(|network| &network.statements) {
        let StatementKind::Instruction { insn, mnemonic_span, operands } = &statement.kind else { continue };
        push(&mut edits, *mnemonic_span, insn.mnemonic(set).into_owned());
        operands.iter().for_each(|operand| of_operand(&mut edits, operand, set));
    }
    for line in &source.data {
        line.address.iter().chain(&line.values).for_each(|operand| of_operand(&mut edits, operand, set));
    }
    edits.sort_by_key(|edit| edit.span.start);
    edits
}

fn of_operand(edits: &mut Vec<Edit>, operand: &Operand, set: Mnemonics) {
    match &operand.kind {
        OperandKind::Direct(direct) => push(edits, after_symbol(operand), address(direct, set)),
        OperandKind::Indirect(inner) | OperandKind::AddressOf(inner) => of_operand(edits, inner, set),
        OperandKind::Constant(_) | OperandKind::Symbol { .. } | OperandKind::Block { .. } | OperandKind::Error => {}
    }
}

/// The place of the address: `I0.0` of `Start:I0.0`, whose symbol stays.
fn after_symbol(operand: &Operand) -> Span {
    let symbol = operand.shown.as_ref().map_or(0, |shown| {
        let signs = match shown.form {
            SymbolForm::Bare => 0,
            SymbolForm::Local => 1,
            SymbolForm::Quoted => 2,
        };
        shown.name.len() + signs + 1
    });
    Span { start: operand.span.start + symbol as u32, ..operand.span }
}

fn push(edits: &mut Vec<Edit>, span: Span, text: String) {
    if span.start < span.end {
        edits.push(Edit { span, text });
    }
}

/// `VW100`, `E0.0`, `AEW4`, `Z5` in the letters of a set.
pub fn address(direct: &Direct, set: Mnemonics) -> String {
    let letters = match (direct.area, set) {
        (Area::I, Mnemonics::De) => "E",
        (Area::Q, Mnemonics::De) => "A",
        (Area::C, Mnemonics::De) => "Z",
        (Area::Hc, Mnemonics::De) => "HZ",
        (Area::Ai, Mnemonics::De) => "AE",
        (Area::Aq, Mnemonics::De) => "AA",
        (area, _) => area.letters(),
    };
    match direct.width {
        Some(Width::Bit) => format!("{letters}{}.{}", direct.number, direct.bit),
        Some(Width::Byte) => format!("{letters}B{}", direct.number),
        Some(Width::Word) => format!("{letters}W{}", direct.number),
        Some(Width::Dword) => format!("{letters}D{}", direct.number),
        Some(Width::Lword) | None => format!("{letters}{}", direct.number),
    }
}
