//! SFC 55 WR_PARM, 56 WR_DPARM, 57 PARM_MOD, 58 WR_REC, 59 RD_REC, 102 RD_DPARA; the runtime part of SFB 52 RDREC and SFB 53 WRREC.
//!
//! Source: System and standard functions, data records. The modules of a station have no data records.

use super::parameters::Call;
use super::{Outcome, error, hardware, station};

const NO_JOB: u16 = 0x7000;
const NO_MODULE: u16 = 0x8090;
const NO_RECORD: u16 = 0x80B0;

/// RET_VAL for a record of the module with this address.
fn answer(call: &Call, ioid: u8, address: u16) -> Outcome {
    error(if station::is_module(call.cpu, ioid, address.into()) { NO_RECORD } else { NO_MODULE })
}

/// REQ, IOID, LADDR, … -> RET_VAL, BUSY at `busy`.
fn with_request(call: &Call, busy: usize) -> Outcome {
    call.set_bool(busy, false);
    if call.byte(0) & 1 == 0 {
        return Outcome::RetVal(NO_JOB);
    }
    answer(call, call.byte(1), call.word(2))
}

/// REQ, IOID, LADDR -> RET_VAL, BUSY.
pub(super) fn parm_mod(call: &Call) -> Outcome {
    with_request(call, 4)
}

/// REQ, IOID, LADDR, RECNUM -> RET_VAL, BUSY.
pub(super) fn of_number(call: &Call) -> Outcome {
    with_request(call, 5)
}

/// REQ, IOID, LADDR, RECNUM, RECORD -> RET_VAL, BUSY.
pub(super) fn with_data(call: &Call) -> Outcome {
    with_request(call, 6)
}

/// LADDR, RECNUM -> RET_VAL, RECORD.
pub(super) fn rd_dpara(call: &Call) -> Outcome {
    let address = call.word(0);
    answer(call, if address & 0x8000 != 0 { station::OUTPUTS } else { station::INPUTS }, address & 0x7FFF)
}

/// ID -> RET_VAL: 8090 or 80B0.
pub(super) fn of_id(call: &Call) -> Outcome {
    let id = hardware::by_address(call, call.dword(0) as u16);
    let ioid = if id & 0x8000 != 0 { station::OUTPUTS } else { station::INPUTS };
    answer(call, ioid, id & 0x7FFF)
}
