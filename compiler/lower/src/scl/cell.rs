//! Timer and counter functions: they do the same as the STL instructions of the same names. Source: SCL reference, timers and counters.

use plcc_ir::{Type, Value};
use plcc_model::scl::{CounterCall, Expr, TimerCall, TimerKind};
use plcc_model::{CellKind, Operand};
use plcc_syntax::stl::StlInsn;

use crate::arithmetic::bcd::Bcd;
use crate::block::BlockLowering;
use crate::stl::CellRead;

impl BlockLowering<'_, '_> {
    /// `S_ODT` and other timers: the start with its edge, the reset, then the time that is read, an S5TIME.
    pub fn timer_function(&mut self, call: &TimerCall) -> Value {
        let operand = Operand::Cell { kind: CellKind::Timer, number: call.timer.clone() };
        let start = call.start.as_ref().map(|start| self.value(start));
        let time = call.value.as_ref().map(|value| self.cell_word(value));
        let reset = call.reset.as_ref().map(|reset| self.value(reset));
        if let Some(start) = start {
            let time = time.unwrap_or_else(|| self.b.i32_const(0));
            self.set_accu1(time);
            self.set(self.regs.rlo, start);
            let insn = match call.kind {
                TimerKind::Pulse => StlInsn::TimerPulse,
                TimerKind::ExtendedPulse => StlInsn::TimerExtendedPulse,
                TimerKind::OnDelay => StlInsn::TimerOnDelay,
                TimerKind::RetentiveOnDelay => StlInsn::TimerRetentiveOnDelay,
                TimerKind::OffDelay => StlInsn::TimerOffDelay,
            };
            self.timer_start(insn, &operand);
        }
        if let Some(reset) = reset {
            self.set(self.regs.rlo, reset);
            self.cell_reset(CellKind::Timer, &call.timer);
        }
        if let Some(q) = &call.q {
            let status = self.cell_scan(CellKind::Timer, &call.timer);
            self.write_access(q, status);
        }
        if let Some(bi) = &call.bi {
            let left = self.cell_value(CellKind::Timer, &call.timer, CellRead::Binary);
            let word = self.b.trunc(Type::I16, left);
            self.write_access(bi, word);
        }
        let left = self.cell_value(CellKind::Timer, &call.timer, CellRead::Bcd);
        self.b.trunc(Type::I16, left)
    }

    /// `S_CU`, `S_CD`, `S_CUD`: CU, CD, S, R in this order; the count in BCD.
    pub fn counter_function(&mut self, call: &CounterCall) -> Value {
        let operand = Operand::Cell { kind: CellKind::Counter, number: call.counter.clone() };
        let mut bit = |value: &Option<Expr>| value.as_ref().map(|value| self.value(value));
        let (up, down, set, reset) = (bit(&call.up), bit(&call.down), bit(&call.set), bit(&call.reset));
        let preset = call.value.as_ref().map(|value| self.cell_word(value));
        for (input, is_up) in [(up, true), (down, false)] {
            if let Some(input) = input {
                self.set(self.regs.rlo, input);
                self.count(&operand, is_up);
            }
        }
        if let Some(set) = set {
            let preset = preset.unwrap_or_else(|| self.b.i32_const(0));
            self.set_accu1(preset);
            self.set(self.regs.rlo, set);
            self.counter_set(&call.counter);
        }
        if let Some(reset) = reset {
            self.set(self.regs.rlo, reset);
            self.cell_reset(CellKind::Counter, &call.counter);
        }
        let count = self.cell_value(CellKind::Counter, &call.counter, CellRead::Binary);
        if let Some(q) = &call.q {
            let status = self.cell_scan(CellKind::Counter, &call.counter);
            self.write_access(q, status);
        }
        if let Some(cv) = &call.cv {
            let word = self.b.trunc(Type::I16, count);
            self.write_access(cv, word);
        }
        let bcd = Bcd::WORD.digits_of_small(&mut self.b, count);
        self.b.trunc(Type::I16, bcd)
    }

    /// A WORD as an i32.
    fn cell_word(&mut self, value: &Expr) -> Value {
        let word = self.value(value);
        self.b.zext(Type::I32, word)
    }
}
