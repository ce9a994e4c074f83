//! Assertions: their entries in the program image, and the calls that supply values.

use plcc_abi::RuntimeFn;
use plcc_abi::image::{AssertComparison, AssertSide, AssertType};
use plcc_ir::{BinaryOp, FunctionBuilder, Type, Value};
use plcc_model::{Compared, ComparedValue, Comparison};

/// A comparison as in the program image.
pub fn compared<S>(comparison: &Comparison<S>) -> AssertComparison {
    let side = |side: &Compared<S>| AssertSide {
        ty: side.ty,
        constant: match &side.value {
            ComparedValue::Constant(constant) => Some(constant.clone()),
            ComparedValue::Code(_) => None,
        },
    };
    let (left, right) = (side(&comparison.left), side(&comparison.right));
    AssertComparison { op: comparison.op, kind: comparison.kind, left, right }
}

/// True if code supplies the address of the value.
fn is_in_memory(ty: AssertType) -> bool {
    matches!(ty, AssertType::Dtl | AssertType::Text | AssertType::WideText)
}

/// The runtime function for a comparison whose values code has supplied, as i32 or i64 (`None`: constant), and these values.
pub fn call<S>(
    b: &mut FunctionBuilder,
    comparison: &Comparison<S>,
    sides: [Option<Value>; 2],
) -> (RuntimeFn, Vec<Value>) {
    let in_memory = [&comparison.left, &comparison.right]
        .iter()
        .any(|side| matches!(side.value, ComparedValue::Code(_)) && is_in_memory(side.ty));
    let long = in_memory || sides.iter().flatten().any(|&side| b.ty(side) == Type::I64);
    let mut values = Vec::new();
    for side in sides {
        let side = side.unwrap_or_else(|| b.i32_const(0));
        let is_long = b.ty(side) == Type::I64;
        values.push(if is_long { b.trunc(Type::I32, side) } else { side });
        if long {
            values.push(match is_long {
                true => {
                    let high = b.binary_imm(BinaryOp::Lshr, side, 32);
                    b.trunc(Type::I32, high)
                }
                false => b.i32_const(0),
            });
        }
    }
    let function = match (in_memory, long) {
        (true, _) => RuntimeFn::AssertMemory,
        (false, true) => RuntimeFn::AssertLong,
        (false, false) => RuntimeFn::Assert,
    };
    (function, values)
}
