//! The cost of S7-200 instructions in JIT code at -O2, and of an empty scan.
//!
//! A row is a sequence that occurs many times in the main program, each time with other operands; the same program without it is
//! subtracted. `cargo bench` prints a table. How to read it: docs/benchmarks.md.

use std::rc::Rc;
use std::time::Instant;

use plcc_codegen::JitProgram;
use plcc_diag::SourceFile;
use plcc_driver::cli::Level;
use plcc_driver::code;
use plcc_driver::inputs::Read;
use plcc_driver::pipeline::{self, Compiled, Settings};
use plcc_runtime::{Code, TestOptions, functions};

/// A sequence of statements.
struct Kernel {
    name: &'static str,
    /// Statements that occur once before all repetitions, in the program that is subtracted too.
    before: &'static [&'static str],
    /// One repetition. Operands change from one to the next; see `filled`.
    lines: &'static [&'static str],
    repetitions: usize,
    /// Divisor of a row: how often one repetition does the measured operation.
    times: usize,
}

const fn kernel(name: &'static str, lines: &'static [&'static str]) -> Kernel {
    Kernel { name, before: &[], lines, repetitions: REPETITIONS, times: 1 }
}

/// How often a sequence is in the program.
const REPETITIONS: usize = 250;

/// Scans of one run: short enough that some runs are not disturbed by other load on the machine.
const SCANS: u64 = 1000;

/// Runs of a row.
const RUNS: usize = 51;

/// V8000.0 is 1, VW8002 is 3: values unknown to the compiler.
#[rustfmt::skip]
const KERNELS: &[Kernel] = &[
    kernel("contacts and coil", &["LD V{b}.{x}", "AN M{m}.{x}", "O V{b}.1", "= V{e}.{x}"]),
    kernel("two groups, ALD, LPS, LPP", &["LD V{b}.{x}", "O V{c}.{x}", "LD V{b}.1", "O V{c}.1", "ALD", "LPS", "A M{m}.{x}", "= V{e}.{x}", "LPP", "= V{e}.1"]),
    kernel("edge", &["LD V{b}.{x}", "EU", "= V{e}.{x}"]),
    kernel("S and R of a bit", &["LD V{b}.{x}", "S V{e}.{x}, 1", "LDN V{b}.{x}", "R V{e}.{x}, 1"]),
    kernel("S of 20 bits", &["LD V8000.0", "S V{d}.{x}, 20"]),
    kernel("compare words", &["LDW>= VW{b}, VW{c}", "= V{e}.{x}"]),
    kernel("compare REALs", &["LDR> VD{d}, VD{f}", "= V{e}.{x}"]),
    kernel("MOVW", &["LD SM0.0", "MOVW VW{b}, VW{c}"]),
    kernel("MOVW after a contact", &["LD V8000.0", "MOVW VW{b}, VW{c}"]),
    kernel("MOVW from a pointer", &["LD SM0.0", "MOVW *VD{d}, VW{b}"]).after(POINTERS),
    kernel("MOVW to a pointer in AC1", &["LD SM0.0", "MOVW VW{b}, *AC1"]).after(POINTERS),
    kernel("+I", &["LD SM0.0", "+I VW{b}, VW{c}"]),
    kernel("+I after a contact", &["LD V8000.0", "+I VW{b}, VW{c}"]),
    kernel("+I, AENO, +I, AENO, coil", &["LD V8000.0", "+I VW{b}, VW{c}", "AENO", "+I 7, VW{e}", "AENO", "= M{m}.{x}"]),
    kernel("*D", &["LD SM0.0", "*D VD{d}, VD{f}"]),
    kernel("/I", &["LD SM0.0", "/I VW8002, VW{b}"]),
    kernel("*R", &["LD SM0.0", "*R VD{d}, VD{f}"]),
    kernel("SQRT", &["LD SM0.0", "SQRT VD{d}, VD{f}"]),
    kernel("INCW", &["LD SM0.0", "INCW VW{b}"]),
    kernel("ANDW", &["LD SM0.0", "ANDW VW{b}, VW{c}"]),
    kernel("SLW by 3", &["LD SM0.0", "SLW VW{b}, 3"]),
    kernel("ITD, DTR", &["LD SM0.0", "ITD VW{b}, VD{f}", "DTR VD{f}, VD{g}"]),
    kernel("TON, 100 ms", &["LD V{b}.{x}", "TON T{t}, 50", "LD T{t}", "= V{e}.{x}"]).times(180),
    kernel("TON, 100 ms, runs", &["LD V8000.0", "TON T{t}, 50", "LD T{t}", "= V{e}.{x}"]).times(180),
    kernel("TON, 10 ms, runs", &["LD V8000.0", "TON T{u}, 50", "LD T{u}", "= V{e}.{x}"]).times(40),
    kernel("TON, 1 ms, runs", &["LD V8000.0", "TON T{z}, 50", "LD T{z}", "= V{e}.{x}"]).times(40),
    kernel("CTU", &["LD V{b}.{x}", "LD V{c}.{x}", "CTU C{n}, 10", "LD C{n}", "= V{e}.{x}"]),
    kernel("CALL with three parameters", &["LD SM0.0", "CALL Sum, VW{b}, VW{c}, VW{e}"]),
    kernel("the same in place", &["LD SM0.0", "MOVW VW{b}, VW{e}", "+I VW{c}, VW{e}"]),
    kernel("CALL after a contact", &["LD V8000.0", "CALL Sum, VW{b}, VW{c}, VW{e}"]),
    kernel("CALL of a large block", &["LD SM0.0", "CALL Large, VW{b}, VW{c}, VW{e}"]),
    kernel("sequence step, active", STEP).after(&["LD SM0.1", "S S0.0, 250"]),
    kernel("sequence step, not active", STEP),
    kernel("pass of a FOR loop", &["LD SM0.0", "FOR VW0, 1, 1000", "LD SM0.0", "+D 1, VD{d}", "NEXT"]).times(1).each(1000),
    kernel("BMB of 100 bytes", &["LD SM0.0", "BMB VB{b}, VB{g}, 100"]),
    kernel("FILL of 50 words", &["LD SM0.0", "FILL 7, VW{g}, 50"]),
    kernel("SHRB of 16 bits", &["LD SM0.0", "SHRB V{b}.{x}, V{e}.0, 16"]),
    kernel("ATT, FIFO", &["LD SM0.0", "ATT VW{b}, VW8100", "FIFO VW8100, VW{e}"]),
    kernel("PID", &["LD SM0.0", "PID VB{l}, {p}"]).times(40),
    kernel("ITA", &["LD SM0.0", "ITA VW{b}, VB{g}, 2#1011"]),
    kernel("SCPY of 5 letters", &["LD SM0.0", "SCPY \"12 kg\", VB{g}"]),
    kernel("network, interrupts attached", &["LD V{b}.{x}", "AN M{m}.{x}", "O V{b}.1", "= V{e}.{x}"])
        .after(&["LD SM0.1", "MOVB 100, SMB34", "ATCH Tick, 10", "ENI"]),
    kernel("network of a program of 1000", MIXTURE).times(100).each(10),
];

/// VD3000 to VD3996 and AC1 point into V memory.
const POINTERS: &[&str] = &[
    "LD SM0.1",
    "MOVD &VB2000, AC1",
    "MOVD &VB3000, AC2",
    "FOR VW8010, 1, 250",
    "MOVD AC1, *AC2",
    "+D 4, AC2",
    "NEXT",
];

const STEP: &[&str] = &["LSCR S{s}.{x}", "LD SM0.0", "= V{e}.{x}", "LD V{b}.{x}", "SCRT S31.{x}", "SCRE"];

/// Ten networks of several kinds.
const MIXTURE: &[&str] = &[
    "LD V{b}.{x}",
    "AN M{m}.{x}",
    "O V{b}.1",
    "= V{e}.{x}",
    "NETWORK",
    "LD V{b}.2",
    "LPS",
    "A V{c}.{x}",
    "= M{m}.1",
    "LPP",
    "A V{c}.1",
    "= M{m}.2",
    "NETWORK",
    "LD V{e}.{x}",
    "EU",
    "S V{e}.3, 1",
    "NETWORK",
    "LD V8000.0",
    "TON T{t}, 50",
    "NETWORK",
    "LD T{t}",
    "R V{e}.3, 1",
    "NETWORK",
    "LD V{e}.4",
    "LD V{e}.5",
    "CTU C{n}, 100",
    "NETWORK",
    "LDW>= C{n}, 10",
    "AW< VW{b}, VW{c}",
    "= V{e}.6",
    "NETWORK",
    "LD V8000.0",
    "MOVW VW{b}, VW{c}",
    "+I 3, VW{c}",
    "NETWORK",
    "LD V8000.0",
    "ITD VW{b}, AC0",
    "DTR AC0, AC0",
    "*R 0.5, AC0",
    "MOVR AC0, VD{f}",
    "NETWORK",
    "LD V8000.0",
    "CALL Sum, VW{b}, VW{c}, VW{e}",
];

impl Kernel {
    /// With these statements before it.
    const fn after(self, before: &'static [&'static str]) -> Kernel {
        Kernel { before, ..self }
    }

    const fn times(self, repetitions: usize) -> Kernel {
        Kernel { repetitions, ..self }
    }

    /// One repetition does it so often.
    const fn each(self, times: usize) -> Kernel {
        Kernel { times, ..self }
    }
}

const BLOCKS: &str = "
SUBROUTINE_BLOCK Sum:SBR0
VAR_INPUT
a:INT;
b:INT;
END_VAR
VAR_OUTPUT
r:INT;
END_VAR
BEGIN
NETWORK 1
LD SM0.0
MOVW #a, #r
+I #b, #r
END_SUBROUTINE_BLOCK
SUBROUTINE_BLOCK Large:SBR1
VAR_INPUT
a:INT;
b:INT;
END_VAR
VAR_OUTPUT
r:INT;
END_VAR
VAR
s:INT;
END_VAR
BEGIN
NETWORK 1
LD SM0.0
MOVW #a, #r
MOVW #b, #s
";

/// The part that occurs twelve times in the large subroutine.
const LARGE: &str = "
NETWORK
LDW> #s, #r
+I VW8002, #s
LD SM0.0
*I VW8002, #r
+I #s, #r
";

const DATA: &str = "
INTERRUPT_BLOCK Tick:INT0
BEGIN
NETWORK 1
LD SM0.0
INCW VW8004
END_INTERRUPT_BLOCK
DATA_BLOCK DB1
VB8000 1
VW8002 3
VW8100 8, 0
VD9000 0.5, 0.6, 0.0, 1.0, 0.1, 10.0, 0.0, 0.0, 0.5
VD9036 0.5, 0.6, 0.0, 1.0, 0.1, 10.0, 0.0, 0.0, 0.5
VD9072 0.5, 0.6, 0.0, 1.0, 0.1, 10.0, 0.0, 0.0, 0.5
VD9108 0.5, 0.6, 0.0, 1.0, 0.1, 10.0, 0.0, 0.0, 0.5
VD9144 0.5, 0.6, 0.0, 1.0, 0.1, 10.0, 0.0, 0.0, 0.5
VD9180 0.5, 0.6, 0.0, 1.0, 0.1, 10.0, 0.0, 0.0, 0.5
VD9216 0.5, 0.6, 0.0, 1.0, 0.1, 10.0, 0.0, 0.0, 0.5
VD9252 0.5, 0.6, 0.0, 1.0, 0.1, 10.0, 0.0, 0.0, 0.5
END_DATA_BLOCK
";

/// Timers of 10 ms and of 1 ms for TON.
const TIMERS_10_MS: [usize; 8] = [33, 34, 35, 36, 97, 98, 99, 100];
const TIMERS_1_MS: [usize; 2] = [32, 96];

/// A line with the numbers of its repetition: `{b}`, `{c}`, `{e}` addresses of words, `{d}`, `{f}`, `{g}` of double words, `{m}` a byte
/// of M, `{s}` of S, `{x}` a bit, `{n}` the repetition, `{t}`, `{u}`, `{z}` timers of 100, 10 and 1 ms, `{p}` a PID loop with its table `{l}`.
fn filled(line: &str, index: usize) -> String {
    let places = [
        ("{b}", 2 * index),
        ("{c}", 1000 + 2 * index),
        ("{e}", 2000 + 2 * index),
        ("{d}", 3000 + 4 * index),
        ("{f}", 4000 + 4 * index),
        ("{g}", 5000 + 4 * index),
        ("{m}", index % 32),
        ("{s}", index / 8),
        ("{x}", index % 8),
        ("{n}", index),
        ("{t}", if index < 27 { 37 + index } else { 101 + (index - 27) % 155 }),
        ("{u}", TIMERS_10_MS[index % TIMERS_10_MS.len()]),
        ("{z}", TIMERS_1_MS[index % TIMERS_1_MS.len()]),
        ("{p}", index % 8),
        ("{l}", 9000 + 36 * (index % 8)),
    ];
    places.iter().fold(line.to_string(), |line, (mark, number)| line.replace(mark, &number.to_string()))
}

/// The program with the repetitions of a kernel, or without them.
fn compile(kernel: &Kernel, with: bool) -> Compiled {
    let mut source = "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\n".to_string();
    let mut network = |lines: &[&str], index: usize| {
        source.push_str("NETWORK\n");
        lines.iter().for_each(|line| source.push_str(&format!("{}\n", filled(line, index))));
    };
    network(kernel.before, 0);
    (0..if with { kernel.repetitions } else { 0 }).for_each(|index| network(kernel.lines, index));
    source.push_str(&format!("END_ORGANIZATION_BLOCK\n{BLOCKS}{}END_SUBROUTINE_BLOCK\n{DATA}", LARGE.repeat(12)));
    let mut read = Read { name: "bench".to_string(), ..Read::default() };
    read.units.push(read.sources.add(SourceFile::new("bench.awl", source)));
    let bound = pipeline::front(read, &Settings { require_main: true, ..Settings::default() });
    assert!(!bound.has_errors(), "{}", plcc_diag::drawing::draw(&bound.diagnostics, &bound.sources, false));
    pipeline::back(&bound, Level::O2)
}

/// A program and the times of its runs.
struct Timed {
    compiled: Compiled,
    code: Rc<dyn Code>,
    times: Vec<f64>,
}

impl Timed {
    fn new(kernel: &Kernel, with: bool) -> Timed {
        let compiled = compile(kernel, with);
        let code = code::jit(&compiled).expect("the kernels compile");
        Timed { compiled, code, times: Vec::new() }
    }

    fn run(&mut self) {
        let options = TestOptions { cycles: Some(SCANS), ..TestOptions::default() };
        let start = Instant::now();
        let report = plcc_runtime::test(self.compiled.image.clone(), self.code.clone(), &options);
        self.times.push(start.elapsed().as_nanos() as f64);
        assert_eq!(report.stopped, None);
    }

    /// Shortest and median time of a scan, in nanoseconds.
    fn nanoseconds(&mut self) -> [f64; 2] {
        self.times.sort_by(f64::total_cmp);
        [self.times[0], self.times[self.times.len() / 2]].map(|time| time / SCANS as f64)
    }

    fn code_bytes(&self) -> usize {
        let program = JitProgram::compile(&self.compiled.module, &functions::address, &self.compiled.codegen_options());
        program.expect("the kernels compile").code_bytes()
    }
}

/// Runs with and without the kernel follow one another in turn, so that a busy machine slows both.
fn print_row(kernel: &Kernel) {
    let mut pair = [true, false].map(|with| Timed::new(kernel, with));
    for _ in 0..RUNS {
        pair.iter_mut().for_each(Timed::run);
    }
    let [full, empty] = &mut pair;
    let count = (kernel.repetitions * kernel.times) as f64;
    let bytes = full.code_bytes().saturating_sub(empty.code_bytes()) as f64 / count;
    let (times, without) = (full.nanoseconds(), empty.nanoseconds());
    let [fastest, median] = [0, 1].map(|at| (times[at] - without[at]) / count);
    println!("{:<32}{fastest:>12.2}{median:>12.2}{bytes:>12.1}", kernel.name);
}

/// A scan of a program without statements.
fn print_idle_scan() {
    let mut idle = Timed::new(&Kernel { repetitions: 0, ..kernel("", &[]) }, true);
    (0..RUNS).for_each(|_| idle.run());
    let [fastest, median] = idle.nanoseconds();
    println!("{:<32}{fastest:>12.1}{median:>12.1}", "idle scan");
}

fn main() {
    // `cargo test --benches` checks that it works, not its speed.
    if !std::env::args().any(|argument| argument == "--bench") {
        return KERNELS.iter().for_each(|kernel| drop(compile(kernel, true)));
    }
    let wanted: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    println!("{:<32}{:>12}{:>12}{:>12}", "sequence", "fastest ns", "median ns", "bytes");
    for kernel in
        KERNELS.iter().filter(|kernel| wanted.is_empty() || wanted.iter().any(|name| kernel.name.contains(name)))
    {
        print_row(kernel);
    }
    print_idle_scan();
}
