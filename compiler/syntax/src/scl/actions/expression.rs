//! Actions for expressions and statements: depth, targets of assignments, arguments.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, Span};

use crate::ast::{Area, BlockPrefix, OperandKind};
use crate::scl::address;
use crate::scl::ast::{Argument, AssignOp, BinaryOp, Expr, ExprKind, Name, Statement, StatementKind, UnaryOp};
use crate::scl::context::Context;

/// How deep an expression may be nested. Code that walks the tree may recurse.
const DEPTH_MAX: usize = 1000;

/// An expression and the depth of its tree.
pub struct Sub {
    pub expr: Expr,
    depth: usize,
}

impl Sub {
    pub fn leaf(kind: ExprKind, span: Span) -> Sub {
        Sub { expr: Expr { kind, span }, depth: 1 }
    }

    /// The same expression with its parentheses.
    pub fn spanning(mut self, span: Span) -> Sub {
        self.expr.span = span;
        self
    }

    /// `REF(self)` and others: a node around the expression.
    pub fn inside(self, context: &mut Context, range: Range<usize>, node: impl FnOnce(Box<Expr>) -> ExprKind) -> Sub {
        let span = context.span(range.start, range.end);
        let depth = self.depth;
        build(context, depth, span, || node(Box::new(self.expr)))
    }

    /// A node around the expression that begins with it and ends at `end`.
    pub fn suffixed(self, context: &mut Context, end: usize, node: impl FnOnce(Box<Expr>) -> ExprKind) -> Sub {
        let start = self.expr.span.start as usize;
        self.inside(context, start..end, node)
    }
}

/// A node over parts of depth `depth`; a tree that is too deep is reported and left out.
fn build(context: &mut Context, depth: usize, span: Span, node: impl FnOnce() -> ExprKind) -> Sub {
    if depth >= DEPTH_MAX {
        too_deep(context, span);
        return Sub::leaf(ExprKind::Error, span);
    }
    Sub { expr: Expr { kind: node(), span }, depth: depth + 1 }
}

fn too_deep(context: &mut Context, span: Span) {
    context.report(
        Diagnostic::new(Code::Syntax, Span { end: span.start + 1, ..span }, "this expression has too many parts")
            .label("begins here")
            .help(format!("at most {DEPTH_MAX} operators may follow one another; store a part of it in a variable")),
    );
}

pub fn binary(context: &mut Context, left: Sub, op: BinaryOp, right: Sub, sign: Range<usize>) -> Sub {
    let span = left.expr.span.to(right.expr.span);
    let op_span = context.span(sign.start, sign.end);
    build(context, left.depth.max(right.depth), span, || ExprKind::Binary {
        op,
        left: Box::new(left.expr),
        right: Box::new(right.expr),
        op_span,
    })
}

pub fn unary(context: &mut Context, op: UnaryOp, operand: Sub, start: usize) -> Sub {
    let end = operand.expr.span.end as usize;
    operand.inside(context, start..end, |operand| ExprKind::Unary { op, operand })
}

pub fn index(context: &mut Context, base: Sub, indices: Vec<Sub>, end: usize) -> Sub {
    let depth = indices.iter().map(|index| index.depth).max().unwrap_or(0).max(base.depth);
    let span = context.span(base.expr.span.start as usize, end);
    build(context, depth, span, || ExprKind::Index {
        base: Box::new(base.expr),
        indices: indices.into_iter().map(|index| index.expr).collect(),
    })
}

/// An argument and its depth.
pub fn argument(
    context: &Context,
    name: Option<Name>,
    output: bool,
    value: Option<Sub>,
    range: Range<usize>,
) -> (Option<Argument>, usize) {
    let span = context.span(range.start, range.end);
    let depth = value.as_ref().map_or(0, |value| value.depth);
    (Some(Argument { name, output, value: value.map(|value| value.expr), span }), depth)
}

pub fn call(context: &mut Context, callee: Sub, arguments: Vec<(Option<Argument>, usize)>, end: usize) -> Sub {
    let depth = arguments.iter().map(|(_, depth)| *depth).max().unwrap_or(0).max(callee.depth);
    let span = context.span(callee.expr.span.start as usize, end);
    if arguments.iter().any(|(argument, _)| argument.is_none()) {
        return Sub::leaf(ExprKind::Error, span);
    }
    build(context, depth, span, || ExprKind::Call {
        callee: Box::new(callee.expr),
        arguments: arguments.into_iter().filter_map(|(argument, _)| argument).collect(),
    })
}

/// `DB10.DX0.0`, `"Db".%DBW4`.
pub fn member_absolute(context: &mut Context, base: Sub, operand: OperandKind, range: Range<usize>) -> Sub {
    let end = range.end;
    match operand {
        OperandKind::Absolute { area: Area::Db, width, byte, bit } => {
            base.suffixed(context, end, |base| ExprKind::MemberAbsolute { base, width, byte, bit })
        }
        _ => {
            let span = context.span(range.start, range.end);
            context.report(
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
pub fn before_arms(context: &mut Context, statements: &[Statement]) {
    let Some(first) =
        statements.iter().find(|statement| !matches!(statement.kind, StatementKind::Empty | StatementKind::Error))
    else {
        return;
    };
    context.report(
        Diagnostic::new(Code::Syntax, first.span, "this statement comes before the first value of CASE")
            .label("no value and `:` before it")
            .help("write the value that selects it before it, e.g. `1: a := b;`"),
    );
}

pub fn check_targets(context: &mut Context, targets: &[(Expr, AssignOp)]) {
    for (target, _) in targets {
        check_target(context, target);
    }
}

/// Whether something can be assigned to the expression.
pub fn check_target(context: &mut Context, target: &Expr) {
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
    if !fits {
        let text = &context.text[target.span.range()];
        let title = if text.len() > 40 || text.contains('\n') {
            "nothing can be assigned to this expression".to_owned()
        } else {
            format!("nothing can be assigned to `{text}`")
        };
        context.report(
            Diagnostic::new(Code::Syntax, target.span, title).label("not a variable").help(
                "write a variable, an element of an array, a component or an address to the left of the assignment",
            ),
        );
    }
}
