//! DATE_AND_TIME in the library's functions FC 1, 3, 6 to 9, 12, 14, 18, 23, 28, 34 and 35.
//!
//! Source: STL reference, IEC function library.

use super::parameters::Call;
use super::{OK, Outcome, error};
use crate::datetime::{self, NS_PER_S};

const NS_PER_MS: i64 = 1_000_000;
const MS_PER_DAY: i64 = 86_400_000;
/// Seconds from 1970 to 1990-01-01, where DATE begins.
const FIRST_S: i64 = 631_152_000;
/// Seconds from 1970 to 2090-01-01, after the last DATE_AND_TIME.
const END_S: i64 = 3_786_912_000;
/// RET_VAL: the result was limited to the range of its type.
const LIMITED: u16 = 0x8001;
/// RET_VAL: no date or time.
const INVALID: u16 = 0x8002;

/// The nearest DATE_AND_TIME; true if it is another moment.
pub(super) fn encode(moment: i64) -> ([u8; 8], bool) {
    let inside = moment.clamp(FIRST_S * NS_PER_S, END_S * NS_PER_S - NS_PER_MS);
    (datetime::encode(inside), inside != moment)
}

fn give(call: &Call, index: usize, moment: i64) -> Outcome {
    let (bytes, limited) = encode(moment);
    call.set_date_and_time(index, bytes);
    if limited { error(LIMITED) } else { OK }
}

/// T, D in ms, BACK -> RET_VAL, OUT: T + D, or with BACK T - D.
pub(super) fn add(call: &Call) -> Outcome {
    let Ok(moment) = datetime::decode(call.date_and_time(0)) else {
        give(call, 4, i64::MIN);
        return error(INVALID);
    };
    let ms = i64::from(call.dword(1) as i32) * NS_PER_MS;
    give(call, 4, if call.byte(2) & 1 != 0 { moment - ms } else { moment + ms })
}

/// DT1, DT2 -> RET_VAL, OUT: DT1 - DT2 in ms.
pub(super) fn difference(call: &Call) -> Outcome {
    let (Ok(one), Ok(two)) = (datetime::decode(call.date_and_time(0)), datetime::decode(call.date_and_time(1))) else {
        call.set_dword(3, 0);
        return error(INVALID);
    };
    let ms = (one - two) / NS_PER_MS;
    let limited = ms.clamp(i32::MIN.into(), i32::MAX.into());
    call.set_dword(3, limited as i32 as u32);
    if limited == ms { OK } else { error(LIMITED) }
}

/// DATE, TIME_OF_DAY -> RET_VAL, OUT.
pub(super) fn combine(call: &Call) -> Outcome {
    let ms = i64::from(call.word(0)) * MS_PER_DAY + i64::from(call.dword(1));
    give(call, 3, FIRST_S * NS_PER_S + ms * NS_PER_MS)
}

/// DT -> RET_VAL, DATE, TIME_OF_DAY, weekday from 1 = Sunday.
pub(super) fn split(call: &Call) -> Outcome {
    let Ok(moment) = datetime::decode(call.date_and_time(0)) else {
        call.set_word(2, 0);
        call.set_dword(3, 0);
        call.set_word(4, 0);
        return error(INVALID);
    };
    let ms = (moment - FIRST_S * NS_PER_S) / NS_PER_MS;
    call.set_word(2, (ms / MS_PER_DAY) as u16);
    call.set_dword(3, (ms % MS_PER_DAY) as u32);
    call.set_word(4, u16::from(datetime::encode(moment)[7] & 0xF));
    OK
}

/// DT1, DT2 -> RET_VAL: 0 if DT1 is earlier, 1 if they are equal, 2 if it is later. Compares the digits without a check.
pub(super) fn compare(call: &Call) -> Outcome {
    let digits = |index| {
        let mut bytes = call.date_and_time(index);
        // Years 90 to 99 are before 00 to 89; the weekday does not count.
        bytes[0] = bytes[0].wrapping_sub(0x90);
        bytes[7] &= 0xF0;
        bytes
    };
    Outcome::RetVal((digits(0).cmp(&digits(1)) as i8 + 1) as u16)
}
