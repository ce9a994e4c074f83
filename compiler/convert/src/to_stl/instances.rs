//! Instances of function blocks where STL has none: in arrays and structures, and as in-out parameters.

use plcc_diag::{Code, Diagnostic};
use plcc_syntax::ast::{self, Block, BlockName, CodeBlock, SectionKind, SourceUnit, TypeKind, TypeRef};
use plcc_syntax::network::ast::{Content, Element, Target};
use plcc_syntax::network::elements::{Kind, find_sd};
use plcc_syntax::scl::ast::{Expr, ExprKind};

use super::types::Types;
use crate::xml::system;

/// What cannot be written in STL, and what to do.
type Refusal = (&'static str, &'static str);

const ELEMENT: Refusal = ("an array of instances", "declare the instances one by one");
const COMPONENT: Refusal = ("an instance in a structure", "declare the instance as a variable of its own in VAR");
const PARAMETER: Refusal = (
    "an instance as an in-out parameter",
    "give the block a parameter of its own for each value of the instance that it uses",
);

/// The messages about the variables of the blocks in SCL and GRAPH of a source.
pub fn of_unit(unit: &SourceUnit, types: &Types) -> Vec<Diagnostic> {
    let of = |block: &Block| match block {
        Block::Code(block) if matches!(block.code, ast::Code::Scl(_) | ast::Code::Chart(_)) => of_block(block, types),
        Block::Code(_) | Block::Data(_) | Block::Type(_) => Vec::new(),
    };
    unit.blocks.iter().flat_map(of).collect()
}

/// The messages about the variables of a block.
pub(super) fn of_block(block: &CodeBlock, types: &Types) -> Vec<Diagnostic> {
    let mut messages = Vec::new();
    for section in &block.sections {
        for variable in &section.variables {
            let is_parameter = section.kind == SectionKind::InOut
                && is_instance(&variable.ty, types)
                && (types.is_function_block(&variable.ty) || may_call(block, &variable.name));
            let found = if is_parameter { Some(PARAMETER) } else { inside(&variable.ty, types) };
            if let Some((what, help)) = found {
                let title = format!("STL has no form for {what}");
                let message = Diagnostic::new(Code::NotConverted, variable.name_span, title);
                messages.push(message.label("cannot be converted").help(help));
            }
        }
    }
    messages
}

/// Whether a block may call an instance that it was given. Of timers and counters that it only reads, STL takes the values.
fn may_call(block: &CodeBlock, name: &str) -> bool {
    let is_own = |instance: &Expr| match &instance.kind {
        ExprKind::Name(own) => own.text.eq_ignore_ascii_case(name),
        _ => false,
    };
    let calls = |element: &Element| match &element.target {
        Target::Element { instance, .. } => instance.as_ref().is_some_and(is_own),
        Target::Block { callee, instance } => is_own(callee) || instance.as_ref().is_some_and(is_own),
    };
    match &block.code {
        ast::Code::Graphic(body) => body.networks.iter().any(|network| match &network.content {
            Content::Graphic(graph) => graph.elements.iter().any(calls),
            Content::Scl(_) => true,
            Content::Stl(_) => false,
        }),
        _ => true,
    }
}

/// What is wrong with the elements and components of a type.
fn inside(ty: &TypeRef, types: &Types) -> Option<Refusal> {
    match &ty.kind {
        TypeKind::Array { element, .. } if types.is_function_block(element) => Some(ELEMENT),
        TypeKind::Array { element, .. } => inside(element, types),
        TypeKind::Struct(members) => members.iter().find_map(|member| match types.is_function_block(&member.ty) {
            true => Some(COMPONENT),
            false => inside(&member.ty, types),
        }),
        TypeKind::Named(_)
        | TypeKind::Block(_)
        | TypeKind::String(_)
        | TypeKind::WideString(_)
        | TypeKind::OpenArray { .. }
        | TypeKind::Reference(_)
        | TypeKind::Error => None,
    }
}

/// Whether variables of a type are instances of a function block of the program, or of a timer, counter or edge of the library.
fn is_instance(ty: &TypeRef, types: &Types) -> bool {
    let name = match &ty.kind {
        TypeKind::Named(name) | TypeKind::Block(BlockName::Symbol { name, .. }) => name,
        _ => return types.is_function_block(ty),
    };
    let is_own_type = types.is_type(&BlockName::Symbol { name: name.clone(), span: ty.span });
    let is_cell = || {
        let has_row = find_sd(name).is_some_and(|(row, _)| matches!(row.kind, Kind::Instance(_)));
        has_row || system::members().any(|(known, _)| known.eq_ignore_ascii_case(name))
    };
    types.is_function_block(ty) || (!is_own_type && is_cell())
}
