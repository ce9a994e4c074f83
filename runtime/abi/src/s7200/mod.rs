//! S7-200: its own memory, operations of the runtime, and the description of a program in its image.
//!
//! V memory is DB 1. I, Q, M and L are at the same offsets as in every CPU; the areas that other families do not have are the
//! [`layout::SYSTEM`](crate::layout::SYSTEM) area, whose parts are the offsets of [`system`].

mod errors;
pub mod event;
pub mod image;
pub mod operation;

pub use errors::{error, fatal};
pub use image::{S7200Config, S7200Image};
pub use operation::{Operation, TimerKind, result};

/// Number of the DB that is V memory.
pub const V_DB: u16 = 1;
/// Number of the DB that holds string constants, after V memory; no instruction names it.
pub const CONSTANTS_DB: u16 = 2;
/// Bytes of local data of a block: L0.0 to L63.7. Source: S7-200 system manual, memory ranges.
pub const LOCAL_BYTES: u32 = 64;
/// Where analog words are in the address space of the I/O driver: AIW n at this + n, AQW n likewise among outputs.
pub const ANALOG_ADDRESS: u32 = 0x1000;
/// Levels of the logic stack.
pub const STACK_LEVELS: usize = 9;
pub const TIMERS: u32 = 256;
pub const COUNTERS: u32 = 256;
pub const HIGH_SPEED_COUNTERS: u32 = 6;
pub const ACCUMULATORS: u32 = 4;
pub const EVENTS: u32 = 34;
/// Entries that a table of ATT, FIFO, LIFO and FND may have.
pub const TABLE_ENTRIES_MAX: u32 = 100;

/// Parts of the system area, as offsets from its start; big-endian.
pub mod system {
    /// Special memory, SMB0 to SMB549.
    pub const SM: u32 = 0;
    pub const SM_BYTES: u32 = 550;
    /// SMB0 to SMB29, which the CPU alone sets. Source: S7-200 system manual, memory ranges.
    pub const SM_READ_ONLY_BYTES: u32 = 30;
    /// Sequence control relays, SB0 to SB31.
    pub const S: u32 = 0x400;
    pub const S_BYTES: u32 = 32;
    /// AC0 to AC3, a double word each.
    pub const ACCUMULATORS: u32 = 0x440;
    /// `u32`: ticks of 100 ms between the starts of the last scan and of this one, for timers of 100 ms.
    pub const TICKS_100_MS: u32 = 0x450;
    /// `u32`: nesting depth of subroutines in the running main program or interrupt routine, where the compiler cannot bound it.
    pub const CALL_DEPTH: u32 = 0x454;
    /// Copies of analog inputs for reads through a pointer.
    pub const AI: u32 = 0x500;
    /// Last values of analog outputs.
    pub const AQ: u32 = 0x580;
    pub const ANALOG_BYTES: u32 = 64;
    /// Current values of timers, one word each.
    pub const TIMER_VALUES: u32 = 0x600;
    /// Bits of timers, one byte each, 0 or 1.
    pub const TIMER_BITS: u32 = 0x800;
    /// Whether the box of a timer was last executed with its input on, one byte each, 0 or 1. Cleared with the timer.
    pub const TIMER_INPUTS: u32 = 0x900;
    /// Current values of counters, one word each.
    pub const COUNTER_VALUES: u32 = 0xA00;
    /// Bits of counters, one byte each, 0 or 1.
    pub const COUNTER_BITS: u32 = 0xC00;
    /// Edge memories, one byte each, 0 or 1: of rising edges first (1 when RUN begins), of falling ones after them (0 when RUN begins).
    pub const EDGES: u32 = 0x1000;
    pub const EDGES_MAX: u32 = 0xE000;
}

/// Area tags of pointers, the high byte; the rest is the byte offset in the area. Words of timers and counters are two bytes apart.
/// A pointer literal of another origin has another tag, and is an error.
pub mod pointer {
    pub const I: u8 = 0x01;
    pub const Q: u8 = 0x02;
    pub const M: u8 = 0x03;
    pub const SM: u8 = 0x04;
    pub const AI: u8 = 0x05;
    pub const AQ: u8 = 0x06;
    pub const V: u8 = 0x08;
    pub const S: u8 = 0x09;
    pub const T: u8 = 0x0A;
    pub const C: u8 = 0x0B;
    /// String constants of the program, read only: what a STRING parameter gets.
    pub const CONSTANT: u8 = 0x0C;
}

/// Resolution of a timer; its number decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Resolution {
    Ms1,
    Ms10,
    Ms100,
}

impl Resolution {
    /// Length of a step.
    pub const fn milliseconds(self) -> u8 {
        match self {
            Resolution::Ms1 => 1,
            Resolution::Ms10 => 10,
            Resolution::Ms100 => 100,
        }
    }
}

/// Resolution of timer `number`. Source: S7-200 system manual, timer instructions.
pub const fn timer_resolution(number: u8) -> Resolution {
    match number % 64 {
        0 if number < 128 => Resolution::Ms1,
        1..=4 if number < 128 => Resolution::Ms10,
        32 if number < 128 => Resolution::Ms1,
        33..=36 if number < 128 => Resolution::Ms10,
        _ => Resolution::Ms100,
    }
}

/// True for the numbers of TONR; the others are TON and TOF.
pub const fn is_retentive_timer(number: u8) -> bool {
    number < 32 || 64 <= number && number < 96
}
