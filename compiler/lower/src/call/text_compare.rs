//! Whether texts are equal, without a call where the code of the caller can tell.
//!
//! A text whose head is as declared is valid and exists as a whole. So one comparison of its head, less the declared maximum, says that, and
//! leaves its length:
//!
//! ```text
//! IF #name = 'pump'      length = head - declared maximum * 256
//!                        length > declared maximum: the runtime decides
//!                        equal: length = 4, and the four characters are 'pump', all in one comparison
//! IF #name = #other      lengths that differ say no, else the runtime decides
//! ```

use plcc_abi::RuntimeFn;
use plcc_ir::{Address, BinaryOp, IntCc, Type, Value};
use plcc_model::CodeBlock;

use super::text::TextOperand;
use crate::block::BlockLowering;

/// Longer constants are compared by the runtime.
const CHARACTERS_MAX: usize = 24;

/// The relation of [`RuntimeFn::TextCompare`] for equal texts.
const EQUAL: u64 = 2;
/// The relation for texts that are not equal.
const DIFFERENT: u64 = 5;

impl BlockLowering<'_, '_> {
    /// As [`run_text`](Self::run_text), with a way that needs no call if `function` asks whether two texts are equal.
    pub fn run_text_or_compare(
        &mut self,
        function: RuntimeFn,
        callee: &CodeBlock,
        texts: &[TextOperand],
        values: &[Option<Value>],
    ) -> Value {
        let relation = match (function, values) {
            (RuntimeFn::TextCompare, [.., Some(relation)]) => self.b.constant_bits(*relation),
            _ => None,
        };
        let ([one, two], Some(relation @ (EQUAL | DIFFERENT))) = (texts, relation) else {
            return self.run_text_shortly(function, callee, texts, values);
        };
        // Where the depth of calls is counted, each call may stop the CPU.
        if self.plan.checks_depth {
            return self.run_text(function, callee, texts, values);
        }
        let constant = match (&one.characters, &two.characters) {
            (None, Some(characters)) => Some((one, characters)),
            (Some(characters), None) => Some((two, characters)),
            _ => None,
        };
        let compared = constant.map_or(0, |(_, characters)| characters.len());
        let (ok_one, length_one) = self.length_if_right(one, compared);
        let (ok_two, length_two) = self.length_if_right(two, compared);
        let ok = self.b.and(ok_one, ok_two);
        let mut difference = self.b.xor(length_one, length_two);
        // What else it takes to know the result here.
        let mut is_decided = ok;
        let result = self.b.declare_var(Type::I64);
        let (decided, call, end) = match constant {
            Some((text, characters)) if characters.len() <= CHARACTERS_MAX => {
                if characters.len() <= self.most(text) as usize {
                    difference = self.differences(text.addr, characters, difference);
                }
                (self.b.create_block(), self.b.create_cold_block(), self.b.create_block())
            }
            _ => {
                let differ = self.b.icmp_imm(IntCc::Ne, difference, 0);
                is_decided = self.b.and(ok, differ);
                (self.b.create_block(), self.b.create_block(), self.b.create_block())
            }
        };
        let cc = if relation == EQUAL { IntCc::Eq } else { IntCc::Ne };
        let holds = self.b.icmp_imm(cc, difference, 0);
        let holds = self.b.zext(Type::I64, holds);
        self.b.branch(is_decided, decided, call);
        self.b.seal_block(decided);
        self.b.seal_block(call);
        self.b.switch_to(decided);
        self.b.def_var(result, holds);
        let good = self.b.bool_const(true);
        self.set(self.regs.br, good);
        self.b.jump(end, &[]);
        self.b.switch_to(call);
        let answer = self.run_text(function, callee, texts, values);
        self.b.def_var(result, answer);
        self.b.jump(end, &[]);
        self.b.seal_block(end);
        self.b.switch_to(end);
        self.b.use_var(result)
    }

    /// Whether a text is as declared, and its length then, an i32. Where no maximum is declared, `compared` characters must exist.
    fn length_if_right(&mut self, text: &TextOperand, compared: usize) -> (Value, Value) {
        if let Some(characters) = &text.characters {
            let length = self.b.i32_const(characters.len() as u32);
            return (self.b.bool_const(true), length);
        }
        if text.declared == 0 {
            let (right, length, maximum) = self.head_as_found(text);
            let exist = self.b.icmp_imm(IntCc::Uge, maximum, compared as i64);
            return (self.b.and(right, exist), length);
        }
        self.head_as_declared(text.addr, text.declared)
    }

    /// Adds to `difference` the bits in which the text at `addr` differs from constant characters, an i32 or i64.
    fn differences(&mut self, addr: Address, characters: &[u8], difference: Value) -> Value {
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
