//! Signals that a user watches and compares: an address, an analog channel in its unit, a number at an address, a value of the plant.
//!
//! | Text | Value |
//! | --- | --- |
//! | `MW20`, `AI0` | bits, as `--print` writes them |
//! | `Motor`, `Station_DB.D1.Starts` | a value of its declared type |
//! | `AO0 in %`, `Level_Transmitter in mA` | number in a unit, by the range of the channel |
//! | `Level as REAL`, `MW10 as INT`, `DB1.DBB0 as STRING` | a value of this type |
//! | `plant.level` | number, from the plant of the scenario |
//! | `pulse.1.duty`, `pulse.1.period` | of a pulse generator: on-time in percent of its cycle, cycle in milliseconds |
//! | `PLS0.COUNT` | pulses of a pulse output of an S7-200 |
//!
//! After the last four ` in UNIT` may name their unit, for the axis of a picture; it changes nothing.

mod channels;
mod reading;

use plcc_abi::ProgramImage;
use plcc_abi::image::AssertType;
use plcc_literal::distance::nearest;

use crate::address::{Address, Bits, Place, Width};
use crate::analog::{self, Scale};
use crate::assertion::Value as TypedValue;
use crate::cpu::Cpu;
use crate::names::{self, Named};
use crate::plant::Plant;
use crate::s7200::Part;
use crate::typed::{self, ValueType};
use crate::watch::format::Format;

pub(crate) use channels::channel;
pub use channels::{analog_channel, has_module, missing_channel, parse_value, scale};
pub use reading::{Value, number_text};

/// Where a value comes from and how it is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Source {
    Bits(Address),
    /// A value of a type that is not bits.
    Typed(Address, ValueType),
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

/// How a trace shows a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    Bits(Width),
    /// A whole number of 64 bits, which are more than a REAL of a trace holds.
    Long {
        signed: bool,
    },
    /// Durations in seconds.
    Number,
    Text,
}

/// A source with the name that the user gave it.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    pub name: String,
    pub source: Source,
}

fn without_unit(text: &str) -> &str {
    text.split_once(" in ").map_or(text, |(name, _)| name).trim()
}

/// Values of a structure or DB that is named as a whole.
const VALUES_MAX: usize = 1000;

/// The signal that `text` names, or all values of a structure, an array or a DB. `Err`: the error as a sentence.
pub fn all(text: &str, image: &ProgramImage, plant: Option<&Plant>) -> Result<Vec<Signal>, String> {
    match Source::find(text, image, plant) {
        Ok(source) => Ok(vec![Signal { name: text.to_string(), source }]),
        Err(wrong) => {
            let values = names::values(text, image, VALUES_MAX).map_err(|_| wrong)?;
            Ok(values.into_iter().map(|(name, named)| Signal { name, source: Source::of(named) }).collect())
        }
    }
}

impl Source {
    /// Finds what `text` names; see the module comment. `Err`: the error as a sentence.
    pub fn find(text: &str, image: &ProgramImage, plant: Option<&Plant>) -> Result<Source, String> {
        let text = text.trim();
        if let Some(name) = text.strip_prefix("plant.") {
            let plant = plant.ok_or("there is no plant; a scenario defines one in `[plant]`")?;
            let name = without_unit(name);
            return plant.find(name).map(Source::Plant).ok_or_else(|| match nearest(name, plant.names()) {
                Some(near) => format!("the plant has no value `{name}`; did you mean `{near}`?"),
                None => format!("the plant has no value `{name}`"),
            });
        }
        if let Some(rest) = text.strip_prefix("pulse.") {
            return pulse(without_unit(rest), image);
        }
        if let Some(number) = pulse_output(without_unit(text), image) {
            return Ok(Source::PulseCount(number));
        }
        let plain = names::find(text, image).map(Source::of);
        if plain.is_ok() {
            return plain;
        }
        if let Some((name, ty)) = split_last(text, " as ") {
            let ty = typed::from_word(without_unit(ty))?;
            let named = names::find(name, image)?;
            return as_type(named, ty).ok_or_else(|| wrong_width(name.trim(), named, ty));
        }
        if let Some((name, unit)) = split_last(text, " in ") {
            if let Ok(source) = names::find(name, image).map(Source::of)
                && !matches!(source, Source::Bits(_))
                && scale(source.address().unwrap_or(&NOWHERE), unit, image).is_err()
            {
                return Ok(source);
            }
            let address = names::find(name, image)?.address;
            return Ok(Source::Channel(address, scale(&address, unit, image)?));
        }
        plain
    }

    /// By the declared type of a named value.
    pub fn of(named: Named) -> Source {
        match named.ty {
            Some(ty) if !matches!(ty.ty, AssertType::Bool | AssertType::Bits(_)) => Source::Typed(named.address, ty),
            Some(_) | None => Source::Bits(named.address),
        }
    }

    /// The type of its values.
    pub fn ty(&self) -> &'static str {
        match self {
            Source::Bits(address) => match address.width {
                Width::Bit(_) => "BOOL",
                Width::Byte => "BYTE",
                Width::Word => "WORD",
                Width::Dword => "DWORD",
                Width::Lword => "LWORD",
            },
            Source::Typed(_, ty) => typed::name(ty.ty),
            Source::PulseCount(_) => "UDINT",
            Source::Channel(..) | Source::Plant(_) | Source::PulseDuty(_) | Source::PulsePeriod(_) => "REAL",
        }
    }

    /// The address, if it has one.
    pub fn address(&self) -> Option<&Address> {
        match self {
            Source::Bits(address) | Source::Typed(address, _) | Source::Channel(address, _) => Some(address),
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

    /// Why the value does not exist at present: its DB is not loaded, or too short.
    pub fn absent(&self, cpu: &Cpu) -> Option<String> {
        self.address().and_then(|address| cpu.check_address(address).err())
    }

    /// True for counts: no other number means one of them.
    pub fn is_exact(&self) -> bool {
        matches!(self, Source::PulseCount(_))
    }

    pub fn read(&self, cpu: &Cpu, plant: Option<&Plant>) -> Value {
        match self {
            Source::Bits(address) => {
                let driven = pulse_terminal(address, cpu).and_then(|number| cpu.s7200_pulse_level(number));
                Value::Bits(driven.map_or_else(|| cpu.read(address), u64::from), address.width)
            }
            Source::Typed(address, ty) => Value::typed(ty.ty, typed_value(cpu, address, *ty), address.width),
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

    /// How a trace shows it.
    pub fn shape(&self) -> Shape {
        match self {
            Source::Bits(address) => Shape::Bits(address.width),
            Source::Typed(_, ty) => match ty.ty {
                AssertType::Date
                | AssertType::TimeOfDay
                | AssertType::Ltod
                | AssertType::Ldt
                | AssertType::DateAndTime
                | AssertType::Dtl
                | AssertType::Char
                | AssertType::Wchar
                | AssertType::Text
                | AssertType::WideText => Shape::Text,
                AssertType::Signed(64) => Shape::Long { signed: true },
                AssertType::Unsigned(64) => Shape::Long { signed: false },
                _ => Shape::Number,
            },
            Source::Channel(..)
            | Source::Plant(_)
            | Source::PulseDuty(_)
            | Source::PulsePeriod(_)
            | Source::PulseCount(_) => Shape::Number,
        }
    }

    /// Reads the text of a value for this source. `Err`: the error as a sentence.
    pub fn parse(&self, text: &str, image: &ProgramImage) -> Result<Value, String> {
        let value = self.parse_any(text, image)?;
        if let (Some(address), Some(bits)) = (self.address(), self.bits(&value)) {
            address.check_value(bits)?;
        }
        Ok(value)
    }

    /// As [`parse`](Source::parse), also what a timer or counter cannot have.
    fn parse_any(&self, text: &str, image: &ProgramImage) -> Result<Value, String> {
        match self {
            // `C#20`: a count as programs write it.
            Source::Typed(address, ty) if address.is_count() && text.trim().starts_with(['C', 'c']) => {
                let bits = Format::Counter.parse_at(text, address)?;
                Ok(Value::typed(ty.ty, TypedValue::Bits(bits), address.width))
            }
            Source::Bits(address) => parse_value(text, address, image).map(|bits| Value::Bits(bits, address.width)),
            Source::Typed(address, ty) => match (typed::parse(text, *ty), analog::with_unit(text)) {
                // The seconds of a duration are not the unit of a channel.
                (Err(_), Some((number, unit))) if address.width == Width::Word && ty.ty != AssertType::S5Time => {
                    let word = scale(address, unit, image)?.word(number);
                    Ok(Value::typed(ty.ty, TypedValue::Bits(u64::from(word as u16)), address.width))
                }
                (parsed, _) => parsed.map(|value| Value::typed(ty.ty, value, address.width)),
            },
            Source::Channel(..)
            | Source::Plant(_)
            | Source::PulseDuty(_)
            | Source::PulsePeriod(_)
            | Source::PulseCount(_) => {
                let number = text.trim().parse::<f64>().map_err(|_| format!("`{}` is not a number", text.trim()));
                number.map(Value::Number)
            }
        }
    }

    /// The bits of a value that [`parse`](Source::parse) has read; `None`: it has more than eight bytes, or no address.
    pub fn bits(&self, value: &Value) -> Option<u64> {
        let address = self.address()?;
        match (self, value) {
            (_, Value::Bits(bits, _) | Value::Typed(_, TypedValue::Bits(bits))) => Some(*bits),
            (_, Value::Whole(whole)) => Some(*whole as u64 & mask(address.width)),
            (Source::Typed(_, ty), Value::Number(number)) => Some(number_bits(*number, ty.ty, address.width)),
            (_, Value::Number(_) | Value::Typed(..)) => None,
        }
    }

    /// Whether a value can be set there from outside. `Err`: why not.
    pub fn check_settable(&self) -> Result<(), String> {
        match self {
            Source::Bits(address) | Source::Typed(address, _) | Source::Channel(address, _) => address.check_settable(),
            Source::PulseDuty(_) | Source::PulsePeriod(_) | Source::PulseCount(_) => {
                Err("the program sets a pulse generator".to_string())
            }
            Source::Plant(_) => Err("set a value of the plant with `plant = { name = 1.0 }`".to_string()),
        }
    }

    /// Sets a value that [`parse`](Source::parse) has read. `Err`: the error.
    pub fn write(&self, cpu: &Cpu, value: &Value) -> Result<(), String> {
        self.check_settable()?;
        let Some(address) = self.address() else { return Ok(()) };
        match (self, value) {
            (_, Value::Bits(bits, _) | Value::Typed(_, TypedValue::Bits(bits))) => cpu.write(address, *bits),
            (_, Value::Whole(whole)) => cpu.write(address, *whole as u64 & mask(address.width)),
            (_, Value::Number(number)) => self.write_number(cpu, *number),
            (_, Value::Typed(_, TypedValue::Bytes(bytes))) => cpu.write_bytes(address, bytes),
            (Source::Typed(_, ty), Value::Typed(_, TypedValue::Text(text))) => write_text(cpu, address, *ty, text),
            (_, Value::Typed(_, TypedValue::Text(_))) => Ok(()),
        }
    }

    /// Sets the address to a number, rounded and limited to what it holds. `Err`: the error.
    pub fn write_number(&self, cpu: &Cpu, number: f64) -> Result<(), String> {
        self.check_settable()?;
        let (address, bits) = match self {
            Source::Bits(address) => (address, whole(number, address.width)),
            Source::Typed(address, ty) => (address, number_bits(number, ty.ty, address.width)),
            Source::Channel(address, scale) => (address, u64::from(scale.word(number) as u16)),
            Source::PulseDuty(_) | Source::PulsePeriod(_) | Source::PulseCount(_) | Source::Plant(_) => return Ok(()),
        };
        cpu.write(address, bits)
    }
}

/// An address that no unit belongs to.
const NOWHERE: Address = Address { place: Place::Timer(0), width: Width::Bit(0) };

/// Splits at the last separator, in any letter case.
fn split_last<'a>(text: &'a str, separator: &str) -> Option<(&'a str, &'a str)> {
    let at = text.to_ascii_lowercase().rfind(separator)?;
    Some((&text[..at], &text[at + separator.len()..]))
}

/// A value read as another type; `None`: the widths differ. What has 64 bits or more may begin at a byte.
fn as_type(named: Named, ty: AssertType) -> Option<Source> {
    let mut address = named.address;
    let ty = match named.ty {
        Some(own) if own.ty == ty => own,
        Some(_) | None => ValueType::of(ty),
    };
    let width = ty.width(match address.width {
        Width::Bit(bit) => bit,
        Width::Byte | Width::Word | Width::Dword | Width::Lword => 0,
    });
    let begins_here = address.width == Width::Byte && matches!(width, Width::Byte | Width::Lword);
    if address.width != width && !begins_here {
        return None;
    }
    address.width = width;
    Some(Source::of(Named { address, ty: Some(ty) }))
}

/// The message for `name as ty`, if `ty` has another width.
fn wrong_width(name: &str, named: Named, ty: AssertType) -> String {
    let (bits, ty_name) = (named.address.width.bits(), typed::name(ty));
    let plural = if bits == 1 { "" } else { "s" };
    match typed::bits(ty) {
        Some(wanted @ 1..=32) => format!("`{name}` has {bits} bit{plural}, but {ty_name} has {wanted}"),
        Some(_) | None => {
            format!("`{name}` has {bits} bit{plural}: name the byte where the {ty_name} begins, such as `MB10`")
        }
    }
}

/// The value of a type at an address.
fn typed_value(cpu: &Cpu, address: &Address, ty: ValueType) -> TypedValue {
    match ty.ty {
        AssertType::Dtl => TypedValue::of_bytes(ty.ty, &cpu.read_bytes(address, 12)),
        // On an S7-200 a text begins with its length alone.
        AssertType::Text if cpu.s7200.is_some() => {
            let length = cpu.read_bytes(address, 1).first().map_or(0, |length| u32::from(*length));
            let bytes = cpu.read_bytes(address, 1 + length);
            TypedValue::Text(bytes.iter().skip(1).map(|byte| u16::from(*byte)).collect())
        }
        AssertType::Text => {
            let head = cpu.read_bytes(address, 2);
            // Behind the declared characters are other values, whatever the head says.
            let length = head.iter().min().map_or(0, |length| u32::from(*length)).min(ty.length.into());
            TypedValue::of_bytes(ty.ty, &cpu.read_bytes(address, 2 + length))
        }
        AssertType::WideText => {
            let head = cpu.read_bytes(address, 4);
            let word = |at: usize| u32::from(head[at]) << 8 | u32::from(head[at + 1]);
            let length = word(0).min(word(2)).min(ty.length.into());
            TypedValue::of_bytes(ty.ty, &cpu.read_bytes(address, 4 + 2 * length))
        }
        _ => TypedValue::Bits(cpu.read(address)),
    }
}

/// Writes a text with its length. Its maximum length stays, or becomes the declared one if there was none.
fn write_text(cpu: &Cpu, address: &Address, ty: ValueType, text: &[u16]) -> Result<(), String> {
    let is_wide = ty.ty == AssertType::WideText;
    if cpu.s7200.is_some() && !is_wide {
        let length = std::iter::once(text.len() as u8);
        let bytes: Vec<u8> = length.chain(text.iter().map(|unit| *unit as u8)).collect();
        return cpu.write_bytes(address, &bytes);
    }
    let head = cpu.read_bytes(address, 4);
    let room = if is_wide { u16::from(head[0]) << 8 | u16::from(head[1]) } else { head[0].into() };
    let room = if room == 0 { ty.length } else { room };
    if text.len() > usize::from(room) {
        return Err(format!("the text has {} characters; there is room for {room}", text.len()));
    }
    let length = text.len() as u16;
    let bytes: Vec<u8> = match is_wide {
        true => [room, length].iter().chain(text).flat_map(|unit| unit.to_be_bytes()).collect(),
        false => [room, length].iter().chain(text).map(|unit| *unit as u8).collect(),
    };
    cpu.write_bytes(address, &bytes)
}

fn mask(width: Width) -> u64 {
    u64::MAX >> (64 - width.bits())
}

/// The bits of a number, rounded and limited to what the type holds; a duration is in seconds.
fn number_bits(number: f64, ty: AssertType, width: Width) -> Bits {
    match ty {
        AssertType::Real => u64::from((number as f32).to_bits()),
        AssertType::Lreal => number.to_bits(),
        AssertType::Unsigned(8) => u64::from(number.round() as u8),
        AssertType::Unsigned(16) => u64::from(number.round() as u16),
        AssertType::Unsigned(32) => u64::from(number.round() as u32),
        AssertType::Unsigned(_) => number.round() as u64,
        AssertType::Signed(8) => u64::from(number.round() as i8 as u8),
        AssertType::Time => whole(number * 1000.0, width),
        _ => whole(number, width),
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
