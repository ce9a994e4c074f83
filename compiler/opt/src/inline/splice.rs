//! Puts a copy of one function in the place of a call.

use plcc_ir::entities::EntityVec;
use plcc_ir::{Address, Block, BlockCall, Function, Inst, InstData, Loc, Region, Value, Values};

use super::address_in_caller;
use super::safepoint::is_stop_exit;

/// A call that is being replaced.
pub struct Splice<'a> {
    caller: &'a mut Function,
    callee: &'a Function,
    call: Inst,
    /// The caller's block that ends at the call.
    at: Block,
    /// Where the caller returns on STOP.
    stop: Option<Block>,
    /// The callee's values in the caller.
    values: EntityVec<Value, Option<Value>>,
    /// The callee's blocks in the caller.
    blocks: EntityVec<Block, Block>,
    loc: Loc,
}

impl<'a> Splice<'a> {
    pub fn new(
        caller: &'a mut Function,
        callee: &'a Function,
        call: Inst,
        at: Block,
        stop: Option<Block>,
    ) -> Splice<'a> {
        let loc = caller.locs[call];
        let (mut values, mut blocks) = (EntityVec::new(), EntityVec::new());
        for _ in callee.values.keys() {
            values.push(None);
        }
        for _ in callee.blocks.keys() {
            blocks.push(at);
        }
        Splice { caller, callee, call, at, stop, values, blocks, loc }
    }

    /// Makes the copy; returns the block in which the caller continues.
    pub fn run(mut self) -> Block {
        self.caller.inlined_bytes = self.caller.inlined_bytes.max(self.callee.local_bytes());
        let copied = self.make_blocks();
        let single = self.only_return(&copied);
        // A callee without jumps is put into the block of the call.
        let after =
            if copied.len() == 1 && single.is_some() { self.at } else { self.make_continuation(single.is_some()) };
        for &block in &copied {
            self.make_results(block);
        }
        for &block in &copied {
            self.copy_insts(block, after, single.is_some());
        }
        if let Some(values) = single {
            let results = self.caller.results[self.call].clone();
            for (result, value) in results.into_iter().zip(values) {
                let value = self.value(value);
                self.caller.replace_value(result, value);
            }
        }
        after
    }

    /// Makes a block for each one of the callee with its parameters. On STOP it is left by the caller's own exit.
    fn make_blocks(&mut self) -> Vec<Block> {
        let cold = self.caller.blocks[self.at].cold;
        let InstData::Call { args, .. } = &self.caller.insts[self.call] else { unreachable!("it is a call") };
        let entry = self.callee.entry();
        for (&param, &arg) in self.callee.blocks[entry].params.iter().zip(args) {
            self.values[param] = Some(arg);
        }
        let mut copied = vec![entry];
        for &block in &self.callee.layout[1..] {
            if let Some(stop) = self.stop
                && is_stop_exit(self.callee, block)
            {
                self.blocks[block] = stop;
                continue;
            }
            let new = self.caller.add_block();
            self.caller.blocks[new].cold = cold || self.callee.blocks[block].cold;
            for &param in &self.callee.blocks[block].params {
                self.values[param] = Some(self.caller.add_param(new, self.callee.ty(param)));
            }
            self.blocks[block] = new;
            copied.push(block);
        }
        copied
    }

    /// The values that the callee returns, if it returns at one place.
    fn only_return(&self, copied: &[Block]) -> Option<Values> {
        let mut returns =
            copied.iter().filter_map(|&block| match &self.callee.insts[self.callee.terminator(block)?] {
                InstData::Return { values } => Some(values),
                _ => None,
            });
        let first = returns.next()?;
        returns.next().is_none().then(|| first.clone())
    }

    /// The block after the call. Unless the callee returns at one place, its parameters are the call's results.
    fn make_continuation(&mut self, single: bool) -> Block {
        let block = self.caller.add_block();
        self.caller.blocks[block].cold = self.caller.blocks[self.at].cold;
        if !single {
            for result in self.caller.results[self.call].clone() {
                let param = self.caller.add_param(block, self.caller.ty(result));
                self.caller.replace_value(result, param);
            }
        }
        block
    }

    /// Assigns values to the results of a block's instructions, before any of them is used.
    fn make_results(&mut self, block: Block) {
        let mut types = Vec::new();
        for &inst in &self.callee.blocks[block].insts {
            types.clear();
            types.extend(self.callee.results[inst].iter().map(|&result| self.callee.ty(result)));
            let new = self.caller.make_inst(InstData::Const { bits: 0 }, &types, self.loc_of(inst));
            for (&result, &value) in self.callee.results[inst].iter().zip(&self.caller.results[new]) {
                self.values[result] = Some(value);
            }
            self.caller.blocks[self.blocks[block]].insts.push(new);
        }
    }

    /// The callee's place in the source, or that of the call for code without a place.
    fn loc_of(&self, inst: Inst) -> Loc {
        match self.callee.locs[inst] {
            Loc(0) => self.loc,
            loc => loc,
        }
    }

    fn value(&self, value: Value) -> Value {
        let value = self.values[self.callee.resolve(value)].expect("a definition stands in a block that is copied");
        self.caller.resolve(value)
    }

    /// Fills the instructions that [`Self::make_results`] has made.
    fn copy_insts(&mut self, block: Block, after: Block, single: bool) {
        let target = self.blocks[block];
        let source = &self.callee.blocks[block].insts;
        let first = self.caller.blocks[target].insts.len() - source.len();
        for (index, &inst) in source.iter().enumerate() {
            let new = self.caller.blocks[target].insts[first + index];
            match self.copy_of(inst, after, single) {
                Some(data) => self.caller.insts[new] = data,
                // The end of a callee without jumps.
                None => {
                    self.caller.blocks[target].insts.pop();
                }
            }
        }
    }

    fn copy_of(&self, inst: Inst, after: Block, single: bool) -> Option<InstData> {
        let mut data = self.callee.insts[inst].clone();
        data.map_uses(|value| self.value(value));
        data.for_each_target_mut(|target| target.block = self.blocks[target.block]);
        let frame_bytes = self.caller.frame_bytes;
        let place = |addr: &mut Address| *addr = address_in_caller(*addr, frame_bytes);
        match &mut data {
            InstData::Return { values } => {
                if after == self.at {
                    return None;
                }
                let args = if single { Values::new() } else { std::mem::take(values) };
                data = InstData::Jump { target: BlockCall { block: after, args } };
            }
            InstData::Load { addr }
            | InstData::Store { addr, .. }
            | InstData::LoadBit { addr, .. }
            | InstData::StoreBit { addr, .. }
            | InstData::AddressOf { addr }
            | InstData::Clear { addr, .. } => place(addr),
            InstData::Copy { to, from, .. } => {
                place(to);
                place(from);
            }
            InstData::FrameBase { callee } => {
                let offset = if *callee { frame_bytes + self.callee.frame_bytes } else { frame_bytes };
                data = InstData::AddressOf { addr: Address::direct(Region::L, offset) };
            }
            _ => {}
        }
        Some(data)
    }
}
