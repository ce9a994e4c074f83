//! Statements of STL.
//!
//! [`lower_block`] walks the statements; `lower_instruction` is the one match over the instruction table. The module of
//! a family contains the meaning of its instructions. Source of each: STL reference for S7-300/400, the chapter of
//! the family, and the decisions in docs/decisions.

mod accumulators;
mod arithmetic;
mod assert;
mod bit_logic;
mod blocks;
mod cells;
mod compare;
mod convert;
mod jumps;
mod mcr;
mod shift;
mod timers;
mod transfer;

pub use cells::CellRead;

use plcc_ir::{BinaryOp, Function};
use plcc_model::{CellKind, CodeBlock, LabelId, Operand, StlStatement, StlStatementKind};
use plcc_syntax::stl::StlInsn;
use rustc_hash::FxHashMap;

use crate::Output;
use crate::block::BlockLowering;
use crate::plan::Plan;

use self::bit_logic::Combine;
use self::jumps::Condition;

/// Lowers a block to a function.
pub fn lower_block<'p>(
    plan: &'p Plan<'p>,
    output: &mut Output<'p>,
    block: &'p CodeBlock,
    statements: &[StlStatement],
) -> Function {
    let mut lowering = BlockLowering::new(plan, output, block);
    lowering.uses_mcr = statements.iter().any(uses_mcr);
    lowering.prepare_instance(statements);
    for (label, jumps) in count_jumps(statements) {
        lowering.declare_label(label, jumps);
    }
    lowering.probe_enter();
    for statement in statements {
        lowering.stl_statement(statement);
    }
    lowering.finish()
}

/// The statement begins the work of the Master Control Relay.
pub fn uses_mcr(statement: &StlStatement) -> bool {
    matches!(statement.kind, StlStatementKind::Instruction { insn: StlInsn::McrActivate | StlInsn::McrOpen, .. })
}

/// Jumps to each label that has any, in order of the first jumps.
fn count_jumps(statements: &[StlStatement]) -> Vec<(LabelId, u32)> {
    let mut order = Vec::new();
    let mut counts: FxHashMap<LabelId, u32> = FxHashMap::default();
    for statement in statements {
        for label in jumps_of(statement) {
            *counts.entry(label).or_insert_with(|| {
                order.push(label);
                0
            }) += 1;
        }
    }
    order.into_iter().map(|label| (label, counts[&label])).collect()
}

/// Labels that `statement` jumps to.
pub fn jumps_of(statement: &StlStatement) -> Vec<LabelId> {
    match &statement.kind {
        StlStatementKind::Instruction { operand: Operand::Label(label), .. } => vec![*label],
        StlStatementKind::JumpList { targets, default } => targets.iter().chain([default]).copied().collect(),
        StlStatementKind::Instruction { .. }
        | StlStatementKind::Label(_)
        | StlStatementKind::Call(_)
        | StlStatementKind::Assert(_)
        | StlStatementKind::Sleep(_) => Vec::new(),
    }
}

impl BlockLowering<'_, '_> {
    /// A statement of a block, or of a network in STL between networks of other languages.
    pub fn stl_statement(&mut self, statement: &StlStatement) {
        self.set_statement(statement);
        self.probed_statement(statement, |lowering| lowering.lower_statement(statement));
    }

    fn lower_statement(&mut self, statement: &StlStatement) {
        if let StlStatementKind::Label(label) = &statement.kind {
            self.place_label(*label);
            return;
        }
        if !self.b.is_reachable() {
            self.skip_statement(statement);
            return;
        }
        match &statement.kind {
            StlStatementKind::Label(_) => {}
            StlStatementKind::Instruction { insn, operand } => self.lower_instruction(*insn, operand),
            StlStatementKind::JumpList { targets, default } => self.jump_list(targets, *default),
            StlStatementKind::Call(call) => self.call(call),
            StlStatementKind::Assert(assert) => self.assert(assert, statement.span),
            StlStatementKind::Sleep(ms) => self.sleep(*ms),
        }
    }

    /// An unreachable statement has no code, but its parentheses, jumps and assertions count.
    fn skip_statement(&mut self, statement: &StlStatement) {
        for label in jumps_of(statement) {
            self.jump_skipped(label);
        }
        match &statement.kind {
            StlStatementKind::Instruction { insn, .. } => self.skip_nesting(*insn),
            StlStatementKind::Assert(assert) => {
                self.output.register_assert(assert, statement.span);
            }
            StlStatementKind::Label(_)
            | StlStatementKind::JumpList { .. }
            | StlStatementKind::Call(_)
            | StlStatementKind::Sleep(_) => {}
        }
    }

    /// The meaning of every row of the instruction table.
    fn lower_instruction(&mut self, insn: StlInsn, operand: &Operand) {
        use StlInsn as I;
        match insn {
            I::And => self.combine(Combine::And, false, operand),
            I::AndNot => self.combine(Combine::And, true, operand),
            I::Or if *operand == Operand::None => self.or_of_ands(),
            I::Or => self.combine(Combine::Or, false, operand),
            I::OrNot => self.combine(Combine::Or, true, operand),
            I::Xor => self.combine(Combine::Xor, false, operand),
            I::XorNot => self.combine(Combine::Xor, true, operand),
            I::AndNest | I::AndNotNest | I::OrNest | I::OrNotNest | I::XorNest | I::XorNotNest => {
                self.open_nesting(insn)
            }
            I::CloseNest => self.close_nesting(),
            I::Assign => self.assign(operand),
            I::Set => match operand {
                Operand::Cell { kind: CellKind::Counter, number } => self.counter_set(number),
                _ => self.set_or_reset(operand, true),
            },
            I::Reset => match operand {
                Operand::Cell { kind, number } => self.cell_reset(*kind, number),
                _ => self.set_or_reset(operand, false),
            },
            I::Not => self.not(),
            I::SetRlo => self.set_rlo(true),
            I::ClearRlo => self.set_rlo(false),
            I::Save => self.save(),
            I::EdgePositive => self.edge(operand, true),
            I::EdgeNegative => self.edge(operand, false),

            I::Load => self.load(operand),
            I::LoadBcd => self.load_bcd(operand),
            I::Transfer => self.transfer(operand),
            I::LoadAr1 => self.load_address_register(0, operand),
            I::LoadAr2 => self.load_address_register(1, operand),
            I::TransferAr1 => self.transfer_address_register(0, operand),
            I::TransferAr2 => self.transfer_address_register(1, operand),
            I::SwapAr => self.swap(self.regs.ar[0], self.regs.ar[1]),
            I::AddAr1 => self.add_address_register(0, operand),
            I::AddAr2 => self.add_address_register(1, operand),

            I::SwapAccu => self.swap(self.regs.accu[0], self.regs.accu[1]),
            I::Push => self.push(),
            I::Pop => self.pop(),
            I::Enter => self.enter(),
            I::Leave => self.leave(),
            I::Increment => self.add_low_byte(operand, false),
            I::Decrement => self.add_low_byte(operand, true),
            I::SwapBytesWord => self.swap_bytes_word(),
            I::SwapBytesDword => self.swap_bytes_dword(),
            I::Display | I::Nop => {}
            I::AddConst => self.add_constant(operand),

            I::AddI => self.add_sub_int(BinaryOp::Iadd),
            I::SubI => self.add_sub_int(BinaryOp::Isub),
            I::MulI => self.mul_int(),
            I::DivI => self.div_int(),
            I::AddD => self.add_sub_dint(BinaryOp::Iadd),
            I::SubD => self.add_sub_dint(BinaryOp::Isub),
            I::MulD => self.mul_dint(),
            I::DivD => self.div_dint(),
            I::ModD => self.mod_dint(),
            I::AddR => self.real_binary(BinaryOp::Fadd),
            I::SubR => self.real_binary(BinaryOp::Fsub),
            I::MulR => self.real_binary(BinaryOp::Fmul),
            I::DivR => self.real_binary(BinaryOp::Fdiv),
            I::AbsR => self.real_sign(true),
            I::NegR => self.real_sign(false),
            I::SqrR => self.square(),
            I::SqrtR => self.square_root(),
            I::ExpR => self.real_function(plcc_abi::RuntimeFn::Exp),
            I::LnR => self.real_function(plcc_abi::RuntimeFn::Ln),
            I::SinR => self.real_function(plcc_abi::RuntimeFn::Sin),
            I::CosR => self.real_function(plcc_abi::RuntimeFn::Cos),
            I::TanR => self.real_function(plcc_abi::RuntimeFn::Tan),
            I::AsinR => self.real_function(plcc_abi::RuntimeFn::Asin),
            I::AcosR => self.real_function(plcc_abi::RuntimeFn::Acos),
            I::AtanR => self.real_function(plcc_abi::RuntimeFn::Atan),

            I::CompareEqI => self.compare_int(plcc_ir::IntCc::Eq),
            I::CompareNeI => self.compare_int(plcc_ir::IntCc::Ne),
            I::CompareGtI => self.compare_int(plcc_ir::IntCc::Sgt),
            I::CompareLtI => self.compare_int(plcc_ir::IntCc::Slt),
            I::CompareGeI => self.compare_int(plcc_ir::IntCc::Sge),
            I::CompareLeI => self.compare_int(plcc_ir::IntCc::Sle),
            I::CompareEqD => self.compare_dint(plcc_ir::IntCc::Eq),
            I::CompareNeD => self.compare_dint(plcc_ir::IntCc::Ne),
            I::CompareGtD => self.compare_dint(plcc_ir::IntCc::Sgt),
            I::CompareLtD => self.compare_dint(plcc_ir::IntCc::Slt),
            I::CompareGeD => self.compare_dint(plcc_ir::IntCc::Sge),
            I::CompareLeD => self.compare_dint(plcc_ir::IntCc::Sle),
            I::CompareEqR => self.compare_real(plcc_ir::FloatCc::Eq),
            I::CompareNeR => self.compare_real(plcc_ir::FloatCc::Ne),
            I::CompareGtR => self.compare_real(plcc_ir::FloatCc::Gt),
            I::CompareLtR => self.compare_real(plcc_ir::FloatCc::Lt),
            I::CompareGeR => self.compare_real(plcc_ir::FloatCc::Ge),
            I::CompareLeR => self.compare_real(plcc_ir::FloatCc::Le),

            I::BcdToI => self.bcd_to_int(false),
            I::BcdToD => self.bcd_to_int(true),
            I::IToBcd => self.int_to_bcd(false),
            I::DToBcd => self.int_to_bcd(true),
            I::IToD => self.int_to_dint(),
            I::DToR => self.dint_to_real(),
            I::InvertI => self.invert_int(),
            I::InvertD => self.invert_dint(),
            I::NegI => self.negate_int(),
            I::NegD => self.negate_dint(),
            I::Round => self.real_to_dint(plcc_ir::UnaryOp::Fnearest),
            I::RoundUp => self.real_to_dint(plcc_ir::UnaryOp::Fceil),
            I::RoundDown => self.real_to_dint(plcc_ir::UnaryOp::Ffloor),
            I::Truncate => self.real_to_dint(plcc_ir::UnaryOp::Ftrunc),

            I::AndW => self.word_logic(BinaryOp::And, operand),
            I::OrW => self.word_logic(BinaryOp::Or, operand),
            I::XorW => self.word_logic(BinaryOp::Xor, operand),
            I::AndD => self.dword_logic(BinaryOp::And, operand),
            I::OrD => self.dword_logic(BinaryOp::Or, operand),
            I::XorD => self.dword_logic(BinaryOp::Xor, operand),

            I::ShiftSignedI => self.shift(shift::Shift::SIGNED_WORD, operand),
            I::ShiftSignedD => self.shift(shift::Shift::SIGNED_DWORD, operand),
            I::ShiftLeftW => self.shift(shift::Shift::LEFT_WORD, operand),
            I::ShiftRightW => self.shift(shift::Shift::RIGHT_WORD, operand),
            I::ShiftLeftD => self.shift(shift::Shift::LEFT_DWORD, operand),
            I::ShiftRightD => self.shift(shift::Shift::RIGHT_DWORD, operand),
            I::RotateLeftD => self.rotate(true, operand),
            I::RotateRightD => self.rotate(false, operand),
            I::RotateLeftCc1 => self.rotate_through_cc1(true),
            I::RotateRightCc1 => self.rotate_through_cc1(false),

            I::TimerPulse | I::TimerExtendedPulse | I::TimerOnDelay | I::TimerRetentiveOnDelay | I::TimerOffDelay => {
                self.timer_start(insn, operand)
            }
            I::Enable => self.cell_enable(operand),
            I::CountUp => self.count(operand, true),
            I::CountDown => self.count(operand, false),

            I::Jump => self.jump_if(Condition::Always, operand),
            I::JumpIf => self.jump_if_rlo(true, false, operand),
            I::JumpIfNot => self.jump_if_rlo(false, false, operand),
            I::JumpIfBr => self.jump_if_rlo(true, true, operand),
            I::JumpIfNotBr => self.jump_if_rlo(false, true, operand),
            I::JumpBr => self.jump_if_br(true, operand),
            I::JumpNotBr => self.jump_if_br(false, operand),
            I::JumpOv => self.jump_if(Condition::Ov, operand),
            I::JumpOs => self.jump_if_os(operand),
            I::JumpZero => self.jump_if(Condition::Zero, operand),
            I::JumpNotZero => self.jump_if(Condition::NotZero, operand),
            I::JumpPositive => self.jump_if(Condition::Positive, operand),
            I::JumpNegative => self.jump_if(Condition::Negative, operand),
            I::JumpNotNegative => self.jump_if(Condition::NotNegative, operand),
            I::JumpNotPositive => self.jump_if(Condition::NotPositive, operand),
            I::JumpUnordered => self.jump_if(Condition::Unordered, operand),
            // Bound to `StlStatementKind::JumpList`.
            I::JumpList => {}
            I::Loop => self.loop_jump(operand),

            I::CallUnconditional => self.raw_call(operand),
            I::CallConditional => self.conditional_call(operand),
            I::BlockEnd | I::BlockEndUnconditional => self.return_registers(),
            I::BlockEndConditional => self.conditional_end(),
            I::OpenDb => self.open_db(operand),
            I::SwapDb => self.swap(self.regs.db, self.regs.di),

            I::McrActivate => self.mcr_activate(true),
            I::McrDeactivate => self.mcr_activate(false),
            I::McrOpen => self.mcr_open(),
            I::McrClose => self.mcr_close(),
        }
    }
}
