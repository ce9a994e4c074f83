//! The command line of plcc: reads, calls, prints, links.

pub mod link;
