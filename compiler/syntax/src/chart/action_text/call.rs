//! `CALL "Ramp", "RampDB" (IN1 := 1, OUT1 := #x)`: commas or line ends separate the parameters.

use std::ops::Range;

use plcc_diag::Span;

use super::Reader;
use crate::chart::ast::{ActionBody, Call, Parameter};
use crate::scl::ast::{Argument, Expr, ExprKind, Name, NameForm};

impl Reader<'_> {
    /// The call at `code`; `after`: where the text after the word CALL begins.
    pub fn call(&mut self, code: Range<usize>, after: usize) -> ActionBody {
        let parentheses = self.source.parentheses(after..code.end);
        let head = after..parentheses.map_or(code.end, |(open, _)| open);
        let parameters = match parentheses {
            None => None,
            Some((open, None)) => {
                let help = "close it after the last parameter";
                return self.refuse(
                    open..open + 1,
                    "the parameters of a call are not closed".to_string(),
                    "opened here",
                    help,
                );
            }
            Some((open, Some(close))) => {
                let rest = self.source.trimmed(close + 1..code.end);
                if !rest.is_empty() {
                    let help = "write one call in a row";
                    return self.refuse(rest, "a call ends with its parameters".to_string(), "not expected here", help);
                }
                Some(open + 1..close)
            }
        };
        let separators = self.source.separators(head.clone());
        let (block, instance) = match separators.as_slice() {
            [] => (head, None),
            [comma] => (head.start..comma.start, Some(comma.end..head.end)),
            [_, second, ..] => {
                let help = "write the block, a comma, and its instance data block";
                let title = "a call names a block and its instance".to_string();
                return self.refuse(second.clone(), title, "one name too many", help);
            }
        };
        let block = self.block(block, code.clone());
        let instance = instance.map(|instance| self.block(instance, code.clone()));
        let parameters = parameters.map_or(Some(Vec::new()), |range| self.parameters(range));
        match (block, instance, parameters) {
            (Some(block), None, Some(parameters)) => {
                ActionBody::Call(Call { block, instance: None, parameters, span: self.span(code) })
            }
            (Some(block), Some(Some(instance)), Some(parameters)) => {
                ActionBody::Call(Call { block, instance: Some(instance), parameters, span: self.span(code) })
            }
            _ => ActionBody::Error,
        }
    }

    /// The name of a block: `"Mix"`, `#ramp`, `FC 10`.
    fn block(&mut self, range: Range<usize>, call: Range<usize>) -> Option<Expr> {
        let range = self.source.trimmed(range);
        if range.is_empty() {
            let help = "write the name of the block after CALL";
            self.refuse(call, "a call without a block".to_string(), "no name", help);
            return None;
        }
        let written = &self.text[range.clone()];
        let (letters, number) =
            written.split_at(written.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(written.len()));
        let digits = number.trim_start();
        // The number may be a separate word.
        if digits.len() < number.len() && !letters.is_empty() && digits.bytes().all(|digit| digit.is_ascii_digit()) {
            let span = self.span(range.clone());
            let name = Name { text: format!("{letters}{digits}"), form: NameForm::Bare, span };
            return Some(Expr { kind: ExprKind::Name(name), span });
        }
        self.expression(range)
    }

    /// `None` if one cannot be read.
    fn parameters(&mut self, range: Range<usize>) -> Option<Vec<Parameter>> {
        let parameters = self.source.parameters(range);
        let found: Vec<Option<Parameter>> = parameters.into_iter().map(|range| self.parameter(range)).collect();
        found.into_iter().collect()
    }

    fn parameter(&mut self, range: Range<usize>) -> Option<Parameter> {
        let Some(arrow) = self.source.arrow(range.clone()) else {
            let help = "write the parameter's name and `:=` before the value";
            self.refuse(range, "a parameter without its name".to_string(), "which parameter is it for?", help);
            return None;
        };
        let name = self.source.trimmed(range.start..arrow.start);
        let value = self.source.trimmed(arrow.end..range.end);
        let name = self.parameter_name(name, arrow)?;
        let value = if value.is_empty() { None } else { Some(self.expression(value)?) };
        Some(Parameter { name, value, span: self.span(range) })
    }

    fn parameter_name(&mut self, range: Range<usize>, arrow: Range<usize>) -> Option<Name> {
        let span = self.span(range.clone());
        let written = self.text[range.clone()].trim_start_matches('#');
        let text = written.trim_matches('"');
        let form = if text.len() < written.len() { NameForm::Quoted } else { NameForm::Bare };
        if text.is_empty() || form == NameForm::Bare && text.contains(|c: char| !c.is_alphanumeric() && c != '_') {
            let place = if range.is_empty() { arrow } else { range };
            self.refuse(place, "a parameter without its name".to_string(), "no name", "write it before `:=`");
            return None;
        }
        Some(Name { text: text.to_string(), form, span })
    }

    /// A call as SCL writes it: `"Mix"(IN1 := 1)`.
    pub fn scl_call(&mut self, block: Expr, arguments: Vec<Argument>, span: Span) -> ActionBody {
        let mut parameters = Vec::new();
        for argument in arguments {
            let Some(name) = argument.name else {
                let help = "write the parameter's name and `:=` before the value";
                let place = argument.span.range();
                return self.refuse(
                    place,
                    "a parameter without its name".to_string(),
                    "which parameter is it for?",
                    help,
                );
            };
            parameters.push(Parameter { name, value: argument.value, span: argument.span });
        }
        ActionBody::Call(Call { block, instance: None, parameters, span })
    }
}
