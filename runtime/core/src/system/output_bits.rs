//! SFC 79 SET, SFC 80 RSET: N consecutive output bits, in the peripheral area and its process image.
//!
//! Source: System and standard functions, SFC 79, 80.

use plcc_abi::layout::{self, area};

use super::parameters::Call;
use super::{OK, Outcome, any, error};
use crate::cpu::Area;

/// Place of SA among the parameters.
const SA: usize = 2;

pub(super) fn set(call: &Call) -> Outcome {
    write(call, true)
}

pub(super) fn rset(call: &Call) -> Outcome {
    write(call, false)
}

fn write(call: &Call, value: bool) -> Outcome {
    // A negative number sets nothing.
    let count = u32::try_from(call.word(0) as i16).unwrap_or(0);
    let [_, _, area_code, a, b, c] = call.pointer(SA);
    let first = u32::from_be_bytes([0, a, b, c]) & 0x7_FFFF;
    if area_code != area::P {
        return error(any::code(SA, 0x25));
    }
    let (_, image_bytes) = call.cpu.area(Area::Outputs);
    let end = first + count;
    let mut bit = first;
    while bit < end {
        let (byte, from, to) = (bit >> 3, bit & 7, (end - (bit & !7)).min(8));
        let mask = (0xFFu32 >> (8 - (to - from))) << from;
        let old = if byte < image_bytes {
            u32::from(call.cpu.memory.byte(layout::Q + byte))
        } else {
            call.cpu.driver.output(byte, 1)
        };
        if call.cpu.peripheral_write(byte, 1, if value { old | mask } else { old & !mask }) {
            return error(any::code(SA, 0x43));
        }
        bit = (byte + 1) << 3;
    }
    OK
}
