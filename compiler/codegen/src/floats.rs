//! Floats that are not numbers.

use cranelift_codegen::ir::condcodes::FloatCC;
use cranelift_codegen::ir::{InstBuilder, MemFlagsData, Value, types};
use cranelift_frontend::FunctionBuilder;

/// `float` if it is a number, else the float with all bits 1: a comparison as a vector gives the mask, so that the value
/// stays in its register and nothing is tested.
pub fn all_ones_if_invalid(b: &mut FunctionBuilder<'_>, float: Value) -> Value {
    let (floats, integers) = match b.func.dfg.value_type(float) {
        types::F32 => (types::F32X4, types::I32X4),
        _ => (types::F64X2, types::I64X2),
    };
    // Lanes of a vector are numbered from its lowest byte.
    let flags = MemFlagsData::new().with_endianness(cranelift_codegen::ir::Endianness::Little);
    let vector = b.ins().scalar_to_vector(floats, float);
    let mask = b.ins().fcmp(FloatCC::Unordered, vector, vector);
    let bits = b.ins().bitcast(integers, flags, vector);
    let form = b.ins().bor(bits, mask);
    let form = b.ins().bitcast(floats, flags, form);
    b.ins().extractlane(form, 0)
}

/// The bits of `float` if it is a number, else all bits 1: for values that go to memory and are compared in the meantime.
pub fn bits_or_all_ones(b: &mut FunctionBuilder<'_>, invalid: Value, float: Value) -> Value {
    let ty = if b.func.dfg.value_type(float) == types::F32 { types::I32 } else { types::I64 };
    let ones = b.ins().iconst(ty, -1);
    let bits = b.ins().bitcast(ty, MemFlagsData::new(), float);
    b.ins().select(invalid, ones, bits)
}
