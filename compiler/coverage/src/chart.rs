//! Steps and transitions of charts: what their instances show at the end of each call.

use plcc_abi::image::BlockKind;
use plcc_model::{BlockKey, Program};
use plcc_runtime::cpu::Cpu;
use plcc_status::graph::{self, Bits};
use plcc_syntax::ast::{Block, BlockName, Code, CodeBlock, CodeKind, SourceUnit};
use plcc_syntax::chart::ast::Body;

/// A chart, and how often calls of it ended with each step active and each transition switched.
#[derive(Clone, Debug)]
pub struct ChartCounts {
    pub block: BlockKey,
    bits: Bits,
    pub active: Vec<u64>,
    pub switched: Vec<u64>,
}

impl ChartCounts {
    /// Nothing is counted if the data of the chart are not found.
    pub fn new(program: &Program, block: BlockKey, chart: &Body) -> ChartCounts {
        let (steps, transitions) = (chart.steps.len(), chart.transitions.len());
        let bits = graph::bits(program, block, steps, transitions);
        ChartCounts { block, bits, active: vec![0; steps], switched: vec![0; transitions] }
    }

    /// A call has ended with the instance at this offset in memory.
    pub fn look(&mut self, cpu: &Cpu, instance: u32) {
        if instance == 0 {
            return;
        }
        let is_on = |&(byte, bit): &(u32, u8)| {
            let at = instance.checked_add(byte).filter(|at| cpu.memory.contains(*at, 1));
            at.is_some_and(|at| cpu.memory.bit(at, bit))
        };
        let pairs = [(&self.bits.active, &mut self.active), (&self.bits.switched, &mut self.switched)];
        for (bits, counts) in pairs {
            for (bit, count) in bits.iter().zip(counts) {
                *count += u64::from(is_on(bit));
            }
        }
    }
}

/// The charts of a program.
pub fn charts<'a>(program: &Program, units: impl Iterator<Item = &'a SourceUnit>) -> Vec<ChartCounts> {
    let blocks = units.flat_map(|unit| &unit.blocks);
    let chart = |block: &Block| match block {
        Block::Code(block) => match &block.code {
            Code::Chart(chart) => Some(ChartCounts::new(program, key(program, block)?, chart)),
            Code::Stl(_) | Code::Scl(_) | Code::Graphic(_) => None,
        },
        Block::Data(_) | Block::Type(_) => None,
    };
    blocks.filter_map(chart).collect()
}

/// The block of a source as the program has it.
pub fn key(program: &Program, block: &CodeBlock) -> Option<BlockKey> {
    let kind = match block.kind {
        CodeKind::Ob => BlockKind::Ob,
        CodeKind::Fc => BlockKind::Fc,
        CodeKind::Fb => BlockKind::Fb,
        CodeKind::Sfc => BlockKind::Sfc,
        CodeKind::Sfb => BlockKind::Sfb,
    };
    let is_it = |known: &&plcc_model::CodeBlock| {
        known.kind == kind
            && match &block.name {
                BlockName::Numbered { number, .. } => u32::from(known.number) == *number,
                BlockName::Symbol { name, .. } => known.name.eq_ignore_ascii_case(name),
            }
    };
    program.blocks.iter().find(is_it).map(plcc_model::CodeBlock::key)
}
