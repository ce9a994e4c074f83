//! Programs that are sixteen times as long take about sixteen times the work: each shape of program in which something could be compared with
//! everything. Work is processor time of this process and bytes that were allocated; both hardly depend on other load on the computer.

#![allow(unsafe_code, reason = "an allocator that counts, and the clock of the process")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};

use plcc_convert::from_scl;
use plcc_diag::SourceFile;
use plcc_driver::cli::Level;
use plcc_driver::code;
use plcc_driver::inputs::Read;
use plcc_driver::pipeline::{self, Settings};
use plcc_syntax::scl as syntax;

/// Counts bytes.
struct Counting;

static ALLOCATED: AtomicU64 = AtomicU64::new(0);

// SAFETY: every call is passed on to the allocator of the system.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATED.fetch_add(layout.size() as u64, Ordering::Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // A growing vector is copied at most as often as it doubles.
        ALLOCATED.fetch_add(size.saturating_sub(layout.size()) as u64, Ordering::Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A shape of program: its name, the ending of its file, the smaller size, and its text.
struct Shape {
    name: &'static str,
    ending: &'static str,
    size: usize,
    text: fn(usize) -> String,
}

/// `line` for each number.
fn lines(count: usize, line: impl Fn(usize) -> String) -> String {
    (0..count).map(line).collect()
}

fn scl(declarations: &str, body: &str) -> String {
    format!("ORGANIZATION_BLOCK \"Main\"\n{declarations}BEGIN\n{body}END_ORGANIZATION_BLOCK\n")
}

fn temps(count: usize) -> String {
    format!("VAR_TEMP\n{}END_VAR\n", lines(count, |i| format!("t{i} : Int;\n")))
}

fn stl(before: &str, body: &str) -> String {
    format!(
        "{before}ORGANIZATION_BLOCK OB 1\nVAR_TEMP\ninfo : ARRAY [0..19] OF BYTE;\nEND_VAR\nBEGIN\n{body}END_ORGANIZATION_BLOCK\n"
    )
}

fn ladder(rungs: &str) -> String {
    format!(
        "ORGANIZATION_BLOCK Main\n{{ S7_Language := \"LAD\" }}\nNETWORK\n{rungs}END_NETWORK\nEND_ORGANIZATION_BLOCK\n"
    )
}

const SHAPES: &[Shape] = &[
    Shape {
        name: "variables over joins",
        ending: "scl",
        size: 187,
        text: |n| {
            let ifs = lines(n, |i| format!("IF %M{}.0 THEN #t{i} := 1; END_IF;\n", i % 1000));
            let uses = lines(n, |i| format!("%MW{} := #t{i};\n", i % 1000 * 2));
            scl(&temps(n), &(ifs + &uses))
        },
    },
    Shape {
        name: "variables over arms",
        ending: "scl",
        size: 100,
        text: |n| {
            let arms = lines(n, |i| format!("{i}: #t{i} := 1;\n"));
            let uses = lines(n, |i| format!("%MW{} := #t{i};\n", i % 1000 * 2));
            scl(&temps(n), &format!("CASE %MW0 OF\n{arms}END_CASE;\n{uses}"))
        },
    },
    Shape {
        name: "alternatives",
        ending: "scl",
        size: 125,
        text: |n| {
            let arms = lines(n, |i| format!("ELSIF %MW0 = {i} THEN #t0 := {i};\n"));
            scl(&temps(1), &format!("IF %M0.0 THEN #t0 := 1;\n{arms}END_IF;\n%MW2 := #t0;\n"))
        },
    },
    Shape {
        name: "loops",
        ending: "scl",
        size: 125,
        text: |n| {
            let body = lines(n, |i| format!("WHILE #t{i} < %MW{} DO #t{i} := #t{i} + 1; END_WHILE;\n", i % 1000 * 2));
            scl(&temps(n), &body)
        },
    },
    Shape {
        name: "calls of functions",
        ending: "scl",
        size: 125,
        text: |n| {
            let function = "FUNCTION \"F\" : Int\nVAR_INPUT a : Int; END_VAR\nBEGIN\nIF #a > 3 THEN #F := #a; END_IF;\nEND_FUNCTION\n";
            let calls = lines(n, |i| format!("%MW{} := \"F\"(a := %MW{});\n", i % 1000 * 2, i % 999 * 2));
            function.to_string() + &scl("", &calls)
        },
    },
    Shape {
        name: "jumps back",
        ending: "stl",
        size: 125,
        text: |n| {
            stl("", &lines(n, |i| format!("L{i:x}: L MW {0}\n+ 1\nT MW {0}\nL 5\n<I\nJC L{i:x}\n", i % 1000 * 2)))
        },
    },
    Shape {
        name: "calls of blocks with instances",
        ending: "stl",
        size: 250,
        text: |n| {
            let block = "FUNCTION_BLOCK FB 1\nVAR_INPUT a : INT; END_VAR\nVAR c : INT; END_VAR\nBEGIN\nL #a\nL #c\n+I\nT #c\nEND_FUNCTION_BLOCK\n";
            let data = lines(n, |i| format!("DATA_BLOCK DB {}\nFB 1\nBEGIN\nEND_DATA_BLOCK\n", i + 1));
            stl(
                &format!("{block}{data}"),
                &lines(n, |i| format!("CALL FB 1, DB {} (a := MW {});\n", i + 1, i % 1000 * 2)),
            )
        },
    },
    Shape {
        name: "networks of an S7-200",
        ending: "awl",
        size: 250,
        text: |n| {
            let networks = lines(n, |i| {
                format!(
                    "Network {}\nLD I0.{}\nMOVW {}, VW{}\nAENO\n+I VW0, VW{}\n",
                    i + 1,
                    i % 8,
                    i % 30000,
                    i % 2000 * 2,
                    i % 1999 * 2
                )
            });
            format!("ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\n{networks}END_ORGANIZATION_BLOCK\n")
        },
    },
    Shape {
        name: "a word of an S7-200",
        ending: "awl",
        size: 5000,
        text: |n| {
            format!("ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nNetwork 1\nLD I0.0{}\nEND_ORGANIZATION_BLOCK\n", "x".repeat(n))
        },
    },
    Shape {
        name: "labels",
        ending: "scl",
        size: 625,
        text: |n| {
            let arms = lines(n, |i| format!("{}: ;\n", i * 3));
            scl("", &format!("CASE %MD0 OF\n{arms}END_CASE;\n"))
        },
    },
    Shape {
        name: "contacts in series",
        ending: "s7dcl",
        size: 375,
        text: |n| {
            let contacts = lines(n, |i| format!("Contact( %M{}.0 ) ", i % 1000));
            ladder(&format!("RUNG wire#powerrail {contacts} Coil( %M1.0 ) END_RUNG\n"))
        },
    },
    Shape {
        name: "branches",
        ending: "s7dcl",
        size: 375,
        text: |n| {
            let branches = lines(n, |i| format!("RUNG wire#powerrail Contact( %M{}.1 ) END_RUNG wire#w1\n", i % 1000));
            ladder(&format!("RUNG wire#powerrail Contact( %M0.0 ) wire#w1 Coil( %M1.0 ) END_RUNG\n{branches}"))
        },
    },
    Shape {
        name: "arms that write one variable",
        ending: "scl",
        size: 375,
        text: |n| {
            let arms = lines(n, |i| format!("{i}: #t0 := %MW{} + 1;\n", i % 999 * 2));
            scl(&temps(1), &format!("CASE %MW0 OF\n{arms}END_CASE;\n%MW2 := #t0;\n"))
        },
    },
    Shape {
        name: "counting loops",
        ending: "scl",
        size: 225,
        text: |n| scl(&temps(1), &lines(n, |i| format!("FOR #t0 := 0 TO 5 DO %MW{} := #t0; END_FOR;\n", i % 999 * 2))),
    },
    Shape {
        name: "exits of one loop",
        ending: "scl",
        size: 375,
        text: |n| {
            let body =
                lines(n, |i| format!("IF %M{0}.0 THEN EXIT; END_IF; IF %M{0}.1 THEN CONTINUE; END_IF;\n", i % 999));
            scl(&temps(1), &format!("FOR #t0 := 0 TO 9 DO\n{body}END_FOR;\n"))
        },
    },
    Shape {
        name: "a variable written now and then",
        ending: "scl",
        size: 500,
        text: |n| {
            let body = lines(n, |i| format!("IF %M{}.0 THEN #t0 := #t0 + 1; END_IF;\n", i % 999));
            scl(&temps(1), &format!("#t0 := 0;\n{body}%MW2 := #t0;\n"))
        },
    },
    Shape {
        name: "temporary data",
        ending: "scl",
        size: 1875,
        text: |n| scl(&temps(n), &lines(n, |i| format!("#t{i} := %MW{0}; %MW{0} := #t{i};\n", i % 999 * 2))),
    },
    Shape {
        name: "jumps to one end",
        ending: "stl",
        size: 625,
        text: |n| {
            let rungs = lines(n, |i| format!("A M {}.0\nJC M{}\nL MW {}\nT MW 2\n", i % 999, i % 2, i % 998 * 2));
            stl("", &(rungs + "M0: NOP 0\nM1: NOP 1\n"))
        },
    },
    Shape {
        name: "addresses that may be wrong",
        ending: "stl",
        size: 225,
        text: |n| stl("", &lines(n, |i| format!("L MW [MD {}]\nT MW {}\n", i % 499 * 4, i % 998 * 2))),
    },
    Shape {
        name: "loops of an S7-200",
        ending: "awl",
        size: 150,
        text: |n| {
            let loops = lines(n, |i| {
                let network = 3 * i + 1;
                format!(
                    "Network {network}\nLD SM0.0\nFOR VW{}, 1, 5\nNetwork {}\nLD SM0.0\nINCW VW{}\nNetwork {}\nNEXT\n",
                    i % 1000 * 2,
                    network + 1,
                    i % 999 * 2,
                    network + 2
                )
            });
            format!("ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\n{loops}END_ORGANIZATION_BLOCK\n")
        },
    },
    Shape {
        name: "a condition of a chart",
        ending: "gr7",
        size: 250,
        text: |n| {
            let condition = lines(n, |i| format!("M{}.{} AND ", i % 999, i % 8));
            format!(
                "FUNCTION_BLOCK FB1\nINITIAL_STEP A (*$_NUM 1*):\nEND_STEP\nSTEP B (*$_NUM 2*):\nEND_STEP\nTRANSITION T1 (*$_NUM 1*)\n  FROM A\n  TO \
                 B\nCONDITION := {condition}M0.0\nEND_TRANSITION\nTRANSITION T2 (*$_NUM 2*)\n  FROM B\n  TO A (*$_JUMP*)\nCONDITION := \
                 M0.0\nEND_TRANSITION\nEND_FUNCTION_BLOCK\nDATA_BLOCK DB 1\nFB 1\nBEGIN\nEND_DATA_BLOCK\nORGANIZATION_BLOCK OB 1\nBEGIN\nCALL \
                 FB 1, DB 1 (INIT_SQ := FALSE);\nEND_ORGANIZATION_BLOCK\n"
            )
        },
    },
    Shape {
        name: "attributes of an element",
        ending: "xml",
        size: 60,
        text: |n| {
            let attributes = lines(n, |i| format!(" a{i}=\"{i}\""));
            format!("<project{attributes}><types/><instances/></project>\n")
        },
    },
    Shape {
        name: "rows of instruction list",
        ending: "xml",
        size: 125,
        text: |n| {
            let rows = lines(n, |i| format!("LD a\nJMPC L{i}\nLD i\nADD 1\nJMP M{i}\nL{i}:\nLD 2\nM{i}:\nST i\n"));
            format!(
                "<project><types><dataTypes/><pous><pou name=\"Main\" pouType=\"program\"><interface><localVars>\
                 <variable name=\"a\"><type><BOOL/></type></variable><variable name=\"i\"><type><INT/></type></variable>\
                 </localVars></interface><body><IL><p>{rows}</p></IL></body></pou></pous></types></project>\n"
            )
        },
    },
    Shape {
        name: "wires without their sign",
        ending: "s7dcl",
        size: 125,
        text: |n| ladder(&lines(n, |i| format!("RUNG wire#powerrail Contact( %M{}.0 ) END_RUNG w{i}\n", i % 1000))),
    },
    Shape {
        name: "open indices of an S7-200",
        ending: "awl",
        size: 1000,
        text: |n| {
            let indices = "VB[VW0 ".repeat(n);
            format!("ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nNetwork 1\nMOVW {indices}\nEND_ORGANIZATION_BLOCK\n")
        },
    },
    Shape { name: "messages", ending: "scl", size: 250, text: |n| scl("", &lines(n, |i| format!("#x{i} := 1;\n"))) },
];

/// Processor time of this process, in nanoseconds.
fn processor_time() -> u64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: `time` is a place for a result.
    unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &raw mut time) };
    time.tv_sec as u64 * 1_000_000_000 + time.tv_nsec as u64
}

/// Time and bytes that compiling a program takes, with messages drawn.
fn work(shape: &Shape, size: usize, level: Level) -> (u64, u64) {
    let text = (shape.text)(size);
    let name = format!("growth.{}", shape.ending);
    measured(move || {
        let mut read = Read { name: "growth".to_string(), ..Read::default() };
        read.units.push(read.sources.add(SourceFile::new(name, text)));
        let bound = pipeline::front(read, &Settings { require_main: true, ..Settings::default() });
        plcc_diag::drawing::draw(&bound.diagnostics, &bound.sources, false);
        if !bound.has_errors() {
            let compiled = pipeline::back(&bound, level);
            code::jit(&compiled).expect("what binds compiles");
        }
    })
}

/// Time and bytes that a program of SCL takes to become STL, with a tag, comments and a branch for each statement.
fn conversion(size: usize) -> (u64, u64) {
    let tags = lines(size, |i| format!("\"Tag_{i}\",\"M {}.{}\",\"BOOL\",\"\"\n", i / 8, i % 8));
    let text =
        scl("", &lines(size, |i| format!("// tag {i}\nIF \"Tag_{i}\" THEN // on\n\"Tag_{i}\" := FALSE;\nEND_IF;\n")));
    measured(move || {
        let mut read = Read { name: "growth".to_string(), ..Read::default() };
        read.tables.push(read.sources.add(SourceFile::new("growth.sym.txt", tags)));
        read.units.push(read.sources.add(SourceFile::new("growth.scl", text.clone())));
        let settings = Settings { cpu: Some("s7-1500".to_string()), require_main: true, ..Settings::default() };
        let parsed = pipeline::parse(read, &settings);
        let unit = parsed.units[0].1.clone();
        let bound = pipeline::bind(parsed, &settings);
        assert!(!bound.has_errors(), "{:#?}", bound.diagnostics);
        let comments = syntax::comments(&text);
        let meaning = (text.as_str(), comments.as_slice());
        let (_, messages) = from_scl::unit(&unit, &bound.program, meaning, plcc_program::with_chart_data);
        assert!(messages.is_empty(), "{messages:#?}");
    })
}

/// Time and bytes.
fn measured(run: impl FnOnce() + Send + 'static) -> (u64, u64) {
    let run = move || {
        let (time, bytes) = (processor_time(), ALLOCATED.load(Ordering::Relaxed));
        run();
        (processor_time() - time, ALLOCATED.load(Ordering::Relaxed) - bytes)
    };
    plcc_driver::on_large_stack(run).expect("no panic")
}

/// How many times the size.
const LARGER: usize = 16;

/// Maximum factors of work for that: quadratic work yields 256. Proportional work yields 16 times the bytes, but up to 60 times the time where
/// only the smaller program fits into the caches of the processor, and twice that where others use them too.
const TIME_MAX: f64 = 140.0;
const BYTES_MAX: f64 = 80.0;

/// Measurements of a factor that is too large before it counts.
const TRIES: usize = 4;

/// What grows too fast; empty if nothing does.
fn growth(name: &str, size: usize, work: &dyn Fn(usize) -> (u64, u64)) -> String {
    // What else runs on the computer, and where memory lies, change times by half: work that grows too fast does so in each try.
    let (mut time, mut bytes, mut large) = (0.0, 0.0, (0, 0));
    for _ in 0..TRIES {
        let small = work(size);
        large = work(LARGER * size);
        (time, bytes) = (large.0 as f64 / small.0 as f64, large.1 as f64 / small.1 as f64);
        if time <= TIME_MAX {
            break;
        }
    }
    println!("{name}: {time:.1} times the time ({} ms), {bytes:.1} times the memory", large.0 / 1_000_000);
    match time > TIME_MAX || bytes > BYTES_MAX {
        true => format!("{name}: {time:.1} times the time, {bytes:.1} times the memory\n"),
        false => String::new(),
    }
}

#[test]
fn work_follows_the_size() {
    let mut failures = String::new();
    for shape in SHAPES {
        for level in [Level::O0, Level::O2] {
            let name = format!("{} {level:?}", shape.name);
            failures.push_str(&growth(&name, shape.size, &|size| work(shape, size, level)));
        }
    }
    failures.push_str(&growth("SCL as STL", 500, &conversion));
    assert!(failures.is_empty(), "{failures}");
}
