//! One function of the IR to CLIF.
//!
//! Blocks are lowered in reverse postorder, so that every value is there before it is used; unreachable blocks are left out.
//! Constants are made where they are used. An i1 is kept as a [`Bit`] inside its block graph and is the byte 0 or 1
//! wherever it crosses a border: block parameters, calls, returns.

mod calls;
mod division;
mod operators;

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{
    self, BlockArg, FuncRef, InstBuilder, JumpTableData, SourceLoc, UserFuncName, Value as ClifValue, types,
};
use cranelift_codegen::isa::TargetIsa;
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};
use plcc_abi::{RuntimeFn, Type};
use plcc_ir::entities::{Entity, EntityVec};
use plcc_ir::{Block, BlockCall, ConvertOp, FloatCc, FuncId, Function, Inst, InstData, Module, Value};
use rustc_hash::FxHashMap;

use crate::CodegenError;
use crate::abi::{FunctionAbi, clif_type};
use crate::bits::Bit;
use crate::byte_order::Numbers;
use crate::compile::source_location;
use crate::floats;
use crate::joins::Joins;
use crate::memory::{Address, BitValue, Memory, constant};
use operators::{float_cc, unary};

/// A switch with at most this many targets becomes a chain of comparisons.
const COMPARED_TARGETS_MAX: usize = 3;

/// Input of lowering in addition to the function.
pub struct Target<'m> {
    pub module: &'m Module,
    pub abis: &'m EntityVec<FuncId, FunctionAbi>,
    pub isa: &'m dyn TargetIsa,
    /// Runtime functions are near enough for a direct call: they are linked into the same executable.
    pub near_runtime: bool,
    /// The machine can round to integral values.
    pub native_rounding: bool,
    /// Runtime functions that are called so that they keep all registers.
    pub keeping: &'m [RuntimeFn],
}

impl Target<'_> {
    /// Number under which a runtime function is known to the linker; functions of the module come first.
    pub fn runtime_symbol(&self, function: RuntimeFn) -> u32 {
        self.module.functions.len() as u32 + function as u32
    }

    /// Number of the function that calls a runtime function and keeps all registers; they come after the runtime functions.
    pub fn keeping_symbol(&self, function: RuntimeFn) -> Option<u32> {
        let index = self.keeping.iter().position(|&keeping| keeping == function)?;
        Some((self.module.functions.len() + RuntimeFn::ALL.len() + index) as u32)
    }
}

/// Lowers `function`, number `id` of the module, to `clif`, which is empty: memory that it had for another function is used again.
pub fn lower(
    target: &Target<'_>,
    id: FuncId,
    function: &Function,
    context: &mut FunctionBuilderContext,
    clif: &mut ir::Function,
) -> Result<(), CodegenError> {
    clif.name = UserFuncName::user(0, id.index() as u32);
    clif.signature = target.abis[id].signature.clone();
    // Source places count from 0, so code does not depend on the position of a function's first one.
    clif.params.ensure_base_srcloc(SourceLoc::new(0));
    let builder = FunctionBuilder::new(clif, context);
    let mut lowering = Lowering::new(target, id, function, builder);
    match lowering.function_body() {
        Ok(()) => {}
        Err(CodegenError::Module { message, .. }) => {
            return Err(CodegenError::Module { function: function.name.clone(), message });
        }
        Err(other) => return Err(other),
    }
    let Lowering { mut b, joins, blocks, .. } = lowering;
    joins.finish(&mut b, |block| blocks[block.index()].expect("a block that is jumped to was made"));
    b.seal_all_blocks();
    b.finalize(target.isa.frontend_config());
    Ok(())
}

/// A lowered value.
#[derive(Clone, Copy)]
enum Slot {
    Missing,
    Plain(ClifValue),
    /// A whole number with its bytes swapped, as it is in PLC memory.
    Swapped(ClifValue),
    Bit(Bit),
}

struct Lowering<'m, 'f> {
    target: &'m Target<'m>,
    abi: &'m FunctionAbi,
    function: &'m Function,
    b: FunctionBuilder<'f>,
    memory: Memory<'m>,
    slots: Vec<Slot>,
    numbers: Numbers,
    /// Bytes from memory that are extended somewhere, with the bits above them, which are 0; none before they are loaded.
    extended: FxHashMap<Value, Option<ClifValue>>,
    blocks: Vec<Option<ir::Block>>,
    callees: FxHashMap<u32, FuncRef>,
    joins: Joins,
}

/// Bytes that are loaded and then extended with 0: the instruction that loads them does that already.
fn extended_bytes(function: &Function) -> FxHashMap<Value, Option<ClifValue>> {
    let insts = function.layout.iter().flat_map(|&block| &function.blocks[block].insts);
    let is_loaded = |&value: &Value| {
        function.ty(value) == Type::I8 && matches!(function.defining(value), Some(InstData::Load { .. }))
    };
    let extended = insts.filter_map(|&inst| match &function.insts[inst] {
        InstData::Convert { op: ConvertOp::Zext, arg } => Some(function.resolve(*arg)),
        _ => None,
    });
    extended.filter(is_loaded).map(|value| (value, None)).collect()
}

impl<'m, 'f> Lowering<'m, 'f> {
    /// Makes the entry block with the function's parameters.
    fn new(target: &'m Target<'m>, id: FuncId, function: &'m Function, mut b: FunctionBuilder<'f>) -> Lowering<'m, 'f> {
        let abi = &target.abis[id];
        let entry = b.create_block();
        b.append_block_params_for_function_params(entry);
        b.switch_to_block(entry);
        let mut params = b.block_params(entry).to_vec().into_iter();
        let mut param = || params.next().expect("the signature was made for this function");
        let mem = param();
        let (frame, caller_frame) = if abi.entry {
            let mut frame_at = |base| {
                let wide = b.ins().uextend(types::I64, base);
                b.ins().iadd(mem, wide)
            };
            (Some(frame_at(param())), Some(frame_at(param())))
        } else {
            (abi.frame.then(&mut param), abi.caller_frame.then(&mut param))
        };
        let memory = Memory::new(&mut b, target.module, function, mem, frame, caller_frame);
        let mut lowering = Lowering {
            target,
            abi,
            function,
            b,
            memory,
            slots: vec![Slot::Missing; function.values.len()],
            numbers: Numbers::of(function),
            extended: extended_bytes(function),
            blocks: vec![None; function.blocks.len()],
            callees: FxHashMap::default(),
            joins: Joins::new(function),
        };
        let args: Vec<ClifValue> = params.collect();
        lowering.enter_first_block(entry, &args);
        lowering
    }

    /// The function's parameters become those of its first block: the same block, unless something jumps back to it.
    fn enter_first_block(&mut self, entry: ir::Block, args: &[ClifValue]) {
        let first = self.function.entry();
        let is_loop = self.function.layout.iter().any(|&block| self.function.successors(block).contains(&first));
        if is_loop {
            let block = self.make_block(first);
            let args: Vec<BlockArg> = args.iter().map(|&arg| BlockArg::Value(arg)).collect();
            self.b.ins().jump(block, &args);
        } else {
            self.blocks[first.index()] = Some(entry);
            self.define_params(first, args);
        }
    }

    fn define_params(&mut self, block: Block, args: &[ClifValue]) {
        for (&param, &arg) in self.function.blocks[block].params.iter().zip(args) {
            self.define(param, arg);
        }
    }

    /// The CLIF block of `block`, with its parameters.
    fn make_block(&mut self, block: Block) -> ir::Block {
        if let Some(made) = self.blocks[block.index()] {
            return made;
        }
        let made = self.b.create_block();
        let data = &self.function.blocks[block];
        if data.cold {
            self.b.set_cold_block(made);
        }
        let params: Vec<ClifValue> = data
            .params
            .iter()
            .map(|&param| self.b.append_block_param(made, clif_type(self.function.ty(param))))
            .collect();
        self.blocks[block.index()] = Some(made);
        self.define_params(block, &params);
        made
    }

    fn function_body(&mut self) -> Result<(), CodegenError> {
        for block in reverse_postorder(self.function) {
            let made = self.make_block(block);
            if self.b.current_block() != Some(made) {
                self.b.switch_to_block(made);
            }
            for &inst in &self.function.blocks[block].insts {
                let loc = self.function.locs[inst];
                self.b.set_srcloc(source_location(loc, self.function.blocks[block].cold));
                self.instruction(inst)?;
            }
            if self.function.terminator(block).is_none() {
                return Err(invalid(format!("{block} does not end with a terminator")));
            }
        }
        Ok(())
    }

    // Values.

    fn define(&mut self, value: Value, clif: ClifValue) {
        self.slots[value.index()] =
            if self.function.ty(value) == Type::I1 { Slot::Bit(Bit::Clean(clif)) } else { Slot::Plain(clif) };
    }

    fn define_bit(&mut self, value: Value, bit: Bit) {
        self.slots[value.index()] = Slot::Bit(bit);
    }

    /// The value as it crosses borders.
    fn value(&mut self, value: Value) -> Result<ClifValue, CodegenError> {
        let value = self.function.resolve(value);
        if let Some(bits) = self.function.constant(value) {
            return Ok(constant(&mut self.b, clif_type(self.function.ty(value)), bits));
        }
        match self.slots[value.index()] {
            Slot::Plain(clif) => Ok(clif),
            Slot::Swapped(clif) => Ok(self.b.ins().bswap(clif)),
            Slot::Bit(bit) => Ok(bit.clean(&mut self.b)),
            Slot::Missing => Err(invalid(format!("{value} is used where it is not defined"))),
        }
    }

    /// Values with their bytes swapped, as they are in PLC memory. `None`: they are not there in this form.
    fn swapped<const N: usize>(&mut self, values: [Value; N]) -> Option<[ClifValue; N]> {
        let function = self.function;
        let form = |value: Value| {
            let value = function.resolve(value);
            match (function.constant(value), self.slots[value.index()]) {
                (Some(bits), _) if function.ty(value).bytes() > 1 => Some(Err(bits)),
                (None, Slot::Swapped(clif)) => Some(Ok(clif)),
                _ => None,
            }
        };
        let forms = values.map(form);
        // Constants alone save nothing.
        if forms.iter().any(Option::is_none) || !forms.iter().any(|form| matches!(form, Some(Ok(_)))) {
            return None;
        }
        let ty = function.ty(values[0]);
        Some(forms.map(|form| match form.expect("all were found") {
            Ok(clif) => clif,
            Err(bits) => constant(&mut self.b, clif_type(ty), bits.swap_bytes() >> (64 - ty.bits())),
        }))
    }

    /// Operands of an operation on bytes with their bytes swapped, if its result is needed in this form only.
    fn swapped_operands(&mut self, operands: [Value; 2], result: Value) -> Option<[ClifValue; 2]> {
        if self.numbers.is_number(self.function, result) { None } else { self.swapped(operands) }
    }

    fn values(&mut self, values: &[Value]) -> Result<Vec<ClifValue>, CodegenError> {
        values.iter().map(|&value| self.value(value)).collect()
    }

    fn bit(&mut self, value: Value) -> Result<Bit, CodegenError> {
        let value = self.function.resolve(value);
        match self.slots[value.index()] {
            Slot::Bit(bit) => Ok(bit),
            Slot::Plain(_) | Slot::Swapped(_) | Slot::Missing => self.value(value).map(Bit::Clean),
        }
    }

    fn condition(&mut self, value: Value) -> Result<ClifValue, CodegenError> {
        let bit = self.bit(value)?;
        Ok(bit.condition(&mut self.b))
    }

    fn address(&mut self, addr: plcc_ir::Address) -> Result<Address, CodegenError> {
        let mut address = Address { region: addr.region, base: None, offset: addr.offset };
        if let Some(base) = addr.base {
            match self.function.constant(base) {
                Some(bits) if u64::from(addr.offset) + bits <= u64::from(u32::MAX) => address.offset += bits as u32,
                _ => address.base = Some(self.value(base)?),
            }
        }
        Ok(address)
    }

    // Instructions.

    fn instruction(&mut self, inst: Inst) -> Result<(), CodegenError> {
        let function = self.function;
        let results = &function.results[inst];
        let only = || results.first().copied().ok_or_else(|| invalid(format!("{inst} has no result")));
        match &function.insts[inst] {
            InstData::Const { .. } => {}
            InstData::Unary { op, arg } => {
                let arg = self.value(*arg)?;
                let value = unary(&mut self.b, *op, arg, self.target.native_rounding);
                self.define(only()?, value);
            }
            InstData::Binary { op, args } => self.binary(*op, *args, only()?)?,
            InstData::IntCompare { cc, args } => self.int_compare(*cc, *args, only()?)?,
            InstData::FloatCompare { cc, args } => {
                let [x, y] = [self.value(args[0])?, self.value(args[1])?];
                // Cranelift makes `maxss` of a selection by "less" only.
                let (cc, x, y) = match cc {
                    FloatCc::Gt => (FloatCc::Lt, y, x),
                    FloatCc::Ge => (FloatCc::Le, y, x),
                    cc => (*cc, x, y),
                };
                let value = self.b.ins().fcmp(float_cc(cc), x, y);
                self.define(only()?, value);
            }
            InstData::Convert { op, arg } => self.convert(*op, *arg, only()?)?,
            InstData::Select { cond, if_true, if_false } if self.is_all_ones_if_invalid(*cond, *if_true, *if_false) => {
                let float = self.value(*if_false)?;
                let value = floats::all_ones_if_invalid(&mut self.b, float);
                self.define(only()?, value);
            }
            InstData::Select { cond, if_true, if_false } => {
                let (cond, result) = (self.condition(*cond)?, only()?);
                match self.swapped_operands([*if_true, *if_false], result) {
                    Some([x, y]) => self.slots[result.index()] = Slot::Swapped(self.b.ins().select(cond, x, y)),
                    None => {
                        let [x, y] = [self.value(*if_true)?, self.value(*if_false)?];
                        let value = self.b.ins().select(cond, x, y);
                        self.define(result, value);
                    }
                }
            }
            InstData::Load { addr } => {
                let (addr, result) = (self.address(*addr)?, only()?);
                let ty = function.ty(result);
                if !self.numbers.is_number(function, result)
                    && let Some(raw) = self.memory.load_swapped(&mut self.b, ty, addr)?
                {
                    self.slots[result.index()] = Slot::Swapped(raw);
                } else if self.extended.contains_key(&result) {
                    let wide = self.memory.load_extended(&mut self.b, addr)?;
                    self.extended.insert(result, Some(wide));
                    let value = self.b.ins().ireduce(types::I8, wide);
                    self.define(result, value);
                } else {
                    let value = self.memory.load(&mut self.b, ty, addr)?;
                    self.define(result, value);
                }
            }
            InstData::Store { addr, value } => {
                let addr = self.address(*addr)?;
                let ty = function.ty(*value);
                match function.constant(*value) {
                    Some(bits) => self.memory.store_constant(&mut self.b, addr, ty, bits)?,
                    None => match self.swapped([*value]) {
                        Some([raw]) => self.memory.store_swapped(&mut self.b, addr, raw)?,
                        None => {
                            let value = self.value(*value)?;
                            self.memory.store(&mut self.b, addr, ty, value)?;
                        }
                    },
                }
            }
            InstData::LoadBit { addr, bit } => {
                let addr = self.address(*addr)?;
                let value = self.memory.load_bit(&mut self.b, addr, *bit)?;
                self.define_bit(only()?, value);
            }
            InstData::StoreBit { addr, bit, value } => {
                let addr = self.address(*addr)?;
                let value = match function.constant(*value) {
                    Some(bits) => BitValue::Constant(bits != 0),
                    None => BitValue::Variable(self.bit(*value)?),
                };
                self.memory.store_bit(&mut self.b, addr, *bit, value)?;
            }
            InstData::AddressOf { addr } => {
                let addr = self.address(*addr)?;
                let value = self.memory.address_of(&mut self.b, addr)?;
                self.define(only()?, value);
            }
            InstData::Clear { addr, len } => {
                let addr = self.address(*addr)?;
                self.memory.clear(&mut self.b, self.target.isa.frontend_config(), addr, *len)?;
            }
            InstData::Copy { to, from, len } => {
                let [to, from] = [self.address(*to)?, self.address(*from)?];
                self.memory.copy(&mut self.b, self.target.isa.frontend_config(), to, from, *len)?;
            }
            InstData::DbBase { number } => self.db_table(*number, 0, only()?)?,
            InstData::DbLength { number } => self.db_table(*number, 4, only()?)?,
            InstData::Call { callee, args } => self.call(*callee, args, results)?,
            InstData::CallRuntime { function, args } => self.call_runtime(*function, args, results)?,
            InstData::FrameBase { callee } => {
                let frame = self.memory.frame.expect("a function that asks for its frame is given it");
                let offset = self.memory.offset_of(&mut self.b, frame);
                let offset =
                    if *callee { self.b.ins().iadd_imm_s(offset, i64::from(function.frame_bytes)) } else { offset };
                self.define(only()?, offset);
            }
            InstData::Jump { target } => {
                let (block, args) = self.block_call(target)?;
                self.b.ins().jump(block, &args);
            }
            InstData::Branch { cond, then_to, else_to } => {
                let cond = self.condition(*cond)?;
                let (then_block, then_args) = self.block_call(then_to)?;
                let (else_block, else_args) = self.block_call(else_to)?;
                self.b.ins().brif(cond, then_block, &then_args, else_block, &else_args);
            }
            InstData::Switch { value, targets, default } => self.switch(*value, targets, default)?,
            InstData::Return { values } => self.return_values(values)?,
        }
        Ok(())
    }

    fn db_table(&mut self, number: Value, field: u32, result: Value) -> Result<(), CodegenError> {
        let value = match self.function.constant(number).and_then(|bits| u16::try_from(bits).ok()) {
            Some(number) => self.memory.db_table_at(&mut self.b, number, field),
            None => {
                let number = self.value(number)?;
                self.memory.db_table(&mut self.b, number, field)
            }
        };
        self.define(result, value);
        Ok(())
    }

    // Jumps.

    fn block_call(&mut self, call: &BlockCall) -> Result<(ir::Block, Vec<BlockArg>), CodegenError> {
        let expected = self.function.blocks[call.block].params.len();
        if call.args.len() != expected {
            return Err(invalid(format!("a jump to {} does not bring {expected} values", call.block)));
        }
        let args = self.values(&call.args)?.into_iter().map(BlockArg::Value).collect();
        let made = self.make_block(call.block);
        Ok((self.joins.entrance(&mut self.b, call.block, made), args))
    }

    fn switch(&mut self, value: Value, targets: &[BlockCall], default: &BlockCall) -> Result<(), CodegenError> {
        let value = self.value(value)?;
        if targets.len() <= COMPARED_TARGETS_MAX {
            for (index, target) in targets.iter().enumerate() {
                let (block, args) = self.block_call(target)?;
                let hit = self.b.ins().icmp_imm_u(IntCC::Equal, value, index as i64);
                let next = self.b.create_block();
                self.b.ins().brif(hit, block, &args, next, &[]);
                self.b.switch_to_block(next);
            }
            let (block, args) = self.block_call(default)?;
            self.b.ins().jump(block, &args);
            return Ok(());
        }
        let mut calls = Vec::with_capacity(targets.len());
        for target in targets.iter().chain([default]) {
            let (block, args) = self.block_call(target)?;
            calls.push(self.b.func.dfg.block_call(block, &args));
        }
        let default = calls.pop().expect("the default was added");
        let table = self.b.create_jump_table(JumpTableData::new(default, &calls));
        self.b.ins().br_table(value, table);
        Ok(())
    }
}

/// The reachable blocks, each before those that it dominates.
fn reverse_postorder(function: &Function) -> Vec<Block> {
    let mut order = Vec::with_capacity(function.layout.len());
    let mut seen = vec![false; function.blocks.len()];
    seen[function.entry().index()] = true;
    // A block with its successors that are still to be visited.
    let mut open = vec![(function.entry(), function.successors(function.entry()))];
    while let Some((block, successors)) = open.last_mut() {
        match successors.pop() {
            Some(next) if seen[next.index()] => {}
            Some(next) => {
                seen[next.index()] = true;
                open.push((next, function.successors(next)));
            }
            None => {
                order.push(*block);
                open.pop();
            }
        }
    }
    order.reverse();
    order
}

fn invalid(message: String) -> CodegenError {
    CodegenError::Module { function: String::new(), message }
}
