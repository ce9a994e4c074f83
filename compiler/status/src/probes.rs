//! The places of probes as the runtime has them, for clients that watch the program while it runs.

use plcc_abi::monitor::{self, BlockProbes, Tells};
use plcc_lower::probe::{Place, Probe};
use plcc_model::types::value_type;
use plcc_model::{CellKind, Program};

use crate::graph;

/// The probes of a program, by block.
pub fn of(program: &Program, places: &[Place]) -> monitor::Probes {
    let mut blocks: Vec<BlockProbes> = Vec::new();
    let mut before = None;
    let mut start = 0;
    for (number, place) in (0..).zip(places) {
        if before.replace(place.block) != Some(place.block) {
            let key = place.block;
            let name = program.block(key).map(|block| block.name.clone()).unwrap_or_default();
            let steps = graph::steps(program, key);
            blocks.push(BlockProbes {
                kind: key.kind,
                number: key.number,
                name,
                first: number,
                probes: Vec::new(),
                steps,
            });
            start = 0;
        }
        let probe = monitor::Probe {
            distance: (place.span.start as i32).wrapping_sub(start),
            length: place.span.end.saturating_sub(place.span.start),
            network: place.network,
            tells: tells(&place.probe),
        };
        start = place.span.start as i32;
        if let Some(block) = blocks.last_mut() {
            block.probes.push(probe);
        }
    }
    monitor::Probes { blocks }
}

fn tells(probe: &Probe) -> Tells {
    match probe {
        // All but the first are in code for a debugger or for coverage alone.
        Probe::Block
        | Probe::Statement(_)
        | Probe::Formal(_)
        | Probe::Reached
        | Probe::Contact
        | Probe::Condition
        | Probe::Enable => Tells::Block,
        Probe::Registers(None) => Tells::Registers,
        Probe::Registers(Some((CellKind::Timer, number))) => Tells::Timer(*number),
        Probe::Registers(Some((CellKind::Counter, number))) => Tells::Counter(*number),
        Probe::Variable(ty) => Tells::Variable(value_type(*ty)),
        Probe::Value(ty) => Tells::Value(value_type(*ty)),
        Probe::Written(ty) => Tells::Written(value_type(*ty)),
        Probe::Stack(operands) => Tells::Stack(operands.clone()),
        Probe::Ran => Tells::Ran,
    }
}
