//! Steps of a chart: which are active, and for how long.

use plcc_abi::monitor::Step;
use serde::Serialize;

use crate::cpu::Cpu;

/// A step as a call has left it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct StepSeen {
    pub step: String,
    pub active: bool,
    /// Milliseconds since its activation.
    pub t_ms: Option<i32>,
    /// As `t_ms`, without the time in which it was disturbed.
    pub u_ms: Option<i32>,
    /// Its interlock is not satisfied.
    #[serde(skip_serializing_if = "is_false")]
    pub interlocked: bool,
    /// Its supervision has found a fault.
    #[serde(skip_serializing_if = "is_false")]
    pub faulty: bool,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_false(bit: &bool) -> bool {
    !bit
}

/// Whether a step is active in the instance at this offset in memory.
pub(super) fn is_active(step: &Step, cpu: &Cpu, instance: u32) -> bool {
    let (byte, bit) = step.active;
    let at = instance.checked_add(byte).filter(|at| instance != 0 && cpu.memory.contains(*at, 1));
    at.is_some_and(|at| cpu.memory.bit(at, bit))
}

/// The steps in the instance at this offset in memory.
pub fn seen(steps: &[Step], cpu: &Cpu, instance: u32) -> Vec<StepSeen> {
    let of = |step: &Step| {
        let at = |byte: u32| instance.checked_add(byte).filter(|at| cpu.memory.contains(*at, 4));
        let bit = |(byte, bit): (u32, u8)| at(byte).is_some_and(|at| cpu.memory.bit(at, bit));
        let time = |byte: Option<u32>| byte.and_then(at).map(|at| cpu.memory.dword(at).cast_signed());
        StepSeen {
            step: step.name.clone(),
            active: bit(step.active),
            t_ms: time(step.t),
            u_ms: time(step.u),
            interlocked: step.interlock.is_some_and(bit),
            faulty: step.supervision.is_some_and(bit),
        }
    };
    if instance == 0 { Vec::new() } else { steps.iter().map(of).collect() }
}
