//! Restarts within a run: a CPU in STOP goes to RUN again because a client asks for it.
//!
//! Memory that a restart clears is as in a CPU that was just made. So the CPU that stopped hands over what outlasts a
//! restart (retentive memory, clock, diagnostic buffer, modules, clients) to a new one with the same program.
//!
//! Source: CPU manuals, operating modes; S7-200 system manual, which keeps all of its memory from STOP to RUN.

use std::cell::RefCell;
use std::rc::Rc;

use plcc_abi::image::Family;

use crate::cpu::{Area, Cpu};
use crate::diagnostics::{self, NO_SITE};
use crate::events::StartInfo;
use crate::options::Restart;
use crate::retain::{Items, Restored};

/// Startup OBs.
pub(crate) const WARM: u16 = 100;
pub(crate) const HOT: u16 = 101;
pub(crate) const COLD: u16 = 102;

/// What the CPU before has left.
pub(crate) struct Carried {
    /// Retentive memory, as a file has it.
    pub(crate) retentive: Vec<u8>,
    /// Parts of memory that stay as they are: offset and bytes.
    parts: Vec<(u32, Vec<u8>)>,
    /// Data blocks that the program has made: number, offset and bytes.
    created: Vec<(u16, u32, Vec<u8>)>,
}

impl Carried {
    fn of(cpu: &Cpu) -> Carried {
        let mut retentive = Vec::new();
        Items::of(cpu, false).collect(cpu, &mut retentive);
        let areas: &[Area] = match cpu.image.profile.family {
            Family::S7200 => &[Area::BitMemory, Area::Outputs],
            Family::S7300 | Family::S7400 | Family::S71200 | Family::S71500 => &[],
        };
        let part = |area: &Area| {
            let (base, length) = cpu.area(*area);
            (base, cpu.memory.view(base, length, <[u8]>::to_vec))
        };
        let created = cpu.created_dbs.borrow();
        let block = |&(number, at, bytes): &(u16, u32, u32)| (number, at, cpu.memory.view(at, bytes, <[u8]>::to_vec));
        Carried { retentive, parts: areas.iter().map(part).collect(), created: created.iter().map(block).collect() }
    }

    /// Brings back what is not retentive and stays nevertheless.
    pub(crate) fn load_parts(&self, cpu: &Cpu) {
        self.parts.iter().for_each(|(base, bytes)| cpu.memory.load(*base, bytes));
        for (number, at, data) in &self.created {
            let bytes = data.len() as u32;
            cpu.memory.load(*at, data);
            cpu.memory.set_db(*number, *at, bytes);
            cpu.created_dbs.borrow_mut().push((*number, *at, bytes));
        }
    }
}

impl Cpu {
    /// A client asks for RUN; the CPU must be in STOP. False: this CPU has no such restart.
    pub fn request_restart(&self, kind: Restart) -> bool {
        let possible = match kind {
            Restart::Warm => true,
            Restart::Cold => self.image.profile.family.has_cold_restart(),
            Restart::Hot | Restart::Reset => false,
        };
        if possible {
            self.restart_requested.set(Some(kind));
        }
        possible
    }

    /// A client asks for a memory reset. `Err`: why not.
    pub fn request_memory_reset(&self) -> Result<(), String> {
        if self.image.profile.family == Family::S7200 {
            return Err("an S7-200 has no memory reset that leaves its program: `Clear` deletes that too".to_string());
        }
        if !self.is_stopped() {
            return Err("the CPU is in RUN: a memory reset is possible in STOP only".to_string());
        }
        self.restart_requested.set(Some(Restart::Reset));
        Ok(())
    }

    /// The CPU after a memory reset, in STOP as before: all data has its start values, also what is retentive and what is kept in a file.
    /// Source: CPU manuals, memory reset.
    ///
    /// # Panics
    /// As [`Cpu::restarted`].
    pub(crate) fn after_reset(cpu: Rc<Cpu>) -> Rc<Cpu> {
        let stop = cpu.stop.get();
        let next = Cpu::restarted(cpu, Restart::Reset);
        next.stop.set(stop);
        // The file gets the start values: it must not bring back what was before, if the process ends now.
        next.carried.replace(Some(Carried::of(&next)));
        next.power_on_retentive();
        next.keep_retentive(true);
        next.reset_force();
        next.log(diagnostics::MEMORY_RESET, NO_SITE, 0);
        next
    }

    /// The CPU that goes on in place of one that has stopped.
    ///
    /// # Panics
    /// If the CPU has another owner.
    pub(crate) fn restarted(cpu: Rc<Cpu>, kind: Restart) -> Rc<Cpu> {
        cpu.end_enabling();
        let carried = (kind == Restart::Warm).then(|| Carried::of(&cpu));
        let stopped = Rc::into_inner(cpu).expect("only the run owns its CPU");
        // The rest ends here, with its threads, files and connections.
        let Cpu { image, code, clock, driver, diagnostics, service, alarms, force, generation, meters, .. } = stopped;
        let mut next = Cpu::new(image, code, clock, driver);
        let own = Rc::get_mut(&mut next).expect("it was just made");
        own.diagnostics = diagnostics;
        own.alarms = RefCell::new(alarms.into_inner().restarted());
        own.is_served.set(service.borrow().is_some());
        own.partners.attach(service.borrow().as_ref().and_then(|service| service.board()));
        own.service = service;
        own.carried = RefCell::new(carried);
        own.is_restarted = true;
        own.generation = generation;
        own.force = force;
        // Jobs of clients end with the restart.
        own.set_modifying(false);
        // They count on whatever the restart clears.
        own.meters = meters;
        own.startup.set(match kind {
            Restart::Cold => COLD,
            Restart::Warm | Restart::Hot | Restart::Reset => WARM,
        });
        next
    }
}

/// What a startup OB of an S7-1200/1500 gets in byte 4 of its start information, which its input parameters come from.
pub(crate) mod retained {
    /// Retentive data came back.
    pub(crate) const REMANENCE: u8 = 1;
    /// Retentive data was lost.
    pub(crate) const LOST: u8 = 2;
}

impl Cpu {
    /// STRT_INFO of OB 100 to OB 102, and the event of the last STOP. Source: System and standard functions, OB 100 to OB 102; System Software
    /// for S7-300/400, volume 1.
    pub(crate) fn startup_info_of_step7(&self, info: StartInfo, automatic: bool) -> StartInfo {
        /// The clock of the host runs without the CPU.
        const CLOCK_BACKED_UP: u32 = 1 << 27;
        let has_memory = self.restored.get() == Restored::Whole || self.is_restarted;
        let ob = self.startup.get();
        let this: u32 = match (automatic, ob, has_memory) {
            (true, HOT, _) => 0xA0,
            (true, COLD, true) => 0x11,
            (true, COLD, false) => 0x21,
            (true, _, true) => 0x10,
            (true, _, false) => 0x20,
            (false, HOT, _) => 0x0C,
            (false, COLD, _) => 0x08,
            (false, _, true) => 0x14,
            (false, _, false) => 0x24,
        };
        // Which restarts are allowed, of each kind: warm ones; of an S7-400 also hot ones.
        let allowed = if self.image.profile.family == Family::S7400 { 0xFF } else { 0x77 };
        let stop = self.diagnostics.newest_first().into_iter().find(|entry| is_stop(entry.event));
        info.word(6, stop.map_or(0, |entry| entry.event)).dword(8, CLOCK_BACKED_UP | this << 16 | allowed << 8 | this)
    }

    /// See [`retained`].
    pub(crate) fn startup_info_of_portal(&self, info: StartInfo) -> StartInfo {
        let restored = if self.is_restarted { Restored::Whole } else { self.restored.get() };
        info.byte(
            4,
            match restored {
                Restored::Whole => retained::REMANENCE,
                Restored::Lost if self.retentive_lost.get() => retained::LOST,
                Restored::Lost | Restored::NotKept => 0,
            },
        )
    }
}

/// An event that puts a CPU into STOP.
fn is_stop(event: u16) -> bool {
    matches!(event, 0x4303 | 0x4304 | 0x430D | 0x4540..=0x457F)
}
