//! Lines of a source with what their statements see beside them, in the columns of the page.

use std::ops::Range;

use serde_json::Value;

use crate::document::Code;
use crate::forcing::{Forcing, Symbols, operands};
use crate::row::{Piece, Row, Tone, piece};
use crate::status::{Place, STA_BIT, Status, Tells, text};

/// Title and width of each column of STL.
const REGISTERS: [(&str, usize); 9] =
    [("RLO", 4), ("STA", 5), ("ACCU1", 9), ("ACCU2", 9), ("AR1", 9), ("AR2", 9), ("DB", 6), ("DI", 6), ("STATUS", 11)];

/// The bit RLO of the status word, its number of bits, and the bit of a logic stack that is ENO.
const RLO_BIT: u64 = 1;
const STATUS_BITS: u64 = 9;
const ENO_BIT: u64 = 9;

/// The widest column of code: what is longer moves what is beside it.
const CODE_MAX: usize = 70;

/// The lines of a section, and the places that belong to each.
pub struct Listing {
    lines: Vec<String>,
    /// Numbers of places, each with what stands there.
    places: Vec<Vec<(usize, String)>>,
    /// Operands of each line: where they are in it, and their addresses.
    operands: Vec<Vec<(Range<usize>, String)>>,
    head: String,
    width: usize,
}

/// The width of the column of code of a block with these lines.
pub fn width<'a>(codes: impl Iterator<Item = &'a Code>) -> usize {
    let longest = codes.flat_map(|code| code.text.lines()).map(|line| plain(line).chars().count()).max();
    (longest.unwrap_or(0) + 2).clamp(16, CODE_MAX)
}

/// A line of a source as it is shown.
fn plain(line: &str) -> String {
    line.replace('\t', "    ").chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect()
}

impl Listing {
    /// `width`: that of the column of code.
    pub fn new(code: &Code, status: &Status, symbols: &Symbols, width: usize) -> Listing {
        let texts: Vec<&str> = code.text.split('\n').collect();
        let mut places: Vec<Vec<(usize, String)>> = vec![Vec::new(); texts.len()];
        let starts: Vec<i64> = code.starts.iter().take(texts.len()).map(|start| i64::from(*start)).collect();
        // The byte after the last line.
        let end = starts.last().zip(texts.last()).map_or(0, |(start, text)| start + text.len() as i64);
        for (number, Place(from, to, tells)) in status.places().iter().enumerate() {
            if *tells == Tells::Block || *from > end {
                continue;
            }
            let Some(line) = starts.iter().rposition(|start| start <= from) else { continue };
            let byte = |at: i64| usize::try_from(at.saturating_sub(starts[line])).unwrap_or(0).min(texts[line].len());
            let name = texts[line].as_bytes().get(byte(*from)..byte(*to)).unwrap_or_default();
            places[line].push((number, String::from_utf8_lossy(name).trim().to_string()));
        }
        let has = |tells: Tells| places.iter().flatten().any(|(number, _)| status.places()[*number].2 == tells);
        let head = if has(Tells::Registers) {
            REGISTERS.iter().map(|&(title, width)| format!("{title:width$}")).collect()
        } else if has(Tells::Stack) {
            "S0...S8   ENO".to_string()
        } else {
            String::new()
        };
        let lines: Vec<String> = texts.into_iter().map(plain).collect();
        let operands = lines.iter().map(|line| operands(line, symbols)).collect();
        Listing { lines, places, operands, head, width }
    }

    /// The lines with what is known now.
    pub fn rows(&self, status: &Status, forcing: &Forcing) -> Vec<Row> {
        let width = self.width;
        let mut rows = Vec::new();
        if !self.head.is_empty() {
            rows.push(vec![piece(format!("{:width$}{}", "", self.head.trim_end()), Tone::Title)]);
        }
        for ((line, places), operands) in self.lines.iter().zip(&self.places).zip(&self.operands) {
            let mut beside = beside(places, status).into_iter();
            let mut row = code(line, operands, forcing);
            if let Some(first) = beside.next() {
                row.push(piece(" ".repeat(width.saturating_sub(line.chars().count())), Tone::Plain));
                row.push(first);
            }
            rows.push(row);
            // Several statements in one line.
            rows.extend(beside.map(|one| vec![piece(" ".repeat(width), Tone::Plain), one]));
        }
        rows
    }
}

/// A line of a source, with its forced operands.
fn code(line: &str, operands: &[(Range<usize>, String)], forcing: &Forcing) -> Row {
    let mut row = Row::new();
    let mut at = 0;
    for (place, _) in operands.iter().filter(|(_, address)| forcing.has(address)) {
        row.push(piece(&line[at..place.start], Tone::Plain));
        row.push(piece(&line[place.clone()], Tone::Forced));
        at = place.end;
    }
    row.push(piece(&line[at..], Tone::Plain));
    row
}

/// What stands beside a line.
fn beside(places: &[(usize, String)], status: &Status) -> Vec<Piece> {
    let seen: Vec<(Tells, &Place, &str, &Value)> = places
        .iter()
        .filter_map(|(number, name)| {
            let place = status.places().get(*number)?;
            Some((place.2, place, name.as_str(), status.seen(*number)?))
        })
        .collect();
    let of = |wanted: Tells| seen.iter().filter(move |(tells, ..)| *tells == wanted).map(|(.., value)| *value);
    match seen.first().map(|(tells, ..)| *tells) {
        None => return Vec::new(),
        Some(Tells::Registers) => return of(Tells::Registers).map(registers).collect(),
        Some(Tells::Stack) => return of(Tells::Stack).map(stack).collect(),
        Some(Tells::Block | Tells::Variable | Tells::Value | Tells::Written | Tells::Ran) => {}
    }
    let mut parts: Vec<String> = Vec::new();
    for (tells, _, name, value) in &seen {
        let sign = match tells {
            Tells::Written => ":=",
            Tells::Variable | Tells::Registers | Tells::Stack => "=",
            Tells::Block | Tells::Value | Tells::Ran => continue,
        };
        let part = format!("{name} {sign} {}", text(value));
        if !parts.contains(&part) {
            parts.push(part);
        }
    }
    // The condition of the line: of the results that are bits that of the longest expression.
    let results = seen.iter().filter(|(tells, .., value)| *tells == Tells::Value && value.is_boolean());
    let longest = results.min_by_key(|(_, place, ..)| place.0.saturating_sub(place.1));
    parts.extend(longest.map(|(.., value)| format!("result {}", text(value))));
    if parts.is_empty() && seen.iter().any(|(tells, ..)| *tells == Tells::Ran) {
        parts.push("has run".to_string());
    }
    vec![piece(parts.join("   "), Tone::Value)]
}

/// The registers after a statement.
fn registers(value: &Value) -> Piece {
    let number = |at: usize| value.get(at).and_then(Value::as_u64).unwrap_or(0);
    let bit = |at: u64| number(0) >> at & 1;
    let digits = |bits: Range<u64>| -> String { bits.rev().map(|at| bit(at).to_string()).collect() };
    let db = |at: usize| if number(at) == 0 { String::new() } else { number(at).to_string() };
    let hex = |at: usize| format!("{:08X}", number(at));
    let bits = format!("{} {} {}", digits(8..STATUS_BITS), digits(4..8), digits(0..4));
    let texts = [
        format!(" {}", bit(RLO_BIT)),
        format!(" {}", bit(STA_BIT)),
        hex(1),
        hex(2),
        hex(3),
        hex(4),
        db(5),
        db(6),
        bits,
    ];
    let columns = texts.iter().zip(REGISTERS).map(|(text, (_, width))| format!("{text:width$}"));
    let cell = value.get(7).and_then(Value::as_str).map_or_else(String::new, |cell| format!(" {cell}"));
    let line = columns.chain([cell]).collect::<String>();
    piece(line.trim_end(), if bit(RLO_BIT) == 1 { Tone::On } else { Tone::Plain })
}

/// The logic stack after a statement, and its operands.
fn stack(value: &Value) -> Piece {
    let bits = value.get(0).and_then(Value::as_u64).unwrap_or(0);
    let levels: String = (0..9).map(|level| (bits >> level & 1).to_string()).collect();
    let mut line = format!("{levels}  {}  ", bits >> ENO_BIT & 1);
    for operand in value.get(1).and_then(Value::as_array).into_iter().flatten() {
        let part = |at: usize| operand.get(at).map(text).unwrap_or_default();
        line.push_str(&format!(" {}={}", part(0), part(1)));
    }
    piece(line.trim_end(), if bits & 1 == 1 { Tone::On } else { Tone::Plain })
}
