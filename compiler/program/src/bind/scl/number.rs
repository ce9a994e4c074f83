//! Functions of numbers and bits. Source: SCL reference, numbers, bits, rounding, conversions.
//!
//! - `operands`: their operands, in the types that they want.
//! - `choice`: MIN, MAX, LIMIT, SEL and MUX.
//! - `conversion`: conversions with the name of a type.

mod choice;
mod conversion;
mod operands;

use plcc_diag::{Code, Diagnostic, Severity, Span};
use plcc_syntax::scl::ast::{BinaryOp as NodeOp, Expr as Node};
use plcc_syntax::{Class, Elementary};

use super::convert::{self, converted};
use super::function::{Kind, Row};
use super::message::described;
use super::numeric::{self, Shape};
use super::pins::Pins;
use super::value::Value;
use super::{Rules, constant};
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::constant::Constant;
use plcc_model::scl::{BinaryOp, Conversion, Expr, ExprKind, Function, UnaryOp};

impl SclBinder<'_, '_> {
    pub fn number_function(
        &mut self,
        ctx: &mut SclBlock,
        row: &Row,
        suffix: Option<Elementary>,
        pins: &Pins,
        span: Span,
    ) -> Option<Value> {
        let expr = match row.kind {
            Kind::Float(function) => self.float_function(ctx, function, suffix, pins.get("IN")?, span),
            Kind::Absolute => {
                let (mut values, ty) = self.alike(ctx, &[pins.get("IN")?], suffix)?;
                let operand = values.pop()?;
                self.number_wanted(&operand)?;
                let kind = ExprKind::Unary { op: UnaryOp::Abs, operand: Box::new(operand) };
                Some(Expr { kind, ty, span })
            }
            Kind::Extreme(op) => return self.extreme(ctx, row, op, suffix, pins, span),
            Kind::Limit => return self.limit(ctx, suffix, pins, span),
            Kind::Select => return self.select(ctx, suffix, pins, span),
            Kind::Mux => return self.mux(ctx, suffix, pins, span),
            Kind::NormX => {
                let nodes = [pins.get("MIN")?, pins.get("VALUE")?, pins.get("MAX")?];
                let (arguments, ty) = self.alike(ctx, &nodes, None)?;
                self.number_wanted(arguments.first()?)?;
                let result = suffix.unwrap_or(if ty == Elementary::Lreal { ty } else { Elementary::Real });
                self.float_suffix(row, result, pins.name)?;
                self.check_scale(&arguments, "1.0 - the result");
                Some(computed(Function::NormX, arguments, result, span))
            }
            Kind::ScaleX => {
                let value = self.float_value(ctx, pins.get("VALUE")?, None);
                let (mut arguments, ty) = self.alike(ctx, &[pins.get("MIN")?, pins.get("MAX")?], suffix)?;
                self.number_wanted(arguments.first()?)?;
                arguments.insert(1, value?);
                self.check_scale(&arguments, "1.0 - the value");
                Some(computed(Function::ScaleX, arguments, ty, span))
            }
            Kind::Round => self.round(ctx, row, suffix, pins, span),
            Kind::Shift(op) => self.shift(ctx, op, suffix, pins, span),
            Kind::Swap => {
                let value = self.bits_value(ctx, pins.get("IN")?, suffix)?;
                let ty = value.ty;
                Some(computed(Function::Swap, vec![value], ty, span))
            }
            Kind::Encode => {
                let value = self.bits_value(ctx, pins.get("IN")?, None)?;
                Some(computed(Function::Encode, vec![value], Elementary::Int, span))
            }
            Kind::BitSum => {
                let value = self.bits_value(ctx, pins.get("IN")?, None)?;
                Some(computed(Function::BitSum, vec![value], Elementary::Int, span))
            }
            Kind::Decode => {
                let ty = suffix.unwrap_or(Elementary::Dword);
                if ty.class() != Class::Bits || ty == Elementary::Bool {
                    return self.bad_suffix(row, ty, pins.name);
                }
                let value = self.count_value(ctx, pins.get("IN")?, "write the number of the bit, from 0")?;
                Some(computed(Function::Decode, vec![value], ty, span))
            }
            Kind::IsValid => {
                let value = self.float_value(ctx, pins.get("IN")?, None)?;
                Some(computed(Function::IsValid, vec![value], Elementary::Bool, span))
            }
            _ => None,
        };
        expr.map(Value::Elementary)
    }

    fn float_function(
        &mut self,
        ctx: &mut SclBlock,
        function: Function,
        suffix: Option<Elementary>,
        node: &Node,
        span: Span,
    ) -> Option<Expr> {
        let value = self.float_value(ctx, node, suffix)?;
        self.check_domain(function, &value);
        let ty = value.ty;
        Some(computed(function, vec![value], ty, span))
    }

    /// Warns of NORM_X and SCALE_X with constants of which MAX is not the greater one: they do not compute then. `reversed`: what counts the
    /// other way. Source: LAD/FBD reference, C.11.
    fn check_scale(&mut self, arguments: &[Expr], reversed: &str) {
        let number = |limit: &Expr| match limit.kind {
            ExprKind::Const(bits) if limit.ty == Elementary::Real => Some(f64::from(f32::from_bits(bits as u32))),
            ExprKind::Const(bits) if limit.ty == Elementary::Lreal => Some(f64::from_bits(bits)),
            ExprKind::Const(bits) if limit.ty.is_integer() => Some(constant::integer(limit.ty, bits) as f64),
            _ => None,
        };
        let [low, _, high] = arguments else { return };
        if let Some((least, greatest)) = number(low).zip(number(high))
            && least >= greatest
        {
            let help = match least > greatest {
                true => format!("exchange them; for the other direction use {reversed}"),
                false => "write two limits that differ".to_owned(),
            };
            let globals = &self.program.globals;
            let (span, low, high) = (low.span, globals.text(low.span), globals.text(high.span));
            self.refuse(
                Code::AlwaysSame,
                span,
                &format!("MIN is `{low}`, which is not below MAX, `{high}`"),
                "nothing is computed, and ENO is FALSE",
                &help,
            );
        }
    }

    fn round(
        &mut self,
        ctx: &mut SclBlock,
        row: &Row,
        suffix: Option<Elementary>,
        pins: &Pins,
        span: Span,
    ) -> Option<Expr> {
        let ty = suffix.unwrap_or(Elementary::Dint);
        let value = self.float_value(ctx, pins.get("IN")?, None)?;
        if !ty.is_integer() && (!ty.is_float() || ctx.scope.rules.is_300()) {
            return self.bad_suffix(row, ty, pins.name);
        }
        self.check_converted(&value, ty);
        let conversion = convert::rounding(ctx.scope.rules, row.name)?;
        Some(Expr { span, ..convert::rounded(value, conversion, ty) })
    }

    /// Shifts and rotates. In the classic form integers are bit strings, so zeros are shifted in.
    fn shift(
        &mut self,
        ctx: &mut SclBlock,
        op: BinaryOp,
        suffix: Option<Elementary>,
        pins: &Pins,
        span: Span,
    ) -> Option<Expr> {
        let value = self.value(ctx, pins.get("IN")?);
        let count = self.count_value(ctx, pins.get("N")?, "for the other direction call the other function");
        let value = value?;
        let ty = match (suffix, Shape::of(&value)) {
            (Some(ty), _) | (None, Shape::Of(ty)) => ty,
            _ => Elementary::Dword,
        };
        let possible = (ty.class() == Class::Bits && ty != Elementary::Bool) || ty.is_integer();
        if !possible {
            let is = described(&value);
            self.wrong_type(value.span(), &is, "a bit string or an integer", None);
            return None;
        }
        // A constant without a type may still take the type of the target.
        if let Some(count) = count.as_ref().filter(|_| suffix.is_some() || !Shape::of(&value).is_untyped()) {
            self.check_shift(op, value.span(), ty, count);
        }
        let left = self.convert(ctx, value, ty)?;
        let bits = numeric::bit_string(Rules::Tia1500, ty).filter(|bits| *bits != ty);
        let make = |left: Expr, count: Expr| {
            let ty = left.ty;
            Expr { kind: ExprKind::Binary { op, left: Box::new(left), right: Box::new(count) }, ty, span }
        };
        // The box shifts the sign in, as SSI and SSD do; the function of SCL does not. Source: LAD/FBD reference, C.14.
        let keeps_sign = ctx.scope.is_network() && op == BinaryOp::ShiftRight;
        Some(match bits {
            Some(bits) if ctx.scope.rules.is_300() && !keeps_sign => {
                let pattern = Conversion::Bits { checked: false };
                converted(make(converted(left, pattern, bits), count?), pattern, ty)
            }
            _ => make(left, count?),
        })
    }

    /// Warns of a shift by a constant of at least the width: no bit keeps its value.
    fn check_shift(&mut self, op: BinaryOp, value: Span, ty: Elementary, count: &Expr) {
        let ExprKind::Const(number) = count.kind else { return };
        let (number, width) = (constant::integer(count.ty, number), ty.bits());
        if number < i128::from(width) || !matches!(op, BinaryOp::ShiftLeft | BinaryOp::ShiftRight) {
            return;
        }
        let text = self.program.globals.text(value);
        let title = format!("a shift by {number} moves all {width} bits of `{text}` out");
        let mut message = Diagnostic::new(Code::ShiftCount, count.span, title)
            .label(format!("{} has {width} bits", ty.name()))
            .help(format!("write a number from 1 to {}", width - 1));
        message.severity = Severity::Warning;
        self.program.report(message);
    }

    fn float_suffix(&mut self, row: &Row, ty: Elementary, name: Span) -> Option<()> {
        if ty.is_float() { Some(()) } else { self.bad_suffix(row, ty, name) }
    }

    fn bad_suffix<T>(&mut self, row: &Row, ty: Elementary, name: Span) -> Option<T> {
        self.program.report(
            Diagnostic::new(Code::TypeMismatch, name, format!("{} has no variant for type {}", row.name, ty.name()))
                .label("this type cannot follow the name")
                .help(format!("write {} alone, and convert its result", row.name)),
        );
        None
    }

    /// An operator as a function.
    pub fn operator_function(&mut self, ctx: &mut SclBlock, op: NodeOp, pins: &Pins, span: Span) -> Option<Value> {
        let (left, right) = (self.value(ctx, pins.get("IN1")?), self.value(ctx, pins.get("IN2")?));
        self.operation(ctx, op, pins.name, left?, right?, span)
    }

    /// T_ADD, T_SUB and T_DIFF of bound operands.
    pub(super) fn operation(
        &mut self,
        ctx: &mut SclBlock,
        op: NodeOp,
        name: Span,
        left: Value,
        right: Value,
        span: Span,
    ) -> Option<Value> {
        let (left, right) = match op {
            NodeOp::Subtract => match self.mixed_difference(ctx, left, right, span) {
                Ok(value) => return value,
                Err(both) => both,
            },
            _ => (left, right),
        };
        // T_DIFF yields a TIME on every CPU.
        if op == NodeOp::Subtract && Self::has_short_difference(ctx.scope.rules, &left, &right) {
            return self.date_difference(ctx, left, right, Elementary::Time, span);
        }
        // A result that does not fit the type is 0. Source: S7-1200 reference, date and time; decision 67.
        let subtract = op == NodeOp::Subtract;
        let of = |value: &Value| match Shape::of(value) {
            Shape::Of(ty) => Some(ty),
            _ => None,
        };
        match (of(&left), of(&right)) {
            (Some(Elementary::Time), Some(Elementary::Time)) => {
                let name = if subtract { "SUB_TIME_TIME" } else { "ADD_TIME_TIME" };
                return self.instruction_value(ctx, name, vec![left, right], span);
            }
            (Some(Elementary::Ltime | Elementary::Time), Some(Elementary::Ltime | Elementary::Time)) => {
                let name = if subtract { "SUB_LTIME_LTIME" } else { "ADD_LTIME_LTIME" };
                return self.instruction_value(ctx, name, vec![left, right], span);
            }
            (Some(Elementary::Ldt), Some(Elementary::Ltime | Elementary::Time)) => {
                let back = Value::Constant(Constant::Typed { ty: Elementary::Bool, bits: subtract.into() }, span);
                return self.instruction_value(ctx, "ADD_LDT_LTIME", vec![left, right, back], span);
            }
            _ => {}
        }
        self.binary_value(ctx, op, name, left, right, span)
    }
}

fn computed(function: Function, arguments: Vec<Expr>, ty: Elementary, span: Span) -> Expr {
    Expr { kind: ExprKind::Function { function, arguments }, ty, span }
}
