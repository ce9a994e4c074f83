//! Binding of SCL: names, types and conversions of statements and expressions.

use plcc_syntax::ast;
use plcc_syntax::scl::ast::Body as Tree;

use super::{Binder, Ctx};
use crate::model::scl::Body;

impl Binder<'_> {
    /// Binds the statements of a block in SCL.
    pub fn bind_scl(&mut self, _ctx: &mut Ctx, _block: &ast::CodeBlock, _body: &Tree) -> Body {
        Body::default()
    }
}
