//! The functions of timers and counters, as the instructions of the same names.

use plcc_model::CellKind;
use plcc_model::scl::{Access, CounterCall, Expr, ExprKind, TimerCall, TimerKind};
use plcc_model::types::Elementary;
use plcc_syntax::ast::Operand;
use plcc_syntax::stl::StlInsn;

use super::Maker;

/// An input of a function, after all inputs are evaluated.
enum Input {
    Constant(bool),
    Bit(Operand),
}

impl Maker<'_> {
    /// `S_ODT` and others: start, reset, then the time that is left, as S5TIME in ACCU1.
    pub fn timer(&mut self, call: &TimerCall) {
        let Some(cell) = self.cell(CellKind::Timer, &call.timer, self.span) else { return };
        let start = call.start.as_ref().and_then(|start| self.input(start));
        let time = call.value.as_ref().map(|value| self.word(value));
        let reset = call.reset.as_ref().and_then(|reset| self.input(reset));
        if let Some(start) = start {
            let insn = match call.kind {
                TimerKind::Pulse => StlInsn::TimerPulse,
                TimerKind::ExtendedPulse => StlInsn::TimerExtendedPulse,
                TimerKind::OnDelay => StlInsn::TimerOnDelay,
                TimerKind::RetentiveOnDelay => StlInsn::TimerRetentiveOnDelay,
                TimerKind::OffDelay => StlInsn::TimerOffDelay,
            };
            let time = time.unwrap_or_else(|| self.constant(Elementary::S5Time, 0));
            self.scan(start);
            self.push(StlInsn::Load, Some(time));
            self.push(insn, Some(cell.clone()));
        }
        self.finish_cell(&cell, reset, (call.q.as_ref(), call.bi.as_ref()));
    }

    /// `S_CUD` and others: the count in BCD, in ACCU1.
    pub fn counter(&mut self, call: &CounterCall) {
        let Some(cell) = self.cell(CellKind::Counter, &call.counter, self.span) else { return };
        let up = call.up.as_ref().and_then(|value| self.input(value));
        let down = call.down.as_ref().and_then(|value| self.input(value));
        let set = call.set.as_ref().and_then(|value| self.input(value));
        let reset = call.reset.as_ref().and_then(|value| self.input(value));
        let preset = call.value.as_ref().map(|value| self.word(value));
        for (input, insn) in [(up, StlInsn::CountUp), (down, StlInsn::CountDown)] {
            if let Some(input) = input {
                self.scan(input);
                self.push(insn, Some(cell.clone()));
            }
        }
        if let Some(set) = set {
            let preset = preset.unwrap_or_else(|| self.constant(Elementary::Word, 0));
            self.scan(set);
            self.push(StlInsn::Load, Some(preset));
            self.push(StlInsn::Set, Some(cell.clone()));
        }
        self.finish_cell(&cell, reset, (call.q.as_ref(), call.cv.as_ref()));
    }

    fn finish_cell(&mut self, cell: &Operand, reset: Option<Input>, (q, value): (Option<&Access>, Option<&Access>)) {
        if let Some(reset) = reset {
            self.scan(reset);
            self.push(StlInsn::Reset, Some(cell.clone()));
        }
        for (access, load, store) in [(q, StlInsn::And, StlInsn::Assign), (value, StlInsn::Load, StlInsn::Transfer)] {
            let Some(access) = access else { continue };
            let ty = access.elementary().unwrap_or(Elementary::Word);
            let Some(target) = self.target(access, true) else { return };
            self.push(load, Some(cell.clone()));
            let operand = self.reach(&target, ty);
            self.push(store, Some(operand));
        }
        self.push(StlInsn::LoadBcd, Some(cell.clone()));
    }

    /// A BOOL that keeps its value while the function runs.
    fn input(&mut self, value: &Expr) -> Option<Input> {
        match &value.kind {
            ExprKind::Const(bits) => Some(Input::Constant(*bits != 0)),
            ExprKind::Load(access) if self.is_direct(access) => self.operand(access).map(Input::Bit),
            _ => {
                self.condition(value);
                Some(Input::Bit(self.keep(Elementary::Bool)))
            }
        }
    }

    fn scan(&mut self, input: Input) {
        match input {
            Input::Constant(true) => self.push(StlInsn::SetRlo, None),
            Input::Constant(false) => self.push(StlInsn::ClearRlo, None),
            Input::Bit(operand) => self.push(StlInsn::And, Some(operand)),
        }
    }

    /// A WORD that `L` loads without changing the RLO.
    fn word(&mut self, value: &Expr) -> Operand {
        match &value.kind {
            ExprKind::Const(bits) => self.constant(value.ty, *bits),
            ExprKind::Load(access) if self.is_direct(access) => {
                self.operand(access).unwrap_or_else(|| self.constant(value.ty, 0))
            }
            _ => {
                self.number(value);
                self.keep(value.ty)
            }
        }
    }
}
