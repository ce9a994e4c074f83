//! Actions for expressions: operands, and trees that are not too deep.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, Span};

use crate::gr7::lexer::BLANKS;
use crate::gr7::messages::State;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{Area, OperandKind};
use plcc_syntax::front::Sub;
use plcc_syntax::scl::ast::{Argument, BinaryOp, Expr, ExprKind, Literal, Name, NameForm};
use plcc_syntax::scl::{address, literal as constant};

/// From this many operands on, the tree of a chain of AND or OR is balanced: exported conditions have thousands.
const CHAIN_MAX: usize = 64;

/// `a AND b AND c`: from the left, or balanced if there are many.
pub fn chain(state: &mut State, op: BinaryOp, first: Sub, rest: Vec<(usize, usize, Sub)>) -> Sub {
    if rest.len() < CHAIN_MAX {
        return rest.into_iter().fold(first, |left, (start, end, right)| left.binary(state, op, right, start..end));
    }
    // Neighbours are joined until one is left; each keeps the operator before it.
    let mut row: Vec<(Range<usize>, Sub)> = vec![(0..0, first)];
    row.extend(rest.into_iter().map(|(start, end, sub)| (start..end, sub)));
    while row.len() > 1 {
        let mut joined = Vec::with_capacity(row.len().div_ceil(2));
        let mut left = row.into_iter();
        while let Some((before, sub)) = left.next() {
            joined.push(match left.next() {
                Some((sign, right)) => (before, sub.binary(state, op, right, sign)),
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

/// `a SHL 2`: the function with both as arguments.
pub fn shift(state: &mut State, function: &str, left: Sub, right: Sub, word: Range<usize>) -> Sub {
    let span = left.expr.span.to(right.expr.span);
    let word_span = state.span(word);
    let formal = |text: &str| Some(Name { text: text.to_owned(), form: NameForm::Bare, span: word_span });
    let argument = |name: &str, value: Expr| {
        let span = value.span;
        Argument { name: formal(name), output: false, value: Some(value), span }
    };
    let name = Name { text: function.to_owned(), form: NameForm::Bare, span: word_span };
    Sub::over(state, left.depth.max(right.depth), span, || ExprKind::Call {
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

pub fn absolute(state: &mut State, text: &str, range: Range<usize>) -> Sub {
    let span = state.span(range);
    match address_of(state, text, span) {
        Some(operand) => Sub::leaf(ExprKind::Absolute(operand), span),
        None => Sub::leaf(ExprKind::Error, span),
    }
}

/// The operand that an address names; text that is not an address is reported.
fn address_of(state: &mut State, text: &str, span: Span) -> Option<OperandKind> {
    let operand = address::token(&text.replace(BLANKS, ""), span);
    if operand.is_none() {
        let message = Diagnostic::new(Code::AddressRange, span, format!("`{text}` is not an address"));
        state.report(match address::with_carried_bit(text) {
            Some(meant) => message
                .label("a byte has the bits 0 to 7")
                .help(format!("is `{meant}` meant, the bit after those of the byte, or another bit from 0 to 7?")),
            None => message
                .label("no area has this address")
                .help("write e.g. `MW10`, `I0.7`, `DB1.DBX2.0`; bits go from 0 to 7"),
        });
    }
    operand
}

pub fn literal(state: &mut State, text: &str, range: Range<usize>) -> Sub {
    let span = state.span(range);
    match constant::parse(text) {
        Ok(read) => {
            if let Some(number) = read.wrapped {
                state.report(
                    Diagnostic::new(Code::Tolerated, span, format!("`{text}` is outside the range of its type"))
                        .label(format!("read as {number}"))
                        .help("write the negative number, or a bit string such as `16#FFFF`"),
                );
            }
            Sub::leaf(ExprKind::Literal(read.value), span)
        }
        Err(error) => {
            state.report(error.at(span));
            Sub::leaf(ExprKind::Error, span)
        }
    }
}

pub fn member(state: &mut State, base: Sub, name: Name) -> Sub {
    let end = name.span.end as usize;
    base.suffixed(state, end, |base| ExprKind::Member { base, name })
}

/// `DB10.DBX0.0`
pub fn member_absolute(state: &mut State, base: Sub, text: &str, range: Range<usize>) -> Sub {
    let part = state.span(range);
    let span = base.expr.span.to(part);
    match address_of(state, text, part) {
        Some(OperandKind::Absolute { area: Area::Db, width, byte, bit }) => Sub::over(state, base.depth, span, || {
            ExprKind::MemberAbsolute { base: Box::new(base.expr), width, byte, bit }
        }),
        Some(_) => {
            state.report(
                Diagnostic::new(Code::Syntax, part, "only an address in a data block can follow a point")
                    .label("an address of another area")
                    .help("write e.g. `DB10.DBX0.0`"),
            );
            Sub::leaf(ExprKind::Error, span)
        }
        None => Sub::leaf(ExprKind::Error, span),
    }
}

/// An argument and its depth.
pub fn argument(state: &State, name: Option<Name>, value: Option<Sub>, range: Range<usize>) -> (Argument, usize) {
    let depth = value.as_ref().map_or(0, |value| value.depth);
    let value = value.map(|value| value.expr);
    (Argument { name, output: false, value, span: state.span(range) }, depth)
}

pub fn call(state: &mut State, callee: Sub, arguments: Vec<(Argument, usize)>, end: usize) -> Sub {
    let depth = arguments.iter().map(|(_, depth)| *depth).max().unwrap_or(0).max(callee.depth);
    let span = state.span(callee.expr.span.start as usize..end);
    Sub::over(state, depth, span, || ExprKind::Call {
        callee: Box::new(callee.expr),
        arguments: arguments.into_iter().map(|(argument, _)| argument).collect(),
    })
}
