//! Floats that are surely numbers: converted integers and constants, and what is computed from them without coming near the
//! largest float.

use plcc_ir::analysis::ControlFlow;
use plcc_ir::entities::{Entity, EntityVec};
use plcc_ir::{BinaryOp, ConvertOp, Function, InstData, Type, UnaryOp, Value};

/// Bounds of values that are neither infinite nor invalid.
pub struct Numbers {
    /// The absolute value is at most this; infinite if nothing is known.
    bounds: EntityVec<Value, f64>,
}

impl Numbers {
    /// Walks the function once: a value that a loop carries is unknown.
    pub fn of(function: &Function) -> Numbers {
        let mut numbers = Numbers { bounds: EntityVec::new() };
        for _ in function.values.keys() {
            numbers.bounds.push(f64::INFINITY);
        }
        for &block in &ControlFlow::new(function).rpo {
            for &inst in &function.blocks[block].insts {
                let data = &function.insts[inst];
                let Some(&result) = function.results[inst].first() else { continue };
                let bound = numbers.bound(function, data, function.ty(result));
                // What was rounded on the way may lie a little above; at this distance from the largest float nothing overflows.
                let largest = match function.ty(result) {
                    Type::F32 => f64::from(f32::MAX) / 4.0,
                    Type::F64 => f64::MAX / 4.0,
                    _ => continue,
                };
                if bound <= largest {
                    numbers.bounds[result] = bound;
                }
            }
        }
        numbers
    }

    pub fn is_number(&self, function: &Function, value: Value) -> bool {
        let value = function.resolve(value);
        value.index() < self.bounds.len() && self.bounds[value].is_finite()
    }

    fn bound(&self, function: &Function, data: &InstData, ty: Type) -> f64 {
        let of = |value: Value| self.bounds[function.resolve(value)];
        match data {
            InstData::Const { bits } => match ty {
                Type::F32 => f64::from(f32::from_bits(*bits as u32)).abs(),
                _ => f64::from_bits(*bits).abs(),
            },
            InstData::Convert { op: ConvertOp::FromSint | ConvertOp::FromUint, arg } => {
                (2f64).powi(function.ty(*arg).bits() as i32)
            }
            InstData::Convert { op: ConvertOp::Fpromote | ConvertOp::Fdemote, arg } => of(*arg),
            InstData::Unary { op: UnaryOp::Fneg | UnaryOp::Fabs, arg } => of(*arg),
            InstData::Unary { op: UnaryOp::Ftrunc | UnaryOp::Ffloor | UnaryOp::Fceil | UnaryOp::Fnearest, arg } => {
                of(*arg) + 1.0
            }
            InstData::Binary { op: BinaryOp::Fadd | BinaryOp::Fsub, args: [x, y] } => of(*x) + of(*y),
            InstData::Binary { op: BinaryOp::Fmul, args: [x, y] } => {
                let product = of(*x) * of(*y);
                // 0 times infinity.
                if product.is_nan() { f64::INFINITY } else { product }
            }
            InstData::Binary { op: BinaryOp::Fdiv, args: [x, y] } => match function.constant(*y) {
                Some(bits) => {
                    let divisor = match ty {
                        Type::F32 => f64::from(f32::from_bits(bits as u32)),
                        _ => f64::from_bits(bits),
                    };
                    let quotient = of(*x) / divisor.abs();
                    if quotient.is_nan() { f64::INFINITY } else { quotient }
                }
                None => f64::INFINITY,
            },
            InstData::Select { if_true, if_false, .. } => of(*if_true).max(of(*if_false)),
            _ => f64::INFINITY,
        }
    }
}
