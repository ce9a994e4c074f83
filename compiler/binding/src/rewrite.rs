//! How the author of a constant would write it with another type, from the text as it stands.
//!
//! ```text
//! T#7S for an S5TIME ──► write `S5T#7S`        5 for a REAL ──► write `5.0`        3.0 for an INT ──► write `3`
//! ```

use plcc_literal::duration::{self, Fraction, Smallest};
use plcc_literal::number;
use plcc_model::types::Elementary;
use plcc_syntax::Class;

const NS_PER_MS: i128 = 1_000_000;
const NS_PER_S: i128 = 1_000_000_000;

/// The language in which the constant is to be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A DINT has `L#`.
    Stl,
    Scl,
}

/// What to write for the constant `text` where a value of `ty` is wanted.
pub fn help(ty: Elementary, text: &str, form: Form) -> String {
    of_constant(ty, text, form).unwrap_or_else(|| wanted(ty))
}

/// As [`help`]; none if `text` is not a constant, or has no form as a value of `ty`.
pub fn of_constant(ty: Elementary, text: &str, form: Form) -> Option<String> {
    let written = Meaning::of(text)?.written(ty, form)?;
    Some(format!("write {written}"))
}

/// What a constant of `ty` looks like, where nothing can be made of the one that stands there.
pub fn wanted(ty: Elementary) -> String {
    match (ty, ty.class()) {
        (Elementary::Bool, _) => "write TRUE or FALSE".to_owned(),
        (_, Class::Signed | Class::Unsigned) => {
            let (low, high) = range(ty);
            format!("write a whole number from {low} to {high}")
        }
        (_, Class::Bits) => format!("write up to {} hexadecimal digits after `{}`", ty.bits() / 4, bits_prefix(ty)),
        (_, Class::Float) => "write a number with a decimal point".to_owned(),
        (Elementary::S5Time, _) => {
            "write a duration after `S5T#`, with the units H, M, S, MS: 10 ms to 2 h 46 min 30 s".to_owned()
        }
        (_, Class::Duration) => {
            format!("write a duration after `{}`, with the units D, H, M, S, MS", duration_prefix(ty))
        }
        (_, Class::Character) => "write one character in single quotes".to_owned(),
        (_, Class::Date) => match ty {
            Elementary::Date => "write year-month-day after `D#`".to_owned(),
            Elementary::TimeOfDay => "write hours:minutes:seconds after `TOD#`".to_owned(),
            Elementary::Ltod => "write hours:minutes:seconds after `LTOD#`".to_owned(),
            _ => "write year-month-day-hours:minutes:seconds after `LDT#`".to_owned(),
        },
    }
}

/// As [`help`], for a DATE_AND_TIME.
pub fn date_and_time(text: &str) -> String {
    match Meaning::of(text) {
        Some(Meaning::Date(Some(date), time)) => {
            format!("write `DT#{date}-{}`", time.unwrap_or_else(|| "0:0:0".to_owned()))
        }
        _ => "write year-month-day-hours:minutes:seconds after `DT#`".to_owned(),
    }
}

/// As [`help`], for a STRING.
pub fn text(constant: &str) -> String {
    let inner = constant.trim().trim_matches(['"', '\'']);
    format!("write the text in single quotes: `'{inner}'`")
}

/// What is wrong with the S5TIME constant `text`, whose bits are `word`, and what to write, if it is a shorter time than the text says.
pub fn cut_s5time(text: &str, word: u16) -> Option<(String, String)> {
    let (prefix, written) = text.split_once('#')?;
    let is_s5time = ["S5T", "S5TIME"].iter().any(|known| prefix.eq_ignore_ascii_case(known));
    let ms = duration::s5time_cut(written, word).filter(|_| is_s5time)?;
    if ms == 0 {
        let title = format!("`{text}` is 0, since an S5TIME counts units of 10 ms");
        return Some((title, "write `S5T#10MS` for the shortest time".to_owned()));
    }
    let unit = ["10 ms", "100 ms", "1 s", "10 s"][usize::from(word >> 12 & 3)];
    let title = format!("`{text}` is {ms} ms, since an S5TIME counts up to 999 units, here of {unit}");
    Some((title, format!("write the time that the timer has, `S5T#{ms}MS`")))
}

/// Which values a variable of the type holds.
pub fn holds(ty: Elementary) -> String {
    match ty.class() {
        Class::Signed | Class::Unsigned => {
            let (low, high) = range(ty);
            format!("{} goes from {low} to {high}", ty.name())
        }
        Class::Bits if ty == Elementary::Bool => "BOOL is TRUE or FALSE".to_owned(),
        Class::Bits => format!("{} has {} bits", ty.name(), ty.bits()),
        Class::Float | Class::Character | Class::Duration | Class::Date => {
            format!("outside of the range of {}", ty.name())
        }
    }
}

/// A type that holds the whole number `value`, of the same kind as `ty`.
pub fn roomy(value: i128, ty: Elementary) -> Option<&'static str> {
    if ty.class() == Class::Bits {
        let larger = [Elementary::Byte, Elementary::Word, Elementary::Dword, Elementary::Lword];
        return larger.into_iter().find(|larger| (0..1 << larger.bits()).contains(&value)).map(Elementary::name);
    }
    match value {
        _ if i16::try_from(value).is_ok() => Some("INT"),
        _ if i32::try_from(value).is_ok() => Some("DINT"),
        _ => None,
    }
}

/// The address `text` with another width: `M 0.0` for `MW 0`. None: it is not an address of one area.
pub fn address_of_width(text: &str, width: char) -> Option<String> {
    let compact: String = text.trim().trim_start_matches('%').chars().filter(|c| !c.is_whitespace()).collect();
    let (data, rest) = match compact.rfind("DB").filter(|at| compact[..*at].ends_with('.')) {
        Some(at) => compact.split_at(at + 2),
        None => compact
            .split_at(compact.find(|c: char| "IQMEA".contains(c.to_ascii_uppercase())).filter(|at| *at == 0)? + 1),
    };
    let rest = rest.trim_start_matches(['X', 'B', 'W', 'D']);
    let byte = rest.split('.').next().filter(|byte| !byte.is_empty() && byte.bytes().all(|c| c.is_ascii_digit()))?;
    let letter = match (width, data.len()) {
        ('X', 1) => String::new(),
        (letter, _) => letter.to_string(),
    };
    let bit = if width == 'X' { ".0" } else { "" };
    Some(format!("{data}{letter} {byte}{bit}"))
}

/// `P#M 2.0 WORD 1` for the address `MW 2`. None: it is not an address of one area.
pub fn any_pointer(text: &str) -> Option<String> {
    let bit = address_of_width(text, 'X')?;
    let compact: String = text.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_ascii_uppercase();
    let letters = compact.trim_end_matches(|c: char| c.is_ascii_digit());
    let ty = match letters.chars().next_back() {
        Some('B') => "BYTE",
        Some('W') => "WORD",
        Some('D') => "DWORD",
        _ => return None,
    };
    Some(format!("P#{bit} {ty} 1"))
}

/// What the author meant, whatever its form.
enum Meaning {
    Bool(bool),
    Whole(i128),
    Real(f64),
    /// Nanoseconds.
    Duration(i128),
    /// `2020-1-31`, `5:45:00`.
    Date(Option<String>, Option<String>),
    Text(String),
}

/// `2024-01-31`, which is a subtraction without `D#` before it.
fn is_date(text: &str) -> bool {
    let lengths: Vec<usize> = text.split('-').map(str::len).collect();
    let digits = text.bytes().all(|byte| byte.is_ascii_digit() || byte == b'-');
    digits && matches!(lengths.as_slice(), [4, 1 | 2, 1 | 2])
}

impl Meaning {
    fn of(text: &str) -> Option<Meaning> {
        let text = text.trim();
        for quote in ['\'', '"'] {
            let inner = text.strip_prefix(quote).and_then(|rest| rest.strip_suffix(quote));
            if let Some(inner) = inner {
                return Some(Meaning::Text(inner.to_owned()));
            }
        }
        let upper = text.to_ascii_uppercase();
        match upper.as_str() {
            "TRUE" => return Some(Meaning::Bool(true)),
            "FALSE" => return Some(Meaning::Bool(false)),
            _ => {}
        }
        if is_date(&upper) {
            return Some(Meaning::Date(Some(upper), None));
        }
        let Some((prefix, rest)) = upper.split_once('#') else { return Meaning::number(&upper) };
        match prefix {
            "T" | "TIME" | "LT" | "LTIME" | "S5T" | "S5TIME" => nanoseconds(rest).map(Meaning::Duration),
            "16" | "8" | "2" => match number::based(prefix, rest) {
                Ok(number::Based { value, .. }) => Some(Meaning::Whole(value.into())),
                Err(_) => None,
            },
            "D" | "DATE" => Some(Meaning::Date(Some(rest.to_owned()), None)),
            "TOD" | "TIME_OF_DAY" | "LTOD" => Some(Meaning::Date(None, Some(rest.to_owned()))),
            "DT" | "DATE_AND_TIME" | "LDT" | "DTL" => {
                let (date, time) = rest.rsplit_once('-')?;
                Some(Meaning::Date(Some(date.to_owned()), Some(time.to_owned())))
            }
            // `INT#5`, `W#16#FF`.
            _ => match rest.split_once('#') {
                Some((base, digits)) => {
                    number::based(base, digits).ok().map(|based| Meaning::Whole(based.value.into()))
                }
                None => Meaning::number(rest).or(match rest {
                    "TRUE" => Some(Meaning::Bool(true)),
                    "FALSE" => Some(Meaning::Bool(false)),
                    _ => None,
                }),
            },
        }
    }

    fn number(text: &str) -> Option<Meaning> {
        if let Some(value) = number::integer(text) {
            return Some(Meaning::Whole(value));
        }
        if text.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.')) {
            let value =
                text.replace('_', "").replacen(',', ".", 1).parse::<f64>().ok().filter(|value| value.is_finite());
            return value.map(Meaning::Real).or_else(|| nanoseconds(text).map(Meaning::Duration));
        }
        None
    }

    /// In quotes for a message.
    fn written(&self, ty: Elementary, form: Form) -> Option<String> {
        let one = |text: String| Some(format!("`{text}`"));
        if let Meaning::Text(text) = self {
            return match ty.class() {
                Class::Character if text.chars().count() == 1 => one(character(ty, text)),
                Class::Character => None,
                _ => match Meaning::of(text) {
                    None | Some(Meaning::Text(_)) => None,
                    Some(inner) => inner.written(ty, form),
                },
            };
        }
        match (ty, ty.class()) {
            (Elementary::Bool, _) => match self {
                Meaning::Bool(value) => one(truth(*value)),
                Meaning::Whole(value @ (0 | 1)) => one(truth(*value == 1)),
                _ => None,
            },
            (_, Class::Signed | Class::Unsigned) => {
                let (value, note) = match self {
                    Meaning::Bool(value) => (i128::from(*value), ""),
                    Meaning::Whole(value) => (*value, ""),
                    Meaning::Real(value) if value.fract() != 0.0 => {
                        (value.round() as i128, ", which is rounded, or use the type REAL")
                    }
                    Meaning::Real(value) => (*value as i128, ""),
                    Meaning::Duration(ns) => (ns / NS_PER_MS, ", the number of milliseconds"),
                    Meaning::Date(..) | Meaning::Text(_) => return None,
                };
                let (low, high) = range(ty);
                let prefix = if ty == Elementary::Dint && form == Form::Stl { "L#" } else { "" };
                (low..=high).contains(&value).then(|| format!("`{prefix}{value}`{note}"))
            }
            (_, Class::Bits) => {
                let value = match self {
                    Meaning::Bool(value) => i128::from(*value),
                    Meaning::Whole(value) => *value,
                    Meaning::Real(_) | Meaning::Duration(_) | Meaning::Date(..) | Meaning::Text(_) => return None,
                };
                let limit = 1i128 << ty.bits();
                let fits = (-limit / 2..limit).contains(&value);
                fits.then(|| format!("`{}{:X}`", bits_prefix(ty), value.rem_euclid(limit)))
            }
            (_, Class::Float) => match self {
                Meaning::Whole(value) => one(format!("{value}.0")),
                Meaning::Real(value) => one(format!("{value:?}")),
                Meaning::Duration(ns) => Some(format!("`{:?}`, in seconds", *ns as f64 / NS_PER_S as f64)),
                Meaning::Bool(_) | Meaning::Date(..) | Meaning::Text(_) => None,
            },
            (_, Class::Duration) => match self {
                Meaning::Duration(ns) => duration_of(ty, *ns).and_then(one),
                Meaning::Whole(value) => {
                    let seconds = duration_of(ty, value.checked_mul(NS_PER_S)?);
                    let milliseconds = duration_of(ty, value.checked_mul(NS_PER_MS)?);
                    match (seconds, milliseconds) {
                        (Some(seconds), Some(milliseconds)) if seconds != milliseconds => {
                            Some(format!("`{seconds}` for seconds, `{milliseconds}` for milliseconds"))
                        }
                        (seconds, milliseconds) => seconds.or(milliseconds).and_then(one),
                    }
                }
                Meaning::Real(value) if value.abs() < 1e9 => {
                    let ns = (value * NS_PER_S as f64).round() as i128;
                    duration_of(ty, ns / NS_PER_MS * NS_PER_MS).map(|text| format!("`{text}` for seconds"))
                }
                Meaning::Real(_) | Meaning::Bool(_) | Meaning::Date(..) | Meaning::Text(_) => None,
            },
            (_, Class::Character) => match self {
                Meaning::Whole(value @ 0..=9) => one(character(ty, &value.to_string())),
                _ => None,
            },
            (_, Class::Date) => match (ty, self) {
                (Elementary::Date, Meaning::Date(Some(date), _)) => one(format!("D#{date}")),
                (Elementary::TimeOfDay, Meaning::Date(_, Some(time))) => one(format!("TOD#{time}")),
                (Elementary::Ltod, Meaning::Date(_, Some(time))) => one(format!("LTOD#{time}")),
                (Elementary::Ldt, Meaning::Date(Some(date), time)) => {
                    one(format!("LDT#{date}-{}", time.as_deref().unwrap_or("0:0:0")))
                }
                _ => None,
            },
        }
    }
}

fn nanoseconds(text: &str) -> Option<i128> {
    duration::nanoseconds(text, Smallest::Nanosecond, Fraction::Anywhere).ok()
}

fn truth(value: bool) -> String {
    if value { "TRUE".to_owned() } else { "FALSE".to_owned() }
}

fn character(ty: Elementary, text: &str) -> String {
    let prefix = if ty == Elementary::Wchar { "WCHAR#" } else { "" };
    format!("{prefix}'{text}'")
}

fn range(ty: Elementary) -> (i128, i128) {
    let bits = ty.bits();
    if ty.is_signed() { (-(1 << (bits - 1)), (1 << (bits - 1)) - 1) } else { (0, (1 << bits) - 1) }
}

const fn bits_prefix(ty: Elementary) -> &'static str {
    match ty {
        Elementary::Byte => "B#16#",
        Elementary::Word => "W#16#",
        Elementary::Dword => "DW#16#",
        _ => "16#",
    }
}

const fn duration_prefix(ty: Elementary) -> &'static str {
    match ty {
        Elementary::S5Time => "S5T#",
        Elementary::Ltime => "LT#",
        _ => "T#",
    }
}

/// The duration as a constant of `ty`; none: outside of its range.
fn duration_of(ty: Elementary, ns: i128) -> Option<String> {
    const S5_LEAST_MS: i128 = 10;
    const S5_MOST_MS: i128 = 9_990_000;
    let ms = ns / NS_PER_MS;
    let fits = match ty {
        Elementary::S5Time => (S5_LEAST_MS..=S5_MOST_MS).contains(&ms) && ms % S5_LEAST_MS == 0,
        Elementary::Time => i32::try_from(ms).is_ok(),
        _ => i64::try_from(ns).is_ok(),
    };
    if !fits {
        return None;
    }
    let mut rest = ms.abs();
    let mut parts = Vec::new();
    for (unit, milliseconds) in [("D", 86_400_000), ("H", 3_600_000), ("M", 60_000), ("S", 1000), ("MS", 1)] {
        if ty == Elementary::S5Time && unit == "D" {
            continue;
        }
        let count = rest / milliseconds;
        rest %= milliseconds;
        if count > 0 {
            parts.push(format!("{count}{unit}"));
        }
    }
    if parts.is_empty() {
        parts.push("0S".to_owned());
    }
    let sign = if ms < 0 { "-" } else { "" };
    Some(format!("{}{sign}{}", duration_prefix(ty), parts.join("_")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stl(ty: Elementary, text: &str) -> String {
        help(ty, text, Form::Stl)
    }

    #[test]
    fn uses_the_value_of_the_author() {
        assert_eq!(stl(Elementary::S5Time, "T#7S"), "write `S5T#7S`");
        assert_eq!(stl(Elementary::Time, "S5T#1M_30S"), "write `T#1M_30S`");
        assert_eq!(stl(Elementary::Time, "5"), "write `T#5S` for seconds, `T#5MS` for milliseconds");
        assert_eq!(stl(Elementary::S5Time, "5"), "write `S5T#5S`");
        assert_eq!(stl(Elementary::Time, "2.5"), "write `T#2S_500MS` for seconds");
        assert_eq!(stl(Elementary::Real, "5"), "write `5.0`");
        assert_eq!(stl(Elementary::Real, "3,5"), "write `3.5`");
        assert_eq!(stl(Elementary::Int, "3.0"), "write `3`");
        assert_eq!(stl(Elementary::Int, "T#2S"), "write `2000`, the number of milliseconds");
        assert_eq!(stl(Elementary::Int, "16#10"), "write `16`");
        assert_eq!(stl(Elementary::Dint, "12"), "write `L#12`");
        assert_eq!(help(Elementary::Dint, "12.0", Form::Scl), "write `12`");
        assert_eq!(stl(Elementary::Word, "-1"), "write `W#16#FFFF`");
        assert_eq!(stl(Elementary::Bool, "1"), "write `TRUE`");
        assert_eq!(stl(Elementary::Char, "\"a\""), "write `'a'`");
        assert_eq!(stl(Elementary::Int, "'17'"), "write `17`");
        assert_eq!(stl(Elementary::Date, "DT#2020-1-31-5:00:00"), "write `D#2020-1-31`");
    }

    #[test]
    fn addresses_keep_their_byte() {
        assert_eq!(address_of_width("MW 10", 'X').as_deref(), Some("M 10.0"));
        assert_eq!(address_of_width("DB1.DBX 2.3", 'W').as_deref(), Some("DB1.DBW 2"));
        assert_eq!(address_of_width("I 0.5", 'B').as_deref(), Some("IB 0"));
        assert_eq!(address_of_width("#speed", 'B'), None);
        assert_eq!(any_pointer("MW 2").as_deref(), Some("P#M 2.0 WORD 1"));
        assert_eq!(any_pointer("DB1.DBD 4").as_deref(), Some("P#DB1.DBX 4.0 DWORD 1"));
        assert_eq!(any_pointer("5"), None);
    }

    #[test]
    fn names_the_form_where_nothing_fits() {
        assert_eq!(stl(Elementary::Int, "70000"), "write a whole number from -32768 to 32767");
        assert_eq!(stl(Elementary::Bool, "5"), "write TRUE or FALSE");
        assert_eq!(stl(Elementary::Word, "16#12345"), "write up to 4 hexadecimal digits after `W#16#`");
        assert!(stl(Elementary::S5Time, "T#9H").contains("S5T#"));
        for ty in Elementary::ALL {
            assert!(!wanted(ty).is_empty() && !stl(ty, "speed").is_empty(), "{}", ty.name());
        }
    }
}
