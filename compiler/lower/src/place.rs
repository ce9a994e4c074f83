//! Places of the bound program as checked memory accesses.
//!
//! Anything proved at compile time is not checked: direct addresses inside their areas, parameters, instances. The
//! rest carries [`Check`]s for the synchronous errors of OB 121. Source: STL reference, addressing and OB 121.

use plcc_abi::codes::{access, access_area, sync};
use plcc_abi::{RuntimeFn, Type, layout};
use plcc_ir::{Address, BinaryOp, IntCc, Region, Value};
use plcc_model::{AddressRegister, Passing, Place, PlaceArea, Width};

use crate::block::BlockLowering;
use crate::fault::{Check, Substitute};

/// Pointers and address registers hold an address of 24 bits below the area code.
const ADDRESS_MASK: i64 = 0x00FF_FFFF;
/// Peripheral addresses end here.
const PERIPHERAL_BYTES: u32 = 0x1_0000;

/// Whether an access reads or writes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    Read,
    Write,
}

/// Bit number inside a byte.
#[derive(Clone, Copy)]
pub enum BitNumber {
    Known(u8),
    /// i32, 0..=7.
    Dynamic(Value),
}

/// A place, ready to be accessed once its checks hold.
pub struct Target {
    pub kind: TargetKind,
    pub checks: Vec<Check>,
}

pub enum TargetKind {
    Memory {
        addr: Address,
        bit: BitNumber,
    },
    /// Peripheral byte address, an i32.
    Peripheral {
        address: Value,
        /// For a bit: its number in the byte.
        bit: u8,
    },
    /// Area known at run time: peripheral if `is_peripheral` (i1), otherwise memory.
    Either {
        is_peripheral: Value,
        address: Value,
        addr: Address,
        bit: BitNumber,
    },
}

/// An effective address that is known at run time.
struct Effective {
    /// i32.
    byte: Value,
    /// i32, 0..=7.
    bit: Value,
}

impl Target {
    fn memory(region: Region, byte: u32, bit: u8) -> Target {
        Target::at(Address::direct(region, byte), BitNumber::Known(bit))
    }

    pub fn at(addr: Address, bit: BitNumber) -> Target {
        Target { kind: TargetKind::Memory { addr, bit }, checks: Vec::new() }
    }
}

impl BlockLowering<'_, '_> {
    /// Reads `place`: an i32, zero-extended, an i1 with width Bit, an i64 with width Lword. After a fault, the value that the error OB supplies.
    pub fn read(&mut self, place: &Place, width: Width) -> Value {
        let target = self.target(place, width, Direction::Read);
        self.read_target(target, width)
    }

    pub fn read_target(&mut self, target: Target, width: Width) -> Value {
        let (substitute, result) = match width {
            Width::Bit => (Substitute::Bit, self.result_bit),
            Width::Byte | Width::Word | Width::Dword => (Substitute::Word, self.result),
            Width::Lword => (Substitute::Long, self.result_long),
        };
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
        Check { ok, code, access, info: address }
    }

    /// Writes the low bits of `value` (an i32; an i1 with width Bit) to `place`.
    pub fn write(&mut self, place: &Place, width: Width, value: Value) {
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

    /// The access to `place`. Opens the DB of a fully qualified address.
    pub fn target(&mut self, place: &Place, width: Width, direction: Direction) -> Target {
        let mut target = match *place {
            Place::I { byte, bit } => Target::memory(Region::I, byte, bit),
            Place::Q { byte, bit } => Target::memory(Region::Q, byte, bit),
            Place::M { byte, bit } => Target::memory(Region::M, byte, bit),
            Place::L { byte, bit } => Target::memory(Region::L, byte, bit),
            Place::Pi { byte, bit } | Place::Pq { byte, bit } => {
                let address = self.b.i32_const(byte);
                Target { kind: TargetKind::Peripheral { address, bit }, checks: Vec::new() }
            }
            Place::OpenDb { byte, bit } => {
                let byte = self.b.i32_const(byte);
                self.in_open_db(PlaceArea::Db, byte, BitNumber::Known(bit), width, direction)
            }
            Place::OpenDi { byte, bit } => {
                let byte = self.b.i32_const(byte);
                self.in_open_db(PlaceArea::Di, byte, BitNumber::Known(bit), width, direction)
            }
            Place::Db { number, byte, bit } => self.in_known_db(number, byte, bit, width, direction),
            Place::Instance { byte, bit } => self.in_instance(byte, bit, width, direction),
            Place::Parameter { parameter, byte, bit } => self.in_parameter(parameter, byte, bit),
            Place::ThroughPointer { pointer, byte, bit } => {
                self.through_pointer(pointer, 8 * byte + u32::from(bit), width, direction)
            }
            Place::Indirect { area, ref pointer } => {
                let pointer = self.read(pointer, Width::Dword);
                let effective = self.effective(pointer, 0);
                self.in_area(area, effective, width, direction)
            }
            Place::Register { area, register, offset } => {
                let index = match register {
                    AddressRegister::Ar1 => 0,
                    AddressRegister::Ar2 => 1,
                };
                let pointer = self.get(self.regs.ar[index]);
                match area {
                    Some(area) => {
                        let effective = self.effective(pointer, offset);
                        self.in_area(area, effective, width, direction)
                    }
                    None => {
                        let (db, di) = (self.get(self.regs.db), self.get(self.regs.di));
                        self.area_crossing(pointer, offset, db, di, width, direction)
                    }
                }
            }
        };
        target.checks.retain(|check| self.b.constant_bits(check.ok) != Some(1));
        target
    }

    /// Address part of `pointer` plus `offset` bits. Bits carry into the byte address; 24 bits wrap.
    fn effective(&mut self, pointer: Value, offset: u32) -> Effective {
        let sum = self.b.binary_imm(BinaryOp::Iadd, pointer, i64::from(offset));
        let address = self.b.binary_imm(BinaryOp::And, sum, ADDRESS_MASK);
        Effective {
            byte: self.b.binary_imm(BinaryOp::Lshr, address, 3),
            bit: self.b.binary_imm(BinaryOp::And, address, 7),
        }
    }

    /// Number of an area in OB 121's access byte, as a value.
    fn area_number(&mut self, area: PlaceArea) -> Value {
        self.b.i32_const(u32::from(area_code(area)))
    }

    /// Access byte of OB 121.
    fn access(&mut self, width: Width, area_number: Value) -> Value {
        self.b.binary_imm(BinaryOp::Or, area_number, i64::from(access_byte(width, 0)))
    }

    /// A byte, word or double word is addressed with bit number 0.
    fn alignment_check(
        &mut self,
        effective: &Effective,
        width: Width,
        area: Value,
        direction: Direction,
    ) -> Option<Check> {
        if width == Width::Bit {
            return None;
        }
        let ok = self.b.icmp_imm(IntCc::Eq, effective.bit, 0);
        let code = if direction == Direction::Read { sync::ALIGN_READ } else { sync::ALIGN_WRITE };
        let code = self.b.i32_const(u32::from(code));
        Some(Check { ok, code, access: self.access(width, area), info: effective.byte })
    }

    /// The access byte of OB 121 for an access to `area`, as a value.
    pub fn access_of(&mut self, width: Width, area: PlaceArea) -> Value {
        self.b.i32_const(access_byte(width, area_code(area)))
    }

    /// The access to `area` at a bit address that is known at run time.
    pub fn in_area_at(&mut self, area: PlaceArea, address: Value, width: Width, direction: Direction) -> Target {
        let effective = self.effective(address, 0);
        self.in_area(area, effective, width, direction)
    }

    /// An address in `area` that is known at run time.
    fn in_area(&mut self, area: PlaceArea, effective: Effective, width: Width, direction: Direction) -> Target {
        let profile = &self.plan.program.profile;
        let (region, limit) = match area {
            PlaceArea::I => (Region::I, profile.inputs),
            PlaceArea::Q => (Region::Q, profile.outputs),
            PlaceArea::M => (Region::M, profile.bit_memory),
            PlaceArea::L => (Region::L, self.local_bytes),
            PlaceArea::Pi | PlaceArea::Pq => {
                let number = self.area_number(area);
                let mut checks = Vec::new();
                checks.extend(self.alignment_check(&effective, width, number, direction));
                let limit = self.b.i32_const(PERIPHERAL_BYTES);
                checks.push(self.length_check(effective.byte, limit, width, number, direction));
                return Target { kind: TargetKind::Peripheral { address: effective.byte, bit: 0 }, checks };
            }
            PlaceArea::Db | PlaceArea::Di => {
                let number = self.area_number(area);
                let alignment = self.alignment_check(&effective, width, number, direction);
                let bit = BitNumber::Dynamic(effective.bit);
                let mut target = self.in_open_db(area, effective.byte, bit, width, direction);
                target.checks.splice(0..0, alignment);
                return target;
            }
        };
        let number = self.area_number(area);
        let mut checks = Vec::new();
        checks.extend(self.alignment_check(&effective, width, number, direction));
        let limit = self.b.i32_const(limit);
        checks.push(self.length_check(effective.byte, limit, width, number, direction));
        let addr = Address::indexed(region, effective.byte, 0);
        Target { kind: TargetKind::Memory { addr, bit: BitNumber::Dynamic(effective.bit) }, checks }
    }

    /// The bytes from `byte` on are below `limit`.
    fn length_check(&mut self, byte: Value, limit: Value, width: Width, area: Value, direction: Direction) -> Check {
        let end = self.b.binary_imm(BinaryOp::Iadd, byte, i64::from(width.bytes()));
        let ok = self.b.icmp(IntCc::Ule, end, limit);
        let code = if direction == Direction::Read { sync::LENGTH_READ } else { sync::LENGTH_WRITE };
        let code = self.b.i32_const(u32::from(code));
        Check { ok, code, access: self.access(width, area), info: byte }
    }

    /// In the DB that is open in the DB or DI register.
    fn in_open_db(
        &mut self,
        area: PlaceArea,
        byte: Value,
        bit: BitNumber,
        width: Width,
        direction: Direction,
    ) -> Target {
        let register = if area == PlaceArea::Di { self.regs.di } else { self.regs.db };
        let number = self.get(register);
        if let Some(known) = self.b.constant_bits(number)
            && let Some(&db) = self.plan.static_db(known as u16)
            && let Some(offset) = self.b.constant_bits(byte)
            && offset as u32 + width.bytes() <= db.length
        {
            let addr = Address::direct(Region::Db(db.number), offset as u32);
            let checks = self.protection_check(number, width, area, direction).into_iter().collect();
            return Target { kind: TargetKind::Memory { addr, bit }, checks };
        }
        let length = self.b.db_length(number);
        let base = self.b.db_base(number);
        let area_number = self.area_number(area);
        let mut check = self.length_check(byte, length, width, area_number, direction);
        // No DB is open: length 0, and another error.
        let open = self.b.icmp_imm(IntCc::Ne, number, 0);
        let none = if area == PlaceArea::Di { sync::DI_NUMBER } else { sync::DB_NUMBER };
        let none = self.b.i32_const(u32::from(none));
        check.code = self.b.select(open, check.code, none);
        check.info = self.b.select(open, check.info, number);
        let mut checks = vec![check];
        checks.extend(self.protection_check(number, width, area, direction));
        let addr = match self.b.constant_bits(byte) {
            Some(offset) => Address::indexed(Region::AnyDb, base, offset as u32),
            None => Address::indexed(Region::AnyDb, self.b.iadd(base, byte), 0),
        };
        Target { kind: TargetKind::Memory { addr, bit }, checks }
    }

    /// The DB can be written.
    fn protection_check(
        &mut self,
        number: Value,
        width: Width,
        area: PlaceArea,
        direction: Direction,
    ) -> Option<Check> {
        let plan = self.plan;
        if direction == Direction::Read || plan.protected_dbs.is_empty() {
            return None;
        }
        let mut ok = self.b.bool_const(true);
        for &protected in &plan.protected_dbs {
            let other = self.b.icmp_imm(IntCc::Ne, number, i64::from(protected));
            ok = self.b.and(ok, other);
        }
        let code = if area == PlaceArea::Di { sync::WRITE_PROTECTED_DI } else { sync::WRITE_PROTECTED_DB };
        let code = self.b.i32_const(u32::from(code));
        let access = self.b.i32_const(access_byte(width, area_code(area)));
        Some(Check { ok, code, access, info: number })
    }

    /// Fully qualified: opens DB `number`, then accesses it.
    fn in_known_db(&mut self, number: u16, byte: u32, bit: u8, width: Width, direction: Direction) -> Target {
        let number_value = self.b.i32_const(u32::from(number));
        let byte_value = self.b.i32_const(byte);
        let is_static = self.plan.static_db(number).is_some();
        let loaded = if is_static {
            self.b.bool_const(true)
        } else {
            let length = self.b.db_length(number_value);
            self.b.icmp_imm(IntCc::Ne, length, 0)
        };
        // An OPN that fails does not change the register.
        let before = self.get(self.regs.db);
        let opened = self.b.select(loaded, number_value, before);
        self.set(self.regs.db, number_value);
        let mut target = self.in_open_db(PlaceArea::Db, byte_value, BitNumber::Known(bit), width, direction);
        self.set(self.regs.db, opened);
        let code = self.b.i32_const(u32::from(sync::DB_MISSING));
        let access = self.b.i32_const(access_byte(width, access_area::DB));
        target.checks.insert(0, Check { ok: loaded, code, access, info: number_value });
        target
    }

    /// In the instance of this FB: at AR2 in the DI.
    fn in_instance(&mut self, byte: u32, bit: u8, width: Width, direction: Direction) -> Target {
        match self.instance {
            Some(base) => Target::at(Address::indexed(Region::AnyDb, base, byte), BitNumber::Known(bit)),
            None => {
                let ar2 = self.get(self.regs.ar[1]);
                let effective = self.effective(ar2, 8 * byte + u32::from(bit));
                self.in_area(PlaceArea::Di, effective, width, direction)
            }
        }
    }

    /// In the target of a formal parameter of this FC.
    fn in_parameter(&mut self, parameter: usize, byte: u32, bit: u8) -> Target {
        match self.passing(parameter) {
            Passing::Elementary(Width::Bit) => {
                let reference = self.parameters[parameter][0];
                let base = self.b.binary_imm(BinaryOp::Lshr, reference, 3);
                let bit = self.b.binary_imm(BinaryOp::And, reference, 7);
                Target::at(Address::indexed(Region::Any, base, 0), BitNumber::Dynamic(bit))
            }
            Passing::Elementary(_) => {
                let base = self.parameters[parameter][0];
                Target::at(Address::indexed(Region::Any, base, byte), BitNumber::Known(bit))
            }
            Passing::Complex { .. } | Passing::OpenArray { .. } => {
                let base = self.parameters[parameter][1];
                Target::at(Address::indexed(Region::Any, base, byte), BitNumber::Known(bit))
            }
            Passing::Number | Passing::Pointer | Passing::Any | Passing::Variant => {
                let base = self.parameters[parameter][0];
                Target::at(Address::indexed(Region::V, base, byte), BitNumber::Known(bit))
            }
        }
    }

    /// In the target of the POINTER at `pointer` of this FB's instance, `offset` bits after its start.
    fn through_pointer(&mut self, pointer: u32, offset: u32, width: Width, direction: Direction) -> Target {
        let db = self.read(&Place::Instance { byte: pointer, bit: 0 }, Width::Word);
        let address = self.read(&Place::Instance { byte: pointer + 2, bit: 0 }, Width::Dword);
        let di = self.get(self.regs.di);
        self.area_crossing(address, offset, db, di, width, direction)
    }

    /// Area V below the caller's frame, the target of pointers from its callers that it passes on: whether `byte` is there
    /// (i1), and the offset from the memory base. Addresses wrap inside the L stack of the priority class.
    fn below_caller(&mut self, caller: Value, byte: Value, width: Width) -> (Value, Value) {
        let inside = i64::from(layout::L_CLASS_BYTES) - 1;
        let sum = self.b.iadd(caller, byte);
        let wrapped = self.b.binary_imm(BinaryOp::And, sum, inside);
        let stack = self.b.binary_imm(BinaryOp::And, caller, !inside);
        let address = self.b.or(stack, wrapped);
        let end = self.b.binary_imm(BinaryOp::Iadd, address, i64::from(width.bytes()));
        let is_below = self.b.icmp(IntCc::Ule, end, caller);
        (is_below, address)
    }

    /// A target in memory. A peripheral target is the error of a wrong area.
    pub fn in_memory(
        &mut self,
        target: Target,
        width: Width,
        direction: Direction,
    ) -> (Address, BitNumber, Vec<Check>) {
        let mut checks = target.checks;
        match target.kind {
            TargetKind::Memory { addr, bit } => (addr, bit, checks),
            TargetKind::Either { is_peripheral, addr, bit, .. } => {
                let code = if direction == Direction::Read { sync::AREA_READ } else { sync::AREA_WRITE };
                let code = self.b.i32_const(u32::from(code));
                let ok = self.b.not(is_peripheral);
                let access = self.b.i32_const(access_byte(width, access_area::P));
                let info = self.b.i32_const(u32::from(layout::area::P));
                checks.push(Check { ok, code, access, info });
                (addr, bit, checks)
            }
            TargetKind::Peripheral { .. } => {
                unreachable!("the binder passes no peripheral address where memory is needed")
            }
        }
    }

    /// An address whose area code is in the pointer: `W [AR1,P#0.0]`. `db` and `di` are the DBs of areas DB and DI.
    pub fn area_crossing(
        &mut self,
        pointer: Value,
        offset: u32,
        db: Value,
        di: Value,
        width: Width,
        direction: Direction,
    ) -> Target {
        use plcc_abi::layout::area;
        let code = self.b.binary_imm(BinaryOp::Lshr, pointer, 24);
        let effective = self.effective(pointer, offset);
        let frame = self.b.address_of(Address::direct(Region::L, 0));
        let caller = self.b.address_of(Address::direct(Region::V, 0));
        let caller_bytes = self.b.isub(frame, caller);
        let (db_base, di_base) = (self.b.db_base(db), self.b.db_base(di));
        let (db_length, di_length) = (self.b.db_length(db), self.b.db_length(di));
        let profile = &self.plan.program.profile;
        let mut constant = |value: u32| self.b.i32_const(value);
        let rows = [
            (area::I, constant(layout::I), constant(profile.inputs)),
            (area::Q, constant(layout::Q), constant(profile.outputs)),
            (area::M, constant(layout::M), constant(profile.bit_memory)),
            (area::DB, db_base, db_length),
            (area::DI, di_base, di_length),
            (area::L, frame, constant(self.local_bytes)),
            (area::V, caller, caller_bytes),
        ];
        let peripheral_limit = constant(PERIPHERAL_BYTES);
        let is_peripheral = self.b.icmp_imm(IntCc::Eq, code, i64::from(area::P));
        let mut known = is_peripheral;
        let (mut base, mut limit) = (constant_zero(self), peripheral_limit);
        for (area, area_base, area_limit) in rows {
            let is_area = self.b.icmp_imm(IntCc::Eq, code, i64::from(area));
            known = self.b.or(known, is_area);
            base = self.b.select(is_area, area_base, base);
            limit = self.b.select(is_area, area_limit, limit);
        }
        let below = self.plan.hands_on_pointers.then(|| {
            let is_local = self.b.icmp_imm(IntCc::Eq, code, i64::from(area::V));
            let (is_below, address) = self.below_caller(caller, effective.byte, width);
            let is_below = self.b.and(is_local, is_below);
            let stack = self.b.i32_const(layout::L_CLASS_BYTES);
            limit = self.b.select(is_below, stack, limit);
            (is_below, address)
        });
        if width == Width::Bit {
            // The peripheral area has no bits.
            let not_peripheral = self.b.not(is_peripheral);
            known = self.b.and(known, not_peripheral);
        }
        let wrong_area = if direction == Direction::Read { sync::AREA_READ } else { sync::AREA_WRITE };
        let wrong_area = self.b.i32_const(u32::from(wrong_area));
        // The numbers of OB 121's areas are the low bits of the pointers' area codes.
        let area_number = self.b.binary_imm(BinaryOp::And, code, 7);
        let mut checks =
            vec![Check { ok: known, code: wrong_area, access: self.access(width, area_number), info: code }];
        checks.extend(self.alignment_check(&effective, width, area_number, direction));
        checks.push(self.length_check(effective.byte, limit, width, area_number, direction));
        if direction == Direction::Write && !self.plan.protected_dbs.is_empty() {
            for (area, place_area, number) in [(area::DB, PlaceArea::Db, db), (area::DI, PlaceArea::Di, di)] {
                let elsewhere = self.b.icmp_imm(IntCc::Ne, code, i64::from(area));
                if let Some(mut check) = self.protection_check(number, width, place_area, direction) {
                    check.ok = self.b.or(check.ok, elsewhere);
                    checks.push(check);
                }
            }
        }
        let address = self.b.iadd(base, effective.byte);
        let address = match below {
            Some((is_below, below)) => self.b.select(is_below, below, address),
            None => address,
        };
        let addr = Address::indexed(Region::Any, address, 0);
        let bit = BitNumber::Dynamic(effective.bit);
        let kind = match self.b.constant_bits(is_peripheral) {
            Some(0) => TargetKind::Memory { addr, bit },
            _ if width == Width::Bit => TargetKind::Memory { addr, bit },
            Some(_) => TargetKind::Peripheral { address: effective.byte, bit: 0 },
            None => TargetKind::Either { is_peripheral, address: effective.byte, addr, bit },
        };
        Target { kind, checks }
    }
}

fn constant_zero(lowering: &mut BlockLowering<'_, '_>) -> Value {
    lowering.b.i32_const(0)
}

/// Type of an access in memory.
pub fn width_type(width: Width) -> Type {
    match width {
        Width::Bit => Type::I1,
        Width::Byte => Type::I8,
        Width::Word => Type::I16,
        Width::Dword => Type::I32,
        Width::Lword => Type::I64,
    }
}

/// Access byte of OB 121.
fn access_byte(width: Width, area: u8) -> u32 {
    let width = match width {
        Width::Bit => access::BIT,
        Width::Byte => access::BYTE,
        Width::Word => access::WORD,
        Width::Dword | Width::Lword => access::DWORD,
    };
    u32::from(width | area)
}

fn area_code(area: PlaceArea) -> u8 {
    match area {
        PlaceArea::I => access_area::I,
        PlaceArea::Q => access_area::Q,
        PlaceArea::M => access_area::M,
        PlaceArea::Pi | PlaceArea::Pq => access_area::P,
        PlaceArea::L => access_area::L,
        PlaceArea::Db => access_area::DB,
        PlaceArea::Di => access_area::DI,
    }
}
