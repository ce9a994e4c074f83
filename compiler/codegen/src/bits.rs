//! i1 values in machine code.
//!
//! Bits of PLC memory are combined far more often than they are stored or passed on, so an i1 is kept in the form
//! that is cheapest to compute, and becomes the byte 0 or 1 only where that is needed.

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{InstBuilder, Type, Value, types};
use cranelift_frontend::FunctionBuilder;

/// An i1 as a CLIF integer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bit {
    /// 0 or 1, an i8.
    Clean(Value),
    /// In bit 0 of an i8 or i32; the other bits are anything.
    Low(Value),
    /// Bit `1` of an integer of any width, such as a byte from memory; the other bits are anything.
    Of(Value, u8),
    /// The negation of bit `1` of an integer.
    NotOf(Value, u8),
}

impl Bit {
    /// The i8 0 or 1.
    pub fn clean(self, b: &mut FunctionBuilder<'_>) -> Value {
        match self {
            Bit::Clean(value) => value,
            Bit::Low(value) => {
                let byte = as_byte(b, value);
                b.ins().band_imm_u(byte, 1)
            }
            Bit::Of(whole, bit) => {
                let low = self.low(b);
                let byte = as_byte(b, low);
                if is_highest(b, whole, bit) { byte } else { b.ins().band_imm_u(byte, 1) }
            }
            Bit::NotOf(whole, bit) => {
                let clean = Bit::Of(whole, bit).clean(b);
                b.ins().bxor_imm_u(clean, 1)
            }
        }
    }

    /// The value in bit 0 of an i8 or i32, the other bits anything.
    pub fn low(self, b: &mut FunctionBuilder<'_>) -> Value {
        match self {
            Bit::Clean(value) | Bit::Low(value) => value,
            Bit::Of(whole, bit) => {
                let shifted = if bit == 0 { whole } else { b.ins().ushr_imm_u(whole, i64::from(bit)) };
                match b.func.dfg.value_type(whole) {
                    types::I16 => b.ins().ireduce(types::I8, shifted),
                    types::I64 => b.ins().ireduce(types::I32, shifted),
                    _ => shifted,
                }
            }
            Bit::NotOf(whole, bit) => {
                let low = Bit::Of(whole, bit).low(b);
                b.ins().bxor_imm_u(low, 1)
            }
        }
    }

    /// Two bits in bit 0 of integers of the same type, the other bits anything.
    pub fn both_low(b: &mut FunctionBuilder<'_>, bits: [Bit; 2]) -> [Value; 2] {
        let [x, y] = bits.map(|bit| bit.low(b));
        if b.func.dfg.value_type(x) == b.func.dfg.value_type(y) { [x, y] } else { [as_byte(b, x), as_byte(b, y)] }
    }

    /// Not 0 if the bit is 1: for branches and selections.
    pub fn condition(self, b: &mut FunctionBuilder<'_>) -> Value {
        match self {
            Bit::Clean(value) => value,
            Bit::Low(value) => b.ins().band_imm_u(value, 1),
            Bit::Of(whole, bit) => b.ins().band_imm_u(whole, 1 << bit),
            Bit::NotOf(whole, bit) => {
                let masked = b.ins().band_imm_u(whole, 1 << bit);
                b.ins().icmp_imm_u(IntCC::Equal, masked, 0)
            }
        }
    }

    /// The value in bit `to` of an integer of type `ty`, all other bits 0.
    pub fn placed(self, b: &mut FunctionBuilder<'_>, ty: Type, to: u8) -> Value {
        let highest = u32::from(to) + 1 == ty.bits();
        match self {
            Bit::Of(whole, from) if b.func.dfg.value_type(whole) == ty => {
                let masked = b.ins().band_imm_u(whole, 1 << from);
                match from.cmp(&to) {
                    std::cmp::Ordering::Equal => masked,
                    std::cmp::Ordering::Less => b.ins().ishl_imm_u(masked, i64::from(to - from)),
                    std::cmp::Ordering::Greater => b.ins().ushr_imm_u(masked, i64::from(from - to)),
                }
            }
            _ => {
                let low = self.low(b);
                let low_type = b.func.dfg.value_type(low);
                // The shift to the highest bit drops what is above bit 0.
                let is_clean = matches!(self, Bit::Clean(_)) || highest && low_type.bits() >= ty.bits();
                let low = match low_type.bits().cmp(&ty.bits()) {
                    std::cmp::Ordering::Less => {
                        let clean = if is_clean { low } else { b.ins().band_imm_u(low, 1) };
                        b.ins().uextend(ty, clean)
                    }
                    order => {
                        let low = if order.is_gt() { b.ins().ireduce(ty, low) } else { low };
                        if is_clean { low } else { b.ins().band_imm_u(low, 1) }
                    }
                };
                if to == 0 { low } else { b.ins().ishl_imm_u(low, i64::from(to)) }
            }
        }
    }

    /// The negation.
    pub fn not(self, b: &mut FunctionBuilder<'_>) -> Bit {
        match self {
            Bit::Clean(value) => Bit::Clean(b.ins().bxor_imm_u(value, 1)),
            Bit::Low(value) => Bit::Low(b.ins().bxor_imm_u(value, 1)),
            Bit::Of(byte, bit) => Bit::NotOf(byte, bit),
            Bit::NotOf(byte, bit) => Bit::Of(byte, bit),
        }
    }
}

/// The lowest byte of an integer.
fn as_byte(b: &mut FunctionBuilder<'_>, value: Value) -> Value {
    if b.func.dfg.value_type(value) == types::I8 { value } else { b.ins().ireduce(types::I8, value) }
}

/// True if nothing is above the bit.
fn is_highest(b: &FunctionBuilder<'_>, whole: Value, bit: u8) -> bool {
    u32::from(bit) + 1 == b.func.dfg.value_type(whole).bits()
}
