//! Running organization blocks: local data, start information, registers, nesting.
//!
//! Each priority class has its own L stack. Synchronous error OBs run inside the class that caused them; where its L stack
//! ends is known only to the code that was left, so they get a slice of the classes above the highest priority each.
//!
//! Block depth is counted and checked by the calling code: `DEPTH` is the number of active blocks of the class; an OB starts with 1.

use std::cell::Cell;

use plcc_abi::image::{BlockEntry, BlockKind};
use plcc_abi::layout::{self, CpuRegister, state};
use plcc_abi::s7200::LOCAL_BYTES;

use crate::cpu::{Cpu, LoadedOb};
use crate::diagnostics::NO_SITE;
use crate::events;
use crate::events::StartInfo;
use crate::ob_set::ObSet;

/// First priority class that no OB uses (OB 90 has 29 by name, and class 0 here).
const ERROR_CLASS: u32 = 29;
/// L stack of one synchronous error OB with all it calls.
const ERROR_SLICE_BYTES: u32 = 0x4000;
/// Synchronous error OBs that can be active at once, in all classes.
const ERROR_LEVELS: u32 = (layout::L_CLASSES - ERROR_CLASS) * layout::L_CLASS_BYTES / ERROR_SLICE_BYTES;
/// Synchronous error OBs active in one class.
const ERROR_DEPTH_MAX: u32 = 3;

const REGISTER_SLOTS: usize = CpuRegister::ALL.len();
const RETURN_SLOTS: usize = 16;

/// What is running now.
#[derive(Default)]
pub struct Running {
    /// Priority class; 0 between cycles.
    pub(crate) priority: Cell<u8>,
    /// Number of the innermost OB, 0: none.
    pub(crate) ob: Cell<u16>,
    /// Active asynchronous OBs.
    pub(crate) active: ObSet,
    /// OBs that have got start information since the change to RUN.
    pub(crate) called: ObSet,
    /// SFC 41 calls that SFC 42 has not undone, in the running OB.
    pub(crate) delayed: Cell<u16>,
    /// In OB 121 and OB 122: whether the faulty instruction was a read, whose value SFC 44 can replace; `None` elsewhere.
    pub(crate) replaceable: Cell<Option<bool>>,
    /// The value that SFC 44 gave.
    pub(crate) substitute: Cell<u32>,
    /// Synchronous errors that are masked in the running class, and those of them that occurred.
    pub(crate) masks: Cell<Masks>,
    /// Start information of the running OB and of the last startup OB.
    pub(crate) info: Cell<[u8; 12]>,
    pub(crate) startup_info: Cell<[u8; 12]>,
    /// Active synchronous error OBs, in all classes and in this one.
    error_levels: Cell<u32>,
    error_depth: Cell<u32>,
}

/// Masked synchronous errors, as the double words of SFC 36-38: programming errors and access errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Masks {
    pub masked: [u32; 2],
    pub occurred: [u32; 2],
}

/// CPU registers and nesting of a class that is interrupted.
struct Saved {
    registers: [[u8; 4]; REGISTER_SLOTS],
    returns: [[u8; 8]; RETURN_SLOTS],
    depth: u32,
    depth_max: u32,
    l_end: u32,
    substitute: u32,
}

impl Cpu {
    /// Runs the OB in its priority class. The caller has checked that it is higher than the running one.
    pub(crate) fn run_ob(&self, ob: u16, priority: u8, info: StartInfo) {
        if let Some(ob) = self.loaded_ob(ob) {
            self.run_loaded(&ob, priority, &info.byte(2, priority));
        }
    }

    /// As [`run_ob`](Cpu::run_ob), for an OB that was looked up. `info` has the priority.
    #[inline]
    pub(crate) fn run_loaded(&self, loaded: &LoadedOb, priority: u8, info: &StartInfo) {
        match self.block_of(loaded) {
            Some(block) if self.running.priority.get() == 0 => self.run_outermost(loaded, block, priority, info),
            Some(block) => self.run_inside(loaded, block, priority, info),
            None => {}
        }
    }

    /// Runs an OB that interrupts another one.
    #[inline(never)]
    fn run_inside(&self, loaded: &LoadedOb, block: &BlockEntry, priority: u8, info: &StartInfo) {
        let ob = loaded.number;
        let running = &self.running;
        let before = (running.priority.get(), running.ob.get(), running.delayed.get(), running.error_depth.get());
        let replaceable = running.replaceable.take();
        let masks = running.masks.take();
        let class = u32::from(priority).min(ERROR_CLASS - 1);
        running.priority.set(priority);
        running.ob.set(ob);
        running.delayed.set(0);
        running.error_depth.set(0);
        running.active.set(ob, true);
        let limit = self.image.profile.local_data.min(layout::L_CLASS_BYTES);
        self.enter(block, layout::l_stack(class), limit, loaded.depth_max, info);
        running.active.set(ob, false);
        running.priority.set(before.0);
        running.ob.set(before.1);
        running.delayed.set(before.2);
        running.error_depth.set(before.3);
        running.replaceable.set(replaceable);
        running.masks.set(masks);
    }

    /// Runs an OB of the program cycle, which no event starts.
    #[inline]
    pub(crate) fn run_in_cycle(&self, loaded: &LoadedOb, priority: u8, info: &StartInfo) {
        if let Some(block) = self.block_of(loaded) {
            self.run_first(loaded, block, priority, info);
        }
    }

    /// Runs an OB of an event while no other runs.
    #[inline(never)]
    fn run_outermost(&self, loaded: &LoadedOb, block: &BlockEntry, priority: u8, info: &StartInfo) {
        self.running.active.set(loaded.number, true);
        self.run_first(loaded, block, priority, info);
        self.running.active.set(loaded.number, false);
    }

    /// Runs an OB while no other runs: what it leaves behind is what there is between OBs, and nothing is kept for it.
    #[inline]
    fn run_first(&self, loaded: &LoadedOb, block: &BlockEntry, priority: u8, info: &StartInfo) {
        let running = &self.running;
        running.priority.set(priority);
        running.ob.set(loaded.number);
        let limit = self.image.profile.local_data.min(layout::L_CLASS_BYTES);
        let class = u32::from(priority).min(ERROR_CLASS - 1);
        if self.has_local_data(block, limit) {
            self.run_block(block, layout::l_stack(class), limit, loaded.depth_max, info);
            // Start information is not read between OBs.
            self.memory.set_state::<{ state::DEPTH }, 4>([0; 4]);
        }
        running.priority.set(0);
        running.ob.set(0);
        running.delayed.set(0);
        running.error_depth.set(0);
        running.replaceable.set(None);
        running.masks.set(Masks::default());
    }

    /// Runs OB 121 or OB 122 inside the running class. False: nested too deeply.
    pub(crate) fn run_error_ob(&self, ob: u16, info: StartInfo) -> bool {
        let Some(block) = self.block(BlockKind::Ob, ob) else { return true };
        let running = &self.running;
        let (levels, depth, before) = (running.error_levels.get(), running.error_depth.get(), running.ob.get());
        if levels >= ERROR_LEVELS || depth >= ERROR_DEPTH_MAX {
            return false;
        }
        running.error_levels.set(levels + 1);
        running.error_depth.set(depth + 1);
        running.ob.set(ob);
        let base = layout::l_stack(ERROR_CLASS) + levels * ERROR_SLICE_BYTES;
        let limit = self.image.profile.local_data.min(ERROR_SLICE_BYTES);
        // The levels of the class are used up to an unknown extent; error OBs may use more in addition.
        let depth_max = self.image.profile.error_depth.max(1);
        self.enter(block, base, limit, depth_max, &info.byte(2, running.priority.get()));
        running.ob.set(before);
        running.error_depth.set(depth);
        running.error_levels.set(levels);
        true
    }

    /// Runs the main program or an interrupt routine of an S7-200 in its class: separate local data, no start information. Nesting is
    /// counted by the code.
    pub(crate) fn run_s7200_block(&self, block: &BlockEntry, priority: u8) {
        let (running, memory) = (&self.running, &self.memory);
        let ob = if block.kind == BlockKind::Ob { block.number } else { 0 };
        let before = (running.priority.replace(priority), running.ob.replace(ob));
        let base = layout::l_stack(u32::from(priority).min(ERROR_CLASS - 1));
        let saved = (before.0 != 0).then(|| self.save());
        if block.local_data_used {
            memory.clear(base, block.frame.clamp(LOCAL_BYTES, layout::L_CLASS_BYTES));
        }
        self.begin_code(u32::MAX, base + layout::L_CLASS_BYTES);
        self.code.call(block.entry, memory.base(), base, base);
        match &saved {
            Some(saved) => self.restore(saved),
            None => memory.set_state::<{ state::DEPTH }, 4>([0; 4]),
        }
        running.priority.set(before.0);
        running.ob.set(before.1);
    }

    /// Runs the block of an OB that interrupts code, whose registers are as before afterwards.
    fn enter(&self, block: &BlockEntry, base: u32, limit: u32, depth_max: u32, info: &StartInfo) {
        if self.has_local_data(block, limit) {
            let (saved, outer_info) = (self.save(), self.running.info.get());
            self.run_block(block, base, limit, depth_max, info);
            self.restore(&saved);
            self.running.info.set(outer_info);
        }
    }

    /// Whether the local data of an OB are within the limit; else the CPU stops.
    #[inline]
    fn has_local_data(&self, block: &BlockEntry, limit: u32) -> bool {
        let fits = block.frame.max(events::START_INFO_BYTES as u32) <= limit;
        if !fits {
            self.stop_by(plcc_abi::codes::stop::LOCAL_DATA, NO_SITE, 0);
        }
        fits
    }

    #[inline(always)]
    fn run_block(&self, block: &BlockEntry, base: u32, limit: u32, depth_max: u32, info: &StartInfo) {
        self.running.info.set(info.0);
        if matches!(block.number, 100..=102) {
            self.running.startup_info.set(info.0);
        }
        if self.is_served.get() {
            self.note_start(block.number, info);
        }
        if block.local_data_used {
            self.fill_local_data(block, base, info);
        }
        self.begin_code(depth_max, base + limit);
        self.code.call(block.entry, self.memory.base(), base, base);
    }

    /// Local data of an OB with its start information. Apart, so that [`run_block`](Cpu::run_block) need not take the information to pieces.
    #[inline(never)]
    fn fill_local_data(&self, block: &BlockEntry, base: u32, info: &StartInfo) {
        let first = !self.running.called.set(block.number, true);
        let memory = &self.memory;
        memory.clear(base, block.frame.max(events::START_INFO_BYTES as u32));
        memory.set_bytes(base, info.0);
        self.set_start_inputs(block, base, &info.0, first);
        memory.set_bytes(base + 12, self.clock.wall_bytes());
    }

    /// Registers, nesting and clock as the first block of a class finds them.
    #[inline]
    fn begin_code(&self, depth_max: u32, l_end: u32) {
        let memory = &self.memory;
        memory.set_state::<{ state::REGISTERS }, { 4 * REGISTER_SLOTS }>([0; 4 * REGISTER_SLOTS]);
        memory.set_state::<{ state::DEPTH }, 4>(1u32.to_ne_bytes());
        memory.set_state::<{ state::DEPTH_MAX }, 4>(depth_max.to_ne_bytes());
        memory.set_state::<{ state::L_END }, 4>(l_end.to_ne_bytes());
        self.show_clock();
    }

    /// Renews what generated code sees of the clock; code that moves the clock while a block waits calls it again.
    pub(crate) fn show_clock(&self) {
        let (countdown, ticks) = self.clock.fields();
        self.memory.set_state::<{ state::COUNTDOWN }, 8>(countdown.to_ne_bytes());
        self.memory.set_state::<{ state::TICKS }, 4>(ticks.to_ne_bytes());
    }

    fn save(&self) -> Saved {
        let memory = &self.memory;
        Saved {
            registers: std::array::from_fn(|index| memory.bytes(state::REGISTERS + 4 * index as u32)),
            returns: std::array::from_fn(|index| memory.bytes(state::RETURN_VALUES + 8 * index as u32)),
            depth: memory.host32(state::DEPTH),
            depth_max: memory.host32(state::DEPTH_MAX),
            l_end: memory.host32(state::L_END),
            substitute: memory.host32(state::SUBSTITUTE),
        }
    }

    fn restore(&self, saved: &Saved) {
        let memory = &self.memory;
        for (index, value) in (0u32..).zip(saved.registers) {
            memory.set_bytes(state::REGISTERS + 4 * index, value);
        }
        for (index, value) in (0u32..).zip(saved.returns) {
            memory.set_bytes(state::RETURN_VALUES + 8 * index, value);
        }
        memory.set_host32(state::DEPTH, saved.depth);
        memory.set_host32(state::DEPTH_MAX, saved.depth_max);
        memory.set_host32(state::L_END, saved.l_end);
        memory.set_host32(state::SUBSTITUTE, saved.substitute);
    }

    /// Calls a block by number for generated code, which has counted the depth: frame at `lbase`, the caller's at `vbase`.
    pub(crate) fn call_block(&self, site: u32, kind: u32, number: u32, lbase: u32, vbase: u32) -> u32 {
        use plcc_abi::codes::sync;
        let (kind, too_large, missing) = match kind {
            1 => (BlockKind::Fc, sync::FC_NUMBER, sync::FC_MISSING),
            2 => (BlockKind::Fb, sync::FB_NUMBER, sync::FB_MISSING),
            3 => (BlockKind::Sfc, sync::SFC_MISSING, sync::SFC_MISSING),
            4 => (BlockKind::Sfb, sync::SFB_MISSING, sync::SFB_MISSING),
            _ => return self.sync_error(site, sync::FC_MISSING, 0, number),
        };
        let Ok(short) = u16::try_from(number) else { return self.sync_error(site, too_large, 0, number) };
        let Some(block) = self.block(kind, short) else {
            if kind == BlockKind::Sfc && crate::system::is_without_parameters(short) {
                let result = self.system_function(site, number, layout::SCRATCH, vbase);
                self.memory.set_host32(CpuRegister::Br.slot(), result & 1);
                return result >> 1;
            }
            return self.sync_error(site, missing, 0, number);
        };
        let memory = &self.memory;
        if lbase.saturating_add(block.frame) > memory.host32(state::L_END) {
            self.stop_by(plcc_abi::codes::stop::LOCAL_DATA, site, 0);
        } else {
            self.code.call(block.entry, memory.base(), lbase, vbase);
        }
        self.stop_result()
    }
}
