//! Actions and permanent instructions: one row each.

use plcc_syntax::chart::ast::{Action, ActionBody, Call, Coil, Permanent, PermanentKind, Qualifier};
use plcc_syntax::scl::ast::{AssignOp, Expr, Statement, StatementKind};

use super::{harmless, logic};
use crate::scl::expression;
use crate::writer::Writer;

impl Writer<'_> {
    pub(super) fn permanents(&mut self, word: &str, rows: &[Permanent]) {
        if rows.is_empty() {
            return;
        }
        self.out.line(word);
        self.out.indent();
        for row in rows {
            self.remarks_before(row.span.start);
            match &row.kind {
                PermanentKind::Coil { operand, coil, value } => self.coil(operand, *coil, value),
                PermanentKind::Call(call) => {
                    let text = self.call_text(call);
                    self.out.line(text);
                }
                PermanentKind::Network(network) => {
                    for (operand, coil, value) in logic::coils(network, self) {
                        self.coil(&operand, coil, &value);
                    }
                }
            }
            self.remarks_on_line(row.span.end);
        }
        self.out.dedent();
        self.out.line("END_PERM_CONDITION");
    }

    fn coil(&mut self, operand: &Expr, coil: Coil, value: &Expr) {
        let sign = match coil {
            Coil::Assign => "=",
            Coil::Set => "S",
            Coil::Reset => "R",
        };
        let operand = expression::text(operand, self);
        let value = expression::text(value, self);
        self.out.line(format!("{operand} ({sign}) := {value}"));
    }

    /// `CALL FB1, DB1 (a := 1)`
    pub(crate) fn call_text(&mut self, call: &Call) -> String {
        let block = expression::text(&call.block, self);
        let instance = match &call.instance {
            Some(instance) => format!(", {}", expression::text(instance, self)),
            None => String::new(),
        };
        let mut list = Vec::new();
        for parameter in &call.parameters {
            let value = parameter.value.as_ref().map_or(String::new(), |value| expression::text(value, self));
            list.push(format!("{} := {value}", crate::names::declared(&parameter.name.text)).trim_end().to_string());
        }
        format!("CALL {block}{instance} ({})", list.join(", "))
    }

    pub(super) fn action(&mut self, action: &Action) {
        self.remarks_before(action.span.start);
        let event = action.event.map_or(String::new(), |event| format!("{}_", event.name()));
        let mark = format!("{event}{}{}", action.qualifier.name(), if action.interlock { "C" } else { "" });
        match &action.body {
            ActionBody::Operand(operand) => {
                let operand = expression::text(operand, self);
                self.out.line(format!("{operand} ({mark})"));
            }
            ActionBody::Value { operand, value } => {
                let operand = expression::text(operand, self);
                let value = expression::text(value, self);
                let sign = match action.qualifier {
                    Qualifier::N | Qualifier::S | Qualifier::R | Qualifier::D | Qualifier::L => " :=",
                    _ => ",",
                };
                self.out.line(format!("{operand}{sign} {value} ({mark})"));
            }
            ActionBody::All { .. } => self.out.line(format!("S_ALL ({mark})")),
            ActionBody::Call(call) => {
                let text = self.call_text(call);
                self.out.line(format!("{text} ({mark})"));
            }
            ActionBody::Statements(list) => self.statements_of(list, &mark),
            ActionBody::Network(network) => {
                let title = "GRAPH sources have no networks in actions";
                self.refuse(network.span, title, "put the network into a block, and call it in the action");
            }
            ActionBody::Error => {
                self.refuse(action.span, "an action that was not understood", "repair the source first");
            }
        }
        if let Some(comment) = &action.comment {
            self.out.trail(&format!("(* {} *)", harmless(comment)));
        }
        let mut remarks = self.trivia.on_line(action.span.end);
        let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        let own = action.comment.as_deref().map(words);
        remarks.retain(|remark| own.as_ref().is_none_or(|own| words(&crate::frames::bare(&remark.text)) != *own));
        self.out.remarks(&remarks);
    }

    /// Statements of an action: assignments are rows.
    fn statements_of(&mut self, list: &[Statement], mark: &str) {
        for statement in list {
            match &statement.kind {
                StatementKind::Assign { targets, value } if matches!(targets[..], [(_, AssignOp::Set)]) => {
                    let target = expression::text(&targets[0].0, self);
                    let value = expression::text(value, self);
                    self.out.line(format!("{target} := {value} ({mark})"));
                }
                StatementKind::Empty => {}
                _ => self.refuse(
                    statement.span,
                    "GRAPH sources have only assignments and calls in actions",
                    "put the statements into a block, and call it in the action",
                ),
            }
        }
    }
}
