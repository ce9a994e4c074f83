//! What binders share, whatever the family: what they are given and give, constants, assertions, messages about missing things.
//!
//! - [`BindInput`], [`Bound`]: what is bound, and what comes of it.
//! - [`constant`], [`value`]: constants with their exact values, and their bytes as values of a type.
//! - [`assertion`], [`pragma`]: the types by which assertions compare, and pragmas of files.
//! - [`report`]: messages, with one list of what is named and defined nowhere; [`stand_ins`]: what takes its place.
//!
//! **Invariant**: knows no language's rules; no binder names another.

pub mod assertion;
pub mod constant;
mod names;
pub mod pragma;
pub mod report;
pub mod stand_ins;
pub mod value;

pub use names::{fold, similar};

use plcc_abi::image::{Config, Profile};
use plcc_diag::{Diagnostic, FileId, SourceMap};
use plcc_model::Program;
use plcc_syntax::ast::SourceUnit;
use plcc_syntax::symbols::SymbolTable;

/// What is bound.
pub struct BindInput<'a> {
    /// Name of the program.
    pub name: String,
    pub sources: &'a SourceMap,
    pub units: &'a [(FileId, SourceUnit)],
    pub tables: &'a [SymbolTable],
    pub profile: Profile,
    pub config: Config,
    /// Undefined names and blocks are warnings, and what depends on them goes unchecked.
    pub partial: bool,
    /// The file of declarations that stand in for what is missing, whose tags lie beyond the CPU's memory.
    pub stand_ins: Option<FileId>,
    /// Obey assertion pragmas.
    pub pragmas: bool,
    /// A program without OB 1 is an error.
    pub require_main: bool,
    /// Blocks of safety programs are compiled as standard blocks.
    pub safety_as_standard: bool,
}

/// A program with its messages.
pub struct Bound {
    pub program: Program,
    pub diagnostics: Vec<Diagnostic>,
    /// What is named and defined nowhere; each has a message among the others.
    pub missing: Vec<report::Uses>,
}
