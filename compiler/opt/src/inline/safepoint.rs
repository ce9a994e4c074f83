//! The safepoint after a call.
//!
//! ```text
//! v1 = call @FC1(...)
//! v2 = load.i32 state ATTENTION
//! v3 = ne v2, 0
//! branch v3, b8, b2
//! b8 cold:
//! v5 = rt @safepoint(v4)
//! v6 = ne v5, 0
//! branch v6, b9, b2          ; b9 returns: STOP
//! ```

use plcc_abi::RuntimeFn;
use plcc_abi::layout::state;
use plcc_ir::{Address, Block, BlockCall, Function, Inst, InstData, IntCc, Region, Value, Values};

/// A safepoint, in the block that ends with its branch.
pub struct Safepoint {
    branch: Inst,
    /// Where it goes if nothing is due.
    next: BlockCall,
    /// The block that returns on STOP.
    pub exit: Block,
}

impl Safepoint {
    /// The safepoint in `after`, the instructions after the call in its block.
    pub fn after_call(function: &Function, after: &[Inst]) -> Option<Safepoint> {
        let (&branch, straight) = after.split_last()?;
        let InstData::Branch { cond, then_to, else_to } = &function.insts[branch] else { return None };
        let attention = non_zero_test(function, *cond)?;
        let load = straight.iter().position(|&inst| function.results[inst].contains(&attention))?;
        let is_attention = InstData::Load { addr: Address::direct(Region::State, state::ATTENTION) };
        let clear_way = !straight
            .iter()
            .any(|&inst| matches!(function.insts[inst], InstData::Call { .. } | InstData::CallRuntime { .. }));
        if function.insts[straight[load]] != is_attention || !clear_way {
            return None;
        }
        let due = &function.blocks[then_to.block];
        let (&leave, insts) = due.insts.split_last()?;
        let InstData::Branch { cond, then_to: exit, else_to: _ } = &function.insts[leave] else { return None };
        let stop = non_zero_test(function, *cond)?;
        let call = insts.iter().find(|&&inst| function.results[inst].contains(&stop))?;
        let is_safepoint =
            matches!(&function.insts[*call], InstData::CallRuntime { function: RuntimeFn::Safepoint, .. });
        (due.cold && is_safepoint && is_stop_exit(function, exit.block)).then(|| Safepoint {
            branch,
            next: else_to.clone(),
            exit: exit.block,
        })
    }

    /// Takes it out: nothing can be due.
    pub fn remove(&self, function: &mut Function) {
        function.insts[self.branch] = InstData::Jump { target: self.next.clone() };
    }
}

/// Adds constants to a block that returns zeros, so that any block can jump to it.
pub fn make_independent(function: &mut Function, exit: Block) {
    let Some(last) = function.terminator(exit) else { return };
    let InstData::Return { values } = function.insts[last].clone() else { return };
    let loc = function.locs[last];
    let mut insts = Vec::with_capacity(values.len() + 1);
    let mut zeros = Values::with_capacity(values.len());
    for value in values {
        let zero = function.make_inst(InstData::Const { bits: 0 }, &[function.ty(value)], loc);
        insts.push(zero);
        zeros.push(function.result(zero));
    }
    insts.push(last);
    function.insts[last] = InstData::Return { values: zeros };
    function.blocks[exit].insts = insts;
}

/// The value that `cond` compares with 0.
fn non_zero_test(function: &Function, cond: Value) -> Option<Value> {
    match function.defining(cond)? {
        InstData::IntCompare { cc: IntCc::Ne, args: [value, zero] } if function.constant(*zero) == Some(0) => {
            Some(function.resolve(*value))
        }
        _ => None,
    }
}

/// True for the block by which a function leaves on STOP: it is cold and only returns zeros, which are never used. Any
/// other cold block calls the runtime.
pub fn is_stop_exit(function: &Function, block: Block) -> bool {
    let data = &function.blocks[block];
    let Some((&last, insts)) = data.insts.split_last() else { return false };
    let InstData::Return { values } = &function.insts[last] else { return false };
    data.cold
        && data.params.is_empty()
        && insts.iter().all(|&inst| matches!(function.insts[inst], InstData::Const { .. }))
        && values.iter().all(|&value| function.constant(value) == Some(0))
}
