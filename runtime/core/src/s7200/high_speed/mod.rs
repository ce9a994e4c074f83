//! High-speed counters HSC0 to HSC5 as simulated hardware.
//!
//! They count edges of the inputs of the CPU: trains of pulses and levels from a scenario. Counting is lazy: a train
//! is a function of time, and the moment of the next event is computed, so that the event comes exactly then.
//!
//! - `modes`: the counters, their modes, inputs, events, special memory; `inputs`: levels over time.
//! - `counter`: the effect of an edge; `bank`: all counters together.
//!
//! Source: S7-200 system manual, high-speed counter instructions.

mod bank;
mod counter;
mod inputs;
mod modes;
#[cfg(test)]
mod tests;

use std::cell::{Cell, RefCell};

use plcc_abi::s7200::error;

use super::{Operands, S7200, done, failed, special};
use crate::cpu::Cpu;
use bank::{Bank, COUNTERS, Look};
use counter::Happening;
use inputs::Train;
use modes::{PINS, ROWS, bit};

/// The six counters.
#[derive(Default)]
pub struct Counters {
    /// A counter was defined or a train begun: until then there is nothing to look at.
    used: Cell<bool>,
    bank: RefCell<Bank>,
}

/// The input that gets pulses from a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PulseInput {
    /// An input on board: 8 × byte + bit.
    Input(u8),
    /// The clock inputs of a counter, by its number.
    Counter(u8),
}

impl PulseInput {
    /// The input at this bit, if counters reach it.
    pub(crate) fn input(byte: u32, bit: u8) -> Option<PulseInput> {
        let pin = byte.checked_mul(8)?.checked_add(u32::from(bit & 7))?;
        u8::try_from(pin).ok().filter(|&pin| usize::from(pin) < PINS).map(PulseInput::Input)
    }

    /// `HSC1`.
    pub(crate) fn counter(number: u8) -> Option<PulseInput> {
        (usize::from(number) < COUNTERS).then_some(PulseInput::Counter(number))
    }

    /// Bytes of inputs that it may be at.
    pub(crate) fn bytes() -> u32 {
        PINS as u32 / 8
    }
}

impl Cpu {
    /// Current value of counter `number`, as HCn reads it.
    pub(crate) fn s7200_counter(&self, number: u32) -> u32 {
        self.s7200_poll_counters();
        let Some(own) = self.s7200() else { return 0 };
        own.counters.bank.borrow().counter(number).map_or(0, |counter| counter.current as u32)
    }

    /// RUN begins: no counter is defined.
    pub(crate) fn s7200_start_counters(&self) {
        let Some(own) = self.s7200() else { return };
        own.counters.bank.borrow_mut().start(self.clock.now(), self.pin_levels());
        ROWS.iter().for_each(|row| self.memory.set_byte(special(row.status), 0));
    }

    /// When a counter next makes an event or reaches its preset.
    pub(crate) fn s7200_counters_due(&self) -> u64 {
        let Some(own) = self.s7200().filter(|own| own.counters.used.get()) else { return crate::schedule::NEVER };
        let bank = own.counters.bank.borrow();
        let wanted = self.wanted(&bank);
        let inputs = bank.due(&wanted, bank::edge_inputs(|event| self.s7200_is_attached(event)));
        // The pulse outputs drive counters of mode 12.
        let reached = Happening::Reached.bit();
        let pulses = bank.defined().filter(|&(index, _)| wanted.get(index).is_some_and(|wanted| wanted & reached != 0));
        let pulses = pulses.filter_map(|(index, counter)| {
            let output = ROWS.get(index).map_or(0, |row| row.output);
            own.pulses.time_of_pulse(output, counter.pulse_wanted()?)
        });
        inputs.into_iter().chain(pulses).min().unwrap_or(crate::schedule::NEVER)
    }

    /// Counts up to now and raises events.
    pub(crate) fn s7200_poll_counters(&self) {
        let Some(own) = self.s7200() else { return };
        self.s7200_poll_pulses();
        if !own.counters.used.get() {
            return;
        }
        let (events, shown, on) = {
            let mut bank = own.counters.bank.borrow_mut();
            let look = self.counters_look(own, &bank);
            bank.look(&look)
        };
        self.show_pins(shown, on);
        self.show_counter_status(own);
        events.into_iter().for_each(|event| self.s7200_event(event, None));
    }

    /// Whether a counter in use owns input I0.`bit` (0 to 3): it cannot raise events 0 to 7 then.
    pub(crate) fn s7200_counter_owns_input(&self, bit: u8) -> bool {
        self.s7200().is_some_and(|own| own.counters.bank.borrow().owned() & modes::bit(bit) != 0)
    }

    /// A scenario begins a train of pulses at `start`, not later than now; one that is there ends. False: the counter is not defined
    /// yet. `Err`: why it cannot be.
    pub(crate) fn s7200_begin_pulses(
        &self,
        input: PulseInput,
        start: u64,
        period: u64,
        count: u64,
        backward: bool,
    ) -> Result<bool, String> {
        let Some(own) = self.s7200() else { return Ok(true) };
        own.counters.used.set(true);
        self.s7200_poll_counters();
        let inputs = match input {
            PulseInput::Input(_) if backward => return Err("pulses at one input have no direction".to_string()),
            PulseInput::Input(pin) => Some((pin, None)),
            PulseInput::Counter(number) => own.counters.bank.borrow().pulse_inputs(number.into(), backward)?,
        };
        let Some((first, second)) = inputs else { return Ok(false) };
        // Both begin low.
        let mask = bit(first) | second.map_or(0, bit);
        own.counters.bank.borrow_mut().wires.remove(mask);
        self.show_pins(mask, 0);
        self.s7200_poll_counters();
        let bank = &mut *own.counters.bank.borrow_mut();
        bank.driven |= mask;
        match second {
            None => bank.wires.begin(first, Train::single(start, period, count)),
            Some(second) => {
                let (a, b) = Train::pair(start, period, count, backward);
                bank.wires.begin(first, a);
                bank.wires.begin(second, b);
            }
        }
        Ok(true)
    }

    /// Levels of the inputs of the CPU, as the driver shows them.
    fn pin_levels(&self) -> u16 {
        let byte = |address: u32| self.driver.read(address, 1).unwrap_or(0) as u16 & 0xFF;
        byte(1) << 8 | byte(0)
    }

    /// Lets the driver show these levels at the inputs of `mask`.
    fn show_pins(&self, mask: u16, levels: u16) {
        let old = self.pin_levels();
        let new = old & !mask | levels & mask;
        for byte in 0..2 {
            let of = |levels: u16| u32::from(levels >> (8 * byte) & 0xFF);
            if of(old) != of(new) {
                self.driver.set_input(byte, 1, of(new));
            }
        }
    }

    /// The events that each counter must report: those with an interrupt routine.
    fn wanted(&self, bank: &Bank) -> [u8; COUNTERS] {
        let mut wanted = [0; COUNTERS];
        for (index, _) in bank.defined() {
            let attached = |happening: &Happening| {
                bank::event(index, *happening).is_some_and(|event| self.s7200_is_attached(event))
            };
            let happenings = [Happening::Reached, Happening::Turned, Happening::Reset];
            let set = happenings.iter().filter(|happening| attached(happening)).fold(0, |set, one| set | one.bit());
            if let Some(place) = wanted.get_mut(index) {
                *place = set;
            }
        }
        wanted
    }

    fn counters_look(&self, own: &S7200, bank: &Bank) -> Look {
        let time = self.clock.now();
        let pulses = [own.pulses.count(0, time), own.pulses.count(1, time)];
        Look { time, levels: self.pin_levels(), pulses, wanted: self.wanted(bank) }
    }

    /// Keeps the status bytes of defined counters.
    fn show_counter_status(&self, own: &S7200) {
        for (index, counter) in own.counters.bank.borrow().defined() {
            if let Some(row) = ROWS.get(index) {
                self.memory.set_byte(special(row.status), counter.status());
            }
        }
    }
}

/// HDEF: counter `a`, mode `b`.
pub(super) fn define(cpu: &Cpu, operands: &Operands) -> u64 {
    let Some(own) = cpu.s7200() else { return 0 };
    if cpu.s7200_in_interrupt() {
        return failed(cpu, operands, error::NOT_IN_INTERRUPT);
    }
    own.counters.used.set(true);
    cpu.s7200_poll_counters();
    let edges = bank::edge_inputs(|event| cpu.s7200_is_attached(event));
    let control = ROWS.get(operands.a as usize).map_or(0, |row| cpu.memory.byte(special(row.status + 1)));
    let defined = {
        let mut bank = own.counters.bank.borrow_mut();
        let look = cpu.counters_look(own, &bank);
        bank.define((operands.a, operands.b), control, edges, &own.image.cpu, &look)
    };
    match defined {
        Ok(()) => {
            cpu.show_counter_status(own);
            done()
        }
        Err(code) => failed(cpu, operands, code),
    }
}

/// HSC: counter `a`.
pub(super) fn control(cpu: &Cpu, operands: &Operands) -> u64 {
    let Some(own) = cpu.s7200() else { return 0 };
    // Earlier pulses count with the old settings.
    cpu.s7200_poll_counters();
    let found = {
        let mut bank = own.counters.bank.borrow_mut();
        match (bank.counter_mut(operands.a), ROWS.get(operands.a as usize)) {
            (Some(counter), Some(row)) => {
                let value = |byte: u32| cpu.memory.dword(special(row.status + byte)) as i32;
                counter.control(cpu.memory.byte(special(row.status + 1)), value(2), value(6));
                true
            }
            (_, _) => false,
        }
    };
    if !found {
        return failed(cpu, operands, error::HSC_BEFORE_HDEF);
    }
    cpu.show_counter_status(own);
    cpu.rearm();
    done()
}
