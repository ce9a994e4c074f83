//! Pictures of traces: a CSV trace as SVG.
//!
//! Each unit (`AO0 in %`) has one panel with its numbers. Bits follow below as steps. All share one time axis.

mod draw;

use plcc_abi::image::AssertType;
use plcc_runtime::signal::number_text;
use plcc_runtime::typed::{self, ValueType};

/// A column of a trace.
#[derive(Clone, Debug, PartialEq)]
struct Column {
    name: String,
    /// Unit of its axis; empty if none is known.
    unit: String,
    is_bit: bool,
    /// It has values that cannot be drawn: texts, dates.
    is_text: bool,
    /// Seconds and value, in the order of time.
    points: Vec<(f64, f64)>,
}

/// Panels of a picture.
#[derive(Clone, Debug, Default, PartialEq)]
struct Panels {
    /// Unit and its columns, in the order of their first use.
    numbers: Vec<(String, Vec<Column>)>,
    bits: Vec<Column>,
    /// Seconds of the last sample.
    end: f64,
}

/// Draws a trace in the form that `--trace FILE.csv` writes. `Err`: the reason why it cannot be drawn.
pub fn picture(trace: &str, title: &str) -> Result<String, String> {
    let mut panels = Panels::default();
    for column in columns(trace)? {
        panels.end = column.points.iter().map(|(time, _)| *time).fold(panels.end, f64::max);
        if column.is_bit {
            panels.bits.push(column);
        } else if let Some((_, columns)) =
            panels.numbers.iter_mut().find(|(unit, columns)| *unit == column.unit && columns.len() < PANEL_MAX)
        {
            columns.push(column);
        } else {
            panels.numbers.push((column.unit.clone(), vec![column]));
        }
    }
    draw::svg(&panels, title)
}

/// Curves of one panel: a legend with more names is higher than the panel.
const PANEL_MAX: usize = 12;

/// The latest time of a trace: 30,000 years.
const TIME_MS_MAX: f64 = 1e15;
/// The largest value of a picture, more than a REAL holds; the difference of two is a number.
const VALUE_MAX: f64 = 1e300;

fn columns(trace: &str) -> Result<Vec<Column>, String> {
    let mut reader = csv::Reader::from_reader(trace.as_bytes());
    let header = reader.headers().map_err(|error| error.to_string())?.clone();
    let time = header
        .iter()
        .position(|name| name == "time_ms")
        .ok_or("this is not a trace of `--trace FILE.csv`: it has no column `time_ms`")?;
    let is_value = |index: usize| index != time && header.get(index) != Some("cycle");
    let mut columns: Vec<(usize, Column)> = Vec::new();
    for (index, name) in header.iter().enumerate().filter(|(index, _)| is_value(*index)) {
        let (name, unit) = split_last(name, " in ").unwrap_or((name, ""));
        let name = split_last(name, " as ").map_or(name, |(name, _)| name);
        columns.push((
            index,
            Column { name: name.to_string(), unit: unit.to_string(), is_bit: true, is_text: false, points: Vec::new() },
        ));
    }
    if columns.is_empty() {
        return Err("this trace has no values".to_string());
    }
    for record in reader.records() {
        let record = record.map_err(|error| error.to_string())?;
        let field = |index: usize| record.get(index).unwrap_or("");
        let wrong = |text: &str| format!("`{text}` is not a value of a trace");
        let ms: f64 = field(time).parse().map_err(|_| wrong(field(time)))?;
        if !(0.0..=TIME_MS_MAX).contains(&ms) {
            return Err(format!(
                "`{}` is not a time of a trace, which lies between 0 and {TIME_MS_MAX:e} ms",
                field(time)
            ));
        }
        for (index, column) in &mut columns {
            let text = field(*index);
            if is_text(text) {
                column.is_text = true;
                continue;
            }
            let value = value(text).filter(|value| value.is_finite()).ok_or_else(|| wrong(text))?;
            if value.abs() > VALUE_MAX {
                return Err(format!("`{text}` cannot be drawn: the largest value is {VALUE_MAX:e}"));
            }
            // Bits are written as 0 and 1, words in base 16, numbers with or without a point.
            column.is_bit &= matches!(text, "0" | "1") && column.unit.is_empty();
            column.points.push((ms / 1000.0, value));
        }
    }
    columns.retain(|(_, column)| !column.is_text);
    if columns.iter().any(|(_, column)| column.points.is_empty()) {
        return Err("this trace has no samples".to_string());
    }
    Ok(columns.into_iter().map(|(_, column)| column).collect())
}

/// Splits the head of a column at its last separator that is not in the quotes of a name, as in `"Pump in use"`.
fn split_last<'a>(head: &'a str, separator: &str) -> Option<(&'a str, &'a str)> {
    head.rsplit_once(separator).filter(|(_, after)| !after.contains('"'))
}

/// True for `'abc'`, `D#2026-01-31`, `TOD#6:00:00` and the like.
fn is_text(text: &str) -> bool {
    let prefix = text.split_once('#').map(|(prefix, _)| prefix);
    text.starts_with('\'') || matches!(prefix, Some("D" | "TOD" | "LTOD" | "DT" | "LDT" | "DTL"))
}

/// A number, a word in base 16 as an INT, wider values as they are, a duration in seconds.
fn value(text: &str) -> Option<f64> {
    if text.starts_with("T#") || text.starts_with("S5T#") || text.starts_with("LT#") {
        let ty = AssertType::Ltime;
        let (_, duration) = text.split_once('#')?;
        return typed::parse(&format!("LT#{duration}"), ValueType::of(ty)).ok()?.seconds(ty);
    }
    match text.strip_prefix("16#") {
        None => text.parse().ok(),
        Some(digits) if digits.len() == 4 => u16::from_str_radix(digits, 16).ok().map(|word| f64::from(word as i16)),
        Some(digits) => u64::from_str_radix(digits, 16).ok().map(|bits| bits as f64),
    }
}

/// A label of an axis.
fn label(value: f64) -> String {
    number_text(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRACE: &str =
        "cycle,time_ms,Q0.1,AO0 in %,Level as REAL in %,MW2\n0,0,0,0,1,16#FFFF\n1,500,1,12.5,2,16#0001\n";

    #[test]
    fn columns_have_names_and_units() {
        let columns = columns(TRACE).unwrap();
        let heads: Vec<(&str, &str, bool)> =
            columns.iter().map(|column| (column.name.as_str(), column.unit.as_str(), column.is_bit)).collect();
        assert_eq!(heads, [("Q0.1", "", true), ("AO0", "%", false), ("Level", "%", false), ("MW2", "", false)]);
        assert_eq!(columns[1].points, [(0.0, 0.0), (0.5, 12.5)]);
        assert_eq!(columns[3].points, [(0.0, -1.0), (0.5, 1.0)]);
    }

    /// Names in quotes have any words.
    #[test]
    fn columns_have_the_names_of_their_symbols() {
        let heads =
            "time_ms,\"\"\"Pump in use\"\"\",\"\"\"D\"\".\"\"Level as set\"\"\",\"\"\"Level in tank\"\" as REAL in %\"";
        let columns = columns(&format!("{heads}\n0,0,1,2\n500,1,2,3\n")).unwrap();
        let heads: Vec<(&str, &str, bool)> =
            columns.iter().map(|column| (column.name.as_str(), column.unit.as_str(), column.is_bit)).collect();
        let expected =
            [("\"Pump in use\"", "", true), ("\"D\".\"Level as set\"", "", false), ("\"Level in tank\"", "%", false)];
        assert_eq!(heads, expected);
    }

    #[test]
    fn a_picture_has_axes_and_legends() {
        let picture = picture(TRACE, "Tank & pump").unwrap();
        for text in ["<svg", "Tank &amp; pump", "time in s", "AO0", "Level", "Q0.1", "</svg>"] {
            assert!(picture.contains(text), "{text}: {picture}");
        }
    }

    /// Steps between the lines of an axis are never lost in the digits of its values.
    #[test]
    fn every_span_has_an_axis() {
        for (a, b) in [
            ("1e300", "-1e300"),
            ("1e300", "1e300"),
            ("1e17", "100000000000000016"),
            ("16#FFFFFFFFFFFFFFFF", "16#FFFFFFFFFFFFFFFE"),
            ("0", "5e-324"),
            ("1", "1.0000000000000002"),
            ("-3.4e38", "3.4e38"),
        ] {
            for time in ["0", "5e-324", "0.001", "1e15"] {
                let picture = picture(&format!("cycle,time_ms,MD0\n0,0,{a}\n1,{time},{b}\n"), "");
                assert!(picture.is_ok_and(|picture| picture.ends_with("</svg>\n")), "{a} {b} {time}");
            }
        }
    }

    #[test]
    fn what_is_no_trace_is_told() {
        for (text, part) in [
            ("", "no column `time_ms`"),
            ("a,b\n1,2\n", "no column `time_ms`"),
            ("cycle,time_ms\n0,0\n", "no values"),
            ("cycle,time_ms,Q0.0\n", "no samples"),
            ("cycle,time_ms,Q0.0\n0,0,x\n", "`x` is not a value"),
            ("cycle,time_ms,Q0.0\n0,0,NaN\n", "`NaN` is not a value"),
            ("cycle,time_ms,Q0.0\n0,soon,1\n", "`soon` is not a value"),
            ("cycle,time_ms,Q0.0\n0,inf,1\n", "`inf` is not a time"),
            ("cycle,time_ms,Q0.0\n0,1e400,1\n", "`1e400` is not a time"),
            ("cycle,time_ms,Q0.0\n0,NaN,1\n", "`NaN` is not a time"),
            ("cycle,time_ms,Q0.0\n0,-1,1\n", "`-1` is not a time"),
            ("cycle,time_ms,MD0 as REAL\n0,0,1e308\n1,10,-1e308\n", "`1e308` cannot be drawn"),
        ] {
            let message = picture(text, "").unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}
