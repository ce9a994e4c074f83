//! Uses in the STL of an S7-200.

use plcc_abi::image::BlockKind;
use plcc_model::BlockKey;
use plcc_model::s7200::{Area as Settled, Direction, Insn, Operand as Actual, Statement, StatementKind};
use plcc_syntax::s7200::OperandClass;

use super::Collector;
use crate::operand::{Area, Operand};
use crate::{Access, Body, Width};

/// What `insn` does with an operand of a class.
fn access(insn: Insn, class: OperandClass) -> Access {
    use OperandClass as C;
    match class {
        C::BitWrite | C::OutputBit | C::WordOutAnalog | C::StringOut | C::BytesOut | C::WordsOut | C::DwordsOut => {
            if matches!(insn, Insn::Scat | Insn::ShiftRegister) { Access::ReadWrite } else { Access::Write }
        }
        C::OutputByte => Access::Write,
        C::ByteOut | C::WordOut | C::DwordOut | C::RealOut if changes_in_place(insn) => Access::ReadWrite,
        C::ByteOut | C::WordOut | C::DwordOut | C::RealOut => Access::Write,
        C::Timer | C::Counter => Access::Write,
        C::Buffer | C::Table | C::LoopTable => Access::ReadWrite,
        C::Subroutine => Access::Call,
        _ => Access::Read,
    }
}

/// Whether the result of the instruction depends on what was in its output.
fn changes_in_place(insn: Insn) -> bool {
    use Insn as I;
    matches!(
        insn,
        I::AddI
            | I::SubI
            | I::MulI
            | I::DivI
            | I::AddD
            | I::SubD
            | I::MulD
            | I::DivD
            | I::AddR
            | I::SubR
            | I::MulR
            | I::DivR
            | I::Mul
            | I::Div
            | I::IncB
            | I::DecB
            | I::IncW
            | I::DecW
            | I::IncD
            | I::DecD
            | I::Swap
            | I::InvB
            | I::InvW
            | I::InvD
            | I::AndB
            | I::AndW
            | I::AndD
            | I::OrB
            | I::OrW
            | I::OrD
            | I::XorB
            | I::XorW
            | I::XorD
            | I::ShiftRightB
            | I::ShiftRightW
            | I::ShiftRightD
            | I::ShiftLeftB
            | I::ShiftLeftW
            | I::ShiftLeftD
            | I::RotateRightB
            | I::RotateRightW
            | I::RotateRightD
            | I::RotateLeftB
            | I::RotateLeftW
            | I::RotateLeftD
            | I::Bcdi
            | I::Ibcd
            | I::FindEqual
            | I::FindNotEqual
            | I::FindLess
            | I::FindGreater
            | I::Sfnd
            | I::Cfnd
            | I::For
    )
}

/// How many elements an operand of a class has: the count that the instruction names, where it is known.
fn elements(class: OperandClass, operands: &[Actual]) -> u32 {
    use OperandClass as C;
    let of_several = matches!(
        class,
        C::BytesIn | C::BytesOut | C::WordsIn | C::WordsOut | C::DwordsIn | C::DwordsOut | C::BitWrite | C::OutputBit
    );
    match operands.last() {
        // A negative count of a shift register is the direction.
        Some(Actual::Const(count)) if class == C::BitWrite && operands.len() > 2 => {
            u32::from((*count as u8).cast_signed().unsigned_abs()).max(1)
        }
        Some(Actual::Const(count)) if of_several && operands.len() > 1 => (*count).clamp(1, 255),
        _ => 1,
    }
}

impl Collector<'_> {
    pub(super) fn s7200(&mut self, statement: &Statement) {
        (self.network, self.span) = (statement.network, statement.span);
        match &statement.kind {
            StatementKind::Instruction { insn, operands } => {
                for (operand, &class) in operands.iter().zip(insn.operands()) {
                    if let (Actual::Const(number), OperandClass::Interrupt) = (operand, class) {
                        let key = BlockKey { kind: BlockKind::Int, number: *number as u16 };
                        self.add(Operand::Block(key), Access::Read);
                    } else {
                        self.s7200_operand(operand, access(*insn, class), elements(class, operands));
                    }
                }
            }
            StatementKind::Call { number, arguments } => {
                let key = BlockKey { kind: BlockKind::Sbr, number: *number };
                self.add(Operand::Block(key), Access::Call);
                let program = self.program;
                let callee = program.block(key).map(|block| &block.body);
                let parameters = if let Some(Body::S7200(callee)) = callee { &callee.parameters[..] } else { &[] };
                for (operand, parameter) in arguments.iter().zip(parameters) {
                    let access = match parameter.direction {
                        Direction::In => Access::Read,
                        Direction::InOut => Access::ReadWrite,
                        Direction::Out => Access::Write,
                    };
                    self.s7200_operand(operand, access, 1);
                }
            }
            StatementKind::Assert(_) | StatementKind::Sleep(_) => {}
        }
        for operand in &statement.addresses {
            self.s7200_operand(operand, Access::Undecided, 1);
        }
    }

    /// An operand that is the first of so many.
    fn s7200_operand(&mut self, operand: &Actual, access: Access, elements: u32) {
        let mut memory = |area, byte: u32, bit: u8, width: Width| {
            let start = byte.saturating_mul(8).saturating_add(u32::from(bit));
            self.add(Operand::Memory { area, start, bits: width.bits().saturating_mul(elements) }, access);
        };
        match operand {
            Actual::Memory { area, byte, bit, width } => {
                let area = match area {
                    Settled::I => Area::I,
                    Settled::Q => Area::Q,
                    Settled::V => Area::V,
                    Settled::M => Area::M,
                    Settled::Sm => Area::Sm,
                    Settled::S => Area::S,
                    Settled::L => return,
                };
                memory(area, *byte, *bit, *width);
            }
            Actual::AnalogInput { byte } => memory(Area::Ai, *byte, 0, Width::Word),
            Actual::AnalogOutput { byte } => memory(Area::Aq, *byte, 0, Width::Word),
            Actual::Timer { number, .. } => self.add(Operand::Timer(u16::from(*number)), access),
            Actual::Counter { number, .. } => self.add(Operand::Counter(u16::from(*number)), access),
            Actual::HighSpeedCounter(number) => self.add(Operand::HighSpeedCounter(u16::from(*number)), access),
            // The pointer is read, whatever is done with its target.
            Actual::Indirect { pointer, .. } => self.s7200_operand(pointer, Access::Read, 1),
            Actual::Const(_) | Actual::Text(_) | Actual::Accumulator { .. } => {}
        }
    }
}
