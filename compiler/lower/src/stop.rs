//! STOP and safepoints: where a function leaves early. The same for all families.

use plcc_abi::layout::state;
use plcc_abi::{RuntimeFn, Type};
use plcc_ir::{Block, FunctionBuilder, IntCc, Value};

/// Where a function leaves when the CPU goes to STOP; values returned from there have no meaning. The block exists once
/// something leads to it.
#[derive(Default)]
pub struct StopExit {
    block: Option<Block>,
}

/// The blocks of a safepoint: events that are due run in the cold one, and both paths meet at the next.
#[derive(Clone, Copy)]
pub struct SafepointBlocks {
    cold: Block,
    next: Block,
}

impl SafepointBlocks {
    pub fn new(b: &mut FunctionBuilder) -> SafepointBlocks {
        SafepointBlocks { cold: b.create_cold_block(), next: b.create_block() }
    }
}

impl StopExit {
    fn block(&mut self, b: &mut FunctionBuilder) -> Block {
        *self.block.get_or_insert_with(|| b.create_cold_block())
    }

    /// Leaves the function if `stop`, an integer, is not 0; otherwise goes to `next`. Ends the current block.
    pub fn leave_if(&mut self, b: &mut FunctionBuilder, stop: Value, next: Block) {
        let stops = b.icmp_imm(IntCc::Ne, stop, 0);
        let exit = self.block(b);
        b.branch(stops, exit, next);
    }

    /// Leaves the function if `stop`, an integer, is not 0.
    pub fn check(&mut self, b: &mut FunctionBuilder, stop: Value) {
        let next = b.create_block();
        self.leave_if(b, stop, next);
        b.seal_block(next);
        b.switch_to(next);
    }

    /// Goes to STOP with `event`. Ends the current block.
    pub fn stop(&mut self, b: &mut FunctionBuilder, site: u32, event: u16) {
        let (site, event) = (b.i32_const(site), b.i32_const(u32::from(event)));
        b.call_runtime(RuntimeFn::Stop, &[site, event]);
        let exit = self.block(b);
        b.jump(exit, &[]);
    }

    /// Goes to STOP with `event` unless `ok`, an i1.
    pub fn stop_unless(&mut self, b: &mut FunctionBuilder, ok: Value, site: u32, event: u16) {
        if b.constant_bits(ok) == Some(1) {
            return;
        }
        let (cold, next) = (b.create_cold_block(), b.create_block());
        b.branch(ok, next, cold);
        b.seal_block(cold);
        b.switch_to(cold);
        self.stop(b, site, event);
        b.seal_block(next);
        b.switch_to(next);
    }

    /// Runs events that are due: one load, one test, one branch that is rarely taken.
    pub fn safepoint(&mut self, b: &mut FunctionBuilder, site: u32) {
        let blocks = SafepointBlocks::new(b);
        self.safepoint_in(b, blocks, site);
    }

    /// Like [`StopExit::safepoint`], with blocks created before.
    pub fn safepoint_in(
        &mut self,
        b: &mut FunctionBuilder,
        SafepointBlocks { cold, next }: SafepointBlocks,
        site: u32,
    ) {
        let attention = b.load_state(state::ATTENTION);
        let due = b.icmp_imm(IntCc::Ne, attention, 0);
        b.branch(due, cold, next);
        b.seal_block(cold);
        b.switch_to(cold);
        let site = b.i32_const(site);
        let stop = b.call_runtime(RuntimeFn::Safepoint, &[site]).expect("safepoint has a result");
        self.leave_if(b, stop, next);
        b.seal_block(next);
        b.switch_to(next);
    }

    /// Builds the exit, if anything leads to it, of a function that returns values of types `returns`.
    pub fn finish(self, b: &mut FunctionBuilder, returns: &[Type]) {
        let Some(exit) = self.block else { return };
        b.seal_block(exit);
        b.switch_to(exit);
        let zeros: Vec<Value> = returns.iter().map(|&ty| b.iconst(ty, 0)).collect();
        b.ret(&zeros);
    }
}
