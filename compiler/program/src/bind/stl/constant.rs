//! Constants as operands: those that the block declares, those of tag tables, and those of the system such as `OB_Main`.

use plcc_syntax::ast::{self, OperandKind, PathRoot};

use crate::bind::declarations::block::CurrentBlock;
use crate::bind::stl::StlBinder;
use plcc_binding::fold;

impl StlBinder<'_, '_> {
    /// The value of the constant that an operand names, as an operand; `None`: it means something else.
    pub fn constant_operand(&self, ctx: &CurrentBlock, operand: &ast::Operand) -> Option<ast::Operand> {
        let OperandKind::Path(path) = &operand.kind else { return None };
        let (name, own, global) = match &path.root {
            PathRoot::Local { name, .. } => (name, true, false),
            PathRoot::Bare { name, .. } => (name, true, true),
            PathRoot::Quoted { name, .. } => (name, false, true),
            PathRoot::Block(_) => return None,
        };
        let folded = fold(name);
        if !path.parts.is_empty() || own && ctx.bound.locals.contains_key(&folded) {
            return None;
        }
        let globals = &self.program.globals;
        let value = match ctx.bound.constants.get(&folded) {
            Some(constant) if own => constant.in_stl()?,
            _ if !global || globals.names.symbols.contains_key(&folded) => return None,
            _ => match globals.names.constants.get(&folded) {
                Some(constant) => constant.in_stl()?,
                None => globals.system_constant(name)?.in_stl()?,
            },
        };
        Some(ast::Operand { kind: OperandKind::Literal(value), span: operand.span })
    }
}
