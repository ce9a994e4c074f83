//! Where sequencers begin and end, and single transitions that are not connected as they should be.

use plcc_diag::{Code, Diagnostic, Severity, Span};
use rustc_hash::FxHashSet;

use super::net::{Arcs, Net, Reach};
use super::{Chart, Checked, names, step_title, transition_title};

/// Transitions that are missing, or that leave no step.
pub fn check_transitions(checked: &Checked, messages: &mut Vec<Diagnostic>) {
    let chart = checked.chart;
    for transition in &chart.transitions {
        let span = transition.name.span;
        let title = transition_title(transition);
        if transition.missing {
            messages.push(
                Diagnostic::new(Code::MissingCondition, transition.span, format!("{title} is missing"))
                    .label("the chart has a gap between two steps here")
                    .help("insert a transition; without a condition it is always satisfied"),
            );
        }
        if transition.from.is_empty() && !chart.broken {
            messages.push(
                Diagnostic::new(Code::NoFromStep, span, format!("{title} leaves no step"))
                    .label("it can never switch")
                    .help("name the step before it after FROM, or connect it to a step"),
            );
        }
    }
}

/// Transitions that go back to where they begin, and ways back that are not drawn as a jump.
pub fn check_ways(checked: &Checked, messages: &mut Vec<Diagnostic>) {
    let Checked { chart, net, .. } = checked;
    for (transition, arcs) in chart.transitions.iter().zip(&net.transitions) {
        let span = transition.name.span;
        let title = transition_title(transition);
        let Some(step) = common(arcs) else { continue };
        let step = &chart.steps[step];
        let message = if transition.jump {
            let text = format!("{title} jumps to the step directly before it, {}", step_title(step));
            Diagnostic::new(Code::ShortJump, span, text)
                .label("the step is left and entered again in one call")
                .help("insert an empty step between the transition and the jump")
        } else {
            let text = format!("{title} leaves and enters {}", step_title(step));
            Diagnostic::new(Code::SelfLoop, span, text)
                .label(
                    "the step is entered again, and its time starts again, in each call in which the condition is TRUE",
                )
                .help("insert an empty step on the way back, or remove the transition")
        };
        messages.push(message.also(step.name.span, "this step"));
    }
    unmarked_jumps(checked, messages);
}

/// A circle without a jump cannot be drawn. Reports the transition that closes it, as seen from the initial steps.
fn unmarked_jumps(checked: &Checked, messages: &mut Vec<Diagnostic>) {
    #[derive(Clone, Copy, PartialEq)]
    enum Mark {
        New,
        /// On the way from the initial step to this step.
        Open,
        Done,
    }
    let Checked { chart, net, .. } = checked;
    // The nodes are the steps, followed by the transitions.
    let steps = net.steps();
    let none: &[usize] = &[];
    let nodes_after = |node: usize| match node.checked_sub(steps) {
        None => net.leaving[node].as_slice(),
        Some(at) if net.transitions[at].jump || leads_back(&net.transitions[at]) => none,
        Some(at) => net.transitions[at].to.as_slice(),
    };
    let mut marks = vec![Mark::New; steps + net.transitions.len()];
    for start in net.initial.iter().copied().chain(0..steps) {
        if marks[start] != Mark::New {
            continue;
        }
        marks[start] = Mark::Open;
        // A node, and how many of its successors have been visited.
        let mut open = vec![(start, 0)];
        while let Some((node, looked)) = open.pop() {
            let Some(&next) = nodes_after(node).get(looked) else {
                marks[node] = Mark::Done;
                continue;
            };
            open.push((node, looked + 1));
            let next = if node < steps { next + steps } else { next };
            if marks[next] == Mark::New {
                marks[next] = Mark::Open;
                open.push((next, 0));
            } else if marks[next] == Mark::Open && next < steps {
                let (transition, target) = (&chart.transitions[node - steps], &chart.steps[next]);
                let (title, target_title) = (transition_title(transition), step_title(target));
                let text = format!("{title} goes back to {target_title} but is not drawn as a jump");
                messages.push(
                    Diagnostic::new(Code::UnmarkedJump, transition.name.span, text)
                        .label("closes a circle")
                        .also(target.name.span, "this step comes before it")
                        .help("draw it as a jump; in source text, write (*$_JUMP*) after the name of the step"),
                );
            }
        }
    }
}

/// There is a step before it and one after it.
fn leads_back(arcs: &Arcs) -> bool {
    common(arcs).is_some()
}

/// The first step that is both before and after a transition.
fn common(arcs: &Arcs) -> Option<usize> {
    arcs.from.iter().copied().find(|step| arcs.to.binary_search(step).is_ok())
}

/// Whether a run from the initial steps shows what may be active.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    Good,
    /// They are wrong, which has been reported.
    Wrong,
}

/// Steps that nothing reaches or leaves, and the initial steps.
pub fn check_steps(checked: &Checked, messages: &mut Vec<Diagnostic>) -> Start {
    let Checked { chart, net, requests, manual, .. } = checked;
    let sequencer = net.sequencers();
    names::check_sequencers(chart, &sequencer, net, messages);
    let no_start = sequencers_without_start(checked, &sequencer, messages);

    // Nodes that are reached or have been explained.
    let mut known = Reach::new(net, net.initial.iter().chain(&requests.on).copied());
    // First, steps that nothing enters: they explain what comes after them.
    let roots = (0..net.steps()).filter(|&step| net.entering[step].is_empty()).chain(0..net.steps());
    let mut unreachable = Vec::new();
    for step in roots {
        if !known.steps[step] && !no_start.contains(&sequencer[step]) && !requests.any {
            unreachable.push(step);
            known.extend(net, [step]);
        }
    }
    // A transition that leaves no step, which has a message, is why others seem to have no way in or out.
    let is_whole = chart.broken || chart.transitions.iter().all(|transition| !transition.from.is_empty());
    let lost: FxHashSet<usize> = unreachable.iter().copied().collect();
    let is_end = |step: &usize| {
        let is_deactivated = requests.any || requests.off.contains(step);
        net.leaving[*step].is_empty() && !is_deactivated && !(net.is_alone(*step) && lost.contains(step))
    };
    let ends: Vec<usize> = (0..net.steps()).filter(is_end).collect();
    // One transition is missing between a step that nothing reaches and those that nothing leaves.
    let gap = match unreachable.as_slice() {
        [only] if net.entering[*only].is_empty() && !net.leaving[*only].is_empty() && !ends.is_empty() => Some(*only),
        _ => None,
    };
    for &step in unreachable.iter().filter(|_| is_whole) {
        let message = unreachable_step(checked, step, *manual);
        messages.push(match gap {
            Some(step) => message.help(missing_transition(chart, &ends, step)),
            None => message,
        });
    }
    for step in ends.into_iter().filter(|_| is_whole) {
        if gap.is_none() {
            let step = &chart.steps[step];
            messages.push(
                Diagnostic::new(Code::DeadEnd, step.name.span, format!("nothing leaves {}", step_title(step)))
                    .label("active for ever once it is entered; a join after it would never switch")
                    .help("add a transition after it: to the next step, as a jump, or to the end of the sequence"),
            );
        }
    }
    let together = initial_steps(checked, messages);
    if no_start.is_empty() && together { Start::Good } else { Start::Wrong }
}

/// What to add between steps that nothing leaves and one that nothing reaches.
fn missing_transition(chart: &Chart, from: &[usize], to: usize) -> String {
    let name = |step: &usize| chart.steps[*step].name.text.as_str();
    let names: Vec<&str> = from.iter().map(name).collect();
    let from = if names.len() == 1 { names[0].to_owned() } else { format!("( {} )", names.join(", ")) };
    format!(
        "add the transition that is missing: `FROM {from}` and `TO {}`; otherwise activate it with a row with ON",
        name(&to)
    )
}

/// Reports sequencers that nothing starts; returns the first steps of those.
fn sequencers_without_start(
    checked: &Checked,
    sequencer: &[usize],
    messages: &mut Vec<Diagnostic>,
) -> FxHashSet<usize> {
    let Checked { chart, net, requests, manual, .. } = checked;
    let firsts = (0..net.steps()).filter(|&step| sequencer[step] == step);
    let message = |span: Span, text: String| {
        Diagnostic::new(Code::NoInitialStep, span, text).label("nothing ever activates a step here")
    };
    if net.initial.is_empty() {
        // The block itself starts at an initial step, even if something else switches steps later.
        let span = chart.steps.first().map_or(checked.span, |step| step.name.span);
        let text = "the chart has no initial step".to_string();
        messages.push(message(span, text).help("make its first step an INITIAL_STEP: a new instance starts there"));
        return firsts.collect();
    }
    let mut started: FxHashSet<usize> = FxHashSet::default();
    started.extend(net.initial.iter().chain(&requests.on).map(|&step| sequencer[step]));
    let none = firsts.filter(|&first| !(started.contains(&first) || net.is_alone(first) || *manual || requests.any));
    let none: Vec<usize> = none.collect();
    for &first in &none {
        let step = &chart.steps[first];
        let text = format!("the sequencer of {} has no initial step", step_title(step));
        let help = "make its first step an initial step, or activate one of its steps with a jump or a row with ON";
        messages.push(message(step.name.span, text).help(help));
    }
    none.into_iter().collect()
}

fn unreachable_step(checked: &Checked, step: usize, manual: bool) -> Diagnostic {
    let Checked { chart, net, .. } = checked;
    let entering = net.entering[step].first();
    let step = &chart.steps[step];
    let text = format!("nothing reaches {}", step_title(step));
    let message = Diagnostic::new(Code::UnreachableStep, step.name.span, text)
        .help("add a transition to it, activate it with a row with ON, or remove it");
    let mut message = match entering {
        None => message.label("no initial step, and no transition leads here"),
        Some(&at) => {
            let transition = &chart.transitions[at];
            let text = format!("{} leads here, but is not reached either", transition_title(transition));
            message.label("no path from an initial step reaches it").also(transition.name.span, text)
        }
    };
    // In a circle, another way in may be missing; by hand, every step can be activated.
    if manual || entering.is_some() {
        message.severity = Severity::Warning;
    }
    message
}

/// Initial steps whose ways meet conflict: both would be active in one sequence. False if there are any.
fn initial_steps(checked: &Checked, messages: &mut Vec<Diagnostic>) -> bool {
    let Checked { chart, net, .. } = checked;
    // For each step, the initial step from which it is reached.
    let mut owner: Vec<Option<usize>> = vec![None; net.steps()];
    let mut good = true;
    for &initial in &net.initial {
        if let Some(other) = meets(net, &mut owner, initial) {
            good = false;
            let (step, other) = (&chart.steps[initial], &chart.steps[other]);
            let text = format!("{} and {} are initial steps of one sequence", step_title(other), step_title(step));
            messages.push(
                Diagnostic::new(Code::InitialSteps, step.name.span, text)
                    .label("active at the start, together with the other one")
                    .also(other.name.span, "the other initial step")
                    .help("keep one of them, or put them into different simultaneous paths or sequencers"),
            );
        }
    }
    good
}

/// Goes forward from an initial step, up to joins and jumps, and marks the steps as its own. Returns the other initial step whose way it meets.
fn meets(net: &Net, owner: &mut [Option<usize>], initial: usize) -> Option<usize> {
    let mut met = None;
    let mut open = vec![initial];
    while let Some(step) = open.pop() {
        match owner[step] {
            Some(other) if other == initial => continue,
            Some(other) => {
                met = Some(other);
                continue;
            }
            None => owner[step] = Some(initial),
        }
        for &at in &net.leaving[step] {
            let arcs = &net.transitions[at];
            if arcs.from.len() == 1 && !arcs.jump {
                open.extend(&arcs.to);
            }
        }
    }
    met
}
