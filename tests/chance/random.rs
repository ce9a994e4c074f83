//! Random STL programs: the interpreter at -O0, and machine code at -O0 and -O2, leave the same memory and CPU registers, and the
//! printed IR parses back to the same IR.
//!
//! Memory is compared through assertions that hardly ever hold: a report of a failed assertion shows both values, so that equal
//! reports mean equal memory.

use std::fmt::Write as _;

use plcc_diag::SourceFile;
use plcc_driver::cli::{CpuFeatures, Level};
use plcc_driver::code;
use plcc_driver::inputs::{Read, TestInput};
use plcc_driver::pipeline::{self, Optimization, Settings};
use plcc_driver::testing::{self, Form, Variant};
use plcc_opt::Without;
use plcc_runtime::{TestOptions, TestReport};
use plcc_tests::{passes_of, plan, without};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

/// Memory bytes that programs use and that are compared: MB 0 to MB 63.
const MEMORY_BYTES: u32 = 64;

/// A part of a program; each is correct in every position.
#[derive(Clone, Debug)]
enum Piece {
    /// A line of instructions without jumps.
    Line(String),
    /// A conditional jump over pieces.
    Skip { jump: &'static str, over: Vec<Piece> },
    /// `LOOP`, this many times.
    Loop { count: u8, body: Vec<Piece> },
    /// A jump list by the value of a byte.
    JumpList { byte: u32, arms: Vec<Vec<Piece>> },
}

fn bit() -> impl Strategy<Value = String> {
    (0..MEMORY_BYTES, 0..8u8, 0..10u8).prop_map(|(byte, bit, area)| match area {
        0 => format!("I {}.{bit}", byte % 8),
        1 => format!("Q {}.{bit}", byte % 8),
        2 => format!("DB1.DBX {byte}.{bit}"),
        3 => format!("L {}.{bit}", byte % 16),
        _ => format!("M {byte}.{bit}"),
    })
}

/// A byte, word or double word of memory.
fn cell() -> impl Strategy<Value = String> {
    (0..MEMORY_BYTES - 3, 0..3u8, 0..10u8).prop_map(|(byte, width, area)| {
        let letter = ["B", "W", "D"][width as usize];
        match area {
            0 => format!("Q{letter} {}", byte % 8),
            1 | 2 => format!("DB1.DB{letter} {byte}"),
            3 => format!("L{letter} {}", byte % 12),
            _ => format!("M{letter} {byte}"),
        }
    })
}

fn constant() -> impl Strategy<Value = String> {
    prop_oneof![
        any::<i16>().prop_map(|value| value.to_string()),
        any::<i32>().prop_map(|value| format!("L#{value}")),
        any::<u32>().prop_map(|value| format!("DW#16#{value:08X}")),
        (-1000i32..1000).prop_map(|value| format!("{}.{:02}", value, value.unsigned_abs() % 100)),
        prop::sample::select(vec![
            "DW#16#7F800000",
            "DW#16#FF800000",
            "DW#16#FFFFFFFF",
            "DW#16#00000001",
            "L#-2147483648",
            "L#2147483647",
            "DW#16#7F7FFFFF",
            "0",
            "-1",
            "1",
        ])
        .prop_map(str::to_string),
    ]
}

/// Instructions on the accumulators and the status word alone.
const OPERATIONS: &[&str] = &[
    "+I",
    "-I",
    "*I",
    "/I",
    "+D",
    "-D",
    "*D",
    "/D",
    "MOD",
    "+R",
    "-R",
    "*R",
    "/R",
    "ABS",
    "NEGR",
    "SQR",
    "SQRT",
    "SIN",
    "ATAN",
    "EXP",
    "LN",
    "==I",
    "<>I",
    ">I",
    "<I",
    ">=I",
    "<=I",
    "==D",
    "<>D",
    ">D",
    "<D",
    ">=D",
    "<=D",
    "==R",
    "<>R",
    ">R",
    "<R",
    ">=R",
    "<=R",
    "ITB",
    "DTB",
    "ITD",
    "DTR",
    "RND",
    "RND+",
    "RND-",
    "TRUNC",
    "INVI",
    "INVD",
    "NEGI",
    "NEGD",
    "CAW",
    "CAD",
    "AW",
    "OW",
    "XOW",
    "AD",
    "OD",
    "XOD",
    "SLW",
    "SRW",
    "SLD",
    "SRD",
    "SSI",
    "SSD",
    "RLD",
    "RRD",
    "RLDA",
    "RRDA",
    "TAK",
    "PUSH",
    "POP",
    "INC 7",
    "DEC 200",
    "+ 5",
    "+ -300",
    "+ L#70000",
    "SLW 3",
    "SRW 5",
    "SLD 17",
    "SRD 32",
    "SSI 15",
    "SSD 1",
    "RLD 9",
    "RRD 31",
    "AW W#16#0FF0",
    "OD DW#16#80000001",
    "SET",
    "CLR",
    "NOT",
    "SAVE",
    "L STW",
    "A BR",
    "A OV",
    "O OS",
    "X >0",
    "AN <0",
    "A ==0",
    "ON <>0",
    "A UO",
    "O",
    "TAR1",
    "TAR2",
    "CAR",
    "+AR1 P#1.3",
    "LAR1 P#4.0",
    "T STW",
];

const BIT_OPERATIONS: &[&str] = &["A", "AN", "O", "ON", "X", "XN", "=", "S", "R", "FP", "FN"];
const SCANS: &[&str] = &["A", "AN", "O", "ON", "X", "XN"];
const NESTS: &[&str] = &["A(", "AN(", "O(", "ON(", "X(", "XN("];
const JUMPS: &[&str] =
    &["JU", "JC", "JCN", "JCB", "JNB", "JBI", "JNBI", "JO", "JOS", "JZ", "JN", "JP", "JM", "JPZ", "JMZ", "JUO"];

fn line() -> impl Strategy<Value = String> {
    let select = |list: &'static [&'static str]| prop::sample::select(list);
    let nest = (select(NESTS), prop::collection::vec((select(SCANS), bit()), 1..4)).prop_map(|(open, scans)| {
        let inner: String = scans.iter().map(|(scan, bit)| format!("      {scan} {bit}\n")).collect();
        format!("{open}\n{inner}      )")
    });
    prop_oneof![
        4 => select(OPERATIONS).prop_map(str::to_string),
        3 => cell().prop_map(|cell| format!("L {cell}")),
        2 => constant().prop_map(|constant| format!("L {constant}")),
        3 => cell().prop_map(|cell| format!("T {cell}")),
        3 => (select(BIT_OPERATIONS), bit()).prop_map(|(operation, bit)| format!("{operation} {bit}")),
        1 => nest,
        // Memory- and register-indirect, with pointers that stay inside.
        1 => (0u32..60, 0u8..8).prop_map(|(byte, bit)| format!("L P#{byte}.{bit}\n      T MD 100\n      A M [MD 100]")),
        1 => (0u32..56).prop_map(|byte| format!("L P#{byte}.0\n      T MD 100\n      L MD [MD 100]")),
        1 => (0u32..24, 0u32..24).prop_map(|(byte, offset)| format!("LAR1 P#M {byte}.0\n      T D [AR1,P#{offset}.0]")),
        1 => (0u32..24, 0u32..24).prop_map(|(byte, offset)| format!("LAR1 P#{byte}.0\n      L MW [AR1,P#{offset}.0]")),
        1 => (0u32..30, 0u32..30).prop_map(|(a, b)| format!("CALL FC 1 (a := MW {a}, b := MD {b}, c := MD {}, d := M {a}.1);", b + 30)),
        1 => (0u32..30).prop_map(|a| format!("CALL FB 1, DB 2 (step := MW {a}, total := MD {});", a + 30)),
        1 => Just("UC FC 2".to_string()),
        1 => Just("CC FC 2".to_string()),
    ]
}

fn piece() -> impl Strategy<Value = Piece> {
    let leaf = line().prop_map(Piece::Line);
    leaf.prop_recursive(3, 40, 6, |inner| {
        let pieces = prop::collection::vec(inner, 1..6);
        prop_oneof![
            (prop::sample::select(JUMPS), pieces.clone()).prop_map(|(jump, over)| Piece::Skip { jump, over }),
            (1..4u8, pieces.clone()).prop_map(|(count, body)| Piece::Loop { count, body }),
            (0..MEMORY_BYTES, prop::collection::vec(pieces, 1..4))
                .prop_map(|(byte, arms)| Piece::JumpList { byte, arms }),
        ]
    })
}

/// Writes pieces as statements; labels and loop counters are numbered.
struct Writer {
    text: String,
    labels: u32,
    depth: u32,
}

impl Writer {
    fn label(&mut self) -> String {
        self.labels += 1;
        format!("l{}", self.labels)
    }

    fn line(&mut self, text: &str) {
        writeln!(self.text, "      {text}").expect("a string takes all");
    }

    fn place(&mut self, label: &str) {
        writeln!(self.text, "{label}: NOP 0").expect("a string takes all");
    }

    fn pieces(&mut self, pieces: &[Piece]) {
        for piece in pieces {
            match piece {
                Piece::Line(line) => self.line(line),
                Piece::Skip { jump, over } => {
                    let label = self.label();
                    self.line(&format!("{jump} {label}"));
                    self.pieces(over);
                    self.place(&label);
                }
                Piece::Loop { count, body } => {
                    // A separate counter at each depth, outside the memory that pieces write.
                    let (label, counter) = (self.label(), 110 + 2 * self.depth);
                    self.depth += 1;
                    self.line(&format!("L {count}"));
                    self.place(&label);
                    self.line(&format!("T MW {counter}"));
                    self.pieces(body);
                    self.line(&format!("L MW {counter}"));
                    self.line(&format!("LOOP {label}"));
                    self.depth -= 1;
                }
                Piece::JumpList { byte, arms } => {
                    let (default, end) = (self.label(), self.label());
                    let labels: Vec<String> = arms.iter().map(|_| self.label()).collect();
                    self.line(&format!("L MB {byte}"));
                    self.line(&format!("JL {default}"));
                    labels.iter().for_each(|label| self.line(&format!("JU {label}")));
                    self.place(&default);
                    self.line(&format!("JU {end}"));
                    for (label, arm) in labels.iter().zip(arms) {
                        self.place(label);
                        self.pieces(arm);
                        self.line(&format!("JU {end}"));
                    }
                    self.place(&end);
                }
            }
        }
    }
}

/// Blocks that random programs call.
const BLOCKS: &str = "
DATA_BLOCK DB 1
STRUCT
  r : ARRAY [0 .. 71] OF BYTE;
END_STRUCT;
BEGIN
END_DATA_BLOCK
FUNCTION FC 1 : VOID
VAR_INPUT
  a : INT;
  b : DWORD;
END_VAR
VAR_OUTPUT
  c : DWORD;
END_VAR
VAR_IN_OUT
  d : BOOL;
END_VAR
BEGIN
      L     #a
      L     #b
      XOD
      T     #c
      A     #d
      NOT
      =     #d
END_FUNCTION
FUNCTION FC 2 : VOID
BEGIN
      L     MW 20
      L     3
      *I
      T     MW 20
      A     M 21.0
      SAVE
END_FUNCTION
FUNCTION_BLOCK FB 1
VAR_INPUT
  step : INT;
END_VAR
VAR_OUTPUT
  total : DINT;
END_VAR
VAR
  sum : DINT;
END_VAR
BEGIN
      L     #step
      ITD
      L     #sum
      +D
      T     #sum
      T     #total
END_FUNCTION_BLOCK
DATA_BLOCK DB 2
FB 1
BEGIN
END_DATA_BLOCK
";

/// A whole program whose last statements assert everything that can be seen.
fn program(pieces: &[Piece], seed: &[u32]) -> String {
    let mut writer = Writer { text: String::new(), labels: 0, depth: 0 };
    for (index, value) in seed.iter().enumerate() {
        writer.line(&format!("L DW#16#{value:08X}"));
        writer.line(&format!("T MD {}", 4 * index));
    }
    writer.pieces(pieces);
    for register in ["ACCU1", "ACCU2", "AR1", "AR2", "STW", "DBNO", "DINO"] {
        writeln!(writer.text, "//@ assert {register} == DW#16#DEADBEEF").expect("a string takes all");
    }
    for byte in (0..MEMORY_BYTES).step_by(4) {
        for area in ["M", "DB1.DB"] {
            writeln!(writer.text, "//@ assert {area}D {byte} == DW#16#DEADBEEF").expect("a string takes all");
        }
    }
    for address in ["QD 0", "QD 4", "DB2.DBD 0", "DB2.DBD 4", "DB2.DBW 8"] {
        writeln!(writer.text, "//@ assert {address} == DW#16#DEADBEEF").expect("a string takes all");
    }
    format!(
        "{BLOCKS}ORGANIZATION_BLOCK OB 1\nVAR_TEMP\n  t : ARRAY [0 .. 19] OF BYTE;\nEND_VAR\nBEGIN\n{}END_ORGANIZATION_BLOCK\n",
        writer.text
    )
}

/// A pointer, usually to somewhere that does not exist: every area code, and offsets at the ends of areas.
fn pointer() -> impl Strategy<Value = u32> {
    let code =
        prop::sample::select(vec![0x00, 0x01, 0x04, 0x7F, 0x80, 0x81, 0x82, 0x83, 0x84, 0x85, 0x86, 0x87, 0x88, 0xFF]);
    (code, offset()).prop_map(|(code, offset): (u32, u32)| code << 24 | offset)
}

/// An offset in bits.
fn offset() -> impl Strategy<Value = u32> {
    let ends = [10, 60, 72, 2048, 8192, 0x8000, 0x1_0000];
    prop_oneof![
        (prop::sample::select(ends.to_vec()), 0..40u32).prop_map(|(byte, back)| 8 * byte - back),
        (0..80u32).prop_map(|byte| 8 * byte),
        prop::sample::select(vec![0x7_FFFF, 0x8_0000, 0xFF_FFFF]),
    ]
}

/// An instruction through a pointer or a number that may not exist.
fn wild() -> impl Strategy<Value = String> {
    let access = || prop::sample::select(vec!["L", "T"]);
    let width = || prop::sample::select(vec!["B", "W", "D"]);
    let area = || prop::sample::select(vec!["M", "I", "Q", "DB", "DI", "L"]);
    let shift = || prop::sample::select(vec![0u32, 1, 8, 70, 4095]);
    let numbered = prop::sample::select(vec![
        "OPN DB [MW 100]",
        "OPN DI [MW 100]",
        "UC FC [MW 100]",
        "UC FB [MW 100]",
        "L T [MW 100]",
        "LC C [MW 100]",
        "A T [MW 100]",
        "CU C [MW 100]",
        "SP T [MW 100]",
        "R C [MW 100]",
        "FR T [MW 100]",
        "S C [MW 100]",
        "BTI",
        "BTD",
    ]);
    prop_oneof![
        (pointer(), access(), width(), shift()).prop_map(|(p, access, width, shift)| format!(
            "L DW#16#{p:X}\n      LAR1\n      {access} {width} [AR1,P#{shift}.0]"
        )),
        (pointer(), prop::sample::select(BIT_OPERATIONS), shift(), 0..8u8).prop_map(
            |(p, operation, shift, bit)| format!("L DW#16#{p:X}\n      LAR2\n      {operation} [AR2,P#{shift}.{bit}]")
        ),
        (offset(), access(), area(), width(), shift()).prop_map(|(p, access, area, width, shift)| format!(
            "L DW#16#{p:X}\n      LAR1\n      {access} {area}{width} [AR1,P#{shift}.0]"
        )),
        (pointer(), access(), area(), width()).prop_map(|(p, access, area, width)| format!(
            "L DW#16#{p:X}\n      T MD 100\n      {access} {area}{width} [MD 100]"
        )),
        (prop::sample::select(vec![0i32, 1, 2, 3, 99, 2047, 2048, 32767, -1]), numbered)
            .prop_map(|(number, line)| format!("L {number}\n      T MW 100\n      {line}")),
        (access(), width(), 0..90u32).prop_map(|(access, width, byte)| format!("{access} DI{width} {byte}")),
        (access(), width(), 0..90u32).prop_map(|(access, width, byte)| format!("{access} DB{width} {byte}")),
        line(),
    ]
}

/// Error OBs that copy their start information into the compared memory.
const ERROR_BLOCKS: &str = "
ORGANIZATION_BLOCK OB 121
VAR_TEMP
  t : ARRAY [0 .. 19] OF BYTE;
END_VAR
BEGIN
      L     LD 0
      L     MD 56
      XOD
      RLD   3
      T     MD 56
      L     LD 4
      L     MD 60
      XOD
      RLD   5
      T     MD 60
      CALL  SFC 44 (VAL := DW#16#12345678, RET_VAL := MW 104);
END_ORGANIZATION_BLOCK
";

/// Compiles `source`, checks that its IR prints and parses back, and runs it: in the interpreter at -O0, and in the ways that must do the
/// same, with their names. Of these, two are without a pass, another one for each `index`, and one is for this
/// processor.
fn reports(source: &str, index: usize) -> Result<(TestReport, Vec<(String, TestReport)>), String> {
    let mut read = Read { name: "random".to_string(), ..Read::default() };
    read.units.push(read.sources.add(SourceFile::new("random.stl", source)));
    let bound = pipeline::front(read, &Settings { pragmas: true, require_main: true, ..Settings::default() });
    if bound.has_errors() {
        return Err(plcc_diag::drawing::draw(&bound.diagnostics, &bound.sources, false));
    }
    let mut ways: Vec<Optimization> = [Level::O0, Level::O2].map(Optimization::from).to_vec();
    ways.extend(passes_of(index, 1).into_iter().map(without));
    ways.push(Optimization { cpu_features: CpuFeatures::Native, ..Level::O2.into() });
    let programs: Vec<pipeline::Compiled> = ways.into_iter().map(|way| pipeline::back(&bound, way)).collect();
    for compiled in &programs {
        plcc_ir::verify::verify(&compiled.module).map_err(|errors| format!("{errors:?}"))?;
        let text = plcc_ir::print::module_text(&compiled.module);
        let parsed = plcc_ir::parse::parse_module(&text).map_err(|error| error.to_string())?;
        if plcc_ir::print::module_text(&parsed) != text {
            return Err(format!("the printed IR does not parse back:\n{text}"));
        }
    }
    let run = |compiled: &pipeline::Compiled, code| {
        plcc_runtime::test(compiled.image.clone(), code, &TestOptions { cycles: Some(2), ..TestOptions::default() })
    };
    let jit = |compiled| code::jit(compiled).map_err(|error| error.to_string());
    let mut reports = Vec::new();
    for compiled in &programs {
        let name = compiled.optimization;
        if name.without != Without::NOTHING {
            reports.push((format!("interpreter {name}"), run(compiled, code::interpreter(compiled))));
        }
        reports.push((format!("jit {name}"), run(compiled, jit(compiled)?)));
    }
    Ok((run(&programs[0], code::interpreter(&programs[0])), reports))
}

/// All ways to run `source` give the same report.
fn check(source: &str, index: usize) -> Result<(), TestCaseError> {
    let text = source.to_string();
    let result = plcc_driver::on_large_stack(move || reports(&text, index)).and_then(|result| result);
    let (interpreted, others) = result.map_err(|error| TestCaseError::fail(format!("{error}\n{source}")))?;
    for (way, report) in &others {
        prop_assert_eq!(&interpreted, report, "{}\n{}", way, source);
    }
    Ok(())
}

/// Executables of programs from a fixed sequence, each at -O2 and without a pass, do the same as the interpreter.
#[test]
fn executables_leave_the_same_memory() {
    let mut runner = TestRunner::deterministic();
    let strategy = (prop::collection::vec(piece(), 1..40), prop::collection::vec(any::<u32>(), 16));
    let folder = tempfile::tempdir().expect("there is room for temporary files");
    for (index, pass) in Without::each().into_iter().enumerate() {
        let sources: Vec<TestInput> = (0..EXECUTABLES)
            .map(|number| {
                let (pieces, seed) = strategy.new_tree(&mut runner).expect("nothing is filtered").current();
                let path = folder.path().join(format!("{index}-{number}.stl"));
                std::fs::write(&path, program(&pieces, &seed)).expect("it is written");
                TestInput::File(path)
            })
            .collect();
        let interpreter = Variant { form: Form::Interp, optimization: Level::O0.into() };
        let machine = [Level::O2.into(), without(pass)].map(|optimization| Variant { form: Form::Exe, optimization });
        let plan = plan([vec![interpreter], machine.to_vec()].concat());
        let outcomes = plcc_driver::on_large_stack(move || testing::run(&sources, &plan)).expect("no fault of plcc");
        for outcome in outcomes {
            // The assertions fail on purpose, in each form with the same values.
            let wrong = |line: &&str| line.contains("do not agree") || line.contains("internal fault");
            let wrong: Vec<&str> = outcome.failures.lines().filter(wrong).collect();
            assert!(wrong.is_empty() && outcome.failed > 0, "{pass}: {}\n{}", outcome.messages, outcome.failures);
        }
    }
}

/// Programs for each pass.
const EXECUTABLES: usize = 3;

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, max_shrink_iters: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn all_forms_leave_the_same_memory(
        pieces in prop::collection::vec(piece(), 1..40),
        seed in prop::collection::vec(any::<u32>(), 16),
        index in any::<usize>(),
    ) {
        check(&program(&pieces, &seed), index)?;
    }

    /// Faults and all: pointers into every area and out of it, with OB 121 or without.
    #[test]
    fn wild_pointers_leave_the_same_memory(
        lines in prop::collection::vec(wild(), 1..30),
        seed in prop::collection::vec(any::<u32>(), 16),
        error_block in prop::bool::weighted(0.8),
        index in any::<usize>(),
    ) {
        let pieces: Vec<Piece> = lines.into_iter().map(Piece::Line).collect();
        let source = format!("{}{}", if error_block { ERROR_BLOCKS } else { "" }, program(&pieces, &seed));
        check(&source, index)?;
    }
}
