//! Block moves by pointers that the program builds: SFC 20 BLKMOV, SFC 21 FILL and SFC 81 UBLKMOV without a call.
//!
//! A program that moves one of many records builds an ANY in its local data: type, length and number of the DB are constants, the
//! address is computed. Where the structure of parameters says so, a test of the address decides at run time; what it does not hold for is
//! left to the call, which knows all cases and errors.
//!
//! ```text
//! v9 = rt @system_function(v1, v2, v3, v4)      ; v5 is the pointer in DB 1
//!
//! v10 = (v5 is a byte of a DB, and 40 bytes are there from it on)
//! branch v10, b1, b2
//! b1: copy DB2 0, DB1[v6]+0, 40
//!     store.i16 L 10, 0                          ; RET_VAL
//!     jump b3(1)
//! b2 cold:
//!     v9 = rt @system_function(v1, v2, v3, v4)
//!     jump b3(v9)
//! b3(v11: i32):
//! ```
//!
//! What fills the structure goes to the cold side with the call, unless somebody reads it before. Takes time linear in the size of the function.
//!
//! Source: System and standard functions, SFC 20, 21, 81.

use plcc_abi::RuntimeFn;
use plcc_abi::any::block_move::{BLKMOV, FILL, UBLKMOV, UNINTERRUPTED_MAX};
use plcc_abi::any::{self, Access, Any, Fields};
use plcc_abi::layout::{AREA_BYTES, area};
use plcc_ir::{
    Address, BinaryOp, Block, BlockCall, Function, Inst, InstData, IntCc, Loc, Region, StaticDb, Type, Value,
};

use crate::surroundings::Surroundings;

/// Bytes of the structure of parameters: source, RET_VAL, destination.
const STRUCTURE_BYTES: u32 = 22;
const RET_VAL_AT: u32 = 10;
const ANY_AT: [u32; 2] = [0, 12];
/// Where the pointer is in an ANY.
const POINTER_AT: u32 = 6;
/// The bits of a pointer that say its area, and those of the bit in a byte.
const AREA_AND_BIT: u64 = 0xFF00_0007;
/// The answer of a system function without an error: BR.
const GOOD: u64 = 1;

/// Does block moves whose areas are known in place. Result: whether there were any.
pub fn move_blocks(function: &mut Function, surroundings: &Surroundings) -> bool {
    let mut changed = false;
    let mut layout = Vec::with_capacity(function.layout.len());
    for mut block in function.layout.clone() {
        layout.push(block);
        while let Some((at, plan)) = first_move(function, block, surroundings) {
            block = plan.carry_out(function, block, at, &mut layout);
            changed = true;
        }
    }
    function.layout = layout;
    if changed {
        function.resolve_aliases();
    }
    changed
}

/// The first call of a block that is a block move, with what it does. Calls on cold sides stay.
fn first_move(function: &Function, block: Block, surroundings: &Surroundings) -> Option<(usize, Plan)> {
    if function.blocks[block].cold {
        return None;
    }
    let insts = &function.blocks[block].insts;
    (0..insts.len()).find_map(|at| {
        let InstData::CallRuntime { function: RuntimeFn::SystemFunction, args } = &function.insts[insts[at]] else {
            return None;
        };
        let number = function.constant(args[1]).and_then(|number| u16::try_from(number).ok())?;
        if !matches!(number, BLKMOV | FILL | UBLKMOV) {
            return None;
        }
        let Some(InstData::AddressOf { addr: Address { region: Region::L, base: None, offset } }) =
            function.defining(args[2])
        else {
            return None;
        };
        let structure = Structure::before(function, &insts[..at], *offset);
        Some((at, structure.plan(function, number, *offset, surroundings)?))
    })
}

/// What is known of a structure of parameters when the call begins.
struct Structure {
    bytes: [Content; STRUCTURE_BYTES as usize],
    /// The pointers of source and destination.
    pointers: [Option<Value>; 2],
    /// What fills it and nobody reads before the call, last first.
    fills: Vec<Inst>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Content {
    /// Written before what has been looked at, if at all.
    Open,
    Known(u8),
    Unknown,
}

impl Structure {
    /// Looks at `insts` from the last to the first; the structure is at byte `start` of the frame.
    fn before(function: &Function, insts: &[Inst], start: u32) -> Structure {
        let mut structure =
            Structure { bytes: [Content::Open; STRUCTURE_BYTES as usize], pointers: [None; 2], fills: Vec::new() };
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
        for (pointer, any_at) in self.pointers.iter_mut().zip(ANY_AT) {
            let at = any_at + POINTER_AT;
            let is_open = self.bytes[at as usize..at as usize + 4].iter().all(|&byte| byte == Content::Open);
            if first == at && bytes == 4 && is_open {
                *pointer = value;
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

    /// Source (0) or destination (1) with the address left open.
    fn any(&self, index: usize, access: Access) -> Option<(Any, Value)> {
        let at = ANY_AT[index] as usize;
        let number = |bytes: std::ops::Range<usize>| {
            self.bytes[bytes].iter().try_fold(0u32, |number, byte| match byte {
                Content::Known(byte) => Some(number << 8 | u32::from(*byte)),
                Content::Open | Content::Unknown => None,
            })
        };
        let (head, db) = (number(at..at + 4)?, number(at + 4..at + 6)?);
        let pointer = u32::from(area::DB) << 24;
        let any = any::decode(Fields { head, db: db as u16, pointer }, index, access).ok()??;
        Some((any, self.pointers[index]?))
    }

    /// What the move does, if its areas are in DBs of the program.
    fn plan(self, function: &Function, number: u16, at: u32, surroundings: &Surroundings) -> Option<Plan> {
        let (from, from_pointer) = self.any(0, Access::Read)?;
        let (to, to_pointer) = self.any(1, Access::Write)?;
        let find = |number: u16| surroundings.dbs.iter().find(|db| db.number == number).copied();
        let (from_db, to_db) = (find(from.db)?, find(to.db)?);
        let (read, written) = match number {
            // What is filled with a part of itself is left to the call.
            FILL if from.db == to.db || from.bytes == 0 => return None,
            FILL => (from.bytes, to.bytes),
            // A copy of a text is one of its characters, as many as it has then.
            _ if from.type_code == any::STRING => return None,
            _ => (from.bytes.min(to.bytes), from.bytes.min(to.bytes)),
        };
        if to_db.read_only || number == UBLKMOV && read > UNINTERRUPTED_MAX {
            return None;
        }
        let place = |pointer: Value, db: StaticDb, bytes: u32| {
            let last = db.length.min(AREA_BYTES).checked_sub(bytes)?;
            // A constant that is wrong is left to the call.
            let is_right = |constant: u64| {
                constant & AREA_AND_BIT == u64::from(area::DB) << 24 && constant >> 3 & 0xFFFF <= u64::from(last)
            };
            function.constant(pointer).is_none_or(is_right).then_some(Place { pointer, db: db.number, last })
        };
        Some(Plan {
            at,
            from: place(from_pointer, from_db, read)?,
            to: place(to_pointer, to_db, written)?,
            read,
            written,
            fills: self.fills,
        })
    }
}

/// True if the instruction may read the structure at byte `start` of the frame.
fn reads(data: &InstData, start: u32) -> bool {
    let (addr, bytes) = match data {
        InstData::Load { addr } => (addr, 8),
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

/// An area in a DB that begins where a pointer says.
struct Place {
    pointer: Value,
    db: u16,
    /// The last byte at which it can begin.
    last: u32,
}

/// A block move.
struct Plan {
    /// Where the structure of parameters is in the frame.
    at: u32,
    from: Place,
    to: Place,
    read: u32,
    /// More than `read` if the source is repeated.
    written: u32,
    fills: Vec<Inst>,
}

impl Plan {
    /// Replaces instruction `at` of the block. Result: the block that goes on after it.
    fn carry_out(self, function: &mut Function, block: Block, at: usize, layout: &mut Vec<Block>) -> Block {
        let mut before = std::mem::take(&mut function.blocks[block].insts);
        let after = before.split_off(at + 1);
        let call = before.pop().expect("the call is the last one");
        let loc = function.locs[call];
        let (direct, cold, next) = (function.add_block(), function.add_block(), function.add_block());
        function.blocks[cold].cold = true;

        before.retain(|inst| !self.fills.contains(inst));
        let mut out = Builder { function, out: before, loc };
        let (from, fits_from) = out.locate(&self.from);
        let (to, fits_to) = out.locate(&self.to);
        let fits = out.binary(BinaryOp::And, Type::I1, fits_from, fits_to);
        let branch = InstData::Branch { cond: fits, then_to: BlockCall::new(direct), else_to: BlockCall::new(cold) };
        out.push(branch);
        let Builder { function, out: before, .. } = out;
        function.blocks[block].insts = before;

        let mut out = Builder { function, out: Vec::new(), loc };
        let mut done = self.read.min(self.written);
        out.push(InstData::Copy { to, from, len: done });
        // Whole patterns, so that a copy goes on where they end.
        while done < self.written {
            let len = done.min(self.written - done);
            out.push(InstData::Copy { to: Address { offset: to.offset + done, ..to }, from: to, len });
            done += len;
        }
        let zero = out.constant(Type::I16, 0);
        out.push(InstData::Store { addr: Address::direct(Region::L, self.at + RET_VAL_AT), value: zero });
        let good = out.constant(Type::I32, GOOD);
        out.push(InstData::Jump { target: BlockCall { block: next, args: vec![good] } });
        let Builder { function, out: moved, .. } = out;
        function.blocks[direct].insts = moved;

        // The call has a copy, so that all uses of its answer are of what the two sides bring.
        let copy = function.make_inst(function.insts[call].clone(), &[Type::I32], loc);
        let jump = InstData::Jump { target: BlockCall { block: next, args: vec![function.result(copy)] } };
        let jump = function.make_inst(jump, &[], loc);
        function.blocks[cold].insts = self.fills.into_iter().rev().chain([copy, jump]).collect();
        let merged = function.add_param(next, Type::I32);
        function.replace_value(function.result(call), merged);
        function.blocks[next].insts = after;
        layout.extend([direct, cold, next]);
        next
    }
}

/// Makes instructions in a row.
struct Builder<'f> {
    function: &'f mut Function,
    out: Vec<Inst>,
    loc: Loc,
}

impl Builder<'_> {
    fn push(&mut self, data: InstData) {
        let inst = self.function.make_inst(data, &[], self.loc);
        self.out.push(inst);
    }

    fn value(&mut self, data: InstData, ty: Type) -> Value {
        let inst = self.function.make_inst(data, &[ty], self.loc);
        self.out.push(inst);
        self.function.result(inst)
    }

    fn constant(&mut self, ty: Type, bits: u64) -> Value {
        self.value(InstData::Const { bits }, ty)
    }

    fn binary(&mut self, op: BinaryOp, ty: Type, one: Value, two: Value) -> Value {
        self.value(InstData::Binary { op, args: [one, two] }, ty)
    }

    fn compare(&mut self, cc: IntCc, one: Value, two: Value) -> Value {
        self.value(InstData::IntCompare { cc, args: [one, two] }, Type::I1)
    }

    /// Where a place begins, and whether it is there.
    fn locate(&mut self, place: &Place) -> (Address, Value) {
        let region = Region::Db(place.db);
        if let Some(pointer) = self.function.constant(place.pointer) {
            let fits = self.constant(Type::I1, 1);
            return (Address::direct(region, (pointer >> 3 & 0xFFFF) as u32), fits);
        }
        let mask = self.constant(Type::I32, AREA_AND_BIT);
        let kind = self.binary(BinaryOp::And, Type::I32, place.pointer, mask);
        let db = self.constant(Type::I32, u64::from(area::DB) << 24);
        let is_db = self.compare(IntCc::Eq, kind, db);
        let three = self.constant(Type::I32, 3);
        let shifted = self.binary(BinaryOp::Lshr, Type::I32, place.pointer, three);
        let bytes = self.constant(Type::I32, 0xFFFF);
        let byte = self.binary(BinaryOp::And, Type::I32, shifted, bytes);
        let last = self.constant(Type::I32, u64::from(place.last));
        let is_there = self.compare(IntCc::Ule, byte, last);
        let fits = self.binary(BinaryOp::And, Type::I1, is_db, is_there);
        (Address::indexed(region, byte, 0), fits)
    }
}
