//! Conditions that are always the same, paths that never open, and conditions that read temporary data.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::chart::ast::{Body as Chart, Condition, Transition};
use plcc_syntax::scl::ast::{Expr, ExprKind, NameForm};
use rustc_hash::FxHashSet;

use super::logic::{Atoms, Formula};
use super::net::{Net, SET_MAX};
use super::{Facts, TRANSITIONS_MAX, step_title, transition_title};
use crate::bind::trees::mentions::{condition_expressions, permanent_expressions};
use plcc_binding::fold;

/// Transitions after one step whose conditions are compared. GRAPH allows 125.
const PATHS_MAX: usize = 125;

pub fn check(chart: &Chart, net: &Net, facts: &Facts, messages: &mut Vec<Diagnostic>) {
    let mut atoms = Atoms::default();
    let formulas: Vec<Formula> = chart
        .transitions
        .iter()
        .map(|transition| match &transition.condition {
            Some(condition) => Formula::of(condition, &mut atoms),
            None => Formula::satisfied(),
        })
        .collect();
    for (transition, formula) in chart.transitions.iter().zip(&formulas) {
        let Some(condition) = &transition.condition else { continue };
        match formula.constant() {
            Some(true) if !formula.plain => messages.push(constant(
                condition,
                transition.name.span,
                format!("the condition of {} is always TRUE", transition_title(transition)),
                "the step before it is left in the call after the one that enters it",
                "leave the condition empty if this is intended",
            )),
            Some(false) => messages.push(constant(
                condition,
                transition.name.span,
                format!("the condition of {} is always FALSE", transition_title(transition)),
                "never switches on its own",
                "write the condition for the chart to continue",
            )),
            Some(true) | None => {}
        }
    }
    interlocks(chart, &mut atoms, messages);
    if net.steps() <= SET_MAX && net.transitions.len() <= TRANSITIONS_MAX {
        paths(chart, net, &formulas, messages);
    }
    temporary(chart, facts, messages);
}

/// Interlocks that are never satisfied, supervisions that always report a fault.
fn interlocks(chart: &Chart, atoms: &mut Atoms, messages: &mut Vec<Diagnostic>) {
    for step in &chart.steps {
        if let Some(condition) = &step.interlock
            && Formula::of(condition, atoms).constant() == Some(false)
        {
            let text = format!("the interlock of {} is always FALSE", step_title(step));
            let help = "write the condition for the rows with the letter C";
            messages.push(constant(condition, step.name.span, text, "rows with the letter C never run", help));
        }
        if let Some(condition) = &step.supervision {
            let formula = Formula::of(condition, atoms);
            // An empty network in place of a supervision means that the step has none.
            let is_empty = formula.plain && matches!(condition, Condition::Network(_));
            if formula.constant() == Some(true) && !is_empty {
                let text = format!("the supervision of {} is always TRUE", step_title(step));
                let help = "write the condition of a fault, e.g. that the step lasts too long";
                messages.push(constant(condition, step.name.span, text, "faulty at once, and never left", help));
            }
        }
    }
}

fn constant(condition: &Condition, name: Span, text: String, label: &str, help: &str) -> Diagnostic {
    let span = match condition {
        Condition::Expression(value) => value.span,
        Condition::Network(_) | Condition::Statements(_) => name,
    };
    Diagnostic::new(Code::ConstantCondition, span, text).label(label).help(help)
}

/// Paths of an alternative branch that an earlier path always closes.
fn paths(chart: &Chart, net: &Net, formulas: &[Formula], messages: &mut Vec<Diagnostic>) {
    let mut told: FxHashSet<usize> = FxHashSet::default();
    for step in 0..net.steps() {
        let mut branch = net.leaving[step].clone();
        branch.sort_by_key(|&at| (&chart.transitions[at].path, chart.transitions[at].number));
        branch.truncate(PATHS_MAX);
        for (place, &at) in branch.iter().enumerate() {
            if formulas[at].constant() == Some(false) || told.contains(&at) {
                continue;
            }
            let from = &net.transitions[at].from;
            let closes = |&first: &usize| {
                // Whenever the later one may switch, the steps before the first one are also active. Each pair is checked once.
                let before = &net.transitions[first].from;
                before[0] == step
                    && before.iter().all(|step| from.binary_search(step).is_ok())
                    && !told.contains(&first)
                    && formulas[at].implies(&formulas[first])
            };
            if let Some(first) = branch[..place].iter().copied().find(closes) {
                told.insert(at);
                let always = formulas[first].constant().is_some();
                messages.push(closed_path(&chart.transitions[at], &chart.transitions[first], always));
            }
        }
    }
}

fn closed_path(later: &Transition, first: &Transition, always: bool) -> Diagnostic {
    let (title, other) = (transition_title(later), transition_title(first));
    let label = match always {
        true => format!("{other} has priority, and is always satisfied"),
        false => format!("{other} has priority, and is satisfied whenever this one is"),
    };
    Diagnostic::new(Code::NotExclusive, later.name.span, format!("{title} never switches: {other} has priority"))
        .label(label)
        .also(first.name.span, "this path is the first one")
        .help("write conditions that exclude each other, or put the path with the narrower condition first")
}

/// Temporary data have no value when conditions are evaluated, unless permanent instructions before the sequencers write them.
fn temporary(chart: &Chart, facts: &Facts, messages: &mut Vec<Diagnostic>) {
    if facts.temporary.is_empty() {
        return;
    }
    let mut written: FxHashSet<String> = FxHashSet::default();
    for permanent in &chart.before {
        permanent_expressions(permanent, &mut |value| {
            written.extend(temporary_name(value, facts).map(fold));
        });
    }
    for transition in &chart.transitions {
        let Some(condition) = &transition.condition else { continue };
        let mut told: FxHashSet<String> = FxHashSet::default();
        condition_expressions(condition, &mut |value| {
            let Some(name) = temporary_name(value, facts) else { return };
            if !written.contains(&fold(name)) && told.insert(fold(name)) {
                let text =
                    format!("the condition of {} reads the temporary variable #{name}", transition_title(transition));
                messages.push(
                    Diagnostic::new(Code::TemporaryCondition, value.span, text)
                        .label("actions run after the conditions, and temporary data is lost at the end of the call")
                        .help("declare it in VAR, as static data"),
                );
            }
        });
    }
}

fn temporary_name<'e>(value: &'e Expr, facts: &Facts) -> Option<&'e str> {
    match &value.kind {
        ExprKind::Name(name) if name.form != NameForm::Quoted && facts.temporary.contains(&fold(&name.text)) => {
            Some(&name.text)
        }
        _ => None,
    }
}
