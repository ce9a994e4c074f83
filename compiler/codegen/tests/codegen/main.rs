//! Machine code against the meaning of the IR.

#![allow(unsafe_code, reason = "machine code is called")]

mod calls;
mod harness;
mod memory;
mod operations;
mod outputs;
mod random;
