//! What can be asked of a VARIANT: TypeOf, TypeOfElements, IS_ARRAY. Each is a number in the VARIANT, or is known from a variable.
//!
//! A type is a double word: [`layout::type_number`] returns it, with one more bit for an array of that type. Source: S7-1500 information system,
//! comparators of VARIANT; decision 48.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{TypeKind, TypeRef};
use plcc_syntax::scl::ast::{BinaryOp as Operator, Expr as Node, ExprKind as NodeKind, Literal, NameForm};

use super::array::variant_field;
use super::expression::{binary_expr, constant_expr};
use super::function::{Kind, Named};
use super::pins::Pins;
use super::value::Value;
use crate::bind::declarations::pointer::pointed_at;
use crate::bind::declarations::typed::Use;
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::constant::Constant;
use plcc_binding::fold;
use plcc_model::Pointed;
use plcc_model::layout;
use plcc_model::scl::{BinaryOp, CompareOp, Conversion, Expr, ExprKind, Function};
use plcc_model::types::{DataType, ParameterType};

/// Marks an array of a type, as opposed to the type.
const ARRAY: u64 = 1 << 30;

/// A question about a type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Question {
    /// TypeOf.
    Type,
    /// TypeOfElements; 0 if it is not an array.
    ElementType,
    /// IS_ARRAY.
    IsArray,
}

impl SclBinder<'_, '_> {
    pub fn type_question(&mut self, ctx: &mut SclBlock, question: Question, pins: &Pins, span: Span) -> Option<Value> {
        let value = self.value(ctx, pins.get("IN")?)?;
        self.type_answer(question, &value, span)
    }

    /// The answer for a variable or a VARIANT.
    pub fn type_answer(&mut self, question: Question, value: &Value, span: Span) -> Option<Value> {
        if let Value::Parameter { access, .. } = value
            && access.ty == DataType::Parameter(ParameterType::Variant)
        {
            let elements = variant_field(access, layout::VARIANT_ELEMENTS, span)?;
            let ty = variant_field(access, layout::VARIANT_TYPE, span)?;
            return Some(Value::Elementary(answered(question, elements, ty, span)));
        }
        let pointed = match value {
            Value::Elementary(expr) => pointed_at(&DataType::Elementary(expr.ty)),
            Value::Constant(Constant::Typed { ty, .. }, _) => pointed_at(&DataType::Elementary(*ty)),
            Value::Complex { ty, .. } => pointed_at(ty),
            Value::Parameter { access, .. } => match &access.ty {
                DataType::OpenArray(array) => Pointed::Known { elements: 1, ty: layout::type_number(&array.element) },
                _ => return self.without_type(value),
            },
            other => return self.without_type(other),
        };
        let Pointed::Known { elements, ty } = pointed else { return None };
        let array = if elements > 0 { ARRAY } else { 0 };
        let (ty, bits) = match question {
            Question::Type => (Elementary::Dword, u64::from(ty) ^ array),
            Question::ElementType if elements == 0 => (Elementary::Dword, 0),
            Question::ElementType => (Elementary::Dword, u64::from(ty)),
            Question::IsArray => (Elementary::Bool, u64::from(elements > 0)),
        };
        Some(Value::Elementary(constant_expr(bits, ty, span)))
    }

    fn without_type<T>(&mut self, value: &Value) -> Option<T> {
        let is = super::message::described(value);
        self.wrong_type(value.span(), &is, "a VARIANT or a variable", None);
        None
    }

    /// The right side of `TypeOf(x) = Int`, and a label of `CASE TypeOf(x) OF`: the number of the type; `None`: it is not a type.
    pub fn named_type_number(&mut self, ctx: &SclBlock, node: &Node) -> Option<Constant> {
        let NodeKind::Name(name) = &node.kind else { return None };
        let folded = fold(&name.text);
        let hidden = ctx.block.bound.locals.contains_key(&folded) || ctx.block.bound.constants.contains_key(&folded);
        // A name in quotes is that of a type, even if a local variable has it.
        if name.form == NameForm::Local || (hidden && name.form == NameForm::Bare) {
            return None;
        }
        let word = match name.form {
            NameForm::Quoted => name.text.clone(),
            NameForm::Bare | NameForm::Local => name.text.to_ascii_uppercase(),
        };
        let kind = match word.as_str() {
            "STRING" => TypeKind::String(None),
            _ => TypeKind::Named(word),
        };
        let typed = self.program.resolve_type(&TypeRef { kind, span: node.span }, Use::Component)?;
        Some(Constant::Typed { ty: Elementary::Dword, bits: layout::type_number(&typed.ty).into() })
    }

    /// True of `TypeOf(…)`, `TypeOfElements(…)` and `TypeOfDB(…)`.
    pub fn asks_for_type(&self, node: &Node) -> bool {
        let NodeKind::Call { callee, .. } = &node.kind else { return false };
        let NodeKind::Name(name) = &callee.kind else { return false };
        let asks = |row: &super::function::Row| matches!(row.kind, Kind::Type(Question::Type | Question::ElementType));
        // TypeOfDB is a function of the library.
        let of_db = name.text.trim().eq_ignore_ascii_case("TypeOfDB");
        !self.program.globals.names.symbols.contains_key(&fold(&name.text))
            && (of_db || matches!(Named::find(&name.text), Some(Named::Row { row, .. }) if asks(row)))
    }

    /// `v = NULL`: TRUE of a VARIANT that points at nothing.
    pub fn compared_with_null(&self, op: Operator, left: Option<&Value>, right: &Node, span: Span) -> Option<Value> {
        let op = match op {
            Operator::Equal => CompareOp::Equal,
            Operator::NotEqual => CompareOp::NotEqual,
            _ => return None,
        };
        match (left, &right.kind) {
            (Some(left), NodeKind::Literal(Literal::Nil | Literal::Null)) => {
                null_answer(op, left, span).or_else(|| self.reference_is_null(op, left, span))
            }
            _ => None,
        }
    }

    /// The value of the right side of a comparison whose left side asks for a type.
    pub fn compared_type_name(&mut self, ctx: &SclBlock, op: Operator, left: &Node, right: &Node) -> Option<Value> {
        let asks = matches!(op, Operator::Equal | Operator::NotEqual) && self.asks_for_type(left);
        let number = asks.then(|| self.named_type_number(ctx, right)).flatten()?;
        Some(Value::Constant(number, right.span))
    }
}

/// `v = NULL` or `v <> NULL` of a VARIANT; `None` of anything else.
pub fn null_answer(op: CompareOp, value: &Value, span: Span) -> Option<Value> {
    let Value::Parameter { access, .. } = value else { return None };
    if access.ty != DataType::Parameter(ParameterType::Variant) {
        return None;
    }
    let ty = variant_field(access, layout::VARIANT_TYPE, span)?;
    let zero = constant_expr(0, Elementary::Udint, span);
    let kind = ExprKind::Compare { op, left: Box::new(ty), right: Box::new(zero) };
    Some(Value::Elementary(Expr { kind, ty: Elementary::Bool, span }))
}

/// The result for a VARIANT with these fields.
fn answered(question: Question, elements: Expr, ty: Expr, span: Span) -> Expr {
    let is_array = Expr {
        kind: ExprKind::Compare {
            op: CompareOp::NotEqual,
            left: Box::new(elements),
            right: Box::new(constant_expr(0, Elementary::Udint, span)),
        },
        ty: Elementary::Bool,
        span,
    };
    let bits = super::convert::converted(ty, Conversion::Bits { checked: false }, Elementary::Dword);
    let select = |no: Expr, yes: Expr| Expr {
        kind: ExprKind::Function { function: Function::Select, arguments: vec![is_array.clone(), no, yes] },
        ty: Elementary::Dword,
        span,
    };
    match question {
        Question::IsArray => is_array,
        Question::ElementType => select(constant_expr(0, Elementary::Dword, span), bits),
        Question::Type => {
            let mark = constant_expr(ARRAY, Elementary::Dword, span);
            select(bits.clone(), binary_expr(BinaryOp::Xor, bits, mark, Elementary::Dword, span))
        }
    }
}
