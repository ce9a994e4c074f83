//! `plcc password`.

use std::io;

use plcc_services::password;

use crate::command::exit;
use crate::report;

/// Prints the hash of the password that is read: of a CPU, or of a user of its page.
pub fn password(of_user: bool) -> u8 {
    let mut line = String::new();
    if let Err(error) = io::stdin().read_line(&mut line) {
        report::say(&format!("cannot read the password: {error}"));
        return exit::USAGE;
    }
    let hash = if of_user { password::hash_of_user } else { password::hash };
    match hash(line.trim_end_matches(['\r', '\n'])) {
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
