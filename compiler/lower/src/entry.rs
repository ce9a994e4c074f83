//! Functions through which the runtime calls FCs and FBs by number.
//!
//! They take nothing: CPU registers come from the CPU state and go back there. DB and DI are the caller's own after the call.

use plcc_abi::layout::{self, CpuRegister};
use plcc_abi::{RuntimeFn, Type};
use plcc_ir::{BinaryOp, FuncId, Function, FunctionBuilder, IntCc, Value};
use plcc_program::model::{CodeBlock, Passing, Width};

use crate::plan::{self, Plan};

/// The entry of `block`, whose function is `function`.
pub fn lower_entry(plan: &Plan<'_>, block: &CodeBlock, function: FuncId) -> Function {
    let mut b = FunctionBuilder::new(format!("{}_entry", plan::function_name(block)), &[], &[]);
    let mut arguments: Vec<Value> = Vec::new();
    let (mut di, mut ar2) = (None, None);
    for &register in &plan.registers {
        let value = b.load_state(register.slot());
        match register {
            CpuRegister::Di => di = Some(value),
            CpuRegister::Ar2 => ar2 = Some(value),
            _ => {}
        }
        arguments.push(b.trunc(plan::register_type(register), value));
    }
    let refused = b.create_cold_block();
    if let (Some(di), Some(ar2)) = (di, ar2) {
        check_instance(&mut b, block, di, ar2, refused);
    }
    if block.kind == plcc_abi::image::BlockKind::Fc {
        for parameter in &block.interface.parameters {
            for _ in plan::parameter_types(parameter.passing) {
                let nowhere = match parameter.passing {
                    Passing::Elementary(Width::Bit) => layout::SCRATCH * 8,
                    Passing::Elementary(_) | Passing::Complex { .. } => layout::SCRATCH,
                    Passing::Number | Passing::Pointer | Passing::Any => 0,
                };
                arguments.push(b.i32_const(nowhere));
            }
        }
    }
    let returned = b.call(function, arguments, &plan.function_returns(block));
    for (register, value) in plan.returned_registers().zip(returned) {
        let value = b.zext(Type::I32, value);
        b.store_state(register.slot(), value);
    }
    b.ret(&[]);
    b.seal_block(refused);
    b.switch_to(refused);
    b.ret(&[]);
    b.finish()
}

/// An FB whose instance does not lie in DI at AR2 is not run: a synchronous error instead.
fn check_instance(b: &mut FunctionBuilder, block: &CodeBlock, di: Value, ar2: Value, refused: plcc_ir::Block) {
    use plcc_abi::codes::{access_area, sync};
    use plcc_abi::image::BlockKind;
    if !matches!(block.kind, BlockKind::Fb | BlockKind::Sfb) || block.interface.bytes == 0 {
        return;
    }
    let length = b.db_length(di);
    let bits = b.binary_imm(BinaryOp::And, ar2, 0x00FF_FFFF);
    let byte = b.binary_imm(BinaryOp::Lshr, bits, 3);
    let end = b.binary_imm(BinaryOp::Iadd, byte, i64::from(block.interface.bytes));
    let ok = b.icmp(IntCc::Ule, end, length);
    let (good, bad) = (b.create_block(), b.create_cold_block());
    b.branch(ok, good, bad);
    b.seal_block(good);
    b.seal_block(bad);
    b.switch_to(bad);
    let open = b.icmp_imm(IntCc::Ne, di, 0);
    let (short, none) = (b.i32_const(sync::LENGTH_READ.into()), b.i32_const(sync::DI_NUMBER.into()));
    let code = b.select(open, short, none);
    let info = b.select(open, byte, di);
    let (site, access) = (b.i32_const(0), b.i32_const(u32::from(access_area::DI)));
    // A STOP is seen by the caller at its next safepoint.
    b.call_runtime(RuntimeFn::SyncError, &[site, code, access, info]);
    b.jump(refused, &[]);
    b.switch_to(good);
}
