//! Standard output: the values of `--print` and of a scenario.

use std::io::Write;

use crate::address::Width;
use crate::cpu::Cpu;
use crate::plant::Plant;
use crate::signal::{Signal, Value};

/// Writes one line per signal, or one JSON object. Names are printed as given.
pub fn write_values(
    cpu: &Cpu,
    plant: Option<&Plant>,
    signals: &[Signal],
    json: bool,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    if json {
        let mut object = String::from("{");
        for (index, Signal { name, source }) in signals.iter().enumerate() {
            let value = source.read(cpu, plant);
            let text = match value {
                Value::Bits(_, Width::Bit(_)) => value.text(),
                Value::Number(number) if number.is_finite() => value.text(),
                Value::Bits(..) | Value::Number(_) => quoted(&value.text()),
            };
            object += &format!("{}{}: {text}", if index == 0 { "" } else { ", " }, quoted(name));
        }
        return writeln!(out, "{object}}}");
    }
    for Signal { name, source } in signals {
        writeln!(out, "{name} = {}", source.read(cpu, plant).text())?;
    }
    Ok(())
}

fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
