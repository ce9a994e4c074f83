//! RCV: a message between its start and its end condition. Source: S7-200 system manual, Receive instruction.
//!
//! ```text
//!          RCV ──► Searching ── 1 ──► Starting ── 3 ──► Receiving ── 4 ──► ended
//!                      │  ▲              │                  ▲
//!                      │  └────── 2 ─────┘                  │
//!                      └──────────────── 1 ─────────────────┘
//! ```
//!
//! 1. The line was idle for its time, or a break came: the start character must follow, if one is set.
//! 2. Another character than the start character came: the search begins again.
//! 3. The start character came; it is the first one of the message.
//! 4. End character, number of characters, timer, or a faulty character.
//!
//! With a start character alone it begins in *Starting* and stays there. Idle times are measured from the end of one character to the
//! end of the next, as the CPU does: the manual requires idle times above that of a character.

const NS_PER_MS: u64 = 1_000_000;

/// Bits of SMB86.
pub mod status {
    pub const ABORTED: u8 = 0x80;
    pub const PARAMETER: u8 = 0x40;
    pub const END_CHARACTER: u8 = 0x20;
    pub const TIMER: u8 = 0x04;
    pub const COUNT: u8 = 0x02;
    pub const FAULTY: u8 = 0x01;
}

/// Bits of SMB87.
pub mod control {
    pub const ENABLE: u8 = 0x80;
    pub const START_CHARACTER: u8 = 0x40;
    pub const END_CHARACTER: u8 = 0x20;
    pub const IDLE_LINE: u8 = 0x10;
    pub const MESSAGE_TIMER: u8 = 0x08;
    pub const TIMER: u8 = 0x04;
    pub const BREAK: u8 = 0x02;
}

/// Conditions that begin and end a message; times in nanoseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Criteria {
    pub idle_line: Option<u64>,
    pub on_break: bool,
    pub start_character: Option<u8>,
    pub end_character: Option<u8>,
    /// Longest time from the end of one character to the end of the next.
    pub character_timer: Option<u64>,
    /// Longest time from the start condition on.
    pub message_timer: Option<u64>,
    pub most: u8,
}

impl Criteria {
    /// From SMB87 to SMB94. `None`: no start condition, or no number of characters.
    pub fn of(control: u8, start: u8, end: u8, idle_ms: u16, timer_ms: u16, most: u8) -> Option<Criteria> {
        let has = |bit: u8| control & bit != 0;
        // A timer of 0 ms would end messages before they begin.
        let timer = has(control::TIMER).then(|| u64::from(timer_ms.max(1)) * NS_PER_MS);
        let criteria = Criteria {
            idle_line: has(control::IDLE_LINE).then(|| u64::from(idle_ms) * NS_PER_MS),
            on_break: has(control::BREAK),
            start_character: has(control::START_CHARACTER).then_some(start),
            end_character: has(control::END_CHARACTER).then_some(end),
            character_timer: timer.filter(|_| !has(control::MESSAGE_TIMER)),
            message_timer: timer.filter(|_| has(control::MESSAGE_TIMER)),
            most,
        };
        let starts = criteria.searches() || criteria.start_character.is_some();
        (starts && most > 0).then_some(criteria)
    }

    /// Something must come before the first character.
    fn searches(&self) -> bool {
        self.idle_line.is_some() || self.on_break
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// For an idle line or a break; the line is idle since then.
    Searching {
        since: u64,
    },
    /// For the start character.
    Starting,
    Receiving {
        began: u64,
        last: Option<u64>,
    },
}

/// The effect of a character or a moment on the message.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Step {
    /// It belongs to the message, as its character of this number, from 1 on.
    pub stored: Option<u8>,
    /// The message ends: the bits of SMB86; else 0.
    pub ended: u8,
}

/// An active RCV.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    criteria: Criteria,
    phase: Phase,
    count: u8,
}

impl Receiver {
    pub fn begin(criteria: Criteria, now: u64) -> Receiver {
        let phase = if criteria.searches() { Phase::Searching { since: now } } else { Phase::Starting };
        let mut receiver = Receiver { criteria, phase, count: 0 };
        receiver.look_at_line(now);
        receiver
    }

    /// When time alone changes something.
    pub fn due(&self) -> Option<u64> {
        match self.phase {
            Phase::Searching { since } => self.criteria.idle_line.map(|idle| since.saturating_add(idle)),
            Phase::Starting => None,
            Phase::Receiving { began, last } => {
                let message = self.criteria.message_timer.map(|time| began.saturating_add(time));
                let characters = self.criteria.character_timer.zip(last).map(|(time, last)| last.saturating_add(time));
                message.into_iter().chain(characters).min()
            }
        }
    }

    /// It is `now`.
    pub fn time(&mut self, now: u64) -> Step {
        if self.due().is_none_or(|due| now < due) {
            return Step::default();
        }
        match self.phase {
            Phase::Searching { .. } => {
                self.look_at_line(now);
                Step::default()
            }
            Phase::Starting => Step::default(),
            Phase::Receiving { .. } => Step { stored: None, ended: status::TIMER },
        }
    }

    /// A character has ended at `at`; `faulty`: parity, framing or overrun.
    pub fn character(&mut self, byte: u8, faulty: bool, at: u64) -> Step {
        match self.phase {
            Phase::Searching { .. } => {
                self.search(at);
                Step::default()
            }
            Phase::Starting if !faulty && self.criteria.start_character == Some(byte) => {
                self.phase = Phase::Receiving { began: at, last: Some(at) };
                self.store(0)
            }
            Phase::Starting => {
                if self.criteria.searches() {
                    self.search(at);
                }
                Step::default()
            }
            Phase::Receiving { .. } if faulty => Step { stored: None, ended: status::FAULTY },
            Phase::Receiving { began, .. } => {
                self.phase = Phase::Receiving { began, last: Some(at) };
                let ends = self.criteria.end_character == Some(byte);
                self.store(if ends { status::END_CHARACTER } else { 0 })
            }
        }
    }

    /// A break has ended at `at`. Inside a message it looks like a faulty character.
    pub fn line_break(&mut self, at: u64) -> Step {
        match self.phase {
            Phase::Receiving { .. } if self.count > 0 || !self.criteria.on_break => {
                return Step { stored: None, ended: status::FAULTY };
            }
            Phase::Receiving { .. } => self.phase = Phase::Receiving { began: at, last: None },
            Phase::Searching { .. } | Phase::Starting if self.criteria.on_break => self.found(at),
            Phase::Searching { .. } => self.search(at),
            Phase::Starting if self.criteria.searches() => self.search(at),
            Phase::Starting => {}
        }
        Step::default()
    }

    fn search(&mut self, at: u64) {
        self.phase = Phase::Searching { since: at };
        self.look_at_line(at);
    }

    fn look_at_line(&mut self, now: u64) {
        if let (Phase::Searching { since }, Some(idle)) = (self.phase, self.criteria.idle_line)
            && now >= since.saturating_add(idle)
        {
            self.found(now);
        }
    }

    /// The condition before the first character is true.
    fn found(&mut self, at: u64) {
        self.phase = match self.criteria.start_character {
            Some(_) => Phase::Starting,
            None => Phase::Receiving { began: at, last: None },
        };
    }

    fn store(&mut self, ended: u8) -> Step {
        self.count = self.count.saturating_add(1);
        let full = if self.count >= self.criteria.most { status::COUNT } else { 0 };
        Step { stored: Some(self.count), ended: ended | full }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = NS_PER_MS;
    const GOES_ON: Step = Step { stored: None, ended: 0 };

    fn stored(count: u8) -> Step {
        Step { stored: Some(count), ended: 0 }
    }

    fn ended(count: u8, ended: u8) -> Step {
        Step { stored: Some(count), ended }
    }

    /// `:` is the start character, `\r` the end character, 5 ms the idle time, 20 ms the timer.
    fn begin(control: u8, most: u8) -> Receiver {
        Receiver::begin(Criteria::of(control, b':', b'\r', 5, 20, most).expect("conditions are there"), 0)
    }

    /// Feeds a character each ms, from `from` ms on.
    fn feed(receiver: &mut Receiver, text: &[u8], from: u64) -> Vec<Step> {
        let steps = (from..).zip(text);
        steps
            .map(|(ms, &byte)| {
                assert_eq!(receiver.time(ms * MS), GOES_ON);
                receiver.character(byte, false, ms * MS)
            })
            .collect()
    }

    #[test]
    fn conditions_must_be_there() {
        let of = |control: u8, most: u8| Criteria::of(control, 0, 0, 0, 0, most);
        assert_eq!(of(0x80, 10), None, "no start condition");
        assert_eq!(of(0xA4, 10), None, "end conditions alone");
        assert_eq!(of(0xC0, 0), None, "no number of characters");
        assert!(of(0xC0, 1).is_some() && of(0x90, 1).is_some() && of(0x82, 1).is_some());
    }

    #[test]
    fn start_character_and_end_character() {
        let mut receiver = begin(0xE0, 100);
        assert_eq!(feed(&mut receiver, b"xy\r:A", 1), [GOES_ON, GOES_ON, GOES_ON, stored(1), stored(2)]);
        assert_eq!(feed(&mut receiver, b":\r", 6), [stored(3), ended(4, status::END_CHARACTER)]);
    }

    #[test]
    fn start_character_is_no_end_character() {
        let criteria = Criteria::of(0xE0, b'~', b'~', 0, 0, 9).unwrap();
        let mut receiver = Receiver::begin(criteria, 0);
        assert_eq!(receiver.character(b'~', false, MS), stored(1));
        assert_eq!(receiver.character(b'~', false, 2 * MS), ended(2, status::END_CHARACTER));
    }

    #[test]
    fn number_of_characters() {
        assert_eq!(feed(&mut begin(0xC0, 2), b":A", 1), [stored(1), ended(2, status::COUNT)]);
        assert_eq!(feed(&mut begin(0xC0, 1), b":", 1), [ended(1, status::COUNT)]);
        let both = status::COUNT | status::END_CHARACTER;
        assert_eq!(feed(&mut begin(0xE0, 2), b":\r", 1), [stored(1), ended(2, both)]);
    }

    #[test]
    fn idle_line() {
        let mut receiver = begin(0x90, 3);
        assert_eq!(receiver.due(), Some(5 * MS));
        // Each character before it is over begins it again.
        assert_eq!(feed(&mut receiver, b"ab", 3), [GOES_ON, GOES_ON]);
        assert_eq!(receiver.due(), Some(9 * MS));
        assert_eq!(receiver.time(9 * MS), GOES_ON);
        assert_eq!(feed(&mut receiver, b"cde", 30), [stored(1), stored(2), ended(3, status::COUNT)]);
    }

    #[test]
    fn any_character() {
        let criteria = Criteria::of(0xB0, 0, b'\r', 0, 0, 9).unwrap();
        let mut receiver = Receiver::begin(criteria, 0);
        assert_eq!(receiver.character(b'\r', false, 1), ended(1, status::END_CHARACTER));
    }

    #[test]
    fn idle_line_and_start_character() {
        let mut receiver = begin(0xD0, 9);
        assert_eq!(feed(&mut receiver, b":", 1), [GOES_ON], "the line was not idle");
        assert_eq!(receiver.time(6 * MS), GOES_ON);
        assert_eq!(feed(&mut receiver, b"x:", 7), [GOES_ON, GOES_ON], "x makes it search again");
        assert_eq!(receiver.time(13 * MS), GOES_ON);
        assert_eq!(feed(&mut receiver, b":A", 50), [stored(1), stored(2)]);
    }

    #[test]
    fn break_alone() {
        let mut receiver = begin(0x82, 2);
        assert_eq!(feed(&mut receiver, b"ab", 1), [GOES_ON, GOES_ON]);
        assert_eq!((receiver.due(), receiver.line_break(4 * MS)), (None, GOES_ON));
        assert_eq!(receiver.line_break(6 * MS), GOES_ON, "a second break is still the beginning");
        assert_eq!(feed(&mut receiver, b"cd", 7), [stored(1), ended(2, status::COUNT)]);
    }

    #[test]
    fn break_and_start_character() {
        let mut receiver = begin(0xC2, 9);
        assert_eq!(feed(&mut receiver, b":", 1), [GOES_ON]);
        assert_eq!(receiver.line_break(3 * MS), GOES_ON);
        assert_eq!(feed(&mut receiver, b"x:", 4), [GOES_ON, GOES_ON], "x makes it search again");
        assert_eq!(receiver.line_break(7 * MS), GOES_ON);
        assert_eq!(feed(&mut receiver, b":A", 8), [stored(1), stored(2)]);
        assert_eq!(receiver.line_break(11 * MS), Step { stored: None, ended: status::FAULTY }, "inside a message");
    }

    #[test]
    fn idle_line_or_break() {
        let mut by_break = begin(0x92, 1);
        assert_eq!(by_break.line_break(MS), GOES_ON);
        assert_eq!(feed(&mut by_break, b"a", 2), [ended(1, status::COUNT)]);
        let mut by_idle = begin(0x92, 1);
        assert_eq!(by_idle.time(5 * MS), GOES_ON);
        assert_eq!(feed(&mut by_idle, b"a", 7), [ended(1, status::COUNT)]);
    }

    #[test]
    fn timer_between_characters() {
        let mut receiver = begin(0xC4, 9);
        assert_eq!(receiver.due(), None, "not before the message");
        assert_eq!(feed(&mut receiver, b":A", 100), [stored(1), stored(2)]);
        assert_eq!(feed(&mut receiver, b"B", 120), [stored(3)]);
        assert_eq!((receiver.due(), receiver.time(139 * MS)), (Some(140 * MS), GOES_ON));
        assert_eq!(receiver.time(140 * MS), Step { stored: None, ended: status::TIMER });
    }

    #[test]
    fn timer_of_the_message() {
        let mut receiver = begin(0xCC, 200);
        assert_eq!(feed(&mut receiver, b":", 100), [stored(1)]);
        assert_eq!(feed(&mut receiver, b"A", 119), [stored(2)]);
        assert_eq!(receiver.time(120 * MS), Step { stored: None, ended: status::TIMER });
        // With any character as start it runs from RCV on: an answer that does not come.
        let criteria = Criteria::of(0x9C, 0, 0, 0, 20, 9).unwrap();
        let mut receiver = Receiver::begin(criteria, 7 * MS);
        assert_eq!(receiver.due(), Some(27 * MS));
        assert_eq!(receiver.time(27 * MS), Step { stored: None, ended: status::TIMER });
    }

    #[test]
    fn faulty_characters() {
        let mut receiver = begin(0xC0, 9);
        assert_eq!(receiver.character(b':', true, MS), GOES_ON, "a faulty character starts nothing");
        assert_eq!(receiver.character(b':', false, 2 * MS), stored(1));
        assert_eq!(receiver.character(b'A', true, 3 * MS), Step { stored: None, ended: status::FAULTY });
    }
}
