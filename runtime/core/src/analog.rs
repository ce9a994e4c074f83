//! Analog values: from engineering units to the word that a channel shows, and back.
//!
//! One table of ranges. A word of 27648 is the end of the nominal range; next to it are overrange and underrange, beyond them
//! overflow (32767) and underflow (-32768).
//! Source: SIMATIC S7-300, Module Data, representation of analog values.

use plcc_abi::image::AnalogChannel;

use crate::s7200::ModuleScale;

/// Word at the end of the nominal range of voltages and currents.
const NOMINAL: i32 = 27648;
/// Largest word of the overrange, 117.589 %.
const OVER: i32 = 32511;
/// Least word of the underrange of bipolar ranges.
const UNDER: i32 = -32512;
/// Least word of the underrange of unipolar ranges, -17.593 %.
const UNDER_UNIPOLAR: i32 = -4864;
/// Word of 0 V or 0 mA at an output of 1 to 5 V or 4 to 20 mA.
const LIVE_ZERO: i32 = -6912;

/// The quantity that a range measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    Voltage,
    Current,
    Resistance,
    Temperature,
}

/// A measuring or output range.
#[derive(Debug, PartialEq)]
pub struct Range {
    pub name: &'static str,
    pub quantity: Quantity,
    /// Unit of `low` and `high`.
    pub unit: &'static str,
    /// Ends of the nominal range, and their words.
    low: f64,
    high: f64,
    low_word: i32,
    high_word: i32,
    /// Words of an input before overflow and underflow.
    least: i32,
    most: i32,
    /// Word below `least`.
    below: i16,
    /// Smallest word of an output that is not 0 V or 0 mA; `None`: no output has this range.
    least_output: Option<i32>,
}

const fn bipolar(name: &'static str, quantity: Quantity, unit: &'static str, high: f64) -> Range {
    let (low_word, high_word) = (-NOMINAL, NOMINAL);
    let least_output = Some(UNDER);
    Range {
        name,
        quantity,
        unit,
        low: -high,
        high,
        low_word,
        high_word,
        least: UNDER,
        most: OVER,
        below: i16::MIN,
        least_output,
    }
}

#[rustfmt::skip]
const fn unipolar(name: &'static str, quantity: Quantity, unit: &'static str, low: f64, high: f64, least: i32, least_output: Option<i32>) -> Range {
    // A range that is clipped at 0 shows 0 for whatever is less.
    let below = if least == 0 { 0 } else { i16::MIN };
    Range { name, quantity, unit, low, high, low_word: 0, high_word: NOMINAL, least, most: OVER, below, least_output }
}

/// Words are tenths or hundredths of a degree, as `per_degree` says.
#[rustfmt::skip]
const fn temperature(name: &'static str, per_degree: i32, low: i32, high: i32, least: i32, most: i32) -> Range {
    Range {
        name, quantity: Quantity::Temperature, unit: "°C",
        low: low as f64 / per_degree as f64, high: high as f64 / per_degree as f64,
        low_word: low, high_word: high, least, most, below: i16::MIN, least_output: None,
    }
}

use Quantity::{Current, Resistance, Voltage};

/// All ranges. Temperatures: nominal range, underrange and overrange from the data of SM 331.
#[rustfmt::skip]
pub const RANGES: &[Range] = &[
    bipolar("+-80 mV", Voltage, "mV", 80.0),
    bipolar("+-250 mV", Voltage, "mV", 250.0),
    bipolar("+-500 mV", Voltage, "mV", 500.0),
    bipolar("+-1 V", Voltage, "V", 1.0),
    bipolar("+-2.5 V", Voltage, "V", 2.5),
    bipolar("+-5 V", Voltage, "V", 5.0),
    bipolar("+-10 V", Voltage, "V", 10.0),
    bipolar("+-3.2 mA", Current, "mA", 3.2),
    bipolar("+-10 mA", Current, "mA", 10.0),
    bipolar("+-20 mA", Current, "mA", 20.0),
    unipolar("0..10 V", Voltage, "V", 0.0, 10.0, 0, Some(0)),
    unipolar("1..5 V", Voltage, "V", 1.0, 5.0, UNDER_UNIPOLAR, Some(LIVE_ZERO)),
    unipolar("0..20 mA", Current, "mA", 0.0, 20.0, UNDER_UNIPOLAR, Some(0)),
    unipolar("4..20 mA", Current, "mA", 4.0, 20.0, UNDER_UNIPOLAR, Some(LIVE_ZERO)),
    unipolar("150 Ohm", Resistance, "Ohm", 0.0, 150.0, 0, None),
    unipolar("300 Ohm", Resistance, "Ohm", 0.0, 300.0, 0, None),
    unipolar("600 Ohm", Resistance, "Ohm", 0.0, 600.0, 0, None),
    temperature("PT100 standard", 10, -2000, 8500, -2430, 10000),
    temperature("PT100 climate", 100, -12000, 13000, -14500, 15500),
    temperature("NI100 standard", 10, -600, 2500, -1050, 2950),
    temperature("NI100 climate", 100, -6000, 25000, -10500, 29500),
    temperature("type E", 10, -2700, 10000, -2700, 12000),
    temperature("type J", 10, -2100, 12000, -2100, 14500),
    temperature("type K", 10, -2700, 13720, -2700, 16220),
    temperature("type L", 10, -2000, 9000, -2000, 11500),
    temperature("type N", 10, -2700, 13000, -2700, 15500),
];

impl Range {
    /// Words at the ends of the nominal range.
    pub fn words(&self) -> (i32, i32) {
        (self.low_word, self.high_word)
    }
}

/// Units that can be written, with the quantity they belong to and their size in its base unit (V, mA, Ohm, degree).
const UNITS: &[(&str, Quantity, f64)] = &[
    ("V", Voltage, 1.0),
    ("mV", Voltage, 1e-3),
    ("mA", Current, 1.0),
    ("A", Current, 1e3),
    ("Ohm", Resistance, 1.0),
    ("Ω", Resistance, 1.0),
    ("°C", Quantity::Temperature, 1.0),
    ("C", Quantity::Temperature, 1.0),
];

/// The range of this name; blanks and letter case do not matter, `±` is `+-`.
pub fn range(name: &str) -> Option<&'static Range> {
    let plain = |text: &str| -> String {
        text.replace('±', "+-")
            .replace('…', "..")
            .chars()
            .filter(|c| !c.is_whitespace())
            .collect::<String>()
            .to_lowercase()
    };
    RANGES.iter().find(|range| plain(range.name) == plain(name))
}

/// A unit of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    Channel(ChannelScale),
    /// Of an analog module of an S7-200.
    Module(ModuleScale),
}

impl Scale {
    /// Numbers in `unit` at this channel. `Err`: the error as a sentence.
    pub fn new(channel: &AnalogChannel, unit: &str) -> Result<Scale, String> {
        ChannelScale::new(channel, unit).map(Scale::Channel)
    }

    /// The word that an input shows, or that produces this value at an output.
    pub fn word(&self, value: f64) -> i16 {
        match self {
            Scale::Channel(scale) => scale.word(value),
            Scale::Module(scale) => scale.word(value),
        }
    }

    /// The meaning of a word at an input.
    pub fn input(&self, word: i16) -> f64 {
        match self {
            Scale::Channel(scale) => scale.input(word),
            Scale::Module(scale) => scale.input(word),
        }
    }

    /// The value of an output.
    pub fn output(&self, word: i16) -> f64 {
        match self {
            Scale::Channel(scale) => scale.output(word),
            Scale::Module(scale) => scale.output(word),
        }
    }
}

/// A number in the unit of a channel and the word are proportional by parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelScale {
    range: &'static Range,
    /// Resolution in bits without the sign.
    bits: u8,
    wire_break: bool,
    unit: Unit,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Unit {
    /// Of 27648.
    Percent,
    /// A number of units of the range.
    Factor(f64),
}

impl ChannelScale {
    /// Numbers in `unit` at this channel. `Err`: the error as a sentence.
    pub fn new(channel: &AnalogChannel, unit: &str) -> Result<ChannelScale, String> {
        if channel.range.is_empty() {
            return Err("the range of this channel is not known; give its module a `range` in plc.toml".to_string());
        }
        let range =
            range(&channel.range).ok_or_else(|| format!("`{}` is not a range of analog modules", channel.range))?;
        let base = |name: &str| UNITS.iter().find(|(unit, ..)| *unit == name);
        let unit = match (unit.trim(), base(unit.trim())) {
            ("%", _) if range.quantity != Quantity::Temperature => Unit::Percent,
            (_, Some((_, quantity, size))) if *quantity == range.quantity => {
                Unit::Factor(size / base(range.unit).map_or(1.0, |(.., size)| *size))
            }
            _ => {
                let percent = if range.quantity == Quantity::Temperature { "" } else { " or in %" };
                return Err(format!(
                    "the channel has the range {}: write a number in {}{percent}",
                    range.name, range.unit
                ));
            }
        };
        Ok(ChannelScale { range, bits: channel.bits, wire_break: channel.wire_break, unit })
    }

    /// The word that an input shows, or that produces this value at an output.
    pub fn word(&self, value: f64) -> i16 {
        let exact = match self.unit {
            Unit::Percent => value / 100.0 * f64::from(NOMINAL),
            Unit::Factor(factor) => {
                let Range { low, high, low_word, high_word, .. } = self.range;
                f64::from(*low_word) + (value * factor - low) / (high - low) * f64::from(high_word - low_word)
            }
        };
        let word = exact.round();
        if word > f64::from(self.range.most) {
            i16::MAX
        } else if word >= f64::from(self.range.least) {
            (word as i16) & self.mask()
        } else if self.wire_break && self.range.low_word == 0 && self.range.low > 0.0 {
            i16::MAX
        } else {
            self.range.below
        }
    }

    /// The meaning of a word at an input.
    pub fn input(&self, word: i16) -> f64 {
        self.number(f64::from(word))
    }

    /// The value of an output: beyond its range 0 V or 0 mA.
    pub fn output(&self, word: i16) -> f64 {
        let least = self.range.least_output.unwrap_or(UNDER);
        let within = (least..=OVER).contains(&i32::from(word));
        // The word of 0 V or 0 mA.
        let zero = if self.range.low > 0.0 { LIVE_ZERO } else { 0 };
        self.number(if within { f64::from(word & self.mask()) } else { f64::from(zero) })
    }

    fn number(&self, word: f64) -> f64 {
        match self.unit {
            Unit::Percent => word / f64::from(NOMINAL) * 100.0,
            Unit::Factor(factor) => {
                let Range { low, high, low_word, high_word, .. } = self.range;
                (low + (word - f64::from(*low_word)) / f64::from(high_word - low_word) * (high - low)) / factor
            }
        }
    }

    /// Bits that the module has: the value is left-justified, the rest is 0. Temperatures are numbers, not parts of a range.
    fn mask(&self) -> i16 {
        match self.range.quantity {
            Quantity::Temperature => -1,
            Quantity::Voltage | Quantity::Current | Quantity::Resistance => {
                -1i16 << 15u8.saturating_sub(self.bits).min(14)
            }
        }
    }
}

/// `12.5 mA` as number and unit.
pub fn with_unit(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let end = text.char_indices().find(|&(at, c)| {
        let exponent = matches!(c, 'e' | 'E')
            && text[at + 1..].starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-'));
        !(c.is_ascii_digit() || matches!(c, '.' | '+' | '-') || exponent)
    })?;
    let (number, unit) = text.split_at(end.0);
    let number = number.trim().parse::<f64>().ok().filter(|number| number.is_finite())?;
    // `16#0100` is a literal.
    Some((number, unit.trim())).filter(|(_, unit)| !unit.is_empty() && !unit.starts_with('#'))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(range: &str, bits: u8, unit: &str) -> Scale {
        Scale::new(&AnalogChannel { range: range.to_string(), bits, wire_break: false }, unit).unwrap()
    }

    #[test]
    fn current_from_4_ma() {
        let ma = scale("4..20 mA", 15, "mA");
        for (current, word) in [(4.0, 0), (12.0, 13824), (20.0, 27648), (22.81, 32504), (1.19, -4856)] {
            assert_eq!(ma.word(current), word, "{current} mA");
        }
        assert_eq!((ma.word(22.82), ma.word(1.18)), (32767, -32768));
        assert_eq!(scale("4..20 mA", 15, "%").word(40.0), 11059);
        assert_eq!(scale("4..20 mA", 15, "A").word(0.012), 13824);
        let checked = AnalogChannel { range: "4..20 mA".to_string(), bits: 15, wire_break: true };
        assert_eq!(Scale::new(&checked, "mA").unwrap().word(0.0), 32767, "wire break");
        assert_eq!(ma.input(13824), 12.0);
    }

    #[test]
    fn voltages() {
        let volts = scale("±10 V", 15, "V");
        for (voltage, word) in
            [(10.0, 27648), (-10.0, -27648), (0.0, 0), (5.0, 13824), (11.76, 32767), (-11.76, -32768)]
        {
            assert_eq!(volts.word(voltage), word, "{voltage} V");
        }
        assert_eq!(volts.word(11.7585), 32510);
        assert_eq!(scale("0..10 V", 15, "V").word(-1.0), 0, "clipped");
        assert_eq!(scale("+-80 mV", 15, "V").word(0.08), 27648);
        assert_eq!(scale("0..20 mA", 15, "mA").word(-3.6), -32768);
    }

    #[test]
    fn resolution_leaves_low_bits_0() {
        // 12 bits and sign: steps of 8.
        assert_eq!(scale("4..20 mA", 12, "%").word(40.0), 11056);
        assert_eq!(scale("+-10 V", 12, "V").word(-0.001), -8);
        assert!((scale("+-10 V", 11, "V").output(23) - 16.0 / 27648.0 * 10.0).abs() < 1e-9);
    }

    #[test]
    fn temperatures() {
        assert_eq!(scale("PT100 standard", 12, "°C").word(23.4), 234);
        assert_eq!(scale("PT100 climate", 12, "C").word(23.45), 2345);
        assert_eq!(scale("PT100 standard", 12, "C").word(1000.1), 32767);
        assert_eq!(scale("type K", 12, "C").word(-270.1), -32768);
    }

    #[test]
    fn outputs() {
        let volts = scale("+-10 V", 15, "V");
        assert_eq!((volts.output(27648), volts.output(-27648), volts.output(32512)), (10.0, -10.0, 0.0));
        let current = scale("4..20 mA", 15, "mA");
        assert_eq!((current.output(0), current.output(27648), current.output(-6912)), (4.0, 20.0, 0.0));
        assert_eq!((current.output(-6913), current.output(32512)), (0.0, 0.0));
        assert_eq!(scale("0..10 V", 15, "V").output(-100), 0.0);
    }

    #[test]
    fn what_does_not_fit_is_told() {
        let channel = |range: &str| AnalogChannel { range: range.to_string(), bits: 12, wire_break: false };
        assert!(Scale::new(&channel(""), "mA").unwrap_err().contains("is not known"));
        assert!(Scale::new(&channel("4..20 mA"), "V").unwrap_err().contains("write a number in mA or in %"));
        assert!(Scale::new(&channel("PT100 climate"), "%").is_err());
        assert_eq!(with_unit("12.5 mA"), Some((12.5, "mA")));
        assert_eq!(with_unit("-1.5e1%"), Some((-15.0, "%")));
        assert_eq!((with_unit("16#100"), with_unit("12"), with_unit("mA")), (None, None, None));
    }
}
