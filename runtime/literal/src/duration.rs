//! Durations.

/// Where a duration of a language may have a fraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fraction {
    /// In each unit, also without digits on one side of the point, as STEP 7 takes it: `T#1.5H_30M`, `T#.5S`.
    Anywhere,
    /// In the last unit only, as the TIA Portal takes it.
    Last,
}

/// The smallest unit of a duration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Smallest {
    /// TIME, S5TIME.
    Millisecond,
    /// LTIME.
    Nanosecond,
}

/// Why a text is not a duration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Not numbers with units in descending order.
    Form,
    /// A number that must go into the next larger unit, because one is before it: `1M_90S`.
    Unit { number: i128, unit: &'static str },
}

/// Letters, nanoseconds, and from which number on the next larger unit must be used.
const UNITS: [(&str, i128, i128); 7] = [
    ("D", 86_400_000_000_000, i128::MAX),
    ("H", 3_600_000_000_000, 24),
    ("M", 60_000_000_000, 60),
    ("S", 1_000_000_000, 60),
    ("MS", 1_000_000, 1000),
    ("US", 1000, 1000),
    ("NS", 1, 1000),
];

/// Milliseconds of the word of an S5TIME; `None`: a digit is above 9. Source: Programming with STEP 7, format of S5TIME.
pub fn s5time_milliseconds(word: u16) -> Option<u64> {
    let digit = |shift: u32| Some(u64::from(word >> shift & 0xF)).filter(|digit| *digit <= 9);
    let units = digit(8)? * 100 + digit(4)? * 10 + digit(0)?;
    Some(units * 10u64.pow(1 + u32::from(word >> 12 & 3)))
}

/// Milliseconds of the S5TIME `word`, if they are less than those of the duration that was written for it: `12S345MS`.
pub fn s5time_cut(written: &str, word: u16) -> Option<u64> {
    let written_ns = nanoseconds(written, Smallest::Millisecond, Fraction::Anywhere).ok()?;
    s5time_milliseconds(word).filter(|ms| i128::from(*ms) * 1_000_000 < written_ns)
}

/// Reads `1D2H3M4S5MS`, with a sign or without, in any letter case, `_` between the units allowed. In nanoseconds; what is below is
/// cut off.
pub fn nanoseconds(value: &str, smallest: Smallest, fraction: Fraction) -> Result<i128, Fault> {
    let units = match smallest {
        Smallest::Millisecond => &UNITS[..5],
        Smallest::Nanosecond => &UNITS[..],
    };
    let compact: String = value.chars().filter(|c| *c != '_').collect::<String>().to_ascii_uppercase();
    let (negative, mut rest) = match compact.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, compact.strip_prefix('+').unwrap_or(&compact)),
    };
    let mut total = 0i128;
    let mut next_unit = 0;
    let mut ended = false;
    while !rest.is_empty() {
        let digits = rest.find(|c: char| !c.is_ascii_digit() && c != '.').ok_or(Fault::Form)?;
        let letters = rest[digits..].find(|c: char| !c.is_ascii_alphabetic()).map_or(rest.len(), |at| digits + at);
        let (number, name) = (&rest[..digits], &rest[digits..letters]);
        let unit = units.iter().position(|(unit, ..)| *unit == name).ok_or(Fault::Form)?;
        let (name, unit_ns, limit) = UNITS[unit];
        if unit < next_unit || ended {
            return Err(Fault::Form);
        }
        let one_sided = number.starts_with('.') || number.ends_with('.');
        if one_sided && fraction == Fraction::Last {
            return Err(Fault::Form);
        }
        ended = number.contains('.') && fraction == Fraction::Last;
        let ns = Scaled::parse(number, unit_ns).ok_or(Fault::Form)?.whole;
        if next_unit > 0 && ns / unit_ns >= limit {
            return Err(Fault::Unit { number: ns / unit_ns, unit: name });
        }
        total += ns;
        next_unit = unit + 1;
        rest = &rest[letters..];
    }
    if next_unit == 0 { Err(Fault::Form) } else { Ok(if negative { -total } else { total }) }
}

/// Reads `10ms`, `1.5s`, `500us`, `2m`, `0` of flags and files, in nanoseconds, cut off below; at most a year. `None`: not a duration.
pub fn span(text: &str) -> Option<u64> {
    const YEAR_NS: i128 = 32_000_000_000_000_000;
    let lower = text.trim().to_ascii_lowercase();
    let (number, unit) = lower.split_at(lower.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(lower.len()));
    let unit_ns = match unit.trim() {
        "ns" => 1,
        "us" | "µs" => 1_000,
        "ms" => 1_000_000,
        "s" => 1_000_000_000,
        "m" | "min" => 60_000_000_000,
        "h" => 3_600_000_000_000,
        "" if number == "0" => 1,
        _ => return None,
    };
    let ns = Scaled::parse(number, unit_ns)?.whole;
    u64::try_from(ns).ok().filter(|_| ns <= YEAR_NS)
}

/// How [`span`] wants what the author of `text` meant: `5s` for `5 sec`, `T#5S` or `5,0 s`, `300ms` for `300`. `None`: no idea.
pub fn meant_span(text: &str) -> Option<String> {
    let lower = text.trim().to_ascii_lowercase();
    let bare = ["s5t#", "s5time#", "lt#", "t#", "time#"].iter().find_map(|prefix| lower.strip_prefix(prefix));
    let bare = bare.unwrap_or(&lower).replace(',', ".");
    let (number, unit) = bare.split_at(bare.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(bare.len()));
    let unit = match unit.trim().trim_end_matches('.') {
        "" | "ms" | "msec" | "msecs" | "millis" | "millisecond" | "milliseconds" => "ms",
        "us" | "µs" | "usec" | "usecs" | "microsecond" | "microseconds" => "us",
        "s" | "sec" | "secs" | "second" | "seconds" => "s",
        "m" | "min" | "mins" | "minute" | "minutes" => "m",
        "h" | "hr" | "hrs" | "hour" | "hours" => "h",
        _ => return None,
    };
    let number = number.strip_suffix(".0").unwrap_or(number);
    Some(format!("{number}{unit}")).filter(|meant| span(meant).is_some() && meant != text)
}

/// Reads the interval of a task in PLCopen XML: `T#1s500ms`, `PT0.02S`, `P0DT0H0M0.01S`, `20ms`. In nanoseconds, a part of one rounded
/// up; `None`: not a duration.
pub fn interval(text: &str) -> Option<u64> {
    let lower = text.trim().to_ascii_lowercase();
    let iso = lower.strip_prefix('p').map(|rest| rest.replacen('t', "", 1));
    let prefixes = ["lt#", "ltime#", "t#", "time#"];
    let typed = prefixes.iter().find_map(|prefix| lower.strip_prefix(prefix));
    let mut rest: &str = iso.as_deref().or(typed).unwrap_or(&lower);
    let mut total = 0i128;
    while !rest.is_empty() {
        let digits = rest.find(|c: char| !c.is_ascii_digit() && c != '.')?;
        let (number, tail) = rest.split_at(digits);
        let end = tail.find(|c: char| c.is_ascii_digit() || c == '_').unwrap_or(tail.len());
        let unit = tail[..end].replace('µ', "u").to_ascii_uppercase();
        let (_, unit_ns, _) = UNITS.iter().find(|(name, ..)| *name == unit)?;
        let Scaled { whole, exact } = Scaled::parse(number, *unit_ns)?;
        total += whole + i128::from(!exact);
        rest = tail[end..].trim_start_matches('_');
    }
    u64::try_from(total).ok()
}

/// Numbers above this exceed every type, in each unit.
const NUMBER_MAX: i128 = 10i128.pow(22);

/// A decimal number times a unit.
struct Scaled {
    /// Fractions are cut off.
    whole: i128,
    /// Nothing was cut off.
    exact: bool,
}

impl Scaled {
    /// An unsigned number: `2`, `1.001`, `.5`. Exact, as no binary number is; `None`: not a number, or one that no duration has.
    fn parse(number: &str, unit: i128) -> Option<Scaled> {
        let (whole, part) = number.split_once('.').unwrap_or((number, ""));
        let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
        if whole.is_empty() && part.is_empty() || !digits(whole) || !digits(part) {
            return None;
        }
        let whole = match whole {
            "" => 0,
            digits => digits.parse().map_or(NUMBER_MAX, |whole: i128| whole.min(NUMBER_MAX)),
        };
        // After this many digits of a day no nanosecond is left.
        let (part, below) = part.split_at(part.len().min(15));
        let scale = 10i128.pow(part.len() as u32);
        let fraction = part.parse::<i128>().unwrap_or(0) * unit;
        let exact = fraction % scale == 0 && below.bytes().all(|digit| digit == b'0');
        Some(Scaled { whole: whole * unit + fraction / scale, exact })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_in_spans() {
        let meant = |text: &str| meant_span(text).unwrap_or_default();
        assert_eq!(
            ["10 msec", "5 sec", "T#2S", "1,5 s", "5,0s", "300", "2 hours"].map(meant),
            ["10ms", "5s", "2s", "1.5s", "5s", "300ms", "2h"]
        );
        assert_eq!(["soon", "5 weeks", "10ms", "", "1..5s", "-5 sec"].map(meant), [""; 6]);
    }

    #[test]
    fn s5times_that_are_cut() {
        assert_eq!(s5time_cut("12S345MS", 0x1123), Some(12_300));
        assert_eq!(s5time_cut("5ms", 0x0000), Some(0));
        assert_eq!([s5time_cut("12S300MS", 0x1123), s5time_cut("2H_46M_30S", 0x3999), s5time_cut("x", 0)], [None; 3]);
    }

    #[test]
    fn durations_of_languages() {
        let step7 = |text: &str| nanoseconds(text, Smallest::Millisecond, Fraction::Anywhere);
        let portal = |text: &str| nanoseconds(text, Smallest::Nanosecond, Fraction::Last);
        assert_eq!(step7("1.001S"), Ok(1_001_000_000));
        assert_eq!(step7("2.01s"), Ok(2_010_000_000));
        assert_eq!(step7("-1d_2H3m_4s5MS"), Ok(-93_784_005_000_000));
        assert_eq!(step7("1.5H_30M"), Ok(7_200_000_000_000));
        assert_eq!(step7(".5S"), Ok(500_000_000));
        assert_eq!(step7("5.S"), Ok(5_000_000_000));
        assert_eq!(portal("1S_2MS_3US_4NS"), Ok(1_002_003_004));
        assert_eq!(portal("0.0000000019S"), Ok(1));
        assert_eq!(portal("7878411002202052351NS"), Ok(7_878_411_002_202_052_351));
        assert_eq!(portal("00000000000000000000012S"), Ok(12_000_000_000));
        assert!(portal(&format!("{}NS", "9".repeat(20))).is_ok_and(|ns| ns > i128::from(i64::MAX)));
        assert_eq!(step7("1M_90S"), Err(Fault::Unit { number: 90, unit: "S" }));
        assert_eq!(step7("90S"), Ok(90_000_000_000));
        for text in ["", "-", "5", "S", "1.2.3S", "1S1M", "1S1S", "5US", ".S"] {
            assert_eq!(step7(text), Err(Fault::Form), "{text}");
        }
        for text in [".5S", "5.S", "1.5S_100MS"] {
            assert_eq!(portal(text), Err(Fault::Form), "{text}");
        }
        for ms in 0..1000 {
            assert_eq!(step7(&format!("31.{ms:03}S")), Ok((31_000 + ms) * 1_000_000));
        }
        assert!(step7(&format!("{}D", "9".repeat(40))).is_ok_and(|ns| ns > i128::from(u64::MAX)));
    }

    #[test]
    fn spans_of_flags_and_files() {
        for (text, ns) in [
            ("10ms", 10_000_000),
            ("1.5s", 1_500_000_000),
            ("500us", 500_000),
            ("0", 0),
            ("2m", 120_000_000_000),
            ("0.000000001s", 1),
            ("1.001 s", 1_001_000_000),
        ] {
            assert_eq!(span(text), Some(ns), "{text}");
        }
        for text in ["", "10", "ms", "-1s", "1e3s", "1.2.3s", ".s", "9999999999h"] {
            assert_eq!(span(text), None, "{text}");
        }
    }

    #[test]
    fn intervals_of_projects() {
        for (text, ns) in [
            ("T#20ms", 20_000_000),
            ("PT0.02S", 20_000_000),
            ("P0DT0H0M1.5S", 1_500_000_000),
            ("t#1s_500ms", 1_500_000_000),
            ("T#100µs", 100_000),
            ("PT4.035S", 4_035_000_000),
            ("T#1.001s", 1_001_000_000),
            ("T#1.5ns", 2),
            ("T#0s", 0),
        ] {
            assert_eq!(interval(text), Some(ns), "{text}");
        }
        for text in ["soon", "T#.s", "T#1.2.3s", "T#99999999999999999999s", "T#5"] {
            assert_eq!(interval(text), None, "{text}");
        }
    }
}
