//! Diagnostic buffer: the events of the CPU. The newest entry is last in memory and first in print.
//!
//! Entries are plain numbers in a ring made before the first cycle; words are found when it is printed.
//! Source of the event texts: event list of the CPUs.

use std::cell::{Cell, RefCell};

use plcc_abi::ProgramImage;
use plcc_abi::image::{BlockKind, Site};
use plcc_abi::remote::RemoteChannel;

use crate::datetime;

/// Entries that the ring holds.
pub const CAPACITY: usize = 500;

/// Events of alarms; no event of a CPU has these numbers.
pub const ALARM_CAME: u16 = 0xC001;
pub const ALARM_WENT: u16 = 0xC002;
pub const USER_CAME: u16 = 0xC011;
pub const USER_WENT: u16 = 0xC012;

/// Events of retentive memory; no event of a CPU has these numbers.
pub const RETAIN_LOST: u16 = 0xC021;
pub const RETAIN_CHANGED: u16 = 0xC022;
pub const RETAIN_NOT_WRITTEN: u16 = 0xC023;
pub const RETAIN_WRITTEN: u16 = 0xC024;
pub const MEMORY_RESET: u16 = 0xC025;

/// The program was changed while it ran; no event of a CPU has this number.
pub const PROGRAM_CHANGED: u16 = 0xC031;

/// Values are forced, or no longer, or were forced by another version of the program; no event of a CPU has these numbers.
pub const FORCE_ACTIVE: u16 = 0xC032;
pub const FORCE_ENDED: u16 = 0xC033;
pub const FORCE_LEFT_OUT: u16 = 0xC034;

/// Outputs are enabled in STOP, or disabled again; no event of a CPU has these numbers.
pub const OUTPUTS_ENABLED: u16 = 0xC035;
pub const OUTPUTS_DISABLED: u16 = 0xC036;

/// No place in the program is known.
pub const NO_SITE: u32 = u32::MAX;

/// An entry. `site` is an index into `ProgramImage::sites`, or [`NO_SITE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    pub event: u16,
    /// Subject of the event: a number or address, as in the start information.
    pub info: u32,
    /// Access to memory: the access byte of OB 121, and the data block in the upper half.
    pub access: u32,
    pub site: u32,
    /// OB that was running, 0: none.
    pub ob: u16,
    pub wall: i64,
}

impl Entry {
    /// See [`Diagnostics::rename_sites`].
    pub(crate) fn rename_site(&mut self, renamed: &[(u32, u32)]) {
        let found = renamed.iter().find(|(before, _)| *before == self.site);
        self.site = found.map_or(NO_SITE, |(_, now)| *now);
    }
}

/// A synchronous or asynchronous error, or a STOP because of one. Source: event list of the CPUs, event classes.
pub fn is_fault(event: u16) -> bool {
    let came = event & 0x0100 != 0;
    matches!(event >> 12, 2 | 3) && came || event >> 8 == 0x45 && event != 0x457F
}

/// The ring.
pub struct Diagnostics {
    entries: RefCell<Vec<Entry>>,
    next: Cell<usize>,
    count: Cell<u64>,
    faults: Cell<u64>,
}

impl Default for Diagnostics {
    fn default() -> Self {
        Diagnostics {
            entries: RefCell::new(Vec::with_capacity(CAPACITY)),
            next: Cell::new(0),
            count: Cell::new(0),
            faults: Cell::new(0),
        }
    }
}

impl Diagnostics {
    pub fn push(&self, entry: Entry) {
        if is_fault(entry.event) {
            self.faults.set(self.faults.get() + 1);
        }
        self.count.set(self.count.get() + 1);
        let mut entries = self.entries.borrow_mut();
        if entries.len() < CAPACITY {
            entries.push(entry);
        } else {
            entries[self.next.get()] = entry;
        }
        self.next.set((self.next.get() + 1) % CAPACITY);
    }

    /// Entries since the CPU was switched on, those that the ring no longer holds included.
    pub fn count(&self) -> u64 {
        self.count.get()
    }

    /// Faults that came since the CPU was switched on.
    pub fn faults(&self) -> u64 {
        self.faults.get()
    }

    /// Places have other numbers in a changed program: the old numbers, and the new ones.
    pub(crate) fn rename_sites(&self, renamed: &[(u32, u32)]) {
        self.entries.borrow_mut().iter_mut().for_each(|entry| entry.rename_site(renamed));
    }

    /// All entries, newest first.
    pub fn newest_first(&self) -> Vec<Entry> {
        let entries = self.entries.borrow();
        let split = if entries.len() < CAPACITY { entries.len() } else { self.next.get() };
        let (newer, older) = entries.split_at(split);
        newer.iter().rev().chain(older.iter().rev()).copied().collect()
    }
}

/// Source place of a site number.
pub fn site(image: &ProgramImage, site: u32) -> Option<&Site> {
    image.sites.get(site as usize)
}

/// `FC 3, network 2, main.stl:17`, or the running OB where no site is known. Blocks with names are called by them, and those of the
/// library have the place of their first use.
pub fn place_text(image: &ProgramImage, entry: &Entry) -> String {
    match site(image, entry.site) {
        Some(site) => {
            let file = image.files.get(site.file as usize).map_or("?", String::as_str);
            let network = if site.network == 0 { String::new() } else { format!("network {}, ", site.network) };
            match (site.block, block_name(image, site.block, site.block_number)) {
                (BlockKind::Sfc | BlockKind::Sfb, Some(name)) => format!("{name}, first used in {file}:{}", site.line),
                (kind @ (BlockKind::Ob | BlockKind::Fc | BlockKind::Fb), Some(name)) => {
                    format!("{name} ({} {}), {network}{file}:{}", kind.prefix(), site.block_number, site.line)
                }
                (kind, _) => format!("{} {}, {network}{file}:{}", kind.prefix(), site.block_number, site.line),
            }
        }
        None if entry.ob != 0 => format!("OB {}", entry.ob),
        None => String::new(),
    }
}

/// The symbolic name of a block with code, if it has one.
fn block_name(image: &ProgramImage, kind: BlockKind, number: u16) -> Option<&str> {
    let entered = image.blocks.iter().map(|block| (block.kind, block.number, block.name.as_str()));
    let inner = image.inner_blocks.iter().map(|(kind, number, name)| (*kind, *number, name.as_str()));
    let found = entered.chain(inner).find(|(found, own, _)| (*found, *own) == (kind, number));
    found.map(|(.., name)| name).filter(|name| !name.is_empty())
}

/// Event in words, with its number.
pub fn event_text(image: &ProgramImage, entry: &Entry) -> String {
    let info = entry.info;
    if let Some(text) = crate::s7200::event_text(entry.event, info) {
        return text;
    }
    let words = match entry.event {
        0x4301 => "startup".to_string(),
        0x4302 => "RUN".to_string(),
        0x4303 => "STOP by request".to_string(),
        0x4304 => "STOP by a client".to_string(),
        0x39C4 | 0x39CB => format!("{} does not answer, address {info}", device_text(image, info)),
        0x38C4 | 0x38CB => format!("{} answers again, address {info}", device_text(image, info)),
        0x3942 => format!("{} refuses a request, address {info}", device_text(image, info)),
        0x3842 => format!("{} accepts requests again, address {info}", device_text(image, info)),
        0x4562 => "STOP: programming error and no OB 121".to_string(),
        0x4563 => "STOP: I/O access error and no OB 122".to_string(),
        0x4568 if info == 2 => "STOP: cycle time exceeded twice in one cycle".to_string(),
        0x4568 if info == 3 => "STOP: endless loop (no end of the cycle within the hang limit)".to_string(),
        0x4568 => "STOP: time error and no OB 80".to_string(),
        0x456A => "STOP: diagnostic interrupt and no OB 82".to_string(),
        0x456B => "STOP: module removed or inserted and no OB 83".to_string(),
        0x456D if info == 0 => "STOP: priority class error and no OB 85".to_string(),
        0x456D => format!("STOP: OB {info} is requested but not loaded, and no OB 85"),
        0x456E => "STOP: communication error and no OB 87".to_string(),
        0x456F => "STOP: rack or DP failure and no OB 86".to_string(),
        0x4570 => "STOP: processing abort and no OB 88".to_string(),
        0x4571 => "STOP: nesting stack error".to_string(),
        0x4572 => "STOP: MCR stack error".to_string(),
        0x4573 => "STOP: synchronous errors nested too deeply".to_string(),
        0x4575 => "STOP: blocks nested too deeply".to_string(),
        0x4576 => "STOP: local data stack exhausted".to_string(),
        0x457F => "STOP by SFC 46 (STP)".to_string(),
        0x3501 => format!("cycle time exceeded ({info} ms)"),
        0x3502 => format!("OB {info} is requested while it is still active or waiting"),
        0x3505 => format!("time jump: time-of-day interrupt OB {info} was skipped"),
        0x3507 => format!("queue of interrupts is full (OB {info})"),
        0x35A1 => format!("OB {info} is requested but not loaded"),
        event @ 0x2521..=0x253F => sync_error_text(image, event as u8, info, entry.access),
        0x2942 => format!("I/O access error: {}, on reading", unanswered(image, entry, false)),
        0x2943 => format!("I/O access error: {}, on writing", unanswered(image, entry, true)),
        0x8000..=0xBFFF => format!("event of the program (SFC 52), INFO2 16#{info:08X}"),
        ALARM_CAME => format!("alarm 16#{info:08X} came"),
        ALARM_WENT => format!("alarm 16#{info:08X} went"),
        USER_CAME => format!("message of the program came: text {}, list {}", info & 0xFFFF, info >> 16),
        USER_WENT => format!("message of the program went: text {}, list {}", info & 0xFFFF, info >> 16),
        RETAIN_LOST => "retentive memory is lost: all data begins with its start values".to_string(),
        RETAIN_CHANGED => format!("DB {info} begins with its start values: its layout has changed"),
        RETAIN_NOT_WRITTEN => "retentive memory cannot be written".to_string(),
        RETAIN_WRITTEN => "retentive memory is written again".to_string(),
        MEMORY_RESET => "memory reset".to_string(),
        FORCE_ACTIVE if info == 1 => "1 value is forced".to_string(),
        FORCE_ACTIVE => format!("{info} values are forced"),
        FORCE_ENDED => "forcing has ended".to_string(),
        FORCE_LEFT_OUT if info == 1 => "1 value is no longer forced: the program has changed".to_string(),
        FORCE_LEFT_OUT => format!("{info} values are no longer forced: the program has changed"),
        OUTPUTS_ENABLED => "a client has enabled the outputs in STOP".to_string(),
        OUTPUTS_DISABLED => "outputs are disabled again".to_string(),
        PROGRAM_CHANGED => "the program was changed".to_string(),
        event => format!("event of class {}", event >> 12),
    };
    format!("16#{:04X} {words}", entry.event)
}

/// The device of `[io]` that has an address, if one alone has it; `output`: among the outputs, else among the inputs, `None`: among both.
fn device(image: &ProgramImage, address: u32, output: Option<bool>) -> Option<&str> {
    let has = |channel: &RemoteChannel| {
        let range = channel.byte..channel.byte + channel.bytes();
        output.is_none_or(|output| channel.output == output) && range.contains(&address)
    };
    let mut devices = image.config.remote.iter().filter(|station| station.channels.iter().any(has));
    let found = devices.next()?;
    devices.next().is_none().then_some(found.name.as_str())
}

/// `device tank`.
fn device_text(image: &ProgramImage, address: u32) -> String {
    device(image, address, None).map_or_else(|| "a device".to_string(), |name| format!("device {name}"))
}

/// Why an access to a peripheral address has failed.
fn unanswered(image: &ProgramImage, entry: &Entry, output: bool) -> String {
    let area = if output { "PQ" } else { "PI" };
    let address = address_text(entry.access, entry.info).replacen('P', area, 1);
    match device(image, entry.info, Some(output)) {
        Some(name) => format!("device {name} is away or refuses {address}"),
        None => format!("no module has {address}"),
    }
}

/// `DBW 200`, `MB 70000`, `PIW 300`: the address of an access; `access` is the access byte of OB 121.
fn address_text(access: u32, byte: u32) -> String {
    use plcc_abi::codes::{access as width, access_area};
    let area = match access as u8 & 0x0F {
        access_area::I => "I",
        access_area::Q => "Q",
        access_area::M => "M",
        access_area::DB => "DB",
        access_area::DI => "DI",
        access_area::L => "L",
        access_area::V => "local data of the caller, L",
        _ => "P",
    };
    let width = match access as u8 & 0xF0 {
        width::BYTE => "B",
        width::WORD => "W",
        width::DWORD => "D",
        _ if area.starts_with('D') => "X",
        _ => "",
    };
    format!("{area}{width} {byte}")
}

/// What is wrong with an address that its area does not have.
fn length_text(image: &ProgramImage, access: u32, byte: u32, direction: &str) -> String {
    use plcc_abi::codes::{access_area, fault_info};
    if access & fault_info::INDEX != 0 {
        return format!("index {} is outside the bounds of its array, on {direction}", byte as i32);
    }
    if access & fault_info::INDICES != 0 {
        return format!("an index is outside the bounds of its array, on {direction}");
    }
    let address = address_text(access, byte);
    let db = access >> 16;
    let area = access as u8 & 0x0F;
    if !matches!(area, access_area::DB | access_area::DI) || db == 0 {
        let profile = &image.profile;
        let length = match area {
            access_area::I => format!("; the CPU has {} bytes of inputs", profile.inputs),
            access_area::Q => format!("; the CPU has {} bytes of outputs", profile.outputs),
            access_area::M => format!("; the CPU has {} bytes of bit memory", profile.bit_memory),
            _ => String::new(),
        };
        return format!("{address} does not exist, on {direction}{length}");
    }
    match image.dbs.iter().find(|known| u32::from(known.number) == db) {
        Some(known) => {
            let name = if known.name.is_empty() { String::new() } else { format!(" \"{}\"", known.name) };
            format!("DB {db}{name} has {} bytes; {address} does not exist, on {direction}", known.data.len())
        }
        None => format!("DB {db} has no {address}, on {direction}"),
    }
}

/// What is wrong with the area of a pointer.
fn area_text(area: u32, direction: &str) -> String {
    match area {
        0 => format!("a pointer has no area, as `P#10.0` has none and `P#M 10.0` has one, on {direction}"),
        area => format!("wrong area 16#{area:02X} in a pointer, on {direction}"),
    }
}

fn sync_error_text(image: &ProgramImage, code: u8, info: u32, access: u32) -> String {
    use plcc_abi::codes::sync;
    match code {
        sync::BCD => "BCD conversion error: a digit is greater than 9".to_string(),
        sync::LENGTH_READ => length_text(image, access, info, "reading"),
        sync::LENGTH_WRITE => length_text(image, access, info, "writing"),
        sync::AREA_READ => area_text(info, "reading"),
        sync::AREA_WRITE => area_text(info, "writing"),
        sync::TIMER_NUMBER => format!("timer {info} does not exist; the CPU has {}", image.profile.timers),
        sync::COUNTER_NUMBER => format!("counter {info} does not exist; the CPU has {}", image.profile.counters),
        sync::ALIGN_READ => format!("bit address is not 0 in a pointer (byte {info}), on reading"),
        sync::ALIGN_WRITE => format!("bit address is not 0 in a pointer (byte {info}), on writing"),
        sync::WRITE_PROTECTED_DB => format!("DB {info} is write-protected"),
        sync::WRITE_PROTECTED_DI => format!("instance DB {info} is write-protected"),
        sync::DB_NUMBER if !image.profile.family.is_portal() => "no DB is open, or its number is wrong".to_string(),
        sync::DB_NUMBER => "no DB is open, its number is wrong, or a reference is NULL".to_string(),
        sync::DI_NUMBER => "no instance DB is open, or its number is wrong".to_string(),
        sync::FC_NUMBER => format!("FC number {info} is too large"),
        sync::FB_NUMBER => format!("FB number {info} is too large"),
        sync::DB_MISSING => format!("DB {info} is not loaded"),
        sync::FC_MISSING => format!("FC {info} is not loaded"),
        sync::SFC_MISSING => format!("SFC {info} does not exist"),
        sync::FB_MISSING => format!("FB {info} is not loaded"),
        sync::SFB_MISSING => format!("SFB {info} does not exist"),
        code => format!("programming error 16#{code:02X}"),
    }
}

/// One line of the printed buffer.
pub fn line(image: &ProgramImage, entry: &Entry) -> String {
    let time = datetime::civil(entry.wall);
    let place = place_text(image, entry);
    let separator = if place.is_empty() { "" } else { "; " };
    format!("{time:.3} {}{separator}{place}", event_text(image, entry))
}

#[cfg(test)]
mod tests {
    use plcc_abi::remote::{RemoteLine, RemoteStation, RemoteTable};

    use super::*;

    #[test]
    fn ring_keeps_the_newest() {
        let diagnostics = Diagnostics::default();
        for info in 0..CAPACITY as u32 + 3 {
            diagnostics.push(Entry { event: 1, info, access: 0, site: NO_SITE, ob: 0, wall: 0 });
        }
        let infos: Vec<u32> = diagnostics.newest_first().iter().map(|entry| entry.info).collect();
        assert_eq!((infos.len(), diagnostics.count()), (CAPACITY, CAPACITY as u64 + 3));
        assert_eq!(infos[0], CAPACITY as u32 + 2);
        assert_eq!(infos[CAPACITY - 1], 3);
    }

    #[test]
    fn devices_are_named_by_their_addresses() {
        let station = |name: &str, byte, output| RemoteStation {
            name: name.to_string(),
            line: RemoteLine::Tcp("127.0.0.1:502".to_string()),
            unit: 1,
            poll_ms: 100,
            timeout_ms: 1000,
            keep: true,
            channels: vec![RemoteChannel {
                table: RemoteTable::HoldingRegisters,
                first: 0,
                count: 2,
                output,
                byte,
                bit: 0,
                low_byte_first: false,
                low_word_first: false,
                scale: None,
                substitute: 0,
            }],
        };
        let mut image = crate::tests::image(&[]);
        image.config.remote =
            vec![station("tank", 300, false), station("drive", 310, true), station("hand", 310, false)];
        let text = |event, info| {
            let access = u32::from(plcc_abi::codes::access::WORD);
            event_text(&image, &Entry { event, info, access, site: NO_SITE, ob: 0, wall: 0 })
        };
        assert_eq!(text(0x39C4, 300), "16#39C4 device tank does not answer, address 300");
        assert_eq!(text(0x38C4, 310), "16#38C4 a device answers again, address 310");
        assert_eq!(text(0x2942, 302), "16#2942 I/O access error: device tank is away or refuses PIW 302, on reading");
        assert_eq!(text(0x2943, 310), "16#2943 I/O access error: device drive is away or refuses PQW 310, on writing");
        assert_eq!(text(0x2942, 304), "16#2942 I/O access error: no module has PIW 304, on reading");
    }
}
