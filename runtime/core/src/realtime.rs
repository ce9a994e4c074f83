//! `--realtime`: the process runs before all ordinary ones (SCHED_FIFO), and its memory stays in RAM.
//!
//! Both need a right. Without it there is an error that names the right: a plant that has asked for punctual cycles must not run without
//! noticing that it does not get them.

use std::io;

use rustix::mm::{MlockAllFlags, mlockall};
use rustix::process::{Resource, getrlimit};
use rustix::thread::{CapabilitySet, capabilities};

/// Priority of the cycle, from 1 to 99. Threads of the kernel that serve devices have 50.
const PRIORITY: libc::c_int = 40;

/// Priority of the watchdog, which must also run while code of the program does.
const WATCHDOG_PRIORITY: libc::c_int = PRIORITY + 1;

/// From now on this thread, and those that it starts, run under SCHED_FIFO, and all memory is locked, what is allocated later too.
///
/// Errors: the system does not permit it; the text names the missing rights.
pub fn enter() -> Result<(), String> {
    let missing: Vec<String> = [lock_memory(), schedule()].into_iter().filter_map(Result::err).collect();
    if missing.is_empty() {
        return Ok(());
    }
    Err(format!("{}; `setcap cap_sys_nice,cap_ipc_lock=ep FILE` gives an executable both rights", missing.join("; ")))
}

/// The watchdog's priority first: where that is permitted, both are.
fn schedule() -> Result<(), String> {
    set_priority(WATCHDOG_PRIORITY).and_then(|()| set_priority(PRIORITY)).map_err(|error| {
        format!(
            "the system refuses SCHED_FIFO ({error}): it needs the capability CAP_SYS_NICE or a limit of real-time priorities \
             (`ulimit -r`) of at least {WATCHDOG_PRIORITY}"
        )
    })
}

/// A limit that is enough now would fail an allocation later, so only the right to lock without limit counts.
fn lock_memory() -> Result<(), String> {
    let refused = |reason: &str| {
        format!(
            "the system refuses to lock memory ({reason}): it needs the capability CAP_IPC_LOCK or no limit of locked memory \
             (`ulimit -l unlimited`)"
        )
    };
    let capable = capabilities(None).is_ok_and(|sets| sets.effective.contains(CapabilitySet::IPC_LOCK));
    if let (false, Some(limit)) = (capable, getrlimit(Resource::Memlock).current) {
        return Err(refused(&format!("at most {} KB", limit / 1024)));
    }
    mlockall(MlockAllFlags::CURRENT | MlockAllFlags::FUTURE).map_err(|error| refused(&error.to_string()))
}

/// Has the calling thread, which raises the attention flag, interrupt the cycle; nothing unless the process runs under SCHED_FIFO.
pub(crate) fn enter_watchdog() {
    // SAFETY: the call takes a number alone.
    let policy = unsafe { libc::sched_getscheduler(0) };
    if policy == libc::SCHED_FIFO {
        // `enter` has had this priority, so it is permitted.
        let _ = set_priority(WATCHDOG_PRIORITY);
    }
}

fn set_priority(priority: libc::c_int) -> io::Result<()> {
    // SAFETY: the parameter is numbers, for which 0 is a value, and is only read during the call.
    let result = unsafe {
        let mut parameter: libc::sched_param = std::mem::zeroed();
        parameter.sched_priority = priority;
        libc::sched_setscheduler(0, libc::SCHED_FIFO, &raw const parameter)
    };
    if result == 0 { Ok(()) } else { Err(io::Error::last_os_error()) }
}
