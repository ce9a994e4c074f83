//! Sequence control: steps that begin with LSCR and end with SCRE. Source: S7-200 system manual, SCR instructions.
//!
//! LSCR latches the S bit of the step as a gate. While it is 0, every value that reaches S0 is 0, so conditional instructions do
//! nothing, coils are off, timers and counters see 0.

use plcc_ir::Type;
use plcc_model::s7200::{Operand, StatementKind, Width};

use super::block::{S7200Lowering, Step};

impl S7200Lowering<'_, '_> {
    /// `LSCR`.
    pub fn begin_step(&mut self, operands: &[Operand]) {
        let body = self.body;
        let own = body.statements.get(self.index).and_then(|statement| match &statement.kind {
            StatementKind::Instruction { operands, .. } => operands.first(),
            _ => None,
        });
        let ([relay], Some(own)) = (operands, own) else { return };
        let active = self.read(relay, Width::Bit);
        let gate = self.b.declare_var(Type::I1);
        self.set(gate, active);
        let end = self.b.create_block();
        self.step = Some(Step { relay: own, end, gate });
        self.push(active);
    }

    /// `SCRT`: the rest of the step still runs in this scan.
    pub fn transition(&mut self, operands: &[Operand]) {
        let [next] = operands else { return };
        let Some(step) = self.step else { return };
        self.conditional(|lowering| {
            let (on, off) = (lowering.b.bool_const(true), lowering.b.bool_const(false));
            let own = lowering.target(step.relay, Width::Bit);
            lowering.store(own, Width::Bit, off);
            let next = lowering.target(next, Width::Bit);
            lowering.store(next, Width::Bit, on);
        });
    }

    /// `CSCRE`.
    pub fn leave_step(&mut self) {
        let Some(step) = self.step else { return };
        let enable = self.top();
        let next = self.b.create_block();
        self.b.branch(enable, step.end, next);
        self.b.seal_block(next);
        self.b.switch_to(next);
    }

    /// `SCRE`.
    pub fn end_step(&mut self) {
        let Some(step) = self.step.take() else { return };
        self.b.jump(step.end, &[]);
        self.b.seal_block(step.end);
        self.b.switch_to(step.end);
    }
}
