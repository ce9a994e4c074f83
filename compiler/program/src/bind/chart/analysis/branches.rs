//! Simultaneous branches: steps that are entered while they are active, jumps out of paths and into them, joins that never switch.
//!
//! If the paths of the branches prove it, no search is needed. Otherwise all markings are searched, unless rows of ON and OFF switch
//! steps in addition to the transitions. Steps that can be switched by hand, and conditions that read active steps, turn errors into
//! warnings: they may separate, or bring together, steps that the transitions alone do not. Source: GRAPH reference G.4 and chapter I, "Detection".

use plcc_diag::{Code, Diagnostic, Severity};
use plcc_syntax::chart::ast::{ActionBody, Qualifier};
use plcc_syntax::scl::ast::ExprKind;
use rustc_hash::FxHashSet;

use super::marking::{self, Entry, MARKINGS_MAX};
use super::net::{Arcs, Net, Reach, StepSet};
use super::regions::{self, Stray};
use super::structure::Start;
use super::{Checked, step_title, transition_title};
use crate::bind::trees::mentions::condition_expressions;

/// Reports mistakes in branches. Returns, by step, the steps that may be active together with it, as far as known.
pub fn check(checked: &Checked, start: Start, messages: &mut Vec<Diagnostic>) -> Vec<StepSet> {
    let net = &checked.net;
    let branches = regions::branches(net);
    for stray in branches.strays.iter().filter(|stray| !abandons(checked, stray)) {
        messages.push(branch_jump(checked, stray));
    }
    if start == Start::Wrong || !checked.requests.is_empty() {
        return branches.together;
    }
    let severity = if checked.manual || asks_for_steps(checked) { Severity::Warning } else { Severity::Error };
    // Mistakes in a sequencer with this jump follow from it.
    let sequencer = net.sequencers();
    let is_told = |step: usize| branches.strays.iter().any(|stray| sequencer[stray.step] == sequencer[step]);
    let joins = (0..net.transitions.len()).filter(|&at| net.transitions[at].from.len() > 1);
    let joins = joins.filter(|&at| !is_told(net.transitions[at].from[0]));
    if branches.proven() {
        let reached = Reach::new(net, net.initial.iter().copied()).steps;
        let dead = joins.filter(|&at| {
            let from = &net.transitions[at].from;
            let apart = from.iter().any(|&step| !StepSet::of(from).within(with_itself(&branches.together, step)));
            apart && from.iter().all(|&step| reached[step])
        });
        messages.extend(dead.map(|at| dead_join(checked, at, &branches.together, severity)));
        return branches.together;
    }
    let search = marking::search(net, MARKINGS_MAX);
    // The first one of a branch: the others follow from it.
    let mut openers: FxHashSet<Option<usize>> = FxHashSet::default();
    for entry in search.entries.iter().filter(|entry| !is_told(entry.step)) {
        if openers.insert(entry.opener) {
            messages.push(unsafe_branch(checked, entry, severity));
        }
    }
    if search.entries.is_empty() && search.complete {
        let reached = |step: &usize| !search.together[*step].is_empty();
        let dead = joins.filter(|&at| !search.switched[at] && net.transitions[at].from.iter().all(reached));
        messages.extend(dead.map(|at| dead_join(checked, at, &search.together, severity)));
    } else if search.entries.is_empty() && branches.strays.is_empty() {
        messages.extend(branches.loose.iter().map(|&opener| unproven(checked, opener)));
    }
    search.together
}

fn with_itself(together: &[StepSet], step: usize) -> StepSet {
    together[step].with(StepSet::of(&[step]))
}

/// A condition reads whether a step is active.
fn asks_for_steps(checked: &Checked) -> bool {
    let mut found = false;
    for condition in checked.chart.transitions.iter().filter_map(|transition| transition.condition.as_ref()) {
        condition_expressions(condition, &mut |value| {
            found |= matches!(&value.kind, ExprKind::Member { name, .. } if name.text.eq_ignore_ascii_case("X"));
        });
    }
    found
}

/// A way out of a path, next to a step that switches off all others.
fn abandons(checked: &Checked, stray: &Stray) -> bool {
    let switches_off = |&step: &usize| {
        let mut rows = checked.chart.steps[step].actions.iter();
        rows.any(|row| row.qualifier == Qualifier::Off && matches!(row.body, ActionBody::All { .. }))
    };
    let arcs = &checked.net.transitions[stray.transition];
    !stray.inward && arcs.from.iter().chain(&arcs.to).any(switches_off)
}

fn branch_jump(checked: &Checked, stray: &Stray) -> Diagnostic {
    let chart = checked.chart;
    let (transition, opener) = (&chart.transitions[stray.transition], &chart.transitions[stray.opener]);
    let (title, step) = (transition_title(transition), &chart.steps[stray.step]);
    let (text, label, help) = if stray.inward {
        (
            format!("{title} goes into one path of a simultaneous branch, to {}", step_title(step)),
            "the other paths are not activated",
            "go to a step before the branch, or open all paths by one transition",
        )
    } else {
        (
            format!("{title} goes out of one path of a simultaneous branch, to {}", step_title(step)),
            "the other paths stay active",
            "join all paths first, or abandon them with OFF S_ALL, OFF_SQ or INIT_SQ",
        )
    };
    Diagnostic::new(Code::BranchJump, transition.name.span, text)
        .label(label)
        .also(opener.name.span, "opens the paths")
        .also(step.name.span, "this step")
        .help(help)
}

fn unsafe_branch(checked: &Checked, entry: &Entry, severity: Severity) -> Diagnostic {
    let chart = checked.chart;
    let (transition, step) = (&chart.transitions[entry.transition], &chart.steps[entry.step]);
    let text = format!("{} may enter {} while it is active", transition_title(transition), step_title(step));
    let mut message = Diagnostic::new(Code::UnsafeBranch, transition.name.span, text)
        .label("switches although the step after it may still be active")
        .also(step.name.span, "this step");
    if let Some(opener) = entry.opener {
        message = message.also(chart.transitions[opener].name.span, "opens simultaneous paths");
    }
    message.severity = if is_jumped_into(checked, entry) { Severity::Warning } else { severity };
    message.help("end simultaneous paths in one transition with all their last steps after FROM, not one at a time")
}

/// Jumps to the steps of this sequencer from others, which may not know that it is running. Sequencers are drawn without jumps.
fn is_jumped_into(checked: &Checked, entry: &Entry) -> bool {
    let net = &checked.net;
    let drawn: Vec<Arcs> = net.transitions.iter().filter(|arcs| !arcs.jump).cloned().collect();
    let sequencer = Net::of(net.steps(), Vec::new(), drawn).sequencers();
    let inside = |step: &usize| sequencer[*step] == sequencer[entry.step];
    let mut jumps = net.transitions.iter().filter(|arcs| arcs.jump);
    jumps.any(|arcs| arcs.to.iter().any(inside) && !arcs.from.iter().any(inside))
}

fn unproven(checked: &Checked, opener: usize) -> Diagnostic {
    let transition = &checked.chart.transitions[opener];
    let text = format!("the paths that {} opens do not all end in one join", transition_title(transition));
    let mut message = Diagnostic::new(Code::UnsafeBranch, transition.name.span, text)
        .label("a step of these paths may be entered while it is active: the chart is too large to be sure")
        .help("end these paths in one transition with the last step of each after FROM");
    message.severity = Severity::Warning;
    message
}

fn dead_join(checked: &Checked, at: usize, together: &[StepSet], severity: Severity) -> Diagnostic {
    let transition = &checked.chart.transitions[at];
    let from = &checked.net.transitions[at].from;
    let text = format!("{} can never switch", transition_title(transition));
    let mut message = Diagnostic::new(Code::DeadJoin, transition.name.span, text)
        .label("the steps before it are never active together")
        .help("open their paths with one transition that has several steps after TO, or continue each path with its own transition");
    let pairs = from.iter().flat_map(|&a| from.iter().map(move |&b| (a, b))).filter(|(a, b)| a < b);
    if let Some((a, b)) = pairs.into_iter().find(|&(a, b)| !together[a].has(b)) {
        for (step, other) in [(a, b), (b, a)] {
            let [step, other] = [step, other].map(|step| &checked.chart.steps[step]);
            message = message.also(step.name.span, format!("not active together with {}", step_title(other)));
        }
    }
    message.severity = severity;
    message
}
