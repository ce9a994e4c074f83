//! Cost of the instruction classes: time and machine code of one instruction, in JIT code at -O2.
//!
//! Each kernel is a short sequence, repeated in OB 1; the same OB without it is subtracted. `cargo bench` prints a table, then one of
//! networks in LAD next to the STL that does the same, then the distribution of each kernel's run. How to read it: docs/benchmarks.md.

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

/// Name, instructions. Operands change from one repetition to the next: `{b}` is the address of a word, `{d}` of a double word,
/// `{x}` a bit, `{n}` the number of the repetition.
const KERNELS: &[(&str, &[&str])] = &[
    ("bit logic", &["A I {b}.{x}", "AN M {b}.{x}", "O M {b}.1", "= Q {b}.{x}"]),
    ("set and reset", &["A I {b}.{x}", "S M {b}.{x}", "AN I {b}.{x}", "R M {b}.{x}"]),
    ("edges", &["A I {b}.{x}", "FP M {b}.{x}", "= Q {b}.{x}"]),
    ("load and transfer", &["L MW {b}", "T QW {b}"]),
    ("load and transfer in a DB", &["L DB1.DBW {b}", "T DB2.DBW {b}"]),
    ("16-bit arithmetic", &["L MW {b}", "L IW {b}", "+I", "T QW {b}"]),
    ("32-bit arithmetic", &["L MD {d}", "L ID {d}", "*D", "T QD {d}"]),
    ("REAL arithmetic", &["L MD {d}", "L ID {d}", "+R", "T QD {d}"]),
    ("comparison", &["L MW {b}", "L IW {b}", ">I", "= Q {b}.{x}"]),
    ("word logic", &["L MW {b}", "L IW {b}", "XOW", "T QW {b}"]),
    ("shift", &["L MW {b}", "SLW 3", "T QW {b}"]),
    ("conversion", &["L MW {b}", "ITD", "DTR", "T QD {d}"]),
    ("memory-indirect", &["L MW [MD {d}]", "T QW {b}"]),
    ("register-indirect", &["LAR1 MD {d}", "L MW [AR1, P#{b}.0]", "T QW {b}"]),
    ("jump", &["A I {b}.{x}", "JC m{n}", "L MW {b}", "T QW {b}", "m{n}: NOP 0"]),
    ("timer", &["A I {b}.{x}", "L S5T#1S", "SD T {b}", "A T {b}", "= Q {b}.{x}"]),
    ("counter", &["A I {b}.{x}", "CU C {b}", "L C {b}", "T QW {b}"]),
    ("block call", &["CALL FC 1 (a := MW {b}, b := QW {b});"]),
    ("the same in place", &["L MW {b}", "NEGI", "T QW {b}"]),
    ("FC with BOOLs", &["CALL FC 2 (a := I {b}.{x}, b := M {b}.{x}, q := Q {b}.{x});"]),
    ("the same in place", &["A I {b}.{x}", "AN M {b}.{x}", "= Q {b}.{x}"]),
    ("FC with constants", &["CALL FC 3 (v := MW {b}, low := -100, high := 100, r := QW {b});"]),
    ("nested FCs", &["CALL FC 4 (a := MW {b}, b := IW {b}, c := 7, r := QW {b});"]),
    ("FB with instance DB", &["CALL FB 1, DB 11 (a := I {b}.{x}, v := MW {b}, r := QW {b});"]),
    ("FB with multi-instance", &["CALL FB 2, DB 12 (a := I {b}.{x}, v := MW {b}, r := QW {b});"]),
    ("large FC", &["CALL FC 6 (a := MW {b}, b := IW {b}, r := QW {b});"]),
];

/// A network in LAD, and STL that does the same.
struct Pair {
    name: &'static str,
    /// Data block of each network, in SIMATIC SD and in STL.
    data: Option<[&'static str; 2]>,
    lad: &'static [&'static str],
    stl: &'static [&'static str],
}

/// Networks of LAD. Places as in `KERNELS`; `{k}` is the number of a data block, `{w}` the address of another word, `{y}` another byte.
const PAIRS: &[Pair] = &[
    Pair {
        name: "contacts and coil",
        data: None,
        lad: &[
            "RUNG wire#powerrail Contact( %I{b}.{x} ) wire#w1 I_Contact( %M{b}.{x} ) Coil( %Q{b}.{x} ) END_RUNG",
            "RUNG wire#powerrail Contact( %M{b}.1 ) END_RUNG wire#w1",
        ],
        stl: &["A(", "O I {b}.{x}", "O M {b}.1", ")", "AN M {b}.{x}", "= Q {b}.{x}"],
    },
    Pair {
        name: "set coil",
        data: None,
        lad: &["RUNG wire#powerrail Contact( %I{b}.{x} ) S_Coil( %M{b}.{x} ) END_RUNG"],
        stl: &["A I {b}.{x}", "S M {b}.{x}"],
    },
    Pair {
        name: "chain of boxes",
        data: None,
        lad: &[
            "RUNG wire#powerrail Contact( %I{b}.{x} )",
            "{ S7_Templates := \"SrcType := Int\"; S7_GenerateENO := \"TRUE\" } Add( in1 := %MW{b}, in2 := %IW{b}, out => %QW{b} )",
            "{ S7_Templates := \"SrcType := Int\"; S7_GenerateENO := \"TRUE\" } Sub( in1 := %QW{b}, in2 := 7, out => %MW{w} ) Coil( %M{y}.{x} ) END_RUNG",
        ],
        stl: &[
            "A I {b}.{x}",
            "JNB e{n}",
            "L MW {b}",
            "L IW {b}",
            "+I",
            "T QW {b}",
            "AN OV",
            "SAVE",
            "CLR",
            "e{n}: A BR",
            "JNB f{n}",
            "L QW {b}",
            "L 7",
            "-I",
            "T MW {w}",
            "AN OV",
            "SAVE",
            "CLR",
            "f{n}: A BR",
            "= M {y}.{x}",
        ],
    },
    Pair {
        name: "TON",
        data: Some([
            "DATA_BLOCK T{n} : TON_TIME\nEND_DATA_BLOCK\n",
            "DATA_BLOCK DB {k}\nSFB 4\nBEGIN\nEND_DATA_BLOCK\n",
        ]),
        lad: &[
            "RUNG wire#powerrail Contact( %I{b}.{x} )",
            "{ S7_Templates := \"time_type := Time\" } \"T{n}\".TON( pt := T#1s, et => ) Coil( %Q{b}.{x} ) END_RUNG",
        ],
        stl: &["CALL SFB 4, DB {k} (IN := I {b}.{x}, PT := T#1S, Q := Q {b}.{x});"],
    },
    Pair {
        name: "CTU",
        data: Some([
            "DATA_BLOCK C{n} : CTU_INT\nEND_DATA_BLOCK\n",
            "DATA_BLOCK DB {k}\nSFB 0\nBEGIN\nEND_DATA_BLOCK\n",
        ]),
        lad: &[
            "RUNG wire#powerrail Contact( %I{b}.{x} )",
            "{ S7_Templates := \"value_type := Int\" } \"C{n}\".CTU( r := %M{b}.{x}, pv := 9, cv => )",
            "Coil( %Q{b}.{x} ) END_RUNG",
        ],
        stl: &["CALL SFB 0, DB {k} (CU := I {b}.{x}, R := M {b}.{x}, PV := 9, Q := Q {b}.{x});"],
    },
];

/// How often a kernel is in OB 1.
const REPETITIONS: usize = 250;

/// Cycles of one run: enough that making the CPU does not count.
const CYCLES: u64 = 4000;

/// Runs that a row of the table is the median of.
const RUNS: usize = 21;

const BLOCKS: &str = "
DATA_BLOCK DB 1
STRUCT
  r : ARRAY [0 .. 599] OF BYTE;
END_STRUCT;
BEGIN
END_DATA_BLOCK
DATA_BLOCK DB 2
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
FUNCTION FC 2 : VOID
VAR_INPUT
  a : BOOL;
  b : BOOL;
END_VAR
VAR_OUTPUT
  q : BOOL;
END_VAR
BEGIN
      A     #a
      AN    #b
      =     #q
END_FUNCTION
FUNCTION FC 3 : VOID
VAR_INPUT
  v : INT;
  low : INT;
  high : INT;
END_VAR
VAR_OUTPUT
  r : INT;
END_VAR
BEGIN
      L     #v
      L     #low
      <I
      JC    set
      TAK
      L     #high
      >I
      JC    set
      TAK
set:  T     #r
END_FUNCTION
FUNCTION FC 4 : VOID
VAR_INPUT
  a : INT;
  b : INT;
  c : INT;
END_VAR
VAR_OUTPUT
  r : INT;
END_VAR
VAR_TEMP
  t : INT;
END_VAR
BEGIN
      CALL FC 5 (a := #a, b := #b, r := #t);
      CALL FC 5 (a := #t, b := #c, r := #r);
END_FUNCTION
FUNCTION FC 5 : VOID
VAR_INPUT
  a : INT;
  b : INT;
END_VAR
VAR_OUTPUT
  r : INT;
END_VAR
BEGIN
      L     #a
      L     #b
      +I
      T     #r
END_FUNCTION
FUNCTION FC 6 : VOID
VAR_INPUT
  a : INT;
  b : INT;
END_VAR
VAR_OUTPUT
  r : INT;
END_VAR
VAR_TEMP
  s : INT;
  t : INT;
END_VAR
BEGIN
      L     #a
      T     #s
      L     #b
      T     #t
      L     #s
      L     #t
      >I
      JC    m00
      L     MW 2000
      +I
      T     #s
m00: L     #t
      L     3
      *I
      T     #t
      L     #s
      L     #t
      >I
      JC    m01
      L     MW 2002
      +I
      T     #s
m01: L     #t
      L     4
      *I
      T     #t
      L     #s
      L     #t
      >I
      JC    m02
      L     MW 2004
      +I
      T     #s
m02: L     #t
      L     5
      *I
      T     #t
      L     #s
      L     #t
      >I
      JC    m03
      L     MW 2006
      +I
      T     #s
m03: L     #t
      L     6
      *I
      T     #t
      L     #s
      L     #t
      >I
      JC    m04
      L     MW 2008
      +I
      T     #s
m04: L     #t
      L     7
      *I
      T     #t
      L     #s
      L     #t
      >I
      JC    m05
      L     MW 2010
      +I
      T     #s
m05: L     #t
      L     8
      *I
      T     #t
      L     #s
      L     #t
      >I
      JC    m06
      L     MW 2012
      +I
      T     #s
m06: L     #t
      L     9
      *I
      T     #t
      L     #s
      L     #t
      >I
      JC    m07
      L     MW 2014
      +I
      T     #s
m07: L     #t
      L     10
      *I
      T     #t
      L     #s
      L     #t
      >I
      JC    m08
      L     MW 2016
      +I
      T     #s
m08: L     #t
      L     11
      *I
      T     #t
      L     #s
      L     #t
      >I
      JC    m09
      L     MW 2018
      +I
      T     #s
m09: L     #t
      L     12
      *I
      T     #t
      L     #s
      L     #t
      >I
      JC    m10
      L     MW 2020
      +I
      T     #s
m10: L     #t
      L     13
      *I
      T     #t
      L     #s
      L     #t
      >I
      JC    m11
      L     MW 2022
      +I
      T     #s
m11: L     #t
      L     14
      *I
      T     #t
      L     #s
      L     #t
      -I
      T     #r
END_FUNCTION
FUNCTION_BLOCK FB 1
VAR_INPUT
  a : BOOL;
  v : INT;
END_VAR
VAR_OUTPUT
  r : INT;
END_VAR
VAR
  edge : BOOL;
  count : INT;
END_VAR
BEGIN
      A     #a
      FP    #edge
      JCN   out
      L     #count
      L     #v
      +I
      T     #count
out:  L     #count
      T     #r
END_FUNCTION_BLOCK
FUNCTION_BLOCK FB 2
VAR_INPUT
  a : BOOL;
  v : INT;
END_VAR
VAR_OUTPUT
  r : INT;
END_VAR
VAR
  inner : FB 1;
END_VAR
BEGIN
      CALL #inner (a := #a, v := #v, r := #r);
END_FUNCTION_BLOCK
DATA_BLOCK DB 11
FB 1
BEGIN
END_DATA_BLOCK
DATA_BLOCK DB 12
FB 2
BEGIN
END_DATA_BLOCK
";

/// A line with the numbers of its repetition.
fn filled(line: &str, index: usize) -> String {
    let places = [
        ("{b}", 2 * index),
        ("{d}", 1000 + 4 * index),
        ("{x}", index % 8),
        ("{n}", index),
        ("{k}", 100 + index),
        ("{w}", 1000 + 2 * index),
        ("{y}", 2000 + index),
    ];
    places.iter().fold(line.to_string(), |line, (mark, number)| line.replace(mark, &number.to_string()))
}

fn compile(kernel: &[&str], repetitions: usize) -> Compiled {
    compile_stl(BLOCKS, kernel, repetitions)
}

fn compile_stl(blocks: &str, kernel: &[&str], repetitions: usize) -> Compiled {
    let mut source = format!("{blocks}ORGANIZATION_BLOCK OB 1\nBEGIN\n");
    for index in 0..repetitions {
        for line in kernel {
            source.push_str(&format!("      {}\n", filled(line, index)));
        }
    }
    source.push_str("END_ORGANIZATION_BLOCK\n");
    compiled("bench.stl", source)
}

/// The two programs of a pair.
fn compile_pair(pair: &Pair, repetitions: usize) -> [Compiled; 2] {
    let data = |at: usize| -> String {
        let block = pair.data.map_or("", |data| data[at]);
        (0..repetitions).map(|index| filled(block, index)).collect()
    };
    let mut source = format!("{}ORGANIZATION_BLOCK Main\n", data(0));
    for index in 0..repetitions {
        source.push_str("{ S7_Language := \"LAD\" }\nNETWORK\n");
        for line in pair.lad {
            source.push_str(&format!("{}\n", filled(line, index)));
        }
        source.push_str("END_NETWORK\n");
    }
    source.push_str("END_ORGANIZATION_BLOCK\n");
    [compiled("bench.s7dcl", source), compile_stl(&data(1), pair.stl, repetitions)]
}

fn compiled(name: &str, source: String) -> Compiled {
    let mut read = Read { name: "bench".to_string(), ..Read::default() };
    read.units.push(read.sources.add(SourceFile::new(name, source)));
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

/// Shortest and median time of a run, in nanoseconds.
fn nanoseconds(compiled: &Compiled) -> [f64; 2] {
    let code = code::jit(compiled).expect("the kernels compile");
    let mut times = [0.0; RUNS];
    for time in &mut times {
        let start = Instant::now();
        run(compiled, &code);
        *time = start.elapsed().as_nanos() as f64;
    }
    times.sort_by(f64::total_cmp);
    [times[0], times[RUNS / 2]]
}

fn print_table() {
    let empty = compile(&[], 0);
    let (empty_bytes, empty_times) = (code_bytes(&empty), nanoseconds(&empty));
    println!("{:<28}{:>12}{:>12}{:>20}", "class", "fastest ns", "median ns", "bytes/instruction");
    for (name, kernel) in KERNELS {
        let compiled = compile(kernel, REPETITIONS);
        let instructions = (kernel.len() * REPETITIONS) as f64;
        let times = nanoseconds(&compiled);
        let [fastest, median] = [0, 1].map(|at| (times[at] - empty_times[at]) / instructions / CYCLES as f64);
        let bytes = code_bytes(&compiled).saturating_sub(empty_bytes) as f64 / instructions;
        println!("{name:<28}{fastest:>12.2}{median:>12.2}{bytes:>20.1}");
    }
    println!();
}

/// The cost of a network in LAD and in STL, from the fastest runs.
fn print_pairs() {
    println!("{:<28}{:>12}{:>12}{:>10}{:>12}{:>12}", "network", "LAD ns", "STL ns", "ratio", "LAD bytes", "STL bytes");
    for pair in PAIRS {
        let (full, empty) = (compile_pair(pair, REPETITIONS), compile_pair(pair, 0));
        let cost = |at: usize| {
            let networks = REPETITIONS as f64;
            let time = (nanoseconds(&full[at])[0] - nanoseconds(&empty[at])[0]) / networks / CYCLES as f64;
            (time, code_bytes(&full[at]).saturating_sub(code_bytes(&empty[at])) as f64 / networks)
        };
        let ((lad, lad_bytes), (stl, stl_bytes)) = (cost(0), cost(1));
        let ratio = lad / stl;
        println!("{:<28}{lad:>12.2}{stl:>12.2}{ratio:>10.2}{lad_bytes:>12.1}{stl_bytes:>12.1}", pair.name);
    }
    println!();
}

fn main() {
    // `cargo test --benches` checks that it works, not its speed.
    if std::env::args().any(|argument| argument == "--bench") {
        print_table();
        print_pairs();
    }
    divan::main();
}

#[divan::bench(args = KERNELS.iter().map(|(name, _)| *name), sample_count = 20, sample_size = 1)]
fn kernel(bencher: divan::Bencher, name: &str) {
    let (_, lines) = KERNELS.iter().find(|(other, _)| *other == name).expect("the argument comes from the table");
    let compiled = compile(lines, REPETITIONS);
    let code = code::jit(&compiled).expect("the kernels compile");
    let instructions = lines.len() * REPETITIONS * CYCLES as usize;
    bencher.counter(ItemsCount::new(instructions)).bench_local(|| run(&compiled, &code));
}
