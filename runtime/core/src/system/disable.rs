//! Disabling and delaying interrupts: SFC 39 DIS_IRT, SFC 40 EN_IRT, SFC 41 DIS_AIRT, SFC 42 EN_AIRT.

use super::parameters::Call;
use super::{OK, Outcome, error};

/// OBs that a call of SFC 39 or 40 means, as bits by number; `Err`: RET_VAL. MODE 0 (80: without diagnostic entry) all,
/// 1 (81) the class that OB_NR begins, 2 (82) one OB. 8090 OB_NR, 8091 MODE.
fn selection(call: &Call) -> Result<u128, u16> {
    let (mode, ob) = (call.byte(0), call.word(1));
    let range = |from: u16, to: u16| (from..=to).fold(0u128, |bits, ob| bits | 1 << ob);
    match mode & 0x7F {
        0 => Ok(range(10, 87)),
        1 => match ob {
            10 => Ok(range(10, 17)),
            20 => Ok(range(20, 23)),
            30 => Ok(range(30, 38)),
            40 => Ok(range(40, 47)),
            50 => Ok(range(50, 57)),
            60 => Ok(range(60, 64)),
            70 => Ok(range(70, 73)),
            80 => Ok(range(80, 87)),
            _ => Err(0x8090),
        },
        2 => match ob {
            10..=17 | 20..=23 | 30..=38 | 40..=47 | 50..=57 | 60..=64 | 70..=73 | 80..=87 => Ok(1 << ob),
            _ => Err(0x8090),
        },
        _ => Err(0x8091),
    }
}

/// Events of the selected OBs are lost from now on.
pub(super) fn dis_irt(call: &Call) -> Outcome {
    let disabled = &call.cpu.schedule.disabled;
    match selection(call) {
        Ok(bits) => {
            disabled.set(disabled.get() | bits);
            OK
        }
        Err(code) => error(code),
    }
}

pub(super) fn en_irt(call: &Call) -> Outcome {
    let disabled = &call.cpu.schedule.disabled;
    match selection(call) {
        Ok(bits) => {
            disabled.set(disabled.get() & !bits);
            OK
        }
        Err(code) => error(code),
    }
}

/// Higher priority classes wait until SFC 42 was called as often, or the OB ends. RET_VAL: number of delays.
pub(super) fn dis_airt(call: &Call) -> Outcome {
    let delayed = &call.cpu.running.delayed;
    delayed.set((delayed.get() + 1).min(0x7FFF));
    Outcome::RetVal(delayed.get())
}

/// RET_VAL: delays that are left. 8080: nothing was delayed.
pub(super) fn en_airt(call: &Call) -> Outcome {
    let delayed = &call.cpu.running.delayed;
    match delayed.get() {
        0 => error(0x8080),
        count => {
            delayed.set(count - 1);
            call.cpu.dispatch();
            Outcome::RetVal(count - 1)
        }
    }
}
