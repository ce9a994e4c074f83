//! The canonical form of a function.
//!
//! Canonical: blocks are numbered as laid out, values and instructions in the order in which they are printed, and
//! nothing else is stored: no aliases, no instruction outside a block, no block outside the layout. A canonical
//! function equals the parsed form of its text.

use crate::analysis::reachable;
use crate::entities::{Block, Entity, EntityVec, Value};
use crate::function::{BlockData, Function, ValueData, ValueDef};

impl Function {
    /// Makes the function canonical: drops instructions outside blocks, aliases, and blocks that are not laid out.
    /// Values that are used but defined nowhere, which the verifier would reject, are kept after the others.
    pub fn renumber(&mut self) {
        self.shorten_aliases();
        let mut blocks: EntityVec<Block, Option<Block>> = EntityVec::filled(None, self.blocks.len());
        for (index, &block) in self.layout.iter().enumerate() {
            blocks[block] = Some(Block::new(index));
        }
        // As much room as it takes: these are most of the memory of a large program.
        let insts = self.layout.iter().map(|&block| self.blocks[block].insts.len()).sum();
        let results = |&block: &Block| self.blocks[block].insts.iter().map(|&inst| self.results[inst].len());
        let params = self.layout.iter().map(|&block| self.blocks[block].params.len()).sum::<usize>();
        let defined = params + self.layout.iter().flat_map(results).sum::<usize>();
        let mut new = Function::new(std::mem::take(&mut self.name));
        new.returns = std::mem::take(&mut self.returns);
        new.frame_bytes = self.frame_bytes;
        new.inlined_bytes = self.inlined_bytes;
        new.apart = self.apart;
        new.by_pointers = self.by_pointers;
        new.blocks = EntityVec::with_capacity(self.layout.len());
        new.layout = Vec::with_capacity(self.layout.len());
        new.insts = EntityVec::with_capacity(insts);
        new.results = EntityVec::with_capacity(insts);
        new.locs = EntityVec::with_capacity(insts);
        new.values = EntityVec::with_capacity(defined);
        let mut values: EntityVec<Value, Option<Value>> = EntityVec::filled(None, self.values.len());
        for &block in &self.layout {
            let data = std::mem::take(&mut self.blocks[block]);
            let insts = Vec::with_capacity(data.insts.len());
            let target = new.blocks.push(BlockData { cold: data.cold, params: Vec::new(), insts });
            new.layout.push(target);
            for param in data.params {
                values[param] = Some(new.add_param(target, self.values[param].ty));
            }
            for inst in data.insts {
                // Results first, so that their numbers are those of the printed order.
                let mut results = std::mem::take(&mut self.results[inst]);
                for (index, result) in (0u32..).zip(&mut results) {
                    let def = ValueDef::Result(crate::Inst::new(new.insts.len()), index);
                    let value = new.values.push(ValueData { ty: self.values[*result].ty, def });
                    values[*result] = Some(value);
                    *result = value;
                }
                let data = std::mem::replace(&mut self.insts[inst], crate::InstData::Const { bits: 0 });
                let moved = new.insts.push(data);
                new.results.push(results);
                new.locs.push(self.locs[inst]);
                new.blocks[target].insts.push(moved);
            }
        }
        let known = new.values.len();
        let mut lost = Vec::new();
        for data in new.insts.values_mut() {
            data.map_uses(|value| {
                let value = match self.values[value].def {
                    ValueDef::Alias(other) => other,
                    ValueDef::Result(..) | ValueDef::Param(..) => value,
                };
                *values[value].get_or_insert_with(|| {
                    lost.push(value);
                    Value::new(known + lost.len() - 1)
                })
            });
            data.for_each_target_mut(|call| call.block = blocks[call.block].unwrap_or(call.block));
        }
        for value in lost {
            new.values.push(self.values[value].clone());
        }
        *self = new;
    }

    /// Drops blocks that cannot be reached, and makes the function canonical.
    pub fn compact(&mut self) {
        self.remove_unreachable_blocks();
        self.renumber();
    }

    /// Takes blocks that cannot be reached out of the layout; returns how many.
    pub fn remove_unreachable_blocks(&mut self) -> usize {
        let reachable = reachable(self);
        let before = self.layout.len();
        self.layout.retain(|&block| reachable[block]);
        before - self.layout.len()
    }
}
