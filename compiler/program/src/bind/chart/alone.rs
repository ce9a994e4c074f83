//! The short way of a call with one active step: its code, and the charts that have it.
//!
//! On the short way a step is a constant in each arm of `one();`, and a transition from one step to another writes all that changes
//! at known addresses. The step is read from the list once. So nothing that runs between may change the data of the chart from outside:
//! code of its conditions, and what is written at the end of an event and of a step. Actions come last and may do what they like.

use plcc_diag::Span;
use plcc_syntax::Elementary;

use super::assemble::{Assembly, Condition, Parts};
use super::build::{assign, if_then, load, number};
use super::engine_data::{Engine, elements, own_names};
use crate::bind::declarations::path::Variable;
use crate::bind::scl::expression::binary_expr;
use plcc_model::scl::walk::{self, Role, Visitor};
use plcc_model::scl::{Access, Base, BinaryOp, Call, Complex, Conversion, Expr, ExprKind, Statement, StatementKind};
use plcc_model::types::DataType;
use plcc_model::{Assert, Place};

/// What the short way hands over when it is left in the middle.
pub const SHARED: [&str; 7] = ["left", "entered", "count", "may", "still_valid", "first_valid", "valid"];

/// Whether a DB is shared, if it is known.
pub type IsShared<'a> = dyn Fn(u16) -> Option<bool> + 'a;

/// True of a chart whose conditions and ends of events leave the data of charts alone, and whose actions can be there twice.
pub fn is_possible(engine: &Engine, parts: &Parts, competing: &[usize], is_shared: &IsShared) -> bool {
    let tame = |statements: &[Statement]| is_tame(statements, engine.data_begin(), is_shared);
    let is_plain = |(before, value): &Condition| {
        let value = StatementKind::SetFlag(value.clone());
        tame(before) && tame(&[Statement { kind: value, span: engine.span }])
    };
    let watched = parts.interlocks.iter().chain(&parts.supervisions).flatten();
    competing.is_empty()
        && watched.chain(&parts.conditions).all(is_plain)
        && tame(&parts.before)
        && is_copyable(&parts.before)
        && parts.codes.iter().all(|code| tame(&code.expire) && is_copyable(&code.active))
}

/// True of a chart in which nothing that happens at the end of an event, and no condition, sees the time of a step or what else a call
/// stores about it: then a step's transitions can be evaluated before the time of the next step passes.
pub fn is_independent(engine: &Engine, parts: &Parts, is_shared: &IsShared) -> bool {
    let is_apart = |(before, value): &Condition| {
        let mut look = Reads { apart: true, begin: engine.data_begin(), is_shared };
        walk::statements(before, &mut look);
        walk::expr(value, &mut look);
        look.apart
    };
    parts.conditions.iter().all(is_apart) && parts.codes.iter().all(|code| code.expire.is_empty())
}

/// True if no action can change the modes.
pub fn has_tame_actions(engine: &Engine, parts: &Parts, is_shared: &IsShared) -> bool {
    parts.codes.iter().all(|code| is_tame(&code.active, engine.data_begin(), is_shared))
}

/// Whether tame statements read nothing that a chart keeps. `begin`: where its data begins.
struct Reads<'a> {
    apart: bool,
    begin: u32,
    is_shared: &'a IsShared<'a>,
}

impl Visitor for Reads<'_> {
    fn access(&mut self, access: &Access, _: Role) {
        self.apart &= match &access.base {
            Base::Place(Place::Instance { byte, .. }) => *byte < self.begin,
            Base::Place(Place::Db { number, .. }) => (self.is_shared)(*number) == Some(true),
            Base::Place(Place::I { .. } | Place::Q { .. } | Place::M { .. } | Place::L { .. }) => true,
            Base::Place(_) | Base::Indexed { .. } => false,
        };
    }
}

/// True of statements that can be there twice.
pub fn is_copyable(statements: &[Statement]) -> bool {
    let unique = |statement: &Statement| {
        matches!(statement.kind, StatementKind::Label(_) | StatementKind::Stl(_) | StatementKind::Assert(_))
            .then_some(())
    };
    walk::find(statements, &unique).is_none()
}

/// True of statements that only compute, cannot fail and write nothing that a chart keeps. `begin`: where the data of the chart begins.
pub fn is_tame(statements: &[Statement], begin: u32, is_shared: &IsShared) -> bool {
    let mut look = Look { tame: true, begin, is_shared };
    walk::statements(statements, &mut look);
    look.tame
}

struct Look<'a> {
    tame: bool,
    begin: u32,
    is_shared: &'a IsShared<'a>,
}

impl Look<'_> {
    fn can_write(&self, target: &Access) -> bool {
        match &target.base {
            Base::Place(Place::Instance { byte, .. }) => *byte < self.begin,
            Base::Place(Place::Db { number, .. }) => (self.is_shared)(*number) == Some(true),
            Base::Place(Place::I { .. } | Place::Q { .. } | Place::M { .. } | Place::L { .. }) => true,
            Base::Place(_) | Base::Indexed { .. } => false,
        }
    }
}

impl Visitor for Look<'_> {
    fn statement(&mut self, statement: &Statement) {
        self.tame &= match &statement.kind {
            StatementKind::Assign { target, .. } => self.can_write(target),
            StatementKind::If { .. } | StatementKind::SetFlag(_) => true,
            _ => false,
        };
    }

    fn expr(&mut self, value: &Expr) {
        self.tame &= !matches!(
            value.kind,
            ExprKind::Call(_)
                | ExprKind::Timer(_)
                | ExprKind::Counter(_)
                | ExprKind::Bound { .. }
                | ExprKind::Convert { conversion: Conversion::FromBcd { fault: true }, .. }
        );
    }

    fn access(&mut self, access: &Access, role: Role) {
        let is_there = match &access.base {
            Base::Place(
                Place::I { .. } | Place::Q { .. } | Place::M { .. } | Place::L { .. } | Place::Instance { .. },
            ) => true,
            Base::Place(Place::Db { number, .. }) => (self.is_shared)(*number).is_some(),
            Base::Place(_) | Base::Indexed { .. } => false,
        };
        self.tame &= is_there && role == Role::Value && access.indices.is_empty();
    }

    fn place(&mut self, _: &Place) {
        self.tame = false;
    }

    fn call(&mut self, _: &Call) {
        self.tame = false;
    }

    fn complex(&mut self, _: &Complex) {
        self.tame = false;
    }

    fn assert(&mut self, _: &Assert) {
        self.tame = false;
    }
}

impl Assembly<'_, '_> {
    /// The usual transition, from one step to another, does phases 7 to 9 in place, without monitoring; any other one enters the lists of
    /// steps to leave and to enter.
    pub fn fire_alone(&self, at: usize, is_shared: &IsShared) -> Vec<Statement> {
        let ([from], [to]) = (self.parts.from[at].as_slice(), self.parts.to[at].as_slice()) else {
            return self.fire(at);
        };
        let leave = &self.parts.codes[*from].leave;
        if !is_copyable(leave) || !is_tame(leave, self.engine.data_begin(), is_shared) {
            return self.fire(at);
        }
        let span = self.engine.chart.transitions[at].span;
        let switch = self.switch_alone(at, *from, *to);
        match from == to {
            true => switch,
            // Written from outside, it could be active without being in the list.
            false => vec![if_then(self.engine.is_marked(*to, span), self.fire(at), switch, span)],
        }
    }

    /// The position of a step, a DINT.
    pub fn place(&self, step: usize) -> Expr {
        number(step as u64 + 1, Elementary::Dint, self.engine.span)
    }

    fn switch_alone(&self, at: usize, from: usize, to: usize) -> Vec<Statement> {
        let engine = self.engine;
        let span = engine.chart.transitions[at].span;
        let put = |list: &str, place: usize, value: usize| {
            let place = &elements(engine.variable(list))[place];
            assign(place, number(value as u64, Elementary::Byte, span), span)
        };
        // The first two elements of a list, which has one step.
        let head = |list: &str, step: usize| {
            assign(engine.variable(list), number(0x200 + step as u64 + 1, Elementary::Word, span), span)
        };
        let mask = |variable: &Variable, op: BinaryOp, mask: u64| {
            let mask = number(mask, Elementary::Byte, span);
            assign(variable, binary_expr(op, load(variable, span), mask, Elementary::Byte, span), span)
        };
        let (left, entered) = (engine.raw(from), engine.raw(to));
        let mut statements = self.mark_fired(at);
        statements.extend([put("S0X", 1, from + 1), put("S1X", 1, to + 1)]);
        statements.push(mask(&left.states, BinaryOp::And, 0xC0));
        statements.push(match self.features.monitoring {
            true => mask(&left.events, BinaryOp::Or, 0x20),
            // Those of the last call have ended.
            false => assign(&left.events, number(0x20, Elementary::Byte, span), span),
        });
        statements.extend(engine.set_active(from, false, span));
        statements.extend(self.parts.codes[from].leave.iter().cloned());
        statements.push(assign(&entered.states, number(0x41, Elementary::Byte, span), span));
        statements.extend(engine.set_active(to, true, span));
        statements.push(mask(&entered.events, BinaryOp::Or, 0x01));
        statements.push(assign(&entered.times, number(0, Elementary::Ulint, span), span));
        statements.extend([head("SAX_HEAD", to), head("S0X_HEAD", from), head("S1X_HEAD", to)]);
        statements.extend(["SAX", "S0X", "S1X"].map(|list| put(list, 2, 0)));
        statements.push(assign(engine.variable("alone"), self.place(to), span));
        if self.features.monitoring {
            statements.push(assign(engine.variable("replaced"), number(1, Elementary::Bool, span), span));
        }
        statements
    }

    /// Phase 5 of the only active step; without monitoring also phases 7 to 9.
    pub fn one(&self, step: usize, is_shared: &IsShared) -> Vec<Statement> {
        // A constant in each arm: `act_alone();` follows without another jump by the step.
        let alone = assign(self.engine.variable("alone"), self.place(step), self.engine.span);
        let evaluated = self.evaluate_with(step, &|at| self.fire_alone(at, is_shared));
        std::iter::once(alone).chain(evaluated).collect()
    }

    /// Phase 7 of the only active step.
    pub fn select_alone(&self, step: usize, is_shared: &IsShared) -> Vec<Statement> {
        self.select_with(step, &|at| self.fire_alone(at, is_shared))
    }
}

/// A step as whole bytes and numbers.
pub struct RawStep {
    /// Events and states together.
    pub heads: Variable,
    pub events: Variable,
    pub states: Variable,
    /// T and U as one number.
    pub times: Variable,
}

impl Engine<'_> {
    /// Leaves the short way. What follows is a function of its own, in which variables are as at the beginning, except those that are `kept`: it gets
    /// nothing that the short way has computed.
    pub fn leave_short_way(&self, kept: &[&str]) -> Vec<Statement> {
        let zero = |name: &str| {
            let variable = self.variable(name);
            let ty = match &variable.ty {
                DataType::Elementary(ty) => *ty,
                _ => Elementary::Bool,
            };
            assign(variable, number(0, ty, self.span), self.span)
        };
        let apart = Statement { kind: StatementKind::Apart, span: self.span };
        let names = own_names().filter(|name| !kept.contains(name));
        std::iter::once(apart).chain(names.map(zero)).collect()
    }

    /// Whether X of a step is set.
    fn is_marked(&self, step: usize, span: Span) -> Expr {
        load(&self.component(step, "X"), span)
    }
}
