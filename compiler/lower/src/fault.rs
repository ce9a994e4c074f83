//! Cold paths: synchronous errors, STOP, safepoints.
//!
//! A check that fails leaves the straight path for a cold block, which calls the runtime immediately. If OB 121 (OB 122)
//! has run, the faulty instruction counts as skipped and the program continues after it; if the CPU goes to STOP, the block returns
//! at once. Source: STL reference, synchronous errors.

use plcc_abi::RuntimeFn;
use plcc_abi::layout::state;
use plcc_ir::{Block, IntCc, Value};

use crate::context::Context;

/// A condition; if it is false, an instruction is a synchronous error.
pub struct Check {
    /// i1: 1 if all is well.
    pub ok: Value,
    /// i32: `SW_FLT`.
    pub code: Value,
    /// i32: access byte of OB 121.
    pub access: Value,
    /// i32: fault register, an address or a number.
    pub info: Value,
}

/// What remains after an instruction that faulted.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Substitute {
    /// Nothing: it is skipped.
    None,
    /// A value of 32 bits in [`Context::result`].
    Word,
    /// 0 in [`Context::result_bit`].
    Bit,
    /// 0 in [`Context::result_long`].
    Long,
}

/// The blocks of a safepoint: events that are due run in the cold one, and both paths meet at the next.
#[derive(Clone, Copy)]
pub struct SafepointBlocks {
    cold: Block,
    next: Block,
}

impl Context<'_, '_> {
    /// Begins the path on which all `checks` hold; a failed check continues at the returned block, for
    /// [`Context::end_guard`]. `None`: nothing can fail.
    pub fn begin_guard(&mut self, checks: Vec<Check>, substitute: Substitute) -> Option<Block> {
        let mut after = None;
        for check in checks {
            if self.b.constant_bits(check.ok) == Some(1) {
                continue;
            }
            let after = *after.get_or_insert_with(|| self.b.create_block());
            let (good, bad) = (self.b.create_block(), self.b.create_cold_block());
            self.b.branch(check.ok, good, bad);
            self.b.seal_block(good);
            self.b.seal_block(bad);
            self.b.switch_to(bad);
            self.raise(&check, substitute, after);
            self.b.switch_to(good);
        }
        after
    }

    /// Calls the error OB, then continues at `after`.
    fn raise(&mut self, check: &Check, substitute: Substitute, after: Block) {
        let site = self.b.i32_const(self.site);
        let mut arguments = vec![site, check.code, check.access, check.info];
        let mut function = RuntimeFn::SyncError;
        if self.plan.handles_errors(self.block.key()) {
            function = RuntimeFn::LocalError;
            arguments.push(self.b.frame_base(false));
        }
        let stop = self.b.call_runtime(function, &arguments).expect("both have a result");
        match substitute {
            Substitute::None => {}
            Substitute::Word => {
                let value = self.b.load_state(state::SUBSTITUTE);
                self.b.def_var(self.result, value);
            }
            Substitute::Bit => {
                let zero = self.b.bool_const(false);
                self.b.def_var(self.result_bit, zero);
            }
            Substitute::Long => {
                let zero = self.b.iconst(plcc_abi::Type::I64, 0);
                self.b.def_var(self.result_long, zero);
            }
        }
        self.leave_if(stop, after);
    }

    /// Ends the path that [`Context::begin_guard`] began; both paths meet.
    pub fn end_guard(&mut self, after: Option<Block>) {
        if let Some(after) = after {
            self.b.jump(after, &[]);
            self.b.seal_block(after);
            self.b.switch_to(after);
        }
    }

    /// Leaves the function if `stop`, an i32, is not 0; otherwise goes to `next`. Ends the current block.
    fn leave_if(&mut self, stop: Value, next: Block) {
        let stops = self.b.icmp_imm(IntCc::Ne, stop, 0);
        let exit = self.exit();
        self.b.branch(stops, exit, next);
    }

    /// Leaves the function if `stop`, an i32, is not 0.
    pub fn stop_check(&mut self, stop: Value) {
        let next = self.b.create_block();
        self.leave_if(stop, next);
        self.b.seal_block(next);
        self.b.switch_to(next);
    }

    /// Runs events that are due: one load, one test, one branch that is rarely taken.
    pub fn safepoint(&mut self) {
        let blocks = self.safepoint_blocks();
        self.safepoint_in(blocks);
    }

    pub fn safepoint_blocks(&mut self) -> SafepointBlocks {
        SafepointBlocks { cold: self.b.create_cold_block(), next: self.b.create_block() }
    }

    /// Like [`Context::safepoint`], with blocks created before.
    pub fn safepoint_in(&mut self, SafepointBlocks { cold, next }: SafepointBlocks) {
        let attention = self.b.load_state(state::ATTENTION);
        let due = self.b.icmp_imm(IntCc::Ne, attention, 0);
        self.b.branch(due, cold, next);
        self.b.seal_block(cold);
        self.b.switch_to(cold);
        let site = self.b.i32_const(self.site);
        let stop = self.b.call_runtime(RuntimeFn::Safepoint, &[site]).expect("safepoint has a result");
        self.leave_if(stop, next);
        self.b.seal_block(next);
        self.b.switch_to(next);
    }

    /// Goes to STOP with `event` unless `ok`, an i1.
    pub fn stop_unless(&mut self, ok: Value, event: u16) {
        if self.b.constant_bits(ok) == Some(1) {
            return;
        }
        let (cold, next) = (self.b.create_cold_block(), self.b.create_block());
        self.b.branch(ok, next, cold);
        self.b.seal_block(cold);
        self.b.switch_to(cold);
        let site = self.b.i32_const(self.site);
        let event = self.b.i32_const(u32::from(event));
        self.b.call_runtime(RuntimeFn::Stop, &[site, event]);
        let exit = self.exit();
        self.b.jump(exit, &[]);
        self.b.seal_block(next);
        self.b.switch_to(next);
    }
}
