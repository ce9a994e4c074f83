//! Run-time meters: SFC 2 SET_RTM, SFC 3 CTRL_RTM, SFC 4 READ_RTM, which count full hours from 0 to 32767; SFC 101 RTM with 32 bits.
//!
//! Source: System and standard functions, SFC 2 to 4. Assumption: eight meters, as on most CPUs; see the data sheet.

use std::cell::Cell;

use super::parameters::Call;
use super::{OK, Outcome, error};

/// Meters of a CPU, numbers 0 to 7.
pub(crate) const METERS: usize = 8;

const NS_PER_HOUR: u64 = 3_600_000_000_000;
const HOURS_MAX: u64 = 0x7FFF;

/// A run-time meter.
#[derive(Default)]
pub(crate) struct Meter {
    /// Counted when it was last started or stopped.
    counted_ns: Cell<u64>,
    /// Since when it runs.
    since: Cell<Option<u64>>,
}

impl Meter {
    fn elapsed(&self, now: u64) -> u64 {
        let running = self.since.get().map_or(0, |since| now.saturating_sub(since));
        self.counted_ns.get().saturating_add(running)
    }
}

fn meter<'a>(call: &'a Call) -> Option<&'a Meter> {
    call.cpu.meters.get(usize::from(call.byte(0)))
}

/// NR, PV: sets the hours; a running one continues from there. 8080 number, 8081 negative.
pub(super) fn set(call: &Call) -> Outcome {
    let Some(meter) = meter(call) else { return error(0x8080) };
    let Ok(hours) = u64::try_from(call.word(1) as i16) else { return error(0x8081) };
    meter.counted_ns.set(hours * NS_PER_HOUR);
    meter.since.set(meter.since.get().map(|_| call.cpu.clock.now()));
    OK
}

/// NR, S: starts or stops. 8080 number.
pub(super) fn control(call: &Call) -> Outcome {
    let Some(meter) = meter(call) else { return error(0x8080) };
    let now = call.cpu.clock.now();
    let start = call.byte(1) & 1 != 0;
    if start != meter.since.get().is_some() {
        meter.counted_ns.set(meter.elapsed(now));
        meter.since.set(start.then_some(now));
    }
    OK
}

/// NR, MODE (0 read, 1 start, 2 stop, 4 set, 5 set and start, 6 set and stop), PV -> RET_VAL, CQ, CV. 8080 number, 8081 negative, 8083 MODE.
pub(super) fn rtm(call: &Call) -> Outcome {
    call.set_bool(4, false);
    call.set_dword(5, 0);
    let Some(meter) = meter(call) else { return error(0x8080) };
    let (mode, now) = (call.byte(1), call.cpu.clock.now());
    if matches!(mode, 3 | 7..) {
        return error(0x8083);
    }
    if mode & 4 != 0 {
        let Ok(hours) = u64::try_from(call.dword(2) as i32) else { return error(0x8081) };
        meter.counted_ns.set(hours * NS_PER_HOUR);
        meter.since.set(meter.since.get().map(|_| now));
    }
    let runs = match mode & 3 {
        1 => true,
        2 => false,
        _ => meter.since.get().is_some(),
    };
    meter.counted_ns.set(meter.elapsed(now));
    meter.since.set(runs.then_some(now));
    let hours = meter.elapsed(now) / NS_PER_HOUR;
    call.set_bool(4, runs);
    call.set_dword(5, u32::try_from(hours).unwrap_or(u32::MAX).min(i32::MAX as u32));
    OK
}

/// NR -> RET_VAL, CQ (runs), CV (hours). 8080 number, 8082 overflow: CV stays at 32767.
pub(super) fn read(call: &Call) -> Outcome {
    let Some(meter) = meter(call) else { return error(0x8080) };
    let hours = meter.elapsed(call.cpu.clock.now()) / NS_PER_HOUR;
    call.set_bool(2, meter.since.get().is_some());
    call.set_word(3, hours.min(HOURS_MAX) as u16);
    if hours > HOURS_MAX { error(0x8082) } else { OK }
}
