//! Steps of a chart: where their data is.

use plcc_abi::monitor::Step;
use plcc_model::types::{DataType, Elementary};
use plcc_model::{BlockKey, Program};

/// The steps of a block, by their data in its instance; none if it is not a chart. Steps are structures of an instance with the members X, T
/// and U. Source: S7-GRAPH, parameters of the step.
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
