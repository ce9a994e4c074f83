//! Many test programs in few executables, because writing one takes longer than most programs run.
//!
//! The objects of a batch export their programs under different names. A directory object names them all; the
//! executable reads from the environment variable `PLCC_TEST` which program to test and how. It prints the report as JSON.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

use plcc_runtime::testing::{TEST_VARIABLE, TestJob};
use plcc_runtime::{TestOptions, TestReport};

use super::prepare::{Prepared, VariantState};
use crate::{link, parallel};

/// Programs that share a link.
const BATCH: usize = 64;

/// A name under which no other object of this process exports its program.
pub fn unique_name() -> String {
    static NEXT: AtomicUsize = AtomicUsize::new(0);
    format!("plcc_program{}", NEXT.fetch_add(1, Ordering::Relaxed))
}

/// Links and runs all programs that are still objects.
pub fn run(prepared: &mut [Prepared], linker: Option<&str>) {
    let mut waiting: Vec<(&TestOptions, &mut VariantState)> = prepared
        .iter_mut()
        .flat_map(|test| &mut test.programs)
        .flat_map(|program| {
            let options = &program.options;
            program.variants.iter_mut().map(move |(_, state)| (options, state))
        })
        .filter(|(_, state)| matches!(state, VariantState::Object { .. }))
        .collect();
    for batch in waiting.chunks_mut(BATCH) {
        let results = run_batch(batch, linker);
        for ((_, state), result) in batch.iter_mut().zip(results) {
            **state = result;
        }
    }
}

fn run_batch(batch: &[(&TestOptions, &mut VariantState)], linker: Option<&str>) -> Vec<VariantState> {
    let linked = tempfile::tempdir().map_err(|error| error.to_string()).and_then(|folder| {
        let executable = link_batch(batch, folder.path(), linker)?;
        Ok((folder, executable))
    });
    let (_folder, executable) = match linked {
        Ok(linked) => linked,
        Err(message) => return batch.iter().map(|_| VariantState::Broken(message.clone())).collect(),
    };
    let jobs: Vec<TestJob> = batch
        .iter()
        .enumerate()
        .map(|(program, (options, _))| TestJob { program, options: (*options).clone() })
        .collect();
    parallel::map(&jobs, |job| match report_of(&executable, job) {
        Ok(report) => VariantState::Done(report),
        Err(message) => VariantState::Broken(message),
    })
}

fn link_batch(
    batch: &[(&TestOptions, &mut VariantState)],
    folder: &Path,
    linker: Option<&str>,
) -> Result<PathBuf, String> {
    let mut objects: Vec<&[u8]> = Vec::new();
    let mut names = Vec::new();
    for (_, state) in batch {
        if let VariantState::Object { name, bytes } = &**state {
            objects.push(bytes);
            names.push(name.as_str());
        }
    }
    let directory = plcc_codegen::directory_object(&names).map_err(|error| error.to_string())?;
    objects.push(&directory);
    let executable = folder.join("tests");
    link::link(&objects, &executable, linker).map_err(|error| error.to_string())?;
    Ok(executable)
}

fn report_of(executable: &Path, job: &TestJob) -> Result<TestReport, String> {
    let job = serde_json::to_string(job).map_err(|error| error.to_string())?;
    let output =
        link::output_of(Command::new(executable).env(TEST_VARIABLE, job)).map_err(|error| error.to_string())?;
    serde_json::from_slice(&output.stdout).map_err(|error| {
        format!(
            "{error} in the report of the executable ({}): {}",
            output.status,
            String::from_utf8_lossy(&output.stderr)
        )
    })
}
