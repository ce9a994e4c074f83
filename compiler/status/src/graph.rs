//! Steps and transitions of a chart: where their data is.

use plcc_abi::monitor::Step;
use plcc_model::types::{DataType, Elementary};
use plcc_model::{BlockKey, Program, layout};

/// The steps of a block, by their data in its instance; none if it is not a chart. Steps are structures of an instance with the members X, T
/// and U. Source: GRAPH reference, parameters of the step.
pub fn steps(program: &Program, block: BlockKey) -> Vec<Step> {
    let Some(block) = program.block(block) else { return Vec::new() };
    let step = |member: &plcc_model::types::Member| {
        let DataType::Struct(structure) = &member.ty else { return None };
        let of = |name: &str, ty: Elementary| {
            let found = structure.members.iter().find(|inner| inner.name.eq_ignore_ascii_case(name))?;
            (found.ty == DataType::Elementary(ty)).then_some((member.byte + found.byte, found.bit))
        };
        let active = of("X", Elementary::Bool)?;
        of("S1", Elementary::Bool)?;
        let [t, u] = ["T", "U"].map(|name| of(name, Elementary::Time).map(|(byte, _)| byte));
        let [interlock, supervision] = ["LA", "VA"].map(|name| of(name, Elementary::Bool));
        Some(Step { name: member.name.clone(), active, t, u, interlock, supervision })
    };
    block.interface.instance.iter().filter_map(step).collect()
}

/// Bits of a chart in its instance, by byte and bit.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Bits {
    /// X of each step, in the order of the source: the step is active.
    pub active: Vec<(u32, u8)>,
    /// TS of each transition, in the order of the source: it has switched in the last call.
    pub switched: Vec<(u32, u8)>,
}

/// The bits of a block; none if it is not a chart. `steps`, `transitions`: how many the chart has; structures of the user that look like
/// them come before. Source: GRAPH reference, parameters of steps and transitions.
pub fn bits(program: &Program, block: BlockKey, steps: usize, transitions: usize) -> Bits {
    let Some(block) = program.block(block) else { return Bits::default() };
    let of = |names: &[&str], wanted: &str, count: usize| {
        let mut found = Vec::new();
        for member in &block.interface.instance {
            match &member.ty {
                DataType::Struct(_) => found.extend(bit_of(&member.ty, member.byte, names, wanted)),
                DataType::Array(array) => {
                    let elements = layout::element_count(&array.bounds).min(count as u64);
                    let places = (0..elements).map(|at| member.byte + layout::element_place(array, at).0);
                    found.extend(places.filter_map(|byte| bit_of(&array.element, byte, names, wanted)));
                }
                DataType::Elementary(_)
                | DataType::DateAndTime
                | DataType::String(_)
                | DataType::WideString(_)
                | DataType::Parameter(_)
                | DataType::OpenArray(_)
                | DataType::Void => {}
            }
        }
        found.split_off(found.len().saturating_sub(count))
    };
    Bits { active: of(&["S1", "LA", "VA"], "X", steps), switched: of(&["TV", "TT"], "TS", transitions) }
}

/// Where the BOOL `wanted` of a structure at `byte` is, if it has the components `names` too.
fn bit_of(ty: &DataType, byte: u32, names: &[&str], wanted: &str) -> Option<(u32, u8)> {
    let DataType::Struct(structure) = ty else { return None };
    let find = |name: &str| {
        let found = structure.members.iter().find(|member| member.name.eq_ignore_ascii_case(name))?;
        (found.ty == DataType::Elementary(Elementary::Bool)).then_some((byte + found.byte, found.bit))
    };
    names.iter().all(|name| find(name).is_some()).then(|| find(wanted)).flatten()
}
