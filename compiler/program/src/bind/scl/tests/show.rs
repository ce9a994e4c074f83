//! The bound tree as short text: `(add i INT->DINT(j))`.

use plcc_model::scl::{Access, Base, Complex, Expr, ExprKind, IndexBounds, IndexedArea, Statement, StatementKind};
use plcc_model::{Number, Place};

pub fn statements(list: &[Statement]) -> String {
    list.iter().map(statement).collect::<Vec<_>>().join("; ")
}

fn statement(statement: &Statement) -> String {
    match &statement.kind {
        StatementKind::Assign { target, value } => format!("{} := {}", access(target), expr(value)),
        StatementKind::AssignText { target, value } => format!("{} :=text {}", access(target), complex(value)),
        StatementKind::Copy { target, source, bytes } => {
            format!("{} :={bytes} {}", access(target), complex(source))
        }
        StatementKind::SetFlag(value) => format!("flag := {}", expr(value)),
        StatementKind::Failed => "failed".to_string(),
        StatementKind::Watch(on) => format!("watch {on}"),
        StatementKind::Call(call) => format!("call {}", call.target),
        StatementKind::Evaluate(value) => format!("evaluate {}", expr(value)),
        StatementKind::If { branches, otherwise } => {
            let branches: Vec<String> =
                branches.iter().map(|(test, body)| format!("if {} {{{}}}", expr(test), statements(body))).collect();
            format!("{} else {{{}}}", branches.join(" "), statements(otherwise))
        }
        StatementKind::Case { selector, arms, otherwise } => {
            let arms: Vec<String> =
                arms.iter().map(|arm| format!("{:?} {{{}}}", arm.ranges, statements(&arm.body))).collect();
            format!("case {} {} else {{{}}}", expr(selector), arms.join(" "), statements(otherwise))
        }
        StatementKind::For { variable, start, end, step, body } => format!(
            "for {} := {} to {} by {} {{{}}}",
            access(variable),
            expr(start),
            expr(end),
            expr(step),
            statements(body)
        ),
        StatementKind::While { condition, body } => format!("while {} {{{}}}", expr(condition), statements(body)),
        StatementKind::Repeat { body, until } => format!("repeat {{{}}} until {}", statements(body), expr(until)),
        StatementKind::Exit => "exit".to_string(),
        StatementKind::Continue => "continue".to_string(),
        StatementKind::Return(None) => "return".to_string(),
        StatementKind::Return(Some(value)) => format!("return {}", expr(value)),
        StatementKind::Goto(label) => format!("goto {}", label.0),
        StatementKind::Label(label) => format!("label {}", label.0),
        StatementKind::Assert(assert) => format!("assert {}", assert.text),
        StatementKind::Stl(statement) => format!("stl {:?}", statement.kind),
        StatementKind::Sleep(milliseconds) => format!("sleep {milliseconds}"),
        StatementKind::Apart => "apart".to_string(),
    }
}

pub fn expr(value: &Expr) -> String {
    let ty = value.ty.name();
    match &value.kind {
        ExprKind::Const(bits) => format!("{ty}#{bits}"),
        ExprKind::Load(place) => access(place),
        ExprKind::Unary { op, operand } => format!("({op:?} {})", expr(operand)).to_lowercase(),
        ExprKind::Binary { op, left, right } => format!("({op:?}.{ty} {} {})", expr(left), expr(right)),
        ExprKind::Compare { op, left, right } => {
            format!("({op:?}.{} {} {})", left.ty.name(), expr(left), expr(right))
        }
        ExprKind::Convert { operand, .. } => format!("{}->{ty}({})", operand.ty.name(), expr(operand)),
        ExprKind::Call(call) => format!("{}()", call.target),
        ExprKind::Cell { kind, number: Number::Known(number) } => format!("{kind:?}{number}"),
        ExprKind::Flag => "flag".to_string(),
        ExprKind::Timer(call) => {
            let pins = [("S", &call.start), ("TV", &call.value), ("R", &call.reset)];
            format!("{:?} {}{}", call.kind, number(&call.timer), self::pins(&pins))
        }
        ExprKind::Counter(call) => {
            let pins =
                [("CU", &call.up), ("CD", &call.down), ("S", &call.set), ("PV", &call.value), ("R", &call.reset)];
            format!("counter {}{}", number(&call.counter), self::pins(&pins))
        }
        ExprKind::LastEno => "eno".to_string(),
        other => format!("{other:?}"),
    }
}

fn number(number: &Number) -> String {
    match number {
        Number::Known(number) => number.to_string(),
        other => format!("{other:?}"),
    }
}

fn pins(pins: &[(&str, &Option<Expr>)]) -> String {
    pins.iter().filter_map(|(name, value)| Some(format!(" {name}={}", expr(value.as_ref()?)))).collect()
}

fn complex(value: &Complex) -> String {
    match value {
        Complex::Variable(place) => access(place),
        Complex::Const(bytes) => format!("{bytes:?}"),
        Complex::Call(call) => format!("{}()", call.target),
        Complex::Character(value) => format!("char {}", expr(value)),
    }
}

pub fn access(access: &Access) -> String {
    let mut text = match &access.base {
        Base::Place(place) => self::place(place),
        Base::Indexed { area, byte, bit } => {
            let area = match area {
                IndexedArea::Memory(area) => area.letters().to_string(),
                IndexedArea::Db(number) => format!("DB{number}"),
                IndexedArea::DynamicDb(number) => format!("DB({})", expr(number)),
                IndexedArea::Coded { .. } => "coded".to_string(),
            };
            let bit = bit.as_ref().map_or(String::new(), |bit| format!(".{}", expr(bit)));
            format!("{area}[{}{bit}]", expr(byte))
        }
    };
    for index in &access.indices {
        let bounds = match index.bounds {
            IndexBounds::Known(low, high) => format!("{low}..{high}"),
            IndexBounds::Characters { length, in_head } => {
                format!("characters 1..{length}{}", if in_head { " of the head" } else { "" })
            }
            IndexBounds::Open { parameter, dimension } => format!("{parameter}:{dimension}"),
        };
        text += &format!("[{} in {bounds} by {}]", expr(&index.value), index.stride);
    }
    if let Some(part) = access.part {
        text += &format!(".{:?}{}", part.width, part.index);
    }
    text
}

fn place(place: &Place) -> String {
    match place {
        Place::L { byte, bit } => format!("L{byte}.{bit}"),
        Place::M { byte, bit } => format!("M{byte}.{bit}"),
        Place::I { byte, bit } => format!("I{byte}.{bit}"),
        Place::Db { number, byte, bit } => format!("DB{number}.{byte}.{bit}"),
        Place::Instance { byte, bit } => format!("S{byte}.{bit}"),
        Place::Parameter { parameter, byte, bit } => format!("P{parameter}+{byte}.{bit}"),
        other => format!("{other:?}"),
    }
}
