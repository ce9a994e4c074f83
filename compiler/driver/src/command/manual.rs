//! `plcc completions` and `plcc man`.

use std::fs;
use std::path::Path;

use clap::CommandFactory;
use clap_complete::Shell;

use crate::cli::Cli;
use crate::command::exit;
use crate::report;

/// Prints the script that completes the command line in a shell.
pub fn completions(shell: Shell) -> u8 {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "plcc", &mut script);
    report::print(&String::from_utf8_lossy(&script)).err().unwrap_or(exit::OK)
}

/// Writes a manual page for each command into a folder.
pub fn pages(folder: &Path) -> u8 {
    let written = fs::create_dir_all(folder).and_then(|()| clap_mangen::generate_to(Cli::command(), folder));
    match written {
        Ok(()) => exit::OK,
        Err(error) => {
            report::say(&format!("cannot write the pages to `{}`: {error}", folder.display()));
            exit::USAGE
        }
    }
}
