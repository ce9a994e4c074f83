//! Programs of plcc against hand-written C that does the same: time and instructions of a scan, and ratios.
//!
//!     cargo bench --bench kernels                  all, in three minutes
//!     cargo bench --bench kernels -- arrays texts  those whose names contain a word
//!
//! Each program is an executable at -O2 under the virtual clock; the empty cycle of its family is subtracted. A twin times its own scans,
//! and its empty scan is subtracted. All run in turn, and a ratio compares what ran in the same turn, so that a busy machine slows both.
//! Where valgrind is installed, the last columns count instructions, which do not depend on what else runs.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use plcc_tests::kernels::{self, Family, Kernel};

/// Turns of a kernel; the median counts.
const TURNS: usize = 7;

/// Processor time of one run of a program, by which the number of its scans is chosen.
const RUN_NS: f64 = 50e6;

/// Scans of the run that finds out how long a scan takes.
const TRIAL_SCANS: u64 = 20_000;

/// The two lengths of run whose difference counts instructions.
const COUNTED: [u64; 2] = [1000, 3000];

/// A compiler of C with its options. The one named first is what plcc is compared with.
const COMPILERS: [(&str, &str, &[&str]); 4] = [
    ("gcc -O3", "gcc", &["-O3"]),
    ("gcc -O2", "gcc", &["-O2"]),
    ("clang -O3", "clang", &["-O3"]),
    ("gcc native", "gcc", &["-O3", "-march=native"]),
];

/// An empty scan in C.
const EMPTY_TWIN: &str = "#include \"plc.h\"\nAREAS({\"M\", M, 1})\nvoid scan(uint32_t now)\n{\n    (void)now;\n}\n";

/// The compilers that are there, and what is run to be subtracted.
struct Bench {
    folder: tempfile::TempDir,
    compilers: Vec<(&'static str, &'static str, &'static [&'static str])>,
    empty_twin: PathBuf,
    counts: bool,
}

/// What is printed of a kernel.
struct Row {
    kind: String,
    name: String,
    /// Nanoseconds of a scan: of plcc, then of each compiler.
    times: Vec<f64>,
    /// Of plcc to the first compiler.
    ratio: f64,
    /// Instructions of a scan, of plcc and the first compiler.
    instructions: Option<[f64; 2]>,
}

fn main() -> ExitCode {
    // `cargo test --benches` checks that it builds, not its speed: the test `kernels` does the rest.
    if !std::env::args().any(|argument| argument == "--bench") {
        return ExitCode::SUCCESS;
    }
    match plcc_driver::on_large_stack(run).and_then(|result| result) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), String> {
    let words: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let bench = Bench::new()?;
    bench.print_head();
    let chosen = |kernel: &Kernel| words.is_empty() || words.iter().any(|word| kernel.name.contains(word.as_str()));
    let mut rows = Vec::new();
    for kernel in kernels::kernels().into_iter().filter(chosen) {
        let row = bench.measure(&kernel)?;
        print_row(&row);
        rows.push(row);
    }
    print_means(&rows);
    Ok(())
}

impl Bench {
    /// Builds the empty programs. Errors: there is no gcc, or it fails.
    fn new() -> Result<Bench, String> {
        let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
        let compilers = COMPILERS.into_iter().filter(|(_, compiler, _)| kernels::has(compiler)).collect();
        for family in Family::ALL {
            let (ending, text) = family.empty_program();
            let source = empty_program(folder.path(), family).with_extension(ending);
            fs::write(&source, text).map_err(|error| error.to_string())?;
            kernels::build_program(&source, &empty_program(folder.path(), family))?;
        }
        let (source, empty_twin) = (folder.path().join("empty.c"), folder.path().join("empty"));
        fs::write(&source, EMPTY_TWIN).map_err(|error| error.to_string())?;
        let include = format!("-I{}", kernels::folder().display());
        kernels::build_twin("gcc", &["-O3", &include], &source, &empty_twin)?;
        Ok(Bench { folder, compilers, empty_twin, counts: kernels::has("valgrind") })
    }

    fn print_head(&self) {
        print!("{:<20}{:>10}", "ns per scan", "plcc");
        self.compilers.iter().for_each(|(name, ..)| print!("{name:>12}"));
        print!("{:>8}", "ratio");
        println!("{}", if self.counts { "  instructions      in C   ratio" } else { "" });
    }

    fn measure(&self, kernel: &Kernel) -> Result<Row, String> {
        let (program, empty) = (self.folder.path().join("program"), empty_program(self.folder.path(), kernel.family()));
        kernels::build_program(&kernel.source, &program)?;
        let mut twins = Vec::new();
        for (index, (_, compiler, options)) in self.compilers.iter().enumerate() {
            let twin = self.folder.path().join(format!("twin{index}"));
            kernels::build_twin(compiler, options, &kernel.twin, &twin)?;
            twins.push(twin);
        }
        let trial = kernels::processor_time(kernels::program_run(&program, TRIAL_SCANS))? / TRIAL_SCANS as f64;
        let scans = (RUN_NS / trial) as u64;
        let mut turns = Vec::new();
        for _ in 0..TURNS {
            let own = kernels::processor_time(kernels::program_run(&program, scans))?;
            let nothing = kernels::processor_time(kernels::program_run(&empty, scans))?;
            let idle = twin_time(&self.empty_twin, scans)?;
            let mut times = vec![(own - nothing) / scans as f64];
            for twin in &twins {
                times.push(twin_time(twin, scans)? - idle);
            }
            turns.push(times);
        }
        let column = |at: usize| median(turns.iter().map(|times| times[at]).collect());
        let instructions = if self.counts { Some(count(&program, &empty, &twins[0], &self.empty_twin)?) } else { None };
        Ok(Row {
            kind: kernel.kind.clone(),
            name: kernel.name.clone(),
            times: (0..turns[0].len()).map(column).collect(),
            ratio: median(turns.iter().map(|times| times[0] / times[1]).collect()),
            instructions,
        })
    }
}

fn empty_program(folder: &Path, family: Family) -> PathBuf {
    folder.join(format!("{family:?}"))
}

fn print_row(row: &Row) {
    print!("{:<20}", row.name);
    row.times
        .iter()
        .enumerate()
        .for_each(|(at, time)| print!("{time:>width$.1}", width = if at == 0 { 10 } else { 12 }));
    print!("{:>8.2}", row.ratio);
    match row.instructions {
        Some([own, twin]) => println!("{own:>14.0}{twin:>10.0}{:>8.2}", own / twin),
        None => println!(),
    }
}

/// Geometric means of the ratios, of each kind and of all.
fn print_means(rows: &[Row]) {
    let mut kinds: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    rows.iter().for_each(|row| kinds.entry(&row.kind).or_default().push(row));
    println!("\n{:<20}{:>8}{:>8}{:>14}", "geometric mean", "kernels", "ratio", "instructions");
    for (kind, rows) in kinds.into_iter().chain([("all", rows.iter().collect())]) {
        print!("{kind:<20}{:>8}{:>8.2}", rows.len(), mean(rows.iter().map(|row| row.ratio)));
        let counts: Vec<f64> = rows.iter().filter_map(|row| row.instructions).map(|[own, twin]| own / twin).collect();
        println!("{}", if counts.is_empty() { String::new() } else { format!("{:>14.2}", mean(counts.into_iter())) });
    }
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    (values.map(f64::ln).sum::<f64>() / count).exp()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Nanoseconds of a scan, as the twin times them.
fn twin_time(twin: &Path, scans: u64) -> Result<f64, String> {
    let output = kernels::finished(&mut kernels::twin_run(twin, scans, "time"))?;
    String::from_utf8_lossy(&output.stdout).trim().parse().map_err(|error| format!("{}: {error}", twin.display()))
}

/// Instructions of a scan of the program and of the twin, without those of empty ones.
fn count(program: &Path, empty: &Path, twin: &Path, empty_twin: &Path) -> Result<[f64; 2], String> {
    let of_program = |path: &Path| per_scan(&|scans| kernels::program_run(path, scans));
    let of_twin = |path: &Path| per_scan(&|scans| kernels::twin_run(path, scans, "none"));
    Ok([of_program(program)? - of_program(empty)?, of_twin(twin)? - of_twin(empty_twin)?])
}

/// Instructions of a scan: the difference of two runs.
fn per_scan(command: &dyn Fn(u64) -> Command) -> Result<f64, String> {
    let [short, long] = COUNTED;
    let difference = instructions(&command(long))? - instructions(&command(short))?;
    Ok(difference / (long - short) as f64)
}

/// Instructions of a run, from valgrind.
fn instructions(command: &Command) -> Result<f64, String> {
    let mut counted = Command::new("valgrind");
    counted
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(command.get_program())
        .args(command.get_args());
    let output = kernels::finished(&mut counted)?;
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    let number = text.lines().find_map(|line| line.split_once("Collected : ")?.1.trim().parse().ok());
    number.ok_or_else(|| format!("no count in the output of valgrind:\n{text}"))
}
