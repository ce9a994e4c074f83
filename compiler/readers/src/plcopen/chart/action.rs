//! The actions of steps: action blocks as rows. Source: GRAPH reference, chapter C.
//!
//! Qualifiers of IEC 61131-3 and the rows with the same meaning:
//!
//! | IEC | Variable | Statements or networks |
//! | --- | --- | --- |
//! | N | N | N, and S0 for the last time when the step is left |
//! | S, R | S, R | S, R of a hidden BOOL |
//! | D, L | D, L | D, L of a hidden BOOL |
//! | P, P1 | S1 with N | S1 with N |
//! | P0 | S0 with N | S0 with N |
//! | SD, SL | S of a hidden BOOL that starts a TON | the same |
//! | DS | D of a hidden BOOL that sets the variable | the same |
//!
//! The statements of hidden BOOLs run after the sequencer, in each call: while their BOOL is 1, and once more when it has become 0.
//! R resets the BOOLs of its action, no matter which step has set them.

use std::collections::HashMap;

use plcc_diag::{Code, Span};
use roxmltree::Node;

use super::drawing::Plan;
use super::{Sfc, comment};
use crate::plcopen::interface::{child, elements};
use crate::plcopen::objects::lines;
use plcc_syntax::chart::ast::{Action, ActionBody, Event, Permanent, PermanentKind, Qualifier, Step};
use plcc_syntax::network::ast::{Content, Language, Network};
use plcc_syntax::scl::ast::{
    Argument, AssignOp, BinaryOp, Expr, ExprKind, Literal, Name, NameForm, Statement, StatementKind, UnaryOp,
};

/// The operand or the statements of an action.
enum Work {
    Operand(Expr),
    /// Rows, and the name of the action of the POU.
    Code(Vec<ActionBody>, Option<String>),
    /// Could not be read; reported.
    Error,
}

/// An action with its place in the file.
struct Entry {
    span: Span,
    qualifier_span: Span,
    comment: Option<String>,
}

impl Entry {
    fn row(&self, event: Option<Event>, qualifier: Qualifier, body: ActionBody) -> Action {
        let (qualifier_span, comment, span) = (self.qualifier_span, self.comment.clone(), self.span);
        Action { event, qualifier, interlock: false, qualifier_span, body, comment, span }
    }
}

impl<'a> Sfc<'_, 'a, '_> {
    /// Adds the rows of all action blocks to their steps.
    pub fn actions(&mut self, content: Node<'a, 'a>, plan: &Plan<'a>, steps: &mut [Step]) {
        let mut owners: HashMap<String, usize> = HashMap::new();
        let mut resets: Vec<(usize, String, Entry)> = Vec::new();
        for block in elements(content).filter(|node| node.tag_name().name() == "actionBlock") {
            let of_line = |line: Node| plan.ids.get(line.attribute("refLocalId")?.trim()).copied();
            let Some(at) = lines(block).find_map(of_line) else {
                let span = self.reader.place(block, "name");
                let help = "connect it to the step that executes its actions";
                self.report(Code::NoSource, span, "an action block that belongs to no step", "is not executed", help);
                continue;
            };
            if matches!(block.attribute("negated").map(str::trim), Some("true" | "1")) {
                let span = self.reader.place(block, "negated");
                let help = "write the actions into the steps that are to execute them";
                let text = "plcc does not read actions that are executed while their step is not active";
                self.report(Code::ForeignContent, span, text, "a negated action block", help);
                continue;
            }
            for node in elements(block).filter(|node| node.tag_name().name() == "action") {
                let (rows, name, reset) = self.action(node);
                resets.extend(reset.map(|(name, entry)| (at, name, entry)));
                steps[at].actions.extend(rows);
                if let Some(name) = name {
                    self.owner(node, name, at, &mut owners);
                }
            }
        }
        for (at, name, entry) in resets {
            for flag in self.stored.get(&name).cloned().unwrap_or_default() {
                steps[at].actions.push(entry.row(None, Qualifier::R, ActionBody::Operand(flag)));
            }
        }
    }

    /// An action of several steps: IEC 61131-3 executes it once in a cycle, here each step executes it.
    fn owner(&mut self, node: Node<'a, 'a>, name: String, step: usize, owners: &mut HashMap<String, usize>) {
        let first = *owners.entry(name.to_lowercase()).or_insert(step);
        if first != step {
            let span = child(node, "reference")
                .map_or(self.reader.place(node, "qualifier"), |reference| self.reader.place(reference, "name"));
            let text = format!("the action `{name}` belongs to several steps");
            let help = "in the cycle where one of these steps follows the other, it is executed for both; do not count cycles in it";
            self.report(Code::Tolerated, span, text, "is executed for each of them", help);
        }
    }

    /// The rows of an action, the name of the action of the POU that N executes, and the action that R resets.
    fn action(&mut self, node: Node<'a, 'a>) -> (Vec<Action>, Option<String>, Option<(String, Entry)>) {
        let work = self.work(node);
        let span = match (&work, child(node, "reference")) {
            (Work::Operand(operand), _) => operand.span,
            (_, Some(reference)) => self.reader.place(reference, "name"),
            _ => self.reader.place(node, "localId"),
        };
        let key = child(node, "reference").and_then(|reference| reference.attribute("name")).unwrap_or_default();
        let key = key.trim().to_lowercase();
        let entry = Entry { span, qualifier_span: self.reader.place(node, "qualifier"), comment: comment(node).pop() };
        let qualifier = node.attribute("qualifier").map_or(String::new(), |text| text.trim().to_ascii_uppercase());
        let event = match qualifier.as_str() {
            "" | "N" => None,
            "P" | "P1" => Some(Event::S1),
            "P0" => Some(Event::S0),
            "R" => {
                let rows = match work {
                    Work::Operand(operand) => vec![entry.row(None, Qualifier::R, ActionBody::Operand(operand))],
                    Work::Code(..) | Work::Error => Vec::new(),
                };
                return (rows, None, Some((key, entry)));
            }
            "S" | "D" | "L" | "SD" | "DS" | "SL" => {
                return (self.controlled(node, entry, &qualifier, work, key), None, None);
            }
            _ => return (self.no_equivalent(entry, &qualifier), None, None),
        };
        match work {
            Work::Operand(operand) => (vec![entry.row(event, Qualifier::N, ActionBody::Operand(operand))], None, None),
            Work::Code(bodies, name) => {
                let last = if event.is_none() { bodies.clone() } else { Vec::new() };
                let rows = bodies.into_iter().map(|body| entry.row(event, Qualifier::N, body));
                let last = last.into_iter().map(|body| entry.row(Some(Event::S0), Qualifier::N, body));
                (rows.chain(last).collect(), name.filter(|_| event.is_none()), None)
            }
            Work::Error => (vec![entry.row(event, Qualifier::N, ActionBody::Error)], None, None),
        }
    }

    /// A variable, an action of the POU, or the body of the action itself.
    fn work(&mut self, node: Node<'a, 'a>) -> Work {
        if let Some(inline) = child(node, "inline") {
            return self.code(inline).map_or(Work::Error, |rows| Work::Code(rows, None));
        }
        let reference = child(node, "reference").and_then(|reference| reference.attribute_node("name"));
        let Some(attribute) = reference.filter(|attribute| !attribute.value().trim().is_empty()) else {
            let span = self.reader.place(node, "qualifier");
            let help = "name a BOOL variable or an action of the POU, or write statements";
            self.report(Code::ActionText, span, "an action without an operand", "", help);
            return Work::Error;
        };
        let name = attribute.value().trim();
        if let Some(known) = self.actions.get(&name.to_lowercase()) {
            return known.clone().map_or(Work::Error, |rows| Work::Code(rows, Some(name.to_string())));
        }
        let operand = self.reader.expression(attribute.range_value(), Some(&self.body.scope));
        Work::Operand(operand)
    }

    /// S, D, L, SD, DS, SL: a row with a BOOL, and its effect after the sequencer.
    fn controlled(
        &mut self,
        node: Node<'a, 'a>,
        entry: Entry,
        qualifier: &str,
        work: Work,
        key: String,
    ) -> Vec<Action> {
        let span = entry.span;
        let error = |entry: Entry| vec![entry.row(None, Qualifier::N, ActionBody::Error)];
        let time = match qualifier {
            "S" => None,
            _ => match self.duration(node) {
                Some(value) => Some(value),
                None => {
                    let text = format!("`{qualifier}` without a time");
                    let help = "give the action a duration, e.g. T#5s";
                    self.report(Code::ActionText, entry.qualifier_span, text, "needs a duration", help);
                    return error(entry);
                }
            },
        };
        let code = match &work {
            Work::Operand(_) => None,
            Work::Code(bodies, _) => match statements(bodies) {
                Some(list) => Some(list),
                None => {
                    let text = format!("plcc reads actions with `{qualifier}` in ST and IL only");
                    let help = "write the action in ST, or set a BOOL, and execute the networks outside the chart";
                    self.report(Code::Qualifier, entry.qualifier_span, text, "of networks", help);
                    return error(entry);
                }
            },
            Work::Error => return error(entry),
        };
        // The operand of the action: the variable, or a BOOL that represents the statements.
        let target = match work {
            Work::Operand(operand) => operand,
            Work::Code(..) | Work::Error => self.hidden(span, "BOOL"),
        };
        let (row, body) = match (qualifier, time) {
            ("D", Some(value)) => (Qualifier::D, ActionBody::Value { operand: target.clone(), value }),
            ("L", Some(value)) => (Qualifier::L, ActionBody::Value { operand: target.clone(), value }),
            ("DS", Some(value)) => {
                let due = self.hidden(span, "BOOL");
                let set = assignment(target.clone(), truth(true, span));
                self.push_after(vec![when(due.clone(), vec![set], Vec::new())], span);
                (Qualifier::D, ActionBody::Value { operand: due, value })
            }
            ("SD" | "SL", Some(value)) => {
                let (stored, timer) = (self.hidden(span, "BOOL"), self.hidden(span, "TON_TIME"));
                let before = self.hidden(span, "BOOL");
                let done = member(timer.clone(), "Q");
                let active = match qualifier {
                    "SD" => done,
                    _ => {
                        let not = Expr { kind: ExprKind::Unary { op: UnaryOp::Not, operand: Box::new(done) }, span };
                        both(stored.clone(), not)
                    }
                };
                let off = when(before.clone(), vec![assignment(target.clone(), truth(false, span))], Vec::new());
                let on = assignment(target.clone(), truth(true, span));
                self.push_after(
                    vec![
                        call(timer, vec![("IN", stored.clone()), ("PT", value)]),
                        when(active.clone(), vec![on], vec![off]),
                        assignment(before, active),
                    ],
                    span,
                );
                self.stored.entry(key.clone()).or_default().push(stored.clone());
                (Qualifier::S, ActionBody::Operand(stored))
            }
            _ => (Qualifier::S, ActionBody::Operand(target.clone())),
        };
        if let Some(list) = code {
            let before = self.hidden(span, "BOOL");
            let either = Expr {
                kind: ExprKind::Binary {
                    op: BinaryOp::Or,
                    op_span: span,
                    left: Box::new(target.clone()),
                    right: Box::new(before.clone()),
                },
                span,
            };
            self.push_after(vec![when(either, list, Vec::new()), assignment(before, target.clone())], span);
            if !matches!(qualifier, "D" | "L") {
                self.stored.entry(key).or_default().push(target);
            }
        }
        vec![entry.row(None, row, body)]
    }

    /// A variable of the instance that is used for nothing else.
    fn hidden(&mut self, span: Span, ty: &str) -> Expr {
        let text = self.body.hidden_variable("action", ty, span);
        Expr { kind: ExprKind::Name(Name { text, form: NameForm::Local, span }), span }
    }

    /// Statements after the sequencer, in each call.
    fn push_after(&mut self, list: Vec<Statement>, span: Span) {
        let (title, comment, labels) = (None, Vec::new(), Vec::new());
        let content = Content::Scl(list);
        let network = Network { language: Language::Scl, title, comment, labels, content, span };
        self.after.push(Permanent { kind: PermanentKind::Network(network), span });
    }

    fn duration(&mut self, node: Node<'a, 'a>) -> Option<Expr> {
        let attribute = node.attribute_node("duration").filter(|duration| !duration.value().trim().is_empty())?;
        let value = self.reader.expression(attribute.range_value(), Some(&self.body.scope));
        Some(value)
    }

    fn no_equivalent(&mut self, entry: Entry, qualifier: &str) -> Vec<Action> {
        let help = "IEC 61131-3 has N, S, R, D, L, P, P0, P1, SD, DS and SL";
        let text = format!("an action has no qualifier `{qualifier}`");
        self.report(Code::Qualifier, entry.qualifier_span, text, "not known", help);
        vec![entry.row(None, Qualifier::N, ActionBody::Error)]
    }
}

/// The statements of an action; none if it has networks.
fn statements(bodies: &[ActionBody]) -> Option<Vec<Statement>> {
    let mut all = Vec::new();
    for body in bodies {
        let ActionBody::Statements(list) = body else { return None };
        all.extend(list.iter().cloned());
    }
    Some(all)
}

fn truth(value: bool, span: Span) -> Expr {
    let literal = Literal::Typed { ty: plcc_syntax::Elementary::Bool, bits: u64::from(value) };
    Expr { kind: ExprKind::Literal(literal), span }
}

fn member(base: Expr, name: &str) -> Expr {
    let span = base.span;
    let name = Name { text: name.to_string(), form: NameForm::Bare, span };
    Expr { kind: ExprKind::Member { base: Box::new(base), name }, span }
}

fn both(left: Expr, right: Expr) -> Expr {
    let span = left.span;
    let kind = ExprKind::Binary { op: BinaryOp::And, op_span: span, left: Box::new(left), right: Box::new(right) };
    Expr { kind, span }
}

fn assignment(target: Expr, value: Expr) -> Statement {
    let span = target.span;
    Statement { kind: StatementKind::Assign { targets: vec![(target, AssignOp::Set)], value }, span }
}

fn when(condition: Expr, body: Vec<Statement>, otherwise: Vec<Statement>) -> Statement {
    let span = condition.span;
    Statement { kind: StatementKind::If { branches: vec![(condition, body)], otherwise }, span }
}

fn call(callee: Expr, inputs: Vec<(&str, Expr)>) -> Statement {
    let span = callee.span;
    let argument = |(name, value): (&str, Expr)| Argument {
        name: Some(Name { text: name.to_string(), form: NameForm::Bare, span }),
        output: false,
        value: Some(value),
        span,
    };
    let arguments = inputs.into_iter().map(argument).collect();
    let call = Expr { kind: ExprKind::Call { callee: Box::new(callee), arguments }, span };
    Statement { kind: StatementKind::Expression(call), span }
}
