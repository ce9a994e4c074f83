//! Programs from syntax trees made by hand.

mod build;
mod legality;
mod operands;
mod programs;
mod text;
