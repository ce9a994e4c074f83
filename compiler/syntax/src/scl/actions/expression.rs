//! Actions for expressions and statements: depth, targets of assignments, arguments.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, Span};

use crate::ast::{Area, BlockPrefix, OperandKind};
use crate::front::Sub;
use crate::scl::address;
use crate::scl::ast::{Argument, AssignOp, Expr, ExprKind, Name, Statement, StatementKind};
use crate::scl::messages::State;

/// An argument and its depth.
pub fn argument(
    state: &State,
    name: Option<Name>,
    output: bool,
    value: Option<Sub>,
    range: Range<usize>,
) -> (Option<Argument>, usize) {
    let span = state.span(range);
    let depth = value.as_ref().map_or(0, |value| value.depth);
    (Some(Argument { name, output, value: value.map(|value| value.expr), span }), depth)
}

pub fn call(state: &mut State, callee: Sub, arguments: Vec<(Option<Argument>, usize)>, end: usize) -> Sub {
    let depth = arguments.iter().map(|(_, depth)| *depth).max().unwrap_or(0).max(callee.depth);
    let span = state.span(callee.expr.span.start as usize..end);
    if arguments.iter().any(|(argument, _)| argument.is_none()) {
        return Sub::leaf(ExprKind::Error, span);
    }
    Sub::over(state, depth, span, || ExprKind::Call {
        callee: Box::new(callee.expr),
        arguments: arguments.into_iter().filter_map(|(argument, _)| argument).collect(),
    })
}

/// `DB10.DX0.0`, `"Db".%DBW4`.
pub fn member_absolute(state: &mut State, base: Sub, operand: OperandKind, range: Range<usize>) -> Sub {
    let end = range.end;
    match operand {
        OperandKind::Absolute { area: Area::Db, width, byte, bit } => {
            base.suffixed(state, end, |base| ExprKind::MemberAbsolute { base, width, byte, bit })
        }
        _ => {
            let span = state.span(range);
            state.report(
                Diagnostic::new(Code::Syntax, span, "only an address in a data block can follow a point")
                    .label("an address of another area")
                    .help("write e.g. `DB10.DX0.0` or `\"Data\".%DBW4`"),
            );
            Sub::leaf(ExprKind::Error, span)
        }
    }
}

/// `DB10` from its prefix and number.
pub fn block_word((prefix, number): (BlockPrefix, u32)) -> String {
    format!("{}{number}", prefix.letters())
}

/// An error that has been reported remains an error node.
pub fn expression_statement(value: Expr) -> StatementKind {
    if value.kind == ExprKind::Error { StatementKind::Error } else { StatementKind::Expression(value) }
}

/// Statements between `CASE … OF` and the first value never run.
pub fn before_arms(state: &mut State, statements: &[Statement]) {
    let Some(first) =
        statements.iter().find(|statement| !matches!(statement.kind, StatementKind::Empty | StatementKind::Error))
    else {
        return;
    };
    state.report(
        Diagnostic::new(Code::Syntax, first.span, "this statement comes before the first value of CASE")
            .label("no value and `:` before it")
            .help("write the value that selects it before it, e.g. `1: a := b;`"),
    );
}

pub fn check_targets(state: &mut State, targets: &[(Expr, AssignOp)]) {
    for (target, _) in targets {
        check_target(state, target);
    }
}

/// The operator at the end of a line after which another statement begins: `q := a AND`, `b := TRUE;`.
fn open_operator(state: &State, target: &Expr) -> Option<Span> {
    let mut part = target;
    while let ExprKind::Binary { right, op_span, .. } = &part.kind {
        let between = state.text.get(op_span.end as usize..right.span.start as usize)?;
        if between.contains('\n') {
            return Some(*op_span);
        }
        part = right;
    }
    None
}

/// Whether something can be assigned to the expression.
pub fn check_target(state: &mut State, target: &Expr) {
    let fits = match &target.kind {
        ExprKind::Name(_)
        | ExprKind::Absolute(_)
        | ExprKind::Member { .. }
        | ExprKind::MemberAbsolute { .. }
        | ExprKind::Slice { .. }
        | ExprKind::Index { .. }
        | ExprKind::Dereference(_)
        | ExprKind::Error => true,
        // `%MW(#i)`: the printed form of `MW[i]`.
        ExprKind::Call { callee, .. } => match &callee.kind {
            ExprKind::Name(name) => address::area_word(&name.text).is_some(),
            ExprKind::Member { name, .. } => address::db_area_word(&name.text).is_some(),
            _ => false,
        },
        _ => false,
    };
    // The binder knows better what is wrong with a call.
    let call = matches!(target.kind, ExprKind::Call { .. });
    if let Some(operator) = open_operator(state, target) {
        let sign = &state.text[operator.range()];
        let title = format!("`{sign}` has no right side");
        let help = format!("write a variable or a constant after `{sign}`, or remove it");
        state.report(
            Diagnostic::new(Code::Syntax, operator, title).label("an operand is missing after this").help(help),
        );
    } else if !fits && !call {
        let text = &state.text[target.span.range()];
        let title = if text.len() > 40 || text.contains('\n') {
            "nothing can be assigned to this expression".to_owned()
        } else {
            format!("nothing can be assigned to `{text}`")
        };
        state.report(
            Diagnostic::new(Code::Syntax, target.span, title).label("not a variable").help(
                "write a variable, an element of an array, a component or an address to the left of the assignment",
            ),
        );
    }
}
