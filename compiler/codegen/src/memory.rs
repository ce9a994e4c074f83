//! Accesses to PLC memory.
//!
//! A region is a constant distance from the memory base, except local data, which is a distance from a frame address.
//! PLC areas are big-endian: a load or store of more than one byte goes with a byte swap; the CPU state and the DB
//! table are in the byte order of the host. No access traps: ranges are checked where the IR is built.
//!
//! Cranelift is informed of accesses that cannot overlap. Its alias regions are disjoint, while an access of `Region::Any` may
//! touch every area; so in a function that has one, all areas are one alias region. The CPU state and the DB table
//! are never reached through an area.

use std::borrow::Cow;

use cranelift_codegen::ir::{AliasRegion, AliasRegionData, InstBuilder, MemFlagsData, Type as ClifType, Value, types};
use cranelift_codegen::isa::TargetFrontendConfig;
use cranelift_frontend::FunctionBuilder;
use plcc_abi::layout::state;
use plcc_abi::{Type, layout};
use plcc_ir::{Function, Module, Region};

use crate::CodegenError;
use crate::abi::clif_type;
use crate::bits::Bit;

/// Clearing and copying up to this many bytes is done with inline stores.
const INLINE_BYTES_MAX: u32 = 128;

/// Sets of bytes: two different ones have no byte in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum AliasClass {
    State,
    DbTable,
    /// All PLC areas, in a function that reaches memory through pointers.
    Everything,
    I,
    Q,
    M,
    System,
    L,
    V,
    Dbs,
    Cells,
}

impl AliasClass {
    const ALL: [AliasClass; 11] = [
        AliasClass::State,
        AliasClass::DbTable,
        AliasClass::Everything,
        AliasClass::I,
        AliasClass::Q,
        AliasClass::M,
        AliasClass::System,
        AliasClass::L,
        AliasClass::V,
        AliasClass::Dbs,
        AliasClass::Cells,
    ];

    fn name(self) -> &'static str {
        match self {
            AliasClass::State => "cpu state",
            AliasClass::DbTable => "db table",
            AliasClass::Everything => "plc memory",
            AliasClass::I => "inputs",
            AliasClass::Q => "outputs",
            AliasClass::M => "bit memory",
            AliasClass::System => "system area",
            AliasClass::Cells => "timers and counters",
            AliasClass::L => "local data",
            AliasClass::V => "local data of the caller",
            AliasClass::Dbs => "data blocks",
        }
    }
}

/// An address with a known base: `pointer + offset`.
#[derive(Clone, Copy, Debug)]
struct Place {
    pointer: Value,
    offset: i32,
    flags: MemFlagsData,
    big_endian: bool,
}

/// An address of the IR with its base as CLIF value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Address {
    pub region: Region,
    pub base: Option<Value>,
    pub offset: u32,
}

/// The attention flag, which another thread sets: each look at it reads it, or a loop that does nothing else would never see it.
fn is_attention(addr: Address) -> bool {
    addr == Address { region: Region::State, base: None, offset: state::ATTENTION }
}

/// How one function reaches memory.
pub struct Memory<'m> {
    pub module: &'m Module,
    /// The memory base.
    pub mem: Value,
    /// Address of the function's L frame, and of its caller's, if it is given them.
    pub frame: Option<Value>,
    pub caller_frame: Option<Value>,
    alias_regions: Vec<AliasRegion>,
    has_any: bool,
}

impl<'m> Memory<'m> {
    pub fn new(
        b: &mut FunctionBuilder<'_>,
        module: &'m Module,
        function: &Function,
        mem: Value,
        frame: Option<Value>,
        caller_frame: Option<Value>,
    ) -> Memory<'m> {
        let alias_regions = AliasClass::ALL
            .iter()
            .map(|&class| {
                let description = Cow::Borrowed(class.name());
                b.func.dfg.alias_regions.insert(AliasRegionData { user_id: class as u32, description })
            })
            .collect();
        Memory { module, mem, frame, caller_frame, alias_regions, has_any: uses_any(function) }
    }

    fn flags(&self, class: AliasClass) -> MemFlagsData {
        MemFlagsData::new().with_notrap().with_alias_region(Some(self.alias_regions[class as usize]))
    }

    fn region_flags(&self, region: Region) -> MemFlagsData {
        let class = match region {
            Region::State => AliasClass::State,
            Region::Cells => AliasClass::Cells,
            _ if self.has_any => AliasClass::Everything,
            Region::I => AliasClass::I,
            Region::Q => AliasClass::Q,
            Region::M => AliasClass::M,
            Region::System => AliasClass::System,
            Region::L => AliasClass::L,
            Region::V => AliasClass::V,
            Region::Db(_) | Region::AnyDb => AliasClass::Dbs,
            Region::Any => AliasClass::Everything,
        };
        self.flags(class)
    }

    /// Distance of `region` from the memory base, or from the frame for local data.
    fn region_offset(&self, region: Region) -> Result<u32, CodegenError> {
        Ok(match region {
            Region::State => layout::STATE,
            Region::I => layout::I,
            Region::Q => layout::Q,
            Region::M => layout::M,
            Region::System => layout::SYSTEM,
            Region::Cells => layout::T,
            Region::L | Region::V | Region::AnyDb | Region::Any => 0,
            Region::Db(number) => match self.module.db(number) {
                Some(db) => db.address,
                None => return Err(invalid(format!("DB {number} is not in the module"))),
            },
        })
    }

    /// The base of offsets in `region`.
    fn region_pointer(&self, region: Region) -> Value {
        match region {
            Region::L => self.frame.expect("a function that touches its frame is given it"),
            Region::V => self.caller_frame.expect("a function that touches its caller's frame is given it"),
            Region::State
            | Region::I
            | Region::Q
            | Region::M
            | Region::System
            | Region::Cells
            | Region::Db(_)
            | Region::AnyDb
            | Region::Any => self.mem,
        }
    }

    fn place(&self, b: &mut FunctionBuilder<'_>, addr: Address) -> Result<Place, CodegenError> {
        let mut pointer = self.region_pointer(addr.region);
        if let Some(base) = addr.base {
            let wide = b.ins().uextend(types::I64, base);
            pointer = b.ins().iadd(pointer, wide);
        }
        let offset = u64::from(self.region_offset(addr.region)?) + u64::from(addr.offset);
        let (pointer, offset) = match i32::try_from(offset) {
            // Room for the chunks of a copy after it.
            Ok(offset) if offset < i32::MAX - INLINE_BYTES_MAX as i32 => (pointer, offset),
            _ => (b.ins().iadd_imm_s(pointer, offset as i64), 0),
        };
        let flags = self.region_flags(addr.region);
        Ok(Place { pointer, offset, flags, big_endian: !addr.region.is_host_order() })
    }

    /// Reads a value of type `ty`, not i1.
    pub fn load(&self, b: &mut FunctionBuilder<'_>, ty: Type, addr: Address) -> Result<Value, CodegenError> {
        let place = self.place(b, addr)?;
        let clif = clif_type(ty);
        if is_attention(addr) {
            let at = match place.offset {
                0 => place.pointer,
                offset => b.ins().iadd_imm_s(place.pointer, i64::from(offset)),
            };
            return Ok(b.ins().atomic_load(clif, place.flags, at));
        }
        if !place.big_endian || ty.bytes() == 1 {
            return Ok(b.ins().load(clif, place.flags, place.pointer, place.offset));
        }
        let raw = b.ins().load(integer_of(clif), place.flags, place.pointer, place.offset);
        let value = b.ins().bswap(raw);
        Ok(if clif.is_float() { b.ins().bitcast(clif, MemFlagsData::new(), value) } else { value })
    }

    /// Reads a byte as an I64.
    pub fn load_extended(&self, b: &mut FunctionBuilder<'_>, addr: Address) -> Result<Value, CodegenError> {
        let place = self.place(b, addr)?;
        Ok(b.ins().uload8(types::I64, place.flags, place.pointer, place.offset))
    }

    /// Reads a whole number of more than one byte with its bytes as they are in PLC memory. `None`: they are in the order of the host there.
    pub fn load_swapped(
        &self,
        b: &mut FunctionBuilder<'_>,
        ty: Type,
        addr: Address,
    ) -> Result<Option<Value>, CodegenError> {
        if addr.region.is_host_order() {
            return Ok(None);
        }
        let place = self.place(b, addr)?;
        Ok(Some(b.ins().load(clif_type(ty), place.flags, place.pointer, place.offset)))
    }

    /// Writes a whole number of more than one byte whose bytes are as they are in PLC memory.
    pub fn store_swapped(&self, b: &mut FunctionBuilder<'_>, addr: Address, raw: Value) -> Result<(), CodegenError> {
        let place = self.place(b, addr)?;
        let value = if place.big_endian { raw } else { b.ins().bswap(raw) };
        b.ins().store(place.flags, value, place.pointer, place.offset);
        Ok(())
    }

    /// Writes a value that is not an i1.
    pub fn store(
        &self,
        b: &mut FunctionBuilder<'_>,
        addr: Address,
        ty: Type,
        value: Value,
    ) -> Result<(), CodegenError> {
        let place = self.place(b, addr)?;
        let clif = clif_type(ty);
        let mut value = value;
        if place.big_endian && ty.bytes() > 1 {
            if clif.is_float() {
                value = b.ins().bitcast(integer_of(clif), MemFlagsData::new(), value);
            }
            value = b.ins().bswap(value);
        }
        b.ins().store(place.flags, value, place.pointer, place.offset);
        Ok(())
    }

    /// Writes the constant `bits` of type `ty`, not i1; the byte swap is done here.
    pub fn store_constant(
        &self,
        b: &mut FunctionBuilder<'_>,
        addr: Address,
        ty: Type,
        bits: u64,
    ) -> Result<(), CodegenError> {
        let place = self.place(b, addr)?;
        let bits = if place.big_endian { bits.swap_bytes() >> (64 - ty.bits()) } else { bits };
        let value = constant(b, integer_of(clif_type(ty)), bits);
        b.ins().store(place.flags, value, place.pointer, place.offset);
        Ok(())
    }

    pub fn load_bit(&self, b: &mut FunctionBuilder<'_>, addr: Address, bit: u8) -> Result<Bit, CodegenError> {
        let place = self.place(b, addr)?;
        Ok(Bit::Of(b.ins().load(types::I8, place.flags, place.pointer, place.offset), bit))
    }

    pub fn store_bit(
        &self,
        b: &mut FunctionBuilder<'_>,
        addr: Address,
        bit: u8,
        value: BitValue,
    ) -> Result<(), CodegenError> {
        let place = self.place(b, addr)?;
        let mask = 1u8 << bit;
        let old = b.ins().load(types::I8, place.flags, place.pointer, place.offset);
        let new = match value {
            BitValue::Constant(true) => b.ins().bor_imm_u(old, i64::from(mask)),
            BitValue::Constant(false) => b.ins().band_imm_u(old, i64::from(!mask)),
            BitValue::Variable(value) => {
                let others = b.ins().band_imm_u(old, i64::from(!mask));
                let placed = value.placed(b, types::I8, bit);
                b.ins().bor(others, placed)
            }
        };
        b.ins().store(place.flags, new, place.pointer, place.offset);
        Ok(())
    }

    /// Distance of `addr` from the memory base, an i32.
    pub fn address_of(&self, b: &mut FunctionBuilder<'_>, addr: Address) -> Result<Value, CodegenError> {
        let offset = self.region_offset(addr.region)?.wrapping_add(addr.offset);
        let start = match addr.region {
            Region::L | Region::V => {
                let pointer = self.region_pointer(addr.region);
                Some(self.offset_of(b, pointer))
            }
            Region::State
            | Region::I
            | Region::Q
            | Region::M
            | Region::System
            | Region::Cells
            | Region::Db(_)
            | Region::AnyDb
            | Region::Any => None,
        };
        let sum = match (start, addr.base) {
            (Some(start), Some(base)) => b.ins().iadd(start, base),
            (Some(value), None) | (None, Some(value)) => value,
            (None, None) => return Ok(constant(b, types::I32, u64::from(offset))),
        };
        Ok(if offset == 0 { sum } else { b.ins().iadd_imm_s(sum, i64::from(offset as i32)) })
    }

    /// Distance of an address from the memory base, an i32.
    pub fn offset_of(&self, b: &mut FunctionBuilder<'_>, pointer: Value) -> Value {
        let distance = b.ins().isub(pointer, self.mem);
        b.ins().ireduce(types::I32, distance)
    }

    /// A field of the entry of DB `number` in the DB table: its offset (0) or its length (4).
    pub fn db_table(&self, b: &mut FunctionBuilder<'_>, number: Value, field: u32) -> Value {
        let wide = b.ins().uextend(types::I64, number);
        let scaled = b.ins().ishl_imm_u(wide, i64::from(layout::DB_TABLE_ENTRY_BYTES.ilog2()));
        let entry = b.ins().iadd(self.mem, scaled);
        b.ins().load(types::I32, self.flags(AliasClass::DbTable), entry, (layout::DB_TABLE + field) as i32)
    }

    /// As [`Memory::db_table`] for a number known at compile time.
    pub fn db_table_at(&self, b: &mut FunctionBuilder<'_>, number: u16, field: u32) -> Value {
        let offset = layout::db_table_entry(number) + field;
        b.ins().load(types::I32, self.flags(AliasClass::DbTable), self.mem, offset as i32)
    }

    /// Reads or writes a slot of the CPU state by its offset from the memory base.
    pub fn load_state(&self, b: &mut FunctionBuilder<'_>, ty: ClifType, offset: u32) -> Value {
        b.ins().load(ty, self.flags(AliasClass::State), self.mem, offset as i32)
    }

    pub fn store_state(&self, b: &mut FunctionBuilder<'_>, value: Value, offset: u32) {
        b.ins().store(self.flags(AliasClass::State), value, self.mem, offset as i32);
    }

    /// Sets `len` bytes to 0.
    pub fn clear(
        &self,
        b: &mut FunctionBuilder<'_>,
        config: TargetFrontendConfig,
        addr: Address,
        len: u32,
    ) -> Result<(), CodegenError> {
        let place = self.place(b, addr)?;
        if len > INLINE_BYTES_MAX {
            let start = b.ins().iadd_imm_s(place.pointer, i64::from(place.offset));
            let zero = b.ins().iconst(types::I8, 0);
            let size = b.ins().iconst(config.pointer_type(), i64::from(len));
            b.call_memset(config, start, zero, size);
            return Ok(());
        }
        for (ty, at) in chunks(len) {
            let zero = if ty == types::I8X16 {
                let bytes = b.func.dfg.constants.insert([0u8; 16][..].into());
                b.ins().vconst(ty, bytes)
            } else {
                b.ins().iconst(ty, 0)
            };
            b.ins().store(place.flags, zero, place.pointer, place.offset + at as i32);
        }
        Ok(())
    }

    /// Copies `len` bytes between ranges that may overlap.
    pub fn copy(
        &self,
        b: &mut FunctionBuilder<'_>,
        config: TargetFrontendConfig,
        to: Address,
        from: Address,
        len: u32,
    ) -> Result<(), CodegenError> {
        let to = self.place(b, to)?;
        let from = self.place(b, from)?;
        if len > INLINE_BYTES_MAX {
            let target = b.ins().iadd_imm_s(to.pointer, i64::from(to.offset));
            let source = b.ins().iadd_imm_s(from.pointer, i64::from(from.offset));
            let size = b.ins().iconst(config.pointer_type(), i64::from(len));
            b.call_memmove(config, target, source, size);
            return Ok(());
        }
        // All is read before anything is written.
        let pieces: Vec<(u32, Value)> = chunks(len)
            .map(|(ty, at)| (at, b.ins().load(ty, from.flags, from.pointer, from.offset + at as i32)))
            .collect();
        for (at, value) in pieces {
            b.ins().store(to.flags, value, to.pointer, to.offset + at as i32);
        }
        Ok(())
    }
}

/// The value that a bit store writes.
#[derive(Clone, Copy, Debug)]
pub enum BitValue {
    Constant(bool),
    Variable(Bit),
}

/// A constant of type `ty`.
pub fn constant(b: &mut FunctionBuilder<'_>, ty: ClifType, bits: u64) -> Value {
    match ty {
        types::F32 => b.ins().f32const(f32::from_bits(bits as u32)),
        types::F64 => b.ins().f64const(f64::from_bits(bits)),
        // Immediates are zero-extended from the width of the type.
        _ => b.ins().iconst(ty, bits as i64),
    }
}

/// Pieces that cover `len` bytes: widest first, the last one of a width moved back to end at `len` where it can.
fn chunks(len: u32) -> impl Iterator<Item = (ClifType, u32)> {
    const WIDTHS: [(ClifType, u32); 5] =
        [(types::I8X16, 16), (types::I64, 8), (types::I32, 4), (types::I16, 2), (types::I8, 1)];
    let mut at = 0;
    std::iter::from_fn(move || {
        let rest = len - at;
        if rest == 0 {
            return None;
        }
        // One wider piece that overlaps the one before is better than two or more narrow ones.
        if rest < 16 && !rest.is_power_of_two() && len >= rest.next_power_of_two() {
            let (ty, width) = WIDTHS[4 - rest.next_power_of_two().ilog2() as usize];
            at = len;
            return Some((ty, len - width));
        }
        let (ty, width) = WIDTHS.into_iter().find(|&(_, width)| width <= rest).expect("1 fits");
        at += width;
        Some((ty, at - width))
    })
}

fn integer_of(ty: ClifType) -> ClifType {
    match ty {
        types::F32 => types::I32,
        types::F64 => types::I64,
        other => other,
    }
}

/// True if an instruction names the region that may be anywhere.
fn uses_any(function: &Function) -> bool {
    function.layout.iter().flat_map(|&block| &function.blocks[block].insts).any(|&inst| {
        let mut uses = false;
        function.insts[inst].for_each_address(|addr| uses |= addr.region == Region::Any);
        uses
    })
}

fn invalid(message: String) -> CodegenError {
    CodegenError::Module { function: String::new(), message }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_cover_every_length_exactly() {
        for len in 0..=INLINE_BYTES_MAX {
            let mut covered = vec![false; len as usize];
            for (ty, at) in chunks(len) {
                for byte in at..at + ty.bytes() {
                    covered[byte as usize] = true;
                }
            }
            assert!(covered.iter().all(|&byte| byte), "{len}");
        }
        assert_eq!(chunks(15).count(), 2);
        assert_eq!(chunks(31).count(), 2);
    }
}
