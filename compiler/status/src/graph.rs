//! Steps of a chart: which are active, and for how long.

use plcc_model::types::{DataType, Elementary};
use plcc_model::{BlockKey, Program};
use plcc_runtime::cpu::Cpu;
use serde::Serialize;

/// A bit in an instance.
type Bit = (u32, u8);

/// The steps of a block, by their data in its instance; none if it is not a chart.
#[derive(Clone, Debug, Default)]
pub struct Steps(Vec<Step>);

#[derive(Clone, Debug)]
struct Step {
    name: String,
    active: Bit,
    /// Where T and U are, TIME.
    t: Option<u32>,
    u: Option<u32>,
}

/// A step as a call has left it.
#[derive(Clone, Debug, Serialize)]
pub struct StepSeen {
    pub step: String,
    pub active: bool,
    /// Milliseconds since its activation.
    pub t_ms: Option<i32>,
    /// As `t_ms`, without the time in which it was disturbed.
    pub u_ms: Option<i32>,
}

impl Steps {
    /// Steps are structures of an instance with the members X, T and U. Source: S7-GRAPH, parameters of the step.
    pub fn of(program: &Program, block: BlockKey) -> Steps {
        let Some(block) = program.block(block) else { return Steps::default() };
        let step = |member: &plcc_model::types::Member| {
            let DataType::Struct(structure) = &member.ty else { return None };
            let of = |name: &str, ty: Elementary| {
                let found = structure.members.iter().find(|inner| inner.name.eq_ignore_ascii_case(name))?;
                (found.ty == DataType::Elementary(ty)).then_some((member.byte + found.byte, found.bit))
            };
            let active = of("X", Elementary::Bool)?;
            of("S1", Elementary::Bool)?;
            let [t, u] = ["T", "U"].map(|name| of(name, Elementary::Time).map(|(byte, _)| byte));
            Some(Step { name: member.name.clone(), active, t, u })
        };
        Steps(block.interface.instance.iter().filter_map(step).collect())
    }
}

/// The steps in the instance at this offset.
pub fn seen(steps: &Steps, cpu: &Cpu, instance: u32) -> Vec<StepSeen> {
    let of = |step: &Step| {
        let at = |byte: u32| instance.checked_add(byte).filter(|at| cpu.memory.contains(*at, 4));
        let (byte, bit) = step.active;
        let time = |byte: Option<u32>| byte.and_then(at).map(|at| cpu.memory.dword(at).cast_signed());
        StepSeen {
            step: step.name.clone(),
            active: at(byte).is_some_and(|at| cpu.memory.bit(at, bit)),
            t_ms: time(step.t),
            u_ms: time(step.u),
        }
    };
    if instance == 0 { Vec::new() } else { steps.0.iter().map(of).collect() }
}
