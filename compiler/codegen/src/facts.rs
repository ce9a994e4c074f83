//! Facts about a function, so that others can be compiled without looking at its code.

use plcc_ir::{FuncId, Function, InstData, Region};

use crate::keeping;

/// See the module comment.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Facts {
    /// It touches its own frame.
    pub own_frame: bool,
    /// It touches the frame of its caller.
    pub caller_frame: bool,
    /// The functions that it calls, each once, in the order of their first calls.
    pub callees: Vec<FuncId>,
    /// Runtime functions that it calls so that all registers are kept: bit n is the n-th of `keeping::KEEPING`.
    pub keeping: u8,
}

/// Looks at the code of a function.
pub fn facts(function: &Function) -> Facts {
    let mut facts = Facts::default();
    let mut called = rustc_hash::FxHashSet::default();
    for &inst in function.layout.iter().flat_map(|&block| &function.blocks[block].insts) {
        let data = &function.insts[inst];
        data.for_each_address(|addr| facts.touch(addr.region));
        match data {
            InstData::FrameBase { .. } => facts.touch(Region::L),
            InstData::Call { callee, .. } if called.insert(*callee) => facts.callees.push(*callee),
            InstData::CallRuntime { function, .. } => facts.keeping |= keeping::bit(*function),
            _ => {}
        }
    }
    facts
}

impl Facts {
    fn touch(&mut self, region: Region) {
        match region {
            Region::L => self.own_frame = true,
            Region::V => self.caller_frame = true,
            Region::State
            | Region::I
            | Region::Q
            | Region::M
            | Region::System
            | Region::Cells
            | Region::Db(_)
            | Region::AnyDb
            | Region::Any => {}
        }
    }
}
