//! Shared functions of the tests: finding files, comparing expected text, compiling programs.

pub mod charts;
pub mod costs;
pub mod damage;
pub mod debug;
pub mod kernels;
pub mod plants;
pub mod random;
pub mod reduce;
pub mod reference;
pub mod robust;
pub mod twins;

use std::fs;
use std::path::{Path, PathBuf};

use plcc_driver::cli::{CpuFeatures, Level};
use plcc_driver::inputs;
use plcc_driver::pipeline::{self, Bound, Optimization, Settings};
use plcc_driver::testing::{Form, Plan, Variant};
use plcc_opt::Without;

/// Set to renew printed forms and carets, never assertions.
pub const UPDATE: &str = "UPDATE_EXPECT";

/// The folder of the workspace.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the tests lie in the workspace").to_path_buf()
}

/// This folder.
pub fn tests_folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// `path` as seen from the workspace, for names of tests and files in messages.
pub fn shown(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}

/// Whether a source is among those that a test takes, about one in `part`. Other sources do not change it.
pub fn is_chosen(path: &Path, part: u64) -> bool {
    let name = path.strip_prefix(root()).unwrap_or(path).to_string_lossy();
    let mix = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3);
    let hash = name.bytes().fold(0xCBF2_9CE4_8422_2325, mix);
    (hash >> 32).is_multiple_of(part)
}

/// True if expectations are to be renewed.
pub fn updating() -> bool {
    std::env::var_os(UPDATE).is_some_and(|value| value != "0")
}

/// Projects in `folder` and below, sorted.
pub fn projects(folder: &Path) -> Vec<PathBuf> {
    if is_project(folder) {
        return vec![folder.to_path_buf()];
    }
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut found: Vec<PathBuf> = entries.filter(|path| path.is_dir()).flat_map(|path| projects(&path)).collect();
    found.sort();
    found
}

fn is_project(folder: &Path) -> bool {
    folder.join("plc.toml").is_file()
}

/// Files with this extension in `folder` and below, sorted; none if the folder does not exist. Files of projects are left out.
pub fn files(folder: &Path, suffix: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() && !is_project(&path) {
            found.extend(files(&path, suffix));
        } else if path.extension().is_some_and(|ending| ending == suffix) {
            found.push(path);
        }
    }
    found
}

/// Folders right in `folder`, sorted.
pub fn folders(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut found: Vec<PathBuf> = entries.filter(|path| path.is_dir()).collect();
    found.sort();
    found
}

/// Compares `actual` with the file at `path`, or renews the file.
pub fn expect_file(path: &Path, actual: &str) -> Result<(), String> {
    let expected = fs::read_to_string(path).unwrap_or_default();
    if expected == actual {
        return Ok(());
    }
    if updating() {
        return fs::write(path, actual).map_err(|error| format!("{}: {error}", shown(path)));
    }
    Err(format!(
        "{} is not what is printed now; `{UPDATE}=1 cargo test --release` renews it\n{}",
        shown(path),
        difference(&expected, actual)
    ))
}

/// The first lines that differ.
pub fn difference(expected: &str, actual: &str) -> String {
    let mut expected_lines = expected.lines();
    for (index, line) in actual.lines().enumerate() {
        match expected_lines.next() {
            Some(other) if other == line => {}
            Some(other) => return format!("line {}:\n  expected: {other}\n  printed:  {line}", index + 1),
            None => return format!("line {} is new:\n  printed:  {line}", index + 1),
        }
    }
    match expected_lines.next() {
        Some(line) => format!("this line is not printed any more:\n  expected: {line}"),
        None => "the ends of lines differ".to_string(),
    }
}

/// All forms at both levels.
pub fn all_variants() -> Vec<Variant> {
    let forms = [Form::Interp, Form::Jit, Form::Exe];
    forms
        .iter()
        .flat_map(|&form| [Level::O0, Level::O2].map(|level| Variant { form, optimization: level.into() }))
        .collect()
}

/// Set to `all` to run each test that switches off a pass without each pass.
pub const PASSES: &str = "PLCC_PASSES";

/// The passes that test number `index` is run without: one of `stride` tests without one pass, in turn, or all tests without each.
pub fn passes_of(index: usize, stride: usize) -> Vec<Without> {
    let each = Without::each();
    if std::env::var_os(PASSES).is_some_and(|value| value == "all") {
        return each;
    }
    match index % stride {
        0 => vec![each[index / stride % each.len()]],
        _ => Vec::new(),
    }
}

/// At -O2 without a pass.
pub fn without(pass: Without) -> Optimization {
    Optimization { without: pass, ..Level::O2.into() }
}

/// All forms at -O2 without a pass.
pub fn variants_without(pass: Without) -> Vec<Variant> {
    [Form::Interp, Form::Jit, Form::Exe].map(|form| Variant { form, optimization: without(pass) }).to_vec()
}

/// Machine code at -O2 for this processor.
pub fn native_variants() -> Vec<Variant> {
    let optimization = Optimization { cpu_features: CpuFeatures::Native, ..Level::O2.into() };
    [Form::Jit, Form::Exe].map(|form| Variant { form, optimization }).to_vec()
}

/// Lets this process link executables.
pub fn provide_runtimes() {
    plcc_driver::link::provide(plcc_prebuilt::RUNTIMES);
}

/// A plan for `variants` with nothing else set.
pub fn plan(variants: Vec<Variant>) -> Plan {
    provide_runtimes();
    Plan { settings: Settings::default(), variants, linker: None, coverage: false }
}

/// The bound program of one source; the messages, drawn, if it has errors.
pub fn bind_file(path: &Path, settings: &Settings) -> Result<Bound, String> {
    let bound = pipeline::front(inputs::read(&[path.to_path_buf()]), settings);
    if bound.has_errors() {
        return Err(plcc_diag::drawing::draw(&bound.diagnostics, &bound.sources, false));
    }
    Ok(bound)
}
