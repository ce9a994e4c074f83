//! The thread that raises the attention flag when something falls due while code runs.
//!
//! It touches one word of PLC memory and nothing else. The CPU sets a host time; when that has passed, it raises the
//! flag once, and the next safepoint finds out what is due. Deadlines usually move later: then setting one is a store;
//! the thread is only woken for an earlier one.

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
}

fn watch(shared: &Shared) {
    while !shared.end.load(Ordering::SeqCst) {
        let deadline = shared.deadline.load(Ordering::SeqCst);
        let now = shared.origin.elapsed().as_nanos() as u64;
        if deadline <= now {
            let flag = std::ptr::with_exposed_provenance_mut::<u32>(shared.flag.load(Ordering::SeqCst));
            // SAFETY: the flag is in the memory of the CPU, which outlives this thread (`Watchdog` joins it on drop);
            // it is aligned, and the runtime accesses it atomically only.
            unsafe { std::sync::atomic::AtomicU32::from_ptr(flag) }.store(1, Ordering::Relaxed);
            // Once only, unless a new deadline was set meanwhile.
            let _ = shared.deadline.compare_exchange(deadline, NEVER, Ordering::SeqCst, Ordering::SeqCst);
            continue;
        }
        shared.wakes_at.store(deadline, Ordering::SeqCst);
        if shared.deadline.load(Ordering::SeqCst) < deadline {
            continue;
        }
        if deadline == NEVER {
            std::thread::park();
        } else {
            std::thread::park_timeout(Duration::from_nanos(deadline - now));
        }
    }
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
