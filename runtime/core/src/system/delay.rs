//! Time-delay interrupts: SFC 32 SRT_DINT, SFC 33 CAN_DINT, SFC 34 QRY_DINT.

use super::parameters::Call;
use super::{OK, Outcome, error};
use crate::clock::NS_PER_MS;
use crate::schedule::{Delay, NEVER};

/// Longest delay.
const DELAY_MS_MAX: u32 = 60_000;

fn delay<'a>(call: &'a Call) -> Option<&'a Delay> {
    call.cpu.schedule.delay(call.word(0))
}

/// OB_NR, DTIME, SIGN. Starting again resets the time. 8090 OB, 8091 DTIME.
pub(super) fn srt_dint(call: &Call) -> Outcome {
    let (ms, sign) = (call.dword(1), call.word(2));
    let Some(delay) = delay(call) else { return error(0x8090) };
    if !(1..=DELAY_MS_MAX).contains(&ms) {
        return error(0x8091);
    }
    delay.delay_ms.set(ms);
    delay.sign.set(sign);
    delay.due.set(call.cpu.clock.now() + u64::from(ms) * NS_PER_MS);
    call.cpu.rearm();
    OK
}

/// OB_NR. 8090 OB, 80A0 not started.
pub(super) fn can_dint(call: &Call) -> Outcome {
    let Some(delay) = delay(call) else { return error(0x8090) };
    if delay.due.replace(NEVER) == NEVER {
        return error(0x80A0);
    }
    call.cpu.rearm();
    OK
}

/// OB_NR -> RET_VAL, STATUS. 8090 OB.
pub(super) fn qry_dint(call: &Call) -> Outcome {
    let Some(delay) = delay(call) else {
        call.set_word(2, 0);
        return error(0x8090);
    };
    call.set_word(2, super::time_of_day::status(call, delay.due.get() != NEVER));
    OK
}
