//! Linking with a C compiler: `--linker NAME`, and computers for which plcc does not write executables.
//!
//! The runtime is one prelinked object here.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::runtimes::provided;
use super::{Form, LinkError, Runtime};

/// Links `objects` with the runtime to the executable `out`.
pub fn link(form: Form, objects: &[impl AsRef<[u8]>], out: &Path, linker: &str) -> Result<(), LinkError> {
    let (runtime, own) = match form {
        Form::Executable(runtime) => (runtime, "-static-libgcc"),
        Form::Static(runtime) => (runtime, "-static-pie"),
        Form::Unit => return Err(LinkError::NotHere(form)),
    };
    let runtime = match runtime {
        Runtime::Plain => provided().object,
        Runtime::Services => provided().object_with_services,
    };
    let folder = tempfile::tempdir().map_err(LinkError::Temporary)?;
    let write = |name: String, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).map_err(LinkError::Temporary)?;
        Ok(path)
    };
    let mut command = Command::new(linker);
    for (index, object) in objects.iter().enumerate() {
        command.arg(write(format!("program{index}.o"), object.as_ref())?);
    }
    command.arg(write("plcc-runtime.o".to_string(), runtime)?);
    command.arg("-o").arg(argument(out)).args(["-lm", own]);
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

    #[test]
    fn paths_are_no_options() {
        assert_eq!(argument(Path::new("-out")), OsString::from("./-out"));
        assert_eq!(argument(Path::new("a/-out")), OsString::from("a/-out"));
    }
}
