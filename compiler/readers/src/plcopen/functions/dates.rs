//! Dates of open editors: DATE and DATE_AND_TIME count from 1970, and convert to numbers as seconds. Here both are an LDT, nanoseconds since 1970.

use plcc_diag::{Code, Diagnostic};

use super::{BIT_STRINGS, FLOATS, INTEGERS, Make};
use plcc_syntax::scl::ast::{BinaryOp, Expr, ExprKind};

const SECOND: u64 = 1_000_000_000;
const DAY: u64 = 86_400 * SECOND;

fn is_date(name: &str) -> bool {
    matches!(name, "DATE" | "DT" | "DATE_AND_TIME")
}

/// A standard function of dates; `None`: another function.
pub fn function(make: &Make, upper: &str, values: &[Expr], tell: &mut dyn FnMut(Diagnostic)) -> Option<ExprKind> {
    match (upper, values) {
        ("SUB_DATE_DATE" | "SUB_DT_DT", [left, right]) => return Some(difference(make, left, right, tell)),
        ("CONCAT_DATE_TOD", [date, day]) => {
            let day = make.call("DINT_TO_LINT", make.call("TOD_TO_DINT", day.clone()));
            let day = make.binary(BinaryOp::Multiply, day, make.number(1_000_000));
            return Some(moment(make, make.binary(BinaryOp::Add, nanoseconds(make, date), day)));
        }
        _ => {}
    }
    let (from, to) = upper.split_once("_TO_")?;
    let [value] = values else { return None };
    let is_number = |name: &str| [INTEGERS, BIT_STRINGS, FLOATS].iter().any(|list| list.contains(&name));
    if is_date(from) && is_number(to) {
        let seconds = make.binary(BinaryOp::Divide, nanoseconds(make, value), make.number(SECOND));
        return Some(make.convert("LINT", to, seconds).kind);
    }
    if is_number(from) && is_date(to) && !FLOATS.contains(&from) {
        let seconds = make.convert(from, "LINT", value.clone());
        return Some(moment(make, make.binary(BinaryOp::Multiply, seconds, make.number(SECOND))));
    }
    match (is_date(from), to) {
        (true, "DATE") => {
            let parted = nanoseconds(make, value);
            let rest = make.binary(BinaryOp::Modulo, parted.clone(), make.number(DAY));
            Some(moment(make, make.binary(BinaryOp::Subtract, parted, rest)))
        }
        (true, "DT" | "DATE_AND_TIME") => Some(value.kind.clone()),
        (true, "TOD" | "TIME_OF_DAY") => Some(make.call("LDT_TO_TOD", value.clone()).kind),
        _ => None,
    }
}

/// The TIME between two dates.
pub fn difference(make: &Make, left: &Expr, right: &Expr, tell: &mut dyn FnMut(Diagnostic)) -> ExprKind {
    let text = "a TIME holds 24 days: if the dates are further apart, the difference is wrong";
    let message = Diagnostic::new(Code::Tolerated, make.name, text).label("the difference of dates is a TIME");
    tell(message.help("subtract the numbers of the dates, DATE_TO_DINT(a) - DATE_TO_DINT(b), where they may be"));
    let apart = make.binary(BinaryOp::Subtract, nanoseconds(make, left), nanoseconds(make, right));
    let milliseconds = make.binary(BinaryOp::Divide, apart, make.number(1_000_000));
    make.call("DINT_TO_TIME", make.call("LINT_TO_DINT", milliseconds)).kind
}

fn nanoseconds(make: &Make, date: &Expr) -> Expr {
    make.call("LDT_TO_LINT", date.clone())
}

fn moment(make: &Make, nanoseconds: Expr) -> ExprKind {
    make.call("LINT_TO_LDT", nanoseconds).kind
}
