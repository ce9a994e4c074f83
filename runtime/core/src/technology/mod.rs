//! Fast counters, pulse generators and hardware interrupts of an S7-1200.
//!
//! Source: LAD/FBD reference for S7-1200, interrupts, pulses, fast counters.

mod counter;

use std::cell::Cell;

use plcc_abi::image::Config;
use plcc_abi::layout;
use plcc_abi::technology::{EventSource, HSC_ID, PulseGenerator, hsc_address, pulse_address};

pub use counter::{Counter, Train};

use crate::cpu::{Area, Cpu};
use crate::events::{self, Event, StartInfo};

/// EventType of OB 40 and its like. Assumption: the numbers of a real CPU are not in our sources.
const EVENT_RISING: u8 = 0;
const EVENT_FALLING: u8 = 1;
const EVENT_REFERENCE: u8 = 2;
const EVENT_RESET: u8 = 3;
const EVENT_DIRECTION: u8 = 4;
/// IO_FLAG in the start information of OB 40: an input module.
const INPUT_MODULE: u8 = 0x54;

/// A pulse generator.
pub struct Pulse {
    pub config: PulseGenerator,
    pub enabled: Cell<bool>,
}

/// A hardware interrupt: the OB that it starts, 0 none, and the level of its input.
struct Interrupt {
    ob: Cell<u16>,
    level: Cell<bool>,
}

/// The technology functions of the CPU.
pub struct Technology {
    pub(crate) counters: Vec<Counter>,
    pub(crate) pulses: Vec<Pulse>,
    interrupts: Vec<Interrupt>,
}

impl Technology {
    pub(crate) fn new(config: &Config) -> Technology {
        Technology {
            counters: config.fast_counters.iter().map(Counter::new).collect(),
            pulses: config
                .pulse_generators
                .iter()
                .map(|config| Pulse { config: config.clone(), enabled: Cell::new(false) })
                .collect(),
            interrupts: config
                .hardware_events
                .iter()
                .map(|event| Interrupt { ob: Cell::new(event.ob), level: Cell::new(false) })
                .collect(),
        }
    }
}

impl Technology {
    /// The CPU has neither fast counters nor hardware interrupts.
    pub(crate) fn is_unused(&self) -> bool {
        self.counters.is_empty() && self.interrupts.is_empty()
    }
}

impl Cpu {
    /// Before the startup: levels of inputs, widths of pulses.
    pub(crate) fn start_technology(&self) {
        for (event, interrupt) in self.image.config.hardware_events.iter().zip(&self.technology.interrupts) {
            if let EventSource::Edge { byte, bit, .. } = event.source {
                interrupt.level.set(self.input_level(byte, bit));
            }
        }
        for counter in &self.technology.counters {
            if let Some((byte, bit)) = counter.config.reset {
                counter.reset_level.set(self.input_level(byte, bit));
            }
        }
        for pulse in &self.technology.pulses {
            let address = pulse_address(pulse.config.number);
            self.peripheral_write(address, 2, u32::from(pulse.config.initial));
        }
    }

    fn input_level(&self, byte: u32, bit: u8) -> bool {
        self.driver.read(byte, 1).is_some_and(|value| value >> bit & 1 != 0)
    }

    /// Edges of inputs since the last look.
    #[inline]
    pub(crate) fn look_at_inputs(&self) {
        if !self.technology.is_unused() {
            self.look_at_edges();
        }
    }

    #[inline(never)]
    fn look_at_edges(&self) {
        for (index, event) in self.image.config.hardware_events.iter().enumerate() {
            let (EventSource::Edge { byte, bit, falling }, Some(interrupt)) =
                (event.source, self.technology.interrupts.get(index))
            else {
                continue;
            };
            let level = self.input_level(byte, bit);
            if interrupt.level.replace(level) != level && level != falling {
                let kind = if falling { EVENT_FALLING } else { EVENT_RISING };
                // The channel is the number of the input.
                self.raise_interrupt(index, 0, (8 * byte) as u8 + bit, kind);
            }
        }
        let now = self.clock.now();
        for counter in &self.technology.counters {
            let Some((byte, bit)) = counter.config.reset else { continue };
            let level = self.input_level(byte, bit);
            if !counter.reset_level.replace(level) && level && counter.reset(now) {
                self.raise_counter(EventSource::Reset(counter.config.number), EVENT_RESET);
            }
        }
    }

    /// Starts the interrupts of a counter's event.
    fn raise_counter(&self, source: EventSource, kind: u8) {
        let (EventSource::Reference(number) | EventSource::Direction(number) | EventSource::Reset(number)) = source
        else {
            return;
        };
        for (index, event) in self.image.config.hardware_events.iter().enumerate() {
            if event.source == source {
                self.raise_interrupt(index, HSC_ID + u16::from(number), 0, kind);
            }
        }
    }

    fn raise_interrupt(&self, index: usize, laddr: u16, channel: u8, kind: u8) {
        let Some(ob) = self.technology.interrupts.get(index).map(|interrupt| interrupt.ob.get()) else { return };
        if ob != 0 && self.schedule.in_run.get() {
            let info = StartInfo::new(0x11, events::cause(0x41, 40, ob), ob)
                .byte(5, INPUT_MODULE)
                .word(6, laddr)
                .word(8, index as u16 + 1)
                .byte(10, channel)
                .byte(11, kind);
            self.request(Event { ob, info });
        }
    }

    /// Counters that have reached their references.
    pub(crate) fn poll_counters(&self) {
        let now = self.clock.now();
        for counter in &self.technology.counters {
            if counter.reached(now) {
                self.raise_counter(EventSource::Reference(counter.config.number), EVENT_REFERENCE);
            }
        }
    }

    /// When the next counter reaches a reference that starts an OB.
    pub(crate) fn next_counter_due(&self) -> Option<u64> {
        let wanted = |counter: &&Counter| {
            let source = EventSource::Reference(counter.config.number);
            let events = self.image.config.hardware_events.iter().zip(&self.technology.interrupts);
            let mut attached = events.filter(|(event, _)| event.source == source);
            attached.any(|(_, interrupt)| interrupt.ob.get() != 0)
        };
        let now = self.clock.now();
        self.technology.counters.iter().filter(wanted).filter_map(|counter| counter.due(now)).min()
    }

    /// A train of pulses of a scenario begins at counter `index`.
    pub(crate) fn begin_pulses(&self, index: usize, period: u64, count: u64, backward: bool) {
        let Some(counter) = self.technology.counters.get(index) else { return };
        let start = self.clock.now();
        if counter.begin(Train { start, period, count, backward }) {
            self.raise_counter(EventSource::Direction(counter.config.number), EVENT_DIRECTION);
        }
    }

    /// Puts the values of the counters to their input addresses.
    #[inline]
    pub(crate) fn show_counters(&self) {
        if !self.technology.counters.is_empty() {
            self.write_counters();
        }
    }

    #[inline(never)]
    fn write_counters(&self) {
        let now = self.clock.now();
        for counter in &self.technology.counters {
            self.driver.set_input(hsc_address(counter.config.number), 4, counter.value(now) as u32);
        }
    }

    /// The value at a counter's input address; `None`: it is not such an address.
    pub(crate) fn read_counter(&self, address: u32, bytes: u32) -> Option<u32> {
        let counter = self.technology.counters.iter().find(|counter| {
            let start = hsc_address(counter.config.number);
            address >= start && address.saturating_add(bytes) <= start + 4
        })?;
        let after = hsc_address(counter.config.number) + 4 - (address + bytes);
        let value = counter.value(self.clock.now()) as u32 >> (8 * after);
        Some(if bytes >= 4 { value } else { value & ((1 << (8 * bytes)) - 1) })
    }

    /// Assigns hardware interrupt `index` to an OB, 0: to none. Result: the OB before.
    pub(crate) fn assign_interrupt(&self, index: usize, ob: u16) -> Option<u16> {
        self.technology.interrupts.get(index).map(|interrupt| interrupt.ob.replace(ob))
    }

    /// Takes all hardware interrupts off an OB. Result: whether there was one.
    pub(crate) fn release_interrupts(&self, ob: u16) -> bool {
        let mut any = false;
        for interrupt in self.technology.interrupts.iter().filter(|interrupt| interrupt.ob.get() == ob) {
            interrupt.ob.set(0);
            any = true;
        }
        any
    }

    /// Part of its cycle that pulse generator `number` is on, in percent; 0 if it is stopped.
    pub fn pulse_duty(&self, number: u8) -> f64 {
        let Some(pulse) = self.technology.pulses.iter().find(|pulse| pulse.config.number == number) else { return 0.0 };
        if !pulse.enabled.get() || self.is_stopped() {
            return 0.0;
        }
        let address = pulse_address(number);
        let (base, length) = self.area(Area::Outputs);
        debug_assert_eq!(base, layout::Q);
        let width = if address + 2 <= length { self.memory.word(base + address) } else { 0 };
        100.0 * f64::from(width.min(pulse.config.full)) / f64::from(pulse.config.full.max(1))
    }
}
