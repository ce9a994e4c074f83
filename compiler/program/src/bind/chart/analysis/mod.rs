//! Which charts are valid. Source: GRAPH reference, chapter I.
//!
//! - `names`: names, numbers and limits.
//! - `structure`: where sequencers begin and end, and how their steps are connected.
//! - `branches`: simultaneous branches, with `regions` for their paths and `marking` for a search through all sets of active steps.
//! - `conditions`: what `logic` finds out about conditions.
//! - `operands`: operands that rows of actions write.
//! - `calls`: calls of the block.
//!
//! All but `calls` depend only on the chart, the parameters of its block and the addresses of symbols.

mod branches;
mod calls;
mod conditions;
mod logic;
mod marking;
mod names;
mod net;
mod operands;
mod regions;
mod structure;
#[cfg(test)]
mod tests;

use plcc_diag::{Diagnostic, Span};
use plcc_syntax::ast;
use plcc_syntax::chart::ast::{ActionBody, Body as Chart, Qualifier, Step, Transition};
use plcc_syntax::scl::ast::{Expr, ExprKind};
use rustc_hash::FxHashSet;

use super::index::Index;
use crate::bind::chart::ChartBinder;
use crate::bind::declarations::path::Base;
use crate::bind::scl::SclBlock;
use net::{Net, SET_MAX};
use plcc_binding::fold;
use plcc_syntax::symbols::SymbolTarget;

/// Limit of transitions of a chart whose pairs are compared. GRAPH allows 250.
const TRANSITIONS_MAX: usize = 1000;

impl ChartBinder<'_, '_> {
    /// Reports mistakes in a chart.
    pub fn check_chart(&mut self, ctx: &SclBlock, block: &ast::CodeBlock, chart: &Chart, index: &Index) {
        let parameters: FxHashSet<String> =
            ctx.block.bound.interface.parameters.iter().map(|parameter| fold(&parameter.name)).collect();
        let temporary = ctx
            .block
            .bound
            .locals
            .iter()
            .filter(|(_, local)| local.base == Base::L)
            .map(|(name, _)| name.clone())
            .collect();
        let messages = {
            let symbol = |name: &str| self.program.globals.global(name);
            let facts = Facts { parameters, temporary, symbol: &symbol };
            check(chart, block.name.span(), index, &facts)
        };
        messages.into_iter().for_each(|message| self.program.report(message));
        self.acknowledgement(ctx, chart);
        self.called_twice(ctx);
    }
}

/// The facts about the block and the program that matter to a chart. Names are folded.
struct Facts<'a> {
    parameters: FxHashSet<String>,
    /// Local data of one call.
    temporary: FxHashSet<String>,
    symbol: &'a dyn Fn(&str) -> Option<SymbolTarget>,
}

impl Facts<'_> {
    /// Steps can be switched by hand.
    fn is_manual(&self) -> bool {
        ["sw_man", "s_on", "s_off"].iter().any(|name| self.parameters.contains(*name))
    }
}

/// A chart with data that the checks need.
struct Checked<'a> {
    chart: &'a Chart,
    /// Name of the block.
    span: Span,
    net: Net,
    requests: Requests,
    manual: bool,
}

/// Mistakes in a chart alone.
fn check(chart: &Chart, span: Span, index: &Index, facts: &Facts) -> Vec<Diagnostic> {
    let mut messages = Vec::new();
    let known = names::check(chart, index, &mut messages);
    let net = Net::new(chart, index);
    let checked = Checked { chart, span, net, requests: Requests::of(chart, index), manual: facts.is_manual() };
    structure::check_transitions(&checked, &mut messages);
    if known {
        structure::check_ways(&checked, &mut messages);
    }
    conditions::check(chart, &checked.net, facts, &mut messages);
    // In an incomplete chart, further mistakes would only follow from this.
    if !chart.broken && known {
        let started = structure::check_steps(&checked, &mut messages);
        if chart.steps.len() <= SET_MAX && chart.transitions.len() <= TRANSITIONS_MAX {
            let together = branches::check(&checked, started, &mut messages);
            operands::check_shared(chart, &together, facts, &mut messages);
        }
        operands::check_reset(chart, facts, &mut messages);
    }
    messages
}

/// Steps that rows of ON and OFF activate and deactivate.
#[derive(Default)]
struct Requests {
    on: FxHashSet<usize>,
    off: FxHashSet<usize>,
    /// `OFF S_ALL`, or a row whose step is not known.
    any: bool,
}

impl Requests {
    fn of(chart: &Chart, index: &Index) -> Requests {
        let mut requests = Requests::default();
        for action in chart.steps.iter().flat_map(|step| &step.actions) {
            let step = match &action.body {
                ActionBody::Operand(Expr { kind: ExprKind::Name(name), .. }) => index.step_reference(&name.text),
                _ => None,
            };
            match (action.qualifier, step) {
                (Qualifier::On, Some(step)) => {
                    requests.on.insert(step);
                }
                (Qualifier::Off, Some(step)) => {
                    requests.off.insert(step);
                }
                (Qualifier::On | Qualifier::Off, None) => requests.any = true,
                _ => {}
            }
        }
        requests
    }

    fn is_empty(&self) -> bool {
        self.on.is_empty() && self.off.is_empty() && !self.any
    }
}

/// A step as messages name it: `step "Fill" (S003)`.
fn step_title(step: &Step) -> String {
    format!("step \"{}\" (S{:03})", step.name.text, step.number)
}

/// A transition as messages name it: `transition "Full" (T003)`.
fn transition_title(transition: &Transition) -> String {
    match transition.name.text.as_str() {
        "" => format!("transition T{:03}", transition.number),
        name => format!("transition \"{name}\" (T{:03})", transition.number),
    }
}
