//! S_CONV, STRG_VAL, VAL_STRG: the types of IN and OUT select a function of the standard library, whose result is OUT.
//!
//! Source: S7-1200 reference, string conversion.

use plcc_diag::Span;
use plcc_syntax::Elementary;
use plcc_syntax::scl::ast::Expr as Node;

use super::actual::is_variable;
use super::call::is_result;
use super::expression::constant_expr;
use super::function::TextNumber;
use super::pins::Pins;
use super::text::is_wide_text;
use super::value::Value;
use super::{Intent, message};
use crate::bind::scl::{SclBinder, SclBlock};
use plcc_binding::constant::Constant;
use plcc_model::layout;
use plcc_model::scl::{Access, Actual, Argument, Call, StatementKind};
use plcc_model::types::DataType;
use plcc_model::{BlockKey, Direction, Parameter};

/// The type whose function accepts a number of type `ty`.
const fn written_as(ty: Elementary) -> Option<&'static str> {
    match ty {
        Elementary::Sint
        | Elementary::Int
        | Elementary::Dint
        | Elementary::Lint
        | Elementary::Usint
        | Elementary::Uint
        | Elementary::Udint => Some("LINT"),
        Elementary::Ulint => Some("ULINT"),
        Elementary::Real => Some("REAL"),
        Elementary::Lreal => Some("LREAL"),
        _ => None,
    }
}

/// The type of the number that a value of type `ty` stands for.
const fn number_of(ty: Elementary) -> Option<Elementary> {
    match ty {
        Elementary::Byte => Some(Elementary::Usint),
        Elementary::Word => Some(Elementary::Uint),
        Elementary::Dword => Some(Elementary::Udint),
        Elementary::Lword => Some(Elementary::Ulint),
        Elementary::Time => Some(Elementary::Dint),
        Elementary::Ltime => Some(Elementary::Lint),
        _ => None,
    }
}

impl SclBinder<'_, '_> {
    pub fn text_number(&mut self, ctx: &mut SclBlock, kind: TextNumber, pins: &Pins, span: Span) -> Option<Call> {
        let (input, output) = (pins.get("IN")?, pins.get("OUT")?);
        let target = self.access(ctx, output, Intent::Write)?;
        if kind == TextNumber::Write && matches!(target.ty, DataType::WideString(_)) {
            return self.write_wide(ctx, pins, target, span);
        }
        let to_text = matches!(target.ty, DataType::String(_));
        let block = match (kind, target.elementary()) {
            (TextNumber::Convert | TextNumber::Write, None) if to_text => {
                let value = self.value(ctx, input)?;
                let name = self.written_type(&value, input.span)?;
                let first = if kind == TextNumber::Convert { "S_CONV" } else { "VAL_STRG" };
                format!("{first}_{name}")
            }
            (TextNumber::Convert, Some(ty)) if written_as(ty).is_some() => format!("STRING_TO_{}", ty.name()),
            (TextNumber::Read, Some(ty)) if written_as(ty).is_some() => format!("STRG_VAL_{}", ty.name()),
            _ => {
                let wanted = match kind {
                    TextNumber::Convert => "a number or a STRING",
                    TextNumber::Read => "a number",
                    TextNumber::Write => "a STRING or WSTRING",
                };
                let is = format!("of type {}", layout::type_name(&target.ty));
                self.wrong_type(output.span, &is, wanted, None);
                return None;
            }
        };
        let Some(key) = self.library_function(ctx.scope.rules, &block) else {
            self.program.globals.report.missing_function(&block, pins.name, None, true);
            return None;
        };
        let bound = self.program.interface(key, pins.name)?;
        let mut arguments = Vec::with_capacity(bound.interface.parameters.len());
        let mut result = None;
        for (parameter, formal) in bound.interface.parameters.iter().enumerate() {
            if is_result(key, formal) {
                result = Some(parameter);
                continue;
            }
            let node = pins.get(&formal.name)?;
            let actual = self.text_number_actual(ctx, key, formal, node)?;
            arguments.push(Argument { parameter, actual, span: node.span });
        }
        let actual = if to_text { Actual::Reference(target) } else { Actual::Variable { access: target, back: None } };
        arguments.push(Argument { parameter: result?, actual, span: output.span });
        let eno = match pins.eno {
            Some(node) => Some(self.variable_of_type(ctx, node, Elementary::Bool, Intent::Write)?),
            None => None,
        };
        Some(Call { target: key, instance: None, arguments, enable: None, eno, is_operation: false, span })
    }

    /// VAL_STRG to a text of wide characters: first to a narrow text, which then replaces some of the wide characters.
    fn write_wide(&mut self, ctx: &mut SclBlock, pins: &Pins, target: Access, span: Span) -> Option<Call> {
        let (input, output) = (pins.get("IN")?, pins.get("OUT")?);
        let value = self.value(ctx, input)?;
        let name = self.written_type(&value, input.span)?;
        let (narrow, wide) = (format!("VAL_STRG_{name}"), "VAL_STRG_WSTRING");
        let (Some(writer), Some(key)) =
            (self.library_function(ctx.scope.rules, &narrow), self.library_function(ctx.scope.rules, wide))
        else {
            self.program.globals.report.missing_function(&narrow, pins.name, None, true);
            return None;
        };
        let bound = self.program.interface(writer, pins.name)?;
        let mut arguments = Vec::with_capacity(bound.interface.parameters.len());
        for (parameter, formal) in bound.interface.parameters.iter().enumerate() {
            if is_result(writer, formal) {
                continue;
            }
            let node = pins.get(&formal.name)?;
            let actual = match formal.direction {
                Direction::InOut => Actual::Value(constant_expr(1, Elementary::Uint, node.span)),
                _ => self.text_number_actual(ctx, writer, formal, node)?,
            };
            arguments.push(Argument { parameter, actual, span: node.span });
        }
        let field =
            Call { target: writer, instance: None, arguments, enable: None, eno: None, is_operation: false, span };
        let mut values = vec![self.call_value(field, false, pins.name)?, self.value(ctx, output)?].into_iter();
        let bound = self.program.interface(key, pins.name)?;
        let mut arguments = Vec::with_capacity(bound.interface.parameters.len());
        for (parameter, formal) in bound.interface.parameters.iter().enumerate() {
            let actual = match formal.direction {
                Direction::Input => Actual::Complex(self.complex_value(ctx, values.next()?, &formal.ty)?),
                Direction::InOut => self.text_number_actual(ctx, key, formal, pins.get("P")?)?,
                _ => Actual::Reference(target.clone()),
            };
            arguments.push(Argument { parameter, actual, span: output.span });
        }
        let eno = match pins.eno {
            Some(node) => Some(self.variable_of_type(ctx, node, Elementary::Bool, Intent::Write)?),
            None => None,
        };
        Some(Call { target: key, instance: None, arguments, enable: None, eno, is_operation: false, span })
    }

    /// An argument: a position that is a number does not advance, and a text of wide characters is read as one of narrow ones.
    fn text_number_actual(
        &mut self,
        ctx: &mut SclBlock,
        key: BlockKey,
        formal: &Parameter,
        node: &Node,
    ) -> Option<Actual> {
        match (&formal.ty, formal.direction) {
            (DataType::Elementary(ty), Direction::InOut) if !is_variable(node) => {
                Some(Actual::Value(self.of_type(ctx, node, *ty)?))
            }
            (DataType::String(_), Direction::Input) => {
                let mut value = self.value(ctx, node)?;
                if is_wide_text(&value) {
                    value = self.instruction_value(ctx, "WSTRING_TO_STRING", vec![value], node.span)?;
                }
                Some(Actual::Complex(self.complex_value(ctx, value, &formal.ty)?))
            }
            _ => self.actual(ctx, key, formal, node),
        }
    }

    /// S_CONV to or from a text of wide characters, where the other side is a text or the target is one; `None`: another S_CONV.
    pub fn wide_conversion(&mut self, ctx: &mut SclBlock, pins: &Pins, span: Span) -> Option<Option<StatementKind>> {
        let (input, output) = (pins.get("IN")?, pins.get("OUT")?);
        if pins.eno.is_some() {
            return None;
        }
        let (told, reads) = (self.program.globals.report.diagnostics.len(), ctx.scope.temp_reads.len());
        let target = self.access(ctx, output, Intent::Write);
        let value = self.value(ctx, input);
        let wide_target = matches!(target.as_ref()?.ty, DataType::WideString(_));
        let from_wide = is_wide_text(value.as_ref()?);
        let narrowed = from_wide && matches!(target.as_ref()?.ty, DataType::String(_));
        if !wide_target && !narrowed {
            self.program.globals.report.diagnostics.truncate(told);
            ctx.scope.temp_reads.truncate(reads);
            return None;
        }
        let (target, value) = (target?, value?);
        let narrow =
            matches!(value, Value::Complex { ty: DataType::String(_), .. } | Value::Constant(Constant::Text { .. }, _));
        let text = if from_wide || narrow {
            Some(value)
        } else {
            let name = self.written_type(&value, input.span).map(|name| format!("S_CONV_{name}"));
            name.and_then(|name| self.instruction_value(ctx, &name, vec![value], span))
        };
        let change = match (&text, wide_target) {
            (Some(text), true) if !is_wide_text(text) => Some("STRING_TO_WSTRING"),
            (Some(text), false) if is_wide_text(text) => Some("WSTRING_TO_STRING"),
            _ => None,
        };
        let text = match (text, change) {
            (Some(text), Some(name)) => self.instruction_value(ctx, name, vec![text], span),
            (text, _) => text,
        };
        Some(text.and_then(|text| self.assignment(ctx, target, text)))
    }

    /// The type whose function writes this number; a constant has one that can hold it. Anything else is reported.
    fn written_type(&mut self, value: &Value, span: Span) -> Option<&'static str> {
        let ty = match value {
            Value::Elementary(expr) => Some(expr.ty),
            Value::Constant(Constant::Typed { ty, .. }, _) => Some(*ty),
            Value::Constant(Constant::Integer { .. }, _) => Some(Elementary::Lint),
            Value::Constant(Constant::Real(_), _) => Some(Elementary::Real),
            _ => None,
        };
        let name = ty.and_then(written_as);
        if name.is_none() {
            let text = self.program.globals.text(span);
            let help = ty.and_then(|ty| Some(message::conversion(ty, number_of(ty)?, &text)));
            let help = help.map(|conversion| format!("convert it: {conversion}"));
            self.wrong_type(span, &message::described(value), "a number", help);
        }
        name
    }
}
