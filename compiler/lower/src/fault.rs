//! Cold paths: synchronous errors.
//!
//! A check that fails leaves the straight path for a cold block, which calls the runtime immediately. If OB 121 (OB 122)
//! has run, the faulty instruction counts as skipped and the program continues after it; if the CPU goes to STOP, the block returns
//! at once. Source: STL reference, synchronous errors.

use plcc_abi::RuntimeFn;
use plcc_abi::layout::{self, state};
use plcc_ir::{Address, BinaryOp, Block, Region, Value};

use crate::block::BlockLowering;

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
    /// i32: number of the data block in which the access is.
    pub db: Option<Value>,
}

/// What remains after an instruction that faulted.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Substitute {
    /// Nothing: it is skipped.
    None,
    /// A value of 32 bits in [`BlockLowering::result`].
    Word,
    /// 0 in [`BlockLowering::result_bit`].
    Bit,
    /// 0 in [`BlockLowering::result_long`].
    Long,
    /// 0 in this many bytes of scratch memory, which a reference refers to then.
    Scratch(u32),
}

impl BlockLowering<'_, '_> {
    /// Begins the path on which all `checks` hold; a failed check continues at the returned block, for
    /// [`BlockLowering::end_guard`]. `None`: nothing can fail.
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
        let access = self.access_with_db(check);
        let mut arguments = vec![site, check.code, access, check.info];
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
            Substitute::Scratch(bytes) => self.clear_scratch(bytes),
        }
        self.stop_exit.leave_if(&mut self.b, stop, after);
    }

    /// Sets the first `bytes` bytes of scratch memory to 0.
    pub fn clear_scratch(&mut self, bytes: u32) {
        let scratch = self.b.i32_const(layout::SCRATCH);
        self.b.clear(Address::indexed(Region::Any, scratch, 0), bytes);
    }

    /// The access byte of OB 121, and the data block in the upper half, which messages name.
    fn access_with_db(&mut self, check: &Check) -> Value {
        let Some(db) = check.db else { return check.access };
        let db = self.b.binary_imm(BinaryOp::Shl, db, 16);
        self.b.binary(BinaryOp::Or, check.access, db)
    }

    /// Ends the path that [`BlockLowering::begin_guard`] began; both paths meet.
    pub fn end_guard(&mut self, after: Option<Block>) {
        if let Some(after) = after {
            self.b.jump(after, &[]);
            self.b.seal_block(after);
            self.b.switch_to(after);
        }
    }

    /// Leaves the function if `stop`, an integer, is not 0.
    pub fn stop_check(&mut self, stop: Value) {
        self.stop_exit.check(&mut self.b, stop);
    }

    /// Runs events that are due.
    pub fn safepoint(&mut self) {
        self.stop_exit.safepoint(&mut self.b, self.site);
    }

    /// Goes to STOP with `event` unless `ok`, an i1.
    pub fn stop_unless(&mut self, ok: Value, event: u16) {
        self.stop_exit.stop_unless(&mut self.b, ok, self.site, event);
    }
}
