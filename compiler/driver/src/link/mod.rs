//! Linking executables.
//!
//! plcc carries the runtime as a finished executable with room for one program (`template`). Linking puts the sections of the
//! program's objects there (`place`), fills in addresses (`relocate`), and writes symbols, line tables and headers
//! (`write`). `compiler` does the same with a C compiler.

use std::fmt;
use std::fs::{self, Permissions};
use std::io::{self, Write as _};
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};

mod compiler;
mod place;
mod relocate;
mod template;
mod write;

use template::Template;

/// The C compiler that links where plcc cannot.
const COMPILER: &str = "cc";

/// Why there is no executable.
#[derive(Debug)]
pub enum LinkError {
    /// A folder for temporary files is full or read-only.
    Temporary(io::Error),
    /// The linker could not be started: it is not installed, or its name is misspelt.
    Start { linker: String, error: io::Error },
    /// The linker failed: the output cannot be written, or plcc has a bug.
    Failed { command: String, output: String },
    /// The executable cannot be written.
    Output { path: PathBuf, error: io::Error },
    /// An object contains what plcc does not link: a bug of plcc, or a program of more than 2 GB.
    Object(String),
}

impl fmt::Display for LinkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LinkError::Temporary(error) => write!(f, "temporary files cannot be written: {error}"),
            LinkError::Start { linker, error } => write!(
                f,
                "the linker `{linker}` cannot be started: {error}; install a C compiler or name one with `--linker`"
            ),
            LinkError::Failed { command, output } => write!(f, "the linker failed: {command}\n{}", output.trim_end()),
            LinkError::Output { path, error } => write!(f, "cannot write `{}`: {error}", path.display()),
            LinkError::Object(message) => {
                write!(f, "internal fault, please report it: {message}; `--linker {COMPILER}` may help")
            }
        }
    }
}

impl std::error::Error for LinkError {}

/// Links `objects` with the runtime to the executable `out`. `linker` is a C compiler; without one plcc links.
pub fn link(objects: &[impl AsRef<[u8]>], out: &Path, linker: Option<&str>) -> Result<(), LinkError> {
    match linker {
        Some(linker) => compiler::link(objects, out, linker),
        None if Template::is_usable() => write_executable(out, &executable(objects)?),
        None => compiler::link(objects, out, COMPILER),
    }
}

/// The bytes of the executable that contains `objects` and the runtime.
fn executable(objects: &[impl AsRef<[u8]>]) -> Result<Vec<u8>, LinkError> {
    let template = Template::read()?;
    let parsed: Vec<place::ObjectFile<'_>> =
        objects.iter().map(|object| place::parse(object.as_ref())).collect::<Result<_, _>>()?;
    let mut image = place::place(&template, &parsed)?;
    relocate::relocate(&parsed, &mut image)?;
    Ok(write::write(&template, &parsed, image))
}

/// Puts the executable in the place of what `path` was. A running executable goes on with the file that it was started from.
fn write_executable(path: &Path, bytes: &[u8]) -> Result<(), LinkError> {
    let failed = |error| LinkError::Output { path: path.to_path_buf(), error };
    // Devices and pipes are written to.
    if path.metadata().is_ok_and(|metadata| !metadata.is_file()) {
        return fs::write(path, bytes).map_err(failed);
    }
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut file = tempfile::Builder::new()
        .prefix(".plcc-")
        .permissions(Permissions::from_mode(0o777))
        .tempfile_in(folder)
        .map_err(failed)?;
    file.write_all(bytes).map_err(failed)?;
    file.persist(path).map_err(|error| failed(error.error))?;
    Ok(())
}
