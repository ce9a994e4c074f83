//! Jumps. Source: STL reference, logic control instructions.

use plcc_ir::{BinaryOp, IntCc, Value};
use plcc_model::{LabelId, Operand, StatusOperand};

use crate::block::BlockLowering;

/// Conditions of jumps that do not change the status word.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Condition {
    Always,
    Ov,
    Zero,
    NotZero,
    Positive,
    Negative,
    NotNegative,
    NotPositive,
    Unordered,
}

impl BlockLowering<'_, '_> {
    fn label(operand: &Operand) -> LabelId {
        match operand {
            Operand::Label(label) => *label,
            _ => unreachable!("the binder only passes labels"),
        }
    }

    /// Goes to `operand`'s label if `condition`, an i1.
    fn jump_to_label(&mut self, condition: Value, operand: &Operand) {
        let label = Self::label(operand);
        let target = self.label_target(label);
        if self.b.constant_bits(condition) == Some(1) {
            self.b.jump(target.block, &[]);
            self.jump_done(target);
            return;
        }
        self.count_contact(condition);
        let next = self.b.create_block();
        self.b.branch(condition, target.block, next);
        self.jump_done(target);
        self.b.seal_block(next);
        self.b.switch_to(next);
    }

    pub fn jump_if(&mut self, condition: Condition, operand: &Operand) {
        let value = match condition {
            Condition::Always => self.b.bool_const(true),
            Condition::Ov => self.get(self.regs.ov),
            Condition::Zero => self.status(StatusOperand::Eq0),
            Condition::NotZero => self.status(StatusOperand::Ne0),
            Condition::Positive => self.status(StatusOperand::Gt0),
            Condition::Negative => self.status(StatusOperand::Lt0),
            Condition::NotNegative => self.status(StatusOperand::Ge0),
            Condition::NotPositive => self.status(StatusOperand::Le0),
            Condition::Unordered => self.status(StatusOperand::Uo),
        };
        self.jump_to_label(value, operand);
    }

    /// `JC JCN JCB JNB`: both paths begin a new logic string with RLO 1.
    pub fn jump_if_rlo(&mut self, if_set: bool, to_br: bool, operand: &Operand) {
        let rlo = self.rlo();
        if to_br {
            self.set(self.regs.br, rlo);
        }
        self.set_bit(self.regs.rlo, true);
        self.set_bit(self.regs.sta, true);
        self.end_logic_string();
        let condition = if if_set { rlo } else { self.b.not(rlo) };
        self.jump_to_label(condition, operand);
    }

    /// `JBI JNBI`.
    pub fn jump_if_br(&mut self, if_set: bool, operand: &Operand) {
        let br = self.get(self.regs.br);
        self.set_bit(self.regs.sta, true);
        self.end_logic_string();
        let condition = if if_set { br } else { self.b.not(br) };
        self.jump_to_label(condition, operand);
    }

    /// `JOS`: OS is 0 on both paths.
    pub fn jump_if_os(&mut self, operand: &Operand) {
        let os = self.get(self.regs.os);
        self.set_bit(self.regs.os, false);
        self.jump_to_label(os, operand);
    }

    /// `LOOP`: counts in ACCU1-L.
    pub fn loop_jump(&mut self, operand: &Operand) {
        let accu1 = self.accu1();
        let count = self.low_word(accu1);
        let left = self.b.binary_imm(BinaryOp::Isub, count, 1);
        self.set_accu1_low(left);
        let again = self.b.icmp_imm(IntCc::Ne, left, 0);
        self.jump_to_label(again, operand);
    }

    /// `JL` with its list: ACCU1-LL numbers the jump.
    pub fn jump_list(&mut self, targets: &[LabelId], default: LabelId) {
        let accu1 = self.accu1();
        let index = self.b.binary_imm(BinaryOp::And, accu1, 0xFF);
        let edges: Vec<_> = targets.iter().map(|&label| self.label_target(label)).collect();
        let default_edge = self.label_target(default);
        let blocks: Vec<_> = edges.iter().map(|edge| edge.block).collect();
        self.b.switch(index, &blocks, default_edge.block);
        for edge in edges {
            self.jump_done(edge);
        }
        self.jump_done(default_edge);
    }
}
