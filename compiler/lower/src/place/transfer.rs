//! Reads and writes of targets: memory and the peripheral area.

use plcc_abi::codes::{access_area, sync};
use plcc_abi::{RuntimeFn, Type};
use plcc_ir::{Address, BinaryOp, IntCc, Value, Var};
use plcc_model::{Place, Width};

use super::{BitNumber, Direction, Target, TargetKind, access_byte, width_type};
use crate::block::BlockLowering;
use crate::fault::{Check, Substitute};

impl BlockLowering<'_, '_> {
    /// Reads `place`: an i32, zero-extended, an i1 with width Bit, an i64 with width Lword. After a fault, the value that the error OB supplies.
    pub fn read(&mut self, place: &Place, width: Width) -> Value {
        if self.is_by_reference(place) {
            let result = self.result_of(width);
            self.by_reference(place, width, Direction::Read, &mut |this, target| {
                let value = this.read_target(target, width);
                this.b.def_var(result, value);
            });
            return self.b.use_var(result);
        }
        if let Some(crossing) = self.crossing(place) {
            let result = self.result_of(width);
            self.by_area(&crossing, width, Direction::Read, &mut |this, target| {
                let value = this.read_target(target, width);
                this.b.def_var(result, value);
            });
            return self.b.use_var(result);
        }
        let target = self.target(place, width, Direction::Read);
        self.read_target(target, width)
    }

    pub fn result_of(&self, width: Width) -> Var {
        match width {
            Width::Bit => self.result_bit,
            Width::Byte | Width::Word | Width::Dword => self.result,
            Width::Lword => self.result_long,
        }
    }

    pub fn read_target(&mut self, target: Target, width: Width) -> Value {
        let substitute = match width {
            Width::Bit => Substitute::Bit,
            Width::Byte | Width::Word | Width::Dword => Substitute::Word,
            Width::Lword => Substitute::Long,
        };
        let result = self.result_of(width);
        let guard = self.begin_guard(target.checks, substitute);
        let value = match target.kind {
            TargetKind::Memory { addr, bit } => self.read_memory(addr, bit, width),
            TargetKind::Peripheral { address, bit } => self.read_peripheral(address, bit, width),
            TargetKind::Either { is_peripheral, address, addr, bit } => {
                let (there, here, join) = (self.b.create_cold_block(), self.b.create_block(), self.b.create_block());
                self.b.branch(is_peripheral, there, here);
                self.b.seal_block(there);
                self.b.seal_block(here);
                self.b.switch_to(there);
                let value = self.read_peripheral(address, 0, width);
                self.b.def_var(result, value);
                self.b.jump(join, &[]);
                self.b.switch_to(here);
                let value = self.read_memory(addr, bit, width);
                self.b.def_var(result, value);
                self.b.jump(join, &[]);
                self.b.seal_block(join);
                self.b.switch_to(join);
                self.b.use_var(result)
            }
        };
        if guard.is_none() {
            return value;
        }
        self.b.def_var(result, value);
        self.end_guard(guard);
        self.b.use_var(result)
    }

    fn read_memory(&mut self, addr: Address, bit: BitNumber, width: Width) -> Value {
        match (width, bit) {
            (Width::Bit, BitNumber::Known(bit)) => self.b.load_bit(addr, bit),
            (Width::Bit, BitNumber::Alone) => self.b.load_bit(addr, 0),
            (Width::Bit, BitNumber::Dynamic(bit)) => {
                let byte = self.load_zero_extended(addr, Width::Byte);
                let shifted = self.b.binary(BinaryOp::Lshr, byte, bit);
                self.b.trunc(Type::I1, shifted)
            }
            (Width::Byte | Width::Word | Width::Dword, _) => self.load_zero_extended(addr, width),
            (Width::Lword, _) => self.b.load(Type::I64, addr),
        }
    }

    /// Loads 8, 16 or 32 bits as i32.
    pub fn load_zero_extended(&mut self, addr: Address, width: Width) -> Value {
        let value = self.b.load(width_type(width), addr);
        self.b.zext(Type::I32, value)
    }

    fn read_peripheral(&mut self, address: Value, bit: u8, width: Width) -> Value {
        if width == Width::Lword {
            // Modules transfer at most double words.
            let high = self.read_peripheral(address, 0, Width::Dword);
            let next = self.b.binary_imm(BinaryOp::Iadd, address, 4);
            let low = self.read_peripheral(next, 0, Width::Dword);
            let (high, low) = (self.b.zext(Type::I64, high), self.b.zext(Type::I64, low));
            let high = self.b.binary_imm(BinaryOp::Shl, high, 32);
            return self.b.or(high, low);
        }
        let bytes = self.b.i32_const(width.bytes());
        let answer =
            self.b.call_runtime(RuntimeFn::PeripheralRead, &[address, bytes]).expect("peripheral_read has a result");
        let missing = self.b.binary_imm(BinaryOp::Lshr, answer, 32);
        let missing = self.b.trunc(Type::I32, missing);
        let ok = self.b.icmp_imm(IntCc::Eq, missing, 0);
        let check = self.peripheral_check(ok, address, width, Direction::Read);
        let guard = self.begin_guard(vec![check], Substitute::Word);
        let value = self.b.trunc(Type::I32, answer);
        self.b.def_var(self.result, value);
        self.end_guard(guard);
        let value = self.b.use_var(self.result);
        if width != Width::Bit {
            return value;
        }
        let value = self.b.binary_imm(BinaryOp::Lshr, value, i64::from(bit));
        self.b.trunc(Type::I1, value)
    }

    fn peripheral_check(&mut self, ok: Value, address: Value, width: Width, direction: Direction) -> Check {
        let code = if direction == Direction::Read { sync::IO_READ } else { sync::IO_WRITE };
        let code = self.b.i32_const(u32::from(code));
        let access = self.b.i32_const(access_byte(width, access_area::P));
        Check { ok, code, access, info: address, db: None }
    }

    /// Writes the low bits of `value` (an i32; an i1 with width Bit) to `place`.
    pub fn write(&mut self, place: &Place, width: Width, value: Value) {
        if self.is_by_reference(place) {
            return self.by_reference(place, width, Direction::Write, &mut |this, target| {
                this.write_target(target, width, value);
            });
        }
        if let Some(crossing) = self.crossing(place) {
            self.by_area(&crossing, width, Direction::Write, &mut |this, target| {
                this.write_target(target, width, value);
            });
            return;
        }
        let target = self.target(place, width, Direction::Write);
        self.write_target(target, width, value);
    }

    pub fn write_target(&mut self, target: Target, width: Width, value: Value) {
        let guard = self.begin_guard(target.checks, Substitute::None);
        match target.kind {
            TargetKind::Memory { addr, bit } => self.write_memory(addr, bit, width, value),
            TargetKind::Peripheral { address, bit } if width == Width::Bit => {
                self.write_peripheral_bit(address, bit, value);
            }
            TargetKind::Peripheral { address, .. } => self.write_peripheral(address, width, value),
            TargetKind::Either { is_peripheral, address, addr, bit } => {
                let (there, here, join) = (self.b.create_cold_block(), self.b.create_block(), self.b.create_block());
                self.b.branch(is_peripheral, there, here);
                self.b.seal_block(there);
                self.b.seal_block(here);
                self.b.switch_to(there);
                self.write_peripheral(address, width, value);
                self.b.jump(join, &[]);
                self.b.switch_to(here);
                self.write_memory(addr, bit, width, value);
                self.b.jump(join, &[]);
                self.b.seal_block(join);
                self.b.switch_to(join);
            }
        }
        self.end_guard(guard);
    }

    fn write_memory(&mut self, addr: Address, bit: BitNumber, width: Width, value: Value) {
        match (width, bit) {
            (Width::Bit, BitNumber::Known(bit)) => self.b.store_bit(addr, bit, value),
            (Width::Bit, BitNumber::Alone) => {
                let byte = self.b.zext(Type::I8, value);
                self.b.store(addr, byte);
            }
            (Width::Bit, BitNumber::Dynamic(bit)) => {
                let one = self.b.i32_const(1);
                let mask = self.b.binary(BinaryOp::Shl, one, bit);
                let others = self.b.not(mask);
                let byte = self.load_zero_extended(addr, Width::Byte);
                let cleared = self.b.and(byte, others);
                let value = self.b.zext(Type::I32, value);
                let shifted = self.b.binary(BinaryOp::Shl, value, bit);
                let byte = self.b.or(cleared, shifted);
                self.store_low(addr, Width::Byte, byte);
            }
            (Width::Byte | Width::Word | Width::Dword, _) => self.store_low(addr, width, value),
            (Width::Lword, _) => self.b.store(addr, value),
        }
    }

    /// Stores the low 8, 16 or 32 bits of an i32.
    pub fn store_low(&mut self, addr: Address, width: Width, value: Value) {
        let value = self.b.trunc(width_type(width), value);
        self.b.store(addr, value);
    }

    fn write_peripheral(&mut self, address: Value, width: Width, value: Value) {
        if width == Width::Lword {
            let high = self.b.binary_imm(BinaryOp::Lshr, value, 32);
            let (high, low) = (self.b.trunc(Type::I32, high), self.b.trunc(Type::I32, value));
            self.write_peripheral(address, Width::Dword, high);
            let after = self.b.binary_imm(BinaryOp::Iadd, address, 4);
            return self.write_peripheral(after, Width::Dword, low);
        }
        let value = if width == Width::Bit { self.b.zext(Type::I32, value) } else { value };
        let bytes = self.b.i32_const(width.bytes());
        let missing = self
            .b
            .call_runtime(RuntimeFn::PeripheralWrite, &[address, bytes, value])
            .expect("peripheral_write has a result");
        let ok = self.b.icmp_imm(IntCc::Eq, missing, 0);
        let check = self.peripheral_check(ok, address, width, Direction::Write);
        let guard = self.begin_guard(vec![check], Substitute::None);
        self.end_guard(guard);
    }

    /// Writes one bit of a peripheral output byte: `value` is an i1.
    pub fn write_peripheral_bit(&mut self, address: Value, bit: u8, value: Value) {
        let bit = self.b.i32_const(u32::from(bit));
        let value = self.b.zext(Type::I32, value);
        let missing = self
            .b
            .call_runtime(RuntimeFn::PeripheralWriteBit, &[address, bit, value])
            .expect("peripheral_write_bit has a result");
        let ok = self.b.icmp_imm(IntCc::Eq, missing, 0);
        let check = self.peripheral_check(ok, address, Width::Bit, Direction::Write);
        let guard = self.begin_guard(vec![check], Substitute::None);
        self.end_guard(guard);
    }
}
