//! A Modbus TCP server.
//!
//! ```text
//! stream -> frame -> functions (a request and its answer) -> memory (registers and bits of the CPU, at its cycle control point)
//! ```
//!
//! Source: Modbus application protocol V1.1b3; Modbus messaging on TCP/IP.

mod functions;
mod identification;
mod memory;
mod server;

#[cfg(test)]
mod tests;

pub use memory::{Map, check};
pub use server::serve;
