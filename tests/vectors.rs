//! Recorded executions of STL instructions, `../shared/vectors/stl300` next to the project (see the README there).
//!
//! Each batch is a program that leaves results in DB 1. The expected values become assertions at its end, so that all forms at
//! both levels are compared with them, and with each other.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::ExitCode;

use libtest_mimic::{Arguments, Failed, Trial};
use plcc_driver::inputs::TestInput;
use plcc_driver::testing;
use plcc_driver::testing::Variant;
use plcc_tests::{all_variants, native_variants, passes_of, plan, root, variants_without};
use serde_json::Value;

/// Programs of one trial.
const GROUP: usize = 24;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let folder = root().join("../shared/vectors/stl300");
    if !folder.is_dir() {
        let missing = Trial::test(format!("stl300: no vectors at {}", folder.display()), || Ok(()));
        return libtest_mimic::run(&arguments, vec![missing.with_ignored_flag(true)]).exit_code();
    }
    let mut programs = batch_programs(&folder.join("batches.jsonl"));
    programs.extend(error_programs(&folder.join("errors.jsonl")));
    let mut trials = Vec::new();
    for (index, group) in programs.chunks(GROUP).enumerate() {
        let group = group.to_vec();
        // All forms, without a pass, another one for each group, and with all instructions of this processor.
        let mut variants = all_variants();
        variants.extend(passes_of(index, 1).into_iter().flat_map(variants_without));
        variants.extend(native_variants());
        trials.push(Trial::test(format!("stl300 {}", index + 1), move || {
            plcc_driver::on_large_stack(move || run(&group, variants)).and_then(|result| result).map_err(Failed::from)
        }));
    }
    libtest_mimic::run(&arguments, trials).exit_code()
}

/// A program with the expected result of `plcc test`.
#[derive(Clone)]
struct TestProgram {
    name: String,
    source: String,
}

fn lines(path: &Path) -> Vec<Value> {
    let text = fs::read_to_string(path).expect("a file of the vectors is read");
    text.lines().map(|line| serde_json::from_str(line).expect("a line is a JSON object")).collect()
}

fn text(value: &Value) -> &str {
    value.as_str().expect("the README says that it is a text")
}

fn batch_programs(path: &Path) -> Vec<TestProgram> {
    lines(path)
        .iter()
        .map(|batch| {
            let mut asserts = String::new();
            for vector in batch["expect"].as_array().expect("a list of vectors") {
                writeln!(asserts, "// {}", text(&vector[0])).expect("a string takes all");
                for cell in vector[1].as_array().expect("a list of cells") {
                    assert_cell(cell, &mut asserts);
                }
            }
            let source =
                text(&batch["source"]).replace("END_ORGANIZATION_BLOCK", &format!("{asserts}END_ORGANIZATION_BLOCK"));
            let number = &batch["batch"];
            TestProgram { name: number.as_str().map_or_else(|| number.to_string(), str::to_string), source }
        })
        .collect()
}

/// `[address, value]`, or `[address, value, {"f32_ulp": n}]`: an error of this many units in the last place is allowed.
fn assert_cell(cell: &Value, asserts: &mut String) {
    let (address, value) = (text(&cell[0]), cell[1].as_u64().expect("an unsigned value") as u32);
    let mut line = |op: &str, value: u32| {
        writeln!(asserts, "//@ assert {address} {op} DW#16#{value:08X}").expect("a string takes all");
    };
    match cell[2]["f32_ulp"].as_u64() {
        None => line("==", value),
        // Patterns of the same sign are in the order of their values.
        Some(ulp) => {
            let sign = value & 0x8000_0000;
            let magnitude = value & 0x7FFF_FFFF;
            line(">=", sign | magnitude.saturating_sub(ulp as u32));
            line("<=", sign | (magnitude + ulp as u32));
        }
    }
}

/// Programs that must go to STOP.
fn error_programs(path: &Path) -> Vec<TestProgram> {
    lines(path)
        .iter()
        .map(|vector| TestProgram {
            name: text(&vector["id"]).to_string(),
            source: format!("//@ test expect=fail\n{}", text(&vector["source"])),
        })
        .collect()
}

fn run(programs: &[TestProgram], variants: Vec<Variant>) -> Result<(), String> {
    let folder = tempfile::tempdir().map_err(|error| error.to_string())?;
    let write = |program: &TestProgram| {
        let path = folder.path().join(format!("{}.stl", program.name.replace('/', "_")));
        fs::write(&path, &program.source).map(|()| TestInput::File(path))
    };
    let inputs: Vec<TestInput> = programs.iter().map(write).collect::<Result<_, _>>().map_err(|e| e.to_string())?;
    let outcomes = testing::run(&inputs, &plan(variants));
    let failed: Vec<String> = outcomes
        .iter()
        .filter(|outcome| outcome.failed > 0)
        .map(|outcome| format!("{}{}", outcome.messages, outcome.failures))
        .collect();
    if failed.is_empty() { Ok(()) } else { Err(failed.concat()) }
}
