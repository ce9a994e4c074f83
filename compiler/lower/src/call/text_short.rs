//! Functions of texts without a call, where the compiler knows the texts.
//!
//! Nearly all calls find each head as it was declared, positions inside the text, and room for the result. The code of the caller tests that and
//! does such calls itself, with the characters moved in words ([`super::text_words`]); all others go to the runtime, before anything is
//! written, so that what is out of the ordinary has one meaning:
//!
//! ```text
//! #text := DELETE(IN := #text, L := #n, P := 1)     head of #text as declared?  n >= 1?  1 <= length?   no: the runtime
//!                                                   what follows the first n characters moves to the front
//! ```
//!
//! A text of a formal parameter has no declared maximum: then its head says it, and must agree with what exists there. Which texts share memory
//! is known at compile time, one variable that is changed in place or texts apart; or a test finds that they are apart.

use plcc_abi::text::{PLUS, ROOM_MAX, Rules};
use plcc_abi::{RuntimeFn, Type};
use plcc_ir::{Address, BinaryOp, Block, IntCc, Region, UnaryOp, Value};
use plcc_model::CodeBlock;

use super::text::{TextOperand, TextResult};
use super::text_compare::compares_at_once;
use super::text_words::WORD;
use crate::block::BlockLowering;
use crate::pointer::moved;
use crate::scl::OwnText;
use crate::scl::text::TextPlace;

/// Bytes before the characters.
pub(super) const HEAD_BYTES: u32 = 2;
/// Longest constant that is searched.
const SOUGHT_MAX: usize = 4;
/// Lengths have no other bits.
const ROOM_MAX_BITS: i64 = 0xFF;
/// `kind` of a number as INT and as DINT, see [`RuntimeFn::TextScan`].
const KIND_INT: u64 = 2;

/// Where two texts are.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Places {
    /// At one address, with one declared maximum.
    Same,
    /// They share no byte.
    Apart,
    Unknown,
}

/// A text whose head is as declared.
struct Text<'t> {
    /// Its first character.
    start: Address,
    /// An i32.
    length: Value,
    /// The declared maximum, an i32.
    maximum: Value,
    /// Neither length nor maximum is more.
    most: u32,
    characters: Option<&'t [u8]>,
    /// It may be the one that is written; an i1 says whether it is.
    is_out: Option<Value>,
    own: Option<OwnText>,
}

/// Characters that become part of a result.
struct Part<'t> {
    text: &'t Text<'t>,
    /// Characters before it, an i32.
    skipped: Value,
    /// An i32.
    count: Value,
}

/// What a function leaves.
struct Done {
    /// An i32.
    value: Value,
    /// BR, an i1.
    good: Value,
}

impl BlockLowering<'_, '_> {
    /// As [`run_text`](Self::run_text), with a way that needs no call.
    pub fn run_text_shortly(
        &mut self,
        function: RuntimeFn,
        callee: &CodeBlock,
        texts: &[TextOperand],
        values: &[Option<Value>],
    ) -> TextResult {
        if !self.has_short_way(function, texts, values) {
            return self.run_text(function, callee, texts, values);
        }
        let (call, end) = (self.b.create_cold_block(), self.b.create_block());
        let (value, written) = (self.b.declare_var(Type::I32), self.b.declare_var(Type::I1));
        let done = self.run_text_or_leave(function, texts, values, call);
        self.b.def_var(value, done.value);
        self.b.def_var(written, done.written);
        self.b.jump(end, &[]);
        self.b.seal_block(call);
        self.b.switch_to(call);
        let answer = self.run_text(function, callee, texts, values);
        self.b.def_var(value, answer.value);
        self.b.def_var(written, answer.written);
        self.b.jump(end, &[]);
        self.b.seal_block(end);
        self.b.switch_to(end);
        TextResult { value: self.b.use_var(value), written: self.b.use_var(written) }
    }

    /// The way without a call, if [`has_short_way`](Self::has_short_way); what is out of the ordinary goes to `call`. Result and BR are
    /// those of [`run_text`](Self::run_text).
    pub fn run_text_or_leave(
        &mut self,
        function: RuntimeFn,
        texts: &[TextOperand],
        values: &[Option<Value>],
        call: Block,
    ) -> TextResult {
        let numbers: Vec<Value> = values.iter().flatten().copied().collect();
        let done = self.short_way(function, texts, &numbers, call);
        self.set(self.regs.br, done.good);
        TextResult { value: done.value, written: self.b.bool_const(true) }
    }

    /// Whether there is a way without a call for the function and its operands.
    pub fn has_short_way(&self, function: RuntimeFn, texts: &[TextOperand], values: &[Option<Value>]) -> bool {
        // Where the depth of calls is counted, each call may stop the CPU.
        if self.plan.checks_depth || self.scl.by_runtime {
            return false;
        }
        let numbers: Vec<Value> = values.iter().flatten().copied().collect();
        let constant = |number: &Value| self.b.constant_bits(*number);
        let holds_word = |text: &TextOperand| self.most(text) >= WORD && text.characters.is_none();
        match (function, texts) {
            // A text that stays at its place, or that moves to the front.
            (RuntimeFn::TextLeft | RuntimeFn::TextRight | RuntimeFn::TextMid | RuntimeFn::TextDelete, [_, _]) => true,
            // One of the texts may be the one that grows.
            (RuntimeFn::TextConcat | RuntimeFn::TextConcatThree, [inputs @ .., out]) => {
                inputs.iter().filter(|text| places(text, out) == Places::Same).count() <= 1
            }
            // The text may be changed in place.
            (RuntimeFn::TextInsert | RuntimeFn::TextReplace, [_, new, out]) => places(new, out) != Places::Same,
            (RuntimeFn::TextFind, [text, sought]) => {
                holds_word(text)
                    && sought.characters.as_ref().is_some_and(|sought| {
                        (1..=SOUGHT_MAX).contains(&sought.len()) && sought.len() as u32 + WORD <= self.most(text)
                    })
            }
            (RuntimeFn::TextCompare, [one, two]) => {
                numbers.last().and_then(constant).is_some_and(|relation| self.compares_shortly(one, two, relation))
            }
            (RuntimeFn::TextOfDint, [out]) => holds_word(out) && numbers.last().and_then(constant).is_some(),
            (RuntimeFn::TextLength, [text]) => text.characters.is_none() && numbers.last().and_then(constant).is_some(),
            (RuntimeFn::TextScan, [text]) => holds_word(text) && numbers.last().and_then(constant).is_some(),
            (RuntimeFn::TextToDint, [text]) => {
                holds_word(text) && numbers.iter().all(|number| constant(number).is_some())
            }
            _ => false,
        }
    }

    /// What the function does where nothing is out of the ordinary; anything else goes to `call`.
    fn short_way(&mut self, function: RuntimeFn, operands: &[TextOperand], numbers: &[Value], call: Block) -> Done {
        let good = self.b.bool_const(true);
        for (index, operand) in operands.iter().enumerate() {
            if self.reads_constant(function, index, operand, numbers) {
                self.store_bytes(operand.addr, &operand.constant);
            }
        }
        if let (RuntimeFn::TextCompare, [one, two], &[relation]) = (function, operands, numbers) {
            let relation = self.b.constant_bits(relation).expect("the relation is a constant");
            let holds = self.compare_shortly(one, two, relation, call);
            return Done { value: self.b.zext(Type::I32, holds), good };
        }
        let mut texts = self.texts_as_declared(operands, call);
        if writes_text(function) {
            self.require_apart(function, operands, &mut texts, call);
        }
        let zero = self.b.i32_const(0);
        let done = Done { value: zero, good };
        match (function, &texts[..], numbers) {
            (RuntimeFn::TextConcat | RuntimeFn::TextConcatThree, [inputs @ .., out], _) => {
                let parts: Vec<Part> =
                    inputs.iter().map(|text| Part { text, skipped: zero, count: text.length }).collect();
                self.put(&parts, out, call);
            }
            (RuntimeFn::TextLeft, [text, out], &[l, _]) => {
                self.require_at_least(1, l, call);
                let count = self.smaller(l, text.length);
                self.put(&[Part { text, skipped: zero, count }], out, call);
            }
            (RuntimeFn::TextRight, [text, out], &[l, _]) => {
                self.require_at_least(1, l, call);
                let count = self.smaller(l, text.length);
                let skipped = self.less_or_none(text.length, l);
                self.put(&[Part { text, skipped, count }], out, call);
            }
            (RuntimeFn::TextMid, [text, out], &[l, p]) => {
                self.require_at_least(1, l, call);
                let skipped = self.before_position(p, text, call);
                let rest = self.b.isub(text.length, skipped);
                let count = self.smaller(l, rest);
                self.put(&[Part { text, skipped, count }], out, call);
            }
            (RuntimeFn::TextDelete, [text, out], &[l, p, _]) => {
                self.require_at_least(1, l, call);
                let first = self.before_position(p, text, call);
                let rest = self.b.isub(text.length, first);
                let gone = self.smaller(l, rest);
                let skipped = self.b.iadd(first, gone);
                let count = self.less_or_none(rest, l);
                let parts = [Part { text, skipped: zero, count: first }, Part { text, skipped, count }];
                self.put(&parts, out, call);
            }
            (RuntimeFn::TextInsert, [text, new, out], &[p, _]) => {
                let inside = self.b.icmp(IntCc::Ule, p, text.length);
                self.require(inside, call);
                let rest = self.b.isub(text.length, p);
                let parts = [
                    Part { text, skipped: zero, count: p },
                    Part { text: new, skipped: zero, count: new.length },
                    Part { text, skipped: p, count: rest },
                ];
                self.put(&parts, out, call);
            }
            (RuntimeFn::TextReplace, [text, new, out], &[l, p, _]) => {
                self.require_at_least(1, l, call);
                let first = self.before_position(p, text, call);
                let rest = self.b.isub(text.length, first);
                let there = self.b.icmp(IntCc::Ule, l, rest);
                self.require(there, call);
                let (skipped, count) = (self.b.iadd(first, l), self.b.isub(rest, l));
                let parts = [
                    Part { text, skipped: zero, count: first },
                    Part { text: new, skipped: zero, count: new.length },
                    Part { text, skipped, count },
                ];
                self.put(&parts, out, call);
            }
            (RuntimeFn::TextFind, [text, sought], &[rules]) => {
                let sought = sought.characters.expect("only constants are sought");
                return self.find(text, sought, rules, call);
            }
            (RuntimeFn::TextOfDint, [out], &[number, form]) => {
                self.require_word(out, call);
                let plus = self.b.constant_bits(form).is_some_and(|form| form & u64::from(PLUS) != 0);
                let (word, count, fits) = self.decimal_word(number, plus);
                self.require(fits, call);
                if out.own.is_some_and(|own| own.is_room) {
                    let word = self.b.unary(UnaryOp::Bswap, word);
                    self.b.store(out.start, word);
                } else {
                    self.store_some(out.start, word, count);
                }
                self.set_length(out, count);
            }
            (RuntimeFn::TextLength, [text], &[maximum]) => {
                let value = if self.b.constant_bits(maximum) == Some(0) { text.length } else { text.maximum };
                return Done { value, good };
            }
            (RuntimeFn::TextScan, [text], &[kind]) => {
                self.require_word(text, call);
                let is_int = self.b.constant_bits(kind) == Some(KIND_INT);
                // A DINT holds all that a word of characters says.
                let range = is_int.then_some((i16::MIN.into(), i16::MAX.into()));
                return self.number_of(text, WORD, range, call);
            }
            (RuntimeFn::TextToDint, [text], &[longest, low, high]) => {
                self.require_word(text, call);
                let [longest, low, high] =
                    [longest, low, high].map(|number| self.b.constant_bits(number).expect("a constant") as u32 as i32);
                return self.number_of(text, WORD.min(longest as u32), Some((low, high)), call);
            }
            _ => unreachable!("the operands have been looked at"),
        }
        done
    }

    /// Whether the way without a call reads the constant that is an operand in memory: a part of it, or more of it than is compared as numbers.
    fn reads_constant(&self, function: RuntimeFn, index: usize, operand: &TextOperand, numbers: &[Value]) -> bool {
        let Some(characters) = &operand.characters else { return false };
        match function {
            RuntimeFn::TextConcat | RuntimeFn::TextConcatThree | RuntimeFn::TextFind => false,
            RuntimeFn::TextInsert | RuntimeFn::TextReplace => index == 0,
            RuntimeFn::TextCompare => {
                let relation = numbers.first().and_then(|&number| self.b.constant_bits(number));
                !relation.is_some_and(|relation| compares_at_once(characters, relation))
            }
            _ => true,
        }
    }

    /// Copies a text as an assignment does, where heads are as declared and it fits. Then all goes on at the result, and what is lowered next does
    /// the rest. `None`: the compiler does not know enough, nothing is lowered.
    pub fn copy_text_shortly(&mut self, to: TextPlace, from: TextPlace) -> Option<Block> {
        if self.scl.by_runtime || [to, from].iter().any(|text| text.formal.is_none() && declared_of(text) == 0) {
            return None;
        }
        let [to_declared, from_declared] = [to, from].map(|text| declared_of(&text));
        let is_result = |text: TextPlace| text.formal.is_some_and(|formal| formal.is_room());
        let places = match is_result(to) == is_result(from) {
            true => apart((to.addr, to_declared), (from.addr, from_declared)),
            false => Places::Apart,
        };
        if places == Places::Same {
            return None;
        }
        let (call, end) = (self.b.create_cold_block(), self.b.create_block());
        let (length, from_maximum) = self.text_to_copy(from, true, call);
        let (_, to_maximum) = self.text_to_copy(to, false, call);
        let may_meet = from.formal.is_some() || to.formal.is_some();
        if places == Places::Unknown || may_meet && is_result(to) == is_result(from) {
            let addresses = [to.addr, from.addr].map(|addr| self.b.address_of(addr));
            let apart = self.are_apart(addresses, [to_maximum, from_maximum]);
            self.require(apart, call);
        }
        if to_declared == 0 || from_declared == 0 || to_declared < from_declared {
            let fits = self.b.icmp(IntCc::Ule, length, to_maximum);
            self.require(fits, call);
        }
        let most = [to_declared, from_declared].into_iter().filter(|&declared| declared != 0).min();
        let most = most.map_or(ROOM_MAX, u32::from);
        let room = (most >= WORD).then(|| self.smaller(to_maximum, from_maximum));
        self.copy_apart(moved(to.addr, HEAD_BYTES), moved(from.addr, HEAD_BYTES), length, most, room);
        if let Some(own) = self.own_text_at(&to) {
            self.set_own_length(own, length);
            self.b.jump(end, &[]);
            self.b.seal_block(call);
            self.b.switch_to(call);
            return Some(end);
        }
        // As in `set_length`; the maximum in memory stays.
        let most = self.b.load(Type::I8, to.addr);
        let most = self.b.zext(Type::I32, most);
        let most = self.b.binary_imm(BinaryOp::Shl, most, 8);
        let head = self.b.or(most, length);
        let head = self.b.trunc(Type::I16, head);
        self.b.store(to.addr, head);
        self.b.jump(end, &[]);
        self.b.seal_block(call);
        self.b.switch_to(call);
        Some(end)
    }

    /// Length and maximum of a text that is copied; `is_read`: its length counts.
    fn text_to_copy(&mut self, text: TextPlace, is_read: bool, call: Block) -> (Value, Value) {
        let declared = declared_of(&text);
        let maximum = self.b.i32_const(declared.into());
        if let Some(own) = self.own_text_at(&text) {
            return (self.own_length(own), maximum);
        }
        if text.formal.is_some() && declared != 0 {
            let (ok, length) = self.head_as_declared(text.addr, declared);
            self.require(ok, call);
            return (length, maximum);
        }
        if let Some(formal) = text.formal {
            let operand = self.formal_text(text.addr, formal);
            let known = self.texts_are_known(std::slice::from_ref(&operand));
            self.require(known, call);
            let (ok, length, maximum) = self.head_as_found(&operand);
            self.require(ok, call);
            return (length, maximum);
        }
        if !is_read {
            return (maximum, maximum);
        }
        let (ok, length) = self.head_as_declared(text.addr, declared);
        self.require(ok, call);
        (length, maximum)
    }

    /// The length that a text has at most.
    pub(super) fn most(&self, text: &TextOperand) -> u32 {
        match &text.characters {
            Some(characters) => characters.len() as u32,
            None if text.declared != 0 => text.longest.unwrap_or(text.declared.into()),
            None => self.b.constant_bits(text.room).map_or(ROOM_MAX, |room| ROOM_MAX.min(room as u32)),
        }
    }

    /// The heads of `operands`, each looked at once.
    fn texts_as_declared<'t>(&mut self, operands: &'t [TextOperand], call: Block) -> Vec<Text<'t>> {
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
    pub(super) fn head_as_found(&mut self, operand: &TextOperand) -> (Value, Value, Value) {
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

    /// Of the texts of which the places are not known, none shares memory with the last one. The first may also be that one, where it does not
    /// matter: its characters stay where they are or move to the front.
    fn require_apart(&mut self, function: RuntimeFn, operands: &[TextOperand], texts: &mut [Text], call: Block) {
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
    fn are_apart(&mut self, [one, two]: [Value; 2], maxima: [Value; 2]) -> Value {
        // From `two` to the last byte of the text there, and the same for `one`.
        let [one_last, two_last] =
            maxima.map(|maximum| self.b.binary_imm(BinaryOp::Iadd, maximum, i64::from(HEAD_BYTES) - 1));
        let distance = self.b.isub(one, two);
        let distance = self.b.iadd(distance, one_last);
        let both = self.b.iadd(one_last, two_last);
        self.b.icmp(IntCc::Ugt, distance, both)
    }

    /// Eight characters of the text exist, whatever its length is.
    fn require_word(&mut self, text: &Text, call: Block) {
        let exists = self.b.icmp_imm(IntCc::Uge, text.maximum, WORD.into());
        self.require(exists, call);
    }

    /// Whether the head at `addr` is as declared, and the length then, an i32.
    pub(super) fn head_as_declared(&mut self, addr: Address, declared: u8) -> (Value, Value) {
        let head = self.b.load(Type::I16, addr);
        let head = self.b.zext(Type::I32, head);
        let declared = i64::from(declared);
        let length = self.b.binary_imm(BinaryOp::Iadd, head, -(declared << 8));
        (self.b.icmp_imm(IntCc::Ule, length, declared), length)
    }

    /// Goes to `call` unless `cond`.
    pub fn require(&mut self, cond: Value, call: Block) {
        if self.b.constant_bits(cond) == Some(1) {
            return;
        }
        let next = self.b.create_block();
        self.b.branch(cond, next, call);
        self.b.seal_block(next);
        self.b.switch_to(next);
    }

    fn require_at_least(&mut self, least: i64, number: Value, call: Block) {
        let ok = self.b.icmp_imm(IntCc::Sge, number, least);
        self.require(ok, call);
    }

    /// Characters before position `p`, which is inside `text`.
    fn before_position(&mut self, p: Value, text: &Text, call: Block) -> Value {
        let before = self.b.binary_imm(BinaryOp::Iadd, p, -1);
        let inside = self.b.icmp(IntCc::Ult, before, text.length);
        self.require(inside, call);
        before
    }

    /// `number` less `by`, or 0: what the less of both leaves of `number`, and so that ranges say it.
    fn less_or_none(&mut self, number: Value, by: Value) -> Value {
        let zero = self.b.i32_const(0);
        let rest = self.b.isub(number, by);
        let is_none = self.b.icmp_imm(IntCc::Slt, rest, 0);
        self.b.select(is_none, zero, rest)
    }

    fn smaller(&mut self, one: Value, two: Value) -> Value {
        let less = self.b.icmp(IntCc::Slt, one, two);
        self.b.select(less, one, two)
    }

    /// Writes `parts` one after the other to `out`. Of those that are there already, one at most moves: what is before the others it moves
    /// past is at its place, so it goes first.
    fn put(&mut self, parts: &[Part], out: &Text, call: Block) {
        let mut total = self.b.i32_const(0);
        for part in parts {
            total = self.b.iadd(total, part.count);
        }
        // Pieces of a text are together not longer than it; a whole text counts each time.
        let (mut most, mut cut) = (0, Vec::new());
        for part in parts {
            let is_whole = part.count == part.text.length;
            if is_whole || !cut.contains(&part.text.start) {
                most += part.text.most;
            }
            if !is_whole {
                cut.push(part.text.start);
            }
        }
        let is_declared = self.b.constant_bits(out.maximum).is_some();
        if !is_declared || most > out.most {
            let fits = self.b.icmp(IntCc::Ule, total, out.maximum);
            self.require(fits, call);
        }
        let mut written = self.b.i32_const(0);
        let mut moves = Vec::new();
        for part in parts {
            let to = self.indexed(out.start, written);
            let from = self.indexed(part.text.start, part.skipped);
            if to != from {
                moves.push((part, to, from, written));
            }
            written = self.b.iadd(written, part.count);
        }
        let in_place = |part: &Part| part.text.start == out.start;
        let room = |lowering: &mut Self, part: &Part, written: Value| {
            let skipped = lowering.b.constant_bits(part.skipped).unwrap_or(0);
            let may_be = u64::from(part.text.most.min(out.most)) >= skipped + u64::from(WORD);
            // After another part a word would be read of which the beginning has just been written.
            if !may_be || lowering.b.constant_bits(written) != Some(0) {
                return None;
            }
            let read = lowering.b.isub(part.text.maximum, part.skipped);
            Some(lowering.smaller(read, out.maximum))
        };
        for &(part, to, from, written) in moves.iter().filter(|(part, ..)| in_place(part)) {
            // Characters that are kept move on where others come before them, and back where some go; REPLACE may do either.
            let kept_before = parts.iter().find(|other| in_place(other)).map(|first| first.count);
            let nothing_goes = self.b.constant_bits(part.skipped) == Some(0) || kept_before == Some(part.skipped);
            let room = room(self, part, written);
            match (parts.iter().all(in_place), nothing_goes) {
                (true, _) => self.copy_characters(to, from, part.count, out.most, room),
                (false, true) => self.copy_from_end(to, from, part.count, out.most, room),
                (false, false) => {
                    let back = self.b.icmp(IntCc::Ule, written, part.skipped);
                    self.move_characters(to, from, part.count, out.most, room, back);
                }
            }
        }
        for &(part, to, from, written) in moves.iter().filter(|(part, ..)| !in_place(part)) {
            match self.known_characters(part).filter(|characters| characters.len() <= out.most as usize) {
                Some(characters) => self.store_bytes(to, characters),
                None => {
                    let room = room(self, part, written);
                    let end = part.text.is_out.filter(|_| part.text.start == from).map(|is_there| {
                        let (copy, end) = (self.b.create_block(), self.b.create_block());
                        self.b.branch(is_there, end, copy);
                        self.b.seal_block(copy);
                        self.b.switch_to(copy);
                        end
                    });
                    self.copy_apart(to, from, part.count, part.text.most.min(out.most), room);
                    if let Some(end) = end {
                        self.b.jump(end, &[]);
                        self.b.seal_block(end);
                        self.b.switch_to(end);
                    }
                }
            }
        }
        self.set_length(out, total);
    }

    /// The characters of a part that are known here.
    fn known_characters<'t>(&self, part: &Part<'t>) -> Option<&'t [u8]> {
        let constant = |value| self.b.constant_bits(value).and_then(|bits| usize::try_from(bits).ok());
        let (skipped, count) = (constant(part.skipped)?, constant(part.count)?);
        part.text.characters?.get(skipped..skipped.checked_add(count)?)
    }

    /// Writes both bytes of the head, the first as it is: a processor waits when it reads a word of which it has just written a part, and the
    /// next function of the text reads the head.
    fn set_length(&mut self, out: &Text, length: Value) {
        if let Some(own) = out.own {
            return self.set_own_length(own, length);
        }
        let maximum = self.b.binary_imm(BinaryOp::Shl, out.maximum, 8);
        let head = self.b.or(length, maximum);
        let head = self.b.trunc(Type::I16, head);
        self.b.store(Address { offset: out.start.offset - HEAD_BYTES, ..out.start }, head);
    }

    /// FIND.
    fn find(&mut self, text: &Text, sought: &[u8], rules: Value, call: Block) -> Done {
        let count = sought.len() as u32;
        // Words are read as a whole, also the last one.
        let words = (text.most - (count - 1)) / WORD;
        let starts_max = text.most - (count - 1);
        let starts = self.b.binary_imm(BinaryOp::Iadd, text.length, -i64::from(count - 1));
        if self.b.constant_bits(text.maximum).is_none() {
            let end = self.b.binary_imm(BinaryOp::Iadd, text.length, i64::from(WORD - 1));
            let exists = self.b.icmp(IntCc::Ule, end, text.maximum);
            self.require(exists, call);
        } else if starts_max > words * WORD {
            let whole = self.b.icmp_imm(IntCc::Sle, starts, i64::from(words * WORD));
            self.require(whole, call);
        }
        let longer = self.b.icmp_imm(IntCc::Sle, starts, 0);
        let (position, good) = (self.b.declare_var(Type::I32), self.b.declare_var(Type::I1));
        let zero = self.b.i32_const(0);
        let yes = self.b.bool_const(true);
        let is_v5 = self.b.constant_bits(rules).map(|rules| Rules::of(rules as u16)) == Some(Rules::V5);
        let allowed = self.b.bool_const(is_v5);
        let (search, none, end) = (self.b.create_block(), self.b.create_block(), self.b.create_block());
        self.b.branch(longer, none, search);
        self.b.seal_block(none);
        self.b.seal_block(search);
        self.b.switch_to(none);
        self.b.def_var(position, zero);
        self.b.def_var(good, allowed);
        self.b.jump(end, &[]);
        self.b.switch_to(search);
        let found = self.find_characters(text.start, starts, sought);
        self.b.def_var(position, found);
        self.b.def_var(good, yes);
        self.b.jump(end, &[]);
        self.b.seal_block(end);
        self.b.switch_to(end);
        Done { value: self.b.use_var(position), good: self.b.use_var(good) }
    }

    /// The number that `text`, a sign or none and digits, of at most `longest` characters, is; in `range`, if that says more than its length.
    fn number_of(&mut self, text: &Text, longest: u32, range: Option<(i32, i32)>, call: Block) -> Done {
        let before = self.b.binary_imm(BinaryOp::Iadd, text.length, -1);
        let short = self.b.icmp_imm(IntCc::Ult, before, longest.into());
        self.require(short, call);
        let (value, ok) = self.word_as_number(text.start, text.length);
        self.require(ok, call);
        if let Some((low, high)) = range {
            let above = self.b.binary_imm(BinaryOp::Isub, value, low.into());
            let inside = self.b.icmp_imm(IntCc::Ule, above, i64::from(high) - i64::from(low));
            self.require(inside, call);
        }
        Done { value, good: self.b.bool_const(true) }
    }
}

/// True if the last text of the function is its result.
pub(super) fn writes_text(function: RuntimeFn) -> bool {
    !matches!(
        function,
        RuntimeFn::TextFind
            | RuntimeFn::TextCompare
            | RuntimeFn::TextLength
            | RuntimeFn::TextScan
            | RuntimeFn::TextToDint
    )
}

/// The declared maximum of a text that is copied; 0 if it is not known.
pub fn declared_of(text: &TextPlace) -> u8 {
    match text.formal {
        Some(formal) => formal.declared(),
        None => u8::try_from(text.maximum).unwrap_or(0),
    }
}

fn places(one: &TextOperand, two: &TextOperand) -> Places {
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
fn apart(one: (Address, u8), two: (Address, u8)) -> Places {
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
