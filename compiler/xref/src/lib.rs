//! Reference data of a program, as STEP 7 has it: cross references, assignment of memory, call structure, symbols without use
//! and addresses without symbol.
//!
//! - [`operand`]: what is used; `collect`: every use, by language.
//! - `cross`: uses by operand, with overlaps; `assignment`: which bits, timers and counters are taken.
//! - [`structure`]: who calls whom; `symbols`: names that nothing uses, addresses that have none.
//! - [`text`]: the lists for people.
//!
//! **Invariant**: [`Reference`] is data, ready to be written as JSON.

use plcc_diag::SourceMap;
use plcc_model::Program;
pub(crate) use plcc_model::{Body, Width};
use serde::Serialize;

mod assignment;
mod collect;
mod cross;
pub mod operand;
pub mod structure;
mod symbols;
pub mod text;

pub use assignment::{Assignment, ByteUse};
pub use cross::{OperandUses, Use};
pub use structure::Structure;
pub use symbols::{AddressWithoutSymbol, UnusedSymbol};

/// The reference data of a program.
#[derive(Clone, Debug, Serialize)]
pub struct Reference {
    pub program: String,
    /// Sorted by address.
    pub operands: Vec<OperandUses>,
    pub assignment: Assignment,
    pub structure: Structure,
    pub unused_symbols: Vec<UnusedSymbol>,
    pub addresses_without_symbol: Vec<AddressWithoutSymbol>,
}

/// What a statement does with an operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub enum Access {
    #[serde(rename = "R")]
    Read,
    #[serde(rename = "W")]
    Write,
    #[serde(rename = "RW")]
    ReadWrite,
    /// It is passed to a block that may do either, or its address is taken.
    #[serde(rename = "?")]
    Undecided,
    /// A block is called, or an instance is the data of a call.
    #[serde(rename = "call")]
    Call,
    /// A data block is opened, or its number is passed.
    #[serde(rename = "open")]
    Open,
}

impl Access {
    /// As in the lists.
    pub const fn name(self) -> &'static str {
        match self {
            Access::Read => "R",
            Access::Write => "W",
            Access::ReadWrite => "RW",
            Access::Undecided => "?",
            Access::Call => "call",
            Access::Open => "open",
        }
    }
}

/// Collects the reference data of a program that is bound without errors.
pub fn reference(program: &Program, sources: &SourceMap) -> Reference {
    let found = collect::collect(program);
    let names = symbols::Names::new(program);
    Reference {
        program: program.name.clone(),
        operands: cross::operands(program, sources, &names, &found),
        assignment: assignment::assignment(&found),
        structure: structure::structure(program, sources, &found),
        unused_symbols: symbols::unused(program, &found),
        addresses_without_symbol: symbols::without_symbol(&names, &found),
    }
}
