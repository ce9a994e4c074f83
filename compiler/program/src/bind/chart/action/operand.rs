//! Operands of N, S, R, D and L, and their times. Source: GRAPH reference D.6.

use std::borrow::Cow;

use plcc_diag::{Code, Span};
use plcc_syntax::Elementary;
use plcc_syntax::ast::CellKind;
use plcc_syntax::scl::ast::{Expr as Node, ExprKind as NodeKind, Literal, Name, NameForm};

use crate::bind::chart::ChartBinder;
use crate::bind::scl::convert::explicit_expr;
use crate::bind::scl::message::described;
use crate::bind::scl::numeric::Shape;
use crate::bind::scl::place::{Spot, Thing};
use crate::bind::scl::value::Value;
use crate::bind::scl::{Intent, SclBlock};
use plcc_binding::constant::Constant;
use plcc_binding::rewrite;
use plcc_model::layout;
use plcc_model::scl::Expr;

impl ChartBinder<'_, '_> {
    /// A BOOL that a row writes.
    pub fn bit_operand(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Spot> {
        let thing = match &node.kind {
            NodeKind::Literal(_) | NodeKind::Unary { .. } | NodeKind::Binary { .. } => {
                self.no_bit(node.span, "not a variable");
                return None;
            }
            _ => self.scl().thing(ctx, node, Intent::Write)?,
        };
        let Thing::Spot(spot) = thing else {
            let is = thing_text(&thing);
            self.no_bit(node.span, is);
            return None;
        };
        let access = spot.clone().access(node.span);
        if access.elementary() != Some(Elementary::Bool) {
            let is = match access.elementary() {
                Some(ty) => format!("of type {}", ty.name()),
                None => format!("of type {}", layout::type_name(&access.ty)),
            };
            self.no_bit(node.span, &is);
            return None;
        }
        self.scl().check_intent(ctx, &spot, Intent::Write, node.span)?;
        Some(spot)
    }

    fn no_bit(&mut self, span: Span, is: &str) {
        let text = self.program.globals.text(span);
        let title = format!("`{text}` is {is}, but this action writes a BOOL");
        let is_fb = || text.get(..2).is_some_and(|letters| letters.eq_ignore_ascii_case("FB"));
        let help = match bit_of(&text) {
            Some(bit) => format!("name one of its bits, such as `{bit}`"),
            None if is == "a block" && is_fb() => {
                format!("to call it with its instance, write `CALL {text}, DB… ()  (N)`")
            }
            None if is == "a block" => format!("to call it, write `CALL {text} ()  (N)`"),
            None => "name a variable of type BOOL".to_string(),
        };
        self.scl().refuse(Code::ActionOperand, span, &title, is, &help);
    }

    /// The time of D and L, a TIME.
    pub fn action_time(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Expr> {
        let value = self.scl().value(ctx, &plain_time(node))?;
        if self.refuse_negative(&value) {
            return None;
        }
        match Shape::of(&value) {
            Shape::Of(Elementary::Time | Elementary::Dword | Elementary::Dint | Elementary::S5Time) => {
                let value = self.scl().own_type(ctx, value)?;
                explicit_expr(ctx.scope.rules, value, Elementary::Time)
            }
            _ => {
                let (text, is) = (self.program.globals.text(node.span), described(&value));
                let title = format!("`{text}` is not a time");
                let help = match rewrite::of_constant(Elementary::Time, &text, rewrite::Form::Scl) {
                    Some(help) => help,
                    None => "write a time such as `T#5S`, or a variable of type TIME; DWORD and DINT hold milliseconds"
                        .to_string(),
                };
                self.scl().refuse(Code::ActionOperand, node.span, &title, &is, &help);
                None
            }
        }
    }

    /// Refuses a constant time below zero; whether it is one.
    pub fn refuse_negative(&mut self, value: &Value) -> bool {
        let Value::Constant(Constant::Typed { ty: Elementary::Time | Elementary::Dint, bits }, span) = value else {
            return false;
        };
        if (*bits as u32).cast_signed() >= 0 {
            return false;
        }
        let written = self.program.globals.text(*span);
        let help = match written.contains("#-") {
            true => format!("write `{}`", written.replacen('-', "", 1).trim()),
            false => "write a time above zero".to_owned(),
        };
        let title = format!("`{written}` is below zero");
        self.scl().refuse(Code::ActionOperand, *span, &title, "the time of an action is not negative", &help);
        true
    }
}

/// The first bit of an address of a byte, word or double word: `Q1.0` for `QW1`.
fn bit_of(text: &str) -> Option<String> {
    let text = text.trim().replace(' ', "").to_ascii_uppercase();
    let (area, width, byte) = (text.get(..1)?, text.get(1..2)?, text.get(2..)?);
    let is_wide = matches!(area, "I" | "E" | "Q" | "A" | "M") && matches!(width, "B" | "W" | "D");
    (is_wide && !byte.is_empty() && byte.bytes().all(|digit| digit.is_ascii_digit())).then(|| format!("{area}{byte}.0"))
}

/// `5s`, `500ms`: a time without `T#`. Source: GRAPH reference D.8.
pub fn plain_time(node: &Node) -> Cow<'_, Node> {
    let NodeKind::Name(Name { text, form: NameForm::Bare, .. }) = &node.kind else { return Cow::Borrowed(node) };
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match text[digits.len()..].to_ascii_lowercase().as_str() {
        "ms" => 1,
        "s" => 1000,
        "m" => 60_000,
        "h" => 3_600_000,
        _ => return Cow::Borrowed(node),
    };
    let milliseconds = digits.parse().ok().and_then(|count: u32| count.checked_mul(unit));
    match milliseconds.filter(|time| i32::try_from(*time).is_ok()) {
        Some(time) => {
            let literal = Literal::Typed { ty: Elementary::Time, bits: u64::from(time) };
            Cow::Owned(Node { kind: NodeKind::Literal(literal), span: node.span })
        }
        None => Cow::Borrowed(node),
    }
}

/// A description of the operand, where something else is expected.
pub fn thing_text(thing: &Thing) -> &'static str {
    match thing {
        Thing::Spot(_) => "a variable",
        Thing::Constant(_) => "a constant",
        Thing::Cell { kind: CellKind::Timer, .. } => "a timer",
        Thing::Cell { kind: CellKind::Counter, .. } => "a counter",
        Thing::Block { .. } => "a block",
        Thing::Db { .. } | Thing::DbArea(..) => "a data block",
        Thing::Flag | Thing::LastEno => "the ENO of a block",
        Thing::Area(..) => "an area of memory",
    }
}
