//! The command `plcc`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(plcc_driver::main_with(std::env::args_os()))
}
