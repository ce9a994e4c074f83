//! Arguments that do not fit the types of their parameters, as the subroutine declares them.

use plcc_diag::{Code, Diagnostic};
use plcc_syntax::ast::Width;
use plcc_syntax::s7200::OperandClass;
use plcc_syntax::s7200::ast::{self, Area, Constant, OperandKind, Section};

use super::Binder;
use super::interface::{Local, Locals, Type};
use super::meant::Form;
use super::operand::{wanted, width, width_name};

impl Binder<'_> {
    /// What is wrong with an argument of another width, a REAL for an integer, or the address of an operand.
    pub fn misfitting_argument(
        &self,
        locals: &Locals,
        formal: &Local,
        class: OperandClass,
        actual: &ast::Operand,
    ) -> Option<Diagnostic> {
        let (name, span) = (&formal.name, actual.span);
        let parameter = format!("parameter `{name}` is {}", with_article(formal.ty));
        let input = formal.section == Section::Input;
        match &actual.kind {
            OperandKind::AddressOf(_) if class != OperandClass::DwordInAddress => {
                let (label, help) = match input {
                    true => {
                        ("an address needs a DWORD", format!("declare `{name}` as DWORD, or pass a value without `&`"))
                    }
                    false => ("the subroutine writes to this operand", "pass the operand without `&`".to_string()),
                };
                let title = format!("an address is passed, but {parameter} (0090)");
                Some(Diagnostic::new(Code::OperandKind, span, title).label(label).help(help))
            }
            OperandKind::Constant(_) if !input => {
                let title = format!("a constant is passed, but the subroutine writes to parameter `{name}` (0090)");
                let message = Diagnostic::new(Code::Protected, span, title).label("its result goes here");
                Some(message.help(format!("name {}", wanted(class))))
            }
            OperandKind::Constant(Constant::Real(value))
                if matches!(formal.ty, Type::Byte | Type::Word | Type::Int | Type::Dint) =>
            {
                let help = match value.fract() == 0.0 {
                    true => format!("write `{value:.0}`, or declare `{name}` as REAL"),
                    false => format!("declare `{name}` as REAL, or pass a whole number"),
                };
                let title = format!("`{}` is a REAL, but {parameter} (0090)", self.written(span));
                Some(Diagnostic::new(Code::OperandKind, span, title).label("this constant").help(help))
            }
            _ => {
                let Form::Place(direct) = self.form_of(locals, actual) else { return None };
                let needed = width(class)?;
                // Analog values, current values of timers and counters, and HC have one width.
                let (own, number) = match direct.area {
                    Area::Ai | Area::Aq => (Width::Word, Some("INT")),
                    Area::T | Area::C if needed != Width::Bit => (Width::Word, Some("INT")),
                    Area::Hc => (Width::Dword, Some("DINT")),
                    _ => (direct.width?, None),
                };
                if own == needed {
                    return None;
                }
                let help = match number {
                    Some(ty) => format!("declare `{name}` as {ty}"),
                    None => {
                        format!("write {}, or declare `{name}` as {}", self.of_width(direct, needed, span), types(own))
                    }
                };
                let title = format!("{} is {}, but {parameter} (0090)", self.shown(direct, span), width_name(own));
                let label = format!("expected: {}", wanted(class));
                Some(Diagnostic::new(Code::OperandKind, span, title).label(label).help(help))
            }
        }
    }
}

fn with_article(ty: Type) -> &'static str {
    match ty {
        Type::Bool => "a BOOL",
        Type::Byte => "a BYTE",
        Type::Word => "a WORD",
        Type::Int => "an INT",
        Type::Dword => "a DWORD",
        Type::Dint => "a DINT",
        Type::Real => "a REAL",
        Type::String => "a STRING",
    }
}

/// The types of a width.
fn types(width: Width) -> &'static str {
    match width {
        Width::Bit => "BOOL",
        Width::Byte => "BYTE",
        Width::Word => "INT or WORD",
        Width::Dword | Width::Lword => "DINT, DWORD or REAL",
    }
}
