//! Calls of the runtime that keep all registers.
//!
//! Faults and safepoints hardly ever call the runtime, but the calls are in the middle of loops: with an ordinary convention
//! nothing could stay in a floating-point register over them. So they go to a function of their own in the module, which
//! saves what the runtime may change, calls it, and leaves the result in the CPU state: the convention that keeps all
//! registers has none for results.

use cranelift_codegen::ir::{self, ExtFuncData, ExternalName, InstBuilder, Signature, UserExternalName, UserFuncName};
use cranelift_codegen::isa::{CallConv, TargetIsa};
use cranelift_frontend::{FunctionBuilder, FunctionBuilderContext};
use plcc_abi::layout::{self, state};
use plcc_abi::{RuntimeFn, Type};

use crate::abi::{clif_type, runtime_signature};
use crate::lower::Target;

/// The functions that are called with this convention.
const KEEPING: [RuntimeFn; 5] = [
    RuntimeFn::Safepoint,
    RuntimeFn::SyncError,
    RuntimeFn::LocalError,
    RuntimeFn::Stop,
    // Under the virtual clock it is not called; the code around it runs in each cycle.
    RuntimeFn::TimeTck,
];

/// Where the result is.
pub const RESULT: u32 = layout::STATE + state::KEPT_RESULT;

/// Number of these functions.
pub const COUNT: u32 = KEEPING.len() as u32;

/// The bit of [`Facts::keeping`](crate::facts::Facts) that stands for `function`; 0 if it is called like others.
pub fn bit(function: RuntimeFn) -> u8 {
    KEEPING.iter().position(|&keeping| keeping == function).map_or(0, |index| 1 << index)
}

/// The functions that these bits stand for, in their order.
pub fn of_bits(bits: u8) -> Vec<RuntimeFn> {
    KEEPING.into_iter().filter(|&function| bits & bit(function) != 0).collect()
}

/// Linker symbol of the function that calls `function`.
pub fn symbol(function: RuntimeFn) -> String {
    format!("plcc_keep_{}", function.name())
}

/// Signature of the function that calls `function`, for generated code.
pub fn signature(function: RuntimeFn, isa: &dyn TargetIsa) -> Signature {
    let mut signature = runtime_signature(function, isa);
    signature.call_conv = CallConv::PreserveAll;
    signature.returns.clear();
    signature
}

/// The function that calls `function`; `number` is its number for the linker.
pub fn function(
    target: &Target<'_>,
    function: RuntimeFn,
    number: u32,
    context: &mut FunctionBuilderContext,
) -> ir::Function {
    let name = UserFuncName::user(0, number);
    let mut clif = ir::Function::with_name_signature(name, signature(function, target.isa));
    let mut b = FunctionBuilder::new(&mut clif, context);
    let entry = b.create_block();
    b.append_block_params_for_function_params(entry);
    b.switch_to_block(entry);
    let params = b.block_params(entry).to_vec();
    let signature = b.import_signature(runtime_signature(function, target.isa));
    let callee = UserExternalName { namespace: 0, index: target.runtime_symbol(function) };
    let name = ExternalName::user(b.func.declare_imported_user_function(callee));
    let callee = ExtFuncData { name, signature, colocated: target.near_runtime, patchable: false };
    let callee = b.import_function(callee);
    let call = b.ins().call(callee, &params);
    if let Some(&result) = b.inst_results(call).first() {
        debug_assert_eq!(function.result(), Some(Type::I32));
        debug_assert_eq!(b.func.dfg.value_type(result), clif_type(Type::I32));
        b.ins().store(ir::MemFlagsData::trusted(), result, params[0], RESULT as i32);
    }
    b.ins().return_(&[]);
    b.seal_all_blocks();
    b.finalize(target.isa.frontend_config());
    clif
}
