//! What blocks of the library declare, for tables that say so without a program.

use plcc_abi::image::{Config, Family};
use plcc_binding::BindInput;
use plcc_diag::{SourceFile, SourceMap, Span};
use plcc_model::{Interface, profile};
use plcc_stdlib::{BlockClass, Form, SystemBlock};
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
    let class = match prefix {
        BlockPrefix::Fc => BlockClass::Fc,
        BlockPrefix::Fb => BlockClass::Fb,
        BlockPrefix::Sfc => BlockClass::Sfc,
        BlockPrefix::Sfb => BlockClass::Sfb,
        BlockPrefix::Ob | BlockPrefix::Db | BlockPrefix::Di | BlockPrefix::Udt | BlockPrefix::Vat => return None,
    };
    let block = plcc_stdlib::find(class, u16::try_from(number).ok()?)?;
    // Blocks of the CPU cannot be replaced.
    let is_of_cpu = matches!(class, BlockClass::Sfc | BlockClass::Sfb);
    let is_same = |name: &str| plcc_stdlib::standard_name(name).eq_ignore_ascii_case(block.name);
    let is_meant = !block.is_tia() && block.form != Form::NotShipped && (is_of_cpu || symbol.is_none_or(is_same));
    is_meant.then(|| library::parsed(block.language, block.source))
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
