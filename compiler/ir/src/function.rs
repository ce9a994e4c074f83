//! A function of the IR: blocks, instructions, values.

use crate::entities::{Block, Entity, EntityVec, Inst, Loc, Value};
use crate::instructions::{BlockCall, InstData, Values};
use plcc_abi::Type;

/// Where a value comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValueDef {
    /// Result number of an instruction.
    Result(Inst, u32),
    /// Parameter number of a block.
    Param(Block, u32),
    /// Another name of that value, left behind by a rewrite; see [`Function::resolve`].
    Alias(Value),
}

/// Type and definition of a value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ValueData {
    pub ty: Type,
    pub def: ValueDef,
}

/// A basic block.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct BlockData {
    pub params: Vec<Value>,
    pub insts: Vec<Inst>,
    /// Rarely runs: faults and safepoints.
    pub cold: bool,
}

/// The results of an instruction. Hardly any but calls have more than one; a single one needs no allocation.
#[derive(Clone, Debug, Default)]
pub enum Results {
    #[default]
    None,
    One([Value; 1]),
    More(Values),
}

impl Results {
    #[inline]
    pub fn as_slice(&self) -> &[Value] {
        match self {
            Results::None => &[],
            Results::One(one) => one,
            Results::More(more) => more,
        }
    }

    /// Keeps those for which `keep` is true.
    pub fn retain(&mut self, mut keep: impl FnMut(&mut Value) -> bool) {
        match self {
            Results::None => {}
            Results::One([one]) => {
                if !keep(one) {
                    *self = Results::None;
                }
            }
            Results::More(more) => more.retain_mut(keep),
        }
    }
}

impl std::ops::Deref for Results {
    type Target = [Value];

    #[inline]
    fn deref(&self) -> &[Value] {
        self.as_slice()
    }
}

impl std::ops::DerefMut for Results {
    #[inline]
    fn deref_mut(&mut self) -> &mut [Value] {
        match self {
            Results::None => &mut [],
            Results::One(one) => one,
            Results::More(more) => more,
        }
    }
}

impl<'a> IntoIterator for &'a Results {
    type Item = &'a Value;
    type IntoIter = std::slice::Iter<'a, Value>;

    #[inline]
    fn into_iter(self) -> Self::IntoIter {
        self.as_slice().iter()
    }
}

impl<'a> IntoIterator for &'a mut Results {
    type Item = &'a mut Value;
    type IntoIter = std::slice::IterMut<'a, Value>;

    #[inline]
    fn into_iter(self) -> Self::IntoIter {
        self.iter_mut()
    }
}

impl IntoIterator for Results {
    type Item = Value;
    type IntoIter = std::iter::Chain<std::option::IntoIter<Value>, thin_vec::IntoIter<Value>>;

    #[inline]
    fn into_iter(self) -> Self::IntoIter {
        let (one, more) = match self {
            Results::None => (None, Values::new()),
            Results::One([one]) => (Some(one), Values::new()),
            Results::More(more) => (None, more),
        };
        one.into_iter().chain(more)
    }
}

/// Lists are the same if they have the same values, however they are kept.
impl PartialEq for Results {
    fn eq(&self, other: &Results) -> bool {
        self.as_slice() == other.as_slice()
    }
}

impl Eq for Results {}

impl FromIterator<Value> for Results {
    #[inline]
    fn from_iter<T: IntoIterator<Item = Value>>(values: T) -> Results {
        let mut values = values.into_iter();
        match (values.next(), values.next()) {
            (None, _) => Results::None,
            (Some(one), None) => Results::One([one]),
            (Some(one), Some(two)) => Results::More([one, two].into_iter().chain(values).collect()),
        }
    }
}

/// A function. The entry block is the first one; its parameters are the function's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Function {
    /// `FC12`, `OB1`; unique in the module.
    pub name: String,
    /// Types of the values that it returns.
    pub returns: Vec<Type>,
    /// Bytes of L stack that a call takes, a multiple of [`plcc_abi::layout::FRAME_ALIGN`].
    pub frame_bytes: u32,
    /// Bytes of L stack after the frame that functions inlined here have as their frames. Callees have theirs in the same place: what
    /// is there does not outlive a call. A multiple of [`plcc_abi::layout::FRAME_ALIGN`].
    pub inlined_bytes: u32,
    /// A part of another function that is kept out of it: what rarely runs would cost the rest registers.
    pub apart: bool,
    /// It reaches the frame of its caller only where its parameters say, and by the area pointers that the caller has stored there.
    pub by_pointers: bool,
    pub blocks: EntityVec<Block, BlockData>,
    /// Blocks in the order in which they are printed and laid out; the entry is the first.
    pub layout: Vec<Block>,
    pub insts: EntityVec<Inst, InstData>,
    pub values: EntityVec<Value, ValueData>,
    /// Results of each instruction.
    pub results: EntityVec<Inst, Results>,
    pub locs: EntityVec<Inst, Loc>,
}

impl Function {
    /// A function without blocks.
    pub fn new(name: impl Into<String>) -> Function {
        Function {
            name: name.into(),
            returns: Vec::new(),
            frame_bytes: 0,
            inlined_bytes: 0,
            apart: false,
            by_pointers: false,
            blocks: EntityVec::new(),
            layout: Vec::new(),
            insts: EntityVec::new(),
            values: EntityVec::new(),
            results: EntityVec::new(),
            locs: EntityVec::new(),
        }
    }

    /// The first block of the layout.
    #[inline]
    pub fn entry(&self) -> Block {
        self.layout[0]
    }

    /// Bytes of local data that the function can address directly: its frame, and the frames inlined after it.
    pub fn local_bytes(&self) -> u32 {
        self.frame_bytes.saturating_add(self.inlined_bytes)
    }

    /// Types of the parameters.
    pub fn params(&self) -> impl Iterator<Item = Type> + '_ {
        self.blocks[self.entry()].params.iter().map(|&param| self.values[param].ty)
    }

    /// Adds an empty block at the end of the layout.
    pub fn add_block(&mut self) -> Block {
        let block = self.blocks.push(BlockData::default());
        self.layout.push(block);
        block
    }

    /// Appends a parameter to `block`.
    pub fn add_param(&mut self, block: Block, ty: Type) -> Value {
        let index = self.blocks[block].params.len() as u32;
        let value = self.values.push(ValueData { ty, def: ValueDef::Param(block, index) });
        self.blocks[block].params.push(value);
        value
    }

    /// Makes an instruction that is in no block yet.
    pub fn make_inst(&mut self, data: InstData, result_types: &[Type], loc: Loc) -> Inst {
        let inst = self.insts.push(data);
        let results = (0u32..)
            .zip(result_types)
            .map(|(index, &ty)| self.values.push(ValueData { ty, def: ValueDef::Result(inst, index) }))
            .collect();
        self.results.push(results);
        self.locs.push(loc);
        inst
    }

    /// Takes the code out. The name, types of parameters and results, and the frame stay: what callers need to know.
    pub fn take_body(&mut self) -> Function {
        let mut head = Function::new(self.name.clone());
        head.returns.clone_from(&self.returns);
        (head.frame_bytes, head.inlined_bytes, head.apart) = (self.frame_bytes, self.inlined_bytes, self.apart);
        if !self.layout.is_empty() {
            let entry = head.add_block();
            self.params().for_each(|ty| {
                head.add_param(entry, ty);
            });
        }
        std::mem::replace(self, head)
    }

    /// Gives back memory that was reserved for more instructions: a third of what a function takes after it has been built.
    pub fn shrink_to_fit(&mut self) {
        self.layout.shrink_to_fit();
        self.blocks.shrink_to_fit();
        for block in self.blocks.values_mut() {
            block.params.shrink_to_fit();
            block.insts.shrink_to_fit();
        }
        self.insts.shrink_to_fit();
        self.values.shrink_to_fit();
        self.results.shrink_to_fit();
        self.locs.shrink_to_fit();
    }

    /// The only result of `inst`.
    #[inline]
    pub fn result(&self, inst: Inst) -> Value {
        self.results[inst][0]
    }

    /// Type of `value`.
    #[inline]
    pub fn ty(&self, value: Value) -> Type {
        self.values[value].ty
    }

    /// The value that `value` is an alias of, or itself.
    #[inline]
    pub fn resolve(&self, mut value: Value) -> Value {
        while let ValueDef::Alias(other) = self.values[value].def {
            value = other;
        }
        value
    }

    /// Replaces aliases with their values among the operands of `inst`.
    #[inline]
    pub fn resolve_uses(&mut self, inst: Inst) {
        let values = &self.values;
        self.insts[inst].map_uses(|mut value| {
            while let ValueDef::Alias(other) = values[value].def {
                value = other;
            }
            value
        });
    }

    /// Makes `value` another name of `other`.
    #[inline]
    pub fn replace_value(&mut self, value: Value, other: Value) {
        let other = self.resolve(other);
        debug_assert_ne!(value, other);
        self.values[value].def = ValueDef::Alias(other);
    }

    /// Replaces aliases with their values, in all instructions of all blocks.
    pub fn resolve_aliases(&mut self) {
        self.shorten_aliases();
        let values = &self.values;
        let resolve = |value: Value| match values[value].def {
            ValueDef::Alias(other) => other,
            ValueDef::Result(..) | ValueDef::Param(..) => value,
        };
        for block in &self.layout {
            for &inst in &self.blocks[*block].insts {
                self.insts[inst].map_uses(resolve);
            }
        }
    }

    /// Makes all aliases those of values, so that a long chain is walked once.
    pub(crate) fn shorten_aliases(&mut self) {
        for index in 0..self.values.len() {
            let value = Value::new(index);
            if let ValueDef::Alias(other) = self.values[value].def
                && let ValueDef::Alias(_) = self.values[other].def
            {
                let target = self.resolve(value);
                let mut at = value;
                while let ValueDef::Alias(next) = self.values[at].def
                    && next != target
                {
                    self.values[at].def = ValueDef::Alias(target);
                    at = next;
                }
            }
        }
    }

    /// The instruction that defines `value`, unless it is a block parameter.
    #[inline]
    pub fn defining(&self, value: Value) -> Option<&InstData> {
        match self.values[self.resolve(value)].def {
            ValueDef::Result(inst, _) => Some(&self.insts[inst]),
            ValueDef::Param(..) | ValueDef::Alias(_) => None,
        }
    }

    /// The bits of `value` if it is a constant.
    #[inline]
    pub fn constant(&self, value: Value) -> Option<u64> {
        match self.defining(value) {
            Some(InstData::Const { bits }) => Some(*bits),
            _ => None,
        }
    }

    /// The last instruction of `block`, if it ends the block.
    #[inline]
    pub fn terminator(&self, block: Block) -> Option<Inst> {
        self.blocks[block].insts.last().copied().filter(|&inst| self.insts[inst].is_terminator())
    }

    /// Jump targets of `block`, in order, with repeats.
    pub fn successors(&self, block: Block) -> Vec<Block> {
        self.terminator(block)
            .map(|inst| self.insts[inst].targets().into_iter().map(|call: &BlockCall| call.block).collect())
            .unwrap_or_default()
    }
}
