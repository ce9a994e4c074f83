//! Settings of the CPU: cycle, memory bytes, startup, technology, and what it keeps and offers.

use plcc_abi::image::Config;
use plcc_diag::Span;
use toml::Spanned;

use super::Context;
use super::keys::{ExceededKey, Keys, StartupKey};
use crate::cpu_settings::CpuSetting;
use crate::{axes, connections, retain, s7200, services, technology};

impl Context {
    /// How long a cycle takes, and how long it may.
    pub(super) fn cycle_times(&mut self, keys: &Keys, config: &mut Config) {
        config.cycle_time_ms = keys.cycle_time.as_ref().and_then(|time| self.duration(time, 1..=6000));
        let Some(time) = &keys.cycle_time_max else { return };
        config.cycle_time_max_ms = self.duration(time, 1..=6000).unwrap_or(config.cycle_time_max_ms);
        if let (Some(key), Some(cycle)) = (&keys.cycle_time, config.cycle_time_ms)
            && cycle > config.cycle_time_max_ms
        {
            let (own, most) = (key.get_ref(), time.get_ref());
            let help = format!("write a longer `cycle_time_max` than `{own}`, or a shorter `cycle_time` than `{most}`");
            self.report(key.span(), "a cycle takes longer than its monitoring allows", &help);
        }
    }

    /// The bytes of clock memory and system memory.
    pub(super) fn memory_bytes(&mut self, keys: &Keys, config: &mut Config) {
        let (clock, system) = (keys.clock_memory.as_ref(), keys.system_memory_byte.as_ref());
        for key in [clock, system].into_iter().flatten() {
            if let Ok(byte) = u16::try_from(*key.get_ref()) {
                self.note_of_cpu(CpuSetting::MemoryByte(byte), key.span());
            }
        }
        config.clock_memory_byte = clock.and_then(|byte| self.number(byte, 0..=65535, "a memory byte"));
        config.system_memory_byte = system.and_then(|byte| self.number(byte, 0..=65535, "a memory byte"));
        if let Some(byte) = system
            && config.system_memory_byte.is_some()
            && config.system_memory_byte == config.clock_memory_byte
        {
            self.report(byte.span(), "clock memory and system memory are one byte", "give each a byte of its own");
        }
    }

    /// The folder of the files that the program writes.
    pub(super) fn data_folder(&mut self, keys: &Keys, config: &mut Config) {
        let Some(data) = &keys.data else { return };
        if data.get_ref().is_empty() || data.get_ref().contains('\0') {
            self.report(data.span(), "this is not the name of a folder", "write `\"plc-data\"`");
        } else {
            config.data_folder = Some(data.get_ref().clone());
        }
    }

    /// What a cycle that takes too long leads to, and how the CPU starts.
    pub(super) fn startup(&mut self, keys: &Keys, config: &mut Config) {
        if let Some(key) = &keys.cycle_time_exceeded {
            config.overrun_stops = Some(matches!(key.get_ref(), ExceededKey::Stop));
            self.note_of_cpu(CpuSetting::Exceeded, key.span());
        }
        config.startup = match keys.startup.as_ref().map(Spanned::get_ref) {
            None | Some(StartupKey::Warm) => 100,
            Some(StartupKey::Hot) => 101,
            Some(StartupKey::Cold) => 102,
        };
        if let (Some(key), 102) = (&keys.startup, config.startup) {
            self.note_of_cpu(CpuSetting::Cold, key.span());
        }
    }

    /// Fast counters, pulse generators and hardware interrupts.
    pub(super) fn technology(&mut self, keys: &Keys, config: &mut Config) -> technology::Used {
        let (used, messages) = technology::read(&keys.hsc, &keys.pulse, &keys.hardware_interrupt, self.file, config);
        self.diagnostics.extend(messages);
        for (ob, range) in technology::started(&keys.hardware_interrupt) {
            self.note_of_cpu(CpuSetting::EventOb(ob), range);
        }
        used
    }

    /// The source that declares the axes, and their names with their headings.
    pub(super) fn axes(&mut self, keys: &Keys) -> (String, Vec<(String, Span)>) {
        let (source, messages) = axes::source(&keys.axis, self.file);
        self.diagnostics.extend(messages);
        let heading = |name: &Spanned<String>| (name.get_ref().clone(), Span::new(self.file, name.span()));
        let names: Vec<(String, Span)> = keys.axis.keys().map(heading).collect();
        if let Some((_, first)) = names.iter().min_by_key(|(_, heading)| heading.start) {
            self.note_of_cpu(CpuSetting::Axes, first.range());
        }
        (source, names)
    }

    /// Retentive memory, services, connections, and the settings of an S7-200.
    pub(super) fn services(&mut self, keys: &Keys, config: &mut Config) {
        if let Some(keys) = &keys.retain {
            for (retained, count, range) in keys.counts() {
                self.note_of_cpu(CpuSetting::Retentive(retained, count), range);
            }
            let (retain, messages) = retain::read(keys, self.file);
            config.retain = retain;
            self.diagnostics.extend(messages);
        }
        if let Some(keys) = &keys.services {
            let (services, messages) = services::read(keys, self.file);
            config.services = services;
            if let Some(range) = services::complete_protection(keys) {
                self.note_of_cpu(CpuSetting::Complete, range);
            }
            self.diagnostics.extend(messages);
        }
        let (connections, messages) = connections::read(&keys.connection, self.file);
        self.diagnostics.extend(messages);
        // Services carry their jobs.
        config.services.linked |= !connections.is_empty();
        config.connections = connections;
        if let Some(keys) = &keys.s7200 {
            let (settings, messages) = s7200::read(keys.get_ref(), self.file);
            config.s7200 = settings;
            self.diagnostics.extend(messages);
        }
    }
}
