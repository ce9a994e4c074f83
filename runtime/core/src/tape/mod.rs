//! Recordings: what a run got from outside, cycle by cycle, so that it can be repeated to the byte.
//!
//! While a run is recorded its clock stands still within a cycle, as the virtual clock does, and follows the clock of
//! the host between cycles. So besides the program, a run depends only on when each cycle begins, what came from
//! devices and what clients have changed. The file has these, and a checksum of memory after each cycle, which the
//! repetition must match.

mod devices;
mod file;

use std::cell::{Cell, RefCell};
use std::path::Path;
use std::rc::Rc;
use std::time::{Duration, Instant};

use plcc_abi::ProgramImage;
use plcc_abi::layout;

use crate::clock::Clock;
use crate::cpu::Cpu;
use crate::io::{Change, Driver, Simulated};

pub use devices::Devices;
use devices::Repeated;
use file::{Client, Frame, Writer};
pub use file::{Head, Recording};

/// What a recording takes of a run, or gives to it.
pub struct Tape {
    side: Side,
    /// What clients have done in this cycle.
    client: RefCell<Option<Client>>,
    failure: RefCell<Option<String>>,
}

enum Side {
    Record { writer: RefCell<Option<Writer>>, begin: Instant, notes: Rc<Notes> },
    Replay { recording: Rc<Recording>, next: Cell<usize>, strict: Cell<bool> },
}

/// What a driver that is recorded has noted.
#[derive(Default)]
pub struct Notes {
    /// Inputs that clients set, as long as they are wanted.
    inputs: RefCell<Option<Vec<(u32, u32, u32)>>>,
    /// What came from devices before this cycle.
    devices: RefCell<Devices>,
}

/// Longest sleep, so that signals are seen soon.
const SLICE: u64 = 20_000_000;

impl Tape {
    /// Records into a file from now on. `Err`: the file cannot be written.
    pub fn record(path: &Path, head: &Head, notes: Rc<Notes>) -> Result<Tape, String> {
        let writer = RefCell::new(Some(Writer::create(path, head)?));
        Ok(Tape::of(Side::Record { writer, begin: Instant::now(), notes }))
    }

    /// Repeats a recording.
    pub fn replay(recording: Rc<Recording>) -> Tape {
        Tape::of(Side::Replay { recording, next: Cell::new(0), strict: Cell::new(true) })
    }

    fn of(side: Side) -> Tape {
        Tape { side, client: RefCell::default(), failure: RefCell::default() }
    }

    /// The clock of a recorded run, at 0, with a wall clock.
    pub fn clock(wall: i64) -> Clock {
        let clock = Clock::simulated();
        clock.set_wall(wall);
        clock
    }

    /// Why the recording is not complete, or the run not as recorded.
    pub fn failure(&self) -> Option<String> {
        self.failure.borrow().clone()
    }

    fn fail(&self, message: String) {
        self.failure.borrow_mut().get_or_insert(message);
    }

    /// The user has changed values: from now on memory differs from the recording.
    pub fn set_free(&self) {
        if let Side::Replay { strict, .. } = &self.side {
            strict.set(false);
        }
    }

    /// No further cycles are recorded. The file is complete.
    pub fn finish(&self) {
        let Side::Record { writer, .. } = &self.side else { return };
        if let Some(Err(error)) = writer.take().map(Writer::finish) {
            self.fail(error);
        }
    }

    /// A cycle is over; `next` is when the next one is to begin. Result: when it begins; `None`: the recording ends here.
    pub(crate) fn end_cycle(&self, cpu: &Cpu, next: u64) -> Option<u64> {
        match &self.side {
            Side::Record { writer, begin, notes } => {
                let now = cpu.clock.now();
                let mut target = now;
                if !cpu.is_stopped() {
                    target = wait(*begin, next).max(next);
                }
                let frame = Frame {
                    advance: target.saturating_sub(now),
                    client: self.client.take(),
                    check: checksum(cpu),
                    devices: notes.devices.take(),
                };
                let mut slot = writer.borrow_mut();
                if let Some(why) = unrecorded(cpu)
                    && slot.is_some()
                {
                    *slot = None;
                    self.fail(format!("the recording ends before cycle {}: {why}", cpu.cycle_number()));
                }
                if let Some(Err(error)) = slot.as_mut().map(|writer| writer.write(&frame)) {
                    *slot = None;
                    self.fail(error);
                }
                Some(target)
            }
            Side::Replay { recording, next, strict } => {
                let frame = recording.frames.get(next.get())?;
                next.set(next.get() + 1);
                if let Some(client) = &frame.client {
                    repeat(cpu, client);
                }
                if strict.get() && checksum(cpu) != frame.check {
                    self.fail(format!(
                        "after cycle {} memory is not as recorded: the program, its files or its library have changed",
                        cpu.cycle_number()
                    ));
                    return None;
                }
                let is_last = next.get() == recording.frames.len();
                (!is_last).then(|| cpu.clock.now().saturating_add(frame.advance))
            }
        }
    }

    /// Lets clients work, and keeps what they change.
    pub(crate) fn served(&self, cpu: &Cpu, serve: impl FnOnce()) {
        let Side::Record { notes, .. } = &self.side else { return serve() };
        let (before, wall) = (areas(cpu), cpu.clock.wall());
        let was_stopped = cpu.is_stopped();
        notes.inputs.replace(Some(Vec::new()));
        serve();
        let inputs = notes.inputs.take().unwrap_or_default();
        let memory = differences(&before, &areas(cpu));
        let wall = Some(cpu.clock.wall()).filter(|now| *now != wall);
        let stop = cpu.is_stopped() && !was_stopped;
        if !inputs.is_empty() || !memory.is_empty() || wall.is_some() || stop {
            self.client.replace(Some(Client { memory, inputs, wall, stop }));
        }
    }
}

/// Sleeps until `next` nanoseconds after `begin`, unless the process is to end. Result: nanoseconds since `begin`.
fn wait(begin: Instant, next: u64) -> u64 {
    loop {
        let now = u64::try_from(begin.elapsed().as_nanos()).unwrap_or(u64::MAX);
        if now >= next || crate::run::end_requested() {
            return now;
        }
        std::thread::sleep(Duration::from_nanos((next - now).min(SLICE)));
    }
}

/// What comes from outside and is not in a recording.
fn unrecorded(cpu: &Cpu) -> Option<&'static str> {
    match () {
        () if cpu.communication.borrow().is_open() => Some("the program talks to partners over connections"),
        () if cpu.partners.is_attached() => Some("the program exchanges jobs with S7 partners"),
        () if cpu.is_forcing() => Some("values are forced"),
        () => None,
    }
}

/// Does what clients did.
fn repeat(cpu: &Cpu, client: &Client) {
    for &(address, bytes, value) in &client.inputs {
        cpu.driver.set_input(address, bytes, value);
    }
    for (offset, bytes) in &client.memory {
        // What the file says goes to the areas of values only.
        let end = offset.saturating_add(bytes.len() as u32);
        if ranges(cpu).iter().any(|(start, length)| *offset >= *start && end <= start + length) {
            cpu.memory.load(*offset, bytes);
        }
    }
    if !client.memory.is_empty() {
        cpu.note_outputs(u32::MAX);
    }
    if let Some(wall) = client.wall {
        cpu.set_wall_clock(wall);
    }
    if client.stop {
        cpu.stop_by_request();
    }
}

/// Where values are in memory, as offset and length.
fn ranges(cpu: &Cpu) -> Vec<(u32, u32)> {
    use crate::cpu::Area;
    let mut ranges: Vec<(u32, u32)> =
        [Area::Inputs, Area::Outputs, Area::BitMemory].into_iter().map(|area| cpu.area(area)).collect();
    ranges.push((layout::T, layout::CELLS_BYTES));
    if cpu.s7200.is_some() {
        ranges.push((layout::SYSTEM, layout::L - layout::SYSTEM));
    }
    let dbs = cpu.image.db_end.max(layout::DB_DATA);
    ranges.push((layout::DB_DATA, dbs - layout::DB_DATA));
    ranges.extend(cpu.created_dbs.borrow().iter().map(|&(_, address, bytes)| (address, bytes)));
    ranges
}

/// The values in memory, by their offsets.
fn areas(cpu: &Cpu) -> Vec<(u32, Vec<u8>)> {
    ranges(cpu).into_iter().map(|(offset, bytes)| (offset, cpu.memory.view(offset, bytes, <[u8]>::to_vec))).collect()
}

/// A checksum of the values in memory, and of the clock.
fn checksum(cpu: &Cpu) -> u32 {
    let mut sum = crc32fast::Hasher::new();
    for (offset, bytes) in ranges(cpu) {
        cpu.memory.view(offset, bytes, |bytes| sum.update(bytes));
    }
    sum.update(&cpu.clock.now().to_le_bytes());
    sum.finalize()
}

/// The runs of bytes that differ.
fn differences(before: &[(u32, Vec<u8>)], after: &[(u32, Vec<u8>)]) -> Vec<(u32, Vec<u8>)> {
    /// Equal bytes that do not end a run.
    const GAP: usize = 8;
    let mut list: Vec<(u32, Vec<u8>)> = Vec::new();
    for (offset, now) in after {
        let Some((_, old)) = before.iter().find(|(own, old)| own == offset && old.len() == now.len()) else {
            list.push((*offset, now.clone()));
            continue;
        };
        let mut open: Option<(usize, usize)> = None;
        let mut close = |from: usize, to: usize| list.push((offset + from as u32, now[from..to].to_vec()));
        for at in (0..now.len()).filter(|&at| old[at] != now[at]) {
            open = match open {
                Some((from, to)) if at - to <= GAP => Some((from, at + 1)),
                Some((from, to)) => {
                    close(from, to);
                    Some((at, at + 1))
                }
                None => Some((at, at + 1)),
            };
        }
        if let Some((from, to)) = open {
            close(from, to);
        }
    }
    list
}

/// The driver of a repeated run.
pub fn repeated_driver(image: &ProgramImage, recording: &Rc<Recording>) -> Box<dyn Driver> {
    let modules = image.config.modules.clone();
    match image.config.remote.is_empty() {
        true => Box::new(Simulated::new(modules)),
        false => Box::new(Repeated::new(modules, &image.config.remote, Rc::clone(recording))),
    }
}

/// A driver that notes which inputs are set, and what comes from devices.
pub struct Noted {
    pub inner: Box<dyn Driver>,
    pub notes: Rc<Notes>,
    pub has_devices: bool,
}

impl Driver for Noted {
    fn read(&self, address: u32, bytes: u32) -> Option<u32> {
        self.inner.read(address, bytes)
    }

    fn write(&self, address: u32, bytes: u32, value: u32) -> bool {
        self.inner.write(address, bytes, value)
    }

    fn write_image(&self, image: &[u8]) {
        self.inner.write_image(image);
    }

    fn stop(&self) {
        self.inner.stop();
    }

    fn enable(&self) {
        self.inner.enable();
    }

    fn hand_over(&self) {
        self.inner.hand_over();
    }

    fn output(&self, address: u32, bytes: u32) -> u32 {
        self.inner.output(address, bytes)
    }

    fn set_input(&self, address: u32, bytes: u32, value: u32) {
        if let Some(notes) = self.notes.inputs.borrow_mut().as_mut() {
            notes.push((address, bytes, value));
        }
        self.inner.set_input(address, bytes, value);
    }

    fn name_input(&self, address: u32, bytes: u32) {
        self.inner.name_input(address, bytes);
    }

    fn named(&self, limit: u32, each: &mut dyn FnMut(u32, u8)) {
        self.inner.named(limit, each);
    }

    fn exchange(&self, changed: &mut dyn FnMut(Change)) {
        if !self.has_devices {
            return self.inner.exchange(changed);
        }
        let (before, mut changes) = (devices::inputs(&*self.inner), Vec::new());
        self.inner.exchange(&mut |change| changes.push(change));
        let devices = Devices::between(&before, devices::inputs(&*self.inner), changes);
        devices.changes.iter().cloned().for_each(changed);
        self.notes.devices.replace(devices);
    }

    fn away(&self) -> Vec<Change> {
        self.inner.away()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_runs() {
        let old = vec![(10, vec![0u8; 40])];
        let mut new = old.clone();
        (new[0].1[3], new[0].1[5], new[0].1[30]) = (1, 2, 3);
        assert_eq!(differences(&old, &new), [(13, vec![1, 0, 2]), (40, vec![3])]);
        assert!(differences(&old, &old).is_empty());
        assert_eq!(differences(&[], &[(5, vec![1])]), [(5, vec![1])]);
    }
}
