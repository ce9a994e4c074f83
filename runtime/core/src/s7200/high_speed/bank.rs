//! The six counters and their inputs.

use plcc_abi::s7200::error;
use plcc_abi::s7200::image::CpuRow;

use super::counter::{Counter, Happening, Latched, Log};
use super::inputs::Wires;
use super::modes::{self, Kind, Pin, ROWS, bit};

/// Counters, a place each.
pub(super) const COUNTERS: usize = ROWS.len();

/// See the module comment.
#[derive(Default)]
pub(super) struct Bank {
    counters: [Option<Counter>; COUNTERS],
    pub wires: Wires,
    /// When somebody last looked.
    time: u64,
    /// Inputs that have had a train, one bit each.
    pub driven: u16,
}

/// The visible state.
pub(super) struct Look {
    pub time: u64,
    /// Levels that the driver shows.
    pub levels: u16,
    /// Pulses that each pulse output has begun.
    pub pulses: [u64; 2],
    /// [`Happening::bit`] of the events that each counter must report.
    pub wanted: [u8; COUNTERS],
}

impl Bank {
    /// RUN begins: no counter is defined. Trains continue.
    pub fn start(&mut self, time: u64, levels: u16) {
        self.counters = [None; COUNTERS];
        self.time = time;
        self.show(levels, 0);
    }

    /// Reads the levels from the driver; inputs of `ended` are 0.
    fn show(&mut self, levels: u16, ended: u16) {
        self.wires.set_levels(levels & !ended & !self.wires.driven());
    }

    /// Counts up to now. Result: events in their order; and the levels that inputs with trains have: which inputs, and which are on.
    pub fn look(&mut self, look: &Look) -> (Vec<u8>, u16, u16) {
        let time = look.time.max(self.time);
        let mut told = Vec::new();
        let ended = self.advance(look, time, &mut told);
        let driven = self.wires.driven();
        self.show(look.levels, ended);
        for ((index, counter), wanted) in (0usize..).zip(&mut self.counters).zip(look.wanted) {
            let Some(counter) = counter else { continue };
            let mut log = Log::new(wanted);
            counter.step(time, self.wires.levels(u16::MAX, time), &mut log);
            told.extend(log.told.into_iter().map(|(time, happening)| (time, index, happening)));
        }
        self.time = time;
        // Simultaneous events are in the order of their numbers, which is the order of priorities.
        told.sort_unstable_by_key(|&(time, index, happening)| (time, index, happening));
        let events = told.iter().filter_map(|&(_, index, happening)| event(index, happening)).collect();
        (events, driven | ended, self.wires.levels(driven, time))
    }

    /// Trains up to `time`. Result: inputs whose train is over.
    fn advance(&mut self, look: &Look, time: u64, told: &mut Vec<(u64, usize, Happening)>) -> u16 {
        for ((index, counter), wanted) in (0usize..).zip(&mut self.counters).zip(look.wanted) {
            let Some(counter) = counter else { continue };
            let output = ROWS.get(index).map_or(0, |row| row.output);
            let pulses = look.pulses.get(usize::from(output)).copied().unwrap_or(0);
            let mut log = Log::new(wanted);
            counter.run(&self.wires, time, pulses, &mut log);
            told.extend(log.told.into_iter().map(|(time, happening)| (time, index, happening)));
        }
        self.wires.end_trains(time)
    }

    /// The counter, if it is defined.
    pub fn counter(&self, number: u32) -> Option<&Counter> {
        self.counters.get(number as usize)?.as_ref()
    }

    pub fn counter_mut(&mut self, number: u32) -> Option<&mut Counter> {
        self.counters.get_mut(number as usize)?.as_mut()
    }

    /// Defined counters with their numbers.
    pub fn defined(&self) -> impl Iterator<Item = (usize, &Counter)> {
        (0usize..).zip(&self.counters).filter_map(|(index, counter)| Some((index, counter.as_ref()?)))
    }

    /// Inputs that counters own, one bit each.
    pub fn owned(&self) -> u16 {
        self.defined().fold(0, |mask, (_, counter)| mask | counter.inputs.mask())
    }

    /// HDEF with the control byte; `edges`: inputs with attached edge events, `look` is of now. `Err`: the non-fatal error.
    pub fn define(
        &mut self,
        (number, mode): (u32, u32),
        control: u8,
        edges: u16,
        cpu: &CpuRow,
        look: &Look,
    ) -> Result<(), u16> {
        let (kind, inputs) = modes::inputs_of(number, mode, cpu).ok_or(error::RANGE)?;
        if self.counter(number).is_some() {
            return Err(error::HDEF_REPEATED);
        }
        if inputs.mask() & (self.owned() | edges) != 0 {
            return Err(error::HSC_INPUT_TAKEN);
        }
        let levels = self.wires.levels(u16::MAX, self.time);
        let output = ROWS.get(number as usize).map_or(0, |row| row.output);
        let pulses = look.pulses.get(usize::from(output)).copied().unwrap_or(0);
        if let Some(place) = self.counters.get_mut(number as usize) {
            *place = Some(Counter::new(kind, inputs, Latched::of(control), self.time, levels, pulses));
        }
        Ok(())
    }

    /// Inputs at which pulses of counter `number` arrive: one, or both clocks of a quadrature signal. `None`: it is not defined yet. `Err`:
    /// why it does not have this inputs.
    pub fn pulse_inputs(&self, number: u32, backward: bool) -> Result<Option<(Pin, Option<Pin>)>, String> {
        let none = |why: &str| Err(format!("HSC{number} {why}"));
        let Some(counter) = self.counter(number) else { return Ok(None) };
        let (clock, second) = (counter.inputs.clock, counter.inputs.second);
        match (counter.kind, clock, second) {
            (Kind::Quadrature, Some(clock), Some(second)) => Ok(Some((clock, Some(second)))),
            (Kind::TwoClocks, _, Some(second)) if backward => Ok(Some((second, None))),
            (Kind::TwoClocks, Some(clock), _) => Ok(Some((clock, None))),
            (Kind::Internal | Kind::External, Some(clock), _) if !backward => Ok(Some((clock, None))),
            (Kind::Internal, ..) => none("gets its direction from its control byte in this mode, not from pulses"),
            (Kind::External, ..) => none("gets its direction from an input in this mode: set that input"),
            (Kind::Output, ..) => none("counts a pulse output in mode 12, not an input"),
            (Kind::TwoClocks | Kind::Quadrature, ..) => none("does not have this input"),
        }
    }

    /// When a counter next reports a requested event, or one of the inputs of `edges` has an edge of a train.
    pub fn due(&self, wanted: &[u8; COUNTERS], edges: u16) -> Option<u64> {
        let due =
            |(index, counter): (usize, &Counter)| counter.due(&self.wires, wanted.get(index).copied().unwrap_or(0));
        let edges = edges & !self.owned();
        self.defined().filter_map(due).chain(self.wires.next(edges, self.time)).min()
    }
}

/// The event of a happening.
pub(super) fn event(counter: usize, happening: Happening) -> Option<u8> {
    ROWS.get(counter)?.events.get(happening as usize).copied().flatten()
}

/// Edge events of inputs: 0 and 1 are the edges of I0.0, 6 and 7 those of I0.3.
pub(super) fn edge_inputs(is_attached: impl Fn(u8) -> bool) -> u16 {
    let attached = (0u8..4).filter(|&pin| is_attached(2 * pin) || is_attached(2 * pin + 1));
    attached.fold(0, |mask, pin| mask | bit(pin))
}
