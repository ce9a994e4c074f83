//! One comparison for a pointer whose area is known.
//!
//! An access by a pointer that is only known at run time is tested: its bit is 0, and its byte address is in the area. Turned right by three bits
//! the pointer has its bit at the top, then its area, then the byte address, so that one comparison with the end of the area tests both; and the
//! address is the turned pointer minus a constant.
//!
//! ```text
//! b1:                        ; b1:
//!     v1 = and v0, 7         ;     v7 = rotr v0, 3
//!     v2 = eq v1, 0          ;     v8 = ule v7, 16#83 << 21 | 16#1FFE
//!     v3 = and v0, 16#FFFFFF ;     branch v8, b2, b3
//!     v4 = lshr v3, 3        ; b2:
//!     v5 = iadd v4, 2        ;     v9 = iadd v7, -(16#83 << 21)
//!     v6 = ule v5, 16#2000   ;     v10 = load.i16 M[v9]+0
//!     v7 = and v2, v6
//!     branch v7, b2, b3
//! b2:
//!     v8 = load.i16 M[v4]+0
//! ```
//!
//! It runs at the end, since other passes know the ranges of the parts.

use plcc_ir::analysis::ControlFlow;
use plcc_ir::{BinaryOp, Block, Function, Inst, InstData, IntCc, Loc, Region, Type, Value};

/// Bits of a pointer below its byte address.
const BIT: u64 = 7;
/// Byte and bit address of a pointer.
const ADDRESS: u64 = 0x00FF_FFFF;
/// Where the area of a pointer begins, and where it does when the pointer is turned.
const AREA_AT: u64 = 24;
const TURNED_AREA_AT: u32 = 21;

/// Makes tests of pointers one comparison in a function. Result: whether there were any.
pub fn join_pointer_tests(function: &mut Function) -> bool {
    let candidates: Vec<(Block, Test)> =
        function.layout.iter().filter_map(|&block| Some((block, test_of(function, block)?))).collect();
    if candidates.is_empty() {
        return false;
    }
    let cfg = ControlFlow::new(function);
    let mut changed = false;
    for (block, test) in candidates {
        let &[before] = cfg.predecessors(block) else { continue };
        let Some(area) = area_tested(function, before, block, test.pointer) else { continue };
        let is_only_way = cfg.predecessors(test.then) == [block];
        rewrite(function, block, &test, area, is_only_way);
        changed = true;
    }
    changed
}

/// The test at the end of a block.
struct Test {
    pointer: Value,
    /// Its byte address.
    address: Value,
    /// The greatest byte address for which it holds.
    last: u64,
    /// Where it leads if it holds.
    then: Block,
}

fn test_of(function: &Function, block: Block) -> Option<Test> {
    let InstData::Branch { cond, then_to, else_to } = &function.insts[function.terminator(block)?] else { return None };
    let [a, b] = binary(function, BinaryOp::And, *cond)?;
    if then_to.block == else_to.block {
        return None;
    }
    let (pointer, length) = match (bit_tested(function, a), bit_tested(function, b)) {
        (Some(pointer), _) => (pointer, b),
        (None, Some(pointer)) => (pointer, a),
        (None, None) => return None,
    };
    let &InstData::IntCompare { cc: IntCc::Ule, args: [end, length] } = function.defining(length)? else { return None };
    let length = function.constant(length)?;
    let (address, bytes) = match with_constant(function, BinaryOp::Iadd, end) {
        Some((address, bytes)) => (address, bytes),
        None => (end, 0),
    };
    let (masked, shift) = with_constant(function, BinaryOp::Lshr, address)?;
    let (of, mask) = with_constant(function, BinaryOp::And, masked)?;
    let last = length.checked_sub(bytes).filter(|&last| last <= ADDRESS >> 3)?;
    ((function.resolve(of), mask, shift) == (pointer, ADDRESS, 3)).then_some(Test {
        pointer,
        address: function.resolve(address),
        last,
        then: then_to.block,
    })
}

/// The pointer whose bit a condition says is 0.
fn bit_tested(function: &Function, cond: Value) -> Option<Value> {
    let &InstData::IntCompare { cc: IntCc::Eq, args: [bit, zero] } = function.defining(cond)? else { return None };
    let (pointer, mask) = with_constant(function, BinaryOp::And, bit)?;
    let is_bit = mask == BIT && function.constant(zero) == Some(0) && function.ty(pointer) == Type::I32;
    is_bit.then(|| function.resolve(pointer))
}

/// The area that `pointer` has where the branch at the end of `before` leads to `block`.
fn area_tested(function: &Function, before: Block, block: Block, pointer: Value) -> Option<u64> {
    let InstData::Branch { cond, then_to, else_to } = &function.insts[function.terminator(before)?] else {
        return None;
    };
    let &InstData::IntCompare { cc: IntCc::Eq, args: [code, area] } = function.defining(*cond)? else { return None };
    let (of, shift) = with_constant(function, BinaryOp::Lshr, code)?;
    let leads = then_to.block == block && else_to.block != block;
    let area = function.constant(area)?;
    (leads && shift == AREA_AT && function.resolve(of) == pointer && area <= 0xFF).then_some(area)
}

fn binary(function: &Function, op: BinaryOp, value: Value) -> Option<[Value; 2]> {
    match function.defining(value)? {
        &InstData::Binary { op: found, args } => (found == op).then_some(args),
        _ => None,
    }
}

fn with_constant(function: &Function, op: BinaryOp, value: Value) -> Option<(Value, u64)> {
    let [x, constant] = binary(function, op, value)?;
    Some((x, function.constant(constant)?))
}

fn rewrite(function: &mut Function, block: Block, test: &Test, area: u64, is_only_way: bool) {
    let Some(branch) = function.terminator(block) else { return };
    let loc = function.locs[branch];
    let area = area << TURNED_AREA_AT;
    let mut new: Vec<Inst> = Vec::new();
    let mut emit = |function: &mut Function, data: InstData, ty: Type| {
        let inst = function.make_inst(data, &[ty], loc);
        new.push(inst);
        function.result(inst)
    };
    let three = emit(function, InstData::Const { bits: 3 }, Type::I32);
    let turned = emit(function, InstData::Binary { op: BinaryOp::Rotr, args: [test.pointer, three] }, Type::I32);
    let last = emit(function, InstData::Const { bits: area + test.last }, Type::I32);
    let fits = emit(function, InstData::IntCompare { cc: IntCc::Ule, args: [turned, last] }, Type::I1);
    let insts = &mut function.blocks[block].insts;
    let end = insts.len() - 1;
    insts.splice(end..end, new);
    if let InstData::Branch { cond, .. } = &mut function.insts[branch] {
        *cond = fits;
    }
    if is_only_way {
        use_turned(function, test, turned, area);
    }
}

/// Accesses where the test leads are at the turned pointer without its area. What is written to outputs keeps its address, of which more is known.
fn use_turned(function: &mut Function, test: &Test, turned: Value, area: u64) {
    let is_at = |function: &Function, data: &InstData| match data {
        InstData::Load { addr } | InstData::LoadBit { addr, .. } => {
            addr.base.is_some_and(|base| function.resolve(base) == test.address)
        }
        InstData::Store { addr, .. } | InstData::StoreBit { addr, .. } => {
            addr.region != Region::Q && addr.base.is_some_and(|base| function.resolve(base) == test.address)
        }
        _ => false,
    };
    let insts = function.blocks[test.then].insts.clone();
    if !insts.iter().any(|&inst| is_at(function, &function.insts[inst])) {
        return;
    }
    let minus = u64::from((area as u32).wrapping_neg());
    let constant = function.make_inst(InstData::Const { bits: minus }, &[Type::I32], Loc(0));
    let args = [turned, function.result(constant)];
    let sum = function.make_inst(InstData::Binary { op: BinaryOp::Iadd, args }, &[Type::I32], Loc(0));
    let address = function.result(sum);
    for inst in insts {
        if is_at(function, &function.insts[inst]) {
            match &mut function.insts[inst] {
                InstData::Load { addr }
                | InstData::LoadBit { addr, .. }
                | InstData::Store { addr, .. }
                | InstData::StoreBit { addr, .. } => addr.base = Some(address),
                _ => {}
            }
        }
    }
    function.blocks[test.then].insts.splice(0..0, [constant, sum]);
}

#[cfg(test)]
mod tests {
    use crate::tests::check_body;

    fn text(area: &str, test: &str, access: &str) -> String {
        format!(
            "v2 = const.i32 24\nv3 = lshr v0, v2\nv4 = const.i32 {area}\nv5 = eq v3, v4\nbranch v5, b1, b3\nb1:\n{test}branch v14, b2, \
             b3\nb2:\n{access}b3:\nret v0"
        )
    }

    const TEST: &str = "v6 = const.i32 7\nv7 = and v0, v6\nv8 = const.i32 0\nv9 = eq v7, v8\nv10 = const.i32 16777215\nv11 = and v0, \
                        v10\nv12 = const.i32 3\nv13 = lshr v11, v12\nv15 = const.i32 2\nv16 = iadd v13, v15\nv17 = const.i32 8192\nv18 = \
                        ule v16, v17\n";

    #[test]
    fn bit_and_address_are_one_comparison() {
        let before = format!("{TEST}v14 = and v18, v9\n");
        let after = format!(
            "{TEST}v20 = and v18, v9\nv21 = const.i32 3\nv22 = rotr v0, v21\nv23 = const.i32 {}\nv14 = ule v22, v23\n",
            (0x83 << 21) + 8190
        );
        check_body(
            "pointer-tests",
            &text("131", &before, "v19 = load.i16 M[v13]+0\nstore.i16 Q[v13]+0, v19\nret v13\n"),
            &text(
                "131",
                &after,
                &format!(
                    "v24 = const.i32 {}\nv25 = iadd v22, v24\nv19 = load.i16 M[v25]+0\nstore.i16 Q[v13]+0, v19\nret v13\n",
                    (0x83u32 << 21).wrapping_neg()
                ),
            ),
        );
    }

    #[test]
    fn a_pointer_of_any_area_keeps_its_tests() {
        let before = format!("{TEST}v14 = and v18, v9\n");
        for (from, to) in [("eq v3, v4", "ne v3, v4"), ("16777215", "524287")] {
            let text = text("131", &before, "ret v13\n").replace(from, to);
            check_body("pointer-tests", &text, &text);
        }
    }
}
