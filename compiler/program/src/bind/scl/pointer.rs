//! Actual parameters of type POINTER and ANY. Source: SCL reference, parameters; STL reference, parameter types.

use plcc_syntax::scl::ast::{Expr as Node, ExprKind as NodeKind, Literal};

use super::Intent;
use super::actual::{access_type, is_variable};
use super::message::described;
use super::value::Value;
use crate::bind::actual::{any_bytes, any_number_of_block, any_number_of_cell, any_of, known_pointer, local_place};
use crate::bind::actual::{pointer_bytes, type_code};
use crate::bind::constant::Constant;
use crate::bind::{Binder, Ctx};
use crate::model::scl::{Access, Actual, Base, Complex, Expr, ExprKind};
use crate::model::{BlockKey, Number, Parameter, Place};
use crate::types::{DataType, Elementary, ParameterType};

impl Binder<'_> {
    /// The actual of a POINTER.
    pub fn scl_pointer(
        &mut self,
        ctx: &mut Ctx,
        callee: BlockKey,
        formal: &Parameter,
        node: &Node,
        intent: Intent,
    ) -> Option<Actual> {
        match &node.kind {
            NodeKind::Literal(Literal::Pointer { db, pointer }) => {
                self.use_db(*db, node.span);
                return Some(match local_place(*pointer) {
                    Some(place) => to_place(place, node, 0, 0),
                    None => Actual::PointerBytes(pointer_bytes(*db, *pointer)),
                });
            }
            NodeKind::Literal(Literal::Nil) => return Some(Actual::PointerBytes(vec![0; 6])),
            _ if is_variable(node) => {}
            _ => return self.wrong_actual(callee, formal, "no variable", node.span),
        }
        let access = self.pointed(ctx, node, intent)?;
        match &access.ty {
            DataType::Parameter(ParameterType::Pointer) => Some(Actual::PointerCopy(access)),
            DataType::Parameter(_) | DataType::OpenArray(_) | DataType::Void => {
                self.wrong_actual(callee, formal, &access_type(&access), node.span)
            }
            _ if access.part.is_some() => self.wrong_actual(callee, formal, &access_type(&access), node.span),
            _ => Some(match known(&access) {
                Some((db, pointer)) => Actual::PointerBytes(pointer_bytes(db, pointer)),
                None => Actual::PointerTo { access, type_code: 0, count: 0 },
            }),
        }
    }

    /// The actual of an ANY.
    pub fn scl_any(
        &mut self,
        ctx: &mut Ctx,
        callee: BlockKey,
        formal: &Parameter,
        node: &Node,
        intent: Intent,
    ) -> Option<Actual> {
        match &node.kind {
            NodeKind::Literal(Literal::Any(bytes)) => {
                let [_, type_code, high, low, db_high, db_low, pointer @ ..] = *bytes;
                self.use_db(u16::from_be_bytes([db_high, db_low]), node.span);
                return Some(match local_place(u32::from_be_bytes(pointer)) {
                    Some(place) => to_place(place, node, type_code, u16::from_be_bytes([high, low])),
                    None => Actual::PointerBytes(bytes.to_vec()),
                });
            }
            NodeKind::Literal(Literal::Nil | Literal::Null) => {
                return Some(Actual::PointerBytes(any_bytes(0, 0, 0, 0)));
            }
            NodeKind::Literal(Literal::Pointer { .. }) => {
                return self.wrong_actual(callee, formal, "a pointer without a length", node.span);
            }
            _ => {}
        }
        if intent != Intent::Read {
            if !is_variable(node) {
                return self.wrong_actual(callee, formal, "no variable", node.span);
            }
            let access = self.pointed(ctx, node, intent)?;
            return self.any_to(callee, formal, access, node);
        }
        match self.scl_value(ctx, node)? {
            Value::Elementary(Expr { kind: ExprKind::Load(access), .. }) if access.part.is_none() => {
                self.any_to(callee, formal, *access, node)
            }
            Value::Complex { value: Complex::Variable(access), .. } | Value::Parameter { access, .. } => {
                self.any_to(callee, formal, access, node)
            }
            Value::Elementary(value) => {
                let type_code = type_code(value.ty);
                Some(Actual::PointerToValue { value, type_code })
            }
            Value::Complex { value, ty, .. } => {
                let (type_code, count) = any_of(&ty);
                Some(Actual::PointerToComplex { value, type_code, count: count.min(0xFFFF) as u16 })
            }
            Value::Constant(Constant::Text { bytes, .. }, _) if bytes.len() != 1 => {
                let ty = DataType::String(bytes.len().min(254) as u8);
                self.any_of_complex(ctx, node, &ty)
            }
            Value::Constant(Constant::DateAndTime(_), _) => self.any_of_complex(ctx, node, &DataType::DateAndTime),
            value @ Value::Constant(..) => {
                let value = self.scl_own_type(ctx, value)?;
                let type_code = type_code(value.ty);
                Some(Actual::PointerToValue { value, type_code })
            }
            Value::Cell { kind, number: Number::Known(number), .. } => {
                Some(Actual::PointerBytes(any_number_of_cell(kind, number)))
            }
            Value::Block { prefix, number: Number::Known(number), span } => match any_number_of_block(prefix, number) {
                Some(bytes) => Some(Actual::PointerBytes(bytes)),
                None => self.wrong_actual(callee, formal, "a block", span),
            },
            other => self.wrong_actual(callee, formal, &described(&other), node.span),
        }
    }

    fn any_of_complex(&mut self, ctx: &mut Ctx, node: &Node, ty: &DataType) -> Option<Actual> {
        let (type_code, count) = any_of(ty);
        let value = self.scl_complex(ctx, node, ty)?;
        Some(Actual::PointerToComplex { value, type_code, count: count.min(0xFFFF) as u16 })
    }

    /// An ANY that points at a variable.
    fn any_to(&mut self, callee: BlockKey, formal: &Parameter, access: Access, node: &Node) -> Option<Actual> {
        let counts = self.library_block(callee).is_some_and(|block| COUNTS_ELEMENTS.contains(&block.name));
        if counts && !has_counted_elements(&access.ty) {
            let is = format!("{}, whose elements an ANY does not count", access_type(&access));
            return self.wrong_actual(callee, formal, &is, node.span);
        }
        let (type_code, count) = match &access.ty {
            DataType::Parameter(ParameterType::Any) => return Some(Actual::PointerCopy(access)),
            DataType::Parameter(_) | DataType::OpenArray(_) | DataType::Void => {
                return self.wrong_actual(callee, formal, &access_type(&access), node.span);
            }
            _ if access.part.is_some() => {
                return self.wrong_actual(callee, formal, &access_type(&access), node.span);
            }
            // A STRING of a function's caller has the length of the actual; the pointer covers the largest.
            DataType::String(_) if matches!(access.base, Base::Place(Place::Parameter { byte: 0, .. })) => {
                any_of(&DataType::String(254))
            }
            ty => any_of(ty),
        };
        let count = count.min(0xFFFF) as u16;
        Some(match known(&access) {
            Some((db, pointer)) => Actual::PointerBytes(any_bytes(type_code, count, db, pointer)),
            None => Actual::PointerTo { access, type_code, count },
        })
    }

    /// The variable at which a pointer points. What an ANY or POINTER formal refers to is not itself read or written here.
    fn pointed(&mut self, ctx: &mut Ctx, node: &Node, intent: Intent) -> Option<Access> {
        self.scl_access(ctx, node, intent)
    }
}

/// Instructions that number the elements of what an ANY points at.
const COUNTS_ELEMENTS: [&str; 1] = ["MOVE_BLK_VARIANT"];

/// True if an ANY says how many elements there are: those that have a type of ANY and whole bytes. A formal says it when it is called.
fn has_counted_elements(ty: &DataType) -> bool {
    let counted = |ty: &Elementary| matches!(ty.bits(), 8 | 16 | 32);
    match ty {
        DataType::Array(array) => match &array.element {
            DataType::Elementary(ty) => counted(ty),
            DataType::DateAndTime => true,
            _ => false,
        },
        DataType::Elementary(ty) => counted(ty),
        DataType::Parameter(ParameterType::Any) => true,
        _ => false,
    }
}

/// A pointer to local data of this block.
fn to_place(place: Place, node: &Node, type_code: u8, count: u16) -> Actual {
    let access = Access {
        base: Base::Place(place),
        indices: Vec::new(),
        ty: DataType::Elementary(Elementary::Byte),
        part: None,
        span: node.span,
    };
    Actual::PointerTo { access, type_code, count }
}

/// DB number and area pointer of a variable whose address is known.
fn known(access: &Access) -> Option<(u16, u32)> {
    match &access.base {
        Base::Place(place) if access.indices.is_empty() && access.part.is_none() => known_pointer(place),
        _ => None,
    }
}
