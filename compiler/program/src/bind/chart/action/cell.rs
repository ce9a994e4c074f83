//! Counters and timers in rows of actions. Source: GRAPH reference D.8.
//!
//! They are the S7 timers and counters that SCL and STL use, which start and count at a rising edge. When its event occurs, a row
//! passes them FALSE first, then TRUE, so that events in consecutive calls all count.

use plcc_diag::{Code, Span};
use plcc_syntax::Elementary;
use plcc_syntax::ast::CellKind;
use plcc_syntax::chart::ast::Qualifier;
use plcc_syntax::scl::ast::{Expr as Node, ExprKind as NodeKind};

use super::operand::{plain_time, thing_text};
use super::{Moment, Rows, guarded};
use crate::bind::chart::ChartBinder;
use crate::bind::network::{no, yes};
use crate::bind::scl::convert::explicit_expr;
use crate::bind::scl::expression::constant_expr;
use crate::bind::scl::message::described;
use crate::bind::scl::numeric::Shape;
use crate::bind::scl::place::Thing;
use crate::bind::scl::value::Value;
use crate::bind::scl::{Intent, SclBlock};
use plcc_binding::constant::Constant;
use plcc_model::Number;
use plcc_model::scl::{CounterCall, Expr, ExprKind, Statement, StatementKind, TimerCall, TimerKind};

/// Greatest count.
const COUNT_MAX: i128 = 999;
/// Longest time of a timer: 2h46m30s.
const TIMER_MILLISECONDS_MAX: u64 = 9_990_000;

impl ChartBinder<'_, '_> {
    /// CS, CU, CD, CR.
    pub(super) fn counter_row(
        &mut self,
        ctx: &mut SclBlock,
        moment: &Moment,
        qualifier: Qualifier,
        operand: &Node,
        value: Option<&Node>,
        span: Span,
    ) -> Vec<Statement> {
        let counter = self.row_cell(ctx, CellKind::Counter, operand);
        let value = match value {
            Some(node) => self.count(ctx, node).map(Some),
            None => Some(None),
        };
        let (Some(counter), Some(value)) = (counter, value) else { return Vec::new() };
        let call = |input: Expr, value: Option<Expr>| {
            let mut call = CounterCall {
                counter: counter.clone(),
                up: None,
                down: None,
                set: None,
                value,
                reset: None,
                q: None,
                cv: None,
            };
            let pin = match qualifier {
                Qualifier::Cs => &mut call.set,
                Qualifier::Cu => &mut call.up,
                Qualifier::Cd => &mut call.down,
                _ => &mut call.reset,
            };
            *pin = Some(input);
            evaluate(ExprKind::Counter(Box::new(call)), Elementary::Word, span)
        };
        let body = match qualifier {
            Qualifier::Cr => vec![call(yes(span), None)],
            _ => vec![call(no(span), None), call(yes(span), value)],
        };
        guarded(moment.value(span), body, span)
    }

    /// TL, TD, TR.
    pub(super) fn timer_row(
        &mut self,
        ctx: &mut SclBlock,
        moment: &Moment,
        qualifier: Qualifier,
        operand: &Node,
        value: Option<&Node>,
        span: Span,
    ) -> Vec<Statement> {
        let timer = self.row_cell(ctx, CellKind::Timer, operand);
        let value = match value {
            Some(node) => self.timer_time(ctx, node).map(Some),
            None => Some(None),
        };
        let (Some(timer), Some(value)) = (timer, value) else { return Vec::new() };
        let body = match qualifier {
            Qualifier::Tr => {
                let reset = TimerCall { reset: Some(yes(span)), ..timer_call(TimerKind::ExtendedPulse, timer) };
                vec![evaluate_timer(reset, span)]
            }
            _ => {
                let kind = match qualifier {
                    Qualifier::Td => TimerKind::RetentiveOnDelay,
                    _ => TimerKind::ExtendedPulse,
                };
                let before = TimerCall { start: Some(no(span)), ..timer_call(kind, timer.clone()) };
                let start = TimerCall { start: Some(yes(span)), value, ..timer_call(kind, timer) };
                vec![evaluate_timer(before, span), evaluate_timer(start, span)]
            }
        };
        guarded(moment.value(span), body, span)
    }

    /// TF: the timer runs out after the step.
    pub(super) fn off_delay_row(
        &mut self,
        ctx: &mut SclBlock,
        rows: &mut Rows,
        moment: &Moment,
        operand: &Node,
        value: &Node,
        span: Span,
    ) {
        let timer = self.row_cell(ctx, CellKind::Timer, operand);
        let value = self.timer_time(ctx, value);
        let (Some(timer), Some(value)) = (timer, value) else { return };
        let call = |start: Expr| {
            let call = TimerCall {
                start: Some(start),
                value: Some(value.clone()),
                ..timer_call(TimerKind::OffDelay, timer.clone())
            };
            evaluate_timer(call, span)
        };
        rows.add(moment, vec![call(moment.value(span))]);
        rows.left.push(call(no(span)));
    }

    /// The timer or counter of a row.
    fn row_cell(&mut self, ctx: &mut SclBlock, wanted: CellKind, node: &Node) -> Option<Number> {
        let is = match &node.kind {
            NodeKind::Literal(_) | NodeKind::Unary { .. } | NodeKind::Binary { .. } => "a value",
            _ => match self.scl().thing(ctx, node, Intent::Read)? {
                Thing::Cell { kind, number } if kind == wanted => return Some(number),
                other => thing_text(&other),
            },
        };
        let (name, example) = match wanted {
            CellKind::Timer => ("a timer", "T5"),
            CellKind::Counter => ("a counter", "C5"),
        };
        let text = self.program.globals.text(node.span);
        let title = format!("`{text}` is {is}, but this action needs {name}");
        self.scl().refuse(Code::ActionOperand, node.span, &title, is, &format!("name {name}: `{example}`"));
        None
    }

    /// The value of CS: a WORD in BCD.
    fn count(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Expr> {
        let value = self.scl().value(ctx, node)?;
        match (&value, Shape::of(&value)) {
            (Value::Constant(Constant::Integer { value: count, based: false }, span), _)
                if (0..=COUNT_MAX).contains(count) =>
            {
                Some(constant_expr(bcd(*count as u64), Elementary::Word, *span))
            }
            (Value::Constant(Constant::Integer { based: true, .. }, _), _) | (_, Shape::Of(Elementary::Word)) => {
                self.scl().convert(ctx, value, Elementary::Word)
            }
            (Value::Constant(Constant::Integer { .. }, span), _) => {
                let title = format!("a counter cannot hold {}", self.program.globals.text(*span));
                self.scl().refuse(
                    Code::ActionOperand,
                    *span,
                    &title,
                    "it goes from 0 to 999",
                    "write a smaller value: `C#20`",
                );
                None
            }
            _ => {
                let (text, is) = (self.program.globals.text(node.span), described(&value));
                let title = format!("`{text}` is not a value of a counter");
                self.scl().refuse(
                    Code::ActionOperand,
                    node.span,
                    &title,
                    &is,
                    "write a constant from 0 to 999, `C#20`, or a WORD in BCD; convert an INT with INT_TO_BCD",
                );
                None
            }
        }
    }

    /// The time of a timer: an S5TIME, or a WORD in the same format.
    fn timer_time(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Expr> {
        let value = self.scl().value(ctx, &plain_time(node))?;
        if matches!(Shape::of(&value), Shape::Of(Elementary::Time)) && self.refuse_negative(&value) {
            return None;
        }
        match (&value, Shape::of(&value)) {
            (Value::Constant(Constant::Typed { ty: Elementary::Time, bits }, span), _)
                if *bits > TIMER_MILLISECONDS_MAX =>
            {
                let title = format!("a timer cannot run for {}", self.program.globals.text(*span));
                self.scl().refuse(
                    Code::ActionOperand,
                    *span,
                    &title,
                    "the longest time is 2h46m30s",
                    "write a shorter time",
                );
                None
            }
            (Value::Constant(Constant::Integer { based: true, .. }, _), _) => {
                self.scl().convert(ctx, value, Elementary::Word)
            }
            (_, Shape::Of(Elementary::S5Time | Elementary::Word)) => self.scl().own_type(ctx, value),
            (_, Shape::Of(Elementary::Time)) => {
                let time = self.scl().own_type(ctx, value)?;
                explicit_expr(ctx.scope.rules, time, Elementary::S5Time)
            }
            _ => {
                let (text, is) = (self.program.globals.text(node.span), described(&value));
                let title = format!("`{text}` is not a time of a timer");
                let help = "write a time, `S5T#5S` or `T#5S`, or a variable of type S5TIME, WORD or TIME";
                self.scl().refuse(Code::ActionOperand, node.span, &title, &is, help);
                None
            }
        }
    }
}

/// A number up to 999 in BCD.
fn bcd(number: u64) -> u64 {
    ((number / 100) << 8) | ((number / 10 % 10) << 4) | (number % 10)
}

fn timer_call(kind: TimerKind, timer: Number) -> TimerCall {
    TimerCall { kind, timer, start: None, value: None, reset: None, q: None, bi: None }
}

fn evaluate_timer(call: TimerCall, span: Span) -> Statement {
    evaluate(ExprKind::Timer(Box::new(call)), Elementary::S5Time, span)
}

fn evaluate(kind: ExprKind, ty: Elementary, span: Span) -> Statement {
    Statement { kind: StatementKind::Evaluate(Expr { kind, ty, span }), span }
}

#[cfg(test)]
mod tests {
    #[test]
    fn bcd() {
        assert_eq!([0, 9, 20, 999].map(super::bcd), [0, 9, 0x20, 0x999]);
    }
}
