//! One method for each instruction. Operations on constants fold as they are built.

use plcc_abi::functions::Effect;
use plcc_abi::{RuntimeFn, Type};

use super::FunctionBuilder;
use crate::entities::{Block, FuncId, Inst, Value};
use crate::eval;
use crate::instructions::{Address, BinaryOp, BlockCall, ConvertOp, FloatCc, InstData, IntCc, Region, UnaryOp};

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
        let inst = self.push(InstData::Call { callee, args: args.into() }, returns);
        self.function.results[inst].to_vec()
    }

    /// Calls a runtime function; its result, if it has one.
    pub fn call_runtime(&mut self, function: RuntimeFn, args: &[Value]) -> Option<Value> {
        assert_eq!(function.params().len(), args.len(), "arguments of {}", function.name());
        let inst = self.push(InstData::CallRuntime { function, args: args.into() }, function.result().as_slice());
        self.function.results[inst].first().copied()
    }

    /// Calls a pure runtime function.
    pub fn call_pure(&mut self, function: RuntimeFn, args: &[Value]) -> Value {
        assert_eq!(function.effect(), Effect::Pure);
        self.call_runtime(function, args).expect("pure functions have a result")
    }

    // Terminators.

    pub fn jump(&mut self, block: Block, args: &[Value]) {
        self.terminate(InstData::Jump { target: BlockCall { block, args: args.into() } });
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
        self.terminate(InstData::Return { values: values.into() });
    }
}
