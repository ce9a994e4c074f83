//! The CPU that goes on with a new program: it has everything of the CPU before it except the program and its data
//! blocks.

use std::cell::OnceCell;
use std::rc::Rc;

use plcc_abi::ProgramImage;
use plcc_abi::image::Site;
use plcc_abi::layout::{self, area, state};
use plcc_abi::s7200::system;

use super::pairs::{Move, Pointer};
use super::plan::Plan;
use crate::clock::Clock;
use crate::code::Code;
use crate::cpu::Cpu;
use crate::diagnostics::{self, NO_SITE};
use crate::io::Simulated;
use crate::memory::Memory;

impl Cpu {
    /// Puts a CPU with a new program in the place of `cpu`, between two cycles. Result: what was not taken over, a line each.
    ///
    /// # Panics
    /// If the CPU has another owner.
    pub(super) fn take_over(
        cpu: &mut Rc<Cpu>,
        plan: &Plan,
        mut image: ProgramImage,
        code: Rc<dyn Code>,
    ) -> Vec<String> {
        cpu.end_enabling();
        let renamed = cpu.keep_sites(&mut image);
        // Clock and driver of the old one take the places of these.
        let mut next = Cpu::new(image, code, Clock::simulated(), Box::new(Simulated::new(None)));
        let old = Rc::get_mut(cpu).expect("only the run owns its CPU");
        let own = Rc::get_mut(&mut next).expect("it was just made");
        macro_rules! take {
            ($($field:ident),*) => { $(std::mem::swap(&mut own.$field, &mut old.$field);)* };
        }
        take!(clock, driver, diagnostics, running, watcher, stop, load_memory, diagnostics_changed, startup, service);
        take!(
            is_served,
            has_jobs,
            is_restarted,
            restart_requested,
            communication,
            partners,
            records,
            alarms,
            technology,
            zone,
            cycle,
            meters,
            force
        );
        // Jobs of clients end: their addresses are those of the old program.
        own.set_modifying(false);
        own.generation = old.generation + 1;
        own.schedule.take_over(&mut old.schedule, own.clock.now());
        own.diagnostics.rename_sites(&renamed);
        own.stop.set(own.stop.get().map(|stop| stop.with_sites(&renamed)));
        own.load_memory.get_mut().retain(|number, _| !plan.changed_dbs.contains(number));
        own.take_memory(&old.memory);
        own.take_edges(&old.memory, &plan.edges.moves);
        let detached = own.s7200_take_over(&mut old.s7200, &renamed);
        own.take_created(&old.memory, old.created_dbs.get_mut(), old.image.db_end);
        let mut lines = own.take_data(&old.memory, plan);
        lines.extend(detached);
        if let Some(retention) = old.retention.take() {
            own.retention = OnceCell::from(retention.with_items_of(own));
        }
        // The thread of the old one ends here, before its memory goes.
        *cpu = next;
        cpu.rearm();
        if cpu.clock.is_virtual() {
            cpu.watchdog.watch_beats(cpu.schedule.hang_limit.get());
        }
        cpu.log(diagnostics::PROGRAM_CHANGED, NO_SITE, 0);
        lines
    }

    /// Puts the places of events in the diagnostic buffer into the new image, after its own. Result: the numbers that they have there.
    fn keep_sites(&self, image: &mut ProgramImage) -> Vec<(u32, u32)> {
        let entries = self.diagnostics.newest_first();
        let stop = self.stop.get();
        let stopped = stop.iter().flat_map(|stop| [Some(stop.entry), stop.cause]).flatten();
        let errors = self.s7200().into_iter().flat_map(|own| own.errors.entries());
        let mut sites: Vec<u32> =
            entries.iter().copied().chain(stopped).chain(errors).map(|entry| entry.site).collect();
        sites.sort_unstable();
        sites.dedup();
        let mut renamed = Vec::new();
        for number in sites {
            let Some(site) = self.image.sites.get(number as usize) else { continue };
            let name = self.image.files.get(site.file as usize).map_or("?", String::as_str);
            let file = image.files.iter().position(|file| file == name).unwrap_or_else(|| {
                image.files.push(name.to_string());
                image.files.len() - 1
            });
            let site = Site { file: file as u32, ..site.clone() };
            let place = image.sites.iter().position(|one| *one == site).unwrap_or_else(|| {
                image.sites.push(site);
                image.sites.len() - 1
            });
            renamed.push((number, place as u32));
        }
        renamed
    }

    /// Everything before local data: the state of the CPU, inputs, outputs, bit memory, timers and counters.
    fn take_memory(&self, from: &Memory) {
        let attention = self.memory.attention().load(std::sync::atomic::Ordering::Relaxed);
        let own = self.memory.host64(state::CPU);
        from.view(layout::STATE, layout::L, |bytes| self.memory.load(layout::STATE, bytes));
        self.memory.set_host64(state::CPU, own);
        self.memory.attention().store(attention, std::sync::atomic::Ordering::Relaxed);
        // A safepoint with nothing to do costs a call, a lost one an interrupt.
        self.memory.raise_attention();
    }

    /// The edge memories of an S7-200 at their new places; all others begin as in the first scan.
    fn take_edges(&self, from: &Memory, moves: &[(u32, u32)]) {
        let Some(own) = &self.image.s7200 else { return };
        let edge = |number: u32| layout::SYSTEM + system::EDGES + number;
        let count = own.rising_edges.saturating_add(own.falling_edges).min(system::EDGES_MAX);
        for number in 0..count {
            self.memory.set_byte(edge(number), u8::from(number < own.rising_edges));
        }
        for &(was, is) in moves.iter().filter(|(was, is)| (*was).max(*is) < system::EDGES_MAX) {
            self.memory.set_byte(edge(is), from.byte(edge(was)));
        }
    }

    /// Data blocks that the program has made: they follow those of the new program as they followed those of the old one.
    fn take_created(&self, from: &Memory, created: &[(u16, u32, u32)], old_end: u32) {
        let (old, new) = (old_end.max(layout::DB_DATA), self.image.db_end.max(layout::DB_DATA));
        let aligned = |end: u32| end.next_multiple_of(layout::DB_ALIGN);
        let mut own = self.created_dbs.borrow_mut();
        for &(number, address, bytes) in created {
            let to = address - aligned(old) + aligned(new);
            from.view(address, bytes, |data| self.memory.load(to, data));
            self.memory.set_db(number, to, bytes);
            own.push((number, to, bytes));
        }
    }

    /// The values of data blocks. Result: charts and pointers that begin again.
    fn take_data(&self, from: &Memory, plan: &Plan) -> Vec<String> {
        take_moves(from, &self.memory, &plan.moves);
        let mut lines: Vec<String> = plan.charts.iter().filter_map(|chart| chart.take(from, &self.memory)).collect();
        let mut lost = 0;
        for pointer in &plan.pointers {
            let db = from.word(pointer.from + pointer.db);
            let code = pointer.area.map_or(area::DB, |at| from.byte(pointer.from + at));
            let is_of_db = matches!(code, area::DB | area::DI);
            if is_of_db && plan.changed_dbs.contains(&db) {
                self.reset(pointer);
                lost += 1;
            } else {
                from.view(pointer.from, pointer.bytes, |data| self.memory.load(pointer.to, data));
            }
        }
        match lost {
            0 => {}
            1 => lines.push("a pointer into a changed data block begins with its initial value".to_string()),
            _ => lines.push(format!("{lost} pointers into changed data blocks begin with their initial values")),
        }
        lines
    }

    /// A pointer gets its initial value.
    fn reset(&self, pointer: &Pointer) {
        let db = self.image.dbs.iter().find(|db| {
            pointer.to.checked_sub(db.address).is_some_and(|at| (at + pointer.bytes) as usize <= db.data.len())
        });
        let Some(db) = db else { return };
        let at = (pointer.to - db.address) as usize;
        self.memory.load(pointer.to, &db.data[at..at + pointer.bytes as usize]);
    }
}

/// Copies values from the old memory to their places in the new one.
pub(super) fn take_moves(from: &Memory, to: &Memory, moves: &[Move]) {
    for one in moves {
        if one.from % 8 == 0 && one.to % 8 == 0 && one.bits % 8 == 0 {
            from.view((one.from / 8) as u32, (one.bits / 8) as u32, |data| to.load((one.to / 8) as u32, data));
        } else {
            for bit in 0..one.bits {
                let (source, target) = (one.from + bit, one.to + bit);
                let value = from.bit((source / 8) as u32, (source % 8) as u8);
                to.set_bit((target / 8) as u32, (target % 8) as u8, value);
            }
        }
    }
}
