//! Every pure operation on edge values against `plcc_ir::eval`.
//!
//! One function computes all results of an operation: operands are in the CPU state and results go there, so that nothing
//! is folded.

use plcc_abi::{Type, layout};
use plcc_codegen::JitProgram;
use plcc_ir::{Address, BinaryOp, ConvertOp, FloatCc, FunctionBuilder, IntCc, Region, UnaryOp, Value, eval};

use crate::harness::{self, LEVELS, MEMORY_BYTES};

/// Slots of the operands and the result in the CPU state, 8 bytes each.
const A: u32 = 0x400;
const B: u32 = 0x408;
const RESULT: u32 = 0x410;

const INTS: [Type; 4] = [Type::I8, Type::I16, Type::I32, Type::I64];
const ALL_INTS: [Type; 5] = [Type::I1, Type::I8, Type::I16, Type::I32, Type::I64];
const FLOATS: [Type; 2] = [Type::F32, Type::F64];

fn edge_values(ty: Type) -> Vec<u64> {
    let width = ty.bits();
    let mut values: Vec<u64> = match ty {
        Type::F32 => {
            [0.0f32, -0.0, 1.0, -1.0, 0.5, 1.5, 2.5, -2.5, 0.1, 3.0e9, -3.0e9, 2147483648.0, -2147483648.0, 8388607.5]
                .into_iter()
                .chain([
                    f32::MAX,
                    f32::MIN,
                    f32::MIN_POSITIVE,
                    1.0e-45,
                    f32::INFINITY,
                    f32::NEG_INFINITY,
                    f32::NAN,
                    1.0e20,
                ])
                .chain([-0.5, -0.3, 0.7, -0.7, -1.5, 3.5, 0.49999997, -8388607.5, 8388608.0, 8388609.0, 16777215.0])
                .map(|x| u64::from(x.to_bits()))
                .chain([0xFFFF_FFFF])
                .collect()
        }
        Type::F64 => {
            [0.0f64, -0.0, 1.0, -1.0, 0.5, 1.5, 2.5, -2.5, 0.1, 1.0e19, -1.0e19, 9007199254740993.0, 4503599627370495.5]
                .into_iter()
                .chain([
                    f64::MAX,
                    f64::MIN,
                    f64::MIN_POSITIVE,
                    f64::INFINITY,
                    f64::NEG_INFINITY,
                    f64::NAN,
                    3.4028235677973366e38,
                ])
                .chain([-0.5, -0.3, 0.7, -1.5, 3.5, 0.49999999999999994, -4503599627370495.5, 4503599627370497.0])
                .map(f64::to_bits)
                .collect()
        }
        _ => [
            0,
            1,
            2,
            3,
            7,
            10,
            0x55,
            0x7F,
            0x80,
            0xFF,
            0x1234,
            0x7FFF,
            0x8000,
            0x1_0000,
            0x1234_5678,
            0x7FFF_FFFF,
            0x8000_0000,
        ]
        .into_iter()
        .chain([
            0x0123_4567_89AB_CDEF,
            1 << 63,
            (1 << 63) - 1,
            u64::MAX,
            u64::MAX - 1,
            u64::from(width - 1),
            u64::from(width),
        ])
        .collect(),
    };
    values.iter_mut().for_each(|value| *value = eval::mask(ty, *value));
    values.sort_unstable();
    values.dedup();
    values
}

fn state(offset: u32) -> Address {
    Address::direct(Region::State, offset)
}

fn read(b: &mut FunctionBuilder, ty: Type, slot: u32) -> Value {
    match ty {
        Type::I1 => b.load_bit(state(slot), 0),
        _ => b.load(ty, state(slot)),
    }
}

fn write(b: &mut FunctionBuilder, value: Value) {
    match b.ty(value) {
        Type::I1 => {
            let byte = b.zext(Type::I8, value);
            b.store(state(RESULT), byte);
        }
        _ => b.store(state(RESULT), value),
    }
}

/// A NaN is one value here: its bits are defined above this level.
fn normal(ty: Type, bits: u64) -> u64 {
    match ty {
        Type::F32 if f32::from_bits(bits as u32).is_nan() => 0x7FC0_0000,
        Type::F64 if f64::from_bits(bits).is_nan() => 0x7FF8_0000_0000_0000,
        _ => bits,
    }
}

/// Checks `build` (from two operands of type `ty` to one of type `to`) against `expect` on all pairs of edge values,
/// where `expect` knows a result.
fn check(
    name: &str,
    ty: Type,
    to: Type,
    build: &dyn Fn(&mut FunctionBuilder, Value, Value) -> Value,
    expect: &dyn Fn(u64, u64) -> Option<u64>,
) {
    let module = harness::entry(|b| {
        let x = read(b, ty, A);
        let y = read(b, ty, B);
        let result = build(b, x, y);
        assert_eq!(b.ty(result), to);
        write(b, result);
    });
    for options in LEVELS {
        let program = JitProgram::compile(&module, &|_| std::ptr::null(), &options).expect("it compiles");
        let mut memory = vec![0u8; MEMORY_BYTES];
        for x in edge_values(ty) {
            for y in edge_values(ty) {
                let Some(expected) = expect(x, y) else { continue };
                // The bits next to a narrow operand must not matter.
                memory[A as usize..RESULT as usize + 8].fill(0xA5);
                for (slot, value) in [(A, x), (B, y)] {
                    let width = ty.bytes() as usize;
                    let bits = if ty == Type::I1 { value | 0xA4 } else { value };
                    memory[slot as usize..slot as usize + width].copy_from_slice(&bits.to_le_bytes()[..width]);
                }
                // SAFETY: the memory covers the CPU state, which is all that the function touches.
                unsafe { program.entry(0)(memory.as_mut_ptr(), layout::L, layout::L) };
                let result = harness::read_state(&memory, RESULT, to.bytes() as usize);
                let (result, expected) = (normal(to, result), normal(to, expected));
                assert_eq!(result, expected, "{name}.{} of {x:#x} and {y:#x}, {options:?}", ty.name());
            }
        }
    }
}

#[test]
fn unary_operations() {
    for &op in UnaryOp::ALL {
        let types: &[Type] = match op {
            UnaryOp::Bswap => &INTS,
            UnaryOp::Ctz => &[Type::I32, Type::I64],
            _ => &FLOATS,
        };
        for &ty in types {
            check(op.name(), ty, ty, &|b, x, _| b.unary(op, x), &|x, _| Some(eval::unary(op, ty, x)));
        }
    }
}

#[test]
fn binary_operations() {
    for &op in BinaryOp::ALL {
        let is_float = matches!(op, BinaryOp::Fadd | BinaryOp::Fsub | BinaryOp::Fmul | BinaryOp::Fdiv);
        let is_logic = matches!(op, BinaryOp::And | BinaryOp::Or | BinaryOp::Xor);
        let types: &[Type] = match (is_float, is_logic) {
            (true, _) => &FLOATS,
            (false, true) => &ALL_INTS,
            (false, false) => &INTS,
        };
        for &ty in types {
            check(op.name(), ty, ty, &|b, x, y| b.binary(op, x, y), &|x, y| eval::binary(op, ty, x, y));
        }
    }
}

#[test]
fn operations_with_a_constant() {
    for &op in BinaryOp::ALL {
        if matches!(op, BinaryOp::Fadd | BinaryOp::Fsub | BinaryOp::Fmul | BinaryOp::Fdiv) {
            continue;
        }
        for ty in INTS {
            for c in edge_values(ty) {
                if matches!(op, BinaryOp::Sdiv | BinaryOp::Srem | BinaryOp::Udiv | BinaryOp::Urem)
                    && eval::binary(op, ty, 1 << (ty.bits() - 1), c).is_none()
                {
                    continue;
                }
                let build = |b: &mut FunctionBuilder, x, _| {
                    let c = b.iconst(ty, c as i64);
                    b.binary(op, x, c)
                };
                check(op.name(), ty, ty, &build, &|x, y| if y == 0 { eval::binary(op, ty, x, c) } else { None });
            }
        }
    }
}

#[test]
fn comparisons() {
    for &cc in IntCc::ALL {
        let types: &[Type] = if matches!(cc, IntCc::Eq | IntCc::Ne) { &ALL_INTS } else { &INTS };
        for &ty in types {
            check(cc.name(), ty, Type::I1, &|b, x, y| b.icmp(cc, x, y), &|x, y| {
                Some(u64::from(eval::int_compare(cc, ty, x, y)))
            });
        }
    }
    for &cc in FloatCc::ALL {
        for ty in FLOATS {
            check(cc.name(), ty, Type::I1, &|b, x, y| b.fcmp(cc, x, y), &|x, y| {
                Some(u64::from(eval::float_compare(cc, ty, x, y)))
            });
        }
    }
}

#[test]
fn conversions() {
    for &op in ConvertOp::ALL {
        for from in ALL_INTS.into_iter().chain(FLOATS) {
            for to in ALL_INTS.into_iter().chain(FLOATS) {
                let fits = match op {
                    ConvertOp::Zext | ConvertOp::Sext => from.is_int() && to.is_int() && from.bits() < to.bits(),
                    ConvertOp::Trunc => from.is_int() && to.is_int() && from.bits() > to.bits(),
                    ConvertOp::Bitcast => from.is_int() != to.is_int() && from.bits() == to.bits(),
                    ConvertOp::FromSint | ConvertOp::FromUint => matches!(from, Type::I32 | Type::I64) && !to.is_int(),
                    ConvertOp::ToSint | ConvertOp::ToUint => !from.is_int() && matches!(to, Type::I32 | Type::I64),
                    ConvertOp::Fpromote => from == Type::F32 && to == Type::F64,
                    ConvertOp::Fdemote => from == Type::F64 && to == Type::F32,
                };
                if fits {
                    check(op.name(), from, to, &|b, x, _| b.convert(op, to, x), &|x, y| {
                        (y == 0).then(|| eval::convert(op, from, to, x))
                    });
                }
            }
        }
    }
}

#[test]
fn selections() {
    for ty in ALL_INTS.into_iter().chain(FLOATS) {
        let build = |b: &mut FunctionBuilder, x, y| {
            let cond = b.load_bit(state(A), 1);
            let cond = b.not(cond);
            b.select(cond, x, y)
        };
        // Bit 1 of an i1's byte is left 0 by the test.
        check("select", ty, ty, &build, &|x, y| Some(if ty != Type::I1 && x & 2 != 0 { y } else { x }));
    }
}
