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

mod paths;

use plcc_abi::functions::Effect;
use plcc_abi::{RuntimeFn, Type};

use crate::entities::{Block, Entity, EntityVec, FuncId, Inst, Loc, Value, Var};
use crate::eval;
use crate::function::{Function, ValueDef};
use crate::instructions::{Address, BinaryOp, BlockCall, ConvertOp, FloatCc, InstData, IntCc, Region, UnaryOp};
use paths::Paths;
use rustc_hash::FxHashMap;

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

/// A variable, and where it was written.
struct VarState {
    ty: Type,
    /// Its value at the end of the block where it was written or read last.
    latest: Option<(Block, Value)>,
    /// Times at which it was written, see [`Paths`].
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
struct Join {
    block: Block,
    param: Value,
    predecessors: Vec<Block>,
    /// Values at the end of the predecessors, as far as they have been read.
    operands: Vec<Value>,
}

impl Join {
    fn new(block: Block, param: Value, predecessors: Vec<Block>) -> Join {
        Join { block, param, predecessors, operands: Vec::new() }
    }
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

    pub fn function(&self) -> &Function {
        &self.function
    }

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

    // Variables.

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
    fn read_var(&mut self, var: Var, block: Block) -> Value {
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
    fn complete_joins(&mut self, var: Var, mut joins: Vec<Join>, found: Option<Value>) -> Value {
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

    fn place_constants(&mut self) {
        for (block, state) in self.states.iter() {
            self.function.blocks[block].insts.splice(0..0, state.constants.iter().rev().copied());
        }
    }

    /// Drops the parameters that mean other values, and adds the operands of the remaining ones to all jumps.
    fn supply_params(&mut self) {
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

/// Instructions. Each method appends one to the current block unless it folds to a known value.
impl FunctionBuilder {
    fn push(&mut self, data: InstData, results: &[Type]) -> Inst {
        let block = self.block.expect("an instruction is built inside a block");
        let inst = self.function.make_inst(data, results, self.loc);
        self.function.blocks[block].insts.push(inst);
        inst
    }

    fn push_value(&mut self, data: InstData, ty: Type) -> Value {
        let inst = self.push(data, &[ty]);
        self.function.result(inst)
    }

    fn terminate(&mut self, data: InstData) {
        let block = self.block.expect("a terminator is built inside a block");
        for target in data.targets() {
            assert!(!self.states[target.block].sealed, "{} is sealed, no jump can be added", target.block);
            self.states[target.block].predecessors.push(block);
        }
        self.push(data, &[]);
        self.ended.push(block);
        self.paths.leave(block);
        self.block = None;
    }

    pub fn ty(&self, value: Value) -> Type {
        self.function.ty(value)
    }

    /// The bits of `value` if it is a constant.
    pub fn constant_bits(&self, value: Value) -> Option<u64> {
        self.function.constant(value)
    }

    /// An integer constant; `value` is cut to the width of `ty`.
    pub fn iconst(&mut self, ty: Type, value: i64) -> Value {
        self.push_value(InstData::Const { bits: eval::mask(ty, value as u64) }, ty)
    }

    /// An i1 constant.
    pub fn bool_const(&mut self, value: bool) -> Value {
        self.iconst(Type::I1, i64::from(value))
    }

    pub fn i32_const(&mut self, value: u32) -> Value {
        self.iconst(Type::I32, i64::from(value))
    }

    pub fn f32_const(&mut self, value: f32) -> Value {
        self.push_value(InstData::Const { bits: u64::from(value.to_bits()) }, Type::F32)
    }

    pub fn unary(&mut self, op: UnaryOp, arg: Value) -> Value {
        let ty = self.ty(arg);
        match self.constant_bits(arg) {
            Some(bits) => self.push_value(InstData::Const { bits: eval::mask(ty, eval::unary(op, ty, bits)) }, ty),
            None => self.push_value(InstData::Unary { op, arg }, ty),
        }
    }

    pub fn binary(&mut self, op: BinaryOp, a: Value, b: Value) -> Value {
        let ty = self.ty(a);
        assert_eq!(ty, self.ty(b), "operands of {}", op.name());
        let (ca, cb) = (self.constant_bits(a), self.constant_bits(b));
        if let (Some(ca), Some(cb)) = (ca, cb)
            && let Some(bits) = eval::binary(op, ty, ca, cb)
        {
            return self.push_value(InstData::Const { bits }, ty);
        }
        if let Some(value) = self.binary_identity(op, ty, (a, ca), (b, cb)) {
            return value;
        }
        self.push_value(InstData::Binary { op, args: [a, b] }, ty)
    }

    /// `a op b` where it is one of the two or a constant.
    fn binary_identity(
        &mut self,
        op: BinaryOp,
        ty: Type,
        (a, ca): (Value, Option<u64>),
        (b, cb): (Value, Option<u64>),
    ) -> Option<Value> {
        let all = eval::mask(ty, u64::MAX);
        match op {
            BinaryOp::And => match (ca, cb) {
                (Some(bits), _) if bits == all => Some(b),
                (_, Some(bits)) if bits == all => Some(a),
                (Some(0), _) => Some(a),
                (_, Some(0)) => Some(b),
                _ => (a == b).then_some(a),
            },
            BinaryOp::Or => match (ca, cb) {
                (Some(0), _) => Some(b),
                (_, Some(0)) => Some(a),
                (Some(bits), _) if bits == all => Some(a),
                (_, Some(bits)) if bits == all => Some(b),
                _ => (a == b).then_some(a),
            },
            BinaryOp::Xor => match (ca, cb) {
                (Some(0), _) => Some(b),
                (_, Some(0)) => Some(a),
                _ if a == b => Some(self.iconst(ty, 0)),
                _ => None,
            },
            BinaryOp::Iadd => match (ca, cb) {
                (Some(0), _) => Some(b),
                (_, Some(0)) => Some(a),
                _ => None,
            },
            BinaryOp::Isub | BinaryOp::Shl | BinaryOp::Lshr | BinaryOp::Ashr | BinaryOp::Rotl | BinaryOp::Rotr => {
                (cb == Some(0)).then_some(a)
            }
            BinaryOp::Imul
            | BinaryOp::Sdiv
            | BinaryOp::Srem
            | BinaryOp::Udiv
            | BinaryOp::Urem
            | BinaryOp::Fadd
            | BinaryOp::Fsub
            | BinaryOp::Fmul
            | BinaryOp::Fdiv => None,
        }
    }

    pub fn iadd(&mut self, a: Value, b: Value) -> Value {
        self.binary(BinaryOp::Iadd, a, b)
    }

    pub fn isub(&mut self, a: Value, b: Value) -> Value {
        self.binary(BinaryOp::Isub, a, b)
    }

    pub fn and(&mut self, a: Value, b: Value) -> Value {
        self.binary(BinaryOp::And, a, b)
    }

    pub fn or(&mut self, a: Value, b: Value) -> Value {
        self.binary(BinaryOp::Or, a, b)
    }

    pub fn xor(&mut self, a: Value, b: Value) -> Value {
        self.binary(BinaryOp::Xor, a, b)
    }

    /// One's complement; of an i1 its negation.
    pub fn not(&mut self, a: Value) -> Value {
        let ones = self.iconst(self.ty(a), -1);
        self.xor(a, ones)
    }

    /// `a op imm`.
    pub fn binary_imm(&mut self, op: BinaryOp, a: Value, imm: i64) -> Value {
        let b = self.iconst(self.ty(a), imm);
        self.binary(op, a, b)
    }

    pub fn icmp(&mut self, cc: IntCc, a: Value, b: Value) -> Value {
        let ty = self.ty(a);
        assert_eq!(ty, self.ty(b), "operands of a comparison");
        if let (Some(ca), Some(cb)) = (self.constant_bits(a), self.constant_bits(b)) {
            return self.bool_const(eval::int_compare(cc, ty, ca, cb));
        }
        self.push_value(InstData::IntCompare { cc, args: [a, b] }, Type::I1)
    }

    pub fn icmp_imm(&mut self, cc: IntCc, a: Value, imm: i64) -> Value {
        let b = self.iconst(self.ty(a), imm);
        self.icmp(cc, a, b)
    }

    pub fn fcmp(&mut self, cc: FloatCc, a: Value, b: Value) -> Value {
        let ty = self.ty(a);
        if let (Some(ca), Some(cb)) = (self.constant_bits(a), self.constant_bits(b)) {
            return self.bool_const(eval::float_compare(cc, ty, ca, cb));
        }
        self.push_value(InstData::FloatCompare { cc, args: [a, b] }, Type::I1)
    }

    /// Converts `arg` to `to`; the value itself if it has that type.
    pub fn convert(&mut self, op: ConvertOp, to: Type, arg: Value) -> Value {
        let from = self.ty(arg);
        if from == to {
            return arg;
        }
        match self.constant_bits(arg) {
            Some(bits) => self.push_value(InstData::Const { bits: eval::convert(op, from, to, bits) }, to),
            None => self.push_value(InstData::Convert { op, arg }, to),
        }
    }

    pub fn zext(&mut self, to: Type, arg: Value) -> Value {
        self.convert(ConvertOp::Zext, to, arg)
    }

    pub fn sext(&mut self, to: Type, arg: Value) -> Value {
        self.convert(ConvertOp::Sext, to, arg)
    }

    pub fn trunc(&mut self, to: Type, arg: Value) -> Value {
        self.convert(ConvertOp::Trunc, to, arg)
    }

    pub fn bitcast(&mut self, to: Type, arg: Value) -> Value {
        self.convert(ConvertOp::Bitcast, to, arg)
    }

    pub fn select(&mut self, cond: Value, if_true: Value, if_false: Value) -> Value {
        match self.constant_bits(cond) {
            Some(0) => if_false,
            Some(_) => if_true,
            None if if_true == if_false => if_true,
            None => {
                let ty = self.ty(if_true);
                self.push_value(InstData::Select { cond, if_true, if_false }, ty)
            }
        }
    }

    /// Reads a value of type `ty`, not i1.
    pub fn load(&mut self, ty: Type, addr: Address) -> Value {
        self.push_value(InstData::Load { addr }, ty)
    }

    pub fn store(&mut self, addr: Address, value: Value) {
        self.push(InstData::Store { addr, value }, &[]);
    }

    pub fn load_bit(&mut self, addr: Address, bit: u8) -> Value {
        self.push_value(InstData::LoadBit { addr, bit }, Type::I1)
    }

    pub fn store_bit(&mut self, addr: Address, bit: u8, value: Value) {
        self.push(InstData::StoreBit { addr, bit, value }, &[]);
    }

    /// Reads the field of the CPU state at offset `field`, an i32.
    pub fn load_state(&mut self, field: u32) -> Value {
        self.load(Type::I32, Address::direct(Region::State, field))
    }

    /// Writes the field of the CPU state at offset `field`.
    pub fn store_state(&mut self, field: u32, value: Value) {
        self.store(Address::direct(Region::State, field), value);
    }

    /// Offset of `addr` from the memory base.
    pub fn address_of(&mut self, addr: Address) -> Value {
        self.push_value(InstData::AddressOf { addr }, Type::I32)
    }

    /// Sets `len` bytes to 0.
    pub fn clear(&mut self, addr: Address, len: u32) {
        if len > 0 {
            self.push(InstData::Clear { addr, len }, &[]);
        }
    }

    /// Copies `len` bytes; the ranges may overlap.
    pub fn copy(&mut self, to: Address, from: Address, len: u32) {
        if len > 0 {
            self.push(InstData::Copy { to, from, len }, &[]);
        }
    }

    /// See [`InstData::DbBase`].
    pub fn db_base(&mut self, number: Value) -> Value {
        self.push_value(InstData::DbBase { number }, Type::I32)
    }

    /// See [`InstData::DbLength`].
    pub fn db_length(&mut self, number: Value) -> Value {
        self.push_value(InstData::DbLength { number }, Type::I32)
    }

    /// See [`InstData::FrameBase`].
    pub fn frame_base(&mut self, callee: bool) -> Value {
        self.push_value(InstData::FrameBase { callee }, Type::I32)
    }

    /// Calls `callee`, which returns values of types `returns`.
    pub fn call(&mut self, callee: FuncId, args: Vec<Value>, returns: &[Type]) -> Vec<Value> {
        let inst = self.push(InstData::Call { callee, args }, returns);
        self.function.results[inst].to_vec()
    }

    /// Calls a runtime function; its result, if it has one.
    pub fn call_runtime(&mut self, function: RuntimeFn, args: &[Value]) -> Option<Value> {
        assert_eq!(function.params().len(), args.len(), "arguments of {}", function.name());
        let inst = self.push(InstData::CallRuntime { function, args: args.to_vec() }, function.result().as_slice());
        self.function.results[inst].first().copied()
    }

    /// Calls a pure runtime function.
    pub fn call_pure(&mut self, function: RuntimeFn, args: &[Value]) -> Value {
        assert_eq!(function.effect(), Effect::Pure);
        self.call_runtime(function, args).expect("pure functions have a result")
    }

    // Terminators.

    pub fn jump(&mut self, block: Block, args: &[Value]) {
        self.terminate(InstData::Jump { target: BlockCall { block, args: args.to_vec() } });
    }

    /// Goes to `then_block` if `cond`, an i1, is 1. A constant condition makes a jump.
    pub fn branch(&mut self, cond: Value, then_block: Block, else_block: Block) {
        match self.constant_bits(cond) {
            Some(0) => self.jump(else_block, &[]),
            Some(_) => self.jump(then_block, &[]),
            None => self.terminate(InstData::Branch {
                cond,
                then_to: BlockCall::new(then_block),
                else_to: BlockCall::new(else_block),
            }),
        }
    }

    /// Goes to `targets[value]`, to `default` if there are fewer.
    pub fn switch(&mut self, value: Value, targets: &[Block], default: Block) {
        let calls = targets.iter().map(|&block| BlockCall::new(block)).collect();
        self.terminate(InstData::Switch { value, targets: calls, default: BlockCall::new(default) });
    }

    pub fn ret(&mut self, values: &[Value]) {
        assert_eq!(values.len(), self.function.returns.len(), "values returned");
        self.terminate(InstData::Return { values: values.to_vec() });
    }
}

#[cfg(test)]
mod tests;
