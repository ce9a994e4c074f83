//! The addresses of modules and of devices on a field bus.

use std::collections::BTreeMap;

use plcc_abi::image::{Config, Module};
use toml::Spanned;

use super::Context;
use super::keys::{AddressKeys, ModuleKeys};
use crate::cpu_settings::CpuSetting;
use crate::remote;

/// Hardware identifiers that a module may have. The CPU itself and its interfaces have smaller ones.
const HARDWARE_IDS: std::ops::RangeInclusive<i64> = 256..=32_767;
/// Peripheral addresses are 16 bits wide.
const PERIPHERAL_BYTES: i64 = 65536;

impl Context {
    /// The modules of the station, and those that `[[module]]` describes with their addresses.
    pub(super) fn modules(&mut self, mut modules: Vec<Module>, keys: &[ModuleKeys]) -> Vec<Module> {
        for module in keys {
            let (input_start, input_bytes) = self.addresses(module.inputs.as_ref());
            let (output_start, output_bytes) = self.addresses(module.outputs.as_ref());
            let name = module.name.get_ref().clone();
            let new = Module { name, input_start, input_bytes, output_start, output_bytes, station: None };
            if let Some(other) = modules.iter().find(|other| overlap(other, &new)) {
                let title = format!("modules `{}` and `{}` have addresses in common", other.name, new.name);
                self.report(module.name.span(), title, "give each module its own addresses");
            }
            modules.push(new);
        }
        modules
    }

    /// The hardware identifiers of the modules of `keys`, with those by their addresses.
    pub(super) fn hardware_ids(&mut self, modules: &[Module], keys: &[ModuleKeys]) -> Vec<(u16, u16)> {
        let mut ids: Vec<(u16, u16)> = Vec::new();
        for (module, keys) in modules.iter().zip(keys) {
            let Some(key) = &keys.hardware_id else { continue };
            self.note_of_cpu(CpuSetting::HardwareId, key.span());
            let Some(id) = self.number::<u16>(key, HARDWARE_IDS, "a hardware identifier") else { continue };
            if ids.iter().any(|(other, _)| *other == id) {
                let title = format!("two modules have the hardware identifier {id}");
                self.report(key.span(), title, "write the number that the properties of each module show");
            }
            ids.push((id, module.identifier()));
        }
        ids
    }

    /// Devices on a field bus. Beside modules their addresses are further ones.
    pub(super) fn devices(&mut self, keys: &BTreeMap<Spanned<String>, remote::IoKeys>, config: &mut Config) {
        let (stations, messages) = remote::read(keys, self.file);
        self.diagnostics.extend(messages);
        if let Some(modules) = &mut config.modules {
            let new: Vec<Module> = remote::modules(&stations).collect();
            for device in &new {
                if let Some(other) = modules.iter().find(|other| overlap(other, device)) {
                    let title = format!("`{}` and module `{}` have addresses in common", device.name, other.name);
                    let name = keys.keys().find(|name| device.name == format!("io {}", name.get_ref()));
                    let span = name.map_or(0..0, Spanned::span);
                    self.report(span, title, "give each its own addresses");
                }
            }
            modules.extend(new);
        }
        config.remote = stations;
    }

    /// Start byte and number of bytes; both 0 if the module has none.
    fn addresses(&mut self, keys: Option<&AddressKeys>) -> (u32, u32) {
        let Some(keys) = keys else { return (0, 0) };
        let start = self.number::<u32>(&keys.start, 0..=PERIPHERAL_BYTES - 1, "a start address");
        let most = PERIPHERAL_BYTES - i64::from(start.unwrap_or_default());
        let bytes = self.number::<u32>(&keys.bytes, 1..=most, "a number of bytes");
        (start.unwrap_or_default(), bytes.unwrap_or_default())
    }
}

/// True of modules with a common address.
fn overlap(a: &Module, b: &Module) -> bool {
    let ranges_overlap = |a_start: u32, a_bytes: u32, b_start: u32, b_bytes: u32| {
        a_bytes > 0 && b_bytes > 0 && a_start < b_start + b_bytes && b_start < a_start + a_bytes
    };
    ranges_overlap(a.input_start, a.input_bytes, b.input_start, b.input_bytes)
        || ranges_overlap(a.output_start, a.output_bytes, b.output_start, b.output_bytes)
}
