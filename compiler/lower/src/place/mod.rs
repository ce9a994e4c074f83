//! Places of the bound program as checked memory accesses.
//!
//! Anything proved at compile time is not checked: direct addresses inside their areas, parameters, instances. The
//! rest carries [`Check`]s for the synchronous errors of OB 121. Source: STL reference, addressing and OB 121.
//!
//! - `area`: addresses in one area; `crossing`: those whose area is in a pointer.
//! - `element`: elements of arrays with a variable index.
//! - `reference`: variables that IN_OUT parameters refer to; `transfer`: reads and writes.

mod area;
pub mod crossing;
mod element;
pub mod reference;
mod transfer;

use plcc_abi::codes::{access, access_area, sync};
use plcc_abi::{Type, layout};
use plcc_ir::{Address, BinaryOp, Region, Value};
use plcc_model::{CodeBlock, Passing, Place, PlaceArea, Width};

use crate::block::BlockLowering;
use crate::fault::Check;

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
    /// Bit 0 of a byte whose other bits mean nothing.
    Alone,
    /// i32, 0..=7.
    Dynamic(Value),
}

impl BitNumber {
    /// Of a bit in the instance of a block.
    pub fn of(block: &CodeBlock, byte: u32, bit: u8) -> BitNumber {
        if block.is_alone(byte, bit) { BitNumber::Alone } else { BitNumber::Known(bit) }
    }
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

impl Target {
    fn memory(region: Region, byte: u32, bit: u8) -> Target {
        Target::at(Address::direct(region, byte), BitNumber::Known(bit))
    }

    pub fn at(addr: Address, bit: BitNumber) -> Target {
        Target { kind: TargetKind::Memory { addr, bit }, checks: Vec::new() }
    }
}

impl BlockLowering<'_, '_> {
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
            Place::ThroughPointer { .. } | Place::Register { area: None, .. } => {
                let crossing = self.crossing_of(place).expect("its area is in a pointer");
                self.area_crossing(&crossing, width, direction)
            }
            Place::Indirect { area, ref pointer } => {
                let pointer = self.read(pointer, Width::Dword);
                let effective = self.effective(pointer, 0);
                self.in_area(area, effective, width, direction)
            }
            Place::Register { area: Some(area), register, offset } => {
                let pointer = self.get(self.address_register(register));
                let effective = self.effective(pointer, offset);
                self.in_area(area, effective, width, direction)
            }
            Place::Element { ref base, ref indices } => self.element_target(base, indices, width, direction),
        };
        target.checks.retain(|check| self.b.constant_bits(check.ok) != Some(1));
        target
    }

    /// In the instance of this FB: at AR2 in the DI.
    fn in_instance(&mut self, byte: u32, bit: u8, width: Width, direction: Direction) -> Target {
        match self.instance {
            Some(base) => Target::at(Address::indexed(Region::AnyDb, base, byte), BitNumber::of(self.block, byte, bit)),
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
                checks.push(Check { ok, code, access, info, db: None });
                (addr, bit, checks)
            }
            TargetKind::Peripheral { .. } => {
                unreachable!("the binder passes no peripheral address where memory is needed")
            }
        }
    }
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
