//! Addresses whose area is in the pointer: area-crossing, register-indirect addressing and POINTER.

use plcc_abi::codes::sync;
use plcc_abi::layout::{self, area};
use plcc_ir::{Address, BinaryOp, InstData, IntCc, Region, Type, Value};
use plcc_model::{Place, PlaceArea, Width};

use super::area::PERIPHERAL_BYTES;
use super::{BitNumber, Direction, Target, TargetKind};
use crate::block::BlockLowering;

/// The codes of all areas.
const AREAS: [u8; 8] = [area::P, area::I, area::Q, area::M, area::DB, area::DI, area::L, area::V];

/// A pointer with its area: `W [AR1,P#0.0]`, or a POINTER.
#[derive(Clone, Copy)]
pub struct Crossing {
    pub pointer: Value,
    /// Bits after its target.
    pub offset: u32,
    /// The DBs of areas DB and DI.
    pub db: Value,
    pub di: Value,
}

impl BlockLowering<'_, '_> {
    /// The pointer of a place whose area is in it.
    pub(super) fn crossing_of(&mut self, place: &Place) -> Option<Crossing> {
        match *place {
            // In the target of a POINTER of this FB's instance.
            Place::ThroughPointer { pointer, byte, bit } => {
                let (db, address) = self.pointer_in_instance(pointer);
                let di = self.get(self.regs.di);
                Some(Crossing { pointer: address, offset: 8 * byte + u32::from(bit), db, di })
            }
            Place::Register { area: None, register, offset } => {
                let pointer = self.get(self.address_register(register));
                let (db, di) = (self.get(self.regs.db), self.get(self.regs.di));
                Some(Crossing { pointer, offset, db, di })
            }
            _ => None,
        }
    }

    /// As [`crossing_of`](Self::crossing_of), if the area is only known at run time.
    pub(super) fn crossing(&mut self, place: &Place) -> Option<Crossing> {
        let crossing = self.crossing_of(place)?;
        let function = self.b.function();
        let pointer = function.resolve(crossing.pointer);
        // An address that was put together with its area: a formal parameter.
        let with_area = match function.defining(pointer) {
            Some(InstData::Binary { op: BinaryOp::Or, args: [_, area] }) => *area,
            _ => pointer,
        };
        function.constant(with_area).is_none().then_some(crossing)
    }

    /// Accesses the target of a pointer. In the usual areas it names its region, so that it touches nothing else; `access` is done
    /// once for each of them, and on a cold way for all other areas and for faults.
    pub(super) fn by_area(
        &mut self,
        crossing: &Crossing,
        width: Width,
        direction: Direction,
        access: &mut dyn FnMut(&mut Self, Target),
    ) {
        let (other, join) = (self.b.create_cold_block(), self.b.create_block());
        let code = self.b.binary_imm(BinaryOp::Lshr, crossing.pointer, 24);
        let effective = self.effective(crossing.pointer, crossing.offset);
        let end = self.b.binary_imm(BinaryOp::Iadd, effective.byte, i64::from(width.bytes()));
        let aligned = (width != Width::Bit).then(|| self.b.icmp_imm(IntCc::Eq, effective.bit, 0));
        let areas = [area::DB, area::M, area::Q, area::I];
        for (number, area) in (1..).zip(areas) {
            let (is_area, good) = (self.b.create_block(), self.b.create_block());
            let next = if number < areas.len() { self.b.create_block() } else { other };
            let matches = self.b.icmp_imm(IntCc::Eq, code, i64::from(area));
            self.b.branch(matches, is_area, next);
            self.b.seal_block(is_area);
            if next != other {
                self.b.seal_block(next);
            }
            self.b.switch_to(is_area);
            let (base, limit) = self.extent_of(area, (crossing.db, crossing.di));
            let mut ok = self.b.icmp(IntCc::Ule, end, limit);
            if let Some(aligned) = aligned {
                ok = self.b.and(ok, aligned);
            }
            let mut addr = Address::indexed(Region::M, effective.byte, 0);
            match area {
                area::DB => {
                    addr = Address::indexed(Region::AnyDb, self.b.iadd(base, effective.byte), 0);
                    if let Some(check) = self.protection_check(crossing.db, width, PlaceArea::Db, direction) {
                        ok = self.b.and(ok, check.ok);
                    }
                }
                area::Q => addr.region = Region::Q,
                area::I => addr.region = Region::I,
                _ => {}
            }
            self.b.branch(ok, good, other);
            self.b.seal_block(good);
            self.b.switch_to(good);
            access(self, Target::at(addr, BitNumber::Dynamic(effective.bit)));
            self.b.jump(join, &[]);
            if next == other {
                self.b.seal_block(other);
            }
            self.b.switch_to(next);
        }
        let target = self.area_crossing(crossing, width, direction);
        access(self, target);
        self.b.jump(join, &[]);
        self.b.seal_block(join);
        self.b.switch_to(join);
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

    /// The target of a pointer, in whatever area it is.
    pub fn area_crossing(&mut self, crossing: &Crossing, width: Width, direction: Direction) -> Target {
        let Crossing { pointer, offset, db, di } = *crossing;
        let code = self.b.binary_imm(BinaryOp::Lshr, pointer, 24);
        let effective = self.effective(pointer, offset);
        let (base, limit) = match self.b.constant_bits(code) {
            Some(_) => self.area_by_selects(&AREAS, code, effective.byte, (db, di), width),
            None => self.area_by_branches(code, effective.byte, (db, di), width),
        };
        let is_peripheral = self.b.icmp_imm(IntCc::Eq, code, i64::from(area::P));
        // Area codes are next to each other. The peripheral area has no bits.
        let first = if width == Width::Bit { area::P + 1 } else { area::P };
        let number = self.b.binary_imm(BinaryOp::Isub, code, i64::from(first));
        let known = self.b.icmp_imm(IntCc::Ule, number, i64::from(area::V - first));
        let wrong_area = if direction == Direction::Read { sync::AREA_READ } else { sync::AREA_WRITE };
        let wrong_area = self.b.i32_const(u32::from(wrong_area));
        // The numbers of OB 121's areas are the low bits of the pointers' area codes.
        let area_number = self.b.binary_imm(BinaryOp::And, code, 7);
        let mut checks = Vec::new();
        checks.extend(self.alignment_check(&effective, width, area_number, direction));
        checks.push(self.length_check(effective.byte, limit, width, area_number, direction));
        // An unknown area has length 0, so that one of these checks fails; its error goes first.
        for check in &mut checks {
            check.code = self.b.select(known, check.code, wrong_area);
            check.info = self.b.select(known, check.info, code);
        }
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

    /// Base and limit of the area of a pointer: most point into DBs and bit memory, so these are tried first.
    fn area_by_branches(&mut self, code: Value, byte: Value, dbs: (Value, Value), width: Width) -> (Value, Value) {
        let join = self.b.create_block();
        let (base, limit) = (self.b.append_param(join, Type::I32), self.b.append_param(join, Type::I32));
        for area in [area::DB, area::M] {
            let (is_area, other) = (self.b.create_block(), self.b.create_block());
            let matches = self.b.icmp_imm(IntCc::Eq, code, i64::from(area));
            self.b.branch(matches, is_area, other);
            self.b.seal_block(is_area);
            self.b.seal_block(other);
            self.b.switch_to(is_area);
            let (base, limit) = self.extent_of(area, dbs);
            self.b.jump(join, &[base, limit]);
            self.b.switch_to(other);
        }
        let others = [area::P, area::I, area::Q, area::DI, area::L, area::V];
        let (other_base, other_limit) = self.area_by_selects(&others, code, byte, dbs, width);
        self.b.jump(join, &[other_base, other_limit]);
        self.b.seal_block(join);
        self.b.switch_to(join);
        (base, limit)
    }

    /// As [`area_by_branches`](Self::area_by_branches), among `areas`; for another area the limit is 0.
    fn area_by_selects(
        &mut self,
        areas: &[u8],
        code: Value,
        byte: Value,
        dbs: (Value, Value),
        width: Width,
    ) -> (Value, Value) {
        let zero = self.b.i32_const(0);
        let (mut base, mut limit) = (zero, zero);
        for &area in areas {
            let (area_base, area_limit) = self.extent_of(area, dbs);
            let area_limit = if area == area::P && width == Width::Bit { zero } else { area_limit };
            let is_area = self.b.icmp_imm(IntCc::Eq, code, i64::from(area));
            base = self.b.select(is_area, area_base, base);
            limit = self.b.select(is_area, area_limit, limit);
        }
        if self.plan.hands_on_pointers {
            let is_local = self.b.icmp_imm(IntCc::Eq, code, i64::from(area::V));
            let caller = self.b.address_of(Address::direct(Region::V, 0));
            let (is_below, address) = self.below_caller(caller, byte, width);
            let is_below = self.b.and(is_local, is_below);
            let stack = self.b.i32_const(layout::L_CLASS_BYTES);
            limit = self.b.select(is_below, stack, limit);
            let below = self.b.isub(address, byte);
            base = self.b.select(is_below, below, base);
        }
        (base, limit)
    }

    /// Where an area begins, as offset from the memory base, and its length. `dbs`: the DBs of areas DB and DI.
    fn extent_of(&mut self, area: u8, dbs: (Value, Value)) -> (Value, Value) {
        let profile = &self.plan.program.profile;
        let (base, limit) = match area {
            area::I => (layout::I, profile.inputs),
            area::Q => (layout::Q, profile.outputs),
            area::M => (layout::M, profile.bit_memory),
            area::DB => return (self.b.db_base(dbs.0), self.b.db_length(dbs.0)),
            area::DI => return (self.b.db_base(dbs.1), self.b.db_length(dbs.1)),
            area::L => {
                let frame = self.b.address_of(Address::direct(Region::L, 0));
                return (frame, self.b.i32_const(self.local_bytes));
            }
            area::V => {
                let frame = self.b.address_of(Address::direct(Region::L, 0));
                let caller = self.b.address_of(Address::direct(Region::V, 0));
                return (caller, self.b.isub(frame, caller));
            }
            _ => (0, PERIPHERAL_BYTES),
        };
        (self.b.i32_const(base), self.b.i32_const(limit))
    }
}
