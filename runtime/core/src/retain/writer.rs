//! The thread that brings copies to the disk.
//!
//! With an interval it writes whole copies. If each cycle counts, the cycle gives its copy to the system, which keeps it when the process is
//! killed, and the thread has the system bring it to the disk, for the case that the computer fails.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use plcc_abi::image::RetainInterval;

use super::late::LateFile;

/// From one time to the next at which copies of each cycle are brought to the disk.
const DISK_PAUSE: Duration = Duration::from_millis(100);

/// What the cycle and the thread share.
struct State {
    /// `None` while the thread works with it.
    file: Option<LateFile>,
    /// The copy to be written, and room for the next one.
    copy: Vec<u8>,
    pending: bool,
    /// Something was given to the system and is not yet on the disk.
    unsettled: bool,
    end: bool,
    /// How the last copy fared, until it is asked for.
    outcome: Option<std::io::Result<()>>,
}

struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// See the module comment.
pub(super) struct Writer {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    each_cycle: bool,
}

impl Writer {
    pub(super) fn new(file: LateFile, interval: RetainInterval) -> Writer {
        let state =
            State { file: Some(file), copy: Vec::new(), pending: false, unsettled: false, end: false, outcome: None };
        let shared = Arc::new(Shared { state: Mutex::new(state), changed: Condvar::new() });
        Writer { shared, thread: None, each_cycle: interval == RetainInterval::Cycle }
    }

    /// A copy is still being written.
    pub(super) fn is_busy(&self) -> bool {
        !self.each_cycle && self.shared.state.try_lock().map_or(true, |state| state.pending || state.file.is_none())
    }

    /// How the last copy fared; `None`: nothing new.
    pub(super) fn outcome(&self) -> Option<std::io::Result<()>> {
        self.shared.state.try_lock().ok()?.outcome.take()
    }

    /// Takes over a copy.
    pub(super) fn write(&mut self, content: &[u8]) {
        let mut state = self.shared.state();
        if let (true, Some(file)) = (self.each_cycle, &mut state.file) {
            let written = file.write(content);
            state.unsettled |= written.is_ok();
            state.outcome = Some(written);
        } else {
            state.copy.clear();
            state.copy.extend(content);
            state.pending = true;
        }
        drop(state);
        self.shared.changed.notify_one();
        if self.thread.is_none() {
            let shared = self.shared.clone();
            let each_cycle = self.each_cycle;
            let thread = std::thread::Builder::new().name("retain".to_string()).stack_size(128 << 10);
            match thread.spawn(move || if each_cycle { settle(&shared) } else { write_copies(&shared) }) {
                Ok(thread) => self.thread = Some(thread),
                Err(error) => self.shared.state().outcome = Some(Err(error)),
            }
        }
    }

    /// Waits until the last copy is on the disk.
    pub(super) fn finish(&mut self) -> Option<std::io::Result<()>> {
        self.shared.state().end = true;
        self.shared.changed.notify_one();
        if let Some(thread) = self.thread.take() {
            // A panic there has said so itself.
            let _ = thread.join();
        }
        let mut state = self.shared.state();
        state.end = false;
        state.outcome.take()
    }
}

/// Writes each copy, and ends after the last one.
fn write_copies(shared: &Shared) {
    let mut state = shared.state();
    let mut copy = Vec::new();
    loop {
        while !state.pending && !state.end {
            state = shared.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        if !state.pending {
            return;
        }
        let Some(mut file) = state.file.take() else { return };
        std::mem::swap(&mut copy, &mut state.copy);
        state.pending = false;
        drop(state);
        let outcome = file.write(&copy).and_then(|()| file.disk()?.sync_data());
        state = shared.state();
        state.file = Some(file);
        state.outcome = Some(outcome);
    }
}

/// Has the system bring to the disk what the cycles gave it.
fn settle(shared: &Shared) {
    let mut state = shared.state();
    loop {
        while !state.unsettled && !state.end {
            state = shared.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        let end = state.end;
        if let Some(disk) = state.file.as_ref().filter(|_| state.unsettled).map(LateFile::disk) {
            state.unsettled = false;
            drop(state);
            let outcome = disk.and_then(|disk| disk.sync_data());
            state = shared.state();
            if let Err(error) = outcome {
                state.outcome = Some(Err(error));
            }
        }
        if end && !state.unsettled {
            return;
        }
        // Not for each copy; the end is not late for it.
        let pause = shared.changed.wait_timeout_while(state, DISK_PAUSE, |state| !state.end);
        state = pause.unwrap_or_else(PoisonError::into_inner).0;
    }
}
