//! Cost of the instruction classes: time and machine code of one instruction, in JIT code at -O2.
//!
//! Each kernel is a short sequence, repeated in OB 1; the same OB without it is subtracted. `cargo bench` prints a table, then the
//! distribution of each kernel's run.

use std::rc::Rc;
use std::time::Instant;

use divan::counter::ItemsCount;
use plcc_codegen::JitProgram;
use plcc_diag::SourceFile;
use plcc_driver::cli::Level;
use plcc_driver::code;
use plcc_driver::inputs::Read;
use plcc_driver::pipeline::{self, Compiled, Settings};
use plcc_runtime::{Code, TestOptions, functions};

/// Name, instructions. Operands change from one repetition to the next: `{b}` is a byte address, `{x}` a bit.
const KERNELS: &[(&str, &[&str])] = &[
    ("bit logic", &["A I {b}.{x}", "AN M {b}.{x}", "O M {b}.1", "= Q {b}.{x}"]),
    ("set and reset", &["A I {b}.{x}", "S M {b}.{x}", "AN I {b}.{x}", "R M {b}.{x}"]),
    ("edges", &["A I {b}.{x}", "FP M {b}.{x}", "= Q {b}.{x}"]),
    ("load and transfer", &["L MW {b}", "T QW {b}"]),
    ("load and transfer in a DB", &["L DB1.DBW {b}", "T DB1.DBD {b}"]),
    ("16-bit arithmetic", &["L MW {b}", "L IW {b}", "+I", "T QW {b}"]),
    ("32-bit arithmetic", &["L MD {b}", "L ID {b}", "*D", "T QD {b}"]),
    ("REAL arithmetic", &["L MD {b}", "L ID {b}", "+R", "T QD {b}"]),
    ("comparison", &["L MW {b}", "L IW {b}", ">I", "= Q {b}.{x}"]),
    ("word logic", &["L MW {b}", "L IW {b}", "XOW", "T QW {b}"]),
    ("shift", &["L MW {b}", "SLW 3", "T QW {b}"]),
    ("conversion", &["L MW {b}", "ITD", "DTR", "T QD {b}"]),
    ("memory-indirect", &["L P#{b}.0", "T MD 4000", "L MW [MD 4000]", "T QW {b}"]),
    ("timer", &["A I {b}.{x}", "L S5T#1S", "SD T {b}", "A T {b}", "= Q {b}.{x}"]),
    ("counter", &["A I {b}.{x}", "CU C {b}", "L C {b}", "T QW {b}"]),
    ("block call", &["CALL FC 1 (a := MW {b}, b := QW {b});"]),
];

/// How often a kernel stands in OB 1.
const REPETITIONS: usize = 250;

/// Cycles of one run: enough that making the CPU does not count.
const CYCLES: u64 = 2000;

const BLOCKS: &str = "
DATA_BLOCK DB 1
STRUCT
  r : ARRAY [0 .. 599] OF BYTE;
END_STRUCT;
BEGIN
END_DATA_BLOCK
FUNCTION FC 1 : VOID
VAR_INPUT
  a : INT;
END_VAR
VAR_OUTPUT
  b : INT;
END_VAR
BEGIN
      L     #a
      NEGI
      T     #b
END_FUNCTION
";

fn compile(kernel: &[&str], repetitions: usize) -> Compiled {
    let mut source = format!("{BLOCKS}ORGANIZATION_BLOCK OB 1\nBEGIN\n");
    for index in 0..repetitions {
        for line in kernel {
            let line = line.replace("{b}", &(2 * index).to_string()).replace("{x}", &(index % 8).to_string());
            source.push_str(&format!("      {line}\n"));
        }
    }
    source.push_str("END_ORGANIZATION_BLOCK\n");
    let mut read = Read { name: "bench".to_string(), ..Read::default() };
    read.units.push(read.sources.add(SourceFile::new("bench.stl", source)));
    let bound = pipeline::front(read, &Settings { require_main: true, ..Settings::default() });
    assert!(!bound.has_errors(), "{}", plcc_diag::drawing::draw(&bound.diagnostics, &bound.sources, false));
    pipeline::back(&bound, Level::O2)
}

fn code_bytes(compiled: &Compiled) -> usize {
    let program = JitProgram::compile(&compiled.module, &functions::address, &compiled.codegen_options());
    program.expect("the kernels compile").code_bytes()
}

fn run(compiled: &Compiled, code: &Rc<dyn Code>) {
    let options = TestOptions { cycles: Some(CYCLES), ..TestOptions::default() };
    let report = plcc_runtime::test(compiled.image.clone(), code.clone(), &options);
    assert_eq!(report.stopped, None);
}

/// Shortest time of a few runs, in nanoseconds.
fn nanoseconds(compiled: &Compiled) -> f64 {
    let code = code::jit(compiled).expect("the kernels compile");
    let times = (0..9).map(|_| {
        let start = Instant::now();
        run(compiled, &code);
        start.elapsed().as_nanos() as f64
    });
    times.fold(f64::INFINITY, f64::min)
}

fn print_table() {
    let empty = compile(&[], 0);
    let (empty_bytes, empty_time) = (code_bytes(&empty), nanoseconds(&empty));
    println!("{:<28}{:>16}{:>20}", "class", "ns/instruction", "bytes/instruction");
    for (name, kernel) in KERNELS {
        let compiled = compile(kernel, REPETITIONS);
        let instructions = (kernel.len() * REPETITIONS) as f64;
        let time = (nanoseconds(&compiled) - empty_time).max(0.0) / instructions / CYCLES as f64;
        let bytes = code_bytes(&compiled).saturating_sub(empty_bytes) as f64 / instructions;
        println!("{name:<28}{time:>16.2}{bytes:>20.1}");
    }
    println!();
}

fn main() {
    // `cargo test --benches` asks whether it works, not how fast it is.
    if std::env::args().any(|argument| argument == "--bench") {
        print_table();
    }
    divan::main();
}

#[divan::bench(args = 0..KERNELS.len())]
fn kernel(bencher: divan::Bencher, index: usize) {
    let compiled = compile(KERNELS[index].1, REPETITIONS);
    let code = code::jit(&compiled).expect("the kernels compile");
    let instructions = KERNELS[index].1.len() * REPETITIONS * CYCLES as usize;
    bencher.counter(ItemsCount::new(instructions)).bench_local(|| run(&compiled, &code));
}
