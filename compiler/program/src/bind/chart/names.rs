//! Steps and transitions in expressions: `S002.X`, `T002.TT` and names become components of the instance. Source: GRAPH reference A.1, F.3.

use plcc_diag::{Code, Diagnostic};
use plcc_syntax::ast::{CodeBlock, OperandKind};
use plcc_syntax::chart::ast::{ActionBody, Body as Chart, Call, Condition, PermanentKind};
use plcc_syntax::network::ast::{Content, Graph, Network, PinValue, Source, Target};
use plcc_syntax::scl::ast::{Expr, ExprKind, Literal, Name, NameForm, Statement, StatementKind};
use rustc_hash::FxHashSet;

use super::index::Index;
use crate::bind::chart::ChartBinder;
use crate::bind::declarations::Declarations;
use crate::bind::trees::SYSTEM_FILE;
use crate::bind::trees::chart_data::Members;
use plcc_binding::fold;

/// Components of transitions; all others are those of steps.
const OF_TRANSITIONS: [&str; 8] = ["TV", "TT", "TS", "CF_IV", "TNO", "CRIT", "CRIT_OLD", "CRIT_FLT"];
/// Components of steps.
const OF_STEPS: [&str; 26] = [
    "S1",
    "L1",
    "V1",
    "R1",
    "A1",
    "S0",
    "L0",
    "V0",
    "X",
    "LA",
    "VA",
    "RA",
    "AA",
    "SS",
    "LS",
    "VS",
    "SNO",
    "T",
    "U",
    "T_MAX",
    "T_WARN",
    "CRIT_LOC",
    "CRIT_LOC_ERR",
    "CRIT_SUP",
    "SM",
    "LP",
];

/// Resolves names of a chart.
struct Names<'n, 'b> {
    index: &'n Index,
    members: &'n Members,
    /// Names that the block declares.
    declared: FxHashSet<String>,
    program: &'n mut Declarations<'b>,
}

impl ChartBinder<'_, '_> {
    /// The chart with names of steps and transitions resolved.
    pub fn resolved_chart(&mut self, block: &CodeBlock, chart: &Chart, index: &Index, members: &Members) -> Chart {
        let variables = block.sections.iter().flat_map(|section| &section.variables);
        let users = variables.filter(|variable| variable.name_span.file != SYSTEM_FILE);
        let declared = users.map(|variable| fold(&variable.name)).collect();
        let mut names = Names { index, members, declared, program: self.program };
        let mut chart = chart.clone();
        names.chart(&mut chart);
        chart
    }
}

impl Names<'_, '_> {
    fn chart(&mut self, chart: &mut Chart) {
        for permanent in chart.before.iter_mut().chain(&mut chart.after) {
            match &mut permanent.kind {
                PermanentKind::Coil { operand, value, .. } => {
                    self.expression(operand);
                    self.expression(value);
                }
                PermanentKind::Call(call) => self.call(call),
                PermanentKind::Network(network) => self.network(network),
            }
        }
        for step in &mut chart.steps {
            for action in &mut step.actions {
                match &mut action.body {
                    ActionBody::Operand(operand) => self.expression(operand),
                    ActionBody::Value { operand, value } => {
                        self.expression(operand);
                        self.expression(value);
                    }
                    ActionBody::Call(call) => self.call(call),
                    ActionBody::Statements(list) => self.statements(list),
                    ActionBody::Network(network) => self.network(network),
                    ActionBody::All { .. } | ActionBody::Error => {}
                }
            }
            step.interlock.iter_mut().chain(&mut step.supervision).for_each(|condition| self.condition(condition));
        }
        for condition in chart.transitions.iter_mut().filter_map(|one| one.condition.as_mut()) {
            self.condition(condition);
        }
    }

    fn condition(&mut self, condition: &mut Condition) {
        match condition {
            Condition::Expression(value) => self.expression(value),
            Condition::Network(network) => self.network(network),
            Condition::Statements(list) => self.statements(list),
        }
    }

    fn call(&mut self, call: &mut Call) {
        call.parameters.iter_mut().filter_map(|one| one.value.as_mut()).for_each(|value| self.expression(value));
    }

    fn network(&mut self, network: &mut Network) {
        match &mut network.content {
            Content::Graphic(graph) => self.graph(graph),
            Content::Scl(list) => self.statements(list),
            Content::Stl(_) => {}
        }
    }

    fn graph(&mut self, graph: &mut Graph) {
        for source in graph.nets.iter_mut().flat_map(|net| &mut net.sources) {
            if let Source::Operand { value, .. } = source {
                self.expression(value);
            }
        }
        for element in &mut graph.elements {
            if let Target::Element { instance: Some(instance), .. } = &mut element.target {
                self.expression(instance);
            }
            element.equation.iter_mut().for_each(|value| self.expression(value));
            for pin in &mut element.pins {
                if let PinValue::Operand(value) = &mut pin.value {
                    self.expression(value);
                }
            }
        }
    }

    fn statements(&mut self, list: &mut [Statement]) {
        for statement in list {
            match &mut statement.kind {
                StatementKind::Expression(value) => self.expression(value),
                StatementKind::Assign { targets, value } => {
                    targets.iter_mut().for_each(|(target, _)| self.expression(target));
                    self.expression(value);
                }
                StatementKind::If { branches, otherwise } => {
                    for (condition, body) in branches {
                        self.expression(condition);
                        self.statements(body);
                    }
                    self.statements(otherwise);
                }
                StatementKind::Case { selector, arms, otherwise } => {
                    self.expression(selector);
                    arms.iter_mut().for_each(|arm| self.statements(&mut arm.body));
                    self.statements(otherwise);
                }
                StatementKind::For { variable, start, end, step, body } => {
                    [variable, start, end].into_iter().chain(step).for_each(|value| self.expression(value));
                    self.statements(body);
                }
                StatementKind::While { condition, body } => {
                    self.expression(condition);
                    self.statements(body);
                }
                StatementKind::Repeat { body, until } => {
                    self.statements(body);
                    self.expression(until);
                }
                StatementKind::Return(value) => value.iter_mut().for_each(|value| self.expression(value)),
                StatementKind::Empty
                | StatementKind::Label(_)
                | StatementKind::Exit
                | StatementKind::Continue
                | StatementKind::Goto(_)
                | StatementKind::Pragma(_)
                | StatementKind::Error => {}
            }
        }
    }

    fn expression(&mut self, value: &mut Expr) {
        match &mut value.kind {
            ExprKind::Member { base, name } => {
                if let ExprKind::Name(owner) = &base.kind {
                    if let Some(data) = self.data(owner, name) {
                        **base = data;
                    }
                } else {
                    self.expression(base);
                }
            }
            ExprKind::MemberAbsolute { base, .. } | ExprKind::Slice { base, .. } => self.expression(base),
            ExprKind::Index { base, indices } => {
                self.expression(base);
                indices.iter_mut().for_each(|index| self.expression(index));
            }
            ExprKind::Call { arguments, .. } => {
                arguments.iter_mut().filter_map(|one| one.value.as_mut()).for_each(|value| self.expression(value));
            }
            ExprKind::Dereference(operand) | ExprKind::Reference(operand) | ExprKind::Unary { operand, .. } => {
                self.expression(operand);
            }
            ExprKind::Binary { left, right, .. } => {
                self.expression(left);
                self.expression(right);
            }
            ExprKind::Name(name) => {
                if let Some(operand) = self.address(name) {
                    value.kind = ExprKind::Absolute(operand);
                }
            }
            ExprKind::Literal(_) | ExprKind::Absolute(_) | ExprKind::Error => {}
        }
    }

    /// T5 without a component is the timer, even if a transition has that name.
    fn address(&self, name: &Name) -> Option<OperandKind> {
        let own = name.form == NameForm::Bare && !self.declared.contains(&fold(&name.text));
        let operand = own.then(|| plcc_syntax::scl::absolute(&name.text)).flatten()?;
        matches!(operand, OperandKind::Cell { .. }).then_some(operand)
    }

    /// Data of the step or transition before a point; none if it is something else.
    fn data(&mut self, owner: &Name, component: &Name) -> Option<Expr> {
        let text = &owner.text;
        let global = owner.form == NameForm::Quoted && self.program.globals.names.symbols.contains_key(&fold(text));
        if global || self.declared.contains(&fold(text)) {
            return None;
        }
        let is = |list: &[&str]| list.iter().any(|known| known.eq_ignore_ascii_case(&component.text));
        let transition = is(&OF_TRANSITIONS).then(|| self.index.transition_reference(text)).flatten();
        if let Some(at) = transition {
            return Some(self.place("G7T", &self.members.transitions[at], at, owner));
        }
        if let Some(at) = self.index.step_reference(text) {
            return Some(self.place("G7S", &self.members.steps[at], at, owner));
        }
        let looks_so = owner.form == NameForm::Bare
            && (is_numbered(text, 'S') && is(&OF_STEPS) || is_numbered(text, 'T') && is(&OF_TRANSITIONS));
        if looks_so && !self.program.globals.names.symbols.contains_key(&fold(text)) {
            let what = if is_numbered(text, 'S') { "step" } else { "transition" };
            self.program.report(
                Diagnostic::new(Code::UnknownStep, owner.span, format!("the chart has no {what} `{text}`"))
                    .label(format!("no {what} of this name or number"))
                    .help("name a step or transition of this block, with its name or number"),
            );
            return Some(Expr { kind: ExprKind::Error, span: owner.span });
        }
        None
    }

    fn place(&self, array: &str, member: &str, at: usize, owner: &Name) -> Expr {
        let span = owner.span;
        let local = |text: &str| Expr {
            kind: ExprKind::Name(Name { text: text.to_string(), form: NameForm::Local, span }),
            span,
        };
        if !self.members.arrays {
            return local(member);
        }
        let index = ExprKind::Literal(Literal::Integer { value: at as u64 + 1, based: false });
        let kind = ExprKind::Index { base: Box::new(local(array)), indices: vec![Expr { kind: index, span }] };
        Expr { kind, span }
    }
}

/// A letter and digits.
fn is_numbered(text: &str, letter: char) -> bool {
    let digits = text.strip_prefix([letter, letter.to_ascii_lowercase()]);
    digits.is_some_and(|digits| !digits.is_empty() && digits.bytes().all(|digit| digit.is_ascii_digit()))
}
