//! Copies of characters of texts, in blocks, words and pieces that overlap.

use plcc_ir::{Address, BinaryOp, IntCc, Type, UnaryOp, Value, Var};

use super::text_words::WORD;
use crate::block::BlockLowering;

/// Characters that are copied at once where there are as many.
pub(super) const BLOCK: u32 = 16;

/// No text has more characters.
const NEAR: u32 = 0xFF;

/// What is known of characters that are copied, and of the place where they go.
#[derive(Clone, Copy, Default)]
pub(super) struct Copied {
    /// The first eight of them, the first one lowest, and anything after the last one.
    pub word: Option<Value>,
    /// What is after them does not matter where they go.
    pub is_free: bool,
    /// Gets the first eight characters that are there then, if not `None`; as many exist.
    pub first: Option<Var>,
}

impl BlockLowering<'_, '_> {
    /// Copies `count` characters, an i32 of at most `most`. Where the two places share memory, `to` is not after `from`. `room`, an i32: the
    /// characters, part of the text or not, that exist at both places, if there may be a word of them.
    pub(super) fn copy_characters(
        &mut self,
        to: Address,
        from: Address,
        count: Value,
        most: u32,
        room: Option<Value>,
        copied: Copied,
    ) {
        if let Some(count) = self.b.constant_bits(count) {
            // More is only where a constant position is wrong: that code never runs.
            if (1..=u64::from(most)).contains(&count) {
                self.b.copy(to, from, count as u32);
            }
            return self.note_first(to, copied, None);
        }
        if most < BLOCK {
            return self.copy_last(to, from, count, most, room, copied);
        }
        let start = to;
        // Those of whole blocks.
        let whole = self.b.binary_imm(BinaryOp::And, count, i64::from(NEAR & !(BLOCK - 1)));
        self.copy_blocks(to, from, whole, false);
        let count = self.b.binary_imm(BinaryOp::And, count, i64::from(BLOCK - 1));
        let (to, from) = (self.indexed(to, whole), self.indexed(from, whole));
        let room = room.map(|room| self.b.isub(room, whole));
        self.copy_last(to, from, count, BLOCK - 1, room, Copied { word: None, first: None, ..copied });
        self.note_first(start, copied, None);
    }

    /// Copies `count` characters, an i32, a multiple of [`BLOCK`], from the first on. `is_above_zero`: there surely are some.
    fn copy_blocks(&mut self, to: Address, from: Address, count: Value, is_above_zero: bool) {
        let at_var = self.b.declare_var(Type::I32);
        let zero = self.b.i32_const(0);
        self.b.def_var(at_var, zero);
        let (body, rest) = (self.b.create_block(), self.b.create_block());
        if is_above_zero {
            self.b.jump(body, &[]);
        } else {
            let is_long = self.b.icmp_imm(IntCc::Ne, count, 0);
            self.b.branch(is_long, body, rest);
        }
        self.b.switch_to(body);
        let at = self.b.use_var(at_var);
        let (block_to, block_from) = (self.indexed(to, at), self.indexed(from, at));
        self.b.copy(block_to, block_from, BLOCK);
        let next = self.b.binary_imm(BinaryOp::Iadd, at, BLOCK.into());
        self.b.def_var(at_var, next);
        let more = self.b.icmp(IntCc::Ult, next, count);
        self.b.branch(more, body, rest);
        self.b.seal_block(body);
        self.b.seal_block(rest);
        self.b.switch_to(rest);
    }

    /// As [`copy_characters`](Self::copy_characters), where the two places share no memory: the last block may begin before the end of the one
    /// before it.
    pub(super) fn copy_apart(
        &mut self,
        to: Address,
        from: Address,
        count: Value,
        most: u32,
        room: Option<Value>,
        copied: Copied,
    ) {
        if most < BLOCK || self.b.constant_bits(count).is_some() {
            return self.copy_characters(to, from, count, most, room, copied);
        }
        let [long, short, end] = std::array::from_fn(|_| self.b.create_block());
        let is_long = self.b.icmp_imm(IntCc::Uge, count, BLOCK.into());
        self.b.branch(is_long, long, short);
        self.b.seal_block(long);
        self.b.seal_block(short);
        self.b.switch_to(long);
        let last = self.b.binary_imm(BinaryOp::Iadd, count, -i64::from(BLOCK));
        if most <= 2 * BLOCK {
            self.b.copy(to, from, BLOCK);
        } else {
            let before_last = self.b.binary_imm(BinaryOp::Iadd, count, -1);
            let before_last = self.b.binary_imm(BinaryOp::And, before_last, i64::from(NEAR & !(BLOCK - 1)));
            self.copy_blocks(to, from, before_last, true);
        }
        let (last_to, last_from) = (self.indexed(to, last), self.indexed(from, last));
        self.b.copy(last_to, last_from, BLOCK);
        self.note_first(to, copied, copied.word);
        self.b.jump(end, &[]);
        self.b.switch_to(short);
        self.copy_last(to, from, count, BLOCK - 1, room, copied);
        self.b.jump(end, &[]);
        self.b.seal_block(end);
        self.b.switch_to(end);
    }

    /// Copies `count` characters, an i32 of at most `most`, inside a text; `is_back`, an i1: `to` is not after `from`.
    pub(super) fn move_characters(
        &mut self,
        to: Address,
        from: Address,
        count: Value,
        most: u32,
        room: Option<Value>,
        is_back: Value,
    ) {
        let (back, on, end) = (self.b.create_block(), self.b.create_block(), self.b.create_block());
        self.b.branch(is_back, back, on);
        self.b.seal_block(back);
        self.b.seal_block(on);
        self.b.switch_to(back);
        self.copy_characters(to, from, count, most, room, Copied::default());
        self.b.jump(end, &[]);
        self.b.switch_to(on);
        self.copy_from_end(to, from, count, most, room);
        self.b.jump(end, &[]);
        self.b.seal_block(end);
        self.b.switch_to(end);
    }

    /// As [`copy_characters`](Self::copy_characters), where the two places share memory and `to` is after `from`: the last ones first.
    pub(super) fn copy_from_end(&mut self, to: Address, from: Address, count: Value, most: u32, room: Option<Value>) {
        // Fewer than a block, or a known number, are read before they are written.
        if most < BLOCK || self.b.constant_bits(count).is_some() {
            return self.copy_characters(to, from, count, most, room, Copied::default());
        }
        let left = self.b.declare_var(Type::I32);
        self.b.def_var(left, count);
        let (body, rest) = (self.b.create_block(), self.b.create_block());
        let is_long = self.b.icmp_imm(IntCc::Uge, count, BLOCK.into());
        self.b.branch(is_long, body, rest);
        self.b.switch_to(body);
        let before = self.b.use_var(left);
        let after = self.b.binary_imm(BinaryOp::Iadd, before, -i64::from(BLOCK));
        let (block_to, block_from) = (self.indexed(to, after), self.indexed(from, after));
        self.b.copy(block_to, block_from, BLOCK);
        self.b.def_var(left, after);
        let is_long = self.b.icmp_imm(IntCc::Uge, after, BLOCK.into());
        self.b.branch(is_long, body, rest);
        self.b.seal_block(body);
        self.b.seal_block(rest);
        self.b.switch_to(rest);
        let count = self.b.use_var(left);
        self.copy_last(to, from, count, BLOCK - 1, room, Copied::default());
    }

    /// Copies `count` characters, fewer than [`BLOCK`] and at most `most`. Fewer than a word come in a word, if there is room for one: no
    /// branch depends on their number, and a later read of the word does not wait for pieces. Else in two pieces that overlap, both read before
    /// one is written.
    fn copy_last(&mut self, to: Address, from: Address, count: Value, most: u32, room: Option<Value>, copied: Copied) {
        let end = self.b.create_block();
        let zero = self.b.i32_const(0);
        for ty in [Type::I64, Type::I32, Type::I16] {
            let bytes = ty.bytes();
            if ty == Type::I32
                && let Some(room) = room
            {
                let (word, pieces) = (self.b.create_block(), self.b.create_block());
                let has_room = self.b.icmp_imm(IntCc::Sge, room, WORD.into());
                self.b.branch(has_room, word, pieces);
                self.b.seal_block(word);
                self.b.seal_block(pieces);
                self.b.switch_to(word);
                let characters = match copied.word {
                    Some(word) => word,
                    None => self.load_word(from),
                };
                if copied.is_free {
                    self.store_word(to, characters);
                } else {
                    self.store_few(to, characters, count);
                }
                self.note_first(to, copied, Some(characters));
                self.b.jump(end, &[]);
                self.b.switch_to(pieces);
            }
            if most < bytes {
                continue;
            }
            let (two, fewer) = (self.b.create_block(), self.b.create_block());
            let is_enough = self.b.icmp_imm(IntCc::Uge, count, bytes.into());
            self.b.branch(is_enough, two, fewer);
            self.b.seal_block(two);
            self.b.seal_block(fewer);
            self.b.switch_to(two);
            let last = self.b.binary_imm(BinaryOp::Iadd, count, -i64::from(bytes));
            let (last_to, last_from) = (self.indexed(to, last), self.indexed(from, last));
            let (first, second) = match copied.word {
                Some(word) if ty == Type::I64 => (self.piece(ty, word, zero), self.b.load(ty, last_from)),
                Some(word) => (self.piece(ty, word, zero), self.piece(ty, word, last)),
                None => (self.b.load(ty, from), self.b.load(ty, last_from)),
            };
            self.b.store(to, first);
            if ty != Type::I64 || most > WORD {
                self.b.store(last_to, second);
            }
            let known = if ty == Type::I64 { Some(self.b.unary(UnaryOp::Bswap, first)) } else { None };
            self.note_first(to, copied, known);
            self.b.jump(end, &[]);
            self.b.switch_to(fewer);
        }
        let one = self.b.create_block();
        let is_one = self.b.icmp_imm(IntCc::Ne, count, 0);
        self.note_first(to, copied, None);
        self.b.branch(is_one, one, end);
        self.b.seal_block(one);
        self.b.switch_to(one);
        let character = match copied.word {
            Some(word) => self.piece(Type::I8, word, zero),
            None => self.b.load(Type::I8, from),
        };
        self.b.store(to, character);
        self.note_first(to, copied, None);
        self.b.jump(end, &[]);
        self.b.seal_block(end);
        self.b.switch_to(end);
    }

    /// Defines the variable for the first eight characters at `to`.
    fn note_first(&mut self, to: Address, copied: Copied, characters: Option<Value>) {
        if let Some(first) = copied.first {
            let characters = characters.unwrap_or_else(|| self.load_word(to));
            self.b.def_var(first, characters);
        }
    }
}
