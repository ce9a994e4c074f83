//! Timers and counters: their cells belong to the runtime. Source: STL reference, timer and counter instructions.

use plcc_abi::RuntimeFn;
use plcc_abi::codes::sync;
use plcc_abi::functions::TimerMode;
use plcc_ir::{BinaryOp, Block, IntCc, Type, Value};
use plcc_model::{CellKind, Number, Operand, Width};
use plcc_syntax::stl::StlInsn;

use crate::block::BlockLowering;
use crate::fault::{Check, Substitute};

impl BlockLowering<'_, '_> {
    /// A number known at compile time or run time, an i32.
    pub fn number(&mut self, number: &Number) -> Value {
        match number {
            Number::Known(number) => self.b.i32_const(u32::from(*number)),
            Number::Word(place) => self.read(place, Width::Word),
            Number::Parameter(parameter) => self.parameters[*parameter][0],
        }
    }

    /// The cell's number, on the path where the CPU has that cell.
    fn begin_cell(&mut self, kind: CellKind, number: &Number, substitute: Substitute) -> (Value, Option<Block>) {
        let profile = &self.plan.program.profile;
        let (count, code) = match kind {
            CellKind::Timer => (profile.timers, sync::TIMER_NUMBER),
            CellKind::Counter => (profile.counters, sync::COUNTER_NUMBER),
        };
        let value = self.number(number);
        if matches!(number, Number::Known(_)) {
            // Checked when bound.
            return (value, None);
        }
        let ok = self.b.icmp_imm(IntCc::Ult, value, i64::from(count));
        let code = self.b.i32_const(u32::from(code));
        let access = self.b.i32_const(0);
        let guard = self.begin_guard(vec![Check { ok, code, access, info: value }], substitute);
        (value, guard)
    }

    /// Value that `function` returns for the cell, an i32.
    pub fn cell_value(&mut self, kind: CellKind, number: &Number, function: RuntimeFn) -> Value {
        let (number, guard) = self.begin_cell(kind, number, Substitute::Word);
        let value = self.b.call_runtime(function, &[number]).expect("it returns a value");
        if guard.is_none() {
            return value;
        }
        self.set(self.result, value);
        self.end_guard(guard);
        self.get(self.result)
    }

    /// Status of a timer, an i1.
    pub fn timer_scan(&mut self, number: &Number) -> Value {
        let value = self.cell_value(CellKind::Timer, number, RuntimeFn::TimerScan);
        self.b.icmp_imm(IntCc::Ne, value, 0)
    }

    /// Status of a counter, an i1: its count is not 0.
    pub fn counter_scan(&mut self, number: &Number) -> Value {
        let value = self.cell_value(CellKind::Counter, number, RuntimeFn::CounterValue);
        self.b.icmp_imm(IntCc::Ne, value, 0)
    }

    /// `LC`.
    pub fn load_bcd(&mut self, operand: &Operand) {
        let value = match operand {
            Operand::Cell { kind: CellKind::Timer, number } => {
                self.cell_value(CellKind::Timer, number, RuntimeFn::TimerValueBcd)
            }
            Operand::Cell { kind: CellKind::Counter, number } => {
                let value = self.cell_value(CellKind::Counter, number, RuntimeFn::CounterValue);
                let digits = self.b.i32_const(3);
                self.b.call_pure(RuntimeFn::IntToBcd, &[value, digits])
            }
            _ => unreachable!("the binder only passes timers and counters"),
        };
        self.load_accu1(value);
    }

    /// `SP SE SD SS SF`.
    pub fn timer_start(&mut self, insn: StlInsn, operand: &Operand) {
        let mode = match insn {
            StlInsn::TimerPulse => TimerMode::Pulse,
            StlInsn::TimerExtendedPulse => TimerMode::ExtendedPulse,
            StlInsn::TimerOnDelay => TimerMode::OnDelay,
            StlInsn::TimerRetentiveOnDelay => TimerMode::RetentiveOnDelay,
            _ => TimerMode::OffDelay,
        };
        let Operand::Cell { number, .. } = operand else { return };
        let (number, guard) = self.begin_cell(CellKind::Timer, number, Substitute::None);
        let mode_value = self.b.i32_const(mode as u32);
        let (accu1, rlo) = (self.accu1(), self.rlo());
        let value = self.b.binary_imm(BinaryOp::And, accu1, 0xFFFF);
        let rlo = self.b.zext(Type::I32, rlo);
        let answer = self
            .b
            .call_runtime(RuntimeFn::TimerStart, &[number, mode_value, value, rlo])
            .expect("timer_start has a result");
        if mode == TimerMode::OnDelay {
            self.set_overflow_if_told(answer);
        }
        let ok = self.bit_is_clear(answer, 0);
        let check = self.bcd_check(ok);
        let inner = self.begin_guard(vec![check], Substitute::None);
        self.end_guard(inner);
        self.end_guard(guard);
        self.end_logic_string();
    }

    /// Only SD changes OV: bit 1 of the result shows this, bit 2 is the value.
    fn set_overflow_if_told(&mut self, answer: Value) {
        let told = self.bit_is_clear(answer, 1);
        let value = self.bit_is_clear(answer, 2);
        let value = self.b.not(value);
        let old = self.get(self.regs.ov);
        let ov = self.b.select(told, old, value);
        self.set(self.regs.ov, ov);
    }

    fn bit_is_clear(&mut self, word: Value, bit: i64) -> Value {
        let masked = self.b.binary_imm(BinaryOp::And, word, 1 << bit);
        self.b.icmp_imm(IntCc::Eq, masked, 0)
    }

    /// `S C n`.
    pub fn counter_set(&mut self, number: &Number) {
        let (number, guard) = self.begin_cell(CellKind::Counter, number, Substitute::None);
        let (accu1, rlo) = (self.accu1(), self.rlo());
        let value = self.b.binary_imm(BinaryOp::And, accu1, 0xFFFF);
        let rlo = self.b.zext(Type::I32, rlo);
        let bad = self.b.call_runtime(RuntimeFn::CounterSet, &[number, value, rlo]).expect("counter_set has a result");
        let ok = self.b.icmp_imm(IntCc::Eq, bad, 0);
        let check = self.bcd_check(ok);
        let inner = self.begin_guard(vec![check], Substitute::None);
        self.end_guard(inner);
        self.end_guard(guard);
        self.end_logic_string();
    }

    /// `R T n`, `R C n`: while the RLO is 1.
    pub fn cell_reset(&mut self, kind: CellKind, number: &Number) {
        let (number, guard) = self.begin_cell(kind, number, Substitute::None);
        let function = match kind {
            CellKind::Timer => RuntimeFn::TimerReset,
            CellKind::Counter => RuntimeFn::CounterReset,
        };
        let rlo = self.rlo();
        let (reset, next) = (self.b.create_block(), self.b.create_block());
        self.b.branch(rlo, reset, next);
        self.b.seal_block(reset);
        self.b.switch_to(reset);
        self.b.call_runtime(function, &[number]);
        self.b.jump(next, &[]);
        self.b.seal_block(next);
        self.b.switch_to(next);
        self.end_guard(guard);
        self.end_logic_string();
    }

    /// `FR`.
    pub fn cell_enable(&mut self, operand: &Operand) {
        let Operand::Cell { kind, number } = operand else { return };
        let function = match kind {
            CellKind::Timer => RuntimeFn::TimerEnable,
            CellKind::Counter => RuntimeFn::CounterEnable,
        };
        self.cell_with_rlo(*kind, number, function);
    }

    /// `CU`, `CD`.
    pub fn count(&mut self, operand: &Operand, function: RuntimeFn) {
        if let Operand::Cell { kind, number } = operand {
            self.cell_with_rlo(*kind, number, function);
        }
    }

    fn cell_with_rlo(&mut self, kind: CellKind, number: &Number, function: RuntimeFn) {
        let (number, guard) = self.begin_cell(kind, number, Substitute::None);
        let rlo = self.rlo();
        let rlo = self.b.zext(Type::I32, rlo);
        self.b.call_runtime(function, &[number, rlo]);
        self.end_guard(guard);
        self.end_logic_string();
    }
}
