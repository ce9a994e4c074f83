//! The SSA intermediate representation: types, builder, text form, verifier, interpreter.
//!
//! A [`Module`] holds one [`Function`] a block of the PLC program. Blocks have parameters, as in Cranelift and MLIR.
//! Memory operations name a [`Region`] and an offset, so aliasing between regions is known.
//!
//! **Invariant**: this crate is independent of the source language and does no I/O.

pub mod analysis;
pub mod builder;
pub mod entities;
pub mod eval;
pub mod function;
pub mod instructions;
pub mod interpreter;
pub mod module;
pub mod parse;
pub mod print;
mod renumber;
pub mod verify;

pub use builder::FunctionBuilder;
pub use entities::{Block, FuncId, Inst, Loc, Value, Var};
pub use function::Function;
pub use instructions::{
    Address, BinaryOp, BlockCall, Class, ConvertOp, FloatCc, InstData, IntCc, Region, UnaryOp, Values,
};
pub use module::{Areas, Module, StaticDb};
pub use plcc_abi::{RuntimeFn, Type};
