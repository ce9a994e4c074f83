//! BCD numbers: digits, above them the sign.

use plcc_abi::RuntimeFn;
use plcc_ir::{BinaryOp, FunctionBuilder, IntCc, Type, Value};

use super::integer;

/// A form of BCD numbers.
#[derive(Clone, Copy)]
pub struct Bcd {
    digits: u32,
    /// Bits of the sign, all of them 1 if the number is negative; the highest one is read.
    sign: u32,
}

impl Bcd {
    /// A word with three digits and a sign.
    pub const WORD: Bcd = Bcd { digits: 3, sign: 0xF000 };
    /// A double word with seven digits and a sign.
    pub const DWORD: Bcd = Bcd { digits: 7, sign: 0xF000_0000 };
    /// A word with four digits.
    pub const UNSIGNED_WORD: Bcd = Bcd { digits: 4, sign: 0 };

    /// The number of the digits in `bits`, an i32; and i1: no digit is above 9.
    pub fn magnitude(self, b: &mut FunctionBuilder, bits: Value) -> (Value, Value) {
        let digits = b.i32_const(self.digits);
        let answer = b.call_pure(RuntimeFn::BcdToInt, &[bits, digits]);
        (answer, b.icmp_imm(IntCc::Sge, answer, 0))
    }

    /// `magnitude` with the sign in `bits`.
    pub fn with_sign(self, b: &mut FunctionBuilder, bits: Value, magnitude: Value) -> Value {
        let sign = b.binary_imm(BinaryOp::Lshr, bits, i64::from(self.sign.ilog2()));
        let negative = b.trunc(Type::I1, sign);
        let minus = integer::negated(b, magnitude);
        b.select(negative, minus, magnitude)
    }

    /// The digits of a number, an i32 read as unsigned; and i1: it is too large, then they are 0.
    pub fn digits(self, b: &mut FunctionBuilder, magnitude: Value) -> (Value, Value) {
        let zero = b.i32_const(0);
        self.digits_or(b, magnitude, zero)
    }

    fn digits_or(self, b: &mut FunctionBuilder, magnitude: Value, zero: Value) -> (Value, Value) {
        let most = 10i64.pow(self.digits) - 1;
        let too_large = b.icmp_imm(IntCc::Ugt, magnitude, most);
        let within = b.select(too_large, zero, magnitude);
        let digits = b.i32_const(self.digits);
        (b.call_pure(RuntimeFn::IntToBcd, &[within, digits]), too_large)
    }

    /// Like [`Bcd::digits`], of a signed number and with its sign.
    pub fn digits_and_sign(self, b: &mut FunctionBuilder, number: Value) -> (Value, Value) {
        let negative = b.icmp_imm(IntCc::Slt, number, 0);
        let zero = b.i32_const(0);
        let minus = b.isub(zero, number);
        let magnitude = b.select(negative, minus, number);
        let (digits, too_large) = self.digits_or(b, magnitude, zero);
        let sign = b.i32_const(self.sign);
        let sign = b.select(negative, sign, zero);
        (b.or(digits, sign), too_large)
    }
}
