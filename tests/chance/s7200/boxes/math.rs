//! Arithmetic with integers and with REAL.

use super::{BY_ZERO, NEGATIVE, OVERFLOW, ZERO, signed};
use crate::s7200::memory::{Fault, Memory, Place};
use crate::s7200::program::{Operand, Width};

/// Writes a result that fits, with its flags; else only the flags.
fn store_result(memory: &mut Memory, place: Place, width: Width, result: i64) -> Result<(), Fault> {
    let fits = match width {
        Width::Byte => u8::try_from(result).is_ok(),
        Width::Word => i16::try_from(result).is_ok(),
        Width::Dword => i32::try_from(result).is_ok(),
    };
    memory.set_flag(OVERFLOW, !fits);
    memory.set_flag(ZERO, fits && result == 0);
    memory.set_flag(NEGATIVE, fits && result < 0);
    if !fits {
        return Err(Fault::Eno);
    }
    memory.set(place, width, result as u32);
    Ok(())
}

pub(super) fn integer_math(memory: &mut Memory, op: &str, operands: &[Operand], width: Width) -> Result<(), Fault> {
    let input = signed(memory.read(&operands[0], width)?, width);
    let place = memory.place(&operands[1], width.bytes())?;
    let old = signed(memory.get(place, width), width);
    let result = match &op[..1] {
        "+" => old + input,
        "-" => old - input,
        "*" => old * input,
        _ => {
            memory.set_flag(BY_ZERO, input == 0);
            if input == 0 {
                return Err(Fault::Eno);
            }
            old / input
        }
    };
    store_result(memory, place, width, result)
}

pub(super) fn long_math(memory: &mut Memory, op: &str, operands: &[Operand]) -> Result<(), Fault> {
    let input = signed(memory.read(&operands[0], Width::Word)?, Width::Word);
    let place = memory.place(&operands[1], 4)?;
    let old = signed(memory.get(place, Width::Dword) & 0xFFFF, Width::Word);
    if op == "MUL" {
        return store_result(memory, place, Width::Dword, old * input);
    }
    memory.set_flag(BY_ZERO, input == 0);
    if input == 0 {
        return Err(Fault::Eno);
    }
    let (quotient, remainder) = (old / input, old % input);
    let fits = i16::try_from(quotient).is_ok();
    memory.set_flag(OVERFLOW, !fits);
    memory.set_flag(ZERO, fits && quotient == 0);
    memory.set_flag(NEGATIVE, fits && quotient < 0);
    if !fits {
        return Err(Fault::Eno);
    }
    memory.set(place, Width::Dword, (remainder as u32) << 16 | quotient as u32 & 0xFFFF);
    Ok(())
}

pub(super) fn step(memory: &mut Memory, op: &str, operands: &[Operand], width: Width) -> Result<(), Fault> {
    let place = memory.place(&operands[0], width.bytes())?;
    let old = signed(memory.get(place, width), width);
    let result = if op.starts_with("INC") { old + 1 } else { old - 1 };
    memory.set(place, width, result as u32);
    let stored = signed(memory.get(place, width), width);
    memory.set_flag(ZERO, stored == 0);
    memory.set_flag(OVERFLOW, stored != result);
    if width != Width::Byte {
        memory.set_flag(NEGATIVE, stored < 0);
    }
    if stored == result { Ok(()) } else { Err(Fault::Eno) }
}

fn store_real(memory: &mut Memory, place: Place, result: Option<f32>) -> Result<(), Fault> {
    let result = result.filter(|result| result.is_finite());
    memory.set_flag(OVERFLOW, result.is_none());
    memory.set_flag(ZERO, result.is_some_and(|result| result == 0.0));
    memory.set_flag(NEGATIVE, result.is_some_and(|result| result < 0.0));
    let Some(result) = result else { return Err(Fault::Eno) };
    memory.set(place, Width::Dword, result.to_bits());
    Ok(())
}

pub(super) fn real_math(memory: &mut Memory, op: &str, operands: &[Operand]) -> Result<(), Fault> {
    let input = f32::from_bits(memory.read(&operands[0], Width::Dword)?);
    let place = memory.place(&operands[1], 4)?;
    let old = f32::from_bits(memory.get(place, Width::Dword));
    let legal = input.is_finite() && old.is_finite();
    let result = match op {
        "+R" => old + input,
        "-R" => old - input,
        "*R" => old * input,
        _ => {
            memory.set_flag(BY_ZERO, input == 0.0);
            if input == 0.0 {
                return Err(Fault::Eno);
            }
            old / input
        }
    };
    store_real(memory, place, legal.then_some(result))
}

pub(super) fn real_function(memory: &mut Memory, op: &str, operands: &[Operand]) -> Result<(), Fault> {
    let input = f64::from(f32::from_bits(memory.read(&operands[0], Width::Dword)?));
    let place = memory.place(&operands[1], 4)?;
    let result = match op {
        "SQRT" => (input >= 0.0).then(|| input.sqrt()),
        "SIN" => Some(input.sin()),
        "COS" => Some(input.cos()),
        "TAN" => Some(input.tan()),
        "LN" => (input > 0.0).then(|| input.ln()),
        _ => Some(input.exp()),
    };
    let result = result.filter(|_| input.is_finite()).map(|result| result as f32);
    store_real(memory, place, result)
}
