//! The status for people: the source with the values beside its lines.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use plcc_diag::SourceFile;

use crate::status::{Kind, PlaceSeen, Row, Status};

/// Characters of a line of the source that are shown.
const SOURCE_MAX: usize = 60;

/// The source of the block with the values beside each line. `file` is the file of the block.
pub fn document(status: &Status, file: &SourceFile) -> String {
    let mut text = head(status);
    let is_text = !status.file.to_ascii_lowercase().ends_with(".xml");
    let mut lines: BTreeMap<u32, Vec<&PlaceSeen>> = BTreeMap::new();
    for place in &status.places {
        lines.entry(place.line).or_default().push(place);
    }
    let (Some((&first, _)), Some((&last, _))) = (lines.first_key_value(), lines.last_key_value()) else {
        match status.network {
            Some(number) => {
                let _ = writeln!(text, "nothing to see here: there is no network {number}, or it has no statements");
            }
            None => text.push_str("nothing to see here\n"),
        }
        return text;
    };
    let source = |line: u32| -> String {
        let line: String = file.line_text(line).replace('\t', "    ");
        line.trim_end().chars().take(SOURCE_MAX).collect()
    };
    let shown: Vec<u32> = if is_text { (first..=last).collect() } else { lines.keys().copied().collect() };
    let width = shown.iter().map(|&line| source(line).chars().count()).max().unwrap_or(0);
    let width = if is_text { width } else { 0 };
    let is_stl = status.places.iter().any(|place| matches!(place.kind, Kind::Statement { .. }));
    if is_stl {
        let _ = writeln!(text, "{:>5}  {:width$} | {REGISTERS}", "", "");
    }
    let mut network = 0;
    for line in shown {
        let places = lines.get(&line).map_or(&[][..], Vec::as_slice);
        if let Some(place) = places.first()
            && !is_text
            && place.network != network
        {
            network = place.network;
            let _ = writeln!(text, "network {network}");
        }
        let source = if is_text { source(line) } else { String::new() };
        let row = format!("{line:>5}  {source:width$} | {}", beside(places));
        let _ = writeln!(text, "{}", row.trim_end_matches([' ', '|']));
    }
    steps(&mut text, status);
    text
}

fn head(status: &Status) -> String {
    let name = if status.name.is_empty() { String::new() } else { format!(" ({})", status.name) };
    let mut head = format!("{}{name}, cycle {}", status.block, status.cycle);
    match status.time_ms {
        None if status.calls.is_empty() => head.push_str(": not called"),
        None => {
            let _ = write!(head, ": no such call; it is called by {}", status.calls.join(", "));
        }
        Some(time) => {
            let _ = write!(head, ", {time} ms");
            if let Some(instance) = &status.instance {
                let _ = write!(head, ", instance {instance}");
            }
            if status.path.len() > 1 {
                let _ = write!(head, ", called by {}", status.path[..status.path.len() - 1].join(", "));
            }
        }
    }
    head.push('\n');
    head
}

/// Above the columns of [`registers`].
const REGISTERS: &str = "RLO STA STANDARD     ACCU2    AR1      AR2      DB1   DB2   STATUS WORD";

fn registers(row: &Row) -> String {
    format!(
        "{:<3} {:<3} {:<12} {:<8x} {:<8} {:<8} {:<5} {:<5} {}",
        u8::from(row.rlo),
        u8::from(row.sta),
        row.standard,
        row.accu2,
        pointer(row.ar1),
        pointer(row.ar2),
        row.db1,
        row.db2,
        row.status_bits
    )
}

/// An address register: `P#10.0`, `P#M10.0`.
fn pointer(register: u32) -> String {
    let area = match register >> 24 {
        0 => "",
        0x80 => "P",
        0x81 => "I",
        0x82 => "Q",
        0x83 => "M",
        0x84 => "DB",
        0x85 => "DI",
        0x86 => "L",
        0x87 => "V",
        _ => return format!("{register:x}"),
    };
    let x = if area.starts_with('D') { "X" } else { "" };
    format!("P#{area}{x}{}.{}", (register & 0x7_FFFF) >> 3, register & 7)
}

/// What stands beside a line.
fn beside(places: &[&PlaceSeen]) -> String {
    let mut parts: Vec<String> = Vec::new();
    let result = outer_condition(places);
    for place in places {
        let name = operand(&place.text);
        let flow = place.flow.map_or("", |flow| if flow { " [flow 1]" } else { " [flow 0]" });
        let part = match &place.kind {
            Kind::Statement { registers } => registers.as_ref().map(self::registers),
            Kind::Stack { levels, eno, operands } => levels.map(|levels| {
                let bits: String = levels.iter().map(|level| if *level { '1' } else { '0' }).collect();
                let operands = operands.iter().map(|(name, value)| format!(", {name} = {value}"));
                format!("{bits} ENO {}{}", u8::from(eno.unwrap_or(false)), operands.collect::<String>())
            }),
            Kind::Read(value) => {
                // What the line writes is shown once, with its new value.
                let is_written =
                    places.iter().any(|other| matches!(other.kind, Kind::Written(_)) && other.text == place.text);
                value.shown.as_ref().filter(|_| !is_written).map(|shown| format!("{name} = {shown}{flow}"))
            }
            // What spans lines is not an operand.
            Kind::Written(value) => {
                value.shown.as_ref().filter(|_| place.end_line == place.line).map(|shown| format!("{name} := {shown}"))
            }
            Kind::Result(value) if result.is_some_and(|result| std::ptr::eq(result, *place)) => {
                value.shown.as_ref().map(|shown| format!("result = {shown}{flow}"))
            }
            Kind::Result(_) | Kind::Ran { .. } => None,
        };
        parts.extend(part.filter(|part| !parts.contains(part)));
    }
    if parts.is_empty() && places.iter().any(|place| matches!(place.kind, Kind::Ran { ran: true })) {
        return "has run".to_string();
    }
    parts.join(", ")
}

/// The operand at the beginning of a text: an action of a chart goes on with its time and its qualifier.
fn operand(text: &str) -> &str {
    let mut quoted = false;
    let end = text.find(|c| {
        quoted ^= c == '"';
        c == ' ' && !quoted
    });
    &text[..end.unwrap_or(text.len())]
}

/// The condition that a line computes: of the results that are BOOL the longest one.
fn outer_condition<'a>(places: &[&'a PlaceSeen]) -> Option<&'a PlaceSeen> {
    let conditions =
        places.iter().copied().filter(|place| matches!(&place.kind, Kind::Result(value) if value.ty == "BOOL"));
    conditions.max_by_key(|place| place.end - place.start)
}

fn steps(text: &mut String, status: &Status) {
    for step in &status.steps {
        let time = |ms: Option<i32>| ms.map_or_else(String::new, |ms| format!("{ms}ms"));
        let active = if step.active { "active" } else { "" };
        let row = format!("step {:<24} {active:<8} T {:<10} U {}", step.step, time(step.t_ms), time(step.u_ms));
        let _ = writeln!(text, "{}", row.trim_end());
    }
}
