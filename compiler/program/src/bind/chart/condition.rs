//! Conditions of transitions, interlocks and supervisions. Source: GRAPH reference A.6.

#[cfg(test)]
mod tests;

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::Elementary;
use plcc_syntax::chart::ast::Condition;
use plcc_syntax::network::ast::{Content, Network, Target};
use plcc_syntax::network::elements::Kind;
use plcc_syntax::scl::ast::{
    AssignOp, Expr as Node, ExprKind as NodeKind, Name, NameForm, Statement as Tree, StatementKind as TreeKind,
};

use super::engine_data::Engine;
use crate::bind::chart::ChartBinder;
use crate::bind::network::Page;
use crate::bind::scl::SclBlock;
use crate::bind::scl::message::described;
use crate::bind::scl::numeric::Shape;
use plcc_binding::fold;
use plcc_model::scl::{Expr, Statement};

impl ChartBinder<'_, '_> {
    /// Binds a condition: statements, and their result, a BOOL that is valid until the next network or row is bound.
    /// `what` names it: "the transition `T1`".
    pub fn condition_code(
        &mut self,
        ctx: &mut SclBlock,
        engine: &mut Engine,
        condition: &Condition,
        what: &str,
    ) -> Option<(Vec<Statement>, Expr)> {
        match condition {
            Condition::Expression(node) => Some((Vec::new(), self.condition_value(ctx, node, what)?)),
            Condition::Statements(list) => self.condition_statements(ctx, list, what),
            Condition::Network(network) => match &network.content {
                Content::Scl(list) => self.condition_statements(ctx, list, what),
                Content::Graphic(_) | Content::Stl(_) => self.condition_network(ctx, &mut engine.page, network, what),
            },
        }
    }

    /// A BOOL.
    pub(super) fn condition_value(&mut self, ctx: &mut SclBlock, node: &Node, what: &str) -> Option<Expr> {
        let value = self.scl().value(ctx, node)?;
        if Shape::of(&value) == Shape::Of(Elementary::Bool) {
            return self.scl().convert(ctx, value, Elementary::Bool);
        }
        let (text, is) = (self.program.globals.text(node.span), described(&value));
        let is_structure = is == "of type STRUCT";
        self.program.report(
            Diagnostic::new(Code::ConditionType, node.span, format!("`{text}` is {is}, but {what} needs a BOOL"))
                .label(is.clone())
                .help(match text.as_str() {
                    "1" => "write `TRUE`".to_string(),
                    "0" => "write `FALSE`".to_string(),
                    // `CONDITION := T#5s`
                    _ if is.ends_with("constant of type TIME") => {
                        format!("compare the time of the step with it, as in `Step1.T >= {text}`")
                    }
                    _ if is_structure => format!("name a bit in it; a step is active while `{text}.X` is TRUE"),
                    _ if text.contains(char::is_whitespace) => {
                        "compare it, for example with `> 0`, or name a bit".to_string()
                    }
                    _ if is.contains("STRING") => format!("compare it, as in `{text} <> ''`, or name a bit"),
                    _ => format!("compare it, as in `{text} <> 0`, or name a bit"),
                }),
        );
        None
    }

    /// A network: the coil of the condition has the result.
    fn condition_network(
        &mut self,
        ctx: &mut SclBlock,
        page: &mut Page,
        network: &Network,
        what: &str,
    ) -> Option<(Vec<Statement>, Expr)> {
        page.condition = Some(None);
        let statements = self.networks().bind_lone_network(ctx, page, network);
        self.check_leaving(&statements);
        let result = page.condition.take().flatten();
        let coils = match &network.content {
            Content::Graphic(graph) if graph.broken => return None,
            Content::Graphic(graph) => graph
                .elements
                .iter()
                .filter(|element| matches!(&element.target, Target::Element { row, .. } if row.kind == Kind::Condition))
                .map(|element| element.span)
                .collect(),
            Content::Scl(_) | Content::Stl(_) => Vec::new(),
        };
        match coils.as_slice() {
            [] => {
                self.program.report(
                    Diagnostic::new(
                        Code::MissingCondition,
                        network.span,
                        format!("the network of {what} has no result"),
                    )
                    .label("there is no coil of the condition")
                    .help("end the network with the coil of the condition"),
                );
                None
            }
            [_] => Some((statements, result?)),
            [first, second, ..] => {
                let title = format!("the network of {what} has several results");
                self.program.report(
                    Diagnostic::new(Code::ElementPlace, *second, title)
                        .label("a second coil of the condition")
                        .also(*first, "the first one")
                        .help("join the branches into one coil"),
                );
                None
            }
        }
    }

    /// Statements. The last one is the condition, or assigns it to the name of the transition.
    fn condition_statements(
        &mut self,
        ctx: &mut SclBlock,
        list: &[Tree],
        what: &str,
    ) -> Option<(Vec<Statement>, Expr)> {
        let list = match list.iter().rposition(|tree| !matches!(tree.kind, TreeKind::Empty | TreeKind::Pragma(_))) {
            Some(last) => &list[..=last],
            None => return None,
        };
        let (last, before) = list.split_last()?;
        self.scl().collect_labels(ctx, before);
        let statements = self.scl().statements(ctx, before);
        self.check_leaving(&statements);
        let value = match &last.kind {
            TreeKind::Expression(node) => node,
            TreeKind::Assign { targets, value } if self.is_own_value(ctx, targets) => value,
            TreeKind::Error => return None,
            _ => {
                self.no_condition_at_end(last.span, what);
                return None;
            }
        };
        let value = self.condition_value(ctx, value, what)?;
        Some((statements, value))
    }

    /// The target is not a variable, so it means the transition.
    fn is_own_value(&self, ctx: &SclBlock, targets: &[(Node, AssignOp)]) -> bool {
        let [(Node { kind: NodeKind::Name(Name { text, form, .. }), .. }, AssignOp::Set)] = targets else {
            return false;
        };
        let folded = fold(text);
        *form == NameForm::Bare
            && !ctx.block.bound.locals.contains_key(&folded)
            && !self.program.globals.names.symbols.contains_key(&folded)
            && plcc_syntax::scl::absolute(text).is_none()
    }

    fn no_condition_at_end(&mut self, span: Span, what: &str) {
        self.program.report(
            Diagnostic::new(Code::ConditionType, span, format!("the last statement of {what} is not a condition"))
                .label("it has no value")
                .help("end with the condition alone, `a AND b;`, or assign it to the name of the transition"),
        );
    }
}
