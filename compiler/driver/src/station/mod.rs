//! The station: racks, slots and modules from plc.toml, with the addresses that the CPU assigns.
//!
//! - [`keys`]: the text; [`catalog`]: modules and CPUs; this file converts keys to modules.
//! - [`rules`]: limits of a station; [`list`]: its table as text.
//!
//! Source: SIMATIC S7-300 hardware and installation, arranging and addressing modules.

mod catalog;
mod keys;
mod list;
mod rules;
#[cfg(test)]
mod tests;

use std::ops::Range;

use plcc_abi::image::{AnalogChannel, Module, StationModule};
use plcc_diag::{Code, Diagnostic, FileId, Span};
use plcc_runtime::analog;
use toml::Spanned;

use crate::keys::one_of;

use catalog::{CpuRow, Kind, Type};
pub use keys::StationKeys;
use keys::{ModuleKeys, OneOrMore};
pub use list::table;

/// A station as plc.toml describes it.
#[derive(Clone, Debug, Default)]
pub struct Station {
    /// Order number or name of the CPU as written.
    pub cpu: Option<(String, Span)>,
    pub dp_address: Option<u32>,
    pub mpi_address: Option<u32>,
    /// In the order of racks and slots; the CPU's own inputs and outputs in slot 2.
    modules: Vec<Placed>,
}

/// A module in its slot.
#[derive(Clone, Debug)]
struct Placed {
    rack: u8,
    slot: u8,
    order: String,
    name: String,
    module: Type,
    input_start: u32,
    output_start: u32,
    /// Analog channels, inputs first.
    channels: Vec<AnalogChannel>,
    substitute: u32,
    span: Span,
    onboard: bool,
}

impl Placed {
    /// Its name in messages.
    fn text(&self) -> String {
        format!("`{}` in rack {}, slot {}", self.name, self.rack, self.slot)
    }

    fn inputs(&self) -> Range<u32> {
        self.input_start..self.input_start + self.module.input_bytes()
    }

    fn outputs(&self) -> Range<u32> {
        self.output_start..self.output_start + self.module.output_bytes()
    }
}

impl Station {
    /// The name of the CPU's profile: an order number becomes a name, anything else stays as it is.
    pub fn profile(&self) -> Option<(String, Span)> {
        let (name, span) = self.cpu.as_ref()?;
        Some((catalog::cpu_ordered(name).map_or_else(|| name.clone(), |row| row.name.to_string()), *span))
    }

    /// Order number of the CPU, empty if only its name is known.
    pub fn cpu_order(&self) -> String {
        let order = self.cpu.as_ref().map(|(name, _)| name.clone()).filter(|name| catalog::cpu_ordered(name).is_some());
        order.unwrap_or_default()
    }

    /// The settings for the runtime.
    pub fn modules(&self) -> Vec<Module> {
        self.modules.iter().map(Placed::module).collect()
    }
}

impl Placed {
    fn module(&self) -> Module {
        let inputs = if self.module.kind.is_analog() { self.module.inputs as usize } else { 0 };
        let (analog_inputs, analog_outputs) = self.channels.split_at(inputs.min(self.channels.len()));
        Module {
            name: self.name.clone(),
            input_start: self.input_start,
            input_bytes: self.module.input_bytes(),
            output_start: self.output_start,
            output_bytes: self.module.output_bytes(),
            station: Some(StationModule {
                rack: self.rack,
                slot: self.slot,
                order: self.order.clone(),
                analog_inputs: analog_inputs.to_vec(),
                analog_outputs: analog_outputs.to_vec(),
                substitute: self.substitute,
            }),
        }
    }
}

/// Peripheral addresses are 16 bits wide.
const PERIPHERAL_BYTES: i64 = 65536;

/// Builds the station of a plc.toml. `cpu`: the project's own key. Reports errors.
pub fn read(keys: &StationKeys, cpu: Option<&(String, Span)>, file: FileId) -> (Station, Vec<Diagnostic>) {
    let mut reader = Reader { file, diagnostics: Vec::new() };
    let place = |text: &Spanned<String>| (text.get_ref().clone(), Span::new(file, text.span()));
    let mut station = Station {
        cpu: keys.cpu.as_ref().map(place),
        dp_address: keys.dp_address.as_ref().and_then(|key| reader.number(key, 0..=126, "a PROFIBUS address")),
        mpi_address: keys.mpi_address.as_ref().and_then(|key| reader.number(key, 0..=126, "an MPI address")),
        modules: keys.module.iter().filter_map(|module| reader.module(module)).collect(),
    };
    // A CPU may be listed as a module in slot 2.
    let in_slot = station.modules.iter().find(|module| module.module.kind == Kind::Cpu);
    let slot_cpu =
        in_slot.map(|module| (if module.order.is_empty() { &module.name } else { &module.order }.clone(), module.span));
    station.cpu = station.cpu.or(slot_cpu).or_else(|| cpu.cloned());
    let row = station.profile().and_then(|(name, _)| cpu_row(&name));
    if let Some(row) = row {
        reader.onboard(&mut station, row);
    }
    for module in station.modules.iter_mut().filter(|module| !module.onboard) {
        reader.addresses(module, keys, row);
    }
    station.modules.sort_by_key(|module| (module.rack, module.slot, !module.onboard));
    reader.diagnostics.extend(rules::check(&station, cpu, row));
    (station, reader.diagnostics)
}

/// What the CPU of this name allows.
fn cpu_row(name: &str) -> Option<&'static CpuRow> {
    catalog::cpu_named(&plcc_model::profile::lookup(name)?.name)
}

struct Reader {
    file: FileId,
    diagnostics: Vec<Diagnostic>,
}

impl Reader {
    fn report(&mut self, range: Range<usize>, title: impl Into<String>, help: impl Into<String>) {
        self.diagnostics.push(Diagnostic::new(Code::Station, Span::new(self.file, range), title).help(help));
    }

    fn number<T: TryFrom<i64>>(
        &mut self,
        key: &Spanned<i64>,
        range: std::ops::RangeInclusive<i64>,
        what: &str,
    ) -> Option<T> {
        let help = format!("write a number from {} to {}", range.start(), range.end());
        crate::project::number_within(key, range, what).map_err(|title| self.report(key.span(), title, help)).ok()
    }

    /// A module with its default addresses.
    fn module(&mut self, keys: &ModuleKeys) -> Option<Placed> {
        let rack = keys.rack.as_ref().map_or(Some(0), |rack| self.number(rack, 0..=3, "a rack"))?;
        let slot = self.number(&keys.slot, 1..=11, "a slot")?;
        let (known, module) = self.kind(keys)?;
        let order = keys.order.as_ref().map(|order| order.get_ref().trim().to_string()).unwrap_or_default();
        let name = keys.name.clone().or(known.map(str::to_string)).unwrap_or_else(|| match module.kind {
            Kind::Cpu if !order.is_empty() => order.clone(),
            kind => kind.name().to_string(),
        });
        let start = default_start(module.kind, rack, slot);
        let span = Span::new(self.file, keys.slot.span());
        let substitute = keys.substitute.as_ref().and_then(|key| match module.kind.is_analog() {
            true => self.number::<i64>(key, -32768..=32767, "a word").map(|word| u32::from(word as i16 as u16)),
            false => self.number(key, 0..=i64::from(u32::MAX), "a bit pattern"),
        });
        Some(Placed {
            rack,
            slot,
            order,
            name,
            module,
            input_start: start,
            output_start: start,
            channels: self.channels(keys, &module),
            substitute: substitute.unwrap_or(0),
            span,
            onboard: false,
        })
    }

    /// The type by order number, or by kind and channels.
    fn kind(&mut self, keys: &ModuleKeys) -> Option<(Option<&'static str>, Type)> {
        let order = keys.order.as_ref();
        if let Some(row) = order.and_then(|order| catalog::lookup(order.get_ref())) {
            return Some((Some(row.name), row.module));
        }
        if let Some(cpu) = order.and_then(|order| catalog::cpu_ordered(order.get_ref())) {
            return Some((Some(cpu.name), Type { kind: Kind::Cpu, inputs: 0, outputs: 0, bits: 0 }));
        }
        let Some(kind) = &keys.kind else {
            match order {
                Some(order) => {
                    let title = format!("plcc does not know the module `{}`", order.get_ref());
                    self.report(order.span(), title, "give its `kind` and `channels` in addition to the order number");
                }
                None => self.report(
                    keys.slot.span(),
                    "a module needs `order`, or `kind` and `channels`",
                    format!("kinds are {}", Kind::names()),
                ),
            }
            return None;
        };
        let Some(found) = Kind::named(kind.get_ref()) else {
            self.report(
                kind.span(),
                format!("`{}` is not a kind of module", kind.get_ref()),
                format!("kinds are {}", Kind::names()),
            );
            return None;
        };
        let (inputs, outputs) = self.channel_counts(keys, kind, found)?;
        let bits = keys.bits.as_ref().and_then(|bits| self.number(bits, 7..=15, "a resolution in bits")).unwrap_or(15);
        Some((None, Type { kind: found, inputs, outputs, bits }))
    }

    fn channel_counts(&mut self, keys: &ModuleKeys, kind: &Spanned<String>, found: Kind) -> Option<(u32, u32)> {
        if !found.is_digital() && !found.is_analog() {
            return Some((0, 0));
        }
        let most = if found.is_digital() { 64 } else { 8 };
        let wanted = if found.directions() == (true, true) {
            "`channels = [8, 8]`, inputs and outputs"
        } else {
            "`channels = 8`"
        };
        let Some(channels) = &keys.channels else {
            self.report(
                kind.span(),
                format!("`{}` needs its number of channels", kind.get_ref()),
                format!("write {wanted}"),
            );
            return None;
        };
        let counts = channels.get_ref().as_slice();
        let good = counts.iter().all(|count| (1..=most).contains(count));
        match (found.directions(), counts) {
            ((true, true), &[inputs, outputs]) if good => Some((inputs as u32, outputs as u32)),
            ((true, false), &[inputs]) if good => Some((inputs as u32, 0)),
            ((false, true), &[outputs]) if good => Some((0, outputs as u32)),
            _ => {
                let title = format!("`{}` has 1 to {most} channels in each direction", kind.get_ref());
                self.report(channels.span(), title, format!("write {wanted}"));
                None
            }
        }
    }

    fn channels(&mut self, keys: &ModuleKeys, module: &Type) -> Vec<AnalogChannel> {
        let count = if module.kind.is_analog() { (module.inputs + module.outputs) as usize } else { 0 };
        let channel =
            |range: &str| AnalogChannel { range: range.to_string(), bits: module.bits, wire_break: keys.wire_break };
        let mut channels = vec![channel(""); count];
        let Some(ranges) = &keys.range else { return channels };
        let given = ranges.get_ref().as_slice();
        let one_for_all = matches!(ranges.get_ref(), OneOrMore::One(_));
        if count == 0 || (!one_for_all && given.len() != count) {
            let title = format!("{} ranges for a module with {count} analog channels", given.len());
            self.report(ranges.span(), title, "write one range for each channel, inputs first, or one text for all");
            return channels;
        }
        for (index, place) in channels.iter_mut().enumerate() {
            let name = if one_for_all { &given[0] } else { &given[index] };
            match analog::range(name) {
                Some(range) => *place = channel(range.name),
                // An unused channel.
                None if name.is_empty() => {}
                None => {
                    let names: Vec<&str> = analog::RANGES.iter().map(|range| range.name).collect();
                    self.report(ranges.span(), format!("`{name}` is not a range"), one_of(name, &names));
                    break;
                }
            }
        }
        channels
    }

    /// Inputs and outputs inside the CPU.
    fn onboard(&mut self, station: &mut Station, row: &CpuRow) {
        let span = station.cpu.as_ref().map_or(Span::new(self.file, 0..0), |(_, span)| *span);
        for onboard in row.onboard {
            let channels = (onboard.module.inputs + onboard.module.outputs) as usize;
            let channel = AnalogChannel { range: String::new(), bits: onboard.module.bits, wire_break: false };
            station.modules.push(Placed {
                rack: 0,
                slot: 2,
                order: String::new(),
                name: format!("{} of CPU {}", onboard.name, row.name),
                module: onboard.module,
                input_start: onboard.start,
                output_start: onboard.start,
                channels: vec![channel; if onboard.module.kind.is_analog() { channels } else { 0 }],
                substitute: 0,
                span,
                onboard: true,
            });
        }
    }

    /// Start addresses in plc.toml that replace the default ones.
    fn addresses(&mut self, module: &mut Placed, all: &StationKeys, row: Option<&CpuRow>) {
        let Some(keys) = all.module.iter().find(|keys| Span::new(self.file, keys.slot.span()) == module.span) else {
            return;
        };
        let (has_inputs, has_outputs) = module.module.kind.directions();
        let (inputs, outputs) = (module.inputs(), module.outputs());
        for (key, has, default, what) in
            [(&keys.inputs, has_inputs, inputs, "inputs"), (&keys.outputs, has_outputs, outputs, "outputs")]
        {
            let Some(key) = key else { continue };
            if !has {
                self.report(key.span(), format!("{} has no {what}", module.text()), format!("leave out `{what}`"));
                continue;
            }
            let last = PERIPHERAL_BYTES - i64::from(default.end - default.start);
            let Some(start) = self.number::<u32>(key, 0..=last, "a start address") else { continue };
            if let Some(row) = row.filter(|row| !row.free_addresses && start != default.start) {
                let title = format!("a CPU {} fixes the addresses of each slot", row.name);
                self.report(key.span(), title, format!("{} has {what} from byte {}", module.text(), default.start));
            } else if module.module.kind.is_analog() && start % 2 != 0 {
                self.report(
                    key.span(),
                    format!("{} cannot start at an odd address", module.text()),
                    "channels are words at even addresses",
                );
            } else if what == "inputs" {
                module.input_start = start;
            } else {
                module.output_start = start;
            }
        }
    }
}

/// First byte of a slot. Digital: 4 bytes per slot, 32 per rack. All others: 16 bytes per slot and 128 per rack, from 256.
fn default_start(kind: Kind, rack: u8, slot: u8) -> u32 {
    let (rack, slot) = (u32::from(rack), u32::from(slot.saturating_sub(4)));
    if kind.is_digital() { 32 * rack + 4 * slot } else { 256 + 128 * rack + 16 * slot }
}
