//! Retentive memory: what a CPU keeps without power is kept in a file, from one process to the next.
//!
//! A copy of retentive memory is made between two cycles, so it is that of one completed cycle. It is written to the file by a
//! [thread](writer) that the cycle never waits for, as often as `every` says, or by the cycle itself if each cycle counts. When the CPU goes to
//! STOP or the run ends, the last copy is written before the process ends. Writing goes on after it has failed once, also
//! if the file could not be opened at the start; what can be read of it then comes back nevertheless.
//!
//! Sources: CPU manuals, retentive memory and restart types; S7-200 system manual, storing and restoring data.

mod family;
mod items;
mod late;
mod numbers;
mod places;
mod references;
mod slots;
mod writer;

use std::cell::{Cell, RefCell};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use plcc_abi::image::{Family, RetainInterval};

use crate::cpu::Cpu;
use crate::diagnostics::{self, NO_SITE};
use crate::restart::{COLD, HOT, WARM};
use crate::s7200::errors::INTERNAL_ERROR;
pub(crate) use items::Items;
use items::{Loaded, Refused};
use late::{LateFile, Opened};
use slots::{Content, Fault};
use writer::Writer;

/// Whether the data of a CPU came back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Restored {
    /// No file is named.
    #[default]
    NotKept,
    /// There is none, or it is of no use.
    Lost,
    Whole,
}

/// The retentive memory of a CPU that keeps it.
pub(crate) struct Retention {
    path: PathBuf,
    items: Items,
    interval: RetainInterval,
    writer: RefCell<Writer>,
    /// The content last handed over, and the one being made.
    written: RefCell<Vec<u8>>,
    next: RefCell<Vec<u8>>,
    last: Cell<Option<Instant>>,
    /// The last copy could not be written, and this was reported.
    failed: Cell<bool>,
}

/// Keeps what the file has beside it: it is overwritten at once, and the user may have named the wrong file or program. Result: what to add
/// to a message.
fn keep_before(path: &Path) -> String {
    let mut name = path.as_os_str().to_os_string();
    name.push(".old");
    let old = PathBuf::from(name);
    match slots::check(&old).is_ok() && std::fs::copy(path, &old).is_ok() {
        true => format!("; its old contents are kept in {}", old.display()),
        false => String::new(),
    }
}

/// How long a process waits at its start for the one before to end, and how often it looks.
const WAIT_FOR_FILE: Duration = Duration::from_secs(2);
const LOOK_FOR_FILE: Duration = Duration::from_millis(20);

/// Opens the file. A process that takes the place of another may begin before that has ended.
fn open(path: &Path) -> Result<Opened, Fault> {
    let end = Instant::now() + WAIT_FOR_FILE;
    loop {
        match LateFile::open(path) {
            Err(Fault::InUse) if Instant::now() < end => std::thread::sleep(LOOK_FOR_FILE),
            opened => return opened,
        }
    }
}

/// Names for a message; `None`: there are none.
fn listed(names: &[String]) -> Option<String> {
    /// Others are counted only.
    const NAMES_MAX: usize = 10;
    match names {
        [] => None,
        _ if names.len() <= NAMES_MAX => Some(names.join(", ")),
        _ => Some(format!("{} and {} more", names[..NAMES_MAX].join(", "), names.len() - NAMES_MAX)),
    }
}

/// A message to the user; a closed standard error changes nothing.
fn say(text: &str) {
    crate::run::say!("runtime: {text}");
}

impl Cpu {
    /// Whether the file of retentive memory can be one. `Err`: why not.
    pub(crate) fn check_retentive_file(&self) -> Result<(), String> {
        let Some(path) = &self.image.config.retain.file else { return Ok(()) };
        match slots::check(Path::new(path)) {
            // Any other error is reported when the file is opened, and the CPU runs without it.
            Ok(()) | Err(Fault::Host(_) | Fault::InUse) => Ok(()),
            Err(Fault::Foreign(text)) => Err(format!("{text}; name another file for retentive memory")),
        }
    }

    /// The CPU is switched on: memory gets what was kept, as the kind of restart says.
    pub(crate) fn power_on_retentive(&self) -> Restored {
        let restored = self.bring_retentive_back();
        self.restored.set(restored);
        restored
    }

    fn bring_retentive_back(&self) -> Restored {
        let carried = self.carried.take();
        if let Some(carried) = &carried {
            carried.load_parts(self);
        }
        let Some(path) = self.image.config.retain.file.as_deref().map(Path::new) else {
            if let Some(carried) = &carried {
                // It is of this program, and whole.
                let _ = Items::of(self, false).load(self, &carried.retentive);
            }
            return Restored::NotKept;
        };
        let Opened { mut file, content, error, is_lost } = match open(path) {
            Ok(opened) => opened,
            Err(fault) => {
                let fault = match fault {
                    Fault::InUse => format!("{} is in use by another process", path.display()),
                    Fault::Foreign(text) => text,
                    Fault::Host(error) => format!("cannot use {}: {error}", path.display()),
                };
                say(&format!("nothing is retentive in this run: {fault}"));
                self.log(diagnostics::RETAIN_NOT_WRITTEN, NO_SITE, 0);
                self.refuse_hot_restart("there is no retentive memory");
                return Restored::Lost;
            }
        };
        let told = error.as_ref().filter(|_| is_lost && !self.is_restarted);
        if let Some(error) = told {
            let path = path.display();
            let what = format!("{path} can neither be read nor written: {error}");
            self.note_lost(&format!(
                "{what}; all data begins with its start values, and nothing is kept until it can be written"
            ));
        }
        let is_told = told.is_some();
        let config = &self.image.config.retain;
        let is_s7400 = self.image.profile.family == Family::S7400;
        let hot = is_s7400 && self.startup.get() == HOT;
        // A client or a flag may have asked for another restart than the one that comes next time.
        let items = Items::of(self, hot || is_s7400 && (self.image.config.startup == HOT || config.for_hot));
        let content = carried.map_or(content, |carried| Content::Whole(carried.retentive));
        let restored = self.bring_back(path, &Items::of(self, hot), content);
        // Cycles are not to wait for a file that must be made.
        let mut first = Vec::new();
        items.collect(self, &mut first);
        let made = match error {
            Some(error) => Err(error),
            None if file.is_short_for(first.len()) => file.write(&first),
            None => Ok(()),
        };
        let retention = Retention {
            path: path.to_path_buf(),
            items,
            interval: config.interval,
            writer: RefCell::new(Writer::new(file, config.interval)),
            written: RefCell::default(),
            next: RefCell::default(),
            last: Cell::new(None),
            failed: Cell::new(false),
        };
        if is_told && made.is_err() {
            retention.failed.set(true);
            self.log(diagnostics::RETAIN_NOT_WRITTEN, NO_SITE, 0);
        } else {
            retention.note(self, made.is_err().then_some(made));
        }
        // Once for each CPU: it is switched on once.
        let _ = self.retention.set(retention);
        restored
    }

    fn bring_back(&self, file: &Path, items: &Items, content: Content) -> Restored {
        let path = file.display();
        let restored = match (content, self.startup.get()) {
            (_, _) if self.image.config.retain.reset && !self.is_restarted => {
                self.log(diagnostics::MEMORY_RESET, NO_SITE, 0);
                Restored::Lost
            }
            (Content::Nothing, _) => Restored::Lost,
            (Content::Damaged, _) => {
                self.note_lost(&format!("{path} is damaged: all data begins with its start values"));
                Restored::Lost
            }
            (Content::Whole(_), COLD) => Restored::Lost,
            (Content::Whole(content), _) => match items.load(self, &content) {
                Ok(loaded) => self.note_loaded(file, &loaded),
                Err(Refused::Damaged) => {
                    self.note_lost(&format!("{path} is incomplete: all data begins with its start values"));
                    Restored::Lost
                }
                Err(Refused::Program(why)) => {
                    let kept = keep_before(file);
                    self.note_lost(&format!("{path} {why}: all data begins with its start values{kept}"));
                    Restored::Lost
                }
            },
        };
        if restored == Restored::Lost {
            self.refuse_hot_restart("no state of this program was kept");
        }
        restored
    }

    /// What was kept does not come back.
    fn note_lost(&self, text: &str) {
        say(text);
        self.log(diagnostics::RETAIN_LOST, NO_SITE, 0);
        self.retentive_lost.set(true);
    }

    fn note_loaded(&self, file: &Path, loaded: &Loaded) -> Restored {
        let path = file.display();
        let is_lost = !loaded.changed.is_empty() || !loaded.gone.is_empty() || loaded.references > 0;
        let kept = if is_lost { keep_before(file) } else { String::new() };
        for &number in &loaded.changed {
            let name = self.image.dbs.iter().find(|db| db.number == number).map_or("", |db| db.name.as_str());
            let named = if name.is_empty() { String::new() } else { format!(" \"{name}\"") };
            let why = match self.image.profile.family {
                Family::S7200 => "V memory begins with the values of the data block, which differs from the one in",
                _ => "begins with its start values: its layout differs from the one in",
            };
            match self.image.profile.family {
                Family::S7200 => say(&format!("{why} {path}{kept}")),
                _ => say(&format!("DB {number}{named} {why} {path}{kept}")),
            }
            self.log(diagnostics::RETAIN_CHANGED, NO_SITE, number.into());
        }
        match loaded.references {
            0 => {}
            1 => say(&format!(
                "a reference begins with its initial value: its data block is not the one in {path}{kept}"
            )),
            n => say(&format!(
                "{n} references begin with their initial values: their data blocks are not those in {path}{kept}"
            )),
        }
        if let Some(names) = listed(&loaded.gone) {
            say(&format!("{path} has values of {names}, which the program does not have: they are left out{kept}"));
        }
        if self.startup.get() == HOT && !loaded.complete {
            self.refuse_hot_restart("the program has changed, or its state was kept for a warm restart");
        }
        Restored::Whole
    }

    /// Only what was interrupted can go on: without its state an S7-400 makes a warm restart.
    fn refuse_hot_restart(&self, why: &str) {
        if self.startup.get() == HOT && self.image.profile.family == Family::S7400 {
            say(&format!("no hot restart: {why}; warm restart"));
            self.startup.set(WARM);
        }
    }

    /// A cycle is complete; with `finally`, the run ends.
    #[inline]
    pub(crate) fn keep_retentive(&self, finally: bool) {
        if let Some(retention) = self.retention.get() {
            retention.keep(self, finally);
        }
    }
}

impl Retention {
    /// Keeps the memory of a CPU with a changed program in the same file.
    pub(crate) fn with_items_of(mut self, cpu: &Cpu) -> Retention {
        self.items = Items::of(cpu, self.items.is_everything());
        // The next copy is written, whatever it is.
        self.written.get_mut().clear();
        self
    }

    fn keep(&self, cpu: &Cpu, finally: bool) {
        // What a fault of plcc itself has left is not to come back.
        let damaged = cpu.stopped().is_some_and(|stop| stop.entry.event == INTERNAL_ERROR);
        if damaged || !finally && !self.is_time() {
            return;
        }
        let mut writer = self.writer.borrow_mut();
        self.note(cpu, writer.outcome());
        if writer.is_busy() && !finally {
            return;
        }
        let mut next = self.next.borrow_mut();
        self.items.collect(cpu, &mut next);
        let mut written = self.written.borrow_mut();
        // Time alone is not a change.
        let same = |one: &[u8], other: &[u8]| {
            one.first() == other.first() && one.get(items::TIME.end..) == other.get(items::TIME.end..)
        };
        if self.failed.get() || !same(&written, &next) || finally {
            std::mem::swap(&mut *written, &mut *next);
            writer.write(&written);
        }
        if finally {
            let outcome = writer.finish();
            self.note(cpu, outcome);
        }
    }

    fn is_time(&self) -> bool {
        match self.interval {
            RetainInterval::Cycle => true,
            RetainInterval::Milliseconds(ms) => {
                let now = Instant::now();
                let due =
                    self.last.get().is_none_or(|last| now.duration_since(last) >= Duration::from_millis(ms.into()));
                if due {
                    self.last.set(Some(now));
                }
                due
            }
        }
    }

    /// Reports that writing has failed, and that it works again.
    fn note(&self, cpu: &Cpu, outcome: Option<std::io::Result<()>>) {
        match outcome {
            Some(Err(error)) if !self.failed.replace(true) => {
                say(&format!("cannot write retentive memory to {}: {error}", self.path.display()));
                cpu.log(diagnostics::RETAIN_NOT_WRITTEN, NO_SITE, 0);
            }
            Some(Ok(())) if self.failed.replace(false) => {
                say(&format!("retentive memory is written to {} again", self.path.display()));
                cpu.log(diagnostics::RETAIN_WRITTEN, NO_SITE, 0);
            }
            Some(_) | None => {}
        }
    }
}
