//! Timer and counter functions: S_PULSE, S_PEXT, S_ODT, S_ODTS, S_OFFDT, S_CU, S_CD, S_CUD. Source: SCL reference, timers and counters.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::Elementary;
use plcc_syntax::ast::CellKind;
use plcc_syntax::scl::ast::Expr as Node;

use super::Intent;
use super::convert;
use super::message::described;
use super::numeric::Shape;
use super::pins::Pins;
use super::value::Value;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::constant::Constant;
use plcc_binding::rewrite::{self, Form};
use plcc_model::Number;
use plcc_model::scl::{Access, CounterCall, Expr, ExprKind, TimerCall, TimerKind};

/// What to write for the preset of a counter.
const COUNT: &str = "write a value from 0 to 999 after `C#`";

impl SclBinder<'_, '_> {
    pub fn timer_function(&mut self, ctx: &mut SclBlock, kind: TimerKind, pins: &Pins, span: Span) -> Option<Value> {
        let timer = self.cell_argument(ctx, CellKind::Timer, pins.get("T_NO")?);
        let start = self.optional(ctx, pins.get("S"), Elementary::Bool);
        let value = match pins.get("TV") {
            Some(node) => self.timer_value(ctx, node).map(Some),
            None => Some(None),
        };
        let reset = self.optional(ctx, pins.get("R"), Elementary::Bool);
        let q = self.optional_output(ctx, pins.get("Q"), Elementary::Bool);
        let bi = self.optional_output(ctx, pins.get("BI"), Elementary::Word);
        let call = TimerCall { kind, timer: timer?, start: start?, value: value?, reset: reset?, q: q?, bi: bi? };
        Some(Value::Elementary(Expr { kind: ExprKind::Timer(Box::new(call)), ty: Elementary::S5Time, span }))
    }

    pub fn counter_function(&mut self, ctx: &mut SclBlock, pins: &Pins, span: Span) -> Option<Value> {
        let counter = self.cell_argument(ctx, CellKind::Counter, pins.get("C_NO")?);
        let up = self.optional(ctx, pins.get("CU"), Elementary::Bool);
        let down = self.optional(ctx, pins.get("CD"), Elementary::Bool);
        let set = self.optional(ctx, pins.get("S"), Elementary::Bool);
        let value = match pins.get("PV") {
            Some(node) => self.counter_value(ctx, node).map(Some),
            None => Some(None),
        };
        let reset = self.optional(ctx, pins.get("R"), Elementary::Bool);
        let q = self.optional_output(ctx, pins.get("Q"), Elementary::Bool);
        let cv = self.optional_output(ctx, pins.get("CV"), Elementary::Word);
        let call = CounterCall {
            counter: counter?,
            up: up?,
            down: down?,
            set: set?,
            value: value?,
            reset: reset?,
            q: q?,
            cv: cv?,
        };
        Some(Value::Elementary(Expr { kind: ExprKind::Counter(Box::new(call)), ty: Elementary::Word, span }))
    }

    /// The timer or counter that a function uses.
    fn cell_argument(&mut self, ctx: &mut SclBlock, wanted: CellKind, node: &Node) -> Option<Number> {
        let value = self.value(ctx, node)?;
        match value {
            Value::Cell { kind, number, .. } if kind == wanted => Some(number),
            // TIA Portal, S7-300/400: the number itself.
            Value::Constant(Constant::Integer { value, .. }, span) => {
                let number = u32::try_from(value).unwrap_or(u32::MAX);
                Some(Number::Known(self.program.globals.check_cell(wanted, number, span)?))
            }
            other => {
                let (name, example) = match wanted {
                    CellKind::Timer => ("a timer", "T5"),
                    CellKind::Counter => ("a counter", "C5"),
                };
                let help = format!("name one, for example {example}, or a parameter that is one");
                self.wrong_type(node.span, &described(&other), name, Some(help));
                None
            }
        }
    }

    /// The outer `None` after a message.
    fn optional(&mut self, ctx: &mut SclBlock, node: Option<&Node>, ty: Elementary) -> Option<Option<Expr>> {
        match node {
            Some(node) => self.of_type(ctx, node, ty).map(Some),
            None => Some(None),
        }
    }

    fn optional_output(&mut self, ctx: &mut SclBlock, node: Option<&Node>, ty: Elementary) -> Option<Option<Access>> {
        match node {
            Some(node) => self.variable_of_type(ctx, node, ty, Intent::Write).map(Some),
            None => Some(None),
        }
    }

    /// The time of a timer: S5TIME, a WORD in the form of one, or a TIME.
    fn timer_value(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Expr> {
        let value = self.value(ctx, node)?;
        if let Value::Constant(Constant::Typed { ty, bits }, span) = &value {
            self.check_time(*ty, *bits as u16, *span);
        }
        match Shape::of(&value) {
            Shape::Of(Elementary::S5Time | Elementary::Word) => self.own_type(ctx, value),
            Shape::Of(Elementary::Time) => {
                let time = self.own_type(ctx, value)?;
                convert::explicit_expr(ctx.scope.rules, time, Elementary::S5Time)
            }
            _ => self.convert(ctx, value, Elementary::S5Time),
        }
    }

    /// Reports a constant that is another time than it says: `S5T#12S345MS`, `C#20`.
    fn check_time(&mut self, ty: Elementary, word: u16, span: Span) {
        let text = self.program.globals.text(span);
        let count = text.get(..2).filter(|prefix| prefix.eq_ignore_ascii_case("C#")).map(|_| &text[2..]);
        let (title, label, help) = match (ty, count) {
            (Elementary::S5Time, _) => {
                let Some((title, help)) = rewrite::cut_s5time(&text, word) else { return };
                let label = if word == 0 { "the time is over at once" } else { "the time is over sooner" };
                (title, label, help)
            }
            (Elementary::Word, Some(count)) if word != 0 => {
                let help = rewrite::help(Elementary::S5Time, count, Form::Scl);
                (format!("`{text}` is not an S5TIME"), "the timer takes the number as units of 10 ms", help)
            }
            _ => return,
        };
        self.program.report(Diagnostic::new(Code::TimerWithoutTime, span, title).label(label).help(help));
    }

    /// The preset of a counter: a WORD in BCD. Of a decimal number the counter takes the bits, which is hardly intended.
    fn counter_value(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Expr> {
        let mut value = self.value(ctx, node)?;
        if let Value::Constant(Constant::Typed { ty, bits }, span) = &mut value
            && *ty == Elementary::S5Time
        {
            self.report_count(*bits as u32, *span, COUNT.to_owned());
            *ty = Elementary::Word;
        }
        if let Value::Constant(Constant::Integer { value: number, based }, span) = &value
            && let Ok(number) = u32::try_from(*number)
        {
            self.check_count(number, *based, *span)?;
        }
        self.convert(ctx, value, Elementary::Word)
    }

    /// Reports a constant whose BCD digits are another count than it says.
    fn report_count(&mut self, number: u32, span: Span, help: String) {
        let digit = |at: u32| number >> (4 * at) & 0xF;
        let count = digit(2) * 100 + digit(1) * 10 + digit(0);
        let text = self.program.globals.text(span);
        self.program.report(
            Diagnostic::new(Code::TimerWithoutTime, span, format!("`{text}` is not the value of a counter"))
                .label(format!("takes its BCD digits, 16#{number:04X}: starts at {count}"))
                .help(help),
        );
    }

    fn check_count(&mut self, number: u32, based: bool, span: Span) -> Option<()> {
        let digit = |at: u32| number >> (4 * at) & 0xF;
        let is_bcd = (0..3).all(|at| digit(at) <= 9);
        if is_bcd && (based || number <= 9) {
            return Some(());
        }
        let text = self.program.globals.text(span);
        let help = match number {
            0..=999 => format!("write `C#{number}`"),
            _ => COUNT.to_owned(),
        };
        if is_bcd {
            self.report_count(number, span, help);
            return Some(());
        }
        let label = match based {
            true => format!("`{text}` has a digit above 9"),
            false => format!("a decimal number, whose bits 16#{number:04X} are not BCD"),
        };
        self.program.report(
            Diagnostic::new(Code::BadLiteral, span, "a counter needs its value in BCD").label(label).help(help),
        );
        None
    }
}
