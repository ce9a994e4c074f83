//! Random programs: machine code against the interpreter of the IR.

use std::cell::RefCell;

use plcc_abi::{RuntimeFn, Type, layout};
use plcc_ir::interpreter::{Host, Interpreter};
use plcc_ir::{
    Address, BinaryOp, ConvertOp, FloatCc, FuncId, Function, FunctionBuilder, IntCc, Module, Region, UnaryOp, Value,
    Var,
};

use crate::harness::{self, DB, LBASE, LEVELS, VBASE, func};

/// A small generator of random numbers (xorshift).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    fn below(&mut self, end: u32) -> u32 {
        ((self.next() >> 32) % u64::from(end)) as u32
    }

    fn chance(&mut self, one_in: u32) -> bool {
        self.below(one_in) == 0
    }

    fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.below(items.len() as u32) as usize]
    }
}

const TYPES: [Type; 6] = [Type::I1, Type::I8, Type::I16, Type::I32, Type::I64, Type::F32];
const INT_OPS: [BinaryOp; 15] = [
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
    BinaryOp::Rotr,
    BinaryOp::Sdiv,
    BinaryOp::Srem,
    BinaryOp::Udiv,
    BinaryOp::Urem,
];
const BIT_OPS: [BinaryOp; 3] = [BinaryOp::And, BinaryOp::Or, BinaryOp::Xor];
const FLOAT_OPS: [BinaryOp; 4] = [BinaryOp::Fadd, BinaryOp::Fsub, BinaryOp::Fmul, BinaryOp::Fdiv];

/// Signature of a function that is already built.
struct Known {
    params: Vec<Type>,
    returns: Vec<Type>,
}

struct Generator<'r> {
    random: &'r mut Random,
    b: FunctionBuilder,
    /// Three variables of each type, in the order of `TYPES`.
    vars: Vec<Var>,
    known: &'r [Known],
    /// Accesses through pointers are among the statements.
    pointers: bool,
    depth: u32,
}

impl Generator<'_> {
    fn var(&mut self, ty: Type) -> Var {
        let index = TYPES.iter().position(|&other| other == ty).expect("one of the types");
        self.vars[3 * index + self.random.below(3) as usize]
    }

    fn get(&mut self, ty: Type) -> Value {
        if self.random.chance(5) && ty != Type::F32 {
            let bits = [0, 1, 0xFF, 0x8000, 0x1234_5678, u64::MAX, self.random.next()];
            let bits = self.random.pick(&bits);
            return self.b.iconst(ty, bits as i64);
        }
        let var = self.var(ty);
        self.b.use_var(var)
    }

    fn set(&mut self, value: Value) {
        let var = self.var(self.b.ty(value));
        self.b.def_var(var, value);
    }

    /// An address with room for `bytes` after it.
    fn address(&mut self, bytes: u32) -> Address {
        let regions = [Region::I, Region::Q, Region::M, Region::L, Region::V, Region::Db(DB.number), Region::State];
        let mut region = self.random.pick(&regions);
        // The slots after the registers are free.
        let start = if region == Region::State { 0x800 } else { 0 };
        let offset = start + self.random.below(20);
        if self.random.chance(3) {
            let index = self.get(Type::I32);
            let base = self.b.binary_imm(BinaryOp::And, index, 7);
            return Address::indexed(region, base, offset);
        }
        if self.pointers && self.random.chance(2) {
            if region == Region::State {
                region = Region::M;
            }
            let is_db = matches!(region, Region::Db(_));
            let base = self.b.address_of(Address::direct(region, self.random.below(20)));
            let through = if is_db && self.random.chance(2) { Region::AnyDb } else { Region::Any };
            return Address::indexed(through, base, self.random.below(20));
        }
        debug_assert!(bytes <= 100);
        Address::direct(region, offset)
    }

    fn statement(&mut self) {
        match self.random.below(if self.depth < 4 { 22 } else { 19 }) {
            0 | 1 => {
                let ty = self.random.pick(&TYPES[..5]);
                let op = self.random.pick(if ty == Type::I1 { &BIT_OPS[..] } else { &INT_OPS[..] });
                let (x, mut y) = (self.get(ty), self.get(ty));
                if matches!(op, BinaryOp::Sdiv | BinaryOp::Srem | BinaryOp::Udiv | BinaryOp::Urem) {
                    y = self.b.binary_imm(BinaryOp::And, y, 0x3F);
                    y = self.b.binary_imm(BinaryOp::Or, y, 1);
                }
                let value = self.b.binary(op, x, y);
                self.set(value);
            }
            2 => {
                let op = self.random.pick(&FLOAT_OPS);
                let (x, y) = (self.get(Type::F32), self.get(Type::F32));
                let value = self.b.binary(op, x, y);
                self.set_float(value);
            }
            3 => {
                let op = self.random.pick(UnaryOp::ALL);
                if matches!(op, UnaryOp::Bswap | UnaryOp::Ctz) {
                    let types = [Type::I16, Type::I32, Type::I64];
                    let ty = self.random.pick(if op == UnaryOp::Bswap { &types } else { &types[1..] });
                    let x = self.get(ty);
                    let value = self.b.unary(op, x);
                    return self.set(value);
                }
                let x = self.get(Type::F32);
                let value = self.b.unary(op, x);
                self.set_float(value);
            }
            4 => {
                let ty = self.random.pick(&TYPES[..5]);
                let (x, y) = (self.get(ty), self.get(ty));
                let cc = self.random.pick(if ty == Type::I1 { &[IntCc::Eq, IntCc::Ne] } else { IntCc::ALL });
                let value = self.b.icmp(cc, x, y);
                self.set(value);
            }
            5 => {
                let (x, y) = (self.get(Type::F32), self.get(Type::F32));
                let cc = self.random.pick(FloatCc::ALL);
                let value = self.b.fcmp(cc, x, y);
                self.set(value);
            }
            6 | 7 => {
                let (from, to) = (self.random.pick(&TYPES[..5]), self.random.pick(&TYPES[..5]));
                let op = match from.bits().cmp(&to.bits()) {
                    std::cmp::Ordering::Less => self.random.pick(&[ConvertOp::Zext, ConvertOp::Sext]),
                    std::cmp::Ordering::Equal => return,
                    std::cmp::Ordering::Greater => ConvertOp::Trunc,
                };
                let x = self.get(from);
                let value = self.b.convert(op, to, x);
                self.set(value);
            }
            8 => {
                let x = self.get(Type::F32);
                let value = self.b.convert(ConvertOp::ToSint, Type::I32, x);
                self.set(value);
                let x = self.get(Type::I32);
                let value = self.b.convert(ConvertOp::FromSint, Type::F32, x);
                self.set(value);
            }
            9 => {
                let ty = self.random.pick(&TYPES);
                let (cond, x, y) = (self.get(Type::I1), self.get(ty), self.get(ty));
                let value = self.b.select(cond, x, y);
                self.set(value);
            }
            10 | 11 => {
                let ty = self.random.pick(&TYPES[1..5]);
                let addr = self.address(8);
                let value = self.b.load(ty, addr);
                self.set(value);
            }
            12 | 13 => {
                let ty = self.random.pick(&TYPES[1..]);
                let addr = self.address(8);
                let value = self.get(ty);
                self.b.store(addr, value);
            }
            14 | 15 => {
                let (addr, bit) = (self.address(1), self.random.below(8) as u8);
                let value = self.b.load_bit(addr, bit);
                self.set(value);
            }
            16 | 17 => {
                let (addr, bit) = (self.address(1), self.random.below(8) as u8);
                let value = self.get(Type::I1);
                self.b.store_bit(addr, bit, value);
            }
            18 => {
                let len = 1 + self.random.below(70);
                let to = self.address(len);
                if self.random.chance(2) {
                    self.b.clear(to, len);
                } else {
                    let from = self.address(len);
                    self.b.copy(to, from, len);
                }
            }
            19 => self.branch(),
            20 => self.repeat(),
            _ => self.call(),
        }
    }

    /// The bits of a resulting NaN are not defined at this level.
    fn set_float(&mut self, value: Value) {
        let is_nan = self.b.fcmp(FloatCc::Uno, value, value);
        let nan = self.b.i32_const(u32::MAX);
        let nan = self.b.bitcast(Type::F32, nan);
        let value = self.b.select(is_nan, nan, value);
        self.set(value);
    }

    fn branch(&mut self) {
        self.depth += 1;
        let (then_block, else_block, join) = (self.b.create_block(), self.b.create_cold_block(), self.b.create_block());
        if self.random.chance(3) {
            let value = self.get(Type::I32);
            let value = self.b.binary_imm(BinaryOp::And, value, 7);
            let mut targets = vec![then_block, else_block, then_block, join, else_block];
            targets.truncate(self.random.below(6) as usize);
            self.b.switch(value, &targets, join);
            // A block without a jump to it is left out.
        } else {
            let cond = self.get(Type::I1);
            self.b.branch(cond, then_block, else_block);
        }
        for block in [then_block, else_block] {
            self.b.seal_block(block);
            self.b.switch_to(block);
            for _ in 0..self.random.below(6) {
                self.statement();
            }
            self.b.jump(join, &[]);
        }
        self.b.seal_block(join);
        self.b.switch_to(join);
        self.depth -= 1;
    }

    fn repeat(&mut self) {
        self.depth += 1;
        let count = self.b.declare_var(Type::I32);
        let zero = self.b.i32_const(0);
        self.b.def_var(count, zero);
        let (head, end) = (self.b.create_block(), self.b.create_block());
        self.b.jump(head, &[]);
        self.b.switch_to(head);
        for _ in 0..1 + self.random.below(5) {
            self.statement();
        }
        let now = self.b.use_var(count);
        let next = self.b.binary_imm(BinaryOp::Iadd, now, 1);
        self.b.def_var(count, next);
        let limit = 1 + self.random.below(3);
        let more = self.b.icmp_imm(IntCc::Ult, next, i64::from(limit));
        self.b.branch(more, head, end);
        self.b.seal_block(head);
        self.b.seal_block(end);
        self.b.switch_to(end);
        self.depth -= 1;
    }

    fn call(&mut self) {
        if self.known.is_empty() {
            let args = [self.get(Type::I32), self.get(Type::I32)];
            let value = self.b.call_runtime(RuntimeFn::PeripheralRead, &args).expect("it has a result");
            return self.set(value);
        }
        let index = self.random.below(self.known.len() as u32) as usize;
        let known = &self.known[index];
        let args = known.params.iter().map(|&ty| self.get(ty)).collect();
        for value in self.b.call(func(index), args, &known.returns) {
            self.set(value);
        }
    }
}

fn random_function(random: &mut Random, name: &str, known: &[Known], statements: u32) -> (Function, Known) {
    let is_last = name == "OB1";
    let mut types = |max: u32| match is_last {
        true => Vec::new(),
        false => (0..1 + random.below(max)).map(|_| random.pick(&TYPES)).collect::<Vec<_>>(),
    };
    let (params, returns) = (types(25), types(20));
    let mut b = FunctionBuilder::new(name, &params, &returns);
    b.set_frame_bytes(128);
    let vars: Vec<Var> = TYPES.iter().flat_map(|&ty| [ty; 3]).map(|ty| b.declare_var(ty)).collect();
    let pointers = random.chance(2);
    let mut generator = Generator { random, b, vars, known, pointers, depth: 0 };
    for index in 0..params.len() {
        let param = generator.b.param(index);
        generator.set(param);
    }
    for _ in 0..statements {
        generator.statement();
    }
    if is_last {
        for (slot, index) in (0u32..).zip(0..generator.vars.len()) {
            let value = generator.b.use_var(generator.vars[index]);
            let addr = Address::direct(Region::State, 0xA00 + 8 * slot);
            match generator.b.ty(value) {
                Type::I1 => generator.b.store_bit(addr, 0, value),
                _ => generator.b.store(addr, value),
            }
        }
    }
    let values: Vec<Value> = returns.iter().map(|&ty| generator.get(ty)).collect();
    generator.b.ret(&values);
    (generator.b.finish(), Known { params, returns })
}

/// Memory of the interpreter, with the runtime functions of the harness.
struct PlainHost(RefCell<Vec<u8>>);

impl Host for PlainHost {
    fn read(&self, offset: u32, buf: &mut [u8]) {
        buf.copy_from_slice(&self.0.borrow()[offset as usize..offset as usize + buf.len()]);
    }

    fn write(&self, offset: u32, bytes: &[u8]) {
        self.0.borrow_mut()[offset as usize..offset as usize + bytes.len()].copy_from_slice(bytes);
    }

    fn call_runtime(&self, function: RuntimeFn, args: &[u64]) -> u64 {
        assert_eq!(function, RuntimeFn::PeripheralRead);
        args[0] | args[1] << 32
    }
}

fn check(module: &Module, entry: FuncId, name: &str) {
    assert_eq!(plcc_ir::verify::verify(module), Ok(()), "{name}");
    let host = PlainHost(RefCell::new(harness::patterned_memory()));
    Interpreter::new(module).call(&host, entry, &[], LBASE, VBASE);
    // Where return values pass is known to machine code only.
    let returns = layout::state::RETURN_VALUES as usize..layout::state::RETURN_VALUES as usize + 0x400;
    let mut expected = host.0.into_inner();
    expected[returns.clone()].fill(0);
    for options in LEVELS {
        let mut memory = harness::patterned_memory();
        harness::run_on(module, 0, &options, &mut memory);
        memory[returns.clone()].fill(0);
        if memory != expected {
            let at = memory.iter().zip(&expected).position(|(a, b)| a != b).expect("they differ");
            let text = plcc_ir::print::module_text(module);
            let _ = std::fs::write(std::env::temp_dir().join("plcc-random-module.ir"), text);
            panic!("{name}: byte {at:#x} is {:#x}, not {:#x}, {options:?}", memory[at], expected[at]);
        }
    }
}

fn random_module(seed: u64, functions: u32, statements: u32) -> (Module, FuncId) {
    let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    let mut known = Vec::new();
    let mut built = Vec::new();
    for index in 0..functions {
        let (function, signature) = random_function(&mut random, &format!("FC{index}"), &known, statements);
        known.push(signature);
        built.push(function);
    }
    let (function, _) = random_function(&mut random, "OB1", &known, statements);
    built.push(function);
    (harness::module(built), func(functions as usize))
}

#[test]
fn small_programs() {
    let seeds: u64 = std::env::var("PLCC_RANDOM_PROGRAMS").ok().and_then(|count| count.parse().ok()).unwrap_or(150);
    for seed in 1..=seeds {
        let (module, entry) = random_module(seed, (seed % 4) as u32, 12);
        check(&module, entry, &format!("program {seed}"));
    }
}

#[test]
fn a_function_beyond_good_register_allocation() {
    let (module, entry) = random_module(7, 0, 12_000);
    assert!(module.functions[entry].insts.len() > 50_000);
    let options = plcc_codegen::CodegenOptions::default();
    let host = PlainHost(RefCell::new(harness::patterned_memory()));
    Interpreter::new(&module).call(&host, entry, &[], LBASE, VBASE);
    let mut memory = harness::patterned_memory();
    harness::run_on(&module, 0, &options, &mut memory);
    assert!(memory == host.0.into_inner());
}
