//! How functions of a module call each other and the runtime.
//!
//! Entries, which the runtime calls, are `extern "C" fn(mem: *mut u8, lbase: u32, vbase: u32)`. All other functions
//! are called by generated code only and take
//!
//! - `mem`, the memory base;
//! - `frame`, the address of their L frame, if they or a function that they call touch local data;
//! - `caller_frame`, the address of the caller's L frame, if they touch it;
//! - the parameters of the IR, an i1 as a byte 0 or 1.
//!
//! Return values travel in as many registers as the machine has for them; the others through
//! `layout::state::RETURN_VALUES`, which the caller reads at once.

use cranelift_codegen::ir::{AbiParam, Signature, types};
use cranelift_codegen::isa::{CallConv, TargetIsa};
use plcc_abi::{RuntimeFn, Type, layout};
use plcc_ir::entities::{Entity, EntityVec};
use plcc_ir::{FuncId, Function, Module};
use rustc_hash::FxHashSet;

use crate::CodegenError;
use crate::facts::Facts;

/// How a function of the module is called.
#[derive(Clone, Debug)]
pub struct FunctionAbi {
    /// The runtime calls it.
    pub entry: bool,
    /// It is given the address of its L frame.
    pub frame: bool,
    /// It is given the address of its caller's L frame.
    pub caller_frame: bool,
    pub returns: Vec<ReturnPlace>,
    pub signature: Signature,
}

/// Where a return value travels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReturnPlace {
    /// The n-th value that the machine function returns.
    Register(usize),
    /// At this offset from the memory base.
    State(u32),
}

/// Return registers of each class in the convention `Tail` where it has many, and in `Fast` everywhere.
const WIDE_RETURNS: usize = 8;
const FEW_RETURNS: usize = 2;

/// The CLIF type of a value.
pub fn clif_type(ty: Type) -> cranelift_codegen::ir::Type {
    match ty {
        Type::I1 | Type::I8 => types::I8,
        Type::I16 => types::I16,
        Type::I32 => types::I32,
        Type::I64 => types::I64,
        Type::F32 => types::F32,
        Type::F64 => types::F64,
    }
}

/// How each function of the module is called. `facts` has one row for each.
pub fn module_abi(
    module: &Module,
    facts: &[Facts],
    isa: &dyn TargetIsa,
) -> Result<EntityVec<FuncId, FunctionAbi>, CodegenError> {
    let entries: FxHashSet<FuncId> = module.entries.iter().copied().collect();
    let frames = frame_uses(facts);
    let mut abis = EntityVec::new();
    for (id, function) in module.functions.iter() {
        let entry = entries.contains(&id);
        if entry && (!function.returns.is_empty() || function.params().next().is_some()) {
            let message = "an entry takes and returns nothing".to_string();
            return Err(CodegenError::Module { function: function.name.clone(), message });
        }
        abis.push(function_abi(function, entry, frames[id], isa));
    }
    Ok(abis)
}

/// Which frames a function must be able to reach.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct FrameUse {
    own: bool,
    caller: bool,
}

/// Frames that each function touches, itself or by handing them on.
fn frame_uses(facts: &[Facts]) -> EntityVec<FuncId, FrameUse> {
    let mut uses: EntityVec<FuncId, FrameUse> = EntityVec::new();
    for facts in facts {
        uses.push(FrameUse { own: facts.own_frame, caller: facts.caller_frame });
    }
    // A callee's frame, and its caller's frame, are both reached from the frame of the function that calls it.
    loop {
        let mut changed = false;
        for (index, facts) in facts.iter().enumerate() {
            let id = FuncId::new(index);
            if !uses[id].own && facts.callees.iter().any(|&callee| uses[callee].own || uses[callee].caller) {
                uses[id].own = true;
                changed = true;
            }
        }
        if !changed {
            return uses;
        }
    }
}

fn function_abi(function: &Function, entry: bool, frames: FrameUse, isa: &dyn TargetIsa) -> FunctionAbi {
    let pointer = AbiParam::new(isa.pointer_type());
    if entry {
        let mut signature = Signature::new(isa.default_call_conv());
        signature.params.extend([pointer, AbiParam::new(types::I32), AbiParam::new(types::I32)]);
        return FunctionAbi { entry, frame: true, caller_frame: true, returns: Vec::new(), signature };
    }
    // `Tail` returns more in registers.
    let (call_conv, registers) =
        if has_wide_returns(isa) { (CallConv::Tail, WIDE_RETURNS) } else { (CallConv::Fast, FEW_RETURNS) };
    let mut signature = Signature::new(call_conv);
    signature.params.push(pointer);
    signature.params.extend(frames.own.then_some(pointer));
    signature.params.extend(frames.caller.then_some(pointer));
    signature.params.extend(function.params().map(|ty| AbiParam::new(clif_type(ty))));

    let (mut ints, mut floats, mut in_state) = (0, 0, 0);
    let mut returns = Vec::with_capacity(function.returns.len());
    for &ty in &function.returns {
        let used = if ty.is_int() { &mut ints } else { &mut floats };
        returns.push(if *used < registers {
            *used += 1;
            signature.returns.push(AbiParam::new(clif_type(ty)));
            ReturnPlace::Register(signature.returns.len() - 1)
        } else {
            in_state += 1;
            ReturnPlace::State(layout::STATE + layout::state::RETURN_VALUES + 8 * (in_state - 1))
        });
    }
    FunctionAbi { entry, frame: frames.own, caller_frame: frames.caller, returns, signature }
}

/// True if the convention `Tail` has [`WIDE_RETURNS`] return registers of each class.
fn has_wide_returns(isa: &dyn TargetIsa) -> bool {
    matches!(isa.name(), "x64" | "aarch64")
}

/// How generated code calls a runtime function.
pub fn runtime_signature(function: RuntimeFn, isa: &dyn TargetIsa) -> Signature {
    let mut signature = Signature::new(isa.default_call_conv());
    if takes_memory(function) {
        signature.params.push(AbiParam::new(isa.pointer_type()));
    }
    signature.params.extend(function.params().iter().map(|&ty| AbiParam::new(clif_type(ty))));
    signature.returns.extend(function.result().map(|ty| AbiParam::new(clif_type(ty))));
    signature
}

/// True if the memory base is before the listed parameters.
pub fn takes_memory(function: RuntimeFn) -> bool {
    function.effect() != plcc_abi::functions::Effect::Pure
}
