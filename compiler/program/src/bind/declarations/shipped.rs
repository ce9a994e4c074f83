//! What blocks of the library declare, for tables that say so without a program.

use plcc_abi::image::{Config, Family};
use plcc_binding::BindInput;
use plcc_diag::{SourceFile, SourceMap, Span};
use plcc_model::{Interface, profile};
use plcc_stdlib::SystemBlock;

use super::Declarations;

/// The interface of a block of the library, in an empty program; `None` if it is only known by name.
pub fn library_interface(block: &SystemBlock) -> Option<Interface> {
    let mut sources = SourceMap::default();
    let file = sources.add(SourceFile::new("", ""));
    let input = empty(&sources);
    let mut program = Declarations::new(&input);
    let key = program.globals.library.key_of(block);
    let bound = program.interface(key, Span { file, start: 0, end: 0 })?;
    Some(bound.interface.clone())
}

/// A program without blocks.
pub fn empty(sources: &SourceMap) -> BindInput<'_> {
    BindInput {
        name: String::new(),
        sources,
        units: &[],
        tables: &[],
        profile: profile::generic(Family::S7300),
        config: Config::default(),
        partial: false,
        stand_ins: None,
        pragmas: false,
        require_main: false,
        safety_as_standard: false,
        plain_charts: false,
    }
}
