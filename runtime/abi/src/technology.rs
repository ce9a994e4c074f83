//! Fast counters, pulse generators and hardware interrupts of an S7-1200, as plc.toml sets them.
//!
//! Source: LAD/FBD reference for S7-1200, interrupts, pulses, fast counters.

use serde::{Deserialize, Serialize};

/// Hardware identifier before that of `Local~HSC_1`.
pub const HSC_ID: u16 = 256;
/// Hardware identifier before that of `Local~Pulse_1`.
pub const PULSE_ID: u16 = 264;
/// Event constant before that of the first hardware interrupt.
pub const EVENT_ID: u32 = 0xC000_0100;
/// Input address of HSC 1; the others follow, 4 bytes each.
pub const HSC_ADDRESS: u32 = 1000;
/// Output address of pulse generator 1; the others follow, 2 bytes each.
pub const PULSE_ADDRESS: u32 = 1000;

/// Input address of the value of fast counter `number`.
pub const fn hsc_address(number: u8) -> u32 {
    HSC_ADDRESS + 4 * (number.saturating_sub(1) as u32)
}

/// Output address of the pulse width of generator `number`.
pub const fn pulse_address(number: u8) -> u32 {
    PULSE_ADDRESS + 2 * (number.saturating_sub(1) as u32)
}

/// How a fast counter counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum CountMode {
    /// One input; the program sets the direction.
    Single,
    /// One input, and one for the direction.
    SingleExternal,
    /// One input up, one down.
    TwoPhase,
    /// A and B; 1 or 4 counts per pulse.
    Quadrature(u8),
    /// Hertz of one input.
    Frequency,
    /// Time between the edges of one input.
    Period,
}

impl CountMode {
    /// Word of plc.toml and mode.
    pub const WORDS: &'static [(&'static str, CountMode)] = &[
        ("single phase", CountMode::Single),
        ("single phase, external direction", CountMode::SingleExternal),
        ("two phase", CountMode::TwoPhase),
        ("quadrature", CountMode::Quadrature(1)),
        ("quadrature 4x", CountMode::Quadrature(4)),
        ("frequency", CountMode::Frequency),
        ("period", CountMode::Period),
    ];

    /// The direction comes from the inputs.
    pub const fn is_external(self) -> bool {
        matches!(self, CountMode::SingleExternal | CountMode::TwoPhase | CountMode::Quadrature(_))
    }

    /// It measures in periods of equal length and has no count.
    pub const fn is_measuring(self) -> bool {
        matches!(self, CountMode::Frequency | CountMode::Period)
    }

    /// Counts a pulse.
    pub const fn counts(self) -> i64 {
        match self {
            CountMode::Quadrature(counts) => counts as i64,
            CountMode::Single
            | CountMode::SingleExternal
            | CountMode::TwoPhase
            | CountMode::Frequency
            | CountMode::Period => 1,
        }
    }
}

/// A fast counter that is enabled.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FastCounter {
    /// 1..=6.
    pub number: u8,
    pub mode: CountMode,
    /// Counts down at first, in mode `Single`.
    pub down: bool,
    /// Value at the start and after an external reset.
    pub initial: i32,
    pub reference: i32,
    /// Input bit whose rising edge resets the counter.
    pub reset: Option<(u32, u8)>,
    /// Measuring period in modes `Frequency` and `Period`: 10, 100 or 1000.
    pub period_ms: u16,
}

/// A pulse generator that is enabled, as PWM.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PulseGenerator {
    /// 1..=4.
    pub number: u8,
    /// Cycle in microseconds.
    pub cycle_us: u32,
    /// Pulse width that is the whole cycle: 100, 1000, 10000 or 27648.
    pub full: u16,
    /// Pulse width in the output word at the start.
    pub initial: u16,
}

/// What raises a hardware interrupt.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum EventSource {
    Edge {
        byte: u32,
        bit: u8,
        falling: bool,
    },
    /// The value of fast counter `0` reaches its reference.
    Reference(u8),
    /// Its direction, given by inputs, changes.
    Direction(u8),
    /// Its external reset.
    Reset(u8),
}

/// A hardware interrupt. Its constant is [`EVENT_ID`] plus its place in the list, from 1.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HardwareEvent {
    pub name: String,
    pub source: EventSource,
    /// OB that it starts until ATTACH or DETACH changes it; 0: none.
    pub ob: u16,
}
