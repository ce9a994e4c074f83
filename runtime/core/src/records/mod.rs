//! Data logs, recipes and files of a program.
//!
//! A block of the program asks for a job and looks for its end in later calls. Jobs are done in their order at the cycle control
//! point, so runs under the virtual clock are the same.
//!
//! - [`store`]: the folder of the files. [`fields`]: values as columns. [`logs`], [`recipes`]: what the blocks do.

pub mod fields;
pub mod logs;
pub mod recipes;
pub mod store;

use std::collections::VecDeque;

use logs::{Definition, Logs};
use recipes::Place;
use store::{Fault, Store};

use crate::cpu::Cpu;

/// Jobs that wait, and ends of jobs that were not asked for; the oldest go.
const JOBS_MAX: usize = 256;

/// What a block asks for.
pub enum Job {
    CreateLog { name: String, definition: Definition, width: u64 },
    OpenLog { name: String, clear: bool },
    WriteLog { id: u32, record: String },
    CloseLog { id: u32 },
    ClearLog { id: u32 },
    NewLog { id: u32, name: String, records: u32, width: u64 },
    DeleteLog { name: String, id: u32, with_file: bool },
    ExportRecipes(Place),
    ImportRecipes(Place),
    ReadFile { name: String, offset: u32, count: u32 },
    WriteFile { name: String, offset: u32, bytes: Vec<u8> },
    DeleteFile { name: String },
}

/// How a job ended.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Done {
    pub status: u16,
    /// Id of a log, or number of bytes.
    pub value: u32,
    /// Of a file.
    pub bytes: Vec<u8>,
}

/// See the module comment.
pub struct Records {
    store: Store,
    pub logs: Logs,
    waiting: VecDeque<(u32, Job)>,
    done: VecDeque<(u32, Done)>,
    last: u32,
}

impl Records {
    pub fn new(store: Store) -> Records {
        Records { store, logs: Logs::default(), waiting: VecDeque::new(), done: VecDeque::new(), last: 0 }
    }

    /// Takes a job. `None`: too many wait.
    pub fn ask(&mut self, job: Job) -> Option<u32> {
        if self.waiting.len() >= JOBS_MAX {
            return None;
        }
        self.last = self.last.wrapping_add(1);
        self.waiting.push_back((self.last, job));
        Some(self.last)
    }

    /// Numbers of the data blocks that open logs and waiting jobs use.
    pub(crate) fn used_dbs(&self) -> impl Iterator<Item = u16> {
        let jobs = self.waiting.iter().filter_map(|(_, job)| match job {
            Job::CreateLog { definition, .. } => Some(definition.db),
            Job::ExportRecipes(place) | Job::ImportRecipes(place) => Some(place.db),
            _ => None,
        });
        self.logs.used_dbs().chain(jobs)
    }

    pub fn waits(&self, job: u32) -> bool {
        self.waiting.iter().any(|(other, _)| *other == job)
    }

    /// The end of a job, once.
    pub fn take(&mut self, job: u32) -> Option<Done> {
        let at = self.done.iter().position(|(other, _)| *other == job)?;
        self.done.remove(at).map(|(_, done)| done)
    }

    /// Does all jobs that wait.
    #[inline]
    pub fn work(&mut self, cpu: &Cpu) {
        if !self.waiting.is_empty() {
            self.do_jobs(cpu);
        }
    }

    fn do_jobs(&mut self, cpu: &Cpu) {
        while let Some((number, job)) = self.waiting.pop_front() {
            let done = self.perform(cpu, job).unwrap_or_else(|status| Done { status, ..Done::default() });
            if self.done.len() >= JOBS_MAX {
                self.done.pop_front();
            }
            self.done.push_back((number, done));
        }
    }

    fn perform(&mut self, cpu: &Cpu, job: Job) -> Result<Done, u16> {
        let Records { store, logs, .. } = self;
        let value = |value: u32| Ok(Done { value, ..Done::default() });
        let only = |status: u16| Ok(Done { status, ..Done::default() });
        let nothing = |()| Done::default();
        match job {
            Job::CreateLog { name, definition, width } => value(logs.create(store, &name, definition, width)?),
            Job::OpenLog { name, clear } => {
                let (value, was_open) = logs.open(store, &cpu.image.shapes, &name, clear)?;
                let status = if was_open { logs::status::ALREADY_OPEN } else { 0 };
                Ok(Done { status, value, ..Done::default() })
            }
            Job::WriteLog { id, record } => only(if logs.write(store, id, &record)? { logs::status::FULL } else { 0 }),
            Job::CloseLog { id } => only(logs.close(id)),
            Job::ClearLog { id } => logs.clear(store, id).map(nothing),
            Job::NewLog { id, name, records, width } => value(logs.create_like(store, id, &name, records, width)?),
            Job::DeleteLog { name, id, with_file } => logs.delete(store, &name, id, with_file).map(nothing),
            Job::ExportRecipes(place) => recipes::export(store, cpu, place).map(nothing),
            Job::ImportRecipes(place) => recipes::import(store, cpu, place).map(nothing),
            Job::ReadFile { name, offset, count } => {
                if u64::from(offset) > store.length(&name).map_err(file_status)? {
                    return Err(file::OFFSET);
                }
                let bytes = store.read(&name, offset.into(), count.into()).map_err(file_status)?;
                Ok(Done { value: bytes.len() as u32, bytes, ..Done::default() })
            }
            Job::WriteFile { name, offset, bytes } => {
                let length = match store.length(&name) {
                    Err(Fault::Missing) => 0,
                    length => length.map_err(file_status)?,
                };
                if u64::from(offset) > length {
                    return Err(file::OFFSET);
                }
                store.write(&name, offset.into(), &bytes, false).map_err(file_status)?;
                value(bytes.len() as u32)
            }
            Job::DeleteFile { name } => store.remove(&name).map(nothing).map_err(file_status),
        }
    }
}

/// STATUS of FileReadC, FileWriteC, FileDelete.
pub mod file {
    pub const NAME: u16 = 0x8090;
    pub const MISSING: u16 = 0x8092;
    pub const OFFSET: u16 = 0x8093;
    pub const FULL: u16 = 0x80B3;
    pub const DENIED: u16 = 0x80C0;
}

fn file_status(fault: Fault) -> u16 {
    match fault {
        Fault::Name => file::NAME,
        Fault::Missing => file::MISSING,
        Fault::Full => file::FULL,
        Fault::Denied => file::DENIED,
    }
}

/// A line of a CSV file without its end.
fn line(columns: &[String]) -> String {
    let mut writer = csv::WriterBuilder::new().terminator(csv::Terminator::Any(b'\n')).from_writer(Vec::new());
    // Writing to memory does not fail.
    let _ = writer.write_record(columns);
    let text = writer.into_inner().unwrap_or_default();
    String::from_utf8_lossy(&text).trim_end_matches('\n').to_string()
}
