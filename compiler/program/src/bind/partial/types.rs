//! Names, variables and data types of stand-ins, as they are written in declarations.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::ast::{BlockName, BlockPrefix, Bound, CellKind, TypeKind, TypeRef, Variable};

use super::evidence::{Elements, Shape};
use super::size;
use plcc_binding::fold;
use plcc_binding::stand_ins::Missing;
use plcc_model::layout;
use plcc_model::types::{DataType, ParameterType, StructType};

/// The name of a stand-in.
pub fn name_of(missing: &Missing, shape: &Shape, span: Span) -> BlockName {
    match missing.numbered() {
        // Unknown system blocks belong to the user.
        Some((prefix, number)) => BlockName::Numbered { prefix, number: u32::from(number), span },
        None => {
            let name = match missing {
                Missing::Name(folded) if shape.name.is_empty() => folded.clone(),
                _ => shape.name.clone(),
            };
            BlockName::Symbol { name, span }
        }
    }
}

/// Components as they are used, in the order of their first use.
pub fn members(shape: &Shape, span: Span) -> Vec<Variable> {
    let mut list: Vec<Variable> =
        shape.members.iter().map(|(_, member)| Variable::new(&member.name, type_of(member, span), span)).collect();
    if list.is_empty() && shape.elements.is_none() {
        list.push(Variable::new("UNKNOWN", named("WORD", span), span));
    }
    list
}

/// The type of a parameter; one that accepts anything if no other is possible.
pub fn parameter_type(shape: &Shape, output: bool, fb: bool, span: Span) -> TypeRef {
    let special = match &shape.ty {
        Some(DataType::Struct(structure)) if structure.instance_of.is_some() => true,
        Some(DataType::Parameter(_) | DataType::OpenArray(_)) => true,
        _ => false,
    };
    if shape.elements.is_none() && shape.members.is_empty() {
        if let Some(kind) = shape.cell.filter(|_| !output) {
            return named(if kind == CellKind::Timer { "TIMER" } else { "COUNTER" }, span);
        }
        if shape.is_db && shape.ty.is_none() && !output {
            return named("BLOCK_DB", span);
        }
        if special && !(output && fb) {
            return match &shape.ty {
                Some(ty @ DataType::Parameter(_)) => named(&layout::type_name(ty), span),
                _ => named("ANY", span),
            };
        }
    }
    type_of(shape, span)
}

/// A type by its word.
pub fn named(word: &str, span: Span) -> TypeRef {
    TypeRef { kind: TypeKind::Named(word.to_string()), span }
}

/// The elementary type that the uses of a name show.
pub fn elementary_of(shape: &Shape) -> Option<Elementary> {
    if !shape.members.is_empty() || shape.elements.is_some() {
        return None;
    }
    match (&shape.ty, shape.width, &shape.literal) {
        (Some(DataType::Elementary(ty)), ..) => Some(*ty),
        (Some(_), ..) => None,
        (None, width, Some(DataType::Elementary(ty))) => Some(match width {
            // A number next to an address of the same width is that number.
            Some(width) if width.bits() != ty.bits() => width,
            _ => *ty,
        }),
        (None, Some(width), _) => Some(width),
        (None, None, _) => None,
    }
}

/// Whether a name is used as a whole with a structure that has all components of the name.
pub fn has_components(shape: &Shape) -> bool {
    let Some(DataType::Struct(structure)) = &shape.ty else { return false };
    let has = |folded: &str| structure.members.iter().any(|member| fold(&member.name) == folded);
    !shape.members.is_empty() && shape.members.iter().all(|(folded, _)| has(folded))
}

/// The type of a text whose characters are used as well, `name[3]`.
pub fn text_of<'s>(shape: &'s Shape, elements: &Elements) -> Option<&'s DataType> {
    let text = shape.literal.as_ref().filter(|ty| matches!(ty, DataType::String(_) | DataType::WideString(_)))?;
    let Elements { bounds, shape: of, .. } = elements;
    let has_parts = of.elements.is_some() || !of.members.is_empty();
    let is_character = matches!(of.ty, None | Some(DataType::Elementary(Elementary::Char | Elementary::Wchar)));
    (bounds.len() == 1 && is_character && !has_parts).then_some(text)
}

/// The type that the uses of a name show, as written in a declaration.
pub fn type_of(shape: &Shape, span: Span) -> TypeRef {
    if let Some(of) = &shape.of {
        return TypeRef { kind: TypeKind::Block(name_of(of, &Shape::default(), span)), span };
    }
    if !shape.members.is_empty() && !has_components(shape) {
        return TypeRef { kind: TypeKind::Struct(members(shape, span)), span };
    }
    match (&shape.elements, &shape.ty) {
        (_, Some(ty @ (DataType::Array(_) | DataType::String(_) | DataType::WideString(_)))) => written(ty, span),
        (Some(elements), None) if let Some(text) = text_of(shape, elements) => written(text, span),
        (Some(elements), _) => {
            let bound = |(low, high)| (Bound::Number(low, span), Bound::Number(high, span));
            let bounds = size::array(elements).0.into_iter().map(bound).collect();
            let element = Box::new(type_of(&elements.shape, span));
            TypeRef { kind: TypeKind::Array { bounds, element }, span }
        }
        (None, Some(ty)) if !matches!(ty, DataType::Elementary(_)) => written(ty, span),
        (None, _) => match (elementary_of(shape), &shape.literal) {
            (Some(ty), _) => named(ty.name(), span),
            (None, Some(ty)) => written(ty, span),
            (None, None) => named("INT", span),
        },
    }
}

/// A type as written in a declaration.
fn written(ty: &DataType, span: Span) -> TypeRef {
    let number = |value: i64| Bound::Number(value, span);
    let kind = match ty {
        DataType::Elementary(ty) => TypeKind::Named(ty.name().to_string()),
        DataType::DateAndTime => TypeKind::Named("DATE_AND_TIME".to_string()),
        DataType::String(length) => TypeKind::String(Some(number(i64::from(*length)))),
        DataType::WideString(length) => TypeKind::WideString(Some(number(i64::from(*length)))),
        DataType::Array(array) => TypeKind::Array {
            bounds: array
                .bounds
                .iter()
                .map(|(low, high)| (number(i64::from(*low)), number(i64::from(*high))))
                .collect(),
            element: Box::new(written(&array.element, span)),
        },
        DataType::Struct(structure) => return written_structure(structure, span),
        DataType::OpenArray(array) => {
            let bounds = vec![(number(0), number(9)); usize::from(array.dimensions)];
            TypeKind::Array { bounds, element: Box::new(written(&array.element, span)) }
        }
        DataType::Parameter(ParameterType::Variant) => TypeKind::Named("VARIANT".to_string()),
        DataType::Parameter(_) | DataType::Void => TypeKind::Named("DWORD".to_string()),
    };
    TypeRef { kind, span }
}

/// A structure as written in a declaration: by its name if it has one.
pub fn written_structure(structure: &StructType, span: Span) -> TypeRef {
    let kind = match structure.instance_of {
        Some((sfb, number)) => {
            let prefix = if sfb { BlockPrefix::Sfb } else { BlockPrefix::Fb };
            TypeKind::Block(BlockName::Numbered { prefix, number: u32::from(number), span })
        }
        None if structure.name.is_empty() => TypeKind::Struct(
            structure
                .members
                .iter()
                .map(|member| Variable::new(&member.name, written(&member.ty, span), span))
                .collect(),
        ),
        None => match structure.name.strip_prefix("UDT ").and_then(|number| number.parse().ok()) {
            Some(number) => TypeKind::Block(BlockName::Numbered { prefix: BlockPrefix::Udt, number, span }),
            None => TypeKind::Block(BlockName::Symbol { name: structure.name.clone(), span }),
        },
    };
    TypeRef { kind, span }
}
