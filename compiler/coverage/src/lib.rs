//! Which parts of a program tests have run.
//!
//! - [`counter`]: counts what the probes of a running program tell, see `plcc_lower::probe`.
//! - [`chart`]: which steps were active and which transitions switched, from the data of charts.
//! - [`collect`](mod@collect): from counts to blocks with statements, networks, contacts, steps and transitions, by the sources.
//! - [`data`]: these, as they are added up over the tests of a run, and their sums.
//! - [`lcov`]: as a file for other tools; [`html`]: as pages with the drawings.
//!
//! **Invariant**: what is counted depends on the sources alone, not on what has run.

pub mod chart;
pub mod collect;
pub mod counter;
pub mod data;
pub mod html;
pub mod lcov;

pub use collect::collect;
pub use counter::Counter;
pub use data::Coverage;
