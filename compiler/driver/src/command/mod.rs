//! The commands, one file each. Each returns the exit code of the process.

pub mod build;
pub mod check;
pub mod convert;
pub mod debug;
pub mod explain;
pub mod fmt;
pub mod load;
pub mod lsp;
pub mod manual;
pub mod monitor;
pub mod new;
pub mod password;
pub mod plot;
pub mod run;
pub mod station;
pub mod status;
pub mod test;
pub mod view;
pub mod xref;

/// Exit codes. A command that runs a PLC program returns the codes of the runtime, which are the same.
pub mod exit {
    pub const OK: u8 = 0;
    /// A test failed; the program went to STOP on a fault.
    pub const FAILED: u8 = 1;
    /// Wrong usage, or a file that cannot be read or written.
    pub const USAGE: u8 = 2;
    /// The sources have errors.
    pub const COMPILE: u8 = 3;
}
