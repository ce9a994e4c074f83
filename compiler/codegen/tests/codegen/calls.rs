//! Calls of functions and of the runtime, switches, loops.

use plcc_abi::{RuntimeFn, Type, layout};
use plcc_ir::{Address, BinaryOp, FunctionBuilder, IntCc, Region};

use crate::harness::{self, LBASE, func, module, read_state, run};

const RESULT: u32 = 0x400;

fn result(slot: u32) -> Address {
    Address::direct(Region::State, RESULT + 8 * slot)
}

const MIXED: [Type; 7] = [Type::I32, Type::I1, Type::F32, Type::I64, Type::I8, Type::F64, Type::I16];

/// Calls a function that takes `params` values and returns the last `returns` of them, in reverse.
fn check_call(params: usize, returns: usize) {
    let param_types: Vec<Type> = (0..params).map(|index| MIXED[index % MIXED.len()]).collect();
    let picked: Vec<usize> = (0..returns).map(|index| (params - 1 + params * 4 - index) % params).collect();
    let return_types: Vec<Type> = picked.iter().map(|&index| param_types[index]).collect();

    let mut callee = FunctionBuilder::new("FC1", &param_types, &return_types);
    let values: Vec<_> = picked.iter().map(|&index| callee.param(index)).collect();
    callee.ret(&values);

    let mut caller = FunctionBuilder::new("OB1", &[], &[]);
    // Loaded, so that nothing is known at compile time.
    let zero = caller.load(Type::I64, Address::direct(Region::State, 0x3F0));
    let args = (0u64..)
        .zip(&param_types)
        .map(|(index, &ty)| {
            let bits = caller.iconst(Type::I64, 0x0102_0304_0506_0708u64.wrapping_mul(index + 1) as i64);
            let bits = caller.iadd(zero, bits);
            match ty {
                Type::F32 => {
                    let word = caller.trunc(Type::I32, bits);
                    caller.bitcast(ty, word)
                }
                Type::F64 => caller.bitcast(ty, bits),
                _ => caller.trunc(ty, bits),
            }
        })
        .collect();
    let results = caller.call(func(0), args, &return_types);
    for (slot, value) in (0u32..).zip(results) {
        let value = if caller.ty(value) == Type::I1 { caller.zext(Type::I8, value) } else { value };
        caller.store(result(slot), value);
    }
    caller.ret(&[]);

    let memory = run(&module(vec![callee.finish(), caller.finish()]));
    for (slot, &index) in (0u32..).zip(&picked) {
        let ty = param_types[index];
        let bits = 0x0102_0304_0506_0708u64.wrapping_mul(index as u64 + 1);
        let value = read_state(&memory, RESULT + 8 * slot, ty.bytes() as usize);
        assert_eq!(value, plcc_ir::eval::mask(ty, bits), "{params} parameters, return value {slot}");
    }
}

#[test]
fn parameters_and_return_values() {
    for (params, returns) in [(1, 0), (1, 1), (4, 2), (7, 5), (13, 13), (25, 20), (40, 40)] {
        check_call(params, returns);
    }
}

#[test]
fn frames_of_callees() {
    // FC2 writes its own frame and its caller's; FC1 only hands its frame on; OB1 sees both.
    let mut inner = FunctionBuilder::new("FC2", &[], &[]);
    inner.set_frame_bytes(16);
    let value = inner.i32_const(0x1111_1111);
    inner.store(Address::direct(Region::L, 4), value);
    let value = inner.i32_const(0x2222_2222);
    inner.store(Address::direct(Region::V, 4), value);
    inner.ret(&[]);
    // Not an entry: it takes a value.
    let mut outer = FunctionBuilder::new("FC1", &[Type::I32], &[]);
    outer.set_frame_bytes(32);
    outer.call(func(0), vec![], &[]);
    outer.ret(&[]);
    let mut ob = FunctionBuilder::new("OB1", &[], &[]);
    ob.set_frame_bytes(64);
    let zero = ob.i32_const(0);
    ob.call(func(1), vec![zero], &[]);
    ob.ret(&[]);
    // FC2 has the signature of an entry and is one, called from inside as well.
    let module = module(vec![inner.finish(), outer.finish(), ob.finish()]);
    for options in harness::LEVELS {
        let mut memory = harness::patterned_memory();
        harness::run_on(&module, 1, &options, &mut memory);
        let at = |offset: u32| &memory[offset as usize..offset as usize + 4];
        assert_eq!(at(LBASE + 64 + 4), [0x22; 4]);
        assert_eq!(at(LBASE + 64 + 32 + 4), [0x11; 4]);
    }
}

#[test]
fn recursion_with_many_values() {
    // f(n, a, b, c) = n == 0 ? (a, b, c) : f(n - 1, a + b, b + c, c + n)
    let types = [Type::I32; 3];
    let mut b = FunctionBuilder::new("FC1", &[Type::I32; 4], &types);
    let [n, x, y, z] = [0, 1, 2, 3].map(|index| b.param(index));
    let (end, more) = (b.create_block(), b.create_block());
    let done = b.icmp_imm(IntCc::Eq, n, 0);
    b.branch(done, end, more);
    b.seal_block(end);
    b.seal_block(more);
    b.switch_to(end);
    b.ret(&[x, y, z]);
    b.switch_to(more);
    let args = vec![b.binary_imm(BinaryOp::Isub, n, 1), b.iadd(x, y), b.iadd(y, z), b.iadd(z, n)];
    let results = b.call(func(0), args, &types);
    b.ret(&results);
    let mut ob = FunctionBuilder::new("OB1", &[], &[]);
    let args = [9, 1, 2, 3].map(|value| ob.i32_const(value)).to_vec();
    for (slot, value) in (0u32..).zip(ob.call(func(0), args, &types)) {
        ob.store(result(slot), value);
    }
    ob.ret(&[]);
    let memory = run(&module(vec![b.finish(), ob.finish()]));
    let (mut n, mut x, mut y, mut z) = (9u32, 1u32, 2u32, 3u32);
    while n > 0 {
        (n, x, y, z) = (n - 1, x + y, y + z, z + n);
    }
    assert_eq!([0, 1, 2].map(|slot| read_state(&memory, RESULT + 8 * slot, 4) as u32), [x, y, z]);
}

#[test]
fn runtime_calls() {
    let module = harness::entry(|b| {
        let site = b.i32_const(0);
        let stopped = b.call_runtime(RuntimeFn::Safepoint, &[site]).expect("it has a result");
        b.store(result(0), stopped);
        // The runtime wrote it meanwhile.
        let substitute = b.load_state(layout::state::SUBSTITUTE);
        b.store(result(1), substitute);
        let args = [3, 4, 5, 6].map(|value| b.i32_const(value));
        let code = b.call_runtime(RuntimeFn::SyncError, &args).expect("it has a result");
        b.store(result(2), code);
        let info = b.load_state(layout::state::SUBSTITUTE);
        b.store(result(3), info);
        let x = b.f32_const(2.0);
        let y = b.call_pure(RuntimeFn::Sin, &[x]);
        b.store(result(4), y);
        let args = [7, 4].map(|value| b.i32_const(value));
        let read = b.call_runtime(RuntimeFn::PeripheralRead, &args).expect("it has a result");
        b.store(result(5), read);
    });
    let memory = run(&module);
    let slot = |slot: u32| read_state(&memory, RESULT + 8 * slot, 4);
    assert_eq!([slot(0), slot(1), slot(2), slot(3)], [5, 77, 3405, 6]);
    assert_eq!(f32::from_bits(slot(4) as u32), 2.5);
    assert_eq!(read_state(&memory, RESULT + 40, 8), 4 << 32 | 7);
}

#[test]
fn switches() {
    for targets in 0..12u32 {
        for value in [0, 1, 2, 3, 5, 11, 12, 0x8000_0000, u32::MAX] {
            let module = harness::entry(|b| {
                let zero = b.load(Type::I32, Address::direct(Region::State, 0x3F0));
                let value = b.i32_const(value);
                let value = b.iadd(zero, value);
                let join = b.create_block();
                let param = b.append_param(join, Type::I32);
                let blocks: Vec<_> = (0..targets).map(|_| b.create_block()).collect();
                let default = b.create_block();
                b.switch(value, &blocks, default);
                for (number, block) in (100u32..).zip(blocks).chain([(999, default)]) {
                    b.seal_block(block);
                    b.switch_to(block);
                    let number = b.i32_const(number);
                    b.jump(join, &[number]);
                }
                b.seal_block(join);
                b.switch_to(join);
                b.store(result(0), param);
            });
            let expected = if value < targets { 100 + value } else { 999 };
            assert_eq!(read_state(&run(&module), RESULT, 4), u64::from(expected), "{value} of {targets}");
        }
    }
}

#[test]
fn a_loop_back_to_the_first_block() {
    let mut b = FunctionBuilder::new("OB1", &[], &[]);
    let first = b.current_block().expect("a builder begins in a block");
    let count = b.load(Type::I32, result(0));
    let count = b.binary_imm(BinaryOp::Iadd, count, 1);
    b.store(result(0), count);
    let more = b.icmp_imm(IntCc::Ult, count, 10);
    let (again, end) = (b.create_block(), b.create_block());
    b.branch(more, again, end);
    b.seal_block(again);
    b.seal_block(end);
    b.switch_to(end);
    b.ret(&[]);
    b.switch_to(again);
    // The builder seals the first block; here it is jumped to all the same, as a pass may do.
    b.ret(&[]);
    let mut function = b.finish();
    let last = function.terminator(again).expect("the block ends");
    function.insts[last] = plcc_ir::InstData::Jump { target: plcc_ir::BlockCall::new(first) };
    assert_eq!(read_state(&run(&module(vec![function])), RESULT, 4), 10);
}
