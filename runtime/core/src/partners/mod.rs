//! Configured S7 connections: PUT, GET, USEND, URCV, BSEND, BRCV.
//!
//! ```text
//! blocks ──► Board ◄── the thread that has the network (services)
//! ```
//!
//! Blocks leave jobs on the [`Board`] and go on; the thread that has the network takes them, and puts results and
//! what partners sent beside them. Blocks see both from the next cycle control point on ([`Board::exchange`]), so a
//! cycle sees one state. Without a network every job ends with STATUS 1, as with a connection that is not up.
//!
//! Source: System and standard functions, SFB 8 to 15.

mod receivers;
#[cfg(test)]
mod tests;

use std::cell::RefCell;
use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

use plcc_abi::connections::S7Connection;

use receivers::Receivers;
pub use receivers::{Arrived, Kind, NotTaken, Receive, Slot};

/// STATUS of blocks. Source: System and standard functions, SFB 8 to 15, error information.
pub mod status {
    pub const DONE: u16 = 0;
    /// ERROR 1: the connection is not up, or was lost.
    pub const NO_CONNECTION: u16 = 1;
    /// The partner refuses the job.
    pub const REFUSED: u16 = 2;
    /// The partner has no block with this R_ID.
    pub const R_ID_UNKNOWN: u16 = 3;
    /// Pointers, lengths or types do not fit.
    pub const AREA: u16 = 4;
    /// The job was cancelled.
    pub const CANCELLED: u16 = 5;
    /// BRCV of the partner is not ready.
    pub const DISABLED: u16 = 6;
    /// BRCV of the partner has not taken the last block.
    pub const NOT_TAKEN: u16 = 7;
    /// The partner refuses access to an area.
    pub const ACCESS: u16 = 8;
    /// ERROR 0: older data was overwritten.
    pub const OVERWRITTEN: u16 = 9;
    /// Own data cannot be read or written.
    pub const LOCAL_ACCESS: u16 = 10;
    /// ERROR 0: data is arriving.
    pub const ARRIVING: u16 = 17;
    /// R_ID is in use on this connection.
    pub const R_ID_USED: u16 = 18;
    /// There are too many jobs.
    pub const RESOURCES: u16 = 20;
    /// ERROR 0: the job is being done.
    pub const RUNNING: u16 = 25;
}

/// Jobs at once, those included whose result has not been taken.
const JOBS_MAX: usize = 256;

/// An area of a partner, as an item of S7 communication names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Remote {
    /// Transport size: 1 one bit, 2 bytes, 1C counters, 1D timers.
    pub transport: u8,
    pub count: u16,
    pub db: u16,
    pub area: u8,
    /// 24 bits: byte and bit, or a number.
    pub address: u32,
}

/// One bit.
pub const BIT: u8 = 0x01;
pub const BYTES: u8 = 0x02;
pub const COUNTERS: u8 = 0x1C;
pub const TIMERS: u8 = 0x1D;

impl Remote {
    /// Bytes of its data; a bit is one byte.
    pub fn bytes(&self) -> usize {
        match self.transport {
            COUNTERS | TIMERS => 2 * usize::from(self.count),
            _ => usize::from(self.count),
        }
    }
}

/// Data of the program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Data {
    /// One byte, 0 or 1.
    pub is_bit: bool,
    pub bytes: Vec<u8>,
}

/// What a block wants of its partner.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Work {
    /// GET.
    Read(Vec<Remote>),
    /// PUT.
    Write(Vec<(Remote, Data)>),
    /// USEND.
    Message(u32, Vec<Data>),
    /// BSEND.
    Block(u32, Vec<u8>),
}

/// How a job ended: what was read, or STATUS.
pub type Ended = Result<Vec<Vec<u8>>, u16>;

/// How far a job is, as its block sees it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum State {
    Running,
    Ended(Ended),
}

struct Job {
    line: usize,
    ended: Option<Ended>,
    /// The end is older than the last cycle control point.
    shown: bool,
}

/// A connection.
#[derive(Default)]
struct Line {
    is_up: bool,
    /// How often it came up: results of what served it before do not count.
    turn: u64,
    waiting: VecDeque<(u32, Work)>,
    wake: Option<Wake>,
}

/// Tells the network that there is something to do.
pub type Wake = Box<dyn Fn() + Send>;

struct Inner {
    lines: Vec<Line>,
    jobs: BTreeMap<u32, Job>,
    last: u32,
    receivers: Receivers,
}

/// Connections, jobs and what has arrived. See the module comment.
pub struct Board {
    connections: Vec<S7Connection>,
    inner: Mutex<Inner>,
}

impl Board {
    /// The connections of a program, none of them up.
    pub fn new(connections: Vec<S7Connection>) -> Board {
        let lines = connections.iter().map(|_| Line::default()).collect();
        // Numbers of jobs are in instances, which may outlive the process: they begin elsewhere each time.
        let last = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(0, |time| time.as_millis() as u32);
        let inner = Inner { lines, jobs: BTreeMap::new(), last, receivers: Receivers::default() };
        Board { connections, inner: Mutex::new(inner) }
    }

    pub fn connections(&self) -> &[S7Connection] {
        &self.connections
    }

    fn inner(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn line_of(&self, id: u16) -> Option<usize> {
        self.connections.iter().position(|connection| connection.id == id)
    }
}

/// The board as the CPU has it: jobs are not carried without services.
#[derive(Default)]
pub(crate) struct Partners(RefCell<Option<Arc<Board>>>);

impl Partners {
    pub fn attach(&self, board: Option<Arc<Board>>) {
        // What a run before left there.
        board.iter().for_each(|board| board.clear());
        self.0.replace(board);
    }

    /// Somebody carries jobs over connections.
    pub fn is_attached(&self) -> bool {
        self.0.borrow().as_ref().is_some_and(|board| !board.connections().is_empty())
    }

    pub fn start(&self, id: u16, work: Work) -> Result<u32, u16> {
        self.0.borrow().as_ref().map_or(Err(status::NO_CONNECTION), |board| board.start(id, work))
    }

    pub fn state(&self, number: u32) -> State {
        self.0.borrow().as_ref().map_or(State::Ended(Err(status::NO_CONNECTION)), |board| board.take(number))
    }

    pub fn cancel(&self, number: u32) {
        self.0.borrow().iter().for_each(|board| board.cancel(number));
    }

    pub fn receive(&self, id: u16, slot: Slot, ready: &Receive) -> (u32, Result<Arrived, u16>) {
        match self.0.borrow().as_ref() {
            Some(board) => board.receive(id, slot, ready),
            None => (slot.handle, nobody(ready)),
        }
    }

    /// The cycle control point.
    pub fn exchange(&self, stopped: bool) {
        if let Some(board) = self.0.borrow().as_ref() {
            if stopped { board.clear() } else { board.exchange() }
        }
    }
}

/// What a block receives without a connection.
fn nobody(ready: &Receive) -> Result<Arrived, u16> {
    if ready.enabled { Err(status::NO_CONNECTION) } else { Ok(Arrived::Nothing) }
}

/// What the CPU does.
impl Board {
    /// Begins a job on connection `id`. `Err`: STATUS.
    pub fn start(&self, id: u16, work: Work) -> Result<u32, u16> {
        let line = self.line_of(id).ok_or(status::NO_CONNECTION)?;
        let mut inner = self.inner();
        if !inner.lines[line].is_up {
            return Err(status::NO_CONNECTION);
        }
        if inner.jobs.len() >= JOBS_MAX {
            // What has ended and is not taken belongs to blocks that are no longer called.
            inner.jobs.retain(|_, job| job.ended.is_none());
            if inner.jobs.len() >= JOBS_MAX {
                return Err(status::RESOURCES);
            }
        }
        let number = inner.next_number();
        inner.jobs.insert(number, Job { line, ended: None, shown: false });
        inner.lines[line].waiting.push_back((number, work));
        inner.lines[line].wake();
        Ok(number)
    }

    /// How far a job is; its end is returned once.
    pub fn take(&self, number: u32) -> State {
        let mut inner = self.inner();
        match inner.jobs.get(&number) {
            // Of a run before a restart.
            None => State::Ended(Err(status::NO_CONNECTION)),
            Some(job) if !job.shown => State::Running,
            Some(_) => {
                let ended = inner.jobs.remove(&number).and_then(|job| job.ended);
                State::Ended(ended.unwrap_or(Err(status::NO_CONNECTION)))
            }
        }
    }

    /// Ends a job, whatever the partner has of it.
    pub fn cancel(&self, number: u32) {
        let mut inner = self.inner();
        if let Some(Job { line, .. }) = inner.jobs.remove(&number) {
            inner.lines[line].waiting.retain(|(other, _)| *other != number);
            inner.lines[line].wake();
        }
    }

    /// A block receives, and tells what it is ready for. Result: the handle of its next call; what has come, or STATUS.
    pub fn receive(&self, id: u16, slot: Slot, ready: &Receive) -> (u32, Result<Arrived, u16>) {
        let Some(line) = self.line_of(id) else { return (slot.handle, nobody(ready)) };
        let mut inner = self.inner();
        let is_up = inner.lines[line].is_up;
        let new = if inner.receivers.is_known(line, slot) { 0 } else { inner.next_number() };
        inner.receivers.receive(line, slot, ready, new, is_up)
    }

    /// The cycle control point: from now on blocks see what has come until here.
    pub fn exchange(&self) {
        let mut inner = self.inner();
        inner.jobs.values_mut().for_each(|job| job.shown = job.ended.is_some());
        inner.receivers.exchange();
    }

    /// STOP: jobs end, and nothing is received.
    pub fn clear(&self) {
        let mut inner = self.inner();
        inner.jobs.clear();
        inner.receivers.clear();
        inner.lines.iter_mut().for_each(|line| line.waiting.clear());
    }
}

/// What the network does. `turn` is the result of [`Board::join`]: a connection that came up again is another one.
impl Board {
    /// A connection is up.
    pub fn join(&self, line: usize, wake: Wake) -> u64 {
        let mut inner = self.inner();
        inner.fail_all(line);
        let own = &mut inner.lines[line];
        // Who served it until now sees that it is over.
        own.wake();
        own.turn += 1;
        own.is_up = true;
        own.wake = Some(wake);
        own.turn
    }

    /// Nothing else has taken the connection over.
    pub fn is_current(&self, line: usize, turn: u64) -> bool {
        self.inner().lines[line].turn == turn
    }

    /// A connection is lost.
    pub fn leave(&self, line: usize, turn: u64) {
        let mut inner = self.inner();
        if inner.lines[line].turn == turn {
            inner.lines[line].is_up = false;
            inner.lines[line].wake = None;
            inner.fail_all(line);
        }
    }

    /// The next job of a connection.
    pub fn next(&self, line: usize, turn: u64) -> Option<(u32, Work)> {
        let mut inner = self.inner();
        if inner.lines[line].turn != turn {
            return None;
        }
        inner.lines[line].waiting.pop_front()
    }

    /// The block has not given its job up.
    pub fn is_wanted(&self, number: u32) -> bool {
        self.inner().jobs.get(&number).is_some_and(|job| job.ended.is_none())
    }

    /// A job has ended.
    pub fn finish(&self, number: u32, ended: Ended) {
        if let Some(job) = self.inner().jobs.get_mut(&number).filter(|job| job.ended.is_none()) {
            job.ended = Some(ended);
        }
    }

    /// USEND of the partner.
    pub fn message(&self, line: usize, r_id: u32, areas: Vec<Vec<u8>>) {
        self.inner().receivers.message(line, r_id, areas);
    }

    /// BSEND of the partner begins to send so many bytes. `Err`: why they are not taken.
    pub fn begin_block(&self, line: usize, r_id: u32, bytes: usize) -> Result<(), NotTaken> {
        self.inner().receivers.begin_block(line, r_id, bytes)
    }

    /// A block that has begun will not be completed.
    pub fn drop_block(&self, line: usize, r_id: u32) {
        self.inner().receivers.drop_block(line, r_id);
    }

    /// All bytes of a block are there.
    pub fn end_block(&self, line: usize, r_id: u32, bytes: Vec<u8>) -> Result<(), NotTaken> {
        self.inner().receivers.end_block(line, r_id, bytes)
    }
}

impl Line {
    fn wake(&self) {
        if let Some(wake) = &self.wake {
            wake();
        }
    }
}

impl Inner {
    fn next_number(&mut self) -> u32 {
        loop {
            // 0 is not a job.
            self.last = self.last.checked_add(1).unwrap_or(1);
            if !self.jobs.contains_key(&self.last) {
                return self.last;
            }
        }
    }

    fn fail_all(&mut self, line: usize) {
        self.lines[line].waiting.clear();
        for job in self.jobs.values_mut().filter(|job| job.line == line && job.ended.is_none()) {
            job.ended = Some(Err(status::NO_CONNECTION));
        }
        self.receivers.lost(line);
    }
}
