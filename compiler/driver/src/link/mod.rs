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
use std::process::{Command, Output};
use std::time::Duration;

mod compiler;
mod load;
mod place;
mod relocate;
mod runtimes;
mod template;
mod write;

pub use load::loadable;
pub use runtimes::provide;
pub use template::{Form, Runtime, Template};

/// The C compiler that links where plcc cannot.
const COMPILER: &str = "cc";

/// Links that lead to each other, as many as Linux follows.
const LINKS_MAX: usize = 40;

/// Why there is no executable.
#[derive(Debug)]
pub enum LinkError {
    /// A folder for temporary files is full or read-only.
    Temporary(io::Error),
    /// The linker could not be started: it is not installed, or its name is misspelt.
    Start { linker: String, error: io::Error },
    /// The linker failed: the output cannot be written, or plcc has a bug.
    Failed { command: String, output: String },
    /// Only plcc itself links this form, and only for x86-64.
    NotHere(Form),
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
            LinkError::Failed { command, output } => write!(
                f,
                "the linker failed: {}; plcc links without it if `--linker` is left out\n  {command}\n  {}",
                cause(output),
                output.trim_end().replace('\n', "\n  ")
            ),
            LinkError::NotHere(Form::Unit) => {
                f.write_str("units of co-simulations are linked by plcc, for x86-64 only; leave out `--linker`")
            }
            LinkError::NotHere(_) => write!(
                f,
                "this plcc was built without the static C library; install it and build plcc again, or try `--linker {COMPILER}`"
            ),
            LinkError::Output { path, error } => match path.parent().filter(|parent| !parent.as_os_str().is_empty()) {
                Some(folder) if error.kind() == io::ErrorKind::NotFound => {
                    write!(
                        f,
                        "cannot write `{}`: there is no folder `{}`; create it first",
                        path.display(),
                        folder.display()
                    )
                }
                Some(folder) if error.kind() == io::ErrorKind::NotADirectory => {
                    write!(f, "cannot write `{}`: `{}` is a file, not a folder", path.display(), folder.display())
                }
                // The error names the temporary file, which the user does not know.
                _ => write!(f, "cannot write `{}`: {}", path.display(), crate::inputs::reason(error)),
            },
            LinkError::Object(message) => {
                write!(f, "internal fault, please report it: {message}; `--linker {COMPILER}` may help")
            }
        }
    }
}

/// Why a linker failed, in our words where it is clear.
fn cause(output: &str) -> &'static str {
    let causes = [
        ("No space left on device", "the disk is full"),
        ("Permission denied", "the executable may not be written there"),
        ("Is a directory", "the name of the executable is that of a folder"),
        ("cannot open output file", "the executable cannot be written"),
        ("cannot find -l", "a library of the C compiler is not installed"),
        ("cannot execute", "a part of the C compiler is not installed"),
        ("incompatible with", "it links for another processor than this one"),
        ("unrecognized", "it does not know an option; name a C compiler, not a linker"),
    ];
    causes.iter().find(|(text, _)| output.contains(text)).map_or("its own message follows", |(_, cause)| cause)
}

impl std::error::Error for LinkError {}

/// Links `objects` with the runtime to the executable `out`. `linker` is a C compiler; without one plcc links.
pub fn link(objects: &[impl AsRef<[u8]>], out: &Path, linker: Option<&str>) -> Result<(), LinkError> {
    link_form(Form::Executable(Runtime::Plain), objects, out, linker)
}

/// As [`link`], to another form.
pub fn link_form(form: Form, objects: &[impl AsRef<[u8]>], out: &Path, linker: Option<&str>) -> Result<(), LinkError> {
    match linker {
        Some(linker) => compiler::link(form, objects, out, linker),
        None if Template::is_usable(form) => replace(out, &linked(form, objects)?, 0o777),
        None if matches!(form, Form::Executable(_)) => compiler::link(form, objects, out, COMPILER),
        None => Err(LinkError::NotHere(form)),
    }
}

/// As [`link_form`], to memory.
pub fn link_bytes(form: Form, objects: &[impl AsRef<[u8]>], linker: Option<&str>) -> Result<Vec<u8>, LinkError> {
    match linker {
        None if Template::is_usable(form) => linked(form, objects),
        _ => {
            let folder = tempfile::tempdir().map_err(LinkError::Temporary)?;
            let path = folder.path().join("linked");
            link_form(form, objects, &path, linker)?;
            fs::read(&path).map_err(LinkError::Temporary)
        }
    }
}

/// How often an executable that is busy is tried again, a millisecond later each time.
const BUSY_TRIES: usize = 2000;

/// Runs an executable that this process may just have written. A process that another thread starts at the same moment has the
/// file open for writing until it begins its own program; until then Linux refuses to run it.
pub fn output_of(command: &mut Command) -> io::Result<Output> {
    for _ in 0..BUSY_TRIES {
        match command.output() {
            Err(error) if error.kind() == io::ErrorKind::ExecutableFileBusy => {
                std::thread::sleep(Duration::from_millis(1));
            }
            result => return result,
        }
    }
    command.output()
}

/// The bytes of the file that contains `objects` and the runtime.
fn linked(form: Form, objects: &[impl AsRef<[u8]>]) -> Result<Vec<u8>, LinkError> {
    let template = Template::read(form)?;
    let parsed: Vec<place::ObjectFile<'_>> =
        objects.iter().map(|object| place::parse(object.as_ref())).collect::<Result<_, _>>()?;
    let mut image = place::place(&(&template).into(), &parsed)?;
    relocate::relocate(&parsed, &mut image)?;
    Ok(write::write(&template, &parsed, image))
}

/// Puts a file in the place of `path`, or of the file that it leads to if it is a link, with the rights `mode` as far as the user's mask allows.
/// If the disk is full, what was there stays. A running executable goes on with the file that it was started from.
pub fn replace(path: &Path, bytes: &[u8], mode: u32) -> Result<(), LinkError> {
    let failed = |error| LinkError::Output { path: path.to_path_buf(), error };
    let place = match (path.metadata(), fs::canonicalize(path)) {
        (Ok(found), Ok(place)) if found.is_file() => place,
        // Devices and pipes are written to, and files that have no name.
        (Ok(_), _) => return fs::write(path, bytes).map_err(failed),
        (Err(_), _) => behind_links(path).map_err(failed)?,
    };
    let folder = match place.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut file = tempfile::Builder::new()
        .prefix(".plcc-")
        .permissions(Permissions::from_mode(mode))
        .tempfile_in(folder)
        .map_err(failed)?;
    file.write_all(bytes).map_err(failed)?;
    file.persist(&place).map_err(|error| failed(error.error))?;
    Ok(())
}

/// Where a link leads whose file does not exist yet; the path itself if it is not a link.
fn behind_links(path: &Path) -> io::Result<PathBuf> {
    let mut place = path.to_path_buf();
    for _ in 0..LINKS_MAX {
        let Ok(target) = fs::read_link(&place) else { return Ok(place) };
        // From the folder of the link.
        place.pop();
        place.push(target);
    }
    // The system says that this is a loop.
    path.metadata().map(|_| place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_busy_executable_is_waited_for() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("program");
        fs::copy("/bin/true", &path).expect("every Linux has it");
        let busy = fs::File::options().append(true).open(&path).expect("own file");
        assert!(Command::new(&path).output().is_err_and(|error| error.kind() == io::ErrorKind::ExecutableFileBusy));
        let closing = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(50));
            drop(busy);
        });
        assert!(output_of(&mut Command::new(&path)).expect("it runs").status.success());
        closing.join().expect("it does nothing else");
    }
}
