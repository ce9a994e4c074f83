//! What blocks of the library declare, for tables that say so without a program.

use plcc_abi::image::{Config, Family};
use plcc_binding::BindInput;
use plcc_diag::{SourceFile, SourceMap, Span};
use plcc_model::{Interface, profile};
use plcc_stdlib::{Form, SystemBlock};
use plcc_syntax::ast::{BlockPrefix, CodeBlock};

use super::Declarations;
use crate::bind::globals::library;

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

/// The syntax tree of the block of the CPU or of a library that has a number in STEP 7; `symbol`: the name of that number in the program.
///
/// `None`: there is no such block, or the symbol says that the number is that of another one.
pub fn library_code(prefix: BlockPrefix, number: u32, symbol: Option<&str>) -> Option<CodeBlock> {
    let block = plcc_stdlib::find_numbered(prefix.letters(), number, symbol)?;
    (block.form != Form::NotShipped).then(|| library::parsed(block.language, block.source))
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
