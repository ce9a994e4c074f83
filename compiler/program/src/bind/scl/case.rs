//! CASE. Source: SCL reference, CASE.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::scl::ast::{
    Arm as ArmTree, BinaryOp, CaseValue, Expr as Node, ExprKind as NodeKind, Literal, Statement as Tree,
};
use plcc_syntax::{Class, Elementary};

use super::value::Value;
use super::{constant, message};
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::constant::Constant;
use plcc_model::scl::{Arm, Expr, StatementKind};

impl SclBinder<'_, '_> {
    pub(super) fn case(
        &mut self,
        ctx: &mut SclBlock,
        selector: &Node,
        arms: &[ArmTree],
        otherwise: &[Tree],
    ) -> Option<StatementKind> {
        let of_types = self.asks_for_type(selector);
        let selector = self.selector(ctx, selector);
        let ty = selector.as_ref().map(|selector| selector.ty);
        // Ranges so far, with their positions.
        let mut seen: Vec<(i128, i128, Span)> = Vec::new();
        let mut bound = Vec::with_capacity(arms.len());
        for arm in arms {
            let ranges: Vec<(i128, i128)> =
                arm.values.iter().filter_map(|value| self.case_range(ctx, value, ty?, of_types, &mut seen)).collect();
            let body = self.statements(ctx, &arm.body);
            bound.push(Arm { ranges, body });
        }
        self.doubled(seen);
        let otherwise = self.statements(ctx, otherwise);
        Some(StatementKind::Case { selector: selector?, arms: bound, otherwise })
    }

    fn selector(&mut self, ctx: &mut SclBlock, node: &Node) -> Option<Expr> {
        let value = self.value(ctx, node)?;
        let fits = match &value {
            Value::Elementary(expr) => {
                matches!(expr.ty.class(), Class::Bits | Class::Signed | Class::Unsigned | Class::Character)
                    && expr.ty != Elementary::Bool
            }
            Value::Constant(_, _) => true,
            _ => false,
        };
        if !fits {
            let is = message::described(&value);
            let text = self.program.globals.text(node.span);
            let help = match &value {
                Value::Elementary(expr) if expr.ty == Elementary::Bool => {
                    format!("write `IF {text} THEN … ELSE … END_IF;`")
                }
                Value::Elementary(expr) if expr.ty.is_float() => format!("write `IF {text} < … THEN`, and ELSIF"),
                _ => format!("write `IF {text} = … THEN`, and ELSIF for each other value"),
            };
            self.wrong_type(node.span, &is, "an integer", Some(help));
            return None;
        }
        self.own_type(ctx, value)
    }

    /// The values of one entry, if it can match.
    fn case_range(
        &mut self,
        ctx: &mut SclBlock,
        value: &CaseValue,
        ty: Elementary,
        of_types: bool,
        seen: &mut Vec<(i128, i128, Span)>,
    ) -> Option<(i128, i128)> {
        let low = self.case_value(ctx, &value.low, ty, of_types);
        let high = match &value.high {
            Some(high) => self.case_value(ctx, high, ty, of_types),
            None => low,
        };
        let (low, high) = (low?, high?);
        let span = match &value.high {
            Some(high) => Span { end: high.span.end, ..value.low.span },
            None => value.low.span,
        };
        let (least, most) = constant::range(ty);
        if low > high {
            let label = "the first value is greater than the second";
            self.never(span, "this range is empty", label);
            return None;
        }
        if high < least || low > most {
            let label = format!("{} goes from {least} to {most}", ty.name());
            self.never(span, "this value never occurs", &label);
            return None;
        }
        let (low, high) = (low.max(least), high.min(most));
        seen.push((low, high, span));
        Some((low, high))
    }

    fn never(&mut self, span: Span, title: &str, label: &str) {
        self.refuse(Code::CaseValue, span, title, label, "remove it or correct it");
    }

    /// `4-6:` is the value -2.
    fn subtracted_range(&mut self, node: &Node) {
        let NodeKind::Binary { op: BinaryOp::Subtract, left, right, .. } = &node.kind else { return };
        let is_number = |node: &Node| matches!(node.kind, NodeKind::Literal(Literal::Integer { .. }));
        if is_number(left) && is_number(right) {
            let text = |node: &Node| self.program.globals.text(node.span);
            let (text, low, high) = (text(node), text(left), text(right));
            let help = format!("a range is written `{low}..{high}`");
            self.refuse(Code::CaseValue, node.span, &format!("`{text}` is a subtraction"), "one value", &help);
        }
    }

    /// `1 OR 2:` is the value 3.
    fn joined_values(&mut self, ctx: &SclBlock, node: &Node) {
        let NodeKind::Binary { op: BinaryOp::Or | BinaryOp::And | BinaryOp::Xor, left, right, .. } = &node.kind else {
            return;
        };
        // Bits are written in hexadecimal, and may be joined.
        let is_value = |node: &Node| match &node.kind {
            NodeKind::Literal(Literal::Integer { based, .. }) => !based,
            NodeKind::Name(_) | NodeKind::Binary { .. } => true,
            _ => false,
        };
        if !is_value(left) || !is_value(right) {
            return;
        }
        let text = |node: &Node| self.program.globals.text(node.span);
        let (text, first, second) = (text(node), text(left), text(right));
        let title = match self.program.globals.constant(&ctx.block.bound.constants, node) {
            Some(Constant::Integer { value, .. }) => format!("`{text}` is the value {value}"),
            _ => format!("`{text}` is one value"),
        };
        let help = format!("several values are separated by `,`: `{first}, {second}:`");
        self.refuse(Code::CaseValue, node.span, &title, "the bits of both, joined", &help);
    }

    /// A label as a number of the selector's type.
    fn case_value(&mut self, ctx: &mut SclBlock, node: &Node, ty: Elementary, of_types: bool) -> Option<i128> {
        if of_types && let Some(Constant::Typed { bits, .. }) = self.named_type_number(ctx, node) {
            return Some(i128::from(bits));
        }
        let told = self.program.globals.report.diagnostics.len();
        let Some(value) = self.program.globals.constant(&ctx.block.bound.constants, node) else {
            let text = self.program.globals.text(node.span);
            let is_variable = matches!(&node.kind, NodeKind::Name(name)
                if ctx.block.bound.locals.contains_key(&plcc_binding::fold(&name.text)));
            for message in self.program.globals.report.diagnostics.iter_mut().skip(told) {
                let help = || format!("the values of CASE are constants: compare with `{text}` in an IF");
                if is_variable {
                    message.help = Some(help());
                }
                message.help.get_or_insert_with(help);
            }
            return None;
        };
        self.subtracted_range(node);
        self.joined_values(ctx, node);
        let (least, most) = constant::range(ty);
        match &value {
            // Bits of a signed number, as 16#FFFF for -1.
            Constant::Integer { value, based: true } if *value > most && *value < 1i128 << ty.bits() => {
                Some(constant::integer(ty, *value as u64))
            }
            Constant::Integer { value, .. } if *value < 0 && ty.class() == Class::Bits && *value >= -(most + 1) / 2 => {
                Some(*value + most + 1)
            }
            Constant::Integer { value, .. } => Some(*value),
            Constant::Typed { ty: own, bits }
                if own.is_integer() || (own.class() == Class::Bits && *own != Elementary::Bool) =>
            {
                let number = constant::integer(*own, *bits);
                Some(match own.class() == Class::Bits && own.bits() == ty.bits() && least < 0 {
                    true => constant::integer(ty, *bits),
                    false => number,
                })
            }
            Constant::Typed { ty: own, bits } if *own == ty => Some(i128::from(*bits)),
            Constant::Text { bytes, .. } if ty.class() == Class::Character && bytes.len() == 1 => {
                Some(i128::from(bytes[0]))
            }
            Constant::WideText(text) if ty == Elementary::Wchar && text.len() == 1 => Some(i128::from(text[0])),
            other => {
                let is = message::described(&Value::Constant(other.clone(), node.span));
                self.wrong_type(node.span, &is, ty.name(), Some(plcc_binding::rewrite::wanted(ty)));
                None
            }
        }
    }

    /// Reports values that an earlier arm has.
    fn doubled(&mut self, seen: Vec<(i128, i128, Span)>) {
        let mut sorted: Vec<(usize, (i128, i128, Span))> = seen.into_iter().enumerate().collect();
        sorted.sort_by_key(|(order, (low, _, _))| (*low, *order));
        // The entry that reaches furthest so far.
        let mut reach: Option<(usize, (i128, i128, Span))> = None;
        for entry in sorted {
            if let Some((order, (_, high, first))) = reach
                && entry.1.0 <= high
            {
                let (earlier, later) = if order < entry.0 { (first, entry.1.2) } else { (entry.1.2, first) };
                self.program.report(
                    Diagnostic::new(Code::CaseValue, later, "this value is already in an earlier arm")
                        .label("the earlier arm runs instead")
                        .also(earlier, "the arm that runs")
                        .help("remove one of them"),
                );
            }
            if reach.is_none_or(|(_, (_, high, _))| entry.1.1 > high) {
                reach = Some(entry);
            }
        }
    }
}
