//! Measures the code generator: time to compile large functions, and size and speed of a few kernels.
//!
//! `cargo run --release -p plcc-codegen --example measure`

use std::time::Instant;

use plcc_abi::{RuntimeFn, Type, layout};
use plcc_codegen::{CodegenOptions, JitProgram, asm_text, compile_object};
use plcc_ir::entities::Entity;
use plcc_ir::{Address, BinaryOp, FuncId, Function, FunctionBuilder, IntCc, Module, Region, StaticDb};

const DB: StaticDb = StaticDb { number: 1, address: layout::DB_DATA, length: 65534 };

fn module(functions: Vec<Function>) -> Module {
    let mut module = Module { dbs: vec![DB], ..Module::default() };
    for function in functions {
        let is_entry = function.params().next().is_none() && function.returns.is_empty();
        let id = module.functions.push(function);
        module.entries.extend(is_entry.then_some(id));
    }
    module
}

fn m(byte: u32) -> Address {
    Address::direct(Region::M, byte % 8000)
}

/// A block of `networks` networks of about ten statements, as a program without an optimiser before this stage has it: the
/// accumulators and status bits are variables that live from one network to the next.
fn large_block(name: &str, networks: u32, jump_every: u32) -> Function {
    let mut b = FunctionBuilder::new(name, &[], &[]);
    let accu1 = b.declare_var(Type::I32);
    let accu2 = b.declare_var(Type::I32);
    let rlo = b.declare_var(Type::I1);
    let ov = b.declare_var(Type::I1);
    let os = b.declare_var(Type::I1);
    for network in 0..networks {
        // A I; AN M; = Q
        let x = b.load_bit(Address::direct(Region::I, network % 1000), (network % 8) as u8);
        let y = b.load_bit(m(network * 3), 3);
        let y = b.not(y);
        let x = b.and(x, y);
        b.def_var(rlo, x);
        b.store_bit(Address::direct(Region::Q, network % 900), (network % 7) as u8, x);
        // L MW; L MW; +I; T MW
        let old = b.use_var(accu1);
        let left = b.load(Type::I16, m(network * 2));
        let left = b.zext(Type::I32, left);
        let right = b.load(Type::I16, m(network * 2 + 100));
        let right = b.zext(Type::I32, right);
        let (wide_left, wide_right) = (b.trunc(Type::I16, left), b.trunc(Type::I16, right));
        let (wide_left, wide_right) = (b.sext(Type::I32, wide_left), b.sext(Type::I32, wide_right));
        let sum = b.iadd(wide_left, wide_right);
        let short = b.trunc(Type::I16, sum);
        let back = b.sext(Type::I32, short);
        let overflow = b.icmp(IntCc::Ne, sum, back);
        b.def_var(ov, overflow);
        let before = b.use_var(os);
        let sticky = b.or(before, overflow);
        b.def_var(os, sticky);
        let result = b.zext(Type::I32, short);
        let mixed = b.xor(result, old);
        b.def_var(accu1, mixed);
        b.def_var(accu2, left);
        b.store(m(network * 2 + 4), short);
        if network % jump_every == jump_every - 1 {
            // JO over a statement.
            let (jump, next) = (b.create_block(), b.create_block());
            let overflow = b.use_var(ov);
            b.branch(overflow, next, jump);
            b.seal_block(jump);
            b.switch_to(jump);
            let other = b.use_var(accu2);
            b.def_var(accu1, other);
            b.jump(next, &[]);
            b.seal_block(next);
            b.switch_to(next);
            b.settle_vars();
        }
        if network % 25 == 24 {
            // A safepoint.
            let attention = b.load_state(layout::state::ATTENTION);
            let due = b.icmp_imm(IntCc::Ne, attention, 0);
            let (cold, stop, next) = (b.create_cold_block(), b.create_cold_block(), b.create_block());
            b.branch(due, cold, next);
            b.seal_block(cold);
            b.switch_to(cold);
            let stopped = b.call_runtime(RuntimeFn::Safepoint, &[]).expect("it has a result");
            let stopped = b.icmp_imm(IntCc::Ne, stopped, 0);
            b.branch(stopped, stop, next);
            b.seal_block(stop);
            b.switch_to(stop);
            b.ret(&[]);
            b.seal_block(next);
            b.switch_to(next);
            b.settle_vars();
        }
    }
    let values = [accu1, accu2].map(|var| b.use_var(var));
    b.store(m(6000), values[0]);
    b.store(m(6004), values[1]);
    let bits = [rlo, ov, os].map(|var| b.use_var(var));
    for (bit, value) in (0u8..).zip(bits) {
        b.store_bit(m(6010), bit, value);
    }
    b.ret(&[]);
    b.finish()
}

fn compile_times() {
    for (networks, jump_every) in [(100u32, 5), (500, 5), (1000, 5), (2000, 5), (4000, 5), (2000, 1)] {
        for optimize in [false, true] {
            let module = module(vec![large_block("OB1", networks, jump_every)]);
            let options = CodegenOptions { optimize, ..CodegenOptions::default() };
            let start = Instant::now();
            let object = compile_object(&module, &[], &options).expect("it compiles");
            let time = start.elapsed();
            let insts = module.functions[FuncId::new(0)].insts.len();
            println!(
                "{networks:6} networks, {insts:7} instructions, optimize {optimize:5}: {time:>10.1?}, {} bytes",
                object.len()
            );
        }
    }
    let blocks = (0..26).map(|number| large_block(&format!("OB{number}"), 100, 5)).collect();
    let module = module(blocks);
    let start = Instant::now();
    compile_object(&module, &[], &CodegenOptions::default()).expect("it compiles");
    println!("26 blocks of 100 networks: {:.1?}", start.elapsed());
}

/// A loop that runs `body` a million times.
fn repeated(mut b: FunctionBuilder, body: impl FnOnce(&mut FunctionBuilder, plcc_ir::Value)) -> Function {
    let count = b.declare_var(Type::I32);
    let zero = b.i32_const(0);
    b.def_var(count, zero);
    let (head, end) = (b.create_block(), b.create_block());
    b.jump(head, &[]);
    b.switch_to(head);
    let now = b.use_var(count);
    body(&mut b, now);
    let now = b.use_var(count);
    let next = b.binary_imm(BinaryOp::Iadd, now, 1);
    b.def_var(count, next);
    let more = b.icmp_imm(IntCc::Ult, next, 1_000_000);
    b.branch(more, head, end);
    b.seal_block(head);
    b.seal_block(end);
    b.switch_to(end);
    b.ret(&[]);
    b.finish()
}

fn ob1() -> FunctionBuilder {
    FunctionBuilder::new("OB1", &[], &[])
}

fn kernels() -> Vec<(&'static str, Module)> {
    let bits = repeated(ob1(), |b, _| {
        for index in 0..10u32 {
            let x = b.load_bit(Address::direct(Region::I, index), (index % 8) as u8);
            let y = b.load_bit(m(index + 40), ((index + 3) % 8) as u8);
            let z = b.load_bit(m(index + 60), ((index + 5) % 8) as u8);
            let y = b.not(y);
            let x = b.and(x, y);
            let x = b.or(x, z);
            b.store_bit(Address::direct(Region::Q, index), (index % 8) as u8, x);
        }
    });
    let words = repeated(ob1(), |b, _| {
        for index in 0..10u32 {
            let x = b.load(Type::I16, m(2 * index));
            let y = b.load(Type::I16, m(2 * index + 2));
            let x = b.iadd(x, y);
            b.store(m(2 * index + 200), x);
        }
    });
    let array = repeated(ob1(), |b, count| {
        let index = b.binary_imm(BinaryOp::And, count, 0x3FFF);
        let offset = b.binary_imm(BinaryOp::Shl, index, 2);
        let old = b.load(Type::I32, Address::indexed(Region::Db(1), offset, 0));
        let new = b.iadd(old, count);
        b.store(Address::indexed(Region::Db(1), offset, 0), new);
    });
    let real = repeated(ob1(), |b, _| {
        let x = b.load(Type::F32, m(100));
        let y = b.load(Type::F32, m(104));
        let x = b.binary(BinaryOp::Fmul, x, y);
        let x = b.binary(BinaryOp::Fadd, x, y);
        b.store(m(100), x);
    });
    let mut kernels = vec![
        ("30 bit operations", bits),
        ("10 word additions", words),
        ("array element", array),
        ("REAL, in memory", real),
    ]
    .into_iter()
    .map(|(name, function)| (name, module(vec![function])))
    .collect::<Vec<_>>();
    for returns in [1, 2, 4, 8, 12] {
        let types = vec![Type::I32; returns];
        let mut callee = FunctionBuilder::new("FC1", &types, &types);
        let values: Vec<_> = (0..returns)
            .map(|index| {
                let (param, other) = (callee.param(index), callee.param(0));
                callee.iadd(param, other)
            })
            .collect();
        callee.ret(&values);
        let caller = repeated(ob1(), |b, count| {
            let results = b.call(FuncId::new(0), vec![count; returns], &types);
            let attention = b.load_state(layout::state::ATTENTION);
            let value = results.into_iter().fold(attention, |sum, value| b.iadd(sum, value));
            b.store(m(0), value);
        });
        let name = ["", "call, 1 value", "call, 2 values", "", "call, 4 values"].get(returns).copied();
        let name = name.unwrap_or(if returns == 8 { "call, 8 values" } else { "call, 12 values" });
        kernels.push((name, module(vec![callee.finish(), caller])));
    }
    kernels
}

fn run_kernels(print: bool) {
    let mut memory = vec![0u8; layout::DB_DATA as usize + 0x2_0000];
    for (name, module) in kernels() {
        for native in [false, true] {
            let options = CodegenOptions { native, ..CodegenOptions::default() };
            let program = JitProgram::compile(&module, &|_| std::ptr::null(), &options).expect("it compiles");
            let best = (0..5)
                .map(|_| {
                    let start = Instant::now();
                    // SAFETY: the memory covers every area that the kernels touch.
                    unsafe { program.entry(0)(memory.as_mut_ptr(), layout::L, layout::L) };
                    start.elapsed()
                })
                .min()
                .expect("it ran");
            let ns = best.as_nanos() as f64 / 1e6;
            println!("{name:20} native {native:5}: {ns:6.2} ns a round, {} bytes", program.code_bytes());
        }
        if print {
            println!("{}", asm_text(&module, &CodegenOptions::default()).expect("it compiles"));
        }
    }
}

fn main() {
    compile_times();
    run_kernels(std::env::args().any(|arg| arg == "--asm"));
}
