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
            let mut used = Used { counted, low: start.min(last), high: start.max(last), beyond: None };
            used.passed(body);
            if let Some(Beyond { index, offset, low, high, is_text }) = used.beyond {
                let within = |value: i128| (value + offset).clamp(low, high) - offset;
                let (from, to) = (within(start), within(last));
                let by = if step == 1 { String::new() } else { format!(" BY {step}") };
                let (title, parts, longer) = match is_text {
                    true => ("the loop goes beyond the characters of this text", "characters", "a longer text"),
                    false => {
                        ("the loop goes beyond the bounds of this array", "elements", "the array with more elements")
                    }
                };
                let help = format!("write `FOR {} := {from} TO {to}{by} DO`, or declare {longer}", text(variable.span));
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
}

impl Used {
    /// The statements that each pass reaches.
    fn passed(&mut self, list: &[Statement]) {
        for statement in list {
            match &statement.kind {
                // A condition may keep the index within the bounds.
                StatementKind::If { branches, .. } => {
                    if let Some((condition, _)) = branches.first() {
                        walk::expr(condition, self);
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
                    self.beyond = Some(Beyond { index: index.value.span, offset, low, high, is_text });
                }
            }
        }
    }
}
