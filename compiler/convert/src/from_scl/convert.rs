//! Conversions of values in ACCU1. Source: SCL reference, explicit conversions.

use plcc_diag::Span;
use plcc_model::scl::{Conversion, Expr, ExprKind, Overflow};
use plcc_model::types::Elementary;
use plcc_syntax::stl::StlInsn;

use super::Maker;

/// The conversion takes a jump or a call, or a BOOL.
pub fn jumps(conversion: Conversion, operand: &Expr, to: Elementary) -> bool {
    let jumps = match conversion {
        Conversion::Value(_) | Conversion::Truncate(_) | Conversion::Ceil(_) | Conversion::Floor(_) => {
            operand.ty == Elementary::Real && to == Elementary::Int
        }
        Conversion::Bits { .. } => operand.ty == Elementary::Bool,
        Conversion::ToBool
        | Conversion::FromBcd { .. }
        | Conversion::ToBcd
        | Conversion::FromS5Time
        | Conversion::ToS5Time
        | Conversion::MillisToNanos
        | Conversion::NanosToMillis
        | Conversion::Ranged { .. } => false,
    };
    jumps || is_called(conversion, operand, to)
}

/// An instruction is called for the conversion where the CPU has that.
pub fn is_called(conversion: Conversion, operand: &Expr, to: Elementary) -> bool {
    let is_known = matches!(operand.kind, ExprKind::Const(bits) if constant_time(conversion, bits).is_some());
    !is_known && instruction_of(conversion, operand.ty, to).is_some()
}

/// The instruction that does what no instruction without types does.
fn instruction_of(conversion: Conversion, from: Elementary, to: Elementary) -> Option<&'static str> {
    use Elementary::{Real, Udint};
    let (name, overflow) = match conversion {
        Conversion::Value(overflow) => ("ROUND", overflow),
        Conversion::Truncate(overflow) => ("TRUNC", overflow),
        Conversion::Ceil(overflow) => ("CEIL", overflow),
        Conversion::Floor(overflow) => ("FLOOR", overflow),
        Conversion::FromS5Time | Conversion::ToS5Time => return Some("T_CONV"),
        Conversion::Bits { .. }
        | Conversion::ToBool
        | Conversion::FromBcd { .. }
        | Conversion::ToBcd
        | Conversion::MillisToNanos
        | Conversion::NanosToMillis
        | Conversion::Ranged { .. } => return None,
    };
    match (from, to) {
        (Udint, Real) => Some("CONVERT"),
        (Real, Real) => Some(name),
        (Real, _) => (overflow == Overflow::LowBits).then_some(name),
        _ => None,
    }
}

/// The longest S5TIME in milliseconds.
const S5TIME_MAX: u64 = 9_990_000;

/// What a constant becomes that is converted between TIME and S5TIME. An S5TIME has three digits and one of four bases, from 10 ms on.
fn constant_time(conversion: Conversion, bits: u64) -> Option<u64> {
    let unit = |base: u64| 10 * 10_u64.pow(base as u32);
    let digit = |number: u64, place: u32| number / 10_u64.pow(place) % 10;
    match conversion {
        Conversion::FromS5Time => {
            let number = (bits >> 8 & 0xF) * 100 + (bits >> 4 & 0xF) * 10 + (bits & 0xF);
            Some(number * unit(bits >> 12 & 3))
        }
        Conversion::ToS5Time => {
            let base = (0..4).find(|base| bits <= S5TIME_MAX && bits / unit(*base) <= 999)?;
            let number = bits / unit(base);
            Some(base << 12 | digit(number, 2) << 8 | digit(number, 1) << 4 | digit(number, 0))
        }
        Conversion::Value(_)
        | Conversion::Truncate(_)
        | Conversion::Ceil(_)
        | Conversion::Floor(_)
        | Conversion::Bits { .. }
        | Conversion::ToBool
        | Conversion::FromBcd { .. }
        | Conversion::ToBcd
        | Conversion::MillisToNanos
        | Conversion::NanosToMillis
        | Conversion::Ranged { .. } => None,
    }
}

impl Maker<'_> {
    /// Loads `operand` as a value of the type of `value`.
    pub fn convert(&mut self, conversion: Conversion, operand: &Expr, value: &Expr) {
        if !self.has_type(operand) {
            return;
        }
        if operand.ty == Elementary::Bool {
            return self.convert_bool(operand, value.ty);
        }
        if let ExprKind::Const(bits) = operand.kind
            && let Some(bits) = constant_time(conversion, bits)
        {
            let constant = self.constant(value.ty, bits);
            return self.push(StlInsn::Load, Some(constant));
        }
        if self.conversion_as_instruction(conversion, operand, value) {
            return;
        }
        self.number(operand);
        self.convert_loaded(conversion, operand.ty, value.ty, value.span);
    }

    /// The same by an instruction; false: the conversion needs none, or the CPU does not have it in STL.
    pub fn conversion_as_instruction(&mut self, conversion: Conversion, operand: &Expr, value: &Expr) -> bool {
        let types = [("src", operand.ty), ("dest", value.ty)];
        let name = instruction_of(conversion, operand.ty, value.ty);
        name.is_some_and(|name| self.instruction(name, &types, &[("IN", operand)], value))
    }

    /// Converts the value in ACCU1, which is not a BOOL.
    pub fn convert_loaded(&mut self, conversion: Conversion, from: Elementary, to: Elementary, span: Span) {
        if let Some(name) = instruction_of(conversion, from, to)
            && self.convert_by_instruction(name, from, to)
        {
            return;
        }
        match conversion {
            Conversion::Value(overflow) => self.by_value(StlInsn::Round, overflow, (from, to), span),
            Conversion::Truncate(overflow) => self.by_value(StlInsn::Truncate, overflow, (from, to), span),
            Conversion::Ceil(overflow) => self.by_value(StlInsn::RoundUp, overflow, (from, to), span),
            Conversion::Floor(overflow) => self.by_value(StlInsn::RoundDown, overflow, (from, to), span),
            Conversion::Bits { .. } | Conversion::Ranged { .. } => self.resize(from, to),
            Conversion::FromBcd { fault: true } => {
                self.push(if to.bits() == 32 { StlInsn::BcdToD } else { StlInsn::BcdToI }, None);
            }
            Conversion::ToBcd => {
                let wide = to.bits() == 32;
                if wide && from == Elementary::Int {
                    self.push(StlInsn::IToD, None);
                }
                self.push(if wide { StlInsn::DToBcd } else { StlInsn::IToBcd }, None);
                self.mask(to.bits());
            }
            Conversion::FromBcd { fault: false }
            | Conversion::FromS5Time
            | Conversion::ToS5Time
            | Conversion::MillisToNanos
            | Conversion::NanosToMillis
            | Conversion::ToBool => {
                let what = format!("the conversion of {} to {}", from.name(), to.name());
                self.refuse(span, what, "call the function of the library that does it");
            }
        }
    }

    fn by_value(&mut self, rounding: StlInsn, overflow: Overflow, (from, to): (Elementary, Elementary), span: Span) {
        use Elementary::{Dint, Int, Real, Sint, Udint, Uint, Usint};
        match (from, to) {
            (Int, Real) => {
                self.push(StlInsn::IToD, None);
                self.push(StlInsn::DToR, None);
            }
            (Sint, Real) => {
                self.resize(Sint, Dint);
                self.push(StlInsn::DToR, None);
            }
            (Dint | Usint | Uint | Elementary::Time, Real) => self.push(StlInsn::DToR, None),
            (Udint, Real) => {
                self.refuse(
                    span,
                    "the conversion of UDINT to REAL",
                    "convert it to DINT first, if it is less than 2**31",
                );
            }
            (Real, Real) => self.refuse(span, "the rounding of a REAL to a REAL", "round it to a DINT"),
            (Real, Dint) if overflow == Overflow::Pattern => self.push(rounding, None),
            (Real, Int) if overflow == Overflow::Pattern => self.round_to_int(rounding),
            (Real, _) | (_, Real) => {
                let what = format!("the conversion of {} to {}", from.name(), to.name());
                self.refuse(span, what, "name a CPU with an instruction for it: `--cpu s7-1500`");
            }
            (from, to) => self.resize(from, to),
        }
    }

    /// A REAL as an INT; out of range it is the low word of the REAL.
    fn round_to_int(&mut self, rounding: StlInsn) {
        let real = self.keep(Elementary::Real);
        self.push(rounding, None);
        let number = self.keep(Elementary::Dint);
        let label = self.new_label();
        self.push(StlInsn::IToD, None);
        self.push(StlInsn::Load, Some(number.clone()));
        self.push(StlInsn::CompareEqD, None);
        self.jump(StlInsn::JumpIf, &label);
        self.push(StlInsn::Load, Some(real));
        self.push(StlInsn::Transfer, Some(number.clone()));
        self.label(&label, self.span.start);
        self.push(StlInsn::Load, Some(number));
    }

    /// The bits of a value, extended by its sign or truncated.
    fn resize(&mut self, from: Elementary, to: Elementary) {
        let is_wider = to.bits() > from.bits();
        if from == Elementary::Sint && is_wider {
            self.sign_of_byte();
        }
        if to.bits() == 32 && matches!(from, Elementary::Int | Elementary::Sint) {
            return self.push(StlInsn::IToD, None);
        }
        // The high bits of an INT may be anything.
        let has_rest = from.bits() > to.bits() || from == Elementary::Int;
        if has_rest && to != Elementary::Int {
            self.mask(to.bits());
        }
    }

    fn convert_bool(&mut self, operand: &Expr, to: Elementary) {
        let label = self.new_label();
        self.condition(operand);
        let (no, yes) = (self.constant(to, 0), self.constant(to, 1));
        let stored = self.temporary(to);
        self.push(StlInsn::Load, Some(no));
        self.push(StlInsn::Transfer, Some(stored.clone()));
        self.jump(StlInsn::JumpIfNot, &label);
        self.push(StlInsn::Load, Some(yes));
        self.push(StlInsn::Transfer, Some(stored.clone()));
        self.label(&label, self.span.start);
        self.push(StlInsn::Load, Some(stored));
    }
}
