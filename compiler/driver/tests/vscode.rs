//! The extension for Visual Studio Code with this plcc: the parts that need no editor, and all of it in a simulated
//! editor. Ignored where there is no node; the second also where `npm ci` has not been run in editors/vscode.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use libtest_mimic::{Arguments, Failed, Trial};

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let version = Command::new("node").arg("--version").output();
    // `node --test` came with 18.
    let version = version.ok().and_then(|out| String::from_utf8(out.stdout).ok());
    let major = version.and_then(|text| text.trim_start_matches('v').split('.').next()?.parse::<u32>().ok());
    let no_node = major.is_none_or(|major| major < 18);
    let not_installed = !folder().join("node_modules/vscode-languageclient").is_dir();
    let trial = |name: &str, file: &'static str, missing: Option<&str>| {
        let name = missing.map_or(name.to_string(), |missing| format!("{name}: {missing}, nothing is tested"));
        Trial::test(name, move || check(file)).with_ignored_flag(missing.is_some())
    };
    let node = no_node.then_some("node is not installed");
    let packages = node.or(not_installed.then_some("`npm ci` has not been run in editors/vscode"));
    let trials = vec![
        trial("extension", "test/results.test.js", node),
        trial("extension in an editor", "test/extension.test.js", packages),
    ];
    libtest_mimic::run(&arguments, trials).exit_code()
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../editors/vscode")
}

fn check(file: &str) -> Result<(), Failed> {
    let mut command = Command::new("node");
    let output =
        command.args(["--test", file]).current_dir(folder()).env("PLCC", env!("CARGO_BIN_EXE_plcc")).output()?;
    match output.status.success() {
        true => Ok(()),
        false => Err(String::from_utf8_lossy(&output.stdout).into_owned().into()),
    }
}
