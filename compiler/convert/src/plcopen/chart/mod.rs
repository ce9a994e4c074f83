//! Charts of GRAPH as SFC.
//!
//! - `plan`: branches, and where everything is; `drawing`: the objects and lines of the file; `rows`: actions.
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
mod rows;

use std::collections::{HashMap, HashSet};

use plcc_syntax::Elementary;
use plcc_syntax::ast::{Code, CodeBlock, PathRoot, ValueAssignment};
use plcc_syntax::chart::ast::{Body as Chart, Condition, Dialect, Permanent, PermanentKind, Step, Transition};
use plcc_syntax::chart::parameters;
use plcc_syntax::network::ast::Content;
use plcc_syntax::scl::ast::{Argument, Expr, ExprKind, Literal, Name, NameForm, Statement};

use super::body::Body;
use super::documentation;
use super::identifier::identifier;
use super::program::{Global, local};
use crate::gr7::logic;
use crate::node::Node;
use drawing::{StepParts, TransitionParts};
use rows::Rows;

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
