//! References: `REF_TO` types, `REF(x)`, `r^`, `r ?= v`, NULL.
//!
//! A reference is a structure with the number of a data block, and bit and byte in it; all 0 is NULL. Only data of data blocks and instances
//! can be referenced, so one stays valid. REFERENCE_OF of the library makes it from a VARIANT. Source: S7-1500 information system, references.

use plcc_diag::{Code, Span};
use plcc_syntax::scl::ast::{Argument, AssignOp, Expr as Node, ExprKind as NodeKind, Literal, Name, NameForm};
use plcc_syntax::{Class, Elementary};

use super::Intent;
use super::compare::comparison;
use super::expression::constant_expr;
use super::place::{Root, Spot};
use super::value::Value;
use crate::bind::declarations::pointer::pointed_at;
use crate::bind::declarations::reference::reference_to;
use crate::bind::scl::{SclBinder, SclBlock};
use crate::bind::trees::SYSTEM_FILE;
use plcc_model::layout;
use plcc_model::scl::{Access, Base, CompareOp, Complex, Expr, ExprKind, IndexedArea};
use plcc_model::types::DataType;
use plcc_model::{Place, Pointed};

/// The function of the library that makes references.
const MAKER: &str = "REFERENCE_OF";

/// What a reference refers to.
fn target_of(ty: &DataType) -> Option<&DataType> {
    match ty {
        DataType::Struct(structure) => structure.refers_to.as_ref(),
        _ => None,
    }
}

pub(super) fn bare(text: &str, span: Span) -> Name {
    Name { text: text.to_string(), form: NameForm::Bare, span }
}

pub(super) fn argument(name: &str, value: Node) -> Argument {
    let span = value.span;
    Argument { name: Some(bare(name, span)), output: false, value: Some(value), span }
}

impl SclBinder<'_, '_> {
    /// `r^` as a variable.
    pub(super) fn dereferenced(&mut self, ctx: &mut SclBlock, base: &Node, span: Span) -> Option<Spot> {
        let reference = self.access(ctx, base, Intent::Read)?;
        let Some(target) = target_of(&reference.ty).cloned() else {
            let is = format!("of type {}", layout::type_name(&reference.ty));
            self.wrong_type(base.span, &is, "a reference (REF_TO)", None);
            return None;
        };
        let DataType::Struct(structure) = reference.ty.clone() else { return None };
        let mut fields = structure.members.iter().map(|member| {
            let DataType::Elementary(ty) = member.ty else { unreachable!("components of a reference are numbers") };
            let access = super::place::part_of(&reference, member)?;
            Some(Expr { kind: ExprKind::Load(Box::new(access)), ty, span })
        });
        let (db, bit, byte) = (fields.next()??, fields.next()??, fields.next()??);
        let bit = (target == DataType::Elementary(Elementary::Bool)).then(|| Box::new(bit));
        let root = Root::Indexed { area: IndexedArea::DynamicDb(Box::new(db)), byte: Box::new(byte), bit };
        Some(Spot { root, byte: 0, bit: 0, indices: Vec::new(), ty: target, part: None })
    }

    /// `REF(x)`.
    pub(super) fn reference(&mut self, ctx: &mut SclBlock, node: &Node, span: Span) -> Option<Value> {
        let access = self.access(ctx, node, Intent::Both)?;
        let in_db = matches!(
            access.base,
            Base::Place(Place::Db { .. } | Place::Instance { .. })
                | Base::Indexed { area: IndexedArea::DynamicDb(_), .. }
        );
        if !in_db || access.part.is_some() || matches!(access.ty, DataType::Parameter(_) | DataType::OpenArray(_)) {
            let text = self.program.globals.text(node.span);
            self.refuse(
                Code::OperandKind,
                node.span,
                &format!("there is no reference to `{text}`"),
                "not data of a data block or of an instance",
                "reference a static variable, or a variable in a data block",
            );
            return None;
        }
        let ty = access.ty.clone();
        self.made(ctx, node.clone(), None, &ty, span)
    }

    /// The value of `r := NULL` and `r ?= v`; `None`: another assignment; `Some(None)`: after a message.
    pub(super) fn reference_for_target(
        &mut self,
        ctx: &mut SclBlock,
        targets: &[(Node, AssignOp)],
        node: &Node,
        span: Span,
    ) -> Option<Option<Value>> {
        let attempt = targets.iter().any(|(_, op)| *op == AssignOp::Attempt);
        let null = matches!(node.kind, NodeKind::Literal(Literal::Null));
        let (target, _) = targets.first().filter(|_| attempt || null)?;
        if targets.len() > 1 {
            self.misplaced_reference(span, "a reference gets this value in a statement of its own");
            return Some(None);
        }
        let told = self.program.globals.report.diagnostics.len();
        let Some(access) = self.access(ctx, target, Intent::Write) else { return Some(None) };
        // The assignment itself reports mistakes in its target.
        self.program.globals.report.diagnostics.truncate(told);
        let Some(to) = target_of(&access.ty).cloned() else {
            let is = format!("of type {}", layout::type_name(&access.ty));
            let nothing = match &access.ty {
                DataType::Elementary(Elementary::Bool) => Some("FALSE"),
                DataType::Elementary(Elementary::Time) => Some("T#0s"),
                DataType::Elementary(ty) if ty.class() == Class::Float => Some("0.0"),
                DataType::Elementary(ty) if matches!(ty.class(), Class::Signed | Class::Unsigned | Class::Bits) => {
                    Some("0")
                }
                DataType::String(_) => Some("''"),
                _ => None,
            };
            let text = self.program.globals.text(target.span);
            let help =
                nothing.filter(|_| null).map(|value| format!("NULL is for references: write `{text} := {value};`"));
            self.wrong_type(target.span, &is, "a reference (REF_TO)", help);
            return Some(None);
        };
        if null {
            return Some(self.made(ctx, node.clone(), None, &to, span));
        }
        let Pointed::Known { elements, ty } = pointed_at(&to) else {
            self.misplaced_reference(span, "the type of this reference is not known to a VARIANT");
            return Some(None);
        };
        let bytes = match to {
            DataType::String(_) | DataType::WideString(_) => layout::bytes(&to),
            _ => 0,
        };
        Some(self.made(ctx, node.clone(), Some((ty, elements, bytes)), &to, span))
    }

    /// A part of a reference where it is not possible.
    pub(super) fn misplaced_reference(&mut self, span: Span, title: &str) {
        let help = "write `r := REF(x)`, `r := NULL`, `r ?= v`, `r = NULL`, with a variable of type REF_TO";
        self.refuse(Code::TypeMismatch, span, title, "not possible here", help);
    }

    /// A call that makes a reference to `ty`. `wanted`: number of the type, elements and length of a text, if they are not known.
    fn made(
        &mut self,
        ctx: &mut SclBlock,
        data: Node,
        wanted: Option<(u32, u32, u32)>,
        ty: &DataType,
        span: Span,
    ) -> Option<Value> {
        let (number, elements, bytes) = wanted.unwrap_or_default();
        let constant = |bits: u32| {
            let literal = Literal::Typed { ty: Elementary::Dword, bits: bits.into() };
            Node { kind: NodeKind::Literal(literal), span }
        };
        let arguments = vec![
            argument("DATA", data),
            argument("KIND", constant(number)),
            argument("ELEMENTS", constant(elements)),
            argument("BYTES", constant(bytes)),
        ];
        let callee = Box::new(Node { kind: NodeKind::Name(bare(MAKER, Span::new(SYSTEM_FILE, 0..0))), span });
        match self.call(ctx, &Node { kind: NodeKind::Call { callee, arguments }, span }, false)? {
            Value::Complex { value, ty: DataType::Struct(structure), span } => {
                Some(Value::Complex { value, ty: reference_to(&structure, ty), span })
            }
            _ => None,
        }
    }

    /// `r = NULL`, `r <> NULL`; `None`: not a reference.
    pub(super) fn reference_is_null(&self, op: CompareOp, value: &Value, span: Span) -> Option<Value> {
        let Value::Complex { value: Complex::Variable(access), ty, .. } = value else { return None };
        target_of(ty)?;
        let DataType::Struct(structure) = ty else { return None };
        let db = super::place::part_of(access, structure.members.first()?)?;
        let left = Expr { kind: ExprKind::Load(Box::new(db)), ty: Elementary::Word, span };
        let right = constant_expr(0, Elementary::Word, span);
        let kind = ExprKind::Compare { op, left: Box::new(left), right: Box::new(right) };
        Some(Value::Elementary(Expr { kind, ty: Elementary::Bool, span }))
    }
    /// `r = REF(x)`, `REF(x) <> r`; `None`: other values, or two variables, which are compared as structures.
    pub(super) fn compared_references(
        &mut self,
        ctx: &mut SclBlock,
        op: CompareOp,
        left: &Value,
        right: &Value,
        span: Span,
    ) -> Option<Option<Expr>> {
        let target = |value: &Value| match value {
            Value::Complex { ty, .. } => target_of(ty).cloned(),
            _ => None,
        };
        let is_variable = |value: &Value| matches!(value, Value::Complex { value: Complex::Variable(_), .. });
        if target(left)? != target(right)? || (is_variable(left) && is_variable(right)) {
            return None;
        }
        let ty = self.program.predefined("REFERENCE", span)?.ty;
        let values = vec![untargeted(left, &ty), untargeted(right, &ty)];
        let same = match self.instruction_value(ctx, "SAME_REFERENCE", values, span) {
            Some(Value::Elementary(same)) => same,
            _ => return Some(None),
        };
        Some(Some(comparison(op, same, constant_expr(1, Elementary::Bool, span), span)))
    }
}

/// A reference as the structure that all of them are.
fn untargeted(value: &Value, ty: &DataType) -> Value {
    match value {
        Value::Complex { value: Complex::Variable(access), span, .. } => {
            let access = Access { ty: ty.clone(), ..access.clone() };
            Value::Complex { value: Complex::Variable(access), ty: ty.clone(), span: *span }
        }
        Value::Complex { value, span, .. } => Value::Complex { value: value.clone(), ty: ty.clone(), span: *span },
        other => other.clone(),
    }
}
