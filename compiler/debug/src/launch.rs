//! What a client says when it starts a program.

use std::path::PathBuf;
use std::rc::Rc;

use plcc_runtime::RunOptions;
use plcc_runtime::options::{ClockKind, parse_duration};
use plcc_runtime::tape::Recording;
use serde::de::DeserializeOwned;
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

impl Launch {
    /// Reads the arguments; keys of other programs may be among them. `Err`: the error.
    pub fn read(arguments: &Value) -> Result<Launch, String> {
        let file = "the path of a file";
        let cycle_time: Option<String> = given(arguments, "cycleTime", "a time such as \"10ms\"")?;
        let cycle_time = cycle_time.as_deref().map(parse_duration).transpose();
        let options = RunOptions {
            cycles: given(arguments, "cycles", "a whole number of 0 or more")?,
            clock: ClockKind::Virtual,
            cycle_time: cycle_time.map_err(|error| format!("`cycleTime` in the launch configuration: {error}"))?,
            set: given(arguments, "set", "a list of texts such as [\"I0.0=1\"]")?.unwrap_or_default(),
            scenario: given(arguments, "scenario", file)?,
            watch_table: given(arguments, "watchTable", file)?,
            stop_on_error: given(arguments, "stopOnError", "true or false")?.unwrap_or_default(),
            ..RunOptions::default()
        };
        Ok(Launch {
            program: given(arguments, "program", "the path of a project, a folder or a file")?,
            stop_on_entry: given(arguments, "stopOnEntry", "true or false")?.unwrap_or_default(),
            options,
            replay: given(arguments, "replay", file)?,
            recording: None,
        })
    }
}

/// The value of a key; `None`: it is not given. `Err`: it is not what is expected.
fn given<T: DeserializeOwned>(arguments: &Value, key: &str, expected: &str) -> Result<Option<T>, String> {
    match arguments.get(key) {
        None | Some(Value::Null) => Ok(None),
        Some(value) => serde_json::from_value(value.clone())
            .map(Some)
            .map_err(|_| format!("`{key}` in the launch configuration must be {expected}, not {value}")),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn what_is_wrong_names_its_key() {
        for (arguments, message) in [
            (json!({"cycles": -1}), "`cycles` in the launch configuration must be a whole number of 0 or more, not -1"),
            (
                json!({"set": "I0.0=1"}),
                "`set` in the launch configuration must be a list of texts such as [\"I0.0=1\"], not \"I0.0=1\"",
            ),
            (json!({"stopOnEntry": 1}), "`stopOnEntry` in the launch configuration must be true or false, not 1"),
            (
                json!({"cycleTime": 10}),
                "`cycleTime` in the launch configuration must be a time such as \"10ms\", not 10",
            ),
        ] {
            assert_eq!(Launch::read(&arguments).map(|_| ()), Err(message.to_string()), "{arguments}");
        }
        let error = Launch::read(&json!({"cycleTime": "soon"})).map(|_| ()).unwrap_err();
        assert!(error.starts_with("`cycleTime` in the launch configuration: `soon` is not a time"), "{error}");
        let launch = Launch::read(&json!({"cycles": 5, "name": "a key of the client", "replay": null})).unwrap();
        assert_eq!((launch.options.cycles, launch.stop_on_entry, launch.replay), (Some(5), false, None));
    }
}
