//! A CPU whose blocks are closures.

use std::rc::Rc;

use plcc_abi::ProgramImage;
use plcc_abi::image::{BlockEntry, BlockKind, Config, DbEntry, Family, Profile};
use plcc_abi::layout;
use plcc_abi::s7200::image::CpuRow;
use plcc_abi::s7200::{Operation, S7200Image};

use crate::clock::Clock;
use crate::code::Code;
use crate::cpu::Cpu;
use crate::cycle::{Observer, Pace};
use crate::diagnostics::NO_SITE;
use crate::io::Simulated;
use crate::s7200::Operands;

/// A block: gets the CPU and its local data base.
pub type Block = Box<dyn Fn(&Cpu, u32)>;

pub struct Closures(pub Vec<Block>);

impl Code for Closures {
    fn call(&self, entry: u32, mem: *mut u8, lbase: u32, _vbase: u32) {
        // SAFETY: the runtime passes the base of its own memory.
        let cpu = unsafe { Cpu::of(mem) };
        (self.0[entry as usize])(cpu, lbase);
    }
}

pub fn profile() -> Profile {
    Profile {
        name: "s7-300".to_string(),
        family: Family::S7300,
        accumulators: 2,
        inputs: 2048,
        outputs: 2048,
        bit_memory: 8192,
        timers: 2048,
        counters: 2048,
        local_data: 32_768,
        db_bytes_max: 65_534,
        block_depth: 16,
        error_depth: 4,
        limits_checked: false,
    }
}

/// An image with these blocks, whose entries are numbered in order.
pub fn image(blocks: &[(BlockKind, u16)]) -> ProgramImage {
    let entry = |(entry, &(kind, number)): (u32, &(BlockKind, u16))| BlockEntry {
        kind,
        number,
        name: String::new(),
        entry,
        frame: 24,
        local_data_used: true,
        start_inputs: Vec::new(),
    };
    ProgramImage {
        name: "test".to_string(),
        profile: profile(),
        config: Config::default(),
        blocks: (0u32..).zip(blocks).map(entry).collect(),
        dbs: Vec::new(),
        db_end: layout::DB_DATA,
        sites: Vec::new(),
        error_slots: Vec::new(),
        files: Vec::new(),
        asserts: Vec::new(),
        symbols: Vec::new(),
        types: Vec::new(),
        used: Vec::new(),
        partial: Vec::new(),
        stops_itself: false,
        sources_sum: 0,
        shapes: Vec::new(),
        outputs_used: u32::MAX,
        notices: Vec::new(),
        inner_blocks: Vec::new(),
        s7200: None,
    }
}

/// A CPU under the virtual clock with OBs as closures.
pub fn cpu(obs: Vec<(u16, Block)>) -> Rc<Cpu> {
    cpu_with(obs, |_| {})
}

pub fn cpu_with(obs: Vec<(u16, Block)>, change: impl FnOnce(&mut ProgramImage)) -> Rc<Cpu> {
    let blocks: Vec<_> = obs.iter().map(|(number, _)| (BlockKind::Ob, *number)).collect();
    let mut image = image(&blocks);
    change(&mut image);
    let code = Closures(obs.into_iter().map(|(_, block)| block).collect());
    let driver = Box::new(Simulated::new(image.config.modules.clone()));
    Cpu::new(image, Rc::new(code), Clock::simulated(), driver)
}

struct Nobody;

impl Observer for Nobody {
    fn before(&mut self, _: &Cpu, _: u64, _: u64) {}
    fn after(&mut self, _: &Cpu, _: u64, _: u64) {}
    fn rests(&self) -> bool {
        true
    }
}

/// Runs this many cycles of 10 ms.
pub fn run(cpu: &Cpu, cycles: u64) {
    run_observed(cpu, cycles, &mut Nobody);
}

pub fn run_observed(cpu: &Cpu, cycles: u64, observer: &mut dyn Observer) {
    let pace = Pace { cycles: Some(cycles), cycle_time: 10_000_000, hang_limit: 50_000_000 };
    cpu.execute(&pace, observer);
}

/// A 226 with these blocks and 10240 bytes of V.
pub fn s7200_image(blocks: &[(BlockKind, u16)]) -> ProgramImage {
    let mut image = image(blocks);
    image.profile = Profile {
        name: "226".to_string(),
        family: Family::S7200,
        inputs: 16,
        outputs: 16,
        bit_memory: 32,
        timers: 256,
        counters: 256,
        local_data: 64,
        block_depth: 8,
        ..profile()
    };
    let cpu = CpuRow {
        v_bytes: 10_240,
        sm_bytes: 550,
        s_bytes: 32,
        analog_bytes: 64,
        high_speed_counters: 0x3F,
        ports: 2,
        pulse_outputs: 2,
        pid_loops: 8,
        subroutines: 128,
        interrupts: 128,
        labels: 256,
        events: (1 << 34) - 1,
        queues: [8, 16, 8],
        watchdog_ms: 500,
        id: 9,
        inputs: 24,
        outputs: 16,
        old: false,
    };
    image.s7200 = Some(S7200Image { cpu, ..S7200Image::default() });
    image.dbs = vec![DbEntry {
        number: 1,
        name: String::new(),
        address: layout::DB_DATA,
        data: vec![0; 10_240],
        read_only: false,
        unlinked: false,
        optimized: false,
        kept: Default::default(),
        ty: None,
    }];
    image.db_end = layout::DB_DATA + 10_240;
    image
}

/// An S7-200 under the virtual clock: main program, interrupt routines with their numbers.
pub fn s7200(main: Block, routines: Vec<(u16, Block)>) -> Rc<Cpu> {
    s7200_with(main, routines, |_| {})
}

pub fn s7200_with(main: Block, routines: Vec<(u16, Block)>, change: impl FnOnce(&mut ProgramImage)) -> Rc<Cpu> {
    let mut blocks = vec![(BlockKind::Ob, 1)];
    blocks.extend(routines.iter().map(|(number, _)| (BlockKind::Int, *number)));
    let mut image = s7200_image(&blocks);
    change(&mut image);
    let code = Closures(std::iter::once(main).chain(routines.into_iter().map(|(_, block)| block)).collect());
    let driver = Box::new(Simulated::new(image.config.modules.clone()));
    Cpu::new(image, Rc::new(code), Clock::simulated(), driver)
}

/// An operation with up to four operands.
pub fn operate(cpu: &Cpu, operation: Operation, operands: [u32; 4]) -> u64 {
    let [a, b, c, d] = operands;
    cpu.s7200_operation(operation as u32, &Operands { site: NO_SITE, a, b, c, d })
}
