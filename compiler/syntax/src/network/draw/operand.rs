//! Operands as a programmer writes them.

use plcc_diag::Span;
use plcc_literal::duration::s5time_milliseconds;
use plcc_literal::written;

use crate::scl::ast::{Expr, ExprKind, Literal, Name, NameForm, UnaryOp};
use crate::scl::literal as constant;
use crate::scl::text;
use crate::{Class, Elementary};

/// Characters of an operand that are shown.
const LENGTH_MAX: usize = 28;

/// `#Start`, `"Tank".level[3]`, `%I0.0`, `T#1s500ms`, cut to a length that fits a drawing.
pub fn operand(value: &Expr) -> String {
    let full = whole(value);
    if full.chars().count() <= LENGTH_MAX {
        return full;
    }
    full.chars().take(LENGTH_MAX - 3).chain("...".chars()).collect()
}

/// As [`operand`], but not cut.
pub fn whole(value: &Expr) -> String {
    whole_of(value, "")
}

/// As [`whole`], with constants as their author wrote them: `16#00FF`, `T#90s`. `source`: the text that the spans are in.
pub fn whole_of(value: &Expr, source: &str) -> String {
    let whole = |value: &Expr| whole_of(value, source);
    match &value.kind {
        ExprKind::Name(value) => name(value),
        ExprKind::Member { base, name: member } => format!("{}.{}", whole(base), name(member)),
        ExprKind::Index { base, indices } => {
            let indices: Vec<String> = indices.iter().map(|index| formula_of(index, source)).collect();
            format!("{}[{}]", whole(base), indices.join(","))
        }
        ExprKind::Slice { base, width, index } => format!("{}.%{}{index}", whole(base), width.letter()),
        ExprKind::Dereference(base) => format!("{}^", whole(base)),
        ExprKind::Binary { .. } => format!("({})", formula_of(value, source)),
        ExprKind::Literal(constant) => written_constant(constant, value.span, source),
        ExprKind::Unary { op: UnaryOp::Minus, operand } => format!("-{}", whole(operand)),
        ExprKind::Unary { op: UnaryOp::Not, operand } => format!("NOT {}", whole(operand)),
        ExprKind::Error => "???".to_string(),
        ExprKind::Absolute(_)
        | ExprKind::MemberAbsolute { .. }
        | ExprKind::Call { .. }
        | ExprKind::Reference(_)
        | ExprKind::Unary { op: UnaryOp::Plus, .. } => text::expr(value),
    }
}

/// A formula with the parentheses that it needs: `(IN1 + IN2) * IN3`. Constants are as in [`whole_of`].
pub fn formula_of(value: &Expr, source: &str) -> String {
    within(value, 0, source)
}

/// In parentheses if what is around it binds more.
fn within(value: &Expr, around: u8, source: &str) -> String {
    let ExprKind::Binary { op, left, right, .. } = &value.kind else { return whole_of(value, source) };
    let own = op.precedence();
    let text = format!("{} {} {}", within(left, own, source), op.sign(), within(right, own + 1, source));
    if own < around { format!("({text})") } else { text }
}

/// A constant as the source has it at its place, or in its usual form if something else is there.
fn written_constant(value: &Literal, span: Span, source: &str) -> String {
    let is_truth = matches!(value, Literal::Typed { ty: Elementary::Bool, .. });
    let same = |text: &&str| !is_truth && constant::parse(text).is_ok_and(|read| read.value == *value);
    source.get(span.range()).filter(same).map_or_else(|| literal(value), str::to_string)
}

fn name(name: &Name) -> String {
    match name.form {
        NameForm::Bare => name.text.clone(),
        NameForm::Local => format!("#{}", name.text),
        // Of an input or output itself, `:P` is a part of the name.
        NameForm::Quoted => match name.text.strip_suffix(":P") {
            Some(tag) => format!("\"{tag}\":P"),
            None => format!("\"{}\"", name.text),
        },
    }
}

fn literal(value: &Literal) -> String {
    let Literal::Typed { ty, bits } = value else {
        let printed = text::expr(&Expr { kind: ExprKind::Literal(value.clone()), span: Default::default() });
        return match value {
            Literal::Text { bytes, typed: false } => {
                format!("'{}'", bytes.iter().map(|byte| char::from(*byte)).collect::<String>())
            }
            _ => printed,
        };
    };
    let shift = 64 - ty.bits();
    let signed = ((*bits << shift) as i64) >> shift;
    match (ty, ty.class()) {
        (Elementary::Bool, _) => if *bits == 0 { "FALSE" } else { "TRUE" }.to_string(),
        (Elementary::Time, _) => format!("T#{}", duration(i128::from(signed) * 1_000_000)),
        (Elementary::Ltime, _) => format!("LT#{}", duration(i128::from(signed))),
        (Elementary::Date, _) => format!("D#{}", written::date(*bits as i64 + written::DAYS_TO_1990)),
        (Elementary::TimeOfDay, _) => format!("TOD#{}", written::time_of_day(bits * 1_000_000)),
        (Elementary::Ltod, _) => format!("LTOD#{}", written::time_of_day(*bits)),
        (Elementary::Ldt, _) => format!("LDT#{}", written::date_and_time(signed)),
        (Elementary::Real, _) => format!("{:?}", f32::from_bits(*bits as u32)),
        (Elementary::Lreal, _) => format!("{:?}", f64::from_bits(*bits)),
        (Elementary::S5Time, _) => s5time(*bits),
        (Elementary::Byte, _) => format!("B#16#{bits:X}"),
        (Elementary::Word, _) => format!("W#16#{bits:X}"),
        (Elementary::Dword, _) => format!("DW#16#{bits:X}"),
        (_, Class::Signed) => format!("{}#{signed}", ty.name()),
        (_, Class::Unsigned) => format!("{}#{bits}", ty.name()),
        (_, Class::Bits | Class::Float | Class::Character | Class::Duration | Class::Date) => {
            format!("{}#16#{bits:X}", ty.name())
        }
    }
}

/// `1h2m3s`, of nanoseconds.
fn duration(ns: i128) -> String {
    written::duration(ns).to_lowercase()
}

/// Time base and three BCD digits as a duration; other bits as they are.
fn s5time(bits: u64) -> String {
    match s5time_milliseconds(bits as u16) {
        Some(ms) => format!("S5T#{}", duration(i128::from(ms) * 1_000_000)),
        None => format!("W#16#{bits:X}"),
    }
}
