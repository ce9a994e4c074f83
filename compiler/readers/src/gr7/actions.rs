//! Actions of the grammar for parts of the tree that need a decision.

mod expression;
mod part;

pub use expression::{absolute, argument, call, chain, literal, member, member_absolute, name, shift};
pub use part::{action, no_action, permanent, step, transition};
