//! What statements pass to an instruction of the TIA Portal that they call by its name.

use crate::Direction;
use crate::types::Elementary;

/// A parameter of an instruction.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InstructionPin {
    pub name: String,
    pub direction: Direction,
    pub ty: InstructionType,
}

/// The type of a parameter of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstructionType {
    Fixed(Elementary),
    /// That of the call: `value` for `value_type`. Parameters with the same word have the same type.
    Named(&'static str),
    /// That of the actual parameter, which is a whole number; with the usual one.
    Number(Elementary),
}
