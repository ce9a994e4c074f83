//! Kernels: programs in PLC languages with twins in C that do the same to the same memory. The test `kernels` compares their memory, the
//! benchmark `kernels` their speed.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use plcc_driver::cli::Level;
use plcc_driver::link;
use plcc_driver::pipeline::{self, Settings};

use crate::{bind_file, files, provide_runtimes, tests_folder};

/// Endings of the sources.
const LANGUAGES: [&str; 5] = ["stl", "awl", "scl", "s7dcl", "gr7"];

/// What each compiler of C is told: the language, and that `a * b + c` rounds twice, as on the CPU.
const C_OPTIONS: [&str; 5] = ["-std=gnu11", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror"];

/// A program and its twin.
#[derive(Clone, Debug)]
pub struct Kernel {
    /// The folder below `tests/kernels`.
    pub kind: String,
    /// Folder and name: `arrays/dot`.
    pub name: String,
    pub source: PathBuf,
    pub twin: PathBuf,
}

/// Programs that differ in what a cycle costs without them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    S7200,
    S7300,
    S71500,
}

impl Family {
    pub const ALL: [Family; 3] = [Family::S7200, Family::S7300, Family::S71500];

    /// A program of the family that does nothing: the ending of its file, and its text.
    pub fn empty_program(self) -> (&'static str, &'static str) {
        match self {
            Family::S7200 => ("awl", "ORGANIZATION_BLOCK MAIN:OB1\nBEGIN\nEND_ORGANIZATION_BLOCK\n"),
            Family::S7300 => ("stl", "ORGANIZATION_BLOCK OB 1\nBEGIN\nEND_ORGANIZATION_BLOCK\n"),
            Family::S71500 => ("scl", "//@ cpu S7-1500\nORGANIZATION_BLOCK \"Main\"\nBEGIN\nEND_ORGANIZATION_BLOCK\n"),
        }
    }
}

impl Kernel {
    pub fn family(&self) -> Family {
        let text = fs::read_to_string(&self.source).unwrap_or_default();
        match self.kind.as_str() {
            "s7200" => Family::S7200,
            _ if text.starts_with("//@ cpu S7-1500") => Family::S71500,
            _ => Family::S7300,
        }
    }
}

/// All kernels, sorted by name. A source without a twin has one that does not exist: building it fails.
pub fn kernels() -> Vec<Kernel> {
    let folder = folder();
    let mut found: Vec<Kernel> = LANGUAGES
        .iter()
        .flat_map(|language| files(&folder, language))
        .map(|source| {
            let stem = source.with_extension("");
            let name = stem.strip_prefix(&folder).expect("it was found there").display().to_string();
            let kind = name.split('/').next().unwrap_or_default().to_string();
            Kernel { kind, name, twin: source.with_extension("c"), source }
        })
        .collect();
    found.sort_by(|a, b| a.name.cmp(&b.name));
    found
}

/// Where the kernels are.
pub fn folder() -> PathBuf {
    tests_folder().join("kernels")
}

/// Compiles `source` with plcc at -O2 to the executable `out`. Errors: the messages.
pub fn build_program(source: &Path, out: &Path) -> Result<(), String> {
    let settings = Settings { pragmas: true, require_main: true, ..Settings::default() };
    let compiled = pipeline::back(&bind_file(source, &settings)?, Level::O2);
    let object = plcc_codegen::compile_object(&compiled.module, &compiled.image_bytes(), &compiled.codegen_options())
        .map_err(|error| error.to_string())?;
    provide_runtimes();
    link::link(&[object], out, None).map_err(|error| error.to_string())
}

/// Compiles a twin with a compiler of C. Errors: its messages.
pub fn build_twin(compiler: &str, options: &[&str], source: &Path, out: &Path) -> Result<(), String> {
    let mut command = Command::new(compiler);
    command.args(C_OPTIONS).args(options).arg(source).arg("-o").arg(out).arg("-lm");
    finished(&mut command).map(drop)
}

/// True if the compiler is there.
pub fn has(program: &str) -> bool {
    Command::new(program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}

/// Where tests look for Python with the packages that they need.
pub fn python() -> PathBuf {
    tests_folder().join("../target/clients/venv/bin/python")
}

/// The command that runs so many cycles of a program of plcc.
pub fn program_run(program: &Path, cycles: u64) -> Command {
    let mut command = Command::new(program);
    command.args(["--cycles", &cycles.to_string(), "--clock", "virtual", "--cycle-time", "1ms", "--quiet"]);
    command
}

/// The command that runs so many scans of a twin, and then does `what`.
pub fn twin_run(twin: &Path, scans: u64, what: &str) -> Command {
    let mut command = Command::new(twin);
    command.args([&scans.to_string(), what]);
    command
}

/// Runs a command to its end. Errors: what it printed, if it fails.
pub fn finished(command: &mut Command) -> Result<Output, String> {
    let output = link::output_of(command.stdin(Stdio::null())).map_err(|error| format!("{command:?}: {error}\n"))?;
    if output.status.success() {
        return Ok(output);
    }
    let text = [output.stdout, output.stderr].concat();
    Err(format!("{command:?}: {}\n{}", output.status, String::from_utf8_lossy(&text)))
}

/// Runs a command; its processor time in nanoseconds.
#[allow(unsafe_code, reason = "the processor time of a child")]
pub fn processor_time(mut command: Command) -> Result<f64, String> {
    command.stdin(Stdio::null()).stdout(Stdio::null());
    let child = command.spawn().map_err(|error| format!("{command:?}: {error}"))?;
    let process = libc::pid_t::try_from(child.id()).map_err(|error| error.to_string())?;
    let mut status = 0;
    // SAFETY: a `rusage` is numbers, for which 0 is a value.
    let mut usage: libc::rusage = unsafe { std::mem::zeroed() };
    // SAFETY: the process is a child that nobody else waits for, and the kernel writes to the two places during the call.
    let ended = unsafe { libc::wait4(process, &raw mut status, 0, &raw mut usage) };
    if ended != process || status != 0 {
        return Err(format!("{command:?}: failed with status {status}"));
    }
    let nanoseconds = |time: libc::timeval| time.tv_sec as f64 * 1e9 + time.tv_usec as f64 * 1e3;
    Ok(nanoseconds(usage.ru_utime) + nanoseconds(usage.ru_stime))
}
