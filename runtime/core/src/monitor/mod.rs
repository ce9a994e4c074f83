//! Status of blocks for clients, while the CPU runs: what the calls of watched blocks see.
//!
//! There are two copies of the program's code, one as it runs and one with probes ([`plcc_abi::monitor`]). While
//! a client watches, the code with probes runs; both codes change only between two cycles, and memory stays as it is.
//! Of all that the probes tell, a [`Watch`] keeps what one call of its block sees, in one cycle, until it is read;
//! then it keeps the next one.

pub mod history;
mod recorder;
pub mod recording;
pub mod steps;

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;

use plcc_abi::image::{BlockKind, DbEntry};
use plcc_abi::monitor::{BlockProbes, Probes};

use crate::cpu::Cpu;
use crate::probe::Registers;
use crate::signal::Source;
use history::{Activation, History};
use steps::StepSeen;

pub use recorder::CALLS_MAX;

/// Who looks at blocks of a CPU.
#[derive(Default)]
pub struct Monitor {
    watches: RefCell<Vec<Watch>>,
    /// The blocks that run: numbers of their first probes, and their instances.
    running: RefCell<Vec<(u32, u32)>>,
    /// Some watch keeps what the block that runs sees.
    is_keeping: Cell<bool>,
    recordings: RefCell<Vec<recording::Recording>>,
    /// How often organization blocks ran, by the numbers of their first probes, and those that run now.
    obs: RefCell<BTreeMap<u32, ObRuns>>,
    started: RefCell<Vec<u64>>,
}

/// How often an organization block ran while a client looked, and how long, in nanoseconds. What interrupts it is part of that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ObRuns {
    pub count: u64,
    pub total: u64,
    pub longest: u64,
}

/// Somebody looks at a block.
struct Watch {
    /// Who looks.
    client: u64,
    /// Place of the block in the list of all; `None`: only the runs of organization blocks are counted.
    block: Option<usize>,
    /// The call that is wanted, as [`Looked::calls`] names it; `None`: the first one.
    wanted: Option<String>,
    calls: Vec<Call>,
    /// Of a chart: the calls that run, each with the number of blocks that run then.
    inside: Vec<(usize, usize)>,
    /// Number of blocks that run when the chosen one runs; 0: it does not run.
    depth: usize,
    now: Recorded,
    /// What the last complete call has seen, until it is read.
    done: Option<Recorded>,
}

/// A way on which the block is called.
struct Call {
    /// First probes of the blocks from the organization block on, the block itself last.
    path: Vec<u32>,
    instance: u32,
    name: String,
    /// Of a chart.
    history: History,
}

/// What a call has seen.
#[derive(Clone, Debug, Default)]
pub struct Recorded {
    pub cycle: u64,
    /// Index in [`Looked::calls`].
    pub call: usize,
    /// By number of the probe, counted from the first one of the block.
    pub seen: Vec<Option<Seen>>,
    /// Of a chart, at the end of the call.
    pub steps: Vec<StepSeen>,
    /// Steps of a chart that have become active in the calls since the first look, the newest first.
    pub history: Vec<Activation>,
}

/// What a probe has told last.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Seen {
    /// The registers, and the timer or counter of the statement as a text.
    Registers(Registers, Option<String>),
    /// A value, zero-extended.
    Value(u64),
    /// A logic stack with ENO, and the operands of the statement with their values.
    Stack(u64, Vec<String>),
}

/// What a client that watches gets.
pub struct Looked {
    /// The calls of the block that have run since it has been watched.
    pub calls: Vec<String>,
    /// What one of them has seen since the last look, if it was called.
    pub recorded: Option<Recorded>,
}

impl Cpu {
    /// The probes of the program, if it has code with probes.
    pub fn probes(&self) -> Option<&Probes> {
        self.image.config.services.probes.as_ref()
    }

    /// From now on `client` looks at a block, and at no other; `call` is one of [`Looked::calls`], or the first in a cycle. Only between
    /// two cycles. `Err`: why not.
    pub fn watch_block(&self, client: u64, block: &str, call: Option<&str>) -> Result<(), String> {
        let Some(probes) = self.probes() else {
            return Err("the program was built without the code that can be watched (plcc build --monitor)".to_string());
        };
        let compact: String = block.chars().filter(|c| !c.is_whitespace()).take(40).collect();
        let is_named = |block: &&BlockProbes| {
            let address = format!("{}{}", block.kind.prefix(), block.number);
            address.eq_ignore_ascii_case(&compact)
        };
        let Some(found) = probes.blocks.iter().position(|block| is_named(&block)) else {
            return Err(format!("{compact} has no status"));
        };
        let mut watches = self.monitor.watches.borrow_mut();
        if let Some(watch) = watches.iter_mut().find(|watch| watch.client == client && watch.block == Some(found)) {
            if watch.wanted.as_deref() != call {
                watch.wanted = call.map(str::to_string);
                watch.done = None;
            }
            return Ok(());
        }
        watches.retain(|watch| watch.client != client);
        watches.push(Watch::new(client, Some(found), call));
        self.code.watch(true);
        Ok(())
    }

    /// From now on the runs of organization blocks are counted for `client`, which watches no block. Only between two cycles.
    pub fn watch_obs(&self, client: u64) {
        let mut watches = self.monitor.watches.borrow_mut();
        if !watches.iter().any(|watch| watch.client == client && watch.block.is_none()) && self.probes().is_some() {
            watches.retain(|watch| watch.client != client);
            watches.push(Watch::new(client, None, None));
            self.code.watch(true);
        }
    }

    /// The runs of an organization block since a client has been watching; `None`: none is.
    pub fn ob_runs(&self, number: u16) -> Option<ObRuns> {
        if self.monitor.watches.borrow().is_empty() {
            return None;
        }
        let of = |block: &&BlockProbes| block.kind == BlockKind::Ob && block.number == number;
        let block = self.probes()?.blocks.iter().find(of)?;
        Some(self.monitor.obs.borrow().get(&block.first).copied().unwrap_or_default())
    }

    /// `client` has stopped looking. Only between two cycles.
    pub fn unwatch_block(&self, client: u64) {
        let mut watches = self.monitor.watches.borrow_mut();
        watches.retain(|watch| watch.client != client);
        if watches.is_empty() {
            self.code.watch(false);
            self.monitor.running.borrow_mut().clear();
            self.monitor.started.borrow_mut().clear();
            self.monitor.obs.borrow_mut().clear();
        }
    }

    /// What `client` sees; `None`: it watches nothing, or the CPU was restarted.
    pub fn look_at_block(&self, client: u64) -> Option<Looked> {
        let mut watches = self.monitor.watches.borrow_mut();
        let watch = watches.iter_mut().find(|watch| watch.client == client)?;
        let calls = watch.calls.iter().map(|call| call.name.clone()).collect();
        Some(Looked { calls, recorded: watch.done.take() })
    }

    /// The DB of the program that has the byte at this offset in memory, and which of its bytes that is.
    pub fn db_at(&self, offset: u32) -> Option<(&DbEntry, u32)> {
        let inside = |db: &&DbEntry| {
            db.address <= offset && offset - db.address < u32::try_from(db.data.len()).unwrap_or(u32::MAX)
        };
        let db = self.image.dbs.iter().find(inside).filter(|_| offset != 0)?;
        Some((db, offset - db.address))
    }

    /// `OB 1 › FC 2 › FB 3, DB 5 "Motor"`
    fn call_name(&self, path: &[u32], instance: u32) -> String {
        let blocks = self.probes().map_or(&[][..], |probes| &probes.blocks);
        let named = path.iter().filter_map(|first| {
            let at = blocks.binary_search_by_key(first, |block| block.first).ok()?;
            Some(format!("{} {}", blocks[at].kind.prefix(), blocks[at].number))
        });
        let mut name = named.collect::<Vec<_>>().join(" › ");
        if let Some((db, byte)) = self.db_at(instance) {
            name.push_str(&format!(", DB {}", db.number));
            if !db.name.is_empty() {
                name.push_str(&format!(" \"{}\"", db.name));
            }
            if byte != 0 {
                name.push_str(&format!(" from byte {byte}"));
            }
        }
        name
    }
}

/// The address of an operand that is read as a type: `VW100` of `VW100 as INT`.
pub fn address_of(name: &str) -> &str {
    name.split_once(" as ").map_or(name, |(address, _)| address)
}

/// The value of a named address as a text.
pub fn text_of(cpu: &Cpu, name: &str) -> Option<String> {
    Source::find(name, &cpu.image, None).ok().map(|source| source.read(cpu, None).text())
}

/// A block that something outside of the program calls.
fn is_root(kind: BlockKind) -> bool {
    matches!(kind, BlockKind::Ob | BlockKind::Int)
}
