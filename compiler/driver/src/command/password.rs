//! `plcc password`.

use std::io;

use plcc_services::password;

use crate::command::exit;
use crate::report;

/// Prints the hash of the password that is read.
pub fn password() -> u8 {
    let mut line = String::new();
    if let Err(error) = io::stdin().read_line(&mut line) {
        report::say(&format!("cannot read the password: {error}"));
        return exit::USAGE;
    }
    match password::hash(line.trim_end_matches(['\r', '\n'])) {
        Ok(hash) => match report::print(&format!("{hash}\n")) {
            Ok(()) => exit::OK,
            Err(code) => code,
        },
        Err(message) => {
            report::say(&message);
            exit::USAGE
        }
    }
}
