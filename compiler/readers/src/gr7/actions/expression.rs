//! Actions for expressions: operands, and trees that are not too deep.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, Span};

use crate::gr7::context::Context;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{Area, OperandKind};
use plcc_syntax::scl::ast::{Argument, BinaryOp, Expr, ExprKind, Literal, Name, NameForm, UnaryOp};
use plcc_syntax::scl::{address, literal as constant};

/// How deep an expression may be nested. Code that walks the tree may recurse.
const DEPTH_MAX: usize = 1000;

/// From this many operands on, the tree of a chain of AND or OR is balanced: exported conditions have thousands.
const CHAIN_MAX: usize = 64;

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
}

/// A node over parts of depth `depth`; a tree that is too deep is reported and left out.
fn build(context: &mut Context, depth: usize, span: Span, node: impl FnOnce() -> ExprKind) -> Sub {
    if depth >= DEPTH_MAX {
        context.report(
            Diagnostic::new(Code::Syntax, Span { end: span.start + 1, ..span }, "this expression has too many parts")
                .label("begins here")
                .help(format!(
                    "at most {DEPTH_MAX} operators may follow one another; store a part of it in a memory bit"
                )),
        );
        return Sub::leaf(ExprKind::Error, span);
    }
    Sub { expr: Expr { kind: node(), span }, depth: depth + 1 }
}

pub fn binary(context: &mut Context, op: BinaryOp, left: Sub, right: Sub, sign: Range<usize>) -> Sub {
    let span = left.expr.span.to(right.expr.span);
    let op_span = context.span(sign);
    build(context, left.depth.max(right.depth), span, || ExprKind::Binary {
        op,
        left: Box::new(left.expr),
        right: Box::new(right.expr),
        op_span,
    })
}

/// `a AND b AND c`: from the left, or balanced if there are many.
pub fn chain(context: &mut Context, op: BinaryOp, first: Sub, rest: Vec<(usize, usize, Sub)>) -> Sub {
    if rest.len() < CHAIN_MAX {
        return rest.into_iter().fold(first, |left, (start, end, right)| binary(context, op, left, right, start..end));
    }
    // Neighbours are joined until one is left; each keeps the operator before it.
    let mut row: Vec<(Range<usize>, Sub)> = vec![(0..0, first)];
    row.extend(rest.into_iter().map(|(start, end, sub)| (start..end, sub)));
    while row.len() > 1 {
        let mut joined = Vec::with_capacity(row.len().div_ceil(2));
        let mut left = row.into_iter();
        while let Some((before, sub)) = left.next() {
            joined.push(match left.next() {
                Some((sign, right)) => (before, binary(context, op, sub, right, sign)),
                None => (before, sub),
            });
        }
        row = joined;
    }
    match row.pop() {
        Some((_, sub)) => sub,
        None => Sub::leaf(ExprKind::Error, Span::default()),
    }
}

pub fn unary(context: &mut Context, op: UnaryOp, operand: Sub, start: usize) -> Sub {
    let span = context.span(start..operand.expr.span.end as usize);
    build(context, operand.depth, span, || ExprKind::Unary { op, operand: Box::new(operand.expr) })
}

/// `a SHL 2`: the function with both as arguments.
pub fn shift(context: &mut Context, function: &str, left: Sub, right: Sub, word: Range<usize>) -> Sub {
    let span = left.expr.span.to(right.expr.span);
    let word_span = context.span(word);
    let formal = |text: &str| Some(Name { text: text.to_owned(), form: NameForm::Bare, span: word_span });
    let argument = |name: &str, value: Expr| {
        let span = value.span;
        Argument { name: formal(name), output: false, value: Some(value), span }
    };
    let name = Name { text: function.to_owned(), form: NameForm::Bare, span: word_span };
    build(context, left.depth.max(right.depth), span, || ExprKind::Call {
        callee: Box::new(Expr { kind: ExprKind::Name(name), span: word_span }),
        arguments: vec![argument("IN", left.expr), argument("N", right.expr)],
    })
}

/// `TRUE`, a number in a form that is also a name (`1e5`), or a name.
pub fn name(name: Name) -> Sub {
    let span = name.span;
    let bool = |bits| ExprKind::Literal(Literal::Typed { ty: Elementary::Bool, bits });
    let kind = match name.form {
        NameForm::Bare if name.text.eq_ignore_ascii_case("TRUE") => bool(1),
        NameForm::Bare if name.text.eq_ignore_ascii_case("FALSE") => bool(0),
        NameForm::Bare if is_real(&name.text) => match constant::parse(&name.text) {
            Ok(read) => ExprKind::Literal(read.value),
            Err(_) => ExprKind::Name(name),
        },
        _ => ExprKind::Name(name),
    };
    Sub::leaf(kind, span)
}

/// `1e5`
fn is_real(word: &str) -> bool {
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    word.split_once(['e', 'E']).is_some_and(|(mantissa, exponent)| digits(mantissa) && digits(exponent))
}

pub fn absolute(context: &mut Context, text: &str, range: Range<usize>) -> Sub {
    let span = context.span(range);
    match address_of(context, text, span) {
        Some(operand) => Sub::leaf(ExprKind::Absolute(operand), span),
        None => Sub::leaf(ExprKind::Error, span),
    }
}

/// The operand that an address names; text that is not an address is reported.
fn address_of(context: &mut Context, text: &str, span: Span) -> Option<OperandKind> {
    let operand = address::token(&text.replace(' ', ""), span);
    if operand.is_none() {
        context.report(
            Diagnostic::new(Code::AddressRange, span, format!("`{text}` is not an address"))
                .label("no area has this address")
                .help("write e.g. `MW10`, `I0.7`, `DB1.DBX2.0`; bits go from 0 to 7"),
        );
    }
    operand
}

pub fn literal(context: &mut Context, text: &str, range: Range<usize>) -> Sub {
    let span = context.span(range);
    match constant::parse(text) {
        Ok(read) => {
            if let Some(number) = read.wrapped {
                context.report(
                    Diagnostic::new(Code::Tolerated, span, format!("`{text}` is outside the range of its type"))
                        .label(format!("read as {number}"))
                        .help("write the negative number, or a bit string such as `16#FFFF`"),
                );
            }
            Sub::leaf(ExprKind::Literal(read.value), span)
        }
        Err(error) => {
            let mut diagnostic = Diagnostic::new(error.code, span, error.title).label(error.label);
            diagnostic.help = error.help;
            context.report(diagnostic);
            Sub::leaf(ExprKind::Error, span)
        }
    }
}

pub fn member(context: &mut Context, base: Sub, name: Name) -> Sub {
    let span = base.expr.span.to(name.span);
    build(context, base.depth, span, || ExprKind::Member { base: Box::new(base.expr), name })
}

/// `DB10.DBX0.0`
pub fn member_absolute(context: &mut Context, base: Sub, text: &str, range: Range<usize>) -> Sub {
    let part = context.span(range);
    let span = base.expr.span.to(part);
    match address_of(context, text, part) {
        Some(OperandKind::Absolute { area: Area::Db, width, byte, bit }) => build(context, base.depth, span, || {
            ExprKind::MemberAbsolute { base: Box::new(base.expr), width, byte, bit }
        }),
        Some(_) => {
            context.report(
                Diagnostic::new(Code::Syntax, part, "only an address in a data block can follow a point")
                    .label("an address of another area")
                    .help("write e.g. `DB10.DBX0.0`"),
            );
            Sub::leaf(ExprKind::Error, span)
        }
        None => Sub::leaf(ExprKind::Error, span),
    }
}

pub fn index(context: &mut Context, base: Sub, indices: Vec<Sub>, end: usize) -> Sub {
    let depth = indices.iter().map(|index| index.depth).max().unwrap_or(0).max(base.depth);
    let span = context.span(base.expr.span.start as usize..end);
    build(context, depth, span, || ExprKind::Index {
        base: Box::new(base.expr),
        indices: indices.into_iter().map(|index| index.expr).collect(),
    })
}

/// An argument and its depth.
pub fn argument(context: &Context, name: Option<Name>, value: Option<Sub>, range: Range<usize>) -> (Argument, usize) {
    let depth = value.as_ref().map_or(0, |value| value.depth);
    let value = value.map(|value| value.expr);
    (Argument { name, output: false, value, span: context.span(range) }, depth)
}

pub fn call(context: &mut Context, callee: Sub, arguments: Vec<(Argument, usize)>, end: usize) -> Sub {
    let depth = arguments.iter().map(|(_, depth)| *depth).max().unwrap_or(0).max(callee.depth);
    let span = context.span(callee.expr.span.start as usize..end);
    build(context, depth, span, || ExprKind::Call {
        callee: Box::new(callee.expr),
        arguments: arguments.into_iter().map(|(argument, _)| argument).collect(),
    })
}
