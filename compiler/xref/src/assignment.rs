//! Which bits, timers and counters a program uses.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use crate::collect::Found;
use crate::operand::{Area, Operand};

/// Bytes of one access that are marked at most: a longer one is that of a pointer with a wrong length.
const ACCESS_BYTES_MAX: u32 = 65_536;

/// The assignment lists.
#[derive(Clone, Debug, Serialize)]
pub struct Assignment {
    /// Bytes of I, Q, M and of V, SM, S of an S7-200 that are used, in this order.
    pub bytes: Vec<ByteUse>,
    pub timers: Vec<u16>,
    pub counters: Vec<u16>,
}

/// How a byte is used.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ByteUse {
    /// `MB10`.
    pub address: String,
    /// Bits that are used by themselves, bit 0 in bit 0.
    pub bits: u8,
    /// An access of a byte, of a word, of a double word covers it.
    pub byte: bool,
    pub word: bool,
    pub dword: bool,
    /// An access of another size covers it: a text, a structure, a pointer.
    pub other: bool,
}

pub(crate) fn assignment(found: &[Found]) -> Assignment {
    let mut bytes: BTreeMap<(Area, u32), ByteUse> = BTreeMap::new();
    let (mut timers, mut counters) = (BTreeSet::new(), BTreeSet::new());
    let operands: BTreeSet<Operand> = found.iter().map(|one| one.operand).collect();
    for operand in operands {
        match operand {
            Operand::Timer(number) => {
                timers.insert(number);
            }
            Operand::Counter(number) => {
                counters.insert(number);
            }
            Operand::Memory { area, start, bits } => {
                if !matches!(area, Area::I | Area::Q | Area::M | Area::V | Area::Sm | Area::S) {
                    continue;
                }
                let last = start.saturating_add(bits.clamp(1, 8 * ACCESS_BYTES_MAX)) - 1;
                for number in start / 8..=last / 8 {
                    let byte = bytes.entry((area, number)).or_default();
                    match bits {
                        1 => byte.bits |= 1 << (start % 8),
                        8 => byte.byte = true,
                        16 => byte.word = true,
                        32 => byte.dword = true,
                        _ => byte.other = true,
                    }
                }
            }
            Operand::HighSpeedCounter(_) | Operand::Block(_) => {}
        }
    }
    let named = |((area, number), byte): ((Area, u32), ByteUse)| ByteUse {
        address: Operand::Memory { area, start: number * 8, bits: 8 }.to_string(),
        ..byte
    };
    Assignment {
        bytes: bytes.into_iter().map(named).collect(),
        timers: timers.into_iter().collect(),
        counters: counters.into_iter().collect(),
    }
}
