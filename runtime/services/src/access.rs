//! The CPU as clients see it.

use plcc_abi::image::{self, BlockKind};
use plcc_abi::layout;
use plcc_abi::s7200::{COUNTERS, TIMERS, V_DB, system};
use plcc_runtime::cpu::{self, Cpu};
use plcc_runtime::diagnostics::{Entry, is_fault};
use plcc_runtime::events::priority;
use plcc_runtime::options;
use plcc_runtime::{bcd, counters, datetime, timers};

use crate::s7::{Area, BlockInfo, DateAndTime, Event, Family, ItemError, Names, Place, Plc, Restart};

/// See the module comment.
pub struct Access<'a>(pub &'a Cpu);

/// A part of memory: where it begins and how long it is.
type Range = (u32, u32);

impl Access<'_> {
    fn is_s7200(&self) -> bool {
        self.family() == Family::S7200
    }

    /// Where an area is in PLC memory. Timers, counters and modules are elsewhere.
    fn range(&self, area: Area) -> Result<Range, ItemError> {
        let cpu = || self.0.image.s7200.as_ref().map(|own| &own.cpu).ok_or(ItemError::Missing);
        let system = |offset, bytes| Ok((layout::SYSTEM + offset, bytes));
        match area {
            Area::Inputs => Ok(self.0.area(cpu::Area::Inputs)),
            Area::Outputs => Ok(self.0.area(cpu::Area::Outputs)),
            Area::BitMemory => Ok(self.0.area(cpu::Area::BitMemory)),
            Area::Db(number) => match self.0.memory.db(number) {
                _ if self.is_s7200() && number != V_DB => Err(ItemError::Missing),
                (_, 0) => Err(ItemError::Missing),
                _ if self.0.is_optimized(number) => Err(ItemError::Missing),
                found => Ok(found),
            },
            Area::SpecialMemory => system(system::SM, cpu()?.sm_bytes.min(system::SM_BYTES)),
            Area::AnalogInputs => system(system::AI, cpu()?.analog_bytes.min(system::ANALOG_BYTES)),
            Area::AnalogOutputs => system(system::AQ, cpu()?.analog_bytes.min(system::ANALOG_BYTES)),
            Area::Peripheral | Area::Timers | Area::Counters | Area::SystemInfo => Err(ItemError::Missing),
        }
    }

    /// The place in PLC memory, if all of it exists, with the values of this moment.
    fn inside(&self, place: Place) -> Result<u32, ItemError> {
        let (base, length) = self.range(place.area)?;
        match place.start.checked_add(place.count) {
            Some(end) if end <= length => {
                self.0.s7200_before_client(base + place.start, place.count);
                Ok(base + place.start)
            }
            Some(_) | None => Err(ItemError::OutOfRange),
        }
    }

    /// Number of timers or counters.
    fn cells(&self, area: Area) -> u32 {
        let profile = &self.0.image.profile;
        match (area, self.is_s7200()) {
            (Area::Timers, true) => profile.timers.min(TIMERS),
            (_, true) => profile.counters.min(COUNTERS),
            (Area::Timers, false) => profile.timers,
            (_, false) => profile.counters,
        }
    }

    /// Where the current values of an S7-200 are.
    fn s7200_values(area: Area) -> u32 {
        layout::SYSTEM + if area == Area::Timers { system::TIMER_VALUES } else { system::COUNTER_VALUES }
    }

    /// The cells of a place, with the values of this moment.
    fn cell_numbers(&self, place: Place) -> Result<std::ops::Range<u32>, ItemError> {
        match place.start.checked_add(place.count) {
            Some(end) if end <= self.cells(place.area) => {
                self.0.s7200_before_client(Self::s7200_values(place.area) + 2 * place.start, 2 * place.count);
                Ok(place.start..end)
            }
            Some(_) | None => Err(ItemError::OutOfRange),
        }
    }

    /// Timers as S5TIME, counters as BCD; of an S7-200 current values.
    fn read_cells(&self, place: Place) -> Result<Vec<u8>, ItemError> {
        let Cpu { memory, clock, .. } = self.0;
        let value = |number: u32| match place.area {
            _ if self.is_s7200() => memory.word(Self::s7200_values(place.area) + 2 * number),
            Area::Timers => timers::remaining(memory, clock, number),
            _ => bcd::from_int(counters::value(memory, number), 3) as u16,
        };
        Ok(self.cell_numbers(place)?.flat_map(|number| value(number).to_be_bytes()).collect())
    }

    fn write_cells(&self, place: Place, data: &[u8]) -> Result<(), ItemError> {
        let Cpu { memory, clock, .. } = self.0;
        let numbers = self.cell_numbers(place)?;
        let values: Vec<u16> = data.as_chunks::<2>().0.iter().map(|word| u16::from_be_bytes(*word)).collect();
        let is_bcd = |value: u16| (0..3).all(|digit| value >> (4 * digit) & 15 <= 9);
        if !self.is_s7200() && !values.iter().all(|value| is_bcd(*value)) {
            return Err(ItemError::TypeInconsistent);
        }
        for (number, value) in numbers.zip(values) {
            match place.area {
                _ if self.is_s7200() => memory.set_word(Self::s7200_values(place.area) + 2 * number, value),
                Area::Timers => timers::set_value(memory, clock, number, value),
                _ => counters::set_value(memory, number, bcd::to_int(value.into(), 3) as u16),
            }
        }
        Ok(())
    }

    fn read_modules(&self, place: Place) -> Result<Vec<u8>, ItemError> {
        let bytes = place.start..place.start.saturating_add(place.count);
        bytes.map(|byte| self.0.module_input(byte).map(|value| value as u8).ok_or(ItemError::Hardware)).collect()
    }

    fn kind(code: u8) -> Option<BlockKind> {
        Some(match code {
            0x08 => BlockKind::Ob,
            0x0A => BlockKind::Db,
            0x0C => BlockKind::Fc,
            0x0D => BlockKind::Sfc,
            0x0E => BlockKind::Fb,
            0x0F => BlockKind::Sfb,
            _ => return None,
        })
    }
}

/// How the names of profiles begin that are of a family, not of one CPU.
const FAMILY_BEGINS: &str = "s7-";

/// What is written on the CPU of a profile: `CPU 315-2 PN/DP` for `315-2PN/DP`.
fn module_name(profile: &str) -> String {
    let is_digit = |letter: char| letter.is_ascii_digit();
    let begins = ["PN", "DP", "PtP", "IFM"].into_iter().filter_map(|interface| profile.find(interface)).min();
    let begins = begins.filter(|at| profile[..*at].ends_with(is_digit)).unwrap_or(profile.len());
    let (model, interface) = profile.split_at(begins);
    let kind = if model.starts_with(is_digit) { "CPU " } else { "" };
    format!("{kind}{model} {interface}").trim_end().to_string()
}

/// The bytes of a place, or the bit of its byte that was asked for.
fn asked(place: Place, bytes: &[u8]) -> Vec<u8> {
    match place.bit {
        Some(bit) => bytes.iter().map(|byte| byte >> bit & 1).collect(),
        None => bytes.to_vec(),
    }
}

/// The modes of an event that changes them, before and after it in half a byte each; `None`: another event.
///
/// Source: System and standard functions, mode transitions in the diagnostic buffer.
fn modes(event: u16) -> Option<u8> {
    const STOP: u8 = 4;
    const WARM: u8 = 6;
    const RUN: u8 = 8;
    match event {
        0x4301 => Some(STOP << 4 | WARM),
        0x4302 => Some(WARM << 4 | RUN),
        0x4303..=0x4304 | 0x4540..=0x457F => Some(RUN << 4 | STOP),
        _ => None,
    }
}

impl Access<'_> {
    fn event(&self, entry: &Entry) -> Event {
        /// Of all changes of mode.
        const PRIORITY: u8 = 0xFF;
        let (priority, ob) = match (modes(entry.event), entry.ob) {
            (Some(modes), _) => (PRIORITY, modes),
            (None, 0) => (PRIORITY, 0),
            (None, ob) => (priority(ob, &self.0.image.profile, &self.0.image.config), ob.min(255) as u8),
        };
        Event { event: entry.event, ob, priority, info: entry.info, time: datetime::encode(entry.wall) }
    }
}

impl Plc for Access<'_> {
    fn family(&self) -> Family {
        match self.0.image.profile.family {
            image::Family::S7300 => Family::S7300,
            image::Family::S7400 => Family::S7400,
            image::Family::S7200 => Family::S7200,
            image::Family::S71200 => Family::S71200,
            image::Family::S71500 => Family::S71500,
        }
    }

    fn names(&self) -> Names {
        let image = &self.0.image;
        let (given, profile) = (image.config.cpu_order.clone(), &image.profile.name);
        if !profile.starts_with(FAMILY_BEGINS) {
            return Names { program: image.name.clone(), order: given, module: module_name(profile) };
        }
        // Of a family its most usual CPU.
        let (order, module) = match self.family() {
            Family::S7300 => ("6ES7 315-2AG10-0AB0", "CPU 315-2 DP"),
            Family::S7400 => ("6ES7 414-2XG04-0AB0", "CPU 414-2"),
            Family::S7200 => ("6ES7 214-1AD23-0XB0", "CPU 224"),
            Family::S71200 => ("6ES7 214-1AG40-0XB0", "CPU 1214C DC/DC/DC"),
            Family::S71500 => ("6ES7 511-1AK01-0AB0", "CPU 1511-1 PN"),
        };
        Names { program: image.name.clone(), order: order.to_string(), module: module.to_string() }
    }

    fn read(&self, place: Place) -> Result<Vec<u8>, ItemError> {
        match place.area {
            Area::Timers | Area::Counters => self.read_cells(place),
            Area::Peripheral => Ok(asked(place, &self.read_modules(place)?)),
            Area::SystemInfo => {
                let text = format!("{:<20}", self.names().module);
                let (start, end) = (place.start as usize, (place.start + place.count) as usize);
                text.as_bytes().get(start..end).map(|bytes| asked(place, bytes)).ok_or(ItemError::OutOfRange)
            }
            _ => {
                let at = self.inside(place)?;
                Ok(match place.bit {
                    Some(bit) => vec![self.0.memory.bit(at, bit).into()],
                    None => self.0.memory.view(at, place.count, <[u8]>::to_vec),
                })
            }
        }
    }

    fn write(&self, place: Place, data: &[u8]) -> Result<(), ItemError> {
        match place.area {
            Area::Timers | Area::Counters => return self.write_cells(place, data),
            Area::SystemInfo | Area::AnalogInputs => return Err(ItemError::NotAllowed),
            Area::Db(number) if self.0.is_read_only(number) => return Err(ItemError::NotAllowed),
            Area::SpecialMemory if place.start < system::SM_READ_ONLY_BYTES => return Err(ItemError::NotAllowed),
            // Outputs are disabled then.
            Area::AnalogOutputs if self.0.is_stopped() => return Err(ItemError::NotAllowed),
            Area::Peripheral => {
                if place.bit.is_some() {
                    return Err(ItemError::OutOfRange);
                }
                // Outputs are disabled then.
                if self.0.is_stopped() {
                    return Err(ItemError::NotAllowed);
                }
                let missing =
                    (place.start..).zip(data).any(|(byte, value)| self.0.peripheral_write(byte, 1, u32::from(*value)));
                return if missing { Err(ItemError::Hardware) } else { Ok(()) };
            }
            _ => {}
        }
        let at = self.inside(place)?;
        match place.bit {
            Some(bit) => self.0.memory.set_bit(at, bit, data.first().is_some_and(|value| value & 1 != 0)),
            None => self.0.memory.load(at, data),
        }
        self.0.s7200_after_client(at, place.count);
        if place.area == Area::Outputs {
            self.0.note_outputs(place.start + place.count);
        }
        Ok(())
    }

    fn is_forcing(&self) -> bool {
        self.0.is_forcing()
    }

    fn is_running(&self) -> bool {
        !self.0.is_stopped()
    }

    fn stop(&self) {
        self.0.stop_by_request();
    }

    fn start(&self, restart: Restart) -> bool {
        self.0.request_restart(match restart {
            Restart::Warm => options::Restart::Warm,
            Restart::Cold => options::Restart::Cold,
        })
    }

    fn blocks(&self, kind: u8) -> Vec<u16> {
        let Some(kind) = Self::kind(kind) else { return Vec::new() };
        let image = &self.0.image;
        let mut numbers: Vec<u16> = match kind {
            BlockKind::Db => image.dbs.iter().map(|db| db.number).collect(),
            _ => {
                let inner = image.inner_blocks.iter().map(|(kind, number, _)| (*kind, *number));
                let all = image.blocks.iter().map(|block| (block.kind, block.number)).chain(inner);
                all.filter(|(found, _)| *found == kind).map(|(_, number)| number).collect()
            }
        };
        numbers.sort_unstable();
        numbers
    }

    fn block(&self, code: u8, number: u16) -> Option<BlockInfo> {
        let kind = Self::kind(code)?;
        let image = &self.0.image;
        if kind == BlockKind::Db {
            let db = image.dbs.iter().find(|db| db.number == number)?;
            let bytes = db.data.len().min(usize::from(u16::MAX)) as u16;
            let name = db.name.clone();
            return Some(BlockInfo { number, bytes, local_data: 0, name, read_only: db.read_only });
        }
        let named = image.blocks.iter().map(|block| (block.kind, block.number, &block.name, block.frame));
        let inner = image.inner_blocks.iter().map(|(kind, number, name)| (*kind, *number, name, 0));
        let (.., name, frame) = named.chain(inner).find(|(found, own, ..)| (*found, *own) == (kind, number))?;
        let local_data = frame.min(u32::from(u16::MAX)) as u16;
        // Machine code of this computer has no length that means something to a client.
        Some(BlockInfo { number, bytes: 0, local_data, name: name.clone(), read_only: false })
    }

    fn clock(&self) -> DateAndTime {
        datetime::encode(self.0.clock.wall())
    }

    fn set_clock(&self, time: DateAndTime) -> bool {
        match datetime::decode(time) {
            Ok(moment) => {
                self.0.set_wall_clock(moment);
                true
            }
            Err(_) => false,
        }
    }

    fn block_bytes_max(&self) -> u32 {
        self.0.image.profile.db_bytes_max
    }

    fn events(&self, count: usize) -> Vec<Event> {
        self.0.diagnostics.newest_first().into_iter().take(count).map(|entry| self.event(&entry)).collect()
    }

    fn ob_status(&self, ob: u16) -> Option<Vec<u8>> {
        self.0.ob_status(ob)
    }

    fn last_mode_change(&self) -> Option<Event> {
        let entries = self.0.diagnostics.newest_first();
        entries.iter().find(|entry| modes(entry.event).is_some()).map(|entry| self.event(entry))
    }

    fn has_faults(&self) -> bool {
        const STARTUP: u16 = 0x4301;
        let entries = self.0.diagnostics.newest_first();
        entries.iter().take_while(|entry| entry.event != STARTUP).any(|entry| is_fault(entry.event))
    }

    fn sizes(&self) -> [u16; 6] {
        let profile = &self.0.image.profile;
        [profile.inputs, profile.outputs, profile.bit_memory, profile.timers, profile.counters, profile.local_data]
            .map(|size| size.min(u32::from(u16::MAX)) as u16)
    }

    fn retentive(&self) -> [u16; 3] {
        self.0.retentive_amounts().map(|amount| amount.min(u32::from(u16::MAX)) as u16)
    }

    fn data_memory(&self) -> [u32; 3] {
        let memory = self.0.data_memory();
        [memory.all, memory.used, memory.largest_free]
    }

    fn modules(&self) -> Vec<[u16; 8]> {
        self.0.module_status().into_iter().map(|(_, record)| record).collect()
    }

    fn cell_bit(&self, area: Area, number: u32) -> bool {
        let bits = if area == Area::Timers { system::TIMER_BITS } else { system::COUNTER_BITS };
        self.is_s7200() && number < self.cells(area) && self.0.memory.byte(layout::SYSTEM + bits + number) != 0
    }
}

#[cfg(test)]
mod tests {
    use super::module_name;

    #[test]
    fn modules_are_named_as_it_is_written_on_them() {
        for (profile, name) in [
            ("315-2DP", "CPU 315-2 DP"),
            ("314C-2PN/DP", "CPU 314C-2 PN/DP"),
            ("313C-2PtP", "CPU 313C-2 PtP"),
            ("312IFM", "CPU 312 IFM"),
            ("1513pro F-2PN", "CPU 1513pro F-2 PN"),
            ("1504D TF", "CPU 1504D TF"),
            ("224XP", "CPU 224XP"),
            ("IM 151-8F PN/DP", "IM 151-8F PN/DP"),
            ("IM 154-8PN/DP", "IM 154-8 PN/DP"),
        ] {
            assert_eq!(module_name(profile), name);
        }
    }
}
