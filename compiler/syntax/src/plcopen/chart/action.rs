//! What steps do: action blocks as rows. Source: GRAPH reference, chapter C.
//!
//! Qualifiers of IEC 61131-3 and the rows that have their meaning:
//!
//! | IEC | Variable | Statements or networks |
//! | --- | --- | --- |
//! | N | N | N, and S0 for the last time when the step is left |
//! | S, R | S, R | none |
//! | D, L | D, L | none |
//! | P, P1 | S1 with N | S1 with N |
//! | P0 | S0 with N | S0 with N |
//! | SD, DS, SL | none | none |

use std::collections::HashMap;

use plcc_diag::{Code, Span};
use roxmltree::Node;

use super::drawing::Plan;
use super::{Sfc, comment};
use crate::chart::ast::{Action, ActionBody, Event, Qualifier, Step};
use crate::plcopen::interface::{child, elements};
use crate::plcopen::objects::lines;
use crate::scl::ast::Expr;
use crate::scl::fragment;

/// What an action works on.
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
        for block in elements(content).filter(|node| node.tag_name().name() == "actionBlock") {
            let of_line = |line: Node| plan.ids.get(line.attribute("refLocalId")?.trim()).copied();
            let Some(at) = lines(block).find_map(of_line) else {
                let span = self.reader.place(block, "name");
                let help = "connect it to the step whose actions it holds";
                self.report(Code::NoSource, span, "an action block that belongs to no step", "is not executed", help);
                continue;
            };
            if matches!(block.attribute("negated").map(str::trim), Some("true" | "1")) {
                let span = self.reader.place(block, "negated");
                let help = "write the actions into the steps in which they are to be executed";
                let text = "plcc does not read actions that are executed while their step is not active";
                self.report(Code::ForeignContent, span, text, "a negated action block", help);
                continue;
            }
            for node in elements(block).filter(|node| node.tag_name().name() == "action") {
                let (rows, name) = self.action(node, &steps[at].name.text);
                steps[at].actions.extend(rows);
                if let Some(name) = name {
                    self.owner(node, name, at, &mut owners);
                }
            }
        }
    }

    /// An action of several steps: IEC 61131-3 executes it once in a cycle, here each step does.
    fn owner(&mut self, node: Node<'a, 'a>, name: String, step: usize, owners: &mut HashMap<String, usize>) {
        let first = *owners.entry(name.to_lowercase()).or_insert(step);
        if first != step {
            let span = child(node, "reference")
                .map_or(self.reader.place(node, "qualifier"), |reference| self.reader.place(reference, "name"));
            let text = format!("the action `{name}` belongs to several steps");
            let help = "a cycle in which one of the steps follows the other executes it for both; let it not count such cycles";
            self.report(Code::Tolerated, span, text, "is executed for each of them", help);
        }
    }

    /// The rows of an action, and the name of the action of the POU that N executes.
    fn action(&mut self, node: Node<'a, 'a>, step: &str) -> (Vec<Action>, Option<String>) {
        let work = self.work(node);
        let span = match (&work, child(node, "reference")) {
            (Work::Operand(operand), _) => operand.span,
            (_, Some(reference)) => self.reader.place(reference, "name"),
            _ => self.reader.place(node, "localId"),
        };
        let entry = Entry { span, qualifier_span: self.reader.place(node, "qualifier"), comment: comment(node).pop() };
        let qualifier = node.attribute("qualifier").map_or(String::new(), |text| text.trim().to_ascii_uppercase());
        let event = match qualifier.as_str() {
            "" | "N" => None,
            "P" | "P1" => Some(Event::S1),
            "P0" => Some(Event::S0),
            "S" => return (self.stored(entry, Qualifier::S, work), None),
            "R" => return (self.stored(entry, Qualifier::R, work), None),
            "D" => return (self.timed(node, entry, Qualifier::D, work, step), None),
            "L" => return (self.timed(node, entry, Qualifier::L, work, step), None),
            _ => return (self.no_equivalent(entry, &qualifier, step), None),
        };
        match work {
            Work::Operand(operand) => (vec![entry.row(event, Qualifier::N, ActionBody::Operand(operand))], None),
            Work::Code(bodies, name) => {
                let last = if event.is_none() { bodies.clone() } else { Vec::new() };
                let rows = bodies.into_iter().map(|body| entry.row(event, Qualifier::N, body));
                let last = last.into_iter().map(|body| entry.row(Some(Event::S0), Qualifier::N, body));
                (rows.chain(last).collect(), name.filter(|_| event.is_none()))
            }
            Work::Error => (vec![entry.row(event, Qualifier::N, ActionBody::Error)], None),
        }
    }

    /// A variable, an action of the POU, or what stands in the action itself.
    fn work(&mut self, node: Node<'a, 'a>) -> Work {
        if let Some(inline) = child(node, "inline") {
            return self.code(inline).map_or(Work::Error, |rows| Work::Code(rows, None));
        }
        let reference = child(node, "reference").and_then(|reference| reference.attribute_node("name"));
        let Some(attribute) = reference.filter(|attribute| !attribute.value().trim().is_empty()) else {
            let span = self.reader.place(node, "qualifier");
            let help = "name a BOOL variable or an action of the POU, or write statements";
            self.report(Code::ActionText, span, "an action that works on nothing", "", help);
            return Work::Error;
        };
        let name = attribute.value().trim();
        if let Some(known) = self.actions.get(&name.to_lowercase()) {
            return known.clone().map_or(Work::Error, |rows| Work::Code(rows, Some(name.to_string())));
        }
        let (mut operand, messages) =
            fragment::expression(self.reader.file, &self.reader.overlay, attribute.range_value());
        self.reader.messages.extend(messages);
        self.body.scope.expr(&mut operand);
        Work::Operand(operand)
    }

    fn stored(&mut self, entry: Entry, qualifier: Qualifier, work: Work) -> Vec<Action> {
        let body = match work {
            Work::Operand(operand) => ActionBody::Operand(operand),
            Work::Code(..) => {
                let text = format!("GRAPH stores no statements: `{}` works on a BOOL only", qualifier.name());
                let help =
                    "set a BOOL by S and reset it by R, and execute the statements outside the chart while it is 1";
                self.report(Code::Qualifier, entry.qualifier_span, text, "stores an action", help);
                ActionBody::Error
            }
            Work::Error => ActionBody::Error,
        };
        vec![entry.row(None, qualifier, body)]
    }

    fn timed(&mut self, node: Node<'a, 'a>, entry: Entry, qualifier: Qualifier, work: Work, step: &str) -> Vec<Action> {
        let body = match work {
            Work::Operand(operand) => match self.duration(node) {
                Some(value) => ActionBody::Value { operand, value },
                None => {
                    let text = format!("`{}` without a time", qualifier.name());
                    let help = "give the action a duration, e.g. T#5s";
                    self.report(Code::ActionText, entry.qualifier_span, text, "needs a duration", help);
                    ActionBody::Error
                }
            },
            Work::Code(..) => {
                let (sign, text) = match qualifier {
                    Qualifier::D => (">=", "GRAPH delays no statements: `D` works on a BOOL only"),
                    _ => ("<", "GRAPH does not limit statements: `L` works on a BOOL only"),
                };
                let time = node.attribute("duration").map(str::trim).filter(|time| !time.is_empty()).unwrap_or("T#5s");
                let help = format!("take N, and write `IF {step}.T {sign} {time} THEN … END_IF;`");
                self.report(Code::Qualifier, entry.qualifier_span, text, "of statements or networks", help);
                ActionBody::Error
            }
            Work::Error => ActionBody::Error,
        };
        vec![entry.row(None, qualifier, body)]
    }

    fn duration(&mut self, node: Node<'a, 'a>) -> Option<Expr> {
        let attribute = node.attribute_node("duration").filter(|duration| !duration.value().trim().is_empty())?;
        let (mut value, messages) =
            fragment::expression(self.reader.file, &self.reader.overlay, attribute.range_value());
        self.reader.messages.extend(messages);
        self.body.scope.expr(&mut value);
        Some(value)
    }

    fn no_equivalent(&mut self, entry: Entry, qualifier: &str, step: &str) -> Vec<Action> {
        let (label, help) = match qualifier {
            "SD" => {
                let help = "set a BOOL by S, start a TON with it outside the chart, and take the output of the TON";
                ("stored and delayed", help.to_string())
            }
            "SL" => {
                let help = "set a BOOL by S, start a TP with it outside the chart, and take the output of the TP";
                ("stored and limited", help.to_string())
            }
            "DS" => {
                let help = format!("take N, and write `IF {step}.T >= T#5s THEN Operand := TRUE; END_IF;`");
                ("delayed and stored", help)
            }
            _ => ("not known", "IEC 61131-3 has N, S, R, D, L, P, P0, P1, SD, DS and SL".to_string()),
        };
        let text = format!("GRAPH has no equivalent of the qualifier `{qualifier}`");
        self.report(Code::Qualifier, entry.qualifier_span, text, label, help);
        vec![entry.row(None, Qualifier::N, ActionBody::Error)]
    }
}
