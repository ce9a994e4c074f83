//! Times the passes on a large synthetic program: `cargo run --release -p plcc-opt --example measure [LINES]`.
//!
//! The code is what lowering makes of typical STL: bit logic with coils, word arithmetic through an accumulator with its
//! status bits, comparisons with jumps, accesses to an open DB with bounds checks, calls of blocks with safepoints.

use std::time::Instant;

use plcc_abi::layout;
use plcc_abi::layout::state;
use plcc_ir::entities::EntityVec;
use plcc_ir::{
    Address, BinaryOp, FuncId, Function, FunctionBuilder, IntCc, Module, Region, RuntimeFn, StaticDb, Type, Value,
};

fn main() {
    let lines: u32 = std::env::args().nth(1).and_then(|arg| arg.parse().ok()).unwrap_or(26_000);
    let mut functions = EntityVec::new();
    functions.push(organization_block(lines));
    functions.push(callee());
    let dbs = vec![StaticDb { number: 1, address: layout::DB_DATA, length: 1000 }];
    let id = functions.keys().next().expect("a function");
    let mut module = Module { functions, dbs, entries: vec![id], ..Module::default() };
    println!("{lines} lines: {} instructions, {} blocks", count(&module), blocks(&module));

    let start = Instant::now();
    let text = plcc_ir::print::module_text(&module);
    println!("print         {:8.1?}, {} bytes", start.elapsed(), text.len());
    let start = Instant::now();
    plcc_ir::parse::parse_module(&text).expect("printed text is well formed");
    println!("parse         {:8.1?}", start.elapsed());
    let start = Instant::now();
    plcc_ir::verify::verify(&module).expect("the rules are kept");
    println!("verify        {:8.1?}", start.elapsed());

    let begin = Instant::now();
    let mut start = begin;
    plcc_opt::optimize_with(&mut module, &mut |name, module| {
        println!("{name:13} {:8.1?}, {} instructions", start.elapsed(), count(module));
        start = Instant::now();
    });
    println!("optimize      {:8.1?}", begin.elapsed());
}

fn count(module: &Module) -> usize {
    let blocks =
        |function: &Function| function.layout.iter().map(|&block| function.blocks[block].insts.len()).sum::<usize>();
    module.functions.values().map(blocks).sum()
}

fn blocks(module: &Module) -> usize {
    module.functions.values().map(|function| function.layout.len()).sum()
}

fn callee() -> Function {
    let mut b = FunctionBuilder::new("FC1", &[Type::I32, Type::I1], &[Type::I32, Type::I1]);
    let values = [b.param(0), b.param(1)];
    b.store(Address::direct(Region::M, 100), values[0]);
    b.ret(&values);
    b.finish()
}

fn organization_block(lines: u32) -> Function {
    let mut b = FunctionBuilder::new("OB1", &[], &[]);
    b.set_frame_bytes(64);
    b.clear(Address::direct(Region::L, 0), 64);
    let accu1 = b.declare_var(Type::I32);
    let accu2 = b.declare_var(Type::I32);
    let bits: Vec<_> = (0..8).map(|_| b.declare_var(Type::I1)).collect();
    let [rlo, sta, or, cc1, cc0, ov, os, br] = bits[..] else { unreachable!("eight bits") };
    let mut line = 0;
    while line < lines {
        let n = line / 10;
        // A I; AN M; O I; = Q
        let a = b.load_bit(Address::direct(Region::I, n % 128), (n % 8) as u8);
        let m = b.load_bit(Address::direct(Region::M, n % 900), (n % 7) as u8);
        let not = b.not(m);
        let both = b.and(a, not);
        let i = b.load_bit(Address::direct(Region::I, n % 100), 3);
        let result = b.or(both, i);
        b.store_bit(Address::direct(Region::Q, n % 128), (n % 8) as u8, result);
        b.def_var(rlo, result);
        b.def_var(sta, result);
        // L MW; L DBW; +I; T LW
        let word = b.load(Type::I16, Address::direct(Region::M, 1000 + n % 500 * 2));
        let word = b.zext(Type::I32, word);
        let old = b.use_var(accu1);
        b.def_var(accu2, old);
        b.def_var(accu1, word);
        let one = b.i32_const(1);
        let length = b.db_length(one);
        let offset = b.i32_const(n % 400 * 2);
        let end = b.binary_imm(BinaryOp::Iadd, offset, 2);
        let inside = b.icmp(IntCc::Ule, end, length);
        let (fault, good) = (b.create_cold_block(), b.create_block());
        b.branch(inside, good, fault);
        b.seal_block(fault);
        b.switch_to(fault);
        let zero = b.i32_const(0);
        let stop = b.call_runtime(RuntimeFn::SyncError, &[zero, zero, zero, zero]).expect("it has a result");
        leave_if(&mut b, stop);
        b.jump(good, &[]);
        b.seal_block(good);
        b.switch_to(good);
        let base = b.db_base(one);
        let data = b.load(Type::I16, Address::indexed(Region::AnyDb, base, n % 400 * 2));
        let data = b.sext(Type::I32, data);
        let low = b.use_var(accu1);
        let low = b.trunc(Type::I16, low);
        let low = b.sext(Type::I32, low);
        let sum = b.iadd(low, data);
        let (min, max) = (b.i32_const(-32768i32 as u32), b.i32_const(32767));
        let (below, above) = (b.icmp(IntCc::Slt, sum, min), b.icmp(IntCc::Sgt, sum, max));
        let overflow = b.or(below, above);
        b.def_var(ov, overflow);
        let sticky = b.use_var(os);
        let sticky = b.or(sticky, overflow);
        b.def_var(os, sticky);
        let (less, greater) = (b.icmp_imm(IntCc::Slt, sum, 0), b.icmp_imm(IntCc::Sgt, sum, 0));
        b.def_var(cc0, less);
        b.def_var(cc1, greater);
        let high = b.use_var(accu1);
        let high = b.binary_imm(BinaryOp::And, high, 0xFFFF_0000);
        let low = b.binary_imm(BinaryOp::And, sum, 0xFFFF);
        let accu = b.or(high, low);
        b.def_var(accu1, accu);
        let out = b.trunc(Type::I16, accu);
        b.store(Address::direct(Region::L, n % 32 * 2), out);
        // JN
        let (x, y) = (b.use_var(cc0), b.use_var(cc1));
        let not_zero = b.or(x, y);
        let (then, join) = (b.create_block(), b.create_block());
        b.branch(not_zero, then, join);
        b.seal_block(then);
        b.switch_to(then);
        let value = b.use_var(accu1);
        b.store(Address::direct(Region::M, 4000 + n % 1000 * 4), value);
        b.jump(join, &[]);
        b.seal_block(join);
        b.switch_to(join);
        line += 9;
        if n % 8 == 0 {
            // CALL, and its safepoint.
            let (value, bit) = (b.use_var(accu1), b.use_var(rlo));
            let results = b.call(callee_id(), vec![value, bit], &[Type::I32, Type::I1]);
            b.def_var(accu1, results[0]);
            b.def_var(br, results[1]);
            let attention = b.load_state(state::ATTENTION);
            let due = b.icmp_imm(IntCc::Ne, attention, 0);
            let (cold, next) = (b.create_cold_block(), b.create_block());
            b.branch(due, cold, next);
            b.seal_block(cold);
            b.switch_to(cold);
            let stop = b.call_runtime(RuntimeFn::Safepoint, &[]).expect("it has a result");
            leave_if(&mut b, stop);
            b.jump(next, &[]);
            b.seal_block(next);
            b.switch_to(next);
            line += 1;
        }
        let zero = b.bool_const(false);
        b.def_var(or, zero);
    }
    b.ret(&[]);
    b.finish()
}

fn callee_id() -> FuncId {
    plcc_ir::entities::Entity::new(1)
}

fn leave_if(b: &mut FunctionBuilder, stop: Value) {
    let stopped = b.icmp_imm(IntCc::Ne, stop, 0);
    let (leave, go_on) = (b.create_cold_block(), b.create_cold_block());
    b.branch(stopped, leave, go_on);
    b.seal_block(leave);
    b.seal_block(go_on);
    b.switch_to(leave);
    b.ret(&[]);
    b.switch_to(go_on);
}
