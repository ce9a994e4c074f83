//! Instructions that the runtime performs: which operation, and how its operands are passed.

use plcc_abi::RuntimeFn;
use plcc_abi::s7200::{Operation, result};
use plcc_ir::{BinaryOp, IntCc, Type, Value};
use plcc_model::s7200::{Insn, Operand, Width};

use super::block::S7200Lowering;
use super::operand::Use;

/// An operand of an operation.
#[derive(Clone, Copy)]
enum Give {
    /// Value of operand n, zero-extended.
    Value(usize, Width),
    /// Value of operand n, a byte with sign.
    Signed(usize),
    /// Value of operand n, a bit.
    Bit(usize),
    /// Address of operand n, which is read.
    From(usize),
    /// Address of operand n, which is written.
    To(usize),
    /// Address of a bit, eight times that of its byte plus the bit.
    BitAddress(usize),
    Fixed(u32),
}

/// How an instruction becomes an operation.
struct Row {
    operation: Operation,
    give: &'static [Give],
    /// The operand that receives the value.
    takes: Option<(usize, Width)>,
}

const fn row(operation: Operation, give: &'static [Give]) -> Row {
    Row { operation, give, takes: None }
}

const fn giving(operation: Operation, give: &'static [Give], output: usize, width: Width) -> Row {
    Row { operation, give, takes: Some((output, width)) }
}

/// The row of an instruction; `None`: it is lowered elsewhere.
#[rustfmt::skip]
fn row_of(insn: Insn) -> Option<Row> {
    use Give::{Bit, BitAddress, Fixed, From, Signed, To, Value};
    use Operation as O;
    use Width::{Byte, Dword, Word};
    Some(match insn {
        Insn::Bmb => row(O::CopyBlock, &[From(0), To(1), Fixed(1), Value(2, Byte)]),
        Insn::Bmw => row(O::CopyBlock, &[From(0), To(1), Fixed(2), Value(2, Byte)]),
        Insn::Bmd => row(O::CopyBlock, &[From(0), To(1), Fixed(4), Value(2, Byte)]),
        Insn::Fill => row(O::Fill, &[Value(0, Word), To(1), Value(2, Byte)]),
        Insn::ShiftRegister => row(O::ShiftRegister, &[Bit(0), BitAddress(1), Signed(2)]),
        Insn::Att => row(O::TableAdd, &[Value(0, Word), To(1)]),
        Insn::Fifo => giving(O::TableFirst, &[To(0)], 1, Word),
        Insn::Lifo => giving(O::TableLast, &[To(0)], 1, Word),
        Insn::FindEqual => giving(O::TableFind, &[From(0), Value(1, Word), Value(2, Word), Fixed(0)], 2, Word),
        Insn::FindNotEqual => giving(O::TableFind, &[From(0), Value(1, Word), Value(2, Word), Fixed(1)], 2, Word),
        Insn::FindLess => giving(O::TableFind, &[From(0), Value(1, Word), Value(2, Word), Fixed(2)], 2, Word),
        Insn::FindGreater => giving(O::TableFind, &[From(0), Value(1, Word), Value(2, Word), Fixed(3)], 2, Word),
        Insn::Ita => row(O::IntToAscii, &[Value(0, Word), To(1), Value(2, Byte)]),
        Insn::Dta => row(O::DintToAscii, &[Value(0, Dword), To(1), Value(2, Byte)]),
        Insn::Rta => row(O::RealToAscii, &[Value(0, Dword), To(1), Value(2, Byte)]),
        Insn::Its => row(O::IntToString, &[Value(0, Word), To(1), Value(2, Byte)]),
        Insn::Dts => row(O::DintToString, &[Value(0, Dword), To(1), Value(2, Byte)]),
        Insn::Rts => row(O::RealToString, &[Value(0, Dword), To(1), Value(2, Byte)]),
        Insn::Ath => row(O::AsciiToHex, &[From(0), To(1), Value(2, Byte)]),
        Insn::Hta => row(O::HexToAscii, &[From(0), To(1), Value(2, Byte)]),
        Insn::Sti => giving(O::StringToInt, &[From(0), Value(1, Byte)], 2, Word),
        Insn::Std => giving(O::StringToDint, &[From(0), Value(1, Byte)], 2, Dword),
        Insn::Str => giving(O::StringToReal, &[From(0), Value(1, Byte)], 2, Dword),
        Insn::Slen => giving(O::StringLength, &[From(0)], 1, Byte),
        Insn::Scpy => row(O::StringCopy, &[From(0), To(1)]),
        Insn::Scat => row(O::StringAppend, &[From(0), To(1)]),
        Insn::Sscpy => row(O::StringPart, &[From(0), Value(1, Byte), Value(2, Byte), To(3)]),
        Insn::Sfnd => giving(O::StringFind, &[From(0), From(1), Value(2, Byte)], 2, Byte),
        Insn::Cfnd => giving(O::CharacterFind, &[From(0), From(1), Value(2, Byte)], 2, Byte),
        Insn::Hdef => row(O::DefineCounter, &[Value(0, Byte), Value(1, Byte)]),
        Insn::Hsc => row(O::ControlCounter, &[Value(0, Byte)]),
        Insn::Pls => row(O::ControlPulses, &[Value(0, Byte)]),
        Insn::Wdr => row(O::RestartWatchdog, &[]),
        Insn::Dled => row(O::DiagnosticLed, &[Value(0, Byte)]),
        Insn::Atch => row(O::AttachInterrupt, &[Value(0, Word), Value(1, Byte)]),
        Insn::Dtch => row(O::DetachInterrupt, &[Value(0, Byte)]),
        Insn::Cevnt => row(O::ClearEvents, &[Value(0, Byte)]),
        Insn::Disi => row(O::DisableInterrupts, &[]),
        Insn::Netr => row(O::NetworkRead, &[To(0), Value(1, Byte)]),
        Insn::Netw => row(O::NetworkWrite, &[To(0), Value(1, Byte)]),
        Insn::Xmt => row(O::Transmit, &[From(0), Value(1, Byte)]),
        Insn::Rcv => row(O::Receive, &[To(0), Value(1, Byte)]),
        Insn::Gpa => giving(O::GetStationAddress, &[Value(1, Byte)], 0, Byte),
        Insn::Spa => row(O::SetStationAddress, &[Value(0, Byte), Value(1, Byte)]),
        Insn::Todr => row(O::ReadClock, &[To(0)]),
        Insn::Todw => row(O::SetClock, &[From(0)]),
        Insn::Todrx => row(O::ReadClockExtended, &[To(0)]),
        Insn::Todwx => row(O::SetClockExtended, &[From(0)]),
        _ => return None,
    })
}

impl S7200Lowering<'_, '_> {
    /// An instruction of the table above, or PID.
    pub fn operation(&mut self, insn: Insn, operands: &[Operand]) {
        if insn == Insn::Pid {
            return self.pid(operands);
        }
        let Some(row) = row_of(insn) else { return };
        if let Some(known) = self.known_move(insn, operands) {
            return self.boxed(|lowering| lowering.move_in_place(known, operands));
        }
        if insn.eno() == "-" {
            return self.conditional(|lowering| {
                let given = lowering.all_given(&row, operands);
                lowering.run_raw(row.operation, &given);
            });
        }
        self.boxed(|lowering| {
            lowering.table_in_place(insn, operands, |lowering| lowering.perform(&row, operands));
        });
    }

    /// An operation that has an ENO.
    fn perform(&mut self, row: &Row, operands: &[Operand]) {
        let given = self.all_given(row, operands);
        let Some((output, width)) = row.takes else { return self.run(row.operation, &given) };
        let target = self.target(&operands[output], width);
        let result = self.run_raw(row.operation, &given);
        self.take_eno(result);
        let value = self.value_of(result);
        let (store, after) = (self.b.create_block(), self.b.create_block());
        let valid = self.result_bit(result, result::VALUE);
        self.b.branch(valid, store, after);
        self.b.seal_block(store);
        self.b.switch_to(store);
        let value = match width {
            Width::Dword => value,
            width => self.b.trunc(super::plan::ir_type(width), value),
        };
        self.store(target, width, value);
        self.b.jump(after, &[]);
        self.b.seal_block(after);
        self.b.switch_to(after);
    }

    fn all_given(&mut self, row: &Row, operands: &[Operand]) -> Vec<Value> {
        row.give.iter().map(|give| self.given(*give, operands)).collect()
    }

    fn given(&mut self, give: Give, operands: &[Operand]) -> Value {
        match give {
            Give::Fixed(value) => self.b.i32_const(value),
            Give::Value(index, width) => {
                let value = self.read(&operands[index], width);
                if width == Width::Dword { value } else { self.b.zext(Type::I32, value) }
            }
            Give::Signed(index) => {
                let value = self.read(&operands[index], Width::Byte);
                self.b.sext(Type::I32, value)
            }
            Give::Bit(index) => {
                let value = self.read(&operands[index], Width::Bit);
                self.b.zext(Type::I32, value)
            }
            Give::From(index) => self.long_address(&operands[index], Use::Read),
            Give::To(index) => self.long_address(&operands[index], Use::Write),
            Give::BitAddress(index) => {
                let at = self.operand_address(&operands[index], Use::Write);
                let first = self.b.binary_imm(BinaryOp::Shl, at, 3);
                let bit = match operands[index] {
                    Operand::Memory { bit, .. } => bit,
                    _ => 0,
                };
                self.b.binary_imm(BinaryOp::Iadd, first, i64::from(bit))
            }
        }
    }

    /// Address of a byte that others may follow. Words of timers and counters are named by their first byte.
    fn long_address(&mut self, operand: &Operand, purpose: Use) -> Value {
        match operand {
            Operand::Timer { .. } | Operand::Counter { .. } => self.address_value(operand, Width::Word, purpose),
            Operand::Accumulator { width, .. } | Operand::Indirect { width, .. } => {
                self.address_value(operand, *width, purpose)
            }
            _ => self.operand_address(operand, purpose),
        }
    }

    /// PID: the loop must also see that it is switched off.
    fn pid(&mut self, operands: &[Operand]) {
        let [table, number] = operands else { return };
        let enable = self.top();
        self.guarded(|lowering| {
            let table = lowering.operand_address(table, Use::Write);
            let number = lowering.read(number, Width::Byte);
            let number = lowering.b.zext(Type::I32, number);
            let on = lowering.b.zext(Type::I32, enable);
            let result = lowering.run_raw(Operation::Pid, &[table, number, on]);
            let ran = lowering.result_bit(result, result::ENO);
            let eno = lowering.b.and(ran, enable);
            lowering.set(lowering.eno, eno);
        });
    }

    /// `ENI`: waiting interrupts run now.
    pub fn enable_interrupts(&mut self) {
        self.boxed(|lowering| {
            lowering.run(Operation::EnableInterrupts, &[]);
            lowering.safepoint();
        });
    }

    /// Runs an operation; its ENO is that of the instruction.
    pub fn run(&mut self, operation: Operation, given: &[Value]) {
        let result = self.run_raw(operation, given);
        self.take_eno(result);
    }

    /// Runs an operation; the whole result, an i64.
    pub fn run_raw(&mut self, operation: Operation, given: &[Value]) -> Value {
        let mut arguments = vec![self.site_value(), self.b.i32_const(operation as u32)];
        arguments.extend(given);
        while arguments.len() < 6 {
            let nothing = self.b.i32_const(0);
            arguments.push(nothing);
        }
        self.b.call_runtime(RuntimeFn::S7200Operation, &arguments).expect("it has a result")
    }

    fn take_eno(&mut self, result: Value) {
        let eno = self.result_bit(result, result::ENO);
        self.set(self.eno, eno);
    }

    pub fn result_bit(&mut self, result: Value, bit: u64) -> Value {
        let masked = self.b.binary_imm(BinaryOp::And, result, bit as i64);
        self.b.icmp_imm(IntCc::Ne, masked, 0)
    }

    /// The value of a result, an i32.
    pub fn value_of(&mut self, result: Value) -> Value {
        let high = self.b.binary_imm(BinaryOp::Lshr, result, 32);
        self.b.trunc(Type::I32, high)
    }

    /// Leaves the block if the operation requires it.
    pub fn stop_if_told(&mut self, result: Value) {
        let stop = self.b.binary_imm(BinaryOp::And, result, result::STOP as i64);
        self.stop_check(stop);
    }
}
