//! Block moves by pointers that the program builds: SFC 20 BLKMOV, SFC 21 FILL and SFC 81 UBLKMOV without a call.
//!
//! A program that moves one of many records builds an ANY in its local data: type, length and number of the DB are
//! constants, the address is computed. An FB moves its static data: all but the number of its instance DB is a
//! constant. Where the structure of parameters says so, a test of address and DB decides at run time; where it fails,
//! the call remains, which knows all cases and errors.
//!
//! - `structure`: what the structure of parameters says; `place`: areas, and what is tested.
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
//! What fills the structure goes to the cold side with the call, unless it is read before. Takes time linear in the size of the function.
//!
//! Source: System and standard functions, SFC 20, 21, 81.

mod place;
mod structure;

use plcc_abi::RuntimeFn;
use plcc_abi::any::block_move::{BLKMOV, FILL, UBLKMOV, UNINTERRUPTED_MAX};
use plcc_abi::any::{self, Access};
use plcc_ir::{Address, BinaryOp, Block, BlockCall, Function, Inst, InstData, Region, Type, Value};

use place::{Builder, Frame, Place};
use structure::{STRUCTURE_BYTES, Structure};

use crate::surroundings::Surroundings;

/// Where RET_VAL is in the structure of parameters.
const RET_VAL_AT: u32 = 10;
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
    (0..insts.len()).find_map(|at| Some((at, plan_of(function, insts, at, surroundings)?)))
}

/// What the call at place `at` of the instructions of a block does, if it is a block move and a test can tell that it is possible.
fn plan_of(function: &Function, insts: &[Inst], at: usize, surroundings: &Surroundings) -> Option<Plan> {
    let (number, args) = block_move(function, &function.insts[insts[at]])?;
    let at_frame = local_offset(function, args[2])?;
    let base = local_offset(function, args[3])?;
    let frame = Frame { base, structure: at_frame };
    let structure = Structure::before(function, &insts[..at], at_frame);
    Plan::new(function, number, at_frame, structure, frame, surroundings)
}

/// True if all block moves of a function that are not on cold sides can be done in place after a test.
pub fn are_possible(function: &Function, surroundings: &Surroundings) -> bool {
    let hot = function.layout.iter().map(|&block| &function.blocks[block]).filter(|block| !block.cold);
    hot.map(|block| &block.insts).all(|insts| {
        let is_move = |&at: &usize| is_block_move(function, &function.insts[insts[at]]);
        (0..insts.len()).filter(is_move).all(|at| plan_of(function, insts, at, surroundings).is_some())
    })
}

/// The number of the system function and the arguments of a call that is a block move.
fn block_move<'f>(function: &Function, data: &'f InstData) -> Option<(u16, &'f [Value])> {
    let InstData::CallRuntime { function: RuntimeFn::SystemFunction, args } = data else { return None };
    let number = function.constant(args[1]).and_then(|number| u16::try_from(number).ok())?;
    matches!(number, BLKMOV | FILL | UBLKMOV).then_some((number, args))
}

/// True if the instruction is a block move, which uses the addresses of local data that it gets, and does not keep them.
pub fn is_block_move(function: &Function, data: &InstData) -> bool {
    block_move(function, data).is_some()
}

/// What a block move after the instructions `before` of its block may change, if it is known: its destination and its structure of
/// parameters, each with its length. It runs no organization block.
pub fn written(
    function: &Function,
    before: &[Inst],
    data: &InstData,
    surroundings: &Surroundings,
) -> Option<[(Address, u32); 2]> {
    let (_, args) = block_move(function, data)?;
    let at_frame = local_offset(function, args[2])?;
    let frame = Frame { base: local_offset(function, args[3])?, structure: at_frame };
    let to = Structure::before(function, before, at_frame).pointed(1, Access::Write)?;
    match Place::of(function, &to, to.any.bytes, frame, surroundings)? {
        Place::Known(addr) if to.any.type_code != any::STRING => {
            Some([(addr, to.any.bytes), (Address::direct(Region::L, at_frame), STRUCTURE_BYTES)])
        }
        _ => None,
    }
}

/// The byte of region L that an address is the one of.
fn local_offset(function: &Function, address: Value) -> Option<u32> {
    match function.defining(address)? {
        InstData::AddressOf { addr: Address { region: Region::L, base: None, offset } } => Some(*offset),
        InstData::FrameBase { callee: false } => Some(0),
        _ => None,
    }
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
    /// The source is repeated, and must not be part of what is written.
    is_fill: bool,
    fills: Vec<Inst>,
}

impl Plan {
    /// What the move does, if a test can tell at run time that it is possible.
    fn new(
        function: &Function,
        number: u16,
        at: u32,
        structure: Structure,
        frame: Frame,
        surroundings: &Surroundings,
    ) -> Option<Plan> {
        let from = structure.pointed(0, Access::Read)?;
        let to = structure.pointed(1, Access::Write)?;
        let (read, written) = match number {
            FILL if from.any.bytes == 0 => return None,
            FILL => (from.any.bytes, to.any.bytes),
            // A copy of a text is one of its characters, as many as it has then.
            _ if from.any.type_code == any::STRING => return None,
            _ => (from.any.bytes.min(to.any.bytes), from.any.bytes.min(to.any.bytes)),
        };
        if number == UBLKMOV && read > UNINTERRUPTED_MAX {
            return None;
        }
        let from = Place::of(function, &from, read, frame, surroundings)?;
        let to = Place::of(function, &to, written, frame, surroundings)?;
        let is_possible = to.is_writable(surroundings);
        is_possible.then_some(Plan { at, from, to, read, written, is_fill: number == FILL, fills: structure.fills })
    }

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
        let (from, is_from_there) = out.locate(self.from);
        let (to, is_to_there) = out.locate(self.to);
        let mut tests = vec![is_from_there, is_to_there];
        if self.is_fill {
            match out.apart(from, self.read, to, self.written) {
                Some(test) => tests.push(test),
                None => tests.push(Some(out.constant(Type::I1, 0))),
            }
        }
        let fits = tests.into_iter().flatten().reduce(|one, two| out.binary(BinaryOp::And, Type::I1, one, two));
        let fits = fits.unwrap_or_else(|| out.constant(Type::I1, 1));
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
        out.push(InstData::Jump { target: BlockCall { block: next, args: [good].into() } });
        let Builder { function, out: moved, .. } = out;
        function.blocks[direct].insts = moved;

        // The call has a copy, so that all uses of its answer are of what the two sides bring.
        let copy = function.make_inst(function.insts[call].clone(), &[Type::I32], loc);
        let jump = InstData::Jump { target: BlockCall { block: next, args: [function.result(copy)].into() } };
        let jump = function.make_inst(jump, &[], loc);
        function.blocks[cold].insts = self.fills.into_iter().rev().chain([copy, jump]).collect();
        let merged = function.add_param(next, Type::I32);
        function.replace_value(function.result(call), merged);
        function.blocks[next].insts = after;
        layout.extend([direct, cold, next]);
        next
    }
}
