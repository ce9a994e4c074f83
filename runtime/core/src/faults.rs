//! Faults: synchronous errors, asynchronous errors, STOP.
//!
//! Source: System and standard functions, OB 121, OB 122.

use plcc_abi::codes::{stop, sync};
use plcc_abi::image::{BlockKind, Family};
use plcc_abi::layout::state;

use crate::cpu::{Cpu, Stop};
use crate::diagnostics::{self, Entry, NO_SITE};
use crate::events::{Event, Missing, StartInfo};

/// Second word of a STOP 16#4568: which time error.
pub(crate) const TIME_ERROR_TWICE: u32 = 2;
pub(crate) const TIME_ERROR_HANG: u32 = 3;

/// STOP from outside.
pub(crate) const STOP_BY_REQUEST: u16 = 0x4303;
/// STOP by a programming device, or another client.
pub(crate) const STOP_BY_CLIENT: u16 = 0x4304;

/// Mask bits of SFC 36-38 for programming errors and access errors that exist.
pub(crate) const MASKABLE: [u32; 2] = [0xF43F_03FE, 0x0000_0018];

/// The bit of a synchronous error in the masks, with 0 for programming and 1 for access errors.
///
/// Source: System and standard functions, SFC 36.
fn mask_bit(code: u8) -> Option<(usize, u32)> {
    let bit = match code {
        0x21..=0x29 => code - 0x20,
        0x30..=0x35 => code - 0x30 + 16,
        0x3A => 26,
        0x3C..=0x3F => code - 0x3C + 28,
        sync::IO_READ => return Some((1, 1 << 3)),
        sync::IO_WRITE => return Some((1, 1 << 4)),
        _ => return None,
    };
    Some((0, 1 << bit))
}

/// Whether the program or the user requested the STOP.
fn is_asked(event: u16) -> bool {
    matches!(event, stop::SFC_46 | STOP_BY_REQUEST | STOP_BY_CLIENT | crate::s7200::STOP_INSTRUCTION)
}

impl Cpu {
    /// Writes to the diagnostic buffer.
    pub(crate) fn log(&self, event: u16, site: u32, info: u32) -> Entry {
        self.log_access(event, site, info, 0)
    }

    /// As [`Cpu::log`], for an access to memory. `access`: its access byte, and the data block in the upper half.
    fn log_access(&self, event: u16, site: u32, info: u32, access: u32) -> Entry {
        let entry = Entry { event, info, access, site, ob: self.running.ob.get(), wall: self.clock.wall() };
        self.diagnostics.push(entry);
        if diagnostics::is_fault(event) {
            self.tell(|watcher| watcher.fault(self, &entry));
        }
        entry
    }

    /// STOP with `event`; only the first counts.
    pub(crate) fn stop_by(&self, event: u16, site: u32, info: u32) {
        self.stop_because(event, site, info, None);
    }

    pub(crate) fn stop_because(&self, event: u16, site: u32, info: u32, cause: Option<Entry>) {
        if !self.is_stopped() {
            let entry = self.log(event, site, info);
            self.stop.set(Some(Stop { entry, cause, asked: is_asked(event) }));
            self.meters.iter().for_each(|meter| meter.stand_still(self.clock.now()));
        }
        self.memory.raise_attention();
    }

    /// Synchronous error `code` at `site`: runs OB 121 or OB 122, else STOP if the CPU stops for it. `access`: access byte, and the data
    /// block in the upper half. Result for generated code.
    pub(crate) fn sync_error(&self, site: u32, code: u8, access: u32, info: u32) -> u32 {
        if self.is_stopped() {
            return 1;
        }
        let memory = &self.memory;
        memory.set_host32(state::SUBSTITUTE, 0);
        if self.is_masked(code) {
            return 0;
        }
        let io = matches!(code, sync::IO_READ | sync::IO_WRITE);
        let (ob, class, stop_event) = if io { (122, 0x29, 0x4563) } else { (121, 0x25, 0x4562) };
        let cause = self.log_access(u16::from(class) << 8 | u16::from(code), site, info, access);
        // An S7-1200 has no error OBs: it notes the error and stays in RUN. So does an S7-1500 after an I/O access error without its OB.
        let is_only_noted = match self.image.profile.family {
            Family::S71200 => true,
            Family::S71500 => io && !self.has_ob(ob),
            Family::S7300 | Family::S7400 | Family::S7200 => false,
        };
        if is_only_noted {
            return 0;
        }
        if !self.has_ob(ob) {
            self.stop_because(stop_event, site, 0, Some(cause));
            return 1;
        }
        let start = StartInfo::new(class, code, ob).byte(5, access as u8).word(6, info as u16);
        let mut start = self.with_block(start, site);
        if self.image.profile.family.is_portal() {
            start = start.word(10, self.running.ob.get());
        }
        let read = matches!(
            code,
            sync::IO_READ
                | sync::LENGTH_READ
                | sync::AREA_READ
                | sync::ALIGN_READ
                | sync::TIMER_NUMBER
                | sync::COUNTER_NUMBER
        );
        let outer = (self.running.replaceable.replace(Some(read)), self.running.substitute.replace(0));
        if !self.run_error_ob(ob, start) {
            self.stop_because(stop::SYNC_DEPTH, site, 0, Some(cause));
        }
        memory.set_host32(state::SUBSTITUTE, self.running.substitute.replace(outer.1));
        self.running.replaceable.set(outer.0);
        self.stop_result()
    }

    /// True if the error is masked (SFC 36); notes that it occurred.
    fn is_masked(&self, code: u8) -> bool {
        let (Some((kind, bit)), mut masks) = (mask_bit(code), self.running.masks.get()) else { return false };
        let masked = masks.masked[kind] & bit != 0;
        if masked {
            masks.occurred[kind] |= bit;
            self.running.masks.set(masks);
        }
        masked
    }

    /// Block type and number of the place, which an S7-400 and an S7-1500 put into the start information.
    fn with_block(&self, start: StartInfo, site: u32) -> StartInfo {
        match diagnostics::site(&self.image, site) {
            Some(site) if matches!(self.image.profile.family, Family::S7400 | Family::S71500) => {
                let block_type = match site.block {
                    BlockKind::Ob => 0x88,
                    BlockKind::Db => 0x8A,
                    BlockKind::Fc | BlockKind::Sfc | BlockKind::Sbr | BlockKind::Int => 0x8C,
                    BlockKind::Fb | BlockKind::Sfb => 0x8E,
                };
                start.byte(4, block_type).word(8, site.block_number)
            }
            Some(_) | None => start,
        }
    }

    /// An event whose OB is to run by its priority. When the OB is not loaded: the reaction of the table.
    pub(crate) fn request(&self, event: Event) {
        if matches!(event.ob, 82 | 83 | 86) {
            self.diagnostics_changed.set(true);
        }
        if self.is_stopped() || self.schedule.is_disabled(event.ob) {
            return;
        }
        if self.has_ob(event.ob) {
            self.queue(event);
            return;
        }
        match crate::events::missing(event.ob, self.image.profile.family) {
            Missing::Continue => {}
            Missing::Stop(number) => {
                self.stop_by(number, NO_SITE, 0);
            }
            Missing::ClassError => self.class_error(event),
        }
    }

    /// OB 85, fault A1: the OB of `event` is not loaded.
    fn class_error(&self, event: Event) {
        let ob = u32::from(event.ob);
        let cause = self.log(0x35A1, NO_SITE, ob);
        if !self.has_ob(85) {
            self.stop_because(0x456D, NO_SITE, ob, Some(cause));
            return;
        }
        let info = StartInfo::new(0x35, 0xA1, 85)
            .byte(8, event.info.0[0])
            .byte(9, event.info.0[1])
            .byte(10, self.priority_of(event.ob))
            .byte(11, event.ob as u8);
        self.request(Event { ob: 85, info });
    }

    /// OB 80 with fault `cause` about the OB of `event`.
    pub(crate) fn time_error(&self, cause: u8, event: Event) {
        self.log(0x3500 | u16::from(cause), NO_SITE, u32::from(event.ob));
        // An S7-1200/1500 has OBs whose numbers take a word.
        let portal = self.image.profile.family.is_portal();
        let info = StartInfo::new(0x35, cause, 80)
            .word(6, if portal { event.ob } else { 0 })
            .byte(8, event.info.0[0])
            .byte(9, event.info.0[1])
            .byte(10, self.priority_of(event.ob))
            .byte(11, event.ob as u8);
        self.request(Event { ob: 80, info });
    }

    /// The cycle took longer than allowed, `ms` milliseconds; this was found at `site`.
    pub(crate) fn cycle_time_exceeded(&self, ms: u32, site: u32) {
        let cause = self.log(0x3501, site, ms);
        let monitor = &self.schedule.monitor;
        monitor.overruns.set(monitor.overruns.get() + 1);
        monitor.restart(self.clock.now());
        if monitor.overruns.get() >= 2 || self.running.active.contains(80) {
            self.stop_because(0x4568, site, TIME_ERROR_TWICE, Some(cause));
        } else if !self.has_ob(80) {
            let config = &self.image.config;
            if config.overrun_stops.unwrap_or(self.image.profile.family != Family::S71200) {
                self.stop_because(0x4568, site, 0, Some(cause));
            }
        } else if self.image.profile.family.is_portal() {
            let info =
                StartInfo::new(0x35, 0x01, 80).word(6, self.running.ob.get()).byte(10, self.running.priority.get());
            self.request(Event { ob: 80, info });
        } else {
            self.request(Event { ob: 80, info: self.overrun_info(ms) });
        }
    }

    /// Start information of OB 80 about a cycle of `ms` milliseconds, with the OB that ran then.
    ///
    /// Source: System and standard functions, OB 80.
    pub(crate) fn overrun_info(&self, ms: u32) -> StartInfo {
        let [class, number, ..] = if self.running.ob.get() == 0 { [0; 12] } else { self.running.info.get() };
        StartInfo::new(0x35, 0x01, 80)
            .word(6, ms.min(0xFFFF) as u16)
            .byte(8, class)
            .byte(9, number)
            .byte(10, self.running.priority.get())
            .byte(11, self.running.ob.get() as u8)
    }

    /// Requests OB 80 for time-of-day interrupts that the clock skipped: once, with a bit for each. On an S7-1200/1500 once for each.
    pub(crate) fn times_skipped(&self, skipped: &[Event]) {
        if self.image.profile.family.is_portal() {
            skipped.iter().for_each(|event| self.time_error(0x05, *event));
            return;
        }
        let Some(first) = skipped.first() else { return };
        self.log(0x3505, NO_SITE, u32::from(first.ob));
        let bit = |event: &Event| 1u16.checked_shl(u32::from(event.ob.saturating_sub(10))).unwrap_or(0);
        let bits = skipped.iter().fold(0, |bits, event| bits | bit(event));
        self.request(Event { ob: 80, info: StartInfo::new(0x35, 0x05, 80).word(6, bits) });
    }

    /// The text of a STOP: its cause before it, if there is one.
    pub fn stop_text(&self, stop: &Stop) -> String {
        let place_of = stop.cause.as_ref().unwrap_or(&stop.entry);
        let place = diagnostics::place_text(&self.image, place_of);
        let separator = if place.is_empty() { "" } else { "; " };
        let cause =
            stop.cause.map(|cause| format!(" ({})", diagnostics::event_text(&self.image, &cause))).unwrap_or_default();
        let scan = self.s7200_scan_number().map(|number| format!(" (scan {number})")).unwrap_or_default();
        format!("{}{cause}{separator}{place}{scan}", diagnostics::event_text(&self.image, &stop.entry))
    }
}
