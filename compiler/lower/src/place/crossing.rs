//! Addresses whose area is in the pointer: area-crossing, register-indirect addressing and POINTER.

use plcc_abi::codes::sync;
use plcc_abi::layout;
use plcc_ir::{Address, BinaryOp, IntCc, Region, Value};
use plcc_model::{Place, PlaceArea, Width};

use super::area::PERIPHERAL_BYTES;
use super::{BitNumber, Direction, Target, TargetKind};
use crate::block::BlockLowering;
use crate::fault::Check;

impl BlockLowering<'_, '_> {
    /// In the target of the POINTER at `pointer` of this FB's instance, `offset` bits after its start.
    pub(super) fn through_pointer(&mut self, pointer: u32, offset: u32, width: Width, direction: Direction) -> Target {
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
