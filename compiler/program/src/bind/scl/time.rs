//! Arithmetic of dates and times. Source: SCL reference, date and time arithmetic.

use plcc_diag::{Code, Span};
use plcc_syntax::scl::ast::{AssignOp, BinaryOp as Operator, Expr as Node, ExprKind as NodeKind};
use plcc_syntax::{Class, Elementary};

use super::complex::is_dtl;
use super::convert;
use super::expression::{as_bits, binary_expr, binary_op, constant_expr};
use super::function::Named;
use super::numeric::Shape;
use super::value::Value;
use super::{Intent, Rules};
use crate::bind::scl::{SclBinder, SclBlock};
use Elementary::*;
use plcc_binding::constant::Constant;
use plcc_binding::fold;
use plcc_model::scl::{Actual, Argument, BinaryOp, Call, Complex, Conversion, Expr, ExprKind};
use plcc_model::types::DataType;

/// Library functions of DATE_AND_TIME. Source: STL reference, IEC functions.
const D_TOD_DT: u16 = 3;
const AD_DT_TM: u16 = 1;
const SB_DT_DT: u16 = 34;
const SB_DT_TM: u16 = 35;

const DAY_MILLISECONDS: u64 = 86_400_000;

/// The role of an operand in this arithmetic.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Moment {
    Of(Elementary),
    DateAndTime,
    Dtl,
    Number,
    None,
}

fn moment(value: &Value) -> Moment {
    match value {
        Value::Complex { ty: DataType::DateAndTime, .. } | Value::Constant(Constant::DateAndTime(_), _) => {
            Moment::DateAndTime
        }
        Value::Complex { ty: DataType::Struct(structure), .. } if is_dtl(structure) => Moment::Dtl,
        Value::Constant(Constant::Dtl(_), _) => Moment::Dtl,
        other => match Shape::of(other) {
            Shape::Integer(_) => Moment::Number,
            Shape::Of(ty) if matches!(ty.class(), Class::Duration | Class::Date) => Moment::Of(ty),
            Shape::Of(ty) if ty.is_integer() => Moment::Number,
            _ => Moment::None,
        },
    }
}

/// The number of a DATE, as a DINT.
fn days_of(date: Expr) -> Expr {
    let days = convert::converted(date, Conversion::Bits { checked: false }, Uint);
    convert::converted(days, Conversion::Bits { checked: false }, Dint)
}

/// True of a DTL.
pub fn is_dtl_value(value: &Value) -> bool {
    moment(value) == Moment::Dtl
}

/// True if two values compare as dates of two types.
pub fn compare_as_dates(left: &Value, right: &Value) -> bool {
    let (a, b) = (moment(left), moment(right));
    let date = |moment| matches!(moment, Moment::Dtl | Moment::DateAndTime | Moment::Of(Ldt));
    a != b && date(a) && date(b)
}

impl SclBinder<'_, '_> {
    /// `left op right` if one of them is a date or time; otherwise returns both.
    #[allow(clippy::result_large_err, reason = "the caller gets the operands back")]
    pub(super) fn time_arithmetic(
        &mut self,
        ctx: &mut SclBlock,
        op: Operator,
        op_span: Span,
        left: Value,
        right: Value,
        span: Span,
    ) -> Result<Option<Value>, (Value, Value)> {
        use Moment::{DateAndTime, Dtl, Number, Of};
        let sum = matches!(op, Operator::Add | Operator::Subtract);
        let (a, b) = (moment(&left), moment(&right));
        let subtract = op == Operator::Subtract;
        let value = match (a, b) {
            (Of(S5Time), _) | (_, Of(S5Time)) => {
                self.operator_types(op_span, &left, &right, "convert S5TIME first: S5TIME_TO_TIME(…)");
                None
            }
            (Of(ty @ (Time | Ltime)), Of(other @ (Time | Ltime))) if sum => {
                let ty = if other == Ltime { Ltime } else { ty };
                self.combined(ctx, binary_op(op), left, right, ty, span)
            }
            (Of(ty @ (Time | Ltime)), Number) if op != Operator::Modulo => {
                let left = self.convert(ctx, left, ty);
                let right = self.factor(ctx, right, ty);
                let both = left.zip(right);
                let scaled = both.and_then(|(left, right)| self.scaled(ctx, binary_op(op), left, right, span));
                scaled.map(Value::Elementary)
            }
            (Number, Of(ty @ (Time | Ltime))) if matches!(op, Operator::Add | Operator::Multiply) => {
                let number = self.factor(ctx, left, ty);
                let duration = self.convert(ctx, right, ty);
                let both = number.zip(duration);
                let converted = both.and_then(|(number, duration)| Some((self.counted(ctx, number, ty)?, duration)));
                converted.map(|(left, right)| Value::Elementary(binary_expr(binary_op(op), left, right, ty, span)))
            }
            (Of(day @ (TimeOfDay | Ltod)), Of(Time | Ltime)) if sum => {
                let step = if day == Ltod { Ltime } else { Time };
                let left = self.convert(ctx, left, day);
                let right = self.convert(ctx, right, step);
                let op = if subtract { BinaryOp::SubtractDay } else { BinaryOp::AddDay };
                let both = left.zip(right);
                both.map(|(left, right)| Value::Elementary(binary_expr(op, left, as_bits(right, day), day, span)))
            }
            (Of(Ldt), Of(Time | Ltime)) if sum => {
                let left = self.convert(ctx, left, Ldt);
                let right = self.convert(ctx, right, Ltime);
                let both = left.zip(right);
                both.map(|(left, right)| {
                    let sum = binary_expr(binary_op(op), as_bits(left, Lint), as_bits(right, Lint), Lint, span);
                    Value::Elementary(convert::converted(sum, convert::TO_LDT, Ldt))
                })
            }
            (Of(day), Of(other)) if subtract && day == other => self.difference(ctx, day, left, right, span),
            (Of(Date), Of(TimeOfDay)) if op == Operator::Add && ctx.scope.rules.is_300() => {
                let left = self.convert(ctx, left, Date);
                let right = self.convert(ctx, right, TimeOfDay);
                let both = left.zip(right);
                both.and_then(|(a, b)| self.library_value(D_TOD_DT, vec![Actual::Value(a), Actual::Value(b)], span))
            }
            (DateAndTime, Of(Time)) if sum => {
                let number = if subtract { SB_DT_TM } else { AD_DT_TM };
                let left = self.complex_value(ctx, left, &DataType::DateAndTime);
                let right = self.convert(ctx, right, Time);
                let both = left.zip(right);
                both.and_then(|(a, b)| self.library_value(number, vec![Actual::Complex(a), Actual::Value(b)], span))
            }
            (DateAndTime, DateAndTime) if subtract => {
                let left = self.complex_value(ctx, left, &DataType::DateAndTime);
                let right = self.complex_value(ctx, right, &DataType::DateAndTime);
                let both = left.zip(right);
                both.and_then(|(a, b)| self.library_value(SB_DT_DT, vec![Actual::Complex(a), Actual::Complex(b)], span))
            }
            (Dtl, Of(step @ (Time | Ltime))) if sum => self.dtl_step(ctx, left, right, step, subtract, span),
            (Dtl, Dtl) if subtract => {
                let ty = if ctx.scope.rules == Rules::Tia1500 { Ltime } else { Time };
                self.dtl_difference(ctx, left, right, ty, span)
            }
            (Of(Date), Of(TimeOfDay)) if op == Operator::Add => {
                self.instruction_value(ctx, "T_COMBINE", vec![left, right], span)
            }
            (Dtl, _) | (_, Dtl) => {
                let help = "add or subtract a TIME to or from a DTL, or subtract one DTL from another";
                self.refuse(Code::TypeMismatch, op_span, "this operation is not possible with a DTL", "DTL", help);
                None
            }
            (Of(_) | DateAndTime, _) | (_, Of(_) | DateAndTime) => {
                let help = self.scaled_time(op, &left, &right).unwrap_or_else(|| {
                    "TIME can be combined with TIME and integers, dates with TIME; two dates of one type can be subtracted"
                        .to_string()
                });
                self.operator_types(op_span, &left, &right, &help);
                None
            }
            _ => return Err((left, right)),
        };
        Ok(value)
    }

    /// What to write for a TIME that is multiplied or divided by a REAL.
    fn scaled_time(&self, op: Operator, left: &Value, right: &Value) -> Option<String> {
        let sign = match op {
            Operator::Multiply => '*',
            Operator::Divide => '/',
            _ => return None,
        };
        let is_time = matches!(left, Value::Elementary(expr) if expr.ty == Time);
        let (time, factor) = (self.program.globals.text(left.span()), self.program.globals.text(right.span()));
        let is_real = match right {
            Value::Constant(Constant::Real(number), _) if number.fract() == 0.0 && is_time => {
                return Some(format!("write `{time} {sign} {number:.0}`"));
            }
            Value::Constant(Constant::Real(_), _) => true,
            Value::Elementary(expr) => expr.ty == Real && !factor.contains(char::is_whitespace),
            _ => false,
        };
        (is_time && is_real).then(|| {
            format!(
                "calculate with milliseconds: `DINT_TO_TIME(REAL_TO_DINT(DINT_TO_REAL(TIME_TO_DINT({time})) {sign} {factor}))`"
            )
        })
    }

    /// True of a DTL or DATE_AND_TIME.
    pub(super) fn is_long_date(value: &Value) -> bool {
        matches!(moment(value), Moment::Dtl | Moment::DateAndTime)
    }

    /// The difference of dates of different types, one of them not a single value: an LTIME; `Err`: other operands.
    #[allow(clippy::result_large_err, reason = "the caller gets the operands back")]
    pub(super) fn mixed_difference(
        &mut self,
        ctx: &mut SclBlock,
        left: Value,
        right: Value,
        span: Span,
    ) -> Result<Option<Value>, (Value, Value)> {
        let (a, b) = (moment(&left), moment(&right));
        let date = |moment| matches!(moment, Moment::Dtl | Moment::DateAndTime | Moment::Of(Ldt));
        if a == b || !date(a) || !date(b) {
            return Err((left, right));
        }
        let (left, right) = (self.as_ldt(ctx, left), self.as_ldt(ctx, right));
        let Some((left, right)) = left.zip(right) else { return Ok(None) };
        Ok(self.difference(ctx, Ldt, Value::Elementary(left), Value::Elementary(right), span))
    }

    /// T_CONV and T_DIFF whose result is assigned: their type is that of the target. `None`: any other expression; `Some(None)`: after a message.
    pub(in crate::bind) fn value_for_target(
        &mut self,
        ctx: &mut SclBlock,
        targets: &[(Node, AssignOp)],
        node: &Node,
    ) -> Option<Option<Value>> {
        let ([(target, AssignOp::Set)], NodeKind::Call { callee, arguments }) = (targets, &node.kind) else {
            return None;
        };
        let NodeKind::Name(name) = &callee.kind else { return None };
        let Named::Row { row, suffix: None } = Named::find(&name.text)? else { return None };
        let own = matches!(row.name, "T_CONV" | "T_DIFF") && !ctx.scope.rules.is_300();
        if !own || self.is_instance(ctx, name) || self.program.globals.names.symbols.contains_key(&fold(&name.text)) {
            return None;
        }
        let access = self.quietly(ctx, |binder, ctx| binder.access(ctx, target, Intent::Write));
        let to = access.filter(|access| access.part.is_none())?.ty;
        let span = node.span;
        let Some(pins) = self.pins(ctx, row, arguments, name.span) else { return Some(None) };
        if row.name == "T_CONV" {
            let value = self.value(ctx, pins.get("IN")?);
            return Some(value.and_then(|value| self.converted_time(ctx, value, &to, span)));
        }
        let (left, right) = (self.value(ctx, pins.get("IN1")?), self.value(ctx, pins.get("IN2")?));
        let Some((left, right)) = left.zip(right) else { return Some(None) };
        Some(match (moment(&left), moment(&right), &to) {
            // The days between two dates.
            (Moment::Of(Date), Moment::Of(Date), DataType::Elementary(ty)) if ty.is_integer() => {
                let left = self.convert(ctx, left, Date);
                let right = self.convert(ctx, right, Date);
                left.zip(right).and_then(|(left, right)| {
                    let days = binary_expr(BinaryOp::Subtract, days_of(left), days_of(right), Dint, span);
                    convert::explicit_expr(ctx.scope.rules, days, *ty).map(Value::Elementary)
                })
            }
            (Moment::Of(Date), Moment::Of(Date), DataType::Elementary(Time)) => {
                self.date_difference(ctx, left, right, Time, span)
            }
            (Moment::Dtl, Moment::Dtl, DataType::Elementary(Ltime))
            | (Moment::DateAndTime, Moment::DateAndTime, DataType::Elementary(Ltime)) => {
                self.date_difference(ctx, left, right, Ltime, span)
            }
            _ => self.operation(ctx, Operator::Subtract, name.span, left, right, span),
        })
    }

    /// T_CONV of a value that goes to a variable of type `to`.
    fn converted_time(&mut self, ctx: &mut SclBlock, value: Value, to: &DataType, span: Span) -> Option<Value> {
        if let DataType::Elementary(ty) = to {
            let own = match value {
                // The conversion says that a number is meant, so its unit is not asked for.
                Value::Constant(Constant::Integer { .. }, _) if matches!(ty, Time | Ltime) => {
                    return self.convert(ctx, value, *ty).map(Value::Elementary);
                }
                // The conversion is written, so the IEC check has nothing against it.
                Value::Constant(Constant::Typed { ty, bits }, span) if ctx.scope.strict => {
                    Expr { kind: ExprKind::Const(bits), ty, span }
                }
                Value::Constant(..) => return Some(value),
                Value::Elementary(expr) => expr,
                other => return self.converted_date(ctx, other, to, span),
            };
            if let Some(converted) = convert::explicit_expr(ctx.scope.rules, own.clone(), *ty) {
                return Some(Value::Elementary(Expr { span, ..converted }));
            }
            return self.converted_date(ctx, Value::Elementary(own), to, span);
        }
        self.converted_date(ctx, value, to, span)
    }

    fn converted_date(&mut self, ctx: &mut SclBlock, value: Value, to: &DataType, span: Span) -> Option<Value> {
        let words = super::text::type_word(&value).zip(super::text::type_word_of(to));
        match words {
            Some((from, to)) if from != to => match self.converted_text(ctx, &from, &to, value, span, span) {
                Ok(value) => value,
                // Mistakes are reported where it is assigned.
                Err(value) => Some(value),
            },
            _ => Some(value),
        }
    }

    /// True of dates whose T_DIFF is a TIME: two DTL, on an S7-1200 or S7-1500 two DATE_AND_TIME, on an S7-1200 two DATE.
    pub(super) fn has_short_difference(rules: Rules, left: &Value, right: &Value) -> bool {
        let kind = moment(left);
        let short = match kind {
            Moment::Dtl => true,
            Moment::DateAndTime => !rules.is_300(),
            Moment::Of(Date) => rules == Rules::Tia1200,
            _ => false,
        };
        short && kind == moment(right)
    }

    /// T_DIFF of two DTL, DATE_AND_TIME or DATE: a TIME or LTIME; 0 if it does not fit.
    pub(super) fn date_difference(
        &mut self,
        ctx: &mut SclBlock,
        left: Value,
        right: Value,
        ty: Elementary,
        span: Span,
    ) -> Option<Value> {
        let (left, right) = (self.as_dtl(ctx, left)?, self.as_dtl(ctx, right)?);
        self.dtl_difference(ctx, left, right, ty, span)
    }

    /// A DATE or DATE_AND_TIME as DTL; anything else as it is.
    fn as_dtl(&mut self, ctx: &mut SclBlock, value: Value) -> Option<Value> {
        let span = value.span();
        match moment(&value) {
            Moment::DateAndTime => self.instruction_value(ctx, "DT_TO_DTL", vec![value], span),
            Moment::Of(Date) => self.instruction_value(ctx, "DATE_TO_DTL", vec![value], span),
            _ => Some(value),
        }
    }

    /// DTL and TIME or LTIME: a DTL.
    fn dtl_step(
        &mut self,
        ctx: &mut SclBlock,
        left: Value,
        right: Value,
        step: Elementary,
        back: bool,
        span: Span,
    ) -> Option<Value> {
        let name = if step == Time { "ADD_DTL_TIME" } else { "ADD_DTL_LTIME" };
        let back = Value::Constant(Constant::Typed { ty: Bool, bits: back.into() }, span);
        self.instruction_value(ctx, name, vec![left, right, back], span)
    }

    /// The time between two DTL: a TIME, or an LTIME, which can hold every one.
    fn dtl_difference(
        &mut self,
        ctx: &mut SclBlock,
        left: Value,
        right: Value,
        ty: Elementary,
        span: Span,
    ) -> Option<Value> {
        let name = if ty == Time { "SUB_DTL_DTL" } else { "SUB_DTL_DTL_LTIME" };
        self.instruction_value(ctx, name, vec![left, right], span)
    }

    /// A DTL, DATE_AND_TIME or LDT as LDT, in which TIA computes and compares them all; `None` for anything else.
    pub(super) fn as_ldt(&mut self, ctx: &mut SclBlock, value: Value) -> Option<Expr> {
        let span = value.span();
        match moment(&value) {
            Moment::Of(Ldt) => self.convert(ctx, value, Ldt),
            Moment::DateAndTime => {
                let dtl = self.as_dtl(ctx, value)?;
                self.as_ldt(ctx, dtl)
            }
            Moment::Dtl => match self.instruction_value(ctx, "DTL_TO_LDT", vec![value], span)? {
                Value::Elementary(value) => Some(value),
                _ => None,
            },
            _ => None,
        }
    }

    /// The value of an instruction of the TIA Portal with the given inputs.
    pub(super) fn instruction_value(
        &mut self,
        ctx: &mut SclBlock,
        name: &str,
        inputs: Vec<Value>,
        span: Span,
    ) -> Option<Value> {
        let long = super::text::for_long_texts(name).filter(|_| inputs.iter().any(super::text::is_long_text));
        let key = self.program.globals.library.key_of(long.or_else(|| plcc_stdlib::find_tia(name))?);
        self.library_call(ctx, key, inputs, span, span)
    }

    /// An integer next to a TIME or LTIME.
    fn factor(&mut self, ctx: &mut SclBlock, value: Value, ty: Elementary) -> Option<Expr> {
        let own = if ty == Ltime { Lint } else { Dint };
        match value {
            Value::Elementary(expr) => Some(expr),
            Value::Constant(Constant::Typed { ty, bits }, span) => Some(constant_expr(bits, ty, span)),
            other => self.convert(ctx, other, own),
        }
    }

    /// An integer as that many milliseconds (LTIME: nanoseconds).
    fn counted(&mut self, ctx: &SclBlock, number: Expr, ty: Elementary) -> Option<Expr> {
        let (from, span) = (number.ty, number.span);
        let converted = convert::explicit_expr(ctx.scope.rules, number, ty);
        if converted.is_none() {
            self.no_conversion(&ctx.scope, span, from, ty);
        }
        converted
    }

    /// `duration op number`. With a number that the duration's type may not hold this is computed in 64 bits: `T#10s / 4_294_967_295` is 0.
    fn scaled(&mut self, ctx: &SclBlock, op: BinaryOp, duration: Expr, number: Expr, span: Span) -> Option<Expr> {
        let (ty, rules) = (duration.ty, ctx.scope.rules);
        let number = match (ty, number.ty) {
            (Time, Udint | Lint) => number,
            // No duration is longer than the largest LINT.
            (_, Ulint) if op == BinaryOp::Divide => convert::up_to_lint(number),
            _ => {
                let number = self.counted(ctx, number, ty)?;
                return Some(binary_expr(op, duration, number, ty, span));
            }
        };
        let number = convert::explicit_expr(rules, number, Lint)?;
        let duration = convert::explicit_expr(rules, duration, Lint)?;
        convert::explicit_expr(rules, binary_expr(op, duration, number, Lint, span), ty)
    }

    /// The time between two dates of one type.
    fn difference(
        &mut self,
        ctx: &mut SclBlock,
        ty: Elementary,
        left: Value,
        right: Value,
        span: Span,
    ) -> Option<Value> {
        let left = self.convert(ctx, left, ty);
        let right = self.convert(ctx, right, ty);
        let (left, right) = (left?, right?);
        let simple = |through: Elementary, left: Expr, right: Expr| {
            binary_expr(BinaryOp::Subtract, as_bits(left, through), as_bits(right, through), through, span)
        };
        let value = match ty {
            TimeOfDay => simple(Time, left, right),
            Ltod | Ldt => simple(Ltime, left, right),
            _ => {
                let days = simple(Dint, left, right);
                let milliseconds = constant_expr(DAY_MILLISECONDS, Time, span);
                if ctx.scope.rules == Rules::Tia1500 {
                    let days = convert::explicit_expr(ctx.scope.rules, days, Ltime)?;
                    let day = constant_expr(DAY_MILLISECONDS * 1_000_000, Ltime, span);
                    binary_expr(BinaryOp::Multiply, days, day, Ltime, span)
                } else {
                    binary_expr(BinaryOp::Multiply, as_bits(days, Time), milliseconds, Time, span)
                }
            }
        };
        Some(Value::Elementary(value))
    }

    /// The value of a function of the standard library, called with all its parameters in order.
    pub(super) fn library_value(&mut self, number: u16, actuals: Vec<Actual>, span: Span) -> Option<Value> {
        let target = self.program.globals.library.key_of(plcc_stdlib::find(plcc_stdlib::BlockClass::Fc, number)?);
        let bound = self.program.interface(target, span)?;
        let result = bound.interface.parameters.iter().find(|formal| formal.name == "RET_VAL");
        let Some(result) = result.filter(|_| bound.interface.parameters.len() == actuals.len() + 1) else {
            self.refuse(
                Code::UnknownBlock,
                span,
                &format!("this needs {target} of the standard library"),
                &format!("the program has another {target}"),
                "give the block of the program another number",
            );
            return None;
        };
        let result = result.ty.clone();
        let inputs = bound.interface.parameters.iter().enumerate().filter(|(_, formal)| formal.name != "RET_VAL");
        let arguments =
            inputs.zip(actuals).map(|((parameter, _), actual)| Argument { parameter, actual, span }).collect();
        let call =
            Box::new(Call { target, instance: None, arguments, enable: None, eno: None, is_operation: true, span });
        Some(match result {
            DataType::Elementary(ty) => Value::Elementary(Expr { kind: ExprKind::Call(call), ty, span }),
            ty => Value::Complex { value: Complex::Call(call), ty, span },
        })
    }
}
