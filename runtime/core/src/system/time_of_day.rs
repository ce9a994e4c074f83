//! Time-of-day interrupts: SFC 28 SET_TINT, SFC 29 CAN_TINT, SFC 30 ACT_TINT, SFC 31 QRY_TINT.

use super::parameters::Call;
use super::{OK, Outcome, error};
use crate::datetime::{self, NS_PER_S, Period};
use crate::schedule::TimeOfDay;

fn time_of_day<'a>(call: &'a Call) -> Option<&'a TimeOfDay> {
    call.cpu.schedule.time_of_day(call.word(0))
}

/// STATUS of SFC 31 and SFC 34: bit 0 in startup, 1 disabled, 2 active, 4 OB loaded.
pub(super) fn status(call: &Call, active: bool) -> u16 {
    let ob = call.word(0);
    u16::from(!call.cpu.schedule.in_run.get())
        | u16::from(call.cpu.schedule.is_disabled(ob)) << 1
        | u16::from(active) << 2
        | u16::from(call.cpu.has_ob(ob)) << 4
}

/// Last day of a month on which a monthly interrupt may begin: every month has it.
const MONTHLY_DAY_MAX: u8 = 28;

/// OB_NR, SDT, PERIOD: sets, without activating. Seconds and milliseconds of SDT are ignored. 8090 OB, 8091 SDT, also the days 29 to 31 with a
/// monthly PERIOD, 8092 PERIOD, 80A1 once only and in the past.
pub(super) fn set_tint(call: &Call) -> Outcome {
    let Some(time) = time_of_day(call) else { return error(0x8090) };
    let Ok(moment) = datetime::decode(call.date_and_time(1)) else { return error(0x8091) };
    let code = call.word(2);
    let Some(period) = Period::from_code(code) else { return error(0x8092) };
    if period == Period::Month && datetime::day(moment) > MONTHLY_DAY_MAX {
        return error(0x8091);
    }
    let start = moment - moment.rem_euclid(60 * NS_PER_S);
    if period == Period::Once && start < call.cpu.clock.wall() {
        return error(0x80A1);
    }
    time.set.set(true);
    time.active.set(false);
    time.start.set(start);
    time.period.set(period);
    time.period_code.set(code);
    call.cpu.rearm();
    OK
}

/// OB_NR: 8090 OB, 80A0 not set. One that waits to be run is gone, too.
pub(super) fn can_tint(call: &Call) -> Outcome {
    let Some(time) = time_of_day(call) else { return error(0x8090) };
    time.active.set(false);
    call.cpu.schedule.forget(time.ob);
    if !time.set.replace(false) {
        return error(0x80A0);
    }
    call.cpu.rearm();
    OK
}

/// OB_NR: 8090 OB, 80A0 not set, 80A1 in the past.
pub(super) fn act_tint(call: &Call) -> Outcome {
    let Some(time) = time_of_day(call) else { return error(0x8090) };
    if !time.set.get() {
        return error(0x80A0);
    }
    if call.cpu.activate_time_of_day(time) { OK } else { error(0x80A1) }
}

/// OB_NR -> RET_VAL, STATUS. 8090 OB.
pub(super) fn qry_tint(call: &Call) -> Outcome {
    let Some(time) = time_of_day(call) else {
        call.set_word(2, 0);
        return error(0x8090);
    };
    call.set_word(2, status(call, time.active.get()));
    OK
}
