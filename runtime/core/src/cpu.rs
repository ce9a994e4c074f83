//! The CPU: PLC memory, the program and everything that runs it.
//!
//! Generated code calls the runtime and the runtime calls generated code, nested to any depth, so a `Cpu` is only ever
//! shared: all its state is in cells, and no borrow of a `RefCell` lasts across a call into code.

use std::cell::{Cell, OnceCell, RefCell};
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

use plcc_abi::ProgramImage;
use plcc_abi::image::{BlockEntry, BlockKind, DbEntry};
use plcc_abi::layout::{self, state};
use plcc_abi::ob::{OB_FREE, ObClass};

use crate::alarms::Alarms;
use crate::assertion::Assertions;
use crate::clock::{Clock, NS_PER_MS};
use crate::code::Code;
use crate::communication::Communication;
use crate::diagnostics::{Diagnostics, Entry};
use crate::enabled::Enabled;
use crate::family::{Family, Step7};
use crate::force::Force;
use crate::io::Driver;
use crate::memory::Memory;
use crate::modify::Jobs;
use crate::monitor::Monitor;
use crate::ob_starts::ObStarts;
use crate::online::Service;
use crate::options::{CYCLE_TIME_DEFAULT, Restart};
use crate::organization::Running;
use crate::partners::Partners;
use crate::probe::Watcher;
use crate::records::Records;
use crate::records::store::Store;
use crate::restart::Carried;
use crate::retain::{Restored, Retention};
use crate::s7200::{S7200, ScanCycle};
use crate::schedule::Schedule;
use crate::system::meters::{METERS, Meter};
use crate::system::zone::Zone;
use crate::tape::Tape;
use crate::technology::Technology;
use crate::watchdog::Watchdog;

/// Why the CPU is in STOP.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stop {
    pub entry: Entry,
    /// The event before it that was its cause, if any.
    pub cause: Option<Entry>,
    /// Requested by the program (SFC 46, STP): not a fault.
    pub asked: bool,
}

impl Stop {
    /// As in a changed program, see [`Diagnostics::rename_sites`].
    pub(crate) fn with_sites(mut self, renamed: &[(u32, u32)]) -> Stop {
        self.entry.rename_site(renamed);
        self.cause.iter_mut().for_each(|cause| cause.rename_site(renamed));
        self
    }
}

/// See the module comment.
pub struct Cpu {
    /// Before `memory`: its thread must end before the memory goes.
    pub(crate) watchdog: Watchdog,
    pub memory: Memory,
    pub image: Arc<ProgramImage>,
    pub(crate) code: Rc<dyn Code>,
    pub clock: Clock,
    pub driver: Box<dyn Driver>,
    pub diagnostics: Diagnostics,
    pub(crate) running: Running,
    pub(crate) schedule: Schedule,
    pub(crate) assertions: Assertions,
    /// Who looks at the probes of the program.
    pub(crate) watcher: OnceCell<Rc<dyn Watcher>>,
    /// Clients that look at blocks.
    pub(crate) monitor: Monitor,
    /// The recording of the run, or the one that it repeats.
    pub(crate) tape: OnceCell<Rc<Tape>>,
    pub(crate) stop: Cell<Option<Stop>>,
    /// Blocks sorted by kind and number.
    blocks: Vec<BlockEntry>,
    /// A bit for each number of a DB: it is write-protected; it has optimised access.
    read_only_dbs: Vec<u64>,
    optimized_dbs: Vec<u64>,
    /// DBs made at run time: number, address, bytes. Sorted by address.
    pub(crate) created_dbs: RefCell<Vec<(u16, u32, u32)>>,
    /// Load memory of DBs where the program has changed it.
    pub(crate) load_memory: RefCell<BTreeMap<u16, Vec<u8>>>,
    /// An event of the diagnostics came since the last cycle began, for the system memory byte.
    pub(crate) diagnostics_changed: Cell<bool>,
    /// Memory that outlives the process, if there is a file for it.
    pub(crate) retention: OnceCell<Retention>,
    /// The startup OB: that of the configuration unless such a restart is not possible.
    pub(crate) startup: Cell<u16>,
    /// Answers clients.
    pub(crate) service: RefCell<Option<Box<dyn Service>>>,
    pub(crate) is_served: Cell<bool>,
    /// A client asks for RUN.
    pub(crate) restart_requested: Cell<Option<Restart>>,
    /// The CPU goes on in place of one that stopped.
    pub(crate) is_restarted: bool,
    /// What came back of retentive memory, and whether there was some that could not.
    pub(crate) restored: Cell<Restored>,
    pub(crate) retentive_lost: Cell<bool>,
    /// What that one has left, until startup.
    pub(crate) carried: RefCell<Option<Carried>>,
    /// Connections of the program.
    pub(crate) communication: RefCell<Communication>,
    /// Its S7 connections.
    pub(crate) partners: Partners,
    /// Data logs, recipes and files.
    pub(crate) records: RefCell<Records>,
    /// The program has begun to use connections, data logs or files: the ends of cycles serve them.
    pub(crate) has_jobs: Cell<bool>,
    /// Alarms that came and went.
    pub(crate) alarms: RefCell<Alarms>,
    /// Fast counters, pulse generators, hardware interrupts.
    pub(crate) technology: Technology,
    /// How startup, cycle and interrupts work on this CPU.
    pub(crate) family: &'static dyn Family,
    /// State that only an S7-200 has.
    pub(crate) s7200: Option<Box<S7200>>,
    /// The output byte before which the runtime may have changed outputs that no code of the program writes: the next copy to the
    /// modules includes them.
    pub(crate) outputs_changed: Cell<u32>,
    /// The OBs of the program cycle in the order of their numbers.
    pub(crate) cycle_obs: Vec<LoadedOb>,
    /// Of local time.
    pub(crate) zone: Cell<Zone>,
    /// Number of the cycle, 0 in startup.
    pub(crate) cycle: Cell<u64>,
    /// Inputs and outputs with fixed values.
    pub(crate) force: Force,
    /// Values that clients modify in the cycle.
    pub(crate) jobs: Jobs,
    /// Outputs in STOP.
    pub(crate) enabled: Enabled,
    pub(crate) ob_starts: ObStarts,
    /// How often the program was changed.
    pub(crate) generation: u64,
    /// Run-time meters.
    pub(crate) meters: [Meter; METERS],
}

/// DBs that may be made at run time; more is "no memory".
pub const CREATED_DBS_MAX: usize = 4096;

/// The bit of a number.
fn is_marked(bits: &[u64], number: u16) -> bool {
    bits.get(usize::from(number / 64)).copied().unwrap_or(0) >> (number % 64) & 1 != 0
}

impl Cpu {
    /// How often the program was changed while it ran: a place that was found by its name must be looked up again
    /// when this number is another one.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// Names the recording of the run, before the CPU starts. The first call counts.
    pub fn set_tape(&self, tape: Rc<Tape>) {
        let _ = self.tape.set(tape);
    }

    /// The recording of the run, or the one that it repeats.
    pub fn tape(&self) -> Option<&Tape> {
        self.tape.get().map(Rc::as_ref)
    }

    /// Number of the cycle, 0 in startup.
    pub fn cycle_number(&self) -> u64 {
        self.cycle.get()
    }

    /// A CPU in STOP with the program loaded.
    pub fn new(
        image: impl Into<Arc<ProgramImage>>,
        code: Rc<dyn Code>,
        clock: Clock,
        driver: Box<dyn Driver>,
    ) -> Rc<Cpu> {
        let image: Arc<ProgramImage> = image.into();
        let mut blocks = image.blocks.clone();
        blocks.sort_by_key(|block| (block.kind, block.number));
        let memory = Memory::new(image.db_end);
        let marked = |is_marked: fn(&DbEntry) -> bool| {
            let mut bits = Vec::new();
            for db in image.dbs.iter().filter(|db| is_marked(db)) {
                let word = usize::from(db.number / 64);
                bits.resize(bits.len().max(word + 1), 0);
                bits[word] |= 1u64 << (db.number % 64);
            }
            bits
        };
        let (read_only_dbs, optimized_dbs) = (marked(|db| db.read_only), marked(|db| db.optimized));
        let cycle_obs = obs_of(&blocks, &image, ObClass::ProgramCycle).map(|ob| LoadedOb::new(ob, &blocks, &image));
        let cycle_obs = cycle_obs.collect();
        let cpu = Rc::new(Cpu {
            schedule: Schedule::new(&image, &blocks),
            technology: Technology::new(&image.config),
            family: if image.s7200.is_some() { &ScanCycle } else { &Step7 },
            s7200: image.s7200.as_ref().map(|own| Box::new(S7200::new(own, &image.config.s7200))),
            assertions: Assertions::new(&image.asserts),
            watcher: OnceCell::new(),
            monitor: Monitor::default(),
            tape: OnceCell::new(),
            cycle: Cell::new(0),
            retention: OnceCell::new(),
            service: RefCell::default(),
            is_served: Cell::new(false),
            has_jobs: Cell::new(false),
            restart_requested: Cell::new(None),
            is_restarted: false,
            restored: Cell::default(),
            retentive_lost: Cell::default(),
            carried: RefCell::default(),
            startup: Cell::new(image.config.startup),
            watchdog: Watchdog::new(&memory),
            memory,
            image,
            code,
            clock,
            driver,
            diagnostics: Diagnostics::default(),
            running: Running::default(),
            stop: Cell::new(None),
            blocks,
            read_only_dbs,
            optimized_dbs,
            created_dbs: RefCell::new(Vec::with_capacity(CREATED_DBS_MAX)),
            load_memory: RefCell::default(),
            diagnostics_changed: Cell::new(false),
            communication: RefCell::default(),
            partners: Partners::default(),
            zone: Cell::default(),
            alarms: RefCell::default(),
            records: RefCell::new(Records::new(Store::temporary())),
            meters: Default::default(),
            force: Force::default(),
            jobs: Jobs::default(),
            enabled: Enabled::default(),
            ob_starts: ObStarts::default(),
            generation: 0,
            outputs_changed: Cell::new(u32::MAX),
            cycle_obs,
        });
        // Who watched the CPU before it was restarted comes again.
        cpu.code.watch(false);
        cpu.memory.set_host64(state::CPU, Rc::as_ptr(&cpu) as u64);
        cpu.load_dbs();
        cpu
    }

    /// The CPU that owns the memory at `mem`.
    ///
    /// # Safety
    /// `mem` is the base of the [`Memory`] of a living `Cpu`.
    pub unsafe fn of<'a>(mem: *mut u8) -> &'a Cpu {
        // SAFETY: `new` stored the address of the `Cpu` there, and it lives as long as its memory.
        unsafe { &*(mem.add(state::CPU as usize).cast::<u64>().read() as *const Cpu) }
    }

    fn load_dbs(&self) {
        for db in self.image.dbs.iter().filter(|db| !db.unlinked) {
            self.memory.load(db.address, &db.data);
            self.memory.set_db(db.number, db.address, db.data.len() as u32);
        }
    }

    /// Where the files of the program are, unless in a folder that goes with the CPU.
    pub fn set_store(&self, store: Store) {
        self.records.replace(Records::new(store));
    }

    /// What a DB of the program has in load memory.
    pub(crate) fn stored(&self, number: u16) -> Option<Vec<u8>> {
        let changed = self.load_memory.borrow().get(&number).cloned();
        changed.or_else(|| Some(self.image.dbs.iter().find(|db| db.number == number)?.data.clone()))
    }

    /// Forgets the load memory of a DB that the program has made. False: there is none.
    pub(crate) fn forget(&self, number: u16) -> bool {
        self.load_memory.borrow_mut().remove(&number).is_some()
    }

    /// Changes what a DB of the program has in load memory.
    pub(crate) fn store(&self, number: u16, data: Vec<u8>) {
        self.load_memory.borrow_mut().insert(number, data);
    }

    /// The bytes of a DB: those the program works with, else those in load memory.
    pub(crate) fn contents(&self, number: u16) -> Option<Vec<u8>> {
        match self.memory.db(number) {
            (_, 0) => self.stored(number),
            (address, length) => Some(self.memory.view(address, length, <[u8]>::to_vec)),
        }
    }

    /// Replaces the bytes of a DB, as [`Self::contents`] has them. False: the DB is write-protected, or has another length.
    pub(crate) fn set_contents(&self, number: u16, data: &[u8]) -> bool {
        match self.memory.db(number) {
            (_, 0) => self.store(number, data.to_vec()),
            (address, length) if length as usize == data.len() && !self.is_read_only(number) => {
                self.memory.load(address, data);
            }
            (..) => return false,
        }
        true
    }

    /// Nanoseconds from one cycle start to the next, unless another time is set.
    pub fn cycle_time(&self) -> u64 {
        let given = self.image.config.cycle_time_ms.map(|ms| u64::from(ms) * NS_PER_MS);
        given.unwrap_or(CYCLE_TIME_DEFAULT.0)
    }

    /// The block of this kind and number.
    pub fn block(&self, kind: BlockKind, number: u16) -> Option<&BlockEntry> {
        self.blocks.get(position(&self.blocks, kind, number)?)
    }

    /// DB `number` is write-protected.
    pub fn is_read_only(&self, number: u16) -> bool {
        is_marked(&self.read_only_dbs, number)
    }

    /// DB `number` has no addresses that a client could name.
    pub fn is_optimized(&self, number: u16) -> bool {
        is_marked(&self.optimized_dbs, number)
    }

    /// The block of a loaded OB.
    pub(crate) fn block_of(&self, ob: &LoadedOb) -> Option<&BlockEntry> {
        self.blocks.get(ob.block)
    }

    /// A loaded OB, with what the runtime looks up for each run.
    pub(crate) fn loaded_ob(&self, ob: u16) -> Option<LoadedOb> {
        self.has_ob(ob).then(|| LoadedOb::new(ob, &self.blocks, &self.image))
    }

    /// Loaded OBs of a class, in the order of their numbers.
    pub(crate) fn obs_of(&self, class: ObClass) -> impl Iterator<Item = u16> {
        obs_of(&self.blocks, &self.image, class)
    }

    pub fn has_ob(&self, number: u16) -> bool {
        self.block(BlockKind::Ob, number).is_some()
    }

    pub fn is_stopped(&self) -> bool {
        self.stop.get().is_some()
    }

    /// Why the CPU went to STOP, if it did.
    pub fn stopped(&self) -> Option<Stop> {
        self.stop.get()
    }

    /// Result for generated code: not 0 means "leave the block at once".
    pub(crate) fn stop_result(&self) -> u32 {
        u32::from(self.is_stopped())
    }

    /// Largest offset of an area's bytes that exists, as (base offset, length).
    pub fn area(&self, area: Area) -> (u32, u32) {
        let profile = &self.image.profile;
        let cut = |bytes: u32| bytes.min(layout::AREA_BYTES);
        match area {
            Area::Inputs => (layout::I, cut(profile.inputs)),
            Area::Outputs => (layout::Q, cut(profile.outputs)),
            Area::BitMemory => (layout::M, cut(profile.bit_memory)),
        }
    }
}

/// Where the block of this kind and number is in `blocks`, which are sorted.
fn position(blocks: &[BlockEntry], kind: BlockKind, number: u16) -> Option<usize> {
    blocks.binary_search_by_key(&(kind, number), |block| (block.kind, block.number)).ok()
}

/// Loaded OBs of a class, in the order of their numbers. From OB 123 on only an S7-1200/1500 has them.
fn obs_of<'a>(blocks: &'a [BlockEntry], image: &'a ProgramImage, class: ObClass) -> impl Iterator<Item = u16> + 'a {
    let portal = image.profile.family.is_portal();
    let obs = blocks.iter().filter(|block| block.kind == BlockKind::Ob).map(|block| block.number);
    obs.filter(move |&ob| (portal || ob < OB_FREE) && image.config.class_of(ob) == Some(class))
}

/// An OB that is loaded, with what depends on its number alone.
#[derive(Clone, Copy)]
pub(crate) struct LoadedOb {
    pub number: u16,
    /// Place of its block among the CPU's.
    block: usize,
    /// Nesting depth that its class allows.
    pub depth_max: u32,
}

impl LoadedOb {
    fn new(number: u16, blocks: &[BlockEntry], image: &ProgramImage) -> LoadedOb {
        LoadedOb {
            number,
            block: position(blocks, BlockKind::Ob, number).unwrap_or(usize::MAX),
            depth_max: image.profile.depth_max(image.config.class_of(number)),
        }
    }
}

/// Areas of fixed extent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Area {
    Inputs,
    Outputs,
    BitMemory,
}
