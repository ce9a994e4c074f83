//! The page: a person watches and operates the CPU from a browser.
//!
//! - [`server`]: HTTP, what may ask, and who is signed in.
//! - [`session`]: a connection that tells values as they change, and takes orders.
//! - [`messages`]: what both sides say, as JSON.
//! - [`names`]: the values that can be watched.
//!
//! The page itself is three files in `page/`, which are part of the program: it works without any other computer.

pub mod messages;
mod names;
mod server;
mod session;
#[cfg(test)]
mod tests;
mod users;

pub use server::{Page, serve};
pub use users::Users;
