//! Each pass of -O2 may be switched off: the run tests and the samples hold without any one of them, as interpreter, JIT code and executable.
//! They hold with all instructions of this processor, too.
//!
//! One pass is off for each file, another one for the next; `PLCC_PASSES=all` runs each file without each pass. The same is done for the
//! vectors (`vectors.rs`), for random programs (`random.rs`, `s7200/`, `charts/`) and for random IR (`plcc-opt`).

use std::path::PathBuf;
use std::process::ExitCode;

use libtest_mimic::{Arguments, Failed, Trial};
use plcc_driver::inputs::TestInput;
use plcc_driver::testing::{self, Variant};
use plcc_opt::Without;
use plcc_tests::{files, native_variants, passes_of, plan, projects, root, shown, tests_folder, variants_without};

/// Files that share a link.
const GROUP: usize = 40;

/// Of so many files one is run without a pass, unless all are.
const STRIDE: usize = 3;

/// Of so many files one is run with all instructions of this processor.
const NATIVE_STRIDE: usize = 8;

const LANGUAGES: [&str; 6] = ["stl", "awl", "scl", "s7dcl", "gr7", "xml"];

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let mut by_pass: Vec<(Without, Vec<TestInput>)> =
        Without::each().into_iter().map(|without| (without, Vec::new())).collect();
    for (index, input) in inputs().into_iter().enumerate() {
        for without in passes_of(index, STRIDE) {
            let list = by_pass.iter_mut().find(|(pass, _)| *pass == without);
            list.expect("it is one of them").1.push(input.clone());
        }
    }
    let mut trials = Vec::new();
    for (without, inputs) in by_pass {
        for (number, group) in inputs.chunks(GROUP).enumerate() {
            trials.push(trial(format!("{without} {}", number + 1), group.to_vec(), variants_without(without)));
        }
    }
    // All instructions of this processor.
    let native: Vec<TestInput> = inputs().into_iter().step_by(NATIVE_STRIDE).collect();
    for (number, group) in native.chunks(GROUP).enumerate() {
        let group = group.to_vec();
        trials.push(trial(format!("native {}", number + 1), group, native_variants()));
    }
    libtest_mimic::run(&arguments, trials).exit_code()
}

fn trial(name: String, inputs: Vec<TestInput>, variants: Vec<Variant>) -> Trial {
    let check = move || check(&inputs, variants);
    Trial::test(name, move || plcc_driver::on_large_stack(check).and_then(|result| result).map_err(Failed::from))
}

fn inputs() -> Vec<TestInput> {
    let folder = tests_folder().join("run");
    let mut paths: Vec<PathBuf> = LANGUAGES.iter().flat_map(|language| files(&folder, language)).collect();
    paths.sort_by_key(|path| shown(path));
    let folders = [projects(&folder), projects(&root().join("samples"))].concat();
    paths.into_iter().map(TestInput::File).chain(folders.into_iter().map(TestInput::Project)).collect()
}

fn check(inputs: &[TestInput], variants: Vec<Variant>) -> Result<(), String> {
    let outcomes = testing::run(inputs, &plan(variants));
    let failed: String = outcomes
        .iter()
        .filter(|outcome| outcome.failed > 0 || outcome.unreadable)
        .map(|outcome| format!("{}{}", outcome.messages, outcome.failures))
        .collect();
    if failed.is_empty() { Ok(()) } else { Err(failed) }
}
