//! Assertions of a source in STL that networks of LAD and FBD cannot keep.

use plcc_diag::{Code, Diagnostic, FileId, Severity};
use plcc_readers::ReadOptions;
use plcc_syntax::ast::{Area, AssertSide, Block, Operand, OperandKind, Pragma, Statement, StatementKind};
use plcc_syntax::stl::Mnemonics;

/// Warnings of assertions that check a register or the open data block, which only statements have. They are comments where a source is
/// converted, so the text is read once more.
pub fn of_registers(file: FileId, text: &str, mnemonics: Mnemonics) -> Vec<Diagnostic> {
    if !text.contains("//@") {
        return Vec::new();
    }
    let options = ReadOptions { mnemonics: Some(mnemonics), pragmas: true, ..ReadOptions::default() };
    let (unit, _) = plcc_readers::parse(file, text, &options);
    let networks = unit.blocks.iter().flat_map(|block| match block {
        Block::Code(block) => block.networks(),
        Block::Data(_) | Block::Type(_) => &[],
    });
    networks.flat_map(|network| &network.statements).filter_map(|one| of_register(one, text)).collect()
}

fn of_register(statement: &Statement, text: &str) -> Option<Diagnostic> {
    let StatementKind::Pragma(Pragma { assert: Some(assertion), .. }) = &statement.kind else { return None };
    let sides = || assertion.comparisons.iter().flat_map(|comparison| [&comparison.left, &comparison.right]);
    let warning = |span, title: &str, label: &str, help: &str| {
        let mut message = Diagnostic::new(Code::NotConverted, span, title);
        message.severity = Severity::Warning;
        Some(message.label(label).help(help))
    };
    if let Some(register) = sides().find(|side| matches!(side.value, AssertSide::Register(_))) {
        return warning(
            register.span,
            "this assertion checks a register, which networks of LAD and FBD do not have",
            "`plcc test` refuses it in the new file",
            "check an address or a variable that the network writes, or remove the assertion",
        );
    }
    let operand = sides().find(|side| matches!(&side.value, AssertSide::Operand(operand) if is_of_open_db(operand)))?;
    warning(
        operand.span,
        "this assertion checks the data block that is open, and between networks of LAD and FBD none is",
        "fails in the new file",
        &format!(
            "write the number of the data block, as in `DB1.{}`",
            text.get(operand.span.range()).unwrap_or_default()
        ),
    )
}

/// `DBW 0`, without the number of a data block.
fn is_of_open_db(operand: &Operand) -> bool {
    matches!(operand.kind, OperandKind::Absolute { area: Area::Db, .. })
}
