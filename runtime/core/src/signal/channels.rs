//! Analog channels of a station: where they are, and their values in a unit.

use plcc_abi::ProgramImage;
use plcc_abi::image::{AnalogChannel, Module, StationModule};

use crate::address::{Address, Bits, Place, Width};
use crate::analog::{self, Scale};
use crate::s7200::{self, Part};
use crate::value;

/// The scale of the channel at `address` in `unit`. `Err`: the error as a sentence.
pub fn scale(address: &Address, unit: &str, image: &ProgramImage) -> Result<Scale, String> {
    if image.s7200.is_some() {
        return s7200::scale(address, unit, image).map(Scale::Module);
    }
    if let Some(digits) = unit.strip_prefix(['x', 'X']).filter(|digits| u64::from_str_radix(digits, 16).is_ok()) {
        return Err(format!("a hexadecimal number begins with `16#`: write 16#{digits}"));
    }
    let has_channels = matches!(
        address.place,
        Place::Input(_) | Place::Output(_) | Place::PeripheralInput(_) | Place::PeripheralOutput(_)
    );
    if !has_channels {
        return Err(format!("`{unit}` would be a unit, which only an analog channel has"));
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
    let (is_input, wanted) = channel_number(text)?;
    let byte = channel_words(is_input, image).into_iter().nth(wanted)?;
    let place = if is_input { Place::PeripheralInput(byte) } else { Place::PeripheralOutput(byte) };
    Some(Address { place, width: Width::Word })
}

/// Which channels the station has, if `text` has the form of one that it does not have.
pub fn missing_channel(text: &str, image: &ProgramImage) -> Option<String> {
    let (is_input, _) = channel_number(text).filter(|_| image.s7200.is_none())?;
    let (what, letters) = if is_input { ("inputs", "AI") } else { ("outputs", "AO") };
    Some(match channel_words(is_input, image).len() {
        0 if station(image).is_empty() => format!("plc.toml describes no station with analog {what}"),
        0 => format!("the station has no analog {what}"),
        1 => format!("of the analog {what} the station has {letters}0 only"),
        count => format!("the station has the analog {what} {letters}0 to {letters}{}", count - 1),
    })
}

/// `AI0`: whether it is an input, and its number.
fn channel_number(text: &str) -> Option<(bool, usize)> {
    let upper = text.trim().to_ascii_uppercase();
    let (is_input, digits) = match (upper.strip_prefix("AI"), upper.strip_prefix("AO")) {
        (Some(digits), _) => (true, digits),
        (_, Some(digits)) => (false, digits),
        (None, None) => return None,
    };
    let number = digits.bytes().all(|byte| byte.is_ascii_digit()).then(|| digits.parse().ok()).flatten()?;
    Some((is_input, number))
}

/// The addresses of the analog channels of the station, in their order.
fn channel_words(is_input: bool, image: &ProgramImage) -> Vec<u32> {
    let modules = station(image);
    let words = modules.iter().flat_map(|(module, station)| {
        let (start, channels) = match is_input {
            true => (module.input_start, &station.analog_inputs),
            false => (module.output_start, &station.analog_outputs),
        };
        (0..channels.len() as u32).map(move |index| start + 2 * index)
    });
    words.collect()
}

/// A value for an address: a literal, or a number with a unit if an analog channel is there. `Err`: the error.
pub fn parse_value(text: &str, address: &Address, image: &ProgramImage) -> Result<Bits, String> {
    match (value::parse(text, address.width), analog::with_unit(text)) {
        (Err(_), Some((number, unit))) => Ok(u64::from(scale(address, unit, image)?.word(number) as u16)),
        (parsed, _) => parsed,
    }
}
