//! The PID instruction. Source: S7-200 system manual, PID loop instruction.

use std::cell::Cell;

use plcc_abi::s7200::error;

use super::{Operands, access, done, failed, failed_quietly, set_special, sm1};
use crate::cpu::Cpu;

/// Bytes of a loop table without the part for auto-tune, which the runtime does not do.
const TABLE_BYTES: u32 = 36;
/// Loops 0 to 7.
const LOOPS: u32 = 8;

/// Offsets in a loop table, a REAL each.
mod field {
    pub const PROCESS_VARIABLE: u32 = 0;
    pub const SETPOINT: u32 = 4;
    pub const OUTPUT: u32 = 8;
    pub const GAIN: u32 = 12;
    /// In seconds.
    pub const SAMPLE_TIME: u32 = 16;
    /// In minutes; infinite: no integral action.
    pub const INTEGRAL_TIME: u32 = 20;
    /// In minutes.
    pub const DERIVATIVE_TIME: u32 = 24;
    pub const BIAS: u32 = 28;
    pub const LAST_PROCESS_VARIABLE: u32 = 32;
}

/// Whether the loops had power flow when they were last executed, one bit each; set when RUN begins.
pub struct Loops {
    had_power: Cell<u8>,
}

impl Default for Loops {
    fn default() -> Loops {
        Loops { had_power: Cell::new(u8::MAX) }
    }
}

/// The results of one execution of a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Step {
    output: f32,
    bias: f32,
}

/// Inputs of one execution.
struct Inputs {
    process_variable: f32,
    last_process_variable: f32,
    setpoint: f32,
    gain: f32,
    sample_s: f32,
    integral_min: f32,
    derivative_min: f32,
    bias: f32,
}

impl Inputs {
    /// `None`: arithmetic fault. A gain of 0 means no proportional action: the other two terms have gain 1 then.
    fn step(&self) -> Option<Step> {
        let deviation = self.setpoint - self.process_variable;
        let other_gain = if self.gain == 0.0 { 1.0 } else { self.gain };
        let proportional = self.gain * deviation;
        let integral = other_gain * (self.sample_s / (self.integral_min * 60.0)) * deviation + self.bias;
        let change = self.last_process_variable - self.process_variable;
        let differential = other_gain * (self.derivative_min * 60.0 / self.sample_s) * change;
        let sum = proportional + integral + differential;
        if ![proportional, integral, differential, sum].into_iter().all(f32::is_finite) {
            return None;
        }
        let (output, bias) = if sum > 1.0 {
            (1.0, 1.0 - (proportional + differential))
        } else if sum < 0.0 {
            (0.0, -(proportional + differential))
        } else {
            (sum, integral)
        };
        Some(Step { output, bias: bias.clamp(0.0, 1.0) })
    }
}

/// With the first power flow after none, the setpoint takes the process variable and the bias the output, so that the output
/// does not jump.
pub(super) fn pid(cpu: &Cpu, operands: &Operands) -> u64 {
    let &Operands { a: table, b: number, c: enabled, .. } = operands;
    let Some(own) = cpu.s7200() else { return 0 };
    if number >= LOOPS {
        return failed(cpu, operands, error::RANGE);
    }
    let (history, mask) = (&own.loops.had_power, 1u8 << number);
    if enabled == 0 {
        history.set(history.get() & !mask);
        return failed_quietly();
    }
    if !access::inside(cpu, table, TABLE_BYTES) {
        return failed(cpu, operands, error::RANGE);
    }
    let real = |offset: u32| f32::from_bits(cpu.memory.dword(table + offset));
    let set_real = |offset: u32, value: f32| cpu.memory.set_dword(table + offset, value.to_bits());
    let process_variable = real(field::PROCESS_VARIABLE);
    if history.get() & mask == 0 {
        history.set(history.get() | mask);
        set_real(field::SETPOINT, process_variable);
        set_real(field::LAST_PROCESS_VARIABLE, process_variable);
        set_real(field::BIAS, real(field::OUTPUT));
    }
    let inputs = Inputs {
        process_variable,
        last_process_variable: real(field::LAST_PROCESS_VARIABLE),
        setpoint: real(field::SETPOINT),
        gain: real(field::GAIN),
        sample_s: real(field::SAMPLE_TIME),
        integral_min: real(field::INTEGRAL_TIME),
        derivative_min: real(field::DERIVATIVE_TIME),
        bias: real(field::BIAS),
    };
    let step = inputs.step();
    set_special(&cpu.memory, 1, sm1::OVERFLOW, step.is_none());
    let Some(step) = step else { return failed_quietly() };
    set_real(field::OUTPUT, step.output);
    set_real(field::BIAS, step.bias);
    set_real(field::LAST_PROCESS_VARIABLE, process_variable);
    access::after_write(cpu, table, TABLE_BYTES);
    done()
}
