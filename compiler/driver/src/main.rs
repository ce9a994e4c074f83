//! The command `plcc`.

use std::process::ExitCode;

fn main() -> ExitCode {
    plcc_driver::link::provide(plcc_prebuilt::RUNTIMES);
    ExitCode::from(plcc_driver::main_with(std::env::args_os()))
}
