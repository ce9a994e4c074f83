//! Status of the program: the values that the statements of a block see in one call, beside its source.
//!
//! - [`choice`]: which call of which block.
//! - [`recorder`]: looks at the probes of the running program and keeps what the chosen call sees.
//! - [`status`](mod@status): the values by line, ready to be written as JSON; [`text`]: for people.
//!
//! - [`graph`]: where steps and transitions of a chart have their data; [`probes`]: the places of probes for the runtime, where clients watch a program that goes on running.
//!
//! The probes come from `plcc_lower::lower_with_probes`; the runtime reports them to the recorder.
//!
//! **Invariant**: all values of a status are of one call in one cycle.

pub mod choice;
pub mod graph;
pub mod probes;
pub mod recorder;
pub mod status;
pub mod text;

pub use choice::{Call, Choice};
pub use recorder::Recorder;
pub use status::Status;
