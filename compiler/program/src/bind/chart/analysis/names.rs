//! Names, numbers and limits of a chart. Source: GRAPH reference, chapter 0.

use std::fmt::Display;

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::chart::ast::{Body as Chart, Dialect};
use rustc_hash::{FxHashMap, FxHashSet};

use super::net::Net;
use super::{step_title, transition_title};
use crate::bind::chart::index::Index;
use plcc_binding::fold;
use plcc_binding::similar;

const SEQUENCERS_MAX: usize = 8;
const STEPS_MAX: usize = 250;
const TRANSITIONS_MAX: usize = 250;
const BRANCHES_MAX: usize = 256;
/// Paths of an alternative branch.
const ALTERNATIVES_MAX: usize = 125;
/// Paths of a simultaneous branch.
const SIMULTANEOUS_MAX: usize = 249;
/// Permanent instructions before or after the sequencers.
const PERMANENT_MAX: usize = 250;

/// Limit of unknown names for which a similar name is searched.
const SIMILAR_MAX: usize = 50;

/// Checks names, numbers and limits. False if it is not clear which steps the transitions name.
pub fn check(chart: &Chart, index: &Index, messages: &mut Vec<Diagnostic>) -> bool {
    let clear = duplicates(chart, messages);
    if chart.dialect != Dialect::Sfc {
        counts(chart, messages);
        names(chart, messages);
    }
    unknown(chart, index, messages) && clear
}

/// A step or transition: its name, number, position and title.
struct Entry<'c> {
    transition: bool,
    name: &'c str,
    number: u32,
    span: Span,
    title: String,
}

fn entries(chart: &Chart) -> impl Iterator<Item = Entry<'_>> {
    let steps = chart.steps.iter().map(|step| Entry {
        transition: false,
        name: &step.name.text,
        number: step.number,
        span: step.name.span,
        title: step_title(step),
    });
    let transitions = chart.transitions.iter().map(|transition| Entry {
        transition: true,
        name: &transition.name.text,
        number: transition.number,
        span: transition.name.span,
        title: transition_title(transition),
    });
    steps.chain(transitions)
}

/// False if a name is used twice.
fn duplicates(chart: &Chart, messages: &mut Vec<Diagnostic>) -> bool {
    let mut clear = true;
    // Transitions of an SFC need no names.
    let apart = chart.dialect == Dialect::Sfc;
    let mut names: FxHashMap<(bool, String), (usize, Span)> = FxHashMap::default();
    let mut numbers: FxHashMap<(bool, u32), (usize, Span)> = FxHashMap::default();
    for (at, entry) in entries(chart).enumerate() {
        let kind = if entry.transition { "transition" } else { "step" };
        let key = (apart && entry.transition, fold(entry.name));
        let name = (!entry.name.is_empty()).then(|| *names.entry(key).or_insert((at, entry.span)));
        let number = *numbers.entry((entry.transition, entry.number)).or_insert((at, entry.span));
        let message = |title: String, (_, first): (usize, Span), help: &str| {
            Diagnostic::new(Code::DuplicateStep, entry.span, title)
                .label("the second one")
                .also(first, "the first one")
                .help(help)
        };
        if let Some(first) = name.filter(|&(first, _)| first != at) {
            let title = format!("the name \"{}\" is used twice", entry.name);
            let help = "each step and each transition of a block needs its own name; upper and lower case are the same";
            messages.push(message(title, first, help));
            clear = false;
        } else if number.0 != at {
            let title = format!("the {kind} number {} is used twice", entry.number);
            messages.push(message(title, number, &format!("give \"{}\" another number", entry.name)));
        }
    }
    clear
}

fn limit(span: Span, title: String, label: impl Display, help: &str) -> Diagnostic {
    Diagnostic::new(Code::ChartLimit, span, title).label(label.to_string()).help(help)
}

fn counts(chart: &Chart, messages: &mut Vec<Diagnostic>) {
    const DIVIDE: &str = "divide the chart among several function blocks";
    if let Some(step) = chart.steps.get(STEPS_MAX) {
        let title = format!("{} steps are too many for a GRAPH block", chart.steps.len());
        messages.push(limit(step.name.span, title, format!("S7-GRAPH allows {STEPS_MAX}"), DIVIDE));
    }
    if let Some(transition) = chart.transitions.get(TRANSITIONS_MAX) {
        let title = format!("{} transitions are too many for a GRAPH block", chart.transitions.len());
        messages.push(limit(transition.name.span, title, format!("S7-GRAPH allows {TRANSITIONS_MAX}"), DIVIDE));
    }
    for (list, place) in [(&chart.before, "before"), (&chart.after, "after")] {
        if let Some(permanent) = list.get(PERMANENT_MAX) {
            let title = format!("{} permanent instructions {place} the sequencers are too many", list.len());
            let help = "write them in a function, and call it as a permanent instruction";
            messages.push(limit(permanent.span, title, format!("S7-GRAPH allows {PERMANENT_MAX}"), help));
        }
    }
    let mut leaving: FxHashMap<String, usize> = FxHashMap::default();
    for transition in &chart.transitions {
        let paths = transition.from.len().max(transition.to.len());
        if paths > SIMULTANEOUS_MAX {
            let title = format!("{} has {paths} simultaneous paths", transition_title(transition));
            messages.push(limit(transition.name.span, title, format!("S7-GRAPH allows {SIMULTANEOUS_MAX}"), DIVIDE));
        }
        for name in &transition.from {
            *leaving.entry(fold(&name.text)).or_default() += 1;
        }
    }
    for step in &chart.steps {
        let paths = leaving.get(&fold(&step.name.text)).copied().unwrap_or(0);
        if paths > ALTERNATIVES_MAX {
            let title = format!("{} has {paths} alternative paths", step_title(step));
            let help = "join conditions, or lead some paths through another step";
            messages.push(limit(step.name.span, title, format!("S7-GRAPH allows {ALTERNATIVES_MAX}"), help));
        }
    }
}

/// Reports more sequencers, or more branches in one, than GRAPH allows. `sequencer` has, for each step, the first step of its sequencer.
pub fn check_sequencers(chart: &Chart, sequencer: &[usize], net: &Net, messages: &mut Vec<Diagnostic>) {
    if chart.dialect == Dialect::Sfc {
        return;
    }
    let firsts: Vec<usize> = (0..sequencer.len()).filter(|&step| sequencer[step] == step).collect();
    if let Some(&first) = firsts.get(SEQUENCERS_MAX) {
        let title = format!("{} sequencers are too many for a GRAPH block", firsts.len());
        let label = format!("S7-GRAPH allows {SEQUENCERS_MAX}; another one begins here");
        let help =
            "divide them among several function blocks; steps that no transition connects are separate sequencers";
        messages.push(limit(chart.steps[first].name.span, title, label, help));
    }
    let mut branches: FxHashMap<usize, usize> = FxHashMap::default();
    for (step, leaving) in net.leaving.iter().enumerate() {
        *branches.entry(sequencer[step]).or_default() += usize::from(leaving.len() > 1);
    }
    for arcs in &net.transitions {
        if let Some(&step) = arcs.from.first().or(arcs.to.first()) {
            let count = usize::from(arcs.to.len() > 1) + usize::from(arcs.from.len() > 1);
            *branches.entry(sequencer[step]).or_default() += count;
        }
    }
    for first in firsts {
        let count = branches.get(&first).copied().unwrap_or(0);
        if count > BRANCHES_MAX {
            let title = format!("the sequencer has {count} branches");
            let help = "divide the sequencer";
            messages.push(limit(chart.steps[first].name.span, title, format!("S7-GRAPH allows {BRANCHES_MAX}"), help));
        }
    }
}

fn names(chart: &Chart, messages: &mut Vec<Diagnostic>) {
    let (length_max, number_max) = match chart.dialect {
        Dialect::Classic => (24, 999),
        Dialect::Tia | Dialect::Sfc => (128, i16::MAX as u32),
    };
    for entry in entries(chart) {
        let length = entry.name.chars().count();
        if length > length_max {
            let title = format!("the name of {} is too long", entry.title);
            let label = format!("{length} characters; {length_max} are possible");
            messages.push(limit(entry.span, title, label, "choose a shorter name; the comment has room for more text"));
        }
        if entry.number == 0 || entry.number > number_max {
            let title = format!("{} is not a valid number of a step or transition", entry.number);
            let help = "number steps and transitions from 1";
            messages.push(limit(entry.span, title, format!("1 to {number_max} are possible"), help));
        }
    }
}

/// False if a transition names a step that does not exist.
fn unknown(chart: &Chart, index: &Index, messages: &mut Vec<Diagnostic>) -> bool {
    let mut told: FxHashSet<String> = FxHashSet::default();
    // One of two steps with the same name has another name, which transitions use.
    let mut known: FxHashSet<String> = FxHashSet::default();
    let is_twice = !chart.steps.iter().all(|step| known.insert(fold(&step.name.text)));
    for transition in &chart.transitions {
        for (word, list) in [("FROM", &transition.from), ("TO", &transition.to)] {
            for name in list.iter().filter(|name| index.step(&name.text).is_none()) {
                if !told.insert(fold(&name.text)) || chart.broken {
                    continue;
                }
                let title = format!("the chart has no step \"{}\"", name.text);
                let label = format!("{word} of {} names a step", transition_title(transition));
                let steps = chart.steps.iter().map(|step| step.name.text.as_str());
                let similar = (told.len() <= SIMILAR_MAX).then(|| similar(&name.text, steps)).flatten();
                if is_twice && similar.is_none() {
                    continue;
                }
                let help = match (index.step_reference(&name.text), similar) {
                    (Some(step), _) => format!("write its name: \"{}\"", chart.steps[step].name.text),
                    (None, Some(step)) => format!("is \"{step}\" meant?"),
                    (None, None) => "name a step of this block, or add the step".to_string(),
                };
                messages.push(Diagnostic::new(Code::UnknownStep, name.span, title).label(label).help(help));
            }
        }
    }
    told.is_empty()
}
