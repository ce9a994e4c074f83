//! What can be left out of a chart, and of its calls.

use plcc_tests::reduce::{self, Best};

use super::chart::{Action, Chart, Condition};
use super::generate::Case;
use super::memory::Inputs;
use super::run::{self, FORMS, Failure};

/// A small case that fails as `case` does, with its failure.
pub fn reduce(case: Case, failure: Failure) -> Best<Case> {
    Best::of(case, failure, |best| {
        steps(best);
        lists(best);
        conditions(best);
        calls(best);
    })
}

impl reduce::Case for Case {
    type Failure = Failure;

    fn check(&self) -> Result<(), Failure> {
        run::check(self, &FORMS)
    }

    fn alike(new: &Failure, old: &Failure) -> bool {
        match (new, old) {
            (Failure::Refused(_), Failure::Refused(_)) | (Failure::Different { .. }, Failure::Different { .. }) => true,
            (Failure::Refused(_) | Failure::Different { .. }, _) => false,
        }
    }

    fn cut(&mut self, failure: &Failure) {
        if let Failure::Different { call, .. } = failure {
            self.calls.truncate(*call);
        }
    }

    fn size(&self) -> usize {
        format!("{self:?}").len()
    }
}

fn steps(best: &mut Best<Case>) {
    best.each(|case| case.chart.steps.len(), |case, step| without_step(&mut case.chart, step));
    best.each(|case| case.chart.transitions.len(), |case, index| without_transition(&mut case.chart, index));
}

fn lists(best: &mut Best<Case>) {
    best.each(|case| case.chart.before.len(), |case, index| _ = case.chart.before.remove(index));
    best.each(|case| case.chart.after.len(), |case, index| _ = case.chart.after.remove(index));
    for step in 0..best.case.chart.steps.len() {
        best.each(|case| case.chart.steps[step].rows.len(), |case, row| _ = case.chart.steps[step].rows.remove(row));
        for row in 0..best.case.chart.steps[step].rows.len() {
            if best.case.chart.steps[step].rows[row].interlock {
                best.attempt(|case| case.chart.steps[step].rows[row].interlock = false);
            }
        }
        if best.case.chart.steps[step].interlock.is_some() {
            best.attempt(|case| case.chart.steps[step].interlock = None);
        }
        if best.case.chart.steps[step].supervision.is_some() {
            best.attempt(|case| case.chart.steps[step].supervision = None);
        }
    }
}

fn conditions(best: &mut Best<Case>) {
    let count = places(&mut best.case.chart).count();
    for index in 0..count {
        let found = places(&mut best.case.chart).nth(index).cloned();
        let Some(condition) = found else { return };
        let constants = match condition {
            Condition::Constant(_) => Vec::new(),
            _ => vec![Condition::Constant(true), Condition::Constant(false)],
        };
        for simpler in constants.into_iter().chain(parts(&condition)) {
            if best.attempt(|case| *places(&mut case.chart).nth(index).expect("it was there") = simpler) {
                break;
            }
        }
    }
}

fn calls(best: &mut Best<Case>) {
    for call in (0..best.case.calls.len()).rev() {
        if best.case.calls.len() > call + 1 {
            best.attempt(|case| _ = case.calls.remove(call));
        }
    }
    for call in 0..best.case.calls.len() {
        if best.case.calls.get(call).is_some_and(|call| call.inputs != Inputs::new()) {
            best.attempt(|case| case.calls[call].inputs = Inputs::new());
        }
        if best.case.calls.get(call).is_some_and(|call| call.inputs.s_sel != 0) {
            best.attempt(|case| case.calls[call].inputs.s_sel = 0);
        }
        for bit in 0..Inputs::new().bits.len() {
            if best.case.calls.get(call).is_some_and(|call| call.inputs.bits[bit]) {
                best.attempt(|case| case.calls[call].inputs.bits[bit] = false);
            }
        }
        if best.case.calls.get(call).is_some_and(|call| call.process != [0; 4]) {
            best.attempt(|case| case.calls[call].process = [0; 4]);
        }
        if best.case.calls.get(call).is_some_and(|call| call.paused) {
            best.attempt(|case| case.calls[call].paused = false);
        }
    }
}

/// All conditions of a chart.
fn places(chart: &mut Chart) -> impl Iterator<Item = &mut Condition> {
    let permanent = chart.before.iter_mut().chain(&mut chart.after).map(|permanent| &mut permanent.value);
    let steps = chart.steps.iter_mut().flat_map(|step| step.interlock.iter_mut().chain(&mut step.supervision));
    let transitions = chart.transitions.iter_mut().flat_map(|transition| &mut transition.condition);
    permanent.chain(steps).chain(transitions)
}

fn parts(condition: &Condition) -> Vec<Condition> {
    match condition {
        Condition::Not(inner) => vec![(**inner).clone()],
        Condition::And(list) | Condition::Or(list) | Condition::Xor(list) => list.clone(),
        Condition::Constant(_)
        | Condition::Bit(_)
        | Condition::Step(..)
        | Condition::Transition(..)
        | Condition::Time { .. }
        | Condition::Word { .. }
        | Condition::Timer(_)
        | Condition::Counter(_) => Vec::new(),
    }
}

/// Changes all numbers of steps and transitions in a condition; a condition on a removed one becomes TRUE.
fn renumber(
    condition: &mut Condition,
    step: &impl Fn(usize) -> Option<usize>,
    transition: &impl Fn(usize) -> Option<usize>,
) {
    let gone = match condition {
        Condition::Step(index, _) | Condition::Time { step: index, .. } => {
            step(*index).map(|new| *index = new).is_none()
        }
        Condition::Transition(index, _) => transition(*index).map(|new| *index = new).is_none(),
        Condition::Not(inner) => {
            renumber(inner, step, transition);
            false
        }
        Condition::And(list) | Condition::Or(list) | Condition::Xor(list) => {
            list.iter_mut().for_each(|one| renumber(one, step, transition));
            false
        }
        Condition::Constant(_)
        | Condition::Bit(_)
        | Condition::Word { .. }
        | Condition::Timer(_)
        | Condition::Counter(_) => false,
    };
    if gone {
        *condition = Condition::Constant(true);
    }
}

fn without(removed: usize) -> impl Fn(usize) -> Option<usize> {
    move |index| (index != removed).then(|| index - usize::from(index > removed))
}

fn without_transition(chart: &mut Chart, removed: usize) {
    chart.transitions.remove(removed);
    places(chart).for_each(|condition| renumber(condition, &Some, &without(removed)));
}

/// Removes a step: transitions to it now go to the target of its first transition.
fn without_step(chart: &mut Chart, removed: usize) {
    let next = chart.transitions.iter().position(|transition| transition.from == [removed]);
    let after = next.map_or(Vec::new(), |next| chart.transitions[next].to.clone());
    if let Some(next) = next {
        without_transition(chart, next);
    }
    while let Some(other) = chart.transitions.iter().position(|transition| transition.from == [removed]) {
        without_transition(chart, other);
    }
    for transition in &mut chart.transitions {
        transition.from.retain(|&step| step != removed);
        if let Some(at) = transition.to.iter().position(|&step| step == removed) {
            transition.to.splice(at..=at, after.iter().copied().filter(|&step| step != removed));
        }
    }
    let initial = chart.steps.remove(removed).initial;
    let new = without(removed);
    for transition in &mut chart.transitions {
        for step in transition.from.iter_mut().chain(&mut transition.to) {
            *step = new(*step).unwrap_or(0);
        }
    }
    if initial {
        for step in after.iter().filter_map(|&step| new(step)) {
            chart.steps[step].initial = true;
        }
    }
    for step in &mut chart.steps {
        step.rows.retain_mut(|row| match &mut row.action {
            Action::On(step) | Action::Off(step) => new(*step).map(|number| *step = number).is_some(),
            _ => true,
        });
    }
    places(chart).for_each(|condition| renumber(condition, &new, &Some));
}
