//! SFC 6 RD_SINFO, SFC 25 COMPRESS, SFC 43 RE_TRIGR, SFC 44 REPL_VAL, SFC 46 STP, SFC 47 WAIT, SFC 48 SNC_RTCB,
//! SFC 52 WR_USMSG.

use plcc_abi::codes::stop;

use super::any::{self, Access};
use super::parameters::Call;
use super::{OK, Outcome, error};
use crate::diagnostics::Entry;

/// Start information of the running OB and of the last startup OB.
pub(super) fn rd_sinfo(call: &Call) -> Outcome {
    call.set_start_info(1, call.cpu.running.info.get());
    call.set_start_info(2, call.cpu.running.startup_info.get());
    OK
}

/// Restarts the cycle-time monitor.
pub(super) fn re_trigr(call: &Call) -> Outcome {
    call.cpu.schedule.monitor.restart(call.cpu.clock.now());
    call.cpu.arm_hang();
    call.cpu.rearm();
    Outcome::Plain
}

/// In OB 121 or OB 122: the value of the faulty read. 8080 elsewhere, 8081 after a write.
pub(super) fn repl_val(call: &Call) -> Outcome {
    match call.cpu.running.replaceable.get() {
        Some(true) => {
            call.cpu.running.substitute.set(call.dword(0));
            OK
        }
        Some(false) => error(0x8081),
        None => error(0x8080),
    }
}

pub(super) fn stp(call: &Call) -> Outcome {
    call.cpu.stop_by(stop::SFC_46, call.site, 0);
    Outcome::Plain
}

/// Waits WT microseconds; not at all when WT <= 0. Interrupts are served.
pub(super) fn wait(call: &Call) -> Outcome {
    let microseconds = call.word(0) as i16;
    if let Ok(microseconds) = u64::try_from(microseconds) {
        call.cpu.pass_time(microseconds * 1000, true);
    }
    Outcome::Plain
}

/// Memory is never fragmented. BUSY 0, DONE 1.
pub(super) fn compress(call: &Call) -> Outcome {
    call.set_bool(1, false);
    call.set_next_bool(2, true);
    OK
}

/// There are no slave clocks to be set.
pub(super) fn snc_rtcb(_call: &Call) -> Outcome {
    OK
}

/// SEND, EVENTN, INFO1, INFO2: an entry in the diagnostic buffer, of a class 8 to B. 8083 INFO1 and 8084 INFO2 cannot be read, 8085
/// EVENTN, 8086 and 8087 INFO1 is not a word, INFO2 is not a double word; 0091 there is no receiver.
pub(super) fn wr_usmsg(call: &Call) -> Outcome {
    let send = call.byte(0) & 1 != 0;
    let event = call.word(1);
    for (index, unreadable, length, bytes) in [(2, 0x8083, 0x8086, 2), (3, 0x8084, 0x8087, 4)] {
        match any::decode(call, index, Access::Read) {
            Ok(Some(range)) if range.existing < range.bytes => return error(unreadable),
            Ok(Some(range)) if range.bytes == bytes => {}
            Ok(_) => return error(length),
            Err(_) => return error(unreadable),
        }
    }
    if !(0x8000..0xC000).contains(&event) {
        return error(0x8085);
    }
    let info = any::decode(call, 3, Access::Read).ok().flatten().map_or(0, |range| call.cpu.memory.dword(range.offset));
    let (site, ob, wall) = (call.site, call.cpu.running.ob.get(), call.cpu.clock.wall());
    call.cpu.diagnostics.push(Entry { event, info, access: 0, site, ob, wall });
    if send { Outcome::RetVal(0x0091) } else { OK }
}
