//! The command line of plcc: reads, calls, prints, links.
