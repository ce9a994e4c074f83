//! Syntax trees of blocks, and values that are made when first needed.

use std::rc::Rc;

use plcc_syntax::ast;

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
