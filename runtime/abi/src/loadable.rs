//! A program that a running process puts into its memory.
//!
//! A [`Head`], then what is mapped: a slot for the address of each runtime function and library function, which the process fills in; jumps
//! through them; at [`Head::program`] a [`LinkedProgram`](crate::linked::LinkedProgram) with everything that it leads to; code.

use crate::functions::RuntimeFn;

/// Bytes of the address of a function.
pub const SLOT_BYTES: usize = 8;
/// How a loadable program begins.
pub const MAGIC: [u8; 8] = *b"plccload";
/// Bytes of an encoded head.
pub const HEAD_BYTES: usize = 32;

/// What is in front of the mapped bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Head {
    /// Of the plcc that made it, see [`fingerprint`].
    pub fingerprint: u64,
    /// Where the `LinkedProgram` is in the mapped bytes.
    pub program: u64,
    /// Of the mapped bytes.
    pub sum: u64,
}

impl Head {
    pub fn encode(&self) -> [u8; HEAD_BYTES] {
        let mut bytes = [0; HEAD_BYTES];
        bytes[..8].copy_from_slice(&MAGIC);
        for (at, value) in [(8, self.fingerprint), (16, self.program), (24, self.sum)] {
            bytes[at..at + 8].copy_from_slice(&value.to_le_bytes());
        }
        bytes
    }

    /// The head, and the mapped bytes. `None`: it is something else, or damaged.
    pub fn decode(bytes: &[u8]) -> Option<(Head, &[u8])> {
        let (head, mapped) = bytes.split_first_chunk::<HEAD_BYTES>()?;
        let field = |at: usize| head[at..at + 8].try_into().map_or(0, u64::from_le_bytes);
        let decoded = Head { fingerprint: field(8), program: field(16), sum: field(24) };
        (head[..8] == MAGIC && decoded.sum == sum(mapped)).then_some((decoded, mapped))
    }
}

/// FNV-1a, eight bytes at a time.
pub fn sum(bytes: &[u8]) -> u64 {
    let step = |sum: u64, value: u64| (sum ^ value).wrapping_mul(0x0100_0000_01B3).rotate_left(23);
    let (words, rest) = bytes.as_chunks::<8>();
    let sum = words.iter().fold(0xCBF2_9CE4_8422_2325, |sum, word| step(sum, u64::from_le_bytes(*word)));
    rest.iter().fold(sum, |sum, &byte| step(sum, byte.into()))
}

/// What compiler and process must have in common: version, architecture, functions of the runtime, memory layout.
pub fn fingerprint() -> u64 {
    let mut text = format!("{} {}", env!("CARGO_PKG_VERSION"), std::env::consts::ARCH);
    for function in RuntimeFn::ALL {
        text += &format!(" {}{:?}{:?}", function.name(), function.params(), function.result());
    }
    text += &format!(" {:x} {:x} {:x}", crate::layout::DB_DATA, crate::layout::L, crate::layout::state::RETURN_VALUES);
    sum(text.as_bytes())
}
