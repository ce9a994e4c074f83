//! What goes to standard output: the values of `--print` and of a scenario.

use std::io::Write;

use crate::address::{Address, Width};
use crate::cpu::Cpu;
use crate::value;

/// Writes one line per address, or one JSON object. Addresses stand as given.
pub fn write_values(
    cpu: &Cpu,
    addresses: &[(String, Address)],
    json: bool,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    if json {
        let mut object = String::from("{");
        for (index, (name, address)) in addresses.iter().enumerate() {
            let value = value::text(cpu.read(address), address.width);
            let value = match address.width {
                Width::Bit(_) => value,
                Width::Byte | Width::Word | Width::Dword | Width::Lword => quoted(&value),
            };
            object += &format!("{}{}: {value}", if index == 0 { "" } else { ", " }, quoted(name));
        }
        return writeln!(out, "{object}}}");
    }
    for (name, address) in addresses {
        writeln!(out, "{name} = {}", value::text(cpu.read(address), address.width))?;
    }
    Ok(())
}

fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
