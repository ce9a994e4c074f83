//! Loops in SCL whose variable, or a sum with it, is an index beyond the bounds of an array: `FOR i := 0 TO 10` and `ARRAY[0..9]`.
//!
//! Only statements that each pass reaches count, in loops with constant limits that nothing leaves.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::{Access, BinaryOp, Conversion, Expr, ExprKind, IndexBounds, Statement, StatementKind, walk};

use super::region::Bits;
use super::tree::known;
use crate::bind::scl::constant;

/// Reports the loops in `list` and in the lists inside it. `text`: what is written at a place.
pub fn review(list: &[Statement], text: &dyn Fn(Span) -> String, found: &mut Vec<Diagnostic>) {
    for statement in list {
        if let StatementKind::For { variable, start, end, step, body } = &statement.kind
            && let (Some(start), Some(end), Some(step)) = (known(start), known(end), known(step))
            && (step > 0 && start <= end || step < 0 && start >= end)
            && let Some(counted) = Bits::of(variable).filter(|_| variable.indices.is_empty())
            && walk::find(body, &|one| leads_away(one).then_some(())).is_none()
        {
            let last = start + (end - start) / step * step;
            let mut used = Used { counted, low: start.min(last), high: start.max(last), guard: None, beyond: None };
            used.passed(body);
            if let Some(Beyond { index, offset, low, high, is_text, guard }) = used.beyond {
                let within = |value: i128| (value + offset).clamp(low, high) - offset;
                // `FOR #i := 0 TO 9` for 1 to 10: all are meant.
                let is_shifted = offset == 0 && (last - start).abs() == high - low;
                let (from, to) = match step {
                    1 if is_shifted => (low - offset, high - offset),
                    -1 if is_shifted => (high - offset, low - offset),
                    _ => (within(start), within(last)),
                };
                let by = if step == 1 { String::new() } else { format!(" BY {step}") };
                let (title, parts, longer) = match is_text {
                    true => ("the loop goes beyond the characters of this text", "characters", "a longer text"),
                    false => {
                        ("the loop goes beyond the bounds of this array", "elements", "the array with more elements")
                    }
                };
                let name = text(variable.span);
                let help = match guard {
                    Some(sign) => format!("compare `{name}` in an IF of its own: {sign} computes both sides"),
                    None => format!("write `FOR {name} := {from} TO {to}{by} DO`, or declare {longer}"),
                };
                found.push(
                    Diagnostic::new(Code::IndexOfLoop, index, title)
                        .label(format!("{} to {}, but the {parts} are {low} to {high}", start + offset, last + offset))
                        .also(statement.span, "the loop")
                        .help(help),
                );
            }
        }
        statement.kind.bodies().into_iter().for_each(|body| review(body, text, found));
    }
}

/// A statement after which a pass may not reach the next one.
fn leads_away(statement: &Statement) -> bool {
    matches!(
        statement.kind,
        StatementKind::Exit
            | StatementKind::Continue
            | StatementKind::Return(_)
            | StatementKind::Goto(_)
            | StatementKind::Label(_)
    )
}

/// Looks for an array with the variable of a loop as its index.
struct Used {
    /// The variable.
    counted: Bits,
    /// Its values.
    low: i128,
    high: i128,
    /// Where it looks now, this operator joins a comparison of the variable with the rest.
    guard: Option<&'static str>,
    beyond: Option<Beyond>,
}

/// The first index that goes beyond its array or text.
struct Beyond {
    index: Span,
    /// What it adds to the variable.
    offset: i128,
    low: i128,
    high: i128,
    is_text: bool,
    guard: Option<&'static str>,
}

impl Used {
    /// The statements that each pass reaches.
    fn passed(&mut self, list: &[Statement]) {
        for statement in list {
            match &statement.kind {
                // A condition may keep the index within the bounds.
                StatementKind::If { branches, .. } => {
                    if let Some((condition, _)) = branches.first() {
                        self.guard = self.guard(condition);
                        walk::expr(condition, self);
                        self.guard = None;
                    }
                }
                StatementKind::For { start, end, step, body, .. } => {
                    walk::own_part(&statement.kind, self);
                    if let (Some(start), Some(end), Some(step)) = (known(start), known(end), known(step))
                        && (step > 0 && start <= end || step < 0 && start >= end)
                    {
                        self.passed(body);
                    }
                }
                // EN may keep a call from reading its parameters.
                StatementKind::Call(call) if call.enable.is_some() => {}
                other => walk::own_part(other, self),
            }
        }
    }

    /// The operator that joins a comparison of the variable with the rest of a condition, as in `i < 9 AND a[i + 1] > 0`. It computes both
    /// sides, so the comparison does not keep the index within the bounds.
    fn guard(&self, condition: &Expr) -> Option<&'static str> {
        let ExprKind::Binary { op, left, right } = &condition.kind else { return None };
        let sign = match op {
            BinaryOp::And => "AND",
            BinaryOp::Or => "OR",
            _ => return None,
        };
        let is_one = |side: &Expr| self.compares(side) || self.guard(side).is_some();
        (is_one(left) || is_one(right)).then_some(sign)
    }

    /// Whether a condition compares the variable with a constant, or with a variable that is not an element of an array.
    fn compares(&self, condition: &Expr) -> bool {
        let ExprKind::Compare { left, right, .. } = &condition.kind else { return false };
        let is_single = |value: &Expr| match &value.kind {
            ExprKind::Const(_) => true,
            ExprKind::Load(access) => access.indices.is_empty(),
            _ => false,
        };
        self.offset(left).is_some() && is_single(right) || self.offset(right).is_some() && is_single(left)
    }

    /// What an index adds to the variable, as 1 in `i + 1`. None: it is something else, or may wrap.
    fn offset(&self, index: &Expr) -> Option<i128> {
        let offset = match &index.kind {
            ExprKind::Load(access) if access.part.is_none() && Bits::of(access) == Some(self.counted) => 0,
            ExprKind::Convert { conversion: Conversion::Value(_), operand } => self.offset(operand)?,
            ExprKind::Binary { op: BinaryOp::Add, left, right } => match known(right) {
                Some(number) => self.offset(left)? + number,
                None => self.offset(right)? + known(left)?,
            },
            ExprKind::Binary { op: BinaryOp::Subtract, left, right } => self.offset(left)? - known(right)?,
            _ => return None,
        };
        let (least, greatest) = constant::range(index.ty);
        (self.low + offset >= least && self.high + offset <= greatest).then_some(offset)
    }
}

impl walk::Visitor for Used {
    fn access(&mut self, access: &Access, _role: walk::Role) {
        for index in &access.indices {
            if let Some((low, high)) = index.bounds.known()
                && self.beyond.is_none()
                && let Some(offset) = self.offset(&index.value)
            {
                let (low, high) = (i128::from(low), i128::from(high));
                let (least, greatest) = (self.low + offset, self.high + offset);
                // An array whose elements are all elsewhere has no loop of its own that would fit.
                if (least < low || greatest > high) && least <= high && greatest >= low {
                    let is_text = matches!(index.bounds, IndexBounds::Characters { .. });
                    let (index, guard) = (index.value.span, self.guard);
                    self.beyond = Some(Beyond { index, offset, low, high, is_text, guard });
                }
            }
        }
    }
}
