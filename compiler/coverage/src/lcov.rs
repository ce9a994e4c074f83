//! The LCOV file, for programs that show coverage. Source: geninfo, FILES.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::data::{Block, Coverage, File};

/// The text of an LCOV file. Blocks are its functions. A line has run as often as that on it which has run most often; a contact, a
/// condition and what acts under a condition are a branch with two ways, 0 and 1.
pub fn lcov(coverage: &Coverage) -> String {
    let mut out = String::new();
    for (name, file) in &coverage.files {
        write_file(&mut out, name, file).expect("a String takes all text");
    }
    out
}

fn write_file(out: &mut String, name: &str, file: &File) -> std::fmt::Result {
    writeln!(out, "TN:\nSF:{name}")?;
    let line = |start: u32| file.source.line(start);
    for block in &file.blocks {
        writeln!(out, "FN:{},{}", line(block.span.0), function(block))?;
    }
    for block in &file.blocks {
        writeln!(out, "FNDA:{},{}", block.calls, function(block))?;
    }
    let called = file.blocks.iter().filter(|block| block.calls > 0).count();
    writeln!(out, "FNF:{}\nFNH:{called}", file.blocks.len())?;
    let (mut found, mut hit) = (0, 0);
    let contacts = file.blocks.iter().flat_map(|block| &block.contacts);
    for (number, (range, contact)) in contacts.enumerate() {
        let is_reached = contact.seen != [0; 2];
        for (way, count) in contact.seen.iter().enumerate() {
            let count = if is_reached { count.to_string() } else { "-".to_string() };
            writeln!(out, "BRDA:{},{number},{way},{count}", line(range.0))?;
        }
        found += 2;
        hit += contact.seen.iter().filter(|count| **count > 0).count();
    }
    writeln!(out, "BRF:{found}\nBRH:{hit}")?;
    let lines = lines(file);
    for (line, runs) in &lines {
        writeln!(out, "DA:{line},{runs}")?;
    }
    let run = lines.values().filter(|runs| **runs > 0).count();
    writeln!(out, "LF:{}\nLH:{run}\nend_of_record", lines.len())
}

/// A block as a function: without blanks and commas.
fn function(block: &Block) -> String {
    let id = block.id.replace(' ', "");
    let name: String = block.name.chars().map(|c| if c == ',' || c.is_control() { '_' } else { c }).collect();
    if name.is_empty() || name == id { id } else { format!("{id} {name}") }
}

/// How often each line has run that has something to run.
pub fn lines(file: &File) -> BTreeMap<u32, u64> {
    let mut lines: BTreeMap<u32, u64> = BTreeMap::new();
    let mut add = |start: u32, runs: u64| {
        let known = lines.entry(file.source.line(start)).or_default();
        *known = (*known).max(runs);
    };
    for block in &file.blocks {
        block.statements.iter().for_each(|(range, statement)| add(range.0, statement.runs));
        block.contacts.iter().for_each(|(range, contact)| add(range.0, contact.seen[0] + contact.seen[1]));
        block.networks.values().for_each(|network| add(network.start, network.runs));
        block.steps.iter().chain(&block.transitions).for_each(|one| add(one.start, one.runs));
    }
    lines
}
