//! Actions of the grammar for parts of the tree that need a decision.

mod expression;
mod part;

pub use expression::{
    Sub, absolute, argument, binary, call, chain, index, literal, member, member_absolute, name, shift, unary,
};
pub use part::{action, no_action, permanent, step, transition};
