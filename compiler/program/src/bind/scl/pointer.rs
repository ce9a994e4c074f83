//! Actual parameters of type POINTER, ANY and VARIANT. Source: SCL reference, parameters; STL reference, parameter types.

use plcc_syntax::scl::ast::{Expr as Node, ExprKind as NodeKind, Literal};

use super::Intent;
use super::actual::{access_type, is_variable};
use super::message::described;
use super::value::Value;
use crate::bind::declarations::pointer::{
    POINTS_AT_NOTHING, any_bytes, any_number_of_block, any_number_of_cell, code_for, code_for_elements, for_formal,
    known_pointer, local_place, pointed_at, pointed_at_by_literal, pointer_bytes,
};
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::constant::Constant;
use plcc_model::layout::{self, type_code};
use plcc_model::scl::{Access, Actual, Base, Complex, Expr, ExprKind};
use plcc_model::types::{DataType, Elementary, ParameterType};
use plcc_model::{BlockKey, Number, Parameter, Place, Pointed};

impl SclBinder<'_, '_> {
    /// The actual of a POINTER.
    pub fn pointer(
        &mut self,
        ctx: &mut SclBlock,
        callee: BlockKey,
        formal: &Parameter,
        node: &Node,
        intent: Intent,
    ) -> Option<Actual> {
        match &node.kind {
            NodeKind::Literal(Literal::Pointer { db, pointer }) => {
                self.program.use_db(*db, node.span);
                return Some(match local_place(*pointer) {
                    Some(place) => to_place(place, node, 0, 0),
                    None => Actual::PointerBytes(pointer_bytes(*db, *pointer)),
                });
            }
            NodeKind::Literal(Literal::Nil) => return Some(Actual::PointerBytes(vec![0; 6])),
            _ if is_variable(node) => {}
            _ => return self.wrong_actual(callee, formal, "not a variable", node.span),
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
    pub fn any(
        &mut self,
        ctx: &mut SclBlock,
        callee: BlockKey,
        formal: &Parameter,
        node: &Node,
        intent: Intent,
    ) -> Option<Actual> {
        match &node.kind {
            NodeKind::Literal(Literal::Any(bytes)) => {
                let [_, type_code, high, low, _, _, pointer @ ..] = *bytes;
                self.program.use_pointed_db(callee, &formal.name, *bytes, node.span);
                let count = u16::from_be_bytes([high, low]);
                let any = match local_place(u32::from_be_bytes(pointer)) {
                    Some(place) => to_place(place, node, type_code, count),
                    None => Actual::PointerBytes(bytes.to_vec()),
                };
                return Some(for_formal(formal, any, pointed_at_by_literal(type_code, count)));
            }
            NodeKind::Literal(Literal::Nil | Literal::Null) => {
                return Some(for_formal(formal, Actual::PointerBytes(any_bytes(0, 0, 0, 0)), POINTS_AT_NOTHING));
            }
            NodeKind::Literal(Literal::Pointer { .. }) => {
                return self.wrong_actual(callee, formal, "a pointer without a length", node.span);
            }
            _ => {}
        }
        if intent != Intent::Read {
            if !is_variable(node) {
                return self.wrong_actual(callee, formal, "not a variable", node.span);
            }
            let access = self.pointed(ctx, node, intent)?;
            return self.any_to(callee, formal, access, node);
        }
        match self.value(ctx, node)? {
            Value::Elementary(Expr { kind: ExprKind::Load(access), .. }) if access.part.is_none() => {
                self.any_to(callee, formal, *access, node)
            }
            Value::Complex { value: Complex::Variable(access), .. } | Value::Parameter { access, .. } => {
                self.any_to(callee, formal, access, node)
            }
            Value::Elementary(value) => Some(any_of_value(formal, value)),
            Value::Complex { value, ty, .. } => {
                let (type_code, count) = code_for(formal, &ty);
                let any = Actual::PointerToComplex { value, type_code, count: count.min(0xFFFF) as u16 };
                Some(for_formal(formal, any, pointed_at(&ty)))
            }
            Value::Constant(Constant::Text { bytes, .. }, _) if bytes.len() != 1 => {
                let ty = DataType::String(bytes.len().min(254) as u8);
                self.any_of_complex(ctx, formal, node, &ty)
            }
            Value::Constant(Constant::WideText(text), _) => {
                self.any_of_complex(ctx, formal, node, &DataType::WideString(text.len().min(254) as u16))
            }
            Value::Constant(Constant::DateAndTime(_), _) => {
                self.any_of_complex(ctx, formal, node, &DataType::DateAndTime)
            }
            value @ Value::Constant(..) => {
                let value = self.own_type(ctx, value)?;
                Some(any_of_value(formal, value))
            }
            Value::Cell { kind, number: Number::Known(number), .. } => {
                Some(for_formal(formal, Actual::PointerBytes(any_number_of_cell(kind, number)), POINTS_AT_NOTHING))
            }
            Value::Block { prefix, number: Number::Known(number), span } => match any_number_of_block(prefix, number) {
                Some(bytes) => Some(for_formal(formal, Actual::PointerBytes(bytes), POINTS_AT_NOTHING)),
                None => self.wrong_actual(callee, formal, "a block", span),
            },
            other => self.wrong_actual(callee, formal, &described(&other), node.span),
        }
    }

    fn any_of_complex(&mut self, ctx: &mut SclBlock, formal: &Parameter, node: &Node, ty: &DataType) -> Option<Actual> {
        let (type_code, count) = code_for(formal, ty);
        let value = self.complex(ctx, node, ty)?;
        let any = Actual::PointerToComplex { value, type_code, count: count.min(0xFFFF) as u16 };
        Some(for_formal(formal, any, pointed_at(ty)))
    }

    /// An ANY that points at a variable.
    fn any_to(&mut self, callee: BlockKey, formal: &Parameter, access: Access, node: &Node) -> Option<Actual> {
        let (type_code, count) = match &access.ty {
            DataType::Parameter(ParameterType::Any) => {
                return Some(for_formal(formal, Actual::PointerCopy(access), POINTS_AT_NOTHING));
            }
            DataType::Parameter(ParameterType::Variant) => {
                return Some(for_formal(formal, Actual::PointerCopy(access), Pointed::Copied));
            }
            DataType::OpenArray(array) if is_open_formal(&access) => {
                let (type_code, count) = code_for_elements(&array.element);
                let pointed = Pointed::Counted { ty: layout::type_number(&array.element) };
                return Some(for_formal(formal, Actual::PointerTo { access, type_code, count }, pointed));
            }
            DataType::Parameter(_) | DataType::OpenArray(_) | DataType::Void => {
                return self.wrong_actual(callee, formal, &access_type(&access), node.span);
            }
            _ if access.part.is_some() => {
                return self.wrong_actual(callee, formal, &access_type(&access), node.span);
            }
            // A STRING parameter of a function has the length of the actual; the pointer covers the longest.
            DataType::String(_) if matches!(access.base, Base::Place(Place::Parameter { byte: 0, .. })) => {
                code_for(formal, &DataType::String(254))
            }
            ty => code_for(formal, ty),
        };
        let count = count.min(0xFFFF) as u16;
        let pointed = pointed_at(&access.ty);
        let any = match known(&access) {
            Some((db, pointer)) => Actual::PointerBytes(any_bytes(type_code, count, db, pointer)),
            None => Actual::PointerTo { access, type_code, count },
        };
        Some(for_formal(formal, any, pointed))
    }

    /// The variable that a pointer points at. The target of an ANY or POINTER formal is not itself read or written here.
    fn pointed(&mut self, ctx: &mut SclBlock, node: &Node, intent: Intent) -> Option<Access> {
        self.access(ctx, node, intent)
    }
}

fn any_of_value(formal: &Parameter, value: Expr) -> Actual {
    let pointed = pointed_at(&DataType::Elementary(value.ty));
    let type_code = type_code(value.ty);
    for_formal(formal, Actual::PointerToValue { value, type_code }, pointed)
}

/// True of a parameter that is an ARRAY[*], which knows its bounds.
fn is_open_formal(access: &Access) -> bool {
    matches!(access.base, Base::Place(Place::Parameter { .. } | Place::ThroughPointer { .. }))
        && access.indices.is_empty()
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
