//! What a client says when it starts a program.

use std::path::PathBuf;
use std::rc::Rc;

use plcc_runtime::RunOptions;
use plcc_runtime::options::{ClockKind, parse_duration};
use plcc_runtime::tape::Recording;
use serde::Deserialize;
use serde_json::Value;

/// The arguments of `launch`.
#[derive(Clone, Debug, Default)]
pub struct Launch {
    /// A project, a folder or a file; `None`: what the command line names.
    pub program: Option<PathBuf>,
    pub stop_on_entry: bool,
    pub options: RunOptions,
    /// The recording that is repeated.
    pub replay: Option<PathBuf>,
    pub recording: Option<Rc<Recording>>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Arguments {
    program: Option<PathBuf>,
    #[serde(default)]
    stop_on_entry: bool,
    cycles: Option<u64>,
    cycle_time: Option<String>,
    #[serde(default)]
    set: Vec<String>,
    scenario: Option<PathBuf>,
    watch_table: Option<PathBuf>,
    #[serde(default)]
    stop_on_error: bool,
    replay: Option<PathBuf>,
}

impl Launch {
    /// Reads the arguments. `Err`: the error.
    pub fn read(arguments: &Value) -> Result<Launch, String> {
        let given: Arguments =
            serde_json::from_value(arguments.clone()).map_err(|error| format!("the launch configuration: {error}"))?;
        let options = RunOptions {
            cycles: given.cycles,
            clock: ClockKind::Virtual,
            cycle_time: given.cycle_time.as_deref().map(parse_duration).transpose()?,
            set: given.set,
            scenario: given.scenario,
            watch_table: given.watch_table,
            stop_on_error: given.stop_on_error,
            ..RunOptions::default()
        };
        let (program, stop_on_entry, replay) = (given.program, given.stop_on_entry, given.replay);
        Ok(Launch { program, stop_on_entry, options, replay, recording: None })
    }
}
