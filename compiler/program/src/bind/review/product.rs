//! Products of whole numbers in SCL that are computed in a type of 8 or 16 bits and become a longer one only afterwards: `dint := int * 1000`.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_model::scl::{Access, Base, BinaryOp, Conversion, Expr, ExprKind, Statement, UnaryOp, walk};
use plcc_syntax::Elementary;
use rustc_hash::FxHashSet;

use super::tree::known;
use crate::bind::scl::{bounds, constant};

/// A factor by which values up to this one fit is not reported: a program seldom has larger ones.
const ORDINARY: i128 = 1000;

/// Reports the products of a block. `text`: what is written at a place.
pub fn review(list: &[Statement], text: &dyn Fn(Span) -> String, found: &mut Vec<Diagnostic>) {
    walk::statements(list, &mut Products { text, addresses: FxHashSet::default(), found });
}

struct Products<'r> {
    text: &'r dyn Fn(Span) -> String,
    /// Where indices and byte addresses begin and end. They are small, and one that is not is an error at run time.
    addresses: FxHashSet<(u32, u32)>,
    found: &'r mut Vec<Diagnostic>,
}

impl Products<'_> {
    /// What to write for the product, so that nothing is lost.
    fn longer(&self, left: &Expr, right: &Expr, target: Elementary) -> String {
        let converted = |side: &Expr| {
            let own = written(side);
            let text = (self.text)(own.span);
            let inside = text.strip_prefix('(').and_then(|text| text.strip_suffix(')'));
            let inside = inside.filter(|text| !text.contains(['(', ')'])).unwrap_or(&text);
            format!("{}_TO_{}({inside})", own.ty.name(), target.name())
        };
        match known(left) {
            None => format!("{} * {}", converted(left), (self.text)(right.span)),
            Some(_) => format!("{} * {}", (self.text)(left.span), converted(right)),
        }
    }
}

/// The value before its implicit conversion.
fn written(value: &Expr) -> &Expr {
    match &value.kind {
        ExprKind::Convert { operand, .. } if operand.span == value.span => written(operand),
        _ => value,
    }
}

/// Whether it is a division by a value that is not constant.
fn is_quotient(value: &Expr) -> bool {
    matches!(&value.kind, ExprKind::Binary { op: BinaryOp::Divide, right, .. } if known(right).is_none())
}

/// The product in a calculation in type `ty` that may not fit it. `divided`: also one that is divided.
fn product(value: &Expr, divided: bool) -> Option<(&Expr, &Expr, &Expr)> {
    match &value.kind {
        // A quotient that is multiplied has a message of its own.
        ExprKind::Binary { op: BinaryOp::Multiply, left, right } if is_quotient(left) || is_quotient(right) => None,
        ExprKind::Binary { op: BinaryOp::Multiply, left, right } => {
            let (_, greatest) = constant::range(value.ty);
            let is_small = [left, right]
                .into_iter()
                .filter_map(|side| known(side))
                .any(|factor| factor == 0 || greatest / factor.abs() >= ORDINARY);
            let fits = is_small || bounds::product_fits(left, right, value.ty);
            let inside = || product(left, divided).or_else(|| product(right, divided));
            if fits { inside() } else { Some((value, &**left, &**right)) }
        }
        ExprKind::Binary { op: BinaryOp::Add | BinaryOp::Subtract, left, right } => {
            product(left, divided).or_else(|| product(right, divided))
        }
        ExprKind::Binary { op: BinaryOp::Divide, left, .. } if divided => product(left, divided),
        ExprKind::Unary { op: UnaryOp::Negate, operand } => product(operand, divided),
        _ => None,
    }
}

impl walk::Visitor for Products<'_> {
    fn access(&mut self, access: &Access, _role: walk::Role) {
        let byte = match &access.base {
            Base::Indexed { byte, .. } => Some(&**byte),
            Base::Place(_) => None,
        };
        let values = access.indices.iter().map(|index| &index.value).chain(byte);
        self.addresses.extend(values.map(|value| (value.span.start, value.span.end)));
    }

    fn expr(&mut self, value: &Expr) {
        let ExprKind::Convert { conversion: Conversion::Value(_), operand } = &value.kind else { return };
        let own = operand.ty;
        let is_longer = own.is_integer() && own.bits() <= 16 && value.ty.bits() > own.bits();
        // A function of conversion says what is meant.
        let is_implicit = operand.span == value.span;
        if !is_longer || !is_implicit || self.addresses.contains(&(value.span.start, value.span.end)) {
            return;
        }
        // A division that becomes a REAL has a message of its own.
        let Some((product, left, right)) = product(operand, !value.ty.is_float()) else { return };
        let (own, target) = (own.name(), value.ty.name());
        let text = (self.text)(product.span);
        self.found.push(
            Diagnostic::new(Code::Narrowing, product.span, format!("`{text}` is of type {own} here, not {target}"))
                .label(format!("what does not fit {own} is lost before it becomes {target}"))
                .help(format!("write `{}`", self.longer(left, right, value.ty))),
        );
    }
}
