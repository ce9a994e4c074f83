//! Divisions of integers of at most 32 bits by constants, as products of 64 bits.
//!
//! With `factor` a little more than 2^shift / divisor, the product is a little more than the quotient times 2^shift, and so little that the
//! bits above `shift` are the quotient as long as the number is not too large. That of a negative number is below its quotient, which is cut
//! towards 0: one more.
//!
//! ```text
//! x / 10     (x * 429496730) >> 32, and 1 more if x is negative
//! ```
//!
//! Cranelift does this for 32 and 64 bits, with the upper half of a product, which is always in the same two registers.

use cranelift_codegen::ir::{InstBuilder, Value as ClifValue, types};
use plcc_ir::{BinaryOp, Value};

use super::Lowering;
use crate::CodegenError;
use crate::abi::clif_type;
use crate::memory::constant;

/// Bits of a number and of the factors that 64 bits have room for.
const FACTOR_BITS: u32 = 32;

/// Factor and shift for numbers of a magnitude of at most 2^`bits`. `None`: a shift does it, or there are none.
fn reciprocal(divisor: u64, bits: u32) -> Option<(u64, u32)> {
    if divisor.is_power_of_two() {
        return None;
    }
    (FACTOR_BITS..63).find_map(|shift| {
        let factor = (1u64 << shift) / divisor + 1;
        let excess = factor * divisor - (1 << shift);
        (factor < 1 << FACTOR_BITS && excess < 1 << (shift - bits)).then_some((factor, shift))
    })
}

impl Lowering<'_, '_> {
    /// `x` divided by a constant, or what is left of it. `None`: Cranelift knows as much.
    pub(super) fn divided(
        &mut self,
        op: BinaryOp,
        x: Value,
        divisor: Value,
    ) -> Result<Option<ClifValue>, CodegenError> {
        let (is_signed, is_rest) = match op {
            BinaryOp::Sdiv => (true, false),
            BinaryOp::Srem => (true, true),
            BinaryOp::Udiv => (false, false),
            BinaryOp::Urem => (false, true),
            _ => return Ok(None),
        };
        let ty = self.function.ty(x);
        let bits = ty.bits() - u32::from(is_signed);
        let Some(divisor) = self.function.constant(divisor).filter(|&divisor| (3..1 << bits).contains(&divisor)) else {
            return Ok(None);
        };
        let Some((factor, shift)) = (bits < 32).then(|| reciprocal(divisor, bits)).flatten() else { return Ok(None) };
        let (x, clif) = (self.value(x)?, clif_type(ty));
        let b = &mut self.b;
        let wide = if is_signed { b.ins().sextend(types::I64, x) } else { b.ins().uextend(types::I64, x) };
        let factor = constant(b, types::I64, factor);
        let product = b.ins().imul(wide, factor);
        let shift = constant(b, types::I64, shift.into());
        let quotient = if is_signed {
            let below = b.ins().sshr(product, shift);
            let sign = constant(b, types::I64, 63);
            let is_negative = b.ins().ushr(wide, sign);
            b.ins().iadd(below, is_negative)
        } else {
            b.ins().ushr(product, shift)
        };
        let quotient = b.ins().ireduce(clif, quotient);
        if !is_rest {
            return Ok(Some(quotient));
        }
        let divisor = constant(b, clif, divisor);
        let whole = b.ins().imul(quotient, divisor);
        Ok(Some(b.ins().isub(x, whole)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The ends of all ranges in which a quotient is the same, where an error would show.
    #[test]
    fn quotients_are_exact() {
        let divisors =
            (3..400).chain([999, 1000, 9001, 10_000, 27_648, 32_767, 65_535, 1_000_000, 999_999_937, 0x7FFF_FFFF]);
        for divisor in divisors {
            for bits in [7, 8, 15, 16, 31] {
                let Some((factor, shift)) = reciprocal(divisor, bits).filter(|_| divisor < 1 << bits) else { continue };
                let most = (1u64 << bits) / divisor;
                let quotients = (0..200).chain(most.saturating_sub(200)..=most);
                for number in quotients.flat_map(|quotient| [quotient * divisor, (quotient + 1) * divisor - 1]) {
                    let number = number.min((1 << bits) - 1) as i64;
                    assert_eq!((number * factor as i64) >> shift, number / divisor as i64, "{number} / {divisor}");
                    let number = -number - 1;
                    assert_eq!(
                        ((number * factor as i64) >> shift) + 1,
                        number / divisor as i64,
                        "{number} / {divisor}"
                    );
                }
            }
        }
    }

    #[test]
    fn all_divisors_of_words_have_a_factor() {
        for divisor in (3u64..1 << 16).filter(|divisor| !divisor.is_power_of_two()) {
            assert!(reciprocal(divisor, 16).is_some(), "{divisor}");
        }
    }
}
