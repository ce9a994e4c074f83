//! Jumps and labels, and the variables in which results come to labels.

use std::ops::Range;

use plcc_diag::Span;

use super::lines::Line;
use super::{List, negated};
use crate::plcopen::types::{self, Ty};
use plcc_syntax::ast::{TypeKind, TypeRef};
use plcc_syntax::scl::ast::{AssignOp, BinaryOp, Expr, ExprKind, Name, NameForm, Statement, StatementKind};

/// The result at a label: its variable, and the type of the result on the paths to the label.
pub(super) struct Merged {
    name: String,
    kind: Option<Ty>,
    span: Span,
}

impl List<'_, '_, '_> {
    /// Declares a variable for each label after which the result is used.
    pub(super) fn merge_at_labels(&mut self, lines: &[Line]) {
        let mut needed = false;
        for line in lines.iter().rev() {
            if line.operator.is_some() {
                needed = !self.begins_anew(line);
            }
            let Some(label) = line.label.clone().filter(|_| needed) else { continue };
            let (key, span) = (self.slice(&label).to_lowercase(), self.reader.span(label));
            let ty = TypeRef { kind: TypeKind::Named("BOOL".to_string()), span };
            let name = self.body.temporary_variable(ty, span);
            self.merged.insert(key, Merged { name, kind: None, span });
        }
    }

    /// Gives the variables of labels the types of the results on the paths to them.
    pub(super) fn declare_merged(&mut self) {
        let mut merged: Vec<Merged> = std::mem::take(&mut self.merged).into_values().collect();
        merged.sort_by_key(|merged| merged.span.start);
        for Merged { name, kind, span } in merged {
            let Some(word) = kind.as_ref().and_then(Ty::word) else {
                let help = "store the result in a variable before each jump, and load it after the label";
                self.refuse(span, "the type of the result at this label is not known", help);
                continue;
            };
            let declared = self.body.temporary.iter_mut().find(|variable| variable.name == name);
            if let Some(variable) = declared {
                variable.ty.kind = TypeKind::Named(word);
            }
        }
    }

    /// The result goes to the variable of a label, if the label has one.
    fn hand_over(&mut self, label: &str, value: Expr, span: Span) -> Option<Statement> {
        let kind = self.kind.clone();
        let merged = self.merged.get_mut(&label.to_lowercase())?;
        // The wider of two types can hold both.
        merged.kind = types::operation(BinaryOp::Add, merged.kind.as_ref(), kind.as_ref());
        let name = Name { text: merged.name.clone(), form: NameForm::Local, span };
        let target = Expr { kind: ExprKind::Name(name), span };
        Some(Statement { kind: StatementKind::Assign { targets: vec![(target, AssignOp::Set)], value }, span })
    }

    pub(super) fn label(&mut self, label: &Range<usize>) {
        let span = self.reader.span(label.clone());
        let text = self.slice(label).to_string();
        let merged = self.merged.get(&text.to_lowercase()).map(|merged| merged.name.clone());
        if merged.is_some() && self.reached {
            match self.result.take() {
                Some(value) => {
                    let statement = self.hand_over(&text, value, span);
                    self.statements.extend(statement);
                }
                None => self.no_result(span),
            }
        }
        self.push(StatementKind::Label(Name { text: text.clone(), form: NameForm::Bare, span }), span);
        self.reached = true;
        self.kind = self.merged.get(&text.to_lowercase()).and_then(|merged| merged.kind.clone());
        self.result = merged.map(|text| {
            let name = Name { text, form: NameForm::Local, span };
            Expr { kind: ExprKind::Name(name), span }
        });
    }

    /// `JMP L`, `JMPC L`, `JMPCN L`
    pub(super) fn jump(&mut self, line: &Line, word: &str, kept: bool, span: Span) {
        let label = line.operand.clone();
        let text = self.slice(&label).trim().to_string();
        if text.is_empty() {
            return self.refuse(span, "a jump without a label", "write the label after it");
        }
        let needed = self.merged.contains_key(&text.to_lowercase());
        let name = Name { text: text.clone(), form: NameForm::Bare, span: self.reader.span(label) };
        let goto = StatementKind::Goto(name);
        if word == "JMP" {
            if needed && let Some(value) = self.taken(span) {
                let statement = self.hand_over(&text, value, span);
                self.statements.extend(statement);
            }
            self.push(goto, span);
            self.result = None;
            self.reached = false;
            return;
        }
        let Some(condition) = self.condition(false, kept || needed, span) else { return };
        let mut body = Vec::new();
        if needed {
            body.extend(self.hand_over(&text, condition.clone(), span));
        }
        body.push(Statement { kind: goto, span });
        self.when(negated(condition, word == "JMPCN"), body, span);
    }
}
