//! The walk over the typed tree: code that looks for something in it implements [`Visitor`].
//!
//! Each part is reported before what it contains, except for calls and complex values, whose room in the frame is needed
//! after that of their arguments.

use super::{
    Access, Actual, Base, Call, Complex, CounterCall, Expr, ExprKind, IndexedArea, Instance, Statement, StatementKind,
    TimerCall,
};
use crate::{Assert, Number, Place};

/// How a place is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The value of an elementary variable is read or written.
    Value,
    /// Something else may reach the memory.
    Memory,
}

/// What a walk reports.
pub trait Visitor {
    /// Before each statement, including those inside others.
    fn statement(&mut self, _statement: &Statement) {}
    /// After the parts of the statement itself, before the statements inside it.
    fn own_part_done(&mut self) {}
    /// This many paths meet: after IF and CASE.
    fn paths_meet(&mut self, _paths: usize) {}
    /// Before each expression, including those inside others.
    fn expr(&mut self, _value: &Expr) {}
    /// An access, before its indices.
    fn access(&mut self, _access: &Access, _role: Role) {}
    /// A place that is not an access: a number in memory.
    fn place(&mut self, _place: &Place) {}
    /// A call, after what its arguments contain.
    fn call(&mut self, _call: &Call) {}
    /// A complex value that needs room in the frame, after what it contains.
    fn complex(&mut self, _complex: &Complex) {}
    fn assert(&mut self, _assert: &Assert) {}
}

/// Walks over statements and all that is inside them.
pub fn statements(list: &[Statement], visitor: &mut dyn Visitor) {
    for statement in list {
        visitor.statement(statement);
        own_part(&statement.kind, visitor);
        visitor.own_part_done();
        let bodies = statement.kind.bodies();
        bodies.iter().for_each(|body| statements(body, visitor));
        if matches!(statement.kind, StatementKind::If { .. } | StatementKind::Case { .. }) {
            visitor.paths_meet(bodies.len());
        }
    }
}

/// The first answer of `look` about a statement, or one inside it, in source order.
pub fn find<T>(list: &[Statement], look: &dyn Fn(&Statement) -> Option<T>) -> Option<T> {
    let inside = |statement: &Statement| statement.kind.bodies().into_iter().find_map(|body| find(body, look));
    list.iter().find_map(|statement| look(statement).or_else(|| inside(statement)))
}

impl StatementKind {
    /// The variable that the statement itself writes: of FOR its counter. Calls write their outputs besides.
    pub fn target(&self) -> Option<&Access> {
        match self {
            StatementKind::Assign { target, .. }
            | StatementKind::AssignText { target, .. }
            | StatementKind::Copy { target, .. }
            | StatementKind::For { variable: target, .. } => Some(target),
            StatementKind::SetFlag(_)
            | StatementKind::Failed
            | StatementKind::Watch(_)
            | StatementKind::Call(_)
            | StatementKind::Evaluate(_)
            | StatementKind::If { .. }
            | StatementKind::Case { .. }
            | StatementKind::While { .. }
            | StatementKind::Repeat { .. }
            | StatementKind::Exit
            | StatementKind::Continue
            | StatementKind::Return(_)
            | StatementKind::Goto(_)
            | StatementKind::Label(_)
            | StatementKind::Assert(_)
            | StatementKind::Sleep(_)
            | StatementKind::Apart
            | StatementKind::Stl(_) => None,
        }
    }

    /// The lists of statements inside this one, in source order. IF and CASE always have one for ELSE.
    pub fn bodies(&self) -> Vec<&[Statement]> {
        match self {
            StatementKind::If { branches, otherwise } => {
                branches.iter().map(|(_, body)| body).chain([otherwise]).map(Vec::as_slice).collect()
            }
            StatementKind::Case { arms, otherwise, .. } => {
                arms.iter().map(|arm| &arm.body).chain([otherwise]).map(Vec::as_slice).collect()
            }
            StatementKind::For { body, .. }
            | StatementKind::While { body, .. }
            | StatementKind::Repeat { body, .. } => {
                vec![body]
            }
            StatementKind::Assign { .. }
            | StatementKind::AssignText { .. }
            | StatementKind::Copy { .. }
            | StatementKind::SetFlag(_)
            | StatementKind::Failed
            | StatementKind::Watch(_)
            | StatementKind::Call(_)
            | StatementKind::Evaluate(_)
            | StatementKind::Exit
            | StatementKind::Continue
            | StatementKind::Return(_)
            | StatementKind::Goto(_)
            | StatementKind::Label(_)
            | StatementKind::Assert(_)
            | StatementKind::Sleep(_)
            | StatementKind::Apart
            | StatementKind::Stl(_) => Vec::new(),
        }
    }
}

/// What a statement contains, except for other statements.
pub fn own_part(statement: &StatementKind, visitor: &mut dyn Visitor) {
    match statement {
        StatementKind::Assign { target, value } => {
            access(target, Role::Value, visitor);
            expr(value, visitor);
        }
        StatementKind::AssignText { target, value } | StatementKind::Copy { target, source: value, .. } => {
            access(target, Role::Memory, visitor);
            complex(value, visitor);
        }
        StatementKind::SetFlag(value) | StatementKind::Evaluate(value) => expr(value, visitor),
        StatementKind::Call(value) => call(value, visitor),
        StatementKind::If { branches, .. } => branches.iter().for_each(|(condition, _)| expr(condition, visitor)),
        StatementKind::Case { selector, .. } => expr(selector, visitor),
        StatementKind::For { variable, start, end, step, .. } => {
            access(variable, Role::Value, visitor);
            [start, end, step].into_iter().for_each(|value| expr(value, visitor));
        }
        StatementKind::While { condition, .. } | StatementKind::Repeat { until: condition, .. } => {
            expr(condition, visitor);
        }
        StatementKind::Return(value) => value.iter().for_each(|value| expr(value, visitor)),
        StatementKind::Assert(assert) => visitor.assert(assert),
        StatementKind::Failed
        | StatementKind::Watch(_)
        | StatementKind::Exit
        | StatementKind::Continue
        | StatementKind::Goto(_)
        | StatementKind::Label(_)
        | StatementKind::Sleep(_)
        | StatementKind::Apart
        | StatementKind::Stl(_) => {}
    }
}

/// Walks over an expression and all that is inside it.
pub fn expr(value: &Expr, visitor: &mut dyn Visitor) {
    visitor.expr(value);
    match &value.kind {
        ExprKind::Const(_) | ExprKind::Flag | ExprKind::LastEno => {}
        ExprKind::Load(from) => access(from, Role::Value, visitor),
        ExprKind::Unary { operand, .. } | ExprKind::Convert { operand, .. } => expr(operand, visitor),
        ExprKind::Binary { left, right, .. } | ExprKind::Compare { left, right, .. } => {
            expr(left, visitor);
            expr(right, visitor);
        }
        ExprKind::Call(value) => call(value, visitor),
        ExprKind::Function { arguments, .. } => arguments.iter().for_each(|argument| expr(argument, visitor)),
        ExprKind::Timer(value) => timer(value, visitor),
        ExprKind::Counter(value) => counter(value, visitor),
        ExprKind::Cell { number, .. } => self::number(number, visitor),
        ExprKind::Bound { dimension, .. } => expr(dimension, visitor),
    }
}

fn number(number: &Number, visitor: &mut dyn Visitor) {
    if let Number::Word(place) = number {
        visitor.place(place);
    }
}

fn timer(call: &TimerCall, visitor: &mut dyn Visitor) {
    number(&call.timer, visitor);
    [&call.start, &call.value, &call.reset].into_iter().flatten().for_each(|value| expr(value, visitor));
    [&call.q, &call.bi].into_iter().flatten().for_each(|target| access(target, Role::Value, visitor));
}

fn counter(call: &CounterCall, visitor: &mut dyn Visitor) {
    number(&call.counter, visitor);
    let values = [&call.up, &call.down, &call.set, &call.value, &call.reset];
    values.into_iter().flatten().for_each(|value| expr(value, visitor));
    [&call.q, &call.cv].into_iter().flatten().for_each(|target| access(target, Role::Value, visitor));
}

/// Walks over an access and the expressions of its address.
pub fn access(access: &Access, role: Role, visitor: &mut dyn Visitor) {
    visitor.access(access, role);
    if let Base::Indexed { area, byte, bit } = &access.base {
        match area {
            IndexedArea::Memory(_) | IndexedArea::Db(_) => {}
            IndexedArea::DynamicDb(db) => expr(db, visitor),
            IndexedArea::Coded { area, db } => {
                expr(area, visitor);
                expr(db, visitor);
            }
        }
        expr(byte, visitor);
        bit.iter().for_each(|bit| expr(bit, visitor));
    }
    access.indices.iter().for_each(|index| expr(&index.value, visitor));
}

fn complex(value: &Complex, visitor: &mut dyn Visitor) {
    match value {
        Complex::Variable(from) => access(from, Role::Memory, visitor),
        Complex::Const(_) => {}
        Complex::Call(value) => call(value, visitor),
        Complex::Character(value) => expr(value, visitor),
    }
    visitor.complex(value);
}

fn call(value: &Call, visitor: &mut dyn Visitor) {
    value.enable.iter().for_each(|enable| expr(enable, visitor));
    if let Some(Instance::Variable(instance)) = &value.instance {
        access(instance, Role::Memory, visitor);
    }
    for argument in &value.arguments {
        match argument.actual.pointer() {
            Actual::Value(value) | Actual::PointerToValue { value, .. } => expr(value, visitor),
            // An FB receives and returns copies.
            Actual::Variable { access: variable, .. } if value.instance.is_some() => {
                access(variable, Role::Value, visitor);
            }
            Actual::Variable { access: variable, .. }
            | Actual::Reference(variable)
            | Actual::PointerTo { access: variable, .. }
            | Actual::PointerCopy(variable) => access(variable, Role::Memory, visitor),
            Actual::Complex(value) | Actual::PointerToComplex { value, .. } => complex(value, visitor),
            Actual::Number(value) => number(value, visitor),
            Actual::PointerBytes(_) | Actual::Variant(..) | Actual::Dropped => {}
        }
    }
    value.eno.iter().for_each(|eno| access(eno, Role::Value, visitor));
    visitor.call(value);
}
