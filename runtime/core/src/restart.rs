//! Restarts within a run: a CPU in STOP goes to RUN again because a client asks for it.
//!
//! What a restart clears is the memory of a CPU that was just made. So the CPU that stopped hands over what outlasts a restart (retentive memory,
//! clock, diagnostic buffer, modules, clients) to a new one with the same program.
//!
//! Source: CPU manuals, operating modes; S7-200 system manual, which keeps all of its memory from STOP to RUN.

use std::cell::RefCell;
use std::rc::Rc;

use plcc_abi::image::Family;

use crate::cpu::{Area, Cpu};
use crate::options::Restart;
use crate::retain::Items;

/// What the CPU before has left.
pub(crate) struct Carried {
    /// Retentive memory, as a file has it.
    pub(crate) retentive: Vec<u8>,
    /// Parts of memory that stay as they are: offset and bytes.
    parts: Vec<(u32, Vec<u8>)>,
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
        Carried { retentive, parts: areas.iter().map(part).collect() }
    }

    /// Brings back what is not retentive and stays nevertheless.
    pub(crate) fn load_parts(&self, cpu: &Cpu) {
        self.parts.iter().for_each(|(base, bytes)| cpu.memory.load(*base, bytes));
    }
}

impl Cpu {
    /// A client asks for RUN; the CPU must be in STOP. False: this CPU has no such restart.
    pub fn request_restart(&self, kind: Restart) -> bool {
        let possible = match kind {
            Restart::Warm => true,
            Restart::Cold => self.image.profile.family != Family::S7200,
            Restart::Hot | Restart::Reset => false,
        };
        if possible {
            self.restart_requested.set(Some(kind));
        }
        possible
    }

    /// The CPU that goes on in place of one that has stopped.
    ///
    /// # Panics
    /// If the CPU has another owner.
    pub(crate) fn restarted(cpu: Rc<Cpu>, kind: Restart) -> Rc<Cpu> {
        let carried = (kind == Restart::Warm).then(|| Carried::of(&cpu));
        let stopped = Rc::into_inner(cpu).expect("only the run owns its CPU");
        // The rest ends here, with its threads, files and connections.
        let Cpu { image, code, clock, driver, diagnostics, service, alarms, force, generation, .. } = stopped;
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
        own.startup.set(match kind {
            Restart::Cold => 102,
            Restart::Warm | Restart::Hot | Restart::Reset => 100,
        });
        next
    }
}
