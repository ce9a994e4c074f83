//! Uses in STL.

use plcc_abi::image::BlockKind;
use plcc_model::{Actual, BlockKey, Call, CellKind, Instance, Number, Operand as Settled, Place, StlStatementKind};
use plcc_syntax::stl::{OperandClass, StlInsn};

use super::Collector;
use crate::Access;
use crate::operand::Operand;

/// What an instruction does with its operand.
fn access(insn: StlInsn) -> Access {
    match (insn, insn.operand()) {
        (StlInsn::EdgePositive | StlInsn::EdgeNegative, _) => Access::ReadWrite,
        (StlInsn::LoadBcd, _) => Access::Read,
        (
            _,
            OperandClass::BitWrite
            | OperandClass::BitWriteOrCounter
            | OperandClass::BitWriteOrCell
            | OperandClass::TransferTarget
            | OperandClass::TransferAr1
            | OperandClass::TransferAr2
            | OperandClass::Timer
            | OperandClass::Counter
            | OperandClass::Cell,
        ) => Access::Write,
        (_, OperandClass::Block) => Access::Call,
        (_, OperandClass::DataBlock) => Access::Open,
        _ => Access::Read,
    }
}

impl Collector<'_> {
    pub(super) fn stl_statement(&mut self, statement: &StlStatementKind) {
        match statement {
            StlStatementKind::Instruction { insn, operand } => self.stl_operand(operand, access(*insn)),
            StlStatementKind::Call(call) => self.stl_call(call),
            StlStatementKind::Label(_)
            | StlStatementKind::JumpList { .. }
            | StlStatementKind::Assert(_)
            | StlStatementKind::Sleep(_) => {}
        }
    }

    fn stl_operand(&mut self, operand: &Settled, access: Access) {
        match operand {
            Settled::Memory { place, width } => self.place(place, width.bits(), access, self.span),
            Settled::Cell { kind: CellKind::Timer, number } => self.number(number, Operand::Timer, access),
            Settled::Cell { kind: CellKind::Counter, number } => self.number(number, Operand::Counter, access),
            Settled::Block { kind, number: Number::Known(number) } => {
                self.add(Operand::Block(BlockKey { kind: *kind, number: *number }), access);
            }
            Settled::Block { kind: _, number } | Settled::Db { di: _, number } => {
                self.number(number, Operand::db, access);
            }
            Settled::None
            | Settled::Const { .. }
            | Settled::Status(_)
            | Settled::Special(_)
            | Settled::Register(_)
            | Settled::Label(_)
            | Settled::ParameterPointer { .. } => {}
        }
    }

    fn stl_call(&mut self, call: &Call) {
        self.add(Operand::Block(call.target), Access::Call);
        let program = self.program;
        match call.instance {
            Some(Instance::Db(number)) => {
                self.add(Operand::Block(BlockKey { kind: BlockKind::Db, number }), Access::Call);
            }
            Some(Instance::Inner { db, byte }) => {
                let place = Place::Db { number: db, byte, bit: 0 };
                let bytes = program.block(call.target).map_or(0, |callee| callee.interface.bytes);
                self.place(&place, 8 * bytes, Access::Call, self.span);
            }
            Some(Instance::Multi { .. }) | None => {}
        }
        let Some(callee) = program.block(call.target) else { return };
        for argument in &call.arguments {
            let Some(parameter) = callee.interface.parameters.get(argument.parameter) else { continue };
            let access = self.access_by(call.target, parameter);
            match argument.actual.pointer() {
                Actual::Place(place) => self.place(place, Self::passed_bits(parameter), access, argument.span),
                Actual::Number(number) => self.passed_number(number, parameter),
                Actual::PointerBytes(bytes) => self.pointer(bytes, parameter.passing, access, argument.span),
                Actual::PointerTo { place, type_code, count } => {
                    let bits = super::pointed_bits(*type_code, *count);
                    self.place(place, bits, access, argument.span);
                }
                Actual::PointerCopy(_) | Actual::Const(_) | Actual::Variant(..) => {}
            }
        }
    }
}
