//! Binding of networks in LAD and FBD: element by element to the typed tree of SCL, so that all languages share one lowering.
//!
//! - `order`: the order in which the elements of a graph run.
//! - `sheet`: the network that is being bound: values of nets, hidden variables, statements so far.
//! - `pins`: what comes in at pins and goes out of them; EN and ENO.
//! - `bits`, `compare`, `math`, `moves`, `convert`, `calls`, `control`, `classic`: what the elements do, by the kinds of the table.
//! - `stl`: networks in STL between the others.
//!
//! Source: LAD/FBD reference, chapters A.11, C and E.2.

mod legality;

use plcc_syntax::ast;
use plcc_syntax::network::ast::{Body as Networks, Content, Graph, Network, Target};
use plcc_syntax::network::elements::Kind;
use plcc_syntax::scl::ast::Dialect;

use super::scl::expression::constant_expr;
use super::scl::temporary;
use super::scl::{Rules, Scope};
use super::{Binder, Ctx};
use crate::model::scl::{Body, Expr, ExprKind, Statement, StatementKind};
use classic::Registers;
use sheet::{Pool, Sheet};

/// What the networks of a block share.
pub struct Page {
    pub pool: Pool,
    /// ENO of the block so far, a BOOL; none if nothing but RET sets it.
    eno: Option<sheet::Hidden>,
    pub registers: Registers,
}

impl Binder<'_> {
    /// Binds the networks of a block.
    pub fn bind_networks(&mut self, _ctx: &mut Ctx, _block: &ast::CodeBlock, networks: &Networks) -> Body {
        let mut messages = legality::labels(networks);
        networks.networks.iter().for_each(|network| legality::legality(network, &mut messages));
        messages.extend(legality::block_warnings(networks));
        messages.into_iter().for_each(|message| self.report.push(message));
        Body::default()
    }
}

/// The list of statements of a block of networks, as labels name it.
const TOP: usize = 0;

/// ENO of a block is the BR of the status word.
fn has_br(rules: Rules) -> bool {
    rules.is_300()
}
