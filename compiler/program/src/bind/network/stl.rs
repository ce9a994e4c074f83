//! Networks in STL between networks of LAD and FBD. Their labels are those of the block; the registers keep their values from one to the next.

use plcc_syntax::ast::Statement as Tree;

use crate::bind::network::NetworkBinder;
use crate::bind::scl::SclBlock;
use plcc_model::scl::{Statement, StatementKind};

impl NetworkBinder<'_, '_> {
    pub fn bind_stl_network(
        &mut self,
        ctx: &mut SclBlock,
        list: &[Tree],
        number: u16,
        statements: &mut Vec<Statement>,
    ) {
        let labels = ctx.scope.labels.iter().map(|(name, label)| (name.clone(), label.id)).collect();
        let bound = self.stl().bind_statements(ctx.block, list, number, labels);
        statements
            .extend(bound.into_iter().map(|one| Statement { span: one.span, kind: StatementKind::Stl(Box::new(one)) }));
    }
}
