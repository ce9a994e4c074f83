//! One block while it is lowered.

use plcc_abi::RuntimeFn;
use plcc_abi::image::BlockKind;
use plcc_abi::layout;
use plcc_abi::s7200::{LOCAL_BYTES, STACK_LEVELS};
use plcc_ir::{Address, Block, FunctionBuilder, Loc, Region, Type, Value, Var};
use plcc_model::CodeBlock;
use plcc_model::s7200::{self as model, Direction, Insn, Operand, Statement, StatementKind, Width};

use super::plan::{self, S7200Plan};
use crate::Output;
use crate::labels::Labels;
use crate::stop::StopExit;

/// The effect of an instruction's error, apart from being noted.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum OnError {
    /// The instruction does nothing.
    Skip,
    /// The CPU stops: compare contacts.
    Stop,
}

/// A FOR that waits for its NEXT.
pub struct Loop<'p> {
    pub operands: &'p [Operand],
    pub body: Block,
    pub after: Block,
}

/// The sequence step around the statements.
#[derive(Clone, Copy)]
pub struct Step<'p> {
    /// Its S bit.
    pub relay: &'p Operand,
    /// The target of CSCRE.
    pub end: Block,
    /// The latched S bit.
    pub gate: Var,
}

/// A block of an S7-200 while it is lowered.
pub struct S7200Lowering<'p, 'o> {
    pub plan: &'o mut S7200Plan<'p>,
    pub output: &'o mut Output<'p>,
    pub block: &'p CodeBlock,
    pub body: &'p model::S7200Body,
    pub b: FunctionBuilder,
    /// The logic stack, S0 first.
    pub stack: [Var; STACK_LEVELS],
    pub eno: Var,
    pub site: u32,
    /// Index of the statement.
    pub index: usize,
    pub on_error: OnError,
    /// The target of an error of this statement, if one is possible.
    failure: Option<Block>,
    stop_exit: StopExit,
    pub labels: Labels<u32>,
    pub loops: Vec<Loop<'p>>,
    pub step: Option<Step<'p>>,
    /// Place of the probes of its begin and its ends, if it has probes.
    pub block_place: Option<u32>,
}

impl<'p, 'o> S7200Lowering<'p, 'o> {
    pub fn new(
        plan: &'o mut S7200Plan<'p>,
        output: &'o mut Output<'p>,
        block: &'p CodeBlock,
        body: &'p model::S7200Body,
    ) -> S7200Lowering<'p, 'o> {
        let name = format!("{}{}", block.kind.prefix(), block.number);
        let mut b = FunctionBuilder::new(name, &plan::parameters(body), &plan::returns(body));
        let stack = std::array::from_fn(|_| b.declare_var(Type::I1));
        let eno = b.declare_var(Type::I1);
        let mut lowering = S7200Lowering {
            plan,
            output,
            block,
            body,
            b,
            stack,
            eno,
            site: 0,
            index: 0,
            on_error: OnError::Skip,
            failure: None,
            stop_exit: StopExit::default(),
            labels: Labels::default(),
            loops: Vec::new(),
            step: None,
            block_place: None,
        };
        lowering.start();
        lowering
    }

    /// OB1 begins with an empty stack, other blocks with S0 = 1. Local data is 0, except for copied parameters.
    fn start(&mut self) {
        let zero = self.b.bool_const(false);
        for var in self.stack.into_iter().chain([self.eno]) {
            self.b.def_var(var, zero);
        }
        if self.block.kind != BlockKind::Ob {
            let one = self.b.bool_const(true);
            self.b.def_var(self.stack[0], one);
        }
        self.b.clear(Address::direct(Region::L, 0), LOCAL_BYTES);
        let copied_in = self.body.parameters.iter().filter(|parameter| parameter.direction != Direction::Out);
        for (index, parameter) in copied_in.enumerate() {
            let value = self.b.param(index);
            let at = Address::direct(Region::L, parameter.byte);
            match parameter.width {
                Width::Bit => self.b.store_bit(at, parameter.bit, value),
                _ => self.b.store(at, value),
            }
        }
        for statement in &self.body.statements {
            if let StatementKind::Instruction { insn: insn @ (Insn::Lbl | Insn::Jmp), operands } = &statement.kind
                && let Some(Operand::Const(number)) = operands.first()
            {
                self.labels.declare(&mut self.b, *number, u32::from(*insn == Insn::Jmp));
            }
        }
    }

    /// Instructions built from now on belong to this statement.
    pub fn begin_statement(&mut self, index: usize, statement: &Statement) {
        self.site = self.output.site(self.block, statement.span, statement.network);
        self.b.set_loc(Loc(self.site + 1));
        self.index = index;
        self.on_error = OnError::Skip;
        if !self.b.is_reachable() {
            // After an unconditional end; kept apart, so the rest still has a block to be in.
            let unreachable = self.b.create_block();
            self.b.seal_block(unreachable);
            self.b.switch_to(unreachable);
        }
    }

    // Variables.

    pub fn get(&mut self, var: Var) -> Value {
        self.b.use_var(var)
    }

    pub fn set(&mut self, var: Var, value: Value) {
        self.b.def_var(var, value);
    }

    /// S0.
    pub fn top(&mut self) -> Value {
        self.get(self.stack[0])
    }

    /// A new S0. In a step that is not active it is 0.
    pub fn set_top(&mut self, value: Value) {
        let value = match self.step {
            Some(step) => {
                let gate = self.get(step.gate);
                self.b.and(value, gate)
            }
            None => value,
        };
        self.set(self.stack[0], value);
    }

    /// Pushes a value; the lowest level is lost.
    pub fn push(&mut self, value: Value) {
        for level in (1..STACK_LEVELS).rev() {
            let upper = self.get(self.stack[level - 1]);
            self.set(self.stack[level], upper);
        }
        self.set_top(value);
    }

    /// Drops the levels from `level` on one place up; S8 becomes 0.
    pub fn close_gap(&mut self, level: usize) {
        for to in level..STACK_LEVELS {
            let value = match self.stack.get(to + 1) {
                Some(&lower) => self.get(lower),
                None => self.b.bool_const(false),
            };
            self.set(self.stack[to], value);
        }
    }

    pub fn site_value(&mut self) -> Value {
        self.b.i32_const(self.site)
    }

    // Boxes and errors.

    /// A box: `body` runs if S0 is 1, with ENO 1 unless it changes it; otherwise ENO is 0.
    pub fn boxed(&mut self, body: impl FnOnce(&mut Self)) {
        self.enabled(true, body);
    }

    /// Like a box, but the instruction has no ENO.
    pub fn conditional(&mut self, body: impl FnOnce(&mut Self)) {
        self.enabled(false, body);
    }

    fn enabled(&mut self, has_eno: bool, body: impl FnOnce(&mut Self)) {
        let enable = self.top();
        let before = self.get(self.eno);
        let skipped = if has_eno { self.b.bool_const(false) } else { before };
        let constant = self.b.constant_bits(enable);
        if constant == Some(0) {
            return self.set(self.eno, skipped);
        }
        let after = self.b.create_block();
        match constant {
            Some(_) => {}
            None => {
                let (run, skip) = (self.b.create_block(), self.b.create_block());
                self.b.branch(enable, run, skip);
                self.b.seal_block(run);
                self.b.seal_block(skip);
                self.b.switch_to(skip);
                self.set(self.eno, skipped);
                self.b.jump(after, &[]);
                self.b.switch_to(run);
            }
        }
        if has_eno {
            let one = self.b.bool_const(true);
            self.set(self.eno, one);
        }
        let outer = self.failure.take();
        body(self);
        if self.b.is_reachable() {
            self.b.jump(after, &[]);
        }
        if let Some(failure) = std::mem::replace(&mut self.failure, outer) {
            self.b.seal_block(failure);
            self.b.switch_to(failure);
            self.set(self.eno, skipped);
            self.b.jump(after, &[]);
        }
        self.b.seal_block(after);
        self.b.switch_to(after);
    }

    /// An instruction that acts with any S0, and does nothing after an error.
    pub fn guarded(&mut self, body: impl FnOnce(&mut Self)) {
        let outer = self.failure.take();
        body(self);
        if let Some(failure) = std::mem::replace(&mut self.failure, outer) {
            let after = self.b.create_block();
            self.b.jump(after, &[]);
            self.b.seal_block(failure);
            self.b.switch_to(failure);
            self.b.jump(after, &[]);
            self.b.seal_block(after);
            self.b.switch_to(after);
        }
    }

    /// Like [`S7200Lowering::guarded`], for a `body` that ends its block; an error goes to `after`.
    pub fn guarded_to(&mut self, after: Block, body: impl FnOnce(&mut Self)) {
        let outer = self.failure.take();
        body(self);
        if let Some(failure) = std::mem::replace(&mut self.failure, outer) {
            self.b.seal_block(failure);
            self.b.switch_to(failure);
            self.b.jump(after, &[]);
        }
    }

    /// Non-fatal error `code` unless `ok`: it is noted, and the instruction does nothing more. A compare contact stops the CPU with `fatal`.
    pub fn error_unless(&mut self, ok: Value, code: u16, fatal: u16) {
        if self.b.constant_bits(ok) == Some(1) {
            return;
        }
        let (cold, next) = (self.b.create_cold_block(), self.b.create_block());
        self.b.branch(ok, next, cold);
        self.b.seal_block(cold);
        self.b.seal_block(next);
        self.b.switch_to(cold);
        match self.on_error {
            OnError::Skip => {
                let (site, code) = (self.site_value(), self.b.i32_const(u32::from(code)));
                self.b.call_runtime(RuntimeFn::S7200Error, &[site, code]);
                let failure = *self.failure.get_or_insert_with(|| self.b.create_cold_block());
                self.b.jump(failure, &[]);
            }
            OnError::Stop => {
                self.stop_exit.stop(&mut self.b, self.site, plcc_abi::s7200::fatal::EVENT | fatal);
            }
        }
        self.b.switch_to(next);
    }

    // Control flow.

    /// Leaves the block if `stop`, an integer, is not 0.
    pub fn stop_check(&mut self, stop: Value) {
        self.stop_exit.check(&mut self.b, stop);
    }

    /// Runs events that are due.
    pub fn safepoint(&mut self) {
        self.stop_exit.safepoint(&mut self.b, self.site);
    }

    pub fn network_safepoint(&mut self) {
        if self.plan.has_interrupts {
            self.safepoint();
        }
    }

    /// Returns, with the values to copy back.
    pub fn leave(&mut self) {
        self.probe_leave();
        let copied_back = self.body.parameters.iter().filter(|parameter| parameter.direction != Direction::In);
        let values: Vec<Value> = copied_back
            .map(|parameter| {
                let at = Address::direct(Region::L, parameter.byte);
                match parameter.width {
                    Width::Bit => self.b.load_bit(at, parameter.bit),
                    width => self.b.load(plan::ir_type(width), at),
                }
            })
            .collect();
        self.b.ret(&values);
    }

    /// Ends the function.
    pub fn finish(mut self) -> plcc_ir::Function {
        if self.b.is_reachable() {
            self.leave();
        }
        self.stop_exit.finish(&mut self.b, &plan::returns(self.body));
        self.b.set_frame_bytes(layout::frame_bytes(LOCAL_BYTES));
        self.b.finish()
    }
}
