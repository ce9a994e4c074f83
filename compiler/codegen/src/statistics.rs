//! What the code of each place costs: instructions, bytes, and a guess of its time, for `plcc build --stats`.
//!
//! The time is not measured. Each instruction that is not on a cold side takes what is usual for its kind ([`nanoseconds`]), and counts
//! [`LOOP_PASSES`] times for each loop around it. Whatever a called function does is left out,
//! apart from the call.

use std::collections::{BTreeMap, BTreeSet};

use iced_x86::{FlowControl, Instruction, Mnemonic, OpKind};
use plcc_abi::image::BlockKind;
use plcc_abi::image::Site;
use plcc_ir::Module;
use rustc_hash::{FxHashMap, FxHashSet};

use crate::compile::{CompiledFunction, Compiler};
use crate::isa::Placement;
use crate::machine::{self, Part};
use crate::{CodegenError, CodegenOptions, loops};

/// How often a loop is thought to run.
pub const LOOP_PASSES: f64 = 8.0;

/// Deeper loops count as much as this deep ones.
const LOOP_DEPTH_MAX: u32 = 4;

/// The network of a block, as in [`Site`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlaceKey {
    pub block: BlockKind,
    pub number: u16,
    /// 1-based; 0 before the first network.
    pub network: u16,
}

/// Cost of code.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Instructions of the host.
    pub instructions: u64,
    /// Of these on sides that faults and interrupts take.
    pub cold: u64,
    pub bytes: u64,
    /// Estimate for one run of the code.
    pub nanoseconds: f64,
}

impl Cost {
    pub fn add(&mut self, other: Cost) {
        self.instructions += other.instructions;
        self.cold += other.cold;
        self.bytes += other.bytes;
        self.nanoseconds += other.nanoseconds;
    }
}

/// The cost of the code of each network; code that became part of a caller counts where its source is. The second part is code that
/// belongs to no statement: entries of organization blocks, tables, padding. In the order of the sites.
pub fn statistics(module: &Module, options: &CodegenOptions) -> Result<(Vec<(PlaceKey, Cost)>, Cost), CodegenError> {
    let compiler = Compiler::new(module, Placement::Object, options)?;
    let mut of_sites: BTreeMap<u32, Cost> = BTreeMap::new();
    let mut others = Cost::default();
    for function in compiler.functions()? {
        let parts = machine::parts(&function);
        let (starts, depths) = depths(&function, &parts);
        let depth = |at: u32| {
            let after = starts.partition_point(|start| *start <= at);
            after.checked_sub(1).map_or(0, |block| depths[block])
        };
        let mut site = None;
        for part in &parts {
            let cost = match part {
                Part::Instruction { instruction, place, .. } => {
                    site = place.map(|place| place.site).filter(|site| *site != 0);
                    let cold = place.is_some_and(|place| place.cold);
                    let passes = LOOP_PASSES.powi(depth(instruction.ip() as u32) as i32);
                    Cost {
                        instructions: 1,
                        cold: u64::from(cold),
                        bytes: instruction.len() as u64,
                        nanoseconds: if cold { 0.0 } else { nanoseconds(instruction) * passes },
                    }
                }
                Part::Data { length, .. } => Cost { bytes: u64::from(*length), ..Cost::default() },
            };
            match site {
                Some(site) => of_sites.entry(site).or_default().add(cost),
                None => others.add(cost),
            }
        }
    }
    Ok((networks(module, of_sites, &mut others), others))
}

fn networks(module: &Module, of_sites: BTreeMap<u32, Cost>, others: &mut Cost) -> Vec<(PlaceKey, Cost)> {
    let mut rows: Vec<(PlaceKey, Cost)> = Vec::new();
    let mut index: FxHashMap<(BlockKind, u16, u16), usize> = FxHashMap::default();
    for (site, cost) in of_sites {
        let Some(Site { block, block_number, network, .. }) = module.sites.get(site as usize - 1) else {
            others.add(cost);
            continue;
        };
        let at = *index.entry((*block, *block_number, *network)).or_insert_with(|| {
            rows.push((PlaceKey { block: *block, number: *block_number, network: *network }, Cost::default()));
            rows.len() - 1
        });
        rows[at].1.add(cost);
    }
    rows
}

/// Where the blocks of a function begin, and how deep in loops they are. What cold sides jump back to is not a loop. A jump by a table may
/// lead to each block that nothing else leads to.
fn depths(function: &CompiledFunction, parts: &[Part]) -> (Vec<u32>, Vec<u32>) {
    let direct = |instruction: &Instruction| {
        matches!(instruction.flow_control(), FlowControl::ConditionalBranch | FlowControl::UnconditionalBranch)
    };
    let mut starts: BTreeSet<u32> = function.blocks.iter().copied().chain([0]).collect();
    for part in parts {
        if let Part::Instruction { instruction, .. } = part
            && direct(instruction)
        {
            starts.insert(instruction.near_branch_target() as u32);
            starts.insert(instruction.next_ip() as u32);
        }
    }
    let (mut edges, mut tables, mut block) = (Vec::new(), Vec::new(), 0);
    for part in parts {
        let Part::Instruction { instruction, place, .. } = part else { continue };
        if starts.contains(&(instruction.ip() as u32)) {
            block = instruction.ip() as u32;
        }
        if place.is_some_and(|place| place.cold) {
            continue;
        }
        let next = instruction.next_ip() as u32;
        match instruction.flow_control() {
            FlowControl::ConditionalBranch => {
                edges.extend([(block, instruction.near_branch_target() as u32), (block, next)]);
            }
            FlowControl::UnconditionalBranch => edges.push((block, instruction.near_branch_target() as u32)),
            FlowControl::IndirectBranch => tables.push(block),
            FlowControl::Return | FlowControl::Exception => {}
            _ if starts.contains(&next) => edges.push((block, next)),
            _ => {}
        }
    }
    let reached: FxHashSet<u32> = edges.iter().map(|&(_, to)| to).collect();
    let others = function.blocks.iter().copied().filter(|start| *start > 0 && !reached.contains(start));
    if let Some(table) = tables.first().copied() {
        edges.extend(others.map(|to| (table, to)));
    }
    let starts: Vec<u32> = starts.into_iter().collect();
    let depths = loops::depths(&starts, &edges, LOOP_DEPTH_MAX);
    (starts, depths)
}

/// What an instruction usually takes on a processor of 3 GHz that runs several at once.
fn nanoseconds(instruction: &Instruction) -> f64 {
    use Mnemonic as M;
    let bits = if instruction.op_count() > 0 && instruction.op_kind(0) == OpKind::Register {
        instruction.op0_register().size() * 8
    } else {
        instruction.memory_size().size() * 8
    };
    match instruction.mnemonic() {
        M::Idiv | M::Div if bits == 64 => 6.0,
        M::Idiv | M::Div => 3.5,
        M::Divss | M::Divsd | M::Sqrtss | M::Sqrtsd | M::Vdivss | M::Vdivsd | M::Vsqrtss | M::Vsqrtsd => 2.0,
        M::Imul | M::Mul => 0.3,
        M::Call => 1.5,
        _ if instruction.op_count() > 0
            && (0..instruction.op_count()).any(|op| instruction.op_kind(op) == OpKind::Memory) =>
        {
            0.15
        }
        _ => 0.1,
    }
}

/// Bytes of machine code of each function of the module, with its name.
pub fn function_sizes(module: &Module, options: &CodegenOptions) -> Result<Vec<(String, u64)>, CodegenError> {
    let compiler = Compiler::new(module, Placement::Object, options)?;
    let functions = compiler.functions()?;
    let sizes = module.functions.values().zip(functions);
    Ok(sizes.map(|(function, code)| (function.name.clone(), code.bytes.len() as u64)).collect())
}
