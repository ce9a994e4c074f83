//! Texts whose heads are as declared: where they are, how long they are, and which of them share memory.

use plcc_abi::text::ROOM_MAX;
use plcc_abi::{RuntimeFn, Type};
use plcc_ir::{Address, BinaryOp, Block, IntCc, Region, Value};

use super::HEAD_BYTES;
use crate::block::BlockLowering;
use crate::call::text_operand::TextOperand;
use crate::call::text_words::WORD;
use crate::pointer::moved;
use crate::scl::OwnText;

/// Lengths have no other bits.
const ROOM_MAX_BITS: i64 = 0xFF;

/// Where two texts are.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Places {
    /// At one address, with one declared maximum.
    Same,
    /// They share no byte.
    Apart,
    Unknown,
}

/// A text whose head is as declared.
pub(super) struct Text<'t> {
    /// Its first character.
    pub start: Address,
    /// An i32.
    pub length: Value,
    /// The declared maximum, an i32.
    pub maximum: Value,
    /// Neither length nor maximum is more.
    pub most: u32,
    pub characters: Option<&'t [u8]>,
    /// It may be the one that is written; an i1 says whether it is.
    pub is_out: Option<Value>,
    pub own: Option<OwnText>,
}

impl BlockLowering<'_, '_> {
    /// The length that a text has at most.
    pub fn most(&self, text: &TextOperand) -> u32 {
        match &text.characters {
            Some(characters) => characters.len() as u32,
            None if text.declared != 0 => text.longest.unwrap_or(text.declared.into()),
            None => self.b.constant_bits(text.room).map_or(ROOM_MAX, |room| ROOM_MAX.min(room as u32)),
        }
    }

    /// The heads of `operands`, each looked at once.
    pub(super) fn texts_as_declared<'t>(&mut self, operands: &'t [TextOperand], call: Block) -> Vec<Text<'t>> {
        let mut texts: Vec<Text> = Vec::new();
        let is_far = operands.last().is_some_and(|out| matches!(out.addr.region, Region::Any | Region::AnyDb));
        for (index, operand) in operands.iter().enumerate() {
            let start = moved(operand.addr, HEAD_BYTES);
            let same = (0..index).find(|&other| places(&operands[other], operand) == Places::Same);
            let most = self.most(operand);
            let (length, maximum) = match (&operand.characters, same) {
                (Some(_), _) => {
                    let length = self.b.i32_const(most);
                    (length, length)
                }
                (None, Some(other)) => (texts[other].length, texts[other].maximum),
                (None, None) if let Some(own) = operand.own => {
                    let length = self.own_length(own);
                    // It may be out of sight how long the text is, and so how far from its begin what is written.
                    let length = if is_far { self.b.binary_imm(BinaryOp::And, length, ROOM_MAX_BITS) } else { length };
                    (length, self.b.i32_const(operand.declared.into()))
                }
                (None, None) if operand.declared == 0 => {
                    let (ok, length, maximum) = self.head_as_found(operand);
                    self.require(ok, call);
                    (length, maximum)
                }
                (None, None) => {
                    let (ok, length) = self.head_as_declared(operand.addr, operand.declared);
                    self.require(ok, call);
                    (length, self.b.i32_const(operand.declared.into()))
                }
            };
            let characters = operand.characters.as_deref();
            texts.push(Text { start, length, maximum, most, characters, is_out: None, own: operand.own });
        }
        texts
    }

    /// Of a text of which no maximum is declared: whether its head is right and all of it exists, and length and maximum then.
    pub fn head_as_found(&mut self, operand: &TextOperand) -> (Value, Value, Value) {
        let head = self.b.load(Type::I16, operand.addr);
        let head = self.b.zext(Type::I32, head);
        let maximum = self.b.binary_imm(BinaryOp::Lshr, head, 8);
        let length = self.b.binary_imm(BinaryOp::And, head, 0xFF);
        // 0: it has not been set up.
        let before = self.b.binary_imm(BinaryOp::Iadd, maximum, -1);
        let exists = self.b.icmp(IntCc::Ult, before, operand.limit);
        let right = self.b.icmp(IntCc::Ule, length, maximum);
        (self.b.and(right, exists), length, maximum)
    }

    /// Whether the head at `addr` is as declared, and the length then, an i32.
    pub fn head_as_declared(&mut self, addr: Address, declared: u8) -> (Value, Value) {
        let head = self.b.load(Type::I16, addr);
        let head = self.b.zext(Type::I32, head);
        let declared = i64::from(declared);
        let length = self.b.binary_imm(BinaryOp::Iadd, head, -(declared << 8));
        (self.b.icmp_imm(IntCc::Ule, length, declared), length)
    }

    /// Eight characters of the text exist, whatever its length is.
    pub(super) fn require_word(&mut self, text: &Text, call: Block) {
        let exists = self.b.icmp_imm(IntCc::Uge, text.maximum, WORD.into());
        self.require(exists, call);
    }

    /// Of the texts of which the places are not known, none shares memory with the last one. The first may also be that one, where it does not
    /// matter: its characters stay where they are or move to the front.
    pub(super) fn require_apart(
        &mut self,
        function: RuntimeFn,
        operands: &[TextOperand],
        texts: &mut [Text],
        call: Block,
    ) {
        let (Some((out, inputs)), Some((written, read))) = (operands.split_last(), texts.split_last_mut()) else {
            return;
        };
        let may_be_out = !matches!(function, RuntimeFn::TextInsert | RuntimeFn::TextReplace)
            && inputs.iter().all(|text| places(text, out) != Places::Same);
        for (index, (operand, text)) in inputs.iter().zip(read).enumerate() {
            if places(operand, out) != Places::Unknown {
                continue;
            }
            let mut ok = self.are_apart([out.address, operand.address], [written.maximum, text.maximum]);
            if index == 0 && may_be_out {
                let same = self.b.icmp(IntCc::Eq, out.address, operand.address);
                text.is_out = Some(same);
                ok = self.b.or(ok, same);
            }
            self.require(ok, call);
        }
    }

    /// Whether two texts share no byte, an i1: by their addresses and maxima, i32 all.
    pub(super) fn are_apart(&mut self, [one, two]: [Value; 2], maxima: [Value; 2]) -> Value {
        // From `two` to the last byte of the text there, and the same for `one`.
        let [one_last, two_last] =
            maxima.map(|maximum| self.b.binary_imm(BinaryOp::Iadd, maximum, i64::from(HEAD_BYTES) - 1));
        let distance = self.b.isub(one, two);
        let distance = self.b.iadd(distance, one_last);
        let both = self.b.iadd(one_last, two_last);
        self.b.icmp(IntCc::Ugt, distance, both)
    }
}

pub(super) fn places(one: &TextOperand, two: &TextOperand) -> Places {
    if one.is_result != two.is_result {
        return Places::Apart;
    }
    match (&one.characters, &two.characters) {
        // Constants have a place of their own.
        (Some(_), _) | (_, Some(_)) => Places::Apart,
        (None, None) => apart((one.addr, one.declared), (two.addr, two.declared)),
    }
}

/// Where two variables are, by their addresses and declared maxima.
pub(super) fn apart(one: (Address, u8), two: (Address, u8)) -> Places {
    let ((a, a_declared), (b, b_declared)) = (one, two);
    if a == b {
        return if a_declared == b_declared { Places::Same } else { Places::Unknown };
    }
    let is_db = |region: Region| matches!(region, Region::Db(_) | Region::AnyDb);
    let is_plain = |region: Region| is_db(region) || matches!(region, Region::I | Region::Q | Region::M | Region::L);
    let most = |declared: u8| if declared == 0 { ROOM_MAX } else { declared.into() };
    let end = |at: Address, declared: u8| at.offset + HEAD_BYTES + most(declared);
    match () {
        () if !is_plain(a.region) || !is_plain(b.region) => Places::Unknown,
        // The data block of an instance may be any.
        () if a.region != b.region && (a.region == Region::AnyDb || b.region == Region::AnyDb) => {
            if is_db(a.region) && is_db(b.region) { Places::Unknown } else { Places::Apart }
        }
        () if a.region != b.region => Places::Apart,
        () if a.base != b.base => Places::Unknown,
        () if end(a, a_declared) <= b.offset || end(b, b_declared) <= a.offset => Places::Apart,
        () => Places::Unknown,
    }
}
