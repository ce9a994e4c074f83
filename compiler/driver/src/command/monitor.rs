//! `plcc monitor`.

use std::io::IsTerminal;

use plcc_runtime::options::split_list;
use plcc_services::client::Process;

use crate::cli::MonitorArgs;
use crate::command::exit;
use crate::command::load::password;
use crate::report;

/// Shows a running process until the user leaves.
pub fn monitor(args: &MonitorArgs) -> u8 {
    match show(args) {
        Ok(()) => exit::OK,
        Err(message) => {
            report::say(&format!("{}: {message}", args.address));
            exit::USAGE
        }
    }
}

fn show(args: &MonitorArgs) -> Result<(), String> {
    let process = Process::new(args.address, args.tls.as_deref())?;
    let session = match &args.user {
        Some(user) => Some(process.sign_in(user, &password()?)?),
        None => None,
    };
    match std::io::stdout().is_terminal() {
        true => plcc_monitor::run(process, session, split_list(&args.watch)).map_err(|error| error.to_string()),
        false => Err("standard output is not a terminal".to_string()),
    }
}
