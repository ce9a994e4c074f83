//! Alarms of the program: what came and went. There is no display, so nothing is acknowledged.
//!
//! Each event is an entry of the diagnostic buffer, and a line of the file of `--alarm-log`.
//!
//! Source: System and standard functions, block-related messages.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::Write;

use crate::cpu::Cpu;
use crate::diagnostics::{self, ALARM_CAME, ALARM_WENT, Entry};

/// Alarms that the CPU follows at a time.
const ALARMS_MAX: usize = 4096;

/// The alarms of a run.
#[derive(Default)]
pub struct Alarms {
    /// Last signal of each number, and of each signal of a block with several.
    states: BTreeMap<(u32, u8), State>,
    /// Numbers of messages that DIS_MSG has disabled; `all_disabled`: each one.
    disabled: BTreeSet<u32>,
    all_disabled: bool,
    /// Where events are written.
    log: Option<File>,
    last_own: u32,
}

#[derive(Clone, Copy, Default)]
struct State {
    signal: bool,
    /// An event is to be acknowledged, and is not.
    open: bool,
}

/// What is reported.
#[derive(Clone, Copy, Debug)]
pub struct Report<'a> {
    pub number: u32,
    /// Which signal of the block.
    pub place: u8,
    pub signal: bool,
    /// The event is to be acknowledged.
    pub to_acknowledge: bool,
    /// Its associated values.
    pub values: &'a [u8],
    pub site: u32,
}

impl Alarms {
    /// Writes events to this file from now on.
    pub fn write_to(&mut self, mut file: File) {
        let _ = writeln!(file, "time,event,alarm,signal,values,place");
        self.log = Some(file);
    }

    /// The alarms of a CPU that starts again: none is active, and the file goes on.
    pub(crate) fn restarted(self) -> Alarms {
        Alarms { log: self.log, ..Alarms::default() }
    }

    /// State of an alarm, and whether its last event was acknowledged; `None`: it is not known.
    pub fn state(&self, number: u32) -> Option<(bool, bool)> {
        self.states.get(&(number, 0)).map(|state| (state.signal, !state.open))
    }

    /// A number for an alarm that the program gives none.
    pub fn own_number(&mut self) -> u32 {
        self.last_own = self.last_own.wrapping_add(1);
        0x8000_0000 | self.last_own
    }

    pub fn enable(&mut self, number: Option<u32>, enabled: bool) {
        match number {
            None => {
                self.all_disabled = !enabled;
                self.disabled.clear();
            }
            Some(number) if enabled => _ = self.disabled.remove(&number),
            Some(number) if self.disabled.len() < ALARMS_MAX => _ = self.disabled.insert(number),
            Some(_) => {}
        }
    }
}

impl Cpu {
    /// Takes the signal of an alarm; a change is an event. False: too many alarms.
    pub(crate) fn report_alarm(&self, report: &Report) -> bool {
        let mut alarms = self.alarms.borrow_mut();
        let key = (report.number, report.place);
        let before = alarms.states.get(&key).copied().unwrap_or_default();
        if before.signal == report.signal {
            return true;
        }
        if !alarms.states.contains_key(&key) && alarms.states.len() >= ALARMS_MAX {
            return false;
        }
        alarms.states.insert(key, State { signal: report.signal, open: report.to_acknowledge });
        if alarms.all_disabled || alarms.disabled.contains(&report.number) {
            return true;
        }
        let event = if report.signal { ALARM_CAME } else { ALARM_WENT };
        let (ob, wall) = (self.running.ob.get(), self.clock.wall());
        let entry = Entry { event, info: report.number, access: 0, site: report.site, ob, wall };
        self.diagnostics.push(entry);
        if let Some(log) = &mut alarms.log {
            let time = crate::datetime::civil(wall);
            let word = if report.signal { "came" } else { "went" };
            let values: String = report.values.iter().map(|byte| format!("{byte:02X}")).collect();
            let place = diagnostics::place_text(&self.image, &entry);
            let signal = report.place + 1;
            // A full disk must not stop the plant.
            let _ = writeln!(log, "{time:.3},{word},16#{:08X},{signal},{values},\"{place}\"", report.number);
        }
        true
    }
}
