//! Comparisons. Source: SCL reference, comparison.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::scl::ast::BinaryOp as Operator;
use plcc_syntax::{Class, Elementary};

use super::assign::value_of;
use super::coerce::{access_has_call, is_untyped};
use super::complex::assignable;
use super::convert::{self, Implicit};
use super::expression::{binary_expr, constant_expr, typed_constant};
use super::numeric::{self, Shape};
use super::value::Value;
use super::{Rules, constant, message, text, time};
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::constant::Constant;
use plcc_binding::rewrite;
use plcc_model::layout;
use plcc_model::scl::{Access, Actual, BinaryOp, CompareOp, Complex, Expr, ExprKind};
use plcc_model::types::DataType;

/// A comparison of structures has at most this many elements.
const ELEMENTS_MAX: u64 = 1024;

/// Library functions: EQ, NE, LT, LE, GT, GE of STRING and of DATE_AND_TIME. Source: STL reference, IEC functions.
const fn library(op: CompareOp) -> (u16, u16) {
    match op {
        CompareOp::Equal => (10, 9),
        CompareOp::GreaterEqual => (13, 12),
        CompareOp::Greater => (15, 14),
        CompareOp::LessEqual => (19, 18),
        CompareOp::Less => (24, 23),
        CompareOp::NotEqual => (29, 28),
    }
}

/// The instruction that returns -1, 0 or 1 for values of this kind.
fn order_of(left: &Value, right: &Value) -> Option<&'static str> {
    if time::is_dtl_value(left) && time::is_dtl_value(right) {
        return Some("COMPARE_DTL");
    }
    let wide = text::is_wide_text(left) && is_any_text(right) || text::is_wide_text(right) && is_any_text(left);
    wide.then_some("COMPARE_WSTRING")
}

impl SclBinder<'_, '_> {
    pub(in crate::bind) fn compare(
        &mut self,
        ctx: &mut SclBlock,
        op: Operator,
        op_span: Span,
        left: Value,
        right: Value,
        span: Span,
    ) -> Option<Expr> {
        let op = compare_op(op)?;
        if ctx.scope.address_numbers {
            self.number_beside_time(&left, &right);
            self.number_beside_time(&right, &left);
        }
        let (left, right) =
            if ctx.scope.address_numbers { self.address_operands(ctx, left, right) } else { (left, right) };
        let (left, right) = self.as_numbers(ctx, left, right)?;
        let compared = match Self::is_compared_again(&left, &right) {
            true => None,
            false => self.compared_type(ctx, &left, &right),
        };
        if let Some(ty) = compared {
            self.decided_before(op, op_span, &left, &right, ty);
            for side in [&left, &right] {
                self.number_for_duration(ctx, side, ty);
            }
            let left = self.convert(ctx, left, ty);
            let right = self.convert(ctx, right, ty);
            return Some(comparison(op, left?, right?, span));
        }
        if let Some(name) = order_of(&left, &right) {
            let order = self.instruction_value(ctx, name, vec![left, right], span)?;
            let Value::Elementary(order) = order else { return None };
            let zero = constant_expr(0, order.ty, span);
            return Some(comparison(op, order, zero, span));
        }
        if time::compare_as_dates(&left, &right) {
            let (left, right) = (self.as_ldt(ctx, left), self.as_ldt(ctx, right));
            return Some(comparison(op, left?, right?, span));
        }
        match (complex_type(&left), complex_type(&right)) {
            (Some(DataType::String(_)), _) | (_, Some(DataType::String(_))) if is_text(&left) && is_text(&right) => {
                let formal = DataType::String(254);
                self.compare_by_call(ctx, library(op).0, left, right, &formal, span)
            }
            (Some(DataType::DateAndTime), Some(DataType::DateAndTime)) => {
                self.compare_by_call(ctx, library(op).1, left, right, &DataType::DateAndTime, span)
            }
            (Some(DataType::Struct(_) | DataType::Array(_)), Some(DataType::Struct(_) | DataType::Array(_))) => {
                self.compare_structures(ctx, op, op_span, left, right, span)
            }
            _ => {
                let s5time = |value: &Value| Shape::of(value) == Shape::Of(Elementary::S5Time);
                let help = if s5time(&left) || s5time(&right) {
                    "convert S5TIME first: S5TIME_TO_TIME(…)".to_string()
                } else if let Value::Elementary(Expr { kind: ExprKind::Compare { right: middle, .. }, .. }) = &left {
                    // `1 < x < 5`
                    let text = |span| self.program.globals.text(span);
                    let (first, middle) = (text(left.span()), text(middle.span));
                    format!("write `{first} AND {middle} {} {}`", text(op_span), text(right.span()))
                } else {
                    self.sides_as_compared(ctx.scope.rules, op_span, &left, &right)
                };
                self.operator_types(op_span, &left, &right, &help);
                None
            }
        }
    }

    /// `S001.T > 5` in a chart of S7-GRAPH V5. `L#5000` is written for milliseconds on purpose.
    fn number_beside_time(&mut self, number: &Value, other: &Value) {
        let text = self.program.globals.text(number.span());
        if Shape::of(other) == Shape::Of(Elementary::Time) && !text.is_empty() && !text.contains('#') {
            self.number_without_unit(number, Elementary::Time);
        }
    }

    /// How two values that do not go together are compared.
    fn sides_as_compared(&self, rules: Rules, op_span: Span, left: &Value, right: &Value) -> String {
        let text = |value: &Value| self.program.globals.text(value.span());
        let (first, sign, second) = (text(left), self.program.globals.text(op_span), text(right));
        let is_string = |value: &Value| matches!(value, Value::Complex { ty: DataType::String(_), .. });
        let converted = |from: Elementary, to: Elementary, text: &str| {
            convert::explicit(rules, from, to).map(|_| message::conversion(from, to, text).trim_matches('`').to_owned())
        };
        match (number_type(left), number_type(right)) {
            (_, Some(ty)) if is_string(left) => format!("write `STRING_TO_{}({first}) {sign} {second}`", ty.name()),
            (Some(ty), _) if is_string(right) => format!("write `{first} {sign} STRING_TO_{}({second})`", ty.name()),
            (Some(_), None) if let Some(number) = number_in_quotes(right, &second) => {
                format!("a number has no quotes: write `{first} {sign} {number}`")
            }
            (None, Some(_)) if let Some(number) = number_in_quotes(left, &first) => {
                format!("a number has no quotes: write `{number} {sign} {second}`")
            }
            _ => match (Shape::of(left), Shape::of(right)) {
                (Shape::Of(Elementary::Bool), Shape::Integer(_)) => {
                    format!("a BOOL is TRUE or FALSE: write `{first}` or `NOT {first}`")
                }
                (Shape::Of(a), Shape::Of(b)) if let Some(second) = converted(b, a, &second) => {
                    format!("convert one of them, as in `{first} {sign} {second}`")
                }
                (Shape::Of(a), Shape::Of(b)) if let Some(first) = converted(a, b, &first) => {
                    format!("convert one of them, as in `{first} {sign} {second}`")
                }
                _ => "both sides must be of one type".to_owned(),
            },
        }
    }

    /// A duration, date or character next to an integer as the integer that it is: the values are compared, and `#time < #udint` is TRUE for
    /// each negative duration. Other pairs stay, and those that do not convert.
    fn as_numbers(&mut self, ctx: &mut SclBlock, left: Value, right: Value) -> Option<(Value, Value)> {
        let (Shape::Of(a), Shape::Of(b)) = (Shape::of(&left), Shape::of(&right)) else { return Some((left, right)) };
        let (rules, strict) = (ctx.scope.rules, ctx.scope.strict);
        let becomes = |from, to| convert::implicit(rules, strict, from, to) == Implicit::Yes;
        let is_address = |value: &Value| is_untyped(ctx, value.span());
        let counts = compared_as_number(a, b) || compared_as_number(b, a);
        if !counts || !(becomes(a, b) || becomes(b, a)) || is_address(&left) || is_address(&right) {
            return Some((left, right));
        }
        let (left, right) = (self.as_number(ctx, left, b), self.as_number(ctx, right, a));
        Some((left?, right?))
    }

    /// A duration, date or character as the integer that it is next to a value of type `other`; other values stay.
    fn as_number(&mut self, ctx: &mut SclBlock, value: Value, other: Elementary) -> Option<Value> {
        let rules = ctx.scope.rules;
        let Some(integer) = Shape::of(&value).elementary().and_then(|ty| integer_of(ty, other)) else {
            return Some(value);
        };
        let own = self.own_type(ctx, value)?;
        convert::explicit_expr(rules, own, integer).map(Value::Elementary)
    }

    /// `1 < x < 5`: the result of a comparison without brackets, next to a number.
    fn is_compared_again(left: &Value, right: &Value) -> bool {
        let Value::Elementary(Expr { kind: ExprKind::Compare { left: first, .. }, span, .. }) = left else {
            return false;
        };
        let in_brackets = span.start < first.span.start;
        !in_brackets && matches!(Shape::of(right), Shape::Integer(_))
    }

    /// The type in which two single values are compared.
    fn compared_type(&self, ctx: &SclBlock, left: &Value, right: &Value) -> Option<Elementary> {
        let (rules, strict) = (ctx.scope.rules, ctx.scope.strict);
        let (a, b) = (Shape::of(left), Shape::of(right));
        match (a, b) {
            (Shape::Of(Elementary::S5Time), _) | (_, Shape::Of(Elementary::S5Time)) => None,
            (Shape::Of(a), Shape::Of(b)) if a == b => Some(a),
            (Shape::Of(Elementary::Bool), Shape::Integer(0 | 1))
            | (Shape::Integer(0 | 1), Shape::Of(Elementary::Bool)) => Some(Elementary::Bool),
            // A constant takes the type of the variable, even that of a bit string.
            (Shape::Of(ty), Shape::Integer(_)) | (Shape::Integer(_), Shape::Of(ty)) => match ty.class() {
                Class::Bits if ty != Elementary::Bool => Some(ty),
                Class::Bits => None,
                Class::Signed | Class::Unsigned | Class::Float => numeric::common(rules, a, b),
                Class::Duration | Class::Date | Class::Character => {
                    (convert::implicit(rules, strict, Elementary::Dint, ty) == Implicit::Yes).then_some(ty)
                }
            },
            (Shape::Of(ty), Shape::Letter) | (Shape::Letter, Shape::Of(ty))
                if ty.class() == Class::Character || ty == Elementary::Byte =>
            {
                Some(ty)
            }
            (Shape::Of(x), Shape::Of(y)) => {
                let both_bits = x.class() == Class::Bits && y.class() == Class::Bits;
                if !both_bits && let Some(ty) = numeric::common(rules, a, b) {
                    return Some(ty);
                }
                let becomes = |from, to| convert::implicit(rules, strict, from, to) == Implicit::Yes;
                let x_first = if x.bits() == y.bits() { !holds_all(x, y) } else { x.bits() < y.bits() };
                let (shorter, longer) = if x_first { (x, y) } else { (y, x) };
                [(shorter, longer), (longer, shorter)]
                    .into_iter()
                    .find(|&(from, to)| becomes(from, to) && to.bits() >= from.bits())
                    .map(|(_, to)| to)
            }
            (Shape::Integer(_) | Shape::Real | Shape::Of(_), Shape::Integer(_) | Shape::Real | Shape::Of(_)) => {
                numeric::common(rules, a, b)
            }
            (Shape::Letter, Shape::Letter) => Some(Elementary::Char),
            (Shape::Letter | Shape::Other, _) | (_, Shape::Letter | Shape::Other) => None,
        }
    }

    /// Reports a comparison in type `ty` with a constant at an end of the values that the other side can have, or beyond it.
    fn decided_before(&mut self, op: CompareOp, op_span: Span, left: &Value, right: &Value, ty: Elementary) {
        let (op, value, number, written) = match (whole_number(left), whole_number(right)) {
            (None, Some(number)) => (op, left, number, right.span()),
            (Some(number), None) => (op.turned(), right, number, left.span()),
            (None, None) | (Some(_), Some(_)) => return,
        };
        let is_whole = |ty: Elementary| ty.is_integer() || (ty.class() == Class::Bits && ty != Elementary::Bool);
        let own = match Shape::of(value) {
            Shape::Of(own) if is_whole(own) && is_whole(ty) => own,
            _ => return,
        };
        let (low, high) = constant::range(own);
        let (least, greatest) = constant::range(ty);
        // Where `ty` does not hold a side, the CPU compares another value.
        if ![low, high, number].iter().all(|side| (least..=greatest).contains(side)) {
            return;
        }
        let always = match op {
            CompareOp::Less if number <= low => false,
            CompareOp::Less if number > high => true,
            CompareOp::GreaterEqual if number <= low => true,
            CompareOp::GreaterEqual if number > high => false,
            CompareOp::Greater if number >= high => false,
            CompareOp::Greater if number < low => true,
            CompareOp::LessEqual if number >= high => true,
            CompareOp::LessEqual if number < low => false,
            CompareOp::Equal if number < low || number > high => false,
            CompareOp::NotEqual if number < low || number > high => true,
            _ => return,
        };
        let is_sign = low == 0 && number == 0;
        // A named constant may have another value in the next version.
        if !is_sign && !is_written_number(&self.program.globals.text(written)) {
            return;
        }
        let word = if always { "TRUE" } else { "FALSE" };
        let label = match is_sign {
            true => format!("a value of type {} is never negative", own.name()),
            false if own.class() == Class::Bits => format!("{} goes from 0 to 16#{high:X}", own.name()),
            false => rewrite::holds(own),
        };
        self.program.report(
            Diagnostic::new(Code::AlwaysSame, op_span, format!("this comparison is always {word}"))
                .label(label)
                .help("compare with another value, or remove the condition"),
        );
    }

    fn compare_by_call(
        &mut self,
        ctx: &mut SclBlock,
        number: u16,
        left: Value,
        right: Value,
        ty: &DataType,
        span: Span,
    ) -> Option<Expr> {
        let left = self.complex_value(ctx, left, ty);
        let right = self.complex_value(ctx, right, ty);
        match self.library_value(number, vec![Actual::Complex(left?), Actual::Complex(right?)], span)? {
            Value::Elementary(expr) => Some(expr),
            _ => None,
        }
    }

    /// `=` and `<>` member by member.
    fn compare_structures(
        &mut self,
        ctx: &mut SclBlock,
        op: CompareOp,
        op_span: Span,
        left: Value,
        right: Value,
        span: Span,
    ) -> Option<Expr> {
        let equality = matches!(op, CompareOp::Equal | CompareOp::NotEqual);
        if equality && let Some(compared) = self.compared_references(ctx, op, &left, &right, span) {
            return compared;
        }
        let variables = match (&left, &right) {
            (
                Value::Complex { value: Complex::Variable(a), ty: x, .. },
                Value::Complex { value: Complex::Variable(b), ty: y, .. },
            ) if equality && ctx.scope.rules != Rules::Classic && assignable(ctx.scope.rules, x, y) => {
                Some((a.clone(), b.clone()))
            }
            _ => None,
        };
        let Some((a, b)) = variables else {
            let help = "compare the components that matter, one by one";
            self.operator_types(op_span, &left, &right, help);
            return None;
        };
        let mut pairs = Vec::new();
        if access_has_call(&a) || access_has_call(&b) || !elements(&a, &b, &mut pairs) {
            self.refuse(
                Code::TypeMismatch,
                op_span,
                "these structures cannot be compared as a whole",
                &format!("only up to {ELEMENTS_MAX} single values and texts"),
                "compare the components in a loop, or those that matter one by one",
            );
            return None;
        }
        let (operator, join) = match op {
            CompareOp::Equal => (Operator::Equal, BinaryOp::And),
            _ => (Operator::NotEqual, BinaryOp::Or),
        };
        let mut results = Vec::with_capacity(pairs.len());
        for (a, b) in pairs {
            let (a, b) = (value_of(&a, span)?, value_of(&b, span)?);
            results.push(self.compare(ctx, operator, op_span, a, b, span)?);
        }
        balanced(join, results, span)
    }
}

/// The value of a constant that is a whole number.
fn whole_number(value: &Value) -> Option<i128> {
    match value {
        Value::Constant(Constant::Integer { value, .. }, _) => Some(*value),
        other => typed_constant(other).filter(|(ty, _)| ty.is_integer()).map(|(ty, bits)| constant::integer(ty, bits)),
    }
}

/// Whether a constant is written as a number, as `32767`, `-1` or `INT#5`, and not by a name.
fn is_written_number(text: &str) -> bool {
    match text.split_once('#') {
        Some((before, _)) => before.starts_with(|first: char| first.is_ascii_alphanumeric()),
        None => text.starts_with(|first: char| first.is_ascii_digit() || first == '-'),
    }
}

/// True of a type whose values next to one of type `other` are compared as numbers.
fn compared_as_number(ty: Elementary, other: Elementary) -> bool {
    match ty.class() {
        Class::Duration => ty != Elementary::S5Time && other.is_integer(),
        Class::Date | Class::Character => other.is_integer(),
        Class::Bits | Class::Signed | Class::Unsigned | Class::Float => false,
    }
}

/// The integer that a duration, date or character is next to a value of type `other`; dates and times of day fit signed ones too.
fn integer_of(ty: Elementary, other: Elementary) -> Option<Elementary> {
    let is_signed = other.class() == Class::Signed;
    Some(match (ty.class(), ty.bits()) {
        (Class::Character, 8) => Elementary::Usint,
        (Class::Date | Class::Character, 16) => Elementary::Uint,
        (Class::Duration, 32) => Elementary::Dint,
        (Class::Date, 32) if is_signed => Elementary::Dint,
        (Class::Date, 32) => Elementary::Udint,
        (Class::Duration, 64) => Elementary::Lint,
        (Class::Date, 64) if is_signed => Elementary::Lint,
        (Class::Date, 64) => Elementary::Ulint,
        _ => return None,
    })
}

/// Whether `ty` has a value for each one of type `other`, which is as wide: a duration for each date and bit string, bits for each date
/// and character.
fn holds_all(ty: Elementary, other: Elementary) -> bool {
    match ty.class() {
        Class::Duration => matches!(other.class(), Class::Date | Class::Bits),
        Class::Bits => matches!(other.class(), Class::Date | Class::Character),
        Class::Signed | Class::Unsigned | Class::Float | Class::Date | Class::Character => false,
    }
}

/// All of `results`, joined in a tree of low depth.
fn balanced(join: BinaryOp, mut results: Vec<Expr>, span: Span) -> Option<Expr> {
    if results.len() > 1 {
        let right = results.split_off(results.len() / 2);
        let (left, right) = (balanced(join, results, span)?, balanced(join, right, span)?);
        return Some(binary_expr(join, left, right, Elementary::Bool, span));
    }
    results.pop()
}

/// The single values and texts of two variables of one type; false: too many, or some that cannot be compared.
fn elements(a: &Access, b: &Access, pairs: &mut Vec<(Access, Access)>) -> bool {
    use super::place::shifted;
    match (&a.ty, &b.ty) {
        (DataType::Elementary(_), DataType::Elementary(_))
        | (DataType::String(_), DataType::String(_))
        | (DataType::WideString(_), DataType::WideString(_))
        | (DataType::DateAndTime, DataType::DateAndTime) => {
            pairs.push((a.clone(), b.clone()));
            pairs.len() as u64 <= ELEMENTS_MAX
        }
        (DataType::Struct(x), DataType::Struct(y)) => x.members.iter().zip(&y.members).all(|(m, n)| {
            match (shifted(a, m.byte, m.bit, &m.ty), shifted(b, n.byte, n.bit, &n.ty)) {
                (Some(a), Some(b)) => elements(&a, &b, pairs),
                _ => false,
            }
        }),
        (DataType::Array(x), DataType::Array(y)) => {
            let count = layout::element_count(&x.bounds);
            count <= ELEMENTS_MAX
                && (0..count).all(|number| {
                    let (m, n) = (layout::element_place(x, number), layout::element_place(y, number));
                    match (shifted(a, m.0, m.1, &x.element), shifted(b, n.0, n.1, &y.element)) {
                        (Some(a), Some(b)) => elements(&a, &b, pairs),
                        _ => false,
                    }
                })
        }
        _ => false,
    }
}

/// A comparison of two values of one type.
pub fn comparison(op: CompareOp, left: Expr, right: Expr, span: Span) -> Expr {
    Expr { kind: ExprKind::Compare { op, left: Box::new(left), right: Box::new(right) }, ty: Elementary::Bool, span }
}

/// The type of a number; that of a constant without a type is the smallest usual one.
pub(super) fn number_type(value: &Value) -> Option<Elementary> {
    match Shape::of(value) {
        Shape::Of(ty) if ty.is_integer() || ty.is_float() => Some(ty),
        Shape::Integer(value) if i16::try_from(value).is_ok() => Some(Elementary::Int),
        Shape::Integer(_) => Some(Elementary::Dint),
        Shape::Real => Some(Elementary::Real),
        Shape::Of(_) | Shape::Letter | Shape::Other => None,
    }
}

/// The number that a text constant, which is written as `text`, consists of.
fn number_in_quotes<'t>(value: &Value, text: &'t str) -> Option<&'t str> {
    let is_text = matches!(value, Value::Constant(Constant::Text { .. }, _));
    let inner = text.trim_matches('\'').trim();
    (is_text && inner.starts_with(|c: char| c.is_ascii_digit() || c == '-') && inner.parse::<f64>().is_ok())
        .then_some(inner)
}

fn complex_type(value: &Value) -> Option<DataType> {
    match value {
        Value::Complex { ty, .. } => Some(ty.clone()),
        Value::Constant(Constant::Text { .. }, _) => Some(DataType::String(254)),
        Value::Constant(Constant::DateAndTime(_), _) => Some(DataType::DateAndTime),
        _ => None,
    }
}

/// A value that is compared as a STRING.
fn is_text(value: &Value) -> bool {
    match value {
        Value::Complex { ty: DataType::String(_), .. } | Value::Constant(Constant::Text { .. }, _) => true,
        other => Shape::of(other) == Shape::Of(Elementary::Char),
    }
}

/// A value that is compared with a WSTRING: a WSTRING, or one that converts to it.
pub(super) fn is_any_text(value: &Value) -> bool {
    match value {
        Value::Constant(Constant::Text { .. }, _) => true,
        Value::Elementary(expr) => expr.ty == Elementary::Wchar,
        other => text::is_wide_text(other),
    }
}

fn compare_op(op: Operator) -> Option<CompareOp> {
    Some(match op {
        Operator::Less => CompareOp::Less,
        Operator::Greater => CompareOp::Greater,
        Operator::LessEqual => CompareOp::LessEqual,
        Operator::GreaterEqual => CompareOp::GreaterEqual,
        Operator::Equal => CompareOp::Equal,
        Operator::NotEqual => CompareOp::NotEqual,
        _ => return None,
    })
}
