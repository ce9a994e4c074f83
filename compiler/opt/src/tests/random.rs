//! Random modules mean the same before and after every pass: returned values, memory, and the memory that runtime functions see.
//!
//! Addresses fall into a few bytes of every region, directly, with a base, and through pointers that may point into the frame
//! of a caller, so that a wrong assumption about aliasing shows.

use std::cell::{Cell, RefCell};

use plcc_abi::functions::Effect;
use plcc_abi::layout;
use plcc_ir::entities::{Entity, EntityVec};
use plcc_ir::interpreter::{Host, Interpreter};
use plcc_ir::{
    Address, BinaryOp, Block, ConvertOp, FloatCc, FuncId, Function, FunctionBuilder, IntCc, Module, Region, RuntimeFn,
    StaticDb, Type, Value, Var,
};
use proptest::prelude::*;

use crate::Without;

const WORDS: usize = 3;
const BITS: usize = 3;
const FRAME: u32 = 32;
const STEPS_MAX: i64 = 12;
const FUNCTIONS: usize = 3;

/// How an address is made.
#[derive(Clone, Debug)]
enum Place {
    Direct(u8, u32),
    /// Base: the low three bits of a word.
    Indexed(u8, usize, u32),
    /// Base: the DB variable, as `anydb` or as `any`.
    Db(u32, bool),
    /// Base: the pointer variable.
    Pointer(u32),
}

#[derive(Clone, Debug)]
enum Statement {
    Const(usize, u32),
    Binary(usize, usize, usize, usize),
    Compare(usize, usize, usize, usize),
    CompareFloat(usize, usize, usize, usize),
    CompareConst(usize, usize, usize, u32),
    Bool(usize, usize, usize, usize),
    Not(usize, usize),
    Select(usize, usize, usize, usize),
    /// The low word of the one into the other, which keeps its high word.
    LowWord(usize, usize),
    Sign(usize, usize),
    BitToWord(usize, usize),
    Load(usize, Place, usize),
    Store(Place, usize, usize),
    LoadBit(usize, Place, u8),
    StoreBit(Place, u8, usize),
    Clear(Place, u32),
    Copy(Place, Place, u32),
    /// Sets the DB variable to the base of DB 1 or 2, by a constant or by a bit.
    OpenDb(Option<usize>),
    DbLength(usize, u32),
    Point(u8, u32),
    Call(usize, usize, usize, usize),
    Timer(usize, usize),
    Peripheral(usize),
    Safepoint(usize),
    Sine(usize, usize),
}

#[derive(Clone, Debug)]
enum End {
    Jump(usize),
    Branch(usize, usize, usize),
    Switch(usize, Vec<usize>, usize),
    Return,
}

#[derive(Clone, Debug)]
struct RandomBlock {
    statements: Vec<Statement>,
    end: End,
    cold: bool,
}

fn place() -> impl Strategy<Value = Place> {
    prop_oneof![
        6 => (0..7u8, 0..8u32).prop_map(|(region, offset)| Place::Direct(region, offset)),
        1 => (0..7u8, 0..WORDS, 0..4u32).prop_map(|(region, word, offset)| Place::Indexed(region, word, offset)),
        3 => (0..8u32, any::<bool>()).prop_map(|(offset, any)| Place::Db(offset, any)),
        2 => (0..4u32).prop_map(Place::Pointer),
    ]
}

fn statement() -> impl Strategy<Value = Statement> {
    let (w, b) = (0..WORDS, 0..BITS);
    let constant = prop_oneof![0..3u32, any::<u32>(), Just(0xFFFF), Just(0xFFFF_0000), Just(0x8000_0000)];
    let values = prop_oneof![
        (w.clone(), constant.clone()).prop_map(|(to, value)| Statement::Const(to, value)),
        (0..10usize, w.clone(), w.clone(), w.clone()).prop_map(|(op, to, a, b)| Statement::Binary(op, to, a, b)),
        (0..10usize, b.clone(), w.clone(), w.clone()).prop_map(|(cc, to, a, b)| Statement::Compare(cc, to, a, b)),
        (0..7usize, b.clone(), w.clone(), w.clone()).prop_map(|(cc, to, a, b)| Statement::CompareFloat(cc, to, a, b)),
        (0..10usize, b.clone(), w.clone(), constant).prop_map(|(cc, to, a, c)| Statement::CompareConst(cc, to, a, c)),
        (0..3usize, b.clone(), b.clone(), b.clone()).prop_map(|(op, to, x, y)| Statement::Bool(op, to, x, y)),
        (b.clone(), b.clone()).prop_map(|(to, from)| Statement::Not(to, from)),
        (w.clone(), b.clone(), w.clone(), w.clone()).prop_map(|(to, cond, x, y)| Statement::Select(to, cond, x, y)),
        (w.clone(), w.clone()).prop_map(|(to, from)| Statement::LowWord(to, from)),
        (w.clone(), w.clone()).prop_map(|(to, from)| Statement::Sign(to, from)),
        (w.clone(), b.clone()).prop_map(|(to, from)| Statement::BitToWord(to, from)),
        (w.clone(), w.clone()).prop_map(|(to, from)| Statement::Sine(to, from)),
    ];
    let memory = prop_oneof![
        4 => (w.clone(), place(), 0..4usize).prop_map(|(to, place, ty)| Statement::Load(to, place, ty)),
        4 => (place(), w.clone(), 0..4usize).prop_map(|(place, from, ty)| Statement::Store(place, from, ty)),
        5 => (b.clone(), place(), 0..2u8).prop_map(|(to, place, bit)| Statement::LoadBit(to, place, bit)),
        5 => (place(), 0..2u8, b.clone()).prop_map(|(place, bit, from)| Statement::StoreBit(place, bit, from)),
        1 => (place(), 0..8u32).prop_map(|(place, len)| Statement::Clear(place, len)),
        1 => (place(), place(), 0..8u32).prop_map(|(to, from, len)| Statement::Copy(to, from, len)),
    ];
    let others = prop_oneof![
        prop::option::of(b.clone()).prop_map(Statement::OpenDb),
        (w.clone(), 1..4u32).prop_map(|(to, number)| Statement::DbLength(to, number)),
        (0..7u8, 0..8u32).prop_map(|(region, offset)| Statement::Point(region, offset)),
        (0..FUNCTIONS, w.clone(), w.clone(), b).prop_map(|(f, to, from, bit)| Statement::Call(f, to, from, bit)),
        (w.clone(), w.clone()).prop_map(|(to, from)| Statement::Timer(to, from)),
        w.clone().prop_map(Statement::Peripheral),
        w.prop_map(Statement::Safepoint),
    ];
    prop_oneof![3 => values, 5 => memory, 2 => others]
}

fn random_block(blocks: usize) -> impl Strategy<Value = RandomBlock> {
    let end = prop_oneof![
        2 => (1..blocks).prop_map(End::Jump),
        4 => (0..BITS, 1..blocks, 1..blocks).prop_map(|(bit, a, b)| End::Branch(bit, a, b)),
        1 => (0..WORDS, prop::collection::vec(1..blocks, 0..3), 1..blocks)
            .prop_map(|(word, targets, default)| End::Switch(word, targets, default)),
        1 => Just(End::Return),
    ];
    (prop::collection::vec(statement(), 0..14), end, prop::bool::weighted(0.15))
        .prop_map(|(statements, end, cold)| RandomBlock { statements, end, cold })
}

fn random_function() -> impl Strategy<Value = Vec<RandomBlock>> {
    (2..6usize).prop_flat_map(|blocks| prop::collection::vec(random_block(blocks), blocks))
}

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
struct Focus {
    regions: Vec<u8>,
    offsets: u32,
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

fn build(index: usize, program: &[RandomBlock], focus: &Focus) -> Function {
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

/// A few bytes of each area, and a log of the memory that runtime functions saw.
struct Memory {
    bytes: RefCell<Vec<u8>>,
    log: RefCell<Vec<u64>>,
    count: Cell<u64>,
    /// Nothing runs at safepoints.
    alone: bool,
}

const WINDOWS: [(u32, u32); 8] = [
    (layout::STATE, 0x200),
    (layout::I, 64),
    (layout::Q, 64),
    (layout::M, 64),
    (layout::T, 16),
    (layout::L, 256),
    (layout::DB_TABLE, 64),
    (layout::DB_DATA, 128),
];
const L_WINDOW: usize = 5;

impl Memory {
    fn new(seed: u8, alone: bool) -> Memory {
        let total: u32 = WINDOWS.iter().map(|window| window.1).sum();
        let bytes = (0..total).map(|index| (index as u8).wrapping_mul(37) ^ seed).collect();
        let memory = Memory { bytes: RefCell::new(bytes), log: RefCell::default(), count: Cell::new(0), alone };
        for db in dbs() {
            memory.write(layout::db_table_entry(db.number), &db.address.to_ne_bytes());
            memory.write(layout::db_table_entry(db.number) + 4, &db.length.to_ne_bytes());
        }
        memory
    }

    fn index(offset: u32) -> usize {
        let mut start = 0;
        for (address, len) in WINDOWS {
            if (address..address + len).contains(&offset) {
                return (start + offset - address) as usize;
            }
            start += len;
        }
        panic!("{offset:#x} is outside of the memory of the test");
    }

    /// The memory that an observer may see: everything except local data.
    fn observed(&self) -> Vec<u8> {
        let l_start: u32 = WINDOWS[..L_WINDOW].iter().map(|window| window.1).sum();
        let mut bytes = self.bytes.borrow().clone();
        bytes.drain(l_start as usize..(l_start + WINDOWS[L_WINDOW].1) as usize);
        bytes
    }

    fn note(&self, value: u64) {
        self.log.borrow_mut().push(value);
    }
}

impl Host for Memory {
    fn read(&self, offset: u32, buf: &mut [u8]) {
        if !buf.is_empty() {
            let index = Memory::index(offset);
            buf.copy_from_slice(&self.bytes.borrow()[index..index + buf.len()]);
        }
    }

    fn write(&self, offset: u32, bytes: &[u8]) {
        // Only optimised code tells the runtime which outputs it writes.
        let is_note = offset == layout::STATE + layout::state::OUTPUTS_WRITTEN;
        if !bytes.is_empty() && !is_note {
            let index = Memory::index(offset);
            self.bytes.borrow_mut()[index..index + bytes.len()].copy_from_slice(bytes);
        }
    }

    fn call_runtime(&self, function: RuntimeFn, args: &[u64]) -> u64 {
        if function.effect() == Effect::Pure {
            return args.iter().fold(17, |hash: u64, arg| hash.wrapping_mul(31) ^ arg);
        }
        self.note(args.iter().fold(function as u64, |hash, arg| hash.wrapping_mul(0x1_0001) ^ arg));
        self.count.set(self.count.get() + 1);
        let count = self.count.get();
        match function.effect() {
            Effect::Pure => {}
            Effect::Cells => {
                let mut cells = [0; 16];
                self.read(layout::T, &mut cells);
                self.note(cells.iter().fold(0, |hash, &byte| hash << 3 ^ u64::from(byte)));
                self.write(layout::T + (count % 12) as u32, &[count as u8]);
            }
            Effect::System => self.write(layout::SYSTEM + (count % 12) as u32, &[(count * 57) as u8]),
            Effect::Io => {
                let mut outputs = [0; 16];
                self.read(layout::Q, &mut outputs);
                self.note(outputs.iter().fold(0, |hash, &byte| hash << 3 ^ u64::from(byte)));
                self.write(layout::Q + (count % 8) as u32, &[count as u8]);
            }
            Effect::Reads => {
                let hash = self.observed().iter().fold(0u64, |hash, &byte| hash.wrapping_mul(31) ^ u64::from(byte));
                self.note(hash);
            }
            Effect::All => {
                let hash = self.observed().iter().fold(0u64, |hash, &byte| hash.wrapping_mul(31) ^ u64::from(byte));
                self.note(hash);
                let data = if self.alone && function == RuntimeFn::Safepoint { 0 } else { 5 };
                for area in
                    [layout::I, layout::Q, layout::M, layout::DB_DATA, layout::DB_DATA + 32].into_iter().take(data)
                {
                    self.write(area + (count % 12) as u32, &[(count * 91) as u8]);
                }
            }
        }
        count.wrapping_mul(0x9E37_79B9) & 0xFFFF_FFFF
    }
}

fn dbs() -> Vec<StaticDb> {
    let db = |number, address| StaticDb { number, address, length: 32, read_only: false };
    vec![db(1, layout::DB_DATA), db(2, layout::DB_DATA + 32)]
}

/// Returned values, memory and log.
type Outcome = (Vec<u64>, Vec<u8>, Vec<u64>);

fn run(module: &Module, seed: u8, word: u32, bit: bool) -> Outcome {
    let memory = Memory::new(seed, !module.entries.is_empty());
    let args = [u64::from(layout::M + 4), u64::from(word), u64::from(bit)];
    let returned = Interpreter::new(module).call(&memory, FuncId::new(0), &args, layout::L, layout::L + 128);
    let observed = memory.observed();
    (returned, observed, memory.log.into_inner())
}

/// The module of random functions: a program of OB 1 alone, or one of which not all is known.
fn random_module(programs: &[Vec<RandomBlock>], focus: &Focus, alone: bool) -> Module {
    let mut functions = EntityVec::new();
    for (index, program) in programs.iter().enumerate() {
        functions.push(build(index, program, focus));
    }
    let mut entries = Vec::new();
    if alone {
        let mut b = FunctionBuilder::new("OB1", &[], &[]);
        b.ret(&[]);
        entries.push(functions.push(b.finish()));
    }
    let module = Module { functions, entries, dbs: dbs(), ..Module::default() };
    crate::check("building", &module);
    module
}

/// `PLCC_PASSES=all` leaves out each pass in each case.
fn left_out(index: usize) -> Vec<Without> {
    let each = Without::each();
    match std::env::var_os("PLCC_PASSES").is_some_and(|value| value == "all") {
        true => each,
        false => vec![each[index % each.len()]],
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, max_shrink_iters: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_pass_relies_on_another_one(
        programs in prop::collection::vec(random_function(), FUNCTIONS),
        (regions, offsets) in (prop::collection::vec(0..7u8, 1..4), 1..9u32),
        (seed, word, bit, alone) in (any::<u8>(), any::<u32>(), any::<bool>(), any::<bool>()),
        index in any::<usize>(),
    ) {
        let module = random_module(&programs, &Focus { regions, offsets }, alone);
        let expected = run(&module, seed, word, bit);
        for without in left_out(index) {
            let mut optimised = module.clone();
            crate::optimize_with(&mut optimised, without, &mut |name, module| crate::check(&format!("{name}, {without}"), module));
            let text = || plcc_ir::print::module_text(&module);
            prop_assert!(run(&optimised, seed, word, bit) == expected, "{} is wrong for\n{}", without, text());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, max_shrink_iters: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn optimisation_keeps_the_meaning(
        programs in prop::collection::vec(random_function(), FUNCTIONS),
        (regions, offsets) in (prop::collection::vec(0..7u8, 1..4), 1..9u32),
        (seed, word, bit, alone) in (any::<u8>(), any::<u32>(), any::<bool>(), any::<bool>()),
    ) {
        let mut module = random_module(&programs, &Focus { regions, offsets }, alone);
        let expected = run(&module, seed, word, bit);
        let mut last = module.clone();
        let mut wrong = None;
        crate::optimize_with(&mut module, Without::NOTHING, &mut |name, module| {
            // Most passes find nothing to do.
            if wrong.is_some() || *module == last {
                return;
            }
            crate::check(name, module);
            if run(module, seed, word, bit) != expected {
                let text = plcc_ir::print::module_text;
                wrong = Some(format!("{name} made of\n{}\n{}", text(&last), text(module)));
            }
            last.clone_from(module);
        });
        prop_assert!(wrong.is_none(), "{}", wrong.unwrap_or_default());
        let again = plcc_ir::parse::parse_module(&plcc_ir::print::module_text(&module));
        prop_assert_eq!(again, Ok(module));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, max_shrink_iters: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_pass_says_when_it_has_changed_something(
        programs in prop::collection::vec(random_function(), FUNCTIONS),
        (regions, offsets) in (prop::collection::vec(0..7u8, 1..4), 1..9u32),
        alone in any::<bool>(),
    ) {
        let mut module = random_module(&programs, &Focus { regions, offsets }, alone);
        for name in crate::pipeline().map(|pass| pass.name) {
            let done = crate::run_pass(&mut module, name);
            prop_assert!(done.is_ok(), "{}", done.unwrap_err());
        }
    }
}
