//! Standard output: the values of `--print` and of a scenario.

use std::io::Write;

use crate::clock::NS_PER_MS;
use crate::cpu::Cpu;
use crate::plant::Plant;
use crate::signal::Signal;

/// Writes one line per signal, or one JSON object with the cycle and its time in nanoseconds. Names are printed as given. What does not
/// exist has the reason in place of a value, in JSON `null`.
pub fn write_values(
    cpu: &Cpu,
    plant: Option<&Plant>,
    signals: &[Signal],
    json: Option<(u64, u64)>,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let Some((cycle, time)) = json else {
        for Signal { name, source } in signals {
            match source.absent(cpu) {
                Some(reason) => writeln!(out, "{name} = ({reason})")?,
                None => writeln!(out, "{name} = {}", source.read(cpu, plant).text())?,
            }
        }
        return Ok(());
    };
    let values = signals.iter().map(|Signal { name, source }| {
        let value = match source.absent(cpu) {
            Some(_) => serde_json::Value::Null,
            None => source.read(cpu, plant).exact_json(),
        };
        let value = serde_json::json!({ "type": source.ty(), "value": value });
        format!("{}: {value}", serde_json::Value::from(name.as_str()))
    });
    // In the order of the flags.
    let values: Vec<String> = values.collect();
    let time = time as f64 / NS_PER_MS as f64;
    writeln!(out, "{{\"cycle\": {cycle}, \"time_ms\": {time}, \"values\": {{{}}}}}", values.join(", "))
}
