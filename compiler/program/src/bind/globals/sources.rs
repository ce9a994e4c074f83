//! The syntax trees of all blocks.

use std::rc::Rc;

use plcc_abi::image::Family;
use plcc_binding::BindInput;
use plcc_model::BlockKey;
use plcc_syntax::ast;
use plcc_syntax::scl::ast::Dialect;
use rustc_hash::FxHashMap;

use crate::bind::trees::blocks::dialect;

/// The syntax trees of all blocks, by their numbers.
pub struct Sources<'a> {
    pub code: FxHashMap<BlockKey, CodeSource<'a>>,
    pub data: FxHashMap<u16, &'a ast::DataBlock>,
    pub types: FxHashMap<u16, &'a ast::TypeBlock>,
    /// A block of the TIA Portal is among the sources, or the CPU only exists there.
    pub tia: bool,
}

/// The syntax tree of a block with code.
#[derive(Clone)]
pub enum CodeSource<'a> {
    User(&'a ast::CodeBlock),
    /// Of a user block, with declarations that its language adds.
    Expanded(Rc<ast::CodeBlock>),
    System(Rc<ast::CodeBlock>),
}

impl CodeSource<'_> {
    pub fn block(&self) -> &ast::CodeBlock {
        match self {
            CodeSource::User(block) => block,
            CodeSource::Expanded(block) | CodeSource::System(block) => block,
        }
    }
}

/// True if names of instructions mean those of the TIA Portal where a data block or UDT declares them.
pub fn is_tia(input: &BindInput) -> bool {
    portal_cpu(input)
        || input.units.iter().flat_map(|(_, unit)| &unit.blocks).any(|block| match block {
            ast::Block::Code(code) => dialect(code) == Some(Dialect::Tia),
            ast::Block::Data(_) | ast::Block::Type(_) => false,
        })
}

/// Only the TIA Portal can program this CPU.
pub fn portal_cpu(input: &BindInput) -> bool {
    matches!(input.profile.family, Family::S71200 | Family::S71500)
}
