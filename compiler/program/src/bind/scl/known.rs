//! Warnings about constant arguments that a function cannot compute with: `DINT_TO_INT(70000)`, `SQRT(-1.0)`, `LEFT(IN := s, L := -1)`.
//!
//! Source: SCL reference, numbers and conversions of numbers.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::scl::ast::{Expr as Node, ExprKind as NodeKind, Literal};
use plcc_syntax::{Class, Elementary};

use super::constant;
use super::expression::typed_constant;
use super::value::Value;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::constant::Constant;
use plcc_binding::{fold, rewrite};
use plcc_model::scl::{Actual, Argument, Conversion, Expr, ExprKind, Function, UnaryOp};
use plcc_model::{BlockKey, Parameter};

/// A number that is known before the program runs.
#[derive(Clone, Copy, Debug)]
enum Known {
    Whole(i128),
    Float(f64),
}

impl Known {
    fn of(expr: &Expr) -> Option<Known> {
        if let Some(value) = constant::computed(expr) {
            return Some(Known::Whole(value));
        }
        match &expr.kind {
            ExprKind::Const(bits) => match expr.ty {
                Elementary::Real => Some(Known::Float(f64::from(f32::from_bits(*bits as u32)))),
                Elementary::Lreal => Some(Known::Float(f64::from_bits(*bits))),
                Elementary::Time => Some(Known::Whole(i128::from(*bits as u32 as i32))),
                Elementary::Ltime => Some(Known::Whole(i128::from(*bits as i64))),
                _ => None,
            },
            ExprKind::Unary { op: UnaryOp::Negate, operand } if expr.ty.is_float() => match Known::of(operand)? {
                Known::Whole(value) => Some(Known::Whole(-value)),
                Known::Float(value) => Some(Known::Float(-value)),
            },
            ExprKind::Convert { conversion: Conversion::Value(_), operand } if expr.ty.is_float() => {
                Some(Known::Float(Known::of(operand)?.float()))
            }
            _ => None,
        }
    }

    const fn float(self) -> f64 {
        match self {
            Known::Whole(value) => value as f64,
            Known::Float(value) => value,
        }
    }

    /// Whether a conversion to whole numbers from `low` to `high` keeps the value, apart from its fraction.
    fn fits(self, low: i128, high: i128) -> bool {
        match self {
            Known::Whole(value) => (low..=high).contains(&value),
            // The ends of long types are not exact as floats, and NaN is another matter.
            Known::Float(value) => {
                let rounded = value.round_ties_even();
                value.is_nan() || rounded >= low as f64 && rounded <= high as f64
            }
        }
    }
}

impl SclBinder<'_, '_> {
    /// Warns of a constant that the type of a conversion cannot hold. Bit strings keep their bits, so they do not count.
    pub(super) fn check_converted(&mut self, value: &Expr, to: Elementary) {
        let Some(number) = Known::of(value) else { return };
        let (low, high) = match to.class() {
            Class::Signed | Class::Unsigned => constant::range(to),
            Class::Character => (0, (1i128 << to.bits()) - 1),
            Class::Bits | Class::Float | Class::Duration | Class::Date => return,
        };
        if number.fits(low, high) {
            return;
        }
        let text = self.program.globals.text(value.span);
        let title = format!("`{text}` does not fit type {}", to.name());
        let help = match number {
            Known::Whole(whole) if to.is_integer() => rewrite::roomy(whole, to),
            Known::Float(_) if to == Elementary::Int && number.fits(i32::MIN.into(), i32::MAX.into()) => Some("DINT"),
            Known::Whole(_) | Known::Float(_) => None,
        };
        let help = match help.filter(|larger| *larger != to.name()) {
            Some(larger) => format!("write a value from {low} to {high}, or convert to {larger}"),
            None => format!("write a value from {low} to {high}"),
        };
        let message = Diagnostic::new(Code::Narrowing, value.span, title);
        self.program.report(message.label(format!("no value of type {}", to.name())).help(help));
    }

    /// Warns of a constant for which a function of REALs has no result.
    pub(super) fn check_domain(&mut self, function: Function, value: &Expr) {
        const INSIDE: &str = "write a number from -1.0 to 1.0";
        let Some(number) = Known::of(value).map(Known::float) else { return };
        let (name, label, help) = match function {
            Function::Sqrt if number < 0.0 => ("SQRT", "it has no square root", "write a number from 0.0 on"),
            Function::Ln if number <= 0.0 => ("LN", "it has no logarithm", "write a number above 0.0"),
            Function::Log if number <= 0.0 => ("LOG", "it has no logarithm", "write a number above 0.0"),
            Function::Asin if number.abs() > 1.0 => ("ASIN", "no angle has this sine", INSIDE),
            Function::Acos if number.abs() > 1.0 => ("ACOS", "no angle has this cosine", INSIDE),
            Function::Sqrt | Function::Ln | Function::Log | Function::Asin | Function::Acos => return,
            Function::Sqr | Function::Exp | Function::Expd | Function::Sin | Function::Cos | Function::Tan => return,
            Function::Atan | Function::Frac | Function::Limit | Function::Select | Function::Mux { .. } => return,
            Function::Swap | Function::NormX | Function::ScaleX | Function::Encode | Function::Decode => return,
            Function::BitSum | Function::IsValid => return,
        };
        let title = format!("{name} has no result for `{}`", self.program.globals.text(value.span));
        self.refuse(Code::AlwaysSame, value.span, &title, label, help);
    }

    /// Warns of a whole number that a box divides by if it is always 0.
    pub(in crate::bind) fn check_divisor(&mut self, divisor: &Expr) {
        if divisor.ty.is_integer() && matches!(Known::of(divisor), Some(Known::Whole(0))) {
            const HELP: &str = "write another divisor, or a variable that is not 0";
            self.refuse(Code::AlwaysSame, divisor.span, "this always divides by 0", "the divisor is 0", HELP);
        }
    }

    /// Warns of constant limits with no value between them. `pins`: their names.
    pub(in crate::bind) fn check_limits(&mut self, low: &Value, high: &Value, pins: [&str; 2]) {
        let number = |value: &Value| match value {
            Value::Constant(Constant::Integer { value, .. }, _) => Some(Known::Whole(*value)),
            Value::Constant(Constant::Real(value), _) => Some(Known::Float(*value)),
            other => {
                let (ty, bits) = typed_constant(other)?;
                Known::of(&Expr { kind: ExprKind::Const(bits), ty, span: other.span() })
            }
        };
        // TIME counts milliseconds, LTIME nanoseconds; two of them do not go together.
        let is_long = |value: &Value| typed_constant(value).is_some_and(|(ty, _)| ty == Elementary::Ltime);
        let limits = number(low).zip(number(high)).filter(|_| is_long(low) == is_long(high));
        if limits.is_some_and(|(low, high)| low.float() > high.float()) {
            let globals = &self.program.globals;
            let (span, low, high) = (low.span(), globals.text(low.span()), globals.text(high.span()));
            self.refuse(
                Code::AlwaysSame,
                span,
                &format!("the lower limit `{low}` is above the upper limit `{high}`"),
                "no value is between them",
                &format!("exchange the values of {} and {}", pins[0], pins[1]),
            );
        }
    }

    /// Warns of a constant K of MUX or DEMUX that selects none of `count` pins, the first of which is `first`0.
    pub(super) fn check_selector(&mut self, selector: &Expr, first: &str, count: usize, otherwise: Option<Span>) {
        let Some(Known::Whole(number)) = Known::of(selector) else { return };
        if (0..count as i128).contains(&number) || count == 0 {
            return;
        }
        let text = self.program.globals.text(selector.span);
        let last = count - 1;
        let title = match last {
            0 => format!("K is `{text}`, but the only pin is {first}0"),
            _ => format!("K is `{text}`, but the pins are {first}0 to {first}{last}"),
        };
        let label = match otherwise {
            Some(span) => format!("`{}` is always selected", self.program.globals.text(span)),
            None => "selects none of them".to_owned(),
        };
        let help = format!("write a number from 0 to {last}, or the variable that selects");
        self.refuse(Code::AlwaysSame, selector.span, &title, &label, &help);
    }

    /// Warns of a text without any digit that a conversion reads as a number. `to`: the name of its type.
    pub(super) fn check_digits(&mut self, ctx: &SclBlock, node: &Node, to: &str) {
        let is_literal = matches!(node.kind, NodeKind::Literal(Literal::Text { .. } | Literal::WideText(_)));
        let is_number = Elementary::from_word(to).is_some_and(|ty| ty.is_integer() || ty.is_float());
        let text = self.program.globals.text(node.span);
        // `$30` is a digit as well.
        if !is_literal || !is_number || text.contains(|letter: char| letter.is_ascii_digit() || letter == '$') {
            return;
        }
        let name = text.split('\'').nth(1).unwrap_or_default().trim();
        let help = match ctx.block.bound.locals.contains_key(&fold(name)) {
            true => format!("write `#{name}` for the variable, without quotes"),
            false => "write a text with digits, or the variable that has it".to_owned(),
        };
        let title = format!("`{text}` is not a number");
        self.refuse(Code::AlwaysSame, node.span, &title, "a text without a digit", &help);
    }

    /// Warns of constants that are no position in a text and no number of characters.
    pub(super) fn check_text_position(&mut self, key: BlockKey, parameters: &[Parameter], arguments: &[Argument]) {
        for argument in arguments {
            let formal = parameters[argument.parameter].name.as_str();
            let Actual::Value(value) = &argument.actual else { continue };
            let Some(Known::Whole(number)) = Known::of(value).filter(|_| matches!(formal, "L" | "P")) else { continue };
            if number > 0 {
                continue;
            }
            let Some(block) = self.program.globals.library_block(key) else { return };
            let name = block.name.trim_end_matches("_WSTRING").trim_end_matches("_LONG");
            if !["LEFT", "RIGHT", "MID", "DELETE", "INSERT", "REPLACE"].contains(&name) {
                return;
            }
            let (least, what, label) = match (formal, name) {
                ("L", _) => (0, "number of characters", "a text has no fewer than 0 characters"),
                ("P", "INSERT") => (0, "position in a text", "0 is before the first character"),
                _ => (1, "position in a text", "the first character is at position 1"),
            };
            if number < least {
                let title = format!("`{}` is not a {what}", self.program.globals.text(argument.span));
                let help = format!("write a number from {least} on, or a variable");
                self.refuse(Code::AlwaysSame, argument.span, &title, label, &help);
            }
        }
    }
}
