//! Fatal and non-fatal errors. Source: S7-200 system manual, error codes.

use std::cell::{Cell, RefCell};

use plcc_abi::s7200::{error, fatal};

use super::set_special;
use crate::cpu::Cpu;
use crate::diagnostics::{self, Entry};

/// Event of a fatal error, plus its code.
const FATAL: u16 = fatal::EVENT;
/// Event of a non-fatal error, plus its code.
const NON_FATAL: u16 = 0xFB00;
/// The program has executed STOP.
pub(crate) const STOP_INSTRUCTION: u16 = 0xFAFF;
/// The scan watchdog has expired.
pub(crate) const WATCHDOG_EXPIRED: u16 = FATAL + fatal::WATCHDOG;
/// The program has changed the diagnostic LED.
pub(crate) const LED_CHANGED: u16 = 0xFC00;
/// After this error retentive memory is not saved.
pub(crate) const INTERNAL_ERROR: u16 = FATAL + fatal::INTERNAL;
/// In place of the milliseconds: the scan did not end within the hang limit.
pub(super) const ENDLESS: u32 = u32::MAX;

/// Places with errors that the diagnostic buffer names one by one.
const PLACES_MAX: usize = 64;

/// Bit of SMB4: a programming error occurred in this scan.
const ERROR_BIT: (u32, u8) = (4, 3);

/// Non-fatal errors since RUN began.
#[derive(Default)]
pub struct Errors {
    count: Cell<u64>,
    first: Cell<Option<Entry>>,
    last: Cell<Option<Entry>>,
    /// Site and code of those that were entered in the buffer: one that occurs in each scan does not fill it.
    logged: RefCell<Vec<(u32, u16)>>,
}

impl Errors {
    /// The program was changed: places have other numbers.
    pub(super) fn rename_sites(&mut self, renamed: &[(u32, u32)]) {
        for entry in [self.first.get_mut(), self.last.get_mut()].into_iter().flatten() {
            entry.rename_site(renamed);
        }
        self.logged.get_mut().clear();
    }

    /// The first and the last error.
    pub(crate) fn entries(&self) -> impl Iterator<Item = Entry> {
        self.first.get().into_iter().chain(self.last.get())
    }

    /// True the first time that this error is seen at this place.
    fn is_new(&self, site: u32, code: u16) -> bool {
        let mut logged = self.logged.borrow_mut();
        let new = logged.len() < PLACES_MAX && !logged.contains(&(site, code));
        if new {
            logged.push((site, code));
        }
        new
    }
}

impl Cpu {
    /// Notes a non-fatal error: SM4.3, first and last error for the report. See [`RuntimeFn::S7200Error`](plcc_abi::RuntimeFn::S7200Error).
    pub(crate) fn s7200_error(&self, site: u32, code: u16) {
        let Some(own) = self.s7200() else { return };
        set_special(&self.memory, ERROR_BIT.0, ERROR_BIT.1, true);
        let event = NON_FATAL | code & 0xFF;
        let errors = &own.errors;
        let stops = own.config.stop_on_error && !self.is_stopped();
        let entry = if !stops && errors.is_new(site, code) {
            self.log(event, site, 0)
        } else {
            Entry { event, info: 0, access: 0, site, ob: self.running.ob.get(), wall: self.clock.wall() }
        };
        errors.count.set(errors.count.get().saturating_add(1));
        errors.last.set(Some(entry));
        if errors.first.get().is_none() {
            errors.first.set(Some(entry));
        }
        if stops {
            self.stop_by(event, site, 0);
        }
    }

    /// First and last non-fatal error, one line each; none if there was no error.
    pub fn s7200_error_report(&self) -> Vec<String> {
        let Some(errors) = self.s7200().map(|own| &own.errors) else { return Vec::new() };
        let line = |what: &str, entry: &Entry| format!("{what}: {}", diagnostics::line(&self.image, entry));
        match (errors.count.get(), errors.first.get(), errors.last.get()) {
            (1, Some(only), _) => vec![line("1 non-fatal error", &only)],
            (count, Some(first), Some(last)) => {
                vec![line(&format!("first of {count} non-fatal errors"), &first), line("last one", &last)]
            }
            (_, _, _) => Vec::new(),
        }
    }
}

/// An event of an S7-200 in words; `None`: it is of another CPU.
pub(crate) fn event_text(event: u16, info: u32) -> Option<String> {
    let code = event & 0xFF;
    let text = match event {
        STOP_INSTRUCTION => "STOP by the STOP instruction".to_string(),
        WATCHDOG_EXPIRED if info == ENDLESS => {
            "fatal error 0003: endless loop (no end of the scan within the hang limit)".to_string()
        }
        WATCHDOG_EXPIRED if info != 0 => format!("fatal error 0003: {} ({info} ms)", fatal_text(code)),
        LED_CHANGED => format!("diagnostic LED {}", if info == 0 { "off" } else { "on" }),
        _ => match event & 0xFF00 {
            FATAL => format!("fatal error {code:04X}: {}", fatal_text(code)),
            NON_FATAL => format!("non-fatal error {code:04X}: {}", error_text(code)),
            _ => return None,
        },
    };
    Some(text)
}

fn fatal_text(code: u16) -> &'static str {
    fatal::text(code).unwrap_or("fatal error")
}

fn error_text(code: u16) -> &'static str {
    error::text(code).unwrap_or("run-time programming error")
}
