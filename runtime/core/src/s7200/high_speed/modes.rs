//! Counters and their modes. Source: S7-200 system manual, high-speed counter instructions.

use plcc_abi::s7200::image::CpuRow;

/// Number of an input on board: 8 × byte + bit.
pub(super) type Pin = u8;

/// Inputs that the program can count at: I0.0 to I1.7.
pub(in crate::s7200) const PINS: usize = 16;

/// The pulses that a mode counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Modes 0 to 2: direction by the control byte.
    Internal,
    /// Modes 3 to 5: direction by an input, 1 is up.
    External,
    /// Modes 6 to 8: a clock for up and one for down.
    TwoClocks,
    /// Modes 9 to 11: two clocks in quadrature.
    Quadrature,
    /// Mode 12: pulses of a pulse output.
    Output,
}

/// Inputs of a counter in a mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Inputs {
    /// Clock, clock A, or clock for up.
    pub clock: Option<Pin>,
    /// Direction, clock B, or clock for down.
    pub second: Option<Pin>,
    pub reset: Option<Pin>,
    pub start: Option<Pin>,
}

impl Inputs {
    /// All of them, one bit each.
    pub fn mask(&self) -> u16 {
        [self.clock, self.second, self.reset, self.start].into_iter().flatten().fold(0, |mask, pin| mask | bit(pin))
    }
}

/// The bit of an input in a mask.
pub(super) fn bit(pin: Pin) -> u16 {
    1u16.checked_shl(u32::from(pin)).unwrap_or(0)
}

/// The features of a counter.
pub(super) struct Row {
    pub inputs: Inputs,
    /// Bytes of special memory: status; then control at + 1, new current value at + 2, new preset value at + 6.
    pub status: u32,
    /// Events: the preset is reached, the direction changes, external reset.
    pub events: [Option<u8>; 3],
    /// Modes, one bit each.
    modes: u16,
    /// Pulse output of mode 12.
    pub output: u8,
}

const fn inputs(clock: Pin, second: Option<Pin>, reset: Option<Pin>, start: Option<Pin>) -> Inputs {
    Inputs { clock: Some(clock), second, reset, start }
}

/// 0 1 3 4 6 7 9 10
const WITHOUT_START: u16 = 0b0110_1101_1011;
const ALL_INPUTS: u16 = 0b1111_1111_1111;
const PULSES: u16 = 1 << 12;

const fn row(inputs: Inputs, status: u32, events: [Option<u8>; 3], modes: u16, output: u8) -> Row {
    Row { inputs, status, events, modes, output }
}

#[rustfmt::skip]
pub(super) const ROWS: [Row; 6] = [
    row(inputs(0, Some(1), Some(2), None),          36,  [Some(12), Some(27), Some(28)], WITHOUT_START | PULSES, 0),
    row(inputs(6, Some(7), Some(8), Some(9)),       46,  [Some(13), Some(14), Some(15)], ALL_INPUTS, 0),
    row(inputs(10, Some(11), Some(12), Some(13)),   56,  [Some(16), Some(17), Some(18)], ALL_INPUTS, 0),
    row(inputs(1, None, None, None),                136, [Some(32), None, None],         1 | PULSES, 1),
    row(inputs(3, Some(4), Some(5), None),          146, [Some(29), Some(30), Some(31)], WITHOUT_START, 0),
    row(inputs(4, None, None, None),                156, [Some(33), None, None],         1, 0),
];

/// The pulses that a mode counts; `None`: the mode does not exist.
pub(super) fn kind(mode: u32) -> Option<Kind> {
    Some(match mode {
        0..=2 => Kind::Internal,
        3..=5 => Kind::External,
        6..=8 => Kind::TwoClocks,
        9..=11 => Kind::Quadrature,
        12 => Kind::Output,
        _ => return None,
    })
}

/// Inputs that a counter uses in a mode; `None`: the counter does not have it on this CPU.
pub(super) fn inputs_of(counter: u32, mode: u32, cpu: &CpuRow) -> Option<(Kind, Inputs)> {
    let row = ROWS.get(counter as usize)?;
    let kind = kind(mode)?;
    let exists = u32::from(cpu.high_speed_counters) >> counter & 1 != 0;
    // HSC0 of a 21x has only mode 0.
    let modes = if cpu.old && counter == 0 { 1 } else { row.modes };
    if !exists || modes >> mode & 1 == 0 {
        return None;
    }
    let used = |pin: Option<Pin>, wanted: bool| pin.filter(|_| wanted);
    let all = row.inputs;
    let counting = kind != Kind::Output;
    let inputs = Inputs {
        clock: used(all.clock, counting),
        second: used(all.second, counting && kind != Kind::Internal),
        reset: used(all.reset, counting && !mode.is_multiple_of(3)),
        start: used(all.start, counting && mode % 3 == 2),
    };
    Some((kind, inputs))
}
