//! SFC 9 EN_MSG, 10 DIS_MSG, 17 ALARM_SQ, 18 ALARM_S, 19 ALARM_SC, 107 ALARM_DQ, 108 ALARM_D; Gen_UsrMsg; the runtime part of the SFBs
//! ALARM … NOTIFY_8P and of Program_Alarm.
//!
//! Source: System and standard functions, block-related messages; TIA Portal help, alarms.

use super::any::{self, Access};
use super::parameters::Call;
use super::{OK, Outcome, error};
use crate::alarms::Report;
use crate::diagnostics::{Entry, USER_CAME, USER_WENT};

/// Associated values that a message carries.
const VALUES_MAX: u32 = 12;

/// SIG, ID, EV_ID, SD. 0001 SD is too long and was cut; 8081 EV_ID is 0; 8082 no more alarms; 8083 SD cannot be read.
fn alarm(call: &Call, sd: usize, to_acknowledge: bool) -> Outcome {
    let number = call.dword(2);
    if number == 0 {
        return error(0x8081);
    }
    let (values, cut) = match any::decode(call, sd, Access::Read) {
        Ok(None) => (Vec::new(), false),
        Ok(Some(range)) if range.existing == range.bytes => {
            let bytes = range.bytes.min(VALUES_MAX);
            (call.cpu.memory.view(range.offset, bytes, <[u8]>::to_vec), range.bytes > VALUES_MAX)
        }
        Ok(Some(_)) | Err(_) => return error(0x8083),
    };
    let signal = call.byte(0) & 1 != 0;
    let report = Report { number, place: 0, signal, to_acknowledge, values: &values, site: call.site };
    match call.cpu.report_alarm(&report) {
        true => Outcome::RetVal(u16::from(cut)),
        false => error(0x8082),
    }
}

pub(super) fn alarm_sq(call: &Call) -> Outcome {
    alarm(call, 3, true)
}

pub(super) fn alarm_s(call: &Call) -> Outcome {
    alarm(call, 3, false)
}

/// As [`alarm_sq`], with CMP_ID before SD.
pub(super) fn alarm_dq(call: &Call) -> Outcome {
    alarm(call, 4, true)
}

/// As [`alarm_s`], with CMP_ID before SD.
pub(super) fn alarm_d(call: &Call) -> Outcome {
    alarm(call, 4, false)
}

/// EV_ID -> RET_VAL, STATE, Q_STATE. 8082: there was no event of this alarm.
pub(super) fn alarm_sc(call: &Call) -> Outcome {
    let state = call.cpu.alarms.borrow().state(call.dword(0));
    let (signal, acknowledged) = state.unwrap_or_default();
    call.set_bool(2, signal);
    call.set_next_bool(3, acknowledged);
    if state.is_some() { OK } else { error(0x8082) }
}

/// REQ, MODE, MESGN -> RET_VAL, BUSY. 7000 without REQ; 8082 MODE, 8083 MESGN is 0.
fn enable(call: &Call, enabled: bool) -> Outcome {
    call.set_bool(4, false);
    if call.byte(0) & 1 == 0 {
        return Outcome::RetVal(0x7000);
    }
    match (call.byte(1), call.dword(2)) {
        (0 | 2, _) => call.cpu.alarms.borrow_mut().enable(None, enabled),
        // Messages of symbols and group status messages, which do not exist.
        (1 | 3 | 4, _) => {}
        (5, 0) => return error(0x8083),
        (5, number) => call.cpu.alarms.borrow_mut().enable(Some(number), enabled),
        (6.., _) => return error(0x8082),
    }
    OK
}

pub(super) fn en_msg(call: &Call) -> Outcome {
    enable(call, true)
}

pub(super) fn dis_msg(call: &Call) -> Outcome {
    enable(call, false)
}

/// NUMBER, PLACE, SIG, ACK -> RET_VAL: 0, or 8082 too many alarms.
pub(super) fn alarm_edge(call: &Call) -> Outcome {
    let report = Report {
        number: call.dword(0),
        place: call.byte(1),
        signal: call.byte(2) & 1 != 0,
        to_acknowledge: call.byte(2) & 2 != 0,
        values: &[],
        site: call.site,
    };
    if call.cpu.report_alarm(&report) { OK } else { error(0x8082) }
}

/// -> RET_VAL: a number that no other alarm has.
pub(super) fn alarm_number(call: &Call) -> Outcome {
    call.set_dword(0, call.cpu.alarms.borrow_mut().own_number());
    Outcome::Plain
}

/// MODE (1 came, 2 went), TextID, TextListID, AssocValues -> RET_VAL. 8080 MODE.
pub(super) fn gen_user_message(call: &Call) -> Outcome {
    let event = match call.word(0) {
        1 => USER_CAME,
        2 => USER_WENT,
        _ => return error(0x8080),
    };
    let info = u32::from(call.word(2)) << 16 | u32::from(call.word(1));
    let (site, ob, wall) = (call.site, call.cpu.running.ob.get(), call.cpu.clock.wall());
    call.cpu.diagnostics.push(Entry { event, info, access: 0, site, ob, wall });
    OK
}
