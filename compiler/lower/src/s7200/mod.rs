//! Lowers blocks of an S7-200. Source: S7-200 system manual, instruction set.
//!
//! - `plan`: numbers of functions and edge memories, string constants, whether calls must be counted.
//! - `block`: one block while it is lowered: logic stack and ENO as SSA variables, boxes, errors, labels.
//! - `operand`: operands to memory accesses; `pointer`: the operand after `*`.
//! - One file per family of instructions; `operations` are those that the runtime performs.

mod assert;
mod bits;
mod block;
mod cells;
mod compare;
mod control;
mod convert;
mod logic;
mod math;
mod moves;
mod operand;
mod operations;
mod plan;
mod pointer;
mod probe;
mod sequence;
mod shift;
mod tables;

use plcc_abi::image::{BlockEntry, BlockKind, DbEntry, Kept};
use plcc_abi::s7200::image::{CpuRow, S7200Image};
use plcc_diag::SourceMap;
use plcc_ir::{BinaryOp, FuncId, Function};
use plcc_model::Program;
use plcc_model::s7200::{self as model, Insn, StatementKind};
use plcc_model::{Body, CodeBlock};

use self::block::S7200Lowering;
use self::plan::S7200Plan;
use crate::probe::Probes;
use crate::{Facts, Lowered, Output};

/// Lowers a program for the S7-200 that was bound without errors.
pub(crate) fn lower(
    program: &Program,
    cpu: CpuRow,
    sources: &SourceMap,
    probes: Probes,
    take: &mut dyn FnMut(Function),
) -> Lowered {
    let mut plan = S7200Plan::new(program);
    let facts =
        Facts { dbs: plan.dbs.clone(), db_end: plan.db_end, error_slots: Vec::new(), stops_itself: plan.stops_itself };
    let mut output = Output::new(program, sources, facts, probes, take);
    if let Some(db) = plan.dbs.iter().find(|db| db.number == plcc_abi::s7200::CONSTANTS_DB) {
        output.image.dbs.push(DbEntry {
            number: db.number,
            name: String::new(),
            address: db.address,
            data: plan.texts.bytes.clone(),
            read_only: true,
            unlinked: false,
            optimized: false,
            kept: Kept::Nothing,
            ty: None,
        });
    }
    for (index, block) in program.blocks.iter().enumerate() {
        let Body::S7200(body) = &block.body else { continue };
        let function = lower_block(&mut plan, &mut output, block, body);
        let frame = function.frame_bytes;
        let id = output.add(function);
        debug_assert_eq!(Some(id), plan.function(index), "functions are numbered in order of the blocks");
        if matches!(block.kind, BlockKind::Ob | BlockKind::Int) {
            add_entry(&mut output, block, id, frame);
        }
    }
    output.image.s7200 = Some(S7200Image {
        timers: plan.timers.iter().copied().collect(),
        rising_edges: plan.rising_edges.next,
        falling_edges: plan.falling_edges.next - plan.falling_edges.first,
        edges: plan::edge_memories(program, sources),
        cpu,
        logic_only: false,
    });
    output.finish()
}

fn add_entry(output: &mut Output, block: &CodeBlock, function: FuncId, frame: u32) {
    output.image.blocks.push(BlockEntry {
        kind: block.kind,
        number: block.number,
        name: block.name.clone(),
        entry: output.module.entries.len() as u32,
        frame,
        local_data_used: true,
        start_inputs: Vec::new(),
    });
    output.module.entries.push(function);
}

fn lower_block<'p>(
    plan: &mut S7200Plan<'p>,
    output: &mut Output<'p>,
    block: &'p CodeBlock,
    body: &'p model::S7200Body,
) -> Function {
    let mut lowering = S7200Lowering::new(plan, output, block, body);
    let mut network = None;
    lowering.probe_enter();
    for (index, statement) in body.statements.iter().enumerate() {
        lowering.begin_statement(index, statement);
        // Waiting interrupts run between networks, in programs that have any.
        if network.replace(statement.network) != Some(statement.network) && network.is_some() {
            lowering.network_safepoint();
        }
        lowering.step_before(statement);
        lowering.count_before(statement);
        match &statement.kind {
            StatementKind::Instruction { insn, operands } => lowering.instruction(*insn, operands),
            StatementKind::Call { number, arguments } => lowering.call(*number, arguments),
            StatementKind::Assert(assert) => lowering.assert(assert, statement.span),
            StatementKind::Sleep(ms) => lowering.sleep(*ms),
        }
        lowering.probe_statement(statement);
    }
    lowering.finish()
}

impl S7200Lowering<'_, '_> {
    /// One instruction; operands are as its row says.
    fn instruction(&mut self, insn: Insn, operands: &[model::Operand]) {
        use model::Width::{Byte, Dword, Word};
        use plcc_abi::RuntimeFn as R;
        match insn {
            Insn::Load => self.load_bit(operands, false),
            Insn::LoadNot => self.load_bit(operands, true),
            Insn::And => self.combine_bit(operands, BinaryOp::And, false),
            Insn::AndNot => self.combine_bit(operands, BinaryOp::And, true),
            Insn::Or => self.combine_bit(operands, BinaryOp::Or, false),
            Insn::OrNot => self.combine_bit(operands, BinaryOp::Or, true),
            Insn::LoadNow => self.load_now(operands, false),
            Insn::LoadNotNow => self.load_now(operands, true),
            Insn::AndNow => self.combine_now(operands, BinaryOp::And, false),
            Insn::AndNotNow => self.combine_now(operands, BinaryOp::And, true),
            Insn::OrNow => self.combine_now(operands, BinaryOp::Or, false),
            Insn::OrNotNow => self.combine_now(operands, BinaryOp::Or, true),
            Insn::Not => self.not(),
            Insn::RisingEdge => self.rising_edge(),
            Insn::FallingEdge => self.falling_edge(),
            Insn::Assign => self.assign(operands),
            Insn::AssignNow => self.assign_now(operands),
            Insn::Set => self.write_bits(operands, true),
            Insn::Reset => self.write_bits(operands, false),
            Insn::SetNow => self.write_outputs_now(operands, true),
            Insn::ResetNow => self.write_outputs_now(operands, false),
            Insn::AndLoad => self.combine_levels(BinaryOp::And),
            Insn::OrLoad => self.combine_levels(BinaryOp::Or),
            Insn::Push => self.copy_level(0),
            Insn::Read => self.read_level(),
            Insn::Pop => self.pop(),
            Insn::LoadStack => self.load_level(operands),
            Insn::AndEno => self.and_eno(),
            Insn::Nop => {}
            Insn::Compare(compare) => self.compare(compare, operands),

            Insn::Ton | Insn::Tonr | Insn::Tof => self.timer(insn, operands),
            Insn::BeginInterval => self.begin_interval(operands),
            Insn::Interval => self.interval(operands),
            Insn::Ctu => self.count_up(operands),
            Insn::Ctd => self.count_down(operands),
            Insn::Ctud => self.count_up_down(operands),

            Insn::AddI => self.integer_sum(operands, Word, BinaryOp::Iadd),
            Insn::SubI => self.integer_sum(operands, Word, BinaryOp::Isub),
            Insn::MulI => self.integer_product(operands, Word),
            Insn::DivI => self.integer_quotient(operands, Word),
            Insn::AddD => self.integer_sum(operands, Dword, BinaryOp::Iadd),
            Insn::SubD => self.integer_sum(operands, Dword, BinaryOp::Isub),
            Insn::MulD => self.integer_product(operands, Dword),
            Insn::DivD => self.integer_quotient(operands, Dword),
            Insn::AddR => self.real_binary(operands, BinaryOp::Fadd),
            Insn::SubR => self.real_binary(operands, BinaryOp::Fsub),
            Insn::MulR => self.real_binary(operands, BinaryOp::Fmul),
            Insn::DivR => self.real_binary(operands, BinaryOp::Fdiv),
            Insn::Mul => self.long_product(operands),
            Insn::Div => self.division_with_remainder(operands),
            Insn::IncB => self.step(operands, Byte, 1),
            Insn::DecB => self.step(operands, Byte, -1),
            Insn::IncW => self.step(operands, Word, 1),
            Insn::DecW => self.step(operands, Word, -1),
            Insn::IncD => self.step(operands, Dword, 1),
            Insn::DecD => self.step(operands, Dword, -1),
            Insn::Sqrt => self.square_root(operands),
            Insn::Sin => self.real_function(operands, R::SinLong),
            Insn::Cos => self.real_function(operands, R::CosLong),
            Insn::Tan => self.real_function(operands, R::TanLong),
            Insn::Ln => self.logarithm(operands),
            Insn::Exp => self.real_function(operands, R::ExpLong),

            Insn::MovB => self.copy_value(operands, Byte),
            Insn::MovW => self.copy_value(operands, Word),
            Insn::MovD | Insn::MovR => self.copy_value(operands, Dword),
            Insn::Swap => self.swap(operands),
            Insn::Bir => self.read_input_now(operands),
            Insn::Biw => self.write_output_now(operands),

            Insn::InvB => self.invert(operands, Byte),
            Insn::InvW => self.invert(operands, Word),
            Insn::InvD => self.invert(operands, Dword),
            Insn::AndB => self.word_logic(operands, Byte, BinaryOp::And),
            Insn::AndW => self.word_logic(operands, Word, BinaryOp::And),
            Insn::AndD => self.word_logic(operands, Dword, BinaryOp::And),
            Insn::OrB => self.word_logic(operands, Byte, BinaryOp::Or),
            Insn::OrW => self.word_logic(operands, Word, BinaryOp::Or),
            Insn::OrD => self.word_logic(operands, Dword, BinaryOp::Or),
            Insn::XorB => self.word_logic(operands, Byte, BinaryOp::Xor),
            Insn::XorW => self.word_logic(operands, Word, BinaryOp::Xor),
            Insn::XorD => self.word_logic(operands, Dword, BinaryOp::Xor),

            Insn::ShiftRightB => self.shift(operands, Byte, BinaryOp::Lshr),
            Insn::ShiftRightW => self.shift(operands, Word, BinaryOp::Lshr),
            Insn::ShiftRightD => self.shift(operands, Dword, BinaryOp::Lshr),
            Insn::ShiftLeftB => self.shift(operands, Byte, BinaryOp::Shl),
            Insn::ShiftLeftW => self.shift(operands, Word, BinaryOp::Shl),
            Insn::ShiftLeftD => self.shift(operands, Dword, BinaryOp::Shl),
            Insn::RotateRightB => self.rotate(operands, Byte, BinaryOp::Rotr),
            Insn::RotateRightW => self.rotate(operands, Word, BinaryOp::Rotr),
            Insn::RotateRightD => self.rotate(operands, Dword, BinaryOp::Rotr),
            Insn::RotateLeftB => self.rotate(operands, Byte, BinaryOp::Rotl),
            Insn::RotateLeftW => self.rotate(operands, Word, BinaryOp::Rotl),
            Insn::RotateLeftD => self.rotate(operands, Dword, BinaryOp::Rotl),

            Insn::Bti => self.byte_to_int(operands),
            Insn::Itb => self.narrow(operands, Word, Byte),
            Insn::Itd => self.int_to_dint(operands),
            Insn::Dti => self.narrow(operands, Dword, Word),
            Insn::Dtr => self.dint_to_real(operands),
            Insn::Round => self.real_to_dint(operands, true),
            Insn::Trunc => self.real_to_dint(operands, false),
            Insn::Bcdi => self.bcd_to_int(operands),
            Insn::Ibcd => self.int_to_bcd(operands),
            Insn::Deco => self.decode(operands),
            Insn::Enco => self.encode(operands),
            Insn::Seg => self.segments(operands),

            Insn::End => self.end_if_enabled(),
            Insn::Cret | Insn::Creti => self.end_if_enabled(),
            // They are at the end of a block or section, which returns anyway.
            Insn::Mend | Insn::Ret | Insn::Reti => {}
            Insn::Stop => self.stop(),
            Insn::Jmp => self.jump(operands),
            Insn::Lbl => self.label(operands),
            Insn::For => self.begin_loop(operands),
            Insn::Next => self.end_loop(),
            Insn::Lscr => self.begin_step(operands),
            Insn::Scrt => self.transition(operands),
            Insn::Cscre => self.leave_step(),
            Insn::Scre => self.end_step(),
            // Bound to `StatementKind::Call`.
            Insn::Call => {}
            Insn::Eni => self.enable_interrupts(),

            Insn::Bmb
            | Insn::Bmw
            | Insn::Bmd
            | Insn::Fill
            | Insn::ShiftRegister
            | Insn::Att
            | Insn::Fifo
            | Insn::Lifo
            | Insn::FindEqual
            | Insn::FindNotEqual
            | Insn::FindLess
            | Insn::FindGreater
            | Insn::Ita
            | Insn::Dta
            | Insn::Rta
            | Insn::Ath
            | Insn::Hta
            | Insn::Its
            | Insn::Dts
            | Insn::Rts
            | Insn::Sti
            | Insn::Std
            | Insn::Str
            | Insn::Slen
            | Insn::Scpy
            | Insn::Scat
            | Insn::Sscpy
            | Insn::Sfnd
            | Insn::Cfnd
            | Insn::Pid
            | Insn::Hdef
            | Insn::Hsc
            | Insn::Pls
            | Insn::Wdr
            | Insn::Dled
            | Insn::Atch
            | Insn::Dtch
            | Insn::Cevnt
            | Insn::Disi
            | Insn::Netr
            | Insn::Netw
            | Insn::Xmt
            | Insn::Rcv
            | Insn::Gpa
            | Insn::Spa
            | Insn::Todr
            | Insn::Todw
            | Insn::Todrx
            | Insn::Todwx => self.operation(insn, operands),
        }
    }
}
