//! What the CPU is and does, as the page shows it: blocks, memory, times of cycles, connections.

use std::collections::BTreeMap;

use plcc_abi::image::{BlockKind, Module};
use plcc_abi::remote::RemoteLine;
use plcc_runtime::cpu::Cpu;
use serde_json::{Value, json};

use crate::link::Link;
use crate::listen::Open;

/// All that is known. `None`: the CPU has ended.
pub async fn info(link: &Link, services: &[(&'static str, Open)]) -> Option<Value> {
    let times = link.time_cycles();
    let mut info = link.ask(of_cpu).await?;
    let (bounds_us, period, work) = times.parts();
    info["cycles"] = json!({ "from": times.first(), "bounds_us": bounds_us, "period": period, "work": work });
    let connections = services.iter().map(|(name, open)| {
        let (now, accepted, refused) = open.counts();
        json!({ "service": name, "now": now, "accepted": accepted, "refused": refused })
    });
    info["connections"] = connections.collect();
    Some(info)
}

/// A module with its place and its addresses.
fn module(module: &Module) -> Value {
    let range = |area: &str, start: u32, bytes: u32| match bytes {
        0 => None,
        1 => Some(format!("{area} {start}")),
        _ => Some(format!("{area} {start} to {}", start.saturating_add(bytes - 1))),
    };
    let addresses: Vec<String> =
        [range("I", module.input_start, module.input_bytes), range("Q", module.output_start, module.output_bytes)]
            .into_iter()
            .flatten()
            .collect();
    let station = module.station.as_ref();
    let channels = station.map(|station| station.analog_inputs.iter().chain(&station.analog_outputs));
    let ranges: Vec<&str> =
        channels.into_iter().flatten().map(|one| one.range.as_str()).filter(|range| !range.is_empty()).collect();
    json!({
        "name": module.name,
        "rack": station.map(|station| station.rack),
        "slot": station.map(|station| station.slot),
        "order": station.map(|station| &station.order),
        "addresses": addresses.join(", "),
        "ranges": ranges,
    })
}

fn of_cpu(cpu: &Cpu) -> Value {
    let image = &cpu.image;
    let mut blocks: BTreeMap<&str, usize> = BTreeMap::new();
    let inner = image.inner_blocks.iter().map(|(kind, ..)| *kind);
    for kind in image.blocks.iter().map(|block| block.kind).chain(inner) {
        *blocks.entry(kind.prefix()).or_default() += 1;
    }
    // An S7-200 has no data blocks: V is DB 1 here.
    let is_s7200 = image.s7200.is_some();
    if !is_s7200 {
        blocks.insert(BlockKind::Db.prefix(), image.dbs.len());
    }
    let obs = image.blocks.iter().filter(|block| block.kind == BlockKind::Ob);
    let obs = obs.map(|block| {
        let class = image.config.class_of(block.number).map(|class| format!("{class:?}"));
        let runs = cpu.ob_runs(block.number).map(|runs| {
            let us = |ns: u64| ns as f64 / 1e3;
            json!({ "count": runs.count, "mean_us": us(runs.total) / runs.count.max(1) as f64, "longest_us": us(runs.longest) })
        });
        json!({ "ob": block.number, "name": block.name, "class": class, "local_bytes": block.frame, "runs": runs })
    });
    let db_bytes: usize = image.dbs.iter().map(|db| db.data.len()).sum();
    let profile = &image.profile;
    let mut memory = json!({ "inputs": profile.inputs, "outputs": profile.outputs, "bit memory": profile.bit_memory });
    memory[if is_s7200 { "V memory" } else { "data blocks" }] = db_bytes.into();
    let away = cpu.driver.away();
    let devices = (1u8..).zip(&image.config.remote).map(|(number, device)| {
        let line = match &device.line {
            RemoteLine::Tcp(address) => format!("Modbus TCP {address}"),
            RemoteLine::Serial { path, .. } => format!("Modbus RTU {path}"),
        };
        let is_away = away.iter().any(|change| change.station == number && change.whole);
        json!({ "name": device.name, "line": line, "unit": device.unit, "away": is_away })
    });
    let modules = image.config.modules.iter().flatten().map(module);
    let partners = image
        .config
        .connections
        .iter()
        .map(|one| json!({ "id": one.id, "partner": one.partner, "active": one.active }));
    json!({
        "cpu": profile.name,
        "order": image.config.cpu_order,
        "program": image.name,
        "cycle_limit_ms": image.cycle_limit_ms(),
        "faults": cpu.diagnostics.faults(),
        "blocks": blocks,
        "modules": modules.collect::<Vec<_>>(),
        "devices": devices.collect::<Vec<_>>(),
        "partners": partners.collect::<Vec<_>>(),
        "obs": obs.collect::<Vec<_>>(),
        "memory": memory,
    })
}
