//! Instructions that run when the stack top is 1 and that change memory only.
//!
//! `math`: arithmetic; `tables`: tables; `texts`: characters and strings; here: which instruction does what, bits, copies, conversions, logic
//! and shifts.

mod math;
mod tables;
mod texts;

use super::memory::{COUNT, Fault, Memory, Place, RANGE, Store};
use super::program::{Operand, Width};
use math::{integer_math, long_math, real_function, real_math, step};
use tables::{table_add, table_find, table_take};
pub use texts::text;
use texts::{ascii_to_hex, find, from_text, hex_to_ascii, part, set_text, to_ascii, to_text};

const ZERO: u8 = 0;
const OVERFLOW: u8 = 1;
const NEGATIVE: u8 = 2;
const BY_ZERO: u8 = 3;
const FULL: u8 = 4;
const EMPTY: u8 = 5;
const BAD_BCD: u8 = 6;
const BAD_HEX: u8 = 7;

/// Executes a box; `reset`: a timer was reset.
pub fn execute(memory: &mut Memory, op: &str, operands: &[Operand], mut reset: impl FnMut(u8)) -> Result<(), Fault> {
    match op {
        "S" | "R" | "SI" | "RI" => set_bits(memory, op, operands, &mut reset),
        "+I" | "-I" | "*I" | "/I" => integer_math(memory, op, operands, Width::Word),
        "+D" | "-D" | "*D" | "/D" => integer_math(memory, op, operands, Width::Dword),
        "MUL" | "DIV" => long_math(memory, op, operands),
        "INCB" | "DECB" => step(memory, op, operands, Width::Byte),
        "INCW" | "DECW" => step(memory, op, operands, Width::Word),
        "INCD" | "DECD" => step(memory, op, operands, Width::Dword),
        "+R" | "-R" | "*R" | "/R" => real_math(memory, op, operands),
        "SQRT" | "SIN" | "COS" | "TAN" | "LN" | "EXP" => real_function(memory, op, operands),
        "MOVB" => copy(memory, operands, Width::Byte),
        "MOVW" => copy(memory, operands, Width::Word),
        "MOVD" | "MOVR" => copy(memory, operands, Width::Dword),
        "BMB" => copy_block(memory, operands, 1),
        "BMW" => copy_block(memory, operands, 2),
        "BMD" => copy_block(memory, operands, 4),
        "SWAP" => change(memory, &operands[0], Width::Word, |value| value >> 8 | value << 8),
        "BIR" => {
            let Operand::Cell(_, _, byte) = operands[0] else { unreachable!("BIR reads an input byte") };
            let place = memory.place(&operands[1], 1)?;
            let value = memory.physical_inputs[byte as usize];
            memory.set(place, Width::Byte, value.into());
            Ok(())
        }
        "BIW" => copy(memory, operands, Width::Byte),
        "INVB" => logic_one(memory, operands, Width::Byte),
        "INVW" => logic_one(memory, operands, Width::Word),
        "INVD" => logic_one(memory, operands, Width::Dword),
        "ANDB" | "ORB" | "XORB" => logic(memory, op, operands, Width::Byte),
        "ANDW" | "ORW" | "XORW" => logic(memory, op, operands, Width::Word),
        "ANDD" | "ORD" | "XORD" => logic(memory, op, operands, Width::Dword),
        "SRB" | "SLB" | "RRB" | "RLB" => shift(memory, op, operands, Width::Byte),
        "SRW" | "SLW" | "RRW" | "RLW" => shift(memory, op, operands, Width::Word),
        "SRD" | "SLD" | "RRD" | "RLD" => shift(memory, op, operands, Width::Dword),
        "SHRB" => shift_register(memory, operands),
        "ATT" => table_add(memory, operands),
        "FIFO" | "LIFO" => table_take(memory, op, operands),
        "FILL" => fill(memory, operands),
        "FND=" | "FND<>" | "FND<" | "FND>" => table_find(memory, op, operands),
        "BTI" => convert(memory, operands, Width::Byte, Width::Word, |value| value),
        "ITD" => convert(memory, operands, Width::Word, Width::Dword, |value| value as i16 as u32),
        "DTR" => convert(memory, operands, Width::Dword, Width::Dword, |value| (value as i32 as f32).to_bits()),
        "DECO" => convert(memory, operands, Width::Byte, Width::Word, |value| 1 << (value & 15)),
        "ENCO" => convert(memory, operands, Width::Word, Width::Byte, |value| match value {
            0 => 0,
            _ => value.trailing_zeros(),
        }),
        "SEG" => convert(memory, operands, Width::Byte, Width::Byte, |value| SEGMENTS[value as usize & 15].into()),
        "ITB" => {
            narrow(memory, operands, Width::Word, Width::Byte, |value| u8::try_from(value as i16).ok().map(u32::from))
        }
        "DTI" => narrow(memory, operands, Width::Dword, Width::Word, |value| {
            i16::try_from(value as i32).ok().map(|value| value as u16 as u32)
        }),
        // Halves go away from zero, as f64::round does.
        "ROUND" => {
            narrow(memory, operands, Width::Dword, Width::Dword, |bits| dint(f64::from(f32::from_bits(bits)).round()))
        }
        "TRUNC" => {
            narrow(memory, operands, Width::Dword, Width::Dword, |bits| dint(f64::from(f32::from_bits(bits)).trunc()))
        }
        "BCDI" | "IBCD" => bcd(memory, op, operands),
        "ITA" | "DTA" => to_ascii(memory, op, operands),
        "ITS" | "DTS" => to_text(memory, op, operands),
        "ATH" => ascii_to_hex(memory, operands),
        "HTA" => hex_to_ascii(memory, operands),
        "STI" | "STD" => from_text(memory, op, operands),
        "SLEN" => {
            let length = text(memory, &operands[0])?.len();
            let place = memory.place(&operands[1], 1)?;
            memory.set(place, Width::Byte, length as u32);
            Ok(())
        }
        "SCPY" => {
            let value = text(memory, &operands[0])?;
            set_text(memory, &operands[1], &value)
        }
        "SCAT" => {
            let value = text(memory, &operands[0])?;
            let mut whole = text(memory, &operands[1])?;
            whole.extend(value);
            set_text(memory, &operands[1], &whole)
        }
        "SSCPY" => part(memory, operands),
        "SFND" | "CFND" => find(memory, op, operands),
        _ => unreachable!("{op} is not an instruction of the model"),
    }
}

const SEGMENTS: [u8; 16] =
    [0x3F, 0x06, 0x5B, 0x4F, 0x66, 0x6D, 0x7D, 0x07, 0x7F, 0x67, 0x77, 0x7C, 0x39, 0x5E, 0x79, 0x71];

fn bits(width: Width) -> u32 {
    width.bytes() * 8
}

/// The value with its sign.
fn signed(value: u32, width: Width) -> i64 {
    match width {
        Width::Byte => i64::from(value as u8),
        Width::Word => i64::from(value as i16),
        Width::Dword => i64::from(value as i32),
    }
}

fn set_bits(memory: &mut Memory, op: &str, operands: &[Operand], reset: &mut dyn FnMut(u8)) -> Result<(), Fault> {
    let count = memory.read(&operands[1], Width::Byte)?;
    let (on, most) = (op.starts_with('S'), if op.ends_with('I') { 128 } else { 255 });
    if count == 0 || count > most {
        return Err(RANGE);
    }
    match operands[0] {
        Operand::Bit(area, byte, bit) => {
            let first = byte * 8 + u32::from(bit);
            if first + count > area.bytes() * 8 {
                return Err(RANGE);
            }
            for at in first..first + count {
                memory.set_bit(&Operand::Bit(area, at / 8, (at % 8) as u8), on);
            }
        }
        Operand::Timer(first) => {
            for number in numbers(first, count)? {
                memory.timer_bits[usize::from(number)] = on;
                if !on {
                    memory.set(Place::In(Store::TimerValues, u32::from(number) * 2), Width::Word, 0);
                    reset(number);
                }
            }
        }
        Operand::Counter(first) => {
            for number in numbers(first, count)? {
                memory.counter_bits[usize::from(number)] = on;
                if !on {
                    memory.set(Place::In(Store::CounterValues, u32::from(number) * 2), Width::Word, 0);
                }
            }
        }
        _ => unreachable!("{} is not a bit", operands[0]),
    }
    Ok(())
}

fn numbers(first: u8, count: u32) -> Result<impl Iterator<Item = u8>, Fault> {
    let end = u32::from(first) + count;
    if end > 256 {
        return Err(RANGE);
    }
    Ok((u32::from(first)..end).map(|number| number as u8))
}

fn copy(memory: &mut Memory, operands: &[Operand], width: Width) -> Result<(), Fault> {
    convert(memory, operands, width, width, |value| value)
}

fn convert(
    memory: &mut Memory,
    operands: &[Operand],
    from: Width,
    to: Width,
    value: impl FnOnce(u32) -> u32,
) -> Result<(), Fault> {
    let input = memory.read(&operands[0], from)?;
    let place = memory.place(&operands[1], to.bytes())?;
    memory.set(place, to, value(input));
    Ok(())
}

/// Conversions that may not fit.
fn narrow(
    memory: &mut Memory,
    operands: &[Operand],
    from: Width,
    to: Width,
    value: impl FnOnce(u32) -> Option<u32>,
) -> Result<(), Fault> {
    let input = memory.read(&operands[0], from)?;
    let place = memory.place(&operands[1], to.bytes())?;
    let result = value(input);
    memory.set_flag(OVERFLOW, result.is_none());
    let Some(result) = result else { return Err(Fault::Eno) };
    memory.set(place, to, result);
    Ok(())
}

fn dint(value: f64) -> Option<u32> {
    (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&value).then_some(value as i32 as u32)
}

fn change(memory: &mut Memory, operand: &Operand, width: Width, value: impl FnOnce(u32) -> u32) -> Result<(), Fault> {
    let place = memory.place(operand, width.bytes())?;
    let new = value(memory.get(place, width));
    memory.set(place, width, new);
    Ok(())
}

fn copy_block(memory: &mut Memory, operands: &[Operand], size: u32) -> Result<(), Fault> {
    let bytes = memory.read(&operands[2], Width::Byte)? * size;
    if bytes == 0 {
        return Err(RANGE);
    }
    let from = memory.buffer(&operands[0], size, bytes)?;
    let to = memory.buffer(&operands[1], size, bytes)?;
    let values = memory.bytes(from, bytes);
    memory.set_bytes(to, &values);
    Ok(())
}

fn fill(memory: &mut Memory, operands: &[Operand]) -> Result<(), Fault> {
    let value = memory.read(&operands[0], Width::Word)? as u16;
    let count = memory.read(&operands[2], Width::Byte)?;
    if count == 0 {
        return Err(RANGE);
    }
    let to = memory.buffer(&operands[1], 2, count * 2)?;
    memory.set_bytes(to, &value.to_be_bytes().repeat(count as usize));
    Ok(())
}

fn logic_one(memory: &mut Memory, operands: &[Operand], width: Width) -> Result<(), Fault> {
    change(memory, &operands[0], width, |value| !value)?;
    let result = memory.read(&operands[0], width)?;
    memory.set_flag(ZERO, result == 0);
    Ok(())
}

fn logic(memory: &mut Memory, op: &str, operands: &[Operand], width: Width) -> Result<(), Fault> {
    let input = memory.read(&operands[0], width)?;
    let place = memory.place(&operands[1], width.bytes())?;
    let old = memory.get(place, width);
    let result = match &op[..1] {
        "A" => old & input,
        "O" => old | input,
        _ => old ^ input,
    };
    memory.set(place, width, result);
    memory.set_flag(ZERO, result == 0);
    Ok(())
}

/// One place at a time.
fn shift(memory: &mut Memory, op: &str, operands: &[Operand], width: Width) -> Result<(), Fault> {
    let count = memory.read(&operands[1], Width::Byte)?;
    let place = memory.place(&operands[0], width.bytes())?;
    let mut value = u64::from(memory.get(place, width));
    let rotates = op.starts_with("RR") || op.starts_with("RL");
    let left = &op[1..2] == "L";
    let size = bits(width);
    let count = if rotates { count % size } else { count.min(size) };
    let top = 1 << (size - 1);
    let mut out = None;
    for _ in 0..count {
        let bit = if left { value & top != 0 } else { value & 1 != 0 };
        value = if left { value << 1 & (top << 1).wrapping_sub(1) } else { value >> 1 };
        if rotates && bit {
            value |= if left { 1 } else { top };
        }
        out = Some(bit);
    }
    memory.set(place, width, value as u32);
    memory.set_flag(ZERO, value == 0);
    if let Some(out) = out {
        memory.set_flag(OVERFLOW, out);
    }
    Ok(())
}

fn shift_register(memory: &mut Memory, operands: &[Operand]) -> Result<(), Fault> {
    let count = memory.read(&operands[2], Width::Byte)? as u8 as i8;
    let length = u32::from(count.unsigned_abs());
    if length == 0 || length > 64 {
        return Err(COUNT);
    }
    let mut new = memory.bit(&operands[0]);
    let Operand::Bit(area, byte, bit) = operands[1] else { unreachable!("SHRB has a bit") };
    let first = byte * 8 + u32::from(bit);
    if first + length > area.bytes() * 8 {
        return Err(RANGE);
    }
    let mut order: Vec<u32> = (first..first + length).collect();
    if count < 0 {
        order.reverse();
    }
    for at in order {
        let place = Operand::Bit(area, at / 8, (at % 8) as u8);
        let old = memory.bit(&place);
        memory.set_bit(&place, new);
        new = old;
    }
    memory.set_flag(OVERFLOW, new);
    Ok(())
}

fn bcd(memory: &mut Memory, op: &str, operands: &[Operand]) -> Result<(), Fault> {
    let place = memory.place(&operands[0], 2)?;
    let value = memory.get(place, Width::Word);
    let digits = |base: u32| [0, 1, 2, 3].map(|place| value / u32::pow(base, place) % base);
    let result = if op == "BCDI" {
        let digits = digits(16);
        let legal = digits.iter().all(|&digit| digit < 10);
        legal.then(|| digits.iter().rev().fold(0, |number, digit| number * 10 + digit))
    } else {
        (value < 10_000).then(|| digits(10).iter().rev().fold(0, |number, digit| number << 4 | digit))
    };
    memory.set_flag(BAD_BCD, result.is_none());
    let Some(result) = result else { return Err(Fault::Eno) };
    memory.set(place, Width::Word, result);
    Ok(())
}
