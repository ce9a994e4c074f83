//! Timers and counters. Source: S7-200 system manual, timer and counter instructions.
//!
//! A timer box of 100 ms and all counters are computed here; timers of 1 ms and 10 ms run independently, in the runtime.

use plcc_abi::RuntimeFn;
use plcc_abi::s7200::{Operation, Resolution, TimerKind, system, timer_resolution};
use plcc_ir::{Address, BinaryOp, ConvertOp, IntCc, Region, Type, Value};
use plcc_model::s7200::{Insn, Operand, Width};

use super::block::S7200Lowering;

impl S7200Lowering<'_, '_> {
    /// `TON TONR TOF`.
    pub fn timer(&mut self, insn: Insn, operands: &[Operand]) {
        let [Operand::Timer { number, .. }, preset] = operands else { return };
        self.guarded(|lowering| {
            let preset = lowering.read(preset, Width::Word);
            let enable = lowering.top();
            if insn == Insn::Ton && timer_resolution(*number) == Resolution::Ms100 {
                return lowering.on_delay_100_ms(*number, preset, enable);
            }
            if insn == Insn::Tof && lowering.step.is_some() {
                lowering.reset_in_inactive_step(*number);
            }
            let kind = match insn {
                Insn::Ton => TimerKind::Ton,
                Insn::Tonr => TimerKind::Tonr,
                _ => TimerKind::Tof,
            };
            let (number, kind) = (lowering.b.i32_const(u32::from(*number)), lowering.b.i32_const(kind as u32));
            let (preset, enable) = (lowering.b.zext(Type::I32, preset), lowering.b.zext(Type::I32, enable));
            lowering.b.call_runtime(RuntimeFn::S7200Timer, &[number, kind, preset, enable]);
        });
    }

    /// A TOF in a step that is not active does not time: it is reset, and its box then sees its input off.
    fn reset_in_inactive_step(&mut self, number: u8) {
        let Some(step) = self.step else { return };
        let active = self.get(step.gate);
        let (inactive, after) = (self.b.create_block(), self.b.create_block());
        self.b.branch(active, after, inactive);
        self.b.seal_block(inactive);
        self.b.switch_to(inactive);
        let (number, count) = (self.b.i32_const(u32::from(number)), self.b.i32_const(1));
        self.run_raw(Operation::ResetTimers, &[number, count]);
        self.b.jump(after, &[]);
        self.b.seal_block(after);
        self.b.switch_to(after);
    }

    /// The box adds the ticks between the last two scans, if it was on before.
    fn on_delay_100_ms(&mut self, number: u8, preset: Value, enable: Value) {
        let number = u32::from(number);
        let value_at = Address::direct(Region::System, system::TIMER_VALUES + 2 * number);
        let bit_at = Address::direct(Region::System, system::TIMER_BITS + number);
        let input_at = Address::direct(Region::System, system::TIMER_INPUTS + number);
        let was_on = self.b.load(Type::I8, input_at);
        let was_on = self.b.icmp_imm(IntCc::Ne, was_on, 0);
        let ticks = self.b.load(Type::I32, Address::direct(Region::System, system::TICKS_100_MS));
        let value = self.b.load(Type::I16, value_at);
        let wide = self.b.convert(ConvertOp::Sext, Type::I32, value);
        let sum = self.b.iadd(wide, ticks);
        let most = self.b.i32_const(i16::MAX as u32);
        let over = self.b.icmp(IntCc::Ugt, sum, most);
        let from_above = self.b.icmp_imm(IntCc::Sge, wide, 0);
        let over = self.b.and(over, from_above);
        let sum = self.b.select(over, most, sum);
        let counted = self.b.select(was_on, sum, wide);
        let counted = self.b.trunc(Type::I16, counted);
        let zero = self.b.iconst(Type::I16, 0);
        let new = self.b.select(enable, counted, zero);
        self.b.store(value_at, new);
        let reached = self.b.icmp(IntCc::Sge, new, preset);
        let bit = self.b.and(reached, enable);
        let bit = self.b.zext(Type::I8, bit);
        self.b.store(bit_at, bit);
        let input = self.b.zext(Type::I8, enable);
        self.b.store(input_at, input);
    }

    /// `BITIM`.
    pub fn begin_interval(&mut self, operands: &[Operand]) {
        self.boxed(|lowering| {
            let target = lowering.target(&operands[0], Width::Dword);
            let now = lowering.b.call_runtime(RuntimeFn::S7200Milliseconds, &[]).expect("it returns a value");
            lowering.store(target, Width::Dword, now);
        });
    }

    /// `CITIM`: modulo 2^32.
    pub fn interval(&mut self, operands: &[Operand]) {
        self.boxed(|lowering| {
            let from = lowering.read(&operands[0], Width::Dword);
            let target = lowering.target(&operands[1], Width::Dword);
            let now = lowering.b.call_runtime(RuntimeFn::S7200Milliseconds, &[]).expect("it returns a value");
            let passed = lowering.b.isub(now, from);
            lowering.store(target, Width::Dword, passed);
        });
    }

    /// Current value of a counter.
    fn count_of(&mut self, number: u8) -> Value {
        self.b.load(Type::I16, Address::direct(Region::System, system::COUNTER_VALUES + 2 * u32::from(number)))
    }

    fn set_counter(&mut self, number: u8, count: Value, bit: Value) {
        let number = u32::from(number);
        self.b.store(Address::direct(Region::System, system::COUNTER_VALUES + 2 * number), count);
        let bit = self.b.zext(Type::I8, bit);
        self.b.store(Address::direct(Region::System, system::COUNTER_BITS + number), bit);
    }

    /// Level `level` of the stack, and whether it has risen. Edges while the counter is held are lost.
    fn counting_edge(&mut self, level: usize) -> Value {
        let edge = self.plan.rising_edges.take();
        let input = self.get(self.stack[level]);
        self.edge_of(edge, input)
    }

    /// `CTU`: S0 resets, S1 counts; stops at 32767.
    pub fn count_up(&mut self, operands: &[Operand]) {
        let [Operand::Counter { number, .. }, preset] = operands else { return };
        let up = self.counting_edge(1);
        self.guarded(|lowering| {
            let preset = lowering.read(preset, Width::Word);
            let reset = lowering.top();
            let count = lowering.count_of(*number);
            let below = lowering.b.icmp_imm(IntCc::Slt, count, i64::from(i16::MAX));
            let counts = lowering.b.and(up, below);
            let step = lowering.b.zext(Type::I16, counts);
            let counted = lowering.b.iadd(count, step);
            let zero = lowering.b.iconst(Type::I16, 0);
            let new = lowering.b.select(reset, zero, counted);
            let bit = lowering.reached(new, preset, reset);
            lowering.set_counter(*number, new, bit);
        });
    }

    /// The bit of a counter that counts up: its preset is reached, and it is not reset.
    fn reached(&mut self, count: Value, preset: Value, reset: Value) -> Value {
        let reached = self.b.icmp(IntCc::Sge, count, preset);
        let free = self.b.not(reset);
        self.b.and(reached, free)
    }

    /// `CTD`: S0 loads, S1 counts; stops at 0.
    pub fn count_down(&mut self, operands: &[Operand]) {
        let [Operand::Counter { number, .. }, preset] = operands else { return };
        let down = self.counting_edge(1);
        self.guarded(|lowering| {
            let preset = lowering.read(preset, Width::Word);
            let load = lowering.top();
            let count = lowering.count_of(*number);
            let above = lowering.b.icmp_imm(IntCc::Sgt, count, 0);
            let counts = lowering.b.and(down, above);
            let step = lowering.b.zext(Type::I16, counts);
            let counted = lowering.b.isub(count, step);
            let new = lowering.b.select(load, preset, counted);
            let empty = lowering.b.icmp_imm(IntCc::Eq, new, 0);
            let free = lowering.b.not(load);
            let bit = lowering.b.and(empty, free);
            lowering.set_counter(*number, new, bit);
        });
    }

    /// `CTUD`: S0 resets, S1 counts down, S2 counts up; wraps at both ends.
    pub fn count_up_down(&mut self, operands: &[Operand]) {
        let [Operand::Counter { number, .. }, preset] = operands else { return };
        let (up, down) = (self.counting_edge(2), self.counting_edge(1));
        self.guarded(|lowering| {
            let preset = lowering.read(preset, Width::Word);
            let reset = lowering.top();
            let count = lowering.count_of(*number);
            let (up, down) = (lowering.b.zext(Type::I16, up), lowering.b.zext(Type::I16, down));
            let counted = lowering.b.iadd(count, up);
            let counted = lowering.b.binary(BinaryOp::Isub, counted, down);
            let zero = lowering.b.iconst(Type::I16, 0);
            let new = lowering.b.select(reset, zero, counted);
            let bit = lowering.reached(new, preset, reset);
            lowering.set_counter(*number, new, bit);
        });
    }
}
