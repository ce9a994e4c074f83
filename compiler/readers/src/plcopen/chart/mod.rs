//! SFC bodies as charts of GRAPH.
//!
//! - `drawing`: steps, transitions and branches with the lines between them, as [`chart::connect`](mod@connect) expects them.
//! - `condition`: the conditions of transitions.
//! - `action`: the actions of steps.
//!
//! Steps and transitions have no numbers here, and transitions have no names: they get them in the order of the file.
//! Source: GRAPH reference, chapter C.

mod action;
mod condition;
mod drawing;

use std::collections::{HashMap, HashSet};

use plcc_diag::{Code, Diagnostic, Span};
use roxmltree::Node;

use super::interface::{child, elements, plain_text};
use super::objects::{Kind, Object, connected_condition};
use super::{Body, Reader};
use drawing::Plan;
use plcc_syntax::chart::ast::{
    ActionBody, Body as Chart, Condition, Dialect, Interface, Permanent, Settings, Step, Transition,
};
use plcc_syntax::chart::connect::{Connection, connect};
use plcc_syntax::network::ast::Language;
use plcc_syntax::scl::ast::{Expr, Name, NameForm, Statement, StatementKind};

#[cfg(test)]
mod tests;

/// Reads an SFC body of a POU.
pub fn read<'a>(reader: &mut Reader<'a>, body: &mut Body, pou: Node<'a, 'a>, content: Node<'a, 'a>) -> Chart {
    let objects = reader.objects(content);
    let (transitions, actions) = (HashMap::new(), HashMap::new());
    let mut sfc =
        Sfc { reader, body, objects, transitions, actions, stored: HashMap::new(), after: Vec::new(), broken: false };
    let plan = sfc.plan(content);
    let names = sfc.step_names(&plan.steps);
    sfc.hide(&names);
    sfc.read_named(pou);
    let mut steps = sfc.steps(&plan.steps, &names);
    sfc.actions(content, &plan, &mut steps);
    let connections = connect(&plan.drawing, &mut sfc.reader.messages);
    let transitions = sfc.transitions(&plan, &names, connections);
    sfc.idle_networks();
    let settings =
        Settings { interface: Some(Interface::UserDefined), acknowledge: Some(false), ..Settings::default() };
    let (after, broken) = (sfc.after, sfc.broken);
    Chart { dialect: Dialect::Sfc, settings, steps, transitions, after, broken, ..Chart::default() }
}

/// A chart that is being read.
struct Sfc<'r, 'a, 'b> {
    reader: &'r mut Reader<'a>,
    body: &'b mut Body,
    /// The objects of the networks in the chart.
    objects: Vec<Object>,
    /// Named transitions of the POU, by name in lower case; none: could not be read.
    transitions: HashMap<String, Option<Condition>>,
    /// Actions of the POU by their names in lower case, as rows; none: could not be read.
    actions: HashMap<String, Option<Vec<ActionBody>>>,
    /// BOOLs that keep an action going, by its name in lower case.
    stored: HashMap<String, Vec<Expr>>,
    /// The networks after the sequencer, executed in each call.
    after: Vec<Permanent>,
    broken: bool,
}

impl<'a> Sfc<'_, 'a, '_> {
    fn report(&mut self, code: Code, span: Span, text: impl Into<String>, label: &str, help: impl Into<String>) {
        let message = Diagnostic::new(code, span, text);
        let message = if label.is_empty() { message } else { message.label(label) };
        self.reader.messages.push(message.help(help));
    }

    fn step_names(&self, steps: &[Node<'a, 'a>]) -> Vec<Name> {
        let name = |(at, step): (usize, &Node)| {
            let text = step.attribute("name").map(str::trim).filter(|name| !name.is_empty());
            let text = text.map_or_else(|| format!("Step{}", at + 1), str::to_string);
            Name { text, form: NameForm::Bare, span: self.reader.place(*step, "name") }
        };
        steps.iter().enumerate().map(name).collect()
    }

    /// `Init.X` is the step, even if a global variable has this name.
    fn hide(&mut self, steps: &[Name]) {
        for name in steps {
            let key = name.text.to_lowercase();
            self.body.scope.located.remove(&key);
            self.body.scope.hidden.insert(key);
        }
    }

    /// Actions and transitions of the POU that the chart refers to by name.
    fn read_named(&mut self, pou: Node<'a, 'a>) {
        let list = |name: &str| child(pou, name).into_iter().flat_map(elements).collect::<Vec<_>>();
        for node in list("transitions") {
            let (Some(name), Some(body)) = (node.attribute("name"), child(node, "body")) else { continue };
            let condition = self.condition_body(body, Some(name), self.reader.place(node, "name"));
            self.transitions.insert(name.trim().to_lowercase(), condition);
        }
        for node in list("actions") {
            let (Some(name), Some(body)) = (node.attribute("name"), child(node, "body")) else { continue };
            let code = self.code(body);
            self.actions.insert(name.trim().to_lowercase(), code);
        }
    }

    /// Steps without their actions. The initial step is number 1.
    fn steps(&self, nodes: &[Node<'a, 'a>], names: &[Name]) -> Vec<Step> {
        let is_initial = |node: &Node| matches!(node.attribute("initialStep").map(str::trim), Some("true" | "1"));
        let first = nodes.iter().position(is_initial);
        let number = |at: usize| match first {
            Some(first) if at == first => 1,
            Some(first) if at < first => at as u32 + 2,
            Some(_) | None => at as u32 + 1,
        };
        let step = |(at, node): (usize, &Node)| Step {
            name: names[at].clone(),
            number: number(at),
            initial: is_initial(node),
            actions: Vec::new(),
            interlock: None,
            supervision: None,
            maximum: None,
            warning: None,
            comment: comment(*node),
            span: names[at].span,
        };
        nodes.iter().enumerate().map(step).collect()
    }

    fn transitions(&mut self, plan: &Plan<'a>, steps: &[Name], connections: Vec<Connection>) -> Vec<Transition> {
        let mut networks = self.objects.iter().enumerate().filter(|(_, object)| object.kind == Kind::Condition);
        let networks: Vec<Option<usize>> = plan
            .transitions
            .iter()
            .map(|node| connected_condition(*node).and_then(|_| networks.next()).map(|(at, _)| at))
            .collect();
        let mut taken: HashSet<String> = steps.iter().map(|name| name.text.to_lowercase()).collect();
        let mut transitions = Vec::new();
        for (at, (node, connection)) in plan.transitions.iter().zip(connections).enumerate() {
            let span = plan.drawing.transitions[at];
            let named = |places: Vec<usize>| places.into_iter().filter_map(|at| steps.get(at).cloned()).collect();
            let mut text = format!("Trans{}", at + 1);
            while taken.contains(&text.to_lowercase()) || self.body.scope.locals.contains(&text.to_lowercase()) {
                text.push('_');
            }
            taken.insert(text.to_lowercase());
            transitions.push(Transition {
                name: Name { text, form: NameForm::Bare, span },
                number: at as u32 + 1,
                from: named(connection.from),
                to: named(connection.to),
                jump: connection.jump,
                path: connection.path,
                condition: self.condition(*node, networks[at], span),
                missing: false,
                comment: comment(*node),
                span,
            });
        }
        transitions
    }

    /// Statements or networks of an action; none if they cannot be read, which is reported.
    fn code(&mut self, holder: Node<'a, 'a>) -> Option<Vec<ActionBody>> {
        let Some(content) = content(holder) else { return Some(Vec::new()) };
        let rows = match content.tag_name().name() {
            "ST" => {
                let range = self.reader.text_range(elements(content).next().unwrap_or(content));
                let Some(range) = range else { return Some(Vec::new()) };
                let statements = self.reader.statements(range, self.body);
                self.stays(&statements)?;
                vec![ActionBody::Statements(statements)]
            }
            "IL" => {
                let statements = crate::plcopen::il::read(self.reader, self.body, content);
                self.stays(&statements)?;
                vec![ActionBody::Statements(statements)]
            }
            "LD" => self.networks(content, Language::Lad)?,
            "FBD" => self.networks(content, Language::Fbd)?,
            _ => return self.refused(content),
        };
        Some(rows)
    }

    fn networks(&mut self, content: Node<'a, 'a>, language: Language) -> Option<Vec<ActionBody>> {
        if self.leaves(content) {
            return None;
        }
        let networks = self.reader.networks(content, language, self.body);
        Some(networks.into_iter().map(ActionBody::Network).collect())
    }

    /// Whether a network has a jump or a return, which is reported.
    fn leaves(&mut self, content: Node<'a, 'a>) -> bool {
        let Some(node) = elements(content).find(|node| matches!(node.tag_name().name(), "jump" | "return")) else {
            return false;
        };
        let span = self.reader.place(node, "label");
        self.leaving(span);
        true
    }

    /// Reports statements that would leave the whole chart.
    fn stays(&mut self, statements: &[Statement]) -> Option<()> {
        match leaving(statements) {
            Some(span) => {
                self.leaving(span);
                None
            }
            None => Some(()),
        }
    }

    fn leaving(&mut self, span: Span) {
        let text = "plcc does not read jumps and returns in actions and transitions";
        self.report(
            Code::ForeignContent,
            span,
            text,
            "would leave the whole chart",
            "use IF, or an N contact before the rest",
        );
    }

    fn refused<T>(&mut self, content: Node<'a, 'a>) -> Option<T> {
        let span = self.reader.place(content, "name");
        let text = format!("plcc does not read actions and transitions in {}", content.tag_name().name());
        self.report(Code::ForeignContent, span, text, "", "write it in ST, LD or FBD");
        None
    }

    /// Networks that no transition reads. IEC 61131-3 has networks in a chart for transitions only.
    fn idle_networks(&mut self) {
        let mut read: HashSet<usize> = HashSet::new();
        for (at, object) in self.objects.iter().enumerate() {
            if object.kind == Kind::Condition {
                read.extend(super::order::feeding(&self.objects, at));
            }
        }
        let writes = |kind| matches!(kind, Kind::Coil | Kind::Block | Kind::OutVariable | Kind::Jump | Kind::Return);
        let idle: Vec<Span> = self
            .objects
            .iter()
            .enumerate()
            .filter(|(at, object)| writes(object.kind) && !read.contains(at))
            .map(|(_, object)| object.span)
            .collect();
        for span in idle {
            let text = "a network in the chart that no transition reads";
            let help = "connect it to a transition, or make it an action of a step";
            self.report(Code::ForeignContent, span, text, "is not executed", help);
        }
    }
}

/// The body proper of a `body` or `inline` element.
fn content<'a, 'i>(holder: Node<'a, 'i>) -> Option<Node<'a, 'i>> {
    elements(holder).find(|node| !matches!(node.tag_name().name(), "documentation" | "addData"))
}

fn comment(node: Node) -> Vec<String> {
    child(node, "documentation").map(plain_text).filter(|text| !text.is_empty()).into_iter().collect()
}

/// A statement that leaves its list.
pub fn leaving(statements: &[Statement]) -> Option<Span> {
    statements.iter().find_map(|statement| match &statement.kind {
        StatementKind::Return(_) | StatementKind::Goto(_) | StatementKind::Label(_) => Some(statement.span),
        StatementKind::If { branches, otherwise } => {
            branches.iter().find_map(|(_, body)| leaving(body)).or_else(|| leaving(otherwise))
        }
        StatementKind::Case { arms, otherwise, .. } => {
            arms.iter().find_map(|arm| leaving(&arm.body)).or_else(|| leaving(otherwise))
        }
        StatementKind::For { body, .. } | StatementKind::While { body, .. } | StatementKind::Repeat { body, .. } => {
            leaving(body)
        }
        StatementKind::Expression(_)
        | StatementKind::Assign { .. }
        | StatementKind::Empty
        | StatementKind::Exit
        | StatementKind::Continue
        | StatementKind::Pragma(_)
        | StatementKind::Error => None,
    })
}
