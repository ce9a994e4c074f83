//! Expressions while they are built: trees that are not too deep for code that walks them.

use std::ops::Range;

use plcc_diag::Span;

use super::state::ParseState;
use crate::scl::ast::{BinaryOp, Expr, ExprKind, UnaryOp};

/// How deep an expression may be nested.
const DEPTH_MAX: usize = 1000;

/// An expression and the depth of its tree.
pub struct Sub {
    pub expr: Expr,
    pub depth: usize,
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

    /// A node over parts of depth `depth`; a tree that is too deep is reported and left out.
    pub fn over<T, R>(state: &mut ParseState<T, R>, depth: usize, span: Span, node: impl FnOnce() -> ExprKind) -> Sub {
        if depth >= DEPTH_MAX {
            state.too_many_parts(span, DEPTH_MAX);
            return Sub::leaf(ExprKind::Error, span);
        }
        Sub { expr: Expr { kind: node(), span }, depth: depth + 1 }
    }

    /// `REF(self)` and others: a node around the expression.
    pub fn inside<T, R>(
        self,
        state: &mut ParseState<T, R>,
        range: Range<usize>,
        node: impl FnOnce(Box<Expr>) -> ExprKind,
    ) -> Sub {
        let span = state.span(range);
        Sub::over(state, self.depth, span, || node(Box::new(self.expr)))
    }

    /// A node around the expression that begins with it and ends at `end`.
    pub fn suffixed<T, R>(
        self,
        state: &mut ParseState<T, R>,
        end: usize,
        node: impl FnOnce(Box<Expr>) -> ExprKind,
    ) -> Sub {
        let start = self.expr.span.start as usize;
        self.inside(state, start..end, node)
    }

    /// `self op right`, with the operator at `sign`.
    pub fn binary<T, R>(self, state: &mut ParseState<T, R>, op: BinaryOp, right: Sub, sign: Range<usize>) -> Sub {
        let span = self.expr.span.to(right.expr.span);
        let op_span = state.span(sign);
        Sub::over(state, self.depth.max(right.depth), span, || ExprKind::Binary {
            op,
            left: Box::new(self.expr),
            right: Box::new(right.expr),
            op_span,
        })
    }

    /// `op self`, from byte `start` on.
    pub fn unary<T, R>(self, state: &mut ParseState<T, R>, op: UnaryOp, start: usize) -> Sub {
        let end = self.expr.span.end as usize;
        self.inside(state, start..end, |operand| ExprKind::Unary { op, operand })
    }

    /// `self[indices]`
    pub fn index<T, R>(self, state: &mut ParseState<T, R>, indices: Vec<Sub>, end: usize) -> Sub {
        let depth = indices.iter().map(|index| index.depth).max().unwrap_or(0).max(self.depth);
        let span = state.span(self.expr.span.start as usize..end);
        Sub::over(state, depth, span, || ExprKind::Index {
            base: Box::new(self.expr),
            indices: indices.into_iter().map(|index| index.expr).collect(),
        })
    }
}
