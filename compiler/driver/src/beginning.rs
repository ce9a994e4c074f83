//! Lowering, with the first passes at the same time.
//!
//! Code as it is lowered takes twice the memory that it takes after the first passes. So functions go through these as soon as they are
//! made: in a large program another thread has that work, and the lowering thread helps where too many functions wait.

use std::sync::mpsc::{SyncSender, TrySendError, sync_channel};
use std::thread::{Builder, Scope, ScopedJoinHandle};

use plcc_diag::SourceMap;
use plcc_ir::entities::EntityVec;
use plcc_ir::{FuncId, Function};
use plcc_lower::Lowered;
use plcc_model::Program;
use plcc_opt::Without;

/// Programs with fewer instructions are done before a thread has started.
const SHARED_INSTS_MIN: usize = 20_000;

/// At most this many functions wait for the other thread.
const WAITING_MAX: usize = 8;

/// Lowers a program that was bound without errors; its functions have been through [`plcc_opt::begin`].
pub fn lower(program: &Program, sources: &SourceMap, without: Without) -> Lowered {
    std::thread::scope(|scope| {
        let mut begun = Begun { without, count: 0, insts: 0, own: Vec::new(), other: None };
        let mut lowered = plcc_lower::lower_each(program, sources, &mut |function| begun.take(scope, function));
        lowered.module.functions = begun.finish();
        lowered
    })
}

/// The functions so far.
struct Begun<'scope> {
    without: Without,
    count: usize,
    /// Instructions of all of them, as lowered.
    insts: usize,
    /// Those of this thread, with their numbers.
    own: Vec<(usize, Function)>,
    other: Option<Other<'scope>>,
}

/// The thread that helps.
struct Other<'scope> {
    waiting: SyncSender<(usize, Function)>,
    thread: ScopedJoinHandle<'scope, Vec<(usize, Function)>>,
}

impl<'scope> Begun<'scope> {
    fn take(&mut self, scope: &'scope Scope<'scope, '_>, function: Function) {
        self.insts += function.insts.len();
        if self.other.is_none() && self.insts > SHARED_INSTS_MIN {
            self.other = Other::start(scope, self.without);
        }
        let mut item = (self.count, function);
        self.count += 1;
        if let Some(other) = &self.other {
            item = match other.waiting.try_send(item) {
                Ok(()) => return,
                Err(TrySendError::Full(item) | TrySendError::Disconnected(item)) => item,
            };
        }
        plcc_opt::begin(&mut item.1, self.without);
        self.own.push(item);
    }

    /// All functions, in order.
    fn finish(self) -> EntityVec<FuncId, Function> {
        let mut all = self.own;
        if let Some(Other { waiting, thread }) = self.other {
            // No more will come.
            drop(waiting);
            match thread.join() {
                Ok(others) => all.extend(others),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        all.sort_unstable_by_key(|&(number, _)| number);
        let mut functions = EntityVec::with_capacity(all.len());
        for (_, function) in all {
            functions.push(function);
        }
        functions
    }
}

impl<'scope> Other<'scope> {
    /// `None`: there is only one processor, or the system gives no thread; then it only takes longer.
    fn start(scope: &'scope Scope<'scope, '_>, without: Without) -> Option<Other<'scope>> {
        if std::thread::available_parallelism().map_or(1, |count| count.get()) == 1 {
            return None;
        }
        let (waiting, next) = sync_channel::<(usize, Function)>(WAITING_MAX);
        let work = move || {
            let mut done = Vec::new();
            while let Ok((number, mut function)) = next.recv() {
                plcc_opt::begin(&mut function, without);
                done.push((number, function));
            }
            done
        };
        let thread = Builder::new().stack_size(crate::COMPILE_STACK_BYTES).spawn_scoped(scope, work).ok()?;
        Some(Other { waiting, thread })
    }
}
