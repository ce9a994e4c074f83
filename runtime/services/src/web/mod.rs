//! The page: a person watches and operates the CPU from a browser.
//!
//! - [`server`]: HTTP, what may ask, and who is signed in.
//! - [`session`]: a connection that tells values as they change, and takes orders.
//! - [`messages`]: what both sides say, as JSON.
//! - [`names`]: the values that can be watched; [`status`]: what the statements of a block see.
//! - [`tables`]: watch tables that are files of the project.
//! - [`trace`]: values recorded in every cycle; [`info`]: what the CPU is and does.
//!
//! The page itself is a few files in `page/`, which are part of the program: it works without any other computer.

mod info;
mod messages;
mod names;
mod server;
mod session;
mod status;
mod tables;
#[cfg(test)]
mod tests;
mod trace;
mod users;

pub use server::{Page, serve};
pub use tables::Tables;
pub use users::Users;
