//! Short loops become straight code, and others whose passes can be counted do several passes in one.
//!
//! A loop over the rows of a matrix or the words of a telegram has few passes, and their number is known. With a copy of the loop for
//! each pass its counter is a constant, so are the addresses made from it, and there is nothing to test:
//!
//! ```text
//! b1(v1: i16):               ; b1:
//!     v2 = ... v1 ...        ;     v2 = ... 1 ...
//!     v3 = iadd v1, 1        ;     v4 = ... 2 ...
//!     v4 = sle v3, 2         ;
//!     branch v4, b1(v3), b2  ;
//! ```
//!
//! A loop that tests at its head, before it does anything, gets one more copy of the head for the last test. The loop stays after the
//! copies for passes that they are not made for, so that nothing depends on the number. Where it is right, later passes find that no
//! jump leads there.
//!
//! A loop with more passes gets as many copies inside as divide their number, which test nothing: 128 passes become 16 of eight. The
//! address in the second copy is that in the first and a constant, and eight bits of an array are in one byte. A loop that ends where its
//! counter is equal to something, as those of LOOP do, gets a new counter of its passes: from the old one, with steps of five, no range shows how
//! far the pointers of the loop get.

use plcc_ir::analysis::{ControlFlow, Dominators};
use plcc_ir::function::ValueDef;
use plcc_ir::{Address, BinaryOp, Block, Function, Inst, InstData, IntCc, Loc, Region, Type, Value, eval};
use rustc_hash::FxHashSet;

use crate::loops::{Loop, Loops};
use crate::variables::{Versions, copy_blocks, join_versions, move_constants};

/// Passes of a loop that becomes straight code.
const PASSES_MAX: usize = 16;
/// Instructions of all passes together, without constants.
const INSTS_MAX: usize = 320;
/// Passes that are counted.
const COUNTED_MAX: usize = 1024;
/// Passes that become one.
const TOGETHER_MAX: usize = 8;
/// Passes whose bits of an array are in one byte.
const BITS_TOGETHER: usize = 8;
/// Loads of such a pass: what they bring is in registers at the same time.
const LOADS_MAX: usize = 8;
/// Instructions of such a pass.
const TOGETHER_INSTS_MAX: usize = 200;
/// Instructions that copies may add to a function.
const GROWTH: usize = 2000;
/// Rounds over a function: where one loop follows another, the second waits.
const ROUNDS_MAX: usize = 8;
/// Larger functions are left as they are.
const FUNCTION_MAX: usize = 20_000;

/// Unrolls short loops in a function. Result: whether there were any.
pub fn unroll_loops(function: &mut Function) -> bool {
    if function.insts.len() > FUNCTION_MAX {
        return false;
    }
    let (mut growth, mut done) = (GROWTH, FxHashSet::default());
    for _ in 0..ROUNDS_MAX {
        if !unroll_in_function(function, &mut growth, &mut done) {
            break;
        }
    }
    !done.is_empty()
}

/// Result: whether a loop is left that begins where one that was copied ends.
fn unroll_in_function(function: &mut Function, growth: &mut usize, done: &mut FxHashSet<Block>) -> bool {
    let cfg = ControlFlow::new(function);
    let dominators = Dominators::new(function, &cfg);
    let loops = Loops::new(function, &cfg, &dominators);
    let headers: FxHashSet<Block> = loops.all.iter().map(|each| each.header).collect();
    let mut versions = Versions::default();
    let mut copied: FxHashSet<Block> = FxHashSet::default();
    let mut is_left = false;
    for each in &loops.all {
        let is_innermost = each.blocks.iter().all(|block| *block == each.header || !headers.contains(block));
        let is_constant = |inst: &Inst| matches!(function.insts[*inst], InstData::Const { .. });
        let insts = |block: &Block| function.blocks[*block].insts.iter().filter(|inst| !is_constant(inst)).count();
        let size: usize = each.blocks.iter().map(insts).sum();
        if !is_innermost || each.header == function.entry() || size * 2 > INSTS_MAX || function.blocks[each.header].cold
        {
            continue;
        }
        if done.contains(&each.header) {
            continue;
        }
        let Some(passes) = passes(function, &cfg, each) else { continue };
        let Some(copies) = copies(function, each, passes.count, size) else { continue };
        let size = copies * size;
        if size > *growth {
            continue;
        }
        if cfg.predecessors(each.header).iter().any(|pred| copied.contains(pred)) {
            is_left = true;
            continue;
        }
        // A block of a loop that was copied is no longer on all ways.
        let before = dominators.immediate(each.header).filter(|before| !copied.contains(before));
        let before = before.unwrap_or(function.entry());
        *growth -= size;
        done.insert(each.header);
        copied.extend(&each.blocks);
        let order = order(function, each);
        move_constants(function, &order, before);
        if copies == passes.count {
            copy_before(function, &cfg, &order, passes, &mut versions);
        } else {
            copy_inside(function, &cfg, &order, (passes, copies), &mut versions);
        }
    }
    if !versions.made.is_empty() {
        join_versions(function, &versions);
    }
    is_left && !versions.made.is_empty()
}

/// How often a loop does what is in it.
#[derive(Clone, Copy)]
struct Passes {
    header: Block,
    count: usize,
    /// The block whose branch decides whether there is another pass, and where it goes if there is one.
    test: Block,
    stays: Block,
    /// The test is at the head, which is reached once more than there are passes.
    tests_first: bool,
}

/// How many passes of a loop become straight code: all of them, or a part of them that divides their number.
fn copies(function: &Function, each: &Loop, passes: usize, size: usize) -> Option<usize> {
    if passes <= PASSES_MAX && passes * size <= INSTS_MAX {
        return Some(passes);
    }
    let hot = each.blocks.iter().filter(|&&block| !function.blocks[block].cold);
    let insts: Vec<Inst> = hot.flat_map(|&block| function.blocks[block].insts.iter().copied()).collect();
    let numbers = bit_numbers(function, &insts);
    let (mut loads, mut bits) = (0, 0);
    for &inst in &insts {
        match &function.insts[inst] {
            InstData::Load { addr } if addr.region == Region::State => {}
            InstData::Load { addr } if has_bit(function, addr, &numbers) => bits += 1,
            InstData::Load { .. } => loads += 1,
            _ => {}
        }
    }
    // Eight bits in a row are mostly one byte, which is there when the first of them is.
    let loads = |count: usize| count * if count == BITS_TOGETHER { loads } else { loads + bits };
    (2..=TOGETHER_MAX)
        .rev()
        .find(|&count| passes.is_multiple_of(count) && loads(count) <= LOADS_MAX && count * size <= TOGETHER_INSTS_MAX)
}

/// Computed numbers of bits: what is shifted by their lowest three bits is a byte.
fn bit_numbers(function: &Function, insts: &[Inst]) -> FxHashSet<Value> {
    let number = |&inst: &Inst| {
        let InstData::Binary { op: BinaryOp::Lshr | BinaryOp::Shl, args: [_, count] } = function.insts[inst] else {
            return None;
        };
        match *function.defining(count)? {
            InstData::Binary { op: BinaryOp::And, args: [number, mask] } if function.constant(mask) == Some(7) => {
                Some(function.resolve(number))
            }
            _ => None,
        }
    };
    insts.iter().filter_map(number).collect()
}

/// True of the byte in which the bit with one of the numbers is.
fn has_bit(function: &Function, addr: &Address, numbers: &FxHashSet<Value>) -> bool {
    let byte = addr.base.and_then(|base| function.defining(base));
    let Some(&InstData::Binary { op: BinaryOp::Lshr, args: [number, count] }) = byte else { return false };
    function.constant(count) == Some(3) && numbers.contains(&function.resolve(number))
}

/// How many passes the loop has, if a counter with constant ends decides that.
fn passes(function: &Function, cfg: &ControlFlow, each: &Loop) -> Option<Passes> {
    let inside = |block: &Block| each.blocks.contains(block);
    let jumps = |from: Block, to: Block| {
        let last = function.terminator(from)?;
        let calls = function.insts[last].targets().into_iter().filter(|call| call.block == to);
        let mut calls: Vec<_> = calls.collect();
        (calls.len() == 1).then(|| calls.remove(0))
    };
    let (back, enter): (Vec<Block>, Vec<Block>) = cfg.predecessors(each.header).iter().partition(|pred| inside(pred));
    let (&[back], &[enter]) = (&back[..], &enter[..]) else { return None };
    // Each pass goes through the header and the jump back; one of them decides whether it is the last.
    let (test, cond, then_to, else_to) = [each.header, back].into_iter().find_map(|block| {
        let InstData::Branch { cond, then_to, else_to } = &function.insts[function.terminator(block)?] else {
            return None;
        };
        (inside(&then_to.block) != inside(&else_to.block)).then_some((block, *cond, then_to.block, else_to.block))
    })?;
    let stays_if = inside(&then_to);
    let (first, next) = (jumps(enter, each.header)?, jumps(back, each.header)?);
    let tests_first = test == each.header && test != back;
    let params = &function.blocks[each.header].params;
    params.iter().enumerate().find_map(|(index, &param)| {
        let mut counter = function.constant(first.args[index])?;
        for tested in 1..=COUNTED_MAX {
            let value = |of: Value| evaluate(function, of, (param, counter), 8);
            let stays = (value(cond)? != 0) == stays_if;
            if !stays {
                let count = tested - usize::from(tests_first);
                let stays = if stays_if { then_to } else { else_to };
                return (count > 0).then_some(Passes { header: each.header, count, test, stays, tests_first });
            }
            counter = value(next.args[index])?;
        }
        None
    })
}

/// The value where the parameter has that one, through so many operations.
fn evaluate(function: &Function, value: Value, counter: (Value, u64), depth: u32) -> Option<u64> {
    let value = function.resolve(value);
    if value == counter.0 {
        return Some(counter.1);
    }
    if depth == 0 {
        return None;
    }
    let of = |value: Value| evaluate(function, value, counter, depth - 1);
    let ValueDef::Result(inst, _) = function.values[value].def else { return None };
    let ty = function.ty(value);
    match function.insts[inst] {
        InstData::Const { bits } => Some(bits),
        InstData::Binary { op, args: [a, b] } => eval::binary(op, ty, of(a)?, of(b)?),
        InstData::IntCompare { cc, args: [a, b] } => {
            Some(u64::from(eval::int_compare(cc, function.ty(a), of(a)?, of(b)?)))
        }
        InstData::Convert { op, arg } => Some(eval::convert(op, function.ty(arg), ty, of(arg)?)),
        _ => None,
    }
}

/// The blocks of a loop as they are laid out.
fn order(function: &Function, each: &Loop) -> Vec<Block> {
    let inside: FxHashSet<Block> = each.blocks.iter().copied().collect();
    function.layout.iter().copied().filter(|block| inside.contains(block)).collect()
}

/// The blocks that jump to the head of a loop: from outside, and from its blocks.
fn ways(cfg: &ControlFlow, header: Block, order: &[Block]) -> (Vec<Block>, Vec<Block>) {
    cfg.predecessors(header).iter().copied().partition(|pred| !order.contains(pred))
}

/// Makes jumps from `ways` that lead to `to` lead to `new`.
fn redirect(function: &mut Function, ways: &[Block], to: Block, new: Block) {
    for &way in ways {
        let Some(last) = function.terminator(way) else { continue };
        function.insts[last].for_each_target_mut(|call| {
            if call.block == to {
                call.block = new;
            }
        });
    }
}

/// Puts a copy for each pass before the loop.
fn copy_before(function: &mut Function, cfg: &ControlFlow, order: &[Block], passes: Passes, versions: &mut Versions) {
    let (enter, back) = ways(cfg, passes.header, order);
    let (mut ways, mut to) = (enter, passes.header);
    let place = function.layout.iter().position(|&block| block == order[0]).unwrap_or(0);
    let first = function.layout.len();
    for pass in 0..passes.count + usize::from(passes.tests_first) {
        let blocks = if pass < passes.count { order } else { &[passes.header] };
        let copies = copy_blocks(function, blocks, versions);
        redirect(function, &ways, to, copies[&passes.header]);
        ways = back.iter().filter_map(|block| copies.get(block).copied()).collect();
        to = copies[&passes.header];
    }
    redirect(function, &ways, to, passes.header);
    // The copies are laid out before the loop.
    let made = function.layout.split_off(first);
    function.layout.splice(place..place, made);
}

/// Gives the loop copies of its blocks, so that it does so many passes in one and tests once.
fn copy_inside(
    function: &mut Function,
    cfg: &ControlFlow,
    order: &[Block],
    (passes, count): (Passes, usize),
    versions: &mut Versions,
) {
    let (enter, back) = ways(cfg, passes.header, order);
    let place = function.layout.iter().rposition(|block| order.contains(block)).map_or(0, |last| last + 1);
    let first = function.layout.len();
    let copies: Vec<_> = (1..count).map(|_| copy_blocks(function, order, versions)).collect();
    // Each copy jumps back to its own head: now to that of the next one.
    let (mut ways, mut to) = (back.clone(), passes.header);
    let mut tests = vec![(passes.test, passes.stays)];
    for copy in &copies {
        redirect(function, &ways, to, copy[&passes.header]);
        if let Some((_, stays)) = tests.last_mut().filter(|(_, stays)| *stays == to) {
            *stays = copy[&passes.header];
        }
        ways = back.iter().map(|block| copy[block]).collect();
        to = copy[&passes.header];
        tests.push((copy[&passes.test], copy[&passes.stays]));
    }
    redirect(function, &ways, to, passes.header);
    // The test that stays is before the first pass or after the last one.
    let (test, _) = tests.remove(if passes.tests_first { 0 } else { count - 1 });
    if !passes.tests_first {
        count_passes(function, passes.header, &enter, (test, passes.count / count));
    }
    for (test, stays) in tests {
        let last = function.terminator(test).expect("it ends with a branch");
        let target = function.insts[last].targets().into_iter().find(|call| call.block == stays).cloned();
        function.insts[last] = InstData::Jump { target: target.expect("it leads to the next pass") };
    }
    let made = function.layout.split_off(first);
    function.layout.splice(place..place, made);
}

/// Gives a loop that tests at its end whether its counter is equal to something a counter of its `passes`, which ends at 0.
fn count_passes(function: &mut Function, header: Block, enter: &[Block], (test, passes): (Block, usize)) {
    let Some(last) = function.terminator(test) else { return };
    let InstData::Branch { cond, then_to, else_to } = &function.insts[last] else { return };
    let is_equality = matches!(function.defining(*cond), Some(InstData::IntCompare { cc: IntCc::Eq | IntCc::Ne, .. }));
    let stays_if = then_to.block == header;
    if !is_equality || stays_if == (else_to.block == header) {
        return;
    }
    let constant = |function: &mut Function, bits: u64| {
        function.make_inst(InstData::Const { bits: eval::mask(Type::I32, bits) }, &[Type::I32], Loc(0))
    };
    let loc = function.locs[last];
    let [one_less, zero] = [u64::MAX, 0].map(|bits| constant(function, bits));
    let counter = function.add_param(header, Type::I32);
    let args = [counter, function.result(one_less)];
    let rest = function.make_inst(InstData::Binary { op: BinaryOp::Iadd, args }, &[Type::I32], loc);
    let cc = if stays_if { IntCc::Ne } else { IntCc::Eq };
    let args = [function.result(rest), function.result(zero)];
    let compared = function.make_inst(InstData::IntCompare { cc, args }, &[Type::I1], loc);
    let insts = &mut function.blocks[test].insts;
    insts.truncate(insts.len() - 1);
    insts.extend([one_less, rest, zero, compared, last]);
    let (rest, compared) = (function.result(rest), function.result(compared));
    if let InstData::Branch { cond, .. } = &mut function.insts[last] {
        *cond = compared;
    }
    bring(function, last, header, rest);
    for &way in enter {
        let Some(last) = function.terminator(way) else { continue };
        let first = constant(function, passes as u64);
        let insts = &mut function.blocks[way].insts;
        insts.insert(insts.len() - 1, first);
        let first = function.result(first);
        bring(function, last, header, first);
    }
}

/// The jump of `last` to `header` brings one more value.
fn bring(function: &mut Function, last: Inst, header: Block, value: Value) {
    function.insts[last].for_each_target_mut(|call| {
        if call.block == header {
            call.args.push(value);
        }
    });
}

#[cfg(test)]
mod tests {
    use crate::tests::check_pass;

    #[test]
    fn a_loop_that_ends_at_a_number_counts_its_passes() {
        let text = "; passes: unroll, control-flow, fold, unused
            func @F -> i32 {
            b0(v0: i32):
            v1 = const.i16 20
            v2 = const.i16 65535
            v3 = const.i16 1
            v4 = const.i32 4
            jump b1(v1, v0)
            b1(v5: i16, v6: i32):
            v7 = load.i32 M[v6]+0
            store.i32 M 0, v7
            v8 = iadd v6, v4
            v9 = iadd v5, v2
            v10 = ne v5, v3
            branch v10, b1(v9, v8), b2
            b2:
            ret v6
            }";
        let result = crate::run_listed_passes(text).expect("text is well formed");
        assert_eq!(result.matches("load").count(), 5, "{result}");
        // Four passes of five, of which only the new counter decides.
        assert!(result.contains("const.i32 4\n") && result.contains("ne v") && !result.contains("i16"), "{result}");
    }

    #[test]
    fn eight_bits_are_one_load() {
        let text = |mask: u32| {
            format!(
                "; passes: unroll
                func @F -> i32 {{
                b0:
                v0 = const.i32 0
                v1 = const.i32 1
                v2 = const.i32 3
                v3 = const.i32 {mask}
                v4 = const.i32 32
                jump b1(v0, v0)
                b1(v5: i32, v6: i32):
                v7 = lshr v5, v2
                v8 = and v5, v3
                v9 = load.i8 M[v7]+0
                v10 = load.i8 M[v7]+8
                v11 = xor v9, v10
                v12 = zext.i32 v11
                v13 = lshr v12, v8
                v14 = iadd v6, v13
                v15 = iadd v5, v1
                v16 = slt v15, v4
                branch v16, b1(v15, v14), b2
                b2:
                ret v6
                }}"
            )
        };
        let loads = |mask: u32| {
            let result = crate::run_listed_passes(&text(mask)).expect("text is well formed");
            result.matches("load").count()
        };
        // Bytes of other numbers are loaded each.
        assert_eq!((loads(7), loads(3)), (2 * 8, 2 * 4));
    }

    #[test]
    fn eight_bits_may_have_a_word_each() {
        let text = "; passes: unroll
            func @F {
            b0:
            v0 = const.i32 0
            v1 = const.i32 1
            v2 = const.i32 3
            v3 = const.i32 7
            v4 = const.i32 64
            jump b1(v0)
            b1(v5: i32):
            v6 = shl v5, v1
            v7 = load.i16 M[v6]+100
            v8 = zext.i32 v7
            v9 = lshr v5, v2
            v10 = and v5, v3
            v11 = load.i8 M[v9]+0
            v12 = zext.i32 v11
            v13 = shl v8, v10
            v14 = xor v12, v13
            v15 = trunc.i8 v14
            store.i8 M[v9]+0, v15
            v16 = iadd v5, v1
            v17 = slt v16, v4
            branch v17, b1(v16), b2
            b2:
            ret
            }";
        let result = crate::run_listed_passes(text).expect("text is well formed");
        assert_eq!(result.matches("store").count(), 8, "{result}");
    }

    #[test]
    fn a_loop_of_two_passes_is_straight() {
        let text = |passes: u32| {
            format!(
                "; passes: unroll, control-flow, fold, control-flow, dead-code
                func @F -> i32 {{
                b0(v0: i32):
                v1 = const.i16 1
                jump b1(v1, v0)
                b1(v2: i16, v3: i32):
                v4 = sext.i32 v2
                v5 = imul v3, v4
                v6 = iadd v2, v1
                v7 = const.i16 {passes}
                v8 = sle v6, v7
                branch v8, b1(v6, v5), b2
                b2:
                ret v5
                }}"
            )
        };
        let result = |passes: u32| {
            let text = text(passes);
            crate::run_listed_passes(&text).expect("text is well formed")
        };
        assert!(!result(2).contains("branch"), "{}", result(2));
        assert!(!result(16).contains("branch"), "{}", result(16));
        assert!(result(17).contains("branch"), "{}", result(17));
        check_pass("unroll", &text(17), &text(17));
    }

    #[test]
    fn a_loop_that_tests_at_its_head_is_straight() {
        let text = |passes: u32| {
            format!(
                "; passes: unroll, fold, control-flow, fold, control-flow, dead-code
                func @F -> i32 {{
                b0(v0: i32):
                v1 = const.i16 1
                jump b1(v1, v0)
                b1(v2: i16, v3: i32):
                v4 = const.i16 {passes}
                v5 = sle v2, v4
                branch v5, b2, b3
                b2:
                v6 = sext.i32 v2
                v7 = imul v3, v6
                store.i16 M 0, v2
                v8 = iadd v2, v1
                jump b1(v8, v7)
                b3:
                ret v3
                }}"
            )
        };
        let result = |passes: u32| crate::run_listed_passes(&text(passes)).expect("text is well formed");
        let count = |passes: u32| result(passes).matches("store").count();
        assert!(!result(1).contains("branch") && count(1) == 1, "{}", result(1));
        assert!(!result(16).contains("branch") && count(16) == 16, "{}", result(16));
        assert!(result(17).contains("branch") && count(17) == 1, "{}", result(17));
        // Three passes of six, and one test for each three.
        assert!(count(18) == 6 && result(18).matches("branch").count() == 1, "{}", result(18));
        check_pass("unroll", &text(17), &text(17));
    }

    #[test]
    fn a_jump_from_a_block_that_nothing_reaches_does_not_matter() {
        let text = "; passes: unroll
            func @F -> i32 {
            b0(v0: i32):
            v1 = const.i16 1
            v2 = const.i16 4
            jump b1(v1)
            b1(v3: i16):
            v4 = sext.i32 v3
            v5 = iadd v3, v1
            v6 = slt v5, v2
            branch v6, b1(v5), b2(v0)
            b2(v7: i32):
            v8 = iadd v4, v7
            ret v8
            b3:
            v9 = sext.i32 v3
            jump b2(v9)
            }";
        let result = crate::run_listed_passes(text).expect("text is well formed");
        assert_eq!(result.matches("sext").count(), 3 + 1, "{result}");
    }
}
