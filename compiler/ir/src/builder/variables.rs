//! Variables of the source program as values: what a read finds, block by block, and the parameters where several definitions meet.

use plcc_abi::Type;

use super::FunctionBuilder;
use crate::entities::{Block, Entity, Loc, Value, Var};
use crate::function::ValueDef;
use crate::instructions::InstData;

/// A variable, and where it was written.
pub(super) struct VarState {
    ty: Type,
    /// Its value at the end of the block where it was written or read last.
    latest: Option<(Block, Value)>,
    /// Times at which it was written, see `paths.rs`.
    written: Vec<u32>,
}

impl VarState {
    /// True if it was written after time `after` and up to `limit`.
    fn is_written(&self, after: u32, limit: u32) -> bool {
        let next = self.written.partition_point(|&time| time <= after);
        self.written.get(next).is_some_and(|&time| time <= limit)
    }
}

/// A block with several predecessors. Its parameter for a variable waits for their arguments.
pub(super) struct Join {
    block: Block,
    param: Value,
    predecessors: Vec<Block>,
    /// Values at the end of the predecessors, as far as they have been read.
    operands: Vec<Value>,
}

impl Join {
    pub(super) fn new(block: Block, param: Value, predecessors: Vec<Block>) -> Join {
        Join { block, param, predecessors, operands: Vec::new() }
    }
}
/// Variables.
impl FunctionBuilder {
    /// A variable of the source program; the builder turns its definitions and uses into SSA values.
    pub fn declare_var(&mut self, ty: Type) -> Var {
        self.vars.push(VarState { ty, latest: None, written: Vec::new() })
    }

    /// `var` has `value` from here on, in the current block.
    pub fn def_var(&mut self, var: Var, value: Value) {
        let block = self.block.expect("a variable is written inside a block");
        let state = &mut self.vars[var];
        assert_eq!(state.ty, self.function.ty(value), "type of {var}");
        let now = self.paths.now();
        if state.written.last() != Some(&now) {
            state.written.push(now);
        }
        self.note_value(var, block, value);
    }

    /// The value of `var` here; where several definitions meet, a block parameter.
    pub fn use_var(&mut self, var: Var) -> Value {
        let block = self.block.expect("a variable is read inside a block");
        self.read_var(var, block)
    }

    /// `var` is `value` at the end of `block`, as built so far.
    fn note_value(&mut self, var: Var, block: Block, value: Value) {
        let before = self.vars[var].latest.replace((block, value));
        if let Some((other, value)) = before
            && other != block
        {
            self.known.insert((var, other), value);
        }
    }

    fn known_var(&self, var: Var, block: Block) -> Option<Value> {
        let value = match self.vars[var].latest {
            Some((latest, value)) if latest == block => Some(value),
            _ => self.known.get(&(var, block)).copied(),
        };
        value.map(|value| self.function.resolve(value))
    }

    /// Value of `var` at the end of `block`.
    pub(super) fn read_var(&mut self, var: Var, block: Block) -> Value {
        if let Some(value) = self.known_var(var, block) {
            return value;
        }
        let mut joins = Vec::new();
        let value = match self.walk_back(var, block, &mut joins) {
            Some(value) => value,
            None => self.complete_joins(var, joins, None),
        };
        self.note_value(var, block, value);
        value
    }

    /// Walks from `block` to where `var` is known, past blocks that do not write it. `None`: the walk ended at a block with
    /// several predecessors, which now is in `joins`.
    fn walk_back(&mut self, var: Var, block: Block, joins: &mut Vec<Join>) -> Option<Value> {
        let mut at = block;
        let mut steps = 0;
        loop {
            if let Some(value) = self.known_var(var, at) {
                return Some(value);
            }
            let ty = self.vars[var].ty;
            let state = &self.states[at];
            if !state.sealed {
                let param = self.function.add_param(at, ty);
                self.states[at].incomplete.push((var, param));
                self.note_value(var, at, param);
                return Some(param);
            }
            steps += 1;
            if let Some(next) = self.step_back(var, at) {
                at = next;
                continue;
            }
            match state.predecessors[..] {
                // Never written, or unreachable: 0.
                [] => break,
                // Blocks that only follow each other round a circle are unreachable.
                [_] if steps > self.states.len() => break,
                [only] => at = only,
                _ => {
                    let param = self.function.add_param(at, ty);
                    // Before the operands are read, so that a loop finds it.
                    self.note_value(var, at, param);
                    joins.push(Join::new(at, param, self.states[at].predecessors.clone()));
                    return None;
                }
            }
        }
        let value = self.constant_at_start(at, self.vars[var].ty, 0);
        self.note_value(var, at, value);
        Some(value)
    }

    /// An ancestor of `block` at whose end `var` has the value that it has at the start of `block`.
    fn step_back(&self, var: Var, block: Block) -> Option<Block> {
        let state = &self.vars[var];
        let steps = [self.paths.jump(block), self.paths.parent(block)];
        let clean = steps.into_iter().flatten().find(|step| !state.is_written(step.after, step.limit));
        clean.map(|step| step.to)
    }

    /// Reads `var` at the end of every predecessor of every join, and of those found on the way. The joins are
    /// in a list and not on the stack of the host, since blocks can have thousands of them in a row. `found` is a value for the
    /// last join. Returns the value of the first one.
    pub(super) fn complete_joins(&mut self, var: Var, mut joins: Vec<Join>, found: Option<Value>) -> Value {
        let mut found = found;
        loop {
            let join = joins.last_mut().expect("ends with the first join");
            if let Some(value) = found.take() {
                let predecessor = join.predecessors[join.operands.len()];
                join.operands.push(value);
                self.note_value(var, predecessor, value);
            }
            match join.predecessors.get(join.operands.len()).copied() {
                Some(predecessor) => found = self.walk_back(var, predecessor, &mut joins),
                None => {
                    let join = joins.pop().expect("it is the last");
                    let value = self.complete_param(var, join);
                    if joins.is_empty() {
                        return value;
                    }
                    found = Some(value);
                }
            }
        }
    }

    /// Records the argument of every jump to the join; returns the parameter, or the only value that it can have.
    fn complete_param(&mut self, var: Var, join: Join) -> Value {
        let Join { block, param, .. } = join;
        let mut same = None;
        for &operand in &join.operands {
            let operand = self.function.resolve(operand);
            if operand == param || Some(operand) == same {
                continue;
            }
            // Equal constants need no parameter.
            if let (Some(known), Some(bits)) = (same, self.function.constant(operand))
                && self.function.constant(known) == Some(bits)
            {
                continue;
            }
            if same.is_some() {
                self.states[block].joined.push((param, join.operands));
                return param;
            }
            same = Some(operand);
        }
        let replacement = match same.map(|value| (value, self.function.constant(value))) {
            Some((value, None)) => value,
            // A constant of one predecessor does not dominate this block.
            Some((_, Some(bits))) => self.constant_at_start(block, self.vars[var].ty, bits),
            // Unreachable.
            None => self.constant_at_start(block, self.vars[var].ty, 0),
        };
        self.function.replace_value(param, replacement);
        replacement
    }

    /// A constant at the start of `block`, before all others.
    fn constant_at_start(&mut self, block: Block, ty: Type, bits: u64) -> Value {
        let inst = self.function.make_inst(InstData::Const { bits }, &[ty], Loc(0));
        self.states[block].constants.push(inst);
        self.function.result(inst)
    }

    pub(super) fn place_constants(&mut self) {
        for (block, state) in self.states.iter() {
            self.function.blocks[block].insts.splice(0..0, state.constants.iter().rev().copied());
        }
    }

    /// Drops the parameters that mean other values, and adds the operands of the remaining ones to all jumps.
    pub(super) fn supply_params(&mut self) {
        for (block, state) in self.states.iter_mut() {
            let values = &mut self.function.values;
            let params = &mut self.function.blocks[block].params;
            params.retain(|&param| !matches!(values[param].def, ValueDef::Alias(_)));
            for (index, &param) in (0u32..).zip(params.iter()) {
                values[param].def = ValueDef::Param(block, index);
            }
            // In the order of the parameters, like the operands of the jumps.
            state.joined.sort_by_key(|&(param, _)| match values[param].def {
                ValueDef::Param(_, index) => index,
                ValueDef::Result(..) | ValueDef::Alias(_) => u32::MAX,
            });
        }
        // The lists contain the predecessors in the order of their ends, once for each jump.
        let mut next = vec![0; self.states.len()];
        for &block in &self.ended {
            let Some(inst) = self.function.terminator(block) else { continue };
            self.function.insts[inst].for_each_target_mut(|call| {
                let at = &mut next[call.block.index()];
                call.args.extend(self.states[call.block].joined.iter().map(|(_, operands)| operands[*at]));
                *at += 1;
            });
        }
    }
}
