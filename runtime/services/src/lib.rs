//! Servers for clients of the CPU.
//!
//! - [`s7`]: S7 communication; [`modbus`]: Modbus TCP; [`metrics`]: Prometheus and health; [`mqtt`]: values to a broker, also as
//!   Sparkplug B;
//!   [`opcua`]: OPC UA; [`web`]: a page.
//! - [`link`]: the way to the CPU; [`access`]: the CPU as clients see it.
//! - [`listen`], [`rights`], [`password`], [`limits`]: who may come in, and what they may use up. [`tls`], [`certificate`]: encryption.
//! - [`client`]: a client of the page. [`options`]: the flags, and what they open. `executable` has `main` of a program with services.
//!
//! A thread of its own runs all servers. They reach the CPU through a [`link`] only, which it looks at between two
//! cycles. Nothing is open unless a flag or plc.toml asks for it, and then only for this computer unless an address
//! is given.
//!
//! **Invariant**: nothing that a client sends panics, hangs, or delays a cycle by more than the share of communication.

mod access;
mod certificate;
pub mod client;
#[cfg(all(feature = "executable", not(test)))]
#[allow(unsafe_code, reason = "the C runtime calls the entry point")]
mod executable;
pub mod limits;
mod link;
mod listen;
mod metrics;
mod modbus;
mod mqtt;
mod opcua;
pub mod options;
pub mod password;
mod patience;
pub mod rights;
pub mod s7;
mod tls;
mod web;
mod wire;

pub use options::ServiceOptions;

/// A message to the user; a closed standard error changes nothing.
fn say(text: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "runtime: {}", plcc_runtime::files::without_numbers(text));
}
