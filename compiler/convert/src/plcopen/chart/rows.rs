//! Rows of a step as actions of SFC.

use plcc_diag::Span;
use plcc_syntax::ast::SectionKind;
use plcc_syntax::chart::ast::{Action, ActionBody, Call, Dialect, Event, Qualifier, Step};
use plcc_syntax::network::ast::{Content, Network};
use plcc_syntax::scl::ast::{
    Argument, AssignOp, BinaryOp, Expr, ExprKind, Literal, Name, NameForm, Statement, StatementKind,
};
use plcc_syntax::{Class, Elementary};

use super::{statements, structured_text};
use crate::frames::bare;
use crate::node::Node;
use crate::plcopen::body::Body;
use crate::plcopen::documentation;
use crate::plcopen::objects::text_width;
use crate::plcopen::program::{Global, is_function};

/// Rows of a step among which the last execution of an action is looked for.
const ROWS_MAX: usize = 200;

/// The rows of a step.
pub(super) struct Rows<'r, 'p, 'a, 'w, 't> {
    pub(super) body: &'r mut Body<'p, 'a, 'w, 't>,
    pub(super) step: &'r Step,
    pub(super) name: String,
    pub(super) actions: Vec<Node>,
    /// Comments between rows, which become part of the comment of the step.
    pub(super) remarks: Vec<String>,
    pub(super) widest: i32,
    pub(super) dialect: Dialect,
}

impl Rows<'_, '_, '_, '_, '_> {
    fn refuse(&mut self, action: &Action, title: impl Into<String>, help: &str) {
        self.body.refuse(action.span, title, help);
    }

    /// Writes all rows.
    pub(super) fn all(&mut self) {
        let step = self.step;
        let rows = &step.actions;
        let mut is_done = vec![false; rows.len()];
        for (at, action) in rows.iter().enumerate() {
            if std::mem::replace(&mut is_done[at], true) {
                self.remarks_of(action, None);
                continue;
            }
            // SFC executes an action with N once more when its step is left: two rows here.
            let is_code = matches!(action.body, ActionBody::Statements(_) | ActionBody::Network(_));
            let is_plain = action.event.is_none() && action.qualifier == Qualifier::N;
            let last = rows.iter().enumerate().skip(at + 1).take(ROWS_MAX).find(|(other, row)| {
                !is_done[*other]
                    && row.event == Some(Event::S0)
                    && row.qualifier == Qualifier::N
                    && row.body == action.body
            });
            let last = last.filter(|_| is_code && is_plain).map(|(other, _)| other);
            if let Some(other) = last {
                is_done[other] = true;
            }
            self.row(action, last.is_some());
            self.remarks_of(action, action.comment.as_deref());
        }
    }

    /// Takes the comments up to the end of a row; `own` is written with the row.
    fn remarks_of(&mut self, action: &Action, own: Option<&str>) {
        // Those of XML belong to its statements.
        if self.dialect == Dialect::Sfc {
            return;
        }
        let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        let own = own.map(words);
        let mut remarks = self.body.writer.trivia.on_line(action.span.end);
        remarks.retain(|remark| own.as_ref().is_none_or(|own| words(&bare(&remark.text)) != *own));
        self.remarks.extend(remarks.iter().flat_map(|remark| remark.text.lines().map(bare).collect::<Vec<_>>()));
    }

    /// `is_last_too`: the row is also executed in the call that leaves the step.
    fn row(&mut self, action: &Action, is_last_too: bool) {
        let moment = match action.event {
            None => None,
            Some(Event::S1) => Some("P1"),
            Some(Event::S0) => Some("P0"),
            Some(event @ (Event::V1 | Event::V0 | Event::L1 | Event::L0 | Event::A1 | Event::R1)) => {
                let title = format!("SFC has no actions at the event {}", event.name());
                return self.refuse(action, title, "SFC has P1 and P0 for a step that is entered and left");
            }
        };
        match (&action.body, action.qualifier) {
            (ActionBody::Operand(operand), Qualifier::N) => self.variable(action, moment.unwrap_or("N"), operand),
            (ActionBody::Operand(operand), Qualifier::S | Qualifier::R) => {
                let is_set = action.qualifier == Qualifier::S;
                match moment {
                    None => self.variable(action, if is_set { "S" } else { "R" }, operand),
                    Some(_) => {
                        let value = Literal::Typed { ty: Elementary::Bool, bits: u64::from(is_set) };
                        let value = Expr { kind: ExprKind::Literal(value), span: operand.span };
                        self.code(action, moment, &[assignment(operand, value, action.span)]);
                    }
                }
            }
            (ActionBody::Value { operand, value }, Qualifier::D | Qualifier::L) if moment.is_none() => {
                if !matches!(self.body.elementary(value), Some(Elementary::Time) | None) {
                    let title = "the time of an action is in an operand that is not of type TIME";
                    return self.refuse(action, title, "give the time a variable of type TIME");
                }
                let time = self.body.text(value);
                let qualifier = if action.qualifier == Qualifier::D { "D" } else { "L" };
                self.variable(action, qualifier, operand);
                if let Some(node) = self.actions.last_mut() {
                    node.attributes.push(("duration", time));
                }
            }
            (ActionBody::Value { operand, value }, Qualifier::N) => {
                if self.is_number_of_bits(operand, value) {
                    let title = "GRAPH computes here with the bits of an operand as a number, and ST does not";
                    return self.refuse(action, title, "give the operand a type such as INT, or convert it");
                }
                self.code(action, moment, &[assignment(operand, value.clone(), action.span)]);
            }
            (ActionBody::Call(call), Qualifier::N) => {
                if let Some(statement) = self.call(call) {
                    self.code(action, moment, &[statement]);
                }
            }
            (ActionBody::Statements(list), Qualifier::N) => {
                if is_last_too {
                    let text = statements(self.body, list, |list| list);
                    self.push(action, "N", structured_text(&text));
                } else {
                    self.code(action, moment, list);
                }
            }
            (ActionBody::Network(network), Qualifier::N) => self.network(action, moment, network, is_last_too),
            (_, Qualifier::On | Qualifier::Off) => {
                let title = "SFC has no actions that activate or deactivate steps";
                self.refuse(action, title, "draw the transitions to and from these steps");
            }
            (
                _,
                Qualifier::Cs
                | Qualifier::Cu
                | Qualifier::Cd
                | Qualifier::Cr
                | Qualifier::Tl
                | Qualifier::Td
                | Qualifier::Tr
                | Qualifier::Tf,
            ) => {
                let title = "PLCopen XML has no timers and counters of the CPU";
                self.refuse(action, title, "use TON, CTU and similar blocks");
            }
            (
                ActionBody::Operand(_)
                | ActionBody::Value { .. }
                | ActionBody::All { .. }
                | ActionBody::Call(_)
                | ActionBody::Statements(_)
                | ActionBody::Network(_)
                | ActionBody::Error,
                Qualifier::N | Qualifier::S | Qualifier::R | Qualifier::D | Qualifier::L,
            ) => self.refuse(action, "an action that SFC does not have", "repair the source first"),
        }
    }

    /// An action that is a variable.
    fn variable(&mut self, action: &Action, qualifier: &str, operand: &Expr) {
        let name = self.body.text(operand);
        let width = text_width(&name).saturating_add(80);
        self.add(action, qualifier, Node::new("reference").with("name", name), width);
    }

    /// An action with a body of its own.
    fn push(&mut self, action: &Action, qualifier: &str, content: Node) {
        // Enough for the beginning of a statement.
        self.add(action, qualifier, Node::new("inline").child(content), 240);
    }

    fn add(&mut self, action: &Action, qualifier: &str, content: Node, width: i32) {
        self.widest = self.widest.max(width);
        let mut node = Node::new("action").with("qualifier", qualifier).child(content);
        node.children.extend(action.comment.as_deref().filter(|text| !text.trim().is_empty()).map(documentation));
        self.actions.push(node);
    }

    /// An action of statements, which GRAPH does not execute when the step is left.
    fn code(&mut self, action: &Action, moment: Option<&str>, list: &[Statement]) {
        let span = action.span;
        let flag = Name { text: self.name.clone(), form: NameForm::Bare, span };
        let text = statements(self.body, list, |list| match moment {
            Some(_) => list,
            None => {
                let base = Box::new(Expr { kind: ExprKind::Name(flag), span });
                let name = Name { text: "X".to_string(), form: NameForm::Bare, span };
                let active = Expr { kind: ExprKind::Member { base, name }, span };
                let kind = StatementKind::If { branches: vec![(active, list)], otherwise: Vec::new() };
                vec![Statement { kind, span }]
            }
        });
        self.push(action, moment.unwrap_or("N"), structured_text(&text));
    }

    fn network(&mut self, action: &Action, moment: Option<&str>, network: &Network, is_last_too: bool) {
        if moment.is_none() && !is_last_too {
            let title = "an action with a network, which SFC would also execute when its step is left";
            return self.refuse(action, title, "put the network into a block, and call it in the action");
        }
        match &network.content {
            Content::Graphic(_) => {
                let networks = std::slice::from_ref(network);
                let content = crate::plcopen::network::write(self.body, networks, network.language);
                self.push(action, moment.unwrap_or("N"), content);
            }
            Content::Scl(_) | Content::Stl(_) => {
                let title = "an action with a network of statements";
                self.refuse(action, title, "write the statements as the action");
            }
        }
    }

    /// Whether an assignment reads or writes bits as a number, as GRAPH does.
    fn is_number_of_bits(&self, operand: &Expr, value: &Expr) -> bool {
        let is_bits = |ty: Elementary| ty.class() == Class::Bits && ty != Elementary::Bool;
        let differs = match (self.body.elementary(operand), self.body.elementary(value)) {
            (Some(to), Some(from)) => to != from && (is_bits(to) || is_bits(from)),
            _ => false,
        };
        self.dialect != Dialect::Sfc && (differs || self.computes_with_bits(value))
    }

    fn computes_with_bits(&self, value: &Expr) -> bool {
        match &value.kind {
            ExprKind::Binary { op, left, right, .. } => {
                let computes = match op {
                    BinaryOp::Add
                    | BinaryOp::Subtract
                    | BinaryOp::Multiply
                    | BinaryOp::Divide
                    | BinaryOp::DivideInteger
                    | BinaryOp::Modulo
                    | BinaryOp::Power => true,
                    BinaryOp::Or
                    | BinaryOp::Xor
                    | BinaryOp::And
                    | BinaryOp::Equal
                    | BinaryOp::NotEqual
                    | BinaryOp::Less
                    | BinaryOp::Greater
                    | BinaryOp::LessEqual
                    | BinaryOp::GreaterEqual => false,
                };
                let is_bits = |side: &Expr| self.body.elementary(side).is_some_and(|ty| ty.class() == Class::Bits);
                computes && (is_bits(left) || is_bits(right))
                    || self.computes_with_bits(left)
                    || self.computes_with_bits(right)
            }
            ExprKind::Unary { operand, .. } => self.computes_with_bits(operand),
            _ => false,
        }
    }

    /// `CALL FB1, DB1 (IN := MW2)` as a statement.
    fn call(&mut self, call: &Call) -> Option<Statement> {
        let key = self.body.program.callee_key(&call.block);
        let block = match key.and_then(|key| self.body.program.global(&key)) {
            Some(Global::Code(block)) => Some(block),
            _ => None,
        };
        let mut arguments = Vec::new();
        let mut result = None;
        for parameter in &call.parameters {
            let Some(value) = &parameter.value else { continue };
            let has = |name: &str| name.eq_ignore_ascii_case(&parameter.name.text);
            let mut sections = block.into_iter().flat_map(|block| &block.sections);
            let own = sections.find(|section| section.variables.iter().any(|variable| has(&variable.name)));
            let kind = own.map(|section| section.kind);
            if kind.is_none() && block.is_some_and(is_function) && has("RET_VAL") {
                result = Some(value);
                continue;
            }
            arguments.push(Argument {
                name: Some(parameter.name.clone()),
                output: kind == Some(SectionKind::Output),
                value: Some(value.clone()),
                span: parameter.span,
            });
        }
        if result.is_none() && block.is_some_and(|block| is_function(block) && block.return_type.is_some()) {
            let title = "a call of a function in an action that does not say where its result goes";
            self.body.refuse(call.span, title, "give RET_VAL a variable");
            return None;
        }
        let callee = Box::new(call.instance.as_ref().unwrap_or(&call.block).clone());
        let value = Expr { kind: ExprKind::Call { callee, arguments }, span: call.span };
        Some(match result {
            Some(target) => assignment(target, value, call.span),
            None => Statement { kind: StatementKind::Expression(value), span: call.span },
        })
    }
}

fn assignment(target: &Expr, value: Expr, span: Span) -> Statement {
    Statement { kind: StatementKind::Assign { targets: vec![(target.clone(), AssignOp::Set)], value }, span }
}
