//! Integer and real mathematics. Source: S7-200 system manual, math instructions.
//!
//! A result that does not fit leaves OUT unchanged: SM1.1 is 1, SM1.0 and SM1.2 are 0. A division by zero sets SM1.3 and changes nothing else.

use plcc_abi::RuntimeFn;
use plcc_ir::{BinaryOp, ConvertOp, FloatCc, IntCc, Type, UnaryOp, Value};
use plcc_model::s7200::{Operand, Width};

use super::block::S7200Lowering;
use super::operand::Place;
use super::plan::ir_type;
use crate::arithmetic::float;
use crate::arithmetic::integer::{self, Narrowed};

/// Bits of SM1.
pub const ZERO: u8 = 0;
pub const OVERFLOW: u8 = 1;
pub const NEGATIVE: u8 = 2;
pub const DIVIDE_BY_ZERO: u8 = 3;
pub const TABLE_FULL: u8 = 4;
pub const TABLE_EMPTY: u8 = 5;
pub const NOT_BCD: u8 = 6;

impl S7200Lowering<'_, '_> {
    /// `+I -I +D -D`.
    pub fn integer_sum(&mut self, operands: &[Operand], width: Width, op: BinaryOp) {
        self.in_place(operands, width, |lowering, old, input| {
            let result = lowering.b.binary(op, old, input);
            (result, integer::sum_overflow(&mut lowering.b, op, old, input, result))
        });
    }

    /// `*I`, `*D`: a product of the width of its operands.
    pub fn integer_product(&mut self, operands: &[Operand], width: Width) {
        self.in_place(operands, width, |lowering, old, input| {
            let product = integer::product(&mut lowering.b, old, input);
            (product.value, product.overflow)
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
        self.boxed(|lowering| {
            let input = lowering.read(input, width);
            let target = lowering.target(output, width);
            let old = lowering.load(target, width);
            let (result, overflow) = compute(lowering, old, input);
            lowering.finish_integer(target, width, old, result, overflow);
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
        self.boxed(|lowering| {
            let divisor = lowering.read(input, width);
            let target = lowering.target(output, width);
            let old = lowering.load(target, width);
            let zero = lowering.b.icmp_imm(IntCc::Eq, divisor, 0);
            lowering.unless_zero(zero, |lowering| {
                // One step wider, so the smallest number divided by -1 is representable.
                let wide = if width == Width::Word { Type::I32 } else { Type::I64 };
                let (a, b) = (lowering.b.sext(wide, old), lowering.b.sext(wide, divisor));
                let quotient = integer::quotient(&mut lowering.b, a, b, ir_type(width));
                lowering.finish_integer(target, width, old, quotient.value, quotient.overflow);
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
        self.boxed(|lowering| {
            let input = lowering.read(input, Width::Word);
            let target = lowering.target(output, Width::Dword);
            let old = lowering.load(target, Width::Dword);
            let low = lowering.b.trunc(Type::I16, old);
            let (a, b) = (lowering.b.sext(Type::I32, low), lowering.b.sext(Type::I32, input));
            let product = lowering.b.binary(BinaryOp::Imul, a, b);
            let fits = lowering.b.bool_const(false);
            lowering.finish_integer(target, Width::Dword, old, product, fits);
        });
    }

    /// `DIV`: remainder in the high word, with the sign of the dividend; quotient in the low word, which sets the flags.
    pub fn division_with_remainder(&mut self, operands: &[Operand]) {
        let [input, output] = operands else { return };
        self.boxed(|lowering| {
            let divisor = lowering.read(input, Width::Word);
            let target = lowering.target(output, Width::Dword);
            let old = lowering.load(target, Width::Dword);
            let zero = lowering.b.icmp_imm(IntCc::Eq, divisor, 0);
            lowering.unless_zero(zero, |lowering| {
                let low = lowering.b.trunc(Type::I16, old);
                let (a, b) = (lowering.b.sext(Type::I32, low), lowering.b.sext(Type::I32, divisor));
                let (Narrowed { value, overflow, .. }, result) = integer::quotient_and_remainder(&mut lowering.b, a, b);
                let stored = lowering.b.select(overflow, old, result);
                lowering.store(target, Width::Dword, stored);
                let (zero, negative) =
                    (lowering.b.icmp_imm(IntCc::Eq, value, 0), lowering.b.icmp_imm(IntCc::Slt, value, 0));
                lowering.set_result_flags(zero, negative, overflow);
            });
        });
    }

    /// `INCB` and the other increments and decrements: the value wraps, and the flags are those of the stored value. Bytes have no sign.
    pub fn step(&mut self, operands: &[Operand], width: Width, by: i64) {
        self.boxed(|lowering| {
            let target = lowering.target(&operands[0], width);
            let old = lowering.load(target, width);
            let result = lowering.b.binary_imm(BinaryOp::Iadd, old, by);
            lowering.store(target, width, result);
            let last = match (width, by > 0) {
                (Width::Byte, true) => 0xFF,
                (Width::Byte, false) => 0,
                (Width::Word, true) => i64::from(i16::MAX),
                (Width::Word, false) => i64::from(i16::MIN),
                (_, true) => i64::from(i32::MAX),
                (_, false) => i64::from(i32::MIN),
            };
            let overflow = lowering.b.icmp_imm(IntCc::Eq, old, last);
            let zero = lowering.b.icmp_imm(IntCc::Eq, result, 0);
            lowering.set_flag(ZERO, zero);
            lowering.set_flag(OVERFLOW, overflow);
            if width != Width::Byte {
                let negative = lowering.b.icmp_imm(IntCc::Slt, result, 0);
                lowering.set_flag(NEGATIVE, negative);
            }
            let fits = lowering.b.not(overflow);
            lowering.set(lowering.eno, fits);
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
        float::is_finite_from_bits(&mut self.b, bits)
    }

    /// `+R -R *R /R`.
    pub fn real_binary(&mut self, operands: &[Operand], op: BinaryOp) {
        let [input, output] = operands else { return };
        self.boxed(|lowering| {
            let input = lowering.read_real(input);
            let target = lowering.target(output, Width::Dword);
            let old = lowering.load(target, Width::Dword);
            let a = lowering.b.bitcast(Type::F32, old);
            if op != BinaryOp::Fdiv {
                // A result that is finite has finite operands.
                let result = lowering.b.binary(op, a, input);
                let fits = lowering.is_finite(result);
                return lowering.finish_real(target, old, result, fits);
            }
            let nothing = lowering.b.f32_const(0.0);
            let zero = lowering.b.fcmp(FloatCc::Eq, input, nothing);
            lowering.unless_zero(zero, |lowering| {
                let result = lowering.b.binary(op, a, input);
                let (result_fits, input_fits) = (lowering.is_finite(result), lowering.is_finite(input));
                let fits = lowering.b.and(result_fits, input_fits);
                lowering.finish_real(target, old, result, fits);
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
        self.boxed(|lowering| {
            let x = lowering.read_real(input);
            let target = lowering.target(output, Width::Dword);
            let old = lowering.load(target, Width::Dword);
            let result = compute(lowering, x);
            let (result_fits, input_fits) = (lowering.is_finite(result), lowering.is_finite(x));
            let fits = lowering.b.and(result_fits, input_fits);
            lowering.finish_real(target, old, result, fits);
        });
    }

    /// `SQRT`: NaN for a negative number, an overflow.
    pub fn square_root(&mut self, operands: &[Operand]) {
        self.real_unary(operands, |lowering, x| lowering.b.unary(UnaryOp::Fsqrt, x));
    }

    /// `LN`: infinite for 0, NaN for a negative number.
    pub fn logarithm(&mut self, operands: &[Operand]) {
        self.real_function(operands, RuntimeFn::LnLong);
    }

    /// `SIN COS TAN EXP LN`: in double precision, rounded once.
    pub fn real_function(&mut self, operands: &[Operand], function: RuntimeFn) {
        self.real_unary(operands, |lowering, x| {
            let x = lowering.b.convert(ConvertOp::Fpromote, Type::F64, x);
            let y = lowering.b.call_pure(function, &[x]);
            lowering.b.convert(ConvertOp::Fdemote, Type::F32, y)
        });
    }
}
