//! Linking executables.
//!
//! An executable is the program's object files and the runtime, which plcc carries as one prelinked object.

use std::ffi::OsString;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The runtime as `build.rs` made it.
static RUNTIME_OBJECT: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/runtime.o"));

/// The default linker.
const LINKER: &str = "cc";

/// Why there is no executable.
#[derive(Debug)]
pub enum LinkError {
    /// The runtime could not be put next to the object files: a full or read-only folder for temporary files.
    Runtime(io::Error),
    /// The linker could not be started: it is not installed, or its name is misspelt.
    Start { linker: String, error: io::Error },
    /// The linker failed: the output cannot be written, or plcc has a bug.
    Failed { command: String, output: String },
}

impl fmt::Display for LinkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LinkError::Runtime(error) => write!(f, "the runtime cannot be written to a temporary folder: {error}"),
            LinkError::Start { linker, error } => write!(
                f,
                "the linker `{linker}` cannot be started: {error}; install a C compiler or name one with `--linker`"
            ),
            LinkError::Failed { command, output } => write!(f, "the linker failed: {command}\n{}", output.trim_end()),
        }
    }
}

impl std::error::Error for LinkError {}

/// Links `objects` with the runtime to the executable `out`. `linker` is a C compiler driver; `cc` if not given.
pub fn link(objects: &[impl AsRef<Path>], out: &Path, linker: Option<&str>) -> Result<(), LinkError> {
    let folder = tempfile::tempdir().map_err(LinkError::Runtime)?;
    let runtime = folder.path().join("plcc-runtime.o");
    std::fs::write(&runtime, RUNTIME_OBJECT).map_err(LinkError::Runtime)?;

    let linker = linker.unwrap_or(LINKER);
    let mut command = Command::new(linker);
    command.args(objects.iter().map(|object| argument(object.as_ref())));
    command.arg(&runtime).arg("-o").arg(argument(out)).args(["-lm", "-static-libgcc"]);
    command.stdin(Stdio::null());
    let output = command.output().map_err(|error| LinkError::Start { linker: linker.to_string(), error })?;
    if output.status.success() {
        return Ok(());
    }
    let text = [output.stdout, output.stderr].concat();
    let text = match String::from_utf8_lossy(&text).trim() {
        "" => output.status.to_string(),
        text => text.to_string(),
    };
    Err(LinkError::Failed { command: format!("{command:?}"), output: text })
}

/// A path that the linker cannot mistake for an option.
fn argument(path: &Path) -> OsString {
    if path.as_os_str().as_encoded_bytes().starts_with(b"-") {
        return PathBuf::from(".").join(path).into_os_string();
    }
    path.as_os_str().to_os_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    const NO_OBJECTS: [&Path; 0] = [];

    #[test]
    fn a_missing_linker_is_named() {
        let error = link(&NO_OBJECTS, Path::new("out"), Some("/no/such/linker")).expect_err("there is none");
        assert!(matches!(error, LinkError::Start { .. }));
        assert!(error.to_string().contains("`/no/such/linker`"), "{error}");
    }

    #[test]
    fn a_failing_linker_is_shown_with_its_command() {
        let error = link(&NO_OBJECTS, Path::new("out"), Some("false")).expect_err("it fails");
        assert!(matches!(error, LinkError::Failed { .. }));
        assert!(error.to_string().contains("plcc-runtime.o"), "{error}");
    }

    #[test]
    fn paths_are_no_options() {
        assert_eq!(argument(Path::new("-out")), OsString::from("./-out"));
        assert_eq!(argument(Path::new("a/-out")), OsString::from("a/-out"));
    }
}
