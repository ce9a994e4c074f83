//! Text form of SCL trees, for `--emit ast`.

use super::ast::{Body, Expr};

/// One line for an expression, fully parenthesised.
pub fn expr(value: &Expr) -> String {
    format!("{:?}", value.kind)
}

/// Lines for the statements of a block, each with its depth.
pub fn body(value: &Body) -> Vec<(usize, String)> {
    value.statements.iter().map(|statement| (0, format!("{:?}", statement.kind))).collect()
}
