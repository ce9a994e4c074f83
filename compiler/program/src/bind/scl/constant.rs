//! Constants in their context: an untyped constant takes the type of its partner. Source: SCL reference, type of a literal.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::scl::ast::Literal;
use plcc_syntax::{Class, Elementary};

use super::convert::{self, Implicit};
use super::value::Value;
use super::{Rules, message};
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::constant::Constant;
use plcc_binding::rewrite;
use plcc_model::scl::{BinaryOp, Conversion, Expr, ExprKind, Function, UnaryOp};

impl SclBinder<'_, '_> {
    /// A literal as a value; pointers are not values.
    pub(super) fn literal_value(&mut self, literal: &Literal, span: Span) -> Option<Value> {
        let constant = match literal {
            Literal::Integer { value, based } => Constant::Integer { value: i128::from(*value), based: *based },
            Literal::Real(value) => Constant::Real(*value),
            Literal::Typed { ty, bits } => Constant::Typed { ty: *ty, bits: *bits },
            Literal::Text { bytes, typed } => Constant::Text { bytes: bytes.clone(), typed: *typed },
            Literal::WideText(text) => Constant::WideText(text.clone()),
            Literal::DateAndTime(bytes) => Constant::DateAndTime(*bytes),
            Literal::Dtl(bytes) => Constant::Dtl(*bytes),
            Literal::Pointer { .. } | Literal::Any(_) | Literal::Nil => {
                // `P#DB1.DBX0.0`
                let text = self.program.globals.text(span);
                let place = text.get(2..).filter(|place| place.starts_with(|first: char| first.is_ascii_alphabetic()));
                let help = match place {
                    Some(place) if !place.contains(' ') && place.contains('.') => {
                        format!("the bit at this address is `%{place}`")
                    }
                    _ => String::new(),
                };
                self.refuse(
                    Code::OperandKind,
                    span,
                    "a pointer can only be passed to a parameter",
                    "possible for a parameter of type POINTER or ANY",
                    &help,
                );
                return None;
            }
            Literal::Null => {
                self.misplaced_reference(span, "NULL is not a value here");
                return None;
            }
        };
        Some(Value::Constant(constant, span))
    }

    /// A constant as a value of type `ty`.
    pub(super) fn constant_of_type(
        &mut self,
        ctx: &mut SclBlock,
        constant: &Constant,
        span: Span,
        ty: Elementary,
    ) -> Option<Expr> {
        let (rules, strict) = (ctx.scope.rules, ctx.scope.strict);
        let give = |bits: u64| Some(Expr { kind: ExprKind::Const(bits), ty, span });
        match constant {
            Constant::Integer { value, based } => match ty.class() {
                Class::Bits if ty == Elementary::Bool => match value {
                    0 | 1 => give(*value as u64),
                    _ => self.unfit_constant(constant, span, ty),
                },
                Class::Signed | Class::Unsigned | Class::Bits => {
                    if !fits(*value, *based, ty) {
                        self.value_lost(rules, span, *value, ty);
                    }
                    give(low_bits(*value, ty))
                }
                Class::Float => {
                    if let Some(message) = self.program.globals.number_for_bits(constant, ty, span) {
                        self.program.report(message);
                    }
                    match ty {
                        Elementary::Real => give(u64::from((*value as f32).to_bits())),
                        _ => give((*value as f64).to_bits()),
                    }
                }
                Class::Character | Class::Duration | Class::Date => {
                    let own = default_type(rules, constant);
                    let own = if *based && own == Elementary::Int { Elementary::Word } else { own };
                    let own = [own, Elementary::Dint, Elementary::Dword]
                        .into_iter()
                        .find(|own| convert::implicit(rules, strict, *own, ty) == Implicit::Yes);
                    let Some(own) = own.filter(|own| fits(*value, *based, *own)) else {
                        return self.unfit_constant(constant, span, ty);
                    };
                    // No character has another code.
                    if ty.class() == Class::Character && !(0..1i128 << ty.bits()).contains(value) {
                        return self.unfit_constant(constant, span, ty);
                    }
                    // No date and no time of day is before the first or after the last one.
                    if let Some(Conversion::Ranged { max }) = convert::explicit(rules, own, ty)
                        && !(0..=i128::from(max)).contains(value)
                    {
                        return self.unfit_constant(constant, span, ty);
                    }
                    let value = Expr { kind: ExprKind::Const(low_bits(*value, own)), ty: own, span };
                    convert::explicit_expr(rules, value, ty)
                }
            },
            Constant::Real(value) => match ty.class() {
                Class::Float => {
                    if ty == Elementary::Real {
                        self.real_lost(rules, span, *value);
                    }
                    match self.program.globals.nearest(constant, ty, span) {
                        Constant::Typed { bits, .. } => give(bits),
                        _ => give(float_bits(*value, ty)),
                    }
                }
                _ => {
                    let value = Expr {
                        kind: ExprKind::Const(float_bits(*value, Elementary::Real)),
                        ty: Elementary::Real,
                        span,
                    };
                    self.implicit(ctx, value, ty)
                }
            },
            Constant::Typed { ty: own, bits } => {
                let value = Expr { kind: ExprKind::Const(*bits), ty: *own, span };
                if own.is_integer() && ty.is_integer() {
                    let number = integer(*own, *bits);
                    if fits(number, false, ty) && convert::implicit(rules, strict, *own, ty) != Implicit::No {
                        return give(low_bits(number, ty));
                    }
                }
                self.implicit(ctx, value, ty)
            }
            Constant::Text { bytes, typed: false } => match bytes.as_slice() {
                [character] => {
                    let character = u64::from(*character);
                    match ty {
                        Elementary::Char => give(character),
                        Elementary::Wchar => give(u64::from(wide(&[character as u8])[0])),
                        _ => {
                            let value = Expr { kind: ExprKind::Const(character), ty: Elementary::Char, span };
                            self.implicit(ctx, value, ty)
                        }
                    }
                }
                _ => self.unfit_constant(constant, span, ty),
            },
            Constant::WideText(text) => match (text.as_slice(), ty) {
                ([character], Elementary::Wchar) => give(u64::from(*character)),
                _ => self.unfit_constant(constant, span, ty),
            },
            Constant::Text { typed: true, .. } | Constant::DateAndTime(_) | Constant::Dtl(_) => {
                self.unfit_constant(constant, span, ty)
            }
        }
    }

    fn unfit_constant(&mut self, constant: &Constant, span: Span, ty: Elementary) -> Option<Expr> {
        let is = message::described(&Value::Constant(constant.clone(), span));
        let text = matches!(constant, Constant::Text { .. } | Constant::WideText(_)) && ty.class() != Class::Character;
        let written = self.program.globals.text(span);
        let help = Some(match text {
            true => format!(
                "declare the variable as CHAR or STRING, or {}",
                rewrite::help(ty, &written, rewrite::Form::Scl)
            ),
            false => rewrite::help(ty, &written, rewrite::Form::Scl),
        });
        self.wrong_type(span, &is, ty.name(), help);
        None
    }

    /// Warns of a number that is assigned or passed to a duration, or compared with one. Source: SCL reference, implicit conversion.
    pub(super) fn number_for_duration(&mut self, ctx: &SclBlock, value: &Value, ty: Elementary) {
        let Value::Constant(Constant::Integer { value: number, .. }, _) = value else { return };
        let own = match ty {
            Elementary::Time => Elementary::Dint,
            Elementary::Ltime => Elementary::Lint,
            _ => return,
        };
        let converts = convert::implicit(ctx.scope.rules, ctx.scope.strict, own, ty) == Implicit::Yes;
        if converts && fits(*number, false, own) && !ctx.scope.is_network() {
            self.number_without_unit(value, ty);
        }
    }

    /// Warns of a number other than 0 that is taken as a duration.
    pub(super) fn number_without_unit(&mut self, value: &Value, ty: Elementary) {
        let Value::Constant(Constant::Integer { value: number, .. }, span) = value else { return };
        if *number == 0 {
            return;
        }
        let unit = if ty == Elementary::Ltime { "nanoseconds" } else { "milliseconds" };
        let text = self.program.globals.text(*span);
        let mut help = rewrite::help(ty, &text, rewrite::Form::Scl);
        if ty == Elementary::Ltime && text.bytes().all(|byte| byte.is_ascii_digit()) {
            help += &format!(", `LT#{text}NS` for nanoseconds");
        }
        self.program.report(
            Diagnostic::new(Code::Tolerated, *span, format!("`{text}` is a number without a unit"))
                .label(format!("taken as {unit}"))
                .help(help),
        );
    }

    /// A constant that loses bits in the type of its partner. S7-SCL of STEP 7 V5 refuses it, the TIA Portal computes with the low bits.
    ///
    /// Source: SCL reference, type of a literal: an integer literal has the type that can hold it.
    pub(super) fn value_lost(&mut self, rules: Rules, span: Span, value: i128, ty: Elementary) {
        let text = self.program.globals.text(span);
        let bits = low_bits(value, ty);
        let left = match ty.class() {
            Class::Bits => format!("16#{bits:X}"),
            _ => integer(ty, bits).to_string(),
        };
        let (code, label) = match rules {
            Rules::Classic => (Code::LiteralRange, rewrite::holds(ty)),
            Rules::Tia300 | Rules::Tia1200 | Rules::Tia1500 => {
                (Code::Narrowing, format!("{}; the low bits remain, which are {left}", rewrite::holds(ty)))
            }
        };
        let help = match rewrite::roomy(value, ty) {
            Some(larger) if ty.class() == Class::Bits => {
                let digits = ty.bits() / 4;
                format!("give the variable the type {larger}, or write a value of up to {digits} hexadecimal digits")
            }
            Some(larger) => format!("give the variable the type {larger}, or write a value that fits"),
            None => "write a value that fits".to_string(),
        };
        self.program.report(
            Diagnostic::new(code, span, format!("`{text}` does not fit type {}", ty.name())).label(label).help(help),
        );
    }

    /// Reports a number that a REAL cannot hold: it is infinite, or 0.
    fn real_lost(&mut self, rules: Rules, span: Span, value: f64) {
        let single = value as f32;
        if single.is_finite() && (single != 0.0 || value == 0.0) {
            return;
        }
        let text = self.program.globals.text(span);
        let (code, label) = match rules {
            Rules::Classic if single.is_finite() => (Code::LiteralRange, "closer to 0 than any REAL"),
            Rules::Classic => (Code::LiteralRange, "a REAL is a number from -3.402823e+38 to 3.402823e+38"),
            _ if single.is_finite() => (Code::Narrowing, "closer to 0 than any REAL: 0.0 remains"),
            _ => (Code::Narrowing, "it becomes infinite; a REAL is a number from -3.402823e+38 to 3.402823e+38"),
        };
        let help = match rules {
            Rules::Classic | Rules::Tia300 => "write a value that fits",
            Rules::Tia1200 | Rules::Tia1500 => "give the variable the type LREAL, or write a value that fits",
        };
        let title = format!("`{text}` does not fit type REAL");
        self.program.report(Diagnostic::new(code, span, title).label(label).help(help));
    }
}

/// The value of an expression of integers that are all constants, such as `ABS(-5)`; none: it is only known at run time, or wraps.
pub(super) fn computed(expr: &Expr) -> Option<i128> {
    if !expr.ty.is_integer() {
        return None;
    }
    let value = match &expr.kind {
        ExprKind::Const(bits) => integer(expr.ty, *bits),
        ExprKind::Unary { op, operand } => {
            let operand = computed(operand)?;
            match op {
                UnaryOp::Negate => -operand,
                UnaryOp::Abs => operand.abs(),
                UnaryOp::Not => return None,
            }
        }
        ExprKind::Binary { op, left, right } => {
            let (left, right) = (computed(left)?, computed(right)?);
            match op {
                BinaryOp::Add => left + right,
                BinaryOp::Subtract => left - right,
                BinaryOp::Multiply => left.checked_mul(right)?,
                BinaryOp::Divide => left.checked_div(right)?,
                BinaryOp::Modulo => left.checked_rem(right)?,
                BinaryOp::Min => left.min(right),
                BinaryOp::Max => left.max(right),
                BinaryOp::Power
                | BinaryOp::And
                | BinaryOp::Or
                | BinaryOp::Xor
                | BinaryOp::ShiftLeft
                | BinaryOp::ShiftRight
                | BinaryOp::RotateLeft
                | BinaryOp::RotateRight
                | BinaryOp::AddDay
                | BinaryOp::SubtractDay => return None,
            }
        }
        ExprKind::Convert { conversion: Conversion::Value(_), operand } => computed(operand)?,
        ExprKind::Function { function: Function::Limit, arguments } => match arguments.as_slice() {
            [low, value, high] => {
                let (low, value, high) = (computed(low)?, computed(value)?, computed(high)?);
                if low > high { value } else { value.clamp(low, high) }
            }
            _ => return None,
        },
        _ => return None,
    };
    fits(value, false, expr.ty).then_some(value)
}

/// The type of a constant that has no partner.
pub fn default_type(rules: Rules, constant: &Constant) -> Elementary {
    match constant {
        Constant::Integer { value, .. } => match rules {
            Rules::Classic | Rules::Tia300 if i16::try_from(*value).is_ok() => Elementary::Int,
            Rules::Tia1500 => Elementary::Lint,
            _ if i32::try_from(*value).is_ok() => Elementary::Dint,
            _ if u32::try_from(*value).is_ok() => Elementary::Udint,
            _ => Elementary::Lint,
        },
        Constant::Real(_) if rules == Rules::Tia1500 => Elementary::Lreal,
        Constant::Real(_) => Elementary::Real,
        Constant::Typed { ty, .. } => *ty,
        Constant::Text { .. } => Elementary::Char,
        Constant::WideText(_) => Elementary::Wchar,
        Constant::DateAndTime(_) | Constant::Dtl(_) => Elementary::Ldt,
    }
}

/// Least and greatest value of an integer or bit string.
pub fn range(ty: Elementary) -> (i128, i128) {
    let bits = ty.bits();
    match ty.is_signed() {
        true => (-(1i128 << (bits - 1)), (1i128 << (bits - 1)) - 1),
        false => (0, (1i128 << bits) - 1),
    }
}

/// An integer constant keeps its value; one written as bits, or a negative one for a bit string, keeps its bit pattern.
pub fn fits(value: i128, based: bool, ty: Elementary) -> bool {
    let (low, high) = range(ty);
    let pattern = 1i128 << ty.bits();
    (low..=high).contains(&value)
        || (based && (0..pattern).contains(&value))
        || (ty.class() == Class::Bits && (-(pattern / 2)..0).contains(&value))
}

/// The low bits of a number, zero-extended.
pub fn low_bits(value: i128, ty: Elementary) -> u64 {
    match ty.bits() {
        64 => value as u64,
        bits => value as u64 & ((1 << bits) - 1),
    }
}

/// The value of the bits of an integer or bit string.
pub fn integer(ty: Elementary, bits: u64) -> i128 {
    let unused = 64 - ty.bits();
    match ty.is_signed() {
        true => i128::from((bits << unused) as i64 >> unused),
        false => i128::from(bits),
    }
}

/// The bits of a REAL or LREAL.
pub fn float_bits(value: f64, ty: Elementary) -> u64 {
    match ty {
        Elementary::Lreal => value.to_bits(),
        _ => u64::from((value as f32).to_bits()),
    }
}

/// A text in Windows-1252 as UTF-16.
pub fn wide(bytes: &[u8]) -> Vec<u16> {
    let letter = |byte: u8| match byte.is_ascii() {
        true => u16::from(byte),
        // A single byte above ASCII is not valid UTF-8.
        false => plcc_syntax::decode(&[byte]).encode_utf16().next().unwrap_or(u16::from(byte)),
    };
    bytes.iter().map(|&byte| letter(byte)).collect()
}
