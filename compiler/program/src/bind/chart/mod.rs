//! Binding of GRAPH: a chart becomes statements of the typed tree of SCL, so that all languages share one lowering.
//!
//! - `index`: steps and transitions by name and number.
//! - `engine`: what the statements know of the chart: where its data lie in the instance.
//! - `action`: rows of actions; `permanent`: permanent instructions; `condition`: conditions; `call`: block calls of the first two.
//! - `analysis`: which charts can be.
//!
//! Source: GRAPH reference, chapters D to G.

mod action;
mod analysis;
mod call;
mod condition;
mod engine;
mod index;
mod permanent;

use plcc_syntax::ast;
use plcc_syntax::chart::ast::Body as Chart;
use plcc_syntax::scl::ast::Dialect;

use super::scl::Scope;
use super::{Binder, Ctx};
use crate::model::scl::Body;
use index::Index;

impl Binder<'_> {
    /// Binds the chart of a block.
    pub fn bind_chart(&mut self, ctx: &mut Ctx, block: &ast::CodeBlock, chart: &Chart) -> Body {
        ctx.scl = Scope::new(self.input, &block.header, Dialect::Tia);
        let index = Index::new(chart);
        self.check_chart(ctx, block, chart, &index);
        Body::default()
    }
}
