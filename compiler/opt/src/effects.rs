//! What runs besides the code of a function: which memory a runtime function may change, and which it may look at.
//!
//! A safepoint and a synchronous error run organization blocks, and a program has all of those that it will ever have. So a
//! safepoint changes nothing that no organization block besides the main program and the startup writes, and in a program of OB 1
//! alone it changes no data at all. It still looks at everything: the CPU may stop there, and memory stays as it is.
//!
//! An S7-200 keeps its accumulators and the flags of SMB1 for whatever an interrupt routine interrupts. What ports, counters and
//! pulse outputs do to its memory on their own is only known if a program uses none.

use std::collections::BTreeSet;

use plcc_abi::functions::Effect;
use plcc_abi::s7200::{Operation, system};
use plcc_ir::entities::Entity;
use plcc_ir::{FuncId, InstData, Module, Region, RuntimeFn};

/// See the module comment.
#[derive(Debug, Hash)]
pub struct Effects {
    /// What code that runs at a safepoint or a synchronous error may write; `None`: anything.
    others: Option<Others>,
}

#[derive(Debug, Default, Hash)]
struct Others {
    /// There is such code.
    exist: bool,
    regions: BTreeSet<Region>,
}

impl Effects {
    pub fn new(module: &Module) -> Effects {
        Effects { others: others(module) }
    }

    /// True if `function` may change the bits from `range.0` to before `range.1` of `region`, whatever part of it if there is none.
    pub fn may_write(&self, function: RuntimeFn, region: Region, range: Option<(u64, u64)>) -> bool {
        match function.effect() {
            Effect::All if is_interruption(function) => self.interruption_writes(region, range),
            Effect::System => {
                touches(Effect::System, region) && !(leaves_registers(function) && is_register(region, range))
            }
            Effect::Reads => false,
            effect => touches(effect, region),
        }
    }

    /// True if `function` may look at any part of `region`.
    pub fn may_read(&self, function: RuntimeFn, region: Region) -> bool {
        touches(function.effect(), region)
    }

    fn interruption_writes(&self, region: Region, range: Option<(u64, u64)>) -> bool {
        let Some(others) = &self.others else { return true };
        let written = |region: &Region| others.regions.contains(region);
        match region {
            Region::State | Region::Cells | Region::I | Region::Any => true,
            Region::System => !is_register(region, range),
            _ if written(&Region::Any) => true,
            // With them parts of the process image may be exchanged.
            Region::Q => others.exist,
            Region::M => written(&Region::M),
            Region::Db(_) => written(&region) || written(&Region::AnyDb),
            Region::AnyDb => others.regions.iter().any(|region| matches!(region, Region::Db(_) | Region::AnyDb)),
            // They have their own local data.
            Region::L | Region::V => false,
        }
    }

    /// True if a safepoint may change entries of the DB table.
    pub fn interruption_changes_dbs(&self) -> bool {
        self.others.as_ref().is_none_or(|others| others.regions.contains(&Region::Any))
    }
}

/// True of functions whose only effect on data is that of the organization blocks that they run.
pub fn is_interruption(function: RuntimeFn) -> bool {
    matches!(function, RuntimeFn::Safepoint | RuntimeFn::SyncError | RuntimeFn::Stop)
}

fn touches(effect: Effect, region: Region) -> bool {
    match effect {
        Effect::Pure => false,
        Effect::Cells => region == Region::Cells,
        Effect::System => matches!(region, Region::System | Region::Any),
        Effect::Io => matches!(region, Region::Q | Region::Any),
        Effect::Reads | Effect::All => true,
    }
}

/// The bits of SMB1 and of the accumulators of an S7-200, in its system area.
pub const REGISTERS: [(u64, u64); 2] = [
    (system::SM as u64 * 8 + 8, system::SM as u64 * 8 + 16),
    (system::ACCUMULATORS as u64 * 8, system::ACCUMULATORS as u64 * 8 + 128),
];

/// True of functions that touch the system area of an S7-200, but neither read nor change [`REGISTERS`].
pub fn leaves_registers(function: RuntimeFn) -> bool {
    matches!(function, RuntimeFn::S7200Pointer | RuntimeFn::S7200Error | RuntimeFn::S7200TimerSync)
}

/// True of bits in the accumulators or SMB1.
fn is_register(region: Region, range: Option<(u64, u64)>) -> bool {
    let Some((start, end)) = range else { return false };
    region == Region::System && REGISTERS.iter().any(|&(first, after)| first <= start && end <= after)
}

fn others(module: &Module) -> Option<Others> {
    if module.entries.is_empty() {
        return None;
    }
    let mut others = Others::default();
    let is_main = |id: &FuncId| matches!(&module.functions[*id].name[..], "OB1" | "OB100" | "OB101" | "OB102");
    let mut work: Vec<FuncId> = module.entries.iter().copied().filter(|id| !is_main(id)).collect();
    others.exist = !work.is_empty();
    let mut seen = vec![false; module.functions.len()];
    while let Some(id) = work.pop() {
        if std::mem::replace(&mut seen[id.index()], true) {
            continue;
        }
        let function = &module.functions[id];
        for &inst in function.layout.iter().flat_map(|&block| &function.blocks[block].insts) {
            match &function.insts[inst] {
                InstData::Store { addr, .. } | InstData::StoreBit { addr, .. } | InstData::Clear { addr, .. } => {
                    others.regions.insert(addr.region);
                }
                InstData::Copy { to, .. } => {
                    others.regions.insert(to.region);
                }
                InstData::Call { callee, .. } => work.push(*callee),
                InstData::CallRuntime { function, .. } if !is_interruption(*function) => match function.effect() {
                    Effect::Pure | Effect::Cells | Effect::System | Effect::Reads => {}
                    Effect::Io => {
                        others.regions.insert(Region::Q);
                    }
                    Effect::All => {
                        others.regions.insert(Region::Any);
                    }
                },
                _ => {}
            }
        }
    }
    let mut functions = module.functions.values();
    functions.all(is_alone).then_some(others)
}

/// True if nothing that the function begins goes on by itself and writes memory later.
fn is_alone(function: &plcc_ir::Function) -> bool {
    function.layout.iter().flat_map(|&block| &function.blocks[block].insts).all(|&inst| match &function.insts[inst] {
        InstData::CallRuntime { function: RuntimeFn::S7200SpecialWritten, .. } => false,
        InstData::CallRuntime { function: RuntimeFn::S7200Operation, args } => {
            let number = args.get(1).and_then(|&value| function.constant(value));
            number
                .and_then(|number| Operation::of_number(number as u32))
                .is_some_and(|operation| !operation.concerns_hardware() || operation == Operation::StopMode)
        }
        _ => true,
    })
}
