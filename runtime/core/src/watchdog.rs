//! The thread that raises the attention flag when something falls due while code runs.
//!
//! It touches one word of PLC memory and nothing else. Under the real clock the CPU sets a host time; when that has
//! passed, the thread raises the flag once, and the next safepoint finds out what is due. Deadlines usually move later:
//! then setting one is a store; the thread is only woken for an earlier one.
//!
//! Under the virtual clock only endless loops are of interest, and a cycle may take less time than reading the host's
//! clock. So each cycle is a *beat*, a store, and the thread looks now and then whether the last one is too long ago.

use std::cell::RefCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::memory::Memory;

/// No deadline.
const NEVER: u64 = u64::MAX;

struct Shared {
    origin: Instant,
    /// Nanoseconds since `origin`.
    deadline: AtomicU64,
    /// Until when the thread sleeps.
    wakes_at: AtomicU64,
    end: AtomicBool,
    /// Number of the last beat.
    beat: AtomicU64,
    /// Nanoseconds from one beat to the next that are too long; [`NEVER`]: beats do not count.
    beat_limit: AtomicU64,
    /// The beat that was too long ago.
    overdue: AtomicU64,
    /// Address of the attention flag.
    flag: AtomicUsize,
}

/// The thread, started with the first deadline.
pub struct Watchdog {
    shared: Arc<Shared>,
    thread: RefCell<Option<JoinHandle<()>>>,
}

impl Watchdog {
    /// Watches for the CPU with this memory; must be dropped before it.
    pub fn new(memory: &Memory) -> Watchdog {
        let flag = std::ptr::from_ref(memory.attention()).addr();
        std::ptr::from_ref(memory.attention()).expose_provenance();
        let shared = Shared {
            origin: Instant::now(),
            deadline: AtomicU64::new(NEVER),
            wakes_at: AtomicU64::new(NEVER),
            end: AtomicBool::new(false),
            beat: AtomicU64::new(0),
            beat_limit: AtomicU64::new(NEVER),
            overdue: AtomicU64::new(NEVER),
            flag: AtomicUsize::new(flag),
        };
        Watchdog { shared: Arc::new(shared), thread: RefCell::new(None) }
    }

    /// Host time, nanoseconds since the watchdog was made.
    pub fn host_now(&self) -> u64 {
        self.shared.origin.elapsed().as_nanos() as u64
    }

    /// Raises the flag at this host time, instead of at the time set before; `u64::MAX`: not at all.
    pub fn set(&self, deadline: u64) {
        self.shared.deadline.store(deadline, Ordering::SeqCst);
        if deadline < self.shared.wakes_at.load(Ordering::SeqCst) {
            self.wake();
        }
    }

    /// From now on beats count, and `limit` nanoseconds without one raise the flag; `u64::MAX`: they no longer count.
    pub fn watch_beats(&self, limit: u64) {
        self.beat();
        if self.shared.beat_limit.swap(limit, Ordering::SeqCst) != limit && limit != NEVER {
            self.wake();
        }
    }

    /// The program has come to its next cycle or event.
    #[inline]
    pub fn beat(&self) {
        let beat = &self.shared.beat;
        beat.store(beat.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
    }

    /// True if the last beat is too long ago.
    pub fn is_overdue(&self) -> bool {
        self.shared.overdue.load(Ordering::SeqCst) == self.shared.beat.load(Ordering::Relaxed)
    }

    /// Has the thread look at what is set. It is started with the first call.
    fn wake(&self) {
        let mut thread = self.thread.borrow_mut();
        match &*thread {
            Some(thread) => thread.thread().unpark(),
            None => {
                let shared = self.shared.clone();
                // Without the thread an endless loop is not found; nothing else depends on it.
                *thread = std::thread::Builder::new()
                    .name("watchdog".to_string())
                    .stack_size(64 << 10)
                    .spawn(move || watch(&shared))
                    .ok();
            }
        }
    }
}

/// The beat that the thread saw last, and when it first saw it.
struct Beats {
    last: u64,
    since: u64,
}

impl Beats {
    /// Looks at the beats. Result: whether the last one is newly overdue, and the host time of the next look.
    fn look(&mut self, shared: &Shared, now: u64) -> (bool, u64) {
        /// Looks within a limit: an endless loop is found after this part of the limit more.
        const LOOKS: u64 = 16;
        let limit = shared.beat_limit.load(Ordering::SeqCst);
        if limit == NEVER {
            self.since = now;
            return (false, NEVER);
        }
        let beat = shared.beat.load(Ordering::Relaxed);
        if beat != self.last {
            *self = Beats { last: beat, since: now };
        }
        let overdue = now - self.since >= limit && shared.overdue.swap(beat, Ordering::SeqCst) != beat;
        (overdue, now.saturating_add((limit / LOOKS).max(1_000_000)))
    }
}

fn watch(shared: &Shared) {
    crate::realtime::enter_watchdog();
    let mut beats = Beats { last: 0, since: 0 };
    while !shared.end.load(Ordering::SeqCst) {
        let deadline = shared.deadline.load(Ordering::SeqCst);
        let now = shared.origin.elapsed().as_nanos() as u64;
        let (overdue, next_look) = beats.look(shared, now);
        if overdue {
            raise(shared);
        }
        if deadline <= now {
            raise(shared);
            // Once only, unless a new deadline was set meanwhile.
            let _ = shared.deadline.compare_exchange(deadline, NEVER, Ordering::SeqCst, Ordering::SeqCst);
            continue;
        }
        let wakes_at = deadline.min(next_look);
        shared.wakes_at.store(wakes_at, Ordering::SeqCst);
        if shared.deadline.load(Ordering::SeqCst) < wakes_at {
            continue;
        }
        if wakes_at == NEVER {
            std::thread::park();
        } else {
            std::thread::park_timeout(Duration::from_nanos(wakes_at - now));
        }
    }
}

fn raise(shared: &Shared) {
    let flag = std::ptr::with_exposed_provenance_mut::<u32>(shared.flag.load(Ordering::SeqCst));
    // SAFETY: the flag is in the memory of the CPU, which outlives this thread (`Watchdog` joins it on drop);
    // it is aligned, and the runtime accesses it atomically only.
    unsafe { std::sync::atomic::AtomicU32::from_ptr(flag) }.store(1, Ordering::Relaxed);
}

impl Drop for Watchdog {
    fn drop(&mut self) {
        self.shared.end.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.borrow_mut().take() {
            thread.thread().unpark();
            let _ = thread.join();
        }
    }
}
