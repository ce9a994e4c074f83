//! Functions of the language that are computed in place. Source: SCL reference, numbers and bits; LAD and FBD reference, conversions.

use plcc_abi::RuntimeFn;
use plcc_ir::{BinaryOp, FloatCc, IntCc, Type, UnaryOp, Value};
use plcc_model::scl::{CompareOp, Conversion, Function, Overflow};
use plcc_model::types::Elementary;

use super::value_type;
use crate::arithmetic::{bits, float};
use crate::block::BlockLowering;

impl BlockLowering<'_, '_> {
    /// `function` of `values`, the last of which has type `ty`; the result has type `result`.
    pub fn function(&mut self, function: Function, values: &[Value], ty: Elementary, result: Elementary) -> Value {
        match (function, values) {
            (Function::Sqr, &[x]) => {
                let square = self.b.binary(BinaryOp::Fmul, x, x);
                self.checked_float(square)
            }
            (Function::Sqrt, &[x]) => {
                let root = self.b.unary(UnaryOp::Fsqrt, x);
                self.checked_float(root)
            }
            (Function::Frac, &[x]) => {
                let whole = self.b.unary(UnaryOp::Ftrunc, x);
                let rest = self.b.binary(BinaryOp::Fsub, x, whole);
                self.checked_float(rest)
            }
            (Function::Expd, &[x]) => {
                let ty = self.b.ty(x);
                let ten = float::constant(&mut self.b, ty, 10.0);
                let function = if ty == Type::F64 { RuntimeFn::PowLong } else { RuntimeFn::Pow };
                let power = self.b.call_pure(function, &[ten, x]);
                self.checked_float(power)
            }
            (
                Function::Exp
                | Function::Ln
                | Function::Log
                | Function::Sin
                | Function::Cos
                | Function::Tan
                | Function::Asin
                | Function::Acos
                | Function::Atan,
                &[x],
            ) => {
                let value = self.b.call_pure(runtime_function(function, self.b.ty(x) == Type::F64), &[x]);
                self.checked_float(value)
            }
            (Function::Limit, &[low, value, high]) => self.limit(low, value, high, ty),
            (Function::Select, &[chooser, zero, one]) => self.b.select(chooser, one, zero),
            (Function::Mux { has_else }, [chooser, choices @ ..]) => self.mux(*chooser, choices, has_else, result),
            (Function::Swap, &[x]) => self.b.unary(UnaryOp::Bswap, x),
            (Function::NormX, &[low, value, high]) => self.norm(low, value, high, ty, result),
            (Function::ScaleX, &[low, value, high]) => self.scale(low, value, high, result),
            (Function::Encode, &[x]) => self.encode(x),
            (Function::Decode, &[x]) => bits::only_bit(&mut self.b, value_type(result), x),
            (Function::BitSum, &[x]) => self.bit_sum(x),
            (Function::IsValid, &[x]) => float::is_finite(&mut self.b, x),
            _ => unreachable!("the binder gives each function its arguments"),
        }
    }

    /// Between two limits; limits in the wrong order are an error, and the value stays.
    fn limit(&mut self, low: Value, value: Value, high: Value, ty: Elementary) -> Value {
        let wrong = self.compare(CompareOp::Greater, low, high, ty);
        self.fail_if(wrong);
        // The second comparison takes what the first has left, so that a processor does both without a branch.
        let above = self.compare(CompareOp::Greater, value, high, ty);
        let lowered = self.b.select(above, high, value);
        let below = self.compare(CompareOp::Less, lowered, low, ty);
        let limited = self.b.select(below, low, lowered);
        let result = self.b.select(wrong, value, limited);
        if !ty.is_float() {
            return result;
        }
        // If one input is not a number, neither is the result; an infinite input that is limited does no harm.
        let limits = self.b.fcmp(FloatCc::Uno, low, high);
        let input = self.b.fcmp(FloatCc::Uno, value, value);
        let nan = self.b.or(limits, input);
        self.fail_if(nan);
        let pattern = self.b.iconst(self.b.ty(value), float::NAN);
        let invalid = self.b.fcmp(FloatCc::Uno, result, result);
        let result = self.b.select(invalid, pattern, result);
        self.b.select(limits, pattern, result)
    }

    fn mux(&mut self, chooser: Value, choices: &[Value], has_else: bool, result: Elementary) -> Value {
        let (choices, mut value) = match (choices, has_else) {
            ([choices @ .., other], true) => (choices, *other),
            _ => (choices, self.zero(result)),
        };
        let mut chosen = self.b.bool_const(false);
        for (number, &choice) in choices.iter().enumerate() {
            let is_this = self.b.icmp_imm(IntCc::Eq, chooser, number as i64);
            value = self.b.select(is_this, choice, value);
            chosen = self.b.or(chosen, is_this);
        }
        let outside = self.b.not(chosen);
        self.fail_if(outside);
        value
    }

    fn norm(&mut self, low: Value, value: Value, high: Value, ty: Elementary, result: Elementary) -> Value {
        let wrong = self.compare(CompareOp::LessEqual, high, low, ty);
        self.fail_if(wrong);
        // Wide integers only keep their digits in LREAL, and their differences are what counts.
        let inner = if ty.is_integer() && ty.bits() > 16 { Elementary::Lreal } else { result };
        let mut as_float = |x| {
            if ty == inner { x } else { self.convert(Conversion::Value(Overflow::LowBits), x, ty, inner) }
        };
        let (low, value, high) = (as_float(low), as_float(value), as_float(high));
        let (above, range) = (self.b.binary(BinaryOp::Fsub, value, low), self.b.binary(BinaryOp::Fsub, high, low));
        let one = float::constant(&mut self.b, value_type(inner), 1.0);
        let range = self.b.select(wrong, one, range);
        let part = self.b.binary(BinaryOp::Fdiv, above, range);
        let part = self.b.select(wrong, value, part);
        match inner == result {
            true => self.checked_float(part),
            false => self.convert(Conversion::Value(Overflow::LowBits), part, inner, result),
        }
    }

    fn scale(&mut self, low: Value, value: Value, high: Value, result: Elementary) -> Value {
        let wrong = self.compare(CompareOp::LessEqual, high, low, result);
        self.fail_if(wrong);
        let float = if self.b.ty(value) == Type::F64 { Elementary::Lreal } else { Elementary::Real };
        // Limits of wide integers only keep their digits in LREAL.
        let inner = if result == Elementary::Real && float == result { result } else { Elementary::Lreal };
        let of_inner = |lowering: &mut Self, x, ty: Elementary| {
            if ty == inner { x } else { lowering.convert(Conversion::Value(Overflow::LowBits), x, ty, inner) }
        };
        let (from, to) = (of_inner(self, low, result), of_inner(self, high, result));
        let part = of_inner(self, value, float);
        let range = self.b.binary(BinaryOp::Fsub, to, from);
        let above = self.b.binary(BinaryOp::Fmul, part, range);
        let sum = self.b.binary(BinaryOp::Fadd, above, from);
        let scaled = if result == inner {
            self.checked_float(sum)
        } else {
            self.convert(Conversion::Value(Overflow::LowBits), sum, inner, result)
        };
        self.b.select(wrong, low, scaled)
    }

    fn encode(&mut self, x: Value) -> Value {
        let (number, none) = bits::lowest_bit(&mut self.b, x);
        self.fail_if(none);
        self.b.trunc(Type::I16, number)
    }

    /// Adds adjacent bits, then pairs, then nibbles, then bytes.
    fn bit_sum(&mut self, x: Value) -> Value {
        let mut sum = if self.b.ty(x) == Type::I64 { x } else { self.b.zext(Type::I64, x) };
        for (shift, mask) in [(1, 0x5555_5555_5555_5555), (2, 0x3333_3333_3333_3333), (4, 0x0F0F_0F0F_0F0F_0F0F)] {
            let high = self.b.binary_imm(BinaryOp::Lshr, sum, shift);
            let (low, high) = (self.masked(sum, mask), self.masked(high, mask));
            sum = self.b.iadd(low, high);
        }
        let spread = self.b.binary_imm(BinaryOp::Imul, sum, 0x0101_0101_0101_0101);
        let total = self.b.binary_imm(BinaryOp::Lshr, spread, 56);
        self.b.trunc(Type::I16, total)
    }
}

const fn runtime_function(function: Function, long: bool) -> RuntimeFn {
    match (function, long) {
        (Function::Exp, false) => RuntimeFn::Exp,
        (Function::Exp, true) => RuntimeFn::ExpLong,
        (Function::Ln, false) => RuntimeFn::Ln,
        (Function::Ln, true) => RuntimeFn::LnLong,
        (Function::Log, false) => RuntimeFn::Log,
        (Function::Log, true) => RuntimeFn::LogLong,
        (Function::Sin, false) => RuntimeFn::Sin,
        (Function::Sin, true) => RuntimeFn::SinLong,
        (Function::Cos, false) => RuntimeFn::Cos,
        (Function::Cos, true) => RuntimeFn::CosLong,
        (Function::Tan, false) => RuntimeFn::Tan,
        (Function::Tan, true) => RuntimeFn::TanLong,
        (Function::Asin, false) => RuntimeFn::Asin,
        (Function::Asin, true) => RuntimeFn::AsinLong,
        (Function::Acos, false) => RuntimeFn::Acos,
        (Function::Acos, true) => RuntimeFn::AcosLong,
        (_, false) => RuntimeFn::Atan,
        (_, true) => RuntimeFn::AtanLong,
    }
}
