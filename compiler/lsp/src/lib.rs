//! The language server: answers what editors ask about the PLC programs of a folder.
//!
//! ```text
//! messages ──► server.rs ──► text.rs: open files        ──► Host: the program, in a thread of its own
//!                        └─► words.rs, index.rs, labels.rs, constants.rs, chart.rs, role.rs, names.rs, s7200.rs
//!                            ──► hover, network.rs, go, values.rs, complete, outline, fixes
//! ```
//!
//! - A change is answered twice: at once with the syntax errors of the file, and with all messages when the program is bound.
//! - The [`Host`] reads files and binds; it is the command line, which alone may read files.
//!
//! **Invariant**: no message of an editor ends the server; a question about something that does not exist has no
//! answer.

mod address;
mod chart;
mod complete;
mod constants;
mod facts;
mod fixes;
mod go;
mod hover;
mod index;
mod labels;
mod names;
mod network;
mod outline;
mod requests;
mod role;
mod s7200;
mod server;
mod text;
mod values;
mod words;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use plcc_diag::{Diagnostic, FileId, SourceMap};
use plcc_syntax::ast::SourceUnit;
use plcc_syntax::symbols::SymbolTable;

pub use facts::{Facts, FunctionFacts, ParameterFacts};
pub use server::serve;
pub use values::{StringForm, ValueName, ValuePart};

/// The texts of open files, by their paths.
pub type Open = BTreeMap<PathBuf, String>;

/// A program that was parsed and bound.
#[derive(Default)]
pub struct Checked {
    /// The names of its files are their paths.
    pub sources: SourceMap,
    pub units: Vec<(FileId, SourceUnit)>,
    pub tables: Vec<SymbolTable>,
    pub facts: Facts,
    pub diagnostics: Vec<Diagnostic>,
    /// Names of values in files that are not sources.
    pub values: Vec<ValueName>,
    /// Sources that are made from other files, and are not files themselves.
    pub made: Vec<FileId>,
}

/// Who reads and binds programs.
pub trait Host: Send + Sync + 'static {
    /// The folder or the file that the program of `path` consists of.
    fn root(&self, path: &Path) -> PathBuf;

    /// The program at a root; the texts of open files go before those on the disk.
    fn check(&self, root: &Path, open: &Open) -> Checked;
}
