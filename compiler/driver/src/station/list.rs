//! The station as a table, like the configuration window of STEP 7.

use std::ops::Range;

use super::catalog::Kind;
use super::{Placed, Station, catalog};

const HEADER: [&str; 7] = ["Rack", "Slot", "Module", "Order number", "I address", "Q address", "Comment"];

/// The table: one line per module, and a line for the CPU.
pub fn table(station: &Station) -> String {
    let mut rows: Vec<[String; 7]> = Vec::new();
    let has_cpu_row = station.modules.iter().any(|module| module.module.kind == Kind::Cpu);
    let mut cpu = station.cpu.as_ref().filter(|_| !has_cpu_row).map(|_| cpu_row(station));
    for module in &station.modules {
        if (module.rack, module.slot) >= (0, 2) {
            rows.extend(cpu.take());
        }
        rows.push(row(module, station));
    }
    rows.extend(cpu);
    let header = HEADER.map(str::to_string);
    let lines: Vec<&[String; 7]> = std::iter::once(&header).chain(&rows).collect();
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..HEADER.len()).map(width).collect();
    let mut text = String::new();
    for line in lines {
        let cells: Vec<String> = line.iter().zip(&widths).map(|(cell, &width)| format!("{cell:<width$}")).collect();
        text.push_str(cells.join("  ").trim_end());
        text.push('\n');
    }
    text
}

fn cpu_row(station: &Station) -> [String; 7] {
    let name = station.profile().map(|(name, _)| name).unwrap_or_default();
    let name = plcc_model::profile::lookup(&name).map_or(name, |profile| profile.name);
    let order = station.cpu_order();
    [0.to_string(), 2.to_string(), format!("CPU {name}"), order, String::new(), String::new(), bus_addresses(station)]
}

fn bus_addresses(station: &Station) -> String {
    let addresses = [("MPI", station.mpi_address), ("DP", station.dp_address)];
    let texts: Vec<String> =
        addresses.iter().filter_map(|(bus, address)| address.map(|address| format!("{bus} {address}"))).collect();
    texts.join(", ")
}

fn row(module: &Placed, station: &Station) -> [String; 7] {
    let addresses = |bytes: Range<u32>| match bytes.len() {
        0 => String::new(),
        1 => bytes.start.to_string(),
        _ => format!("{}...{}", bytes.start, bytes.end - 1),
    };
    let mut ranges: Vec<&str> = module.channels.iter().map(|channel| channel.range.as_str()).collect();
    ranges.dedup();
    let mut comment = ranges.join(", ");
    let mut name = module.name.clone();
    if module.module.kind == Kind::Cpu {
        name = catalog::cpu_ordered(&module.order).map_or(name, |row| format!("CPU {}", row.name));
        comment = bus_addresses(station);
    }
    [
        module.rack.to_string(),
        if module.onboard { String::new() } else { module.slot.to_string() },
        name,
        module.order.clone(),
        addresses(module.inputs()),
        addresses(module.outputs()),
        comment,
    ]
}
