//! A program is changed while it runs: after a cycle control point the cycles are those of the new program.
//!
//! [`plan`] compares two programs and says what data goes where, what is new, what is lost, and whether the change is possible at all; nothing
//! of the CPU is needed for it. [`takeover`] makes the CPU that goes on. A [`Loader`] is the way from another thread to the CPU: it compares
//! there, and the cycle only waits for the copy of the data.
//!
//! Inputs, outputs, bit memory, timers and counters stay where they are. Data blocks are the same by name on an S7-1200/1500, whose numbers the
//! compiler gives, and by number on an S7-300/400; their values by symbolic path, as far as the type is the same.
//!
//! Source: CPU manuals, download in RUN: all blocks of a load are exchanged together at the cycle control point.

mod charts;
mod edges;
mod pairs;
mod plan;
mod takeover;

use std::rc::Rc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use plcc_abi::ProgramImage;
use plcc_abi::image::Config;

use crate::code::Code;
use crate::cpu::Cpu;
use crate::options::RunOptions;
pub use plan::{Item, Plan};

/// Makes the code of a program; it may be asked again, when the program is restored.
pub type CodeSource = Arc<dyn Fn() -> Rc<dyn Code> + Send + Sync>;

/// How long a CPU may take until its next cycle control point.
const ANSWER_TIME: Duration = Duration::from_secs(30);

/// A program with its code.
#[derive(Clone)]
struct Version {
    image: Arc<ProgramImage>,
    code: CodeSource,
}

/// A change that was compared with the running program.
pub struct Prepared {
    plan: Plan,
    image: ProgramImage,
    code: CodeSource,
}

impl Prepared {
    /// What happens to data: what is new, and what is lost.
    pub fn items(&self) -> &[Item] {
        &self.plan.items
    }

    /// Values of the running program go.
    pub fn loses(&self) -> bool {
        self.plan.items.iter().any(|item| item.loses)
    }
}

/// An order to the CPU.
pub(crate) struct Order {
    prepared: Prepared,
    /// Takes what was done besides the plan, or why nothing has changed.
    answer: SyncSender<Result<Vec<String>, String>>,
}

/// Which programs there are.
struct Versions {
    /// `None` before the CPU runs.
    running: Option<Version>,
    before: Option<Version>,
    options: RunOptions,
}

struct Shared {
    versions: Mutex<Versions>,
    /// The CPU looks at it in each cycle, which must cost next to nothing.
    waits: AtomicBool,
    orders: SyncSender<Order>,
}

/// The end of who changes the program, on any thread.
#[derive(Clone)]
pub struct Loader(Arc<Shared>);

/// The end of the CPU.
pub struct Inbox {
    shared: Arc<Shared>,
    orders: Receiver<Order>,
}

/// Both ends of a new way. `code` is that of the program which the CPU begins with, `options` are the flags of the run.
pub fn loader(options: &RunOptions) -> (Loader, Inbox) {
    let (send, orders) = sync_channel(1);
    let versions = Mutex::new(Versions { running: None, before: None, options: options.clone() });
    let shared = Arc::new(Shared { versions, waits: AtomicBool::new(false), orders: send });
    (Loader(shared.clone()), Inbox { shared, orders })
}

impl Shared {
    fn versions(&self) -> MutexGuard<'_, Versions> {
        self.versions.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Loader {
    /// Compares a program with the running one. `Err`: why the change is not possible.
    pub fn prepare(&self, mut image: ProgramImage, code: CodeSource) -> Result<Prepared, String> {
        let (running, options) = {
            let versions = self.0.versions();
            let running = versions.running.clone().ok_or("the CPU has not begun yet")?;
            (running, versions.options.clone())
        };
        options.configure(&mut image.config);
        let plan = Plan::new(running.image, &image)?;
        Ok(Prepared { plan, image, code })
    }

    /// The program that ran before the last change. `Err`: there is none, or the way back is not possible.
    pub fn previous(&self) -> Result<Prepared, String> {
        let before = self.0.versions().before.clone().ok_or("there is no program from before a change")?;
        self.prepare((*before.image).clone(), before.code)
    }

    /// Has the CPU change the program at its next cycle control point. The receiver gets what [`Loader::apply`] returns.
    pub fn order(&self, prepared: Prepared) -> Result<Receiver<Result<Vec<String>, String>>, String> {
        let (answer, done) = sync_channel(1);
        if self.0.orders.try_send(Order { prepared, answer }).is_err() {
            return Err("another change is under way, or the CPU has ended".to_string());
        }
        self.0.waits.store(true, Ordering::Release);
        Ok(done)
    }

    /// Changes the program at the next cycle control point, and waits for it. `Ok`: what else happened, a line each. `Err`: why the old program
    /// goes on.
    pub fn apply(&self, prepared: Prepared) -> Result<Vec<String>, String> {
        match self.order(prepared)?.recv_timeout(ANSWER_TIME) {
            Ok(outcome) => outcome,
            Err(_) => Err("the CPU has ended, or does not come to the end of its cycle".to_string()),
        }
    }
}

impl Inbox {
    /// The CPU begins with this program.
    pub(crate) fn begin(&self, cpu: &Cpu, code: CodeSource) {
        self.shared.versions().running = Some(Version { image: Arc::clone(&cpu.image), code });
    }

    /// A change waits.
    #[inline]
    pub(crate) fn waits(&self) -> bool {
        self.shared.waits.load(Ordering::Relaxed)
    }

    /// Carries out what waits; `cpu` is then the one that goes on. Result: whether something waited, and whether the program has changed.
    ///
    /// # Panics
    /// If the CPU has another owner.
    pub(crate) fn carry_out(&self, cpu: &mut Rc<Cpu>) -> (bool, bool) {
        self.shared.waits.store(false, Ordering::Relaxed);
        let Order { prepared, answer } = match self.orders.try_recv() {
            Ok(order) => order,
            Err(TryRecvError::Empty | TryRecvError::Disconnected) => return (true, false),
        };
        // Who asked may have gone.
        let say = |outcome| drop(answer.try_send(outcome));
        let Prepared { plan, image, code } = prepared;
        if !Arc::ptr_eq(&plan.old, &cpu.image) {
            say(Err("the program has changed meanwhile: compare again".to_string()));
            return (true, false);
        }
        if let Err(why) = plan.check(cpu) {
            say(Err(why));
            return (true, false);
        }
        let lines = Cpu::take_over(cpu, &plan, image, code());
        let mut versions = self.shared.versions();
        let running = Version { image: Arc::clone(&cpu.image), code };
        versions.before = versions.running.replace(running);
        drop(versions);
        say(Ok(lines));
        (true, true)
    }
}

/// What of two configurations a program cannot change while it runs.
fn fixed(config: &Config) -> Config {
    let mut config = config.clone();
    config.services.drawings = Vec::new();
    // A program that is loaded has no code with probes.
    config.services.probes = None;
    config
}
