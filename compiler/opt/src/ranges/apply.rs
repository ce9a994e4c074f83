//! Makes the changes of instructions, with the instructions that they need.

use super::access;
use super::change::{Change, Part};
use plcc_ir::{Address, BinaryOp, Block, Function, Inst, InstData, Loc, Value, eval};

/// Makes the changes, which are in the order of the code.
pub fn apply(function: &mut Function, changes: Vec<(Block, Inst, Change)>) {
    let mut changes = changes.into_iter().peekable();
    while let Some(&(block, ..)) = changes.peek() {
        let insts = std::mem::take(&mut function.blocks[block].insts);
        let mut out = Vec::with_capacity(insts.len() + 4);
        for inst in insts {
            let Some((_, _, mut change)) = changes.next_if(|&(at, changed, _)| at == block && changed == inst) else {
                out.push(inst);
                continue;
            };
            if let Change::AddressFrom(value, by, addr) = change {
                let (ty, loc) = (function.ty(value), function.locs[inst]);
                let by = function.make_inst(InstData::Const { bits: eval::mask(ty, by) }, &[ty], Loc(0));
                let args = [value, function.result(by)];
                let base = function.make_inst(InstData::Binary { op: BinaryOp::Iadd, args }, &[ty], loc);
                out.extend([by, base]);
                change = Change::Addresses([Some(Address { base: Some(function.result(base)), ..addr }), None]);
            }
            if let Change::Addresses(addresses) = change {
                access::set_addresses(&mut function.insts[inst], addresses);
                out.push(inst);
                continue;
            }
            let (result, loc) = (function.result(inst), function.locs[inst]);
            match change {
                Change::Addresses(_) | Change::AddressFrom(..) => unreachable!("done above"),
                Change::Constant(bits) => {
                    function.insts[inst] = InstData::Const { bits };
                    function.locs[inst] = Loc(0);
                    out.push(inst);
                }
                Change::Value(value) => {
                    if function.resolve(value) == result {
                        out.push(inst);
                    } else {
                        function.replace_value(result, value);
                    }
                }
                Change::SumOfShifts(parts) => {
                    let args = parts.map(|part| shifted(function, &mut out, loc, part));
                    function.insts[inst] = InstData::Binary { op: BinaryOp::Iadd, args };
                    out.push(inst);
                }
                Change::ShiftAndAdd(part, added) => {
                    let shifted = shifted(function, &mut out, loc, part);
                    add(function, &mut out, inst, shifted, added);
                }
                Change::MaskAndAdd(arg, mask, added) => {
                    let ty = function.ty(result);
                    let mask = function.make_inst(InstData::Const { bits: eval::mask(ty, mask) }, &[ty], loc);
                    let args = [arg, function.result(mask)];
                    let masked = function.make_inst(InstData::Binary { op: BinaryOp::And, args }, &[ty], loc);
                    out.extend([mask, masked]);
                    let masked = function.result(masked);
                    add(function, &mut out, inst, masked, added);
                }
                Change::ExtendAndAdd(op, arg, added) => {
                    let wide = function.make_inst(InstData::Convert { op, arg }, &[function.ty(result)], loc);
                    out.push(wide);
                    let wide = function.result(wide);
                    add(function, &mut out, inst, wide, added);
                }
                Change::Shift(op, arg, by) => {
                    let ty = function.ty(result);
                    let count = function.make_inst(InstData::Const { bits: eval::mask(ty, by) }, &[ty], loc);
                    out.push(count);
                    function.insts[inst] = InstData::Binary { op, args: [arg, function.result(count)] };
                    out.push(inst);
                }
            }
        }
        function.blocks[block].insts = out;
    }
    function.resolve_aliases();
}

/// Makes `inst` the sum of a value and a constant.
fn add(function: &mut Function, out: &mut Vec<Inst>, inst: Inst, value: Value, added: u64) {
    let ty = function.ty(value);
    let added = function.make_inst(InstData::Const { bits: eval::mask(ty, added) }, &[ty], function.locs[inst]);
    function.insts[inst] = InstData::Binary { op: BinaryOp::Iadd, args: [value, function.result(added)] };
    out.extend([added, inst]);
}

/// The instructions of a shifted value.
fn shifted(function: &mut Function, out: &mut Vec<Inst>, loc: Loc, Part { op, arg, by }: Part) -> Value {
    if by == 0 {
        return arg;
    }
    let ty = function.ty(arg);
    let count = function.make_inst(InstData::Const { bits: eval::mask(ty, by) }, &[ty], loc);
    let inst = function.make_inst(InstData::Binary { op, args: [arg, function.result(count)] }, &[ty], loc);
    out.extend([count, inst]);
    function.result(inst)
}
