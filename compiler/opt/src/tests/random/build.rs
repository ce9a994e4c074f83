//! Functions of the IR, built from what was generated.

use plcc_ir::entities::Entity;
use plcc_ir::{
    Address, BinaryOp, Block, ConvertOp, FloatCc, FuncId, Function, FunctionBuilder, IntCc, Region, RuntimeFn, Type,
    Value, Var,
};

use super::generate::{End, Place, RandomBlock, Statement};
use super::{BITS, FUNCTIONS, WORDS};

const FRAME: u32 = 32;
const STEPS_MAX: i64 = 12;

const REGIONS: [Region; 7] = [Region::I, Region::Q, Region::M, Region::L, Region::Db(1), Region::Db(2), Region::V];
const TYPES: [Type; 4] = [Type::I8, Type::I16, Type::I32, Type::F32];
const OPS: [BinaryOp; 10] = [
    BinaryOp::Iadd,
    BinaryOp::Isub,
    BinaryOp::Imul,
    BinaryOp::And,
    BinaryOp::Or,
    BinaryOp::Xor,
    BinaryOp::Shl,
    BinaryOp::Lshr,
    BinaryOp::Ashr,
    BinaryOp::Rotl,
];

/// Types that every function takes: a pointer, a word and a bit; it returns two words and a bit.
const PARAMS: [Type; 3] = [Type::I32, Type::I32, Type::I1];
const RETURNS: [Type; 3] = [Type::I32, Type::I32, Type::I1];

/// To how few places the addresses of a program are brought together, so that they meet.
#[derive(Clone, Debug)]
pub(super) struct Focus {
    pub regions: Vec<u8>,
    pub offsets: u32,
}

struct Builder<'a> {
    b: FunctionBuilder,
    index: usize,
    focus: &'a Focus,
    words: Vec<Var>,
    bits: Vec<Var>,
    pointer: Var,
    db: Var,
}

impl Builder<'_> {
    fn address(&mut self, place: &Place) -> Address {
        // The first function has no caller whose frame it could reach.
        let regions = &self.focus.regions;
        let region = |region: u8| match REGIONS[regions[region as usize % regions.len()] as usize] {
            Region::V if self.index == 0 => Region::M,
            region => region,
        };
        let offsets = self.focus.offsets;
        match *place {
            Place::Direct(r, offset) => Address::direct(region(r), offset % offsets),
            Place::Indexed(r, word, offset) => {
                let region = region(r);
                let word = self.b.use_var(self.words[word]);
                let base = self.b.binary_imm(BinaryOp::And, word, 7);
                Address::indexed(region, base, offset % offsets)
            }
            Place::Db(offset, any) => {
                let base = self.b.use_var(self.db);
                Address::indexed(if any { Region::Any } else { Region::AnyDb }, base, offset % offsets)
            }
            Place::Pointer(offset) => Address::indexed(Region::Any, self.b.use_var(self.pointer), offset % offsets),
        }
    }

    fn word(&mut self, index: usize) -> Value {
        self.b.use_var(self.words[index])
    }

    fn bit(&mut self, index: usize) -> Value {
        self.b.use_var(self.bits[index])
    }

    fn set_word(&mut self, index: usize, value: Value) {
        self.b.def_var(self.words[index], value);
    }

    fn set_bit(&mut self, index: usize, value: Value) {
        self.b.def_var(self.bits[index], value);
    }

    fn as_type(&mut self, ty: Type, word: Value) -> Value {
        match ty {
            Type::F32 => self.b.bitcast(ty, word),
            _ => self.b.trunc(ty, word),
        }
    }

    fn as_word(&mut self, value: Value) -> Value {
        match self.b.ty(value) {
            Type::F32 => self.b.bitcast(Type::I32, value),
            _ => self.b.zext(Type::I32, value),
        }
    }

    fn statement(&mut self, statement: &Statement) {
        match statement {
            Statement::Const(to, value) => {
                let value = self.b.i32_const(*value);
                self.set_word(*to, value);
            }
            Statement::Binary(op, to, x, y) => {
                let (x, y) = (self.word(*x), self.word(*y));
                let value = self.b.binary(OPS[*op], x, y);
                self.set_word(*to, value);
            }
            Statement::Compare(cc, to, x, y) => {
                let (x, y) = (self.word(*x), self.word(*y));
                let value = self.b.icmp(IntCc::ALL[*cc], x, y);
                self.set_bit(*to, value);
            }
            Statement::CompareFloat(cc, to, x, y) => {
                let (x, y) = (self.word(*x), self.word(*y));
                let (x, y) = (self.b.bitcast(Type::F32, x), self.b.bitcast(Type::F32, y));
                let value = self.b.fcmp(FloatCc::ALL[*cc], x, y);
                self.set_bit(*to, value);
            }
            Statement::CompareConst(cc, to, x, value) => {
                let x = self.word(*x);
                let value = self.b.icmp_imm(IntCc::ALL[*cc], x, i64::from(*value));
                self.set_bit(*to, value);
            }
            Statement::Bool(op, to, x, y) => {
                let (x, y) = (self.bit(*x), self.bit(*y));
                let value = self.b.binary([BinaryOp::And, BinaryOp::Or, BinaryOp::Xor][*op], x, y);
                self.set_bit(*to, value);
            }
            Statement::Not(to, from) => {
                let from = self.bit(*from);
                let value = self.b.not(from);
                self.set_bit(*to, value);
            }
            Statement::Select(to, cond, x, y) => {
                let (cond, x, y) = (self.bit(*cond), self.word(*x), self.word(*y));
                let value = self.b.select(cond, x, y);
                self.set_word(*to, value);
            }
            Statement::LowWord(to, from) => {
                let (high, low) = (self.word(*to), self.word(*from));
                let low = self.b.trunc(Type::I16, low);
                let low = self.b.zext(Type::I32, low);
                let high = self.b.binary_imm(BinaryOp::And, high, 0xFFFF_0000);
                let value = self.b.or(high, low);
                self.set_word(*to, value);
            }
            Statement::Sign(to, from) => {
                let from = self.word(*from);
                let low = self.b.trunc(Type::I16, from);
                let value = self.b.sext(Type::I32, low);
                self.set_word(*to, value);
            }
            Statement::BitToWord(to, from) => {
                let from = self.bit(*from);
                let value = self.b.convert(ConvertOp::Zext, Type::I32, from);
                self.set_word(*to, value);
            }
            Statement::Load(to, place, ty) => {
                let addr = self.address(place);
                let value = self.b.load(TYPES[*ty], addr);
                let value = self.as_word(value);
                // The old value is included, so every load has an effect on the result.
                let old = self.word(*to);
                let old = self.b.binary_imm(BinaryOp::Rotl, old, 5);
                let value = self.b.xor(old, value);
                self.set_word(*to, value);
            }
            Statement::Store(place, from, ty) => {
                let addr = self.address(place);
                let word = self.word(*from);
                let value = self.as_type(TYPES[*ty], word);
                self.b.store(addr, value);
            }
            Statement::LoadBit(to, place, bit) => {
                let addr = self.address(place);
                let value = self.b.load_bit(addr, *bit);
                let old = self.bit(*to);
                let value = self.b.xor(old, value);
                self.set_bit(*to, value);
            }
            Statement::StoreBit(place, bit, from) => {
                let addr = self.address(place);
                let value = self.bit(*from);
                self.b.store_bit(addr, *bit, value);
            }
            Statement::Clear(place, len) => {
                let addr = self.address(place);
                self.b.clear(addr, *len);
            }
            Statement::Copy(to, from, len) => {
                let (to, from) = (self.address(to), self.address(from));
                self.b.copy(to, from, *len);
            }
            Statement::OpenDb(by) => {
                let (one, two) = (self.b.i32_const(1), self.b.i32_const(2));
                let number = match by {
                    Some(bit) => {
                        let bit = self.bit(*bit);
                        self.b.select(bit, one, two)
                    }
                    None => two,
                };
                let base = self.b.db_base(number);
                self.b.def_var(self.db, base);
            }
            Statement::DbLength(to, number) => {
                let number = self.b.i32_const(*number);
                let value = self.b.db_length(number);
                self.set_word(*to, value);
            }
            Statement::Point(region, offset) => {
                let addr = self.address(&Place::Direct(*region, *offset));
                let value = self.b.address_of(addr);
                self.b.def_var(self.pointer, value);
            }
            Statement::Call(callee, to, from, bit) => {
                // Only functions after this one, so that there is no recursion.
                if self.index + 1 + callee >= FUNCTIONS {
                    return;
                }
                let pointer = self.b.use_var(self.pointer);
                let (word, arg) = (self.word(*from), self.bit(*bit));
                let callee = FuncId::new(self.index + 1 + callee);
                let results = self.b.call(callee, vec![pointer, word, arg], &RETURNS);
                self.set_word(*to, results[0]);
                self.set_word(*from, results[1]);
                self.set_bit(*bit, results[2]);
            }
            Statement::Timer(to, from) => {
                let from = self.word(*from);
                // As with timers: cells, which the runtime sees, and brings up to date.
                self.b.store(Address::direct(Region::Cells, 4), from);
                self.b.call_runtime(RuntimeFn::TimerSettle, &[from]);
                let value = self.b.load(Type::I32, Address::direct(Region::Cells, 4));
                self.set_word(*to, value);
                self.b.store(Address::direct(Region::Cells, 8), value);
                let part = self.b.load(Type::I16, Address::direct(Region::Cells, 8));
                let part = self.b.zext(Type::I32, part);
                self.b.store(Address::direct(Region::Cells, 8), part);
            }
            Statement::Peripheral(from) => {
                let from = self.word(*from);
                self.b.call_runtime(RuntimeFn::PeripheralWrite, &[from, from, from]);
            }
            Statement::Safepoint(to) => {
                let site = self.b.i32_const(0);
                let value = self.b.call_runtime(RuntimeFn::Safepoint, &[site]).expect("it has a result");
                self.set_word(*to, value);
            }
            Statement::Sine(to, from) => {
                let from = self.word(*from);
                let from = self.b.bitcast(Type::F32, from);
                let value = self.b.call_pure(RuntimeFn::Sin, &[from]);
                let value = self.b.bitcast(Type::I32, value);
                self.set_word(*to, value);
            }
        }
    }

    fn ret(&mut self) {
        let word = self.word(1);
        let shifted = self.b.binary_imm(BinaryOp::Rotl, word, 9);
        let (word, bits) = (self.word(2), [self.bit(0), self.bit(1), self.bit(2)]);
        let second = self.b.xor(shifted, word);
        let bit = self.b.xor(bits[0], bits[1]);
        let bit = self.b.xor(bit, bits[2]);
        let first = self.word(0);
        self.b.ret(&[first, second, bit]);
    }
}

pub(super) fn build(index: usize, program: &[RandomBlock], focus: &Focus) -> Function {
    let mut b = FunctionBuilder::new(format!("F{index}"), &PARAMS, &RETURNS);
    b.set_frame_bytes(FRAME);
    let words: Vec<Var> = (0..WORDS).map(|_| b.declare_var(Type::I32)).collect();
    let bits: Vec<Var> = (0..BITS).map(|_| b.declare_var(Type::I1)).collect();
    let (pointer, db, steps) = (b.declare_var(Type::I32), b.declare_var(Type::I32), b.declare_var(Type::I32));
    b.clear(Address::direct(Region::L, 0), FRAME);
    let params = [b.param(0), b.param(1), b.param(2)];
    b.def_var(pointer, params[0]);
    b.def_var(words[0], params[1]);
    b.def_var(bits[0], params[2]);
    let one = b.i32_const(1);
    let base = b.db_base(one);
    b.def_var(db, base);
    let end = b.create_block();
    let mut blocks = vec![b.current_block().expect("the entry")];
    for block in &program[1..] {
        blocks.push(if block.cold { b.create_cold_block() } else { b.create_block() });
    }
    let mut builder = Builder { b, index, focus, words, bits, pointer, db };
    for (position, block) in program.iter().enumerate() {
        builder.b.switch_to(blocks[position]);
        let count = builder.b.use_var(steps);
        let count = builder.b.binary_imm(BinaryOp::Iadd, count, 1);
        builder.b.def_var(steps, count);
        for statement in &block.statements {
            builder.statement(statement);
        }
        let count = builder.b.use_var(steps);
        let go_on = builder.b.icmp_imm(IntCc::Ult, count, STEPS_MAX);
        let next = builder.b.create_block();
        builder.b.branch(go_on, next, end);
        builder.b.seal_block(next);
        builder.b.switch_to(next);
        match &block.end {
            End::Jump(target) => builder.b.jump(blocks[*target], &[]),
            End::Branch(bit, then_to, else_to) => {
                let bit = builder.bit(*bit);
                builder.b.branch(bit, blocks[*then_to], blocks[*else_to]);
            }
            End::Switch(word, targets, default) => {
                let word = builder.word(*word);
                let targets: Vec<Block> = targets.iter().map(|&target| blocks[target]).collect();
                builder.b.switch(word, &targets, blocks[*default]);
            }
            End::Return => builder.ret(),
        }
    }
    blocks.iter().for_each(|&block| builder.b.seal_block(block));
    builder.b.seal_block(end);
    builder.b.switch_to(end);
    builder.ret();
    builder.b.finish()
}
