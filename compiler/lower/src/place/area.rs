//! Addresses in one area, with their checks.

use plcc_abi::codes::{access_area, fault_info, sync};
use plcc_ir::{Address, BinaryOp, IntCc, Region, Value};
use plcc_model::{PlaceArea, Width};

use super::{BitNumber, Direction, Target, TargetKind, access_byte, area_code};
use crate::block::BlockLowering;
use crate::fault::Check;

/// Pointers and address registers hold an address of 24 bits below the area code.
const ADDRESS_MASK: i64 = 0x00FF_FFFF;
/// Peripheral addresses end here.
pub(super) const PERIPHERAL_BYTES: u32 = 0x1_0000;

/// An effective address that is known at run time.
pub(super) struct Effective {
    /// i32.
    pub byte: Value,
    /// i32, 0..=7.
    pub bit: Value,
}

impl BlockLowering<'_, '_> {
    /// Address part of `pointer` plus `offset` bits. Bits carry into the byte address; 24 bits wrap.
    pub(super) fn effective(&mut self, pointer: Value, offset: u32) -> Effective {
        let sum = self.b.binary_imm(BinaryOp::Iadd, pointer, i64::from(offset));
        let address = self.b.binary_imm(BinaryOp::And, sum, ADDRESS_MASK);
        Effective {
            byte: self.b.binary_imm(BinaryOp::Lshr, address, 3),
            bit: self.b.binary_imm(BinaryOp::And, address, 7),
        }
    }

    /// Number of an area in OB 121's access byte, as a value.
    pub(super) fn area_number(&mut self, area: PlaceArea) -> Value {
        self.b.i32_const(u32::from(area_code(area)))
    }

    /// Access byte of OB 121.
    pub(super) fn access(&mut self, width: Width, area_number: Value) -> Value {
        self.b.binary_imm(BinaryOp::Or, area_number, i64::from(access_byte(width, 0)))
    }

    /// A byte, word or double word is addressed with bit number 0.
    pub(super) fn alignment_check(
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
        Some(Check { ok, code, access: self.access(width, area), info: effective.byte, db: None })
    }

    /// The access byte of OB 121 for an access to `area`, as a value.
    pub fn access_of(&mut self, width: Width, area: PlaceArea) -> Value {
        self.access_about(width, area, fault_info::ADDRESS)
    }

    /// The same with the word of [`fault_info`] for what the information of the error is.
    pub fn access_about(&mut self, width: Width, area: PlaceArea, form: u32) -> Value {
        self.b.i32_const(access_byte(width, area_code(area)) | form)
    }

    /// The access to `area` at a bit address that is known at run time.
    pub fn in_area_at(&mut self, area: PlaceArea, address: Value, width: Width, direction: Direction) -> Target {
        let effective = self.effective(address, 0);
        self.in_area(area, effective, width, direction)
    }

    /// An address in `area` that is known at run time.
    pub(super) fn in_area(
        &mut self,
        area: PlaceArea,
        effective: Effective,
        width: Width,
        direction: Direction,
    ) -> Target {
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
    pub(super) fn length_check(
        &mut self,
        byte: Value,
        limit: Value,
        width: Width,
        area: Value,
        direction: Direction,
    ) -> Check {
        let end = self.b.binary_imm(BinaryOp::Iadd, byte, i64::from(width.bytes()));
        let ok = self.b.icmp(IntCc::Ule, end, limit);
        let code = if direction == Direction::Read { sync::LENGTH_READ } else { sync::LENGTH_WRITE };
        let code = self.b.i32_const(u32::from(code));
        Check { ok, code, access: self.access(width, area), info: byte, db: None }
    }

    /// In the DB that is open in the DB or DI register.
    pub(super) fn in_open_db(
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
        check.db = Some(number);
        let mut checks = vec![check];
        checks.extend(self.protection_check(number, width, area, direction));
        let addr = match self.b.constant_bits(byte) {
            Some(offset) => Address::indexed(Region::AnyDb, base, offset as u32),
            None => Address::indexed(Region::AnyDb, self.b.iadd(base, byte), 0),
        };
        Target { kind: TargetKind::Memory { addr, bit }, checks }
    }

    /// The DB can be written.
    pub(super) fn protection_check(
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
        Some(Check { ok, code, access, info: number, db: None })
    }

    /// Fully qualified: opens DB `number`, then accesses it.
    pub(super) fn in_known_db(
        &mut self,
        number: u16,
        byte: u32,
        bit: u8,
        width: Width,
        direction: Direction,
    ) -> Target {
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
        target.checks.insert(0, Check { ok: loaded, code, access, info: number_value, db: None });
        target
    }
}
