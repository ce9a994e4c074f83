//! Characters of texts, in words of eight.
//!
//! A word as a number has its first character lowest: what is done to each character at once then carries from one to the next, and a shift
//! by whole characters drops the first ones.

use plcc_ir::{Address, BinaryOp, IntCc, Type, UnaryOp, Value};

use crate::block::BlockLowering;
use crate::pointer::moved;
use crate::scl::OwnText;

/// Characters of a word.
pub const WORD: u32 = 8;

/// A word in which each character is the lowest bit.
const ONES: u64 = 0x0101_0101_0101_0101;
const HIGH_BITS: u64 = ONES << 7;
const ZEROS_AS_TEXT: u64 = ONES * b'0' as u64;

impl BlockLowering<'_, '_> {
    /// `addr` plus `index` bytes, an i32. A constant one may be anything where a constant position is wrong, in code that never runs: so it
    /// is a base, which becomes an offset if it is inside.
    pub(super) fn indexed(&mut self, addr: Address, index: Value) -> Address {
        if self.b.constant_bits(index) == Some(0) {
            return addr;
        }
        let base = match addr.base {
            Some(base) => self.b.iadd(base, index),
            None => index,
        };
        Address { base: Some(base), ..addr }
    }

    /// The first character lowest, an i64.
    pub fn load_word(&mut self, addr: Address) -> Value {
        let word = self.b.load(Type::I64, addr);
        self.b.unary(UnaryOp::Bswap, word)
    }

    /// The first eight characters at `start`, where as many exist as are `declared`, the first one lowest. `None`: none exist.
    pub(super) fn first_characters(&mut self, start: Address, declared: u64) -> Option<Value> {
        let ty = match declared {
            0 => return None,
            1 => Type::I8,
            2..4 => Type::I16,
            4..8 => Type::I32,
            _ => return Some(self.load_word(start)),
        };
        let bytes = u64::from(ty.bytes());
        let mut piece = |from: u64| {
            let piece = self.b.load(ty, moved(start, from as u32));
            let piece = if ty == Type::I8 { piece } else { self.b.unary(UnaryOp::Bswap, piece) };
            let piece = self.b.zext(Type::I64, piece);
            self.b.binary_imm(BinaryOp::Shl, piece, 8 * from as i64)
        };
        let first = piece(0);
        if declared == bytes {
            return Some(first);
        }
        // Characters that are in both pieces are the same.
        let last = piece(declared - bytes);
        Some(self.b.or(first, last))
    }

    /// Stores eight characters.
    pub(super) fn store_word(&mut self, to: Address, word: Value) {
        let word = self.b.unary(UnaryOp::Bswap, word);
        self.b.store(to, word);
    }

    /// Constant characters as a word, those that there are of the first eight.
    pub(super) fn constant_word(&mut self, characters: &[u8]) -> Value {
        let bits = characters.iter().take(WORD as usize).rev().fold(0, |bits, &byte| bits << 8 | u64::from(byte));
        self.word(bits)
    }

    /// Stores constant characters as all that a text at `to` has, `own` if it is one.
    pub fn store_characters(&mut self, to: Address, characters: &[u8], own: Option<OwnText>) {
        let Some(own) = own.filter(OwnText::has_word) else { return self.store_bytes(to, characters) };
        let word = self.constant_word(characters);
        match characters.len() {
            0 => {}
            length if length <= WORD as usize => self.store_word(to, word),
            _ => self.store_bytes(to, characters),
        }
        self.set_own_word(own, word);
    }

    /// `count` characters of `word`, an i32 of at most `most`, and after them those of `after`.
    pub(super) fn word_before(&mut self, word: Value, count: Value, most: u32, after: Value) -> Value {
        match self.b.constant_bits(count) {
            Some(0) => return after,
            Some(count) if count >= u64::from(WORD) => return word,
            _ => {}
        }
        let bits = self.bits_of(count);
        let mask = self.few_bits(bits);
        let kept = self.b.and(word, mask);
        let moved = self.b.binary(BinaryOp::Shl, after, bits);
        let both = self.b.or(kept, moved);
        if most < WORD {
            return both;
        }
        let is_whole = self.b.icmp_imm(IntCc::Uge, count, WORD.into());
        self.b.select(is_whole, word, both)
    }

    /// The characters of `word` after the first `skipped`, an i32 of at most eight. After all of them it is anything.
    pub(super) fn word_after(&mut self, word: Value, skipped: Value) -> Value {
        if self.b.constant_bits(skipped) == Some(0) {
            return word;
        }
        let bits = self.bits_of(skipped);
        self.b.binary(BinaryOp::Lshr, word, bits)
    }

    /// As memory has them, the characters of `word` after the first `skipped`, as many as `ty` has bytes.
    pub(super) fn piece(&mut self, ty: Type, word: Value, skipped: Value) -> Value {
        let word = self.word_after(word, skipped);
        if ty == Type::I64 {
            return self.b.unary(UnaryOp::Bswap, word);
        }
        let piece = self.b.trunc(ty, word);
        if ty == Type::I8 { piece } else { self.b.unary(UnaryOp::Bswap, piece) }
    }

    fn word(&mut self, bits: u64) -> Value {
        self.b.iconst(Type::I64, bits as i64)
    }

    fn with_word(&mut self, op: BinaryOp, value: Value, bits: u64) -> Value {
        let bits = self.word(bits);
        self.b.binary(op, value, bits)
    }

    /// Stores the first `count` characters of `word`, at most eight and at least one, and leaves those after them, which exist, as they are.
    pub(super) fn store_some(&mut self, to: Address, word: Value, count: Value) {
        let bits = self.bits_of(count);
        // 64 - bits, as shifts take it.
        let zero = self.word(0);
        let others = self.b.isub(zero, bits);
        let ones = self.word(u64::MAX);
        let mask = self.b.binary(BinaryOp::Lshr, ones, others);
        self.store_masked(to, word, mask);
    }

    /// As [`store_some`](Self::store_some), for fewer than eight characters or none.
    pub(super) fn store_few(&mut self, to: Address, word: Value, count: Value) {
        let bits = self.bits_of(count);
        let mask = self.few_bits(bits);
        self.store_masked(to, word, mask);
    }

    /// A mask of fewer than 64 `bits`, an i64.
    fn few_bits(&mut self, bits: Value) -> Value {
        let one = self.word(1);
        let mask = self.b.binary(BinaryOp::Shl, one, bits);
        self.with_word(BinaryOp::Isub, mask, 1)
    }

    fn bits_of(&mut self, count: Value) -> Value {
        let count = self.b.zext(Type::I64, count);
        self.b.binary_imm(BinaryOp::Shl, count, 3)
    }

    /// Stores the bits of `word` that `mask` has.
    fn store_masked(&mut self, to: Address, word: Value, mask: Value) {
        let old = self.load_word(to);
        let difference = self.b.xor(old, word);
        let difference = self.b.and(difference, mask);
        let new = self.b.xor(old, difference);
        let new = self.b.unary(UnaryOp::Bswap, new);
        self.b.store(to, new);
    }

    /// Position from 1 of the first `sought` among the characters from `start` on, of which the first `starts`, an i32 above 0, may begin it;
    /// 0 if there is none. Whole words exist there. `only`: the word there, if there is just one.
    pub(super) fn find_characters(
        &mut self,
        start: Address,
        starts: Value,
        sought: &[u8],
        only: Option<Value>,
    ) -> Value {
        let at_var = self.b.declare_var(Type::I32);
        let zero = self.b.i32_const(0);
        self.b.def_var(at_var, zero);
        let (look, next, found, end) =
            (self.b.create_block(), self.b.create_block(), self.b.create_block(), self.b.create_block());
        self.b.jump(look, &[]);
        self.b.switch_to(look);
        let at = self.b.use_var(at_var);
        let mut differences = self.word(0);
        for (index, &character) in sought.iter().enumerate() {
            let word = match only {
                Some(word) if index == 0 => word,
                _ => {
                    let addr = self.indexed(moved(start, index as u32), at);
                    self.load_word(addr)
                }
            };
            let difference = self.with_word(BinaryOp::Xor, word, ONES * u64::from(character));
            differences = self.b.or(differences, difference);
        }
        // The lowest bit that is left belongs to the first character that is 0.
        let less = self.with_word(BinaryOp::Isub, differences, ONES);
        let not = self.b.not(differences);
        let zeros = self.b.and(less, not);
        let zeros = self.with_word(BinaryOp::And, zeros, HIGH_BITS);
        let is_there = self.b.icmp_imm(IntCc::Ne, zeros, 0);
        self.b.branch(is_there, found, next);
        self.b.seal_block(found);
        self.b.seal_block(next);
        self.b.switch_to(next);
        let after = self.b.binary_imm(BinaryOp::Iadd, at, WORD.into());
        self.b.def_var(at_var, after);
        let more = match only {
            Some(_) => self.b.bool_const(false),
            None => self.b.icmp(IntCc::Slt, after, starts),
        };
        let position = self.b.declare_var(Type::I32);
        self.b.def_var(position, zero);
        self.b.branch(more, look, end);
        self.b.seal_block(look);
        self.b.switch_to(found);
        let bit = self.b.unary(UnaryOp::Ctz, zeros);
        let place = self.b.binary_imm(BinaryOp::Lshr, bit, 3);
        let place = self.b.trunc(Type::I32, place);
        let place = self.b.iadd(at, place);
        let inside = self.b.icmp(IntCc::Slt, place, starts);
        let from_one = self.b.binary_imm(BinaryOp::Iadd, place, 1);
        let from_one = self.b.select(inside, from_one, zero);
        self.b.def_var(position, from_one);
        self.b.jump(end, &[]);
        self.b.seal_block(end);
        self.b.switch_to(end);
        self.b.use_var(position)
    }

    /// How a text of `length` characters, of which the first eight are in `word` as memory has them, compares with at most eight characters, by
    /// the bits of `relation`: 1 less, 2 equal, 4 greater; an i1.
    pub(super) fn word_relation(&mut self, word: Value, length: Value, with: &[u8], relation: u64) -> Value {
        let mut other = [0; WORD as usize];
        other[..with.len()].copy_from_slice(with);
        // The first character is highest here.
        let other = self.word(u64::from_be_bytes(other));
        // Characters that are not there count as 0; if all are equal, the lengths decide.
        let all = self.word(u64::MAX);
        let count = self.b.zext(Type::I64, length);
        let bits = self.b.binary_imm(BinaryOp::Shl, count, 3);
        let gone = self.b.binary(BinaryOp::Lshr, all, bits);
        let is_whole = self.b.icmp_imm(IntCc::Uge, length, WORD.into());
        let zero = self.word(0);
        let gone = self.b.select(is_whole, zero, gone);
        let there = self.b.not(gone);
        let word = self.b.and(word, there);
        let mut holds = self.b.bool_const(false);
        let ties = self.b.icmp(IntCc::Eq, word, other);
        for (bit, cc) in [(1, IntCc::Ult), (2, IntCc::Eq), (4, IntCc::Ugt)] {
            if relation & bit == 0 {
                continue;
            }
            let by_length = self.b.icmp_imm(cc, length, with.len() as i64);
            let so = self.b.and(ties, by_length);
            holds = self.b.or(holds, so);
            if cc != IntCc::Eq {
                let by_characters = self.b.icmp(cc, word, other);
                holds = self.b.or(holds, by_characters);
            }
        }
        holds
    }

    /// `number`, an i32, in decimal, with a sign if it is negative or `plus`: a word, how many of its characters count (an i32), and an i1:
    /// it has at most seven digits, so that this is right.
    pub(super) fn decimal_word(&mut self, number: Value, plus: bool) -> (Value, Value, Value) {
        /// The largest number of seven digits.
        const LARGEST: i64 = 9_999_999;
        let negative = self.b.icmp_imm(IntCc::Slt, number, 0);
        let zero = self.b.i32_const(0);
        let minus = self.b.isub(zero, number);
        let magnitude = self.b.select(negative, minus, number);
        let fits = self.b.icmp_imm(IntCc::Ule, magnitude, LARGEST);
        let eight = self.b.zext(Type::I64, magnitude);
        // Halves, then pairs, then digits; in each step the first part becomes the lower one. The quotients are by multiplication, exact for numbers
        // of this size. With q for the first part of x, n the bits of a part and d the divisor: x * 2^n - q * (d * 2^n - 1).
        let mut parts = eight;
        for (factor, shift, mask, bits, divisor) in [
            (3_518_437_209u64, 45, u64::MAX, 32, 10_000u64),
            (10_486, 20, 0x0000_007F_0000_007F, 16, 100),
            (103, 10, 0x000F_000F_000F_000F, 8, 10),
        ] {
            let first = self.with_word(BinaryOp::Imul, parts, factor);
            let first = self.b.binary_imm(BinaryOp::Lshr, first, shift);
            let first = self.with_word(BinaryOp::And, first, mask);
            let whole = self.b.binary_imm(BinaryOp::Shl, parts, bits);
            let taken = self.with_word(BinaryOp::Imul, first, (divisor << bits) - 1);
            parts = self.b.isub(whole, taken);
        }
        // Digits that are 0 at the beginning; the last one always counts.
        let digits = self.with_word(BinaryOp::Or, parts, 1 << 56);
        let leading = self.b.unary(UnaryOp::Ctz, digits);
        let leading = self.b.binary_imm(BinaryOp::Lshr, leading, 3);
        let has_sign = if plus { self.b.bool_const(true) } else { negative };
        let signs = self.b.zext(Type::I64, has_sign);
        let dropped = self.b.isub(leading, signs);
        let characters = self.with_word(BinaryOp::Or, parts, ZEROS_AS_TEXT);
        let bits = self.b.binary_imm(BinaryOp::Shl, dropped, 3);
        let characters = self.b.binary(BinaryOp::Lshr, characters, bits);
        // A digit 0 is before the others: it becomes the sign.
        let difference = |sign: u8| u64::from(sign ^ b'0');
        let (minus, other) = (difference(b'-'), if plus { difference(b'+') } else { 0 });
        let (minus, other) = (self.word(minus), self.word(other));
        let sign = self.b.select(negative, minus, other);
        let characters = self.b.xor(characters, sign);
        let all = self.word(WORD.into());
        let count = self.b.isub(all, dropped);
        (characters, self.b.trunc(Type::I32, count), fits)
    }

    /// The number that the first `length` characters of `word`, an i32 of 1 to 8, are: a sign or none, then digits; an i32, and an i1 that
    /// they are so.
    pub(super) fn word_as_number(&mut self, word: Value, length: Value) -> (Value, Value) {
        let first = self.with_word(BinaryOp::And, word, 0xFF);
        let minus = self.b.icmp_imm(IntCc::Eq, first, b'-'.into());
        let plus = self.b.icmp_imm(IntCc::Eq, first, b'+'.into());
        let has_sign = self.b.or(minus, plus);
        let signs = self.b.zext(Type::I64, has_sign);
        let sign_bits = self.b.binary_imm(BinaryOp::Shl, signs, 3);
        let digits = self.b.binary(BinaryOp::Lshr, word, sign_bits);
        let length = self.b.zext(Type::I64, length);
        let count = self.b.isub(length, signs);
        let some = self.b.icmp_imm(IntCc::Ne, count, 0);
        // The last digit comes to the end, before the first one are zeros; the count of a shift is taken modulo 64.
        let digits = self.with_word(BinaryOp::Xor, digits, ZEROS_AS_TEXT);
        let bits = self.b.binary_imm(BinaryOp::Shl, count, 3);
        let zero = self.word(0);
        let unused = self.b.isub(zero, bits);
        let digits = self.b.binary(BinaryOp::Shl, digits, unused);
        // A digit above 9 reaches the high bit by adding 118.
        let above = self.with_word(BinaryOp::Iadd, digits, ONES * 118);
        let wrong = self.b.or(above, digits);
        let wrong = self.with_word(BinaryOp::And, wrong, HIGH_BITS);
        let good = self.b.icmp_imm(IntCc::Eq, wrong, 0);
        let good = self.b.and(good, some);
        // Neighbours become pairs, fours, the number: the first of two by its weight, plus the second.
        let mut sum = digits;
        for (bits, weight, mask) in
            [(8, 10u64, 0x00FF_00FF_00FF_00FF), (16, 100, 0x0000_FFFF_0000_FFFF), (32, 10_000, u64::MAX)]
        {
            let both = self.with_word(BinaryOp::Imul, sum, (weight << bits) + 1);
            let both = self.b.binary_imm(BinaryOp::Lshr, both, bits);
            sum = self.with_word(BinaryOp::And, both, mask);
        }
        let sum = self.b.trunc(Type::I32, sum);
        let zero = self.b.i32_const(0);
        let negative = self.b.isub(zero, sum);
        (self.b.select(minus, negative, sum), good)
    }
}
