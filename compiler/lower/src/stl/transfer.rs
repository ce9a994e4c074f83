//! Load, transfer, address registers, status word. Source: STL reference, load and transfer, address registers.

use plcc_abi::layout::area;
use plcc_ir::{BinaryOp, Type, Value, Var};
use plcc_model::{AddressRegister, Operand, Passing, SpecialRegister, Width};

use super::cells::CellRead;
use crate::block::BlockLowering;

/// Address part of an address register.
const ADDRESS_MASK: i64 = 0x00FF_FFFF;

impl BlockLowering<'_, '_> {
    /// `L`.
    pub fn load(&mut self, operand: &Operand) {
        let value = self.load_value(operand);
        self.load_accu1(value);
    }

    /// The value that `L operand` loads, an i32.
    pub fn load_value(&mut self, operand: &Operand) -> Value {
        match operand {
            Operand::Const { value, .. } => self.b.i32_const(*value),
            Operand::Memory { place, width: Width::Bit } => {
                let bit = self.read(place, Width::Bit);
                self.b.zext(Type::I32, bit)
            }
            Operand::Memory { place, width } => self.read(place, *width),
            Operand::Cell { kind, number } => self.cell_value(*kind, number, CellRead::Binary),
            Operand::Special(special) => self.special(*special),
            Operand::Register(register) => self.get(self.address_register(*register)),
            Operand::ParameterPointer { parameter } if matches!(self.passing(*parameter), Passing::Elementary(_)) => {
                self.area_pointer(*parameter)
            }
            Operand::ParameterPointer { parameter } => {
                let offset = self.parameters[*parameter][0];
                let bits = self.b.binary_imm(BinaryOp::Shl, offset, 3);
                self.b.binary_imm(BinaryOp::Or, bits, i64::from(area::V) << 24)
            }
            Operand::Status(status) => {
                let bit = self.status(*status);
                self.b.zext(Type::I32, bit)
            }
            Operand::None | Operand::Block { .. } | Operand::Db { .. } | Operand::Label(_) => {
                unreachable!("the binder only passes sources of `L`")
            }
        }
    }

    pub fn address_register(&self, register: AddressRegister) -> Var {
        match register {
            AddressRegister::Ar1 => self.regs.ar[0],
            AddressRegister::Ar2 => self.regs.ar[1],
        }
    }

    fn special(&mut self, special: SpecialRegister) -> Value {
        match special {
            SpecialRegister::Stw => {
                let all = self.has_four_accumulators();
                self.status_word(all)
            }
            SpecialRegister::DbNumber => self.get(self.regs.db),
            SpecialRegister::DiNumber => self.get(self.regs.di),
            SpecialRegister::DbLength => {
                let number = self.get(self.regs.db);
                self.b.db_length(number)
            }
            SpecialRegister::DiLength => {
                let number = self.get(self.regs.di);
                self.b.db_length(number)
            }
        }
    }

    /// The status bits with their positions in the status word.
    fn status_bits(&self) -> [(Var, u8); 9] {
        [
            (self.regs.br, 8),
            (self.regs.cc1, 7),
            (self.regs.cc0, 6),
            (self.regs.ov, 5),
            (self.regs.os, 4),
            (self.regs.or_, 3),
            (self.regs.sta, 2),
            (self.regs.rlo, 1),
            (self.regs.fc, 0),
        ]
    }

    /// OR, STA and /FC, which an S7-300 with two accumulators does not transfer.
    fn is_hidden(bit: u8) -> bool {
        matches!(bit, 3 | 2 | 0)
    }

    /// The status word as i32; without OR, STA and /FC unless `all`.
    pub fn status_word(&mut self, all: bool) -> Value {
        let mut word = self.b.i32_const(0);
        for (var, bit) in self.status_bits() {
            if all || !Self::is_hidden(bit) {
                let value = self.get(var);
                let value = self.b.zext(Type::I32, value);
                let value = self.b.binary_imm(BinaryOp::Shl, value, i64::from(bit));
                word = self.b.or(word, value);
            }
        }
        word
    }

    /// The bits of an i32 become status bits; OR, STA and /FC only with `all`.
    pub fn set_status_word(&mut self, word: Value, all: bool) {
        for (var, bit) in self.status_bits() {
            if all || !Self::is_hidden(bit) {
                let bit = self.b.binary_imm(BinaryOp::Lshr, word, i64::from(bit));
                let bit = self.b.trunc(Type::I1, bit);
                self.set(var, bit);
            }
        }
    }

    /// `T`.
    pub fn transfer(&mut self, operand: &Operand) {
        let accu1 = self.accu1();
        let on = self.mcr_on();
        let zero = self.b.i32_const(0);
        let value = self.b.select(on, accu1, zero);
        match operand {
            Operand::Memory { place, width } => self.write(place, *width, value),
            Operand::Special(SpecialRegister::Stw) => {
                let all = self.has_four_accumulators();
                self.set_status_word(value, all);
            }
            Operand::None
            | Operand::Const { .. }
            | Operand::Cell { .. }
            | Operand::Block { .. }
            | Operand::Db { .. }
            | Operand::Status(_)
            | Operand::Special(_)
            | Operand::Register(_)
            | Operand::Label(_)
            | Operand::ParameterPointer { .. } => unreachable!("the binder only passes targets of `T`"),
        }
    }

    /// `LAR1`, `LAR2`: from ACCU1 without operand.
    pub fn load_address_register(&mut self, index: usize, operand: &Operand) {
        let value = match operand {
            Operand::None => self.accu1(),
            _ => self.load_value(operand),
        };
        self.set(self.regs.ar[index], value);
    }

    /// `TAR1`, `TAR2`: to ACCU1 without operand.
    pub fn transfer_address_register(&mut self, index: usize, operand: &Operand) {
        let value = self.get(self.regs.ar[index]);
        match operand {
            Operand::None => self.load_accu1(value),
            Operand::Register(register) => self.set(self.address_register(*register), value),
            Operand::Memory { place, width } => self.write(place, *width, value),
            _ => unreachable!("the binder only passes double words"),
        }
    }

    /// `+AR1`, `+AR2`: 24 bits wrap, the area code stays.
    pub fn add_address_register(&mut self, index: usize, operand: &Operand) {
        let var = self.regs.ar[index];
        let add = match Self::constant(operand) {
            Some((value, _)) => self.b.i32_const(value),
            None => {
                let accu1 = self.accu1();
                let word = self.low_word(accu1);
                self.b.sext(Type::I32, word)
            }
        };
        let old = self.get(var);
        let sum = self.b.iadd(old, add);
        let address = self.b.binary_imm(BinaryOp::And, sum, ADDRESS_MASK);
        let code = self.b.binary_imm(BinaryOp::And, old, 0xFF00_0000);
        let value = self.b.or(code, address);
        self.set(var, value);
    }
}
