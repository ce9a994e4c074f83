//! How to write the duration, date or time of day that the author of a constant means.

use plcc_literal::calendar::{Clock, Date};
use plcc_literal::duration::{self, Fraction, Smallest};

/// The units of S5TIME, TIME and LTIME.
pub const S5TIME_UNITS: &[&str] = &["H", "M", "S", "MS"];
pub const TIME_UNITS: &[&str] = &["D", "H", "M", "S", "MS"];
pub const LTIME_UNITS: &[&str] = &["D", "H", "M", "S", "MS", "US", "NS"];

/// All units, with the words that people write for them and their nanoseconds.
const UNITS: &[(&str, &[&str], i128)] = &[
    ("D", &["D", "DAY", "DAYS"], 86_400_000_000_000),
    ("H", &["H", "HR", "HOUR", "HOURS", "STD"], 3_600_000_000_000),
    ("M", &["M", "MIN", "MINUTE", "MINUTES"], 60_000_000_000),
    ("S", &["S", "SEC", "SECOND", "SECONDS", "SEK"], 1_000_000_000),
    ("MS", &["MS", "MSEC", "MILLISECONDS"], 1_000_000),
    ("US", &["US"], 1000),
    ("NS", &["NS"], 1),
];

/// A duration: `S5TIME#10` has no unit, `T#5S_2H` not their order, `T#5sec` not their names, `T#1,5s` a comma, and `T#1m30` no unit at its
/// end. `units`: those of the type.
pub fn duration(text: &str, value: &str, units: &[&str]) -> String {
    let prefix = prefix(text);
    let compact = compact(value);
    if is_number(&compact) {
        return format!("write the unit: `{prefix}#{compact}S` for seconds, `{prefix}#{compact}MS` for milliseconds");
    }
    let pointed = compact.replace(',', ".");
    if pointed != compact && duration::nanoseconds(&pointed, Smallest::Nanosecond, Fraction::Last).is_ok() {
        return format!("a fraction has a point: write `{prefix}#{pointed}`");
    }
    let all = format!("its units are {}, in this order, each once", units.join(", "));
    let (sign, unsigned) = signed(&compact);
    let Some(parts) = parts(unsigned) else { return all };
    let mut known: Vec<(usize, &str)> = Vec::new();
    for &(number, letters) in &parts {
        let found = UNITS.iter().position(|(_, words, _)| words.contains(&letters));
        match found {
            Some(unit) if known.iter().any(|(other, _)| *other == unit) => {
                return format!("`{letters}` is there twice: {all}");
            }
            Some(unit) => known.push((unit, number)),
            None if letters.is_empty() => {
                let next = known.last().and_then(|(unit, _)| UNITS.get(unit + 1));
                let Some((next, ..)) = next.filter(|(next, ..)| units.contains(next)) else { return all };
                let before = written(&known);
                return format!("write the unit of `{number}`, as in `{prefix}#{sign}{before}_{number}{next}`");
            }
            None if parts.len() == 1 => {
                let number = format!("{prefix}#{sign}{number}");
                return format!(
                    "`{letters}` is not a unit: write `{number}S` for seconds, `{number}MS` for milliseconds"
                );
            }
            None => return format!("`{letters}` is not a unit: {all}"),
        }
    }
    let foreign = known.iter().find(|(unit, _)| !units.contains(&UNITS[*unit].0));
    if let Some((unit, _)) = foreign {
        return format!("{prefix}# has no unit {}: {all}", UNITS[*unit].0);
    }
    known.sort_unstable_by_key(|(unit, _)| *unit);
    let fraction_inside = known.iter().rev().skip(1).any(|(_, number)| number.contains('.'));
    match carried(&parts, units).filter(|_| fraction_inside) {
        Some(carried) => format!("only the last unit has a fraction: write `{prefix}#{sign}{carried}`"),
        None => format!("write `{prefix}#{sign}{}`", written(&known)),
    }
}

/// A duration with a number that must go into the next larger unit, `T#1H90M`.
pub fn within_limits(text: &str, value: &str, units: &[&str]) -> String {
    let compact = compact(value);
    let (sign, unsigned) = signed(&compact);
    let limits = "only the first unit may exceed its natural limit";
    match parts(unsigned).and_then(|parts| carried(&parts, units)) {
        Some(carried) => format!("{limits}: write `{}#{sign}{carried}`", prefix(text)),
        None => limits.to_owned(),
    }
}

/// A date: `D#6.5.2024` has another order, `D#2024.5.6` other signs.
pub fn date(text: &str, value: &str) -> String {
    let prefix = prefix(text);
    let fields: Vec<&str> = value.split(['-', '.', '/', ':']).map(str::trim).collect();
    let meant = match fields.as_slice() {
        [day, month, year] if year.len() == 4 && day.len() <= 2 => existing(year, month, day),
        [year, month, day] if year.len() == 4 => existing(year, month, day),
        [year] if year.len() == 4 => existing(year, "1", "31"),
        [year, month] if year.len() == 4 => existing(year, month, "1"),
        _ => None,
    };
    let example = meant.unwrap_or_else(|| "2000-6-20".to_owned());
    format!("write year, month and day: `{prefix}#{example}`")
}

/// A time of day: `TOD#12:30` has no seconds, `TOD#12.30.00` other signs.
pub fn clock(text: &str, value: &str) -> String {
    let example = whole_clock(value).unwrap_or_else(|| "5:45:00.5".to_owned());
    format!("write hours, minutes and seconds: `{}#{example}`", prefix(text))
}

/// A date with a time of day: `DT#2024-5-6` has no time, `DT#2024-5-6-12:30` no seconds.
pub fn date_and_clock(text: &str, value: &str) -> String {
    let example = match value.rsplit_once('-') {
        _ if Date::parse(value).is_some_and(Date::exists) => Some(format!("{value}-0:0:0")),
        Some((date, time)) if Date::parse(date).is_some_and(Date::exists) => {
            whole_clock(time).map(|time| format!("{date}-{time}"))
        }
        _ => None,
    };
    let example = example.unwrap_or_else(|| "2000-6-20-5:45:00.5".to_owned());
    format!("write date and time: `{}#{example}`", prefix(text))
}

/// A day that the calendar does not have.
pub fn day(text: &str, date: Date) -> String {
    let Date { year, month, day } = date;
    let others = [Date { year: day, month, day: year }, Date { year, month: day, day: month }];
    if let Some(meant) = others.into_iter().find(|meant| meant.year >= 1900 && meant.exists()) {
        let written = format!("{}-{}-{}", meant.year, meant.month, meant.day);
        return match text.contains(':') {
            true => format!("the order is year, month, day: `{written}`"),
            false => format!("the order is year, month, day: `{}#{written}`", prefix(text)),
        };
    }
    match (28..=31).rev().find(|last| Date { day: *last, ..date }.exists()) {
        Some(last) => format!("month {month} of {year} has {last} days"),
        None => format!("{month} is not a month: the order is year, month, day"),
    }
}

fn prefix(text: &str) -> &str {
    text.split('#').next().unwrap_or_default()
}

/// Without what has no meaning, in capitals.
fn compact(value: &str) -> String {
    value.chars().filter(|c| *c != '_' && !c.is_whitespace()).collect::<String>().to_ascii_uppercase()
}

fn signed(compact: &str) -> (&str, &str) {
    compact.split_at(usize::from(compact.starts_with(['-', '+'])))
}

/// Digits with at most one point between them.
fn is_number(text: &str) -> bool {
    let digits = |part: &str| !part.is_empty() && part.bytes().all(|digit| digit.is_ascii_digit());
    match text.split_once('.') {
        Some((whole, fraction)) => digits(whole) && digits(fraction),
        None => digits(text),
    }
}

/// Numbers with the letters after each, which the last one may lack; `None`: something else.
fn parts(unsigned: &str) -> Option<Vec<(&str, &str)>> {
    let mut parts = Vec::new();
    let mut rest = unsigned;
    while !rest.is_empty() {
        let letters = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
        let (number, tail) = rest.split_at(letters);
        let end = tail.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(tail.len());
        let (unit, after) = tail.split_at(end);
        if !is_number(number) || unit.is_empty() && !after.is_empty() {
            return None;
        }
        parts.push((number, unit));
        rest = after;
    }
    (!parts.is_empty()).then_some(parts)
}

fn written(known: &[(usize, &str)]) -> String {
    known.iter().map(|(unit, number)| format!("{number}{}", UNITS[*unit].0)).collect::<Vec<_>>().join("_")
}

/// The sum of the parts in `units`, each within its limit; `None`: a unit is unknown.
fn carried(parts: &[(&str, &str)], units: &[&str]) -> Option<String> {
    let mut rest = 0i128;
    for (number, letters) in parts {
        let (unit, ..) = UNITS.iter().find(|(_, words, _)| words.contains(letters))?;
        let part = format!("{number}{unit}");
        rest += duration::nanoseconds(&part, Smallest::Nanosecond, Fraction::Anywhere).ok()?;
    }
    let mut sum: Vec<String> = Vec::new();
    for (unit, _, unit_ns) in UNITS.iter().filter(|(unit, ..)| units.contains(unit)) {
        let count = rest / unit_ns;
        rest %= unit_ns;
        if count > 0 {
            sum.push(format!("{count}{unit}"));
        }
    }
    (!sum.is_empty()).then(|| sum.join("_"))
}

/// A date as it is written, if the calendar has it.
fn existing(year: &str, month: &str, day: &str) -> Option<String> {
    let written = format!("{year}-{month}-{day}");
    Date::parse(&written).filter(|date| date.exists()).map(|_| written)
}

/// `12:30:00` for `12:30`, `12` and `12.30.00`.
fn whole_clock(value: &str) -> Option<String> {
    let fields: Vec<&str> = value.split([':', '.', '-']).map(str::trim).collect();
    let [hour, more @ ..] = fields.as_slice() else { return None };
    let written = match more {
        [] => format!("{hour}:00:00"),
        [minute] => format!("{hour}:{minute}:00"),
        [minute, second] => format!("{hour}:{minute}:{second}"),
        _ => return None,
    };
    Clock::parse(&written).filter(|clock| clock.exists()).map(|_| written)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations() {
        let of_time = |text: &str| duration(text, text.split_once('#').unwrap_or_default().1, TIME_UNITS);
        assert_eq!(of_time("T#1m30"), "write the unit of `30`, as in `T#1M_30S`");
        assert_eq!(of_time("T#-1h_5"), "write the unit of `5`, as in `T#-1H_5M`");
        assert_eq!(of_time("T#1.5"), "write the unit: `T#1.5S` for seconds, `T#1.5MS` for milliseconds");
        assert_eq!(of_time("T#5s_2h"), "write `T#2H_5S`");
        assert_eq!(of_time("T#1.5h_30m"), "only the last unit has a fraction: write `T#2H`");
        assert_eq!(of_time("T#5x"), "`X` is not a unit: write `T#5S` for seconds, `T#5MS` for milliseconds");
        assert_eq!(of_time("T#5m5m"), "`M` is there twice: its units are D, H, M, S, MS, in this order, each once");
        assert_eq!(of_time("T#5us"), "T# has no unit US: its units are D, H, M, S, MS, in this order, each once");
        assert_eq!(of_time("T#5ms7"), "its units are D, H, M, S, MS, in this order, each once");
    }

    #[test]
    fn limits() {
        let of_time = |text: &str| within_limits(text, text.split_once('#').unwrap_or_default().1, TIME_UNITS);
        assert_eq!(of_time("T#1h90m"), "only the first unit may exceed its natural limit: write `T#2H_30M`");
        assert_eq!(of_time("T#-1d_25h"), "only the first unit may exceed its natural limit: write `T#-2D_1H`");
    }

    #[test]
    fn dates_and_times() {
        let value = |text: &'static str| text.split_once('#').unwrap_or_default().1;
        let of_date = |text| date(text, value(text));
        assert_eq!(of_date("D#6.5.2024"), "write year, month and day: `D#2024-5-6`");
        assert_eq!(of_date("D#2024"), "write year, month and day: `D#2024-1-31`");
        assert_eq!(of_date("D#today"), "write year, month and day: `D#2000-6-20`");
        assert_eq!(clock("TOD#12:30", "12:30"), "write hours, minutes and seconds: `TOD#12:30:00`");
        assert_eq!(clock("TOD#12.30.05", "12.30.05"), "write hours, minutes and seconds: `TOD#12:30:05`");
        assert_eq!(date_and_clock("DT#2024-5-6", "2024-5-6"), "write date and time: `DT#2024-5-6-0:0:0`");
        let of_day = |text: &str, year, month, day| super::day(text, Date { year, month, day });
        assert_eq!(of_day("D#2024-13-1", 2024, 13, 1), "the order is year, month, day: `D#2024-1-13`");
        assert_eq!(of_day("D#6-5-2024", 6, 5, 2024), "the order is year, month, day: `D#2024-5-6`");
        assert_eq!(of_day("D#2024-2-30", 2024, 2, 30), "month 2 of 2024 has 29 days");
        assert_eq!(of_day("D#2024-13-14", 2024, 13, 14), "13 is not a month: the order is year, month, day");
    }
}
