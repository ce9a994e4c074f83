//! Pulse outputs, expected values by hand from the S7-200 system manual, pulse output instruction.

mod hardware;
mod outputs;
mod segments;
