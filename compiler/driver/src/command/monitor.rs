//! `plcc monitor`.

use std::io::IsTerminal;

use plcc_runtime::options::split_list;
use plcc_services::client;

use crate::cli::MonitorArgs;
use crate::command::exit;
use crate::command::load::password;
use crate::report;

/// Shows a running process until the user leaves.
pub fn monitor(args: &MonitorArgs) -> u8 {
    let signed = match &args.user {
        Some(user) => password().and_then(|password| client::sign_in(args.address, user, &password)).map(Some),
        None => Ok(None),
    };
    let outcome = signed.and_then(|session| match std::io::stdout().is_terminal() {
        true => plcc_monitor::run(args.address, session, split_list(&args.watch)).map_err(|error| error.to_string()),
        false => Err("standard output is not a terminal".to_string()),
    });
    match outcome {
        Ok(()) => exit::OK,
        Err(message) => {
            report::say(&format!("{}: {message}", args.address));
            exit::USAGE
        }
    }
}
