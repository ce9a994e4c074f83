//! `CALL MOVE` of the TIA Portal in STL: it copies a value from IN to OUT, as `L` and `T` do.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{self, OperandKind, PathRoot, Width};
use plcc_syntax::stl::StlInsn;

use crate::bind::declarations::block::CurrentBlock;
use crate::bind::stl::StlBinder;
use crate::bind::stl::settle::Settled;
use plcc_binding::fold;
use plcc_binding::value;
use plcc_model::layout;
use plcc_model::types::Elementary;
use plcc_model::{Operand, StlStatementKind};

/// The data type that an actual names for an instruction: `value_type := Int`.
pub fn named_type(parameter: &ast::Parameter) -> Option<Elementary> {
    let Some(OperandKind::Path(path)) = parameter.actual.as_ref().map(|actual| &actual.kind) else { return None };
    match &path.root {
        PathRoot::Bare { name, .. } if path.parts.is_empty() && fold(&parameter.name).ends_with("type") => {
            Elementary::from_word(&name.to_ascii_uppercase())
        }
        _ => None,
    }
}

/// Whether an actual names the data type of an instruction.
pub fn names_a_type(parameter: &ast::Parameter) -> bool {
    named_type(parameter).is_some()
}

/// The name of what is called without an instance; none: it is not called by a name.
pub fn called_name(call: &ast::Call) -> Option<&str> {
    let OperandKind::Path(path) = &call.target.kind else { return None };
    match &path.root {
        PathRoot::Quoted { name, .. } | PathRoot::Bare { name, .. } => {
            (path.parts.is_empty() && call.instance.is_none()).then_some(name.as_str())
        }
        PathRoot::Local { .. } | PathRoot::Block(_) => None,
    }
}

impl StlBinder<'_, '_> {
    /// Whether a call means the instruction MOVE: no block of the program has the name.
    pub fn is_move(&self, call: &ast::Call) -> bool {
        called_name(call).is_some_and(|name| fold(name) == "move" && self.program.globals.global(name).is_none())
    }

    /// `CALL MOVE (IN := …, OUT := …)` as load and transfer; `None` after a message.
    pub fn bind_move(&mut self, ctx: &mut CurrentBlock, call: &ast::Call) -> Option<[StlStatementKind; 2]> {
        let span = call.target.span;
        let (mut from, mut to) = (None, None);
        for parameter in call.parameters.iter().filter(|parameter| !names_a_type(parameter)) {
            match fold(&parameter.name).as_str() {
                "in" => from = parameter.actual.as_ref(),
                "out" | "out1" => to = parameter.actual.as_ref(),
                _ => {
                    self.program.report(
                        Diagnostic::new(
                            Code::UnknownParameter,
                            parameter.name_span,
                            format!("MOVE has no parameter `{}`", parameter.name),
                        )
                        .label("no such parameter")
                        .help("its parameters are IN and OUT"),
                    );
                    return None;
                }
            }
        }
        let (Some(from), Some(to)) = (from, to) else {
            self.program.report(
                Diagnostic::new(Code::MissingParameter, span, "MOVE needs IN and OUT").label("one of them is missing"),
            );
            return None;
        };
        let constant = self.constant_operand(ctx, from);
        let from = constant.as_ref().unwrap_or(from);
        let Settled::Memory { width, ty, .. } = self.settle(ctx, to)? else { return self.no_move(span) };
        let load = match self.settle(ctx, from)? {
            Settled::Literal(literal) => {
                let ty = ty.unwrap_or(crate::bind::declarations::path::type_of_width(width));
                let bytes = value::elementary_bytes(ty, literal, value::Place::Call).ok();
                match bytes.or_else(|| value::untyped_bytes(ty, literal)) {
                    Some(bytes) if matches!(bytes.len(), 1 | 2 | 4) && width != Width::Bit => {
                        let value = bytes.iter().fold(0, |value, &byte| value << 8 | u32::from(byte));
                        Operand::Const { value, wide: bytes.len() == 4 }
                    }
                    _ => return self.no_move(span),
                }
            }
            Settled::Memory { width: found, ty: source, .. } => {
                let same = match (source, ty) {
                    (Some(source), Some(ty)) => layout::width(source) == layout::width(ty),
                    _ => found == width,
                };
                if !same || matches!(width, Width::Bit | Width::Lword) {
                    return self.no_move(span);
                }
                self.bind_operand(ctx, StlInsn::Load, span, Some(from))?
            }
            _ => return self.no_move(span),
        };
        let transfer = self.bind_operand(ctx, StlInsn::Transfer, span, Some(to))?;
        Some([
            StlStatementKind::Instruction { insn: StlInsn::Load, operand: load },
            StlStatementKind::Instruction { insn: StlInsn::Transfer, operand: transfer },
        ])
    }

    fn no_move<T>(&mut self, span: Span) -> Option<T> {
        self.program.report(
            Diagnostic::new(
                Code::TypeMismatch,
                span,
                "MOVE in STL copies a value of 8, 16 or 32 bits to one of the same width",
            )
            .label("IN and OUT do not have one of these widths in common")
            .help("copy bits with `A` and `=`, structures and arrays with BLKMOV"),
        );
        None
    }
}
