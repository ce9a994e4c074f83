//! The data of a channel: as the device has them in its frames, and as the CPU has them in its bytes.

use plcc_abi::remote::{RemoteChannel, RemoteScale};

/// Puts what a device has sent into the bytes of the CPU. Bits beside those of the channel stay.
pub fn to_cpu(channel: &RemoteChannel, sent: &[u8], bytes: &mut [u8]) {
    if channel.table.has_bits() {
        for index in 0..usize::from(channel.count) {
            let value = sent.get(index / 8).is_some_and(|byte| byte >> (index % 8) & 1 != 0);
            set_bit(bytes, usize::from(channel.bit) + index, value);
        }
        return;
    }
    for (index, word) in words(channel, sent).into_iter().enumerate() {
        let word = channel.scale.map_or(word, |scale| to_word(scale, word));
        if let Some(place) = bytes.get_mut(2 * index..2 * index + 2) {
            place.copy_from_slice(&word.to_be_bytes());
        }
    }
}

/// What a device gets of the bytes of the CPU.
pub fn to_device(channel: &RemoteChannel, bytes: &[u8]) -> Vec<u8> {
    let count = usize::from(channel.count);
    if channel.table.has_bits() {
        let mut out = vec![0; count.div_ceil(8)];
        for index in 0..count {
            let at = usize::from(channel.bit) + index;
            let value = bytes.get(at / 8).is_some_and(|byte| byte >> (at % 8) & 1 != 0);
            set_bit(&mut out, index, value);
        }
        return out;
    }
    let scaled: Vec<u8> = bytes
        .chunks_exact(2)
        .take(count)
        .flat_map(|pair| {
            let word = u16::from_be_bytes([pair[0], pair[1]]);
            channel.scale.map_or(word, |scale| to_raw(scale, word)).to_be_bytes()
        })
        .collect();
    words(channel, &scaled).into_iter().flat_map(u16::to_be_bytes).collect()
}

/// The bytes with substitute values.
pub fn substitute(channel: &RemoteChannel, bytes: &mut [u8]) {
    if channel.table.has_bits() {
        for index in 0..usize::from(channel.count) {
            set_bit(bytes, usize::from(channel.bit) + index, channel.substitute != 0);
        }
        return;
    }
    for pair in bytes.chunks_exact_mut(2).take(channel.count.into()) {
        pair.copy_from_slice(&channel.substitute.to_be_bytes());
    }
}

fn set_bit(bytes: &mut [u8], at: usize, value: bool) {
    if let Some(byte) = bytes.get_mut(at / 8) {
        *byte = *byte & !(1 << (at % 8)) | u8::from(value) << (at % 8);
    }
}

/// The words of registers, in the order of the other side: the same both ways.
fn words(channel: &RemoteChannel, bytes: &[u8]) -> Vec<u16> {
    let order = |pair: &[u8]| match channel.low_byte_first {
        true => u16::from_le_bytes([pair[0], pair[1]]),
        false => u16::from_be_bytes([pair[0], pair[1]]),
    };
    let mut words: Vec<u16> = bytes.chunks_exact(2).map(order).collect();
    if channel.low_word_first {
        words.chunks_exact_mut(2).for_each(|pair| pair.swap(0, 1));
    }
    words
}

/// The word of a number of the device; beyond what a word holds overflow or underflow.
fn to_word(scale: RemoteScale, raw: u16) -> u16 {
    let number = if scale.raw_low.min(scale.raw_high) < 0 { i64::from(raw as i16) } else { i64::from(raw) };
    let (from, to) = (scale.raw_low, scale.word_low);
    let word = line(number, from, scale.raw_high, to, scale.word_high);
    word.clamp(i16::MIN.into(), i16::MAX.into()) as i16 as u16
}

/// The number of the device for a word, limited to what a register holds.
fn to_raw(scale: RemoteScale, word: u16) -> u16 {
    let (from, to) = (scale.word_low, scale.raw_low);
    let number = line(i64::from(word as i16), from, scale.word_high, to, scale.raw_high);
    match scale.raw_low.min(scale.raw_high) < 0 {
        true => number.clamp(i16::MIN.into(), i16::MAX.into()) as i16 as u16,
        false => number.clamp(0, u16::MAX.into()) as u16,
    }
}

/// The straight line through two points, rounded to the nearest, halves away from 0.
fn line(x: i64, x0: i32, x1: i32, y0: i32, y1: i32) -> i64 {
    let (x0, x1, y0, y1) = (i64::from(x0), i64::from(x1), i64::from(y0), i64::from(y1));
    if x1 == x0 {
        return y0;
    }
    let y = (x - x0) as f64 * (y1 - y0) as f64 / (x1 - x0) as f64;
    (y0 as f64 + y).round() as i64
}

#[cfg(test)]
mod tests {
    use plcc_abi::remote::RemoteTable;

    use super::*;

    fn channel(table: RemoteTable, count: u16) -> RemoteChannel {
        RemoteChannel {
            table,
            first: 0,
            count,
            output: false,
            byte: 0,
            bit: 0,
            low_byte_first: false,
            low_word_first: false,
            scale: None,
            substitute: 0,
        }
    }

    #[test]
    fn bits_begin_anywhere_and_leave_others() {
        let bits = RemoteChannel { bit: 6, substitute: 1, ..channel(RemoteTable::Coils, 10) };
        assert_eq!(bits.bytes(), 2);
        let mut bytes = [0x3F, 0x00];
        to_cpu(&bits, &[0b0000_0101, 0b10], &mut bytes);
        assert_eq!(bytes, [0x7F, 0b1000_0001]);
        assert_eq!(to_device(&bits, &bytes), [0b0000_0101, 0b10]);
        to_cpu(&bits, &[], &mut bytes);
        assert_eq!(bytes, [0x3F, 0x00]);
        substitute(&bits, &mut bytes);
        assert_eq!(bytes, [0xFF, 0xFF]);
    }

    #[test]
    fn each_order_of_bytes_and_words_is_its_own_inverse() {
        for (low_byte_first, low_word_first, expected) in [
            (false, false, [0x11, 0x22, 0x33, 0x44]),
            (true, false, [0x22, 0x11, 0x44, 0x33]),
            (false, true, [0x33, 0x44, 0x11, 0x22]),
            (true, true, [0x44, 0x33, 0x22, 0x11]),
        ] {
            let pair = RemoteChannel { low_byte_first, low_word_first, ..channel(RemoteTable::HoldingRegisters, 2) };
            let mut bytes = [0; 4];
            to_cpu(&pair, &[0x11, 0x22, 0x33, 0x44], &mut bytes);
            assert_eq!(bytes, expected);
            assert_eq!(to_device(&pair, &bytes), [0x11, 0x22, 0x33, 0x44]);
        }
    }

    #[test]
    fn words_follow_the_range() {
        let unipolar = RemoteScale { raw_low: 0, raw_high: 10_000, word_low: 0, word_high: 27_648 };
        for (raw, word) in [(0, 0), (5_000, 13_824), (10_000, 27_648), (10_001, 27_651), (65_535, 32_767)] {
            assert_eq!(to_word(unipolar, raw), word, "{raw}");
        }
        assert_eq!((to_raw(unipolar, 13_824), to_raw(unipolar, -100i16 as u16)), (5_000, 0));
        let bipolar = RemoteScale { raw_low: -1_000, raw_high: 1_000, word_low: -27_648, word_high: 27_648 };
        assert_eq!(to_word(bipolar, -500i16 as u16) as i16, -13_824);
        assert_eq!(to_raw(bipolar, -13_824i16 as u16) as i16, -500);
        // A device that counts down.
        let falling = RemoteScale { raw_low: 4_000, raw_high: 0, word_low: 0, word_high: 27_648 };
        assert_eq!((to_word(falling, 4_000), to_word(falling, 0)), (0, 27_648));
    }
}
