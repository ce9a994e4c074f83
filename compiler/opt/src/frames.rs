//! Who can reach the local data of a function.
//!
//! A frame is *private* if its address is never taken: then only the function itself reaches it by region `L`, and a callee by
//! region `V`. Pointers to local data in PLC memory are area pointers, which code turns into an address by `address` or
//! `frame_base` where they are used; so a frame that has neither cannot be reached in another way, by organization
//! blocks that run in between either: they have frames of their own.

use plcc_ir::entities::EntityVec;
use plcc_ir::{FuncId, Function, InstData, Module, Region};

/// What is known about the frames of a module's functions.
pub struct Frames {
    facts: EntityVec<FuncId, Facts>,
}

#[derive(Clone, Copy)]
struct Facts {
    is_private: bool,
    touches_caller: bool,
}

impl Frames {
    pub fn new(module: &Module) -> Frames {
        let mut facts = EntityVec::new();
        for function in module.functions.values() {
            facts.push(facts_of(function));
        }
        Frames { facts }
    }

    /// True if nobody but `function` and its direct callees can reach its frame.
    pub fn is_private(&self, function: FuncId) -> bool {
        self.facts[function].is_private
    }

    /// True if a call of `callee` may read or write the frame of `caller`.
    pub fn call_touches(&self, caller: FuncId, callee: FuncId) -> bool {
        !self.facts[caller].is_private || self.facts[callee].touches_caller
    }
}

fn facts_of(function: &Function) -> Facts {
    let mut facts = Facts { is_private: true, touches_caller: false };
    for block in function.layout.iter().map(|&block| &function.blocks[block]) {
        for &inst in &block.insts {
            let data = &function.insts[inst];
            match data {
                InstData::AddressOf { addr } if addr.region == Region::L => facts.is_private = false,
                InstData::FrameBase { .. } => facts.is_private = false,
                _ => {}
            }
            data.for_each_address(|addr| facts.touches_caller |= addr.region == Region::V);
        }
    }
    facts
}
