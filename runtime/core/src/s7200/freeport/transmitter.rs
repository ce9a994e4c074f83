//! XMT: characters leave one after the other, each for its time on the line. Source: S7-200 system manual, Transmit instruction.

use std::collections::VecDeque;

/// An active XMT.
#[derive(Clone, Debug)]
pub struct Transmitter {
    /// Empty: a break.
    bytes: VecDeque<u8>,
    /// When the character or break on the line ends.
    ends: u64,
    character_ns: u64,
}

/// The characters sent at a moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Left {
    Nothing,
    Character { byte: u8, last: bool },
    Break,
}

impl Transmitter {
    pub fn begin(bytes: &[u8], now: u64, character_ns: u64, break_ns: u64) -> Transmitter {
        let first = if bytes.is_empty() { break_ns } else { character_ns };
        Transmitter { bytes: bytes.iter().copied().collect(), ends: now.saturating_add(first), character_ns }
    }

    pub fn due(&self) -> u64 {
        self.ends
    }

    /// It is `now`; call again until nothing has been sent.
    pub fn time(&mut self, now: u64) -> Left {
        if now < self.ends {
            return Left::Nothing;
        }
        let Some(byte) = self.bytes.pop_front() else { return Left::Break };
        self.ends = self.ends.saturating_add(self.character_ns);
        Left::Character { byte, last: self.bytes.is_empty() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_take_their_time() {
        let mut transmitter = Transmitter::begin(b"AB", 100, 10, 16);
        assert_eq!((transmitter.time(109), transmitter.due()), (Left::Nothing, 110));
        assert_eq!(transmitter.time(110), Left::Character { byte: b'A', last: false });
        assert_eq!((transmitter.time(119), transmitter.due()), (Left::Nothing, 120));
        assert_eq!(transmitter.time(300), Left::Character { byte: b'B', last: true });
    }

    #[test]
    fn nothing_is_a_break() {
        let mut transmitter = Transmitter::begin(b"", 100, 10, 16);
        assert_eq!((transmitter.time(115), transmitter.time(116)), (Left::Nothing, Left::Break));
    }
}
