//! Syntax trees of blocks, and values that are made when first needed.

use std::rc::Rc;

use plcc_model::BlockKey;
use plcc_syntax::ast;
use rustc_hash::FxHashMap;

/// The syntax trees of all blocks, by their numbers.
pub struct Sources<'a> {
    pub code: FxHashMap<BlockKey, CodeSource<'a>>,
    pub data: FxHashMap<u16, &'a ast::DataBlock>,
    pub types: FxHashMap<u16, &'a ast::TypeBlock>,
    /// A block of the TIA Portal is among the sources, or the CPU only exists there.
    pub tia: bool,
}

/// A value that is made when first needed.
pub enum State<T> {
    /// In progress: a use now means a loop.
    Running,
    Done(T),
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
