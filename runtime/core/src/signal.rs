//! Signals that a user watches and compares: an address, an analog channel in its unit, a number at an address, a value of the plant.
//!
//! | Text | Value |
//! | --- | --- |
//! | `MW20`, `Motor`, `AI0` | bits, as `--print` writes them |
//! | `AO0 in %`, `Level_Transmitter in mA` | number in a unit, by the range of the channel |
//! | `Level as REAL`, `MW10 as INT` | number |
//! | `plant.level` | number, from the plant of the scenario |
//! | `pulse.1.duty`, `pulse.1.period` | of a pulse generator: on-time in percent of its cycle, cycle in milliseconds |
//! | `PLS0.COUNT` | pulses of a pulse output of an S7-200 |
//!
//! After the last three ` in UNIT` may name their unit, for the axis of a picture; it changes nothing.

use plcc_abi::ProgramImage;
use plcc_abi::image::{AnalogChannel, Module, StationModule};

use crate::address::{self, Address, Bits, Place, Width};
use crate::analog::{self, Scale};
use crate::cpu::Cpu;
use crate::plant::Plant;
use crate::s7200::{self, Part};
use crate::value;

/// Where a value comes from and how it is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    Bits(Address),
    Number(Address, NumberType),
    /// A word of an analog channel.
    Channel(Address, Scale),
    /// A value of the plant, by its number.
    Plant(usize),
    /// Of the pulse generator with this number: on-time in percent.
    PulseDuty(u8),
    /// Of the pulse generator with this number: cycle in milliseconds.
    PulsePeriod(u8),
    /// Of the pulse output of an S7-200 with this number: pulses since RUN began.
    PulseCount(u8),
}

/// How bits at an address are a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberType {
    /// An integer with a sign, of the width of the address.
    Signed,
    Unsigned,
    Real,
    Lreal,
}

impl NumberType {
    /// The number that the bits of an address of this width are.
    fn number(self, bits: Bits, width: Width) -> f64 {
        let unused = 64 - width.bits();
        match self {
            NumberType::Signed => ((bits << unused) as i64 >> unused) as f64,
            NumberType::Unsigned => bits as f64,
            NumberType::Real => f64::from(f32::from_bits(bits as u32)),
            NumberType::Lreal => f64::from_bits(bits),
        }
    }

    /// The bits of a number, rounded and limited to what the type holds.
    fn bits(self, number: f64, width: Width) -> Bits {
        match self {
            NumberType::Real => u64::from((number as f32).to_bits()),
            NumberType::Lreal => number.to_bits(),
            NumberType::Unsigned => match width {
                Width::Bit(_) | Width::Byte => u64::from(number.round() as u8),
                Width::Word => u64::from(number.round() as u16),
                Width::Dword => u64::from(number.round() as u32),
                Width::Lword => number.round() as u64,
            },
            NumberType::Signed if width == Width::Byte => u64::from(number.round() as i8 as u8),
            NumberType::Signed => whole(number, width),
        }
    }
}

const NUMBER_TYPES: [(&str, NumberType, Width); 8] = [
    ("SINT", NumberType::Signed, Width::Byte),
    ("INT", NumberType::Signed, Width::Word),
    ("DINT", NumberType::Signed, Width::Dword),
    ("USINT", NumberType::Unsigned, Width::Byte),
    ("UINT", NumberType::Unsigned, Width::Word),
    ("UDINT", NumberType::Unsigned, Width::Dword),
    ("REAL", NumberType::Real, Width::Dword),
    ("LREAL", NumberType::Lreal, Width::Lword),
];

/// A source with the name that the user gave it.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    pub name: String,
    pub source: Source,
}

/// A value that was read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    Bits(Bits, Width),
    Number(f64),
}

impl Value {
    /// As `--print` writes it.
    pub fn text(self) -> String {
        match self {
            Value::Bits(bits, width) => value::text(bits, width),
            Value::Number(number) => number_text(number),
        }
    }
}

/// Six digits, the precision of a REAL.
pub fn number_text(number: f64) -> String {
    let rounded = format!("{number:.5e}").parse::<f64>().unwrap_or(number);
    // No `-0`.
    (rounded + 0.0).to_string()
}

fn without_unit(text: &str) -> &str {
    text.split_once(" in ").map_or(text, |(name, _)| name).trim()
}

impl Source {
    /// Finds what `text` names; see the module comment. `Err`: the error as a sentence.
    pub fn find(text: &str, image: &ProgramImage, plant: Option<&Plant>) -> Result<Source, String> {
        let text = text.trim();
        if let Some(name) = text.strip_prefix("plant.") {
            let plant = plant.ok_or("there is no plant; a scenario defines one in `[plant]`")?;
            let name = without_unit(name);
            return plant.find(name).map(Source::Plant).ok_or_else(|| format!("the plant has no value `{name}`"));
        }
        if let Some(rest) = text.strip_prefix("pulse.") {
            return pulse(without_unit(rest), image);
        }
        if let Some(number) = pulse_output(without_unit(text), image) {
            return Ok(Source::PulseCount(number));
        }
        let plain = address::resolve(text, image).map(Source::Bits);
        if plain.is_ok() {
            return plain;
        }
        if let Some((name, ty)) = text.rsplit_once(" as ") {
            let ty = without_unit(ty);
            let address = address::resolve(name, image)?;
            let row = NUMBER_TYPES.iter().find(|(word, ..)| word.eq_ignore_ascii_case(ty.trim()));
            let (_, ty, width) = row.ok_or_else(|| {
                format!("`{}` is not one of SINT, INT, DINT, USINT, UINT, UDINT, REAL, LREAL", ty.trim())
            })?;
            if address.width != *width {
                return Err(format!("the width of {} is not that of {}", name.trim(), row.map_or("", |row| row.0)));
            }
            return Ok(Source::Number(address, *ty));
        }
        if let Some((name, unit)) = text.rsplit_once(" in ") {
            let address = address::resolve(name, image)?;
            return Ok(Source::Channel(address, scale(&address, unit, image)?));
        }
        plain
    }

    /// The address, if it has one.
    pub fn address(&self) -> Option<&Address> {
        match self {
            Source::Bits(address) | Source::Number(address, _) | Source::Channel(address, _) => Some(address),
            Source::Plant(_) | Source::PulseDuty(_) | Source::PulsePeriod(_) | Source::PulseCount(_) => None,
        }
    }

    /// Whether the address exists on this CPU; a DB may still be made by the program. `Err`: the error.
    pub fn check(&self, cpu: &Cpu) -> Result<(), String> {
        match self.address() {
            Some(address) if !matches!(address.place, Place::Db(..)) || cpu.s7200.is_some() => {
                cpu.check_address(address)
            }
            Some(_) | None => Ok(()),
        }
    }

    /// True for integers: no other number means one of them.
    pub fn is_exact(&self) -> bool {
        matches!(self, Source::Number(_, NumberType::Signed | NumberType::Unsigned) | Source::PulseCount(_))
    }

    pub fn read(&self, cpu: &Cpu, plant: Option<&Plant>) -> Value {
        match self {
            Source::Bits(address) => {
                let driven = pulse_terminal(address, cpu).and_then(|number| cpu.s7200_pulse_level(number));
                Value::Bits(driven.map_or_else(|| cpu.read(address), u64::from), address.width)
            }
            Source::Number(address, ty) => Value::Number(ty.number(cpu.read(address), address.width)),
            Source::Channel(address, scale) => {
                let word = cpu.read(address) as u16 as i16;
                let is_output = matches!(
                    address.place,
                    Place::Output(_) | Place::PeripheralOutput(_) | Place::S7200(Part::AnalogOutput, _)
                );
                Value::Number(if is_output { scale.output(word) } else { scale.input(word) })
            }
            Source::PulseDuty(number) => Value::Number(cpu.pulse_duty(*number)),
            Source::PulsePeriod(number) => {
                let generators = &cpu.image.config.pulse_generators;
                let found = generators.iter().find(|generator| generator.number == *number);
                Value::Number(found.map_or(0.0, |generator| f64::from(generator.cycle_us) / 1000.0))
            }
            Source::PulseCount(number) => Value::Number(cpu.s7200_pulse_count(*number) as f64),
            Source::Plant(index) => Value::Number(plant.map_or(0.0, |plant| plant.value(*index))),
        }
    }

    /// Width in a trace; `None`: a number.
    pub fn width(&self) -> Option<Width> {
        match self {
            Source::Bits(address) => Some(address.width),
            Source::Number(..)
            | Source::Channel(..)
            | Source::Plant(_)
            | Source::PulseDuty(_)
            | Source::PulsePeriod(_)
            | Source::PulseCount(_) => None,
        }
    }

    /// Sets the address to a number, rounded and limited to what it holds. `Err`: the error.
    pub fn write_number(&self, cpu: &Cpu, number: f64) -> Result<(), String> {
        let (address, bits) = match self {
            Source::Bits(address) => (address, whole(number, address.width)),
            Source::Number(address, ty) => (address, ty.bits(number, address.width)),
            Source::Channel(address, scale) => (address, u64::from(scale.word(number) as u16)),
            Source::PulseDuty(_) | Source::PulsePeriod(_) | Source::PulseCount(_) => {
                return Err("the program sets a pulse generator".to_string());
            }
            Source::Plant(_) => return Err("set a value of the plant with `plant = { name = 1.0 }`".to_string()),
        };
        cpu.write(address, bits)
    }
}

/// The pulse output of an S7-200 whose terminal the address is: Q0.0, Q0.1.
fn pulse_terminal(address: &Address, cpu: &Cpu) -> Option<u8> {
    match (address.place, address.width) {
        (Place::Output(0), Width::Bit(bit)) if cpu.s7200().is_some() && bit < crate::s7200::PULSE_OUTPUTS => Some(bit),
        _ => None,
    }
}

/// `PLS0.COUNT`
fn pulse_output(text: &str, image: &ProgramImage) -> Option<u8> {
    let upper = text.to_ascii_uppercase();
    let number = upper.strip_prefix("PLS")?.strip_suffix(".COUNT")?.parse().ok()?;
    (image.s7200.is_some() && number < crate::s7200::PULSE_OUTPUTS).then_some(number)
}

/// `1.duty`, `1.period`
fn pulse(text: &str, image: &ProgramImage) -> Result<Source, String> {
    let (number, what) = text.split_once('.').ok_or("write `pulse.1.duty` or `pulse.1.period`")?;
    let generators = &image.config.pulse_generators;
    let number = number.parse().ok().filter(|number| generators.iter().any(|known| known.number == *number));
    let number = number.ok_or_else(|| format!("plc.toml enables no pulse generator `{text}`"))?;
    match what {
        "duty" => Ok(Source::PulseDuty(number)),
        "period" => Ok(Source::PulsePeriod(number)),
        _ => Err(format!("a pulse generator has no `{what}`; it has `duty` and `period`")),
    }
}

/// The bits of a number at an address: a bit is 1 if the number is not 0, a byte has no sign, wider ones have.
fn whole(number: f64, width: Width) -> Bits {
    let number = number.round();
    match width {
        Width::Bit(_) => u64::from(number != 0.0),
        Width::Byte => u64::from(number as u8),
        Width::Word => u64::from(number as i16 as u16),
        Width::Dword => u64::from(number as i32 as u32),
        Width::Lword => number as i64 as u64,
    }
}

/// The scale of the channel at `address` in `unit`. `Err`: the error as a sentence.
pub fn scale(address: &Address, unit: &str, image: &ProgramImage) -> Result<Scale, String> {
    if image.s7200.is_some() {
        return s7200::scale(address, unit, image).map(Scale::Module);
    }
    let none = "a unit needs an analog channel: a station with this address in plc.toml, and a word address";
    if address.width != Width::Word {
        return Err(none.to_string());
    }
    channel(address, image).ok_or_else(|| none.to_string()).and_then(|channel| Scale::new(channel, unit))
}

/// The modules of the station that have a place, in the order of racks and slots.
fn station(image: &ProgramImage) -> Vec<(&Module, &StationModule)> {
    let modules = image.config.modules.iter().flatten();
    let mut modules: Vec<_> =
        modules.filter_map(|module| module.station.as_ref().map(|station| (module, station))).collect();
    modules.sort_by_key(|(_, station)| (station.rack, station.slot));
    modules
}

/// The analog channel whose word is at `address`.
fn channel<'a>(address: &Address, image: &'a ProgramImage) -> Option<&'a AnalogChannel> {
    let at = |start: u32, byte: u32, channels: &'a [AnalogChannel]| {
        byte.checked_sub(start).filter(|offset| offset % 2 == 0).and_then(|offset| channels.get(offset as usize / 2))
    };
    station(image).into_iter().find_map(|(module, station)| match address.place {
        Place::PeripheralInput(byte) | Place::Input(byte) => at(module.input_start, byte, &station.analog_inputs),
        Place::PeripheralOutput(byte) | Place::Output(byte) => at(module.output_start, byte, &station.analog_outputs),
        Place::BitMemory(_) | Place::Db(..) | Place::Timer(_) | Place::Counter(_) | Place::S7200(..) => None,
    })
}

/// False for an input that no module has, if plc.toml describes the station.
pub fn has_module(address: &Address, image: &ProgramImage) -> bool {
    if let Place::S7200(Part::AnalogInput, byte) = address.place {
        return s7200::has_module(&image.config.s7200, byte);
    }
    let (Place::Input(start) | Place::PeripheralInput(start)) = address.place else { return true };
    let modules = image.config.modules.as_deref().unwrap_or_default();
    let covers = |byte: u32| {
        modules.iter().any(|module| byte >= module.input_start && byte - module.input_start < module.input_bytes)
    };
    station(image).is_empty() || (start..start + address.width.bytes()).all(covers)
}

/// `AI0`: the first analog input channel of the station, in the order of racks, slots and channels. `AO0`: of the outputs.
pub fn analog_channel(text: &str, image: &ProgramImage) -> Option<Address> {
    let upper = text.trim().to_ascii_uppercase();
    let (is_input, digits) = match (upper.strip_prefix("AI"), upper.strip_prefix("AO")) {
        (Some(digits), _) => (true, digits),
        (_, Some(digits)) => (false, digits),
        (None, None) => return None,
    };
    let wanted = digits.bytes().all(|byte| byte.is_ascii_digit()).then(|| digits.parse::<usize>().ok()).flatten()?;
    let modules = station(image);
    let words = modules.iter().flat_map(|(module, station)| {
        let (start, channels) = match is_input {
            true => (module.input_start, &station.analog_inputs),
            false => (module.output_start, &station.analog_outputs),
        };
        (0..channels.len() as u32).map(move |index| start + 2 * index)
    });
    let byte = words.into_iter().nth(wanted)?;
    let place = if is_input { Place::PeripheralInput(byte) } else { Place::PeripheralOutput(byte) };
    Some(Address { place, width: Width::Word })
}

/// A value for an address: a literal, or a number with a unit if an analog channel is there. `Err`: the error.
pub fn parse_value(text: &str, address: &Address, image: &ProgramImage) -> Result<Bits, String> {
    match (value::parse(text, address.width), analog::with_unit(text)) {
        (Err(_), Some((number, unit))) => Ok(u64::from(scale(address, unit, image)?.word(number) as u16)),
        (parsed, _) => parsed,
    }
}
