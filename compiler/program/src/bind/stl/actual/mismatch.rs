//! The message about an actual whose type is not that of the formal.

use plcc_diag::{Code, Diagnostic, Span};
use plcc_syntax::ast::{BlockPrefix, CellKind, Width};

use crate::bind::globals::sources::portal_cpu;
use crate::bind::stl::StlBinder;
use crate::bind::stl::settle::Settled;
use plcc_binding::{rewrite, value};
use plcc_model::layout;
use plcc_model::types::{DataType, Elementary, ParameterType};
use plcc_model::{Actual, BlockKey, Number, Parameter};

impl StlBinder<'_, '_> {
    /// Reports an actual whose type is not that of the formal.
    pub(super) fn mismatch(
        &mut self,
        callee: BlockKey,
        formal: &Parameter,
        settled: &Settled,
        span: Span,
    ) -> Option<Actual> {
        let text = self.program.globals.text(span);
        let is = match settled {
            Settled::Memory { ty: Some(ty), .. } => ty.name().to_string(),
            Settled::Memory { width, .. } => match width {
                Width::Bit => "a bit",
                Width::Byte => "a byte",
                Width::Word => "a word",
                Width::Dword => "a double word",
                Width::Lword => "a long word",
            }
            .to_string(),
            Settled::Complex { ty, .. } => layout::type_name(ty),
            Settled::Cell { kind: CellKind::Timer, .. } => "a timer".to_string(),
            Settled::Cell { kind: CellKind::Counter, .. } => "a counter".to_string(),
            Settled::Block { .. } => "a block".to_string(),
            Settled::Literal(literal) => value::literal_kind(literal).to_string(),
            Settled::Pointer(_) | Settled::ParameterPointer(_) => "a pointer".to_string(),
            Settled::Status(_) => "a status bit".to_string(),
            Settled::Special(_) | Settled::Register(_) => "a register of the CPU".to_string(),
            Settled::Label => "a name without a meaning here".to_string(),
        };
        let wanted = layout::type_name(&formal.ty);
        let is = match &formal.ty {
            DataType::Struct(structure) if structure.name.is_empty() && is == wanted => format!("another {wanted}"),
            _ => is,
        };
        let message = Diagnostic::new(
            Code::TypeMismatch,
            span,
            format!(
                "`{}` of {} is of type {wanted}, but `{text}` is {is}",
                formal.name,
                self.program.globals.shown(callee)
            ),
        )
        .label(is);
        // A data block whose data could be the variable.
        if let (DataType::Struct(_) | DataType::Array(_), Settled::Block { prefix: BlockPrefix::Db, number }) =
            (&formal.ty, settled)
            && let Number::Known(number) = number
            && !portal_cpu(self.program.globals.input)
            && self.program.data.db_type(*number).is_some_and(|ty| ty.bytes == layout::bytes(&formal.ty))
        {
            let help = format!("write `P#DB{number}.DBX 0.0`, the address of its data, or name a variable");
            self.program.report(message.help(help));
            return None;
        }
        self.program.report(match (&formal.ty, settled) {
            (DataType::Elementary(ty), Settled::Literal(_)) => {
                message.help(rewrite::help(*ty, &text, rewrite::Form::Stl))
            }
            (DataType::Elementary(ty), _) => {
                message.help(format!("name {} or a variable of type {wanted}", address_of_type(*ty, &text)))
            }
            (DataType::Parameter(ParameterType::Any | ParameterType::Variant), _) => {
                let is_pointer = text.get(..2).is_some_and(|sign| sign.eq_ignore_ascii_case("P#"));
                message.help(match rewrite::any_pointer(&text) {
                    Some(pointer) => format!("write `{pointer}`, or name a variable"),
                    None if is_pointer => format!("write the type and the number after it, as in `{text} BYTE 1`"),
                    None => "name a variable, or write a pointer to an area: `P#`, its first bit, a type and a number"
                        .to_string(),
                })
            }
            (DataType::Parameter(ParameterType::Pointer), _) => {
                message.help("write for example `P#M 50.0`, or name a variable")
            }
            (
                DataType::DateAndTime | DataType::String(_) | DataType::Array(_) | DataType::Struct(_),
                Settled::Literal(_),
            ) => message.help(format!("store the value in a variable of type {wanted} and pass that variable")),
            (DataType::Parameter(ParameterType::Timer), _) => {
                message.help("name a timer such as `T 5`, or a parameter of type TIMER")
            }
            (DataType::Parameter(ParameterType::Counter), _) => {
                message.help("name a counter by its number, or a parameter of type COUNTER")
            }
            (ty, _) => message.help(format!("name a variable of type {}", layout::declared_type(ty))),
        });
        None
    }
}

/// An address of the width of the type, at the byte of the address that stands there.
fn address_of_type(ty: Elementary, text: &str) -> String {
    let (what, letter) = match layout::width(ty) {
        Width::Bit => ("a bit", 'X'),
        Width::Byte => ("a byte", 'B'),
        Width::Word => ("a word", 'W'),
        Width::Dword => ("a double word", 'D'),
        Width::Lword => return "a variable of 64 bits".to_string(),
    };
    match rewrite::address_of_width(text, letter) {
        Some(address) => format!("{what} such as `{address}`"),
        None => what.to_string(),
    }
}
