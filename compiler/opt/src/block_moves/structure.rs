//! What is known of the structure of parameters when a block move is called.

use plcc_abi::any::{self, Access, Any, Fields};
use plcc_abi::layout::area;
use plcc_ir::{Function, Inst, InstData, Region, Type, Value};

/// Bytes of the structure of parameters: source, RET_VAL, destination.
pub(super) const STRUCTURE_BYTES: u32 = 22;
const ANY_AT: [u32; 2] = [0, 12];
/// Where the fields of an ANY are.
const HEAD_BYTES: u32 = 4;
const DB_AT: u32 = 4;
const POINTER_AT: u32 = 6;

pub(super) struct Structure {
    bytes: [Content; STRUCTURE_BYTES as usize],
    /// The numbers of the DBs of source and destination, i16, where one store wrote them.
    dbs: [Option<Value>; 2],
    /// The same of the pointers, i32.
    pointers: [Option<Value>; 2],
    /// What fills it and is not read before the call, last first.
    pub fills: Vec<Inst>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Content {
    /// Written before what has been looked at, if at all.
    Open,
    Known(u8),
    Unknown,
}

/// The number of a DB.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    Known(u16),
    /// An i16.
    Computed(Value),
}

/// Source or destination.
pub(super) struct Pointed {
    /// Type and length; neither the DB nor the address is looked at.
    pub any: Any,
    pub db: Number,
    /// An i32.
    pub pointer: Value,
}

impl Structure {
    /// Looks at `insts` from the last to the first; the structure is at byte `start` of the frame.
    pub fn before(function: &Function, insts: &[Inst], start: u32) -> Structure {
        let mut structure = Structure {
            bytes: [Content::Open; STRUCTURE_BYTES as usize],
            dbs: [None; 2],
            pointers: [None; 2],
            fills: Vec::new(),
        };
        let mut is_seen = false;
        for &inst in insts.iter().rev() {
            let data = &function.insts[inst];
            let written = match data {
                InstData::Store { addr, value } => Some((addr, function.ty(*value).bytes())),
                InstData::StoreBit { addr, .. } => Some((addr, 1)),
                InstData::Clear { addr, len } | InstData::Copy { to: addr, len, .. } => Some((addr, *len)),
                InstData::Call { .. } | InstData::CallRuntime { .. } if data.has_side_effect() => break,
                _ => None,
            };
            is_seen |= reads(data, start);
            let Some((addr, bytes)) = written.filter(|(addr, _)| addr.region.may_alias(Region::L)) else { continue };
            if addr.base.is_some() || addr.region != Region::L {
                break;
            }
            // Before the structure, the distance wraps to more than its length.
            let first = addr.offset.wrapping_sub(start);
            let is_inside = first < STRUCTURE_BYTES && bytes <= STRUCTURE_BYTES - first;
            if is_inside && !is_seen {
                structure.fills.push(inst);
            }
            // What is written before this stays before it.
            is_seen |= !is_inside && overlaps(addr.offset, bytes, start);
            structure.write(function, data, first, bytes);
        }
        structure
    }

    /// Notes what `data` writes to `bytes` bytes from byte `first` of the structure on.
    fn write(&mut self, function: &Function, data: &InstData, first: u32, bytes: u32) {
        let (value, constant) = match data {
            InstData::Store { value, .. } => (Some(*value), function.constant(*value)),
            InstData::Clear { .. } => (None, Some(0)),
            _ => (None, None),
        };
        for (fields, field_at, field_bytes) in [(&mut self.dbs, DB_AT, 2), (&mut self.pointers, POINTER_AT, 4)] {
            for (field, any_at) in fields.iter_mut().zip(ANY_AT) {
                let at = any_at + field_at;
                let mut content = self.bytes[at as usize..(at + field_bytes) as usize].iter();
                if first == at && bytes == field_bytes && content.all(|&byte| byte == Content::Open) {
                    *field = value;
                }
            }
        }
        for nth in 0..bytes {
            let Some(byte) = self.bytes.get_mut(first.wrapping_add(nth) as usize) else { continue };
            if *byte == Content::Open {
                *byte = constant.map_or(Content::Unknown, |constant| {
                    // Big-endian; of a long range all bytes are 0.
                    let shift = 8 * (bytes - 1 - nth);
                    Content::Known(constant.checked_shr(shift).unwrap_or(0) as u8)
                });
            }
        }
    }

    /// Source (0) or destination (1), if type and length are constants.
    pub fn pointed(&self, index: usize, access: Access) -> Option<Pointed> {
        let at = ANY_AT[index] as usize;
        let constant = |first: u32, bytes: u32| {
            let bytes = &self.bytes[at + first as usize..at + (first + bytes) as usize];
            bytes.iter().try_fold(0u32, |number, byte| match byte {
                Content::Known(byte) => Some(number << 8 | u32::from(*byte)),
                Content::Open | Content::Unknown => None,
            })
        };
        let pointer = u32::from(area::DB) << 24;
        let any = any::decode(Fields { head: constant(0, HEAD_BYTES)?, db: 0, pointer }, index, access).ok()??;
        let db = match constant(DB_AT, 2) {
            Some(number) => Number::Known(number as u16),
            None => Number::Computed(self.dbs[index]?),
        };
        Some(Pointed { any, db, pointer: self.pointers[index]? })
    }
}

/// True if the instruction may read the structure at byte `start` of the frame.
fn reads(data: &InstData, start: u32) -> bool {
    let (addr, bytes) = match data {
        InstData::Load { addr } => (addr, Type::I64.bytes()),
        InstData::LoadBit { addr, .. } | InstData::StoreBit { addr, .. } => (addr, 1),
        InstData::Copy { from, len, .. } => (from, *len),
        _ => return false,
    };
    addr.region.may_alias(Region::L)
        && (addr.region != Region::L || addr.base.is_some() || overlaps(addr.offset, bytes, start))
}

/// True if the bytes at `offset` touch the structure at `start`.
fn overlaps(offset: u32, bytes: u32, start: u32) -> bool {
    offset < start + STRUCTURE_BYTES && start < offset.saturating_add(bytes)
}
