//! Parts that binders of all families share: their input and output, constants, assertions, messages about missing names.
//!
//! - [`BindInput`], [`Bound`]: what is bound, and the result.
//! - [`constant`], [`value`]: constants with their exact values, and their bytes as values of a type.
//! - [`rewrite`]: how the author of a constant would write it with another type.
//! - [`assertion`], [`pragma`]: the types by which assertions compare, and pragmas of files.
//! - [`report`]: messages, with one list of names that are defined nowhere; [`stand_ins`]: what replaces them.
//!
//! **Invariant**: independent of the rules of a language; no binder refers to another.

pub mod assertion;
pub mod constant;
mod names;
pub mod pragma;
pub mod report;
pub mod rewrite;
pub mod stand_ins;
pub mod value;

pub use names::{fold, similar};

use plcc_abi::image::{Config, Profile};
use plcc_diag::{Diagnostic, FileId, SourceMap};
use plcc_model::Program;
use plcc_syntax::ast::SourceUnit;
use plcc_syntax::symbols::SymbolTable;

/// The input of a binder.
pub struct BindInput<'a> {
    /// Name of the program.
    pub name: String,
    pub sources: &'a SourceMap,
    pub units: &'a [(FileId, SourceUnit)],
    pub tables: &'a [SymbolTable],
    pub profile: Profile,
    pub config: Config,
    /// Undefined names and blocks are warnings, and parts that depend on them are not checked.
    pub partial: bool,
    /// The file of declarations that stand in for missing names; its tags are beyond the CPU's memory.
    pub stand_ins: Option<FileId>,
    /// Honor assertion pragmas.
    pub pragmas: bool,
    /// A program without OB 1 is an error.
    pub require_main: bool,
    /// Blocks of safety programs are compiled as standard blocks.
    pub safety_as_standard: bool,
    /// Charts become the statements that they are in every mode, with types of the S7-300 only, as other notations need them; otherwise there
    /// are also short ways and values of 64 bits.
    pub plain_charts: bool,
}

/// A program with its messages.
pub struct Bound {
    pub program: Program,
    pub diagnostics: Vec<Diagnostic>,
    /// Warnings about valid code that does nothing, or hardly what its author means; none if there are errors.
    pub reviewed: Vec<Diagnostic>,
    /// Names that are defined nowhere; each has a message among the others.
    pub missing: Vec<report::Uses>,
}
