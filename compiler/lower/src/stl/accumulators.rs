//! Accumulator instructions. Source: STL reference, accumulator operations.

use plcc_ir::{BinaryOp, Type, UnaryOp, Value, Var};
use plcc_model::Operand;

use crate::block::BlockLowering;

impl BlockLowering<'_, '_> {
    /// Constant of an instruction that has one.
    pub fn constant(operand: &Operand) -> Option<(u32, bool)> {
        match operand {
            Operand::Const { value, wide } => Some((*value, *wide)),
            _ => None,
        }
    }

    pub fn has_four_accumulators(&self) -> bool {
        self.plan.program.profile.accumulators == 4
    }

    /// Exchanges two registers.
    pub fn swap(&mut self, a: Var, b: Var) {
        let (value_a, value_b) = (self.get(a), self.get(b));
        self.set(a, value_b);
        self.set(b, value_a);
    }

    /// Copies accumulators: each `(to, from)` with the previous values, from 0.
    fn move_accumulators(&mut self, moves: &[(usize, usize)]) {
        let values: Vec<Value> = moves.iter().map(|&(_, from)| self.b.use_var(self.regs.accu[from])).collect();
        for (&(to, _), value) in moves.iter().zip(values) {
            self.set(self.regs.accu[to], value);
        }
    }

    /// A value is loaded into ACCU1; the old ACCU1 goes to ACCU2. `L` does this even with 4 accumulators.
    pub fn load_accu1(&mut self, value: Value) {
        let old = self.accu1();
        self.set(self.regs.accu[1], old);
        self.set_accu1(value);
    }

    pub fn push(&mut self) {
        if self.has_four_accumulators() {
            self.move_accumulators(&[(3, 2), (2, 1), (1, 0)]);
        } else {
            self.move_accumulators(&[(1, 0)]);
        }
    }

    pub fn pop(&mut self) {
        if self.has_four_accumulators() {
            self.move_accumulators(&[(0, 1), (1, 2), (2, 3)]);
        } else {
            self.move_accumulators(&[(0, 1)]);
        }
    }

    pub fn enter(&mut self) {
        self.move_accumulators(&[(3, 2), (2, 1)]);
    }

    pub fn leave(&mut self) {
        self.move_accumulators(&[(1, 2), (2, 3)]);
    }

    /// After arithmetic with two operands, 4 accumulators move up: ACCU2 := ACCU3, ACCU3 := ACCU4.
    pub fn shift_down(&mut self) {
        if self.has_four_accumulators() {
            self.leave();
        }
    }

    /// `INC`, `DEC`: in the lowest byte, without carry.
    pub fn add_low_byte(&mut self, operand: &Operand, subtract: bool) {
        let Some((count, _)) = Self::constant(operand) else { return };
        let count = if subtract { -i64::from(count) } else { i64::from(count) };
        let accu1 = self.accu1();
        let sum = self.b.binary_imm(BinaryOp::Iadd, accu1, count);
        let low = self.b.binary_imm(BinaryOp::And, sum, 0xFF);
        let high = self.b.binary_imm(BinaryOp::And, accu1, 0xFFFF_FF00);
        let value = self.b.or(high, low);
        self.set_accu1(value);
    }

    pub fn swap_bytes_word(&mut self) {
        let accu1 = self.accu1();
        let low = self.low_word(accu1);
        let swapped = self.b.unary(UnaryOp::Bswap, low);
        self.set_accu1_low(swapped);
    }

    pub fn swap_bytes_dword(&mut self) {
        let accu1 = self.accu1();
        let swapped = self.b.unary(UnaryOp::Bswap, accu1);
        self.set_accu1(swapped);
    }

    /// `+ 5` acts on ACCU1-L, `+ L#5` on ACCU1.
    pub fn add_constant(&mut self, operand: &Operand) {
        let Some((value, wide)) = Self::constant(operand) else { return };
        let accu1 = self.accu1();
        if wide {
            let sum = self.b.binary_imm(BinaryOp::Iadd, accu1, i64::from(value));
            self.set_accu1(sum);
        } else {
            let low = self.low_word(accu1);
            let sum = self.b.binary_imm(BinaryOp::Iadd, low, i64::from(value));
            debug_assert_eq!(self.b.ty(sum), Type::I16);
            self.set_accu1_low(sum);
        }
    }
}
