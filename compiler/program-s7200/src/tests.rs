//! Programs from syntax trees built by hand.

mod build;
mod legality;
mod operands;
mod programs;
mod text;
