//! BCD numbers: digits, above them the sign.

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

    /// The bits of the digits, each of which is `digit`.
    fn all(self, digit: u32) -> u32 {
        0x1111_1111u32.wrapping_mul(digit) & self.mask()
    }

    fn mask(self) -> u32 {
        (1 << (4 * self.digits)) - 1
    }

    /// The number of the digits in `bits`, an i32; and i1: no digit is above 9. Otherwise the number means nothing.
    pub fn magnitude(self, b: &mut FunctionBuilder, bits: Value) -> (Value, Value) {
        let bits = b.binary_imm(BinaryOp::And, bits, i64::from(self.mask()));
        // With 6 more a digit above 9 carries into the next one, and only then.
        let sixes = i64::from(self.all(6));
        let more = b.binary_imm(BinaryOp::Iadd, bits, sixes);
        let without_carries = b.binary_imm(BinaryOp::Xor, bits, sixes);
        let carries = b.xor(more, without_carries);
        let carries = b.binary_imm(BinaryOp::And, carries, i64::from(self.all(1) << 4));
        let ok = b.icmp_imm(IntCc::Eq, carries, 0);
        // Digits become pairs of digits, then fours, then all: in each the high half counts less than its place says.
        let mut number = bits;
        for (shift, high_halves, less) in [(4, 0x0F0F_0F0F, 16 - 10), (8, 0x00FF_00FF, 256 - 100), (16, 0xFFFF, 55_536)]
        {
            if 4 * self.digits > shift {
                let high = b.binary_imm(BinaryOp::Lshr, number, i64::from(shift));
                let high = b.binary_imm(BinaryOp::And, high, high_halves);
                let less = b.binary_imm(BinaryOp::Imul, high, less);
                number = b.isub(number, less);
            }
        }
        (number, ok)
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
        (self.digits_of_small(b, within), too_large)
    }

    /// The digits of a number, an i32, that has no more of them than the form.
    pub fn digits_of_small(self, b: &mut FunctionBuilder, number: Value) -> Value {
        if self.digits <= 4 {
            return four_digits(b, number, self.digits);
        }
        // In 64 bits the quotient by 10000 is exact for all 32 bits.
        let wide = b.zext(Type::I64, number);
        let high = b.binary_imm(BinaryOp::Imul, wide, 3_518_437_209);
        let high = b.binary_imm(BinaryOp::Lshr, high, 45);
        let high = b.trunc(Type::I32, high);
        let whole = b.binary_imm(BinaryOp::Imul, high, 10_000);
        let low = b.isub(number, whole);
        let (high, low) = (four_digits(b, high, self.digits - 4), four_digits(b, low, 4));
        let high = b.binary_imm(BinaryOp::Shl, high, 16);
        b.or(high, low)
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

/// The `digits` digits of a number that has no more, at most four: each quotient adds what its digit counts more in BCD than in
/// decimal.
fn four_digits(b: &mut FunctionBuilder, number: Value, digits: u32) -> Value {
    // By 10, 100 and 1000, exact up to 9999.
    let quotients = [(6554, 16, 16 - 10), (5243, 19, 16 * (16 - 10)), (8389, 23, 256 * (16 - 10))];
    let mut result = number;
    for (factor, shift, more) in quotients.into_iter().take(digits.saturating_sub(1) as usize) {
        let quotient = b.binary_imm(BinaryOp::Imul, number, factor);
        let quotient = b.binary_imm(BinaryOp::Lshr, quotient, shift);
        let more = b.binary_imm(BinaryOp::Imul, quotient, more);
        result = b.iadd(result, more);
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bits of `number` as BCD, written out.
    fn bcd(number: u32) -> u32 {
        u32::from_str_radix(&number.to_string(), 16).expect("decimal digits are hexadecimal digits")
    }

    fn numbers(form: Bcd) -> impl Iterator<Item = u32> {
        let end = 10u32.pow(form.digits);
        (0..end).step_by(if end > 100_000 { 97 } else { 1 }).chain([end - 1])
    }

    #[test]
    fn numbers_there_and_back() {
        for form in [Bcd::WORD, Bcd::UNSIGNED_WORD, Bcd::DWORD] {
            for number in numbers(form) {
                // The builder computes with constants.
                let mut b = FunctionBuilder::new("F", &[], &[]);
                let value = b.i32_const(number);
                let digits = form.digits_of_small(&mut b, value);
                assert_eq!(b.constant_bits(digits), Some(u64::from(bcd(number))), "{number}");
                let (back, ok) = form.magnitude(&mut b, digits);
                assert_eq!(
                    (b.constant_bits(back), b.constant_bits(ok)),
                    (Some(u64::from(number)), Some(1)),
                    "{number}"
                );
            }
        }
    }

    #[test]
    fn digits_above_9() {
        for form in [Bcd::WORD, Bcd::UNSIGNED_WORD, Bcd::DWORD] {
            for bits in (0..=0xFFFFu32).flat_map(|low| [low, low << 12 | 0x999, low << 16 | 0x9999]) {
                let mut b = FunctionBuilder::new("F", &[], &[]);
                let value = b.i32_const(bits);
                let (_, ok) = form.magnitude(&mut b, value);
                let good = (0..form.digits).all(|digit| bits >> (4 * digit) & 0xF <= 9);
                assert_eq!(b.constant_bits(ok), Some(u64::from(good)), "{bits:#x}");
            }
        }
    }
}
