//! The lists for people.

use std::collections::HashMap;
use std::fmt::Write as _;

use crate::structure::BlockCalls;
use crate::{Assignment, Reference, Structure, Use};

/// Rows of the table of timers and counters have so many.
const CELLS_IN_ROW: u16 = 10;

/// All lists, one after the other.
pub fn document(reference: &Reference) -> String {
    let mut text = String::new();
    heading(&mut text, "Cross references");
    cross(&mut text, reference);
    heading(&mut text, "Assignment of memory");
    assignment(&mut text, &reference.assignment);
    heading(&mut text, "Call structure");
    structure(&mut text, &reference.structure);
    heading(&mut text, "Symbols that nothing uses");
    let names = reference.unused_symbols.iter().map(|symbol| [symbol.name.clone(), symbol.address.clone()]);
    table(&mut text, "", &names.collect::<Vec<_>>());
    heading(&mut text, "Addresses without symbol");
    let addresses = reference.addresses_without_symbol.iter();
    let addresses = addresses.map(|one| [one.address.clone(), format!("{}x", one.uses)]);
    table(&mut text, "", &addresses.collect::<Vec<_>>());
    text
}

fn heading(text: &mut String, title: &str) {
    if !text.is_empty() {
        text.push('\n');
    }
    let _ = writeln!(text, "{title}\n{}", "-".repeat(title.len()));
}

/// Columns of equal width; `none` if there is no row.
fn table<const COLUMNS: usize>(text: &mut String, indent: &str, rows: &[[String; COLUMNS]]) {
    if rows.is_empty() {
        let _ = writeln!(text, "{indent}none");
    }
    let mut widths = [0; COLUMNS];
    for row in rows {
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = cell.chars().count().max(*width);
        }
    }
    for row in rows {
        let mut line = indent.to_string();
        for (cell, width) in row.iter().zip(widths) {
            let _ = write!(line, "{cell:<width$}  ");
        }
        let _ = writeln!(text, "{}", line.trim_end());
    }
}

/// `OB1 (Main)`.
fn with_name(address: &str, name: &str) -> String {
    if name.is_empty() { address.to_string() } else { format!("{address} ({name})") }
}

fn row(place: &Use) -> [String; 5] {
    let network = if place.network == 0 { String::new() } else { format!("network {}", place.network) };
    [
        place.access.name().to_string(),
        with_name(&place.block, &place.block_name),
        network,
        format!("{}:{}", place.file, place.line),
        place.statement.clone(),
    ]
}

fn cross(text: &mut String, reference: &Reference) {
    if reference.operands.is_empty() {
        text.push_str("none\n");
    }
    for operand in &reference.operands {
        let overlaps = match operand.overlaps.as_slice() {
            [] => String::new(),
            others => format!("   overlaps {}", others.join(", ")),
        };
        let _ = writeln!(text, "{}{overlaps}", with_name(&operand.address, &operand.symbol));
        table(text, "    ", &operand.uses.iter().map(row).collect::<Vec<_>>());
    }
}

fn assignment(text: &mut String, assignment: &Assignment) {
    if !assignment.bytes.is_empty() {
        text.push_str("            7 6 5 4 3 2 1 0   B W D\n");
    }
    for byte in &assignment.bytes {
        let bits: Vec<&str> = (0..8).rev().map(|bit| if byte.bits >> bit & 1 != 0 { "X" } else { "." }).collect();
        let mark = |used: bool| if used { "#" } else { "." };
        let other = if byte.other { " part of more" } else { "" };
        let _ = writeln!(
            text,
            "{:<10}  {}   {} {} {}{other}",
            byte.address,
            bits.join(" "),
            mark(byte.byte),
            mark(byte.word),
            mark(byte.dword),
        );
    }
    cells(text, "T", &assignment.timers);
    cells(text, "C", &assignment.counters);
    if assignment.bytes.is_empty() && assignment.timers.is_empty() && assignment.counters.is_empty() {
        text.push_str("none\n");
    }
}

/// Ten in a row; rows without any are left out.
fn cells(text: &mut String, letter: &str, used: &[u16]) {
    let mut last = None;
    for number in used {
        let first = number - number % CELLS_IN_ROW;
        if last.replace(first) == Some(first) {
            continue;
        }
        let cell = |number: u32| {
            let is_used = u16::try_from(number).is_ok_and(|number| used.binary_search(&number).is_ok());
            if is_used { format!("{letter}{number}") } else { ".".to_string() }
        };
        let first = u32::from(first);
        let row: Vec<String> =
            (first..first + u32::from(CELLS_IN_ROW)).map(|number| format!("{:<6}", cell(number))).collect();
        let _ = writeln!(text, "{:<10}  {}", format!("{letter}{first}-{}", first + 9), row.concat().trim_end());
    }
}

fn structure(text: &mut String, structure: &Structure) {
    let blocks = structure.blocks.iter().map(|block| (block.block.as_str(), block)).collect();
    let mut tree = Tree { text, blocks, shown: Vec::new() };
    for root in &structure.roots {
        tree.shown.clear();
        tree.block(root, None, 0);
    }
    if !structure.not_called.is_empty() {
        text.push_str("not called: ");
        text.push_str(&structure.not_called.join(", "));
        text.push('\n');
    }
}

/// The tree of calls below an organization block. What a block calls is shown where it is met first.
struct Tree<'t, 'a> {
    text: &'t mut String,
    blocks: HashMap<&'a str, &'a BlockCalls>,
    /// Blocks of this tree whose calls are shown.
    shown: Vec<&'a str>,
}

impl<'a> Tree<'_, 'a> {
    fn block(&mut self, name: &'a str, instance: Option<&str>, depth: usize) {
        let Some(&block) = self.blocks.get(name) else { return };
        let mut notes = Vec::new();
        if let Some(instance) = instance {
            notes.push(instance.to_string());
        }
        if depth == 0
            && let Some(bytes) = block.path_bytes
        {
            notes.push(format!("local data {} bytes, at most {bytes} in all", block.local_bytes));
        } else if block.local_bytes != 0 {
            notes.push(format!("local data {} bytes", block.local_bytes));
        }
        if block.recursive {
            notes.push("calls itself".to_string());
        }
        let again = self.shown.contains(&block.block.as_str());
        if again && !block.calls.is_empty() {
            notes.push("as above".to_string());
        }
        let notes = if notes.is_empty() { String::new() } else { format!("   {}", notes.join(", ")) };
        let _ = writeln!(self.text, "{:1$}{2}{notes}", "", depth * 4, with_name(&block.block, &block.name));
        if again {
            return;
        }
        self.shown.push(&block.block);
        for call in &block.calls {
            self.block(&call.block, call.instance.as_deref(), depth + 1);
        }
    }
}
