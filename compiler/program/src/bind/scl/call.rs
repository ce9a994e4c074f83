//! Calls of blocks.

use plcc_syntax::scl::ast::Expr as Node;

use super::value::Value;
use crate::bind::{Binder, Ctx};

impl Binder<'_> {
    /// Binds a call: of a block, an instance, a function of the language. `statement`: its value may be dropped.
    pub(super) fn scl_call(&mut self, _ctx: &mut Ctx, _node: &Node, _statement: bool) -> Option<Value> {
        None
    }
}
