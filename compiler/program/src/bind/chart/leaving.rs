//! Code of a chart must not end the block: the code after it must run in each call.

use plcc_diag::{Code, Span};
use plcc_syntax::stl::StlInsn;

use crate::bind::chart::ChartBinder;
use plcc_model::StlStatementKind;
use plcc_model::scl::{Statement, StatementKind, walk};

impl ChartBinder<'_, '_> {
    /// Reports RETURN and other exits among statements of an action, a condition or a permanent instruction.
    pub(super) fn check_leaving(&mut self, statements: &[Statement]) {
        if let Some(span) = block_end(statements) {
            self.scl().refuse(
                Code::ElementPlace,
                span,
                "code of a chart cannot end the block",
                "steps and outputs would not be fully processed",
                "put the code that it skips into an IF, or jump to a label",
            );
        }
    }
}

/// The first statement that leaves the block.
fn block_end(statements: &[Statement]) -> Option<Span> {
    walk::find(statements, &|statement| match &statement.kind {
        StatementKind::Return(_) => Some(statement.span),
        StatementKind::Stl(stl) => match &stl.kind {
            StlStatementKind::Instruction {
                insn: StlInsn::BlockEnd | StlInsn::BlockEndUnconditional | StlInsn::BlockEndConditional,
                ..
            } => Some(stl.span),
            _ => None,
        },
        _ => None,
    })
}
