//! Binding of networks in LAD and FBD: to the typed tree of SCL.

use plcc_syntax::ast;
use plcc_syntax::network::ast::Body as Networks;

use super::{Binder, Ctx};
use crate::model::scl::Body;

impl Binder<'_> {
    /// Binds the networks of a block.
    pub fn bind_networks(&mut self, _ctx: &mut Ctx, _block: &ast::CodeBlock, _networks: &Networks) -> Body {
        Body::default()
    }
}
