//! Statements, and assertions, which name variables in a text.

use plcc_diag::Span;
use plcc_syntax::ast::{DataBlock, DataContent, Pragma};
use plcc_syntax::scl::ast::{Arm, AssignOp, BinaryOp, CaseValue, Expr, ExprKind, Statement, StatementKind};

use super::Body;
use crate::plcopen::globals::has_place;
use crate::plcopen::identifier::identifier;
use crate::plcopen::program::{GLOBALS, Global};

impl Body<'_, '_, '_, '_> {
    pub fn statements(&mut self, list: &[Statement]) -> Vec<Statement> {
        list.iter().flat_map(|statement| self.statement(statement)).collect()
    }

    fn statement(&mut self, statement: &Statement) -> Vec<Statement> {
        let span = statement.span;
        let kind = match &statement.kind {
            StatementKind::Empty => StatementKind::Empty,
            StatementKind::Expression(value) => StatementKind::Expression(self.expr(value)),
            StatementKind::Assign { targets, value } => return self.assign(targets, value, span),
            StatementKind::If { branches, otherwise } => StatementKind::If {
                branches: branches
                    .iter()
                    .map(|(condition, body)| (self.expr(condition), self.statements(body)))
                    .collect(),
                otherwise: self.statements(otherwise),
            },
            StatementKind::Case { selector, arms, otherwise } => {
                let selector = self.expr(selector);
                let arms = arms
                    .iter()
                    .map(|arm| {
                        let value = |value: &CaseValue| CaseValue {
                            low: self.expr(&value.low),
                            high: value.high.as_ref().map(|high| self.expr(high)),
                        };
                        let values = arm.values.iter().map(value).collect();
                        Arm { values, body: self.statements(&arm.body), span: arm.span }
                    })
                    .collect();
                StatementKind::Case { selector, arms, otherwise: self.statements(otherwise) }
            }
            StatementKind::For { variable, start, end, step, body } => StatementKind::For {
                variable: self.expr(variable),
                start: self.expr(start),
                end: self.expr(end),
                step: step.as_ref().map(|step| self.expr(step)),
                body: self.statements(body),
            },
            StatementKind::While { condition, body } => {
                StatementKind::While { condition: self.expr(condition), body: self.statements(body) }
            }
            StatementKind::Repeat { body, until } => {
                StatementKind::Repeat { body: self.statements(body), until: self.expr(until) }
            }
            StatementKind::Exit => StatementKind::Exit,
            StatementKind::Continue => StatementKind::Continue,
            StatementKind::Return(None) => StatementKind::Return(None),
            StatementKind::Return(Some(_)) => {
                self.refuse(span, "ST has no RETURN with a value for ENO", "write RETURN alone");
                StatementKind::Error
            }
            StatementKind::Label(_) | StatementKind::Goto(_) => {
                self.refuse(span, "ST has no labels and jumps", "write it with IF, CASE and loops");
                StatementKind::Empty
            }
            StatementKind::Pragma(pragma) => StatementKind::Pragma(self.pragma(pragma)),
            StatementKind::Error => StatementKind::Error,
        };
        vec![Statement { kind, span }]
    }

    /// `a := b += e` is `b := b + e; a := b`.
    fn assign(&mut self, targets: &[(Expr, AssignOp)], value: &Expr, span: Span) -> Vec<Statement> {
        let mut value = self.expr(value);
        let mut list = Vec::new();
        for (target, op) in targets.iter().rev() {
            let target = self.expr(target);
            let op = match op {
                AssignOp::Set => None,
                AssignOp::Add => Some(BinaryOp::Add),
                AssignOp::Subtract => Some(BinaryOp::Subtract),
                AssignOp::Multiply => Some(BinaryOp::Multiply),
                AssignOp::Divide => Some(BinaryOp::Divide),
                AssignOp::Attempt => {
                    self.refuse(span, "ST has no `?=`", "assign with `:=`");
                    None
                }
            };
            if let Some(op) = op {
                let (left, right) = (Box::new(target.clone()), Box::new(value));
                value = Expr { kind: ExprKind::Binary { op, left, right, op_span: span }, span };
            }
            let next = target.clone();
            let kind = StatementKind::Assign { targets: vec![(target, AssignOp::Set)], value };
            list.push(Statement { kind, span });
            value = next;
        }
        list
    }

    /// An assertion, with the names of the file.
    fn pragma(&mut self, pragma: &Pragma) -> Pragma {
        let mut text = String::new();
        let mut rest = pragma.text.as_str();
        while let Some(at) = rest.find(['"', '#', '\'', '.']) {
            text.push_str(&rest[..at]);
            let sign = &rest[at..=at];
            rest = &rest[at + 1..];
            match sign {
                "'" => {
                    let end = rest.find('\'').map_or(rest.len(), |end| end + 1);
                    text.push_str(sign);
                    text.push_str(&rest[..end]);
                    rest = &rest[end..];
                }
                "." => {
                    text.push('.');
                    let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
                    let is_member = rest.starts_with(|c: char| c.is_alphabetic() || c == '_');
                    text.push_str(&if is_member { identifier(&rest[..end]) } else { rest[..end].to_string() });
                    rest = &rest[end..];
                }
                // A component in quotes.
                "\"" if text.ends_with('.') => {
                    let end = rest.find('"').unwrap_or(rest.len());
                    text.push_str(&identifier(&rest[..end]));
                    rest = rest.get(end + 1..).unwrap_or_default();
                }
                "\"" => {
                    let end = rest.find('"').unwrap_or(rest.len());
                    text.push_str(&self.asserted(&rest[..end]));
                    rest = rest.get(end + 1..).unwrap_or_default();
                }
                _ => {
                    // `16#FF` is a number.
                    let is_number = text.ends_with(|c: char| c.is_alphanumeric());
                    let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
                    if !is_number && self.is_start_information(&rest[..end]) {
                        let title = "an assertion of start information, which a program of PLCopen XML does not have";
                        self.refuse(pragma.span, title, "remove it");
                    }
                    text.push('#');
                    text.push_str(&if is_number { rest[..end].to_string() } else { identifier(&rest[..end]) });
                    rest = &rest[end..];
                }
            }
        }
        text.push_str(rest);
        Pragma { text, span: pragma.span, assert: None }
    }

    /// A global name in an assertion, where plcc finds it when it reads the file.
    fn asserted(&mut self, name: &str) -> String {
        let key = self.program.key_of(name);
        let written = self.program.name(&key);
        match self.program.global(&key) {
            Some(Global::Tag(symbol)) if has_place(symbol) => format!("\"{written}\""),
            Some(Global::Data(_)) if self.program.tasks.contains_key(&key) => format!("\"{written}\""),
            // An instance is a data block of its own.
            Some(Global::Data(DataBlock { content: DataContent::OfType(ty), .. }))
                if self.program.block_type(ty).is_some() =>
            {
                format!("\"{written}\"")
            }
            Some(Global::Data(_) | Global::Tag(_) | Global::Variable(_)) => format!("\"{GLOBALS}\".{written}"),
            _ if name.eq_ignore_ascii_case(GLOBALS) => format!("\"{GLOBALS}\""),
            _ => format!("\"{name}\""),
        }
    }
}
