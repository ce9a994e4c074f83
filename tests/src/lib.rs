//! The file tests of the project and their one runner.
