//! Run-time meters: SFC 2 SET_RTM, SFC 3 CTRL_RTM, SFC 4 READ_RTM, which count full hours up to 32767, and SFC 101 RTM, up to 2147483647.
//! They are the same meters, and stand still while the CPU is in STOP.
//!
//! Source: System and standard functions, SFC 2 to 4, SFC 101. Assumption: eight meters, as on most CPUs; see the data sheet.

use std::cell::Cell;

use super::parameters::Call;
use super::{OK, Outcome, error};

/// Meters of a CPU, numbers 0 to 7.
pub(crate) const METERS: usize = 8;

/// Bytes of a meter in retentive memory.
pub(crate) const KEPT_BYTES: usize = 8 + 1;

const NS_PER_S: u64 = 1_000_000_000;
const NS_PER_HOUR: u64 = 3600 * NS_PER_S;
const HOURS_MAX: u64 = 0x7FFF;
/// Of SFC 101.
const LONG_HOURS_MAX: u64 = 0x7FFF_FFFF;

/// A run-time meter.
#[derive(Default)]
pub(crate) struct Meter {
    /// Counted when it was last started or stopped.
    counted_ns: Cell<u64>,
    /// The program has started it.
    is_started: Cell<bool>,
    /// Since when it counts: it is started, and the CPU is not in STOP.
    since: Cell<Option<u64>>,
}

impl Meter {
    fn elapsed(&self, now: u64) -> u64 {
        let running = self.since.get().map_or(0, |since| now.saturating_sub(since));
        self.counted_ns.get().saturating_add(running)
    }

    /// A meter that counts continues from there.
    fn set(&self, hours: u64, now: u64) {
        self.counted_ns.set(hours.saturating_mul(NS_PER_HOUR));
        self.since.set(self.since.get().map(|_| now));
    }

    /// As retentive memory has it: the full seconds counted, and whether it runs.
    pub(crate) fn kept(&self, now: u64) -> [u8; KEPT_BYTES] {
        let mut kept = [0; KEPT_BYTES];
        kept[..8].copy_from_slice(&(self.elapsed(now) / NS_PER_S).to_le_bytes());
        kept[8] = self.is_started.get().into();
        kept
    }

    /// Is where it was when it was [kept](Meter::kept), and counts from the [startup](Meter::go_on) on.
    pub(crate) fn bring_back(&self, kept: &[u8]) {
        let (Some(seconds), Some(&started)) = (kept.first_chunk::<8>(), kept.get(8)) else { return };
        self.counted_ns.set(u64::from_le_bytes(*seconds).saturating_mul(NS_PER_S));
        self.is_started.set(started != 0);
        self.since.set(None);
    }

    /// The CPU goes to STOP.
    pub(crate) fn stand_still(&self, now: u64) {
        self.counted_ns.set(self.elapsed(now));
        self.since.set(None);
    }

    /// The CPU leaves STOP.
    pub(crate) fn go_on(&self, now: u64) {
        if self.is_started.get() && self.since.get().is_none() {
            self.since.set(Some(now));
        }
    }

    fn run(&self, start: bool, now: u64) {
        self.stand_still(now);
        self.is_started.set(start);
        self.go_on(now);
    }
}

fn meter<'a>(call: &'a Call) -> Option<&'a Meter> {
    call.cpu.meters.get(usize::from(call.byte(0)))
}

/// NR, PV: sets the hours; a running one continues from there. 8080 number, 8081 negative.
pub(super) fn set(call: &Call) -> Outcome {
    let Some(meter) = meter(call) else { return error(0x8080) };
    let Ok(hours) = u64::try_from(call.word(1) as i16) else { return error(0x8081) };
    meter.set(hours, call.cpu.clock.now());
    OK
}

/// NR, S: starts or stops. 8080 number.
pub(super) fn control(call: &Call) -> Outcome {
    let Some(meter) = meter(call) else { return error(0x8080) };
    meter.run(call.byte(1) & 1 != 0, call.cpu.clock.now());
    OK
}

/// NR -> RET_VAL, CQ (runs), CV (hours). 8080 number, 8082 overflow: CV stays at 32767.
pub(super) fn read(call: &Call) -> Outcome {
    let Some(meter) = meter(call) else { return error(0x8080) };
    let hours = meter.elapsed(call.cpu.clock.now()) / NS_PER_HOUR;
    call.set_bool(2, meter.is_started.get());
    call.set_word(3, hours.min(HOURS_MAX) as u16);
    if hours > HOURS_MAX { error(0x8082) } else { OK }
}

/// NR, MODE, PV -> RET_VAL, CQ (runs), CV (hours). 8080 number, 8081 negative, 8082 overflow, 8091 mode, 80B1 no memory card for mode 7.
pub(super) fn handle(call: &Call) -> Outcome {
    let Some(meter) = meter(call) else { return error(0x8080) };
    let now = call.cpu.clock.now();
    let mode = call.byte(1);
    // 1 start, 2 stop, 4 set, 5 and 6 set as well.
    match mode {
        0..=2 => {}
        4..=6 => {
            let Ok(hours) = u64::try_from(call.dword(2) as i32) else { return error(0x8081) };
            meter.set(hours, now);
        }
        7 => return error(0x80B1),
        _ => return error(0x8091),
    }
    match mode & 3 {
        1 => meter.run(true, now),
        2 => meter.run(false, now),
        _ => {}
    }
    let hours = meter.elapsed(now) / NS_PER_HOUR;
    call.set_bool(4, meter.is_started.get());
    call.set_dword(5, hours.min(LONG_HOURS_MAX) as u32);
    if hours > LONG_HOURS_MAX { error(0x8082) } else { OK }
}
