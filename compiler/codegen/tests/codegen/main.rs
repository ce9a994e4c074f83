//! Machine code against the meaning of the IR.

mod calls;
mod harness;
mod memory;
mod operations;
mod outputs;
mod random;
