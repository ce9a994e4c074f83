//! Disabling and delaying interrupts: SFC 39 DIS_IRT, SFC 40 EN_IRT, SFC 41 DIS_AIRT, SFC 42 EN_AIRT.

use super::parameters::Call;
use super::{OK, Outcome, error};

/// OBs that a call of SFC 39 or 40 means, first and last; `Err`: RET_VAL. MODE 0 (80: without diagnostic entry) all,
/// 1 (81) the class that OB_NR begins, 2 (82) one OB. 8090 OB_NR, 8091 MODE.
fn selection(call: &Call) -> Result<(u16, u16), u16> {
    let (mode, ob) = (call.byte(0), call.word(1));
    match mode & 0x7F {
        0 => Ok((10, 87)),
        1 => match ob {
            10 => Ok((10, 17)),
            20 => Ok((20, 23)),
            30 => Ok((30, 38)),
            40 => Ok((40, 47)),
            50 => Ok((50, 57)),
            60 => Ok((60, 64)),
            70 => Ok((70, 73)),
            80 => Ok((80, 87)),
            _ => Err(0x8090),
        },
        2 => match ob {
            10..=17 | 20..=23 | 30..=38 | 40..=47 | 50..=57 | 60..=64 | 70..=73 | 80..=87 => Ok((ob, ob)),
            _ => Err(0x8090),
        },
        _ => Err(0x8091),
    }
}

fn disable(call: &Call, disabled: bool) -> Outcome {
    match selection(call) {
        Ok((first, last)) => {
            (first..=last).for_each(|ob| {
                call.cpu.schedule.disabled.set(ob, disabled);
            });
            OK
        }
        Err(code) => error(code),
    }
}

/// Events of the selected OBs are lost from now on.
pub(super) fn dis_irt(call: &Call) -> Outcome {
    disable(call, true)
}

pub(super) fn en_irt(call: &Call) -> Outcome {
    disable(call, false)
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
