//! Addresses as a user writes them: absolute in either mnemonic set, or symbols.

use plcc_abi::ProgramImage;
use plcc_abi::layout;

use crate::cpu::{Area, Cpu};
use crate::s7200::Part;
use crate::{bcd, counters, names, s7200, timers};

/// Where a value is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Place {
    Input(u32),
    Output(u32),
    BitMemory(u32),
    PeripheralInput(u32),
    PeripheralOutput(u32),
    Db(u16, u32),
    /// Status bit of a timer.
    Timer(u32),
    /// Status bit of a counter.
    Counter(u32),
    /// Remaining time of a timer, an S5TIME.
    TimerValue(u32),
    /// Count of a counter, an INT.
    CounterValue(u32),
    /// What only an S7-200 has, with its number. V is DB 1.
    S7200(Part, u32),
}

impl Place {
    /// The beginning of its DB; another place is itself.
    pub fn start(self) -> Place {
        if let Place::Db(number, _) = self { Place::Db(number, 0) } else { self }
    }

    /// The place this many bytes further.
    pub fn offset(self, bytes: u32) -> Place {
        match self {
            Place::Input(byte) => Place::Input(byte.saturating_add(bytes)),
            Place::Output(byte) => Place::Output(byte.saturating_add(bytes)),
            Place::BitMemory(byte) => Place::BitMemory(byte.saturating_add(bytes)),
            Place::PeripheralInput(byte) => Place::PeripheralInput(byte.saturating_add(bytes)),
            Place::PeripheralOutput(byte) => Place::PeripheralOutput(byte.saturating_add(bytes)),
            Place::Db(number, byte) => Place::Db(number, byte.saturating_add(bytes)),
            Place::Timer(_) | Place::Counter(_) | Place::TimerValue(_) | Place::CounterValue(_) | Place::S7200(..) => {
                self
            }
        }
    }
}

/// How wide it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Width {
    /// A bit with its number in the byte.
    Bit(u8),
    Byte,
    Word,
    Dword,
    /// Eight bytes (LREAL, DATE_AND_TIME).
    Lword,
}

impl Width {
    /// Bytes in memory.
    pub fn bytes(self) -> u32 {
        match self {
            Width::Bit(_) | Width::Byte => 1,
            Width::Word => 2,
            Width::Dword => 4,
            Width::Lword => 8,
        }
    }

    /// Width in bits.
    pub fn bits(self) -> u32 {
        if let Width::Bit(_) = self { 1 } else { 8 * self.bytes() }
    }
}

/// An address with its width.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Address {
    pub place: Place,
    pub width: Width,
}

impl Address {
    /// Whether it is the count of an S7-300 counter.
    pub(crate) fn is_count(&self) -> bool {
        matches!(self.place, Place::CounterValue(_))
    }

    /// Whether a value can be set there from outside. `Err`: why not.
    pub fn check_settable(&self) -> Result<(), String> {
        match self.place {
            Place::Timer(number) => Err(state_of_timer(number)),
            Place::Counter(number) => Err(state_of_counter(number)),
            Place::S7200(part, number) => part.check_settable(number),
            Place::TimerValue(_)
            | Place::CounterValue(_)
            | Place::Input(_)
            | Place::Output(_)
            | Place::BitMemory(_)
            | Place::PeripheralInput(_)
            | Place::PeripheralOutput(_)
            | Place::Db(..) => Ok(()),
        }
    }

    /// Whether a timer or counter can have a value; other places can have all. `Err`: why not.
    pub fn check_value(&self, value: Bits) -> Result<(), String> {
        match self.place {
            Place::TimerValue(_) if bcd::to_int(value as u32, 3) == bcd::BAD_DIGIT || value >> 14 != 0 => {
                Err(format!("W#16#{value:04X} is not an S5TIME: its digits are decimal, its time base is 0 to 3"))
            }
            Place::CounterValue(_) if value > counters::MAX.into() => {
                Err(format!("a counter counts from 0 to {}", counters::MAX))
            }
            _ => Ok(()),
        }
    }
}

/// Why the bit of a timer is not set from outside.
pub(crate) fn state_of_timer(number: u32) -> String {
    format!("T{number} is the state of a timer, which the program alone sets; its time is T{number}.VALUE")
}

/// Why the bit of a counter is not set from outside.
pub(crate) fn state_of_counter(number: u32) -> String {
    format!("C{number} is the state of a counter, which follows from its count; set C{number}.VALUE")
}

/// Finds an address or a name (with or without quotes). `Err`: the error as a sentence.
pub fn resolve(text: &str, image: &ProgramImage) -> Result<Address, String> {
    names::find(text, image).map(|named| named.address)
}

/// An absolute address as the CPU of the program has them.
pub fn parse_for(text: &str, image: &ProgramImage) -> Option<Address> {
    let own = || {
        let compact = text.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_ascii_uppercase();
        s7200::parse_address(&compact)
    };
    image.s7200.as_ref().and_then(|_| own()).or_else(|| parse(text))
}

/// An absolute address of an S7-300 and its like: `I0.0 E0.0 QB4 AB4 MW20 MD 20 PIW256 PEW256 DB10.DBX0.1 DB10.DBD4 T5 C5 Z5`, and
/// `T5.VALUE`, `C5.VALUE`.
pub fn parse(text: &str) -> Option<Address> {
    let compact: String = text.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_ascii_uppercase();
    let text = compact.strip_prefix('%').unwrap_or(&compact);
    if let Some(rest) = text.strip_prefix("DB") {
        let (number, rest) = rest.split_once('.')?;
        let number = digits(number).and_then(|number| u16::try_from(number).ok()).filter(|&number| number != 0)?;
        let (byte, width) = offset(rest.strip_prefix("DB")?, false)?;
        return Some(Address { place: Place::Db(number, byte), width });
    }
    for (prefix, place) in [
        ("PI", Place::PeripheralInput as fn(u32) -> Place),
        ("PE", Place::PeripheralInput),
        ("PQ", Place::PeripheralOutput),
        ("PA", Place::PeripheralOutput),
        ("I", Place::Input),
        ("E", Place::Input),
        ("Q", Place::Output),
        ("A", Place::Output),
        ("M", Place::BitMemory),
    ] {
        if let Some(rest) = text.strip_prefix(prefix) {
            let (byte, width) = offset(rest, true)?;
            if prefix.len() == 2 && matches!(width, Width::Bit(_)) {
                return None;
            }
            return Some(Address { place: place(byte), width });
        }
    }
    let (text, is_value) = text.strip_suffix(".VALUE").map_or((text, false), |text| (text, true));
    let number = |prefix: char| digits(text.strip_prefix(prefix)?).filter(|&number| number < layout::TIMERS_MAX);
    let place = match (text.chars().next()?, is_value) {
        ('T', false) => Place::Timer(number('T')?),
        ('T', true) => Place::TimerValue(number('T')?),
        (letter @ ('C' | 'Z'), false) => Place::Counter(number(letter)?),
        (letter @ ('C' | 'Z'), true) => Place::CounterValue(number(letter)?),
        _ => return None,
    };
    Some(Address { place, width: if is_value { Width::Word } else { Width::Bit(0) } })
}

/// Why a text that has the form of an address is not one: a number in it is too large. `None`: it has another form.
pub(crate) fn too_large(text: &str) -> Option<String> {
    const AREAS: [&str; 9] = ["PI", "PE", "PQ", "PA", "I", "E", "Q", "A", "M"];
    let compact: String = text.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_ascii_uppercase();
    let bare = compact.strip_prefix('%').unwrap_or(&compact);
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let is_above = |number: &str, most: u32| digits(number).is_none_or(|number| number > most);
    if let Some(number) = bare.strip_prefix(['T', 'C', 'Z']).filter(|number| is_number(number)) {
        let cell = if bare.starts_with('T') { "timer" } else { "counter" };
        return is_above(number, layout::TIMERS_MAX - 1).then(|| format!("this CPU has no {cell} {number}"));
    }
    let rest = match bare.strip_prefix("DB").and_then(|rest| rest.split_once(".DB")) {
        Some((number, rest)) if is_number(number) => rest,
        Some(_) => return None,
        None => AREAS.iter().find_map(|area| bare.strip_prefix(area))?,
    };
    let (byte, bit) = match rest.strip_prefix(['B', 'W', 'D', 'L']) {
        Some(byte) => (byte, None),
        None => rest.strip_prefix('X').unwrap_or(rest).split_once('.').map(|(byte, bit)| (byte, Some(bit)))?,
    };
    match is_number(byte) && bit.is_none_or(is_number) {
        true if is_above(byte, 65_535) => Some("bytes have the numbers 0 to 65535".to_string()),
        true if bit.is_some_and(|bit| is_above(bit, 7)) => Some("a byte has the bits 0 to 7".to_string()),
        true | false => None,
    }
}

/// A decimal number of at most 6 digits.
pub(crate) fn digits(text: &str) -> Option<u32> {
    let plain = !text.is_empty() && text.len() <= 6 && text.bytes().all(|byte| byte.is_ascii_digit());
    plain.then(|| text.parse().ok()).flatten()
}

/// `0.0`, `X0.0`, `B4`, `W4`, `D4`, `L4` after the area letters. A bit without `X` only where `bare_bit`.
pub(crate) fn offset(text: &str, bare_bit: bool) -> Option<(u32, Width)> {
    let width = match text.chars().next()? {
        'B' => Width::Byte,
        'W' => Width::Word,
        'D' => Width::Dword,
        'L' => Width::Lword,
        first => {
            let rest = if first == 'X' { &text[1..] } else { text };
            if first != 'X' && !bare_bit {
                return None;
            }
            let (byte, bit) = rest.split_once('.')?;
            let bit = digits(bit).filter(|&bit| bit < 8)?;
            return Some((digits(byte).filter(|&byte| byte < 65_536)?, Width::Bit(bit as u8)));
        }
    };
    Some((digits(&text[1..]).filter(|&byte| byte < 65_536)?, width))
}

/// A value on its way in or out, right-aligned.
pub type Bits = u64;

impl Cpu {
    /// Whether the address exists on this CPU now. `Err`: the error.
    pub fn check_address(&self, address: &Address) -> Result<(), String> {
        let bytes = address.width.bytes();
        let inside = |byte: u32, length: u32, area: &str| match byte + bytes <= length {
            true => Ok(()),
            false => Err(format!("byte {byte} is outside of {area} {length} bytes")),
        };
        match address.place {
            Place::Input(byte) => inside(byte, self.area(Area::Inputs).1, "the inputs, which have"),
            Place::Output(byte) => inside(byte, self.area(Area::Outputs).1, "the outputs, which have"),
            Place::BitMemory(byte) => inside(byte, self.area(Area::BitMemory).1, "the bit memory, which has"),
            Place::PeripheralInput(byte) | Place::PeripheralOutput(byte) => {
                inside(byte, crate::io::PERIPHERAL_BYTES, "the peripheral area, which has")
            }
            Place::Db(number, byte) => match self.memory.db(number).1 {
                0 => Err(format!("DB {number} is not loaded")),
                length if self.s7200.is_some() => inside(byte, length, "the V memory, which has"),
                length => inside(byte, length, &format!("DB {number}, which has")),
            },
            Place::Timer(number) | Place::TimerValue(number) if number < self.image.profile.timers => Ok(()),
            Place::Timer(number) | Place::TimerValue(number) => {
                Err(format!("timer {number} does not exist on this CPU"))
            }
            Place::Counter(number) | Place::CounterValue(number) if number < self.image.profile.counters => Ok(()),
            Place::Counter(number) | Place::CounterValue(number) => {
                Err(format!("counter {number} does not exist on this CPU"))
            }
            Place::S7200(part, number) => self.check_part(part, number, address.width),
        }
    }

    /// Where a place is in memory; `None`: it is elsewhere.
    pub fn offset_of(&self, place: Place) -> Option<u32> {
        match place {
            Place::Input(byte) => Some(layout::I + byte),
            Place::Output(byte) => Some(layout::Q + byte),
            Place::BitMemory(byte) => Some(layout::M + byte),
            Place::Db(number, byte) => Some(self.memory.db(number).0 + byte),
            Place::S7200(part, number) => part.memory_offset(number),
            Place::PeripheralInput(_)
            | Place::PeripheralOutput(_)
            | Place::Timer(_)
            | Place::Counter(_)
            | Place::TimerValue(_)
            | Place::CounterValue(_) => None,
        }
    }

    /// Reads a value; 0 where the address does not exist.
    pub fn read(&self, address: &Address) -> Bits {
        if self.check_address(address).is_err() {
            return 0;
        }
        if let Place::S7200(part, number) = address.place
            && let Some(value) = self.read_part(part, number)
        {
            return value;
        }
        let wide = |read: &dyn Fn(u32, u32) -> u32, byte: u32| match address.width {
            Width::Lword => u64::from(read(byte, 4)) << 32 | u64::from(read(byte + 4, 4)),
            Width::Bit(_) | Width::Byte | Width::Word | Width::Dword => u64::from(read(byte, address.width.bytes())),
        };
        match address.place {
            Place::PeripheralInput(byte) => wide(&|byte, bytes| self.driver.read(byte, bytes).unwrap_or(0), byte),
            Place::PeripheralOutput(byte) => wide(&|byte, bytes| self.module_output(byte, bytes), byte),
            Place::Timer(number) => timers::scan(&self.memory, &self.clock, number).into(),
            Place::Counter(number) => (counters::value(&self.memory, number) != 0).into(),
            Place::TimerValue(number) => timers::remaining(&self.memory, &self.clock, number).into(),
            Place::CounterValue(number) => counters::value(&self.memory, number).into(),
            Place::Input(_) | Place::Output(_) | Place::BitMemory(_) | Place::Db(..) | Place::S7200(..) => {
                let offset = self.offset_of(address.place).unwrap_or(layout::SCRATCH);
                match address.width {
                    Width::Bit(bit) => self.memory.bit(offset, bit).into(),
                    Width::Byte => self.memory.byte(offset).into(),
                    Width::Word => self.memory.word(offset).into(),
                    Width::Dword => self.memory.dword(offset).into(),
                    Width::Lword => u64::from_be_bytes(self.memory.bytes(offset)),
                }
            }
        }
    }

    /// Modifies a value between the phases of a cycle: an input only in the process image, until the inputs are read again. `Err`: the error.
    pub fn modify(&self, address: &Address, value: Bits) -> Result<(), String> {
        self.check_address(address)?;
        match address.place {
            Place::Input(_) => self.write_memory(address, value),
            _ => self.write(address, value)?,
        }
        Ok(())
    }

    /// Sets a value from outside: an input goes to its module and into the process image. `Err`: the error.
    pub fn write(&self, address: &Address, value: Bits) -> Result<(), String> {
        self.check_address(address)?;
        address.check_settable()?;
        address.check_value(value)?;
        self.check_enabled(address.place)?;
        match address.place {
            Place::Timer(_) | Place::Counter(_) => {}
            Place::TimerValue(number) => timers::set_value(&self.memory, &self.clock, number, value as u16),
            Place::CounterValue(number) => counters::set_value(&self.memory, number, value as u16),
            Place::S7200(part, number) => {
                self.s7200_look_always();
                if !self.write_part(part, number, value) {
                    self.write_memory(address, value);
                }
            }
            Place::Input(byte) => {
                if let Width::Bit(_) = address.width {
                    // The other bits of the byte are the ones of the module, not those that the program has written to the image.
                    let module = self.driver.read(byte, 1).unwrap_or(0);
                    self.memory.set_byte(layout::I + byte, module as u8);
                }
                self.write_memory(address, value);
                let offset = layout::I + byte;
                for index in 0..address.width.bytes() {
                    self.driver.set_input(byte + index, 1, self.memory.byte(offset + index).into());
                }
            }
            Place::PeripheralInput(byte) => match address.width {
                Width::Lword => {
                    self.driver.set_input(byte, 4, (value >> 32) as u32);
                    self.driver.set_input(byte + 4, 4, value as u32);
                }
                width => self.driver.set_input(byte, width.bytes(), value as u32),
            },
            Place::PeripheralOutput(byte) => match address.width {
                Width::Lword => {
                    return Err("peripheral outputs can be set only as bytes, words or double words".to_string());
                }
                width => {
                    self.peripheral_write(byte, width.bytes(), value as u32);
                }
            },
            Place::Output(byte) => {
                self.write_memory(address, value);
                self.show_enabled(byte, address.width);
            }
            Place::BitMemory(_) | Place::Db(..) => self.write_memory(address, value),
        }
        Ok(())
    }

    /// The bytes of a value that has more than eight, or of a text, from its address on; 0 where they do not exist.
    pub fn read_bytes(&self, address: &Address, length: u32) -> Vec<u8> {
        let byte = |offset| Address { place: address.place.offset(offset), width: Width::Byte };
        (0..length).map(|offset| self.read(&byte(offset)) as u8).collect()
    }

    /// Sets bytes from an address on. `Err`: the error.
    pub fn write_bytes(&self, address: &Address, bytes: &[u8]) -> Result<(), String> {
        let byte = |offset| Address { place: address.place.offset(offset), width: Width::Byte };
        self.check_address(&byte(bytes.len().saturating_sub(1) as u32))?;
        (0u32..).zip(bytes).try_for_each(|(offset, &value)| self.write(&byte(offset), value.into()))
    }

    fn write_memory(&self, address: &Address, value: Bits) {
        let Some(offset) = self.offset_of(address.place) else { return };
        if let Place::Output(_) = address.place {
            self.note_outputs(u32::MAX);
        }
        match address.width {
            Width::Bit(bit) => self.memory.set_bit(offset, bit, value & 1 != 0),
            Width::Byte => self.memory.set_byte(offset, value as u8),
            Width::Word => self.memory.set_word(offset, value as u16),
            Width::Dword => self.memory.set_dword(offset, value as u32),
            Width::Lword => self.memory.set_bytes(offset, value.to_be_bytes()),
        }
    }

    /// Makes the bytes of an input address copied into the process image, from the start, with the values of its module.
    pub fn name_input(&self, address: &Address) {
        match address.place {
            Place::Input(byte) | Place::PeripheralInput(byte) => self.driver.name_input(byte, address.width.bytes()),
            Place::Output(_)
            | Place::BitMemory(_)
            | Place::PeripheralOutput(_)
            | Place::Db(..)
            | Place::Timer(_)
            | Place::Counter(_)
            | Place::TimerValue(_)
            | Place::CounterValue(_)
            | Place::S7200(..) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_mnemonic_sets() {
        let same = |a: &str, b: &str| {
            assert!(parse(a).is_some(), "{a}");
            assert_eq!(parse(a), parse(b), "{a} {b}");
        };
        same("I0.7", "E 0.7");
        same("QB4", "ab4");
        same("ID 0", "ED0");
        same("PIW256", "PEW 256");
        same("PQB1", "PAB 1");
        same("C5", "Z 5");
        same("DB10.DBX0.1", "db10.dbx 0.1");
        same("M0.0", "MX0.0");
        assert_eq!(parse("DB10.DBD4"), Some(Address { place: Place::Db(10, 4), width: Width::Dword }));
        assert_eq!(parse("T5"), Some(Address { place: Place::Timer(5), width: Width::Bit(0) }));
        assert_eq!(parse("t 5.value"), Some(Address { place: Place::TimerValue(5), width: Width::Word }));
        same("C5.VALUE", "Z5.VALUE");
    }

    #[test]
    fn numbers_of_addresses_that_are_too_large() {
        for (text, why) in [
            ("MW99999", "bytes have the numbers 0 to 65535"),
            ("%MB65536", "bytes have the numbers 0 to 65535"),
            ("pew 70000", "bytes have the numbers 0 to 65535"),
            ("DB1.DBW70000", "bytes have the numbers 0 to 65535"),
            ("M99999999999.0", "bytes have the numbers 0 to 65535"),
            ("I0.9", "a byte has the bits 0 to 7"),
            ("MX0.8", "a byte has the bits 0 to 7"),
            ("DB1.DBX0.8", "a byte has the bits 0 to 7"),
            ("T2048", "this CPU has no timer 2048"),
            ("z99999999", "this CPU has no counter 99999999"),
        ] {
            assert_eq!((parse(text), too_large(text).as_deref()), (None, Some(why)), "{text}");
        }
        for text in ["", "M", "M0", "M0.0", "MW", "MW2.9", "Motor", "DB1", "DBX.DBW70000", "T5.VALUE", "\"I0.9\""] {
            assert_eq!(too_large(text), None, "{text}");
        }
    }

    #[test]
    fn what_is_no_address() {
        for text in [
            "",
            "M",
            "M0",
            "M0.8",
            "MW",
            "MW-1",
            "DB0.DBW0",
            "DB1.W0",
            "PI0.0",
            "T",
            "T9999",
            "X0.0",
            "MWÄ",
            "Motor",
            "MW99999999999",
        ] {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
