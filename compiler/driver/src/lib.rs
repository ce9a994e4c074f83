//! The command line of plcc: reads, calls, prints, links.
//!
//! - [`cli`]: what can be written on the command line; [`command`]: what is done.
//! - [`inputs`], [`content`], [`project`]: from arguments to files.
//! - [`pipeline`]: from files to code, one function an arrow; [`emit`]: its forms as text; [`link`]: executables.
//! - [`code`]: code that runs in this process; [`testing`]: `plcc test`.
//! - [`report`] writes messages.
//!
//! **Invariant**: the only compiler crate that does I/O.

pub mod link;
