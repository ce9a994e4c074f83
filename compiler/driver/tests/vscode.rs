//! The parts of the extension for Visual Studio Code that need no editor, with this plcc. Ignored where there is no node.

use std::path::Path;
use std::process::{Command, ExitCode};

use libtest_mimic::{Arguments, Trial};

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let version = Command::new("node").arg("--version").output();
    // `node --test` came with 18.
    let version = version.ok().and_then(|out| String::from_utf8(out.stdout).ok());
    let major = version.and_then(|text| text.trim_start_matches('v').split('.').next()?.parse::<u32>().ok());
    let missing = major.is_none_or(|major| major < 18);
    let name = if missing { "extension: node is not installed, nothing is tested" } else { "extension" };
    libtest_mimic::run(&arguments, vec![Trial::test(name, check).with_ignored_flag(missing)]).exit_code()
}

fn check() -> Result<(), libtest_mimic::Failed> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../editors/vscode");
    let mut command = Command::new("node");
    let output =
        command.args(["--test", "test/"]).current_dir(folder).env("PLCC", env!("CARGO_BIN_EXE_plcc")).output()?;
    match output.status.success() {
        true => Ok(()),
        false => Err(String::from_utf8_lossy(&output.stdout).into_owned().into()),
    }
}
