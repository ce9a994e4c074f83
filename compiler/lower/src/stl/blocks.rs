//! Block instructions: UC, CC, BEC, OPN. Source: STL reference, program control and data block instructions.

use plcc_abi::codes::sync;
use plcc_abi::image::BlockKind;
use plcc_ir::{BinaryOp, IntCc};
use plcc_model::{BlockKey, Call, Number, Operand, StlStatement, StlStatementKind};
use plcc_syntax::stl::StlInsn;

use crate::block::BlockLowering;
use crate::fault::{Check, Substitute};
use crate::plan;

impl BlockLowering<'_, '_> {
    /// Determines how the block reaches its instance. As long as nothing changes AR2 or DI, the instance has one address, whose
    /// extent every caller has checked; otherwise each access uses the current AR2 and DI.
    pub fn prepare_instance(&mut self, statements: &[StlStatement]) {
        if !matches!(self.block.kind, BlockKind::Fb | BlockKind::Sfb)
            || statements.iter().any(|statement| self.moves_instance(statement))
        {
            return;
        }
        let (di, ar2) = (self.get(self.regs.di), self.get(self.regs.ar[1]));
        self.instance = Some(self.instance_address(di, ar2));
    }

    fn moves_instance(&self, statement: &StlStatement) -> bool {
        match &statement.kind {
            StlStatementKind::Instruction { insn, operand } => {
                plan::changes_ar2(*insn, operand)
                    || *insn == StlInsn::SwapDb
                    || matches!(operand, Operand::Db { di: true, .. })
                    || match operand {
                        Operand::Block { kind, number: Number::Known(number) } => {
                            self.plan.changes_ar2(BlockKey { kind: *kind, number: *number })
                        }
                        Operand::Block { .. } => true,
                        _ => false,
                    }
            }
            StlStatementKind::Call(call) => call.instance.is_none() && self.plan.changes_ar2(call.target),
            StlStatementKind::Label(_)
            | StlStatementKind::JumpList { .. }
            | StlStatementKind::Assert(_)
            | StlStatementKind::Sleep(_) => false,
        }
    }

    /// `UC`.
    pub fn raw_call(&mut self, operand: &Operand) {
        let Operand::Block { kind, number } = operand else { return };
        match number {
            Number::Known(number) => {
                let target = BlockKey { kind: *kind, number: *number };
                if matches!(kind, BlockKind::Sfc) {
                    self.call(&Call { target, instance: None, arguments: Vec::new() });
                } else {
                    self.call_as_it_stands(target);
                }
            }
            Number::Word(_) | Number::Parameter(_) => {
                let number = self.number(number);
                self.call_by_number(*kind, number);
            }
        }
        self.after_block();
    }

    /// `CC`: calls if the RLO is 1, and leaves RLO 1 if it was 0.
    pub fn conditional_call(&mut self, operand: &Operand) {
        let rlo = self.rlo();
        self.count_contact(rlo);
        let (called, skipped, next) = (self.b.create_block(), self.b.create_block(), self.b.create_block());
        self.b.branch(rlo, called, skipped);
        self.b.seal_block(called);
        self.b.seal_block(skipped);
        self.b.switch_to(called);
        self.raw_call(operand);
        self.b.jump(next, &[]);
        self.b.switch_to(skipped);
        self.set_bit(self.regs.rlo, true);
        self.set_bit(self.regs.sta, true);
        self.end_logic_string();
        self.b.jump(next, &[]);
        self.b.seal_block(next);
        self.b.switch_to(next);
    }

    /// `BEC`: ends if the RLO is 1, otherwise continues with RLO 1.
    pub fn conditional_end(&mut self) {
        let rlo = self.rlo();
        self.count_contact(rlo);
        self.set_bit(self.regs.rlo, true);
        self.set_bit(self.regs.sta, true);
        self.end_logic_string();
        let (end, next) = (self.b.create_block(), self.b.create_block());
        self.b.branch(rlo, end, next);
        self.b.seal_block(end);
        self.b.seal_block(next);
        self.b.switch_to(end);
        self.return_registers();
        self.b.switch_to(next);
    }

    /// `OPN`: number 0 closes; a DB that is not loaded is an error and does not change the register.
    pub fn open_db(&mut self, operand: &Operand) {
        let Operand::Db { di, number } = operand else { return };
        let register = if *di { self.regs.di } else { self.regs.db };
        let value = self.number(number);
        let is_static = match number {
            Number::Known(known) => *known == 0 || self.plan.static_db(*known).is_some(),
            Number::Word(_) | Number::Parameter(_) => false,
        };
        let ok = if is_static {
            self.b.bool_const(true)
        } else {
            let length = self.b.db_length(value);
            let loaded = self.b.icmp_imm(IntCc::Ne, length, 0);
            let closes = self.b.icmp_imm(IntCc::Eq, value, 0);
            self.b.or(loaded, closes)
        };
        let code = self.b.i32_const(u32::from(sync::DB_MISSING));
        let access = self.b.i32_const(0);
        let guard = self.begin_guard(vec![Check { ok, code, access, info: value, db: None }], Substitute::None);
        self.set(register, value);
        self.end_guard(guard);
    }

    /// Offset of the target of AR2 in DB `di` from the memory base.
    pub fn instance_address(&mut self, di: plcc_ir::Value, ar2: plcc_ir::Value) -> plcc_ir::Value {
        let base = self.b.db_base(di);
        let bits = self.b.binary_imm(BinaryOp::And, ar2, 0x00FF_FFFF);
        let byte = self.b.binary_imm(BinaryOp::Lshr, bits, 3);
        self.b.iadd(base, byte)
    }
}
