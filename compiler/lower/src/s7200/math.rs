//! Integer and real mathematics. Source: S7-200 system manual, math instructions.
//!
//! A result that does not fit leaves OUT unchanged: SM1.1 is 1, SM1.0 and SM1.2 are 0. A division by zero sets SM1.3 and changes nothing else.

use plcc_abi::RuntimeFn;
use plcc_ir::{BinaryOp, ConvertOp, FloatCc, IntCc, Type, UnaryOp, Value};
use plcc_model::s7200::{Operand, Width};

use super::context::Context;
use super::operand::Place;
use super::plan::ir_type;

/// Bits of SM1.
pub const ZERO: u8 = 0;
pub const OVERFLOW: u8 = 1;
pub const NEGATIVE: u8 = 2;
pub const DIVIDE_BY_ZERO: u8 = 3;
pub const NOT_BCD: u8 = 6;

/// Exponent bits of a REAL; all of them are set in infinities and NaN.
const EXPONENT: i64 = 0x7F80_0000;

impl Context<'_, '_> {
    /// `+I -I +D -D`.
    pub fn integer_sum(&mut self, operands: &[Operand], width: Width, op: BinaryOp) {
        self.in_place(operands, width, |context, old, input| {
            let result = context.b.binary(op, old, input);
            let from_old = context.b.xor(old, result);
            let other = if op == BinaryOp::Iadd { context.b.xor(input, result) } else { context.b.xor(old, input) };
            let both = context.b.and(from_old, other);
            (result, context.b.icmp_imm(IntCc::Slt, both, 0))
        });
    }

    /// `*I`, `*D`: a product of the width of its operands.
    pub fn integer_product(&mut self, operands: &[Operand], width: Width) {
        self.in_place(operands, width, |context, old, input| {
            let wide = if width == Width::Word { Type::I32 } else { Type::I64 };
            let (a, b) = (context.b.sext(wide, old), context.b.sext(wide, input));
            let product = context.b.binary(BinaryOp::Imul, a, b);
            let result = context.b.trunc(ir_type(width), product);
            let fits = context.b.sext(wide, result);
            (result, context.b.icmp(IntCc::Ne, product, fits))
        });
    }

    /// OUT := OUT op IN for integers; `compute` returns the result and whether it does not fit.
    fn in_place(
        &mut self,
        operands: &[Operand],
        width: Width,
        compute: impl FnOnce(&mut Self, Value, Value) -> (Value, Value),
    ) {
        let [input, output] = operands else { return };
        self.boxed(|context| {
            let input = context.read(input, width);
            let target = context.target(output, width);
            let old = context.load(target, width);
            let (result, overflow) = compute(context, old, input);
            context.finish_integer(target, width, old, result, overflow);
        });
    }

    /// Stores a result that fits, and sets the flags.
    fn finish_integer(&mut self, target: Place, width: Width, old: Value, result: Value, overflow: Value) {
        let stored = self.b.select(overflow, old, result);
        self.store(target, width, stored);
        let (zero, negative) = (self.b.icmp_imm(IntCc::Eq, result, 0), self.b.icmp_imm(IntCc::Slt, result, 0));
        self.set_result_flags(zero, negative, overflow);
    }

    /// SM1.0, SM1.1, SM1.2 and ENO.
    fn set_result_flags(&mut self, zero: Value, negative: Value, overflow: Value) {
        let fits = self.b.not(overflow);
        let (zero, negative) = (self.b.and(zero, fits), self.b.and(negative, fits));
        self.set_flag(ZERO, zero);
        self.set_flag(OVERFLOW, overflow);
        self.set_flag(NEGATIVE, negative);
        self.set(self.eno, fits);
    }

    /// `/I`, `/D`: towards 0.
    pub fn integer_quotient(&mut self, operands: &[Operand], width: Width) {
        let [input, output] = operands else { return };
        self.boxed(|context| {
            let divisor = context.read(input, width);
            let target = context.target(output, width);
            let old = context.load(target, width);
            let zero = context.b.icmp_imm(IntCc::Eq, divisor, 0);
            context.unless_zero(zero, |context| {
                // One step wider, so the smallest number divided by -1 is representable.
                let wide = if width == Width::Word { Type::I32 } else { Type::I64 };
                let (a, b) = (context.b.sext(wide, old), context.b.sext(wide, divisor));
                let quotient = context.b.binary(BinaryOp::Sdiv, a, b);
                let result = context.b.trunc(ir_type(width), quotient);
                let fits = context.b.sext(wide, result);
                let overflow = context.b.icmp(IntCc::Ne, quotient, fits);
                context.finish_integer(target, width, old, result, overflow);
            });
        });
    }

    /// A division: with a divisor of 0 only SM1.3 is set and ENO is 0, otherwise SM1.3 is cleared and `body` runs.
    fn unless_zero(&mut self, zero: Value, body: impl FnOnce(&mut Self)) {
        let (cold, divide, after) = (self.b.create_cold_block(), self.b.create_block(), self.b.create_block());
        self.b.branch(zero, cold, divide);
        self.b.seal_block(cold);
        self.b.seal_block(divide);
        self.b.switch_to(cold);
        let one = self.b.bool_const(true);
        self.set_flag(DIVIDE_BY_ZERO, one);
        let no = self.b.bool_const(false);
        self.set(self.eno, no);
        self.b.jump(after, &[]);
        self.b.switch_to(divide);
        let no = self.b.bool_const(false);
        self.set_flag(DIVIDE_BY_ZERO, no);
        body(self);
        self.b.jump(after, &[]);
        self.b.seal_block(after);
        self.b.switch_to(after);
    }

    /// `MUL`: 32 bits of product; it always fits.
    pub fn long_product(&mut self, operands: &[Operand]) {
        let [input, output] = operands else { return };
        self.boxed(|context| {
            let input = context.read(input, Width::Word);
            let target = context.target(output, Width::Dword);
            let old = context.load(target, Width::Dword);
            let low = context.b.trunc(Type::I16, old);
            let (a, b) = (context.b.sext(Type::I32, low), context.b.sext(Type::I32, input));
            let product = context.b.binary(BinaryOp::Imul, a, b);
            let fits = context.b.bool_const(false);
            context.finish_integer(target, Width::Dword, old, product, fits);
        });
    }

    /// `DIV`: remainder in the high word, with the sign of the dividend; quotient in the low word, which sets the flags.
    pub fn division_with_remainder(&mut self, operands: &[Operand]) {
        let [input, output] = operands else { return };
        self.boxed(|context| {
            let divisor = context.read(input, Width::Word);
            let target = context.target(output, Width::Dword);
            let old = context.load(target, Width::Dword);
            let zero = context.b.icmp_imm(IntCc::Eq, divisor, 0);
            context.unless_zero(zero, |context| {
                let low = context.b.trunc(Type::I16, old);
                let (a, b) = (context.b.sext(Type::I32, low), context.b.sext(Type::I32, divisor));
                let quotient = context.b.binary(BinaryOp::Sdiv, a, b);
                let remainder = context.b.binary(BinaryOp::Srem, a, b);
                let low = context.b.trunc(Type::I16, quotient);
                let fits = context.b.sext(Type::I32, low);
                let overflow = context.b.icmp(IntCc::Ne, quotient, fits);
                let high = context.b.binary_imm(BinaryOp::Shl, remainder, 16);
                let wide_low = context.b.zext(Type::I32, low);
                let result = context.b.or(high, wide_low);
                let stored = context.b.select(overflow, old, result);
                context.store(target, Width::Dword, stored);
                let (zero, negative) = (context.b.icmp_imm(IntCc::Eq, low, 0), context.b.icmp_imm(IntCc::Slt, low, 0));
                context.set_result_flags(zero, negative, overflow);
            });
        });
    }

    /// `INCB` and the other increments and decrements: the value wraps, and the flags are those of the stored value. Bytes have no sign.
    pub fn step(&mut self, operands: &[Operand], width: Width, by: i64) {
        self.boxed(|context| {
            let target = context.target(&operands[0], width);
            let old = context.load(target, width);
            let result = context.b.binary_imm(BinaryOp::Iadd, old, by);
            context.store(target, width, result);
            let last = match (width, by > 0) {
                (Width::Byte, true) => 0xFF,
                (Width::Byte, false) => 0,
                (Width::Word, true) => i64::from(i16::MAX),
                (Width::Word, false) => i64::from(i16::MIN),
                (_, true) => i64::from(i32::MAX),
                (_, false) => i64::from(i32::MIN),
            };
            let overflow = context.b.icmp_imm(IntCc::Eq, old, last);
            let zero = context.b.icmp_imm(IntCc::Eq, result, 0);
            context.set_flag(ZERO, zero);
            context.set_flag(OVERFLOW, overflow);
            if width != Width::Byte {
                let negative = context.b.icmp_imm(IntCc::Slt, result, 0);
                context.set_flag(NEGATIVE, negative);
            }
            let fits = context.b.not(overflow);
            context.set(context.eno, fits);
        });
    }

    /// Value of a REAL operand, an f32.
    pub fn read_real(&mut self, operand: &Operand) -> Value {
        let bits = self.read(operand, Width::Dword);
        self.b.bitcast(Type::F32, bits)
    }

    /// i1: neither infinite nor NaN.
    fn is_finite(&mut self, x: Value) -> Value {
        let bits = self.b.bitcast(Type::I32, x);
        let exponent = self.b.binary_imm(BinaryOp::And, bits, EXPONENT);
        self.b.icmp_imm(IntCc::Ne, exponent, EXPONENT)
    }

    /// `+R -R *R /R`.
    pub fn real_binary(&mut self, operands: &[Operand], op: BinaryOp) {
        let [input, output] = operands else { return };
        self.boxed(|context| {
            let input = context.read_real(input);
            let target = context.target(output, Width::Dword);
            let old = context.load(target, Width::Dword);
            let a = context.b.bitcast(Type::F32, old);
            if op != BinaryOp::Fdiv {
                // A result that is finite has finite operands.
                let result = context.b.binary(op, a, input);
                let fits = context.is_finite(result);
                return context.finish_real(target, old, result, fits);
            }
            let nothing = context.b.f32_const(0.0);
            let zero = context.b.fcmp(FloatCc::Eq, input, nothing);
            context.unless_zero(zero, |context| {
                let result = context.b.binary(op, a, input);
                let (result_fits, input_fits) = (context.is_finite(result), context.is_finite(input));
                let fits = context.b.and(result_fits, input_fits);
                context.finish_real(target, old, result, fits);
            });
        });
    }

    fn finish_real(&mut self, target: Place, old: Value, result: Value, fits: Value) {
        let bits = self.b.bitcast(Type::I32, result);
        let stored = self.b.select(fits, bits, old);
        self.store(target, Width::Dword, stored);
        let nothing = self.b.f32_const(0.0);
        let (zero, negative) = (self.b.fcmp(FloatCc::Eq, result, nothing), self.b.fcmp(FloatCc::Lt, result, nothing));
        let overflow = self.b.not(fits);
        self.set_result_flags(zero, negative, overflow);
    }

    /// A function of one REAL; operand and result must be finite.
    fn real_unary(&mut self, operands: &[Operand], compute: impl FnOnce(&mut Self, Value) -> Value) {
        let [input, output] = operands else { return };
        self.boxed(|context| {
            let x = context.read_real(input);
            let target = context.target(output, Width::Dword);
            let old = context.load(target, Width::Dword);
            let result = compute(context, x);
            let (result_fits, input_fits) = (context.is_finite(result), context.is_finite(x));
            let fits = context.b.and(result_fits, input_fits);
            context.finish_real(target, old, result, fits);
        });
    }

    /// `SQRT`: NaN for a negative number, an overflow.
    pub fn square_root(&mut self, operands: &[Operand]) {
        self.real_unary(operands, |context, x| context.b.unary(UnaryOp::Fsqrt, x));
    }

    /// `LN`: infinite for 0, NaN for a negative number.
    pub fn logarithm(&mut self, operands: &[Operand]) {
        self.real_function(operands, RuntimeFn::LnLong);
    }

    /// `SIN COS TAN EXP LN`: in double precision, rounded once.
    pub fn real_function(&mut self, operands: &[Operand], function: RuntimeFn) {
        self.real_unary(operands, |context, x| {
            let x = context.b.convert(ConvertOp::Fpromote, Type::F64, x);
            let y = context.b.call_pure(function, &[x]);
            context.b.convert(ConvertOp::Fdemote, Type::F32, y)
        });
    }
}
