//! S7 communication: what panels, SCADA systems and libraries speak to a CPU on port 102.
//!
//! ```text
//! stream -> frame (TPKT, COTP) -> session (jobs, userdata) -> plc (the CPU at its cycle control point)
//!                              -> partner (PUT, GET, USEND, BSEND of both sides) -> the board of the program
//! ```
//!
//! `server` has the connections, those that clients open and those to partners, which `dial` sets up.
//!
//! Everything but the server is a function of bytes and the CPU. Source: S7comm reference; RFC 1006 and RFC 905 (ISO 8073).

mod cyclic;
mod dial;
mod frame;
mod partner;
mod plc;
mod server;
mod session;
mod status_lists;
mod userdata;
mod variables;
mod watch_list;

#[cfg(test)]
mod fake;
#[cfg(test)]
mod tests;

#[cfg(test)]
pub(crate) use fake::Fake;
pub use frame::PORT;
pub use plc::{Area, BlockInfo, DateAndTime, Event, Family, ItemError, Names, Place, Plc, Restart};
pub use server::{Server, call, serve};
pub use session::{Gate, Session};
