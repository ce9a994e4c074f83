//! What passes that work on one function at a time know of the rest of the program, and how they run on all functions.
//!
//! Functions do not depend on each other in such a pass, so threads share them out, the largest first. Several passes
//! in a row run on one function before the next: its code stays in the cache of the processor.

use std::sync::Mutex;
use std::sync::PoisonError;

use plcc_abi::layout;
use plcc_ir::entities::EntityVec;
use plcc_ir::{Areas, FuncId, Function, Module, Region, StaticDb};

use crate::effects::Effects;
use crate::frames::{Callees, CallerReads, Frames};

/// The facts about a module that hold while its functions are optimised one by one.
pub struct Surroundings {
    /// Sorted by number.
    pub dbs: Vec<StaticDb>,
    /// The same DBs, sorted by address.
    pub dbs_by_address: Vec<StaticDb>,
    pub areas: Areas,
    /// What runs at safepoints and errors.
    pub effects: Effects,
    callees: Callees,
}

impl Surroundings {
    pub fn new(module: &Module) -> Surroundings {
        let mut dbs_by_address = module.dbs.clone();
        dbs_by_address.sort_by_key(|db| db.address);
        Surroundings {
            dbs: module.dbs.clone(),
            dbs_by_address,
            areas: module.areas,
            effects: Effects::new(module),
            callees: Callees::new(module),
        }
    }

    /// Who can reach the frame of `function`, as it is.
    pub fn frames(&self, function: &Function) -> Frames<'_> {
        Frames::new(function, &self.callees)
    }

    /// True if a call of `callee` may read or write the frame of its caller.
    pub fn touches_caller(&self, callee: FuncId) -> bool {
        self.callees.touches_caller(callee)
    }

    /// What a call of `callee` reads of the frame of its caller.
    pub fn caller_reads(&self, callee: FuncId) -> &CallerReads {
        self.callees.caller_reads(callee)
    }

    /// Where a region is, as offsets from the memory base in bits.
    pub fn extent_of(&self, region: Region) -> (u64, u64) {
        let area = |start: u32| (u64::from(start) * 8, u64::from(start + layout::AREA_BYTES) * 8);
        match region {
            Region::I => area(layout::I),
            Region::Q => area(layout::Q),
            Region::M => area(layout::M),
            Region::System => area(layout::SYSTEM),
            Region::L | Region::V => (u64::from(layout::L) * 8, u64::from(layout::DB_DATA) * 8),
            Region::Db(number) => match self.dbs.binary_search_by_key(&number, |db| db.number) {
                Ok(index) => {
                    let db = &self.dbs[index];
                    (u64::from(db.address) * 8, (u64::from(db.address) + u64::from(db.length)) * 8)
                }
                Err(_) => (0, u64::MAX),
            },
            Region::AnyDb => (u64::from(layout::DB_DATA) * 8, u64::MAX),
            Region::State | Region::Cells | Region::Any => (0, u64::MAX),
        }
    }
}

/// Programs with fewer instructions are optimised before a thread has started.
const SHARED_INSTS_MIN: usize = 20_000;

/// Stack of a thread, only touched as far as needed.
const STACK_BYTES: usize = 64 << 20;

/// Calls `work` with each function, on all processors.
pub fn for_each(functions: &mut EntityVec<FuncId, Function>, work: &(dyn Fn(&mut Function) + Sync)) {
    let total: usize = functions.values().map(|function| function.insts.len()).sum();
    let threads = std::thread::available_parallelism().map_or(1, |count| count.get()).min(functions.len());
    if threads <= 1 || total < SHARED_INSTS_MIN {
        functions.values_mut().for_each(work);
        return;
    }
    let mut order: Vec<&mut Function> = functions.values_mut().collect();
    // The next one is taken from the end.
    order.sort_by_key(|function| function.insts.len());
    let waiting = Mutex::new(order);
    // A thread that panicked ends the program when it is joined.
    let next = || waiting.lock().unwrap_or_else(PoisonError::into_inner).pop();
    let share = || {
        while let Some(function) = next() {
            work(function);
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..threads {
            // Without a further thread it only takes longer.
            let _ = std::thread::Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, share);
        }
        share();
    });
}
