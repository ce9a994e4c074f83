//! Constants of blocks, which STL of the TIA Portal has, too.

use plcc_syntax::Elementary;
use plcc_syntax::ast::{CodeBlock, InitialKind, InitialValue, TypeKind};
use plcc_syntax::literal::Literal;

use super::types::elementary;

/// Gives constants their values as STL declares them. Those that STL cannot declare stay as they are: where they are written, a message
/// names them.
pub(crate) fn with_start_values(block: &mut CodeBlock) {
    for constant in &mut block.constants {
        let ty = match constant.ty.as_ref().map(|ty| &ty.kind) {
            Some(TypeKind::Named(name)) => elementary(name),
            _ => None,
        };
        // The accumulators have 32 bits, and bit logic has no constants.
        let Some(ty) = ty.filter(|ty| (8..=32).contains(&ty.bits())) else { continue };
        let Some(value) = &constant.value else { continue };
        let Some(literal) = crate::operand::constant(value) else { continue };
        let literal = match (literal, ty) {
            (Literal::Int(number), Elementary::Real) => Literal::Real(number as f32),
            (literal, _) => literal,
        };
        constant.initial = Some(InitialValue { kind: InitialKind::Literal(literal), span: value.span });
        constant.value = None;
    }
}
