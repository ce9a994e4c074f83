//! Block moves, FILL, SHRB. Source: S7-200 system manual, move, table and shift instructions.

use plcc_abi::layout;
use plcc_abi::s7200::{COUNTERS, TIMERS, error, system};

use super::{Operands, access, done, failed, set_special, sm1};
use crate::cpu::Cpu;
use crate::memory::Memory;

/// Largest count of elements: a byte.
const COUNT_MAX: u32 = 255;
/// Longest shift register.
const REGISTER_MAX: u32 = 64;

/// Sides that overlap are copied as if through a buffer.
pub(super) fn copy(cpu: &Cpu, operands: &Operands) -> u64 {
    let &Operands { a: from, b: to, c: size, d: count, .. } = operands;
    let bytes = size.min(4) * count.min(COUNT_MAX);
    let counted = (1..=COUNT_MAX).contains(&count);
    if !counted || !access::inside(cpu, from, bytes) || !access::inside(cpu, to, bytes) {
        return failed(cpu, operands, error::RANGE);
    }
    access::before(cpu, from, bytes);
    access::before(cpu, to, bytes);
    cpu.memory.copy(from, to, bytes);
    access::after_write(cpu, to, bytes);
    done()
}

pub(super) fn fill(cpu: &Cpu, operands: &Operands) -> u64 {
    let &Operands { a: value, b: to, c: count, .. } = operands;
    let bytes = 2 * count.min(COUNT_MAX);
    if !(1..=COUNT_MAX).contains(&count) || !access::inside(cpu, to, bytes) {
        return failed(cpu, operands, error::RANGE);
    }
    let mut words = [0u8; 2 * COUNT_MAX as usize];
    words.chunks_exact_mut(2).for_each(|word| word.copy_from_slice(&(value as u16).to_be_bytes()));
    access::before(cpu, to, bytes);
    cpu.memory.load(to, words.get(..bytes as usize).unwrap_or_default());
    access::after_write(cpu, to, bytes);
    done()
}

/// The bit that leaves is SM1.1, which is not an error here.
pub(super) fn shift_register(cpu: &Cpu, operands: &Operands) -> u64 {
    let &Operands { a: data, b: first, c: count, .. } = operands;
    let (length, up) = ((count as i32).unsigned_abs(), count as i32 > 0);
    if !(1..=REGISTER_MAX).contains(&length) {
        return failed(cpu, operands, error::COUNT);
    }
    let Some(register) = Register::at(cpu, first, length) else { return failed(cpu, operands, error::RANGE) };
    let (top, mask) = (length - 1, u64::MAX >> (64 - length));
    let (old, data) = (register.read(&cpu.memory), u64::from(data & 1));
    let (new, out) = if up { (old << 1 & mask | data, old >> top & 1) } else { (old >> 1 | data << top, old & 1) };
    register.write(&cpu.memory, new);
    if let Register::Bits { first, .. } = register {
        access::after_write(cpu, first / 8, (first % 8 + length).div_ceil(8));
    }
    set_special(&cpu.memory, 1, sm1::OVERFLOW, out != 0);
    done()
}

/// The position of a shift register of 1 to 64 bits.
enum Register {
    /// Consecutive bits from a bit address on.
    Bits { first: u32, length: u32 },
    /// Bits of consecutive timers or counters, one byte each.
    Bytes { first: u32, length: u32 },
}

impl Register {
    fn at(cpu: &Cpu, first: u32, length: u32) -> Option<Register> {
        let profile = &cpu.image.profile;
        for (bits, count) in
            [(system::TIMER_BITS, profile.timers.min(TIMERS)), (system::COUNTER_BITS, profile.counters.min(COUNTERS))]
        {
            let start = layout::SYSTEM + bits;
            if (start..start + count).contains(&(first / 8)) {
                let first = first / 8;
                return (first + length <= start + count).then_some(Register::Bytes { first, length });
            }
        }
        let bytes = (first % 8 + length).div_ceil(8);
        access::inside(cpu, first / 8, bytes).then_some(Register::Bits { first, length })
    }

    /// The bits, the first one lowest.
    fn read(&self, memory: &Memory) -> u64 {
        match *self {
            Register::Bits { first, length } => {
                let bytes = (first % 8 + length).div_ceil(8);
                let all =
                    (0..bytes).fold(0u128, |all, byte| all | u128::from(memory.byte(first / 8 + byte)) << (8 * byte));
                (all >> (first % 8)) as u64 & u64::MAX >> (64 - length)
            }
            Register::Bytes { first, length } => {
                (0..length).fold(0, |all, index| all | u64::from(memory.byte(first + index) & 1) << index)
            }
        }
    }

    fn write(&self, memory: &Memory, bits: u64) {
        match *self {
            Register::Bits { first, length } => {
                let mask = u128::from(u64::MAX >> (64 - length)) << (first % 8);
                let all = u128::from(bits) << (first % 8);
                for byte in 0..(first % 8 + length).div_ceil(8) {
                    let (address, mask, new) =
                        (first / 8 + byte, (mask >> (8 * byte)) as u8, (all >> (8 * byte)) as u8);
                    memory.set_byte(address, memory.byte(address) & !mask | new & mask);
                }
            }
            Register::Bytes { first, length } => {
                (0..length).for_each(|index| memory.set_byte(first + index, (bits >> index & 1) as u8));
            }
        }
    }
}
