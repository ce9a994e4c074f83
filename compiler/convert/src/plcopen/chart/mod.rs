//! Charts of GRAPH as SFC.
//!
//! - `plan`: branches, and where everything is; `drawing`: the objects and lines of the file.
//!
//! | GRAPH | SFC |
//! | --- | --- |
//! | N with a variable | N |
//! | N with an assignment or call | N with ST, which does nothing in the last call that SFC makes for it |
//! | S, R, D, L | S, R, D, L |
//! | S1, S0 with N | P1, P0; with S and R a statement |
//! | conditions | ST |
//! | X, T and U of a step | X and T: without interlocks and supervision U is T |
//!
//! SFC has no operating modes: the parameters for them are left out, with a warning, and a program that uses one is refused. It has no
//! interlocks, supervision and other events either.
//!
//! Source: GRAPH reference, chapter C.

mod drawing;
mod plan;

use std::collections::{HashMap, HashSet};

use plcc_diag::Span;
use plcc_syntax::ast::{Code, CodeBlock, PathRoot, SectionKind, ValueAssignment};
use plcc_syntax::chart::ast::{
    Action, ActionBody, Body as Chart, Call, Condition, Dialect, Event, Permanent, PermanentKind, Qualifier, Step,
    Transition,
};
use plcc_syntax::chart::parameters;
use plcc_syntax::network::ast::{Content, Network};
use plcc_syntax::scl::ast::{
    Argument, AssignOp, BinaryOp, Expr, ExprKind, Literal, Name, NameForm, Statement, StatementKind,
};
use plcc_syntax::{Class, Elementary};

use super::body::Body;
use super::documentation;
use super::identifier::identifier;
use super::objects::text_width;
use super::program::{Global, is_function, local};
use crate::frames::bare;
use crate::gr7::logic;
use crate::node::Node;
use drawing::{StepParts, TransitionParts};

/// Rows of a step among which the last execution of an action is looked for.
const ROWS_MAX: usize = 200;

/// The chart of a block.
pub fn of_block(block: &CodeBlock) -> Option<&Chart> {
    match &block.code {
        Code::Chart(chart) => Some(chart),
        Code::Stl(_) | Code::Scl(_) | Code::Graphic(_) => None,
    }
}

/// Whether a variable of a block is a parameter for the operating modes of GRAPH. A chart that was SFC has none.
pub fn is_operating(block: &CodeBlock, name: &str) -> bool {
    of_block(block).is_some_and(|chart| chart.dialect != Dialect::Sfc) && parameters::find(name).is_some()
}

/// The operating parameters that a block declares.
pub fn operating(block: &CodeBlock) -> Vec<&str> {
    let variables = block.sections.iter().flat_map(|section| &section.variables);
    variables.map(|variable| variable.name.as_str()).filter(|name| is_operating(block, name)).collect()
}

/// Whether other blocks can name this part of an instance in the file: step flags belong to the chart alone.
pub fn is_visible(block: &CodeBlock, name: &str) -> bool {
    match of_block(block) {
        Some(chart) if chart.dialect != Dialect::Sfc => local(block, name).is_some() && !is_operating(block, name),
        _ => true,
    }
}

/// The values of an instance that are those of its variables.
pub fn own_values(block: &CodeBlock, values: &[ValueAssignment]) -> Vec<ValueAssignment> {
    let is_own = |value: &&ValueAssignment| match &value.target.root {
        PathRoot::Local { name, .. } | PathRoot::Bare { name, .. } | PathRoot::Quoted { name, .. } => {
            is_visible(block, name)
        }
        PathRoot::Block(_) => true,
    };
    values.iter().filter(is_own).cloned().collect()
}

/// The steps and transitions that the code of a chart can name, in lower case.
#[derive(Default)]
pub struct Names {
    steps: HashMap<String, String>,
    numbers: HashMap<u32, String>,
    transitions: HashSet<String>,
}

impl Names {
    pub fn new(block: &CodeBlock) -> Names {
        let Some(chart) = of_block(block) else { return Names::default() };
        let mut names = Names::default();
        for step in &chart.steps {
            let name = identifier(&step.name.text);
            names.steps.entry(step.name.text.to_lowercase()).or_insert_with(|| name.clone());
            names.numbers.entry(step.number).or_insert(name);
        }
        names.transitions = chart.transitions.iter().map(|one| one.name.text.to_lowercase()).collect();
        names
    }

    /// The name of a step in the file; `S002` is that of the step with this number.
    fn step(&self, text: &str) -> Option<&str> {
        let numbered = || self.numbers.get(&text.strip_prefix(['S', 's'])?.parse::<u32>().ok()?);
        self.steps.get(&text.to_lowercase()).or_else(numbered).map(String::as_str)
    }

    /// The type of a flag of a step.
    pub fn flag_type(&self, step: &str, member: &str) -> Option<Elementary> {
        let ty = match member.to_ascii_uppercase().as_str() {
            "X" => Elementary::Bool,
            "T" | "U" => Elementary::Time,
            _ => return None,
        };
        self.step(step).map(|_| ty)
    }

    fn is_transition(&self, text: &str) -> bool {
        self.transitions.contains(&text.to_lowercase())
    }
}

/// The body of a chart.
pub fn write(body: &mut Body, chart: &Chart) -> Option<Node> {
    let span = body.block.name.span();
    if chart.broken {
        body.refuse(span, "a chart that was not understood", "repair the source first");
        return None;
    }
    if chart.settings.skip_steps == Some(true) {
        let title = "SFC does not skip steps whose transitions are satisfied when they are entered";
        body.refuse(span, title, "draw the ways past these steps, and set SSkipOn to F");
    }
    chart.before.iter().chain(&chart.after).for_each(|row| permanent(body, row));
    let plan = plan::plan(chart, body.writer)?;
    // In the order of the source, as its comments.
    let mut parts: Vec<(u32, bool, usize)> = Vec::new();
    parts.extend(chart.steps.iter().enumerate().map(|(at, step)| (step.span.start, true, at)));
    parts.extend(chart.transitions.iter().enumerate().map(|(at, one)| (one.span.start, false, at)));
    parts.sort_unstable();
    let mut steps: Vec<Option<StepParts>> = chart.steps.iter().map(|_| None).collect();
    let mut transitions: Vec<Option<TransitionParts>> = chart.transitions.iter().map(|_| None).collect();
    for (_, is_step, at) in parts {
        match is_step {
            true => steps[at] = Some(step(body, &chart.steps[at], chart.dialect)),
            false => transitions[at] = Some(transition(body, &chart.transitions[at], chart.dialect)),
        }
    }
    Some(drawing::body(&plan, steps.into_iter().flatten().collect(), transitions.into_iter().flatten().collect()))
}

fn permanent(body: &mut Body, row: &Permanent) {
    let what = match &row.kind {
        PermanentKind::Coil { .. } => "permanent instructions",
        PermanentKind::Call(_) => "permanent calls",
        PermanentKind::Network(network) if matches!(network.content, Content::Scl(_)) => {
            "code that runs in each call, as actions with S, SD, DS and SL and with statements need it here"
        }
        PermanentKind::Network(_) => "permanent instructions",
    };
    body.refuse(row.span, format!("SFC has no {what}"), "write it into the block that calls the chart");
}

/// The comments before a part of a chart, and its own.
fn comments(body: &mut Body, own: &[String], at: u32, dialect: Dialect) -> Vec<String> {
    // Those of XML belong to its statements.
    let mut lines = if dialect == Dialect::Sfc { Vec::new() } else { body.writer.lines_before(at) };
    lines.extend(own.iter().cloned());
    lines
}

fn documented(mut lines: Vec<String>) -> Option<Node> {
    lines.retain(|line| !line.trim().is_empty());
    (!lines.is_empty()).then(|| documentation(&lines.join("\n")))
}

fn step(body: &mut Body, step: &Step, dialect: Dialect) -> StepParts {
    let mut lines = comments(body, &step.comment, step.span.start, dialect);
    let name = &step.name.text;
    if step.supervision.is_some() {
        let title = format!("SFC has no supervision, such as that of step `{name}`");
        body.refuse(step.span, title, "let a transition lead to a step for the fault");
    }
    if step.interlock.is_some() {
        let span = step.actions.iter().find(|action| action.interlock).map_or(step.span, |action| action.span);
        let title = format!("SFC has no interlocks, such as that of step `{name}`");
        body.refuse(span, title, "write the condition into the action: `Valve := Fill.X AND Ready`");
    }
    let remarks = Vec::new();
    let mut rows = Rows { body, step, name: identifier(name), actions: Vec::new(), remarks, widest: 0, dialect };
    rows.all();
    let (actions, widest) = (rows.actions, rows.widest);
    lines.extend(rows.remarks);
    StepParts { name: identifier(name), initial: step.initial, actions, widest, comment: documented(lines) }
}

fn transition(body: &mut Body, transition: &Transition, dialect: Dialect) -> TransitionParts {
    let lines = comments(body, &transition.comment, transition.span.start, dialect);
    let whose = format!("transition `{}`", transition.name.text);
    if transition.missing {
        body.refuse(transition.span, format!("the drawing has a gap at {whose}"), "draw the transition first");
    }
    let text = match &transition.condition {
        None => "TRUE".to_string(),
        Some(Condition::Expression(value)) => body.text(value),
        Some(Condition::Network(network)) => {
            logic::condition(network, &whose, body.writer).map_or_else(String::new, |value| body.text(&value))
        }
        Some(Condition::Statements(list)) => statements(body, list, |list| list),
    };
    let inline = Node::new("inline").with("name", "").child(structured_text(text.trim_end()));
    let condition = Node::new("condition").child(inline);
    TransitionParts { condition, comment: documented(lines) }
}

fn structured_text(text: &str) -> Node {
    Node::new("ST").child(Node::of("xhtml:p", text))
}

/// Statements as text. `around`: what contains them in the file.
fn statements(body: &mut Body, list: &[Statement], around: impl FnOnce(Vec<Statement>) -> Vec<Statement>) -> String {
    let before = std::mem::take(&mut body.writer.out);
    let list = around(body.statements(list));
    body.writer.statements(&list);
    std::mem::replace(&mut body.writer.out, before).into_text()
}

/// The rows of a step.
struct Rows<'r, 'p, 'a, 'w, 't> {
    body: &'r mut Body<'p, 'a, 'w, 't>,
    step: &'r Step,
    name: String,
    actions: Vec<Node>,
    /// Comments between rows, which become part of the comment of the step.
    remarks: Vec<String>,
    widest: i32,
    dialect: Dialect,
}

impl Rows<'_, '_, '_, '_, '_> {
    fn refuse(&mut self, action: &Action, title: impl Into<String>, help: &str) {
        self.body.refuse(action.span, title, help);
    }

    fn all(&mut self) {
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
                let content = super::network::write(self.body, networks, network.language);
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

impl Body<'_, '_, '_, '_> {
    /// `Fill.X` of the chart itself; `None`: the name before the point is not a step.
    pub(super) fn step_flag(&mut self, base: &Expr, member: &Name) -> Option<Expr> {
        let ExprKind::Name(name) = &base.kind else { return None };
        let is_other = local(self.block, &name.text).is_some()
            || name.form == NameForm::Quoted && self.program.global(&self.program.key_of(&name.text)).is_some();
        if is_other {
            return None;
        }
        let span = member.span;
        let Some(step) = self.names.step(&name.text).map(str::to_string) else {
            if self.names.is_transition(&name.text) {
                let title = format!("SFC has no `{}` of a transition", member.text);
                self.refuse(span, title, "write the condition of the transition");
                let name = Name { text: String::new(), form: NameForm::Bare, span };
                return Some(Expr { kind: ExprKind::Name(name), span });
            }
            return None;
        };
        let flag = match member.text.to_ascii_uppercase().as_str() {
            "X" => "X",
            // Without interlocks and supervision no part of the time is a disturbed one.
            "T" | "U" => "T",
            _ => {
                let title = format!("SFC has no `{}` of a step, only X and T", member.text);
                let help = "use X, which is TRUE while the step is active, or T, the time since it began";
                self.refuse(span, title, help);
                "X"
            }
        };
        let name = Name { text: step, form: NameForm::Bare, span: base.span };
        let base = Box::new(Expr { kind: ExprKind::Name(name), span: base.span });
        let name = Name { text: flag.to_string(), form: NameForm::Bare, span };
        Some(Expr { kind: ExprKind::Member { base, name }, span })
    }

    /// Reports a part of a chart that other blocks cannot name in the file.
    pub(super) fn check_chart(&mut self, base: &Expr, member: &Name) {
        let key = self.program.type_of(base, self.block).and_then(|ty| self.program.type_key(ty));
        let Some(Global::Code(block)) = key.and_then(|key| self.program.global(&key)) else { return };
        if !is_visible(block, &member.text) {
            let title = format!("`{}` of a chart cannot be read or written from outside in SFC", member.text);
            let help = "write it to an output of the chart in an action, or read an input in a condition";
            self.refuse(member.span, title, help);
        }
    }

    /// Reports an operating parameter that the code of a chart uses.
    pub(super) fn check_operating(&mut self, name: &Name) {
        if is_operating(self.block, &name.text) && local(self.block, &name.text).is_some() {
            self.refuse_operating(name);
        }
    }

    pub(super) fn refuse_operating(&mut self, name: &Name) {
        let title = format!("`{}` belongs to the operating modes of GRAPH, which SFC does not have", name.text);
        self.refuse(name.span, title, "draw what it does as steps and transitions, or leave it out");
    }

    /// Whether the file has no such argument of a call: an operating parameter, which is reported if it does something.
    pub(super) fn is_left_out(&mut self, block: &CodeBlock, argument: &Argument) -> bool {
        let Some(name) = argument.name.as_ref().filter(|name| is_operating(block, &name.text)) else { return false };
        let is_off = |value: &Expr| {
            matches!(value.kind, ExprKind::Literal(Literal::Typed { ty: Elementary::Bool, bits: 0 }))
                || matches!(value.kind, ExprKind::Literal(Literal::Integer { value: 0, .. }))
        };
        if argument.value.as_ref().is_some_and(|value| !is_off(value)) {
            self.refuse_operating(name);
        }
        true
    }
}
