//! Rows of actions. Source: GRAPH reference D.6 to D.8.
//!
//! - `legality`: events and interlocks that rows can have.
//! - `operand`: operands of N, S, R, D and L.
//! - `cell`: counters and timers.
//! - `arithmetic`: assignments.

mod arithmetic;
mod cell;
mod legality;
mod operand;

#[cfg(test)]
mod tests;

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::Elementary;
use plcc_syntax::chart::ast::{Action, ActionBody, Event, Qualifier};
use plcc_syntax::scl::ast::{Expr as Node, ExprKind as NodeKind};

use super::engine_data::Engine;
use crate::bind::chart::ChartBinder;
use crate::bind::network::{Page, and, inverted, no, yes};
use crate::bind::scl::place::Spot;
use crate::bind::scl::{Intent, SclBlock};
use plcc_binding::similar;
use plcc_model::scl::{CompareOp, Expr, ExprKind, Statement, StatementKind};

/// The code of a step, in order of its rows.
#[derive(Default)]
pub struct StepCode {
    /// In each call while it is active.
    pub active: Vec<Statement>,
    /// In the call that leaves it: rows of S0, then operands of N, D and L become 0.
    pub leave: Vec<Statement>,
    /// At the start of the call after an event: anything set for one call becomes 0.
    pub expire: Vec<Statement>,
}

/// When a row takes effect.
#[derive(Clone, Default)]
struct Moment {
    /// Event and interlock, a BOOL; none: in every call in which the row is run.
    condition: Option<Expr>,
    /// For rows with an event: the event and the interlock, kept until the next call checks them; a BOOL.
    pulse: Option<Expr>,
    /// Operands must be 0, and blocks are not called; a BOOL.
    zeroed: Option<Expr>,
    /// The row is of S0: it runs in the call that leaves the step.
    leaving: bool,
}

impl Moment {
    /// Whether the row takes effect: TRUE if it always does.
    fn value(&self, span: Span) -> Expr {
        self.condition.clone().unwrap_or_else(|| yes(span))
    }

    /// As `value`, but FALSE while operands must be 0.
    fn value_unless_zeroed(&self, span: Span) -> Expr {
        self.unless_zeroed(self.value(span), span)
    }

    fn unless_zeroed(&self, value: Expr, span: Span) -> Expr {
        match &self.zeroed {
            Some(zeroed) => and(value, inverted(zeroed.clone()), span),
            None => value,
        }
    }
}

/// Rows of a step so far.
#[derive(Default)]
struct Rows {
    active: Vec<Statement>,
    /// Rows of S0.
    leaving: Vec<Statement>,
    /// Statements of timers and counters after the rows of S0.
    left: Vec<Statement>,
    /// Operands that become 0 after the step.
    zero: Vec<(Spot, Span)>,
    /// Operands that become 0 in the call after an event.
    expire: Vec<Statement>,
}

impl Rows {
    /// Adds the statements of a row.
    fn add(&mut self, moment: &Moment, statements: Vec<Statement>) {
        let list = if moment.leaving { &mut self.leaving } else { &mut self.active };
        list.extend(statements);
    }

    fn finish(self) -> StepCode {
        let zero = once(self.zero.iter());
        StepCode { active: self.active, leave: [self.leaving, self.left, zero].concat(), expire: self.expire }
    }
}

/// Writes 0 to operands, once to each.
fn once<'s>(spots: impl Iterator<Item = &'s (Spot, Span)>) -> Vec<Statement> {
    let mut seen: Vec<&Spot> = Vec::new();
    let mut statements = Vec::new();
    for (spot, span) in spots {
        if !seen.iter().any(|other| other.is_same(spot)) {
            seen.push(spot);
            statements.push(assign(spot, no(*span), *span));
        }
    }
    statements
}

fn assign(spot: &Spot, value: Expr, span: Span) -> Statement {
    Statement { kind: StatementKind::Assign { target: spot.clone().access(span), value }, span }
}

/// Statements that run if a condition is TRUE.
fn guarded(condition: Expr, body: Vec<Statement>, span: Span) -> Vec<Statement> {
    if body.is_empty() || matches!(condition.kind, ExprKind::Const(1)) {
        return body;
    }
    let kind = StatementKind::If { branches: vec![(condition, body)], otherwise: Vec::new() };
    vec![Statement { kind, span }]
}

impl ChartBinder<'_, '_> {
    /// Binds the actions of a step.
    pub fn step_code(&mut self, ctx: &mut SclBlock, engine: &mut Engine, step: usize) -> StepCode {
        let chart = engine.chart;
        let has_interlock = chart.steps[step].interlock.is_some();
        let mut rows = Rows::default();
        for action in &chart.steps[step].actions {
            // Of ON and OFF without a step, only that is reported.
            if !is_request_of_nothing(engine, action) {
                for message in legality::messages(action, has_interlock) {
                    self.program.report(message);
                }
            }
            let moment = moment(engine, step, action);
            match (action.qualifier, &action.body) {
                (Qualifier::On | Qualifier::Off, ActionBody::Operand(node)) => {
                    let on = action.qualifier == Qualifier::On;
                    if let Some(target) = self.requested_step(engine, node, on) {
                        let body = engine.request(target, on, action.span);
                        rows.add(&moment, guarded(moment.value(action.span), body, action.span));
                    }
                }
                (Qualifier::Off, ActionBody::All { .. }) => {
                    let except = (action.event == Some(Event::S1)).then_some(step);
                    let body = engine.request_all_off(except, action.span);
                    rows.add(&moment, guarded(moment.value(action.span), body, action.span));
                }
                (Qualifier::D | Qualifier::L, ActionBody::Value { operand, value }) => {
                    let elapsed = engine.elapsed(step, action.span);
                    let late = action.qualifier == Qualifier::D;
                    self.timed_row(ctx, &mut rows, &moment, operand, value, (elapsed, late), action.span);
                }
                _ => self.row(ctx, &mut engine.page, &mut rows, &moment, action),
            }
        }
        rows.finish()
    }

    /// A row that needs only the moment from the chart.
    fn row(&mut self, ctx: &mut SclBlock, page: &mut Page, rows: &mut Rows, moment: &Moment, action: &Action) {
        let span = action.span;
        let statements = match (action.qualifier, &action.body) {
            (_, ActionBody::Error | ActionBody::Operand(Node { kind: NodeKind::Error, .. })) => return,
            (Qualifier::N, ActionBody::Operand(node)) => return self.active_row(ctx, rows, moment, node, span),
            (Qualifier::S | Qualifier::R, ActionBody::Operand(node)) => {
                let set = action.qualifier == Qualifier::S;
                let body = self.bit_operand(ctx, node).map(|spot| {
                    let value = if set { yes(span) } else { no(span) };
                    assign(&spot, value, span)
                });
                guarded(moment.value(span), body.into_iter().collect(), span)
            }
            (Qualifier::N, ActionBody::Value { operand, value }) => {
                let told = self.program.globals.report.diagnostics.len();
                let body = self.action_assignment(ctx, page, operand, value, span);
                self.time_assigned(ctx, told, operand, value);
                guarded(moment.value(span), body, span)
            }
            (Qualifier::N, ActionBody::Call(call)) => {
                let body = self.chart_call(ctx, call);
                guarded(moment.value_unless_zeroed(span), body, span)
            }
            (Qualifier::N, ActionBody::Statements(list)) => {
                self.scl().collect_labels(ctx, list);
                let body = self.scl().statements(ctx, list);
                self.check_leaving(&body);
                guarded(moment.value_unless_zeroed(span), body, span)
            }
            (Qualifier::N, ActionBody::Network(network)) => {
                let body = self.networks().bind_lone_network(ctx, page, network);
                self.check_leaving(&body);
                guarded(moment.value_unless_zeroed(span), body, span)
            }
            (Qualifier::Cs, ActionBody::Value { operand, value }) => {
                self.counter_row(ctx, moment, action.qualifier, operand, Some(value), span)
            }
            (Qualifier::Cu | Qualifier::Cd | Qualifier::Cr, ActionBody::Operand(node)) => {
                self.counter_row(ctx, moment, action.qualifier, node, None, span)
            }
            (Qualifier::Tl | Qualifier::Td, ActionBody::Value { operand, value }) => {
                self.timer_row(ctx, moment, action.qualifier, operand, Some(value), span)
            }
            (Qualifier::Tr, ActionBody::Operand(node)) => {
                self.timer_row(ctx, moment, action.qualifier, node, None, span)
            }
            (Qualifier::Tf, ActionBody::Value { operand, value }) => {
                return self.off_delay_row(ctx, rows, moment, operand, value, span);
            }
            (qualifier, body) => {
                let (operand, delay) = match body {
                    ActionBody::Operand(node) => (self.program.globals.text(node.span), None),
                    ActionBody::Value { operand, value } => (String::new(), self.delay(operand, value)),
                    _ => (String::new(), None),
                };
                self.program.report(wrong_body(qualifier, body, &operand, delay, span));
                return;
            }
        };
        rows.add(moment, statements);
    }

    /// Completes the messages since `told` about `Q4.0 := T#5S  (N)`.
    fn time_assigned(&mut self, ctx: &mut SclBlock, told: usize, operand: &Node, value: &Node) {
        let messages = &self.program.globals.report.diagnostics;
        let about_value = |at: &usize| messages[*at].primary.span == value.span;
        let Some(at) = (told..messages.len()).find(about_value) else { return };
        let Some(help) = self.delay(operand, value) else { return };
        let access = self.scl().access(ctx, operand, Intent::Write);
        if access.is_some_and(|access| access.elementary() == Some(Elementary::Bool)) {
            self.program.globals.report.diagnostics[at].help = Some(help);
        }
    }

    /// What the assignment of a constant time is meant as.
    fn delay(&self, operand: &Node, value: &Node) -> Option<String> {
        let (operand, time) = (self.program.globals.text(operand.span), self.program.globals.text(value.span));
        let (first, _) = time.split_once('#')?;
        let is_time = ["T", "TIME", "S5T", "S5TIME"].iter().any(|word| word.eq_ignore_ascii_case(first));
        is_time.then(|| {
            format!(
                "a time belongs to D or L: write `{operand} := {time}  (D)` to set it after the time, `(L)` up to it"
            )
        })
    }

    /// N: the operand is 1 while the step is active, or in the call of the event.
    fn active_row(&mut self, ctx: &mut SclBlock, rows: &mut Rows, moment: &Moment, node: &Node, span: Span) {
        let Some(spot) = self.bit_operand(ctx, node) else { return };
        let value = moment.value_unless_zeroed(span);
        match &moment.pulse {
            Some(pulse) => {
                rows.add(moment, guarded(value, vec![assign(&spot, yes(span), span)], span));
                rows.expire.extend(guarded(pulse.clone(), vec![assign(&spot, no(span), span)], span));
            }
            None => {
                rows.add(moment, vec![assign(&spot, value, span)]);
                rows.zero.push((spot, span));
            }
        }
    }

    /// D and L: the operand is 1 after the time, or up to it. `late`: after it.
    #[allow(clippy::too_many_arguments, reason = "the parts of one row")]
    fn timed_row(
        &mut self,
        ctx: &mut SclBlock,
        rows: &mut Rows,
        moment: &Moment,
        operand: &Node,
        time: &Node,
        (elapsed, late): (Expr, bool),
        span: Span,
    ) {
        let time = self.action_time(ctx, time);
        let spot = self.bit_operand(ctx, operand);
        let (Some(time), Some(spot)) = (time, spot) else { return };
        let op = if late { CompareOp::GreaterEqual } else { CompareOp::Less };
        let kind = ExprKind::Compare { op, left: Box::new(elapsed), right: Box::new(time) };
        let reached = Expr { kind, ty: Elementary::Bool, span };
        let value = match &moment.condition {
            Some(condition) => and(reached, condition.clone(), span),
            None => reached,
        };
        rows.add(moment, vec![assign(&spot, moment.unless_zeroed(value, span), span)]);
        rows.zero.push((spot, span));
    }

    /// The step of ON and OFF.
    fn requested_step(&mut self, engine: &Engine, node: &Node, on: bool) -> Option<usize> {
        let text = self.program.globals.text(node.span);
        let operand = format!("; for the operand write `{text}  ({})`", if on { "S" } else { "R" });
        let name = match &node.kind {
            NodeKind::Name(name) => name,
            NodeKind::Error => return None,
            _ => {
                let help = format!("name one, or write its number: `S002`{operand}");
                let title = format!("`{text}` is not a step");
                self.scl().refuse(Code::ActionOperand, node.span, &title, "ON and OFF need a step", &help);
                return None;
            }
        };
        let found = engine.index.step_reference(&name.text);
        if found.is_none() {
            let title = format!("the chart has no step `{}`", name.text);
            let message = Diagnostic::new(Code::UnknownStep, name.span, title).label("no such step");
            let names = engine.chart.steps.iter().map(|step| step.name.text.as_str());
            self.program.report(match similar(&name.text, names) {
                Some(other) => message.help(format!("is `{other}` meant?")),
                None => message.help(format!("name a step of this block, or write its number: `S002`{operand}")),
            });
        }
        found
    }
}

/// A row of ON or OFF whose operand is not a step of the chart.
fn is_request_of_nothing(engine: &Engine, action: &Action) -> bool {
    match (action.qualifier, &action.body) {
        (Qualifier::On | Qualifier::Off, ActionBody::Operand(node)) => match &node.kind {
            NodeKind::Name(name) => engine.index.step_reference(&name.text).is_none(),
            _ => true,
        },
        _ => false,
    }
}

/// When a row of a step takes effect.
fn moment(engine: &Engine, step: usize, action: &Action) -> Moment {
    let span = action.qualifier_span;
    let leaving = action.event == Some(Event::S0);
    let event = action.event.map(|event| engine.event(step, event, span));
    let interlock = match action.interlock && !leaving {
        true => engine.interlock(step, span),
        false => None,
    };
    let pulse = match (event, &interlock) {
        (Some(event), Some(interlock)) => Some(and(event, interlock.clone(), span)),
        (event, _) => event,
    };
    // Rows of S0 already run where the event occurs.
    let condition = pulse.clone().filter(|_| !leaving).or(interlock);
    Moment { condition, pulse, zeroed: engine.zeroed(span), leaving }
}

/// A row whose text does not fit its qualifier. `operand`: as written, of a row that has nothing else; `delay`: what a row with a time
/// is meant as.
fn wrong_body(qualifier: Qualifier, body: &ActionBody, operand: &str, delay: Option<String>, span: Span) -> Diagnostic {
    let name = qualifier.name();
    let alone = matches!(body, ActionBody::Operand(_));
    let (title, label, help) = match (qualifier, body) {
        (_, ActionBody::Call(_) | ActionBody::Statements(_) | ActionBody::Network(_)) => (
            format!("`{name}` cannot have code"),
            "calls and statements are actions of N",
            "write N; to run it once, use an event: S1 N".to_string(),
        ),
        (Qualifier::On, ActionBody::All { .. }) => {
            ("ON activates one step".to_string(), "all steps cannot be active", "name the step: `S002`".to_string())
        }
        (_, ActionBody::All { .. }) => (
            format!("`{name}` is not possible with all steps"),
            "S_ALL is only possible with OFF",
            "write OFF S_ALL with an event".to_string(),
        ),
        (Qualifier::D | Qualifier::L | Qualifier::Tl | Qualifier::Td | Qualifier::Tf, _) if alone => {
            let help = format!("write the time after the operand: `{operand} := T#…  ({name})`");
            (format!("`{name}` needs a time"), "only an operand", help)
        }
        (Qualifier::Cs, _) if alone => {
            let help = format!("write the value after the counter: `{operand} := C#…  (CS)`");
            ("`CS` needs a value".to_string(), "only a counter", help)
        }
        _ => (
            format!("`{name}` needs an operand and nothing else"),
            "there is a value after the operand",
            delay.unwrap_or_else(|| "an assignment is an action of N".to_string()),
        ),
    };
    Diagnostic::new(Code::ActionText, span, title).label(label).help(help)
}
