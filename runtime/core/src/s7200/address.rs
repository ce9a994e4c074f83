//! Addresses of an S7-200 as a user writes them, in addition to those that all CPUs have.

use plcc_abi::layout;
use plcc_abi::s7200::{ACCUMULATORS, ANALOG_ADDRESS, V_DB, system};

use super::special::POTENTIOMETERS;
use super::{analog, special};
use crate::address::{Address, Bits, Place, Width, digits, offset, state_of_counter, state_of_timer};
use crate::cpu::Cpu;

/// Areas that only an S7-200 has. The number is that of the byte, timer, counter or accumulator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Part {
    SpecialMemory,
    /// Sequence control relays.
    Relays,
    AnalogInput,
    AnalogOutput,
    TimerBit,
    TimerValue,
    CounterBit,
    CounterValue,
    HighSpeedCounter,
    Accumulator,
}

/// Areas whose addresses always name a whole word.
const ANALOG: [(&str, Part); 8] = [
    ("AIW", Part::AnalogInput),
    ("AEW", Part::AnalogInput),
    ("AI", Part::AnalogInput),
    ("AE", Part::AnalogInput),
    ("AQW", Part::AnalogOutput),
    ("AAW", Part::AnalogOutput),
    ("AQ", Part::AnalogOutput),
    ("AA", Part::AnalogOutput),
];
/// Parts with numbers, the width that the number alone has, and the part after `.VALUE`.
const NUMBERED: [(&str, Part, Width, Option<Part>); 8] = [
    ("HC", Part::HighSpeedCounter, Width::Dword, None),
    ("HZ", Part::HighSpeedCounter, Width::Dword, None),
    ("AC", Part::Accumulator, Width::Dword, None),
    ("TX", Part::TimerBit, Width::Bit(0), None),
    ("CX", Part::CounterBit, Width::Bit(0), None),
    ("T", Part::TimerBit, Width::Bit(0), Some(Part::TimerValue)),
    ("C", Part::CounterBit, Width::Bit(0), Some(Part::CounterValue)),
    ("Z", Part::CounterBit, Width::Bit(0), Some(Part::CounterValue)),
];

/// An address that only an S7-200 has: `V100.5 VW100 DBX5.0 SM0.1 SMB28 S0.1 AIW4 AI4 AQW0 T37 T37.VALUE C5 HC1 AC0`, and German
/// ones. `text` is in upper case and has no blanks.
pub(crate) fn parse(text: &str) -> Option<Address> {
    for (prefix, part) in ANALOG {
        if let Some(number) = text.strip_prefix(prefix).and_then(digits).filter(|number| number % 2 == 0) {
            return Some(Address { place: Place::S7200(part, number), width: Width::Word });
        }
    }
    for (prefix, part, width, value) in NUMBERED {
        let Some(rest) = text.strip_prefix(prefix) else { continue };
        if let Some(number) = digits(rest) {
            return Some(Address { place: Place::S7200(part, number), width });
        }
        if let (Some(value), Some(number)) = (value, rest.strip_suffix(".VALUE").and_then(digits)) {
            return Some(Address { place: Place::S7200(value, number), width: Width::Word });
        }
    }
    let variable = |byte: u32| Place::Db(V_DB, byte);
    let of_area = |prefix: &str, place: &dyn Fn(u32) -> Place, bare_bit: bool| {
        let (byte, width) = offset(text.strip_prefix(prefix)?, bare_bit)?;
        Some(Address { place: place(byte), width }).filter(|address| address.width != Width::Lword)
    };
    of_area("SM", &|byte| Place::S7200(Part::SpecialMemory, byte), true)
        .or_else(|| of_area("S", &|byte| Place::S7200(Part::Relays, byte), true))
        .or_else(|| of_area("V", &variable, true))
        .or_else(|| of_area("DB", &variable, false))
}

impl Part {
    /// The current value next to a status bit.
    pub(crate) fn current_value(self) -> Option<Part> {
        NUMBERED.iter().filter(|(_, part, ..)| *part == self).find_map(|(.., value)| *value)
    }

    /// Whether a value can be set there from outside. `Err`: why not.
    pub(crate) fn check_settable(self, number: u32) -> Result<(), String> {
        match self {
            Part::TimerBit => Err(state_of_timer(number)),
            Part::CounterBit => Err(state_of_counter(number)),
            Part::HighSpeedCounter => Err("a high-speed counter is set by its inputs".to_string()),
            // Somebody may turn the potentiometers.
            Part::SpecialMemory if number < POTENTIOMETERS => {
                Err(format!("SMB0 to SMB{} are set by the CPU alone", POTENTIOMETERS - 1))
            }
            Part::TimerValue
            | Part::CounterValue
            | Part::SpecialMemory
            | Part::Relays
            | Part::AnalogInput
            | Part::AnalogOutput
            | Part::Accumulator => Ok(()),
        }
    }

    /// Offset from the memory base; `None`: it is not in memory.
    pub(crate) fn memory_offset(self, number: u32) -> Option<u32> {
        let at = |part: u32, bytes: u32| Some(layout::SYSTEM + part + bytes * number);
        match self {
            Part::SpecialMemory => Some(special(number)),
            Part::Relays => at(system::S, 1),
            Part::TimerBit => at(system::TIMER_BITS, 1),
            Part::TimerValue => at(system::TIMER_VALUES, 2),
            Part::CounterBit => at(system::COUNTER_BITS, 1),
            Part::CounterValue => at(system::COUNTER_VALUES, 2),
            Part::Accumulator => at(system::ACCUMULATORS, 4),
            Part::AnalogInput | Part::AnalogOutput | Part::HighSpeedCounter => None,
        }
    }
}

impl Cpu {
    /// Whether the address exists on this CPU. `Err`: the error.
    pub(crate) fn check_part(&self, part: Part, number: u32, width: Width) -> Result<(), String> {
        let Some(own) = self.s7200() else { return Err("this CPU is not an S7-200".to_string()) };
        let (cpu, profile) = (&own.image.cpu, &self.image.profile);
        let inside = |length: u32, area: &str| match number.saturating_add(width.bytes()) <= length {
            true => Ok(()),
            false => Err(format!("byte {number} is outside of {area}, which has {length} bytes")),
        };
        let exists = |exists: bool, what: &str| match exists {
            true => Ok(()),
            false => Err(format!("{what} {number} does not exist on this CPU")),
        };
        let analog = cpu.analog_bytes.min(system::ANALOG_BYTES);
        match part {
            Part::SpecialMemory => inside(cpu.sm_bytes.min(system::SM_BYTES), "the special memory"),
            Part::Relays => inside(cpu.s_bytes.min(system::S_BYTES), "the sequence control relays"),
            Part::AnalogInput => inside(analog, "the analog inputs"),
            Part::AnalogOutput => inside(analog, "the analog outputs"),
            Part::TimerBit | Part::TimerValue => exists(number < profile.timers.min(plcc_abi::s7200::TIMERS), "timer"),
            Part::CounterBit | Part::CounterValue => {
                exists(number < profile.counters.min(plcc_abi::s7200::COUNTERS), "counter")
            }
            Part::HighSpeedCounter => {
                exists(number < 8 && cpu.high_speed_counters >> number & 1 != 0, "high-speed counter")
            }
            Part::Accumulator => exists(number < ACCUMULATORS, "accumulator"),
        }
    }

    /// Reads a value that is not plain memory; `None`: it is plain memory.
    pub(crate) fn read_part(&self, part: Part, number: u32) -> Option<Bits> {
        match part {
            Part::AnalogInput => {
                let word = self.driver.read(ANALOG_ADDRESS + number, 2).unwrap_or(0);
                Some(self.forced_input(ANALOG_ADDRESS + number, 2, word).into())
            }
            Part::AnalogOutput => Some(self.driver.output(ANALOG_ADDRESS + number, 2).into()),
            Part::HighSpeedCounter => Some(self.s7200_counter(number).into()),
            Part::TimerBit | Part::TimerValue => {
                self.s7200_timer_sync(number);
                None
            }
            Part::SpecialMemory | Part::Relays | Part::CounterBit | Part::CounterValue | Part::Accumulator => None,
        }
    }

    /// Sets an analog word from outside, and brings a timer up to date whose value is about to be set. False: it is memory.
    pub(crate) fn write_part(&self, part: Part, number: u32, value: Bits) -> bool {
        match (part, self.s7200()) {
            (Part::AnalogInput, Some(own)) => {
                let word = analog::shown(&own.config, number, value as u16);
                self.driver.set_input(ANALOG_ADDRESS + number, 2, word.into());
                true
            }
            (Part::AnalogOutput, Some(_)) => {
                self.peripheral_write(ANALOG_ADDRESS + number, 2, value as u32 & 0xFFFF);
                true
            }
            (Part::TimerValue, Some(_)) => {
                self.s7200_timer_sync(number);
                false
            }
            (_, _) => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_languages() {
        let own = |part: Part, number: u32, width: Width| Some(Address { place: Place::S7200(part, number), width });
        let v = |byte: u32, width: Width| Some(Address { place: Place::Db(1, byte), width });
        for (text, address) in [
            ("V100.5", v(100, Width::Bit(5))),
            ("VX100.5", v(100, Width::Bit(5))),
            ("VB0", v(0, Width::Byte)),
            ("VD8", v(8, Width::Dword)),
            ("DBX5.0", v(5, Width::Bit(0))),
            ("DBW6", v(6, Width::Word)),
            ("SM0.1", own(Part::SpecialMemory, 0, Width::Bit(1))),
            ("SMB28", own(Part::SpecialMemory, 28, Width::Byte)),
            ("SMD38", own(Part::SpecialMemory, 38, Width::Dword)),
            ("S31.7", own(Part::Relays, 31, Width::Bit(7))),
            ("SW2", own(Part::Relays, 2, Width::Word)),
            ("AIW4", own(Part::AnalogInput, 4, Width::Word)),
            ("AI0", own(Part::AnalogInput, 0, Width::Word)),
            ("AEW2", own(Part::AnalogInput, 2, Width::Word)),
            ("AQW0", own(Part::AnalogOutput, 0, Width::Word)),
            ("AA2", own(Part::AnalogOutput, 2, Width::Word)),
            ("T37", own(Part::TimerBit, 37, Width::Bit(0))),
            ("T37.VALUE", own(Part::TimerValue, 37, Width::Word)),
            ("C50", own(Part::CounterBit, 50, Width::Bit(0))),
            ("Z50.VALUE", own(Part::CounterValue, 50, Width::Word)),
            ("HZ1", own(Part::HighSpeedCounter, 1, Width::Dword)),
            ("AC3", own(Part::Accumulator, 3, Width::Dword)),
        ] {
            assert_eq!(parse(text), address, "{text}");
        }
        for text in ["AIW1", "V5", "VL0", "S", "SM", "T", "T37.X", "AC", "I0.0", "A0.0", "AB4", "AW4", "DB1.DBX0.0"] {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
