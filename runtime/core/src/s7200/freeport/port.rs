//! One port: the characters on its line, in the order of time.

use std::collections::VecDeque;

use super::receiver::{Receiver, Step};
use super::registers::Control;
use super::stream::{Arrived, Stream};
use super::transmitter::{Left, Transmitter};
use crate::schedule::NEVER;

/// Characters on the line that the port has not seen yet.
const LINE_MAX: usize = 1 << 14;
/// Sent bytes that are kept for a scenario.
const SENT_MAX: usize = 1 << 16;

/// Events of the port, for memory and interrupts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Happened {
    /// Nothing that the program sees.
    Nothing,
    /// A character outside RCV.
    Character { byte: u8, faulty: bool },
    /// A message continues or ends.
    Message { table: u32, byte: u8, step: Step },
    /// XMT has ended.
    Transmitted,
}

/// See the module comment. Times are those of the CPU, in nanoseconds.
#[derive(Default)]
pub struct Port {
    pub stream: Option<Stream>,
    /// SMB30 as it was last applied.
    pub control_byte: u8,
    /// When the characters on the line end.
    line: VecDeque<(u64, Arrived)>,
    line_free: u64,
    /// When the stream was last polled.
    looked: u64,
    /// RCV, and its table.
    pub receiver: Option<(Receiver, u32)>,
    pub transmitter: Option<Transmitter>,
    /// The characters sent since the last call.
    pub sent: Vec<u8>,
}

impl Port {
    /// Leaves Freeport, or begins it.
    pub fn reset(&mut self, now: u64) {
        if self.transmitter.take().is_some()
            && let Some(stream) = &mut self.stream
        {
            stream.set_break(false);
        }
        self.line.clear();
        self.line_free = now;
        self.looked = now;
        self.receiver = None;
    }

    pub fn is_busy(&self) -> bool {
        self.transmitter.is_some() || self.receiver.is_some()
    }

    /// When the next event is due without input.
    pub fn due(&self) -> u64 {
        let line = self.line.front().map_or(NEVER, |(at, _)| *at);
        let receiver = self.receiver.as_ref().and_then(|(receiver, _)| receiver.due()).unwrap_or(NEVER);
        let transmitter = self.transmitter.as_ref().map_or(NEVER, Transmitter::due);
        line.min(receiver).min(transmitter)
    }

    /// When the stream is polled next, at intervals of `period`.
    pub fn look_due(&self, period: u64) -> u64 {
        self.stream.as_ref().map_or(NEVER, |_| self.looked.saturating_add(period))
    }

    /// Puts characters on the line, after those that are there; the first one begins at `from` at the earliest. Without room they are lost,
    /// and the last one before them is faulty: an overrun.
    pub fn put(&mut self, arrived: &[Arrived], from: u64, control: &Control) {
        for &item in arrived {
            if self.line.len() >= LINE_MAX {
                if let Some((_, Arrived::Character { faulty, .. })) = self.line.back_mut() {
                    *faulty = true;
                }
                return;
            }
            let (item, time) = match item {
                Arrived::Character { byte, faulty } => {
                    (Arrived::Character { byte: control.on_line(byte), faulty }, control.character_ns())
                }
                Arrived::Break => (Arrived::Break, control.break_ns()),
            };
            self.line_free = self.line_free.max(from).saturating_add(time);
            self.line.push_back((self.line_free, item));
        }
    }

    /// Asks the stream. With the real clock characters may have come since the last look: they are as late as they can be, but after it.
    pub fn look(&mut self, now: u64, is_virtual: bool, control: &Control) {
        let Some(stream) = &mut self.stream else { return };
        stream.work();
        let arrived = stream.take(LINE_MAX.saturating_sub(self.line.len()));
        let taken = control.character_ns().saturating_mul(arrived.len() as u64);
        let from = if is_virtual { now } else { now.saturating_sub(taken).max(self.looked) };
        self.looked = now;
        self.put(&arrived, from, control);
    }

    /// The next thing that happens until `now`.
    pub fn next(&mut self, now: u64) -> Option<Happened> {
        let due = self.due();
        if due > now {
            return None;
        }
        // A message that ends at the moment of a time-out is in time.
        if let Some((at, arrived)) = self.line.front().copied().filter(|(at, _)| *at == due) {
            self.line.pop_front();
            return Some(self.arrived(arrived, at));
        }
        if let Some((receiver, table)) = &mut self.receiver
            && receiver.due() == Some(due)
        {
            let (table, step) = (*table, receiver.time(due));
            return Some(self.message(table, 0, step));
        }
        Some(self.leave(due))
    }

    fn arrived(&mut self, arrived: Arrived, at: u64) -> Happened {
        match (&mut self.receiver, arrived) {
            (Some((receiver, table)), Arrived::Character { byte, faulty }) => {
                let (table, step) = (*table, receiver.character(byte, faulty, at));
                self.message(table, byte, step)
            }
            (Some((receiver, table)), Arrived::Break) => {
                let (table, step) = (*table, receiver.line_break(at));
                self.message(table, 0, step)
            }
            (None, Arrived::Character { byte, faulty }) => Happened::Character { byte, faulty },
            (None, Arrived::Break) => Happened::Nothing,
        }
    }

    fn message(&mut self, table: u32, byte: u8, step: Step) -> Happened {
        if step.ended != 0 {
            self.receiver = None;
        }
        if step == Step::default() { Happened::Nothing } else { Happened::Message { table, byte, step } }
    }

    fn leave(&mut self, at: u64) -> Happened {
        let Some(transmitter) = &mut self.transmitter else { return Happened::Nothing };
        let left = transmitter.time(at);
        match left {
            Left::Nothing => Happened::Nothing,
            Left::Break => {
                if let Some(stream) = &mut self.stream {
                    stream.set_break(false);
                }
                self.transmitter = None;
                Happened::Transmitted
            }
            Left::Character { byte, last } => {
                if let Some(stream) = self.stream.as_mut().filter(|stream| !stream.keeps_time()) {
                    stream.send(&[byte]);
                }
                if self.sent.len() < SENT_MAX {
                    self.sent.push(byte);
                }
                if !last {
                    return Happened::Nothing;
                }
                self.transmitter = None;
                Happened::Transmitted
            }
        }
    }

    /// XMT of `bytes`; none: a break.
    pub fn transmit(&mut self, bytes: &[u8], now: u64, control: &Control) {
        let bytes: Vec<u8> = bytes.iter().map(|&byte| control.on_line(byte)).collect();
        if let Some(stream) = &mut self.stream {
            match bytes.is_empty() {
                true => stream.set_break(true),
                false if stream.keeps_time() => stream.send(&bytes),
                false => {}
            }
        }
        self.transmitter = Some(Transmitter::begin(&bytes, now, control.character_ns(), control.break_ns()));
    }
}
