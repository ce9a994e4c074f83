//! Words of analog modules. Source: S7-200 system manual, technical specifications of EM 231, EM 232 and EM 235.

use plcc_abi::ProgramImage;
use plcc_abi::s7200::S7200Config;
use plcc_abi::s7200::image::AnalogModule;

use super::address::Part;
use crate::address::{Address, Place, Width};

/// Word at the end of a range.
const FULL: f64 = 32_000.0;
/// Bits of an input word: 12 bits of a unipolar range in bits 14 to 3, of a bipolar one in bits 15 to 4.
const UNIPOLAR_MASK: i16 = 0x7FF8;
const BIPOLAR_MASK: i16 = !0xF;
/// Bits of an output word: of a voltage, of a current.
const VOLTAGE_MASK: i16 = !0xF;
const CURRENT_MASK: i16 = 0x7FF0;
/// Ends of the output: -10 to 10 V and 0 to 20 mA.
const OUTPUT_VOLTS: f64 = 10.0;
const OUTPUT_MILLIAMPERES: f64 = 20.0;

/// A unit of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModuleScale {
    channel: Channel,
    /// Units of the channel's range for one of the user's; `None`: percent of 32000.
    factor: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Channel {
    Input { low: f64, high: f64, bipolar: bool },
    VoltageOutput,
    CurrentOutput,
}

impl ModuleScale {
    /// The word that an input shows, or that produces this value at an output.
    pub fn word(&self, value: f64) -> i16 {
        let value = value * self.factor.unwrap_or(FULL / 100.0);
        let part = |low: f64, high: f64, from: f64| from + (value - low) / (high - low) * (FULL - from);
        let exact = match (self.channel, self.factor) {
            (_, None) => value,
            (Channel::Input { low, high, bipolar }, Some(_)) => part(low, high, if bipolar { -FULL } else { 0.0 }),
            (Channel::VoltageOutput, Some(_)) => part(0.0, OUTPUT_VOLTS, 0.0),
            (Channel::CurrentOutput, Some(_)) => part(0.0, OUTPUT_MILLIAMPERES, 0.0),
        };
        // The cast limits.
        self.masked(exact.round() as i16)
    }

    /// The meaning of a word at an input.
    pub fn input(&self, word: i16) -> f64 {
        self.number(f64::from(word))
    }

    /// The value of an output.
    pub fn output(&self, word: i16) -> f64 {
        self.number(f64::from(self.masked(word)))
    }

    fn masked(&self, word: i16) -> i16 {
        match self.channel {
            Channel::Input { bipolar, .. } => input_word(bipolar, word),
            Channel::VoltageOutput => word & VOLTAGE_MASK,
            Channel::CurrentOutput => word.max(0) & CURRENT_MASK,
        }
    }

    fn number(&self, word: f64) -> f64 {
        let Some(factor) = self.factor else { return word / FULL * 100.0 };
        let part = |low: f64, high: f64, from: f64| low + (word - from) / (FULL - from) * (high - low);
        let value = match self.channel {
            Channel::Input { low, high, bipolar } => part(low, high, if bipolar { -FULL } else { 0.0 }),
            Channel::VoltageOutput => part(0.0, OUTPUT_VOLTS, 0.0),
            Channel::CurrentOutput => part(0.0, OUTPUT_MILLIAMPERES, 0.0),
        };
        value / factor
    }
}

/// A raw word as an input module shows it.
fn input_word(bipolar: bool, word: i16) -> i16 {
    if bipolar { word & BIPOLAR_MASK } else { word.max(0) & UNIPOLAR_MASK }
}

/// The module with the analog channel at byte `address`, inputs or outputs; each takes an even number of channels.
fn module(config: &S7200Config, address: u32, channels: fn(&AnalogModule) -> u8) -> Option<&AnalogModule> {
    let channel = address / 2;
    let mut first = 0;
    config.analog.iter().find(|module| {
        let start = first;
        let count = u32::from(channels(module));
        first += count.next_multiple_of(2);
        channel >= start && channel - start < count
    })
}

fn input_module(config: &S7200Config, address: u32) -> Option<&AnalogModule> {
    module(config, address, |module| module.inputs)
}

/// `word` in the form of the module at AIW `address`; unchanged if no module is described.
pub(super) fn shown(config: &S7200Config, address: u32, word: u16) -> u16 {
    input_module(config, address).map_or(word, |module| input_word(module.bipolar, word as i16) as u16)
}

/// False for an analog input that no module has, if plc.toml describes analog modules.
pub(crate) fn has_module(config: &S7200Config, address: u32) -> bool {
    config.analog.is_empty() || input_module(config, address).is_some()
}

/// The scale of the channel at `address` in `unit`. `Err`: the error as a sentence.
pub(crate) fn scale(address: &Address, unit: &str, image: &ProgramImage) -> Result<ModuleScale, String> {
    let config = &image.config.s7200;
    let unit = unit.trim();
    let none = || Err("a unit needs an analog channel: AIW or AQW of an analog module in plc.toml".to_string());
    let scale = |channel: Channel, factor: f64| Ok(ModuleScale { channel, factor: Some(factor) });
    match (address.place, address.width) {
        (Place::S7200(Part::AnalogInput, byte), Width::Word) => {
            let Some(module) = input_module(config, byte) else { return none() };
            let (low, high) = (f64::from_bits(module.low), f64::from_bits(module.high));
            let span = high - low;
            if !(span.is_finite() && span > 0.0) {
                return Err(format!("the range of {} is not known; set it in plc.toml", module.name));
            }
            let channel = Channel::Input { low, high, bipolar: module.bipolar };
            match (unit, module.unit.as_str()) {
                ("%", _) => Ok(ModuleScale { channel, factor: None }),
                (unit, of_range) if unit == of_range => scale(channel, 1.0),
                ("mV", "V") => scale(channel, 1e-3),
                ("V", "mV") | ("A", "mA") => scale(channel, 1e3),
                (_, of_range) => Err(format!(
                    "the range of the channel is {low} to {high} {of_range}: write a number in {of_range} or in %"
                )),
            }
        }
        (Place::S7200(Part::AnalogOutput, byte), Width::Word) => {
            if module(config, byte, |module| module.outputs).is_none() {
                return none();
            }
            match unit {
                "%" => Ok(ModuleScale { channel: Channel::VoltageOutput, factor: None }),
                "V" => scale(Channel::VoltageOutput, 1.0),
                "mV" => scale(Channel::VoltageOutput, 1e-3),
                "mA" => scale(Channel::CurrentOutput, 1.0),
                _ => Err("an analog output has V and mA: write a number in V, in mA or in %".to_string()),
            }
        }
        (_, _) => none(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn em235(low: f64, high: f64, bipolar: bool) -> AnalogModule {
        let (low, high) = (low.to_bits(), high.to_bits());
        AnalogModule { name: "EM 235".to_string(), inputs: 4, outputs: 1, low, high, unit: "V".to_string(), bipolar }
    }

    fn input(low: f64, high: f64, bipolar: bool) -> ModuleScale {
        ModuleScale { channel: Channel::Input { low, high, bipolar }, factor: Some(1.0) }
    }

    #[test]
    fn unipolar_words_have_steps_of_8() {
        let volts = input(0.0, 10.0, false);
        for (value, word) in [(0.0, 0), (5.0, 16000), (10.0, 32000), (5.0009, 16000), (-1.0, 0), (12.0, 32760)] {
            assert_eq!(volts.word(value), word, "{value} V");
        }
        assert_eq!(volts.input(16000), 5.0);
        // 4 mA of 0 to 20 mA.
        assert_eq!(input(0.0, 20.0, false).word(4.0), 6400);
    }

    #[test]
    fn bipolar_words_have_steps_of_16() {
        let volts = input(-5.0, 5.0, true);
        for (value, word) in [(0.0, 0), (5.0, 32000), (-5.0, -32000), (2.5, 16000), (-0.0001, -16), (6.0, 32752)] {
            assert_eq!(volts.word(value), word, "{value} V");
        }
        assert_eq!(volts.input(-16000), -2.5);
    }

    #[test]
    fn raw_words_are_masked_by_the_module_of_the_channel() {
        let config =
            S7200Config { analog: vec![em235(0.0, 10.0, false), em235(-5.0, 5.0, true)], ..S7200Config::default() };
        assert_eq!(shown(&config, 0, 16003), 16000);
        assert_eq!(shown(&config, 6, 0x8000), 0);
        assert_eq!(shown(&config, 8, 0xFFFF), 0xFFF0);
        assert_eq!(shown(&config, 16, 16003), 16003);
        assert!(has_module(&config, 14) && !has_module(&config, 16));
        // One output reserves two words.
        assert!(module(&config, 0, |module| module.outputs).is_some());
        assert!(module(&config, 2, |module| module.outputs).is_none());
        assert!(module(&config, 4, |module| module.outputs).is_some());
    }

    #[test]
    fn outputs() {
        let volts = ModuleScale { channel: Channel::VoltageOutput, factor: Some(1.0) };
        assert_eq!((volts.output(32000), volts.output(-32000), volts.output(16015)), (10.0, -10.0, 5.0));
        let current = ModuleScale { channel: Channel::CurrentOutput, factor: Some(1.0) };
        assert_eq!((current.output(16000), current.output(-16000)), (10.0, 0.0));
    }
}
