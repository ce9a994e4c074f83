//! Interrupt events. Source: S7-200 system manual, priorities of interrupt events.

use super::EVENTS;

/// Groups of events, the highest priority first. A group as number is that of its queue and of its overflow bit in SMB4.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    Communication,
    InputOutput,
    Timed,
}

/// One event; its number is the place in [`TABLE`].
#[derive(Clone, Copy, Debug)]
pub struct Event {
    pub source: &'static str,
    pub group: Group,
    /// In its group, 0 first.
    pub priority: u8,
}

const fn event(source: &'static str, group: Group, priority: u8) -> Event {
    Event { source, group, priority }
}

use Group::{Communication, InputOutput, Timed};

pub const TABLE: [Event; EVENTS as usize] = [
    event("rising edge of I0.0", InputOutput, 2),
    event("falling edge of I0.0", InputOutput, 6),
    event("rising edge of I0.1", InputOutput, 3),
    event("falling edge of I0.1", InputOutput, 7),
    event("rising edge of I0.2", InputOutput, 4),
    event("falling edge of I0.2", InputOutput, 8),
    event("rising edge of I0.3", InputOutput, 5),
    event("falling edge of I0.3", InputOutput, 9),
    event("port 0: character received", Communication, 0),
    event("port 0: transmission complete", Communication, 0),
    event("timed interrupt 0, period in SMB34", Timed, 0),
    event("timed interrupt 1, period in SMB35", Timed, 1),
    event("HSC0: current value is the preset value", InputOutput, 10),
    event("HSC1: current value is the preset value", InputOutput, 13),
    event("HSC1: direction has changed", InputOutput, 14),
    event("HSC1: external reset", InputOutput, 15),
    event("HSC2: current value is the preset value", InputOutput, 16),
    event("HSC2: direction has changed", InputOutput, 17),
    event("HSC2: external reset", InputOutput, 18),
    event("Q0.0: pulse train complete", InputOutput, 0),
    event("Q0.1: pulse train complete", InputOutput, 1),
    event("T32: current value is the preset value", Timed, 2),
    event("T96: current value is the preset value", Timed, 3),
    event("port 0: message received", Communication, 0),
    event("port 1: message received", Communication, 1),
    event("port 1: character received", Communication, 1),
    event("port 1: transmission complete", Communication, 1),
    event("HSC0: direction has changed", InputOutput, 11),
    event("HSC0: external reset", InputOutput, 12),
    event("HSC4: current value is the preset value", InputOutput, 20),
    event("HSC4: direction has changed", InputOutput, 21),
    event("HSC4: external reset", InputOutput, 22),
    event("HSC3: current value is the preset value", InputOutput, 19),
    event("HSC5: current value is the preset value", InputOutput, 23),
];
