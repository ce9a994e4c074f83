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
//!
//! `texts`: where texts are and how long they are; `write`: writes results, and copies; here: what the functions do.

mod texts;
mod write;

use plcc_abi::text::{PLUS, Rules};
use plcc_abi::{RuntimeFn, Type};
use plcc_ir::{BinaryOp, Block, IntCc, Value};
use plcc_model::CodeBlock;

use super::text::TextResult;
use super::text_compare::compares_at_once;
use super::text_operand::TextOperand;
use super::text_words::WORD;
use crate::block::BlockLowering;
use texts::{Places, Text, places};
use write::Part;
pub use write::declared_of;

/// Bytes before the characters.
pub(super) const HEAD_BYTES: u32 = 2;
/// Longest constant that is searched.
const SOUGHT_MAX: usize = 4;
/// `kind` of a number as INT and as DINT, see [`RuntimeFn::TextScan`].
const KIND_INT: u64 = 2;

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
                if let Some(own) = out.own.filter(|own| own.is_room) {
                    self.store_word(out.start, word);
                    self.set_own_word(own, word);
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
        let word = text.own.and_then(|own| self.own_word(own));
        let found = self.find_characters(text.start, starts, sought, word.filter(|_| words == 1));
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
        let word = match text.own.and_then(|own| self.own_word(own)) {
            Some(word) => word,
            None => self.load_word(text.start),
        };
        let (value, ok) = self.word_as_number(word, text.length);
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
