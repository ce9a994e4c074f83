//! What plcc and its executables do as commands. One program for all, since each costs as much to link.

mod convert;
mod coverage;
mod executable;
mod flags;
mod fmt;
mod linking;
mod lsp;
mod mistakes;
mod new;
mod partial;
mod partners;
mod rename;
mod stations;
mod status;
mod view;
mod view_s7200;

use std::path::Path;
use std::process::{Command, Output};

/// The path of plcc.
const PLCC: &str = env!("CARGO_BIN_EXE_plcc");

/// Runs plcc in a folder until it ends.
fn plcc(folder: impl AsRef<Path>, arguments: &[&str]) -> Output {
    Command::new(PLCC).current_dir(folder).args(arguments).output().expect("plcc starts")
}
