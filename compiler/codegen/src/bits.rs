//! i1 values in machine code.
//!
//! Bits of PLC memory are combined far more often than they are stored or passed on, so an i1 is kept in the form in
//! which it comes cheapest and brought into the byte 0 or 1 only where that is needed.

use cranelift_codegen::ir::condcodes::IntCC;
use cranelift_codegen::ir::{InstBuilder, Value};
use cranelift_frontend::FunctionBuilder;

/// An i1 as a CLIF value of type i8.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bit {
    /// 0 or 1.
    Clean(Value),
    /// In bit 0; the other bits are anything.
    Low(Value),
    /// Bit `1` of a byte from memory; the other bits are anything.
    Of(Value, u8),
    /// The negation of bit `1` of a byte from memory.
    NotOf(Value, u8),
}

impl Bit {
    /// 0 or 1.
    pub fn clean(self, b: &mut FunctionBuilder<'_>) -> Value {
        match self {
            Bit::Clean(value) => value,
            Bit::Low(value) => b.ins().band_imm_u(value, 1),
            Bit::Of(byte, 7) => b.ins().ushr_imm_u(byte, 7),
            Bit::Of(byte, bit) => {
                let low = shifted_down(b, byte, bit);
                b.ins().band_imm_u(low, 1)
            }
            Bit::NotOf(byte, bit) => {
                let clean = Bit::Of(byte, bit).clean(b);
                b.ins().bxor_imm_u(clean, 1)
            }
        }
    }

    /// The value in bit 0, the other bits anything.
    pub fn low(self, b: &mut FunctionBuilder<'_>) -> Value {
        match self {
            Bit::Clean(value) | Bit::Low(value) => value,
            Bit::Of(byte, bit) => shifted_down(b, byte, bit),
            Bit::NotOf(byte, bit) => {
                let low = shifted_down(b, byte, bit);
                b.ins().bxor_imm_u(low, 1)
            }
        }
    }

    /// Not 0 if the bit is 1: for branches and selections.
    pub fn condition(self, b: &mut FunctionBuilder<'_>) -> Value {
        match self {
            Bit::Clean(value) => value,
            Bit::Low(value) => b.ins().band_imm_u(value, 1),
            Bit::Of(byte, bit) => b.ins().band_imm_u(byte, 1 << bit),
            Bit::NotOf(byte, bit) => {
                let masked = b.ins().band_imm_u(byte, 1 << bit);
                b.ins().icmp_imm_u(IntCC::Equal, masked, 0)
            }
        }
    }

    /// The value in bit `to`, all other bits 0.
    pub fn placed(self, b: &mut FunctionBuilder<'_>, to: u8) -> Value {
        match self {
            Bit::Of(byte, from) => {
                let masked = b.ins().band_imm_u(byte, 1 << from);
                match from.cmp(&to) {
                    std::cmp::Ordering::Equal => masked,
                    std::cmp::Ordering::Less => b.ins().ishl_imm_u(masked, i64::from(to - from)),
                    std::cmp::Ordering::Greater => b.ins().ushr_imm_u(masked, i64::from(from - to)),
                }
            }
            // The shift drops what is above bit 0.
            _ if to == 7 => {
                let low = self.low(b);
                b.ins().ishl_imm_u(low, 7)
            }
            Bit::Clean(_) | Bit::Low(_) | Bit::NotOf(..) => {
                let clean = self.clean(b);
                if to == 0 { clean } else { b.ins().ishl_imm_u(clean, i64::from(to)) }
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

fn shifted_down(b: &mut FunctionBuilder<'_>, byte: Value, bit: u8) -> Value {
    if bit == 0 { byte } else { b.ins().ushr_imm_u(byte, i64::from(bit)) }
}
