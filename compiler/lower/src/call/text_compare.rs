//! How texts compare, without a call where the code of the caller can tell.
//!
//! A text whose head is as declared is valid and exists as a whole. So one comparison of its head, less the declared maximum, says that, and
//! leaves its length:
//!
//! ```text
//! IF #name = 'pump'      length = head - declared maximum * 256
//!                        length > declared maximum: the runtime decides
//!                        equal: length = 4, and the four characters are 'pump', all in one comparison
//! IF #name = #other      lengths that differ say no, else words of eight characters are compared
//! IF #name < #other      the first word that differs says it, or else the lengths
//! ```

use plcc_ir::{Address, BinaryOp, Block, IntCc, Type, UnaryOp, Value};

use super::text_operand::TextOperand;
use super::text_short::HEAD_BYTES;
use super::text_words::WORD;
use crate::block::BlockLowering;
use crate::pointer::moved;

/// Longer constants are compared by the runtime.
const CHARACTERS_MAX: usize = 24;

/// The relation of [`RuntimeFn::TextCompare`](plcc_abi::RuntimeFn::TextCompare) for equal texts.
const EQUAL: u64 = 2;
/// The relation for texts that are not equal.
const DIFFERENT: u64 = 5;

impl BlockLowering<'_, '_> {
    /// Whether the code of the caller can compare two texts.
    pub(super) fn compares_shortly(&self, one: &TextOperand, two: &TextOperand, relation: u64) -> bool {
        let asks_if_equal = matches!(relation, EQUAL | DIFFERENT);
        let holds_word = |text: &TextOperand| self.most(text) >= WORD;
        match (&one.characters, &two.characters) {
            (Some(_), Some(_)) => false,
            (Some(_), None) => asks_if_equal,
            (None, Some(characters)) if characters.len() <= WORD as usize => asks_if_equal || holds_word(one),
            (None, Some(characters)) if characters.len() <= CHARACTERS_MAX && asks_if_equal => true,
            (None, _) => asks_if_equal || holds_word(one) && holds_word(two),
        }
    }

    /// How two texts compare, by the bits of `relation`: 1 less, 2 equal, 4 greater; an i1. What the caller cannot tell goes to `call`.
    pub(super) fn compare_shortly(
        &mut self,
        one: &TextOperand,
        two: &TextOperand,
        relation: u64,
        call: Block,
    ) -> Value {
        let asks_if_equal = matches!(relation, EQUAL | DIFFERENT);
        let constant = match (&one.characters, &two.characters) {
            (None, Some(characters)) => Some((one, characters)),
            (Some(characters), None) => Some((two, characters)),
            _ => None,
        };
        if let Some((text, characters)) = constant.filter(|(_, characters)| characters.len() <= CHARACTERS_MAX) {
            if asks_if_equal {
                let length = self.length_or_leave(text, characters.len(), call);
                let count = self.b.i32_const(characters.len() as u32);
                let mut difference = self.b.xor(length, count);
                if characters.len() <= self.most(text) as usize {
                    difference = self.differences(text, characters, difference);
                }
                let cc = if relation == EQUAL { IntCc::Eq } else { IntCc::Ne };
                return self.b.icmp_imm(cc, difference, 0);
            }
            if characters.len() <= WORD as usize {
                let length = self.length_or_leave(text, WORD as usize, call);
                let word = self.first_word(text);
                return self.word_relation(word, length, characters, relation);
            }
        }
        if self.most(one) >= WORD && self.most(two) >= WORD {
            let lengths = [one, two].map(|text| self.length_or_leave(text, WORD as usize, call));
            return self.compare_words([one, two], lengths, relation);
        }
        // Lengths that differ say no.
        let lengths = [one, two].map(|text| self.length_or_leave(text, 0, call));
        let differ = self.b.icmp(IntCc::Ne, lengths[0], lengths[1]);
        self.require(differ, call);
        self.b.bool_const(relation == DIFFERENT)
    }

    /// Compares texts by their first characters and lengths; eight characters of each exist.
    fn compare_words(&mut self, texts: [&TextOperand; 2], lengths: [Value; 2], relation: u64) -> Value {
        let ([one, two], [length_one, length_two]) = (texts.map(|text| moved(text.addr, HEAD_BYTES)), lengths);
        let asks_if_equal = matches!(relation, EQUAL | DIFFERENT);
        let holds = self.b.declare_var(Type::I1);
        let (first, second) = (self.b.declare_var(Type::I64), self.b.declare_var(Type::I64));
        let at_var = self.b.declare_var(Type::I32);
        let [long, look, next, short, differ, equal, end] = std::array::from_fn(|_| self.b.create_block());
        let common = if asks_if_equal {
            let other_length = self.b.icmp(IntCc::Ne, length_one, length_two);
            let no = self.b.bool_const(relation == DIFFERENT);
            self.b.def_var(holds, no);
            let same_length = self.b.create_block();
            self.b.branch(other_length, end, same_length);
            self.b.seal_block(same_length);
            self.b.switch_to(same_length);
            length_one
        } else {
            let is_less = self.b.icmp(IntCc::Ult, length_one, length_two);
            self.b.select(is_less, length_one, length_two)
        };
        let is_long = self.b.icmp_imm(IntCc::Uge, common, WORD.into());
        self.b.branch(is_long, long, short);
        self.b.seal_block(long);
        self.b.seal_block(short);

        // The last word may begin before the end of the one before it.
        self.b.switch_to(long);
        let last = self.b.binary_imm(BinaryOp::Iadd, common, -i64::from(WORD));
        let zero = self.b.i32_const(0);
        self.b.def_var(at_var, zero);
        self.b.jump(look, &[]);
        self.b.switch_to(look);
        let at = self.b.use_var(at_var);
        let (word_one, word_two) = (self.indexed(one, at), self.indexed(two, at));
        let (word_one, word_two) = (self.b.load(Type::I64, word_one), self.b.load(Type::I64, word_two));
        self.b.def_var(first, word_one);
        self.b.def_var(second, word_two);
        let differs = self.b.icmp(IntCc::Ne, word_one, word_two);
        self.b.branch(differs, differ, next);
        self.b.seal_block(next);
        self.b.switch_to(next);
        let after = self.b.binary_imm(BinaryOp::Iadd, at, WORD.into());
        let is_before = self.b.icmp(IntCc::Slt, after, last);
        let after = self.b.select(is_before, after, last);
        self.b.def_var(at_var, after);
        let more = self.b.icmp(IntCc::Ne, at, last);
        self.b.branch(more, look, equal);
        self.b.seal_block(look);

        // Fewer than eight: the last characters of a word do not count.
        self.b.switch_to(short);
        let bits = self.b.zext(Type::I64, common);
        let bits = self.b.binary_imm(BinaryOp::Shl, bits, 3);
        let most = self.b.iconst(Type::I64, i64::from(WORD - 1) * 8);
        let gone = self.b.isub(most, bits);
        let [word_one, word_two] = texts.map(|text| {
            let word = self.first_word(text);
            let word = self.b.binary_imm(BinaryOp::Lshr, word, 8);
            self.b.binary(BinaryOp::Lshr, word, gone)
        });
        self.b.def_var(first, word_one);
        self.b.def_var(second, word_two);
        let differs = self.b.icmp(IntCc::Ne, word_one, word_two);
        self.b.branch(differs, differ, equal);
        self.b.seal_block(differ);
        self.b.seal_block(equal);

        self.b.switch_to(differ);
        let (word_one, word_two) = (self.b.use_var(first), self.b.use_var(second));
        let so = self.relation_of([word_one, word_two], relation & DIFFERENT);
        self.b.def_var(holds, so);
        self.b.jump(end, &[]);
        self.b.switch_to(equal);
        let so = if asks_if_equal {
            self.b.bool_const(relation == EQUAL)
        } else {
            self.relation_of([length_one, length_two], relation)
        };
        self.b.def_var(holds, so);
        self.b.jump(end, &[]);
        self.b.seal_block(end);
        self.b.switch_to(end);
        self.b.use_var(holds)
    }

    /// How two numbers compare, by the bits of `relation`, an i1.
    fn relation_of(&mut self, [one, two]: [Value; 2], relation: u64) -> Value {
        let cc = match relation {
            1 => IntCc::Ult,
            2 => IntCc::Eq,
            3 => IntCc::Ule,
            4 => IntCc::Ugt,
            5 => IntCc::Ne,
            6 => IntCc::Uge,
            _ => return self.b.bool_const(relation & 7 == 7),
        };
        self.b.icmp(cc, one, two)
    }

    /// The length of a text whose head is as declared; others go to `call`.
    fn length_or_leave(&mut self, text: &TextOperand, compared: usize, call: Block) -> Value {
        let (ok, length) = self.length_if_right(text, compared);
        self.require(ok, call);
        length
    }

    /// Whether a text is as declared, and its length then, an i32. Where no maximum is declared, `compared` characters must exist.
    fn length_if_right(&mut self, text: &TextOperand, compared: usize) -> (Value, Value) {
        if let Some(characters) = &text.characters {
            let length = self.b.i32_const(characters.len() as u32);
            return (self.b.bool_const(true), length);
        }
        if let Some(own) = text.own {
            return (self.b.bool_const(true), self.own_length(own));
        }
        if text.declared == 0 {
            let (right, length, maximum) = self.head_as_found(text);
            let exist = self.b.icmp_imm(IntCc::Uge, maximum, compared as i64);
            return (self.b.and(right, exist), length);
        }
        self.head_as_declared(text.addr, text.declared)
    }

    /// The first eight characters of a text that has room for them, as memory has them.
    fn first_word(&mut self, text: &TextOperand) -> Value {
        match text.own.and_then(|own| self.own_word(own)) {
            Some(word) => self.b.unary(UnaryOp::Bswap, word),
            None => self.b.load(Type::I64, moved(text.addr, HEAD_BYTES)),
        }
    }

    /// Adds to `difference` the bits in which a text differs from constant characters, an i32 or i64.
    fn differences(&mut self, text: &TextOperand, characters: &[u8], difference: Value) -> Value {
        if (1..=WORD as usize).contains(&characters.len())
            && let Some(word) = text.own.and_then(|own| self.own_word(own))
        {
            let constant = self.constant_word(characters);
            let word = self.b.xor(word, constant);
            // The others come to the end and go.
            let others = 64 - 8 * characters.len() as i64;
            let word = if others == 0 { word } else { self.b.binary_imm(BinaryOp::Shl, word, others) };
            let difference = self.b.zext(Type::I64, difference);
            return self.b.or(difference, word);
        }
        let addr = text.addr;
        let (ty, bytes) = match characters.len() {
            0 => return difference,
            1 => (Type::I8, 1),
            2..4 => (Type::I16, 2),
            4..8 => (Type::I32, 4),
            _ => (Type::I64, 8),
        };
        let sum = if bytes == 8 { Type::I64 } else { Type::I32 };
        let mut all = self.b.zext(sum, difference);
        let mut at = 0;
        while at < characters.len() {
            // The last word may begin before the end of the one before it.
            let from = at.min(characters.len() - bytes);
            let constant =
                characters[from..from + bytes].iter().fold(0, |bits: u64, &byte| bits << 8 | u64::from(byte));
            let word = self.b.load(ty, Address { offset: addr.offset + 2 + from as u32, ..addr });
            let word = self.b.binary_imm(BinaryOp::Xor, word, constant as i64);
            let word = self.b.zext(sum, word);
            all = self.b.or(all, word);
            at += bytes;
        }
        all
    }
}

/// Whether constant characters are compared with others as numbers in the code.
pub(super) fn compares_at_once(characters: &[u8], relation: u64) -> bool {
    let asks_if_equal = matches!(relation, EQUAL | DIFFERENT);
    characters.len() <= if asks_if_equal { CHARACTERS_MAX } else { WORD as usize }
}
