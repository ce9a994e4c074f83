//! Assertions of a source in STL that networks of LAD and FBD cannot keep.

use plcc_diag::{Code, Diagnostic, FileId, Severity};
use plcc_readers::ReadOptions;
use plcc_syntax::ast::{AssertSide, Block, Pragma, Statement, StatementKind};
use plcc_syntax::stl::Mnemonics;

/// Warnings of assertions that check a register, which only statements have. They are comments where a source is converted, so the
/// text is read once more.
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
    networks.flat_map(|network| &network.statements).filter_map(of_register).collect()
}

fn of_register(statement: &Statement) -> Option<Diagnostic> {
    let StatementKind::Pragma(Pragma { assert: Some(assertion), .. }) = &statement.kind else { return None };
    let mut sides = assertion.comparisons.iter().flat_map(|comparison| [&comparison.left, &comparison.right]);
    let register = sides.find(|side| matches!(side.value, AssertSide::Register(_)))?;
    let mut message = Diagnostic::new(
        Code::NotConverted,
        register.span,
        "this assertion checks a register, which networks of LAD and FBD do not have",
    );
    message.severity = Severity::Warning;
    let label = "`plcc test` refuses it in the new file";
    Some(message.label(label).help("check an address or a variable that the network writes, or remove the assertion"))
}
