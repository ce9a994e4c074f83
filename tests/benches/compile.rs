//! How long plcc takes for plants of 1,000 to 1,000,000 lines of STL, how much memory, and how large executables are.
//!
//! Each build is a process of its own, as on the command line: this program starts itself. `cargo bench --bench compile` prints the
//! tables; numbers as arguments are other sizes, in lines.

#![allow(unsafe_code, reason = "the clock of the process")]

use std::ffi::OsString;
use std::fs;
use std::path::Path;
use std::process::{Command, ExitCode};
use std::time::Instant;

use plcc_tests::plants::plant;

/// Sizes of plants, in lines.
const SIZES: [usize; 5] = [1_000, 10_000, 26_000, 100_000, 1_000_000];

/// Builds of one row; the fastest counts.
const RUNS: usize = 5;

/// Lines from which on one build is enough.
const LONG: usize = 500_000;

/// Begins the line of a build that says what it took.
const MEASURED: &str = "measured:";

/// Makes this program a build with the arguments after it.
const BUILD: &str = "--plcc";

fn main() -> ExitCode {
    plcc_tests::provide_runtimes();
    let arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    if arguments.first().is_some_and(|first| first == BUILD) {
        let code = plcc_driver::main_with(arguments);
        println!("{MEASURED} {} {}", processor_seconds(), peak_memory());
        return ExitCode::from(code);
    }
    let named: Vec<usize> = arguments.iter().filter_map(|size| size.to_str()?.parse().ok()).collect();
    let sizes = if named.is_empty() { SIZES.to_vec() } else { named };
    let folder = tempfile::tempdir().expect("a temporary folder");
    println!(
        "| Lines | Everything, s | Processor, s | Memory, MB | One block changed, s | Processor, s | Executable, KB |"
    );
    println!("| ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
    for size in sizes {
        row(folder.path(), size);
    }
    ExitCode::SUCCESS
}

fn row(folder: &Path, size: usize) {
    let (source, executable) = (folder.join("plant.stl"), folder.join("plant"));
    let write = |setpoint| fs::write(&source, plant(size, setpoint)).expect("the folder can be written");
    write(0);
    let lines = fs::read_to_string(&source).expect("it was written").lines().count();
    let fastest = |prepare: &dyn Fn(u16), flags: &[&str]| {
        let runs = (0..if size < LONG { RUNS } else { 1 }).map(|run| {
            prepare(run as u16 + 1);
            build(folder, flags)
        });
        runs.min_by(|a, b| a.seconds.total_cmp(&b.seconds)).expect("there are runs")
    };
    let whole = fastest(&|_| {}, &["--no-cache"]);
    build(folder, &[]);
    let changed = fastest(&write, &[]);
    let bytes = fs::metadata(executable).expect("it was built").len();
    println!(
        "| {lines} | {:.3} | {:.3} | {} | {:.3} | {:.3} | {} |",
        whole.seconds,
        whole.processor_seconds,
        whole.memory / 1000,
        changed.seconds,
        changed.processor_seconds,
        bytes / 1000
    );
}

/// What a build took.
struct Build {
    seconds: f64,
    processor_seconds: f64,
    /// In KB.
    memory: u64,
}

fn build(folder: &Path, flags: &[&str]) -> Build {
    let mut command = Command::new(std::env::current_exe().expect("this program has a file"));
    command.current_dir(folder).args([BUILD, "build", "plant.stl", "-o", "plant"]).args(flags);
    command.env("XDG_CACHE_HOME", folder.join("cache"));
    let start = Instant::now();
    let output = command.output().expect("this program starts");
    let seconds = start.elapsed().as_secs_f64();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report = String::from_utf8_lossy(&output.stdout);
    let measured = report.lines().find_map(|line| line.strip_prefix(MEASURED)).expect("a build says what it took");
    let mut numbers = measured.split_whitespace();
    let mut next = || numbers.next().expect("a build reports two numbers");
    let processor_seconds = next().parse().expect("a number of seconds");
    Build { seconds, processor_seconds, memory: next().parse().expect("a number of KB") }
}

/// Time of all threads of this process.
fn processor_seconds() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the clock exists on every Linux, and `time` is written completely.
    unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &mut time) };
    time.tv_sec as f64 + time.tv_nsec as f64 / 1e9
}

/// The most memory that this process has had, in KB.
fn peak_memory() -> u64 {
    let status = fs::read_to_string("/proc/self/status").expect("Linux says");
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("Linux says");
    line.trim().trim_end_matches("kB").trim().parse().expect("a number of KB")
}
