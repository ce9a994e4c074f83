//! All variables that a block in SCL reads, writes or passes on.

use plcc_model::scl::{
    Access, Actual, Base, Body, Call, Complex, Expr, ExprKind, IndexedArea, Instance, Statement, StatementKind,
};

/// Calls `visit` for each access of the block.
pub fn of_body(body: &Body, visit: &mut dyn FnMut(&Access)) {
    of_statements(&body.statements, visit);
}

fn of_statements(statements: &[Statement], visit: &mut dyn FnMut(&Access)) {
    statements.iter().for_each(|statement| of_statement(&statement.kind, visit));
}

fn of_statement(statement: &StatementKind, visit: &mut dyn FnMut(&Access)) {
    match statement {
        StatementKind::Assign { target, value } => {
            of_access(target, visit);
            of_expr(value, visit);
        }
        StatementKind::AssignText { target, value } | StatementKind::Copy { target, source: value, .. } => {
            of_access(target, visit);
            of_complex(value, visit);
        }
        StatementKind::SetFlag(value) | StatementKind::Evaluate(value) => of_expr(value, visit),
        StatementKind::Return(value) => of_optional(value, visit),
        StatementKind::Call(call) => of_call(call, visit),
        StatementKind::If { branches, otherwise } => {
            for (condition, body) in branches {
                of_expr(condition, visit);
                of_statements(body, visit);
            }
            of_statements(otherwise, visit);
        }
        StatementKind::Case { selector, arms, otherwise } => {
            of_expr(selector, visit);
            arms.iter().for_each(|arm| of_statements(&arm.body, visit));
            of_statements(otherwise, visit);
        }
        StatementKind::For { variable, start, end, step, body } => {
            of_access(variable, visit);
            [start, end, step].into_iter().for_each(|value| of_expr(value, visit));
            of_statements(body, visit);
        }
        StatementKind::While { condition, body } | StatementKind::Repeat { body, until: condition } => {
            of_expr(condition, visit);
            of_statements(body, visit);
        }
        StatementKind::Exit
        | StatementKind::Continue
        | StatementKind::Goto(_)
        | StatementKind::Label(_)
        | StatementKind::Assert(_)
        // Networks in STL are handled with all other STL.
        | StatementKind::Sleep(_)
        | StatementKind::Stl(_) => {}
    }
}

fn of_optional(value: &Option<Expr>, visit: &mut dyn FnMut(&Access)) {
    if let Some(value) = value {
        of_expr(value, visit);
    }
}

fn of_expr(expr: &Expr, visit: &mut dyn FnMut(&Access)) {
    match &expr.kind {
        ExprKind::Load(access) => of_access(access, visit),
        ExprKind::Unary { operand, .. } | ExprKind::Convert { operand, .. } => of_expr(operand, visit),
        ExprKind::Binary { left, right, .. } | ExprKind::Compare { left, right, .. } => {
            of_expr(left, visit);
            of_expr(right, visit);
        }
        ExprKind::Call(call) => of_call(call, visit),
        ExprKind::Function { arguments, .. } => arguments.iter().for_each(|argument| of_expr(argument, visit)),
        ExprKind::Timer(call) => {
            [&call.start, &call.value, &call.reset].into_iter().for_each(|value| of_optional(value, visit));
            [&call.q, &call.bi].into_iter().flatten().for_each(|access| of_access(access, visit));
        }
        ExprKind::Counter(call) => {
            let values = [&call.up, &call.down, &call.set, &call.value, &call.reset];
            values.into_iter().for_each(|value| of_optional(value, visit));
            [&call.q, &call.cv].into_iter().flatten().for_each(|access| of_access(access, visit));
        }
        ExprKind::Bound { dimension, .. } => of_expr(dimension, visit),
        ExprKind::Const(_) | ExprKind::Cell { .. } | ExprKind::Flag | ExprKind::LastEno => {}
    }
}

fn of_access(access: &Access, visit: &mut dyn FnMut(&Access)) {
    visit(access);
    access.indices.iter().for_each(|index| of_expr(&index.value, visit));
    let Base::Indexed { area, byte, bit } = &access.base else { return };
    of_expr(byte, visit);
    if let Some(bit) = bit {
        of_expr(bit, visit);
    }
    match area {
        IndexedArea::Memory(_) | IndexedArea::Db(_) => {}
        IndexedArea::DynamicDb(db) => of_expr(db, visit),
        IndexedArea::Coded { area, db } => {
            of_expr(area, visit);
            of_expr(db, visit);
        }
    }
}

fn of_complex(value: &Complex, visit: &mut dyn FnMut(&Access)) {
    match value {
        Complex::Variable(access) => of_access(access, visit),
        Complex::Call(call) => of_call(call, visit),
        Complex::Character(value) => of_expr(value, visit),
        Complex::Const(_) => {}
    }
}

fn of_call(call: &Call, visit: &mut dyn FnMut(&Access)) {
    if let Some(Instance::Variable(access)) = &call.instance {
        of_access(access, visit);
    }
    for argument in &call.arguments {
        match argument.actual.pointer() {
            Actual::Value(value) | Actual::PointerToValue { value, .. } => of_expr(value, visit),
            Actual::Variable { access, .. }
            | Actual::Reference(access)
            | Actual::PointerTo { access, .. }
            | Actual::PointerCopy(access) => of_access(access, visit),
            Actual::Complex(value) | Actual::PointerToComplex { value, .. } => of_complex(value, visit),
            Actual::Number(_) | Actual::PointerBytes(_) | Actual::Variant(..) | Actual::Dropped => {}
        }
    }
    of_optional(&call.enable, visit);
    call.eno.iter().for_each(|access| of_access(access, visit));
}
