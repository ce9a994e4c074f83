//! Shifts and rotates. Source: STL reference, shift and rotate instructions; a count of 0 changes nothing.

use plcc_ir::{BinaryOp, IntCc, Type, Value};
use plcc_model::Operand;

use crate::arithmetic::bits;
use crate::block::BlockLowering;

/// A shift instruction.
#[derive(Clone, Copy)]
pub struct Shift {
    /// 16 or 32.
    width: u32,
    op: BinaryOp,
}

impl Shift {
    pub const SIGNED_WORD: Shift = Shift { width: 16, op: BinaryOp::Ashr };
    pub const SIGNED_DWORD: Shift = Shift { width: 32, op: BinaryOp::Ashr };
    pub const LEFT_WORD: Shift = Shift { width: 16, op: BinaryOp::Shl };
    pub const RIGHT_WORD: Shift = Shift { width: 16, op: BinaryOp::Lshr };
    pub const LEFT_DWORD: Shift = Shift { width: 32, op: BinaryOp::Shl };
    pub const RIGHT_DWORD: Shift = Shift { width: 32, op: BinaryOp::Lshr };
}

impl BlockLowering<'_, '_> {
    /// The count: the literal, or ACCU2-LL. An i32.
    fn shift_count(&mut self, operand: &Operand) -> Value {
        match Self::constant(operand) {
            Some((count, _)) => self.b.i32_const(count),
            None => {
                let accu2 = self.accu2();
                self.b.binary_imm(BinaryOp::And, accu2, 0xFF)
            }
        }
    }

    /// Beyond one more than the width nothing changes, so greater counts are limited to that.
    pub fn shift(&mut self, shift: Shift, operand: &Operand) {
        let count = self.shift_count(operand);
        let most = i64::from(shift.width) + 1;
        let too_far = self.b.icmp_imm(IntCc::Ugt, count, most);
        let limit = self.b.i32_const(most as u32);
        let steps = self.b.select(too_far, limit, count);
        let steps = self.b.zext(Type::I64, steps);
        let accu1 = self.accu1();
        let narrow = if shift.width == 16 { self.low_word(accu1) } else { accu1 };
        let wide =
            if shift.op == BinaryOp::Ashr { self.b.sext(Type::I64, narrow) } else { self.b.zext(Type::I64, narrow) };
        let (shifted, last) = bits::shift(&mut self.b, shift.op, wide, steps, shift.width);
        let result = if shift.width == 16 {
            let low = self.b.trunc(Type::I16, shifted);
            let low = self.b.zext(Type::I32, low);
            let high = self.b.binary_imm(BinaryOp::And, accu1, 0xFFFF_0000);
            self.b.or(high, low)
        } else {
            self.b.trunc(Type::I32, shifted)
        };
        self.set_shifted(count, result, last);
    }

    /// `RLD`, `RRD`.
    pub fn rotate(&mut self, left: bool, operand: &Operand) {
        let count = self.shift_count(operand);
        let accu1 = self.accu1();
        let op = if left { BinaryOp::Rotl } else { BinaryOp::Rotr };
        let (result, last) = bits::rotate(&mut self.b, op, accu1, count);
        self.set_shifted(count, result, last);
    }

    /// Result, CC1 the last bit out, CC0 and OV 0, unless the count is 0.
    fn set_shifted(&mut self, count: Value, result: Value, last: Value) {
        let nothing = self.b.icmp_imm(IntCc::Eq, count, 0);
        // A count of 0 does not change the value anyway.
        self.set_accu1(result);
        let zero = self.b.bool_const(false);
        for (var, new) in [(self.regs.cc1, last), (self.regs.cc0, zero), (self.regs.ov, zero)] {
            let old = self.get(var);
            let value = self.b.select(nothing, old, new);
            self.set(var, value);
        }
    }

    /// `RLDA`, `RRDA`: by 1 through CC1.
    pub fn rotate_through_cc1(&mut self, left: bool) {
        let accu1 = self.accu1();
        let cc1 = self.get(self.regs.cc1);
        let cc1 = self.b.zext(Type::I32, cc1);
        let (out_bit, shift, in_bit) = if left { (31, BinaryOp::Shl, 0) } else { (0, BinaryOp::Lshr, 31) };
        let last = self.b.binary_imm(BinaryOp::Lshr, accu1, out_bit);
        let last = self.b.trunc(Type::I1, last);
        let shifted = self.b.binary_imm(shift, accu1, 1);
        let incoming = self.b.binary_imm(BinaryOp::Shl, cc1, in_bit);
        let result = self.b.or(shifted, incoming);
        self.set_accu1(result);
        self.set(self.regs.cc1, last);
        self.set_bit(self.regs.cc0, false);
        self.set_bit(self.regs.ov, false);
    }
}
