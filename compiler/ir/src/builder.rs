//! Builds a function in SSA form.
//!
//! The caller declares variables and writes and reads them; the builder turns them into values and block parameters
//! (Braun et al., "Simple and efficient construction of static single assignment form", 2013): a read in a block
//! with several predecessors makes a parameter, which is removed again if all predecessors bring the same value.
//! A block is *sealed* when all its predecessors are known. Variables that no block on the way writes are not searched block by
//! block, see [`paths`]: time and memory grow with reads and writes, not with variables times blocks.
//!
//! Operations on constants are folded as they are built: most of the virtual CPU's state is known at compile time,
//! and instructions that need not exist need not be removed.

mod instructions;
mod paths;
mod variables;

use plcc_abi::Type;

use crate::entities::{Block, EntityVec, Inst, Loc, Value, Var};
use crate::function::Function;
use paths::Paths;
use rustc_hash::FxHashMap;
use variables::{Join, VarState};

/// State of a block while the function is built.
#[derive(Default)]
struct BlockState {
    predecessors: Vec<Block>,
    sealed: bool,
    /// Parameters made by reads before the block was sealed.
    incomplete: Vec<(Var, Value)>,
    /// Parameters of variables, and the arguments of each predecessor.
    joined: Vec<(Value, Vec<Value>)>,
    /// Constants at the start, the last one first.
    constants: Vec<Inst>,
}

/// Builds one function; see the module comment.
pub struct FunctionBuilder {
    function: Function,
    vars: EntityVec<Var, VarState>,
    /// Values of variables at the ends of blocks, except the latest ones.
    known: FxHashMap<(Var, Block), Value>,
    states: EntityVec<Block, BlockState>,
    paths: Paths,
    /// Blocks in the order in which they ended.
    ended: Vec<Block>,
    block: Option<Block>,
    loc: Loc,
}

impl FunctionBuilder {
    /// A builder for a function with parameters `params`; the current block is its sealed entry.
    pub fn new(name: impl Into<String>, params: &[Type], returns: &[Type]) -> FunctionBuilder {
        let mut function = Function::new(name);
        function.returns = returns.to_vec();
        let mut builder = FunctionBuilder {
            function,
            vars: EntityVec::new(),
            known: FxHashMap::default(),
            states: EntityVec::new(),
            paths: Paths::default(),
            ended: Vec::new(),
            block: None,
            loc: Loc(0),
        };
        let entry = builder.create_block();
        for &ty in params {
            builder.function.add_param(entry, ty);
        }
        builder.seal_block(entry);
        builder.switch_to(entry);
        builder
    }

    /// Ends building. Every block is sealed and ends with a terminator; those that cannot be reached are left out.
    pub fn finish(mut self) -> Function {
        for block in self.function.layout.clone() {
            assert!(self.states[block].sealed, "{block} of {} is not sealed", self.function.name);
            assert!(self.function.terminator(block).is_some(), "{block} of {} has no end", self.function.name);
        }
        self.place_constants();
        self.supply_params();
        self.function.resolve_aliases();
        // In an unreachable cycle a value can be defined by itself; the text would not parse.
        self.function.remove_unreachable_blocks();
        self.function
    }

    /// The function as built so far.
    pub fn function(&self) -> &Function {
        &self.function
    }

    /// Bytes of L stack that a call of the function takes, a multiple of [`plcc_abi::layout::FRAME_ALIGN`].
    pub fn set_frame_bytes(&mut self, bytes: u32) {
        self.function.frame_bytes = bytes;
    }

    /// Parameter `index` of the function.
    pub fn param(&self, index: usize) -> Value {
        self.function.blocks[self.function.entry()].params[index]
    }

    /// Source place of the instructions built from now on.
    pub fn set_loc(&mut self, loc: Loc) {
        self.loc = loc;
    }

    // Blocks.

    /// A block without instructions; nothing jumps to it until it is a target.
    pub fn create_block(&mut self) -> Block {
        let block = self.function.add_block();
        self.states.push(BlockState::default());
        self.paths.add();
        block
    }

    /// A block for faults and other rare paths; it is laid out at the end.
    pub fn create_cold_block(&mut self) -> Block {
        let block = self.create_block();
        self.function.blocks[block].cold = true;
        block
    }

    /// Appends a parameter that every jump to `block` must supply. Parameters are appended before
    /// variables are read in the block.
    pub fn append_param(&mut self, block: Block, ty: Type) -> Value {
        let state = &self.states[block];
        assert!(state.incomplete.is_empty() && state.joined.is_empty(), "variables have been read in {block}");
        self.function.add_param(block, ty)
    }

    /// Instructions built from now on go to the end of `block`.
    pub fn switch_to(&mut self, block: Block) {
        self.block = Some(block);
        let is_first = !self.paths.is_entered(block);
        self.paths.enter(block);
        if is_first {
            let state = &self.states[block];
            match state.sealed {
                true => self.paths.close(block, &state.predecessors),
                false => self.paths.open(block, &state.predecessors),
            }
        }
    }

    /// The block that is being filled; none after a terminator.
    pub fn current_block(&self) -> Option<Block> {
        self.block
    }

    /// True if code built now can be reached: there is a current block.
    pub fn is_reachable(&self) -> bool {
        self.block.is_some()
    }

    /// Says that all jumps to `block` have been built.
    pub fn seal_block(&mut self, block: Block) {
        if self.states[block].sealed {
            return;
        }
        for (var, param) in std::mem::take(&mut self.states[block].incomplete) {
            let join = Join::new(block, param, self.states[block].predecessors.clone());
            self.complete_joins(var, vec![join], None);
        }
        let state = &mut self.states[block];
        state.sealed = true;
        if self.paths.is_entered(block) {
            self.paths.close(block, &state.predecessors);
        }
    }
}

#[cfg(test)]
mod tests;
