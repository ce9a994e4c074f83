//! How other blocks use a chart: instances that are called twice, faults that nothing acknowledges.

use plcc_abi::image::BlockKind;
use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{self, BlockPrefix, Code as BlockCode, OperandKind, PathPart};
use plcc_syntax::chart::ast::{Body as Chart, Condition, PermanentKind};
use plcc_syntax::network::ast as network;
use plcc_syntax::scl::ast::{Expr, ExprKind, Statement, StatementKind};
use rustc_hash::FxHashMap;

use super::logic::{Atoms, Formula};
use super::step_title;
use crate::bind::chart::ChartBinder;
use crate::bind::scl::SclBlock;
use crate::bind::trees::mentions::{expressions, stl_statements};
use plcc_model::BlockKey;

impl ChartBinder<'_, '_> {
    /// Reports a supervision fault that stays for ever: it must be acknowledged, and nothing can do that.
    pub(super) fn acknowledgement(&mut self, ctx: &SclBlock, chart: &Chart) {
        if chart.settings.acknowledge != Some(true) {
            return;
        }
        let mut parameters = ctx.block.bound.interface.parameters.iter().map(|parameter| parameter.name.as_str());
        let acknowledges =
            |name: &str| ["ACK_EF", "ACK_S", "EN_ACKREQ"].iter().any(|own| own.eq_ignore_ascii_case(name));
        let supervised = chart.steps.iter().find(|step| step.supervision.as_ref().is_some_and(may_fault));
        let Some(step) = supervised else { return };
        if parameters.any(acknowledges) || self.blocks().any(names_acknowledgement) {
            return;
        }
        self.program.report(
            Diagnostic::new(
                Code::NoAcknowledgement,
                step.name.span,
                format!("a fault of {} can never be acknowledged", step_title(step)),
            )
            .label("has a supervision; once it reports a fault, the chart stays here")
            .help("declare the parameter ACK_EF and connect a button, or switch off the setting AckReq"),
        );
    }

    /// Reports instances of this block that one block calls twice.
    pub(super) fn called_twice(&mut self, ctx: &SclBlock) {
        let mut messages = Vec::new();
        for block in self.blocks() {
            let mut first: FxHashMap<u16, Span> = FxHashMap::default();
            for (instance, span) in self.chart_calls(ctx.block.key, &block.code) {
                if let Some(&first) = first.get(&instance) {
                    messages.push(
                        Diagnostic::new(Code::CalledTwice, span, format!("DB {instance} is called twice in one cycle"))
                            .label("the chart advances by another step here")
                            .also(first, "already called here")
                            .help("call the chart once, or give each call its own instance DB"),
                    );
                } else {
                    first.insert(instance, span);
                }
            }
        }
        messages.into_iter().for_each(|message| self.program.report(message));
    }

    fn blocks(&self) -> impl Iterator<Item = &ast::CodeBlock> {
        self.program.globals.input.units.iter().flat_map(|(_, unit)| &unit.blocks).filter_map(|block| match block {
            ast::Block::Code(code) => Some(code),
            ast::Block::Data(_) | ast::Block::Type(_) => None,
        })
    }

    /// Calls of the FB `key` that nothing skips, with their instance DBs.
    fn chart_calls(&self, key: BlockKey, code: &BlockCode) -> Vec<(u16, Span)> {
        let mut calls = Vec::new();
        let mut named = |callee: &Expr, instance: Option<&Expr>, span: Span| {
            calls.extend(self.chart_instance(key, callee, instance).map(|instance| (instance, span)));
        };
        match code {
            BlockCode::Stl(_) => return self.stl_calls(key, code),
            BlockCode::Scl(body) => {
                if body.labels.is_empty() {
                    statement_calls(&body.statements, &mut named);
                }
            }
            BlockCode::Graphic(body) => {
                if body.networks.iter().all(|network| network.labels.is_empty()) {
                    body.networks.iter().for_each(|network| network_calls(network, &mut named));
                }
            }
            BlockCode::Chart(chart) => {
                for permanent in chart.before.iter().chain(&chart.after) {
                    match &permanent.kind {
                        PermanentKind::Call(call) => named(&call.block, call.instance.as_ref(), call.span),
                        PermanentKind::Network(network) => network_calls(network, &mut named),
                        PermanentKind::Coil { .. } => {}
                    }
                }
            }
        }
        calls
    }

    /// Calls in STL. If the block has a label, a jump may skip any of them.
    fn stl_calls(&self, key: BlockKey, code: &BlockCode) -> Vec<(u16, Span)> {
        let BlockCode::Stl(networks) = code else { return Vec::new() };
        let statements = || networks.iter().flat_map(|network| &network.statements);
        if statements().any(|statement| statement.label.is_some()) {
            return Vec::new();
        }
        let calls = statements().filter_map(|statement| match &statement.kind {
            ast::StatementKind::Call(call) => {
                let target = self.program.named_number(&call.target)?;
                let instance = self.program.named_number(call.instance.as_ref()?)?;
                (is_block(target, key) && instance.0 == BlockPrefix::Db).then_some((instance.1, statement.span))
            }
            _ => None,
        });
        calls.collect()
    }

    /// The instance DB of a call of the FB `key`: `FB1.DB1(…)`, `"Db"(…)`.
    fn chart_instance(&self, key: BlockKey, callee: &Expr, instance: Option<&Expr>) -> Option<u16> {
        let block = |value: &Expr| match &value.kind {
            ExprKind::Name(name) => self.program.type_block(&name.text),
            _ => None,
        };
        let is_db = |(prefix, number): (BlockPrefix, u16)| (prefix == BlockPrefix::Db).then_some(number);
        if let Some(instance) = instance {
            return is_block(block(callee)?, key).then(|| block(instance).and_then(is_db))?;
        }
        if let ExprKind::Member { base, name } = &callee.kind {
            return is_block(block(base)?, key).then(|| self.program.type_block(&name.text).and_then(is_db))?;
        }
        let number = is_db(block(callee)?)?;
        (self.program.data.blocks.get(&number)?.block.instance_of == Some(key)).then_some(number)
    }
}

fn is_block((prefix, number): (BlockPrefix, u16), key: BlockKey) -> bool {
    prefix == BlockPrefix::Fb && key.kind == BlockKind::Fb && number == key.number
}

type Visit<'a> = dyn FnMut(&Expr, Option<&Expr>, Span) + 'a;

/// Unconditional calls.
fn statement_calls(list: &[Statement], visit: &mut Visit) {
    for statement in list {
        if let StatementKind::Expression(Expr { kind: ExprKind::Call { callee, .. }, .. }) = &statement.kind {
            visit(callee, None, statement.span);
        }
    }
}

fn network_calls(network: &network::Network, visit: &mut Visit) {
    let graph = match &network.content {
        network::Content::Graphic(graph) => graph,
        network::Content::Scl(list) => return statement_calls(list, visit),
        network::Content::Stl(_) => return,
    };
    for element in &graph.elements {
        let always = match element.pin("en").map(|pin| &pin.value) {
            None | Some(network::PinValue::Open) => true,
            Some(network::PinValue::Operand(_)) => false,
            Some(network::PinValue::Net(id)) => {
                let net = graph.nets.get(id.0 as usize);
                net.is_some_and(|net| net.sources.iter().all(|source| *source == network::Source::Rail))
            }
        };
        if let network::Target::Block { callee, instance } = &element.target
            && always
        {
            visit(callee, instance.as_ref(), element.span);
        }
    }
}

/// A supervision with content. An empty network means there is none.
fn may_fault(condition: &Condition) -> bool {
    let formula = Formula::of(condition, &mut Atoms::default());
    formula.constant() != Some(false) && !(formula.plain && matches!(condition, Condition::Network(_)))
}

/// Code of a block names `MOP.ACK`, ACK_EF, ACK_S or ACKREQ of some instance.
fn names_acknowledgement(block: &ast::CodeBlock) -> bool {
    let names = |outer: &str, name: &str| {
        let begin = name.get(..3).unwrap_or_default();
        outer.eq_ignore_ascii_case("MOP") && begin.eq_ignore_ascii_case("ACK")
    };
    let mut found = false;
    expressions(&block.code, &mut |value| {
        if let ExprKind::Member { base, name } = &value.kind
            && let ExprKind::Member { name: outer, .. } | ExprKind::Name(outer) = &base.kind
        {
            found |= names(&outer.text, &name.text);
        }
    });
    let statements = block.networks().iter().flat_map(|network| &network.statements);
    let operands = statements.chain(stl_statements(&block.code)).filter_map(|statement| match &statement.kind {
        ast::StatementKind::Instruction { operand, .. } => operand.as_ref(),
        _ => None,
    });
    let mut paths = operands.filter_map(|operand| match &operand.kind {
        OperandKind::Path(path) => Some(path),
        _ => None,
    });
    found
        || paths.any(|path| {
            path.parts.windows(2).any(|parts| match parts {
                [PathPart::Member { name: outer, .. }, PathPart::Member { name, .. }] => names(outer, name),
                _ => false,
            })
        })
}
