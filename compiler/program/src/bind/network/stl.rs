//! Networks in STL between networks of LAD and FBD. Their labels are those of the block; the registers keep their values from one to the next.

use plcc_syntax::ast::Statement as Tree;

use crate::bind::{Binder, Ctx};
use plcc_model::scl::{Statement, StatementKind};

impl Binder<'_> {
    pub fn bind_stl_network(&mut self, ctx: &mut Ctx, list: &[Tree], number: u16, statements: &mut Vec<Statement>) {
        let labels = ctx.scl.labels.iter().map(|(name, label)| (name.clone(), label.id)).collect();
        let bound = self.bind_statements(ctx, list, number, labels);
        statements
            .extend(bound.into_iter().map(|one| Statement { span: one.span, kind: StatementKind::Stl(Box::new(one)) }));
    }
}
