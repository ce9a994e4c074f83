//! Binding of STL.
//!
//! - [`statement`]: labels, jump lists and the instructions of a block; [`move_call`]: `CALL MOVE`.
//! - [`settle`]: what an operand is, [`constant`] if it names one; [`operand`] checks it against the instruction table.
//! - [`call`]: `CALL`; [`instance`]: its instance; [`actual`]: what it passes; [`instruction_call`], [`form_call`]: calls of
//!   instructions.
//! - [`pragma`]: assertions of tests, in SCL too.

mod actual;
mod call;
mod constant;
mod form_call;
pub mod instance;
mod instruction_call;
mod move_call;
mod operand;
mod pragma;
pub mod settle;
mod statement;

use crate::bind::declarations::Declarations;

/// Binds statements of STL, and operands as STL writes them.
pub struct StlBinder<'b, 'a> {
    program: &'b mut Declarations<'a>,
}

impl<'b, 'a> StlBinder<'b, 'a> {
    pub fn new(program: &'b mut Declarations<'a>) -> StlBinder<'b, 'a> {
        StlBinder { program }
    }
}
