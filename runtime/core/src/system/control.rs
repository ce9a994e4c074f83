//! SFC 6 RD_SINFO, SFC 43 RE_TRIGR, SFC 44 REPL_VAL, SFC 46 STP, SFC 47 WAIT.

use plcc_abi::codes::stop;

use super::parameters::Call;
use super::{OK, Outcome, error};

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

/// In OB 121 or OB 122: the value that the faulty read gives. 8080 elsewhere, 8081 after a write.
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
