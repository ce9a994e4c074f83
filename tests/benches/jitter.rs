//! How punctual a cycle of 1 ms and an OB 35 of 1 ms are under the real clock.
//!
//!     cargo bench --bench jitter              30 seconds each
//!     cargo bench --bench jitter -- 5         5 seconds each
//!
//! Printed are percentiles of how far the time from one start to the next is from 1 ms, in microseconds: as any process runs, and with
//! `--realtime`, where the system permits it. The table is in docs/PERFORMANCE.md.

use std::cell::RefCell;
use std::process::ExitCode;
use std::rc::Rc;
use std::time::Instant;

use plcc_abi::image::BlockKind;
use plcc_diag::SourceFile;
use plcc_driver::cli::Level;
use plcc_driver::code;
use plcc_driver::inputs::Read;
use plcc_driver::pipeline::{self, Compiled, Settings};
use plcc_runtime::Code;
use plcc_runtime::clock::Clock;
use plcc_runtime::cpu::Cpu;
use plcc_runtime::cycle::{Observer, Pace};
use plcc_runtime::io::Simulated;
use plcc_runtime::realtime;

/// Period of both, in nanoseconds.
const PERIOD: u64 = 1_000_000;

/// Seconds of each run.
const SECONDS: u64 = 30;

/// Host time for a cycle under the virtual clock, which is not used.
const HANG_LIMIT: u64 = 10_000_000_000;

const SOURCE: &str = "
ORGANIZATION_BLOCK OB 1
BEGIN
      L     50
next: T     MW 0
      L     MD 4
      L     MW 0
      +D
      T     MD 4
      L     MW 0
      LOOP  next
END_ORGANIZATION_BLOCK
ORGANIZATION_BLOCK OB 35
BEGIN
      L     MD 8
      +     1
      T     MD 8
END_ORGANIZATION_BLOCK
";

fn main() -> ExitCode {
    // `cargo test --benches` checks that it builds.
    if !std::env::args().any(|argument| argument == "--bench") {
        return ExitCode::SUCCESS;
    }
    let seconds = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(SECONDS);
    println!("{:<34}{:>10}{:>10}{:>10}{:>10}{:>10}", "microseconds from 1 ms", "starts", "p50", "p99", "p99.99", "max");
    run("as any process", seconds);
    match realtime::enter() {
        Ok(()) => run("--realtime", seconds),
        Err(error) => println!("--realtime: {error}"),
    }
    ExitCode::SUCCESS
}

fn compiled() -> Compiled {
    let mut read = Read { name: "jitter".to_string(), ..Read::default() };
    read.units.push(read.sources.add(SourceFile::new("jitter.stl", SOURCE)));
    let bound = pipeline::front(read, &Settings { require_main: true, ..Settings::default() });
    assert!(!bound.has_errors(), "{}", plcc_diag::drawing::draw(&bound.diagnostics, &bound.sources, false));
    let mut compiled = pipeline::back(&bound, Level::O2);
    compiled.image.config.cyclic_period_ms = vec![(35, 1)];
    compiled
}

/// Runs the program and prints a line for each of its blocks.
fn run(name: &str, seconds: u64) {
    let compiled = compiled();
    let entry = |number| {
        let block = compiled.image.blocks.iter().find(|block| (block.kind, block.number) == (BlockKind::Ob, number));
        block.expect("the program has the block").entry
    };
    let cycles = seconds * 1000;
    let code = code::jit(&compiled).expect("the program compiles");
    // Room for all starts, so that none waits for memory.
    let watch = |number| (entry(number), RefCell::new(Vec::with_capacity(2 * cycles as usize)));
    let watched = Rc::new(Watched { code, blocks: [watch(1), watch(35)] });
    let driver = Box::new(Simulated::new(compiled.image.config.modules.clone()));
    let cpu = Cpu::new(compiled.image.clone(), watched.clone(), Clock::real(), driver);
    cpu.execute(&Pace { cycles: Some(cycles), cycle_time: PERIOD, hang_limit: HANG_LIMIT }, &mut Nobody);
    assert!(!cpu.is_stopped(), "the program does not fail");
    for (block, (_, starts)) in ["cycle", "OB 35"].into_iter().zip(&watched.blocks) {
        print_line(&format!("{block}, {name}"), &starts.borrow());
    }
}

fn print_line(name: &str, starts: &[Instant]) {
    let between = starts.windows(2).map(|pair| (pair[1] - pair[0]).as_nanos() as u64);
    let mut late: Vec<u64> = between.map(|time| time.abs_diff(PERIOD)).collect();
    late.sort_unstable();
    let at = |part: f64| late.get(((late.len() as f64 * part) as usize).min(late.len().saturating_sub(1)));
    let [p50, p99, p9999, max] = [0.5, 0.99, 0.9999, 1.0].map(|part| at(part).map_or(0.0, |time| *time as f64 / 1e3));
    println!("{name:<34}{:>10}{p50:>10.1}{p99:>10.1}{p9999:>10.1}{max:>10.1}", starts.len());
}

/// Code that notes when some of its entries are called.
struct Watched {
    code: Rc<dyn Code>,
    /// The number of an entry, and when it was called.
    blocks: [(u32, RefCell<Vec<Instant>>); 2],
}

impl Code for Watched {
    fn call(&self, entry: u32, mem: *mut u8, lbase: u32, vbase: u32) {
        if let Some((_, starts)) = self.blocks.iter().find(|(number, _)| *number == entry) {
            starts.borrow_mut().push(Instant::now());
        }
        self.code.call(entry, mem, lbase, vbase);
    }
}

/// Nothing happens between cycles.
struct Nobody;

impl Observer for Nobody {
    fn before(&mut self, _: &Cpu, _: u64, _: u64) {}
    fn after(&mut self, _: &Cpu, _: u64, _: u64) {}
}
