//! Cost of a call of a chart, in JIT code at -O2: charts of several sizes with one and with eight active steps.
//!
//! Instances of a chart are called in OB 1; the same OB without the calls is subtracted. `cargo bench` prints a table. How to read it:
//! docs/benchmarks.md.

use std::rc::Rc;
use std::time::Instant;

use plcc_codegen::JitProgram;
use plcc_driver::code;
use plcc_driver::pipeline::Compiled;
use plcc_runtime::{Code, TestOptions, functions};
use plcc_tests::charts::Rings;

/// Active steps, and steps of the charts that are compared.
const SIZES: [(usize, &[usize]); 2] = [(1, &[5, 10, 100, 250]), (8, &[16, 100, 250])];

/// Instances that OB 1 calls.
const INSTANCES: usize = 16;

/// Cycles of one run.
const CYCLES: u64 = 4000;

/// Runs that a row of the table is the median of.
const RUNS: usize = 21;

struct Timed {
    compiled: Compiled,
    code: Rc<dyn Code>,
    times: Vec<f64>,
}

impl Timed {
    fn new(rings: &Rings, called: bool) -> Timed {
        let compiled = rings.compile(INSTANCES, called);
        let code = code::jit(&compiled).expect("charts compile");
        Timed { compiled, code, times: Vec::new() }
    }

    fn run(&mut self) {
        let options = TestOptions { cycles: Some(CYCLES), ..TestOptions::default() };
        let start = Instant::now();
        let report = plcc_runtime::test(self.compiled.image.clone(), self.code.clone(), &options);
        self.times.push(start.elapsed().as_nanos() as f64);
        assert_eq!(report.stopped, None);
    }

    /// Shortest and median time of a run, in nanoseconds.
    fn nanoseconds(&mut self) -> [f64; 2] {
        self.times.sort_by(f64::total_cmp);
        [self.times[0], self.times[self.times.len() / 2]]
    }

    fn code_bytes(&self) -> usize {
        let program = JitProgram::compile(&self.compiled.module, &functions::address, &self.compiled.codegen_options());
        program.expect("charts compile").code_bytes()
    }
}

/// Rows of one kind of chart. Runs of its sizes follow one another in turn, so that a busy machine slows all of them.
fn print_rows(kind: &Rings, sizes: &[usize]) {
    let of_size = |&steps: &usize| {
        let rings = Rings { steps, ..*kind };
        [true, false].map(|called| Timed::new(&rings, called))
    };
    let mut charts: Vec<[Timed; 2]> = sizes.iter().map(of_size).collect();
    for _ in 0..RUNS {
        charts.iter_mut().flatten().for_each(Timed::run);
    }
    let mut smallest = None;
    for (steps, [full, empty]) in sizes.iter().zip(&mut charts) {
        let calls = INSTANCES as f64 * CYCLES as f64;
        let (times, without) = (full.nanoseconds(), empty.nanoseconds());
        let [fastest, median] = [0, 1].map(|at| (times[at] - without[at]) / calls);
        let ratio = fastest / *smallest.get_or_insert(fastest);
        let name = format!(
            "{}, {}{}",
            kind.interface,
            if kind.switching { "one switches" } else { "idle" },
            if kind.supervised { ", supervised" } else { "" },
        );
        let (active, bytes) = (kind.rings, full.code_bytes());
        println!("{name:<36}{active:>8}{steps:>8}{fastest:>12.1}{median:>12.1}{ratio:>10.2}{bytes:>12}");
    }
}

fn main() {
    // `cargo test --benches` checks that it works, not its speed.
    if !std::env::args().any(|argument| argument == "--bench") {
        let kind = Rings { steps: 5, rings: 1, interface: "Minimum", supervised: true, switching: true };
        Timed::new(&kind, true).run();
        return;
    }
    let head = ["active", "steps", "fastest ns", "median ns", "ratio", "code bytes"];
    println!("{:<36}{:>8}{:>8}{:>12}{:>12}{:>10}{:>12}", "chart", head[0], head[1], head[2], head[3], head[4], head[5]);
    for (rings, sizes) in SIZES {
        for interface in ["Minimum", "Standard"] {
            for (supervised, switching) in [(false, false), (false, true), (true, false), (true, true)] {
                print_rows(&Rings { steps: 0, rings, interface, supervised, switching }, sizes);
            }
        }
    }
}
