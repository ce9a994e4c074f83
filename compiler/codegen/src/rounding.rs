//! Rounding to integral values.
//!
//! The baseline of x86-64 has no instruction for it, and a call of the mathematics library would spill every float.
//! Adding 2^23 (2^52 for f64) to a smaller magnitude leaves no room for a fraction, so the addition itself rounds to nearest,
//! ties to even; subtracting it again is exact. The other roundings correct that result by 1. A larger magnitude has no
//! fraction. The sign is that of the operand, also of a zero.

use cranelift_codegen::ir::condcodes::FloatCC;
use cranelift_codegen::ir::{InstBuilder, Type, Value, types};
use cranelift_codegen::isa::TargetIsa;
use cranelift_frontend::FunctionBuilder;

/// Direction of rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounding {
    Up,
    Down,
    TowardsZero,
    Nearest,
}

/// True if the machine has an instruction for it.
pub fn is_native(isa: &dyn TargetIsa) -> bool {
    isa.name() != "x64" || isa.isa_flags().iter().any(|flag| flag.name == "has_sse41" && flag.as_bool() == Some(true))
}

/// Rounds with the machine's instruction.
pub fn native(b: &mut FunctionBuilder<'_>, rounding: Rounding, x: Value) -> Value {
    match rounding {
        Rounding::Up => b.ins().ceil(x),
        Rounding::Down => b.ins().floor(x),
        Rounding::TowardsZero => b.ins().trunc(x),
        Rounding::Nearest => b.ins().nearest(x),
    }
}

/// Rounds with additions and comparisons.
pub fn by_addition(b: &mut FunctionBuilder<'_>, rounding: Rounding, x: Value) -> Value {
    let ty = b.func.dfg.value_type(x);
    let magnitude = b.ins().fabs(x);
    let limit = constant(b, ty, 8_388_608.0, 4_503_599_627_370_496.0);
    let rounded = match rounding {
        Rounding::Nearest => nearest(b, limit, magnitude),
        Rounding::TowardsZero => {
            let near = nearest(b, limit, magnitude);
            corrected(b, near, FloatCC::GreaterThan, magnitude, -1.0)
        }
        Rounding::Up | Rounding::Down => {
            let near = nearest(b, limit, magnitude);
            let near = b.ins().fcopysign(near, x);
            let (beyond, step) = match rounding {
                Rounding::Up => (FloatCC::LessThan, 1.0),
                _ => (FloatCC::GreaterThan, -1.0),
            };
            corrected(b, near, beyond, x, step)
        }
    };
    let rounded = b.ins().fcopysign(rounded, x);
    let has_fraction = b.ins().fcmp(FloatCC::LessThan, magnitude, limit);
    // Changes nothing but a signalling NaN, as any arithmetic does.
    let negative_zero = constant(b, ty, -0.0, -0.0);
    let unchanged = b.ins().fadd(x, negative_zero);
    b.ins().select(has_fraction, rounded, unchanged)
}

fn nearest(b: &mut FunctionBuilder<'_>, limit: Value, magnitude: Value) -> Value {
    let sum = b.ins().fadd(magnitude, limit);
    b.ins().fsub(sum, limit)
}

/// `near + step` if `near` is `beyond` `x`.
fn corrected(b: &mut FunctionBuilder<'_>, near: Value, beyond: FloatCC, x: Value, step: f32) -> Value {
    let ty = b.func.dfg.value_type(near);
    let is_beyond = b.ins().fcmp(beyond, near, x);
    let step = constant(b, ty, step, f64::from(step));
    let stepped = b.ins().fadd(near, step);
    b.ins().select(is_beyond, stepped, near)
}

fn constant(b: &mut FunctionBuilder<'_>, ty: Type, single: f32, double: f64) -> Value {
    if ty == types::F32 { b.ins().f32const(single) } else { b.ins().f64const(double) }
}
