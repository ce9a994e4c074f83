//! Which charts can be. Source: GRAPH reference, chapter I.

use plcc_syntax::ast;
use plcc_syntax::chart::ast::Body as Chart;

use super::index::Index;
use crate::bind::{Binder, Ctx};

impl Binder<'_> {
    /// Tells what is wrong with a chart.
    pub fn check_chart(&mut self, _ctx: &Ctx, _block: &ast::CodeBlock, _chart: &Chart, _index: &Index) {}
}
