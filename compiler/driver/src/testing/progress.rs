//! How far a long test run is, on a terminal.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Shorter runs show nothing.
const QUIET: Duration = Duration::from_secs(1);

/// Time between two lines.
const STEP: Duration = Duration::from_millis(100);

/// A line on standard error that is written again and again.
pub struct Progress {
    total: usize,
    shown: bool,
    state: Mutex<State>,
}

struct State {
    done: usize,
    next: Instant,
    written: bool,
}

impl Progress {
    /// For so many tests. Nothing is written where standard error is not a terminal.
    pub fn new(total: usize) -> Progress {
        let state = State { done: 0, next: Instant::now() + QUIET, written: false };
        Progress { total, shown: std::io::stderr().is_terminal(), state: Mutex::new(state) }
    }

    /// One more test has run.
    pub fn step(&self, name: &str) {
        let Ok(mut state) = self.state.lock() else { return };
        state.done += 1;
        if self.shown && Instant::now() >= state.next {
            let line = line(state.done, self.total, name);
            let _ = write!(std::io::stderr(), "\r\x1B[K{line}");
            state.next = Instant::now() + STEP;
            state.written = true;
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if self.state.lock().is_ok_and(|state| state.written) {
            let _ = write!(std::io::stderr(), "\r\x1B[K");
        }
    }
}

/// `12 of 300 (4 %): name`, in one line of a terminal.
fn line(done: usize, total: usize, name: &str) -> String {
    let percent = done * 100 / total.max(1);
    let text: String = name.chars().filter(|c| !c.is_control()).collect();
    let tail: String = text.chars().skip(text.chars().count().saturating_sub(50)).collect();
    format!("{done} of {total} ({percent} %): {tail}")
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_line_fits_on_a_terminal() {
        assert_eq!(super::line(3, 12, "tests/a.stl"), "3 of 12 (25 %): tests/a.stl");
        assert!(super::line(1, 1, &"x/".repeat(200)).len() < 80);
        assert!(!super::line(1, 1, "a\u{1B}[2J\nb").contains(['\u{1B}', '\n']));
    }
}
