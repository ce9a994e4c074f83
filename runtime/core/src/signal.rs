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

use plcc_abi::ProgramImage;
use plcc_abi::image::{AnalogChannel, AssertType, Module, StationModule};

use crate::address::{Address, Bits, Place, Width};
use crate::analog::{self, Scale};
use crate::assertion::Value as TypedValue;
use crate::cpu::Cpu;
use crate::memory::Memory;
use crate::names::{self, Named};
use crate::plant::Plant;
use crate::s7200::{self, Part};
use crate::typed::{self, ValueType};
use crate::value;
use crate::watch::format::Format;

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

/// A value that was read.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Bits(Bits, Width),
    /// A whole number of a type.
    Whole(i128),
    Number(f64),
    /// A value of another type.
    Typed(AssertType, TypedValue),
}

impl Value {
    /// Of a type.
    fn typed(ty: AssertType, value: TypedValue, width: Width) -> Value {
        match (ty, &value) {
            (AssertType::Bool | AssertType::Bits(_), TypedValue::Bits(bits)) => Value::Bits(*bits, width),
            (AssertType::Real, TypedValue::Bits(bits)) => Value::Number(f32::from_bits(*bits as u32).into()),
            (_, TypedValue::Bits(bits)) => match typed::whole(ty, *bits) {
                Some(whole) => Value::Whole(whole),
                None => Value::Typed(ty, value),
            },
            _ => Value::Typed(ty, value),
        }
    }

    /// The value of an elementary type with these bits, zero-extended.
    pub fn of_type(ty: AssertType, bits: u64) -> Value {
        Value::typed(ty, TypedValue::Bits(bits), ValueType::of(ty).width(0))
    }

    /// The value of a type at an offset in memory; of a BOOL the bit.
    pub fn at(memory: &Memory, offset: u32, bit: u8, ty: ValueType) -> Value {
        let given = match typed::bits(ty.ty) {
            Some(1) => u64::from(memory.bit(offset, bit)),
            Some(8) => u64::from(memory.byte(offset)),
            Some(16) => u64::from(memory.word(offset)),
            Some(32) => u64::from(memory.dword(offset)),
            Some(_) => u64::from_be_bytes(memory.bytes(offset)),
            None => u64::from(offset),
        };
        Value::typed(ty.ty, TypedValue::read(ty.ty, given, memory), ty.width(bit))
    }

    /// Writes the text of a value of a type to an offset in memory. `Err`: the error as a sentence.
    pub fn put(memory: &Memory, offset: u32, bit: u8, ty: ValueType, text: &str) -> Result<(), String> {
        match (typed::parse(text, ty)?, typed::bits(ty.ty)) {
            (TypedValue::Bits(bits), Some(1)) => memory.set_bit(offset, bit, bits != 0),
            (TypedValue::Bits(bits), Some(8)) => memory.set_byte(offset, bits as u8),
            (TypedValue::Bits(bits), Some(16)) => memory.set_word(offset, bits as u16),
            (TypedValue::Bits(bits), Some(32)) => memory.set_dword(offset, bits as u32),
            (TypedValue::Bits(bits), _) => memory.set_bytes(offset, bits.to_be_bytes()),
            (TypedValue::Bytes(bytes), _) => memory.load(offset, &bytes),
            // The head has the declared length, then the one of the value.
            (TypedValue::Text(text), _) if ty.ty == AssertType::WideText => {
                memory.set_word(offset + 2, text.len() as u16);
                (0u32..).zip(&text).for_each(|(number, unit)| memory.set_word(offset + 4 + 2 * number, *unit));
            }
            (TypedValue::Text(text), _) => {
                memory.set_byte(offset + 1, text.len() as u8);
                (0u32..).zip(&text).for_each(|(number, unit)| memory.set_byte(offset + 2 + number, *unit as u8));
            }
        }
        Ok(())
    }

    /// As `--print` writes it.
    pub fn text(&self) -> String {
        match self {
            Value::Bits(bits, width) => value::text(*bits, *width),
            Value::Whole(whole) => whole.to_string(),
            Value::Number(number) => number_text(*number),
            Value::Typed(AssertType::Lreal, _) => self.number().map_or_else(String::new, |number| number.to_string()),
            Value::Typed(ty, value) => value.typed_text(*ty),
        }
    }

    /// As a number, a duration in seconds; `None`: a text or a date.
    pub fn number(&self) -> Option<f64> {
        match self {
            Value::Bits(bits, _) => Some(*bits as f64),
            Value::Whole(whole) => Some(*whole as f64),
            Value::Number(number) => Some(*number),
            Value::Typed(AssertType::Lreal, TypedValue::Bits(bits)) => Some(f64::from_bits(*bits)),
            Value::Typed(ty, value) => value.seconds(*ty),
        }
    }

    /// As JSON: a number, true or false where it is one, else a text.
    pub fn json(&self) -> serde_json::Value {
        match self {
            Value::Bits(bits, Width::Bit(_)) => (*bits != 0).into(),
            Value::Bits(bits, _) => (*bits).into(),
            Value::Whole(whole) => match (i64::try_from(*whole), u64::try_from(*whole)) {
                (Ok(whole), _) => whole.into(),
                (_, Ok(whole)) => whole.into(),
                _ => whole.to_string().into(),
            },
            // NaN and infinite numbers are null.
            Value::Number(number) => number_text(*number).parse::<f64>().unwrap_or(*number).into(),
            Value::Typed(AssertType::Lreal, _) => self.number().into(),
            Value::Typed(
                AssertType::Text | AssertType::WideText | AssertType::Char | AssertType::Wchar,
                TypedValue::Bits(_) | TypedValue::Text(_) | TypedValue::Bytes(_),
            ) => self.plain_text().into(),
            Value::Typed(..) => self.text().into(),
        }
    }

    /// A text without quotes.
    pub fn plain_text(&self) -> String {
        match self {
            Value::Typed(ty, value) => value.plain_text(*ty),
            Value::Bits(..) | Value::Whole(_) | Value::Number(_) => self.text(),
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
            return plant.find(name).map(Source::Plant).ok_or_else(|| format!("the plant has no value `{name}`"));
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
            return as_type(names::find(name, image)?, ty)
                .ok_or_else(|| format!("the width of {} is not that of {}", name.trim(), typed::name(ty)));
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
                (Err(_), Some((number, unit))) if address.width == Width::Word => {
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
            let length = head.iter().min().map_or(0, |length| u32::from(*length));
            TypedValue::of_bytes(ty.ty, &cpu.read_bytes(address, 2 + length))
        }
        AssertType::WideText => {
            let head = cpu.read_bytes(address, 4);
            let word = |at: usize| u32::from(head[at]) << 8 | u32::from(head[at + 1]);
            let length = word(0).min(word(2)).min(16_382);
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

/// The scale of the channel at `address` in `unit`. `Err`: the error as a sentence.
pub fn scale(address: &Address, unit: &str, image: &ProgramImage) -> Result<Scale, String> {
    if image.s7200.is_some() {
        return s7200::scale(address, unit, image).map(Scale::Module);
    }
    if let Some(digits) = unit.strip_prefix(['x', 'X']).filter(|digits| u64::from_str_radix(digits, 16).is_ok()) {
        return Err(format!("a hexadecimal number begins with `16#`: write 16#{digits}"));
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
pub(crate) fn channel<'a>(address: &Address, image: &'a ProgramImage) -> Option<&'a AnalogChannel> {
    let at = |start: u32, byte: u32, channels: &'a [AnalogChannel]| {
        byte.checked_sub(start).filter(|offset| offset % 2 == 0).and_then(|offset| channels.get(offset as usize / 2))
    };
    station(image).into_iter().find_map(|(module, station)| match address.place {
        Place::PeripheralInput(byte) | Place::Input(byte) => at(module.input_start, byte, &station.analog_inputs),
        Place::PeripheralOutput(byte) | Place::Output(byte) => at(module.output_start, byte, &station.analog_outputs),
        Place::BitMemory(_)
        | Place::Db(..)
        | Place::Timer(_)
        | Place::Counter(_)
        | Place::TimerValue(_)
        | Place::CounterValue(_)
        | Place::S7200(..) => None,
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
