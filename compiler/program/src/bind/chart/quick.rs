//! The quick way of a call in the ordinary modes, of a chart that monitors and displays nothing: its code, and the charts that have it.
//!
//! The set of active steps is one number, and leads by its bits to the code of each active step, in which the step is a constant. With one
//! active step its transitions, and what each of them writes, follow at once. With several, each step in turn lets time pass, evaluates its
//! transitions, and acts if none of them switches, nor a join that leaves it; a switch comes after that. So the order is not that of the
//! phases. It makes no difference as long as no step uses what the actions of another one write. Steps that do are rivals. Where rivals are
//! active together, and where more transitions switch in one call than two usual ones, the rest of the call goes by the lists. Actions may
//! run there once more, so they must only depend on what they do not change.

use plcc_syntax::Elementary;
use plcc_syntax::chart::ast::Settings;
use rustc_hash::FxHashMap;

use super::alone::{IsShared, is_copyable, is_tame};
use super::assemble::{Assembly, Parts};
use super::build::{assign, if_then, load, number};
use super::engine_data::{Engine, SIGNS, compared};
use super::rivals::Uses;
use crate::bind::scl::expression::binary_expr;
use crate::bind::trees::chart_data::usual_modes;
use plcc_model::Place;
use plcc_model::scl::walk::{self, Visitor};
use plcc_model::scl::{Arm, Base, BinaryOp, CompareOp, Expr, Statement, StatementKind};

/// Up to so many steps the bits of a set are part of instructions, and few groups of them are tested.
const MOST_STEPS: usize = 32;
/// Steps whose bits are tested one by one.
const GROUP: usize = 8;
/// Of these in a group.
const IN_GROUP: usize = 4;
/// Statements of the actions of a step, of what it does when it is left, and of the permanent instructions at the end: each transition has its copy.
const MOST_STATEMENTS: usize = 16;
/// Bits for the number of a transition.
const TARGET_BITS: u32 = 12;

/// True of a chart that can have the quick way, if it has the short way with one loop for times and transitions, and neither monitoring nor displays
/// nor requests. `several`: several steps can be active.
pub fn is_possible(engine: &Engine, parts: &Parts, several: bool, is_shared: &IsShared) -> bool {
    let can_be_there =
        |statements: &Vec<Statement>| is_copyable(statements) && is_tame(statements, engine.data_begin(), is_shared);
    let is_short = |statements: &[Statement]| Count::of(statements) <= MOST_STATEMENTS;
    parts.codes.len() <= MOST_STEPS
        && parts.conditions.len() < 1 << TARGET_BITS
        && parts.codes.iter().all(|code| can_be_there(&code.leave) && is_short(&code.leave) && is_short(&code.active))
        && is_short(&parts.after)
        // Conditions are not evaluated in the order of activation.
        && (!several || parts.conditions.iter().all(|(before, _)| writes_only_local_data(before)) && {
            let uses = Uses::of(engine, parts, is_shared);
            !uses.sees_others && uses.can_be_repeated()
        })
}

/// True if the modes that a chart begins with are ordinary ones, as `quick.scl` asks for them.
pub fn has_usual_modes(settings: &Settings) -> bool {
    usual_modes(settings) & 0x0FC8_0F60 == 0x0100_0200
}

/// Counts statements, also those inside others.
struct Count(usize);

impl Count {
    fn of(statements: &[Statement]) -> usize {
        let mut count = Count(0);
        walk::statements(statements, &mut count);
        count.0
    }
}

impl Visitor for Count {
    fn statement(&mut self, _: &Statement) {
        self.0 += 1;
    }
}

fn writes_only_local_data(statements: &[Statement]) -> bool {
    let elsewhere = |statement: &Statement| match &statement.kind {
        StatementKind::Assign { target, .. } => (!matches!(target.base, Base::Place(Place::L { .. }))).then_some(()),
        _ => None,
    };
    walk::find(statements, &elsewhere).is_none()
}

/// The set of some steps.
fn set_of(steps: &[usize]) -> u64 {
    steps.iter().fold(0, |set, step| set | 1 << step)
}

impl Assembly<'_, '_> {
    /// The code for the placeholders of the quick way.
    pub fn quick_holes(&self, holes: &mut FxHashMap<&'static str, Vec<Statement>>, is_shared: &IsShared) {
        let engine = self.engine;
        let span = engine.span;
        let steps: Vec<usize> = (0..engine.chart.steps.len()).collect();
        self.usual_holes(holes);
        holes.insert("take_active", vec![self.put("mask", load(engine.active_word(), span))]);
        let one_less = self.numbers(BinaryOp::Subtract, engine.value("mask"), self.set(1));
        let rest = self.numbers(BinaryOp::And, engine.value("mask"), one_less);
        holes.insert("is_single", vec![self.put("single", compared(CompareOp::Equal, rest, 0))]);
        let signs = self.numbers(BinaryOp::And, engine.value("step"), self.set(SIGNS));
        holes.insert("is_forward", vec![self.put("forward", compared(CompareOp::Equal, signs, 0))]);
        holes.insert("quick_one", self.one_of(&steps, &|step| self.quick_one(step)));
        let end = |step: usize| {
            let events = assign(&engine.raw(step).events, number(0, Elementary::Byte, span), span);
            std::iter::once(events).chain(self.forget(step)).collect()
        };
        holes.insert("end_one", self.case("k", &end));
        if !self.features.several {
            return;
        }
        let uses = Uses::of(engine, &self.parts, is_shared);
        let rivals = uses.rivals(steps.len());
        let has_twin = uses.leave_together(steps.len());
        let mut ways = vec![0; steps.len()];
        self.parts.to.iter().flatten().for_each(|step| ways[*step] += 1);
        // Two of these can switch in one call, in any order.
        let is_usual = |at: usize| {
            let ([from], [to]) = (self.parts.from[at].as_slice(), self.parts.to[at].as_slice()) else { return false };
            ways[*to] == 1 && from != to && rivals[*to] == 0 && !has_twin[*from]
        };
        holes.insert("find_rivals", self.find_rivals(rivals.clone()));
        // `timed` by the name of its place.
        let mut to_lists = engine.leave_short_way(&["step", "register", "left", "target"]);
        to_lists.push(engine.passed_of_pair());
        holes.insert("to_lists", to_lists);
        holes.insert("each_step", self.each_of(&steps, &|step| self.each_step(step, &rivals, &is_usual)));
        let arms = (0..self.parts.to.len()).filter(|at| !self.parts.from[*at].is_empty()).map(|at| {
            let place = at as i128 + 1;
            Arm { ranges: vec![(place, place)], body: self.switch_one(at) }
        });
        let kind =
            StatementKind::Case { selector: engine.value("target"), arms: arms.collect(), otherwise: Vec::new() };
        holes.insert("switch_one", vec![Statement { kind, span }]);
        let above = self.places(BinaryOp::ShiftRight, engine.value("target"), TARGET_BITS);
        let last = number((1 << TARGET_BITS) - 1, Elementary::Dint, span);
        let last = binary_expr(BinaryOp::And, engine.value("target"), last, Elementary::Dint, span);
        holes.insert("split_targets", vec![self.put("other", last), self.put("target", above)]);
        let place = number(1, Elementary::Dint, span);
        let place = binary_expr(BinaryOp::Subtract, engine.value("k"), place, Elementary::Dint, span);
        let bit = self.numbers(BinaryOp::ShiftLeft, self.set(1), place);
        let stays = self.numbers(BinaryOp::And, engine.value("rest"), bit);
        holes.insert("stays", vec![self.put("known", compared(CompareOp::NotEqual, stays, 0))]);
    }

    /// Whether nobody has changed the modes: MOP, OLD and the bits that follow it are what they were at the beginning, as one number each.
    fn usual_holes(&self, holes: &mut FxHashMap<&'static str, Vec<Statement>>) {
        /// OLD with STARTED, REQUESTED, ALL_WERE and EVENTFUL; what these are in an ordinary call, and what EVENTFUL adds.
        const ASKED: u64 = 0xFFFF_FFFF_1B00_0000;
        const CALM: u64 = 0x0100_0000;
        const EVENTFUL: u64 = 0x1000_0000;
        let engine = self.engine;
        let usual = u64::from(usual_modes(&engine.chart.settings));
        let is = |name: &str, value: u64| compared(CompareOp::Equal, engine.value(name), value);
        holes.insert("modes_are_usual", vec![self.put("known", is("MOP_D", usual))]);
        holes.insert("modes_and_edges_are_usual", vec![self.put("known", is("MOPS", usual))]);
        let noted = |bits: u64| {
            let mask = number(ASKED, Elementary::Lword, engine.span);
            let asked = binary_expr(BinaryOp::And, engine.value("MODES"), mask, Elementary::Lword, engine.span);
            compared(CompareOp::Equal, asked, usual << 32 | bits)
        };
        holes.insert("is_calm", vec![self.put("known", noted(CALM))]);
        holes.insert("is_eventful", vec![self.put("known", noted(CALM | EVENTFUL))]);
    }

    fn put(&self, name: &str, value: Expr) -> Statement {
        assign(self.engine.variable(name), value, self.engine.span)
    }

    fn set(&self, bits: u64) -> Expr {
        number(bits, Elementary::Ulint, self.engine.span)
    }

    /// A DINT shifted.
    fn places(&self, op: BinaryOp, value: Expr, places: u32) -> Expr {
        let span = self.engine.span;
        binary_expr(op, value, number(places.into(), Elementary::Dint, span), Elementary::Dint, span)
    }

    fn numbers(&self, op: BinaryOp, left: Expr, right: Expr) -> Expr {
        binary_expr(op, left, right, Elementary::Ulint, self.engine.span)
    }

    /// The steps of a set that are active.
    fn active_of(&self, set: u64) -> Expr {
        self.numbers(BinaryOp::And, self.engine.value("mask"), self.set(set))
    }

    fn is_any_active(&self, set: u64) -> Expr {
        compared(CompareOp::NotEqual, self.active_of(set), 0)
    }

    /// The code of the one of these steps that is active.
    fn one_of(&self, steps: &[usize], make: &dyn Fn(usize) -> Vec<Statement>) -> Vec<Statement> {
        match steps {
            [] => Vec::new(),
            [step] => make(*step),
            _ => {
                let (first, second) = steps.split_at(steps.len() / 2);
                let (then, otherwise) = (self.one_of(first, make), self.one_of(second, make));
                vec![if_then(self.is_any_active(set_of(first)), then, otherwise, self.engine.span)]
            }
        }
    }

    /// The code of each of these steps that is active.
    fn each_of(&self, steps: &[usize], make: &dyn Fn(usize) -> Vec<Statement>) -> Vec<Statement> {
        let span = self.engine.span;
        let one = |step: &usize| if_then(self.is_any_active(1 << step), make(*step), Vec::new(), span);
        if steps.len() <= GROUP {
            return steps.iter().map(one).collect();
        }
        let group = |steps: &[usize]| {
            if_then(self.is_any_active(set_of(steps)), steps.iter().map(one).collect(), Vec::new(), span)
        };
        steps.chunks(IN_GROUP).map(group).collect()
    }

    /// Events of an active step end, and time passes.
    fn pass(&self, step: usize) -> Vec<Statement> {
        let engine = self.engine;
        let span = engine.span;
        let raw = engine.raw(step);
        let value = |name: &str| engine.value(name);
        let signs = self.numbers(BinaryOp::Or, value("both"), value("later"));
        let is_usual = compared(CompareOp::Equal, self.numbers(BinaryOp::And, signs, self.set(SIGNS)), 0);
        let usual = assign(&raw.times, value("later"), span);
        let mut one_by_one = engine.count_separately();
        one_by_one.push(usual.clone());
        vec![
            assign(&raw.events, number(0, Elementary::Byte, span), span),
            self.put("both", load(&raw.times, span)),
            self.put("later", self.numbers(BinaryOp::Add, value("both"), value("step"))),
            if_then(is_usual, vec![usual], one_by_one, span),
        ]
    }

    fn flags(&self, at: usize, flags: u64) -> Statement {
        self.set_flags(at, number(flags, Elementary::Byte, self.engine.chart.transitions[at].span))
    }

    /// The transitions of an active step, in order: what the first one that is satisfied does, and what the step does if none is.
    fn transitions(
        &self,
        step: usize,
        fire: &dyn Fn(usize) -> Vec<Statement>,
        otherwise: Option<Vec<Statement>>,
    ) -> Vec<Statement> {
        let span = self.engine.chart.steps[step].span;
        let owned = self.owned[step].as_slice();
        // Of several active steps.
        let can_join = otherwise.is_some();
        let mut otherwise = otherwise.unwrap_or_default();
        let mut statements = Vec::new();
        let mut branches = Vec::new();
        for (place, &at) in owned.iter().enumerate() {
            let from = &self.parts.from[at];
            let is_join = from.len() > 1;
            if is_join && !can_join {
                statements.push(self.flags(at, 0));
                continue;
            }
            let (before, value) = self.parts.conditions[at].clone();
            if let ([_], false) = (owned, is_join) {
                statements.extend(before);
                otherwise.insert(0, self.flags(at, 1));
                statements.push(if_then(value, fire(at), otherwise, span));
                return statements;
            }
            let result = &self.results[place];
            let mut own = before;
            own.push(assign(result, value, span));
            own.push(if_then(load(result, span), vec![self.flags(at, 3)], vec![self.flags(at, 1)], span));
            if is_join {
                let set = set_of(from);
                let are_active = compared(CompareOp::Equal, self.active_of(set), set);
                let none = vec![assign(result, number(0, Elementary::Bool, span), span), self.flags(at, 0)];
                statements.push(if_then(are_active, own, none, span));
            } else {
                statements.extend(own);
            }
            branches.push((load(result, span), fire(at)));
        }
        match branches.is_empty() {
            true => statements.extend(otherwise),
            false => statements.push(Statement { kind: StatementKind::If { branches, otherwise }, span }),
        }
        statements
    }

    /// Phases 3 to 9 of the only active step.
    fn quick_one(&self, step: usize) -> Vec<Statement> {
        let mut statements = vec![self.put("alone", self.place(step))];
        statements.extend(self.pass(step));
        statements.extend(self.transitions(step, &|at| self.switch_single(step, at), None));
        statements
    }

    /// A transition of the only active step switches.
    fn switch_single(&self, step: usize, at: usize) -> Vec<Statement> {
        let engine = self.engine;
        let to = self.parts.to[at].as_slice();
        let mut statements = self.switch(&[step], at);
        statements.push(assign(engine.active_word(), self.set(set_of(to)), engine.span));
        statements.extend(self.list("SAX", to));
        statements.push(self.put("NOTES", number(0x11, Elementary::Byte, engine.span)));
        if let [to] = to {
            statements.push(self.put("alone", self.place(*to)));
        } else {
            statements.push(self.put("alone", number(0, Elementary::Dint, engine.span)));
            statements.extend(to.iter().flat_map(|step| self.ordinary_actions(*step)));
            statements.push(self.put("empty", number(to.is_empty().into(), Elementary::Bool, engine.span)));
        }
        statements
    }

    /// Whether rivals are active together. Steps with many rivals come first, so that few are asked.
    fn find_rivals(&self, mut rivals: Vec<u64>) -> Vec<Statement> {
        let span = self.engine.span;
        let mut statements = Vec::new();
        loop {
            let (step, own) = match rivals.iter().copied().enumerate().max_by_key(|(_, own)| own.count_ones()) {
                Some((step, own)) if own != 0 => (step, own),
                _ => return statements,
            };
            let found = self.put("known", number(1, Elementary::Bool, span));
            // Mostly one test is enough, which one AND would not be.
            let are_others = if_then(self.is_any_active(own), vec![found], Vec::new(), span);
            statements.push(if_then(self.is_any_active(1 << step), vec![are_others], Vec::new(), span));
            rivals[step] = 0;
            rivals.iter_mut().for_each(|others| *others &= !(1 << step));
        }
    }

    /// Phases 3 to 7 of one of several active steps, and its actions if it is not left.
    fn each_step(&self, step: usize, rivals: &[u64], is_usual: &dyn Fn(usize) -> bool) -> Vec<Statement> {
        let engine = self.engine;
        let more = |count: u64| {
            let count = number(count, Elementary::Dint, engine.span);
            self.put("left", binary_expr(BinaryOp::Add, engine.value("left"), count, Elementary::Dint, engine.span))
        };
        let fire = |at: usize| {
            let target = number(at as u64 + 1, Elementary::Dint, engine.span);
            let count = more(if is_usual(at) { 4 } else { 3 });
            let before = self.places(BinaryOp::ShiftLeft, engine.value("target"), TARGET_BITS);
            let target = binary_expr(BinaryOp::Or, before, target, Elementary::Dint, engine.span);
            let mut statements = vec![self.flags(at, 3), count, self.put("target", target)];
            // One that is active already begins again; others must act in order with the new ones.
            let to = &self.parts.to[at];
            let entered = to.iter().fold(set_of(to), |set, step| set | rivals[*step]) & !set_of(&self.parts.from[at]);
            if entered != 0 {
                statements.push(if_then(self.is_any_active(entered), vec![more(64)], Vec::new(), engine.span));
            }
            statements
        };
        let mut statements = self.pass(step);
        statements.extend(self.transitions(step, &fire, Some(self.actions_unless_joined(step))));
        statements
    }

    /// What a step does if it is not left. A join has been evaluated by the first of the steps that it leaves: the others ask whether it switches.
    /// Steps of a join have no other transition.
    fn actions_unless_joined(&self, step: usize) -> Vec<Statement> {
        let engine = self.engine;
        let actions = self.ordinary_actions(step);
        let is_joined =
            |from: &[usize]| from.len() > 1 && from.contains(&step) && from.iter().any(|other| *other < step);
        let join = self.parts.from.iter().position(|from| is_joined(from));
        let Some(at) = join.filter(|_| !actions.is_empty()) else { return actions };
        // Its flags are of this call only if all its steps are active, which is asked last: mostly the flags are enough.
        let set = set_of(&self.parts.from[at]);
        let are_active = compared(CompareOp::Equal, self.active_of(set), set);
        let switches = compared(CompareOp::Equal, load(&engine.flags(at), engine.span), 3);
        let unless_active = if_then(are_active, Vec::new(), actions.clone(), engine.span);
        vec![if_then(switches, vec![unless_active], actions, engine.span)]
    }

    /// The only transition that switches, with several active steps. The list of active steps is made later.
    fn switch_one(&self, at: usize) -> Vec<Statement> {
        let engine = self.engine;
        let (from, to) = (self.parts.from[at].as_slice(), self.parts.to[at].as_slice());
        let place = |name: &str, place: usize| self.put(name, number(place as u64, Elementary::Dint, engine.span));
        let rest = self.active_of(!set_of(from));
        let mut statements = vec![self.put("rest", rest)];
        statements.extend(self.switch(from, at));
        let after = self.numbers(BinaryOp::Or, engine.value("rest"), self.set(set_of(to)));
        statements.push(assign(engine.active_word(), after, engine.span));
        statements.extend(to.iter().flat_map(|step| self.ordinary_actions(*step)));
        match (from, to) {
            ([from], [to]) => statements.extend([place("k", from + 1), place("target", to + 1), place("entered", 0)]),
            _ => {
                let none = compared(CompareOp::Equal, engine.value("rest"), 0);
                let mut whole_list = self.list("SAX", to);
                let is_empty = number(to.is_empty().into(), Elementary::Bool, engine.span);
                whole_list.extend([self.put("empty", is_empty), place("entered", 2)]);
                statements.extend([place("k", 0), place("target", 0)]);
                statements.push(if_then(none, whole_list, vec![place("entered", 1)], engine.span));
            }
        }
        statements
    }

    /// What a transition writes that leaves these steps, without the set and the list of active steps.
    fn switch(&self, from: &[usize], at: usize) -> Vec<Statement> {
        // Events and states: S0, and of the states LS, which stays; S1, and X with LS; both events.
        const LEFT: u64 = 0x2040;
        const ENTERED: u64 = 0x0141;
        const LEFT_AND_ENTERED: u64 = 0x2141;
        let engine = self.engine;
        let span = engine.chart.transitions[at].span;
        let to = &self.parts.to[at];
        let heads =
            |step: usize, value: u64| assign(&engine.raw(step).heads, number(value, Elementary::Word, span), span);
        let mut statements = vec![self.flags(at, 7)];
        statements.extend(self.list("S0X", from));
        statements.extend(self.list("S1X", to));
        for &step in from {
            statements.push(heads(step, LEFT));
            statements.extend(self.parts.codes[step].leave.iter().cloned());
        }
        for &step in to {
            statements.push(heads(step, if from.contains(&step) { LEFT_AND_ENTERED } else { ENTERED }));
            statements.push(assign(&engine.raw(step).times, number(0, Elementary::Ulint, span), span));
        }
        statements
    }

    /// A list with these steps: the first free place, the steps, 0.
    fn list(&self, name: &str, steps: &[usize]) -> Vec<Statement> {
        let head = std::iter::once(steps.len() as u8 + 1);
        let bytes: Vec<u8> = head.chain(steps.iter().map(|step| *step as u8 + 1)).chain([0]).collect();
        let mut statements = Vec::new();
        let mut at = 0;
        while at < bytes.len() {
            let (length, ty) = match bytes.len() - at {
                8.. => (8, Elementary::Ulint),
                4.. => (4, Elementary::Dword),
                2.. => (2, Elementary::Word),
                _ => (1, Elementary::Byte),
            };
            let value = bytes[at..at + length].iter().fold(0, |value, byte| value << 8 | u64::from(*byte));
            let part = self.engine.part(name, at as u32, ty);
            statements.push(assign(&part, number(value, ty, self.engine.span), self.engine.span));
            at += length;
        }
        statements
    }
}
