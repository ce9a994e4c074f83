//! Jobs of clients that modify values in the cycle: once or in every cycle, at its beginning or its end.
//!
//! A client has one job. It ends when all of its values were to be written once, when the client ends it or goes, with a restart and with a
//! change of the program; what it has written stays. A value that is written outside of a cycle needs no job.
//!
//! Source: Programming with STEP 7, 20.4: trigger points and frequency of modifying.

use std::cell::RefCell;

use crate::address::Place;
use crate::cpu::Cpu;
use crate::watch::{Settled, Trigger};

/// Values of one job. Source: technical data of the CPUs, variables of a job; that of an S7-1500 is the largest.
pub const ROWS_MAX: usize = 200;

/// The jobs of all clients.
#[derive(Default)]
pub(crate) struct Jobs {
    list: RefCell<Vec<Job>>,
}

struct Job {
    client: u64,
    rows: Vec<Row>,
}

/// A value that is to be written.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub settled: Settled,
    pub trigger: Trigger,
    /// Else once.
    pub every_cycle: bool,
}

impl Cpu {
    /// Whether a value may be modified by a client here. `Err`: why not.
    pub fn check_modifiable(&self, settled: &Settled) -> Result<(), String> {
        self.check_address(&settled.address)?;
        settled.address.check_settable()?;
        self.check_enabled(settled.address.place)?;
        match settled.address.place {
            Place::Db(number, _) if self.is_read_only(number) => Err(format!("DB {number} is write-protected")),
            _ => Ok(()),
        }
    }

    /// Begins the job of a client in place of the one that it has; without rows that ends. Only between two cycles. `Err`: why not; the job
    /// before goes on then.
    pub fn begin_job(&self, client: u64, rows: Vec<Row>) -> Result<(), String> {
        if rows.len() > ROWS_MAX {
            return Err(format!("{} values are to be modified in the cycle; {ROWS_MAX} are possible", rows.len()));
        }
        if !rows.is_empty() && self.is_stopped() {
            return Err("the CPU is in STOP, which has no cycle: modify at once".to_string());
        }
        if !rows.is_empty() && self.tape().is_some() {
            return Err("while the run is recorded or repeated, values can only be modified at once".to_string());
        }
        rows.iter().try_for_each(|row| self.check_modifiable(&row.settled))?;
        for row in &rows {
            // What is not modified comes from the module again.
            self.name_input(&row.settled.address);
        }
        let mut list = self.jobs.list.borrow_mut();
        list.retain(|job| job.client != client);
        if !rows.is_empty() {
            list.push(Job { client, rows });
        }
        self.set_modifying(!list.is_empty());
        Ok(())
    }

    /// Values that the job of a client still writes.
    pub fn job_rows(&self, client: u64) -> usize {
        self.jobs.list.borrow().iter().find(|job| job.client == client).map_or(0, |job| job.rows.len())
    }

    /// Writes what is due at a trigger of a cycle. Of values that overlap the last one counts.
    pub(crate) fn carry_out_jobs(&self, trigger: Trigger) {
        let mut list = self.jobs.list.borrow_mut();
        for job in list.iter_mut() {
            job.rows.retain(|row| {
                let is_due = row.trigger == trigger;
                if is_due {
                    // Checked when the job began; a DB may be gone.
                    let _ = self.modify(&row.settled.address, row.settled.bits);
                }
                !is_due || row.every_cycle
            });
        }
        list.retain(|job| !job.rows.is_empty());
        self.set_modifying(!list.is_empty());
    }
}
