//! Rules for a station: slots, racks, addresses.
//!
//! Source: SIMATIC S7-300 hardware and installation, arranging modules on racks.

use std::ops::Range;

use plcc_diag::{Code, Diagnostic, Span};

use super::catalog::{CpuRow, Kind};
use super::{Placed, Station, catalog};

/// All errors in the station. `cpu`: the project's own key.
pub(super) fn check(station: &Station, cpu: Option<&(String, Span)>, row: Option<&CpuRow>) -> Vec<Diagnostic> {
    let mut diagnostics = Vec::new();
    cpus(station, cpu, &mut diagnostics);
    let modules: Vec<&Placed> = station.modules.iter().filter(|module| !module.onboard).collect();
    for module in &modules {
        diagnostics.extend(slot(module));
        diagnostics.extend(row.and_then(|row| limits(module, row)));
    }
    for (index, module) in station.modules.iter().enumerate() {
        for other in &station.modules[..index] {
            diagnostics.extend(pair(other, module));
        }
    }
    racks(&modules, &mut diagnostics);
    diagnostics
}

fn wrong(span: Span, title: String, help: &str) -> Diagnostic {
    Diagnostic::new(Code::Station, span, title).help(help)
}

/// Exactly one CPU, of a family that has slots.
fn cpus(station: &Station, project: Option<&(String, Span)>, diagnostics: &mut Vec<Diagnostic>) {
    let profile = |name: &str| {
        let name = catalog::cpu_ordered(name).map_or(name, |row| row.name);
        plcc_model::profile::lookup(name).map(|profile| profile.name)
    };
    let Some((name, span)) = &station.cpu else {
        if let Some(module) = station.modules.first() {
            let title = "the station has no CPU".to_string();
            diagnostics.push(wrong(module.span, title, "write `cpu = \"315-2DP\"` below `[station]`"));
        }
        return;
    };
    if profile(name).is_some_and(|profile| catalog::cpu_named(&profile).is_none()) {
        let title = format!("the CPU `{name}` has no S7-300 racks");
        diagnostics.push(wrong(*span, title, "give the addresses of its modules with `[[module]]`"));
    }
    let in_slot = station.modules.iter().filter(|module| module.module.kind == Kind::Cpu);
    let named = in_slot.map(|module| (if module.order.is_empty() { &module.name } else { &module.order }, module.span));
    for (other, other_span) in named.chain(project.map(|(name, span)| (name, *span))) {
        if other_span != *span && profile(other) != profile(name) {
            let title = format!("the station has two CPUs, `{name}` and `{other}`");
            diagnostics
                .push(wrong(other_span, title, "a station has exactly one").also(*span, format!("`{name}` is here")));
        }
    }
}

fn slot(module: &Placed) -> Option<Diagnostic> {
    let kind = module.module.kind;
    let (fits, help) = match module.slot {
        1 => (kind == Kind::Ps, "slot 1 holds the power supply"),
        2 => (kind == Kind::Cpu && module.rack == 0, "slot 2 holds the CPU, in rack 0"),
        3 => (kind.is_interface(), "slot 3 holds the interface module (IM 360, 361, 365) or is empty"),
        _ => (
            !kind.is_interface() && !matches!(kind, Kind::Ps | Kind::Cpu),
            "slots 4 to 11 hold signal modules, function modules and communication processors",
        ),
    };
    (!fits).then(|| wrong(module.span, format!("{} is not allowed there", module.text()), help))
}

fn limits(module: &Placed, row: &CpuRow) -> Option<Diagnostic> {
    let help = "choose a CPU with more, or another slot";
    if module.rack >= row.racks {
        let title = format!("{}: a CPU {} has rack 0 only", module.text(), row.name);
        return Some(wrong(module.span, title, help));
    }
    if row.short_rack && (module.rack, module.slot) == (3, 11) {
        let title = format!("{}: with a CPU {} this slot stays empty", module.text(), row.name);
        return Some(wrong(module.span, title, "its addresses belong to the CPU's own inputs and outputs"));
    }
    let end = module.inputs().end.max(module.outputs().end);
    let has_addresses = !module.inputs().is_empty() || !module.outputs().is_empty();
    (has_addresses && end > row.peripheral).then(|| {
        let title = format!(
            "{} ends at byte {}, but a CPU {} has addresses up to {}",
            module.text(),
            end - 1,
            row.name,
            row.peripheral - 1
        );
        wrong(module.span, title, "give it a lower start address")
    })
}

/// Two modules in one slot, or with common bytes.
fn pair(a: &Placed, b: &Placed) -> Option<Diagnostic> {
    if a.onboard && b.onboard {
        return None;
    }
    if (a.rack, a.slot) == (b.rack, b.slot) && !a.onboard && !b.onboard {
        let title = format!("`{}` and `{}` are both in rack {}, slot {}", a.name, b.name, a.rack, a.slot);
        return Some(wrong(b.span, title, "a slot holds one module").also(a.span, format!("`{}` is here", a.name)));
    }
    let common = |a: Range<u32>, b: Range<u32>| {
        let common = a.start.max(b.start)..a.end.min(b.end);
        (!common.is_empty()).then_some(common)
    };
    let (what, bytes) = match (common(a.inputs(), b.inputs()), common(a.outputs(), b.outputs())) {
        (Some(bytes), _) => ("input", bytes),
        (None, Some(bytes)) => ("output", bytes),
        (None, None) => return None,
    };
    let title = format!("{} and {} both have {what} byte {}", a.text(), b.text(), bytes.start);
    let message = wrong(b.span, title, "give each module its own addresses with `inputs` and `outputs`");
    Some(message.also(a.span, format!("`{}` is here", a.name)))
}

/// Racks 1 to 3 need interface modules.
fn racks(modules: &[&Placed], diagnostics: &mut Vec<Diagnostic>) {
    let interface = |rack: u8| modules.iter().find(|module| module.rack == rack && module.module.kind.is_interface());
    let kind = |rack: u8| interface(rack).map(|module| module.module.kind);
    for module in modules.iter().filter(|module| module.module.kind.is_interface()) {
        let title = match (module.rack, module.module.kind) {
            (0, Kind::Im361) => format!("{} belongs in racks 1 to 3", module.text()),
            (1..=3, Kind::Im360) => format!("{} belongs in rack 0", module.text()),
            (2 | 3, Kind::Im365) => format!("{}: an IM 365 connects only racks 0 and 1", module.text()),
            _ => continue,
        };
        diagnostics.push(wrong(
            module.span,
            title,
            "rack 0 has an IM 360 and the others an IM 361, or racks 0 and 1 an IM 365 each",
        ));
    }
    for rack in 1..=3u8 {
        let Some(first) = modules.iter().find(|module| module.rack == rack && !module.module.kind.is_interface())
        else {
            continue;
        };
        let connected = match kind(0) {
            Some(Kind::Im360) => kind(rack) == Some(Kind::Im361),
            Some(Kind::Im365) => rack == 1 && kind(rack) == Some(Kind::Im365),
            _ => false,
        };
        if !connected {
            let title = format!("{}: rack {rack} is not connected to rack 0", first.text());
            diagnostics.push(wrong(
                first.span,
                title,
                "put an IM 360 into slot 3 of rack 0 and an IM 361 into slot 3 of this rack, or an IM 365 into both (rack 1)",
            ));
        }
        if kind(0) == Some(Kind::Im365) {
            for module in modules.iter().filter(|m| m.rack == 1 && matches!(m.module.kind, Kind::Fm | Kind::Cp)) {
                let title = format!("{}: a rack after an IM 365 has no communication bus", module.text());
                diagnostics.push(wrong(
                    module.span,
                    title,
                    "put function modules and communication processors into rack 0",
                ));
            }
        }
    }
}
