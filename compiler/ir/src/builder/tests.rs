//! SSA construction: shapes that are easy to get wrong, and random programs against their direct interpretation.

use plcc_abi::{RuntimeFn, layout};
use proptest::prelude::*;

use super::*;
use crate::entities::{Entity, FuncId};
use crate::instructions::{BinaryOp, IntCc};
use crate::interpreter::{Host, Interpreter};
use crate::module::Module;
use crate::print::function_text;
use crate::verify::verify;

/// For functions that use no memory.
struct NoHost;

impl Host for NoHost {
    fn read(&self, _offset: u32, buf: &mut [u8]) {
        buf.fill(0);
    }

    fn write(&self, _offset: u32, _bytes: &[u8]) {}

    fn call_runtime(&self, _function: RuntimeFn, _args: &[u64]) -> u64 {
        0
    }
}

fn module_of(function: Function) -> Module {
    let mut functions = EntityVec::new();
    functions.push(function);
    Module { functions, ..Module::default() }
}

fn run(function: Function, args: &[u64]) -> Vec<u64> {
    let module = module_of(function);
    if let Err(errors) = verify(&module) {
        panic!("{}\n{}", errors[0], function_text(&module, &module.functions[FuncId::new(0)]));
    }
    Interpreter::new(&module).call(&NoHost, FuncId::new(0), args, layout::L, layout::L)
}

#[test]
fn a_loop_with_an_unsealed_head() {
    // Counts its argument down, adding it up.
    let mut b = FunctionBuilder::new("F", &[Type::I32], &[Type::I32]);
    let (count, sum) = (b.declare_var(Type::I32), b.declare_var(Type::I32));
    let (head, body, end) = (b.create_block(), b.create_block(), b.create_block());
    let param = b.param(0);
    b.def_var(count, param);
    b.jump(head, &[]);
    b.switch_to(head);
    let value = b.use_var(count);
    let more = b.icmp_imm(IntCc::Ne, value, 0);
    b.branch(more, body, end);
    b.seal_block(body);
    b.seal_block(end);
    b.switch_to(body);
    let (value, total) = (b.use_var(count), b.use_var(sum));
    let total = b.iadd(total, value);
    b.def_var(sum, total);
    let value = b.binary_imm(BinaryOp::Isub, value, 1);
    b.def_var(count, value);
    b.jump(head, &[]);
    b.seal_block(head);
    b.switch_to(end);
    let total = b.use_var(sum);
    b.ret(&[total]);
    assert_eq!(run(b.finish(), &[4]), [10]);
}

#[test]
fn a_switch_may_name_a_target_several_times() {
    let mut b = FunctionBuilder::new("F", &[Type::I32], &[Type::I32]);
    let var = b.declare_var(Type::I32);
    let (other, join) = (b.create_block(), b.create_block());
    let param = b.param(0);
    b.def_var(var, param);
    b.switch(param, &[join, other, join], join);
    b.seal_block(other);
    b.switch_to(other);
    let nine = b.i32_const(9);
    b.def_var(var, nine);
    b.jump(join, &[]);
    b.seal_block(join);
    b.switch_to(join);
    let value = b.use_var(var);
    b.ret(&[value]);
    let function = b.finish();
    assert_eq!([0, 1, 2, 3].map(|arg| run(function.clone(), &[arg])[0]), [0, 9, 2, 3]);
}

#[test]
fn blocks_that_only_follow_each_other_are_unreachable() {
    let mut b = FunctionBuilder::new("F", &[], &[Type::I32]);
    let var = b.declare_var(Type::I32);
    let (first, second, end) = (b.create_block(), b.create_block(), b.create_block());
    let five = b.i32_const(5);
    b.def_var(var, five);
    b.jump(end, &[]);
    b.switch_to(first);
    b.jump(second, &[]);
    b.switch_to(second);
    b.jump(first, &[]);
    for block in [first, second, end] {
        b.seal_block(block);
    }
    // Nothing reaches the two, yet they read.
    assert_eq!(b.read_var(var, first), b.read_var(var, second));
    b.switch_to(end);
    let value = b.use_var(var);
    b.ret(&[value]);
    assert_eq!(run(b.finish(), &[]), [5]);
}

#[test]
fn long_rows_of_joins_take_no_stack() {
    let mut b = FunctionBuilder::new("F", &[Type::I1, Type::I32], &[Type::I32]);
    let var = b.declare_var(Type::I32);
    let (cond, value) = (b.param(0), b.param(1));
    b.def_var(var, value);
    for _ in 0..100_000 {
        let (then, join) = (b.create_block(), b.create_block());
        b.branch(cond, then, join);
        b.seal_block(then);
        b.switch_to(then);
        b.jump(join, &[]);
        b.seal_block(join);
        b.switch_to(join);
    }
    let read = b.use_var(var);
    b.ret(&[read]);
    let function = b.finish();
    assert!(function.layout.iter().skip(1).all(|&block| function.blocks[block].params.is_empty()));
    assert_eq!(run(function, &[1, 42]), [42]);
}

/// Statement of a random program over four i32 variables.
#[derive(Clone, Debug)]
enum Statement {
    Set(usize, u32),
    Copy(usize, usize),
    Add(usize, usize),
    Xor(usize, usize),
}

#[derive(Clone, Debug)]
enum End {
    Jump(usize),
    /// By the lowest bit of a variable.
    Branch(usize, usize, usize),
    Switch(usize, Vec<usize>, usize),
    Return,
}

#[derive(Clone, Debug)]
struct RandomBlock {
    statements: Vec<Statement>,
    end: End,
}

const VARS: usize = 4;
const STEPS_MAX: usize = 200;

fn random_block(blocks: usize) -> impl Strategy<Value = RandomBlock> {
    let statement = prop_oneof![
        (0..VARS, 0..4u32).prop_map(|(var, value)| Statement::Set(var, value)),
        (0..VARS, 0..VARS).prop_map(|(to, from)| Statement::Copy(to, from)),
        (0..VARS, 0..VARS).prop_map(|(to, from)| Statement::Add(to, from)),
        (0..VARS, 0..VARS).prop_map(|(to, from)| Statement::Xor(to, from)),
    ];
    let end = prop_oneof![
        2 => (1..blocks).prop_map(End::Jump),
        4 => (0..VARS, 1..blocks, 1..blocks).prop_map(|(var, a, b)| End::Branch(var, a, b)),
        2 => (0..VARS, prop::collection::vec(1..blocks, 0..4), 1..blocks)
            .prop_map(|(var, targets, default)| End::Switch(var, targets, default)),
        1 => Just(End::Return),
    ];
    (prop::collection::vec(statement, 0..4), end).prop_map(|(statements, end)| RandomBlock { statements, end })
}

/// A program, and for each block how early it is sealed: soon after its last predecessor, or at the end.
fn random_program() -> impl Strategy<Value = (Vec<RandomBlock>, Vec<bool>, Vec<usize>)> {
    (2..12usize).prop_flat_map(|blocks| {
        (
            prop::collection::vec(random_block(blocks), blocks),
            prop::collection::vec(any::<bool>(), blocks),
            Just((1..blocks).collect::<Vec<_>>()).prop_shuffle(),
        )
    })
}

/// Runs the program on variables; returns them at the end. Each block costs a step, and the program ends with the last.
fn interpret(program: &[RandomBlock], args: [u32; VARS]) -> [u32; VARS] {
    let mut vars = args;
    let mut at = 0;
    for _ in 0..STEPS_MAX {
        for statement in &program[at].statements {
            match *statement {
                Statement::Set(var, value) => vars[var] = value,
                Statement::Copy(to, from) => vars[to] = vars[from],
                Statement::Add(to, from) => vars[to] = vars[to].wrapping_add(vars[from]),
                Statement::Xor(to, from) => vars[to] ^= vars[from],
            }
        }
        at = match &program[at].end {
            End::Jump(target) => *target,
            End::Branch(var, then_to, else_to) => {
                if vars[*var] & 1 == 1 {
                    *then_to
                } else {
                    *else_to
                }
            }
            End::Switch(var, targets, default) => targets.get(vars[*var] as usize).copied().unwrap_or(*default),
            End::Return => return vars,
        };
    }
    vars
}

/// Builds the same program; the steps are a variable too, so that every loop ends.
fn build(program: &[RandomBlock], late: &[bool], order: &[usize]) -> Function {
    let types = [Type::I32; VARS];
    let mut b = FunctionBuilder::new("F", &types, &types);
    let vars: Vec<Var> = (0..VARS).map(|_| b.declare_var(Type::I32)).collect();
    let steps = b.declare_var(Type::I32);
    for (index, &var) in vars.iter().enumerate() {
        let value = b.param(index);
        b.def_var(var, value);
    }
    let end = b.create_block();
    let mut blocks = vec![b.current_block().expect("the entry")];
    blocks.extend((1..program.len()).map(|_| b.create_block()));
    let mut open_jumps = vec![0; program.len()];
    for block in program {
        for target in targets(block) {
            open_jumps[target] += 1;
        }
    }
    let seal_if_known = |b: &mut FunctionBuilder, open_jumps: &[usize], index: usize| {
        if open_jumps[index] == 0 && !late[index] {
            b.seal_block(blocks[index]);
        }
    };
    for index in 1..program.len() {
        seal_if_known(&mut b, &open_jumps, index);
    }
    for index in std::iter::once(0).chain(order.iter().copied()) {
        b.switch_to(blocks[index]);
        for statement in &program[index].statements {
            let (to, value) = match *statement {
                Statement::Set(var, value) => (var, b.i32_const(value)),
                Statement::Copy(to, from) => (to, b.use_var(vars[from])),
                Statement::Add(to, from) => {
                    let (x, y) = (b.use_var(vars[to]), b.use_var(vars[from]));
                    (to, b.iadd(x, y))
                }
                Statement::Xor(to, from) => {
                    let (x, y) = (b.use_var(vars[to]), b.use_var(vars[from]));
                    (to, b.xor(x, y))
                }
            };
            b.def_var(vars[to], value);
        }
        let count = b.use_var(steps);
        let count = b.binary_imm(BinaryOp::Iadd, count, 1);
        b.def_var(steps, count);
        let go_on = b.icmp_imm(IntCc::Ult, count, STEPS_MAX as i64);
        let next = b.create_block();
        b.branch(go_on, next, end);
        b.seal_block(next);
        b.switch_to(next);
        match &program[index].end {
            End::Jump(target) => b.jump(blocks[*target], &[]),
            End::Branch(var, then_to, else_to) => {
                let value = b.use_var(vars[*var]);
                let bit = b.trunc(Type::I1, value);
                b.branch(bit, blocks[*then_to], blocks[*else_to]);
            }
            End::Switch(var, targets, default) => {
                let value = b.use_var(vars[*var]);
                let targets: Vec<Block> = targets.iter().map(|&target| blocks[target]).collect();
                b.switch(value, &targets, blocks[*default]);
            }
            End::Return => {
                let values: Vec<Value> = vars.iter().map(|&var| b.use_var(var)).collect();
                b.ret(&values);
            }
        }
        for target in targets(&program[index]) {
            open_jumps[target] -= 1;
            seal_if_known(&mut b, &open_jumps, target);
        }
    }
    b.seal_block(end);
    b.switch_to(end);
    let values: Vec<Value> = vars.iter().map(|&var| b.use_var(var)).collect();
    b.ret(&values);
    for &block in &blocks {
        b.seal_block(block);
    }
    b.finish()
}

fn targets(block: &RandomBlock) -> Vec<usize> {
    match &block.end {
        End::Jump(target) => vec![*target],
        End::Branch(_, then_to, else_to) => vec![*then_to, *else_to],
        End::Switch(_, targets, default) => targets.iter().chain([default]).copied().collect(),
        End::Return => Vec::new(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_programs_keep_their_meaning(
        (program, late, order) in random_program(),
        args in prop::array::uniform4(0..8u32),
    ) {
        let mut function = build(&program, &late, &order);
        let expected = interpret(&program, args).map(u64::from).to_vec();
        let args = args.map(u64::from);
        prop_assert_eq!(&run(function.clone(), &args), &expected);

        // The canonical form means the same, and its text reads back to it.
        function.compact();
        prop_assert_eq!(&run(function.clone(), &args), &expected);
        let module = module_of(function);
        let text = crate::print::module_text(&module);
        prop_assert_eq!(crate::parse::parse_module(&text), Ok(module));
    }
}
