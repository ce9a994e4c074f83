//! Functions through which the runtime calls FCs and FBs by number.
//!
//! They have no parameters: CPU registers come from the CPU state and go back there. DB and DI are the caller's own after the call.

use plcc_abi::layout::{self, CpuRegister, state};
use plcc_abi::{RuntimeFn, Type};
use plcc_ir::{Address, FuncId, Function, FunctionBuilder, Region, Value};
use plcc_model::{CodeBlock, Passing, Width};

use crate::call;
use crate::plan::{self, Plan};

/// Bytes of the zero ANY or POINTER that replaces each one that is not passed.
const NO_POINTER_BYTES: u32 = 18;

/// The entry of `block`, whose function is `function`.
pub fn lower_entry(plan: &Plan<'_>, block: &CodeBlock, function: FuncId) -> Function {
    let mut b = FunctionBuilder::new(format!("{}_entry", plan::function_name(block)), &[], &[]);
    let words: Vec<Value> = plan.registers.iter().map(|register| b.load_state(register.slot())).collect();
    check_instance(&mut b, plan, block, &words);
    let mut arguments = Vec::new();
    for (&register, word) in plan.registers.iter().zip(words) {
        arguments.push(b.trunc(plan::register_type(register), word));
    }
    if plan::takes_references(block) {
        no_arguments(&mut b, block, &mut arguments);
        arguments.extend(plan.pointed(block.key()).iter().map(|_| b.i32_const(0)));
    }
    let returned = b.call(function, arguments, &plan.function_returns(block));
    for (register, value) in plan.returned_registers().zip(returned) {
        let value = b.zext(Type::I32, value);
        b.store_state(register.slot(), value);
    }
    b.ret(&[]);
    b.finish()
}

/// Nothing is passed for the formals of an FC: reads yield 0, writes have no effect.
fn no_arguments(b: &mut FunctionBuilder, block: &CodeBlock, arguments: &mut Vec<Value>) {
    for parameter in &block.interface.parameters {
        if !matches!(parameter.passing, Passing::Elementary(_) | Passing::Number) {
            b.set_frame_bytes(layout::frame_bytes(NO_POINTER_BYTES));
        }
        let nowhere: &[u32] = match parameter.passing {
            Passing::Elementary(Width::Bit) => &[layout::SCRATCH * 8],
            Passing::Elementary(_) => &[layout::SCRATCH],
            Passing::Number => &[0],
            // At the start of this frame.
            Passing::Complex { .. } => &[0, layout::SCRATCH],
            Passing::Pointer | Passing::Any | Passing::Variant => &[0],
            Passing::OpenArray { dimensions } => {
                arguments.push(b.i32_const(0));
                arguments.push(b.i32_const(layout::SCRATCH));
                // No element exists between 1 and 0.
                for _ in 0..dimensions {
                    arguments.push(b.i32_const(1));
                    arguments.push(b.i32_const(0));
                }
                continue;
            }
        };
        arguments.extend(nowhere.iter().map(|&value| b.i32_const(value)));
    }
    if b.function().frame_bytes > 0 {
        b.clear(Address::direct(Region::L, 0), NO_POINTER_BYTES);
    }
}

/// An FB whose instance is not in DI at AR2 is not run: a synchronous error instead. The runtime, which made the call, sees a STOP.
fn check_instance(b: &mut FunctionBuilder, plan: &Plan<'_>, block: &CodeBlock, words: &[Value]) {
    let word = |wanted| {
        let index = plan.registers.iter().position(|&register| register == wanted);
        words[index.expect("every profile has DI and AR2")]
    };
    let (di, ar2) = (word(CpuRegister::Di), word(CpuRegister::Ar2));
    let Some(check) = call::instance_check(b, block, di, ar2) else { return };
    let (good, bad) = (b.create_block(), b.create_cold_block());
    b.branch(check.ok, good, bad);
    b.seal_block(good);
    b.seal_block(bad);
    b.switch_to(bad);
    let site = b.load_state(state::SITE);
    b.call_runtime(RuntimeFn::SyncError, &[site, check.code, check.access, check.info]);
    b.ret(&[]);
    b.switch_to(good);
}
