//! Code of a chart, put into the placeholders of the engine. Source: GRAPH reference, chapters D and G.
//!
//! A call processes the active steps: each placeholder in a loop over them is one CASE over the step's position, with an arm for each
//! step that has code there.

use plcc_syntax::Elementary;
use plcc_syntax::chart::ast::Transition;
use rustc_hash::FxHashMap;

use super::action::StepCode;
use super::alone::{IsShared, SHARED};
use super::build::{assign, if_then, number};
use super::engine_data::{Engine, all, compared, not};
use crate::bind::declarations::path::Variable;
use crate::bind::scl::expression::binary_expr;
use plcc_model::scl::{Arm, BinaryOp, CompareOp, Expr, Statement, StatementKind};

/// Statements that must run before the value of a condition, and the value, a BOOL.
pub type Condition = (Vec<Statement>, Expr);

/// All bound parts of a chart.
pub struct Parts {
    pub before: Vec<Statement>,
    pub after: Vec<Statement>,
    /// One for each step.
    pub codes: Vec<StepCode>,
    pub interlocks: Vec<Option<Condition>>,
    pub supervisions: Vec<Option<Condition>>,
    /// One for each transition.
    pub conditions: Vec<Condition>,
    /// Steps that each transition leaves and enters.
    pub from: Vec<Vec<usize>>,
    pub to: Vec<Vec<usize>>,
}

/// The features of the engine that the chart needs.
pub struct Features {
    pub monitoring: bool,
    /// Transitions only switch after phase 6.
    pub selection: bool,
    pub all_conditions: bool,
    pub skipping: bool,
    pub display: bool,
    pub transition_display: bool,
    pub safe_activation: bool,
    /// Rows of OFF.
    pub requests: bool,
    /// The short way of a call with one active step, see `alone.rs`; that with several.
    pub alone: bool,
    pub several: bool,
    /// With several: a step's time can pass after the transitions of another.
    pub one_loop: bool,
    /// No action changes the modes.
    pub tame_actions: bool,
    /// The end of the call is short, and there again on the short way.
    pub own_end: bool,
    /// The quick way in place of the short one, see `quick.rs`.
    pub quick: bool,
}

/// Fills the placeholders.
pub struct Assembly<'a, 'c> {
    pub engine: &'a Engine<'c>,
    pub parts: Parts,
    pub features: Features,
    /// BOOLs of the frame, one for each transition of the step with the most of them.
    pub results: Vec<Variable>,
    /// Transitions that a step's arm evaluates, best first.
    pub owned: Vec<Vec<usize>>,
    /// Transitions that compete with a join for a step, best first: they switch after all others.
    competing: Vec<usize>,
    /// The code is for the short way, on which a satisfied transition fires and none is forced.
    ordinary: bool,
}

/// Transitions, grouped by the step whose arm evaluates them: the first of those they leave.
pub fn owners(steps: usize, from: &[Vec<usize>], transitions: &[Transition]) -> Vec<Vec<usize>> {
    let mut owned = vec![Vec::new(); steps];
    for (at, from) in from.iter().enumerate() {
        if let Some(owner) = from.iter().min() {
            owned[*owner].push(at);
        }
    }
    for list in &mut owned {
        list.sort_by_key(|at| (&transitions[*at].path, transitions[*at].number));
    }
    owned
}

/// Transitions that compete for a step: one leaves several steps, another leaves one of these.
pub fn competing(steps: usize, from: &[Vec<usize>], transitions: &[Transition]) -> Vec<usize> {
    // Transitions and joins that leave each step; a join spreads to all steps that its rivals leave.
    let mut leaving = vec![Vec::new(); steps];
    for (at, from) in from.iter().enumerate() {
        from.iter().for_each(|step| leaving[*step].push(at));
    }
    let mut found = vec![false; from.len()];
    let is_join = |at: &usize| from[*at].len() > 1;
    let rivals = leaving.iter().filter(|list| list.len() > 1 && list.iter().any(is_join));
    let mut open: Vec<usize> = rivals.flatten().copied().collect();
    while let Some(at) = open.pop() {
        if !std::mem::replace(&mut found[at], true) {
            open.extend(from[at].iter().flat_map(|step| leaving[*step].iter().copied()));
        }
    }
    let mut list: Vec<usize> = (0..from.len()).filter(|at| found[*at]).collect();
    list.sort_by_key(|at| (&transitions[*at].path, transitions[*at].number));
    list
}

impl<'a, 'c> Assembly<'a, 'c> {
    pub fn new(
        engine: &'a Engine<'c>,
        parts: Parts,
        features: Features,
        results: Vec<Variable>,
        owned: Vec<Vec<usize>>,
        competing: Vec<usize>,
    ) -> Assembly<'a, 'c> {
        Assembly { engine, parts, features, results, owned, competing, ordinary: false }
    }

    /// The code for each placeholder of the engine.
    pub fn holes(mut self, is_shared: &IsShared) -> FxHashMap<&'static str, Vec<Statement>> {
        let engine = self.engine;
        let mut holes = FxHashMap::default();
        let per_step = |make: &dyn Fn(usize) -> Vec<Statement>| self.case("k", make);
        holes.insert("sets", engine.begin_sets());
        let (long_way, go_on) = (engine.leave_short_way(&[]), engine.leave_short_way(&SHARED));
        holes.insert("make_pair_since", engine.make_pair_since());
        holes.insert("long_way", if self.features.alone { long_way } else { Vec::new() });
        holes.insert("go_on", go_on);
        holes.insert("expire", per_step(&|step| self.parts.codes[step].expire.clone()));
        holes.insert("forget", per_step(&|step| self.forget(step)));
        holes.insert("enter_initial", self.enter_initial());
        holes.insert("evaluate", per_step(&|step| self.evaluate(step)));
        holes.insert("evaluate_all", if self.features.all_conditions { self.evaluate_all() } else { Vec::new() });
        holes.insert("watch", per_step(&|step| self.watch(step)));
        holes.insert("watch_entered", per_step(&|step| self.watch(step)));
        holes.insert("select", if self.features.selection { per_step(&|step| self.select(step)) } else { Vec::new() });
        holes.insert("select_joins", self.select_joins());
        holes.insert("leave_section", if self.features.safe_activation { self.leave_section() } else { Vec::new() });
        holes.insert("mark_left", engine.mark(&engine.left));
        holes.insert("is_entered", engine.look_up(&engine.entered));
        holes.insert("mark_entered", engine.mark(&engine.entered));
        holes.insert("no_longer_active", engine.change_active(false));
        holes.insert("now_active", engine.change_active(true));
        holes.insert("was_passed", engine.look_up(&engine.passed));
        holes.insert("skip", if self.features.skipping { per_step(&|step| self.skip(step)) } else { Vec::new() });
        holes.insert("leave", per_step(&|step| self.parts.codes[step].leave.clone()));
        holes.insert("make_pair", if engine.is_plain { Vec::new() } else { engine.make_pair() });
        holes.insert("add_pair", engine.add_pair());
        holes.insert("put_pair", engine.put_pair());
        holes.insert("act", per_step(&|step| self.parts.codes[step].active.clone()));
        self.ordinary = true;
        if self.features.alone {
            let per_step = |make: &dyn Fn(usize) -> Vec<Statement>| self.case("k", make);
            let alone = |make: &dyn Fn(usize) -> Vec<Statement>| self.case("alone", make);
            if self.features.quick {
                let yes = number(1, Elementary::Bool, engine.span);
                let leave = Statement { kind: StatementKind::Return(Some(yes)), span: engine.span };
                holes.insert("leave_block", vec![leave]);
                self.quick_holes(&mut holes, is_shared);
            } else {
                holes.insert("one", alone(&|step| self.one(step, is_shared)));
                holes.insert("watch_alone", alone(&|step| self.watch(step)));
                if self.features.selection {
                    holes.insert("select_alone", alone(&|step| self.select_alone(step, is_shared)));
                }
            }
            holes.insert("act_alone", alone(&|step| self.ordinary_actions(step)));
            if self.features.several {
                holes.insert("evaluate_ordinary", per_step(&|step| self.evaluate(step)));
                holes.insert("select_ordinary", per_step(&|step| self.select(step)));
                holes.insert("act_ordinary", per_step(&|step| self.ordinary_actions(step)));
            }
        }
        holes.insert("before", self.parts.before);
        holes.insert("after", self.parts.after);
        holes
    }

    /// `CASE selector OF`, with an arm for each step that has statements.
    pub fn case(&self, selector: &str, make: &dyn Fn(usize) -> Vec<Statement>) -> Vec<Statement> {
        let steps = 0..self.engine.chart.steps.len();
        let arms: Vec<Arm> = steps
            .filter_map(|step| {
                let body = make(step);
                let place = step as i128 + 1;
                (!body.is_empty()).then(|| Arm { ranges: vec![(place, place)], body })
            })
            .collect();
        if arms.is_empty() {
            return Vec::new();
        }
        let kind = StatementKind::Case { selector: self.engine.value(selector), arms, otherwise: Vec::new() };
        vec![Statement { kind, span: self.engine.span }]
    }

    /// The call after the one that left a step.
    pub fn forget(&self, step: usize) -> Vec<Statement> {
        let span = self.engine.chart.steps[step].span;
        self.owned[step].iter().map(|at| self.set_flags(*at, number(0, Elementary::Byte, span))).collect()
    }

    pub fn set_flags(&self, transition: usize, value: Expr) -> Statement {
        assign(&self.engine.flags(transition), value, self.engine.chart.transitions[transition].span)
    }

    fn enter_initial(&self) -> Vec<Statement> {
        let steps = self.engine.chart.steps.iter().enumerate().filter(|(_, step)| step.initial);
        steps.flat_map(|(at, step)| self.engine.append(&self.engine.entered, "S1X", "entered", at, step.span)).collect()
    }

    /// Phase 5 of an active step; without monitoring also phase 7.
    fn evaluate(&self, step: usize) -> Vec<Statement> {
        self.evaluate_with(step, &|at| self.fire_or_mark(at))
    }

    /// The same, with what a transition does that fires.
    pub fn evaluate_with(&self, step: usize, fire: &dyn Fn(usize) -> Vec<Statement>) -> Vec<Statement> {
        let mut statements = Vec::new();
        for (place, &at) in self.owned[step].iter().enumerate() {
            let span = self.engine.chart.transitions[at].span;
            let result = &self.results[place];
            let (before, value) = self.parts.conditions[at].clone();
            let flags = |value| vec![self.set_flags(at, number(value, Elementary::Byte, span))];
            let mut own = flags(1);
            own.extend(before);
            own.push(assign(result, value, span));
            own.push(if_then(super::build::load(result, span), flags(3), Vec::new(), span));
            if self.features.transition_display {
                own.extend(self.note_valid(at));
            }
            let from = &self.parts.from[at];
            if from.len() > 1 {
                let mut none = vec![assign(result, number(0, Elementary::Bool, span), span)];
                none.extend(flags(0));
                statements.push(if_then(self.engine.is_active(from, span), own, none, span));
            } else {
                statements.extend(own);
            }
        }
        if !self.features.selection {
            let satisfied = |place: usize, at: usize| {
                super::build::load(&self.results[place], self.engine.chart.transitions[at].span)
            };
            statements.extend(self.choose(&self.owned[step], &satisfied, fire));
        }
        statements
    }

    /// Stores the values of T_NO and T_MORE.
    fn note_valid(&self, at: usize) -> Vec<Statement> {
        let span = self.engine.chart.transitions[at].span;
        let own = u64::from(self.engine.chart.transitions[at].number);
        let variable = |name: &str| self.engine.variable(name).clone();
        let value = |name: &str| super::build::load(self.engine.variable(name), span);
        let more = binary_expr(BinaryOp::Add, value("valid"), number(1, Elementary::Int, span), Elementary::Int, span);
        let first = assign(&variable("first_valid"), number(own, Elementary::Int, span), span);
        let still = assign(&variable("still_valid"), number(1, Elementary::Bool, span), span);
        vec![
            assign(&variable("valid"), more, span),
            if_then(compared(CompareOp::Equal, value("first_valid"), 0), vec![first], Vec::new(), span),
            if_then(compared(CompareOp::Equal, value("T_SHOWN"), own), vec![still], Vec::new(), span),
        ]
    }

    /// Conditions of all transitions that are not valid (T_PERM).
    fn evaluate_all(&self) -> Vec<Statement> {
        let mut statements = Vec::new();
        for (at, transition) in self.engine.chart.transitions.iter().enumerate() {
            let span = transition.span;
            let (before, value) = self.parts.conditions[at].clone();
            let flags = |value| vec![self.set_flags(at, number(value, Elementary::Byte, span))];
            let mut own = before;
            own.push(if_then(value, flags(2), flags(0), span));
            statements.push(if_then(not(self.is_valid(at)), own, Vec::new(), span));
        }
        statements
    }

    fn is_valid(&self, at: usize) -> Expr {
        let span = self.engine.chart.transitions[at].span;
        let flags = super::build::load(&self.engine.flags(at), span);
        let bit = binary_expr(BinaryOp::And, flags, number(1, Elementary::Byte, span), Elementary::Byte, span);
        compared(CompareOp::NotEqual, bit, 0)
    }

    /// Interlock and supervision of a step.
    fn watch(&self, step: usize) -> Vec<Statement> {
        let (interlock, supervision) = (&self.parts.interlocks[step], &self.parts.supervisions[step]);
        if interlock.is_none() && supervision.is_none() {
            return Vec::new();
        }
        let span = self.engine.chart.steps[step].span;
        let mut statements = Vec::new();
        for (name, condition, absent) in [("satisfied", interlock, 1), ("faulty_now", supervision, 0)] {
            let value = match condition {
                Some((before, value)) => {
                    statements.extend(before.iter().cloned());
                    value.clone()
                }
                None => number(absent, Elementary::Bool, span),
            };
            statements.push(assign(self.engine.variable(name), value, span));
        }
        statements.push(assign(self.engine.variable("watched"), number(1, Elementary::Bool, span), span));
        statements
    }

    /// Phase 7 of an active step.
    fn select(&self, step: usize) -> Vec<Statement> {
        self.select_with(step, &|at| self.fire_or_mark(at))
    }

    /// The same, with what a transition does that fires.
    pub fn select_with(&self, step: usize, fire: &dyn Fn(usize) -> Vec<Statement>) -> Vec<Statement> {
        let own: Vec<usize> = self.owned[step].iter().copied().filter(|at| !self.competing.contains(at)).collect();
        let satisfied = |_: usize, at: usize| self.engine.satisfied(at, self.engine.chart.transitions[at].span);
        self.choose(&own, &satisfied, fire)
    }

    fn select_joins(&self) -> Vec<Statement> {
        let satisfied = |at: usize| self.engine.satisfied(at, self.engine.chart.transitions[at].span);
        let one = |&at: &usize| {
            let span = self.engine.chart.transitions[at].span;
            let free = self.engine.left.holds_none(&self.parts.from[at], span);
            let go = binary_expr(BinaryOp::And, free, self.goes(at, satisfied(at)), Elementary::Bool, span);
            if_then(go, self.fire(at), Vec::new(), span)
        };
        self.in_order(&self.competing, &|list| list.iter().map(one).collect())
    }

    /// The first transition that can fire does. With T_PERM their numbers decide.
    fn choose(
        &self,
        list: &[usize],
        satisfied: &dyn Fn(usize, usize) -> Expr,
        fire: &dyn Fn(usize) -> Vec<Statement>,
    ) -> Vec<Statement> {
        if list.is_empty() {
            return Vec::new();
        }
        let place = |at: usize| list.iter().position(|one| *one == at).unwrap_or(0);
        self.in_order(list, &|list| {
            let branches = list.iter().map(|&at| (self.goes(at, satisfied(place(at), at)), fire(at))).collect();
            let span = self.engine.chart.transitions[list[0]].span;
            vec![Statement { kind: StatementKind::If { branches, otherwise: Vec::new() }, span }]
        })
    }

    /// Statements for transitions in the order of the drawing, or in order of their numbers if T_PERM is set.
    fn in_order(&self, list: &[usize], make: &dyn Fn(&[usize]) -> Vec<Statement>) -> Vec<Statement> {
        let mut numbered = list.to_vec();
        numbered.sort_by_key(|at| self.engine.chart.transitions[*at].number);
        if !self.features.all_conditions || numbered == list {
            return make(list);
        }
        let span = self.engine.span;
        vec![if_then(self.engine.operating("T_PERM", span), make(&numbered), make(list), span)]
    }

    /// Whether a transition fires, if its steps are not left by others.
    fn goes(&self, at: usize, satisfied: Expr) -> Expr {
        let span = self.engine.chart.transitions[at].span;
        let and = |left, right| binary_expr(BinaryOp::And, left, right, Elementary::Bool, span);
        let or = |left, right| binary_expr(BinaryOp::Or, left, right, Elementary::Bool, span);
        let value = |name: &str| super::build::load(self.engine.variable(name), span);
        let mut forced = value("forced");
        if self.features.transition_display {
            let own = u64::from(self.engine.chart.transitions[at].number);
            let shown = compared(CompareOp::Equal, value("T_SHOWN"), own);
            forced = and(forced, or(shown, not(value("still_valid"))));
        }
        if self.parts.from[at].len() > 1 || self.competing.contains(&at) {
            forced = and(forced, self.is_valid(at));
        }
        let mut goes = match self.ordinary {
            true => and(satisfied, value("may")),
            false => or(and(satisfied, value("may")), forced),
        };
        let from = self.parts.from[at].iter();
        let watched = from.filter(|step| self.parts.supervisions[**step].is_some());
        let good: Vec<Expr> = watched.map(|step| not(self.engine.faulty(*step, span))).collect();
        if !good.is_empty() {
            goes = and(goes, or(all(good.into_iter(), span), value("force")));
        }
        if self.features.requests {
            goes = and(goes, self.engine.left.holds_none(&self.parts.from[at], span));
        }
        goes
    }

    /// From one step to another, the most common transition.
    fn is_plain(&self, at: usize) -> bool {
        self.parts.from[at].len() == 1 && self.parts.to[at].len() == 1
    }

    fn fire_or_mark(&self, at: usize) -> Vec<Statement> {
        if self.is_plain(at) { self.fire_plain(at) } else { self.fire(at) }
    }

    /// A transition switches.
    pub fn fire(&self, at: usize) -> Vec<Statement> {
        let engine = self.engine;
        let mut statements = self.mark_fired(at);
        for &step in &self.parts.from[at] {
            let span = engine.chart.transitions[at].span;
            statements.extend(engine.append(&engine.left, "S0X", "left", step, span));
        }
        statements.extend(self.enter(at));
        statements
    }

    /// A plain transition of step `k` switches; the part that is independent of it comes once, after the code of all steps.
    fn fire_plain(&self, at: usize) -> Vec<Statement> {
        let span = self.engine.chart.transitions[at].span;
        let target = number(self.parts.to[at][0] as u64 + 1, Elementary::Dint, span);
        let mut statements = self.mark_fired(at);
        statements.push(assign(self.engine.variable("target"), target, span));
        statements
    }

    /// TS, and the end of a forced transition.
    pub fn mark_fired(&self, at: usize) -> Vec<Statement> {
        let engine = self.engine;
        let span = engine.chart.transitions[at].span;
        let flags = super::build::load(&engine.flags(at), span);
        let flags = binary_expr(BinaryOp::Or, flags, number(4, Elementary::Byte, span), Elementary::Byte, span);
        if self.ordinary {
            return vec![self.set_flags(at, flags)];
        }
        let pushed = match self.features.transition_display {
            true => super::build::load(engine.variable("still_valid"), span),
            false => number(0, Elementary::Bool, span),
        };
        let forced = super::build::load(engine.variable("forced"), span);
        let forced = binary_expr(BinaryOp::And, forced, pushed, Elementary::Bool, span);
        vec![self.set_flags(at, flags), assign(engine.variable("forced"), forced, span)]
    }

    /// Steps that a transition enters, except those that are already entered.
    fn enter(&self, at: usize) -> Vec<Statement> {
        let engine = self.engine;
        let span = engine.chart.transitions[at].span;
        let one = |&step: &usize| {
            let new = engine.entered.holds_none(&[step], span);
            if_then(new, engine.append(&engine.entered, "S1X", "entered", step, span), Vec::new(), span)
        };
        self.parts.to[at].iter().map(one).collect()
    }

    /// A step whose transition is already satisfied is not entered; its successor is.
    fn skip(&self, step: usize) -> Vec<Statement> {
        let mut otherwise = Vec::new();
        let single = self.owned[step].iter().rev().filter(|at| self.parts.from[**at].len() == 1);
        for &at in single {
            let span = self.engine.chart.transitions[at].span;
            let engine = self.engine;
            let mut then = vec![assign(engine.variable("skipped"), number(1, Elementary::Bool, span), span)];
            then.extend(engine.passed.add(step, span));
            then.extend(engine.entered.remove(step, span));
            for &next in &self.parts.to[at] {
                let append = engine.append(&engine.entered, "S1X", "entered", next, span);
                let replaced = super::build::load(engine.variable("replaced"), span);
                let put = if_then(replaced, append, engine.replace(next, span), span);
                then.push(if_then(engine.entered.holds_none(&[next], span), vec![put], Vec::new(), span));
            }
            let (before, value) = self.parts.conditions[at].clone();
            otherwise = before.into_iter().chain([if_then(value, then, otherwise, span)]).collect();
        }
        otherwise
    }

    /// Requests to leave the other steps of the section of the shown step: those that single transitions join.
    fn leave_section(&self) -> Vec<Statement> {
        let steps = self.engine.chart.steps.len();
        let mut section: Vec<usize> = (0..steps).collect();
        let root = |section: &[usize], mut step: usize| {
            while section[step] != step {
                step = section[step];
            }
            step
        };
        for (from, to) in self.parts.from.iter().zip(&self.parts.to) {
            if let ([from], [to]) = (from.as_slice(), to.as_slice()) {
                let (from, to) = (root(&section, *from), root(&section, *to));
                section[from.max(to)] = from.min(to);
            }
        }
        let span = self.engine.span;
        let mut arms = Vec::new();
        for first in (0..steps).filter(|step| root(&section, *step) == *step) {
            let members: Vec<usize> = (0..steps).filter(|step| root(&section, *step) == first).collect();
            let ranges = members.iter().map(|step| (*step as i128 + 1, *step as i128 + 1)).collect();
            let off = |step: &usize| {
                let shown = compared(CompareOp::NotEqual, self.engine.value("SHOWN_AT"), *step as u64 + 1);
                if_then(shown, self.engine.request(*step, false, span), Vec::new(), span)
            };
            arms.push(Arm { ranges, body: members.iter().map(off).collect() });
        }
        let kind = StatementKind::Case { selector: self.engine.value("SHOWN_AT"), arms, otherwise: Vec::new() };
        vec![Statement { kind, span }]
    }
}
