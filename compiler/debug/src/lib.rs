//! The debugger: the Debug Adapter Protocol for a program that runs in memory, with a probe before each statement.
//!
//! ```text
//! client ──► wire.rs: messages ──► server.rs: before, between and after runs
//!                              └─► debugger.rs: the Watcher; the program waits in it while requests.rs answers
//! ```
//!
//! - `places`: lines, networks, steps and the probes there; `breakpoint`, `condition`, `data`: when to stop.
//! - `course`: how far the program runs on: steps, cycles, and back to an earlier statement.
//! - `lookup`, `indices`: what a name means in a block; `variables`, `registers`: what a client sees and changes.
//!
//! The clock is virtual, so a run can be repeated to the byte. That is how the debugger goes back: it starts the program once more, with
//! the same inputs and the same changes of the user, and stops it at the statement with the wanted number.
//!
//! **Invariant**: no message of a client ends the server; a request that cannot be carried out is answered with an
//! error.

mod breakpoint;
mod condition;
mod course;
mod data;
mod debugger;
mod indices;
mod launch;
mod lookup;
mod places;
mod registers;
mod requests;
mod server;
mod stack;
mod variables;
mod wire;

use std::path::{Path, PathBuf};
use std::rc::Rc;

use plcc_abi::ProgramImage;
use plcc_diag::SourceMap;
use plcc_lower::probe::Place;
use plcc_model::Program;
use plcc_runtime::Code;

pub use launch::Launch;
pub use server::serve;

/// A program with a probe before each statement.
pub struct Target {
    pub program: Program,
    pub sources: SourceMap,
    pub places: Vec<Place>,
    pub image: ProgramImage,
    pub code: Rc<dyn Code>,
}

/// Who reads and compiles programs.
pub trait Host {
    /// `Err`: why there is no program, for the user.
    fn compile(&self, program: Option<&Path>) -> Result<Target, String>;

    /// The recording to repeat, unless the client names one.
    fn replay(&self) -> Option<PathBuf>;

    /// The path of a file from the root on, as each client names the same file.
    fn absolute(&self, path: &str) -> String;
}
