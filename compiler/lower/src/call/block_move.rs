//! Block moves of areas that are known at compile time: SFC 20 BLKMOV, SFC 21 FILL, SFC 81 UBLKMOV without a call.
//!
//! Everything is decided here as the runtime would: whether the areas exist and are long enough, whether the destination may be
//! written, RET_VAL. What cannot be decided remains a call: DBs made at run time, texts, a source that overlaps what is filled.
//!
//! Source: System and standard functions, SFC 20, 21, 81.

use plcc_abi::any::block_move::{BLKMOV, DESTINATION, FILL, RET_VAL, SOURCE, TOO_LONG, UBLKMOV, UNINTERRUPTED_MAX};
use plcc_abi::any::{self, Access, Fields};
use plcc_abi::image::BlockKind;
use plcc_abi::layout::{AREA_BYTES, area};
use plcc_ir::{Address, BinaryOp, Region, Type, Value};
use plcc_model::{Actual, Argument, CodeBlock, Place, Width};

use crate::block::BlockLowering;
use crate::pointer::{ANY_S7, PointerFields, moved};

/// A pattern is repeated up to this length by stores, and from there by copies of what is filled already.
const STORED_BYTES_MAX: u32 = 64;

/// A range of memory.
struct Range {
    addr: Address,
    /// Length as the pointer says, in bytes.
    bytes: u32,
    /// Bytes that really exist there, up to `bytes`.
    existing: u32,
    type_code: u8,
}

/// What a block move does.
enum Move {
    Nothing,
    Copy { from: Address, to: Address, bytes: u32 },
    Fill { pattern: Address, bytes: u32, to: Address, filled: u32 },
}

/// True for the functions of this module.
pub fn is_block_move(callee: &CodeBlock) -> bool {
    callee.kind == BlockKind::Sfc && matches!(callee.number, BLKMOV | FILL | UBLKMOV)
}

impl BlockLowering<'_, '_> {
    /// Does the block move `callee` in place, with RET_VAL in the structure of parameters. False: not all of it is known.
    pub fn known_block_move(
        &mut self,
        callee: &CodeBlock,
        structure: Address,
        source: Fields,
        destination: Fields,
    ) -> bool {
        let Some(decided) = self.decide(callee.number, source, destination) else { return false };
        let (ret_val, what) = match decided {
            Ok(what) => (0, what),
            Err(error) => (error, Move::Nothing),
        };
        match what {
            Move::Nothing => {}
            Move::Copy { from, to, bytes } => self.b.copy(to, from, bytes),
            Move::Fill { pattern, bytes, to, filled } => self.fill_range(pattern, bytes, to, filled),
        }
        let value = self.b.i32_const(u32::from(ret_val));
        self.store_low(moved(structure, callee.interface.parameters[RET_VAL].byte), Width::Word, value);
        let good = self.b.bool_const(ret_val & 0x8000 == 0);
        self.set(self.regs.br, good);
        true
    }

    /// The pointers of a call from STL, if both are known.
    pub(super) fn block_move_pointers(&mut self, arguments: &[Argument]) -> Option<(Fields, Fields)> {
        let mut known = |parameter| {
            let argument = arguments.iter().find(|argument| argument.parameter == parameter)?;
            self.known_pointer(&argument.actual)
        };
        Some((known(SOURCE)?, known(DESTINATION)?))
    }

    fn known_pointer(&mut self, actual: &Actual) -> Option<Fields> {
        match actual {
            Actual::PointerBytes(bytes) => known_bytes(bytes),
            Actual::PointerTo { place, type_code, count } => match place {
                Place::I { .. }
                | Place::Q { .. }
                | Place::M { .. }
                | Place::L { .. }
                | Place::Pi { .. }
                | Place::Pq { .. }
                | Place::Db { .. }
                | Place::OpenDb { .. }
                | Place::OpenDi { .. } => {
                    let fields = self.pointer_fields(place);
                    self.known_any(ANY_S7 << 24 | u32::from(*type_code) << 16 | u32::from(*count), fields)
                }
                Place::Instance { .. }
                | Place::Parameter { .. }
                | Place::ThroughPointer { .. }
                | Place::Indirect { .. }
                | Place::Register { .. }
                | Place::Element { .. } => None,
            },
            Actual::Const(_) | Actual::Place(_) | Actual::Number(_) | Actual::PointerCopy(_) | Actual::Variant(..) => {
                None
            }
        }
    }

    /// The ANY, if its fields are constants.
    pub fn known_any(&self, head: u32, fields: PointerFields) -> Option<Fields> {
        let db = self.b.constant_bits(fields.db)? as u16;
        let pointer = self.b.constant_bits(fields.pointer)? as u32;
        Some(Fields { head, db, pointer })
    }

    /// `None`: not known. `Err`: RET_VAL.
    fn decide(&self, number: u16, source: Fields, destination: Fields) -> Option<Result<Move, u16>> {
        let source = match self.decode(source, SOURCE, Access::Read)? {
            Ok(source) => source,
            Err(error) => return Some(Err(error)),
        };
        let destination = match self.decode(destination, DESTINATION, Access::Write)? {
            Ok(destination) => destination,
            Err(error) => return Some(Err(error)),
        };
        let (Some(source), Some(to)) = (source, destination) else { return Some(Ok(Move::Nothing)) };
        // A copy of a text is one of its characters, as many as it has then.
        if number != FILL && source.type_code == any::STRING {
            return None;
        }
        let (read, written) = match number {
            FILL => (source.bytes, to.bytes),
            _ => (source.bytes.min(to.bytes), source.bytes.min(to.bytes)),
        };
        if number == UBLKMOV && read > UNINTERRUPTED_MAX {
            return Some(Err(TOO_LONG));
        }
        let family = self.plan.program.profile.family;
        if let Some(error) = any::short_error(family, source.existing < read, to.existing < written) {
            return Some(Err(error));
        }
        if number != FILL {
            return Some(Ok(Move::Copy { from: source.addr, to: to.addr, bytes: read }));
        }
        let apart = source.addr.region != to.addr.region
            || source.addr.offset + read <= to.addr.offset
            || to.addr.offset + written <= source.addr.offset;
        apart.then_some(Ok(Move::Fill { pattern: source.addr, bytes: read, to: to.addr, filled: written }))
    }

    /// As [`any::decode`], with the place in memory. `None`: not known.
    fn decode(&self, pointer: Fields, index: usize, access: Access) -> Option<Result<Option<Range>, u16>> {
        let any = match any::decode(pointer, index, access) {
            Ok(Some(any)) => any,
            Ok(None) => return Some(Ok(None)),
            Err(error) => return Some(Err(error)),
        };
        let profile = &self.plan.program.profile;
        let (region, length) = match any.area {
            area::I => (Region::I, profile.inputs),
            area::Q => (Region::Q, profile.outputs),
            area::M => (Region::M, profile.bit_memory),
            area::DB | area::DI => {
                let db = *self.plan.static_db(any.db)?;
                let read_only = self.plan.protected_dbs.contains(&any.db);
                if let Some(error) = any::db_error(index, access, db.length, read_only) {
                    return Some(Err(error));
                }
                (Region::Db(any.db), db.length)
            }
            area::L | area::V => {
                // The stack goes on after the local data.
                if any.byte + any.bytes > self.local_bytes {
                    return None;
                }
                (Region::L, self.local_bytes)
            }
            _ => return Some(Err(any::area_error(index, access))),
        };
        let existing = length.min(AREA_BYTES).saturating_sub(any.byte).min(any.bytes);
        let addr = Address::direct(region, any.byte);
        Some(Ok(Some(Range { addr, bytes: any.bytes, existing, type_code: any.type_code })))
    }

    /// Repeats the `bytes` bytes at `pattern` in the `filled` bytes at `to`, which are apart from them.
    fn fill_range(&mut self, pattern: Address, bytes: u32, to: Address, filled: u32) {
        let mut done = match bytes {
            _ if bytes >= filled => filled,
            1 | 2 | 4 | 8 => filled.min(STORED_BYTES_MAX),
            _ => bytes,
        };
        match bytes {
            1 | 2 | 4 | 8 if bytes < filled => self.store_pattern(pattern, bytes, to, done),
            _ => self.b.copy(to, pattern, done),
        }
        // Whole patterns, so that a copy goes on where they end.
        while done < filled {
            let part = done.min(filled - done);
            self.b.copy(moved(to, done), to, part);
            done += part;
        }
    }

    /// Stores a pattern of 1, 2, 4 or 8 bytes again and again.
    fn store_pattern(&mut self, pattern: Address, bytes: u32, to: Address, filled: u32) {
        let ty = integer(bytes);
        let mut value = self.b.load(ty, pattern);
        if ty != Type::I64 {
            value = self.b.zext(Type::I64, value);
            let ones = (0..8 / bytes).fold(0u64, |ones, _| ones << (8 * bytes) | 1);
            value = self.b.binary_imm(BinaryOp::Imul, value, ones as i64);
        }
        let mut done = 0;
        while done < filled {
            let width = 1 << (filled - done).min(8).ilog2();
            let part = self.part_of_pattern(value, done % 8, width);
            self.b.store(moved(to, done), part);
            done += width;
        }
    }

    /// `width` bytes of eight, from byte `first` on.
    fn part_of_pattern(&mut self, pattern: Value, first: u32, width: u32) -> Value {
        if width == 8 {
            return pattern;
        }
        let shifted = self.b.binary_imm(BinaryOp::Lshr, pattern, i64::from(8 * (8 - first - width)));
        self.b.trunc(integer(width), shifted)
    }
}

/// The fields of a constant ANY.
pub fn known_bytes(bytes: &[u8]) -> Option<Fields> {
    let &[a, b, c, d, e, f, g, h, i, j] = bytes else { return None };
    let head = u32::from_be_bytes([a, b, c, d]);
    Some(Fields { head, db: u16::from_be_bytes([e, f]), pointer: u32::from_be_bytes([g, h, i, j]) })
}

/// The integer of 1, 2, 4 or 8 bytes.
fn integer(bytes: u32) -> Type {
    match bytes {
        1 => Type::I8,
        2 => Type::I16,
        4 => Type::I32,
        _ => Type::I64,
    }
}
