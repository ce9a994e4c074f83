//! BCD numbers and S5TIME, without state.

/// Set in the result of [`to_int`] when a digit is above 9.
pub const BAD_DIGIT: u32 = 1 << 31;

/// Magnitude of the low `digits` (0..=8) BCD digits of `value`, or [`BAD_DIGIT`].
pub fn to_int(value: u32, digits: u32) -> u32 {
    let mut result = 0;
    for digit in (0..digits.min(8)).rev() {
        let nibble = value >> (4 * digit) & 0xF;
        if nibble > 9 {
            return BAD_DIGIT;
        }
        result = result * 10 + nibble;
    }
    result
}

/// The low `digits` (0..=8) decimal digits of `value` as BCD.
pub fn from_int(value: u32, digits: u32) -> u32 {
    let mut rest = value;
    let mut result = 0;
    for digit in 0..digits.min(8) {
        result |= (rest % 10) << (4 * digit);
        rest /= 10;
    }
    result
}

/// One byte of two digits, as in DATE_AND_TIME; `None` when a digit is above 9.
pub fn byte_to_int(byte: u8) -> Option<u8> {
    let (high, low) = (byte >> 4, byte & 0xF);
    (high <= 9 && low <= 9).then_some(high * 10 + low)
}

/// Nanoseconds of time base 0..=3 of an S5TIME: 10 ms, 100 ms, 1 s, 10 s. Source: Programming with STEP 7, format of S5TIME.
pub const fn s5_base_ns(base: u8) -> u64 {
    [10_000_000, 100_000_000, 1_000_000_000, 10_000_000_000][(base & 3) as usize]
}

/// S5TIME of milliseconds: the finest base that holds them, digits below it cut off; `None` above 9,990,000.
pub fn s5_from_ms(ms: u64) -> Option<u16> {
    let base = (0..4u8).find(|&base| ms / (s5_base_ns(base) / 1_000_000) <= 999)?;
    let units = (ms / (s5_base_ns(base) / 1_000_000)) as u32;
    Some(u16::from(base) << 12 | from_int(units, 3) as u16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bcd_digits() {
        assert_eq!(to_int(0x0999, 3), 999);
        assert_eq!(to_int(0x00A0, 3), BAD_DIGIT);
        assert_eq!(to_int(0xF123, 3), 123);
        assert_eq!(to_int(0x9_999_999, 7), 9_999_999);
        assert_eq!(from_int(9_999_999, 7), 0x9_999_999);
        assert_eq!(from_int(0, 3), 0);
    }

    #[test]
    fn s5time_literals_of_the_reference() {
        assert_eq!(s5_from_ms(123_400), Some(0x2123));
        assert_eq!(s5_from_ms(400), Some(0x0040));
        assert_eq!(s5_from_ms(10_000), Some(0x1100));
        assert_eq!(s5_from_ms(3_723_400), Some(0x3372));
        assert_eq!(s5_from_ms(9_990_000), Some(0x3999));
        assert_eq!(s5_from_ms(10_000_000), None);
        assert_eq!(s5_from_ms(9), Some(0));
    }
}
